//! Contacts by convex patches: no ghosts on inner edges, normals of the mesh, names that last.

use super::{mesh, relative};
use lab::Pose;
use lab::pose::{quat, quat_mul, scale, unit_quat};
use lab::rng::Rng;
use lab::soups::{self, Soup};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{Composite, ContactPatches, ManifoldOptions, PatchContacts, PatchTracker, Piece};

fn patches(soup: &Soup) -> ContactPatches {
    ContactPatches::of_mesh(&mesh(soup)).unwrap()
}

fn within(prediction: f64) -> ManifoldOptions {
    ManifoldOptions::within(prediction)
}

/// The greatest distance of a contact's points from the surfaces, by brute force.
fn off_surface(soup: &Soup, point: [f64; 3]) -> f64 {
    let there = Soup {
        points: vec![
            point,
            [point[0] + 1e-9, point[1], point[2]],
            [point[0], point[1] + 1e-9, point[2]],
        ],
        triangles: vec![[0, 1, 2]],
    };
    lab::brute::distance(soup, &there, &Pose::IDENTITY).0
}

#[test]
fn convex_bodies_and_flat_regions_are_one_patch() {
    assert_eq!(patches(&soups::plate(8, [1.0, 0.5, 0.1])).count(), 1);
    assert_eq!(patches(&soups::sphere(2)).count(), 1);
    let torus = soups::torus(24, 12, 0.3);
    let found = patches(&torus);
    let mut seen: Vec<u32> = (0..found.count() as u32).flat_map(|p| found.triangles(p)).collect();
    seen.sort_unstable();
    assert_eq!(seen, (0..torus.triangles.len() as u32).collect::<Vec<_>>());
    assert!(found.count() < torus.triangles.len() / 2, "{}", found.count());
}

#[test]
fn a_plate_on_a_plate_has_four_contacts_apart_and_shallow() {
    let plate = soups::plate(12, [1.0, 1.0, 0.05]);
    let p = patches(&plate);
    let mut tracker = PatchTracker::new();
    let mut names = Vec::new();
    for (k, gap) in [4e-3, 1e-9, 0.0, -4e-3, -4e-3].into_iter().enumerate() {
        let pose = Pose {
            q: quat([0.0, 0.0, 1.0], 0.3),
            t: [0.2, 0.1, 0.1 + gap],
        };
        let found = tracker.contacts(&p, &p, &relative(&pose), &within(0.01)).to_vec();
        assert_eq!(found.len(), 1, "{gap} {found:?}");
        assert_eq!(found[0].contacts.len(), 4, "{gap} {found:?}");
        assert!((*found[0].normal - Vector3::z()).norm() < 1e-9, "{gap} {found:?}");
        for c in &found[0].contacts {
            assert!((c.point.separation - gap).abs() < 1e-12, "{gap} {c:?}");
        }
        let mut now: Vec<_> = found[0]
            .contacts
            .iter()
            .map(|c| (c.patches, c.point.id.to_string()))
            .collect();
        now.sort();
        if k > 0 {
            assert_eq!(names, now, "{gap}");
        }
        names = now;
    }
}

/// Every contact on both surfaces, every normal one of the allowed ones.
fn check(found: &[PatchContacts], (a, b): (&Soup, &Soup), normals: &[Vector3<f64>]) -> usize {
    for group in found {
        let best = normals.iter().map(|n| n.dot(&group.normal)).fold(-1.0, f64::max);
        assert!(best > 0.999, "{group:?}");
        for c in &group.contacts {
            assert!(off_surface(a, c.point.point_on_a.into()) < 1e-8, "{c:?}");
            assert!(off_surface(b, c.point.point_on_b.into()) < 1e-8, "{c:?}");
        }
    }
    found.iter().map(|g| g.contacts.len()).sum()
}

