//! What one array hears: any number of samples of all its microphones, block after block.
//!
//! Time is cut into frames of 10 ms by the array's own clock, at whose borders delays are exact, and into blocks of six
//! frames for the late reverberation. Both are counted from the start, whatever blocks are asked for, and every sum is
//! taken in the order of sources: the same bytes for any size of blocks and any number of threads.

use super::bands;
use super::diffuse::DiffuseField;
use super::early::{EarlyFrame, EarlyLink, EarlyPlan};
use super::emitter::Emitter;
use super::error::{AcousticsError, check};
use super::high_pass::HighPass;
use super::lattice::{Lattice, Reach};
use super::microphones::{Microphone, Placement};
use super::random::{derive, generator, normal};
use super::room::{BANDS, Shoebox};
use super::settings::RenderSettings;
use super::source::SoundSource;
use super::synthesis::{Link, Split, Synthesis};
use super::tail::{Feed, Filter, LatePlan, TailEar, TailInput, TailPlan};
use hearsight_core::{AudioBlock, Instant, WorldPoint};
use rayon::prelude::*;

/// Frames in a block of late reverberation.
const FRAMES: usize = 6;
/// Directive sources that turn by more than this get new late responses: cosine of 20 degrees.
const TURN_COSINE: f64 = 0.94;
/// Longest late reverberation unless asked for, seconds.
const USUAL_LATE_S: f64 = 3.0;

/// How far gains of early reflections in bands may be from those of the walls, a share of all bands together.
const MIXED_WITHIN: f64 = 0.02;

/// The taps of all mixtures of bands but the first, which is the signal itself.
fn mixture_taps(mixtures: &[[f64; BANDS]], rate_hz: u32) -> Vec<Vec<f32>> {
    if mixtures.len() < 2 {
        return Vec::new();
    }
    let filters = bands::filters(rate_hz);
    let mix = |mixture: &[f64; BANDS]| {
        let tap = |at: usize| {
            (0..BANDS)
                .map(|band| mixture[band] * f64::from(filters[band][at]))
                .sum::<f64>() as f32
        };
        (0..filters[0].len()).map(tap).collect()
    };
    mixtures[1..].iter().map(mix).collect()
}

/// Where source and microphones were when the late responses of a source were made.
struct Renewed {
    source_m: [f64; 3],
    facing: [f64; 3],
    microphones_m: Vec<[f64; 3]>,
}

/// One microphone.
struct Ear {
    microphone: Microphone,
    number: u64,
    early: Vec<EarlyLink>,
    filters: Vec<Filter>,
    /// Sources whose response here is measured.
    measured: Vec<bool>,
    tail: TailEar,
    high_pass: HighPass,
    gain: f32,
    self_noise: f32,
    /// Samples made and not yet given.
    pending: Vec<f32>,
}

/// Makes what the microphones of one array take of the sound in a room.
pub struct ArrayRenderer {
    room: Shoebox,
    settings: RenderSettings,
    frame: usize,
    early: EarlyPlan,
    tail: TailPlan,
    emitters: Vec<Emitter>,
    inputs: Vec<TailInput>,
    renewed: Vec<Option<Renewed>>,
    ears: Vec<Ear>,
    diffuse: Option<DiffuseField>,
    /// Microphones x samples of the frames being made.
    noise: Vec<Vec<f32>>,
    /// For each frame border of those being made, and each microphone, its place.
    places_m: Vec<Vec<[f64; 3]>>,
    asked: Vec<WorldPoint>,
    next_frame: i64,
    next_sample: i64,
}

