//! An immutable convex polyhedron with its features, their adjacency and their planes.
//!
//! This file holds the type and read access to it. Reading order of the other files: [`feature`]
//! (ids), `topology` (adjacency without coordinates), `plane`, `build` (from points to a body:
//! `cloud`, `hull`, `facets`; the caller's faces: `faces`; `persist`). Then the support vertices,
//! where each file uses those before it: `fans` (vertices with many edges), `highest` (exact),
//! `support` (hill climbing and cube map). Then `aabb`, `query`, `mass` and [`solids`].
//!
//! # Stored coordinates
//!
//! A body stores its vertices as `stored = (given - origin) / 2^exponent`, exactly. A coordinate of
//! `origin` is zero if the body lies around its origin in that coordinate, and `exponent` is zero
//! for ordinary sizes. So most bodies are stored as given. With this transform, bodies far from the
//! origin and bodies of extreme size are as accurate as all others: rounding is relative to the
//! size of the body, never to its position.

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

use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::rigid;
pub use crate::body::polyhedron::aabb::BoxHint;
pub use crate::body::polyhedron::build::BuildReport;
pub(crate) use crate::body::polyhedron::build::cloud::{bounding_box, exponent_of, far_origin, power_of_two};
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
/// exactly, for the stored normal. The offset exceeds the least number with this property by at
/// most 5 UNIT times the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Plane {
    /// Outward normal, of unit length up to rounding; zero for the null face of a segment.
    pub(crate) normal: Vector3<f64>,
    /// Upper bound of `normal . x` over the body.
    pub(crate) offset: f64,
}

/// A convex body: a polyhedron, a polygon, a segment or a point.
///
/// It is immutable, `Send + Sync`, and cheap to share by reference or `Arc`. Coordinates are the
/// caller's, in the frame of the body and in any unit.
///
/// Constructors for a mesh:
///
/// * [`from_points`](Self::from_points) takes the hull of the vertices and ignores the faces.
/// * [`from_faces`](Self::from_faces) keeps the caller's faces, and returns an error if the mesh is
///   not convex or has holes.
/// * [`from_faces_within`](Self::from_faces_within) does the same for rounded coordinates, as in
///   STL files.
///
/// Triangles that repeat their vertices (STL) need no welding: equal points are merged.
///
/// A body that is read from a file (feature `serde`) is identical if the format keeps every bit of
/// an `f64`: with `serde_json`, enable its feature `float_roundtrip`.
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
    /// The caller's face that contains each face; empty for bodies from points.
    pub(crate) source_faces: Vec<u32>,
    /// The position of the stored origin in the caller's coordinates.
    pub(crate) origin: Vector3<f64>,
    /// The scale exponent: stored lengths times `2^exponent` are the caller's.
    pub(crate) exponent: i32,
    /// The exponent of the lowest bit set in any of the caller's coordinates, if any is not zero.
    #[cfg(feature = "exact")]
    pub(crate) lowest_bit: Option<i32>,
    /// Whether stored coordinates are the caller's: no origin, no exponent.
    pub(crate) is_unscaled: bool,
    /// Largest distance of a vertex from the stored origin, rounded up, in stored units.
    pub(crate) radius: f64,
    /// Radius of [`bounding_ball`](Self::bounding_ball), in the caller's unit.
    pub(crate) ball_radius: f64,
    /// The mean of the vertices, in stored coordinates, with an error of at most 2 UNIT of each
    /// coordinate. Up to rounding it is always inside the body, unlike the centre of the bounding
    /// box.
    pub(crate) vertex_mean: Vector3<f64>,
    /// Three times the covariance of the vertices. For points on an ellipsoid this is the matrix of
    /// the ellipsoid.
    pub(crate) covariance3: Matrix3<f64>,
    /// Whether the ellipsoid of `covariance3` is far from a ball: where a walk starts, never a
    /// fact. It is false for a polygon of few vertices, and true for some bodies with volume.
    pub(crate) seems_flat: bool,
    /// Whether some face boundaries or fans are so long that walks jump along them: a hint too.
    pub(crate) has_large_rings: bool,
    /// Least corner of the bounding box, in stored coordinates; `high` is the greatest.
    pub(crate) low: Vector3<f64>,
    pub(crate) high: Vector3<f64>,
    /// Whether two adjacent faces lie in one plane up to rounding.
    pub(crate) has_coplanar_neighbours: bool,
    /// Fingerprint of vertices and faces. Cached state uses it to detect another body.
    pub(crate) fingerprint: Fingerprint,
    pub(crate) report: BuildReport,
}

/// Ids are checked: an id that names no feature of this body, such as an id of a larger body, gives
/// `None` or an empty iterator.
impl ConvexPolyhedron {
    /// Returns the number of vertices. All of them are extreme points.
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

