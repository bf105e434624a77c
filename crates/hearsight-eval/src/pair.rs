//! Both sides to cases: which pictures belong together, which instants, and who counts.
//!
//! Pictures are paired by the camera's name, or because there is only one on either side, and their frames by number. The
//! world is paired by time: each instant of the truth has the nearest one of the tracks within half of the truth's
//! interval.
//!
//! People who do not count are taken out, and with them the tracks on them: a track that fits nobody who counts but lies
//! within the gate of somebody who does not.

use crate::case::Case;
use crate::matching::{Aim, Edge, Matcher};
use crate::measure::{Measure, Place};
use crate::metrics::JudgeError;
use crate::recording::{Observation, ObservedFrame, Recording, Scope, Stream, median_interval_s};
use crate::sequence::{Sequence, SequenceError, Sighting};
use crate::speech::Speech;
use thiserror::Error;

/// How a judgement is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// What distances are; none for overlaps where both sides have boxes, pixels where both have pictures, else metres.
    pub measure: Option<Measure>,
    /// Pairs farther apart are no match; none for [`Measure::default_gate`].
    pub gate: Option<f64>,
    /// The camera whose picture is judged; none for all that both sides have.
    pub camera: Option<String>,
    /// People of whom less can be seen do not count, 0 to 1.
    pub least_visibility: f64,
    /// Seconds cut out around each boundary of the truth's speech, half on either side.
    pub collar_s: f64,
    /// Whether time at which the truth has several speakers is cut out.
    pub skip_overlap: bool,
    /// Where azimuths are taken from, x and y in metres.
    pub azimuth_from_m: Option<[f64; 2]>,
}

/// Why two sides cannot be judged together.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PairError {
    /// The sides have nothing of the same kind.
    #[error(
        "the truth has {truth} and the tracks have {tracks}: nothing to compare{wanted}; name other files or formats"
    )]
    NothingInCommon {
        /// What the truth has.
        truth: String,
        /// What the tracks have.
        tracks: String,
        /// What was asked for.
        wanted: String,
    },
    /// There is nothing on either side.
    #[error("both sides are empty: there is nothing to judge; name files with rows in them")]
    Empty,
    /// No camera is on both sides.
    #[error(
        "the cameras of the truth are {truth}, those of the tracks {tracks}: none is {wanted}; choose one by --camera"
    )]
    NoSuchCamera {
        /// Cameras of the truth.
        truth: String,
        /// Cameras of the tracks.
        tracks: String,
        /// What was looked for.
        wanted: String,
    },
    /// An option outside its range.
    #[error("{what} must be {range}, found {found}")]
    OutOfRange {
        /// The option.
        what: &'static str,
        /// Its range in words.
        range: &'static str,
        /// The value that came.
        found: f64,
    },
    /// More than can be judged.
    #[error(transparent)]
    Judge(#[from] JudgeError),
}

impl From<SequenceError> for PairError {
    fn from(error: SequenceError) -> Self {
        Self::Judge(error.into())
    }
}

/// What is judged, and what was left out.
#[derive(Clone, Debug, Default)]
pub struct Paired {
    /// One case a picture, or the world; speech is in the only one or in one of its own.
    pub cases: Vec<Case>,
    /// What was left out and what is odd, sentences for people.
    pub notes: Vec<String>,
}

