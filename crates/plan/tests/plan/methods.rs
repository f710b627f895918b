//! The methods of the planner: each makes paths of proven segments.

use lin_canny::Progress;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, EdgeKind, JointMotion, Opportunistic, Plan, PlanMethod, PlanOptions,
    PlanarSpace, RigidSpace, RrtConnect, Shortcuts,
};
use truth::plans::{Ask, Furnish, cuboid};

/// A rectangle in the plane, and two walls with a gap in which it fits lengthwise only.
fn gap(half: f64) -> (Checker<PlanarSpace>, [[f64; 3]; 2]) {
    let mut cell = Cell::new();
    let rectangle = cuboid([0.5, 0.1, 0.1]);
    cell.robot_body("rectangle", rectangle);
    for side in [1.0, -1.0] {
        let wall = cuboid([0.3, 1.0, 1.0]);
        cell.put(
            cell.free_name("wall"),
            wall,
            Isometry3::translation(0.0, side * (1.0 + half), 0.0),
        );
    }
    let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 1).expect("a space");
    let checker = Checker::new(space, cell).expect("a world");
    (checker, [[-1.5, 0.5, 1.57], [1.5, -0.5, 1.57]])
}

fn plan(half: f64, method: PlanMethod, options: &PlanOptions) -> Plan {
    let (mut checker, [start, goal]) = gap(half);
    let found = match method {
        PlanMethod::RrtConnect => RrtConnect::new(options).plan(&mut checker, &start, &goal),
        _ => Opportunistic::new(options).plan(&mut checker, &start, &goal),
    };
    found.expect("free ends")
}

fn options(seed: u64) -> PlanOptions {
    PlanOptions::default().seed(seed)
}

/// The number of steps of a search.
fn steps(plan: &Plan) -> u64 {
    plan.work.samples / 16 + plan.work.checks.segments + plan.work.checks.configurations
}

#[test]
fn every_method_makes_paths_of_proven_segments() {
    assert_eq!(PlanMethod::default(), PlanMethod::RrtConnect);
    for method in PlanMethod::ALL {
        assert_eq!(PlanMethod::from_name(method.name()), Some(method));
        for seed in 0..4 {
            let found = plan(0.25, method, &options(seed));
            let path = found.path.as_ref().expect("there is a way");
            let (mut judge, [start, goal]) = gap(0.25);
            assert_eq!([&path[0], &path[path.len() - 1]], [&start.to_vec(), &goal.to_vec()]);
            assert!(judge.is_free_along(&JointMotion::path(path).expect("a motion")));
            let work = &found.work;
            match method {
                PlanMethod::RrtConnect => assert!(work.samples > 0 && work.freeways + work.slices == 0, "{work:?}"),
                PlanMethod::Opportunistic => assert!(work.samples == 0 && work.extensions == [0, 0], "{work:?}"),
                other => panic!("{other:?} has no case"),
            }
            assert_eq!(found, plan(0.25, method, &options(seed)), "the same seed");
        }
    }
    assert_eq!(PlanMethod::from_name("RRT-Connect"), None);
}

#[test]
fn edges_of_the_trees_are_proven() {
    let found = plan(0.25, PlanMethod::RrtConnect, &options(3));
    let (mut judge, [start, goal]) = gap(0.25);
    let roadmap = &found.roadmap;
    assert_eq!([&roadmap.nodes[0][..], &roadmap.nodes[1][..]], [&start[..], &goal[..]]);
    assert_eq!(roadmap.component(0), roadmap.component(1));
    assert_eq!(roadmap.edges.len() as u64, found.work.extensions[1]);
    // Two trees that are joined by one edge, which hold every configuration.
    assert_eq!(roadmap.edges.len() + 1, roadmap.nodes.len());
    for edge in &roadmap.edges {
        assert_eq!(edge.kind, EdgeKind::Tree);
        let [a, b] = edge.ends.map(|node| &roadmap.nodes[node]);
        assert!(judge.is_free_along(&JointMotion::segment(a, b)));
    }
    for q in found.path.iter().flatten() {
        assert!(roadmap.nodes.contains(q));
    }
}

/// Trackers, boxes and recent collisions of a checker that was used change the time only.
#[test]
fn the_state_of_a_checker_does_not_change_the_path() {
    let (mut used, [start, goal]) = gap(0.25);
    for seed in 0..6 {
        let options = options(seed);
        let warm = RrtConnect::new(&options)
            .plan(&mut used, &start, &goal)
            .expect("free ends");
        let cold = plan(0.25, PlanMethod::RrtConnect, &options);
        assert_eq!((&warm.path, &warm.roadmap), (&cold.path, &cold.roadmap), "seed {seed}");
        assert_eq!(steps(&warm), steps(&cold), "seed {seed}");
    }
}

