//! Promise: bounds of the volume that two solids share hold the exact value for every tie, and are narrow.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{
    Cloud, CloudElement, Compound, Geometry, GeometryKind, HalfSpace, Mesh, Operand, OverlapError, PairTracker, Piece,
    RelativePose, Shape, polyhedron::solids,
};
use truth::driven::overlaps::{self, FAMILIES};
use truth::driven::played;
use truth::soups::{self, Soup};
use truth::tally::tenth;
use truth::{Pose, rng::Rng};

use crate::{mesh, relative};

fn closed_forms(seeds: std::ops::Range<u64>) {
    let n = seeds.end - seeds.start;
    let mix = played(seeds, overlaps::play);
    println!("{mix:?}");
    assert!(mix.families[..6].iter().all(|count| *count > n / 9), "{mix:?}");
    assert!(mix.shared.iter().all(|count| *count > n / 9), "{mix:?}");
    assert!(mix.forms[2] > n / 9, "{mix:?}");
}

fn rationals(seeds: std::ops::Range<u64>) {
    let n = seeds.end - seeds.start;
    let mix = played(seeds, overlaps::play_exactly);
    println!("{mix:?}");
    if n < 100 {
        return;
    }
    assert!(mix.families[6..FAMILIES].iter().all(|count| *count > n / 9), "{mix:?}");
    assert!(mix.shared[0] > n / 2 && mix.shared[1] > 0, "{mix:?}");
    assert!(mix.forms[1] > n / 9, "{mix:?}");
}

#[test]
fn volumes_of_lattice_bodies_are_closed_forms() {
    closed_forms(0..tenth(10_000) as u64);
}

#[test]
#[ignore = "23 minutes: 1,000,000 pairs; cargo test --release --all-features --test meshes a_million_lattice -- --ignored --nocapture"]
fn volumes_of_a_million_lattice_bodies_are_closed_forms() {
    closed_forms(1_000_000..2_000_000);
}

#[test]
fn volumes_of_meshes_are_those_of_rationals() {
    rationals(0..tenth(100) as u64);
}

#[test]
#[ignore = "more than 24 minutes, never run to its end: 10,000 pairs; cargo test --release --all-features --test meshes ten_thousand_meshes_are -- --ignored --nocapture"]
fn volumes_of_ten_thousand_meshes_are_those_of_rationals() {
    rationals(10_000..20_000);
}

/// Returns the bounds of the volume that two meshes share.
fn overlap(a: &Mesh, b: &Mesh, pose: &RelativePose) -> (f64, f64) {
    let found = PairTracker::new().overlap(a, b, pose).expect("two solids");
    assert!(found.lower <= found.upper, "{found:?}");
    (found.lower, found.upper)
}

#[test]
fn volumes_of_meshes_of_lattice_points_are_those_of_rationals() {
    let mut rng = Rng::new(16);
    for _ in 0..200 {
        let data: Vec<u8> = (0..34).map(|_| rng.below(256) as u8).collect();
        if let Err(why) = overlaps::play_bytes(&data) {
            panic!("{why}");
        }
    }
}

#[test]
fn tiles_of_space_add_up_to_the_body() {
    let mut rng = Rng::new(106);
    for soup in [soups::torus(24, 12, 0.3), soups::gear(12), soups::screw(2, 12)] {
        for k in [2, 3] {
            let turn = Pose {
                q: rng.quat(),
                t: [0.0; 3],
            };
            let body = mesh(&soup.clone().moved(&turn));
            let at = |i: usize| -4.0 + 8.0 * i as f64 / k as f64;
            let (mut lower, mut upper) = (0.0, 0.0);
            for c in 0..k * k * k {
                let [x, y, z] = [c % k, c / k % k, c / k / k];
                let tile =
                    truth::driven::slots::union_of(&[[[at(x), at(y), at(z)], [at(x + 1), at(y + 1), at(z + 1)]]], 1);
                let part = overlap(
                    &body,
                    &mesh(&tile),
                    &RelativePose::from_isometry(&Isometry3::identity()).unwrap(),
                );
                (lower, upper) = (lower + part.0, upper + part.1);
            }
            let whole = body.volume_bounds();
            assert!(
                lower <= whole.1 + 1e-15 && whole.0 <= upper + 1e-15,
                "{lower} {upper} {whole:?}"
            );
            assert!(upper - lower < 1e-12 * whole.1, "{lower} {upper}");
        }
    }
}

