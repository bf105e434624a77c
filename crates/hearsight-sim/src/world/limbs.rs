//! Arms and legs: where joints are when hands and feet are somewhere.

use super::posture::Limb;
use hearsight_core::WorldPoint;
use nalgebra::{Point3, Vector3};

/// A limb of two bones from `root` that reaches for `target`; what is out of reach is pointed at. Of all places that
/// the joint can have it takes the one nearest to `hint`.
pub(crate) fn bend(root: Point3<f64>, target: Point3<f64>, lengths_m: [f64; 2], hint: Point3<f64>) -> Limb {
    let [upper, lower] = lengths_m;
    let way = target - root;
    let direction = way.try_normalize(1e-9).unwrap_or_else(|| -Vector3::z());
    let distance = way
        .norm()
        .clamp((upper - lower).abs() + 1e-3, 0.999 * (upper + lower));
    let along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
    let aside = (upper * upper - along * along).max(0.0).sqrt();
    let off = hint - root;
    let across = off - direction * off.dot(&direction);
    let across = across
        .try_normalize(1e-9)
        .unwrap_or_else(|| direction.cross(&Vector3::x()).normalize());
    Limb {
        root: WorldPoint(root),
        joint: WorldPoint(root + direction * along + across * aside),
        end: WorldPoint(root + direction * distance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bones_keep_their_lengths_and_the_joint_its_side() {
        let root = Point3::new(0.0, 0.0, 1.0);
        for target in [
            Point3::new(0.3, 0.1, 0.8),
            Point3::new(0.0, 0.0, 0.2),
            Point3::new(9.0, 0.0, 1.0),
            root,
        ] {
            let limb = bend(root, target, [0.4, 0.35], Point3::new(-1.0, 0.0, 0.5));
            assert!((limb.root.distance_m(limb.joint) - 0.4).abs() < 1e-9);
            assert!((limb.joint.distance_m(limb.end) - 0.35).abs() < 1e-9, "{limb:?}");
            assert!(limb.joint.0.x <= limb.end.0.x.max(0.0) + 1e-9);
        }
        let limb = bend(
            root,
            Point3::new(0.3, 0.1, 0.8),
            [0.4, 0.35],
            Point3::new(-1.0, 0.0, 0.5),
        );
        assert!((limb.end.0 - Point3::new(0.3, 0.1, 0.8)).norm() < 1e-9);
    }
}
