//! The displacement budget: a pair is tested again only if its bodies may have used up the distance
//! between them.
//!
//! Every body has an odometer. At each change of its pose the odometer grows by an upper bound of
//! the displacement of any point of the body, `|shift of its centre| + 2 radius sin(angle / 2)`,
//! rounded up. Suppose that a pair was tested when the odometers were at a and b, and that the
//! answer holds as long as the distance changes by less than s. Then the pair sleeps until the sum
//! of the odometers reaches a + b + s. Velocities are not needed, and jumps are covered.
//!
//! **Proof.** Let d be the distance at the test and d' the distance now. Assume that no point of A
//! has moved farther than x, and no point of B farther than y. Then x and y are at most the growth
//! of the odometers, for any number of steps, because the displacement of a point is at most the
//! sum of its displacements. Any two points are now at least `d - x - y` apart, so `d' >= d - x -
//! y`. The two witness points of the test are now at most `d + x + y` apart, so `d' <= d + x + y`.
//! For bodies that share a point take d = 0 in the second inequality.
//!
//! Hence, with certified bounds `lower <= d <= upper`:
//! - beyond a threshold t (`lower > t`) the pair stays beyond it while x + y < lower - t;
//! - within a threshold (`upper < t`) the pair stays within it while x + y < t - upper;
//! - of several thresholds the nearest counts. A distance that is enabled and within its range is
//!   computed again whenever a body has moved.
//!
//! At contact the budget of an overlap event is zero, so the pair is tested in every step in which
//! one of its bodies moves. Rounding always wakes a pair early: an odometer is rounded up at each
//! step, and a sleep ends early by `ODOMETER` times the odometers. Long displacements therefore
//! shorten sleeps a little, but no event is lost.
//!
//! A query that is not enabled sets no threshold. So with fewer queries, pairs sleep longer.
//!
//! Sources: Schwarzer, Saha, Latombe 2005 bound motions in the same way for the edges of a roadmap.
//! Mirtich 1996 and Lin 1993 (section 5.1) wake pairs by velocity and time instead, which is
//! tighter if velocities are known.

use crate::base::tolerance::{ODOMETER, ROUND_UP};

/// Distance travelled by a body, and the step of the last move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Travel {
    /// Sum of displacements; never decreases.
    pub(super) odometer: f64,
    /// The step of the last move. The next field is the step in which the box was last marked as
    /// due.
    pub(super) moved: u32,
    due: u32,
}

impl Travel {
    /// Returns the travel of a body that was inserted in this step, with its box up to date.
    pub(super) fn moved_in(step: u32) -> Self {
        Self {
            odometer: 0.0,
            moved: step,
            due: step.wrapping_sub(1),
        }
    }

    /// Adds a displacement, rounded up.
    #[inline]
    pub(super) fn add(&mut self, way: f64, step: u32) {
        self.odometer = (self.odometer + way) * ROUND_UP;
        self.moved = step;
    }

    /// Returns whether the box is marked as due.
    pub(super) fn is_due(&self, step: u32) -> bool {
        self.due == step
    }

    /// Marks the box as due; returns whether it is the first mark in this step.
    #[inline]
    pub(super) fn mark_due(&mut self, step: u32) -> bool {
        let first = self.due != step;
        self.due = step;
        first
    }
}

/// Returns the sum of odometers at which a pair is tested again.
#[inline]
pub(super) fn wake(sum: f64, slack: f64) -> f64 {
    if slack > 0.0 {
        let end = sum + slack;
        end - ODOMETER * end
    } else {
        0.0
    }
}

/// Returns by how much a distance in `lower..=upper` may change before the result for one threshold
/// changes.
#[inline]
pub(super) fn slack(threshold: f64, lower: f64, upper: f64) -> f64 {
    if lower > threshold {
        lower - threshold
    } else {
        threshold - upper
    }
}
