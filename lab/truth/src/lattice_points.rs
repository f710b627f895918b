//! The exact side of points on a lattice, a million in a minute.
//!
//! The vertices of the mesh are multiples of 2^-20, the points of 2^-50. Products of their
//! differences fit in 128 bits, so every sign is exact without rationals. A ray along x counts the
//! winding number: the point is moved by (0, e, e^2) for an infinitely small e, so the ray meets no
//! edge. The moved point has the same winding number, since it is not on the surface.

use crate::Point;
use crate::driven::exact_place::Place;
use crate::rng::Rng;
use crate::soups::Soup;

/// Coordinates in steps of 2^-50.
pub type Fine = [i64; 3];

/// Steps of points per step of vertices.
const FINE: i64 = 1 << 30;

/// Vertices have coordinates below 4, points below 8.
const REACH: i64 = 1 << 52;

/// Number of the kinds of [`LatticeMesh::hard_point`].
pub const LATTICE_KINDS: usize = 12;

/// A mesh with vertices on the lattice of 2^-20, ready for many points.
#[derive(Clone, Debug)]
pub struct LatticeMesh {
    /// The vertices in steps of 2^-20.
    points: Vec<[i64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The triangles whose boxes meet each cell of a grid over y and z.
    cells: Vec<Vec<u32>>,
    /// Cells along an axis, over coordinates of -4 to 4.
    side: i64,
}

impl LatticeMesh {
    /// Returns a mesh with the vertices rounded to the lattice.
    ///
    /// # Panics
    ///
    /// Panics if a coordinate is 4 or more, or a triangle has no area.
    pub fn new(soup: &Soup) -> Self {
        let round = |x: &f64| (x * 2f64.powi(20)).round() as i64;
        let points: Vec<[i64; 3]> = soup.points.iter().map(|p| p.each_ref().map(round)).collect();
        assert!(
            points.iter().flatten().all(|x| x.abs() < REACH / FINE),
            "a vertex is far"
        );
        let side = (soup.triangles.len() as f64).sqrt().ceil() as i64 * 4;
        let mut mesh = Self {
            points,
            triangles: soup.triangles.clone(),
            cells: vec![Vec::new(); (side * side) as usize],
            side,
        };
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t);
            assert!(normal(corners) != [0; 3], "triangle {t} has no area");
            let range = |k: usize| {
                let along = corners.map(|p| mesh.cell_along(p[k] * FINE));
                along.into_iter().min().unwrap_or(0)..=along.into_iter().max().unwrap_or(0)
            };
            let (ys, zs) = (range(1), range(2));
            for cell in ys.flat_map(|y| zs.clone().map(move |z| y * side + z)) {
                mesh.cells[cell as usize].push(t as u32);
            }
        }
        mesh
    }

    fn corners(&self, t: usize) -> [[i64; 3]; 3] {
        self.triangles[t].map(|v| self.points[v as usize])
    }

    /// Returns the column of cells of a coordinate in fine steps; far points are in the last.
    fn cell_along(&self, x: i64) -> i64 {
        let along = (i128::from(x) + i128::from(REACH)) * i128::from(self.side) / (2 * i128::from(REACH));
        (along as i64).clamp(0, self.side - 1)
    }

    /// Returns the mesh times a power of two, without rounding.
    pub fn soup(&self, exponent: i32) -> Soup {
        let step = 2f64.powi(exponent - 20);
        Soup::new(
            self.points.iter().map(|p| p.map(|x| x as f64 * step)).collect(),
            self.triangles.clone(),
        )
    }

    /// Returns the location of a point, by exact signs.
    pub fn place(&self, p: Fine) -> Place {
        match self.winding(p) {
            None => Place::On,
            Some(0) => Place::Outside,
            Some(_) => Place::Inside,
        }
    }

    /// Returns the winding number about a point; `None` on the surface.
    pub fn winding(&self, p: Fine) -> Option<i32> {
        let mut winding = 0;
        for &t in &self.cells[(self.cell_along(p[1]) * self.side + self.cell_along(p[2])) as usize] {
            let corners = self.corners(t as usize);
            let n = normal(corners);
            let from = apart(p, corners[0]);
            let height: i128 = (0..3).map(|k| n[k] * from[k]).sum();
            if height == 0 && is_within(corners, n, p) {
                return None;
            }
            // The ray crosses where all turns agree with the sign of the normal along x.
            let way = n[0].signum();
            let turns = |k: usize| moved_turn(corners[k], corners[(k + 1) % 3], p);
            if way != 0 && height.signum() == -way && (0..3).all(|k| turns(k) == way) {
                winding += way;
            }
        }
        Some(winding as i32)
    }

    /// Returns a point that is hard to judge: on vertices, edges, faces and their planes, one step
    /// beside them, on coarse lattices, on planes of symmetry, between two places of the surface,
    /// anywhere.
    pub fn hard_point(&self, kind: usize, rng: &mut Rng) -> Fine {
        let corners = self.corners(rng.below(self.triangles.len()));
        let vertex = |rng: &mut Rng| self.points[rng.below(self.points.len())].map(|x| x * FINE);
        let beside = |mut p: Fine, steps: i64, rng: &mut Rng| {
            p[rng.below(3)] += rng.int(-steps, steps);
            p
        };
        // Weights are multiples of 2^-10, so the point is on the lattice.
        let mix = |corners: [[i64; 3]; 3], w: [i64; 2]| -> Fine {
            let w = [w[0], w[1], 1024 - w[0] - w[1]];
            std::array::from_fn(|k| (0..3).map(|i| corners[i][k] * w[i] * (FINE / 1024)).sum())
        };
        let face = |corners: [[i64; 3]; 3], rng: &mut Rng| {
            let x = rng.int(0, 1024);
            mix(corners, [x, rng.int(0, 1024 - x)])
        };
        match kind {
            0 => corners[0].map(|x| x * FINE),
            1 => beside(corners[0].map(|x| x * FINE), 2, rng),
            2 => {
                let x = rng.int(0, 1024);
                mix(corners, [x, 1024 - x])
            }
            3 => {
                let x = rng.int(0, 16) * 64;
                beside(mix(corners, [x, 1024 - x]), 1, rng)
            }
            4 => face(corners, rng),
            5 => beside(face(corners, rng), 1, rng),
            // In the plane of a face, also outside of it.
            6 => {
                let w = [rng.int(-8, 8) * 64, rng.int(-8, 8) * 64];
                beside(mix(corners, w), rng.int(0, 1), rng)
            }
            7 => [0; 3].map(|_| rng.int(-16, 16) * (REACH / 64)),
            8 => {
                let mut p = [0; 3].map(|_| rng.int(-REACH / 2, REACH / 2));
                p[rng.below(3)] = 0;
                p[rng.below(3)] = vertex(rng)[rng.below(3)];
                p
            }
            // Coordinates of several vertices: lines along the axes meet vertices and edges.
            9 => {
                let p = [vertex(rng)[0], vertex(rng)[1], vertex(rng)[2]];
                beside(p, rng.int(0, 1), rng)
            }
            10 => {
                let (a, b) = (face(corners, rng), vertex(rng));
                std::array::from_fn(|k| (a[k] + b[k]) / 2)
            }
            _ => [0; 3].map(|_| rng.int(-REACH, REACH)),
        }
    }
}

