//! CAD-like meshes: turned and extruded parts, and a terrain.
//!
//! Their triangles are as long as the part and as narrow as its steps.

use std::f64::consts::TAU;

use crate::Point;
use crate::rng::Rng;
use crate::soups::Soup;

/// Joins loops of equally many points by two triangles per side; the first and the last loop are
/// fanned from `ends`.
fn skin(loops: &[Vec<Point>], ends: [Point; 2]) -> Soup {
    let (rows, m) = (loops.len(), loops[0].len());
    let mut soup = Soup::new(loops.iter().flatten().copied().chain(ends).collect(), Vec::new());
    let at = |i: usize, j: usize| (i * m + j % m) as u32;
    let (first, last) = ((rows * m) as u32, (rows * m) as u32 + 1);
    for j in 0..m {
        for i in 0..rows - 1 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            soup.triangles.extend([[a, b, c], [a, c, d]]);
        }
        soup.triangles.extend([
            [first, at(0, j + 1), at(0, j)],
            [last, at(rows - 1, j), at(rows - 1, j + 1)],
        ]);
    }
    soup
}

/// Returns a part turned on a lathe about z with `n` sides; `profile` has radii and heights from
/// the lower end up.
pub fn turned(n: usize, profile: &[[f64; 2]]) -> Soup {
    let circle = |&[r, z]: &[f64; 2]| {
        let point = |k: usize| {
            let (s, c) = (TAU * k as f64 / n as f64).sin_cos();
            [r * c, r * s, z]
        };
        (0..n).map(point).collect()
    };
    let loops: Vec<Vec<Point>> = profile.iter().map(circle).collect();
    let end = |k: usize| [0.0, 0.0, profile[k][1]];
    skin(&loops, [end(0), end(profile.len() - 1)])
}

/// Returns a shaft of `4 n` triangles: radius 1, length 10.
pub fn shaft(n: usize) -> Soup {
    turned(n, &[[1.0, -5.0], [1.0, 5.0]])
}

/// Returns a cone of `4 n` triangles with a blunt tip: radius 1, height 3.
pub fn cone(n: usize) -> Soup {
    turned(n, &[[1.0, 0.0], [0.01, 3.0]])
}

/// Returns a plain bearing of `8 n` triangles: a tube of length 4, with inner radius `r` and outer
/// radius 1.5.
pub fn bearing(n: usize, r: f64) -> Soup {
    let ring = [[r, -2.0], [1.5, -2.0], [1.5, 2.0], [r, 2.0]];
    let mut soup = Soup::default();
    for [r, z] in ring {
        soup.points.extend((0..n).map(|k| {
            let (s, c) = (TAU * k as f64 / n as f64).sin_cos();
            [r * c, r * s, z]
        }));
    }
    let at = |i: usize, j: usize| (i % 4 * n + j % n) as u32;
    for j in 0..n {
        for i in 0..4 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            soup.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    soup
}

/// Returns a link of a robot with `24 n` triangles: a tube of length 0.5 between two drums, with
/// collars and fillets of one step each.
pub fn link(n: usize) -> Soup {
    let half = [
        [0.09, -0.4],
        [0.1, -0.39],
        [0.1, -0.28],
        [0.07, -0.27],
        [0.06, -0.25],
        [0.06, -0.05],
    ];
    let other = half.iter().rev().map(|&[r, z]| [r, -z]);
    let profile: Vec<[f64; 2]> = half.iter().copied().chain(other).collect();
    turned(n, &profile)
}

/// Returns a tray of about `32 n` triangles with `n` steps per rounded corner: half extents 0.5 by
/// 0.35, walls 0.15 high and 0.01 thick.
pub fn tray(n: usize) -> Soup {
    let rounded = |inset: f64, z: f64| -> Vec<Point> {
        let corner = |k: usize| {
            let (s, c) = (TAU * k as f64 / (4 * n) as f64).sin_cos();
            // Four arcs of `n` steps with straight walls between them.
            let quarter = k / n;
            let x = if matches!(quarter, 0 | 3) { 0.4 } else { -0.4 };
            let y = if quarter < 2 { 0.25 } else { -0.25 };
            let r = 0.1 - inset;
            [x + r * c, y + r * s, z]
        };
        (0..4 * n).map(corner).collect()
    };
    let loops = [
        rounded(0.0, 0.0),
        rounded(0.0, 0.15),
        rounded(0.01, 0.15),
        rounded(0.01, 0.01),
    ];
    skin(&loops, [[0.0, 0.0, 0.0], [0.0, 0.0, 0.01]])
}

/// Returns a terrain of `2 n^2` triangles over `n` by `n` squares of side 0.1 about the origin,
/// with heights within 1: hills of six sizes.
pub fn terrain(n: usize) -> Soup {
    let mut rng = Rng::new(5);
    let waves: Vec<[f64; 4]> = (0..24)
        .map(|k| {
            let f = 0.3 * 1.5f64.powi(k / 4);
            let (s, c) = rng.range(0.0, TAU).sin_cos();
            [f * c, f * s, rng.range(0.0, TAU), 0.08 / f]
        })
        .collect();
    let place = |k: usize| {
        let [x, y] = [k / (n + 1), k % (n + 1)].map(|i| 0.1 * i as f64 - 0.05 * n as f64);
        let z: f64 = waves
            .iter()
            .map(|[u, v, phase, a]| a * (u * x + v * y + phase).sin())
            .sum();
        [x, y, z]
    };
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let cell = |k: usize| {
        let (i, j) = (k / n, k % n);
        [
            [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
            [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
        ]
    };
    Soup::new(
        (0..(n + 1) * (n + 1)).map(place).collect(),
        (0..n * n).flat_map(cell).collect(),
    )
}
