//! A simulated microphone array: samples in order of time, as a file of them would give.

use super::shared::Shared;
use crate::acoustics::{AcousticsError, ArrayRenderer};
use crate::world::ArrayDevice;
use hearsight_core::source::{AudioFormat, AudioSource, Delivery};
use hearsight_core::{AudioBlock, Fault, FaultKind, Span, WorldPoint};
use std::sync::Arc;

/// Samples a block: as many as a WAV file is read by, so that times of blocks are rounded alike.
const BLOCK: usize = 2048;
/// Of arrays that move by commands blocks are short, so that these are obeyed.
const COMMANDED_BLOCK: usize = 512;

/// Delivers the samples of one array.
pub struct SimulatedArray {
    shared: Arc<Shared>,
    number: usize,
    format: AudioFormat,
    renderer: ArrayRenderer,
    block: usize,
    total: u64,
    made: u64,
}

impl SimulatedArray {
    pub(super) fn new(shared: &Arc<Shared>, number: usize, renderer: ArrayRenderer) -> Self {
        let device = &shared.world.arrays[number];
        let total = samples(device, shared.world.seconds);
        Self {
            format: AudioFormat {
                rate_hz: device.rate_hz,
                channels: device.microphones.len(),
                samples: Some(total),
                start: device.clock.declared(Span::ZERO),
                live: false,
            },
            block: if device.base.is_some() {
                COMMANDED_BLOCK
            } else {
                BLOCK
            },
            total,
            made: 0,
            renderer,
            number,
            shared: Arc::clone(shared),
        }
    }

    /// When the next sample is taken on the common clock, as whoever reads the file believes it, seconds.
    pub fn end_s(&self) -> f64 {
        let device = &self.shared.world.arrays[self.number];
        let own = Span::of_samples(self.made as i64, device.rate_hz);
        device.clock.declared(own).seconds()
    }

    /// Replaces the block by the next samples; `false` at the end.
    ///
    /// # Errors
    /// A source or microphone outside the room, which resolved scenarios exclude for all but moving bases.
    pub fn record(&mut self, block: &mut AudioBlock) -> Result<bool, AcousticsError> {
        let count = (self.block as u64).min(self.total - self.made) as usize;
        if count == 0 {
            return Ok(false);
        }
        let world = &self.shared.world;
        let device = &world.arrays[self.number];
        let placement = |time_s: f64, places: &mut [WorldPoint]| {
            self.shared
                .with_controls(|controls| controls.microphones(device, &world.bases, time_s, places));
        };
        self.renderer.render(&placement, count, block)?;
        // What is lost on the way is silence, at its time.
        for channel in &mut block.channels {
            silence(device, self.made, channel);
        }
        block.rate_hz = device.rate_hz;
        let own = Span::of_samples(self.made as i64, device.rate_hz);
        block.time = device.clock.declared(own);
        self.made += count as u64;
        Ok(true)
    }
}

impl AudioSource for SimulatedArray {
    fn format(&self) -> &AudioFormat {
        &self.format
    }

    fn read(&mut self, block: &mut AudioBlock, faults: &mut Vec<Fault>) -> Delivery {
        match self.record(block) {
            Ok(true) => Delivery::Data,
            Ok(false) => Delivery::End,
            Err(error) => {
                faults.push(Fault {
                    sensor: self.shared.world.arrays[self.number].name.clone(),
                    time_s: self.end_s(),
                    kind: FaultKind::Lost,
                    detail: error.to_string(),
                });
                self.total = self.made;
                Delivery::End
            }
        }
    }
}

fn silence(device: &ArrayDevice, first: u64, channel: &mut [f32]) {
    let rate = f64::from(device.rate_hz);
    let sample = |time_s: f64| (device.clock.own_s(time_s) * rate - 1e-6).ceil() as i64 - first as i64;
    for [from, until] in &device.lost {
        let from = sample(*from).clamp(0, channel.len() as i64) as usize;
        let until = sample(*until).clamp(0, channel.len() as i64) as usize;
        if from < until {
            channel[from..until].fill(0.0);
        }
    }
}

/// Samples that an array takes before the scenario is over.
fn samples(device: &ArrayDevice, seconds: f64) -> u64 {
    let own_s = device.clock.own_s(seconds);
    (own_s * f64::from(device.rate_hz) - 1e-6).ceil().max(0.0) as u64
}
