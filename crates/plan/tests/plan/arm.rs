//! The arm of the example `arm` in its cell, through a window in a wall that stands between the bins.

use cpu_time::ThreadTime;
use lin_canny::Progress;
use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Checker, ConfigurationSpace, JointMotion, JointTree, PlanOptions, RrtConnect, Shortcuts};
use std::time::Duration;
use truth::arm::{self, motion};
use truth::plans::{Ask, Furnish, cuboid};

/// The cell with a wall that the arm can pass through a window alone, so many metres high.
fn checker(window: f64) -> Checker<JointTree> {
    const TOP: f64 = 1.7;
    const SILL: f64 = 0.4;
    let (arm, mut cell) = arm::in_cell().expect("the built-in cell");
    for (name, x, [low, high]) in [
        ("sill", 0.65, [0.0, SILL]),
        ("lintel", 0.65, [SILL + window, TOP]),
        ("back wall", -0.65, [0.0, TOP]),
    ] {
        let wall = cuboid([0.5, 0.01, 0.5 * (high - low)]);
        cell.put(name, wall, Isometry3::translation(x, 0.0, 0.5 * (low + high)));
    }
    Checker::new(arm, cell).expect("a cell")
}

/// Every configuration of a dense sample is apart, by distances alone.
fn judge(checker: &mut Checker<JointTree>, path: &[Vec<f64>]) {
    assert!(checker.is_free_along(&JointMotion::path(path).expect("a motion")));
    for ends in path.windows(2) {
        for k in 0..=200 {
            let q = checker.space().between(&ends[0], &ends[1], f64::from(k) / 200.0);
            let near = checker.clearance(&q).expect("a configuration").expect("a pair");
            assert!(near.lower > 0.0, "{near:?} at {q:?}");
        }
    }
}

/// From bin to bin: how many seeds find a way within 10 s of processor time, and the longest time.
fn window(height: f64, seeds: u64) -> (u64, Duration) {
    let (mut solved, mut longest) = (0, Duration::ZERO);
    for seed in 0..seeds {
        let mut checker = checker(height);
        let [start, goal] = [0.2, 0.6].map(motion::carry);
        let options = PlanOptions::default().seed(seed);
        let began = ThreadTime::now();
        let limit = Duration::from_secs(10);
        let plan = RrtConnect::new(&options)
            .progress(&mut |_| Progress::stop_if(began.elapsed() > limit))
            .plan(&mut checker, &start, &goal)
            .expect("free ends");
        let took = began.elapsed();
        longest = longest.max(took);
        println!("window {height} seed {seed}: {took:?} {:?}", plan.work);
        let Some(path) = plan.path else { continue };
        solved += 1;
        assert_eq!((&path[0], &path[path.len() - 1]), (&start, &goal));
        judge(&mut checker, &path);
        let short = Shortcuts::new(100, seed).shorten(&mut checker, &path).expect("a path");
        judge(&mut checker, &short);
    }
    (solved, longest)
}

#[test]
fn an_arm_passes_a_window() {
    let (solved, longest) = window(0.5, 2);
    assert!(solved == 2, "{solved} in up to {longest:?}");
}

#[test]
#[ignore = "a minute: 20 seeds for each window"]
fn windows_are_passed_for_twenty_seeds() {
    // The gripper is 0.14 wide and 0.05 thick, the forearm 0.10 by 0.09.
    let found = [0.5, 0.35].map(|height| (height, window(height, 20)));
    println!("{found:?}");
    assert!(found.iter().all(|(_, (solved, _))| *solved >= 19), "{found:?}");
}
