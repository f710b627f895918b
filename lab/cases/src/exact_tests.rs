//! Cases of the oracle computed by hand, and a comparison of its two halves.

use super::*;
use crate::Point;
use crate::brute_hull;
use crate::rng::Rng;
use crate::shapes::{self, Shape};

fn body(s: &Shape) -> Body<'_> {
    Body {
        points: &s.points,
        faces: &s.faces,
    }
}

fn ask(a: &Shape, pose_a: Pose, b: &Shape, pose_b: Pose) -> (ContactState, f64) {
    let e = solve(body(a), &pose_a, body(b), &pose_b);
    let f = solve(body(b), &pose_b, body(a), &pose_a);
    assert_eq!(
        (e.state, e.distance, e.remainder),
        (f.state, f.distance, f.remainder),
        "A-B and B-A"
    );
    (e.state, e.distance)
}

fn shifted(a: &Shape, b: &Shape, t: Point) -> (ContactState, f64) {
    ask(a, Pose::IDENTITY, b, Pose::shift(t))
}

#[test]
fn boxes_by_hand() {
    let unit = shapes::cuboid([0.5; 3]);
    let gap = |t| shifted(&unit, &unit, t);
    assert_eq!(gap([3.0, 0.0, 0.0]), (ContactState::Separated, 2.0), "face and face");
    assert_eq!(
        gap([4.0, 5.0, 0.25]),
        (ContactState::Separated, 5.0),
        "parallel edges: 3, 4, 5"
    );
    assert_eq!(
        gap([2.0, 3.0, 3.0]),
        (ContactState::Separated, 3.0),
        "corner and corner: 1, 2, 2"
    );
    assert_eq!(gap([1.0, 0.3, 0.0]), (ContactState::Touching, 0.0), "on a face");
    assert_eq!(gap([1.0, 1.0, 1.0]), (ContactState::Touching, 0.0), "at a corner");
    assert_eq!(
        gap([0.75, 0.5, 0.0]),
        (ContactState::Overlapping, -0.25),
        "the shallowest way out"
    );
    assert_eq!(gap([0.0; 3]), (ContactState::Overlapping, -1.0), "the same place");
}

#[test]
fn gaps_below_the_rounding_of_coordinates_are_seen() {
    let unit = shapes::cuboid([0.5; 3]);
    let eps = f64::EPSILON;
    assert_eq!(
        shifted(&unit, &unit, [1.0 + eps, 0.0, 0.0]),
        (ContactState::Separated, eps)
    );
    assert_eq!(
        shifted(&unit, &unit, [1.0 - eps, 0.0, 0.0]),
        (ContactState::Overlapping, -eps)
    );
    // 1 + 1e-15 is not a double; the sum of two translations is exact.
    let far = ask(
        &unit,
        Pose::shift([-1.0, 0.0, 0.0]),
        &unit,
        Pose::shift([1e-15, 0.0, 0.0]),
    );
    assert_eq!(far, (ContactState::Separated, 1e-15));
    let tiny = ask(
        &unit,
        Pose::shift([-1.0, 0.0, 0.0]),
        &unit,
        Pose::shift([-1e-300, 0.0, 0.0]),
    );
    assert_eq!(tiny, (ContactState::Overlapping, -1e-300));
}

#[test]
fn a_small_box_inside_a_large_one_overlaps() {
    let (large, small) = (shapes::cuboid([4.0; 3]), shapes::cuboid([0.5; 3]));
    assert_eq!(
        shifted(&large, &small, [1.0, 0.0, 0.0]),
        (ContactState::Overlapping, -3.5),
        "out through the near wall"
    );
    assert_eq!(
        shifted(&large, &small, [3.5, 0.0, 0.0]),
        (ContactState::Overlapping, -1.0),
        "flush from inside"
    );
}

#[test]
fn crossing_edges_and_a_corner_over_a_face() {
    let (long, unit) = (shapes::cuboid([2.0, 0.5, 0.5]), shapes::cuboid([0.5; 3]));
    let half_turn = Pose {
        q: [1.0, 0.0, 0.0, 0.0],
        t: [0.0; 3],
    };
    assert_eq!(
        ask(&long, half_turn, &unit, Pose::shift([0.0, 0.0, 2.0])),
        (ContactState::Separated, 1.0)
    );
    let (top, bottom) = (shapes::octahedron(), shapes::octahedron());
    assert_eq!(
        shifted(&top, &bottom, [0.0, 0.0, 3.0]),
        (ContactState::Separated, 1.0),
        "tip on tip"
    );
    assert_eq!(
        shifted(&unit, &top, [0.25, 0.0, 2.0]),
        (ContactState::Separated, 0.5),
        "tip over face"
    );
    // Rods along x and y, each standing on an edge: the crossing edges are sqrt(1/2) above and
    // below their axes.
    let on_edge = Pose::turn([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_4, [0.0; 3]);
    let across = Pose {
        q: [0.0, 0.0, 1.0, 1.0],
        t: [0.25, 0.125, 2.0],
    }
    .after(&on_edge);
    let (state, d) = ask(&long, on_edge, &long, across);
    assert_eq!(state, ContactState::Separated);
    assert!(
        (d - (2.0 - std::f64::consts::SQRT_2)).abs() < 1e-15,
        "edge over edge: {d}"
    );
}

#[test]
fn tetrahedra_with_crossing_edges() {
    // A's upper edge is along x at z = 0, B's lower edge along y at z = 1: only the pair of edges
    // gives 1.
    let a = Shape::hull(
        "lower",
        vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, -2.0], [0.0, 1.0, -2.0]],
    );
    let b = Shape::hull(
        "upper",
        vec![[0.0, -1.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 3.0], [1.0, 0.0, 3.0]],
    );
    let faces = [brute_hull::faces(&a.points), brute_hull::faces(&b.points)];
    let (a, b) = (
        Shape {
            faces: faces[0].clone(),
            ..a
        },
        Shape {
            faces: faces[1].clone(),
            ..b
        },
    );
    assert_eq!(shifted(&a, &b, [0.25, 0.125, 0.0]), (ContactState::Separated, 1.0));
    assert_eq!(shifted(&a, &b, [0.25, 0.125, -1.0]), (ContactState::Touching, 0.0));
    assert_eq!(
        shifted(&a, &b, [0.25, 0.125, -1.25]),
        (ContactState::Overlapping, -0.25)
    );
}

