//! From the triangles of a hull to its faces: exactly coplanar adjacent triangles become one face,
//! and only extreme points are kept.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::sign::{projection, side, turn};
use crate::body::polyhedron::build::hull::{HullSurface, HullTriangle};

const NONE: u32 = u32::MAX;

/// The faces of a hull as loops over its extreme points.
pub(crate) struct Facets {
    /// Vertices in the order of the cloud, as indices there.
    pub(crate) kept: Vec<u32>,
    /// Boundaries of the faces by vertex number, counter-clockwise from outside, least vertex
    /// first, in ascending order.
    pub(crate) loops: Vec<Vec<u32>>,
    /// Points of the cloud inside an edge, if they were vertices of the triangles.
    pub(crate) on_edges: Vec<u32>,
    /// Points of the cloud inside a face, if they were vertices of the triangles.
    pub(crate) on_faces: Vec<u32>,
    /// Number of triangles merged into faces.
    pub(crate) merged: usize,
    /// The face of each triangle.
    pub(crate) face_of: Vec<u32>,
}

impl Facets {
    pub(crate) fn new(points: &[Vector3<f64>], surface: &HullSurface) -> Option<Self> {
        let triangles = &surface.triangles;
        let (group, groups) = coplanar_groups(points, triangles);
        let degree = faces_at(points.len(), triangles, &group);
        let mut number = vec![NONE; points.len()];
        let mut facets = Self {
            kept: Vec::new(),
            loops: Vec::with_capacity(groups),
            on_edges: Vec::new(),
            on_faces: Vec::new(),
            merged: triangles.len() - groups,
            face_of: Vec::new(),
        };
        for (i, degree) in degree.iter().enumerate() {
            match degree {
                0 => {}
                1 => facets.on_faces.push(i as u32),
                2 => facets.on_edges.push(i as u32),
                _ => {
                    number[i] = facets.kept.len() as u32;
                    facets.kept.push(i as u32);
                }
            }
        }
        let mut done = vec![false; groups];
        let mut order = Vec::with_capacity(groups);
        for start in 0..triangles.len() {
            let g = group[start] as usize;
            let Some(k) = (0..3).find(|&k| group[triangles[start].adjacent[k] as usize] != group[start]) else {
                continue;
            };
            if !core::mem::replace(&mut done[g], true) {
                let ring = rim(triangles, &group, &number, start as u32, k)?;
                order.push(((ring[0] as u64) << 32 | ring[1] as u64, facets.loops.len(), g));
                facets.loops.push(ring);
            }
        }
        order.sort_unstable();
        let mut face_of_group = vec![NONE; groups];
        for (&(_, _, g), face) in order.iter().zip(0u32..) {
            face_of_group[g] = face;
        }
        facets.face_of = group.iter().map(|&g| face_of_group[g as usize]).collect();
        facets.loops = order
            .into_iter()
            .map(|(_, i, _)| core::mem::take(&mut facets.loops[i]))
            .collect();
        (facets.loops.len() == groups).then_some(facets)
    }

    /// Returns whether a point of the hull that lies in the plane of a triangle is on an edge of
    /// the triangle's face.
    pub(crate) fn is_on_edge(&self, points: &[Vector3<f64>], triangle: u32, p: &Vector3<f64>) -> bool {
        let rim = &self.loops[self.face_of[triangle as usize] as usize];
        let at = |k: usize| &points[self.kept[rim[k] as usize] as usize];
        // Vertices are extreme, so no three are collinear.
        let Some(axis) = projection(at(0), at(1), at(2)) else {
            return false;
        };
        let sense = turn(axis, at(0), at(1), at(2));
        is_on_rim(rim.len(), |i, j| turn(axis, at(i), at(j), p) * sense.signum())
    }
}

