//! The Minkowski difference A - B: its points by vertex pairs, and its support points.
//!
//! Points of the difference are made nowhere else, except in exact arithmetic, which has integers
//! of its own.

use nalgebra::Vector3;

use crate::base::num::scalar::{Scalar, Vec3, neg, sub};
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::highest::Direction;
use crate::body::polyhedron::{ConvexPolyhedron, VertexId};
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

/// Returns the support vertex along `n` in the arithmetic of the solver; the lowest index among
/// ties.
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
