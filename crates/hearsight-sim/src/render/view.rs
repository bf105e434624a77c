//! A camera's rays and the room as it shows it without people, kept as long as neither camera nor light changes.

use super::lamps::Lamps;
use super::stage::Stage;
use crate::world::Colour;
use hearsight_core::{Camera, CameraModel, DistortedPixel, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Samples a pixel.
pub(super) const SAMPLES: usize = 4;
/// Where in the pixel each sample lies, pixels from its centre: a turned square.
pub(super) const OFFSETS_PX: [[f32; 2]; SAMPLES] =
    [[-0.125, -0.375], [0.375, -0.125], [-0.375, 0.125], [0.125, 0.375]];

/// The room without people.
#[derive(Clone, Debug, Default)]
pub(super) struct View {
    lens: Option<(CameraModel, usize, usize)>,
    /// Directions of pixel centres in the camera's frame, with a border of one pixel all around; not a number where
    /// the lens shows nothing.
    rays: Vec<Vector3<f32>>,
    state: Option<(Pose, Option<Pose>, Vec<f64>)>,
    /// Light of each pixel, the mean of its samples.
    pub(super) light: Vec<Colour>,
    /// One over the distance of each sample of a pixel, 1/m; 0 where nothing is.
    pub(super) nearness: Vec<[f32; SAMPLES]>,
    /// Where the first sample of each pixel lies on the floor, metres; not a number where it does not.
    pub(super) floor: Vec<[f32; 2]>,
}

impl View {
    /// Draws the room anew where something has changed.
    pub(super) fn update(
        &mut self,
        stage: &Stage,
        lamps: &Lamps,
        gains: &[f64],
        camera: &Camera,
        closing: Option<&Pose>,
    ) {
        let lens = (camera.model, camera.width, camera.height);
        if self.lens != Some(lens) {
            self.trace_lens(camera);
            self.lens = Some(lens);
            self.state = None;
        }
        let same = self.state.as_ref().is_some_and(|(pose, end, lamps)| {
            *pose == camera.pose && end.as_ref() == closing && lamps == gains
        });
        if !same {
            self.draw(stage, lamps, camera, closing);
            let mut kept = self.state.take().map_or_else(Vec::new, |(_, _, lamps)| lamps);
            kept.clear();
            kept.extend_from_slice(gains);
            self.state = Some((camera.pose, closing.copied(), kept));
        }
    }

    fn trace_lens(&mut self, camera: &Camera) {
        let (columns, rows) = (camera.width + 2, camera.height + 2);
        self.rays.clear();
        self.rays.resize(columns * rows, Vector3::repeat(f32::NAN));
        let model = &camera.model;
        self.rays
            .par_chunks_exact_mut(columns)
            .enumerate()
            .for_each(|(row, rays)| {
                let lens = model.projection();
                for (column, ray) in rays.iter_mut().enumerate() {
                    let pixel = DistortedPixel::new(column as f64 - 1.0, row as f64 - 1.0);
                    if let Some(direction) = lens.unproject(pixel) {
                        *ray = direction.into_inner().map(|part| part as f32);
                    }
                }
            });
    }

    fn draw(&mut self, stage: &Stage, lamps: &Lamps, camera: &Camera, closing: Option<&Pose>) {
        let (width, height) = (camera.width, camera.height);
        self.light.resize(width * height, [0.0; 3]);
        self.nearness.resize(width * height, [0.0; SAMPLES]);
        self.floor.resize(width * height, [f32::NAN; 2]);
        if width * height == 0 {
            return;
        }
        let poses: [_; SAMPLES] = std::array::from_fn(|sample| {
            let pose = between(&camera.pose, closing, sample_time(sample, SAMPLES));
            let rotation = pose.sensor_from_world.rotation.to_rotation_matrix();
            let turn = rotation.matrix().transpose().map(|part| part as f32);
            (turn, pose.centre().0.coords.map(|coordinate| coordinate as f32))
        });
        let rays = &self.rays;
        let columns = width + 2;
        let lights = self.light.par_chunks_exact_mut(width);
        let others = self
            .nearness
            .par_chunks_exact_mut(width)
            .zip(self.floor.par_chunks_exact_mut(width));
        lights
            .zip(others)
            .enumerate()
            .for_each(|(y, (light, (nearness, floor)))| {
                for x in 0..width {
                    let at = (y + 1) * columns + x + 1;
                    let middle = rays[at];
                    let across = slope(rays[at - 1], middle, rays[at + 1]);
                    let down = slope(rays[at - columns], middle, rays[at + columns]);
                    let pixel_rad = across.norm().max(down.norm());
                    let mut sum = [0.0; 3];
                    nearness[x] = [0.0; SAMPLES];
                    floor[x] = [f32::NAN; 2];
                    for (sample, ([dx, dy], (turn, origin))) in OFFSETS_PX.iter().zip(&poses).enumerate() {
                        let ray = turn * (middle + across * *dx + down * *dy);
                        let Some(direction) = ray.try_normalize(1e-6) else {
                            continue;
                        };
                        let Some(hit) = stage.hit(*origin, direction) else {
                            continue;
                        };
                        nearness[x][sample] = 1.0 / hit.distance;
                        if sample == 0 && hit.normal.z > 0.5 && hit.place.z < 0.02 {
                            floor[x] = [hit.place.x, hit.place.y];
                        }
                        let radiance = hit.radiance(stage, lamps, 0.5 * pixel_rad);
                        for (sum, channel) in sum.iter_mut().zip(radiance) {
                            *sum += channel / SAMPLES as f32;
                        }
                    }
                    light[x] = sum;
                }
            });
    }
}

/// When a sample is taken, -0.5 (the shutter opens) to 0.5 (it closes), of so many.
pub(super) fn sample_time(sample: usize, count: usize) -> f32 {
    (sample as f32 + 0.5) / count as f32 - 0.5
}

/// The pose at a time of the shutter, -0.5 to 0.5.
pub(super) fn between(opening: &Pose, closing: Option<&Pose>, time: f32) -> Pose {
    let Some(closing) = closing else { return *opening };
    let share = f64::from(time) + 0.5;
    let (from, to) = (&opening.sensor_from_world, &closing.sensor_from_world);
    let rotation = from
        .rotation
        .try_slerp(&to.rotation, share, 1e-9)
        .unwrap_or(from.rotation);
    // The camera's place moves evenly, not the translation that depends on the turn.
    let centre = opening.centre().0.coords.lerp(&closing.centre().0.coords, share);
    let translation = -(rotation * centre);
    Pose {
        sensor_from_world: nalgebra::Isometry3::from_parts(translation.into(), rotation),
    }
}

/// Change a pixel, from whichever neighbours are seen.
fn slope(before: Vector3<f32>, middle: Vector3<f32>, after: Vector3<f32>) -> Vector3<f32> {
    let central = (after - before) * 0.5;
    [central, after - middle, middle - before]
        .into_iter()
        .find(|step| !step.x.is_nan())
        .unwrap_or_else(Vector3::zeros)
}
