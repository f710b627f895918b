//! Promise: every public type of the feature `serde` reads back as it was written.
#![cfg(feature = "serde")]

use lin_canny::polyhedron::solids;
use lin_canny::{
    ContactState, ConvexPolyhedron, Distance, Manifold, ManifoldOptions, Outcome, PairTracker, Proposal, QueryOptions,
    RelativePose, Shape, Solver, Tracker,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use truth::errors::says;
use truth::support;

fn round_trip<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("serialises");
    let back: T = serde_json::from_str(&text).expect("deserialises");
    assert_eq!(&back, value, "{text}");
    back
}

/// Returns a value as it is read.
fn read<T: Serialize + DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("serialises");
    serde_json::from_str(&text).expect("deserialises")
}

fn query() -> (ConvexPolyhedron, ConvexPolyhedron, RelativePose) {
    let (a, b) = (
        solids::icosahedron(1.0).expect("a body"),
        solids::cone(7, 0.55, 0.3).expect("a body"),
    );
    let pose = truth::Pose::turn([0.6, 0.0, 0.8], 0.7, [1.9, 0.3, -0.4]);
    (a, b, RelativePose::from_isometry(&pose.isometry()).expect("a pose"))
}

#[test]
fn answers_come_back() {
    let (a, b, pose) = query();
    let mut t = Tracker::new();
    let outcome: Outcome = t.closest(&a, &b, &pose);
    let (distance, proposal): (Distance, Proposal) = (t.distance(&a, &b, &pose), t.propose(&a, &b, &pose));
    assert_eq!(outcome.state, ContactState::Separated);
    round_trip(&outcome);
    round_trip(&outcome.features);
    round_trip(&outcome.work);
    round_trip(&distance);
    round_trip(&proposal);
    for layer in [
        Solver::Walk,
        Solver::Restart,
        Solver::Gjk,
        Solver::DoubleDouble,
        Solver::Exact,
        Solver::Far,
    ] {
        round_trip(&layer);
    }
    for state in [
        ContactState::Separated,
        ContactState::Touching,
        ContactState::Overlapping,
        ContactState::Undecided,
    ] {
        round_trip(&state);
    }
}

/// A manifold continues after reading; invalid indices are not used, and too many points are
/// rejected.
#[test]
fn a_manifold_keeps_its_names() {
    let cube = solids::cuboid(lin_canny::nalgebra::Vector3::new(0.5, 0.5, 0.5)).expect("a body");
    let pose = support::shifted([0.3, 0.2, 0.99]);
    let options = round_trip(&ManifoldOptions::default().prediction(0.1));
    let (mut t, mut m) = (Tracker::new(), Manifold::new());
    t.manifold(&cube, &cube, &pose, &options, &mut m);
    assert_eq!(m.points().len(), 4);
    m.points().iter().for_each(|p| assert_eq!(round_trip(p), *p));
    let text = serde_json::to_string(&m).expect("serialises");
    let mut back: Manifold = serde_json::from_str(&text).expect("deserialises");
    let without_bounds = |m: &Manifold| (m.points().to_vec(), m.features(), m.reference(), m.normal());
    assert_eq!(without_bounds(&back), without_bounds(&m));
    assert!(back.lower() == f64::NEG_INFINITY && back.upper() == f64::INFINITY && !back.is_fresh());
    // Far enough to compute the contacts again, too near for other points.
    let pose = support::shifted([0.31, 0.2, 0.99]);
    for manifold in [&mut m, &mut back] {
        t.manifold(&cube, &cube, &pose, &options, manifold);
        assert!(manifold.is_fresh());
    }
    assert_eq!((back.lower(), back.upper()), (m.lower(), m.upper()));
    // The contacts are chosen again, and a contact keeps its name.
    assert_eq!(back.points().len(), 4);
    for p in back.points() {
        let before = m.points().iter().find(|q| q.features == p.features);
        assert!(before.is_none_or(|q| q.id == p.id), "{p:?} {before:?}");
    }
    assert!(
        back.points()
            .iter()
            .filter(|p| m.points().iter().any(|q| q.id == p.id))
            .count()
            > 1
    );
    let mut damaged: serde_json::Value = serde_json::from_str(&text).expect("is JSON");
    damaged["on"] = serde_json::json!(vec![[u32::MAX, (2 << 30) | 77]; 8]);
    let mut back: Manifold = serde_json::from_value(damaged.clone()).expect("numbers");
    t.manifold(&cube, &cube, &pose, &options, &mut back);
    assert_eq!(back.points().len(), 4);
    damaged["count"] = 400.into();
    assert!(serde_json::from_value::<Manifold>(damaged).is_err());
    // Older files identify the bodies by two numbers, which are no longer known.
    let mut older: serde_json::Value = serde_json::from_str(&text).expect("is JSON");
    let made = older["made"].as_object_mut().expect("a computation");
    made.remove("fingerprints").expect("fingerprints");
    made.insert("bodies".to_owned(), serde_json::json!([1, u64::MAX]));
    let mut back: Manifold = serde_json::from_value(older).expect("an older manifold");
    t.manifold(&cube, &cube, &pose, &options, &mut back);
    assert!(back.points().len() == 4 && back.is_fresh());
    let outcome = t.closest(&cube, &cube, &pose);
    round_trip(&outcome.gradient_a());
}

