//! Decoded libav pictures to RGB and full-range luma.
//!
//! Planar 8-bit YUV, which nearly every camera and codec delivers, is converted here in integers, straight into the
//! frame's own memory: the result is the same on every machine, whatever SIMD it has. swscale first brings anything
//! else to a form that this module takes, and pictures that change their size in mid-stream to the declared size.

use crate::matrix::{luma_from_rgb, primaries};
use ffmpeg_next::color;
use ffmpeg_next::format::Pixel;
use ffmpeg_next::frame;
use ffmpeg_next::software::scaling;
use hearsight_core::VideoFrame;
use hearsight_core::yuv::YuvMatrix;

/// Turns libav frames of any format into frames of one size.
pub(crate) struct PictureConverter {
    width: usize,
    height: usize,
    scaler: Option<Scaler>,
    matrix: Option<(color::Space, bool, YuvMatrix)>,
}

struct Scaler {
    context: scaling::Context,
    from: (Pixel, u32, u32),
    picture: frame::Video,
}

// SAFETY (of a scaler moved between threads): swscale's context has no tie to the thread that made it, and the
// converter is used by one thread at a time, since every use takes `&mut self`.
#[expect(unsafe_code, reason = "the bindings leave the scaling context without Send")]
unsafe impl Send for Scaler {}

impl PictureConverter {
    /// A converter to pictures of the given size.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            scaler: None,
            matrix: None,
        }
    }

    /// Fills `frame`'s pixels and size from `decoded`.
    pub(crate) fn convert(
        &mut self,
        decoded: &frame::Video,
        frame: &mut VideoFrame,
    ) -> Result<(), ffmpeg_next::Error> {
        let (width, height) = (self.width, self.height);
        frame.width = width;
        frame.height = height;
        frame.rgb.resize(width * height * 3, 0);
        frame.luma.resize(width * height, 0);
        let same_size = decoded.width() as usize == width && decoded.height() as usize == height;
        if same_size && is_direct(decoded) {
            return self.unpack(decoded, is_full_range(decoded), frame);
        }
        let full = is_full_range(decoded);
        let mut scaler = match self.scaler.take() {
            Some(scaler) if scaler.from == (decoded.format(), decoded.width(), decoded.height()) => scaler,
            _ => Scaler::new(decoded, width, height)?,
        };
        scaler.context.run(decoded, &mut scaler.picture)?;
        scaler.picture.set_color_space(decoded.color_space());
        let result = self.unpack(&scaler.picture, full, frame);
        self.scaler = Some(scaler);
        result
    }

    fn unpack(
        &mut self,
        picture: &frame::Video,
        full: bool,
        frame: &mut VideoFrame,
    ) -> Result<(), ffmpeg_next::Error> {
        let (width, height) = (self.width, self.height);
        if picture.format() == Pixel::RGB24 {
            copy_rgb(picture, frame);
            return Ok(());
        }
        if picture.format() == Pixel::GRAY8 {
            copy_gray(picture, frame);
            return Ok(());
        }
        let (across, down) = chroma_shift(picture.format());
        let space = picture.color_space();
        let matrix = match &mut self.matrix {
            Some((known, range, matrix)) if *known == space && *range == full => matrix,
            slot => {
                &mut slot
                    .insert((space, full, YuvMatrix::new(primaries(space), full)))
                    .2
            }
        };
        let (luma, blue, red) = (picture.data(0), picture.data(1), picture.data(2));
        let (luma_stride, blue_stride, red_stride) =
            (picture.stride(0), picture.stride(1), picture.stride(2));
        let chroma_width = width.div_ceil(1 << across);
        for y in 0..height {
            let codes = &luma[y * luma_stride..][..width];
            let u = &blue[(y >> down) * blue_stride..][..chroma_width];
            let v = &red[(y >> down) * red_stride..][..chroma_width];
            matrix.luma_row(codes, &mut frame.luma[y * width..][..width]);
            let rgb = &mut frame.rgb[y * width * 3..][..width * 3];
            if across == 1 {
                matrix.row_of_pairs(codes, u, v, rgb);
            } else {
                matrix.row(codes, u, v, across, rgb);
            }
        }
        Ok(())
    }
}

impl Scaler {
    fn new(decoded: &frame::Video, width: usize, height: usize) -> Result<Self, ffmpeg_next::Error> {
        let from = (decoded.format(), decoded.width(), decoded.height());
        let to = intermediate(decoded.format());
        let context = scaling::Context::get(
            from.0,
            from.1,
            from.2,
            to,
            width as u32,
            height as u32,
            scaling::Flags::BILINEAR | scaling::Flags::ACCURATE_RND | scaling::Flags::BITEXACT,
        )?;
        Ok(Self {
            context,
            from,
            picture: frame::Video::new(to, width as u32, height as u32),
        })
    }
}

/// Whether the planes can be read without swscale.
fn is_direct(picture: &frame::Video) -> bool {
    let planes = match picture.format() {
        Pixel::GRAY8 | Pixel::RGB24 => 1,
        Pixel::YUV420P | Pixel::YUVJ420P | Pixel::YUV422P | Pixel::YUVJ422P => 3,
        Pixel::YUV444P | Pixel::YUVJ444P | Pixel::YUV411P => 3,
        _ => return false,
    };
    // Pictures stored bottom up have a negative stride, which these bindings show as an enormous one.
    picture.planes() >= planes && (0..planes).all(|plane| picture.stride(plane) <= i32::MAX as usize)
}

