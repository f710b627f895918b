//! Exact support vertex. The search examines few vertices, even if thousands tie exactly or within
//! rounding because the direction is normal to a large face or fan.
//!
//! A body is the exact hull of its stored points, and its faces are exactly flat. With exact signs,
//! three statements therefore hold without exception. A vertex that no adjacent vertex exceeds is a
//! support vertex. Heights around a face are unimodal, and so are the slopes of the edges of a fan
//! (see `fans`). The points at the height of a support vertex are the vertex itself, an edge or a
//! face. So hill climbing and bisection need no further proof.
//!
//! Vertices are compared by height along a direction, and edges by slope, without rounding. A sign
//! comes from f64 if f64 is certain; otherwise from double-double, and then from exact sums, or
//! from integers at the exact stage ([`Upward`]).

use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::each::Each;
use crate::base::num::scalar::Scalar;
use crate::base::num::sign::{dot_and_size, edge_sign, exact_dot, is_level, sign};
use crate::base::tolerance::{EDGE_SIGN, LEAST_RISE, STEEPER, UNIT};
use crate::body::polyhedron::build::cloud::{exponent_of, power_of_two};
use crate::body::polyhedron::fans::{Axis, Cycle, Fans, MANY};
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, HalfEdgeId, VertexId};
use core::cmp::Ordering;
use nalgebra::Vector3;

/// Returns the highest vertex of the large faces at `v`, or a high vertex of the large fans
/// adjacent to `v`; `v` itself if none is higher.
pub(super) fn jump<U: Upward>(t: &Topology, fans: &Fans, n: &U, v: VertexId) -> VertexId {
    if !t.has_large_faces() && fans.is_empty() || t.fan(v).len() > MANY {
        return v;
    }
    let mut best = v;
    let mut take = |w: VertexId| {
        if n.rise(best, w) > 0 {
            best = w;
        }
    };
    for h in t.fan(v).iter() {
        let e = t.half_edge(h);
        if let Some(ring) = t.ring(e.face) {
            take(t.from(ring.top(|h| Height(n, t.from(h)))));
        }
        if fans.axis(t, e.to).is_some() {
            // If the adjacent vertices lie in one plane, this is the highest of them.
            let to = |h| t.half_edge(h).to;
            take(to(t.fan(e.to).top(|h| Height(n, to(h)))));
        }
    }
    best
}

impl ConvexPolyhedron {
    /// Returns the support vertex along `n`, the lowest id among equal vertices, climbing from
    /// `start`.
    #[inline(never)]
    pub(crate) fn support_exact<U: Upward>(&self, n: &U, start: VertexId) -> VertexId {
        let mut v = start;
        // Each vertex is higher than the previous vertex.
        for _ in 0..self.points.len() {
            match self.higher_vertex(n, v) {
                Ok(higher) => v = jump(&self.topology, &self.fans, n, higher),
                Err(first) => return first,
            }
        }
        v
    }

    /// Returns an adjacent vertex higher than `v`, or, as an error, the lowest id among the
    /// vertices level with `v` if none is higher.
    fn higher_vertex<U: Upward>(&self, n: &U, v: VertexId) -> Result<VertexId, VertexId> {
        let t = &self.topology;
        let to = |h: HalfEdgeId| t.half_edge(h).to;
        let (fan, (first, count)) = (t.fan(v), self.candidate_edges(n, v));
        let next = |h| fan.after(h);
        let (mut best, mut level, mut h) = (v, [None; 2], first);
        for _ in 0..count {
            let w = to(h);
            match n.rise(v, w) {
                1 if best == v || n.rise(best, w) > 0 => best = w,
                0 if level[0].is_some() => level[1] = Some(h),
                0 => level[0] = Some(h),
                _ => {}
            }
            h = next(h);
        }
        match level {
            _ if best != v => Ok(best),
            [Some(g), Some(h)] => {
                // Two level edges are adjacent in the fan, with a face between them.
                let h = if next(g) == h { g } else { h };
                Err(t.from(t.rim_half_edge(t.half_edge(h).face)))
            }
            [Some(h), _] => Err(v.min(to(h))),
            _ => Err(v),
        }
    }

