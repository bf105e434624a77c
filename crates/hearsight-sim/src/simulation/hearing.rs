//! What arrays hear: the sources of a world with their places and levels, and the room between them.

use super::shared::Shared;
use super::voices;
use crate::acoustics::random::derive;
use crate::acoustics::{
    AcousticsError, ArrayRenderer, DeviceClock, DiffuseNoise, Directivity, Emission, ImpulseResponse,
    Microphone, Mismatch, RenderSettings, Responder, ResponseSettings, Shoebox, ShoeboxSettings, Sound,
    SoundSource, Walls,
};
use crate::world::{Noise, NoiseKind, NoiseLevel, NoisePlace, World};
use hearsight_core::WorldPoint;
use nalgebra::Vector3;
use std::sync::Arc;

/// Levels relative to speech are compared at this rate, over responses of this length at most, seconds.
const COMPARED_HZ: u32 = 8000;
const COMPARED_S: f64 = 0.3;
/// And at so many microphones and people at most.
const MOST_COMPARED: usize = 6;
/// Level of noise whose level is relative to speech where nobody speaks or listens, decibels.
const NOTHING_TO_COMPARE_DB: f64 = -45.0;

/// The room as sound meets it.
pub(super) fn room(world: &World) -> Result<Shoebox, AcousticsError> {
    let walls = if world.t60_s > 0.0 {
        Walls::T60(world.t60_s)
    } else {
        Walls::Anechoic
    };
    let mut settings = ShoeboxSettings::new(world.setting.size_m, walls);
    settings.origin = world.setting.origin;
    settings.speed_m_s = world.speed_of_sound_m_s;
    settings.seed = derive(world.seed, "room", 0);
    Shoebox::new(&settings)
}

/// What makes the samples of one array.
pub(super) fn renderer(shared: &Arc<Shared>, number: usize) -> Result<ArrayRenderer, AcousticsError> {
    let world = &shared.world;
    let device = &world.arrays[number];
    let usual = Microphone {
        noise_db: device.noise_db,
        ..Microphone::default()
    };
    let [gain_db, delay_s, corner_share] = device.mismatch;
    let mismatch = Mismatch {
        gain_db,
        delay_s,
        corner_share,
    };
    let seed = derive(derive(world.seed, "array", 0), &device.name, 0);
    let microphones = mismatch.draw(&usual, device.microphones.len(), seed)?;
    let mut settings = RenderSettings::new(device.rate_hz);
    settings.clock = DeviceClock {
        offset_s: device.clock.offset_s,
        drift_ppm: device.clock.drift_ppm,
    };
    settings.noise = diffuse(shared);
    settings.seed = seed;
    ArrayRenderer::new(
        &shared.room,
        sources(shared, device.rate_hz)?,
        microphones,
        &settings,
    )
}

/// Everything at a place that sounds.
fn sources(shared: &Arc<Shared>, rate_hz: u32) -> Result<Vec<SoundSource>, AcousticsError> {
    let world = &shared.world;
    let mut sources = Vec::new();
    for (number, person) in world.people.iter().enumerate() {
        if person.turns.is_empty() {
            continue;
        }
        let from = Arc::clone(shared);
        sources.push(SoundSource {
            name: person.name.clone(),
            path: Arc::new(move |time_s: f64| mouth(&from.world, number, time_s)),
            sound: speech(shared, number, rate_hz)?,
            directivity: Directivity::MOUTH,
            level_db: person.voice.level_db,
        });
    }
    for (number, noise) in world.noises.iter().enumerate() {
        if noise.place == NoisePlace::Diffuse {
            continue;
        }
        let mut sound = voices::noise(noise, rate_hz)?;
        if let (NoiseKind::Motor, NoisePlace::Base(base, _)) = (noise.kind, noise.place) {
            sound = Arc::new(Driven {
                shared: Arc::clone(shared),
                base,
                sound,
            });
        }
        let from = Arc::clone(shared);
        sources.push(SoundSource {
            name: noise.name.clone(),
            path: Arc::new(move |time_s: f64| emission(&from, number, time_s)),
            sound,
            directivity: directivity(noise),
            level_db: shared.noise_levels_db[number],
        });
    }
    Ok(sources)
}

/// What a person says; what the mouth goes by is heard as well where rates are alike.
fn speech(shared: &Shared, person: usize, rate_hz: u32) -> Result<Arc<dyn Sound>, AcousticsError> {
    match shared.speech.get(person) {
        Some(speech) if speech.rate_hz() == rate_hz => Ok(Arc::clone(speech) as Arc<dyn Sound>),
        _ => Ok(Arc::new(voices::speech(&shared.world.people[person], rate_hz)?)),
    }
}

