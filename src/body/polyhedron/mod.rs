//! The immutable body: a convex polyhedron with its features, their adjacency and their planes.
//!
//! This file holds the type and read access to it. Reading order of the others: [`feature`] (ids),
//! `topology` (adjacency without coordinates), `plane`, `build` (points to a body: `cloud`, `hull`,
//! `facets`; the caller's faces: `faces`; `persist`); support vertices, each file on the files
//! before: `fans` (vertices of many edges), `highest` (exact), `support` (hill climbing and cube
//! map); `bounds`, `query`, `mass`, [`solids`].
//!
//! # Stored coordinates
//!
//! A body keeps its vertices as `stored = (given - origin) / 2^exponent`, exactly. `origin` is zero
//! in every coordinate in which the body lies about its own origin, and `exponent` is zero for
//! ordinary sizes, so most bodies are stored as given. The transform makes far-off and extreme
//! bodies as accurate as all others: rounding is relative to the body's size, never to its
//! position.

mod aabb;
pub(crate) mod build;
mod check;
pub(crate) mod fans;
pub mod feature;
pub(crate) mod highest;
mod mass;
mod plane;
pub(crate) mod query;
pub mod solids;
pub(crate) mod support;
pub(crate) mod topology;

use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::RADIUS_UP;
pub use crate::body::polyhedron::aabb::BoxHint;
pub use crate::body::polyhedron::build::BuildReport;
pub(crate) use crate::body::polyhedron::build::cloud::{bounding_box, exponent_of, power_of_two};
#[cfg(feature = "exact")]
pub(crate) use crate::body::polyhedron::build::cloud::{lowest_bit, odd_part};
pub use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::fans::Fans;
pub(crate) use crate::body::polyhedron::feature::HalfEdgeId;
pub use crate::body::polyhedron::feature::{EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::body::polyhedron::support::{CubeMap, SCANNED};
use crate::body::polyhedron::topology::Topology;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::Write as _;
use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};

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
    scan: aabb::Scan,
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

