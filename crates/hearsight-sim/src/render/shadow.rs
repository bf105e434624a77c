//! Soft shadows of people on the floor: around their feet, and away from the lamps.

use super::lamps::Lamps;

/// A shadow reaches no farther from the feet than this, metres.
const FARTHEST_M: f32 = 2.5;
/// Half the breadth of a lamp's shadow, metres.
const BREADTH_M: f32 = 0.22;
/// How far around a foot the floor is darker, metres.
const CONTACT_M: f32 = 0.13;

/// The shadow of one person.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadow {
    /// Feet and the place below the body, and how far each darkens the floor, metres.
    spots: [([f32; 2], f32); 3],
    middle: [f32; 2],
    streaks: Vec<Streak>,
    /// How far from the middle there is any shadow, squared, square metres.
    reach: f32,
}

/// What a lamp makes of somebody.
#[derive(Clone, Copy, Debug)]
struct Streak {
    /// Away from the lamp, unit length.
    away: [f32; 2],
    length_m: f32,
    depth: f32,
}

impl Shadow {
    /// Takes the places of both feet and of the body on the floor, and the height of the crown, metres.
    pub(super) fn set(&mut self, feet: [[f32; 2]; 2], middle: [f32; 2], crown_m: f32, lamps: &Lamps) {
        self.spots = [
            (feet[0], CONTACT_M),
            (feet[1], CONTACT_M),
            (middle, 2.2 * CONTACT_M),
        ];
        self.middle = middle;
        self.streaks.clear();
        let mut reach_m = 4.4 * CONTACT_M;
        for foot in feet {
            reach_m = reach_m
                .max((foot[0] - middle[0]).hypot(foot[1] - middle[1]).min(FARTHEST_M) + 2.0 * CONTACT_M);
        }
        let all: f32 = lamps.points().map(|(_, strength)| strength).sum();
        for (lamp, strength) in lamps.points() {
            let above = lamp.z - crown_m;
            let away = [middle[0] - lamp.x, middle[1] - lamp.y];
            let distance = away[0].hypot(away[1]);
            if above > 0.05 && distance > 1e-3 && strength > 0.0 {
                let length_m = (distance * crown_m / above).clamp(0.0, FARTHEST_M - 2.0 * BREADTH_M);
                let away = away.map(|part| part / distance);
                reach_m = reach_m.max(length_m + 2.0 * BREADTH_M);
                self.streaks.push(Streak {
                    away,
                    length_m,
                    depth: 0.5 * strength / all,
                });
            }
        }
        self.reach = reach_m * reach_m;
    }

    /// Share of the light that a place on the floor still gets.
    #[inline]
    pub(super) fn on(&self, floor: [f32; 2]) -> f32 {
        let offset = [floor[0] - self.middle[0], floor[1] - self.middle[1]];
        if offset[0] * offset[0] + offset[1] * offset[1] > self.reach {
            return 1.0;
        }
        let mut open = 1.0;
        for (place, breadth) in self.spots {
            let square = (floor[0] - place[0]).powi(2) + (floor[1] - place[1]).powi(2);
            open *= 1.0 - 0.35 * soft(square / (breadth * breadth));
        }
        for streak in &self.streaks {
            let along = offset[0] * streak.away[0] + offset[1] * streak.away[1];
            let beside = offset[0] * streak.away[1] - offset[1] * streak.away[0];
            if beside.abs() > 2.0 * BREADTH_M {
                continue;
            }
            let past = if along < 0.0 {
                -along
            } else {
                (along - streak.length_m).max(0.0)
            };
            let gap = (past * past + beside * beside) / (BREADTH_M * BREADTH_M);
            // Fainter the farther from the feet.
            let depth = streak.depth * (1.0 - 0.5 * along.max(0.0) / FARTHEST_M);
            open *= 1.0 - depth * soft(gap);
        }
        open
    }
}

/// From 1 at 0 to 0 at 4 and beyond, of a square of a distance: about a bell of unit width.
#[inline(always)]
fn soft(square: f32) -> f32 {
    let rest = (1.0 - 0.25 * square).max(0.0);
    rest * rest * rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Colour, Light, Material, Pattern, Setting};
    use hearsight_core::WorldPoint;

    #[test]
    fn shadows_lie_at_the_feet_and_away_from_the_lamp() {
        let colour: Colour = [1.0; 3];
        let material = Material {
            colour,
            second: colour,
            pattern: Pattern::Plain,
            scale_m: 1.0,
            seed: 0,
        };
        let setting = Setting {
            size_m: [4.0, 4.0, 3.0],
            origin: WorldPoint::new(0.0, 0.0, 0.0),
            surfaces: [material; 6],
            blocks: vec![],
            lights: vec![Light {
                position: WorldPoint::new(0.0, 2.0, 2.5),
                colour,
            }],
            ambient: colour,
        };
        let (mut lamps, mut shadow) = (Lamps::default(), Shadow::default());
        lamps.set(&setting, &[]);
        shadow.set([[2.0, 1.9], [2.0, 2.1]], [2.0, 2.0], 1.7, &lamps);
        assert!(shadow.on([2.0, 2.0]) < 0.5);
        assert!(shadow.on([3.2, 2.0]) < 0.8 && shadow.on([0.8, 2.0]) == 1.0);
        assert_eq!(shadow.on([2.0, 3.0]), 1.0);
        // A lamp that is out makes none.
        lamps.set(&setting, &[0.0]);
        shadow.set([[2.0, 1.9], [2.0, 2.1]], [2.0, 2.0], 1.7, &lamps);
        assert!(shadow.on([3.2, 2.0]) == 1.0 && shadow.on([2.0, 2.0]) < 0.7);
    }
}
