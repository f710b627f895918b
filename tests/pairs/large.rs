//! Faces and vertices with thousands of edges: no query visits all of them, and the outcomes are
//! correct.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::{ContactState, ConvexPolyhedron, Manifold, ManifoldOptions, Outcome, RelativePose, Solver, Tracker};
use std::f64::consts::TAU;
use truth::Point;
use truth::motion::Frame;
use truth::rng::Rng;
use truth::support::relative;
use truth::workload;

/// Returns the vertices of a polygon on an ellipse: evenly spaced on a circle, or random.
fn polygon(n: usize, rng: &mut Rng, even: bool) -> Vec<[f64; 2]> {
    let angle = |k| {
        if even {
            TAU * k as f64 / n as f64
        } else {
            rng.range(0.0, TAU)
        }
    };
    let width = if even { 1.0 } else { 0.6 };
    (0..n).map(angle).map(|t| [t.cos(), width * t.sin()]).collect()
}

fn body(shape: &str, n: usize, rng: &mut Rng) -> ConvexPolyhedron {
    let at = |z: f64| move |p: &[f64; 2]| [p[0], p[1], z];
    let rim = polygon(n, rng, !shape.starts_with("odd"));
    let mut points: Vec<Point> = rim.iter().map(at(0.0)).collect();
    match shape {
        "prism" | "odd prism" => points.extend(rim.iter().map(at(0.4))),
        // With lids that rounding breaks into thousands of faces.
        "turned prism" => {
            points.extend(rim.iter().map(at(0.4)));
            let turn = turned().inverse();
            points = points.iter().map(|&p| (turn * Point3::from(p)).into()).collect();
        }
        "cone" => points.push([0.0, 0.0, 0.8]),
        "tip" | "odd tip" => {
            points = rim.iter().map(at(0.5)).collect();
            points.push([0.0; 3]);
        }
        // A tip no higher than rounding, and another behind it.
        "low tip" => {
            points = rim.iter().map(at(1e-16)).collect();
            points.extend([[0.0; 3], [0.0, 0.0, 1.0]]);
        }
        "turned low tip" => {
            points = rim.iter().map(at(1e-14)).collect();
            points.extend([[0.0; 3], [0.0, 0.0, 1.0]]);
            let turn = turned().inverse();
            points = points.iter().map(|&p| (turn * Point3::from(p)).into()).collect();
        }
        // Two apexes with thousands of edges, one of which joins them.
        "tent" => {
            points.retain(|p| p[1] > -0.01);
            points = points.iter().map(|p| [0.0, p[0], 0.1 + p[1]]).collect();
            points.extend([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]);
        }
        "cube" => points = (0..8).map(|k| [0, 1, 2].map(|axis| f64::from(k >> axis & 1))).collect(),
        "flat cone" => points.push([0.0, 0.0, 0.02]),
        "odd cone" => points.push([0.5, 0.4, 0.7]),
        "bipyramid" => points.extend([[0.0, 0.0, 0.5], [0.0, 0.0, -0.5]]),
        "odd bipyramid" => points.extend([[0.5, 0.4, 0.7], [-0.9, 0.2, -0.5]]),
        "needle" => {
            points = rim.iter().map(|p| [0.1 * p[0], 0.1 * p[1], 0.0]).collect();
            points.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        }
        "sphere" => points = workload::points("sphere", 64, rng),
        _ => points = workload::points("box", 8, rng),
    }
    let points: Vec<Point3<f64>> = points.into_iter().map(Point3::from).collect();
    ConvexPolyhedron::from_points(&points).expect("a solid")
}

fn turned() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, 0.7, -0.4)
}

const PAIRS: [(&str, &str); 12] = [
    ("prism", "prism"),
    ("odd prism", "odd prism"),
    ("prism", "box"),
    ("odd prism", "sphere"),
    ("cone", "cone"),
    ("flat cone", "odd cone"),
    ("odd cone", "odd cone"),
    ("bipyramid", "bipyramid"),
    ("odd bipyramid", "odd bipyramid"),
    ("odd bipyramid", "sphere"),
    ("needle", "needle"),
    ("cone", "odd prism"),
];

