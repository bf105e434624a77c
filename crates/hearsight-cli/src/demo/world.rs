//! Who is where and who talks, as functions of time.

/// Pixels a row of the video.
pub(crate) const WIDTH: usize = 320;
/// Rows of the video.
pub(crate) const HEIGHT: usize = 240;
/// Focal length, pixels: a picture 53 degrees wide.
pub(crate) const FOCAL_PX: f64 = 320.0;
/// Frames a second.
pub(crate) const FRAMES_PER_SECOND: f64 = 25.0;
/// Samples a second.
pub(crate) const RATE_HZ: u32 = 16_000;
/// The microphones, left and right of the camera, metres.
pub(crate) const MICROPHONES_M: [[f64; 3]; 2] = [[-0.475, 0.0, 1.4], [0.475, 0.0, 1.4]];
/// Metres a second.
pub(crate) const SPEED_OF_SOUND_M_S: f64 = 343.0;
/// Height of a mouth above the floor, metres.
const MOUTH_M: f64 = 1.55;
/// A turn of talking with the pause after it, seconds.
const TURN_S: f64 = 2.4;
/// The pause, seconds.
const PAUSE_S: f64 = 0.4;

/// The made-up room.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    /// How long it lasts, seconds.
    pub(crate) seconds: f64,
}

/// What is true of one person at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Truth {
    /// The mouth, metres.
    pub(crate) mouth_m: [f64; 3],
    /// The middle of the head in the picture, pixels.
    pub(crate) head_px: [f64; 2],
    /// Pixels a metre at the person.
    pub(crate) scale_px: f64,
    /// Whether the person talks.
    pub(crate) talking: bool,
}

impl World {
    /// Both people at a time.
    pub(crate) fn people(&self, time_s: f64) -> [Truth; 2] {
        let turn = (time_s / TURN_S).floor();
        let talks = time_s - turn * TURN_S < TURN_S - PAUSE_S;
        let talker = if turn.rem_euclid(2.0) < 1.0 { 0 } else { 1 };
        [0, 1].map(|person| self.person(person, time_s, talks && talker == person))
    }

    fn person(&self, person: usize, time_s: f64, talking: bool) -> Truth {
        // One walks on the left half, the other on the right half and a little farther away.
        let (middle_m, reach_m, distance_m, period_s) = if person == 0 {
            (-0.62, 0.36, 2.4, 6.3)
        } else {
            (0.68, 0.45, 2.8, 7.7)
        };
        let phase = time_s / period_s * std::f64::consts::TAU;
        let x = middle_m + reach_m * phase.sin();
        let y = distance_m + 0.12 * (0.7 * phase).cos();
        let scale_px = FOCAL_PX / y;
        let u = WIDTH as f64 / 2.0 + x * scale_px;
        // The middle of the head is 6 cm above the mouth.
        let v = HEIGHT as f64 / 2.0 - (MOUTH_M + 0.06 - 1.4) * scale_px;
        Truth {
            mouth_m: [x, y, MOUTH_M],
            head_px: [u, v],
            scale_px,
            talking,
        }
    }
}

/// A simple generator of random bits (splitmix64): the same everywhere and for ever.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Evenly from -1 to 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// About normal, of unit variance: the sum of four even ones.
    pub(crate) fn normal(&mut self) -> f64 {
        let sum: f64 = (0..4).map(|_| self.uniform()).sum();
        sum * 0.75_f64.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_stay_in_the_picture_and_one_talks_at_a_time() {
        let world = World { seconds: 30.0 };
        for tick in 0..750 {
            let people = world.people(f64::from(tick) / 25.0);
            for truth in people {
                assert!(truth.head_px[0] > 15.0 && truth.head_px[0] < 305.0, "{truth:?}");
                assert!(truth.head_px[1] > 20.0 && truth.head_px[1] < 200.0, "{truth:?}");
            }
            assert!(!(people[0].talking && people[1].talking));
        }
    }
}
