//! Pairs of bodies thrown at each other, and a second way to cast them: conservative advancement.
//!
//! The second scheme shares with the crate only its distance query: it steps by the distance over a bound of the approach speed
//! along the witnesses' direction n, `(vA - vB) . n + |wA x n| cA + |wB x n| cB`, `c` the greatest distance of a vertex from the
//! axis of its body (Mirtich 1996, with the perpendicular radius). It converges linearly, and is sound.

use crate::Point;
use crate::rng::Rng;
use crate::shapes;
use lin_canny::motion::{Motion, Steady};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, Velocity};
use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};

/// The families of bodies that are cast.
pub const SHAPES: [&str; 5] = ["sphere", "flat", "box", "rods", "plates"];

/// The body of a family with about `n` vertices, of radius about 1. A `box` has eight whatever `n` is.
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

/// The hull of points that have one.
pub fn solid(points: &[Point]) -> ConvexPolyhedron {
    let points: Vec<_> = points.iter().map(|&p| Point3::from(p)).collect();
    ConvexPolyhedron::from_points(&points).expect("points of a solid")
}

/// Where both bodies begin, and their velocities, for one unit of time.
#[derive(Clone, Copy, Debug)]
pub struct Throw {
    /// Poses at time zero.
    pub start: [Isometry3<f64>; 2],
    /// Velocities of the origins, and about them.
    pub velocity: [Velocity; 2],
}

impl Throw {
    /// The motions.
    pub fn motions(&self) -> [Steady; 2] {
        [0, 1].map(|k| Steady::new(&self.start[k], self.velocity[k]).expect("a throw is finite"))
    }

    /// The same with the letters exchanged.
    pub fn swapped(&self) -> Self {
        let ([a, b], [v, w]) = (self.start, self.velocity);
        Self {
            start: [b, a],
            velocity: [w, v],
        }
    }
}

/// A random rotation.
pub fn rotation(rng: &mut Rng) -> UnitQuaternion<f64> {
    let [x, y, z, w] = rng.quat();
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

/// A throw of two bodies of the given radii so aimed that about half of them meet: centres begin one and a half to four radii
/// apart and pass each other within one and a fifth, and each body turns by at most `turn` radians.
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

/// What conservative advancement finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advance {
    /// The bodies touch or overlap at the start.
    Start,
    /// They are apart up to here, and no farther apart than the tolerance there.
    Near(f64),
    /// They never come as near.
    Miss,
    /// So many steps were not enough.
    Limit(f64),
}

/// The greatest distance of a vertex from the axis, in the body's own frame, through its origin.
fn swing(body: &ConvexPolyhedron, axis: &Vector3<f64>) -> f64 {
    let norm = axis.norm();
    let far = |p: Point3<f64>| p.coords.cross(axis).norm();
    if norm > 0.0 {
        body.vertex_points().map(far).fold(0.0, f64::max) / norm
    } else {
        0.0
    }
}

/// Casts by conservative advancement over one unit of time; also how many distances it took.
pub fn advance(bodies: [&ConvexPolyhedron; 2], throw: &Throw, tolerance: f64, limit: u32) -> (Advance, u32) {
    let motions = throw.motions();
    let [va, vb] = throw.velocity;
    // The axis as each body sees it.
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
        // The last factor covers rounding: distances here are within 1e-13 of the size.
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
