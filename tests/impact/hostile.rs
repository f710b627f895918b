//! Invalid motions, and intervals without length: a cast proves nothing from them, and always ends.

use super::pairs::{Bodies, Fall};
use lin_canny::impact::{Cast, Impact, ImpactError, Tolerance, cast, cast_within, free_until, overlapping_until};
use lin_canny::motion::{Motion, MotionModel, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::separation::{FreeSpan, Measurement, PairMotion, Proof, Separation, Tangent};
use lin_canny::{ContactState, Operand, RelativePose, Velocity};
use truth::rng::Rng;

const FINE: Tolerance = Tolerance::Distance(1e-6);

/// A motion whose model has an invalid number, from a time on.
struct Broken {
    way: Fall,
    field: usize,
    number: f64,
    from: f64,
}

/// Number of numbers in a model.
const FIELDS: usize = 20;

impl Motion for Broken {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        self.way.pose(time)
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        let mut model = self.way.model(time, span);
        if time >= self.from {
            let vectors = [
                &mut model.pivot.coords,
                &mut model.linear,
                &mut model.angular,
                &mut model.acceleration,
            ];
            let bounds = [&mut model.shift.0, &mut model.turn.0];
            let mut numbers = vectors
                .into_iter()
                .flat_map(|v| v.iter_mut())
                .chain(bounds.into_iter().flatten());
            *numbers.nth(self.field).expect("a field") = self.number;
        }
        model
    }
}

fn towards(x: f64, speed: f64) -> Fall {
    Fall {
        start: Isometry3::translation(x, 0.0, 0.0),
        linear: Vector3::x() * -speed,
        ..Fall::still()
    }
}

#[test]
fn a_course_that_is_none_proves_nothing() {
    let bodies = Bodies::new(1.0);
    let still = Fall::still();
    let mut late = 0;
    for field in 0..FIELDS {
        let bound = if field < 12 { f64::NEG_INFINITY } else { -1.0 };
        for number in [f64::NAN, f64::INFINITY, bound] {
            // From the start on, and from the time when the cast is halfway.
            for from in [0.0, 1.0] {
                let way = towards(4.0, 1.0);
                let broken = Broken {
                    way,
                    field,
                    number,
                    from,
                };
                let what = format!("field {field} is {number} from {from}");
                bodies.each(|kind, pair| {
                    let found = cast(pair, &still, &broken, 0.0..8.0, FINE).expect("a cast");
                    let Impact::Incomplete { safe } = found.impact else {
                        panic!("{kind}, {what}: {found:?}")
                    };
                    assert!(
                        if from == 0.0 { safe == 0.0 } else { safe < 3.0 },
                        "{kind}, {what}: {safe}"
                    );
                    late += u32::from(safe > 1.0);
                    let found = cast(pair, &broken, &still, 0.0..8.0, FINE).expect("a cast");
                    assert!(
                        matches!(found.impact, Impact::Incomplete { .. }),
                        "{kind}, {what}: {found:?}"
                    );
                    if from == 0.0 {
                        let free = free_until(pair, &still, &broken, 0.0..8.0, 0.1).expect("an answer");
                        assert_eq!(free.until, 0.0, "{kind}, {what}: {free:?}");
                        let held = overlapping_until(pair, &still, &broken, 0.0..8.0, 0.1).expect("an answer");
                        assert_eq!(held, 0.0, "{kind}, {what}");
                    }
                });
                // Bodies that meet at the start do so for any later model.
                let broken = Broken {
                    way: towards(0.5, 1.0),
                    field,
                    number,
                    from,
                };
                bodies.each(|kind, pair| {
                    let found = cast(pair, &still, &broken, 0.0..8.0, FINE).expect("a cast");
                    assert!(
                        matches!(found.impact, Impact::AtStart { .. }),
                        "{kind}, {what}: {found:?}"
                    );
                });
            }
        }
    }
    assert!(late > 100, "{late}");
}

