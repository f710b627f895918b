//! Keeps the contacts of the previous manifold by measuring them again, without clipping the faces.
//!
//! A vertex of a face stays over the opposite face as long as the bodies move less than the
//! distance of the vertex from the boundary. Two edges that crossed are tested again. So the cost
//! of keeping a manifold of two faces does not depend on their numbers of vertices.

use nalgebra::Vector3;

use super::clip::{self, LocalPoint, Location};
use super::projection::{Axes, FacePlane2, LazyProjection};
use super::{ContactPoint, Contacts, Manifold, ManifoldOptions, PosedOutcome};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::{AGREE, STAY};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, Feature, FeaturePair};

/// Lower bound of a vertex's distance to the boundary of the opposite face, for every normal within
/// the promotion angle; `inside` is the distance seen along the current normal. Returns 0 if the
/// angle is too large or the vertex is outside (0, not -inf, so that the value can be serialized).
pub(super) fn margin(inside: f64, separation: f64, options: &ManifoldOptions) -> f64 {
    let sine = STAY * options.max_face_sine.abs();
    // Up to a sine of 1/2, the tangent is below twice the sine, and the cosine above one less the
    // sine.
    if sine <= 0.5 {
        ((1.0 - sine) * inside - tilt_offset(separation, options)).at_least(0.0)
    } else {
        0.0
    }
}

/// Returns the largest shift of a projected vertex caused by the angle between normal and face
/// normal.
fn tilt_offset(separation: f64, options: &ManifoldOptions) -> f64 {
    2.0 * STAY * options.max_face_sine.abs() * separation.abs()
}

/// Projections of the features that carry a contact.
pub(super) struct Projections<'a> {
    pub(super) a: LazyProjection<'a>,
    pub(super) b: LazyProjection<'a>,
}

/// A contact by stored points, plane coordinates, and heights along the normal.
struct MeasuredContact {
    points: [Vector3<f64>; 2],
    at: [f64; 2],
    heights: [f64; 2],
}

impl Projections<'_> {
    /// Measures all contacts of the previous manifold again. Returns false unless all are still
    /// contacts and the deepest is one of them. `moved` bounds the motion of the bodies since the
    /// candidates were chosen, in the caller's unit.
    #[inline(always)]
    pub(super) fn keep(
        &mut self,
        posed: &PosedOutcome,
        options: &ManifoldOptions,
        before: &Manifold,
        moved: f64,
        contacts: &mut Contacts,
    ) -> bool {
        let (Feature::Face(f), Feature::Face(g)) = (self.a.feature, self.b.feature) else {
            return false;
        };
        let planes = [
            FacePlane2::new(self.a.body, f, self.a.axes),
            FacePlane2::new(self.b.body, g, self.b.axes),
        ];
        let (unit, distance) = (posed.a.unit(), posed.outcome.distance);
        let (old, on, margins) = (before.points(), before.on(), before.margins());
        let mut least = f64::INFINITY;
        for k in 0..old.len() {
            let features = old[k].features;
            let Some(m) = self.measure(&planes, features, on[k]) else {
                return false;
            };
            let separation = distance + (m.heights[1] - m.heights[0]) * unit;
            // NaN is tested.
            let mut margin = margins[k];
            if on[k][0].as_edge().is_none() && !(margin - tilt_offset(separation, options) > moved) {
                let other = if on[k][0].as_vertex().is_some() {
                    self.b.get()
                } else {
                    self.a.get()
                };
                let inside = other.inside_by(m.at);
                if !(inside >= -other.axes.noise) {
                    return false;
                }
                margin = self::margin(inside * unit, separation, options) + moved;
            }
            if !(separation <= options.prediction) {
                return false;
            }
            least = least.smaller(separation);
            contacts.points[k] = ContactPoint {
                point_on_a: posed.a.to_user(&m.points[0]),
                point_on_b: posed.b.to_user(&m.points[1]),
                separation,
                features,
                id: features,
            };
            (contacts.on[k], contacts.margins[k]) = (on[k], margin);
        }
        contacts.same = least <= posed.outcome.upper + AGREE * posed.size;
        if contacts.same {
            contacts.count = old.len();
        }
        contacts.same
    }

    /// Returns a contact measured from its features; `None` if edges no longer cross, and for
    /// witnesses.
    #[inline(always)]
    fn measure(&self, planes: &[FacePlane2; 2], features: FeaturePair, on: [Location; 2]) -> Option<MeasuredContact> {
        let (a, b, ours, theirs) = (self.a.body, self.b.body, self.a.axes, self.b.axes);
        match (features.a, features.b) {
            (Feature::Vertex(v), Feature::Face(_)) if on[0].as_vertex().is_some() => {
                let p = *a.points.get(v.index())?;
                let [x, y, height] = ours.to_local(&p);
                let below = planes[1].height([x, y]);
                Some(MeasuredContact {
                    points: [p, theirs.point([x, y], below)],
                    at: [x, y],
                    heights: [height, below],
                })
            }
            (Feature::Face(_), Feature::Vertex(v)) if on[1].as_vertex().is_some() => {
                let q = *b.points.get(v.index())?;
                let [x, y, height] = theirs.to_local(&q);
                let above = planes[0].height([x, y]);
                Some(MeasuredContact {
                    points: [ours.point([x, y], above), q],
                    at: [x, y],
                    heights: [above, height],
                })
            }
            (Feature::Edge(e), Feature::Edge(g)) if on[0].as_edge().is_some() => {
                let ((p, local_p), (q, local_q)) = (ends(a, e, ours)?, ends(b, g, theirs)?);
                let crossing = clip::crossing(&local_p, &local_q, ours.noise)?;
                let along = |[from, to]: &[Vector3<f64>; 2], t: f64| from + (to - from) * t;
                Some(MeasuredContact {
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
fn ends(body: &ConvexPolyhedron, edge: EdgeId, axes: &Axes) -> Option<([Vector3<f64>; 2], [LocalPoint; 2])> {
    let t = &body.topology;
    if edge.index() >= t.half_edge_count() {
        return None;
    }
    let ends = [t.from(edge.half_edge()), t.half_edge(edge.half_edge()).to].each(|v| body.points[v.index()]);
    Some((ends, ends.each(|p| axes.to_local(&p))))
}
