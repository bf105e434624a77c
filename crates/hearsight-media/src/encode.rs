//! Encoders: which there are, with settings fast enough to run beside a tracker.

use crate::error::EncodeError;
use crate::libav;
use ffmpeg_next::codec::{self, threading};
use ffmpeg_next::format::Pixel;
use ffmpeg_next::{Codec, Dictionary, Error, Rational, color, encoder, frame};

/// Units of encoded time a second; whole for every common frame rate.
pub(crate) const UNITS_PER_SECOND: i32 = 90_000;

/// An encoder of video.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Encoder {
    /// The first of VP9, H.264 by OpenH264 and AV1 that the installed libav has: all play in browsers, none is GPL.
    #[default]
    Automatic,
    /// VP9 by libvpx (BSD licence).
    Vp9,
    /// AV1 by SVT-AV1 or libaom (BSD licences).
    Av1,
    /// H.264 by OpenH264 (BSD licence), else by libx264, whose licence is the GPL: only who asks for it gets it.
    H264,
    /// FFV1, which keeps every bit of 4:2:0 pictures, in QuickTime files.
    Lossless,
    /// libav's name of any other encoder.
    Named(String),
}

impl Encoder {
    /// libav's names, the preferred first.
    fn names(&self) -> Vec<&str> {
        match self {
            Self::Automatic => vec!["libvpx-vp9", "libopenh264", "libsvtav1", "libaom-av1"],
            Self::Vp9 => vec!["libvpx-vp9"],
            Self::Av1 => vec!["libsvtav1", "libaom-av1"],
            Self::H264 => vec!["libopenh264", "libx264"],
            Self::Lossless => vec!["ffv1"],
            Self::Named(name) => vec![name],
        }
    }

    /// libav's name of the kind of file.
    pub(crate) fn container(&self) -> &'static str {
        match self {
            Self::Lossless => "mov",
            _ => "mp4",
        }
    }

    pub(crate) fn find(&self) -> Result<Codec, EncodeError> {
        libav::initialize();
        let names = self.names();
        let named = names.iter().filter(|name| !name.contains('\0'));
        named
            .filter_map(|name| encoder::find_by_name(name))
            .next()
            .ok_or_else(|| EncodeError::NoEncoder {
                name: names.join(" or "),
                available: available_encoders().join(", "),
            })
    }
}

/// libav's names of the encoders known here that are installed.
pub fn available_encoders() -> Vec<&'static str> {
    libav::initialize();
    let known = ["libvpx-vp9", "libopenh264", "libsvtav1", "libaom-av1", "libx264"];
    known
        .into_iter()
        .filter(|name| encoder::find_by_name(name).is_some())
        .collect()
}

/// What an encoder has to know.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) frames_per_second: f64,
    pub(crate) keyframe_seconds: f64,
    pub(crate) quality: u8,
    pub(crate) threads: usize,
    pub(crate) global_header: bool,
}

/// Opens an encoder.
pub(crate) fn open(chosen: Codec, settings: &Settings) -> Result<encoder::video::Encoder, Error> {
    let mut context = codec::Context::new_with_codec(chosen);
    context.set_threading(threading::Config {
        count: settings.threads.max(1),
        ..threading::Config::kind(threading::Type::Slice)
    });
    if settings.global_header {
        context.set_flags(codec::Flags::GLOBAL_HEADER);
    }
    let mut video = context.encoder().video()?;
    video.set_width(settings.width as u32);
    video.set_height(settings.height as u32);
    video.set_format(Pixel::YUV420P);
    video.set_colorspace(color::Space::SMPTE170M);
    video.set_color_range(color::Range::MPEG);
    video.set_time_base(Rational::new(1, UNITS_PER_SECOND));
    let rate = settings.frames_per_second.clamp(0.01, 1000.0);
    video.set_frame_rate(Some(Rational::new((rate * 1000.0).round() as i32, 1000)));
    // Lossless pictures stand each for itself: one that is damaged costs no other.
    let gop = (rate * settings.keyframe_seconds).round().clamp(1.0, 1000.0) as u32;
    video.set_gop(if chosen.name() == "ffv1" { 1 } else { gop });
    video.set_max_b_frames(0);
    // Without a quality of its own an encoder gets a rate that suits the size.
    let bits = settings.width as f64 * settings.height as f64 * rate * 0.15;
    if chosen.name() == "libopenh264" {
        video.set_bit_rate(bits as usize);
    } else {
        video.set_bit_rate(0);
    }
    video.open_as_with(chosen, private_options(chosen.name(), settings))
}

