//! The face: what distinguishes one from others, its relief, and its paint.
//!
//! Places on the face are metres to the person's left (y) and up (z) of the middle of the head, seen from in front.

use super::hash::{smooth, trait_of, unit};
use super::head::{Place, hair, smooth_step, table};
use super::pattern::blend;
use super::texture::Texture;
use crate::world::{Colour, Looks};
use nalgebra::Vector2;

/// Texels of a head's texture around and down.
pub(super) const WIDTH: usize = 256;
pub(super) const HEIGHT: usize = 192;
/// Part of the texture that eyes and mouth are in: columns and rows from and to.
const LIVELY: [[usize; 2]; 2] = [[88, 76], [168, 152]];
/// Steps of mouth and lids that are told apart.
const STEPS: f64 = 32.0;

/// Proportions of one face.
#[derive(Clone, Debug)]
pub(super) struct Features {
    seed: u64,
    /// Half the distance between the eyes, height of eyes, brows, root of the nose, and mouth, metres.
    eye: Vector2<f32>,
    brow_m: f32,
    nose_m: f32,
    mouth_m: f32,
    /// Half widths of an eye and of the mouth, thickness of a brow, metres.
    eye_width_m: f32,
    mouth_width_m: f32,
    brow_thickness_m: f32,
    /// How far the nose stands out, and half its width at the wings, metres.
    nose_out_m: f32,
    nose_width_m: f32,
    /// Breadth of the jaw over the usual one, less 1.
    pub(super) jaw: f32,
    /// How much higher the hair begins than usual, over the head's half height.
    pub(super) hairline: f32,
    /// Thickness of the hair, metres.
    pub(super) hair_m: f32,
    redness: f32,
}

/// How open mouth and eyes are, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mien {
    mouth: u8,
    lids: u8,
}

impl Mien {
    pub(super) fn of(mouth_opening: f64, blink: f64) -> Self {
        // Numbers that are none become 0.
        let step = |value: f64| (value.clamp(0.0, 1.0) * STEPS).round() as u8;
        Self {
            mouth: step(mouth_opening),
            lids: step(blink),
        }
    }

    pub(super) fn mouth(self) -> f32 {
        f32::from(self.mouth) / STEPS as f32
    }

    fn lids(self) -> f32 {
        f32::from(self.lids) / STEPS as f32
    }
}

impl Features {
    pub(super) fn of(looks: &Looks) -> Self {
        let half = looks.head_half_axes_m.map(|half| half as f32);
        let own = |which: u64| trait_of(looks.seed, which);
        let [_, side, up] = half;
        let eye_height = up * (0.03 + 0.02 * own(1));
        Self {
            seed: looks.seed,
            eye: Vector2::new(side * (0.405 + 0.025 * own(0)), eye_height),
            brow_m: eye_height + up * (0.165 + 0.015 * own(2)),
            nose_m: up * (-0.33 + 0.02 * own(3)),
            mouth_m: up * (-0.535 + 0.015 * own(4)),
            eye_width_m: side * (0.185 + 0.012 * own(5)),
            mouth_width_m: side * (0.33 + 0.04 * own(6)),
            brow_thickness_m: up * (0.042 + 0.01 * own(7)),
            nose_out_m: half[0] * (0.21 + 0.03 * own(8)),
            nose_width_m: side * (0.215 + 0.03 * own(9)),
            jaw: 0.08 * own(10),
            hairline: 0.05 * own(11),
            hair_m: 0.012 + 0.005 * own(12),
            redness: 0.5 + 0.5 * own(13),
        }
    }

