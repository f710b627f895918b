//! Points and one geometry of any kind: closest point, side, signed distance, near subshapes.
//!
//! ```text
//! PointQuery     which kind; polyhedra, half-spaces and curved shapes   mod.rs
//!   batch        many points, in Morton order                           batch.rs
//!   grid         signed distances at the nodes of a grid                grid.rs
//! PointTracker   a point that moves little                              tracker.rs
//! cover          balls around a geometry, and inside                    cover/
//! ```
//!
//! Meshes, compounds and clouds search their trees (`nonconvex/point.rs`,
//! `nonconvex/near_parts.rs`), and faces are tried one by one (`nonconvex/near_faces.rs`). The
//! other kinds are pairs with a point, which is exact: its pose is a translation.

mod batch;
pub mod cover;
mod grid;
mod tracker;

#[cfg(feature = "meshes")]
use alloc::vec::Vec;

use nalgebra::{Isometry3, Point3};

use crate::base::callbacks::Stopped;
use crate::base::pose::RelativePose;
use crate::base::tolerance::PLACE_MAX;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Shape};
#[cfg(feature = "meshes")]
use crate::nonconvex::point::MeshMemory;
#[cfg(feature = "meshes")]
use crate::nonconvex::simple_surface::SimpleSurface;
#[cfg(feature = "meshes")]
use crate::nonconvex::{near_faces, near_parts};
use crate::pair::outcome::{ContactState, Distance};
use crate::pair::point::PointOutcome;
use crate::pair_tracker::PairTracker;
use crate::pair_tracker::geometry::{Borrowed, GeometryKind, GeometryRef};
pub use grid::DistanceGrid;
pub use tracker::PointTracker;

/// Error returned if a query point or a grid is invalid, or if the caller stops a call.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// A coordinate is not finite, or its absolute value is 1e116 or more.
    #[error("point {index} is not finite or farther than 1e116 from the origin: {value:?}")]
    OutOfRange {
        /// Index of the point in a batch; zero for a single point.
        index: usize,
        /// The coordinates.
        value: [f64; 3],
    },
    /// A grid has no cell along an axis, no extent, or more than 2^31 nodes.
    #[error(
        "grid has {cells} cells over a side of {side} along axis {axis} (expected a cell, an extent, at most 2^31 nodes)"
    )]
    Grid {
        /// The axis, 0 to 2.
        axis: usize,
        /// Number of cells along the axis.
        cells: usize,
        /// Extent along the axis.
        side: f64,
    },
    /// The geometry has no winding number: it is curved, a union, infinite, or an open mesh.
    #[error("this {kind} has no winding number (expected a polyhedron or a closed mesh)")]
    NoWinding {
        /// The kind of the geometry.
        kind: GeometryKind,
    },
    /// The caller stopped the call through its callback.
    #[error("the caller has stopped the call")]
    Stopped,
}