impl ArrayRenderer {
    /// Makes everything ready; the array's first sample is number 0 of its clock.
    ///
    /// # Errors
    /// A setting, level or rate that cannot be used, no microphone, two sources of one name, or a measured response of
    /// an unknown source or microphone.
    pub fn new(
        room: &Shoebox,
        sources: Vec<SoundSource>,
        microphones: Vec<Microphone>,
        settings: &RenderSettings,
    ) -> Result<Self, AcousticsError> {
        settings.check()?;
        let count = microphones.len();
        check(
            (1..=1024).contains(&count),
            "the array's microphones",
            "1 to 1024",
            count as f64,
        )?;
        for (number, microphone) in microphones.iter().enumerate() {
            microphone.check(&format!("microphone {number}"))?;
        }
        for (number, source) in sources.iter().enumerate() {
            let same = sources[..number]
                .iter()
                .filter(|other| other.name == source.name)
                .count();
            check(
                same == 0,
                format!("sources named {:?}", source.name),
                "only one",
                1.0 + same as f64,
            )?;
        }
        let rate_hz = settings.rate_hz;
        let speed_m_s = room.settings().speed_m_s;
        let late_m = (settings.early_s * speed_m_s).max(room.diagonal_m());
        let split = Split {
            early_m: 0.75 * late_m,
            late_m,
        };
        let near = Reach {
            distance_m: late_m + room.diagonal_m(),
            order: u32::MAX,
            density_per_m: f64::INFINITY,
        };
        let mut lattice = Lattice::new(room, &near);
        let mixtures = lattice.mix_bands(MIXED_WITHIN);
        let early = EarlyPlan {
            lattice,
            split,
            speed_m_s,
            rate_hz,
            mixtures: mixtures.len(),
        };
        let taps = mixture_taps(&mixtures, rate_hz);
        let frame = (f64::from(rate_hz) / 100.0).round() as usize;
        let late_s = settings
            .late_s
            .unwrap_or_else(|| room.longest_t60_s().min(USUAL_LATE_S));
        let late = (late_s * speed_m_s > split.early_m && early.lattice.len() > 0).then(|| {
            let reach = Reach {
                distance_m: late_s * speed_m_s + room.diagonal_m(),
                order: u32::MAX,
                density_per_m: settings.late_per_sample * f64::from(rate_hz) / speed_m_s,
            };
            let samples = (late_s * f64::from(rate_hz)).ceil() as usize;
            let lattice = Lattice::new(room, &reach);
            (
                LatePlan {
                    lattice,
                    synthesis: Synthesis::new(room, rate_hz, samples),
                    split,
                },
                samples,
            )
        });
        let (late, late_samples) = late.map_or((None, 0), |(late, samples)| (Some(late), samples));
        let longest = settings
            .measured
            .iter()
            .map(|response| response.samples.len())
            .max()
            .unwrap_or(0);
        let tail = TailPlan::new(FRAMES * frame, late_samples.max(longest).max(1), late);
        let emitters: Vec<Emitter> = sources
            .into_iter()
            .map(|source| Emitter::new(source, taps.clone(), rate_hz))
            .collect::<Result<_, _>>()?;
        let ears = microphones.iter().enumerate().map(|(number, microphone)| Ear {
            microphone: *microphone,
            number: number as u64,
            early: vec![EarlyLink::default(); emitters.len()],
            filters: emitters.iter().map(|_| Filter::EMPTY).collect(),
            measured: vec![false; emitters.len()],
            tail: TailEar::new(&tail),
            high_pass: HighPass::new(microphone.corner_hz, rate_hz),
            gain: 10.0_f64.powf(microphone.gain_db / 20.0) as f32,
            self_noise: if microphone.noise_db <= -200.0 {
                0.0
            } else {
                10.0_f64.powf(microphone.noise_db / 20.0) as f32
            },
            pending: Vec::new(),
        });
        let mut ears: Vec<Ear> = ears.collect();
        for response in &settings.measured {
            response.check(rate_hz)?;
            let source = emitters
                .iter()
                .position(|emitter| emitter.source.name == response.source);
            let (Some(source), Some(ear)) = (source, ears.get_mut(response.microphone)) else {
                return Err(response.unknown());
            };
            ear.measured[source] = true;
            TailEar::measure(&tail, &response.samples, &mut ear.filters[source])?;
        }
        Ok(Self {
            diffuse: settings.noise.as_ref().map(|noise| {
                DiffuseField::new(
                    noise,
                    count,
                    rate_hz,
                    speed_m_s,
                    derive(settings.seed, "diffuse noise", 0),
                )
            }),
            inputs: emitters.iter().map(|_| TailInput::new(&tail)).collect(),
            renewed: emitters.iter().map(|_| None).collect(),
            noise: vec![Vec::new(); count],
            places_m: Vec::new(),
            asked: vec![WorldPoint::new(0.0, 0.0, 0.0); count],
            next_frame: 0,
            next_sample: 0,
            room: room.clone(),
            settings: settings.clone(),
            frame,
            early,
            tail,
            emitters,
            ears,
        })
    }

