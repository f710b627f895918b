//! Proofs over ranges of joints in whole worlds: margins, paddings, attached parts, excluded pairs, and obstacles of each
//! kind. The judge measures each pair at sampled configurations, at the poses that the checker gives.

use core::ops::{ControlFlow, Range};

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Cloud, Geometry, HalfSpace, Mesh, PairTracker, RelativePose, Shape};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ClearanceWidth, ConfigurationSpace, Drive, Joint, JointKind, JointTree,
    PlanError, RangeAnswer, RangeOptions, RangeProver, RangeVerdict, TimedPoses, TreeJoint,
};
use std::f64::consts::PI;
use truth::rng::Rng;

use crate::ranges::{A, B, OTHER, at, channel, cube, moved, pose, ranges, robot, slide};
use truth::plans::{self, Ask, Furnish, cuboid, place_of};

/// The distance of a pair at a configuration: bounds, and whether it is within what the pair must keep.
fn measured<C: ConfigurationSpace>(checker: &Checker<C>, pair: CellPair, q: &[f64]) -> (f64, bool) {
    let [x, y] = [pair.a, pair.b].map(|id| checker.pose(id, q).expect("a pose"));
    let pose = RelativePose::new(&x, &y).expect("poses");
    let [x, y] = [pair.a, pair.b].map(|id| checker.cell().geometry(id).expect("a body"));
    let mut tracker = PairTracker::new();
    let upper = tracker.closest(x, y, &pose).upper;
    tracker.reset();
    let kept = checker.cell().required_distance(pair).distance;
    (upper, tracker.within(x, y, &pose, kept))
}

/// Checks an answer at samples and at its witnesses.
fn judge<C: ConfigurationSpace>(checker: &Checker<C>, answer: &RangeAnswer, samples: u32, rng: &mut Rng) {
    let [low, high]: [Vec<f64>; 2] = [0, 1].map(|k| answer.range.iter().map(|ends| ends[k]).collect());
    for (witness, is_touching) in answer.witnesses.iter().zip([false, true]) {
        if let Some(q) = witness {
            assert_eq!(measured(checker, answer.pair, q).1, is_touching, "{answer:?}");
        }
    }
    let kept = checker.cell().required_distance(answer.pair).distance;
    assert!(!answer.is_never() || answer.lower >= kept, "{answer:?}");
    for _ in 0..samples {
        let q = at(rng, [&low, &high]);
        let (upper, is_within) = measured(checker, answer.pair, &q);
        match answer.verdict {
            RangeVerdict::Never => assert!(!is_within, "{q:?} {answer:?}"),
            RangeVerdict::Always => assert!(is_within, "{q:?} {answer:?}"),
            _ => {}
        }
        // The depth of an overlap counts as no distance.
        assert!(answer.lower <= upper.max(0.0), "{upper} at {q:?}: {answer:?}");
    }
}

/// A box without its lid.
fn open_box(half: f64) -> Mesh {
    let corner = |m: usize| Point3::from([0, 1, 2].map(|k| if m >> k & 1 == 1 { half } else { -half }));
    let points: Vec<Point3<f64>> = (0..8).map(corner).collect();
    let faces: [[u32; 4]; 5] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new(&points, &triangles.collect::<Vec<_>>()).expect("a mesh")
}

/// Obstacles of each kind around a robot of a size.
pub(crate) fn add_obstacles(cell: &mut Cell, rng: &mut Rng, size: f64) {
    let scaled = |p: Point3<f64>| Point3::from(p.coords * size);
    let floor = HalfSpace::new(Vector3::z(), -1.5 * size).expect("a plane");
    cell.put("floor", floor, Isometry3::identity());
    let points: Vec<Point3<f64>> = (0..40)
        .map(|_| Point3::from(Vector3::from_fn(|_, _| size * rng.range(-0.5, 0.5))))
        .collect();
    let ball = Shape::ball(0.05 * size).expect("a ball");
    cell.put(
        "cloud",
        Cloud::new(&points, ball).expect("a cloud"),
        pose(rng, 2.0 * size),
    );
    cell.put("open box", open_box(0.6 * size), pose(rng, 2.0 * size));
    let walls = channel().to_mesh().expect("a mesh");
    let corners: Vec<Point3<f64>> = walls.triangles().flat_map(|(_, t)| t.map(scaled)).collect();
    let triangles: Vec<[u32; 3]> = (0..corners.len() as u32 / 3)
        .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
        .collect();
    cell.put(
        "walls",
        Mesh::new(&corners, &triangles).expect("walls"),
        pose(rng, 2.0 * size),
    );
    let way = [pose(rng, size), pose(rng, 3.0 * size)];
    let poses = TimedPoses::new(&[0.0, 1.0], &way).expect("poses");
    cell.put_moving(
        "cart",
        Shape::capsule(0.2 * size, 0.1 * size).expect("a capsule"),
        poses,
    );
}

