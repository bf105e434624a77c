use super::*;

const SIZE: (usize, usize) = (320, 240);
const TICK: Span = Span::from_nanoseconds(100_000_000);

/// People (x, shirt) on a grey wall, faces 40 pixels wide at row 80.
fn picture(people: &[(f32, [u8; 3])]) -> Vec<u8> {
    let mut rgb = [120, 125, 130].repeat(SIZE.0 * SIZE.1);
    let mut fill = |region: Rectangle, colour: [u8; 3]| {
        for y in region.top.max(0.0) as usize..(region.bottom().max(0.0) as usize).min(SIZE.1) {
            for x in region.left.max(0.0) as usize..(region.right().max(0.0) as usize).min(SIZE.0) {
                rgb[3 * (y * SIZE.0 + x)..][..3].copy_from_slice(&colour);
            }
        }
    };
    for (x, shirt) in people {
        fill(Rectangle::new(x - 40.0, 105.0, 80.0, 100.0), *shirt);
        fill(Rectangle::new(x - 18.0, 56.0, 36.0, 50.0), [205, 160, 130]);
        fill(Rectangle::new(x - 18.0, 44.0, 36.0, 16.0), [50, 35, 25]);
    }
    rgb
}

/// Windows as a cascade gives them: a handful around each face.
fn windows(xs: &[f32]) -> Vec<FaceWindow> {
    let offsets = [
        (0.0, 0.0, 40.0),
        (1.0, -1.0, 42.0),
        (-1.0, 1.0, 38.0),
        (0.0, 1.0, 44.0),
        (1.0, 0.0, 40.0),
    ];
    xs.iter()
        .flat_map(|x| {
            offsets.map(|(dx, dy, width)| FaceWindow {
                x: x + dx,
                y: 80.0 + dy,
                width,
            })
        })
        .collect()
}

struct Run {
    tracker: FaceTracker,
    tick: i64,
    identities: u64,
}

impl Run {
    fn new() -> Self {
        Self {
            tracker: FaceTracker::new(FaceSettings::default(), 3, "faces").unwrap(),
            tick: 0,
            identities: 0,
        }
    }

    fn step(&mut self, people: &[(f32, [u8; 3])], detected: &[f32]) {
        let rgb = picture(people);
        let view = RgbView::new(SIZE.0, SIZE.1, &rgb).unwrap();
        let now = Instant::ZERO + TICK * self.tick;
        self.tick += 1;
        self.tracker.see(view, &windows(detected), now, TICK).unwrap();
        self.tracker.publish(&mut self.identities);
    }

    fn columns(&self) -> Vec<f32> {
        self.tracker
            .published()
            .map(|belief| belief.region.centre().0)
            .collect()
    }
}

const RED: [u8; 3] = [190, 40, 40];
const BLUE: [u8; 3] = [40, 60, 190];

#[test]
fn faces_are_born_followed_and_kept_by_their_colours_when_they_turn_away() {
    let mut run = Run::new();
    for tick in 0..20 {
        let x = 90.0 + 2.0 * tick as f32;
        run.step(&[(x, RED), (240.0, BLUE)], &[x, 240.0]);
    }
    let columns = run.columns();
    assert_eq!(columns.len(), 2);
    assert!(
        (columns[0] - 128.0).abs() < 8.0 && (columns[1] - 240.0).abs() < 5.0,
        "{columns:?}"
    );
    let widths: Vec<f32> = run
        .tracker
        .published()
        .map(|belief| belief.region.width)
        .collect();
    assert!(
        widths.iter().all(|width| (width - 40.0).abs() < 7.0),
        "{widths:?}"
    );
    // The one on the left walks on without windows.
    for tick in 20..40 {
        let x = 90.0 + 2.0 * tick as f32;
        run.step(&[(x, RED), (240.0, BLUE)], &[240.0]);
    }
    let columns = run.columns();
    assert_eq!(columns.len(), 2, "{columns:?}");
    assert!((columns[0] - 168.0).abs() < 14.0, "{columns:?}");
    assert_eq!(
        run.tracker
            .published()
            .map(|belief| belief.identity)
            .collect::<Vec<_>>(),
        [Some(1), Some(2)]
    );
}

#[test]
fn whoever_leaves_is_given_up_and_short_errors_are_never_published() {
    let mut run = Run::new();
    for _ in 0..10 {
        run.step(&[(100.0, RED)], &[100.0]);
    }
    run.step(&[(100.0, RED)], &[100.0, 250.0]);
    for _ in 0..40 {
        run.step(&[], &[]);
    }
    assert!(run.columns().is_empty(), "{:?}", run.columns());
    assert_eq!(run.identities, 1);
}

#[test]
fn a_saved_tracker_goes_on_with_the_same_bytes() {
    let mut first = Run::new();
    for _ in 0..8 {
        first.step(&[(100.0, RED), (220.0, BLUE)], &[100.0, 220.0]);
    }
    let mut second = Run::new();
    let text = serde_json::to_string(first.tracker.state()).unwrap();
    let state: FaceState = serde_json::from_str(&text).unwrap();
    assert!(second.tracker.accepts(&state, first.identities));
    assert!(!second.tracker.accepts(&state, 0));
    second.tracker.set_state(state);
    (second.tick, second.identities) = (first.tick, first.identities);
    for run in [&mut first, &mut second] {
        for _ in 0..5 {
            run.step(&[(104.0, RED), (220.0, BLUE)], &[104.0]);
        }
    }
    assert_eq!(first.tracker.state(), second.tracker.state());
}

#[test]
fn settings_out_of_range_are_named() {
    let mut settings = FaceSettings::default();
    settings.likelihood.base = 0.0;
    let error = FaceTracker::new(settings, 1, "faces").err().unwrap().to_string();
    assert!(error.contains("likelihood.base"), "{error}");
}
