//! Smooth motions: within limits by hulls of the judge's own subdivision, continuous, and free at many places by predicates.

use std::ops::ControlFlow;

use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::separation::Proof;
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, Joint, JointCurve, JointMotion, JointTree, Path, PlanError, PlanarSpace,
    RigidSpace, SmoothOptions, SmoothPath, Smoother, TranslationSpace,
};
use truth::arm::chain::{chain, posts};
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

/// Returns whether a polynomial with these Bezier control points is at most `limit` in absolute value, by hulls of its parts.
fn is_within(row: &[f64], limit: f64, depth: u32) -> bool {
    if row.iter().all(|x| x.abs() <= limit) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    let (mut left, mut right, mut round) = (Vec::new(), Vec::new(), row.to_vec());
    while !round.is_empty() {
        left.push(round[0]);
        right.push(round[round.len() - 1]);
        round = round.windows(2).map(|x| 0.5 * (x[0] + x[1])).collect();
    }
    right.reverse();
    is_within(&left, limit, depth - 1) && is_within(&right, limit, depth - 1)
}

/// Control points of the derivative of a curve of this duration by time.
fn derivative(row: &[f64], duration: f64) -> Vec<f64> {
    let n = (row.len() - 1) as f64;
    row.windows(2).map(|x| n * (x[1] - x[0]) / duration).collect()
}

fn row(curve: &JointCurve, c: usize) -> Vec<f64> {
    (0..=curve.degree()).map(|j| curve.control_point(j)[c]).collect()
}

/// Judges all of a motion but whether it is free.
fn judge(smooth: &SmoothPath, options: &SmoothOptions) {
    let count = smooth.curves.len();
    assert_eq!(smooth.times.len(), count + 1);
    assert_eq!(smooth.positions.len(), count + 1);
    assert_eq!(smooth.velocities.len(), count + 1);
    assert!(smooth.times.windows(2).all(|t| t[0] < t[1]), "{:?}", smooth.times);
    let is_c2 = options.continuous_acceleration;
    assert_eq!(smooth.accelerations.len(), if is_c2 { count + 1 } else { 0 });
    for end in [0, count] {
        assert!(smooth.velocities[end].iter().all(|v| *v == 0.0));
    }
    let dims = smooth.positions[0].len();
    for c in 0..dims {
        let mut before = [smooth.positions[0][c], 0.0, 0.0];
        let mut last = f64::INFINITY;
        for (k, curve) in smooth.curves.iter().enumerate() {
            let duration = smooth.times[k + 1] - smooth.times[k];
            let q = row(curve, c);
            let v = derivative(&q, duration);
            let a = derivative(&v, duration);
            assert!(
                is_within(&v, options.velocity[c], 16),
                "velocity of {c} in piece {k}: {v:?}"
            );
            assert!(
                is_within(&a, options.acceleration[c], 16),
                "acceleration of {c} in piece {k}: {a:?}"
            );
            // Rows are shared, so only the conversion rounds: positions by some units of their size.
            let size = 1e-14 * q.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let short = duration.min(last);
            last = duration;
            assert_eq!(before[0], q[0]);
            let most = size / short + 1e-12 * options.velocity[c].min(1e300);
            let off = (before[1] - v[0]).abs();
            assert!(off <= most, "velocity of {c} at row {k}: {before:?} {v:?}");
            if is_c2 {
                let most = 10.0 * size / (short * short) + 1e-12 * options.acceleration[c];
                let off = (before[2] - a[0]).abs();
                assert!(off <= most, "acceleration of {c} at row {k}: {before:?} {a:?}");
            }
            before = [&q, &v, &a].map(|x| x[x.len() - 1]);
            if is_c2 {
                // The next piece starts at the row, as this one ends.
                before[2] = smooth.accelerations[k + 1][c];
                let off = (a[a.len() - 1] - before[2]).abs();
                assert!(off <= 10.0 * size / (duration * duration) + 1e-12 * options.acceleration[c]);
            }
        }
    }
}

