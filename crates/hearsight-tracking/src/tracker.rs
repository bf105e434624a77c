//! One view: a camera, perhaps an array, and the people in its picture.
//!
//! A step runs the system's stages for every belief and scout, then the life cycle over all of them, then decides who
//! speaks. Saved state ([`ViewState`]) and scratch memory are apart.

mod by_sound;
mod restore;

pub use restore::MOST_NUMBERED;

use crate::belief::{Appearance, Belief, Existence, Portrait};
use crate::body::{Body, Part};
use crate::closed_loop::Verdict;
use crate::life_cycle::{
    Association, AssociationSettings, BirthSettings, EncounterSettings, ExclusionSettings, ExistenceSettings,
    Memory, ReEntrySettings, Situation, bodies, body_part_rate, covers, is_clear_of_edges, is_nearer,
    log_ratio, may_begin, may_publish, meet, same_place, settle, surroundings, weaker,
};
use crate::momentum::{self, MomentumSettings};
use crate::percepts::{ArrayPercepts, CameraPercepts, Turn};
use crate::speaker::{Speaker, SpeakerSettings, Voice, decide};
use crate::stage::{self, Scratch, Sight, Stage};
use hearsight_core::{Instant, Rectangle, Span};
use hearsight_filter::{FilterError, Generator, Particles, generator};
use hearsight_vision::histogram::Histogram;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the colours of a person are learnt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AppearanceSettings {
    /// Time after which old colours have faded to a third, seconds of detection. Default 2. Raising it keeps to the
    /// colours at birth, lowering it drifts more easily.
    pub memory_s: f64,
    /// Share of a part that must be inside the picture before it is learnt, 0 to 1. Default 0.6.
    pub inside: f32,
}

impl Default for AppearanceSettings {
    fn default() -> Self {
        Self {
            memory_s: 2.0,
            inside: 0.6,
        }
    }
}

/// Everything that a view tracker is made of; a system fills this in.
pub struct Composition {
    /// From states to regions and sounds.
    pub body: Box<dyn Body>,
    /// The filter.
    pub stages: Vec<Stage>,
    /// Particles a belief.
    pub particles: usize,
    /// Seed of the run.
    pub seed: u64,
    /// What distinguishes this view's random numbers from those of other views.
    pub role: String,
    /// How people move on.
    pub momentum: MomentumSettings,
    /// Which detection belongs to whom.
    pub association: AssociationSettings,
    /// Who becomes a track.
    pub birth: BirthSettings,
    /// Who stays one.
    pub existence: ExistenceSettings,
    /// Who is one with another.
    pub exclusion: ExclusionSettings,
    /// Who is who after a meeting.
    pub encounter: EncounterSettings,
    /// Who comes back.
    pub re_entry: ReEntrySettings,
    /// How colours are learnt.
    pub appearance: AppearanceSettings,
    /// Who speaks.
    pub speaker: SpeakerSettings,
}

/// What is remembered from step to step: saved and restored.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ViewState {
    /// Everyone believed in, published or not, in the order of their birth.
    pub beliefs: Vec<Belief>,
    /// Everyone who left.
    pub memory: Memory,
    /// Who speaks.
    pub speaker: Speaker,
    next_number: u64,
    last: Option<Instant>,
}

/// Tracks the people in one view.
pub struct ViewTracker {
    composition: Composition,
    state: ViewState,
    association: Association,
    scratch: Scratch,
    detections: Vec<Rectangle>,
    faces: Vec<bool>,
    appearances: Vec<Appearance>,
    weights: Vec<(Rectangle, f32)>,
    covers: Vec<Rectangle>,
    voices: Vec<Voice>,
    histogram: Histogram,
    quarantined: u64,
    turn: Option<Turn>,
}

impl ViewTracker {
    /// A tracker that believes in nobody yet.
    pub fn new(composition: Composition) -> Self {
        Self {
            composition,
            state: ViewState::default(),
            association: Association::default(),
            scratch: Scratch::default(),
            detections: Vec::new(),
            faces: Vec::new(),
            appearances: Vec::new(),
            weights: Vec::new(),
            covers: Vec::new(),
            voices: Vec::new(),
            histogram: Histogram::default(),
            quarantined: 0,
            turn: None,
        }
    }

