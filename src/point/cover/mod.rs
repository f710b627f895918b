//! Balls that contain a body, and balls inside a body, with proven gaps.
//!
//! ```text
//! cover_outside   samples -> clusters -> balls -> proof, which grows balls   outside.rs
//! cover_inside    deepest points -> balls that cover most samples -> gap     inside.rs
//!   Body          distances of points, cells that may meet the body          cells.rs
//!   min_ball      small enclosing ball of samples                            clusters.rs
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
//! Sources: small enclosing balls by steps towards the farthest point, Bădoiu and Clarkson 2003;
//! greedy choice of balls, and clusters that are divided where they stick out most, as in
//! Bradshaw and O'Sullivan 2004, "Adaptive medial-axis approximation for sphere-tree construction".
//! Departures:
//! 1. Their balls cover samples. Here the cells prove that the balls cover the body, and a ball
//!    that is too small grows.
//! 2. The distance by which balls stick out is a proven bound.

mod cells;
mod clusters;
mod inside;
mod outside;

use alloc::vec::Vec;

use nalgebra::Point3;

use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};

/// Largest number of balls of a cover.
pub const BALLS_MAX: usize = 1024;

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
/// of the goal, not the least possible one. With n balls the call computes about `10,000 + 100 n`
/// distances of points.
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

/// Returns an error for a number of balls that is out of range.
fn check_count(balls: usize) -> Result<(), CoverError> {
    if (1..=BALLS_MAX).contains(&balls) {
        return Ok(());
    }
    Err(CoverError::Balls { balls })
}
