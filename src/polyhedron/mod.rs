//! The immutable body: a convex polyhedron with its features, their neighbours and their planes.
//!
//! Reading order: [`feature`] (names), `topology` (who is beside whom, without coordinates), `cloud`, `hull`, `facets`,
//! `plane` and `build` (points to a body), `build_faces` and `source_faces` (the caller's faces), `flat` (polygon, segment, point),
//! `fans` (vertices of many edges), `support` (extreme vertices), `highest` (the same where rounding hides them), `access`,
//! `query`, `mass`, `rebuild`, `persist`, [`solids`].
//!
//! # Stored coordinates
//!
//! A body keeps its vertices as `stored = (given - origin) / 2^exponent`, exactly. `origin` is zero in every coordinate
//! in which the body lies about its own origin, and `exponent` is zero for ordinary sizes, so most bodies are kept as
//! given. The rest is what makes far-off and extreme bodies as accurate as any other: rounding is relative to the
//! body's size, never to its place.

mod access;
mod bounds;
mod build;
mod build_faces;
mod cloud;
mod error;
mod facets;
pub(crate) mod fans;
pub mod feature;
mod flat;
pub(crate) mod highest;
mod hull;
mod mass;
#[cfg(feature = "serde")]
mod persist;
mod plane;
mod query;
mod rebuild;
mod report;
pub(crate) mod sign;
pub mod solids;
mod source_faces;
pub(crate) mod support;
pub(crate) mod topology;

use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

pub use bounds::BoxHint;
pub(crate) use cloud::{exponent_of, power_of_two};
#[cfg(feature = "exact")]
pub(crate) use cloud::{lowest_bit, odd_part};
pub use error::BuildError;
use fans::Fans;
pub use feature::{EdgeId, FaceId, Feature, FeaturePair, VertexId};
pub use report::BuildReport;
use support::CubeMap;
use topology::Topology;

/// The supporting plane of a face: `normal . x <= offset` for every vertex `x` of the body, exactly, for the normal as
/// stored. The offset exceeds the least such number by at most 5 UNIT times the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Plane {
    /// Unit up to rounding; zero for the null face of a segment.
    pub(crate) normal: Vector3<f64>,
    /// The largest `normal . x` over the body, rounded up.
    pub(crate) offset: f64,
}

/// A convex body: a polyhedron, or on purpose a polygon, a segment or a point.
///
/// Immutable, `Send + Sync`, cheap to share by reference or `Arc`. Coordinates are those of the caller, in the body's
/// own frame, in any unit.
///
/// From a mesh: [`from_points`](Self::from_points) takes the hull of its vertices, whatever its faces are;
/// [`from_faces`](Self::from_faces) refuses a mesh that is not convex or has holes, and keeps the caller's faces;
/// [`from_faces_within`](Self::from_faces_within) does so for coordinates that were rounded, as those of STL files are. Triangles that
/// repeat their corners (STL) need no welding: equal points are one.
#[derive(Clone, Debug)]
pub struct ConvexPolyhedron {
    pub(crate) topology: Topology,
    /// Stored coordinates, see the module page.
    pub(crate) points: Vec<Vector3<f64>>,
    pub(crate) planes: Vec<Plane>,
    pub(crate) fans: Fans,
    pub(crate) lookup: CubeMap,
    scan: bounds::Scan,
    /// The caller's index of each vertex.
    pub(crate) source: Vec<u32>,
    /// The caller's face that holds each face; empty for bodies from points.
    pub(crate) source_faces: Vec<u32>,
    /// The place of the stored origin in the caller's coordinates.
    pub(crate) origin: Vector3<f64>,
    /// Stored lengths times `2^exponent` are the caller's.
    pub(crate) exponent: i32,
    /// The exponent of the lowest bit set in any of the caller's coordinates, if any is not zero.
    #[cfg(feature = "exact")]
    pub(crate) lowest_bit: Option<i32>,
    /// Whether stored coordinates are the caller's: no origin, no exponent.
    pub(crate) as_given: bool,
    /// Largest distance of a vertex from the stored origin, rounded up, in stored units.
    pub(crate) radius: f64,
    /// The mean of the vertices, in stored coordinates: inside the body, which the middle of its box need not be.
    pub(crate) inner: Vector3<f64>,
    /// Three times the covariance of the vertices: the matrix of the ellipsoid through points that lie on one.
    pub(crate) spread: Matrix3<f64>,
    /// Whether that is far from a ball.
    pub(crate) is_flat: bool,
    /// Whether it has rims or fans so long that walks leap along them.
    pub(crate) has_bands: bool,
    /// Corners of the bounding box, in stored coordinates.
    pub(crate) low: Vector3<f64>,
    pub(crate) high: Vector3<f64>,
    /// Whether two faces with a common edge lie in one plane but for rounding.
    pub(crate) is_creased: bool,
    /// A number made of vertices and faces, by which what is kept of a body knows it again.
    pub(crate) print: u64,
    pub(crate) report: BuildReport,
}
