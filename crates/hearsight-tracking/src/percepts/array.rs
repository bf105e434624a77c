//! What a microphone array hears: onsets, voice activity and the correlation of its first pair, or of all pairs over the
//! azimuth.
//!
//! The way of the sound (stac, section 2.2, corrected by E2, E3 and E5): 12 kHz, overlapping frames, signal to noise
//! ratio of both microphones, onset filter, correlation in three bands, agreement of their peaks. Beside it the evidence
//! for deciding who speaks, which needs every frame and not only onsets: [`DirectionPercept`].

use super::array_frames::{Engine, Remembered};
use super::array_settings::{ArraySettings, Pairs};
use super::azimuth::{AzimuthFan, wrapped_rad};
use super::direction::{DirectionPercept, DirectionState};
use super::pair_noise::NOISE_MEMORY_S;
use hearsight_audio::AudioError;
use hearsight_audio::activity::ActivityDetector;
use hearsight_audio::agreement::Agreement;
use hearsight_audio::bands::{BandBank, BandShape, THREE_BANDS};
use hearsight_audio::coherence::NoiseCoherence;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{FrameSettings, Framer};
use hearsight_audio::noise::NoiseFloor;
use hearsight_audio::onset::OnsetFilter;
use hearsight_audio::resample::{Resampler, ResamplerState};
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_core::room::ArraySensor;
use hearsight_core::{AudioBlock, Span, WorldPoint};
use serde::{Deserialize, Serialize};

/// What is remembered from moment to moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ArrayState {
    resampler: Option<ResamplerState>,
    listener: Listener,
    direction: DirectionState,
}

/// The part of the state that changes with every frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Listener {
    framer: Framer,
    remembered: Remembered,
}

/// Percepts of one array.
pub struct ArrayPercepts {
    microphones: [WorldPoint; 2],
    speed_of_sound_m_s: f64,
    fan: Option<AzimuthFan>,
    resampler: Option<Resampler>,
    listener: Listener,
    direction: DirectionPercept,
    engine: Engine,
    resampled: AudioBlock,
    ignored: u64,
}

/// The rate at which sound is looked at, samples a second (stac, section 3: f_max = 6 kHz; E5).
const RATE_HZ: u32 = 12_000;

/// Greatest distance of two microphones that are one array, metres: beyond it memory and time grow without use.
const FARTHEST_M: f64 = 60.0;

