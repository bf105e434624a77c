//! All faces in one camera's pictures: partitioned sampling for each, birth, death, identities.

use super::belief::{FaceBelief, Model};
use super::colours::{ColourSettings, FaceColours, SubRegion};
use super::windows::FaceLikelihood;
use crate::belief::Existence;
use crate::percepts::FaceWindow;
use crate::tracker::MOST_NUMBERED;
use hearsight_core::{Instant, Rectangle, RgbView, Span};
use hearsight_filter::{
    FilterError, NormalizationOutcome, Particles, Resampling, fill_standard_normal, generator,
};
use hearsight_vision::VisionError;
use hearsight_vision::histogram::Histogram;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much a face moves by chance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FaceWalk {
    /// Standard deviation of the position after one second, face widths. Default 1.5. Raising it follows faster people and
    /// blurs the rest.
    pub position: f32,
    /// Standard deviation of the logarithm of the width after one second. Default 0.2.
    pub width: f32,
}

impl Default for FaceWalk {
    fn default() -> Self {
        Self {
            position: 1.5,
            width: 0.2,
        }
    }
}

/// Who becomes a track, and who stays one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FaceLifeSettings {
    /// Windows alike that begin a scout. Default 4. Raising it gives fewer false faces.
    pub windows: usize,
    /// For how long windows must support a scout before it is published, seconds. Default 0.3.
    pub support_s: f64,
    /// Change of the logarithm of the odds of existence a second while windows support a face. Default 8.
    pub seen: f64,
    /// The same while only its colours are there. Default -0.4: somebody who turns away for ten seconds is kept.
    pub coloured: f64,
    /// The same while not even those are. Default -4.
    pub missed: f64,
    /// Distance of colours (eq. 16) up to which they are its own, 0 to 1. Default 0.4.
    pub own_colours: f32,
    /// Probability below which a face is given up, 0 to 1. Default 0.1.
    pub least: f64,
    /// Overlap beyond which two beliefs are one face, of which the younger goes, 0 to 1. Default 0.4.
    pub overlap: f32,
    /// Most beliefs at a time. Default 16.
    pub most: usize,
}

impl Default for FaceLifeSettings {
    fn default() -> Self {
        Self {
            windows: 4,
            support_s: 0.3,
            seen: 8.0,
            coloured: -0.4,
            missed: -4.0,
            own_colours: 0.4,
            least: 0.1,
            overlap: 0.4,
            most: 16,
        }
    }
}

/// How faces are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FaceSettings {
    /// Particles a face. Default 50.
    pub particles: usize,
    /// How survivors are drawn, after each partition. Default systematic.
    #[schemars(with = "String")]
    pub resampling: Resampling,
    /// How much a face moves.
    pub walk: FaceWalk,
    /// Likelihood of the windows of cascades.
    pub likelihood: FaceLikelihood,
    /// Likelihood of colours.
    pub colour: ColourSettings,
    /// Birth and death.
    pub life: FaceLifeSettings,
}

impl Default for FaceSettings {
    fn default() -> Self {
        Self {
            particles: 50,
            resampling: Resampling::Systematic,
            walk: FaceWalk::default(),
            likelihood: FaceLikelihood::default(),
            colour: ColourSettings::default(),
            life: FaceLifeSettings::default(),
        }
    }
}

/// What is remembered from picture to picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FaceState {
    /// Every face believed in, published or not, by age.
    pub beliefs: Vec<FaceBelief>,
    next_number: u64,
}

/// Follows the faces in one camera's pictures.
pub struct FaceTracker {
    settings: FaceSettings,
    seed: u64,
    role: String,
    state: FaceState,
    colours: FaceColours,
    near: Vec<FaceWindow>,
    taken: Vec<bool>,
    logarithms: Vec<f64>,
    distances: Vec<f32>,
    normal: Vec<f32>,
    histogram: Histogram,
    quarantined: u64,
}

/// Windows farther than this from every face are nobody's, face widths.
const GATE: f32 = 1.2;

