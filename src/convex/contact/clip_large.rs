//! Overlap of two faces, one or both with many vertices. It is found by rays from an interior
//! point, without visiting most vertices.
//!
//! ```text
//!       .-----.
//!     /    A .-+----.        m: a point inside both faces
//!    |      /   \     \      i: the edge by which the ray leaves A, before leaving B
//!    |     |  m--i->   |     The left end of i is a candidate if it lies in B; otherwise the
//!     \     \   /   B /      crossing of i with the boundary of B is.
//!       '----+'-----'
//! ```
//!
//! The edge by which a ray leaves each face is found by bisection. The nearer exit is on the
//! boundary of the overlap; the end of its edge, or the crossing of the edge with the opposite
//! boundary, is a candidate. An exit that rounding hides is ignored, and so is a crossing whose
//! edges do not meet. So every candidate lies in both faces. Faces whose overlap is only a line
//! have no interior point: the ends of the line are found among the vertices next to the witness
//! points.
//!
//! Four rays are cast crosswise, some more between them, and then some through the middle of the
//! longest sides found so far. For two discs of `m` vertices each ray visits `log m` of them. Not
//! all vertices of the overlap are found, but more than requested, spread over the overlap.

use core::cmp::Ordering;

use super::MOST_POINTS;
use super::clip::{Candidates, Location, push_crossing};
use super::projection::ProjectedFeature;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;

/// Number of vertices of a face boundary that are tried next to a hint before bisection.
const MAX_LOCAL_STEPS: usize = 4;

/// Rays are cast from a point of an overlap that is this many times the rounding of a position away
/// from the boundaries. Nearer to them, rounding would choose the edges by which the rays leave.
/// Narrower overlaps count as lines.
const INSIDE: f64 = 16.0;

/// Exit edges of the rays of the previous frame on the faces of A and of B: the next rays exit near
/// them.
pub(super) type Rays = [[u32; 2]; 12];

/// Exit edges of rays never cast before.
pub(super) const NO_RAYS: Rays = [[u32::MAX; 2]; 12];

type Point2 = [f64; 2];

fn minus(p: Point2, q: Point2) -> Point2 {
    [p[0] - q[0], p[1] - q[1]]
}

fn turn(u: Point2, v: Point2) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn dot(u: Point2, v: Point2) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

