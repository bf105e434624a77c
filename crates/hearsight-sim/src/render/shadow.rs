//! Soft shadows of people on the floor: around their feet, and away from the lamps.

use super::figure::Figure;
use super::lamps::Lamps;

/// A shadow reaches no farther from the feet than this, metres.
const FARTHEST_M: f32 = 2.5;
/// Half the breadth of a lamp's shadow, metres.
const BREADTH_M: f32 = 0.22;
/// How far around a foot the floor is darker, metres.
const CONTACT_M: f32 = 0.13;

/// Share of the light that a place on the floor still gets.
pub(super) fn on_floor(figure: &Figure, lamps: &Lamps, floor: [f32; 2]) -> f32 {
    let [left, right, middle] = figure.ground;
    let square = |from: [f32; 2]| (floor[0] - from[0]).powi(2) + (floor[1] - from[1]).powi(2);
    if square(middle) > FARTHEST_M * FARTHEST_M {
        return 1.0;
    }
    let mut open = 1.0;
    for (place, breadth) in [(left, CONTACT_M), (right, CONTACT_M), (middle, 2.2 * CONTACT_M)] {
        open *= 1.0 - 0.35 * (-square(place) / (breadth * breadth)).exp();
    }
    let all: f32 = lamps.points().map(|(_, strength)| strength).sum();
    for (lamp, strength) in lamps.points() {
        let above = lamp.z - figure.crown_m;
        let away = [middle[0] - lamp.x, middle[1] - lamp.y];
        let distance = away[0].hypot(away[1]);
        if above <= 0.05 || distance < 1e-3 {
            continue;
        }
        let length = (distance * figure.crown_m / above).clamp(0.0, FARTHEST_M - BREADTH_M);
        let along = ((floor[0] - middle[0]) * away[0] + (floor[1] - middle[1]) * away[1]) / distance;
        let beside = ((floor[0] - middle[0]) * away[1] - (floor[1] - middle[1]) * away[0]) / distance;
        let past = if along < 0.0 {
            -along
        } else {
            (along - length).max(0.0)
        };
        let gap = past.hypot(beside) / BREADTH_M;
        if gap < 2.0 {
            // Softer the farther from the feet.
            let depth = 0.5 * strength / all.max(1e-6) * (1.0 - 0.5 * along.max(0.0) / FARTHEST_M);
            open *= 1.0 - depth * (-gap * gap).exp();
        }
    }
    open
}
