//! What one variant of a system said of one camera's picture beside what was so, tick by tick, and what comes of it.

use hearsight::core::record::{BoxRecord, Scene};
use hearsight::core::truth::TruthRecord;
use hearsight::eval::metrics::diarization;
use hearsight::eval::{Event, Measure, Place, Sequence, Sighting, Speech, Turn, events};
use miette::IntoDiagnostic;
use std::collections::BTreeMap;

/// A person of whose head less is seen counts as hidden.
const LEAST_VISIBLE: f64 = 0.3;
/// Time around the boundaries of true turns that is not judged, seconds, half on either side: as NIST has it.
const COLLAR_S: f64 = 0.5;

/// A run beside the truth.
#[derive(Debug, Default)]
pub(crate) struct Observed {
    ticks: Vec<Tick>,
    interval_s: f64,
}

#[derive(Debug)]
struct Tick {
    time_s: f64,
    people: Vec<Person>,
    tracks: Vec<(u64, [f64; 2])>,
    speaker: Option<u64>,
    /// The column from which sound comes, where it comes from the picture.
    heard: Option<f64>,
}

#[derive(Debug)]
struct Person {
    id: u64,
    /// Where the middle of the head is; none where it is not in the picture.
    pixel: Option<[f64; 2]>,
    visible: bool,
    speaking: bool,
}

/// Which coordinates of a picture a distance is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axes {
    /// Columns alone: all that two microphones can tell.
    Column,
    /// Columns and rows.
    Both,
}

/// How well one person was followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Following {
    /// Mean distance from the first tick with a track on, pixels.
    pub(crate) error_px: f64,
    /// Times at which another track took over.
    pub(crate) switches: f64,
    /// Share of the ticks with the person in the picture, hidden or not, that have a track within the gate.
    pub(crate) share: f64,
}

impl Observed {
    /// A run with this time from tick to tick.
    pub(crate) fn new(interval_s: f64) -> Self {
        Self {
            ticks: Vec::new(),
            interval_s,
        }
    }

    /// Adds a tick: what the system said, and what was so in the picture of `camera`.
    pub(crate) fn push(&mut self, camera: &str, scene: &Scene, truth: &TruthRecord) {
        let people = truth.people.iter().filter(|person| person.present).map(|person| {
            let view = person.views.iter().find(|view| view.camera == camera);
            Person {
                id: person.id,
                pixel: view.and_then(|view| view.head).map(|head| middle(&head)),
                visible: view.is_some_and(|view| view.head_visible >= LEAST_VISIBLE),
                speaking: person.speaking,
            }
        });
        let tracks = scene.tracks.iter().filter_map(|track| {
            let view = track.views.iter().find(|view| view.camera == camera)?;
            Some((track.id, middle(&view.head)))
        });
        self.ticks.push(Tick {
            time_s: scene.time_s,
            people: people.collect(),
            tracks: tracks.collect(),
            speaker: scene.speaker,
            heard: scene.sounds.iter().find_map(|sound| sound.column_px),
        });
    }

    /// Mean distance of the columns that were heard from the head of the only one who spoke, pixels, over the moments in
    /// which there is both: what sound tells before any filter. Nothing where there is none.
    pub(crate) fn hearing_error(&self) -> Option<f64> {
        let errors: Vec<f64> = self
            .ticks
            .iter()
            .filter_map(|tick| {
                let [column, _] = tick.only_speaker()?.pixel?;
                Some((tick.heard? - column).abs())
            })
            .collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    }

    /// How well the person with this number was followed. A track farther than `gate_px` is none; where there is none, the
    /// person's last track is judged where it is, or was last. Nothing where no track ever came near.
    pub(crate) fn following(
        &self,
        person: u64,
        gate_px: f64,
        axes: Axes,
    ) -> miette::Result<Option<Following>> {
        let sequence = self.sequence(gate_px, axes, |other| other.id == person && other.pixel.is_some())?;
        let log = events(&sequence).into_diagnostic()?;
        let mut own = vec![None; self.ticks.len()];
        for pair in log.iter().filter_map(Event::pair) {
            own[pair.frame] = Some(sequence.tracks()[pair.track].who);
        }
        let identities = self.identities();
        let (mut last, mut last_at) = (None, None);
        let (mut sum, mut judged, mut there) = (0.0, 0_u32, 0_u32);
        for (tick, own) in self.ticks.iter().zip(&own) {
            last = own.or(last);
            let at = last.and_then(|who: u32| {
                let track = tick
                    .tracks
                    .iter()
                    .find(|(id, _)| identities.get(id) == Some(&who));
                track.map(|(_, pixel)| *pixel)
            });
            last_at = at.or(last_at);
            let truth = tick.people.iter().find(|other| other.id == person);
            let Some(truth) = truth.and_then(|truth| truth.pixel) else {
                continue;
            };
            there += 1;
            if let Some(at) = last_at {
                sum += axes.distance(at, truth);
                judged += 1;
            }
        }
        if judged == 0 {
            return Ok(None);
        }
        Ok(Some(Following {
            error_px: sum / f64::from(judged),
            switches: log
                .iter()
                .filter(|event| matches!(event, Event::Switch(_)))
                .count() as f64,
            share: own.iter().flatten().count() as f64 / f64::from(there),
        }))
    }

