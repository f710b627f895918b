//! Exact answers about closed meshes of triangles and about translations of convex bodies: the side
//! and the distance of a point, contact states and distances of two meshes, times of first contact,
//! and first hits of rays.
//!
//! Every pair of features is tried over the integers, so this is for meshes of some dozens of
//! triangles. It relies on three facts:
//!
//! 1. Two surfaces that do not pass through each other are closest at a vertex and a vertex, edge or
//!    triangle, or at two edges. They pass through each other if an edge passes through the inside
//!    of a triangle from one side to the other, or if the least such distance is zero.
//! 2. The winding number of a point is the number of triangles that a ray leaves through, minus
//!    those that it enters through. A ray that meets no edge counts right.
//! 3. A convex body that moves along a line meets another while no facet of their difference
//!    separates them. Each facet does until a time that is a fraction.

use crate::body::{Body, Placed, place_two};
use crate::exact::{facet_normals, least};
use crate::minkowski;
use crate::queries::{Query, QueryTruth};
use crate::rational::{IntVec, cross, dot, exact, rounded, sub};
use crate::rng::Rng;
use crate::shapes::Shape;
use crate::verdict::{ContactState, Exact};
use crate::volumes::{self, Exact as Mesh};
use crate::{Point, Pose};
use dashu_int::IBig;
use dashu_ratio::RBig;

/// Returns a ray from the origin whose coordinates have no simple ratio.
fn direction(k: u64) -> IntVec {
    let mut rng = Rng::new(k);
    std::array::from_fn(|_| IBig::from(rng.int(-1_000_003, 1_000_003)))
}

/// Returns the three signs that say on which side of a triangle's edges the line from `p` along `d`
/// passes.
fn sides(p: &IntVec, d: &IntVec, corners: &[IntVec]) -> [i32; 3] {
    let from = [0, 1, 2].map(|k| sub(&corners[k], p));
    [0, 1, 2].map(|k| sign(&dot(d, &cross(&from[k], &from[(k + 1) % 3]))))
}

fn sign(x: &IBig) -> i32 {
    i32::from(*x > IBig::ZERO) - i32::from(*x < IBig::ZERO)
}

/// Returns the winding number of a closed surface around a point that is not on it.
fn winding(p: &IntVec, body: &Placed) -> i32 {
    let along = |d: &IntVec| {
        let mut sum = 0;
        for (corners, n) in &body.faces {
            let signs = sides(p, d, corners);
            // A point in line with an edge has it at a side zero along every ray.
            if signs.contains(&1) && signs.contains(&-1) {
                continue;
            }
            if signs.contains(&0) {
                return None;
            }
            let ahead = sign(&dot(n, &sub(&corners[0], p))) * sign(&dot(n, d)) > 0;
            if ahead {
                sum += sign(&dot(n, d));
            }
        }
        Some(sum)
    };
    (1..)
        .find_map(|k| along(&direction(k)))
        .expect("some ray meets no edge")
}

/// Returns whether an edge of `a` passes through the inside of a triangle of `b`.
fn pierces(a: &Placed, b: &Placed) -> bool {
    a.edges.iter().any(|[p, q]| {
        let d = sub(q, p);
        b.faces.iter().any(|(corners, n)| {
            let ends = [p, q].map(|x| sign(&dot(n, &sub(x, &corners[0]))));
            let signs = sides(p, &d, corners);
            ends[0] * ends[1] < 0 && signs[0] != 0 && signs[0] == signs[1] && signs[1] == signs[2]
        })
    })
}

fn value(exact: &Exact) -> Option<[f64; 2]> {
    Some([exact.distance, exact.remainder])
}

/// Returns the signed distance of a point from the surface of a mesh, negative inside.
fn of_point(mesh: Body, point: Point) -> QueryTruth {
    let at = Body::new(std::slice::from_ref(&point), &[]);
    let (placed, p, den) = place_two(mesh, &Pose::IDENTITY, at, &Pose::IDENTITY);
    let (num, below) = least(&placed, &p);
    let state = if num.is_zero() {
        ContactState::Touching
    } else if winding(&p.points[0], &placed) == 0 {
        ContactState::Separated
    } else {
        ContactState::Overlapping
    };
    let squared = RBig::from_parts_signed(num, below * &den * &den);
    QueryTruth {
        state,
        value: value(&Exact::new(state, squared)),
        size: minkowski::size(mesh, &Pose::IDENTITY, at, &Pose::IDENTITY),
    }
}