/// Judges whether a motion is free at so many places.
fn judge_free<C: ConfigurationSpace>(judge: &mut Checker<C>, smooth: &SmoothPath, places: u32) {
    let each = places / smooth.curves.len() as u32 + 1;
    for (k, curve) in smooth.curves.iter().enumerate() {
        for i in 0..=each {
            let q = curve.at(f64::from(i) / f64::from(each));
            assert!(judge.is_free_at(&q).expect("within limits"), "piece {k}: {q:?}");
        }
    }
}

/// Returns a random path of segments that are free.
fn random_path<C: ConfigurationSpace>(checker: &mut Checker<C>, rng: &mut Rng, count: usize, reach: f64) -> Path {
    let dims = checker.space().coordinates();
    let mut path: Path = Vec::new();
    let mut tries = 0;
    while path.len() < count {
        let q: Vec<f64> = match path.last() {
            None => (0..dims).map(|_| rng.range(-reach, reach)).collect(),
            Some(last) => {
                let way = rng.log_range(1e-3, 2.0);
                last.iter()
                    .map(|x| (x + rng.range(-way, way)).clamp(-reach, reach))
                    .collect()
            }
        };
        tries += 1;
        if checker
            .is_free(&JointMotion::segment(path.last().unwrap_or(&q), &q))
            .expect("within limits")
        {
            path.push(q);
        } else if tries % 50 == 0 {
            path.clear();
        }
    }
    path
}

#[derive(Debug, Default)]
struct Counts {
    paths: u32,
    corners: usize,
    stops: usize,
    pieces: usize,
}

fn judged<C: ConfigurationSpace + Clone>(
    space: C,
    cell: Cell,
    reach: f64,
    paths: u32,
    places: u32,
    seed: u64,
) -> Counts {
    let mut checker = Checker::new(space.clone(), cell.clone()).expect("a world");
    let mut other = Checker::new(space, cell).expect("a world");
    let dims = other.space().coordinates();
    let (mut rng, mut counts) = (Rng::new(seed), Counts::default());
    for k in 0..paths {
        let length = 2 + rng.below(8);
        let path = random_path(&mut other, &mut rng, length, reach);
        let limits =
            |rng: &mut Rng, low: f64, high: f64| (0..dims).map(|_| rng.log_range(low, high)).collect::<Vec<_>>();
        let options = SmoothOptions::new(limits(&mut rng, 0.3, 3.0), limits(&mut rng, 0.5, 20.0))
            .continuous_acceleration(k % 2 == 1)
            .deviation(if k % 3 == 0 { 0.05 } else { f64::INFINITY });
        let smooth = Smoother::new(&options)
            .smooth(&mut checker, &path)
            .expect("a free path");
        judge(&smooth, &options);
        judge_free(&mut other, &smooth, places);
        assert!(checker.is_free_along(&JointMotion::spline(&smooth.curves).expect("a motion")));
        counts.paths += 1;
        counts.corners += path.len() - 2;
        counts.stops += smooth.stops.len();
        counts.pieces += smooth.curves.len();
    }
    counts
}

/// A box among boxes.
fn room() -> Cell {
    let mut cell = Cell::new();
    cell.robot_body("box", cuboid([0.15, 0.1, 0.05]));
    posts(&mut cell, 0.9).expect("posts");
    cell
}

fn planar() -> PlanarSpace {
    PlanarSpace::new([[-2.0, 2.0]; 2], 0.3, 1).expect("a space")
}

fn sliding() -> TranslationSpace {
    TranslationSpace::new([[-2.0, 2.0]; 3], UnitQuaternion::identity(), 1).expect("a space")
}

fn judged_all(paths: u32, places: u32, seed: u64) {
    let (arm, cell) = chain(6, [-4.0, 4.0]).expect("an arm");
    println!("chain of 6: {:?}", judged(arm, cell, 1.5, paths, places, seed));
    println!("planar: {:?}", judged(planar(), room(), 1.8, paths, places, seed + 1));
    println!("sliding: {:?}", judged(sliding(), room(), 1.8, paths, places, seed + 2));
}

