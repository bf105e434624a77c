//! What cameras see and what the truth says of it are one thing, for any number of threads.

use crate::common::world;
use hearsight_core::VideoFrame;
use hearsight_core::WorldPoint;
use hearsight_core::source::{Delivery, VideoSource};
use hearsight_sim::simulation::{Files, Simulation, mot_rows};

const SCENE: &str = r#"
name = "two"
seconds = 1.2
[room]
size = [5, 4, 2.6]
[[room.door]]
at = [0, 2]
[[person]]
name = "anna"
at = [1.8, 2.8]
turns = [[0.2, 0.7]]
[[person.action]]
time = 0.1
walk = [[3.2, 2.6]]
[[person]]
name = "bob"
at = [3.4, 3.2]
[[person]]
name = "carl"
[[person.action]]
time = 30
enter = "door"
[[noise]]
kind = "fan"
name = "fan"
at = [1, 1, 2]
during = [[0.5, 1.0]]
[[camera]]
name = "front"
size = [160, 120]
rate = 10
at = [2.5, 0.3, 1.5]
look_at = [2.5, 3, 1.4]
[[camera]]
name = "side"
size = [161, 99]
rate = 5
at = [4.7, 3.7, 1.9]
look_at = [2, 2, 1.3]
clock = { offset = 0.05, drift = 40, declared = true }
"#;

fn simulation() -> Simulation {
    Simulation::new(world(SCENE)).unwrap()
}

#[test]
fn heads_are_where_the_truth_says() {
    let simulation = simulation();
    let controls = simulation.world().controls().unwrap();
    let mut cameras = [simulation.camera(0), simulation.camera(1)];
    let mut frame = VideoFrame::default();
    let mut faults = Vec::new();
    let (mut seen, mut spoken) = ([0, 0], 0);
    assert_eq!(simulation.ticks(), 12);
    for tick in 0..simulation.ticks() {
        let time = simulation.tick_time(tick);
        assert_eq!(cameras[0].read(&mut frame, &mut faults), Delivery::Data);
        assert_eq!((frame.number, frame.time), (tick + 1, time));
        if tick % 2 == 1 {
            assert_eq!(cameras[1].read(&mut frame, &mut faults), Delivery::Data);
            assert!(frame.time <= time && (time - frame.time).seconds() < 0.1);
        }
        let record = simulation.truth(tick);
        assert_eq!(record.people.len(), 3);
        assert!(!record.people[2].present && record.people[2].views.is_empty());
        assert_eq!(record.sounds[0].sounding, (0.5..1.0).contains(&record.time_s));
        // Speech begins and ends a little within its turn, and pauses are silence.
        let speaking = record.people[0].speaking;
        assert!(
            !speaking || (0.2..0.7).contains(&record.time_s),
            "{}",
            record.time_s
        );
        spoken += u32::from(speaking);
        for person in &record.people[..2] {
            let head = person.head_m.map(|[x, y, z]| WorldPoint::new(x, y, z)).unwrap();
            for view in &person.views {
                let number = usize::from(view.camera == "side");
                seen[number] += 1;
                let device = &simulation.world().cameras[number];
                let camera = controls.camera(device, number, &[], record.time_s).unwrap();
                let (centre, shown) = (camera.project(head).unwrap(), view.head.unwrap());
                let [u, v] = [
                    shown.left + shown.width / 2.0 - 0.5,
                    shown.top + shown.height / 2.0 - 0.5,
                ];
                let near = 0.35 * shown.height + if number == 1 { 6.0 } else { 1.0 };
                assert!(
                    (u - centre.u).hypot(v - centre.v) < near,
                    "{} {view:?} {centre:?}",
                    record.time_s
                );
                assert!((0.0..=1.0).contains(&view.head_visible) && view.body.is_some());
            }
        }
        let rows = mot_rows(&record, "front");
        assert_eq!(rows.lines().count(), 2, "{rows}");
        assert!(
            rows.starts_with(&format!("{},1,", tick + 1)) && rows.ends_with('\n'),
            "{rows}"
        );
    }
    assert_eq!(cameras[0].read(&mut frame, &mut faults), Delivery::End);
    assert!(seen[0] == 24 && seen[1] >= 6, "{seen:?}");
    assert!(spoken >= 2, "{spoken}");
    assert!(faults.is_empty());
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let pictures = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut camera = simulation().camera(1);
            let mut all = Vec::new();
            while let Some((_, picture)) = camera.shoot() {
                all.push(picture.clone());
            }
            all
        })
    };
    let (one, two) = (pictures(1), pictures(2));
    assert_eq!(one.len(), 6);
    assert!(one == two);
    assert!(one[0].luma != one[1].luma);
}

#[test]
fn the_room_file_tells_what_may_be_known() {
    let text = simulation().room_file(&Files::default());
    for wanted in [
        "name = \"two\"",
        "file = \"front.mov\"",
        "file = \"side.mov\"",
        "start = 0.05",
        "drift = 40.0",
        "model = \"pinhole\"",
    ] {
        assert!(text.contains(wanted), "no {wanted} in {text}");
    }
    assert!(!text.contains("anna"));
    let without = simulation().room_file(&Files {
        video: None,
        sound: Some("wav"),
    });
    assert!(!without.contains("[[camera]]"));
}
