//! Balls or a hull of few faces that contain a body, and balls inside a body, with proven gaps.
//!
//! ```text
//! cover_outside   samples -> clusters -> balls -> proof, which grows balls   outside.rs
//! cover_inside    deepest points -> balls that cover most samples -> gap     inside.rs
//!   Body          distances of points, cells that may meet the body          cells.rs
//!   min_ball      small enclosing ball of samples                            clusters.rs
//! hull_outside    planes -> corners -> proof -> gap                          hull.rs
//!   Supports      planes that are proven to touch and contain the body       supports.rs
//!   Inner         hull of points of the body, planes along its faces         inner.rs
//!   Chooser       from many planes to few                                    fewer.rs
//! ```
//!
//! Samples only propose. The proofs use bounds of the signed distance s of single points
//! ([`PointQuery`](crate::PointQuery)) and rounding that is counted in `COVER`:
//!
//! - **A cell is empty** if `s(centre)` is greater than half its diagonal.
//! - **The balls contain the body** if the root cell contains it, and each cell is empty, or inside
//!   one ball, or divided into cells for which this is true. A ball contains a cell if it contains
//!   its farthest corner.
//! - **A ball sticks out** by at most `s(centre) + radius`.
//! - **A ball is inside** if its radius is at most `-s(centre)`.
//!
//! `hull.rs` has the proof of hulls.
//!
//! Sources: small enclosing balls by steps towards the farthest point, Bădoiu and Clarkson 2003;
//! greedy choice of balls, and clusters that are divided where they stick out most, as in
//! Bradshaw and O'Sullivan 2004, "Adaptive medial-axis approximation for sphere-tree construction".
//! Departures:
//! 1. Their balls cover samples. Here the cells prove that the balls cover the body, and a ball
//!    that is too small grows.
//! 2. The distance by which balls stick out is a proven bound.

mod cells;
mod clusters;
mod fewer;
mod hull;
mod inner;
mod inside;
mod outside;
mod supports;

use alloc::vec::Vec;

use nalgebra::Point3;

use crate::body::polyhedron::ConvexPolyhedron;
use crate::convex::contact::HalfSpace;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};

/// Largest number of balls of a cover.
pub const BALLS_MAX: usize = 1024;

/// Largest number of planes of a hull.
pub const FACES_MAX: usize = 256;

/// A ball, in the frame of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ball {
    /// Centre.
    pub center: Point3<f64>,
    /// Radius; zero for the cover of a single point.
    pub radius: f64,
}

/// Balls that contain a body, or balls inside a body, and how far the two differ at most.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BallCover {
    /// The balls.
    pub balls: Vec<Ball>,
    /// Upper bound of the gap, in the caller's unit.
    ///
    /// For [`cover_outside`]: no point of a ball is farther from the body. For [`cover_inside`]: no
    /// point of the body is farther from the balls.
    pub gap: f64,
}

/// A convex polyhedron that contains a body, and how far the two differ at most.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HullCover {
    /// The polyhedron, in the frame of the body: the exact hull of rounded corners.
    ///
    /// A face of the cover with more than three corners is flat up to rounding only. It is several
    /// faces of this polyhedron, and [`source_face`](ConvexPolyhedron::source_face) returns the
    /// index of its plane.
    pub hull: ConvexPolyhedron,
    /// The planes of the faces of the cover: each half-space contains the body.
    ///
    /// The polyhedron sticks out of them by rounding. Empty for a single point at the origin, which
    /// is its own hull.
    pub planes: Vec<HalfSpace>,
    /// Upper bound of the gap, in the caller's unit.
    ///
    /// No point of the polyhedron is farther from the convex hull of the body: from the body itself
    /// if it is convex.
    pub gap: f64,
}

/// What an outer cover must reach.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CoverGoal {
    /// At most this many balls, with a small gap.
    Balls(usize),
    /// A proven gap of at most this length, with few balls.
    Gap(f64),
}

/// Error returned if a body has no cover, or a parameter is out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoverError {
    /// The number of balls is zero or too large.
    #[error("number of balls is out of range: {balls} (expected 1..={BALLS_MAX})")]
    Balls {
        /// The number.
        balls: usize,
    },
    /// The requested gap is not a positive number.
    #[error("gap of the cover is out of range: {gap:?} (expected a positive length)")]
    Gap {
        /// The length.
        gap: f64,
    },
    /// The requested gap needs too many balls, or is within rounding of zero.
    #[error("gap of {gap:e} is not reached: {balls} balls stick out by up to {reached:e}")]
    TooFine {
        /// The requested gap.
        gap: f64,
        /// Number of balls at the end.
        balls: usize,
        /// The proven gap of these balls.
        reached: f64,
    },
    /// The number of faces is too small to bound a body, or too large.
    #[error("number of faces is out of range: {faces} (expected 4..={FACES_MAX})")]
    Faces {
        /// The number.
        faces: usize,
    },
    /// No hull is proven to contain the body.
    #[error("no hull of the {kind} is found: its hull would be out of range, 1e-100..1e100")]
    NoHull {
        /// Kind of the geometry.
        kind: GeometryKind,
    },
    /// The body is not bounded.
    #[error("a {kind} has no cover: it is not bounded")]
    Unbounded {
        /// Kind of the geometry.
        kind: GeometryKind,
    },
    /// No ball is proven to be inside the body.
    #[error("no ball is inside the {kind}: it has no inside, or is thinner than rounding")]
    NoInside {
        /// Kind of the geometry.
        kind: GeometryKind,
    },
}

