//! Curves: what is called free is free at every sampled time, what is called blocked is in contact at the time named. The
//! judge evaluates the curve by the sum of Bernstein polynomials, and decides configurations by predicates.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{
    Cell, CertifyOptions, Checker, ConfigurationSpace, Drive, Joint, JointCurve, JointKind, JointMotion, JointTree,
    JointTube, PlanError, PlanarSpace, RigidSpace, SegmentMotion, TranslationSpace, TreeJoint, Verdict,
};
use truth::arm::chain::posts;
use truth::plans::{Ask, Furnish, bezier, blocked, tubed};
use truth::rng::Rng;

use crate::judge::Counts;

fn chain(joints: usize) -> (JointTree, Cell) {
    truth::arm::chain::chain(joints, [-1e3, 1e3]).expect("an arm")
}

/// Two arms on a carriage that slides and lifts, with a gripper whose fingers mirror each other.
fn carriage() -> (JointTree, Cell) {
    let mut joints = Vec::new();
    let mut add = |parent, kind, at: [f64; 3], axis, coordinate, factor| {
        joints.push(TreeJoint {
            parent,
            kind,
            origin: Isometry3::translation(at[0], at[1], at[2]),
            axis,
            drive: Some(Drive {
                coordinate,
                factor,
                offset: 0.0,
            }),
        });
        joints.len()
    };
    let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
    let slide = add(0, JointKind::Prismatic, [0.0; 3], x, 0, 1.0);
    let lift = add(slide, JointKind::Prismatic, [0.0, 0.0, 0.2], z, 1, 1.0);
    let mut links = vec![slide];
    for (side, k) in [(1.0, 2), (-1.0, 4)] {
        let upper = add(lift, JointKind::Revolute, [0.0, 0.15 * side, 0.1], z, k, 1.0);
        let fore = add(upper, JointKind::Revolute, [0.3, 0.0, 0.0], y, k + 1, 1.0);
        links.extend([upper, fore]);
        // Fingers follow one coordinate, one of them the wrong way round.
        for mirror in [1.0, -1.0] {
            let at = [0.3, 0.03 * mirror, 0.0];
            links.push(add(fore, JointKind::Prismatic, at, y, 6, 0.05 * mirror));
        }
    }
    let mut cell = Cell::new();
    let cuboid = |x: f64, y: f64, z: f64, at: f64| {
        let half = solids::cuboid(Vector3::new(x, y, z)).expect("a box");
        half.transformed(&Isometry3::translation(at, 0.0, 0.0)).expect("a box")
    };
    cell.robot_body("slide", cuboid(0.1, 0.1, 0.05, 0.0));
    for side in ["left", "right"] {
        cell.robot_body(format!("{side} upper"), cuboid(0.13, 0.03, 0.03, 0.15));
        cell.robot_body(format!("{side} fore"), cuboid(0.13, 0.03, 0.03, 0.15));
        for finger in ["a", "b"] {
            cell.robot_body(format!("{side} {finger}"), cuboid(0.05, 0.01, 0.02, 0.05));
        }
        for [a, b] in [["upper", "fore"], ["fore", "a"], ["fore", "b"], ["a", "b"]] {
            let [a, b] = [a, b].map(|name| format!("{side} {name}"));
            cell.exclude(&a, &b).expect("names");
        }
    }
    posts(&mut cell, 0.9).expect("posts");
    (tree(joints, 7, links), cell)
}

fn tree(joints: Vec<TreeJoint>, coordinates: usize, links: Vec<usize>) -> JointTree {
    let radii = vec![0.3; joints.len() + 1];
    let limits = vec![[-1e3, 1e3]; coordinates];
    JointTree::new(Isometry3::identity(), joints, limits, links, radii).expect("a tree")
}

/// Evaluates a curve by the sum of its Bernstein polynomials.
fn bernstein(points: &[Vec<f64>], t: f64) -> Vec<f64> {
    let n = points.len() - 1;
    let mut sum = vec![0.0; points[0].len()];
    let mut choose = 1.0;
    for (j, point) in points.iter().enumerate() {
        let weight = choose * t.powi(j as i32) * (1.0 - t).powi((n - j) as i32);
        sum.iter_mut().zip(point).for_each(|(s, x)| *s += weight * x);
        choose *= (n - j) as f64 / (j + 1) as f64;
    }
    sum
}

/// Control points of a random curve between two configurations: inner ones off the straight segment by up to `wild` of
/// the way of each coordinate.
fn control_points(rng: &mut Rng, from: &[f64], to: &[f64], degree: usize, wild: f64) -> Vec<Vec<f64>> {
    let point = |j: usize, rng: &mut Rng| {
        let x = j as f64 / degree as f64;
        let is_end = j == 0 || j == degree;
        let each = from.iter().zip(to).map(|(a, b)| {
            let off = if is_end { 0.0 } else { wild * (b - a).abs() };
            if j == degree {
                *b
            } else {
                a + (b - a) * x + off * rng.range(-1.0, 1.0)
            }
        });
        each.collect()
    };
    (0..=degree).map(|j| point(j, rng)).collect()
}

/// Certifies random curves of degree 1 to 7, and judges each at `places` times up to where it is called free.
fn judged((space, cell): (JointTree, Cell), count: usize, places: u32, seed: u64) -> Counts {
    let mut checker = Checker::new(space.clone(), cell.clone()).expect("a world");
    let mut judge = Checker::new(space, cell).expect("a world");
    let dims = checker.space().coordinates();
    let (mut rng, mut counts) = (Rng::new(seed), Counts::default());
    for k in 0..count {
        let from = loop {
            let q: Vec<f64> = (0..dims).map(|_| rng.range(-1.5, 1.5)).collect();
            if judge.is_free_at(&q).expect("within limits") {
                break q;
            }
        };
        let way = [0.2, 0.7, 2.0][k % 3];
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-way, way)).collect();
        let degree = 1 + k % 7;
        let mut points = control_points(&mut rng, &from, &to, degree, [0.2, 1.0, 3.0][(k / 7) % 3]);
        if k % 11 == 0 && degree > 3 {
            // A cusp.
            points[2] = points[1].clone();
            points[3] = points[1].clone();
        }
        let curve = bezier(&points);
        let verdict = checker.verdict_of(&JointMotion::curve(&curve));
        let is_free = |t: f64| judge.is_free_at(&curve.at(t)).expect("within limits");
        counts.judge(&verdict, places, is_free, &(k, &points));
        // The judge's own evaluation.
        let t = rng.uniform();
        let (one, other) = (curve.at(t), bernstein(&points, t));
        assert!(
            one.iter()
                .zip(&other)
                .all(|(x, y)| (x - y).abs() < 1e-13 * (1.0 + 10.0 * way))
        );
    }
    counts.queries = checker.work().queries;
    counts
}

