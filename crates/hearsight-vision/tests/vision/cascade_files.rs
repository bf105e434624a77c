//! Reading cascades: both formats say the same, damage is named, and nothing makes it panic.

use crate::common::picture;
use hearsight_core::{GrayView, Rectangle};
use hearsight_vision::cascade::{
    Cascade, CascadeDetector, CascadeError, DetectOptions, Mirror, WindowScorer,
};
use proptest::prelude::*;

const NEW: &str = r#"<?xml version="1.0"?>
<opencv_storage>
<cascade type_id="opencv-cascade-classifier"><stageType>BOOST</stageType>
  <featureType>HAAR</featureType>
  <height>9</height>
  <width>12</width>
  <stageNum>2</stageNum>
  <stages>
    <_><maxWeakCount>2</maxWeakCount>
      <stageThreshold>-0.5</stageThreshold>
      <weakClassifiers>
        <_><internalNodes>0 1 0 4.3e-03 -1 -2 1 1.3e-02</internalNodes>
          <leafValues>0.25 -0.75 0.5</leafValues></_>
        <_><internalNodes>0 -1 2 -0.01</internalNodes>
          <leafValues>-0.125 0.25</leafValues></_></weakClassifiers></_>
    <_><stageThreshold>-0.25</stageThreshold>
      <weakClassifiers>
        <_><internalNodes>1 0 3 0.01 -1 -2 4 -0.02</internalNodes>
          <leafValues>0.5 -0.5 0.125</leafValues></_></weakClassifiers></_></stages>
  <features>
    <_><rects><_>0 0 12 9 -1.</_><_>0 0 6 9 2.</_></rects></_>
    <_><rects><_>1 2 6 3 -1.</_><_>3 2 2 3 3.</_></rects><tilted>0</tilted></_>
    <_><rects><_>6 1 3 4 -1.</_><_>6 1 3 2 2.</_></rects><tilted>1</tilted></_>
    <_><rects><_>2 2 6 6 -1.</_><_>2 2 3 3 2.</_><_>5 5 3 3 2.</_></rects></_>
    <_><rects><_>0 3 4 2 -1.</_><_>2 3 2 2 2.</_></rects></_></features></cascade>
</opencv_storage>
"#;

const OLD: &str = r#"<?xml version="1.0"?>
<opencv_storage>
<anything type_id="opencv-haar-classifier">
  <size>12 9</size>
  <stages>
    <_><trees>
        <_>
          <_><feature><rects><_>0 0 12 9 -1.</_><_>0 0 6 9 2.</_></rects><tilted>0</tilted></feature>
            <threshold>4.3e-03</threshold><left_val>0.25</left_val><right_node>1</right_node></_>
          <_><feature><rects><_>1 2 6 3 -1.</_><_>3 2 2 3 3.</_></rects><tilted>0</tilted></feature>
            <threshold>1.3e-02</threshold><left_val>-0.75</left_val><right_val>0.5</right_val></_></_>
        <_>
          <_><feature><rects><_>6 1 3 4 -1.</_><_>6 1 3 2 2.</_></rects><tilted>1</tilted></feature>
            <threshold>-0.01</threshold><left_val>-0.125</left_val><right_val>0.25</right_val></_></_></trees>
      <stage_threshold>-0.5</stage_threshold><parent>-1</parent><next>-1</next></_>
    <_><trees>
        <_>
          <_><feature><rects><_>2 2 6 6 -1.</_><_>2 2 3 3 2.</_><_>5 5 3 3 2.</_></rects><tilted>0</tilted></feature>
            <threshold>0.01</threshold><left_node>1</left_node><right_val>0.5</right_val></_>
          <_><feature><rects><_>0 3 4 2 -1.</_><_>2 3 2 2 2.</_></rects><tilted>0</tilted></feature>
            <threshold>-0.02</threshold><left_val>-0.5</left_val><right_val>0.125</right_val></_></_></trees>
      <stage_threshold>-0.25</stage_threshold></_></stages></anything>
</opencv_storage>
"#;

fn parse(text: &str) -> Result<Cascade, CascadeError> {
    Cascade::parse("faces.xml", text.as_bytes())
}

/// Whatever a cascade says, using it must not panic.
fn run(cascade: &Cascade) {
    let data = picture(41, 33, 1, 5);
    let view = GrayView::new(41, 33, &data).unwrap();
    let options = DetectOptions {
        mirror: Mirror::Both,
        neighbours: 1,
        ..Default::default()
    };
    CascadeDetector::new(cascade.clone(), options)
        .unwrap()
        .detect(view);
    for mirrored in [false, true] {
        let mut scorer = WindowScorer::new(cascade, mirrored);
        for window in [
            Rectangle::new(3.3, 2.1, 20.7, 14.2),
            Rectangle::new(-50.0, -50.0, 200.0, 180.0),
            Rectangle::new(40.9, 32.9, 100.0, 100.0),
            Rectangle::new(7.0, 7.0, 1e-30, 1e-30),
            Rectangle::new(-1e30, -1e30, 2e30, 2e30),
            Rectangle::new(f32::NAN, 0.0, 5.0, 5.0),
            Rectangle::new(0.0, 0.0, 0.0, 0.0),
            Rectangle::new(0.0, 0.0, f32::INFINITY, 5.0),
        ] {
            let score = scorer.score_window(view, &window);
            assert!((0.0..=1.0).contains(&score.inside) && score.stages <= cascade.stages());
        }
        let nothing = GrayView::new(0, 0, &[]).unwrap();
        assert_eq!(
            scorer
                .score_window(nothing, &Rectangle::new(0.0, 0.0, 9.0, 9.0))
                .inside,
            0.0
        );
    }
}

