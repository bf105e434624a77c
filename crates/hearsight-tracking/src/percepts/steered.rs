//! What a whole array hears: the steered response of all its pairs, frame by frame, and whether there is sound.
//!
//! Frames overlap; each is handed on as it fills. Pnevmatikakis and Talantzis take 0.27 s, in which a turn may begin and end.

use super::voice::VoiceBands;
use hearsight_audio::AudioError;
use hearsight_audio::activity::{ActivityDetector, ActivitySettings};
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::noise::{NoiseFloor, NoiseSettings};
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_audio::steered_response::{SteeredResponse, SteeredSettings};
use hearsight_core::microphones::MicrophoneArray;
use hearsight_core::room::ArraySensor;
use hearsight_core::{AudioBlock, Instant};
use serde::{Deserialize, Serialize};

/// How an array is listened to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SteeredArraySettings {
    /// Length of a frame, seconds, 0.01 to 2. Default 0.15; the paper's is 0.27 (L). Raising it makes directions surer and later.
    pub frame_s: f64,
    /// Time from one frame to the next, seconds, at most `frame_s`. Default 0.05.
    pub hop_s: f64,
    /// How frames become scores of points.
    pub response: SteeredSettings,
    /// How the noise floor is followed. Default as elsewhere, but over 8 s, and smoothed over 0.1 s: in a room with
    /// reverberation a talker leaves few gaps.
    pub noise: NoiseSettings,
    /// How many decibels above the noise floor a frequency must be to count; -100 counts all. Default 3. The phase transform
    /// makes all frequencies equal, so that a fan beside the array is else louder than a voice in the room.
    pub gate_db: f32,
    /// Of how much of the end of a frame it is asked whether there is voice, seconds, 0.01 to 2, at most the whole. Default
    /// 0.04. Raising it is surer and later at the ends of phrases.
    pub voice_s: f64,
    /// Where voice is told from noise, lowest and highest frequency, hertz. Default 300 to 6000; machines hum below.
    pub voice_hz: [f64; 2],
    /// When sound counts as voice, by the mean in decibels over 12 bands of equal ratio between these frequencies, each
    /// above its own noise floor. Default on at 2.5 dB, off at 0.5 dB: such a mean is near -2.5 dB in noise (logarithms of
    /// powers that scatter) and hardly scatters itself.
    pub activity: ActivitySettings,
}

impl Default for SteeredArraySettings {
    fn default() -> Self {
        Self {
            frame_s: 0.15,
            hop_s: 0.05,
            response: SteeredSettings::default(),
            noise: NoiseSettings {
                smoothing_s: 0.1,
                window_s: 8.0,
                ..NoiseSettings::default()
            },
            gate_db: 3.0,
            voice_s: 0.04,
            voice_hz: [300.0, 6000.0],
            activity: ActivitySettings {
                on_db: 2.5,
                off_db: 0.5,
                hangover_s: 0.1,
                slope: 0.8,
                limit: 3.0,
                ..ActivitySettings::default()
            },
        }
    }
}

/// What is remembered from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteeredState {
    framer: Framer,
    bands: NoiseFloor,
    spectrum: NoiseFloor,
    activity: ActivityDetector,
}

/// What is said of a frame beside the response to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardFrame {
    /// The instant in its middle.
    pub time: Instant,
    /// Whether there is a voice, as far as energy tells.
    pub active: bool,
    /// Logarithm of the likelihood ratio of voice and none, as far as energy tells.
    pub voice: f32,
    /// Mean over the bands of voice of the power over that of the noise, all channels together, decibels.
    pub signal_to_noise_db: f32,
}

/// Percepts of one array.
pub struct SteeredPercepts {
    state: SteeredState,
    analyzer: SpectrumAnalyzer,
    spectra: Spectra,
    response: SteeredResponse,
    /// Least power over that of the noise at which a frequency counts.
    gate: f32,
    voice: VoiceBands,
    power: Vec<f32>,
    ignored: u64,
}

