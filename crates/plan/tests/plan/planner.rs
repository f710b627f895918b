//! Paths of each method: judged by dense predicates; a blocked world has none.

use crate::judge::{Placed, first_contact, pose_of};
use crate::wrapped::Wrapped;
use cpu_time::ThreadTime;
use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Piece, Progress};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, FreewayEnd, JointMotion, Opportunistic, PlanError, PlanMethod, PlanOptions,
    PlanarSpace, RigidSpace, RrtConnect, Shortcuts, TranslationSpace,
};
use std::time::Duration;
use truth::plans::{Ask, Furnish, cuboid};
use truth::rooms::wall;

fn cell(robot: &ConvexPolyhedron, obstacles: &[Placed]) -> Cell {
    let mut cell = Cell::new();
    cell.robot_body("robot", robot.clone());
    for (k, (hull, pose)) in obstacles.iter().enumerate() {
        cell.put(k, hull.clone(), *pose);
    }
    cell
}

/// Judges every segment of a path of a rigid body.
fn judge(path: &[Vec<f64>], robot: &ConvexPolyhedron, obstacles: &[Placed], steps: usize) {
    for ends in path.windows(2) {
        let [p, q] = [0, 1].map(|k| pose_of(&ends[k]));
        let contact = first_contact(std::slice::from_ref(robot), obstacles, [&p, &q], 1.0, steps);
        assert_eq!(contact, None, "{ends:?}");
    }
}

fn options(seed: u64) -> PlanOptions {
    PlanOptions::default().seed(seed)
}

/// A plank that must turn to pass a hole, and comes turned wrongly: how many seeds find a way within a limit of processor time.
fn passage(width: f64, method: PlanMethod, seeds: u64, limit: Duration) -> (u64, Duration) {
    let robot = cuboid([0.8, 0.1, 0.1]);
    let obstacles = wall(width);
    let (mut solved, mut longest) = (0, Duration::ZERO);
    for seed in 0..seeds {
        let (space, [start, goal]) = truth::rooms::passage();
        let mut checker = Checker::new(space, cell(&robot, &obstacles)).expect("a world");
        let began = ThreadTime::now();
        let mut stop = |_| Progress::stop_if(began.elapsed() > limit);
        let plan = method.plan(&mut checker, [&start, &goal], &options(seed), &mut stop);
        let plan = plan.expect("free ends");
        let took = began.elapsed();
        longest = longest.max(took);
        println!("{} width {width} seed {seed}: {took:?} {:?}", method.name(), plan.work);
        let Some(path) = plan.path else { continue };
        solved += 1;
        assert_eq!((&path[0], &path[path.len() - 1]), (&start, &goal));
        judge(&path, &robot, &obstacles, 200);
        assert!(checker.is_free_along(&JointMotion::path(&path).expect("a motion")));
        let short = Shortcuts::new(100, seed).shorten(&mut checker, &path).expect("a path");
        assert!(checker.space().path_length(&short) <= checker.space().path_length(&path) * (1.0 + 1e-12));
        assert!(checker.is_free_along(&JointMotion::path(&short).expect("a motion")));
        judge(&short, &robot, &obstacles, 400);
    }
    (solved, longest)
}

#[test]
fn a_wide_passage_is_found() {
    for method in PlanMethod::ALL {
        let (solved, longest) = passage(0.6, method, 4, Duration::from_secs(10));
        assert!(solved == 4, "{method:?}: {solved} in up to {longest:?}");
    }
}

#[test]
#[ignore = "a minute: 20 seeds for each width"]
fn passages_are_found_for_twenty_seeds() {
    // The plank is 0.2 thick.
    for method in PlanMethod::ALL {
        let found = [0.6, 0.4, 0.3].map(|width| (width, passage(width, method, 20, Duration::from_secs(10))));
        println!("{method:?}: {found:?}");
        assert!(
            found.iter().all(|(_, (solved, _))| *solved >= 19),
            "{method:?}: {found:?}"
        );
    }
}

