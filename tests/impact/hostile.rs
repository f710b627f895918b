//! Motions that are no motions, and intervals of no length: nothing is proven by them, and every cast ends.

use super::pairs::{Bodies, Fall};
use lab::rng::Rng;
use lin_canny::RelativePose;
use lin_canny::impact::{Cast, Impact, ImpactError, Tolerance, cast, cast_within, free_until, held_until};
use lin_canny::motion::{Course, Motion};
use lin_canny::nalgebra::{Isometry3, Vector3};

const FINE: Tolerance = Tolerance::Distance(1e-6);

/// A motion whose course has a number that is none, from a time on.
struct Broken {
    way: Fall,
    field: usize,
    number: f64,
    from: f64,
}

/// Numbers of a course.
const FIELDS: usize = 20;

impl Motion for Broken {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        self.way.pose(time)
    }

    fn course(&self, time: f64, span: f64) -> Course {
        let mut course = self.way.course(time, span);
        if time >= self.from {
            let vectors = [
                &mut course.pivot.coords,
                &mut course.linear,
                &mut course.angular,
                &mut course.acceleration,
            ];
            let bounds = [&mut course.shift.0, &mut course.turn.0];
            let mut numbers = vectors
                .into_iter()
                .flat_map(|v| v.iter_mut())
                .chain(bounds.into_iter().flatten());
            *numbers.nth(self.field).expect("a field") = self.number;
        }
        course
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
            // From the begin on; and once the cast has come half way.
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
                    let found = cast(pair, &still, &broken, (0.0, 8.0), FINE).expect("a cast");
                    let Impact::Unknown { safe } = found.impact else {
                        panic!("{kind}, {what}: {found:?}")
                    };
                    assert!(
                        if from == 0.0 { safe == 0.0 } else { safe < 3.0 },
                        "{kind}, {what}: {safe}"
                    );
                    late += u32::from(safe > 1.0);
                    let found = cast(pair, &broken, &still, (0.0, 8.0), FINE).expect("a cast");
                    assert!(
                        matches!(found.impact, Impact::Unknown { .. }),
                        "{kind}, {what}: {found:?}"
                    );
                    if from == 0.0 {
                        let free = free_until(pair, &still, &broken, (0.0, 8.0), 0.1).expect("an answer");
                        assert_eq!(free.until, 0.0, "{kind}, {what}: {free:?}");
                        let held = held_until(pair, &still, &broken, (0.0, 8.0), 0.1).expect("an answer");
                        assert_eq!(held, 0.0, "{kind}, {what}");
                    }
                });
                // Bodies that meet at the begin do so whatever comes later.
                let broken = Broken {
                    way: towards(0.5, 1.0),
                    field,
                    number,
                    from,
                };
                bodies.each(|kind, pair| {
                    let found = cast(pair, &still, &broken, (0.0, 8.0), FINE).expect("a cast");
                    assert!(
                        matches!(found.impact, Impact::Start { .. }),
                        "{kind}, {what}: {found:?}"
                    );
                });
            }
        }
    }
    assert!(late > 100, "{late}");
}

/// Velocities and bounds so large that squares of them are infinite.
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
                let found = cast(pair, &Fall::still(), &broken, (1.0, 8.0), FINE).expect("a cast");
                let Cast { impact, .. } = found;
                // The poses meet at 3, and the course allows for these poses unless it names other velocities.
                let is_late = field >= 12 && matches!(impact, Impact::Miss);
                assert!(!is_late, "{kind}, field {field} is {number}: {found:?}");
            });
        }
    }
}

/// A pose that is none, from a time on.
struct Lost(Fall);

impl Motion for Lost {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let mut pose = self.0.pose(time);
        if time > 0.0 {
            pose.translation.vector.y = f64::NAN;
        }
        pose
    }

    fn course(&self, time: f64, span: f64) -> Course {
        self.0.course(time, span)
    }
}

#[test]
fn a_pose_that_is_none_is_an_error() {
    Bodies::new(1.0).each(|kind, pair| {
        let found = cast(pair, &Fall::still(), &Lost(towards(4.0, 1.0)), (0.0, 8.0), FINE);
        assert!(matches!(found, Err(ImpactError::Pose(_))), "{kind}: {found:?}");
    });
}

/// At an instant a cast is the question whether the bodies are within the distance: the same answer as the measure, and a
/// tie is met.
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
            let found = cast_within(pair, &a, &b, (time, time), FINE, distance).expect("a cast");
            let relative = RelativePose::new(&a.pose(time), &b.pose(time)).expect("a pose");
            let seen = pair.measure(&relative);
            match found.impact {
                Impact::Start { .. } => {
                    assert!(seen.lower <= distance, "{kind} {k}: {found:?} {seen:?}");
                    starts += 1;
                }
                Impact::Miss => {
                    assert!(
                        distance < seen.lower && distance < gap,
                        "{kind} {k}: {found:?} {seen:?}"
                    );
                    misses += 1;
                }
                Impact::Near { safe, .. } => {
                    assert!(safe == time && seen.upper > distance, "{kind} {k}: {found:?} {seen:?}");
                    assert!((distance - gap).abs() < 1e-5, "{kind} {k}: {found:?} {seen:?}");
                }
                other => panic!("{kind} {k}: {other:?}"),
            }
            if kind == "polyhedra" && factor == 1.0 && k % 6 == 0 {
                assert!(matches!(found.impact, Impact::Start { .. }), "a tie is met: {found:?}");
            }
        });
    }
    assert!(starts > 120 && misses > 120, "{starts} {misses}");
}
