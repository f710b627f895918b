//! Points and meshes over the rationals: side and distance, and points that are hard to judge.
//!
//! The judge tests every triangle. Signs come from floating point if their error bound leaves no
//! doubt, else from rationals. A segment to a random point outside counts the winding number; if it
//! meets an edge, another segment is drawn.

use crate::Point;
use crate::brute;
use crate::driven::exact_place::Place;
use crate::exact_meshes::square;
use crate::pose::{Pose, add, cross, norm, scale, sub};
use crate::rational::{RBig, exact};
use crate::rng::Rng;
use crate::soups::{self, Soup};

/// Returns the sign of the volume of four points: positive if `d` is above `a, b, c`.
pub fn side(a: Point, b: Point, c: Point, d: Point) -> i32 {
    let (u, v, w) = (sub(b, a), sub(c, a), sub(d, a));
    let (mut value, mut size) = (0.0, 0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (x, y) = (u[i] * v[j], u[j] * v[i]);
        value += (x - y) * w[k];
        size += (x.abs() + y.abs()) * w[k].abs();
    }
    // Seven roundings of each term, and far from underflow.
    if value.abs() > 1e-14 * size && size > 1e-280 {
        return if value > 0.0 { 1 } else { -1 };
    }
    let [a, b, c, d] = [a, b, c, d].map(|p| p.map(exact));
    let (u, v, w) = (minus(&b, &a), minus(&c, &a), minus(&d, &a));
    sign(&times(&across(&u, &v), &w))
}

type Exact3 = [RBig; 3];

