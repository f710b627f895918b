//! A proof of the depth by one facet: the pyramid over the facet, whose apex is a point deep in P =
//! A - B, contains the ball.
//!
//! ```text
//!        n  ^
//!    F -----+---------     facet of P, at height r above the origin
//!     \     | r     '      o  origin
//!      \    o     '        c  a point deep in P: the difference of two points inside the bodies
//!       \       '          The sides of the pyramid join the edges of F to c.
//!        \    '
//!          c
//! ```
//!
//! The pyramid lies in P. Assume that the origin lies in the pyramid and that every side is at
//! least as far from the origin as F. Then P contains the ball of radius `r` around the origin, and
//! the depth is `r`, because F lies in a supporting plane. This proves shallow overlaps and gives
//! no result for the others. If the foot of the origin is near an edge of F, the side there is too
//! near; three triangles to a support point of P beyond that side replace it.
//!
//! The sides are tested like the triangles of a polytope
//! ([`verify_surface`](super::polytope::verify_surface)).

use crate::base::num::each::Each;
use crate::body::polyhedron::fans::LARGE;
use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::{Vec3, cross, dot, neg, sqrt, sub};
use crate::base::tolerance::{AGREE_DEPTH, ALMOST_FLAT, CERTIFICATE, ORIENTATION, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, HalfEdgeId};
use crate::convex::depth::polytope::{Target, unit};
use crate::convex::depth::search::Best;
use crate::pair::difference::DifferenceFacet;
use crate::pair::posed::PosedPair;
use crate::pair::star::EdgeSpan;

/// Number of vertices of a face over which a pyramid is tried first. Measured on a prism of 32
/// vertices that slides on another: 5 vertices are enough, and take two thirds of the time of all
/// 16.
const CORNERS: usize = 5;

/// Largest number of support points that one pyramid may add to its apex.
const SUPPORTS: u32 = 6;

/// A facet joined to a point deep in A - B. For a face of B all points are points of B - A, so that
/// the facet has the orientation of the face.
pub(super) struct Pyramid<'a, 'b> {
    posed: &'a PosedPair<'b>,
    facet: DifferenceFacet,
    apex: PackedVec3,
    normal: PackedVec3,
    height: f64,
}

impl<'a, 'b> Pyramid<'a, 'b> {
    #[inline(always)]
    pub(super) fn new(posed: &'a PosedPair<'b>, facet: DifferenceFacet, best: &Best<f64>) -> Self {
        // Up to rounding, the mean of the vertices lies in its body, and not on the surface of a
        // solid body. The error term of the depth covers this rounding like the rounding of a
        // vertex.
        let (p, q) = (PackedVec3::new(&posed.a.vertex_mean), &posed.b.vertex_mean);
        let apex = p - (posed.rotation.times(PackedVec3::new(q)) + posed.translation);
        let normal = PackedVec3::new(&best.normal.into());
        let is_reflected = matches!(facet, DifferenceFacet::VertexFace(..));
        Self {
            posed,
            facet,
            apex: if is_reflected { -apex } else { apex },
            normal: if is_reflected { -normal } else { normal },
            height: best.height,
        }
    }

    fn is_reflected(&self) -> bool {
        matches!(self.facet, DifferenceFacet::VertexFace(..))
    }

    /// Returns whether `side` is true for every edge of the facet, counter-clockwise seen from
    /// outside, and whether all vertices lie in the plane of the facet up to rounding. Of a face,
    /// only about `most` vertices are used.
    #[inline(always)]
    fn all_sides(&self, most: usize, side: impl FnMut(PackedVec3, PackedVec3) -> bool) -> bool {
        let (a, b) = (self.posed.a, self.posed.b);
        let in_a = |q: &Vector3<f64>| self.posed.rotation.times(PackedVec3::new(q)) + self.posed.translation;
        match self.facet {
            DifferenceFacet::FaceVertex(f, v) => {
                let q = in_a(&b.points[v.index()]);
                self.all_of(rim(a, f, most).map(|p| PackedVec3::new(p) - q), side)
            }
            DifferenceFacet::VertexFace(v, f) => {
                let p = PackedVec3::new(&a.points[v.index()]);
                self.all_of(rim(b, f, most).map(|q| in_a(q) - p), side)
            }
            DifferenceFacet::Edges(e, g) => {
                let (e, g) = (EdgeSpan::new(a, e), EdgeSpan::new(b, g));
                let (p, q, x, y) = (PackedVec3::new(&e.p), PackedVec3::new(&e.q), in_a(&g.p), in_a(&g.q));
                let is_left = self.normal.dot((q - p).cross(x - y)) > 0.0;
                let (p, q) = if is_left { (p, q) } else { (q, p) };
                self.all_of([p - x, q - x, q - y, p - y].into_iter(), side)
            }
        }
    }

    #[inline(always)]
    fn all_of(
        &self,
        mut corners: impl Iterator<Item = PackedVec3>,
        mut side: impl FnMut(PackedVec3, PackedVec3) -> bool,
    ) -> bool {
        let least = self.height - 0.5 * AGREE_DEPTH * self.posed.size();
        let Some(first) = corners.next() else { return false };
        let mut from = first;
        for to in corners {
            // NaN is not in the plane.
            if !(side(from, to) && self.normal.dot(from) >= least) {
                return false;
            }
            from = to;
        }
        side(from, first) && self.normal.dot(from) >= least
    }

