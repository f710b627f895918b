//! Queries on the boundary of a face: where a point is relative to the side planes, and by which
//! edge a line exits.
//!
//! Small boundaries are scanned edge by edge. Large boundaries (see
//! [`Topology::ring`](crate::polyhedron::topology::Topology)) use bisection for both queries. So a
//! face of 8192 edges costs only a few times as much as a face of 32.

use nalgebra::Vector3;

use crate::base::num::packed::PackedVec3;
use crate::base::tolerance::{DIFFERENCE, FOOT};
use crate::body::polyhedron::fans::top_of_ring;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, HalfEdgeId};
use crate::pair::star::one_norm;

/// Location of a point relative to the side planes of a face.
pub(crate) enum FaceLocation {
    /// Inside all side planes, by more than rounding.
    Inside,
    /// Within rounding error of the side plane of this edge.
    Grazes(EdgeId),
    /// Outside the side plane of this edge, by more than rounding.
    Outside(EdgeId),
}

/// A face of a body, with the normal of the plane.
pub(crate) struct Face<'a> {
    pub(crate) body: &'a ConvexPolyhedron,
    pub(crate) face: FaceId,
    pub(crate) normal: &'a Vector3<f64>,
}

/// Position of a point relative to one edge of the boundary.
struct EdgeSide {
    /// Squared distance from the side plane, with the sign of the distance: negative outside.
    signed: f64,
    location: FaceLocation,
}

