//! Pictures of the simulated room against the cameras' own projections.

#![expect(clippy::unwrap_used, reason = "tests may panic")]

use hearsight_core::camera::{
    Fisheye, FisheyeParameters, Panorama, PanoramaParameters, Pinhole, PinholeParameters,
};
use hearsight_core::{Camera, CameraModel, Pose, WorldPoint};
use hearsight_sim::render::{Person, Picture, Range, Renderer, SensorNoise, Shot};
use hearsight_sim::world::{Block, Hair, Light, Limb, Looks, Material, Pattern, Posture, Setting, Wear};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const SILENT: SensorNoise = SensorNoise { dark: 0.0, shot: 0.0 };

fn plain(grey: f32) -> Material {
    Material {
        colour: [grey; 3],
        second: [grey; 3],
        pattern: Pattern::Plain,
        scale_m: 0.3,
        seed: 1,
    }
}

fn room() -> Setting {
    Setting {
        size_m: [8.0, 6.0, 3.0],
        origin: WorldPoint::new(0.0, 0.0, 0.0),
        surfaces: [plain(0.3); 6],
        blocks: vec![],
        lights: vec![Light {
            position: WorldPoint::new(1.0, 3.0, 2.8),
            colour: [1.5; 3],
        }],
        ambient: [0.5; 3],
    }
}

fn looks() -> Looks {
    Looks {
        height_m: 1.75,
        build: 1.0,
        head_half_axes_m: [0.1, 0.078, 0.118],
        skin: [0.6, 0.4, 0.3],
        hair: [0.05, 0.03, 0.02],
        hair_style: Hair::Bald,
        eyes: [0.1, 0.1, 0.2],
        wear: Wear {
            top: plain(0.05),
            bottom: plain(0.02),
            long_sleeves: true,
        },
        face: None,
        seed: 4,
    }
}

/// Upright at (x, y), looking along `yaw`.
fn standing(x: f64, y: f64, yaw: f64) -> Posture {
    let (sine, cosine) = yaw.sin_cos();
    let at = |left: f64, up: f64| WorldPoint::new(x - sine * left, y + cosine * left, up);
    let limb = |side: f64, points: [(f64, f64); 3]| {
        let [root, joint, end] = points.map(|(left, up)| at(side * left, up));
        Limb { root, joint, end }
    };
    Posture {
        head: at(0.0, 1.63),
        head_yaw_rad: yaw,
        head_pitch_rad: 0.0,
        head_roll_rad: 0.0,
        neck: at(0.0, 1.45),
        pelvis: at(0.0, 0.93),
        torso_yaw_rad: yaw,
        arms: [1.0, -1.0].map(|side| limb(side, [(0.2, 1.41), (0.23, 1.1), (0.24, 0.85)])),
        legs: [1.0, -1.0].map(|side| limb(side, [(0.1, 0.9), (0.1, 0.5), (0.1, 0.07)])),
        mouth_opening: 0.0,
        blink: 0.0,
    }
}

fn pinhole(radial: [f64; 3]) -> CameraModel {
    let parameters = PinholeParameters {
        focal_px: [500.0; 2],
        centre_px: [319.5, 239.5],
        radial,
        tangential: [0.0; 2],
    };
    CameraModel::Pinhole(Pinhole::new(parameters).unwrap())
}

fn camera(model: CameraModel, from: [f64; 3], to: [f64; 3]) -> Camera {
    let pose = Pose::looking_at(WorldPoint(from.into()), WorldPoint(to.into())).unwrap();
    Camera {
        model,
        pose,
        width: 640,
        height: 480,
    }
}

fn shot<'a>(camera: &'a Camera, people: &'a [Person<'a>]) -> Shot<'a> {
    Shot {
        view: 0,
        frame: 3,
        camera,
        closing_pose: None,
        people,
        lamps: &[],
        exposure: 1.0,
        white_balance: [1.0; 3],
        noise: SILENT,
        range: Range::Full,
    }
}

fn picture(setting: &Setting, shot: &Shot<'_>) -> Picture {
    let mut picture = Picture::default();
    Renderer::new(setting, 7).render(shot, &mut picture);
    picture
}

fn still<'a>(looks: &'a Looks, posture: &'a Posture) -> Person<'a> {
    Person {
        looks,
        opening: posture,
        closing: posture,
    }
}