fn robots() -> [(&'static str, (JointTree, Cell)); 4] {
    [
        ("chain of 6", chain(6)),
        ("chain of 14", chain(14)),
        ("chain of 9", chain(9)),
        ("carriage", carriage()),
    ]
}

#[test]
fn random_curves_are_as_the_verdict_says() {
    for (name, robot) in robots() {
        let counts = judged(robot, 25, 100, 1);
        println!("{name}: {counts:?}");
        assert!(counts.free > 2, "{counts:?}");
        assert!(counts.blocked > 2, "{counts:?}");
        assert!(counts.undecided == 0, "{counts:?}");
    }
}

#[test]
#[ignore = "10,000 curves at 10,000 places: cargo test --release -p lin-canny-plan --test plan curves::ten_thousand -- --ignored --nocapture"]
fn ten_thousand_curves_are_as_the_verdict_says() {
    let chosen = crate::chosen_robots(0..4);
    for (k, (name, robot)) in (0..).zip(robots()) {
        if chosen.contains(&k) {
            println!("{name}: {:?}", judged(robot, 2500, 10_000, k + 2));
        }
    }
}

/// A box of half 0.1 that slides along x and y and turns about z, above a box of half 0.5.
fn slider() -> Checker<JointTree> {
    let origin = Isometry3::identity();
    let limits = [-10.0, 10.0];
    let joints = vec![
        Joint::prismatic(origin, Vector3::x_axis(), limits),
        Joint::prismatic(origin, Vector3::y_axis(), limits),
        Joint::revolute(origin, Vector3::z_axis(), limits),
    ];
    let space = JointTree::serial(origin, joints, vec![3], 0.2).expect("an arm");
    let mut cell = Cell::new();
    cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1)).expect("a box"));
    cell.put("box", solids::cuboid(Vector3::repeat(0.5)).expect("a box"), origin);
    Checker::new(space, cell).expect("a world")
}

fn verdict(checker: &mut Checker<JointTree>, points: &[[f64; 3]]) -> Verdict {
    let curve = bezier(points);
    checker.verdict_of(&JointMotion::curve(&curve))
}

fn is_blocked_at_end(verdict: &Verdict) -> bool {
    matches!(verdict, Verdict::Blocked { contact_at: 1.0, free_until: safe, .. } if *safe > 0.99)
}

#[test]
fn a_parabola_that_nearly_touches_is_decided() {
    let mut checker = slider();
    for k in 1..=12 {
        for sign in [1.0, -1.0] {
            let gap = sign * 10f64.powi(-k);
            let low = 2.0 * (0.6 + gap) - 1.6;
            let verdict = verdict(&mut checker, &[[-1.0, 1.6, 0.0], [0.0, low, 0.0], [1.0, 1.6, 0.0]]);
            match verdict {
                Verdict::Free { .. } => assert!(gap > 0.0, "{gap:e}"),
                Verdict::Blocked {
                    contact_at: t,
                    free_until: safe,
                    ..
                } => assert!(gap < 0.0 && t - safe < 1e-3, "{gap:e} {verdict:?}"),
                _ => panic!("{gap:e}: {verdict:?}"),
            }
        }
    }
}

#[test]
fn a_contact_that_is_reached_at_rest_is_found() {
    let mut checker = slider();
    let ways: [&[f64]; 4] = [
        &[1.6, 0.6],
        &[1.6, 0.6, 0.6],
        &[1.6, 0.6, 0.6, 0.6],
        &[1.6, 1.6, 1.6, 0.6, 0.6, 0.6],
    ];
    for way in ways {
        let points: Vec<_> = way.iter().map(|y| [0.0, *y, 0.0]).collect();
        let found = verdict(&mut checker, &points);
        assert!(is_blocked_at_end(&found), "{way:?}: {found:?}");
        for d in [1e-3, 1e-7, 1e-12] {
            for sign in [1.0, -1.0] {
                let mut other = points.clone();
                other
                    .iter_mut()
                    .for_each(|p| p[1] += if p[1] < 1.0 { sign * d } else { 0.0 });
                let found = verdict(&mut checker, &other);
                assert_eq!(found.is_free(), sign > 0.0, "{way:?} {d:e}: {found:?}");
                assert!(!matches!(found, Verdict::Undecided { .. }), "{way:?} {d:e}: {found:?}");
            }
        }
    }
    // A segment that ends in contact, too.
    let found = checker.verdict_of(&JointMotion::segment(&[0.0, 1.6, 0.0], &[0.0, 0.6, 0.0]));
    assert!(is_blocked_at_end(&found), "{found:?}");
}

#[test]
fn cusps_and_curves_that_return_are_decided() {
    let mut checker = slider();
    let back_and_forth = [[-1.0, 0.7, 0.0], [1.0, 0.7, 0.0], [-1.0, 0.7, 0.0], [1.0, 0.7, 0.0]];
    assert!(verdict(&mut checker, &back_and_forth).is_free());
    // The tip of the cusp is at 0.85.
    let cusp = [[-1.0, 1.6, 0.0], [1.0, 0.6, 0.0], [-1.0, 0.6, 0.0], [1.0, 1.6, 0.0]];
    assert!(verdict(&mut checker, &cusp).is_free());
    for d in [1e-3, 1e-6, 1e-9, -1e-9, -1e-6] {
        // The lowest value is a quarter of 1.6 and three quarters of y.
        let y = (0.6 + d - 0.4) / 0.75;
        let found = verdict(
            &mut checker,
            &[[0.0, 1.6, 0.0], [0.0, y, 0.0], [0.0, y, 0.0], [0.0, 1.6, 0.0]],
        );
        assert_eq!(found.is_free(), d > 0.0, "{d:e}: {found:?}");
        assert!(!matches!(found, Verdict::Undecided { .. }), "{d:e}: {found:?}");
    }
    // Exactly tangent within the curve: contact lasts an instant that may be no `f64`.
    let tangent = [[-1.0, 1.6, 0.0], [0.0, -0.4, 0.0], [1.0, 1.6, 0.0]];
    assert!(!verdict(&mut checker, &tangent).is_free());
}