#[test]
fn random_paths_become_smooth_and_stay_free() {
    judged_all(20, 500, 1);
}

#[test]
#[ignore = "3,000 paths at 10,000 places: cargo test --release -p lin-canny-plan --test plan smooth::three_thousand -- --ignored --nocapture"]
fn three_thousand_paths_become_smooth_and_stay_free() {
    judged_all(1000, 10_000, 11);
}

/// A block of half 0.1 on rails x and y, whose limits are `limit`, scaled.
fn slider(scale: f64, limit: f64, cell: impl FnOnce(&mut Cell)) -> Checker<JointTree> {
    let origin = Isometry3::identity();
    let rail = |axis| Joint::prismatic(origin, axis, [-limit * scale, limit * scale]);
    let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    let space = JointTree::serial(origin, rails, vec![2], 0.2 * scale).expect("an arm");
    let mut all = Cell::new();
    all.robot_body("block", cuboid([0.1 * scale; 3]));
    cell(&mut all);
    Checker::new(space, all).expect("a world")
}

fn path(points: &[[f64; 2]]) -> Path {
    points.iter().map(|q| q.to_vec()).collect()
}

fn options() -> SmoothOptions {
    SmoothOptions::new([1.0, 2.0], [4.0, 3.0])
}

#[test]
fn a_segment_is_a_trapezoid() {
    let mut checker = slider(1.0, 9.0, |_| {});
    for (way, expected) in [(4.0, 4.0 + 0.25), (0.25, 0.5), (0.01, 0.1)] {
        let ends = path(&[[0.0, 0.0], [way, 0.0]]);
        let smooth = Smoother::new(&options()).smooth(&mut checker, &ends).expect("a motion");
        judge(&smooth, &options());
        let off = (smooth.duration() / expected - 1.0).abs();
        assert!(off < 1e-3, "{way}: {}", smooth.duration());
        assert_eq!(smooth.curves.len(), if way > 0.3 { 3 } else { 2 });
        // Speed that changes smoothly takes half as long again.
        let options = options().continuous_acceleration(true);
        let slower = Smoother::new(&options).smooth(&mut checker, &ends).expect("a motion");
        judge(&slower, &options);
        let ratio = if way > 0.3 { (4.0 + 0.375) / 4.25 } else { 1.5f64.sqrt() };
        let off = (slower.duration() / smooth.duration() / ratio - 1.0).abs();
        assert!(off < 1e-3, "{way}");
        assert_eq!(slower.curves[0].degree(), 5);
    }
}

#[test]
fn motions_return_on_themselves() {
    let mut checker = slider(1.0, 9.0, |_| {});
    for is_c2 in [false, true] {
        let options = options().continuous_acceleration(is_c2);
        let there_and_back = path(&[[0.0, 0.0], [1.0, 0.5], [0.0, 0.0], [1.0, 0.5]]);
        let smooth = Smoother::new(&options)
            .smooth(&mut checker, &there_and_back)
            .expect("a motion");
        judge(&smooth, &options);
        assert!(smooth.stops.is_empty());
        // The motion stays on the line.
        for curve in &smooth.curves {
            for k in 0..=20 {
                let q = curve.at(f64::from(k) / 20.0);
                assert!((q[0] - 2.0 * q[1]).abs() < 1e-12, "{q:?}");
            }
        }
    }
}

