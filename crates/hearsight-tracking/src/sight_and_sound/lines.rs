//! The point that suits a line of sight and a sound.

use crate::sound::PointEstimate;
use hearsight_core::camera::Camera;
use hearsight_core::{DistortedPixel, Ray, WorldPoint};
use nalgebra::{Matrix3, Unit, Vector3};

/// A face as its camera sees it: where it is but for the distance, of which its width gives an idea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightLine {
    /// From the camera through the mouth.
    pub ray: Ray,
    /// Standard deviation of the ray's direction, radians, above 0.
    pub deviation_rad: f64,
    /// Width of the face times the distance at which it is a metre wide: its width at a distance of d metres is
    /// `width_per_metre d`, metres.
    pub width_per_metre: f64,
    /// Distance along the ray that the width speaks for and its standard deviation, metres; none where it is not to
    /// be used.
    pub range_m: Option<(f64, f64)>,
}

/// A point that suits a face and a sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Where.
    pub point: WorldPoint,
    /// How sure, square metres; none from the plain form, which does not know.
    pub covariance: Option<Matrix3<f64>>,
    /// Half the distance of both lines, metres (e_av, section 4): the norm of the residual of eq. 20 over the root of
    /// two.
    pub residual_m: f64,
    /// Squared distance from the sound and from the ray in units of their deviations; 0 from the plain form.
    pub misfit: f64,
    /// Distance along the ray, metres.
    pub range_m: f64,
}

impl SightLine {
    /// The line of sight through a mouth at `pixel` (edges, not centres) of a face `width_px` wide, which in truth has
    /// `face_width_m` (mean and standard deviation). `deviation_px`: standard deviation of the pixel. None where the lens
    /// shows nothing there.
    pub fn new(
        camera: &Camera,
        pixel: (f32, f32),
        deviation_px: f64,
        width_px: f64,
        width_deviation_px: f64,
        face_width_m: Option<(f64, f64)>,
    ) -> Option<Self> {
        let ray = camera.ray(DistortedPixel::new(
            f64::from(pixel.0) - 0.5,
            f64::from(pixel.1) - 0.5,
        ))?;
        // A metre across the line of sight at a distance of one metre.
        let pixels = camera.pixels_per_metre(ray.at(1.0))?;
        if !(pixels > 0.0 && width_px > 0.0) {
            return None;
        }
        let range_m = face_width_m.map(|(mean_m, deviation_m)| {
            let range_m = pixels * mean_m / width_px;
            let relative = (deviation_m / mean_m).hypot(width_deviation_px / width_px);
            (range_m, range_m * relative)
        });
        Some(Self {
            ray,
            deviation_rad: deviation_px.max(0.1) / pixels,
            width_per_metre: width_px / pixels,
            range_m,
        })
    }

    /// What the camera alone says of the place, where the width speaks for a distance.
    pub fn estimate(&self) -> Option<PointEstimate> {
        self.range_m.map(|range_m| self.at_range(range_m))
    }

    /// The place at a distance (mean and standard deviation, metres).
    pub(super) fn at_range(&self, (range_m, deviation_m): (f64, f64)) -> PointEstimate {
        let along = self.along();
        let across = (self.deviation_rad * range_m).powi(2);
        PointEstimate {
            mean: self.ray.at(range_m),
            covariance: (Matrix3::identity() - along) * across + along * deviation_m.powi(2),
        }
    }

    /// The projection on the ray's direction.
    fn along(&self) -> Matrix3<f64> {
        let direction = self.ray.direction.into_inner();
        direction * direction.transpose()
    }
}

/// The middle of the shortest segment between a ray and the line through `origin` along `direction` (eq. 20, corrected:
/// five unknowns). None where they are parallel or meet behind the camera.
pub fn nearest_to_both(ray: &Ray, origin: WorldPoint, direction: Unit<Vector3<f64>>) -> Option<Meeting> {
    let (v, a) = (ray.direction.into_inner(), direction.into_inner());
    let between = origin.0 - ray.origin.0;
    let cosine = v.dot(&a);
    let determinant = 1.0 - cosine * cosine;
    if determinant < 1e-9 {
        return None;
    }
    let on_ray = (between.dot(&v) - cosine * between.dot(&a)) / determinant;
    let on_line = (cosine * between.dot(&v) - between.dot(&a)) / determinant;
    if !(on_ray > 0.0 && on_line.is_finite()) {
        return None;
    }
    let (first, second) = (ray.at(on_ray).0, origin.0 + a * on_line);
    Some(Meeting {
        point: WorldPoint(nalgebra::center(&first, &second)),
        covariance: None,
        residual_m: 0.5 * (first - second).norm(),
        misfit: 0.0,
        range_m: on_ray,
    })
}