impl FaceTracker {
    /// A tracker that believes in nobody. `role` tells its random numbers from those of other cameras.
    ///
    /// # Errors
    /// [`VisionError`] where a setting is out of its range.
    pub fn new(settings: FaceSettings, seed: u64, role: impl Into<String>) -> Result<Self, VisionError> {
        let numbers = [
            ("particles", settings.particles as f64, 1.0, "1 or more"),
            ("walk.position", settings.walk.position.into(), 0.0, "from 0"),
            ("walk.width", settings.walk.width.into(), 0.0, "from 0"),
            (
                "likelihood.falloff",
                settings.likelihood.falloff.into(),
                0.0,
                "from 0",
            ),
            (
                "likelihood.exponent",
                settings.likelihood.exponent.into(),
                0.0,
                "from 0",
            ),
            (
                "likelihood.base",
                settings.likelihood.base.into(),
                1e-6,
                "above 0",
            ),
            (
                "likelihood.width_deviation",
                settings.likelihood.width_deviation.into(),
                1e-6,
                "above 0",
            ),
            ("life.windows", settings.life.windows as f64, 1.0, "1 or more"),
        ];
        for (name, value, least, allowed) in numbers {
            if !(value >= least && value <= 1e6) {
                return Err(VisionError::Parameter { name, value, allowed });
            }
        }
        Ok(Self {
            colours: FaceColours::new(settings.colour)?,
            settings,
            seed,
            role: role.into(),
            state: FaceState::default(),
            near: Vec::new(),
            taken: Vec::new(),
            logarithms: Vec::new(),
            distances: Vec::new(),
            normal: Vec::new(),
            histogram: Histogram::default(),
            quarantined: 0,
        })
    }

    /// What is remembered.
    pub fn state(&self) -> &FaceState {
        &self.state
    }

    /// Goes on from what was remembered.
    pub fn set_state(&mut self, state: FaceState) {
        self.state = state;
    }

    /// The regions of all faces believed in, around which windows are worth seeking.
    pub fn known(&self) -> impl Iterator<Item = Rectangle> {
        self.state.beliefs.iter().map(|belief| belief.region)
    }

    /// The faces that are published, by age.
    pub fn published(&self) -> impl Iterator<Item = &FaceBelief> {
        self.state
            .beliefs
            .iter()
            .filter(|belief| belief.identity.is_some())
    }

    /// Numbers that were not finite and were set aside since the start.
    pub fn quarantined(&self) -> u64 {
        self.quarantined
    }

    /// Takes in a picture, `elapsed` after the one before, with the windows found in it.
    ///
    /// # Errors
    /// [`FilterError`] where the filter cannot run; that would be a mistake of this module.
    pub fn see(
        &mut self,
        picture: RgbView<'_>,
        windows: &[FaceWindow],
        now: Instant,
        elapsed: Span,
    ) -> Result<(), FilterError> {
        self.taken.clear();
        self.taken.resize(windows.len(), false);
        for place in 0..self.state.beliefs.len() {
            self.gather(place, windows);
            self.filter(place, picture, now, elapsed)?;
        }
        self.bury(picture);
        self.give_birth(picture, windows, now)
    }

    /// Gives the next identities to scouts that have earned them.
    pub fn publish(&mut self, next_identity: &mut u64) {
        for belief in &mut self.state.beliefs {
            if belief.identity.is_none() && belief.support_s >= self.settings.life.support_s {
                *next_identity += 1;
                belief.identity = Some(*next_identity);
            }
        }
    }

    /// Whether this tracker could have left a state; `last_identity` is the greatest identity given.
    pub fn accepts(&self, state: &FaceState, last_identity: u64) -> bool {
        let bins = self.colours.bins();
        state.next_number <= MOST_NUMBERED
            && state.beliefs.len() <= self.settings.life.most
            && state
                .beliefs
                .windows(2)
                .all(|pair| pair[0].number < pair[1].number)
            && state.beliefs.iter().all(|belief| {
                let real = belief
                    .particles
                    .columns()
                    .iter()
                    .flatten()
                    .all(|value| value.is_finite());
                let binned = |part: &Histogram| [0, bins].contains(&part.values().len());
                belief.number < state.next_number
                    && belief
                        .identity
                        .is_none_or(|identity| (1..=last_identity).contains(&identity))
                    && belief.particles.count() == self.settings.particles
                    && belief.particles.dimensions() == 3
                    && real
                    && belief.region.is_finite()
                    && belief.region.width > 0.0
                    && belief.model.parts.iter().all(binned)
            })
    }

    /// Collects the windows that are nearer to a face than to any other.
    fn gather(&mut self, place: usize, windows: &[FaceWindow]) {
        self.near.clear();
        let distance = |belief: &FaceBelief, window: &FaceWindow| {
            let (x, y) = belief.region.centre();
            (x - window.x).hypot(y - window.y) / belief.region.width.max(1.0)
        };
        for (window, taken) in windows.iter().zip(&mut self.taken) {
            let own = distance(&self.state.beliefs[place], window);
            let is_nearest = self
                .state
                .beliefs
                .iter()
                .enumerate()
                .all(|(other, belief)| other == place || own <= distance(belief, window));
            if own < GATE && is_nearest {
                *taken = true;
                self.near.push(*window);
            }
        }
    }

