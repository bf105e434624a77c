//! Matrices from files to rigid poses.

use crate::geometry::Pose;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// How far from orthonormal a rotation in a file may be: files round to a few digits.
const TOLERANCE: f64 = 1e-3;
/// A larger rotation vector is one in degrees.
const LARGEST_ANGLE_RAD: f64 = 20.0;
/// Steps of the orthonormalization; it doubles its digits at each.
const ITERATIONS: usize = 8;

/// The rotation next to a matrix, or in words why there is none.
pub(super) fn rotation(matrix: Matrix3<f64>) -> Result<UnitQuaternion<f64>, String> {
    let gram = matrix * matrix.transpose() - Matrix3::identity();
    let error = gram.amax();
    if !(error.is_finite() && error <= TOLERANCE) {
        return Err(format!(
            "its rows must be orthonormal, but are off by {error:.2e}; give a rotation matrix, camera from world"
        ));
    }
    if matrix.determinant() < 0.0 {
        return Err("it mirrors (determinant -1) where it must rotate; swap the sign of one axis".into());
    }
    // Newton's iteration for the polar decomposition (Higham, "Computing the polar decomposition", 1986, eq. 3.4).
    let mut nearest = matrix;
    for _ in 0..ITERATIONS {
        let Some(inverse) = nearest.try_inverse() else {
            break;
        };
        nearest = (nearest + inverse.transpose()) / 2.0;
    }
    Ok(UnitQuaternion::from_rotation_matrix(
        &Rotation3::from_matrix_unchecked(nearest),
    ))
}

/// The rotation of a rotation vector (axis times angle in radians), or in words why there is none.
pub(super) fn rotation_of_vector(vector: Vector3<f64>) -> Result<UnitQuaternion<f64>, String> {
    if vector.amax() > LARGEST_ANGLE_RAD {
        return Err("it must be an axis times an angle in radians, at most a few turns".into());
    }
    Ok(UnitQuaternion::from_scaled_axis(vector))
}

/// The pose `[R | t]`.
pub(super) fn pose(rotation: UnitQuaternion<f64>, translation: Vector3<f64>) -> Pose {
    Pose {
        sensor_from_world: Isometry3::from_parts(Translation3::from(translation), rotation),
    }
}

/// The rigid pose whose projections are those of the matrix `[linear | offset]`, whose linear part is a rotation times
/// any factor other than zero, or in words why there is none.
///
/// A pixel is a ratio of rows, so a common factor cancels: dividing by the one that makes the linear part a rotation
/// moves no pixel and gives depths in metres. Its sign is that of the determinant, so what is seen lies in front.
pub(super) fn pose_of_similarity(linear: Matrix3<f64>, offset: Vector3<f64>) -> Result<Pose, String> {
    let factor = linear.determinant().cbrt();
    if !factor.is_normal() {
        return Err("it is singular: no camera sees like that; give K [R | t] up to a factor".into());
    }
    let rotation = rotation(linear / factor).map_err(|reason| {
        format!("without K and alignment it must be a rotation times a factor ({factor:.4}): {reason}")
    })?;
    let translation = offset / factor;
    if !translation.iter().all(|number| number.is_finite()) {
        return Err("it puts the camera at infinity; give K [R | t] up to a factor".into());
    }
    Ok(pose(rotation, translation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::WorldPoint;

    #[test]
    fn a_similarity_gives_the_pose_with_the_same_projections() {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -1.0, 2.0));
        let (matrix, offset) = (
            turn.to_rotation_matrix().into_inner(),
            Vector3::new(0.1, 0.2, 3.0),
        );
        for factor in [0.9993, 1.0, 17.0, -2.0] {
            let pose = pose_of_similarity(matrix * factor, offset * factor).unwrap();
            let point = WorldPoint::new(0.3, -0.7, 0.9);
            let expected = matrix * point.0.coords + offset;
            assert!((pose.camera_from_world(point).0.coords - expected).norm() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        assert!(
            rotation(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)))
                .unwrap_err()
                .contains("mirrors")
        );
        assert!(rotation_of_vector(Vector3::new(0.0, 1e300, 0.0)).is_err());
        assert!(rotation(Matrix3::identity() * 1.01).is_err());
        assert!(rotation(Matrix3::repeat(f64::NAN)).is_err());
        assert!(pose_of_similarity(Matrix3::zeros(), Vector3::zeros()).is_err());
        assert!(pose_of_similarity(Matrix3::identity() * 1e200, Vector3::zeros()).is_err());
        let almost = rotation(Matrix3::identity() + Matrix3::repeat(1e-5)).unwrap();
        assert!((almost.norm() - 1.0).abs() < 1e-14);
    }
}