/// Mouth and facing of a person who is in the room.
fn mouth(world: &World, person: usize, time_s: f64) -> Option<Emission> {
    let posture = world.posture(person, time_s)?;
    let position = posture.mouth(world.people[person].looks.head_half_axes_m);
    let facing = posture.world_from_head() * Vector3::x();
    is_inside(world, position).then_some(Emission { position, facing })
}

fn emission(shared: &Shared, noise: usize, time_s: f64) -> Option<Emission> {
    let world = &shared.world;
    let noise = &world.noises[noise];
    if let NoisePlace::Person(person) = noise.place {
        return mouth(world, person, time_s);
    }
    let position = shared.with_controls(|controls| world.noise_place(noise, controls, time_s))?;
    // Loudspeakers face the middle of the room.
    let size = world.setting.size_m;
    let middle =
        WorldPoint(world.setting.origin.0 + Vector3::new(0.5 * size[0], 0.5 * size[1], 0.5 * size[2]));
    let facing = middle.0 - position.0;
    let facing = if facing.norm() > 1e-6 {
        facing
    } else {
        Vector3::x()
    };
    is_inside(world, position).then_some(Emission { position, facing })
}

fn is_inside(world: &World, place: WorldPoint) -> bool {
    let within = place.0 - world.setting.origin.0;
    (0..3).all(|axis| (0.0..=world.setting.size_m[axis]).contains(&within[axis]))
}

fn directivity(noise: &Noise) -> Directivity {
    match (noise.kind, noise.place) {
        (_, NoisePlace::Person(_)) => Directivity::MOUTH,
        (NoiseKind::Television, _) => Directivity::CARDIOID,
        _ => Directivity::OMNIDIRECTIONAL,
    }
}

/// All noise from everywhere as one: its power, and the colour of the loudest.
fn diffuse(shared: &Shared) -> Option<DiffuseNoise> {
    let all = shared.world.noises.iter().zip(&shared.noise_levels_db);
    let diffuse = all.filter(|(noise, _)| noise.place == NoisePlace::Diffuse);
    let loudest = diffuse.clone().max_by(|one, other| one.1.total_cmp(other.1))?;
    let power: f64 = diffuse.map(|(_, level)| 10.0_f64.powf(level / 10.0)).sum();
    Some(DiffuseNoise {
        level_db: (10.0 * power.log10()).clamp(-200.0, 0.0),
        fall_db: match loudest.0.kind {
            NoiseKind::White => 0.0,
            NoiseKind::Street => 8.0,
            _ => 5.0,
        },
    })
}

/// The level of each noise: as written, or so far below speech at the microphones.
pub(super) fn noise_levels_db(world: &World, room: &Shoebox) -> Result<Vec<f64>, AcousticsError> {
    let relative = |noise: &Noise| matches!(noise.level, NoiseLevel::SignalToNoise(_));
    let mut comparison = None;
    if world.noises.iter().any(relative) {
        comparison = Comparison::new(world, room)?;
    }
    let mut levels = Vec::new();
    for noise in &world.noises {
        levels.push(match (noise.level, &mut comparison) {
            (NoiseLevel::Level(level_db), _) => level_db,
            (NoiseLevel::SignalToNoise(_), None) => NOTHING_TO_COMPARE_DB,
            (NoiseLevel::SignalToNoise(below_db), Some(comparison)) => {
                let wanted_db = comparison.speech_db - below_db;
                let place = match noise.place {
                    NoisePlace::Diffuse => None,
                    NoisePlace::Person(person) => speaking_place(world, person),
                    _ => {
                        let controls = world.controls().ok();
                        let place = controls.and_then(|controls| world.noise_place(noise, &controls, 0.0));
                        place.map(|position| Emission {
                            position,
                            facing: Vector3::x(),
                        })
                    }
                };
                // What is not in the room at the beginning is compared as if it were a metre away.
                match place.filter(|place| is_inside(world, place.position)) {
                    Some(place) => wanted_db - comparison.gain_db(&place, Directivity::OMNIDIRECTIONAL)?,
                    None => wanted_db,
                }
            }
        });
    }
    Ok(levels)
}

/// Where somebody is when they first speak.
fn speaking_place(world: &World, person: usize) -> Option<Emission> {
    let first = world.people.get(person)?.turns.first();
    mouth(world, person, first.map_or(0.0, |turn| 0.5 * (turn[0] + turn[1])))
}

