//! From where the sound of a moment comes: the likelihood of every delay of a pair, in a scale that adds up.
//!
//! The phases of the cross-spectrum of a frame scatter about those of the true delay. With a von Mises distribution of
//! concentration kappa a bin, the logarithm of the likelihood ratio of a delay tau against sound from everywhere is
//! sum_f kappa_f cos(phase_f + 2 pi f tau): the phase transform itself, scaled. Where reverberation is stronger than the
//! direct sound kappa is small, kappa_f = 2 times the mean cosine, and independent bins and frames add up; here kappa_f is
//! also in proportion to the share of direct sound in the bin ([`DirectShare`]), so that onsets count most.
//!
//! Frames are short and overlap by half: they are nearly independent, and a new voice is heard soon.

use super::azimuth::{AZIMUTHS, AzimuthFan, STEP_RAD};
use super::pair_noise::{FIRST_PAIR, NOISE_MEMORY_S, check_coherence, mean_into};
use hearsight_audio::coherence::NoiseCoherence;
use hearsight_audio::correlation::{Correlator, CorrelatorSettings, Normalization};
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::direct::{DirectSettings, DirectShare};
use hearsight_audio::frames::{Frame, FrameSettings, Framer};
use hearsight_audio::noise::{NoiseFloor, NoiseSettings, mean_square};
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, bin_range, power_into, transform_length};
use hearsight_audio::weighting::PairNoise;
use hearsight_audio::{AudioError, Complex};
use hearsight_core::AudioBlock;
use serde::{Deserialize, Serialize};

/// How the direction of a voice is heard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DirectionSettings {
    /// Length of a frame, seconds, 0.005 to 1. Default 0.032: many times the greatest delay of a metre, as short as
    /// the sounds of speech. Frames follow each other by half of it.
    pub frame_s: f64,
    /// Lowest frequency that counts, hertz. Default 200: below it rooms hum.
    pub low_hz: f64,
    /// Mean cosine of the phase errors where all of a bin is new sound, 0 to 1. Default 0.07: direct sound 10 dB below
    /// its reverberation, some metres away in a room without curtains. Raising it decides sooner and less surely.
    pub clarity: f64,
    /// Signal to noise ratio from which there is sound, decibels, at every microphone. Default 6. -100 takes every frame for
    /// sound, which suits rooms that are as loud as their talkers; directions alone tell then whether anybody speaks, and the
    /// rate of silence of the decision should be 0.
    pub sound_db: f32,
    /// Signal to noise ratio below which there is silence, decibels. Default 3.
    pub silence_db: f32,
    /// What is known of the room's reverberation.
    pub room: DirectSettings,
}

impl Default for DirectionSettings {
    fn default() -> Self {
        Self {
            frame_s: 0.032,
            low_hz: 200.0,
            clarity: 0.07,
            sound_db: 6.0,
            silence_db: 3.0,
            room: DirectSettings::default(),
        }
    }
}

/// What is remembered from frame to frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DirectionState {
    framer: Framer,
    remembered: Remembered,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Remembered {
    levels: [NoiseFloor; 2],
    spectra: [NoiseFloor; 2],
    share: DirectShare,
    coherence: Option<NoiseCoherence>,
}

/// Hears directions with the first two microphones of an array, or with all of them over the azimuth.
pub struct DirectionPercept {
    state: DirectionState,
    engine: Engine,
    fan: Option<AzimuthFan>,
}

/// Plans and buffers: nothing of it is remembered.
struct Engine {
    settings: DirectionSettings,
    analyzer: SpectrumAnalyzer,
    correlator: Correlator,
    hop_s: f64,
    /// Mean of the squared coherence between bins, summed over bins: how many bins tell the same.
    same: f64,
    first_bin: usize,
    spectra: Spectra,
    powers: [Vec<f32>; 2],
    power: Vec<f32>,
    noise: Vec<f32>,
    noise_cross: Vec<Complex>,
    share: Vec<f32>,
    curve: CorrelationCurve,
    pair_curve: CorrelationCurve,
    log_ratio: CorrelationCurve,
    sound_s: f64,
    silence_s: f64,
}

