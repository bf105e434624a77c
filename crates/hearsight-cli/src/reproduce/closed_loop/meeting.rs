//! Sequence B: who speaks around a ring of cameras, by sound alone, by pictures alone and by both.
//!
//! The cameras of the simulation are stitched as those of a room are; directions are columns of the panorama, in degrees.

use super::super::lockstep::{Variant, build_all, run};
use super::super::{Measured, Trial};
use super::{EXPERIMENT, as_in_the_paper};
use hearsight::core::camera::Camera;
use hearsight::core::record::Scene;
use hearsight::core::room::{CameraSensor, Room};
use hearsight::core::source::VideoSource;
use hearsight::core::truth::TruthRecord;
use hearsight::core::{Span, WorldPoint};
use hearsight::media::{
    Camera as Picture, Microphones, MomentOptions, MomentReader, StitchOptions, StitchedCamera, StitchedVideo,
};
use hearsight::sim::simulation::Simulation;
use hearsight::systems::System;
use miette::{IntoDiagnostic, miette};
use serde_json::json;
use std::collections::BTreeMap;

pub(super) const FUSED: &str = "sound and pictures";
pub(super) const SEEN: &str = "pictures alone";
pub(super) const HEARD: &str = "sound alone";
pub(super) const OURS: &str = "beyond the paper";

/// Farther from a head a track is not on it, degrees.
const NEAR_DEG: f64 = 8.0;
/// Before this time people may not have been found yet, seconds.
const SETTLED_S: f64 = 3.0;

/// The variants of the paper's meeting. A face is searched every second: the experiment is about speaking.
pub(super) fn variants() -> Vec<Variant> {
    let paper = as_in_the_paper(&[("faces.period_s", json!(1.0))]);
    [FUSED, SEEN]
        .map(|name| Variant {
            name,
            system: EXPERIMENT.name,
            parameters: paper.clone(),
        })
        .into()
}

/// Ours is set for a loud room with much reverberation, as whoever installs it would: loudness tells nothing there.
pub(super) fn beyond_variants() -> Vec<Variant> {
    let mut variants = variants();
    variants.retain(|variant| variant.name == FUSED);
    let direction = json!({ "sound_db": -100.0, "silence_db": -100.0, "room": { "reverberation_s": 0.8 } });
    variants.push(Variant {
        name: OURS,
        system: EXPERIMENT.name,
        parameters: json!({ "audio": { "direction": direction }, "speaker": { "silence": 0.0 } }),
    });
    variants
}

pub(super) fn measure(
    simulation: &Simulation,
    trial: &Trial,
    variants: &[Variant],
) -> miette::Result<Measured> {
    let (stitched, room) = panorama(simulation)?;
    let camera = *stitched.calibration();
    let picture = Picture {
        name: room.cameras[0].name.clone(),
        source: Box::new(stitched),
    };
    let arrays = room.arrays.iter().enumerate().map(|(number, sensor)| {
        Ok::<_, miette::Report>(Microphones {
            name: sensor.name.clone(),
            source: Box::new(simulation.array(number).into_diagnostic()?),
        })
    });
    let arrays = arrays.collect::<miette::Result<Vec<_>>>()?;
    let mut reader = MomentReader::new(vec![picture], arrays, MomentOptions::default()).into_diagnostic()?;
    let interval_s = reader.tick().seconds();
    let deaf = Room {
        arrays: Vec::new(),
        ..room.clone()
    };
    let mut systems = Vec::new();
    for variant in variants {
        let room = if variant.name == SEEN { &deaf } else { &room };
        systems.extend(build_all(std::slice::from_ref(variant), room, trial.seed)?);
    }
    let mut judges: Vec<Judge> = variants.iter().map(|_| Judge::new(interval_s)).collect();
    run(
        simulation,
        &mut reader,
        &mut systems,
        &mut |_| (),
        &mut |number, system, scene, truth| {
            judges[number].push(Look::of(&camera, system, scene, truth));
        },
    )?;
    let mut measured = Measured::new();
    for (variant, judge) in variants.iter().zip(&judges) {
        measured.insert(variant.name.to_owned(), judge.metrics(|look| look.named));
        if variant.name == FUSED {
            measured.insert(HEARD.to_owned(), judge.metrics(|look| look.sound));
        }
    }
    Ok(measured)
}

