//! Generated nonconvex meshes: closed, nested, linked and multi-component meshes, plates and soups.

use crate::pose::{add, cross, norm, scale, sub, unit};
use crate::rng::Rng;
use crate::{Point, Pose};
use lin_canny_formats::MeshFile;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

/// Points and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Points.
    pub points: Vec<Point>,
    /// Indices of three points each.
    pub triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Returns the triangles between points.
    pub const fn new(points: Vec<Point>, triangles: Vec<[u32; 3]>) -> Self {
        Self { points, triangles }
    }

    /// Returns the triangles of a mesh file; `None` if it cannot be read.
    pub fn read(path: &Path) -> Option<Self> {
        let (points, triangles) = MeshFile::load(path).ok()?.whole();
        Some(Self { points, triangles })
    }

    /// Returns the vertices of a triangle.
    pub fn corners(&self, t: usize) -> [Point; 3] {
        self.triangles[t].map(|v| self.points[v as usize])
    }

    /// Returns the mesh with every point mapped.
    pub fn map(mut self, f: impl Fn(Point) -> Point) -> Self {
        self.points.iter_mut().for_each(|p| *p = f(*p));
        self
    }

    /// Returns the mesh moved by a pose.
    pub fn moved(self, pose: &Pose) -> Self {
        self.map(|p| pose.apply(p))
    }

    /// Returns both meshes as one.
    pub fn with(mut self, other: &Self) -> Self {
        let base = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles
            .extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
        self
    }

    /// Returns the mesh turned inside out.
    pub fn flipped(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// Returns the mesh with a separate point for every triangle vertex, as in STL files.
    pub fn unwelded(&self) -> Self {
        let points: Vec<_> = (0..self.triangles.len()).flat_map(|t| self.corners(t)).collect();
        let triangles = (0..points.len() as u32 / 3)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        Self { points, triangles }
    }

    /// Returns the distance of the farthest point from the origin.
    pub fn radius(&self) -> f64 {
        crate::pose::radius(&self.points)
    }
}

/// Returns a grid of `n` by `m` points that is periodic in both directions.
fn ring(n: usize, m: usize, place: impl Fn(f64, f64) -> Point) -> Soup {
    let points = (0..n * m)
        .map(|k| place((k / m) as f64 / n as f64, (k % m) as f64 / m as f64))
        .collect();
    let at = |i: usize, j: usize| (i % n * m + j % m) as u32;
    let cells = (0..n * m).flat_map(|k| {
        let (i, j) = (k / m, k % m);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Soup::new(points, cells.collect())
}

/// Returns a torus about z of `2 n m` triangles: `n` around the ring of radius 1, `m` around the
/// tube.
pub fn torus(n: usize, m: usize, tube: f64) -> Soup {
    ring(n, m, |u, v| {
        let ((s, c), (t, d)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let r = 1.0 + tube * d;
        [r * c, r * s, tube * t]
    })
}

/// Returns a tube along a trefoil knot of `2 n m` triangles.
pub fn knot(n: usize, m: usize, tube: f64) -> Soup {
    let path = |u: f64| {
        let a = TAU * u;
        let r = 2.0 + (3.0 * a).cos();
        scale([r * (2.0 * a).cos(), r * (2.0 * a).sin(), (3.0 * a).sin()], 1.0 / 3.0)
    };
    ring(n, m, |u, v| {
        let along = unit(sub(path(u + 1e-4), path(u - 1e-4)));
        let x = unit(cross([0.0, 0.0, 1.0], along));
        let y = cross(along, x);
        let (s, c) = (TAU * v).sin_cos();
        // Goes around the tube in the negative sense, so that the grid's triangles face outward.
        add(path(u), add(scale(x, tube * c), scale(y, -tube * s)))
    })
}

/// Returns a sphere of `20 4^k` triangles.
pub fn sphere(k: u32) -> Soup {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut soup = Soup::new(
        vec![
            [-1.0, g, 0.0],
            [1.0, g, 0.0],
            [-1.0, -g, 0.0],
            [1.0, -g, 0.0],
            [0.0, -1.0, g],
            [0.0, 1.0, g],
            [0.0, -1.0, -g],
            [0.0, 1.0, -g],
            [g, 0.0, -1.0],
            [g, 0.0, 1.0],
            [-g, 0.0, -1.0],
            [-g, 0.0, 1.0],
        ],
        vec![
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ],
    );
    for _ in 0..k {
        let mut middles = HashMap::new();
        let points = &mut soup.points;
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push(scale(add(points[a as usize], points[b as usize]), 0.5));
                points.len() as u32 - 1
            })
        };
        let cut = soup.triangles.iter().flat_map(|&[a, b, c]| {
            let [x, y, z] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, x, z], [x, b, y], [z, y, c], [x, y, z]]
        });
        soup.triangles = cut.collect();
        soup.points.iter_mut().for_each(|p| *p = unit(*p));
    }
    soup.map(unit)
}

