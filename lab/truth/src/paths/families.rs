//! Four or six vertices on deliberately hard straight paths.
//!
//! The kinds of query are those that Wang, Ferguson, Schneider, Jiang, Attene and Panozzo (2021)
//! collected by hand. Here they are generated from seeds.

use super::{Moving, Path, Truth, first_contact};
use crate::Point;
use crate::rng::Rng;

/// The kinds of queries.
pub const KINDS: [&str; 16] = [
    "random",
    "slow",
    "lattice",
    "fine lattice",
    "parallel",
    "degenerate",
    "sliding in a plane",
    "sliding on a face",
    "spike at a corner",
    "touching at an end",
    "grazing",
    "equal vertices",
    "no motion",
    "common motion",
    "near miss",
    "crack",
];

/// Numbers of vertices of A and of B.
pub type Split = (usize, usize);

fn point(r: &mut Rng) -> Point {
    [(); 3].map(|()| r.range(-1.0, 1.0))
}

fn lattice(r: &mut Rng, n: usize, unit: f64) -> Point {
    [(); 3].map(|()| (r.below(2 * n + 1) as f64 - n as f64) * unit)
}

fn add(a: Point, b: Point, s: f64) -> Point {
    [0, 1, 2].map(|k| a[k] + b[k] * s)
}

fn mix(points: &[Point], weights: &[f64]) -> Point {
    points
        .iter()
        .zip(weights)
        .fold([0.0; 3], |sum, (p, w)| add(sum, *p, *w))
}

/// Returns weights that sum to one; some are zero.
fn weights(r: &mut Rng, n: usize) -> Vec<f64> {
    let dyadic = |r: &mut Rng| r.below(9) as f64 / 8.0;
    match (n, r.below(3)) {
        (1, _) => vec![1.0],
        (2, 0) => {
            let x = r.uniform();
            vec![x, 1.0 - x]
        }
        (2, _) => {
            let x = dyadic(r);
            vec![x, 1.0 - x]
        }
        (_, 0) => {
            let (x, y) = (r.uniform(), r.uniform());
            let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
            vec![x, y, 1.0 - x - y]
        }
        (_, 1) => {
            let x = dyadic(r);
            vec![x, 1.0 - x, 0.0]
        }
        _ => vec![0.25, 0.25, 0.5],
    }
}

/// Converts positions and velocities at an instant into paths over the frame.
fn paths(places: &[Point], velocities: &[Point], instant: f64) -> Vec<Path> {
    let path = |(p, v): (&Point, &Point)| [add(*p, *v, -instant), add(*p, *v, 1.0 - instant)];
    places.iter().zip(velocities).map(path).collect()
}