    /// Number of the sample that comes next.
    pub fn next_sample(&self) -> i64 {
        self.next_sample
    }

    /// When the sample that comes next is taken, seconds of the scenario.
    pub fn next_time_s(&self) -> f64 {
        self.settings
            .clock
            .time_s(self.next_sample, self.settings.rate_hz)
    }

    /// Writes the next `samples` samples of every microphone into `block`. Its time is what the device believes: the
    /// offset and sample numbers at the nominal rate; it does not know of its drift.
    ///
    /// Not clipped and not rounded to integers. Where blocks are of one size, nothing is allocated once the first
    /// movements have been.
    ///
    /// # Errors
    /// [`AcousticsError::Outside`] where a source or a microphone is not in the room. After an error, what comes next
    /// is undefined.
    pub fn render(
        &mut self,
        placement: &dyn Placement,
        samples: usize,
        block: &mut AudioBlock,
    ) -> Result<(), AcousticsError> {
        let rate_hz = self.settings.rate_hz;
        let seconds = self.settings.clock.offset_s + self.next_sample as f64 / f64::from(rate_hz);
        (block.time, block.rate_hz) = (Instant::from_seconds(seconds), rate_hz);
        block.channels.resize_with(self.ears.len(), Vec::new);
        block.channels.iter_mut().for_each(Vec::clear);
        let mut left = samples;
        while left > 0 {
            let ready = self.ears.first().map_or(0, |ear| ear.pending.len());
            if ready == 0 {
                let in_block = self.next_frame.rem_euclid(FRAMES as i64) as usize;
                let frames = left.div_ceil(self.frame).min(FRAMES - in_block);
                self.make(placement, frames)?;
                continue;
            }
            let taken = ready.min(left);
            for (channel, ear) in block.channels.iter_mut().zip(&mut self.ears) {
                channel.extend_from_slice(&ear.pending[..taken]);
                ear.pending.drain(..taken);
            }
            left -= taken;
        }
        self.next_sample += samples as i64;
        Ok(())
    }

    fn time_s(&self, frame: i64) -> f64 {
        self.settings
            .clock
            .time_s(frame * self.frame as i64, self.settings.rate_hz)
    }

    /// Samples of a source an output sample, less 1.
    fn slope(&self) -> f64 {
        1.0 / (1.0 + self.settings.clock.drift_ppm * 1e-6) - 1.0
    }

