//! Free or not at a single configuration: an arm of meshes in its cell.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Shape};
use lin_canny_plan::{Cell, Checker, ConfigurationSpace, JointMotion, JointTree, RigidSpace};
use truth::cells::ArmCell;
use truth::plans::{Ask, Furnish};
use truth::pose::Pose;
use truth::rng::Rng;
use truth::tally::tenth;
use truth::{brute, soups::Soup};

fn posed(pose: &Isometry3<f64>) -> Pose {
    let (q, t) = (pose.rotation.coords, pose.translation.vector);
    Pose::new([q.x, q.y, q.z, q.w], t.into())
}

/// Whether two solids share a point: all pairs of triangles, and a point of each in the other. `None` if rounding hides it.
fn meet((a, p): (&Soup, &Isometry3<f64>), (b, q): (&Soup, &Isometry3<f64>)) -> Option<bool> {
    if (q.translation.vector - p.translation.vector).norm() > a.radius() + b.radius() {
        return Some(false);
    }
    let at = posed(&(p.inverse() * q));
    let distance = brute::distance(a, b, &at).0;
    let is_inside = |s: &Soup, p| brute::winding(s, p).abs() > 0.5;
    match distance {
        0.0 => Some(true),
        d if d < 1e-12 => None,
        _ => Some(is_inside(a, at.apply(b.points[0])) || is_inside(b, at.apply_inverse(a.points[0]))),
    }
}

/// Whether a configuration is free, by brute force.
fn is_free(cell: &ArmCell, arm: &JointTree, q: &[f64]) -> Option<bool> {
    let mut poses = Vec::new();
    arm.place(q, &mut poses);
    for (i, link) in cell.links.iter().enumerate() {
        let obstacles = cell.obstacles.iter().enumerate().filter(|(k, _)| (i, *k) != (0, 0));
        let others = obstacles.map(|(_, (soup, pose))| (soup, pose));
        let own = (i + 1..cell.links.len()).filter(|&k| !ArmCell::is_excluded(i, k));
        for other in others.chain(own.map(|k| (&cell.links[k], &poses[k]))) {
            if meet((link, &poses[i]), other)? {
                return Some(false);
            }
        }
    }
    Some(true)
}

/// Compares warm and cold answers with brute force; returns how many configurations are free and how many are not.
fn judge(count: usize, seed: u64) -> [usize; 2] {
    let cell = ArmCell::new(5);
    let arm = cell.arm();
    let mut warm = Checker::new(cell.arm(), cell.cell()).expect("a cell");
    let (mut rng, mut tally, mut q) = (Rng::new(seed), [0; 2], Vec::new());
    for k in 0..count {
        // Every other configuration is near the last one.
        q = match k % 2 {
            0 => ArmCell::sample(&mut rng),
            _ => arm.moved(&q, &[0; 6].map(|_| rng.range(-0.02, 0.02))),
        };
        let Some(truth) = is_free(&cell, &arm, &q) else {
            continue;
        };
        assert_eq!(warm.is_free_at(&q).expect("a configuration"), truth, "{k} {q:?}");
        if k % 16 == 0 {
            let mut cold = Checker::new(cell.arm(), cell.cell()).expect("a cell");
            assert_eq!(cold.is_free_at(&q).expect("a configuration"), truth, "{k} {q:?}");
        }
        tally[usize::from(truth)] += 1;
    }
    let work = warm.work();
    assert_eq!((work.queries, work.measures), (0, 0), "{work:?}");
    tally
}

#[test]
fn free_or_not_equals_brute_force() {
    let count = tenth(1_500);
    let tally = judge(count, 31);
    assert!(tally.iter().all(|n| *n > count / 5), "{tally:?}");
}

#[test]
#[ignore = "a hundred thousand configurations"]
fn free_or_not_equals_brute_force_a_hundred_thousand_times() {
    let tally = judge(100_000, 32);
    assert!(tally.iter().all(|n| *n > 20_000), "{tally:?}");
}

