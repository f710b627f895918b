//! The point of a simplex closest to the origin, in any arithmetic.
//!
//! Source: signed volumes (Montanari, Petrinic, Barbieri 2017). Departure: if the origin is beyond
//! more than one face, or if rounding hides a sign, each such face is tried and the closest point
//! of all is used.

use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, root, scaled, sub};
use crate::base::tolerance::VOLUME;
use crate::body::polyhedron::VertexId;
use crate::pair::difference::MinkowskiPoint;
use crate::pair::transform::ErrorScale;

/// A point with the identity that its solver uses: vertices of two bodies, or an index.
pub(crate) trait Corner<T>: Copy {
    fn position(&self) -> &Vec3<T>;
}

impl<T: Scalar> Corner<T> for MinkowskiPoint<T> {
    #[inline(always)]
    fn position(&self) -> &Vec3<T> {
        &self.w
    }
}

/// A point with its index, or pair of indices, in a list of the solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Indexed<T, I> {
    pub(crate) index: I,
    pub(crate) w: Vec3<T>,
}

impl<T: Scalar, I: Copy> Corner<T> for Indexed<T, I> {
    #[inline(always)]
    fn position(&self) -> &Vec3<T> {
        &self.w
    }
}

/// Up to four points, and the point of their convex hull closest to the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex<T, P = MinkowskiPoint<T>> {
    points: [P; 4],
    closest: ClosestPoint<T>,
}

/// The closest point of a simplex, in barycentric coordinates.
#[derive(Clone, Copy, Debug)]
struct ClosestPoint<T> {
    /// Indices of the points whose hull contains the closest point in the relative interior.
    ids: [u8; 4],
    len: u8,
    /// Barycentric weights of the points in `ids`: positive, with a sum of 1 up to rounding.
    weights: [T; 4],
    /// Direction from the origin to the simplex: the closest point, or for a triangle a multiple of
    /// its normal, which is better conditioned.
    direction: Vec3<T>,
    /// Squared distance from the origin.
    squared: T,
}

impl<T: Scalar> ClosestPoint<T> {
    #[inline]
    fn vertex(c: &[impl Corner<T>; 4], p: u8) -> Self {
        let (one, w) = (T::from(1.0), *c[p as usize].position());
        Self {
            ids: [p; 4],
            len: 1,
            weights: [one; 4],
            direction: w,
            squared: dot(&w, &w),
        }
    }

    fn edge(c: &[impl Corner<T>; 4], p: u8, q: u8) -> Self {
        let (pw, qw) = (c[p as usize].position(), c[q as usize].position());
        let d = sub(qw, pw);
        let (t, dd) = (-dot(pw, &d), dot(&d, &d));
        let zero = T::from(0.0);
        // Voronoi regions V(p), V(q). An edge of length zero is a vertex.
        if !(t > zero) {
            return Self::vertex(c, p);
        }
        if !(t < dd) {
            return Self::vertex(c, q);
        }
        let s = t / dd;
        let v = [0, 1, 2].each(|k| pw[k] + d[k] * s);
        let v = sub(&v, &scaled(&d, dot(&v, &d) / dd));
        let weights = [T::from(1.0) - s, s, zero, zero];
        Self {
            ids: [p, q, q, q],
            len: 2,
            weights,
            direction: v,
            squared: dot(&v, &v),
        }
    }

    fn triangle(c: &[impl Corner<T>; 4], ids: [u8; 3]) -> Self {
        let [p, q, r] = ids.each(|k| c[k as usize].position());
        let n = cross(&sub(q, p), &sub(r, p));
        let zero = T::from(0.0);
        // Weight of the point opposite to the edge x-y.
        let weight = |x: &Vec3<T>, y: &Vec3<T>| -dot(&n, &cross(&sub(y, x), x));
        let w = [weight(q, r), weight(r, p), weight(p, q)];
        let mut best: Option<Self> = None;
        for k in 0..3 {
            if !(w[k] > zero) {
                let e = Self::edge(c, ids[(k + 1) % 3], ids[(k + 2) % 3]);
                if best.is_none_or(|b| e.squared < b.squared) {
                    best = Some(e);
                }
            }
        }
        if let Some(best) = best {
            return best;
        }
        let (sum, height) = (w[0] + w[1] + w[2], dot(&n, p));
        let weights = [w[0] / sum, w[1] / sum, w[2] / sum, zero];
        let direction = if height < zero { neg(&n) } else { n };
        let squared = height * height / dot(&n, &n);
        Self {
            ids: [ids[0], ids[1], ids[2], ids[2]],
            len: 3,
            weights,
            direction,
            squared,
        }
    }

