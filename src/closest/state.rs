//! The pairs of features the walk stands on, and what the look at one of them says.

use nalgebra::Vector3;

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Which;

/// A pair of features the walk can end on. Edges are named by the lower of their half-edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum State {
    /// A vertex of A, a vertex of B.
    VertexVertex { a: u32, b: u32 },
    /// A vertex of one body, an edge of the other.
    VertexEdge { of: Which, vertex: u32, edge: u32 },
    /// A vertex of one body, a face of the other.
    VertexFace { of: Which, vertex: u32, face: u32 },
    /// An edge of A, an edge of B.
    EdgeEdge { a: u32, b: u32 },
}

/// What the look at one state says.
pub(crate) enum Step {
    /// A neighbour is closer.
    Move(State),
    /// A face elsewhere sees the vertex from outside; the distance need not be smaller.
    Jump(State),
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

impl Which {
    /// The other body.
    #[inline]
    pub(crate) fn other(self) -> Self {
        match self {
            Which::A => Which::B,
            Which::B => Which::A,
        }
    }
}

impl State {
    /// A vertex of `of` beside a vertex of the other body.
    #[inline]
    pub(crate) fn vertices(of: Which, vertex: u32, other: u32) -> Self {
        match of {
            Which::A => State::VertexVertex { a: vertex, b: other },
            Which::B => State::VertexVertex { a: other, b: vertex },
        }
    }

    /// An edge of `of` beside an edge of the other body.
    #[inline]
    pub(crate) fn edges(of: Which, edge: u32, other: u32) -> Self {
        match of {
            Which::A => State::EdgeEdge { a: edge, b: other },
            Which::B => State::EdgeEdge { a: other, b: edge },
        }
    }

    /// The features by their public names.
    pub(crate) fn features(self) -> FeaturePair {
        let pair = |of, x, y| match of {
            Which::A => FeaturePair { a: x, b: y },
            Which::B => FeaturePair { a: y, b: x },
        };
        let vertex = |v| Feature::Vertex(VertexId(v));
        let edge = |e| Feature::Edge(EdgeId(e));
        match self {
            State::VertexVertex { a, b } => pair(Which::A, vertex(a), vertex(b)),
            State::VertexEdge { of, vertex: v, edge: e } => pair(of, vertex(v), edge(e)),
            State::VertexFace { of, vertex: v, face } => pair(of, vertex(v), Feature::Face(FaceId(face))),
            State::EdgeEdge { a, b } => pair(Which::A, edge(a), edge(b)),
        }
    }

    /// The state for a pair of features of these very bodies; `None` for ids that are not theirs. An edge beside a
    /// face, or two faces, are no states: their first vertices stand in.
    pub(crate) fn from_features(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pair: FeaturePair) -> Option<Self> {
        (a.has(pair.a) && b.has(pair.b)).then_some(())?;
        Some(match (pair.a, pair.b) {
            (Feature::Vertex(v), Feature::Vertex(w)) => State::VertexVertex { a: v.0, b: w.0 },
            (Feature::Vertex(v), Feature::Edge(e)) => State::VertexEdge {
                of: Which::A,
                vertex: v.0,
                edge: e.0,
            },
            (Feature::Edge(e), Feature::Vertex(v)) => State::VertexEdge {
                of: Which::B,
                vertex: v.0,
                edge: e.0,
            },
            (Feature::Vertex(v), Feature::Face(f)) => State::VertexFace {
                of: Which::A,
                vertex: v.0,
                face: f.0,
            },
            (Feature::Face(f), Feature::Vertex(v)) => State::VertexFace {
                of: Which::B,
                vertex: v.0,
                face: f.0,
            },
            (Feature::Edge(e), Feature::Edge(g)) => State::EdgeEdge { a: e.0, b: g.0 },
            (x, y) => State::VertexVertex {
                a: a.first_vertex(x),
                b: b.first_vertex(y),
            },
        })
    }

    /// The same pair with A and B exchanged.
    pub(crate) fn swapped(self) -> Self {
        match self {
            State::VertexVertex { a, b } => State::VertexVertex { a: b, b: a },
            State::VertexEdge { of, vertex, edge } => State::VertexEdge {
                of: of.other(),
                vertex,
                edge,
            },
            State::VertexFace { of, vertex, face } => State::VertexFace {
                of: of.other(),
                vertex,
                face,
            },
            State::EdgeEdge { a, b } => State::EdgeEdge { a: b, b: a },
        }
    }

    /// Whether every number names a feature of these bodies. Edges have two numbers; only the lower one is a name.
    #[inline]
    pub(crate) fn is_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
        let pick = |of| if of == Which::A { (a, b) } else { (b, a) };
        let has_vertex = |x: &ConvexPolyhedron, v: u32| (v as usize) < x.topology.vertex_count();
        match self {
            State::VertexVertex { a: v, b: w } => has_vertex(a, v) && has_vertex(b, w),
            State::VertexEdge { of, vertex, edge } => {
                let (x, y) = pick(of);
                has_vertex(x, vertex) && y.has_edge(EdgeId(edge))
            }
            State::VertexFace { of, vertex, face } => {
                let (x, y) = pick(of);
                has_vertex(x, vertex) && y.has_face(FaceId(face))
            }
            State::EdgeEdge { a: e, b: g } => a.has_edge(EdgeId(e)) && b.has_edge(EdgeId(g)),
        }
    }

    /// One vertex of each body's feature.
    pub(crate) fn vertices_of(self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> (u32, u32) {
        let pair = self.features();
        (a.first_vertex(pair.a), b.first_vertex(pair.b))
    }
}

impl ConvexPolyhedron {
    /// Whether `feature` names a feature of this body.
    pub(crate) fn has(&self, feature: Feature) -> bool {
        match feature {
            Feature::Vertex(v) => v.index() < self.topology.vertex_count(),
            Feature::Edge(e) => self.has_edge(e),
            Feature::Face(f) => self.has_face(f),
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

    /// Whether stored coordinates are the caller's.
    #[inline]
    pub(crate) fn is_as_given(&self) -> bool {
        self.exponent == 0 && self.origin == Vector3::zeros()
    }
}
