//! The point of a simplex nearest to the origin, in any arithmetic.
//!
//! Signed volumes (Montanari, Petrinic, Barbieri 2017) with one departure: where a sign says the origin lies beyond
//! more than one face, or rounding hides the sign, each such face is tried and the nearest answer taken.

use crate::scalar::{Scalar, Vec3, cross, dot, neg, root, scaled, sub};
use crate::tolerance::VOLUME;

/// A point of the Minkowski difference A - B: a vertex of each body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner<T> {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// Placed difference `a - b`, in A's frame.
    pub(crate) w: Vec3<T>,
}

/// Up to four corners and the weights of the point of their hull nearest to the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex<T> {
    pub(crate) corners: [Corner<T>; 4],
    /// Positive and summing to one up to rounding, for the corners kept.
    pub(crate) weights: [T; 4],
    pub(crate) len: usize,
    /// From the origin towards the simplex: the nearest point or, better conditioned, a multiple of the normal.
    pub(crate) direction: Vec3<T>,
    /// Squared distance from the origin.
    pub(crate) squared: T,
}

impl<T: Scalar> Simplex<T> {
    /// One corner.
    pub(crate) fn vertex(c: Corner<T>) -> Self {
        let one = T::from(1.0);
        Self {
            corners: [c; 4],
            weights: [one; 4],
            len: 1,
            direction: c.w,
            squared: dot(&c.w, &c.w),
        }
    }

    fn edge(p: Corner<T>, q: Corner<T>) -> Self {
        let d = sub(&q.w, &p.w);
        let (t, dd) = (-dot(&p.w, &d), dot(&d, &d));
        let zero = T::from(0.0);
        // V(p), V(q); a zero edge is a vertex.
        if !(t > zero) {
            return Self::vertex(p);
        }
        if !(t < dd) {
            return Self::vertex(q);
        }
        let s = t / dd;
        let mut v = [0, 1, 2].map(|k| p.w[k] + d[k] * s);
        let along = dot(&v, &d) / dd;
        v = sub(&v, &scaled(&d, along));
        let weights = [T::from(1.0) - s, s, zero, zero];
        Self {
            corners: [p, q, q, q],
            weights,
            len: 2,
            direction: v,
            squared: dot(&v, &v),
        }
    }

    fn triangle(p: Corner<T>, q: Corner<T>, r: Corner<T>) -> Self {
        let n = cross(&sub(&q.w, &p.w), &sub(&r.w, &p.w));
        let zero = T::from(0.0);
        // Weight of the corner opposite to the edge x-y.
        let weight = |x: &Corner<T>, y: &Corner<T>| -dot(&n, &cross(&sub(&y.w, &x.w), &x.w));
        let w = [weight(&q, &r), weight(&r, &p), weight(&p, &q)];
        let edges = [(q, r), (r, p), (p, q)];
        let mut best: Option<Self> = None;
        for k in 0..3 {
            if !(w[k] > zero) {
                let e = Self::edge(edges[k].0, edges[k].1);
                if best.is_none_or(|b| e.squared < b.squared) {
                    best = Some(e);
                }
            }
        }
        if let Some(best) = best {
            return best;
        }
        let (sum, height) = (w[0] + w[1] + w[2], dot(&n, &p.w));
        let weights = [w[0] / sum, w[1] / sum, w[2] / sum, zero];
        let direction = if height < zero { neg(&n) } else { n };
        let squared = height * height / dot(&n, &n);
        Self {
            corners: [p, q, r, r],
            weights,
            len: 3,
            direction,
            squared,
        }
    }

    /// Four corners: the origin inside (`len` 4, proven against rounding for corners no longer than `size`), or the
    /// nearest of the faces it may be beyond.
    fn tetrahedron(c: [Corner<T>; 4], size: f64) -> Self {
        let det = |i: usize, j: usize, k: usize| dot(&c[i].w, &cross(&c[j].w, &c[k].w));
        let mut volume = [det(1, 2, 3), -det(0, 2, 3), det(0, 1, 3), -det(0, 1, 2)];
        let zero = T::from(0.0);
        let sum = volume[0] + volume[1] + volume[2] + volume[3];
        if sum < zero {
            volume = volume.map(|v| -v);
        }
        let certain = T::from(VOLUME * T::UNIT * size * size * size);
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        let mut best: Option<Self> = None;
        for k in 0..4 {
            if !(volume[k] > certain) {
                let [i, j, l] = faces[k];
                let t = Self::triangle(c[i], c[j], c[l]);
                if best.is_none_or(|b| t.squared < b.squared) {
                    best = Some(t);
                }
            }
        }
        best.unwrap_or_else(|| {
            let sum = volume[0] + volume[1] + volume[2] + volume[3];
            Self {
                corners: c,
                weights: volume.map(|v| v / sum),
                len: 4,
                direction: [zero; 3],
                squared: zero,
            }
        })
    }

    /// The nearest point of the hull of these corners and one more.
    pub(crate) fn with(&self, c: Corner<T>, size: f64) -> Self {
        let k = &self.corners;
        match self.len {
            1 => Self::edge(k[0], c),
            2 => Self::triangle(k[0], k[1], c),
            _ => Self::tetrahedron([k[0], k[1], k[2], c], size),
        }
    }

    /// The distance of the point that the weights name. The weights are positive and sum to one, so it is a point of the
    /// difference whatever rounding did to them, and the distance an upper bound; the root of `squared` is none, because
    /// the plane of a needle-shaped triangle may be nearer than the triangle.
    pub(crate) fn reach(&self) -> T {
        let at = |k: usize| {
            let parts = self.kept().iter().zip(&self.weights);
            parts.fold(T::from(0.0), |sum, (c, &weight)| sum + c.w[k] * weight)
        };
        let v = [at(0), at(1), at(2)];
        root(dot(&v, &v))
    }

    /// The corners kept.
    pub(crate) fn kept(&self) -> &[Corner<T>] {
        &self.corners[..self.len]
    }

    /// Whether a corner is kept.
    pub(crate) fn holds(&self, a: u32, b: u32) -> bool {
        self.kept().iter().any(|c| (c.a, c.b) == (a, b))
    }
}
