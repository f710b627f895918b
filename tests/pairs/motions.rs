//! Promise: a tracker changes the time, never the outcome: along motions, after jumps, for other
//! bodies, and for flat bodies.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Solver, Tracker};
use truth::bound;
use truth::motion::{self, Frame};
use truth::pose::{radius, unit};
use truth::rng::Rng;
use truth::shapes::Shape;
use truth::support;
use truth::support::{plain, relative};

/// Asserts that two outcomes of one query agree: the same contact state, and consistent bounds and
/// distances.
fn same(x: &Outcome, y: &Outcome, what: impl std::fmt::Display) {
    assert_eq!(x.state, y.state, "{what}:\n{x:?}\n{y:?}");
    let agree = x.lower <= y.upper && y.lower <= x.upper;
    assert!(agree, "{what}: bounds exclude each other\n{x:?}\n{y:?}");
    if x.state == ContactState::Separated {
        let width = (x.upper - x.lower) + (y.upper - y.lower);
        assert!((x.distance - y.distance).abs() <= width, "{what}:\n{x:?}\n{y:?}");
    }
}

/// Asserts the outcome of a separated pair by exact bounds: the normal proves it and the witnesses
/// attain it.
fn proved(a: &Shape, b: &Shape, frame: &Frame, o: &Outcome) {
    let normal = frame.a.rotate(o.normal.into_inner().into());
    let (on_a, on_b) = (o.point_on_a.coords.into(), o.point_on_b.coords.into());
    let c = bound::check(a.into(), &frame.a, b.into(), &frame.b, normal, on_a, on_b);
    assert!(c.within(1e-13), "{c:?} {o:?} {frame:?}");
    assert!(o.lower <= c.upper + 2.0 * c.outside, "{c:?} {o:?} {frame:?}");
    assert!(c.lower <= o.upper, "{c:?} {o:?} {frame:?}");
}

fn bodies() -> Vec<ConvexPolyhedron> {
    let hull = |n, axes, seed| solids::random_hull(n, axes, seed).expect("a hull");
    let mut all = support::shipped();
    all.push(hull(128, Vector3::new(1.0, 1.0, 1.0), 1));
    all.push(hull(512, Vector3::new(1.0, 1.0, 0.1), 2));
    all.push(hull(64, Vector3::new(1.0, 0.01, 0.01), 3));
    all
}

