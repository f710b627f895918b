//! What a tracker of any two geometries keeps: counters, fronts, and where a query begins.

use alloc::string::String;
#[cfg(feature = "surfaces")]
use alloc::vec::Vec;

use super::pair::Asked;
#[cfg(feature = "meshes")]
use super::parted::TrackedMeshes;
#[cfg(feature = "surfaces")]
use super::patched::TrackedSurfaces;
use super::tracker::PairTracker;
use super::work::PairWork;
use crate::base::pose::RelativePose;
use crate::convex::replay::Replay;
use crate::pair_tracker::geometry::GeometryRef;
#[cfg(feature = "surfaces")]
use crate::patch::{Surface, SurfacePart};

impl PairTracker {
    /// Returns a query of two convex geometries as a text that rebuilds the query bit for bit, as
    /// [`Tracker::replay`](crate::Tracker::replay): call this before the query. `None` unless both
    /// are polyhedra, rounded or not.
    #[must_use]
    pub fn replay<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Option<Replay> {
        let (a, b) = (a.into(), b.into());
        self.of(a, b).tracker.replay((a, b), a_from_b)
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> PairWork {
        let mut work = self.work;
        if let Some(followed) = &self.followed {
            work += followed.tracker.work();
        }
        work
    }

    /// Returns the number of entries of the front that is kept: pairs of parts of both geometries
    /// that are proven farther apart than the distance, under which every pair of triangles, pieces
    /// or patches lies. Zero for convex geometries, which have none.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.followed.as_ref().map_or(0, |f| f.tracker.front_len())
    }

    /// Returns the front that is kept of two meshes: pairs of nodes of the trees of A and of B that
    /// are proven farther apart than the distance. [`Mesh::node_box`](crate::Mesh::node_box)
    /// returns their boxes. Empty for other geometries.
    #[cfg(feature = "meshes")]
    pub fn mesh_front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let followed = self.followed.as_ref();
        let tracked = followed.and_then(|f| f.tracker.of_kinds::<TrackedMeshes>());
        tracked.into_iter().flat_map(|tracked| tracked.tracker.front())
    }

    /// Returns the front that is kept of two surfaces of patches: pairs of parts of A and of B that
    /// are proven apart. Empty for surfaces other than those of the last query.
    #[cfg(feature = "surfaces")]
    #[must_use]
    pub fn surface_front(&self, a: &Surface, b: &Surface) -> Vec<[SurfacePart; 2]> {
        let followed = self.followed.as_ref();
        let tracked = followed.and_then(|f| f.tracker.of_kinds::<TrackedSurfaces>());
        tracked.map(|t| t.tracker.front(a, b).collect()).unwrap_or_default()
    }

    /// Returns the bytes that the tracker keeps on the heap, without those of stand-ins and
    /// contacts.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        self.followed.as_ref().map_or(0, |f| f.tracker.heap_bytes())
    }

    /// Returns the first broken invariant of what is kept: a tool of tests and fuzzing. The front
    /// of two meshes is compared with all vertices, at the pose of the last
    /// [`closest`](Self::closest), in time that is entries times triangles.
    ///
    /// # Errors
    /// A text that names the broken invariant.
    pub fn check<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Result<(), String> {
        self.pair(a.into(), b.into()).check(a_from_b)
    }
}

impl Replay {
    /// Returns a tracker of [`shapes`](Self::shapes) with the recorded start.
    #[must_use]
    pub fn pair_tracker(&self) -> PairTracker {
        let [a, b] = self.shapes();
        let mut tracker = PairTracker::new();
        tracker.of((&a).into(), (&b).into()).tracker.begin_as(self);
        tracker
    }
}