/// Returns a rock of `20 4^k` triangles: a sphere with waves of random directions.
pub fn rock(k: u32, seed: u64) -> Soup {
    let mut rng = Rng::new(seed);
    let waves: Vec<(Point, f64, f64)> = (0..24)
        .map(|i| {
            let f = 2.0 + 10.0 * f64::from(i) / 24.0;
            (scale(rng.unit(), f), rng.range(0.0, TAU), 0.5 / (f * f.sqrt()))
        })
        .collect();
    sphere(k).map(|p| {
        let bump: f64 = waves
            .iter()
            .map(|(w, phase, a)| a * (crate::pose::dot(*w, p) + phase).sin())
            .sum();
        scale(p, 1.0 + 0.35 * bump)
    })
}

/// Returns a prism over a star-shaped polygon in the plane `z = 0`, from `-h` to `h`, with end
/// faces fanned from their centres.
fn prism(outline: &[[f64; 2]], h: f64) -> Soup {
    let n = outline.len() as u32;
    let mut soup = Soup::default();
    for z in [-h, h] {
        soup.points.extend(outline.iter().map(|[x, y]| [*x, *y, z]));
    }
    soup.points.extend([[0.0, 0.0, -h], [0.0, 0.0, h]]);
    for i in 0..n {
        let j = (i + 1) % n;
        soup.triangles.extend([
            [i, j, n + j],
            [i, n + j, n + i],
            [2 * n, j, i],
            [2 * n + 1, n + i, n + j],
        ]);
    }
    soup
}

/// Returns a gear of `16 teeth` triangles.
pub fn gear(teeth: usize) -> Soup {
    let outline: Vec<[f64; 2]> = (0..4 * teeth)
        .map(|k| {
            let r = if k % 4 < 2 { 1.0 } else { 0.8 };
            let (s, c) = (TAU * k as f64 / (4 * teeth) as f64).sin_cos();
            [r * c, r * s]
        })
        .collect();
    prism(&outline, 0.2)
}

