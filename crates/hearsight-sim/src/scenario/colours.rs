//! Colours as people write them, to light.

use super::raw::{RawMaterial, RawMaterialTable};
use super::resolve::Resolver;
use crate::world::{Colour, Material, Pattern};
use hearsight_core::configuration::{ConfigurationError, Field};

/// Names of colours, as in CSS where it has them.
const NAMED: [(&str, u32); 24] = [
    ("white", 0xf4f4f0),
    ("black", 0x161616),
    ("grey", 0x8c8c8c),
    ("light-grey", 0xc4c4c2),
    ("dark-grey", 0x4a4a4c),
    ("red", 0xb02a2e),
    ("green", 0x2f7a45),
    ("blue", 0x2b4f9e),
    ("yellow", 0xd9b830),
    ("orange", 0xd0702a),
    ("purple", 0x6b3f86),
    ("pink", 0xd58aa0),
    ("brown", 0x6a4630),
    ("beige", 0xd8c6a8),
    ("navy", 0x1f2a4c),
    ("teal", 0x2a7a7c),
    ("olive", 0x6c6e38),
    ("wine", 0x6a2236),
    ("cream", 0xeee4cc),
    ("oak", 0xb48c5c),
    ("walnut", 0x6b4a34),
    ("beech", 0xcda87a),
    ("skin", 0xe0ac8c),
    ("blond", 0xc9a468),
];

/// Light that a colour of sRGB reflects (IEC 61966-2-1).
pub(super) fn linear(code: u32) -> Colour {
    [16, 8, 0].map(|shift| {
        let value = ((code >> shift) & 0xff) as f32 / 255.0;
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// A darker shade.
pub(super) fn darker(colour: Colour) -> Colour {
    colour.map(|value| value * 0.45)
}

impl Resolver {
    /// A colour: `#rrggbb` or a name.
    pub(super) fn colour(&self, field: &Field, text: &str) -> Result<Colour, ConfigurationError> {
        if let Some(digits) = text.strip_prefix('#') {
            if digits.len() == 6
                && let Ok(code) = u32::from_str_radix(digits, 16)
            {
                return Ok(linear(code));
            }
            let what = format!("`{text}` is no colour");
            return Err(self.wrong(field, what, "write six hexadecimal digits, such as #b02a2e"));
        }
        if let Some((_, code)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(linear(*code));
        }
        let known: Vec<&str> = NAMED.iter().map(|(name, _)| *name).collect();
        let cure = format!("{} or write #rrggbb", Self::did_you_mean(text, &known));
        Err(self.wrong(field, format!("there is no colour `{text}`"), cure))
    }

    /// A material; what is not said is as in `usual`.
    pub(super) fn material(
        &self,
        field: &Field,
        raw: Option<&RawMaterial>,
        usual: Material,
    ) -> Result<Material, ConfigurationError> {
        match raw {
            None => Ok(usual),
            Some(RawMaterial::Colour(text)) => {
                let colour = self.colour(field, text)?;
                Ok(Material {
                    colour,
                    second: darker(colour),
                    pattern: Pattern::Plain,
                    ..usual
                })
            }
            Some(RawMaterial::Full(table)) => self.material_of(field, table, usual),
        }
    }

    fn material_of(
        &self,
        field: &Field,
        table: &RawMaterialTable,
        usual: Material,
    ) -> Result<Material, ConfigurationError> {
        let colour = match &table.colour {
            Some(text) => self.colour(&field.key("colour"), text)?,
            None => usual.colour,
        };
        let second = match &table.second {
            Some(text) => self.colour(&field.key("second"), text)?,
            None if table.colour.is_some() => darker(colour),
            None => usual.second,
        };
        let scale = self.number(
            &field.key("scale"),
            table.scale,
            f64::from(usual.scale_m),
            [0.005, 20.0],
            "give metres, such as 0.1",
        )?;
        let pattern = table.pattern.unwrap_or(if table.colour.is_some() {
            Pattern::Plain
        } else {
            usual.pattern
        });
        Ok(Material {
            colour,
            second,
            pattern,
            scale_m: scale as f32,
            seed: usual.seed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_light_and_black_is_not() {
        assert!(linear(0xffffff).iter().all(|value| (value - 1.0).abs() < 1e-6));
        assert_eq!(linear(0), [0.0; 3]);
        // Half of the code is a fifth of the light.
        assert!((linear(0x808080)[0] - 0.2158).abs() < 1e-3);
    }
}
