//! Whether people keep out of walls and furniture, and sensors on bases inside the room.

use super::resolve::Resolver;
use super::surroundings::{Footprint, Surroundings};
use crate::world::{CameraDevice, Person, World};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::Point2;

/// Bodies are looked at so often, seconds.
const STEP_S: f64 = 0.1;
/// What somebody steps over, metres.
const STEP_OVER_M: f64 = 0.15;
/// From the middle of a head to above its crown, metres.
const ABOVE_HEAD_M: f64 = 0.15;
/// Elbows and coats give way: bodies count as so much thinner.
const GIVES_WAY: f64 = 0.8;

impl Resolver {
    pub(super) fn check_motion(
        &self,
        world: &World,
        surroundings: &Surroundings,
    ) -> Result<(), ConfigurationError> {
        for (number, person) in world.people.iter().enumerate() {
            self.check_person(number, person, surroundings)?;
        }
        self.check_company(world)?;
        self.check_cameras(world)?;
        let Ok(controls) = world.controls() else {
            return Ok(());
        };
        let steps = (world.seconds / STEP_S) as usize;
        for (number, base) in world.bases.iter().enumerate() {
            for step in 0..=steps {
                let time_s = step as f64 * STEP_S;
                let [x, y, _] = controls.base(&world.bases, number, time_s);
                let inside = x >= 0.0 && y >= 0.0 && x <= self.size_m[0] && y <= self.size_m[1];
                if !inside {
                    let what = format!(
                        "`{}` is outside the room at {time_s:.1} s, at ({x:.2}, {y:.2})",
                        base.name
                    );
                    return Err(self.wrong(
                        &Field::of("base").index(number),
                        what,
                        "drive less far, or stop it",
                    ));
                }
            }
        }
        let mut places = Vec::new();
        for (number, array) in world
            .arrays
            .iter()
            .enumerate()
            .filter(|(_, array)| array.base.is_some())
        {
            places.resize(array.microphones.len(), WorldPoint::new(0.0, 0.0, 0.0));
            for step in 0..=steps {
                let time_s = step as f64 * STEP_S;
                controls.microphones(array, &world.bases, time_s, &mut places);
                if let Some(place) = places.iter().find(|place| !self.holds(**place)) {
                    let p = place.0;
                    let what = format!(
                        "a microphone of `{}` is outside the room at {time_s:.1} s, at ({:.2}, {:.2}, {:.2})",
                        array.name, p.x, p.y, p.z
                    );
                    return Err(self.wrong(
                        &Field::of("array").index(number),
                        what,
                        "keep its base away from walls",
                    ));
                }
            }
        }
        Ok(())
    }

    fn holds(&self, place: WorldPoint) -> bool {
        place
            .0
            .iter()
            .zip(self.size_m)
            .all(|(value, size)| (0.0..=size).contains(value))
    }

    fn check_person(
        &self,
        number: usize,
        person: &Person,
        surroundings: &Surroundings,
    ) -> Result<(), ConfigurationError> {
        let radius = GIVES_WAY * person.figure.radius_m;
        let until = person.motion.end_s().max(0.0).min(self.seconds);
        for step in 0..=(until / STEP_S).ceil() as usize {
            let time_s = (step as f64 * STEP_S).min(until);
            let stance = person.motion.stance(time_s);
            if !stance.present {
                continue;
            }
            let place = stance.place;
            let field = self.entry_at(number, time_s);
            if !self.keeps_from_walls(place, radius, surroundings) {
                let what = format!(
                    "`{}` is in a wall at {time_s:.1} s, at ({:.2}, {:.2})",
                    person.name, place.x, place.y
                );
                let cure =
                    "keep people a quarter of a metre from walls; through doors they `leave` and `enter`";
                return Err(self.wrong(&field, what, cure));
            }
            let sits = stance.sitting > 0.0;
            let hit = surroundings.footprints.iter().find(|piece| {
                let in_the_way =
                    piece.heights_m[0] < person.figure.height_m && piece.heights_m[1] > STEP_OVER_M;
                // Knees go under tables, and whoever sits, sits on something.
                let allowed = piece.seat_m.is_some() || (sits && is_low(piece, place));
                in_the_way && !allowed && piece.touches(place, radius)
            });
            if let Some(piece) = hit {
                let what = format!(
                    "`{}` is in `{}` at {time_s:.1} s, at ({:.2}, {:.2})",
                    person.name, piece.name, place.x, place.y
                );
                return Err(self.wrong(&field, what, "walk around it, or move it"));
            }
        }
        Ok(())
    }

