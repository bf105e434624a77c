//! FLAC files, as recordings of simulated people are read.

use super::{Target, Verdict};
use hearsight_sim::voice::read_sound;

pub(super) const TARGET: Target = Target {
    name: "flac",
    meaning: "A FLAC file; what is read has all channels, equally long, with finite samples.",
    text: false,
    words: &["fLaC"],
    longest: 4 << 10,
    seeds: || vec![include_bytes!("../../../crates/hearsight-sim/tests/goldens/tone.flac").to_vec()],
    open: || {
        let directory = tempfile::tempdir();
        Box::new(move |bytes| {
            let Ok(directory) = &directory else {
                return Verdict::Refused("no directory".to_owned());
            };
            let path = directory.path().join("a.flac");
            if std::fs::write(&path, bytes).is_err() {
                return Verdict::Refused("not written".to_owned());
            }
            let sound = match read_sound(&path) {
                Ok(sound) => sound,
                Err(error) => return Verdict::Refused(error.to_string()),
            };
            let length = sound.channels.first().map_or(0, Vec::len);
            if sound.channels.iter().any(|channel| channel.len() != length) {
                return Verdict::Broken("channels differ in length".to_owned());
            }
            if sound.channels.iter().flatten().any(|sample| !sample.is_finite()) {
                return Verdict::Broken("a sample is not finite".to_owned());
            }
            Verdict::Read(format!(
                "{} channels, {} bits of samples",
                sound.channels.len(),
                length.max(1).ilog2()
            ))
        })
    },
};
