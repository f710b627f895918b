//! Bodies in contact at the start: they may leave it or slide along it, and must not come closer.

use lin_canny::impact::{Cast, CastOptions, Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Compound, ContactState, Geometry, GeometryKind, GeometryRef, HalfSpace, Mesh, PairTracker, Piece, RelativePose,
    Shape, Velocity,
};
use truth::rng::Rng;

/// Half the height of a part, and of the table; the table reaches from -1 to 1.
const HALF: f64 = 0.125;

/// A table whose top is at `z = HALF`.
fn tables(size: f64) -> Vec<(&'static str, Geometry)> {
    let half = Vector3::new(1.0, 1.0, HALF) * size;
    let body = solids::cuboid(half).expect("a box");
    let slim = solids::cuboid(half - Vector3::repeat(0.0625 * size)).expect("a box");
    vec![
        ("polyhedron", body.clone().into()),
        (
            "rounded",
            Shape::rounded(slim.into(), 0.0625 * size)
                .expect("a rounded box")
                .into(),
        ),
        (
            "half-space",
            HalfSpace::new(Vector3::z(), HALF * size).expect("a floor").into(),
        ),
        ("mesh", Mesh::from_convex(&body).expect("a mesh").into()),
        (
            "compound",
            Compound::new(vec![Piece::new(body)]).expect("a piece").into(),
        ),
    ]
}

/// Parts that stand on `z = -HALF`.
fn parts(size: f64) -> Vec<(&'static str, Geometry)> {
    let half = Vector3::new(0.25, HALF, HALF) * size;
    let body = solids::cuboid(half).expect("a box");
    let foot = Isometry3::translation(0.0, 0.5 * size, 0.0);
    let mut feet = vec![Piece::new(body.clone()), Piece::new(body.clone())];
    feet[1].pose = foot;
    let cylinder = Shape::cylinder(HALF * size, HALF * size).expect("a cylinder");
    vec![
        ("polyhedron", body.clone().into()),
        ("ball", Shape::ball(HALF * size).expect("a ball").into()),
        ("cylinder", cylinder.into()),
        ("mesh", Mesh::from_convex(&body).expect("a mesh").into()),
        ("compound", Compound::new(feet).expect("two feet").into()),
    ]
}

/// Returns bounds of the signed distance at a time.
fn signed(a: &Geometry, b: &Geometry, pose: &RelativePose) -> [f64; 2] {
    let mut tracker = PairTracker::new();
    let found = tracker.closest(a, b, pose);
    let is_floor = [a, b].iter().any(|g| g.kind() == GeometryKind::HalfSpace);
    if found.state == ContactState::Separated || is_floor || (a.as_convex().is_some() && b.as_convex().is_some()) {
        return [found.lower, found.upper];
    }
    let depth = tracker.penetration(a, b, pose).expect("solids");
    [-depth.upper, -depth.lower]
}

struct Case<'a> {
    bodies: [&'a Geometry; 2],
    motions: [&'a dyn Motion; 2],
    options: CastOptions,
    name: String,
}

impl Case<'_> {
    fn cast(&self) -> Cast {
        let [a, b] = self.bodies.map(GeometryRef::from);
        let [x, y] = self.motions;
        let mut tracker = PairTracker::new();
        let cold = tracker.cast_from_contact([a, b], x, y, 0.0..1.0, &self.options, None);
        let cold = cold.unwrap_or_else(|e| panic!("{}: {e}", self.name));
        let warm = tracker.cast_from_contact([a, b], x, y, 0.0..1.0, &self.options, None);
        let found = kind(&warm.expect("as before").impact);
        assert_eq!(found, kind(&cold.impact), "{}", self.name);
        self.judge(&cold);
        cold
    }

    fn pose(&self, time: f64) -> RelativePose {
        let [x, y] = self.motions.map(|m| m.pose(time));
        RelativePose::new(&x, &y).expect("a pose")
    }

    /// Samples both rules of a cast.
    fn judge(&self, cast: &Cast) {
        let [a, b] = self.bodies;
        let Some(start) = cast.start_contact else { return };
        let safe = match cast.impact {
            Impact::Miss => 1.0,
            Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => safe,
            _ => 0.0,
        };
        for k in 0..=40 {
            let time = safe * f64::from(k) / 40.0;
            let [_, upper] = signed(a, b, &self.pose(time));
            let keep = if start.until.is_some_and(|t| time >= t) {
                self.options.distance
            } else {
                start.kept
            };
            assert!(upper >= keep, "{}: {upper} < {keep} at {time}: {cast:?}", self.name);
        }
        if let Impact::Hit { hit, .. } = cast.impact {
            let [lower, _] = signed(a, b, &self.pose(hit));
            let keep = if start.until.is_some_and(|t| hit > t) {
                self.options.distance
            } else {
                start.kept
            };
            assert!(lower <= keep, "{}: {lower} > {keep}: {cast:?}", self.name);
        }
    }
}