impl Face<'_> {
    /// Locates `x`, with rounding relative to the pair's `size`.
    ///
    /// Also returns a vertex of the boundary.
    #[inline(always)]
    pub(crate) fn locate(&self, x: &Vector3<f64>, size: f64) -> (FaceLocation, Vector3<f64>) {
        match self.body.topology.ring(self.face) {
            None => self.locate_small(x, size),
            Some(ring) => (self.locate_large(ring, x, size), self.tail(ring[0])),
        }
    }

    /// Locates `x` by a scan.
    ///
    /// Returns the edge farthest outside, or the closest edge that `x` grazes.
    #[inline(always)]
    fn locate_small(&self, x: &Vector3<f64>, size: f64) -> (FaceLocation, Vector3<f64>) {
        let body = self.body;
        // No edge is longer than the diameter, and the 1-norm is less than twice the length.
        let close = 4.0 * FOOT * size * body.radius;
        let start = body.topology.rim_half_edge(self.face);
        let mut from = self.tail(start);
        let (mut location, mut furthest) = (FaceLocation::Inside, f64::INFINITY);
        let mut h = start;
        loop {
            let e = body.topology.half_edge(h);
            let to = body.points[e.to.index()];
            let u = to - from;
            let side = self.normal.cross(&u).dot(&(x - to));
            if side < close {
                let edge_side = classify(EdgeId::of(h, e.twin), side, &u, size);
                if edge_side.signed < furthest && !matches!(edge_side.location, FaceLocation::Inside) {
                    (location, furthest) = (edge_side.location, edge_side.signed);
                }
            }
            (from, h) = (to, e.next);
            if h == start {
                return (location, from);
            }
        }
    }

    /// Locates `x` on a large boundary by bisection over the wedges at the first vertex.
    ///
    /// ```text
    ///   high *-------* low     root       first vertex of the boundary
    ///         \     /          low, high  neighbours of x in angle, narrowed by bisection
    ///          \ x /
    ///           \ /            x on the near side of the chord low-high is inside the face
    ///            * root
    /// ```
    ///
    /// The bisection narrows the wedge that contains `x` until `x` lies on the near side of the
    /// chord between the two outer vertices. The three vertices then prove `x` inside the face,
    /// except for the edges adjacent to them. These edges are tested.
    #[inline(never)]
    pub(crate) fn locate_large(&self, ring: &[HalfEdgeId], x: &Vector3<f64>, size: f64) -> FaceLocation {
        let m = ring.len();
        let root = self.tail(ring[0]);
        let left_of = |k: usize| self.normal.cross(&(self.tail(ring[k]) - root)).dot(&(x - root)) >= 0.0;
        // x is left of the ray to vertex `low` and right of the ray to `high`, or beyond one of the
        // two edges at the root.
        let (mut low, mut high) = (1, m - 1);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if left_of(middle) {
                low = middle;
            } else {
                high = middle;
            }
            let (p, q) = (self.tail(ring[low]), self.tail(ring[high]));
            if high - low < m / 2 && self.normal.cross(&(q - p)).dot(&(x - p)) > 0.0 {
                break;
            }
        }
        let near = [0, m - 1, low - 1, low, high - 1, high];
        let (mut location, mut furthest, mut at) = (FaceLocation::Inside, f64::INFINITY, 0);
        for k in near {
            let edge_side = self.edge_side(ring[k], x, size);
            if edge_side.signed < furthest && !matches!(edge_side.location, FaceLocation::Inside) {
                (location, furthest, at) = (edge_side.location, edge_side.signed, k);
            }
        }
        if let FaceLocation::Outside(_) = location {
            FaceLocation::Outside(self.edge(ring[self.nearest_visible(ring, at, x)]))
        } else {
            location
        }
    }

    /// Finds the edge closest to `x` by a gallop from the edge `at` along the edges visible from
    /// `x`.
    ///
    /// `x` is outside the side planes of the visible edges. Along them the distance falls up to the
    /// closest edge and rises after it.
    fn nearest_visible(&self, ring: &[HalfEdgeId], at: usize, x: &Vector3<f64>) -> usize {
        let m = ring.len();
        let ends = |k: usize| (self.tail(ring[k % m]), self.head(ring[k % m]));
        let is_visible = |k: usize| {
            let (p, q) = ends(k);
            self.normal.cross(&(q - p)).dot(&(x - p)) < 0.0
        };
        let closer_ahead = |k: usize| {
            let (p, q) = ends(at + k);
            is_visible(at + k) && (x - q).dot(&(q - p)) > 0.0
        };
        let closer_behind = |k: usize| {
            let (p, q) = ends(at + m - k);
            is_visible(at + m - k) && (x - p).dot(&(q - p)) < 0.0
        };
        let forward = gallop(m, closer_ahead);
        if forward > 0 {
            (at + forward) % m
        } else {
            (at + m - gallop(m, closer_behind)) % m
        }
    }

    /// Returns where a line that starts over the face exits: the fraction of `displacement`, and
    /// the edge.
    ///
    /// `None` if the line does not exit between `start` and `start + displacement`. The line may
    /// enter over the edge `entry` and never exits there.
    #[inline(always)]
    pub(crate) fn exit(
        &self,
        start: PackedVec3,
        displacement: PackedVec3,
        entry: Option<EdgeId>,
    ) -> Option<(f64, EdgeId)> {
        match self.body.topology.ring(self.face) {
            None => self.exit_small(start, displacement, entry),
            Some(ring) => self.exit_large(ring, &start.vector(), &displacement.vector(), entry),
        }
    }

    /// Finds the exit by a scan.
    #[inline(always)]
    fn exit_small(&self, start: PackedVec3, displacement: PackedVec3, entry: Option<EdgeId>) -> Option<(f64, EdgeId)> {
        let (body, normal) = (self.body, PackedVec3::new(self.normal));
        let begin = body.topology.rim_half_edge(self.face);
        let (mut h, mut p) = (begin, PackedVec3::new(&self.tail(begin)));
        let mut first = None;
        loop {
            let e = body.topology.half_edge(h);
            let q = PackedVec3::new(&body.points[e.to.index()]);
            let (edge, inward) = (EdgeId::of(h, e.twin), normal.cross(q - p));
            let speed = inward.dot(displacement);
            if speed < 0.0 && entry != Some(edge) {
                let when = -inward.dot(start - p) / speed;
                if when < first.map_or(1.0, |(w, _)| w) {
                    first = Some((when, edge));
                }
            }
            (p, h) = (q, e.next);
            if h == begin {
                return first;
            }
        }
    }

    /// Finds the exit by bisection.
    ///
    /// Most lines are short compared with a large face, so the end of the line is located first.
    #[inline(never)]
    fn exit_large(
        &self,
        ring: &[HalfEdgeId],
        start: &Vector3<f64>,
        displacement: &Vector3<f64>,
        entry: Option<EdgeId>,
    ) -> Option<(f64, EdgeId)> {
        if matches!(
            self.locate_large(ring, &(start + displacement), 0.0),
            FaceLocation::Inside
        ) {
            return None;
        }
        let mut first = None;
        let mut try_edge = |h: HalfEdgeId| {
            let edge = self.edge(h);
            let (p, q) = (self.tail(h), self.head(h));
            let inward = self.normal.cross(&(q - p));
            let speed = inward.dot(displacement);
            if speed < 0.0 && entry != Some(edge) {
                let when = -inward.dot(&(start - p)) / speed;
                if when < first.map_or(1.0, |(w, _)| w) {
                    first = Some((when, edge));
                }
            }
        };
        let k = self.exit_edge(ring, start, displacement);
        let m = ring.len();
        [(k + m - 1) % m, k, (k + 1) % m]
            .into_iter()
            .for_each(|k| try_edge(ring[k]));
        first
    }

    /// Returns the index of the edge by which the line from `start` along `displacement` exits a
    /// large boundary.
    ///
    /// This edge leads from the vertices right of the line to the vertices left of the line.
    #[inline(never)]
    fn exit_edge(&self, ring: &[HalfEdgeId], start: &Vector3<f64>, displacement: &Vector3<f64>) -> usize {
        let m = ring.len();
        let left = self.normal.cross(displacement);
        let height = |k: usize| left.dot(&(self.tail(ring[k % m]) - start));
        // Counter-clockwise from the rightmost vertex to the leftmost, the sign changes once.
        let (low, high) = (top_of_ring(m, |k| -height(k)), top_of_ring(m, height));
        let span = (high + m - low) % m;
        let (mut right, mut over) = (0, span.max(1));
        while over - right > 1 {
            let middle = (right + over) / 2;
            if height(low + middle) < 0.0 {
                right = middle;
            } else {
                over = middle;
            }
        }
        (low + right) % m
    }

    fn edge_side(&self, h: HalfEdgeId, x: &Vector3<f64>, size: f64) -> EdgeSide {
        let (p, q) = (self.tail(h), self.head(h));
        let side = self.normal.cross(&(q - p)).dot(&(x - q));
        classify(self.edge(h), side, &(q - p), size)
    }

    fn edge(&self, h: HalfEdgeId) -> EdgeId {
        self.body.topology.edge(h)
    }

    #[inline(always)]
    fn tail(&self, h: HalfEdgeId) -> Vector3<f64> {
        self.body.points[self.body.topology.from(h).index()]
    }

    #[inline(always)]
    fn head(&self, h: HalfEdgeId) -> Vector3<f64> {
        self.body.points[self.body.topology.half_edge(h).to.index()]
    }
}

/// Classifies a point by the product `side` with the unnormalised inward direction of an edge `u`.
#[inline(always)]
fn classify(edge: EdgeId, side: f64, u: &Vector3<f64>, size: f64) -> EdgeSide {
    let length = one_norm(u);
    let location = if side < -DIFFERENCE * size * length {
        FaceLocation::Outside(edge)
    } else if side < FOOT * size * length {
        FaceLocation::Grazes(edge)
    } else {
        FaceLocation::Inside
    };
    EdgeSide {
        signed: side * side.abs() / u.norm_squared(),
        location,
    }
}

/// Returns for how many steps in a row, from the first, a condition holds.
///
/// The condition must be true for a run of steps and false ever after.
fn gallop(most: usize, holds: impl Fn(usize) -> bool) -> usize {
    let mut reach = 1;
    while reach < most && holds(reach - 1) {
        reach *= 2;
    }
    // True below `low` and false at `high`, or the boundary ends there.
    let (mut low, mut high) = (reach / 2, reach.min(most) - 1);
    while low < high {
        let middle = (low + high) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gallop_counts_the_run() {
        for most in 1..40 {
            for run in 0..most {
                assert_eq!(gallop(most, |k| k < run), run, "{run} of {most}");
            }
        }
    }
}
