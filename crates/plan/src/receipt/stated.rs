//! What is stated of a body in a receipt: its points and ellipsoids, and the parts of a body that is not convex.
//!
//! Parts are triangles of a mesh or pieces of a compound or a cloud, in the order of a tree. A part is the
//! hull of some points of the body and of the ellipsoids about them, rounded by a radius. Parts are sorted so
//! that those with numbers in a range, halved as often as one likes, are near each other: evidence names parts
//! by such ranges.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::extremes::Extremes;
use lin_canny::polyhedron::ConvexPolyhedron;
use lin_canny::shape::Core;
use lin_canny::{Compound, Geometry, Mesh, MeshKind, Piece, Shape};

/// Directions along which points of an ellipsoid are taken, for a hull that is nearly the body.
const SIDES: u32 = 16;

/// Number of the finenesses at which a curved surface is stated. A receipt takes the first that is enough.
pub(super) const FINENESS: usize = 3;

/// An ellipsoid about a point of a body, or an ellipse, which is one with two semi-axes.
#[derive(Clone, Debug)]
pub(super) struct Ellipsoid {
    /// The number of the point.
    pub(super) centre: usize,
    pub(super) at: Vector3<f64>,
    pub(super) axes: Vec<Vector3<f64>>,
}

impl Ellipsoid {
    /// Half of the height of the ellipsoid along a direction.
    pub(super) fn half_height(&self, m: &Vector3<f64>) -> f64 {
        let heights = self.axes.iter().map(|v| m.dot(v));
        heights.map(|height| height * height).sum::<f64>().sqrt()
    }

    /// Returns the radius of a ball around it, as a checker sees it: lemma 13 there.
    pub(super) fn radius(&self) -> f64 {
        let row = |u: &Vector3<f64>| self.axes.iter().map(|v| u.dot(v).abs()).sum::<f64>();
        self.axes.iter().map(row).fold(0.0, f64::larger).sqrt()
    }

    /// Returns points of its surface.
    pub(super) fn samples(&self) -> Vec<Point3<f64>> {
        let mut samples = Vec::new();
        for (k, u) in self.axes.iter().enumerate() {
            for v in &self.axes[k + 1..] {
                for side in 0..SIDES {
                    let (sin, cos) = libm::sincos(core::f64::consts::TAU * f64::from(side) / f64::from(SIDES));
                    samples.push(Point3::from(self.at + u * cos + v * sin));
                }
            }
        }
        samples
    }
}

/// A convex body: the hull of points and ellipsoids, rounded by a radius.
pub(super) struct StatedHull {
    /// The hull of the points.
    pub(super) hull: Arc<ConvexPolyhedron>,
    pub(super) ellipsoids: Vec<Ellipsoid>,
    pub(super) radius: f64,
}

impl StatedHull {
    /// Returns points and ellipsoids of a body; `None` if it has another form.
    pub(super) fn new(geometry: &Geometry) -> Option<Self> {
        match geometry {
            Geometry::Polyhedron(hull) => Some(Self {
                hull: hull.clone(),
                ellipsoids: Vec::new(),
                radius: 0.0,
            }),
            Geometry::Convex(shape) => Self::of_shape(shape),
            _ => None,
        }
    }

    fn of_shape(shape: &Shape) -> Option<Self> {
        let axis = |h: f64| ConvexPolyhedron::segment(Point3::new(0.0, 0.0, -h), Point3::new(0.0, 0.0, h));
        let disc = |z: f64, r: f64| (z, vec![r * Vector3::x(), r * Vector3::y()]);
        let (hull, ends) = match shape.core() {
            Core::Polyhedron(hull) => (hull.clone(), Vec::new()),
            Core::Cylinder(core) => {
                let (h, r) = (core.half_height(), core.radius());
                (Arc::new(axis(h).ok()?), vec![disc(-h, r), disc(h, r)])
            }
            Core::Cone(core) => {
                let (h, r) = (core.half_height(), core.radius());
                (Arc::new(axis(h).ok()?), vec![disc(-h, r)])
            }
            Core::Ellipsoid(core) => {
                let origin = ConvexPolyhedron::point(Point3::origin()).ok()?;
                let axes = core.semi_axes();
                let axes = (0..3).map(|k| Vector3::ith(k, axes[k])).collect();
                (Arc::new(origin), vec![(0.0, axes)])
            }
            _ => return None,
        };
        let ellipsoid = |(z, axes): (f64, Vec<Vector3<f64>>)| {
            let centre = hull.vertex_points().position(|p| p.z == z)?;
            let at = Vector3::new(0.0, 0.0, z);
            Some(Ellipsoid { centre, at, axes })
        };
        Some(Self {
            ellipsoids: ends.into_iter().map(ellipsoid).collect::<Option<_>>()?,
            radius: shape.rounding_radius(),
            hull,
        })
    }
}

