//! The pairs of features the walk stands on, and what the look at one of them says.

use nalgebra::Vector3;

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Which;

/// What the look at one pair says.
pub(crate) enum Step {
    /// A neighbour is closer.
    Move(FeaturePair),
    /// A face elsewhere sees the vertex from outside; the distance need not be smaller.
    Jump(FeaturePair),
    /// Each witness lies in the Voronoi region of the other feature; they are written to where the look was told.
    Found,
    /// No neighbour helps: the bodies overlap or nearly touch, or rounding hides the way.
    Lost,
}

/// A pair of witnesses that the Voronoi tests accept.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// Unit, from A to B in A's frame.
    pub(crate) normal: Vector3<f64>,
    /// In A's stored frame.
    pub(crate) point_a: Vector3<f64>,
    /// In B's stored frame.
    pub(crate) point_b: Vector3<f64>,
    /// Distance of the witnesses in A's stored units.
    pub(crate) distance: f64,
    /// Lower bound of the distance before its error term, minus infinity where the tests do not prove one.
    pub(crate) lower: f64,
}

/// The pair of `x`, a feature of body `of`, and `y`, a feature of the other.
#[inline]
fn pair(of: Which, x: Feature, y: Feature) -> FeaturePair {
    match of {
        Which::A => FeaturePair { a: x, b: y },
        Which::B => FeaturePair { a: y, b: x },
    }
}

impl FeaturePair {
    /// A vertex of `of` beside a vertex of the other body.
    #[inline]
    pub(crate) fn vertices(of: Which, vertex: u32, other: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Vertex(VertexId(other)))
    }

    /// A vertex of `of` beside an edge of the other body, named by the lower of its half-edges.
    #[inline]
    pub(crate) fn vertex_edge(of: Which, vertex: u32, edge: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Edge(EdgeId(edge)))
    }

    /// A vertex of `of` beside a face of the other body.
    #[inline]
    pub(crate) fn vertex_face(of: Which, vertex: u32, face: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Face(FaceId(face)))
    }

    /// An edge of `of` beside an edge of the other body.
    #[inline]
    pub(crate) fn edges(of: Which, edge: u32, other: u32) -> Self {
        pair(of, Feature::Edge(EdgeId(edge)), Feature::Edge(EdgeId(other)))
    }

    /// Whether both ids name features of bodies with as many.
    #[inline]
    pub(crate) fn is_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
        a.has(self.a) && b.has(self.b)
    }

    /// A pair the walk can stand on. An edge beside a face, or two faces, are none: a vertex of each stands in.
    pub(crate) fn to_stand_on(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Self {
        if self.a.dimension() + self.b.dimension() <= 2 {
            return self;
        }
        let (v, w) = self.vertices_of(a, b);
        Self::vertices(Which::A, v, w)
    }

    /// One vertex of each body's feature.
    pub(crate) fn vertices_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> (u32, u32) {
        (a.first_vertex(self.a), b.first_vertex(self.b))
    }
}

impl ConvexPolyhedron {
    /// Whether `feature` names a feature of a body with this many.
    #[inline]
    pub(crate) fn has(&self, feature: Feature) -> bool {
        match feature {
            Feature::Vertex(v) => v.index() < self.topology.vertex_count(),
            Feature::Edge(e) => e.index() < self.topology.half_edge_count(),
            Feature::Face(f) => f.index() < self.topology.face_count(),
        }
    }

    /// A vertex of a feature that is this body's.
    pub(crate) fn first_vertex(&self, feature: Feature) -> u32 {
        match feature {
            Feature::Vertex(v) => v.0,
            Feature::Edge(e) => self.topology.half_edge(e.0).to,
            Feature::Face(f) => self.topology.half_edge(self.topology.rim_start(f.0)).to,
        }
    }

    /// Middle of the bounding box, in stored coordinates.
    #[inline]
    pub(crate) fn center(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }
}
