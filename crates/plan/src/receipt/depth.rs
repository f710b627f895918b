//! The line of a depth: a normal for the upper bound, a closed surface of A - B for the lower one.

use nalgebra::{Isometry3, Point3, Vector3};

use super::number::{hex, hexes};
use super::scene::Scene;
use crate::extremes::Extremes;
use crate::tolerance::RECEIPT;
use lin_canny::Outcome;
use lin_canny::polyhedron::ConvexPolyhedron;

/// Most differences of vertices whose hull is stated. Not measured.
const DIFFERENCES: usize = 4096;

/// Returns the line of the depth of two bodies at rest, if one of its sides is certain.
///
/// Both bounds leave room for rounding: they are those of the evidence, not of the outcome.
pub(super) fn depth(scene: &Scene, b_in_a: &Isometry3<f64>, outcome: &Outcome) -> Option<String> {
    let [a, b] = [&scene.bodies[0], &scene.bodies[1]];
    let a_points: Vec<Vector3<f64>> = a.hull.vertex_points().map(|p| p.coords).collect();
    let b_points: Vec<Vector3<f64>> = b.hull.vertex_points().map(|p| (b_in_a * p).coords).collect();
    let radii = a.radius + b.radius;
    let (room, n) = (RECEIPT * scene.size(), outcome.normal.into_inner());
    let most =
        |all: &[Vector3<f64>], n: Vector3<f64>| all.iter().map(|p| n.dot(p)).fold(f64::NEG_INFINITY, f64::larger);
    let size = (most(&a_points, n) + most(&b_points, -n)) / n.norm() + room;
    let mut text = String::from("{\"depth\":[0,1]");
    let is_upper = size > 0.0 && size.is_finite();
    if is_upper {
        let upper = hex(size + radii + room);
        text += &format!(",\"upper\":\"{upper}\",\"normal\":{}", hexes(n.as_slice()));
    }
    let lower = surface(&a_points, &b_points, room);
    if let Some((radius, pairs, facets)) = &lower {
        let list = |all: Vec<String>| all.join(",");
        let pairs = list(pairs.iter().map(|[i, j]| format!("[{i},{j}]")).collect());
        let facets = list(facets.iter().map(|[p, q, r]| format!("[{p},{q},{r}]")).collect());
        let lower = hex((radius + radii - room).larger(radii));
        text += &format!(",\"lower\":\"{lower}\",\"points\":[{pairs}],\"facets\":[{facets}]");
    }
    (is_upper || lower.is_some()).then(|| text + "}")
}

/// A radius, pairs of vertices, and triangles of their differences.
type Surface = (f64, Vec<[usize; 2]>, Vec<[usize; 3]>);

/// Returns a closed surface of differences around 0 and the radius of a ball inside it.
fn surface(a: &[Vector3<f64>], b: &[Vector3<f64>], room: f64) -> Option<Surface> {
    if a.len() * b.len() > DIFFERENCES {
        return None;
    }
    let of = |[i, j]: [usize; 2]| a[i] - b[j];
    let every: Vec<[usize; 2]> = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| [i, j])).collect();
    let cloud: Vec<Point3<f64>> = every.iter().map(|pair| of(*pair).into()).collect();
    let hull = ConvexPolyhedron::from_points(&cloud).ok()?;
    let nearest = |p: Point3<f64>| {
        let squares = every.iter().map(|pair| (*pair, (of(*pair) - p.coords).norm_squared()));
        squares
            .fold(
                ([0; 2], f64::INFINITY),
                |best, next| if next.1 < best.1 { next } else { best },
            )
            .0
    };
    let pairs: Vec<[usize; 2]> = hull.vertex_points().map(nearest).collect();
    let (mut facets, mut radius) = (Vec::new(), f64::INFINITY);
    for face in hull.faces() {
        let corners: Vec<usize> = hull.face_vertices(face).map(|v| v.index()).collect();
        for ends in corners[1..].windows(2) {
            let facet = [corners[0], ends[0], ends[1]];
            let [p, q, r] = facet.map(|k| of(pairs[k]));
            let normal = (q - p).cross(&(r - p));
            let height = normal.dot(&p) / normal.norm();
            // Of a facet without extent, the height is not a number.
            if !(height > room) {
                return None;
            }
            radius = radius.smaller(height);
            facets.push(facet);
        }
    }
    Some((radius, pairs, facets))
}
