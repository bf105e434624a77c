//! One side as it was read, truth or result: who is where in each picture and in the world, and who speaks when.

use crate::sequence::Sighting;
use crate::speech::Turn;
use std::collections::HashMap;

/// Which side a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What is really so.
    Truth,
    /// What was found.
    Tracks,
}

/// One side of a recording.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Pictures and the world, in the order in which they were met.
    pub streams: Vec<Stream>,
    /// Names of people or tracks, by index.
    pub names: Vec<String>,
    /// Who speaks when, by index of [`Recording::speakers`]; none where nothing says so.
    pub turns: Option<Vec<Turn>>,
    /// Names of those who speak, by index.
    pub speakers: Vec<String>,
    /// Start and end of what the turns cover, seconds; none where only they themselves say it.
    pub span_s: Option<[f64; 2]>,
    /// Rows set aside because a number in them was not finite.
    pub set_aside: u64,
}

/// What a stream looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The picture of a camera; the name is none where the file does not tell it.
    Picture(Option<String>),
    /// The world, in metres.
    World,
}

/// Frames of one picture or of the world.
#[derive(Clone, Debug)]
pub struct Stream {
    /// What it looks at.
    pub scope: Scope,
    /// Whether every instant that exists is in it, so that whatever the other side has elsewhere is not judged.
    pub complete: bool,
    /// The frames, by ascending number, or by ascending time in the world.
    frames: Vec<FrameEnd>,
    observations: Vec<Observation>,
}

#[derive(Clone, Copy, Debug)]
struct FrameEnd {
    number: u64,
    time_s: Option<f64>,
    end: usize,
}

/// Somebody at one instant, and whether they count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Who and where.
    pub seen: Sighting,
    /// Whether they count at all. Who does not is neither asked for nor held against a track.
    pub counts: bool,
    /// Part that can be seen, 0 to 1.
    pub visible: f64,
}

/// One frame of a stream.
#[derive(Clone, Copy, Debug)]
pub struct ObservedFrame<'a> {
    /// Number of the frame or tick.
    pub number: u64,
    /// Time, seconds.
    pub time_s: Option<f64>,
    /// Everyone in it.
    pub observations: &'a [Observation],
}

impl Observation {
    /// Somebody who counts and can be seen.
    pub const fn new(seen: Sighting) -> Self {
        Self {
            seen,
            counts: true,
            visible: 1.0,
        }
    }
}

impl Recording {
    /// Whether there is nothing in it: no frame, and no turn of speech.
    pub fn is_empty(&self) -> bool {
        self.streams.iter().all(Stream::is_empty) && self.turns.as_ref().is_none_or(Vec::is_empty)
    }
}

impl Stream {
    /// A stream without frames.
    pub fn new(scope: Scope, complete: bool) -> Self {
        Self {
            scope,
            complete,
            frames: Vec::new(),
            observations: Vec::new(),
        }
    }

    /// Adds a frame.
    pub fn begin(&mut self, number: u64, time_s: Option<f64>) {
        let end = self.observations.len();
        self.frames.push(FrameEnd { number, time_s, end });
    }

    /// Adds somebody to the newest frame; nothing where there is none.
    pub fn push(&mut self, observation: Observation) {
        if let Some(frame) = self.frames.last_mut() {
            self.observations.push(observation);
            frame.end = self.observations.len();
        }
    }

    /// Number of the newest frame.
    pub fn newest(&self) -> Option<u64> {
        self.frames.last().map(|frame| frame.number)
    }

    /// Who is in the newest frame.
    pub fn newest_observations(&self) -> &[Observation] {
        let count = self.frames.len();
        let start = if count > 1 { self.frames[count - 2].end } else { 0 };
        &self.observations[start..]
    }

