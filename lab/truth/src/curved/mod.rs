//! A judge of curved pairs: the duality gap in double-double, with independent arithmetic, supports
//! and membership tests.
//!
//! For any direction, the support value of the difference is a lower bound of the signed distance.
//! For separated shapes, the distance of two points plus their distances outside their shapes is an
//! upper bound.

mod kinds;
pub mod parse;
pub mod special;
mod wide;

pub use kinds::{KINDS, Kind};
pub use wide::{Triple, Wide, dot, matrix, norm, turned, turned_back, wide};

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{Outcome, RelativePose};

use crate::motion::Frame;
use crate::pose::Pose;

/// Pose of B in the frame of A.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Quaternion x y z w, of unit length up to rounding.
    pub q: [f64; 4],
    /// The origin of B.
    pub t: [f64; 3],
}

impl Place {
    /// Returns a rotation, then a translation.
    pub const fn new(q: [f64; 4], t: [f64; 3]) -> Self {
        Self { q, t }
    }

    /// Returns the pose of a frame of a motion.
    pub fn of(frame: &Frame) -> Self {
        let relative = frame.relative();
        Self {
            q: relative.q,
            t: relative.t,
        }
    }

    /// Returns a frame of a motion, with A at the origin.
    pub fn frame(&self) -> Frame {
        let (q, t) = (self.q, self.t);
        Frame::new(Pose::IDENTITY, Pose::new(q, t))
    }

    /// Returns the isometry with the same bits.
    pub fn isometry(&self) -> Isometry3<f64> {
        let [x, y, z, w] = self.q;
        let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(Translation3::from(self.t), q)
    }

    /// Returns the pose of the crate.
    pub fn pose(&self) -> RelativePose {
        RelativePose::from_isometry(&self.isometry()).expect("a pose")
    }

    /// Returns the least `n . b - n . a` over both shapes, divided by the length of `n`.
    pub fn height(&self, a: &Kind, b: &Kind, n: &Triple) -> Wide {
        let m = turned_back(&matrix(self.q), n).map(|x| -x);
        (dot(n, &wide(self.t)) - a.height(n) - b.height(&m)) / norm(n)
    }

    /// Returns the size L of the pair.
    pub fn size(&self, a: &Kind, b: &Kind) -> f64 {
        a.radius() + b.radius() + crate::pose::norm(self.t)
    }

    /// Returns bounds of the true distance of separated shapes, from a normal and two witnesses.
    pub fn truth(&self, a: &Kind, b: &Kind, o: &Outcome) -> (Wide, Wide) {
        let lower = self.height(a, b, &wide((*o.normal).into()));
        let (p, q) = (wide(o.point_on_a.coords.into()), wide(o.point_on_b.coords.into()));
        let (t, r) = (wide(self.t), turned(&matrix(self.q), &q));
        let w = [0, 1, 2].map(|k| r[k] + t[k] - p[k]);
        (lower, norm(&w) + Wide::from(a.outside(&p)) + Wide::from(b.outside(&q)))
    }
}