fn kind(impact: &Impact) -> &'static str {
    match impact {
        Impact::Miss => "miss",
        Impact::Hit { .. } => "hit",
        Impact::AtStart { .. } => "at start",
        Impact::Undecided { .. } => "undecided",
        _ => "incomplete",
    }
}

/// A motion of a part on the table: its name, its velocity, its acceleration, and the result.
type Move = (&'static str, Velocity, Vector3<f64>, &'static str);

fn moves(size: f64) -> Vec<Move> {
    let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * size;
    let still = Vector3::zeros();
    let straight = |name, way, result| (name, Velocity::new(way, still), still, result);
    vec![
        straight("lift", v(0.0, 0.0, 1.0), "miss"),
        straight("lift aslant", v(0.5, 0.2, 0.1), "miss"),
        straight("slide", v(0.5, 0.25, 0.0), "miss"),
        straight("slide past the end", v(2.0, 0.3, 0.0), "miss"),
        straight("rest", still, "miss"),
        straight("press", v(0.0, 0.0, -0.5), "hit"),
        straight("press aslant", v(0.5, 0.0, -0.01), "hit"),
        ("twist", Velocity::new(still, Vector3::z() * 3.0), still, "miss"),
        (
            "slide and twist",
            Velocity::new(v(0.5, 0.0, 0.0), Vector3::z() * 2.0),
            still,
            "miss",
        ),
        (
            "lift and twist",
            Velocity::new(v(0.1, 0.0, 0.5), Vector3::z() * 1.0),
            still,
            "miss",
        ),
        (
            "thrown up",
            Velocity::new(v(0.2, 0.0, 1.0), still),
            v(0.0, 0.0, -3.0),
            "hit",
        ),
    ]
}

fn run(seed: u64, count: u64) {
    let mut tally = std::collections::BTreeMap::new();
    for case in 0..count {
        let mut rng = Rng::of_case(seed, case);
        let size = [1.0, 1.0, 1e-3, 2f64.powi(-200), 2f64.powi(200)][rng.below(5)];
        let (table_kind, table) = rng.pick(&tables(size)).clone();
        let (part_kind, part) = rng.pick(&parts(size)).clone();
        let (name, velocity, acceleration, result) = *rng.pick(&moves(size));
        let gap = [0.0, 0.0, 1e-12, 5e-4, -5e-4, -2e-3][rng.below(6)];
        let at = Vector3::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), 2.0 * HALF + gap) * size;
        let world = if rng.chance(0.4) {
            Isometry3::identity()
        } else {
            let far = [1.0, 30.0][rng.below(2)] * size;
            let turn = Vector3::new(rng.range(-3.0, 3.0), rng.range(-3.0, 3.0), rng.range(-3.0, 3.0));
            let shift = Vector3::new(rng.range(-far, far), rng.range(-far, far), rng.range(-far, far));
            Isometry3::new(shift, turn)
        };
        let turned = |v: &Vector3<f64>| world.rotation * v;
        let velocity = Velocity::new(turned(&velocity.linear), turned(&velocity.angular));
        let start = world * Isometry3::from_parts(at.into(), UnitQuaternion::identity());
        let moving =
            Steady::about(&start, Point3::origin(), velocity).and_then(|m| m.with_acceleration(turned(&acceleration)));
        let moving = moving.expect("a motion");
        let resting = Steady::new(&world, Velocity::default()).expect("rest");
        let distance = [0.0, 2e-4 * size][rng.below(2)];
        let options = CastOptions::default()
            .tolerance(Tolerance::Distance(1e-6 * size))
            .distance(distance)
            .start_contact_margin(1e-3 * size);
        let name = format!("case {case}: {part_kind} on {table_kind}, {name}, size {size:e}, gap {gap:e}");
        let result = if gap < -1e-3 { "at start" } else { result };
        let is_swapped = rng.chance(0.5);
        let found = if is_swapped {
            let motions: [&dyn Motion; 2] = [&moving, &resting];
            Case {
                bodies: [&part, &table],
                motions,
                options,
                name: name.clone(),
            }
            .cast()
        } else {
            let motions: [&dyn Motion; 2] = [&resting, &moving];
            Case {
                bodies: [&table, &part],
                motions,
                options,
                name: name.clone(),
            }
            .cast()
        };
        *tally.entry(result).or_insert(0) += 1;
        assert_eq!(kind(&found.impact), result, "{name}, distance {distance:e}: {found:?}");
    }
    println!("{tally:?}");
    assert_eq!(tally.len(), 3, "{tally:?}");
}

