//! The tree of boxes of joint values in which one pair is apart.
//!
//! # Method
//!
//! 1. The limits are one box. A box in which the pair is not proven apart is halved, the largest
//!    first: see the proofs over ranges. A box in which the pair is always in contact stays whole.
//! 2. The boxes are the leaves of the tree of halvings, so a lookup is a descent: one comparison for
//!    each halving, and no geometry.
//! 3. A segment is divided in time where it crosses the face between two halves. The time of the
//!    crossing is rounded, so each half gets the outer of two times: together they cover the segment,
//!    whatever was rounded.
//!
//! Sources: Brooks and Lozano-Perez 1985 (free and full cells of a subdivision); Zhu and Latombe 1991.

use core::ops::ControlFlow;
use std::collections::VecDeque;
use std::vec::Vec;

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::range::{BoxProof, PairProver};
use crate::tolerance::CROSSING;
use lin_canny::Progress;

/// Boxes of joint values, closed and disjoint except for their faces.
pub(super) struct BoxTree {
    /// The whole range.
    low: Vec<f64>,
    high: Vec<f64>,
    nodes: Vec<Node>,
    /// Share of the volume in which the pair is proven apart.
    share: f64,
}

/// A box.
#[derive(Clone, Copy, PartialEq)]
enum Node {
    /// It was halved along a coordinate at a value; the lower half is the node `half`, the upper one
    /// the next.
    Halved { coordinate: usize, half: usize, at: f64 },
    /// The pair is proven apart.
    Apart,
    /// Nothing is proven.
    Open,
}

impl BoxTree {
    /// Searches boxes until as many are searched as `most` says, or the caller stops.
    pub(super) fn search(
        prover: &mut PairProver<'_>,
        [low, high]: [Vec<f64>; 2],
        most: u64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Self, PlanError> {
        let mut waiting = VecDeque::from([(0, [low.clone(), high.clone()], 1.0)]);
        let mut tree = Self {
            low,
            high,
            nodes: std::vec![Node::Open],
            share: 0.0,
        };
        let mut searched = 0;
        while searched < most
            && let Some((node, [low, high], share)) = waiting.pop_front()
        {
            match prover.prove(&low, &high)? {
                BoxProof::Free => {
                    tree.nodes[node] = Node::Apart;
                    tree.share += share;
                }
                BoxProof::Contact => {}
                BoxProof::Left => {
                    if let Some((coordinate, at)) = halving(prover, &low, &high) {
                        let half = tree.nodes.len();
                        tree.nodes[node] = Node::Halved { coordinate, half, at };
                        tree.nodes.extend([Node::Open; 2]);
                        let (mut middle_low, mut middle_high) = (low.clone(), high.clone());
                        (middle_low[coordinate], middle_high[coordinate]) = (at, at);
                        waiting.push_back((half, [low, middle_high], 0.5 * share));
                        waiting.push_back((half + 1, [middle_low, high], 0.5 * share));
                    }
                }
            }
            searched += 1;
            let total = usize::try_from(most).ok();
            if progress(Progress::new("boxes", searched as usize, total)).is_break() {
                break;
            }
        }
        Ok(tree)
    }

    /// Returns the share of the volume in which the pair is proven apart. A coordinate without width
    /// does not count.
    pub(super) fn share(&self) -> f64 {
        self.share
    }

    /// Returns whether the pair is proven apart at a configuration.
    pub(super) fn apart_at(&self, configuration: &[f64]) -> bool {
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
    pub(super) fn apart_along(&self, from: &[f64], to: &[f64]) -> bool {
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

/// Returns the coordinate that moves the pair most, with the value at which a box is halved.
fn halving(prover: &PairProver<'_>, low: &[f64], high: &[f64]) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for (coordinate, moved) in prover.levers() {
        let (low, high) = (low[coordinate], high[coordinate]);
        let at = 0.5 * low + 0.5 * high;
        if low < at && at < high && best.is_none_or(|(most, ..)| moved > most) {
            best = Some((moved, coordinate, at));
        }
    }
    best.map(|(_, coordinate, at)| (coordinate, at))
}