    /// Both partitions for one face.
    fn filter(
        &mut self,
        place: usize,
        picture: RgbView<'_>,
        now: Instant,
        elapsed: Span,
    ) -> Result<(), FilterError> {
        let seconds = elapsed.seconds().max(0.0) as f32;
        let belief = &mut self.state.beliefs[place];
        let count = belief.particles.count();
        self.normal.resize(count, 0.0);
        self.logarithms.resize(count, 0.0);
        // First the position: windows weigh it.
        let step = self.settings.walk.position * seconds.sqrt();
        for axis in 0..2 {
            fill_standard_normal(&mut belief.generator, &mut self.normal);
            let [values, widths] = belief.particles.columns_mut([axis, 2])?;
            for ((value, width), normal) in values.iter_mut().zip(widths).zip(&self.normal) {
                *value += step * *width * normal;
            }
        }
        if !self.near.is_empty() {
            let [x, y, width] = [0, 1, 2].map(|axis| belief.particles.column(axis));
            for (place, logarithm) in self.logarithms.iter_mut().enumerate() {
                *logarithm =
                    self.settings
                        .likelihood
                        .log_likelihood(x[place], y[place], width[place], &self.near);
            }
            let report = belief.particles.add_log_likelihoods(&self.logarithms)?;
            self.quarantined += report.quarantined as u64;
            recover(belief, report.outcome)?;
            belief
                .particles
                .resample(self.settings.resampling, &mut belief.generator)?;
        }
        // Then the width: colours weigh the whole.
        fill_standard_normal(&mut belief.generator, &mut self.normal);
        let step = self.settings.walk.width * seconds.sqrt();
        for (width, normal) in belief.particles.column_mut(2).iter_mut().zip(&self.normal) {
            *width = (*width * (1.0 + step * normal).max(0.5)).max(LEAST_WIDTH);
        }
        let seen = self.colours.look(picture, &belief.region, LOOK);
        if seen {
            self.colours.refer(&belief.model.parts, &belief.region);
            let [x, y, width] = [0, 1, 2].map(|axis| belief.particles.column(axis));
            self.colours.distances([x, y, width], &mut self.distances);
            for (logarithm, distance) in self.logarithms.iter_mut().zip(&self.distances) {
                *logarithm = self.colours.log_likelihood(*distance);
            }
            let report = belief.particles.add_log_likelihoods(&self.logarithms)?;
            self.quarantined += report.quarantined as u64;
            recover(belief, report.outcome)?;
        }
        summarize(belief);
        let colour = seen.then(|| {
            let (x, y) = belief.region.centre();
            self.colours
                .distances([&[x], &[y], &[belief.region.width]], &mut self.distances);
            self.distances[0]
        });
        belief
            .particles
            .resample(self.settings.resampling, &mut belief.generator)?;
        self.judge(place, colour, now, elapsed);
        Ok(())
    }

    /// Adds what this picture says of a face's existence, and learns its colours where windows support it.
    fn judge(&mut self, place: usize, colour: Option<f32>, now: Instant, elapsed: Span) {
        let life = self.settings.life;
        let seconds = elapsed.seconds().max(0.0);
        let belief = &mut self.state.beliefs[place];
        let (x, y) = belief.region.centre();
        let support = self
            .settings
            .likelihood
            .sum(x, y, belief.region.width, &self.near);
        if support >= SUPPORT {
            belief.existence.add(life.seen * seconds);
            belief.supported = now;
            belief.support_s += seconds;
            let share = (seconds / self.colours.settings().adaptation_s).min(1.0) as f32;
            learn(
                &mut self.colours,
                &mut self.histogram,
                &belief.region,
                &mut belief.model,
                share,
            );
        } else if colour.is_some_and(|distance| distance <= life.own_colours) && belief.identity.is_some() {
            belief.existence.add(life.coloured * seconds);
        } else {
            belief.existence.add(life.missed * seconds);
        }
    }

    /// Gives up faces that are not there, that left the picture or that are another's.
    fn bury(&mut self, picture: RgbView<'_>) {
        let life = self.settings.life;
        let frame = Rectangle::new(0.0, 0.0, picture.width as f32, picture.height as f32);
        let beliefs = &mut self.state.beliefs;
        let mut place = 0;
        while place < beliefs.len() {
            let belief = &beliefs[place];
            let inside = belief.region.intersection(&frame).area() / belief.region.area().max(1.0);
            let is_twin = beliefs[..place]
                .iter()
                .any(|older| older.region.overlap(&belief.region) > life.overlap);
            if belief.existence.probability() < life.least || inside < 0.3 || is_twin {
                beliefs.remove(place);
            } else {
                place += 1;
            }
        }
    }

