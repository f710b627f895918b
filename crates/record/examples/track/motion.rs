//! Motion of the two bodies: frames of `truth::motion` about the origin, converted to poses of
//! bodies centred anywhere.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3};
use truth::motion::{Frame, tumble_past};
use truth::rng::Rng;

/// Rotation of A over the whole motion, in degrees; B rotates less, about another axis.
const TURN: f64 = 360.0;

/// Gap between the passing bounding balls, as a fraction of the sum of their radii, so that the
/// bodies stay separated.
const CLEARANCE: f64 = 0.02;

/// Returns world poses of A and B, frame by frame: they tumble past each other on parallel lines.
pub(crate) fn poses(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frames: usize) -> Vec<[Isometry3<f64>; 2]> {
    let ((centre_a, radius_a), (centre_b, radius_b)) = (a.bounding_ball(), b.bounding_ball());
    let reach = radius_a + radius_b;
    let motion = tumble_past(
        &mut Rng::new(7),
        frames,
        TURN / frames as f64,
        reach * (1.0 + CLEARANCE),
        2.4 * reach,
    );
    let placed = |f: &Frame| [about(&centre_a, &f.a), about(&centre_b, &f.b)];
    motion.iter().map(placed).collect()
}

/// Returns the pose that rotates a body about `centre` and moves `centre` to the position of
/// `pose`.
fn about(centre: &Point3<f64>, pose: &truth::Pose) -> Isometry3<f64> {
    pose.isometry() * Translation3::from(-centre.coords)
}
