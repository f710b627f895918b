//! Compounds of convex pieces against all pairs of pieces, at identity and other poses, tracked and
//! cold.

use super::{mesh, relative};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, CompoundError, ContactState, PairTracker, Piece};
use truth::pose::{quat, quat_mul, scale, unit_quat};
use truth::rng::Rng;
use truth::soups::Soup;
use truth::support::piece_at;
use truth::{Pose, brute};

/// Returns boxes and hulls strung along a path.
fn chain(count: usize, in_place: bool, seed: u64) -> Compound {
    let mut rng = Rng::new(seed);
    let pieces = (0..count).map(|k| {
        let at = scale(rng.in_ball(), 1.0);
        let size = Vector3::new(rng.range(0.05, 0.3), rng.range(0.05, 0.3), rng.range(0.05, 0.3));
        let shape = solids::random_hull(12, size, seed + k as u64).unwrap();
        let pose = Pose::new(rng.quat(), at);
        let mut piece = if in_place {
            let points: Vec<_> = shape.vertex_points().map(|p| pose.isometry() * p).collect();
            Piece::new(lin_canny::ConvexPolyhedron::from_points(&points).unwrap())
        } else {
            piece_at(pose.isometry(), shape)
        };
        piece.name = format!("piece {k}");
        piece
    });
    Compound::new(pieces.collect()).unwrap()
}

pub(crate) fn soup(body: &Compound) -> Soup {
    let mut soup = Soup::default();
    for (_, corners) in body.to_mesh().unwrap().triangles() {
        let base = soup.points.len() as u32;
        soup.points.extend(corners.map(|p| [p.x, p.y, p.z]));
        soup.triangles.push([base, base + 1, base + 2]);
    }
    soup
}

#[test]
fn pieces_equal_brute_force() {
    let mut rng = Rng::new(31);
    let mut tally = [0; 2];
    for k in 0..40u64 {
        let (a, b) = (chain(9, k % 2 == 0, k), chain(7, k % 4 < 2, 100 + k));
        let (s, t) = (soup(&a), soup(&b));
        let (m, n) = (mesh(&s), mesh(&t));
        let (mut tracker, mut meshes, mut back) = (PairTracker::new(), PairTracker::new(), PairTracker::new());
        let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
        for frame in 0..40 {
            q = unit_quat(quat_mul(quat(axis, 0.009), q));
            let pose = Pose::new(q, scale(at, 1.1 + 0.6 * (0.16 * f64::from(frame)).sin()));
            let truth = brute::distance(&s, &t, &pose).0;
            let found = tracker.closest(&a, &b, &relative(&pose));
            let other = meshes.closest(&m, &n, &relative(&pose));
            assert_eq!(found.state, other.state, "{k} {frame} {found:?} {other:?}");
            assert_eq!(back.closest(&b, &a, &relative(&pose).swapped()).state, found.state);
            if found.state == ContactState::Separated {
                assert!((found.distance - truth).abs() < 1e-13, "{k} {frame} {found:?} {truth}");
                assert!(found.lower <= truth + 1e-15, "{found:?} {truth}");
                assert!(truth <= found.upper + 1e-15, "{found:?} {truth}");
                assert!(!tracker.within(&a, &b, &relative(&pose), truth - 1e-12));
                assert!(tracker.within(&a, &b, &relative(&pose), truth + 1e-12));
                let on_b = pose.apply(found.point_on_b.into());
                let apart = truth::pose::norm(truth::pose::sub(on_b, found.point_on_a.into()));
                assert!((apart - truth).abs() < 1e-13);
            }
            let answer = tracker.intersects(&a, &b, &relative(&pose));
            assert_eq!(answer, found.state != ContactState::Separated);
            tally[usize::from(found.state == ContactState::Separated)] += 1;
        }
        let w = tracker.work();
        assert!(w.trees.measured < 40 * w.trees.queries, "{w:?}");
    }
    assert!(tally.iter().all(|t| *t > 200), "{tally:?}");
}

#[test]
fn mass_of_pieces_is_that_of_their_mesh() {
    let one = solids::cuboid(Vector3::new(1.0, 0.5, 0.25)).unwrap();
    let pose = Pose::new(Rng::new(4).quat(), [3.0, -1.0, 0.5]);
    let far = piece_at(pose.isometry(), one.clone());
    let body = Compound::new(vec![Piece::new(one), far]).unwrap();
    let m = body.to_mesh().unwrap();
    let mass = body.mass().unwrap();
    assert!((mass.volume - 2.0).abs() < 1e-14 && (m.volume() - 2.0).abs() < 1e-13);
    assert!((mass.centroid - m.centroid()).norm() < 1e-13);
    let off = (mass.inertia - m.inertia()).norm();
    assert!(off < 1e-12, "{} {}", mass.inertia, m.inertia());
    assert_eq!(Compound::new(vec![]).unwrap_err(), CompoundError::Count { count: 0 });
}
