//! The room: its surfaces and lights, and what a scenario must know of all that stands in it.

use super::colours::{darker, linear};
use super::raw::RawScene;
use super::resolve::Resolver;
use crate::acoustics::random::{Generator, between, generator};
use crate::world::{Colour, LampChanges, Light, Material, Pattern, Setting};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::{Point2, Vector2};

/// Paints of walls, and of floors.
const WALLS: [u32; 7] = [
    0xe6e2d8, 0xd9dde0, 0xdcd6c4, 0xcfd8d0, 0xe0d2c8, 0xc9ced6, 0xebe7df,
];

const FLOORS: [u32; 6] = [0x8d7355, 0x6e6a66, 0xa08a6a, 0x75665a, 0x9a9690, 0x5c6670];

/// Wood and what else furniture is made of; skin-like woods are meant.
pub(super) const WOODS: [u32; 6] = [0xb48c5c, 0x8a6242, 0xcda87a, 0x6b4a34, 0xc49a74, 0xe2d8c8];

/// How far outside its wall somebody is who has left, metres.
pub(super) const OUTSIDE_M: f64 = 0.45;

/// How far inside a door people walk to before they leave, metres.
pub(super) const THRESHOLD_M: f64 = 0.55;

/// How deep something may be set into furniture, metres, as a camera into a screen.
const SET_IN_M: f64 = 0.05;

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

    /// Whether a place is inside, and not merely set into its surface.
    pub(super) fn swallows(&self, place: WorldPoint) -> bool {
        let coords = place.0.coords;
        let (sin, cos) = self.yaw_rad.sin_cos();
        let off = coords.xy() - self.centre.coords;
        let own = [off.x * cos + off.y * sin, off.y * cos - off.x * sin];
        let [from_m, to_m] = self.heights_m;
        let flat = [0, 1]
            .iter()
            .all(|axis| own[*axis].abs() < self.half_m[*axis] - SET_IN_M);
        flat && coords.z > from_m + SET_IN_M && coords.z < to_m - SET_IN_M
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

    pub(super) fn lights(
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
            // Daylight from one of the long sides; at the wall itself it would burn a hole into the picture.
            let inset = (0.25 * width).min(1.3);
            let side = if between(random, 0.0, 1.0) < 0.5 {
                inset
            } else {
                width - inset
            };
            lights.push(Light {
                position: WorldPoint::new(length * between(random, 0.25, 0.75), side, height - 0.08),
                colour: [0.9, 0.97, 1.05],
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