fn radii(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> (f64, f64) {
    let of = |x: &ConvexPolyhedron| radius(&plain(x).points);
    (of(a), of(b))
}

/// Returns every kind of motion for one pair.
fn motions(rng: &mut Rng, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Vec<(&'static str, Vec<Frame>)> {
    let r = radii(a, b);
    let start = motion::random_poses(rng, 1, r, (1.0, 1.1), 1.0)[0];
    let direction = rng.unit();
    let axis = unit([0.3, -0.5, 0.8]);
    vec![
        ("orbit", motion::orbit_and_spin(rng, 300, 0.5, r, (-0.1, 0.3), 100)),
        (
            "tumble",
            motion::tumble_past(rng, 200, 2.0, 0.9 * (r.0 + r.1), 3.0 * (r.0 + r.1)),
        ),
        ("pass", motion::pass_through(rng, 200, r, 0.1)),
        ("slide", motion::slide(start, direction, 0.01, 200)),
        (
            "approach",
            motion::approach(rng, axis, 2.0 * (r.0 + r.1), 0.9 * (r.0 + r.1), 1e-6, 100),
        ),
        ("jumps", motion::random_poses(rng, 100, r, (0.4, 1.5), 10.0)),
    ]
}

#[test]
fn warm_equals_cold_in_every_frame() {
    let mut rng = Rng::new(501);
    let bodies = bodies();
    let (mut classes, mut judged) = ([0; 2], 0);
    for _ in 0..40 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let (plain_a, plain_b) = (plain(a), plain(b));
        let (mut forth, mut back) = (Tracker::new(), Tracker::new());
        for (name, frames) in motions(&mut rng, a, b) {
            for (k, f) in frames.iter().enumerate() {
                let pose = relative(f);
                let warm = forth.closest(a, b, &pose);
                same(&warm, &Tracker::new().closest(a, b, &pose), format!("{name} {k}"));
                let turned = back.closest(b, a, &relative(&f.swapped()));
                same(&warm, &turned, format!("{name} {k} swapped"));
                classes[usize::from(warm.state == ContactState::Overlapping)] += 1;
                if k % 50 == 25 && warm.state == ContactState::Separated {
                    proved(&plain_a, &plain_b, f, &warm);
                    judged += 1;
                }
            }
        }
    }
    assert!(classes[0] > 20_000, "{classes:?}, {judged} judged");
    assert!(classes[1] > 2_000, "{classes:?}, {judged} judged");
    assert!(judged > 500, "{classes:?}, {judged} judged");
}

/// Coherence: half a degree per frame costs about one step, and the walk itself answers.
#[test]
fn steps_are_few_along_smooth_motions() {
    let mut rng = Rng::new(502);
    for n in [16, 128, 1024] {
        let hull = |seed| solids::random_hull(n, Vector3::new(1.0, 1.0, 1.0), seed).expect("a hull");
        let (a, b) = (hull(1), hull(2));
        let mut t = Tracker::new();
        let frames = motion::orbit_and_spin(&mut rng, 4000, 0.5, (1.0, 1.0), (0.02, 0.3), 500);
        frames
            .iter()
            .for_each(|f| assert_eq!(t.closest(&a, &b, &relative(f)).state, ContactState::Separated));
        let totals = t.work();
        let steps = totals.steps as f64 / totals.queries as f64;
        // Measured on the prototype of the walk: 1 + 0.085 sqrt(n) for half a degree.
        assert!(
            steps < 1.2 + 0.17 * f64::from(n as u32).sqrt(),
            "{steps} steps a query, n = {n}"
        );
        // A tracker may occasionally try the other start, to learn its cost.
        assert!(totals.queries == 4000 && totals.warm >= 3900, "{totals:?}");
        assert!(totals.answered_by(Solver::Walk) >= 3998, "{totals:?}");
    }
}

#[test]
fn a_foreign_tracker_costs_time_only() {
    let mut rng = Rng::new(503);
    let large = solids::random_hull(700, Vector3::new(1.0, 0.7, 0.5), 4).expect("a hull");
    let bodies = bodies();
    // From a large pair to small ones and back: ids that do not exist, and ids of other features.
    let mut t = Tracker::new();
    for _ in 0..2000 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let f = motion::random_poses(&mut rng, 1, (1.0, 1.0), (0.3, 1.2), 1.0)[0];
        if rng.chance(0.5) {
            t.closest(&large, &large, &relative(&f));
        }
        let strange = t.closest(a, b, &relative(&f));
        assert!(support::are_of(strange.features, a, b), "{strange:?}");
        same(&strange, &Tracker::new().closest(a, b, &relative(&f)), "foreign");
        let found = t.intersects(a, b, &relative(&f));
        assert_eq!(found, strange.state != ContactState::Separated);
    }
    assert!(t.work().warm > 100, "{:?}", t.work());
}

#[test]
fn features_of_other_bodies_are_no_start() {
    let large = solids::random_hull(700, Vector3::new(1.0, 0.7, 0.5), 5).expect("a hull");
    let small = solids::tetrahedron(1.0).expect("a tetrahedron");
    let pose = support::shifted([3.0, 0.2, 0.1]);
    let pair = Tracker::new().closest(&large, &large, &pose).features;
    let mut t = Tracker::with_features(pair, &small, &small);
    assert!(t.features().is_none() || support::are_of(t.features().expect("some"), &small, &small));
    same(
        &t.closest(&small, &small, &pose),
        &Tracker::new().closest(&small, &small, &pose),
        "start",
    );
}

/// Returns points, segments and polygons, against each other and against solids.
fn flat_bodies() -> Vec<ConvexPolyhedron> {
    let p = |x, y, z| Point3::new(x, y, z);
    let ring: Vec<_> = (0..7)
        .map(|k| f64::from(k) * 0.9)
        .map(|t| p(t.cos(), t.sin(), 0.0))
        .collect();
    [
        ConvexPolyhedron::point(p(0.2, -0.1, 0.3)),
        ConvexPolyhedron::point(p(0.0, 0.0, 0.0)),
        ConvexPolyhedron::segment(p(-1.0, 0.0, 0.0), p(1.0, 0.0, 0.0)),
        ConvexPolyhedron::segment(p(-0.3, 0.5, -0.7), p(0.3, -0.1, 0.9)),
        ConvexPolyhedron::polygon(&[p(-1.0, -1.0, 0.0), p(1.0, -1.0, 0.0), p(0.0, 1.0, 0.0)]),
        ConvexPolyhedron::polygon(&ring),
    ]
    .into_iter()
    .map(|b| b.expect("a flat body"))
    .collect()
}