/// Left, top, right, bottom of the pixels in which two pictures differ, edges.
fn difference(one: &Picture, other: &Picture) -> [f64; 4] {
    let mut edges = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for (place, (a, b)) in one.luma.iter().zip(&other.luma).enumerate() {
        if a.abs_diff(*b) > 6 {
            let (x, y) = ((place % one.width) as f64, (place / one.width) as f64);
            edges = [
                edges[0].min(x),
                edges[1].min(y),
                edges[2].max(x + 1.0),
                edges[3].max(y + 1.0),
            ];
        }
    }
    edges
}

#[test]
fn a_head_is_where_the_camera_says() {
    let (looks, posture) = (looks(), standing(4.0, 3.0, PI));
    let people = [still(&looks, &posture)];
    // Only the head is in the picture.
    for model in [pinhole([0.0; 3]), pinhole([-0.25, 0.08, 0.0])] {
        let mut camera = camera(model, [2.0, 3.0, 1.75], [4.0, 3.1, 1.9]);
        camera.height = 345;
        let taken = picture(&room(), &shot(&camera, &people));
        let empty = picture(&room(), &shot(&camera, &[]));
        let head = taken.sights[0].head.unwrap();
        let shown = difference(&taken, &empty);
        let whole = head.whole;
        // What differs from the empty room is the head down to the neck, within the truth's box.
        for (shown, told) in shown.iter().zip([whole.left, whole.top, whole.right()]) {
            assert!((shown - f64::from(told)).abs() <= 1.0, "{shown:?} {whole:?}");
        }
        // The box is that of the ellipsoid: crown and middle.
        let [forward, left, up] = looks.head_half_axes_m;
        let (mut top, mut bottom, mut sides) = (
            f64::INFINITY,
            f64::NEG_INFINITY,
            [f64::INFINITY, f64::NEG_INFINITY],
        );
        for step in 0..200_u32 {
            for turn in 0..200_u32 {
                let (polar, around) = (f64::from(step) / 199.0 * PI, f64::from(turn) / 200.0 * TAU);
                let offset = Vector3::new(
                    forward * polar.sin() * around.cos(),
                    left * polar.sin() * around.sin(),
                    up * polar.cos(),
                );
                let pixel = camera.project(WorldPoint(posture.head.0 + offset)).unwrap();
                (top, bottom) = (top.min(pixel.v), bottom.max(pixel.v));
                sides = [sides[0].min(pixel.u), sides[1].max(pixel.u)];
            }
        }
        assert!(
            (f64::from(whole.top) - (top + 0.5)).abs() < 1.0,
            "{} {top}",
            whole.top
        );
        // A chin is in front of where the ellipsoid ends, which seen from above is a little lower.
        assert!(
            (-1.0..3.0).contains(&(f64::from(whole.bottom()) - (bottom + 0.5))),
            "{} {bottom}",
            whole.bottom()
        );
        let middle = (sides[0] + sides[1]) / 2.0 + 0.5;
        assert!(
            (f64::from(whole.centre().0) - middle).abs() < 1.0,
            "{whole:?} {middle}"
        );
        assert!(head.visible > 0.99, "{head:?}");
    }
}

#[test]
fn half_of_somebody_behind_a_wall_or_outside_is_half_visible() {
    let (looks, posture) = (looks(), standing(5.0, 3.0, PI));
    let people = [still(&looks, &posture)];
    let ahead = camera(pinhole([-0.2, 0.05, 0.0]), [1.0, 3.0, 1.2], [5.0, 3.0, 1.0]);
    let mut walled = room();
    walled.blocks.push(Block {
        name: "wall".into(),
        centre: WorldPoint::new(3.0, 4.0, 1.5),
        size_m: [0.2, 2.0, 3.0],
        yaw_rad: 0.0,
        material: plain(0.8),
    });
    let aside = Camera { width: 320, ..ahead };
    for (setting, camera) in [(walled, ahead), (room(), aside)] {
        let sight = picture(&setting, &shot(&camera, &people)).sights[0];
        for extent in [sight.head.unwrap(), sight.body.unwrap()] {
            assert!((extent.visible - 0.5).abs() < 0.03, "{extent:?}");
            assert!(extent.inside.width <= extent.whole.width);
        }
    }
    // Somebody in front hides whoever is behind; alone, everybody is seen.
    let nearer = standing(4.0, 3.0, 0.0);
    let both = [still(&looks, &posture), still(&looks, &nearer)];
    let sights = picture(&room(), &shot(&ahead, &both)).sights;
    assert!(
        sights[0].body.unwrap().visible < 0.2 && sights[1].body.unwrap().visible > 0.99,
        "{sights:?}"
    );
}