impl ProjectedFeature<'_> {
    /// Returns a point inside the face.
    pub(super) fn middle(&self) -> Point2 {
        let [p, q, r] = [0, self.count / 3, 2 * self.count / 3].each(|k| self.position(k));
        [0, 1].each(|k| (p[k] + q[k] + r[k]) / 3.0)
    }

    /// Returns whether the face is no wider than rounding, so that rounding decides the exits of
    /// rays. For a large face an inscribed triangle decides.
    fn is_sliver(&self) -> bool {
        let noise = self.axes.noise;
        let count = if self.is_large() { 3 } else { self.count };
        let relative = |k: usize| minus(self.position(k * self.count / count), self.position(0));
        let (mut area, mut reach) = (0.0, 0.0f64);
        for k in 2..count {
            let (p, q) = (relative(k - 1), relative(k));
            area += turn(p, q);
            reach = reach.larger(dot(p, p)).larger(dot(q, q));
        }
        // NaN counts as a sliver.
        !self.is_edge() && !(area.abs() > noise * sqrt(reach))
    }

    /// Returns the exit of a ray from `from`, inside the face: the ray parameter in multiples of
    /// `way`, and the exit edge. The parameter is 0 if no point of the edge found lies on the ray,
    /// which may happen if `from` is on the boundary. The call is fast if the exit edge is `hint`
    /// or near it.
    fn exit(&self, from: Point2, way: Point2, hint: usize) -> (f64, usize) {
        let relative = |k: usize| minus(self.position(k), from);
        let exit_at = |k: usize, p: Point2, q: Point2| {
            let (right, left) = (turn(way, p), turn(way, q));
            let s = if left > right {
                (-right / (left - right)).clamped(0.0, 1.0)
            } else {
                0.5
            };
            let x = [p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])];
            let (beside, squared) = (turn(way, x), dot(way, way));
            let is_on_ray = beside * beside <= self.axes.noise * self.axes.noise * squared;
            (if is_on_ray { dot(x, way) / squared } else { 0.0 }, k)
        };
        // Right of the ray at the start, left of the ray at the end, and seen from inside.
        let hit = |p: Point2, q: Point2| {
            turn(way, p) <= 0.0 && turn(way, q) >= 0.0 && turn(p, q) > 0.0 && dot(way, q) + dot(way, p) > 0.0
        };
        let near = if hint < self.count { MAX_LOCAL_STEPS } else { 0 };
        let mut k = hint.min(self.count - 1);
        let mut p = relative(k);
        let forward = turn(way, p) <= 0.0;
        for _ in 0..near {
            let adjacent = if forward {
                self.next(k)
            } else if k == 0 {
                self.count - 1
            } else {
                k - 1
            };
            let q = relative(adjacent);
            if forward && hit(p, q) {
                return exit_at(k, p, q);
            }
            if !forward && hit(q, p) {
                return exit_at(adjacent, q, p);
            }
            (k, p) = (adjacent, q);
        }
        let k = self.bisect(from, way);
        exit_at(k, relative(k), relative(self.next(k)))
    }

    /// Returns the edge by which a ray exits, found by bisection.
    fn bisect(&self, from: Point2, way: Point2) -> usize {
        let relative = |k: usize| minus(self.position(k), from);
        let first = relative(0);
        let ahead = turn(first, way) >= 0.0;
        // Returns whether `v` comes before the ray, counter-clockwise from the first vertex.
        let before = |v: Point2| {
            let (half, short) = (turn(first, v) >= 0.0, turn(v, way) >= 0.0);
            if ahead { half && short } else { half || short }
        };
        let (mut low, mut high) = (0, self.count);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if before(relative(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Returns whether a point is in the face, as seen from the interior point `middle`; true for
    /// NaN.
    pub(super) fn contains(&self, middle: Point2, at: Point2) -> bool {
        !(self.exit(middle, minus(at, middle), usize::MAX).0 < 1.0)
    }

    /// Returns whether a point is in the face and several times rounding away from its boundary, as
    /// seen from the interior point `middle`. An edge has no interior; all its points are accepted.
    fn is_well_inside(&self, middle: Point2, at: Point2) -> bool {
        let (far, k) = self.exit(middle, minus(at, middle), usize::MAX);
        let (p, q) = (self.position(k), self.position(self.next(k)));
        let (u, margin) = (minus(q, p), INSIDE * self.axes.noise);
        let inside = turn(u, minus(at, p));
        // At the middle the parameter is NaN.
        !(far < 1.0) && (self.is_edge() || inside > 0.0 && inside * inside > margin * margin * dot(u, u))
    }

    /// Returns the edge by which a ray from the middle through the witness leaves the face, and the
    /// unit direction from the edge inwards.
    fn edge_at_witness(&self, middle: Point2) -> (usize, Point2) {
        let (_, k) = self.exit(middle, [-middle[0], -middle[1]], usize::MAX);
        let u = minus(self.position(self.next(k)), self.position(k));
        let length = sqrt(dot(u, u));
        (k, [-u[1] / length, u[0] / length])
    }

    /// Returns the four vertices next to the witness, of which the inner two end the edge that
    /// holds the witness, if the witness is on the boundary.
    fn vertices_at_witness(&self) -> [usize; 4] {
        let (k, _) = self.edge_at_witness(self.middle());
        [self.count - 1, 0, 1, 2].each(|n| (k + n) % self.count)
    }

    /// Returns whether a point is in the face, or outside it by no more than rounding.
    fn holds(&self, at: Point2) -> bool {
        let middle = self.middle();
        let (far, k) = self.exit(middle, minus(at, middle), usize::MAX);
        let (p, q, t) = (self.position(k), self.position(self.next(k)), self.along(k, at));
        let off = [0, 1].each(|i| p[i] + t * (q[i] - p[i]) - at[i]);
        far >= 1.0 || dot(off, off) <= self.axes.noise * self.axes.noise
    }
}

/// Returns a point well inside both faces, farther from their boundaries than rounding. It is the
/// hint, or a point offset from the witness points (the origin of the plane) towards the middle of
/// a face, or away from one or both boundaries. `None` if the overlap is as narrow as rounding.
fn common_point(a: &ProjectedFeature, b: &ProjectedFeature, hint: Option<Point2>) -> Option<Point2> {
    let (of_a, of_b) = (a.middle(), b.middle());
    let both = |p: &Point2| a.is_well_inside(of_a, *p) && b.is_well_inside(of_b, *p);
    if let Some(hint) = hint.filter(both) {
        return Some(hint);
    }
    if let Some(p) = [of_a, of_b].each(|w| [w[0] * 0.5, w[1] * 0.5]).into_iter().find(both) {
        return Some(p);
    }
    let ((_, m), (_, n)) = (a.edge_at_witness(of_a), b.edge_at_witness(of_b));
    let reach = sqrt(dot(of_a, of_a).smaller(dot(of_b, of_b)));
    let between = [(m[0] + n[0]) * reach, (m[1] + n[1]) * reach];
    let mut part = 1.0;
    for _ in 0..12 {
        let ways = [between, of_a, of_b].each(|w| [w[0] * part, w[1] * part]);
        if let Some(p) = ways.into_iter().find(both) {
            return Some(p);
        }
        part *= 0.5;
    }
    // A strip: half of its width.
    let across = |way: Point2| {
        let width = [a, b].each(|face| face.exit([0.0; 2], way, usize::MAX).0);
        let half = 0.5 * width[0].smaller(width[1]);
        [way[0] * half, way[1] * half]
    };
    [m, n].each(across).into_iter().find(both)
}

/// Adds the ends of a line along which two faces meet: the vertices of each near the witnesses that
/// lie in the opposite face.
fn share_line(a: &ProjectedFeature, b: &ProjectedFeature, candidates: &mut Candidates) {
    for k in a.vertices_at_witness() {
        if b.holds(a.position(k)) {
            push_vertex_of_a(a, k, b, candidates);
        }
    }
    for k in b.vertices_at_witness() {
        if a.holds(b.position(k)) {
            push_vertex_of_b(a, b, k, candidates);
        }
    }
}

/// Adds vertex `k` of A and the point of B opposite.
fn push_vertex_of_a(a: &ProjectedFeature, k: usize, b: &ProjectedFeature, candidates: &mut Candidates) {
    let at = a.position(k);
    let heights = [a.vertex(k)[2], b.height_at(at)];
    candidates.push(at, heights, [Location::vertex(k), Location::WHOLE]);
}

/// Adds vertex `k` of B and the point of A opposite.
fn push_vertex_of_b(a: &ProjectedFeature, b: &ProjectedFeature, k: usize, candidates: &mut Candidates) {
    let at = b.position(k);
    let heights = [a.height_at(at), b.vertex(k)[2]];
    candidates.push(at, heights, [Location::WHOLE, Location::vertex(k)]);
}

/// Two faces, and the number of rays cast so far.
pub(super) struct RimRays<'a> {
    a: &'a ProjectedFeature<'a>,
    b: &'a ProjectedFeature<'a>,
    rays: &'a mut Rays,
    count: usize,
}

/// Adds candidates on the boundary of the overlap of two faces, enough to choose `most` from; none
/// if a face is a sliver no wider than rounding. `hint` may be near the middle of the overlap.
pub(super) fn clip(
    [a, b]: [&ProjectedFeature; 2],
    hint: Option<Point2>,
    most: usize,
    rays: &mut Rays,
    candidates: &mut Candidates,
) {
    if a.is_sliver() || b.is_sliver() {
        return;
    }
    let Some(mut centre) = common_point(a, b, hint) else {
        share_line(a, b, candidates);
        return;
    };
    let mut caster = RimRays { a, b, rays, count: 0 };
    let first = candidates.all().len();
    let mut half = [0.0; 2];
    for k in 0..2 {
        let mut ray = |way: f64| {
            let mut axis = [0.0; 2];
            axis[k] = way;
            caster.cast_ray(centre, axis, candidates)
        };
        let (ahead, back) = (ray(1.0), ray(-1.0));
        half[k] = (ahead + back) * 0.5;
        centre[k] += (ahead - back) * 0.5;
    }
    // Between the axes a round or square outline is hit before the sum of both half axes; a long
    // outline beyond the sum, and then on both ends.
    for [x, y] in [half, [-half[0], half[1]]] {
        if caster.cast_ray(centre, [x, y], candidates) > 1.0 {
            caster.cast_ray(centre, [-x, -y], candidates);
        }
    }
    let mut tried = [[f64::NAN; 2]; MOST_POINTS / 2];
    for k in 0..most / 2 {
        if candidates.all().len() < first + 3 {
            return;
        }
        tried[k] = caster.widen(first, &tried[..k], candidates);
    }
}

impl RimRays<'_> {
    /// Casts a further ray from the middle of the longest untried side of the candidates found;
    /// returns the middle.
    fn widen(&mut self, first: usize, tried: &[Point2], candidates: &mut Candidates) -> Point2 {
        let found = &mut candidates.all_mut()[first..];
        let count = found.len();
        let sum = found.iter().fold([0.0; 2], |s, c| [s[0] + c.at[0], s[1] + c.at[1]]);
        let middle = [sum[0] / count as f64, sum[1] / count as f64];
        // Sorts counter-clockwise from the first candidate.
        let start = minus(found[0].at, middle);
        let half = |p: Point2| turn(start, p) < 0.0 || turn(start, p) == 0.0 && dot(start, p) < 0.0;
        let order = |p: Point2, q: Point2| {
            let (u, v) = (minus(p, middle), minus(q, middle));
            half(u).cmp(&half(v)).then(turn(v, u).total_cmp(&turn(u, v)))
        };
        // Sorted here: with rounding the comparison is not a total order, and library sorts may
        // panic.
        for end in 2..count {
            let mut k = end;
            while k > 1 && order(found[k].at, found[k - 1].at) == Ordering::Less {
                found.swap(k, k - 1);
                k -= 1;
            }
        }
        let mut longest = (0.0, [f64::NAN; 2], [0.0; 2]);
        for k in 0..count {
            let (p, q) = (found[k].at, found[(k + 1) % count].at);
            let u = minus(q, p);
            let from = [(p[0] + q[0]) * 0.5, (p[1] + q[1]) * 0.5];
            if dot(u, u) > longest.0 && !tried.contains(&from) {
                longest = (dot(u, u), from, [u[1], -u[0]]);
            }
        }
        let (length, from, way) = longest;
        if length > 0.0 {
            self.cast_ray(from, way, candidates);
        }
        from
    }

    /// Casts a ray from an interior point and adds the left end (for small faces also the right
    /// end) of the boundary edge it hits. Returns the ray parameter in multiples of `way`.
    fn cast_ray(&mut self, from: Point2, way: Point2, candidates: &mut Candidates) -> f64 {
        let (a, b) = (self.a, self.b);
        let before = self.rays.get(self.count).copied().unwrap_or([u32::MAX; 2]);
        let ((far_a, i), (far_b, j)) = (
            a.exit(from, way, before[0] as usize),
            b.exit(from, way, before[1] as usize),
        );
        if let Some(ray) = self.rays.get_mut(self.count) {
            *ray = [i as u32, j as u32];
        }
        self.count += 1;
        if far_a <= far_b {
            for end in tested_ends(a, i) {
                match crossing_edge(a, i, end, b, j, from) {
                    None => push_vertex_of_a(a, end, b, candidates),
                    Some(j) => push_crossing(a, b, i, j, candidates),
                }
            }
        } else {
            for end in tested_ends(b, j) {
                match crossing_edge(b, j, end, a, i, from) {
                    None => push_vertex_of_b(a, b, end, candidates),
                    Some(i) => push_crossing(a, b, i, j, candidates),
                }
            }
        }
        far_a.smaller(far_b)
    }
}