#[test]
fn parts_leave_the_table_and_never_enter_it() {
    run(1, 200);
}

#[test]
#[ignore = "20,000 casts, a minute: cargo test --release --all-features --test impact leave -- --ignored"]
fn parts_leave_the_table_and_never_enter_it_in_full() {
    run(2, 20_000);
}

/// The planes of the certificates separate the bodies by the distance that they state, at every
/// sampled time, before and after the bodies have left the margin.
#[test]
fn certificates_of_a_lift_hold() {
    let (table, part) = (tables(1.0).remove(0).1, parts(1.0).remove(0).1);
    let still = Steady::new(&Isometry3::identity(), Velocity::default()).expect("rest");
    let velocity = Velocity::new(Vector3::new(0.3, 0.1, 0.4), Vector3::new(0.0, 0.0, 1.0));
    let lift = Steady::new(&Isometry3::translation(0.1, 0.2, 2.0 * HALF), velocity).expect("a motion");
    let options = CastOptions::default()
        .tolerance(Tolerance::Distance(1e-9))
        .start_contact_margin(1e-3);
    let (a, b) = (GeometryRef::from(&table), GeometryRef::from(&part));
    let mut tracker = PairTracker::new();
    let mut trail = Vec::new();
    let cast = tracker.cast_from_contact([a, b], &still, &lift, 0.0..1.0, &options, Some(&mut trail));
    let cast = cast.expect("a cast");
    assert_eq!(cast.impact, Impact::Miss);
    let start = cast.start_contact.expect("a contact at the start");
    assert!(start.kept < 0.0 && start.kept > -1e-8, "{start:?}");
    let mut time = 0.0;
    for certificate in &trail {
        assert_eq!(certificate.from, time);
        let expected = if certificate.from < start.until.expect("it leaves") {
            start.kept
        } else {
            0.0
        };
        assert!(certificate.distance >= expected, "{certificate:?}");
        for k in 0..=100 {
            let at = certificate.from + (certificate.until - certificate.from) * f64::from(k) / 100.0;
            let mut pair = tracker.pair(a, b);
            if let Some(gap) = certificate.gap(&mut pair, &still, &lift, at) {
                assert!(gap >= certificate.distance - 1e-15, "{gap} at {at}: {certificate:?}");
            }
        }
        time = certificate.until;
    }
    assert_eq!(time, 1.0);
}

#[test]
fn numbers_out_of_range_are_named() {
    let (table, part) = (tables(1.0).remove(0).1, parts(1.0).remove(0).1);
    let still = Steady::new(&Isometry3::identity(), Velocity::default()).expect("rest");
    let bodies = [GeometryRef::from(&table), GeometryRef::from(&part)];
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let good = CastOptions::default();
        for (options, what) in [
            (CastOptions::default().tolerance(Tolerance::Distance(bad)), "tolerance"),
            (good.distance(bad), "distance"),
            (good.start_contact_margin(bad), "start contact margin"),
        ] {
            let found = PairTracker::new().cast_from_contact(bodies, &still, &still, 0.0..1.0, &options, None);
            assert!(found.expect_err("an error").to_string().contains(what), "{what} {bad}");
        }
    }
}
