//! What is in walls and on them: doors and pictures.

use super::colours::linear;
use super::raw::RawScene;
use super::resolve::Resolver;
use super::surroundings::{Door, WOODS, pick, plain, vivid};
use crate::acoustics::random::{between, generator};
use crate::world::{Block, Material, Pattern};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};
use rand::Rng;

impl Resolver {
    pub(super) fn doors(
        &self,
        raw: &RawScene,
        blocks: &mut Vec<Block>,
    ) -> Result<Vec<Door>, ConfigurationError> {
        let [length, width, height] = self.size_m;
        let mut doors = Vec::new();
        for (number, raw) in raw.room.door.iter().enumerate() {
            let field = Field::of("room").key("door").index(number);
            let Some([x, y]) = raw.at else {
                return Err(self.missing(&field, "at", "give the place of its middle, [x, y], on a wall"));
            };
            self.inside(&field.key("at"), [x, y, 0.0])?;
            let leaf = self.number(
                &field.key("width"),
                raw.width,
                0.9,
                [0.5, 4.0],
                "give 0.5 to 4 metres",
            )?;
            let tall = self.number(
                &field.key("height"),
                raw.height,
                2.05,
                [1.0, height],
                "it must fit the room",
            )?;
            // The nearest wall, its middle line, and the way into the room.
            let walls: [(f64, Point2<f64>, Vector2<f64>); 4] = [
                (x, Point2::new(0.0, y), Vector2::x()),
                (length - x, Point2::new(length, y), Vector2::new(-1.0, 0.0)),
                (y, Point2::new(x, 0.0), Vector2::y()),
                (width - y, Point2::new(x, width), Vector2::new(0.0, -1.0)),
            ];
            let nearest = walls.iter().min_by(|one, other| one.0.total_cmp(&other.0));
            let (_, place, inwards) = nearest.copied().unwrap_or(walls[0]);
            let name = self.name_of(&field);
            let mut random = generator(self.seed_of("door", &name), "door", 0);
            let usual = plain(linear(pick(&mut random, &WOODS)), self.seed_of("door", &name));
            let along = inwards.x.abs() > 0.5;
            let centre = place + inwards * 0.02;
            blocks.push(Block {
                name: name.clone(),
                centre: WorldPoint::new(centre.x, centre.y, tall / 2.0),
                size_m: if along {
                    [0.04, leaf, tall]
                } else {
                    [leaf, 0.04, tall]
                },
                yaw_rad: 0.0,
                material: self.material(&field.key("material"), raw.material.as_ref(), usual)?,
            });
            doors.push(Door {
                place,
                inwards,
                width_m: leaf,
            });
        }
        Ok(doors)
    }

    /// Pictures and boards on the walls, where no door is.
    pub(super) fn hang_pictures(&self, each_ten_metres: f64, doors: &[Door], blocks: &mut Vec<Block>) {
        let [length, width, height] = self.size_m;
        let mut random = generator(self.seed, "pictures", 0);
        let around = 2.0 * (length + width);
        let count = (each_ten_metres * around / 10.0).round() as usize;
        let mut hung: Vec<(usize, f64, f64)> = Vec::new();
        for number in 0..count {
            for _ in 0..20 {
                let wall = (between(&mut random, 0.0, 4.0) as usize).min(3);
                let room = if wall < 2 { width } else { length };
                let across = between(&mut random, 0.3, 1.3).min(0.5 * room);
                let high = between(&mut random, 0.3, 0.9).min(0.4 * height);
                let at = between(&mut random, 0.5 * across + 0.1, room - 0.5 * across - 0.1);
                let middle =
                    between(&mut random, 0.45 * height, 0.75 * height).min(height - 0.5 * high - 0.05);
                let (x, y) = match wall {
                    0 => (0.015, at),
                    1 => (length - 0.015, at),
                    2 => (at, 0.015),
                    _ => (at, width - 0.015),
                };
                let near_door = doors.iter().any(|door| {
                    (Point2::new(x, y) - door.place).norm() < 0.5 * (door.width_m + across) + 0.15
                });
                let overlaps = hung.iter().any(|(other, place, wide)| {
                    *other == wall && (place - at).abs() < 0.5 * (wide + across) + 0.08
                });
                if near_door || overlaps {
                    continue;
                }
                hung.push((wall, at, across));
                let pattern = [
                    Pattern::Clutter,
                    Pattern::Clouds,
                    Pattern::Squares,
                    Pattern::Clutter,
                ][(between(&mut random, 0.0, 4.0) as usize).min(3)];
                let material = Material {
                    colour: vivid(&mut random),
                    second: vivid(&mut random),
                    pattern,
                    scale_m: between(&mut random, 0.06, 0.3) as f32,
                    seed: random.next_u64(),
                };
                blocks.push(Block {
                    name: format!("picture{}", number + 1),
                    centre: WorldPoint::new(x, y, middle),
                    size_m: if wall < 2 {
                        [0.03, across, high]
                    } else {
                        [across, 0.03, high]
                    },
                    yaw_rad: 0.0,
                    material,
                });
                break;
            }
        }
    }
}