    /// Returns the number of faces. A polygon has two (its sides), a segment or a point has none.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        if self.topology.face_count() == 1 {
            0
        } else {
            self.topology.face_count()
        }
    }

    /// Returns the ids of all vertices, in ascending order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone + use<> {
        VertexId::all(self.vertex_count())
    }

    /// Returns the ids of all edges, in ascending order.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + Clone + '_ {
        let half_edges = HalfEdgeId::all(self.topology.half_edge_count());
        half_edges
            .filter(|&h| h < self.topology.half_edge(h).twin)
            .map(|h| self.topology.edge(h))
    }

    /// Returns the ids of all faces, in ascending order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone + use<> {
        FaceId::all(self.face_count())
    }

    /// Returns the feature with a dimension (0 vertex, 1 edge, 2 face) and an index.
    ///
    /// This is the inverse of [`Feature::dimension`] and [`Feature::index`]. `None` if the body has
    /// no such feature.
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

    /// Returns the position of a vertex: exactly the point that the caller gave, except for
    /// coordinates that the report counts as replaced by zero.
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

    /// Returns the faces on the left and on the right of an edge. Left and right are seen from
    /// outside, looking from the first end of the edge to the second. `None` also for the edge of a
    /// segment.
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

    /// Returns triangles that cover the surface, as vertex ids, counter-clockwise seen from
    /// outside.
    ///
    /// Each face is divided into a fan, face by face. A polygon has the triangles of both sides; a
    /// segment or a point has none. Use this for drawing; [`to_obj`](Self::to_obj) writes a file.
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

    /// Returns the edges of a face, counter-clockwise seen from outside. The first edge starts at
    /// the first of [`face_vertices`](Self::face_vertices).
    pub fn face_edges(&self, face: FaceId) -> impl Iterator<Item = EdgeId> + '_ {
        self.face_rim(face).map(|h| self.topology.edge(h))
    }

    /// Returns the outward unit normal of a face and the offset of its plane. On the face, `normal
    /// . x = offset` up to rounding.
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

    /// Returns the caller's index of a vertex; the lowest index of equal points.
    #[must_use]
    pub fn source_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.source.get(vertex.index()).map(|&i| i as usize)
    }

    /// Returns the caller's face that contains a face of the body. If the caller divided a flat
    /// face into several, any of them. `None` for bodies not made from faces.
    #[must_use]
    pub fn source_face(&self, face: FaceId) -> Option<usize> {
        self.source_faces.get(face.index()).map(|&i| i as usize)
    }

    /// Returns the memory of this body in bytes, with its lists but without its report. This is
    /// about 155 bytes per vertex from about a hundred vertices, and about 200 beyond 10,922
    /// vertices (links of 16 and of 32 bits).
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

    /// Returns the report of the build: points and facets that were kept, merged and dropped.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// Returns the least and greatest corner of the exact axis-aligned bounding box.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        (self.to_user(&self.low), self.to_user(&self.high))
    }

    /// Returns centre and radius of a ball that contains the body. The centre is that of the
    /// bounding box; the radius is the largest distance of a vertex from it, rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (low, high) = self.aabb();
        (Point3::from(low.coords * 0.5 + high.coords * 0.5), self.ball_radius)
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

/// Two bodies are equal if they have equal vertices in equal order and equal topology. The caller's
/// indices and the report are not compared.
impl PartialEq for ConvexPolyhedron {
    fn eq(&self, other: &Self) -> bool {
        let place = |b: &Self| (b.exponent, b.origin);
        place(self) == place(other) && self.points == other.points && self.topology == other.topology
    }
}

impl ConvexPolyhedron {
    /// Returns the support value along a direction of any length, from a point of the caller's
    /// frame, up to rounding. `None` for bodies with too many vertices for a scan.
    #[inline]
    pub(crate) fn scanned_height(&self, n: &Vector3<f64>, from: &Vector3<f64>) -> Option<f64> {
        if self.points.len() > SCANNED {
            return None;
        }
        let higher = |top: f64, h: f64| if h > top { h } else { top };
        let top = self.points.iter().map(|p| n.dot(p)).fold(f64::NEG_INFINITY, higher);
        Some(top * self.unit() + n.dot(&(self.origin - from)))
    }

    /// Returns the centre of the bounding box, in stored coordinates.
    #[inline]
    pub(crate) fn center(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }
}

impl ConvexPolyhedron {
    /// Returns the body scaled by a positive factor, for example from millimetres to metres.
    ///
    /// The result is the hull of the scaled vertices. Scaling by a power of two is exact. Any other
    /// factor rounds every coordinate, and a face of more than three vertices may become several
    /// faces that are planar up to this rounding. Vertices keep the caller's indices
    /// ([`source_vertex`](Self::source_vertex)). The ids of features are new, and
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
    /// Returns an error if the factor is not a positive finite number, or if the extent of the
    /// result is outside 1e-100..1e100.
    pub fn scaled(&self, factor: f64) -> Result<Self, BuildError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(BuildError::BadFactor { value: factor });
        }
        self.mapped(|p| p * factor)
    }

    /// Returns the body transformed by a pose, in the frame to which the pose leads.
    ///
    /// Use it for bodies that are measured in another frame once and for all, such as a collision
    /// mesh with a different origin. For a body that moves, pass the pose to the query instead.
    ///
    /// The result is the hull of the transformed vertices. As with [`scaled`](Self::scaled),
    /// rounding may split faces, and vertices keep the caller's indices.
    ///
    /// # Errors
    ///
    /// Returns an error if the pose gives coordinates that are not finite or too large.
    #[doc(alias = "translated")]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Result<Self, BuildError> {
        let pose = rigid(pose);
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
    /// Returns the body as the text of an OBJ file.
    ///
    /// The vertices are in the order of their ids, with every bit kept. The faces are polygons,
    /// counter-clockwise seen from outside.
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

/// Returns the text of an OBJ file, in which vertices are counted from one.
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