#[test]
fn repeated_points_and_steps_of_rounding_are_left_out() {
    let mut checker = slider(1.0, 9.0, |_| {});
    let plain = path(&[[0.0, 0.0], [1.0, 0.5], [1.0, 2.0]]);
    let smooth = Smoother::new(&options())
        .smooth(&mut checker, &plain)
        .expect("a motion");
    let tiny = 1.0 + f64::EPSILON;
    let repeated = path(&[
        [0.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.5],
        [tiny, 0.5],
        [1.0, 0.5],
        [1.0, 2.0 - 4.0 * f64::EPSILON],
        [1.0, 2.0],
        [1.0, 2.0],
    ]);
    let found = Smoother::new(&options())
        .smooth(&mut checker, &repeated)
        .expect("a motion");
    assert_eq!(found, smooth);
    for still in [path(&[[0.5, 0.5]]), path(&[[0.5, 0.5]; 4])] {
        for is_c2 in [false, true] {
            let options = options().continuous_acceleration(is_c2);
            let smooth = Smoother::new(&options).smooth(&mut checker, &still).expect("a motion");
            assert_eq!((&smooth.positions[..], smooth.duration()), (&still[..1], 0.0));
            judge(&smooth, &options);
        }
    }
    // Collinear points do not stop the motion.
    let line: Path = (0..=50).map(|k| vec![0.04 * f64::from(k), 0.0]).collect();
    let whole = Smoother::new(&options())
        .smooth(&mut checker, &path(&[[0.0, 0.0], [2.0, 0.0]]))
        .expect("a motion");
    let parts = Smoother::new(&options()).smooth(&mut checker, &line).expect("a motion");
    judge(&parts, &options());
    let off = (parts.duration() / whole.duration() - 1.0).abs();
    assert!(off < 0.02, "{} {}", parts.duration(), whole.duration());
}

#[test]
fn steps_of_all_sizes_keep_the_limits() {
    let mut checker = slider(1.0, 9.0, |_| {});
    let mut rng = Rng::new(5);
    for round in 0..60 {
        let mut points = vec![[1.0, 2.0]];
        for _ in 0..6 {
            let way = rng.log_range(1e-16, 1.0);
            let last = points[points.len() - 1];
            points.push(last.map(|x| (x + rng.range(-way, way)).clamp(-8.0, 8.0)));
        }
        let mut limit = |low, high| [rng.log_range(low, high), rng.log_range(low, high)];
        let options = match round % 3 {
            0 => SmoothOptions::new([1.0, 2.0], [4.0, 3.0]),
            1 => SmoothOptions::new(limit(1e-3, 1e3), limit(1e-3, 1e3)),
            _ => SmoothOptions::new(limit(1e-20, 1e20), limit(1e-20, 1e20)),
        };
        let options = options.continuous_acceleration(round % 2 == 0);
        let smooth = Smoother::new(&options)
            .smooth(&mut checker, &path(&points))
            .expect("a motion");
        judge(&smooth, &options);
    }
}

/// Walls above and below a corridor of half `0.1 + gap` along x, and then along y.
fn corridor(scale: f64, gap: f64) -> impl FnOnce(&mut Cell) {
    move |cell| {
        let mut wall = |name: &str, half: [f64; 2], at: [f64; 2]| {
            let half = Vector3::new(half[0], half[1], 1.0) * scale;
            let at = Isometry3::translation(at[0] * scale, at[1] * scale, 0.0);
            cell.put(name, solids::cuboid(half).expect("a box"), at);
        };
        // From (-1, 0) to (0, 0) to (0, 1).
        let near = 0.1 + gap;
        wall("below", [1.0 + near, 0.5], [-1.0, -near - 0.5]);
        wall("inside", [0.5, 1.0], [-near - 0.5, near + 1.0]);
        wall("outside", [0.5, 1.0 + near], [near + 0.5, 1.0]);
    }
}

/// A curve has a proof if and only if it is free. A proof without planes is that of the segment on which the curve stays.
fn proofs_agree(checker: &mut Checker<JointTree>, smooth: &SmoothPath) {
    for (k, curve) in smooth.curves.iter().enumerate() {
        let verdict = checker.verdict_of(&JointMotion::curve(curve));
        let proof = crate::prove(checker, &JointMotion::curve(curve)).expect("within limits");
        assert_eq!(proof.is_some(), verdict.is_free(), "piece {k}: {verdict:?}");
        let each = || proof.iter().flatten().map(|pair| &pair.certificates[..]);
        if proof.is_some() && each().all(|all| matches!(all, [one] if one.proof == Proof::Own)) {
            assert!(each().all(|all| all[0].from == 0.0 && all[0].until == 1.0), "piece {k}");
            let [from, to] = [curve.at(0.0), curve.at(1.0)];
            for i in 0..=16 {
                let q = curve.at(f64::from(i) / 16.0);
                let across = (q[0] - from[0]) * (to[1] - from[1]) - (q[1] - from[1]) * (to[0] - from[0]);
                assert!(across.abs() < 1e-14, "piece {k}");
            }
            assert!(
                crate::prove(checker, &JointMotion::segment(&from, &to))
                    .expect("within limits")
                    .is_some(),
                "piece {k}"
            );
        }
    }
}

