//! The box that sound is in: its walls, what they absorb, and whether something is inside.

use super::decay::{absorption, time_of_box_s};
use super::error::{AcousticsError, check};
use hearsight_core::WorldPoint;
use serde::{Deserialize, Serialize};

/// Octave bands with absorption of their own.
pub const BANDS: usize = 6;
/// Middles of the bands, hertz. The first reaches down to 0 Hz and the last up to half the rate.
pub const BAND_CENTRES_HZ: [f64; BANDS] = [125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0];

/// What the walls do to sound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one in a room, and it is copied once"
)]
pub enum Walls {
    /// No reflections at all.
    Anechoic,
    /// All alike and for all frequencies: absorption is sought that gives this reverberation time, seconds.
    T60(f64),
    /// All alike: a reverberation time for each band, seconds.
    BandT60([f64; BANDS]),
    /// For each wall (smallest x, largest x, smallest y, largest y, floor, ceiling) the share of the energy absorbed.
    Absorption([f64; 6]),
    /// For each wall the share absorbed in each band.
    BandAbsorption([[f64; BANDS]; 6]),
}

/// What a room is to sound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShoeboxSettings {
    /// The corner with the smallest coordinates, metres.
    pub origin: WorldPoint,
    /// Length, width and height, metres, each 0.5 to 200.
    pub size_m: [f64; 3],
    /// The walls. Reverberation times are 0.05 to 10 s, shares 0 to 1.
    pub walls: Walls,
    /// How far each image source is displaced at most along each axis, metres, 0 to 0.5; 0.05 to 0.08 takes away the
    /// sweeping echoes that perfectly parallel walls have (De Sena et al. 2015). The direct sound is never displaced.
    pub jitter_m: f64,
    /// Speed of sound, metres a second, 200 to 2000; 343 at 20 degrees.
    pub speed_m_s: f64,
    /// What distinguishes these displacements from those of other rooms.
    pub seed: u64,
}

impl ShoeboxSettings {
    /// A room of this size at the world's origin with displaced images.
    pub fn new(size_m: [f64; 3], walls: Walls) -> Self {
        Self {
            origin: WorldPoint::new(0.0, 0.0, 0.0),
            size_m,
            walls,
            jitter_m: 0.07,
            speed_m_s: 343.0,
            seed: 0,
        }
    }
}

/// A box with walls of known reflection.
#[derive(Clone, Debug, PartialEq)]
pub struct Shoebox {
    settings: ShoeboxSettings,
    /// Amplitude reflected, for each wall and band; of bands only the first counts unless `banded`.
    reflection: [[f64; BANDS]; 6],
    banded: bool,
    /// Reverberation time expected in each band, seconds; 0 where nothing is reflected.
    t60_s: [f64; BANDS],
}

impl Shoebox {
    /// Checks the settings and finds the absorption.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] where a setting is out of its range, [`AcousticsError::Unreachable`] where no
    /// absorption gives a reverberation time.
    pub fn new(settings: &ShoeboxSettings) -> Result<Self, AcousticsError> {
        for (axis, length) in ["length", "width", "height"].iter().zip(settings.size_m) {
            let entry = format!("the room's {axis}");
            check(
                (0.5..=200.0).contains(&length),
                entry,
                "within 0.5 and 200 m",
                length,
            )?;
        }
        let (jitter, speed) = (settings.jitter_m, settings.speed_m_s);
        check(
            (0.0..=0.5).contains(&jitter),
            "the room's jitter_m",
            "within 0 and 0.5",
            jitter,
        )?;
        check(
            (200.0..=2000.0).contains(&speed),
            "the room's speed_m_s",
            "within 200 and 2000",
            speed,
        )?;
        for coordinate in settings.origin.0.iter() {
            check(
                coordinate.abs() <= 1e6,
                "the room's origin",
                "a place within 1000 km",
                *coordinate,
            )?;
        }
        let sought = |entry: &str, wanted: f64| {
            check(
                (0.05..=10.0).contains(&wanted),
                entry,
                "within 0.05 and 10 s",
                wanted,
            )?;
            absorption(settings.size_m, wanted, speed, entry)
        };
        let (absorbed, banded) = match settings.walls {
            Walls::Anechoic => ([[1.0; BANDS]; 6], false),
            Walls::T60(wanted) => ([[sought("the room's t60", wanted)?; BANDS]; 6], false),
            Walls::BandT60(wanted) => {
                let mut bands = [0.0; BANDS];
                for (band, wanted) in wanted.into_iter().enumerate() {
                    let entry = format!("the room's t60 at {} Hz", BAND_CENTRES_HZ[band]);
                    bands[band] = sought(&entry, wanted)?;
                }
                ([bands; 6], true)
            }
            Walls::Absorption(walls) => (walls.map(|wall| [wall; BANDS]), false),
            Walls::BandAbsorption(walls) => (walls, true),
        };
        for (wall, bands) in absorbed.iter().enumerate() {
            for share in bands {
                let entry = format!("the absorption of the room's wall {wall}");
                check((0.0..=1.0).contains(share), entry, "within 0 and 1", *share)?;
            }
        }
        let reflection = absorbed.map(|wall| wall.map(|share| (1.0 - share).sqrt()));
        let mut t60_s = [0.0; BANDS];
        for (band, time) in t60_s.iter_mut().enumerate() {
            let log = |wall: usize| reflection[wall][band].max(1e-9).ln();
            let pairs = [0, 2, 4].map(|wall| 0.5 * (log(wall) + log(wall + 1)));
            *time = if settings.walls == Walls::Anechoic {
                0.0
            } else {
                time_of_box_s(settings.size_m, pairs, speed)
                    .unwrap_or(10.0)
                    .min(10.0)
            };
        }
        Ok(Self {
            settings: *settings,
            reflection,
            banded,
            t60_s,
        })
    }

