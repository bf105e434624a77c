//! What a microphone array hears: onsets, voice activity and the correlation of its first pair, or of all pairs over the
//! azimuth.
//!
//! The way of the sound (stac, section 2.2, corrected by E2, E3 and E5): 12 kHz, overlapping frames, signal to noise
//! ratio of both microphones, onset filter, correlation in three bands, agreement of their peaks. Beside it the evidence
//! for deciding who speaks, which needs every frame and not only onsets: [`DirectionPercept`].

use super::azimuth::{AZIMUTHS, AzimuthFan, STEP_RAD, wrapped_rad};
use super::direction::{DirectionPercept, DirectionSettings, DirectionState};
use hearsight_audio::activity::{ActivityDetector, ActivitySettings};
use hearsight_audio::agreement::{Agreement, AgreementSettings};
use hearsight_audio::bands::{BandBank, BandShape, THREE_BANDS};
use hearsight_audio::coherence::NoiseCoherence;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::{Frame, FrameSettings, Framer};
use hearsight_audio::noise::{NoiseFloor, NoiseSettings, mean_square};
use hearsight_audio::onset::{OnsetFilter, OnsetSettings};
use hearsight_audio::resample::{Resampler, ResamplerState};
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, power_into, transform_length};
use hearsight_audio::weighting::{PairNoise, Weighting};
use hearsight_audio::{AudioError, Complex};
use hearsight_core::room::ArraySensor;
use hearsight_core::{AudioBlock, Span, WorldPoint};
use serde::{Deserialize, Serialize};

/// Which pairs of an array are listened to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairs {
    /// The first two microphones: curves over their delay, seconds.
    #[default]
    First,
    /// All pairs together: curves over the azimuth around the array, radians, once all round. Needs three microphones that
    /// do not lie in one line. Correlations are of the whole spectrum.
    All,
}

/// How an array's sound is listened to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArraySettings {
    /// Length of a frame, seconds, 0.01 to 1. Default 0.128: many times the greatest delay, short against walking.
    /// Raising it makes peaks surer and more of it reverberation. The paper does not say.
    pub frame_s: f64,
    /// Time from one frame to the next, seconds, 0.001 to `frame_s`. Default 0.02.
    pub hop_s: f64,
    /// How much each frequency counts. Default: noise-regularized with gamma 0.3 (stac, eq. 7 corrected).
    pub weighting: Weighting,
    /// Whether the correlation is taken in three bands whose peaks must agree. Default true.
    pub bands: bool,
    /// Whether frames that reverberation has caught up with are left out. Default true; false takes every frame.
    pub onset_filter: bool,
    /// What the agreement of bands is.
    pub agreement: AgreementSettings,
    /// How the noise floor is followed.
    pub noise: NoiseSettings,
    /// What an onset is.
    pub onset: OnsetSettings,
    /// When sound counts as voice.
    pub activity: ActivitySettings,
    /// From where the sound comes that decides who speaks.
    pub direction: DirectionSettings,
    /// Which pairs are listened to. Default `first`.
    pub pairs: Pairs,
    /// Whether noise that comes from somewhere, such as that of a fan, is taken out of the cross-spectra. Default false. With
    /// it such noise is not heard between the sounds of speech; where microphones move it does harm.
    pub subtract_noise: bool,
}

impl Default for ArraySettings {
    fn default() -> Self {
        Self {
            frame_s: 0.128,
            hop_s: 0.02,
            weighting: Weighting::NoiseRegularized { gamma: 0.3 },
            bands: true,
            onset_filter: true,
            agreement: AgreementSettings::default(),
            noise: NoiseSettings::default(),
            onset: OnsetSettings::default(),
            activity: ActivitySettings::default(),
            direction: DirectionSettings::default(),
            pairs: Pairs::First,
            subtract_noise: false,
        }
    }
}