#[test]
fn a_body_shares_its_volume_with_its_equal_at_any_pose() {
    let mut rng = Rng::new(7);
    for soup in crate::shapes() {
        let body = mesh(&soup);
        let (low, high) = body.volume_bounds();
        assert!(
            high - low < 1e-14 * high && low <= body.volume() * (1.0 + 1e-12) && body.volume() <= high * (1.0 + 1e-12)
        );
        let pose = Pose {
            q: rng.quat(),
            t: rng.in_ball(),
        }
        .isometry();
        for same in [Isometry3::identity(), pose] {
            let shared = overlap(&body, &body, &RelativePose::new(&same, &same).unwrap());
            assert!(shared.0 <= high && low <= shared.1, "{shared:?} {low} {high}");
            assert!(shared.1 - shared.0 < 1e-13 * high, "{shared:?}");
        }
    }
}

#[test]
fn powers_of_two_scale_volumes_exactly() {
    let mut rng = Rng::new(9);
    let scaled = |soup: &Soup, by: f64| mesh(&soup.clone().map(|p| p.map(|x| x * by)));
    for _ in 0..20 {
        let (a, b) = (soups::torus(9, 6, 0.4), soups::gear(7));
        let pose = Pose {
            q: rng.quat(),
            t: rng.in_ball(),
        };
        let plain = overlap(&mesh(&a), &mesh(&b), &relative(&pose));
        for k in [-331, -40, 3, 100, 330] {
            let by = 2f64.powi(k);
            let found = overlap(&scaled(&a, by), &scaled(&b, by), &relative(&pose.scaled(by)));
            assert_eq!(found, (plain.0 * by * by * by, plain.1 * by * by * by), "{k}");
        }
    }
}

#[test]
fn flush_bodies_share_exactly_nothing_or_all() {
    let die = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let die = Mesh::from_convex(&die).unwrap();
    for (x, y) in [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (-1.0, 0.5)] {
        let pose = RelativePose::from_isometry(&Isometry3::translation(x, y, 0.0)).unwrap();
        let truth = (1.0f64 - x.abs()) * (1.0 - y.abs());
        let (lower, upper) = overlap(&die, &die, &pose);
        assert!(
            lower <= truth && truth <= upper && upper - lower < 1e-15,
            "{lower} {upper}"
        );
    }
}

