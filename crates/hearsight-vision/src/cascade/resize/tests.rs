use super::*;

#[path = "../../../tests/vision/common.rs"]
mod common;

#[derive(serde::Deserialize)]
struct Goldens {
    resized: Vec<(usize, usize, String)>,
}

#[test]
fn pictures_shrink_as_with_opencv_and_turned_ones_mirror_them() {
    let goldens: Goldens =
        serde_json::from_str(include_str!("../../../tests/goldens/pictures.json")).unwrap();
    let (width, height) = (157, 83);
    let data = common::picture(width, height, 1, 1);
    let mut turned_data = data.clone();
    turned_data.chunks_exact_mut(width).for_each(<[u8]>::reverse);
    let (view, turned_view) = (
        GrayView {
            width,
            height,
            data: &data,
        },
        GrayView {
            width,
            height,
            data: &turned_data,
        },
    );
    let (mut resizer, mut out, mut turned) = (Resizer::default(), Vec::new(), Vec::new());
    for (to_width, to_height, golden) in goldens.resized {
        resizer.resize(view, to_width, to_height, false, &mut out);
        assert_eq!(
            common::checksum(out.iter().copied()),
            golden,
            "{to_width} x {to_height}"
        );
        resizer.resize(turned_view, to_width, to_height, true, &mut turned);
        assert_eq!(out, turned, "{to_width} x {to_height} turned twice");
    }
}

#[test]
fn the_smallest_pictures_are_no_exception() {
    let (mut resizer, mut out) = (Resizer::default(), Vec::new());
    for (width, height) in [(0, 0), (1, 1), (1, 5), (5, 1), (2, 2)] {
        let data = vec![77; width * height];
        for turned in [false, true] {
            resizer.resize(
                GrayView {
                    width,
                    height,
                    data: &data,
                },
                3,
                4,
                turned,
                &mut out,
            );
            assert!(
                out.iter()
                    .all(|&value| value == if data.is_empty() { 0 } else { 77 })
            );
        }
    }
}
