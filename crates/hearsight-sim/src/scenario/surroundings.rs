//! The room, its doors, furniture and lights.

use super::colours::{darker, linear};
use super::raw::{FurnitureKind, RawFurniture, RawScene};
use super::resolve::Resolver;
use crate::acoustics::random::{Generator, between, generator};
use crate::world::{Block, Colour, LampChanges, Light, Material, Pattern, Setting};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};
use rand::Rng;

/// Paints of walls, and of floors.
const WALLS: [u32; 7] = [
    0xe6e2d8, 0xd9dde0, 0xdcd6c4, 0xcfd8d0, 0xe0d2c8, 0xc9ced6, 0xebe7df,
];
const FLOORS: [u32; 6] = [0x8d7355, 0x6e6a66, 0xa08a6a, 0x75665a, 0x9a9690, 0x5c6670];
/// Wood and what else furniture is made of; skin-like woods are meant.
const WOODS: [u32; 6] = [0xb48c5c, 0x8a6242, 0xcda87a, 0x6b4a34, 0xc49a74, 0xe2d8c8];
const CLOTHS: [u32; 6] = [0x5a6478, 0x7a4a44, 0x4e6a58, 0x8c8474, 0x3c4250, 0xa08c6c];

/// How far outside its wall somebody is who has left, metres.
pub(super) const OUTSIDE_M: f64 = 0.45;
/// How far inside a door people walk to before they leave, metres.
pub(super) const THRESHOLD_M: f64 = 0.55;

/// The room with what stands in it, and what only a scenario must know of that.
pub(super) struct Surroundings {
    pub(super) setting: Setting,
    pub(super) lamp_changes: LampChanges,
    pub(super) doors: Vec<Door>,
    pub(super) footprints: Vec<Footprint>,
}

/// A door, for those who come and go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Door {
    /// Its middle on the floor, in the wall.
    pub(super) place: Point2<f64>,
    /// Into the room.
    pub(super) inwards: Vector2<f64>,
    pub(super) width_m: f64,
}

/// What a piece of furniture takes up.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    pub(super) name: String,
    pub(super) centre: Point2<f64>,
    pub(super) half_m: [f64; 2],
    pub(super) yaw_rad: f64,
    /// From and to, above the floor, metres.
    pub(super) heights_m: [f64; 2],
    /// Height of the seat, metres, of what people sit on.
    pub(super) seat_m: Option<f64>,
}

impl Footprint {
    /// Whether a disc reaches into it.
    pub(super) fn touches(&self, place: Point2<f64>, radius_m: f64) -> bool {
        let (sin, cos) = self.yaw_rad.sin_cos();
        let off = place - self.centre;
        let own = [off.x * cos + off.y * sin, off.y * cos - off.x * sin];
        let beyond = [0, 1].map(|axis| (own[axis].abs() - self.half_m[axis]).max(0.0));
        beyond[0].hypot(beyond[1]) < radius_m
    }
}

/// Name of a kind, for names of things.
pub(super) fn kind_name(kind: Option<FurnitureKind>) -> &'static str {
    match kind.unwrap_or(FurnitureKind::Box) {
        FurnitureKind::Table => "table",
        FurnitureKind::Chair => "chair",
        FurnitureKind::Sofa => "sofa",
        FurnitureKind::Cabinet => "cabinet",
        FurnitureKind::Shelf => "shelf",
        FurnitureKind::Pillar => "pillar",
        FurnitureKind::Screen => "screen",
        FurnitureKind::Board => "board",
        FurnitureKind::Box => "box",
    }
}

