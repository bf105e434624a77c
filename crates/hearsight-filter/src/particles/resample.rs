//! Resampling in place, without allocation.

use super::{Normalization, Particles};
use crate::elementary;
use crate::error::FilterError;
use crate::resampling::Resampling;
use rand::Rng;

impl Particles {
    /// Draws as many particles as there are, each in proportion to its weight, and makes the weights equal.
    ///
    /// Returns the ancestor of each particle, in rising order. Nothing is allocated.
    ///
    /// # Errors
    /// [`FilterError::NoWeight`] if the weights were never normalized, which the methods of this type exclude.
    pub fn resample(&mut self, scheme: Resampling, generator: &mut impl Rng) -> Result<&[u32], FilterError> {
        scheme.draw(&self.weights, generator, &mut self.ancestors)?;
        self.gather();
        self.make_uniform();
        Ok(&self.ancestors)
    }

    /// Resamples if the effective sample size is below `fraction` (0 to 1) of the number of particles; says whether.
    ///
    /// # Errors
    /// As [`resample`](Self::resample).
    pub fn resample_below(
        &mut self,
        fraction: f64,
        scheme: Resampling,
        generator: &mut impl Rng,
    ) -> Result<bool, FilterError> {
        let needed = self.effective_sample_size() < fraction * self.count() as f64;
        if needed {
            self.resample(scheme, generator)?;
        }
        Ok(needed)
    }

    /// Draws in proportion to `importance` instead of the weights, and corrects the weights by dividing by it, so that
    /// the particles stand for the same distribution: the weighted resampling of partitioned sampling (MacCormick and
    /// Isard 2000, section 4).
    ///
    /// `importance`: one value a particle, finite and not negative, of any scale; positive wherever the weight is, or
    /// that part of the distribution is lost.
    ///
    /// # Errors
    /// [`FilterError::SizeMismatch`] unless there is one value for each particle, [`FilterError::NoWeight`] or
    /// [`FilterError::NotFinite`] if nothing can be drawn from them.
    pub fn resample_by_importance(
        &mut self,
        importance: &[f64],
        scheme: Resampling,
        generator: &mut impl Rng,
    ) -> Result<Normalization, FilterError> {
        FilterError::check_length("importance", self.count(), importance.len())?;
        scheme.draw(importance, generator, &mut self.ancestors)?;
        self.gather();
        // The linear weights serve as the other buffer of the logarithmic ones; normalizing fills them again.
        for (weight, ancestor) in self.weights.iter_mut().zip(&self.ancestors) {
            let ancestor = *ancestor as usize;
            *weight = self.log_weights[ancestor] - elementary::ln(importance[ancestor]);
        }
        std::mem::swap(&mut self.weights, &mut self.log_weights);
        Ok(self.normalize())
    }

    /// Moves every particle's state to its place in `self.ancestors`.
    fn gather(&mut self) {
        for column in &mut self.columns {
            // Groups of eight are unrolled, which is three times faster than one by one.
            let (values, last_values) = self.spare.as_chunks_mut::<8>();
            let (ancestors, last_ancestors) = self.ancestors.as_chunks::<8>();
            for (values, ancestors) in values.iter_mut().zip(ancestors) {
                for (value, ancestor) in values.iter_mut().zip(ancestors) {
                    *value = column[*ancestor as usize];
                }
            }
            for (value, ancestor) in last_values.iter_mut().zip(last_ancestors) {
                *value = column[*ancestor as usize];
            }
            std::mem::swap(column, &mut self.spare);
        }
    }
}
