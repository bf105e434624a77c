//! Drives sources and system, tick by tick.
//!
//! While the system works on one moment the next one is decoded, where there is more than one thread and no source is
//! live. That changes when things happen, never what: the same room gives the same scenes for any number of threads.

mod suspend;

use crate::config::{ResolvedRoom, ResolvedSystem};
use crate::error::EngineError;
use crate::progress::Progress;
use crate::sinks::{Outputs, SinkContext, Tick};
use crate::sources::{self, Sources};
use crate::summary::{Counts, FaultBook, Outcome, Summary, stage_times};
use hearsight_core::record::{SCENE_SCHEMA_VERSION, Scene};
use hearsight_core::room::Room;
use hearsight_core::source::{AudioSource, Delivery, VideoSource};
use hearsight_core::{Instant, Moment, Span};
use hearsight_media::MomentReader;
use hearsight_systems::System;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{self, Duration};

/// A room whose sensors are open and whose system is ready.
pub struct Engine {
    configuration: ResolvedRoom,
    room: Room,
    camera_names: Vec<String>,
    array_names: Vec<String>,
    reader: MomentReader,
    system: Box<dyn System>,
    pool: rayon::ThreadPool,
    live: bool,
    stop: Arc<AtomicBool>,
    /// The moment that was tracked last, and the one after it where it has been decoded ahead.
    moment: Moment,
    ahead: Moment,
    ahead_is_ready: bool,
    scene: Scene,
    first: Option<Instant>,
    start: Instant,
    end: Option<Instant>,
    /// The sources have ended; `moment` is the last one.
    at_end: bool,
    counts: Counts,
    /// Ticks that were counted before the run was restored.
    restored_ticks: u64,
    last_track: u64,
    /// Records that were kept out of scenes for numbers that are not finite.
    set_aside: u64,
    faults: FaultBook,
    opened: time::Instant,
    decoding: Duration,
    writing: Duration,
}

impl Engine {
    /// Opens every sensor of a room and builds its system.
    ///
    /// # Errors
    /// [`EngineError`] where a sensor cannot be opened, sensors do not fit each other, or the system refuses them.
    pub fn open(configuration: ResolvedRoom) -> Result<Self, EngineError> {
        let sources = sources::open(&configuration)?;
        let ResolvedSystem { name, given, .. } = &configuration.system;
        let system = hearsight_systems::build(name, given, &sources.room, configuration.run.seed)?;
        Self::assemble(configuration, sources, system)
    }

    /// Opens every sensor of a room for a system of the caller's own.
    ///
    /// # Errors
    /// As [`Engine::open`]; `build` gets the room and may refuse it.
    pub fn open_with(
        configuration: ResolvedRoom,
        build: impl FnOnce(&Room) -> Result<Box<dyn System>, EngineError>,
    ) -> Result<Self, EngineError> {
        let sources = sources::open(&configuration)?;
        let system = build(&sources.room)?;
        Self::assemble(configuration, sources, system)
    }

    /// Tracks on sources of the caller's own, one for each camera and array of the configuration and in its order,
    /// instead of the files that it names: a simulated room, for example. Their clocks, channels and rates must be as
    /// they are to be; only the configuration's geometry, system and run are used.
    ///
    /// # Errors
    /// As [`Engine::open`], and [`EngineError::Sources`] where their numbers differ from the configuration's.
    pub fn open_with_sources(
        configuration: ResolvedRoom,
        cameras: Vec<Box<dyn VideoSource>>,
        arrays: Vec<Box<dyn AudioSource>>,
    ) -> Result<Self, EngineError> {
        let sources = sources::take(&configuration, cameras, arrays)?;
        let ResolvedSystem { name, given, .. } = &configuration.system;
        let system = hearsight_systems::build(name, given, &sources.room, configuration.run.seed)?;
        Self::assemble(configuration, sources, system)
    }