/// Brings two sides together. `name` is put before the names of cameras.
///
/// # Errors
/// [`PairError`].
pub fn pair(
    name: &str,
    truth: &Recording,
    tracks: &Recording,
    options: &Options,
) -> Result<Paired, PairError> {
    check(options)?;
    let mut paired = Paired::default();
    let sides = [(truth, "truth"), (tracks, "tracks")];
    match sides.map(|(recording, _)| recording.is_empty()) {
        [true, true] => return Err(PairError::Empty),
        [true, false] => paired
            .notes
            .push("the truth is empty: all that was found is false".to_owned()),
        [false, true] => paired
            .notes
            .push("the tracks are empty: all that is so was missed".to_owned()),
        [false, false] => {}
    }
    let speech = speech(truth, tracks, options);
    let measure = match options.measure {
        Some(measure) => Some(measure),
        None => common_measure(truth, tracks),
    };
    if let Some(measure) = measure {
        let placed = |side: &Recording| {
            let mut all = side.streams.iter().flat_map(Stream::observations);
            all.any(|observation| measure.can_use(&observation.seen.place))
        };
        for (recording, side) in sides.iter().filter(|(side, _)| !side.names.is_empty()) {
            if !placed(recording) {
                let unit = format!("{measure:?}").to_lowercase();
                paired.notes.push(format!(
                    "nobody of the {side} has a place that can be compared by {unit}"
                ));
            }
        }
        let streams = match measure {
            Measure::Metres => worlds(truth, tracks),
            Measure::Overlap | Measure::Pixels => pictures(truth, tracks, options.camera.as_deref())?,
        };
        for (of_truth, of_tracks) in streams {
            let sequence = Joining::new(measure, options, &mut paired.notes).join(of_truth, of_tracks)?;
            let camera = of_truth.camera().or(of_tracks.camera());
            let mut case = Case::new(full_name(name, camera), sequence)?;
            case.azimuth_from_m = options.azimuth_from_m;
            case.people.clone_from(&truth.names);
            case.tracks.clone_from(&tracks.names);
            paired.cases.push(case);
        }
    }
    match (speech, paired.cases.as_mut_slice()) {
        (Some(speech), [case]) => case.speech = Some(speech),
        (Some(speech), _) => {
            let nobody = Sequence::new(Measure::Metres, 1.0)?;
            let mut case = Case::new(full_name(name, Some("speech")), nobody)?;
            case.speech = Some(speech);
            paired.cases.push(case);
        }
        // Pictures without a frame that is judged are nothing either.
        (None, cases) if cases.iter().all(|case| case.sequence.is_empty()) => {
            return Err(nothing_in_common(truth, tracks, options));
        }
        (None, _) => {}
    }
    for (recording, side) in sides {
        if recording.set_aside > 0 {
            paired.notes.push(format!(
                "{} rows of the {side} were set aside: a number was not finite",
                recording.set_aside
            ));
        }
    }
    Ok(paired)
}

fn full_name(name: &str, camera: Option<&str>) -> String {
    match camera {
        Some(camera) if name.is_empty() => camera.to_owned(),
        Some(camera) if camera != name => format!("{name} {camera}"),
        _ if name.is_empty() => "all".to_owned(),
        _ => name.to_owned(),
    }
}

fn check(options: &Options) -> Result<(), PairError> {
    let bounded = |what, range, found: f64, good: bool| {
        if good {
            Ok(())
        } else {
            Err(PairError::OutOfRange { what, range, found })
        }
    };
    if let Some(gate) = options.gate {
        bounded(
            "the gate",
            "a number above 0",
            gate,
            gate > 0.0 && gate.is_finite(),
        )?;
    }
    let visible = options.least_visibility;
    bounded(
        "the least visibility",
        "0 to 1",
        visible,
        (0.0..=1.0).contains(&visible),
    )?;
    let collar = options.collar_s;
    bounded(
        "the collar",
        "seconds from 0 on",
        collar,
        collar >= 0.0 && collar.is_finite(),
    )?;
    for from in options.azimuth_from_m.into_iter().flatten() {
        bounded("the place of azimuths", "finite", from, from.is_finite())?;
    }
    Ok(())
}