/// Returns a point in the unit of a mesh times a power of two, without rounding.
pub fn float(p: Fine, exponent: i32) -> Point {
    p.map(|x| x as f64 * 2f64.powi(exponent - 50))
}

/// Returns the normal in coarse steps: at most 2^47.
fn normal([a, b, c]: [[i64; 3]; 3]) -> [i128; 3] {
    let edge = |p: [i64; 3]| -> [i128; 3] { std::array::from_fn(|k| i128::from(p[k] - a[k])) };
    let (u, v) = (edge(b), edge(c));
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i] * v[j] - u[j] * v[i]
    })
}

/// Returns the vector from a vertex to a point in fine steps: at most 2^54.
fn apart(p: Fine, a: [i64; 3]) -> [i128; 3] {
    std::array::from_fn(|k| i128::from(p[k] - a[k] * FINE))
}

/// Returns twice the area of an edge and a point, seen along axis `k`.
fn turn(a: [i64; 3], b: [i64; 3], p: Fine, k: usize) -> i128 {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let from = apart(p, a);
    i128::from(b[i] - a[i]) * from[j] - i128::from(b[j] - a[j]) * from[i]
}

/// Returns the sign of the turn along x of an edge and the moved point.
fn moved_turn(a: [i64; 3], b: [i64; 3], p: Fine) -> i128 {
    let signs = [
        turn(a, b, p, 0).signum(),
        i128::from(a[2] - b[2]).signum(),
        i128::from(b[1] - a[1]).signum(),
    ];
    signs.into_iter().find(|s| *s != 0).unwrap_or(0)
}

/// Returns whether a triangle contains a point of its plane.
fn is_within(corners: [[i64; 3]; 3], n: [i128; 3], p: Fine) -> bool {
    let k = (0..3).find(|k| n[*k] != 0).unwrap_or(0);
    let agrees = |i: usize| turn(corners[i], corners[(i + 1) % 3], p, k) * n[k].signum() >= 0;
    (0..3).all(agrees)
}
