//! Queries that only meshes and surfaces answer: a mesh against itself, and a mesh by the pieces
//! that replace it.

use alloc::vec::Vec;

use super::borrowed_pair::BorrowedPair;
use super::engine::Engine;
use super::of_parts::of_pieces;
use super::tracker::PairTracker;
use crate::base::num::each::Each;
use crate::base::pose::RelativePose;
use crate::nonconvex::decomposition::Decomposition;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::PartsRef;
use crate::nonconvex::separation::CompoundPair;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::Distance;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};

impl PairTracker {
    /// Returns the closest two triangles of a mesh that share no vertex.
    ///
    /// Their distance is the distance of the mesh from a self-collision. `None` if any two of its
    /// triangles share a vertex.
    ///
    /// Triangles that share a vertex always touch there and are left out. Vertices are the vertices
    /// of the mesh, so welded points are one vertex. Vertices that
    /// [`set_vertices`](Mesh::set_vertices) moves to the same position remain two, so triangles
    /// around them touch. A mesh in contact with itself is
    /// [`Touching`](crate::ContactState::Touching), whether or not its triangles cross. The points
    /// and the normal are in the frame of the mesh, and the bounds are as close as the bounds of
    /// two meshes.
    ///
    /// The tracker keeps what the search has proven while the vertices move. For a mesh of 20,000
    /// triangles, this cache takes some megabytes. If all triangles are about the same size, many
    /// pairs with one triangle between them are nearly as close as the closest pair, and the query
    /// is slow. A fold closer than these makes it faster.
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{ContactState, Mesh, PairTracker};
    ///
    /// // A strip of ten squares along x.
    /// let at = |k: i32| Point3::new(f64::from(k / 2), f64::from(k % 2), 0.0);
    /// let points: Vec<_> = (0..22).map(at).collect();
    /// let square = |k: u32| [[k, k + 2, k + 3], [k, k + 3, k + 1]];
    /// let triangles: Vec<_> = (0..10).flat_map(|k| square(2 * k)).collect();
    /// let mut strip = Mesh::new(&points, &triangles)?;
    /// let mut tracker = PairTracker::new();
    /// let flat = tracker.self_closest(&strip).expect("ten squares");
    /// assert!((flat.distance - 0.5f64.sqrt()).abs() < 1e-12);
    ///
    /// // Its right half is folded over the left, 0.125 above it.
    /// let fold = |p: &Point3<f64>| match p.x > 5.0 {
    ///     true => Point3::new(10.0 - p.x, p.y, 0.125),
    ///     false => *p,
    /// };
    /// strip.set_vertices(&points.iter().map(fold).collect::<Vec<_>>())?;
    /// let folded = tracker.self_closest(&strip).expect("ten squares");
    /// assert!(folded.state == ContactState::Separated && folded.distance <= 0.125);
    /// // Triangles that lie over each other, by the indices of the caller.
    /// assert!(tracker.self_pairs(&strip, 0.2).iter().all(|pair| {
    ///     let [p, q] = pair.locations.map(|at| at.subshape);
    ///     (p < 10) != (q < 10)
    /// }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "self-collision")]
    #[doc(alias = "self-intersection")]
    pub fn self_closest(&mut self, mesh: &Mesh) -> Option<PairOutcome> {
        self.self_tracker(mesh)?.self_closest(mesh)
    }

    /// Returns whether two triangles without a common vertex are at most `d` apart.
    ///
    /// `d` is in the caller's unit; the answer is no for a negative `d` and for NaN. The search
    /// stops at the first such pair. Exact with the feature `exact`; without it ties count as
    /// within. With a `d` of zero this is whether the mesh intersects itself.
    ///
    /// Leaves out the same triangles as [`self_closest`](Self::self_closest).
    #[doc(alias = "self-intersection")]
    pub fn self_within(&mut self, mesh: &Mesh, d: f64) -> bool {
        self.self_tracker(mesh)
            .is_some_and(|tracker| tracker.self_within(mesh, d))
    }

