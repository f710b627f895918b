//! Promise: queries of meshes equal brute force over all pairs of triangles, independent of earlier
//! queries of the tracker.

mod ahead;
mod bending;
mod bent_kinds;
mod bumps;
mod contact_state;
mod contacts;
mod contain;
mod copies;
mod corners;
mod crossing;
mod crowds;
mod decomposition;
mod far;
mod faults;
mod frames;
mod hard;
mod judged;
mod kept;
mod long;
mod many;
mod mixed_depth;
mod near;
mod own;
mod penetration;
mod pieces;
mod points;
mod repair;
mod shallow;
mod shapes;
mod sheets;
mod slivers;
mod slots;
mod solids;
mod valleys;
mod volume;

use lin_canny::{ContactState, Mesh, MeshKind, PairTracker, RelativePose};
pub(crate) use truth::forms::mesh;
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

pub(crate) fn relative(pose: &Pose) -> RelativePose {
    RelativePose::from_isometry(&pose.isometry()).unwrap()
}

/// Returns L of a pair.
pub(crate) fn size(a: &Soup, b: &Soup, pose: &Pose) -> f64 {
    a.radius() + b.radius() + truth::pose::norm(pose.t)
}

/// Returns closed meshes of a few hundred triangles.
pub(crate) fn shapes() -> Vec<Soup> {
    vec![
        soups::torus(24, 12, 0.3),
        soups::knot(60, 8, 0.12),
        soups::rock(3, 1),
        soups::gear(12),
        soups::bracket(),
        soups::screw(4, 24),
        soups::plate(3, [1.0, 0.5, 0.1]),
    ]
}

/// Compares a query with brute force; returns its contact state.
pub(crate) fn judge(
    tracker: &mut PairTracker,
    soups: (&Soup, &Soup),
    meshes: (&Mesh, &Mesh),
    pose: &Pose,
) -> ContactState {
    judge_by_surfaces(tracker, soups, meshes, pose).0
}

/// Compares a query with brute force; returns its contact state and the distance of the surfaces.
pub(crate) fn judge_by_surfaces(
    tracker: &mut PairTracker,
    (a, b): (&Soup, &Soup),
    (m, n): (&Mesh, &Mesh),
    pose: &Pose,
) -> (ContactState, f64) {
    let truth = brute::distance(a, b, pose).0;
    let found = tracker.closest(m, n, &relative(pose));
    let noise = 1e-14 * size(a, b, pose);
    match found.state {
        ContactState::Separated => {
            assert!((found.distance - truth).abs() < noise, "{found:?} {truth}");
            assert!(found.lower <= truth + noise, "{found:?} {truth}");
            assert!(truth <= found.upper + noise, "{found:?} {truth}");
            assert!(found.upper - found.lower < 1e-13 * size(a, b, pose), "{found:?}");
            let on_b = pose.apply(found.point_on_b.into());
            let apart = truth::pose::norm(truth::pose::sub(on_b, found.point_on_a.into()));
            assert!((apart - truth).abs() < noise, "{found:?} {apart}");
        }
        ContactState::Touching => assert!(found.lower == 0.0 && truth < noise, "{found:?} {truth}"),
        ContactState::Overlapping => {
            let inside = |s: &Soup, p| brute::winding(s, p).abs() > 0.5;
            let contained = inside(a, pose.apply(b.points[0])) || inside(b, pose.apply_inverse(a.points[0]));
            assert!(found.distance == 0.0, "{found:?} {truth}");
            assert!((truth == 0.0 || contained), "{found:?} {truth}");
        }
        _ => panic!("{found:?}"),
    }
    if truth > noise {
        let separated = found.state == ContactState::Separated;
        assert_eq!(tracker.intersects(m, n, &relative(pose)), !separated);
        if separated {
            assert!(tracker.within(m, n, &relative(pose), found.upper));
            assert!(!tracker.within(m, n, &relative(pose), truth * (1.0 - 1e-9) - noise));
            let bound = tracker.lower_bound(m, n, &relative(pose));
            assert!(bound <= truth + noise, "{bound} {truth}");
        }
    }
    (found.state, truth)
}

#[test]
fn made_meshes_are_solids() {
    for (k, soup) in shapes().iter().enumerate() {
        let m = mesh(soup);
        assert_eq!(m.kind(), MeshKind::Solid, "{k}: {}", m.report());
        assert!(m.report().parts.iter().all(|p| p.volume > 0.0), "{k}: {}", m.report());
        let n = mesh(&soup.unwelded());
        assert_eq!((n.vertex_count(), n.kind()), (m.vertex_count(), MeshKind::Solid));
    }
}

#[test]
fn random_poses_equal_brute_force() {
    let shapes = shapes();
    let meshes: Vec<Mesh> = shapes.iter().map(mesh).collect();
    let mut rng = Rng::new(5);
    let mut tally = [0; 2];
    for k in 0..2000 {
        let (i, j) = (rng.below(7), rng.below(7));
        let pose = Pose::new(rng.quat(), rng.unit().map(|x| x * rng.range(0.1, 3.0)));
        let state = judge(
            &mut PairTracker::new(),
            (&shapes[i], &shapes[j]),
            (&meshes[i], &meshes[j]),
            &pose,
        );
        tally[usize::from(state == ContactState::Separated)] += 1;
        if k % 4 == 0 {
            // Swapped: the same contact state, and the same distance within the bounds.
            let back = PairTracker::new().closest(&meshes[j], &meshes[i], &relative(&pose).swapped());
            assert_eq!(back.state, state);
        }
    }
    assert!(tally.iter().all(|t| *t > 400), "{tally:?}");
}