/// Not every format can store an infinity: unknown values and unlimited requests read back
/// correctly all the same.
#[test]
fn what_is_infinite_comes_back() {
    let none = Manifold::new();
    assert!(none.lower() == f64::NEG_INFINITY && none.upper() == f64::INFINITY);
    round_trip(&none);
    let mut options = ManifoldOptions::default().prediction(f64::INFINITY);
    (options.rebuild_motion, options.reselect_motion, options.max_face_sine) =
        (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
    round_trip(&options);
    let (a, b, pose) = query();
    let (mut t, mut m) = (Tracker::new(), Manifold::new());
    for prediction in [f64::INFINITY, f64::NEG_INFINITY] {
        options.prediction = prediction;
        t.manifold(&a, &b, &pose, &options, &mut m);
        assert_eq!(m.points().is_empty(), prediction < 0.0);
        assert_eq!(read(&m).points(), m.points());
    }
    let mut open = t.closest(&a, &b, &pose);
    open.lower = f64::NEG_INFINITY;
    round_trip(&open);
    round_trip(&Distance::from(&open));
}

/// In faces of more than 24 vertices, a vertex is only known to be on the face or not, and near
/// rounding this may fail.
#[test]
fn a_manifold_of_large_faces_comes_back() {
    let disc = solids::prism(26, 0.2, 1.0).expect("a body");
    for k in 0..26 {
        // Vertex on vertex.
        let angle = std::f64::consts::TAU * f64::from(k) / 26.0;
        let pose = truth::Pose::turn([0.0, 0.0, 1.0], angle, [0.0, 0.0, 0.4 + 1e-6]);
        let pose = RelativePose::from_isometry(&pose.isometry()).expect("a pose");
        let mut m = Manifold::new();
        Tracker::new().manifold(&disc, &disc, &pose, &ManifoldOptions::default().prediction(0.1), &mut m);
        assert!(m.points().len() > 2);
        assert_eq!(read(&m).points(), m.points());
    }
}

#[test]
fn a_tracker_goes_on_where_it_was() {
    let (a, b, pose) = query();
    let mut t = Tracker::new();
    t.closest(&a, &b, &pose);
    round_trip(&t.work());
    let mut back = round_trip(&t);
    let (x, y) = (t.closest(&a, &b, &pose), back.closest(&a, &b, &pose));
    assert_eq!(x, y);
    assert_eq!(back.work().warm, 1);
}

#[test]
fn bodies_and_poses_come_back() {
    let (a, b, pose) = query();
    round_trip(&pose);
    let (a2, b2) = (round_trip(&a), round_trip(&b));
    assert_eq!(a2.report(), a.report());
    let found = Tracker::new().closest(&a2, &b2, &pose);
    assert_eq!(found, Tracker::new().closest(&a, &b, &pose));
    round_trip(a.report());
}

/// A file is untrusted input: invalid bodies and poses are rejected, and the features of a tracker
/// are only a hint.
#[test]
fn damaged_files_are_refused() {
    let (a, b, pose) = query();
    let damage = |text: String, from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        text.replacen(from, to, 1)
    };
    let text = serde_json::to_string(&pose).expect("serialises");
    assert!(serde_json::from_str::<RelativePose>(&damage(text, "\"t\":[0.0", "\"t\":[1e999")).is_err());
    let text = serde_json::to_string(&a).expect("serialises");
    assert!(serde_json::from_str::<ConvexPolyhedron>(&damage(text, "\"source\":[", "\"source\":[0,")).is_err());
    let mut t = Tracker::new();
    t.closest(&b, &b, &pose);
    let known = serde_json::to_value(&t).expect("serialises");
    let wanted = Tracker::new().closest(&a, &b, &pose);
    for features in [
        r#"{"a":{"Edge":4000000000},"b":{"Vertex":0}}"#,
        r#"{"a":{"Vertex":0},"b":{"Face":4294967295}}"#,
        r#"{"a":{"Edge":0},"b":{"Face":0}}"#,
        r#"{"a":{"Face":0},"b":{"Face":0}}"#,
        r#"{"a":{"Edge":59},"b":{"Edge":27}}"#,
    ] {
        let mut text = known.clone();
        text["last"] = serde_json::from_str(features).expect("is JSON");
        let mut strange: Tracker = serde_json::from_value(text).expect("a hint, whatever it says");
        let o = strange.closest(&a, &b, &pose);
        assert_eq!((o.state, o.features), (wanted.state, wanted.features), "{features}");
        assert!(o.lower <= wanted.upper && wanted.lower <= o.upper, "{features}: {o:?}");
    }
}

