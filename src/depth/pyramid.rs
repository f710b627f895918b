//! A proof of the depth by one facet: the pyramid of the facet and a point deep in P = A - B holds
//! the ball.
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
//! The pyramid lies in P. If the origin lies in the pyramid, and every side is at least as far from
//! the origin as F, then P contains the ball of radius `r` about the origin, and the depth is `r`:
//! F lies in a supporting plane. Shallow overlaps are proven like this; of all others nothing is
//! said. If the foot of the origin is near an edge of F, the side there is too near, and a support
//! point of P beyond the side replaces the side by three triangles.
//!
//! The sides are judged as the triangles of a surface are
//! ([`verify_surface`](super::verify_surface)).

use nalgebra::Vector3;

use crate::depth::direction::unit;
use crate::depth::result::Best;
use crate::depth::verify_surface::Target;
use crate::num::scalar::{Vec3, cross, dot, neg, sub};
use crate::pair::edge::EdgeSpan;
use crate::pair::posed::PosedPair;
use crate::polyhedron::{ConvexPolyhedron, FaceId, Feature, FeaturePair, HalfEdgeId};
use crate::tolerance::{AGREE_DEPTH, ALMOST_FLAT};
use crate::tuning::depth::{CORNERS, SUPPORTS};
use crate::tuning::polyhedron::LARGE;

/// Returns whether the pyramid over a facet proves the height of the facet to be the depth.
pub(super) fn proves(posed: &PosedPair, facet: FeaturePair, best: &Best<f64>) -> bool {
    let target = Target::new(best, posed.size());
    if !target.is_deep() {
        return false;
    }
    // The means of the vertices lie in the bodies up to rounding, which the error term of the depth
    // covers like that of a vertex, and off the surface of solid bodies.
    let apex = posed.a.vertex_mean - posed.point_in_a(&posed.b.vertex_mean);
    let mut sides = PyramidSides {
        posed,
        target,
        apex: apex.into(),
        is_reflected: false,
        supports: SUPPORTS,
    };
    let slack = 0.25 * AGREE_DEPTH * posed.size();
    match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let q = posed.point_in_a(&posed.b.points[v.index()]);
            let place = |p: &Vector3<f64>| p - q;
            sides.of_face(posed.a, f, slack, place)
        }
        (Feature::Vertex(v), Feature::Face(f)) => {
            // The reflected facet is turned like the face.
            let p = posed.a.points[v.index()];
            let place = |q: &Vector3<f64>| posed.point_in_a(q) - p;
            sides.reflected().of_face(posed.b, f, slack, place)
        }
        (Feature::Edge(e), Feature::Edge(g)) => {
            let (a, b) = (EdgeSpan::new(posed.a, e), EdgeSpan::new(posed.b, g));
            let (x, y) = (posed.point_in_a(&b.p), posed.point_in_a(&b.q));
            let n = Vector3::from(best.normal);
            let is_left = n.dot(&(a.q - a.p).cross(&(x - y))) > 0.0;
            let (p, q) = if is_left { (a.p, a.q) } else { (a.q, a.p) };
            let corners = [p - x, q - x, q - y, p - y];
            let low = corners.iter().fold(f64::INFINITY, |low, w| low.min(n.dot(w)));
            low >= best.height - 2.0 * slack && (0..4).all(|k| sides.is_far(&corners[k], &corners[(k + 1) % 4]))
        }
        _ => false,
    }
}

/// The sides of a pyramid.
struct PyramidSides<'a, 'b> {
    posed: &'a PosedPair<'b>,
    target: Target,
    apex: Vec3<f64>,
    /// Whether all points are those of B - A.
    is_reflected: bool,
    /// Support points that may still be added.
    supports: u32,
}

impl PyramidSides<'_, '_> {
    /// Returns the sides of the pyramid reflected in the origin.
    fn reflected(self) -> Self {
        Self {
            target: self.target.reflected(),
            apex: neg(&self.apex),
            is_reflected: true,
            ..self
        }
    }

    /// Returns whether the side over an edge of the facet, which runs counter-clockwise seen from
    /// outside, is beyond the target.
    #[inline(always)]
    fn is_far(&mut self, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
        let side = [(*to).into(), (*from).into(), self.apex];
        match self.target.judge(&side) {
            Some(false) => self.is_far_beyond(&side),
            judged => judged == Some(true),
        }
    }

    /// Returns whether three triangles to the support point along a failed side's normal lie beyond
    /// the target. The origin lies behind them, so the surface still encloses the origin.
    #[cold]
    fn is_far_beyond(&mut self, side: &[Vec3<f64>; 3]) -> bool {
        let Some(left) = self.supports.checked_sub(1) else {
            return false;
        };
        self.supports = left;
        let normal = unit(&cross(&sub(&side[1], &side[0]), &sub(&side[2], &side[0])));
        let tip = self.support(&normal);
        // No point outside: the side is a facet, and nearer than the target.
        dot(&normal, &tip) > dot(&normal, &side[0]) + ALMOST_FLAT * self.posed.size()
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
        let along = if self.is_reflected { neg(normal) } else { *normal };
        let (a, b) = (Vector3::from(along), -self.posed.direction_in_b(&along.into()));
        let (p, q) = (self.posed.a.support_cold(&a), self.posed.b.support_cold(&b));
        let tip = self.posed.a.points[p.index()] - self.posed.point_in_a(&self.posed.b.points[q.index()]);
        if self.is_reflected { (-tip).into() } else { tip.into() }
    }

    /// Returns whether the sides over a face, placed by `place`, are beyond the target, and the
    /// corners in the plane of the face up to `slack`. Few corners stand for the face if they do,
    /// and a sample for a large face.
    #[inline(always)]
    fn of_face(
        &mut self,
        body: &ConvexPolyhedron,
        face: FaceId,
        slack: f64,
        place: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    ) -> bool {
        let t = &body.topology;
        let count = t.ring(face).map_or_else(|| t.rim(face).count(), <[_]>::len);
        let (coarse, fine) = (count.div_ceil(CORNERS), count.div_ceil(LARGE));
        if coarse > fine {
            let supports = core::mem::take(&mut self.supports);
            if self.of_sample(body, face, coarse, slack, &place) {
                return true;
            }
            self.supports = supports;
        }
        self.of_sample(body, face, fine, slack, &place)
    }

    /// As [`of_face`](Self::of_face), over every `step`-th corner.
    #[inline]
    fn of_sample(
        &mut self,
        body: &ConvexPolyhedron,
        face: FaceId,
        step: usize,
        slack: f64,
        place: &impl Fn(&Vector3<f64>) -> Vector3<f64>,
    ) -> bool {
        let (t, plane) = (&body.topology, &body.planes[face.index()]);
        let corner = |h: HalfEdgeId| body.points[t.from(h).index()];
        let (mut first, mut from) = (None, Vector3::zeros());
        let mut is_far = |h: HalfEdgeId| {
            let at = corner(h);
            let to = place(&at);
            let is_first = first.is_none();
            let is_far = is_first || self.is_far(&from, &to);
            from = to;
            first.get_or_insert(to);
            is_far && plane.normal.dot(&at) >= plane.offset - slack
        };
        let all_far = match t.ring(face) {
            Some(ring) => ring.iter().step_by(step).all(|&h| is_far(h)),
            None => t.rim(face).step_by(step).all(is_far),
        };
        all_far && first.is_some_and(|to| self.is_far(&from, &to))
    }
}