fn random_worlds(robots: Range<u64>, samples: u32, seed: u64) -> [u32; 4] {
    let mut tally = [0; 4];
    for k in robots {
        let mut rng = Rng::new(seed + k);
        let size = [1.0, 1e-6, 1e6][(k % 3) as usize];
        let (tree, mut cell) = robot(&mut rng, size, seed + k);
        add_obstacles(&mut cell, &mut rng, size);
        cell.set_margin(0.03 * size).expect("a margin");
        cell.set_pair_margin("a", "cloud", Some(0.2 * size)).expect("a margin");
        cell.set_pair_margin("b", "open box", Some(0.0)).expect("a margin");
        cell.pad("b", 0.05 * size).expect("a padding");
        cell.exclude("a", "walls").expect("a pair");
        let limits = tree.bounds().to_vec();
        let mut checker = Checker::new(tree, cell).expect("a robot");
        let part = cuboid([0.1 * size; 3]);
        let part = checker
            .cell_mut()
            .carry("b", "part", part, pose(&mut rng, 0.5 * size), &[]);
        let [low, high] = ranges(&mut rng, &limits);
        let mut options = RangeOptions::default().cells(200).samples(40);
        if k % 2 == 0 {
            options = options.width(ClearanceWidth::Share(0.2));
        }
        let refused = RangeProver::new(&options).all_pairs(&mut checker, &low, &high);
        assert_eq!(refused, Err(PlanError::NoTime("cart".into())));
        checker.set_time(rng.range(0.0, 1.0)).expect("a time");
        let mut answers = checker.answers_over(&options, &low, &high);
        let excluded = CellPair::new(A, CellBody::Obstacle(3)).expect("a pair");
        // Both bodies and the part against five obstacles, one excluded; the part is rigid with b.
        assert_eq!(answers.len(), 3 * 5 - 1 + 2);
        assert!(answers.iter().all(|answer| answer.pair != excluded));
        assert!(
            answers
                .iter()
                .any(|answer| answer.pair.a == part || answer.pair.b == part)
        );
        answers.push(checker.answer_over(&options, [excluded.a, excluded.b], &low, &high));
        for answer in &answers {
            judge(&checker, answer, samples, &mut rng);
            tally[place_of(&answer.verdict)] += 1;
        }
    }
    println!("{tally:?} pairs never, always, both, open");
    tally
}

#[test]
fn verdicts_in_random_worlds_hold_at_samples() {
    let tally = random_worlds(0..12, 60, 40);
    assert!(tally[0] > 60 && tally[2] > 10, "{tally:?}");
}

#[test]
#[ignore = "three hundred worlds at two thousand samples a pair: cargo test --release -p lin-canny-plan --test plan three_hundred_worlds -- --ignored"]
fn verdicts_in_three_hundred_worlds_hold_at_samples() {
    random_worlds(crate::chosen_robots(0..300), 2_000, 4_000);
}