#[test]
fn curves_without_length_are_configurations() {
    let mut checker = slider();
    for count in 1..=6 {
        let at = |y: f64, turn: f64| vec![[0.0, y, turn]; count];
        assert!(verdict(&mut checker, &at(0.7, 0.3)).is_free());
        for (y, turn) in [(0.6, 0.0), (0.5, 0.3)] {
            let found = verdict(&mut checker, &at(y, turn));
            assert!(
                matches!(found, Verdict::Blocked { contact_at: 0.0, .. }),
                "{y}: {found:?}"
            );
        }
    }
}

#[test]
fn a_straight_segment_has_the_same_verdict_at_every_degree() {
    let mut checker = slider();
    let ends = [[-2.0, 0.3, -1.0], [1.5, 0.1, 2.0]];
    let verdict = checker.verdict_of(&JointMotion::segment(&ends[0], &ends[1]));
    let ([safe, t], pair) = blocked(&verdict).expect("the block meets the box");
    let mut curve = bezier(&ends);
    for _ in 1..=7 {
        let found = checker.verdict_of(&JointMotion::curve(&curve));
        let ([s, u], p) = blocked(&found).expect("the block meets the box");
        assert!(p == pair, "{found:?}");
        assert!((s - safe).abs() < 1e-9, "{found:?}");
        assert!((u - t).abs() < 1e-9, "{found:?}");
        curve = curve.elevated().expect("a curve");
    }
    // Degree 1 is the segment, bit for bit.
    let curve = bezier(&ends);
    checker.reset();
    let one = checker.verdict_of(&JointMotion::curve(&curve));
    checker.reset();
    assert_eq!(one, checker.verdict_of(&JointMotion::segment(&ends[0], &ends[1])));
}

/// A joint at its limit along the whole curve stays within the limit, whatever the degree rounds.
#[test]
fn values_stay_within_the_control_points() {
    let mut rng = Rng::new(78);
    for degree in 1..=16 {
        for _ in 0..200 {
            let limit = rng.range(-3.0, 3.0);
            let ends = [limit, limit + rng.range(0.0, 1.0)];
            let points: Vec<Vec<f64>> = (0..=degree).map(|k| vec![limit, ends[k % 2]]).collect();
            let curve = bezier(&points);
            let [still, other] = curve.at(rng.range(0.0, 1.0))[..] else {
                panic!("two coordinates")
            };
            assert_eq!(still, limit, "{degree}");
            assert!(ends[0] <= other && other <= ends[1], "{degree} {other} {ends:?}");
        }
    }
}

#[test]
fn limits_hold_between_control_points() {
    let joints = vec![Joint::prismatic(Isometry3::identity(), Vector3::x_axis(), [-10.0, 1.0])];
    let space = JointTree::serial(Isometry3::identity(), joints, vec![1], 0.2).expect("an arm");
    let mut cell = Cell::new();
    cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1)).expect("a box"));
    let mut checker = Checker::new(space, cell).expect("a world");
    let mut check = |points: &[f64]| {
        let points: Vec<[f64; 1]> = points.iter().map(|x| [*x]).collect();
        checker.certify(&JointMotion::curve(&bezier(&points)))
    };
    // A control point outside, the curve inside or on the limit.
    assert!(check(&[0.0, 1.9, 0.0]).is_ok_and(|v| v.is_free()));
    assert!(check(&[0.0, 2.0, 0.0]).is_ok_and(|v| v.is_free()));
    for (points, expected) in [
        (&[0.0, 2.002, 0.0][..], 0.5),
        (&[0.0, 2.0 + 2e-13, 0.0], 0.5),
        (&[0.0, 0.0, 2.3, 0.0], 2.0 / 3.0),
    ] {
        let Err(PlanError::CurveLimit {
            coordinate: 0,
            time,
            value,
        }) = check(points)
        else {
            panic!("{points:?}")
        };
        assert!((time - expected).abs() < 0.1, "{points:?}: {time} {value}");
        assert!(value > 1.0, "{points:?}: {time} {value}");
    }
}

#[test]
fn curves_of_wrong_numbers_and_spaces_are_errors() {
    let refused = |points: &[&[f64]]| JointCurve::bezier(points).expect_err("an error").to_string();
    assert_eq!(refused(&[]), "path is empty (expected at least one configuration)");
    assert!(refused(&[&[0.0], &[0.0, 1.0]]).contains("2 numbers"));
    assert!(refused(&[&[0.0], &[f64::NAN]]).contains("control point"));
    assert!(refused(&[&[0.0][..]; 18]).contains("degree"));
    let mut checker = slider();
    let short = bezier(&[[0.0, 1.0], [1.0, 1.0]]);
    assert!(matches!(
        checker.certify(&JointMotion::curve(&short)),
        Err(PlanError::Length { expected: 3, found: 2 })
    ));

    let mut cell = Cell::new();
    cell.robot_body("part", solids::cuboid(Vector3::repeat(0.1)).expect("a box"));
    let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.5, 1).expect("a space");
    let mut rigid = Checker::new(space, cell.clone()).expect("a world");
    let at = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let straight = bezier(&[at(0.0), at(1.0)]);
    assert!(rigid.certify(&JointMotion::curve(&straight)).is_ok_and(|v| v.is_free()));
    let bent = bezier(&[at(0.0), at(1.0), at(0.0)]);
    assert_eq!(
        rigid.certify(&JointMotion::curve(&bent)),
        Err(PlanError::CurveDegree {
            coordinate: 3,
            degree: 2
        })
    );
}

/// The rooms of rigid bodies: a plank that slides and turns in the plane, and one that slides in space.
fn plank() -> Cell {
    let mut cell = Cell::new();
    let plank = solids::cuboid(Vector3::new(0.3, 0.05, 0.1)).expect("a box");
    let end = Isometry3::translation(0.2, 0.1, 0.0);
    cell.robot_body("plank", plank.clone());
    cell.robot_body("end", plank.transformed(&end).expect("a box"));
    posts(&mut cell, 0.9).expect("posts");
    cell
}