impl SteeredPercepts {
    /// Percepts of all microphones of an array.
    ///
    /// # Errors
    /// [`AudioError`] where a setting is out of its range or the array has fewer than two microphones or impossible
    /// ones.
    pub fn new(
        settings: &SteeredArraySettings,
        array: &ArraySensor,
        speed_of_sound_m_s: f64,
    ) -> Result<Self, AudioError> {
        let impossible = |rule| AudioError::Setting {
            name: "microphones",
            rule,
            value: array.microphones.len() as f64,
        };
        let microphones = MicrophoneArray::new(array.microphones.clone())
            .and_then(|array| array.with_speed_of_sound(speed_of_sound_m_s))
            .map_err(|_| impossible("at different finite places"))?;
        if microphones.positions().len() != array.channels {
            return Err(impossible("one a channel"));
        }
        let samples = |seconds: f64| (seconds * f64::from(array.rate_hz)).round().max(1.0);
        if !(settings.frame_s >= 0.01 && settings.frame_s <= 2.0) {
            return Err(AudioError::Setting {
                name: "frame_s",
                rule: "within 0.01 and 2",
                value: settings.frame_s,
            });
        }
        let frames = FrameSettings {
            length: samples(settings.frame_s) as usize,
            hop: samples(settings.hop_s) as usize,
            ..FrameSettings::half_overlapping(settings.frame_s, array.rate_hz, array.channels)
        };
        if !(settings.gate_db >= -100.0 && settings.gate_db <= 100.0) {
            return Err(AudioError::Setting {
                name: "gate_db",
                rule: "within -100 and 100",
                value: settings.gate_db.into(),
            });
        }
        let transform = transform_length(frames.length, microphones.max_delay_s(), array.rate_hz);
        let analyzer = SpectrumAnalyzer::new(frames.length, transform, Window::Hann)?;
        if !(settings.voice_s >= 0.01 && settings.voice_s <= 2.0) {
            return Err(AudioError::Setting {
                name: "voice_s",
                rule: "within 0.01 and 2",
                value: settings.voice_s,
            });
        }
        let newest = (samples(settings.voice_s) as usize).min(frames.length);
        let voice = VoiceBands::new(newest, array.rate_hz, settings.voice_hz)?;
        let floors = voice.floor(&settings.noise, frames.hop_s())?;
        let noise_of_bins = NoiseFloor::of_spectra(
            &settings.noise,
            frames.hop_s(),
            analyzer.bins(),
            analyzer.window_energy(),
        )?;
        Ok(Self {
            gate: 10.0_f32.powf(settings.gate_db / 10.0),
            voice,
            power: vec![0.0; analyzer.bins()],
            analyzer,
            spectra: Spectra::default(),
            response: SteeredResponse::new(&microphones, transform, array.rate_hz, settings.response)?,
            state: SteeredState {
                bands: floors,
                spectrum: noise_of_bins,
                activity: ActivityDetector::new(settings.activity)?,
                framer: Framer::new(frames)?,
            },
            ignored: 0,
        })
    }

    /// What is remembered.
    pub fn state(&self) -> &SteeredState {
        &self.state
    }

    /// Checks what was remembered: whether these percepts could have left it.
    ///
    /// # Errors
    /// [`AudioError`] where they could not.
    pub fn check_state(&self, state: &SteeredState) -> Result<(), AudioError> {
        self.state.framer.check_saved(&state.framer)?;
        self.state.bands.check_saved(&state.bands)?;
        self.state.spectrum.check_saved(&state.spectrum)?;
        self.state.activity.check_saved(&state.activity)
    }

    /// Goes on from what was remembered.
    pub fn set_state(&mut self, state: SteeredState) {
        self.state = state;
    }

    /// The response to the newest frame.
    pub fn response(&mut self) -> &mut SteeredResponse {
        &mut self.response
    }

    /// Takes in the samples of a moment and calls `each` with the response to every frame that they complete.
    pub fn hear(
        &mut self,
        block: Option<&AudioBlock>,
        mut each: impl FnMut(&mut SteeredResponse, HeardFrame),
    ) {
        let Some(block) = block else { return };
        let SteeredState {
            framer,
            bands: floors,
            spectrum,
            activity,
        } = &mut self.state;
        let hop_s = framer.settings().hop_s();
        let (analyzer, spectra, response) = (&mut self.analyzer, &mut self.spectra, &mut self.response);
        let (gate, powers_of_bins) = (self.gate, &mut self.power);
        let voice = &mut self.voice;
        let mut failed = 0;
        let pushed = framer.push(block, |frame| {
            let observed = analyzer.transform_all(frame.channels, spectra).and_then(|()| {
                mean_power(spectra, powers_of_bins);
                let is_whole = frame.filled == 0;
                if is_whole {
                    spectrum.observe(powers_of_bins)?;
                }
                let ratio_db = voice.ratio_db(frame.channels, is_whole, floors)?;
                leave_out_noise(spectra, powers_of_bins, spectrum.power(), gate);
                response.observe(&spectra.channels)?;
                Ok(ratio_db)
            });
            match observed {
                Ok(signal_to_noise_db) => {
                    let heard = activity.observe(signal_to_noise_db, hop_s);
                    each(
                        response,
                        HeardFrame {
                            time: frame.middle(),
                            active: heard.active,
                            voice: heard.log_ratio,
                            signal_to_noise_db,
                        },
                    );
                }
                Err(_) => failed += 1,
            }
        });
        self.ignored += failed + u64::from(pushed.is_err());
    }