impl DirectionPercept {
    /// A percept of sound at `rate_hz`, of delays up to `greatest_s`, of the first pair or of all pairs of a fan.
    /// `subtract_noise` as in [`super::ArraySettings`].
    ///
    /// # Errors
    /// [`AudioError`] where a setting is out of its range.
    pub(super) fn new(
        settings: DirectionSettings,
        noise: &NoiseSettings,
        rate_hz: u32,
        channels: usize,
        greatest_s: f64,
        fan: Option<AzimuthFan>,
        subtract_noise: bool,
    ) -> Result<Self, AudioError> {
        let holds = (0.005..=1.0).contains(&settings.frame_s);
        check(holds, "frame_s", "within 0.005 and 1", settings.frame_s)?;
        let holds = (0.0..=1.0).contains(&settings.clarity);
        check(holds, "clarity", "within 0 and 1", settings.clarity)?;
        let holds = settings.silence_db <= settings.sound_db;
        check(
            holds,
            "silence_db",
            "at most sound_db",
            settings.silence_db.into(),
        )?;
        let frames = FrameSettings::half_overlapping(settings.frame_s, rate_hz, channels);
        let transform = transform_length(frames.length, greatest_s, rate_hz);
        let analyzer = SpectrumAnalyzer::new(frames.length, transform, Window::Hann)?;
        let correlator = Correlator::new(CorrelatorSettings {
            interpolation: 4,
            normalization: Normalization::None,
            ..CorrelatorSettings::new(transform, rate_hz, greatest_s)
        })?;
        let bins = analyzer.bins();
        let hop_s = frames.hop_s();
        let pairs = fan.as_ref().map_or(1, |fan| fan.pairs().len());
        let coherence = subtract_noise
            .then(|| NoiseCoherence::new(pairs, bins, hop_s, NOISE_MEMORY_S))
            .transpose()?;
        let level = NoiseFloor::of_frames(noise, hop_s, frames.length)?;
        let spectrum = NoiseFloor::of_spectra(noise, hop_s, bins, analyzer.window_energy())?;
        let fourth: f32 = Window::Hann
            .coefficients(frames.length)
            .iter()
            .map(|w| w.powi(4))
            .sum();
        // By Parseval: what bins k apart share is the transform of the squared window.
        let same =
            transform as f64 * f64::from(fourth) / f64::from(analyzer.window_energy()).powi(2).max(1e-9);
        Ok(Self {
            fan,
            state: DirectionState {
                framer: Framer::new(frames)?,
                remembered: Remembered {
                    levels: [level.clone(), level],
                    spectra: [spectrum.clone(), spectrum],
                    share: DirectShare::new(&settings.room, hop_s, bins)?,
                    coherence,
                },
            },
            engine: Engine {
                first_bin: bin_range(settings.low_hz, f64::INFINITY, rate_hz, transform)
                    .start
                    .max(1),
                settings,
                analyzer,
                correlator,
                hop_s,
                same,
                spectra: Spectra::default(),
                powers: [vec![0.0; bins], vec![0.0; bins]],
                power: vec![0.0; bins],
                noise: vec![0.0; bins],
                noise_cross: Vec::with_capacity(bins),
                share: vec![0.0; bins],
                curve: CorrelationCurve::default(),
                pair_curve: CorrelationCurve::default(),
                log_ratio: CorrelationCurve::default(),
                sound_s: 0.0,
                silence_s: 0.0,
            },
        })
    }

    /// What is remembered.
    pub fn state(&self) -> DirectionState {
        self.state.clone()
    }

    /// Checks what was remembered: whether this percept could have left it.
    ///
    /// # Errors
    /// [`AudioError`] where it is of other settings or contradicts itself.
    pub fn check_state(&self, state: &DirectionState) -> Result<(), AudioError> {
        self.state.framer.check_saved(&state.framer)?;
        let (own, saved) = (&self.state.remembered, &state.remembered);
        for (floor, saved) in own.levels.iter().zip(&saved.levels) {
            floor.check_saved(saved)?;
        }
        for (floor, saved) in own.spectra.iter().zip(&saved.spectra) {
            floor.check_saved(saved)?;
        }
        own.share.check_saved(&saved.share)?;
        check_coherence(own.coherence.as_ref(), saved.coherence.as_ref())
    }

    /// Goes on from what was remembered; to be checked before by [`DirectionPercept::check_state`].
    pub fn set_state(&mut self, state: DirectionState) {
        self.state = state;
    }

    /// Forgets the moment before.
    pub(super) fn begin(&mut self) {
        self.engine.sound_s = 0.0;
        self.engine.silence_s = 0.0;
    }

    /// Takes in the samples of a moment.
    ///
    /// # Errors
    /// [`AudioError`] where the block is not that of this array; it is ignored then.
    pub(super) fn hear(&mut self, block: &AudioBlock) -> Result<(), AudioError> {
        let DirectionState { framer, remembered } = &mut self.state;
        let (engine, fan) = (&mut self.engine, self.fan.as_ref());
        framer.push(block, |frame| engine.take(&frame, remembered, fan))
    }

    /// Seconds of this moment's frames that hold sound.
    pub fn sound_s(&self) -> f64 {
        self.engine.sound_s
    }