fn frames(a: &ConvexPolyhedron, b: &ConvexPolyhedron, degrees: Option<f64>, count: usize, rng: &mut Rng) -> Vec<Frame> {
    workload::motion(degrees, count, rng, |f| {
        let o = Tracker::new().closest(a, b, &relative(f));
        let (pa, pb) = (f.a.isometry(), f.b.isometry());
        (o.lower > 0.0).then(|| ((pa * o.point_on_a).into(), (pb * o.point_on_b).into()))
    })
}

/// A query takes as few steps on 8192 vertices as on 512, warm and cold. With linear growth there
/// would be sixteen times as many.
#[test]
fn no_query_takes_steps_in_proportion_to_the_corners() {
    for (x, y) in PAIRS {
        for degrees in [Some(0.5), None] {
            let mean = |n: usize| {
                let mut rng = Rng::new(5);
                let (a, b) = (body(x, n, &mut rng), body(y, n, &mut rng));
                let list = frames(&a, &b, degrees, 150, &mut rng);
                let mut pair = Tracker::new();
                let steps: Vec<u32> = list
                    .iter()
                    .map(|f| pair.closest(&a, &b, &relative(f)).work.steps)
                    .collect();
                let fallbacks = pair.work().answered_by(Solver::Gjk);
                assert!(fallbacks <= 6, "{x} and {y}, {n}: {fallbacks} fallbacks");
                steps.iter().sum::<u32>() as f64 / steps.len() as f64
            };
            let (few, many) = (mean(512), mean(8192));
            let most = if degrees.is_some() { 8.0 } else { 32.0 };
            assert!(many <= most, "{x} and {y}, {degrees:?}: {few} and {many}");
            assert!(many <= 3.0 * few + 2.0, "{x} and {y}, {degrees:?}: {few} and {many}");
        }
    }
}

/// In a steady motion, walks start at the predicted features: most end before a leap is tried.
#[test]
fn walks_begin_where_features_go() {
    for shape in ["prism", "cone"] {
        let mut rng = Rng::new(5);
        let (a, b) = (body(shape, 8192, &mut rng), body(shape, 8192, &mut rng));
        let list = frames(&a, &b, Some(0.5), 400, &mut rng);
        let mut pair = Tracker::new();
        let steps = list.iter().map(|f| pair.closest(&a, &b, &relative(f)).work.steps);
        let mean = steps.sum::<u32>() as f64 / list.len() as f64;
        assert!(mean < 4.0, "{shape}: {mean}");
    }
}

/// Asserts that the outcome is within its bounds of the true distance: by support values over all
/// vertices from below, and by the witnesses from above.
fn assert_proven(a: &ConvexPolyhedron, b: &ConvexPolyhedron, f: &Frame, o: &Outcome) {
    let pose = relative(f);
    let (ra, rb) = (f.a.isometry(), f.b.isometry());
    let size = 4.0 + (rb.translation.vector - ra.translation.vector).norm();
    let n = ra.rotation * o.normal.into_inner();
    let top = a
        .vertex_points()
        .map(|p| n.dot(&(ra * p).coords))
        .fold(f64::NEG_INFINITY, f64::max);
    let low = b
        .vertex_points()
        .map(|p| n.dot(&(rb * p).coords))
        .fold(f64::INFINITY, f64::min);
    let between = (rb * o.point_on_b - ra * o.point_on_a).norm();
    let noise = 64.0 * f64::EPSILON * size;
    assert!(o.lower <= low - top + noise, "{o:?}: {} proven", low - top);
    let off = (between - (low - top)).abs();
    assert!(off <= noise, "{o:?}: {between} and {}", low - top);
    assert!((between - o.distance).abs() <= noise, "{o:?}: {between}");
    assert!(o.upper - o.lower <= 1e-13 * size, "{o:?}");
    assert_eq!(Tracker::new().closest(a, b, &pose).state, o.state);
}

#[test]
fn answers_on_large_features_are_right_warm_and_cold() {
    for (x, y) in PAIRS {
        for n in [30, 200, 2000] {
            let mut rng = Rng::new(n as u64);
            let (a, b) = (body(x, n, &mut rng), body(y, n, &mut rng));
            for degrees in [Some(0.5), Some(5.0), None] {
                let mut pair = Tracker::new();
                for f in frames(&a, &b, degrees, 25, &mut rng) {
                    let warm = pair.closest(&a, &b, &relative(&f));
                    let cold = Tracker::new().closest(&a, &b, &relative(&f));
                    assert_eq!(warm.state, ContactState::Separated, "{x} and {y}");
                    assert_proven(&a, &b, &f, &warm);
                    assert_proven(&a, &b, &f, &cold);
                }
            }
        }
    }
}

