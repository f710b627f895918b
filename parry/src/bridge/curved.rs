//! Manifolds of cylinders and cones, rounded ones too, with every convex shape.

use lin_canny::nalgebra::Isometry3;
use lin_canny::{ContactPoint, Manifold, ManifoldOptions, PairTracker, RelativePose};

use super::dispatcher::ContactOptions;
use super::known::Known;
use super::manifold::{exchange, packed};
use super::number::{isometry, narrow};
use super::parry::math::{Pose, Real};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::Shape;
use super::part::{self, Placed};

/// Rounding of the gap between two balls, over the lengths that are summed: some tens of roundings.
const BALLS: f64 = 512.0 * f64::EPSILON;

/// Writes the contacts within the prediction. Returns false, with nothing written, unless both
/// shapes are convex, one is a cylinder or cone, and the pose is finite.
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
    let turned = isometry(pos12);
    let Some((of_a, of_b)) = part::both(known, a, b).filter(|(x, y)| x.is_convex() && y.is_convex()) else {
        return false;
    };
    let reach = f64::from(prediction) * f64::from(options.reach);
    if are_far((&of_a, &of_b), &turned, reach) {
        out.clear();
        return true;
    }
    let Ok(at) = RelativePose::new(&of_a.at, &(turned * of_b.at)) else {
        return false;
    };
    let mut chosen = ManifoldOptions::within(reach);
    (chosen.sine, chosen.max_points) = (f64::from(options.sine), options.max_points);
    let mut manifold = Manifold::new();
    let asked = PairTracker::new().manifold(&of_a.shape, &of_b.shape, &at, &chosen, &mut manifold);
    if asked.is_err() {
        return false;
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
    exchange(out, |points| points.extend(manifold.points().iter().map(tracked)));
    true
}

/// Returns whether the bounding balls of two shapes are farther apart than a distance, by more than
/// rounding.
fn are_far((a, b): (&Placed, &Placed), at: &Isometry3<f64>, distance: f64) -> bool {
    let ((of_a, radius_a), (of_b, radius_b)) = (a.shape.bounding_ball(), b.shape.bounding_ball());
    let (middle_a, middle_b) = (a.at * of_a, at * (b.at * of_b));
    let reach = radius_a + radius_b + distance;
    let sizes = middle_a.coords.norm() + middle_b.coords.norm() + at.translation.vector.norm() + reach;
    (middle_b - middle_a).norm() - reach > BALLS * sizes
}
