//! From phones to samples: a voice through a row of resonances, noises beside it (formant synthesis, Klatt 1980).

use super::TalkerTraits;
use super::phones::Phone;
use crate::acoustics::random::{Generator, between, generator, normal};
use crate::voice::speech::{MOUTH_S, smooth};

/// Seconds between two settings of source and tract.
pub(crate) const CONTROL_S: f32 = 0.005;
/// Settings are interpolated to steps of so many samples.
const STEP: usize = 16;

/// Source and tract over time, every [`CONTROL_S`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    formants_hz: [Vec<f32>; 3],
    voice: Vec<f32>,
    breath: Vec<f32>,
    friction: Vec<f32>,
    friction_hz: Vec<f32>,
    friction_width_hz: Vec<f32>,
    pub(crate) pitch_hz: Vec<f32>,
    mouth: Vec<f32>,
}

impl Score {
    /// Settings so far.
    pub(crate) fn len(&self) -> usize {
        self.voice.len()
    }

    /// Appends a phone of a length.
    pub(crate) fn push(&mut self, phone: &Phone, length_s: f32) {
        let count = (length_s / CONTROL_S).round().max(1.0) as usize;
        let end = self.len() + count;
        for (formant, hz) in self.formants_hz.iter_mut().zip(phone.formants_hz) {
            formant.resize(end, hz);
        }
        self.voice.resize(end, phone.voice);
        self.breath.resize(end, phone.breath);
        // What is sudden must survive the smoothing: doubled, and cut to its length by the short window.
        self.friction.resize(
            end,
            if phone.sudden {
                2.0 * phone.friction
            } else {
                phone.friction
            },
        );
        self.friction_hz.resize(end, phone.friction_hz);
        self.friction_width_hz.resize(end, phone.friction_width_hz);
        self.mouth.resize(end, phone.mouth);
    }

    /// Lets each setting take the time that lips and tongue take.
    pub(crate) fn articulate(&mut self) {
        for formant in &mut self.formants_hz {
            *formant = smooth(formant, 4);
        }
        self.voice = smooth(&self.voice, 2);
        self.breath = smooth(&self.breath, 1);
        self.friction = smooth(&self.friction, 1);
        self.mouth = smooth(&self.mouth, 6);
    }

    /// Opening of the mouth every [`MOUTH_S`].
    pub(crate) fn mouth(&self) -> Vec<f32> {
        let step = (MOUTH_S / f64::from(CONTROL_S)).round() as usize;
        self.mouth.iter().step_by(step).copied().collect()
    }
}

/// A resonance of gain 1 at 0 Hz.
#[derive(Clone, Copy, Debug, Default)]
struct Resonance {
    a: f32,
    b: f32,
    c: f32,
    memory: [f32; 2],
}

impl Resonance {
    fn tune(&mut self, frequency_hz: f32, width_hz: f32, rate_hz: f32) {
        let radius = (-std::f32::consts::PI * width_hz / rate_hz).exp();
        self.c = -radius * radius;
        self.b = 2.0 * radius * (std::f32::consts::TAU * frequency_hz / rate_hz).cos();
        self.a = 1.0 - self.b - self.c;
    }

    /// Tunes it so that white noise of variance 1 keeps its variance.
    fn tune_to_noise(&mut self, frequency_hz: f32, width_hz: f32, rate_hz: f32) {
        self.tune(frequency_hz, width_hz, rate_hz);
        let (b, c) = (self.b, self.c);
        let variance = (1.0 - c) / ((1.0 + c) * ((1.0 - c) * (1.0 - c) - b * b)).max(1e-9);
        self.a = 1.0 / variance.sqrt();
    }

    fn next(&mut self, input: f32) -> f32 {
        let output = self.a * input + self.b * self.memory[0] + self.c * self.memory[1];
        self.memory = [output, self.memory[0]];
        output
    }
}

/// The folds: the derivative of the flow through them, pulse by pulse (Rosenberg 1971, with a rounded closure).
struct Folds {
    /// Place within the pulse, 0 to 1.
    phase: f32,
    /// This pulse's strength and speed over the usual ones.
    strength: f32,
    hurry: f32,
    random: Generator,
}

