//! Certified segments in rooms full of hulls.

use crate::judge::{first_contact, meet, replay};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::surface::BezierSurface;
use lin_canny::{Compound, Mesh, Piece, Shape, Tracker};
use lin_canny_plan::{
    Cell, CellBody, Checker, ConfigurationSpace, JointMotion, PlanError, RigidSpace, TranslationSpace, Verdict,
};
use truth::plans::{Ask, Furnish, blocked, cuboid};
use truth::rng::Rng;
use truth::rooms::Room;

/// What was seen of some segments.
#[derive(Debug, Default)]
struct Tally {
    free: u32,
    blocked: u32,
    unknown: u32,
    /// Distance queries of free segments.
    queries: u64,
}

/// Judges random segments of a room: free ones by dense predicates and, now and then, by their
/// certificates; blocked ones by the contact at `t` and by predicates up to `safe`.
fn judge(n: usize, segments: u64, steps: usize) -> Tally {
    let room = Room::new(n, 1);
    let robot = [room.robot.clone()];
    let mut checker = Checker::new(room.space(), room.cell()).expect("a room");
    let mut tally = Tally::default();
    for k in 0..segments {
        let [from, to] = room.segment(&mut Rng::of_case(7, k));
        let ends = [&from, &to];
        let [p, q] = ends.map(RigidSpace::configuration);
        let before = checker.work();
        let verdict = checker.verdict_of(&JointMotion::segment(&p, &q));
        match verdict {
            Verdict::Free { .. } => {
                tally.free += 1;
                tally.queries += checker.work().queries - before.queries;
                let contact = first_contact(&robot, &room.hulls, ends, 1.0, steps);
                assert_eq!(contact, None, "segment {k} of {n} hulls");
                if k % 16 == 0 {
                    let proofs = crate::prove(&mut checker, &JointMotion::segment(&p, &q))
                        .expect("a segment")
                        .expect("a free segment");
                    replay(&proofs, &room.robot, &room.hulls, ends);
                }
            }
            Verdict::Blocked {
                free_until: safe,
                contact_at: t,
                pair,
                ..
            } => {
                tally.blocked += 1;
                let CellBody::Obstacle(obstacle) = pair.b else {
                    panic!("{pair:?}")
                };
                // At the pose that the segment places, not at nalgebra's.
                let motion = lin_canny::motion::Steady::between(&from, &to, 1.0, Point3::origin()).expect("a motion");
                let body = (room.robot.clone(), lin_canny::motion::Motion::pose(&motion, t));
                assert!(
                    meet(&mut Tracker::new(), &body, &room.hulls[obstacle]),
                    "segment {k}: {verdict:?}"
                );
                if safe > 0.0 {
                    let contact = first_contact(&robot, &room.hulls, ends, safe * (1.0 - 1e-9), steps / 4);
                    assert_eq!(contact, None, "segment {k} of {n} hulls: {verdict:?}");
                    assert!(t - safe < 1e-3, "{verdict:?}");
                }
            }
            _ => tally.unknown += 1,
        }
        let found = checker.is_free(&JointMotion::segment(&p, &q)).expect("a segment");
        assert_eq!(found, verdict.is_free());
    }
    tally
}

#[test]
fn segments_of_small_crowds_are_judged_right() {
    for (n, segments) in [(40, 400), (150, 250)] {
        let tally = judge(n, segments, 200);
        println!("{n} hulls: {tally:?}");
        assert!(tally.free > 60 && tally.blocked > 40 && tally.unknown == 0, "{tally:?}");
        assert!(tally.queries <= 7 * u64::from(tally.free), "{tally:?}");
    }
}

#[test]
#[ignore = "minutes: ten thousand segments, a thousand places each"]
fn ten_thousand_segments_are_judged_right() {
    for n in [40, 150] {
        let tally = judge(n, 10_000, 1000);
        println!("{n} hulls: {tally:?}");
        assert!(tally.unknown == 0, "{tally:?}");
        assert!(tally.queries <= 7 * u64::from(tally.free), "{tally:?}");
    }
}

