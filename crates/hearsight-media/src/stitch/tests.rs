use super::*;
use hearsight_core::camera::{CameraModel, Pinhole};
use hearsight_core::{DistortedPixel, Instant, Pose, WorldPoint};

/// The colour of a far wall in a direction: smooth, and different everywhere.
fn wall(direction: [f64; 3]) -> [u8; 3] {
    let azimuth = direction[1].atan2(direction[0]);
    let height = direction[2] / direction[0].hypot(direction[1]);
    [
        128.0 + 100.0 * azimuth.sin(),
        128.0 + 100.0 * azimuth.cos(),
        128.0 + 200.0 * height,
    ]
    .map(|value| value.clamp(0.0, 255.0) as u8)
}

struct Drawn {
    format: VideoFormat,
    camera: Camera,
    left: u64,
}

impl VideoSource for Drawn {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, _: &mut Vec<Fault>) -> Delivery {
        if self.left == 0 {
            return Delivery::End;
        }
        self.left -= 1;
        frame.number += 1;
        frame.time = Instant::ZERO + self.format.interval * (frame.number as i64 - 1);
        (frame.width, frame.height) = (self.camera.width, self.camera.height);
        frame.rgb.clear();
        frame.luma.clear();
        for row in 0..self.camera.height {
            for column in 0..self.camera.width {
                let ray = self
                    .camera
                    .ray(DistortedPixel::new(column as f64, row as f64))
                    .unwrap();
                let colour = wall([ray.direction.x, ray.direction.y, ray.direction.z]);
                frame.rgb.extend(colour);
                frame.luma.push(colour[1]);
            }
        }
        Delivery::Data
    }
}

fn ring(count: usize, frames: u64) -> Vec<StitchedCamera> {
    (0..count)
        .map(|number| {
            let angle = std::f64::consts::TAU * number as f64 / count as f64;
            let eye = WorldPoint::new(0.02 * angle.cos(), 0.02 * angle.sin(), 1.0);
            let target = WorldPoint::new(3.0 * angle.cos(), 3.0 * angle.sin(), 1.0);
            let lens = Pinhole::ideal([170.0, 170.0], [159.5, 119.5]).unwrap();
            let camera = Camera {
                model: CameraModel::Pinhole(lens),
                pose: Pose::looking_at(eye, target).unwrap(),
                width: 320,
                height: 240,
            };
            let format = VideoFormat {
                width: 320,
                height: 240,
                interval: Span::from_seconds(0.1),
                frames: Some(frames),
                start: Instant::ZERO,
                live: false,
            };
            StitchedCamera {
                name: format!("part{number}"),
                source: Box::new(Drawn {
                    format,
                    camera,
                    // The last one ends early.
                    left: if number + 1 == count {
                        frames.min(2)
                    } else {
                        frames
                    },
                }),
                calibration: camera,
            }
        })
        .collect()
}

#[test]
fn five_cameras_see_all_around_without_seams() {
    let options = StitchOptions::default();
    let mut stitched = StitchedVideo::new(ring(5, 3), &options).unwrap();
    assert!(stitched.covered() > 0.98, "{}", stitched.covered());
    let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
    assert_eq!(stitched.read(&mut frame, &mut faults), Delivery::Data);
    assert_eq!(
        (frame.width, frame.height, frame.rgb.len()),
        (1500, 240, 1500 * 240 * 3)
    );
    let panorama = *stitched.calibration();
    // The first camera is in the middle, what is left of it is on the left, and colours are those of the wall everywhere.
    let middle = panorama.ray(DistortedPixel::new(749.5, 119.5)).unwrap().direction;
    assert!(middle.x > 0.999, "{middle:?}");
    let left = panorama.ray(DistortedPixel::new(375.0, 119.5)).unwrap().direction;
    assert!(left.y > 0.99, "{left:?}");
    for row in (20..220).step_by(20) {
        for column in 0..1500 {
            let direction = panorama
                .ray(DistortedPixel::new(column as f64, row as f64))
                .unwrap()
                .direction;
            let expected = wall([direction.x, direction.y, direction.z]);
            let at = 3 * (row * 1500 + column);
            for (channel, value) in expected.iter().enumerate() {
                let found = frame.rgb[at + channel];
                assert!(
                    found.abs_diff(*value) <= 6,
                    "{column} {row}: {found} where {value} is"
                );
            }
            assert!(frame.luma[at / 3].abs_diff(frame.rgb[at + 1]) <= 1);
        }
    }
}

#[test]
fn a_camera_that_ends_early_is_reported_once_and_its_part_stays() {
    let mut stitched = StitchedVideo::new(ring(5, 4), &StitchOptions::default()).unwrap();
    let (mut frame, mut faults) = (VideoFrame::default(), Vec::new());
    let mut pictures = Vec::new();
    while stitched.read(&mut frame, &mut faults) == Delivery::Data {
        pictures.push(frame.rgb.clone());
    }
    assert_eq!(pictures.len(), 4);
    assert_eq!(pictures[0], pictures[3]);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert_eq!(
        (faults[0].sensor.as_str(), faults[0].kind),
        ("part4", FaultKind::EndedEarly)
    );
}

#[test]
fn what_does_not_fit_is_named() {
    let options = StitchOptions::default();
    assert!(matches!(
        StitchedVideo::new(Vec::new(), &options),
        Err(StitchError::NoCameras)
    ));
    let mut wrong = ring(2, 1);
    wrong[1].calibration.width = 640;
    let error = StitchedVideo::new(wrong, &options).err().unwrap().to_string();
    assert!(error.contains("camera 1") && error.contains("640"), "{error}");
    for bad in [
        StitchOptions { width: 0, ..options },
        StitchOptions {
            radius_m: f64::NAN,
            ..options
        },
        StitchOptions { seam: 0.0, ..options },
    ] {
        assert!(StitchedVideo::new(ring(2, 1), &bad).is_err());
    }
}
