//! Loudness, clipping, sign: is every channel a microphone that works?

use super::CheckReport;
use hearsight_audio::levels::LevelMeter;

/// Says what the meter has found.
pub(super) fn report(name: &str, meter: &LevelMeter, report: &mut CheckReport) {
    let channels = meter.channels();
    let loudest = channels
        .iter()
        .map(|channel| channel.rms_dbfs)
        .fold(-200.0, f64::max);
    for (number, channel) in channels.iter().enumerate() {
        let level = format!(
            "channel {number}: {:.0} dB of full scale, peak {:.2}",
            channel.rms_dbfs, channel.peak
        );
        if channel.silent {
            let cure = "check the cable, the gain, and `channels`";
            report.fail(
                name,
                "level",
                format!("channel {number} is silent"),
                Some(cure.to_owned()),
            );
        } else if channel.clipped > 1e-4 {
            let what = format!(
                "{level}; {:.2} % of its samples are clipped",
                100.0 * channel.clipped
            );
            report.warn(
                name,
                "level",
                what,
                "lower the gain: clipped sound has no true delays",
            );
        } else if loudest - channel.rms_dbfs > 12.0 {
            let what = format!("{level}, {:.0} dB below the loudest", loudest - channel.rms_dbfs);
            report.warn(
                name,
                "level",
                what,
                "check the gain and the place of this microphone",
            );
        } else {
            report.pass(name, "level", level);
        }
        if channel.non_finite > 0 {
            let what = format!("channel {number}: {} samples are not numbers", channel.non_finite);
            report.warn(
                name,
                "samples",
                what,
                "they count as zero: convert the file again",
            );
        }
        if channel.offset.abs() > 0.02 {
            let what = format!("channel {number} has an offset of {:.3}", channel.offset);
            report.warn(
                name,
                "offset",
                what,
                "check the sound card; the offset hides soft sound",
            );
        }
    }
    let pairs = meter.pairs();
    let inverted: Vec<_> = pairs.iter().filter(|pair| pair.inverted).collect();
    match inverted.as_slice() {
        [] if pairs.is_empty() => {
            let cure = "delays need two or more: pick more with `channels`";
            report.warn(name, "channels", "only one channel", cure);
        }
        [] => report.pass(name, "sign", "all channels have the same sign"),
        [first, ..] => {
            // The channel that is in every inverted pair is the one, where there are three or more.
            let counts = (0..channels.len()).map(|channel| {
                inverted
                    .iter()
                    .filter(|pair| pair.channels.contains(&channel))
                    .count()
            });
            let guilty: Vec<_> = counts
                .enumerate()
                .filter(|(_, count)| *count == inverted.len())
                .collect();
            let [one, other] = first.channels;
            let what = match guilty.as_slice() {
                [(channel, _)] => format!("channel {channel} is inverted"),
                _ => format!(
                    "channel {one} or {other} is inverted (correlation {:.2})",
                    first.correlation
                ),
            };
            report.warn(name, "sign", what, "swap the two wires of that microphone");
        }
    }
}
