//! Following one talker by sound alone: the paper's experiment without pictures (stac, section 3).
//!
//! The belief is born from the first sound that may be localized. Only its column is estimated; row and size of the head
//! come from a prior. It is believed in to the end.

use super::{ViewTracker, newborn, summarize};
use crate::percepts::{ArrayPercepts, CameraPercepts};
use crate::stage::{self, Sight};
use hearsight_core::{Instant, Rectangle, Span};
use hearsight_filter::{FilterError, Particles, generator, uniform};

impl ViewTracker {
    /// Takes a moment of sound in place of a picture of `width_px`: runs the filter of the one talker, whose head is
    /// `prior` but for its column.
    ///
    /// # Errors
    /// [`FilterError`] where the composition does not fit together.
    pub fn follow_sound(
        &mut self,
        camera: &CameraPercepts,
        array: &ArrayPercepts,
        prior: &Rectangle,
        width_px: f32,
        now: Instant,
    ) -> Result<(), FilterError> {
        let elapsed = self.state.last.map_or(Span::ZERO, |last| now - last);
        self.state.last = Some(now);
        if self.state.beliefs.is_empty() {
            if !array.has_onset() {
                return Ok(());
            }
            self.bear_talker(prior, width_px, now)?;
        }
        let body = self.composition.body.as_ref();
        let mut state = [0.0; 4];
        body.state_from_head(prior, &mut state);
        for belief in &mut self.state.beliefs {
            // Nobody else is there to whom the sound could belong.
            belief.speaking = 1.0;
            let sight = Sight {
                body,
                camera,
                array: Some(array),
                detections: &[],
                covers: &[],
                elapsed,
            };
            self.quarantined +=
                stage::run(&self.composition.stages, belief, &sight, &mut self.scratch)? as u64;
            let [x, y, width, height] = belief.particles.columns_mut([0, 1, 2, 3])?;
            x.iter_mut().for_each(|x| *x = x.clamp(0.0, width_px));
            y.fill(state[1]);
            width.fill(state[2]);
            height.fill(state[3]);
            summarize(belief, body);
            if array.has_onset() {
                belief.supported = now;
                belief.support = belief.support + elapsed;
            }
        }
        Ok(())
    }

    /// Publishes everybody who is not yet.
    pub fn publish_all(&mut self, next_identity: &mut u64) {
        let unknown = self
            .state
            .beliefs
            .iter_mut()
            .filter(|belief| belief.identity.is_none());
        for belief in unknown {
            *next_identity += 1;
            belief.identity = Some(*next_identity);
        }
    }

    /// Starts the belief, with its column unknown.
    fn bear_talker(&mut self, prior: &Rectangle, width_px: f32, now: Instant) -> Result<(), FilterError> {
        let number = self.state.next_number;
        self.state.next_number += 1;
        let mut random = generator(self.composition.seed, &self.composition.role, number);
        let mut particles = Particles::new(self.composition.body.dimensions(), self.composition.particles)?;
        let mut state = [0.0; 4];
        self.composition.body.state_from_head(prior, &mut state);
        for particle in 0..particles.count() {
            state[0] = (f64::from(width_px) * uniform(&mut random)) as f32;
            particles.set_state(particle, &state)?;
        }
        let mut belief = newborn(number, particles, random, *prior, now);
        belief.existence.add(f64::MAX);
        self.state.beliefs.push(belief);
        Ok(())
    }
}
