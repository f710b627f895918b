//! Segments through the boxes of an atlas.
//!
//! The walk divides the time of a segment where it crosses the face between two halves. The time of
//! the crossing is rounded, so each half gets the outer of two times: together they cover the
//! segment, whatever was rounded.

use std::vec::Vec;

use super::{Atlas, AtlasVerdict, Node};
use crate::extremes::Extremes;
use crate::tolerance::CROSSING;

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
        self.is_free_along(from, to).then_some(AtlasVerdict::Free)
    }

    /// Returns whether free boxes cover a segment.
    fn is_free_along(&self, from: &[f64], to: &[f64]) -> bool {
        // The box that is followed, the part of the segment in it, and those that wait.
        let (mut node, mut part, mut waiting) = (0, 0.0..1.0, Vec::new());
        loop {
            if let Node::Halved { coordinate, half, at } = self.nodes[node] {
                let (x, y) = (from[usize::from(coordinate)], to[usize::from(coordinate)]);
                let (low, high) = (half as usize, half as usize + 1);
                if x <= at && y <= at {
                    node = low;
                    continue;
                }
                if x >= at && y >= at {
                    node = high;
                    continue;
                }
                let time = (at - x) / (y - x);
                let error = CROSSING * time + f64::MIN_POSITIVE;
                let [first, second] = if x < at { [low, high] } else { [high, low] };
                let before = part.start..part.end.smaller(time + error);
                let after = part.start.larger(time - error)..part.end;
                if before.start > before.end {
                    (node, part) = (second, after);
                    continue;
                }
                if after.start <= after.end {
                    waiting.push((second, after));
                }
                (node, part) = (first, before);
                continue;
            }
            if self.nodes[node] != Node::Proven(AtlasVerdict::Free) {
                return false;
            }
            match waiting.pop() {
                Some(next) => (node, part) = next,
                None => return true,
            }
        }
    }
}
