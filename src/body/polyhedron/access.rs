//! Read access to a body: features, their neighbours and coordinates, bounding box and bounding
//! ball.

use crate::body::polyhedron::support::SCANNED;
use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::RADIUS_UP;
use crate::body::polyhedron::{BuildReport, ConvexPolyhedron, EdgeId, FaceId, Feature, HalfEdgeId, VertexId};

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
    pub fn size_in_bytes(&self) -> usize {
        let lists = size_of_val(&self.points[..])
            + size_of_val(&self.planes[..])
            + size_of_val(&self.source[..])
            + size_of_val(&self.source_faces[..]);
        size_of::<Self>()
            + lists
            + self.topology.heap_bytes()
            + self.fans.heap_bytes()
            + self.lookup.heap_bytes()
            + self.scan.heap_bytes()
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