#[test]
fn flat_bodies_are_bodies() {
    let mut rng = Rng::new(504);
    let flat = flat_bodies();
    let solid = [
        solids::cuboid(Vector3::new(0.5, 0.5, 0.5)),
        solids::cone(9, 0.5, 0.8),
        solids::icosahedron(0.7),
    ];
    let solid = solid.map(|b| b.expect("a solid"));
    let (mut seen, mut crossing) = (0, 0);
    for a in flat.iter().chain(&solid) {
        for b in &flat {
            let (plain_a, plain_b) = (plain(a), plain(b));
            let (mut forth, mut back) = (Tracker::new(), Tracker::new());
            for f in motion::random_poses(&mut rng, 60, (1.0, 1.0), (0.1, 1.2), 1.0) {
                let warm = forth.closest(a, b, &relative(&f));
                same(&warm, &Tracker::new().closest(a, b, &relative(&f)), "flat");
                same(&warm, &back.closest(b, a, &relative(&f.swapped())), "flat, swapped");
                assert!(support::are_of(warm.features, a, b));
                // Two bodies without volume share no interior point, but may cross.
                crossing += usize::from(warm.state != ContactState::Separated);
                if warm.state == ContactState::Separated {
                    flat_proved(&plain_a, &plain_b, &f, &warm);
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 1500 && crossing > 100, "{seen} apart, {crossing} not");
}

/// Like [`proved`], for bodies that may have no faces.
fn flat_proved(a: &Shape, b: &Shape, frame: &Frame, o: &Outcome) {
    let normal = frame.a.rotate(o.normal.into_inner().into());
    let gap = bound::support_gap(a.into(), &frame.a, b.into(), &frame.b, normal);
    let apart = bound::witness_distance(
        o.point_on_a.coords.into(),
        &frame.a,
        o.point_on_b.coords.into(),
        &frame.b,
    );
    assert!((gap - o.distance).abs() < 1e-14, "{gap} {apart} {o:?} {a:?} {b:?}");
    assert!((apart - o.distance).abs() < 1e-14, "{gap} {apart} {o:?} {a:?} {b:?}");
    assert!(o.lower <= gap && apart <= o.upper, "{gap} {apart} {o:?}");
}

/// Results computed by hand: crossing segments, a point on a polygon, parallel segments.
#[test]
fn flat_bodies_by_hand() {
    let p = |x, y, z| Point3::new(x, y, z);
    let along_x = ConvexPolyhedron::segment(p(-1.0, 0.0, 0.0), p(1.0, 0.0, 0.0)).expect("a segment");
    let along_y = ConvexPolyhedron::segment(p(0.0, -1.0, 0.0), p(0.0, 1.0, 0.0)).expect("a segment");
    let square = [
        p(-1.0, -1.0, 0.0),
        p(1.0, -1.0, 0.0),
        p(1.0, 1.0, 0.0),
        p(-1.0, 1.0, 0.0),
    ];
    let square = ConvexPolyhedron::polygon(&square).expect("a square");
    let point = ConvexPolyhedron::point(p(0.0, 0.0, 0.0)).expect("a point");
    let ask = |a: &ConvexPolyhedron, b: &ConvexPolyhedron, at| Tracker::new().closest(a, b, &support::shifted(at));
    let apart = [
        (&along_x, &along_y, [0.5, 0.2, 0.75], 0.75),
        (&along_x, &along_x, [0.5, 3.0, 4.0], 5.0),
        (&along_x, &along_x, [5.0, 0.0, 0.0], 3.0),
        (&square, &point, [0.3, 0.2, -2.0], 2.0),
        (&square, &point, [4.0, 5.0, 0.0], 5.0),
        (&square, &square, [0.1, 0.2, 0.5], 0.5),
        (&square, &along_x, [0.0, 0.0, 0.25], 0.25),
        (&point, &point, [2.0, 3.0, 6.0], 7.0),
    ];
    for (a, b, at, d) in apart {
        for o in [ask(a, b, at), ask(b, a, at.map(|x: f64| -x))] {
            assert_eq!(o.state, ContactState::Separated, "{at:?} {o:?}");
            assert!((o.distance - d).abs() < 1e-15 * 8.0, "{at:?} {o:?}");
            assert!(o.lower <= d, "{at:?} {o:?}");
            assert!(d <= o.upper, "{at:?} {o:?}");
        }
    }
    let meeting = [
        (&along_x, &along_y, [0.5, 0.2, 0.0]),
        (&along_x, &along_x, [0.5, 0.0, 0.0]),
        (&square, &point, [0.5, 0.5, 0.0]),
        (&square, &along_x, [0.0, 0.3, 0.0]),
        (&square, &square, [0.5, 0.5, 0.0]),
        (&point, &point, [0.0, 0.0, 0.0]),
    ];
    for (a, b, at) in meeting {
        for o in [ask(a, b, at), ask(b, a, at.map(|x: f64| -x))] {
            assert_eq!((o.state, o.distance), (ContactState::Touching, 0.0), "{at:?} {o:?}");
        }
    }
}
