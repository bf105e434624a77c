//! The fuser (Chen and Rui, sections III and VI): a mixture of what the trackers propose, weights against all that was
//! predicted, and the way back.

use super::hypotheses::{Hypotheses, Prediction};
use super::settings::VerdictSettings;
use super::{
    ColourTracker, ContourTracker, FuserSettings, HeadMotion, LoopError, LoopState, ProposalRule, SoundFix,
    SoundTracker, TrackerKind, Verdict, WeightRule,
};
use crate::belief::Belief;
use crate::body::{ASPECT, Part, UprightEllipse};
use crate::stage::Sight;
use hearsight_core::Span;
use hearsight_filter::{FilterError, Gaussian, Resampling};
use hearsight_vision::contour::ContourScorer;
use hearsight_vision::histogram::Histogram;
use nalgebra::{SMatrix, SVector};
use std::cell::RefCell;

/// Proposes hypotheses for one belief after another, and closes the loop once they have weights.
#[derive(Debug)]
pub struct Fuser {
    settings: FuserSettings,
    sound: Option<SoundTracker>,
    work: RefCell<Work>,
}

/// Trackers' buffers, and what a proposal leaves for the end of its loop.
#[derive(Debug)]
struct Work {
    contour: ContourTracker,
    colour: ColourTracker,
    scorer: ContourScorer,
    /// Score of an outline with an edge on every line.
    full_score: f32,
    hypotheses: Hypotheses,
    histogram: Histogram,
}

impl Fuser {
    /// A fuser; `sound` is its sound tracker, where the view has one.
    ///
    /// # Errors
    /// [`LoopError`] where a setting is out of its range.
    pub fn new(settings: FuserSettings, sound: Option<SoundTracker>) -> Result<Self, LoopError> {
        settings.check()?;
        // The settings of the motion are checked by a step.
        HeadMotion::over(&settings.motion, Span::from_seconds(0.04), 20.0)?;
        let line = settings.contour.line;
        let work = Work {
            contour: ContourTracker::new(settings.contour)?,
            colour: ColourTracker::new(settings.colour)?,
            scorer: ContourScorer::new(line, 24, settings.contour.edges.least_strength)?,
            full_score: line
                .ratio(&[hearsight_vision::contour::Edge::default()], 0.0)
                .ln(),
            hypotheses: Hypotheses::default(),
            histogram: Histogram::default(),
        };
        Ok(Self {
            sound: sound.filter(|_| settings.trackers.sound),
            settings,
            work: RefCell::new(work),
        })
    }

    /// What sound alone says now.
    pub fn sound_fix(&self, array: &crate::percepts::ArrayPercepts) -> Option<SoundFix> {
        self.sound.as_ref()?.fix(array)
    }

    /// Runs the trackers and draws every hypothesis of a belief anew, with the weight of prediction over proposal.
    ///
    /// # Errors
    /// [`FilterError`] where the belief's state is not that of [`UprightEllipse`].
    pub fn propose(&self, belief: &mut Belief, sight: &Sight<'_>) -> Result<(), FilterError> {
        let work = &mut *self.work.borrow_mut();
        let state = place_of(belief);
        let motion = HeadMotion::over(&self.settings.motion, sight.elapsed, state[2])?;
        if belief.trackers.is_none() {
            belief.trackers = Some(LoopState {
                contour: ContourTracker::start(state, [0.0; 3])?,
                colour: state,
                reliabilities: [0.5; 3],
                failing_s: [0.0; 3],
                verdict: Verdict::Open,
            });
        }
        if self.settings.weights == WeightRule::Printed {
            // Equation 8 multiplies weights moment after moment: a filter that does so must resample when few are left.
            let Belief {
                particles, generator, ..
            } = &mut *belief;
            particles.resample_below(0.5, Resampling::Systematic, generator)?;
        }
        let prediction = work.hypotheses.predict(belief, &motion, self.settings.weights)?;
        self.run_trackers(work, belief, sight, &motion, &prediction)?;
        match self.settings.proposal {
            ProposalRule::Prior => work.hypotheses.draw_from_prior(belief, &motion, &prediction),
            ProposalRule::Trackers => {
                work.hypotheses.detected = detection(sight).filter(|_| self.settings.shares.detected > 0.0);
                self.mix(work, belief, &prediction);
                work.hypotheses
                    .draw_from_mixture(belief, sight, &motion, &prediction, &self.settings)
            }
        }
    }

