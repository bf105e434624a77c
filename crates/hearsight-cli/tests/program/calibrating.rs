//! `hearsight calibrate`: boards, and what it says where something is missing.

use super::common::{errors, printed, recording, run};
use std::path::{Path, PathBuf};

fn boards(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../hearsight-calibrate/tests/goldens")
        .join(kind)
}

fn pictures(kind: &str, numbers: std::ops::Range<usize>) -> Vec<String> {
    numbers
        .map(|number| {
            boards(kind)
                .join(format!("{number:02}.png"))
                .display()
                .to_string()
        })
        .collect()
}

fn camera<'a>(board: &[&'a str], pictures: &'a [String]) -> Vec<&'a str> {
    let mut arguments = vec!["calibrate", "camera", "--square", "0.03"];
    arguments.extend(board);
    arguments.push("--");
    arguments.extend(pictures.iter().map(String::as_str));
    arguments
}

#[test]
fn boards_give_a_file_that_a_room_can_name() {
    let directory = tempfile::tempdir().unwrap();
    for (kind, board) in [
        ("chessboard", vec!["--chessboard", "9x7"]),
        (
            "charuco",
            vec!["--charuco", "DICT_APRILTAG_36h11", "9x7", "--marker", "0.022"],
        ),
    ] {
        let out = directory.path().join(format!("{kind}.toml"));
        let out = out.to_str().unwrap();
        let pictures = pictures(kind, 0..9);
        let mut board = board;
        board.extend(["--place", "0", "--out", out]);
        let made = run(&camera(&board, &pictures));
        assert!(made.status.success(), "{}", errors(&made));
        assert!(
            printed(&made).contains("board seen in 9 of 9 pictures"),
            "{}",
            printed(&made)
        );
        let text = std::fs::read_to_string(out).unwrap();
        assert!(text.contains("focal_px") && text.contains("rotation"), "{text}");
        let room = directory.path().join(format!("{kind}-room.toml"));
        std::fs::write(
            &room,
            format!(
                "[[camera]]\nname = \"a\"\nfile = {:?}\ncalibration = {out:?}\n",
                pictures[0]
            ),
        )
        .unwrap();
        let checked = run(&["check", room.to_str().unwrap()]);
        assert!(!errors(&checked).contains("calibration"), "{}", errors(&checked));
    }
}

#[test]
fn too_few_views_boards_never_seen_and_impossible_boards_are_refused() {
    let few = pictures("chessboard", 0..2);
    let refused = run(&camera(&["--chessboard", "9x7"], &few));
    assert!(!refused.status.success());
    let text = errors(&refused).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        text.contains("in 2 of 2 pictures") && text.contains("take more"),
        "{text}"
    );
    let none = run(&camera(&["--chessboard", "4x3"], &few));
    assert!(errors(&none).contains("in none of 2"), "{}", errors(&none));
    let larger = ["--charuco", "DICT_4X4_50", "9x7", "--marker", "0.05"];
    let impossible = run(&camera(&larger, &few));
    assert!(
        errors(&impossible).contains("side of a marker"),
        "{}",
        errors(&impossible)
    );
}

#[test]
fn an_array_needs_people_who_are_seen() {
    let room = recording().join("room.toml");
    let refused = run(&["calibrate", "array", room.to_str().unwrap(), "--until", "0.3"]);
    assert!(!refused.status.success());
    assert!(errors(&refused).contains("nobody"), "{}", errors(&refused));
}