impl Resolver {
    pub(super) fn surroundings(&self, raw: &RawScene) -> Result<Surroundings, ConfigurationError> {
        let room = Field::of("room");
        let mut random = generator(self.seed, "surroundings", 0);
        let [length, width, height] = self.size_m;
        if raw.room.walls.len() > 4 || [2, 3].contains(&raw.room.walls.len()) {
            let what = format!("has {} entries", raw.room.walls.len());
            return Err(self.wrong(&room.key("walls"), what, "give one for all walls, or four"));
        }
        let paint = pick(&mut random, &WALLS);
        let wall = |number: usize| {
            let usual = Material {
                colour: linear(paint),
                second: linear(paint).map(|value| value * 0.93),
                pattern: Pattern::Clouds,
                scale_m: 0.35,
                seed: self.seed_of("wall", &number.to_string()),
            };
            let walls = &raw.room.walls;
            let entry = if number < walls.len() { number } else { 0 };
            self.material(&room.key("walls").index(entry), walls.get(entry), usual)
        };
        let floor_colour = linear(pick(&mut random, &FLOORS));
        let usual_floor = Material {
            colour: floor_colour,
            second: floor_colour.map(|value| value * 0.75),
            pattern: if between(&mut random, 0.0, 1.0) < 0.6 {
                Pattern::Planks
            } else {
                Pattern::Clouds
            },
            scale_m: 0.15,
            seed: self.seed_of("floor", ""),
        };
        let usual_ceiling = plain(linear(0xf2f2ee), self.seed_of("ceiling", ""));
        let surfaces = [
            self.material(&room.key("floor"), raw.room.floor.as_ref(), usual_floor)?,
            self.material(&room.key("ceiling"), raw.room.ceiling.as_ref(), usual_ceiling)?,
            wall(0)?,
            wall(1)?,
            wall(2)?,
            wall(3)?,
        ];
        let ambient = self.number(
            &room.key("ambient"),
            raw.room.ambient,
            0.35,
            [0.0, 1.0],
            "give 0 to 1",
        )?;
        let clutter = self.number(
            &room.key("clutter"),
            raw.room.clutter,
            2.0,
            [0.0, 10.0],
            "give 0 to 10",
        )?;
        let mut blocks = Vec::new();
        let doors = self.doors(raw, &mut blocks)?;
        self.hang_pictures(clutter, &doors, &mut blocks);
        let mut footprints = Vec::new();
        for (number, furniture) in raw.furniture.iter().enumerate() {
            let field = Field::of("furniture").index(number);
            let footprint = self.furniture(&field, furniture, height, &mut blocks)?;
            footprints.push(footprint);
        }
        let (lights, lamp_changes) = self.lights(raw, [length, width, height], &mut random)?;
        let setting = Setting {
            size_m: self.size_m,
            origin: WorldPoint::new(0.0, 0.0, 0.0),
            surfaces,
            blocks,
            lights,
            ambient: [ambient as f32; 3],
        };
        Ok(Surroundings {
            setting,
            lamp_changes,
            doors,
            footprints,
        })
    }

