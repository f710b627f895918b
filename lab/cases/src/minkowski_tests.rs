//! The naive oracle judges contact state and distance; exact checks judge normals and witnesses.

use super::*;
use crate::bound::{support_gap, witness_distance};
use crate::exact;
use crate::rng::Rng;
use crate::shapes::{self, Shape};

fn judge(a: &Shape, pose_a: &Pose, b: &Shape, pose_b: &Pose) -> ContactState {
    let (a, b) = (Body::from(a), Body::from(b));
    let ours = solve(a, pose_a, b, pose_b);
    let naive = exact::solve(a, pose_a, b, pose_b);
    assert_eq!(
        (ours.state, ours.distance, ours.remainder),
        (naive.state, naive.distance, naive.remainder)
    );
    let size = ours.size.unwrap();
    // Witness points are rounded in the world.
    let size = size + norm(pose_a.t);
    let near = |x: f64, y: f64| (x - y).abs() <= 4e-16 * size;
    let gap = support_gap(a, pose_a, b, pose_b, ours.normal.unwrap());
    assert!(near(gap, ours.distance), "normal: {gap} for {}", ours.distance);
    let (wa, wb) = ours.witnesses.unwrap();
    let apart = witness_distance(wa, &Pose::IDENTITY, wb, &Pose::IDENTITY);
    assert!(
        near(apart, ours.distance.abs()),
        "witnesses: {apart} for {}",
        ours.distance
    );
    for (point, body, pose) in [(wa, a, pose_a), (wb, b, pose_b)] {
        assert!(exact::distance_to_body(point, body, pose) <= 4e-16 * size);
    }
    ours.state
}

#[test]
fn small_bodies_are_answered_as_by_the_naive_oracle() {
    let mut r = Rng::new(1);
    let mut seen = [0; 3];
    for k in 0..150 {
        let (a, b) = (shapes::small(&mut r), shapes::small(&mut r));
        let pose_a = Pose {
            q: r.quat(),
            t: scale(r.unit(), [0.0, 1.0, 1e6][k % 3]),
        };
        let apart = r.range(0.0, 3.0) * [1.0, 1e-9][usize::from(k % 7 == 0)];
        let pose_b = Pose {
            q: if k % 4 == 0 { pose_a.q } else { r.quat() },
            t: add(pose_a.t, scale(r.unit(), apart)),
        };
        seen[judge(&a, &pose_a, &b, &pose_b) as usize] += 1;
    }
    assert!(seen[0] > 20 && seen[2] > 20, "{seen:?}");
}

#[test]
fn bodies_on_a_lattice_touch_and_tie() {
    let mut r = Rng::new(2);
    let mut seen = [0; 3];
    let mut ties = 0;
    while seen.iter().sum::<i32>() < 100 {
        let [a, b] = [(); 2].map(|()| shapes::lattice(&mut r, 10, 1).solved());
        if a.faces.is_empty() || b.faces.is_empty() {
            continue;
        }
        let pose_b = Pose::shift([(); 3].map(|()| r.int(-2, 2) as f64));
        seen[judge(&a, &Pose::IDENTITY, &b, &pose_b) as usize] += 1;
        ties += usize::from(solve((&a).into(), &Pose::IDENTITY, (&b).into(), &pose_b).ties > Some(1));
    }
    assert!(seen.iter().all(|n| *n > 5) && ties > 2, "{seen:?} {ties}");
}

#[test]
fn equal_cubes_have_six_nearest_faces() {
    let cube = shapes::cube();
    let truth = solve((&cube).into(), &Pose::IDENTITY, (&cube).into(), &Pose::IDENTITY);
    assert_eq!((truth.distance, truth.ties), (-2.0, Some(6)));
}

#[test]
fn a_flat_body_touches_what_it_crosses_only_in_its_plane() {
    let square = Shape::hull(
        "square",
        vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
    );
    let cube = shapes::cube();
    let ask = |b: &Shape, t| {
        let truth = solve((&square).into(), &Pose::IDENTITY, b.into(), &Pose::shift(t));
        (truth.state, truth.distance)
    };
    assert_eq!(ask(&square, [0.5, 0.5, 0.0]), (ContactState::Touching, 0.0));
    assert_eq!(ask(&square, [0.5, 0.5, 0.25]), (ContactState::Separated, 0.25));
    assert_eq!(ask(&cube, [0.0, 0.0, 0.25]), (ContactState::Overlapping, -0.75));
    assert_eq!(ask(&cube, [0.0, 0.0, 1.0]), (ContactState::Touching, 0.0));
    let point = Shape::hull("point", vec![[0.0; 3]]);
    assert_eq!(ask(&point, [0.0, 0.0, -3.0]), (ContactState::Separated, 3.0));
    assert_eq!(ask(&point, [1.0, 1.0, 0.0]), (ContactState::Touching, 0.0));
}
