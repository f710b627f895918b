//! Options of a contact manifold.

use super::MOST_POINTS;
use crate::pair::outcome::Until;

/// Options of a contact manifold. A NaN option requests nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ManifoldOptions {
    /// Largest separation of a contact, in the caller's unit. Zero: only touching or overlapping
    /// contacts.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub prediction: f64,
    /// Largest number of points, 1 to 8. Default 4. If a face has more than 24 vertices, not all
    /// vertices of the overlap are examined: in random poses of a large face on another, eight
    /// points span 60 % of the overlap in all but some in a thousand poses; in long and narrow
    /// overlaps now and then much less.
    pub max_points: usize,
    /// Sine of the largest angle between the normal and a face that bears the contact. Default 1/2,
    /// 30 degrees: vertices of such a face within the prediction are contacts, so that a round body
    /// rests on its face instead of rolling over one vertex. At 1/64 piles of round hulls penetrate
    /// 1.3 times as deep, beyond 1/2 nothing changes. A face within one degree of upright (parallel
    /// to the normal) never bears the contact, at any setting.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub sine: f64,
    /// Largest motion of the bodies before a manifold is computed again, in radii of the smaller
    /// body; until then the points stay fixed on the bodies and only separations change. Contacts
    /// nearer to each other than `drift` are merged. Default 1/1024; zero: every motion computes
    /// the manifold again.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub drift: f64,
    /// Largest motion of the bodies, in radii of the smaller body, before points are chosen again
    /// from the vertices of the overlap of two faces; until then the chosen vertices are kept, as
    /// long as they stay in the overlap and include the deepest. Default 1/16.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub choice: f64,
    /// Whether a local depth will do: normal and separations of an overlap from the nearest facet
    /// about the last one, for a fraction of the time, whether or not a shorter translation parts
    /// the bodies: see [`Tracker::closest_with_local_depth`]. For polyhedra, sharp or rounded, and
    /// for curved shapes, from the normal that is highest in its neighbourhood; bodies of pieces
    /// keep the depth. Default false.
    ///
    /// [`Tracker::closest_with_local_depth`]: crate::Tracker::closest_with_local_depth
    #[cfg_attr(feature = "serde", serde(default))]
    pub local_depth: bool,
}

impl Default for ManifoldOptions {
    fn default() -> Self {
        Self::within(0.0)
    }
}

impl ManifoldOptions {
    /// Returns the default options with a prediction distance.
    #[must_use]
    pub const fn within(prediction: f64) -> Self {
        Self {
            prediction,
            max_points: 4,
            sine: 0.5,
            drift: 1.0 / 1024.0,
            choice: 1.0 / 16.0,
            local_depth: false,
        }
    }

    /// Returns the options with another number of points.
    #[must_use]
    pub const fn max_points(mut self, max_points: usize) -> Self {
        self.max_points = max_points;
        self
    }

    /// Returns the options with another sine.
    #[must_use]
    pub const fn sine(mut self, sine: f64) -> Self {
        self.sine = sine;
        self
    }

    /// Returns the options with another drift.
    #[must_use]
    pub const fn drift(mut self, drift: f64) -> Self {
        self.drift = drift;
        self
    }

    /// Returns the options with another motion before points are chosen again.
    #[must_use]
    pub const fn choice(mut self, choice: f64) -> Self {
        self.choice = choice;
        self
    }

    /// Returns the options with or without a local depth.
    #[must_use]
    pub const fn local_depth(mut self, local_depth: bool) -> Self {
        self.local_depth = local_depth;
        self
    }

    /// Returns what the contacts need of an overlap.
    pub(crate) fn until(&self) -> Until {
        Until::of_depth(true, self.local_depth)
    }

    pub(crate) fn most(&self) -> usize {
        self.max_points.clamp(1, MOST_POINTS)
    }
}