    /// Blocks and frames that could not be used since the start.
    pub fn ignored(&self) -> u64 {
        self.ignored
    }
}

/// The mean power of all channels, bin by bin.
fn mean_power(spectra: &Spectra, powers: &mut [f32]) {
    powers.fill(0.0);
    let share = 1.0 / spectra.channels.len().max(1) as f32;
    for channel in &spectra.channels {
        for (power, value) in powers.iter_mut().zip(channel) {
            *power += share * value.norm_sqr();
        }
    }
}

/// Sets the bins to nothing that are not so many times as strong as the noise.
fn leave_out_noise(spectra: &mut Spectra, powers: &[f32], noise: &[f32], gate: f32) {
    for channel in &mut spectra.channels {
        for ((value, power), noise) in channel.iter_mut().zip(powers).zip(noise) {
            if *power < gate * noise {
                *value = Default::default();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::{Instant, Span, WorldPoint};

    const RATE_HZ: u32 = 16_000;
    const BLOCK: usize = 1600;

    /// Whether each frame of seconds 0 to 12 counts as voice: noise as from a fan, and from 3 s to 9 s the syllables of
    /// somebody who does not stop, in a room that never lets them die away by more than 8 dB.
    fn voices() -> Vec<(f64, bool)> {
        let array = ArraySensor {
            name: "pair".into(),
            rate_hz: RATE_HZ,
            channels: 2,
            microphones: vec![WorldPoint::new(-0.1, 0.0, 1.0), WorldPoint::new(0.1, 0.0, 1.0)],
            camera: None,
        };
        let mut percepts = SteeredPercepts::new(&SteeredArraySettings::default(), &array, 343.0).unwrap();
        let mut state = 1_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 8_388_608.0 - 1.0
        };
        let (mut low, mut voices) = (0.0, Vec::new());
        for block in 0..120 {
            let samples: Vec<f32> = (0..BLOCK)
                .map(|sample| {
                    let time_s = (block * BLOCK + sample) as f64 / f64::from(RATE_HZ);
                    low += 0.05 * (noise() - low);
                    let syllable = 0.5 - 0.5 * (std::f64::consts::TAU * 4.0 * time_s).cos();
                    let is_speech = (3.0..9.0).contains(&time_s);
                    let level = if is_speech {
                        0.002 + 0.003 * syllable as f32
                    } else {
                        0.0
                    };
                    0.005 * low + 0.0005 * noise() + level * noise()
                })
                .collect();
            let block = AudioBlock {
                time: Instant::ZERO + Span::from_seconds(block as f64 * 0.1),
                rate_hz: RATE_HZ,
                channels: vec![samples.clone(), samples],
            };
            percepts.hear(Some(&block), |_, frame| {
                voices.push((frame.time.seconds(), frame.active));
            });
        }
        voices
    }

    #[test]
    fn speech_without_a_pause_stays_voice_and_noise_is_none() {
        let voices = voices();
        let share = |from: f64, until: f64| {
            let within: Vec<bool> = voices
                .iter()
                .filter(|(time_s, _)| (from..until).contains(time_s))
                .map(|(_, active)| *active)
                .collect();
            within.iter().filter(|active| **active).count() as f64 / within.len() as f64
        };
        assert!(share(1.0, 2.8) < 0.05, "{}", share(1.0, 2.8));
        assert!(share(3.2, 8.9) > 0.9, "{}", share(3.2, 8.9));
        assert!(share(9.5, 12.0) < 0.05, "{}", share(9.5, 12.0));
    }
}