/// The polytope of an overlap is untrusted input too: an invalid one is dropped.
#[test]
fn a_damaged_surface_does_no_harm() {
    let (a, b, _) = query();
    let pose =
        RelativePose::from_isometry(&lin_canny::nalgebra::Isometry3::translation(0.01, 0.02, 0.03)).expect("a pose");
    let mut t = Tracker::new();
    let wanted = t.closest(&a, &b, &pose);
    assert_eq!(wanted.state, ContactState::Overlapping);
    let known = round_trip(&t);
    let known = serde_json::to_value(&known).expect("serialises");
    let triangles = known["memory"]["triangles"].as_array().expect("a list").len();
    assert!(triangles > 3);
    for k in 0..triangles {
        for i in 0..6 {
            for x in [0u32, 1, 7, 4_000_000_000] {
                let mut text = known.clone();
                text["memory"]["triangles"][k][i] = x.into();
                text["memory"]["points"][k % 4][i % 2] = (x / 2).into();
                let mut strange: Tracker = serde_json::from_value(text).expect("numbers");
                let o = strange.closest(&a, &b, &pose);
                assert_eq!(o.state, wanted.state);
                assert!(o.lower <= wanted.upper && wanted.lower <= o.upper, "{o:?}");
            }
        }
    }
}

/// Shapes of every kind, rounded or not; a shape that no constructor would make is rejected.
#[test]
fn shapes_come_back() {
    let shapes = truth::forms::shapes([0.5, 0.25, 0.75]);
    for a in &shapes {
        let text = serde_json::to_string(a).expect("serialises");
        let back: Shape = serde_json::from_str(&text).expect("deserialises");
        // A polyhedron reads back with another build report; all outcomes are the same.
        let pose = support::shifted([1.3, 0.4, 1.5]);
        for b in &shapes {
            let answer = |s: &Shape| PairTracker::new().closest(s, b, &pose);
            assert_eq!(answer(a), answer(&back), "{text}");
        }
        assert_eq!(serde_json::to_string(&back).expect("serialises"), text);
        assert!(
            serde_json::from_str::<Shape>(&text.replace("\"round\":0.", "\"round\":-1.")).is_err(),
            "{text}"
        );
    }
    for bad in [
        r#"{"core":{"Cylinder":{"half_height":0.7,"radius":-0.5}},"round":0.0}"#,
        r#"{"core":{"Cone":{"half_height":1e200,"radius":0.5}},"round":0.0}"#,
        r#"{"core":{"Ellipsoid":{"semi_axes":[0.5,0.0,0.7]}},"round":0.0}"#,
    ] {
        assert!(serde_json::from_str::<Shape>(bad).is_err(), "{bad}");
    }
}

