//! The outcome of a query of a point and a geometry of any kind.

use nalgebra::{Point3, Unit, Vector3};

use super::location::WitnessLocation;
use super::outcome::{ContactState, Distance};
use crate::base::num::extremes::Bounded;

/// The closest point of a geometry to a query point, with proven bounds of the signed distance.
///
/// Points and directions are in the frame of the geometry, lengths in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PointOutcome {
    /// Side of the surface on which the point is.
    ///
    /// Separated: outside. Touching: on the surface. Overlapping: inside. Undecided: rounding hides
    /// the side. The side is proven even if the bounds include zero.
    pub state: ContactState,
    /// Best estimate of the signed distance from the surface: negative inside.
    pub distance: f64,
    /// Lower bound of the signed distance; not negative outside.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the signed distance; not positive inside.
    pub upper: f64,
    /// The point of the surface that is closest to the query point, up to rounding.
    pub point: Point3<f64>,
    /// Outward unit direction: that in which the signed distance grows.
    ///
    /// It leads from the closest point to a point outside, and from a point inside to the closest
    /// point. Within rounding of the surface it is the normal of the face.
    pub normal: Unit<Vector3<f64>>,
    /// The subshape and feature that contain the closest point.
    pub location: WitnessLocation,
}

impl PointOutcome {
    /// Returns whether the geometry contains the point; its surface counts, and so does undecided.
    #[must_use]
    pub fn is_contained(&self) -> bool {
        self.state != ContactState::Separated
    }
}

impl PointOutcome {
    /// Returns the side that bounds prove.
    pub(crate) fn state_of(lower: f64, upper: f64) -> ContactState {
        if lower > 0.0 {
            ContactState::Separated
        } else if upper < 0.0 {
            ContactState::Overlapping
        } else if lower == 0.0 && upper == 0.0 {
            ContactState::Touching
        } else {
            ContactState::Undecided
        }
    }

    /// Sets the proven side: 1 outside, 0 on the surface, -1 inside.
    pub(crate) fn set_side(&mut self, side: i32) {
        let positive = |x: f64| x.at_least(0.0);
        match side {
            1 => {
                self.state = ContactState::Separated;
                (self.lower, self.upper) = (positive(self.lower), positive(self.upper));
            }
            -1 => {
                self.state = ContactState::Overlapping;
                (self.lower, self.upper) = (-positive(-self.lower), -positive(-self.upper));
            }
            _ => {
                self.state = ContactState::Touching;
                (self.lower, self.upper) = (0.0, 0.0);
            }
        }
        self.distance = self.distance.clamped(self.lower, self.upper);
    }
}

impl From<&PointOutcome> for Distance {
    fn from(outcome: &PointOutcome) -> Self {
        Self {
            state: outcome.state,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}
