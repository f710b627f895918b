//! Contact candidates: the vertices of the overlap of two projected features. For two features with
//! few vertices ([`clip`]) the overlap is a polygon, a segment or a point.
//!
//! ```text
//!    A +-----------+
//!      |       v---c-----+ B     v: vertex of either feature inside the opposite feature
//!      |       |   |     |       c: crossing of an edge of A with an edge of B
//!      +-------c---v     |
//!              +---------+
//! ```
//!
//! Both kinds of candidates are found from two tables of signs, which treat A and B alike. Vertices
//! on the boundary, within rounding, belong to both features.

use wide::f64x4;

use crate::base::num::extremes::Bounded;
use crate::body::polyhedron::fans::LARGE;
use crate::convex::contact::projection::ProjectedFeature;

/// Largest number of candidates: for two features of 24 vertices, with some doubled by rounding.
const MAX_CANDIDATES: usize = 64;

/// Location of a point on a projected feature: a vertex, an edge, or the interior.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Location(u32);

impl Location {
    /// The interior of the feature.
    pub(super) const WHOLE: Location = Location(0);
    const VERTEX: u32 = 1 << 30;
    const EDGE: u32 = 2 << 30;

    #[inline(always)]
    pub(super) fn vertex(k: usize) -> Self {
        Location(Self::VERTEX | k as u32)
    }

    #[inline(always)]
    pub(super) fn edge(k: usize) -> Self {
        Location(Self::EDGE | k as u32)
    }

    /// Returns the index of the vertex, if the location is a vertex.
    pub(super) fn as_vertex(self) -> Option<usize> {
        (self.0 & Self::VERTEX != 0).then_some((self.0 & !Self::VERTEX) as usize)
    }

    /// Returns the index of the edge, if the location is an edge.
    pub(super) fn as_edge(self) -> Option<usize> {
        (self.0 & Self::EDGE != 0).then_some((self.0 & !Self::EDGE) as usize)
    }
}

/// A pair of points opposite each other along the normal. Witness points have no vertex or edge
/// location.
//
// The value of an empty slot is all zero bits, so an empty list is cheap to initialize.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactCandidate {
    pub(super) at: [f64; 2],
    /// Height of the point on B above the point on A.
    pub(super) separation: f64,
    pub(super) on: [Location; 2],
}

impl ContactCandidate {
    pub(super) const WITNESS: [Location; 2] = [Location::WHOLE; 2];

    /// Returns the candidate of a pair of points by its position in the plane of contact.
    pub(crate) fn at(at: [f64; 2], separation: f64) -> Self {
        Self {
            at,
            separation,
            on: Self::WITNESS,
        }
    }
}

/// Short list of the candidates that are no farther apart than the prediction.
pub(super) struct Candidates {
    list: [ContactCandidate; MAX_CANDIDATES],
    count: usize,
    /// Signed distance of the witness points.
    distance: f64,
    /// Largest accepted separation.
    prediction: f64,
}

impl Candidates {
    #[inline(always)]
    pub(super) fn new(distance: f64, prediction: f64) -> Self {
        const EMPTY: ContactCandidate = ContactCandidate {
            at: [0.0; 2],
            separation: 0.0,
            on: ContactCandidate::WITNESS,
        };
        Self {
            list: [EMPTY; MAX_CANDIDATES],
            count: 0,
            distance,
            prediction,
        }
    }

    /// Adds a candidate with the given heights over the witness points, if it is near enough. The
    /// witness points are accepted at any separation.
    #[inline(always)]
    pub(super) fn push(&mut self, at: [f64; 2], [on_a, on_b]: [f64; 2], on: [Location; 2]) {
        let separation = self.distance + (on_b - on_a);
        let is_accepted =
            (separation <= self.prediction || on == ContactCandidate::WITNESS) && self.count < MAX_CANDIDATES;
        if is_accepted {
            self.list[self.count] = ContactCandidate { at, separation, on };
            self.count += 1;
        }
    }

    #[inline(always)]
    pub(super) fn all(&self) -> &[ContactCandidate] {
        &self.list[..self.count]
    }

    pub(super) fn all_mut(&mut self) -> &mut [ContactCandidate] {
        &mut self.list[..self.count]
    }
}

/// For each edge of a projected feature, a bit mask of the opposite feature's vertices outside the
/// edge.
struct OutsideTable {
    outside: [u32; LARGE],
    /// Vertices outside any edge, or past the extremes of the coordinates, beyond rounding.
    beyond: u32,
}