fn common_measure(truth: &Recording, tracks: &Recording) -> Option<Measure> {
    let both = |wanted: fn(&Place) -> bool| truth.has(wanted) && tracks.has(wanted);
    let scopes = |picture: bool| {
        let has = |side: &Recording| side.streams.iter().any(|s| (s.scope != Scope::World) == picture);
        has(truth) && has(tracks)
    };
    if both(|place| matches!(place, Place::Box(_))) {
        Some(Measure::Overlap)
    } else if both(|place| place.pixel().is_some()) {
        Some(Measure::Pixels)
    } else if both(|place| matches!(place, Place::World(_))) {
        Some(Measure::Metres)
    } else if scopes(true) {
        // One side is empty: what the other has decides.
        let points_only = truth.has(|place| matches!(place, Place::Pixel(_)));
        Some(if points_only {
            Measure::Pixels
        } else {
            Measure::Overlap
        })
    } else {
        // Who has tracks but no place for them does not know the world, and has missed nobody there.
        let is_world = |place: &Place| matches!(place, Place::World(_));
        let knows = |side: &Recording| side.names.is_empty() || side.has(is_world);
        (scopes(false) && knows(truth) && knows(tracks)).then_some(Measure::Metres)
    }
}

fn worlds<'a>(truth: &'a Recording, tracks: &'a Recording) -> Vec<(&'a Stream, &'a Stream)> {
    let world = |side: &'a Recording| side.streams.iter().find(|stream| stream.scope == Scope::World);
    world(truth).zip(world(tracks)).into_iter().collect()
}

fn pictures<'a>(
    truth: &'a Recording,
    tracks: &'a Recording,
    camera: Option<&str>,
) -> Result<Vec<(&'a Stream, &'a Stream)>, PairError> {
    let of = |side: &'a Recording| -> Vec<&'a Stream> {
        let all = side.streams.iter();
        all.filter(|stream| stream.scope != Scope::World).collect()
    };
    let (of_truth, of_tracks) = (of(truth), of(tracks));
    let fits = |stream: &&Stream, name: &str| stream.camera() == Some(name);
    // A picture without a name, alone on its side, is whichever is asked for.
    let choose = |side: &[&'a Stream], name: &str| match side {
        [only] if only.camera().is_none() => Some(*only),
        _ => side.iter().copied().find(|stream| fits(stream, name)),
    };
    let found: Vec<(&Stream, &Stream)> = match (camera, of_truth.as_slice(), of_tracks.as_slice()) {
        (Some(name), _, _) => {
            let both = choose(&of_truth, name).zip(choose(&of_tracks, name));
            both.into_iter().collect()
        }
        (None, [one], [other]) => vec![(*one, *other)],
        (None, _, _) => {
            let named = of_truth.iter().filter_map(|stream| {
                let other = choose(&of_tracks, stream.camera()?)?;
                Some((*stream, other))
            });
            named.collect()
        }
    };
    if found.is_empty() {
        let names = |side: &[&Stream]| {
            let names = side
                .iter()
                .map(|stream| stream.camera().unwrap_or("without a name"));
            let names: Vec<&str> = names.take(10).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        return Err(PairError::NoSuchCamera {
            truth: names(&of_truth),
            tracks: names(&of_tracks),
            wanted: camera.map_or("in both".to_owned(), |name| format!("`{name}`")),
        });
    }
    Ok(found)
}

fn speech(truth: &Recording, tracks: &Recording, options: &Options) -> Option<Speech> {
    let (of_truth, of_tracks) = truth.turns.as_ref().zip(tracks.turns.as_ref())?;
    Some(Speech {
        truth: of_truth.clone(),
        result: of_tracks.clone(),
        span_s: truth.span_s,
        collar_s: options.collar_s,
        skip_overlap: options.skip_overlap,
    })
}

fn nothing_in_common(truth: &Recording, tracks: &Recording, options: &Options) -> PairError {
    let has = |side: &Recording| {
        let mut kinds = Vec::new();
        if side.has(|place| matches!(place, Place::Box(_))) {
            kinds.push("boxes in pictures");
        }
        if side.has(|place| matches!(place, Place::Pixel(_))) {
            kinds.push("points in pictures");
        }
        if side.has(|place| matches!(place, Place::World(_))) {
            kinds.push("places in the world");
        }
        if side.turns.is_some() {
            kinds.push("speech");
        }
        if kinds.is_empty() {
            "nothing".to_owned()
        } else {
            kinds.join(", ")
        }
    };
    PairError::NothingInCommon {
        truth: has(truth),
        tracks: has(tracks),
        wanted: options
            .measure
            .map_or(String::new(), |measure| format!(" by {measure:?}").to_lowercase()),
    }
}

/// Frames of two streams in one sequence.
struct Joining<'a> {
    measure: Measure,
    gate: f64,
    least_visibility: f64,
    notes: &'a mut Vec<String>,
    people: Vec<Sighting>,
    tracks: Vec<Sighting>,
    ignored: Vec<Sighting>,
    edges: Vec<Edge>,
    pairs: Vec<(u32, u32)>,
    matcher: Matcher,
    without_place: u64,
    outside: u64,
}

