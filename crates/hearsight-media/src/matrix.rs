//! Rows of 8-bit YUV to RGB and luma, in integers.

use ffmpeg_next::color;

/// Binary places of fixed-point values. With 6, sums of luma and chroma nearly fit into 16 bits, where they saturate
/// far outside of what a byte holds, and the error stays below a thirtieth of a step.
const PLACES: u32 = 6;
/// Chroma samples, each of two pixels, that are converted together.
const BLOCK: usize = 16;

/// YUV to RGB: for each code its contribution in fixed point.
#[derive(Clone)]
pub(crate) struct Matrix {
    /// Luma code to full-range luma.
    pub(crate) luma: [u8; 256],
    /// Luma code to fixed point, rounding included.
    scaled: [i16; 256],
    red_from_v: [i16; 256],
    green_from_u: [i16; 256],
    green_from_v: [i16; 256],
    blue_from_u: [i16; 256],
}

impl Matrix {
    pub(crate) fn new(space: color::Space, full: bool) -> Self {
        // ITU-R BT.709-6, BT.2020-2 and BT.601-7; what is not tagged is BT.601, as libav itself assumes.
        let (red, blue) = match space {
            color::Space::BT709 => (0.2126, 0.0722),
            color::Space::BT2020NCL | color::Space::BT2020CL => (0.2627, 0.0593),
            _ => (0.299, 0.114),
        };
        let green = 1.0 - red - blue;
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

    /// A row whose chroma has half the width.
    pub(crate) fn row_of_pairs(&self, codes: &[u8], u: &[u8], v: &[u8], rgb: &mut [u8]) {
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

    pub(crate) fn row(&self, codes: &[u8], u: &[u8], v: &[u8], across: usize, rgb: &mut [u8]) {
        for (x, (code, pixel)) in codes.iter().zip(rgb.chunks_exact_mut(3)).enumerate() {
            self.write(*code, self.chroma(u[x >> across], v[x >> across]), pixel);
        }
    }
}

/// Full-range BT.601 luma of interleaved R, G, B.
pub(crate) fn luma_from_rgb(rgb: &[u8], luma: &mut [u8]) {
    for (pixel, luma) in rgb.chunks_exact(3).zip(luma) {
        let sum = u32::from(pixel[0]) * 19_595 + u32::from(pixel[1]) * 38_470 + u32::from(pixel[2]) * 7_471;
        *luma = ((sum + 32_768) >> 16) as u8;
    }
}
