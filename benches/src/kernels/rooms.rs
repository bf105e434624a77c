//! Work on the sound of simulated rooms.

use crate::{Failure, Work};
use hearsight_core::{AudioBlock, WorldPoint};
use hearsight_sim::acoustics::{
    ArrayRenderer, Directivity, Emission, ImpulseResponse, Microphone, RenderSettings, Responder,
    ResponseSettings, Shoebox, ShoeboxSettings, SoundSource, Walls,
};
use hearsight_sim::voice::{Talker, TalkerKind, Turn};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The room of `compare_rooms.py`: its absorption is what that of T60 0.5 s comes to.
const SIZE_M: [f64; 3] = [6.0, 5.0, 3.0];
const ORDER: u32 = 66;

fn shoebox() -> Result<Shoebox, Failure> {
    let walls = Walls::Absorption([0.35; 6]);
    Ok(Shoebox::new(&ShoeboxSettings {
        jitter_m: 0.0,
        ..ShoeboxSettings::new(SIZE_M, walls)
    })?)
}

fn settings() -> ResponseSettings {
    // As long as the last image of this order needs: 66 times the longest side.
    ResponseSettings {
        rate_hz: 16_000,
        length_s: Some(f64::from(ORDER + 1) * 6.0 / 343.0),
        order: Some(ORDER),
    }
}

fn source() -> Emission {
    Emission {
        position: WorldPoint::new(1.2, 3.1, 1.6),
        facing: Vector3::x(),
    }
}

/// A response and everything that it needs, from nothing.
pub(super) fn response() -> Result<Work, Failure> {
    let room = shoebox()?;
    let mut response = ImpulseResponse::default();
    Ok(Box::new(move || {
        let made = Responder::new(&room, &settings()).and_then(|mut responder| {
            let ear = WorldPoint::new(4.4, 1.7, 1.1);
            responder.respond(&source(), Directivity::OMNIDIRECTIONAL, ear, &mut response)
        });
        made.map_or(f64::NAN, |()| energy(&response.samples))
    }))
}

/// A response where the images are known.
pub(super) fn another() -> Result<Work, Failure> {
    let mut responder = Responder::new(&shoebox()?, &settings())?;
    let mut response = ImpulseResponse::default();
    Ok(Box::new(move || {
        let ear = WorldPoint::new(4.4, 1.7, 1.1);
        let made = responder.respond(&source(), Directivity::OMNIDIRECTIONAL, ear, &mut response);
        made.map_or(f64::NAN, |()| energy(&response.samples))
    }))
}

/// A second of three people who walk and talk all the time, at eight microphones, T60 0.5 s.
pub(super) fn meeting(rate_hz: u32) -> Result<Work, Failure> {
    let room = Shoebox::new(&ShoeboxSettings::new(SIZE_M, Walls::T60(0.5)))?;
    let kinds = [TalkerKind::Man, TalkerKind::Woman, TalkerKind::Man];
    let sources = kinds.iter().enumerate().map(|(person, kind)| {
        let turns: Vec<Turn> = (0..40)
            .map(|turn| Turn {
                person,
                start_s: 3.0 * f64::from(turn),
                end_s: 3.0 * f64::from(turn) + 2.95,
            })
            .collect();
        let path = move |time_s: f64| {
            // A metre a second.
            let angle = time_s / 1.2 + TAU * person as f64 / 3.0;
            let position = WorldPoint::new(3.0 + 1.2 * angle.cos(), 2.5 + 1.2 * angle.sin(), 1.6);
            Some(Emission {
                position,
                facing: Vector3::new(-angle.sin(), angle.cos(), 0.0),
            })
        };
        Ok(SoundSource {
            name: format!("person {person}"),
            path: Arc::new(path),
            sound: Arc::new(Talker::new(*kind, person as u64).speak(&turns, person, rate_hz)?),
            directivity: Directivity::MOUTH,
            level_db: -30.0,
        })
    });
    let sources: Vec<SoundSource> = sources.collect::<Result<_, Failure>>()?;
    let places: Vec<WorldPoint> = (0..8)
        .map(|number| {
            let angle = TAU * f64::from(number) / 8.0;
            WorldPoint::new(3.0 + 0.1 * angle.cos(), 2.5 + 0.1 * angle.sin(), 0.8)
        })
        .collect();
    let mut renderer = ArrayRenderer::new(
        &room,
        sources,
        vec![Microphone::default(); 8],
        &RenderSettings::new(rate_hz),
    )?;
    let mut block = AudioBlock::default();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build();
    let pool = pool.ok();
    Ok(Box::new(move || {
        let mut second = || renderer.render(&places, rate_hz as usize, &mut block);
        let made = match &pool {
            Some(pool) => pool.install(second),
            None => second(),
        };
        made.map_or(f64::NAN, |()| energy(&block.channels[0]))
    }))
}

fn energy(samples: &[f32]) -> f64 {
    samples.iter().map(|sample| f64::from(*sample).powi(2)).sum()
}