    fn assemble(
        configuration: ResolvedRoom,
        sources: Sources,
        system: Box<dyn System>,
    ) -> Result<Self, EngineError> {
        for warning in system.warnings() {
            tracing::warn!("{warning}");
        }
        let threads = configuration.run.threads.max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|number| format!("tracking-{number}"))
            .build()
            .map_err(|error| EngineError::Threads {
                threads,
                reason: error.to_string(),
            })?;
        Ok(Self {
            camera_names: sources
                .room
                .cameras
                .iter()
                .map(|camera| camera.name.clone())
                .collect(),
            array_names: sources
                .room
                .arrays
                .iter()
                .map(|array| array.name.clone())
                .collect(),
            start: sources.start,
            end: sources.end,
            live: sources.live,
            room: sources.room,
            reader: sources.reader,
            configuration,
            system,
            pool,
            stop: Arc::default(),
            moment: Moment::default(),
            ahead: Moment::default(),
            ahead_is_ready: false,
            scene: Scene::default(),
            first: None,
            at_end: false,
            counts: Counts::default(),
            restored_ticks: 0,
            last_track: 0,
            set_aside: 0,
            faults: FaultBook::default(),
            opened: time::Instant::now(),
            decoding: Duration::ZERO,
            writing: Duration::ZERO,
        })
    }

    /// While `flag` is set, [`Engine::step`] returns nothing, also from waiting for a live source.
    pub fn stop_when(&mut self, flag: Arc<AtomicBool>) {
        self.stop = flag;
    }

    /// Takes the next moment and gives what is believed then; nothing at the end.
    pub fn step(&mut self) -> Option<&Scene> {
        if self.stop.load(Ordering::Relaxed) || !self.advance() {
            return None;
        }
        self.track();
        Some(&self.scene)
    }

    /// Brings the next moment into `self.moment`.
    fn advance(&mut self) -> bool {
        if !self.ahead_is_ready && !self.at_end {
            loop {
                let begun = time::Instant::now();
                let delivery = self.reader.read(&mut self.ahead);
                self.decoding += begun.elapsed();
                self.take_delivery(delivery);
                if delivery != Delivery::Pending {
                    break;
                }
                if self.stop.load(Ordering::Relaxed) {
                    return false;
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        if !self.ahead_is_ready {
            return false;
        }
        std::mem::swap(&mut self.moment, &mut self.ahead);
        self.ahead_is_ready = false;
        true
    }

    fn take_delivery(&mut self, delivery: Delivery) {
        let until = self.configuration.run.until;
        match delivery {
            Delivery::Data if until.is_some_and(|until| self.ahead.time >= until) => self.at_end = true,
            Delivery::Data => self.ahead_is_ready = true,
            // What went wrong then belongs to no scene.
            Delivery::Pending => self.faults.add(&self.ahead.faults),
            Delivery::End => {
                self.faults.add(&self.ahead.faults);
                self.at_end = true;
            }
        }
    }

    /// Gives `self.moment` to the system; where it pays, the next one is decoded meanwhile.
    fn track(&mut self) {
        let (moment, scene) = (&self.moment, &mut self.scene);
        scene.schema.clear();
        scene.schema.push_str(SCENE_SCHEMA_VERSION);
        scene.tick = moment.tick;
        scene.time_s = moment.time.seconds();
        let system = &mut self.system;
        if self.live || self.pool.current_num_threads() == 1 {
            self.pool.install(|| system.step(moment, scene));
        } else {
            let (reader, ahead) = (&mut self.reader, &mut self.ahead);
            let mut decoding = Duration::ZERO;
            let delivery = self.pool.install(|| {
                let decode = || {
                    let begun = time::Instant::now();
                    let delivery = reader.read(ahead);
                    decoding += begun.elapsed();
                    delivery
                };
                rayon::join(|| system.step(moment, scene), decode).1
            });
            self.decoding += decoding;
            self.take_delivery(delivery);
        }
        self.scene.faults.clone_from(&self.moment.faults);
        self.set_aside += self.scene.set_aside_non_finite();
        self.account();
    }

    fn account(&mut self) {
        self.first.get_or_insert(self.moment.time);
        self.faults.add(&self.moment.faults);
        self.counts
            .add_moment(&self.moment, &self.camera_names, &self.array_names);
        self.counts.ticks_with_speaker += u64::from(self.scene.speaker.is_some());
        // Identities ascend, so whoever is above the newest one so far is new.
        let new: BTreeSet<u64> = self.scene.tracks.iter().map(|track| track.id).collect();
        for id in new
            .into_iter()
            .filter(|id| *id > self.last_track)
            .collect::<Vec<_>>()
        {
            self.counts.tracks += 1;
            self.last_track = id;
        }
    }

    /// What sinks see of the last tick.
    pub fn tick(&self) -> Tick<'_> {
        Tick {
            scene: &self.scene,
            moment: &self.moment,
            system: self.system.as_ref(),
        }
    }

    /// The last scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The sensors.
    pub fn room(&self) -> &Room {
        &self.room
    }

    /// The configuration that the engine was opened with.
    pub fn configuration(&self) -> &ResolvedRoom {
        &self.configuration
    }

    /// Time from tick to tick.
    pub fn interval(&self) -> Span {
        self.reader.tick()
    }

    /// Whether a source delivers at its own pace and cannot wait.
    pub fn is_live(&self) -> bool {
        self.live
    }

    /// Ends the run at this time, where it would not end before.
    pub fn end_by(&mut self, end: Instant) {
        let until = &mut self.configuration.run.until;
        *until = Some(until.map_or(end, |until| until.min(end)));
        self.end = Some(self.end.map_or(end, |known| known.min(end)));
    }

    /// How far the run is.
    pub fn progress(&self) -> Progress {
        Progress {
            start: self.start,
            position: if self.first.is_some() {
                self.moment.time
            } else {
                self.start
            },
            end: self.end,
            ticks: self.counts.ticks,
            tracks: self.scene.tracks.len(),
        }
    }

    /// Opens the outputs that the configuration wants.
    ///
    /// # Errors
    /// [`EngineError::Output`] where one cannot be made.
    pub fn open_outputs(&self) -> Result<Outputs, EngineError> {
        Ok(Outputs::open(&SinkContext {
            directory: &self.configuration.output.directory,
            room: &self.room,
            configuration: &self.configuration,
            tick_s: self.interval().seconds(),
        })?)
    }

    /// Notes true time that a caller spent on writing results.
    pub fn add_writing_time(&mut self, time: Duration) {
        self.writing += time;
    }

    /// How the run went so far.
    pub fn summary(&self, outcome: Outcome) -> Summary {
        let elapsed_s = self.opened.elapsed().as_secs_f64();
        let done_s = self.interval().seconds() * (self.counts.ticks - self.restored_ticks) as f64;
        let mut stages = vec![("decode", self.decoding)];
        stages.extend(self.system.timings());
        stages.push(("write", self.writing));
        let mut warnings = self.system.warnings().to_vec();
        if outcome == Outcome::Finished {
            warnings.extend(self.counts.silent().map(|sensor| {
                format!("`{sensor}` gave no data between the beginning and the end of this run; correct its `start`")
            }));
        }
        Summary {
            version: env!("CARGO_PKG_VERSION"),
            outcome,
            counts: self.counts.clone(),
            first_tick_s: self.first.map(Instant::seconds),
            last_tick_s: self.first.map(|_| self.moment.time.seconds()),
            tick_s: self.interval().seconds(),
            threads: self.pool.current_num_threads(),
            elapsed_s,
            times_real_time: if elapsed_s > 0.0 { done_s / elapsed_s } else { 0.0 },
            stages: stage_times(&stages),
            faults: self.faults.list(),
            warnings,
            quarantined: self.system.quarantined() + self.set_aside,
        }
    }
}
