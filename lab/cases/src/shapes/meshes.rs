//! Closed meshes of triangles that are not convex.

use super::Shape;
use crate::Face;
use std::f64::consts::TAU;

/// Returns the same body with triangles for faces.
pub fn triangulated(shape: &Shape) -> Shape {
    let faces = shape.triangles().iter().map(|t| t.to_vec()).collect();
    Shape::new(shape.name.clone(), shape.points.clone(), faces)
}

/// Returns a prism of height `2 h` over triangles of a plane, counter-clockwise.
fn extruded(name: &str, flat: &[[f64; 2]], caps: &[[u32; 3]], h: f64) -> Shape {
    let n = flat.len() as u32;
    let level = |z: f64| flat.iter().map(move |[x, y]| [*x, *y, z]);
    let mut faces: Vec<Face> = Vec::new();
    for t in caps {
        faces.push(t.map(|v| v + n).to_vec());
        faces.push(vec![t[2], t[1], t[0]]);
        for k in 0..3 {
            let (i, j) = (t[k], t[(k + 1) % 3]);
            let is_inner = caps.iter().any(|o| (0..3).any(|m| (o[m], o[(m + 1) % 3]) == (j, i)));
            if !is_inner {
                faces.extend([vec![i, j, j + n], vec![i, j + n, i + n]]);
            }
        }
    }
    Shape::new(name, level(-h).chain(level(h)).collect(), faces)
}

/// Returns an L of three unit squares, `2 h` high.
pub fn bracket(h: f64) -> Shape {
    let flat = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
        [0.0, 0.0],
        [0.0, 1.0],
        [-1.0, 1.0],
    ];
    extruded("bracket", &flat, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], h)
}

/// Returns a square of side 2 with a square hole of side 1, `2 h` high.
pub fn square_frame(h: f64) -> Shape {
    let square = |r: f64| [[-r, -r], [r, -r], [r, r], [-r, r]];
    let flat = [square(1.0), square(0.5)].concat();
    let caps: Vec<[u32; 3]> = (0..4)
        .flat_map(|k| {
            let next = (k + 1) % 4;
            [[k, next, next + 4], [k, next + 4, k + 4]]
        })
        .collect();
    extruded("frame", &flat, &caps, h)
}

/// Returns a star of `n` points with radii 1 and `inner`, `2 h` high.
pub fn star(n: u32, inner: f64, h: f64) -> Shape {
    let rim = (0..2 * n).map(|k| {
        let r = if k % 2 == 0 { 1.0 } else { inner };
        let (sin, cos) = (TAU * f64::from(k) / f64::from(2 * n)).sin_cos();
        [r * cos, r * sin]
    });
    let flat: Vec<[f64; 2]> = rim.chain([[0.0; 2]]).collect();
    let caps: Vec<[u32; 3]> = (0..2 * n).map(|k| [2 * n, k, (k + 1) % (2 * n)]).collect();
    extruded("star", &flat, &caps, h)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pose;
    use crate::rational::exact;
    use crate::volumes::{Exact, whole};
    use std::collections::HashSet;

    #[test]
    fn meshes_are_closed_and_turned_outward() {
        let cuboid = triangulated(&super::super::cuboid([0.5; 3]));
        let volumes = [(bracket(0.5), 3.0), (square_frame(0.5), 3.0), (cuboid, 1.0)];
        for (shape, volume) in &volumes {
            let mesh = Exact::at(&shape.points, &shape.faces, &Pose::IDENTITY);
            assert_eq!(whole(&mesh).0, exact(*volume), "{}", shape.name);
        }
        for shape in volumes.iter().map(|x| &x.0).chain([&star(5, 0.4, 0.25)]) {
            let edges = shape.faces.iter().flat_map(|f| (0..3).map(|k| (f[k], f[(k + 1) % 3])));
            let once: HashSet<(u32, u32)> = edges.clone().collect();
            assert_eq!(once.len(), 3 * shape.faces.len(), "{}", shape.name);
            assert!(once.iter().all(|(i, j)| once.contains(&(*j, *i))), "{}", shape.name);
        }
    }
}
