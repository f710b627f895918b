//! Races curved pairs: ours against parry's GJK, which starts from the direction of the previous
//! frame.
//!
//! Both use the same support functions and the same frames. B orbits A and spins by 0.5 degrees per
//! frame, at a gap between 0.02 and 0.2. Every engine gets two world poses and returns the distance
//! and both witnesses. The error is the difference from our distance, divided by L. `core` is the
//! same tracker on the cores of rounded shapes.

use std::hint::black_box;
use std::time::Instant;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{PairTracker, RelativePose, Shape, Solver, TrackerWork};
use truth::motion::{self, Frame};
use truth::parry::{Core, Map, MapGjk};
use truth::rng::Rng;

use race::common::{Options, Rows, WARM_UP, median};

pub(crate) const SCENES: [&str; 1] = ["0.5"];

struct Body {
    shape: Shape,
    core: Shape,
    map: Map,
}

fn body(kind: &str) -> Body {
    let (core, round, shape) = match kind {
        "ball" => (Core::Segment(0.0), 0.7, Shape::ball(0.7)),
        "capsule" => (Core::Segment(0.6), 0.3, Shape::capsule(0.6, 0.3)),
        "box" => (
            Core::Box([0.8, 0.5, 0.6]),
            0.0,
            Shape::cuboid(Vector3::new(0.8, 0.5, 0.6)),
        ),
        "round-box" => {
            let shape = Shape::cuboid(Vector3::new(0.7, 0.4, 0.5)).and_then(|s| s.rounded(0.1));
            (Core::Box([0.7, 0.4, 0.5]), 0.1, shape)
        }
        "cylinder" => (Core::Cylinder(0.7, 0.5), 0.0, Shape::cylinder(0.7, 0.5)),
        "cone" => (Core::Cone(0.7, 0.6), 0.0, Shape::cone(0.7, 0.6)),
        "ellipsoid" => (
            Core::Ellipsoid([0.9, 0.6, 0.4]),
            0.0,
            Shape::ellipsoid(Vector3::new(0.9, 0.6, 0.4)),
        ),
        other => panic!("no body is called {other}"),
    };
    let shape = shape.expect("a shape");
    let core_alone = match shape.core() {
        lin_canny::shape::Core::Polyhedron(body) => Shape::from(body.clone()),
        _ => shape.clone(),
    };
    Body {
        shape,
        core: core_alone,
        map: Map { core, round },
    }
}

type Poses = (Isometry3<f64>, Isometry3<f64>);

fn ours(pair: &mut PairTracker, a: &Shape, b: &Shape, poses: &Poses) -> f64 {
    let Ok(relative) = RelativePose::new(&poses.0, &poses.1) else {
        return f64::NAN;
    };
    let o = pair.closest(a, b, &relative);
    black_box((poses.0 * o.point_on_a, poses.1 * o.point_on_b));
    o.distance
}

fn parry(gjk: &mut MapGjk, a: &Map, b: &Map, f: &Frame) -> f64 {
    let found = gjk.closest(a, b, f);
    black_box(&found).as_ref().map_or(0.0, |w| w.distance)
}

/// Returns the nanoseconds per frame: the least of some passes.
fn timed(frames: usize, mut pass: impl FnMut()) -> f64 {
    let began = Instant::now();
    while began.elapsed() < WARM_UP {
        pass();
    }
    let mut times: Vec<f64> = (0..5)
        .map(|_| {
            let began = Instant::now();
            pass();
            began.elapsed().as_nanos() as f64 / frames as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[0]
}

/// Races all pairs.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    let kinds = ["ball", "capsule", "box", "round-box", "cylinder", "cone", "ellipsoid"];
    let count = if options.quick { 400 } else { 4000 };
    println!(
        "{:22} {:>8} {:>8} {:>9} {:>7} {:>6} {:>8} {:>10} {:>10}",
        "pair", "ours", "core", "parry", "ratio", "steps", "beyond", "parry p99", "parry max"
    );
    for (i, first) in kinds.iter().enumerate() {
        for second in &kinds[i..] {
            let (a, b) = (body(first), body(second));
            race(&mut rows, (first, second), (&a, &b), count);
        }
    }
    rows
}

fn race(rows: &mut Rows, names: (&str, &str), (a, b): (&Body, &Body), count: usize) {
    let mut rng = Rng::new(21);
    let radii = (a.shape.bounding_ball().1, b.shape.bounding_ball().1);
    let frames = motion::orbit_and_spin(&mut rng, count, 0.5, radii, (0.02, 0.2), 200);
    let poses: Vec<Poses> = frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect();
    let mut totals = TrackerWork::default();
    let time_of = |x: &Shape, y: &Shape, totals: &mut TrackerWork| {
        timed(count, || {
            let mut pair = PairTracker::new();
            for p in &poses {
                black_box(ours(&mut pair, x, y, p));
            }
            *totals = pair.work().convex;
        })
    };
    let mine = time_of(&a.shape, &b.shape, &mut totals);
    let core = time_of(&a.core, &b.core, &mut TrackerWork::default());
    let theirs = timed(count, || {
        let mut gjk = MapGjk::default();
        for f in &frames {
            parry(&mut gjk, &a.map, &b.map, f);
        }
    });
    let (mut pair, mut gjk) = (PairTracker::new(), MapGjk::default());
    let mut errors: Vec<f64> = frames
        .iter()
        .zip(&poses)
        .map(|(f, p)| {
            let size = radii.0 + radii.1 + truth::pose::norm(f.b.t);
            let truth = ours(&mut pair, &a.shape, &b.shape, p);
            (parry(&mut gjk, &a.map, &b.map, f) - truth).abs() / size
        })
        .collect();
    median(&mut errors);
    let beyond = 1.0 - totals.answered_by(Solver::Walk) as f64 / totals.queries as f64;
    println!(
        "{:22} {mine:8.0} {core:8.0} {theirs:9.0} {:7.1} {:6.2} {:7.2}% {:10.1e} {:10.1e}",
        format!("{}-{}", names.0, names.1),
        theirs / mine,
        totals.steps as f64 / totals.queries as f64,
        100.0 * beyond,
        errors[errors.len() * 99 / 100],
        errors[errors.len() - 1]
    );
    let shape = format!("{}-{}", names.0, names.1);
    rows.push(("0.5", &shape, 0), "ours", mine, 1);
    rows.push(("0.5", &shape, 0), "core", core, 1);
    rows.push(("0.5", &shape, 0), "parry-gjk", theirs, 1);
}