#[test]
fn points_and_segments_against_a_box() {
    let unit = shapes::cuboid([0.5; 3]);
    let solid = body(&unit);
    let point = |p: &[Point]| {
        let e = solve(solid, &Pose::IDENTITY, Body { points: p, faces: &[] }, &Pose::IDENTITY);
        (e.state, e.distance)
    };
    assert_eq!(point(&[[2.5, 0.0, 0.0]]), (ContactState::Separated, 2.0));
    assert_eq!(point(&[[0.5, 0.5, 0.0]]), (ContactState::Touching, 0.0));
    assert_eq!(
        point(&[[2.5, -9.0, 0.0], [2.5, 9.0, 0.1]]),
        (ContactState::Separated, 2.0)
    );
}

#[test]
fn the_distance_is_rounded_once_and_its_remainder_kept() {
    let unit = shapes::cuboid([0.5; 3]);
    let e = solve(body(&unit), &Pose::IDENTITY, body(&unit), &Pose::shift([2.0, 2.0, 0.0]));
    assert_eq!(e.squared, 2.into());
    assert_eq!(e.distance, std::f64::consts::SQRT_2);
    assert!(
        (e.remainder - -9.667293313452913e-17).abs() < 1e-32,
        "sqrt 2 to thirty digits"
    );
}

#[test]
fn a_quaternion_that_is_not_unit_places_the_same_body() {
    let (a, b) = (shapes::cuboid([1.0, 2.0, 3.0]), shapes::octahedron());
    let long = Pose {
        q: [0.0, 3.0, 0.0, 4.0],
        t: [5.0, 0.0, 0.0],
    };
    let longer = Pose {
        q: [0.0, 1.5, 0.0, 2.0],
        t: [5.0, 0.0, 0.0],
    };
    assert_eq!(ask(&a, long, &b, Pose::IDENTITY), ask(&a, longer, &b, Pose::IDENTITY));
}

/// The contact state comes from directions, the distance from features: they must agree. Scaling by
/// a power of two must scale the distance exactly.
#[test]
fn directions_and_features_tell_the_same_story() {
    let mut r = Rng::new(3);
    let mut seen = [0; 3];
    for _ in 0..60 {
        let (na, nb) = (4 + r.below(4), 4 + r.below(4));
        let (a, b) = (shapes::sphere(&mut r, na).solved(), shapes::sphere(&mut r, nb).solved());
        let (pa, pb) = (
            Pose {
                q: r.quat(),
                t: [0.0; 3],
            },
            Pose {
                q: r.quat(),
                t: crate::pose::scale(r.unit(), 1.3),
            },
        );
        let e = solve(body(&a), &pa, body(&b), &pb);
        seen[e.state as usize] += 1;
        let corner = |p: &Point| distance_to_body(pa.apply(*p), body(&b), &pb);
        let nearest = a.points.iter().map(corner).fold(f64::MAX, f64::min);
        match e.state {
            ContactState::Separated => assert!(e.distance > 0.0 && e.distance <= nearest + 1e-15),
            ContactState::Overlapping => assert!(e.distance < 0.0),
            ContactState::Touching => unreachable!("not by chance"),
        }
        let twice = |s: &Shape| Shape {
            points: s.points.iter().map(|p| p.map(|x| 2.0 * x)).collect(),
            ..s.clone()
        };
        let shift = |p: &Pose| Pose {
            t: p.t.map(|x| 2.0 * x),
            ..*p
        };
        assert_eq!(
            ask(&twice(&a), shift(&pa), &twice(&b), shift(&pb)),
            (e.state, 2.0 * e.distance)
        );
    }
    assert!(seen[0] > 10 && seen[2] > 10, "both classes met: {seen:?}");
}

#[test]
fn distance_of_a_point_from_a_body() {
    let unit = shapes::cuboid([0.5; 3]);
    let at = |p| distance_to_body(p, body(&unit), &Pose::shift([10.0, 0.0, 0.0]));
    assert_eq!(at([10.0, 0.0, 0.0]), 0.0);
    assert_eq!(at([10.5, 0.5, 0.5]), 0.0);
    let above = 0.5 + 2f64.powi(-53); // the next double after 0.5
    assert_eq!(at([10.5, 0.5, above]), 2f64.powi(-53), "one bit off the corner");
    assert_eq!(at([10.5, 0.0, 1.5]), 1.0);
    assert_eq!(at([13.5, 4.5, 0.0]), 5.0);
}
