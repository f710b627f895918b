//! From an answer, or from the manifold before, to the contacts of now.

use super::Tracker;
use crate::contact::{Manifold, ManifoldOptions, Query};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;

impl Tracker {
    /// The contact points of two bodies within `options.prediction`, in `manifold`, which keeps names and order of those that were
    /// there in the query before: one manifold for each pair, passed in every frame.
    ///
    /// Where the bodies have moved no more than `options.drift` since it was made, its points stay where they are on the bodies and only
    /// their separations, the normal and the bounds are measured anew; otherwise it is made from [`closest`](Self::closest), and its
    /// deepest contact is the answer's.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Manifold, ManifoldOptions, RelativePose, Tracker, polyhedron::solids};
    ///
    /// let (floor, part) = (solids::cuboid(Vector3::new(5.0, 5.0, 1.0))?, solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?);
    /// let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    /// let options = ManifoldOptions::within(0.02);
    /// for k in 0..10 {
    ///     let a_from_b = RelativePose::from_isometry(&Isometry3::translation(0.1 * k as f64, 0.0, 1.49))?;
    ///     pair.manifold(&floor, &part, &a_from_b, &options, &mut manifold);
    ///     assert_eq!(manifold.points().len(), 4);
    ///     for contact in manifold.points() {
    ///         println!("{}: {:.3} at {}", contact.id, contact.separation, contact.point_on_a);
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn manifold(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) {
        let query = Query::new(a, b, a_from_b, options);
        if let Err(moved) = manifold.refresh(&query) {
            let outcome = self.closest(a, b, a_from_b);
            manifold.renew(&query, &outcome, moved);
        }
    }
}
