//! The state that a caller keeps per pair of shapes.

mod contains;
mod face;
mod manifold;
mod round;

use nalgebra::Vector3;

use crate::base::pose::RelativePose;
use crate::body::shape::{Core, Shape};
use crate::convex::replay::Replay;
use crate::convex::smooth;
use crate::convex::tracker::{Totals, Tracker};
use crate::pair::outcome::{Accuracy, Outcome, Until};
pub(crate) use face::{along_face, swapped};

/// Closest features of the last answer of one pair of shapes, from which the next query starts.
///
/// The counterpart of [`Tracker`] for every kind of [`Shape`]. Owns no shape. A tracker that comes
/// from another pair, or is out of date, costs time and never an answer.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ShapeTracker {
    polyhedral: Tracker,
    curved: smooth::WarmStart,
    totals: Totals,
}

impl ShapeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns a tracker whose first query of two shapes of which one is curved starts along a
    /// direction from A to B, in the frame of A.
    pub(crate) fn along(n: &Vector3<f64>) -> Self {
        Self {
            curved: smooth::WarmStart::along(n),
            ..Self::default()
        }
    }

    /// Returns the closest points of two shapes, their signed distance and its bounds, as told at
    /// `PairTracker::closest`. Features are those of the cores.
    ///
    /// Depths are searched to an interval of `2^-19 L` by a limited number of support points,
    /// unless balls inside the cores prove them, or cylinders and cones have parallel axes: about a
    /// common centre, if many directions are nearly as deep, the interval may stay wider.
    pub(crate) fn closest(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Outcome {
        self.measure(a, b, a_from_b, Until::Depth)
    }

    /// Returns the closest points, of an overlap with the depth or a local one.
    pub(crate) fn measure(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose, until: Until) -> Outcome {
        match (a.core(), b.core()) {
            (Core::Polyhedron(x), Core::Polyhedron(y)) => {
                let mut outcome = self.polyhedral.checked(x, y, a_from_b, until);
                let radii = [a.round(), b.round()];
                if radii != [0.0; 2] {
                    round::grow((x, y), a_from_b, radii, &mut outcome);
                }
                outcome
            }
            (x, y) => {
                let mut outcome = smooth::closest(x, y, a_from_b, Until::Depth, &mut self.curved);
                self.count(&outcome);
                let radii = [a.round(), b.round()];
                if radii != [0.0; 2] {
                    round::shift(a_from_b, radii, &mut outcome);
                }
                outcome
            }
        }
    }

    /// Returns the closest points, of overlapping polyhedra the class without the depth.
    pub(crate) fn closest_or_class(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Outcome {
        match (a.core(), b.core()) {
            (Core::Polyhedron(x), Core::Polyhedron(y)) if a.round() == 0.0 && b.round() == 0.0 => {
                self.polyhedral.closest_or_class(x, y, a_from_b)
            }
            _ => self.closest(a, b, a_from_b),
        }
    }

    /// Returns whether the closed shapes are at most `d` apart, `d` in the caller's unit; false if
    /// `d` is negative or NaN.
    ///
    /// For polyhedra, rounded or not, the answer is that of exact arithmetic on the poses, the
    /// radii and the `d` given (with the feature `exact`). For other shapes, a distance that the
    /// bounds cannot tell from `d` counts as within; for such a `d`, the answer may depend on the
    /// last query, which moves the bounds by less than their width.
    pub(crate) fn within(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose, d: f64) -> bool {
        match (a.core(), b.core()) {
            (Core::Polyhedron(x), Core::Polyhedron(y)) => {
                self.polyhedral.within_reach(x, y, a_from_b, [d, a.round(), b.round()])
            }
            _ => d >= 0.0 && self.closest(a, b, a_from_b).lower <= d,
        }
    }

    /// Returns the query as a text that rebuilds the query bit for bit, as [`Tracker::replay`];
    /// `None` unless both cores are polyhedra.
    #[must_use]
    pub(crate) fn replay(&self, a: &Shape, b: &Shape, a_from_b: &RelativePose) -> Option<Replay> {
        let (Core::Polyhedron(x), Core::Polyhedron(y)) = (a.core(), b.core()) else {
            return None;
        };
        Some(Replay {
            round: [a.round(), b.round()],
            ..self.polyhedral.replay(x, y, a_from_b, Accuracy::Certified)
        })
    }

    /// Returns what has been done so far.
    #[must_use]
    pub(crate) fn work(&self) -> Totals {
        let mut totals = self.totals;
        totals += self.polyhedral.work();
        totals
    }

    fn count(&mut self, outcome: &Outcome) {
        self.totals.note(false, outcome.solver, &outcome.work);
    }
}

impl Replay {
    /// Returns a tracker of [`shapes`](Self::shapes) with the recorded start.
    #[must_use]
    pub(crate) fn shape_tracker(&self) -> ShapeTracker {
        ShapeTracker {
            polyhedral: self.tracker(),
            ..ShapeTracker::default()
        }
    }
}
