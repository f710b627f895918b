//! How the two bodies move: frames about the origin of `truth::motion`, turned into poses of bodies that stand anywhere.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3};
use truth::motion::{Frame, tumble_past};
use truth::rng::Rng;

/// Degrees that A turns over the whole motion; B turns less, about another axis.
const TURN: f64 = 360.0;

/// Bounding balls pass each other with this part of the sum of their radii between them, so the bodies stay apart.
const CLEARANCE: f64 = 0.02;

/// World poses of A and B, frame by frame: they tumble past each other on parallel lines.
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

/// The pose that turns a body about `centre` and puts it where `pose` puts the origin.
fn about(centre: &Point3<f64>, pose: &truth::Pose) -> Isometry3<f64> {
    pose.isometry() * Translation3::from(-centre.coords)
}