/// Judges curves of a space whose coordinates are independent, as [`judged`] does.
fn judged_in<C: ConfigurationSpace + Clone>(space: C, degrees: usize, seed: u64) -> [u32; 2] {
    let mut checker = Checker::new(space.clone(), plank()).expect("a world");
    let mut judge = Checker::new(space, plank()).expect("a world");
    let (mut rng, mut counts) = (Rng::new(seed), Counts::default());
    for k in 0..200 {
        let from = loop {
            let q: Vec<f64> = (0..3).map(|_| rng.range(-1.2, 1.2)).collect();
            if judge.is_free_at(&q).expect("within limits") {
                break q;
            }
        };
        let way = [0.3, 1.0, 2.0][k % 3];
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-way, way)).collect();
        let points = control_points(&mut rng, &from, &to, 1 + k % degrees, [0.2, 1.0][k % 2]);
        let curve = bezier(&points);
        let verdict = checker.verdict_of(&JointMotion::curve(&curve));
        let is_free = |t: f64| judge.is_free_at(&curve.at(t)).expect("within limits");
        counts.judge(&verdict, 100, is_free, &(k, &points));
        if verdict.is_free() {
            // The tube of one coordinate: shifted curves are free.
            let e = 0.02;
            let tube: Vec<f64> = (0..3).map(|c| if c == k % 3 { e } else { 0.0 }).collect();
            let is_tube = checker.is_free_along(&tubed(&curve, &tube));
            for i in 0..=20 {
                for off in [-e, e] {
                    let mut q = curve.at(f64::from(i) / 20.0);
                    q[k % 3] += off;
                    assert!(!is_tube || judge.is_free_at(&q).expect("within limits"), "curve {k}");
                }
            }
        }
    }
    assert_eq!(counts.undecided, 0);
    [counts.free, counts.blocked]
}

#[test]
fn curves_of_planar_bodies_are_as_the_verdict_says() {
    let space = PlanarSpace::new([[-9.0, 9.0]; 2], 0.5, 2).expect("a space");
    let [free, blocked] = judged_in(space, 7, 5);
    assert!(free > 20 && blocked > 20, "{free} {blocked}");
}

#[test]
fn curves_of_bodies_that_slide_are_as_the_verdict_says() {
    let turn = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
    let space = TranslationSpace::new([[-9.0, 9.0]; 3], turn, 2).expect("a space");
    let [free, blocked] = judged_in(space, 7, 6);
    assert!(free > 20 && blocked > 20, "{free} {blocked}");
}

#[test]
fn angles_of_planar_curves_do_not_jump() {
    let mut cell = Cell::new();
    let arm = solids::cuboid(Vector3::new(0.5, 0.05, 0.05)).expect("a box");
    let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    cell.robot_body("arm", arm.transformed(&at(0.6)).expect("a box"));
    cell.put("post", solids::cuboid(Vector3::repeat(0.1)).expect("a box"), at(1.0));
    let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    let ends = [[0.0, 0.0, 3.0], [0.0, 0.0, -3.0]];
    assert!(checker.is_free_along(&JointMotion::segment(&ends[0], &ends[1])));
    let curve = bezier(&ends);
    assert!(matches!(
        checker.certify(&JointMotion::curve(&curve)),
        Ok(Verdict::Blocked { .. })
    ));
    let short = bezier(&[[0.0, 0.0, 3.0], [0.0, 0.0, 3.28]]);
    assert!(checker.certify(&JointMotion::curve(&short)).is_ok_and(|v| v.is_free()));
    let far = bezier(&[[0.0; 3], [0.0, 0.0, 2e3], [0.0; 3]]);
    assert!(checker.certify(&JointMotion::curve(&far)).is_ok_and(|v| !v.is_free()));
    let out = bezier(&[[0.0; 3], [0.0, 4.1, 0.0], [0.0; 3]]);
    let error = checker.certify(&JointMotion::curve(&out));
    assert!(
        matches!(error, Err(PlanError::CurveLimit { coordinate: 1, .. })),
        "{error:?}"
    );
}

#[test]
fn conversions_are_the_curves_that_were_given() {
    let mut rng = Rng::new(3);
    for _ in 0..200 {
        let [p, q, v, w, a, b]: [[f64; 2]; 6] = std::array::from_fn(|_| [rng.range(-2.0, 2.0), rng.range(-2.0, 2.0)]);
        let duration = rng.log_range(0.1, 10.0);
        let near = |x: &[f64], y: &[f64], scale: f64| {
            assert!(
                x.iter()
                    .zip(y)
                    .all(|(x, y)| (x - y * scale).abs() < 1e-11 * (1.0 + scale)),
                "{x:?} {y:?}"
            );
        };
        let cubic = JointCurve::cubic(p, q, v, w, duration).expect("a curve");
        let quintic = JointCurve::quintic([p, q], [v, w], [a, b], duration).expect("a curve");
        for curve in [&cubic, &quintic] {
            near(&curve.at(0.0), &p, 1.0);
            near(&curve.at(1.0), &q, 1.0);
            near(&curve.velocity(0.0), &v, duration);
            near(&curve.velocity(1.0), &w, duration);
        }
        near(&quintic.acceleration(0.0), &a, duration * duration);
        near(&quintic.acceleration(1.0), &b, duration * duration);

        let power = JointCurve::power(&[p, q, v, w, a, b]).expect("a curve");
        let t = rng.uniform();
        let sum: Vec<f64> = (0..2)
            .map(|c| [p, q, v, w, a, b].iter().rev().fold(0.0, |sum, x| sum * t + x[c]))
            .collect();
        near(&power.at(t), &sum, 1.0);
        near(&power.elevated().expect("a curve").at(t), &sum, 1.0);
    }
}

/// The recursion of Cox and de Boor.
fn basis(knots: &[f64], k: usize, degree: usize, u: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from(knots[k] <= u && u < knots[k + 1]));
    }
    let part = |from: f64, until: f64, at: f64| if until > from { at / (until - from) } else { 0.0 };
    part(knots[k], knots[k + degree], u - knots[k]) * basis(knots, k, degree - 1, u)
        + part(knots[k + 1], knots[k + degree + 1], knots[k + degree + 1] - u) * basis(knots, k + 1, degree - 1, u)
}