    /// Pictures go all round from now on, and are widened by margins ([`crate::percepts::RoundPicture`]).
    pub fn go_round(&mut self, turn: Turn) {
        self.turn = Some(turn);
    }

    /// What is remembered.
    pub fn state(&self) -> &ViewState {
        &self.state
    }

    /// Goes on from what was remembered; to be checked before by [`ViewTracker::check_state`].
    pub fn set_state(&mut self, state: ViewState) {
        self.state = state;
    }

    /// Everyone who is published now, by age.
    pub fn published(&self) -> impl Iterator<Item = &Belief> {
        self.state
            .beliefs
            .iter()
            .filter(|belief| belief.identity.is_some())
    }

    /// Numbers that were not finite and were set aside since the start.
    pub fn quarantined(&self) -> u64 {
        self.quarantined
    }

    /// Takes a new picture at `now`: runs the filters and the life cycle, except giving identities.
    ///
    /// # Errors
    /// [`FilterError`] where the composition does not fit together.
    pub fn see(
        &mut self,
        camera: &CameraPercepts,
        array: Option<&ArrayPercepts>,
        now: Instant,
    ) -> Result<(), FilterError> {
        let elapsed = self.state.last.map_or(Span::ZERO, |last| now - last);
        self.state.last = Some(now);
        self.gather_detections(camera);
        for belief in &mut self.state.beliefs {
            momentum::move_on(belief, elapsed, &self.composition.momentum)?;
        }
        self.association.solve(
            &self.state.beliefs,
            &self.detections,
            &self.appearances,
            &self.composition.association,
        )?;
        for place in 0..self.state.beliefs.len() {
            self.filter(place, camera, array, elapsed)?;
        }
        self.mark_occluded();
        for place in 0..self.state.beliefs.len() {
            self.judge(place, camera, now, elapsed);
        }
        self.note_encounters();
        settle(
            &mut self.state.beliefs,
            &mut self.state.memory,
            self.composition.re_entry.torso,
            &self.composition.encounter,
        );
        self.exclude(elapsed);
        self.bury();
        self.give_birth(camera, array, now)?;
        self.wrap()
    }

    /// Moves everybody who has left the middle turn of a picture that goes all round by one turn.
    fn wrap(&mut self) -> Result<(), FilterError> {
        let Some(turn) = self.turn else { return Ok(()) };
        for belief in &mut self.state.beliefs {
            let shift = turn.shift(belief.head.centre().0);
            if shift == 0.0 {
                continue;
            }
            belief.head.left += shift;
            for particle in 0..belief.particles.count() {
                let mut state = [0.0; MOST_DIMENSIONS];
                let mut dimensions = 0;
                for (value, from) in state.iter_mut().zip(belief.particles.state(particle)) {
                    *value = from;
                    dimensions += 1;
                }
                state[0] += shift;
                belief.particles.set_state(particle, &state[..dimensions])?;
            }
            if let Some(trackers) = &mut belief.trackers {
                trackers.shift(f64::from(shift))?;
            }
        }
        Ok(())
    }

    /// Listens: updates who speaks. To be called at every moment with sound, after [`ViewTracker::see`].
    pub fn hear(&mut self, array: &ArrayPercepts, elapsed: Span) {
        self.voices.clear();
        let body = self.composition.body.as_ref();
        for belief in &self.state.beliefs {
            let mut state = [0.0; 4];
            body.state_from_head(&belief.head, &mut state);
            let delay = |state: &[f32]| body.sound_point(state).and_then(|point| array.delay_s(point));
            let delay_s = delay(&state);
            // The column is what the delay hangs on: the spread of the belief, and where in the head the mouth is.
            let delay_beside = |pixels: f32| {
                let mut state = state;
                state[0] += pixels;
                delay(&state)
            };
            let longer_s = |pixels: f32| {
                delay_beside(pixels)
                    .zip(delay_beside(-pixels))
                    .map_or(0.0, |(right, left)| 0.5 * array.difference(left, right))
            };
            let mouth_px = self.composition.speaker.mouth_aside as f32 * belief.head.width;
            self.voices.push(Voice {
                number: belief.number,
                existence: belief.existence.probability(),
                scout: belief.identity.is_none(),
                delay_s,
                deviation_s: longer_s(belief.deviation[0]).abs(),
                aside_s: longer_s(mouth_px),
            });
        }
        self.state.speaker.listen(
            &self.voices,
            array.direction(),
            elapsed,
            &self.composition.speaker,
        );
        for belief in &mut self.state.beliefs {
            belief.speaking = self.state.speaker.probability_of(belief.number);
        }
    }

