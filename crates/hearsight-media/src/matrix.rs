//! libav's names of colour spaces, and luma of RGB, in integers.

use ffmpeg_next::color;
use hearsight_core::yuv::Primaries;

/// The weights of luma that a picture is tagged with; what is not tagged is BT.601, as libav itself assumes.
pub(crate) fn primaries(space: color::Space) -> Primaries {
    match space {
        color::Space::BT709 => Primaries::Bt709,
        color::Space::BT2020NCL | color::Space::BT2020CL => Primaries::Bt2020,
        _ => Primaries::Bt601,
    }
}

/// Full-range BT.601 luma of interleaved R, G, B.
pub(crate) fn luma_from_rgb(rgb: &[u8], luma: &mut [u8]) {
    for (pixel, luma) in rgb.chunks_exact(3).zip(luma) {
        let sum = u32::from(pixel[0]) * 19_595 + u32::from(pixel[1]) * 38_470 + u32::from(pixel[2]) * 7_471;
        *luma = ((sum + 32_768) >> 16) as u8;
    }
}
