//! Promise: what a robot that holds a box is told over a cloud of points is what all points say, one by one, and nothing that is
//! proven free meets.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{Cloud, CloudElement, PairTracker, RelativePose, Shape};
use lin_canny_plan::{CellBody, Checker, JointMotion, JointTree, Verdict};
use lin_canny_robot::{LoadedCell, RobotFiles};
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

/// Radius of the balls at the points.
const RADIUS: f64 = 0.005;

/// A robot, the link that holds the box, and the links that touch the box.
struct Holder {
    file: PathBuf,
    hand: &'static str,
    touching: &'static [&'static str],
    /// The link that stands on the table.
    base: &'static str,
}

fn six_axis() -> Holder {
    Holder {
        file: Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/six_axis.urdf"),
        hand: "gripper",
        touching: &[],
        base: "base",
    }
}

/// Panda of the package `example-robot-data`, whose file the variable names.
fn panda() -> Holder {
    let file = std::env::var_os("LIN_CANNY_PANDA").expect("LIN_CANNY_PANDA is the path of panda.urdf");
    Holder {
        file: file.into(),
        hand: "panda_hand",
        touching: &["panda_leftfinger", "panda_rightfinger"],
        base: "panda_link0",
    }
}

/// Returns what a camera sees of a table, a wall and three balls about a robot, within a millimetre.
fn camera(n: usize) -> Vec<[f32; 3]> {
    let mut rng = Rng::new(31);
    let balls = [[0.5, 0.3, 0.15], [0.45, -0.4, 0.12], [-0.4, 0.3, 0.2]];
    let mut seen = |k: usize| {
        let p = match k % 4 {
            0 | 1 => [rng.range(-0.9, 0.9), rng.range(-0.9, 0.9), 0.0],
            2 => {
                let (ball, u) = (balls[rng.below(3)], rng.unit());
                [0, 1, 2].map(|i| if i < 2 { ball[i] } else { ball[2] } + u[i] * ball[2])
            }
            _ => [0.8, rng.range(-0.9, 0.9), rng.range(0.0, 1.2)],
        };
        p.map(|x| (x + rng.range(-0.001, 0.001)) as f32)
    };
    (0..n).map(&mut seen).collect()
}

/// Returns a checker of the robot with the box over the points; pairs without the cloud are excluded.
fn checker(holder: &Holder, points: &[[f32; 3]]) -> Checker<JointTree> {
    let LoadedCell { cell: setup, .. } = RobotFiles::new(&holder.file).load().expect("a robot");
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let cloud = Cloud::from_f32(points, CloudElement::Ball(RADIUS)).expect("points");
    checker.cell_mut().put("camera", cloud, Isometry3::identity());
    let part = cuboid([0.03, 0.03, 0.06]);
    let at = Isometry3::translation(0.0, 0.0, 0.14);
    checker.cell_mut().carry(holder.hand, "part", part, at, holder.touching);
    checker.cell_mut().exclude(holder.base, "camera").expect("both");
    let own: Vec<CellBody> = checker.cell().bodies().map(|b| b.0).filter(is_own).collect();
    for (k, a) in own.iter().enumerate() {
        for b in &own[k + 1..] {
            checker.cell_mut().exclude(*a, *b).expect("both");
        }
    }
    checker
}

fn is_own(id: &CellBody) -> bool {
    !matches!(id, CellBody::Obstacle(_))
}

fn configuration(rng: &mut Rng, limits: &[[f64; 2]]) -> Vec<f64> {
    limits.iter().map(|[low, high]| rng.range(*low, *high)).collect()
}

/// Returns the limits of the coordinates of the robot.
fn limits(holder: &Holder) -> Vec<[f64; 2]> {
    let LoadedCell { robot, .. } = RobotFiles::new(&holder.file).load().expect("a robot");
    robot.coordinates().iter().map(|c| c.limits).collect()
}

/// Returns bounds of the distance of a body from the balls, over all points; of an overlap any.
fn over_all_points(checker: &Checker<JointTree>, id: CellBody, q: &[f64], points: &[[f32; 3]]) -> [f64; 2] {
    let geometry = checker.cell().geometry(id).expect("a body");
    let at = checker.pose(id, q).expect("a pose");
    let (centre, reach) = geometry.bounding_ball();
    let centre = (at * centre).coords;
    let place = |p: &[f32; 3]| Vector3::from(p.map(f64::from));
    let from_centre = |p: &[f32; 3]| (place(p) - centre).norm();
    let least = points.iter().map(from_centre).fold(f64::INFINITY, f64::min);
    // A point farther from the centre is farther from the body than the nearest point.
    let mut far: Vec<(f64, Vector3<f64>)> = points.iter().map(|p| (from_centre(p), place(p))).collect();
    far.retain(|p| p.0 <= least + 2.0 * reach + 1e-9);
    far.sort_by(|x, y| x.0.total_cmp(&y.0));
    let (ball, mut tracker) = (Shape::ball(RADIUS).expect("a ball"), PairTracker::new());
    let mut bounds = [f64::INFINITY; 2];
    for (from_centre, p) in far {
        if from_centre - reach - RADIUS > bounds[1] + 1e-9 || bounds[1] < 0.0 {
            break;
        }
        let pose = RelativePose::new(&Isometry3::translation(p.x, p.y, p.z), &at).expect("a pose");
        let found = tracker.closest(&ball, geometry, &pose);
        bounds = [bounds[0].min(found.lower), bounds[1].min(found.upper)];
    }
    bounds
}

