//! Questions that only meshes and surfaces answer: a mesh against itself, a mesh by the pieces that
//! stand for it.

use alloc::vec::Vec;

use super::engine::Engine;
use super::lent_pair::LentPair;
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
    /// Returns the closest two triangles of a mesh that share no vertex: how far the mesh is from a
    /// self-collision. `None` if any two of its triangles share a vertex.
    ///
    /// Triangles that share a vertex always touch there, and are left out. Vertices are those of
    /// the mesh: welded points are one, and vertices that
    /// [`set_vertices`](Mesh::set_vertices) moves to one place remain two, so that triangles about
    /// them touch. A mesh in contact with itself is [`Touching`](crate::ContactState::Touching),
    /// whether or not its triangles cross. The points and the normal are in the frame of the mesh,
    /// and the bounds are as close as those of two meshes.
    ///
    /// The tracker keeps what the search has proven while the vertices move; the claims of a mesh
    /// of 20,000 triangles take some megabytes. A mesh whose triangles are of one size has many
    /// pairs that are nearly as near as the closest: those with one triangle between them. A fold
    /// that is nearer than these takes less time.
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

    /// Returns whether two triangles of a mesh that share no vertex are at most `d` apart, in the
    /// caller's unit, and stops at the first; no for a negative `d` and NaN. Exact with the feature
    /// `exact`; without it ties count as within. For a `d` of zero: whether the mesh intersects
    /// itself.
    ///
    /// Triangles are left out as told at [`self_closest`](Self::self_closest).
    #[doc(alias = "self-intersection")]
    pub fn self_within(&mut self, mesh: &Mesh, d: f64) -> bool {
        self.self_tracker(mesh)
            .is_some_and(|tracker| tracker.self_within(mesh, d))
    }

    /// Returns all pairs of triangles of a mesh that share no vertex and are at most `d` apart, in
    /// the caller's unit, each once and in no order: with the closest points, bounds, and the
    /// triangles by the caller's indices ([`PairOutcome::locations`]). Which pairs are returned is
    /// exact with the feature `exact`; without it ties count as within. None for a negative `d` and
    /// NaN.
    ///
    /// Triangles are left out as told at [`self_closest`](Self::self_closest). If `d` exceeds the
    /// heights of the triangles, the pairs that have one triangle between them are among those
    /// returned: some ten for each triangle.
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

    /// Measures two bodies of parts, the first of which is a compound that stays one beside a
    /// mesh.
    fn distance_by_pieces(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        a_from_b: &RelativePose,
        bounds: impl FnOnce(&PairOutcome, &PartsRef<'_>) -> Distance,
    ) -> Distance {
        let pair = bodies.each(|body| body.fingerprint().with(*b"pieces  ", 0.0));
        let followed = self.follow_by(pair, || of_pieces(bodies));
        match followed.engine.lend(bodies) {
            LentPair::Pieces(CompoundPair { a, b, tracker }) => bounds(&tracker.closest(&a, &b, a_from_b), &b),
            mut other => Distance::from(&other.closest_with(a_from_b, &QueryOptions::new())),
        }
    }
}

impl Decomposition {
    /// Returns bounds of the distance of the mesh from another geometry, by the distance of the
    /// pieces.
    ///
    /// If the bounds leave open whether the bodies meet, the contact state is
    /// [`ContactState::Undecided`](crate::ContactState::Undecided); no depth is told. A surface of
    /// patches is measured against the mesh.
    pub fn distance<'g>(
        &'g self,
        tracker: &mut PairTracker,
        other: impl Into<GeometryRef<'g>>,
        mesh_from_other: &RelativePose,
    ) -> Distance {
        let other = other.into();
        let pieces = GeometryRef::from(self.pieces());
        if other.kind() == GeometryKind::BezierSurface {
            return tracker.distance(self.mesh(), other, mesh_from_other);
        }
        tracker.distance_by_pieces([pieces, other], mesh_from_other, |found, other| {
            self.bounds(found, other, mesh_from_other)
        })
    }
}

/// The fronts that are kept, to be drawn.
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
        /// Returns the front that is kept of two meshes: pairs of nodes of the trees of A and of B
        /// that are proven farther apart than the distance.
        /// [`Mesh::node_box`](crate::Mesh::node_box) returns their boxes. Empty for other
        /// geometries.
        pub fn mesh_front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
            let tracker = match self.followed.as_ref().map(|followed| &followed.engine) {
                Some(Engine::Meshes(engine)) => Some(&engine.tracker),
                _ => None,
            };
            tracker.into_iter().flat_map(MeshTracker::front)
        }

        /// Returns the front that is kept of two Bézier surfaces: pairs of parts of A and of B
        /// that are proven apart. Empty for surfaces other than those of the last query.
        #[cfg(feature = "surfaces")]
        #[must_use]
        pub fn surface_front(&self, a: &BezierSurface, b: &BezierSurface) -> Vec<[SurfacePart; 2]> {
            match self.followed.as_ref().map(|followed| &followed.engine) {
                Some(Engine::Surfaces(engine)) => engine.tracker.front(a, b).collect(),
                _ => Vec::new(),
            }
        }
    }
}
