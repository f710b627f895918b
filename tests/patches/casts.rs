//! Surfaces over time: closed forms and dense samples; no late and no missed contact.

use lin_canny::impact::{Impact, Tolerance, cast, cast_within, free_until};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::separation::Separation;
use lin_canny::surface::BezierSurface;
use lin_canny::{Decision, PairTracker, RelativePose, Shape, Velocity};
use truth::rng::Rng;
use truth::support::Decide;

use crate::bodies::{bumpy, sphere};
use crate::shapes::{kinds, sampled};

fn moving(at: Vector3<f64>, linear: Vector3<f64>, angular: Vector3<f64>) -> Steady {
    Steady::new(&Isometry3::from(at), Velocity::new(linear, angular)).expect("a motion")
}

fn at(a: &Steady, b: &Steady, time: f64) -> RelativePose {
    RelativePose::new(&a.pose(time), &b.pose(time)).expect("a pose")
}

/// Returns the first time at which two balls whose radii add up to `reach` meet.
fn meeting(from: Vector3<f64>, velocity: Vector3<f64>, reach: f64) -> Option<f64> {
    let a = velocity.norm_squared();
    let b = from.dot(&velocity);
    let c = from.norm_squared() - reach * reach;
    let root = b * b - a * c;
    (root > 0.0 && b < 0.0).then(|| c / (-b + root.sqrt()))
}

/// Judges a cast of two round bodies.
fn judge(pair: &mut dyn Separation, throw: [&Steady; 2], truth: Option<f64>, keep: f64) -> bool {
    let [a, b] = throw;
    let found = cast_within(pair, a, b, 0.0..1.0, Tolerance::Distance(1e-6), keep).expect("a cast");
    match (found.impact, truth) {
        (Impact::Hit { safe, hit, .. }, Some(t)) => {
            assert!(safe <= t + 1e-14, "{t} {found:?}");
            assert!(t - 1e-14 <= hit, "{t} {found:?}");
            assert!(hit - safe < 1e-3, "{t} {found:?}");
            assert!(hit - safe < 2e-5 || t > 0.0, "{found:?}");
            true
        }
        (Impact::Miss, t) => {
            assert!(t.is_none_or(|t| t > 1.0 - 1e-9), "{t:?} missed");
            false
        }
        (Impact::Undecided { safe, .. } | Impact::Incomplete { safe }, t) => {
            assert!(t.is_none_or(|t| safe <= t), "{t:?} {found:?}");
            panic!("undecided: {t:?} {found:?}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn spheres_meet_on_time() {
    let mut rng = Rng::new(41);
    let (shell, other) = (sphere(1.0), sphere(0.4));
    let ball = Shape::ball(0.4).expect("a ball");
    let mut hits = 0;
    for k in 0..40 {
        let from = Vector3::from(rng.unit()) * rng.range(1.6, 3.0);
        let velocity = Vector3::from(rng.unit()) * 3.0;
        let velocity = if k % 4 > 0 {
            (velocity - from * 2.0) * 0.5
        } else {
            velocity
        };
        let spin = Vector3::from(rng.unit()) * rng.range(0.0, 4.0);
        let a = moving(Vector3::zeros(), Vector3::zeros(), spin);
        let b = moving(from, velocity, -spin);
        let keep = if k % 3 == 0 { 0.1 } else { 0.0 };
        let truth = meeting(from, velocity, 1.4 + keep);
        if truth.is_some_and(|t| (t - 1.0).abs() < 1e-3) {
            continue;
        }
        let truth = truth.filter(|t| *t < 1.0);
        let is_hit = judge(&mut PairTracker::new().pair(&shell, &ball), [&a, &b], truth, keep);
        judge(&mut PairTracker::new().pair(&ball, &shell), [&b, &a], truth, keep);
        if k % 4 == 1 {
            judge(&mut PairTracker::new().pair(&shell, &other), [&a, &b], truth, keep);
        }
        hits += u32::from(is_hit);
    }
    assert!(hits > 10, "{hits}");
}

/// A ball in a shell meets the shell from the inside.
#[test]
fn hollows_are_no_matter() {
    let shell = sphere(1.0);
    let ball = Shape::ball(0.3).expect("a ball");
    let still = moving(Vector3::zeros(), Vector3::zeros(), Vector3::x());
    let fall = moving(Vector3::new(0.1, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0), Vector3::y());
    let mut tracker = PairTracker::new();
    let mut pair = tracker.pair(&shell, &ball);
    let found = cast(&mut pair, &still, &fall, 0.0..2.0, Tolerance::Distance(1e-6)).expect("a cast");
    let Impact::Hit { safe, hit, .. } = found.impact else {
        panic!("{found:?}")
    };
    assert!(safe <= 0.6 && 0.6 <= hit && hit - safe < 1e-5, "{found:?}");
    let free = free_until(&mut pair, &still, &fall, 0.0..2.0, 0.05).expect("a proof");
    assert!(free.until > 0.05 && free.until < 0.55, "{free:?}");
}

/// Patches thrown at shapes of every kind: separated up to `safe` at samples, in contact at the
/// hit.
#[test]
fn patches_meet_shapes_never_late() {
    let mut rng = Rng::new(42);
    let (mut hits, mut misses) = (0, 0);
    for (k, shape) in kinds().iter().enumerate() {
        for _ in 0..12 {
            let surface = BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.6)]).expect("a surface");
            let from = Vector3::from(rng.unit()) * rng.range(1.5, 2.5);
            let aside = Vector3::from(rng.unit()) * rng.range(0.0, 2.4);
            let a = moving(Vector3::zeros(), Vector3::zeros(), Vector3::from(rng.unit()));
            let b = moving(from, aside - from * 1.5, Vector3::from(rng.unit()) * 2.0);
            let mut tracker = PairTracker::new();
            if tracker.decide(&surface, shape, &at(&a, &b, 0.0), 1e-3) != Decision::No {
                continue;
            }
            let mut pair = tracker.pair(&surface, shape);
            let found = cast(&mut pair, &a, &b, 0.0..1.0, Tolerance::Distance(1e-5)).expect("a cast");
            let until = match found.impact {
                Impact::Hit { safe, hit, .. } => {
                    hits += 1;
                    assert_eq!(tracker.decide(&surface, shape, &at(&a, &b, hit), 0.0), Decision::Yes);
                    safe
                }
                Impact::Miss => {
                    misses += 1;
                    1.0
                }
                other => panic!("{k}: {other:?}"),
            };
            for i in 0..=20 {
                let time = until * f64::from(i) / 20.0;
                let least = sampled(&surface, shape, &at(&a, &b, time), 12);
                assert!(least > 0.0, "{k}: {least} at {time}, safe {until}");
            }
        }
    }
    println!("{hits} hits, {misses} misses");
    assert!(hits > 60 && misses > 10, "{hits} {misses}");
}