#[test]
fn a_callback_follows_and_stops_the_shortening_of_a_path() {
    let robot = cuboid([0.8, 0.1, 0.1]);
    let (space, [start, goal]) = truth::rooms::passage();
    let mut checker = Checker::new(space, cell(&robot, &wall(0.6))).expect("a world");
    let path = RrtConnect::new(&options(0))
        .plan(&mut checker, &start, &goal)
        .expect("free ends")
        .path;
    let path = path.expect("a wide passage");
    checker.reset();
    let whole = Shortcuts::new(60, 7).shorten(&mut checker, &path).expect("a path");
    let mut reports = Vec::new();
    checker.reset();
    let followed = Shortcuts::new(60, 7)
        .progress(&mut |progress| {
            reports.push(progress);
            Progress::stop_if(false)
        })
        .shorten(&mut checker, &path);
    assert_eq!(followed.expect("a path"), whole);
    assert!(
        reports
            .iter()
            .all(|p| p.stage == "shortcuts" && p.total == Some(60) && p.done <= 60)
    );
    assert!(reports.len() > 20, "{reports:?}");
    assert!(reports.is_sorted_by_key(|p| p.done), "{reports:?}");
    let mut lengths = Vec::new();
    for stop in (0..reports.len()).step_by(8) {
        let mut calls = 0;
        checker.reset();
        let short = Shortcuts::new(60, 7)
            .progress(&mut |_| {
                calls += 1;
                Progress::stop_if(calls > stop)
            })
            .shorten(&mut checker, &path);
        let short = short.expect("a path");
        assert_eq!(calls, stop + 1);
        assert!(checker.is_free_along(&JointMotion::path(&short).expect("a motion")));
        assert_eq!((&short[0], &short[short.len() - 1]), (&start, &goal));
        lengths.push(checker.space().path_length(&short));
    }
    assert!(
        lengths.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-12)),
        "{lengths:?}"
    );
}

/// A closed wall, and a box with the goal inside: never a path.
#[test]
fn a_blocked_world_has_no_path() {
    let robot = cuboid([0.3, 0.1, 0.1]);
    let bounds = [[-2.5, 2.5], [-2.0, 2.0], [-2.0, 2.0]];
    let at = |x: f64| RigidSpace::configuration(&Isometry3::translation(x, 0.0, 0.0));
    // Closed, and with a hole that the thinnest section does not pass.
    for obstacles in [vec![(cuboid([0.25, 5.0, 5.0]), Isometry3::identity())], wall(0.19)] {
        for seed in 0..3 {
            let space = RigidSpace::new(bounds, 0.3, 1).expect("a space");
            let mut checker = Checker::new(space, cell(&robot, &obstacles)).expect("a world");
            let plan = Opportunistic::new(&options(seed).slices(12))
                .plan(&mut checker, &at(-2.0), &at(2.0))
                .expect("free ends");
            assert_eq!(plan.path, None);
            assert!(plan.work.slices == 12 && plan.work.freeways > 0, "{:?}", plan.work);
        }
    }
}

/// The same seed gives the same answer to the bit; budgets end a search.
#[test]
fn searches_repeat_and_end() {
    let robot = cuboid([0.8, 0.1, 0.1]);
    let obstacles = wall(0.6);
    let run = |options: &PlanOptions| {
        let space = RigidSpace::new([[-2.5, 2.5], [-2.0, 2.0], [-2.0, 2.0]], 0.8, 1).expect("a space");
        let mut checker = Checker::new(space, cell(&robot, &obstacles)).expect("a world");
        let at = |x: f64, y: f64| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * 1.5);
            RigidSpace::configuration(&Isometry3::from_parts(Vector3::new(x, y, 0.0).into(), turn))
        };
        RrtConnect::new(options)
            .plan(&mut checker, &at(-1.8, -1.0), &at(1.8, 1.0))
            .expect("free ends")
    };
    let few = options(9).slices(3);
    assert_eq!(run(&few), run(&few));
    let none = options(9).queries(1);
    let ended = run(&none);
    assert!(ended.path.is_none() && ended.work.slices == 0, "{:?}", ended.work);
}

