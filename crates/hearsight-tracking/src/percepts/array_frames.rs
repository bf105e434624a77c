//! What is made of each frame of an array: levels, onset, voice activity, and the correlation of its pairs.

use super::array_settings::ArraySettings;
use super::azimuth::{AZIMUTHS, AzimuthFan, STEP_RAD};
use super::pair_noise::{FIRST_PAIR, check_coherence, mean_into};
use hearsight_audio::activity::ActivityDetector;
use hearsight_audio::agreement::Agreement;
use hearsight_audio::bands::BandBank;
use hearsight_audio::coherence::NoiseCoherence;
use hearsight_audio::correlation::Correlator;
use hearsight_audio::curve::CorrelationCurve;
use hearsight_audio::frames::Frame;
use hearsight_audio::noise::{NoiseFloor, mean_square};
use hearsight_audio::onset::OnsetFilter;
use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, power_into};
use hearsight_audio::weighting::PairNoise;
use hearsight_audio::{AudioError, Complex};
use serde::{Deserialize, Serialize};

/// What one frame leaves for the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Remembered {
    pub(super) levels: [NoiseFloor; 2],
    pub(super) spectra: [NoiseFloor; 2],
    pub(super) onset: OnsetFilter,
    pub(super) activity: ActivityDetector,
    pub(super) coherence: Option<NoiseCoherence>,
}

/// Plans and buffers: nothing of it is remembered.
pub(super) struct Engine {
    pub(super) settings: ArraySettings,
    pub(super) analyzer: SpectrumAnalyzer,
    pub(super) correlator: Correlator,
    pub(super) bank: BandBank,
    pub(super) agreement: Agreement,
    pub(super) spectra: Spectra,
    /// Of both microphones of the first pair, and means of both: powers, and those of the noise.
    pub(super) powers: [Vec<f32>; 2],
    pub(super) power: Vec<f32>,
    pub(super) noise: Vec<f32>,
    pub(super) noise_cross: Vec<Complex>,
    pub(super) curve: CorrelationCurve,
    pub(super) pair_curve: CorrelationCurve,
    pub(super) onset_sum: CorrelationCurve,
    pub(super) onset_frames: u32,
    pub(super) active: bool,
    pub(super) signal_to_noise_db: f32,
}

impl Engine {
    pub(super) fn begin(&mut self) {
        self.onset_frames = 0;
    }

    /// Looks at one frame.
    pub(super) fn take(
        &mut self,
        frame: &Frame<'_>,
        remembered: &mut Remembered,
        fan: Option<&AzimuthFan>,
        hop_s: f64,
    ) {
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
        // Of a frame with samples filled in nothing is learnt, and the noise is as it was.
        if let Some(coherence) = remembered.coherence.as_mut().filter(|_| frame.filled == 0) {
            mean_into(
                remembered.spectra.each_ref().map(NoiseFloor::power),
                &mut self.noise,
            );
            mean_into(self.powers.each_ref().map(Vec::as_slice), &mut self.power);
            let pairs = fan.map_or(FIRST_PAIR.as_slice(), AzimuthFan::pairs);
            let powers = [self.power.as_slice(), &self.noise];
            let _ = coherence.observe(&self.spectra.channels, pairs, powers, true);
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

    pub(super) fn end(&mut self) {
        if self.onset_frames > 0 {
            self.onset_sum.normalize_to_peak();
        }
    }
}

impl Remembered {
    /// Checks what was saved against this.
    pub(super) fn check_saved(&self, saved: &Self) -> Result<(), AudioError> {
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

/// The noise of a pair with its cross-spectrum, where its coherence is followed; `cross` is a buffer.
fn with_cross<'a>(
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
