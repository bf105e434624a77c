//! How likely the outline is at a place of a line (Isard and Blake 1998; Chen and Rui, equation 10), and scores of whole
//! ellipses (equation 20).

use super::edges::{Edge, LineEdges};
use super::gradient::GradientPicture;
use super::normals::Normals;
use crate::VisionError;
use hearsight_core::Rectangle;
use serde::{Deserialize, Serialize};

/// The model of one line: the outline is one of its edges, displaced by a Gaussian, or was missed; the other edges are
/// clutter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LineLikelihood {
    /// Deviation of an edge from the outline (sigma_z), pixels, above 0, default 2. Raising it forgives heads that are no
    /// ellipses.
    pub deviation_px: f32,
    /// Probability that the outline shows no edge (q), above 0 to 1, default 0.1.
    pub missed: f32,
    /// Edges of clutter a pixel of line (gamma), above 0, default 0.05. Raising it trusts edges less.
    pub clutter: f32,
}

impl Default for LineLikelihood {
    fn default() -> Self {
        Self {
            deviation_px: 2.0,
            missed: 0.1,
            clutter: 0.05,
        }
    }
}

impl LineLikelihood {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        let positive = |name, value: f32, most: f64, allowed| {
            VisionError::within(name, f64::from(value), 1e-4, most, allowed)
        };
        positive("deviation_px", self.deviation_px, 100.0, "0.0001 to 100")?;
        positive("missed", self.missed, 1.0, "0.0001 to 1")?;
        positive("clutter", self.clutter, 10.0, "0.0001 to 10")
    }

    /// How much a single edge at the outline speaks for it.
    pub(super) fn gain(&self) -> f32 {
        1.0 / ((2.0 * std::f32::consts::PI).sqrt() * self.deviation_px * self.missed * self.clutter)
    }

    /// Likelihood of the outline at `offset_px` of a line against none on it at all: 1 without an edge near, more with
    /// (equation 10).
    #[inline]
    pub fn ratio(&self, edges: &[Edge], offset_px: f32) -> f32 {
        let scale = 0.5 / (self.deviation_px * self.deviation_px);
        let sum: f32 = edges
            .iter()
            .map(|edge| (-(edge.offset_px - offset_px).powi(2) * scale).exp())
            .sum();
        1.0 + self.gain() * sum
    }

    /// Adds the logarithms of equation 10 at every whole pixel from `-reach` to `reach` of a line to `emissions`.
    pub fn emit(&self, edges: &[Edge], reach: usize, emissions: &mut Vec<f64>) {
        let reach = reach as i32;
        emissions.extend((-reach..=reach).map(|offset| f64::from(self.ratio(edges, offset as f32).ln())));
    }
}

/// Scores ellipses by the edges on their own outlines.
#[derive(Clone, Debug)]
pub struct ContourScorer {
    likelihood: LineLikelihood,
    normals: Normals,
    least_strength: f32,
    reach: usize,
}

