//! Bodies that are hard on purpose, as plain points and, where a body has natural ones, faces.
//!
//! Bodies stand about the origin with a size near 1 unless said otherwise. Where faces are given they turn
//! counter-clockwise from outside; where `faces` is empty the hull has to find them.

use crate::pose::{add, cross, dot, scale, sub};
use crate::rng::Rng;
use crate::{Face, Point, Pose, brute_hull};
use std::f64::consts::TAU;

/// A body by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What it is, for messages.
    pub name: String,
    /// Points in the body's own frame; not all need be extreme.
    pub points: Vec<Point>,
    /// Faces, or none.
    pub faces: Vec<Face>,
}

impl Shape {
    /// Points whose hull is the body.
    pub fn hull(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self {
            name: name.into(),
            points,
            faces: Vec::new(),
        }
    }

    /// The same body with its faces found exactly; for a few points only.
    pub fn solved(mut self) -> Self {
        self.faces = brute_hull::faces(&self.points);
        self
    }

    /// The same points moved (and rounded); faces are kept, though no longer planar to the last bit.
    pub fn moved(mut self, pose: &Pose) -> Self {
        self.points.iter_mut().for_each(|p| *p = pose.apply(*p));
        self
    }

    /// The same points stretched along the axes by positive factors; faces are kept.
    pub fn stretched(mut self, by: Point) -> Self {
        self.points
            .iter_mut()
            .for_each(|p| *p = std::array::from_fn(|i| p[i] * by[i]));
        self
    }

    /// The same body with its points in another order.
    pub fn shuffled(mut self, rng: &mut Rng) -> Self {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        rng.shuffle(&mut order); // order[new] = old
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new as u32);
        self.points = order.iter().map(|&old| self.points[old]).collect();
        self.faces.iter_mut().flatten().for_each(|i| *i = place[*i as usize]);
        self
    }

    /// Faces cut into triangles by fans.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        triangles(&self.faces)
    }
}

/// Faces cut into triangles by a fan from each first corner.
pub fn triangles(faces: &[Face]) -> Vec<[u32; 3]> {
    faces
        .iter()
        .flat_map(|f| f[1..].windows(2).map(|w| [f[0], w[0], w[1]]))
        .collect()
}

/// A box of half sizes `h`. Point `4 i + 2 j + k` is at `x` sign `i`, `y` sign `j`, `z` sign `k`.
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
    Shape {
        name: format!("box {h:?}"),
        points: (0..8).map(corner).collect(),
        faces,
    }
}

/// `n` points of a circle of radius `r` at height `z`, counter-clockwise from above.
fn ring(n: usize, r: f64, z: f64) -> Vec<Point> {
    let at = |i| TAU * i as f64 / n as f64;
    (0..n).map(|i| [r * at(i).cos(), r * at(i).sin(), z]).collect()
}

/// An upright prism over a regular `n`-gon of radius `r`, of half height `h`.
pub fn prism(n: usize, r: f64, h: f64) -> Shape {
    let points = [ring(n, r, -h), ring(n, r, h)].concat();
    let m = n as u32;
    let mut faces: Vec<Face> = (0..m)
        .map(|i| [i, (i + 1) % m, (i + 1) % m + m, i + m].to_vec())
        .collect();
    faces.push((0..m).rev().collect());
    faces.push((m..2 * m).collect());
    Shape {
        name: format!("prism {n}"),
        points,
        faces,
    }
}

/// A cone over a regular `n`-gon of radius `r` at `z = 0`, with its tip (the last point, of valence `n`) at height `h`.
pub fn cone(n: usize, r: f64, h: f64) -> Shape {
    let mut points = ring(n, r, 0.0);
    points.push([0.0, 0.0, h]);
    let m = n as u32;
    let mut faces: Vec<Face> = (0..m).map(|i| vec![i, (i + 1) % m, m]).collect();
    faces.push((0..m).rev().collect());
    Shape {
        name: format!("cone {n}"),
        points,
        faces,
    }
}

/// The regular tetrahedron in the cube of half size 1.
pub fn tetrahedron() -> Shape {
    let points = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    Shape::hull("tetrahedron", points).solved()
}

/// The cube of half size 1.
pub fn cube() -> Shape {
    Shape {
        name: "cube".into(),
        ..cuboid([1.0; 3])
    }
}

