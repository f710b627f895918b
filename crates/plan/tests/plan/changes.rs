//! Promise: a checker whose world has changed answers as a new checker of that world, bit for bit after `reset`; objects
//! move with their links; every pair keeps its own margin.

use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Geometry, Mesh, PairTracker, RelativePose, Shape};
use lin_canny_plan::receipt::Receipt;
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ConfigurationSpace, JointMotion, JointTree, PairBoxes, PlanError, PlanOptions,
    RangeOptions, RangeProver, RigidSpace, RrtConnect, Shortcuts, TreeJoint, Verdict, widen,
};
use std::ops::ControlFlow;
use truth::plans::{Ask, Furnish, blocked, cuboid, slide, told, turn};
use truth::rng::Rng;

const LIMITS: [f64; 2] = [-2.5, 2.5];

/// Three links and a tool frame without geometry.
fn arm() -> JointTree {
    let along = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let flange = Isometry3::new(Vector3::new(0.3, 0.0, 0.05), Vector3::new(0.0, 0.4, 0.1));
    let joints = vec![
        turn(0, along(0.0), Vector3::z_axis(), 0),
        turn(1, along(1.0), Vector3::y_axis(), 1),
        slide(2, along(1.0), Vector3::x_axis(), 2),
        TreeJoint::fixed(3, flange),
    ];
    let limits = vec![LIMITS, LIMITS, [0.0, 0.3]];
    let radii = vec![0.0, 0.6, 1.0, 0.4, 0.0];
    JointTree::new(Isometry3::identity(), joints, limits, vec![1, 2, 3, 4], radii).expect("an arm")
}

fn cell() -> Cell {
    let mut cell = Cell::new();
    let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let rod = |half: f64| cuboid([half, 0.07, 0.06]).transformed(&at(half)).expect("a rod");
    cell.robot_body("upper", rod(0.45));
    cell.robot_body("fore", Mesh::from_convex(&rod(0.4)).expect("a mesh"));
    cell.robot_body("hand", rod(0.1));
    cell.bare_frame("tool");
    cell.exclude("upper", "fore").expect("names");
    cell.exclude("fore", "hand").expect("names");
    cell
}

fn pose(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    let mut draw = |most: f64| Vector3::from_fn(|_, _| rng.range(-most, most));
    Isometry3::from_parts(
        Translation3::from(draw(far)),
        UnitQuaternion::from_scaled_axis(draw(3.0)),
    )
}

fn geometry(rng: &mut Rng) -> Geometry {
    let mut size = || rng.range(0.05, 0.2);
    let block = cuboid([size(), size(), size()]);
    match rng.below(4) {
        0 => Shape::ball(0.1).expect("a ball").into(),
        1 => Mesh::from_convex(&block).expect("a mesh").into(),
        _ => block.into(),
    }
}

fn sample(rng: &mut Rng) -> Vec<f64> {
    vec![rng.range(-2.5, 2.5), rng.range(-2.5, 2.5), rng.range(0.0, 0.3)]
}

/// The checker of a world that was saved and loaded, if the feature is enabled.
fn stored(cell: &Cell) -> Checker<JointTree> {
    #[cfg(feature = "serde")]
    let text = serde_json::to_string(cell).expect("a world");
    #[cfg(feature = "serde")]
    let cell = &serde_json::from_str::<Cell>(&text).expect("a world");
    Checker::new(arm(), cell.clone()).expect("a world")
}

/// Makes random changes: one, several at once, or another world.
fn change(checker: &mut Checker<JointTree>, rng: &mut Rng) {
    match rng.below(14) {
        0 => {
            let (name, q) = (*rng.pick(&["a", "b", "c", "upper"]), sample(rng));
            let before = format!("{:?}", checker.cell());
            if checker.detach_at(name, &q).is_err() {
                assert_eq!(format!("{:?}", checker.cell()), before);
            }
        }
        1 => *checker = stored(checker.cell()),
        2 => {
            let mut other = checker.cell().clone();
            change_world(&mut other, rng);
            change_world(&mut checker.cell_mut(), rng);
            *checker.cell_mut() = other;
        }
        3 => {
            // Another world, a query of it, and the world of before with a change.
            let mut other = checker.cell().clone();
            for _ in 0..3 {
                change_world(&mut other, rng);
            }
            let mut old = core::mem::replace(&mut *checker.cell_mut(), other);
            checker.is_free_at(&sample(rng)).expect("a configuration");
            change_world(&mut old, rng);
            *checker.cell_mut() = old;
        }
        4..=6 => {
            let mut cell = checker.cell_mut();
            for _ in 0..2 + rng.below(4) {
                change_world(&mut cell, rng);
            }
        }
        _ => change_world(&mut checker.cell_mut(), rng),
    }
}

