//! Scenarios that cannot be: each is refused with the entry, what is wrong, and a cure.

use crate::common::{refusal, world};

const ROOM: &str = "[room]\nsize = [5, 4, 2.7]\n[[room.door]]\nat = [5, 2]\n";
const TABLE: &str = "[[furniture]]\nkind = \"table\"\nname = \"desk\"\nat = [2.5, 2]\n";

fn person(more: &str) -> String {
    format!("{ROOM}[[person]]\nname = \"anna\"\nat = [1, 1]\n{more}")
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let message = refusal(text);
    for word in words {
        assert!(message.contains(word), "no `{word}` in: {message}");
    }
}

#[test]
fn the_least_scenario_is_empty() {
    assert!(world("").people.is_empty());
    assert_eq!(world(&person("")).people[0].name, "anna");
}

#[test]
fn unknown_keys_and_words_have_suggestions() {
    refused("[rom]\n", &["unknown key `rom`", "`room`"]);
    refused(
        &person("heigth = 1.7\n"),
        &["unknown key `heigth`", "did you mean `height`"],
    );
    refused(
        "[[camera]]\nname = \"a\"\nat = [1, 1, 1]\nvew = 60\n",
        &["unknown key `vew`", "`view`"],
    );
    refused(
        "[[furniture]]\nkind = \"tabel\"\nat = [1, 1]\n",
        &["unknown value `tabel`", "`table`"],
    );
    refused(
        &person("skin = \"whit\"\n"),
        &["person[0].skin", "no colour `whit`", "`white`"],
    );
    refused(&person("skin = \"#12\"\n"), &["person[0].skin", "no colour"]);
    refused(
        &person("top = { color = \"red\" }\n"),
        &["unknown key `color`", "`colour`"],
    );
    refused(&person("facing = \"bob\"\n"), &["person[0].facing", "`bob`"]);
    refused(&person("facing = [1, 2, 3, 4]\n"), &["a direction is"]);
    refused("seconds = -3\n", &["seconds", "-3 s is no length"]);
}

#[test]
fn people_in_walls_and_furniture() {
    refused(
        "[room]\nsize = [4, 4, 1.2]\n[[person]]\n",
        &["person[0].height", "ceiling"],
    );
    refused(
        &format!("{ROOM}[[person]]\nat = [0.05, 2]\n"),
        &["person[0].at", "in a wall"],
    );
    refused(
        &format!("{ROOM}[[person]]\nat = [9, 2]\n"),
        &["person[0].at", "outside the room"],
    );
    refused(
        &format!("{ROOM}{TABLE}[[person]]\nat = [2.5, 2.1]\n"),
        &["person[0].at", "in `desk`"],
    );
    let through = person("[[person.action]]\ntime = 1\nwalk = [[4, 3]]\n") + TABLE;
    refused(
        &through,
        &["person[0].action[0]", "`anna` is in `desk`", "walk around"],
    );
    let wall = person("[[person.action]]\ntime = 1\nwalk = [[0.05, 3]]\n");
    refused(&wall, &["person[0].action[0]", "in a wall"]);
    let out = person("[[person.action]]\ntime = 1\nwalk = [[-1, 3]]\n");
    refused(&out, &["person[0].action[0].walk[0]", "outside the room"]);
}

#[test]
fn sources_and_sensors_outside_the_room() {
    refused(
        "[[noise]]\nkind = \"fan\"\nat = [9, 1, 1]\n",
        &["noise[0].at", "outside the room"],
    );
    refused(
        "[[noise]]\nkind = \"cough\"\n",
        &["noise[0]", "comes from somewhere"],
    );
    refused(
        "[[array]]\nat = [1, 1, 5]\n",
        &["array[0].at", "outside the room"],
    );
    refused(
        "[[camera]]\nat = [1, -1, 1]\n",
        &["camera[0].at", "outside the room"],
    );
    refused("[[light]]\nat = [1, 1, 3]\n", &["light[0].at", "outside"]);
    let base = "[[base]]\nat = [5, 2]\n[[base.action]]\ntime = 0\nwalk = [[5.95, 2]]\n";
    let array = "[[array]]\nbase = \"base1\"\nat = [0, 0, 0.5]\n";
    refused(&format!("{base}{array}"), &["array[0]", "outside the room"]);
}

