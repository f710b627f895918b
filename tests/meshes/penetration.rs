//! Bounds of the penetration depth: convex meshes against the depth of the bodies, other meshes
//! against shifts by brute force.

use super::{mesh, relative, shapes};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ContactState, Mesh, PairTracker, PenetrationBounds, Piece, RelativePose, Shape, Tracker};
use truth::Pose;
use truth::pose::{add, scale, unit_quat};
use truth::rng::Rng;
use truth::soups;

fn shifted(pose: &Pose, by: Vector3<f64>) -> RelativePose {
    relative(&Pose {
        t: add(pose.t, by.into()),
        ..*pose
    })
}

#[test]
fn convex_meshes_have_the_depth_of_their_bodies_between_the_bounds() {
    let bodies = [
        solids::cuboid(Vector3::new(0.5, 0.7, 0.3)).unwrap(),
        solids::geodesic_sphere(2, 0.6).unwrap(),
        solids::random_hull(40, Vector3::new(0.6, 0.5, 0.4), 3).unwrap(),
    ];
    let meshes: Vec<_> = bodies.iter().map(|b| Mesh::from_convex(b).unwrap()).collect();
    let pieces: Vec<_> = bodies.iter().map(|b| Compound::from(Shape::from(b.clone()))).collect();
    let mut rng = Rng::new(2);
    let (mut met, mut close) = (0, 0);
    for _ in 0..40 {
        let (i, j) = (rng.below(3), rng.below(3));
        let pose = Pose {
            q: rng.quat(),
            t: scale(rng.unit(), rng.range(0.2, 1.0)),
        };
        let at = relative(&pose);
        let truth = Tracker::new().closest(&bodies[i], &bodies[j], &at);
        let found = PairTracker::new().penetration(&meshes[i], &meshes[j], &at).unwrap();
        let whole = PairTracker::new().penetration(&pieces[i], &pieces[j], &at).unwrap();
        if truth.state != ContactState::Overlapping {
            assert_eq!((found.lower, found.upper), (0.0, 0.0));
            continue;
        }
        met += 1;
        for o in [found, whole] {
            assert!(
                o.lower <= -truth.distance + 1e-12 && -truth.distance <= o.upper + 1e-12,
                "{o:?} {truth:?}"
            );
            assert!(
                o.upper <= -truth.distance * (1.0 + 2e-3) + 1e-9,
                "the hulls are the bodies: {o:?} {truth:?}"
            );
        }
        assert!(
            whole.lower >= -truth.distance - 1e-9,
            "the piece is the body: {whole:?} {truth:?}"
        );
        close += usize::from(found.lower > -0.5 * truth.distance);
    }
    assert!(met > 20 && close > 10, "{met} {close}");
}

/// Asserts that the shift separates the bodies, and that shifts shorter than the lower bound never
/// do.
fn check(found: &PenetrationBounds, pose: &Pose, rng: &mut Rng, mut state: impl FnMut(&RelativePose) -> ContactState) {
    assert!(0.0 <= found.lower && found.lower <= found.upper, "{found:?}");
    assert!(
        (found.shift.norm() - found.upper).abs() <= 1e-12 * found.upper,
        "{found:?}"
    );
    assert_eq!(state(&shifted(pose, found.shift)), ContactState::Separated, "{found:?}");
    for _ in 0..20 {
        let by = Vector3::from(rng.unit()) * (found.lower * 0.999);
        assert_eq!(state(&shifted(pose, by)), ContactState::Overlapping, "{found:?} {by}");
    }
}

#[test]
fn bounds_of_meshes_hold_and_meet_for_shallow_overlaps() {
    let shapes = shapes();
    let meshes: Vec<_> = shapes.iter().map(mesh).collect();
    let mut rng = Rng::new(8);
    let (mut met, mut tight) = (0, 0);
    for k in 0..24 {
        let (i, j) = (k % 3, rng.below(3));
        let (m, n) = (&meshes[i], &meshes[j]);
        let at = rng.unit();
        let mut pose = Pose {
            q: unit_quat(rng.quat()),
            t: scale(at, 2.6),
        };
        for _ in 0..20 {
            let d = PairTracker::new().distance(m, n, &relative(&pose)).value;
            pose.t = add(pose.t, scale(at, -d));
        }
        pose.t = add(pose.t, scale(at, -[0.02, 0.1][k % 2]));
        let found = PairTracker::new().penetration(m, n, &relative(&pose)).unwrap();
        if found.upper == 0.0 {
            continue;
        }
        met += 1;
        tight += usize::from(found.lower > 0.5 * found.upper);
        check(&found, &pose, &mut rng, |p| PairTracker::new().closest(m, n, p).state);
        let back = PairTracker::new()
            .penetration(n, m, &relative(&pose).swapped())
            .unwrap();
        assert!(
            back.lower <= found.upper + 1e-12 && found.lower <= back.upper + 1e-12,
            "{found:?} {back:?}"
        );
    }
    assert!(met > 15 && tight > 5, "{met} {tight}");
}

#[test]
fn bounds_of_pieces_hold_and_surfaces_have_none() {
    let beam = |x: f64, turn: f64| Piece {
        pose: lin_canny::nalgebra::Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * turn),
        ..Piece::new(Shape::cuboid(Vector3::new(0.8, 0.15, 0.2)).unwrap())
    };
    let cross = Compound::new(vec![beam(0.0, 0.0), beam(0.1, 1.4), beam(-0.5, 0.7)]).unwrap();
    let round = Compound::new(vec![beam(0.0, 0.3), Piece::new(Shape::cylinder(0.5, 0.3).unwrap())]).unwrap();
    let mut rng = Rng::new(4);
    let mut met = 0;
    for k in 0..20 {
        let body = if k % 2 == 0 { &cross } else { &round };
        let pose = Pose {
            q: rng.quat(),
            t: scale(rng.unit(), rng.range(0.3, 1.0)),
        };
        let found = PairTracker::new().penetration(&cross, body, &relative(&pose)).unwrap();
        if found.upper > 0.0 {
            met += 1;
            check(&found, &pose, &mut rng, |p| {
                PairTracker::new().closest(&cross, body, p).state
            });
        }
    }
    assert!(met > 8, "{met}");
    let mut open = soups::sphere(1);
    open.triangles.pop();
    let (solid, surface) = (mesh(&soups::sphere(1)), mesh(&open));
    let at = relative(&Pose::shift([0.5, 0.0, 0.0]));
    assert_eq!(PairTracker::new().penetration(&solid, &surface, &at), None);
}