impl ContourScorer {
    /// A scorer that reads `lines` (4 to 256) lines of each ellipse, edges of at least `least_strength` (grey levels a
    /// pixel) and as far as they can matter: two deviations and a half.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn new(likelihood: LineLikelihood, lines: usize, least_strength: f32) -> Result<Self, VisionError> {
        likelihood.validate()?;
        VisionError::within("lines", lines as f64, 4.0, 256.0, "4 to 256")?;
        VisionError::within(
            "least_strength",
            f64::from(least_strength),
            1e-3,
            1e3,
            "0.001 to 1000",
        )?;
        Ok(Self {
            likelihood,
            normals: Normals::new(lines),
            least_strength,
            reach: (2.5 * likelihood.deviation_px).ceil().clamp(1.0, 64.0) as usize,
        })
    }

    /// Writes the mean over the lines of the logarithm of equation 10 on the outline itself into `scores`, one an
    /// ellipse: 0 where there is no edge anywhere. Lines outside the picture have none.
    ///
    /// The product over the lines (equation 20) is the exponential of this times their number; since neighbouring lines
    /// see the same edge, fewer should be counted.
    pub fn score(&self, gradients: &GradientPicture, ellipses: &[Rectangle], scores: &mut [f32]) {
        for (score, bounds) in scores.iter_mut().zip(ellipses) {
            *score = self.score_one(gradients, bounds);
        }
    }

    /// Pixels of a line that are read on each side of the outline.
    pub(super) fn reach(&self) -> usize {
        self.reach
    }

    pub(super) fn score_one(&self, gradients: &GradientPicture, bounds: &Rectangle) -> f32 {
        if !bounds.is_finite() {
            return f32::NAN;
        }
        // The logarithm of a product of eight ratios is cheaper than eight logarithms; each is far below the eighth root
        // of the largest number.
        let mut sum = 0.0;
        let mut product = 1.0_f32;
        for (place, normal) in self.normals.of(bounds).enumerate() {
            let found = LineEdges::find(gradients, &normal, self.reach, self.least_strength);
            product *= self.likelihood.ratio(found.edges(), 0.0).min(5e4);
            if place % 8 == 7 {
                sum += product.ln();
                product = 1.0;
            }
        }
        (sum + product.ln()) / self.normals.count() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::RgbView;

    #[test]
    fn equation_ten_by_its_figures() {
        let likelihood = LineLikelihood {
            deviation_px: 3.0,
            missed: 0.1,
            clutter: 0.05,
        };
        assert_eq!(likelihood.ratio(&[], 0.0), 1.0);
        let edges = [-2.0, 5.0].map(|offset_px| Edge {
            offset_px,
            strength: 20.0,
        });
        let expected = 1.0
            + 1.0 / ((2.0 * std::f64::consts::PI).sqrt() * 3.0 * 0.1 * 0.05)
                * ((-4.0_f64 / 18.0).exp() + (-25.0_f64 / 18.0).exp());
        assert!((f64::from(likelihood.ratio(&edges, 0.0)) / expected - 1.0).abs() < 1e-5);
        let mut emissions = Vec::new();
        likelihood.emit(&edges, 6, &mut emissions);
        assert_eq!(emissions.len(), 13);
        assert!(
            emissions[4] > emissions[7] && emissions[11] > emissions[7],
            "{emissions:?}"
        );
        assert!(
            LineLikelihood {
                missed: 0.0,
                ..likelihood
            }
            .validate()
            .is_err()
        );
    }

    #[test]
    fn the_true_ellipse_scores_best() {
        let (width, height) = (120, 100);
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| {
                let (u, v) = (
                    ((i % width) as f32 - 59.5) / 18.0,
                    ((i / width) as f32 - 47.5) / 21.6,
                );
                if u * u + v * v < 1.0 {
                    [190, 140, 110]
                } else {
                    [70, 80, 90]
                }
            })
            .collect();
        let mut gradients = GradientPicture::default();
        gradients.compute(RgbView::new(width, height, &data).unwrap());
        let scorer = ContourScorer::new(LineLikelihood::default(), 16, 8.0).unwrap();
        let at = |x: f32, y: f32, half: f32| Rectangle::from_centre(x, y, 2.0 * half / 1.2, 2.0 * half);
        let ellipses = [
            at(60.0, 48.0, 21.6),
            at(64.0, 48.0, 21.6),
            at(60.0, 54.0, 21.6),
            at(60.0, 48.0, 26.0),
            at(60.0, 48.0, 17.0),
            at(20.0, 20.0, 10.0),
            at(-60.0, 20.0, 10.0),
            at(f32::NAN, 20.0, 10.0),
        ];
        let mut scores = [0.0; 8];
        scorer.score(&gradients, &ellipses, &mut scores);
        assert!((1..7).all(|other| scores[0] > scores[other] + 0.5), "{scores:?}");
        assert!((scores[0] - LineLikelihood::default().ratio(&[Edge::default()], 0.0).ln()).abs() < 0.1);
        assert_eq!((scores[5], scores[6]), (0.0, 0.0));
        assert!(scores[7].is_nan());
    }
}