    fn run_trackers(
        &self,
        work: &mut Work,
        belief: &mut Belief,
        sight: &Sight<'_>,
        motion: &HeadMotion,
        prediction: &Prediction,
    ) -> Result<(), FilterError> {
        work.hypotheses.proposed = [None, None, None];
        let on = self.settings.trackers;
        let Some(state) = &mut belief.trackers else {
            return Ok(());
        };
        if let Some(gradients) = sight.camera.gradients().filter(|_| on.contour) {
            let tracked = work.contour.track(&mut state.contour, motion, gradients);
            work.hypotheses.proposed[0] = match tracked {
                Ok(proposed) => proposed,
                // Its state is none any more: it begins anew where the person is.
                Err(_) => {
                    let place = prediction.places.mean();
                    state.contour = ContourTracker::start([place[0], place[1], place[2]], [0.0; 3])?;
                    None
                }
            };
        }
        if let Some(model) = belief.appearance.part(Part::Head).filter(|_| on.colour) {
            work.hypotheses.proposed[1] = work
                .colour
                .track(&mut state.colour, sight.camera.bins(), model)
                .unwrap_or(None);
        }
        for proposed in &mut work.hypotheses.proposed[..2] {
            *proposed = proposed.take().and_then(|own| sized(&own, &prediction.places));
        }
        let fix = sight.array.and_then(|array| self.sound_fix(array));
        if let Some(fix) = fix {
            // On the column alone; row and size are as predicted.
            let mut mean = *prediction.places.mean();
            let mut covariance = *prediction.places.covariance();
            mean[0] = fix.column_px;
            let turn_px = f64::from(belief.turn_px);
            if turn_px > 0.0 {
                // All round the sound is where it is nearest to the person.
                mean[0] += turn_px * ((prediction.places.mean()[0] - mean[0]) / turn_px).round();
            }
            for other in 1..3 {
                covariance[(0, other)] = 0.0;
                covariance[(other, 0)] = 0.0;
            }
            covariance[(0, 0)] = fix.variance_px2;
            work.hypotheses.proposed[2] = Gaussian::new(mean, covariance).ok();
        }
        Ok(())
    }

    /// The mixture of the trackers by their reliabilities, with the defensive share of the prior.
    fn mix(&self, work: &mut Work, belief: &Belief, prediction: &Prediction) {
        let shares = &self.settings.shares;
        let reliabilities = belief
            .trackers
            .as_ref()
            .map_or([0.5; 3], |state| state.reliabilities);
        let share = |kind: usize| {
            // A voice is whoever's it is: it pulls the others only as far as the floor.
            let speaking = if kind == TrackerKind::Sound as usize {
                belief.speaking
            } else {
                1.0
            };
            (reliabilities[kind] * speaking).max(shares.least)
        };
        let total: f64 = (0..3)
            .filter(|kind| work.hypotheses.proposed[*kind].is_some())
            .map(share)
            .sum();
        work.hypotheses.mixture.clear();
        for (kind, proposed) in work.hypotheses.proposed.iter().enumerate() {
            if let Some(proposed) = proposed {
                work.hypotheses
                    .mixture
                    .push((1.0 - shares.prior) * share(kind) / total, proposed.clone());
            }
        }
        work.hypotheses
            .mixture
            .push(shares.prior, prediction.places.clone());
        work.hypotheses.mixture.normalize();
        if let Some(detected) = &work.hypotheses.detected {
            let share = shares.detected / (1.0 - shares.detected);
            work.hypotheses.mixture.push(share, detected.clone());
            work.hypotheses.mixture.normalize();
        }
    }

    /// Judges the trackers by the weighted hypotheses and tells them (equations 25 and 26, corrected).
    ///
    /// # Errors
    /// [`FilterError`] where a number is not finite.
    pub fn close(&self, belief: &mut Belief, sight: &Sight<'_>) -> Result<(), FilterError> {
        let work = &mut *self.work.borrow_mut();
        let mean: [f64; 6] = std::array::from_fn(|dimension| belief.particles.mean_of(dimension));
        if !mean.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        let place = [mean[0], mean[1], mean[2]];
        let reliabilities = work.hypotheses.reliabilities(belief);
        let Some(mut state) = belief.trackers.take() else {
            return Ok(());
        };
        let model = belief.appearance.part(Part::Head);
        let likeness = model.and_then(|model| work.colour.likeness(place, sight.camera.bins(), model));
        state.verdict = self.judge(work, place, likeness, sight);
        let feedback = &self.settings.feedback;
        for kind in TrackerKind::ALL {
            let number = kind as usize;
            let proposed = work.hypotheses.proposed[number].is_some();
            let running = match kind {
                TrackerKind::Contour => self.settings.trackers.contour,
                TrackerKind::Colour => self.settings.trackers.colour,
                // It remembers nothing, so it cannot have lost its way.
                TrackerKind::Sound => false,
            };
            let reliability = if proposed { reliabilities[number] } else { 0.0 };
            // A sound tracker that is silent is no worse than it was.
            if proposed || running {
                state.reliabilities[number] = if feedback.enabled { reliability } else { 0.5 };
            }
            if running && reliability < feedback.failing {
                state.failing_s[number] += sight.elapsed.seconds();
            } else {
                state.failing_s[number] = 0.0;
            }
        }
        if feedback.enabled {
            self.tell(&mut state, &mean)?;
            let agreed = state.verdict == Verdict::Verified
                && TrackerKind::ALL[..2].iter().all(|kind| {
                    let number = *kind as usize;
                    work.hypotheses.proposed[number].is_none() || reliabilities[number] >= feedback.failing
                });
            let inside = sight.camera.histogram(
                &UprightEllipse::bounds(place[0] as f32, place[1] as f32, place[2] as f32),
                &mut work.histogram,
            );
            if (agreed || model.is_none()) && inside > 0.7 && !belief.occluded {
                let rate = 1.0 - (-sight.elapsed.seconds() / feedback.memory_s).exp();
                belief.appearance.learn(Part::Head, &work.histogram, rate as f32);
            }
        }
        belief.trackers = Some(state);
        Ok(())
    }