#[test]
fn a_margin_makes_configurations_blocked_that_are_nearer() {
    let cell = ArmCell::new(8);
    let mut checker = Checker::new(cell.arm(), cell.cell()).expect("a cell");
    let (mut rng, mut tally) = (Rng::new(33), [0; 2]);
    for _ in 0..200 {
        let q = ArmCell::sample(&mut rng);
        let near = checker.clearance(&q).expect("a configuration").expect("a pair");
        if !(near.lower > 0.0) {
            continue;
        }
        for (part, is_free) in [(0.999, true), (1.001, false)] {
            checker.cell_mut().set_margin(near.distance * part).expect("a margin");
            assert_eq!(checker.is_free_at(&q).expect("a configuration"), is_free, "{near:?}");
            let found = checker.is_free(&JointMotion::segment(&q, &q)).expect("a configuration");
            assert_eq!(found, is_free, "{near:?}");
            tally[usize::from(is_free)] += 1;
        }
        checker.cell_mut().set_margin(0.0).expect("a margin");
    }
    assert!(tally[0] > 20, "{tally:?}");
}

#[test]
fn a_configuration_of_another_space_is_refused() {
    let cell = ArmCell::new(5);
    let mut checker = Checker::new(cell.arm(), cell.cell()).expect("a cell");
    assert!(checker.is_free_at(&[0.0; 5]).is_err());
    assert!(checker.is_free_at(&[f64::NAN; 6]).is_err());
}

#[test]
fn a_segment_that_ends_in_contact_takes_no_distance() {
    let cell = ArmCell::new(5);
    let arm = cell.arm();
    let mut checker = Checker::new(cell.arm(), cell.cell()).expect("a cell");
    let (mut rng, mut tally) = (Rng::new(34), [0; 3]);
    for _ in 0..60 {
        let from = ArmCell::sample(&mut rng);
        let to = arm.moved(&from, &[0; 6].map(|_| rng.range(-0.2, 0.2)));
        let ends = [&from, &to].map(|q| checker.is_free_at(q).expect("a configuration"));
        let before = checker.work();
        let is_free = checker.is_free(&JointMotion::segment(&from, &to)).expect("a segment");
        let spent = checker.work().queries - before.queries;
        assert_eq!(checker.work().segments, before.segments + 1);
        assert_eq!(checker.is_free_along(&JointMotion::segment(&from, &to)), is_free);
        assert!(ends[1] || spent == 0, "{spent} queries");
        tally[if is_free { 0 } else { 1 + usize::from(ends[1]) }] += 1;
    }
    assert!(tally[0] > 10 && tally[1] > 10, "{tally:?}");
}

/// A tip that a bounding ball touches, of an obstacle far from its own origin, at poses whose quaternions are off unit
/// length by all that is accepted: a ball that reaches into the tip is not free.
#[test]
fn tips_of_obstacles_at_poses_off_unit_length_are_met() {
    let (far, radius) = (1e3, 1e-3);
    let tips = [1.0, -1.0].map(|s| [0, 1, 2].map(|k| Vector3::from_fn(|i, _| if i == k { s } else { 0.0 })));
    let tips = tips
        .concat()
        .iter()
        .map(|v| Point3::from(v + Vector3::x() * far))
        .collect::<Vec<_>>();
    let body = ConvexPolyhedron::from_points(&tips).expect("an octahedron");
    for length in [1.0 + 4.9e-13, 1.0 - 4.9e-13, 1.0] {
        let q = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2);
        let pose = Isometry3::from_parts(
            Vector3::zeros().into(),
            UnitQuaternion::new_unchecked(q.into_inner() * length),
        );
        let mut cell = Cell::new();
        cell.robot_body("probe", Shape::ball(radius).expect("a ball"));
        cell.put("octahedron", body.clone(), pose);
        let space = RigidSpace::new([[-2e3, 2e3]; 3], 1.0, 1).expect("a space");
        let mut checker = Checker::new(space, cell).expect("a world");
        for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            for (depth, is_free) in [(4e-10, false), (-4e-10, true)] {
                let out = 1.0 + radius - depth;
                let q = RigidSpace::configuration(&Isometry3::translation(x * out, far + y * out, 0.0));
                let told = checker.is_free_at(&q).expect("a configuration");
                assert_eq!(told, is_free, "{length} {x} {y}");
                let clearance = checker.clearance(&q).expect("a configuration").expect("a pair");
                assert!(clearance.lower <= -depth + 1e-11, "{clearance:?}");
                assert!(-depth <= clearance.upper + 1e-11, "{clearance:?}");
            }
        }
    }
}