    /// The identity of the track that speaks, if any does.
    pub fn speaking(&self) -> Option<u64> {
        let tracks = self
            .published()
            .filter_map(|belief| Some((belief.identity?, belief.speaking)));
        decide(tracks, &self.composition.speaker)
    }

    /// The probability that no track speaks; `None` before the first moment that was listened to.
    pub fn nobody_probability(&self) -> Option<f64> {
        let somebody: f64 = self.published().map(|belief| belief.speaking).sum();
        let listened = self.state.speaker.has_listened();
        listened.then(|| (1.0 - somebody).clamp(0.0, 1.0))
    }

    /// Publishes the scouts that have earned it: known people get their old identity, others the next one.
    pub fn publish(&mut self, camera: &CameraPercepts, now: Instant, next_identity: &mut u64) {
        let (width, height) = camera.size();
        let picture = Rectangle::new(0.0, 0.0, width as f32, height as f32);
        let settings = &self.composition.re_entry;
        for belief in &mut self.state.beliefs {
            let mut state = [0.0; 4];
            self.composition.body.state_from_head(&belief.head, &mut state);
            let torso = self.composition.body.region(&state, Part::Torso);
            let inside = torso.intersection(&picture).area() / torso.area().max(1.0);
            let seen_well = belief.encounter.is_none() && belief.portrait.sights(Part::Torso) >= LEAST_SIGHTS;
            let second_look = seen_well
                && belief
                    .unknown_since
                    .is_some_and(|since| (now - since).seconds() >= settings.second_look_s);
            let first_look =
                belief.identity.is_none() && may_publish(belief, now, inside, &self.composition.birth);
            if !(first_look || second_look) {
                continue;
            }
            let known =
                self.state
                    .memory
                    .recognize(&belief.portrait, belief.born, now, second_look, settings);
            belief.looks = belief.looks.saturating_add(u32::from(second_look));
            let again = known.is_none() && belief.looks < settings.looks;
            belief.unknown_since = again.then_some(now);
            if let Some((identity, older)) = known {
                belief.identity = Some(identity);
                belief.portrait.join(&older);
            } else if first_look {
                *next_identity += 1;
                belief.identity = Some(*next_identity);
            }
        }
    }

    /// Collects the detections of this picture and the colours at each.
    fn gather_detections(&mut self, camera: &CameraPercepts) {
        self.detections.clear();
        self.faces.clear();
        for detection in camera.detections() {
            self.detections.push(detection.region);
            self.faces.push(detection.is_face);
        }
        self.appearances.resize_with(
            self.detections.len().max(self.appearances.len()),
            Appearance::default,
        );
        for (detection, appearance) in self.detections.iter().zip(&mut self.appearances) {
            let mut state = [0.0; 4];
            self.composition.body.state_from_head(detection, &mut state);
            for part in Part::ALL {
                let region = self.composition.body.region(&state, part);
                let inside = camera.histogram(&region, &mut self.histogram);
                appearance.set(part, (inside >= 0.4).then_some(&self.histogram));
            }
        }
    }

    /// Runs the stages on one belief and summarizes its particles.
    fn filter(
        &mut self,
        place: usize,
        camera: &CameraPercepts,
        array: Option<&ArrayPercepts>,
        elapsed: Span,
    ) -> Result<(), FilterError> {
        self.weights.clear();
        let own = self.association.detection_of(place);
        for (number, detection) in self.detections.iter().enumerate() {
            if own == Some(number) {
                self.weights.push((*detection, 1.0));
            }
        }
        self.covers.clear();
        if own.is_none() {
            let behind = &self.state.beliefs[place];
            for (other, front) in self.state.beliefs.iter().enumerate() {
                if front.identity.is_some()
                    && self.association.detection_of(other).is_some()
                    && other != place
                    && is_nearer(front, behind)
                {
                    self.covers.extend(bodies(&front.head_beside(&behind.head)));
                }
            }
        }
        let belief = &mut self.state.beliefs[place];
        let sight = Sight {
            body: self.composition.body.as_ref(),
            camera,
            array,
            detections: &self.weights,
            covers: &self.covers,
            elapsed,
        };
        let awaited = belief.head;
        self.quarantined += stage::run(&self.composition.stages, belief, &sight, &mut self.scratch)? as u64;
        summarize(belief, self.composition.body.as_ref());
        let detection = own.map(|number| &self.detections[number]);
        momentum::learn(
            &mut belief.velocity_px_s,
            &awaited,
            detection,
            elapsed,
            &self.composition.momentum,
        );
        Ok(())
    }

