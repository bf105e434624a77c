//! Sequence A: how often each variant loses the head, how far off it is, and how reliable its trackers were.

use super::super::lockstep::{Variant, build_all, run};
use super::super::{Measured, Trial};
use super::{EXPERIMENT, as_in_the_paper};
use hearsight::core::record::BoxRecord;
use hearsight::media::{Camera, MomentOptions, MomentReader};
use hearsight::sim::simulation::Simulation;
use miette::IntoDiagnostic;
use serde_json::json;
use std::collections::BTreeMap;

/// What happens in the scene: name, first and last frame. Those of sequence A.
pub(super) const EVENTS: [(&str, usize, usize); 3] =
    [("jerk", 150, 165), ("hand", 350, 400), ("turn", 520, 600)];
/// Around these frames nobody's accuracy is judged.
const TRANSIENTS: [(usize, usize); 3] = [(145, 200), (345, 410), (515, 615)];
/// Below this overlap with the true head a track is not on it.
const LEAST_OVERLAP: f64 = 0.2;
/// For so many frames it must be off to be lost.
const LOST_FRAMES: usize = 10;
/// Frames over which reliabilities are averaged for their curves.
pub(super) const BIN_FRAMES: usize = 20;

pub(super) const CONTOUR: &str = "contour alone";
pub(super) const COLOUR: &str = "colour alone";
pub(super) const FUSED: &str = "fused";
pub(super) const OPEN: &str = "fused, open loop";
pub(super) const PRINTED: &str = "fused, eq. 8 printed";
pub(super) const OURS: &str = "fused, beyond the paper";
/// Other numbers of hypotheses from the trackers' mixture.
pub(super) const OTHERS: [(&str, usize); 4] = [
    ("fused 12", 12),
    ("fused 25", 25),
    ("fused 50", 50),
    ("fused 200", 200),
];
/// Hypotheses from the transition prior, up to where the sheet's ratio is shown many times over: more cost minutes a seed.
pub(super) const PRIOR: [(&str, usize); 7] = [
    ("prior 12", 12),
    ("prior 25", 25),
    ("prior 50", 50),
    ("prior 100", 100),
    ("prior 200", 200),
    ("prior 400", 400),
    ("prior 800", 800),
];
/// Hypotheses of [`FUSED`].
pub(super) const USUAL: usize = 100;

pub(super) fn variants() -> Vec<Variant> {
    let off = json!(false);
    let variant = |name, parameters| Variant {
        name,
        system: EXPERIMENT.name,
        parameters,
    };
    let alone = |others: [&str; 2]| {
        let settings: Vec<_> = others.iter().map(|path| (*path, off.clone())).collect();
        as_in_the_paper(&settings)
    };
    let mut variants = vec![
        variant(
            CONTOUR,
            alone(["fuser.trackers.colour", "verifiers.colour.enabled"]),
        ),
        variant(
            COLOUR,
            alone(["fuser.trackers.contour", "verifiers.contour.enabled"]),
        ),
        variant(FUSED, as_in_the_paper(&[])),
        variant(OPEN, as_in_the_paper(&[("fuser.feedback.enabled", off.clone())])),
        variant(PRINTED, as_in_the_paper(&[("fuser.weights", json!("printed"))])),
        variant(OURS, json!({})),
    ];
    for (name, count) in OTHERS {
        variants.push(variant(name, as_in_the_paper(&[("particles", json!(count))])));
    }
    for (name, count) in PRIOR {
        let settings = [("particles", json!(count)), ("fuser.proposal", json!("prior"))];
        variants.push(variant(name, as_in_the_paper(&settings)));
    }
    variants
}

/// What a variant said of one picture.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    /// Overlap with the true head, 0 to 1.
    overlap: f64,
    /// Distance of the middles, widths of the true head.
    offset: Option<f64>,
    effective: Option<f64>,
    reliabilities: Option<[f64; 3]>,
}

