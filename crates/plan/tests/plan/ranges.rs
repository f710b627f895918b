//! Proofs over ranges of joints, against samples, searches for the minimum, and cases with known answers.

use core::ops::{ControlFlow, Range};

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ConvexPolyhedron, Geometry, HalfSpace, PairTracker, Piece, RelativePose, Shape};
use lin_canny_plan::{
    Cell, CellBody, Checker, ClearanceWidth, ConfigurationSpace, Drive, Joint, JointKind, JointTree, PlanError,
    PlanarSpace, RangeAnswer, RangeOptions, RangeProver, RangeVerdict, RigidSpace, TreeJoint,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use truth::cells::ArmCell;
use truth::plans::{self, Ask, Furnish, cuboid, place_of};
use truth::rng::Rng;

pub(crate) const A: CellBody = CellBody::Robot(0);
pub(crate) const B: CellBody = CellBody::Robot(1);

fn unit(rng: &mut Rng) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::from_fn(|_, _| rng.range(-1.0, 1.0)) + Vector3::repeat(1e-3))
}

pub(crate) fn pose(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&unit(rng), rng.range(-3.0, 3.0));
    let at = Vector3::from_fn(|_, _| rng.range(-far, far));
    Isometry3::from_parts(Translation3::from(at), turn)
}

/// A body of a random kind.
fn body(rng: &mut Rng, size: f64, seed: u64) -> Geometry {
    let half = Vector3::from_fn(|_, _| size * rng.range(0.1, 0.4));
    match rng.range(0.0, 7.0) as u32 {
        0 => Shape::ball(half.x).expect("a ball").into(),
        1 => Shape::capsule(half.x, half.y).expect("a capsule").into(),
        2 => Shape::cylinder(half.x, half.y).expect("a cylinder").into(),
        3 => Shape::cuboid(half)
            .expect("a box")
            .rounded(0.1 * half.x)
            .expect("a shape")
            .into(),
        4 => solids::cuboid(half).expect("a box").into(),
        _ => solids::random_hull(20, half, seed).expect("a hull").into(),
    }
}

/// Two bodies on a tree with up to five joints between them: turns and slides, some of which mimic others, on both sides
/// of the link that both hang on.
pub(crate) fn robot(rng: &mut Rng, size: f64, seed: u64) -> (JointTree, Cell) {
    let count = 2 + rng.range(0.0, 4.0) as usize;
    let fork = rng.range(0.0, count as f64) as usize;
    let coordinates = count.min(1 + rng.range(0.0, count as f64) as usize);
    let joint = |index: usize, rng: &mut Rng| TreeJoint {
        parent: if index == fork { 0 } else { index },
        kind: if rng.range(0.0, 1.0) < 0.7 {
            JointKind::Revolute
        } else {
            JointKind::Prismatic
        },
        origin: pose(rng, 0.6 * size),
        axis: unit(rng),
        drive: Some(Drive {
            coordinate: index % coordinates,
            factor: if index < coordinates { 1.0 } else { rng.range(-1.5, 1.5) },
            offset: if index < coordinates { 0.0 } else { rng.range(-0.5, 0.5) },
        }),
    };
    let mut joints: Vec<TreeJoint> = (0..count).map(|k| joint(k, rng)).collect();
    // A slide moves by lengths of the robot; a coordinate with a turn is an angle.
    for joint in &mut joints {
        if joint.kind == JointKind::Prismatic {
            let drive = joint.drive.as_mut().expect("a drive");
            (drive.factor, drive.offset) = (0.2 * size * drive.factor, 0.2 * size * drive.offset);
        }
    }
    let limits = vec![[-3.0, 3.0]; coordinates];
    let radii = vec![size; count + 1];
    // Both bodies at the ends of the branches; on a chain from the base to its end.
    let links = vec![fork, count];
    let tree = JointTree::new(Isometry3::identity(), joints, limits, links, radii).expect("a tree");
    let mut cell = Cell::new();
    cell.robot_body("a", body(rng, size, seed));
    cell.robot_body("b", body(rng, size, seed + 1));
    (tree, cell)
}

/// Bounds and predicates of the two bodies at single configurations.
struct Oracle<'a, C> {
    space: &'a C,
    shapes: [&'a Geometry; 2],
    tracker: PairTracker,
}