    /// Says of each belief whether somebody nearer covers it.
    fn mark_occluded(&mut self) {
        for place in 0..self.state.beliefs.len() {
            let detected = self.association.detection_of(place).is_some();
            let hidden = !detected
                && self.state.beliefs.iter().enumerate().any(|(other, front)| {
                    other != place && front.identity.is_some() && covers(front, &self.state.beliefs[place])
                });
            self.state.beliefs[place].occluded = hidden;
        }
    }

    /// Whether somebody else's head or body is in the way of the colours at a detection.
    fn is_mixed(&self, place: usize, detection: &Rectangle) -> bool {
        let own = bodies(detection);
        self.state.beliefs.iter().enumerate().any(|(other, belief)| {
            other != place
                && belief.identity.is_some()
                && bodies(&belief.head_beside(detection)).iter().any(|theirs| {
                    own.iter()
                        .any(|own| own.intersection(theirs).area() > 0.1 * own.area())
                })
        })
    }

    /// Adds the evidence of this picture to one belief, and learns its colours.
    fn judge(&mut self, place: usize, camera: &CameraPercepts, now: Instant, elapsed: Span) {
        let detection = self.association.detection_of(place);
        let mixed = detection.is_some_and(|number| self.is_mixed(place, &self.detections[number]));
        let belief = &mut self.state.beliefs[place];
        let situation = if outside(&belief.head, camera.size()) {
            Situation::Outside
        } else if detection.is_some() {
            Situation::Detected
        } else if !is_clear_of_edges(&belief.head, camera.size().0, &self.composition.birth) {
            Situation::Leaving
        } else if belief.occluded {
            Situation::Occluded
        } else {
            let verdict = belief.trackers.as_ref().map(|trackers| trackers.verdict);
            let absent = camera.change_share(&belief.head).is_some_and(|share| share < 0.5);
            match verdict {
                // Who sits still for long becomes background, and is there all the same.
                Some(Verdict::Verified) => Situation::Verified,
                _ if absent => Situation::Absent,
                None | Some(Verdict::Open) => Situation::Present,
                Some(Verdict::Refuted) => Situation::Refuted,
            }
        };
        belief.existence.add(log_ratio(
            situation,
            elapsed.seconds(),
            &self.composition.existence,
        ));
        if let Some(detection) = detection {
            belief.supported = now;
            belief.face_seen |= self.faces[detection];
            belief.support = belief.support + elapsed;
            let body = body_bounds(&belief.head);
            let stirred = camera.stirred_share(&body).unwrap_or(0.0);
            let share = if self.faces[detection] { 1.0 } else { stirred };
            belief.stirred_s += f64::from(share) * elapsed.seconds();
            let rate = 1.0 - (-elapsed.seconds() / self.composition.appearance.memory_s.max(1e-3)).exp();
            if mixed {
                return;
            }
            if let Some(encounter) = &mut belief.encounter {
                encounter.apart_s += elapsed.seconds();
            }
            // Colours are learnt where the detection is, not where the particles are: a belief that has slipped onto
            // hair alone would otherwise teach itself that hair is all there is.
            let mut state = [0.0; 4];
            self.composition
                .body
                .state_from_head(&self.detections[detection], &mut state);
            for part in Part::ALL {
                let region = self.composition.body.region(&state, part);
                let inside = camera.histogram(&region, &mut self.histogram);
                if inside >= self.composition.appearance.inside {
                    belief.appearance.learn(part, &self.histogram, rate as f32);
                    match &mut belief.encounter {
                        Some(encounter) => encounter.since.add(part, &self.histogram),
                        None => belief.portrait.add(part, &self.histogram),
                    }
                }
            }
        }
    }