pub(super) fn measure(simulation: &Simulation, trial: &Trial) -> miette::Result<Measured> {
    let variants = variants();
    let room = simulation.room();
    let cameras = room.cameras.iter().enumerate().map(|(number, sensor)| Camera {
        name: sensor.name.clone(),
        source: Box::new(simulation.camera(number)),
    });
    let mut reader =
        MomentReader::new(cameras.collect(), Vec::new(), MomentOptions::default()).into_diagnostic()?;
    let mut systems = build_all(&variants, &room, trial.seed)?;
    let mut looks: Vec<Vec<Look>> = variants.iter().map(|_| Vec::new()).collect();
    run(
        simulation,
        &mut reader,
        &mut systems,
        &mut |_| (),
        &mut |number, system, scene, truth| {
            let view = truth.people.first().and_then(|person| person.views.first());
            let Some(head) = view.and_then(|view| view.head) else {
                looks[number].push(Look::default());
                return;
            };
            let tracks = scene
                .tracks
                .iter()
                .filter_map(|track| Some((track, track.views.first()?.head)));
            let best = tracks
                .map(|(track, own)| (overlap(&own, &head), track, own))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            looks[number].push(best.map_or_else(Look::default, |(overlap, track, own)| Look {
                overlap,
                offset: Some(offset(&own, &head)),
                effective: Some(track.effective_sample_size),
                reliabilities: system.reliabilities(0, track.id),
            }));
        },
    )?;
    let measured = variants
        .iter()
        .zip(&looks)
        .map(|(variant, looks)| (variant.name.to_owned(), metrics(looks)));
    Ok(measured.collect())
}

fn overlap(a: &BoxRecord, b: &BoxRecord) -> f64 {
    let across = (a.left + a.width).min(b.left + b.width) - a.left.max(b.left);
    let down = (a.top + a.height).min(b.top + b.height) - a.top.max(b.top);
    let both = across.max(0.0) * down.max(0.0);
    both / (a.width * a.height + b.width * b.height - both).max(1e-9)
}

fn offset(own: &BoxRecord, head: &BoxRecord) -> f64 {
    let middle = |of: &BoxRecord| [of.left + 0.5 * of.width, of.top + 0.5 * of.height];
    let ([x, y], [u, v]) = (middle(own), middle(head));
    (x - u).hypot(y - v) / head.width.max(1.0)
}

fn metrics(looks: &[Look]) -> BTreeMap<String, f64> {
    let mut metrics = BTreeMap::new();
    for (name, from, until) in EVENTS {
        if let Some(lost) = lost(looks, from, until) {
            metrics.insert(format!("lost_{name}"), f64::from(u8::from(lost)));
        }
    }
    let mut add = |name: String, value: Option<f64>| {
        if let Some(value) = value {
            metrics.insert(name, value);
        }
    };
    add(
        "lost".into(),
        lost_anywhere(looks).map(|lost| f64::from(u8::from(lost))),
    );
    let calm = || {
        looks
            .iter()
            .enumerate()
            .filter(|(frame, look)| {
                look.overlap >= LEAST_OVERLAP
                    && !TRANSIENTS
                        .iter()
                        .any(|(from, until)| (*from..*until).contains(frame))
            })
            .map(|(_, look)| look)
    };
    add("error".into(), mean(calm().filter_map(|look| look.offset)));
    add("overlap".into(), mean(calm().map(|look| look.overlap)));
    add("effective".into(), mean(calm().filter_map(|look| look.effective)));
    let after = looks.get(165..300).unwrap_or_default();
    add(
        "shortfall_after".into(),
        mean(after.iter().map(|look| 1.0 - look.overlap)),
    );
    let first = looks.iter().position(|look| look.overlap >= LEAST_OVERLAP);
    let later = &looks[first.unwrap_or(looks.len())..];
    add(
        "share".into(),
        mean(
            later
                .iter()
                .map(|look| f64::from(u8::from(look.overlap >= LEAST_OVERLAP))),
        ),
    );
    let reliability = |from: usize, until: usize, kind: usize| {
        let looks = looks.get(from..until.min(looks.len())).unwrap_or_default();
        mean(
            looks
                .iter()
                .filter_map(|look| look.reliabilities)
                .map(|all| all[kind]),
        )
    };
    for (kind, name) in ["contour", "colour"].into_iter().enumerate() {
        add(format!("{name}_calm"), reliability(60, 140, kind));
        add(format!("{name}_jerk"), reliability(151, 164, kind));
        add(format!("{name}_hand"), reliability(352, 400, kind));
        for from in (0..looks.len()).step_by(BIN_FRAMES) {
            add(
                format!("{name}_{from:04}"),
                reliability(from, from + BIN_FRAMES, kind),
            );
        }
    }
    let crossed = (150..170).position(|frame| {
        let reliabilities = looks.get(frame).and_then(|look| look.reliabilities);
        reliabilities.is_some_and(|[contour, colour, _]| contour < colour)
    });
    add("frames_to_cross".into(), crossed.map(|frames| frames as f64));
    metrics
}