/// Splines that bulge from the chord by no more than the radius of a free tube meet no obstacle; a
/// tube wider than the clearance is not free.
#[test]
fn splines_within_a_tube_are_free() {
    let mut cell = Cell::new();
    cell.robot_body("ball", Shape::ball(0.1).expect("a ball"));
    let block = cuboid([0.2, 0.2, 0.2]);
    let at = [[0.0, 0.7, 0.0], [0.0, -0.9, 0.1], [0.5, 0.1, 0.8], [-0.3, 0.2, -0.7]];
    for (k, [x, y, z]) in at.into_iter().enumerate() {
        cell.put(k, block.clone(), Isometry3::translation(x, y, z));
    }
    let space = TranslationSpace::new([[-2.0, 2.0]; 3], Default::default(), 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a checker");
    let (from, to) = ([-1.5, 0.0, 0.0], [1.5, 0.1, 0.0]);
    let clearance = checker
        .clearance_along(&JointMotion::segment(&from, &to), 1e-3)
        .expect("a segment")
        .lower;
    let mut rng = Rng::new(5);
    let (mut free, mut blocked) = (0, 0);
    for k in 0..200 {
        let radius = (0.01 * f64::from(k) + 0.005) * clearance;
        let verdict = checker.verdict_of(&JointMotion::segment(&from, &to).with_radius(radius).expect("a motion"));
        assert_eq!(checker.cell().margin(), 0.0);
        assert_eq!(
            verdict.is_free(),
            radius < clearance,
            "{radius} of {clearance}: {verdict:?}"
        );
        if !verdict.is_free() {
            blocked += 1;
            continue;
        }
        free += 1;
        // A quadratic spline whose middle is off the chord by the radius.
        let off = Vector3::from(rng.unit()) * radius;
        for i in 0..=100 {
            let t = 0.01 * f64::from(i);
            let q: Vec<f64> = (0..3)
                .map(|c| from[c] + t * (to[c] - from[c]) + 4.0 * t * (1.0 - t) * off[c])
                .collect();
            let near = checker.clearance(&q).expect("a configuration").expect("a pair");
            assert!(near.distance > 0.0, "{radius} {t} {near:?}");
        }
    }
    assert!(free >= 95 && blocked >= 95, "{free} {blocked}");
    for wrong in [-1.0, f64::NAN] {
        let found = JointMotion::segment(&from, &to).with_radius(wrong);
        assert!(
            matches!(found, Err(PlanError::Value { what: "radius", .. })),
            "{found:?}"
        );
    }
}

/// Steps of a length miss thin contacts that certificates find. The table of the issue is printed
/// by `race plan`.
#[test]
fn fixed_steps_miss_what_certificates_find() {
    let room = Room::new(150, 2);
    let robot = [room.robot.clone()];
    let mut checker = Checker::new(room.space(), room.cell()).expect("a room");
    let mut missed = [0; 2];
    let mut blocked = 0;
    for k in 0..1500 {
        let [from, to] = room.segment(&mut Rng::of_case(11, k));
        let [p, q] = [&from, &to].map(RigidSpace::configuration);
        if checker.is_free(&JointMotion::segment(&p, &q)).expect("a segment") {
            continue;
        }
        blocked += 1;
        for (missed, step) in missed.iter_mut().zip([0.2, 0.05]) {
            let steps = (checker.space().path_length(&[p.clone(), q.clone()]) / step).ceil() as usize;
            *missed += u32::from(first_contact(&robot, &room.hulls, [&from, &to], 1.0, steps).is_none());
        }
    }
    println!(
        "of {blocked} blocked segments, steps of 0.2 miss {}, of 0.05 {}",
        missed[0], missed[1]
    );
    assert!(missed[0] > 0 && missed[0] > missed[1], "{missed:?} of {blocked}");
}

/// The margin counts as contact, on both sides of it.
#[test]
fn margins_are_kept() {
    let mut cell = Cell::new();
    cell.robot_body("die", cuboid([0.5; 3]));
    cell.put("wall", cuboid([1.0, 3.0, 3.0]), Isometry3::translation(3.0, 0.0, 0.0));
    let space = TranslationSpace::new([[-5.0, 5.0]; 3], Default::default(), 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    // The faces are 0.25 apart on the way.
    let ends = [vec![1.25, -1.0, 0.0], vec![1.25, 1.0, 0.0]];
    for (margin, is_free) in [(0.0, true), (0.249, true), (0.251, false)] {
        checker.cell_mut().set_margin(margin).expect("a margin");
        let answer = checker
            .is_free(&JointMotion::segment(&ends[0], &ends[1]))
            .expect("a segment");
        assert_eq!(answer, is_free, "{margin}");
    }
    checker.cell_mut().set_margin(0.0).expect("a margin");
    let found = checker
        .clearance_along(&JointMotion::segment(&ends[0], &ends[1]), 0.01)
        .expect("a segment");
    assert!(found.lower <= 0.25, "{found:?}");
    assert!(found.lower > 0.247, "{found:?}");
    assert!((found.upper - 0.25).abs() < 1e-12, "{found:?}");
    // Towards the wall, past the middle: contact at x = 1.5.
    let verdict = checker.verdict_of(&JointMotion::segment(&[-1.0, 0.0, 0.0], &[4.0, 0.0, 0.0]));
    let Verdict::Blocked {
        free_until: safe,
        contact_at: t,
        witnesses,
        ..
    } = verdict
    else {
        panic!("{verdict:?}")
    };
    assert!(safe < 0.5 && 0.5 < t && t - safe < 1e-5, "{verdict:?}");
    assert!((witnesses[0].x - 2.0).abs() < 1e-5 && (witnesses[1].x - 2.0).abs() < 1e-12);
    assert!(checker.cell_mut().set_margin(f64::NAN).is_err());
}

/// The clearance among few and many obstacles, the robot near some, far from all, in contact, by
/// small steps and by jumps: that of the least pair of all, with all pairs within the slack. What
/// is looked at does not grow with the obstacles.
#[test]
fn clearances_are_those_of_all_pairs() {
    for n in [0, 1, 8, 300] {
        let room = Room::new(n, 3);
        let mut checker = Checker::new(room.space(), room.cell()).expect("a room");
        let mut rng = Rng::new(n as u64);
        let mut at = [0.0; 3];
        for k in 0..120 {
            let jump = rng.chance(0.3);
            at = std::array::from_fn(|i| {
                if jump {
                    rng.range(-6.0, 6.0)
                } else {
                    (at[i] + rng.range(-0.1, 0.1)).clamp(-6.0, 6.0)
                }
            });
            let pose = Isometry3::from_parts(Vector3::from(at).into(), truth::casts::rotation(&mut rng));
            let slack = *rng.pick(&[0.0, 0.0, 0.3, f64::INFINITY]);
            let near = checker
                .nearest(&RigidSpace::configuration(&pose), slack)
                .expect("a configuration");
            let each = room.hulls.iter().map(|(hull, other)| {
                let relative = lin_canny::RelativePose::new(&pose, other).expect("a pose");
                Tracker::new().distance(&room.robot, hull, &relative).value
            });
            let all: Vec<f64> = each.collect();
            let least = all.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(near.is_empty(), n == 0);
            for pair in near.iter().take(1) {
                assert!((pair.distance - least).abs() < 1e-12, "{k}: {} {least}", pair.distance);
            }
            let within = |slack: f64| all.iter().filter(|d| **d <= least + slack).count();
            let counts = [within(slack - 1e-12), within(slack + 1e-12)];
            assert!(
                n == 0 || (counts[0].max(1)..=counts[1]).contains(&near.len()),
                "{k}: {counts:?} {}",
                near.len()
            );
        }
    }
    // As dense, over ten times the side: as much to look at.
    let looked = [4, 40].map(|side| {
        let mut cell = Cell::new();
        cell.robot_body("ball", Shape::ball(0.3).expect("a ball"));
        for k in 0..side * side {
            let at = Vector3::new(f64::from(k % side), f64::from(k / side), 0.0);
            cell.put(
                k,
                Shape::ball(0.2).expect("a ball"),
                Isometry3::from_parts(at.into(), Default::default()),
            );
        }
        let space = TranslationSpace::new([[0.0, 40.0]; 3], Default::default(), 1).expect("a space");
        let mut checker = Checker::new(space, cell).expect("a world");
        for k in 0..100 {
            let q = [1.0 + 0.01 * f64::from(k), 1.5, 0.6];
            checker.clearance(&q).expect("a configuration");
        }
        checker.work().pairs
    });
    assert!(looked[1] < 2 * looked[0] + 1600, "{looked:?}");
}

/// A rod turns between two posts: only the middle of the turn is blocked.
#[test]
fn a_turn_is_more_than_its_ends() {
    let mut cell = Cell::new();
    cell.robot_body("rod", cuboid([1.0, 0.02, 0.02]));
    let post = cuboid([0.01; 3]);
    cell.put("post", post, Isometry3::translation(0.6, 0.6, 0.0));
    let space = RigidSpace::new([[-1.0, 1.0]; 3], 1.0, 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    let at = |angle: f64| RigidSpace::configuration(&Isometry3::rotation(Vector3::z() * angle));
    let verdict = checker.verdict_of(&JointMotion::segment(&at(0.0), &at(1.57)));
    let Verdict::Blocked { contact_at: t, .. } = verdict else {
        panic!("{verdict:?}")
    };
    assert!((t - 0.49).abs() < 0.02, "{t}");
    assert!(
        checker
            .is_free(&JointMotion::segment(&at(0.0), &at(0.7)))
            .expect("a segment")
    );
}

/// Obstacles of every kind of shape, judged by distance: a ball flies at each of them and past it.
#[test]
fn obstacles_of_every_kind() {
    let die = || cuboid([0.5; 3]);
    let kinds: Vec<(&str, lin_canny::Geometry)> = vec![
        ("polyhedron", die().into()),
        ("ball", Shape::ball(0.5).expect("a ball").into()),
        ("cone", Shape::cone(0.5, 0.5).expect("a cone").into()),
        (
            "compound",
            Compound::new(vec![Piece::new(die())]).expect("a piece").into(),
        ),
        ("mesh", Mesh::from_convex(&die()).expect("a mesh").into()),
    ];
    for (name, shape) in kinds {
        let mut cell = Cell::new();
        cell.robot_body("die", die());
        cell.put(name, shape, Isometry3::translation(0.0, 0.0, 0.0));
        let space = RigidSpace::new([[-9.0, 9.0]; 3], 0.9, 1).expect("a space");
        let mut checker = Checker::new(space, cell).expect("a world");
        let at = |x: f64, y: f64| RigidSpace::configuration(&Isometry3::translation(x, y, -0.1));
        let verdict = checker.verdict_of(&JointMotion::segment(&at(-3.0, 0.0), &at(3.0, 0.0)));
        let ([safe, t], _) = blocked(&verdict).expect(name);
        assert!((1.9 / 6.0..2.1 / 6.0).contains(&safe), "{name}: {verdict:?}");
        assert!(t - safe < 1e-3, "{name}: {verdict:?}");
        assert!(
            checker
                .is_free(&JointMotion::segment(&at(-3.0, 1.01), &at(3.0, 1.01)))
                .expect("a segment"),
            "{name}"
        );
    }
}

#[test]
fn bad_input_is_named() {
    let room = Room::new(3, 1);
    let mut checker = Checker::new(room.space(), room.cell()).expect("a room");
    let good = RigidSpace::configuration(&Isometry3::identity());
    let with = |k: usize, value: f64| {
        let mut q = good.clone();
        q[k] = value;
        q
    };
    let mut refused = |q: &[f64]| {
        checker
            .certify(&JointMotion::segment(&good, q))
            .expect_err("a bad configuration")
            .to_string()
    };
    assert!(refused(&good[..6]).contains("6 numbers (expected 7)"));
    assert!(refused(&with(1, f64::NAN)).contains("coordinate 1"));
    assert!(refused(&with(2, 99.0)).contains("99"));
    assert!(refused(&with(3, 0.1)).contains("quaternion"));
    assert!(RigidSpace::new([[1.0, 0.0]; 3], 1.0, 1).is_err());
    assert!(RigidSpace::new([[0.0, f64::INFINITY]; 3], 1.0, 1).is_err());
    assert!(RigidSpace::new([[0.0, 1.0]; 3], 0.0, 1).is_err());
    let two = RigidSpace::new([[0.0, 1.0]; 3], 1.0, 2).expect("a space");
    assert!(matches!(
        Checker::new(two, room.cell()).err(),
        Some(PlanError::Bodies { space: 2, cell: 1 })
    ));
    let mut cell = room.cell();
    assert_eq!(
        cell.exclude("robot", "nobody"),
        Err(PlanError::Unnamed {
            name: "nobody".into(),
            near: None
        })
    );
    cell.put(
        "bead",
        Mesh::from_convex(&room.robot).expect("a mesh"),
        Isometry3::identity(),
    );
    let mut round = Cell::new();
    round.robot_body("ball", Shape::ball(1.0).expect("a ball"));
    round.put(
        "bead",
        Mesh::from_convex(&room.robot).expect("a mesh"),
        Isometry3::identity(),
    );
    assert!(Checker::new(room.space(), round).is_ok());
    let mesh = Mesh::from_convex(&room.robot).expect("a mesh");
    let mut curved = Cell::new();
    let patches = BezierSurface::from_mesh(&mesh).expect("a surface");
    curved.robot_body("bracket", mesh);
    curved.put("dome", patches, Isometry3::identity());
    assert!(Checker::new(room.space(), curved).is_ok());
}