/// The simulation's ring of cameras as one, and the room with it.
fn panorama(simulation: &Simulation) -> miette::Result<(StitchedVideo, Room)> {
    let mut room = simulation.room();
    let ring = room
        .cameras
        .iter()
        .enumerate()
        .map(|(number, sensor)| {
            Ok(StitchedCamera {
                name: sensor.name.clone(),
                source: Box::new(simulation.camera(number)),
                calibration: sensor
                    .calibration
                    .ok_or_else(|| miette!("a camera of the ring has no calibration"))?,
            })
        })
        .collect::<miette::Result<Vec<_>>>()?;
    let stitched = StitchedVideo::new(ring, &StitchOptions::default()).into_diagnostic()?;
    let interval: Span = stitched.format().interval;
    room.cameras = vec![CameraSensor {
        name: "panorama".into(),
        width: stitched.calibration().width,
        height: stitched.calibration().height,
        interval,
        calibration: Some(*stitched.calibration()),
    }];
    for array in &mut room.arrays {
        array.camera = Some(0);
    }
    Ok((stitched, room))
}

/// What was so and what a variant said at one tick; directions are degrees.
#[derive(Clone, Debug, Default)]
struct Look {
    time_s: f64,
    people: Vec<f64>,
    /// Indices into `people`.
    speaking: Vec<usize>,
    tracks: Vec<f64>,
    /// The track that is said to speak, and where sound alone comes from.
    named: Option<f64>,
    sound: Option<f64>,
}

impl Look {
    fn of(camera: &Camera, system: &dyn System, scene: &Scene, truth: &TruthRecord) -> Self {
        let degrees = |column: f64| 360.0 * column / camera.width as f64;
        let mut look = Self {
            time_s: truth.time_s,
            ..Self::default()
        };
        for person in truth.people.iter().filter(|person| person.present) {
            let pixel = person
                .head_m
                .and_then(|[x, y, z]| camera.project(WorldPoint::new(x, y, z)));
            let Some(pixel) = pixel else { continue };
            if person.speaking {
                look.speaking.push(look.people.len());
            }
            look.people.push(degrees(pixel.u));
        }
        for track in &scene.tracks {
            let Some(view) = track.views.first() else { continue };
            let at = degrees(view.head.left + 0.5 * view.head.width);
            look.tracks.push(at);
            if scene.speaker == Some(track.id) {
                look.named = Some(at);
            }
        }
        look.sound = system.bars(0).sound.map(|column| degrees(f64::from(column)));
        look
    }

    fn only_talker(&self) -> Option<usize> {
        match self.speaking.as_slice() {
            [one] => Some(*one),
            _ => None,
        }
    }

    fn nearest_person(&self, direction: f64) -> Option<usize> {
        (0..self.people.len()).min_by(|a, b| {
            let off = |person: &usize| apart(self.people[*person], direction);
            off(a).total_cmp(&off(b))
        })
    }
}

/// Degrees between two directions.
fn apart(a: f64, b: f64) -> f64 {
    let apart = (a - b).rem_euclid(360.0);
    apart.min(360.0 - apart)
}

struct Judge {
    looks: Vec<Look>,
    interval_s: f64,
}

impl Judge {
    fn new(interval_s: f64) -> Self {
        Self {
            looks: Vec::new(),
            interval_s,
        }
    }

    fn push(&mut self, look: Look) {
        self.looks.push(look);
    }