#[test]
fn a_range_beside_a_moving_obstacle_needs_a_time() {
    let x = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let mut cell = Cell::new();
    cell.robot_body("body", cube(0.5));
    let poses = TimedPoses::new(&[0.0, 1.0], &[x(9.0), x(2.0)]).expect("poses");
    let cart = cell.put_moving("cart", cube(0.5), poses);
    let arm = JointTree::serial(
        Isometry3::identity(),
        vec![slide(Vector3::x_axis(), [0.0, 3.0])],
        vec![1],
        1.0,
    );
    let mut checker = Checker::new(arm.expect("an arm"), cell).expect("a world");
    let options = RangeOptions::default();
    let none = Err(PlanError::NoTime("cart".into()));
    let found = RangeProver::new(&options).pair(&mut checker, A, cart, &[0.0], &[3.0]);
    assert_eq!(found, none);
    checker.set_time(0.0).expect("a time");
    let early = checker.answer_over(&options, [A, cart], &[0.0], &[3.0]);
    assert!(early.is_never() && early.lower <= 5.0, "{early:?}");
    checker.set_time(1.0).expect("a time");
    let late = checker.answer_over(&options, [A, cart], &[0.0], &[3.0]);
    assert!(matches!(late.verdict, RangeVerdict::Both { .. }), "{late:?}");
    // The obstacle has moved since the answer.
    let go = &mut |_| ControlFlow::Continue(());
    let found = RangeProver::new(&options).progress(go).resume(&mut checker, &early);
    assert_eq!(found, Err(PlanError::OtherRange(early.pair)));
}

#[test]
fn a_range_of_no_width_at_the_margin_is_within_it() {
    for (gap, is_within) in [(0.5, true), (0.5f64.next_up(), false), (0.5f64.next_down(), true)] {
        let at = 2.0 + gap;
        let mut checker = moved(vec![slide(Vector3::x_axis(), [2.0, 5.0])], cube(1.0), cube(1.0));
        checker.cell_mut().set_margin(0.5).expect("a margin");
        let options = RangeOptions::default();
        let answer = checker.answer_over(&options, [A, OTHER], &[at], &[at]);
        // The slide rounds to a grid of 2^-51.
        let is_at = at - 2.0 <= 0.5;
        assert!(is_at == is_within || gap != 0.5);
        assert_eq!(answer.verdict == RangeVerdict::Always, is_at, "{answer:?}");
        assert_eq!(checker.is_free_at(&[at]), Ok(!is_at));
        // A decided answer is returned as it is.
        let again = RangeProver::new(&options)
            .progress(&mut |_| ControlFlow::Continue(()))
            .resume(&mut checker, &answer);
        assert_eq!(again, Ok(answer));
    }
}

/// Two boxes on a link that turns freely: the coordinate between them has no width, so only rounding moves them.
#[test]
fn a_coordinate_of_no_width_on_a_link_that_turns_is_no_single_configuration() {
    let mut rng = Rng::new(8);
    let (mut never, mut always) = (0, 0);
    for k in 0..40 {
        let near = pose(&mut rng, 3.0);
        let first = plans::turn(0, near, Vector3::z_axis(), 0);
        let second = plans::slide(1, Isometry3::identity(), Vector3::x_axis(), 1);
        let (joints, limits) = (vec![first, second], vec![[-3.0, 3.0], [0.0, 4.0]]);
        let tree = JointTree::new(Isometry3::identity(), joints, limits, vec![1, 2], vec![3.0; 3]);
        let mut cell = Cell::new();
        cell.robot_body("a", cube(0.5));
        cell.robot_body("b", cube(0.5));
        let mut checker = Checker::new(tree.expect("a tree"), cell).expect("a world");
        let gap = [0.0, 0.1, -0.1, 1e-15][k % 4];
        let options = RangeOptions::default();
        let [low, high] = [[-3.0, 1.0 + gap], [3.0, 1.0 + gap]];
        let answer = checker.answer_over(&options, [A, B], &low, &high);
        judge(&checker, &answer, 200, &mut rng);
        never += u32::from(answer.is_never());
        always += u32::from(answer.verdict == RangeVerdict::Always);
    }
    assert_eq!((never, always), (10, 10));
}

/// Limits of a million radians, of coordinates that drive one joint, two joints, and a joint against itself.
#[test]
fn limits_of_a_million_radians_hold_at_samples() {
    let mut rng = Rng::new(3);
    let mut tally = [0; 2];
    for k in 0..8 {
        let turn = |z: f64, parent: usize, factor: f64| TreeJoint {
            parent,
            kind: JointKind::Revolute,
            origin: Isometry3::translation(1.0, 0.0, z),
            axis: Vector3::z_axis(),
            drive: Some(Drive {
                coordinate: 0,
                factor,
                offset: 0.1,
            }),
        };
        // The second joint turns back what the first turns, half of it, or more.
        let joints = vec![turn(0.0, 0, 1.0), turn(0.0, 1, [-1.0, -0.5, 2.0, 0.0][k % 4])];
        let limits = vec![[-1e6, 1e6]];
        let tree = JointTree::new(Isometry3::identity(), joints, limits, vec![2], vec![3.0; 3]).expect("a tree");
        let mut cell = Cell::new();
        cell.robot_body("body", cube(0.1));
        let post = cell.put("post", cube(0.3), Isometry3::translation([0.0, 4.0][k / 4], 0.0, 0.0));
        let mut checker = Checker::new(tree, cell).expect("a world");
        let options = RangeOptions::default().cells(400);
        let answer = checker.answer_over(&options, [A, post], &[-1e6], &[1e6]);
        judge(&checker, &answer, 2_000, &mut rng);
        tally[usize::from(answer.is_never())] += 1;
    }
    assert!(tally[1] >= 2, "{tally:?}");
}

