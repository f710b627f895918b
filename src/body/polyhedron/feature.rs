//! Ids of the features of a body (vertices, edges, faces), pairs of features by kind and number,
//! and the pairs that the walk can test.

use crate::base::pose::Operand;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::polyhedron::fans::MANY;
use alloc::format;
use core::fmt;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $letter:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(pub(crate) u32);

        impl $name {
            /// Returns the index of this feature among the features of its kind and body.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(&format!(concat!($letter, "{}"), self.0)) // keeps width and alignment
            }
        }
    };
}

id!(
    /// A vertex of one body. [`ConvexPolyhedron::source_vertex`] returns the caller's index.
    ///
    /// [`ConvexPolyhedron::source_vertex`]: crate::ConvexPolyhedron::source_vertex
    VertexId,
    "v"
);
id!(
    /// An undirected edge of one body. Its number is the lower number of its two half-edges, so
    /// edge numbers have gaps.
    EdgeId,
    "e"
);
id!(
    /// A face of one body. All coplanar facets of the hull are one face.
    FaceId,
    "f"
);

id!(
    /// A half-edge of one body: an edge with a direction.
    HalfEdgeId,
    "h"
);

macro_rules! numbered {
    ($($name:ident),*) => {
        $(impl $name {
            /// Returns the first `count` ids.
            pub(crate) fn all(count: usize) -> impl ExactSizeIterator<Item = Self> + Clone + use<> {
                (0..count as u32).map(Self)
            }
        })*
    };
}

// The ids of edges have gaps.
numbered!(VertexId, HalfEdgeId, FaceId);

impl EdgeId {
    /// Returns the edge of a half-edge and its twin.
    #[inline(always)]
    pub(crate) fn of(half_edge: HalfEdgeId, twin: HalfEdgeId) -> Self {
        Self(half_edge.0.min(twin.0))
    }

    /// Returns the half-edge that names the edge.
    #[inline(always)]
    pub(crate) fn half_edge(self) -> HalfEdgeId {
        HalfEdgeId(self.0)
    }
}

/// A vertex, an edge or a face of one body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Feature {
    /// A vertex.
    Vertex(VertexId),
    /// An edge without its ends.
    Edge(EdgeId),
    /// A face without its boundary.
    Face(FaceId),
}

impl Feature {
    /// Returns 0 for a vertex, 1 for an edge, 2 for a face.
    #[must_use]
    pub fn dimension(self) -> usize {
        match self {
            Feature::Vertex(_) => 0,
            Feature::Edge(_) => 1,
            Feature::Face(_) => 2,
        }
    }

    /// Returns the index of this feature among the features of its kind and body.
    ///
    /// Kind ([`dimension`](Self::dimension)) and index identify the feature in the state of another
    /// engine; [`ConvexPolyhedron::feature`](crate::ConvexPolyhedron::feature) is the inverse.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Feature::Vertex(v) => v.index(),
            Feature::Edge(e) => e.index(),
            Feature::Face(f) => f.index(),
        }
    }
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Feature::Vertex(v) => v.fmt(f),
            Feature::Edge(e) => e.fmt(f),
            Feature::Face(x) => x.fmt(f),
        }
    }
}

/// The closest features of two bodies: one of A, one of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeaturePair {
    /// The feature of A.
    pub a: Feature,
    /// The feature of B.
    pub b: Feature,
}

impl FeaturePair {
    /// Returns the pair with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self { a: self.b, b: self.a }
    }
}

impl fmt::Display for FeaturePair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{}-{}", self.a, self.b))
    }
}

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
    /// face, or for two faces; for these the result is a pair of one vertex of each.
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
    /// Returns whether `feature` is a feature of this body. An edge has two half-edges; only the
    /// lower number is its id.
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
    /// Returns the smallest feature that contains the given vertices (one to four, with repeats).
    /// If no face contains all of them, returns the first vertex.
    ///
    /// The candidates are the features at the vertex with the fewest edges, in the direction of
    /// another vertex.
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
        // At a vertex with many faces the exact plane of the face decides.
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