/// Returns a threaded rod of about `8 turns n` triangles: a helical ridge on a cylinder along z,
/// with `n` steps per turn.
pub fn screw(turns: usize, n: usize) -> Soup {
    let (rows, m) = (4 * turns, n);
    let pitch = 0.25;
    let mut points = Vec::new();
    for i in 0..=rows {
        for j in 0..m {
            let u = j as f64 / m as f64;
            let phase = i as f64 / 4.0;
            let depth = [0.0, 1.0, 1.0, 0.0][i % 4];
            let r = if i == 0 || i == rows { 0.4 } else { 0.4 + 0.1 * depth };
            let (s, c) = (TAU * u).sin_cos();
            points.push([r * c, r * s, pitch * (phase + u)]);
        }
    }
    let base = points.len() as u32;
    points.push([0.0, 0.0, -pitch]);
    points.push([0.0, 0.0, pitch * (turns as f64 + 2.0)]);
    let at = |i: usize, j: usize| (i * m + j % m) as u32;
    // The seam of the helix: the end of a row meets the row one turn later.
    let mut triangles = Vec::new();
    for i in 0..rows {
        for j in 0..m {
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for j in 0..m {
        triangles.push([base, at(0, j + 1), at(0, j)]);
        triangles.push([base + 1, at(rows, j), at(rows, j + 1)]);
    }
    Soup::new(points, triangles)
}

/// Returns a box of twelve triangles. Point `i + 2 j + 4 k` has the low or high `x` by `i`, `y` by `j`
/// and `z` by `k`.
pub fn cuboid(low: Point, high: Point) -> Soup {
    let corner = |m: usize| std::array::from_fn(|i| if m >> i & 1 == 1 { high[i] } else { low[i] });
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    Soup::new(
        (0..8).map(corner).collect(),
        sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    )
}

/// Returns a box of half extents `h` whose sides have `n` by `n` squares each: `12 n^2` triangles.
pub fn plate(n: usize, h: Point) -> Soup {
    let mut points = Vec::new();
    let mut index = HashMap::new();
    let mut triangles = Vec::new();
    let mut at = |p: [i64; 3]| {
        *index.entry(p).or_insert_with(|| {
            let x = |k: usize| h[k] * (2.0 * p[k] as f64 / n as f64 - 1.0);
            points.push([x(0), x(1), x(2)]);
            points.len() as u32 - 1
        })
    };
    let m = n as i64;
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [0, m] {
            for k in 0..m * m {
                let mut place = |i: i64, j: i64| {
                    let mut p = [0; 3];
                    (p[axis], p[u], p[v]) = (end, k / m + i, k % m + j);
                    at(p)
                };
                let [a, b, c, d] = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)];
                let two = [[a, b, c], [a, c, d]];
                triangles.extend(if end == m { two } else { two.map(|[a, b, c]| [a, c, b]) });
            }
        }
    }
    Soup::new(points, triangles)
}

/// Returns an L-shaped prism of 20 triangles.
pub fn bracket() -> Soup {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.3, 0.3], [0.3, 1.0], [0.0, 1.0]];
    let mut soup = Soup::default();
    for z in [-0.3, 0.3] {
        soup.points.extend(outline.iter().map(|[x, y]| [*x, *y, z]));
    }
    for i in 0..6 {
        let j = (i + 1) % 6;
        soup.triangles.extend([[i, j, 6 + j], [i, 6 + j, 6 + i]]);
    }
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        soup.triangles.extend([[a, c, b], [6 + a, 6 + b, 6 + c]]);
    }
    soup.map(|p| sub(p, [0.4, 0.4, 0.0]))
}

/// Returns a hollow ball: an outer sphere and a cavity of radius `r` that faces inward.
pub fn cave(k: u32, r: f64) -> Soup {
    sphere(k).with(&sphere(k).flipped().map(|p| scale(p, r)))
}

/// Returns `n` unconnected triangles of size `size` in a ball of radius 1.
pub fn loose(n: usize, size: f64, rng: &mut Rng) -> Soup {
    let points = (0..n).flat_map(|_| {
        let at = rng.in_ball();
        [0; 3].map(|_| add(at, scale(rng.in_ball(), size)))
    });
    Soup::new(
        points.collect(),
        (0..n as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    )
}

/// Returns `n` slivers: triangles a million times as long as wide, in a ball of radius 1.
pub fn slivers(n: usize, rng: &mut Rng) -> Soup {
    let points = (0..n).flat_map(|_| {
        let (at, along) = (rng.in_ball(), scale(rng.unit(), rng.range(0.1, 0.5)));
        let aside = scale(rng.unit(), norm(along) * 1e-6);
        [at, add(at, along), add(add(at, scale(along, 0.4)), aside)]
    });
    Soup::new(
        points.collect(),
        (0..n as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    )
}
