//! Casts of rounded and curved shapes: closed forms for balls, and dense sampling for every pair of
//! kinds.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{PairTracker, RelativePose, Shape, Velocity};
use truth::casts;
use truth::forms::shapes;
use truth::rng::Rng;

const TOLERANCE: f64 = 1e-9;

/// Instants of a motion at which a separate tracker measures the shapes.
const INSTANTS: usize = 100;

fn steady(start: &Isometry3<f64>, linear: Vector3<f64>, angular: Vector3<f64>) -> Steady {
    Steady::new(start, Velocity::new(linear, angular)).expect("a finite motion")
}

/// Returns the first root of `|x + v t| = r` for `t` in 0 to 1.
fn balls_meet(x: &Vector3<f64>, v: &Vector3<f64>, r: f64) -> Option<f64> {
    let (a, b, c) = (v.norm_squared(), x.dot(v), x.norm_squared() - r * r);
    let root = b * b - a * c;
    let t = if root > 0.0 { (-b - root.sqrt()) / a } else { f64::NAN };
    (0.0..=1.0).contains(&t).then_some(t)
}

#[test]
fn balls_meet_when_the_closed_form_says() {
    let (mut hits, mut misses) = (0, 0);
    for case in 0..2000 {
        let mut rng = Rng::of_case(77, case);
        let (ra, rb) = (rng.log_range(0.01, 10.0), rng.log_range(0.01, 10.0));
        let (a, b) = (Shape::ball(ra).unwrap(), Shape::ball(rb).unwrap());
        let x = Vector3::from(rng.unit()) * ((ra + rb) * rng.range(1.01, 3.0));
        let v = -x * rng.range(0.2, 1.5) + Vector3::from(rng.unit()) * (ra + rb);
        let spin = Vector3::from(rng.unit()) * 10.0;
        let motions = [
            steady(&Isometry3::identity(), Vector3::zeros(), spin),
            steady(&Isometry3::from_parts(x.into(), lin_canny::nalgebra::one()), v, -spin),
        ];
        let found = cast(
            &mut PairTracker::new().pair(&a, &b),
            &motions[0],
            &motions[1],
            0.0..1.0,
            Tolerance::Distance(TOLERANCE * (ra + rb)),
        );
        match (found.expect("a finite cast").impact, balls_meet(&x, &v, ra + rb)) {
            (Impact::Hit { safe, hit, .. }, Some(t)) => {
                assert!(safe <= t + 1e-12 && t <= hit + 1e-12, "case {case}: {safe} {t} {hit}");
                hits += 1;
            }
            (Impact::Miss, None) => misses += 1,
            // A grazing motion: nearly a hit and nearly a miss.
            (Impact::Undecided { safe, .. }, _) => assert!(safe > 0.0, "case {case}"),
            (impact, t) => panic!("case {case}: {impact:?}, closed form {t:?}"),
        }
    }
    assert!(hits > 300 && misses > 300, "{hits} hits, {misses} misses");
}

#[test]
fn every_pair_of_kinds_is_apart_until_it_is_hit() {
    let (mut hits, mut misses, mut open) = (0, 0, 0);
    let shapes = shapes([0.7, 0.5, 0.9]);
    for case in 0..6 * (shapes.len() * shapes.len()) as u64 {
        let mut rng = Rng::of_case(78, case);
        let a = &shapes[case as usize % shapes.len()];
        let b = &shapes[case as usize / shapes.len() % shapes.len()];
        let turn = [0.0, 0.3, 1.0, 6.0][rng.below(4)];
        let throw = casts::aimed(&mut rng, (a.bounding_ball().1, b.bounding_ball().1), turn);
        let motions = [0, 1].map(|k| steady(&throw.start[k], throw.velocity[k].linear, throw.velocity[k].angular));
        let found = cast(
            &mut PairTracker::new().pair(a, b),
            &motions[0],
            &motions[1],
            0.0..1.0,
            Tolerance::Distance(TOLERANCE),
        );
        let relative = |t: f64| RelativePose::new_normalized(&motions[0].pose(t), &motions[1].pose(t)).expect("a pose");
        let (until, hit) = match found.expect("a finite cast").impact {
            Impact::Hit { safe, hit, .. } => (safe, Some(hit)),
            Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => (safe, None),
            Impact::Miss => (1.0, None),
            _ => continue,
        };
        let mut tracker = PairTracker::new();
        for k in 0..INSTANTS {
            let t = until * k as f64 / INSTANTS as f64;
            let seen = tracker.distance(a, b, &relative(t));
            assert!(seen.upper > 0.0, "case {case}: {seen} at {t} before {until}");
        }
        if let Some(hit) = hit {
            let seen = tracker.distance(a, b, &relative(hit));
            assert!(seen.lower <= 1e-12, "case {case}: {seen} at the hit {hit}");
            hits += 1;
        } else if until == 1.0 {
            misses += 1;
        } else {
            open += 1;
        }
    }
    assert!(hits > 200, "{hits} hits, {misses} misses, {open} open");
    assert!(misses > 100, "{hits} hits, {misses} misses, {open} open");
    assert!(open * 20 < hits, "{hits} hits, {misses} misses, {open} open");
}
