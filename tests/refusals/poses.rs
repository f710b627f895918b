//! Promise: `new` rejects a pose whose rotation is not normalised, with a text that states the
//! remedy, and `new_normalized` accepts it; both reject a rotation without a direction.

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::{PoseError, RelativePose, Tracker, normalize_rotation, polyhedron::solids};

fn pose(w: f64, i: f64, j: f64, k: f64) -> Isometry3<f64> {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::new(3.0, 0.0, 0.0), rotation)
}

#[test]
fn an_integrated_rotation_is_accepted_when_normalised() {
    let step = UnitQuaternion::from_scaled_axis(Vector3::new(0.01, 0.02, 0.03));
    let mut rotation = UnitQuaternion::identity();
    // The drift of products without normalisation: about 1e-16 each.
    for _ in 0..40_000 {
        rotation = UnitQuaternion::new_unchecked(rotation.into_inner() * step.into_inner());
    }
    let drifted = Isometry3::from_parts(Translation3::new(3.0, 0.0, 0.0), rotation);
    let refused = RelativePose::from_isometry(&drifted).expect_err("40,000 products drift");
    assert!(refused.to_string().contains("normalize_rotation"), "{refused}");
    assert!(RelativePose::new_normalized(&Isometry3::identity(), &drifted).is_ok());
    assert!(RelativePose::from_isometry(&normalize_rotation(&drifted)).is_ok());
}

#[test]
fn any_length_of_a_quaternion_is_normalised() {
    let ball = solids::icosahedron(1.0).expect("a solid");
    for scale in [1e-300, 1e-6, 0.5, 1e6, 1e300] {
        let q = pose(0.5 * scale, 0.5 * scale, -0.5 * scale, 0.5 * scale);
        let poses = RelativePose::new_normalized(&Isometry3::identity(), &q).expect("any length is accepted");
        let d = Tracker::new().distance(&ball, &ball, &poses);
        assert!(d.lower > 0.0 && d.upper < 3.0, "{scale}: {d}");
    }
}

#[test]
fn a_quaternion_without_a_direction_is_refused() {
    for q in [
        pose(0.0, 0.0, 0.0, 0.0),
        pose(f64::NAN, 0.0, 0.0, 1.0),
        pose(f64::INFINITY, 0.0, 0.0, 0.0),
    ] {
        let refused = RelativePose::new_normalized(&Isometry3::identity(), &q);
        assert!(matches!(refused, Err(PoseError::Rotation { .. })), "{refused:?}");
    }
}
