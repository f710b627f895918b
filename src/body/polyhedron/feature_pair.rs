//! Pairs of features by kind and number, and pairs for which the walk has a test.

use crate::base::pose::Operand;
use crate::body::polyhedron::fans::MANY;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};

/// Returns the pair of `x`, a feature of body `of`, and `y`, a feature of the other body.
#[inline]
fn pair(of: Operand, x: Feature, y: Feature) -> FeaturePair {
    match of {
        Operand::A => FeaturePair { a: x, b: y },
        Operand::B => FeaturePair { a: y, b: x },
    }
}

impl FeaturePair {
    /// The first vertex of each body.
    pub(crate) const FIRST: Self = Self {
        a: Feature::Vertex(VertexId(0)),
        b: Feature::Vertex(VertexId(0)),
    };

    /// Returns the pair of a vertex of `of` and a vertex of the other body.
    #[inline]
    pub(crate) fn vertices(of: Operand, vertex: VertexId, other: VertexId) -> Self {
        pair(of, Feature::Vertex(vertex), Feature::Vertex(other))
    }

    /// Returns the pair of a vertex of `of` and an edge of the other body.
    #[inline]
    pub(crate) fn vertex_edge(of: Operand, vertex: VertexId, edge: EdgeId) -> Self {
        pair(of, Feature::Vertex(vertex), Feature::Edge(edge))
    }

    /// Returns the pair of a vertex of `of` and a face of the other body.
    #[inline]
    pub(crate) fn vertex_face(of: Operand, vertex: VertexId, face: FaceId) -> Self {
        pair(of, Feature::Vertex(vertex), Feature::Face(face))
    }

    /// Returns the pair of an edge of `of` and an edge of the other body.
    #[inline]
    pub(crate) fn edges(of: Operand, edge: EdgeId, other: EdgeId) -> Self {
        pair(of, Feature::Edge(edge), Feature::Edge(other))
    }

    /// Returns whether both ids name features of the given bodies.
    #[inline]
    pub(crate) fn is_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
        a.has(self.a) && b.has(self.b)
    }

    /// Returns this pair if the walk has a test for it. The walk has no test for an edge and a
    /// face, or for two faces: then returns the pair of one vertex of each.
    pub(crate) fn walkable(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Self {
        if self.a.dimension() + self.b.dimension() <= 2 {
            return self;
        }
        let (v, w) = self.vertices_of(a, b);
        Self::vertices(Operand::A, v, w)
    }

    /// Returns one vertex of each body's feature.
    pub(crate) fn vertices_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> (VertexId, VertexId) {
        (a.first_vertex(self.a), b.first_vertex(self.b))
    }
}

impl ConvexPolyhedron {
    /// Returns whether `feature` names a feature of this body. An edge has two half-edges; only the
    /// lower number is its name.
    #[inline]
    pub(crate) fn has(&self, feature: Feature) -> bool {
        match feature {
            Feature::Vertex(v) => v.index() < self.topology.vertex_count(),
            Feature::Edge(e) => self.has_edge(e),
            Feature::Face(f) => self.has_face(f),
        }
    }

    /// Returns one vertex of a feature, which must be a feature of this body.
    pub(crate) fn first_vertex(&self, feature: Feature) -> VertexId {
        match feature {
            Feature::Vertex(v) => v,
            Feature::Edge(e) => self.topology.half_edge(e.half_edge()).to,
            Feature::Face(f) => self.topology.half_edge(self.topology.rim_half_edge(f)).to,
        }
    }
}

impl ConvexPolyhedron {
    /// Returns the smallest feature that holds the given vertices (one to four, with repeats); the
    /// first vertex if no face holds all of them.
    ///
    /// The candidates are the features at the vertex of fewest edges, in the direction of another
    /// vertex.
    pub(crate) fn feature_of(&self, vertices: &[VertexId]) -> Feature {
        let t = &self.topology;
        let first = vertices[0];
        let v = vertices
            .iter()
            .fold(first, |v, &x| if t.fan(x).len() < t.fan(v).len() { x } else { v });
        let Some(&w) = vertices.iter().find(|&&w| w != v) else {
            return Feature::Vertex(v);
        };
        if vertices.iter().all(|&x| x == v || x == w)
            && let Some(h) = self.toward(v, w).find(|&h| t.half_edge(h).to == w)
        {
            return Feature::Edge(t.edge(h));
        }
        // At a vertex of many faces the exact plane of the face decides.
        let is_at = |x: VertexId, f: FaceId| {
            if t.fan(x).len() > MANY {
                self.face_side(f, &self.points[x.index()]) == 0.0
            } else {
                t.fan(x).iter().any(|h| t.half_edge(h).face == f)
            }
        };
        let holds = |f: FaceId| vertices.iter().all(|&x| x == v || is_at(x, f));
        match self.toward(v, w).map(|h| t.half_edge(h).face).find(|&f| holds(f)) {
            Some(f) => Feature::Face(f),
            None => Feature::Vertex(first),
        }
    }
}
