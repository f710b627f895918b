//! Pairs of two bodies that move with the robot, among them pairs whose boxes never overlap: verdicts equal those of the
//! proof, which casts all pairs, and every place of what is called free keeps all distances.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, HalfSpace, Mesh, Shape};
use lin_canny_plan::{
    Cell, CellBody, Checker, ConfigurationSpace, Drive, JointKind, JointMotion, JointTree, TimedPoses, TreeJoint,
    Verdict,
};
use truth::plans::{Ask, Furnish, bezier, tubed};
use truth::rng::Rng;

const CARTS: usize = 3;

/// Carts, each with a slide along x, one along y and a hinge about z.
fn carts(limit: f64) -> JointTree {
    let mut joints = Vec::new();
    let mut links = Vec::new();
    for cart in 0..CARTS {
        for (j, axis) in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()]
            .into_iter()
            .enumerate()
        {
            joints.push(TreeJoint {
                parent: if j == 0 { 0 } else { joints.len() },
                kind: if j == 2 {
                    JointKind::Revolute
                } else {
                    JointKind::Prismatic
                },
                origin: Isometry3::identity(),
                axis,
                drive: Some(Drive::by(3 * cart + j)),
            });
        }
        links.push(joints.len());
    }
    let limits = vec![[-limit, limit]; 3 * CARTS];
    let radii = vec![0.5 * limit; joints.len() + 1];
    JointTree::new(Isometry3::identity(), joints, limits, links, radii).expect("a tree")
}

fn geometry(rng: &mut Rng) -> Geometry {
    let half = Vector3::from_fn(|_, _| rng.range(0.03, 0.2));
    let block = solids::cuboid(half).expect("a box");
    match rng.below(4) {
        0 => Shape::ball(half.x).expect("a ball").into(),
        1 => Mesh::from_convex(&block).expect("a mesh").into(),
        2 => Shape::rounded(block.into(), 0.02).expect("a rounded box").into(),
        _ => block.into(),
    }
}

/// Carts with an object on one of them, above a floor, with random margins and paddings.
fn scene(rng: &mut Rng, is_moving: bool) -> Checker<JointTree> {
    let mut cell = Cell::new();
    let names: Vec<String> = (0..CARTS).map(|k| format!("cart {k}")).collect();
    for name in &names {
        cell.robot_body(name, geometry(rng));
    }
    let floor = Isometry3::translation(0.0, 0.0, -0.35);
    cell.put("floor", HalfSpace::new(Vector3::z(), 0.0).expect("a half-space"), floor);
    let corner =
        |rng: &mut Rng| Isometry3::translation(rng.range(-1.5, 1.5), rng.range(-1.5, 1.5), rng.range(-0.1, 0.1));
    cell.put("post", geometry(rng), corner(rng));
    if is_moving {
        let poses = [corner(rng), corner(rng)];
        cell.put_moving(
            "drone",
            geometry(rng),
            TimedPoses::new(&[0.0, 1.0], &poses).expect("poses"),
        );
    }
    let mut checker = Checker::new(carts(9.0), cell).expect("a world");
    let grip = Isometry3::translation(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), rng.range(-0.1, 0.1));
    let mut cell = checker.cell_mut();
    cell.carry("cart 0", "load", geometry(rng), grip, &["cart 0"]);
    if rng.chance(0.7) {
        cell.set_margin(rng.log_range(1e-3, 0.3)).expect("a margin");
    }
    if rng.chance(0.4) {
        cell.pad(rng.pick(&names).as_str(), rng.log_range(1e-3, 0.3))
            .expect("a padding");
    }
    if rng.chance(0.3) {
        cell.pad("load", rng.log_range(1e-3, 0.2)).expect("a padding");
    }
    if rng.chance(0.5) {
        let margin = Some(rng.log_range(1e-3, 0.6));
        cell.set_pair_margin("cart 1", "cart 2", margin).expect("a margin");
    }
    drop(cell);
    checker
}

/// Judges a configuration: the least excess of a pair over what it must keep.
fn excess(judge: &mut Checker<JointTree>, q: &[f64]) -> f64 {
    let near = judge.nearest(q, f64::INFINITY).expect("a configuration");
    near.iter().fold(f64::INFINITY, |least, n| least.min(n.excess))
}

#[derive(Debug, Default)]
struct Tally {
    free: u32,
    blocked: u32,
    /// Verdicts of two carts that block each other.
    own: u32,
    contacts: u32,
}

fn is_own(verdict: &Verdict) -> bool {
    matches!(verdict, Verdict::Blocked { pair, .. } if !matches!(pair.b, CellBody::Obstacle(_)))
}

