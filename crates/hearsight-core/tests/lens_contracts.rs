//! Lenses with random coefficients, also absurd ones: what projects comes back, and nothing folds.

use hearsight_core::camera::{Fisheye, FisheyeParameters, Pinhole, PinholeParameters};
use hearsight_core::{CameraPoint, DistortedPixel, Projection};
use proptest::prelude::*;

/// A direction that projects is the one seen at its pixel; a pixel that shows a direction is where that projects.
fn check(lens: &dyn Projection, point: [f64; 3], pixel: [f64; 2]) -> Result<(), TestCaseError> {
    let point = CameraPoint(point.into());
    if let Some((seen, jacobian)) = lens.project_with_jacobian(point) {
        prop_assert!(
            seen.u.is_finite() && seen.v.is_finite() && jacobian.iter().all(|number| number.is_finite())
        );
        // Next to a fold a whole region has nearly the same pixel: there the way back is not determined.
        let steepness =
            (jacobian * jacobian.transpose()).determinant().sqrt() * point.0.coords.norm_squared();
        if steepness > 1.0 {
            let direction = lens.unproject(seen);
            prop_assert!(
                direction.is_some(),
                "nothing is seen at {seen:?}, where {point:?} projects"
            );
            let angle = direction.map_or(0.0, |direction| direction.angle(&point.0.coords));
            prop_assert!(angle < 1e-6, "{angle} rad off");
        }
    }
    let pixel = DistortedPixel::new(pixel[0], pixel[1]);
    if let Some(direction) = lens.unproject(pixel) {
        let back = lens.project(CameraPoint((direction.into_inner() * 2.0).into()));
        let error = back.map(|back| (back.u - pixel.u).hypot(back.v - pixel.v));
        prop_assert!(
            error.is_none_or(|error| error < 1e-6),
            "{pixel:?} returns {error:?} px off"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pinholes_never_fold(
        radial in [-0.6..0.6_f64, -0.4..0.4_f64, -0.2..0.2_f64],
        point in [-4.0..4.0_f64, -4.0..4.0_f64, -0.5..4.0_f64],
        pixel in [-900.0..1500.0_f64, -900.0..1500.0_f64],
    ) {
        let lens = Pinhole::new(PinholeParameters {
            focal_px: [400.0, 410.0], centre_px: [320.0, 240.0], radial, tangential: [0.0; 2],
        });
        check(&lens.unwrap(), point, pixel)?;
    }

    #[test]
    fn pinholes_with_tangential_distortion_return_too(
        radial in [-0.4..0.1_f64, -0.0..0.2_f64, -0.01..0.05_f64],
        tangential in [-0.01..0.01_f64, -0.01..0.01_f64],
        point in [-0.7..0.7_f64, -0.5..0.5_f64, 1.0..4.0_f64],
        pixel in [0.0..640.0_f64, 0.0..480.0_f64],
    ) {
        let lens = Pinhole::new(PinholeParameters {
            focal_px: [500.0, 510.0], centre_px: [320.0, 240.0], radial, tangential,
        });
        check(&lens.unwrap(), point, pixel)?;
    }

    #[test]
    fn fisheyes_never_fold(
        radial in [-0.3..0.3_f64, -0.2..0.2_f64, -0.1..0.1_f64, -0.05..0.05_f64],
        point in [-4.0..4.0_f64, -4.0..4.0_f64, -2.0..4.0_f64],
        pixel in [-900.0..1500.0_f64, -900.0..1500.0_f64],
    ) {
        let lens = Fisheye::new(FisheyeParameters { focal_px: [280.0, 283.0], centre_px: [320.0, 240.0], radial });
        check(&lens.unwrap(), point, pixel)?;
    }
}