#[test]
fn turns_that_cannot_be() {
    refused(
        &person("turns = [[1, 3], [2, 4]]\n"),
        &["person[0].turns[1]", "before the one before ends"],
    );
    refused(&person("turns = [[3, 1]]\n"), &["person[0].turns[0]", "no span"]);
    refused(
        &person("turns = [[0, 7000]]\n"),
        &["person[0].turns[0]", "7000 s"],
    );
    let both = person("turns = [[1, 9]]\n[[conversation]]\n");
    refused(&both, &["conversation[0]", "`anna` already speaks"]);
    let away = person("turns = [[1, 9]]\n[[person.action]]\ntime = 0\nleave = \"door\"\n");
    refused(&away, &["person[0].turns[0]", "not in the room"]);
    refused("[[conversation]]\n", &["conversation[0]", "nobody"]);
    refused(
        &person("[[conversation]]\npeople = [\"ana\"]\n"),
        &["conversation[0].people[0]", "`anna`"],
    );
    refused(
        &person("[[conversation]]\nturns = { overlap = 0.9 }\n[[person]]\nat = [2, 2]\n"),
        &["conversation[0].turns", "overlap"],
    );
}

#[test]
fn cameras_of_no_size_and_impossible_lenses() {
    let camera = |more: &str| format!("[[camera]]\nat = [1, 1, 1]\n{more}\n");
    refused(&camera("size = [0, 480]"), &["camera[0].size", "0 x 480"]);
    refused(&camera("view = 0"), &["camera[0].view"]);
    refused(&camera("view = 180"), &["camera[0].view"]);
    refused(&camera("rate = 0"), &["camera[0].rate"]);
    refused(&camera("focal = -1"), &["camera[0].focal"]);
    refused(
        &camera("look_at = [1, 1, 1]"),
        &["camera[0].look_at", "very place"],
    );
    refused(&camera("shutter = 1.0"), &["camera[0].shutter"]);
    refused(
        &camera("[[camera.command]]\ntime = 1\npan = 3"),
        &["camera[0].command[0]", "head"],
    );
    refused(
        &format!("{ROOM}{TABLE}[[camera]]\nat = [2.5, 2, 0.3]\n"),
        &["camera[0].at", "inside `desk`"],
    );
    refused("[[array]]\nat = [1, 1, 1]\ncount = 0\n", &["array[0].count"]);
    refused(
        "[[array]]\nmicrophones = [[1, 1, 1], [1, 1, 1]]\n",
        &["array[0].microphones[1]", "zero size"],
    );
}

#[test]
fn times_out_of_order_and_unreachable_speeds() {
    let action = |more: &str| person(&format!("[[person.action]]\n{more}\n"));
    refused(&action("walk = [[2, 2]]"), &["person[0].action[0]", "`time`"]);
    refused(&action("time = -1\nstand = true"), &["person[0].action[0].time"]);
    refused(
        &action("time = 1\nspeed = 9\nwalk = [[4, 3]]"),
        &["person[0].action[0].speed", "3.5"],
    );
    refused(
        &action("time = 1\nuntil = 2.5\nwalk = [[4, 3]]"),
        &["person[0].action[0]", "metres a second"],
    );
    refused(
        &action("time = 1\nuntil = 1.1\nwalk = [[4, 3]]"),
        &["person[0].action[0]"],
    );
    refused(
        &action("time = 1\njerk = [2, 0]\nseconds = 0.1"),
        &["person[0].action[0]", "nobody moves faster"],
    );
    refused(
        &action("time = 5\nwalk = [[2, 2]]\n[[person.action]]\ntime = 4\nstand = true"),
        &["person[0].action[1].time", "before the action before"],
    );
    refused(
        &action("time = 5\nwalk = [[4, 3]]\n[[person.action]]\ntime = 6\nwalk = [[1, 3]]"),
        &["person[0].action[1].time", "too early"],
    );
    refused(&action("time = 1"), &["person[0].action[0]", "says nothing"]);
    refused(&action("time = 1\nstand = true\nturn = 3"), &["stand and turn"]);
    refused(
        &action("time = 1\nsit = \"chair\""),
        &["person[0].action[0].sit", "no seat `chair`"],
    );
    refused(
        &action("time = 1\nleave = \"window\""),
        &["person[0].action[0].leave", "no door `window`", "door"],
    );
    refused(&action("time = 1\nenter = \"door\""), &["in the room already"]);
    refused(
        &action(
            "time = 1\ngesture = \"wave\"\nseconds = 3\n[[person.action]]\ntime = 2\ngesture = \"raise_hand\"",
        ),
        &["person[0].action[1].time", "gesture before"],
    );
}