#[test]
fn straight_edges_bend_as_the_lens_says() {
    let mut setting = room();
    setting.blocks.push(Block {
        name: "table".into(),
        centre: WorldPoint::new(4.5, 3.0, 1.0),
        size_m: [1.0, 4.0, 2.0],
        yaw_rad: 0.0,
        material: plain(0.9),
    });
    let panorama = Panorama::new(PanoramaParameters {
        columns_per_turn: 1600.0,
        focal_px: 300.0,
        centre_px: [319.5, 239.5],
    });
    let fisheye = Fisheye::new(FisheyeParameters {
        focal_px: [300.0; 2],
        centre_px: [319.5, 239.5],
        radial: [-0.02, 0.001, 0.0, 0.0],
    });
    let models = [
        pinhole([-0.3, 0.1, 0.0]),
        pinhole([0.2, 0.0, 0.0]),
        CameraModel::Panorama(panorama.unwrap()),
        CameraModel::Fisheye(fisheye.unwrap()),
    ];
    for model in models {
        let camera = camera(model, [2.0, 3.0, 1.3], [4.0, 3.0, 1.4]);
        let taken = picture(&setting, &shot(&camera, &[]));
        let mut rows = Vec::new();
        for step in -10..=10 {
            // The upper edge of the table's front.
            let edge = WorldPoint::new(4.0, 3.0 + 0.09 * f64::from(step), 2.0);
            let pixel = camera.project_inside(edge).unwrap();
            let column = pixel.u.round() as usize;
            let luma = |row: usize| f64::from(taken.luma[row * 640 + column]);
            let row = pixel.v.round() as usize;
            let (above, below) = (luma(row - 4), luma(row + 4));
            let half = (above + below) / 2.0;
            let crossing = (row - 4..row + 4)
                .find(|row| (luma(*row) - half) * (luma(*row + 1) - half) <= 0.0)
                .unwrap();
            let share = (half - luma(crossing)) / (luma(crossing + 1) - luma(crossing));
            let found = crossing as f64 + share;
            assert!((above - below).abs() > 20.0, "{model:?} at {step}: no edge");
            assert!(
                (found - pixel.v).abs() < 0.7,
                "{model:?} at {step}: {found} is not {}",
                pixel.v
            );
            rows.push(pixel.v);
        }
        let sag = rows[10] - (rows[0] + rows[20]) / 2.0;
        assert!(sag.abs() > 1.5, "{model:?} bends: {sag}");
    }
}

#[test]
fn whoever_moves_is_smeared_along_the_way() {
    let looks = looks();
    let (from, to) = (standing(4.0, 2.9, PI), standing(4.0, 3.1, PI));
    let middle = standing(4.0, 3.0, PI);
    let mut camera = camera(pinhole([0.0; 3]), [2.0, 3.0, 1.75], [4.0, 3.0, 1.9]);
    camera.height = 380;
    let empty = picture(&room(), &shot(&camera, &[]));
    let moving = [Person {
        looks: &looks,
        opening: &from,
        closing: &to,
    }];
    let resting = [still(&looks, &middle)];
    let (moved, rested) = (
        picture(&room(), &shot(&camera, &moving)),
        picture(&room(), &shot(&camera, &resting)),
    );
    let [blurred, sharp] = [&moved, &rested].map(|taken| difference(taken, &empty));
    // 0.2 m at 2 m are 50 pixels; the outermost parts are nearly transparent.
    let wider = (blurred[2] - blurred[0]) - (sharp[2] - sharp[0]);
    assert!((30.0..=52.0).contains(&wider), "{wider}");
    assert!((blurred[1] - sharp[1]).abs() <= 2.0, "{blurred:?} {sharp:?}");
    let (one, other) = (moved.sights[0].head.unwrap(), rested.sights[0].head.unwrap());
    assert!(
        (one.whole.left - other.whole.left).abs() < 0.2,
        "the truth is that of the middle"
    );
}