impl From<Stopped> for PointError {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

/// Queries of points and one geometry of any kind, which it borrows.
///
/// Points are in the frame of the geometry: for a body at a pose, pass
/// `pose.inverse_transform_point(&p)`. Coordinates below 2^-200 of the size of the geometry count
/// as zero.
///
/// The signed distance is positive outside and negative inside. Its sign is proven by the state,
/// and its value by two bounds:
///
/// | geometry | side | width of the bounds |
/// |---|---|---|
/// | polyhedron | exact | `1e-13 L` |
/// | rounded polyhedron | exact outside (feature `exact`), else by the bounds | `1e-13 L` |
/// | curved shape | by the bounds: undecided within rounding | `1e-13 L`; inside `2^-19 L` |
/// | mesh | exact | `2e-14 L` |
/// | half-space | exact | `1e-14` of the distance |
/// | compound, cloud | that of its pieces | outside that of its pieces; inside see below |
/// | Bézier surface | outside or undecided: it has no inside | that of [`PairTracker::closest`] |
///
/// L is the size of the geometry plus the distance of the point; for pieces of compounds and
/// elements of clouds it is the pair size (see the [front page](crate)). Exceptions:
///
/// - **Meshes.** A closed mesh contains the points with a winding number that is not zero, and its
///   surface. An [open mesh](crate::MeshKind::Open) contains only its surface. The distance is that
///   of the triangles, also of those inside other components.
/// - **Compounds and clouds** are unions. Inside, the upper bound of the signed distance is that of
///   the deepest piece, which is also the value returned. The union may be deeper, so the lower
///   bound is that of the box of the union. Both are proven, and they may be far apart.
///
/// ```
/// use lin_canny::nalgebra::{Point3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{ContactState, Mesh, PointQuery};
///
/// let cube = Mesh::from_convex(&solids::cuboid(Vector3::repeat(1.0))?)?;
/// let query = PointQuery::new(&cube);
/// let found = query.closest_point(&Point3::new(0.25, 0.5, 3.0))?;
/// assert_eq!(found.state, ContactState::Separated);
/// assert!(found.lower <= 2.0 && 2.0 <= found.upper);
/// assert_eq!(found.normal, Vector3::z_axis());
/// // One step of the last place next to a face: the side is exact.
/// assert!(query.contains(&Point3::new(0.1, 0.2, 1.0))?);
/// assert!(!query.contains(&Point3::new(0.1, 0.2, 1.0_f64.next_up()))?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "proximity")]
#[doc(alias = "signed distance field")]
#[doc(alias = "winding number")]
#[doc(alias = "inside")]
#[derive(Clone, Debug)]
pub struct PointQuery<'g> {
    pub(crate) geometry: GeometryRef<'g>,
    /// A point at the origin.
    origin: ConvexPolyhedron,
    /// Set if the surface of a mesh is proven simple.
    #[cfg(feature = "meshes")]
    surface: Option<SimpleSurface>,
}

/// Room of queries, reused from point to point.
#[derive(Clone, Debug, Default)]
pub(crate) struct PointMemory {
    #[cfg(feature = "meshes")]
    mesh: MeshMemory,
}

impl<'g> PointQuery<'g> {
    /// Returns the queries of a geometry: a [`Geometry`](crate::Geometry) or a body of any kind.
    ///
    /// The call does no work that depends on the size of the geometry.
    #[must_use]
    pub fn new(geometry: impl Into<GeometryRef<'g>>) -> Self {
        Self {
            geometry: geometry.into(),
            origin: ConvexPolyhedron::origin(),
            #[cfg(feature = "meshes")]
            surface: None,
        }
    }

    /// Returns the queries after work that makes many points of a closed mesh faster.
    ///
    /// The call tests whether the surface meets itself, in a few microseconds per triangle. If it
    /// is proven that it does not, the side of most points follows from the closest triangles. The
    /// answers are the same with and without this call. Batches of more than 16 points per
    /// triangle make it themselves. For other kinds of geometry the call does nothing.
    #[must_use]
    pub fn prepared(self) -> Self {
        #[cfg(feature = "meshes")]
        if let (None, Some(mesh)) = (&self.surface, self.geometry.mesh()) {
            let surface = SimpleSurface::new(mesh);
            return Self { surface, ..self };
        }
        self
    }

    /// Returns the closest point of the surface and the signed distance with its bounds.
    ///
    /// If several points are equally close, the result is one of them.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    #[doc(alias = "nearest")]
    #[doc(alias = "project")]
    pub fn closest_point(&self, point: &Point3<f64>) -> Result<PointOutcome, PointError> {
        check(0, point)?;
        Ok(self.ask(point, &mut PointMemory::default()))
    }

    /// Returns whether the geometry contains a point; its surface counts.
    ///
    /// The result is exact for polyhedra, meshes and half-spaces, and for rounded polyhedra with
    /// the feature `exact`. For a curved shape a point within rounding of the surface counts as
    /// contained. A compound or a cloud contains the points of its pieces.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    #[doc(alias = "point in polyhedron")]
    pub fn contains(&self, point: &Point3<f64>) -> Result<bool, PointError> {
        check(0, point)?;
        Ok(self.holds(point, &mut PointMemory::default()))
    }