impl<'a, C: ConfigurationSpace> Oracle<'a, C> {
    fn new(space: &'a C, cell: &'a Cell) -> Self {
        let mut bodies = cell.robot_bodies().map(|b| b.1);
        let shapes = [(); 2].map(|()| bodies.next().expect("two bodies"));
        let tracker = PairTracker::new();
        Self { space, shapes, tracker }
    }

    fn pose(&self, q: &[f64]) -> RelativePose {
        let mut poses = Vec::new();
        self.space.place(q, &mut poses);
        RelativePose::new(&poses[0], &poses[1]).expect("poses")
    }

    /// An upper bound of the distance.
    fn upper(&mut self, q: &[f64]) -> f64 {
        let pose = self.pose(q);
        self.tracker.closest(self.shapes[0], self.shapes[1], &pose).upper
    }

    fn is_within(&mut self, q: &[f64], d: f64) -> bool {
        let pose = self.pose(q);
        self.tracker.within(self.shapes[0], self.shapes[1], &pose, d)
    }
}

/// Random ranges: products of two uniform shares of the limits.
pub(crate) fn ranges(rng: &mut Rng, limits: &[[f64; 2]]) -> [Vec<f64>; 2] {
    let of = |[low, high]: [f64; 2], rng: &mut Rng| {
        let width = (high - low) * rng.range(0.0, 1.0) * rng.range(0.0, 1.0);
        let low = low + (high - low - width) * rng.range(0.0, 1.0);
        [low, (low + width).min(high)]
    };
    let both: Vec<[f64; 2]> = limits.iter().map(|ends| of(*ends, rng)).collect();
    [0, 1].map(|k| both.iter().map(|ends| ends[k]).collect())
}

pub(crate) fn at(rng: &mut Rng, [low, high]: [&[f64]; 2]) -> Vec<f64> {
    let each = low.iter().zip(high);
    // Every third number is an end.
    each.map(|(low, high)| match rng.range(0.0, 3.0) as u32 {
        0 if rng.range(0.0, 1.0) < 0.5 => *low,
        0 => *high,
        _ => rng.range(*low, *high).clamp(*low, *high),
    })
    .collect()
}

/// Checks an answer by samples and by a search for the least distance from the nearest of them.
fn judge<C: ConfigurationSpace>(
    oracle: &mut Oracle<'_, C>,
    answer: &RangeAnswer,
    kept: f64,
    samples: u32,
    rng: &mut Rng,
) {
    let [low, high]: [Vec<f64>; 2] = [0, 1].map(|k| answer.range.iter().map(|ends| ends[k]).collect());
    match &answer.verdict {
        RangeVerdict::Both { free, touching } => {
            assert!(!oracle.is_within(free, kept), "{answer:?}");
            assert!(oracle.is_within(touching, kept), "{answer:?}");
        }
        RangeVerdict::Always => {
            for _ in 0..samples {
                let q = at(rng, [&low, &high]);
                assert!(oracle.is_within(&q, kept), "free at {q:?}: {answer:?}");
            }
        }
        RangeVerdict::Never => {
            assert!(answer.lower > kept || low == high, "{answer:?}");
            let attained = oracle.upper(&answer.at);
            assert!(
                attained <= answer.upper * (1.0 + 1e-12) || answer.upper == f64::INFINITY,
                "{answer:?}"
            );
            least(oracle, answer, [&low, &high], samples, rng);
        }
        RangeVerdict::Open { .. } => least(oracle, answer, [&low, &high], samples / 10, rng),
        other => panic!("{other:?}"),
    }
}

/// Checks that no configuration found by samples and descents is closer than the lower bound.
fn least<C: ConfigurationSpace>(
    oracle: &mut Oracle<'_, C>,
    answer: &RangeAnswer,
    [low, high]: [&[f64]; 2],
    samples: u32,
    rng: &mut Rng,
) {
    let mut best = (f64::INFINITY, low.to_vec());
    for _ in 0..samples {
        let q = at(rng, [low, high]);
        let upper = oracle.upper(&q);
        if upper < best.0 {
            best = (upper, q);
        }
    }
    let (mut step, mut tries) = (0.2, 0);
    while step > 1e-7 && tries < 2_000 {
        let mut is_lower = false;
        for k in 0..low.len() {
            for sign in [-step, step] {
                let mut q = best.1.clone();
                q[k] = (q[k] + sign * (high[k] - low[k])).clamp(low[k], high[k]);
                tries += 1;
                let upper = oracle.upper(&q);
                if upper < best.0 {
                    (best, is_lower) = ((upper, q), true);
                }
            }
        }
        step *= if is_lower { 1.0 } else { 0.5 };
    }
    // The depth of an overlap counts as no distance.
    assert!(
        best.0.max(0.0) >= answer.lower,
        "{} at {:?}: {answer:?}",
        best.0,
        best.1
    );
}