/// Settings for real time of each encoder, by its own names.
fn private_options(name: &str, settings: &Settings) -> Dictionary<'static> {
    let quality = u32::from(settings.quality.clamp(1, 63)).to_string();
    // The scale of H.264 ends at 51 where that of VP9 and AV1 ends at 63.
    let short_quality = (u32::from(settings.quality.clamp(1, 63)) * 51 / 63).to_string();
    // Odd sizes cannot be cut in this version of the format.
    let slices = if settings.width.is_multiple_of(2) && settings.height.is_multiple_of(2) {
        "4"
    } else {
        "1"
    };
    let pairs: Vec<(&str, &str)> = match name {
        "libvpx-vp9" => vec![
            ("deadline", "realtime"),
            ("cpu-used", "8"),
            ("lag-in-frames", "0"),
            ("auto-alt-ref", "0"),
            ("crf", &quality),
        ],
        "libaom-av1" => {
            vec![
                ("usage", "realtime"),
                ("cpu-used", "9"),
                ("lag-in-frames", "0"),
                ("crf", &quality),
            ]
        }
        "libsvtav1" => vec![("preset", "12"), ("crf", &quality)],
        // Version 3 with checksums of slices.
        "ffv1" => vec![
            ("level", "3"),
            ("slices", slices),
            ("slicecrc", "1"),
            ("coder", "rice"),
        ],
        "libx264" => vec![
            ("preset", "veryfast"),
            ("tune", "zerolatency"),
            ("crf", &short_quality),
        ],
        _ => Vec::new(),
    };
    pairs.into_iter().collect()
}

/// Copies planes of 4:2:0 (luma, blue, red; rows without gaps) into a libav frame.
pub(crate) fn copy_planes(planes: [&[u8]; 3], picture: &mut frame::Video) {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let sizes = [
        (width, height),
        (width.div_ceil(2), height.div_ceil(2)),
        (width.div_ceil(2), height.div_ceil(2)),
    ];
    for (plane, (codes, (width, height))) in planes.into_iter().zip(sizes).enumerate() {
        let stride = picture.stride(plane);
        let rows = picture.data_mut(plane).chunks_mut(stride).take(height);
        for (row, codes) in rows.zip(codes.chunks_exact(width)) {
            row[..width].copy_from_slice(codes);
        }
    }
}

/// Interleaved R, G, B to limited-range BT.601 4:2:0, chroma averaged over two by two pixels.
pub(crate) fn planes_from_rgb(rgb: &[u8], picture: &mut frame::Video) {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let strides = [picture.stride(0), picture.stride(1), picture.stride(2)];
    let luma = picture.data_mut(0);
    for (y, row) in rgb.chunks_exact(width * 3).enumerate().take(height) {
        for (code, pixel) in luma[y * strides[0]..][..width]
            .iter_mut()
            .zip(row.chunks_exact(3))
        {
            let [r, g, b] = [0, 1, 2].map(|channel| i32::from(pixel[channel]));
            *code = ((16_829 * r + 33_039 * g + 6_416 * b + 32_768 + (16 << 16)) >> 16) as u8;
        }
    }
    for plane in [1, 2] {
        let (r, g, b) = if plane == 1 {
            (-9_714, -19_070, 28_784)
        } else {
            (28_784, -24_103, -4_681)
        };
        let stride = strides[plane];
        let chroma = picture.data_mut(plane);
        for y in 0..height.div_ceil(2) {
            let upper = &rgb[2 * y * width * 3..][..width * 3];
            let lower = &rgb[(2 * y + 1).min(height - 1) * width * 3..][..width * 3];
            for (x, code) in chroma[y * stride..][..width.div_ceil(2)].iter_mut().enumerate() {
                let (left, right) = (2 * x * 3, (2 * x + 1).min(width - 1) * 3);
                let sum = |channel: usize| {
                    let at = [
                        upper[left + channel],
                        upper[right + channel],
                        lower[left + channel],
                        lower[right + channel],
                    ];
                    at.iter().map(|value| i32::from(*value)).sum::<i32>()
                };
                *code = ((r * sum(0) + g * sum(1) + b * sum(2) + (1 << 17) + (128 << 18)) >> 18)
                    .clamp(16, 240) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::PictureConverter;
    use hearsight_core::VideoFrame;

    #[test]
    fn colors_survive_the_way_there_and_back() {
        for color in [
            [255, 0, 0],
            [0, 255, 0],
            [0, 0, 255],
            [255, 255, 255],
            [0, 0, 0],
            [90, 160, 20],
        ] {
            let mut picture = frame::Video::new(Pixel::YUV420P, 5, 3);
            planes_from_rgb(&color.repeat(15), &mut picture);
            let mut back = VideoFrame::default();
            PictureConverter::new(5, 3).convert(&picture, &mut back).unwrap();
            for pixel in back.rgb.chunks_exact(3) {
                for (new, old) in pixel.iter().zip(color) {
                    assert!(new.abs_diff(old) <= 3, "{color:?} became {pixel:?}");
                }
            }
        }
    }
}