impl<'a> Joining<'a> {
    fn new(measure: Measure, options: &Options, notes: &'a mut Vec<String>) -> Self {
        Self {
            measure,
            gate: options.gate.unwrap_or(measure.default_gate()),
            least_visibility: options.least_visibility,
            notes,
            people: Vec::new(),
            tracks: Vec::new(),
            ignored: Vec::new(),
            edges: Vec::new(),
            pairs: Vec::new(),
            matcher: Matcher::default(),
            without_place: 0,
            outside: 0,
        }
    }

    fn join(mut self, truth: &Stream, tracks: &Stream) -> Result<Sequence, PairError> {
        let mut sequence = Sequence::new(self.measure, self.gate)?;
        if truth.scope == Scope::World {
            self.by_time(truth, tracks, &mut sequence)?;
        } else {
            self.by_number(truth, tracks, &mut sequence)?;
        }
        let (without_place, outside) = (self.without_place, self.outside);
        if without_place > 0 {
            let kind = format!("{:?}", self.measure).to_lowercase();
            self.notes.push(format!(
                "{without_place} rows have no place that can be compared by {kind}"
            ));
        }
        if outside > 0 {
            self.notes.push(format!(
                "{outside} tracks at instants that the truth does not cover are not judged"
            ));
        }
        Ok(sequence)
    }

    fn by_number(
        &mut self,
        truth: &Stream,
        tracks: &Stream,
        sequence: &mut Sequence,
    ) -> Result<(), PairError> {
        let mut of_truth = truth.frames().peekable();
        let mut of_tracks = tracks.frames().peekable();
        loop {
            let (next_truth, next_tracks) = (of_truth.peek().copied(), of_tracks.peek().copied());
            let (now, found) = match (next_truth, next_tracks) {
                (None, None) => return Ok(()),
                (Some(now), Some(found)) if now.number == found.number => (Some(now), Some(found)),
                (Some(now), Some(found)) if now.number < found.number => (Some(now), None),
                (Some(now), None) => (Some(now), None),
                (_, Some(found)) => (None, Some(found)),
            };
            if now.is_some() {
                of_truth.next();
            }
            if found.is_some() {
                of_tracks.next();
            }
            if now.is_none() && truth.complete {
                self.outside += found.map_or(0, |found| found.observations.len() as u64);
                continue;
            }
            self.push(now, found, sequence)?;
        }
    }