impl Folds {
    fn next(&mut self, pitch_hz: f32, traits: &TalkerTraits, rate_hz: f32) -> f32 {
        self.phase += pitch_hz * self.hurry / rate_hz;
        if self.phase >= 1.0 {
            self.phase -= 1.0;
            // Jitter and shimmer of healthy voices.
            self.hurry = 1.0 + traits.jitter * normal(&mut self.random).clamp(-3.0, 3.0) as f32;
            self.strength = 1.0 + traits.shimmer * normal(&mut self.random).clamp(-3.0, 3.0) as f32;
        }
        let opening = 0.66 * traits.open_share;
        let closing = 0.34 * traits.open_share;
        let closed = opening + closing;
        let rounding = traits.closure;
        // As much flow comes as goes.
        let rise = (closing * 2.0 / std::f32::consts::PI + rounding) * std::f32::consts::PI / (2.0 * opening);
        let value = if self.phase < opening {
            rise * (std::f32::consts::PI * self.phase / opening).sin()
        } else if self.phase < closed {
            -(std::f32::consts::FRAC_PI_2 * (self.phase - opening) / closing).sin()
        } else {
            -(-(self.phase - closed) / rounding).exp()
        };
        value * self.strength
    }
}

/// Samples of a score, at no particular level.
pub(crate) fn sing(score: &Score, traits: &TalkerTraits, rate_hz: u32, seed: u64) -> Vec<f32> {
    let rate = rate_hz as f32;
    let per_control = CONTROL_S * rate;
    let count = (score.len() as f32 * per_control) as usize;
    let mut folds = Folds {
        phase: 0.0,
        strength: 1.0,
        hurry: 1.0,
        random: generator(seed, "folds", 0),
    };
    let mut noise = generator(seed, "breath", 0);
    let mut hiss = generator(seed, "friction", 0);
    let mut upper = upper_formants(traits, rate);
    let mut lower = [Resonance::default(); 3];
    let mut passage = Resonance::default();
    let mut color = 0.0;
    let mut samples = Vec::with_capacity(count);
    while samples.len() < count {
        let place = samples.len() as f32 / per_control;
        let at = |values: &[f32]| {
            let index = place as usize;
            let from = values.get(index).copied().unwrap_or(0.0);
            let to = values.get(index + 1).copied().unwrap_or(from);
            from + (place - index as f32) * (to - from)
        };
        for (number, resonance) in lower.iter_mut().enumerate() {
            let hz = at(&score.formants_hz[number]) * traits.formants[number];
            let width = [60.0, 90.0, 150.0][number] * traits.width * (1.0 + hz / 6000.0);
            resonance.tune(hz.min(0.47 * rate), width, rate);
        }
        let scale = traits.formants[3];
        let friction_hz = (at(&score.friction_hz) * (0.5 + 0.5 * scale)).min(0.46 * rate);
        passage.tune_to_noise(friction_hz, at(&score.friction_width_hz), rate);
        let (voice, breath) = (
            at(&score.voice),
            at(&score.breath) + traits.breath * at(&score.voice),
        );
        let (friction, pitch) = (at(&score.friction), at(&score.pitch_hz));
        for _ in 0..STEP.min(count - samples.len()) {
            let mut sound = 0.0;
            if voice > 1e-4 {
                sound += voice * folds.next(pitch, traits, rate);
            }
            if breath > 1e-4 {
                sound += 0.35 * breath * white(&mut noise);
            }
            for resonance in lower.iter_mut().chain(&mut upper) {
                sound = resonance.next(sound);
            }
            if friction > 1e-4 {
                // As strong beside the voice, whatever the rate: noise is spread over more of it at a higher one.
                sound += traits.friction * friction * passage.next(white(&mut hiss));
            }
            // The slope that tells bright voices from dark ones.
            color += traits.darkness * (sound - color);
            samples.push(color + traits.brightness * (sound - color));
        }
    }
    samples
}

/// Resonances above the third: those of a tube as long as the talker's, as far as the rate goes.
fn upper_formants(traits: &TalkerTraits, rate_hz: f32) -> Vec<Resonance> {
    let mut all = Vec::new();
    for number in 4..20 {
        let mut hz = (2 * number - 1) as f32 * 500.0 * traits.formants[3];
        if number == 4 {
            hz *= traits.fourth;
        }
        if hz > (0.46 * rate_hz).min(9000.0) {
            break;
        }
        let mut resonance = Resonance::default();
        resonance.tune(hz, 180.0 * traits.width * (1.0 + hz / 5000.0), rate_hz);
        all.push(resonance);
    }
    all
}

/// Noise of variance 1, evenly distributed.
fn white(random: &mut Generator) -> f32 {
    between(random, -1.732, 1.732) as f32
}