    fn doors(&self, raw: &RawScene, blocks: &mut Vec<Block>) -> Result<Vec<Door>, ConfigurationError> {
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
    fn hang_pictures(&self, each_ten_metres: f64, doors: &[Door], blocks: &mut Vec<Block>) {
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

    fn furniture(
        &self,
        field: &Field,
        raw: &RawFurniture,
        height: f64,
        blocks: &mut Vec<Block>,
    ) -> Result<Footprint, ConfigurationError> {
        let kind = raw.kind.unwrap_or(FurnitureKind::Box);
        let Some([x, y]) = raw.at else {
            return Err(self.missing(field, "at", "give the place of its middle on the floor, [x, y]"));
        };
        self.inside(&field.key("at"), [x, y, 0.0])?;
        let usual_size = match kind {
            FurnitureKind::Table => [1.6, 0.8, 0.74],
            FurnitureKind::Chair => [0.45, 0.45, 0.9],
            FurnitureKind::Sofa => [0.9, 1.9, 0.8],
            FurnitureKind::Cabinet => [0.45, 1.0, 1.8],
            FurnitureKind::Shelf => [0.3, 1.0, 1.9],
            FurnitureKind::Pillar => [0.4, 0.4, height],
            FurnitureKind::Screen => [0.05, 1.2, 1.8],
            FurnitureKind::Board => [0.05, 1.4, 0.9],
            FurnitureKind::Box => [0.5; 3],
        };
        let size = raw.size.unwrap_or(usual_size);
        for (axis, length) in size.iter().enumerate() {
            if !(0.01..=50.0).contains(length) {
                let what = format!("{length} m is no size");
                return Err(self.wrong(&field.key("size").index(axis), what, "give 0.01 to 50 metres"));
            }
        }
        let above = raw
            .above
            .unwrap_or(if kind == FurnitureKind::Board { 1.0 } else { 0.0 });
        if !(above >= 0.0 && above + size[2] <= height + 1e-9) {
            let what = format!(
                "reaches from {above} to {} m, but the room from 0 to {height} m",
                above + size[2]
            );
            return Err(self.wrong(&field.key("size"), what, "make it lower, or the room higher"));
        }
        let turn = self.number(
            &field.key("turn"),
            raw.turn,
            0.0,
            [-3600.0, 3600.0],
            "give degrees",
        )?;
        let name = self.name_of(field);
        let seed = self.seed_of("furniture", &name);
        let mut random = generator(seed, "furniture", 0);
        let colours: &[u32] = if matches!(kind, FurnitureKind::Sofa | FurnitureKind::Screen) {
            &CLOTHS
        } else {
            &WOODS
        };
        let colour = linear(pick(&mut random, colours));
        let usual = Material {
            colour,
            second: darker(colour),
            pattern: match kind {
                FurnitureKind::Shelf => Pattern::Clutter,
                FurnitureKind::Cabinet => Pattern::Planks,
                FurnitureKind::Board => Pattern::Clutter,
                FurnitureKind::Sofa | FurnitureKind::Screen => Pattern::Clouds,
                _ => Pattern::Plain,
            },
            scale_m: if kind == FurnitureKind::Cabinet { 0.4 } else { 0.12 },
            seed,
        };
        let material = self.material(&field.key("material"), raw.material.as_ref(), usual)?;
        let part = Part {
            name: &name,
            at: [x, y],
            yaw_rad: turn.to_radians(),
            material,
        };
        part.build(kind, size, above, blocks);
        let seat_m = match kind {
            FurnitureKind::Chair => Some(0.5 * size[2]),
            FurnitureKind::Sofa => Some(0.52 * size[2]),
            _ => None,
        };
        Ok(Footprint {
            name,
            centre: Point2::new(x, y),
            half_m: [0.5 * size[0], 0.5 * size[1]],
            yaw_rad: turn.to_radians(),
            heights_m: [above, above + size[2]],
            seat_m,
        })
    }

    fn lights(
        &self,
        raw: &RawScene,
        [length, width, height]: [f64; 3],
        random: &mut Generator,
    ) -> Result<(Vec<Light>, LampChanges), ConfigurationError> {
        if raw.light.is_empty() {
            let mut lamp = |part: f64| Light {
                position: WorldPoint::new(
                    length * (part + between(random, -0.06, 0.06)),
                    width * between(random, 0.4, 0.6),
                    height - 0.08,
                ),
                colour: [1.5, 1.42, 1.3],
            };
            let mut lights = vec![lamp(0.3), lamp(0.7)];
            // Daylight falls in through a window in one of the long walls.
            let side = if between(random, 0.0, 1.0) < 0.5 {
                0.15
            } else {
                width - 0.15
            };
            lights.push(Light {
                position: WorldPoint::new(length * between(random, 0.25, 0.75), side, 0.62 * height),
                colour: [1.2, 1.28, 1.4],
            });
            return Ok((lights, vec![Vec::new(); 3]));
        }
        let (mut lights, mut changes) = (Vec::new(), Vec::new());
        for (number, light) in raw.light.iter().enumerate() {
            let field = Field::of("light").index(number);
            let Some(place) = light.at else {
                return Err(self.missing(&field, "at", "give its place, [x, y, z]"));
            };
            let strength = self.number(
                &field.key("strength"),
                light.strength,
                1.5,
                [0.0, 100.0],
                "give 0 to 100",
            )?;
            let colour: Colour = match &light.colour {
                Some(text) => self.colour(&field.key("colour"), text)?,
                None => [1.0; 3],
            };
            lights.push(Light {
                position: self.inside(&field.key("at"), place)?,
                colour: colour.map(|value| value * strength as f32),
            });
            let key = field.key("changes");
            changes.push(
                self.steps(
                    &key,
                    &light
                        .changes
                        .iter()
                        .map(|[at, factor]| (*at, *factor))
                        .collect::<Vec<_>>(),
                )?,
            );
        }
        Ok((lights, changes))
    }

    /// Values from times on, in order.
    pub(super) fn steps(
        &self,
        field: &Field,
        steps: &[(f64, f64)],
    ) -> Result<Vec<(f64, f64)>, ConfigurationError> {
        let mut last = f64::NEG_INFINITY;
        for (number, (time, value)) in steps.iter().enumerate() {
            if !(time.is_finite() && *time > last && value.is_finite() && *value >= 0.0) {
                let what = format!("{value} from {time} s on is not possible here");
                return Err(self.wrong(
                    &field.index(number),
                    what,
                    "write [seconds, factor] in order of time",
                ));
            }
            last = *time;
        }
        Ok(steps.to_vec())
    }
}

/// One piece of furniture that is being built of blocks.
struct Part<'a> {
    name: &'a str,
    at: [f64; 2],
    yaw_rad: f64,
    material: Material,
}

impl Part<'_> {
    fn build(
        &self,
        kind: FurnitureKind,
        [length, width, height]: [f64; 3],
        above: f64,
        blocks: &mut Vec<Block>,
    ) {
        let mut add = |part: &str, centre: [f64; 3], size_m: [f64; 3]| {
            let (sin, cos) = self.yaw_rad.sin_cos();
            let [x, y, z] = centre;
            blocks.push(Block {
                name: if part.is_empty() {
                    self.name.to_owned()
                } else {
                    format!("{}-{part}", self.name)
                },
                centre: WorldPoint::new(self.at[0] + cos * x - sin * y, self.at[1] + sin * x + cos * y, z),
                size_m,
                yaw_rad: self.yaw_rad,
                material: self.material,
            });
        };
        let legs = |thick: f64, high: f64| {
            let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
            corners.map(|(x, y)| {
                let place = [
                    x * 0.5 * (length - thick),
                    y * 0.5 * (width - thick),
                    above + 0.5 * high,
                ];
                (place, [thick, thick, high])
            })
        };
        const LEGS: [&str; 4] = ["leg1", "leg2", "leg3", "leg4"];
        match kind {
            FurnitureKind::Table => {
                add("top", [0.0, 0.0, above + height - 0.02], [length, width, 0.04]);
                for (name, (place, size)) in LEGS.into_iter().zip(legs(0.06, height - 0.04)) {
                    add(name, place, size);
                }
            }
            FurnitureKind::Chair => {
                let seat = 0.5 * height;
                add("seat", [0.0, 0.0, above + seat - 0.02], [length, width, 0.04]);
                add(
                    "back",
                    [-0.5 * length + 0.02, 0.0, above + 0.79 * height],
                    [0.03, width, 0.42 * height],
                );
                for (name, (place, size)) in LEGS.into_iter().zip(legs(0.04, seat - 0.04)) {
                    add(name, place, size);
                }
            }
            FurnitureKind::Sofa => {
                add(
                    "seat",
                    [0.08, 0.0, above + 0.26 * height],
                    [length - 0.16, width - 0.3, 0.52 * height],
                );
                add(
                    "back",
                    [-0.5 * length + 0.1, 0.0, above + 0.5 * height],
                    [0.2, width, height],
                );
                for (side, name) in [(1.0, "left"), (-1.0, "right")] {
                    let place = [0.0, side * 0.5 * (width - 0.16), above + 0.38 * height];
                    add(name, place, [length, 0.16, 0.76 * height]);
                }
            }
            _ => add("", [0.0, 0.0, above + 0.5 * height], [length, width, height]),
        }
    }
}

/// A surface of one colour.
pub(super) fn plain(colour: Colour, seed: u64) -> Material {
    Material {
        colour,
        second: darker(colour),
        pattern: Pattern::Plain,
        scale_m: 0.1,
        seed,
    }
}

pub(super) fn pick<T: Copy>(random: &mut Generator, list: &[T]) -> T {
    let place = (between(random, 0.0, list.len() as f64) as usize).min(list.len() - 1);
    list[place]
}

/// A colour that is neither pale nor dark.
pub(super) fn vivid(random: &mut Generator) -> Colour {
    let hue = between(random, 0.0, 6.0);
    let (light, dark) = (
        between(random, 0.25, 0.75) as f32,
        between(random, 0.02, 0.25) as f32,
    );
    let part = (hue.fract() as f32) * (light - dark) + dark;
    match hue as u32 {
        0 => [light, part, dark],
        1 => [light + dark - part, light, dark],
        2 => [dark, light, part],
        3 => [dark, light + dark - part, light],
        4 => [part, dark, light],
        _ => [light, dark, light + dark - part],
    }
}
