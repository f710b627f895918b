//! Regular bodies with their faces.

use super::Shape;
use crate::pose::{add, cross, dot, scale, sub};
use crate::{Face, Point};
use std::f64::consts::TAU;

/// Returns a box of half sizes `h`. Point `4 i + 2 j + k` is at `x` sign `i`, `y` sign `j`, `z`
/// sign `k`.
pub fn cuboid(h: Point) -> Shape {
    let corner = |m: u32| std::array::from_fn(|i| if m >> (2 - i) & 1 == 1 { h[i] } else { -h[i] });
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let faces = faces.iter().map(|f| f.to_vec()).collect();
    Shape::new(format!("box {h:?}"), (0..8).map(corner).collect(), faces)
}

/// Returns `n` points of a circle of radius `r` at height `z`, counter-clockwise from above.
pub(super) fn ring(n: usize, r: f64, z: f64) -> Vec<Point> {
    let at = |i| TAU * i as f64 / n as f64;
    (0..n).map(|i| [r * at(i).cos(), r * at(i).sin(), z]).collect()
}

/// Returns an upright prism over a regular `n`-gon of radius `r`, with half height `h`.
pub fn prism(n: usize, r: f64, h: f64) -> Shape {
    let points = [ring(n, r, -h), ring(n, r, h)].concat();
    let m = n as u32;
    let mut faces: Vec<Face> = (0..m)
        .map(|i| [i, (i + 1) % m, (i + 1) % m + m, i + m].to_vec())
        .collect();
    faces.push((0..m).rev().collect());
    faces.push((m..2 * m).collect());
    Shape::new(format!("prism {n}"), points, faces)
}

/// Returns a plate of half sizes `h` whose upright edges are rounded by `k` points each, with a
/// radius of half the shorter side.
///
/// Between the corners its sides are straight. For `k = 1` it is a box.
pub fn rounded_plate(h: Point, k: usize) -> Shape {
    let r = 0.5 * h[0].min(h[1]);
    let quarter = |i: usize| if k > 1 { i as f64 / (k - 1) as f64 } else { 0.5 };
    let corner = |i: usize| {
        let (y, x) = (0.25 * TAU * quarter(i)).sin_cos();
        if k > 1 {
            [h[0] - r + r * x, h[1] - r + r * y]
        } else {
            [h[0], h[1]]
        }
    };
    let mut points = Vec::new();
    for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
        for [x, y] in (0..k).map(corner) {
            points.extend([-h[2], h[2]].map(|z| [signs[0] * x, signs[1] * y, z]));
        }
    }
    Shape::hull(format!("plate {}", 4 * k), points)
}

/// Returns a cone over a regular `n`-gon of radius `r` at `z = 0`, with its tip (the last point, of
/// valence `n`) at height `h`.
pub fn cone(n: usize, r: f64, h: f64) -> Shape {
    let mut points = ring(n, r, 0.0);
    points.push([0.0, 0.0, h]);
    let m = n as u32;
    let mut faces: Vec<Face> = (0..m).map(|i| vec![i, (i + 1) % m, m]).collect();
    faces.push((0..m).rev().collect());
    Shape::new(format!("cone {n}"), points, faces)
}

/// Returns the regular tetrahedron in the cube of half size 1.
pub fn tetrahedron() -> Shape {
    let points = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    Shape::hull("tetrahedron", points).solved()
}

/// Returns the cube of half size 1.
pub fn cube() -> Shape {
    Shape {
        name: "cube".into(),
        ..cuboid([1.0; 3])
    }
}

/// Returns the octahedron with vertices at distance 1.
pub fn octahedron() -> Shape {
    let tips = (0..6).map(|i| std::array::from_fn(|k| if k == i / 2 { 1.0 - 2.0 * (i % 2) as f64 } else { 0.0 }));
    Shape::hull("octahedron", tips.collect()).solved()
}

/// The golden ratio.
const PHI: f64 = 1.618_033_988_749_895;

/// Returns the icosahedron of edge 2.
pub fn icosahedron() -> Shape {
    let mut points = Vec::new();
    for i in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.push(std::array::from_fn(|k| [0.0, s, t * PHI][(k + 3 - i) % 3]));
        }
    }
    Shape::hull("icosahedron", points).solved()
}

/// Returns the dodecahedron of edge `2 / PHI`.
///
/// Its pentagons are planar only up to rounding: the dual of the icosahedron defines them, and the
/// exact hull of the points may cut them.
pub fn dodecahedron() -> Shape {
    let mut points = cube().points;
    for i in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.push(std::array::from_fn(|k| [0.0, s / PHI, t * PHI][(k + 3 - i) % 3]));
        }
    }
    let tips = icosahedron().points;
    // The vertices of the icosahedron with y and z exchanged are above the faces.
    let faces = tips.iter().map(|n| rim_about(&points, [n[0], n[2], n[1]])).collect();
    Shape::new("dodecahedron", points, faces)
}

/// Returns the five points farthest along `n`, in order about it.
fn rim_about(points: &[Point], n: Point) -> Face {
    let mut ids: Vec<u32> = (0..points.len() as u32).collect();
    ids.sort_by(|&i, &j| dot(points[j as usize], n).total_cmp(&dot(points[i as usize], n)));
    ids.truncate(5);
    let u = sub(points[ids[0] as usize], points[ids[1] as usize]);
    let (u, v) = (u, cross(scale(n, 1.0 / dot(n, n).sqrt()), u));
    let centre = scale(ids.iter().fold([0.0; 3], |s, &i| add(s, points[i as usize])), 0.2);
    let angle = |i: u32| {
        let d = sub(points[i as usize], centre);
        dot(d, v).atan2(dot(d, u))
    };
    ids.sort_by(|&i, &j| angle(i).total_cmp(&angle(j)));
    ids
}

/// Returns the five Platonic solids.
pub fn platonic() -> [Shape; 5] {
    [tetrahedron(), cube(), octahedron(), dodecahedron(), icosahedron()]
}

/// Returns the geodesic sphere of frequency `2^level` over the icosahedron: `10 * 4^level + 2`
/// points and their triangles.
pub fn icosphere(level: usize) -> Shape {
    let base = icosahedron();
    let on_sphere = |p: Point| scale(p, 1.0 / dot(p, p).sqrt());
    let mut points: Vec<Point> = base.points.iter().map(|&p| on_sphere(p)).collect();
    let mut faces = base.faces;
    for _ in 0..level {
        let mut middle = std::collections::HashMap::new();
        let mut split = Vec::with_capacity(4 * faces.len());
        for f in &faces {
            let m = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
                let (a, b) = (f[i].min(f[j]), f[i].max(f[j]));
                *middle.entry((a, b)).or_insert_with(|| {
                    points.push(on_sphere(add(points[a as usize], points[b as usize])));
                    points.len() as u32 - 1
                })
            });
            split.extend([
                vec![f[0], m[0], m[2]],
                vec![f[1], m[1], m[0]],
                vec![f[2], m[2], m[1]],
                m.to_vec(),
            ]);
        }
        faces = split;
    }
    Shape::new(format!("icosphere {level}"), points, faces)
}
