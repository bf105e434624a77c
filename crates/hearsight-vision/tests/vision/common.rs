//! Synthetic pictures by the formula of goldens/make_pictures.py, and checksums.

/// The linear congruential generator of Numerical Recipes, its highest byte.
pub(crate) struct Noise {
    state: u32,
}

impl Noise {
    pub(crate) fn new(seed: u32) -> Self {
        Self { state: seed }
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.state >> 24) as u8
    }
}

/// A slope with discs and noise, `channels` interleaved.
pub(crate) fn picture(width: usize, height: usize, channels: usize, seed: u32) -> Vec<u8> {
    let mut noise = Noise::new(seed);
    let mut place = |side: usize| usize::from(noise.byte()) * side / 256;
    let discs: Vec<_> = (0..8)
        .map(|_| {
            let (x, y, r) = (place(width), place(height), 4 + place(256) % 20);
            let colour: Vec<usize> = (0..channels).map(|_| place(256)).collect();
            (x, y, r, colour)
        })
        .collect();
    let mut out = Vec::with_capacity(width * height * channels);
    for y in 0..height {
        for x in 0..width {
            let inside = discs.iter().rev().find(|(disc_x, disc_y, r, _)| {
                x.abs_diff(*disc_x).pow(2) + y.abs_diff(*disc_y).pow(2) <= r * r
            });
            for channel in 0..channels {
                let slope = (x * 2 + y * (channel + 1)) % 200;
                let value = inside.map_or(slope, |(.., colour)| colour[channel]);
                out.push((value + usize::from(noise.byte()) % 24).min(255) as u8);
            }
        }
    }
    out
}

/// FNV-1a, 64 bits, in hexadecimal digits.
pub(crate) fn checksum(bytes: impl IntoIterator<Item = u8>) -> String {
    let value = bytes.into_iter().fold(0xcbf2_9ce4_8422_2325_u64, |value, byte| {
        (value ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{value:016x}")
}