/// Returns the contact state of two meshes, their distance if they are apart, and their depth if
/// both are convex.
fn of_meshes(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, are_convex: bool) -> QueryTruth {
    let size = minkowski::size(a, pose_a, b, pose_b);
    let (x, y, den) = place_two(a, pose_a, b, pose_b);
    let (num, below) = least(&x, &y);
    let inside = |x: &Placed, y: &Placed| winding(&x.points[0], y) != 0;
    let state = if pierces(&x, &y) || pierces(&y, &x) {
        ContactState::Overlapping
    } else if !num.is_zero() {
        if inside(&x, &y) || inside(&y, &x) {
            ContactState::Overlapping
        } else {
            ContactState::Separated
        }
    } else {
        // A tie: only a common volume tells whether interiors meet.
        let at = |body: Body, pose: &Pose| Mesh::at(body.points, body.faces, pose);
        let (volume, _) = volumes::shared(&at(a, pose_a), &at(b, pose_b));
        if volume.is_zero() {
            ContactState::Touching
        } else {
            ContactState::Overlapping
        }
    };
    let squared = RBig::from_parts_signed(num, below * &den * &den);
    let value = match state {
        ContactState::Overlapping if are_convex => {
            let truth = minkowski::solve(a, pose_a, b, pose_b);
            Some([truth.distance, truth.remainder])
        }
        ContactState::Overlapping => None,
        _ => value(&Exact::new(state, squared)),
    };
    QueryTruth { state, value, size }
}

/// Returns a time as the nearest number and what rounding lost.
fn time(t: &RBig) -> Option<[f64; 2]> {
    let head = rounded(t);
    Some([head, rounded(&(t - exact(head)))])
}

/// Returns when a convex body that moves by `velocity` from time 0 to 1 first meets another.
fn of_cast(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, velocity: Point) -> QueryTruth {
    let size = minkowski::size(a, pose_a, b, pose_b);
    let (x, y, den) = place_two(a, pose_a, b, pose_b);
    let v = velocity.map(|c| exact(c) * RBig::from(den.clone()));
    // The times at which no facet separates the bodies, and at which their interiors meet.
    let (mut first, mut last) = (RBig::ZERO, RBig::ONE);
    let (mut is_apart, mut is_flush) = (false, false);
    for n in facet_normals(&x, &y) {
        let ((low_a, high_a), (low_b, high_b)) = (x.extent(&n), y.extent(&n));
        let rate = (0..3).fold(RBig::ZERO, |sum, k| sum + &v[k] * RBig::from(n[k].clone()));
        for (gap, rate) in [(low_b - high_a, rate.clone()), (low_a - high_b, -rate)] {
            let gap = RBig::from(gap);
            if rate.is_zero() {
                is_apart |= gap > RBig::ZERO;
                is_flush |= gap.is_zero();
            } else {
                let at = -(gap / &rate);
                if rate < RBig::ZERO {
                    first = first.max(at);
                } else {
                    last = last.min(at);
                }
            }
        }
    }
    let state = if is_apart || first > last {
        ContactState::Separated
    } else if is_flush || first == last {
        ContactState::Touching
    } else {
        ContactState::Overlapping
    };
    let value = (state != ContactState::Separated).then(|| time(&first)).flatten();
    QueryTruth { state, value, size }
}

/// Returns when a ray first meets a mesh, as a part of `direction`.
///
/// The ray touches if it meets an edge or a vertex first, and overlaps if it starts inside or meets
/// the inside of a triangle.
fn of_ray(mesh: Body, origin: Point, direction: Point) -> QueryTruth {
    let end: Point = std::array::from_fn(|k| origin[k] + direction[k]);
    let at = Body::new(std::slice::from_ref(&origin), &[]);
    let size = minkowski::size(mesh, &Pose::IDENTITY, at, &Pose::IDENTITY).max(minkowski::size(
        mesh,
        &Pose::IDENTITY,
        Body::new(std::slice::from_ref(&end), &[]),
        &Pose::IDENTITY,
    ));
    let ray = [origin, direction];
    let (placed, ray, _) = place_two(mesh, &Pose::IDENTITY, Body::new(&ray, &[]), &Pose::IDENTITY);
    let (p, d) = (&ray.points[0], &ray.points[1]);
    let from = Placed::new(vec![p.clone()], &[]);
    let is_on = least(&placed, &from).0.is_zero();
    if is_on || winding(p, &placed) != 0 {
        return QueryTruth {
            state: if is_on {
                ContactState::Touching
            } else {
                ContactState::Overlapping
            },
            value: Some([0.0; 2]),
            size,
        };
    }
    let mut best: Option<(RBig, bool)> = None;
    for (corners, n) in &placed.faces {
        let along = dot(n, d);
        let signs = sides(p, d, corners);
        if along.is_zero() || signs.contains(&1) && signs.contains(&-1) {
            continue;
        }
        let t = RBig::from(dot(n, &sub(&corners[0], p))) / RBig::from(along);
        let is_edge = signs.contains(&0);
        if t < RBig::ZERO || t > RBig::ONE || best.as_ref().is_some_and(|(s, _)| *s < t) {
            continue;
        }
        let was_edge = best.as_ref().is_some_and(|(s, edge)| *s == t && *edge);
        best = Some((t, is_edge || was_edge));
    }
    let state = match &best {
        None => ContactState::Separated,
        Some((_, true)) => ContactState::Touching,
        Some((_, false)) => ContactState::Overlapping,
    };
    QueryTruth {
        state,
        value: best.and_then(|(t, _)| time(&t)),
        size,
    }
}

