//! Weightings of the cross-spectrum: what turns a correlation into a generalized one.

use crate::Complex;
use crate::error::{AudioError, check_setting, check_shape};
use serde::{Deserialize, Serialize};

/// How much each frequency counts in the correlation of a pair, given its cross-spectrum G = X_i X_j*.
///
/// Powers P = |X|² and noise powers N are of the same scaling (see
/// [`SpectrumAnalyzer::window_energy`](crate::spectrum::SpectrumAnalyzer::window_energy)). Where a denominator vanishes the
/// weight is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weighting {
    /// 1: the plain cross-correlation, sharpest where the signal is white.
    Plain,
    /// Smoothed coherence transform 1 / sqrt(P_i P_j). Equal to [`Self::Phat`] on a single frame: it wants averages.
    Scot,
    /// Phase transform 1 / |G|: every frequency alike. The default.
    #[default]
    Phat,
    /// Maximum likelihood by coherence, C / ((1 - C) |G|) with C = |G|² / (P_i P_j) (Knapp and Carter 1976). On a
    /// single frame C is 1 everywhere and tells nothing: it wants averages; C is held below 0.999.
    Coherence,
    /// Maximum likelihood by noise power,
    /// sqrt(P_i P_j) / (2 q P_i P_j + (1 - q) (N_j P_i + N_i P_j)), where `q` = `reverberation` is the share of the sound
    /// taken as reverberation, 0 to 1: 0 is the classic form for noise alone, 1 the phase transform. About 0.3 suits
    /// rooms (Rui and Florêncio 2003, to which Chen and Rui 2004, equation 17, point).
    MaximumLikelihood {
        /// Share of reverberation, 0 to 1.
        reverberation: f32,
    },
    /// Phase transform held down where there is only noise, 1 / (gamma |G| + (1 - gamma) sqrt(N_i N_j)): Bregonzio,
    /// Taj and Cavallaro, section 2.2, equation 7, corrected: the noise enters as a power, as |G| does. `gamma` 1 is
    /// the phase transform, 0.3 lets a bin far above the noise count three times one of noise alone and suits rooms; smaller values trust loud frequencies more.
    NoiseRegularized {
        /// Share of the phase transform, 0 to 1.
        gamma: f32,
    },
}

impl Weighting {
    /// Whether the noise power of both channels must be given.
    pub fn needs_noise(self) -> bool {
        matches!(
            self,
            Self::MaximumLikelihood { .. } | Self::NoiseRegularized { .. }
        )
    }

    pub(crate) fn check(self) -> Result<(), AudioError> {
        match self {
            Self::MaximumLikelihood { reverberation: share } | Self::NoiseRegularized { gamma: share } => {
                check_setting(
                    (0.0..=1.0).contains(&share),
                    "share",
                    "within 0 and 1",
                    f64::from(share),
                )
            }
            _ => Ok(()),
        }
    }

    /// The weight of one bin from |G|, the powers and the noise powers of both channels.
    #[inline]
    pub(crate) fn weight(self, magnitude: f32, powers: [f32; 2], noises: [f32; 2]) -> f32 {
        let product = powers[0] * powers[1];
        let (above, below) = match self {
            Self::Plain => (1.0, 1.0),
            Self::Scot => (1.0, product.sqrt()),
            Self::Phat => (1.0, magnitude),
            Self::Coherence => {
                let coherence = (magnitude * magnitude / product.max(f32::MIN_POSITIVE)).min(0.999);
                (coherence, (1.0 - coherence) * magnitude)
            }
            Self::MaximumLikelihood { reverberation } => {
                let noise = noises[1] * powers[0] + noises[0] * powers[1];
                (
                    product.sqrt(),
                    2.0 * reverberation * product + (1.0 - reverberation) * noise,
                )
            }
            Self::NoiseRegularized { gamma } => (
                1.0,
                gamma * magnitude + (1.0 - gamma) * (noises[0] * noises[1]).sqrt(),
            ),
        };
        if below > f32::MIN_POSITIVE {
            above / below
        } else {
            0.0
        }
    }
}

/// The noise power of both channels of a pair, one value a bin, in the scaling of |X|².
#[derive(Clone, Copy, Debug)]
pub struct PairNoise<'a> {
    /// Of microphone i.
    pub first: &'a [f32],
    /// Of microphone j.
    pub second: &'a [f32],
    /// What the noise adds to the cross-spectrum, as a share of its magnitude: it is taken out before all is weighted. None
    /// where the noise comes from everywhere. See [`crate::coherence`].
    pub cross: Option<&'a [Complex]>,
}

/// Cross-spectrum and powers of a pair, averaged over frames: what [`Weighting::Scot`] and [`Weighting::Coherence`] need.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PairAverage {
    /// Real and imaginary part of G, one a bin.
    pub(crate) cross: Vec<[f32; 2]>,
    /// Powers of i and j, one pair a bin.
    pub(crate) powers: Vec<[f32; 2]>,
    forgetting: f32,
}

impl PairAverage {
    /// An empty average; each frame counts by `1 - forgetting`, all before it by `forgetting` (0 to below 1), and the
    /// first frame wholly.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where `forgetting` is out of range.
    pub fn new(forgetting: f32) -> Result<Self, AudioError> {
        let holds = (0.0..1.0).contains(&forgetting);
        check_setting(holds, "forgetting", "within 0 and below 1", f64::from(forgetting))?;
        Ok(Self {
            cross: Vec::new(),
            powers: Vec::new(),
            forgetting,
        })
    }

    /// Forgets everything, as after a gap or an onset.
    pub fn reset(&mut self) {
        self.cross.clear();
        self.powers.clear();
    }

    /// Takes in the spectra of i and j of one frame.
    ///
    /// # Errors
    /// [`AudioError::Shape`] where they have unequal numbers of bins, or other numbers than before.
    pub fn observe(&mut self, first: &[Complex], second: &[Complex]) -> Result<(), AudioError> {
        check_shape("bins of a pair", first.len(), second.len())?;
        let bins = first.iter().zip(second).map(|(&x, &y)| {
            let cross = x * y.conj();
            ([cross.re, cross.im], [x.norm_sqr(), y.norm_sqr()])
        });
        if self.cross.is_empty() {
            self.cross.extend(bins.clone().map(|(cross, _)| cross));
            self.powers.extend(bins.map(|(_, powers)| powers));
            return Ok(());
        }
        check_shape("bins of a pair", self.cross.len(), first.len())?;
        let (old, new) = (self.forgetting, 1.0 - self.forgetting);
        for ((cross, powers), (new_cross, new_powers)) in
            self.cross.iter_mut().zip(&mut self.powers).zip(bins)
        {
            for part in 0..2 {
                cross[part] = old * cross[part] + new * new_cross[part];
                powers[part] = old * powers[part] + new * new_powers[part];
            }
        }
        Ok(())
    }
}
