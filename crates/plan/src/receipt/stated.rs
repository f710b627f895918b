//! What is stated of a body in a receipt: its points and discs, or the parts of a body that is not convex.
//!
//! Parts are triangles of a mesh or pieces of a compound or a cloud, in the order of a tree. A part is the
//! hull of some points of the body. Parts are sorted so that those with numbers in a range, halved as
//! often as one likes, are near each other: evidence names parts by such ranges.

use core::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use crate::extremes::Extremes;
use lin_canny::polyhedron::{ConvexPolyhedron, solids};
use lin_canny::shape::Core;
use lin_canny::{Compound, Geometry, Mesh, MeshKind, Shape};

/// Numbers of sides of polyhedra around the cylinders and cones of a compound, few first. They exceed the
/// radius by 5e-3, 8e-5 and 1e-6 of it.
pub(super) const SIDES: [usize; 3] = [32, 256, 2048];

/// Factor by which the radius grows, more than the vertices round.
const GROWN: f64 = 1.0 + 16.0 * f64::EPSILON;

/// A disc about a point of a body, perpendicular to an axis.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    /// The number of the point.
    pub(super) centre: usize,
    pub(super) at: Vector3<f64>,
    /// A unit vector.
    pub(super) axis: Vector3<f64>,
    pub(super) radius: f64,
}

impl Disc {
    /// Returns the disc of a shape whose axis is z.
    fn new(centre: usize, z: f64, radius: f64) -> Self {
        let [at, axis] = [Vector3::new(0.0, 0.0, z), Vector3::z()];
        Self {
            centre,
            at,
            axis,
            radius,
        }
    }

    /// Half of the height of the disc along a direction.
    pub(super) fn half_height(&self, m: &Vector3<f64>) -> f64 {
        self.radius * m.cross(&self.axis).norm()
    }
}

/// A convex body: the hull of points and discs, rounded by a radius.
pub(super) struct StatedHull {
    /// The hull of the points.
    pub(super) hull: Arc<ConvexPolyhedron>,
    pub(super) discs: Vec<Disc>,
    pub(super) radius: f64,
}

impl StatedHull {
    /// Returns points and discs of a body; `None` if it has another form.
    pub(super) fn new(geometry: &Geometry) -> Option<Self> {
        let shape = match geometry {
            Geometry::Polyhedron(hull) => {
                let hull = hull.clone();
                let (discs, radius) = (Vec::new(), 0.0);
                return Some(Self { hull, discs, radius });
            }
            Geometry::Convex(shape) => shape,
            _ => return None,
        };
        let axis = |h: f64| ConvexPolyhedron::segment(Point3::new(0.0, 0.0, -h), Point3::new(0.0, 0.0, h));
        let (hull, ends) = match shape.core() {
            Core::Polyhedron(hull) => (hull.clone(), Vec::new()),
            Core::Cylinder(core) => {
                let (h, r) = (core.half_height(), core.radius());
                (Arc::new(axis(h).ok()?), vec![(-h, r), (h, r)])
            }
            Core::Cone(core) => {
                let (h, r) = (core.half_height(), core.radius());
                (Arc::new(axis(h).ok()?), vec![(-h, r)])
            }
            _ => return None,
        };
        let number = |z: f64| hull.vertex_points().position(|p| p.z == z);
        let discs = ends.iter().map(|(z, r)| Some(Disc::new(number(*z)?, *z, *r)));
        Some(Self {
            discs: discs.collect::<Option<_>>()?,
            radius: shape.rounding_radius(),
            hull,
        })
    }
}

/// Returns the points of a piece and its radius, and by how much a polyhedron exceeds a curved one;
/// `None` if there is no polyhedron around it.
fn around_piece(shape: &Shape, sides: usize) -> Option<(Arc<ConvexPolyhedron>, f64, f64)> {
    let outer = |radius: f64| radius / libm::cos(PI / sides as f64) * GROWN;
    let (hull, excess) = match shape.core() {
        Core::Polyhedron(hull) => (hull.clone(), 0.0),
        Core::Cylinder(core) => {
            let radius = outer(core.radius());
            let hull = solids::prism(sides, core.half_height(), radius).ok();
            let hull = hull.filter(|hull| hull.vertex_count() == 2 * sides);
            (Arc::new(hull?), radius - core.radius())
        }
        Core::Cone(core) => {
            let radius = outer(core.radius());
            let hull = solids::cone(sides, core.half_height(), radius).ok();
            let hull = hull.filter(|hull| hull.vertex_count() == sides + 1);
            (Arc::new(hull?), radius - core.radius())
        }
        _ => return None,
    };
    Some((hull, shape.rounding_radius(), excess))
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
    pub(super) around: Option<String>,
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
    pub(super) fn of_compound(compound: &Compound, sides: usize) -> Option<Self> {
        let (mut points, mut parts, mut radii, mut excess) = (Vec::new(), Vec::new(), Vec::new(), 0.0f64);
        for piece in compound.pieces() {
            let (hull, radius, more) = around_piece(&piece.shape, sides)?;
            let first = points.len();
            points.extend(hull.vertex_points().map(|p| piece.pose * p));
            parts.push((first..points.len()).collect());
            radii.push(radius);
            excess = excess.larger(more);
        }
        let [least, radius] = radii
            .iter()
            .fold([f64::INFINITY, 0.0], |[low, high], r| [r.smaller(low), r.larger(high)]);
        let around = match (excess > 0.0, radius > least) {
            (false, false) => None,
            (true, false) => Some(format!(
                "curved pieces in polyhedra of {sides} sides, at most {excess:.1e} larger"
            )),
            (_, true) => {
                let excess = excess + (radius - least);
                Some(format!(
                    "all pieces with the greatest radius, at most {excess:.1e} larger"
                ))
            }
        };
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
            let (hull, rounding, excess) = around_piece(&shape, SIDES[0]).expect("a polyhedron");
            assert!(excess > 0.0);
            let (_, ball) = shape.bounding_ball();
            let (radius, low) = match shape.core() {
                Core::Cylinder(core) => (core.radius(), -core.half_height()),
                Core::Cone(core) => (core.radius(), -core.half_height()),
                _ => panic!("a round core"),
            };
            let points = hull.vertex_points();
            let mut base: Vec<_> = points.filter(|p| p.z == low).map(|p| p.coords.xy()).collect();
            base.sort_by(|p, q| p.y.atan2(p.x).total_cmp(&q.y.atan2(q.x)));
            assert_eq!(base.len(), SIDES[0]);
            for k in 0..SIDES[0] {
                let (a, b) = (base[k], base[(k + 1) % SIDES[0]]);
                let from_axis = a.perp(&b) / (b - a).norm();
                assert!(from_axis > radius, "{from_axis} {radius}");
            }
            for k in 0..2000 {
                let turn = 2.0 * PI * f64::from(k) / 2000.0;
                let direction = Vector3::new(turn.cos(), turn.sin(), (7.0 * turn).sin()).normalize();
                let heights = hull.vertex_points().map(|p| p.coords.dot(&direction));
                let outer = heights.fold(f64::NEG_INFINITY, f64::max) + rounding;
                let own = shape.support_height(&direction);
                assert!(
                    outer >= own - 1e-14 * ball && outer <= own + 0.005 * ball,
                    "{own} {outer}"
                );
            }
        }
    }
}
