//! The outcome along the normal of a face, whatever the closest features are.

use nalgebra::{Point3, Unit, Vector3};

use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature, FeaturePair};
use crate::body::shape::{Core, Support, match_core};
use crate::pair::outcome::{Class, Outcome};

/// Returns the gap of the plane of a face of A and a core B along the outward normal of the face,
/// as an outcome: a lower bound of the signed distance, right up to rounding, that says nothing
/// about an upper one. `None` for a face that A does not have.
pub(crate) fn along_face(a: &ConvexPolyhedron, face: FaceId, b: &Core, a_from_b: &RelativePose) -> Option<Outcome> {
    let (normal, offset) = a.face_plane(face)?;
    let rotation = a_from_b.rotation();
    let (feature, lowest) = support(b, &-rotation.tr_mul(&normal))?;
    let place = rotation * lowest + a_from_b.translation();
    let gap = normal.dot(&place) - offset;
    let features = FeaturePair {
        a: Feature::Face(face),
        b: feature,
    };
    Some(Outcome {
        class: if gap > 0.0 {
            Class::Separated
        } else {
            Class::Overlapping
        },
        distance: gap,
        lower: gap,
        upper: gap,
        point_on_a: Point3::from(place - normal.into_inner() * gap),
        point_on_b: Point3::from(lowest),
        normal,
        ..Outcome::starting_at(features)
    })
}

/// Returns the outcome of the bodies in the other order.
pub(crate) fn swapped(outcome: &Outcome, b_from_a: &RelativePose) -> Outcome {
    let normal = -b_from_a.rotation().tr_mul(&outcome.normal);
    Outcome {
        features: outcome.features.swapped(),
        point_on_a: outcome.point_on_b,
        point_on_b: outcome.point_on_a,
        normal: Unit::new_unchecked(normal),
        ..*outcome
    }
}

/// Returns a point of a core that is highest along a unit direction, and its feature.
fn support(core: &Core, n: &Vector3<f64>) -> Option<(Feature, Vector3<f64>)> {
    fn of<S: Support>(core: &S, n: &Vector3<f64>) -> (Feature, Vector3<f64>) {
        let (branch, point) = core.support::<f64>(&[n.x, n.y, n.z], 0);
        let point = Vector3::from(point);
        (core.feature(&[branch], &point), point)
    }
    Some(match_core!(core, body => {
        let v = body.extreme_vertex(n);
        (Feature::Vertex(v), body.vertex(v)?.coords)
    }, core => of(core, n)))
}