    /// Whether nobody stops where somebody else rests. Those who walk may brush by each other.
    fn check_company(&self, world: &World) -> Result<(), ConfigurationError> {
        let ends = world.people.iter().map(|person| person.motion.end_s());
        // Who arrives last has stopped two steps later.
        let until = (ends.fold(0.0, f64::max) + 2.0 * STEP_S).min(self.seconds);
        let mut places: Vec<Option<Point2<f64>>> = vec![None; world.people.len()];
        let mut rests = vec![false; world.people.len()];
        for step in 0..=(until / STEP_S).ceil() as usize {
            let time_s = (step as f64 * STEP_S).min(until);
            let mut stopped = Vec::new();
            for (number, person) in world.people.iter().enumerate() {
                let stance = person.motion.stance(time_s);
                let place = stance.present.then_some(stance.place);
                let resting = place.is_some_and(|place| {
                    step == 0 || places[number].is_some_and(|before| (before - place).norm() < 1e-6)
                });
                if resting && !rests[number] {
                    stopped.push(number);
                }
                (places[number], rests[number]) = (place, resting);
            }
            for number in stopped {
                let (Some(place), person) = (places[number], &world.people[number]) else {
                    continue;
                };
                let there = (0..world.people.len()).find(|&other| {
                    let apart =
                        0.5 * GIVES_WAY * (person.figure.radius_m + world.people[other].figure.radius_m);
                    other != number
                        && rests[other]
                        && places[other].is_some_and(|other| (other - place).norm() < apart)
                });
                if let Some(other) = there {
                    let later = number.max(other);
                    let what = format!(
                        "`{}` is where `{}` is at {time_s:.1} s, at ({:.2}, {:.2})",
                        world.people[later].name,
                        world.people[number.min(other)].name,
                        place.x,
                        place.y
                    );
                    return Err(self.wrong(
                        &self.entry_at(later, time_s),
                        what,
                        "leave each a place of their own",
                    ));
                }
            }
        }
        Ok(())
    }

    /// Whether no camera that rests is in somebody's head or body.
    fn check_cameras(&self, world: &World) -> Result<(), ConfigurationError> {
        let fixed: Vec<_> = world
            .cameras
            .iter()
            .filter(|camera| camera.mount.base.is_none())
            .collect();
        for (number, person) in world.people.iter().enumerate() {
            let until = person.motion.end_s().max(0.0).min(self.seconds);
            for step in 0..=(until / STEP_S).ceil() as usize {
                let time_s = (step as f64 * STEP_S).min(until);
                let stance = person.motion.stance(time_s);
                let within = |camera: &&&CameraDevice| {
                    let place = camera.mount.position.0;
                    (place.xy() - stance.place).norm() < GIVES_WAY * person.figure.radius_m
                        && world
                            .head_anchor(number, time_s)
                            .is_some_and(|head| place.z < head.0.z + ABOVE_HEAD_M)
                };
                if let Some(camera) = fixed.iter().find(within) {
                    let what = format!(
                        "`{}` is where the camera `{}` is at {time_s:.1} s, at ({:.2}, {:.2})",
                        person.name, camera.name, stance.place.x, stance.place.y
                    );
                    let cure = "keep people from cameras, or put the camera above their heads";
                    return Err(self.wrong(&self.entry_at(number, time_s), what, cure));
                }
            }
        }
        Ok(())
    }

    /// The entry of the scenario that brought somebody to where they are at a time.
    fn entry_at(&self, number: usize, time_s: f64) -> Field {
        let field = Field::of("person").index(number);
        match self.actions_before(number, time_s) {
            Some(action) => field.key("action").index(action),
            None => field.key("at"),
        }
    }

    /// Whether a body at a place keeps out of walls, doors apart.
    fn keeps_from_walls(&self, place: Point2<f64>, radius: f64, surroundings: &Surroundings) -> bool {
        let [length, width, _] = self.size_m;
        let free =
            place.x >= radius && place.y >= radius && place.x <= length - radius && place.y <= width - radius;
        free || surroundings.doors.iter().any(|door| {
            let off = place - door.place;
            let along = off.x * door.inwards.y - off.y * door.inwards.x;
            let inwards = off.dot(&door.inwards);
            along.abs() <= 0.5 * door.width_m && (-0.6..1.0).contains(&inwards)
        })
    }
}

/// Whether somebody who sits may have their knees under it: a table whose edge they sit at.
fn is_low(piece: &Footprint, place: Point2<f64>) -> bool {
    piece.heights_m[1] < 1.0 && !piece.touches(place, 0.02)
}