    /// Share of the ticks in which exactly one person speaks, and is seen, whose track is the one that is marked.
    pub(crate) fn right_speaker(&self, gate_px: f64) -> miette::Result<Option<f64>> {
        let sequence = self.sequence(gate_px, Axes::Both, |person| person.visible)?;
        let identities = self.identities();
        let mut right = vec![false; self.ticks.len()];
        for event in events(&sequence).into_diagnostic()? {
            let Some(pair) = event.pair() else { continue };
            let tick = &self.ticks[pair.frame];
            let person = u64::from(sequence.truth()[pair.truth].who);
            let marked =
                tick.speaker.and_then(|id| identities.get(&id)) == Some(&sequence.tracks()[pair.track].who);
            right[pair.frame] |= marked && tick.only_speaker().is_some_and(|speaker| speaker.id == person);
        }
        let asked: Vec<bool> = self
            .ticks
            .iter()
            .zip(right)
            .filter(|(tick, _)| tick.only_speaker().is_some_and(|person| person.visible))
            .map(|(_, right)| right)
            .collect();
        let count = asked.iter().filter(|right| **right).count();
        Ok((!asked.is_empty()).then(|| count as f64 / asked.len() as f64))
    }

    /// Diarization error rate of the marks, 0 to infinity, with a collar of half a second in all.
    pub(crate) fn diarization_error(&self) -> miette::Result<f64> {
        let identities = self.identities();
        let speaking = |tick: &Tick| -> Vec<u32> {
            let people = tick.people.iter().filter(|person| person.speaking);
            people.map(|person| person.id as u32).collect()
        };
        let marked = |tick: &Tick| -> Vec<u32> {
            tick.speaker
                .and_then(|id| identities.get(&id))
                .copied()
                .into_iter()
                .collect()
        };
        let speech = Speech {
            truth: self.turns(speaking),
            result: self.turns(marked),
            span_s: None,
            collar_s: COLLAR_S,
            skip_overlap: false,
        };
        Ok(diarization::diarization(&speech).into_diagnostic()?.rate())
    }

    fn turns(&self, speakers: impl Fn(&Tick) -> Vec<u32>) -> Vec<Turn> {
        let mut turns: Vec<Turn> = Vec::new();
        let mut open: BTreeMap<u32, usize> = BTreeMap::new();
        for tick in &self.ticks {
            let now = speakers(tick);
            open.retain(|speaker, _| now.contains(speaker));
            let end_s = tick.time_s + self.interval_s;
            for speaker in now {
                let turn = *open.entry(speaker).or_insert_with(|| {
                    turns.push(Turn {
                        start_s: tick.time_s,
                        end_s,
                        speaker,
                    });
                    turns.len() - 1
                });
                turns[turn].end_s = end_s;
            }
        }
        turns
    }

    /// Tracks by numbers without gaps, as the judge wants them.
    fn identities(&self) -> BTreeMap<u64, u32> {
        let mut identities = BTreeMap::new();
        for (id, _) in self.ticks.iter().flat_map(|tick| &tick.tracks) {
            let next = identities.len() as u32;
            identities.entry(*id).or_insert(next);
        }
        identities
    }

    fn sequence(
        &self,
        gate_px: f64,
        axes: Axes,
        counts: impl Fn(&Person) -> bool,
    ) -> miette::Result<Sequence> {
        let identities = self.identities();
        let mut sequence = Sequence::new(Measure::Pixels, gate_px).into_diagnostic()?;
        for (number, tick) in self.ticks.iter().enumerate() {
            let people: Vec<Sighting> = tick
                .people
                .iter()
                .filter(|person| counts(person))
                .filter_map(|person| Some(Sighting::new(person.id as u32, axes.place(person.pixel?))))
                .collect();
            let tracks: Vec<Sighting> = tick
                .tracks
                .iter()
                .filter_map(|(id, pixel)| Some(Sighting::new(*identities.get(id)?, axes.place(*pixel))))
                .collect();
            sequence
                .push(number as u64, Some(tick.time_s), &people, &tracks)
                .into_diagnostic()?;
        }
        Ok(sequence)
    }
}

