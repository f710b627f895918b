//! Keeps the contacts of the previous manifold by measuring them again, without clipping the faces.
//!
//! A vertex of a face over the opposite face stays over it while the bodies have moved less than
//! the vertex's distance from the boundary; two edges that crossed are tested again. So the cost of
//! keeping a manifold of two faces does not depend on their numbers of vertices.

use nalgebra::Vector3;

use super::axes::{Axes, FacePlane2};
use super::clip::{self, End};
use super::corners::Location;
use super::shadow::LazyProjection;
use super::{Answer, ContactPoint, Contacts, Manifold, ManifoldOptions};
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::tolerance::{AGREE, STAY};

/// Lower bound of a vertex's distance to the boundary of the opposite face, for every normal within
/// the promotion angle; `inside` is the distance seen along the current normal. Returns 0 if the
/// angle is too large or the vertex is outside (0, not -inf, so that the value can be serialized).
pub(super) fn margin(inside: f64, separation: f64, options: &ManifoldOptions) -> f64 {
    let sine = STAY * options.sine.abs();
    // Up to a sine of 1/2, the tangent is below twice the sine, and the cosine above one less the
    // sine.
    if sine <= 0.5 {
        ((1.0 - sine) * inside - lean_off(separation, options)).max(0.0)
    } else {
        0.0
    }
}

/// Returns the largest shift of a projected vertex caused by the angle between normal and face
/// normal.
fn lean_off(separation: f64, options: &ManifoldOptions) -> f64 {
    2.0 * STAY * options.sine.abs() * separation.abs()
}

/// Projections of the features that bear a contact.
pub(super) struct Shadows<'a> {
    pub(super) a: LazyProjection<'a>,
    pub(super) b: LazyProjection<'a>,
}

/// A contact by stored points, plane coordinates, and heights along the normal.
struct Measured {
    points: [Vector3<f64>; 2],
    at: [f64; 2],
    heights: [f64; 2],
}

impl Shadows<'_> {
    /// Measures all contacts of the previous manifold; returns false unless all are still contacts
    /// and the deepest is among them. `moved` bounds the motion of the bodies since the candidates
    /// were chosen, in the caller's unit.
    #[inline(always)]
    pub(super) fn keep(
        &mut self,
        answer: &Answer,
        options: &ManifoldOptions,
        before: &Manifold,
        moved: f64,
        contacts: &mut Contacts,
    ) -> bool {
        let (Feature::Face(f), Feature::Face(g)) = (self.a.feature, self.b.feature) else {
            return false;
        };
        let leans = [
            FacePlane2::new(self.a.body, f.0, self.a.axes),
            FacePlane2::new(self.b.body, g.0, self.b.axes),
        ];
        let (unit, distance) = (answer.a.unit(), answer.outcome.distance);
        let (old, on, margins) = (before.points(), before.on(), before.margins());
        let mut least = f64::INFINITY;
        for k in 0..old.len() {
            let features = old[k].features;
            let Some(m) = self.measure(&leans, features, on[k]) else {
                return false;
            };
            let separation = distance + (m.heights[1] - m.heights[0]) * unit;
            // NaN is tested.
            let mut margin = margins[k];
            if on[k][0].as_edge().is_none() && !(margin - lean_off(separation, options) > moved) {
                let other = if on[k][0].as_corner().is_some() {
                    self.b.seen()
                } else {
                    self.a.seen()
                };
                let inside = other.inside_by(m.at);
                if !(inside >= -answer.noise()) {
                    return false;
                }
                margin = self::margin(inside * unit, separation, options) + moved;
            }
            if !(separation <= options.prediction) {
                return false;
            }
            least = least.min(separation);
            contacts.points[k] = ContactPoint {
                point_on_a: answer.a.to_user(&m.points[0]),
                point_on_b: answer.b.to_user(&m.points[1]),
                separation,
                features,
                id: features,
            };
            (contacts.on[k], contacts.margins[k]) = (on[k], margin);
        }
        contacts.same = least <= answer.outcome.upper + AGREE * answer.size;
        if contacts.same {
            contacts.count = old.len();
        }
        contacts.same
    }

    /// Returns a contact measured from its features; `None` if edges no longer cross, and for
    /// witnesses.
    #[inline(always)]
    fn measure(&self, leans: &[FacePlane2; 2], features: FeaturePair, on: [Location; 2]) -> Option<Measured> {
        let (a, b, ours, theirs) = (self.a.body, self.b.body, self.a.axes, self.b.axes);
        match (features.a, features.b) {
            (Feature::Vertex(v), Feature::Face(_)) if on[0].as_corner().is_some() => {
                let p = *a.points.get(v.index())?;
                let [x, y, height] = ours.see(&p);
                let below = leans[1].height([x, y]);
                Some(Measured {
                    points: [p, theirs.point([x, y], below)],
                    at: [x, y],
                    heights: [height, below],
                })
            }
            (Feature::Face(_), Feature::Vertex(v)) if on[1].as_corner().is_some() => {
                let q = *b.points.get(v.index())?;
                let [x, y, height] = theirs.see(&q);
                let above = leans[0].height([x, y]);
                Some(Measured {
                    points: [ours.point([x, y], above), q],
                    at: [x, y],
                    heights: [above, height],
                })
            }
            (Feature::Edge(e), Feature::Edge(g)) if on[0].as_edge().is_some() => {
                let ((p, seen_p), (q, seen_q)) = (ends(a, e.0, ours)?, ends(b, g.0, theirs)?);
                let crossing = clip::cross(&seen_p, &seen_q).then(|| clip::meet(&seen_p, &seen_q))?;
                let along = |[from, to]: &[Vector3<f64>; 2], t: f64| from + (to - from) * t;
                Some(Measured {
                    points: [along(&p, crossing.along[0]), along(&q, crossing.along[1])],
                    at: crossing.at,
                    heights: crossing.heights,
                })
            }
            _ => None,
        }
    }
}

/// Returns the ends of an edge, as stored and in contact coordinates.
#[inline(always)]
fn ends(body: &ConvexPolyhedron, edge: u32, axes: &Axes) -> Option<([Vector3<f64>; 2], [End; 2])> {
    let t = &body.topology;
    if edge as usize >= t.half_edge_count() {
        return None;
    }
    let ends = [t.from(edge), t.half_edge(edge).to].map(|v| body.points[v as usize]);
    Some((ends, ends.map(|p| axes.see(&p))))
}
