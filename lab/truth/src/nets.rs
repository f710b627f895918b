//! Control points of curved surfaces.

use crate::pose::Point;
use crate::rng::Rng;

/// Returns control points of a patch of degrees `[p, q]` over a square of size 2, with heights up
/// to `bump`: rows of constant u.
pub fn bumps(rng: &mut Rng, [p, q]: [usize; 2], bump: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for i in 0..=p {
        for j in 0..=q {
            let (x, y) = (2.0 * i as f64 / p as f64 - 1.0, 2.0 * j as f64 / q as f64 - 1.0);
            points.push([x, y, bump * rng.range(-1.0, 1.0)]);
        }
    }
    points
}

/// Returns the profile of a vase as eight smooth cubic Bézier curves, each point
/// `[radius, height, weight]`.
///
/// They are the curves of a uniform cubic B-spline. A revolution in four quarter turns makes 32
/// patches.
pub fn vase() -> Vec<Vec<[f64; 3]>> {
    spline(&[
        [0.45, -1.1],
        [0.5, -1.0],
        [0.8, -0.85],
        [1.0, -0.5],
        [0.95, -0.1],
        [0.6, 0.2],
        [0.35, 0.4],
        [0.3, 0.6],
        [0.4, 0.8],
        [0.6, 0.95],
        [0.7, 1.05],
    ])
}

/// Returns the profile of a pot with a lid, from the bottom to the knob.
pub fn pot() -> Vec<Vec<[f64; 3]>> {
    spline(&[
        [-0.5, -0.72],
        [0.0, -0.7],
        [0.6, -0.72],
        [1.05, -0.55],
        [1.1, -0.1],
        [0.9, 0.3],
        [0.7, 0.45],
        [0.45, 0.6],
        [0.1, 0.65],
        [0.1, 0.75],
        [0.2, 0.9],
        [0.0, 1.0],
        [-0.2, 0.9],
    ])
}

/// Returns the Bézier curves of a uniform cubic B-spline.
fn spline(c: &[[f64; 2]]) -> Vec<Vec<[f64; 3]>> {
    let mixed = |k: usize, w: [f64; 3]| {
        let at = |x: usize| (w[0] * c[k][x] + w[1] * c[k + 1][x] + w[2] * c[k + 2][x]) / w.iter().sum::<f64>();
        [at(0), at(1), 1.0]
    };
    let piece = |k: usize| {
        vec![
            mixed(k, [1.0, 4.0, 1.0]),
            mixed(k, [0.0, 2.0, 1.0]),
            mixed(k, [0.0, 1.0, 2.0]),
            mixed(k + 1, [1.0, 4.0, 1.0]),
        ]
    };
    (0..c.len() - 3).map(piece).collect()
}

/// Returns control points of a twisted blade: a B-spline of degrees `[3, 3]` with `rows` by 7
/// points, rows along the blade.
pub fn blade(rows: usize) -> Vec<Point> {
    let profile: [[f64; 2]; 7] = [
        [0.5, 0.0],
        [0.45, 0.1],
        [0.0, 0.16],
        [-0.45, 0.06],
        [0.0, -0.04],
        [0.45, -0.02],
        [0.5, 0.0],
    ];
    let mut points = Vec::new();
    for k in 0..rows {
        let t = k as f64 / (rows - 1) as f64;
        let (sin, cos) = (0.9 * t).sin_cos();
        let size = 1.0 - 0.45 * t;
        points.extend(profile.map(|[x, y]| [size * (cos * x - sin * y), size * (sin * x + cos * y), 2.4 * t - 1.2]));
    }
    points
}
