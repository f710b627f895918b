//! Random, thin, almost flat and untidy bodies, mostly as points alone.

use super::Shape;
use super::solids::{cuboid, ring};
use crate::pose::{add, scale};
use crate::rng::Rng;
use crate::{Point, Pose};

/// Returns `n` random points on the unit sphere.
pub fn sphere(rng: &mut Rng, n: usize) -> Shape {
    Shape::hull(format!("sphere {n}"), (0..n).map(|_| rng.unit()).collect())
}

/// Returns `n` random points on an ellipsoid with half axes `axes`.
pub fn ellipsoid(rng: &mut Rng, n: usize, axes: Point) -> Shape {
    let s = sphere(rng, n).stretched(axes);
    Shape {
        name: format!("ellipsoid {n} {axes:?}"),
        ..s
    }
}

/// Returns `n` random points in the unit ball: most points of a large cloud are interior.
pub fn ball(rng: &mut Rng, n: usize) -> Shape {
    Shape::hull(format!("ball {n}"), (0..n).map(|_| rng.in_ball()).collect())
}

/// Returns a flat body: `n` random points squeezed to `thickness` and rotated at random.
pub fn sliver(rng: &mut Rng, n: usize, thickness: f64) -> Shape {
    let turn = Pose::new(rng.quat(), [0.0; 3]);
    let s = sphere(rng, n).stretched([1.0, 1.0, thickness]).moved(&turn);
    Shape {
        name: format!("sliver {n} {thickness:e}"),
        ..s
    }
}

/// Returns a thin body: `n` random points squeezed to `width` in two directions and rotated at
/// random.
pub fn needle(rng: &mut Rng, n: usize, width: f64) -> Shape {
    let turn = Pose::new(rng.quat(), [0.0; 3]);
    let s = sphere(rng, n).stretched([1.0, width, width]).moved(&turn);
    Shape {
        name: format!("needle {n} {width:e}"),
        ..s
    }
}

/// Returns a box with a ridge higher by `height` on its top: two almost coplanar roof faces.
pub fn roof(height: f64) -> Shape {
    let mut points = cuboid([1.0, 1.0, 0.5]).points;
    points.extend([[-1.0, 0.0, 0.5 + height], [1.0, 0.0, 0.5 + height]]);
    Shape::hull(format!("roof {height:e}"), points)
}

/// Returns a box with a tip higher by `height` on its top: four almost coplanar faces.
pub fn pyramid_lid(height: f64) -> Shape {
    let mut points = cuboid([1.0, 1.0, 0.5]).points;
    points.push([0.0, 0.0, 0.5 + height]);
    Shape::hull(format!("lid {height:e}"), points)
}

/// Returns a prism of `n` sides closed by a cap of `rings` rings that rises by `height`: a fan and
/// bands of almost coplanar faces.
pub fn cap(n: usize, rings: usize, height: f64) -> Shape {
    let mut points = ring(n, 1.0, -0.5);
    for i in 0..rings {
        let r = 1.0 - i as f64 / rings as f64;
        points.extend(ring(n, r, height * (1.0 - r * r)));
    }
    points.push([0.0, 0.0, height]);
    Shape::hull(format!("cap {n} {rings} {height:e}"), points)
}

/// Returns a box whose top is a grid of `(k + 1)^2` points of a paraboloid that rises by `height`.
pub fn dome(k: usize, height: f64) -> Shape {
    let at = |i| 2.0 * i as f64 / k as f64 - 1.0;
    let mut points = vec![
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [1.0, 1.0, -1.0],
    ];
    for i in 0..=k {
        points.extend((0..=k).map(|j| [at(i), at(j), height * (1.0 - 0.5 * (at(i) * at(i) + at(j) * at(j)))]));
    }
    Shape::hull(format!("dome {k} {height:e}"), points)
}

/// Returns `n` random points with integer coordinates in `-k..=k`.
///
/// Many are duplicates, collinear or coplanar, and all points may even be coplanar.
pub fn lattice(rng: &mut Rng, n: usize, k: i64) -> Shape {
    let mut point = || std::array::from_fn(|_| rng.int(-k, k) as f64);
    Shape::hull(format!("lattice {n} {k}"), (0..n).map(|_| point()).collect())
}

/// Returns all points of a cubic grid with `k + 1` points per side on the cube of half size 1,
/// including interior points.
pub fn grid(k: usize) -> Shape {
    let at = |i| 2.0 * i as f64 / k as f64 - 1.0;
    let point = |m: usize| [at(m / (k + 1) / (k + 1)), at(m / (k + 1) % (k + 1)), at(m % (k + 1))];
    Shape::hull(format!("grid {k}"), (0..(k + 1).pow(3)).map(point).collect())
}

/// Returns a box of half sizes `h` with every edge and vertex cut by `chamfer`: slim rectangles and
/// tiny triangles next to large faces.
pub fn chamfered(h: Point, chamfer: f64) -> Shape {
    let inset = |p: Point, keep: usize| {
        std::array::from_fn(|i| {
            if i == keep {
                p[i]
            } else {
                p[i] - p[i].signum() * chamfer
            }
        })
    };
    let points = cuboid(h)
        .points
        .iter()
        .flat_map(|&p| (0..3).map(move |keep| inset(p, keep)))
        .collect();
    Shape::hull(format!("chamfered {chamfer:e}"), points)
}

/// Returns the same hull with a third more points, in random order and without faces.
///
/// Some points are duplicates, some are interior, and some are midpoints of two points of one face:
/// on the face if that is exact, otherwise off it by rounding.
pub fn dirty(shape: &Shape, rng: &mut Rng) -> Shape {
    let mut points = shape.points.clone();
    let n = points.len();
    let centre = scale(points.iter().fold([0.0; 3], |s, &p| add(s, p)), 1.0 / n as f64);
    for _ in 0..n.div_ceil(9) {
        let p = *rng.pick(&shape.points);
        let inner = rng.range(0.1, 0.9);
        points.extend([p, add(scale(p, inner), scale(centre, 1.0 - inner))]);
        if !shape.faces.is_empty() {
            let face = rng.pick(&shape.faces);
            let [a, b] = [(); 2].map(|()| shape.points[*rng.pick(face) as usize]);
            points.push(scale(add(a, b), 0.5));
        }
    }
    rng.shuffle(&mut points);
    Shape::hull(format!("dirty {}", shape.name), points)
}