#[test]
fn bodies_without_a_known_volume_are_refused_by_name() {
    let at = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    let die = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let mut tracker = PairTracker::new();
    let mut refused = |a: &Geometry, b: &Geometry| tracker.overlap(a, b, &at).expect_err("no volume");
    let solid = Geometry::from(die.clone());
    let kind = |body, kind| OverlapError::Kind { body, kind };
    let ball = Geometry::from(Shape::ball(1.0).unwrap());
    assert_eq!(refused(&ball, &solid), kind(Operand::A, GeometryKind::Rounded));
    let can = Geometry::from(Shape::cylinder(1.0, 1.0).unwrap());
    assert_eq!(refused(&solid, &can), kind(Operand::B, GeometryKind::Curved));
    let floor = Geometry::from(HalfSpace::new(Vector3::z(), 0.0).unwrap());
    assert_eq!(refused(&solid, &floor), kind(Operand::B, GeometryKind::HalfSpace));
    let points = Cloud::new(&[Point3::origin()], CloudElement::Ball(1.0)).unwrap();
    assert_eq!(refused(&points.into(), &solid), kind(Operand::A, GeometryKind::Cloud));
    let cube = Mesh::from_convex(&die).unwrap();
    let open = Mesh::new(&cube.vertices(), &cube.triangle_vertices()[1..]).unwrap();
    assert_eq!(refused(&open.into(), &solid), OverlapError::Open { body: Operand::A });
    let piece = |x: f64| Piece {
        pose: Isometry3::translation(x, 0.0, 0.0),
        ..Piece::new(die.clone())
    };
    let deep = Compound::new(vec![piece(0.0), piece(3.0), piece(0.5)]).unwrap();
    let pieces = [0, 2];
    let body = Operand::B;
    assert_eq!(refused(&solid, &deep.into()), OverlapError::Pieces { body, pieces });
    let round = Piece::new(Shape::ball(1.0).unwrap());
    let mixed = Compound::new(vec![piece(5.0), round]).unwrap();
    assert_eq!(refused(&solid, &mixed.into()), OverlapError::Piece { body, piece: 1 });
}

#[test]
fn a_mesh_that_covers_itself_is_reported_wherever_its_copies_are() {
    let at = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    let cube = |h: f64| solids::cuboid(Vector3::repeat(h)).unwrap();
    let twice = |h: f64| {
        let body = Mesh::from_convex(&cube(h)).unwrap();
        let (points, triangles) = (body.vertices(), body.triangle_vertices());
        let moved = points.iter().map(|p| p + Vector3::new(0.25 * h, 0.0, 0.0));
        let more = triangles.iter().map(|t| t.map(|v| v + points.len() as u32));
        let all: Vec<_> = points.iter().copied().chain(moved).collect();
        Mesh::new(&all, &[&triangles[..], &more.collect::<Vec<_>>()].concat()).unwrap()
    };
    for (h, volume) in [(0.5, 2.0), (8.0, 16.0)] {
        let found = PairTracker::new().overlap(&twice(h), &cube(1.0), &at).unwrap();
        assert!(found.covers_itself, "{found:?}");
        assert!(found.lower <= volume && volume <= found.upper, "{found:?}");
    }
    let body = Mesh::from_convex(&cube(1.0)).unwrap();
    let flipped: Vec<_> = body.triangle_vertices().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let inward = Mesh::new(&body.vertices(), &flipped).unwrap();
    let found = PairTracker::new().overlap(&inward, &cube(2.0), &at).unwrap();
    assert!(
        found.covers_itself && found.lower <= -8.0 && -8.0 <= found.upper,
        "{found:?}"
    );
}

#[test]
fn loops_are_closed_and_shares_add_up() {
    let mut rng = Rng::new(3);
    let mut curves = 0;
    for _ in 0..50 {
        let (a, b) = (mesh(&soups::torus(12, 8, 0.4)), mesh(&soups::gear(9)));
        let pose = relative(&Pose {
            q: rng.quat(),
            t: rng.in_ball(),
        });
        let mut tracker = PairTracker::new();
        let found = tracker.overlap_loops(&a, &b, &pose).unwrap();
        let volume = tracker.overlap(&a, &b, &pose).unwrap();
        assert_eq!(found.loops.is_empty(), volume.upper <= 0.0, "{volume:?}");
        curves += found.loops.len();
        for curve in &found.loops {
            assert!(curve.len() > 2);
        }
        // Each face inside is at most the face.
        for (shares, body) in found.shares.iter().zip([&a, &b]) {
            let area = |t: u32| {
                let [p, q, r] = body.triangles().find(|x| x.0 == t).unwrap().1;
                0.5 * (q - p).cross(&(r - p)).norm()
            };
            for share in shares {
                assert!(
                    share.area > -1e-14 && share.area <= area(share.face) + 1e-14,
                    "{share:?}"
                );
            }
        }
    }
    assert!(curves > 50, "{curves}");
}
