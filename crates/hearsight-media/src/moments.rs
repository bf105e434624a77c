//! Several cameras and arrays on one clock: moments in order.
//!
//! Ticks lie on a grid in phase with the fastest camera, so that its frames need not wait. Each camera's frames fall
//! into successive ticks by its own phase, which jitter of less than half a tick does not disturb. Samples are given
//! once they are complete at the tick's time.

use crate::clock::RunClock;
use crate::error::{MomentError, fault};
use crate::pending::{PendingAudio, PendingVideo, Wait, ceiling};
use hearsight_core::moment::Observed;
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{Fault, FaultKind, Instant, Moment, Span};

/// The tick where there is no camera to set it.
const TICK_WITHOUT_CAMERA: Span = Span::from_nanoseconds(40_000_000);

/// A camera of the room.
pub struct Camera {
    /// The sensor's name in the room, which its faults carry.
    pub name: String,
    /// What delivers its frames.
    pub source: Box<dyn VideoSource>,
}

/// A microphone array of the room.
pub struct Microphones {
    /// The sensor's name in the room, which its faults carry.
    pub name: String,
    /// What delivers its samples.
    pub source: Box<dyn AudioSource>,
}

/// How sources are put into moments.
#[derive(Clone, Copy, Debug)]
pub struct MomentOptions {
    /// Time from tick to tick; default is the fastest camera's interval, or 40 ms without cameras. Where it is longer
    /// than a camera's interval, the newest frame of each tick is given.
    pub tick: Option<Span>,
    /// Data before this instant are left out.
    pub from: Option<Instant>,
    /// Data at or after this instant are left out and the run ends there.
    pub until: Option<Instant>,
    /// The clock of live sources; by it a tick stops waiting for a source that is late. Default is to wait for all.
    pub clock: Option<RunClock>,
    /// How long after its time a tick waits for live sources; default 200 ms. Frames that come later are left out,
    /// samples are given with a later tick.
    pub patience: Span,
}

impl Default for MomentOptions {
    fn default() -> Self {
        Self {
            tick: None,
            from: None,
            until: None,
            clock: None,
            patience: Span::from_nanoseconds(200_000_000),
        }
    }
}

/// Builds moments from the sources of a room.
pub struct MomentReader {
    cameras: Vec<PendingVideo>,
    arrays: Vec<PendingAudio>,
    options: MomentOptions,
    tick: Span,
    /// The fastest camera, which sets the phase of the grid.
    leader: Option<usize>,
    /// Time of tick 0, once known.
    origin: Option<Instant>,
    next: u64,
    /// Faults since the last moment.
    faults: Vec<Fault>,
    ended: bool,
}

impl MomentReader {
    /// A reader of the given sources; their order is the order within moments.
    ///
    /// # Errors
    /// No source at all, a tick that is not positive, or an empty range of time.
    pub fn new(
        cameras: Vec<Camera>,
        arrays: Vec<Microphones>,
        options: MomentOptions,
    ) -> Result<Self, MomentError> {
        if cameras.is_empty() && arrays.is_empty() {
            return Err(MomentError::NoSources);
        }
        if let (Some(from), Some(until)) = (options.from, options.until)
            && until <= from
        {
            return Err(MomentError::EmptyRange {
                from_s: from.seconds(),
                until_s: until.seconds(),
            });
        }
        let intervals = cameras.iter().map(|camera| camera.source.format().interval);
        let leader = intervals
            .clone()
            .enumerate()
            .min_by_key(|(_, interval)| *interval)
            .map(|(at, _)| at);
        let tick = options
            .tick
            .or_else(|| intervals.min())
            .unwrap_or(TICK_WITHOUT_CAMERA);
        if tick <= Span::ZERO {
            return Err(MomentError::BadTick {
                tick_s: tick.seconds(),
            });
        }
        Ok(Self {
            cameras: cameras
                .into_iter()
                .map(|camera| PendingVideo::new(camera.name, camera.source))
                .collect(),
            arrays: arrays
                .into_iter()
                .map(|array| PendingAudio::new(array.name, array.source))
                .collect(),
            options,
            tick,
            leader,
            origin: None,
            next: 0,
            faults: Vec::new(),
            ended: false,
        })
    }

    /// Time from tick to tick.
    pub fn tick(&self) -> Span {
        self.tick
    }

