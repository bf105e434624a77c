//! Early reflections, one by one: each image's delay and gain follow the movement of source and microphone.
//!
//! Delays are those of the sound that arrives now, from where its source was when it left. They are renewed every 10 ms
//! and move evenly in between, which gives the Doppler effect and leaves nothing to cross-fade.

use super::emitter::Emitter;
use super::lattice::Lattice;
use super::room::BANDS;
use super::synthesis::{NEAREST_M, Split};

/// Images are looked through anew after so many metres of movement.
const MARGIN_M: f64 = 0.25;
/// How far a source may go while its sound is on the way to a microphone, metres.
const RESERVE_M: f64 = 0.5;

/// The images of one source that one microphone hears one by one.
#[derive(Clone, Debug, Default)]
pub(crate) struct EarlyLink {
    /// Number of the mirror of each image; images of one mirror are together.
    mirror: Vec<u8>,
    /// Number in the lattice, all mirrors counted through; the direct sound has none.
    number: Vec<u32>,
    offset_m: Vec<[f64; 3]>,
    /// Travel, samples, at the end of the frame before.
    delay: Vec<f64>,
    /// How much it grew in that frame: where it will be at the end of the next is known nearly.
    growth: Vec<f64>,
    /// For each image and mixture of bands.
    gain: Vec<f32>,
    amplitude: Vec<f32>,
    /// Where source and microphone were when the images were chosen.
    chosen_at: Option<[[f64; 3]; 2]>,
    /// Whether delays and amplitudes are those of the end of the frame before.
    current: bool,
    /// Kept for choosing anew.
    before: Vec<(u32, [f64; 2], [f32; BANDS])>,
}

/// What all images of one array have in common.
pub(crate) struct EarlyPlan {
    pub(crate) lattice: Lattice,
    pub(crate) split: Split,
    pub(crate) speed_m_s: f64,
    pub(crate) rate_hz: u32,
    /// Mixtures of bands in which images are heard.
    pub(crate) mixtures: usize,
}

/// One frame of one microphone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EarlyFrame {
    /// When its first sample and that of the next frame are taken, seconds, the microphone's delay taken off.
    pub(crate) times_s: [f64; 2],
    /// Where the microphone is then.
    pub(crate) microphone_m: [[f64; 3]; 2],
    /// Samples of the source an output sample, less 1: the clock's drift.
    pub(crate) slope: f64,
}

const DIRECT: u32 = u32::MAX;
/// Rounds in which a delay is found from nothing.
const ROUNDS: usize = 5;

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

impl EarlyLink {
    /// Adds what the frame hears of the source to `output`.
    pub(crate) fn render(
        &mut self,
        plan: &EarlyPlan,
        emitter: &Emitter,
        frame: &EarlyFrame,
        output: &mut [f32],
    ) {
        let rate = f64::from(plan.rate_hz);
        let [begin_s, end_s] = frame.times_s;
        let longest_s = plan.split.late_m / plan.speed_m_s;
        if !emitter.sounds_since((begin_s * rate) as i64 - self.reach(plan)) {
            self.current = false;
            return;
        }
        self.choose(plan, emitter, frame);
        if !self.current {
            self.update(plan, emitter, begin_s, &frame.microphone_m[0]);
            self.current = true;
        }
        let still = frame.microphone_m[0] == frame.microphone_m[1]
            && emitter
                .track
                .still_from(begin_s - longest_s - 2.0 * plan.reserve_s());
        if still {
            let start = begin_s * rate;
            for (image, delay) in self.delay.iter().enumerate() {
                for (mixture, branches) in emitter.branches.iter().enumerate() {
                    let amplitude = self.amplitude[image * plan.mixtures + mixture];
                    if amplitude != 0.0 {
                        branches.read(start - delay, frame.slope, amplitude, 0.0, output);
                    }
                }
            }
            return;
        }
        let start = begin_s * rate;
        let one_over = 1.0 / output.len() as f64;
        for image in 0..self.delay.len() {
            let (before, guess) = (self.delay[image], self.delay[image] + self.growth[image]);
            let (delay, amplitude) =
                self.moved(plan, emitter, end_s, &frame.microphone_m[1], image, guess, 1);
            let slope = frame.slope - (delay - before) * one_over;
            for (mixture, branches) in emitter.branches.iter().enumerate() {
                let place = image * plan.mixtures + mixture;
                let (from, to) = (self.amplitude[place], amplitude * self.gain[place]);
                if from != 0.0 || to != 0.0 {
                    branches.read(start - before, slope, from, (to - from) * one_over as f32, output);
                }
                self.amplitude[place] = to;
            }
            (self.delay[image], self.growth[image]) = (delay, delay - before);
        }
    }

    /// Samples back in time that may still be heard.
    fn reach(&self, plan: &EarlyPlan) -> i64 {
        plan.reach()
    }

    /// Delays and amplitudes at a time.
    fn update(&mut self, plan: &EarlyPlan, emitter: &Emitter, time_s: f64, microphone_m: &[f64; 3]) {
        for image in 0..self.delay.len() {
            let (delay, amplitude) = self.moved(plan, emitter, time_s, microphone_m, image, 0.0, ROUNDS);
            (self.delay[image], self.growth[image]) = (delay, 0.0);
            for mixture in 0..plan.mixtures {
                self.amplitude[image * plan.mixtures + mixture] =
                    amplitude * self.gain[image * plan.mixtures + mixture];
            }
        }
    }

