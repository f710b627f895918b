//! Parts of surfaces, and the work of queries.

use super::tree::Node;
use crate::base::num::sum_of_counters;

/// A part of a surface: a node of its tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePart {
    /// The number of the patch; `None` for a group of whole patches.
    pub patch: Option<u32>,
    /// Least and greatest parameter u.
    pub u: [f64; 2],
    /// Least and greatest parameter v.
    pub v: [f64; 2],
}

impl SurfacePart {
    pub(super) fn of(node: &Node) -> Self {
        let [u, v] = node.domain();
        let patch = (!node.is_group()).then_some(node.patch());
        Self { patch, u, v }
    }
}

/// The work of queries of two surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceWork {
    /// Queries answered.
    pub queries: u64,
    /// Entries of fronts tested by their directions.
    pub entries: u64,
    /// Entries that their directions did not prove.
    pub failed: u64,
    /// Gaps of two nets along a direction.
    pub gaps: u64,
    /// Pairs bounded by second derivatives.
    pub caps: u64,
    /// Pairs bounded by a curved surface between them.
    pub bowls: u64,
    /// Surroundings of closest points proven at once.
    pub regions: u64,
    /// Surroundings of closest points that were tried and not proven.
    pub refused: u64,
    /// Steps of Newton's method for two points.
    pub steps: u64,
    /// Pairs of nodes split.
    pub splits: u64,
    /// Searches from the roots.
    pub searches: u64,
}

sum_of_counters!(SurfaceWork {
    queries,
    entries,
    failed,
    gaps,
    caps,
    bowls,
    regions,
    refused,
    steps,
    splits,
    searches,
});