/// Microphones at which levels are compared, and the level of speech there.
struct Comparison {
    responder: Responder,
    response: ImpulseResponse,
    microphones: Vec<WorldPoint>,
    speech_db: f64,
}

impl Comparison {
    fn new(world: &World, room: &Shoebox) -> Result<Option<Self>, AcousticsError> {
        let Ok(controls) = world.controls() else {
            return Ok(None);
        };
        let mut microphones = Vec::new();
        for array in &world.arrays {
            let mut places = vec![WorldPoint::new(0.0, 0.0, 0.0); array.microphones.len()];
            controls.microphones(array, &world.bases, 0.0, &mut places);
            // The first and the last stand for all of them.
            microphones.extend(places.first().copied());
            microphones.extend(places.last().copied().filter(|_| places.len() > 1));
        }
        microphones.truncate(MOST_COMPARED);
        let settings = ResponseSettings {
            rate_hz: COMPARED_HZ,
            length_s: Some(room.longest_t60_s().clamp(0.05, COMPARED_S)),
            order: None,
        };
        let mut comparison = Self {
            responder: Responder::new(room, &settings)?,
            response: ImpulseResponse::default(),
            microphones,
            speech_db: 0.0,
        };
        let talkers = (0..world.people.len()).filter(|person| !world.people[*person].turns.is_empty());
        let (mut power, mut count) = (0.0, 0);
        for person in talkers.take(MOST_COMPARED) {
            if let Some(place) = speaking_place(world, person) {
                let level_db = world.people[person].voice.level_db;
                let gain_db = comparison.gain_db(&place, Directivity::MOUTH)?;
                power += 10.0_f64.powf((level_db + gain_db) / 10.0);
                count += 1;
            }
        }
        if count == 0 || comparison.microphones.is_empty() {
            return Ok(None);
        }
        comparison.speech_db = 10.0 * (power / f64::from(count)).log10();
        Ok(Some(comparison))
    }

    /// Level at the microphones, on average, of a source of 0 dB at a metre.
    fn gain_db(&mut self, place: &Emission, directivity: Directivity) -> Result<f64, AcousticsError> {
        let mut energy = 0.0;
        for microphone in &self.microphones {
            self.responder
                .respond(place, directivity, *microphone, &mut self.response)?;
            energy += self
                .response
                .samples
                .iter()
                .map(|x| f64::from(*x).powi(2))
                .sum::<f64>();
        }
        let mean = energy / self.microphones.len().max(1) as f64;
        Ok(10.0 * mean.max(1e-20).log10())
    }
}

/// A sound that is the louder the faster a base moves: a tenth at rest, as it is at full speed.
struct Driven {
    shared: Arc<Shared>,
    base: usize,
    sound: Arc<dyn Sound>,
}

/// Loudness is renewed at whole multiples of this many samples.
const DRIVEN_STEP: i64 = 64;

impl Driven {
    fn loudness(&self, time_s: f64) -> f64 {
        let world = &self.shared.world;
        let device = &world.bases[self.base];
        const STEP_S: f64 = 0.02;
        self.shared.with_controls(|controls| {
            let [x, y, yaw] = controls.base(&world.bases, self.base, time_s);
            let [before_x, before_y, before_yaw] = controls.base(&world.bases, self.base, time_s - STEP_S);
            let speed = (x - before_x).hypot(y - before_y) / STEP_S / device.speed_m_s;
            let turn = (yaw - before_yaw).abs() / STEP_S / device.turn_rad_s;
            0.1 + 0.9 * speed.max(turn).min(1.0)
        })
    }
}

impl Sound for Driven {
    fn rate_hz(&self) -> u32 {
        self.sound.rate_hz()
    }

    fn fill(&self, first: i64, samples: &mut [f32]) {
        self.sound.fill(first, samples);
        let rate = f64::from(self.rate_hz());
        let mut at = first;
        let mut rest = samples;
        while !rest.is_empty() {
            let step = at.div_euclid(DRIVEN_STEP);
            let length = ((step + 1) * DRIVEN_STEP - at).min(rest.len() as i64) as usize;
            let (now, later) = rest.split_at_mut(length);
            let border = |step: i64| self.loudness((step * DRIVEN_STEP) as f64 / rate);
            let (from, to) = (border(step), border(step + 1));
            for (place, sample) in now.iter_mut().enumerate() {
                let part = (at - step * DRIVEN_STEP + place as i64) as f64 / DRIVEN_STEP as f64;
                *sample *= (from + (to - from) * part) as f32;
            }
            at += length as i64;
            rest = later;
        }
    }
}
