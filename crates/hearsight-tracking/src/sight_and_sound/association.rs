//! Which face a sound may belong to.

use super::lines::{Meeting, SightLine, nearest_to_both, weighted};
use crate::sound::PointEstimate;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When a sound may belong to a face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AssociationSettings {
    /// Whether both are weighted by their uncertainties. Default true; false is eq. 20 with a vertical line through the
    /// sound, as printed.
    pub weighted: bool,
    /// Greatest half distance of both lines, metres (e_av; 0.6 in the paper). Used by the plain form. Default 0.6.
    pub residual_m: f64,
    /// Greatest distance in units of the deviations. Used by the weighted form. Default 3.
    pub deviations: f64,
    /// Least and greatest height of a speaker above the floor, metres. Default 0.7 and 2.1.
    pub height_m: [f64; 2],
    /// Least and greatest width of a face, metres, as the cascade boxes it. Default 0.13 and 0.25, for the boxes of
    /// OpenCV's cascades; the paper has 0.111 and 0.189 for its own, whose faces are cropped above the eyebrows.
    pub face_width_m: [f64; 2],
}

impl Default for AssociationSettings {
    fn default() -> Self {
        Self {
            weighted: true,
            residual_m: 0.6,
            deviations: 3.0,
            height_m: [0.7, 2.1],
            face_width_m: [0.13, 0.25],
        }
    }
}

impl AssociationSettings {
    /// The width of a face in the mean and its deviation, so that the two bounds are two deviations away.
    pub fn face_width(&self) -> (f64, f64) {
        let [low, high] = self.face_width_m;
        (0.5 * (low + high), (0.25 * (high - low)).max(1e-3))
    }
}

/// Why an association does not survive, or that it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It may be.
    Survives,
    /// Both are too far apart.
    Apart,
    /// The speaker would be too low or too high.
    Height,
    /// The face would be too narrow or too wide.
    Width,
}

/// A sound and a face put together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Where they meet.
    pub meeting: Meeting,
    /// How far apart they are as a share of what is allowed, squared: below 1 where it survives.
    pub strain: f64,
    /// Whether it survives.
    pub verdict: Verdict,
}

/// Puts a sound and a face together; `floor_m` is the height of the floor. None where they meet nowhere.
pub fn associate(
    sight: &SightLine,
    sound: &PointEstimate,
    floor_m: f64,
    settings: &AssociationSettings,
) -> Option<Match> {
    let (meeting, strain) = if settings.weighted {
        let meeting = weighted(sight, sound)?;
        (meeting, meeting.misfit / settings.deviations.powi(2))
    } else {
        let meeting = nearest_to_both(&sight.ray, sound.mean, Vector3::z_axis())?;
        (meeting, (meeting.residual_m / settings.residual_m).powi(2))
    };
    let height_m = meeting.point.0.z - floor_m;
    let width_m = sight.width_per_metre * meeting.range_m;
    let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    let verdict = if strain >= 1.0 || strain.is_nan() {
        Verdict::Apart
    } else if !within(settings.height_m, height_m) {
        Verdict::Height
    } else if !within(settings.face_width_m, width_m) {
        Verdict::Width
    } else {
        Verdict::Survives
    };
    Some(Match {
        meeting,
        strain,
        verdict,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::{Ray, WorldPoint};
    use nalgebra::{Matrix3, Unit};

    fn sight(width_per_metre: f64) -> SightLine {
        SightLine {
            ray: Ray {
                origin: WorldPoint::new(0.0, 0.0, 1.3),
                direction: Unit::new_normalize(Vector3::new(1.0, 0.0, 0.0)),
            },
            deviation_rad: 0.004,
            width_per_metre,
            range_m: None,
        }
    }

    fn sound(y: f64) -> PointEstimate {
        PointEstimate {
            mean: WorldPoint::new(2.5, y, 1.2),
            covariance: Matrix3::identity() * 0.2_f64.powi(2),
        }
    }

    #[test]
    fn distance_height_and_width_are_asked_in_both_forms() {
        for weighted in [false, true] {
            let settings = AssociationSettings {
                weighted,
                ..AssociationSettings::default()
            };
            let verdict = |sight, sound, floor_m| {
                associate(&sight, &sound, floor_m, &settings).map(|found| found.verdict)
            };
            assert_eq!(verdict(sight(0.06), sound(0.1), 0.0), Some(Verdict::Survives));
            assert_eq!(verdict(sight(0.06), sound(1.5), 0.0), Some(Verdict::Apart));
            assert_eq!(verdict(sight(0.06), sound(0.1), -1.0), Some(Verdict::Height));
            assert_eq!(verdict(sight(0.12), sound(0.1), 0.0), Some(Verdict::Width));
        }
    }
}
