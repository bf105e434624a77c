//! Furniture and occluders: pieces of each kind, built of blocks.

use super::colours::{darker, linear};
use super::raw::{FurnitureKind, RawFurniture};
use super::resolve::Resolver;
use super::surroundings::{Footprint, WOODS, pick};
use crate::acoustics::random::generator;
use crate::world::{Block, Material, Pattern};
use hearsight_core::WorldPoint;
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::Point2;

const CLOTHS: [u32; 6] = [0x5a6478, 0x7a4a44, 0x4e6a58, 0x8c8474, 0x3c4250, 0xa08c6c];

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
    pub(super) fn furniture(
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