    fn by_time(&mut self, truth: &Stream, tracks: &Stream, sequence: &mut Sequence) -> Result<(), PairError> {
        let times =
            |stream: &Stream| -> Vec<f64> { stream.frames().filter_map(|frame| frame.time_s).collect() };
        let (truth_s, tracks_s) = (times(truth), times(tracks));
        let most_s = median_interval_s(&truth_s) / 2.0 + 1e-6;
        // For each instant of the truth the nearest of the tracks.
        let mut nearest: Vec<Option<usize>> = vec![None; truth_s.len()];
        for (place, time_s) in tracks_s.iter().enumerate() {
            let after = truth_s.partition_point(|truth_s| truth_s < time_s);
            let candidates = [
                after.checked_sub(1),
                Some(after).filter(|&after| after < truth_s.len()),
            ];
            let apart = |&instant: &usize| (truth_s[instant] - time_s).abs();
            let near = candidates
                .into_iter()
                .flatten()
                .filter(|instant| apart(instant) <= most_s);
            let Some(instant) = near.min_by(|one, other| apart(one).total_cmp(&apart(other))) else {
                self.outside += tracks
                    .frame(place)
                    .map_or(0, |frame| frame.observations.len() as u64);
                continue;
            };
            let closer = |known: usize| (truth_s[instant] - tracks_s[known]).abs() <= apart(&instant);
            if !nearest[instant].is_some_and(closer) {
                nearest[instant] = Some(place);
            }
        }
        for (place, now) in truth.frames().filter(|frame| frame.time_s.is_some()).enumerate() {
            let found = nearest[place].and_then(|place| tracks.frame(place));
            self.push(Some(now), found, sequence)?;
        }
        Ok(())
    }

    fn push(
        &mut self,
        truth: Option<ObservedFrame<'_>>,
        found: Option<ObservedFrame<'_>>,
        sequence: &mut Sequence,
    ) -> Result<(), PairError> {
        let instant = truth.or(found).map(|frame| (frame.number, frame.time_s));
        let Some((number, time_s)) = instant else {
            return Ok(());
        };
        let time_s = time_s.or(found.and_then(|frame| frame.time_s));
        self.people.clear();
        self.ignored.clear();
        self.tracks.clear();
        let measure = self.measure;
        let usable = |observation: &&Observation| measure.can_use(&observation.seen.place);
        let of_truth = truth.map_or(&[][..], |frame| frame.observations);
        let of_tracks = found.map_or(&[][..], |frame| frame.observations);
        for person in of_truth.iter().filter(usable) {
            if person.counts && person.visible >= self.least_visibility {
                self.people.push(person.seen);
            } else {
                self.ignored.push(person.seen);
            }
        }
        self.tracks
            .extend(of_tracks.iter().filter(usable).map(|track| track.seen));
        let used = self.people.len() + self.ignored.len() + self.tracks.len();
        self.without_place += (of_truth.len() + of_tracks.len() - used) as u64;
        if !self.ignored.is_empty() {
            self.leave_out_tracks_on_ignored()?;
        }
        sequence.push(number, time_s, &self.people, &self.tracks)?;
        Ok(())
    }

    /// Takes out tracks that fit nobody who counts and lie on somebody who does not.
    fn leave_out_tracks_on_ignored(&mut self) -> Result<(), SequenceError> {
        let (measure, gate) = (self.measure, self.gate);
        let distance = |one: &Sighting, other: &Sighting| {
            let apart = measure.distance(&one.place, &other.place);
            apart.unwrap_or(f64::INFINITY)
        };
        self.edges.clear();
        for (row, person) in self.people.iter().enumerate() {
            for (column, track) in self.tracks.iter().enumerate() {
                let cost = distance(person, track);
                if cost <= gate {
                    let (row, column) = (row as u32, column as u32);
                    self.edges.push(Edge { row, column, cost });
                }
            }
        }
        let (people, tracks) = (self.people.len(), self.tracks.len());
        self.matcher
            .pair(people, tracks, &self.edges, Aim::Most, &mut self.pairs)?;
        let mut place = 0_u32;
        let (pairs, ignored) = (&self.pairs, &self.ignored);
        self.tracks.retain(|track| {
            let fits = pairs.iter().any(|&(_, column)| column == place);
            place += 1;
            fits || !ignored.iter().any(|person| distance(person, track) <= gate)
        });
        Ok(())
    }
}
