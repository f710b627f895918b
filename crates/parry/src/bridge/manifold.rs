//! Contacts as a function of the relative pose and of the contacts that the engine kept.

use lin_canny::nalgebra::{Point3, UnitQuaternion};
use lin_canny::{ContactState, Feature, FeaturePair, Manifold, ManifoldOptions, Outcome, RelativePose, Tracker};

use super::contact::{ContactOptions, exchange};
use super::number::{isometry, narrow};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::{FeatureId, PackedFeatureId};
use super::part::Part;

/// A pair of rounded polyhedra at a pose.
pub(super) struct PosedPair<'a> {
    a: &'a Part<'a>,
    b: &'a Part<'a>,
    pose: RelativePose,
    turn: UnitQuaternion<f64>,
}

impl<'a> PosedPair<'a> {
    /// Returns `None` for a pose that is not finite.
    pub(super) fn new((a, b): &'a (Part<'a>, Part<'a>), pos12: &Pose) -> Option<Self> {
        let isometry = isometry(pos12);
        let pose = RelativePose::from_isometry(&isometry).ok()?;
        let turn = isometry.rotation;
        Some(Self { a, b, pose, turn })
    }

    /// Writes the contacts within the prediction, or the closest points as one contact beyond it.
    ///
    /// The next query starts from the features of this contact. Pairs that are [far](is_far) have
    /// none.
    pub(super) fn write<M, C: Default + Copy>(
        &self,
        prediction: Real,
        options: &ContactOptions,
        out: &mut ContactManifold<M, C>,
    ) {
        let outcome = self.closest(&out.points);
        let radii = self.a.radius + self.b.radius;
        let prediction = f64::from(prediction) * f64::from(options.prediction_factor) + radii;
        (out.local_n1, out.local_n2) = self.normals(&outcome);
        exchange(out, |points| {
            if outcome.lower <= prediction {
                let mut chosen = ManifoldOptions::default().prediction(prediction);
                (chosen.max_face_sine, chosen.max_points) = (f64::from(options.max_face_sine), options.max_points);
                let manifold = Manifold::from_outcome(self.a.body(), self.b.body(), &self.pose, &outcome, &chosen);
                for p in manifold.points() {
                    let contact = self.contact(&outcome, &p.point_on_a, &p.point_on_b, p.separation, p.features);
                    points.push(contact);
                }
            }
            if points.is_empty() {
                let (on_a, on_b) = (&outcome.point_on_a, &outcome.point_on_b);
                points.push(self.contact(&outcome, on_a, on_b, outcome.distance, outcome.features));
            }
        });
    }

    /// Returns the closest points of the cores. The query starts from the features of the deepest
    /// contact and from whether the cores overlapped.
    fn closest<C>(&self, points: &[TrackedContact<C>]) -> Outcome {
        let (a, b) = (self.a.body(), self.b.body());
        let deepest = points.iter().min_by(|p, q| p.dist.total_cmp(&q.dist));
        let feature = |body: &lin_canny::ConvexPolyhedron, id: PackedFeatureId| match id.unpack() {
            FeatureId::Vertex(k) => body.feature(0, k as usize),
            FeatureId::Edge(k) => body.feature(1, k as usize),
            FeatureId::Face(k) => body.feature(2, k as usize),
            FeatureId::Unknown => None,
        };
        let start = deepest.and_then(|p| {
            let (a, b) = (feature(a, p.fid1)?, feature(b, p.fid2)?);
            // Contacts belong to the rounded shapes, features to the cores.
            let is_overlap = f64::from(p.dist) + self.a.radius + self.b.radius < 0.0;
            let state = if is_overlap {
                ContactState::Overlapping
            } else {
                ContactState::Separated
            };
            Some((FeaturePair { a, b }, state))
        });
        let mut tracker = start.map_or_else(Tracker::new, |(pair, state)| Tracker::with_previous(pair, state, a, b));
        tracker.closest(a, b, &self.pose)
    }

    /// Returns a contact of the rounded shapes from a contact of their cores.
    fn contact<C: Default + Copy>(
        &self,
        outcome: &Outcome,
        on_a: &Point3<f64>,
        on_b: &Point3<f64>,
        separation: f64,
        features: FeaturePair,
    ) -> TrackedContact<C> {
        let n = outcome.normal.into_inner();
        let on_a = on_a.coords + n * self.a.radius;
        let on_b = on_b.coords - self.turn.inverse_transform_vector(&n) * self.b.radius;
        let apart = (separation - self.a.radius) - self.b.radius;
        let (id_a, id_b) = (packed(features.a), packed(features.b));
        TrackedContact::new(narrow(&on_a), narrow(&on_b), id_a, id_b, apart as Real)
    }

    /// Returns the outward normals of both shapes, each in the frame of its shape.
    fn normals(&self, outcome: &Outcome) -> (Vector, Vector) {
        let n = outcome.normal.into_inner();
        (narrow(&n), narrow(&-self.turn.inverse_transform_vector(&n)))
    }
}

pub(super) fn packed(feature: Feature) -> PackedFeatureId {
    let k = feature.index() as u32;
    match feature {
        // Ids of parry have 30 bits; a lost start only costs time.
        _ if k >= 1 << 30 => PackedFeatureId::UNKNOWN,
        Feature::Vertex(_) => PackedFeatureId::vertex(k),
        Feature::Edge(_) => PackedFeatureId::edge(k),
        Feature::Face(_) => PackedFeatureId::face(k),
    }
}
