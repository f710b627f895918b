//! The work of a tracker of any two geometries.

#[cfg(feature = "meshes")]
use crate::composite::meet::search::MeshWork;
use crate::convex::tracker::Totals;
#[cfg(feature = "surfaces")]
use crate::patch::SurfaceWork;

/// The work of the queries of a [`PairTracker`](crate::PairTracker), by what the geometries are
/// searched by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairWork {
    /// Queries of two convex geometries.
    pub convex: Totals,
    /// Queries of composites and meshes.
    #[cfg(feature = "meshes")]
    pub trees: MeshWork,
    /// Queries with a surface of patches.
    #[cfg(feature = "surfaces")]
    pub surfaces: SurfaceWork,
}

impl PairWork {
    pub(super) fn of_convex(convex: Totals) -> Self {
        Self {
            convex,
            ..Self::default()
        }
    }

    #[cfg(feature = "meshes")]
    pub(super) fn of_trees(trees: MeshWork) -> Self {
        Self {
            trees,
            ..Self::default()
        }
    }

    #[cfg(feature = "surfaces")]
    pub(super) fn of_surfaces(surfaces: SurfaceWork) -> Self {
        Self {
            surfaces,
            ..Self::default()
        }
    }
}

impl core::ops::AddAssign for PairWork {
    /// Adds all counts. Sums saturate.
    fn add_assign(&mut self, other: Self) {
        self.convex += other.convex;
        #[cfg(feature = "meshes")]
        {
            self.trees += other.trees;
        }
        #[cfg(feature = "surfaces")]
        {
            self.surfaces += other.surfaces;
        }
    }
}