    /// How far the face stands out of the egg, metres.
    pub(super) fn relief_m(&self, y: f32, z: f32, half: [f32; 3]) -> f32 {
        let [deep, side, up] = half;
        let hill = |y0: f32, z0: f32, wide: f32, high: f32| {
            (-((y.abs() - y0) / wide).powi(2) - ((z - z0) / high).powi(2)).exp()
        };
        // The bridge rises from between the eyes to the tip and falls steeply to the lip.
        let bridge = [
            (self.nose_m - 0.05 * up, 0.0),
            (self.nose_m, 0.55),
            (self.nose_m + 0.06 * up, 1.0),
            (self.nose_m + 0.16 * up, 0.72),
            (self.eye.y - 0.04 * up, 0.22),
            (self.eye.y + 0.12 * up, 0.0),
        ];
        let wide = table(
            &[
                (self.nose_m, 0.72 * self.nose_width_m),
                (self.nose_m + 0.12 * up, 0.6 * self.nose_width_m),
                (self.eye.y, 0.42 * self.nose_width_m),
            ],
            z,
        );
        let nose = self.nose_out_m * table(&bridge, z).max(0.0) * (-(y / wide).powi(2)).exp();
        let wings = 0.045
            * deep
            * hill(
                0.8 * self.nose_width_m,
                self.nose_m + 0.03 * up,
                0.07 * side,
                0.05 * up,
            );
        let sockets = -0.075 * deep * hill(0.9 * self.eye.x, self.eye.y + 0.03 * up, 0.23 * side, 0.1 * up);
        let brows = 0.035 * deep * hill(0.9 * self.eye.x, self.brow_m, 0.3 * side, 0.06 * up);
        let cheeks = 0.03 * deep * hill(0.5 * side, self.nose_m + 0.08 * up, 0.2 * side, 0.15 * up);
        let lips = 0.035
            * deep
            * (hill(0.0, self.mouth_m + 0.035 * up, 0.26 * side, 0.03 * up)
                + 1.1 * hill(0.0, self.mouth_m - 0.045 * up, 0.22 * side, 0.035 * up));
        let chin = 0.03 * deep * hill(0.0, -0.8 * up, 0.2 * side, 0.1 * up);
        nose + wings + sockets + brows + cheeks + lips + chin
    }
}

/// The texture of a head with closed mouth and open eyes.
pub(super) fn texture(looks: &Looks, features: &Features) -> Texture {
    Texture::painted(WIDTH, HEIGHT, |column, row| {
        texel(looks, features, Mien::default(), column, row)
    })
}

/// Paints eyes and mouth anew.
pub(super) fn enliven(texture: &mut Texture, looks: &Looks, features: &Features, mien: Mien) {
    texture.repaint(LIVELY[0], LIVELY[1], |column, row| {
        texel(looks, features, mien, column, row)
    });
}

fn texel(looks: &Looks, features: &Features, mien: Mien, column: usize, row: usize) -> Colour {
    let place = Place::at(
        (column as f32 + 0.5) / WIDTH as f32,
        (row as f32 + 0.5) / HEIGHT as f32,
    );
    let [forward, left, height] = place.on_egg(features);
    let half = looks.head_half_axes_m.map(|half| half as f32);
    let (y, z) = (left * half[1], height * half[2]);
    let grain = smooth(features.seed, 40.0 * place.turn, 30.0 * height);
    let mut colour = looks.skin.map(|channel| channel * (0.97 + 0.06 * grain));
    if forward > 0.0 {
        colour = match &looks.face {
            Some(photograph) => {
                let edge = smooth_step((80.0 - place.turn.abs().to_degrees()) / 15.0);
                let (width, height_px, bytes) = &**photograph;
                let seen = photographed(*width, *height_px, bytes, left, height);
                let own = seen.map_or(colour, |seen| blend(colour, seen, edge));
                mouth(looks, features, mien, y, z, half, own, true)
            }
            None => face(looks, features, mien, y, z, half, colour),
        };
    }
    let strand = 0.75 + 0.5 * smooth(features.seed ^ 7, 60.0 * place.turn, 6.0 * height);
    blend(
        colour,
        looks.hair.map(|channel| channel * strand),
        hair(looks, features, place),
    )
}

/// A photograph that shows the face from ear to ear and from the hairline (0.75 of the half height) to the chin.
fn photographed(width: usize, height_px: usize, bytes: &[u8], left: f32, height: f32) -> Option<Colour> {
    if width == 0 || height_px == 0 || bytes.len() < width.checked_mul(height_px)?.checked_mul(3)? {
        return None;
    }
    // Who faces the camera has their left at its right.
    let across = (0.5 + 0.5 * left / 0.98).clamp(0.0, 1.0) * (width - 1) as f32;
    let down = ((0.75 - height) / 1.75).clamp(0.0, 1.0) * (height_px - 1) as f32;
    let (column, row) = (across as usize, down as usize);
    let (dx, dy) = (across - column as f32, down - row as f32);
    let at = |column: usize, row: usize| {
        let at = 3 * (row.min(height_px - 1) * width + column.min(width - 1));
        [0, 1, 2].map(|channel| linear(bytes[at + channel]))
    };
    let upper = blend(at(column, row), at(column + 1, row), dx);
    let lower = blend(at(column, row + 1), at(column + 1, row + 1), dx);
    Some(blend(upper, lower, dy))
}

