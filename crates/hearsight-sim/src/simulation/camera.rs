//! A simulated camera: pictures in order of time, as a file of them would give.

use super::shared::Shared;
use crate::render::{Person, Picture, Range, Renderer, SensorNoise, Shot};
use crate::world::{CameraDevice, Looks, Posture};
use hearsight_core::source::{Delivery, VideoFormat, VideoSource};
use hearsight_core::{Fault, Instant, Span, VideoFrame};
use std::sync::Arc;

/// Delivers the pictures of one camera.
pub struct SimulatedCamera {
    shared: Arc<Shared>,
    number: usize,
    format: VideoFormat,
    frames: u64,
    /// Number of the next frame, from 0.
    next: u64,
    renderer: Renderer,
    picture: Picture,
    /// Postures of those in the room when the shutter opens and closes, and who they are.
    before: Vec<(usize, Posture, Posture)>,
}

impl SimulatedCamera {
    pub(super) fn new(shared: &Arc<Shared>, number: usize) -> Self {
        let device = &shared.world.cameras[number];
        let frames = frames(device, shared.world.seconds);
        Self {
            format: VideoFormat {
                width: device.width,
                height: device.height,
                interval: device.interval(),
                frames: Some(frames),
                start: device.clock.declared(device.own_time(0)),
                live: false,
            },
            frames,
            next: 0,
            renderer: Renderer::new(&shared.world.setting, shared.world.seed),
            picture: Picture::default(),
            before: Vec::new(),
            number,
            shared: Arc::clone(shared),
        }
    }

    /// The time of a frame, from 0, on the common clock, as whoever reads the file believes it.
    pub fn time(&self, frame: u64) -> Instant {
        let device = &self.shared.world.cameras[self.number];
        device.clock.declared(device.own_time(frame))
    }

    /// The time of a frame, from 0, after the first one, by the camera's own clock.
    pub fn own_time(&self, frame: u64) -> Span {
        self.shared.world.cameras[self.number].own_time(frame)
    }

    /// Takes the next picture: its number from 0 and the picture. Nothing at the end.
    pub fn shoot(&mut self) -> Option<(u64, &Picture)> {
        if self.next >= self.frames {
            return None;
        }
        let frame = self.next;
        self.next += 1;
        self.take(frame);
        Some((frame, &self.picture))
    }

    fn take(&mut self, frame: u64) {
        let world = &self.shared.world;
        let device = &world.cameras[self.number];
        let middle_s = device.clock.time_s(device.own_time(frame).seconds());
        let opening_s = middle_s - 0.5 * device.shutter_s;
        let closing_s = middle_s + 0.5 * device.shutter_s;
        self.before.clear();
        for person in 0..world.people.len() {
            let Some(posture) = world.posture(person, middle_s) else {
                continue;
            };
            let at = |time_s: f64| world.posture(person, time_s).unwrap_or(posture);
            self.before.push((person, at(opening_s), at(closing_s)));
        }
        let looks = |person: usize| -> &Looks { &world.people[person].looks };
        let people = self.before.iter().map(|(person, opening, closing)| Person {
            looks: looks(*person),
            opening,
            closing,
        });
        let people: Vec<Person<'_>> = people.collect();
        let lamps = world.lamps(middle_s);
        let (exposure, white_balance) = device.exposure.at(middle_s);
        let [opening, closing] = self.shared.camera_at(self.number, [opening_s, closing_s]);
        let moves = opening.pose != closing.pose;
        let shot = Shot {
            view: 0,
            // Cameras have renderers of their own, and noise of their own.
            frame: frame + ((self.number as u64) << 40),
            camera: &opening,
            closing_pose: moves.then_some(&closing.pose),
            people: &people,
            lamps: &lamps,
            exposure,
            white_balance,
            noise: SensorNoise {
                dark: device.noise[0],
                shot: device.noise[1],
            },
            range: Range::Limited,
        };
        self.renderer.render(&shot, &mut self.picture);
        let sights = self.before.iter().zip(&self.picture.sights);
        self.shared.note_sights(
            self.number,
            frame,
            sights.map(|((person, ..), sight)| (*person, *sight)).collect(),
        );
    }
}

impl VideoSource for SimulatedCamera {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, _: &mut Vec<Fault>) -> Delivery {
        let Some((number, picture)) = self.shoot() else {
            return Delivery::End;
        };
        picture.to_rgb(&mut frame.rgb, &mut frame.luma);
        (frame.width, frame.height) = (picture.width, picture.height);
        frame.number = number + 1;
        frame.time = self.time(number);
        Delivery::Data
    }
}

/// Frames that a camera takes before the scenario is over.
pub(super) fn frames(device: &CameraDevice, seconds: f64) -> u64 {
    let own_s = device.clock.own_s(seconds);
    // The end itself does not belong to it; times of frames are whole units of files.
    let mut count = (own_s * device.rate_hz).ceil().max(0.0) as u64;
    while count > 0 && device.clock.time_s(device.own_time(count - 1).seconds()) >= seconds - 1e-9 {
        count -= 1;
    }
    count
}
