//! The sound verifier: the height of the whole correlation curve at a hypothesis' delay (Chen and Rui, equations 23 and
//! 24, corrected by E9).
//!
//! A sound belongs to whoever made it: the score is drawn towards 1, which says nothing, by the probability that the
//! person does not speak.

use super::{Cue, CueInfo, Evidence, Hypotheses, Subject};
use crate::body::Part;
use crate::percepts::{ArrayPercepts, CameraPercepts};
use hearsight_audio::bearing::PairBearing;

pub(super) const INFO: CueInfo = CueInfo {
    name: "curve",
    meaning: "height of the correlation at the hypothesis' delay over its highest peak (eq. 23)",
    unit: "1",
    range: (0.0, 1.0),
    larger_is_better: true,
    source: "Chen, Rui, section V.C, eqs. 23-24, corrected",
};

/// From a hypothesis to its delay.
#[derive(Clone, Copy, Debug)]
pub enum CurveGeometry {
    /// By the measured places of camera and microphones.
    World,
    /// By the column, the spacing of the microphones and the field of view (equation 24, corrected).
    Pair(PairBearing),
    /// The same as equation 24 is printed: everybody on the left is heard on the right.
    Printed(PairBearing),
}

/// Scores mouths by the correlation at their delay.
#[derive(Clone, Copy, Debug)]
pub struct CurveCue {
    geometry: CurveGeometry,
}

impl CurveCue {
    /// A cue with this geometry.
    pub fn new(geometry: CurveGeometry) -> Self {
        Self { geometry }
    }
}

impl Cue for CurveCue {
    fn info(&self) -> &'static CueInfo {
        &INFO
    }

    fn subject(&self) -> Subject {
        match self.geometry {
            CurveGeometry::World => Subject::Sounds,
            CurveGeometry::Pair(_) | CurveGeometry::Printed(_) => Subject::Regions(Part::Head),
        }
    }

    fn has_evidence(&self, _: &CameraPercepts, array: Option<&ArrayPercepts>) -> bool {
        array.is_some_and(|array| array.has_sound() && array.has_onset())
    }

    fn score(&self, hypotheses: &Hypotheses<'_>, scores: &mut [f32]) -> Evidence {
        let Some(array) = hypotheses.array else {
            return Evidence::Missing;
        };
        if !self.has_evidence(hypotheses.camera, hypotheses.array) {
            return Evidence::Missing;
        }
        let share = |height: f32| 1.0 - hypotheses.speaking * (1.0 - height);
        match self.geometry {
            CurveGeometry::World => {
                if hypotheses.sounds.len() != scores.len() {
                    return Evidence::Missing;
                }
                for (score, point) in scores.iter_mut().zip(hypotheses.sounds) {
                    let delay_s = point.and_then(|point| array.delay_s(point));
                    *score = share(delay_s.map_or(0.0, |delay_s| array.onset_height(delay_s)));
                }
            }
            CurveGeometry::Pair(pair) | CurveGeometry::Printed(pair) => {
                let printed = matches!(self.geometry, CurveGeometry::Printed(_));
                for (score, region) in scores.iter_mut().zip(hypotheses.regions) {
                    let column = f64::from(region.centre().0);
                    let delay_s = if printed {
                        pair.printed_delay_s(column)
                    } else {
                        pair.delay_s(column)
                    };
                    *score = share(array.onset_height(delay_s));
                }
            }
        }
        Evidence::Scored
    }
}