#[test]
fn ends_in_contact_are_named() {
    let robot = cuboid([0.8, 0.1, 0.1]);
    let space = RigidSpace::new([[-3.0, 3.0]; 3], 0.8, 1).expect("a space");
    let mut checker = Checker::new(space, cell(&robot, &wall(0.5))).expect("a world");
    let at = |x: f64| RigidSpace::configuration(&Isometry3::translation(x, 1.0, 1.0));
    let refused = RrtConnect::new(&options(0)).plan(&mut checker, &at(-2.0), &at(0.5));
    assert!(
        matches!(refused, Err(PlanError::Contact { end: "goal", .. })),
        "{refused:?}"
    );
}

/// A rectangle in the plane through a gap in which it fits lengthwise only.
#[test]
fn a_rectangle_turns_in_the_plane() {
    for seed in 0..3 {
        let mut cell = Cell::new();
        cell.robot_body("rectangle", cuboid([0.5, 0.1, 0.1]));
        for (y, name) in [(1.15, "left"), (-1.15, "right")] {
            cell.put(name, cuboid([0.3, 1.0, 1.0]), Isometry3::translation(0.0, y, 0.0));
        }
        let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 1).expect("a space");
        let mut checker = Checker::new(space, cell).expect("a world");
        let (start, goal) = ([-1.5, 0.5, 1.57], [1.5, -0.5, 1.57]);
        let plan = RrtConnect::new(&options(seed))
            .plan(&mut checker, &start, &goal)
            .expect("free ends");
        let path = plan.path.expect("there is a way");
        assert!(checker.is_free_along(&JointMotion::path(&path).expect("a motion")));
    }
}

/// A rod among posts, its start and its goal exactly half a turn apart; the first three of the seeds give roadmaps that drive
/// half a turn backwards.
fn half_turns<C: ConfigurationSpace + Clone>(space: &C) -> u32 {
    let mut found = 0;
    for seed in [17, 341, 1965].into_iter().chain(0..40) {
        let mut rng = truth::rng::Rng::of_case(17, seed);
        let mut cell = Cell::new();
        cell.robot_body("rod", cuboid([rng.range(0.4, 1.0), 0.05, 0.1]));
        for k in 0..4 + rng.below(20) {
            let at = Vector3::new(rng.range(-3.5, 3.5), rng.range(-2.5, 2.5), 0.0);
            let pose = Isometry3::from_parts(at.into(), UnitQuaternion::identity());
            cell.put(k, cuboid([0.08, 0.08, 1.0]), pose);
        }
        let mut checker = Checker::new(space.clone(), cell).expect("a world");
        let turned = *rng.pick(&[0.0, std::f64::consts::PI]);
        let start = [-3.0, rng.range(-1.9, 1.9), turned];
        let goal = [
            *rng.pick(&[-3.0, 3.0]),
            rng.range(-1.9, 1.9),
            std::f64::consts::PI - turned,
        ];
        let few = options(seed).slices(20);
        // Some ends are in contact.
        let Ok(Some(path)) = RrtConnect::new(&few)
            .plan(&mut checker, &start, &goal)
            .map(|plan| plan.path)
        else {
            continue;
        };
        found += 1;
        let verdict = checker.verdict_of(&JointMotion::path(&path).expect("a motion"));
        assert!(verdict.is_free(), "seed {seed}: {verdict:?} of {path:?}");
        let short = Shortcuts::new(50, seed).shorten(&mut checker, &path).expect("a path");
        let verdict = checker.verdict_of(&JointMotion::path(&short).expect("a motion"));
        assert!(verdict.is_free(), "seed {seed}, shortened: {verdict:?} of {short:?}");
    }
    found
}

/// Half a turn in a plane goes counterclockwise from either end: not the same motion backwards, against the contract.
fn one_way(space: &PlanarSpace, from: &[f64], to: &[f64]) -> Vec<f64> {
    let mut to = to.to_vec();
    let turn = space.difference(from, &to)[2];
    // Half a turn and a little more is the other way round, as the shorter way goes.
    if turn < 1e-7 - std::f64::consts::PI {
        to[2] -= 1e-7;
    }
    to
}