/// The point most likely by both: generalized least squares, with the covariance of the result. None where a
/// covariance cannot be inverted or the point is behind the camera.
///
/// The ray's deviation across grows with the distance, so the distance is found in a few rounds.
pub fn weighted(sight: &SightLine, sound: &PointEstimate) -> Option<Meeting> {
    // An array is never surer than this: its own place and the speed of sound are not.
    let floor = Matrix3::identity() * LEAST_DEVIATION_M.powi(2);
    let by_sound = (sound.covariance + floor).try_inverse()?;
    let along = sight.along();
    let across = Matrix3::identity() - along;
    let origin = sight.ray.origin.0;
    let direction = sight.ray.direction.into_inner();
    let mut range_m = match sight.range_m {
        Some((range_m, _)) => range_m,
        None => (sound.mean.0 - origin).dot(&direction),
    }
    .max(NEAREST_M);
    let mut solved = None;
    for _ in 0..ROUNDS {
        let mut by_sight = across / (sight.deviation_rad * range_m).powi(2);
        let mut anchor = origin;
        if let Some((mean_m, deviation_m)) = sight.range_m {
            by_sight += along / deviation_m.powi(2);
            anchor = sight.ray.at(mean_m).0;
        }
        let covariance = (by_sound + by_sight).try_inverse()?;
        let point = covariance * (by_sound * sound.mean.0.coords + by_sight * anchor.coords);
        let (from_sound, from_sight) = (point - sound.mean.0.coords, point - anchor.coords);
        let misfit = from_sound.dot(&(by_sound * from_sound)) + from_sight.dot(&(by_sight * from_sight));
        range_m = (point - origin.coords).dot(&direction);
        if !(range_m > 0.0 && range_m.is_finite()) {
            return None;
        }
        range_m = range_m.max(NEAREST_M);
        solved = Some((point, covariance, misfit));
    }
    let (point, covariance, misfit) = solved?;
    Some(Meeting {
        point: WorldPoint(point.into()),
        covariance: Some(covariance),
        residual_m: 0.0,
        misfit,
        range_m,
    })
}

