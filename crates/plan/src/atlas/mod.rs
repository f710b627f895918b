//! An atlas: disjoint boxes of configurations that are proven free or in contact.
//!
//! # Method
//!
//! 1. The limits are one box. A box is free if each pair that is measured keeps its distance all over
//!    it, and in contact if one pair is in contact all over it: see the proofs over ranges.
//! 2. Other boxes are halved, the largest first. The halves inherit the pairs that are proven apart.
//! 3. The boxes are the leaves of the tree of halvings, so a lookup is a descent: one comparison for
//!    each halving, and no geometry.
//!
//! Sources: Brooks and Lozano-Perez 1985 (free and full cells of a subdivision); Zhu and Latombe 1991.

mod answers;
mod build;
mod pair_boxes;
#[cfg(feature = "serde")]
mod stored;
mod walk;

use core::fmt;
use std::vec::Vec;

use crate::world::WorldPair;

pub use build::AtlasOptions;
pub(crate) use pair_boxes::ApartBoxes;
pub use pair_boxes::PairBoxes;
#[cfg(feature = "serde")]
pub(crate) use stored::StoredAtlas;

/// What an atlas has proven about configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AtlasVerdict {
    /// Every pair is farther apart than it must keep.
    Free,
    /// A pair is in contact or closer than it must keep.
    Contact,
}

/// Shares of the volume of an atlas. Their sum is 1.
///
/// Each halving counts as exactly a half, so the shares are exact up to 53 halvings in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AtlasShares {
    /// Share of the boxes that are proven free.
    pub free: f64,
    /// Share of the boxes that are proven to be in contact or closer than they must be.
    pub contact: f64,
    /// Share about which nothing is proven.
    pub left: f64,
}

/// A box of configurations with its verdict.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AtlasBox {
    /// Least value of each coordinate.
    pub low: Vec<f64>,
    /// Greatest value of each coordinate.
    pub high: Vec<f64>,
    /// The verdict; `None` if nothing is proven.
    pub verdict: Option<AtlasVerdict>,
}

/// Disjoint boxes of configurations that are proven free or in contact: an atlas of the joint limits.
///
/// [`Checker::free_boxes`](crate::Checker::free_boxes) makes one. With
/// [`Checker::set_atlas`](crate::Checker::set_atlas), a checker answers by it where it can. An atlas
/// belongs to one robot and one world: their bodies, poses, margins, paddings and pairs.
///
/// Boxes are closed. An atlas with the feature `serde` can be stored; its numbers are exact.
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredAtlas", into = "StoredAtlas"))]
pub struct Atlas {
    /// The whole range.
    low: Vec<f64>,
    high: Vec<f64>,
    /// The pairs, in ascending order, each with a hash of its bodies, joints and distance to keep.
    pairs: Vec<(WorldPair, u64)>,
    /// The boxes in the order in which they were made: the largest first.
    nodes: Vec<Node>,
    /// The box that was halved into the nodes 2k + 1 and 2k + 2.
    parents: Vec<u32>,
    /// The first box that was not searched.
    next: usize,
    /// For each two halves that wait, the pairs that are not proven apart, as a set of bits.
    waiting: std::collections::VecDeque<Vec<u64>>,
    /// Number of proofs of a pair over a box.
    proofs: u64,
    shares: [f64; 2],
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    /// It was halved along a coordinate at a value.
    Halved { coordinate: u16, half: u32, at: f64 },
    /// It is proven free or in contact.
    Proven(AtlasVerdict),
    /// It was not searched.
    Waiting,
    /// It cannot be halved.
    Stuck,
}

impl fmt::Debug for Atlas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Atlas")
            .field("low", &self.low)
            .field("high", &self.high)
            .field("boxes", &self.nodes.len())
            .field("shares", &self.shares())
            .finish_non_exhaustive()
    }
}

impl Atlas {
    /// Returns the atlas of one box that was not searched.
    fn new(low: Vec<f64>, high: Vec<f64>, pairs: Vec<(WorldPair, u64)>) -> Self {
        let words = pairs.len().div_ceil(64);
        let mut all = std::vec![u64::MAX; words];
        if let Some(last) = all.last_mut() {
            *last >>= words * 64 - pairs.len();
        }
        Self {
            low,
            high,
            pairs,
            nodes: std::vec![Node::Waiting],
            parents: Vec::new(),
            next: 0,
            waiting: [all].into(),
            proofs: 0,
            shares: [0.0; 2],
        }
    }

    /// Returns the least and the greatest value of each coordinate.
    #[must_use]
    pub fn range(&self) -> [&[f64]; 2] {
        [&self.low, &self.high]
    }

    /// Returns the number of boxes that were searched.
    #[must_use]
    pub fn searched(&self) -> u64 {
        self.next as u64
    }

    /// Returns the number of proofs of a pair over a box.
    #[must_use]
    pub fn proofs(&self) -> u64 {
        self.proofs
    }