#[test]
fn splines_are_the_sums_of_their_basis() {
    let mut rng = Rng::new(4);
    for round in 0..60 {
        let degree = 1 + round % 5;
        let count = degree + 1 + rng.below(6);
        let points: Vec<[f64; 2]> = (0..count)
            .map(|_| [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)])
            .collect();
        let mut knots: Vec<f64> = (0..count + degree + 1)
            .map(|_| f64::from(rng.below(6) as u32))
            .collect();
        knots.sort_by(f64::total_cmp);
        let is_uniform = round % 4 == 0;
        if is_uniform {
            knots = (0..count + degree + 1).map(|k| k as f64).collect();
        }
        let Ok(times) = JointCurve::b_spline_times(count, degree, &knots) else {
            continue;
        };
        let curves = JointCurve::b_spline(&points, degree, &knots).expect("a spline");
        if is_uniform {
            assert_eq!(curves, JointCurve::uniform_b_spline(&points, degree).expect("a spline"));
        }
        assert_eq!(curves.len() + 1, times.len());
        for (curve, ends) in curves.iter().zip(times.windows(2)) {
            for i in 0..8 {
                let t = f64::from(i) / 8.0;
                let u = ends[0] + (ends[1] - ends[0]) * t;
                let at = curve.at(t);
                for c in 0..2 {
                    let sum: f64 = points
                        .iter()
                        .enumerate()
                        .map(|(k, p)| p[c] * basis(&knots, k, degree, u))
                        .sum();
                    assert!((sum - at[c]).abs() < 1e-12, "{knots:?} at {u}: {sum} {at:?}");
                }
            }
        }
        for pair in curves.windows(2) {
            assert_eq!(pair[0].control_point(degree), pair[1].control_point(0));
        }
    }
}

#[test]
fn proofs_and_clearances_of_curves_agree_with_verdicts() {
    let (space, cell) = chain(6);
    let mut checker = Checker::new(space, cell).expect("a world");
    let (mut rng, mut free) = (Rng::new(7), 0);
    for k in 0..30 {
        let from: Vec<f64> = (0..6).map(|_| rng.range(-1.0, 1.0)).collect();
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-0.5, 0.5)).collect();
        let points = control_points(&mut rng, &from, &to, 2 + k % 4, 1.0);
        let curve = bezier(&points);
        let is_free = checker.is_free_along(&JointMotion::curve(&curve));
        let proof = crate::prove(&mut checker, &JointMotion::curve(&curve)).expect("within limits");
        assert_eq!(proof.is_some(), is_free);
        let clearance = checker
            .clearance_along(&JointMotion::curve(&curve), 1e-2)
            .expect("within limits");
        assert_eq!(clearance.lower > 0.0, is_free, "{clearance:?}");
        if !is_free {
            continue;
        }
        free += 1;
        proof.expect("a proof").iter().for_each(crate::judge::follow);
        let least = (0..=200).map(|i| {
            let near = checker
                .clearance(&curve.at(f64::from(i) / 200.0))
                .expect("within limits");
            near.expect("a pair").distance
        });
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(clearance.lower <= least, "{clearance:?} {least}");
        assert!(least <= clearance.upper * (1.0 + 1e-2) + 1e-3, "{clearance:?} {least}");
    }
    assert!(free > 5, "{free}");
}

#[test]
fn paths_and_splines_report_progress_and_stop() {
    use std::ops::ControlFlow::{Break, Continue};
    let mut checker = slider();
    let path: Vec<Vec<f64>> = [[-2.0, 2.0], [-1.0, 1.5], [1.0, 1.5], [2.0, 2.0]]
        .map(|[x, y]| vec![x, y, 0.0])
        .into();
    let curves: Vec<JointCurve> = path
        .windows(2)
        .map(|ends| bezier(&[&ends[0], &ends[0], &ends[1]]))
        .collect();
    let one = checker.certify(&JointMotion::path(&path[..1]).expect("a motion"));
    assert_eq!(one, checker.certify(&JointMotion::segment(&path[0], &path[0])));
    let motions = [
        JointMotion::path(&path).expect("a path"),
        JointMotion::spline(&curves).expect("a spline"),
    ];
    for (upto, motion) in [0, 1, 9]
        .into_iter()
        .flat_map(|upto| motions.iter().map(move |m| (upto, m)))
    {
        let mut seen = Vec::new();
        let mut note = |progress: lin_canny::Progress| {
            assert_eq!((progress.stage, progress.total), ("pieces", Some(3)));
            seen.push(progress.done);
            if progress.done == upto { Break(()) } else { Continue(()) }
        };
        let found = checker.certify_with(motion, CertifyOptions::default().progress(&mut note));
        let found = found.expect("within limits");
        let (last, is_stopped) = if upto < 3 { (upto, true) } else { (2, false) };
        assert_eq!(seen, (0..=last).collect::<Vec<_>>());
        assert_eq!(found.is_stopped, is_stopped);
        let whole = checker.verdict_of(motion);
        match is_stopped {
            true => assert_eq!((found.verdict.free_until(), found.verdict.piece()), (0.0, Some(upto))),
            false => assert_eq!(found.verdict, whole),
        }
    }
}

#[test]
fn curves_have_the_same_bits_on_every_thread_and_after_reset() {
    let ask = |checker: &mut Checker<JointTree>| -> Vec<String> {
        let mut rng = Rng::new(9);
        let each = (0..12).map(|k| {
            let from: Vec<f64> = (0..7).map(|_| rng.range(-1.0, 1.0)).collect();
            let to: Vec<f64> = from.iter().map(|x| x + rng.range(-1.0, 1.0)).collect();
            let points = control_points(&mut rng, &from, &to, 1 + k % 7, 1.0);
            let curve = bezier(&points);
            checker.reset();
            let verdict = checker.certify(&JointMotion::curve(&curve));
            checker.reset();
            format!(
                "{verdict:?} {:?}",
                checker.clearance_along(&JointMotion::curve(&curve), 0.01)
            )
        });
        each.collect()
    };
    let new = || {
        let (space, cell) = carriage();
        Checker::new(space, cell).expect("a world")
    };
    let mut checker = new();
    let expected = ask(&mut checker);
    assert_eq!(ask(&mut checker), expected);
    let threads: Vec<_> = (0..3).map(|_| std::thread::spawn(move || ask(&mut new()))).collect();
    for thread in threads {
        assert_eq!(thread.join().expect("no panic"), expected);
    }
}