/// A part of a body that is not convex.
#[derive(Clone, Debug)]
struct Part {
    points: Vec<usize>,
    radius: f64,
    /// The part itself, if it is not the hull of its points.
    curved: Option<Geometry>,
}

/// The points and the parts of a body that is not convex.
#[derive(Clone, Debug)]
pub(super) struct StatedParts {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) ellipsoids: Vec<Ellipsoid>,
    /// The points of each part.
    pub(super) parts: Vec<Vec<usize>>,
    pub(super) radii: Vec<f64>,
    /// Each part itself, if it is not the hull of its points; empty if all are.
    pub(super) curved: Vec<Option<Geometry>>,
    /// The parts are triangles, and what they enclose belongs to the body.
    pub(super) is_solid: bool,
}

impl StatedParts {
    pub(super) fn of_mesh(mesh: &Mesh) -> Self {
        let part = |t: [u32; 3]| Part {
            points: t.map(|k| k as usize).to_vec(),
            radius: 0.0,
            curved: None,
        };
        let parts = mesh.triangle_vertices().into_iter().map(part).collect();
        Self::sorted(mesh.vertices(), Vec::new(), parts, mesh.kind() == MeshKind::Solid)
    }

    /// Returns triangles with a radius.
    #[cfg(feature = "surfaces")]
    pub(super) fn of_thick(points: Vec<Point3<f64>>, parts: Vec<[usize; 3]>, radius: f64) -> Self {
        let part = |points: [usize; 3]| Part {
            points: points.to_vec(),
            radius,
            curved: None,
        };
        Self::sorted(points, Vec::new(), parts.into_iter().map(part).collect(), false)
    }

    /// Returns the pieces, or `None` if one has no form in a receipt.
    pub(super) fn of_compound(compound: &Compound) -> Option<Self> {
        let (mut points, mut ellipsoids, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for piece in compound.pieces() {
            let stated = StatedHull::of_shape(&piece.shape)?;
            let (first, pose): (usize, &Isometry3<f64>) = (points.len(), &piece.pose);
            points.extend(stated.hull.vertex_points().map(|p| pose * p));
            parts.push(Part {
                points: (first..points.len()).collect(),
                radius: stated.radius,
                curved: (!stated.ellipsoids.is_empty()).then(|| alone(piece)).flatten(),
            });
            ellipsoids.extend(stated.ellipsoids.into_iter().map(|of| Ellipsoid {
                centre: first + of.centre,
                at: points[first + of.centre].coords,
                axes: of.axes.iter().map(|v| pose.rotation * v).collect(),
            }));
        }
        Some(Self::sorted(points, ellipsoids, parts, false))
    }

    fn sorted(points: Vec<Point3<f64>>, ellipsoids: Vec<Ellipsoid>, parts: Vec<Part>, is_solid: bool) -> Self {
        let middle = |part: &Part| {
            let sum: Vector3<f64> = part.points.iter().map(|k| points[*k].coords).sum();
            sum / part.points.len() as f64
        };
        let mut parts: Vec<(Vector3<f64>, Part)> = parts.into_iter().map(|part| (middle(&part), part)).collect();
        sort(&mut parts);
        let mut stated = Self {
            points,
            ellipsoids,
            parts: Vec::new(),
            radii: Vec::new(),
            curved: Vec::new(),
            is_solid,
        };
        for (_, part) in parts {
            stated.parts.push(part.points);
            stated.radii.push(part.radius);
            stated.curved.push(part.curved);
        }
        if stated.ellipsoids.is_empty() {
            stated.curved.clear();
        }
        stated
    }
}

/// Returns a compound of one piece.
fn alone(piece: &Piece) -> Option<Geometry> {
    Compound::new(vec![piece.clone()]).ok().map(Geometry::from)
}

/// Sorts parts such that the lower and the upper half are apart along the longest axis, and so on.
fn sort(parts: &mut [(Vector3<f64>, Part)]) {
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
        x.0[axis]
            .total_cmp(&y.0[axis])
            .then_with(|| x.1.points.cmp(&y.1.points))
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
