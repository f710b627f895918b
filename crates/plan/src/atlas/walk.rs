//! Segments through the boxes of an atlas.
//!
//! The walk divides the time of a segment where it crosses the face between two halves. The time of
//! the crossing is rounded, so each half gets the outer of two times: together they cover the
//! segment, whatever was rounded. A contact counts only in the inner times.

use core::ops::Range;

use super::{Atlas, AtlasVerdict, Node};
use crate::extremes::Extremes;
use crate::tolerance::CROSSING;

/// What a walk has found.
struct Walk<'a> {
    atlas: &'a Atlas,
    from: &'a [f64],
    to: &'a [f64],
    is_free: bool,
}

impl Atlas {
    /// Returns what is proven about the segment between two configurations: free if free boxes cover
    /// it, and in contact if it meets a box of contact.
    ///
    /// The segment is straight in all coordinates.
    #[must_use]
    pub fn verdict_along(&self, from: &[f64], to: &[f64]) -> Option<AtlasVerdict> {
        let count = self.low.len();
        let is_inside = |k: usize| {
            let ends = [from[k], to[k]];
            ends.iter().all(|x| *x >= self.low[k] && *x <= self.high[k])
        };
        if from.len() != count || to.len() != count || !(0..count).all(is_inside) {
            return None;
        }
        let mut walk = Walk {
            atlas: self,
            from,
            to,
            is_free: true,
        };
        if walk.meets_contact(0, 0.0..1.0, 0.0..1.0) {
            return Some(AtlasVerdict::Contact);
        }
        walk.is_free.then_some(AtlasVerdict::Free)
    }
}

impl Walk<'_> {
    /// Follows the part of the segment in a box; returns whether it meets a box of contact.
    fn meets_contact(&mut self, node: usize, outer: Range<f64>, inner: Range<f64>) -> bool {
        let (coordinate, half, at) = match self.atlas.nodes[node] {
            Node::Halved { coordinate, half, at } => (usize::from(coordinate), half as usize, at),
            Node::Proven(AtlasVerdict::Free) => return false,
            Node::Proven(AtlasVerdict::Contact) => {
                self.is_free = false;
                return inner.start <= inner.end;
            }
            Node::Waiting | Node::Stuck => {
                self.is_free = false;
                return false;
            }
        };
        let (from, to) = (self.from[coordinate], self.to[coordinate]);
        let (low, high) = (half, half + 1);
        if from <= at && to <= at {
            return self.meets_contact(low, outer, inner);
        }
        if from >= at && to >= at {
            return self.meets_contact(high, outer, inner);
        }
        let time = (at - from) / (to - from);
        let error = CROSSING * time + f64::MIN_POSITIVE;
        let [before, after] = [time - error, time + error];
        let [first, second] = if from < at { [low, high] } else { [high, low] };
        let until = |range: &Range<f64>, end: f64| range.start..range.end.smaller(end);
        let since = |range: &Range<f64>, start: f64| range.start.larger(start)..range.end;
        let first_part = (until(&outer, after), until(&inner, before));
        let second_part = (since(&outer, before), since(&inner, after));
        for (node, (outer, inner)) in [(first, first_part), (second, second_part)] {
            if outer.start <= outer.end && self.meets_contact(node, outer, inner) {
                return true;
            }
        }
        false
    }
}
