//! What a whole array hears: the steered response of all its pairs, frame by frame, and whether there is sound.
//!
//! Frames are long (Pnevmatikakis and Talantzis take 0.27 s) and overlap; each is handed on as it fills.

use hearsight_audio::AudioError;
use hearsight_audio::activity::{ActivityDetector, ActivitySettings};
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::noise::{NoiseFloor, NoiseSettings, mean_square};
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
    /// Length of a frame, seconds, 0.01 to 2. Default 0.27 (L). Raising it makes directions surer and later.
    pub frame_s: f64,
    /// Time from one frame to the next, seconds, at most `frame_s`. Default 0.08.
    pub hop_s: f64,
    /// How frames become scores of points.
    pub response: SteeredSettings,
    /// How the noise floor is followed.
    pub noise: NoiseSettings,
    /// How many decibels above the noise floor a frequency must be to count; -100 counts all. Default 3. The phase transform
    /// makes all frequencies equal, so that a fan beside the array is else louder than a voice in the room.
    pub gate_db: f32,
    /// When sound counts as voice.
    pub activity: ActivitySettings,
}

impl Default for SteeredArraySettings {
    fn default() -> Self {
        Self {
            frame_s: 0.27,
            hop_s: 0.08,
            response: SteeredSettings::default(),
            noise: NoiseSettings::default(),
            gate_db: 3.0,
            activity: ActivitySettings::default(),
        }
    }
}

/// What is remembered from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteeredState {
    framer: Framer,
    level: NoiseFloor,
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
    /// Signal to noise ratio of the mean of all channels, decibels.
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
        let noise_of_bins = NoiseFloor::of_spectra(
            &settings.noise,
            frames.hop_s(),
            analyzer.bins(),
            analyzer.window_energy(),
        )?;
        Ok(Self {
            gate: 10.0_f32.powf(settings.gate_db / 10.0),
            power: vec![0.0; analyzer.bins()],
            analyzer,
            spectra: Spectra::default(),
            response: SteeredResponse::new(&microphones, transform, array.rate_hz, settings.response)?,
            state: SteeredState {
                spectrum: noise_of_bins,
                level: NoiseFloor::of_frames(&settings.noise, frames.hop_s(), frames.length)?,
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
        self.state.level.check_saved(&state.level)?;
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
            level,
            spectrum,
            activity,
        } = &mut self.state;
        let hop_s = framer.settings().hop_s();
        let (analyzer, spectra, response) = (&mut self.analyzer, &mut self.spectra, &mut self.response);
        let (gate, powers_of_bins) = (self.gate, &mut self.power);
        let mut failed = 0;
        let pushed = framer.push(block, |frame| {
            let powers: f32 = frame.channels.iter().map(|channel| mean_square(channel)).sum();
            let power = powers / frame.channels.len().max(1) as f32;
            let signal_to_noise_db = level.snr_db(power);
            if frame.filled == 0 && level.observe(&[power]).is_err() {
                failed += 1;
            }
            let active = activity.observe(signal_to_noise_db, hop_s).active;
            let observed = analyzer.transform_all(frame.channels, spectra).and_then(|()| {
                mean_power(spectra, powers_of_bins);
                if frame.filled == 0 {
                    spectrum.observe(powers_of_bins)?;
                }
                leave_out_noise(spectra, powers_of_bins, spectrum.power(), gate);
                response.observe(&spectra.channels)
            });
            match observed {
                Ok(()) => each(
                    response,
                    HeardFrame {
                        time: frame.middle(),
                        active,
                        signal_to_noise_db,
                    },
                ),
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