/// Ids are checked: an id that names no feature of this body, such as an id of a larger body, gives
/// `None` or an empty iterator.
impl ConvexPolyhedron {
    /// Returns the number of vertices; all are extreme points.
    #[inline]
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// Returns the number of edges.
    #[inline]
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.topology.half_edge_count() / 2
    }

    /// Returns the number of faces: two for a polygon (its sides), none for a segment or a point.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        if self.topology.face_count() == 1 {
            0
        } else {
            self.topology.face_count()
        }
    }

    /// Returns the ids of all vertices, in rising order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone + use<> {
        VertexId::all(self.vertex_count())
    }

    /// Returns the ids of all edges, in rising order.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + Clone + '_ {
        let half_edges = HalfEdgeId::all(self.topology.half_edge_count());
        half_edges
            .filter(|&h| h < self.topology.half_edge(h).twin)
            .map(|h| self.topology.edge(h))
    }

    /// Returns the ids of all faces, in rising order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone + use<> {
        FaceId::all(self.face_count())
    }

    /// Returns the feature of a dimension (0 vertex, 1 edge, 2 face) and an index, the inverse of
    /// [`Feature::dimension`] and [`Feature::index`]; `None` if the body has no such feature.
    #[must_use]
    pub fn feature(&self, dimension: usize, index: usize) -> Option<Feature> {
        let index = u32::try_from(index).ok()?;
        let feature = match dimension {
            0 => Feature::Vertex(VertexId(index)),
            1 => Feature::Edge(EdgeId(index)),
            2 => Feature::Face(FaceId(index)),
            _ => return None,
        };
        self.has(feature).then_some(feature)
    }

    /// Returns the position of a vertex: exactly the point the caller gave, but for coordinates the
    /// report counts as flushed.
    #[must_use]
    pub fn vertex(&self, vertex: VertexId) -> Option<Point3<f64>> {
        self.points.get(vertex.index()).map(|p| self.to_user(p))
    }

    /// Returns the positions of all vertices, in the order of their ids.
    #[must_use]
    pub fn vertex_points(&self) -> impl ExactSizeIterator<Item = Point3<f64>> + Clone + '_ {
        self.points.iter().map(|p| self.to_user(p))
    }

    /// Returns the two end vertices of an edge.
    #[must_use]
    pub fn edge_vertices(&self, edge: EdgeId) -> Option<[VertexId; 2]> {
        self.has_edge(edge).then(|| {
            [
                self.topology.from(edge.half_edge()),
                self.topology.half_edge(edge.half_edge()).to,
            ]
        })
    }

    /// Returns the faces on the left and on the right of an edge, as seen from outside and looking
    /// from the first end to the second; `None` also for the edge of a segment.
    #[must_use]
    pub fn edge_faces(&self, edge: EdgeId) -> Option<[FaceId; 2]> {
        let known = self.has_edge(edge) && self.face_count() > 0;
        known.then(|| {
            let e = self.topology.half_edge(edge.half_edge());
            [e.face, self.topology.half_edge(e.twin).face]
        })
    }

    /// Returns the vertices of a face, counter-clockwise seen from outside.
    pub fn face_vertices(&self, face: FaceId) -> impl Iterator<Item = VertexId> + '_ {
        self.face_rim(face).map(|h| self.topology.from(h))
    }

    /// Returns triangles that make up the surface, as the ids of their vertices, counter-clockwise
    /// seen from outside: a fan of each face, face by face. Both sides of a polygon; none for a
    /// segment or a point. For drawing; [`to_obj`](Self::to_obj) writes a file.
    #[doc(alias = "indices")]
    #[doc(alias = "trimesh")]
    pub fn triangles(&self) -> impl Iterator<Item = [VertexId; 3]> + '_ {
        self.faces().flat_map(|face| {
            let first = self.face_vertices(face).next();
            let second = self.face_vertices(face).skip(1);
            let third = self.face_vertices(face).skip(2);
            let sides = second.zip(third);
            sides.filter_map(move |(b, c)| Some([first?, b, c]))
        })
    }

    /// Returns the edges of a face, counter-clockwise seen from outside, beginning with the edge
    /// that leaves the first of [`face_vertices`](Self::face_vertices).
    pub fn face_edges(&self, face: FaceId) -> impl Iterator<Item = EdgeId> + '_ {
        self.face_rim(face).map(|h| self.topology.edge(h))
    }

    /// Returns the outward unit normal of a face and the offset of its plane: `normal . x = offset`
    /// on the face up to rounding.
    #[must_use]
    pub fn face_plane(&self, face: FaceId) -> Option<(Unit<Vector3<f64>>, f64)> {
        let plane = self.planes.get(face.index()).filter(|_| self.has_face(face))?;
        let offset = plane.offset * self.unit() + plane.normal.dot(&self.origin);
        Some((Unit::new_unchecked(plane.normal), offset))
    }

    /// Returns the vertices adjacent to a vertex, counter-clockwise seen from outside.
    pub fn vertex_neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.vertex_fan(vertex).map(|h| self.topology.half_edge(h).to)
    }

    /// Returns the edges at a vertex, counter-clockwise seen from outside.
    pub fn vertex_edges(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        self.vertex_fan(vertex).map(|h| self.topology.edge(h))
    }

    /// Returns the faces at a vertex, counter-clockwise seen from outside.
    pub fn vertex_faces(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        let fan = self.vertex_fan(vertex).filter(|_| self.face_count() > 0);
        fan.map(|h| self.topology.half_edge(h).face)
    }

    /// Returns the caller's index of a vertex, the lowest among equal points.
    #[must_use]
    pub fn source_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.source.get(vertex.index()).map(|&i| i as usize)
    }

    /// Returns the caller's face that holds a face of the body; any piece if the caller had cut a
    /// flat face into pieces. `None` for bodies not made from faces.
    #[must_use]
    pub fn source_face(&self, face: FaceId) -> Option<usize> {
        self.source_faces.get(face.index()).map(|&i| i as usize)
    }

    /// Returns the bytes this body takes, with its lists but without its report: some 155 a vertex
    /// from some hundred vertices on, some 200 beyond 10,922 vertices (links of 16 and of 32 bits).
    #[must_use]
    pub fn memory_usage(&self) -> usize {
        let lists = size_of_val(&self.points[..])
            + size_of_val(&self.planes[..])
            + size_of_val(&self.source[..])
            + size_of_val(&self.source_faces[..]);
        size_of::<Self>()
            + lists
            + self.topology.memory_usage()
            + self.fans.memory_usage()
            + self.lookup.memory_usage()
            + self.scan.memory_usage()
    }

    /// Returns the report of the build: points and facets kept, merged and dropped.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// Returns the least and greatest corner of the smallest axis-aligned box that holds the body,
    /// exactly.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        (self.to_user(&self.low), self.to_user(&self.high))
    }

    /// Returns centre and radius of a ball that holds the body: the centre of the bounding box and
    /// the largest distance of a vertex from there, rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (low, high) = self.aabb();
        let centre = Point3::from(low.coords * 0.5 + high.coords * 0.5);
        let scale = 1.0 / self.unit();
        // Distances are taken from the rounded centre, in stored units so that squares stay in
        // range.
        let far = self.points.iter().fold(0.0f64, |r, p| {
            r.larger(((self.to_user(p) - centre) * scale).norm_squared())
        });
        (centre, sqrt(far) * RADIUS_UP * self.unit())
    }

    /// Converts a stored point to the caller's coordinates.
    #[inline]
    pub(crate) fn to_user(&self, stored: &Vector3<f64>) -> Point3<f64> {
        Point3::from(stored * self.unit() + self.origin)
    }

    #[inline]
    pub(crate) fn has_edge(&self, edge: EdgeId) -> bool {
        edge.index() < self.topology.half_edge_count() && self.topology.edge(edge.half_edge()) == edge
    }

    #[inline]
    pub(crate) fn has_face(&self, face: FaceId) -> bool {
        face.index() < self.face_count()
    }

    fn face_rim(&self, face: FaceId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.has_face(face)
            .then(|| self.topology.rim(face))
            .into_iter()
            .flatten()
    }

    fn vertex_fan(&self, vertex: VertexId) -> impl Iterator<Item = HalfEdgeId> + use<> {
        (vertex.index() < self.vertex_count())
            .then(|| self.topology.fan(vertex).iter())
            .into_iter()
            .flatten()
    }
}