/// Returns balls that contain a body, with a proven bound of how far they stick out.
///
/// The union of the balls contains the whole body: a polyhedron, shape or closed mesh with its
/// inside, and each triangle of an open mesh. This is proven, including rounding, and not sampled.
/// So an obstacle that is clear of all balls is clear of the body, and its distance from the balls
/// is less than its distance from the body by at most [`BallCover::gap`].
///
/// The balls depend on nothing but the geometry and the goal. The number of balls is at most that
/// of the goal, not the least possible one.
///
/// The cost is that of [distances of points](crate::PointQuery): of 4,000 balls or 20,000
/// triangles, 20,000 to 120,000 of them for up to 64 balls, and up to 800,000 for 1,024. A goal of
/// a gap starts again with more balls, and computes up to 1,500,000: then it takes seconds.
///
/// ```
/// use lin_canny::Shape;
/// use lin_canny::cover::{CoverGoal, cover_outside};
///
/// let rod = Shape::cylinder(1.0, 0.2)?;
/// let few = cover_outside(&rod, CoverGoal::Balls(4))?;
/// let many = cover_outside(&rod, CoverGoal::Balls(16))?;
/// assert!(few.balls.len() <= 4 && many.gap < few.gap);
///
/// let close = cover_outside(&rod, CoverGoal::Gap(0.1))?;
/// assert!(close.gap <= 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns an error if the number of balls is not in `1..=1024`, if the gap is not positive or not
/// reached with 1,024 balls, or if the body is a half-space.
#[doc(alias = "sphere decomposition")]
#[doc(alias = "bounding spheres")]
pub fn cover_outside<'a>(geometry: impl Into<GeometryRef<'a>>, goal: CoverGoal) -> Result<BallCover, CoverError> {
    outside::cover(geometry.into(), goal)
}

/// Returns balls inside a body, with a proven bound of what they leave out.
///
/// Each ball is inside the body: this is proven by the bounds of the signed distance of its centre.
/// So an obstacle that meets a ball meets the body. No point of the body is farther from the balls
/// than [`BallCover::gap`].
///
/// The first ball is about the largest one inside. Each further ball contains the most samples of
/// those that the balls before it leave out. There are fewer balls than requested if no sample is
/// left. Each ball of a compound or cloud is inside one of its pieces.
///
/// The cost is that of distances of points: of a cloud of 4,000 balls, 15,000 to 120,000 of them
/// for 8 balls, and up to 1,400,000 for 1,024. If all balls of the cloud overlap, these take 10 s.
///
/// ```
/// use lin_canny::Shape;
/// use lin_canny::cover::cover_inside;
/// use lin_canny::nalgebra::Vector3;
///
/// let die = Shape::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let cover = cover_inside(&die, 1)?;
/// let ball = cover.balls[0];
/// assert!(ball.radius <= 1.0 && ball.radius > 0.9);
/// // The corners of the die are left out.
/// assert!(cover.gap >= 3f64.sqrt() - 1.0 && cover.gap < 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns an error if the number of balls is not in `1..=1024`, or if the body is a half-space or
/// has no inside: an open mesh, a Bézier surface, a polygon, a segment, or a body thinner than
/// rounding.
#[doc(alias = "inner spheres")]
pub fn cover_inside<'a>(geometry: impl Into<GeometryRef<'a>>, balls: usize) -> Result<BallCover, CoverError> {
    inside::cover(geometry.into(), balls)
}

/// Returns a polyhedron of at most `faces` faces that contains a body, with a proven bound of the
/// gap.
///
/// The polyhedron contains the whole body: a polyhedron, a shape, a compound, a cloud, a mesh, a
/// surface. This is proven, including rounding, and not sampled. So an obstacle that is clear of
/// the polyhedron is clear of the body, and what the polyhedron fits into, the body fits into. No
/// point of the polyhedron is farther than [`HullCover::gap`] from the convex hull of the body.
///
/// A flat body gets a polyhedron that is thicker than the body by rounding. A polyhedron with no
/// more faces than requested gets its own faces, up to rounding. Otherwise the faces are those
/// whose removal makes the gap grow most, not the best possible ones.
///
/// The polyhedron depends on nothing but the geometry and the number. The call takes up to about
/// 0.1 s for 6 faces, 0.3 s for 64 and 2 s for 256.
///
/// ```
/// use lin_canny::cover::hull_outside;
/// use lin_canny::polyhedron::solids;
///
/// let ball = solids::geodesic_sphere(3, 1.0)?;
/// let few = hull_outside(&ball, 8)?;
/// let many = hull_outside(&ball, 64)?;
/// assert!(many.planes.len() <= 64 && many.gap < few.gap);
/// for corner in ball.vertex_points() {
///     assert!(many.hull.contains(&corner));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns an error if the number of faces is not in `4..=256`, if the body is a half-space, or if
/// the extent of the polyhedron is outside 1e-100..1e100.
#[doc(alias = "convex hull simplification")]
#[doc(alias = "bounding polyhedron")]
pub fn hull_outside<'a>(geometry: impl Into<GeometryRef<'a>>, faces: usize) -> Result<HullCover, CoverError> {
    hull::cover(geometry.into(), faces)
}

/// Returns an error for a number of balls that is out of range.
fn check_count(balls: usize) -> Result<(), CoverError> {
    if (1..=BALLS_MAX).contains(&balls) {
        return Ok(());
    }
    Err(CoverError::Balls { balls })
}
