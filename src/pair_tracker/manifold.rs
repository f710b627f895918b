//! The contact manifold of two convex geometries.

use super::tracker::PairTracker;
use crate::base::pose::RelativePose;
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::pair_tracker::geometry::{GeometryRef, ShapeKind};

/// Two geometries of these kinds do not have what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a {a} and a {b} have no {asked}")]
pub struct PairError {
    /// The kind of A.
    pub a: ShapeKind,
    /// The kind of B.
    pub b: ShapeKind,
    /// What was asked for.
    pub asked: &'static str,
}

impl PairTracker {
    /// Computes the contact points of two convex geometries within `options.prediction`, in
    /// `manifold`, which keeps ids and order of the contacts of the previous query: one manifold
    /// for each pair, passed in every frame. [`contacts`](Self::contacts) returns them for all
    /// kinds.
    ///
    /// Rounded polyhedra have the contacts of their cores, moved out by the radii along the normal.
    /// Curved shapes bear contacts by their flat round faces and straight generators within
    /// `options.sine` of the normal; an ellipsoid, a superquadric, or a rim or apex without such a
    /// face has one contact, the witnesses.
    ///
    /// Contacts of a flat round face are eight points of its rim at multiples of 45 degrees, as far
    /// as they are over the other shape, and the crossings of the rim with the boundary of the
    /// other face. They stand still on a shape that trembles: if the shapes are tilted by less than
    /// some 2e-4, the deepest contact may be shallower than [`closest`](Self::closest) by `2^-16`
    /// times the radius of the smaller shape. As features, the points of the upper rim of a
    /// cylinder are vertices 0 to 7, of the lower rim 8 to 15, and of the rim of a cone 1 to 8; the
    /// second crossing of an edge with a rim is named by the face instead of the rim.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Manifold, ManifoldOptions, PairTracker, RelativePose, Shape};
    ///
    /// let floor = Shape::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let can = Shape::cylinder(0.5, 0.25)?;
    /// let at = RelativePose::from_isometry(&Isometry3::translation(1.0, 2.0, 1.51))?;
    /// let (mut tracker, mut manifold) = (PairTracker::new(), Manifold::new());
    /// let options = ManifoldOptions::within(0.02);
    /// tracker.manifold(&floor, &can, &at, &options, &mut manifold)?;
    /// assert_eq!(manifold.points().len(), 4);
    /// assert!(manifold.points().iter().all(|p| (p.separation - 0.01).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If one of both is not convex.
    pub fn manifold<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) -> Result<(), PairError> {
        let bodies = [a.into(), b.into()];
        if self.pair(bodies).manifold(a_from_b, options, manifold) {
            Ok(())
        } else {
            Err(refused(bodies, "manifold"))
        }
    }
}

pub(super) fn refused(bodies: [GeometryRef<'_>; 2], asked: &'static str) -> PairError {
    let [a, b] = bodies.map(GeometryRef::kind);
    PairError { a, b, asked }
}