/// Velocities and bounds so large that their squares are infinite.
#[test]
fn a_course_beyond_all_squares_ends() {
    let bodies = Bodies::new(1.0);
    for number in [1e120, 1e170, 1e300] {
        for field in 3..FIELDS {
            let broken = Broken {
                way: towards(4.0, 1.0),
                field,
                number,
                from: 0.0,
            };
            bodies.each(|kind, pair| {
                let found = cast(pair, &Fall::still(), &broken, 1.0..8.0, FINE).expect("a cast");
                let Cast { impact, .. } = found;
                // The poses meet at 3, and the model allows these poses unless it states other
                // velocities.
                let is_late = field >= 12 && matches!(impact, Impact::Miss);
                assert!(!is_late, "{kind}, field {field} is {number}: {found:?}");
            });
        }
    }
}

/// A motion whose pose is invalid from a time on.
struct Lost(Fall);

impl Motion for Lost {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let mut pose = self.0.pose(time);
        if time > 0.0 {
            pose.translation.vector.y = f64::NAN;
        }
        pose
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        self.0.model(time, span)
    }
}

#[test]
fn a_pose_that_is_none_is_an_error() {
    Bodies::new(1.0).each(|kind, pair| {
        let found = cast(pair, &Fall::still(), &Lost(towards(4.0, 1.0)), 0.0..8.0, FINE);
        assert!(matches!(found, Err(ImpactError::Pose(_))), "{kind}: {found:?}");
    });
}

/// At an instant, a cast asks whether the bodies are within the distance: it agrees with the
/// measurement, and a tie counts as met.
#[test]
fn an_interval_without_length_is_an_instant() {
    let bodies = Bodies::new(1.0);
    let mut rng = Rng::new(1921);
    let (mut starts, mut misses) = (0, 0);
    for k in 0..60 {
        let gap = if k % 2 == 0 { 0.25 } else { rng.log_range(1e-6, 2.0) };
        // Both gaps along x are known: bodies end at one half.
        let (x, time) = (1.0 + gap, [0.0, 0.7, -3.0][k % 3]);
        let factor = [1.0, 1.0 + 1e-9, 1.0 - 1e-6, 2.0, 0.5, 0.0][k % 6];
        let distance = gap * factor;
        let (a, b) = (towards(0.0, 1.0), towards(x, 1.0));
        bodies.each(|kind, pair| {
            let found = cast_within(pair, &a, &b, time..time, FINE, distance).expect("a cast");
            let relative = RelativePose::new(&a.pose(time), &b.pose(time)).expect("a pose");
            let seen = pair.measure(&relative);
            match found.impact {
                Impact::AtStart { .. } => {
                    assert!(seen.lower <= distance, "{kind} {k}: {found:?} {seen:?}");
                    starts += 1;
                }
                Impact::Miss => {
                    assert!(distance < seen.lower, "{kind} {k}: {found:?} {seen:?}");
                    assert!(distance < gap, "{kind} {k}: {found:?} {seen:?}");
                    misses += 1;
                }
                Impact::Undecided { safe, .. } => {
                    assert!(safe == time && seen.upper > distance, "{kind} {k}: {found:?} {seen:?}");
                    assert!((distance - gap).abs() < 1e-5, "{kind} {k}: {found:?} {seen:?}");
                }
                other => panic!("{kind} {k}: {other:?}"),
            }
            if kind == "polyhedra" && factor == 1.0 && k % 6 == 0 {
                assert!(
                    matches!(found.impact, Impact::AtStart { .. }),
                    "a tie is met: {found:?}"
                );
            }
        });
    }
    assert!(starts > 120 && misses > 120, "{starts} {misses}");
}

/// Returns a number of a motion: half of them ordinary, the others from the whole range.
fn number(rng: &mut Rng) -> f64 {
    let extremes = [
        0.0, 5e-324, 1e-300, 1e-150, 1e-100, 1e-30, 1e-12, 1e-6, 1e3, 1e6, 1e15, 1e30, 1e100, 1e150, 1e300,
    ];
    let sign = if rng.chance(0.25) { -1.0 } else { 1.0 };
    let ordinary = rng.range(0.1, 4.0);
    let k = rng.below(2 * extremes.len());
    sign * extremes.get(k).copied().unwrap_or(ordinary)
}