/// Returns the ends of edge `k` to be tested.
fn tested_ends(of: &ProjectedFeature, k: usize) -> impl Iterator<Item = usize> {
    let right = (!of.is_large()).then_some(k);
    core::iter::once(of.next(k)).chain(right)
}

/// Returns the outer face's boundary edge that crosses edge `k` of the inner face between the ray,
/// which exits the outer face by `start`, and an end of edge `k`; `None` if the end is in the outer
/// face.
fn crossing_edge(
    inner: &ProjectedFeature,
    k: usize,
    end: usize,
    outer: &ProjectedFeature,
    start: usize,
    from: Point2,
) -> Option<usize> {
    let (far, last) = outer.exit(from, minus(inner.position(end), from), start);
    if !(far < 1.0) {
        return None;
    }
    let p = inner.position(k);
    let u = minus(inner.position(inner.next(k)), p);
    let m = outer.count;
    // The ray exits by edge 0, the segment to the end by the last edge; the vertices between are
    // first outside the inner edge, then inside.
    let left = end != k;
    let edge = |n: usize| if left { (start + n) % m } else { (start + m - n) % m };
    let inside = |n: usize| {
        let vertex = if left { outer.next(edge(n)) } else { edge(n) };
        turn(u, minus(outer.position(vertex), p)) >= 0.0
    };
    let (mut low, mut high) = (
        0,
        if left {
            (last + m - start) % m
        } else {
            (start + m - last) % m
        },
    );
    while low < high {
        let middle = (low + high) / 2;
        if inside(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(edge(low))
}
