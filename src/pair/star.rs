//! The star of a feature: the edges around a vertex, and the two faces adjacent to an edge.
//!
//! The tests here prove that a vertex or an edge of a polyhedron is extreme along a direction.

use nalgebra::Vector3;

use crate::base::num::extremes::Bounded;
use crate::base::num::packed::PackedVec3;
use crate::base::tolerance::{EDGE_BOUND, EDGE_SIGN, FLANK};
use crate::body::polyhedron::fans::{Axis, steepest};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, HalfEdgeId, Plane, VertexId};

/// Returns the sum of absolute coordinates: a norm without a root.
#[inline]
pub(crate) fn one_norm(v: &Vector3<f64>) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// Returns whether a direction perpendicular to an edge certainly falls into both adjacent faces.
///
/// This proves the edge extreme along the direction.
///
/// The first argument contains the weights of the direction over the planes of the faces
/// ([`Edge::weights`](super::star::EdgeSpan::weights)). The weights are as long as the opposite
/// edge, whose squared length is `squared`.
///
/// From a point of the edge, every point of the body is reached along the edge, then along the
/// inward directions of the two faces by non-negative lengths, because the faces are exactly plane.
/// The signs suffice: nothing is divided by the sine of the angle between the faces.
#[inline(always)]
pub(crate) fn falls_into_both_faces([alpha, beta]: [f64; 2], squared: f64) -> bool {
    let least = FLANK * FLANK * squared;
    // Written so that NaN proves nothing.
    alpha * alpha.abs() > least && beta * beta.abs() > least
}

/// The edge of a vertex fan along which a direction rises least.
pub(crate) struct FanMinimum {
    /// Smallest `n . e` over the fan; plus infinity for an empty fan.
    pub(crate) value: f64,
    /// The half-edge with the smallest value.
    pub(crate) half_edge: HalfEdgeId,
}

impl ConvexPolyhedron {
    /// Finds the edge of the fan of `v` that falls most along `n`.
    #[inline(always)]
    pub(crate) fn fan_minimum(&self, v: VertexId, n: &Vector3<f64>) -> FanMinimum {
        if let Some(m) = self.fans.axis(&self.topology, v) {
            return self.large_fan_minimum(v, m, n);
        }
        let p = self.points[v.index()];
        let mut fan = FanMinimum {
            value: f64::INFINITY,
            half_edge: HalfEdgeId(0),
        };
        self.topology.each_leaving(v, |half_edge, to| {
            let c = n.dot(&(self.points[to.index()] - p));
            if c < fan.value {
                fan = FanMinimum { value: c, half_edge };
            }
        });
        fan
    }

    /// Approximates the minimum of a large fan by a search over the slopes `n . e / m . e`.
    ///
    /// The search does not examine every edge, so the result is clamped to at most zero and never
    /// certifies.
    #[cold]
    #[inline(never)]
    fn large_fan_minimum(&self, v: VertexId, m: &Axis, n: &Vector3<f64>) -> FanMinimum {
        let (t, points) = (&self.topology, &self.points);
        let along = |h: HalfEdgeId| n.dot(&(points[t.half_edge(h).to.index()] - points[v.index()]));
        let half_edge = steepest(t, points, v, m, &-n);
        if along(half_edge) >= 0.0 {
            return FanMinimum { value: 0.0, half_edge };
        }
        let half_edge = self.nearest_edge(v, &-n);
        FanMinimum {
            value: along(half_edge).at_most(0.0),
            half_edge,
        }
    }

    /// Returns whether a fan minimum proves the vertex to be the lowest of the body along `n`:
    /// every edge certainly rises.
    #[inline(always)]
    pub(crate) fn proves_lowest(&self, fan: &FanMinimum, n: &Vector3<f64>) -> bool {
        fan.value > 2.0 * EDGE_SIGN * self.radius * one_norm(n)
    }

