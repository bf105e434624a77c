//! Impulse responses between a source and a microphone that stay where they are.

use super::error::{AcousticsError, check};
use super::lattice::{Lattice, Reach};
use super::room::Shoebox;
use super::source::{Directivity, Emission};
use super::synthesis::{Link, Scratch, Synthesis, unit};
use hearsight_core::WorldPoint;
use std::f64::consts::PI;

/// Longest response, seconds.
const LONGEST_S: f64 = 10.0;

/// How long and how complete a response is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseSettings {
    /// Samples a second, 1000 to 400000.
    pub rate_hz: u32,
    /// Seconds from the emission, at most 10; by default the longest reverberation time, and at least what the direct
    /// sound needs.
    pub length_s: Option<f64>,
    /// Reflections on the way at most; by default whatever arrives in that time.
    pub order: Option<u32>,
}

/// What arrives at a microphone of an impulse at a source.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImpulseResponse {
    /// Samples a second.
    pub rate_hz: u32,
    /// Samples before the instant of emission: kernels of early arrivals reach into them.
    pub lead: usize,
    /// The samples; an impulse on the source's axis at 1 m is 1.
    pub samples: Vec<f32>,
}

/// Makes impulse responses of one room for sources and microphones that stay where they are.
pub struct Responder {
    room: Shoebox,
    samples: usize,
    rate_hz: u32,
    lattice: Lattice,
    synthesis: Synthesis,
    scratch: Scratch,
}

impl Responder {
    /// Lists the images, all of them.
    ///
    /// # Errors
    /// [`AcousticsError::Setting`] where rate or length is out of range, or there would be more than 50 million images.
    pub fn new(room: &Shoebox, settings: &ResponseSettings) -> Result<Self, AcousticsError> {
        let ResponseSettings {
            rate_hz,
            length_s,
            order,
        } = *settings;
        check(
            (1000..=400_000).contains(&rate_hz),
            "rate_hz",
            "within 1000 and 400000",
            f64::from(rate_hz),
        )?;
        let speed = room.settings().speed_m_s;
        let direct_s = room.diagonal_m() / speed + 0.005;
        let length_s = length_s.unwrap_or_else(|| room.longest_t60_s().max(direct_s));
        check(
            (0.0..=LONGEST_S).contains(&length_s),
            "length_s of responses",
            "within 0 and 10",
            length_s,
        )?;
        let samples = (length_s * f64::from(rate_hz)).ceil() as usize;
        let synthesis = Synthesis::new(room, rate_hz, samples);
        // Kernels reach back from beyond the end.
        let reached_s = length_s + synthesis.lead() as f64 / f64::from(rate_hz);
        let distance_m = reached_s * speed + room.diagonal_m();
        let volume: f64 = room.settings().size_m.iter().product();
        let by_distance = 4.0 / 3.0 * PI * distance_m.powi(3) / volume;
        let by_order = order.map_or(f64::INFINITY, |order| 4.0 / 3.0 * f64::from(order).powi(3));
        check(
            by_distance.min(by_order) <= 5e7,
            "the number of images of a response",
            "at most 50 million: shorten it or lower its order",
            by_distance.min(by_order),
        )?;
        let reach = Reach {
            distance_m,
            order: order.unwrap_or(u32::MAX),
            density_per_m: f64::INFINITY,
        };
        Ok(Self {
            room: room.clone(),
            samples,
            rate_hz,
            lattice: Lattice::new(room, &reach),
            scratch: synthesis.scratch(),
            synthesis,
        })
    }

    /// How many images there are besides the source itself.
    pub fn images(&self) -> usize {
        self.lattice.len()
    }

    /// The response from a source to a microphone, into `response`.
    ///
    /// # Errors
    /// [`AcousticsError::Outside`] where either is not in the room, [`AcousticsError::Setting`] for a directivity out of
    /// range.
    pub fn respond(
        &mut self,
        source: &Emission,
        directivity: Directivity,
        microphone: WorldPoint,
        response: &mut ImpulseResponse,
    ) -> Result<(), AcousticsError> {
        let everywhere = directivity.everywhere;
        check(
            (0.5..=1.0).contains(&everywhere),
            "the source's directivity",
            "within 0.5 and 1",
            everywhere,
        )?;
        let link = Link {
            source_m: self
                .room
                .inside(source.position, 0.0, || "the source".to_owned())?,
            facing: unit(source.facing),
            directivity,
            microphone_m: self
                .room
                .inside(microphone, 0.0, || "the microphone".to_owned())?,
            delay_s: 0.0,
        };
        self.synthesis.add_direct(&link, &mut self.scratch);
        self.synthesis.add(&self.lattice, &link, None, &mut self.scratch);
        let samples = self.synthesis.finish(&mut self.scratch)?;
        response.rate_hz = self.rate_hz;
        response.lead = self.synthesis.lead();
        response.samples.clear();
        response
            .samples
            .extend_from_slice(&samples[..self.synthesis.lead() + self.samples]);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