/// Points of bodies stay as near to their models along curves as the bounds say.
#[test]
fn curves_keep_the_contract_of_motions() {
    use lin_canny_plan::SegmentMotion;
    let mut rng = Rng::new(12);
    for (space, _) in [chain(6), carriage()] {
        let dims = space.coordinates();
        let mut tight = 0;
        for round in 0..150 {
            let degree = 1 + round % 7;
            let from: Vec<f64> = (0..dims).map(|_| rng.range(-2.0, 2.0)).collect();
            let to: Vec<f64> = (0..dims).map(|_| rng.range(-2.0, 2.0)).collect();
            let points = control_points(&mut rng, &from, &to, degree, [0.0, 0.3, 2.0][round % 3]);
            let curve = bezier(&points);
            let motion = space.curve(&curve).expect("within limits");
            for _ in 0..8 {
                let body = rng.below(space.bodies());
                let time = if rng.chance(0.25) { 0.0 } else { rng.uniform() };
                let span = (1.0 - time) * rng.log_range(1e-4, 1.0);
                let stem = motion.stem(body, rng.below(space.bodies()));
                let (start, model) = motion.placed(stem, body, time, span);
                for _ in 0..8 {
                    let s = span * rng.uniform();
                    let now = motion.placed(stem, body, time + s, 0.0).0;
                    let arm = Vector3::from(rng.unit()) * rng.range(0.0, 2.0);
                    let pivot = start * model.pivot + model.linear * s + model.acceleration * (0.5 * s * s);
                    let turn = lin_canny::nalgebra::UnitQuaternion::from_scaled_axis(model.angular * s);
                    let at = pivot + turn * (start.rotation * arm);
                    let off = (now * Point3::from(model.pivot.coords + arm) - at).norm();
                    let bound = model.shift.at(s) + arm.norm() * model.turn.at(s);
                    assert!(
                        off <= bound,
                        "{off:e} {bound:e} at {time} + {s}, degree {degree}, stem {stem}"
                    );
                    tight += u32::from(off > 0.2 * bound);
                }
            }
        }
        assert!(tight > 100, "{tight}");
    }
}

/// Returns a tube of numbers, or of curves of this degree.
fn random_tube(rng: &mut Rng, dims: usize, degree: usize, [low, high]: [f64; 2]) -> JointTube {
    let mut row = || -> Vec<f64> { (0..dims).map(|_| rng.log_range(low, high)).collect() };
    match degree {
        0 => (&row()).into(),
        _ => {
            let points: Vec<Vec<f64>> = (0..=degree).map(|_| row()).collect();
            bezier(&points).into()
        }
    }
}

/// No configuration within a tube that is called free meets anything: corners and random places of the tube, by predicates.
#[test]
fn tubes_of_joints_hold_at_their_corners() {
    let mut rng = Rng::new(21);
    for (name, (space, cell)) in robots() {
        let mut checker = Checker::new(space.clone(), cell.clone()).expect("a world");
        let mut judge = Checker::new(space, cell).expect("a world");
        let dims = checker.space().coordinates();
        let (mut free, mut narrow) = (0, 0);
        for k in 0..25 {
            let from: Vec<f64> = (0..dims).map(|_| rng.range(-1.0, 1.0)).collect();
            let to: Vec<f64> = from.iter().map(|x| x + rng.range(-0.5, 0.5)).collect();
            let points = control_points(&mut rng, &from, &to, 1 + k % 7, 1.0);
            let curve = bezier(&points);
            let tube = random_tube(&mut rng, dims, k % 4, [1e-4, 0.02]);
            let without = checker.is_free_along(&JointMotion::curve(&curve));
            let verdict = checker.verdict_of(&tubed(&curve, &tube));
            assert!(without || !verdict.is_free());
            free += u32::from(verdict.is_free());
            narrow += u32::from(without && !verdict.is_free());
            for i in 0..=100 {
                let t = verdict.free_until() * f64::from(i) / 100.0;
                if matches!(
                    verdict,
                    Verdict::Blocked { contact_at: 0.0, .. } | Verdict::Undecided { free_until: 0.0, .. }
                ) {
                    break;
                }
                let off = |x: &f64, e: &f64, rng: &mut Rng| x + e * [-1.0, 1.0, rng.range(-1.0, 1.0)][rng.below(3)];
                let q: Vec<f64> = curve
                    .at(t)
                    .iter()
                    .zip(&tube.at(t))
                    .map(|(x, e)| off(x, e, &mut rng))
                    .collect();
                assert!(
                    judge.is_free_at(&q).expect("within limits"),
                    "{name} {k} at {t}: {tube:?} {points:?}"
                );
            }
            let none = checker.verdict_of(&tubed(&curve, &vec![0.0; dims]));
            assert_eq!(none.is_free(), without);
        }
        println!("{name}: {free} free, {narrow} too narrow");
        assert!(free > 2, "{name}: {free}");
    }
    let curve = bezier(&[[0.0; 3], [0.1; 3]]);
    for tube in [&[0.1, 0.1][..], &[0.1, -0.1, 0.1], &[0.1, f64::NAN, 0.1]] {
        assert!(JointMotion::curve(&curve).with_tube(tube).is_err(), "{tube:?}");
    }
}

/// What is returned from a tube that is not free is within the tube and the limits, and not free,
/// by predicates of another checker. A tube that is free contains none.
#[test]
fn contacts_in_tubes_are_within_the_tube() {
    let mut rng = Rng::new(22);
    let (mut found, mut missed) = (0, 0);
    for (name, (space, cell)) in robots() {
        let mut checker = Checker::new(space.clone(), cell.clone()).expect("a world");
        let mut judge = Checker::new(space, cell).expect("a world");
        let dims = checker.space().coordinates();
        for k in 0..25 {
            let from: Vec<f64> = (0..dims).map(|_| rng.range(-1.0, 1.0)).collect();
            let to: Vec<f64> = from.iter().map(|x| x + rng.range(-0.5, 0.5)).collect();
            let points = control_points(&mut rng, &from, &to, 1 + k % 7, 1.0);
            let curve = bezier(&points);
            if !checker.is_free_along(&JointMotion::curve(&curve)) {
                continue;
            }
            let tube = random_tube(&mut rng, dims, k % 4, [1e-3, 0.05]);
            let verdict = checker.verdict_of(&tubed(&curve, &tube));
            let contact = checker
                .tube_contact(&tubed(&curve, &tube), 0, verdict.free_until())
                .expect("a tube");
            let Some((t, q)) = contact else {
                missed += u32::from(!verdict.is_free());
                continue;
            };
            assert!(!verdict.is_free(), "{name} {k}");
            assert!(t >= verdict.free_until(), "{name} {k}");
            assert!(t <= 1.0, "{name} {k}");
            for ((x, y), e) in q.iter().zip(curve.at(t)).zip(tube.at(t)) {
                let off = (x - y).abs();
                assert!(off <= e + 1e-15 * y.abs().max(1.0), "{name} {k} at {t}: {q:?}");
            }
            assert!(
                !judge.is_free_at(&q).expect("within limits"),
                "{name} {k} at {t}: {q:?}"
            );
            found += 1;
        }
    }
    println!("{found} contacts in tubes, {missed} tubes without one");
    assert!(found > 5, "{found} {missed}");
}