/// A slide behind a turn carries a ball far from the axis of the turn.
#[test]
fn a_turn_before_a_long_slide_reaches_far() {
    let joints = vec![
        Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-1.0, 2.0]),
        slide(Vector3::x_axis(), [0.0, 10.0]),
    ];
    let ball = || Shape::ball(0.1).expect("a ball");
    let arm = JointTree::serial(Isometry3::identity(), joints, vec![2], 11.0).expect("an arm");
    let mut cell = Cell::new();
    cell.robot_body("ball", ball());
    let other = cell.put("other", ball(), Isometry3::translation(0.0, 8.0, 0.0));
    let mut checker = Checker::new(arm, cell).expect("a world");
    let options = RangeOptions::default();
    let both = checker.answer_over(&options, [A, other], &[-1.0, 0.0], &[2.0, 10.0]);
    assert!(matches!(both.verdict, RangeVerdict::Both { .. }), "{both:?}");
    let short = checker.answer_over(&options, [A, other], &[-1.0, 0.0], &[2.0, 7.7]);
    assert!(short.is_never() && short.lower <= 0.1 + 1e-12, "{short:?}");
}

#[test]
fn an_answer_about_other_bodies_is_not_resumed() {
    let joint = || vec![Joint::revolute(Isometry3::identity(), Vector3::z_axis(), [-PI, PI])];
    let far = |x: f64| {
        let far = cube(0.5).transformed(&Isometry3::translation(x, 0.0, 0.0));
        Geometry::from(far.expect("a box"))
    };
    let options = RangeOptions::default();
    let go = &mut |_| ControlFlow::Continue(());
    let mut checker = moved(joint(), cube(0.5), far(2.0));
    let open = checker.answer_over(&options.cells(0), [A, OTHER], &[-PI], &[PI]);
    assert!(matches!(open.verdict, RangeVerdict::Open { .. }));
    let answer = RangeProver::new(&options)
        .progress(go)
        .resume(&mut checker, &open)
        .expect("a range");
    assert!(answer.is_never());
    let points = [Point3::new(2.0, 0.0, 0.0), Point3::new(2.1, 0.1, 0.1)];
    let more = [points[0], points[1], Point3::new(2.05, 0.05, 0.05)];
    let ball = || Shape::ball(0.1).expect("a ball");
    let cloud = |points: &[Point3<f64>]| Geometry::from(Cloud::new(points, ball()).expect("a cloud"));
    let others = [far(2.5), far(2.0f64.next_up()), cloud(&points), cloud(&more)];
    for other in others.clone() {
        let mut changed = moved(joint(), cube(0.5), other);
        for old in [&open, &answer] {
            let found = RangeProver::new(&options).progress(go).resume(&mut changed, old);
            assert_eq!(found, Err(PlanError::OtherRange(old.pair)));
        }
    }
    let [_, _, two, three] = others;
    let of_two = RangeProver::new(&options).pair(&mut moved(joint(), cube(0.5), two), A, OTHER, &[-PI], &[PI]);
    assert!(
        RangeProver::new(&options)
            .progress(go)
            .resume(&mut moved(joint(), cube(0.5), three), &of_two.expect("a range"))
            .is_err()
    );
    let turned = Joint::revolute(Isometry3::identity(), Vector3::x_axis(), [-PI, PI]);
    assert!(
        RangeProver::new(&options)
            .progress(go)
            .resume(&mut moved(vec![turned], cube(0.5), far(2.0)), &answer)
            .is_err()
    );
    checker.cell_mut().set_margin(0.1).expect("a margin");
    assert!(
        RangeProver::new(&options)
            .progress(go)
            .resume(&mut checker, &answer)
            .is_err()
    );
}