/// A tracker keeps its counters; the pair starts cold.
#[test]
fn a_tracker_of_any_pair_comes_back() {
    let a = Shape::cylinder(0.7, 0.5).expect("a shape");
    let b = Shape::cone(0.7, 0.6).expect("a shape");
    let mut pair = PairTracker::new();
    for k in 0..20 {
        let pose = support::shifted([1.4, 0.02 * f64::from(k), 0.3]);
        let o = pair.closest(&a, &b, &pose);
        let mut back: PairTracker =
            serde_json::from_str(&serde_json::to_string(&pair).expect("serialises")).expect("a tracker");
        let p = back.closest(&a, &b, &pose);
        assert_eq!(p.state, o.state);
        assert!(p.lower <= o.upper && o.lower <= p.upper, "{o:?} {p:?}");
        assert_eq!(back.work().convex.queries, pair.work().convex.queries + 1);
        round_trip(&o);
        round_trip(&pair.work());
    }
}

/// Surfaces read back bit for bit, with the errors of their sources; invalid files are rejected.
#[test]
fn surfaces_come_back() {
    use lin_canny::nalgebra::{Isometry3, Point3};
    use lin_canny::surface::{BezierPatch, BezierSurface, Nurbs, SurfaceError};
    fn shared<T: Send + Sync>(_: &T) {}
    let at = |i: usize| [(i / 3) as f64, (i % 3) as f64, (i % 2) as f64];
    let points: Vec<_> = (0..12).map(|i| Point3::from(at(i))).collect();
    let spline = BezierSurface::from_nurbs(&Nurbs {
        degrees: [2, 2],
        knots: [&[0.0, 0.0, 0.0, 1.0, 2.5, 2.5, 2.5], &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]],
        points: &points,
        ..Nurbs::default()
    })
    .expect("a surface");
    let weights = [1.0, 0.3, 2.0, 0.7, 1.0, 0.9];
    let triangle = BezierPatch::triangular(2, &points[..6], Some(&weights)).expect("a patch");
    let both = BezierSurface::new(vec![
        triangle.clone(),
        BezierPatch::polynomial([2, 3], &points).expect("a patch"),
    ]);
    round_trip(&triangle);
    triangle.split(0).iter().for_each(|half| drop(round_trip(half)));
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.3, 0.2, 4.0)).expect("a pose");
    for surface in [spline, both.expect("a surface")] {
        let text = serde_json::to_string(&surface).expect("serialises");
        let back: BezierSurface = serde_json::from_str(&text).expect("deserialises");
        assert_eq!(serde_json::to_string(&back).expect("serialises"), text);
        assert_eq!(back.patches(), surface.patches());
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&surface, &surface, &pose, &QueryOptions::default().width(1e-9));
        let expected = PairTracker::new().closest_with(&back, &back, &pose, &QueryOptions::default().width(1e-9));
        assert_eq!(o, expected);
        round_trip(&o);
        let ball = Shape::ball(0.5).expect("a ball");
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&surface, &ball, &pose, &QueryOptions::default().width(1e-9));
        round_trip(&o);
        shared(&surface);
        shared(&tracker);
        // The knots of the first patch, its first weight, the radius and the degrees.
        let wrong = |from: &str, to: &str| {
            assert!(text.contains(from), "{text}");
            serde_json::from_str::<BezierSurface>(&text.replacen(from, to, 1)).map(drop)
        };
        assert!(wrong("\"degrees\":[2,2]", "\"degrees\":[2,9]").is_err());
        assert!(wrong("\"degrees\":[2,2]", "\"degrees\":[3,2]").is_err());
        assert!(wrong("\"reach\":", "\"reach\":0.5,\"other\":").is_err());
        assert!(wrong("\"domains\":[[[0.0,", "\"domains\":[[[7.0,").is_err());
        assert!(wrong("\"domains\":[", "\"domains\":[[[0.0,1.0],[0.0,1.0]],").is_err());
    }
    let bad = r#"{"degrees":[1,1],"net":[[0,0,0,1],[1,0,0,1],[0,1,0,-1],[1,1,0,1]],"is_triangular":false,"source":"Points","reach":2}"#;
    says(
        serde_json::from_str::<BezierPatch>(bad),
        &SurfaceError::Weight { index: 2, value: -1.0 }.to_string(),
    );
}