    /// Returns the radius of a ball around the origin that the pyramid contains; `None` if the
    /// origin is not certainly inside the pyramid.
    #[inline(always)]
    pub(super) fn radius(&self) -> Option<f64> {
        let size = self.posed.size();
        let noise = ORIENTATION * size;
        // The square of the height of the plane of the nearest side: a quotient, as a comparison of
        // products would be of degree ten and leave f64 (see `tolerance`).
        let mut nearest_squared = f64::INFINITY;
        let is_behind = |from, to| {
            let PyramidSide { n, height, squares } = PyramidSide::new(self.apex, from, to);
            let low = height - noise * squares;
            nearest_squared = nearest_squared.smaller(low * low / n.norm_squared());
            low > 0.0
        };
        if !self.all_sides(LARGE, is_behind) {
            return None;
        }
        let radius = sqrt(nearest_squared).smaller(self.height);
        // Comparisons with NaN are false.
        (radius > 2.0 * CERTIFICATE * UNIT * size).then_some(radius)
    }
}

/// Returns the vertices of a face; for a face with more than `most`, evenly spaced ones.
#[inline(always)]
fn rim(body: &ConvexPolyhedron, face: FaceId, most: usize) -> impl Iterator<Item = &Vector3<f64>> {
    let t = &body.topology;
    let ring = t.ring(face);
    let count = ring.map_or_else(|| t.rim(face).count(), <[_]>::len);
    let step = count.div_ceil(most);
    let of_ring = ring.into_iter().flatten().copied().step_by(step);
    let of_rim = t.rim(face).take(if ring.is_none() { count } else { 0 }).step_by(step);
    of_rim
        .chain(of_ring)
        .map(move |h: HalfEdgeId| &body.points[t.from(h).index()])
}

/// A side of a pyramid.
pub(crate) struct PyramidSide {
    pub(crate) n: PackedVec3,
    /// Depth of the origin behind the side, times the length of `n`.
    pub(crate) height: f64,
    /// The sum of the squares of both edges.
    pub(crate) squares: f64,
}

impl PyramidSide {
    #[inline(always)]
    pub(crate) fn new(apex: PackedVec3, from: PackedVec3, to: PackedVec3) -> Self {
        let (u, v) = (from - to, apex - to);
        let n = u.cross(v);
        Self {
            n,
            height: n.dot(to),
            squares: u.norm_squared() + v.norm_squared(),
        }
    }
}

/// Returns whether the pyramid over a facet proves that the height of the facet is the depth. A few
/// vertices of a face are used if they are enough, and a sample for a large face.
pub(super) fn proves(posed: &PosedPair, facet: DifferenceFacet, best: &Best<f64>) -> bool {
    let target = Target::new(best, posed.size());
    if !target.is_deep() {
        return false;
    }
    let pyramid = Pyramid::new(posed, facet, best);
    let target = if pyramid.is_reflected() {
        target.reflected()
    } else {
        target
    };
    [CORNERS, LARGE].into_iter().any(|most| {
        let mut sides = FarSides {
            pyramid: &pyramid,
            target: &target,
            supports: SUPPORTS,
        };
        pyramid.all_sides(most, |from, to| sides.is_far(from, to))
    })
}

/// The sides of a pyramid, compared with a target.
struct FarSides<'a, 'p, 'b> {
    pyramid: &'a Pyramid<'p, 'b>,
    target: &'a Target,
    /// Support points that may still be added.
    supports: u32,
}

impl FarSides<'_, '_, '_> {
    /// Returns whether the side over an edge of the facet is beyond the target.
    #[inline(always)]
    fn is_far(&mut self, from: PackedVec3, to: PackedVec3) -> bool {
        let side = [to, from, self.pyramid.apex].each(|w| w.vector().into());
        match self.target.judge(&side) {
            Some(false) => self.is_far_beyond(&side),
            judged => judged == Some(true),
        }
    }

    /// Returns whether three triangles to the support point along the normal of a failed side lie
    /// beyond the target. The origin lies behind them, so the surface still encloses the origin.
    #[cold]
    fn is_far_beyond(&mut self, side: &[Vec3<f64>; 3]) -> bool {
        let Some(left) = self.supports.checked_sub(1) else {
            return false;
        };
        self.supports = left;
        let normal = unit(&cross(&sub(&side[1], &side[0]), &sub(&side[2], &side[0])));
        let tip = self.support(&normal);
        // No point outside: the side is a facet, and nearer than the target.
        dot(&normal, &tip) > dot(&normal, &side[0]) + ALMOST_FLAT * self.pyramid.posed.size()
            && (0..3).all(|k| {
                let part = [side[k], side[(k + 1) % 3], tip];
                match self.target.judge(&part) {
                    Some(false) => self.is_far_beyond(&part),
                    judged => judged == Some(true),
                }
            })
    }

    /// Returns the support point along a unit direction.
    fn support(&self, normal: &Vec3<f64>) -> Vec3<f64> {
        let (posed, is_reflected) = (self.pyramid.posed, self.pyramid.is_reflected());
        let along = if is_reflected { neg(normal) } else { *normal };
        let (a, b) = (Vector3::from(along), -posed.direction_in_b(&along.into()));
        let (p, q) = (posed.a.support_cold(&a), posed.b.support_cold(&b));
        let tip = posed.a.points[p.index()] - posed.point_in_a(&posed.b.points[q.index()]);
        if is_reflected { (-tip).into() } else { tip.into() }
    }
}
