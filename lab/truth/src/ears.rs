//! Triangulation of polygons, including concave polygons.

use crate::Point;
use crate::pose::{add, cross, sub};

/// Triangulates a polygon along interior diagonals, seen along its mean normal.
///
/// A convex polygon is cut from its first vertex, and so is the rest of a polygon that crosses
/// itself.
pub(crate) fn cut(points: &[Point], face: &[u32]) -> Vec<[u32; 3]> {
    let at = |v: u32| points[v as usize];
    let dot = |p: Point, q: Point| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let first = at(face[0]);
    let fan = face[1..].windows(2);
    let normal = fan.fold([0.0; 3], |n, w| {
        add(n, cross(sub(at(w[0]), first), sub(at(w[1]), first)))
    });
    let turn = |a: u32, b: u32, c: u32| dot(normal, cross(sub(at(b), at(a)), sub(at(c), at(a))));
    let mut rest = face.to_vec();
    let mut triangles = Vec::with_capacity(face.len() - 2);
    while rest.len() > 3 {
        let n = rest.len();
        let ear = |&k: &usize| {
            let [a, b, c] = [rest[k - 1], rest[k % n], rest[(k + 1) % n]];
            let holds = |p: u32| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0 && !rest.iter().any(|&p| ![a, b, c].contains(&p) && holds(p))
        };
        let k = (1..=n).find(ear).unwrap_or(1);
        triangles.push([rest[k - 1], rest[k % n], rest[(k + 1) % n]]);
        rest.remove(k % n);
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    triangles
}