/// Whether a head is lost between when it is found and the end of the hand's sweep; none where it is not found before that.
/// Who loses it before the jerk has lost it too.
fn lost_anywhere(looks: &[Look]) -> Option<bool> {
    let until = EVENTS[1].2 + LOST_FRAMES;
    let judged = &looks[..until.min(looks.len())];
    let first = judged.iter().position(|look| look.overlap >= LEAST_OVERLAP)?;
    let off = |looks: &[Look]| looks.iter().all(|look| look.overlap < LEAST_OVERLAP);
    Some(judged[first..].windows(LOST_FRAMES).any(off))
}

/// Whether a head that was followed is lost in an event; none where it was not followed before.
fn lost(looks: &[Look], from: usize, until: usize) -> Option<bool> {
    let before = looks.get(from.saturating_sub(8)..from)?;
    if !before.iter().any(|look| look.overlap >= LEAST_OVERLAP) {
        return None;
    }
    let off = |frame: usize| {
        looks
            .get(frame..frame + LOST_FRAMES)
            .is_some_and(|looks| looks.iter().all(|look| look.overlap < LEAST_OVERLAP))
    };
    Some((from..until).any(off))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_is_lost_after_ten_frames_off_it_and_only_if_it_was_followed() {
        let look = |overlap| Look {
            overlap,
            offset: Some(0.1),
            ..Look::default()
        };
        let mut looks = vec![look(0.7); 700];
        assert_eq!(lost(&looks, 150, 165), Some(false));
        looks[160..169].fill(look(0.1));
        assert_eq!(lost(&looks, 150, 165), Some(false));
        looks[169] = look(0.0);
        assert_eq!(lost(&looks, 150, 165), Some(true));
        looks[342..350].fill(Look::default());
        assert_eq!(lost(&looks, 350, 400), None);
        let metrics = metrics(&looks);
        assert_eq!(metrics["lost_jerk"], 1.0);
        assert_eq!(metrics["lost"], 1.0);
        assert!(!metrics.contains_key("lost_hand"));
        looks[165] = look(0.7);
        assert_eq!(lost_anywhere(&looks), Some(false));
        looks[100..110].fill(look(0.1));
        assert_eq!(lost_anywhere(&looks), Some(true), "before any event");
        assert_eq!(lost_anywhere(&vec![look(0.0); 700]), None);
        assert!((metrics["error"] - 0.1).abs() < 1e-9);
    }

    #[test]
    fn overlaps_and_offsets_are_those_of_boxes() {
        let own = BoxRecord {
            left: 0.0,
            top: 0.0,
            width: 10.0,
            height: 10.0,
        };
        let other = BoxRecord { left: 5.0, ..own };
        assert!((overlap(&own, &other) - 1.0 / 3.0).abs() < 1e-12);
        assert!((offset(&own, &other) - 0.5).abs() < 1e-12);
    }
}
