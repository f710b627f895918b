//! A judge of curved pairs: the duality gap in double-double, with arithmetic, supports and memberships of its own.
//!
//! For any direction the height of the difference is a lower bound of the signed distance; for shapes apart, the distance of two
//! points and how far they are outside their shapes is an upper bound.

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

/// B in the frame of A.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// x y z w, of unit length but for rounding.
    pub q: [f64; 4],
    /// The origin of B.
    pub t: [f64; 3],
}

impl Place {
    /// Of a frame of a motion.
    pub fn of(frame: &Frame) -> Self {
        let relative = frame.relative();
        Self {
            q: relative.q,
            t: relative.t,
        }
    }

    /// A frame of a motion: A at its own origin.
    pub fn frame(&self) -> Frame {
        let (q, t) = (self.q, self.t);
        Frame {
            a: Pose::IDENTITY,
            b: Pose { q, t },
        }
    }

    /// As an isometry, bit for bit.
    pub fn isometry(&self) -> Isometry3<f64> {
        let [x, y, z, w] = self.q;
        let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(Translation3::from(self.t), q)
    }

    /// As a pose of the crate.
    pub fn pose(&self) -> RelativePose {
        RelativePose::from_isometry(&self.isometry()).expect("a pose")
    }

    /// `n . b - n . a`, the least of it over both shapes, over the length of `n`.
    pub fn height(&self, a: &Kind, b: &Kind, n: &Triple) -> Wide {
        let m = turned_back(&matrix(self.q), n).map(|x| -x);
        (dot(n, &wide(self.t)) - a.height(n) - b.height(&m)) / norm(n)
    }

    /// The size L of the pair.
    pub fn size(&self, a: &Kind, b: &Kind) -> f64 {
        a.radius() + b.radius() + crate::pose::norm(self.t)
    }

    /// Bounds of the truth of shapes apart from a normal and two witnesses.
    pub fn truth(&self, a: &Kind, b: &Kind, o: &Outcome) -> (Wide, Wide) {
        let lower = self.height(a, b, &wide((*o.normal).into()));
        let (p, q) = (wide(o.point_on_a.coords.into()), wide(o.point_on_b.coords.into()));
        let (t, r) = (wide(self.t), turned(&matrix(self.q), &q));
        let w = [0, 1, 2].map(|k| r[k] + t[k] - p[k]);
        (lower, norm(&w) + Wide::from(a.outside(&p)) + Wide::from(b.outside(&q)))
    }
}