/// Linear light of an sRGB code (IEC 61966-2-1).
fn linear(code: u8) -> f32 {
    let value = f32::from(code) / 255.0;
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

fn face(
    looks: &Looks,
    features: &Features,
    mien: Mien,
    y: f32,
    z: f32,
    half: [f32; 3],
    skin: Colour,
) -> Colour {
    let [_, side, up] = half;
    let bump = |y0: f32, z0: f32, wide: f32, high: f32| {
        (-((y.abs() - y0) / wide).powi(2) - ((z - z0) / high).powi(2)).exp()
    };
    let mut colour = skin;
    // Cheeks are redder, orbits darker, the bridge of the nose and the cheekbones lighter.
    let rosy =
        0.5 * features.redness * bump(0.52 * side, features.nose_m + 0.05 * up, 0.22 * side, 0.16 * up);
    colour = [
        colour[0],
        colour[1] * (1.0 - 0.3 * rosy),
        colour[2] * (1.0 - 0.3 * rosy),
    ];
    let orbit = bump(
        0.95 * features.eye.x,
        features.eye.y + 0.035 * up,
        0.25 * side,
        0.105 * up,
    );
    let inner = bump(
        0.5 * features.eye.x,
        features.eye.y + 0.03 * up,
        0.1 * side,
        0.09 * up,
    );
    let flank = bump(
        0.75 * features.nose_width_m,
        features.nose_m + 0.1 * up,
        0.07 * side,
        0.16 * up,
    );
    let below = bump(0.0, features.nose_m - 0.045 * up, 0.2 * side, 0.035 * up);
    let dark = (1.0 - 0.42 * orbit) * (1.0 - 0.25 * inner) * (1.0 - 0.2 * flank) * (1.0 - 0.3 * below);
    let ridge = bump(0.0, features.nose_m + 0.16 * up, 0.07 * side, 0.2 * up);
    let bones = bump(0.5 * side, features.nose_m + 0.16 * up, 0.16 * side, 0.07 * up);
    let light = 1.0 + 0.16 * ridge + 0.12 * bones;
    colour = colour.map(|channel| (channel * dark * light).min(1.0));
    // Nostrils.
    let nostril = bump(
        0.5 * features.nose_width_m,
        features.nose_m - 0.02 * up,
        0.06 * side,
        0.018 * up,
    );
    colour = blend(colour, skin.map(|channel| 0.15 * channel), 0.85 * nostril);
    colour = brow(looks, features, y, z, colour);
    colour = eye(looks, features, mien, y, z, colour);
    mouth(looks, features, mien, y, z, half, colour, false)
}

fn brow(looks: &Looks, features: &Features, y: f32, z: f32, colour: Colour) -> Colour {
    let along = (y.abs() - features.eye.x) / (1.45 * features.eye_width_m);
    let arc = features.brow_m + 0.25 * features.brow_thickness_m * (1.0 - 2.0 * along * along);
    let thick = features.brow_thickness_m * (0.62 - 0.25 * along);
    let cover = smooth_step(1.6 - 1.6 * ((z - arc) / thick).abs()) * smooth_step(4.0 - 4.0 * along.abs());
    // Brows are darker than the hair, and darker than the skin.
    let own = [0, 1, 2].map(|channel| (0.5 * looks.hair[channel]).min(0.35 * looks.skin[channel]));
    blend(colour, own, 0.85 * cover)
}

fn eye(looks: &Looks, features: &Features, mien: Mien, y: f32, z: f32, colour: Colour) -> Colour {
    let (dx, dz) = (y.abs() - features.eye.x, z - features.eye.y);
    let along = dx / features.eye_width_m;
    if along.abs() > 1.3 {
        return colour;
    }
    let bow = (1.0 - along * along).max(0.0);
    let open = 1.0 - mien.lids();
    let top = 0.40 * features.eye_width_m * bow * open - 0.2 * features.eye_width_m * (1.0 - open);
    let bottom = -0.30 * features.eye_width_m * bow;
    let soft = 0.12 * features.eye_width_m;
    let inside = smooth_step((top - dz) / soft + 0.5) * smooth_step((dz - bottom) / soft + 0.5);
    let radius = dx.hypot(dz) / (0.5 * features.eye_width_m);
    let white = [0.62, 0.58, 0.55];
    let ring = blend(
        looks.eyes.map(|channel| 0.7 * channel),
        [0.01; 3],
        smooth_step((0.52 - radius) / 0.08),
    );
    let ball = blend(white, ring, smooth_step((1.05 - radius) / 0.1));
    let ball = ball
        .map(|channel| channel * (1.0 - 0.45 * smooth_step(1.0 - (top - dz) / (0.3 * features.eye_width_m))));
    let mut colour = blend(colour, ball, if bow > 0.0 { inside } else { 0.0 });
    // Lashes on the upper lid, a line below, a fold above.
    let line = |height: f32, thick: f32| smooth_step(1.5 - 1.5 * ((dz - height) / thick).abs());
    let ends = smooth_step(5.0 - 4.6 * along.abs());
    let dark = looks.skin.map(|channel| 0.12 * channel);
    colour = blend(
        colour,
        dark,
        0.9 * ends * line(top + 0.3 * soft, 0.13 * features.eye_width_m),
    );
    colour = blend(
        colour,
        dark,
        0.45 * ends * line(bottom, 0.08 * features.eye_width_m),
    );
    blend(
        colour,
        dark,
        0.35 * ends
            * line(
                0.62 * features.eye_width_m * bow.max(0.3),
                0.08 * features.eye_width_m,
            ),
    )
}

fn mouth(
    looks: &Looks,
    features: &Features,
    mien: Mien,
    y: f32,
    z: f32,
    half: [f32; 3],
    colour: Colour,
    photographed: bool,
) -> Colour {
    let up = half[2];
    let opening = mien.mouth();
    if photographed && opening == 0.0 {
        return colour;
    }
    let along = y / (features.mouth_width_m * (1.0 - 0.12 * opening));
    let dz = z - features.mouth_m;
    let bow = (1.0 - along * along).max(0.0);
    // The lower lip sinks with the jaw.
    let sunk = 0.17 * up * opening * bow.sqrt();
    let lip = [0.72, 0.42, 0.4].map(|factor: f32| factor);
    let lip = [0, 1, 2].map(|channel| lip[channel] * looks.skin[channel] * 0.95);
    let cupid = 1.0 - 0.25 * (-(along / 0.18).powi(2)).exp();
    let upper =
        smooth_step((0.075 * up * bow * cupid - dz) / (0.015 * up)) * smooth_step(dz / (0.01 * up) + 1.0);
    let lower = smooth_step((dz + sunk + 0.095 * up * bow) / (0.02 * up))
        * smooth_step(-(dz + sunk) / (0.01 * up) + 1.0);
    let within = if bow > 0.0 { 1.0 } else { 0.0 };
    let mut colour = if photographed {
        colour
    } else {
        let colour = blend(colour, lip.map(|channel| 0.8 * channel), 0.8 * within * upper);
        blend(colour, lip, 0.75 * within * lower)
    };
    // The shadow under the lower lip, the line between the lips, and what is seen between them.
    let shadow = (-(y / (0.7 * features.mouth_width_m)).powi(2)
        - ((dz + 0.15 * up + sunk) / (0.035 * up)).powi(2))
    .exp();
    if !photographed {
        colour = colour.map(|channel| channel * (1.0 - 0.28 * shadow));
    }
    let hollow = looks.skin.map(|channel| 0.06 * channel);
    let seam = smooth_step(1.5 - 1.5 * ((dz + 0.5 * sunk) / (0.014 * up + 0.5 * sunk)).abs());
    let corners = smooth_step(6.0 - 5.6 * along.abs());
    let teeth = smooth_step((dz + 0.35 * sunk) / (0.01 * up)) * smooth_step((opening - 0.15) / 0.2) * bow;
    let between = blend(hollow, [0.55, 0.52, 0.46], 0.7 * teeth);
    blend(colour, between, 0.9 * corners * seam)
}

/// The colour of skin that is not on the face.
pub(super) fn plain_skin(looks: &Looks) -> Colour {
    looks.skin.map(|channel| 0.95 * channel)
}

/// The colour of shoes: dark, a little different for everyone.
pub(super) fn shoe(looks: &Looks) -> Colour {
    let number = super::hash::mix(looks.seed ^ 0x5_140E);
    [0, 1, 2].map(|which| 0.02 + 0.08 * unit(number, which))
}