fn minus(a: &Exact3, b: &Exact3) -> Exact3 {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn across(a: &Exact3, b: &Exact3) -> Exact3 {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn times(a: &Exact3, b: &Exact3) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn sign(x: &RBig) -> i32 {
    i32::from(*x > RBig::ZERO) - i32::from(*x < RBig::ZERO)
}

/// Returns whether a triangle contains a point.
fn is_on(t: [Point; 3], p: Point) -> bool {
    let reach = t.iter().map(|x| norm(sub(*x, t[0]))).fold(0.0, f64::max);
    if norm(sub(p, t[0])) > 2.0 * reach || side(t[0], t[1], t[2], p) != 0 {
        return false;
    }
    let [a, b, c] = t.map(|x| x.map(exact));
    let p = p.map(exact);
    let n = across(&minus(&b, &a), &minus(&c, &a));
    if sign(&times(&n, &n)) == 0 {
        return false;
    }
    [(&a, &b), (&b, &c), (&c, &a)]
        .iter()
        .all(|(x, y)| sign(&times(&across(&minus(y, x), &minus(&p, x)), &n)) >= 0)
}

/// Returns the location of a point by the rule of open meshes: on the surface or outside.
pub fn place_beside(soup: &Soup, p: Point) -> Place {
    let mut all = (0..soup.triangles.len()).map(|t| soup.corners(t));
    if all.any(|t| is_on(t, p)) {
        Place::On
    } else {
        Place::Outside
    }
}

/// Returns the location of a point by the winding number of the mesh.
pub fn place(soup: &Soup, p: Point, rng: &mut Rng) -> Place {
    let all = || (0..soup.triangles.len()).map(|t| soup.corners(t));
    if place_beside(soup, p) == Place::On {
        return Place::On;
    }
    let reach = 4.0 * (soup.radius() + norm(p));
    loop {
        let to = scale(rng.unit(), reach);
        let crossing = |[a, b, c]: [Point; 3]| {
            let (from, until) = (side(a, b, c, p), side(a, b, c, to));
            if from * until > 0 {
                return Some(0);
            }
            let turns = [side(p, to, a, b), side(p, to, b, c), side(p, to, c, a)];
            if turns.contains(&1) && turns.contains(&-1) {
                return Some(0);
            }
            // In the plane of a triangle that does not contain it, the point leaves the plane at once.
            if from == 0 && until != 0 {
                return Some(0);
            }
            (!turns.contains(&0) && until != 0).then_some(until)
        };
        if let Some(winding) = all().map(crossing).sum::<Option<i32>>() {
            return if winding == 0 { Place::Outside } else { Place::Inside };
        }
    }
}

/// Returns whether the distance of a point from one triangle is between two numbers.
pub fn is_between_of(corners: &[Point; 3], p: Point, lower: f64, upper: f64) -> bool {
    let square = square(&[p; 3], corners, &Pose::IDENTITY);
    let [lower, upper] = [lower, upper].map(|x| &exact(x) * &exact(x));
    lower <= square && square <= upper
}

/// Returns whether the distance of a point from the triangles is between two numbers.
pub fn is_between(soup: &Soup, p: Point, lower: f64, upper: f64) -> bool {
    // Floating point picks the triangles that may be closest, in a unit in which squares are in range.
    let unit = 2f64.powi(-(soup.radius() + norm(p)).log2() as i32);
    let near: Vec<f64> = (0..soup.triangles.len())
        .map(|t| brute::triangles(&[scale(p, unit); 3], &soup.corners(t).map(|x| scale(x, unit))))
        .collect();
    let level = near.iter().copied().fold(f64::INFINITY, f64::min) + 1e-12;
    let squares = (0..near.len()).filter(|t| near[*t] <= level);
    let least = squares
        .map(|t| square(&[p; 3], &soup.corners(t), &Pose::IDENTITY))
        .min();
    let [lower, upper] = [lower, upper].map(|x| &exact(x) * &exact(x));
    least.is_some_and(|d| lower <= d && d <= upper)
}

/// Number of the kinds of [`hard_point`].
pub const POINT_KINDS: usize = 12;

/// Returns a point that is hard to judge: on or within rounding of vertices, edges, faces, their
/// planes and planes of symmetry, on a lattice, near the surface, anywhere.
pub fn hard_point(soup: &Soup, kind: usize, rng: &mut Rng) -> Point {
    let size = soup.radius();
    let t = soup.corners(rng.below(soup.triangles.len()));
    let [a, b, c] = t;
    let stepped = |mut p: Point, rng: &mut Rng| {
        let k = rng.below(3);
        for _ in 0..rng.below(4) {
            p[k] = if rng.below(2) == 0 {
                p[k].next_up()
            } else {
                p[k].next_down()
            };
        }
        p
    };
    let middle = |[x, y, z]: [f64; 3]| add(scale(a, x), add(scale(b, y), scale(c, z)));
    let n = cross(scale(sub(b, a), 1.0 / size), scale(sub(c, a), 1.0 / size));
    let normal = scale(n, 1.0 / norm(n).max(f64::MIN_POSITIVE));
    match kind {
        0 => a,
        1 => stepped(a, rng),
        2 => stepped(scale(add(a, b), 0.5), rng),
        3 => {
            let off = size * [0.0, 1e-16, 1e-15, 1e-13][rng.below(4)] * rng.sign();
            add(middle([0.25, 0.5, 0.25]), scale(normal, off))
        }
        4 => {
            let step = 2f64.powi((size.log2().floor()) as i32 - 3);
            [0; 3].map(|_| step * rng.int(-9, 9) as f64)
        }
        5 => {
            let mut p = scale(rng.in_ball(), size);
            p[rng.below(3)] = 0.0;
            p[rng.below(3)] = a[rng.below(3)];
            p
        }
        6 => scale([0; 3].map(|_| rng.range(-1.0, 1.0)), 2.0 * size),
        7 => {
            let off = size * 10f64.powf(rng.range(-12.0, -1.0)) * rng.sign();
            let (x, y) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
            add(middle([x, y, 1.0 - x - y]), scale(normal, off))
        }
        // In the plane of a face, up to rounding.
        8 => {
            let (x, y) = (rng.int(-8, 8) as f64 / 4.0, rng.int(-8, 8) as f64 / 4.0);
            middle([x, y, 1.0 - x - y])
        }
        9 => {
            let mut p = a;
            p[rng.below(3)] = [5e-324, -5e-324, 1e-250 * size, 0.0][rng.below(4)];
            p
        }
        // Coordinates of several vertices: lines along the axes meet vertices and edges.
        10 => {
            let mut of = || soup.points[rng.below(soup.points.len())];
            let (p, q, r) = (of(), of(), of());
            [p[0], q[1], r[2]]
        }
        _ => scale(rng.unit(), size * 10f64.powf(rng.range(0.0, 12.0))),
    }
}

/// Number of the kinds of [`hard_mesh`].
pub const MESH_KINDS: usize = 14;

/// Returns a closed mesh: simple, with several components, nested, inside out, crossing itself,
/// touching itself.
pub fn hard_mesh(kind: usize, rng: &mut Rng) -> Soup {
    let cube = |at: Point, h: f64| {
        let shape = crate::shapes::cuboid([h; 3]);
        let triangles = shape.triangles();
        Soup::new(shape.points, triangles).map(|p| add(p, at))
    };
    match kind {
        0 => cube([0.0; 3], 1.0),
        1 => soups::sphere(3),
        2 => soups::torus(8, 6, 0.35),
        3 => soups::bracket(),
        4 => soups::gear(7),
        5 => soups::cave(2, 0.5),
        6 => soups::rock(3, rng.bits()),
        7 => soups::knot(40, 5, 0.25),
        // Overlapping, nested, and touching in a vertex, an edge and a face.
        8 => cube([0.0; 3], 1.0).with(&cube([0.5, 0.25, 1.0], 0.75)),
        9 => cube([0.0; 3], 1.0).with(&cube([0.0; 3], 0.5)),
        10 => cube([-0.5; 3], 0.5).with(&cube([0.5; 3], 0.5)),
        11 => cube([-0.5; 3], 0.5)
            .with(&cube([0.5, 0.5, -0.5], 0.5))
            .with(&cube([0.5, -0.5, -0.5], 0.5)),
        12 => soups::torus(7, 5, 0.4).flipped().with(&cube([2.0, 0.0, 0.0], 0.5)),
        _ => {
            // A cone with a fan of 80 triangles.
            let shape = crate::shapes::cone(80, 1.0, 1.0);
            let triangles = shape.triangles();
            Soup::new(shape.points, triangles)
        }
    }
}
