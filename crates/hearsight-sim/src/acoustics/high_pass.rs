//! Where the response of a microphone begins.

use std::f64::consts::PI;

/// A second-order high-pass (Butterworth), by the bilinear transform.
pub(crate) struct HighPass {
    gain: f64,
    feedback: [f64; 2],
    memory: [f64; 2],
}

impl HighPass {
    pub(crate) fn new(corner_hz: f64, rate_hz: u32) -> Self {
        let omega = 2.0 * PI * corner_hz / f64::from(rate_hz);
        let alpha = omega.sin() / 2.0_f64.sqrt();
        let whole = 1.0 + alpha;
        Self {
            gain: 0.5 * (1.0 + omega.cos()) / whole,
            feedback: [-2.0 * omega.cos() / whole, (1.0 - alpha) / whole],
            memory: [0.0; 2],
        }
    }

    pub(crate) fn filter(&mut self, gain: f32, samples: &mut [f32]) {
        let [a1, a2] = self.feedback;
        let [mut first, mut second] = self.memory;
        for sample in samples {
            let input = f64::from(*sample * gain) * self.gain;
            // Transposed second form: input, -2 input, input.
            let output = input + first;
            first = -2.0 * input - a1 * output + second;
            second = input - a2 * output;
            *sample = output as f32;
        }
        self.memory = [first, second];
    }
}