impl ArrayPercepts {
    /// Percepts of the first two microphones of an array, or of all.
    ///
    /// # Errors
    /// [`AudioError`] where a setting is out of its range or the array has too few microphones.
    pub fn new(
        settings: ArraySettings,
        array: &ArraySensor,
        speed_of_sound_m_s: f64,
    ) -> Result<Self, AudioError> {
        let [first, second] = match array.microphones.as_slice() {
            [first, second, ..] => [*first, *second],
            fewer => {
                return Err(AudioError::Setting {
                    name: "microphones",
                    rule: "two or more",
                    value: fewer.len() as f64,
                });
            }
        };
        settings.check()?;
        let fan = match settings.pairs {
            Pairs::First => None,
            Pairs::All => {
                let fan = AzimuthFan::new(&array.microphones, speed_of_sound_m_s)
                    .filter(|_| array.microphones.len() == array.channels);
                Some(fan.ok_or(AudioError::Setting {
                    name: "microphones",
                    rule: "three or more, not in one line, one a channel",
                    value: array.microphones.len() as f64,
                })?)
            }
        };
        let distance_m = array
            .microphones
            .iter()
            .flat_map(|one| array.microphones.iter().map(|other| one.distance_m(*other)))
            .filter(|_| fan.is_some())
            .fold(first.distance_m(second), f64::max);
        if distance_m.is_nan() || distance_m > FARTHEST_M {
            return Err(AudioError::Setting {
                name: "microphones",
                rule: "within 60 m of each other",
                value: distance_m,
            });
        }
        let samples = |seconds: f64| (seconds * f64::from(RATE_HZ)).round().max(1.0) as usize;
        let frames = FrameSettings {
            length: samples(settings.frame_s),
            hop: samples(settings.hop_s),
            ..FrameSettings::half_overlapping(settings.frame_s, RATE_HZ, array.channels)
        };
        let greatest_s = distance_m / speed_of_sound_m_s;
        let transform = transform_length(frames.length, greatest_s, RATE_HZ);
        let analyzer = SpectrumAnalyzer::new(frames.length, transform, Window::Hann)?;
        let correlator = Correlator::new(CorrelatorSettings {
            weighting: settings.weighting,
            ..CorrelatorSettings::new(transform, RATE_HZ, greatest_s)
        })?;
        let hop_s = frames.hop_s();
        let pairs = fan.as_ref().map_or(1, |fan| fan.pairs().len());
        let coherence = settings
            .subtract_noise
            .then(|| NoiseCoherence::new(pairs, analyzer.bins(), hop_s, NOISE_MEMORY_S))
            .transpose()?;
        let level = NoiseFloor::of_frames(&settings.noise, hop_s, frames.length)?;
        let spectrum =
            NoiseFloor::of_spectra(&settings.noise, hop_s, analyzer.bins(), analyzer.window_energy())?;
        let resampler = if array.rate_hz == RATE_HZ {
            None
        } else {
            Some(Resampler::new(
                array.channels,
                array.rate_hz,
                RATE_HZ,
                frames.longest_fill,
            )?)
        };
        Ok(Self {
            microphones: [first, second],
            speed_of_sound_m_s,
            resampler,
            listener: Listener {
                framer: Framer::new(frames)?,
                remembered: Remembered {
                    levels: [level.clone(), level],
                    spectra: [spectrum.clone(), spectrum],
                    onset: OnsetFilter::new(settings.onset)?,
                    activity: ActivityDetector::new(settings.activity)?,
                    coherence,
                },
            },
            direction: DirectionPercept::new(
                settings.direction,
                &settings.noise,
                RATE_HZ,
                array.channels,
                greatest_s,
                fan.clone(),
                settings.subtract_noise,
            )?,
            fan,
            engine: Engine {
                bank: BandBank::new(&THREE_BANDS, BandShape::default(), RATE_HZ, transform)?,
                agreement: Agreement::new(settings.agreement)?,
                settings,
                analyzer,
                correlator,
                spectra: Spectra::default(),
                powers: Default::default(),
                power: Vec::new(),
                noise: Vec::new(),
                noise_cross: Vec::new(),
                curve: CorrelationCurve::default(),
                pair_curve: CorrelationCurve::default(),
                onset_sum: CorrelationCurve::default(),
                onset_frames: 0,
                active: false,
                signal_to_noise_db: 0.0,
            },
            resampled: AudioBlock::default(),
            ignored: 0,
        })
    }

    /// Whether the pairs of an array lie in two directions, so that all together tell azimuths all round.
    pub fn hears_around(array: &ArraySensor) -> bool {
        array.microphones.len() == array.channels && AzimuthFan::new(&array.microphones, 343.0).is_some()
    }

    /// What is remembered.
    pub fn state(&self) -> ArrayState {
        ArrayState {
            resampler: self.resampler.as_ref().map(|resampler| resampler.state().clone()),
            listener: self.listener.clone(),
            direction: self.direction.state(),
        }
    }

    /// Checks what was remembered: whether this array with these settings could have left it.
    ///
    /// # Errors
    /// [`AudioError`] where the state is that of another array or contradicts itself.
    pub fn check_state(&self, state: &ArrayState) -> Result<(), AudioError> {
        match (&self.resampler, &state.resampler) {
            (Some(resampler), Some(saved)) => resampler.check_saved(saved)?,
            (None, None) => {}
            _ => {
                return Err(AudioError::State {
                    what: "the rate of the sound",
                });
            }
        }
        self.listener.framer.check_saved(&state.listener.framer)?;
        self.listener.remembered.check_saved(&state.listener.remembered)?;
        self.direction.check_state(&state.direction)
    }

    /// Goes on from what was remembered.
    ///
    /// # Errors
    /// As [`ArrayPercepts::check_state`]; nothing is changed then.
    pub fn set_state(&mut self, state: ArrayState) -> Result<(), AudioError> {
        self.check_state(&state)?;
        if let (Some(resampler), Some(remembered)) = (&mut self.resampler, state.resampler) {
            resampler.restore(remembered)?;
        }
        self.listener = state.listener;
        self.direction.set_state(state.direction);
        Ok(())
    }