/// Compares the pairs at random configurations with all points; returns how many of them are free.
fn judge_configurations(holder: &Holder, points: usize, count: usize) -> usize {
    let points = camera(points);
    let mut checker = checker(holder, &points);
    let limits = limits(holder);
    let mut free = 0;
    for k in 0..count {
        let q = configuration(&mut Rng::of_case(7101, k as u64), &limits);
        let near = checker.nearest(&q, f64::INFINITY).expect("a configuration");
        assert!(!near.is_empty());
        let mut is_free = true;
        for pair in &near {
            let [lower, upper] = over_all_points(&checker, pair.pair.a, &q, &points);
            let told = format!("{k}: {lower:e} {upper:e} {pair:?}");
            if upper < -1e-12 {
                assert!(pair.lower <= 0.0 && pair.distance <= 0.0, "{told}");
            } else {
                assert!(pair.lower <= upper + 1e-13 && lower <= pair.upper + 1e-13, "{told}");
                assert!((pair.distance - upper.max(0.0)).abs() < 1e-9, "{told}");
            }
            is_free &= lower > 0.0;
        }
        assert_eq!(checker.is_free_at(&q).expect("a configuration"), is_free, "{k}");
        free += usize::from(is_free);
    }
    free
}

/// Certifies motions of up to a step per joint until so many are free. Asks predicates at places of
/// each free motion, and all points at ten of them. Returns how many motions were blocked and undecided.
fn judge_motions(holder: &Holder, points: usize, step: f64, [count, places]: [usize; 2]) -> [usize; 2] {
    let points = camera(points);
    let (mut checker, mut other) = (checker(holder, &points), checker(holder, &points));
    let limits = limits(holder);
    let own: Vec<CellBody> = checker
        .nearest(&configuration(&mut Rng::new(1), &limits), f64::INFINITY)
        .expect("a configuration")
        .iter()
        .map(|pair| pair.pair.a)
        .collect();
    let (mut free, mut blocked, mut open, mut k) = (0, 0, 0, 0);
    while free < count {
        let mut rng = Rng::of_case(7102, k);
        k += 1;
        let from = configuration(&mut rng, &limits);
        if !other.is_free_at(&from).expect("a configuration") {
            continue;
        }
        let to: Vec<f64> = from
            .iter()
            .zip(&limits)
            .map(|(x, [low, high])| (x + rng.range(-step, step)).clamp(*low, *high))
            .collect();
        match checker.verdict_of(&JointMotion::segment(&from, &to)) {
            Verdict::Free { .. } => free += 1,
            Verdict::Blocked { .. } => {
                blocked += 1;
                continue;
            }
            _ => {
                open += 1;
                continue;
            }
        }
        for i in 0..=places {
            let t = i as f64 / places as f64;
            // Rounded, a place may be beyond a limit at which the motion ends.
            let place = |((a, b), [low, high]): ((&f64, &f64), &[f64; 2])| (a + t * (b - a)).clamp(*low, *high);
            let q: Vec<f64> = from.iter().zip(&to).zip(&limits).map(place).collect();
            assert!(
                other.is_free_at(&q).expect("a configuration"),
                "motion {} at {t}",
                k - 1
            );
            if i % (places / 10) == 0 {
                for id in &own {
                    let [_, upper] = over_all_points(&other, *id, &q, &points);
                    assert!(upper > 0.0, "motion {} at {t}: {id} {upper:e}", k - 1);
                }
            }
        }
    }
    [blocked, open]
}

#[test]
fn configurations_over_a_cloud_are_those_of_all_points() {
    let free = judge_configurations(&six_axis(), 2000, 100);
    assert!((10..90).contains(&free), "{free}");
}

#[test]
fn motions_over_a_cloud_are_free_where_they_are_proven_so() {
    let [blocked, open] = judge_motions(&six_axis(), 2000, 2.0, [20, 100]);
    assert!(blocked > 0 && open == 0, "{blocked} blocked, {open} undecided");
}

#[test]
#[ignore = "10,000 configurations of Panda over 20,000 points: minutes; set LIN_CANNY_PANDA and ROS_PACKAGE_PATH, then -p lin-canny-robot --test cloud -- --ignored"]
fn configurations_of_panda_are_those_of_all_points_10_000() {
    let free = judge_configurations(&panda(), 20_000, 10_000);
    println!("{free} of 10,000 configurations are free");
}

#[test]
#[ignore = "1,000 motions of Panda over 20,000 points: minutes; set LIN_CANNY_PANDA and ROS_PACKAGE_PATH, then -p lin-canny-robot --test cloud -- --ignored"]
fn motions_of_panda_are_free_where_they_are_proven_so_1_000() {
    let [blocked, open] = judge_motions(&panda(), 20_000, 0.5, [1000, 10_000]);
    println!("1,000 free motions at 10,000 places each; {blocked} blocked, {open} undecided");
}