    /// Tests a tetrahedron. If the origin is proven to be inside, `len` is 4. Otherwise returns the
    /// closest point of the faces that may separate the origin.
    fn tetrahedron(c: &[impl Corner<T>; 4], scale: ErrorScale) -> Self {
        let det = |i: usize, j: usize, k: usize| dot(c[i].position(), &cross(c[j].position(), c[k].position()));
        let mut volume = [det(1, 2, 3), -det(0, 2, 3), det(0, 1, 3), -det(0, 1, 2)];
        let zero = T::from(0.0);
        let sum = volume[0] + volume[1] + volume[2] + volume[3];
        if sum < zero {
            volume = volume.each(|v| -v);
        }
        let all = scale.total();
        let certain = T::from(VOLUME * T::UNIT * all * all * all);
        let is_certain = |v: T, face: &[u8; 3]| v > certain || (v > zero && v.value() > rounding_bound(c, face, scale));
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        let mut best: Option<Self> = None;
        for k in 0..4 {
            if !is_certain(volume[k], &faces[k]) {
                let t = Self::triangle(c, faces[k]);
                if best.is_none_or(|b| t.squared < b.squared) {
                    best = Some(t);
                }
            }
        }
        best.unwrap_or_else(|| {
            let sum = volume[0] + volume[1] + volume[2] + volume[3];
            let weights = volume.each(|v| v / sum);
            Self {
                ids: [0, 1, 2, 3],
                len: 4,
                weights,
                direction: [zero; 3],
                squared: zero,
            }
        })
    }
}

/// Bound of the rounding error in the volume of three points and the origin; see [`VOLUME`].
#[cold]
fn rounding_bound<T: Scalar>(c: &[impl Corner<T>; 4], face: &[u8; 3], scale: ErrorScale) -> f64 {
    let sum = |v: Vec3<T>| v.iter().fold(0.0, |sum, x| sum + x.value().abs());
    let [p, q, r] = face.each(|k| *c[k as usize].position());
    let (u, v) = (sub(&q, &p), sub(&r, &p));
    let [p, q, r] = [p, q, r].each(sum);
    let off = VOLUME * T::UNIT * scale.size;
    let own = off * (p * q + q * r + r * p) + off * off * scale.size;
    own + VOLUME * T::UNIT * scale.shared * (sum(cross(&u, &v)) + off * (sum(u) + sum(v) + off))
}

impl<T: Scalar, P: Corner<T>> Simplex<T, P> {
    /// Returns the simplex of one point.
    pub(crate) fn vertex(c: P) -> Self {
        let points = [c; 4];
        Self {
            points,
            closest: ClosestPoint::vertex(&points, 0),
        }
    }

    /// Returns the simplex of two points.
    pub(crate) fn edge([p, q]: [P; 2]) -> Self {
        Self::reduced([p, q, q, q], ClosestPoint::edge(&[p, q, q, q], 0, 1))
    }

    /// Returns the simplex of a triangle.
    pub(crate) fn triangle([p, q, r]: [P; 3]) -> Self {
        let points = [p, q, r, r];
        Self::reduced(points, ClosestPoint::triangle(&points, [0, 1, 2]))
    }

    /// Keeps the points that span the closest point.
    fn reduced(points: [P; 4], closest: ClosestPoint<T>) -> Self {
        Self {
            points: closest.ids.each(|k| points[k as usize]),
            closest,
        }
    }

    /// Returns the simplex of a tetrahedron. It has four points if and only if the origin is proven
    /// to be inside.
    pub(crate) fn tetrahedron(points: [P; 4], scale: ErrorScale) -> Self {
        Self::reduced(points, ClosestPoint::tetrahedron(&points, scale))
    }

    /// Adds a point. Returns whether the hull comes closer to the origin or contains it; if not,
    /// nothing changes.
    pub(crate) fn add(&mut self, c: P, scale: ErrorScale) -> bool {
        let mut points = self.points;
        points[self.len()] = c;
        let closest = match self.len() {
            1 => ClosestPoint::edge(&points, 0, 1),
            2 => ClosestPoint::triangle(&points, [0, 1, 2]),
            _ => ClosestPoint::tetrahedron(&points, scale),
        };
        let better = closest.squared < self.closest.squared;
        if better {
            *self = Self::reduced(points, closest);
        }
        better
    }

    /// Returns the number of points that span the closest point. Four points contain the origin.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.closest.len as usize
    }

    /// Returns the points that span the closest point.
    #[inline]
    pub(crate) fn points(&self) -> &[P] {
        &self.points[..self.len()]
    }

    /// Returns the barycentric weights of the points.
    pub(crate) fn weights(&self) -> &[T] {
        &self.closest.weights[..self.len()]
    }

    /// Returns the direction from the origin towards the simplex.
    pub(crate) fn direction(&self) -> Vec3<T> {
        self.closest.direction
    }

    /// Returns the squared distance from the origin.
    pub(crate) fn squared_distance(&self) -> T {
        self.closest.squared
    }

    /// Returns the distance of the point that the weights give, an upper bound.
    ///
    /// The weights are positive and sum to 1, so they give a point of the difference despite their
    /// rounding. The square root of `squared` is not an upper bound, because the plane of a
    /// needle-shaped triangle may be closer than the triangle.
    pub(crate) fn witness_distance(&self) -> T {
        let at = |k: usize| {
            let parts = self.points().iter().zip(self.weights());
            parts.fold(T::from(0.0), |sum, (c, &weight)| sum + c.position()[k] * weight)
        };
        let v = [at(0), at(1), at(2)];
        root(dot(&v, &v))
    }
}

impl<T: Scalar> Simplex<T> {
    /// Returns whether the simplex contains the point of two vertices.
    pub(crate) fn contains(&self, a: VertexId, b: VertexId) -> bool {
        self.points().iter().any(|c| (c.a, c.b) == (a, b))
    }
}