/// Checks four random boxes of each random robot; returns how many of each verdict.
fn random_boxes(robots: Range<u64>, samples: u32, seed: u64) -> [u32; 4] {
    let mut tally = [0; 4];
    for k in robots {
        let mut rng = Rng::new(seed + k);
        let size = [1.0, 1e-6, 1e6, 1e-95, 1e95][(k % 5) as usize];
        let (tree, cell) = robot(&mut rng, size, seed + k);
        let kept = if k % 4 == 3 { 0.05 * size } else { 0.0 };
        let mut checker = Checker::new(tree.clone(), cell.clone()).expect("a robot");
        checker.cell_mut().set_margin(kept).expect("a margin");
        let mut oracle = Oracle::new(&tree, &cell);
        for turn in 0..4 {
            let [low, high] = ranges(&mut rng, tree.bounds());
            let mut options = RangeOptions::default().cells(1_000);
            if turn == 0 {
                options = options.width(ClearanceWidth::Share(0.1));
            }
            let answer = checker.answer_over(&options, [A, B], &low, &high);
            judge(&mut oracle, &answer, kept, samples, &mut rng);
            if turn == 0 && answer.is_never() {
                assert!(
                    answer.lower >= 0.899 * answer.upper || answer.lower >= kept,
                    "{answer:?}"
                );
            }
            tally[place_of(&answer.verdict)] += 1;
        }
        if (k + 1) % 50 == 0 {
            println!("robots to {k}: {tally:?} boxes never, always, both, open");
        }
    }
    tally
}

#[test]
fn verdicts_over_random_boxes_hold_at_samples() {
    let tally = random_boxes(0..50, 100, 1);
    assert!(tally[0] > 60 && tally[2] > 10 && tally[3] < 40, "{tally:?}");
}

#[test]
#[ignore = "twenty thousand boxes at ten thousand samples each: cargo test --release -p lin-canny-plan --test plan twenty_thousand_boxes -- --ignored"]
fn verdicts_over_twenty_thousand_boxes_hold_at_samples() {
    random_boxes(crate::chosen_robots(0..5_000), 10_000, 1_000);
}

/// A body on joints, and an obstacle.
pub(crate) fn moved(joints: Vec<Joint>, body: impl Into<Geometry>, other: impl Into<Geometry>) -> Checker<JointTree> {
    let links = vec![joints.len()];
    let arm = JointTree::serial(Isometry3::identity(), joints, links, 1.0).expect("an arm");
    let mut cell = Cell::new();
    cell.robot_body("body", body);
    cell.put("other", other, Isometry3::identity());
    Checker::new(arm, cell).expect("a world")
}

pub(crate) const OTHER: CellBody = CellBody::Obstacle(0);

pub(crate) fn cube(half: f64) -> ConvexPolyhedron {
    cuboid([half; 3])
}

pub(crate) fn slide(axis: Unit<Vector3<f64>>, limits: [f64; 2]) -> Joint {
    Joint::prismatic(Isometry3::identity(), axis, limits)
}

#[test]
fn a_range_of_no_width_is_a_configuration() {
    let mut rng = Rng::new(5);
    let mut tally = [0; 2];
    for k in 0..60 {
        let (tree, cell) = robot(&mut rng, 1.0, k);
        let mut checker = Checker::new(tree.clone(), cell).expect("a robot");
        let q: Vec<f64> = tree.bounds().iter().map(|[low, high]| rng.range(*low, *high)).collect();
        let is_free = checker.is_free_at(&q).expect("a configuration");
        let answer = checker.answer_over(&RangeOptions::default(), [A, B], &q, &q);
        let verdict = if is_free {
            RangeVerdict::Never
        } else {
            RangeVerdict::Always
        };
        assert_eq!((answer.verdict, answer.cells), (verdict, 1));
        tally[usize::from(is_free)] += 1;
    }
    assert!(tally.iter().all(|n| *n > 4), "{tally:?}");
}