/// Makes a random change; refused changes must change nothing.
fn change_world(cell: &mut Cell, rng: &mut Rng) {
    let names = ["a", "b", "c", "upper", "fore", "hand", "tool", "nobody"];
    let name = *rng.pick(&names[..4]);
    let [one, two] = [*rng.pick(&names), *rng.pick(&names)];
    let all: Vec<CellBody> = cell.bodies().map(|b| b.0).collect();
    let id = *rng.pick(&all);
    let link = *rng.pick(&names[3..]);
    let before = format!("{cell:?}");
    let is_refused = match rng.below(14) {
        0 | 1 => cell.add_obstacle(name, geometry(rng), pose(rng, 1.6)).is_err(),
        2 => cell.move_obstacle(name, pose(rng, 1.6)).is_err(),
        3 => cell.move_obstacle(id, pose(rng, 1.6)).is_err(),
        4 => cell.replace_obstacle(id, geometry(rng)).is_err(),
        5 => cell
            .remove_obstacle(if rng.below(4) == 0 { name } else { "c" })
            .is_err(),
        6 => cell.attach(link, name, geometry(rng), pose(rng, 0.2), &[one]).is_err(),
        7 => cell.detach(name).is_err(),
        8 => cell.set_margin(*rng.pick(&[0.02, 0.0, 0.05, -1.0])).is_err(),
        9 => cell.pad(one, *rng.pick(&[0.0, 0.01, 0.2, -1.0])).is_err(),
        10 => {
            let margin = *rng.pick(&[None, Some(0.0), Some(0.05), Some(f64::NAN)]);
            cell.set_pair_margin(one, two, margin).is_err()
        }
        11 => cell.exclude(one, two).is_err(),
        12 => cell.include(one, id).is_err(),
        _ => {
            cell.exclude_if(|pair| pair.a == id && pair.b == all[0]);
            false
        }
    };
    if is_refused {
        assert_eq!(format!("{cell:?}"), before);
    }
}

/// What a checker says; the ninth question is a proof.
fn ask(checker: &mut Checker<JointTree>, question: usize, q: &[f64], p: &[f64]) -> String {
    match question {
        8 => format!("{:?}", crate::prove(checker, &JointMotion::segment(q, p))),
        _ => told(checker, question, q, p),
    }
}

fn judge(sequences: usize, changes: usize, seed: u64) {
    let (mut differing, mut free) = (0, 0);
    for k in 0..sequences {
        let mut rng = Rng::new(seed + k as u64);
        let mut checker = Checker::new(arm(), cell()).expect("a world");
        let mut warm = Checker::new(arm(), cell()).expect("a world");
        checker.cell_mut().set_margin(0.02).expect("a margin");
        warm.cell_mut().set_margin(0.02).expect("a margin");
        for step in 0..changes {
            let mut same = rng.clone();
            change(&mut checker, &mut rng);
            change(&mut warm, &mut same);
            let q = sample(&mut rng);
            let by = [0; 3].map(|_| rng.range(-0.3, 0.3));
            let p = checker.space().moved(&q, &by);
            let mut new = Checker::new(arm(), checker.cell().clone()).expect("a world");
            let questions = if step % 8 == 0 { 9 } else { 4 };
            for question in 0..questions {
                new.reset();
                checker.reset();
                let expected = ask(&mut new, question, &q, &p);
                assert_eq!(ask(&mut checker, question, &q, &p), expected, "{k} {step} {question}");
                let told = ask(&mut warm, question, &q, &p);
                differing += usize::from(told != expected);
                if question == 1 {
                    assert_eq!(told, expected, "{k} {step}");
                    free += usize::from(told == "Ok(true)");
                }
            }
        }
    }
    assert!(differing > 0 || sequences < 5, "nothing to reset");
    assert!(free > sequences, "{free} free");
}

#[test]
fn a_changed_checker_equals_a_new_one() {
    judge(10, 100, 100);
}

