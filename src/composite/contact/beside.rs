//! Contacts beside a vertex whose foot on the plane of a face is beyond the end of the face.
//!
//! ```text
//!    face \       / other face     A vertex v in a valley is below both faces. Its foot on the
//!          \  |  /                 plane of either lies beyond the bottom of the valley, where
//!           \_|_/                  the face ends: the contact of a face is where an edge at v
//!             v  ` foot            passes over its end.
//! ```

use nalgebra::Vector3;

use super::PatchQuery;
use super::near::PosedPatches;
use super::surface::Borne;
use super::union::Under;
use crate::base::num::extremes::Extremes;
use crate::body::polyhedron::{EdgeId, Feature};
use crate::body::shape::Core;
use crate::convex::contact::ContactPoint;
use crate::pair::outcome::{Class, Outcome};

/// The part of an edge beyond which a contact beside a vertex is looked for: a millionth. Corners
/// in 8,400 poses in valleys have the same contacts with 1e-9, 1e-6 and 1e-3, in 13.3, 12.2 and
/// 10.4 s of a build for tests.
const SHORT_EDGE: f64 = 1.0 / 1_048_576.0;

/// Bisections of the place along an edge at which a body begins to bear a contact: to 1e-9 of the
/// place. Corners in 8,400 poses in valleys have the same contacts, right to 1e-9, with 20, 30, 40
/// and 52, in 4.2, 6.2, 8.7 and 11.8 s of a build for tests.
const EDGE_HALVINGS: usize = 30;

impl PosedPatches<'_> {
    /// Returns the outcome along the normal of a face at the lowest place over the face on an edge
    /// of the other part's deepest vertex, which is not over the face itself.
    ///
    /// A face that ends in a valley bears contacts within the prediction; any other one overlaps,
    /// if it is the nearest to the vertex.
    pub(super) fn beside(&self, is_of_a: bool, outcome: &Outcome, is_nearest: bool) -> Option<Outcome> {
        let (part, feature) = if is_of_a {
            (&self.parts[1].0, outcome.features.b)
        } else {
            (&self.parts[0].0, outcome.features.a)
        };
        let (Core::Polyhedron(body), Feature::Vertex(vertex)) = (part.core(), feature) else {
            return None;
        };
        let level = match self.under(is_of_a, outcome) {
            Under::Body => self.query.options.prediction,
            Under::Unknown if is_nearest => -self.query.doubt,
            Under::Face | Under::Unknown => return None,
        };
        let from = body.vertex(vertex)?;
        let along = |edge| {
            let [v, w] = body.edge_vertices(edge)?;
            let to = body.vertex(if v == vertex { w } else { v })?;
            self.first_borne(is_of_a, outcome, (edge, &(to - from)), level)
        };
        let places = body.vertex_edges(vertex).filter_map(along);
        let places = places.filter(|place| self.is_nearest(is_of_a, place));
        places.min_by(|x, y| x.distance.total_cmp(&y.distance))
    }

    /// Returns what is at the foot of an outcome's vertex on the plane of the face.
    fn under(&self, is_of_a: bool, outcome: &Outcome) -> Under {
        let PatchQuery { a, b, pose, doubt, .. } = self.query;
        let n = (self.parts[0].1 * outcome.normal).into_inner();
        let point = self.point(&self.witness(outcome));
        if is_of_a {
            a.under(self.patches[0], &point.point_on_a, &n, *doubt)
        } else {
            let down = -pose.rotation().tr_mul(&n);
            b.under(self.patches[1], &point.point_on_b, &down, *doubt)
        }
    }

    /// Returns the first place along an edge, from the vertex of an outcome, at which the bodies
    /// fully bear a contact along the outcome's normal that is no farther apart than `level`.
    fn first_borne(
        &self,
        is_of_a: bool,
        outcome: &Outcome,
        (edge, along): (EdgeId, &Vector3<f64>),
        level: f64,
    ) -> Option<Outcome> {
        let n = self.parts[0].1 * outcome.normal;
        let at = |t: f64| self.moved(is_of_a, outcome, edge, along * t);
        let height = |t: f64| self.witness(&at(t)).separation;
        let is_borne = |t: f64| {
            let place = self.witness(&at(t));
            self.is_on_parts(&place) && self.how_borne(&n, &self.point(&place)) == Borne::Fully
        };
        let (first, rise) = (height(0.0), height(1.0) - height(0.0));
        let end = if rise > level - first {
            (level - first) / rise
        } else {
            1.0
        };
        if !(end > 0.0) {
            return None;
        }
        let (mut off, mut on) = (0.0, SHORT_EDGE.smaller(end));
        while !is_borne(on) {
            if on >= end {
                return None;
            }
            (off, on) = (on, end.smaller(2.0 * on));
        }
        for _ in 0..EDGE_HALVINGS {
            let middle = 0.5 * (off + on);
            *(if is_borne(middle) { &mut on } else { &mut off }) = middle;
        }
        Some(at(on))
    }

    /// Returns an outcome along a face whose point on the other part moves along an edge by a step
    /// in the other part's frame.
    fn moved(&self, is_of_a: bool, outcome: &Outcome, edge: EdgeId, step: Vector3<f64>) -> Outcome {
        let (n, rotation, mut moved) = (outcome.normal, self.pose.rotation(), *outcome);
        if is_of_a {
            let in_a = rotation * step;
            let rise = n.dot(&in_a);
            moved.distance += rise;
            moved.point_on_b += step;
            moved.point_on_a += in_a - *n * rise;
            moved.features.b = Feature::Edge(edge);
        } else {
            let rise = n.dot(&step);
            moved.distance -= rise;
            moved.point_on_a += step;
            moved.point_on_b += rotation.tr_mul(&(step - *n * rise));
            moved.features.a = Feature::Edge(edge);
        }
        (moved.lower, moved.upper) = (moved.distance, moved.distance);
        moved.class = if moved.distance > 0.0 {
            Class::Separated
        } else {
            Class::Overlapping
        };
        moved
    }

    /// Returns the closest points of an outcome of the cores as a contact of the parts.
    fn witness(&self, outcome: &Outcome) -> ContactPoint {
        let [on_a, on_b] = [0, 1].map(|k| self.parts[k].0.round());
        ContactPoint {
            point_on_a: outcome.point_on_a + *outcome.normal * on_a,
            point_on_b: outcome.point_on_b - self.pose.rotation().tr_mul(&outcome.normal) * on_b,
            separation: outcome.distance - on_a - on_b,
            features: outcome.features,
            id: outcome.features,
        }
    }
}