#[test]
fn a_camera_that_turns_smears_the_room() {
    let mut setting = room();
    setting.surfaces[3] = Material {
        second: [0.9; 3],
        pattern: Pattern::Stripes,
        scale_m: 0.4,
        ..plain(0.05)
    };
    let camera = camera(pinhole([0.0; 3]), [2.0, 3.0, 1.5], [7.9, 3.0, 1.5]);
    let turned = Pose::looking_at(WorldPoint::new(2.0, 3.0, 1.5), WorldPoint::new(7.9, 3.2, 1.5)).unwrap();
    let contrast = |closing: Option<&Pose>| {
        let taken = picture(
            &setting,
            &Shot {
                closing_pose: closing,
                ..shot(&camera, &[])
            },
        );
        let row = &taken.luma[240 * 640..241 * 640];
        row.windows(2)
            .map(|pair| f64::from(pair[0].abs_diff(pair[1])))
            .fold(0.0, f64::max)
    };
    assert!(
        contrast(Some(&turned)) < 0.6 * contrast(None),
        "{} {}",
        contrast(Some(&turned)),
        contrast(None)
    );
}

#[test]
fn pictures_depend_neither_on_threads_nor_on_what_was_drawn_before() {
    let (mut looks, posture) = (looks(), standing(4.0, 3.0, 2.5));
    looks.hair_style = Hair::Long;
    let other = Looks {
        seed: 9,
        hair_style: Hair::Short,
        ..looks.clone()
    };
    let beside = standing(4.5, 3.5, 3.0);
    let talking = Posture {
        mouth_opening: 0.7,
        blink: 0.4,
        ..beside
    };
    let camera = camera(pinhole([-0.2, 0.0, 0.0]), [1.0, 3.0, 1.5], [4.0, 3.0, 1.3]);
    let people = [
        still(&looks, &posture),
        Person {
            looks: &other,
            opening: &beside,
            closing: &talking,
        },
    ];
    let last = Shot {
        noise: SensorNoise::default(),
        ..shot(&camera, &people)
    };
    let on = |threads: usize, first: bool| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let (mut renderer, mut picture) = (Renderer::new(&room(), 7), Picture::default());
            if first {
                let swapped = [people[1], people[0]];
                let before = Shot {
                    people: &swapped,
                    lamps: &[0.3],
                    frame: 2,
                    exposure: 2.0,
                    ..last
                };
                renderer.render(&before, &mut picture);
                renderer.render(&Shot { people: &[], ..last }, &mut picture);
            }
            renderer.render(&last, &mut picture);
            picture
        })
    };
    let one = on(1, false);
    assert_eq!(one, on(2, false));
    assert_eq!(one, on(2, true));
    let next = picture(&room(), &Shot { frame: 4, ..last });
    assert_ne!(one.luma, next.luma, "every picture has its own noise");
    assert_eq!(one.sights, next.sights);
}

#[test]
fn panoramas_show_who_stands_at_their_seam_in_one_piece() {
    let lens = Panorama::new(PanoramaParameters {
        columns_per_turn: 640.0,
        focal_px: 120.0,
        centre_px: [319.5, 239.5],
    });
    let camera = camera(
        CameraModel::Panorama(lens.unwrap()),
        [4.0, 3.0, 1.4],
        [6.0, 3.0, 1.4],
    );
    let (looks, behind) = (looks(), standing(2.5, 3.0, 0.0));
    let taken = picture(&room(), &shot(&camera, &[still(&looks, &behind)]));
    let body = taken.sights[0].body.unwrap();
    assert!(body.whole.width < 100.0 && body.visible > 0.97, "{body:?}");
    assert!(body.inside.width < 0.6 * body.whole.width, "{body:?}");
    let empty = picture(&room(), &shot(&camera, &[]));
    let edge = |column: usize| {
        (0..480)
            .filter(|y| taken.luma[y * 640 + column] != empty.luma[y * 640 + column])
            .count()
    };
    assert!(edge(0) > 20 && edge(639) > 20, "drawn on both sides");
}

