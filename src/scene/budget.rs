//! The displacement budget: a pair is looked at again only when its bodies may have used up its distance.
//!
//! Every body has an odometer: at each change of its pose it grows by a bound of how far any point of the body went,
//! `|shift of its centre| + 2 radius sin(turn / 2)`, rounded up. A pair that was looked at when its odometers
//! stood at a and b, and whose answer holds as long as its distance changes by less than s, sleeps until the sum of its odometers
//! reaches a + b + s. Velocities need not be known, and jumps are no exception.
//!
//! **Proof.** Let d be the distance then and d' now, and let no point of A have gone farther than x, none of B farther than y: both
//! are at most the growth of the odometers, however many steps it took (a point goes no farther than the sum of its ways). Any
//! two points are now at least `d - x - y` apart, so `d' >= d - x - y`; the two witness points of then are now at most
//! `d + x + y` apart, so `d' <= d + x + y`. For bodies that share a point take d = 0 in the second.
//!
//! Hence, with certified bounds `lower <= d <= upper`:
//! - beyond a threshold t (`lower > t`) the pair stays beyond while x + y < lower - t;
//! - within it (`upper < t`) it stays within while x + y < t - upper;
//! - of several thresholds the nearest counts; a distance that is called for and within its range is always taken anew when
//!   a body has moved.
//!
//! At contact the budget of an overlap event is zero, so the pair is looked at in every step in which one of its bodies moves.
//! Sums are rounded towards waking: an odometer is rounded up at each step, and a sleep ends early by
//! [`ODOMETER`] times the odometers. That is what long ways cost, and never an event.
//!
//! The threshold of a pair that is not called for is none, so the fewer effects, the longer the sleep.
//!
//! Sources: Schwarzer, Saha, Latombe 2005 bound motions likewise for the edges of a roadmap; Mirtich 1996 and Lin 1993
//! (section 5.1) wake pairs by velocity and time instead, which is tighter where velocities are known.

use crate::tolerance::{ODOMETER, ROUND_UP};

/// How far a body has come, and when it last moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Travel {
    /// Never falls.
    pub(super) odometer: f64,
    /// The step in which it last moved, and in which its box was last called for.
    pub(super) moved: u32,
    due: u32,
}

impl Travel {
    /// Of a body that was inserted for this step, with its box.
    pub(super) fn moved_in(step: u32) -> Self {
        Self {
            odometer: 0.0,
            moved: step,
            due: step.wrapping_sub(1),
        }
    }

    /// Adds a way, rounded up.
    #[inline]
    pub(super) fn add(&mut self, way: f64, step: u32) {
        self.odometer = (self.odometer + way) * ROUND_UP;
        self.moved = step;
    }

    /// Whether this is the first call of the step.
    #[inline]
    pub(super) fn mark_due(&mut self, step: u32) -> bool {
        let first = self.due != step;
        self.due = step;
        first
    }
}

/// The sum of odometers from which on a pair is looked at again.
#[inline]
pub(super) fn wake(sum: f64, slack: f64) -> f64 {
    if slack > 0.0 {
        let end = sum + slack;
        end - ODOMETER * end
    } else {
        0.0
    }
}

/// By how much the distance may change before the answer to one threshold does, for a distance in `lower..=upper`.
#[inline]
pub(super) fn slack(threshold: f64, lower: f64, upper: f64) -> f64 {
    if lower > threshold {
        lower - threshold
    } else {
        threshold - upper
    }
}
