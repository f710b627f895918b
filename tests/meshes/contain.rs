//! Inside and outside: nested, linked, hollow and multi-component meshes, jumps through walls,
//! flush boxes that overlap.

use super::{mesh, relative};
use lin_canny::{ContactState, MeshKind, PairTracker};
use truth::pose::{quat, scale};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

#[test]
fn windings_decide_over_jumps() {
    // A hollow ball; a ball made of two overlapping components; a component in a component.
    let two = soups::sphere(2).with(&soups::sphere(2).map(|p| [p[0] + 0.7, p[1], p[2]]));
    let nested = soups::sphere(2).with(&soups::sphere(2).map(|p| scale(p, 0.5)));
    let solids = [
        soups::cave(3, 0.7),
        two,
        nested,
        soups::torus(40, 20, 0.3),
        soups::bracket(),
    ];
    let pebble = soups::sphere(1).map(|p| scale(p, 0.05));
    let small = mesh(&pebble);
    let mut rng = Rng::new(21);
    let (mut inside, mut outside) = (0, 0);
    for (k, solid) in solids.iter().enumerate() {
        let m = mesh(solid);
        assert_eq!(m.kind(), MeshKind::Solid);
        let (mut forward, mut backward) = (PairTracker::new(), PairTracker::new());
        for i in 0..500 {
            let pose = Pose::new(rng.quat(), scale(rng.in_ball(), 1.5));
            let truth = brute::distance(solid, &pebble, &pose).0;
            if truth < 1e-9 {
                continue;
            }
            let contained = brute::winding(solid, pose.apply(pebble.points[0])).abs() > 0.5;
            let state = if contained {
                ContactState::Overlapping
            } else {
                ContactState::Separated
            };
            let found = forward.closest(&m, &small, &relative(&pose));
            assert_eq!(found.state, state, "{k} {i} {found:?} {truth}");
            assert_eq!(backward.closest(&small, &m, &relative(&pose).swapped()).state, state);
            assert_eq!(forward.intersects(&m, &small, &relative(&pose)), contained);
            *if contained { &mut inside } else { &mut outside } += 1;
        }
    }
    assert!(inside > 200 && outside > 500, "{inside} {outside}");
}

#[test]
fn an_open_mesh_holds_nothing_and_may_be_held() {
    let mut open = soups::sphere(2);
    open.triangles.pop();
    let bowl = mesh(&open);
    assert_eq!(bowl.kind(), MeshKind::Open);
    let pebble = mesh(&soups::sphere(1).map(|p| scale(p, 0.05)));
    let found = PairTracker::new().closest(&bowl, &pebble, &relative(&Pose::IDENTITY));
    assert_eq!(found.state, ContactState::Separated);
    // An open mesh in a solid shares points with it.
    let ball = mesh(&soups::sphere(2).map(|p| scale(p, 3.0)));
    let found = PairTracker::new().closest(&ball, &bowl, &relative(&Pose::IDENTITY));
    assert_eq!((found.state, found.distance), (ContactState::Touching, 0.0));
}

#[test]
fn linked_rings_are_apart() {
    let ring = soups::torus(40, 20, 0.2);
    let m = mesh(&ring);
    let mut tracker = PairTracker::new();
    for k in 0..100 {
        let angle = 0.05 * f64::from(k);
        let q = truth::pose::quat_mul(quat([0.0, 0.0, 1.0], 0.1 * angle.sin()), quat([1.0, 0.0, 0.0], 1.5));
        let pose = Pose::new(q, [1.0 + 0.2 * angle.cos(), 0.0, 0.1 * angle.sin()]);
        let found = super::judge(&mut tracker, (&ring, &ring), (&m, &m), &pose);
        assert_eq!(found, ContactState::Separated);
    }
}

#[test]
fn boxes_with_coplanar_faces_overlap() {
    let cube = |n| soups::plate(n, [0.5, 0.5, 0.5]);
    for n in [1, 2, 3] {
        let (a, b): (Soup, Soup) = (cube(n), cube(n));
        let (m, k) = (mesh(&a), mesh(&b));
        for t in [[0.5, 0.0, 0.0], [0.25, 0.25, 0.0], [0.0, 0.0, 0.75]] {
            let found = PairTracker::new().closest(&m, &k, &relative(&Pose::shift(t)));
            assert_eq!(found.state, ContactState::Overlapping, "{n} {t:?}");
        }
        for t in [[1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0, 1.0, 0.25], [1.0, 1.0, 1.0]] {
            let mut tracker = PairTracker::new();
            let found = tracker.closest(&m, &k, &relative(&Pose::shift(t)));
            assert_eq!(found.state, ContactState::Touching, "{n} {t:?}");
            assert_eq!(found.distance, 0.0, "{n} {t:?}");
            assert!(tracker.intersects(&m, &k, &relative(&Pose::shift(t))));
            let beyond = t.map(|x| if x == 1.0 { 1.0 + 1e-15 } else { x });
            assert!(
                !PairTracker::new().intersects(&m, &k, &relative(&Pose::shift(beyond))),
                "{n} {t:?}"
            );
        }
    }
}

#[test]
fn crossings_and_nested_parts_are_named() {
    let ball = soups::sphere(2);
    assert!(mesh(&ball).inspect(10).crossings.is_empty());
    assert!(mesh(&soups::torus(40, 20, 0.3)).inspect(10).inner_parts.is_empty());
    let two = ball
        .clone()
        .with(&ball.clone().map(|p| [p[0] + 0.7, p[1] + 0.01, p[2] + 0.02]));
    let found = mesh(&two).inspect(10_000);
    // Every pair of triangles, each queried alone.
    let mut pairs = Vec::new();
    let half = ball.triangles.len();
    for i in 0..half {
        for j in half..2 * half {
            let (p, q) = (two.corners(i), two.corners(j));
            let one = |t: [truth::Point; 3]| Soup::new(t.to_vec(), vec![[0, 1, 2]]);
            if brute::distance(&one(p), &one(q), &Pose::IDENTITY).0 == 0.0 {
                pairs.push([i as u32, j as u32]);
            }
        }
    }
    assert!(pairs.len() > 30 && found.is_complete);
    assert_eq!(found.crossings, pairs);
    assert!(!mesh(&two).inspect(5).is_complete);
    let nested = ball.clone().with(&ball.clone().map(|p| scale(p, 0.5)));
    assert_eq!(mesh(&nested).inspect(10).inner_parts, [(1, 1)]);
}