#[test]
fn names_that_are_given_twice() {
    refused(
        &person("[[person]]\nname = \"anna\"\nat = [2, 2]\n"),
        &["person[1].name", "already the name of person[0]"],
    );
    refused(
        &person("[[camera]]\nname = \"anna\"\nat = [1, 1, 1]\n"),
        &["camera[0].name", "already the name of person[0]"],
    );
    refused(
        &person("[[camera]]\nname = \"a b\"\nat = [1, 1, 1]\n"),
        &["camera[0].name", "contains ' '"],
    );
    refused(
        &format!("{ROOM}[[person]]\nname = \"anna\"\n"),
        &["person[0]", "has no `at`"],
    );
}

#[test]
fn damaged_text_is_refused_and_never_panics() {
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/meeting.toml")).unwrap();
    let none = hearsight_core::configuration::Overrides::new();
    for cut in (0..text.len())
        .step_by(7)
        .filter(|cut| text.is_char_boundary(*cut))
    {
        let _ = hearsight_sim::scenario::from_text("scene.toml", &text[..cut], &none);
    }
    for (number, word) in ["nan", "inf", "-1e300", "0", "\"x\"", "[]", "1e300"]
        .iter()
        .enumerate()
    {
        let mut digits = 0;
        let damaged: String = text
            .split_inclusive(char::is_whitespace)
            .map(|part| {
                let is_number = part.trim().trim_end_matches([',', ']']).parse::<f64>().is_ok();
                digits += usize::from(is_number);
                if is_number && digits % 7 == number {
                    format!("{word}\n")
                } else {
                    part.to_owned()
                }
            })
            .collect();
        let _ = hearsight_sim::scenario::from_text("scene.toml", &damaged, &none);
    }
}

#[test]
fn people_and_cameras_that_share_a_place() {
    refused(
        &person("[[person]]\nname = \"bob\"\nat = [1.05, 1]\n"),
        &["person[1].at", "`bob` is where `anna` is"],
    );
    let comes =
        person("[[person]]\nname = \"bob\"\nat = [4, 1]\n[[person.action]]\ntime = 1\nwalk = [[1, 1]]\n");
    refused(
        &comes,
        &[
            "person[1].action[0]",
            "`bob` is where `anna` is",
            "a place of their own",
        ],
    );
    // Walking by is no fault, nor is a neighbour.
    let passes = person(
        "[[person]]\nname = \"bob\"\nat = [4, 1]\n[[person.action]]\ntime = 1\nwalk = [[1, 1], [0.5, 3]]\n\
         [[person]]\nname = \"cleo\"\nat = [1.6, 1]\n",
    );
    assert_eq!(world(&passes).people.len(), 3);
    let camera = |height: &str| person(&format!("[[camera]]\nname = \"desk\"\nat = [1, 1, {height}]\n"));
    refused(
        &camera("1.2"),
        &["person[0].at", "`anna` is where the camera `desk` is"],
    );
    assert_eq!(world(&camera("2.4")).cameras.len(), 1);
}

#[test]
fn pictures_that_no_codec_takes() {
    let camera = |size: &str| format!("[[camera]]\nat = [1, 1, 1]\nlook_at = [2, 2, 1]\nsize = {size}\n");
    refused(&camera("[8192, 8192]"), &["camera[0].size", "16 million"]);
    refused(&camera("[640, 0]"), &["camera[0].size", "is no picture"]);
    assert_eq!(world(&camera("[4096, 4096]")).cameras[0].width, 4096);
}