    /// Makes the next frames, all within one block.
    fn make(&mut self, placement: &dyn Placement, frames: usize) -> Result<(), AcousticsError> {
        let first = self.next_frame;
        self.places_m.resize_with(FRAMES + 1, Vec::new);
        if first == 0 {
            self.ask(placement, 0, 0)?;
        }
        if first.rem_euclid(FRAMES as i64) == 0 {
            self.begin_block(first)?;
        }
        for frame in 1..=frames {
            self.ask(placement, first + frame as i64, frame)?;
        }
        self.make_noise(first, frames)?;
        let (length, slope) = (self.frame, self.slope());
        let times: [f64; FRAMES + 1] = std::array::from_fn(|frame| self.time_s(first + frame as i64));
        let (plan, emitters, places_m) = (&self.early, &self.emitters, &self.places_m);
        let in_block = first.rem_euclid(FRAMES as i64) as usize;
        let seed = self.settings.seed;
        self.ears
            .par_iter_mut()
            .zip(&self.noise)
            .for_each(|(ear, noise)| {
                ear.pending.clear();
                ear.pending.resize(frames * length, 0.0);
                let number = ear.number as usize;
                let delay_s = ear.microphone.delay_s;
                for (frame, output) in ear.pending.chunks_exact_mut(length).enumerate() {
                    let early = EarlyFrame {
                        times_s: [times[frame] - delay_s, times[frame + 1] - delay_s],
                        microphone_m: [places_m[frame][number], places_m[frame + 1][number]],
                        slope,
                    };
                    for (source, emitter) in emitters.iter().enumerate() {
                        if !ear.measured[source] {
                            ear.early[source].render(plan, emitter, &early, output);
                        }
                    }
                    let tail = &ear.tail.output[(in_block + frame) * length..][..length];
                    for (output, tail) in output.iter_mut().zip(tail) {
                        *output += tail;
                    }
                    if let Some(noise) = noise.get(frame * length..(frame + 1) * length) {
                        for (output, noise) in output.iter_mut().zip(noise) {
                            *output += noise;
                        }
                    }
                    ear.high_pass.filter(ear.gain, output);
                    if ear.self_noise > 0.0 {
                        let id = (ear.number << 40) ^ (first + frame as i64).cast_unsigned();
                        let mut random = generator(seed, "self noise", id);
                        for output in output {
                            *output += ear.self_noise * normal(&mut random) as f32;
                        }
                    }
                }
            });
        self.places_m.swap(0, frames);
        self.next_frame += frames as i64;
        Ok(())
    }

    /// Asks where the microphones are at the begin of a frame.
    fn ask(&mut self, placement: &dyn Placement, frame: i64, slot: usize) -> Result<(), AcousticsError> {
        let time_s = self.time_s(frame);
        let nowhere = WorldPoint::new(f64::NAN, f64::NAN, f64::NAN);
        self.asked.fill(nowhere);
        placement.place(time_s, &mut self.asked);
        let places = &mut self.places_m[slot];
        places.clear();
        for (number, position) in self.asked.iter().enumerate() {
            places.push(
                self.room
                    .inside(*position, time_s, || format!("microphone {number}"))?,
            );
        }
        Ok(())
    }

