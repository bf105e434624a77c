//! Rows of 8-bit YUV to RGB and luma, in integers: the same bytes on every machine.
//!
//! With luma code Y, chroma codes U and V, the weights of red, green and blue in luma r, g, b, and everything rounded
//! to a 64th before it is added:
//!
//! ```text
//! full range:     y = Y,                  c = 1
//! limited range:  y = (Y - 16) 255/219,   c = 255/224
//! R = y + 2 (1 - r) c (V - 128)
//! G = y - 2 (1 - b) b/g c (U - 128) - 2 (1 - r) r/g c (V - 128)
//! B = y + 2 (1 - b) c (U - 128)
//! ```
//!
//! Each pixel takes the chroma sample that covers it, without interpolation.

/// Binary places of fixed-point values. With 6, sums of luma and chroma nearly fit into 16 bits, where they saturate
/// far outside of what a byte holds, and the error stays below a thirtieth of a step.
const PLACES: u32 = 6;
/// Chroma samples, each of two pixels, that are converted together.
const BLOCK: usize = 16;

/// Whose weights of red, green and blue make luma.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Primaries {
    /// ITU-R BT.601-7: r = 0.299, b = 0.114. What is not tagged is taken for this.
    #[default]
    Bt601,
    /// ITU-R BT.709-6: r = 0.2126, b = 0.0722.
    Bt709,
    /// ITU-R BT.2020-2: r = 0.2627, b = 0.0593.
    Bt2020,
}

/// YUV to RGB: for each code its contribution in fixed point.
#[derive(Clone, Debug)]
pub struct YuvMatrix {
    /// Luma code to full-range luma.
    luma: [u8; 256],
    /// Luma code to fixed point, rounding included.
    scaled: [i16; 256],
    red_from_v: [i16; 256],
    green_from_u: [i16; 256],
    green_from_v: [i16; 256],
    blue_from_u: [i16; 256],
}

impl Primaries {
    /// The weights r, g, b.
    pub const fn weights(self) -> [f64; 3] {
        let (red, blue) = match self {
            Self::Bt601 => (0.299, 0.114),
            Self::Bt709 => (0.2126, 0.0722),
            Self::Bt2020 => (0.2627, 0.0593),
        };
        [red, 1.0 - red - blue, blue]
    }
}

impl YuvMatrix {
    /// The conversion of codes in full range (0 to 255) or limited range (luma 16 to 235, chroma 16 to 240).
    pub fn new(primaries: Primaries, full: bool) -> Self {
        let [red, green, blue] = primaries.weights();
        let chroma = if full { 1.0 } else { 255.0 / 224.0 };
        let (black, gain) = if full { (0.0, 1.0) } else { (16.0, 255.0 / 219.0) };
        let fixed = |value: f64| (value * f64::from(1_u32 << PLACES)).round() as i16;
        let table = |gain: f64| std::array::from_fn(|code| fixed(gain * (code as f64 - 128.0)));
        let value = |code: usize| (code as f64 - black) * gain;
        Self {
            luma: std::array::from_fn(|code| value(code).round().clamp(0.0, 255.0) as u8),
            scaled: std::array::from_fn(|code| fixed(value(code)) + (1 << (PLACES - 1))),
            red_from_v: table(2.0 * (1.0 - red) * chroma),
            green_from_u: table(-2.0 * (1.0 - blue) * blue / green * chroma),
            green_from_v: table(-2.0 * (1.0 - red) * red / green * chroma),
            blue_from_u: table(2.0 * (1.0 - blue) * chroma),
        }
    }

    /// The full-range luma of a row of luma codes.
    pub fn luma_row(&self, codes: &[u8], luma: &mut [u8]) {
        for (luma, code) in luma.iter_mut().zip(codes) {
            *luma = self.luma[usize::from(*code)];
        }
    }

    #[inline(always)]
    fn chroma(&self, u: u8, v: u8) -> [i16; 3] {
        let (u, v) = (usize::from(u), usize::from(v));
        [
            self.red_from_v[v],
            self.green_from_u[u].saturating_add(self.green_from_v[v]),
            self.blue_from_u[u],
        ]
    }

    #[inline(always)]
    fn write(&self, code: u8, chroma: [i16; 3], pixel: &mut [u8]) {
        let luma = self.scaled[usize::from(code)];
        for (channel, chroma) in pixel.iter_mut().zip(chroma) {
            *channel = (luma.saturating_add(chroma) >> PLACES).clamp(0, 255) as u8;
        }
    }