#[test]
fn a_tube_may_change_along_the_curve() {
    // The block touches the box at the height 0.6, while x is within 0.6: at the times 0.35 to 0.65.
    let mut checker = slider();
    let level = bezier(&[[-2.0, 0.75, 0.0], [2.0, 0.75, 0.0]]);
    let of = |points: &[f64]| {
        let points: Vec<[f64; 3]> = points.iter().map(|y| [0.0, *y, 0.0]).collect();
        bezier(&points)
    };
    for (points, is_free) in [
        (&[0.1, 0.1][..], true),
        (&[0.2, 0.2], false),
        // 0.077 where x enters the box.
        (&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], true),
        // 0.218 where x enters the box.
        (&[0.4, 0.0, 0.4], false),
        // Linear: 0.13 where x enters the box, 0.07 where it leaves it.
        (&[0.2, 0.0], true),
        // 0.165 where x leaves it.
        (&[0.06, 0.22], false),
    ] {
        let verdict = checker.verdict_of(&tubed(&level, of(points)));
        let contact = checker
            .tube_contact(&tubed(&level, of(points)), 0, 0.0)
            .expect("a tube");
        assert_eq!(verdict.is_free(), is_free, "{points:?}: {verdict:?}");
        assert_eq!(contact.is_none(), is_free, "{points:?}: {contact:?}");
        // The same numbers in a constant tube have the same verdict, bit for bit.
        if let [a, b] = points
            && a == b
        {
            let same = checker.verdict_of(&tubed(&level, &[0.0, *a, 0.0]));
            assert_eq!(same, verdict);
        }
    }
    for wrong in [of(&[0.1, -0.1, 0.1]), bezier(&[[0.1, 0.1]; 2])] {
        assert!(JointMotion::curve(&level).with_tube(wrong).is_err());
    }
}

#[test]
fn a_contact_in_a_tube_has_its_time() {
    // The block touches the box at the height 0.6, while x is within 0.6.
    let mut checker = slider();
    let level = bezier(&[[-2.0, 0.75, 0.0], [2.0, 0.75, 0.0]]);
    for (off, touches) in [(0.0, false), (0.1, false), (0.2, true)] {
        let tube = [0.0, off, 0.0];
        let verdict = checker.verdict_of(&tubed(&level, &tube));
        let found = checker
            .tube_contact(&tubed(&level, &tube), 0, verdict.free_until())
            .expect("a tube");
        assert_eq!((verdict.is_free(), found.is_some()), (!touches, touches), "{found:?}");
        if let Some((t, q)) = found {
            assert!(q[0] == level.at(t)[0], "{q:?}");
            assert!(q[0].abs() <= 0.6 + 1e-9, "{q:?}");
            assert!((q[1] - 0.55).abs() < 1e-12, "{q:?}");
        }
    }
    // The cart reaches the tube of the block at the end, and no sooner than at 0.9.
    let x = |x: f64| Isometry3::translation(x, 3.0, 0.0);
    let poses = lin_canny_plan::TimedPoses::new(&[0.0, 10.0], &[x(10.0), x(0.25)]).expect("poses");
    let mut cell = checker.cell().clone();
    cell.put_moving("cart", solids::cuboid(Vector3::repeat(0.1)).expect("a box"), poses);
    let mut moving = Checker::new(checker.space().clone(), cell).expect("a world");
    let still = bezier(&[[0.0, 3.0, 0.0]; 2]);
    let still = still.with_times([0.0, 10.0]).expect("times");
    for (before, off) in [(None, 0.1), (Some(2.0), 0.1), (None, 0.01)] {
        if let Some(time) = before {
            moving.set_time(time).expect("a time");
        }
        let tube = [off, 0.0, 0.0];
        let verdict = moving.verdict_of(&tubed(&still, &tube));
        let found = moving
            .tube_contact(&tubed(&still, &tube), 0, verdict.free_until())
            .expect("a tube");
        assert_eq!(verdict.is_free(), off < 0.05, "{verdict:?} {found:?}");
        assert_eq!(found.is_some(), off > 0.05, "{verdict:?} {found:?}");
        assert!(found.is_none_or(|(t, q)| t > 0.9 && (q[0] - 0.1).abs() < 1e-12));
        assert_eq!(moving.time(), before);
        moving = Checker::new(moving.space().clone(), moving.cell().clone()).expect("a world");
    }
    for (tube, from) in [
        (&[0.1, 0.1][..], 0.0),
        (&[0.1, -0.1, 0.1], 0.0),
        (&[0.1; 3], f64::NAN),
        (&[0.1; 3], 1.5),
    ] {
        assert!(
            JointMotion::curve(&level)
                .with_tube(tube)
                .and_then(|motion| checker.tube_contact(&motion, 0, from))
                .is_err(),
            "{tube:?} {from}"
        );
    }
}

/// Two hinges and a slide among boxes, in this unit of length.
fn crane(unit: f64) -> Checker<JointTree> {
    let at = |x: f64, y: f64, z: f64| Isometry3::translation(x * unit, y * unit, z * unit);
    let joints = vec![
        Joint::revolute(at(0.0, 0.0, 0.0), Vector3::z_axis(), [-4.0, 4.0]),
        Joint::prismatic(at(1.0, 0.0, 0.0), Vector3::x_axis(), [-unit, 2.0 * unit]),
        Joint::revolute(at(0.2, 0.0, 0.0), Vector3::y_axis(), [-4.0, 4.0]),
    ];
    let space = JointTree::serial(at(0.0, 0.0, 0.1), joints, vec![1, 2, 3], 3.0 * unit).expect("an arm");
    let cuboid = |x: f64, y: f64, z: f64| solids::cuboid(Vector3::new(x, y, z) * unit).expect("a box");
    let mut cell = Cell::new();
    cell.robot_body("boom", cuboid(0.3, 0.1, 0.1));
    cell.robot_body("slide", cuboid(0.2, 0.1, 0.1));
    cell.robot_body(
        "hook",
        cuboid(0.1, 0.1, 0.3).transformed(&at(0.0, 0.0, -0.3)).expect("a box"),
    );
    cell.exclude("slide", "hook").expect("names");
    cell.exclude("boom", "slide").expect("names");
    cell.put("post", cuboid(0.2, 0.2, 1.0), at(1.1, 0.8, 0.0));
    cell.put("pillar", cuboid(0.2, 0.2, 1.0), at(1.2, -0.7, 0.0));
    cell.put("floor", cuboid(9.0, 9.0, 0.1), at(0.0, 0.0, -1.0));
    Checker::new(space, cell).expect("a world")
}