    /// Prepares the sources for a block and makes its late reverberation.
    fn begin_block(&mut self, first: i64) -> Result<(), AcousticsError> {
        let (begin_s, end_s) = (self.time_s(first), self.time_s(first + FRAMES as i64));
        let rate_hz = self.settings.rate_hz;
        let rate = f64::from(rate_hz);
        // Microphones may be 1 ms late or early.
        let slack_s = 2e-3;
        let reach_s = self.early.reach() as f64 / rate;
        let from = ((begin_s - slack_s - reach_s) * rate).floor() as i64;
        let to = ((end_s + slack_s) * rate).ceil() as i64 + 2;
        let (room, slope) = (&self.room, self.slope());
        for emitter in &mut self.emitters {
            // Until where the signal is prepared, which is further than it is heard.
            emitter.follow(room, begin_s - slack_s - 2.0 * reach_s - 0.05, end_s + 0.1)?;
        }
        self.emitters
            .par_iter_mut()
            .zip(&mut self.inputs)
            .for_each(|(emitter, input)| {
                emitter.prepare(from, to, rate_hz);
                emitter.read_all(begin_s * rate, slope, &mut input.signal);
            });
        let simulates = self.tail.late.is_some();
        let now = &self.places_m[0];
        for (source, (emitter, input)) in self.emitters.iter().zip(&mut self.inputs).enumerate() {
            let was_silent = input.feed == Feed::Nothing;
            let position = emitter.track.position(begin_s);
            let facing = emitter.track.facing(begin_s);
            input.feed = if input.signal.iter().all(|sample| *sample == 0.0) {
                Feed::Nothing
            } else if !simulates || self.ears.iter().all(|ear| ear.measured[source]) {
                if self.ears.iter().any(|ear| ear.measured[source]) {
                    Feed::Held
                } else {
                    Feed::Nothing
                }
            } else {
                let directive = emitter.source.directivity.everywhere < 1.0;
                match &self.renewed[source] {
                    None => Feed::Renewed,
                    Some(last) if last.holds(&position, &facing, now, directive, self.settings.renew_m) => {
                        Feed::Held
                    }
                    Some(_) if was_silent => Feed::Renewed,
                    Some(_) => Feed::Faded,
                }
            };
            if matches!(input.feed, Feed::Renewed | Feed::Faded) {
                let renewed = self.renewed[source].get_or_insert_with(|| Renewed {
                    source_m: position,
                    facing,
                    microphones_m: Vec::new(),
                });
                (renewed.source_m, renewed.facing) = (position, facing);
                renewed.microphones_m.clone_from(now);
            }
        }
        let plan = &self.tail;
        self.inputs
            .par_iter_mut()
            .try_for_each(|input| input.transform(plan))?;
        let (inputs, emitters, renewed) = (&self.inputs, &self.emitters, &self.renewed);
        self.ears.par_iter_mut().try_for_each(|ear| {
            for (source, input) in inputs.iter().enumerate() {
                let filter = &mut ear.filters[source];
                if ear.measured[source] {
                    ear.tail.feed_measured(plan, input, filter);
                    continue;
                }
                if let (Feed::Renewed | Feed::Faded, Some(renewed)) = (input.feed, &renewed[source]) {
                    let link = Link {
                        source_m: renewed.source_m,
                        facing: renewed.facing,
                        directivity: emitters[source].source.directivity,
                        microphone_m: now[ear.number as usize],
                        delay_s: ear.microphone.delay_s,
                    };
                    ear.tail.renew(plan, &link, filter)?;
                }
                ear.tail.feed(plan, input, filter);
            }
            ear.tail.finish(plan)
        })
    }

    /// Makes the noise from everywhere for the next frames.
    fn make_noise(&mut self, first: i64, frames: usize) -> Result<(), AcousticsError> {
        let Some(diffuse) = &mut self.diffuse else {
            return Ok(());
        };
        let stretch = diffuse.stretch() as i64;
        let (mut sample, length) = (first * self.frame as i64, (frames * self.frame) as i64);
        let end = sample + length;
        self.noise.iter_mut().for_each(Vec::clear);
        while sample < end {
            let number = sample.div_euclid(stretch);
            // Where the microphones are in the frame in which the stretch begins, whatever blocks are asked for.
            let begun = ((number * stretch - first * self.frame as i64) / self.frame as i64).max(0);
            diffuse.make(number, &self.places_m[begun as usize])?;
            let from = (sample - number * stretch) as usize;
            let count = (end - sample).min(stretch - from as i64) as usize;
            for (noise, output) in self.noise.iter_mut().zip(&diffuse.output) {
                noise.extend_from_slice(&output[from..from + count]);
            }
            sample += count as i64;
        }
        Ok(())
    }
}

impl Renewed {
    /// Whether responses made here will do for where source and microphones are now.
    fn holds(
        &self,
        source_m: &[f64; 3],
        facing: &[f64; 3],
        microphones_m: &[[f64; 3]],
        directive: bool,
        renew_m: f64,
    ) -> bool {
        let apart =
            |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt();
        let moved = self
            .microphones_m
            .iter()
            .zip(microphones_m)
            .map(|(old, new)| apart(old, new))
            .fold(0.0, f64::max);
        let cosine: f64 = self.facing.iter().zip(facing).map(|(old, new)| old * new).sum();
        apart(&self.source_m, source_m) + moved < renew_m && (!directive || cosine > TURN_COSINE)
    }
}