    /// The frame at a place.
    pub fn frame(&self, place: usize) -> Option<ObservedFrame<'_>> {
        let end = self.frames.get(place)?;
        let start = if place > 0 { self.frames[place - 1].end } else { 0 };
        Some(ObservedFrame {
            number: end.number,
            time_s: end.time_s,
            observations: &self.observations[start..end.end],
        })
    }

    /// The frames in order.
    pub fn frames(&self) -> impl Iterator<Item = ObservedFrame<'_>> + '_ {
        (0..self.frames.len()).filter_map(|place| self.frame(place))
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Name of the camera.
    pub fn camera(&self) -> Option<&str> {
        match &self.scope {
            Scope::Picture(name) => name.as_deref(),
            Scope::World => None,
        }
    }

    /// Everyone, frame by frame.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// Everyone, to be changed where another file knows more of them.
    pub(crate) fn observations_mut(&mut self) -> impl Iterator<Item = (Option<f64>, &mut Observation)> {
        let mut frames = self.frames.iter().peekable();
        self.observations
            .iter_mut()
            .enumerate()
            .map(move |(place, seen)| {
                while frames.next_if(|frame| frame.end <= place).is_some() {}
                (frames.peek().and_then(|frame| frame.time_s), seen)
            })
    }
}

/// Indices for names, from 0 in the order in which they are met.
#[derive(Clone, Debug)]
pub(crate) struct Names<K> {
    known: HashMap<K, u32>,
    pub(crate) names: Vec<String>,
}

impl<K> Default for Names<K> {
    fn default() -> Self {
        Self {
            known: HashMap::new(),
            names: Vec::new(),
        }
    }
}

impl<K: std::hash::Hash + Eq> Names<K> {
    /// The index of a key; a new one with the name where it was never met.
    pub(crate) fn index(&mut self, key: K, name: impl FnOnce() -> String) -> u32 {
        let next = self.names.len() as u32;
        *self.known.entry(key).or_insert_with(|| {
            self.names.push(name());
            next
        })
    }
}

/// Turns from the instants at which somebody speaks: each stands for the time until the next, and those that follow each
/// other are one turn.
#[derive(Clone, Debug, Default)]
pub(crate) struct TurnMaker {
    /// Speaker and number of the instant.
    spoken: Vec<(u32, usize)>,
    times_s: Vec<f64>,
}

impl TurnMaker {
    pub(crate) fn instant(&mut self, time_s: f64) {
        self.times_s.push(time_s);
    }

    /// Somebody speaks at the newest instant.
    pub(crate) fn speaks(&mut self, speaker: u32) {
        self.spoken.push((speaker, self.times_s.len().saturating_sub(1)));
    }

    /// The turns, and start and end of all instants.
    pub(crate) fn finish(mut self) -> (Vec<Turn>, Option<[f64; 2]>) {
        let interval_s = median_interval_s(&self.times_s);
        let end_s = |instant: usize| {
            let now = self.times_s[instant];
            let next = self.times_s.get(instant + 1).copied();
            // After a gap nobody knows.
            next.filter(|next| *next <= now + 1.5 * interval_s)
                .unwrap_or(now + interval_s)
        };
        self.spoken.sort_unstable();
        let mut turns: Vec<Turn> = Vec::new();
        let mut newest: Option<(u32, usize)> = None;
        for &(speaker, instant) in &self.spoken {
            let start_s = self.times_s[instant];
            let goes_on = newest == Some((speaker, instant.wrapping_sub(1)));
            match turns.last_mut().filter(|turn| goes_on && turn.end_s >= start_s) {
                Some(turn) => turn.end_s = end_s(instant),
                None => turns.push(Turn {
                    start_s,
                    end_s: end_s(instant),
                    speaker,
                }),
            }
            newest = Some((speaker, instant));
        }
        let span = self.times_s.first().zip(self.times_s.last());
        (turns, span.map(|(first, last)| [*first, *last + interval_s]))
    }
}

/// The usual time between instants, seconds; 0.04 where there are fewer than two.
pub(crate) fn median_interval_s(times_s: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if intervals.is_empty() {
        return 0.04;
    }
    let middle = intervals.len() / 2;
    *intervals.select_nth_unstable_by(middle, f64::total_cmp).1
}