#[test]
#[ignore = "1,000 sequences of 100 changes: cargo test --release --all-features -p lin-canny-plan --test plan changes -- --ignored"]
fn a_changed_checker_equals_a_new_one_1000_times() {
    judge(1000, 100, 10_000);
}

/// Returns the signed distance of two posed geometries by a new tracker, with its bounds.
fn measured(a: (&Geometry, Isometry3<f64>), b: (&Geometry, Isometry3<f64>)) -> [f64; 2] {
    let relative = RelativePose::new_normalized(&a.1, &b.1).expect("poses");
    let outcome = PairTracker::new().closest(a.0, b.0, &relative);
    [outcome.lower, outcome.upper]
}

/// Returns geometry and pose of a body at a configuration, from the pose of its link alone.
fn placed<'a>(checker: &'a Checker<JointTree>, id: CellBody, q: &[f64]) -> (&'a Geometry, Isometry3<f64>) {
    let mut poses = Vec::new();
    checker.space().place(q, &mut poses);
    let cell = checker.cell();
    let link = |name: &str| ["upper", "fore", "hand", "tool"].iter().position(|n| *n == name);
    let pose = match id {
        CellBody::Robot(k) => poses[k],
        CellBody::Obstacle(_) => *cell.obstacle_pose(id).expect("an obstacle"),
        CellBody::Attached(_) => {
            let object = cell.attached().find(|o| o.0 == id).expect("an object").1;
            poses[link(&object.link).expect("a link")] * object.pose
        }
    };
    (cell.geometry(id).expect("a body"), pose)
}

/// A checker with objects on hand and tool, obstacles, paddings and margins of pairs.
fn loaded(rng: &mut Rng) -> Checker<JointTree> {
    let mut checker = Checker::new(arm(), cell()).expect("a world");
    for k in 0..12 {
        let at = pose(rng, 1.8);
        if at.translation.vector.norm() > 0.8 {
            checker.cell_mut().put(k, geometry(rng), at);
        }
    }
    let mut cell = checker.cell_mut();
    let grip = ["hand", "tool"];
    cell.carry("tool", "part", geometry(rng), pose(rng, 0.15), &grip);
    cell.carry("upper", "pack", geometry(rng), pose(rng, 0.4), &["fore"]);
    cell.set_margin(0.01).expect("a margin");
    cell.pad("part", 0.03).expect("a padding");
    cell.pad("hand", 0.005).expect("a padding");
    let id = cell.bodies().map(|b| b.0).last().expect("a body");
    cell.pad(id, 0.02).expect("a padding");
    cell.set_pair_margin("fore", id, Some(0.0)).expect("a margin");
    cell.set_pair_margin("pack", id, Some(0.1)).expect("a margin");
    drop(cell);
    checker
}

