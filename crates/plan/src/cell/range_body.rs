//! Bodies as bounds over ranges see them: a convex outer part, and for bodies that are not convex a
//! tree of parts.

use std::collections::BTreeSet;
use std::vec::Vec;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::extremes::Extremes;
use crate::fingerprint::Fingerprint;
use lin_canny::polyhedron::BoxHint;
use lin_canny::shape::Core;
use lin_canny::{ConvexPolyhedron, Geometry, PointQuery, Shape};

/// Steps of the search for a small ball.
const BALL_STEPS: usize = 64;

/// Sides of the prism around a cylinder or cone.
const SIDES: usize = 32;

/// Most triangles of a leaf of a tree.
const LEAF: usize = 4;

/// Directions whose support vertices stand for a body of more points.
const DIRECTIONS: usize = 48;

/// Most points of a part that is not replaced by its box.
const MOST_POINTS: usize = 48;

/// Points, coordinate by coordinate.
#[derive(Default)]
pub(crate) struct Points([Vec<f64>; 3]);

impl Points {
    fn new(points: &[Point3<f64>]) -> Self {
        Self([0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect()))
    }

    pub(crate) fn len(&self) -> usize {
        self.0[0].len()
    }

    pub(crate) fn get(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.0[0][k], self.0[1][k], self.0[2][k])
    }

    pub(crate) fn each(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        (0..self.len()).map(|k| self.get(k).into())
    }

    /// Writes `n . x + b` for each point.
    pub(crate) fn heights(&self, n: &Vector3<f64>, b: f64, values: &mut Vec<f64>) {
        let [x, y, z] = &self.0;
        values.clear();
        let each = x.iter().zip(y).zip(z);
        values.extend(each.map(|((x, y), z)| n.x * x + n.y * y + n.z * z + b));
    }

    /// Adds `factor |matrix x + offset|` to the value of each point.
    pub(crate) fn add_norms(&self, matrix: &Matrix3<f64>, offset: &Vector3<f64>, factor: f64, values: &mut [f64]) {
        let [x, y, z] = &self.0;
        let row = |k: usize| (matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)], offset[k]);
        let (first, second, third) = (row(0), row(1), row(2));
        for (((value, x), y), z) in values.iter_mut().zip(x).zip(y).zip(z) {
            let at = |r: (f64, f64, f64, f64)| r.0 * x + r.1 * y + r.2 * z + r.3;
            let (u, v, w) = (at(first), at(second), at(third));
            *value += factor * (u * u + v * v + w * w).sqrt();
        }
    }

    /// Takes `h |n . x + b|` off the value of each point.
    pub(crate) fn lower_by(&self, n: &Vector3<f64>, b: f64, h: f64, values: &mut [f64]) {
        let [x, y, z] = &self.0;
        for (((value, x), y), z) in values.iter_mut().zip(x).zip(y).zip(z) {
            *value -= h * (n.x * x + n.y * y + n.z * z + b).abs();
        }
    }
}

/// The convex hull of points, rounded by a radius: it contains a body or a part of it.
pub(crate) struct Part {
    pub(crate) points: Points,
    pub(crate) radius: f64,
    /// A ball around the points, without the radius.
    pub(crate) ball: (Point3<f64>, f64),
    /// The parts that it is made of: first and last.
    pub(crate) children: [usize; 2],
    /// Few of the points, and a distance: all points are within it of the hull of the few.
    pub(crate) coarse: Option<(Points, f64)>,
}

impl Part {
    fn new(points: &[Point3<f64>], radius: f64) -> Self {
        Self {
            ball: small_ball(points),
            points: Points::new(points),
            radius,
            children: [0; 2],
            coarse: None,
        }
    }

    /// Returns a convex part that is a whole body. If it has many points, a few of them bound it first.
    fn whole(points: &[Point3<f64>], radius: f64) -> Self {
        Self {
            coarse: coarse(points),
            ..Self::new(points, radius)
        }
    }

    /// Returns by how much few points bound less than all.
    pub(crate) fn slack(&self) -> f64 {
        self.coarse.as_ref().map_or(0.0, |coarse| coarse.1)
    }

    pub(crate) fn has_children(&self) -> bool {
        self.children != [0; 2]
    }
}

/// A body of a pair.
pub(crate) struct RangeBody {
    /// The first part contains the body; the leaves together are its surface, if it is not convex.
    pub(crate) parts: Vec<Part>,
    /// A convex body around a body that is not convex.
    pub(crate) outer: Option<Geometry>,
    /// Outward normal of a half-space.
    pub(crate) plane: Option<Vector3<f64>>,
    /// Points of a cloud, which its parts do not hold.
    cloud: Vec<Point3<f64>>,
    /// A hash of all parts and of the points of a cloud.
    pub(crate) fingerprint: u64,
}

impl RangeBody {
    pub(crate) fn new(geometry: &Geometry) -> Self {
        let mut body = Self::unmarked(geometry);
        body.fingerprint = body.hash();
        body
    }