impl OutsideTable {
    #[inline(always)]
    fn new(of: &ProjectedFeature, vertices: &ProjectedFeature, noise: f64) -> Self {
        let mut table = Self {
            outside: [0; LARGE],
            beyond: 0,
        };
        let fours = vertices.count.div_ceil(4);
        let xs = || vertices.x.as_chunks::<4>().0[..fours].iter();
        let ys = || vertices.y.as_chunks::<4>().0[..fours].iter();
        for j in 0..of.count {
            let next = of.next(j);
            let u = [of.x[next] - of.x[j], of.y[next] - of.y[j]];
            let (ux, uy) = (f64x4::splat(u[0]), f64x4::splat(u[1]));
            let line = f64x4::splat(u[0] * of.y[j] - u[1] * of.x[j]);
            let margin = line - f64x4::splat(noise * (u[0].abs() + u[1].abs()));
            let (mut outside, mut beyond) = (0, 0);
            for (k, (x, y)) in xs().zip(ys()).enumerate() {
                let side = ux * f64x4::new(*y) - uy * f64x4::new(*x);
                outside |= side.simd_lt(line).to_bitmask() << (4 * k);
                beyond |= side.simd_lt(margin).to_bitmask() << (4 * k);
            }
            table.outside[j] = outside;
            table.beyond |= beyond;
        }
        let [[left, right], [low, high]] = of.span();
        let (left, right) = (f64x4::splat(left - noise), f64x4::splat(right + noise));
        let (low, high) = (f64x4::splat(low - noise), f64x4::splat(high + noise));
        for (k, (x, y)) in xs().zip(ys()).enumerate() {
            let (x, y) = (f64x4::new(*x), f64x4::new(*y));
            let past = x.simd_lt(left) | x.simd_gt(right) | y.simd_lt(low) | y.simd_gt(high);
            table.beyond |= past.to_bitmask() << (4 * k);
        }
        table
    }

    /// Returns a bit mask of the other feature's edges with ends on both sides of the line of edge
    /// `j`.
    #[inline(always)]
    fn straddling(&self, j: usize, other: &ProjectedFeature) -> u32 {
        let here = self.outside[j] & all_bits(other);
        // A projected edge has two vertices but is a single edge.
        if other.is_edge() {
            return (here ^ here >> 1) & 1;
        }
        let next = here >> 1 | (here & 1) << (other.count - 1);
        here ^ next
    }
}

/// Returns a mask with a bit for each vertex.
#[inline(always)]
fn all_bits(s: &ProjectedFeature) -> u32 {
    (1 << s.count) - 1
}