    /// The metrics of one of the answers.
    fn metrics(&self, answer: impl Fn(&Look) -> Option<f64>) -> BTreeMap<String, f64> {
        let mut metrics = BTreeMap::new();
        let mut add = |name: &str, value: Option<f64>| {
            if let Some(value) = value {
                metrics.insert(name.to_owned(), value);
            }
        };
        let settled = || self.looks.iter().filter(|look| look.time_s >= SETTLED_S);
        let named = |look: &Look| answer(look).and_then(|direction| look.nearest_person(direction));
        let single = || settled().filter_map(|look| Some((look, look.only_talker()?)));
        add(
            "right",
            share(single().map(|(look, talker)| named(look) == Some(talker))),
        );
        let answered = || single().filter(|(look, _)| answer(look).is_some());
        add(
            "right_answered",
            share(answered().map(|(look, talker)| named(look) == Some(talker))),
        );
        add(
            "right_overlap",
            share(
                settled()
                    .filter(|look| look.speaking.len() > 1)
                    .map(|look| named(look).is_some_and(|person| look.speaking.contains(&person))),
            ),
        );
        let offs = single().filter_map(|(look, talker)| Some(apart(answer(look)?, look.people[talker])));
        add("error_deg", median(offs.collect()));
        add(
            "tracked",
            share(settled().flat_map(|look| {
                look.people
                    .iter()
                    .map(|person| look.tracks.iter().any(|track| apart(*track, *person) < NEAR_DEG))
            })),
        );
        add(
            "false_tracks",
            mean(settled().map(|look| {
                let is_false = |track: &&f64| {
                    look.people
                        .iter()
                        .all(|person| apart(**track, *person) >= NEAR_DEG)
                };
                look.tracks.iter().filter(is_false).count() as f64
            })),
        );
        let (false_switches, switch_s) = self.switches(&named);
        let minutes = settled().count() as f64 * self.interval_s / 60.0;
        add(
            "false_switches_per_min",
            (minutes > 0.0).then(|| f64::from(false_switches) / minutes),
        );
        add("switch_s", mean(switch_s.into_iter()));
        metrics
    }

    /// Changes of the answer to somebody who does not speak, and how long each change of the talker took to be noticed; one
    /// that was not, counts as long as the turn.
    fn switches(&self, named: &impl Fn(&Look) -> Option<usize>) -> (u32, Vec<f64>) {
        let (mut wrong, mut delays_s) = (0, Vec::new());
        let (mut before, mut talker): (Option<usize>, Option<usize>) = (None, None);
        let mut waiting: Option<f64> = None;
        for look in self.looks.iter().filter(|look| look.time_s >= SETTLED_S) {
            if let Some(now) = look.only_talker().filter(|now| talker != Some(*now)) {
                // A turn that was never noticed.
                delays_s.extend(waiting.map(|from| look.time_s - from));
                waiting = talker.is_some().then_some(look.time_s);
                talker = Some(now);
            }
            let Some(now) = named(look) else { continue };
            if before.is_some_and(|before| before != now) && !look.speaking.contains(&now) {
                wrong += 1;
            }
            before = Some(now);
            if talker == Some(now)
                && let Some(from) = waiting.take()
            {
                delays_s.push(look.time_s - from);
            }
        }
        (wrong, delays_s)
    }
}

fn share(values: impl Iterator<Item = bool>) -> Option<f64> {
    mean(values.map(|value| f64::from(u8::from(value))))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(tick: usize, speaking: &[usize], named: Option<f64>) -> Look {
        Look {
            time_s: SETTLED_S + 0.1 * tick as f64,
            people: vec![10.0, 130.0, 355.0],
            speaking: speaking.to_vec(),
            tracks: vec![12.0, 129.0, 200.0],
            named,
            sound: Some(2.0),
        }
    }

    #[test]
    fn speakers_switches_and_errors_are_counted_around_the_seam() {
        let mut judge = Judge::new(0.1);
        judge.push(look(0, &[0], Some(12.0)));
        judge.push(look(1, &[0], Some(129.0)));
        judge.push(look(2, &[2], Some(12.0)));
        judge.push(look(3, &[2], Some(357.0)));
        judge.push(look(4, &[0, 1], Some(129.0)));
        judge.push(look(5, &[], None));
        let metrics = judge.metrics(|look| look.named);
        assert_eq!(metrics["right"], 0.5);
        assert_eq!(metrics["right_overlap"], 1.0);
        assert!((metrics["tracked"] - 2.0 / 3.0).abs() < 1e-9);
        assert_eq!(metrics["false_tracks"], 1.0);
        // To 129 while the first talks, and back to the first while the third does.
        assert!((metrics["false_switches_per_min"] - 2.0 / (0.6 / 60.0)).abs() < 1e-6);
        assert!((metrics["switch_s"] - 0.1).abs() < 1e-9);
        let heard = judge.metrics(|look| look.sound);
        // 2 degrees is 8 from the first and 7 from the third.
        assert_eq!(heard["right"], 0.5);
        assert_eq!(heard["error_deg"], 8.0);
        assert_eq!(apart(355.0, 2.0), 7.0);
    }
}