#[test]
fn photographs_and_mouths_are_seen_on_the_face() {
    let posture = standing(4.0, 3.0, PI);
    let camera = camera(pinhole([0.0; 3]), [2.5, 3.0, 1.65], [4.0, 3.0, 1.63]);
    let colour = |looks: &Looks, posture: &Posture, place: WorldPoint| {
        let taken = picture(&room(), &shot(&camera, &[still(looks, posture)]));
        let (mut rgb, mut luma) = (Vec::new(), Vec::new());
        taken.to_rgb(&mut rgb, &mut luma);
        let pixel = camera.project_inside(place).unwrap();
        let at = 3 * (pixel.v.round() as usize * 640 + pixel.u.round() as usize);
        [rgb[at], rgb[at + 1], rgb[at + 2]].map(i32::from)
    };
    let drawn = looks();
    let green = Looks {
        face: Some(Arc::new((2, 2, [20, 200, 30].repeat(4)))),
        ..looks()
    };
    let short = Looks {
        face: Some(Arc::new((2, 2, vec![0; 5]))),
        ..looks()
    };
    let cheek = WorldPoint::new(3.93, 3.03, 1.6);
    let [red, lush, _] = colour(&green, &posture, cheek);
    assert!(lush > red + 80, "{red} {lush}");
    for looks in [&drawn, &short] {
        let [red, lush, _] = colour(looks, &posture, cheek);
        assert!(red > lush + 10, "skin is red: {red} {lush}");
    }
    let mouth = posture.mouth(drawn.head_half_axes_m);
    let below = WorldPoint::new(mouth.0.x, mouth.0.y, mouth.0.z - 0.018);
    let open = Posture {
        mouth_opening: 1.0,
        ..posture
    };
    let (shut, wide) = (colour(&drawn, &posture, below), colour(&drawn, &open, below));
    assert!(wide[0] < shut[0] - 40, "{shut:?} {wide:?}");
}

#[test]
fn senseless_input_gives_pictures_without_it() {
    let good = standing(4.0, 3.0, 3.0);
    let looks = looks();
    let lost = Posture {
        neck: WorldPoint::new(f64::NAN, 0.0, 0.0),
        ..good
    };
    let far = Posture {
        head: WorldPoint::new(1e300, 0.0, 0.0),
        ..good
    };
    let level = camera(pinhole([0.0; 3]), [1.0, 3.0, 1.5], [4.0, 3.0, 1.3]);
    let behind = standing(0.3, 3.0, 0.0);
    let around = standing(1.0, 3.0, 0.0);
    let closest = Posture {
        head: WorldPoint::new(1.12, 3.0, 1.5),
        ..around
    };
    let odd = Looks {
        height_m: f64::NAN,
        build: -1.0,
        head_half_axes_m: [f64::INFINITY, 0.0, -3.0],
        hair_style: Hair::Long,
        ..looks.clone()
    };
    let folded = Posture {
        pelvis: good.neck,
        legs: [good.arms[0]; 2],
        arms: [good.arms[0]; 2],
        ..good
    };
    for posture in [lost, far] {
        let people = [still(&looks, &posture), still(&looks, &good)];
        let taken = picture(&room(), &shot(&level, &people));
        assert_eq!(taken.sights[0], Default::default());
        assert!(taken.sights[1].body.unwrap().visible > 0.5);
    }
    for (looks, posture) in [
        (&looks, &behind),
        (&looks, &around),
        (&looks, &closest),
        (&odd, &good),
        (&looks, &folded),
    ] {
        let sight = picture(&room(), &shot(&level, &[still(looks, posture)])).sights[0];
        for extent in [sight.head, sight.body].into_iter().flatten() {
            assert!(
                extent.whole.is_finite() && extent.inside.is_finite(),
                "{extent:?}"
            );
            assert!((0.0..=1.0).contains(&extent.visible), "{extent:?}");
        }
    }
    let people = [still(&looks, &good)];
    let blind = Shot {
        exposure: f64::NAN,
        lamps: &[f64::INFINITY],
        ..shot(&level, &people)
    };
    assert!(picture(&room(), &blind).luma.iter().all(|code| *code == 0));
    for (width, height) in [(0, 480), (640, 0), (1, 1), (3, 5)] {
        let small = Camera {
            width,
            height,
            ..level
        };
        let taken = picture(&room(), &shot(&small, &people));
        assert_eq!((taken.luma.len(), taken.sights.len()), (width * height, 1));
        let (mut rgb, mut luma) = (Vec::new(), Vec::new());
        taken.to_rgb(&mut rgb, &mut luma);
        assert_eq!(rgb.len(), 3 * width * height);
    }
    let mut broken = room();
    broken.size_m = [f64::NAN, -1.0, 0.0];
    broken.lights[0].position = WorldPoint::new(f64::NAN, 0.0, 0.0);
    broken.blocks.push(Block {
        name: "nothing".into(),
        centre: WorldPoint::new(f64::NAN, 0.0, 0.0),
        size_m: [f64::INFINITY, 0.0, 1.0],
        yaw_rad: f64::NAN,
        material: Material {
            scale_m: f32::NAN,
            ..plain(0.5)
        },
    });
    assert_eq!(picture(&broken, &shot(&level, &people)).luma.len(), 640 * 480);
}