/// Returns whether a point of a closed convex polygon of `corners` vertices is on an edge.
/// `turn(i, j)` must be positive if the point is to the left of the line from vertex `i` to vertex
/// `j`, and zero on the line; called a number of times logarithmic in the vertices.
fn is_on_rim(corners: usize, mut turn: impl FnMut(usize, usize) -> f64) -> bool {
    // The point is between the diagonals from corner 0 to `low` and to `high`.
    let (mut low, mut high) = (1, corners - 1);
    if turn(0, low) == 0.0 || turn(0, high) == 0.0 {
        return true;
    }
    while high - low > 1 {
        let middle = low.midpoint(high);
        if turn(0, middle) >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    turn(low, high) == 0.0
}

/// Returns the face number of each triangle, and the number of faces.
fn coplanar_groups(points: &[Vector3<f64>], triangles: &[HullTriangle]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    for (i, t) in triangles.iter().enumerate() {
        let [a, b, c] = t.v.each(|v| &points[v as usize]);
        for &other in t.adjacent.iter().filter(|&&o| (o as usize) > i) {
            let across = triangles[other as usize].v.into_iter().find(|v| !t.v.contains(v));
            if across.is_some_and(|d| side(a, b, c, &points[d as usize]) == 0.0) {
                let (p, q) = (root(&mut parent, i as u32), root(&mut parent, other));
                parent[p.max(q) as usize] = p.min(q);
            }
        }
    }
    // Roots come before all members, so a single pass numbers the groups.
    let mut group = vec![NONE; triangles.len()];
    let mut count = 0;
    for i in 0..triangles.len() {
        let r = root(&mut parent, i as u32) as usize;
        if r == i {
            group[i] = count;
            count += 1;
        } else {
            group[i] = group[r];
        }
    }
    (group, count as usize)
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Returns the number of faces at each point, counted up to 3: a vertex has three, a point inside
/// an edge two.
fn faces_at(points: usize, triangles: &[HullTriangle], group: &[u32]) -> Vec<u8> {
    let mut degree = vec![0u8; points];
    let mut met = vec![[NONE; 2]; points];
    for (t, &g) in triangles.iter().zip(group) {
        for v in t.v.each(|v| v as usize) {
            if degree[v] < 3 && !met[v][..degree[v] as usize].contains(&g) {
                if degree[v] < 2 {
                    met[v][degree[v] as usize] = g;
                }
                degree[v] += 1;
            }
        }
    }
    degree
}

/// Returns the extreme points around the face of triangle `start`, whose edge `k` is on the
/// boundary; least vertex first.
fn rim(triangles: &[HullTriangle], group: &[u32], number: &[u32], start: u32, k: usize) -> Option<Vec<u32>> {
    let mut ring = Vec::with_capacity(3);
    let (mut t, mut e) = (start, k);
    for _ in 0..3 * triangles.len() {
        let vertex = number[triangles[t as usize].v[e] as usize];
        if vertex != NONE {
            ring.push(vertex);
        }
        // The next rim edge leaves the end of this edge: turn about the end through triangles of
        // one face.
        e = (e + 1) % 3;
        let mut other = triangles[t as usize].adjacent[e];
        while group[other as usize] == group[start as usize] {
            let pivot = triangles[t as usize].v[e];
            t = other;
            e = triangles[t as usize].v.iter().position(|&v| v == pivot)?;
            other = triangles[t as usize].adjacent[e];
        }
        if (t, e) == (start, k) {
            let least = ring.iter().enumerate().min_by_key(|r| r.1)?.0;
            ring.rotate_left(least);
            return (ring.len() >= 3).then_some(ring);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::ConvexPolyhedron;
    use crate::rng::Rng;
    use nalgebra::Point3;

    /// A polygon on a parabola, with vertices `(k, k^2)`, doubled so that midpoints of edges are
    /// whole.
    #[test]
    fn a_point_is_found_on_a_rim_by_a_logarithm_of_looks() {
        for corners in [3usize, 4, 5, 17, 1000] {
            let at = |k: usize| [2 * k as i64, 2 * (k * k) as i64];
            let most = 2 * (usize::BITS - corners.leading_zeros()) + 3;
            let ask = |p: [i64; 2]| {
                let mut looks = 0;
                let reported = is_on_rim(corners, |i, j| {
                    looks += 1;
                    let ([ax, ay], [bx, by]) = (at(i), at(j));
                    ((bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax)) as f64
                });
                assert!(looks <= most, "{looks} looks at {corners} corners");
                reported
            };
            for k in 0..corners {
                let ([ax, ay], [bx, by]) = (at(k), at((k + 1) % corners));
                assert!(ask([(ax + bx) / 2, (ay + by) / 2]), "{corners} {k}");
            }
            // Two units above the parabola, the first and the last vertex left out.
            for k in 1..corners.saturating_sub(2) {
                let [x, y] = at(k);
                assert!(!ask([x + 1, y + 2 * k as i64 + 2]), "{corners} {k}");
            }
        }
    }

    /// The report sorts points that are no vertices as a test of all faces does.
    #[test]
    fn every_face_looked_at_sorts_points_out_alike() {
        let mut rng = Rng::new(71);
        let mut found = [0; 3];
        for round in 0..300 {
            let n = 8 + rng.below(60);
            let side = 2 + rng.below(6);
            let mut points: Vec<Vector3<f64>> = (0..n)
                .map(|_| Vector3::from([0; 3].map(|_| 6.0 * rng.below(side) as f64)))
                .collect();
            // Midpoints and centroids of some points, exact because coordinates are multiples of
            // six.
            for _ in 0..n {
                let [p, q, r] = [0; 3].map(|_| points[rng.below(n)]);
                points.push(if rng.below(2) == 0 {
                    (p + q) / 2.0
                } else {
                    (p + q + r) / 3.0
                });
            }
            let points: Vec<Point3<f64>> = points.into_iter().map(Point3::from).collect();
            let Ok(body) = ConvexPolyhedron::from_points(&points) else {
                continue;
            };
            let report = body.report();
            let copies: Vec<usize> = report.duplicates.iter().map(|d| d.0 as usize).collect();
            for (i, p) in points.iter().enumerate().filter(|(i, _)| !copies.contains(i)) {
                let stored = (p.coords - body.origin) / body.unit();
                let on = body.faces().filter(|f| body.face_side(*f, &stored) == 0.0).count();
                let i = i as u32;
                let listed = [&report.interior, &report.on_faces, &report.on_edges].map(|list| list.contains(&i));
                assert_eq!(listed, [on == 0, on == 1, on == 2], "{round}: {p} is on {on} faces");
                if on < 3 {
                    found[on] += 1;
                }
            }
        }
        assert!(found.iter().all(|&n| n > 300), "{found:?}");
    }
}
