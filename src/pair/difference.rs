//! The Minkowski difference A - B: its points by vertex pairs, and its support points. The only place where points of the
//! difference are made, but for the exact rung, which has integers of its own.

use nalgebra::Vector3;

use crate::num::scalar::{Scalar, Vec3, sub};
use crate::pair::posed::Placed;
use crate::pair::transform::Frame;
use crate::polyhedron::ConvexPolyhedron;
use crate::polyhedron::highest::Direction;
use crate::tolerance::UNIT;

/// Bodies of so many vertices are climbed from any of them.
const SMALL: usize = 64;

/// A point of the Minkowski difference A - B: a vertex of each body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corner<T> {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// Placed difference `a - b`, in A's frame.
    pub(crate) w: Vec3<T>,
}

pub(crate) fn corner<T: Scalar>(placed: &Placed, frame: &Frame<T>, a: u32, b: u32) -> Corner<T> {
    let p = placed.a.points[a as usize];
    let w = sub(
        &[T::from(p.x), T::from(p.y), T::from(p.z)],
        &frame.point(&placed.b.points[b as usize]),
    );
    Corner { a, b, w }
}

/// The extreme vertex along `n` in the arithmetic of the solver; the lowest number among equals.
pub(crate) fn extreme<T: Scalar>(body: &ConvexPolyhedron, n: &Vec3<T>, hint: u32) -> u32 {
    let rounded = Vector3::new(n[0].value(), n[1].value(), n[2].value());
    if T::UNIT == UNIT {
        let start = if body.points.len() > SMALL {
            body.higher(&rounded, hint)
        } else {
            hint
        };
        return body.extreme(&rounded, start).vertex;
    }
    let rest = Vector3::from_fn(|k, _| (n[k] - T::from(rounded[k])).value());
    let direction = Direction::new(&body.points, &rounded, &rest);
    body.highest(&direction, body.climb(&rounded, body.higher(&rounded, hint)))
}
