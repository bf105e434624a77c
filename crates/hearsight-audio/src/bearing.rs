//! From the delay of one pair to an angle and to a column of a pin-hole camera, and back (Chen and Rui, equations 18, 19
//! and 24).
//!
//! For a camera that stands midway between both microphones, its columns along their line, microphone 2 on the right:
//! then a sound on the right has a positive delay. Rooms with measured positions need none of this; it is the paper's
//! geometry, for pairs of which nothing but their spacing is known, and to show what the printed equation does.

use crate::curve::{CorrelationCurve, Peak};
use crate::error::{AudioError, check_setting};

/// Two microphones and a camera between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairBearing {
    /// Distance of the microphones (|AB|) over the speed of sound, seconds.
    longest_delay_s: f64,
    /// Half the picture's width, pixels.
    half_width_px: f64,
    /// Half the field of view.
    half_view_rad: f64,
}

impl PairBearing {
    /// A pair `spacing_m` apart at a speed of sound of `speed_m_s`, and a picture of `width_px` columns that spans
    /// `field_of_view_rad`, above 0 and below pi.
    ///
    /// # Errors
    /// [`AudioError::Setting`] where a number is out of its range.
    pub fn new(
        spacing_m: f64,
        speed_m_s: f64,
        width_px: f64,
        field_of_view_rad: f64,
    ) -> Result<Self, AudioError> {
        for (name, value) in [
            ("spacing_m", spacing_m),
            ("speed_m_s", speed_m_s),
            ("width_px", width_px),
        ] {
            check_setting(value.is_finite() && value > 0.0, name, "above 0", value)?;
        }
        let narrow = field_of_view_rad > 0.0 && field_of_view_rad < std::f64::consts::PI;
        check_setting(
            narrow,
            "field_of_view_rad",
            "above 0 and below pi",
            field_of_view_rad,
        )?;
        Ok(Self {
            longest_delay_s: spacing_m / speed_m_s,
            half_width_px: 0.5 * width_px,
            half_view_rad: 0.5 * field_of_view_rad,
        })
    }

    /// Focal length, pixels: (x_R / 2) / tan(beta_F / 2).
    pub fn focal_px(&self) -> f64 {
        self.half_width_px / self.half_view_rad.tan()
    }

    /// Angle between the line from microphone 1 to 2 and the sound, radians, 0 to pi (equation 18). A delay that is longer
    /// than the spacing allows, as rounding makes at the ends, is taken for the longest (corrected).
    pub fn angle_rad(&self, delay_s: f64) -> f64 {
        (delay_s / self.longest_delay_s).clamp(-1.0, 1.0).acos()
    }

    /// Column that a delay points at, pixels from the picture's left edge (equation 19; corrected: the printed form
    /// counts from the middle). None behind the ends of the line of microphones, where the camera sees nothing.
    pub fn column_px(&self, delay_s: f64) -> Option<f64> {
        let angle = self.angle_rad(delay_s);
        let column = self.focal_px() / angle.tan() + self.half_width_px;
        column.is_finite().then_some(column)
    }

    /// How many columns a second of delay is worth there: the derivative of [`Self::column_px`], pixels a second.
    pub fn columns_per_second(&self, delay_s: f64) -> f64 {
        let cosine = (delay_s / self.longest_delay_s).clamp(-0.999, 0.999);
        self.focal_px() / (self.longest_delay_s * (1.0 - cosine * cosine).powf(1.5))
    }

    /// Delay of a sound in a column, seconds (equation 24, corrected): (|AB| / v) x / sqrt(x^2 + f^2) with x from the
    /// middle of the picture.
    pub fn delay_s(&self, column_px: f64) -> f64 {
        let x = column_px - self.half_width_px;
        self.longest_delay_s * x / x.hypot(self.focal_px())
    }

    /// The delay as equation 24 prints it: (|AB| / v) cos(arctan((x_R / 2) / (x tan(beta_F)))). The cosine loses the sign,
    /// so that every sound on the left is heard on the right, and the whole field of view stands where its half belongs.
    pub fn printed_delay_s(&self, column_px: f64) -> f64 {
        let x = column_px - self.half_width_px;
        let tangent = self.half_width_px / (x * (2.0 * self.half_view_rad).tan());
        self.longest_delay_s * tangent.atan().cos()
    }
}

