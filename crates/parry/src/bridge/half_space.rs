//! Contacts of polyhedra with half-spaces.

use lin_canny::{HalfSpace, HalfSpaceContact, ManifoldOptions, RelativePose};

use super::contact::ContactOptions;
use super::known::Known;
use super::number::{isometry, narrow, wide};
use super::parry::math::{Pose, Real};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::{PackedFeatureId, Shape};
use super::part;

/// Writes the contacts within the prediction, or the deepest vertex beyond it.
///
/// Returns false, with nothing written, unless one shape is a half-space and the other a
/// polyhedron, at a finite pose.
pub(super) fn write<M, C: Default + Copy>(
    known: &Known,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    prediction: Real,
    options: &ContactOptions,
    out: &mut ContactManifold<M, C>,
) -> bool {
    let (space, other, is_first) = match (a.as_halfspace(), b.as_halfspace()) {
        (Some(space), None) => (space, b, true),
        (None, Some(space)) => (space, a, false),
        _ => return false,
    };
    let pose = isometry(pos12);
    let pose = if is_first { pose } else { pose.inverse() };
    let (Some(part), Ok(at), Ok(space)) = (
        part::polyhedron(known, other),
        RelativePose::from_isometry(&pose),
        HalfSpace::new(wide(space.normal), 0.0),
    ) else {
        return false;
    };
    let mut chosen = ManifoldOptions::default()
        .prediction(f64::from(prediction) * f64::from(options.prediction_factor) + part.radius);
    (chosen.max_face_sine, chosen.max_points) = (f64::from(options.max_face_sine), options.max_points);
    let contacts = space.contacts(part.body(), &at, &chosen);
    let up = space.normal().into_inner();
    let down = -pose.rotation.inverse_transform_vector(&up);
    let tracked = |c: &HalfSpaceContact| {
        let on_plane = narrow(&c.point_on_plane.coords);
        let on_body = narrow(&(c.point_on_body.coords + down * part.radius));
        let (plane, vertex) = (
            PackedFeatureId::face(0),
            PackedFeatureId::vertex(c.vertex.index() as u32 & 0x3fff_ffff),
        );
        let apart = (c.separation - part.radius) as Real;
        if is_first {
            TrackedContact::new(on_plane, on_body, plane, vertex, apart)
        } else {
            TrackedContact::new(on_body, on_plane, vertex, plane, apart)
        }
    };
    let kept = core::mem::take(&mut out.points);
    out.points.extend(contacts.points().iter().map(tracked));
    if out.points.is_empty() {
        out.points.push(tracked(contacts.lowest()));
    }
    let (of_plane, of_body) = (narrow(&up), narrow(&down));
    (out.local_n1, out.local_n2) = if is_first {
        (of_plane, of_body)
    } else {
        (of_body, of_plane)
    };
    out.match_contacts(&kept);
    true
}
