//! Bodies far from the origins of their frames: survey and plant coordinates.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ContactState, Mesh, PairTracker, RelativePose};
use truth::driven::{far, played};
use truth::forms::mesh;
use truth::soups;

/// Returns a box as a mesh.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let mesh = mesh(&soups::cuboid(low, high));
    assert!(mesh.volume() > 0.0);
    mesh
}

/// Two beams in line, flush or inset, at the coordinates of a survey: a gap and an overlap of a
/// millionth are found, as near the origin.
#[test]
fn beams_in_survey_coordinates_are_as_exact_as_at_the_origin() {
    let here = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    let size = 2.0 * 0.5 * Vector3::new(1000.0, 200.0, 3000.0).norm() + 1000.0;
    for far in [0.0, 1e7, 1e9, 1e12] {
        for inset in [0.0, 10.0] {
            for step in [-1e-3, -1e-4, -1e-6, 1e-6, 1e-4, 1e-3] {
                let corner = Vector3::new(far, 0.37 * far, -0.71 * far).map(f64::round);
                let at = |p: [f64; 3]| [0, 1, 2].map(|k| p[k] + corner[k]);
                let a = cuboid(at([0.0; 3]), at([1000.0, 200.0, 3000.0]));
                let b = cuboid(
                    at([1000.0 + step, inset, inset]),
                    at([2000.0, 200.0 - inset, 3000.0 - inset]),
                );
                let gap = b.aabb().0.x - a.aabb().1.x;
                let mut tracker = PairTracker::new();
                let found = tracker.closest(&a, &b, &here);
                let told = format!(
                    "{far:e} {inset} {step:e} {gap:e}: {:?} [{:e}, {:e}]",
                    found.state, found.lower, found.upper
                );
                assert_eq!(tracker.intersects(&a, &b, &here), gap <= 0.0, "{told}");
                if gap > 0.0 {
                    assert_eq!(found.state, ContactState::Separated, "{told}");
                    assert!(found.lower <= gap && gap <= found.upper, "{told}");
                    assert!(found.upper - found.lower <= 1e-13 * size, "{told}");
                } else if gap < 0.0 {
                    assert_eq!(found.state, ContactState::Overlapping, "{told}");
                    let depth = tracker.penetration(&a, &b, &here).unwrap();
                    assert!(depth.lower <= -gap && -gap <= depth.upper, "{told} {depth:?}");
                    assert!(depth.upper - depth.lower <= 1e-12 * size, "{told} {depth:?}");
                } else {
                    assert_eq!(found.state, ContactState::Touching, "{told}");
                }
            }
        }
    }
}

/// A mesh that moves far away by its vertices is as exact there as a new one.
#[test]
fn vertices_that_move_far_away_stay_exact() {
    let here = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    let mut a = cuboid([0.0; 3], [1.0, 2.0, 3.0]);
    let mut b = cuboid([1.5, 0.0, 0.0], [2.5, 2.0, 3.0]);
    let (of_a, of_b) = (a.vertices(), b.vertices());
    let mut tracker = PairTracker::new();
    let mut steps = vec![0.0, 0.5, 3.0, 1e3, 1e9, 1e9 + 1.0, 1e9 + 1e3, 1e12, 10.0, 0.0];
    steps.extend((0..40).map(f64::from));
    for far in steps {
        let moved = |all: &[Point3<f64>]| all.iter().map(|p| p + Vector3::new(far, -far, 0.0)).collect::<Vec<_>>();
        a.set_vertices(&moved(&of_a)).unwrap();
        b.set_vertices(&moved(&of_b)[..4]).unwrap_err();
        b.set_vertices_from(0, &moved(&of_b)[..5]).unwrap();
        b.set_vertices_from(5, &moved(&of_b)[5..]).unwrap();
        assert_eq!((a.vertices(), b.vertices()), (moved(&of_a), moved(&of_b)));
        let gap = b.aabb().0.x - a.aabb().1.x;
        let found = tracker.closest(&a, &b, &here);
        assert!(found.lower <= gap && gap <= found.upper, "{far:e} {found:?}");
        assert!(found.upper - found.lower < 1e-12, "{far:e} {found:?}");
        let depth = a.volume();
        assert!((depth - 6.0).abs() < 1e-9, "{far:e} {depth}");
    }
}

#[test]
fn bodies_far_from_their_origins_are_as_exact_as_near() {
    let mix = played(0..1_000, far::play);
    assert!(mix.kinds.iter().chain(&mix.states).all(|n| *n > 20), "{mix:?}");
    assert!(
        mix.near > 200 && mix.depths > 100 && mix.contacts > 50 && mix.rays > 20 && mix.widest > 0.05,
        "{mix:?}"
    );
}

#[test]
#[ignore = "minutes: cargo test --release --locked --all-features --test meshes far_bodies -- --ignored --nocapture"]
fn a_hundred_thousand_far_bodies_are_as_exact_as_near() {
    println!("{:?}", played(1_000_000..1_100_000, far::play));
}