    /// Seconds of this moment's frames that are silent.
    pub fn silence_s(&self) -> f64 {
        self.engine.silence_s
    }

    /// Whether the curve is over the azimuth, radians, once all round, instead of delays, seconds.
    pub fn is_circular(&self) -> bool {
        self.fan.is_some()
    }

    /// The logarithm of the likelihood ratio of each delay against sound from everywhere, given the frames of this
    /// moment; says nothing, and may be of an earlier moment, where [`DirectionPercept::sound_s`] is 0.
    pub fn log_ratio(&self) -> &CorrelationCurve {
        &self.engine.log_ratio
    }
}

/// A setting out of its range.
fn check(holds: bool, name: &'static str, rule: &'static str, value: f64) -> Result<(), AudioError> {
    if holds {
        Ok(())
    } else {
        Err(AudioError::Setting { name, rule, value })
    }
}

impl Engine {
    fn take(&mut self, frame: &Frame<'_>, remembered: &mut Remembered, fan: Option<&AzimuthFan>) {
        let channels = if fan.is_some() { frame.channels.len() } else { 2 };
        if self
            .analyzer
            .transform_all(&frame.channels[..channels], &mut self.spectra)
            .is_err()
        {
            return;
        }
        let mut ratio_db = f32::INFINITY;
        for (channel, powers) in self.powers.iter_mut().enumerate() {
            let power = mean_square(&frame.channels[channel]);
            ratio_db = ratio_db.min(remembered.levels[channel].snr_db(power));
            power_into(&self.spectra.channels[channel], powers);
            if frame.filled == 0 {
                // Both cannot fail: the number of bins is that of the analyzer they were made for.
                let _ = remembered.levels[channel].observe(&[power]);
                let _ = remembered.spectra[channel].observe(powers);
            }
        }
        mean_into(self.powers.each_ref().map(Vec::as_slice), &mut self.power);
        mean_into(
            remembered.spectra.each_ref().map(NoiseFloor::power),
            &mut self.noise,
        );
        if let Some(coherence) = &mut remembered.coherence {
            let pairs = fan.map_or(FIRST_PAIR.as_slice(), AzimuthFan::pairs);
            let powers = [self.power.as_slice(), &self.noise];
            let _ = coherence.observe(&self.spectra.channels, pairs, powers, frame.filled == 0);
        }
        // Cannot fail either; reverberation is followed through silence too.
        let _ = remembered
            .share
            .observe(&self.power, &self.noise, &mut self.share);
        if ratio_db >= self.settings.sound_db {
            self.add(fan, remembered.coherence.as_ref());
        } else if ratio_db < self.settings.silence_db {
            self.silence_s += self.hop_s;
        }
    }

    /// Adds what the frame says of every delay.
    fn add(&mut self, fan: Option<&AzimuthFan>, coherence: Option<&NoiseCoherence>) {
        self.share[..self.first_bin].fill(0.0);
        if self.correlate(fan, coherence).is_err() {
            return;
        }
        // The curve is twice the sum of cosines over the transform's length. Of the kappas of bins that tell the same
        // only one counts; half of kappa squared is what a delay without any sound loses in the mean.
        let kappa = 2.0 * self.settings.clarity / self.same;
        let scale = (0.5 * kappa * self.correlator.settings().transform_length as f64) as f32;
        let squares: f32 = self.share.iter().map(|share| share * share).sum();
        let loss = (0.25 * kappa * kappa * self.same * f64::from(squares)) as f32;
        // Of the pairs of n microphones n - 1 tell something of their own: the mean of all counts so often.
        let pairs = fan.map_or(1.0, |_| self.spectra.channels.len().saturating_sub(1) as f32);
        if self.sound_s == 0.0 {
            self.log_ratio
                .reset(self.curve.step_s, self.curve.values.len() / 2);
        }
        for (sum, value) in self.log_ratio.values.iter_mut().zip(&self.curve.values) {
            *sum += pairs * (scale * value - loss);
        }
        self.sound_s += self.hop_s;
    }