#[test]
fn budgets_end_every_method() {
    // The gap is closed.
    let closed = |method, options: &PlanOptions| {
        let found = plan(0.05, method, options);
        assert_eq!(found.path, None, "{options:?}");
        found.work
    };
    let trees = |options: &PlanOptions| closed(PlanMethod::RrtConnect, options);
    assert_eq!(trees(&options(1).samples(0)).samples, 0);
    assert_eq!(trees(&options(1).samples(70)).samples, 70);
    let work = trees(&options(1).unlimited().queries(2000));
    assert!(work.samples > 0 && work.freeways == 0, "{work:?}");
    let work = closed(PlanMethod::Opportunistic, &options(1).samples(0).slices(2));
    assert!(work.slices == 2 && work.samples == 0, "{work:?}");
}

#[test]
fn a_callback_stops_every_method() {
    for method in PlanMethod::ALL {
        let (mut checker, [start, goal]) = gap(0.05);
        let (mut calls, mut last) = (0, 0);
        let endless = options(2).unlimited();
        let mut stop = |now: Progress| {
            assert!(now.done >= last, "{now:?}");
            (calls, last) = (calls + 1, now.done);
            Progress::stop_if(calls == 20)
        };
        let found = method.plan(&mut checker, [&start, &goal], &endless, &mut stop);
        assert_eq!(found.expect("free ends").path, None, "{method:?}");
        assert_eq!(calls, 20, "{method:?}");
    }
}

/// No pair is near: growth costs no query, and still ends.
#[test]
fn a_search_without_queries_ends() {
    let mut cell = Cell::new();
    let die = cuboid([0.1; 3]);
    cell.robot_body("die", die);
    // A closed box of thin walls around the goal.
    for axis in 0..3 {
        let mut half = Vector3::repeat(0.4);
        half[axis] = 0.02;
        let wall = solids::cuboid(half).expect("a box");
        for side in [-0.4, 0.4] {
            let mut at = Vector3::new(3.0, 0.0, 0.0);
            at[axis] += side;
            cell.put(
                cell.free_name("wall"),
                wall.clone(),
                Isometry3::translation(at.x, at.y, at.z),
            );
        }
    }
    let space = RigidSpace::new([[-50.0, 50.0]; 3], 0.2, 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    let at = |x: f64| RigidSpace::configuration(&Isometry3::translation(x, 0.0, 0.0));
    let trees = options(1).samples(3000);
    let found = RrtConnect::new(&trees)
        .plan(&mut checker, &at(-3.0), &at(3.0))
        .expect("free ends");
    assert_eq!((found.path, found.work.samples), (None, 3000));
}

/// Shortening without tries removes corners as passes over all of them do, but tries none twice.
#[test]
fn corners_are_tried_once() {
    let (mut ours, mut theirs) = (0, 0);
    for seed in 0..6 {
        let found = plan(0.14, PlanMethod::Opportunistic, &options(seed));
        let path = found.path.expect("there is a way");
        let (mut checker, _) = gap(0.14);
        let before = checker.work().segments;
        let short = Shortcuts::new(0, 1).shorten(&mut checker, &path).expect("a path");
        // The passes after the random tries find nothing new.
        ours += checker.work().segments - before;
        let (mut judge, _) = gap(0.14);
        let (mut passes, mut left) = (path.clone(), usize::MAX);
        while passes.len() < left {
            left = passes.len();
            let mut k = 1;
            while k + 1 < passes.len() {
                let way = judge.space().path_length(&passes[k - 1..=k + 1]);
                let ends = [passes[k - 1].clone(), passes[k + 1].clone()];
                let is_shorter = judge.space().distance(&ends[0], &ends[1]) <= way;
                theirs += u64::from(is_shorter);
                if is_shorter
                    && judge
                        .is_free(&JointMotion::segment(&ends[0], &ends[1]))
                        .expect("a segment")
                {
                    passes.remove(k);
                } else {
                    k += 1;
                }
            }
        }
        assert_eq!(short, passes, "seed {seed}");
        assert!(judge.is_free_along(&JointMotion::path(&short).expect("a motion")));
    }
    println!("{ours} segments instead of {theirs}");
    assert!(ours < theirs, "{ours} {theirs}");
}
