//! The pairs of features the walk stands on, and what the look at one of them says.
//!
//! The [`Outcome`] of a query is where everything is written, from the first look to the last layer, in stored units and
//! frames until the tracker hands it out: the walk is so short that copying an answer would show.

use nalgebra::{Point3, Unit, Vector3};

use super::outcome::{Class, Layer, Outcome, Work};
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Which;

/// What the look at one pair says.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// A neighbour is closer; it is the pair to look at next.
    Move,
    /// A face elsewhere sees the vertex from outside; the distance need not be smaller.
    Jump,
    /// Each witness lies in the Voronoi region of the other feature.
    Found,
    /// No neighbour helps: the bodies overlap or nearly touch, or rounding hides the way.
    Lost,
}

impl Outcome {
    /// Nothing known yet but where to begin.
    #[inline(always)]
    pub(crate) fn open(pair: FeaturePair) -> Self {
        Self {
            class: Class::Undecided,
            distance: 0.0,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            features: pair,
            point_on_a: Point3::origin(),
            point_on_b: Point3::origin(),
            normal: Vector3::x_axis(),
            layer: Layer::Walk,
            work: Work::default(),
        }
    }

    /// Goes to a closer pair.
    #[inline(always)]
    pub(crate) fn go(&mut self, pair: FeaturePair) -> Step {
        self.features = pair;
        Step::Move
    }

    /// Ends at this pair: the unit direction from A to B in A's frame, the witnesses in their stored frames, their
    /// distance, and a lower bound of it before its error term (minus infinity where the tests do not prove one).
    #[inline(always)]
    pub(crate) fn end(&mut self, normal: Vector3<f64>, witnesses: Witnesses, distance: f64, lower: f64) -> Step {
        self.normal = Unit::new_unchecked(normal);
        self.point_on_a = witnesses.0.into();
        self.point_on_b = witnesses.1.into();
        self.distance = distance;
        self.lower = lower;
        Step::Found
    }
}

/// A point of A and a point of B, each in its body's stored frame.
pub(crate) type Witnesses = (Vector3<f64>, Vector3<f64>);

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
    /// Whether `feature` names a feature of this body. An edge has two numbers; only the lower one is its name.
    #[inline]
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
}