#[test]
fn boxes_that_touch_at_one_end_of_a_slide_do_both() {
    for (from, name) in [(2.0, "touch"), (2.0 + 1e-9, "never")] {
        let mut checker = moved(vec![slide(Vector3::x_axis(), [2.0, 5.0])], cube(1.0), cube(1.0));
        let options = RangeOptions::default();
        let answer = checker.answer_over(&options, [A, OTHER], &[from], &[5.0]);
        match answer.verdict {
            RangeVerdict::Both { touching, .. } => assert_eq!((name, touching), ("touch", vec![2.0])),
            RangeVerdict::Never => assert!(name == "never" && answer.lower <= 1e-9),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn boxes_that_touch_at_one_inner_configuration_are_never_free() {
    // An edge passes over a face of the other box, and touches it at one angle.
    let edge = cube(1.0)
        .transformed(&Isometry3::rotation(Vector3::z() * (0.25 * PI)))
        .expect("a box");
    let far = Isometry3::translation(2.0, 0.0, 0.0);
    let edge = edge.transformed(&far).expect("a box");
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-1.0, 1.0]);
    let mut checker = moved(vec![turn], edge, cube(1.0));
    checker.cell_mut().set_margin(0.3).expect("a margin");
    let options = RangeOptions::default().cells(300);
    let answer = checker.answer_over(&options, [A, OTHER], &[-0.1], &[0.1]);
    assert!(!answer.is_never() || answer.lower > 0.3, "{answer:?}");
}

#[test]
fn full_turns_and_more_are_one_turn() {
    // A rod that turns beside a post.
    let rod = |from: f64| {
        let rod = cuboid([0.4, 0.05, 0.05]);
        rod.transformed(&Isometry3::translation(0.5 + from, 0.0, 0.0))
            .expect("a rod")
    };
    let post = |x: f64| {
        cube(0.1)
            .transformed(&Isometry3::translation(x, 0.0, 0.0))
            .expect("a post")
    };
    for turns in [1.0, 1.0 - 1e-15, 2.0, 100.0, 1e6] {
        let limit = turns * PI;
        let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-limit, limit]);
        let options = RangeOptions::default();
        let mut never = moved(vec![turn.clone()], rod(0.0), post(1.2));
        let answer = never.answer_over(&options, [A, OTHER], &[-limit], &[limit]);
        assert!(answer.is_never() && answer.cells < 40, "{turns}: {answer:?}");
        let mut both = moved(vec![turn], rod(0.0), post(0.95));
        let answer = both.answer_over(&options, [A, OTHER], &[-limit], &[limit]);
        assert!(
            matches!(answer.verdict, RangeVerdict::Both { .. }),
            "{turns}: {answer:?}"
        );
    }
}

#[test]
fn links_that_overlap_about_their_joint_always_meet() {
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-TAU, TAU]);
    let rod = cuboid([0.5, 0.1, 0.1]);
    for shape in [
        Geometry::from(rod.clone()),
        Shape::from(rod).rounded(0.01).expect("a shape").into(),
    ] {
        let mut checker = moved(vec![turn.clone(), turn.clone()], shape, cube(0.2));
        let answer = checker.answer_over(&RangeOptions::default(), [A, OTHER], &[-TAU; 2], &[TAU; 2]);
        assert_eq!((answer.verdict, answer.cells), (RangeVerdict::Always, 1));
    }
}

#[test]
fn a_width_that_is_negative_is_an_error() {
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-1.0, 1.0]);
    let mut checker = moved(vec![turn], cube(0.1), cube(0.1));
    for width in [ClearanceWidth::Length(-0.5), ClearanceWidth::Share(f64::NAN)] {
        let options = RangeOptions::default().width(width);
        let found = RangeProver::new(&options).pair(&mut checker, A, OTHER, &[-1.0], &[1.0]);
        let words = "width of the clearance is out of range: ";
        assert!(found.expect_err("a width").to_string().starts_with(words));
    }
}

