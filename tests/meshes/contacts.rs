//! Contacts by convex patches: no ghost contacts on inner edges, normals of the mesh, ids that
//! persist.

use super::{mesh, relative};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Compound, ContactGroup, ConvexPatches, ManifoldOptions, PairTracker, PatchContact, Piece, Shape};
use truth::Pose;
use truth::pose::{add, quat, quat_mul, scale, sub, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::support::piece_at;

pub(crate) fn patches(soup: &Soup) -> ConvexPatches {
    ConvexPatches::from_mesh(mesh(soup))
}

/// Returns the inside of a room without a ceiling, an open mesh.
fn room(n: usize, half: [f64; 3]) -> Soup {
    let mut room = soups::plate(n, half).flipped();
    room.triangles.truncate(10 * n * n);
    room
}

pub(crate) fn within(prediction: f64) -> ManifoldOptions {
    ManifoldOptions::default().prediction(prediction)
}

/// Returns options that choose points again for every motion.
pub(crate) fn exact(prediction: f64) -> ManifoldOptions {
    let mut options = within(prediction);
    options.rebuild_motion = 0.0;
    options
}

pub(crate) fn cuboid(half: [f64; 3]) -> ConvexPatches {
    ConvexPatches::from(Shape::cuboid(Vector3::from(half)).unwrap())
}

fn all(found: &[ContactGroup]) -> impl Iterator<Item = &PatchContact> {
    found.iter().flat_map(|g| &g.contacts)
}

pub(crate) fn deepest(found: &[ContactGroup]) -> f64 {
    all(found).map(|c| c.point.separation).fold(f64::INFINITY, f64::min)
}

/// Returns the triangles that contain a point within 1e-8, by brute force.
fn holding(soup: &Soup, p: Point3<f64>) -> Vec<[Vector3<f64>; 3]> {
    let near = |t: &[Vector3<f64>; 3]| {
        let [a, b, c] = *t;
        let n = (b - a).cross(&(c - a)).normalize();
        let foot = p.coords - n * n.dot(&(p.coords - a));
        let side = |s: Vector3<f64>, e: Vector3<f64>| (e - s).normalize().cross(&(foot - s)).dot(&n) > -1e-8;
        (p.coords - foot).norm() < 1e-8 && side(a, b) && side(b, c) && side(c, a)
    };
    let corners = (0..soup.triangles.len()).map(|t| soup.corners(t).map(Vector3::from));
    corners.filter(near).collect()
}

/// Returns whether a point lies on a mesh, and whether `n` is a normal of the mesh there.
///
/// A normal is that of a face, or such that no triangle around the point rises along it.
pub(crate) fn is_normal(soup: &Soup, p: Point3<f64>, n: Vector3<f64>) -> (bool, bool) {
    let about = holding(soup, p);
    let own = |t: &[Vector3<f64>; 3]| (t[1] - t[0]).cross(&(t[2] - t[0])).normalize();
    let of_face = about.iter().any(|t| (own(t) - n).norm() < 1e-6);
    let rises = |v: &Vector3<f64>| n.dot(&(v - p.coords)) > 1e-6 * (v - p.coords).norm() + 1e-8;
    let in_cone = !about.iter().flatten().any(rises) && about.iter().any(|t| own(t).dot(&n) > 0.0);
    (!about.is_empty(), of_face || in_cone)
}

/// Asserts that every contact is on the meshes, opposite each other along its normal.
///
/// Of every pair of patches, at least one contact must have a normal that is a normal of both
/// meshes.
pub(crate) fn check(found: &[ContactGroup], soups: [Option<&Soup>; 2], pose: &Pose, what: &str) {
    let turn = pose.isometry().rotation;
    for c in all(found) {
        let n = c.normal.into_inner();
        let between = pose.isometry() * c.point.point_on_b - c.point.point_on_a;
        assert!((between - n * c.point.separation).norm() < 1e-9, "{what} {c:?}");
        let places = [c.point.point_on_a, c.point.point_on_b];
        let normals = [n, -(turn.inverse() * n)];
        for k in 0..2 {
            let Some(soup) = soups[k] else { continue };
            assert!(
                is_normal(soup, places[k], normals[k]).0,
                "{what}: {k} off the mesh {c:?}"
            );
        }
    }
    for group in found {
        let c = group
            .contacts
            .iter()
            .min_by(|x, y| x.point.separation.total_cmp(&y.point.separation))
            .unwrap();
        let n = c.normal.into_inner();
        let level = c.point.separation + 1e-9;
        let places = |c: &PatchContact| [c.point.point_on_a, c.point.point_on_b];
        let normals = [n, -(turn.inverse() * n)];
        let fits = |c: &&PatchContact| {
            c.point.separation <= level
                && (0..2).all(|k| soups[k].is_none_or(|s| is_normal(s, places(c)[k], normals[k]).1))
        };
        assert!(group.contacts.iter().any(|c| fits(&c)), "{what}: ghost {group:?}");
    }
}

#[test]
fn convex_bodies_and_flat_regions_are_one_patch_turned_or_not() {
    let turn = Pose::new(unit_quat([0.3, 0.2, 0.5, 0.7]), [0.3, 7.0, -2.0]);
    for soup in [soups::plate(8, [1.0, 0.5, 0.1]), soups::sphere(2)] {
        assert_eq!(patches(&soup).count(), 1);
        assert_eq!(patches(&soup.moved(&turn)).count(), 1);
    }
    assert_eq!(patches(&room(4, [1.0, 0.5, 0.1]).moved(&turn)).count(), 5);
    // A closed mesh is a solid, also inside out.
    assert_eq!(patches(&soups::plate(4, [1.0, 0.5, 0.1]).flipped()).count(), 1);
    let torus = soups::torus(24, 12, 0.3);
    let found = patches(&torus);
    let mut seen: Vec<u32> = (0..found.count() as u32).flat_map(|p| found.triangles(p)).collect();
    seen.sort_unstable();
    assert_eq!(seen, (0..torus.triangles.len() as u32).collect::<Vec<_>>());
    assert!(found.count() < torus.triangles.len() / 2, "{}", found.count());
}

/// The tessellation has no effect: a plate of a thousand triangles has four contacts.
#[test]
fn a_plate_on_a_plate_has_four_contacts_whose_names_last() {
    let plate = soups::plate(12, [1.0, 1.0, 0.05]);
    let p = patches(&plate);
    let mut tracker = PairTracker::new();
    let mut names = Vec::new();
    for (k, gap) in [4e-3, 3e-3, 1e-9, 0.0, -3e-3, -4e-3, -4e-3].into_iter().enumerate() {
        let pose = Pose::new(quat([0.0, 0.0, 1.0], 0.3), [0.2, 0.1, 0.1 + gap]);
        let found = tracker
            .contacts_between(&p, &p, &relative(&pose), &within(0.01))
            .to_vec();
        assert_eq!((found.len(), all(&found).count()), (1, 4), "{gap} {found:?}");
        assert!((*found[0].normal - Vector3::z()).norm() < 1e-9, "{gap} {found:?}");
        assert!(
            all(&found).all(|c| (c.point.separation - gap).abs() < 1e-12),
            "{gap} {found:?}"
        );
        check(&found, [Some(&plate); 2], &pose, "plates");
        let mut now: Vec<_> = all(&found).map(|c| (c.patches, c.point.id.to_string())).collect();
        now.sort();
        assert!(k == 0 || names == now, "{gap} {names:?} {now:?}");
        names = now;
    }
}

#[test]
fn bodies_on_a_plate_have_a_few_contacts_upward() {
    let plate = soups::plate(8, [2.0, 2.0, 0.1]);
    let floor = patches(&plate);
    let on_its_side = quat([1.0, 0.0, 0.0], core::f64::consts::FRAC_PI_2);
    let bodies = [
        ("gear", soups::gear(12), unit_quat([0.0, 0.0, 0.0, 1.0]), 0.2, 4),
        (
            "torus",
            soups::torus(24, 12, 0.3),
            unit_quat([0.0, 0.0, 0.0, 1.0]),
            0.3,
            4,
        ),
        ("bracket", soups::bracket(), unit_quat([0.0, 0.0, 0.0, 1.0]), 0.3, 4),
        ("bracket on its side", soups::bracket(), on_its_side, 0.4, 4),
    ];
    for (name, soup, q, height, count) in bodies {
        let body = patches(&soup);
        for gap in [5e-3, 1e-9, -4e-3] {
            let pose = Pose::new(q, [0.1, 0.2, 0.1 + height + gap]);
            let found = PairTracker::new()
                .contacts_between(&floor, &body, &relative(&pose), &within(0.01))
                .to_vec();
            assert_eq!((found.len(), all(&found).count()), (1, count), "{name} {gap} {found:?}");
            let off = (*found[0].normal - Vector3::z()).norm();
            assert!(off < 1e-9, "{name} {gap} {found:?}");
            assert!((deepest(&found) - gap).abs() < 1e-12, "{name} {gap} {found:?}");
            check(&found, [Some(&plate), Some(&soup)], &pose, name);
            // The other order: the same contacts.
            let back = relative(&pose).swapped();
            let other = PairTracker::new()
                .contacts_between(&body, &floor, &back, &within(0.01))
                .to_vec();
            assert_eq!(all(&other).count(), count, "{name} {gap} {other:?}");
            assert!((deepest(&other) - gap).abs() < 1e-12, "{name} {gap} {other:?}");
        }
    }
}

#[test]
fn an_l_in_an_l_has_contacts_along_both_walls() {
    let l = soups::bracket();
    let p = patches(&l);
    let mut tracker = PairTracker::new();
    for gap in [4e-3, -4e-3] {
        // The back of one in the corner of the other.
        let pose = Pose::shift([0.3 + gap, 0.3 + gap, 0.1]);
        let found = tracker
            .contacts_between(&p, &p, &relative(&pose), &within(0.01))
            .to_vec();
        check(&found, [Some(&l); 2], &pose, "L in L");
        assert!((deepest(&found) - gap).abs() < 1e-12, "{found:?}");
        for axis in [Vector3::x(), Vector3::y()] {
            assert!(
                found.iter().any(|g| g.normal.dot(&axis) > 1.0 - 1e-9),
                "{gap} {axis} {found:?}"
            );
        }
    }
}

#[test]
fn an_l_on_an_l_and_a_finger_of_overlapping_parts_on_a_plate_rest_on_a_few_contacts() {
    let (l, plate) = (soups::bracket(), soups::plate(8, [2.0, 2.0, 0.1]));
    // Three closed components, each inside the next by a quarter, like the links of a modelled
    // hand; the tip points up.
    let link = soups::plate(2, [0.4, 0.15, 0.1]);
    let tip = Pose::new(quat([0.0, 1.0, 0.0], -0.5), [1.0, 0.0, 0.25]);
    let finger = link
        .clone()
        .with(&link.clone().map(|p| add(p, [0.6, 0.0, 0.0])))
        .with(&link.clone().moved(&tip));
    let cases = [
        ("L on L", &l, &l, [0.05, 0.02, 0.6]),
        ("finger on plate", &plate, &finger, [-0.4, 0.1, 0.2]),
    ];
    for (name, a, b, t) in cases {
        let (p, q) = (patches(a), patches(b));
        let mut tracker = PairTracker::new();
        for gap in [5e-3, 1e-9, -4e-3] {
            let pose = Pose::shift(add(t, [0.0, 0.0, gap]));
            let found = tracker
                .contacts_between(&p, &q, &relative(&pose), &within(0.01))
                .to_vec();
            check(&found, [Some(a), Some(b)], &pose, name);
            assert!((deepest(&found) - gap).abs() < 1e-12, "{name} {gap} {found:?}");
            let upward = |g: &&ContactGroup| (*g.normal - Vector3::z()).norm() < 1e-9;
            let up = found.iter().find(upward).expect("a contact upward");
            assert!((3..=4).contains(&up.contacts.len()), "{name} {gap} {found:?}");
            assert!(all(&found).count() <= 12, "{name} {gap} {found:?}");
        }
    }
}

/// A floor slides under a body for a thousand frames: the normal is that of the plane.
fn slide((floor, turn): (&ConvexPatches, &Pose), (body, lift, count): (&ConvexPatches, f64, usize), what: &str) {
    let up = Vector3::from(turn.rotate([0.0, 0.0, 1.0]));
    let mut rng = Rng::new(3);
    let mut tracker = PairTracker::new();
    for k in 0..1000 {
        let angle = 0.0171 * f64::from(k);
        let depth = rng.range(-2e-3, 2e-3);
        let at = [0.9 * angle.sin(), 0.9 * (1.3 * angle).cos(), lift + depth];
        let pose = Pose::new(
            unit_quat(quat_mul(turn.q, quat([0.0, 0.0, 1.0], angle))),
            turn.apply(at),
        );
        let found = tracker.contacts_between(floor, body, &relative(&pose), &within(5e-3));
        assert_eq!((found.len(), all(found).count()), (1, count), "{what} {k} {found:?}");
        assert!((deepest(found) - depth).abs() < 1e-9, "{what} {k} {depth} {found:?}");
        for c in all(found) {
            assert!((*c.normal - up).norm() < 1e-9, "{what} {k} {c:?}");
        }
    }
}

#[test]
fn a_body_that_slides_over_inner_edges_for_a_thousand_frames_feels_none() {
    // The floor is at -1.
    let room = room(10, [2.0, 2.0, 1.0]);
    let turned = Pose::new(unit_quat([0.3, 0.2, 0.5, 0.7]), [0.3, 0.2, -0.1]);
    let bracket = soups::bracket();
    for turn in [Pose::IDENTITY, turned] {
        let floor = patches(&room.clone().moved(&turn));
        slide((&floor, &turn), (&cuboid([0.3, 0.2, 0.25]), -0.75, 4), "box");
        slide((&floor, &turn), (&patches(&bracket), -0.7, 4), "bracket");
        slide(
            (&floor, &turn),
            (&ConvexPatches::from(Shape::ball(0.2).unwrap()), -0.8, 1),
            "ball",
        );
    }
    // A floor of tiles, each a piece.
    let tiles = (0..100).map(|k| {
        piece_at(
            Pose::shift([f64::from(k % 10) * 0.4 - 1.8, f64::from(k / 10) * 0.4 - 1.8, -1.1]).isometry(),
            Shape::cuboid(Vector3::new(0.2, 0.2, 0.1)).unwrap(),
        )
    });
    let floor = ConvexPatches::from_compound(Compound::new(tiles.collect()).unwrap());
    slide(
        (&floor, &Pose::IDENTITY),
        (&cuboid([0.3, 0.2, 0.25]), -0.75, 4),
        "box on tiles",
    );
    slide(
        (&floor, &Pose::IDENTITY),
        (&ConvexPatches::from(Shape::ball(0.2).unwrap()), -0.8, 1),
        "ball on tiles",
    );
}

#[test]
fn a_body_in_a_corner_has_both_walls_and_a_body_behind_a_wall_none() {
    let room = room(10, [2.0, 2.0, 1.0]);
    let (r, c) = (patches(&room), cuboid([0.3, 0.2, 0.25]));
    for k in 0..50 {
        let depth = 1e-4 * f64::from(k - 25);
        let pose = Pose::shift([1.7 + depth, 0.01 * f64::from(k), -0.75 - depth]);
        let found = PairTracker::new()
            .contacts_between(&r, &c, &relative(&pose), &within(5e-3))
            .to_vec();
        check(&found, [Some(&room), None], &pose, "corner");
        assert_eq!(found.len(), 2, "{k} {found:?}");
        assert!(found.iter().all(|g| g.contacts.len() == 4), "{k} {found:?}");
    }
    // A box below a thin shelf, inside the shelf's hull.
    let mut shelf = soups::plate(4, [1.0, 1.0, 0.02]);
    shelf = shelf.with(&soups::plate(4, [0.1, 0.1, 0.5]).map(|p| add(p, [0.0, 0.0, 0.6])));
    let p = patches(&shelf);
    let below = Pose::shift([0.7, 0.0, -0.02 - 0.25 - 0.02]);
    let found = PairTracker::new()
        .contacts_between(&p, &c, &relative(&below), &within(5e-3))
        .to_vec();
    assert_eq!(found, [], "{found:?}");
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
    let meshes: Vec<_> = shapes.iter().map(mesh).collect();
    let options = exact(0.01);
    let mut rng = Rng::new(9);
    let mut met = 0;
    for k in 0..60 {
        let (i, j) = (rng.below(4), rng.below(4));
        let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
        let (m, n) = (&meshes[i], &meshes[j]);
        let mut tracker = PairTracker::new();
        for frame in 0..4 {
            q = unit_quat(quat_mul(quat(axis, 0.01), q));
            let mut pose = Pose::new(q, scale(at, 2.6));
            for _ in 0..30 {
                let d = PairTracker::new().distance(m, n, &relative(&pose)).value;
                pose.t = sub(pose.t, scale(at, (d - 0.002).max(0.0)));
            }
            let truth = PairTracker::new().closest(m, n, &relative(&pose));
            let found = tracker
                .contacts_between(&parts[i], &parts[j], &relative(&pose), &options)
                .to_vec();
            check(
                &found,
                [Some(&shapes[i]), Some(&shapes[j])],
                &pose,
                &format!("{k} {frame} {i} {j}"),
            );
            if truth.distance < 0.01 {
                met += 1;
                let off = (deepest(&found) - truth.distance).abs();
                assert!(off < 1e-9, "{k} {frame} {truth:?} {found:?}");
            }
        }
    }
    assert!(met > 200, "{met}");
}

#[test]
fn pieces_bear_contacts_as_they_are() {
    let beam = Shape::cuboid(Vector3::new(1.0, 0.1, 0.1)).unwrap();
    let mut post = Piece::new(Shape::cylinder(0.1, 0.5).unwrap());
    post.pose.translation.vector.z = 0.6;
    let body = Compound::new(vec![Piece::new(beam), post]).unwrap();
    let p = ConvexPatches::from_compound(body);
    let floor = cuboid([3.0, 3.0, 1.0]);
    let pose = Pose::shift([0.0, 0.0, 1.099]);
    let found = PairTracker::new()
        .contacts_between(&floor, &p, &relative(&pose), &within(1e-3))
        .to_vec();
    assert_eq!((found.len(), all(&found).count()), (1, 4));
    assert!(all(&found).all(|c| c.patches == [0, 0] && (c.point.separation + 1e-3).abs() < 1e-12));
}

/// Two sheets of 128 triangles that face each other, with a prediction beyond the bodies: every
/// pair of triangles is queried, and the call ends soon.
#[test]
fn a_prediction_beyond_the_bodies_ends_in_time() {
    let mut rng = Rng::new(29);
    let sheet = |rng: &mut Rng| {
        let points = (0..81).map(|k| [f64::from(k / 9), f64::from(k % 9), rng.range(0.0, 1.0)]);
        let cells = (0..64).map(|k| k / 8 * 9 + k % 8);
        Soup::new(
            points.collect(),
            cells
                .flat_map(|k| [[k, k + 9, k + 1], [k + 1, k + 9, k + 10]])
                .collect(),
        )
    };
    let (a, b) = (mesh(&sheet(&mut rng)), mesh(&sheet(&mut rng)));
    let turned = relative(&Pose::new(quat([1.0, 0.0, 0.0], std::f64::consts::PI), [0.1, 8.0, 3.0]));
    let mut tracker = PairTracker::new();
    let nearest = tracker.closest(&a, &b, &turned);
    for prediction in [1e3, 1e300] {
        let began = cpu_time::ThreadTime::now();
        let found = tracker.contacts(&a, &b, &turned, &within(prediction)).unwrap();
        let spent = began.elapsed();
        println!("{prediction:e}: {} groups in {spent:?}", found.len());
        let deepest = deepest(found);
        assert!((deepest - nearest.distance).abs() <= 1e-12, "{deepest} {nearest:?}");
        // 0.2 s in release; a build with checks takes longer.
        assert!(spent < std::time::Duration::from_secs(5), "{spent:?}");
    }
}
