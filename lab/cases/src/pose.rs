//! A rigid pose as plain numbers, and the vector operations of the generators.

use crate::rng::Rng;
#[cfg(feature = "nalgebra")]
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};

/// A point or a vector.
pub type Point = [f64; 3];

/// The rigid motion `v -> R(q) v + t`, with `q = [x, y, z, w]`.
///
/// `q` is unit up to rounding; exact code divides by `|q|^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation as a quaternion `x, y, z, w`.
    pub q: [f64; 4],
    /// Translation.
    pub t: Point,
}

impl Pose {
    /// The identity pose.
    pub const IDENTITY: Self = Self {
        q: [0.0, 0.0, 0.0, 1.0],
        t: [0.0; 3],
    };

    /// Returns a rotation, then a translation.
    pub const fn new(q: [f64; 4], t: Point) -> Self {
        Self { q, t }
    }

    /// Returns a translation.
    pub fn shift(t: Point) -> Self {
        Self { t, ..Self::IDENTITY }
    }

    /// Returns a rotation by `angle` radians about the unit `axis`, then a translation by `t`.
    pub fn turn(axis: Point, angle: f64, t: Point) -> Self {
        Self {
            q: quat(axis, angle),
            t,
        }
    }

    /// Returns the pose with another translation.
    pub const fn moved_to(&self, t: Point) -> Self {
        Self { t, ..*self }
    }

    /// Returns the pose shifted by a vector of the outer frame.
    pub fn shifted(&self, by: Point) -> Self {
        self.moved_to(add(self.t, by))
    }

    /// Returns the image of the point `v`, in `f64`.
    pub fn apply(&self, v: Point) -> Point {
        add(self.rotate(v), self.t)
    }

    /// Returns the pose in another unit of length.
    pub fn scaled(&self, by: f64) -> Self {
        Self {
            q: self.q,
            t: scale(self.t, by),
        }
    }

    /// Returns an isometry with exactly the same bits.
    #[cfg(feature = "nalgebra")]
    pub fn isometry(&self) -> Isometry3<f64> {
        let [x, y, z, w] = self.q;
        Isometry3::from_parts(
            self.t.into(),
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
        )
    }

    /// Applies the rotation alone.
    pub fn rotate(&self, v: Point) -> Point {
        let [x, y, z, w] = self.q;
        let u = [x, y, z];
        let twice = scale(cross(u, v), 2.0);
        add(add(v, scale(twice, w)), cross(u, twice))
    }

    /// Applies the inverse rotation.
    pub fn rotate_back(&self, v: Point) -> Point {
        let [x, y, z, w] = self.q;
        Self {
            q: [-x, -y, -z, w],
            t: self.t,
        }
        .rotate(v)
    }

    /// Returns the point `p` of the world in the body's frame, in `f64`.
    pub fn apply_inverse(&self, p: Point) -> Point {
        self.rotate_back(sub(p, self.t))
    }

    /// Returns `self` after `first`: the pose `v -> self(first(v))`.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            q: unit_quat(quat_mul(self.q, first.q)),
            t: self.apply(first.t),
        }
    }

    /// Returns the pose of `b` in the frame of `a`, in `f64`. It is rounded: exact checks must use
    /// the pose of the actual query.
    pub fn relative(a: &Self, b: &Self) -> Self {
        let [x, y, z, w] = a.q;
        Self {
            q: unit_quat(quat_mul([-x, -y, -z, w], b.q)),
            t: a.apply_inverse(b.t),
        }
    }
}

/// Returns the unit quaternion of a rotation by `angle` radians about the unit `axis`.
pub fn quat(axis: Point, angle: f64) -> [f64; 4] {
    let (s, c) = (0.5 * angle).sin_cos();
    unit_quat([axis[0] * s, axis[1] * s, axis[2] * s, c])
}

/// Returns the Hamilton product.
pub fn quat_mul(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let [ax, ay, az, aw] = a;
    let [bx, by, bz, bw] = b;
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// Returns `q` divided by its length.
pub fn unit_quat(q: [f64; 4]) -> [f64; 4] {
    let n = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.map(|x| x / n)
}

/// Returns a rotation, in half of all cases off unit length by almost as much as a pose may be.
pub fn off_unit(q: [f64; 4], rng: &mut Rng) -> [f64; 4] {
    let by = [1.0, 1.0, 1.0 + 4.9e-13, 1.0 - 4.9e-13][rng.below(4)];
    q.map(|x| x * by)
}

/// `a + b`.
pub fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
pub fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`.
pub fn scale(a: Point, s: f64) -> Point {
    a.map(|x| x * s)
}

/// `a . b`.
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
pub fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `|a|`.
pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// `a / |a|`; the zero vector stays zero.
pub fn unit(a: Point) -> Point {
    let n = norm(a);
    if n > 0.0 { scale(a, 1.0 / n) } else { a }
}

/// Returns the largest distance of a point from the origin: the radius of a body about its origin.
pub fn radius(points: &[Point]) -> f64 {
    points.iter().map(|&p| norm(p)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Point, b: Point) -> bool {
        norm(sub(a, b)) < 1e-14
    }

    #[test]
    fn a_quarter_turn_about_z_sends_x_to_y() {
        let pose = Pose::turn([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2, [0.0, 0.0, 5.0]);
        assert!(close(pose.apply([1.0, 0.0, 0.0]), [0.0, 1.0, 5.0]));
        assert!(close(pose.apply_inverse([0.0, 1.0, 5.0]), [1.0, 0.0, 0.0]));
    }

    #[test]
    fn relative_and_after_undo_each_other() {
        let a = Pose::turn(unit([1.0, 2.0, -1.0]), 0.7, [1.0, -2.0, 0.5]);
        let b = Pose::turn(unit([0.0, -1.0, 3.0]), 2.1, [-0.3, 0.4, 2.0]);
        let back = a.after(&Pose::relative(&a, &b));
        let v = [0.3, 0.9, -0.2];
        assert!(close(back.apply(v), b.apply(v)));
    }
}
