//! Exact merged faces of a few points, by testing the plane of every triple of points.
//!
//! The number of planes is cubic in the number of points, so this is for tens of points only. The
//! coordinates count as exact. Duplicates, interior points, and points in the interior of a face or
//! an edge belong to no face. The points that remain are exactly the extreme points.

use crate::rational::{IntVec, common, cross, dot, placed, sub};
use crate::{Face, Point, Pose};
use dashu_int::IBig;

/// Returns the faces of the convex hull, counter-clockwise from outside; none if the points are
/// coplanar.
///
/// Of equal points, the first is used. Each face starts at its least index, and faces are sorted.
pub fn faces(points: &[Point]) -> Vec<Face> {
    let (p, _, _) = common(&placed(points, &Pose::IDENTITY), &[]);
    let first: Vec<usize> = (0..p.len()).filter(|&i| !p[..i].contains(&p[i])).collect();
    let mut out: Vec<Face> = Vec::new();
    for (x, &i) in first.iter().enumerate() {
        for (y, &j) in first.iter().enumerate().skip(x + 1) {
            for &k in &first[y + 1..] {
                out.extend(face_through(&p, &first, i, j, k));
            }
        }
    }
    out.sort_unstable();
    out.dedup(); // each triple of a face's vertices found the face
    out
}

/// Returns the indices of the extreme points, ascending; empty if the points are coplanar.
pub fn extreme(points: &[Point]) -> Vec<u32> {
    let mut ids: Vec<u32> = faces(points).concat();
    ids.sort_unstable();
    ids.dedup();
    ids
}

/// Returns the face in the plane of three points, if all other points lie on one side, and some off
/// the plane.
fn face_through(p: &[IntVec], ids: &[usize], i: usize, j: usize, k: usize) -> Option<Face> {
    let n = cross(&sub(&p[j], &p[i]), &sub(&p[k], &p[i]));
    if n.iter().all(IBig::is_zero) {
        return None;
    }
    let height: Vec<IBig> = ids.iter().map(|&m| dot(&n, &sub(&p[m], &p[i]))).collect();
    let above = height.iter().any(|h| *h > IBig::ZERO);
    let below = height.iter().any(|h| *h < IBig::ZERO);
    if above == below {
        return None;
    }
    let outward = if above { n.map(|x| -x) } else { n };
    let flat: Vec<usize> = ids
        .iter()
        .zip(&height)
        .filter(|(_, h)| h.is_zero())
        .map(|(&m, _)| m)
        .collect();
    Some(rim(p, &flat, &outward))
}

/// Returns the vertices of coplanar points in order about `n`, by gift wrapping (Jarvis 1973).
fn rim(p: &[IntVec], flat: &[usize], n: &IntVec) -> Face {
    // The lexicographically least point is a vertex, in any plane.
    let start = *flat
        .iter()
        .min_by(|&&a, &&b| p[a].cmp(&p[b]))
        .expect("three points at least");
    let mut face = vec![start];
    loop {
        let from = *face.last().expect("not empty");
        let next = flat.iter().copied().filter(|&m| m != from).reduce(|best, m| {
            let (u, v) = (sub(&p[best], &p[from]), sub(&p[m], &p[from]));
            let turn = dot(&cross(&u, &v), n);
            // The next vertex has all other points on its left; of collinear points, the farthest
            // is the vertex.
            let farther = dot(&v, &v) > dot(&u, &u);
            if turn < IBig::ZERO || turn.is_zero() && farther {
                m
            } else {
                best
            }
        });
        match next {
            Some(m) if m != start => face.push(m),
            _ => break,
        }
    }
    let least = (0..face.len()).min_by_key(|&i| face[i]).expect("not empty");
    face.rotate_left(least);
    face.into_iter().map(|i| i as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use crate::shapes;

    /// V - E + F, with each edge counted once.
    fn euler(points: &[Point]) -> usize {
        let f = faces(points);
        extreme(points).len() + f.len() - f.iter().map(Vec::len).sum::<usize>() / 2
    }

    #[test]
    fn a_box_has_six_faces_whatever_else_lies_in_it() {
        let mut points = shapes::cuboid([1.0, 2.0, 3.0]).points;
        let plain = faces(&points);
        assert_eq!(plain.len(), 6);
        assert!(plain.iter().all(|f| f.len() == 4));
        points.extend([[0.0; 3], [1.0, 0.0, 0.5], [1.0, 2.0, 0.0], points[3]]);
        assert_eq!(faces(&points), plain, "inside, on a face, on an edge, twice");
    }

    #[test]
    fn faces_turn_counter_clockwise_from_outside() {
        let points = shapes::octahedron().points;
        for f in faces(&points) {
            let [a, b, c] = [0, 1, 2].map(|i| points[f[i] as usize]);
            let n = crate::pose::cross(crate::pose::sub(b, a), crate::pose::sub(c, a));
            assert!(crate::pose::dot(n, a) > 0.0);
        }
    }

    #[test]
    fn random_hulls_obey_euler() {
        let mut r = Rng::new(11);
        for n in 4..13 {
            assert_eq!(euler(&shapes::ellipsoid(&mut r, n, [1.0, 0.3, 1e-7]).points), 2);
            let lattice = shapes::lattice(&mut r, n, 2).points;
            if !faces(&lattice).is_empty() {
                assert_eq!(euler(&lattice), 2);
            }
        }
    }

    #[test]
    fn points_of_one_plane_have_no_faces() {
        assert!(faces(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]).is_empty());
        assert!(faces(&[]).is_empty());
    }
}
