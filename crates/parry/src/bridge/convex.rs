//! Manifolds of two convex shapes.

use super::contact::ContactOptions;
use super::curved;
use super::far::are_far;
use super::half_space;
use super::known::Known;
use super::manifold::PosedPair;
use super::parry::math::{Pose, Real};
use super::parry::query::ContactManifold;
use super::parry::shape::Shape;
use super::part;

/// Writes the contacts of two convex shapes. Returns false, with nothing written, for a pair
/// that parry handles.
pub(super) fn write<M, C: Default + Copy>(
    known: &Known,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    prediction: Real,
    options: &ContactOptions,
    out: &mut ContactManifold<M, C>,
) -> bool {
    if are_far(pos12, (a, b), prediction * options.prediction_factor) {
        out.clear();
        return true;
    }
    if let Some(pair) = part::pair(known, a, b) {
        if pair.0.is_far(&pair.1, pos12, prediction * options.prediction_factor) {
            out.clear();
            return true;
        }
        if let Some(posed) = PosedPair::new(&pair, pos12) {
            posed.write(prediction, options, out);
            return true;
        }
    }
    half_space::write(known, pos12, (a, b), prediction, options, out)
        || curved::write(known, pos12, (a, b), prediction, options, out)
}