#[test]
fn a_body_that_slides_over_inner_edges_feels_none() {
    // A floor with walls seen from inside: a room cut out of a block, as an open surface.
    let room = soups::plate(10, [2.0, 2.0, 1.0]).flipped();
    let cube = soups::plate(2, [0.3, 0.2, 0.25]);
    let (r, c) = (patches(&room), patches(&cube));
    assert_eq!(r.count(), 6);
    let mut rng = Rng::new(3);
    let mut tracker = PatchTracker::new();
    let (mut contacts, mut cornered) = (0, 0);
    for k in 0..300 {
        let angle = 0.02 * f64::from(k);
        let depth = rng.range(-2e-3, 2e-3);
        let spin = quat([0.0, 0.0, 1.0], if k < 200 { angle } else { 0.0 });
        let t = match k {
            0..200 => [1.2 * angle.sin(), 1.2 * (1.3 * angle).cos(), -0.75 + depth],
            _ => [1.7 + depth, 0.01 * f64::from(k - 250), -0.75 + depth],
        };
        let found = tracker.contacts(&r, &c, &relative(&Pose { q: spin, t }), &within(5e-3));
        let normals = [Vector3::z(), -Vector3::x()];
        contacts += check(found, (&room, &cube), &normals[..if k < 200 { 1 } else { 2 }]);
        assert_eq!(found.len(), if k < 200 { 1 } else { 2 }, "{k} {found:?}");
        assert!(found.iter().all(|g| g.contacts.len() == 4), "{k} {found:?}");
        cornered += usize::from(found.len() == 2);
    }
    assert!(contacts > 1000 && cornered == 100, "{contacts} {cornered}");
}

#[test]
fn contacts_of_tumbling_bodies_lie_on_both_and_their_normals_are_the_meshes_own() {
    let shapes = [
        soups::torus(20, 10, 0.3),
        soups::gear(8),
        soups::bracket(),
        soups::rock(1, 3),
    ];
    let parts: Vec<_> = shapes.iter().map(patches).collect();
    let mut rng = Rng::new(9);
    let (mut found_any, mut none) = (0, 0);
    for k in 0..60 {
        let (i, j) = (rng.below(4), rng.below(4));
        let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
        let (m, n) = (mesh(&shapes[i]), mesh(&shapes[j]));
        let mut tracker = PatchTracker::new();
        for frame in 0..6 {
            q = unit_quat(quat_mul(quat(axis, 0.01), q));
            let mut pose = Pose { q, t: scale(at, 2.6) };
            for _ in 0..20 {
                let d = lin_canny::MeshTracker::new().distance(&m, &n, &relative(&pose)).value;
                pose.t = scale(pose.t, 1.0 - (d - 0.002).max(0.0) * 0.5 / lab::pose::norm(pose.t));
            }
            let truth = lin_canny::MeshTracker::new().closest(&m, &n, &relative(&pose));
            let found = tracker.contacts(&parts[i], &parts[j], &relative(&pose), &within(0.01));
            let count: usize = found.iter().map(|g| g.contacts.len()).sum();
            for c in found.iter().flat_map(|g| &g.contacts) {
                assert!(
                    off_surface(&shapes[i], c.point.point_on_a.into()) < 1e-8,
                    "{k} {frame} {c:?}"
                );
                assert!(
                    off_surface(&shapes[j], c.point.point_on_b.into()) < 1e-8,
                    "{k} {frame} {c:?}"
                );
                assert!(c.point.separation >= truth.lower - 1e-12, "{k} {frame} {c:?} {truth:?}");
            }
            // The closest pair of all is among the contacts.
            let deepest = found.iter().flat_map(|g| &g.contacts).map(|c| c.point.separation);
            let deepest = deepest.fold(f64::INFINITY, f64::min);
            if truth.distance < 0.01 && truth.distance > 1e-4 {
                assert!(
                    (deepest - truth.distance).abs() < 1e-9,
                    "{k} {frame} {deepest} {truth:?} {found:?}"
                );
            }
            found_any += usize::from(count > 0);
            none += usize::from(count == 0);
        }
    }
    assert!(found_any > 250, "{found_any} {none}");
}

#[test]
fn pieces_bear_contacts_as_they_are() {
    let beam = solids::cuboid(Vector3::new(1.0, 0.1, 0.1)).unwrap();
    let mut post = Piece::new(solids::cuboid(Vector3::new(0.1, 0.1, 0.5)).unwrap());
    post.pose.translation.vector.z = 0.6;
    let body = Composite::new(vec![Piece::new(beam), post]).unwrap();
    let p = ContactPatches::of_pieces(&body).unwrap();
    let floor = ContactPatches::of_pieces(&Composite::from(
        lin_canny::Shape::cuboid(Vector3::new(3.0, 3.0, 1.0)).unwrap(),
    ))
    .unwrap();
    let found = PatchTracker::new()
        .contacts(&floor, &p, &relative(&Pose::shift([0.0, 0.0, 1.099])), &within(1e-3))
        .to_vec();
    assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
    assert!(
        found[0]
            .contacts
            .iter()
            .all(|c| c.patches == [0, 0] && (c.point.separation + 1e-3).abs() < 1e-12)
    );
}