/// Chroma is this many powers of two narrower and lower than luma.
fn chroma_shift(format: Pixel) -> (usize, usize) {
    match format {
        Pixel::YUV420P | Pixel::YUVJ420P => (1, 1),
        Pixel::YUV422P | Pixel::YUVJ422P => (1, 0),
        Pixel::YUV411P => (2, 0),
        _ => (0, 0),
    }
}

/// The format to which swscale brings `format` without changing its range or matrix.
fn intermediate(format: Pixel) -> Pixel {
    let name = format.descriptor().map_or("", |descriptor| descriptor.name());
    const YUV: [&str; 12] = [
        "yuv", "nv", "uyvy", "yuyv", "yvyu", "uyyv", "p0", "p2", "p4", "y2", "xv", "vuy",
    ];
    const FULL: [Pixel; 5] = [
        Pixel::YUVJ420P,
        Pixel::YUVJ411P,
        Pixel::YUVJ422P,
        Pixel::YUVJ440P,
        Pixel::YUVJ444P,
    ];
    if FULL.contains(&format) {
        Pixel::YUVJ444P
    } else if YUV.iter().any(|prefix| name.starts_with(prefix)) {
        Pixel::YUV444P
    } else if name.starts_with("gray") || name.starts_with("mono") {
        Pixel::GRAY8
    } else {
        Pixel::RGB24
    }
}

fn is_full_range(picture: &frame::Video) -> bool {
    let name = picture
        .format()
        .descriptor()
        .map_or("", |descriptor| descriptor.name());
    name.starts_with("yuvj") || picture.color_range() == color::Range::JPEG
}

fn copy_rgb(picture: &frame::Video, frame: &mut VideoFrame) {
    let (width, stride, bytes) = (frame.width, picture.stride(0), picture.data(0));
    for y in 0..frame.height {
        let rgb = &mut frame.rgb[y * width * 3..][..width * 3];
        rgb.copy_from_slice(&bytes[y * stride..][..width * 3]);
        luma_from_rgb(rgb, &mut frame.luma[y * width..][..width]);
    }
}

fn copy_gray(picture: &frame::Video, frame: &mut VideoFrame) {
    let (width, stride, bytes) = (frame.width, picture.stride(0), picture.data(0));
    for y in 0..frame.height {
        let gray = &bytes[y * stride..][..width];
        frame.luma[y * width..][..width].copy_from_slice(gray);
        for (pixel, value) in frame.rgb[y * width * 3..].chunks_exact_mut(3).zip(gray) {
            pixel.fill(*value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(format: Pixel, values: [u8; 3]) -> frame::Video {
        let mut picture = frame::Video::new(format, 6, 4);
        for plane in 0..picture.planes() {
            picture.data_mut(plane).fill(values[plane]);
        }
        picture
    }

    fn converted(picture: &frame::Video) -> VideoFrame {
        let mut frame = VideoFrame::default();
        PictureConverter::new(6, 4).convert(picture, &mut frame).unwrap();
        frame
    }

    #[test]
    fn limited_range_spans_black_to_white() {
        for (code, value) in [(16, 0), (235, 255), (0, 0), (255, 255), (126, 128)] {
            let frame = converted(&picture(Pixel::YUV420P, [code, 128, 128]));
            assert!(frame.luma.iter().all(|luma| *luma == value), "{code}");
            assert!(frame.rgb.iter().all(|channel| *channel == value), "{code}");
        }
    }

    #[test]
    fn full_range_is_kept() {
        let mut tagged = picture(Pixel::YUV420P, [77, 128, 128]);
        tagged.set_color_range(color::Range::JPEG);
        for frame in [
            converted(&tagged),
            converted(&picture(Pixel::YUVJ444P, [77, 128, 128])),
        ] {
            assert!(frame.luma.iter().all(|luma| *luma == 77));
            assert!(frame.rgb.iter().all(|channel| *channel == 77));
        }
    }

    #[test]
    fn primary_red_in_both_matrices() {
        // BT.601-7 and BT.709-6 limited-range codes of pure red.
        let mut modern = picture(Pixel::YUV422P, [63, 102, 240]);
        modern.set_color_space(color::Space::BT709);
        for frame in [
            converted(&picture(Pixel::YUV444P, [81, 90, 240])),
            converted(&modern),
        ] {
            let pixel = &frame.rgb[..3];
            assert!(pixel[0] >= 253 && pixel[1] <= 2 && pixel[2] <= 2, "{pixel:?}");
        }
    }

    #[test]
    fn other_formats_go_through_the_scaler() {
        let frame = converted(&picture(Pixel::NV12, [126, 128, 128]));
        assert!(frame.luma.iter().all(|luma| *luma == 128));
        let frame = converted(&picture(Pixel::BGR24, [200, 0, 0]));
        assert_eq!(frame.luma[0], 200);
        let larger = frame::Video::new(Pixel::YUV420P, 12, 8);
        assert_eq!(converted(&larger).rgb.len(), 72);
    }
}
