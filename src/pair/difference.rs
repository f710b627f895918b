//! The Minkowski difference A - B: its points, support points and facets.
//!
//! A point is a pair of vertices, a facet a pair of features. No other module computes points of
//! the difference, except exact arithmetic, which computes them on integers.

use nalgebra::Vector3;

use crate::base::num::scalar::{Scalar, Vec3, neg, sub};
use crate::base::pose::Operand;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::highest::Direction;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// A point of the Minkowski difference A - B: a vertex of each body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MinkowskiPoint<T> {
    pub(crate) a: VertexId,
    pub(crate) b: VertexId,
    /// The difference `a - b`, in A's frame.
    pub(crate) w: Vec3<T>,
}

impl<T: Scalar> Default for MinkowskiPoint<T> {
    fn default() -> Self {
        Self {
            a: VertexId(0),
            b: VertexId(0),
            w: [T::from(0.0); 3],
        }
    }
}

/// Returns the point of A - B for a vertex of A and a vertex of B.
pub(crate) fn difference_point<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    a: VertexId,
    b: VertexId,
) -> MinkowskiPoint<T> {
    let p = posed.a.points[a.index()];
    let w = sub(
        &[T::from(p.x), T::from(p.y), T::from(p.z)],
        &frame.point(&posed.b.points[b.index()]),
    );
    MinkowskiPoint { a, b, w }
}

/// Returns the support vertex along `n` in the arithmetic of the solver.
///
/// The lowest index among ties.
pub(crate) fn support_vertex<T: Scalar>(body: &ConvexPolyhedron, n: &Vec3<T>, hint: VertexId) -> VertexId {
    let rounded = Vector3::new(n[0].value(), n[1].value(), n[2].value());
    if T::UNIT == UNIT {
        return body.support_certified_anywhere(&rounded, hint).vertex;
    }
    let rest = Vector3::from_fn(|k, _| (n[k] - T::from(rounded[k])).value());
    let direction = Direction::new(&body.points, &rounded, &rest);
    body.support_exact(
        &direction,
        body.support_climb(&rounded, body.start_vertex(&rounded, hint)),
    )
}

/// Returns the support point of A - B along a direction.
pub(crate) fn support<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    n: &Vec3<T>,
    hint: &MinkowskiPoint<T>,
) -> MinkowskiPoint<T> {
    let a = support_vertex(posed.a, n, hint.a);
    let b = support_vertex(posed.b, &neg(&frame.direction(n)), hint.b);
    difference_point(posed, frame, a, b)
}

/// A facet of A - B, given by the features of the bodies that span it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DifferenceFacet {
    /// A face of A and a vertex of B.
    FaceVertex(FaceId, VertexId),
    /// A vertex of A and a face of B.
    VertexFace(VertexId, FaceId),
    /// An edge of A and an edge of B.
    Edges(EdgeId, EdgeId),
}

impl DifferenceFacet {
    /// Returns the facet that a pair of features spans; `None` for other features.
    pub(crate) fn of(features: FeaturePair) -> Option<Self> {
        match (features.a, features.b) {
            (Feature::Face(f), Feature::Vertex(v)) => Some(Self::FaceVertex(f, v)),
            (Feature::Vertex(v), Feature::Face(f)) => Some(Self::VertexFace(v, f)),
            (Feature::Edge(e), Feature::Edge(g)) => Some(Self::Edges(e, g)),
            _ => None,
        }
    }

    /// Returns the facet of a vertex of body `of` and a face of the other body.
    #[inline]
    pub(crate) fn vertex_face(of: Operand, vertex: VertexId, face: FaceId) -> Self {
        match of {
            Operand::A => Self::VertexFace(vertex, face),
            Operand::B => Self::FaceVertex(face, vertex),
        }
    }

    /// Returns the facet of an edge of body `of` and an edge of the other body.
    #[inline]
    pub(crate) fn edges(of: Operand, edge: EdgeId, other: EdgeId) -> Self {
        match of {
            Operand::A => Self::Edges(edge, other),
            Operand::B => Self::Edges(other, edge),
        }
    }

    pub(crate) fn features(self) -> FeaturePair {
        match self {
            Self::FaceVertex(f, v) => FeaturePair::vertex_face(Operand::B, v, f),
            Self::VertexFace(v, f) => FeaturePair::vertex_face(Operand::A, v, f),
            Self::Edges(e, g) => FeaturePair::edges(Operand::A, e, g),
        }
    }

    /// Returns whether both facets belong to the same face.
    pub(crate) fn is_on_face_of(self, other: Self) -> bool {
        match (self, other) {
            (Self::FaceVertex(f, _), Self::FaceVertex(g, _)) | (Self::VertexFace(_, f), Self::VertexFace(_, g)) => {
                f == g
            }
            _ => false,
        }
    }

    /// Returns the facets that may contain three points of A - B, given by vertices of A and of B.
    pub(crate) fn at(posed: &PosedPair, on_a: &[VertexId; 3], on_b: &[VertexId; 3]) -> [Option<Self>; 3] {
        let (fa, fb) = (posed.a.feature_of(on_a), posed.b.feature_of(on_b));
        let of_a = match fa {
            Feature::Face(f) => Some(Self::FaceVertex(f, on_b[0])),
            _ => None,
        };
        let of_b = match fb {
            Feature::Face(f) => Some(Self::VertexFace(on_a[0], f)),
            _ => None,
        };
        let of_edges = match (fa, fb) {
            (Feature::Edge(e), Feature::Edge(g)) => Some(Self::Edges(e, g)),
            _ => None,
        };
        [of_a, of_b, of_edges]
    }
}