#[test]
fn paths_with_half_turns_are_free_in_the_direction_of_travel() {
    let space = PlanarSpace::new([[-3.0, 3.0], [-2.0, 2.0]], 0.9, 1).expect("a space");
    let found = half_turns(&space);
    assert!(found > 25, "{found} paths");
    let found = half_turns(&Wrapped::with_ends(space, one_way));
    assert!(found > 20, "{found} paths");
}

/// Along a freeway no small step within the slice has more clearance, but for the precision of the ascent; the freeway of a
/// corridor is its middle.
#[test]
fn freeways_are_local_maxima_in_their_slices() {
    let robot = cuboid([0.3, 0.1, 0.1]);
    let obstacles: Vec<Placed> = [(0.0, 1.0), (0.4, -1.0)]
        .iter()
        .map(|&(tilt, side)| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * (0.1 * tilt));
            let pose = Isometry3::from_parts(Vector3::new(0.0, 1.5 * side, 0.0).into(), turn);
            (cuboid([4.0, 0.5, 4.0]), pose)
        })
        .collect();
    let bounds = [[-2.0, 2.0]; 3];
    // A post keeps the straight way closed.
    let mut all = obstacles.clone();
    all.push((cuboid([0.2, 0.6, 1.5]), Isometry3::translation(0.0, 0.0, 0.0)));
    let space = TranslationSpace::new(bounds, UnitQuaternion::identity(), 1).expect("a space");
    let mut checker = Checker::new(space, cell(&robot, &all)).expect("a world");
    let plan = Opportunistic::new(&options(1))
        .plan(&mut checker, &[-1.5, 0.3, 0.1], &[1.5, -0.3, 0.0])
        .expect("free ends");
    let (mut judged, mut kept) = (0, 0);
    for freeway in &plan.roadmap.freeways {
        assert!(
            freeway.ends.iter().all(|end| *end != FreewayEnd::Budget),
            "{:?}",
            freeway.ends
        );
        for &node in &freeway.nodes {
            let q = &plan.roadmap.nodes[node];
            let here = checker.clearance(q).expect("a configuration").expect("a pair").distance;
            if here >= 0.5 || freeway.depth > 0 {
                // Clearance enough ends an ascent before the maximum; bridges have smaller slices.
                continue;
            }
            judged += 1;
            let h = 1e-2;
            let is_best = (0..3).filter(|k| *k != freeway.coordinate).all(|k| {
                [h, -h].iter().all(|step| {
                    let mut way = vec![0.0; 3];
                    way[k] = *step;
                    let moved = checker.space().moved(q, &way);
                    let there = checker
                        .clearance(&moved)
                        .expect("a configuration")
                        .expect("a pair")
                        .distance;
                    // Flat directions are no descent; a slope of a tenth would be one.
                    there <= here + 0.1 * h
                })
            });
            kept += u32::from(is_best);
        }
    }
    println!("{kept} of {judged} places");
    assert!(judged > 10 && kept == judged, "{kept} of {judged}");
}

/// Two pieces that move as one; a compound obstacle.
#[test]
fn robots_of_several_pieces() {
    let mut cell = Cell::new();
    cell.robot_body("bar", cuboid([0.5, 0.1, 0.1]));
    cell.robot_body(
        "hook",
        cuboid([0.1, 0.3, 0.1])
            .transformed(&Isometry3::translation(0.4, 0.2, 0.0))
            .expect("a box"),
    );
    let posts = [-1.0, 1.0].map(|y| {
        let mut piece = Piece::new(cuboid([0.2, 0.6, 2.0]));
        piece.pose = Isometry3::translation(0.0, y, 0.0);
        piece
    });
    let gate = lin_canny::Compound::new(posts.to_vec()).expect("two pieces");
    cell.put("gate", gate, Isometry3::identity());
    let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.6, 2).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    let at = |x: f64, y: f64| RigidSpace::configuration(&Isometry3::translation(x, y, 0.0));
    let plan = RrtConnect::new(&options(2))
        .plan(&mut checker, &at(-1.5, 1.0), &at(1.5, -1.0))
        .expect("free ends");
    let path = plan.path.expect("there is a way");
    assert!(checker.is_free_along(&JointMotion::path(&path).expect("a motion")));
}