#[test]
fn bodies_of_one_link_are_one_cell() {
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-1.0, 1.0]);
    let arm = JointTree::serial(Isometry3::identity(), vec![turn], vec![1, 1], 1.0).expect("an arm");
    for (x, verdict) in [(1.0, RangeVerdict::Always), (2.5, RangeVerdict::Never)] {
        let mut cell = Cell::new();
        cell.robot_body("a", cube(1.0));
        cell.robot_body(
            "b",
            cube(1.0)
                .transformed(&Isometry3::translation(x, 0.0, 0.0))
                .expect("a box"),
        );
        let mut checker = Checker::new(arm.clone(), cell).expect("a world");
        let answer = checker.answer_over(&RangeOptions::default(), [B, A], &[-1.0], &[1.0]);
        assert_eq!((answer.verdict, answer.coordinates, answer.cells), (verdict, vec![], 1));
        // Pairs that keep their pose are not measured.
        assert_eq!(checker.answers_over(&RangeOptions::default(), &[-1.0], &[1.0]), []);
    }
}

#[test]
fn a_pair_that_stays_closer_than_its_margin_always_meets() {
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-PI, PI]);
    let mut checker = moved(
        vec![turn],
        Shape::ball(0.5).expect("a ball"),
        cube(0.5)
            .transformed(&Isometry3::translation(1.1, 0.0, 0.0))
            .expect("a box"),
    );
    for (margin, verdict) in [(0.05, RangeVerdict::Never), (0.15, RangeVerdict::Always)] {
        checker.cell_mut().set_margin(margin).expect("a margin");
        let answer = checker.answer_over(&RangeOptions::default(), [A, OTHER], &[-PI], &[PI]);
        assert_eq!(answer.verdict, verdict, "{answer:?}");
    }
}

#[test]
fn a_block_in_the_plane_keeps_off_a_post() {
    let space = PlanarSpace::new([[-5.0, 5.0]; 2], 1.5, 1).expect("a space");
    let mut cell = Cell::new();
    cell.robot_body("block", cube(1.0));
    cell.put("post", cube(1.0), Isometry3::identity());
    let mut checker = Checker::new(space, cell).expect("a world");
    let width = ClearanceWidth::Length(1e-3);
    let options = RangeOptions::default().width(width);
    let answer = checker.answer_over(&options, [A, OTHER], &[3.0, -1.0, -4.0], &[5.0, 1.0, 4.0]);
    // A corner of the block points at the post.
    let truth = 2.0 - 2f64.sqrt();
    assert!(answer.is_never(), "{answer:?}");
    assert!(answer.lower <= truth, "{answer:?}");
    assert!(truth <= answer.upper + 1e-12, "{answer:?}");
    assert!(answer.upper - answer.lower <= 1e-3, "{answer:?}");
    let error = RangeProver::new(&options).pair(&mut checker, A, OTHER, &[3.0, 0.0, 0.0], &[3.0, 0.0, 1e4]);
    assert_eq!(error, Err(PlanError::Coordinate { index: 2, value: 1e4 }));
}

#[test]
fn fingers_that_mimic_each_other_keep_their_distance() {
    // Both slide by the same coordinate, so the gap is constant; a bound of each alone would lose it.
    let finger = |y: f64| plans::slide(0, Isometry3::translation(0.0, y, 0.0), Vector3::x_axis(), 0);
    let joints = vec![finger(0.0), finger(2.1)];
    let tree = JointTree::new(
        Isometry3::identity(),
        joints,
        vec![[0.0, 100.0]],
        vec![1, 2],
        vec![1.0; 3],
    )
    .expect("a tree");
    let mut cell = Cell::new();
    cell.robot_body("a", cube(1.0));
    cell.robot_body("b", cube(1.0));
    let mut checker = Checker::new(tree, cell).expect("a world");
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-9));
    let answer = checker.answer_over(&options, [A, B], &[0.0], &[100.0]);
    assert!(answer.is_never() && answer.lower > 0.1 - 1e-8, "{answer:?}");
}