/// Returns all pairs that must be measured, by brute force.
fn pairs(checker: &Checker<JointTree>) -> Vec<CellPair> {
    let all: Vec<CellBody> = checker.cell().bodies().map(|b| b.0).collect();
    let rigid = |id: CellBody| match checker.cell().name(id) {
        "part" | "hand" => 1,
        "pack" | "upper" => 2,
        _ => 100 + all.iter().position(|x| *x == id).unwrap_or(0),
    };
    let mut pairs = Vec::new();
    for (k, &a) in all.iter().enumerate() {
        for pair in all[k + 1..].iter().filter_map(|&b| CellPair::new(a, b)) {
            let is_excluded = checker.cell().excluded().any(|x| x == [pair.a, pair.b]);
            if !is_excluded && rigid(pair.a) != rigid(pair.b) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

#[test]
fn attached_objects_are_where_their_links_carry_them() {
    let mut rng = Rng::new(7);
    for _ in 0..6 {
        let mut checker = loaded(&mut rng);
        let expected = pairs(&checker);
        for _ in 0..20 {
            let q = sample(&mut rng);
            let near = checker.nearest(&q, f64::INFINITY).expect("a configuration");
            let mut found: Vec<CellPair> = near.iter().map(|n| n.pair).collect();
            found.sort_unstable();
            assert_eq!(found, expected);
            let is_free = checker.is_free_at(&q).expect("a configuration");
            let mut least = f64::INFINITY;
            for n in &near {
                let [lower, upper] = measured(placed(&checker, n.pair.a, &q), placed(&checker, n.pair.b, &q));
                assert!(n.lower <= upper + 1e-9, "{n:?} {lower} {upper}");
                assert!(lower <= n.upper + 1e-9, "{n:?} {lower} {upper}");
                least = least.min(n.excess);
                let kept = checker.cell().required_distance(n.pair).distance;
                assert_eq!(n.excess, n.distance - kept);
            }
            assert!(is_free == (least > 0.0) || least.abs() < 1e-9, "{least}");
            let touching = checker.in_contact(&q).expect("a configuration");
            let mut below: Vec<CellPair> = near.iter().filter(|n| n.lower <= 0.0).map(|n| n.pair).collect();
            below.sort_unstable();
            assert_eq!(touching, below);
        }
    }
}

/// Judges verdicts by places of each motion; returns how many were free and blocked.
fn judge_verdicts(motions: usize, places: usize, seed: u64) -> [usize; 2] {
    let mut rng = Rng::new(seed);
    let (mut tally, mut checker) = ([0; 2], loaded(&mut rng));
    for k in 0..motions {
        if k % 20 == 0 {
            checker = loaded(&mut rng);
        }
        let q = sample(&mut rng);
        let by = [0; 3].map(|_| rng.range(-0.5, 0.5));
        let p = checker.space().moved(&q, &by);
        let verdict = checker.verdict_of(&JointMotion::segment(&q, &p));
        let proof = crate::prove(&mut checker, &JointMotion::segment(&q, &p)).expect("a segment");
        assert_eq!(proof.is_some(), verdict.is_free());
        let all = pairs(&checker);
        for place in 0..=places {
            let t = place as f64 / places as f64;
            if t >= verdict.free_until() && !verdict.is_free() {
                break;
            }
            let at = checker.space().between(&q, &p, t);
            for pair in &all {
                let [_, upper] = measured(placed(&checker, pair.a, &at), placed(&checker, pair.b, &at));
                let kept = checker.cell().required_distance(*pair).distance;
                assert!(upper > kept - 1e-9, "{} at {t}: {upper}", checker.show(pair));
            }
        }
        if let Some(([_, t], pair)) = blocked(&verdict) {
            let at = checker.space().between(&q, &p, t);
            let [lower, _] = measured(placed(&checker, pair.a, &at), placed(&checker, pair.b, &at));
            assert!(
                lower <= checker.cell().required_distance(pair).distance + 1e-9,
                "{}",
                checker.show(&verdict)
            );
            tally[1] += 1;
        }
        tally[0] += usize::from(verdict.is_free());
    }
    tally
}

#[test]
fn verdicts_keep_the_margin_of_each_pair() {
    let tally = judge_verdicts(60, 30, 3);
    assert!(tally.iter().all(|n| *n > 5), "{tally:?}");
}

#[test]
#[ignore = "1,000 motions at 1,000 places: cargo test --release --all-features -p lin-canny-plan --test plan changes -- --ignored"]
fn verdicts_keep_the_margin_of_each_pair_over_1000_motions() {
    let tally = judge_verdicts(1000, 1000, 4);
    assert!(tally.iter().all(|n| *n > 100), "{tally:?}");
}

#[test]
fn a_change_of_one_obstacle_measures_its_own_pairs_alone() {
    let mut cell = cell();
    for k in 0..1000 {
        let (x, y) = (f64::from(k % 32), f64::from(k / 32));
        cell.put(k, Shape::ball(0.2).expect("a ball"), Isometry3::translation(x, y, 0.5));
    }
    let mut checker = Checker::new(arm(), cell).expect("a world");
    let q = [0.3, 0.1, 0.1];
    checker.nearest(&q, f64::INFINITY).expect("a configuration");
    let made = checker.work().pairs_made;
    assert_eq!(made, 3 * 1000 + 1);
    for k in 0..10 {
        let at = Isometry3::translation(1.0, f64::from(k), 0.3);
        checker.cell_mut().move_obstacle("500", at).expect("an obstacle");
        checker
            .cell_mut()
            .replace_obstacle("501", cuboid([0.1, 0.1, 0.1]))
            .expect("an obstacle");
    }
    assert_eq!(checker.work().pairs_made, made);
    let id = checker
        .cell_mut()
        .put("new", cuboid([0.1, 0.1, 0.1]), Isometry3::translation(0.0, 2.0, 0.0));
    assert_eq!(checker.work().pairs_made, made + 3);
    checker.cell_mut().remove_obstacle(id).expect("an obstacle");
    checker.cell_mut().exclude("upper", "500").expect("names");
    checker.cell_mut().include("upper", "500").expect("names");
    assert_eq!(checker.work().pairs_made, made + 4);
}

#[test]
fn removed_bodies_and_unknown_names_are_errors_that_say_so() {
    let mut checker = Checker::new(arm(), cell()).expect("a world");
    let at = Isometry3::translation(0.0, 3.0, 0.0);
    let ball = || Shape::ball(0.1).expect("a ball");
    let post = checker.cell_mut().put("post", ball(), at);
    assert_eq!(checker.cell_mut().remove_obstacle(post), Ok(vec![post]));
    let found = checker.cell_mut().move_obstacle(post, at);
    assert_eq!(found, Err(PlanError::Removed(post)));
    assert_eq!(post.to_string(), "obstacle 0");
    let next = checker.cell_mut().put("post", ball(), at);
    assert_eq!(next, CellBody::Obstacle(1));
    let text = |error: PlanError| error.to_string();
    let missing = checker
        .cell_mut()
        .move_obstacle("posts", at)
        .expect_err("a misspelt name");
    assert_eq!(text(missing), "body \"posts\" does not exist (nearest: \"post\")");
    let robot = checker.cell_mut().move_obstacle("hand", at).expect_err("a link");
    assert_eq!(text(robot), "hand is not an obstacle");
    let bare = checker.cell_mut().exclude("tool", "post").expect_err("a frame");
    assert_eq!(text(bare), "link \"tool\" has no bodies, so it has no pairs");
    let link = checker
        .cell_mut()
        .attach("tol", "part", ball(), at, &[])
        .expect_err("a misspelt link");
    assert_eq!(text(link), "body \"tol\" does not exist (nearest: \"tool\")");
    let far = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(checker.cell_mut().add_obstacle("far", ball(), far).is_err());
    assert!(checker.cell_mut().move_obstacle("post", far).is_err());
    for (link, name) in [("hand", "twin"), ("tool", "twin#2")] {
        let name = (checker.cell().free_name("twin") == name)
            .then_some(name)
            .expect("a free name");
        checker.cell_mut().carry(link, name, ball(), Isometry3::identity(), &[]);
    }
    for taken in ["twin", "hand", "tool"] {
        let error = checker
            .cell_mut()
            .attach("hand", taken, ball(), Isometry3::identity(), &[]);
        let expected = format!("object {taken:?}: the name is taken (expected another one)");
        assert_eq!(text(error.expect_err("a taken name")), expected);
        let error = checker.cell_mut().add_obstacle(taken, ball(), Isometry3::identity());
        let answer = text(error.expect_err("a taken name"));
        assert_eq!(answer, expected.replace("object", "obstacle"));
    }
    let twins = ["twin".to_owned(), "twin#2".to_owned()];
    let error = checker.detach_at(&twins[..], &[0.0; 3]).expect_err("two objects");
    assert_eq!(text(error), "2 bodies are named \"twin\" (expected one)");
    assert_eq!(checker.cell_mut().detach(&twins[..]).map(|ids| ids.len()), Ok(2));
    // The names are free again.
    assert_eq!(checker.cell().free_name("twin"), "twin");
    assert!(checker.cell_mut().pad("post", -0.1).is_err());
    let found = checker.cell().excluded_names();
    assert_eq!(found, [(["fore", "hand"], "User"), (["fore", "upper"], "User")]);
}

#[test]
fn a_world_that_does_not_fit_is_an_error_of_every_call() {
    let mut checker = Checker::new(arm(), cell()).expect("a world");
    let good = checker.cell().clone();
    let (q, p) = ([0.1, 0.2, 0.1], [0.3, 0.2, 0.1]);
    let free = checker.is_free_at(&q);
    let motion = JointMotion::segment(&q, &p);
    let mut more = good.clone();
    let extra = more.robot_body("extra", cuboid([0.1, 0.1, 0.1]));
    let faults: [fn(&mut Cell, Cell); 3] = [
        |cell, _| _ = cell.robot_body("extra", cuboid([0.1, 0.1, 0.1])),
        |cell, _| *cell = Cell::new(),
        |cell, more| *cell = more,
    ];
    for fault in faults {
        fault(&mut checker.cell_mut(), more.clone());
        let boxes = checker.fork().err();
        let said = checker.is_free_at(&q).expect_err("another robot");
        assert!(matches!(said, PlanError::Bodies { .. }), "{said}");
        assert_eq!(boxes, Some(said.clone()));
        let options = RangeOptions::default();
        for found in [
            checker.in_contact(&q).map(|_| ()),
            checker.clearance(&q).map(|_| ()),
            checker.nearest(&q, 0.1).map(|_| ()),
            checker.nearest_batch(&q, 1, 0.1, 1).map(|_| ()),
            checker.certify(&motion).map(|_| ()),
            checker.is_free(&motion).map(|_| ()),
            checker.tube_contact(&motion, 0, 0.0).map(|_| ()),
            checker.clearance_along(&motion, 0.1).map(|_| ()),
            checker.pose(extra, &q).map(|_| ()),
            checker.link_pose("tool", &q).map(|_| ()),
            checker.set_time(1.0),
            checker.detach_at("part", &q).map(|_| ()),
            RangeProver::new(&options).all_pairs(&mut checker, &q, &p).map(|_| ()),
            RrtConnect::new(&PlanOptions::default())
                .plan(&mut checker, &q, &p)
                .map(|_| ()),
            Shortcuts::new(1, 1)
                .shorten(&mut checker, &[q.to_vec(), p.to_vec(), q.to_vec()])
                .map(|_| ()),
            widen(&mut checker, &[q.to_vec(), p.to_vec(), q.to_vec()], 0.1, 0.1, 1).map(|_| ()),
            PairBoxes::search(&mut checker, 1, &mut |_| ControlFlow::Continue(())).map(|_| ()),
        ] {
            assert!(found.is_err(), "{found:?}");
        }
        assert!(Receipt::motion(&mut checker, &motion).is_err());
        *checker.cell_mut() = good.clone();
        assert_eq!(checker.is_free_at(&q), free);
    }
}

#[test]
fn an_object_that_is_put_down_stays_where_it_was() {
    let mut rng = Rng::new(19);
    for _ in 0..30 {
        let mut checker = Checker::new(arm(), cell()).expect("a world");
        let (shape, grip, q) = (geometry(&mut rng), pose(&mut rng, 0.2), sample(&mut rng));
        let id = checker.cell_mut().carry("tool", "part", shape, grip, &["hand"]);
        let at = checker.pose(id, &q).expect("a pose");
        let link = checker.link_pose("tool", &q).expect("a pose");
        assert!(((link * grip).translation.vector - at.translation.vector).norm() < 1e-12);
        let left = checker.detach_at("part", &q).expect("a part");
        assert_eq!(checker.cell().obstacle_pose(left), Some(&at));
        assert_eq!(checker.pose(id, &q), Err(PlanError::Removed(id)));
    }
}

#[test]
fn gradients_equal_finite_differences() {
    let (mut rng, mut count) = (Rng::new(23), 0);
    for _ in 0..8 {
        let mut checker = loaded(&mut rng);
        for _ in 0..10 {
            let q: Vec<f64> = vec![rng.range(-2.0, 2.0), rng.range(-2.0, 2.0), rng.range(0.05, 0.25)];
            let near = checker.nearest(&q, 0.3).expect("a configuration");
            for n in near.iter().filter(|n| n.lower > 1e-3) {
                for k in 0..3 {
                    let h = 1e-6;
                    let mut at = |x: f64| {
                        let mut moved = q.clone();
                        moved[k] += x;
                        let all = checker.nearest(&moved, f64::INFINITY).expect("a configuration");
                        all.iter().find(|m| m.pair == n.pair).expect("the pair").distance
                    };
                    // At a kink the differences to both sides differ.
                    let (up, down) = ((at(h) - n.distance) / h, (n.distance - at(-h)) / h);
                    if (up - down).abs() < 1e-4 {
                        let off = (n.gradient[k] - 0.5 * (up + down)).abs();
                        assert!(off < 1e-4, "{n:?} {k} {up} {down}");
                        count += 1;
                    }
                }
            }
        }
    }
    assert!(count > 300, "{count}");
}

#[test]
fn gradients_of_rigid_bodies_equal_finite_differences() {
    let mut cell = Cell::new();
    cell.robot_body("plank", cuboid([0.5, 0.1, 0.05]));
    cell.put(
        "ball",
        Shape::ball(0.2).expect("a ball"),
        Isometry3::translation(0.2, 1.0, 0.3),
    );
    let space = RigidSpace::new([[-4.0, 4.0]; 3], 0.5, 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    checker.cell_mut().carry(
        "plank",
        "knob",
        Shape::ball(0.2).expect("a ball"),
        Isometry3::translation(0.4, 0.2, 0.0),
        &[],
    );
    let mut rng = Rng::new(29);
    for _ in 0..50 {
        let q = RigidSpace::configuration(&pose(&mut rng, 0.3));
        let near = checker.clearance(&q).expect("a configuration").expect("a pair");
        if near.lower < 0.01 {
            continue;
        }
        for k in 0..6 {
            let mut at = |h: f64| {
                let step: Vec<f64> = (0..6).map(|i| if i == k { h } else { 0.0 }).collect();
                let moved = checker.space().moved(&q, &step);
                let all = checker.nearest(&moved, f64::INFINITY).expect("a configuration");
                all.iter().find(|n| n.pair == near.pair).expect("the pair").distance
            };
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((near.gradient[k] - slope).abs() < 1e-4, "{near:?} {k} {slope}");
        }
    }
}

#[test]
fn a_batch_has_the_bits_of_new_checkers_on_any_number_of_threads() {
    let mut rng = Rng::new(31);
    let mut checker = loaded(&mut rng);
    let rows: Vec<Vec<f64>> = (0..17).map(|_| sample(&mut rng)).collect();
    let flat = rows.concat();
    let one = checker.nearest_batch(&flat, 3, 0.2, 1).expect("configurations");
    for threads in [2, 3, 16, 100] {
        let more = checker.nearest_batch(&flat, 3, 0.2, threads).expect("configurations");
        assert_eq!(format!("{more:?}"), format!("{one:?}"));
    }
    for (row, q) in rows.iter().enumerate() {
        checker.reset();
        let near = checker.nearest(q, 0.2).expect("a configuration");
        assert_eq!(one.counts[row], near.len().min(3));
        for (k, n) in near.iter().take(3).enumerate() {
            let at = 3 * row + k;
            assert_eq!(one.pairs[at], Some(n.pair));
            assert_eq!(one.distances[at].to_bits(), n.distance.to_bits());
            assert_eq!(one.gradients[3 * at..3 * at + 3], n.gradient);
            assert_eq!(one.points_b[at], <[f64; 3]>::from(n.witnesses[1].coords));
        }
    }
    let mut bad = flat;
    bad[3 * 11] = 99.0;
    let error = checker.nearest_batch(&bad, 3, 0.2, 4).expect_err("a bad configuration");
    assert!(
        error.to_string().starts_with("configuration 11: coordinate 0"),
        "{error}"
    );
    assert!(checker.nearest_batch(&[0.0; 4], 3, 0.2, 4).is_err());
    assert!(
        checker
            .nearest_batch(&[], 3, 0.2, 0)
            .expect("no rows")
            .counts
            .is_empty()
    );
}

#[cfg(feature = "serde")]
#[test]
fn worlds_and_answers_are_stored() {
    let mut rng = Rng::new(37);
    for _ in 0..5 {
        let mut checker = loaded(&mut rng);
        checker
            .cell_mut()
            .remove_obstacle(CellBody::Obstacle(0))
            .expect("an obstacle");
        let text = serde_json::to_string(checker.cell()).expect("a world");
        let cell: Cell = serde_json::from_str(&text).expect("a world");
        let mut read = Checker::new(arm(), cell).expect("a world");
        let (q, p) = (sample(&mut rng), sample(&mut rng));
        for question in 0..4 {
            checker.reset();
            assert_eq!(ask(&mut read, question, &q, &p), ask(&mut checker, question, &q, &p));
            read.reset();
        }
        let verdict = checker.verdict_of(&JointMotion::segment(&q, &p));
        let text = serde_json::to_string(&verdict).expect("a verdict");
        assert_eq!(serde_json::from_str::<Verdict>(&text).expect("a verdict"), verdict);
    }
    let bad = r#"{"robot":[],"frames":[],"attached":[],"obstacles":[],"excluded":[],"margin":-1.0,"paddings":[],"margins":[]}"#;
    assert!(serde_json::from_str::<Cell>(bad).is_err());
}
