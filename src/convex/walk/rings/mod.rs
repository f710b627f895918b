//! Large rings (long face boundaries and large fans of edges at a vertex): the walk jumps along a
//! ring instead of taking one step per edge.
//!
//! [`newton_jump`] moves a walk that has taken too many steps, and [`predict`] chooses the start of
//! the next query. This code runs only for bodies with a face or a fan of more than [`LARGE`]
//! edges.
//!
//! # Prediction
//!
//! On face boundaries and fans of thousands of edges, the closest features of a moving body move by
//! many vertices per query. In a steady motion they move by about as many as in the query before. A
//! start at the predicted features saves the Newton jump (see [`newton_jump`]).
//!
//! # Rings as smooth curves
//!
//! Large rings are treated as smooth curves ([`RingCurve`]): long face boundaries, and the
//! neighbours of a vertex with many edges.
//!
//! ```text
//!         apex                 ring       vertices k = 0, 1, 2, ...: the boundary of a large face,
//!         /|\                             or the link of an apex (the ends of a large fan)
//!        / | \  spokes         spoke k    edge from vertex k to the apex, or along the side of a
//!       /  |  \                           prism to the opposite face
//!   ---0---1---2---  ring      side face  k lies between spoke k and spoke k + 1
//! ```
//!
//! Near a vertex the ring is approximated by the parabola through the vertex and two other
//! vertices. They are so far away that the unevenness of the edges does not matter.

pub(crate) mod newton_jump;

use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::body::polyhedron::fans::{Cycle, Fan, LARGE};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, HalfEdgeId, VertexId};

/// Extrapolates the motion from `before` to `now`, each feature along its ring. A feature that is
/// on no ring, or does not move, stays.
#[cold]
#[inline(never)]
pub(crate) fn predict(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    before: FeaturePair,
    now: FeaturePair,
) -> FeaturePair {
    let next = |body: &ConvexPolyhedron, before: Feature, now: Feature| {
        let moves = body.has_large_rings && before != now && body.has(before);
        moves
            .then(|| body.extrapolate_feature(before, now))
            .flatten()
            .unwrap_or(now)
    };
    FeaturePair {
        a: next(a, before.a, now.a),
        b: next(b, before.b, now.b),
    }
}

impl ConvexPolyhedron {
    /// Extrapolates the motion from `before` to `now` along a ring; `None` if the two features
    /// share none.
    fn extrapolate_feature(&self, before: Feature, now: Feature) -> Option<Feature> {
        let (RingLocation::Ring(old_ring, from) | RingLocation::Spokes(old_ring, from)) = self.ring_location(before)?;
        let location = self.ring_location(now)?;
        let (RingLocation::Ring(ring, to) | RingLocation::Spokes(ring, to)) = location;
        let index = ring.extrapolate(&old_ring, from, to)?;
        Some(match (location, now) {
            (RingLocation::Ring(..), Feature::Vertex(_)) => Feature::Vertex(ring.vertex(index)),
            (RingLocation::Ring(..), _) => Feature::Edge(ring.edge(index)),
            (RingLocation::Spokes(..), Feature::Edge(_)) => Feature::Edge(ring.spoke(index)?),
            (RingLocation::Spokes(..), _) => Feature::Face(ring.side_face(index)),
        })
    }
}

/// Curves are fitted over this fraction (one over the number) of their ring on each side: an arc of
/// about three degrees, smooth over small edges and short.
const SPAN: usize = 256;

/// A large ring of a body, as a curve.
#[derive(Clone, Copy)]
pub(super) struct RingCurve<'a> {
    body: &'a ConvexPolyhedron,
    kind: RingKind<'a>,
}

#[derive(Clone, Copy)]
enum RingKind<'a> {
    /// The half-edges of a long face boundary.
    Boundary(&'a [HalfEdgeId]),
    /// The link of a vertex of many edges.
    Link { apex: VertexId, fan: Fan },
}