#[test]
fn blends_shrink_in_narrow_passages() {
    let way = path(&[[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]]);
    let mut last = 0.0;
    for (gap, is_stop) in [(0.3, false), (1e-2, false), (1e-3, false), (1e-5, true), (1e-9, true)] {
        let mut checker = slider(1.0, 9.0, corridor(1.0, gap));
        for is_c2 in [false, true] {
            let options = options().continuous_acceleration(is_c2);
            let smooth = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
            judge(&smooth, &options);
            assert_eq!(smooth.stops, if is_stop { vec![1] } else { vec![] }, "{gap:e} {is_c2}");
            judge_free(&mut checker, &smooth, 1000);
            proofs_agree(&mut checker, &smooth);
            if !is_c2 {
                assert!(smooth.duration() >= last, "{gap:e}");
                last = smooth.duration();
            }
        }
    }
    // A gap that is near the rounding of curves is proven, or the segment is named.
    for gap in [1e-11, 1e-12, 1e-13, 1e-15] {
        let mut checker = slider(1.0, 9.0, corridor(1.0, gap));
        match Smoother::new(&options()).smooth(&mut checker, &way) {
            Ok(smooth) => {
                assert_eq!(smooth.stops, [1]);
                proofs_agree(&mut checker, &smooth);
            }
            Err(error) => assert!(matches!(error, PlanError::Unproven { .. }), "{error:?}"),
        }
    }
    // No halving at all: the blend is free, or the motion stops.
    let mut checker = slider(1.0, 9.0, corridor(1.0, 1e-2));
    let smooth = Smoother::new(&options().halvings(0))
        .smooth(&mut checker, &way)
        .expect("a motion");
    assert_eq!(smooth.stops, [1]);
    // Without a gap the path touches, so it is not free.
    let mut checker = slider(1.0, 9.0, corridor(1.0, -1e-3));
    let found = Smoother::new(&options()).smooth(&mut checker, &way);
    assert_eq!(found, Err(PlanError::Unproven { segment: 0 }));
}

#[test]
fn sizes_scale_the_motion() {
    let way = [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.0, 0.2]];
    let mut counts = Vec::new();
    for power in [-98, -50, 0, 20, 50, 98] {
        let scale = 10f64.powi(power);
        let mut checker = slider(scale, 9.0, corridor(scale, 0.05));
        let way: Path = way.iter().map(|q| q.iter().map(|x| x * scale).collect()).collect();
        for (is_c2, time) in [(false, 1.0), (true, 1e30), (true, 1e-30)] {
            let limits = |order: i32| [1.0, 2.0].map(|x: f64| x * scale / if order == 1 { time } else { time * time });
            let options = SmoothOptions::new(limits(1), limits(2)).continuous_acceleration(is_c2);
            let smooth = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
            judge(&smooth, &options);
            judge_free(&mut checker, &smooth, 300);
            counts.push((
                smooth.curves.len(),
                smooth.stops.clone(),
                (smooth.duration() / time * 1e6).round(),
            ));
        }
    }
    assert!(
        counts
            .chunks(3)
            .all(|c| c[0] == counts[0] && c[1] == counts[1] && c[2] == counts[1]),
        "{counts:?}"
    );
}

