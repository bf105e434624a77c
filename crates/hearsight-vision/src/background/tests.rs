use super::*;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;
const TICK: Span = Span::from_nanoseconds(40_000_000);

struct Scene {
    state: u32,
}

impl Scene {
    /// A textured wall, a person (or none) at column `person`, all times `light`, with noise of +-4 levels.
    fn picture(&mut self, person: Option<usize>, light: f32) -> Vec<u8> {
        let mut data = Vec::with_capacity(WIDTH * HEIGHT * 3);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let wall = [120 + (x / 20 % 2) * 8, 110 + (y / 30 % 2) * 8, 100];
                let on = person.is_some_and(|left| (left..left + 24).contains(&x) && y >= 40);
                let colour = if on {
                    [40, 60, 150 + (y / 8 % 2) * 30]
                } else {
                    wall
                };
                for value in colour {
                    self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let noise = (self.state >> 24) as f32 / 32.0 - 4.0;
                    data.push((value as f32 * light + noise).clamp(0.0, 255.0) as u8);
                }
            }
        }
        data
    }
}

fn step(model: &mut BackgroundModel, data: &[u8], mask: &mut Mask) -> BackgroundReport {
    model
        .step(RgbView::new(WIDTH, HEIGHT, data).unwrap(), TICK, mask)
        .unwrap()
}

fn count(mask: &Mask, columns: std::ops::Range<usize>) -> usize {
    mask.data
        .iter()
        .enumerate()
        .filter(|(at, value)| columns.contains(&(at % WIDTH)) && **value > 0)
        .count()
}

#[test]
fn a_person_is_found_and_stays_found_while_standing() {
    let (mut scene, mut mask) = (Scene { state: 1 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    for _ in 0..60 {
        step(&mut model, &scene.picture(None, 1.0), &mut mask);
    }
    assert_eq!(count(&mask, 0..WIDTH), 0);
    for _ in 0..1000 {
        step(&mut model, &scene.picture(Some(70), 1.0), &mut mask);
    }
    assert!(count(&mask, 70..94) > 24 * 75, "{}", count(&mask, 70..94));
    assert_eq!(count(&mask, 0..55) + count(&mask, 110..WIDTH), 0);
}

#[test]
fn a_change_of_exposure_is_no_person() {
    let (mut scene, mut mask) = (Scene { state: 2 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    for _ in 0..60 {
        step(&mut model, &scene.picture(None, 1.0), &mut mask);
    }
    let report = step(&mut model, &scene.picture(Some(70), 1.4), &mut mask);
    assert!((report.gain[0] - 1.4).abs() < 0.05, "{report:?}");
    assert_eq!(count(&mask, 0..55) + count(&mask, 110..WIDTH), 0);
    assert!(count(&mask, 70..94) > 24 * 70);
}

#[test]
fn someone_there_from_the_start_who_leaves_is_forgotten_within_seconds() {
    let (mut scene, mut mask) = (Scene { state: 3 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    for _ in 0..100 {
        step(&mut model, &scene.picture(Some(20), 1.0), &mut mask);
    }
    step(&mut model, &scene.picture(Some(100), 1.0), &mut mask);
    assert!(count(&mask, 20..44) > 24 * 70, "the ghost");
    let mut ghosts = 0;
    for _ in 0..75 {
        ghosts += step(&mut model, &scene.picture(Some(100), 1.0), &mut mask).ghosts;
    }
    assert!(ghosts >= 1);
    assert_eq!(count(&mask, 0..70), 0, "the ghost is gone");
    assert!(count(&mask, 100..124) > 24 * 70, "the person is not");
}

#[test]
fn someone_walking_at_the_start_leaves_no_ghost() {
    let (mut scene, mut mask) = (Scene { state: 4 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions {
        ghost_secs: 0.0,
        ..Default::default()
    })
    .unwrap();
    for i in 0..60 {
        step(&mut model, &scene.picture(Some(i * 2), 1.0), &mut mask);
    }
    step(&mut model, &scene.picture(None, 1.0), &mut mask);
    assert_eq!(count(&mask, 0..WIDTH), 0);
}

#[test]
fn a_shadow_is_no_person() {
    let (mut scene, mut mask) = (Scene { state: 5 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    for _ in 0..60 {
        step(&mut model, &scene.picture(None, 1.0), &mut mask);
    }
    let mut picture = scene.picture(None, 1.0);
    for y in 60..100 {
        for value in &mut picture[(y * WIDTH + 40) * 3..(y * WIDTH + 80) * 3] {
            *value = (f32::from(*value) * 0.7) as u8;
        }
    }
    step(&mut model, &picture, &mut mask);
    assert_eq!(count(&mask, 0..WIDTH), 0);
}

#[test]
fn a_restored_model_continues_identically() {
    let (mut scene, mut mask) = (Scene { state: 6 }, Mask::default());
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    for i in 0..70 {
        step(&mut model, &scene.picture(Some(i), 1.0), &mut mask);
    }
    let saved = serde_json::to_string(model.state()).unwrap();
    let mut restored =
        BackgroundModel::restore(*model.options(), serde_json::from_str(&saved).unwrap()).unwrap();
    let mut other = Mask::default();
    for i in 70..100 {
        let picture = scene.picture(Some(i), 1.1);
        let reports = (
            step(&mut model, &picture, &mut mask),
            step(&mut restored, &picture, &mut other),
        );
        assert_eq!(reports.0, reports.1);
        assert!(mask == other && model.state() == restored.state(), "picture {i}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut model = BackgroundModel::new(BackgroundOptions::default()).unwrap();
    let mut mask = Mask::default();
    step(&mut model, &vec![0; WIDTH * HEIGHT * 3], &mut mask);
    let small = RgbView::new(1, 1, &[0; 3]).unwrap();
    assert!(matches!(
        model.step(small, TICK, &mut mask),
        Err(VisionError::Size { .. })
    ));
    assert!(
        BackgroundModel::new(BackgroundOptions {
            ghost_contrast: f32::NAN,
            ..Default::default()
        })
        .is_err()
    );
    let mut saved = serde_json::to_value(model.state()).unwrap();
    saved["width"] = 7.into();
    let state: BackgroundState = serde_json::from_value(saved).unwrap();
    assert!(BackgroundModel::restore(BackgroundOptions::default(), state).is_err());
}
