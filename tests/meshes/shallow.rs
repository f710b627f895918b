//! Bodies that overlap slightly have a contact, for any thickness and any edges.

use super::contacts::{exact, is_normal, patches};
use super::{mesh, relative};
use lin_canny::{ContactState, ConvexPatches, Mesh, PairTracker};
use truth::Pose;
use truth::pose::{scale, sub};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Returns solids of all kinds, stretched by up to a hundred along each axis.
fn stretched(rng: &mut Rng) -> Vec<Soup> {
    let all = [
        soups::screw(2, 12),
        soups::gear(6),
        soups::bracket(),
        soups::torus(12, 8, 0.3),
    ];
    let stretch = |k: usize| {
        let by = [0; 3].map(|_| 10f64.powf(rng.range(-2.0, 0.0)));
        all[k % all.len()].clone().map(|p| [0, 1, 2].map(|i| p[i] * by[i]))
    };
    (0..24).map(stretch).collect()
}

/// Moves B along a direction from afar until the bodies touch, and deeper by up to 1/500 of their
/// size.
fn entered(a: &Mesh, b: &Mesh, size: f64, rng: &mut Rng) -> Pose {
    let (q, way) = (rng.quat(), rng.unit());
    let mut pose = Pose::new(q, scale(way, 4.0));
    let mut tracker = PairTracker::new();
    for _ in 0..60 {
        let gap = tracker.distance(a, b, &relative(&pose)).value;
        if gap < 1e-9 {
            break;
        }
        pose.t = sub(pose.t, scale(way, gap));
    }
    pose.t = sub(pose.t, scale(way, 0.002 * size * rng.range(0.1, 1.0)));
    pose
}

#[test]
fn thin_bodies_a_little_way_in_have_a_contact() {
    let mut rng = Rng::new(77);
    let shapes = stretched(&mut rng);
    let parts: Vec<ConvexPatches> = shapes.iter().map(patches).collect();
    let meshes: Vec<Mesh> = shapes.iter().map(mesh).collect();
    let (mut met, mut parted) = (0, 0);
    for k in 0..500 {
        let (i, j) = (rng.below(shapes.len()), rng.below(shapes.len()));
        let (a, b) = (&meshes[i], &meshes[j]);
        let pose = entered(a, b, shapes[i].radius() + shapes[j].radius(), &mut rng);
        let at = relative(&pose);
        if PairTracker::new().closest(a, b, &at).state != ContactState::Overlapping {
            continue;
        }
        met += 1;
        let found = PairTracker::new()
            .contacts_between(&parts[i], &parts[j], &at, &exact(0.0))
            .to_vec();
        assert!(!found.is_empty(), "{k}: {i} {j} {pose:?}");
        let turn = pose.isometry().rotation;
        for c in found.iter().flat_map(|g| &g.contacts) {
            let n = c.normal.into_inner();
            let on_a = is_normal(&shapes[i], c.point.point_on_a, n).0;
            let on_b = is_normal(&shapes[j], c.point.point_on_b, -(turn.inverse() * n)).0;
            assert!(on_a && on_b, "{k}: {i} {j} off the mesh {c:?}");
            let between = pose.isometry() * c.point.point_on_b - c.point.point_on_a;
            assert!(
                (between.dot(&n) - c.point.separation).abs() < 1e-12,
                "{k}: {i} {j} {c:?}"
            );
        }
        let deepest = found[0].contacts[0];
        let out = deepest.normal.into_inner() * (-1.001 * deepest.point.separation);
        let moved = pose.shifted(out.into());
        parted += usize::from(!PairTracker::new().intersects(a, b, &relative(&moved)));
    }
    // In most overlaps, moving B out along the deepest contact separates the bodies.
    assert!(met > 400 && parted * 100 > met * 99, "{met} {parted}");
}