fn judged(cases: u64, places: u32, seed: u64) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let mut rng = Rng::of_case(seed, case);
        let mode = case % 5;
        let mut checker = scene(&mut rng, mode == 1);
        let mut judge = Checker::new(carts(9.0), checker.cell().clone()).expect("a world");
        let times = |t: f64| if mode == 1 { Some(t) } else { None };
        // Begin where all distances are kept, or nearly so.
        let within = if mode == 4 { [-0.1, 0.0] } else { [0.0, f64::INFINITY] };
        let mut tries = 0;
        let from = loop {
            let q: Vec<f64> = (0..3 * CARTS).map(|_| rng.range(-1.5, 1.5)).collect();
            if let Some(time) = times(0.0) {
                judge.set_time(time).expect("a pose");
            }
            tries += 1;
            let least = excess(&mut judge, &q);
            if (least > within[0] && least < within[1]) || tries == 200 {
                break q;
            }
        };
        let way = [0.05, 0.3, 1.0][rng.below(3)];
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-way, way)).collect();
        let middle: Vec<f64> = from.iter().map(|x| x + rng.range(-way, way)).collect();
        let curve = bezier(&[from.clone(), middle, to.clone()]);
        let curve = if mode == 1 {
            curve.with_times([0.0, 1.0]).expect("times")
        } else {
            curve
        };
        let radius = rng.log_range(1e-4, 0.1);
        let tube: Vec<f64> = (0..3 * CARTS).map(|_| rng.log_range(1e-4, 0.1)).collect();
        let contact = rng.log_range(1e-4, 0.3);
        let (verdict, proof) = match mode {
            0 => (
                checker.certify(&JointMotion::segment(&from, &to)),
                Some(crate::prove(&mut checker, &JointMotion::segment(&from, &to))),
            ),
            1 => (
                checker.certify(&JointMotion::curve(&curve)),
                Some(crate::prove(&mut checker, &JointMotion::curve(&curve))),
            ),
            2 => (
                checker.certify(&JointMotion::segment(&from, &to).with_radius(radius).expect("a motion")),
                None,
            ),
            3 => (checker.certify(&tubed(&curve, &tube)), None),
            _ => {
                checker.set_start_contact_margin(Some(contact)).expect("a margin");
                (
                    checker.certify(&JointMotion::segment(&from, &to)),
                    Some(crate::prove(&mut checker, &JointMotion::segment(&from, &to))),
                )
            }
        };
        let verdict = verdict.expect("a motion");
        if let Some(proof) = proof {
            let proof = proof.expect("a motion");
            assert_eq!(proof.is_some(), verdict.is_free(), "case {case}: {verdict:?}");
        }
        tally.free += u32::from(verdict.is_free());
        tally.blocked += u32::from(matches!(verdict, Verdict::Blocked { .. }));
        tally.own += u32::from(is_own(&verdict));
        if let Verdict::Free { start_contacts, .. } = &verdict {
            tally.contacts += start_contacts.len() as u32;
            if mode == 4 {
                // Contacts at the start are as brute force finds them.
                for n in judge.nearest(&from, f64::INFINITY).expect("a configuration") {
                    let is_listed = start_contacts.iter().any(|c| c.pair == n.pair);
                    assert!(is_listed || n.excess > -1e-9, "case {case}: {n:?} {contact}");
                }
                continue;
            }
        }
        let until = verdict.free_until();
        for i in 0..=places {
            let t = until * f64::from(i) / f64::from(places);
            if !verdict.is_free() && (mode >= 2 || t >= until) {
                break;
            }
            let mut q = match mode {
                0 | 2 => judge.space().between(&from, &to, t),
                _ => curve.at(t),
            };
            let mut more = 0.0;
            match mode {
                1 => judge.set_time(t).expect("a pose"),
                2 => more = radius,
                3 => {
                    let off = |e: &f64, rng: &mut Rng| e * [-1.0, 1.0, rng.range(-1.0, 1.0)][rng.below(3)];
                    q.iter_mut().zip(&tube).for_each(|(x, e)| *x += off(e, &mut rng));
                }
                _ => {}
            }
            let least = excess(&mut judge, &q);
            assert!(
                least > more - 1e-11,
                "case {case}, mode {mode}, at {t}: {least} {verdict:?}"
            );
        }
    }
    tally
}

#[test]
fn verdicts_of_carts_equal_those_of_all_pairs() {
    let tally = judged(400, 40, 1);
    println!("{tally:?}");
    assert!(tally.free > 100 && tally.own > 20 && tally.contacts > 3, "{tally:?}");
}

#[test]
#[ignore = "2,000 motions at 1,000 places: cargo test --release -p lin-canny-plan --test plan apart -- --ignored --nocapture"]
fn verdicts_of_carts_equal_those_of_all_pairs_at_1000_places() {
    println!("{:?}", judged(2000, 1000, 2));
}

