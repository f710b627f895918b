//! A mesh against itself.

use alloc::vec::Vec;

use super::parted::TrackedMeshes;
use super::tracker::PairTracker;
use crate::composite::mesh::Mesh;
use crate::composite::separation::MeshPair;
use crate::pair::outcome::Decision;
use crate::pair::spot::Answer;

impl PairTracker {
    fn ask_self<R>(&mut self, mesh: &Mesh, ask: impl FnOnce(MeshPair<'_>) -> R) -> Option<R> {
        let mut pair = self.pair(mesh.into(), mesh.into());
        pair.of_kinds::<TrackedMeshes>().map(ask)
    }

    /// Returns the closest two triangles of a mesh that share no vertex: how far the mesh is from a
    /// self-collision. `None` if any two of its triangles share a vertex.
    ///
    /// Triangles that share a vertex always touch there, and are left out. Vertices are those of
    /// the mesh: welded points are one, and vertices that
    /// [`set_vertices`](Mesh::set_vertices) moves to one place remain two, so that triangles about
    /// them touch. A mesh in contact with itself is [`Touching`](crate::Class::Touching), whether
    /// or not its triangles cross. The points and the normal are in the frame of the mesh, and the
    /// bounds are as close as those of two meshes.
    ///
    /// The tracker keeps what the search has proven while the vertices move; the claims of a mesh
    /// of 20,000 triangles take some megabytes. A mesh whose triangles are of one size has many
    /// pairs that are nearly as near as the closest: those with one triangle between them. A fold
    /// that is nearer than these takes less time.
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{Class, Mesh, PairTracker};
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
    /// assert!(folded.class == Class::Separated && folded.distance <= 0.125);
    /// // Triangles that lie over each other, by the indices of the caller.
    /// assert!(tracker.self_pairs(&strip, 0.2).iter().all(|pair| {
    ///     let [p, q] = pair.on.map(|spot| spot.part);
    ///     (p < 10) != (q < 10)
    /// }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "self-collision")]
    #[doc(alias = "self-intersection")]
    pub fn self_closest(&mut self, mesh: &Mesh) -> Option<Answer> {
        self.ask_self(mesh, |pair| pair.tracker.self_closest(mesh))?
    }

    /// Returns whether two triangles of a mesh that share no vertex are at most `d` apart, in the
    /// caller's unit, and stops at the first; no for a negative `d` and NaN. Exact with the feature
    /// `exact`; without it ties count as within. For a `d` of zero: whether the mesh intersects
    /// itself.
    ///
    /// Triangles are left out as told at [`self_closest`](Self::self_closest).
    #[doc(alias = "self-intersection")]
    pub fn self_within(&mut self, mesh: &Mesh, d: f64) -> Decision {
        Decision::of(self.ask_self(mesh, |pair| pair.tracker.self_within(mesh, d)) == Some(true))
    }

    /// Returns all pairs of triangles of a mesh that share no vertex and are at most `d` apart, in
    /// the caller's unit, each once and in no order: with the closest points, bounds, and the
    /// triangles by the caller's indices ([`Answer::on`]). Which pairs are returned is exact with
    /// the feature `exact`; without it ties count as within. None for a negative `d` and NaN.
    ///
    /// Triangles are left out as told at [`self_closest`](Self::self_closest). If `d` exceeds the
    /// heights of the triangles, the pairs that have one triangle between them are among those
    /// returned: some ten for each triangle.
    #[doc(alias = "self-collision")]
    pub fn self_pairs(&mut self, mesh: &Mesh, d: f64) -> Vec<Answer> {
        self.ask_self(mesh, |pair| pair.tracker.self_pairs(mesh, d))
            .unwrap_or_default()
    }
}