impl Tick {
    fn only_speaker(&self) -> Option<&Person> {
        let mut speaking = self.people.iter().filter(|person| person.speaking);
        speaking.next().filter(|_| speaking.next().is_none())
    }
}

impl Axes {
    fn place(self, [u, v]: [f64; 2]) -> Place {
        match self {
            Self::Column => Place::Pixel([u, 0.0]),
            Self::Both => Place::Pixel([u, v]),
        }
    }

    fn distance(self, [u, v]: [f64; 2], [other_u, other_v]: [f64; 2]) -> f64 {
        match self {
            Self::Column => (u - other_u).abs(),
            Self::Both => (u - other_u).hypot(v - other_v),
        }
    }
}

fn middle(head: &BoxRecord) -> [f64; 2] {
    [head.left + head.width / 2.0, head.top + head.height / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(number: usize, tracks: &[(u64, f64)], speaking: [bool; 2], speaker: Option<u64>) -> Tick {
        let person = |id: u64, u: f64| Person {
            id,
            pixel: Some([u, 50.0]),
            visible: true,
            speaking: speaking[id as usize - 1],
        };
        Tick {
            time_s: number as f64 * 0.1,
            people: vec![person(1, 100.0), person(2, 200.0)],
            tracks: tracks.iter().map(|(id, u)| (*id, [*u, 50.0])).collect(),
            speaker,
            heard: None,
        }
    }

    #[test]
    fn a_lost_track_is_judged_where_it_was_and_another_one_is_a_switch() {
        let tracks: [&[(u64, f64)]; 4] = [&[], &[(7, 102.0)], &[], &[(8, 104.0)]];
        let ticks = tracks
            .iter()
            .enumerate()
            .map(|(n, tracks)| tick(n, tracks, [false; 2], None));
        let observed = Observed {
            ticks: ticks.collect(),
            interval_s: 0.1,
        };
        let following = observed.following(1, 30.0, Axes::Column).unwrap().unwrap();
        assert!(
            (following.error_px - (2.0 + 2.0 + 4.0) / 3.0).abs() < 1e-12,
            "{following:?}"
        );
        assert_eq!((following.switches, following.share), (1.0, 0.5));
        assert_eq!(observed.following(2, 30.0, Axes::Both).unwrap(), None);
    }

    #[test]
    fn the_speaker_is_right_where_the_mark_is_on_their_track() {
        let tracks: &[(u64, f64)] = &[(7, 101.0), (8, 199.0)];
        let said = [
            ([true, false], Some(7)),
            ([true, false], Some(8)),
            ([false, true], Some(8)),
            ([true, true], None),
        ];
        let ticks = said
            .iter()
            .enumerate()
            .map(|(n, (speaking, speaker))| tick(n, tracks, *speaking, *speaker));
        let observed = Observed {
            ticks: ticks.collect(),
            interval_s: 0.1,
        };
        assert_eq!(observed.right_speaker(30.0).unwrap(), Some(2.0 / 3.0));
    }

    #[test]
    fn what_is_heard_is_judged_by_the_only_one_who_speaks() {
        let said = [
            ([true, false], 104.0),
            ([true, true], 300.0),
            ([false, true], 190.0),
        ];
        let ticks = said.iter().enumerate().map(|(n, (speaking, heard))| Tick {
            heard: Some(*heard),
            ..tick(n, &[], *speaking, None)
        });
        let mut observed = Observed {
            ticks: ticks.collect(),
            interval_s: 0.1,
        };
        assert_eq!(observed.hearing_error(), Some((4.0 + 10.0) / 2.0));
        observed.ticks.truncate(0);
        assert_eq!(observed.hearing_error(), None);
    }

    #[test]
    fn a_run_that_marks_who_speaks_has_no_diarization_error() {
        let said = |number: usize| [number < 20, number >= 30];
        let speaker = |number: usize| match said(number) {
            [true, _] => Some(7),
            [_, true] => Some(8),
            _ => None,
        };
        let tracks: &[(u64, f64)] = &[(7, 101.0), (8, 199.0)];
        let ticks = (0..50).map(|number| tick(number, tracks, said(number), speaker(number)));
        let mut observed = Observed {
            ticks: ticks.collect(),
            interval_s: 0.1,
        };
        assert!(observed.diarization_error().unwrap() < 1e-9);
        for tick in &mut observed.ticks[30..] {
            tick.speaker = Some(7);
        }
        assert!(observed.diarization_error().unwrap() > 0.4);
    }
}