/// The octahedron with tips at distance 1.
pub fn octahedron() -> Shape {
    let tips = (0..6).map(|i| std::array::from_fn(|k| if k == i / 2 { 1.0 - 2.0 * (i % 2) as f64 } else { 0.0 }));
    Shape::hull("octahedron", tips.collect()).solved()
}

/// The golden ratio.
const PHI: f64 = 1.618_033_988_749_895;

/// The icosahedron of edge 2.
pub fn icosahedron() -> Shape {
    let mut points = Vec::new();
    for i in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.push(std::array::from_fn(|k| [0.0, s, t * PHI][(k + 3 - i) % 3]));
        }
    }
    Shape::hull("icosahedron", points).solved()
}

/// The dodecahedron of edge `2 / PHI`. Its pentagons are planar up to rounding only: the dual of the icosahedron names
/// them, and the exact hull of the points may cut them.
pub fn dodecahedron() -> Shape {
    let mut points = cube().points;
    for i in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.push(std::array::from_fn(|k| [0.0, s / PHI, t * PHI][(k + 3 - i) % 3]));
        }
    }
    let tips = icosahedron().points;
    // The icosahedron with y and z exchanged has its tips over the faces.
    let faces = tips.iter().map(|n| rim_about(&points, [n[0], n[2], n[1]])).collect();
    Shape {
        name: "dodecahedron".into(),
        points,
        faces,
    }
}

/// The five points farthest along `n`, in order about it.
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

/// The five Platonic solids.
pub fn platonic() -> [Shape; 5] {
    [tetrahedron(), cube(), octahedron(), dodecahedron(), icosahedron()]
}

/// `n` random points of the unit sphere.
pub fn sphere(rng: &mut Rng, n: usize) -> Shape {
    Shape::hull(format!("sphere {n}"), (0..n).map(|_| rng.unit()).collect())
}

/// `n` random points of an ellipsoid with half axes `axes`.
pub fn ellipsoid(rng: &mut Rng, n: usize, axes: Point) -> Shape {
    let s = sphere(rng, n).stretched(axes);
    Shape {
        name: format!("ellipsoid {n} {axes:?}"),
        ..s
    }
}

/// `n` random points in the unit ball: most of a large cloud is inside.
pub fn ball(rng: &mut Rng, n: usize) -> Shape {
    let mut point = || {
        let s = rng.uniform().cbrt();
        scale(rng.unit(), s)
    };
    Shape::hull(format!("ball {n}"), (0..n).map(|_| point()).collect())
}

/// A flat body: `n` random points squeezed to `thickness` and turned at random.
pub fn sliver(rng: &mut Rng, n: usize, thickness: f64) -> Shape {
    let turn = Pose {
        q: rng.quat(),
        t: [0.0; 3],
    };
    let s = sphere(rng, n).stretched([1.0, 1.0, thickness]).moved(&turn);
    Shape {
        name: format!("sliver {n} {thickness:e}"),
        ..s
    }
}

/// A thin body: `n` random points squeezed to `width` in two directions and turned at random.
pub fn needle(rng: &mut Rng, n: usize, width: f64) -> Shape {
    let turn = Pose {
        q: rng.quat(),
        t: [0.0; 3],
    };
    let s = sphere(rng, n).stretched([1.0, width, width]).moved(&turn);
    Shape {
        name: format!("needle {n} {width:e}"),
        ..s
    }
}

/// A box whose top carries a ridge higher by `height`: two roof faces almost in one plane.
pub fn roof(height: f64) -> Shape {
    let mut points = cuboid([1.0, 1.0, 0.5]).points;
    points.extend([[-1.0, 0.0, 0.5 + height], [1.0, 0.0, 0.5 + height]]);
    Shape::hull(format!("roof {height:e}"), points)
}

/// A box whose top carries a tip higher by `height`: four faces almost in one plane.
pub fn pyramid_lid(height: f64) -> Shape {
    let mut points = cuboid([1.0, 1.0, 0.5]).points;
    points.push([0.0, 0.0, 0.5 + height]);
    Shape::hull(format!("lid {height:e}"), points)
}

/// A prism of `n` sides closed by a cap of `rings` rings rising by `height` in all: a fan and bands of faces almost in
/// one plane.
pub fn cap(n: usize, rings: usize, height: f64) -> Shape {
    let mut points = ring(n, 1.0, -0.5);
    for i in 0..rings {
        let r = 1.0 - i as f64 / rings as f64;
        points.extend(ring(n, r, height * (1.0 - r * r)));
    }
    points.push([0.0, 0.0, height]);
    Shape::hull(format!("cap {n} {rings} {height:e}"), points)
}

