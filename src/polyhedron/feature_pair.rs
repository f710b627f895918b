//! Pairs of features by kind and number, and pairs for which the walk has a test.

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Operand;
use crate::tuning::polyhedron::MANY;

/// Returns the pair of `x`, a feature of body `of`, and `y`, a feature of the other body.
#[inline]
fn pair(of: Operand, x: Feature, y: Feature) -> FeaturePair {
    match of {
        Operand::A => FeaturePair { a: x, b: y },
        Operand::B => FeaturePair { a: y, b: x },
    }
}

impl FeaturePair {
    /// Returns the pair of a vertex of `of` and a vertex of the other body.
    #[inline]
    pub(crate) fn vertices(of: Operand, vertex: u32, other: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Vertex(VertexId(other)))
    }

    /// Returns the pair of a vertex of `of` and an edge of the other body, named by the lower of
    /// its half-edges.
    #[inline]
    pub(crate) fn vertex_edge(of: Operand, vertex: u32, edge: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Edge(EdgeId(edge)))
    }

    /// Returns the pair of a vertex of `of` and a face of the other body.
    #[inline]
    pub(crate) fn vertex_face(of: Operand, vertex: u32, face: u32) -> Self {
        pair(of, Feature::Vertex(VertexId(vertex)), Feature::Face(FaceId(face)))
    }

    /// Returns the pair of an edge of `of` and an edge of the other body.
    #[inline]
    pub(crate) fn edges(of: Operand, edge: u32, other: u32) -> Self {
        pair(of, Feature::Edge(EdgeId(edge)), Feature::Edge(EdgeId(other)))
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
    pub(crate) fn vertices_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> (u32, u32) {
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
    pub(crate) fn first_vertex(&self, feature: Feature) -> u32 {
        match feature {
            Feature::Vertex(v) => v.0,
            Feature::Edge(e) => self.topology.half_edge(e.0).to,
            Feature::Face(f) => self.topology.half_edge(self.topology.rim_half_edge(f.0)).to,
        }
    }
}

impl ConvexPolyhedron {
    /// Returns the smallest feature that holds the given vertices (one to four, with repeats); the
    /// first vertex if no face holds all of them.
    ///
    /// The candidates are the features at the vertex of fewest edges, in the direction of another
    /// vertex.
    pub(crate) fn feature_of(&self, vertices: &[u32]) -> Feature {
        let t = &self.topology;
        let first = vertices[0];
        let v = vertices
            .iter()
            .fold(first, |v, &x| if t.fan(x).len() < t.fan(v).len() { x } else { v });
        let Some(&w) = vertices.iter().find(|&&w| w != v) else {
            return Feature::Vertex(VertexId(v));
        };
        if vertices.iter().all(|&x| x == v || x == w)
            && let Some(h) = self.toward(v, w).find(|&h| t.half_edge(h).to == w)
        {
            return Feature::Edge(EdgeId(t.edge(h)));
        }
        // At a vertex of many faces the exact plane of the face decides.
        let is_at = |x: u32, f: u32| {
            if t.fan(x).len() > MANY {
                self.face_side(f, &self.points[x as usize]) == 0.0
            } else {
                t.fan(x).any(|h| t.half_edge(h).face == f)
            }
        };
        let holds = |f: u32| vertices.iter().all(|&x| x == v || is_at(x, f));
        match self.toward(v, w).map(|h| t.half_edge(h).face).find(|&f| holds(f)) {
            Some(f) => Feature::Face(FaceId(f)),
            None => Feature::Vertex(VertexId(first)),
        }
    }
}
