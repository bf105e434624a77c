//! The scenes of the papers' experiments can be written: each names what it needs and resolves.

use crate::common::world;
use hearsight_sim::world::{NoisePlace, World};

fn duration_of_faces(world: &World, camera: usize, until: f64) -> usize {
    let controls = world.controls().unwrap();
    let device = &world.cameras[camera];
    (0..(until * 10.0) as usize)
        .filter(|step| {
            let time = *step as f64 * 0.1;
            let view = controls.camera(device, camera, &world.bases, time).unwrap();
            let head = world.posture(0, time).map(|posture| posture.head);
            head.is_some_and(|head| view.project_inside(head).is_some())
        })
        .count()
}

/// Closed loop, Seq. A: a head that jerks, a hand that sweeps across the face, a turn by 150 degrees.
#[test]
fn one_person_who_is_hard_to_follow() {
    let text = r#"
seconds = 46
[room]
size = [4, 4, 2.6]
clutter = 6
[[person]]
name = "user"
at = [2, 2]
facing = -90
[[person.action]]
time = 2
walk = [[2.2, 2.1]]
speed = 0.3
[[person.action]]
time = 6
turn = -90
[[person.action]]
time = 10
jerk = [0.45, 0]
seconds = 0.3
[[person.action]]
time = 10.5
jerk = [-0.45, 0]
seconds = 0.3
[[person.action]]
time = 23.3
gesture = "hand_before_face"
seconds = 3.4
rate = 0.8
[[person.action]]
time = 34.6
turn = 60
seconds = 2
[[camera]]
name = "desk"
size = [320, 240]
rate = 15
at = [2, 0.4, 1.5]
look_at = [2, 2, 1.5]
exposure_changes = [[30, 1.4], [33, 1.0]]
"#;
    let world = world(text);
    assert!(duration_of_faces(&world, 0, 46.0) > 450);
    let yaw = |time: f64| world.posture(0, time).unwrap().head_yaw_rad.to_degrees();
    assert!((yaw(34.0) + 90.0).abs() < 40.0 && (yaw(40.0) - 60.0).abs() < 15.0);
    // 20 pixels a frame and more at the height of the jerk.
    let device = &world.cameras[0];
    let camera = world.controls().unwrap().camera(device, 0, &[], 0.0).unwrap();
    let column = |time: f64| camera.project(world.posture(0, time).unwrap().head).unwrap().u;
    let fastest = (0..20).map(|step| 10.0 + f64::from(step) * 0.02);
    let fastest = fastest
        .map(|time| (column(time + 1.0 / 15.0) - column(time)).abs())
        .fold(0.0, f64::max);
    assert!(fastest > 18.0, "{fastest}");
}

/// Closed loop, Seq. B: five cameras around one point, six who sit around it, eight microphones in a ring, lost sound.
#[test]
fn a_meeting_around_a_ring_of_cameras() {
    let mut text = String::from(
        "seconds = 120\n[room]\nsize = [6, 6, 2.7]\nt60 = 0.5\n\
         [[camera]]\nname = \"ring\"\nsize = [320, 240]\nring = 5\nview = 75\nat = [3, 3, 1.1]\n\
         [[camera]]\nname = \"all\"\nlens = \"panorama\"\nsize = [1500, 240]\nat = [3, 3, 1.1]\n\
         [[array]]\ncount = 8\nradius = 0.15\nat = [3, 3, 0.8]\nlost_share = 0.3\n\
         [[noise]]\nkind = \"fan\"\nat = [0.5, 0.5, 2]\nsnr = 10\n\
         [[noise]]\nkind = \"television\"\nat = [5.5, 3, 1]\nsnr = 10\n\
         [[conversation]]\nturns = { overlap = 0.1 }\n",
    );
    for seat in 0..6 {
        let angle = f64::from(seat) * 60.0;
        let (sin, cos) = angle.to_radians().sin_cos();
        text += &format!(
            "[[person]]\nsit = \"here\"\nat = [{:.3}, {:.3}]\nfacing = [3, 3]\nlook = \"speaker\"\n",
            3.0 + 1.6 * cos,
            3.0 + 1.6 * sin
        );
    }
    let world = world(&text);
    assert_eq!(
        (
            world.cameras.len(),
            world.people.len(),
            world.arrays[0].microphones.len()
        ),
        (6, 6, 8)
    );
    let lost: f64 = world.arrays[0].lost.iter().map(|span| span[1] - span[0]).sum();
    assert!((lost / 120.0 - 0.3).abs() < 0.05, "{lost}");
    assert!(world.people.iter().all(|person| !person.turns.is_empty()));
}