    /// Takes in the samples of a moment, or `None` where there are none. What was heard before is forgotten.
    pub fn hear(&mut self, block: Option<&AudioBlock>) {
        self.engine.begin();
        self.direction.begin();
        let Some(block) = block else { return };
        let block = match &mut self.resampler {
            Some(resampler) => {
                if resampler.process(block, &mut self.resampled).is_err() {
                    self.ignored += 1;
                    return;
                }
                &self.resampled
            }
            None => block,
        };
        let Listener { framer, remembered } = &mut self.listener;
        let (engine, fan) = (&mut self.engine, self.fan.as_ref());
        let hop_s = framer.settings().hop_s();
        let framed = framer.push(block, |frame| engine.take(&frame, remembered, fan, hop_s));
        if framed.and(self.direction.hear(block)).is_err() {
            self.ignored += 1;
        }
        engine.end();
    }

    /// From where the sound of this moment comes.
    pub fn direction(&self) -> &DirectionPercept {
        &self.direction
    }

    /// Whether there is a frame in this moment whose correlation the sound cue may use.
    pub fn has_onset(&self) -> bool {
        self.engine.onset_frames > 0
    }

    /// Whether a frame of this moment holds sound above the room's noise.
    pub fn has_sound(&self) -> bool {
        self.direction().sound_s() > 0.0
    }

    /// Height of the normalized correlation at a delay (or azimuth, [`Pairs::All`]), 0 to 1 (R_n, stac, eq. 8 corrected).
    pub fn onset_height(&self, delay_s: f64) -> f32 {
        self.engine.onset_sum.at(delay_s).clamp(0.0, 1.0)
    }

    /// Whether curves go once all round: they are over the azimuth, radians, and their ends are neighbours.
    pub fn is_circular(&self) -> bool {
        self.fan.is_some()
    }

    /// From one delay to another, seconds; from one azimuth to another the short way round, radians.
    pub fn difference(&self, from: f64, to: f64) -> f64 {
        if self.is_circular() {
            wrapped_rad(to - from)
        } else {
            to - from
        }
    }

    /// The normalized correlation of this moment.
    pub fn onset_curve(&self) -> &CorrelationCurve {
        &self.engine.onset_sum
    }

    /// Delay (or azimuth) of the highest peak of the normalized correlation of this moment, seconds, t_i - t_j.
    pub fn onset_delay_s(&self) -> Option<f64> {
        if self.has_onset() {
            self.engine.onset_sum.peak().map(|peak| peak.delay_s)
        } else {
            None
        }
    }

    /// Delay between the first two microphones of what is heard at a place of the curves, seconds.
    pub fn first_delay_s(&self, place: f64) -> f64 {
        let first = self.fan.as_ref().and_then(|fan| {
            let pair = fan.pairs().iter().position(|pair| *pair == [0, 1])?;
            Some(fan.delay_s(pair, place))
        });
        first.unwrap_or(if self.is_circular() { 0.0 } else { place })
    }

    /// Whether there is a voice now, as far as energy tells.
    pub fn is_active(&self) -> bool {
        self.engine.active
    }

    /// Smaller signal to noise ratio of both microphones, decibels, of the newest frame.
    pub fn signal_to_noise_db(&self) -> f32 {
        self.engine.signal_to_noise_db
    }

    /// Greatest delay that the spacing of the microphones allows, seconds.
    pub fn greatest_delay_s(&self) -> f64 {
        self.microphones[0].distance_m(self.microphones[1]) / self.speed_of_sound_m_s
    }

    /// Where a sound from a point is on the curves: its delay t_i - t_j, seconds, or its azimuth, radians
    /// ([`Pairs::All`]); `None` for a point that is not finite.
    pub fn delay_s(&self, point: WorldPoint) -> Option<f64> {
        if let Some(fan) = &self.fan {
            return fan.azimuth_rad(point).filter(|azimuth| azimuth.is_finite());
        }
        let [first, second] = self.microphones;
        let delay_s = (point.distance_m(first) - point.distance_m(second)) / self.speed_of_sound_m_s;
        delay_s.is_finite().then_some(delay_s)
    }

    /// Blocks that could not be used since the start.
    pub fn ignored(&self) -> u64 {
        self.ignored
    }

    /// How long sound takes from its arrival to its percept at the most: one frame and the resampler's delay.
    pub fn latency(&self) -> Span {
        let frame = Span::from_seconds(self.engine.settings.frame_s);
        self.resampler
            .as_ref()
            .map_or(frame, |resampler| frame + resampler.latency())
    }
}
