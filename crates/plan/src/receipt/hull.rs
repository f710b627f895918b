//! The polyhedron that represents a body.

use core::f64::consts::PI;
use std::sync::Arc;

use lin_canny::polyhedron::{ConvexPolyhedron, solids};
use lin_canny::shape::Core;
use lin_canny::{Geometry, Shape};

/// Number of sides of a polyhedron around a cylinder or a cone. It exceeds the radius by 0.5 %.
const SIDES: usize = 32;

/// Factor by which the radius grows, more than the vertices round.
const GROWN: f64 = 1.0 + 16.0 * f64::EPSILON;

/// A polyhedron, rounded by a radius, that is a body or contains it.
pub(super) struct StatedHull {
    pub(super) hull: Arc<ConvexPolyhedron>,
    pub(super) radius: f64,
    /// What the polyhedron is, if it is larger than the body.
    pub(super) around: Option<&'static str>,
}

impl StatedHull {
    /// Returns the polyhedron of a body, or one around it; `None` if there is none.
    pub(super) fn new(geometry: &Geometry) -> Option<Self> {
        match geometry {
            Geometry::Polyhedron(hull) => Some(Self {
                hull: hull.clone(),
                radius: 0.0,
                around: None,
            }),
            Geometry::Convex(shape) => Self::of_shape(shape),
            _ => None,
        }
    }

    /// Returns the polyhedron of a shape, or one around it.
    pub(super) fn of_shape(shape: &Shape) -> Option<Self> {
        let outer = |radius: f64| radius / libm::cos(PI / SIDES as f64) * GROWN;
        let (hull, around) = match shape.core() {
            Core::Polyhedron(hull) => (hull.clone(), None),
            Core::Cylinder(core) => {
                let hull = solids::prism(SIDES, core.half_height(), outer(core.radius())).ok();
                let hull = hull.filter(|hull| hull.vertex_count() == 2 * SIDES);
                (Arc::new(hull?), Some("in a prism of 32 sides"))
            }
            Core::Cone(core) => {
                let hull = solids::cone(SIDES, core.half_height(), outer(core.radius())).ok();
                let hull = hull.filter(|hull| hull.vertex_count() == SIDES + 1);
                (Arc::new(hull?), Some("in a pyramid of 32 sides"))
            }
            _ => return None,
        };
        Some(Self {
            hull,
            radius: shape.rounding_radius(),
            around,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use std::vec::Vec;

    /// Support heights of the polyhedron are those of the body or more, and at most 0.5 % more. Those
    /// of the body are too large by up to 1e-14 of its size, so the sides at the base are tested, too.
    #[test]
    fn a_polyhedron_contains_the_body() {
        let shapes = [
            Shape::cylinder(0.3, 0.2),
            Shape::cone(0.3, 0.2),
            Shape::cylinder(1e-7, 1e3),
            Shape::cylinder(0.1, 0.1).and_then(|shape| shape.rounded(0.05)),
        ];
        for shape in shapes {
            let shape = shape.expect("a shape");
            let stated = StatedHull::new(&Geometry::from(shape.clone())).expect("a polyhedron");
            let (_, ball) = shape.bounding_ball();
            let (radius, low) = match shape.core() {
                Core::Cylinder(core) => (core.radius(), -core.half_height()),
                Core::Cone(core) => (core.radius(), -core.half_height()),
                _ => panic!("a round core"),
            };
            let points = stated.hull.vertex_points();
            let mut base: Vec<_> = points.filter(|p| p.z == low).map(|p| p.coords.xy()).collect();
            base.sort_by(|p, q| p.y.atan2(p.x).total_cmp(&q.y.atan2(q.x)));
            assert_eq!(base.len(), SIDES);
            for k in 0..SIDES {
                let (a, b) = (base[k], base[(k + 1) % SIDES]);
                let from_axis = a.perp(&b) / (b - a).norm();
                assert!(from_axis > radius, "{from_axis} {radius}");
            }
            for k in 0..2000 {
                let turn = 2.0 * PI * f64::from(k) / 2000.0;
                let direction = Vector3::new(turn.cos(), turn.sin(), (7.0 * turn).sin()).normalize();
                let heights = stated.hull.vertex_points().map(|p| p.coords.dot(&direction));
                let outer = heights.fold(f64::NEG_INFINITY, f64::max) + stated.radius;
                let own = shape.support_height(&direction);
                assert!(
                    outer >= own - 1e-14 * ball && outer <= own + 0.005 * ball,
                    "{own} {outer}"
                );
            }
        }
    }
}