/// Three microphones: a living room with a camera in its corner, sitting people, and everything that is no speech.
#[test]
fn a_living_room() {
    let text = r#"
seconds = 60
[room]
size = [5.5, 4.5, 2.7]
t60 = 0.5
[[furniture]]
kind = "sofa"
name = "sofa"
at = [4.6, 2.6]
turn = 180
[[person]]
name = "a"
sit = "sofa"
look = "speaker"
[[person]]
name = "b"
sit = "here"
at = [3.0, 3.2]
look = "speaker"
[[person]]
name = "child"
height = 1.1
sit = "here"
at = [2.2, 2.8]
[[conversation]]
[[noise]]
kind = "telephone"
at = [5, 4, 0.8]
during = [[10, 13]]
[[noise]]
kind = "cough"
person = "b"
during = [[20, 21]]
[[noise]]
kind = "laugh"
person = "a"
during = [[30, 32]]
[[noise]]
kind = "fan"
at = [0.4, 4.2, 2.3]
snr = 15
[[noise]]
kind = "white"
snr = 25
[[camera]]
name = "corner"
size = [1600, 1200]
rate = 10
focal = 1040
at = [0.3, 0.1, 1.8]
look_at = [4, 3, 1.1]
[[array]]
shape = "line"
count = 3
spacing = 0.2
at = [2.75, 0.1, 0.9]
facing = 90
rate = 44100
"#;
    let world = world(text);
    assert!(duration_of_faces(&world, 0, 60.0) > 590);
    let place = world.arrays[0].microphones[0];
    assert!((place.0.x - 2.55).abs() < 1e-9);
    assert!(matches!(world.noises[1].place, NoisePlace::Person(1)));
    assert_eq!(world.noises[4].place, NoisePlace::Diffuse);
}

/// Smart room: corner cameras and a fisheye above, people who come, walk, sit and leave, close-up cameras, an array whose
/// clock runs too fast.
#[test]
fn a_smart_room() {
    let mut text = String::from(
        "seconds = 60\n[room]\nsize = [7, 6, 3]\nt60 = 0.4\n[[room.door]]\nat = [7, 3]\n\
         [[furniture]]\nkind = \"chair\"\nname = \"chair\"\nat = [2, 4]\nturn = -90\n\
         [[camera]]\nname = \"top\"\nlens = \"fisheye\"\nview = 190\nsize = [640, 640]\nat = [3.5, 3, 2.95]\ntilt = -90\n\
         [[camera]]\nname = \"ptz\"\nat = [6.5, 0.5, 2.2]\nlook_at = [3, 3, 1.5]\nhead = {}\n\
         [[camera.command]]\ntime = 5\npan_speed = 60\n[[camera.command]]\ntime = 6\n\
         [[array]]\nname = \"a\"\nshape = \"line\"\nat = [3.5, 0.1, 1.5]\nfacing = 90\nclock = { drift = 50 }\n",
    );
    for (number, at) in ["0.1, 0.1", "6.9, 0.1", "6.9, 5.9", "0.1, 5.9"]
        .iter()
        .enumerate()
    {
        text += &format!(
            "[[camera]]\nname = \"corner{number}\"\nat = [{at}, 2.7]\nlook_at = [3.5, 3, 1]\nview = 80\n\
             distortion = [-0.2, 0.05]\n"
        );
    }
    text += "[[person]]\nname = \"p\"\n[[person.action]]\ntime = 1\nenter = \"door\"\nwalk = [[4, 3], [2.1, 3.2]]\n\
             [[person.action]]\ntime = 12\nsit = \"chair\"\n[[person.action]]\ntime = 25\nwander = [[1, 1], [6, 3]]\n\
             until = 50\n[[person.action]]\ntime = 52\nleave = \"door\"\n\
             [[person]]\nname = \"q\"\nat = [5, 1.5]\n[[person.action]]\ntime = 0\nwander = [[3.5, 0.8], [6, 2.4]]\nuntil = 60\n";
    let world = world(&text);
    assert_eq!(world.cameras.len(), 6);
    assert!(
        world.posture(0, 0.5).is_none()
            && world.posture(0, 20.0).is_some()
            && world.posture(0, 59.9).is_none()
    );
    let controls = world.controls().unwrap();
    assert!((controls.head(1, 10.0)[0].to_degrees() - 60.0).abs() < 8.0);
}

/// Humanoid: a stereo head on a robot that drives and pans, a desk that hides legs, exits.
#[test]
fn a_robot() {
    let text = r#"
seconds = 40
[room]
size = [8, 6, 3]
[[room.door]]
at = [8, 5]
[[furniture]]
kind = "table"
name = "desk"
at = [4, 2.2]
[[base]]
name = "robot"
at = [1, 3]
facing = 0
[[base.action]]
time = 20
walk = [[2, 3]]
[[camera]]
name = "eyes"
size = [320, 240]
stereo = 0.09
base = "robot"
at = [0.1, 0, 1.4]
view = 70
head = { pan_speed = 40 }
shutter = 0.03
[[array]]
name = "ears"
count = 4
base = "robot"
at = [0.1, 0, 1.3]
[[noise]]
kind = "motor"
base = "robot"
level = -40
[[person]]
name = "p"
at = [3, 3]
turns = [[1, 5]]
[[person.action]]
time = 2
walk = [[5, 3.5], [7, 4]]
[[person.action]]
time = 15
leave = "door"
[[person.action]]
time = 25
enter = "door"
walk = [[5, 4]]
"#;
    let world = world(text);
    assert_eq!(world.cameras.len(), 2);
    assert!(duration_of_faces(&world, 0, 15.0) > 100);
    assert!(matches!(world.noises[0].place, NoisePlace::Base(0, _)));
}
