//! A replay is the query, bit for bit, and an invalid text is rejected with its line.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Accuracy, ConvexPolyhedron, Operand, PairTracker, RelativePose, Replay, ReplayError, Shape, Tracker};
use truth::rng::Rng;
use truth::shapes;

fn bodies() -> Vec<ConvexPolyhedron> {
    let point = |x, y, z| Point3::new(x, y, z);
    let mut all = vec![
        ConvexPolyhedron::point(point(0.1, 0.2, 0.3)).unwrap(),
        ConvexPolyhedron::segment(point(0.1, 0.2, 0.3), point(-1.0, 1e-200, 3.0)).unwrap(),
        ConvexPolyhedron::polygon(&[point(0.0, 0.0, 0.1), point(1.0, 0.0, 0.1), point(0.0, 1.0, 0.1)]).unwrap(),
        solids::cuboid(Vector3::new(1e-70, 2e-70, 3e-70)).unwrap(),
    ];
    let mut rng = Rng::new(5);
    for _ in 0..12 {
        let small = shapes::small(&mut rng);
        let far = small.points.iter().map(|p| Point3::new(p[0] + 1e9, p[1], p[2]));
        all.extend(ConvexPolyhedron::from_points(&far.collect::<Vec<_>>()));
        let points: Vec<_> = small.points.iter().map(|&p| Point3::from(p)).collect();
        all.push(ConvexPolyhedron::from_faces(&points, &small.faces).unwrap());
    }
    all
}

#[test]
fn a_query_comes_back_bit_for_bit() {
    let bodies = bodies();
    let mut rng = Rng::new(6);
    let mut warm = 0;
    for a in &bodies {
        for b in &bodies {
            let unit = |rng: &mut Rng| Vector3::from(rng.unit());
            let to = |rng: &mut Rng| Isometry3::new(unit(rng) * 3.0, unit(rng));
            let mut pair = Tracker::new();
            for _ in 0..3 {
                let pose = RelativePose::new(&to(&mut rng), &to(&mut rng)).unwrap();
                let replay = pair.replay(a, b, &pose, Accuracy::Exact);
                let again: Replay = replay.to_string().parse().unwrap();
                assert_eq!(again, replay);
                warm += usize::from(again.start.is_some());
                assert_eq!(again.tracker().trace(a, b, &pose), pair.trace(a, b, &pose));
                let bits = |o: lin_canny::Outcome| format!("{o:?}");
                let mut other = again.tracker();
                let mine = pair.closest(a, b, &pose);
                let theirs = other.closest(&again.a, &again.b, &again.pose);
                assert_eq!(bits(mine), bits(theirs), "{replay}");
            }
        }
    }
    assert!(warm > bodies.len());
}

#[test]
fn a_query_of_rounded_bodies_comes_back_bit_for_bit() {
    let mut rng = Rng::new(7);
    let (mut warm, mut overlaps) = (0, 0);
    for (k, a) in bodies().into_iter().enumerate() {
        let b = solids::icosahedron(1.0).unwrap();
        let round = [0.25, 0.0, 1e-9][k % 3];
        let [a, b] = [
            Shape::from(a).rounded(round).unwrap(),
            Shape::from(b).rounded(0.5).unwrap(),
        ];
        let mut pair = PairTracker::new();
        for _ in 0..4 {
            let pose = Isometry3::new(Vector3::from(rng.unit()) * 2.0, Vector3::from(rng.unit()));
            let pose = RelativePose::from_isometry(&pose).unwrap();
            let replay = pair.replay(&a, &b, &pose).expect("polyhedral cores");
            let again: Replay = replay.to_string().parse().unwrap();
            assert_eq!(again, replay);
            assert_eq!(again.shapes().map(|s| s.rounding_radius()), [round, 0.5]);
            warm += usize::from(again.start.is_some());
            let [c, d] = again.shapes();
            let mine = pair.closest(&a, &b, &pose);
            let theirs = again.pair_tracker().closest(&c, &d, &again.pose);
            overlaps += usize::from(mine.upper < 0.0);
            assert_eq!(format!("{mine:?}"), format!("{theirs:?}"));
        }
    }
    assert!(warm > 20 && overlaps > 3, "{warm} {overlaps}");
    let ball = Shape::ellipsoid(Vector3::new(1.0, 2.0, 3.0)).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    assert_eq!(PairTracker::new().replay(&ball, &ball, &pose), None);
}

/// Returns the replay of two boxes with one line changed.
fn with(line: usize, text: &str) -> Result<Replay, ReplayError> {
    let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(3.0, 0.0, 0.0)).unwrap();
    let replay = Tracker::new().replay(&a, &a, &pose, Accuracy::Certified).to_string();
    let mut lines: Vec<&str> = replay.lines().collect();
    lines[line - 1] = text;
    lines.join("\n").parse()
}

#[test]
fn what_is_no_replay_is_refused_by_line() {
    assert_eq!("".parse::<Replay>(), Err(ReplayError::Title));
    assert_eq!("lin-canny replay 2".parse::<Replay>(), Err(ReplayError::Title));
    let line = |r: Result<Replay, ReplayError>| match r {
        Err(ReplayError::Line { line, .. }) => line,
        other => panic!("{other:?}"),
    };
    assert_eq!(line("lin-canny replay 1".parse()), 0);
    assert_eq!(line(with(2, "level best")), 2);
    assert_eq!(line(with(4, "vertex 0 0 0")), 4);
    assert_eq!(line(with(4, "vertex 3ff0000000000000 3ff0000000000000")), 4);
    assert_eq!(line(with(4, "")), 3, "seven vertices are a body, but another one");
    assert_eq!(line(with(23, "start v0")), 23);
    assert_eq!(line(with(12, "round bff0000000000000\nbody B 8")), 12);
    let rounded = with(12, "round 3ff0000000000000\nbody B 8").unwrap();
    assert_eq!(rounded.rounding_radii, [1.0, 0.0]);
}

#[test]
fn what_makes_no_query_is_refused_by_name() {
    let nan = "vertex 7ff8000000000000 3ff0000000000000 3ff0000000000000";
    assert!(matches!(with(4, nan), Err(ReplayError::Body { which: Operand::A, .. })));
    let long = "pose A 4000000000000000 0000000000000000 0000000000000000 0000000000000000 \
                0000000000000000 0000000000000000 0000000000000000";
    assert!(
        matches!(with(21, long), Err(ReplayError::Pose(_))),
        "{:?}",
        with(21, long)
    );
    assert!(matches!(with(23, "start v8 v0"), Err(ReplayError::Start(_))));
    assert!(matches!(with(23, "start v7 f5"), Ok(Replay { start: Some(_), .. })));
}