/// Compares with the exact stage, at gaps from 1e-2 to 1e-10.
#[cfg(feature = "exact")]
#[test]
fn answers_on_large_features_agree_with_exact_ones() {
    for (x, y) in PAIRS {
        let mut rng = Rng::new(9);
        let (a, b) = (body(x, 400, &mut rng), body(y, 400, &mut rng));
        for f in frames(&a, &b, None, 6, &mut rng) {
            let first = Tracker::new().closest(&a, &b, &relative(&f));
            let n = f.a.isometry().rotation * first.normal.into_inner();
            for gap in [1e-2, 1e-4, 1e-7, 1e-10] {
                let by = n * (gap - first.distance);
                let t = [0, 1, 2].map(|k| f.b.t[k] + by[k]);
                let f = Frame {
                    b: f.b.moved_to(t),
                    ..f
                };
                let o = Tracker::new().closest(&a, &b, &relative(&f));
                let truth = Tracker::new().closest_exact(&a, &b, &relative(&f));
                assert_eq!(o.state, truth.state, "{x} and {y} at {gap}");
                let off = (o.distance - truth.distance).abs();
                assert!(off <= 5e-14, "{x} and {y}: {o:?} {truth:?}");
                assert!(o.lower <= truth.upper, "{x} and {y}: {o:?} {truth:?}");
                assert!(truth.lower <= o.upper, "{x} and {y}: {o:?} {truth:?}");
            }
        }
    }
}

/// The support vertex of bodies with large features is the highest, along normals, edges and
/// directions near them too.
#[test]
fn extreme_vertices_of_large_features_are_the_highest() {
    for shape in [
        "prism",
        "odd prism",
        "cone",
        "flat cone",
        "odd cone",
        "odd bipyramid",
        "needle",
    ] {
        for n in [30, 300, 3000] {
            let mut rng = Rng::new(n as u64);
            let a = body(shape, n, &mut rng);
            let mut directions: Vec<_> = (0..200).map(|_| rng.unit()).collect();
            let faces: Vec<_> = a.faces().collect();
            for k in 0..40 {
                let f = faces[k * (faces.len() - 1) / 39];
                let d = a.face_plane(f).expect("a face").0.into_inner();
                directions.push(d.into());
                directions.push([d.x + 1e-16, d.y, d.z - 1e-15]);
            }
            for d in directions {
                let d = lin_canny::nalgebra::Vector3::from(d);
                let v = a.extreme_vertex(&d);
                let height = |p: Point3<f64>| d.dot(&p.coords);
                let top = a.vertex_points().map(height).fold(f64::NEG_INFINITY, f64::max);
                let here = height(a.vertex(v).expect("a vertex"));
                assert!(top - here <= 20.0 * f64::EPSILON, "{shape} {n} {d:?}: {here} of {top}");
            }
        }
    }
}

/// Returns poses with one body upside down and the other upon it, both rotated back by `un`.
///
/// They rest, slide, are separated, or overlap by rounding and more, flush or off by rounding and
/// more, in a rotated world or not.
fn stacks(un: [UnitQuaternion<f64>; 2], rng: &mut Rng) -> Vec<RelativePose> {
    let upside_down = UnitQuaternion::new_unchecked(lin_canny::nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0));
    let mut list = vec![];
    for world in [
        UnitQuaternion::identity(),
        UnitQuaternion::from_euler_angles(0.2, -0.5, 1.1),
    ] {
        for tilt in [0.0, 1e-16, 1e-15, 1e-14, 1e-12, 1e-9] {
            for (k, gap) in [0.0, 1e-16, 1e-9, -1e-9, 1e-3].into_iter().enumerate() {
                let slide = [0.3, 0.0][k % 2];
                let axis = Vector3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.0);
                let shift = Vector3::new(rng.range(-slide, slide), slide, gap);
                let a = Isometry3::from_parts(Vector3::zeros().into(), world * upside_down * un[0]);
                let b = world * UnitQuaternion::from_scaled_axis(axis * tilt) * un[1];
                let b = Isometry3::from_parts((world * shift).into(), b);
                list.push(RelativePose::new(&a, &b).expect("a pose"));
            }
        }
    }
    list
}