    /// Returns the edge along which the walk leaves the vertex.
    ///
    /// This is the edge that falls most, if the fall exceeds the uncertainty `noise` of the
    /// direction.
    #[inline(always)]
    pub(crate) fn descending_edge(&self, v: VertexId, fan: &FanMinimum, noise: f64) -> Option<HalfEdgeId> {
        if fan.value >= 0.0 {
            return None;
        }
        let to = self.topology.half_edge(fan.half_edge).to;
        let e = self.points[to.index()] - self.points[v.index()];
        (fan.value < -noise * one_norm(&e)).then_some(fan.half_edge)
    }

    /// Upper bound of `n . x` over the body from the planes of two faces (or one plane twice), by
    /// linear programming duality. For any non-negative weights and `m = alpha nL + beta nR`,
    ///
    /// `n . x = s m . x + (n - s m) . x <= s (alpha oL + beta oR) + |n - s m| r`  for every
    /// `s >= 0`,
    ///
    /// here with `s = n . n / m . n`, the least rest if `m` is parallel to `n`. The caller passes
    /// `squared = n . n`.
    ///
    /// The rest `n - s m` is evaluated, never assumed small, so the bound holds for any weights. If
    /// `m` cancels (thin bodies), the rounding of `m` and of the sum of the offsets grows with the
    /// weights; the last term covers both.
    #[inline(always)]
    pub(crate) fn edge_bound(
        &self,
        n: PackedVec3,
        left: &Plane,
        right: &Plane,
        [alpha, beta]: [f64; 2],
        squared: f64,
    ) -> f64 {
        let weights = [alpha.at_least(0.0), beta.at_least(0.0)];
        two_planes_bound(n, [left, right], weights, squared, self.radius)
    }
}

/// Returns the bound of [`edge_bound`](ConvexPolyhedron::edge_bound) for weights that are not
/// negative and a body of this radius.
#[inline(always)]
pub(crate) fn two_planes_bound(
    n: PackedVec3,
    [left, right]: [&Plane; 2],
    [alpha, beta]: [f64; 2],
    squared: f64,
    radius: f64,
) -> f64 {
    let m = PackedVec3::new(&left.normal) * alpha + PackedVec3::new(&right.normal) * beta;
    let s = squared / m.dot(n);
    let rest = n - m * s;
    let weights = s * (alpha + beta) * EDGE_BOUND;
    let bound = s * (alpha * left.offset + beta * right.offset) + (rest.one_norm() + weights) * radius;
    // A zero m or a negative s proves nothing; the comparison is false for NaN.
    if s >= 0.0 { bound } else { f64::INFINITY }
}

/// Endpoints of an edge and the planes of the adjacent faces.
#[derive(Clone, Copy)]
pub(crate) struct EdgeSpan<'a> {
    pub(crate) tail: VertexId,
    pub(crate) head: VertexId,
    pub(crate) p: Vector3<f64>,
    pub(crate) q: Vector3<f64>,
    pub(crate) left: &'a Plane,
    pub(crate) right: &'a Plane,
}

impl<'a> EdgeSpan<'a> {
    #[inline(always)]
    pub(crate) fn new(body: &'a ConvexPolyhedron, edge: EdgeId) -> Self {
        let e = body.topology.half_edge(edge.half_edge());
        let twin = body.topology.half_edge(e.twin);
        Self {
            tail: twin.to,
            head: e.to,
            p: body.points[twin.to.index()],
            q: body.points[e.to.index()],
            left: &body.planes[e.face.index()],
            right: &body.planes[twin.face.index()],
        }
    }

    /// Returns the weights `(alpha, beta)` of a normal over the normals of the left and right face:
    /// up to a positive factor, `sign (e x t)` is `alpha nL + beta nR`, with `e` the edge. Neither
    /// weight is negative if the normal lies between the two face normals.
    #[inline(always)]
    pub(crate) fn weights(&self, t: PackedVec3, sign: f64) -> [f64; 2] {
        let along = |plane: &Plane| t.dot(PackedVec3::new(&plane.normal));
        [-sign * along(self.right), sign * along(self.left)]
    }
}