    /// Returns how many times the surface winds around a point, or `None` on the surface.
    ///
    /// The number is exact. It is 0 outside, and 1 inside of a solid whose triangles face outward.
    /// It is 2 where two components overlap, and negative where a component faces inward. A mesh
    /// with holes has winding numbers once it is [repaired](crate::Mesh::repaired).
    ///
    /// # Errors
    ///
    /// Returns an error if the geometry is neither a polyhedron nor a closed mesh, if a coordinate
    /// is not finite, or if its absolute value is 1e116 or more.
    #[doc(alias = "generalized winding number")]
    pub fn winding_number(&self, point: &Point3<f64>) -> Result<Option<i32>, PointError> {
        check(0, point)?;
        self.check_winding()?;
        Ok(self.winding(point))
    }

    /// Returns the signed distance and its bounds, without the closest point.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    pub fn signed_distance(&self, point: &Point3<f64>) -> Result<Distance, PointError> {
        Ok(Distance::from(&self.closest_point(point)?))
    }

    /// Returns the `count` subshapes nearest to a point, in rising order of their upper bounds.
    ///
    /// Subshapes are the triangles of a mesh, the faces of a polyhedron, the pieces of a compound
    /// and the elements of a cloud; any other geometry is one. Equal bounds are in the order of the
    /// indices ([`WitnessLocation::subshape`](crate::WitnessLocation::subshape)). The distance of a
    /// piece or element is signed. The distance of a triangle or face is not: no point is inside.
    ///
    /// The time for a polyhedron is proportional to its faces.
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{Cloud, CloudElement, PointQuery};
    ///
    /// let points: Vec<_> = (0..10u8)
    ///     .map(|k| Point3::new(f64::from(k), 0.0, 0.0))
    ///     .collect();
    /// let cloud = Cloud::new(&points, CloudElement::Ball(0.25))?;
    /// let query = PointQuery::new(&cloud);
    /// let p = Point3::new(3.125, 0.0, 0.0);
    /// let near = query.nearest_features(&p, 2)?;
    /// assert_eq!(near[0].location.subshape, 3);
    /// assert_eq!(near[1].location.subshape, 4);
    /// assert_eq!(query.within(&p, 0.9)?.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    #[cfg(feature = "meshes")]
    #[doc(alias = "k nearest neighbours")]
    pub fn nearest_features(&self, point: &Point3<f64>, count: usize) -> Result<Vec<PointOutcome>, PointError> {
        check(0, point)?;
        Ok(match self.geometry.0 {
            Borrowed::Mesh(mesh) => near_parts::nearest(mesh.get(), point, count),
            Borrowed::Compound(body) => near_parts::nearest(body.get(), point, count),
            Borrowed::Cloud(body) => near_parts::nearest(body.get(), point, count),
            _ => {
                let mut all = self.few_features(point);
                all.truncate(count);
                all
            }
        })
    }

    /// Returns all subshapes that may be at most `d` from a point, in rising order of their upper
    /// bounds.
    ///
    /// A subshape is left out if its lower bound is above `d`; so ties count as within. The rest is
    /// as in [`nearest_features`](Self::nearest_features).
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, or its absolute value is 1e116 or more.
    #[cfg(feature = "meshes")]
    pub fn within(&self, point: &Point3<f64>, d: f64) -> Result<Vec<PointOutcome>, PointError> {
        check(0, point)?;
        Ok(match self.geometry.0 {
            Borrowed::Mesh(mesh) => near_parts::within(mesh.get(), point, d),
            Borrowed::Compound(body) => near_parts::within(body.get(), point, d),
            Borrowed::Cloud(body) => near_parts::within(body.get(), point, d),
            _ => {
                let mut all = self.few_features(point);
                all.retain(|found| found.lower <= d);
                all
            }
        })
    }

    /// Returns the faces of a polyhedron, or the geometry as its only subshape.
    #[cfg(feature = "meshes")]
    fn few_features(&self, point: &Point3<f64>) -> Vec<PointOutcome> {
        let body = self.geometry.polyhedron();
        let faces = body.and_then(|body| near_faces::outcomes_of_faces(body, point));
        faces.unwrap_or_else(|| alloc::vec![self.ask(point, &mut PointMemory::default())])
    }

    /// Returns the work of a query of a mesh, counted: leaves of the tree that the search visits,
    /// and triangles that the ray of the winding number tests.
    #[cfg(all(feature = "__internals", feature = "meshes"))]
    #[doc(hidden)]
    #[must_use]
    pub fn work(&self, point: &Point3<f64>) -> Option<[usize; 2]> {
        check(0, point).ok()?;
        Some(self.geometry.mesh()?.work_of_point(point))
    }

    fn ask(&self, point: &Point3<f64>, memory: &mut PointMemory) -> PointOutcome {
        let _ = &memory;
        match self.geometry.0 {
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(mesh) => mesh.get().outcome_of(point, self.surface.as_ref(), &mut memory.mesh),
            #[cfg(feature = "meshes")]
            Borrowed::Compound(body) => near_parts::outcome_of_union(body.get(), point),
            #[cfg(feature = "meshes")]
            Borrowed::Cloud(body) => near_parts::outcome_of_union(body.get(), point),
            Borrowed::HalfSpace(space) => space.get().outcome_of(point),
            _ => self.ask_pair(point, &mut PairTracker::new()),
        }
    }

    fn holds(&self, point: &Point3<f64>, memory: &mut PointMemory) -> bool {
        match self.geometry.0 {
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(mesh) => mesh.get().contains_point(point),
            Borrowed::Polyhedron(body) => body.get().contains(point),
            Borrowed::Convex(shape) => holds(shape.get(), &self.origin, point),
            _ => self.ask(point, memory).is_contained(),
        }
    }

    /// Returns an error if the geometry has no winding number.
    fn check_winding(&self) -> Result<(), PointError> {
        match self.geometry.0 {
            Borrowed::Polyhedron(_) => Ok(()),
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(mesh) if mesh.get().is_solid() => Ok(()),
            _ => Err(PointError::NoWinding {
                kind: self.geometry.kind(),
            }),
        }
    }

    /// Returns the winding number of a geometry that has one, or `None` on its surface.
    fn winding(&self, point: &Point3<f64>) -> Option<i32> {
        match self.geometry.0 {
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(mesh) => mesh.get().winding_number(point),
            Borrowed::Polyhedron(body) => match body.get().side_of(point) {
                0 => None,
                side => Some(i32::from(side < 0)),
            },
            _ => Some(0),
        }
    }

    /// Returns the outcome of the geometry and a point as a pair.
    fn ask_pair(&self, point: &Point3<f64>, tracker: &mut PairTracker) -> PointOutcome {
        let found = tracker.closest(self.geometry, &self.origin, &pose_of(point));
        let mut outcome = PointOutcome {
            state: PointOutcome::state_of(found.lower, found.upper),
            distance: found.distance,
            lower: found.lower,
            upper: found.upper,
            point: found.point_on_a,
            normal: found.normal,
            location: found.locations[0],
        };
        match self.geometry.0 {
            Borrowed::Polyhedron(body) => outcome.set_side(body.get().side_of(point)),
            Borrowed::Convex(shape)
                if outcome.state == ContactState::Undecided
                    && matches!(shape.get().core(), Core::Polyhedron(_))
                    && !holds(shape.get(), &self.origin, point) =>
            {
                outcome.set_side(1);
            }
            _ => {}
        }
        outcome
    }
}

/// Returns whether a shape contains a point: exactly if its core is a polyhedron.
fn holds(shape: &Shape, origin: &ConvexPolyhedron, point: &Point3<f64>) -> bool {
    PairTracker::new().intersects(shape, origin, &pose_of(point))
}

/// Returns the pose of the point at the origin that puts it at `point`, which is in range.
fn pose_of(point: &Point3<f64>) -> RelativePose {
    let pose = RelativePose::from_isometry(&Isometry3::translation(point.x, point.y, point.z));
    pose.unwrap_or_else(|_| RelativePose::identity())
}

/// Returns an error for a point that is out of range.
fn check(index: usize, point: &Point3<f64>) -> Result<(), PointError> {
    // Written so that NaN is an error.
    if point.iter().all(|x| x.abs() < PLACE_MAX) {
        return Ok(());
    }
    let value = (*point).into();
    Err(PointError::OutOfRange { index, value })
}