/// The error of a joint is a joint about the same axis, and the place of an obstacle is a joint of
/// its own: both at once, against the closed form.
#[test]
fn errors_of_joints_and_places_of_obstacles_are_coordinates_with_a_range() {
    let joints = vec![
        plans::turn(0, Isometry3::identity(), Vector3::z_axis(), 0),
        plans::turn(1, Isometry3::identity(), Vector3::z_axis(), 1),
        plans::slide(0, Isometry3::translation(1.3, 0.0, 0.0), Vector3::x_axis(), 2),
    ];
    let limits = vec![[0.5, 1.0], [-0.1, 0.1], [-0.1, 0.1]];
    let tree = JointTree::new(Isometry3::identity(), joints, limits, vec![2, 3], vec![1.0; 4]).expect("a tree");
    let rod = cuboid([0.5, 0.05, 0.05]);
    let mut cell = Cell::new();
    let rod = rod.transformed(&Isometry3::translation(0.5, 0.0, 0.0)).expect("a rod");
    cell.robot_body("rod", rod);
    cell.robot_body("wall", cuboid([0.1, 2.0, 2.0]));
    let mut checker = Checker::new(tree, cell).expect("a world");
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-6));
    for (error, place) in [(0.0, 0.0), (0.05, 0.0), (0.0, 0.03), (0.05, 0.03), (0.1, 0.1)] {
        let (low, high) = ([0.5, -error, -place], [1.0, error, place]);
        let answer = checker.answer_over(&options, [A, B], &low, &high);
        let least = 0.5 - error;
        let truth = 1.2 - place - (least.cos() + 0.05 * least.sin());
        assert!(answer.is_never(), "{answer:?}");
        assert!(answer.lower <= truth, "{truth} {answer:?}");
        assert!(truth <= answer.lower + 1.1e-6, "{truth} {answer:?}");
    }
    // The exact arm in the exact place keeps 0.298, which neither tolerance leaves.
    checker.cell_mut().set_margin(0.27).expect("a margin");
    for (error, place, is_never) in [(0.0, 0.0, true), (0.1, 0.0, false), (0.0, 0.1, false)] {
        let (low, high) = ([0.5, -error, -place], [1.0, error, place]);
        let answer = checker.answer_over(&options, [A, B], &low, &high);
        assert_eq!(answer.is_never(), is_never, "{answer:?}");
    }
}

/// A peg in a hole: the place of the part and its tilt are coordinates with a tolerance.
#[test]
fn tolerances_of_a_part_are_coordinates_with_a_range() {
    let lift = plans::slide(0, Isometry3::identity(), Vector3::z_axis(), 0);
    let off = plans::slide(1, Isometry3::identity(), Vector3::x_axis(), 1);
    let tilt = plans::turn(2, Isometry3::identity(), Vector3::y_axis(), 2);
    let limits = vec![[-0.5, 0.5], [-0.05, 0.05], [-0.1, 0.1]];
    let joints = vec![lift, off, tilt];
    let tree = JointTree::new(Isometry3::identity(), joints, limits, vec![3], vec![2.0; 4]).expect("a tree");
    let mut cell = Cell::new();
    cell.robot_body("peg", cuboid([0.1, 0.1, 0.5]));
    let wall = cell.put("wall", cube(1.0), Isometry3::translation(1.2, 0.0, 0.0));
    let mut checker = Checker::new(tree, cell).expect("a world");
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-4));
    let mut prove = |off: f64, tilt: f64| {
        let (low, high) = ([-0.5, -off, -tilt], [0.5, off, tilt]);
        checker.answer_over(&options, [A, wall], &low, &high)
    };
    assert!((prove(0.0, 0.0).lower - 0.1).abs() < 2e-4);
    for (off, tilt) in [(0.02, 0.0), (0.0, 0.1), (0.02, 0.05)] {
        let answer = prove(off, tilt);
        let truth = 0.2 - off - (0.1 * tilt.cos() + 0.5 * tilt.sin());
        assert!(answer.lower <= truth && truth <= answer.lower + 2e-4, "{answer:?}");
    }
    assert!(prove(0.05, 0.1).is_never());
}
