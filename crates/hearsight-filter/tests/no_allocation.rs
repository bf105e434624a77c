//! A step allocates nothing: live tracking must not wait for memory.

#![expect(unsafe_code, reason = "counting allocations means being the allocator")]

use hearsight_core::Span;
use hearsight_filter::motion::{
    ConstantVelocity, ConstantVelocityAxis, Langevin, LangevinAxis, LangevinIntegration, Motion, Noise,
    RandomWalk,
};
use hearsight_filter::{Particles, Resampling, generator};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// Of this thread alone: what runs the test allocates when it likes.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and the memory came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_step_allocates_nothing() {
    let axis = [0, 3];
    let [position, velocity] = axis;
    let models: [Box<dyn Motion>; 3] = [
        Box::new(
            RandomWalk::new()
                .with(
                    2,
                    Noise::Relative {
                        sigma_per_sqrt_sec: 0.1,
                    },
                )
                .unwrap(),
        ),
        Box::new(ConstantVelocity {
            axes: vec![ConstantVelocityAxis {
                position,
                velocity,
                diffusion: 1.0,
            }],
        }),
        Box::new(Langevin {
            axes: vec![LangevinAxis {
                position,
                velocity,
                rate_per_sec: 10.0,
                rms_velocity: 1.0,
            }],
            integration: LangevinIntegration::Exact,
        }),
    ];
    let mut random = generator(1, "test", 0);
    let mut particles = Particles::new(6, 1001).unwrap();
    particles
        .draw_gaussian(&[0.0; 6], &[1.0; 6], &mut random)
        .unwrap();
    let importance = vec![1.0; 1001];
    let (mut mean, mut covariance) = ([0.0; 6], [0.0; 36]);
    let before = ALLOCATIONS.get();
    for scheme in Resampling::ALL {
        for model in &models {
            model
                .step(&mut particles, Span::from_seconds(0.04), &mut random)
                .unwrap();
            // A state that is not finite, so that setting aside is counted as well.
            particles.column_mut(0)[17] = f32::NAN;
            let report = particles.reweight(|columns, log_weights| {
                for (log_weight, x) in log_weights.iter_mut().zip(&columns[0]) {
                    *log_weight -= f64::from(x * x);
                }
            });
            assert_eq!(report.quarantined, 1);
            particles.mean_into(&mut mean).unwrap();
            particles.covariance_into(&mut covariance).unwrap();
            particles
                .resample_by_importance(&importance, scheme, &mut random)
                .map(|_| ())
                .unwrap();
            particles.resample(scheme, &mut random).unwrap();
        }
    }
    assert_eq!(ALLOCATIONS.get(), before);
}
