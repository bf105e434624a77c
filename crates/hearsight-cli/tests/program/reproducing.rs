//! `hearsight reproduce`: the quick form runs whole, its claims come out as JSON, and a second run measures nothing anew.

use crate::common::{errors, printed, run};
use serde_json::Value;
use tempfile::TempDir;

#[test]
fn stac_in_its_quick_form_judges_every_claim_and_goes_on_from_what_it_measured() {
    let directory = TempDir::new().unwrap();
    let file = directory.path().join("claims.json");
    let out = directory.path().join("trials");
    let reproduce = || {
        let output = run(&[
            "reproduce",
            "stac",
            "--quick",
            "--json",
            file.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ]);
        // Claims that fail are a result, not an error.
        assert!(output.status.success(), "{}", errors(&output));
        let claims: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        let trials = std::fs::read_to_string(out.join("trials.jsonl")).unwrap();
        let trials: Vec<String> = trials
            .lines()
            .filter(|line| !line.is_empty())
            .map(str::to_owned)
            .collect();
        (printed(&output), claims, trials)
    };
    let (table, claims, trials) = reproduce();
    assert!(
        table.contains("28.63") && table.contains("claims hold"),
        "{table}"
    );
    let listed = claims.as_array().unwrap();
    assert_eq!(listed.len(), 16);
    for claim in listed {
        assert!(
            claim["id"].is_string() && claim["statement"].is_string(),
            "{claim}"
        );
        assert!(claim["seeds"].as_u64().unwrap() >= 8, "{claim}");
        assert_eq!(claim["interval"].as_array().unwrap().len(), 2, "{claim}");
        let low = claim["interval"][0].as_f64().unwrap();
        let ours = claim["ours"].as_f64().unwrap();
        assert!(
            low <= ours && ours <= claim["interval"][1].as_f64().unwrap(),
            "{claim}"
        );
    }
    // One filter that never dies has no switch, however hard the scene is.
    let sound = listed
        .iter()
        .find(|claim| claim["id"] == "audio-switches")
        .unwrap();
    assert_eq!(sound["holds"], true, "{table}");
    let (_, again, resumed) = reproduce();
    assert_eq!((again, resumed), (claims, trials));
}