    /// The curve of the pair, or the mean of all pairs over the azimuth.
    fn correlate(
        &mut self,
        fan: Option<&AzimuthFan>,
        coherence: Option<&NoiseCoherence>,
    ) -> Result<(), AudioError> {
        let pairs = fan.map_or(FIRST_PAIR.as_slice(), AzimuthFan::pairs);
        if fan.is_some() {
            self.curve.reset(STEP_RAD, AZIMUTHS / 2);
        }
        for (number, pair) in pairs.iter().enumerate() {
            let [first, second] = pair.map(|microphone| self.spectra.channels[microphone].as_slice());
            let noise = coherence.map(|coherence| {
                coherence.cross_spectrum(number, &mut self.noise_cross);
                PairNoise {
                    first: &self.noise,
                    second: &self.noise,
                    cross: Some(&self.noise_cross),
                }
            });
            let curve = match fan {
                Some(_) => &mut self.pair_curve,
                None => &mut self.curve,
            };
            self.correlator
                .correlate(first, second, noise, Some(&self.share), curve)?;
            if let Some(fan) = fan {
                let share = 1.0 / pairs.len().max(1) as f32;
                fan.add(number, &self.pair_curve, share, &mut self.curve);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::{Instant, Span};

    const RATE_HZ: u32 = 12_000;

    /// Repeatable noise, -1 to 1.
    fn noise(index: i64, seed: u64) -> f32 {
        let mut x = (index as u64)
            .wrapping_mul(0x9E37_79B9_7F4A_7C15)
            .wrapping_add(seed.wrapping_mul(0xD1B5_4A32_D192_ED03));
        x ^= x >> 31;
        x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x ^= x >> 29;
        (x >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn percept() -> DirectionPercept {
        DirectionPercept::new(
            DirectionSettings::default(),
            &NoiseSettings::default(),
            RATE_HZ,
            2,
            0.0028,
            None,
            false,
        )
        .unwrap()
    }

    /// Block `number` of 40 ms: faint noise, and from block 50 on a sound that reaches the first microphone `delay`
    /// samples after the second, or sound without a direction.
    fn block(number: i64, delay: Option<i64>) -> AudioBlock {
        let channel = |microphone: i64| {
            (0..480)
                .map(|k| {
                    let at = number * 480 + k;
                    let hiss = 1e-3 * noise(at, 7 + microphone as u64);
                    let loud = if number < 50 { 0.0 } else { 0.1 };
                    match delay {
                        Some(delay) => hiss + loud * noise(at - (1 - microphone) * delay, 1),
                        None => hiss + loud * noise(at, 3 + microphone as u64),
                    }
                })
                .collect()
        };
        AudioBlock {
            time: Instant::ZERO + Span::of_samples(number * 480, RATE_HZ),
            rate_hz: RATE_HZ,
            channels: vec![channel(0), channel(1)],
        }
    }

    fn hear(percept: &mut DirectionPercept, block: &AudioBlock) {
        percept.begin();
        percept.hear(block).unwrap();
    }

    #[test]
    fn an_onset_points_at_its_delay_and_silence_is_silent() {
        let mut percept = percept();
        for number in 0..50 {
            hear(&mut percept, &block(number, Some(9)));
            assert_eq!(percept.sound_s(), 0.0, "block {number}");
        }
        assert!(percept.silence_s() > 0.03);
        hear(&mut percept, &block(50, Some(9)));
        hear(&mut percept, &block(51, Some(9)));
        assert!(percept.sound_s() > 0.03);
        let curve = percept.log_ratio();
        let peak = curve.peak().unwrap();
        assert!((peak.delay_s - 9.0 / f64::from(RATE_HZ)).abs() < 1e-5, "{peak:?}");
        // The other side hears nothing: it loses.
        assert!(peak.value > 3.0 && curve.at(-0.001) < 0.5, "{}", curve.at(-0.001));
    }

    #[test]
    fn sound_from_everywhere_favours_no_delay() {
        let mut percept = percept();
        let mut means = Vec::new();
        for number in 0..75 {
            hear(&mut percept, &block(number, None));
            if percept.sound_s() > 0.0 {
                let values = &percept.log_ratio().values;
                // A likelihood ratio has the mean 1 over what its denominator gives.
                means.push(values.iter().map(|value| value.exp()).sum::<f32>() / values.len() as f32);
            }
        }
        assert!(means.len() > 20);
        let mean = means.iter().sum::<f32>() / means.len() as f32;
        assert!((0.7..1.3).contains(&mean), "{mean}");
    }

    #[test]
    fn a_saved_percept_goes_on() {
        let mut first = percept();
        for number in 0..52 {
            hear(&mut first, &block(number, Some(-4)));
        }
        let mut second = percept();
        second.set_state(first.state());
        for number in 52..55 {
            hear(&mut first, &block(number, Some(-4)));
            hear(&mut second, &block(number, Some(-4)));
            assert_eq!(first.log_ratio(), second.log_ratio());
        }
        let wrong = DirectionSettings {
            clarity: 2.0,
            ..DirectionSettings::default()
        };
        assert!(
            DirectionPercept::new(wrong, &NoiseSettings::default(), RATE_HZ, 2, 0.0028, None, false).is_err()
        );
    }
}
