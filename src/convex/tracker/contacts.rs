//! From an answer, or from the previous manifold, to the present contacts.

use super::Tracker;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::convex::contact::{Manifold, ManifoldOptions, Query};

impl Tracker {
    /// Computes the contact points of two bodies within `options.prediction`, in `manifold`, which
    /// keeps ids and order of the contacts of the previous query: one manifold for each pair,
    /// passed in every frame.
    ///
    /// If the bodies have moved no more than `options.drift` since the manifold was made, its
    /// points stay fixed to the bodies and only their separations, the normal and the bounds are
    /// measured again; otherwise the manifold is rebuilt from [`closest`](Self::closest), and its
    /// deepest contact is the contact of the answer.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Manifold, ManifoldOptions, RelativePose, Tracker};
    ///
    /// let floor = solids::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let part = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    /// let options = ManifoldOptions::within(0.02);
    /// for k in 0..10 {
    ///     let at = Isometry3::translation(0.1 * k as f64, 0.0, 1.49);
    ///     let a_from_b = RelativePose::from_isometry(&at)?;
    ///     pair.manifold(&floor, &part, &a_from_b, &options, &mut manifold);
    ///     assert_eq!(manifold.points().len(), 4);
    ///     for contact in manifold.points() {
    ///         let (id, point) = (contact.id, contact.point_on_a);
    ///         println!("{id}: {:.3} at {point}", contact.separation);
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
            let outcome = match options.local_depth {
                false => self.closest(a, b, a_from_b),
                true => self.closest_with_local_depth(a, b, a_from_b),
            };
            manifold.renew(&query, &outcome, moved);
        }
    }
}
