//! Casts at every size and time scale: the result is that of size one, and never late.

use super::pairs::{Bodies, Fall};
use lin_canny::Tracker;
use lin_canny::impact::{Cast, Impact, Tolerance, cast, cast_within, overlapping_until};
use lin_canny::motion::{Motion, MotionModel, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Velocity};
use truth::casts::{aimed, body};
use truth::rng::Rng;

/// Returns motions of bodies that end at one half of `size`: B flies towards A, both rotating about
/// the line of flight.
fn head_on(size: f64, tick: f64) -> [Steady; 2] {
    let pace = size / tick;
    let spin = Vector3::x() / tick;
    let motion = |x: f64, v: f64, w: f64| {
        let velocity = Velocity::new(Vector3::x() * (v * pace), spin * w);
        Steady::new(&Isometry3::translation(x * size, 0.0, 0.0), velocity).expect("a motion")
    };
    [motion(0.0, 0.0, 0.75), motion(4.0, -1.0, -1.5)]
}

/// Returns the result in units of the clock.
fn told(found: &Cast, tick: f64) -> (&'static str, f64, f64) {
    match found.impact {
        Impact::Hit { safe, hit, .. } => ("hit", safe / tick, hit / tick),
        Impact::Miss => ("miss", 0.0, 0.0),
        Impact::Undecided { safe, .. } => ("near", safe / tick, 0.0),
        Impact::Incomplete { safe } => ("unknown", safe / tick, 0.0),
        _ => ("other", 0.0, 0.0),
    }
}

/// Head-on, every kind of pair meets when the gap is used up, and not before the requested
/// distance.
#[test]
fn every_kind_meets_on_time_at_every_size() {
    for k in (-330..=330).step_by(44) {
        let size = 2f64.powi(k);
        let bodies = Bodies::new(size);
        for clock in [0, -k, 200 - k / 2] {
            // Velocities stay in the range of motions.
            let tick = 2f64.powi(clock.clamp(k - 332, k + 332).max(-332));
            let motions = head_on(size, tick);
            let [a, b] = &motions;
            bodies.each(|kind, pair| {
                // Below this size, surfaces are measured only by their origins: no hit is proven.
                let is_tiny = kind.contains("surface") && k < -290;
                let tolerance = Tolerance::Distance(1e-6 * size);
                for (until, keep, truth) in [(3.5, 0.0, 3.0), (2.5, 0.0, f64::NAN), (3.5, 1.0, 2.0)] {
                    let found = cast_within(pair, a, b, 0.0..until * tick, tolerance, keep * size).expect("a cast");
                    let (answer, safe, hit) = told(&found, tick);
                    let what = format!("{kind} at 2^{k}, tick {tick:e}, until {until}: {found:?}");
                    if is_tiny {
                        let is_true = match answer {
                            "miss" => truth.is_nan(),
                            "near" | "unknown" => truth.is_nan() || safe <= truth,
                            _ => false,
                        };
                        assert!(is_true, "{what}");
                    } else if truth.is_nan() {
                        assert_eq!(answer, "miss", "{what}");
                    } else {
                        assert!(answer == "hit" && safe <= truth, "{what}");
                        assert!(hit >= truth - 1e-12 && hit - safe < 1e-4, "{what}");
                    }
                }
            });
        }
    }
}

fn scaled(body: &ConvexPolyhedron, size: f64) -> ConvexPolyhedron {
    let points: Vec<_> = body.vertex_points().map(|p| p * size).collect();
    ConvexPolyhedron::from_points(&points).expect("a solid")
}

