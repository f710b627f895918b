//! Tests on the star of a feature: the fan of a vertex, the two faces of an edge.

use nalgebra::Vector3;

use crate::num::packed::PackedVec3;
use crate::polyhedron::axis::Axis;
use crate::polyhedron::fans::steepest;
use crate::polyhedron::{ConvexPolyhedron, Plane};
use crate::tolerance::{EDGE_BOUND, EDGE_SIGN, FLANK};

/// The sum of absolute coordinates: a norm without a root.
#[inline]
pub(crate) fn one_norm(v: &Vector3<f64>) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// Whether a direction across an edge certainly falls into both faces beside it: then the edge is extreme along it. Known by the
/// weights of the direction over the planes of the faces ([`Edge::weights`](super::edge_edge::Edge::weights)), which are as long
/// as the other edge; here that, squared.
///
/// From a point of the edge every point of the body is reached along the edge, then along the inward directions of the two faces by
/// ways that are not negative, for the faces are exactly plane. Signs are enough: nothing divides by the sine between the faces.
#[inline(always)]
pub(crate) fn is_flanked((alpha, beta): (f64, f64), squared: f64) -> bool {
    let least = FLANK * FLANK * squared;
    // Written so that NaN proves nothing.
    alpha * alpha.abs() > least && beta * beta.abs() > least
}

/// The edge of a vertex's fan along which a direction rises least.
pub(crate) struct Fan {
    /// The smallest `n . e` over the fan, plus infinity for an empty fan.
    pub(crate) least: f64,
    /// Its half-edge.
    pub(crate) half_edge: u32,
}

impl ConvexPolyhedron {
    /// Scans the fan of `v` for the edge that falls most along `n`.
    #[inline(always)]
    pub(crate) fn fan_minimum(&self, v: u32, n: &Vector3<f64>) -> Fan {
        if let Some(m) = self.fans.axis(&self.topology, v) {
            return self.large_fan_minimum(v, m, n);
        }
        let p = self.points[v as usize];
        let mut fan = Fan {
            least: f64::INFINITY,
            half_edge: 0,
        };
        self.topology.each_leaving(v, |half_edge, to| {
            let c = n.dot(&(self.points[to as usize] - p));
            if c < fan.least {
                fan = Fan { least: c, half_edge };
            }
        });
        fan
    }

    /// Searches a large fan for the edge that falls most for its rise along `m`. The search proves nothing, so the least is at most zero.
    #[cold]
    #[inline(never)]
    fn large_fan_minimum(&self, v: u32, m: &Axis, n: &Vector3<f64>) -> Fan {
        let (t, points) = (&self.topology, &self.points);
        let along = |h: u32| n.dot(&(points[t.half_edge(h).to as usize] - points[v as usize]));
        let half_edge = steepest(t, points, v, m, &-n);
        if along(half_edge) >= 0.0 {
            return Fan { least: 0.0, half_edge };
        }
        let half_edge = self.nearest_rib(v, &-n);
        Fan {
            least: along(half_edge).min(0.0),
            half_edge,
        }
    }

    /// Whether a fan minimum proves its vertex the lowest of the body along `n`: every edge certainly rises.
    #[inline(always)]
    pub(crate) fn proves_lowest(&self, fan: &Fan, n: &Vector3<f64>) -> bool {
        fan.least > 2.0 * EDGE_SIGN * self.radius * one_norm(n)
    }

    /// The edge to leave the vertex by: the one that falls most, where it falls by more than the direction's own
    /// uncertainty `noise` explains.
    #[inline(always)]
    pub(crate) fn descent(&self, v: u32, fan: &Fan, noise: f64) -> Option<u32> {
        if fan.least >= 0.0 {
            return None;
        }
        let to = self.topology.half_edge(fan.half_edge).to;
        let e = self.points[to as usize] - self.points[v as usize];
        (fan.least < -noise * one_norm(&e)).then_some(fan.half_edge)
    }

    /// A bound of the largest `n . x` over the body from the planes of two faces (or one twice), by linear programming
    /// duality: for any weights that are not negative and `m = alpha nL + beta nR`,
    ///
    /// `n . x = s m . x + (n - s m) . x <= s (alpha oL + beta oR) + |n - s m| r`  for every `s >= 0`,
    ///
    /// here `s = n . n / m . n`, the least rest where `m` is parallel to `n`; the caller has `squared = n . n` at hand.
    ///
    /// The rest `n - s m` is evaluated, never assumed small, so the bound holds whatever the weights. Where `m` cancels
    /// (thin bodies), its rounding and that of the offsets' sum grow with the weights; the last term covers both.
    #[inline(always)]
    pub(crate) fn edge_bound(
        &self,
        n: PackedVec3,
        left: &Plane,
        right: &Plane,
        (alpha, beta): (f64, f64),
        squared: f64,
    ) -> f64 {
        let (alpha, beta) = (alpha.max(0.0), beta.max(0.0));
        let m = PackedVec3::new(&left.normal) * alpha + PackedVec3::new(&right.normal) * beta;
        let s = squared / m.dot(n);
        let rest = n - m * s;
        let weights = s * (alpha + beta) * EDGE_BOUND;
        let bound = s * (alpha * left.offset + beta * right.offset) + (rest.one_norm() + weights) * self.radius;
        // A zero m or a negative s proves nothing; the comparison is false for NaN.
        if s >= 0.0 { bound } else { f64::INFINITY }
    }
}
