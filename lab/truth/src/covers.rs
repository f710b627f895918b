//! Whether balls contain a triangle or a tetrahedron, over the rationals.
//!
//! A ball contains a simplex if it contains the corners. Balls contain a simplex if one of them
//! does, or if they contain both halves across its longest edge.

use crate::Point;
use crate::rational::{RBig, exact, rounded};

/// A ball: centre and radius.
pub type Ball = (Point, f64);

type Exact3 = [RBig; 3];

/// Halvings after which a simplex counts as not contained.
const DEPTH: u32 = 64;

/// Returns whether the union of the balls contains a simplex. May return false if a point of the
/// simplex is on the surface of a ball and in no other one.
pub fn contain<const N: usize>(balls: &[Ball], corners: &[Point; N]) -> bool {
    let exact_balls: Vec<(Exact3, RBig)> = balls
        .iter()
        .map(|(c, r)| (c.map(exact), &exact(*r) * &exact(*r)))
        .collect();
    let mut open = vec![(corners.map(|p| p.map(exact)), 0)];
    while let Some((corners, depth)) = open.pop() {
        let near = corners.each_ref().map(|p| p.each_ref().map(rounded));
        let may = |(c, r): &Ball| near.iter().all(|p| distance(p, c) <= r * (1.0 + 1e-12));
        let holds = |(c, square): &(Exact3, RBig)| corners.iter().all(|p| squared(p, c) <= *square);
        if (0..balls.len()).any(|k| may(&balls[k]) && holds(&exact_balls[k])) {
            continue;
        }
        if depth == DEPTH {
            return false;
        }
        let edges = (0..N).flat_map(|i| (0..i).map(move |j| (i, j)));
        let longest = edges.max_by(|a, b| {
            let length = |e: &(usize, usize)| distance(&near[e.0], &near[e.1]);
            length(a).total_cmp(&length(b))
        });
        let Some((i, j)) = longest else { return false };
        let half = RBig::from_parts(1.into(), 2u32.into());
        let middle: Exact3 = std::array::from_fn(|k| (&corners[i][k] + &corners[j][k]) * &half);
        for end in [i, j] {
            let mut part = corners.clone();
            part[end] = middle.clone();
            open.push((part, depth + 1));
        }
    }
    true
}

/// Returns whether a ball is inside a convex body, whose faces are triangles that are
/// counter-clockwise seen from outside.
pub fn is_inside((center, radius): &Ball, faces: &[[Point; 3]]) -> bool {
    let (center, radius) = (center.map(exact), exact(*radius));
    let square = &radius * &radius;
    faces.iter().all(|face| {
        let [a, b, c] = face.map(|p| p.map(exact));
        let way = |p: &Exact3| -> Exact3 { std::array::from_fn(|k| &p[k] - &a[k]) };
        let (u, v, w) = (way(&b), way(&c), way(&center));
        let normal: Exact3 = std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            &u[i] * &v[j] - &u[j] * &v[i]
        });
        let dot = |p: &Exact3, q: &Exact3| (0..3).fold(RBig::ZERO, |sum, k| sum + &p[k] * &q[k]);
        let height = dot(&normal, &w);
        height <= RBig::ZERO && &height * &height >= &square * dot(&normal, &normal)
    })
}

/// Returns the distance of two points, for points whose squares leave the range too.
fn distance(p: &Point, q: &Point) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}

fn squared(p: &Exact3, q: &Exact3) -> RBig {
    let difference = |k: usize| &p[k] - &q[k];
    (0..3).fold(RBig::ZERO, |sum, k| sum + difference(k) * difference(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_inside_until_it_meets_a_face() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f: [usize; 3]| f.map(|k| corners[k]));
        assert!(is_inside(&([0.125; 3], 0.125), &faces));
        assert!(!is_inside(&([0.125; 3], 0.125_f64.next_up()), &faces));
        assert!(!is_inside(&([2.0; 3], 0.0), &faces));
    }

    #[test]
    fn two_balls_contain_a_triangle_and_one_of_them_does_not() {
        let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.1, 0.0]];
        let [left, right] = [0.5, 1.5].map(|x| ([x, 0.0, 0.0], 0.6));
        assert!(contain(&[left, right], &triangle));
        assert!(!contain(&[left], &triangle));
        // A gap of one part in 1e9 between the balls.
        let [left, right] = [0.5, 1.5].map(|x| ([x, 0.0, 0.0], 0.5 - 1e-9));
        assert!(!contain(&[left, right], &triangle));
    }
}