/// Two patches: the cast agrees with small steps.
#[test]
fn patches_meet_patches_never_late() {
    let mut rng = Rng::new(43);
    let (mut hits, mut misses) = (0, 0);
    for k in 0..10 {
        let a = BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.5)]).expect("a surface");
        let b = BezierSurface::new(vec![bumpy(&mut rng, [2, 2], 0.5)]).expect("a surface");
        let from = Vector3::from(rng.unit()) * 3.0;
        let aside = Vector3::from(rng.unit()) * rng.range(0.0, 2.0);
        let x = moving(Vector3::zeros(), Vector3::zeros(), Vector3::from(rng.unit()));
        let y = moving(from, aside - from, Vector3::from(rng.unit()));
        let mut tracker = PairTracker::new();
        let mut pair = tracker.pair(&a, &b);
        let found = cast(&mut pair, &x, &y, 0.0..1.0, Tolerance::Distance(1e-4)).expect("a cast");
        let until = match found.impact {
            Impact::Hit { safe, hit, .. } => {
                hits += 1;
                assert_eq!(tracker.decide(&a, &b, &at(&x, &y, hit), 0.0), Decision::Yes);
                safe
            }
            Impact::Miss => {
                misses += 1;
                1.0
            }
            // A boundary of a patch that meets a boundary is no crossing: no time is proven free.
            Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
                println!("{k}: {:?}", found.impact);
                safe
            }
            other => panic!("{k}: {other:?}"),
        };
        for i in 0..=40 {
            let time = until * f64::from(i) / 40.0;
            let decided = tracker.decide(&a, &b, &at(&x, &y, time), 0.0);
            assert!(decided != Decision::Yes, "{k}: they meet at {time}, safe {until}");
        }
    }
    println!("{hits} hits, {misses} misses");
    assert!(hits >= 2 && misses >= 1, "{hits} {misses}");
}
