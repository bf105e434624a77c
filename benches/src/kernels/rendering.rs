//! Work on the pictures of simulated rooms.

use super::Work;
use crate::rooms::{Dice, standing};
use crate::{Failure, Inputs};
use hearsight_core::camera::{Pinhole, PinholeParameters};
use hearsight_core::{Camera, CameraModel, Pose, WorldPoint};
use hearsight_sim::render::{Person, Picture, Range, Renderer, SensorNoise, Shot};

/// Three people who move, 2 to 4 m from a distorting lens, in one picture after the other. With `turning`, the camera
/// turns, so that the room is drawn anew for each.
pub(super) fn render(_: &Inputs, turning: bool) -> Result<Work, Failure> {
    let mut dice = Dice::new(11);
    let setting = dice.setting();
    let looks = [dice.looks(), dice.looks(), dice.looks()];
    let parameters = PinholeParameters {
        focal_px: [500.0; 2],
        centre_px: [319.5, 239.5],
        radial: [-0.2, 0.05, 0.0],
        tangential: [0.0; 2],
    };
    let model = CameraModel::Pinhole(Pinhole::new(parameters)?);
    let place = WorldPoint::new(0.3, 2.5, 1.6);
    let mut renderer = Renderer::new(&setting, 1);
    let mut picture = Picture::default();
    let mut frame = 0;
    Ok(Box::new(move || {
        frame += 1;
        let time = frame as f64 / 15.0;
        let aim = if turning { 0.2 * time.sin() } else { 0.0 };
        let pose =
            Pose::looking_at(place, WorldPoint::new(3.0, 2.5 + aim, 1.2)).unwrap_or_else(Pose::identity);
        let camera = Camera {
            model,
            pose,
            width: 640,
            height: 480,
        };
        let at = |number: usize, time: f64| {
            let aside = 0.1 * (time + number as f64).sin();
            let ground = [2.3 + 0.8 * number as f64, 2.0 + 0.5 * number as f64 + aside];
            standing(&looks[number], ground, 3.0, 3.0 + 0.5 * time.sin())
        };
        let (from, to) = (
            [0, 1, 2].map(|number| at(number, time)),
            [0, 1, 2].map(|number| at(number, time + 0.01)),
        );
        let people = [0, 1, 2].map(|number| Person {
            looks: &looks[number],
            opening: &from[number],
            closing: &to[number],
        });
        let shot = Shot {
            view: 0,
            frame,
            camera: &camera,
            closing_pose: None,
            people: &people,
            lamps: &[],
            exposure: 1.0,
            white_balance: [1.0; 3],
            noise: SensorNoise::default(),
            range: Range::Limited,
        };
        renderer.render(&shot, &mut picture);
        picture
            .sights
            .iter()
            .filter_map(|sight| sight.body)
            .map(|body| body.visible)
            .sum()
    }))
}