/// Makes a query of a kind, scaled by a power of two, with A's vertices first.
pub fn make(kind: &str, (a, b): Split, r: &mut Rng) -> Vec<Path> {
    let n = a + b;
    let many = |r: &mut Rng, f: &mut dyn FnMut(&mut Rng) -> Point| -> Vec<Point> { (0..n).map(|_| f(r)).collect() };
    let mut x = many(r, &mut point);
    let mut v = many(r, &mut point);
    let instant = *r.pick(&[0.0, 0.25, 0.5, 0.75, 1.0]);
    // Moves A so that points of both parts meet at the instant, up to rounding.
    let meet = |x: &mut [Point], r: &mut Rng| {
        let (of_a, of_b) = (mix(&x[..a], &weights(r, a)), mix(&x[a..], &weights(r, b)));
        let way = add(of_b, of_a, -1.0);
        x[..a].iter_mut().for_each(|p| *p = add(*p, way, 1.0));
    };
    let mut all = match kind {
        "random" => paths(&x, &v, 0.5),
        "slow" => {
            v.iter_mut().for_each(|w| *w = w.map(|c| c * 0.02));
            meet(&mut x, r);
            paths(&x, &v, r.uniform())
        }
        "lattice" | "fine lattice" => {
            let (n, unit) = if kind == "lattice" { (2, 1.0) } else { (6, 0.125) };
            let ends = |r: &mut Rng| [lattice(r, n, unit), lattice(r, n, unit)];
            x.iter().map(|_| ends(r)).collect()
        }
        "parallel" => {
            // Edges of one direction, or a vertex that moves along the face.
            let along = lattice(r, 3, 0.25);
            let d = r.log_range(1e-17, 1.0) * f64::from(r.chance(0.7));
            for k in 0..n {
                let base = if k < a { x[0] } else { x[a] };
                x[k] = add(
                    add(base, along, r.below(5) as f64 * 0.5),
                    point(r),
                    if r.chance(0.5) { d } else { 0.0 },
                );
                v[k] = if r.chance(0.5) { along } else { v[0] };
            }
            meet(&mut x, r);
            paths(&x, &v, instant)
        }
        "degenerate" => {
            x.iter_mut().for_each(|p| *p = lattice(r, 2, 0.5));
            v.iter_mut().for_each(|p| *p = lattice(r, 2, 0.5));
            // A face or an edge without extent, always or at the instant.
            let (i, j) = (a + r.below(b), a + r.below(b));
            x[i] = x[j];
            if r.chance(0.5) {
                v[i] = v[j];
            }
            if b > 2 && r.chance(0.5) {
                x[n - 1] = mix(&x[n - 3..n - 1], &[0.5, 0.5]);
            }
            meet(&mut x, r);
            paths(&x, &v, instant)
        }
        "sliding in a plane" => {
            let fine = r.chance(0.5);
            let flat = |p: Point| [p[0], p[1], if fine { p[0] + 2.0 * p[1] } else { 0.0 }];
            let at = |r: &mut Rng| if fine { lattice(r, 8, 0.125) } else { point(r) };
            let ends = |r: &mut Rng| [flat(at(r)), flat(at(r))];
            x.iter().map(|_| ends(r)).collect()
        }
        "sliding on a face" => {
            // Along the face or the edges, and slightly above or below.
            let level = |p: Point, z: f64| [p[0], p[1], z];
            let height = *r.pick(&[0.0, 1e-17, 1e-15, 1e-12, 1e-8, -1e-15, -1e-8]);
            let k = if r.chance(0.5) { height } else { -height };
            let ends = |r: &mut Rng, i: usize| {
                let (from, to) = if i < a { (height, k) } else { (0.0, 0.0) };
                [level(point(r), from), level(point(r), to)]
            };
            (0..n).map(|i| ends(r, i)).collect()
        }
        "spike at a corner" => {
            // Through a vertex or an edge, with dyadic numbers.
            x.iter_mut().for_each(|p| *p = lattice(r, 4, 0.25));
            v.iter_mut().for_each(|p| *p = lattice(r, 4, 0.25));
            let way = add(x[a + r.below(b)], x[r.below(a)], -1.0);
            x[..a].iter_mut().for_each(|p| *p = add(*p, way, 1.0));
            paths(&x, &v, instant)
        }
        "touching at an end" => {
            x.iter_mut().for_each(|p| *p = lattice(r, 4, 0.25));
            v.iter_mut().for_each(|p| *p = lattice(r, 4, 0.25));
            meet(&mut x, r);
            let instant = f64::from(r.chance(0.7));
            paths(&x, &v, instant)
        }
        "grazing" => {
            // The cubic has a double zero: the vertex touches a rotating face, or approaches it and
            // recedes.
            x.iter_mut().for_each(|p| *p = lattice(r, 4, 0.25));
            meet(&mut x, r);
            let along = |r: &mut Rng, x: &[Point]| {
                let (i, j) = (a + r.below(b), r.below(n));
                add(add([0.0; 3], x[i], 0.5), x[j], -0.5)
            };
            for k in 0..n {
                v[k] = along(r, &x);
            }
            paths(&x, &v, instant)
        }
        "equal vertices" => {
            for _ in 0..2 {
                let (i, j) = (r.below(n), r.below(n));
                x[i] = x[j];
                if r.chance(0.5) {
                    v[i] = v[j];
                }
            }
            paths(&x, &v, instant)
        }
        "no motion" => {
            if r.chance(0.5) {
                x.iter_mut().for_each(|p| *p = lattice(r, 3, 0.25));
            }
            meet(&mut x, r);
            v.iter_mut().for_each(|w| *w = [0.0; 3]);
            paths(&x, &v, 0.0)
        }
        "common motion" => {
            meet(&mut x, r);
            let off = point(r).map(|c| c * *r.pick(&[0.0, 1e-16, 1e-10, 1e-3]));
            x[..a].iter_mut().for_each(|p| *p = add(*p, off, 1.0));
            let w = v[0].map(|c| c * 1e3);
            v.iter_mut().for_each(|u| *u = w);
            paths(&x, &v, 0.0)
        }
        "near miss" => {
            meet(&mut x, r);
            let off = point(r).map(|c| c * *r.pick(&[1e-16, 1e-15, 1e-14, 1e-12, 1e-9, 1e-6]));
            x[..a].iter_mut().for_each(|p| *p = add(*p, off, 1.0));
            paths(&x, &v, r.uniform())
        }
        _ => {
            // A wedge in a crack: thin faces and short edges, down to 1e-14.
            let thin = *r.pick(&[1e-3, 1e-8, 1e-14]);
            let axis = lattice(r, 2, 0.5);
            for k in 0..n {
                let base = if k < a { x[0] } else { x[a] };
                x[k] = add(add(base, axis, r.uniform()), point(r), thin);
            }
            meet(&mut x, r);
            paths(&x, &v, r.uniform())
        }
    };
    let scale = 2f64.powi(*r.pick(&[0, 0, 0, -40, 40, -330, 330]));
    all.iter_mut().flatten().for_each(|p| *p = p.map(|c| c * scale));
    all
}