/// The highest peak of a correlation and the variance of its delay, square seconds: that of a Gaussian of its curvature,
/// raised where a rival at least `separation_s` away is nearly as high. None on a curve without a peak above 0.
pub fn peak_variance(
    curve: &CorrelationCurve,
    separation_s: f64,
    peaks: &mut Vec<Peak>,
) -> Option<(Peak, f64)> {
    curve.peaks(2, separation_s, peaks);
    let top = *peaks.first()?;
    if top.value <= 0.0 || top.curvature >= 0.0 {
        return None;
    }
    let rival = peaks.get(1).map_or(0.0, |peak| peak.value.max(0.0));
    let variance = raised(-f64::from(top.value) / top.curvature, rival / top.value);
    variance.is_finite().then_some((top, variance))
}

/// A variance raised by the height of the rival, as a share of the peak's: a rival of equal height makes it twenty times
/// as large, none leaves it.
pub(crate) fn raised(variance: f64, rival: f32) -> f64 {
    variance / (1.0 - f64::from(rival.clamp(0.0, 0.95)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The method sheet's example: 0.2 m, 60 degrees, 640 columns, a sound 20 degrees to the left.
    #[test]
    fn the_printed_equation_hears_the_left_on_the_right() {
        let bearing = PairBearing::new(0.2, 342.0, 640.0, 60_f64.to_radians()).unwrap();
        let column = 320.0 - bearing.focal_px() * 20_f64.to_radians().tan();
        let delay = bearing.delay_s(column);
        assert!((delay * 1e6 + 200.0).abs() < 0.1, "{delay}");
        let printed = bearing.printed_delay_s(column);
        assert!((printed * 1e6 - 431.3).abs() < 0.1, "{printed}");
        // Inside what the spacing allows, so that a check of its range would not notice.
        assert!(printed < 0.2 / 342.0);
    }

    #[test]
    fn columns_and_delays_return_and_the_derivative_is_one() {
        let bearing = PairBearing::new(0.3, 343.0, 500.0, 1.2).unwrap();
        for column in [1.0, 130.0, 250.0, 333.3, 499.0] {
            let delay = bearing.delay_s(column);
            assert!((bearing.column_px(delay).unwrap() - column).abs() < 1e-9);
            let slope =
                (bearing.column_px(delay + 1e-9).unwrap() - bearing.column_px(delay - 1e-9).unwrap()) / 2e-9;
            assert!((bearing.columns_per_second(delay) / slope - 1.0).abs() < 1e-4);
        }
        assert!(bearing.delay_s(400.0) > 0.0, "the right is positive");
        // Longer than possible is the end of the line, not NaN.
        assert_eq!(bearing.angle_rad(1.0), 0.0);
        assert_eq!(bearing.angle_rad(-1.0), std::f64::consts::PI);
        assert!(PairBearing::new(0.3, 343.0, 500.0, 3.2).is_err());
        assert!(PairBearing::new(f64::NAN, 343.0, 500.0, 1.0).is_err());
    }

    #[test]
    fn rivals_raise_the_variance_and_blunt_peaks_too() {
        let curve = |width: f64, rival: f32| CorrelationCurve {
            step_s: 1e-5,
            values: (-60..=60)
                .map(|k| {
                    let bump = |at: f64| (-0.5 * ((f64::from(k) - at) / width).powi(2)).exp() as f32;
                    bump(10.0) + rival * bump(-40.0)
                })
                .collect(),
        };
        let mut peaks = Vec::new();
        let mut variance = |width, rival| peak_variance(&curve(width, rival), 1e-4, &mut peaks).unwrap();
        let (peak, sharp) = variance(3.0, 0.0);
        assert!((peak.delay_s - 1e-4).abs() < 1e-6);
        assert!((sharp.sqrt() / 3e-5 - 1.0).abs() < 0.05, "{sharp}");
        assert!(variance(6.0, 0.0).1 > 3.0 * sharp);
        assert!((variance(3.0, 0.5).1 / sharp - 2.0).abs() < 0.1);
        assert_eq!(
            peak_variance(&CorrelationCurve::default(), 1e-4, &mut Vec::new()),
            None
        );
    }
}