/// Location of a feature relative to a ring.
pub(super) enum RingLocation<'a> {
    /// A vertex or an edge of the ring, and the index.
    Ring(RingCurve<'a>, usize),
    /// A spoke, or the side face between two spokes, and the index.
    Spokes(RingCurve<'a>, usize),
}

/// Parabolas through three vertices of a ring and through the far ends of their spokes, in a
/// parameter `x` that is zero at the middle vertex: value, first and second derivative.
pub(super) struct ParabolaFit {
    /// Parabola of the ring.
    pub(super) ring: [Vector3<f64>; 3],
    /// Parabola of the far ends of the spokes.
    pub(super) spoke_ends: [Vector3<f64>; 3],
    /// The parameter `x` of a point `p` of the body is `scale . p - origin`.
    scale: Vector3<f64>,
    origin: f64,
}

impl<'a> RingCurve<'a> {
    /// Returns the link of `apex`, if the fan of `apex` is large.
    fn of_link(body: &'a ConvexPolyhedron, apex: VertexId) -> Option<Self> {
        let fan = body.topology.fan(apex);
        let kind = RingKind::Link { apex, fan };
        (fan.len() > LARGE).then_some(RingCurve { body, kind })
    }

    /// Returns the ring that contains the half-edge `h`, with the index of the tail of `h`: the
    /// boundary of the face on the left, or the link of the vertex opposite to `h` in the triangle
    /// on the left.
    fn of_half_edge(body: &'a ConvexPolyhedron, h: HalfEdgeId) -> Option<(Self, usize)> {
        let t = &body.topology;
        if let Some((ring, k)) = t.long_rim(t.from(h)).filter(|(ring, k)| ring[*k] == h) {
            let kind = RingKind::Boundary(ring);
            return Some((RingCurve { body, kind }, k));
        }
        let next = t.half_edge(t.half_edge(h).next);
        let curve = Self::of_link(body, next.to)?;
        Some((curve, curve.index_of(next.next)))
    }

    /// Returns the index of a half-edge of the fan.
    fn index_of(&self, h: HalfEdgeId) -> usize {
        match self.kind {
            RingKind::Link { fan, .. } => fan.index_of(h),
            RingKind::Boundary(_) => 0,
        }
    }

    /// Returns the number of vertices.
    fn len(&self) -> usize {
        match self.kind {
            RingKind::Boundary(ring) => ring.len(),
            RingKind::Link { fan, .. } => fan.len(),
        }
    }

    /// Returns the vertex at index `k`.
    pub(super) fn vertex(&self, k: usize) -> VertexId {
        let t = &self.body.topology;
        match self.kind {
            RingKind::Boundary(ring) => t.from(ring[k]),
            RingKind::Link { fan, .. } => t.half_edge(fan.at(k)).to,
        }
    }

    /// Returns the vertex closest to the point at `fraction` of the edge from index `k` to the
    /// next.
    pub(super) fn nearest_vertex(&self, k: usize, fraction: f64) -> VertexId {
        self.vertex(if fraction < 0.5 { k } else { (k + 1) % self.len() })
    }

    /// Returns the edge from index `k` to the next.
    pub(super) fn edge(&self, k: usize) -> EdgeId {
        let t = &self.body.topology;
        match self.kind {
            RingKind::Boundary(ring) => t.edge(ring[k]),
            RingKind::Link { fan, .. } => t.edge(t.half_edge(fan.at(k)).next),
        }
    }

    /// Returns the half-edge of spoke `k`. On a face boundary it leads to the far end, and exists
    /// if the vertex has three edges: the edge outside the boundary. On a link it leads from the
    /// apex.
    fn spoke_half_edge(&self, k: usize) -> Option<HalfEdgeId> {
        let t = &self.body.topology;
        match self.kind {
            RingKind::Boundary(ring) => {
                (t.fan(t.from(ring[k])).len() == 3).then(|| t.half_edge(t.half_edge(ring[k]).twin).next)
            }
            RingKind::Link { fan, .. } => Some(fan.at(k)),
        }
    }

    /// Returns the edge of spoke `k`.
    pub(super) fn spoke(&self, k: usize) -> Option<EdgeId> {
        self.spoke_half_edge(k).map(|h| self.body.topology.edge(h))
    }

    /// Returns the vertex at the far end of spoke `k`.
    pub(super) fn spoke_end(&self, k: usize) -> Option<VertexId> {
        match self.kind {
            RingKind::Boundary(_) => self.spoke_half_edge(k).map(|h| self.body.topology.half_edge(h).to),
            RingKind::Link { apex, .. } => Some(apex),
        }
    }

    /// Returns the side face between spoke `k` and the next.
    pub(super) fn side_face(&self, k: usize) -> FaceId {
        let t = &self.body.topology;
        match self.kind {
            RingKind::Boundary(ring) => t.half_edge(t.half_edge(ring[k]).twin).face,
            RingKind::Link { fan, .. } => t.half_edge(fan.at(k)).face,
        }
    }

    /// Returns the position of the vertex at index `k`.
    fn at(&self, k: usize) -> Vector3<f64> {
        self.body.points[self.vertex(k).index()]
    }

    /// Returns the point at `fraction` of the edge from index `k` to the next.
    pub(super) fn point(&self, k: usize, fraction: f64) -> Vector3<f64> {
        self.at(k) * (1.0 - fraction) + self.at((k + 1) % self.len()) * fraction
    }

    /// Returns the number of edges between two indices, in the shorter direction.
    pub(super) fn index_distance(&self, k: usize, j: usize) -> usize {
        let d = k.abs_diff(j);
        d.min(self.len() - d)
    }

    /// Extrapolates the motion along this ring: returns index `to + (to - from)` (mod ring length,
    /// shorter direction). `None` if `from` is on another ring (`ring`) or the step is at most one
    /// vertex.
    pub(super) fn extrapolate(&self, ring: &Self, from: usize, to: usize) -> Option<usize> {
        let is_same_ring = match (self.kind, ring.kind) {
            (RingKind::Boundary(a), RingKind::Boundary(b)) => a.first() == b.first(),
            (RingKind::Link { apex: a, .. }, RingKind::Link { apex: b, .. }) => a == b,
            _ => false,
        };
        let m = self.len();
        (is_same_ring && self.index_distance(from, to) > 1).then(|| (2 * to + m - from) % m)
    }

    /// Fits a parabola around index `k`, and with `spokes` a parabola through the far ends too.
    /// `None` if a spoke is missing, or if the three vertices do not follow each other along a
    /// line.
    pub(super) fn fit(&self, k: usize, spokes: bool) -> Option<ParabolaFit> {
        let m = self.len();
        // An arc of about three degrees: smooth over small edges, and short.
        let w = m.div_ceil(SPAN);
        let indices = [
            if k >= w { k - w } else { k + m - w },
            k,
            if k + w >= m { k + w - m } else { k + w },
        ];
        let [before, p, after] = indices.each(|k| self.at(k));
        let chord = after - before;
        let scale = chord * (1.0 / chord.norm_squared());
        let (x0, x1) = (scale.dot(&(before - p)), scale.dot(&(after - p)));
        if !(x0 < 0.0 && x1 > 0.0) {
            return None;
        }
        let (per_left, per_right) = (1.0 / x0, 1.0 / x1);
        // x1 - x0 is 1.
        let parabola = |a: Vector3<f64>, p: Vector3<f64>, b: Vector3<f64>| {
            let (left, right) = ((a - p) * per_left, (b - p) * per_right);
            [p, left * x1 - right * x0, (right - left) * 2.0]
        };
        let spoke_ends = if spokes {
            let [a, q, b] = indices.each(|k| self.spoke_end(k).map(|v| self.body.points[v.index()]));
            parabola(a?, q?, b?)
        } else {
            [Vector3::zeros(); 3]
        };
        Some(ParabolaFit {
            ring: parabola(before, p, after),
            spoke_ends,
            scale,
            origin: scale.dot(&p),
        })
    }

    /// Locates the parameter `x` of a fit around index `k`: returns the index of the last vertex
    /// before `x`, and the fraction of the edge to the next vertex at which `x` lies.
    pub(super) fn locate(&self, fit: &ParabolaFit, k: usize, x: f64) -> (usize, f64) {
        if x == 0.0 {
            return (k, 0.0);
        }
        let m = self.len();
        let wrapped = |j: usize| if j >= m { j - m } else { j };
        let at = |j: usize| fit.scale.dot(&self.at(wrapped(j))) - fit.origin;
        // Vertices are in order along the fit for less than a quarter of the ring.
        let most = m / 4;
        // The index if vertices are evenly spaced.
        let guess = x * (2 * m.div_ceil(SPAN)) as f64;
        let from = wrapped(wrapped(
            (k + m).wrapping_add_signed(guess.clamped(-(most as f64), most as f64) as isize),
        ));
        let j = if at(from) <= x {
            wrapped(from + last_true(most, |d| at(from + d) <= x))
        } else {
            wrapped(from + m - 1 - last_true(most, |d| at(from + m - d) > x))
        };
        let (before, after) = (at(j), at(j + 1));
        (j, ((x - before) / (after - before)).clamped(0.0, 1.0))
    }
}

/// Returns the largest `d` up to `most` for which a condition holds that is true from zero up to
/// some number: doubling, then bisection. Zero counts as true.
fn last_true(most: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut reach) = (0, 1);
    while reach <= most && holds(reach) {
        (low, reach) = (reach, 2 * reach);
    }
    let mut high = reach.min(most + 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl ConvexPolyhedron {
    /// Returns the location of a feature relative to a large ring, if the feature touches one.
    pub(super) fn ring_location(&self, feature: Feature) -> Option<RingLocation<'_>> {
        match feature {
            Feature::Vertex(v) => self.ring_of_vertex(v),
            Feature::Edge(e) => self.ring_of_edge(e),
            Feature::Face(f) => self.ring_of_face(f),
        }
    }

    /// Returns the ring that contains a vertex.
    fn ring_of_vertex(&self, v: VertexId) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        if t.fan(v).len() > LARGE {
            return None;
        }
        if let Some((ring, k)) = t.long_rim(v) {
            let kind = RingKind::Boundary(ring);
            return Some(RingLocation::Ring(RingCurve { body: self, kind }, k));
        }
        t.fan(v).iter().find_map(|h| {
            let e = t.half_edge(h);
            let curve = RingCurve::of_link(self, e.to)?;
            Some(RingLocation::Ring(curve, curve.index_of(e.twin)))
        })
    }

    /// Returns the ring that contains an edge, or has the edge as a spoke.
    fn ring_of_edge(&self, edge: EdgeId) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        let h = edge.half_edge();
        let e = t.half_edge(h);
        let tail = t.half_edge(e.twin).to;
        // A spoke of a fan.
        for (apex, h) in [(tail, h), (e.to, e.twin)] {
            if let Some(curve) = RingCurve::of_link(self, apex) {
                return Some(RingLocation::Spokes(curve, curve.index_of(h)));
            }
        }
        // An edge of a ring, in either direction.
        if let Some((curve, k)) = RingCurve::of_half_edge(self, h).or_else(|| RingCurve::of_half_edge(self, e.twin)) {
            return Some(RingLocation::Ring(curve, k));
        }
        match self.ring_of_vertex(tail)? {
            RingLocation::Ring(curve, k) if curve.spoke(k) == Some(edge) => Some(RingLocation::Spokes(curve, k)),
            _ => None,
        }
    }

    /// Returns the ring that has the face as a side face.
    fn ring_of_face(&self, face: FaceId) -> Option<RingLocation<'_>> {
        let t = &self.topology;
        if t.ring(face).is_some() {
            return None;
        }
        t.rim(face).find_map(|h| {
            let e = t.half_edge(h);
            if let Some(curve) = RingCurve::of_link(self, e.to) {
                // The half-edge from the apex with this face on the left.
                return Some(RingLocation::Spokes(curve, curve.index_of(e.next)));
            }
            let (ring, k) = t.long_rim(e.to).filter(|(ring, k)| ring[*k] == e.twin)?;
            let kind = RingKind::Boundary(ring);
            Some(RingLocation::Spokes(RingCurve { body: self, kind }, k))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use nalgebra::Point3;

    /// Every vertex of a regular ring has the same parabolas, at the first and last index too.
    #[test]
    fn parabolas_of_a_regular_ring_are_alike() {
        let n = 200;
        let rim = (0..n).map(|k| TAU * f64::from(k) / f64::from(n));
        let rim = rim.map(|t| Point3::new(t.cos(), t.sin(), 0.0));
        let points: alloc::vec::Vec<_> = rim.chain([Point3::new(0.0, 0.0, 1.0)]).collect();
        let body = ConvexPolyhedron::from_points(&points).expect("a cone");
        let apex = body
            .vertices()
            .find(|&v| body.topology.fan(v).len() > LARGE)
            .expect("an apex");
        let ring = RingCurve::of_link(&body, apex).expect("a large fan");
        let lengths = |k: usize| {
            let fit = ring.fit(k, true).expect("a parabola");
            [fit.ring, fit.spoke_ends].map(|parabola| parabola.map(|v| v.norm()))
        };
        let middle = lengths(ring.len() / 2);
        for k in 0..ring.len() {
            let all = lengths(k)
                .into_iter()
                .zip(middle)
                .flat_map(|(x, y)| [0, 1, 2].map(|i| x[i] - y[i]));
            assert!(all.into_iter().all(|off| off.abs() < 1e-12), "{k}: {:?}", lengths(k));
        }
    }
}
