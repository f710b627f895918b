//! The immutable body: a convex polyhedron with its features, their adjacency and their planes.
//!
//! Reading order: [`feature`] (ids), `topology` (adjacency without coordinates), `plane`, `build`
//! (points to a body: `cloud`, `hull`, `facets`; the caller's faces: `faces`, `source_faces`;
//! polygon, segment, point: `flat`; `rebuild`, `persist`); support vertices, each file on the files
//! before: `axis` (of a fan), `heights` (exact comparison), `unimodal` (bisection), `fans`
//! (vertices of many edges), `highest` (exact), `support` (hill climbing and cube map); `access`,
//! `bounds`, `query`, `mass`, `obj`, `transform`, `feature_pair`, [`solids`].
//!
//! # Stored coordinates
//!
//! A body keeps its vertices as `stored = (given - origin) / 2^exponent`, exactly. `origin` is zero
//! in every coordinate in which the body lies about its own origin, and `exponent` is zero for
//! ordinary sizes, so most bodies are stored as given. The transform makes far-off and extreme
//! bodies as accurate as all others: rounding is relative to the body's size, never to its
//! position.

// First, so that the documentation of `ConvexPolyhedron` begins with the constructors.
pub(crate) mod build;

mod access;
pub(crate) mod axis;
mod bounds;
mod check;
pub(crate) mod cycle;
pub(crate) mod fans;
pub mod feature;
mod feature_pair;
pub(crate) mod heights;
pub(crate) mod highest;
mod mass;
pub(crate) mod obj;
mod plane;
pub(crate) mod query;
pub mod solids;
pub(crate) mod support;
pub(crate) mod topology;
mod transform;
pub(crate) mod unimodal;

use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

use crate::base::num::fingerprint::Fingerprint;
pub use bounds::BoxHint;
pub(crate) use build::cloud::{bounding_box, exponent_of, power_of_two};
#[cfg(feature = "exact")]
pub(crate) use build::cloud::{lowest_bit, odd_part};
pub use build::error::BuildError;
pub use build::report::BuildReport;
use fans::Fans;
pub(crate) use feature::HalfEdgeId;
pub use feature::{EdgeId, FaceId, Feature, FeaturePair, VertexId};
use support::CubeMap;
use topology::Topology;

/// The supporting plane of a face: `normal . x <= offset` for every vertex `x` of the body,
/// exactly, for the stored normal. The offset exceeds the least such number by at most 5 UNIT times
/// the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Plane {
    /// Outward normal, of unit length up to rounding; zero for the null face of a segment.
    pub(crate) normal: Vector3<f64>,
    /// Upper bound of `normal . x` over the body.
    pub(crate) offset: f64,
}

/// A convex body: a polyhedron, or on purpose a polygon, a segment or a point.
///
/// Immutable, `Send + Sync`, cheap to share by reference or `Arc`. Coordinates are the caller's, in
/// the body's own frame, in any unit.
///
/// From a mesh: [`from_points`](Self::from_points) takes the hull of the vertices, whatever the
/// faces are; [`from_faces`](Self::from_faces) refuses a mesh that is not convex or has holes, and
/// keeps the caller's faces; [`from_faces_within`](Self::from_faces_within) does so for rounded
/// coordinates, as in STL files. Triangles that repeat their vertices (STL) need no welding: equal
/// points are merged.
///
/// A file (feature `serde`) gives the identical body back if the format keeps every bit of an
/// `f64`: with `serde_json` switch on the feature `float_roundtrip`.
#[derive(Clone, Debug)]
pub struct ConvexPolyhedron {
    pub(crate) topology: Topology,
    /// Vertices in stored coordinates, see the module page.
    pub(crate) points: Vec<Vector3<f64>>,
    pub(crate) planes: Vec<Plane>,
    pub(crate) fans: Fans,
    pub(crate) lookup: CubeMap,
    scan: bounds::Scan,
    /// The caller's index of each vertex.
    pub(crate) source: Vec<u32>,
    /// The caller's face that holds each face; empty for bodies from points.
    pub(crate) source_faces: Vec<u32>,
    /// The position of the stored origin in the caller's coordinates.
    pub(crate) origin: Vector3<f64>,
    /// Exponent of the stored unit: stored lengths times `2^exponent` are the caller's.
    pub(crate) exponent: i32,
    /// The exponent of the lowest bit set in any of the caller's coordinates, if any is not zero.
    #[cfg(feature = "exact")]
    pub(crate) lowest_bit: Option<i32>,
    /// Whether stored coordinates are the caller's: no origin, no exponent.
    pub(crate) is_unscaled: bool,
    /// Largest distance of a vertex from the stored origin, rounded up, in stored units.
    pub(crate) radius: f64,
    /// The mean of the vertices, in stored coordinates, right up to 2 UNIT of each coordinate:
    /// always inside the body but for rounding, unlike the centre of the bounding box.
    pub(crate) vertex_mean: Vector3<f64>,
    /// Three times the covariance of the vertices: for points on an ellipsoid, the matrix of the
    /// ellipsoid.
    pub(crate) covariance3: Matrix3<f64>,
    /// Whether the ellipsoid of `covariance3` is far from a ball.
    pub(crate) is_flat: bool,
    /// Whether the body has face boundaries or fans so long that walks jump along them.
    pub(crate) has_large_rings: bool,
    /// Least corner of the bounding box, in stored coordinates; `high` is the greatest.
    pub(crate) low: Vector3<f64>,
    pub(crate) high: Vector3<f64>,
    /// Whether two adjacent faces lie in one plane but for rounding.
    pub(crate) has_coplanar_neighbours: bool,
    /// Of vertices and faces: cached state uses it to detect another body.
    pub(crate) fingerprint: Fingerprint,
    pub(crate) report: BuildReport,
}
