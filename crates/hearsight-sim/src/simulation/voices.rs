//! What people and things of a world sound like.

use crate::acoustics::{AcousticsError, Sound};
use crate::voice;
use crate::world::{Noise, NoiseKind, Person, Speech};
use std::sync::Arc;

/// Speech is told apart from pauses in frames of this length, seconds.
const FRAME_S: f64 = 0.01;
/// Frames this far below the loudest ones are silence, decibels.
const SILENT_DB: f64 = -35.0;
/// Silence shorter than this is part of a word, frames.
const SHORTEST_PAUSE: usize = 20;
/// The lowest frequency of white noise, hertz, and the highest, a share of the rate.
const WHITE_FROM_HZ: f64 = 30.0;
const WHITE_TO: f64 = 0.49;

/// What somebody says in their turns.
pub(super) fn speech(person: &Person, rate_hz: u32) -> Result<voice::Speech, AcousticsError> {
    let turns: Vec<voice::Turn> = turns(&person.turns);
    match &person.voice.recording {
        Some(folder) => voice::RecordedVoice::open(folder, rate_hz)?.speak(&turns, 0, person.voice.seed),
        None => voice::Talker::new(person.voice.kind, person.voice.seed).speak(&turns, 0, rate_hz),
    }
}

/// The samples of a noise at a place.
pub(super) fn noise(noise: &Noise, rate_hz: u32) -> Result<Arc<dyn Sound>, AcousticsError> {
    if let Some(folder) = &noise.recording {
        let turns = turns(&noise.during);
        return Ok(Arc::new(
            voice::RecordedVoice::open(folder, rate_hz)?.speak(&turns, 0, noise.seed)?,
        ));
    }
    let kind = match noise.kind {
        NoiseKind::Fan | NoiseKind::Motor => voice::NoiseKind::Fan,
        NoiseKind::Street => voice::NoiseKind::Street,
        NoiseKind::Television => voice::NoiseKind::Television,
        NoiseKind::Telephone => voice::NoiseKind::Telephone,
        NoiseKind::Cough => voice::NoiseKind::Cough,
        NoiseKind::Laugh => voice::NoiseKind::Laugh,
        NoiseKind::Clap => voice::NoiseKind::Clap,
        NoiseKind::White => voice::NoiseKind::Band {
            low_hz: WHITE_FROM_HZ,
            high_hz: WHITE_TO * f64::from(rate_hz),
        },
        NoiseKind::Band => {
            let [middle, width] = noise.band_hz;
            voice::NoiseKind::Band {
                low_hz: middle - 0.5 * width,
                high_hz: middle + 0.5 * width,
            }
        }
    };
    Ok(Arc::new(voice::Noise::new(
        kind,
        &noise.during,
        rate_hz,
        noise.seed,
    )?))
}

fn turns(spans: &[[f64; 2]]) -> Vec<voice::Turn> {
    let turn = |[start_s, end_s]: &[f64; 2]| voice::Turn {
        person: 0,
        start_s: *start_s,
        end_s: *end_s,
    };
    spans.iter().map(turn).collect()
}

/// The mouth that goes with a speech, and when it is silent.
pub(super) struct Mouth {
    speech: Arc<voice::Speech>,
    /// For each turn its beginning, seconds, and whether there is sound in each frame from there on.
    turns: Vec<(f64, Vec<bool>)>,
}

impl Mouth {
    /// Listens to a person's speech.
    pub(super) fn new(person: &Person, speech: Arc<voice::Speech>) -> Self {
        let rate = f64::from(speech.rate_hz());
        let mut samples = vec![0.0; (rate * FRAME_S).round() as usize];
        let mut turns = Vec::new();
        for [from, until] in &person.turns {
            let frames = ((until - from) / FRAME_S).ceil().max(1.0) as usize;
            let energies = (0..frames).map(|frame| {
                let first = ((from + frame as f64 * FRAME_S) * rate).round() as i64;
                speech.fill(first, &mut samples);
                samples
                    .iter()
                    .map(|sample| f64::from(*sample).powi(2))
                    .sum::<f64>()
            });
            turns.push((*from, energies.collect::<Vec<f64>>()));
        }
        let mut all: Vec<f64> = turns
            .iter()
            .flat_map(|(_, energies)| energies.iter().copied())
            .collect();
        all.sort_by(f64::total_cmp);
        let loud = all.get(all.len() * 19 / 20).copied().unwrap_or(0.0);
        let floor = loud * 10.0_f64.powf(SILENT_DB / 10.0);
        let sounds = |energies: Vec<f64>| {
            let mut sounds: Vec<bool> = energies.iter().map(|energy| *energy > floor).collect();
            join(&mut sounds);
            sounds
        };
        Self {
            turns: turns
                .into_iter()
                .map(|(from, energies)| (from, sounds(energies)))
                .collect(),
            speech,
        }
    }
}

/// Fills silence that is too short to be a pause.
fn join(sounds: &mut [bool]) {
    let mut last = None;
    for frame in 0..sounds.len() {
        if sounds[frame] {
            if let Some(last) = last
                && frame - last <= SHORTEST_PAUSE
            {
                sounds[last..frame].fill(true);
            }
            last = Some(frame);
        }
    }
}

impl Speech for Mouth {
    fn opening(&self, time_s: f64) -> f64 {
        self.speech.mouth_opening(time_s)
    }

    fn sounds(&self, time_s: f64) -> bool {
        let begun = self.turns.partition_point(|(from, _)| *from <= time_s);
        let Some((from, sounds)) = begun.checked_sub(1).and_then(|last| self.turns.get(last)) else {
            return false;
        };
        let frame = ((time_s - from) / FRAME_S) as usize;
        sounds.get(frame).copied().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::join;

    #[test]
    fn only_long_silence_is_a_pause() {
        let mut sounds = vec![false; 100];
        for frame in [10, 25, 60] {
            sounds[frame] = true;
        }
        join(&mut sounds);
        assert!(sounds[10..=25].iter().all(|sound| *sound));
        assert!(!sounds[26..60].iter().any(|sound| *sound) && sounds[60]);
    }
}
