//! Counters of the work of queries.

use crate::base::num::sum_of_counters;

/// Work done by queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshWork {
    /// Queries.
    pub queries: u64,
    /// Entries of the front that were proven again, or not, by their direction.
    pub entries: u64,
    /// Entries whose direction no longer proved them.
    pub failed: u64,
    /// Pairs of boxes bounded anew.
    pub bounds: u64,
    /// Pairs of boxes bounded in double precision.
    pub looks: u64,
    /// Pairs of leaves judged.
    pub leaves: u64,
    /// Pairs of triangles or pieces measured.
    pub measured: u64,
    /// Pairs settled by a certified query of two polygons.
    pub settled: u64,
    /// Fronts cut.
    pub cuts: u64,
    /// Winding numbers taken.
    pub windings: u64,
}

sum_of_counters!(MeshWork {
    queries,
    entries,
    failed,
    bounds,
    looks,
    leaves,
    measured,
    settled,
    cuts,
    windings,
});