    /// Notes which published people stand at one place, so that they are compared when they are apart again.
    fn note_encounters(&mut self) {
        for first in 0..self.state.beliefs.len() {
            for second in first + 1..self.state.beliefs.len() {
                let [a, b] = [&self.state.beliefs[first], &self.state.beliefs[second]];
                let published = a.identity.is_some() && b.identity.is_some();
                if published && same_place(a, b, &self.composition.exclusion) {
                    meet(&mut self.state.beliefs, first, second);
                }
            }
        }
    }

    /// Lets beliefs die that are part of another's body, or at one place with a stronger one, for too long.
    fn exclude(&mut self, elapsed: Span) {
        let settings = self.composition.exclusion;
        let mut condemned = Vec::new();
        for place in 0..self.state.beliefs.len() {
            let beliefs = &self.state.beliefs;
            let own = &beliefs[place];
            let others = || beliefs.iter().filter(|other| other.number != own.number);
            let detected = self.association.detection_of(place).is_some();
            let engulfed = others()
                .map(|whole| body_part_rate(own, detected, whole, &settings))
                .fold(0.0, f64::max);
            let merged = others()
                .any(|other| same_place(own, other, &settings) && weaker(own, other).number == own.number);
            let belief = &mut self.state.beliefs[place];
            belief.body_part_s = counted(belief.body_part_s, engulfed, elapsed);
            belief.merged_s = counted(belief.merged_s, if merged { 1.0 } else { 0.0 }, elapsed);
            let patience_s = if belief.identity.is_some() {
                settings.patience_s
            } else {
                0.0
            };
            if belief.body_part_s > settings.body_part_s || belief.merged_s > patience_s {
                condemned.push(belief.number);
            }
        }
        for number in condemned {
            if let Some(place) = self
                .state
                .beliefs
                .iter()
                .position(|belief| belief.number == number)
            {
                let belief = self.state.beliefs.remove(place);
                // A part of another's body never was a person of its own; one of two at one place may have been.
                let long = belief.support.seconds() >= self.composition.re_entry.least_s;
                if let Some(identity) = belief
                    .identity
                    .filter(|_| long && belief.merged_s > belief.body_part_s)
                {
                    self.state
                        .memory
                        .remember(identity, belief.portrait, belief.supported);
                }
            }
        }
    }

    fn bury(&mut self) {
        let least = self.composition.existence.least;
        while let Some(place) = self
            .state
            .beliefs
            .iter()
            .position(|belief| belief.existence.probability() < least)
        {
            let belief = self.state.beliefs.remove(place);
            let known_s = belief.support.seconds();
            if let Some(identity) = belief.identity
                && known_s >= self.composition.re_entry.least_s
            {
                self.state
                    .memory
                    .remember(identity, belief.portrait, belief.supported);
            }
        }
    }

    /// Whether somebody who is not seen talks at the delay of a detection.
    fn is_heard(&self, detection: &Rectangle, array: Option<&ArrayPercepts>) -> bool {
        let mut state = [0.0; 4];
        let body = self.composition.body.as_ref();
        body.state_from_head(detection, &mut state);
        array
            .zip(body.sound_point(&state))
            .and_then(|(array, point)| array.delay_s(point))
            .is_some_and(|delay_s| {
                let heard = self.state.speaker.unseen_near(delay_s, &self.composition.speaker);
                heard >= self.composition.birth.talking
            })
    }