/// Calls `f` with the index of each set bit.
#[inline(always)]
fn for_each_bit(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Adds the vertices of the overlap of two features; `noise` is the rounding of a plane coordinate.
#[inline(always)]
pub(super) fn clip(a: &ProjectedFeature, b: &ProjectedFeature, noise: f64, candidates: &mut Candidates) {
    let of_b = OutsideTable::new(b, a, noise);
    // An edge has no interior: its two sides would be one line.
    let inside_b = if b.is_edge() { 0 } else { all_bits(a) & !of_b.beyond };
    for_each_bit(inside_b, |i| {
        let at = [a.x[i], a.y[i]];
        candidates.push(
            at,
            [a.vertex(i)[2], b.height_on_face(at)],
            [Location::vertex(i), Location::WHOLE],
        );
    });
    let of_a = OutsideTable::new(a, b, noise);
    let inside_a = if a.is_edge() { 0 } else { all_bits(b) & !of_a.beyond };
    for_each_bit(inside_a, |j| {
        let at = [b.x[j], b.y[j]];
        candidates.push(
            at,
            [a.height_on_face(at), b.vertex(j)[2]],
            [Location::WHOLE, Location::vertex(j)],
        );
    });
    let edges = if b.is_edge() { 1 } else { b.count };
    for j in 0..edges {
        for_each_bit(of_b.straddling(j, a), |i| {
            if of_a.straddling(i, b) >> j & 1 == 1 {
                push_crossing(a, b, i, j, candidates);
            }
        });
    }
}

/// Plane coordinates and height of the end of an edge.
pub(super) type LocalPoint = [f64; 3];

/// Crossing of two edges: plane coordinates, parameter along each edge, and height on each edge.
pub(super) struct Crossing {
    pub(super) at: [f64; 2],
    pub(super) along: [f64; 2],
    pub(super) heights: [f64; 2],
}

/// Returns the crossing of an edge of A with an edge of B; `None` unless each line separates the
/// ends of the opposite edge, and the edges meet within `noise`.
#[inline(always)]
pub(super) fn crossing(e: &[LocalPoint; 2], f: &[LocalPoint; 2], noise: f64) -> Option<Crossing> {
    do_cross(e, f).then(|| intersection(e, f, noise)).flatten()
}

/// Returns the crossing of an edge of A with an edge of B whose line separates the ends of A's edge
/// up to rounding. `None` if the edges are farther apart than `noise`, as edges on one line may be.
#[inline(always)]
fn intersection([p, q]: &[LocalPoint; 2], [r, s]: &[LocalPoint; 2], noise: f64) -> Option<Crossing> {
    let (u, v) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
    let side = |x: &LocalPoint| v[0] * (x[1] - r[1]) - v[1] * (x[0] - r[0]);
    let (from, to) = (side(p), side(q));
    // Exactly one of the two values is negative; if rounding hides the parameter, take the middle.
    let t = from / (from - to);
    let t = if (0.0..=1.0).contains(&t) { t } else { 0.5 };
    let point = |from: &LocalPoint, way: [f64; 2], t: f64| [from[0] + t * way[0], from[1] + t * way[1]];
    let foot = |at: [f64; 2], from: &LocalPoint, way: [f64; 2]| {
        let along = (at[0] - from[0]) * way[0] + (at[1] - from[1]) * way[1];
        along / (way[0] * way[0] + way[1] * way[1])
    };
    let along = foot(point(p, u, t), r, v);
    // Edges on one line cross anywhere on both: use an end of B's edge if A's edge continues beyond
    // it.
    let (t, along) = if (0.0..=1.0).contains(&along) {
        (t, along)
    } else {
        let end = if along > 0.0 { 1.0 } else { 0.0 };
        let beside = foot(point(r, v, end), p, u);
        (if beside > 0.0 { beside.at_most(1.0) } else { 0.0 }, end)
    };
    let (at, opposite) = (point(p, u, t), point(r, v, along));
    let apart = [at[0] - opposite[0], at[1] - opposite[1]];
    let meet = apart[0] * apart[0] + apart[1] * apart[1] <= noise * noise;
    meet.then(|| Crossing {
        at,
        along: [t, along],
        heights: [p[2] + t * (q[2] - p[2]), r[2] + along * (s[2] - r[2])],
    })
}

/// Returns whether two edges cross: each line separates the ends of the opposite edge.
#[inline(always)]
fn do_cross([p, q]: &[LocalPoint; 2], [r, s]: &[LocalPoint; 2]) -> bool {
    let left =
        |p: &LocalPoint, q: &LocalPoint, x: &LocalPoint| (q[0] - p[0]) * (x[1] - p[1]) >= (q[1] - p[1]) * (x[0] - p[0]);
    left(r, s, p) != left(r, s, q) && left(p, q, r) != left(p, q, s)
}

/// Adds the crossing of edge `i` of A and edge `j` of B if the edges meet. Their lines separate
/// each other's ends up to rounding.
#[inline(always)]
pub(super) fn push_crossing(
    a: &ProjectedFeature,
    b: &ProjectedFeature,
    i: usize,
    j: usize,
    candidates: &mut Candidates,
) {
    if let Some(Crossing { at, heights, .. }) = intersection(&a.ends(i), &b.ends(j), a.axes.noise) {
        candidates.push(at, heights, [Location::edge(i), Location::edge(j)]);
    }
}

/// Adds the ends of the overlap of two nearly parallel edges, each end opposite its foot on the
/// other edge. Adds nothing if the edges are not nearly parallel, because they then cross at the
/// witness points.
pub(super) fn overlap_edges(a: &ProjectedFeature, b: &ProjectedFeature, sine: f64, candidates: &mut Candidates) {
    let direction = |s: &ProjectedFeature| [s.x[1] - s.x[0], s.y[1] - s.y[0]];
    let (u, v) = (direction(a), direction(b));
    let squared = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
    let turn = u[0] * v[1] - u[1] * v[0];
    if turn * turn > sine * sine * squared(u) * squared(v) {
        return;
    }
    for k in 0..2 {
        for (of, to, is_a) in [(a, b, true), (b, a, false)] {
            let at = [of.x[k], of.y[k]];
            let t = to.along(0, at);
            if t > 0.0 && t < 1.0 {
                let foot = to.height_on_edge(0, at);
                if is_a {
                    candidates.push(at, [of.vertex(k)[2], foot], [Location::vertex(k), Location::WHOLE]);
                } else {
                    candidates.push(at, [foot, of.vertex(k)[2]], [Location::WHOLE, Location::vertex(k)]);
                }
            }
        }
    }
}