/// Motions: the stored input reads back exactly, derived values are not read, and input that a
/// constructor rejects is rejected.
#[test]
fn motions_come_back_and_false_ones_are_refused() {
    use lin_canny::motion::{Motion, Nlerp, Steady};
    use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    let mut rng = truth::rng::Rng::new(41);
    let mut vector = |size: f64| Vector3::from(rng.in_ball()) * size;
    for _ in 0..200 {
        let from = Isometry3::new(vector(3.0), vector(3.0));
        let to = Isometry3::new(vector(3.0), vector(3.0));
        let velocity = lin_canny::Velocity::new(vector(2.0), vector(9.0));
        let pivot = Point3::from(vector(2.0));
        let steady = Steady::about(&from, pivot, velocity).and_then(|m| m.with_acceleration(vector(9.0)));
        let steady = steady
            .and_then(|m| m.with_acceleration_bounds(0.25, 0.5))
            .expect("a motion");
        let nlerp = Nlerp::new(&from, &to, 0.7, pivot).expect("a motion");
        let back = (round_trip(&steady), round_trip(&nlerp));
        assert_eq!(back.0.pose(0.3), steady.pose(0.3));
        assert_eq!(back.1.pose(0.3), nlerp.pose(0.3));

        let damaged = |motion: serde_json::Value, at: &str, value: serde_json::Value| {
            let mut motion = motion;
            *motion.pointer_mut(at).expect(at) = value;
            motion
        };
        let s = serde_json::to_value(steady).expect("JSON");
        let n = serde_json::to_value(nlerp).expect("JSON");
        for at in [
            "/rotation/0",
            "/centre/1",
            "/pivot/2",
            "/velocity/linear/0",
            "/velocity/angular/1",
            "/acceleration/2",
        ] {
            let file = damaged(s.clone(), at, serde_json::json!(1e200));
            let read = serde_json::from_value::<Steady>(file);
            assert!(read.is_err() || at.starts_with("/centre"), "{at}: {read:?}");
        }
        let file = damaged(s.clone(), "/open/1", serde_json::json!(-1.0));
        assert!(serde_json::from_value::<Steady>(file).is_err());
        for (at, value) in [
            ("/duration", 0.0),
            ("/duration", -1.0),
            ("/to/3", 5.0),
            ("/from/0", 5.0),
            ("/pivot/0", 1e200),
        ] {
            let file = damaged(n.clone(), at, serde_json::json!(value));
            assert!(serde_json::from_value::<Nlerp>(file).is_err(), "{at}");
        }
        // Derived numbers, present in older files, are false: the motion follows from the others.
        let mut file = s.clone();
        file["spin"] = serde_json::json!({"axis": [1.0, 0.0, 0.0], "rate": [0.0, 0.0]});
        assert_eq!(serde_json::from_value::<Steady>(file).expect("a motion"), steady);
        let mut file = n.clone();
        file["axis"] = serde_json::json!([0.0, 0.0, 0.0]);
        file["versine"] = serde_json::json!(0.0);
        assert_eq!(serde_json::from_value::<Nlerp>(file).expect("a motion"), nlerp);
        // The longer rotation is the shorter rotation of the opposite quaternion.
        let mut file = n.clone();
        let opposite = |x: &serde_json::Value| serde_json::json!(-x.as_f64().expect("a number"));
        file["to"] = n["to"].as_array().expect("four").iter().map(opposite).collect();
        assert_eq!(serde_json::from_value::<Nlerp>(file).expect("a motion"), nlerp);
        // A rotation with few digits is normalised.
        let mut file = s.clone();
        let longer = |x: &serde_json::Value| serde_json::json!(x.as_f64().expect("a number") * (1.0 + 3e-13));
        file["rotation"] = s["rotation"].as_array().expect("four").iter().map(longer).collect();
        let read: Steady = serde_json::from_value(file).expect("a motion");
        assert!((read.pose(0.0).rotation.coords.norm() - 1.0).abs() < 1e-15);
    }
}