    fn unmarked(geometry: &Geometry) -> Self {
        let one = |part| Self {
            parts: std::vec![part],
            outer: None,
            plane: None,
            cloud: Vec::new(),
            fingerprint: 0,
        };
        match geometry {
            Geometry::Polyhedron(body) => one(Part::whole(&vertices(body), 0.0)),
            Geometry::Convex(shape) => {
                let (points, radius) = of_shape(shape);
                one(Part::whole(&points, radius))
            }
            Geometry::Mesh(mesh) => {
                let triangles: Vec<Vec<Point3<f64>>> = mesh.triangles().map(|(_, t)| t.to_vec()).collect();
                let hull = mesh.hull().map_or_else(|_| box_of(mesh.aabb()), |hull| vertices(&hull));
                Self::tree(&hull, 0.0, triangles.into_iter().map(|t| (t, 0.0)).collect())
            }
            Geometry::Compound(compound) => {
                let pieces = compound.pieces().iter().map(|piece| {
                    let (points, radius) = of_shape(&piece.shape);
                    (points.iter().map(|p| piece.pose * p).collect(), radius)
                });
                let pieces: Vec<(Vec<Point3<f64>>, f64)> = pieces.collect();
                let radius = pieces.iter().map(|piece| piece.1).fold(0.0, f64::larger);
                let all: Vec<Point3<f64>> = pieces.iter().flat_map(|piece| piece.0.iter().copied()).collect();
                let hull = ConvexPolyhedron::from_points(&all).map_or(all, |hull| vertices(&hull));
                Self::tree(&hull, radius, pieces)
            }
            Geometry::HalfSpace(plane) => Self {
                plane: Some(plane.normal().into_inner()),
                ..one(Part::new(&[plane.foot()], 0.0))
            },
            _ => {
                let corners = box_of(geometry.aabb_at(&Isometry3::identity(), &mut BoxHint::default()));
                Self {
                    outer: outer(&corners, 0.0),
                    cloud: match geometry {
                        Geometry::Cloud(cloud) => cloud.points(),
                        _ => Vec::new(),
                    },
                    ..one(Part::new(&corners, 0.0))
                }
            }
        }
    }

    fn hash(&self) -> u64 {
        let mut all = Fingerprint::new();
        let normal = self.plane.iter().map(|n| Point3::from(*n));
        let points = self.parts.iter().flat_map(|part| part.points.each());
        for p in points.chain(normal).chain(self.cloud.iter().copied()) {
            p.iter().for_each(|x| all.number(*x));
        }
        self.parts.iter().for_each(|part| all.number(part.radius));
        all.0
    }

    /// Returns whether a convex body stands for this one.
    pub(crate) fn is_outer(&self) -> bool {
        self.outer.is_some()
    }

    /// Returns the greatest distance of a point of the body from its origin; of a half-space that of
    /// a point of its plane.
    pub(crate) fn reach(&self) -> f64 {
        let Part { ball, radius, .. } = &self.parts[0];
        ball.0.coords.abs().sum() + ball.1 + radius
    }

    /// Returns a body made of pieces, below a part that contains all of them.
    fn tree(hull: &[Point3<f64>], radius: f64, pieces: Vec<(Vec<Point3<f64>>, f64)>) -> Self {
        let mut body = Self {
            parts: std::vec![Part::whole(hull, radius)],
            outer: outer(hull, radius),
            plane: None,
            cloud: Vec::new(),
            fingerprint: 0,
        };
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        body.split(0, &mut order, &pieces);
        body
    }

    /// Divides the pieces of a part into two, until few are left.
    fn split(&mut self, part: usize, order: &mut [usize], pieces: &[(Vec<Point3<f64>>, f64)]) {
        if order.len() < 2 || (order.len() <= LEAF && part != 0) {
            return;
        }
        let middle = |k: usize| {
            let points = &pieces[k].0;
            points.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / points.len() as f64
        };
        let (low, high) = extent(order.iter().map(|k| middle(*k)));
        let axis = (high - low).imax();
        order.sort_by(|x, y| middle(*x)[axis].total_cmp(&middle(*y)[axis]).then(x.cmp(y)));
        let (left, right) = order.split_at_mut(order.len() / 2);
        let first = self.parts.len();
        for half in [&*left, &*right] {
            let points: Vec<Point3<f64>> = half.iter().flat_map(|k| pieces[*k].0.iter().copied()).collect();
            let radius = half.iter().map(|k| pieces[*k].1).fold(0.0, f64::larger);
            self.parts.push(Part::new(&few(points), radius));
        }
        self.parts[part].children = [first, first + 1];
        self.split(first, left, pieces);
        self.split(first + 1, right, pieces);
    }
}

fn vertices(body: &ConvexPolyhedron) -> Vec<Point3<f64>> {
    body.vertex_points().collect()
}

/// Returns the hull of points, rounded by a radius; `None` if the points are flat.
fn outer(points: &[Point3<f64>], radius: f64) -> Option<Geometry> {
    let hull = ConvexPolyhedron::from_points(points).ok()?;
    match radius > 0.0 {
        true => Some(Shape::from(hull).rounded(radius).ok()?.into()),
        false => Some(hull.into()),
    }
}

