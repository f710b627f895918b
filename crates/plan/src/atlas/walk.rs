//! Segments through the boxes of an atlas.
//!
//! The walk divides the time of a segment where it crosses the face between two halves. The time of
//! the crossing is rounded, so each half gets the outer of two times: together they cover the
//! segment, whatever was rounded.

use core::ops::Range;

use super::{Atlas, AtlasVerdict, Node};
use crate::extremes::Extremes;
use crate::tolerance::CROSSING;

/// A segment whose part is followed through the boxes.
struct Walk<'a> {
    atlas: &'a Atlas,
    from: &'a [f64],
    to: &'a [f64],
}

impl Atlas {
    /// Returns what is proven about the segment between two configurations: free if free boxes cover
    /// it, and in contact if an end is in a box of contact.
    ///
    /// The segment is straight in all coordinates. The walk ends at the first box that is not free, so a
    /// segment about which nothing is proven costs little more than two lookups.
    #[must_use]
    pub fn verdict_along(&self, from: &[f64], to: &[f64]) -> Option<AtlasVerdict> {
        for end in [from, to] {
            if self.verdict_at(end)? == AtlasVerdict::Contact {
                return Some(AtlasVerdict::Contact);
            }
        }
        let walk = Walk { atlas: self, from, to };
        walk.is_free(0, 0.0..1.0).then_some(AtlasVerdict::Free)
    }
}

impl Walk<'_> {
    /// Returns whether free boxes cover the part of the segment in a box.
    fn is_free(&self, node: usize, part: Range<f64>) -> bool {
        let (coordinate, half, at) = match self.atlas.nodes[node] {
            Node::Halved { coordinate, half, at } => (usize::from(coordinate), half as usize, at),
            other => return other == Node::Proven(AtlasVerdict::Free),
        };
        let (from, to) = (self.from[coordinate], self.to[coordinate]);
        let (low, high) = (half, half + 1);
        if from <= at && to <= at {
            return self.is_free(low, part);
        }
        if from >= at && to >= at {
            return self.is_free(high, part);
        }
        let time = (at - from) / (to - from);
        let error = CROSSING * time + f64::MIN_POSITIVE;
        let [first, second] = if from < at { [low, high] } else { [high, low] };
        let before = part.start..part.end.smaller(time + error);
        let after = part.start.larger(time - error)..part.end;
        let is_covered = |node, part: Range<f64>| part.start > part.end || self.is_free(node, part);
        is_covered(first, before) && is_covered(second, after)
    }
}