/// Standard deviation below which no sound is placed, metres.
const LEAST_DEVIATION_M: f64 = 0.05;
/// Nobody is nearer to a camera, metres.
const NEAREST_M: f64 = 0.2;
const ROUNDS: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::Pose;
    use hearsight_core::camera::{CameraModel, Pinhole};
    use nalgebra::{DMatrix, DVector};

    fn ray(origin: [f64; 3], target: [f64; 3]) -> Ray {
        let direction = Vector3::from(target) - Vector3::from(origin);
        Ray {
            origin: WorldPoint(origin.into()),
            direction: Unit::new_normalize(direction),
        }
    }

    #[test]
    fn the_closed_form_is_the_least_squares_solution_of_equation_20() {
        let ray = ray([0.3, 0.1, 1.8], [2.9, 2.6, 1.2]);
        let (origin, direction) = (WorldPoint::new(2.5, 2.9, 0.0), Vector3::z_axis());
        let meeting = nearest_to_both(&ray, origin, direction).unwrap();
        let mut matrix = DMatrix::<f64>::zeros(6, 5);
        for k in 0..3 {
            matrix[(k, k)] = 1.0;
            matrix[(k + 3, k)] = 1.0;
            matrix[(k, 3)] = -ray.direction[k];
            matrix[(k + 3, 4)] = -direction[k];
        }
        let side = DVector::from_iterator(6, ray.origin.0.iter().chain(origin.0.iter()).copied());
        let solution = matrix.clone().svd(true, true).solve(&side, 1e-12).unwrap();
        for k in 0..3 {
            assert!((solution[k] - meeting.point.0[k]).abs() < 1e-12);
        }
        assert!((solution[3] - meeting.range_m).abs() < 1e-12);
        let residual = (matrix * solution - side).norm() / 2.0_f64.sqrt();
        assert!((residual - meeting.residual_m).abs() < 1e-12, "{residual}");
    }

    #[test]
    fn parallel_lines_and_those_behind_the_camera_meet_nowhere() {
        let down = ray([0.0, 0.0, 2.0], [0.0, 0.0, 0.0]);
        assert_eq!(
            nearest_to_both(&down, WorldPoint::new(1.0, 0.0, 0.0), Vector3::z_axis()),
            None
        );
        let ahead = ray([0.0, 0.0, 1.0], [1.0, 0.0, 1.0]);
        assert_eq!(
            nearest_to_both(&ahead, WorldPoint::new(-1.0, 0.0, 0.0), Vector3::z_axis()),
            None
        );
    }

    fn sight(range_m: Option<(f64, f64)>) -> SightLine {
        SightLine {
            ray: ray([0.0, 0.0, 1.5], [2.0, 1.0, 1.3]),
            deviation_rad: 0.004,
            width_per_metre: 0.06,
            range_m,
        }
    }

    /// Sure across the direction from an array at (3, 0, 1), unsure along it.
    fn sound(point: [f64; 3]) -> PointEstimate {
        let along = (Vector3::from(point) - Vector3::new(3.0, 0.0, 1.0)).normalize();
        let along = along * along.transpose();
        PointEstimate {
            mean: WorldPoint(point.into()),
            covariance: (Matrix3::identity() - along) * 0.06_f64.powi(2) + along * 0.5_f64.powi(2),
        }
    }

    #[test]
    fn the_weighted_point_believes_each_where_it_is_sure() {
        let truth = Vector3::new(2.0, 1.0, 1.3);
        // The array is wrong by half a metre along its line: the ray corrects that, the plain form only halves it.
        let away = (truth - Vector3::new(3.0, 0.0, 1.0)).normalize();
        let wrong = truth + away * 0.5;
        let sound = sound(wrong.into());
        let better = weighted(&sight(None), &sound).unwrap();
        let plain = nearest_to_both(&sight(None).ray, sound.mean, Vector3::z_axis()).unwrap();
        let error = |meeting: &Meeting| (meeting.point.0.coords - truth).norm();
        println!("weighted {:.3} m, plain {:.3} m", error(&better), error(&plain));
        assert!(error(&better) < 0.12 && error(&better) < 0.6 * error(&plain));
        let covariance = better.covariance.unwrap();
        assert!(
            covariance
                .symmetric_eigenvalues()
                .iter()
                .all(|value| *value > 0.0 && *value < 0.05)
        );
        // A range from the face's width helps further and makes it surer.
        let ranged = weighted(
            &sight(Some((truth.metric_distance(&Vector3::new(0.0, 0.0, 1.5)), 0.2))),
            &sound,
        );
        let ranged = ranged.unwrap();
        assert!(error(&ranged) < error(&better));
        assert!(ranged.covariance.unwrap().trace() < covariance.trace());
    }

    #[test]
    fn a_sound_elsewhere_misfits() {
        let near = weighted(&sight(None), &sound([2.0, 1.0, 1.3])).unwrap();
        let far = weighted(&sight(None), &sound([1.0, 2.5, 1.3])).unwrap();
        assert!(
            near.misfit < 0.1 && far.misfit > 9.0,
            "{} {}",
            near.misfit,
            far.misfit
        );
    }

    #[test]
    fn a_face_of_known_width_tells_its_range() {
        let lens = Pinhole::ideal([1040.0, 1040.0], [799.5, 599.5]).unwrap();
        let pose = Pose::looking_at(WorldPoint::new(0.0, 0.0, 1.8), WorldPoint::new(3.0, 0.0, 1.8)).unwrap();
        let camera = Camera {
            model: CameraModel::Pinhole(lens),
            pose,
            width: 1600,
            height: 1200,
        };
        let sight = SightLine::new(&camera, (800.0, 600.0), 2.0, 62.4, 3.0, Some((0.15, 0.015))).unwrap();
        let (range_m, deviation_m) = sight.range_m.unwrap();
        assert!((range_m - 2.5).abs() < 1e-6, "{range_m}");
        assert!(deviation_m > 0.25 && deviation_m < 0.35, "{deviation_m}");
        let estimate = sight.estimate().unwrap();
        assert!(estimate.mean.distance_m(WorldPoint::new(2.5, 0.0, 1.8)) < 1e-6);
        assert!((sight.width_per_metre * 2.5 - 0.15).abs() < 1e-9);
    }
}