/// Returns the corners of a box.
fn box_of((low, high): (Point3<f64>, Point3<f64>)) -> Vec<Point3<f64>> {
    let ends = [low, high];
    let corner = |m: usize| Point3::new(ends[m & 1].x, ends[m >> 1 & 1].y, ends[m >> 2 & 1].z);
    (0..8).map(corner).collect()
}

/// Returns the least and the greatest coordinates of vectors.
fn extent(vectors: impl Iterator<Item = Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    vectors.fold(none, |(low, high), v| {
        (low.zip_map(&v, f64::smaller), high.zip_map(&v, f64::larger))
    })
}

/// Returns the points once each, or the corners of their box if they are many.
fn few(mut points: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let key = |p: &Point3<f64>| [p.x, p.y, p.z];
    points.sort_by(|p, q| {
        let (p, q) = (key(p), key(q));
        p[0].total_cmp(&q[0])
            .then(p[1].total_cmp(&q[1]))
            .then(p[2].total_cmp(&q[2]))
    });
    points.dedup();
    if points.len() <= MOST_POINTS {
        return points;
    }
    let (low, high) = extent(points.iter().map(|p| p.coords));
    box_of((low.into(), high.into()))
}

/// Returns points whose hull contains the core of a shape, and its rounding radius.
fn of_shape(shape: &Shape) -> (Vec<Point3<f64>>, f64) {
    let round = |radius: f64, z: f64| {
        let angle = core::f64::consts::PI / SIDES as f64;
        let far = radius / libm::cos(angle) * (1.0 + 16.0 * f64::EPSILON);
        (0..SIDES).map(move |k| {
            let (sine, cosine) = libm::sincos(2.0 * angle * k as f64);
            Point3::new(far * cosine, far * sine, z)
        })
    };
    let cuboid = |half: Vector3<f64>| box_of(((-half).into(), half.into()));
    let points = match shape.core() {
        Core::Polyhedron(body) => vertices(body),
        Core::Cylinder(cylinder) => [-1.0, 1.0]
            .into_iter()
            .flat_map(|sign| round(cylinder.radius(), sign * cylinder.half_height()))
            .collect(),
        Core::Cone(cone) => {
            let apex = Point3::new(0.0, 0.0, cone.half_height());
            let base = round(cone.radius(), -cone.half_height());
            base.chain(core::iter::once(apex)).collect()
        }
        Core::Ellipsoid(body) => cuboid(body.semi_axes()),
        _ => {
            let (centre, radius) = shape.bounding_ball();
            return ([centre].into(), radius);
        }
    };
    (points, shape.rounding_radius())
}

/// Returns few of many points, and an upper bound of the distance of all points from their hull;
/// `None` if the points are few or flat.
fn coarse(points: &[Point3<f64>]) -> Option<(Points, f64)> {
    if points.len() <= 2 * DIRECTIONS {
        return None;
    }
    // Even directions: heights in equal steps, turned by the golden angle.
    let turn = core::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let support = |k: usize| {
        let z = (2 * k + 1) as f64 / DIRECTIONS as f64 - 1.0;
        let (sine, cosine) = libm::sincos(turn * k as f64);
        let across = (1.0 - z * z).sqrt();
        let n = Vector3::new(cosine * across, sine * across, z);
        let each = points.iter().enumerate().map(|(k, p)| (k, n.dot(&p.coords)));
        each.fold(
            (0, f64::NEG_INFINITY),
            |best, next| if next.1 > best.1 { next } else { best },
        )
        .0
    };
    let few: BTreeSet<usize> = (0..DIRECTIONS).map(support).collect();
    let few: Vec<Point3<f64>> = few.into_iter().map(|k| points[k]).collect();
    let hull = Geometry::from(ConvexPolyhedron::from_points(&few).ok()?);
    let query = PointQuery::new(&hull);
    let mut radius = 0.0;
    for point in points {
        let found = query.closest_point(point).ok()?;
        radius = found.upper.larger(radius);
    }
    Some((Points::new(&few), radius))
}

/// Returns a small ball around points: steps towards the farthest point (Badoiu and Clarkson 2003).
fn small_ball(points: &[Point3<f64>]) -> (Point3<f64>, f64) {
    let Some(first) = points.first() else {
        return (Point3::origin(), 0.0);
    };
    let sum = points.iter().fold(Vector3::zeros(), |sum, p| sum + (p - first));
    let mut centre = first + sum / points.len() as f64;
    let farthest = |centre: &Point3<f64>| {
        let each = points.iter().map(|p| (p - centre).norm());
        each.enumerate()
            .fold((0, 0.0), |most, (k, d)| if d > most.1 { (k, d) } else { most })
    };
    let mut best = (centre, farthest(&centre));
    let mut now = best.1;
    for k in 1..BALL_STEPS {
        centre += (points[now.0] - centre) / (k as f64 + 1.0);
        now = farthest(&centre);
        if now.1 < best.1.1 {
            best = (centre, now);
        }
    }
    (best.0, best.1.1 * (1.0 + 16.0 * f64::EPSILON))
}
