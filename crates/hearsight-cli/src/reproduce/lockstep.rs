//! Variants of systems side by side on one simulation: each gets the same moments, so that differences are theirs alone,
//! and the room is rendered once.

use super::observed::Observed;
use hearsight::core::record::{SCENE_SCHEMA_VERSION, Scene};
use hearsight::core::room::Room;
use hearsight::core::source::Delivery;
use hearsight::core::truth::TruthRecord;
use hearsight::core::{Moment, Span};
use hearsight::media::{Camera, Microphones, MomentOptions, MomentReader};
use hearsight::sim::simulation::Simulation;
use hearsight::systems::{System, build};
use miette::{IntoDiagnostic, miette};
use serde_json::Value;

/// A system with parameters of its own.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    /// Its name in tables.
    pub(crate) name: &'static str,
    /// Name of the system.
    pub(crate) system: &'static str,
    /// Its parameters.
    pub(crate) parameters: Value,
}

/// Runs the variants over the whole simulation, and notes what each says of the picture of the first camera.
pub(crate) fn observe(
    simulation: &Simulation,
    seed: u64,
    variants: &[Variant],
) -> miette::Result<Vec<Observed>> {
    let room = simulation.room();
    let camera = room
        .cameras
        .first()
        .ok_or_else(|| miette!("the scene has no camera"))?
        .name
        .clone();
    let mut observed: Vec<Observed> = Vec::new();
    follow(simulation, seed, variants, &mut |_| (), &mut |said| {
        if observed.is_empty() {
            observed.extend(variants.iter().map(|_| Observed::new(said.interval_s)));
        }
        observed[said.variant].push(&camera, said.scene, said.truth);
    })?;
    Ok(observed)
}

/// What one variant said of one tick, beside what was so.
pub(crate) struct Said<'a> {
    /// Place of the variant in the list.
    pub(crate) variant: usize,
    /// Time from tick to tick, seconds.
    pub(crate) interval_s: f64,
    /// What it said.
    pub(crate) scene: &'a Scene,
    /// What was so.
    pub(crate) truth: &'a TruthRecord,
}

/// Runs the variants over the whole simulation, and gives each tick of each to `each`. `spoil` may damage a moment before
/// any of them gets it, as broken devices do.
pub(crate) fn follow(
    simulation: &Simulation,
    seed: u64,
    variants: &[Variant],
    spoil: &mut dyn FnMut(&mut Moment),
    each: &mut dyn FnMut(Said<'_>),
) -> miette::Result<()> {
    let room = simulation.room();
    let cameras = room.cameras.iter().enumerate().map(|(number, sensor)| Camera {
        name: sensor.name.clone(),
        source: Box::new(simulation.camera(number)),
    });
    let arrays = room.arrays.iter().enumerate().map(|(number, sensor)| {
        Ok::<_, miette::Report>(Microphones {
            name: sensor.name.clone(),
            source: Box::new(simulation.array(number).into_diagnostic()?),
        })
    });
    let arrays = arrays.collect::<miette::Result<Vec<_>>>()?;
    let mut reader =
        MomentReader::new(cameras.collect(), arrays, MomentOptions::default()).into_diagnostic()?;
    let mut systems = build_all(variants, &room, seed)?;
    let interval_s = reader.tick().seconds();
    run(
        simulation,
        &mut reader,
        &mut systems,
        spoil,
        &mut |variant, _, scene, truth| {
            each(Said {
                variant,
                interval_s,
                scene,
                truth,
            });
        },
    )
}

/// The variants as systems for one room.
pub(crate) fn build_all(
    variants: &[Variant],
    room: &Room,
    seed: u64,
) -> miette::Result<Vec<Box<dyn System>>> {
    let built = variants
        .iter()
        .map(|variant| build(variant.system, &variant.parameters, room, seed).into_diagnostic());
    built.collect()
}

/// What is told of a step: the number of the system, the system, what it said, and what was so.
pub(crate) type Each<'a> = dyn FnMut(usize, &dyn System, &Scene, &TruthRecord) + 'a;

/// Runs systems over what `reader` gives of a simulation, side by side, and tells `each` of every step.
pub(crate) fn run(
    simulation: &Simulation,
    reader: &mut MomentReader,
    systems: &mut [Box<dyn System>],
    spoil: &mut dyn FnMut(&mut Moment),
    each: &mut Each<'_>,
) -> miette::Result<()> {
    let interval_s = reader.tick().seconds();
    let (mut moment, mut scene) = (Moment::default(), Scene::default());
    while reader.read(&mut moment) == Delivery::Data {
        if moment.tick >= simulation.ticks() {
            break;
        }
        let truth = simulation.truth(moment.tick);
        let apart = simulation.tick_time(moment.tick) - moment.time;
        if apart.magnitude() > Span::from_seconds(0.25 * interval_s) {
            return Err(miette!(
                "tick {} is {} s from the truth's",
                moment.tick,
                apart.seconds()
            ));
        }
        spoil(&mut moment);
        for (variant, system) in systems.iter_mut().enumerate() {
            step(system.as_mut(), &moment, &mut scene);
            each(variant, system.as_ref(), &scene, &truth);
        }
    }
    Ok(())
}

fn step(system: &mut dyn System, moment: &Moment, scene: &mut Scene) {
    scene.schema.clear();
    scene.schema.push_str(SCENE_SCHEMA_VERSION);
    scene.tick = moment.tick;
    scene.time_s = moment.time.seconds();
    system.step(moment, scene);
}
