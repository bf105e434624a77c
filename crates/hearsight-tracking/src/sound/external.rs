//! What watches a sound's filter from outside, and saves it from traps.

use super::{Likelihood, SoundError, estimate};
use hearsight_audio::steered_response::{Bounds, Search, SearchSettings, SteeredResponse};
use hearsight_core::WorldPoint;
use hearsight_filter::{FilterError, Generator, Particles};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What starts anew all over the room at every frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum External {
    /// Nothing: a trapped filter stays trapped.
    Off,
    /// A filter of particles drawn evenly from the room at every frame, as in the paper, whose number of particles is
    /// not given: fifty are far too few for a room (erratum 13).
    Filter {
        /// Particles.
        particles: usize,
        /// Distance beyond which its estimate is another, metres (d_e, 1 in the paper).
        distance_m: f64,
        /// How long it must be elsewhere before it takes over, seconds (T_e, 1 in the paper).
        time_s: f64,
    },
    /// A search of the whole room by the steered response, from a coarse grid to a fine one. The default: 0.6 m, 0.2 s,
    /// advantage 3.
    Grid {
        /// Step of the coarse grid, metres.
        coarse_m: f64,
        /// Distance beyond which the best point is another, metres.
        distance_m: f64,
        /// How long it must be elsewhere before it takes over, seconds.
        time_s: f64,
        /// By how much its log-likelihood must be above that of the filter's estimate.
        advantage: f32,
    },
}

impl Default for External {
    fn default() -> Self {
        Self::Grid {
            coarse_m: 0.3,
            distance_m: 0.6,
            time_s: 0.2,
            advantage: 3.0,
        }
    }
}

/// What the external says of a frame.
pub(super) struct Taking {
    pub(super) is_elsewhere: bool,
    pub(super) time_s: f64,
}

/// The external with its buffers; nothing of it is remembered.
pub(super) enum Outsider {
    Off,
    Filter(Particles, Bounds),
    Grid(Box<Search>, WorldPoint),
}

/// Standard deviation of particles that begin at a point of the grid, metres.
const SPREAD_M: f64 = 0.25;

impl Outsider {
    pub(super) fn new(
        external: &External,
        bounds: Bounds,
        response: &SteeredResponse,
    ) -> Result<Self, SoundError> {
        let (distance_m, time_s) = match *external {
            External::Off => return Ok(Self::Off),
            External::Filter {
                distance_m, time_s, ..
            }
            | External::Grid {
                distance_m, time_s, ..
            } => (distance_m, time_s),
        };
        for (what, found) in [("external.distance_m", distance_m), ("external.time_s", time_s)] {
            if !(found >= 0.0 && found.is_finite()) {
                let range = "from 0";
                return Err(FilterError::OutOfRange { what, range, found }.into());
            }
        }
        Ok(match *external {
            External::Off => Self::Off,
            External::Filter { particles, .. } => Self::Filter(Particles::new(6, particles)?, bounds),
            External::Grid { coarse_m, .. } => {
                let settings = SearchSettings {
                    coarse_m,
                    fine_m: coarse_m.min(0.04),
                    ..SearchSettings::default()
                };
                let middle = |axis: usize| 0.5 * (bounds.low_m[axis] + bounds.high_m[axis]);
                let start = WorldPoint::new(middle(0), middle(1), middle(2));
                Self::Grid(Box::new(Search::new(response, bounds, settings)?), start)
            }
        })
    }

    /// The best place of the newest frame, of a grid.
    pub(super) fn best(&self) -> Option<WorldPoint> {
        match self {
            Self::Grid(_, point) => Some(*point),
            Self::Off | Self::Filter(..) => None,
        }
    }

    /// Looks at a frame anew; `own` is the filter's estimate.
    pub(super) fn look(
        &mut self,
        external: &External,
        response: &mut SteeredResponse,
        likelihood: &mut Likelihood,
        own: WorldPoint,
        generator: &mut Generator,
    ) -> Result<Option<Taking>, SoundError> {
        match (self, *external) {
            (
                Self::Filter(particles, bounds),
                External::Filter {
                    distance_m, time_s, ..
                },
            ) => {
                let [low, high] = [bounds.low_m, bounds.high_m].map(|[x, y, z]| [x, y, z, 0.0, 0.0, 0.0]);
                particles.draw_uniform(&low, &high, generator)?;
                let logarithms = likelihood.score(response, particles);
                // Drawn anew at every frame: what is set aside here is not the belief's.
                let _ = particles.add_log_likelihoods(logarithms)?;
                let is_elsewhere = estimate(particles).mean.distance_m(own) > distance_m;
                Ok(Some(Taking { is_elsewhere, time_s }))
            }
            (
                Self::Grid(search, best),
                External::Grid {
                    distance_m,
                    time_s,
                    advantage,
                    ..
                },
            ) => {
                let found = search.find(response, |[_, _, z]| likelihood.prior(f64::from(z)) as f32)?;
                *best = found.point;
                let [here, there] = [own, found.point].map(|point| {
                    let score = response.score(point);
                    response.log_likelihood(score) + likelihood.prior(point.0.z) as f32
                });
                let is_elsewhere = found.point.distance_m(own) > distance_m && there - here > advantage;
                Ok(Some(Taking { is_elsewhere, time_s }))
            }
            _ => Ok(None),
        }
    }

    /// Replaces the filter's particles by the external's.
    pub(super) fn hand_over(
        &self,
        particles: &mut Particles,
        generator: &mut Generator,
    ) -> Result<(), FilterError> {
        match self {
            Self::Off => Ok(()),
            Self::Grid(_, point) => {
                let mean = [point.0.x, point.0.y, point.0.z, 0.0, 0.0, 0.0];
                let sigma = [SPREAD_M, SPREAD_M, SPREAD_M, 0.0, 0.0, 0.0];
                particles.draw_gaussian(&mean, &sigma, generator)
            }
            Self::Filter(from, _) => {
                // As many as there are of ours, by weight: the systematic points of one uniform number.
                let count = particles.count();
                let offset = hearsight_filter::uniform(generator);
                let (mut source, mut reached) = (0, from.weights()[0]);
                for place in 0..count {
                    let wanted = (place as f64 + offset) / count as f64;
                    while reached < wanted && source + 1 < from.count() {
                        source += 1;
                        reached += from.weights()[source];
                    }
                    let state: [f32; 6] = std::array::from_fn(|axis| from.column(axis)[source]);
                    particles.set_state(place, &state)?;
                }
                particles.make_uniform();
                Ok(())
            }
        }
    }
}
