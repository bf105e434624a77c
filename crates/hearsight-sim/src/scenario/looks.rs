//! How people look and sound, as far as it is not said: drawn from a seed of their own.

use super::colours::{darker, linear};
use super::raw::{RawPerson, RawVoice};
use super::resolve::Resolver;
use super::surroundings::{pick, vivid};
use crate::acoustics::random::{Generator, between, generator, normal};
use crate::voice::TalkerKind;
use crate::world::{Colour, Hair, Looks, Material, Pattern, VoiceSpec, Wear};
use hearsight_core::configuration::{ConfigurationError, Field};
use rand::Rng;

/// Who is lower has a child's voice, metres.
const CHILD_M: f64 = 1.45;

/// From light to dark.
const SKINS: [u32; 8] = [
    0xf2d3bd, 0xecc3a6, 0xe3b391, 0xd6a07c, 0xc08a64, 0xa06d4a, 0x7d5136, 0x5a3a28,
];
const HAIRS: [u32; 8] = [
    0x1c1715, 0x2e231d, 0x4a3325, 0x6b4a30, 0x8c6a42, 0xb8935a, 0x7c7670, 0x8e4a2a,
];
const EYES: [u32; 4] = [0x4a3020, 0x5b6a48, 0x4a6a88, 0x2c2018];
const TROUSERS: [u32; 7] = [
    0x24304a, 0x2b2b2e, 0x55565c, 0x5c4a38, 0x3a4638, 0x8a7c64, 0x1c2430,
];

impl Resolver {
    pub(super) fn looks(
        &self,
        field: &Field,
        raw: &RawPerson,
        seed: u64,
    ) -> Result<Looks, ConfigurationError> {
        let mut random = generator(seed, "looks", 0);
        let colour = |key: &str, text: &Option<String>, drawn: Colour| match text {
            Some(text) => self.colour(&field.key(key), text),
            None => Ok(drawn),
        };
        let drawn_height = (1.73 + 0.085 * normal(&mut random)).clamp(1.55, 1.92);
        let height_m = self.number(
            &field.key("height"),
            raw.height,
            drawn_height,
            [0.8, 2.2],
            "give 0.8 to 2.2 metres",
        )?;
        if height_m >= self.size_m[2] {
            let what = format!(
                "{height_m:.2} m does not fit under a ceiling at {} m",
                self.size_m[2]
            );
            return Err(self.wrong(
                &field.key("height"),
                what,
                "make the room higher, or the person smaller",
            ));
        }
        let drawn_build = (1.0 + 0.12 * normal(&mut random)).clamp(0.82, 1.25);
        let build = self.number(
            &field.key("build"),
            raw.build,
            drawn_build,
            [0.7, 1.5],
            "1 is usual",
        )?;
        // Heads grow much less than bodies.
        let size = (height_m / 1.73).powf(0.3);
        let mut axis = |usual: f64| usual * size * (1.0 + (0.035 * normal(&mut random)).clamp(-0.07, 0.07));
        let head_half_axes_m = [axis(0.098), axis(0.077), axis(0.118)];
        let tone = between(&mut random, 0.0, 1.0);
        // Light and middle tones are as frequent as dark ones.
        let skin = SKINS[((tone * SKINS.len() as f64) as usize).min(SKINS.len() - 1)];
        let hairs = if tone > 0.6 { &HAIRS[..3] } else { &HAIRS[..] };
        let drawn_hair = linear(pick(&mut random, hairs));
        let chance = between(&mut random, 0.0, 1.0);
        let drawn_style = if chance < 0.07 {
            Hair::Bald
        } else if chance < 0.6 {
            Hair::Short
        } else {
            Hair::Long
        };
        let top = cloth(&mut random);
        let bottom_colour = linear(pick(&mut random, &TROUSERS));
        let bottom = Material {
            colour: bottom_colour,
            second: darker(bottom_colour),
            pattern: Pattern::Plain,
            scale_m: 0.05,
            seed: random.next_u64(),
        };
        let long_sleeves = between(&mut random, 0.0, 1.0) < 0.65;
        Ok(Looks {
            height_m,
            build,
            head_half_axes_m,
            skin: colour("skin", &raw.skin, linear(skin))?,
            hair: colour("hair", &raw.hair, drawn_hair)?,
            hair_style: raw.hair_style.unwrap_or(drawn_style),
            eyes: colour("eyes", &raw.eyes, linear(pick(&mut random, &EYES)))?,
            wear: Wear {
                top: self.material(&field.key("top"), raw.top.as_ref(), top)?,
                bottom: self.material(&field.key("bottom"), raw.bottom.as_ref(), bottom)?,
                long_sleeves: raw.long_sleeves.unwrap_or(long_sleeves),
            },
            face: match &raw.face {
                Some(path) => Some(self.photograph(&field.key("face"), path)?),
                None => None,
            },
            seed,
        })
    }

    fn photograph(
        &self,
        field: &Field,
        path: &str,
    ) -> Result<std::sync::Arc<(usize, usize, Vec<u8>)>, ConfigurationError> {
        let path = self.existing(field, path)?;
        let picture = image::open(&path).map_err(|error| {
            let what = format!("{} cannot be read: {error}", path.display());
            self.wrong(field, what, "give a PNG or JPEG picture")
        })?;
        let picture = picture.into_rgb8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        Ok(std::sync::Arc::new((width, height, picture.into_raw())))
    }

    pub(super) fn voice(
        &self,
        field: &Field,
        raw: &RawVoice,
        height_m: f64,
        seed: u64,
    ) -> Result<VoiceSpec, ConfigurationError> {
        let drawn = if height_m < CHILD_M {
            TalkerKind::Child
        } else if seed.count_ones().is_multiple_of(2) {
            TalkerKind::Man
        } else {
            TalkerKind::Woman
        };
        let recording = match &raw.recording {
            Some(path) => Some(self.existing(&field.key("recording"), path)?),
            None => None,
        };
        Ok(VoiceSpec {
            level_db: self.number(
                &field.key("level"),
                raw.level,
                -30.0,
                [-100.0, 0.0],
                "give decibels relative to full scale, at one metre",
            )?,
            kind: raw.kind.unwrap_or(drawn),
            recording,
            seed,
        })
    }
}

/// Shirts and pullovers.
fn cloth(random: &mut Generator) -> Material {
    let colour = if between(random, 0.0, 1.0) < 0.25 {
        let grey = between(random, 0.03, 0.8) as f32;
        [grey, grey, grey * 0.97]
    } else {
        vivid(random)
    };
    let chance = between(random, 0.0, 1.0);
    Material {
        colour,
        second: if between(random, 0.0, 1.0) < 0.5 {
            darker(colour)
        } else {
            [0.75, 0.74, 0.7]
        },
        pattern: if chance < 0.6 {
            Pattern::Plain
        } else if chance < 0.8 {
            Pattern::Stripes
        } else if chance < 0.92 {
            Pattern::Squares
        } else {
            Pattern::Clouds
        },
        scale_m: between(random, 0.03, 0.12) as f32,
        seed: random.next_u64(),
    }
}