/// Spinning throws of polyhedra: the result of size one, bit for bit, at every other size and time
/// scale.
#[test]
fn answers_scale_bit_for_bit() {
    let mut rng = Rng::new(1922);
    let (mut hits, mut misses) = (0, 0);
    for case in 0..60 {
        let (a, b) = (body("sphere", 8, &mut rng), body("box", 8, &mut rng));
        let turn = [0.0, 1.0, 6.0][case % 3];
        let throw = aimed(&mut rng, (1.0, 0.9), turn);
        let pivot = Point3::from(Vector3::from(rng.in_ball()));
        let push = Vector3::from(rng.in_ball());
        let at = |size: f64, tick: f64| {
            let motion = |k: usize| {
                let mut start = throw.start[k];
                start.translation.vector *= size;
                let Velocity { linear, angular, .. } = throw.velocity[k];
                let velocity = Velocity::new(linear * (size / tick), angular / tick);
                let pivot = if case % 4 == 0 { pivot * size } else { Point3::origin() };
                let motion = Steady::about(&start, pivot, velocity).expect("a motion");
                if case % 5 == 0 {
                    motion
                        .with_acceleration(push * (size / tick / tick))
                        .expect("an acceleration")
                } else {
                    motion
                }
            };
            let (motions, bodies) = ([motion(0), motion(1)], [scaled(&a, size), scaled(&b, size)]);
            let mut tracker = Tracker::new();
            let mut pair = tracker.pair(&bodies[0], &bodies[1]);
            let tolerance = Tolerance::Distance(1e-9 * size);
            cast(&mut pair, &motions[0], &motions[1], 0.0..tick, tolerance).expect("a cast")
        };
        let one = at(1.0, 1.0);
        match one.impact {
            Impact::Hit { .. } => hits += 1,
            Impact::Miss => misses += 1,
            _ => {}
        }
        for k in [-320, -300, -272, -180, -90, 90, 200, 310] {
            for clock in [0, 150, -k / 2] {
                // Velocities and accelerations stay in the range of motions.
                let tick = 2f64.powi(clock.max(k - 320).max((k - 320) / 2).max(-320));
                let found = at(2f64.powi(k), tick);
                let what = format!("case {case} at 2^{k}, tick {tick:e}: {found:?}, at size one {one:?}");
                assert_eq!(told(&found, tick), told(&one, 1.0), "{what}");
                assert_eq!((found.queries, found.proofs), (one.queries, one.proofs), "{what}");
            }
        }
    }
    assert!(hits > 15 && misses > 10, "{hits} {misses}");
}

/// A motion on another time scale, with velocities beyond the range of the crate's motions.
struct Clocked(Fall, f64);

impl Motion for Clocked {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        self.0.pose(time / self.1)
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        let (Self(fall, tick), per) = (self, 1.0 / self.1);
        let mut model = fall.model(time / tick, span / tick);
        model.linear *= per;
        model.angular *= per;
        model.acceleration = model.acceleration * per * per;
        for drift in [&mut model.shift.0, &mut model.turn.0] {
            (drift[1], drift[2], drift[3]) = (drift[1] * per, drift[2] * per * per, drift[3] * per * per * per);
        }
        model
    }
}

/// Time scales at which squares and cubes of velocities leave `f64`: the result of scale one, bit
/// for bit, for every kind of pair.
#[test]
fn no_clock_changes_an_answer() {
    let bodies = Bodies::new(1.0);
    let mut rng = Rng::new(1923);
    let mut hits = 0;
    for case in 0..6 {
        let spin = Vector3::from(rng.in_ball()) * 6.0;
        let gravity = if case % 2 == 0 {
            Vector3::from(rng.in_ball())
        } else {
            Vector3::zeros()
        };
        let fall = |x: f64, v: f64| Fall {
            start: Isometry3::translation(x, 0.1, 0.0),
            linear: Vector3::x() * v,
            angular: spin * v.abs(),
            gravity: gravity * v.abs(),
            is_named: case % 4 < 2,
        };
        let (a, b) = (fall(0.0, 0.0), fall(4.0, -1.0));
        // Separate pairs for each time scale: bounds of surfaces depend on the cached state of the
        // previous pose.
        let ask = |clock: i32| {
            let tick = 2f64.powi(clock);
            let (a, b, until) = (Clocked(a, tick), Clocked(b, tick), 4.0 * tick);
            let mut answers = Vec::new();
            bodies.each(|kind, pair| {
                let tolerance = Tolerance::Distance(1e-6);
                let found = cast(pair, &a, &b, 0.0..until, tolerance).expect("a cast");
                let held = overlapping_until(pair, &a, &b, 0.0..until, 0.5).expect("an answer");
                answers.push((kind.to_string(), told(&found, tick), found.queries, held / tick));
            });
            answers
        };
        let one = ask(0);
        hits += one.iter().filter(|(_, found, ..)| found.0 == "hit").count();
        // Twice the exponent of the time scale, for the acceleration, stays in the range of `f64`.
        for clock in [-500, -400, -200, 200, 330, 355, 400, 500] {
            assert_eq!(ask(clock), one, "case {case}, tick 2^{clock}");
        }
    }
    assert!(hits > 20, "{hits}");
}

/// A motion model bounds a displacement at any time scale.
#[test]
fn displacements_do_not_vanish() {
    for clock in [-900, -540, 540, 900] {
        let tick = 2f64.powi(clock);
        let fall = Fall {
            linear: Vector3::y(),
            angular: Vector3::z(),
            ..Fall::still()
        };
        let most = Clocked(fall, tick).model(0.0, tick).displacement(1.0, tick);
        assert!((2.0..2.0 + 1e-12).contains(&most), "{clock}: {most}");
    }
}