fn consume<T>(answer: T) {
    std::hint::black_box(answer);
}

/// Returns the longest CPU time of a kind of query in seconds: the shortest of three runs each.
///
/// Up to nine runs if all take longer than a millisecond, as a disturbed run does.
fn longest(a: &ConvexPolyhedron, b: &ConvexPolyhedron, list: &[RelativePose], kind: &str) -> f64 {
    let (mut tracker, mut manifold) = (Tracker::new(), Manifold::default());
    let mut longest = 0.0;
    for pose in list {
        let before = (tracker.clone(), manifold.clone());
        let mut shortest = f64::INFINITY;
        for run in 0..9 {
            if run >= 3 && shortest < 0.001 {
                break;
            }
            (tracker, manifold) = before.clone();
            let began = cpu_time::ThreadTime::now();
            match kind {
                "closest" => consume(tracker.closest(a, b, pose)),
                "cold" => consume(Tracker::new().closest(a, b, pose)),
                "within" => consume(tracker.within(a, b, pose, 1e-10)),
                #[cfg(feature = "exact")]
                "exact" => consume(tracker.closest_exact(a, b, pose)),
                _ => tracker.manifold(a, b, pose, &ManifoldOptions::default().prediction(0.01), &mut manifold),
            }
            shortest = f64::min(shortest, began.elapsed().as_secs_f64());
        }
        longest = f64::max(longest, shortest);
    }
    longest
}

/// If thousands of vertices or edges are level up to rounding, every stage up to the exact one is
/// used, and none visits all of them.
///
/// Linear time would be 32 times as long; the observed factor is at most five, for times below two
/// milliseconds.
#[test]
fn no_query_on_flush_features_takes_time_in_proportion_to_the_corners() {
    for (x, y) in [
        ("prism", "prism"),
        ("odd prism", "prism"),
        ("turned prism", "turned prism"),
        ("prism", "cube"),
        ("odd cone", "flat cone"),
        ("tip", "prism"),
        ("odd tip", "odd tip"),
        ("odd tip", "cube"),
        ("low tip", "low tip"),
        ("turned low tip", "prism"),
        ("tent", "tent"),
    ] {
        let un = [x, y].map(|s| {
            if s.starts_with("turned") {
                turned()
            } else {
                UnitQuaternion::identity()
            }
        });
        let run = |n: usize| {
            let mut rng = Rng::new(5);
            let (a, b) = (body(x, n, &mut rng), body(y, n, &mut rng));
            let list = stacks(un, &mut rng);
            ["closest", "cold", "within", "exact", "manifold"].map(|kind| (kind, longest(&a, &b, &list, kind)))
        };
        for ((kind, few), (_, many)) in run(512).into_iter().zip(run(16_384)) {
            assert!(many <= 8.0 * few + 0.002, "{x} on {y}, {kind}: {few} s and {many} s");
        }
    }
}

/// The solver bisects such boundaries, each in turn, and converges.
#[test]
fn nearly_parallel_rims_do_not_need_the_exact_rung() {
    for n in [8192, 16_384] {
        let body = body("low tip", n, &mut Rng::new(5));
        let upside_down = Vector3::x_axis().into_inner() * std::f64::consts::PI;
        let a = Isometry3::new(Vector3::zeros(), upside_down);
        for k in 0..12 {
            let direction = TAU * f64::from(k) / 12.0 + 0.1;
            let tilt = Vector3::new(direction.cos(), direction.sin(), 0.0) * 1e-6;
            let b = Isometry3::new(Vector3::new(0.0, 0.0, 1e-3), tilt);
            let pose = RelativePose::new(&a, &b).expect("a pose");
            let o = Tracker::new().closest(&body, &body, &pose);
            assert_eq!(o.state, ContactState::Separated, "{n}, {direction}: {o:?}");
            assert_eq!(o.work.exacts, 0, "{n}, {direction}: {o:?}");
        }
    }
}