/// Returns the exact answer of a query, given the bodies by their numbers.
///
/// # Panics
/// If a number is not finite, or a mesh is not closed.
pub fn solve<'s>(query: &Query, shape: impl Fn(usize) -> &'s Shape) -> QueryTruth {
    let body = |id: usize| Body::from(shape(id));
    match *query {
        Query::Point { mesh, point } => of_point(body(mesh), point),
        Query::Meshes { a, b, pose_a, pose_b } => {
            let are_convex = [a, b].iter().all(|id| is_convex(shape(*id)));
            of_meshes(body(a), &pose_a, body(b), &pose_b, are_convex)
        }
        Query::Cast {
            a,
            b,
            pose_a,
            pose_b,
            velocity,
        } => of_cast(body(a), &pose_a, body(b), &pose_b, velocity),
        Query::Ray {
            mesh,
            origin,
            direction,
        } => of_ray(body(mesh), origin, direction),
    }
}

/// Returns whether no vertex is above the plane of any triangle.
fn is_convex(shape: &Shape) -> bool {
    let body = Body::from(shape);
    let (placed, ..) = place_two(body, &Pose::IDENTITY, body, &Pose::IDENTITY);
    let below = |p: &IntVec| placed.faces.iter().all(|(c, n)| dot(n, &sub(p, &c[0])) <= IBig::ZERO);
    placed.points.iter().all(below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn truth(query: Query, shapes: &[Shape]) -> (ContactState, Option<f64>) {
        let truth = solve(&query, |id| &shapes[id]);
        (truth.state, truth.value.map(|v| v[0]))
    }

    #[test]
    fn closed_forms_of_a_frame_and_a_box() {
        use ContactState::{Overlapping, Separated, Touching};
        // The frame is the square of side 2 without that of side 1, 1 high.
        let all = [
            shapes::square_frame(0.5),
            shapes::triangulated(&shapes::cuboid([0.5; 3])),
        ];
        let point = |point| truth(Query::Point { mesh: 0, point }, &all);
        assert_eq!(point([0.0; 3]), (Separated, Some(0.5)));
        assert_eq!(point([0.75, 0.0, 0.0]), (Overlapping, Some(-0.25)));
        assert_eq!(point([0.5, 0.25, 0.0]), (Touching, Some(0.0)));
        let meshes = |x: f64| {
            let (pose_a, pose_b) = (Pose::IDENTITY, Pose::shift([x, 0.0, 0.0]));
            truth(
                Query::Meshes {
                    a: 0,
                    b: 1,
                    pose_a,
                    pose_b,
                },
                &all,
            )
        };
        assert_eq!(meshes(0.0), (Touching, Some(0.0)), "the box fills the hole");
        assert_eq!(meshes(0.25), (Overlapping, None));
        assert_eq!(meshes(2.0), (Separated, Some(0.5)));
        let cast = |x: f64, y: f64| {
            let query = Query::Cast {
                a: 1,
                b: 1,
                pose_a: Pose::IDENTITY,
                pose_b: Pose::shift([-3.0, y, 0.0]),
                velocity: [x, 0.0, 0.0],
            };
            truth(query, &all)
        };
        assert_eq!(cast(4.0, 0.0), (Overlapping, Some(0.5)));
        assert_eq!(cast(4.0, 1.0), (Touching, Some(0.5)));
        assert_eq!(cast(4.0, 1.5), (Separated, None));
        assert_eq!(cast(1.0, 0.0), (Separated, None));
        let ray = |y: f64, x: f64| {
            let (origin, direction) = ([-2.0, y, 0.125], [x, 0.0, 0.0]);
            truth(
                Query::Ray {
                    mesh: 0,
                    origin,
                    direction,
                },
                &all,
            )
        };
        assert_eq!(ray(0.3, 2.0), (Overlapping, Some(0.5)));
        assert_eq!(ray(1.0, 2.0).1, Some(0.5));
        assert_eq!(ray(2.0, 2.0), (Separated, None));
    }

    #[test]
    fn depths_and_distances_of_boxes_are_those_of_their_hulls() {
        let all = [shapes::triangulated(&shapes::cuboid([1.0, 0.5, 0.25]))];
        let mut rng = Rng::new(3);
        for _ in 0..40 {
            let pose = |rng: &mut Rng| Pose::new(rng.quat(), rng.in_ball());
            let (pose_a, pose_b) = (pose(&mut rng), pose(&mut rng));
            let found = truth(
                Query::Meshes {
                    a: 0,
                    b: 0,
                    pose_a,
                    pose_b,
                },
                &all,
            );
            let body = Body::from(&all[0]);
            let hulls = minkowski::solve(body, &pose_a, body, &pose_b);
            assert_eq!(found, (hulls.state, Some(hulls.distance)));
        }
    }
}