#[test]
fn a_floor_stays_below_an_arm() {
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a plane");
    let turn = |z: f64, axis| Joint::revolute(Isometry3::translation(0.0, 0.0, z), axis, [-PI, PI]);
    let joints = || vec![turn(1.5, Vector3::z_axis()), turn(0.0, Vector3::y_axis())];
    let rod = |x: f64| {
        let rod = cuboid([0.5, 0.1, 0.1]);
        rod.transformed(&Isometry3::translation(x, 0.0, 0.0)).expect("a rod")
    };
    let options = RangeOptions::default().width(ClearanceWidth::Share(0.01));
    let mut above = moved(joints(), rod(0.5), floor);
    let answer = above.answer_over(&options, [A, OTHER], &[-PI; 2], &[PI; 2]);
    let truth = 1.5 - 1.01f64.sqrt();
    assert!(answer.is_never(), "{answer:?}");
    assert!(answer.lower <= truth, "{answer:?}");
    assert!(answer.lower > 0.98 * truth, "{answer:?}");
    let mut meets = moved(joints(), rod(1.2), floor);
    let answer = meets.answer_over(&options, [A, OTHER], &[-PI; 2], &[PI; 2]);
    assert!(matches!(answer.verdict, RangeVerdict::Both { .. }), "{answer:?}");
}

/// A channel along x, open at the top.
pub(crate) fn channel() -> Compound {
    let plate = |half: [f64; 3], at: [f64; 3]| {
        let mut piece = Piece::new(solids::cuboid(half.into()).expect("a box"));
        piece.pose = Isometry3::translation(at[0], at[1], at[2]);
        piece
    };
    let pieces = vec![
        plate([2.0, 0.1, 0.5], [0.0, 0.6, 0.5]),
        plate([2.0, 0.1, 0.5], [0.0, -0.6, 0.5]),
        plate([2.0, 0.7, 0.1], [0.0, 0.0, -0.1]),
    ];
    Compound::new(pieces).expect("a channel")
}

#[test]
fn a_block_in_a_channel_never_meets_its_walls() {
    let inner = cube(0.2)
        .transformed(&Isometry3::translation(0.0, 0.0, 0.4))
        .expect("a block");
    let channel = channel();
    let mesh = channel.to_mesh().expect("a mesh");
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-0.3, 0.3]);
    for other in [Geometry::from(channel), mesh.into()] {
        let joints = vec![slide(Vector3::x_axis(), [-1.0, 1.0]), turn.clone()];
        let mut checker = moved(joints, inner.clone(), other);
        let (low, high) = ([-1.0, -0.3], [1.0, 0.3]);
        let options = RangeOptions::default().cells(400);
        let answer = checker.answer_over(&options, [A, OTHER], &low, &high);
        let truth = 0.5 - 0.2 * (0.3f64.cos() + 0.3f64.sin());
        assert!(answer.is_never() && answer.lower <= truth, "{answer:?}");
        // Deep in the material, and free of it.
        let answer = checker.answer_over(&options, [A, OTHER], &[-1.0, 0.0], &[1.0, 0.0]);
        assert!(answer.is_never(), "{answer:?}");
    }
}

#[test]
fn a_mesh_inside_a_mesh_always_meets_it() {
    let small = lin_canny::Mesh::from_convex(&cube(0.1)).expect("a mesh");
    let large = lin_canny::Mesh::from_convex(&cube(1.0)).expect("a mesh");
    let mut checker = moved(vec![slide(Vector3::x_axis(), [-3.0, 3.0])], small, large);
    let options = RangeOptions::default();
    let inside = checker.answer_over(&options, [A, OTHER], &[-0.5], &[0.5]);
    assert_eq!(inside.verdict, RangeVerdict::Always);
    let both = checker.answer_over(&options, [A, OTHER], &[-0.5], &[2.0]);
    assert!(matches!(both.verdict, RangeVerdict::Both { .. }), "{both:?}");
    let outside = checker.answer_over(&options, [A, OTHER], &[1.2], &[3.0]);
    assert!(outside.is_never(), "{outside:?}");
}

#[test]
fn bodies_without_an_inside_are_answered() {
    let segment =
        ConvexPolyhedron::segment(Point3::new(-1.0, 0.0, 0.0), Point3::new(1.0, 0.0, 0.0)).expect("a segment");
    let point = ConvexPolyhedron::point(Point3::new(0.0, 0.0, 1.0)).expect("a point");
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-PI, PI]);
    let slide = slide(Vector3::z_axis(), [-0.5, 2.0]);
    let mut checker = moved(vec![turn, slide], segment, point);
    let options = RangeOptions::default().cells(2_000);
    let never = checker.answer_over(&options, [A, OTHER], &[-PI, -0.5], &[PI, 0.9]);
    assert!(never.is_never() && never.lower <= 0.1, "{never:?}");
    let both = checker.answer_over(&options, [A, OTHER], &[-PI, -0.5], &[PI, 1.0]);
    assert!(matches!(both.verdict, RangeVerdict::Both { .. }), "{both:?}");
}

