//! Exact comparison of vertices by height along a direction, and of edges by slope.
//!
//! Signs are f64 signs if f64 is certain, else signs in double-double, then of exact sums, or of
//! integers at the exact level ([`Upward`]).

use crate::body::polyhedron::VertexId;
use core::cmp::Ordering;

use nalgebra::Vector3;

use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::scalar::Scalar;
use crate::base::num::sign::{dot_and_size, edge_sign, exact_dot, is_level, sign};
use crate::base::tolerance::{EDGE_SIGN, LEAST_RISE, STEEPER, UNIT};
use crate::body::polyhedron::axis::Axis;
use crate::body::polyhedron::build::cloud::{exponent_of, power_of_two};

/// A direction `n` along which the vertices of a body have an exact order.
pub(crate) trait Upward {
    /// Returns the sign of `n . (q - p)` for vertices `p` and `q`.
    fn rise(&self, p: VertexId, q: VertexId) -> i32;
    /// Returns the sign of `(n . e) (m . f) - (n . f) (m . e)`, with `e` and `f` the edges from `p`
    /// to `q` and `r`: which edge has the greater slope `n . e / m . e`, if both rise along the
    /// axis `m`.
    fn steeper(&self, m: &Axis, p: VertexId, q: VertexId, r: VertexId) -> i32;
}

/// A direction in double-double, `n + rest`, which rounds to `n`.
pub(crate) struct Direction<'a> {
    points: &'a [Vector3<f64>],
    n: Vector3<f64>,
    rest: Vector3<f64>,
}

impl<'a> Direction<'a> {
    /// Makes a direction in the frame of the points.
    #[inline]
    pub(crate) fn new(points: &'a [Vector3<f64>], n: &Vector3<f64>, rest: &Vector3<f64>) -> Self {
        let (n, rest) = (*n, *rest);
        Self { points, n, rest }
    }

    /// Returns the direction in double-double, scaled by a power of two to a length of about
    /// `2^400`, so that no bit of a product with a stored edge is lost to underflow.
    fn in_double_double(&self) -> [DoubleDouble; 3] {
        let scale = power_of_two(400 - exponent_of(self.n.amax()));
        [0, 1, 2].map(|k| DoubleDouble {
            hi: self.n[k] * scale,
            lo: self.rest[k] * scale,
        })
    }

    /// Returns the edge from `p` to `q`, rounded.
    fn edge(&self, p: VertexId, q: VertexId) -> Vector3<f64> {
        self.points[q.index()] - self.points[p.index()]
    }

    fn edge_in_double_double(&self, p: VertexId, q: VertexId) -> [DoubleDouble; 3] {
        let (p, q) = (&self.points[p.index()], &self.points[q.index()]);
        [0, 1, 2].map(|k| DoubleDouble::sum(q[k], -p[k]))
    }

    #[cold]
    fn rise_exact(&self, p: VertexId, q: VertexId) -> i32 {
        let fine = self.in_double_double();
        let edge = self.edge_in_double_double(p, q);
        let (value, size) = dot_and_size(&fine, &edge);
        let bound = EDGE_SIGN / UNIT * DoubleDouble::UNIT * size + LEAST_RISE;
        if is_level(&fine, &edge) || value.value().abs() > bound {
            return sign(value.value());
        }
        let (p, q) = (&self.points[p.index()], &self.points[q.index()]);
        exact_dot::<2, 24>(&fine.map(|n| [n.hi, n.lo]), p, q).sign()
    }

    #[cold]
    fn steeper_exact(&self, m: &Axis, p: VertexId, q: VertexId, r: VertexId) -> i32 {
        let (fine, e, f) = (
            self.in_double_double(),
            self.edge_in_double_double(p, q),
            self.edge_in_double_double(p, r),
        );
        if let Some(sign) = certain(&fine, &m.doubled(), &e, &f) {
            return sign;
        }
        let [p, q, r] = [p, q, r].map(|v| &self.points[v.index()]);
        let up = fine.map(|n| [n.hi, n.lo]);
        let rises = |q| (exact_dot::<2, 24>(&up, p, q), m.rise(p, q));
        let ((n_e, m_e), (n_f, m_f)) = (rises(q), rises(r));
        let mut sum = Expansion::<4608>::new();
        for (x, y, sign) in [(&n_e, &m_f, 1.0), (&n_f, &m_e, -1.0)] {
            for &x in x.parts() {
                y.parts().iter().for_each(|y| sum.add_product(x, sign * y));
            }
        }
        sum.sign()
    }
}

impl Upward for Direction<'_> {
    #[inline]
    fn rise(&self, p: VertexId, q: VertexId) -> i32 {
        match edge_sign(&self.n, &self.edge(p, q)) {
            0 => self.rise_exact(p, q),
            sign => sign,
        }
    }

    #[inline]
    fn steeper(&self, m: &Axis, p: VertexId, q: VertexId, r: VertexId) -> i32 {
        steeper(&self.n, &m.rounded(), &self.edge(p, q), &self.edge(p, r))
            .unwrap_or_else(|| self.steeper_exact(m, p, q, r))
    }
}

/// Returns the sign of `(n . e) (m . f) - (n . f) (m . e)`, if the arithmetic is certain.
#[inline]
fn certain<T: Scalar>(n: &[T; 3], m: &[T; 3], e: &[T; 3], f: &[T; 3]) -> Option<i32> {
    let (value, bound) = slopes(n, m, e, f);
    let is_zero = || (is_level(n, e) || is_level(m, f)) && (is_level(n, f) || is_level(m, e));
    (value.abs() > bound || is_zero()).then(|| sign(value))
}

