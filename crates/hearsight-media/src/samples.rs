//! Decoded libav samples of any format to planar `f32`, appended to buffers that are reused.

use ffmpeg_next::format::Sample;
use ffmpeg_next::frame;

/// Appends the channels `selection` of `decoded` to `planes`, one plane for each. `false` where the frame has fewer
/// channels than the selection needs or a format that is unknown; then nothing is appended.
pub(crate) fn append(decoded: &frame::Audio, selection: &[usize], planes: &mut [Vec<f32>]) -> bool {
    let channels = usize::from(decoded.channels());
    if selection.iter().any(|channel| *channel >= channels) {
        return false;
    }
    let count = decoded.samples();
    for (channel, plane) in selection.iter().zip(planes) {
        let (packed, index) = match decoded.format() {
            Sample::None => return false,
            format => (format.is_packed(), *channel),
        };
        // A packed frame has one plane of interleaved samples, a planar one a plane for each channel.
        let (source, offset, stride) = if packed {
            (0, index, channels)
        } else {
            (index, 0, 1)
        };
        if source >= decoded.planes() {
            return false;
        }
        let bytes = decoded.format().bytes();
        let data = raw_plane(decoded, source, count * stride * bytes);
        let samples = data.chunks_exact(bytes).skip(offset).step_by(stride).take(count);
        match decoded.format() {
            Sample::U8(_) => plane.extend(samples.map(|s| (f32::from(s[0]) - 128.0) / 128.0)),
            Sample::I16(_) => {
                plane.extend(samples.map(|s| f32::from(i16::from_ne_bytes([s[0], s[1]])) / 32_768.0))
            }
            Sample::I32(_) => {
                plane.extend(samples.map(|s| integer(i64::from(i32::from_ne_bytes(array(s))), 31)))
            }
            Sample::I64(_) => plane.extend(samples.map(|s| integer(i64::from_ne_bytes(array(s)), 63))),
            Sample::F32(_) => plane.extend(samples.map(|s| f32::from_ne_bytes(array(s)))),
            Sample::F64(_) => plane.extend(samples.map(|s| f64::from_ne_bytes(array(s)) as f32)),
            Sample::None => return false,
        }
    }
    true
}

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&bytes[..N]);
    array
}

/// A sample of `bits` bits beside the sign, at full scale 1.
pub(crate) fn integer(value: i64, bits: u32) -> f32 {
    (value as f64 / (1_u64 << bits) as f64) as f32
}

/// The first `length` bytes of a plane; the bindings' own `data` takes its length from `linesize`, which padding may
/// make longer but never shorter.
fn raw_plane(decoded: &frame::Audio, index: usize, length: usize) -> &[u8] {
    let data = decoded.data(index);
    &data[..length.min(data.len())]
}

/// Replaces samples that are not finite by zero and returns how many there were.
pub(crate) fn quarantine(planes: &mut [Vec<f32>]) -> usize {
    let mut count = 0;
    for sample in planes.iter_mut().flatten().filter(|sample| !sample.is_finite()) {
        *sample = 0.0;
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use ffmpeg_next::ChannelLayout;
    use ffmpeg_next::format::sample::Type;

    #[test]
    fn every_layout_gives_the_same_samples() {
        let mut planes = vec![Vec::new(), Vec::new()];
        let mut packed = frame::Audio::new(Sample::I16(Type::Packed), 4, ChannelLayout::STEREO);
        packed.set_channels(2);
        packed
            .plane_mut::<(i16, i16)>(0)
            .copy_from_slice(&[(0, 16_384); 4]);
        assert!(append(&packed, &[1, 0], &mut planes));
        assert_eq!(planes, [vec![0.5; 4], vec![0.0; 4]]);

        let mut planar = frame::Audio::new(Sample::F32(Type::Planar), 4, ChannelLayout::STEREO);
        planar.set_channels(2);
        planar.plane_mut::<f32>(1).fill(-0.25);
        planar.plane_mut::<f32>(0).fill(f32::NAN);
        assert!(append(&planar, &[1, 0], &mut planes));
        assert_eq!(planes[0][4..], [-0.25; 4]);
        assert_eq!(quarantine(&mut planes), 4);
        assert_eq!(planes[1], vec![0.0; 8]);
        assert!(!append(&planar, &[2], &mut planes));
    }

    #[test]
    fn integers_reach_full_scale() {
        assert_eq!(integer(i64::from(i32::MIN), 31), -1.0);
        assert_eq!(integer(i64::MIN, 63), -1.0);
        assert_eq!(integer(1 << 22, 23), 0.5);
    }
}