/// Returns two meshes of a few triangles, each with a triangle of a query of a kind.
///
/// The surrounding triangles share vertices, coincide with positions, or continue planes, edges or
/// the other mesh. With `is_fast`, all of A passes B in the frame.
pub fn meshes(kind: &str, is_fast: bool, r: &mut Rng) -> [Moving; 2] {
    let both = make(kind, (3, 3), r);
    let mut all = [&both[..3], &both[3..]].map(|paths| Moving {
        paths: paths.to_vec(),
        triangles: vec![[0, 1, 2]],
    });
    // Most triangles around the query are separated at the start, so that they do not hide the
    // query.
    let hides = |all: &[Moving; 2]| {
        let begin = |m: &Moving| Moving {
            paths: m.paths.iter().map(|p| [p[0]; 2]).collect(),
            triangles: m.triangles.clone(),
        };
        matches!(first_contact(&begin(&all[0]), &begin(&all[1])), Truth::Start)
    };
    let is_start = hides(&all);
    for k in 0..2 {
        for _ in 0..2 + r.below(6) {
            let mut grown = all.clone();
            grow(&mut grown[k], &all[1 - k].paths, r);
            if is_start || r.chance(0.02) || !hides(&grown) {
                all = grown;
            }
        }
    }
    if is_fast {
        let way = add(
            *r.pick(&both[3..].iter().map(|p| p[1]).collect::<Vec<_>>()),
            both[0][0],
            -1.0,
        );
        for path in &mut all[0].paths {
            path[1] = add(path[0], way, 4.0);
        }
    }
    all
}

/// Adds a triangle at an edge, with a new vertex.
fn grow(mesh: &mut Moving, other: &[Path], r: &mut Rng) {
    let [mut i, mut j, k] = *r.pick(&mesh.triangles);
    let own = |v: u32| mesh.paths[v as usize];
    let combined = |p: Path, q: Path, s: Path, x: f64| [0, 1].map(|t| add(add(p[t], q[t], 1.0), s[t], -x));
    let path = match r.below(6) {
        // The parallelogram: in the plane of the triangle, and on the same lattice.
        0 | 1 => combined(own(i), own(j), own(k), 1.0),
        // A vertex at the position of another vertex.
        2 => own(k),
        3 => *r.pick(other),
        // Off the plane, with the velocity of a vertex.
        4 => {
            let off = add(*r.pick(&own(j)), own(k)[0], -1.0);
            own(i).map(|p| add(p, [off[1], off[2], off[0]], 1.0))
        }
        _ => combined(own(i), *r.pick(other), own(j), 1.0),
    };
    if r.chance(0.5) {
        (i, j) = (j, i);
    }
    mesh.paths.push(path);
    mesh.triangles.push([i, j, mesh.paths.len() as u32 - 1]);
}