    /// Returns a run of edges of `v`, first and count, including a rising or level edge if there is
    /// any: the whole fan, or the steepest edge of a large fan and the edges next to it.
    fn candidate_edges<U: Upward>(&self, n: &U, v: VertexId) -> (HalfEdgeId, usize) {
        let (t, fan) = (&self.topology, self.topology.fan(v));
        let Some(m) = self.fans.axis(t, v) else {
            return (fan.at(0), fan.len());
        };
        (fan.wrapped(self.steepest(n, v, m) + fan.len() - 1), 3)
    }

    /// Returns the index in the large fan of `v`, whose axis is `m`, of the edge with the greatest
    /// slope along `n`.
    fn steepest<U: Upward>(&self, n: &U, v: VertexId, m: &Axis) -> usize {
        let (t, fan) = (&self.topology, self.topology.fan(v));
        fan.top_index(|h| Slope(n, m, v, t.half_edge(h).to))
    }

    /// Returns a rising edge of `v` along `n`, if there is any, else a level edge, else any edge;
    /// `None` for a point.
    #[cfg(feature = "exact")]
    pub(crate) fn rising<U: Upward>(&self, n: &U, v: VertexId) -> Option<HalfEdgeId> {
        let (t, fan) = (&self.topology, self.topology.fan(v));
        if let Some(m) = self.fans.axis(t, v) {
            return Some(fan.at(self.steepest(n, v, m)));
        }
        let to = |h: HalfEdgeId| t.half_edge(h).to;
        fan.iter()
            .reduce(|best, h| if n.rise(to(best), to(h)) > 0 { h } else { best })
    }
}

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
        [0, 1, 2].each(|k| DoubleDouble {
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
        [0, 1, 2].each(|k| DoubleDouble::sum(q[k], -p[k]))
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
        exact_dot::<2, 24>(&fine.each(|n| [n.hi, n.lo]), p, q).sign()
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
        let [p, q, r] = [p, q, r].each(|v| &self.points[v.index()]);
        let up = fine.each(|n| [n.hi, n.lo]);
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
    let [n, m, e, f] = [n, m, e, f].each(|v| <[f64; 3]>::from(*v));
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
    use crate::base::num::sign::exact_dot;
    use crate::body::polyhedron::FaceId;
    use crate::body::polyhedron::highest::Direction;
    use crate::rng::Rng;
    use alloc::vec::Vec;
    use core::cell::Cell;
    use core::f64::consts::TAU;
    use nalgebra::{Point3, UnitQuaternion, Vector3};

    /// Prisms, rotated or not (rounding splits the lids of a rotated prism into thousands of
    /// faces), cones, and a face that bulges by rounding.
    fn body(kind: &str, n: usize, rng: &mut Rng) -> ConvexPolyhedron {
        let angle = |k| {
            if kind.starts_with("odd") {
                rng.range(0.0, TAU)
            } else {
                TAU * k as f64 / n as f64
            }
        };
        let rim: Vec<_> = (0..n)
            .map(angle)
            .map(|t| Point3::new(t.cos(), 0.7 * t.sin(), 0.0))
            .collect();
        let lid = rim.iter().map(|p| p + Vector3::new(0.0, 0.0, 0.4));
        let turn = UnitQuaternion::from_euler_angles(0.3, 0.7, -0.4);
        let points: Vec<_> = match kind {
            "prism" | "odd prism" => rim.iter().copied().chain(lid).collect(),
            "turned prism" => rim.iter().copied().chain(lid).map(|p| turn * p).collect(),
            "flat cone" => rim.iter().copied().chain([Point3::new(0.1, 0.1, 1e-13)]).collect(),
            "turned cone" => rim
                .iter()
                .copied()
                .chain([Point3::new(0.1, 0.1, 0.5)])
                .map(|p| turn * p)
                .collect(),
            "odd cone" => rim.iter().copied().chain([Point3::new(0.2, -0.1, 0.5)]).collect(),
            "octahedron" => [0, 1, 2]
                .into_iter()
                .flat_map(|k| [1.0, -1.0].map(|x| Point3::from(Vector3::ith(k, x))))
                .collect(),
            _ => {
                let inside = rim.iter().enumerate().map(|(k, p)| {
                    let s = k as f64 / n as f64;
                    Point3::new(p.x * s, p.y * s, 1e-15 * (1.0 - s * s))
                });
                rim.iter()
                    .copied()
                    .chain(inside)
                    .chain([Point3::new(0.0, 0.0, -0.3)])
                    .collect()
            }
        };
        ConvexPolyhedron::from_points(&points).expect("a solid")
    }

    const KINDS: [&str; 8] = [
        "prism",
        "odd prism",
        "turned prism",
        "flat cone",
        "turned cone",
        "odd cone",
        "bulge",
        "octahedron",
    ];

    /// Directions perpendicular to faces, to edges and to nothing, off by rounding and less: each
    /// direction and its rest.
    fn directions(body: &ConvexPolyhedron, count: usize, rng: &mut Rng) -> Vec<[Vector3<f64>; 2]> {
        let pick = |m: usize, rng: &mut Rng| (rng.range(0.0, m as f64) as usize).min(m - 1);
        let largest = FaceId::all(body.planes.len()).max_by_key(|&f| body.topology.rim(f).count());
        let aside = |off: f64, rng: &mut Rng| Vector3::from(rng.unit()) * off;
        let one = |k: usize, rng: &mut Rng| {
            let face = match k % 3 {
                0 => pick(body.planes.len(), rng),
                _ => largest.map_or(0, FaceId::index),
            };
            let off = [0.0, 1e-17, 1e-16, 1e-15, 1e-12, 1e-6, 1.0][k / 3 % 7];
            let n = body.planes[face].normal * 0.7 + aside(off, rng);
            let rest = n.map(|x| x * rng.range(-1.0, 1.0) * [0.0, 1e-33, 5e-17][k / 21 % 3]);
            [n, rest]
        };
        (0..count).map(|k| one(k, rng)).collect()
    }

    #[test]
    fn no_vertex_is_higher_and_none_as_high_has_a_lower_number() {
        let mut ties = [0; 4];
        for kind in KINDS {
            for n in [7, 60, 1000] {
                let mut rng = Rng::new(n as u64);
                let body = body(kind, n, &mut rng);
                for [n, rest] in directions(&body, 126, &mut rng) {
                    let parts = [0, 1, 2].map(|k| [n[k], rest[k]]);
                    // Exact, without a floating-point filter.
                    let rise = |p: VertexId, q: VertexId| {
                        exact_dot::<2, 24>(&parts, &body.points[p.index()], &body.points[q.index()]).sign()
                    };
                    let all = VertexId::all(body.points.len());
                    let top = all
                        .clone()
                        .fold(VertexId(0), |top, v| if rise(top, v) > 0 { v } else { top });
                    let level = all.filter(|&v| rise(top, v) == 0).count();
                    ties[level.min(4) - 1] += 1;
                    let direction = Direction::new(&body.points, &n, &rest);
                    let middle = VertexId(body.points.len() as u32 / 2);
                    for start in [top, VertexId(0), middle, body.support_climb(&n, VertexId(1))] {
                        assert_eq!(
                            body.support_exact(&direction, start),
                            top,
                            "{kind} {n} {rest}: {level} level"
                        );
                    }
                }
            }
        }
        // Vertices, edges, triangles and larger faces.
        assert!(
            ties[0] > 500 && ties[1] > 5 && ties[2] > 20 && ties[3] > 100,
            "{ties:?}"
        );
    }

    /// Counts comparisons.
    struct Counted<U>(U, Cell<u32>);

    impl<U: Upward> Upward for Counted<U> {
        fn rise(&self, p: VertexId, q: VertexId) -> i32 {
            self.1.set(self.1.get() + 1);
            self.0.rise(p, q)
        }
        fn steeper(&self, m: &Axis, p: VertexId, q: VertexId, r: VertexId) -> i32 {
            self.1.set(self.1.get() + 1);
            self.0.steeper(m, p, q, r)
        }
    }

    #[test]
    fn comparisons_are_few_on_plateaus_of_thousands() {
        for kind in KINDS {
            let most = |n: usize| {
                let mut rng = Rng::new(3);
                let body = body(kind, n, &mut rng);
                let list = directions(&body, 210, &mut rng);
                let counts = list.iter().map(|[n, rest]| {
                    let direction = Counted(Direction::new(&body.points, n, rest), Cell::new(0));
                    body.support_exact(&direction, body.support_climb(n, VertexId(0)));
                    direction.1.get()
                });
                counts.max().unwrap_or(0)
            };
            let (few, many) = (most(500), most(16_000));
            assert!(many <= 3 * few + 60 && many < 1000, "{kind}: {few} and {many}");
        }
    }
}

#[cfg(test)]
mod heights_tests {
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
