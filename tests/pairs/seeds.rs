//! Every pair of features as the start of a walk leads to the same contact state, and to bounds of
//! the same distance.

use lin_canny::{ContactState, Solver, Tracker};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support::{assert_right, between, body, pairs};
use truth::{Pose, exact};

/// Returns a corner of a thin plate: faces with an angle of `angle` radians at a vertex.
fn tip(angle: f64) -> Shape {
    let points = vec![[0.0; 3], [-1.0, angle, 0.0], [-1.0, -angle, 0.0], [-0.5, 0.0, -1.0]];
    Shape::hull(format!("tip {angle:e}"), points).solved()
}

fn small_bodies(rng: &mut Rng) -> Vec<Shape> {
    let mut all = vec![
        shapes::tetrahedron(),
        shapes::cube(),
        shapes::octahedron(),
        shapes::icosahedron(),
        tip(1e-6),
        tip(1e-12),
        tip(1e-16),
    ];
    all.extend((0..8).map(|_| shapes::small(rng)));
    all
}

/// Returns poses of every kind for a pair: separated, near, touching at the origin's planes, deep.
fn poses(rng: &mut Rng) -> Vec<(Pose, Pose)> {
    let at = |q, t| (Pose::IDENTITY, Pose::new(q, t));
    let upright = Pose::IDENTITY.q;
    vec![
        at(upright, [0.0, 0.0, 2.0]),
        at(upright, [1e-4, 0.0, 1e-5]),
        at(upright, [1.0, 1.0, 1.0]),
        at(upright, [0.0; 3]),
        at(truth::pose::quat([0.0, 0.0, 1.0], 1e-9), [0.3, 0.2, 2.0 + 1e-12]),
        at(rng.quat(), truth::pose::scale(rng.unit(), 2.5)),
        at(rng.quat(), truth::pose::scale(rng.unit(), 1.5)),
        (
            Pose::new(rng.quat(), rng.unit()),
            Pose::new(rng.quat(), [3.0, -1.0, 2.0]),
        ),
    ]
}

#[test]
fn every_pair_of_features_leads_to_the_same_answer() {
    let mut rng = Rng::new(11);
    let bodies = small_bodies(&mut rng);
    let (mut classes, mut walked, mut asked) = ([0; 3], 0u64, 0u64);
    for (i, sa) in bodies.iter().enumerate() {
        // Each body with itself and two others.
        for sb in [sa, &bodies[(i + 1) % bodies.len()], &bodies[(i + 5) % bodies.len()]] {
            let (a, b) = (body(sa), body(sb));
            for (k, (pa, pb)) in poses(&mut rng).into_iter().enumerate() {
                let truth = exact::solve(sa.into(), &pa, sb.into(), &pb);
                classes[truth.state as usize] += 1;
                let pose = between(&pa, &pb);
                for pair in pairs(&a, &b) {
                    let o = Tracker::with_features(pair, &a, &b).closest(&a, &b, &pose);
                    assert_right(
                        &o,
                        &truth,
                        &format!("{} beside {}, pose {k}, from {pair}", sa.name, sb.name),
                    );
                    walked += u64::from(matches!(o.solver, Solver::Walk) && o.state == ContactState::Separated);
                    asked += u64::from(o.state == ContactState::Separated);
                }
            }
        }
    }
    // The mix is complete: all contact states occur, and most starts are used.
    assert!(classes.iter().all(|&n| n > 5), "{classes:?}");
    assert!(walked * 10 > asked * 8, "{walked} of {asked}");
}

#[test]
fn beyond_the_tip_of_a_face_the_face_is_not_the_closest_feature() {
    // Above the plane of a face that ends in a vertex of 1e-12 radians, 1e-4 beyond the vertex:
    // within rounding of both side planes. As a point above the face, its distance would be 1e-5, a
    // tenth of the true distance.
    let (sa, sb) = (tip(1e-12), Shape::hull("point", vec![[1e-4, 0.0, 1e-5]]));
    let (a, b) = (body(&sa), body(&sb));
    let truth = exact::solve((&sa).into(), &Pose::IDENTITY, (&sb).into(), &Pose::IDENTITY);
    assert!(truth.distance > 1e-4);
    let pose = between(&Pose::IDENTITY, &Pose::IDENTITY);
    for pair in pairs(&a, &b) {
        let o = Tracker::with_features(pair, &a, &b).closest(&a, &b, &pose);
        assert_right(&o, &truth, &pair.to_string());
    }
}