#[test]
fn angles_turn_the_shorter_way() {
    let mut checker = Checker::new(planar(), room()).expect("a world");
    let at = |x: f64, angle: f64| vec![x, 1.9, angle];
    let path = vec![at(-1.5, 3.0), at(-0.5, -3.0), at(0.5, -1.0), at(1.5, 2.5), at(1.5, 1.0)];
    let options = SmoothOptions::new([1.0, 1.0, 2.0], [4.0; 3]);
    let smooth = Smoother::new(&options).smooth(&mut checker, &path).expect("a motion");
    judge(&smooth, &options);
    let tau = std::f64::consts::TAU;
    // Up through half a turn to -3 and on to -1, then down to 2.5 and to 1.
    let last = &smooth.positions[smooth.positions.len() - 1];
    assert!((last[2] - 1.0).abs() < 1e-12, "{last:?}");
    let most = smooth.positions.iter().map(|q| q[2]).fold(0.0, f64::max);
    assert!(most > tau - 2.0, "{most}");
    for rows in smooth.positions.windows(2) {
        assert!((rows[0][2] - rows[1][2]).abs() < 3.2, "{rows:?}");
    }
    // Joints that turn fully.
    let (arm, cell) = chain(6, [-20.0, 20.0]).expect("an arm");
    let mut checker = Checker::new(arm, cell).expect("a world");
    let mut q = vec![1.4; 6];
    q.iter_mut().skip(1).for_each(|x| *x = 0.1);
    let ends = [
        q.clone(),
        q.iter()
            .enumerate()
            .map(|(k, x)| if k == 5 { x + 3.0 * tau } else { *x })
            .collect(),
    ];
    let options = SmoothOptions::new([2.0; 6], [5.0; 6]);
    let smooth = Smoother::new(&options).smooth(&mut checker, &ends).expect("a motion");
    judge(&smooth, &options);
    judge_free(&mut checker, &smooth, 500);
}

#[test]
fn the_deviation_is_kept() {
    let mut checker = slider(1.0, 9.0, |_| {});
    let way = path(&[[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.3, 0.2]]);
    let mut last = f64::INFINITY;
    for deviation in [0.0, 1e-6, 1e-3, 0.02, f64::INFINITY] {
        for is_c2 in [false, true] {
            let options = options().deviation(deviation).continuous_acceleration(is_c2);
            let smooth = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
            judge(&smooth, &options);
            assert_eq!(smooth.stops, if deviation == 0.0 { vec![1, 2] } else { vec![] });
            for corner in &way[1..3] {
                let mut nearest = f64::INFINITY;
                for curve in &smooth.curves {
                    for k in 0..=1000 {
                        let q = curve.at(f64::from(k) / 1000.0);
                        let off = q.iter().zip(corner).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                        nearest = nearest.min(off);
                    }
                }
                assert!(nearest <= deviation + 1e-9, "{deviation} {nearest}");
            }
            if !is_c2 {
                assert!(smooth.duration() <= last);
                last = smooth.duration();
            }
        }
    }
}

