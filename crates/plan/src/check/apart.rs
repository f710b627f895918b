//! Boxes of joint values in which a pair is proven apart, and their lookup.
//!
//! The boxes are the leaves of a tree of halvings, so a lookup is a descent: one comparison for each
//! halving, and no geometry. A segment is divided in time where it crosses the face between two
//! halves. The time of the crossing is rounded, so each half gets the outer of two times: together
//! they cover the segment, rounding included.

use std::vec::Vec;

use crate::extremes::Extremes;
use crate::motion::space::JointPath;
use crate::names::CellPair;
use crate::tolerance::CROSSING;

/// The boxes of a pair.
pub(crate) struct ApartBoxes {
    pub(crate) pair: CellPair,
    /// The distance that the pair keeps in the boxes.
    pub(crate) kept: f64,
    pub(crate) paths: [Option<JointPath>; 2],
    pub(crate) boxes: BoxTree,
}

impl ApartBoxes {
    /// Returns whether the pair is proven farther apart than a distance at a configuration.
    pub(crate) fn apart_at(&self, configuration: &[f64], kept: f64) -> bool {
        kept <= self.kept && self.boxes.apart_at(configuration)
    }

    /// Returns whether the pair is proven farther apart than a distance along a segment.
    pub(crate) fn apart_along(&self, [from, to]: [&[f64]; 2], kept: f64) -> bool {
        kept <= self.kept && self.boxes.apart_along(from, to)
    }
}

/// Boxes of joint values, closed and disjoint except for their faces.
pub(crate) struct BoxTree {
    /// The whole range.
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
    pub(crate) nodes: Vec<Node>,
    /// Share of the volume in which the pair is proven apart. A coordinate without width does not
    /// count.
    pub(crate) share: f64,
}

/// A box.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Node {
    /// It was halved along a coordinate at a value; the lower half is the node `half`, the upper one
    /// the next.
    Halved { coordinate: usize, half: usize, at: f64 },
    /// The pair is proven apart.
    Apart,
    /// Nothing is proven.
    Open,
}

impl BoxTree {
    /// Returns whether the pair is proven apart at a configuration.
    pub(crate) fn apart_at(&self, configuration: &[f64]) -> bool {
        let is_inside = |k: usize| configuration[k] >= self.low[k] && configuration[k] <= self.high[k];
        let count = self.low.len();
        configuration.len() == count && (0..count).all(is_inside) && self.is_apart_below(configuration)
    }

    fn is_apart_below(&self, q: &[f64]) -> bool {
        // The upper halves of the faces on which the configuration is: it belongs to both halves.
        let (mut node, mut others) = (0, Vec::new());
        loop {
            match self.nodes[node] {
                Node::Halved { coordinate, half, at } => {
                    if q[coordinate] == at {
                        others.push(half + 1);
                    }
                    node = half + usize::from(q[coordinate] > at);
                }
                Node::Apart => return true,
                Node::Open => match others.pop() {
                    Some(next) => node = next,
                    None => return false,
                },
            }
        }
    }

    /// Returns whether the pair is proven apart all along a segment that is straight in all
    /// coordinates.
    ///
    /// The walk ends at the first box that is open, so a segment about which nothing is proven costs
    /// little more than two lookups.
    pub(crate) fn apart_along(&self, from: &[f64], to: &[f64]) -> bool {
        if !self.apart_at(from) || !self.apart_at(to) {
            return false;
        }
        // The box that is followed, the part of the segment in it, and those that wait.
        let (mut node, mut part, mut waiting) = (0, 0.0..1.0, Vec::new());
        loop {
            match self.nodes[node] {
                Node::Halved { coordinate, half, at } => {
                    let (x, y) = (from[coordinate], to[coordinate]);
                    if x <= at && y <= at {
                        node = half;
                        continue;
                    }
                    if x >= at && y >= at {
                        node = half + 1;
                        continue;
                    }
                    let time = (at - x) / (y - x);
                    let error = CROSSING * time + f64::MIN_POSITIVE;
                    let [first, second] = if x < at { [half, half + 1] } else { [half + 1, half] };
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
                }
                Node::Apart => match waiting.pop() {
                    Some(next) => (node, part) = next,
                    None => return true,
                },
                Node::Open => return false,
            }
        }
    }
}
