//! Promise: a cloud is measured as the union of its elements: every answer agrees with the answers
//! for the elements one by one.

mod build;
mod grazing;
mod queries;
mod uses;

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Cloud, CloudElement, Compound, ContactState, ConvexPolyhedron, Geometry, Mesh, PairTracker, Piece, RelativePose,
    Shape,
};
use truth::rng::Rng;

fn vector(rng: &mut Rng, size: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.range(-size, size))
}

fn rotation(rng: &mut Rng) -> UnitQuaternion<f64> {
    UnitQuaternion::new(vector(rng, 3.0))
}

fn pick(rng: &mut Rng, n: usize) -> usize {
    (rng.range(0.0, n as f64) as usize).min(n - 1)
}

const FAMILIES: usize = 7;

/// Returns points within about `size`: anywhere, on a lattice, a line, a plane, repeated, one, or
/// with an outlier.
fn points(rng: &mut Rng, family: usize, size: f64) -> Vec<Point3<f64>> {
    let count = 2 + pick(rng, 70);
    let direction = vector(rng, 1.0);
    let mut all: Vec<Point3<f64>> = (0..count)
        .map(|_| {
            let p = vector(rng, 1.0);
            Point3::from(match family {
                1 => p.map(|x| (x * 4.0).round() / 4.0) * size,
                2 => direction * (p.x * size),
                3 => Vector3::new(p.x, p.y, 0.25) * size,
                4 => p.map(f64::signum) * size,
                _ => p * size,
            })
        })
        .collect();
    match family {
        5 => all.truncate(1),
        6 => all.push(Point3::new(1e30 * size, 0.0, 0.0)),
        _ => {}
    }
    all
}

/// Returns an element and the shapes that it puts at the points.
fn element(rng: &mut Rng, kind: usize, count: usize, size: f64) -> (CloudElement, Vec<Shape>) {
    let ball = |radius: f64| {
        if radius > 0.0 {
            Shape::ball(radius).unwrap()
        } else {
            Shape::from(ConvexPolyhedron::point(Point3::origin()).unwrap())
        }
    };
    let radius = size * rng.range(0.01, 0.2);
    let same = |shape: Shape| vec![shape; count];
    match kind {
        0 => (CloudElement::Ball(radius), same(ball(radius))),
        1 => (CloudElement::Ball(0.0), same(ball(0.0))),
        2 => {
            let radii = (0..count).map(|k| if k % 3 == 0 { 0.0 } else { size * rng.range(0.01, 0.2) });
            let radii: Vec<f64> = radii.collect();
            let shapes = radii.iter().map(|r| ball(*r)).collect();
            (CloudElement::Balls(radii), shapes)
        }
        3 => {
            let half = Vector3::from_fn(|_, _| size * rng.range(0.01, 0.2));
            (CloudElement::Box(half), same(Shape::cuboid(half).unwrap()))
        }
        4 => {
            let shape = Shape::cylinder(radius, radius * 0.7).unwrap();
            (CloudElement::Shape(shape.clone()), same(shape))
        }
        _ => {
            let half = Vector3::from_fn(|_, _| size * rng.range(0.01, 0.2));
            let hull = solids::random_hull(9, half, 3).unwrap();
            let shape = Shape::from(hull);
            (CloudElement::Shape(shape.clone()), same(shape))
        }
    }
}

const ELEMENTS: usize = 6;
const OTHERS: usize = 13;

/// Returns the other body: convex, a compound, a mesh or a cloud.
fn other(rng: &mut Rng, kind: usize, size: f64) -> Geometry {
    let s = size * rng.range(0.2, 1.0);
    let hull = |n: usize| solids::random_hull(n, Vector3::new(s, s * 0.7, s * 0.5), 7).unwrap();
    match kind {
        0 => Geometry::from(hull(24)),
        1 => Geometry::from(solids::cuboid(Vector3::new(s, s, s * 0.25)).unwrap()),
        2 => Geometry::from(ConvexPolyhedron::point(Point3::from(vector(rng, s))).unwrap()),
        3 => Geometry::from(
            ConvexPolyhedron::segment(Point3::from(vector(rng, s)), Point3::from(vector(rng, s))).unwrap(),
        ),
        4 => Geometry::from(Shape::ball(s).unwrap()),
        5 => Geometry::from(Shape::capsule(s, s * 0.25).unwrap()),
        6 => Geometry::from(Shape::from(hull(12)).rounded(s * 0.125).unwrap()),
        7 => Geometry::from(Shape::cylinder(s, s * 0.5).unwrap()),
        8 => Geometry::from(Shape::ellipsoid(Vector3::new(s, s * 0.5, s * 0.75)).unwrap()),
        9 => {
            let mut other = Piece::new(solids::cuboid(Vector3::new(s, s * 0.25, s * 0.25)).unwrap());
            other.pose = Isometry3::from_parts(vector(rng, s).into(), rotation(rng));
            Geometry::from(Compound::new(vec![Piece::new(Shape::ball(s * 0.5).unwrap()), other]).unwrap())
        }
        10 => Geometry::from(Mesh::from_convex(&hull(30)).unwrap()),
        11 => {
            let all: Vec<_> = (0..12).map(|_| Point3::from(vector(rng, s))).collect();
            let triangles: Vec<[u32; 3]> = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            Geometry::from(Mesh::new(&all, &triangles).unwrap())
        }
        _ => {
            let at = points(rng, 0, s);
            Geometry::from(Cloud::new(&at, CloudElement::Ball(s * 0.0625)).unwrap())
        }
    }
}

/// The least distance over the elements, one by one.
struct Brute {
    lower: f64,
    upper: f64,
    /// Whether an element overlaps.
    is_overlap: bool,
    /// Whether the state of an element that may overlap is undecided.
    is_clear: bool,
}

fn brute(cloud: &[Point3<f64>], shapes: &[Shape], other: &Geometry, poses: &[Isometry3<f64>; 2]) -> Brute {
    let mut found = Brute {
        lower: f64::INFINITY,
        upper: f64::INFINITY,
        is_overlap: false,
        is_clear: true,
    };
    for (p, shape) in cloud.iter().zip(shapes) {
        let at = poses[0] * Isometry3::from_parts(Translation3::from(p.coords), UnitQuaternion::identity());
        let pose = RelativePose::new(&at, &poses[1]).unwrap();
        let one = PairTracker::new().closest(shape, other, &pose);
        found.is_overlap |= one.state == ContactState::Overlapping;
        found.is_clear &= one.state == ContactState::Separated || one.state == ContactState::Overlapping;
        found.lower = found.lower.min(one.lower.max(0.0));
        found.upper = found.upper.min(one.upper.max(0.0));
    }
    if found.is_overlap {
        (found.lower, found.upper) = (0.0, 0.0);
    }
    found
}

/// Whether an element is at most `d` from the other body.
fn brute_within(
    cloud: &[Point3<f64>],
    shapes: &[Shape],
    other: &Geometry,
    poses: &[Isometry3<f64>; 2],
    d: f64,
) -> bool {
    cloud.iter().zip(shapes).any(|(p, shape)| {
        let at = poses[0] * Isometry3::from_parts(Translation3::from(p.coords), UnitQuaternion::identity());
        let pose = RelativePose::new(&at, &poses[1]).unwrap();
        PairTracker::new().within(shape, other, &pose, d)
    })
}
