//! Manifolds of cylinders and cones, rounded or not, with every convex shape.
//!
//! Most pairs of an engine are close without touching. For these, the plane along the normal that
//! the engine kept is tested first. The solver starts along that normal.

use lin_canny::nalgebra::{Unit, Vector3};
use lin_canny::{ContactPoint, Manifold, ManifoldOptions, PairTracker, RelativePose};

use super::contact::{ContactOptions, exchange};
use super::far::Planes;
use super::known::Known;
use super::manifold::packed;
use super::number::{isometry, narrow, wide};
use super::parry::math::{Pose, Real};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::Shape;
use super::part::{self, Placed};

/// Depth, divided by the radius of the smaller shape, up to which an overlap may be a local
/// minimum. The least depth is at most as large, so the error of a contact is at most this.
const SHALLOW: f64 = 0.01;

/// Writes the contacts within the prediction, or one beyond it.
///
/// The contact beyond it has the support points along the normal and the distance that a plane
/// proves. Returns false, with nothing written, unless both shapes are convex, one is a cylinder or
/// cone, and the pose is finite.
pub(super) fn write<M, C: Default + Copy>(
    known: &Known,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    prediction: Real,
    options: &ContactOptions,
    out: &mut ContactManifold<M, C>,
) -> bool {
    if !(part::is_curved(a) || part::is_curved(b)) {
        return false;
    }
    let reach = prediction * options.prediction_factor;
    let planes = Planes::new(pos12, (a, b));
    if let Some(planes) = &planes
        && !out.points.is_empty()
        && planes.write_beyond(reach, out)
    {
        return true;
    }
    let turned = isometry(pos12);
    let Some((of_a, of_b)) = part::both(known, a, b).filter(|(x, y)| x.is_convex() && y.is_convex()) else {
        return false;
    };
    let Ok(at) = RelativePose::new(&of_a.at, &(turned * of_b.at)) else {
        return false;
    };
    let mut chosen = ManifoldOptions::default()
        .prediction(f64::from(reach))
        .local_depth(true);
    (chosen.max_face_sine, chosen.max_points) = (f64::from(options.max_face_sine), options.max_points);
    let mut manifold = Manifold::new();
    let mut tracker = match hint(out, &of_a) {
        Some(normal) => PairTracker::with_direction(&normal, &of_a.shape, &of_b.shape),
        None => PairTracker::new(),
    };
    let mut ask = |chosen: &ManifoldOptions, manifold: &mut Manifold| {
        tracker
            .manifold(&of_a.shape, &of_b.shape, &at, chosen, manifold)
            .is_ok()
    };
    if !ask(&chosen, &mut manifold) {
        return false;
    }
    let shallow = SHALLOW * of_a.shape.bounding_ball().1.min(of_b.shape.bounding_ball().1);
    if manifold.lower() < -shallow {
        manifold = Manifold::new();
        if !ask(&chosen.local_depth(false), &mut manifold) {
            return false;
        }
    }
    let normal = of_a.at.rotation * manifold.normal().into_inner();
    out.local_n1 = narrow(&normal);
    out.local_n2 = narrow(&-turned.rotation.inverse_transform_vector(&normal));
    let tracked = |contact: &ContactPoint| {
        TrackedContact::new(
            narrow(&(of_a.at * contact.point_on_a).coords),
            narrow(&(of_b.at * contact.point_on_b).coords),
            packed(contact.id.a),
            packed(contact.id.b),
            contact.separation as Real,
        )
    };
    let (n1, n2) = (out.local_n1, out.local_n2);
    exchange(out, |points| {
        points.extend(manifold.points().iter().map(tracked));
        if points.is_empty() {
            points.extend(planes.map(|planes| planes.contact(n1, n2, manifold.lower() as Real)));
        }
    });
    true
}

/// Returns the normal of the kept contacts, in the frame of the shape of [`lin_canny`].
fn hint<M, C>(kept: &ContactManifold<M, C>, a: &Placed) -> Option<Unit<Vector3<f64>>> {
    kept.points.first()?;
    Unit::try_new(a.at.rotation.inverse_transform_vector(&wide(kept.local_n1)), 0.5)
}