impl ArraySettings {
    /// Checks the lengths that memory and time are spent by; the parts check their own settings.
    fn check(&self) -> Result<(), AudioError> {
        let lengths = [
            ("frame_s", self.frame_s, 0.01..=1.0, "within 0.01 and 1"),
            ("hop_s", self.hop_s, 0.001..=1.0, "within 0.001 and 1"),
        ];
        for (name, value, range, rule) in lengths {
            if !range.contains(&value) {
                return Err(AudioError::Setting { name, rule, value });
            }
        }
        Ok(())
    }
}

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

/// What one frame leaves for the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Remembered {
    levels: [NoiseFloor; 2],
    spectra: [NoiseFloor; 2],
    onset: OnsetFilter,
    activity: ActivityDetector,
    coherence: Option<NoiseCoherence>,
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

/// Plans and buffers: nothing of it is remembered.
struct Engine {
    settings: ArraySettings,
    analyzer: SpectrumAnalyzer,
    correlator: Correlator,
    bank: BandBank,
    agreement: Agreement,
    spectra: Spectra,
    /// Of both microphones of the first pair, and means of both: powers, and those of the noise.
    powers: [Vec<f32>; 2],
    power: Vec<f32>,
    noise: Vec<f32>,
    noise_cross: Vec<Complex>,
    curve: CorrelationCurve,
    pair_curve: CorrelationCurve,
    onset_sum: CorrelationCurve,
    onset_frames: u32,
    active: bool,
    signal_to_noise_db: f32,
}

/// The rate at which sound is looked at, samples a second (stac, section 3: f_max = 6 kHz; E5).
const RATE_HZ: u32 = 12_000;

/// For how long the direction of noise is remembered, seconds of noise.
pub(super) const NOISE_MEMORY_S: f64 = 2.0;

/// The first pair, where there is no fan of pairs.
pub(super) const FIRST_PAIR: [[usize; 2]; 1] = [[0, 1]];

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

impl Engine {
    fn begin(&mut self) {
        self.onset_frames = 0;
    }

    /// Looks at one frame.
    fn take(&mut self, frame: &Frame<'_>, remembered: &mut Remembered, fan: Option<&AzimuthFan>, hop_s: f64) {
        let channels = if fan.is_some() { frame.channels.len() } else { 2 };
        if self
            .analyzer
            .transform_all(&frame.channels[..channels], &mut self.spectra)
            .is_err()
        {
            return;
        }
        let mut ratios_db = [0.0; 2];
        for (channel, ratio_db) in ratios_db.iter_mut().enumerate() {
            let power = mean_square(&frame.channels[channel]);
            *ratio_db = remembered.levels[channel].snr_db(power);
            if frame.filled == 0 {
                let powers = &mut self.powers[channel];
                power_into(&self.spectra.channels[channel], powers);
                // Both cannot fail: the number of bins is that of the analyzer they were made for.
                let _ = remembered.levels[channel].observe(&[power]);
                let _ = remembered.spectra[channel].observe(powers);
            }
        }
        if let Some(coherence) = &mut remembered.coherence {
            let [first, second] = remembered.spectra.each_ref().map(NoiseFloor::power);
            mean_into([first, second], &mut self.noise);
            // Without the powers of a frame with samples filled in nothing is known of it: those before are close.
            if frame.filled == 0 {
                mean_into(self.powers.each_ref().map(Vec::as_slice), &mut self.power);
            }
            let pairs = fan.map_or(FIRST_PAIR.as_slice(), AzimuthFan::pairs);
            let powers = [self.power.as_slice(), &self.noise];
            let _ = coherence.observe(&self.spectra.channels, pairs, powers, frame.filled == 0);
        }
        let class = remembered.onset.classify(&ratios_db);
        self.signal_to_noise_db = ratios_db[0].min(ratios_db[1]);
        self.active = remembered
            .activity
            .observe(0.5 * (ratios_db[0] + ratios_db[1]), hop_s)
            .active;
        let noise = PairNoise {
            first: remembered.spectra[0].power(),
            second: remembered.spectra[1].power(),
            cross: None,
        };
        let coherence = remembered.coherence.as_ref();
        let wanted = class.is_onset() || !self.settings.onset_filter;
        let correlated = |engine: &mut Self| match fan {
            Some(fan) => engine.correlate_all(fan, noise, coherence),
            None => engine.correlate(noise, coherence),
        };
        if wanted && correlated(self).is_ok() {
            self.add_onset();
        }
    }