#[test]
fn an_attached_part_is_part_of_the_robot() {
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-PI, PI]);
    let mut checker = moved(
        vec![turn],
        cube(0.1),
        cube(0.1)
            .transformed(&Isometry3::translation(2.0, 0.0, 0.0))
            .expect("a post"),
    );
    let at = Isometry3::translation(1.0, 0.0, 0.0);
    let part = checker.cell_mut().carry("body", "part", cube(0.2), at, &[]);
    let options = RangeOptions::default();
    let near = checker.answer_over(&options, [part, OTHER], &[-PI], &[PI]);
    assert!(near.is_never() && near.lower <= 0.7, "{near:?}");
    let answers = checker.answers_over(&options, &[-PI], &[PI]);
    assert_eq!(answers.len(), 2);
    assert!(answers.iter().all(RangeAnswer::is_never));
}

#[test]
fn a_search_that_is_stopped_goes_on_with_its_cells() {
    let mut rng = Rng::new(77);
    let mut resumed = 0;
    for k in 0..40 {
        let (tree, cell) = robot(&mut rng, 1.0, k);
        let mut checker = Checker::new(tree.clone(), cell).expect("a robot");
        let [low, high]: [Vec<f64>; 2] = [0, 1].map(|e| tree.bounds().iter().map(|ends| ends[e]).collect());
        for options in [
            RangeOptions::default(),
            RangeOptions::default().width(ClearanceWidth::Share(0.2)),
        ] {
            let whole = checker.answer_over(&options.cells(600), [A, B], &low, &high);
            let mut parts = checker.answer_over(&options.cells(100), [A, B], &low, &high);
            for _ in 0..5 {
                if matches!(parts.verdict, RangeVerdict::Open { .. }) {
                    resumed += 1;
                    let go = &mut |_| ControlFlow::Continue(());
                    parts = RangeProver::new(&options.cells(100))
                        .progress(go)
                        .resume(&mut checker, &parts)
                        .expect("a range");
                }
            }
            assert_eq!(whole, parts);
        }
    }
    assert!(resumed > 20, "{resumed}");
}

#[test]
fn a_caller_stops_a_search() {
    let cell = ArmCell::new(5);
    let mut checker = Checker::new(cell.arm(), cell.cell()).expect("a cell");
    let [low, high]: [Vec<f64>; 2] = [0, 1].map(|e| cell.arm().bounds().iter().map(|ends| ends[e]).collect());
    let mut seen = 0;
    let mut stop = |progress: lin_canny::Progress| {
        seen = progress.done;
        lin_canny::Progress::stop_if(progress.done >= 3)
    };
    let options = RangeOptions::default().samples(5);
    let answers = RangeProver::new(&options)
        .progress(&mut stop)
        .all_pairs(&mut checker, &low, &high)
        .expect("a range");
    assert!(seen <= 3 && answers.iter().any(|a| matches!(a.verdict, RangeVerdict::Open { .. })));
}

/// Links of meshes: each verdict is that of brute force at samples.
#[test]
fn meshes_of_a_cell_hold_at_samples() {
    let made = ArmCell::new(5);
    let (arm, cell) = (made.arm(), made.cell());
    let mut rng = Rng::new(9);
    let mut tally = [0; 4];
    for _ in 0..12 {
        let [low, high] = ranges(&mut rng, arm.bounds());
        let mut checker = Checker::new(made.arm(), made.cell()).expect("a cell");
        let options = RangeOptions::default().cells(60).samples(20);
        let answers = checker.answers_over(&options, &low, &high);
        let is_never = answers.iter().all(RangeAnswer::is_never);
        let always = answers.iter().any(|answer| answer.verdict == RangeVerdict::Always);
        let mut blocked = 0;
        for _ in 0..30 {
            let q = at(&mut rng, [&low, &high]);
            let found = checker.in_contact(&q).expect("a configuration");
            blocked += u32::from(!found.is_empty());
            for answer in &answers {
                let touches = found.contains(&answer.pair);
                match answer.verdict {
                    RangeVerdict::Never => assert!(!touches, "{q:?} {answer:?}"),
                    RangeVerdict::Always => assert!(touches, "{q:?} {answer:?}"),
                    _ => {}
                }
            }
        }
        assert!((blocked == 0 || !is_never) && (blocked > 0 || !always));
        for answer in &answers {
            tally[place_of(&answer.verdict)] += 1;
        }
    }
    println!("{tally:?}");
    assert!(tally[0] > 100 && cell.robot_bodies().len() == 7, "{tally:?}");
}