/// Two bodies are equal if they have equal vertices in equal order; everything else follows but the
/// caller's indices and the report.
impl PartialEq for ConvexPolyhedron {
    fn eq(&self, other: &Self) -> bool {
        let place = |b: &Self| (b.exponent, b.origin);
        place(self) == place(other) && self.points == other.points && self.topology == other.topology
    }
}

impl ConvexPolyhedron {
    /// Returns the greatest height of a vertex along a direction of any length, in the caller's
    /// unit, right up to rounding; `None` for bodies of more vertices than are worth a scan.
    #[inline]
    pub(crate) fn scanned_height(&self, n: &Vector3<f64>) -> Option<f64> {
        if self.points.len() > SCANNED {
            return None;
        }
        let higher = |top: f64, h: f64| if h > top { h } else { top };
        let top = self.points.iter().map(|p| n.dot(p)).fold(f64::NEG_INFINITY, higher);
        Some(top * self.unit() + n.dot(&self.origin))
    }

    /// Returns the centre of the bounding box, in stored coordinates.
    #[inline]
    pub(crate) fn center(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }
}

impl ConvexPolyhedron {
    /// Returns the body with all coordinates multiplied by a positive factor, as from millimetres
    /// to metres.
    ///
    /// The result is the hull of the scaled vertices. Scaling by a power of two is exact; any other
    /// factor rounds every coordinate, and a face of more than three vertices may become several
    /// faces, planar up to that rounding. Vertices keep the caller's indices
    /// ([`source_vertex`](Self::source_vertex)); the ids of features are new, and
    /// [`source_face`](Self::source_face) is `None`.
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::polyhedron::solids;
    ///
    /// let in_millimetres = solids::cuboid(Vector3::new(50.0, 20.0, 20.0))?;
    /// let in_metres = in_millimetres.scaled(1e-3)?;
    /// assert_eq!(in_metres.aabb().1.x, 0.05);
    /// # Ok::<(), lin_canny::BuildError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// A factor that is not a positive finite number, or an extent of the result outside
    /// 1e-100..1e100.
    pub fn scaled(&self, factor: f64) -> Result<Self, BuildError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(BuildError::BadFactor { value: factor });
        }
        self.mapped(|p| p * factor)
    }

    /// Returns the body moved by a pose, in the frame that the pose leads to: for bodies that are
    /// measured in another frame once and for all, such as a collision mesh with an origin of its
    /// own. For a body that moves, pass the pose to the query instead.
    ///
    /// The result is the hull of the moved vertices. Rounding may split faces, and names are kept,
    /// as by [`scaled`](Self::scaled).
    ///
    /// # Errors
    ///
    /// A pose that gives coordinates that are not finite or too large.
    #[doc(alias = "translated")]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Result<Self, BuildError> {
        self.mapped(|p| pose * p)
    }

    /// Returns the body of the same kind (polyhedron, polygon, segment or point) with mapped
    /// vertices.
    fn mapped(&self, map: impl Fn(Point3<f64>) -> Point3<f64>) -> Result<Self, BuildError> {
        let rim = self.first_side();
        let order: Vec<u32> = if rim.is_empty() {
            (0..self.vertex_count() as u32).collect()
        } else {
            rim
        };
        let place = |&v: &u32| map(self.to_user(&self.points[v as usize]));
        let points: Vec<Point3<f64>> = order.iter().map(place).collect();
        let mut body = match *points {
            [p] => Self::point(p)?,
            [p, q] => Self::segment(p, q)?,
            _ if self.face_count() == 2 => Self::polygon(&points)?,
            _ => Self::from_points(&points)?,
        };
        for source in &mut body.source {
            *source = self.source[order[*source as usize] as usize];
        }
        Ok(body)
    }
}