/// Returns `(n . e) (m . f) - (n . f) (m . e)`, and the bound of its error.
#[inline(always)]
pub(crate) fn slopes<T: Scalar>(n: &[T; 3], m: &[T; 3], e: &[T; 3], f: &[T; 3]) -> (f64, f64) {
    let ((ne, s_ne), (mf, s_mf)) = (dot_and_size(n, e), dot_and_size(m, f));
    let ((nf, s_nf), (me, s_me)) = (dot_and_size(n, f), dot_and_size(m, e));
    let (value, size) = ((ne * mf - nf * me).value(), s_ne * s_mf + s_nf * s_me);
    let bound = STEEPER / UNIT * T::UNIT * size + LEAST_RISE * (1.0 + s_ne + s_mf + s_nf + s_me);
    (value, bound)
}

/// Returns the sign of `(n . e) (m . f) - (n . f) (m . e)`, if f64 is certain. `n` may be rounded,
/// and `e` and `f` are rounded differences of stored points.
#[inline]
pub(crate) fn steeper(n: &Vector3<f64>, m: &Vector3<f64>, e: &Vector3<f64>, f: &Vector3<f64>) -> Option<i32> {
    let [n, m, e, f] = [n, m, e, f].map(|v| <[f64; 3]>::from(*v));
    certain(&n, &m, &e, &f)
}

/// A vertex, compared by height along a direction.
pub(super) struct Height<'a, U>(pub(super) &'a U, pub(super) VertexId);

impl<U: Upward> PartialEq for Height<'_, U> {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl<U: Upward> PartialOrd for Height<'_, U> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.0.rise(other.1, self.1).cmp(&0))
    }
}

/// An edge from the first vertex to the second, compared by slope: the rise along the direction
/// over the rise along the axis `m`.
pub(super) struct Slope<'a, U>(
    pub(super) &'a U,
    pub(super) &'a Axis,
    pub(super) VertexId,
    pub(super) VertexId,
);

impl<U: Upward> PartialEq for Slope<'_, U> {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl<U: Upward> PartialOrd for Slope<'_, U> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.0.steeper(self.1, self.2, self.3, other.3).cmp(&0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn rises_below_the_least_number_are_told() {
        let mut rng = Rng::new(12);
        for _ in 0..2000 {
            let [a, b, c, d] = [0; 4].map(|_| rng.range(-8.0, 8.0).round());
            // Products of one size, of which f64 holds none.
            let (i, j) = (1070 - rng.below(60) as i32, 1070 - rng.below(60) as i32);
            let two = |e: i32| power_of_two(-e / 2) * power_of_two(-e + e / 2);
            let n = Vector3::new(1.0, a * two(i), c * two(j));
            let e = Vector3::new(0.0, b * two(1370 - i), d * two(1370 - j));
            let points = [Vector3::zeros(), e];
            let direction = Direction::new(&points, &n, &Vector3::zeros());
            let [p, q] = [0, 1].map(VertexId);
            assert_eq!(direction.rise(p, q), sign(a * b + c * d), "{n} {e}");
        }
    }

    #[test]
    fn slopes_compare_exactly() {
        let mut rng = Rng::new(11);
        let whole = |rng: &mut Rng| Vector3::from_fn(|_, _| rng.range(-4.0, 4.0).round());
        let mut level = 0;
        for _ in 0..20_000 {
            let (n, m, p, e, f) = (
                whole(&mut rng),
                whole(&mut rng),
                whole(&mut rng),
                whole(&mut rng),
                whole(&mut rng),
            );
            let truth = sign(n.dot(&e) * m.dot(&f) - n.dot(&f) * m.dot(&e));
            let (points, [o, a, b]) = ([p, p + e, p + f], [0, 1, 2].map(VertexId));
            let direction = Direction::new(&points, &n, &Vector3::zeros());
            let axis = Axis::new([0, 1, 2].map(|k| [m[k], 0.0, 0.0, 0.0]));
            assert_eq!(direction.steeper(&axis, o, a, b), truth);
            assert_eq!(direction.steeper_exact(&axis, o, a, b), truth);
            assert_eq!(direction.rise(o, a), sign(n.dot(&e)));
            if truth == 0 && n.z == 0.0 {
                // Off by an amount that only an exact sum resolves.
                let n = n + Vector3::new(0.0, 0.0, 2f64.powi(-140));
                let direction = Direction::new(&points, &n, &Vector3::zeros());
                let truth = sign(e.z * m.dot(&f) - f.z * m.dot(&e));
                assert_eq!(direction.steeper(&axis, o, a, b), truth);
                level += 1;
                // An axis off by such an amount, visible in its last part alone.
                let off = whole(&mut rng);
                let n = Vector3::new(n.x, n.y, 0.0);
                let truth = sign(n.dot(&e) * off.dot(&f) - n.dot(&f) * off.dot(&e));
                let axis = Axis::new([0, 1, 2].map(|k| {
                    let off = off[k] * 2f64.powi(-160);
                    if m[k] == 0.0 {
                        [off, 0.0, 0.0, 0.0]
                    } else {
                        [m[k], off, 0.0, 0.0]
                    }
                }));
                let direction = Direction::new(&points, &n, &Vector3::zeros());
                assert_eq!(direction.steeper(&axis, o, a, b), truth);
            }
        }
        assert!(level > 20, "{level}");
    }
}