/// Curves, tubes and clearances in scenes of all sizes: equal to the bit, unless the size crosses a limit of storage.
#[test]
fn scenes_of_all_sizes_have_equal_verdicts() {
    let asked = |exponent: i32| -> Vec<(Verdict, bool, [f64; 2])> {
        let unit = 2f64.powi(exponent);
        let mut checker = crane(unit);
        let mut rng = Rng::new(41);
        let each = (0..21).map(|k| {
            let from = [rng.range(-1.0, 1.0), rng.range(-0.5, 0.5), rng.range(-0.5, 0.5)];
            let to = from.map(|x| x + rng.range(-1.0, 1.0));
            let mut points = control_points(&mut rng, &from, &to, 1 + k % 7, 1.0);
            points.iter_mut().for_each(|p| p[1] *= unit);
            let curve = bezier(&points);
            checker.reset();
            let verdict = checker.verdict_of(&JointMotion::curve(&curve));
            checker.reset();
            let tube = checker.certify(&tubed(&curve, &[0.01, 0.01 * unit, 0.01]));
            checker.reset();
            let clearance = checker
                .clearance_along(&JointMotion::curve(&curve), 1e-2)
                .expect("within limits");
            let is_wide = tube.expect("within limits").is_free();
            (verdict, is_wide, [clearance.lower / unit, clearance.upper / unit])
        });
        each.collect()
    };
    let expected = asked(0);
    let free = expected.iter().filter(|(verdict, ..)| verdict.is_free()).count();
    assert!((3..19).contains(&free), "{free}");
    // A bracket is 1e-6 of the sizes wide, and a clearance 1e-2 of itself.
    let is_near = |a: f64, b: f64, width: f64| (a - b).abs() <= width * (a.abs() + b.abs());
    for exponent in [-325, -200, -100, -40, 40, 100, 200, 325] {
        for (found, expected) in asked(exponent).iter().zip(&expected) {
            let is_equal = match (blocked(&found.0), blocked(&expected.0)) {
                (Some(found), Some(expected)) if exponent.abs() <= 40 => found == expected,
                (Some(([safe, t], pair)), Some(([s, u], p))) => {
                    pair == p && is_near(safe, s, 1e-5) && is_near(t, u, 1e-5)
                }
                _ => found.0.is_free() && expected.0.is_free(),
            };
            assert!(is_equal && found.1 == expected.1, "{exponent}: {found:?} {expected:?}");
            let [low, high] =
                [0, 1].map(|k| is_near(found.2[k], expected.2[k], if exponent.abs() <= 40 { 0.0 } else { 1e-2 }));
            assert!(low && high, "{exponent}: {found:?} {expected:?}");
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn curves_are_stored_with_their_errors() {
    let mut rng = Rng::new(77);
    for degree in 1..=7 {
        let points: Vec<Vec<f64>> = (0..=degree)
            .map(|_| (0..3).map(|_| rng.range(-2.0, 2.0)).collect())
            .collect();
        let curves = [
            bezier(&points),
            JointCurve::power(&points).expect("a curve"),
            JointCurve::uniform_b_spline(&points, degree)
                .expect("a spline")
                .remove(0),
        ];
        for curve in curves {
            let text = serde_json::to_string(&curve).expect("a curve");
            let read: JointCurve = serde_json::from_str(&text).expect("a curve");
            // The error of a conversion is a part of the curve.
            assert_eq!(read, curve);
            let timed = curve.with_times([-1.5, 2.0]).expect("times");
            let text = serde_json::to_string(&timed).expect("a curve");
            assert_eq!(serde_json::from_str::<JointCurve>(&text).expect("a curve"), timed);
        }
    }
    for bad in [
        r#"{"points":[],"errors":[]}"#,
        r#"{"points":[[0.0],[1.0]],"errors":[]}"#,
        r#"{"points":[[0.0],[1.0]],"errors":[-1.0]}"#,
        r#"{"points":[[0.0],[1.0,2.0]],"errors":[0.0]}"#,
    ] {
        assert!(serde_json::from_str::<JointCurve>(bad).is_err(), "{bad}");
    }
}

/// Points of bodies stay within the bound of their chords, and the bound is near for one joint that turns.
#[test]
fn points_stay_near_their_chords() {
    let mut rng = Rng::new(77);
    let mut closest = 0.0f64;
    for round in 0..60 {
        let (space, _) = match round % 3 {
            0 => chain(1),
            1 => chain(6),
            _ => carriage(),
        };
        let (coordinates, degree) = (space.bounds().len(), 1 + rng.below(7));
        let way = [0.05, 0.3, 1.0][rng.below(3)];
        let mut points = vec![vec![0.0; coordinates]];
        for _ in 0..degree {
            let last = &points[points.len() - 1];
            points.push(
                last.iter()
                    .map(|x| (x + rng.range(-way, way)).clamp(-0.9, 0.9))
                    .collect(),
            );
        }
        let segment = space.curve(&bezier(&points)).expect("a motion");
        let (parts, reach) = (1u32 << rng.below(5), rng.range(0.01, 1.0));
        for body in 0..3.min(space.bodies()) {
            let bound = segment.chord_deviation(body, reach, parts);
            let point = Point3::from(reach * Vector3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 1.0).normalize());
            let at = |time: f64| segment.pose(body, time) * point;
            for part in 0..parts {
                let [from, until] = [part, part + 1].map(|k| f64::from(k) / f64::from(parts));
                let (start, end) = (at(from), at(until));
                for k in 1..16 {
                    let u = f64::from(k) / 16.0;
                    let off = (at(from + u * (until - from)) - (start + (end - start) * u)).norm();
                    assert!(off <= bound, "{round}: {off} {bound}, degree {degree}, {parts} parts");
                    if round % 3 == 0 && bound > 1e-9 {
                        closest = closest.max(off / bound);
                    }
                }
            }
        }
    }
    println!("the farthest point is at {closest} of its bound");
    assert!(closest > 0.7, "{closest}");
}