    /// Equation 26, and a new start for trackers that have failed for too long.
    fn tell(&self, state: &mut LoopState, mean: &[f64; 6]) -> Result<(), FilterError> {
        let patience_s = self.settings.feedback.patience_s;
        let [contour, colour] = [state.reliabilities[0], state.reliabilities[1]];
        let (place, velocity) = ([mean[0], mean[1], mean[2]], [mean[3], mean[4], mean[5]]);
        if state.failing_s[0] > patience_s {
            state.contour = ContourTracker::start(place, velocity)?;
            state.failing_s[0] = 0.0;
        } else {
            let own = *state.contour.mean();
            let blended = SVector::from_fn(|row, _| contour * own[row] + (1.0 - contour) * mean[row]);
            let covariance = *state.contour.covariance();
            state.contour.set(blended, covariance)?;
        }
        if state.failing_s[1] > patience_s {
            state.colour = place;
            state.failing_s[1] = 0.0;
        } else {
            for (own, fused) in state.colour.iter_mut().zip(place) {
                *own = colour * *own + (1.0 - colour) * fused;
            }
        }
        Ok(())
    }

    /// What outline and colours say of the fused place.
    fn judge(&self, work: &mut Work, place: [f64; 3], likeness: Option<f32>, sight: &Sight<'_>) -> Verdict {
        let VerdictSettings {
            outline,
            no_outline,
            colour,
            no_colour,
            smallest_px,
        } = self.settings.verdict;
        let bounds = UprightEllipse::bounds(place[0] as f32, place[1] as f32, place[2] as f32);
        let mut score = [0.0];
        let seen = match sight
            .camera
            .gradients()
            .filter(|_| self.settings.trackers.contour)
        {
            Some(gradients) => {
                work.scorer.score(gradients, &[bounds], &mut score);
                Some(score[0] / work.full_score)
            }
            None => None,
        };
        let alike = likeness.filter(|_| self.settings.trackers.colour);
        if place[2] < smallest_px {
            return Verdict::Refuted;
        }
        let confirms = |value: Option<f32>, least: f32| value.is_some_and(|value| value >= least);
        let denies = |value: Option<f32>, most: f32| value.is_some_and(|value| value < most);
        let confirmed = [confirms(seen, outline), confirms(alike, colour)];
        let denied = [denies(seen, no_outline), denies(alike, no_colour)];
        let asked = [seen.is_some(), alike.is_some()];
        match (confirmed, denied) {
            // All that were asked.
            _ if confirmed == asked => Verdict::Verified,
            // A head that turns has other colours and the same outline; one before clutter the other way round.
            ([false, false], [true, _] | [_, true]) => Verdict::Refuted,
            _ => Verdict::Open,
        }
    }
}

/// A proposal with what was predicted of the size taken in. Sizes change slowly, and neither outlines nor colours know
/// them half as well: of hypotheses of all the sizes that they leave open most would be wasted.
fn sized(proposed: &Gaussian<3>, predicted: &Gaussian<3>) -> Option<Gaussian<3>> {
    let (mut mean, mut covariance) = (*proposed.mean(), *proposed.covariance());
    let column = covariance.column(2).into_owned();
    let gain = column / (column[2] + predicted.covariance()[(2, 2)]);
    mean += gain * (predicted.mean()[2] - mean[2]);
    covariance -= gain * column.transpose();
    Gaussian::new(mean, 0.5 * (covariance + covariance.transpose())).ok()
}

/// The person's own detection as a Gaussian: a tenth of the head's width off, and as much of its size.
fn detection(sight: &Sight<'_>) -> Option<Gaussian<3>> {
    let (head, _) = sight.detections.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (x, y) = head.centre();
    let half = 0.5 * f64::from(head.area() * ASPECT).sqrt();
    let deviation = 0.12 * f64::from(head.width).max(4.0);
    let size = 0.08 * half.max(4.0);
    Gaussian::new(
        SVector::from([f64::from(x), f64::from(y), half]),
        SMatrix::from_diagonal(&SVector::from([
            deviation * deviation,
            deviation * deviation,
            size * size,
        ])),
    )
    .ok()
}

/// Where the particles of a belief are in the mean: x, y, half height.
fn place_of(belief: &Belief) -> [f64; 3] {
    [0, 1, 2].map(|dimension| belief.particles.mean_of(dimension))
}