    /// Starts scouts on detections that belong to nobody.
    fn give_birth(
        &mut self,
        camera: &CameraPercepts,
        array: Option<&ArrayPercepts>,
        now: Instant,
    ) -> Result<(), FilterError> {
        for number in 0..self.detections.len() {
            let detection = self.detections[number];
            let settings = &self.composition.birth;
            let crowded = camera
                .change_share(&surroundings(&detection))
                .is_some_and(|share| share > settings.crowded);
            // Where an unseen talker is heard, half a body at the edge of the picture is enough.
            let doubtful = !is_clear_of_edges(&detection, camera.size().0, settings)
                || camera.detections()[number].score < settings.score;
            // What lies in a margin is seen in the middle turn too.
            let again = self
                .turn
                .is_some_and(|turn| turn.shift(detection.centre().0) != 0.0);
            if again
                || self.association.is_taken(number)
                || (crowded && !self.faces[number])
                || (doubtful && !self.is_heard(&detection, array))
                || !may_begin(&detection, &self.state.beliefs, &self.composition.birth)
            {
                continue;
            }
            let belief_number = self.state.next_number;
            self.state.next_number += 1;
            let mut random = generator(self.composition.seed, &self.composition.role, belief_number);
            let mut particles =
                Particles::new(self.composition.body.dimensions(), self.composition.particles)?;
            let (mut mean, mut deviation) = ([0.0; MOST_DIMENSIONS], [0.0; MOST_DIMENSIONS]);
            let dimensions = self.composition.body.dimensions().min(MOST_DIMENSIONS);
            self.composition
                .body
                .state_from_head(&detection, &mut mean[..dimensions]);
            self.composition
                .body
                .first_deviations(&detection, &mut deviation[..dimensions]);
            let mean = mean.map(f64::from);
            particles.draw_gaussian(&mean[..dimensions], &deviation[..dimensions], &mut random)?;
            let mut appearance = Appearance::default();
            for part in Part::ALL {
                if let Some(histogram) = self.appearances[number].part(part) {
                    appearance.learn(part, histogram, 1.0);
                }
            }
            let mut belief = newborn(belief_number, particles, random, detection, now);
            belief.appearance = appearance;
            belief.turn_px = self.turn.map_or(0.0, |turn| turn.columns as f32);
            belief.face_seen = self.faces[number];
            self.state.beliefs.push(belief);
        }
        Ok(())
    }
}

/// A scout that has just begun.
fn newborn(number: u64, particles: Particles, generator: Generator, head: Rectangle, now: Instant) -> Belief {
    Belief {
        number,
        identity: None,
        effective_sample_size: particles.count() as f64,
        particles,
        generator,
        appearance: Appearance::default(),
        portrait: Portrait::default(),
        encounter: None,
        unknown_since: None,
        looks: 0,
        existence: Existence::even(),
        occluded: false,
        body_part_s: 0.0,
        merged_s: 0.0,
        born: now,
        born_height_px: head.height,
        supported: now,
        support: Span::ZERO,
        face_seen: false,
        stirred_s: 0.0,
        head,
        turn_px: 0.0,
        velocity_px_s: [0.0; 2],
        deviation: [0.0; 2],
        speaking: 0.0,
        trackers: None,
    }
}

/// Mean and deviation of the particles. After resampling all weights are equal, and the mean is that of eq. 14
/// (corrected by E8) up to the noise of resampling.
fn summarize(belief: &mut Belief, body: &dyn Body) {
    let mut mean = [0.0_f32; 4];
    for (dimension, value) in mean.iter_mut().enumerate() {
        *value = belief.particles.mean_of(dimension) as f32;
    }
    let head = body.head_from_state(&mean);
    if head.is_finite() {
        belief.head = head;
        belief.deviation = [0, 1].map(|dimension| {
            belief
                .particles
                .covariance_of(dimension, dimension)
                .max(0.0)
                .sqrt() as f32
        });
    }
}

/// Seconds for which something held: they grow at `rate` while it holds and shrink while it does not (`rate` 0).
fn counted(before_s: f64, rate: f64, elapsed: Span) -> f64 {
    let change_s = if rate > 0.0 {
        rate * elapsed.seconds()
    } else {
        -elapsed.seconds()
    };
    (before_s + change_s).max(0.0)
}

/// Longest state of a body.
const MOST_DIMENSIONS: usize = 8;

/// Pictures in which clothing must have been seen before somebody unknown is looked at once more.
const LEAST_SIGHTS: u32 = 5;

/// Whether the mouth has left the picture.
fn outside(head: &Rectangle, (width, height): (usize, usize)) -> bool {
    let (x, _) = head.centre();
    let mouth = head.top + 0.75 * head.height;
    x < 0.0 || x > width as f32 || mouth < 0.0 || mouth > height as f32
}

/// Head and upper body, where movement is looked for.
fn body_bounds(head: &Rectangle) -> Rectangle {
    let (x, _) = head.centre();
    Rectangle::new(
        x - 1.25 * head.width,
        head.top,
        2.5 * head.width,
        3.5 * head.height,
    )
}
