//! Ids of the features of a body (vertices, edges, faces) and pairs of features.

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
    /// A vertex of one body. [`ConvexPolyhedron::source_vertex`] leads back to the caller's own
    /// index.
    ///
    /// [`ConvexPolyhedron::source_vertex`]: crate::ConvexPolyhedron::source_vertex
    VertexId,
    "v"
);
id!(
    /// An undirected edge of one body, named by the lower of the numbers of its two half-edges (so
    /// the numbers have gaps).
    EdgeId,
    "e"
);
id!(
    /// A face of one body: all coplanar facets of the hull are one face.
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

    /// Returns the index of this feature among the features of its kind and body. Kind
    /// ([`dimension`](Self::dimension)) and index name the feature in the state of another engine;
    /// [`ConvexPolyhedron::feature`](crate::ConvexPolyhedron::feature) leads back.
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
