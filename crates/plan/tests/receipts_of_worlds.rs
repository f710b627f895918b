//! Promise: a motion that is proven free has a receipt, whatever stands in its world, and both checkers accept it with
//! the same text. A motion that is blocked has one if its contact is a matter of points.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::ConvexPolyhedron;
use lin_canny::shape::Core;
use lin_canny::{Cloud, CloudElement, Compound, Geometry, HalfSpace, Mesh, MeshKind, Piece, Shape};
use lin_canny_plan::receipt::{Receipt, ReceiptError};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, Joint, JointMotion, JointTree, RangeOptions, RangeProver, TimedPoses, Verdict,
};
use truth::plans::{Ask, Furnish, bezier};
use truth::rng::Rng;
use truth::support::piece_at;

#[path = "../../verify/tests/support/python.rs"]
#[allow(dead_code, reason = "the checkers' own tests use all of it")]
mod python;

fn direction(rng: &mut Rng) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| rng.range(-1.0, 1.0));
        if (0.1..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

fn pose(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    let turn = rng.range(-3.0, 3.0) * direction(rng);
    Isometry3::new(direction(rng) * far, turn)
}

fn hull(rng: &mut Rng, size: f64) -> ConvexPolyhedron {
    let points: Vec<Point3<f64>> = (0..8).map(|_| Point3::from(size * direction(rng))).collect();
    ConvexPolyhedron::from_points(&points).expect("a hull")
}

/// A convex shape of each kind that has a receipt.
fn shape(rng: &mut Rng, size: f64) -> Shape {
    let [r, h] = [rng.range(0.2, 1.0) * size, rng.range(0.2, 1.0) * size];
    let shape = match rng.below(7) {
        0 => Ok(Shape::from(hull(rng, size))),
        1 => Shape::cylinder(h, r),
        2 => Shape::cone(h, r),
        3 => Shape::capsule(h, 0.5 * r),
        4 => Shape::cylinder(h, r).and_then(|shape| shape.rounded(0.1 * r)),
        5 => Shape::ellipsoid(Vector3::new(h, r, 0.5 * (h + r))),
        _ => Shape::ball(r),
    };
    shape.expect("a shape")
}

/// A patch, polynomial or rational, flat, bent or folded.
#[cfg(feature = "surfaces")]
fn surface(rng: &mut Rng, size: f64) -> lin_canny::surface::BezierSurface {
    use lin_canny::surface::{BezierPatch, BezierSurface};
    let degrees = [1 + rng.below(3), 1 + rng.below(3)];
    let count = (degrees[0] + 1) * (degrees[1] + 1);
    let thick = [0.0, 0.3, 1.0][rng.below(3)];
    let point = |k: usize, rng: &mut Rng| {
        let part = |i: usize, n: usize| (2.0 * i as f64 / n as f64 - 1.0) * (1.0 - 0.5 * thick);
        let (u, v) = (k / (degrees[1] + 1), k % (degrees[1] + 1));
        let at = Vector3::new(part(u, degrees[0]), part(v, degrees[1]), 0.0);
        Point3::from(size * (at + thick * Vector3::from_fn(|_, _| rng.range(-0.5, 0.5))))
    };
    let points: Vec<Point3<f64>> = (0..count).map(|k| point(k, rng)).collect();
    let patch = match rng.below(2) {
        0 => BezierPatch::polynomial(degrees, &points),
        _ => {
            let weights: Vec<f64> = (0..count).map(|_| rng.range(0.3, 2.0)).collect();
            BezierPatch::rational(degrees, &points, &weights)
        }
    };
    BezierSurface::new(vec![patch.expect("a patch")]).expect("a surface")
}

/// A body of any kind that has a receipt and an end.
fn body(rng: &mut Rng, size: f64) -> Geometry {
    let points = |rng: &mut Rng, count: usize| -> Vec<Point3<f64>> {
        let point = |_| Point3::from(Vector3::from_fn(|_, _| rng.range(-size, size)));
        (0..count).map(point).collect()
    };
    match rng.below(11) {
        #[cfg(feature = "surfaces")]
        10 => surface(rng, size).into(),
        0 => {
            let pieces = (0..2).map(|_| piece_at(pose(rng, 0.5 * size), shape(rng, 0.5 * size)));
            Compound::new(pieces.collect()).expect("a compound").into()
        }
        1 => Cloud::new(&points(rng, 8), CloudElement::Ball(0.1 * size))
            .expect("a cloud")
            .into(),
        2 => {
            let half = CloudElement::Box(Vector3::repeat(0.1 * size));
            Cloud::new(&points(rng, 5), half).expect("a cloud").into()
        }
        3 => {
            let heights: Vec<f64> = (0..9).map(|_| rng.range(0.0, 0.5) * size).collect();
            let base = (rng.below(2) == 0).then_some(-0.5 * size);
            Mesh::from_heights(3, 3, [0.6 * size; 2], &heights, base)
                .expect("a field")
                .into()
        }
        4 => {
            let piece = Piece::new(Shape::from(hull(rng, size)));
            let compound = Compound::new(vec![piece]).expect("a piece");
            compound.to_mesh().expect("a mesh").into()
        }
        5..=7 => hull(rng, size).into(),
        _ => shape(rng, size).into(),
    }
}

/// Poses of an obstacle at some of the times from 0 to 3: it shifts, turns, does both or waits from each to the next.
fn poses(rng: &mut Rng) -> TimedPoses {
    let mut times = vec![-1.0];
    let far = rng.range(0.3, 2.0);
    let mut poses = vec![pose(rng, far)];
    for time in [0.0, rng.range(0.1, 1.0), 1.0, rng.range(1.1, 2.9), 4.0] {
        if time == 4.0 || rng.below(2) == 0 {
            let (last, next) = (poses[poses.len() - 1], pose(rng, far));
            let shift = if rng.below(3) == 0 {
                last.translation
            } else {
                next.translation
            };
            let turn = if rng.below(3) == 0 {
                last.rotation
            } else {
                next.rotation
            };
            poses.push(Isometry3::from_parts(shift, turn));
            times.push(time);
        }
    }
    TimedPoses::new(&times, &poses).expect("timed poses")
}

/// A robot of a few links in a world: paddings, margins, excluded pairs, bodies that touch at rest, and obstacles that
/// move if there are times.
fn world(rng: &mut Rng, has_times: bool) -> Checker<JointTree> {
    let joints = 1 + rng.below(4);
    let joint = |k: usize, rng: &mut Rng| -> Vec<Joint> {
        let origin = Isometry3::translation(if k == 0 { 0.0 } else { 0.8 }, 0.0, 0.0);
        let axis = UnitQuaternion::from_scaled_axis(direction(rng)) * Vector3::z_axis();
        match rng.below(4) {
            0 => vec![Joint::prismatic(origin, axis, [-1.0, 1.0])],
            1 => Joint::ball(origin, [-3.0, 3.0]).to_vec(),
            _ => vec![Joint::revolute(origin, axis, [-3.0, 3.0])],
        }
    };
    let mut chain: Vec<Joint> = Vec::new();
    // The link of the tree that each joint moves: a ball joint is three joints.
    let mut links = vec![0];
    for k in 0..joints {
        chain.extend(joint(k, rng));
        links.push(chain.len());
    }
    let (mut cell, mut on) = (Cell::new(), Vec::new());
    let is_alone = rng.below(12) == 0;
    let first = usize::from(rng.below(2) == 0);
    for k in first..=joints {
        cell.robot_body(format!("link {k}"), body(rng, 0.3));
        on.push(links[k]);
    }
    if !is_alone {
        let tilt = UnitQuaternion::from_scaled_axis(rng.range(0.0, 0.3) * direction(rng));
        let floor = HalfSpace::new(tilt * Vector3::z(), rng.range(-3.0, -0.2)).expect("a plane");
        // The base may stand in it.
        cell.put("floor", floor, pose(rng, 0.0));
        for k in 0..rng.below(6) {
            let far = rng.range(0.2, 2.0);
            cell.put(format!("part {k}"), body(rng, 0.3), pose(rng, far));
        }
        for k in 0..if has_times { 1 + rng.below(2) } else { 0 } {
            let wall = HalfSpace::new(direction(rng), rng.range(-4.0, -0.5)).expect("a plane");
            let body = if rng.below(4) == 0 { wall.into() } else { body(rng, 0.2) };
            let poses = poses(rng);
            cell.put_moving(format!("cart {k}"), body, poses);
        }
        if rng.below(3) == 0 {
            cell.pad("floor", 0.02).expect("a padding");
        }
        if rng.below(3) == 0 {
            cell.set_margin(0.01).expect("a margin");
            let last = format!("link {joints}");
            cell.set_pair_margin(&last, "floor", Some(0.05)).expect("a pair");
        }
    }
    for k in first..joints {
        cell.exclude(&format!("link {k}"), &format!("link {}", k + 1))
            .expect("a pair");
    }
    // Moving obstacles are carried in the frame of the world.
    let base = if has_times {
        pose(rng, 0.0)
    } else {
        Isometry3::identity()
    };
    let tree = JointTree::serial(base, chain, on, 5.0).expect("a tree");
    let mut checker = Checker::new(tree, cell).expect("a world");
    if rng.below(3) == 0 {
        checker.set_start_contact_margin(Some(0.05)).expect("a margin");
    }
    checker
}

fn motion(rng: &mut Rng, joints: usize) -> JointMotion {
    let most = [0.1, 0.4, 1.0][rng.below(3)];
    let mut rows = vec![(0..joints).map(|_| rng.range(-0.9, 0.9)).collect::<Vec<f64>>()];
    for _ in 0..1 + rng.below(3) {
        let last = &rows[rows.len() - 1];
        rows.push(
            last.iter()
                .map(|x| (x + rng.range(-most, most)).clamp(-1.0, 1.0))
                .collect(),
        );
    }
    match rng.below(3) {
        0 => JointMotion::segment(&rows[0], &rows[1]),
        1 => JointMotion::path(&rows).expect("a path"),
        _ => JointMotion::curve(&bezier(&rows)),
    }
}

/// Whether a body has points that a contact can be proven by: a closed mesh may hold the other body inside.
fn has_points(geometry: &Geometry) -> bool {
    let is_hull = |shape: &Shape| matches!(shape.core(), Core::Polyhedron(_));
    match geometry {
        Geometry::Polyhedron(_) | Geometry::Cloud(_) | Geometry::HalfSpace(_) => true,
        Geometry::Mesh(mesh) => mesh.kind() != MeshKind::Solid,
        Geometry::Convex(shape) => is_hull(shape),
        Geometry::Compound(compound) => compound.pieces().iter().all(|piece| is_hull(&piece.shape)),
        _ => false,
    }
}

/// Judges random motions; returns how many are free, free without a pair that moves, blocked with a receipt, blocked
/// by a body without points, and undecided.
fn judge(seeds: std::ops::Range<u64>, has_times: bool) -> [usize; 5] {
    let mut counts = [0; 5];
    for seed in seeds {
        let mut rng = Rng::new(seed);
        let mut checker = world(&mut rng, has_times);
        let mut motion = motion(&mut rng, checker.space().bounds().len());
        if has_times {
            let times: Vec<f64> = (0..=motion.pieces())
                .map(|k| 3.0 * k as f64 / motion.pieces() as f64)
                .collect();
            motion = motion.with_times(&times).expect("times");
        }
        if rng.below(6) == 0 {
            motion = motion.with_radius(rng.range(0.001, 0.05)).expect("a tube");
        }
        let verdict = checker.verdict_of(&motion);
        let receipt = Receipt::motion(&mut checker, &motion);
        let receipt = match (&verdict, receipt) {
            (Verdict::Free { .. }, Ok(receipt)) => {
                counts[0] += 1;
                receipt
            }
            (Verdict::Free { .. }, Err(ReceiptError::Nothing)) => {
                counts[1] += 1;
                continue;
            }
            (Verdict::Blocked { .. }, Err(ReceiptError::Blocked { .. })) if motion.pieces() > 1 => continue,
            (Verdict::Blocked { .. }, Ok(receipt)) => {
                counts[2] += 1;
                receipt
            }
            (Verdict::Blocked { pair, .. }, Err(error @ ReceiptError::Pair { .. })) => {
                let bodies = [pair.a, pair.b].map(|id| checker.cell().geometry(id).expect("a body"));
                assert!(
                    !bodies.iter().all(|body| has_points(body)),
                    "{seed}: {error} {verdict:?}"
                );
                counts[3] += 1;
                continue;
            }
            (Verdict::Undecided { .. }, Err(ReceiptError::Undecided { .. })) => {
                counts[4] += 1;
                continue;
            }
            (verdict, receipt) => panic!("{seed}: {verdict:?} {:?}", receipt.err()),
        };
        is_accepted(seed, &receipt);
    }
    counts
}

/// Both checkers accept a receipt, and print the same about it.
fn is_accepted(seed: u64, receipt: &Receipt) {
    let (code, said) = python::judged(&receipt.to_string());
    assert_eq!(code, 0, "{seed}: {said}");
}

/// Judges random ranges: pairs that never meet in small boxes of joint values. Returns how many receipts there are, and
/// how many ranges without a pair that is proven.
fn judge_ranges(seeds: std::ops::Range<u64>) -> [usize; 2] {
    let mut counts = [0; 2];
    for seed in seeds {
        let mut rng = Rng::new(seed);
        let mut checker = world(&mut rng, false);
        let half = rng.range(0.01, 0.15);
        let middle: Vec<f64> = (0..checker.space().bounds().len())
            .map(|_| rng.range(-0.8, 0.8))
            .collect();
        let [low, high] = [-half, half].map(|by| middle.iter().map(|x| x + by).collect::<Vec<f64>>());
        let options = RangeOptions::default().cells(500);
        let answers = RangeProver::new(&options).all_pairs(&mut checker, &low, &high);
        match Receipt::range(&checker, &answers.expect("a range"), 2_000) {
            Ok(receipt) => {
                is_accepted(seed, &receipt);
                counts[0] += 1;
            }
            Err(ReceiptError::Nothing | ReceiptError::Plan(_)) => counts[1] += 1,
            Err(error) => panic!("{seed}: {error}"),
        }
    }
    counts
}

#[test]
fn ranges_of_random_worlds_have_receipts() {
    let counts = judge_ranges(0..30);
    println!("ranges with a receipt, without a proven pair: {counts:?}");
    assert!(counts[0] > 10, "{counts:?}");
}

#[test]
fn motions_of_random_worlds_have_receipts() {
    let counts = judge(0..100, false);
    println!("{COUNTED} {counts:?}");
    // Floors, cylinders, clouds, resting pairs: a writer of polyhedra alone had few of them.
    assert!(counts[0] > 40 && counts[1] > 0 && counts[2] > 5, "{counts:?}");
    let counts = judge(0..60, true);
    println!("{COUNTED} {counts:?}");
    assert!(counts[0] > 20 && counts[2] > 5, "{counts:?}");
}

const COUNTED: &str = "free, without a pair, blocked, without points, undecided:";

#[test]
#[ignore = "10,000 worlds take minutes: cargo test -p lin-canny-plan --all-features --test receipts_of_worlds -- --ignored --nocapture"]
fn many_motions_of_random_worlds_have_receipts() {
    println!("{COUNTED} {:?}", judge(0..10_000, false));
    println!("{COUNTED} {:?}, obstacles that move", judge(0..10_000, true));
}