    /// Frames of each camera that were left out since a newer one fell into the same tick.
    pub fn superseded(&self) -> impl Iterator<Item = u64> + '_ {
        self.cameras.iter().map(|camera| camera.superseded)
    }

    /// Fills `moment` with the next tick, reusing its memory. Faults since the tick before are in it, also at the end.
    ///
    /// [`Delivery::Pending`] comes only from live sources: nothing is complete yet, ask again.
    pub fn read(&mut self, moment: &mut Moment) -> Delivery {
        moment.faults.clear();
        moment.video.resize_with(self.cameras.len(), Observed::default);
        moment.audio.resize_with(self.arrays.len(), Observed::default);
        moment.video.iter_mut().for_each(|video| video.new = false);
        moment.audio.iter_mut().for_each(|audio| audio.new = false);
        let delivery = if self.ended {
            Delivery::End
        } else {
            self.step(moment)
        };
        if delivery != Delivery::Pending {
            std::mem::swap(&mut moment.faults, &mut self.faults);
        }
        delivery
    }

    /// As [`MomentReader::read`], but waits for live sources instead of returning [`Delivery::Pending`].
    pub fn wait(&mut self, moment: &mut Moment) -> Delivery {
        loop {
            match self.read(moment) {
                Delivery::Pending => std::thread::sleep(std::time::Duration::from_millis(1)),
                delivery => return delivery,
            }
        }
    }

    fn step(&mut self, moment: &mut Moment) -> Delivery {
        let Some(origin) = self.origin.or_else(|| self.begin()) else {
            return if self.all_ended() {
                self.end()
            } else {
                Delivery::Pending
            };
        };
        let grid = origin + self.tick * self.next as i64;
        // Data just before the end may belong to the first tick after it.
        if self.options.until.is_some_and(|until| grid >= until + self.tick) {
            return self.end();
        }
        match self.gather(origin, grid) {
            Delivery::Data => self.complete(grid, moment),
            Delivery::Pending => Delivery::Pending,
            Delivery::End => self.end(),
        }
    }

    fn end(&mut self) -> Delivery {
        self.ended = true;
        Delivery::End
    }

    fn all_ended(&self) -> bool {
        self.cameras.iter().all(PendingVideo::is_over) && self.arrays.iter().all(PendingAudio::is_over)
    }

    /// Whether a source that has nothing yet need not be waited for at the time `grid`.
    fn out_of_patience(&self, grid: Instant) -> bool {
        self.options
            .clock
            .is_some_and(|clock| clock.now() - grid > self.options.patience)
    }

    /// Finds the first data of the run and lays the grid through the leader's frames.
    fn begin(&mut self) -> Option<Instant> {
        let MomentOptions { from, until, .. } = self.options;
        let mut waiting = false;
        for camera in &mut self.cameras {
            waiting |= camera.fill(from, until, &mut self.faults) == Wait::Yes;
        }
        for array in &mut self.arrays {
            waiting |= array.fill(from, until, &mut self.faults) == Wait::Yes;
        }
        let frames = self.cameras.iter().filter_map(PendingVideo::time);
        let first = frames
            .chain(self.arrays.iter().filter_map(PendingAudio::time))
            .min()?;
        if waiting && !self.out_of_patience(first) {
            return None;
        }
        let origin = match self.leader.and_then(|leader| self.cameras[leader].first) {
            Some(phase) => {
                phase + self.tick * ceiling((first - phase).nanoseconds(), self.tick.nanoseconds())
            }
            // Without a camera the first tick closes the first interval.
            None if self.cameras.is_empty() => first + self.tick,
            None => first,
        };
        self.origin = Some(origin);
        self.origin
    }

    /// Brings every source up to the tick at `grid`: data where the tick is complete.
    fn gather(&mut self, origin: Instant, grid: Instant) -> Delivery {
        let MomentOptions { from, until, .. } = self.options;
        let impatient = self.out_of_patience(grid);
        let mut waiting = false;
        for camera in &mut self.cameras {
            // The newest frame of this tick moves to `ready`; the first of a later one stays pending.
            while camera.fill(from, until, &mut self.faults) == Wait::No {
                camera.align(origin, self.tick);
                let Some(tick) = camera.tick(self.tick) else { break };
                if tick > self.next as i64 {
                    break;
                }
                if tick < self.next as i64
                    && let Some(time) = camera.time()
                {
                    let late = (grid - time).seconds();
                    let detail = format!("a frame came {late:.3} s late, after its tick, and was left out");
                    self.faults
                        .push(fault(&camera.name, time, FaultKind::Dropped, detail));
                    camera.forget();
                } else {
                    camera.accept();
                }
            }
            waiting |= camera.is_waiting();
        }
        let time = self.moment_time(grid);
        for array in &mut self.arrays {
            while array.fill(from, until, &mut self.faults) == Wait::No && array.take_until(time) {}
            waiting |= array.is_waiting();
        }
        if waiting && !impatient {
            return Delivery::Pending;
        }
        let ready =
            self.cameras.iter().any(PendingVideo::is_ready) || self.arrays.iter().any(PendingAudio::is_ready);
        if !ready && self.all_ended() {
            Delivery::End
        } else {
            Delivery::Data
        }
    }

    /// The grid's time, or that of the newest frame where jitter brought it later: data are never later than this.
    fn moment_time(&self, grid: Instant) -> Instant {
        self.cameras
            .iter()
            .filter_map(PendingVideo::ready_time)
            .fold(grid, Instant::max)
    }

    /// Hands the gathered data over.
    fn complete(&mut self, grid: Instant, moment: &mut Moment) -> Delivery {
        moment.tick = self.next;
        moment.time = self.moment_time(grid);
        for (camera, slot) in self.cameras.iter_mut().zip(&mut moment.video) {
            camera.give(slot);
        }
        for (array, slot) in self.arrays.iter_mut().zip(&mut moment.audio) {
            array.give(slot);
        }
        self.next += 1;
        Delivery::Data
    }
}
