//! The options of contact manifolds, and how the contacts of a manifold are replaced.

use super::parry::math::Real;
use super::parry::query::{ContactManifold, TrackedContact};

/// Options of contact manifolds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactOptions {
    /// Sine of the largest angle between the normal and a contact face (default 1/2).
    ///
    /// With 1/64, overlaps in piles of round hulls are 1.3 times as deep.
    pub max_face_sine: Real,
    /// Factor by which the prediction of the engine is multiplied (default 4).
    ///
    /// An engine drops contacts that do not close within a step. Overlaps in piles of hulls are
    /// half as deep as with 1.
    pub prediction_factor: Real,
    /// Largest number of points of a manifold, 1 to 8 (default 8). rapier itself reduces them to 4.
    pub max_points: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            max_face_sine: 0.5,
            prediction_factor: 4.0,
            max_points: 8,
        }
    }
}

impl ContactOptions {
    /// Returns the options with another sine of the largest angle between normal and contact face.
    #[must_use]
    pub const fn max_face_sine(mut self, sine: Real) -> Self {
        self.max_face_sine = sine;
        self
    }

    /// Returns the options with another factor for the prediction of the engine.
    #[must_use]
    pub const fn prediction_factor(mut self, factor: Real) -> Self {
        self.prediction_factor = factor;
        self
    }

    /// Returns the options with another largest number of points.
    #[must_use]
    pub const fn max_points(mut self, points: usize) -> Self {
        self.max_points = points;
        self
    }
}

/// Maximum number of points that are copied for matching; other engines may have more.
const MOST_KEPT: usize = 8;

/// Replaces the contacts of a manifold, and keeps the data of contacts with equal features.
pub(super) fn exchange<M, C: Default + Copy>(
    out: &mut ContactManifold<M, C>,
    write: impl FnOnce(&mut Vec<TrackedContact<C>>),
) {
    match out.points[..] {
        [first, ..] if out.points.len() <= MOST_KEPT => {
            let mut kept = [first; MOST_KEPT];
            let count = out.points.len();
            kept[..count].copy_from_slice(&out.points);
            out.points.clear();
            write(&mut out.points);
            out.match_contacts(&kept[..count]);
        }
        _ => {
            let kept = core::mem::take(&mut out.points);
            write(&mut out.points);
            out.match_contacts(&kept);
        }
    }
}