    /// A row whose chroma has half the width, rounded up, to interleaved R, G, B.
    ///
    /// # Panics
    /// Where `u`, `v` or `rgb` is shorter than the row needs.
    pub fn row_of_pairs(&self, codes: &[u8], u: &[u8], v: &[u8], rgb: &mut [u8]) {
        let blocks = codes.len() / (2 * BLOCK);
        let parts = codes
            .chunks_exact(2 * BLOCK)
            .zip(u.chunks_exact(BLOCK).zip(v.chunks_exact(BLOCK)));
        for ((codes, (u, v)), rgb) in parts.zip(rgb.chunks_exact_mut(6 * BLOCK)) {
            self.block(codes, u, v, rgb);
        }
        let done = blocks * BLOCK;
        self.row(
            &codes[2 * done..],
            &u[done..],
            &v[done..],
            1,
            &mut rgb[6 * done..],
        );
    }

    /// A block of pixels in steps that the compiler turns into vector instructions: look up, add, store.
    #[inline(always)]
    fn block(&self, codes: &[u8], u: &[u8], v: &[u8], rgb: &mut [u8]) {
        let mut luma = [0_i16; 2 * BLOCK];
        let mut chroma = [[0_i16; 2 * BLOCK]; 3];
        for (luma, code) in luma.iter_mut().zip(codes) {
            *luma = self.scaled[usize::from(*code)];
        }
        for (index, (u, v)) in u.iter().zip(v).enumerate().take(BLOCK) {
            for (row, value) in chroma.iter_mut().zip(self.chroma(*u, *v)) {
                row[2 * index] = value;
                row[2 * index + 1] = value;
            }
        }
        let mut pixels = [0_u32; 2 * BLOCK];
        for (index, pixel) in pixels.iter_mut().enumerate() {
            let byte = |channel: usize| {
                (luma[index].saturating_add(chroma[channel][index]) >> PLACES).clamp(0, 255) as u32
            };
            *pixel = byte(0) | byte(1) << 8 | byte(2) << 16;
        }
        for (bytes, pixel) in rgb.chunks_exact_mut(3).zip(pixels) {
            let [red, green, blue, _] = pixel.to_le_bytes();
            (bytes[0], bytes[1], bytes[2]) = (red, green, blue);
        }
    }

    /// A row each of whose chroma samples serves 2^`across` pixels, to interleaved R, G, B.
    ///
    /// # Panics
    /// Where `u` or `v` is shorter than the row needs.
    pub fn row(&self, codes: &[u8], u: &[u8], v: &[u8], across: usize, rgb: &mut [u8]) {
        for (x, (code, pixel)) in codes.iter().zip(rgb.chunks_exact_mut(3)).enumerate() {
            self.write(*code, self.chroma(u[x >> across], v[x >> across]), pixel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_and_single_pixels_agree_with_the_equations() {
        for (primaries, full) in [
            (Primaries::Bt601, true),
            (Primaries::Bt709, false),
            (Primaries::Bt2020, true),
        ] {
            let matrix = YuvMatrix::new(primaries, full);
            let code = |place: usize| (place * 37 % 256) as u8;
            let codes: Vec<u8> = (0..71).map(code).collect();
            let u: Vec<u8> = (0..36).map(|place| code(place + 5)).collect();
            let v: Vec<u8> = (0..36).map(|place| code(place + 11)).collect();
            let (mut pairs, mut single) = (vec![0; 213], vec![0; 213]);
            matrix.row_of_pairs(&codes, &u, &v, &mut pairs);
            matrix.row(&codes, &u, &v, 1, &mut single);
            assert_eq!(pairs, single);
            let [r, g, b] = primaries.weights();
            let (black, gain, c) = if full {
                (0.0, 1.0, 1.0)
            } else {
                (16.0, 255.0 / 219.0, 255.0 / 224.0)
            };
            for x in 0..71 {
                let y = (f64::from(codes[x]) - black) * gain;
                let (u, v) = (
                    c * (f64::from(u[x / 2]) - 128.0),
                    c * (f64::from(v[x / 2]) - 128.0),
                );
                let expected = [
                    y + 2.0 * (1.0 - r) * v,
                    y - 2.0 * (1.0 - b) * b / g * u - 2.0 * (1.0 - r) * r / g * v,
                    y + 2.0 * (1.0 - b) * u,
                ];
                for channel in 0..3 {
                    let difference = f64::from(pairs[3 * x + channel]) - expected[channel].clamp(0.0, 255.0);
                    assert!(difference.abs() < 0.54, "{x} {channel}: {difference}");
                }
            }
        }
    }
}
