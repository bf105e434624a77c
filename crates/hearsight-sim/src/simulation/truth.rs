//! The truth, tick by tick, for judges.

use super::Simulation;
use super::shared::Seen;
use crate::render::{Extent, Sight};
use hearsight_core::record::BoxRecord;
use hearsight_core::truth::{PersonTruth, SoundTruth, TRUTH_SCHEMA_VERSION, TruthRecord, ViewTruth};
use hearsight_core::{Instant, Span};

/// Time from tick to tick without cameras, as of whoever tracks.
const TICK_WITHOUT_CAMERA: Span = Span::from_nanoseconds(40_000_000);
/// Speech is told apart from pauses so finely, seconds.
const SPEECH_STEP_S: f64 = 0.01;

/// A span in which somebody's voice sounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Utterance {
    /// Name of the person.
    pub person: String,
    /// When it begins, seconds.
    pub from_s: f64,
    /// When it ends, seconds.
    pub until_s: f64,
}

impl Simulation {
    /// Time of a tick on the common clock. Ticks are the frames of the fastest camera, the first of several alike.
    pub fn tick_time(&self, tick: u64) -> Instant {
        match self.leader() {
            Some(leader) => {
                let device = &self.world().cameras[leader];
                device.clock.declared(device.own_time(tick))
            }
            None => Instant::ZERO + TICK_WITHOUT_CAMERA * tick as i64,
        }
    }

    /// Number of ticks.
    pub fn ticks(&self) -> u64 {
        match self.leader() {
            Some(leader) => super::camera::frames(&self.world().cameras[leader], self.world().seconds),
            None => (self.world().seconds / TICK_WITHOUT_CAMERA.seconds()) as u64,
        }
    }

    fn leader(&self) -> Option<usize> {
        let cameras = self.world().cameras.iter().enumerate();
        cameras
            .min_by_key(|(_, camera)| camera.interval())
            .map(|(number, _)| number)
    }

    /// What is so at a tick. Views are those of frames that cameras delivered up to the tick's time and that no record
    /// before has told of: ask in order, after the frames were read.
    pub fn truth(&self, tick: u64) -> TruthRecord {
        let time = self.tick_time(tick);
        let seen: Vec<Vec<Seen>> = (0..self.world().cameras.len())
            .map(|camera| self.take_seen(camera, time))
            .collect();
        let people = (0..self.world().people.len()).map(|person| self.person_truth(person, time, &seen));
        TruthRecord {
            schema: TRUTH_SCHEMA_VERSION.to_owned(),
            tick,
            time_s: time.seconds(),
            people: people.collect(),
            sounds: self.sound_truth(time.seconds()),
        }
    }

    /// Takes the frames of a camera that whoever reads believes to be of this time or before.
    fn take_seen(&self, camera: usize, time: Instant) -> Vec<Seen> {
        let device = &self.world().cameras[camera];
        let mut queue = self.shared.seen(camera);
        let due = queue
            .iter()
            .take_while(|seen| device.clock.declared(device.own_time(seen.frame)) <= time)
            .count();
        queue.drain(..due).collect()
    }

    fn person_truth(&self, person: usize, time: Instant, seen: &[Vec<Seen>]) -> PersonTruth {
        let world = self.world();
        let who = &world.people[person];
        let posture = world.posture(person, time.seconds());
        let array = |point: hearsight_core::WorldPoint| [point.0.x, point.0.y, point.0.z];
        let mut views = Vec::new();
        for (camera, frames) in seen.iter().enumerate() {
            // Of several frames within one tick the newest counts.
            let Some(frame) = frames.last() else { continue };
            let sight = frame.people.iter().find(|(other, _)| *other == person);
            let view = sight.and_then(|(_, sight)| view(&world.cameras[camera].name, frame.frame, sight));
            views.extend(view);
        }
        PersonTruth {
            id: who.id,
            name: who.name.clone(),
            present: posture.is_some(),
            head_m: posture.map(|posture| array(posture.head)),
            mouth_m: posture.map(|posture| array(posture.mouth(who.looks.head_half_axes_m))),
            head_yaw_rad: posture.map(|posture| posture.head_yaw_rad),
            speaking: posture.is_some() && who.is_speaking(time.seconds()),
            views,
        }
    }

    fn sound_truth(&self, time_s: f64) -> Vec<SoundTruth> {
        let world = self.world();
        self.shared.with_controls(|controls| {
            let sounds = world.noises.iter().filter_map(|noise| {
                let place = world.noise_place(noise, controls, time_s)?;
                Some(SoundTruth {
                    name: noise.name.clone(),
                    position_m: [place.0.x, place.0.y, place.0.z],
                    sounding: noise.is_sounding(time_s),
                })
            });
            sounds.collect()
        })
    }

    /// When whose voice sounds, in order of time: pauses within turns are left out.
    pub fn utterances(&self) -> Vec<Utterance> {
        let mut all = Vec::new();
        for person in &self.world().people {
            for [from, until] in &person.turns {
                let until = until.min(self.world().seconds);
                let steps = ((until - from) / SPEECH_STEP_S).ceil().max(0.0) as usize;
                let mut begun: Option<f64> = None;
                for step in 0..=steps {
                    let time_s = from + step as f64 * SPEECH_STEP_S;
                    let sounds = step < steps && person.is_speaking(time_s + 0.5 * SPEECH_STEP_S);
                    match (begun, sounds) {
                        (None, true) => begun = Some(time_s),
                        (Some(from_s), false) => {
                            all.push(Utterance {
                                person: person.name.clone(),
                                from_s,
                                until_s: time_s.min(until),
                            });
                            begun = None;
                        }
                        _ => {}
                    }
                }
            }
        }
        all.sort_by(|one, other| one.from_s.total_cmp(&other.from_s));
        all
    }

    /// The utterances as RTTM.
    pub fn rttm(&self) -> String {
        let name = &self.world().name;
        let lines = self.utterances().into_iter().map(|utterance| {
            let length = utterance.until_s - utterance.from_s;
            let person = utterance.person;
            format!(
                "SPEAKER {name} 1 {:.3} {length:.3} <NA> <NA> {person} <NA> <NA>\n",
                utterance.from_s
            )
        });
        lines.collect()
    }
}

/// Rows of MOTChallenge's ground truth (`frame,id,left,top,width,height,consider,class,visibility`, head boxes) that one
/// camera has in a record.
pub fn mot_rows(record: &TruthRecord, camera: &str) -> String {
    let mut rows = String::new();
    for person in &record.people {
        for view in person.views.iter().filter(|view| view.camera == camera) {
            if let Some(head) = view.head {
                rows.push_str(&format!(
                    "{},{},{:.3},{:.3},{:.3},{:.3},1,1,{:.4}\n",
                    view.frame, person.id, head.left, head.top, head.width, head.height, view.head_visible
                ));
            }
        }
    }
    rows
}

fn view(camera: &str, frame: u64, sight: &Sight) -> Option<ViewTruth> {
    let shown = |extent: &Option<Extent>| {
        extent.filter(|extent| extent.inside.width > 0.0 && extent.inside.height > 0.0)
    };
    let (head, body) = (shown(&sight.head), shown(&sight.body));
    if head.is_none() && body.is_none() {
        return None;
    }
    let whole = |extent: Extent| BoxRecord::from(extent.whole);
    Some(ViewTruth {
        camera: camera.to_owned(),
        frame: frame + 1,
        head: head.map(whole),
        body: body.map(whole),
        head_visible: head.map_or(0.0, |extent| extent.visible),
        body_visible: body.map_or(0.0, |extent| extent.visible),
    })
}
