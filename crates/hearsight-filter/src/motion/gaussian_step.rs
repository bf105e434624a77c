//! One linear Gaussian step of a position and its velocity: what the second-order models have in common.

use super::BLOCK;
use crate::error::FilterError;
use crate::particles::Particles;
use crate::random::{Generator, fill_standard_normal};
use nalgebra::Matrix2;

/// The step of one axis over one span: with independent standard normal numbers `n` and `m`,
///
/// ```text
/// velocity' = velocity_from_velocity * velocity + velocity_noise * n
/// position' = position + position_from_velocity * velocity + shared_noise * n + position_noise * m
/// ```
///
/// Units: those of the position and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianStep {
    /// What is left of the velocity, 0 to 1.
    pub velocity_from_velocity: f64,
    /// For how many seconds the old velocity carries the position.
    pub position_from_velocity: f64,
    /// Deviation of the new velocity, per second.
    pub velocity_noise: f64,
    /// The part of the position's deviation that is the velocity's noise, integrated.
    pub shared_noise: f64,
    /// The rest of the position's deviation.
    pub position_noise: f64,
}

impl GaussianStep {
    /// The matrix that takes (position, velocity) over the span, for a Kalman filter.
    pub fn transition(&self) -> Matrix2<f64> {
        Matrix2::new(1.0, self.position_from_velocity, 0.0, self.velocity_from_velocity)
    }

    /// The covariance of the noise of (position, velocity), for a Kalman filter.
    pub fn covariance(&self) -> Matrix2<f64> {
        let shared = self.shared_noise * self.velocity_noise;
        Matrix2::new(
            self.shared_noise.powi(2) + self.position_noise.powi(2),
            shared,
            shared,
            self.velocity_noise.powi(2),
        )
    }

    /// Moves every particle. Draws for the velocity, and for the position only if it has noise of its own.
    pub(super) fn apply(
        &self,
        particles: &mut Particles,
        position: usize,
        velocity: usize,
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        let [position, velocity] = particles.columns_mut([position, velocity])?;
        let keep = self.velocity_from_velocity as f32;
        let carry = self.position_from_velocity as f32;
        let (velocity_noise, shared, own) = (
            self.velocity_noise as f32,
            self.shared_noise as f32,
            self.position_noise as f32,
        );
        let (mut first, mut second) = ([0.0_f32; BLOCK], [0.0_f32; BLOCK]);
        for (positions, velocities) in position.chunks_mut(BLOCK).zip(velocity.chunks_mut(BLOCK)) {
            let (first, second) = (&mut first[..positions.len()], &mut second[..positions.len()]);
            fill_standard_normal(generator, first);
            if own != 0.0 {
                fill_standard_normal(generator, second);
            }
            for (((position, velocity), n), m) in positions.iter_mut().zip(velocities).zip(first).zip(second)
            {
                *position += carry * *velocity + shared * *n + own * *m;
                *velocity = keep * *velocity + velocity_noise * *n;
            }
        }
        Ok(())
    }
}

/// A position and its velocity among the dimensions of a state.
pub(super) fn check_axes(
    particles: &Particles,
    axes: impl Iterator<Item = [usize; 2]> + Clone,
) -> Result<(), FilterError> {
    let available = particles.dimensions();
    for (count, index) in axes.clone().flatten().enumerate() {
        if index >= available || axes.clone().flatten().take(count).any(|earlier| earlier == index) {
            return Err(FilterError::BadIndex {
                what: "dimension",
                index,
                available,
            });
        }
    }
    Ok(())
}