impl ConvexPolyhedron {
    /// Returns the body as the text of an OBJ file: the vertices in the order of their ids, every
    /// bit kept, and the faces as polygons, counter-clockwise seen from outside.
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::polyhedron::solids;
    ///
    /// let body = solids::cuboid(Vector3::new(0.5, 0.5, 0.1))?;
    /// let text = body.to_obj(); // std::fs::write("cuboid.obj", text)?;
    /// assert_eq!(text.lines().filter(|l| l.starts_with("v ")).count(), 8);
    /// assert_eq!(text.lines().filter(|l| l.starts_with("f ")).count(), 6);
    /// # Ok::<(), lin_canny::BuildError>(())
    /// ```
    #[doc(alias = "write")]
    #[doc(alias = "export")]
    #[must_use]
    pub fn to_obj(&self) -> String {
        let face = |f| self.face_vertices(f).map(|v| v.index());
        obj(self.vertex_points(), self.faces().map(face))
    }
}

/// Returns the text of an OBJ file, whose vertices are counted from one.
pub(crate) fn obj<F>(points: impl Iterator<Item = Point3<f64>>, faces: impl Iterator<Item = F>) -> String
where
    F: Iterator<Item = usize>,
{
    let mut text = String::new();
    for p in points {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for face in faces {
        text.push('f');
        for vertex in face {
            let _ = write!(text, " {}", vertex + 1);
        }
        text.push('\n');
    }
    text
}