    /// Begins a scout at every cluster of windows that belongs to nobody.
    fn give_birth(
        &mut self,
        picture: RgbView<'_>,
        windows: &[FaceWindow],
        now: Instant,
    ) -> Result<(), FilterError> {
        for first in 0..windows.len() {
            if self.taken[first] || self.state.beliefs.len() >= self.settings.life.most {
                continue;
            }
            let seed = windows[first];
            let (mut sums, mut count) = ([0.0; 3], 0);
            for (window, taken) in windows.iter().zip(&mut self.taken).skip(first) {
                let apart = (window.x - seed.x).hypot(window.y - seed.y) / seed.width;
                let ratio = window.width / seed.width;
                if !*taken && apart < 0.35 && (0.7..1.43).contains(&ratio) {
                    *taken = true;
                    count += 1;
                    for (sum, value) in sums.iter_mut().zip([window.x, window.y, window.width]) {
                        *sum += value;
                    }
                }
            }
            if count >= self.settings.life.windows {
                let [x, y, width] = sums.map(|sum| sum / count as f32);
                self.begin(picture, Rectangle::from_centre(x, y, width, width), now)?;
            }
        }
        Ok(())
    }

    fn begin(&mut self, picture: RgbView<'_>, region: Rectangle, now: Instant) -> Result<(), FilterError> {
        let is_known = self
            .state
            .beliefs
            .iter()
            .any(|belief| belief.region.overlap(&region) > 0.5 * self.settings.life.overlap);
        if is_known || !self.colours.look(picture, &region, LOOK) {
            return Ok(());
        }
        let number = self.state.next_number;
        self.state.next_number += 1;
        let mut random = generator(self.seed, &self.role, number);
        let mut particles = Particles::new(3, self.settings.particles)?;
        let (x, y) = region.centre();
        let width = f64::from(region.width);
        let spread = [0.1 * width, 0.1 * width, 0.08 * width];
        particles.draw_gaussian(&[x.into(), y.into(), width], &spread, &mut random)?;
        let mut model = Model::default();
        learn(&mut self.colours, &mut self.histogram, &region, &mut model, 1.0);
        self.state.beliefs.push(FaceBelief {
            number,
            identity: None,
            effective_sample_size: particles.count() as f64,
            particles,
            generator: random,
            model,
            existence: Existence::even(),
            born: now,
            supported: now,
            support_s: 0.0,
            region,
            deviation: spread.map(|value| value as f32),
        });
        Ok(())
    }
}

/// How far around a face colours are looked at, face widths.
const LOOK: f32 = 1.0;
/// Smallest width of a particle, pixels.
const LEAST_WIDTH: f32 = 4.0;
/// Sum of eq. 13 from which windows support a face.
const SUPPORT: f32 = 1.5;

fn learn(
    colours: &mut FaceColours,
    histogram: &mut Histogram,
    region: &Rectangle,
    model: &mut Model,
    share: f32,
) {
    let (x, y) = region.centre();
    for (part, sub_region) in model.parts.iter_mut().zip(SubRegion::ALL) {
        let inside = colours.read(sub_region.region(x, y, region.width), histogram);
        if inside >= 0.5 || (part.is_zero() && inside > 0.0) {
            part.blend(histogram, share);
        }
    }
}

/// Begins again at the last place known where every state was not finite.
fn recover(belief: &mut FaceBelief, outcome: NormalizationOutcome) -> Result<(), FilterError> {
    if outcome == NormalizationOutcome::Lost {
        let (x, y) = belief.region.centre();
        for particle in 0..belief.particles.count() {
            belief
                .particles
                .set_state(particle, &[x, y, belief.region.width])?;
        }
    }
    Ok(())
}

fn summarize(belief: &mut FaceBelief) {
    belief.effective_sample_size = belief.particles.effective_sample_size();
    let [x, y, width] = [0, 1, 2].map(|axis| belief.particles.mean_of(axis) as f32);
    belief.region = Rectangle::from_centre(x, y, width, width);
    belief.deviation =
        [0, 1, 2].map(|axis| belief.particles.covariance_of(axis, axis).max(0.0).sqrt() as f32);
}

#[cfg(test)]
mod tests;