/// A box whose top is a grid of `(k + 1)^2` points of a paraboloid rising by `height`.
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

/// `n` random points with integer coordinates in `-k..=k`: duplicates, collinear and coplanar points abound, and the
/// points may even lie in one plane.
pub fn lattice(rng: &mut Rng, n: usize, k: i64) -> Shape {
    let mut point = || std::array::from_fn(|_| rng.int(-k, k) as f64);
    Shape::hull(format!("lattice {n} {k}"), (0..n).map(|_| point()).collect())
}

/// All points of a cubic grid with `k + 1` points a side on the cube of half size 1, the inner ones too.
pub fn grid(k: usize) -> Shape {
    let at = |i| 2.0 * i as f64 / k as f64 - 1.0;
    let point = |m: usize| [at(m / (k + 1) / (k + 1)), at(m / (k + 1) % (k + 1)), at(m % (k + 1))];
    Shape::hull(format!("grid {k}"), (0..(k + 1).pow(3)).map(point).collect())
}

/// A box of half sizes `h` with every edge and corner cut by `chamfer`: slim rectangles and tiny triangles beside large
/// faces.
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

/// The geodesic sphere of frequency `2^level` over the icosahedron: `10 * 4^level + 2` points and their triangles.
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
    Shape {
        name: format!("icosphere {level}"),
        points,
        faces,
    }
}

/// The same hull with a third more points: some twice, some inside, some half way between two points of one face (on the
/// face where that is exact, else off it by rounding). Faces are dropped, the order is random.
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

/// A random body of at most 16 points for the exact oracle, its faces found: of any of the families above.
pub fn small(rng: &mut Rng) -> Shape {
    loop {
        let n = 4 + rng.below(10);
        let thin = rng.log_range(1e-9, 1.0);
        let shape = match rng.below(12) {
            0 => ellipsoid(rng, n, [1.0, 0.5, 0.25]),
            1 => sliver(rng, n, thin),
            2 => needle(rng, n, thin),
            3 => lattice(rng, n, 2),
            4 => roof(thin),
            5 => pyramid_lid(thin),
            6 => prism(3 + rng.below(5), 1.0, 0.7),
            7 => cone(3 + rng.below(9), 1.0, 0.5),
            8 => cuboid([1.0, rng.range(0.2, 1.0), thin]),
            9 => platonic()[[0, 1, 2, 4][rng.below(4)]].clone(),
            _ => sphere(rng, n),
        };
        let solved = shape.solved();
        if !solved.faces.is_empty() {
            return solved;
        }
    }
}

/// One body of each family, from 4 to some 1000 points, by name.
pub fn catalogue(seed: u64) -> Vec<Shape> {
    let mut r = Rng::new(seed);
    let mut all = Vec::from(platonic());
    all.extend([
        cuboid([1.0, 0.5, 1e-6]),
        prism(6, 1.0, 0.3),
        prism(256, 1.0, 0.5),
        cone(5, 1.0, 1.0),
        cone(512, 1.0, 0.4),
    ]);
    all.extend([4, 16, 128, 1024].map(|n| sphere(&mut r, n)));
    all.extend([1e-3, 1e-6].map(|z| ellipsoid(&mut r, 64, [1.0, 0.7, z])));
    all.extend([1e-3, 1e-6, 1e-9, 1e-12].map(|z| sliver(&mut r, 24, z)));
    all.extend([1e-3, 1e-6, 1e-9].map(|z| needle(&mut r, 24, z)));
    for h in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        all.extend([roof(h), pyramid_lid(h), cap(12, 3, h), dome(6, h)]);
    }
    all.extend([
        lattice(&mut r, 30, 2),
        lattice(&mut r, 200, 5),
        grid(4),
        ball(&mut r, 300),
    ]);
    all.extend([1e-2, 1e-6, 1e-9].map(|c| chamfered([1.0, 0.8, 0.6], c)));
    all.extend([icosphere(1), icosphere(3)]);
    let clean = [cube(), prism(12, 1.0, 0.5), icosphere(1)];
    all.extend(clean.map(|s| dirty(&s, &mut r)));
    all
}

#[cfg(test)]
#[path = "shapes_tests.rs"]
mod tests;