fn vector(rng: &mut Rng) -> Vector3<f64> {
    match rng.below(4) {
        0 => Vector3::new(number(rng), number(rng), number(rng)),
        1 => Vector3::zeros(),
        2 => Vector3::x() * -number(rng),
        _ => Vector3::from(rng.unit()) * number(rng),
    }
}

/// Returns a motion with any numbers: one of the crate's motions or a user-defined one.
fn wild(rng: &mut Rng, at: Vector3<f64>) -> Box<dyn Motion> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.in_ball()));
    let start = Isometry3::from_parts(at.into(), turn);
    let (linear, angular) = (vector(rng), vector(rng));
    let gravity = if rng.chance(0.5) { vector(rng) } else { Vector3::zeros() };
    let pivot = if rng.chance(0.3) {
        Point3::from(vector(rng))
    } else {
        Point3::origin()
    };
    let steady = Steady::about(&start, pivot, Velocity::new(linear, angular));
    if let (Ok(steady), true) = (steady, rng.chance(0.7)) {
        let most = number(rng).abs();
        let other = match rng.below(3) {
            0 => steady.with_acceleration(gravity),
            1 => steady.with_acceleration_bounds(most, number(rng).abs()),
            _ => Ok(steady),
        };
        return Box::new(other.unwrap_or(steady));
    }
    Box::new(Fall {
        start,
        linear,
        angular,
        gravity,
        is_named: rng.chance(0.5),
    })
}

/// Limit of the steps of a cast, and of the predicates in one round of a step.
const LOOKS: u32 = 20_000;
const DOUBLINGS: u32 = 6;

/// Numbers from the whole range, for every kind of pair: a cast ends within its step limit, with an
/// ordinary bracket.
#[test]
fn casts_end_at_any_numbers() {
    let mut rng = Rng::new(1924);
    let mut answers = [0; 6];
    for case in 0..100 {
        let size = if rng.below(4) == 0 {
            rng.log_range(1e-90, 1e59)
        } else {
            1.0
        };
        let bodies = Bodies::new(size);
        let other = if rng.chance(0.3) {
            vector(&mut rng)
        } else {
            Vector3::from(rng.unit()) * rng.range(1.0, 4.0) * size
        };
        let (a, mut b) = (wild(&mut rng, Vector3::zeros()), wild(&mut rng, other));
        if case % 3 == 0 {
            b = Box::new(towards(rng.range(1.1, 3.0) * size, rng.range(1.0, 4.0) * size));
        }
        let from = if rng.chance(0.5) { 0.0 } else { number(&mut rng) };
        let until = from + number(&mut rng).abs();
        let width = number(&mut rng).abs();
        let tolerance = if rng.chance(0.5) {
            Tolerance::Distance(width)
        } else {
            Tolerance::Time(width)
        };
        let keep = if rng.chance(0.7) { 0.0 } else { number(&mut rng).abs() };
        bodies.each(|kind, pair| {
            let found = cast_within(pair, &*a, &*b, from..until, tolerance, keep);
            let what = format!("{kind} {case}: {found:?}");
            let Ok(Cast {
                impact,
                queries,
                proofs,
                ..
            }) = found
            else {
                answers[0] += 1;
                return;
            };
            assert!(queries <= LOOKS && proofs <= LOOKS * DOUBLINGS, "{what}");
            let inside = |time: f64| (from..=until).contains(&time);
            answers[match impact {
                Impact::AtStart { .. } => 1,
                Impact::Hit { safe, hit, .. } => {
                    assert!(inside(safe) && inside(hit) && safe < hit, "{what}");
                    2
                }
                Impact::Undecided { safe, .. } => {
                    assert!(inside(safe), "{what}");
                    3
                }
                Impact::Miss => 4,
                Impact::Incomplete { safe } => {
                    assert!(inside(safe), "{what}");
                    5
                }
                other => panic!("{other:?}"),
            }] += 1;
        });
    }
    assert!(answers.iter().all(|&n| n > 3), "{answers:?}");
}