    /// The correlations of all pairs over the azimuth. The noise is taken to be as loud at every microphone as at the first
    /// two: arrays are small against rooms.
    fn correlate_all(
        &mut self,
        fan: &AzimuthFan,
        noise: PairNoise<'_>,
        coherence: Option<&NoiseCoherence>,
    ) -> Result<(), AudioError> {
        self.curve.reset(STEP_RAD, AZIMUTHS / 2);
        let share = 1.0 / fan.pairs().len().max(1) as f32;
        for (number, pair) in fan.pairs().iter().enumerate() {
            let [first, second] = pair.map(|microphone| self.spectra.channels[microphone].as_slice());
            let noise = with_cross(noise, coherence, number, &mut self.noise_cross);
            self.correlator
                .correlate(first, second, Some(noise), None, &mut self.pair_curve)?;
            fan.add(number, &self.pair_curve, share, &mut self.curve);
        }
        Ok(())
    }

    /// The correlation that the sound cue sees: in bands, or of the whole spectrum.
    fn correlate(
        &mut self,
        noise: PairNoise<'_>,
        coherence: Option<&NoiseCoherence>,
    ) -> Result<(), AudioError> {
        let noise = with_cross(noise, coherence, 0, &mut self.noise_cross);
        let [first, second] = [&self.spectra.channels[0], &self.spectra.channels[1]];
        if !self.settings.bands {
            return self
                .correlator
                .correlate(first, second, Some(noise), None, &mut self.curve);
        }
        self.bank
            .correlate(&mut self.correlator, first, second, Some(noise))?;
        self.agreement.combine(&self.bank, &mut self.curve)
    }

    fn add_onset(&mut self) {
        if self.onset_frames == 0 {
            self.onset_sum.step_s = self.curve.step_s;
            self.onset_sum.values.clear();
            self.onset_sum.values.extend_from_slice(&self.curve.values);
        } else {
            for (sum, value) in self.onset_sum.values.iter_mut().zip(&self.curve.values) {
                *sum += value;
            }
        }
        self.onset_frames += 1;
    }

    fn end(&mut self) {
        if self.onset_frames > 0 {
            self.onset_sum.normalize_to_peak();
        }
    }
}

impl Remembered {
    /// Checks what was saved against this.
    fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
        for (floor, saved) in self.levels.iter().zip(&saved.levels) {
            floor.check_saved(saved)?;
        }
        for (floor, saved) in self.spectra.iter().zip(&saved.spectra) {
            floor.check_saved(saved)?;
        }
        self.onset.check_saved(&saved.onset)?;
        self.activity.check_saved(&saved.activity)?;
        check_coherence(self.coherence.as_ref(), saved.coherence.as_ref())
    }
}

/// Checks a saved coherence of the noise against that of the settings.
pub(super) fn check_coherence(
    own: Option<&NoiseCoherence>,
    saved: Option<&NoiseCoherence>,
) -> Result<(), AudioError> {
    match (own, saved) {
        (Some(own), Some(saved)) => own.check_saved(saved),
        (None, None) => Ok(()),
        _ => Err(AudioError::State {
            what: "whether noise is subtracted",
        }),
    }
}

/// The noise of a pair with its cross-spectrum, where its coherence is followed; `cross` is a buffer.
pub(super) fn with_cross<'a>(
    noise: PairNoise<'a>,
    coherence: Option<&NoiseCoherence>,
    pair: usize,
    cross: &'a mut Vec<Complex>,
) -> PairNoise<'a> {
    let Some(coherence) = coherence else { return noise };
    coherence.cross_spectrum(pair, cross);
    PairNoise {
        cross: Some(cross),
        ..noise
    }
}

/// The mean of two spectra of powers.
pub(super) fn mean_into([first, second]: [&[f32]; 2], mean: &mut Vec<f32>) {
    mean.clear();
    mean.extend(
        first
            .iter()
            .zip(second)
            .map(|(first, second)| 0.5 * (first + second)),
    );
}
