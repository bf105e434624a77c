//! Devices: where sensors are, and that they obey.

use crate::common::world;
use hearsight_core::command::{DeviceCommand, DeviceOrder};
use hearsight_core::{Instant, WorldPoint};
use hearsight_sim::simulation::Simulation;

const ROOM: &str = r#"
seconds = 20
[[base]]
name = "robot"
at = [2, 2]
facing = 90
[[base.action]]
time = 1
walk = [[2, 4]]
[[camera]]
name = "head"
base = "robot"
at = [0.1, 0, 1.2]
size = [320, 240]
stereo = 0.09
[[camera]]
name = "ptz"
at = [0.5, 0.5, 2.2]
look_at = [3, 2.5, 1.2]
head = {}
[[camera.command]]
time = 2
pan = 40
zoom = 2
[[camera]]
name = "ring"
at = [3, 2.5, 1]
ring = 5
view = 75
[[array]]
name = "ears"
base = "robot"
shape = "pair"
at = [0, 0, 1.2]
"#;

#[test]
fn sensors_are_carried_and_heads_obey() {
    let world = world(ROOM);
    let names: Vec<&str> = world.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "head-left",
            "head-right",
            "ptz",
            "ring-1",
            "ring-2",
            "ring-3",
            "ring-4",
            "ring-5"
        ]
    );
    let controls = world.controls().unwrap();
    let camera = |number: usize, time: f64| {
        controls
            .camera(&world.cameras[number], number, &world.bases, time)
            .unwrap()
    };
    // The robot looks along y: its left camera is at the smaller x.
    let (left, right) = (camera(0, 0.0), camera(1, 0.0));
    assert!((left.centre().0.x - 1.955).abs() < 1e-9 && (right.centre().0.x - 2.045).abs() < 1e-9);
    assert!((camera(0, 19.0).centre().0.y - 4.1).abs() < 1e-9);
    let ahead = left.project_inside(WorldPoint::new(1.955, 4.5, 1.2)).unwrap();
    assert!((ahead.u - 159.5).abs() < 1e-6 && (ahead.v - 119.5).abs() < 1e-6);
    let mut ears = [WorldPoint::new(0.0, 0.0, 0.0); 2];
    controls.microphones(&world.arrays[0], &world.bases, 0.0, &mut ears);
    assert!(
        (ears[0].0.x - 1.9).abs() < 1e-9 && (ears[1].0.x - 2.1).abs() < 1e-9,
        "{ears:?}"
    );
    // 40 degrees at 80 degrees a second, after the latency.
    assert_eq!(controls.head(2, 2.05), [0.0, 0.0, 1.0]);
    let middle = controls.head(2, 2.3)[0].to_degrees();
    assert!((10.0..20.0).contains(&middle), "{middle}");
    let end = controls.head(2, 3.0);
    assert!((end[0].to_degrees() - 40.0).abs() < 1e-9 && (end[2] - 2.0).abs() < 1e-9);
    let wide = camera(2, 0.0).horizontal_field_of_view_rad().unwrap();
    let tele = camera(2, 5.0).horizontal_field_of_view_rad().unwrap();
    assert!(((wide / 2.0).tan() / (tele / 2.0).tan() - 2.0).abs() < 1e-9);
    // The ring looks all round, from around one point.
    let yaw = |number: usize| {
        let ahead = camera(number, 0.0)
            .ray(hearsight_core::DistortedPixel::new(319.5, 239.5))
            .unwrap();
        ahead.direction.y.atan2(ahead.direction.x).to_degrees()
    };
    assert!((yaw(4) - yaw(3) - 72.0).abs() < 1e-6);
}

#[test]
fn commands_from_outside_change_what_follows_and_nothing_before() {
    let world = world(ROOM);
    let mut controls = world.controls().unwrap();
    let before = controls.clone();
    let send = |controls: &mut hearsight_sim::world::Controls, time: f64, device: &str, order| {
        let command = DeviceCommand {
            time: Instant::from_seconds(time),
            device: device.to_owned(),
            order,
        };
        controls.send(&world.cameras, &world.bases, &command)
    };
    let turn = DeviceOrder::Turn {
        pan_rad_s: -0.5,
        tilt_rad_s: 0.1,
        zoom_per_s: 0.0,
    };
    send(&mut controls, 5.0, "ptz", turn).unwrap();
    send(&mut controls, 6.0, "ptz", DeviceOrder::Stop).unwrap();
    for number in 0..506 {
        let time = f64::from(number) * 0.01;
        assert_eq!(controls.head(2, time), before.head(2, time));
    }
    let turned = controls.head(2, 8.0)[0] - before.head(2, 8.0)[0];
    assert!((turned + 0.5).abs() < 0.02, "{turned}");
    let drive = DeviceOrder::Drive {
        forward_m_s: 0.5,
        turn_rad_s: std::f64::consts::FRAC_PI_2,
    };
    send(&mut controls, 9.9, "robot", drive).unwrap();
    send(&mut controls, 10.9, "robot", DeviceOrder::Stop).unwrap();
    let [x, y, yaw] = controls.base(&world.bases, 0, 15.0);
    // A quarter of a turn would take more than it can: 60 degrees a second.
    let angle = 60.0_f64.to_radians();
    let radius = 0.5 / angle;
    assert!((yaw - std::f64::consts::FRAC_PI_2 - angle).abs() < 1e-9);
    assert!((x - (2.0 - radius * (1.0 - angle.cos()))).abs() < 1e-9, "{x}");
    assert!((y - (4.0 + radius * angle.sin())).abs() < 1e-9, "{y}");
    assert!(send(&mut controls, 12.0, "ring-1", turn).is_err());
    assert!(send(&mut controls, 12.0, "nobody", DeviceOrder::Stop).is_err());
}

#[test]
fn a_camera_obeys_while_it_films() {
    let text = r#"
seconds = 2
[room]
size = [5, 4, 2.6]
[[person]]
at = [2.5, 2.8]
[[camera]]
name = "ptz"
size = [96, 72]
rate = 10
at = [2.5, 0.3, 1.5]
look_at = [2.5, 3, 1.3]
head = { latency = 0.12 }
"#;
    let film = |order: Option<DeviceOrder>| {
        let simulation = Simulation::new(world(text)).unwrap();
        let mut camera = simulation.camera(0);
        let mut pictures = Vec::new();
        for frame in 0..20 {
            if let (5, Some(order)) = (frame, order) {
                let command = DeviceCommand {
                    time: camera.time(frame),
                    device: "ptz".to_owned(),
                    order,
                };
                simulation.send(&command).unwrap();
            }
            pictures.push(camera.shoot().unwrap().1.clone());
        }
        assert!(camera.shoot().is_none());
        pictures
    };
    let aim = DeviceOrder::Aim {
        pan_rad: 0.4,
        tilt_rad: 0.0,
        zoom: 1.5,
    };
    let (still, moved) = (film(None), film(Some(aim)));
    // The command of frame 5 (0.5 s) is obeyed from 0.62 s on.
    for (number, (one, other)) in still.iter().zip(&moved).enumerate() {
        assert_eq!(one == other, number <= 6, "frame {number}");
    }
    let head = |picture: &hearsight_sim::render::Picture| picture.sights[0].head.unwrap().whole;
    let (before, after) = (head(&still[19]), head(&moved[19]));
    // Turned to the left, the person moves to the right, and larger they are.
    assert!(
        after.left > before.left + 10.0 && after.height > 1.3 * before.height,
        "{before:?} {after:?}"
    );
}
