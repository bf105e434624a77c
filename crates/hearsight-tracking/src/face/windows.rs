//! The likelihood of a face's place and width by the windows of cascades.

use crate::percepts::FaceWindow;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The face likelihood (eqs. 13 and 14, corrected).
///
/// p = sum_i w_i / ((|x_p - y_i|^2 / x_w^2)^(K/2) + 1), w_i = exp(-(x_w - y_w,i)^2 / (2 (sigma x_w)^2)). It is not
/// normalized: many windows alike say more than one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FaceLikelihood {
    /// How fast windows lose weight with distance (K). Default 2: half at one face width.
    pub falloff: f32,
    /// Deviation of widths as a share of the width (sigma_w). Default 0.15; the paper does not say.
    pub width_deviation: f32,
    /// Power of the sum. Default 6. The paper's is 1, with which a window half a face away loses a fifth of its weight
    /// only and fifty particles follow slowly.
    pub exponent: f32,
    /// Windows that count in addition to those that there are, so that few windows weigh little, above 0. Default 0.3.
    pub base: f32,
    /// Use eqs. 13 and 14 as printed, neither distance squared: a window a face away keeps 98 % of its weight. Default
    /// false; to show that it fails.
    pub printed: bool,
}

impl Default for FaceLikelihood {
    fn default() -> Self {
        Self {
            falloff: 2.0,
            width_deviation: 0.15,
            exponent: 6.0,
            base: 0.3,
            printed: false,
        }
    }
}

impl FaceLikelihood {
    /// The sum of eq. 13 for a face of `width` pixels at (x, y); 0 without windows.
    pub fn sum(&self, x: f32, y: f32, width: f32, windows: &[FaceWindow]) -> f32 {
        windows.iter().map(|window| self.term(x, y, width, window)).sum()
    }

    fn term(&self, x: f32, y: f32, width: f32, window: &FaceWindow) -> f32 {
        let (dx, dy, dw) = (x - window.x, y - window.y, width - window.width);
        let square = dx * dx + dy * dy;
        let sigma = (self.width_deviation * width).max(1e-3);
        let (ratio, difference) = if self.printed {
            (square.sqrt() / (width * width), dw.abs())
        } else {
            (square / (width * width), dw * dw)
        };
        let near = 1.0 / (ratio.powf(0.5 * self.falloff) + 1.0);
        near * (-difference / (2.0 * sigma * sigma)).exp()
    }

    /// Its logarithm, tempered; the same for every state where there are no windows.
    pub fn log_likelihood(&self, x: f32, y: f32, width: f32, windows: &[FaceWindow]) -> f64 {
        let sum = self.sum(x, y, width, windows) + self.base;
        f64::from(self.exponent * sum.ln())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(x: f32, width: f32) -> FaceWindow {
        FaceWindow { x, y: 50.0, width }
    }

    #[test]
    fn a_window_a_face_width_away_counts_half_and_as_printed_nearly_all() {
        let corrected = FaceLikelihood::default();
        let windows = [window(100.0, 60.0)];
        assert!((corrected.sum(100.0, 50.0, 60.0, &windows) - 1.0).abs() < 1e-6);
        assert!((corrected.sum(160.0, 50.0, 60.0, &windows) - 0.5).abs() < 1e-6);
        let printed = FaceLikelihood {
            printed: true,
            ..corrected
        };
        // The method sheet's number for faces of 60 to 65 pixels.
        let value = printed.sum(160.0, 50.0, 60.0, &windows);
        assert!((value - 0.984).abs() < 1e-3, "{value}");
    }

    #[test]
    fn windows_of_another_width_count_less_and_many_count_more_than_one() {
        let likelihood = FaceLikelihood::default();
        let at = |windows: &[FaceWindow]| likelihood.sum(100.0, 50.0, 60.0, windows);
        // One deviation of 9 pixels.
        let value = at(&[window(100.0, 69.0)]);
        assert!((value - (-0.5_f32).exp()).abs() < 1e-6, "{value}");
        assert!((at(&[window(100.0, 60.0); 3]) - 3.0).abs() < 1e-6);
        let none = likelihood.log_likelihood(1.0, 2.0, 3.0, &[]);
        assert_eq!(none, likelihood.log_likelihood(100.0, 50.0, 60.0, &[]));
    }
}
