//! Numbers, points and poses between the engine's precision and `f64`.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::parry::math::{Pose, Real, Rotation, Vector};

/// Returns a vector of the engine in `f64`, exactly.
pub(super) fn wide(v: Vector) -> Vector3<f64> {
    Vector3::from(v.to_array().map(f64::from))
}

/// Returns a point of the engine in `f64`, exactly.
pub(super) fn wide_point(v: Vector) -> Point3<f64> {
    Point3::from(wide(v))
}

/// Returns a vector rounded to the engine's precision.
pub(super) fn narrow(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}

/// Returns the largest number of the engine that is no greater than `x`.
pub(super) fn down(x: f64) -> Real {
    let y = x as Real;
    if f64::from(y) > x { y.next_down() } else { y }
}

/// Returns the least number of the engine that is no less than `x`.
pub(super) fn up(x: f64) -> Real {
    -down(-x)
}

/// Returns a pose of the engine in `f64`, with its rotation normalised in `f64`.
///
/// [`lin_canny`] rejects a rotation that is normalised only in `f32`.
pub fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [i, j, k, w] = pose.rotation.to_array().map(f64::from);
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::from(wide(pose.translation)), rotation)
}

/// Returns a pose rounded to the engine's precision, with its rotation normalised in it.
pub fn pose(isometry: &Isometry3<f64>) -> Pose {
    let [i, j, k, w] = isometry.rotation.coords.data.0[0].map(|x| x as Real);
    let rotation = Rotation::from_xyzw(i, j, k, w).normalize();
    Pose::from_parts(narrow(&isometry.translation.vector), rotation)
}