    /// Returns all pairs of triangles without a common vertex at most `d` apart.
    ///
    /// `d` is in the caller's unit; a negative `d` and NaN return no pair. Each pair is returned
    /// once, in no order, with the closest points, the bounds, and the triangles by the caller's
    /// indices ([`PairOutcome::locations`]). Which pairs are returned is exact with the feature
    /// `exact`; without it ties count as within.
    ///
    /// Leaves out the same triangles as [`self_closest`](Self::self_closest). If `d` exceeds the
    /// heights of the triangles, the result contains the pairs that have one triangle between them:
    /// about ten per triangle.
    #[doc(alias = "self-collision")]
    pub fn self_pairs(&mut self, mesh: &Mesh, d: f64) -> Vec<PairOutcome> {
        self.self_tracker(mesh)
            .map(|tracker| tracker.self_pairs(mesh, d))
            .unwrap_or_default()
    }

    fn self_tracker(&mut self, mesh: &Mesh) -> Option<&mut MeshTracker> {
        match &mut self.follow([mesh.into(); 2]).engine {
            Engine::Meshes(engine) => Some(&mut engine.tracker),
            _ => None,
        }
    }

    /// Measures two bodies of subshapes; the first is a compound that stays a compound against a
    /// mesh.
    fn distance_by_pieces(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        a_from_b: &RelativePose,
        bounds: impl FnOnce(&PairOutcome, &PartsRef<'_>) -> Distance,
    ) -> Distance {
        let pair = bodies.each(|body| body.fingerprint().with(*b"pieces  ", 0.0));
        let followed = self.follow_by(pair, || of_pieces(bodies));
        match followed.engine.borrow(bodies) {
            BorrowedPair::Pieces(CompoundPair { a, b, tracker }) => bounds(&tracker.closest(&a, &b, a_from_b), &b),
            mut other => Distance::from(&other.closest_with(a_from_b, &QueryOptions::default())),
        }
    }
}

impl Decomposition {
    /// Returns bounds of the mesh's distance from another geometry, measured by the pieces.
    ///
    /// If the bounds do not decide whether the bodies meet, the contact state is
    /// [`ContactState::Undecided`](crate::ContactState::Undecided). No depth is returned. A Bézier
    /// surface or a half-space is measured against the mesh.
    pub fn distance<'g>(
        &'g self,
        tracker: &mut PairTracker,
        other: impl Into<GeometryRef<'g>>,
        mesh_from_other: &RelativePose,
    ) -> Distance {
        let other = other.into();
        let pieces = GeometryRef::from(self.pieces());
        if matches!(other.kind(), GeometryKind::BezierSurface | GeometryKind::HalfSpace) {
            return tracker.distance(self.mesh(), other, mesh_from_other);
        }
        tracker.distance_by_pieces([pieces, other], mesh_from_other, |found, other| {
            self.bounds(found, other, mesh_from_other)
        })
    }
}

/// The cached fronts, for drawing.
#[cfg(feature = "__internals")]
mod fronts {
    use alloc::vec::Vec;

    use crate::nonconvex::mesh::tracker::MeshTracker;
    use crate::pair_tracker::PairTracker;
    use crate::pair_tracker::engine::Engine;
    #[cfg(feature = "surfaces")]
    use crate::surface::{BezierSurface, SurfacePart};

    #[doc(hidden)]
    impl PairTracker {
        /// Returns the cached front of two meshes; empty for other geometries.
        ///
        /// An entry is a pair of nodes of the trees of A and B that are proven farther apart than
        /// the distance. [`Mesh::node_box`](crate::Mesh::node_box) returns their boxes.
        pub fn mesh_front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
            let tracker = match self.followed.as_ref().map(|followed| &followed.tracked.engine) {
                Some(Engine::Meshes(engine)) => Some(&engine.tracker),
                _ => None,
            };
            tracker.into_iter().flat_map(MeshTracker::front)
        }

        /// Returns the cached front of two Bézier surfaces: pairs of nodes of A and B that are
        /// proven apart.
        ///
        /// Empty if the last query was of other surfaces.
        #[cfg(feature = "surfaces")]
        #[must_use]
        pub fn surface_front(&self, a: &BezierSurface, b: &BezierSurface) -> Vec<[SurfacePart; 2]> {
            match self.followed.as_ref().map(|followed| &followed.tracked.engine) {
                Some(Engine::Surfaces(engine)) => engine.tracker.front(a, b).collect(),
                _ => Vec::new(),
            }
        }
    }
}
