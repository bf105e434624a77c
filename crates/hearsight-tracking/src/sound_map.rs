//! From delays to columns of a picture, for people to look at and for estimates by sound alone.
//!
//! A delay is a surface in the room, not a column: the map takes sounds at the row where heads usually are and
//! at a nominal range (method sheet, notes for several people).

use crate::percepts::{ArrayPercepts, wrapped_rad};
use hearsight_core::DistortedPixel;
use hearsight_core::camera::Camera;

/// The delay of the first microphone pair, or the azimuth around the whole array, at every column of a picture.
#[derive(Clone, Debug)]
pub struct SoundMap {
    delays_s: Vec<f64>,
    step_px: f64,
    /// Half of a turn where delays are azimuths, and go all round: a greater step from one column to the next is none.
    half_turn: f64,
}

/// Columns of the map.
const COLUMNS: usize = 181;

impl SoundMap {
    /// Range at which sounds are taken to be, metres: the middle of a room.
    pub const NOMINAL_RANGE_M: f64 = 2.5;
    /// Row at which they are taken to be, as a share of the picture's height: a little above its middle, where cameras
    /// are pointed so that they see people.
    pub const HEAD_ROW: f64 = 0.4;

    /// The map of a camera for an array.
    pub fn new(camera: &Camera, array: &ArrayPercepts) -> Self {
        let step_px = camera.width as f64 / (COLUMNS - 1) as f64;
        let row = Self::HEAD_ROW * camera.height as f64;
        let delays_s = (0..COLUMNS)
            .map(|column| {
                camera
                    .ray(DistortedPixel::new(column as f64 * step_px - 0.5, row))
                    .and_then(|ray| array.delay_s(ray.at(Self::NOMINAL_RANGE_M)))
                    .unwrap_or(f64::NAN)
            })
            .collect();
        let half_turn = if array.is_circular() {
            std::f64::consts::PI
        } else {
            f64::INFINITY
        };
        Self {
            delays_s,
            step_px,
            half_turn,
        }
    }

    /// The column that a delay points at, pixels; `None` where it points outside the picture.
    pub fn column(&self, delay_s: f64) -> Option<f64> {
        self.delays_s.windows(2).enumerate().find_map(|(column, pair)| {
            let (before, after) = (self.apart(pair[0], delay_s), self.apart(pair[1], delay_s));
            (before * after <= 0.0 && before != after && (before - after).abs() < self.half_turn)
                .then(|| (column as f64 + before / (before - after)) * self.step_px - 0.5)
        })
    }

    fn apart(&self, place: f64, from: f64) -> f64 {
        if self.half_turn.is_finite() {
            wrapped_rad(place - from)
        } else {
            place - from
        }
    }

    /// The correlation of this moment over the columns, 0 to 1; empty without sound.
    pub fn strip(&self, array: &ArrayPercepts, strip: &mut Vec<f32>) {
        strip.clear();
        if array.has_onset() {
            strip.extend(self.delays_s.iter().map(|delay_s| array.onset_height(*delay_s)));
        }
    }
}