#[test]
fn both_formats_say_the_same() {
    let (new, old) = (parse(NEW).unwrap(), parse(OLD).unwrap());
    assert_eq!(new, old);
    assert_eq!(
        (new.window_size(), new.stages(), new.is_tilted()),
        ((12, 9), 2, true)
    );
    run(&new);
}

#[test]
fn damage_is_named() {
    for (text, from, to, element, problem) in [
        (NEW, "<featureType>HAAR", "<featureType>LBP", "featureType", "LBP"),
        (NEW, "<height>9", "<height>2", "height", "3 to 256"),
        (NEW, "<width>12", "<width>1e9", "width", "3 to 256"),
        (
            NEW,
            "<stageThreshold>-0.5</stageThreshold>",
            "",
            "_",
            "stageThreshold",
        ),
        (
            NEW,
            "-0.25</stageThreshold>",
            "NaN</stageThreshold>",
            "stageThreshold",
            "NaN",
        ),
        (NEW, "0 1 0 4.3e-03", "0 5 0 4.3e-03", "_", "no later node"),
        (NEW, "-1 -2 1 1.3e-02", "0 -3 1 1.3e-02", "_", "no leaf"),
        (NEW, "-1 -2 1 1.3e-02", "-1 -2 1", "internalNodes", "missing"),
        (NEW, "0.25 -0.75 0.5", "0.25 -0.75", "_", "2 leaves for 2 nodes"),
        (NEW, "0 -1 2 -0.01", "0 -1 77 -0.01", "cascade", "feature 77"),
        (NEW, "6 1 3 4 -1.", "6 1 3 6 -1.", "_", "leaves the window"),
        (NEW, "0 0 12 9 -1.", "0 0 13 9 -1.", "_", "leaves the window"),
        (NEW, "0 0 12 9 -1.", "0 0 12 9", "_", "missing"),
        (NEW, "<_>0 0 6 9 2.</_>", "", "rects", "fewer than two"),
        (NEW, "<stages>", "<stages><_/>", "_", "stageThreshold"),
        (OLD, "<size>12 9", "<size>12", "size", "missing"),
        (OLD, "<right_node>1</right_node>", "", "_", "right_node"),
        (OLD, "<right_node>1<", "<right_node>3<", "_", "no later node"),
        (OLD, "<left_node>1<", "<left_node>0<", "left_node", "from 1"),
        (
            OLD,
            "<stage_threshold>-0.25<",
            "<stage_threshold>inf<",
            "stage_threshold",
            "inf",
        ),
        (
            OLD,
            "<opencv_storage>",
            "<opencv_storage><other/>",
            "other",
            "size",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = parse(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(
            error.contains("faces.xml") && error.contains(&format!("<{element}>")) && error.contains(problem),
            "{error}"
        );
    }
}

#[test]
fn what_is_no_cascade_is_refused() {
    for text in [
        "",
        "cascade",
        "<a/>",
        "<opencv_storage/>",
        "<!DOCTYPE a [<!ENTITY b 'c'>]><opencv_storage/>",
    ] {
        assert!(parse(text).is_err(), "{text}");
    }
    assert!(matches!(
        Cascade::parse("x", &[0xff, 0xfe]),
        Err(CascadeError::Xml { .. })
    ));
    let missing = Cascade::load(std::path::Path::new("no/such/file.xml")).unwrap_err();
    assert!(matches!(missing, CascadeError::Read { .. }));
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(old in any::<bool>(), at in 0..2000_usize, bytes in proptest::collection::vec(any::<u8>(), 0..6), cut in 0..4_usize) {
        let mut text = if old { OLD } else { NEW }.as_bytes().to_vec();
        let at = at.min(text.len());
        let end = (at + cut).min(text.len());
        text.splice(at..end, bytes);
        let _ = Cascade::parse("faces.xml", &text);
    }

    /// Digits for digits: files that stay well-formed and go further.
    #[test]
    fn no_numbers_make_it_panic(old in any::<bool>(), changes in proptest::collection::vec((0..2000_usize, 0..10_u8), 1..8)) {
        let mut text = if old { OLD } else { NEW }.as_bytes().to_vec();
        let digits: Vec<usize> = (40..text.len()).filter(|&at| text[at].is_ascii_digit()).collect();
        for (at, digit) in changes {
            text[digits[at % digits.len()]] = b'0' + digit;
        }
        if let Ok(cascade) = Cascade::parse("faces.xml", &text) {
            run(&cascade);
        }
    }
}
