//! The serialised form of an atlas (feature `serde`), checked when it is read.

use std::collections::VecDeque;
use std::string::String;
use std::vec::Vec;

use super::{Atlas, AtlasVerdict, Node, middle};
use crate::error::PlanError;
use crate::world::WorldPair;

/// Version of the stored form.
const VERSION: u32 = 1;

/// Codes of boxes that are not halved; others are the coordinate along which a box was halved.
const FREE: i32 = -1;
const CONTACT: i32 = -2;
const WAITING: i32 = -3;
const STUCK: i32 = -4;

/// An atlas as it is stored.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Atlas")]
pub(crate) struct StoredAtlas {
    version: u32,
    low: Vec<f64>,
    high: Vec<f64>,
    pairs: Vec<(WorldPair, u64)>,
    /// The boxes in the order of the atlas.
    boxes: Vec<i32>,
    /// The pairs that are not proven apart, for each two halves that wait, as a set of bits.
    waiting: Vec<Vec<u64>>,
    proofs: u64,
}

impl From<Atlas> for StoredAtlas {
    fn from(atlas: Atlas) -> Self {
        let code = |node: &Node| match node {
            Node::Halved { coordinate, .. } => i32::from(*coordinate),
            Node::Proven(AtlasVerdict::Free) => FREE,
            Node::Proven(AtlasVerdict::Contact) => CONTACT,
            Node::Waiting => WAITING,
            Node::Stuck => STUCK,
        };
        Self {
            version: VERSION,
            boxes: atlas.nodes.iter().map(code).collect(),
            low: atlas.low,
            high: atlas.high,
            pairs: atlas.pairs,
            waiting: atlas.waiting.into(),
            proofs: atlas.proofs,
        }
    }
}

impl TryFrom<StoredAtlas> for Atlas {
    type Error = PlanError;

    fn try_from(stored: StoredAtlas) -> Result<Self, PlanError> {
        let StoredAtlas {
            version,
            low,
            high,
            pairs,
            boxes,
            waiting,
            proofs,
        } = stored;
        if version != VERSION {
            return damaged(std::format!("version {version} (expected {VERSION})"));
        }
        if low.len() != high.len() || low.len() > usize::from(u16::MAX) {
            let (low, high) = (low.len(), high.len());
            return damaged(std::format!("{low} lower and {high} upper limits"));
        }
        let is_range = |k: &usize| low[*k].is_finite() && high[*k].is_finite() && low[*k] <= high[*k];
        if let Some(index) = (0..low.len()).find(|k| !is_range(k)) {
            let (low, high) = (low[index], high[index]);
            return damaged(std::format!("limits of coordinate {index}: {low:?} to {high:?}"));
        }
        if let Some(index) = (1..pairs.len()).find(|k| pairs[k - 1].0 >= pairs[*k].0) {
            return damaged(std::format!("pair {index} is not in ascending order"));
        }
        if boxes.is_empty() || boxes.len() > u32::MAX as usize {
            return damaged(std::format!("{} boxes", boxes.len()));
        }
        let mut atlas = Self::new(low, high, pairs);
        atlas.proofs = proofs;
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for (node, &code) in boxes.iter().enumerate() {
            if node >= atlas.nodes.len() {
                return damaged(std::format!("box {node} belongs to no halved box"));
            }
            if code == WAITING {
                break;
            }
            let level = atlas.ends(node, &mut lower, &mut upper);
            match code {
                FREE => atlas.prove(node, AtlasVerdict::Free, level),
                CONTACT => atlas.prove(node, AtlasVerdict::Contact, level),
                STUCK => atlas.nodes[node] = Node::Stuck,
                _ => {
                    let coordinate = usize::try_from(code).ok().filter(|k| *k < lower.len());
                    let at = coordinate.and_then(|k| middle(lower[k], upper[k]));
                    let (Some(coordinate), Some(at)) = (coordinate, at) else {
                        return damaged(std::format!("box {node} cannot be halved along coordinate {code}"));
                    };
                    atlas.halve(node, coordinate, at);
                }
            }
            atlas.next += 1;
        }
        if let Some(node) = (atlas.next..boxes.len()).find(|node| boxes[*node] != WAITING) {
            return damaged(std::format!("box {node} comes after boxes that were not searched"));
        }
        if boxes.len() != atlas.nodes.len() {
            let (found, expected) = (boxes.len(), atlas.nodes.len());
            return damaged(std::format!("{found} boxes (expected {expected})"));
        }
        atlas.take_waiting(waiting)
    }
}

impl Atlas {
    /// Takes the pairs of the boxes that were not searched.
    fn take_waiting(mut self, waiting: Vec<Vec<u64>>) -> Result<Self, PlanError> {
        // The first of two halves may be searched already.
        let halves = |count: usize| count.div_ceil(2);
        let expected = match self.next {
            0 => 1,
            next => halves(self.nodes.len() - 1) - (next - 1) / 2,
        };
        if waiting.len() != expected {
            let found = waiting.len();
            return damaged(std::format!("{found} sets of pairs (expected {expected})"));
        }
        let all = Self::new(Vec::new(), Vec::new(), self.pairs.clone())
            .waiting
            .remove(0)
            .unwrap_or_default();
        let is_subset =
            |set: &Vec<u64>| set.len() == all.len() && set.iter().zip(&all).all(|(own, all)| own & !all == 0);
        if let Some(index) = waiting.iter().position(|set| !is_subset(set)) {
            return damaged(std::format!("set {index} has pairs that do not exist"));
        }
        self.waiting = VecDeque::from(waiting);
        Ok(self)
    }
}

fn damaged<T>(what: String) -> Result<T, PlanError> {
    Err(PlanError::AtlasFile(what))
}