    /// What it was made of.
    pub fn settings(&self) -> &ShoeboxSettings {
        &self.settings
    }

    /// Amplitude reflected by each wall in each band.
    pub fn reflection(&self) -> &[[f64; BANDS]; 6] {
        &self.reflection
    }

    /// Whether bands differ. Where they do not, one response serves all of them.
    pub fn is_banded(&self) -> bool {
        self.banded
    }

    /// The reverberation time expected in each band, seconds (at most 10); 0 where the walls reflect nothing.
    pub fn t60_s(&self) -> [f64; BANDS] {
        self.t60_s
    }

    /// The longest of the bands' reverberation times, seconds.
    pub fn longest_t60_s(&self) -> f64 {
        self.t60_s.into_iter().fold(0.0, f64::max)
    }

    /// Length of the diagonal, metres.
    pub fn diagonal_m(&self) -> f64 {
        self.settings
            .size_m
            .iter()
            .map(|side| side * side)
            .sum::<f64>()
            .sqrt()
    }

    /// Coordinates from the corner, or an error that names what is outside.
    pub(crate) fn inside(
        &self,
        position: WorldPoint,
        time_s: f64,
        entry: impl FnOnce() -> String,
    ) -> Result<[f64; 3], AcousticsError> {
        let (origin, size) = (self.settings.origin.0, self.settings.size_m);
        let within = position.0 - origin;
        // False for what is not a number, too.
        if (0..3).all(|axis| (0.0..=size[axis]).contains(&within[axis])) {
            return Ok([within.x, within.y, within.z]);
        }
        Err(AcousticsError::Outside {
            entry: entry(),
            time_s,
            position,
            lowest: self.settings.origin,
            highest: WorldPoint(origin + nalgebra::Vector3::from(size)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_rooms_are_refused_by_name() {
        let message = |settings: ShoeboxSettings| Shoebox::new(&settings).unwrap_err().to_string();
        let good = ShoeboxSettings::new([6.0, 5.0, 3.0], Walls::T60(0.4));
        assert!(
            message(ShoeboxSettings {
                size_m: [6.0, -5.0, 3.0],
                ..good
            })
            .contains("the room's width")
        );
        assert!(
            message(ShoeboxSettings {
                size_m: [6.0, 5.0, f64::NAN],
                ..good
            })
            .contains("the room's height")
        );
        assert!(
            message(ShoeboxSettings {
                size_m: [30.0, 20.0, 9.0],
                walls: Walls::T60(0.05),
                ..good
            })
            .contains("choose at least")
        );
        assert!(
            message(ShoeboxSettings {
                walls: Walls::T60(f64::NAN),
                ..good
            })
            .contains("the room's t60")
        );
        let bands = [0.4, 0.4, 0.01, 0.4, 0.4, 0.4];
        assert!(
            message(ShoeboxSettings {
                walls: Walls::BandT60(bands),
                ..good
            })
            .contains("t60 at 500 Hz")
        );
        let walls = Walls::Absorption([0.1, 0.1, 1.5, 0.1, 0.1, 0.1]);
        assert!(message(ShoeboxSettings { walls, ..good }).contains("wall 2"));
        assert!(
            message(ShoeboxSettings {
                jitter_m: 3.0,
                ..good
            })
            .contains("jitter_m")
        );
    }

    #[test]
    fn what_is_outside_is_told_where_it_is() {
        let room = Shoebox::new(&ShoeboxSettings::new([6.0, 5.0, 3.0], Walls::Anechoic)).unwrap();
        let entry = || "source \"anna\"".to_owned();
        let error = room
            .inside(WorldPoint::new(7.0, 1.0, 1.0), 2.5, entry)
            .unwrap_err();
        assert!(
            error.to_string().contains("source \"anna\" at 2.500 s"),
            "{error}"
        );
        assert!(
            room.inside(WorldPoint::new(f64::NAN, 1.0, 1.0), 0.0, entry)
                .is_err()
        );
        assert_eq!(
            room.inside(WorldPoint::new(1.0, 2.0, 3.0), 0.0, entry),
            Ok([1.0, 2.0, 3.0])
        );
    }

    #[test]
    fn the_time_expected_is_the_one_wanted() {
        let wanted = [0.8, 0.7, 0.6, 0.5, 0.4, 0.3];
        let room = Shoebox::new(&ShoeboxSettings::new([7.0, 4.0, 2.8], Walls::BandT60(wanted))).unwrap();
        assert!(room.is_banded());
        for (expected, wanted) in room.t60_s().into_iter().zip(wanted) {
            assert!((expected / wanted - 1.0).abs() < 0.03);
        }
    }
}
