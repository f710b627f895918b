//! What stands for a body in a receipt: a polyhedron, or the parts of a body that is not convex.
//!
//! Parts are triangles of a mesh or pieces of a compound, in the order of a tree. A part is the hull
//! of some points of the body. Parts are sorted so that those with numbers in a range, halved as
//! often as one likes, are near each other: evidence names parts by such ranges.

use core::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use crate::extremes::Extremes;
use lin_canny::polyhedron::{ConvexPolyhedron, solids};
use lin_canny::shape::Core;
use lin_canny::{Compound, Geometry, Mesh, MeshKind, Shape};

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

/// The points and the parts of a body that is not convex.
#[derive(Clone, Debug)]
pub(super) struct StatedParts {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) parts: Vec<Vec<usize>>,
    /// The parts are triangles, and what they enclose belongs to the body.
    pub(super) is_solid: bool,
    pub(super) radius: f64,
    /// What the parts are, if they are larger than the body.
    pub(super) around: Option<&'static str>,
}

impl StatedParts {
    pub(super) fn of_mesh(mesh: &Mesh) -> Self {
        let triangles = mesh.triangle_vertices().into_iter();
        let stated = Self {
            points: mesh.vertices(),
            parts: triangles.map(|t| t.map(|k| k as usize).to_vec()).collect(),
            is_solid: mesh.kind() == MeshKind::Solid,
            radius: 0.0,
            around: None,
        };
        stated.sorted()
    }

    /// Returns the pieces, or `None` if one has no polyhedron around it. All pieces get the greatest
    /// radius.
    pub(super) fn of_compound(compound: &Compound) -> Option<Self> {
        let (mut points, mut parts, mut radii, mut around) = (Vec::new(), Vec::new(), Vec::new(), None);
        for piece in compound.pieces() {
            let stated = StatedHull::of_shape(&piece.shape)?;
            let first = points.len();
            points.extend(stated.hull.vertex_points().map(|p| piece.pose * p));
            parts.push((first..points.len()).collect());
            radii.push(stated.radius);
            around = around.or(stated.around.map(|_| "curved pieces in polyhedra of 32 sides"));
        }
        let radius = radii.iter().copied().fold(0.0, f64::larger);
        if radii.iter().any(|other| *other != radius) {
            around = Some("all pieces with the greatest radius");
        }
        let stated = Self {
            points,
            parts,
            is_solid: false,
            radius,
            around,
        };
        Some(stated.sorted())
    }

    fn sorted(mut self) -> Self {
        let middle = |part: &Vec<usize>| {
            let sum: Vector3<f64> = part.iter().map(|k| self.points[*k].coords).sum();
            sum / part.len() as f64
        };
        let mut middles: Vec<(Vector3<f64>, Vec<usize>)> =
            self.parts.into_iter().map(|part| (middle(&part), part)).collect();
        sort(&mut middles);
        self.parts = middles.into_iter().map(|x| x.1).collect();
        self
    }
}

/// Sorts parts such that the lower and the upper half are apart along the longest axis, and so on.
fn sort(parts: &mut [(Vector3<f64>, Vec<usize>)]) {
    if parts.len() < 2 {
        return;
    }
    let first = parts[0].0;
    let [low, high] = parts.iter().fold([first; 2], |[low, high], (p, _)| {
        [low.zip_map(p, f64::smaller), high.zip_map(p, f64::larger)]
    });
    let axis = (high - low).imax();
    let middle = half([0, parts.len()]);
    parts.select_nth_unstable_by(middle, |x, y| {
        x.0[axis].total_cmp(&y.0[axis]).then_with(|| x.1.cmp(&y.1))
    });
    let (lower, upper) = parts.split_at_mut(middle);
    sort(lower);
    sort(upper);
}

/// Returns the hull of a cloud, flat or not.
pub(super) fn hull_of(cloud: &[Point3<f64>]) -> Option<ConvexPolyhedron> {
    let first = *cloud.first()?;
    let far = |from: Point3<f64>| {
        let each = cloud.iter().copied();
        each.max_by(|p, q| (p - from).norm_squared().total_cmp(&(q - from).norm_squared()))
    };
    let end = far(first)?;
    let (start, flat) = (far(end)?, ConvexPolyhedron::polygon(cloud));
    let full = flat.or_else(|_| ConvexPolyhedron::from_points(cloud));
    let line = full.or_else(|_| ConvexPolyhedron::segment(start, end));
    line.or_else(|_| ConvexPolyhedron::point(first)).ok()
}

/// Returns where a range of parts is cut.
pub(super) fn half([low, high]: [usize; 2]) -> usize {
    low + (high - low) / 2
}