#[test]
fn wrong_ranges_are_refused() {
    let mut checker = moved(vec![slide(Vector3::x_axis(), [-1.0, 1.0]); 2], cube(1.0), cube(1.0));
    let options = RangeOptions::default();
    let mut ask = |low: [f64; 2], high: [f64; 2]| {
        RangeProver::new(&options)
            .pair(&mut checker, A, OTHER, &low, &high)
            .map(|_| ())
    };
    let range = PlanError::Range {
        index: 1,
        low: 0.5,
        high: 0.0,
    };
    assert_eq!(ask([0.0, 0.5], [0.0, 0.0]), Err(range.clone()));
    assert_eq!(
        range.to_string(),
        "coordinate 1 of the range is empty: 0.5 to 0.0 (expected low <= high)"
    );
    assert_eq!(
        ask([0.0, 0.5], [0.0, 1.5]),
        Err(PlanError::Coordinate { index: 1, value: 1.5 })
    );
    assert!(ask([f64::NAN, 0.5], [0.0, 1.0]).is_err_and(|e| e.to_string().contains("coordinate 0")));
    assert_eq!(
        RangeProver::new(&options).all_pairs(&mut checker, &[0.0], &[1.0]),
        Err(PlanError::Length { expected: 2, found: 1 })
    );
    let unknown = RangeProver::new(&options).pair(&mut checker, A, CellBody::Obstacle(3), &[0.0; 2], &[1.0; 2]);
    assert_eq!(unknown, Err(PlanError::NoBody(CellBody::Obstacle(3))));
    assert_eq!(
        RangeProver::new(&options).pair(&mut checker, A, A, &[0.0; 2], &[1.0; 2]),
        Err(PlanError::NoBody(A))
    );
    let answer = checker.answer_over(&options, [A, OTHER], &[0.0; 2], &[1.0; 2]);
    let mut other = moved(vec![slide(Vector3::x_axis(), [-1.0, 1.0])], cube(1.0), cube(1.0));
    let go = &mut |_| ControlFlow::Continue(());
    assert!(
        RangeProver::new(&options)
            .progress(go)
            .resume(&mut other, &answer)
            .is_err()
    );
    let space = RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1).expect("a space");
    let mut cell = Cell::new();
    cell.robot_body("body", cube(1.0));
    cell.put("other", cube(1.0), Isometry3::identity());
    let mut rigid = Checker::new(space, cell).expect("a world");
    let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    assert_eq!(
        RangeProver::new(&options).pair(&mut rigid, A, OTHER, &q, &q),
        Err(PlanError::WithoutJoints(A))
    );
}

#[test]
fn a_swinging_rod_keeps_its_distance_to_the_width_asked_for() {
    // The tip is nearest to the wall at the angle 0.
    let rod = cuboid([0.5, 1e-3, 1e-3]);
    let rod = rod.transformed(&Isometry3::translation(0.5, 0.0, 0.0)).expect("a rod");
    let wall = cuboid([0.1, 2.0, 2.0]);
    let wall = wall
        .transformed(&Isometry3::translation(1.2, 0.0, 0.0))
        .expect("a wall");
    let turn = Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-FRAC_PI_2, FRAC_PI_2]);
    let truth = 1.1 - 1f64.hypot(1e-3);
    for width in [1e-2, 1e-4, 1e-6, 1e-8] {
        let mut checker = moved(vec![turn.clone()], rod.clone(), wall.clone());
        let options = RangeOptions::default().width(ClearanceWidth::Length(width));
        let answer = checker.answer_over(&options, [A, OTHER], &[-1.5], &[1.5]);
        assert!(answer.is_never(), "{answer:?}");
        assert!(answer.lower <= truth, "{answer:?}");
        assert!(truth <= answer.upper, "{answer:?}");
        assert!(answer.upper - answer.lower <= width && answer.cells < 100, "{answer:?}");
    }
}
