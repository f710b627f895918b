//! A point that moves little from query to query.

use nalgebra::Point3;

use super::{PointError, PointMemory, PointQuery, check};
use crate::pair::point::PointOutcome;
use crate::pair_tracker::PairTracker;
#[cfg(feature = "meshes")]
use crate::pair_tracker::geometry::Borrowed;

/// The state of a point that moves little between queries of one geometry.
///
/// For meshes, each search starts with the last closest triangle, and a point that did not reach
/// the surface keeps its side; the answers have the bits of [`PointQuery::closest_point`]. For
/// other kinds the tracker keeps the state of a [`PairTracker`]. The state changes the time of a
/// query, never the answer: a tracker may be used with any [`PointQuery`].
///
/// ```
/// use lin_canny::nalgebra::Point3;
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Mesh, PointQuery, PointTracker};
///
/// let ball = Mesh::from_convex(&solids::icosahedron(1.0)?)?;
/// let query = PointQuery::new(&ball);
/// let mut tracker = PointTracker::new();
/// for k in 0..100 {
///     let p = Point3::new(0.03 * f64::from(k), 0.1, 0.0);
///     assert_eq!(tracker.closest_point(&query, &p)?, query.closest_point(&p)?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct PointTracker {
    memory: PointMemory,
    pair: PairTracker,
}

impl PointTracker {
    /// Returns a tracker that starts cold.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the closest point and the signed distance, as [`PointQuery::closest_point`] does.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    pub fn closest_point(&mut self, query: &PointQuery<'_>, point: &Point3<f64>) -> Result<PointOutcome, PointError> {
        check(0, point)?;
        Ok(match query.geometry.0 {
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(_) | Borrowed::Compound(_) | Borrowed::Cloud(_) => query.ask(point, &mut self.memory),
            _ => query.ask_pair(point, &mut self.pair),
        })
    }
}