/// Two balls that pass each other along x, at this distance along y.
fn passing(radius: f64, apart: f64) -> (Checker<JointTree>, [Vec<f64>; 2]) {
    let mut cell = Cell::new();
    for k in 0..CARTS {
        cell.robot_body(k, Shape::ball(radius).expect("a ball"));
    }
    let checker = Checker::new(carts(1e2 * radius), cell).expect("a world");
    let far = 50.0 * radius;
    let at = |x: f64| vec![-x, 0.0, 0.0, x, apart, 0.0, far, far, 0.0];
    (checker, [at(radius), at(-radius)])
}

/// The box of a ball is tight, so the boxes of both motions are as far apart as the balls.
#[test]
fn margins_at_the_distance_of_the_boxes_are_decided() {
    let mut rng = Rng::new(3);
    for round in 0..100 {
        let radius = rng.log_range(1e-20, 1e20);
        let gap = radius * rng.log_range(1e-3, 10.0);
        let (mut checker, [from, to]) = passing(radius, 2.0 * radius + gap);
        let curve = bezier(&[&from, &from, &to]);
        let tube = [0.0, 0.5, 0.0].repeat(CARTS);
        for off in [-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1e-3] {
            let kept = gap * (1.0 + off);
            let expected = off < 0.0;
            let mut found = Vec::new();
            checker.cell_mut().set_margin(kept).expect("a margin");
            found.push(checker.certify(&JointMotion::segment(&from, &to)));
            found.push(checker.certify(&JointMotion::curve(&curve)));
            let is_proven = crate::prove(&mut checker, &JointMotion::segment(&from, &to))
                .expect("a motion")
                .is_some();
            checker.cell_mut().set_margin(0.0).expect("a margin");
            // A tube counts twice for two movers, once for each; the tube of joints as it is.
            found.push(
                checker.certify(
                    &JointMotion::segment(&from, &to)
                        .with_radius(0.5 * kept)
                        .expect("a motion"),
                ),
            );
            let tube: Vec<f64> = tube.iter().map(|x| x * kept).collect();
            found.push(checker.certify(&tubed(&curve, &tube)));
            checker
                .cell_mut()
                .set_pair_margin("0", "1", Some(kept))
                .expect("a margin");
            found.push(checker.certify(&JointMotion::segment(&from, &to)));
            checker.cell_mut().set_pair_margin("0", "1", None).expect("a margin");
            for name in ["0", "1"] {
                checker.cell_mut().pad(name, 0.5 * kept).expect("a padding");
            }
            found.push(checker.certify(&JointMotion::segment(&from, &to)));
            for name in ["0", "1"] {
                checker.cell_mut().pad(name, 0.0).expect("a padding");
            }
            for (k, verdict) in found.into_iter().enumerate() {
                let verdict = verdict.expect("a motion");
                if off != 0.0 {
                    assert_eq!(verdict.is_free(), expected, "{round} {k} {off:e}: {verdict:?}");
                } else if k < 2 {
                    assert_eq!(verdict.is_free(), is_proven, "{round} {k}: {verdict:?}");
                }
            }
        }
    }
}

/// A pair that starts within its margin, and within that of contacts, is accepted and listed, although its boxes are apart.
#[test]
fn contacts_at_the_start_are_listed_up_to_their_margin() {
    let mut rng = Rng::new(4);
    for _ in 0..50 {
        let radius = rng.log_range(1e-10, 1e10);
        let gap = radius * rng.log_range(1e-3, 3.0);
        let (mut checker, [from, _]) = passing(radius, 2.0 * radius + gap);
        let from: Vec<f64> = from
            .iter()
            .enumerate()
            .map(|(k, x)| if k % 3 == 0 && k < 6 { 0.0 } else { *x })
            .collect();
        let mut to = from.clone();
        to[4] += radius;
        for (margin, contact) in [
            (0.0, 1.01),
            (0.5, 1.01),
            (1.5, 1.01),
            (0.5, 0.99),
            (0.0, 0.99),
            (1.5, 0.99),
        ] {
            checker.cell_mut().set_margin(margin * gap).expect("a margin");
            checker.set_start_contact_margin(Some(contact * gap)).expect("a margin");
            let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
            assert_eq!(
                verdict.is_free(),
                contact > 1.0 || margin < 1.0,
                "{margin} {contact}: {verdict:?}"
            );
            if let Verdict::Free { start_contacts, .. } = verdict {
                assert_eq!(start_contacts.len(), usize::from(margin > 1.0), "{margin} {contact}");
            }
        }
    }
}
