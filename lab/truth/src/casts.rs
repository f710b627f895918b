//! Pairs of bodies thrown at each other, and conservative advancement as a second method of
//! casting.
//!
//! Conservative advancement shares only the distance query with the crate. It steps by the distance
//! divided by a bound of the approach speed along the direction n of the witnesses,
//! `(vA - vB) . n + |wA x n| cA + |wB x n| cB`. Here `c` is the greatest distance of a vertex from
//! the axis of its body (Mirtich 1996, with the perpendicular radius). The method converges
//! linearly, and is sound.

use crate::Point;
use crate::rng::Rng;
use crate::shapes;
use lin_canny::motion::{Motion, Steady};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, Velocity};
use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};

/// The families of bodies for casts.
pub const SHAPES: [&str; 5] = ["sphere", "flat", "box", "rods", "plates"];

/// Returns a body of a family with about `n` vertices and a radius of about 1. A `box` always has
/// eight.
pub fn body(shape: &str, n: usize, rng: &mut Rng) -> ConvexPolyhedron {
    let points = match shape {
        "sphere" => shapes::sphere(rng, n).points,
        "flat" => shapes::ellipsoid(rng, n, [1.0, 1.0, 0.1]).points,
        "rods" => shapes::prism((n / 2).max(3), 0.05, 1.0).points,
        "plates" => shapes::prism((n / 2).max(3), 1.0, 0.05).points,
        _ => shapes::cuboid([0.6, 0.5, 0.4]).points,
    };
    solid(&points)
}

/// Returns the hull of points that span a volume.
pub fn solid(points: &[Point]) -> ConvexPolyhedron {
    let points: Vec<_> = points.iter().map(|&p| Point3::from(p)).collect();
    ConvexPolyhedron::from_points(&points).expect("points of a solid")
}

/// Start poses of both bodies, and their velocities, for one unit of time.
#[derive(Clone, Copy, Debug)]
pub struct Throw {
    /// Poses at time zero.
    pub start: [Isometry3<f64>; 2],
    /// Velocities of the origins, and angular velocities about them.
    pub velocity: [Velocity; 2],
}

impl Throw {
    /// Returns the motions.
    pub fn motions(&self) -> [Steady; 2] {
        [0, 1].map(|k| Steady::new(&self.start[k], self.velocity[k]).expect("a throw is finite"))
    }

    /// Returns the throw with A and B exchanged.
    pub fn swapped(&self) -> Self {
        let ([a, b], [v, w]) = (self.start, self.velocity);
        Self {
            start: [b, a],
            velocity: [w, v],
        }
    }
}

/// Returns a random rotation.
pub fn rotation(rng: &mut Rng) -> UnitQuaternion<f64> {
    let [x, y, z, w] = rng.quat();
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

/// Returns a throw of two bodies of the given radii, aimed so that about half of the throws hit.
///
/// In units of the sum of the radii, the centres start 1.5 to 4 apart and pass each other within
/// 1.2. Each body rotates by at most `turn` radians.
pub fn aimed(rng: &mut Rng, radii: (f64, f64), turn: f64) -> Throw {
    let sum = radii.0 + radii.1;
    let away = Vector3::from(rng.unit()) * (sum * rng.range(1.5, 4.0));
    let aside = Vector3::from(rng.unit());
    let aside = (aside - away * (aside.dot(&away) / away.norm_squared())) * (sum * rng.range(0.0, 1.2));
    let when = rng.range(0.3, 0.9);
    let relative = (aside - away) / when;
    let common = Vector3::from(rng.in_ball()) * 3.0;
    let spin = |rng: &mut Rng| Vector3::from(rng.unit()) * rng.range(0.0, turn);
    let place = Vector3::from(rng.in_ball()) * 2.0;
    let start = [place, place + away].map(|t| Isometry3::from_parts(t.into(), rotation(rng)));
    Throw {
        start,
        velocity: [
            Velocity::new(common, spin(rng)),
            Velocity::new(common + relative, spin(rng)),
        ],
    }
}

/// Result of conservative advancement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance {
    /// The bodies touch or overlap at the start.
    Start,
    /// The bodies are separated until this time, and within the tolerance at it.
    Near(f64),
    /// The bodies never come within the tolerance.
    Miss,
    /// The step limit was reached at this time.
    Limit(f64),
}

/// Returns the greatest distance of a vertex from an axis through the body's origin, in the body's
/// frame.
fn swing(body: &ConvexPolyhedron, axis: &Vector3<f64>) -> f64 {
    let norm = axis.norm();
    let far = |p: Point3<f64>| p.coords.cross(axis).norm();
    if norm > 0.0 {
        body.vertex_points().map(far).fold(0.0, f64::max) / norm
    } else {
        0.0
    }
}

/// Casts by conservative advancement over one unit of time. Returns the result and the number of
/// distance queries.
pub fn advance(bodies: [&ConvexPolyhedron; 2], throw: &Throw, tolerance: f64, limit: u32) -> (Advance, u32) {
    let motions = throw.motions();
    let [va, vb] = throw.velocity;
    // The axis in the frame of each body.
    let swings = [0, 1].map(|k| {
        swing(
            bodies[k],
            &(throw.start[k].rotation.inverse() * throw.velocity[k].angular),
        )
    });
    let mut tracker = Tracker::new();
    let mut time = 0.0;
    for queries in 1..=limit {
        let [pa, pb] = [0, 1].map(|k| motions[k].pose(time));
        let relative = RelativePose::new(&pa, &pb).expect("a throw stays in range");
        let seen = tracker.closest(bodies[0], bodies[1], &relative);
        if seen.lower <= tolerance {
            let met = time == 0.0 && seen.lower <= 0.0;
            return (if met { Advance::Start } else { Advance::Near(time) }, queries);
        }
        let n = pa.rotation * seen.normal.into_inner();
        let speed = (va.linear - vb.linear).dot(&n)
            + va.angular.cross(&n).norm() * swings[0]
            + vb.angular.cross(&n).norm() * swings[1];
        // The factor covers rounding: these distances are within 1e-13 of the size.
        let step = if speed > 0.0 {
            0.99999 * seen.lower / speed
        } else {
            f64::INFINITY
        };
        if time + step > 1.0 {
            return (Advance::Miss, queries);
        }
        time += step;
    }
    (Advance::Limit(time), limit)
}