/// A pair alternately near and far, whose contact is never proven, and which is free for `span`.
struct Stubborn {
    is_near: bool,
    span: f64,
}

impl Separation for Stubborn {
    fn ball(&self, _: Operand) -> (Point3<f64>, f64) {
        (Point3::origin(), 1.0)
    }

    fn measure(&mut self, _: &RelativePose) -> Measurement {
        self.is_near = !self.is_near;
        let gap = if self.is_near { 1e-10 } else { 1e305 };
        Measurement {
            state: ContactState::Separated,
            distance: gap,
            lower: gap,
            upper: gap,
            features: None,
            subshapes: [0; 2],
            point_on_a: Point3::origin(),
            point_on_b: Point3::origin(),
            normal: Vector3::x_axis(),
            tangent: Tangent::Free,
            by_plane: false,
        }
    }

    fn meets(&mut self, _: &RelativePose, _: f64, _: &Measurement) -> bool {
        false
    }

    fn free_for(&mut self, _: &Measurement, _: &PairMotion) -> FreeSpan {
        FreeSpan {
            span: self.span,
            proof: Proof::Own,
        }
    }
}

/// Each step tests for an overlap at about two hundred tolerances without success: all of these
/// tests count towards the limit.
#[test]
fn rounds_of_a_look_count_as_looks() {
    let mut pair = Stubborn {
        is_near: false,
        span: 1e-6,
    };
    let huge = Tolerance::Distance(1e300);
    let found = cast(&mut pair, &Fall::still(), &towards(1.0, 1e-3), 0.0..1.0, huge).expect("a cast");
    assert!(
        matches!(found.impact, Impact::Incomplete { safe } if safe > 0.0),
        "{found:?}"
    );
    assert!(found.proofs > LOOKS / 2 && found.proofs <= LOOKS, "{found:?}");
}

/// From the time 1, a span of one unit in the last place ends at 1, rounded down: no progress.
#[test]
fn a_step_shorter_than_rounding_ends_the_cast() {
    let mut pair = Stubborn {
        is_near: false,
        span: f64::EPSILON,
    };
    let fine = Tolerance::Distance(1e-12);
    let found = cast(&mut pair, &Fall::still(), &towards(1.0, 1e-3), 1.0..2.0, fine).expect("a cast");
    assert!(matches!(found.impact, Impact::Undecided { safe: 1.0, .. }), "{found:?}");
    assert_eq!(found.queries, 1);
}

/// A motion that is at rest according to its models, but jumps from a time on.
struct Liar(Fall, f64);

impl Motion for Liar {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let mut pose = self.0.pose(0.0);
        if time >= self.1 {
            pose.translation.vector = Vector3::zeros();
        }
        pose
    }

    fn model(&self, _: f64, _: f64) -> MotionModel {
        self.0.model(0.0, 0.0)
    }
}

/// A motion that breaks its contract, so that bodies proven separated meet, gets a named result.
#[test]
fn a_motion_that_breaks_its_contract_ends_by_name() {
    let bodies = Bodies::new(1.0);
    let mut near = 0;
    for (speed, jump) in [(1.0, 1e-9), (1.0, 0.5), (1.0, 1.5), (0.3, 5.0), (1.0, 2.9)] {
        for distance in [0.0, 0.1] {
            let liar = Liar(towards(4.0, speed), jump);
            bodies.each(|kind, pair| {
                let found = cast_within(pair, &Fall::still(), &liar, 0.0..8.0, FINE, distance).expect("a cast");
                match found.impact {
                    Impact::Undecided { safe, distance: upper } => {
                        assert!(safe > 0.0 && upper <= distance + 1e-9, "{kind}, {jump}: {found:?}");
                        near += 1;
                    }
                    Impact::Hit { .. } | Impact::Miss | Impact::Incomplete { .. } => {}
                    other => panic!("{kind}, {jump}: {other:?}"),
                }
            });
        }
    }
    assert!(near > 20, "{near}");
}