    /// Delay (samples) and amplitude without reflections of an image at a time. From a guess of the delay, each round
    /// comes nearer to the true one by the ratio of the speed of sound to the source's.
    #[inline]
    fn moved(
        &self,
        plan: &EarlyPlan,
        emitter: &Emitter,
        time_s: f64,
        microphone_m: &[f64; 3],
        image: usize,
        guess: f64,
        rounds: usize,
    ) -> (f64, f32) {
        let sign = &plan.lattice.mirrors[usize::from(self.mirror[image])].sign;
        let offset = &self.offset_m[image];
        let (seconds, samples_per_m) = (
            1.0 / f64::from(plan.rate_hz),
            f64::from(plan.rate_hz) / plan.speed_m_s,
        );
        let (mut delay, mut away, mut metres) = (guess, [0.0; 3], 0.0);
        for _ in 0..rounds {
            let from = emitter.track.position(time_s - delay * seconds);
            away = [
                microphone_m[0] - sign[0] * from[0] - offset[0],
                microphone_m[1] - sign[1] * from[1] - offset[1],
                microphone_m[2] - sign[2] * from[2] - offset[2],
            ];
            metres = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt();
            delay = metres * samples_per_m;
        }
        let direct = self.number[image] == DIRECT;
        if metres >= plan.split.late_m && !direct {
            return (delay, 0.0);
        }
        let early = if direct { 1.0 } else { plan.split.early(metres) };
        let one_over = 1.0 / metres.max(NEAREST_M);
        let mut amplitude = early * one_over;
        let directivity = emitter.source.directivity;
        if directivity.everywhere < 1.0 {
            let facing = emitter.track.facing(time_s - delay * seconds);
            let along =
                sign[0] * facing[0] * away[0] + sign[1] * facing[1] * away[1] + sign[2] * facing[2] * away[2];
            amplitude *= directivity.gain(along * one_over);
        }
        (delay, amplitude as f32)
    }

    /// Chooses the images near enough to be heard soon, where source or microphone have moved since the last time.
    fn choose(&mut self, plan: &EarlyPlan, emitter: &Emitter, frame: &EarlyFrame) {
        let source = emitter.track.position(frame.times_s[1]);
        let microphone = frame.microphone_m[1];
        let fresh = self.chosen_at.is_some_and(|[old_source, old_microphone]| {
            distance(&old_source, &source) + distance(&old_microphone, &microphone) < MARGIN_M
        });
        if fresh {
            return;
        }
        self.chosen_at = Some([source, microphone]);
        self.before.clear();
        if self.current {
            for (image, number) in self.number.iter().enumerate() {
                let mut amplitudes = [0.0; BANDS];
                let own = &self.amplitude[image * plan.mixtures..(image + 1) * plan.mixtures];
                amplitudes[..plan.mixtures].copy_from_slice(own);
                self.before
                    .push((*number, [self.delay[image], self.growth[image]], amplitudes));
            }
        }
        self.mirror.clear();
        self.number.clear();
        self.offset_m.clear();
        self.gain.clear();
        // In the first mixture, which is the signal itself.
        let direct = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        self.add(0, DIRECT, [0.0; 3], direct.iter().take(plan.mixtures));
        let mut number = 0;
        // Twice the margin: movement until the next choice, and during the sound's travel.
        let limit_m = plan.split.late_m + 2.0 * MARGIN_M + RESERVE_M;
        for (place, mirror) in plan.lattice.mirrors.iter().enumerate() {
            for image in 0..mirror.offset_m[0].len() {
                let offset = [0, 1, 2].map(|axis| mirror.offset_m[axis][image]);
                let at = [0, 1, 2].map(|axis| mirror.sign[axis] * source[axis] + offset[axis]);
                if distance(&at, &microphone) < limit_m {
                    self.add(
                        place as u8,
                        number,
                        offset,
                        mirror.gain.iter().map(|gain| &gain[image]),
                    );
                }
                number += 1;
            }
        }
        let count = self.number.len();
        self.delay.clear();
        self.delay.resize(count, 0.0);
        self.growth.clear();
        self.growth.resize(count, 0.0);
        self.amplitude.clear();
        self.amplitude.resize(count * plan.mixtures, 0.0);
        if !self.current {
            return;
        }
        // Numbers ascend, but for the direct sound, which comes first in both.
        let mut old = self.before.iter().peekable();
        for image in 0..count {
            let number = self.number[image];
            while old
                .peek()
                .is_some_and(|before| before.0 != DIRECT && (number != DIRECT && before.0 < number))
            {
                old.next();
            }
            let (delays, amplitudes) = match old.next_if(|before| before.0 == number) {
                Some(before) => (before.1, before.2),
                None => {
                    // Unheard until now: from where it is at the frame's begin.
                    let (begin_s, ear) = (frame.times_s[0], &frame.microphone_m[0]);
                    let (delay, _) = self.moved(plan, emitter, begin_s, ear, image, 0.0, ROUNDS);
                    ([delay, 0.0], [0.0; BANDS])
                }
            };
            [self.delay[image], self.growth[image]] = delays;
            self.amplitude[image * plan.mixtures..(image + 1) * plan.mixtures]
                .copy_from_slice(&amplitudes[..plan.mixtures]);
        }
    }

    fn add<'g>(&mut self, mirror: u8, number: u32, offset_m: [f64; 3], gains: impl Iterator<Item = &'g f32>) {
        self.mirror.push(mirror);
        self.number.push(number);
        self.offset_m.push(offset_m);
        self.gain.extend(gains);
    }
}

impl EarlyPlan {
    /// Seconds of travel beyond the last early image, for movement meanwhile.
    pub(crate) fn reserve_s(&self) -> f64 {
        RESERVE_M / self.speed_m_s
    }

    /// Samples of a source's past that are needed.
    pub(crate) fn reach(&self) -> i64 {
        let seconds = (self.split.late_m + 2.0 * MARGIN_M) / self.speed_m_s + 3.0 * self.reserve_s();
        (seconds * f64::from(self.rate_hz)).ceil() as i64
    }
}
