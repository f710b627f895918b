//! What a body tells about itself: its features, their neighbours and places, its box and ball.

use nalgebra::{Point3, Unit, Vector3};

use crate::num::scalar::sqrt;
use crate::polyhedron::{BuildReport, ConvexPolyhedron, EdgeId, FaceId, VertexId};
use crate::tolerance::UNIT;

/// Ids are checked: one that names no feature of this body, such as one of a larger body, gives
/// `None` or an empty iterator.
impl ConvexPolyhedron {
    /// How many vertices the body has: all are extreme points.
    #[inline]
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// How many edges the body has.
    #[inline]
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.topology.half_edge_count() / 2
    }

    /// How many faces the body has: two for a polygon (its sides), none for a segment or a point.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        if self.topology.face_count() == 1 {
            0
        } else {
            self.topology.face_count()
        }
    }

    /// All vertices, in rising order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone + use<> {
        (0..self.vertex_count() as u32).map(VertexId)
    }

    /// All edges, in rising order.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + Clone + '_ {
        let half_edges = 0..self.topology.half_edge_count() as u32;
        half_edges.filter(|&h| h < self.topology.half_edge(h).twin).map(EdgeId)
    }

    /// All faces, in rising order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone + use<> {
        (0..self.face_count() as u32).map(FaceId)
    }

    /// The place of a vertex: exactly the point the caller gave, but for coordinates the report
    /// counts as flushed.
    #[must_use]
    pub fn vertex(&self, vertex: VertexId) -> Option<Point3<f64>> {
        self.points.get(vertex.index()).map(|p| self.to_user(p))
    }

    /// The places of all vertices, in the order of their ids.
    #[must_use]
    pub fn vertex_points(&self) -> impl ExactSizeIterator<Item = Point3<f64>> + Clone + '_ {
        self.points.iter().map(|p| self.to_user(p))
    }

    /// The ends of an edge.
    #[must_use]
    pub fn edge_vertices(&self, edge: EdgeId) -> Option<[VertexId; 2]> {
        self.has_edge(edge)
            .then(|| [self.topology.from(edge.0), self.topology.half_edge(edge.0).to].map(VertexId))
    }

    /// The faces on the left and on the right of an edge, looking from its first end to its second
    /// from outside; `None` also for the edge of a segment.
    #[must_use]
    pub fn edge_faces(&self, edge: EdgeId) -> Option<[FaceId; 2]> {
        let known = self.has_edge(edge) && self.face_count() > 0;
        known.then(|| {
            let e = self.topology.half_edge(edge.0);
            [e.face, self.topology.half_edge(e.twin).face].map(FaceId)
        })
    }

    /// The vertices round a face, counter-clockwise seen from outside.
    pub fn face_vertices(&self, face: FaceId) -> impl Iterator<Item = VertexId> + '_ {
        self.face_rim(face).map(|h| VertexId(self.topology.from(h)))
    }

    /// The edges round a face, counter-clockwise seen from outside; the first leaves the first of
    /// [`face_vertices`](Self::face_vertices).
    pub fn face_edges(&self, face: FaceId) -> impl Iterator<Item = EdgeId> + '_ {
        self.face_rim(face).map(|h| EdgeId(self.topology.edge(h)))
    }

    /// The outward unit normal of a face and its offset along it, `normal . x = offset` on the face
    /// up to rounding.
    #[must_use]
    pub fn face_plane(&self, face: FaceId) -> Option<(Unit<Vector3<f64>>, f64)> {
        let plane = self.planes.get(face.index()).filter(|_| self.has_face(face))?;
        let offset = plane.offset * self.unit() + plane.normal.dot(&self.origin);
        Some((Unit::new_unchecked(plane.normal), offset))
    }

    /// The vertices joined to a vertex by an edge, counter-clockwise seen from outside.
    pub fn vertex_neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.vertex_fan(vertex).map(|h| VertexId(self.topology.half_edge(h).to))
    }

    /// The edges at a vertex, counter-clockwise seen from outside.
    pub fn vertex_edges(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        self.vertex_fan(vertex).map(|h| EdgeId(self.topology.edge(h)))
    }

    /// The faces at a vertex, counter-clockwise seen from outside.
    pub fn vertex_faces(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        let fan = self.vertex_fan(vertex).filter(|_| self.face_count() > 0);
        fan.map(|h| FaceId(self.topology.half_edge(h).face))
    }

    /// The caller's index of a vertex, the lowest among equal points.
    #[must_use]
    pub fn source_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.source.get(vertex.index()).map(|&i| i as usize)
    }

    /// The caller's face that holds a face of the body. Where the caller had cut one flat face into
    /// pieces it is one of them; `None` for bodies that were not made from faces.
    #[must_use]
    pub fn source_face(&self, face: FaceId) -> Option<usize> {
        self.source_faces.get(face.index()).map(|&i| i as usize)
    }

    /// Bytes this body takes, its lists included but not its report: with some hundred vertices or
    /// more some 155 a vertex, beyond 10,922 vertices some 200 (links of 16 and of 32 bits).
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

    /// What building this body kept, merged and dropped.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// The corners of the smallest box that holds the body, exactly.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        (self.to_user(&self.low), self.to_user(&self.high))
    }

    /// A ball that holds the body: the centre of its box and the largest distance of a vertex from
    /// there, rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (low, high) = self.aabb();
        let centre = Point3::from(low.coords * 0.5 + high.coords * 0.5);
        let scale = 1.0 / self.unit();
        // Distances are taken from the centre as rounded, in stored units so that squares stay in
        // range.
        let far = self.points.iter().fold(0.0f64, |r, p| {
            r.max(((self.to_user(p) - centre) * scale).norm_squared())
        });
        (centre, sqrt(far) * (1.0 + 8.0 * UNIT) * self.unit())
    }

    /// A stored point in the caller's coordinates.
    #[inline]
    pub(crate) fn to_user(&self, stored: &Vector3<f64>) -> Point3<f64> {
        Point3::from(stored * self.unit() + self.origin)
    }

    #[inline]
    pub(crate) fn has_edge(&self, edge: EdgeId) -> bool {
        edge.index() < self.topology.half_edge_count() && self.topology.edge(edge.0) == edge.0
    }

    #[inline]
    pub(crate) fn has_face(&self, face: FaceId) -> bool {
        face.index() < self.face_count()
    }

    fn face_rim(&self, face: FaceId) -> impl Iterator<Item = u32> + '_ {
        self.has_face(face)
            .then(|| self.topology.rim(face.0))
            .into_iter()
            .flatten()
    }

    fn vertex_fan(&self, vertex: VertexId) -> core::ops::Range<u32> {
        if vertex.index() < self.vertex_count() {
            self.topology.fan(vertex.0)
        } else {
            0..0
        }
    }
}

/// Two bodies are equal if they have the same vertices by number, and with them all else but the
/// caller's indices and the report.
impl PartialEq for ConvexPolyhedron {
    fn eq(&self, other: &Self) -> bool {
        let place = |b: &Self| (b.exponent, b.origin);
        place(self) == place(other) && self.points == other.points && self.topology == other.topology
    }
}

impl ConvexPolyhedron {
    /// Middle of the bounding box, in stored coordinates.
    #[inline]
    pub(crate) fn center(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }
}
