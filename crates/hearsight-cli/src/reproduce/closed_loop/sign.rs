//! Equation 24 as printed and corrected: from which column does each hear the talker, who is left or right of the camera?

use super::super::Measured;
use hearsight::core::Moment;
use hearsight::core::source::Delivery;
use hearsight::media::{Camera, Microphones, MomentOptions, MomentReader};
use hearsight::sim::simulation::Simulation;
use hearsight::tracking::percepts::{ArrayPercepts, ArraySettings, PairBearing, Weighting};
use miette::{IntoDiagnostic, miette};
use std::collections::BTreeMap;

/// The equation as it is printed.
pub(super) const PRINTED: &str = "printed";
/// Corrected.
pub(super) const CORRECTED: &str = "corrected";
/// A column is right within this share of the picture's width.
const NEAR: f64 = 0.06;

pub(super) fn measure(simulation: &Simulation) -> miette::Result<Measured> {
    let room = simulation.room();
    let (Some(sensor), Some(array)) = (room.cameras.first(), room.arrays.first()) else {
        return Err(miette!("the scene needs a camera and an array"));
    };
    let [first, second] = array.microphones.as_slice() else {
        return Err(miette!("the array of the scene must be a pair"));
    };
    let camera = sensor
        .calibration
        .ok_or_else(|| miette!("the camera of the scene has no calibration"))?;
    let view_rad = camera
        .horizontal_field_of_view_rad()
        .ok_or_else(|| miette!("the camera of the scene has no field of view"))?;
    let width = camera.width as f64;
    let speed = room.speed_of_sound_m_s;
    let bearing = PairBearing::new(first.distance_m(*second), speed, width, view_rad).into_diagnostic()?;
    let settings = ArraySettings {
        weighting: Weighting::MaximumLikelihood { reverberation: 0.3 },
        bands: false,
        onset_filter: false,
        ..ArraySettings::default()
    };
    let mut heard = ArrayPercepts::new(settings, array, speed).into_diagnostic()?;
    let picture = Camera {
        name: sensor.name.clone(),
        source: Box::new(simulation.camera(0)),
    };
    let microphones = Microphones {
        name: array.name.clone(),
        source: Box::new(simulation.array(0).into_diagnostic()?),
    };
    let mut reader =
        MomentReader::new(vec![picture], vec![microphones], MomentOptions::default()).into_diagnostic()?;
    let mut counts: BTreeMap<(&str, &str), [u32; 2]> = BTreeMap::new();
    let mut moment = Moment::default();
    while reader.read(&mut moment) == Delivery::Data {
        if moment.tick >= simulation.ticks() {
            break;
        }
        heard.hear(moment.audio.first().and_then(|block| block.get()));
        let truth = simulation.truth(moment.tick);
        let mut talkers = truth.people.iter().filter(|person| person.speaking);
        let (Some(talker), None) = (talkers.next(), talkers.next()) else {
            continue;
        };
        let head = talker.views.first().and_then(|view| view.head);
        let Some(head) = head.filter(|_| heard.has_sound() && heard.has_onset()) else {
            continue;
        };
        let column = head.left + 0.5 * head.width;
        let side = if column < 0.5 * width { "left" } else { "right" };
        let found = [
            (
                PRINTED,
                best(&heard, width, |column| bearing.printed_delay_s(column)),
            ),
            (CORRECTED, best(&heard, width, |column| bearing.delay_s(column))),
        ];
        for (rule, found) in found {
            let [right, all] = counts.entry((rule, side)).or_default();
            *right += u32::from((found - column).abs() < NEAR * width);
            *all += 1;
        }
    }
    let mut measured = Measured::new();
    for ((rule, side), [right, all]) in counts {
        let metrics = measured.entry(rule.to_owned()).or_default();
        metrics.insert(side.to_owned(), f64::from(right) / f64::from(all));
    }
    Ok(measured)
}

/// The column whose delay has the highest correlation.
fn best(heard: &ArrayPercepts, width: f64, delay_s: impl Fn(f64) -> f64) -> f64 {
    let columns = (0..width as usize).map(|column| column as f64 + 0.5);
    columns
        .map(|column| (column, heard.onset_height(delay_s(column))))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0.0, |(column, _)| column)
}