    /// Returns whether every box is decided or cannot be halved, so that no search finds more.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.next == self.nodes.len()
    }

    /// Returns the shares of the volume. A coordinate without width does not count.
    #[must_use]
    pub fn shares(&self) -> AtlasShares {
        let [free, contact] = self.shares;
        let left = 1.0 - free - contact;
        AtlasShares { free, contact, left }
    }

    /// Returns what is proven about a configuration; `None` if nothing is, if it is outside the
    /// limits, or if its length is wrong.
    ///
    /// This is a descent through the tree of halvings: some tens of comparisons, no geometry.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{AtlasOptions, AtlasVerdict, Checker, Joint, SerialArm, World};
    /// # let rail = |axis| Joint::prismatic(Isometry3::identity(), axis, [-2.0, 2.0]);
    /// # let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// # let block = SerialArm::new(Isometry3::identity(), rails, vec![2], 0.1)?;
    /// # let mut world = World::new();
    /// # world.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// # world.obstacle("post", solids::cuboid(Vector3::repeat(0.5))?, Isometry3::identity());
    /// # let mut checker = Checker::new(block, world)?;
    /// let atlas = checker.free_boxes(&AtlasOptions::default().boxes(500))?;
    /// assert_eq!(atlas.verdict_at(&[1.9, 0.0]), Some(AtlasVerdict::Free));
    /// assert_eq!(atlas.verdict_at(&[0.1, 0.0]), Some(AtlasVerdict::Contact));
    /// assert_eq!(atlas.verdict_at(&[0.6, 0.0]), None); // touches
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn verdict_at(&self, configuration: &[f64]) -> Option<AtlasVerdict> {
        let is_inside = |k: usize| configuration[k] >= self.low[k] && configuration[k] <= self.high[k];
        let count = self.low.len();
        (configuration.len() == count && (0..count).all(is_inside))
            .then(|| self.verdict_below(0, configuration))
            .flatten()
    }

    fn verdict_below(&self, mut node: usize, q: &[f64]) -> Option<AtlasVerdict> {
        // The upper halves of the faces on which the configuration is: it belongs to both halves.
        let mut others = Vec::new();
        loop {
            match self.nodes[node] {
                Node::Halved { coordinate, half, at } => {
                    let (x, half) = (q[usize::from(coordinate)], half as usize);
                    if x == at {
                        others.push(half + 1);
                    }
                    node = half + usize::from(x > at);
                }
                Node::Proven(verdict) => return Some(verdict),
                Node::Waiting | Node::Stuck => node = others.pop()?,
            }
        }
    }

    /// Returns all boxes, the largest first.
    pub fn boxes(&self) -> impl Iterator<Item = AtlasBox> + '_ {
        let is_leaf = |node: &usize| !matches!(self.nodes[*node], Node::Halved { .. });
        (0..self.nodes.len()).filter(is_leaf).map(|node| {
            let (mut low, mut high) = (Vec::new(), Vec::new());
            self.ends(node, &mut low, &mut high);
            let verdict = match self.nodes[node] {
                Node::Proven(verdict) => Some(verdict),
                _ => None,
            };
            AtlasBox { low, high, verdict }
        })
    }

    /// Writes the ends of a box, and returns how often the range was halved.
    fn ends(&self, node: usize, low: &mut Vec<f64>, high: &mut Vec<f64>) -> i32 {
        low.clone_from(&self.low);
        high.clone_from(&self.high);
        let (mut node, mut level) = (node, 0);
        // Going up, halvings cut at values farther and farther out.
        while let Some(pair) = node.checked_sub(1) {
            let parent = self.parents[pair / 2] as usize;
            if let Node::Halved { coordinate, half, at } = self.nodes[parent] {
                let k = usize::from(coordinate);
                if node == half as usize {
                    high[k] = if at < high[k] { at } else { high[k] };
                } else {
                    low[k] = if at > low[k] { at } else { low[k] };
                }
            }
            (node, level) = (parent, level + 1);
        }
        level
    }

    /// Leaves a box with what is proven about it.
    fn prove(&mut self, node: usize, verdict: AtlasVerdict, level: i32) {
        self.nodes[node] = Node::Proven(verdict);
        let of = usize::from(verdict == AtlasVerdict::Contact);
        // A power of two, exactly; below the least number it is zero.
        self.shares[of] += (0..level).fold(1.0, |share, _| 0.5 * share);
    }

    /// Halves a box.
    fn halve(&mut self, node: usize, coordinate: usize, at: f64) {
        let half = self.nodes.len() as u32;
        let coordinate = coordinate as u16;
        self.nodes[node] = Node::Halved { coordinate, half, at };
        self.nodes.extend([Node::Waiting; 2]);
        self.parents.push(node as u32);
    }
}

/// Returns the value at which a coordinate is halved, if it can be.
fn middle(low: f64, high: f64) -> Option<f64> {
    let at = 0.5 * low + 0.5 * high;
    (low < at && at < high).then_some(at)
}
