//! One step of a bootstrap filter: 1000 particles of six dimensions, predicted, weighted and resampled.
//!
//! `particle_step_numpy.py` does the same with numpy and filterpy; run both on one quiet machine to compare.

#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

use divan::Bencher;
use hearsight_core::Span;
use hearsight_filter::motion::{Langevin, LangevinAxis, LangevinIntegration, Motion, Noise, RandomWalk};
use hearsight_filter::{Generator, Particles, Resampling, fill_standard_normal, generator};

const COUNT: usize = 1000;
const DIMENSIONS: usize = 6;

fn main() {
    divan::main();
}

fn start() -> (Particles, Generator) {
    let mut random = generator(1, "bench", 0);
    let mut particles = Particles::new(DIMENSIONS, COUNT).unwrap();
    particles
        .draw_gaussian(&[0.0; DIMENSIONS], &[1.0; DIMENSIONS], &mut random)
        .unwrap();
    (particles, random)
}

fn walk() -> RandomWalk {
    (0..DIMENSIONS).fold(RandomWalk::new(), |walk, dimension| {
        walk.with(
            dimension,
            Noise::Additive {
                sigma_per_sqrt_sec: 0.5,
            },
        )
        .unwrap()
    })
}

/// A Gaussian likelihood over three dimensions, so that weights are as uneven as in use.
fn weigh(particles: &mut Particles) {
    let report = particles.reweight(|columns, log_weights| {
        let positions = columns[0].iter().zip(&columns[1]).zip(&columns[2]);
        for (log_weight, ((x, y), z)) in log_weights.iter_mut().zip(positions) {
            *log_weight -= 2.0 * f64::from(x * x + y * y + z * z);
        }
    });
    let _ = divan::black_box(report);
}

#[divan::bench(args = Resampling::ALL.map(Resampling::name))]
fn whole_step(bencher: Bencher<'_, '_>, scheme: &str) {
    let scheme = Resampling::ALL
        .into_iter()
        .find(|known| known.name() == scheme)
        .unwrap();
    let (mut particles, mut random) = start();
    let walk = walk();
    bencher.bench_local(|| {
        walk.step(&mut particles, Span::from_seconds(0.04), &mut random)
            .unwrap();
        weigh(&mut particles);
        particles.resample(scheme, &mut random).unwrap();
    });
}

#[divan::bench]
fn whole_step_langevin(bencher: Bencher<'_, '_>) {
    let axis = |axis| LangevinAxis {
        position: axis,
        velocity: axis + 3,
        rate_per_sec: 10.0,
        rms_velocity: 1.0,
    };
    let model = Langevin {
        axes: [0, 1, 2].map(axis).to_vec(),
        integration: LangevinIntegration::Exact,
    };
    let (mut particles, mut random) = start();
    bencher.bench_local(|| {
        model
            .step(&mut particles, Span::from_seconds(0.04), &mut random)
            .unwrap();
        weigh(&mut particles);
        particles.resample(Resampling::Systematic, &mut random).unwrap();
    });
}

#[divan::bench]
fn predict_only(bencher: Bencher<'_, '_>) {
    let (mut particles, mut random) = start();
    let walk = walk();
    bencher.bench_local(|| walk.step(&mut particles, Span::from_seconds(0.04), &mut random));
}

#[divan::bench]
fn weigh_only(bencher: Bencher<'_, '_>) {
    let (mut particles, _) = start();
    bencher.bench_local(|| {
        particles.make_uniform();
        weigh(&mut particles);
    });
}

#[divan::bench]
fn draw_only(bencher: Bencher<'_, '_>) {
    let (mut particles, mut random) = start();
    weigh(&mut particles);
    let mut ancestors = [0; COUNT];
    bencher.bench_local(|| Resampling::Systematic.draw(particles.weights(), &mut random, &mut ancestors));
}

#[divan::bench]
fn resample_only(bencher: Bencher<'_, '_>) {
    let (mut particles, mut random) = start();
    weigh(&mut particles);
    bencher.bench_local(|| {
        particles
            .resample(Resampling::Systematic, &mut random)
            .map(<[u32]>::len)
    });
}

#[divan::bench]
fn normals_1000(bencher: Bencher<'_, '_>) {
    let mut random = generator(1, "bench", 0);
    let mut normals = [0.0_f32; COUNT];
    bencher.bench_local(|| fill_standard_normal(&mut random, divan::black_box(&mut normals)));
}