#[test]
fn the_same_path_gives_the_same_bits() {
    let (arm, cell) = chain(6, [-4.0, 4.0]).expect("an arm");
    let mut checker = Checker::new(arm.clone(), cell.clone()).expect("a world");
    let way = random_path(&mut checker, &mut Rng::new(9), 6, 1.5);
    let options = SmoothOptions::new([1.0; 6], [5.0; 6]).continuous_acceleration(true);
    let warm = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
    checker.reset();
    let answer = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
    assert_eq!(answer, warm);
    let mut other = Checker::new(arm, cell).expect("a world");
    let answer = Smoother::new(&options).smooth(&mut other, &way).expect("a motion");
    assert_eq!(answer, warm);

    // The callback sees every stage, and stops it.
    let mut stages = Vec::new();
    let found = Smoother::new(&options)
        .progress(&mut |progress| {
            assert!(progress.total.is_some_and(|total| progress.done < total));
            stages.push(progress.stage);
            ControlFlow::Continue(())
        })
        .smooth(&mut checker, &way);
    assert_eq!(found, Ok(warm));
    stages.dedup();
    assert_eq!(stages, ["blends", "pieces"]);
    for stop in 0..8 {
        let mut calls = 0;
        let found = Smoother::new(&options)
            .progress(&mut |_| {
                calls += 1;
                if calls > stop {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })
            .smooth(&mut checker, &way);
        assert_eq!((found, calls), (Err(PlanError::Stopped), stop + 1));
    }
}

#[test]
fn faults_are_named() {
    let mut checker = slider(1.0, 9.0, |_| {});
    let way = path(&[[0.0, 0.0], [1.0, 0.0]]);
    let mut fault = |path: &[Vec<f64>], options: SmoothOptions| {
        Smoother::new(&options).smooth(&mut checker, path).expect_err("a fault")
    };
    assert_eq!(fault(&[], options()), PlanError::Empty);
    assert!(matches!(
        fault(&[vec![0.0, 99.0]], options()),
        PlanError::Coordinate { index: 1, .. }
    ));
    assert!(matches!(
        fault(&[vec![0.0]], options()),
        PlanError::Length { expected: 2, found: 1 }
    ));
    let short = SmoothOptions::new([1.0], [1.0, 1.0]);
    assert!(matches!(
        fault(&way, short),
        PlanError::Length { expected: 2, found: 1 }
    ));
    for value in [0.0, -1.0, f64::NAN, 1e-210] {
        for (what, coordinate) in [("velocity", 1), ("acceleration", 0)] {
            let mut options = options();
            let of = if what == "velocity" {
                &mut options.velocity
            } else {
                &mut options.acceleration
            };
            of[coordinate] = value;
            let text = fault(&way, options).to_string();
            assert!(
                text.starts_with(&format!("{what} limit of coordinate {coordinate} is out of range: ")),
                "{text}"
            );
        }
    }
    assert!(matches!(
        fault(&way, SmoothOptions::new([1.0; 2], [f64::INFINITY; 2])),
        PlanError::Limit { .. }
    ));
    assert!(matches!(
        fault(&way, options().deviation(f64::NAN)),
        PlanError::Value { .. }
    ));
    let text = PlanError::Unproven { segment: 3 }.to_string();
    assert_eq!(text, "segment 3 of the path is not proven free");
    // No limit of velocity.
    let open = SmoothOptions::new([f64::INFINITY; 2], [4.0; 2]);
    let smooth = Smoother::new(&open).smooth(&mut checker, &way).expect("a motion");
    assert!((smooth.duration() - 1.0).abs() < 1e-3, "{}", smooth.duration());

    let mut cell = Cell::new();
    cell.robot_body("part", cuboid([0.1; 3]));
    let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.5, 1).expect("a space");
    let mut rigid = Checker::new(space, cell).expect("a world");
    let at = |x: f64| vec![x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let error = Smoother::new(&SmoothOptions::new([1.0; 7], [1.0; 7])).smooth(&mut rigid, &[at(0.0), at(1.0)]);
    assert!(
        matches!(error, Err(PlanError::CurveDegree { coordinate: 3, .. })),
        "{error:?}"
    );
}

/// A random path of the block, and one small post inside each corner, as near as a random gap.
fn crowded(rng: &mut Rng) -> Option<(Path, Vec<[f64; 2]>)> {
    let mut way = path(&[[0.0, 0.0]]);
    for _ in 0..2 + rng.below(4) {
        let (last, angle) = (way[way.len() - 1].clone(), rng.range(0.0, std::f64::consts::TAU));
        let length = rng.range(0.3, 1.5);
        way.push(vec![last[0] + length * angle.cos(), last[1] + length * angle.sin()]);
    }
    let mut posts: Vec<[f64; 2]> = Vec::new();
    for corner in way.windows(3) {
        let unit = |a: &[f64], b: &[f64]| {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            [0, 1].map(|c| (b[c] - a[c]) / length)
        };
        let [one, other] = [unit(&corner[0], &corner[1]), unit(&corner[1], &corner[2])];
        let inside = |s: f64| [0, 1].map(|c| corner[1][c] + s * (other[c] - one[c]));
        let is_free = |s: f64| {
            let mut checker = slider(1.0, 9.0, posted(&[inside(s)]));
            corner.windows(2).all(|ends| {
                checker
                    .is_free(&JointMotion::segment(&ends[0], &ends[1]))
                    .expect("within limits")
            })
        };
        let (mut near, mut far) = (0.0, 4.0);
        for _ in 0..45 {
            let middle = 0.5 * (near + far);
            *(if is_free(middle) { &mut far } else { &mut near }) = middle;
        }
        posts.push(inside(far + rng.log_range(1e-9, 0.1)));
    }
    let mut checker = slider(1.0, 9.0, posted(&posts));
    let mut each = way.windows(2);
    let is_free = each.all(|ends| {
        checker
            .is_free(&JointMotion::segment(&ends[0], &ends[1]))
            .expect("within limits")
    });
    is_free.then_some((way, posts))
}

fn posted(posts: &[[f64; 2]]) -> impl FnOnce(&mut Cell) {
    move |cell| {
        for (k, [x, y]) in posts.iter().enumerate() {
            let post = cuboid([0.02, 0.02, 1.0]);
            cell.put(k, post, Isometry3::translation(*x, *y, 0.0));
        }
    }
}

#[test]
fn blends_shrink_or_stop_among_random_posts() {
    let (mut free, mut shrunk, mut stops) = (0, 0, 0);
    let mut rng = Rng::new(17);
    for round in 0..80 {
        let Some((way, posts)) = crowded(&mut rng) else {
            continue;
        };
        let options = options()
            .continuous_acceleration(round % 2 == 1)
            .halvings(rng.below(9) as u32);
        let mut checker = slider(1.0, 9.0, posted(&posts));
        let smooth = Smoother::new(&options).smooth(&mut checker, &way).expect("a motion");
        judge(&smooth, &options);
        assert!(checker.is_free_along(&JointMotion::spline(&smooth.curves).expect("a motion")));
        judge_free(&mut slider(1.0, 9.0, posted(&posts)), &smooth, 500);
        let open = Smoother::new(&options)
            .smooth(&mut slider(1.0, 9.0, |_| {}), &way)
            .expect("a motion");
        assert!(open.stops.is_empty());
        // The motion stops where it says.
        for k in &smooth.stops {
            let row = smooth
                .positions
                .iter()
                .position(|q| *q == way[*k])
                .expect("a row at the corner");
            assert!(smooth.velocities[row].iter().all(|v| *v == 0.0));
        }
        stops += smooth.stops.len();
        free += u32::from(smooth == open);
        shrunk += u32::from(smooth != open && smooth.stops.is_empty());
    }
    println!("{free} as without posts, {shrunk} shrunk, {stops} stops");
    assert!(free > 3 && shrunk > 10 && stops > 5, "{free} {shrunk} {stops}");
}

/// Posts at the very distance at which a blend is just proven free: the curves that are returned are proven, too.
#[test]
fn blends_that_barely_pass_are_proven_as_returned() {
    let mut rng = Rng::new(23);
    for _ in 0..12 {
        let turn = rng.range(0.5, 2.5);
        let way = path(&[[-1.0, 0.1], [0.1, 0.3], [0.1 + turn.cos(), 0.3 + turn.sin()]]);
        let limits = options().halvings(0);
        let (mut near, mut far) = (-0.5, 2.0);
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            let post = [0.1 - middle, 0.3 + middle];
            let mut checker = slider(1.0, 9.0, posted(&[post]));
            let is_passed = match Smoother::new(&limits).smooth(&mut checker, &way) {
                Ok(smooth) => {
                    assert!(checker.is_free_along(&JointMotion::spline(&smooth.curves).expect("a motion")));
                    smooth.stops.is_empty()
                }
                Err(error) => {
                    assert!(matches!(error, PlanError::Unproven { .. }), "{error:?}");
                    false
                }
            };
            *(if is_passed { &mut far } else { &mut near }) = middle;
        }
        assert!(far < 2.0);
    }
}
