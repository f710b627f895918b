//! Hard scenes: spinning rods next to walls, bullets, bodies that rotate as one, gears, grazing
//! motions, contact at the ends.

use super::judge::{Judge, Tally};
use super::radius;
use lin_canny::Tracker;
use lin_canny::Velocity;
use lin_canny::impact::{Impact, ImpactError, Tolerance, cast, cast_within};
use lin_canny::motion::{Motion, Nlerp, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use truth::casts::{Throw, aimed, body, rotation, solid};
use truth::rng::Rng;
use truth::shapes;

const FINE: Tolerance = Tolerance::Distance(1e-10);

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

fn rest() -> Velocity {
    Velocity::default()
}

/// A rod spins next to a wall, with closest points at rest at the start: the time of impact is
/// known.
#[test]
fn a_rod_spins_into_a_wall() {
    let rod = solid(&shapes::cuboid([1.0, 1e-3, 1e-3]).points);
    let wall = solid(&shapes::cuboid([0.5, 4.0, 4.0]).points);
    let mut rng = Rng::new(1909);
    let mut tally = Tally::default();
    for k in 0..400 {
        let gap = rng.log_range(1e-4, 0.7);
        let drift = Vector3::from(rng.in_ball()) * f64::from(u8::from(k % 2 == 0));
        // Along y, at x = gap before the wall. It rotates about z by one radian per unit of time,
        // and a corner of its end reaches the wall.
        let start = Isometry3::from_parts(
            Vector3::new(-0.5 - 1e-3 - gap, 0.0, 0.0).into(),
            UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2),
        );
        let spin = if k % 3 == 0 { 1.0 } else { -1.0 };
        let throw = Throw {
            start: [at(0.0, 0.0, 0.0), start],
            velocity: [
                Velocity::new(drift, Vector3::zeros()),
                Velocity::new(drift, Vector3::z() * spin),
            ],
        };
        let (throw, pair) = if k % 5 == 0 {
            (throw.swapped(), [&rod, &wall])
        } else {
            (throw, [&wall, &rod])
        };
        let cast = Judge::new(pair, throw, format!("rod {k}")).cast(FINE, 100, 1.0, &mut tally);
        let reach = 1e-3 + gap;
        // sin t + 1e-3 cos t = reach
        let expected = (reach / (1.0f64 + 1e-6).sqrt()).asin() - 1e-3f64.atan();
        match cast.impact {
            Impact::Hit { safe, hit, .. } => assert!(
                safe <= expected + 1e-14 && expected - 1e-14 <= hit && hit - safe < 1e-8,
                "{gap}: {safe} {expected} {hit}"
            ),
            other => panic!("{gap} {expected}: {other:?}"),
        }
    }
    assert_eq!(tally.hits, 400);
    assert!(tally.medians()[0] <= 4, "{:?}", tally.medians());
}

/// A 1 cm body flies at a 2 mm plate at 100 to 1,000 m/s.
#[test]
fn bullets_do_not_pass_through_plates() {
    let mut rng = Rng::new(1910);
    let mut tally = Tally::default();
    let plate = solid(&shapes::cuboid([1e-3, 0.5, 0.5]).points);
    for k in 0..300 {
        let bullet = solid(
            &shapes::sphere(&mut rng, 16)
                .points
                .iter()
                .map(|p| p.map(|x| 0.005 * x))
                .collect::<Vec<_>>(),
        );
        let speed = rng.range(100.0, 1000.0);
        let spin = Vector3::from(rng.unit()) * rng.range(0.0, 500.0);
        let start = Isometry3::from_parts(Vector3::new(-20.0, 0.1, -0.2).into(), rotation(&mut rng));
        let throw = Throw {
            start: [start, at(0.0, 0.0, 0.0)],
            velocity: [Velocity::new(Vector3::x() * speed, spin), rest()],
        };
        Judge::new([&bullet, &plate], throw, format!("bullet {k}")).cast(FINE, 20, 1.0, &mut tally);
    }
    assert_eq!(tally.hits, 300, "{tally:?}");
    assert!(tally.medians()[0] <= 5, "{:?}", tally.medians());
}

/// A rotates in place, and B moves with it as one rigid body: they never approach. Also bodies that
/// move alike, or apart.
#[test]
fn bodies_carried_along_never_meet() {
    let mut rng = Rng::new(1911);
    let mut tally = Tally::default();
    for k in 0..200 {
        let (a, b) = (body("box", 8, &mut rng), body("sphere", 16, &mut rng));
        let spin = Vector3::z() * rng.range(0.5, 6.0);
        // As one rigid body: B rotates about A's origin.
        let start = [at(0.0, 0.0, 0.0), at(1.7, 0.0, 0.0)];
        let ma = Steady::new(&start[0], Velocity::new(Vector3::zeros(), spin)).expect("a motion");
        let mb = Steady::about(
            &start[1],
            Point3::new(-1.7, 0.0, 0.0),
            Velocity::new(Vector3::zeros(), spin),
        )
        .expect("a motion");
        let mut tracker = Tracker::new();
        let mut pair = tracker.pair(&a, &b);
        let found = cast(&mut pair, &ma, &mb, 0.0..1.0, FINE).expect("a cast");
        let throw = Throw {
            start,
            velocity: [rest(), rest()],
        };
        if Judge::new([&a, &b], throw, String::new()).meets(&mut lin_canny::Tracker::new(), 0.0) {
            continue;
        }
        assert!(found.impact == Impact::Miss, "carried {k}: {found:?}");
        assert!(found.queries <= 3, "carried {k}: {found:?}");
        let alike = Velocity::new(Vector3::from(rng.in_ball()) * 50.0, Vector3::zeros());
        let away = Velocity::new(alike.linear + Vector3::x(), Vector3::zeros());
        for velocity in [[alike, alike], [alike, away]] {
            let throw = Throw { start, velocity };
            let cast = Judge::new([&a, &b], throw, format!("alike {k}")).cast(FINE, 10, 1.0, &mut tally);
            assert!(cast.impact == Impact::Miss && cast.queries <= 1, "{cast:?}");
        }
    }
    assert!(tally.misses > 300, "{tally:?}");
}

/// Two gears rotate by fifty to a hundred radians, with teeth that nearly or just meet.
#[test]
fn gears_turn_a_hair_apart() {
    let gear = solid(&shapes::prism(12, 1.0, 0.2).points);
    let mut rng = Rng::new(1912);
    let mut tally = Tally::default();
    for k in 0..60 {
        // At the start a tooth of A faces a gap of B. Two facing teeth need a distance of 2, a
        // tooth and a gap about 0.04 less.
        let apart = 2.001 - rng.range(0.0, 0.03);
        let gap = UnitQuaternion::from_scaled_axis(Vector3::z() * (std::f64::consts::PI / 12.0));
        let rates = [rng.range(50.0, 100.0), rng.range(50.0, 100.0)];
        let throw = Throw {
            start: [at(0.0, 0.0, 0.0), at(apart, 0.0, 0.0) * gap],
            velocity: rates.map(|r| Velocity::new(Vector3::zeros(), Vector3::z() * r)),
        };
        Judge::new([&gear, &gear], throw, format!("gears {k}")).cast(FINE, 2000, 100.0, &mut tally);
    }
    assert!(tally.hits > 10, "{tally:?}");
    assert!(tally.misses > 0, "{tally:?}");
    assert!(tally.near + tally.unknown == 0, "{tally:?}");
}

/// Bisection between a hit and a miss: the grazing motion, to the last bits.
#[test]
fn grazing_motions_are_hits_misses_or_near() {
    let mut rng = Rng::new(1913);
    let mut tally = Tally::default();
    for k in 0..60 {
        let a = body(["sphere", "box", "rods"][k % 3], 8, &mut rng);
        let b = body("sphere", 8, &mut rng);
        let throw = aimed(&mut rng, (radius(&a), radius(&b)), 1.0);
        let shifted = |aside: f64| {
            let mut t = throw;
            let way = t.velocity[1].linear - t.velocity[0].linear;
            let across = way.cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
            t.start[1].translation.vector += across * aside;
            t
        };
        let (mut hit, mut miss) = (0.0, 6.0);
        let is_hit = |aside: f64, tally: &mut Tally| {
            let judge = Judge::new([&a, &b], shifted(aside), format!("grazing {k} {aside}"));
            matches!(judge.cast(FINE, 40, 1.0, tally).impact, Impact::Hit { .. })
        };
        if !is_hit(hit, &mut tally) {
            continue;
        }
        for _ in 0..44 {
            let middle = 0.5 * (hit + miss);
            if is_hit(middle, &mut tally) {
                hit = middle
            } else {
                miss = middle
            }
        }
    }
    eprintln!("{tally:?}");
    assert!(
        tally.hits > 400 && tally.misses > 400 && tally.near < 200,
        "{} {} {}",
        tally.hits,
        tally.misses,
        tally.near
    );
    assert_eq!(tally.unknown, 0);
}

/// Contact exactly at the start or the end of the interval is contact.
#[test]
fn contact_at_the_ends_is_contact() {
    let cube = solid(&shapes::cuboid([1.0, 1.0, 1.0]).points);
    let throw = |x: f64, v: f64| Throw {
        start: [at(0.0, 0.0, 0.0), at(x, 0.25, 0.5)],
        velocity: [rest(), Velocity::new(Vector3::x() * v, Vector3::zeros())],
    };
    let ask = |x: f64, v: f64| {
        let [a, b] = throw(x, v).motions();
        cast(&mut Tracker::new().pair(&cube, &cube), &a, &b, 0.0..1.0, FINE)
            .expect("a cast")
            .impact
    };
    assert!(matches!(ask(2.0, 1.0), Impact::AtStart { .. }));
    assert!(matches!(ask(1.5, 1.0), Impact::AtStart { .. }));
    assert!(matches!(ask(3.0, -1.0), Impact::Hit { hit: 1.0, safe, .. } if safe < 1.0 && safe > 1.0 - 1e-9));
    assert_eq!(ask(3.0f64.next_up().next_up(), -1.0 + 1e-9), Impact::Miss);
    assert_eq!(ask(2.0 + 1e-9, 1.0), Impact::Miss);
    assert_eq!(ask(2.0 + 1e-12, 0.0), Impact::Miss);
    assert!(matches!(ask(2.5, -1.0), Impact::Hit { safe, hit, .. } if safe < 0.5 && 0.5 <= hit && hit - safe < 2e-10));
}

/// Tolerances down to 1e-12 of the interval, as lengths and as times.
#[test]
fn brackets_are_as_narrow_as_asked() {
    let mut rng = Rng::new(1914);
    for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
        let (mut widths, mut late) = (vec![], 0);
        for _ in 0..400 {
            let (a, b) = (body("sphere", 16, &mut rng), body("flat", 16, &mut rng));
            let throw = aimed(&mut rng, (1.0, 1.0), 1.0);
            let [ma, mb] = throw.motions();
            let mut tracker = Tracker::new();
            let mut pair = tracker.pair(&a, &b);
            let by_time = cast(&mut pair, &ma, &mb, 0.0..1.0, Tolerance::Time(tolerance)).expect("a cast");
            let Impact::Hit { safe, hit, .. } = by_time.impact else {
                continue;
            };
            widths.push(hit - safe);
            late += u32::from(hit - safe > tolerance);
        }
        widths.sort_by(f64::total_cmp);
        let n = widths.len();
        eprintln!(
            "{tolerance:e}: median {:e} p99 {:e} of {n}, {late} wider",
            widths[n / 2],
            widths[n * 99 / 100]
        );
        assert!(n > 100 && late <= 2 + n as u32 / 50 && widths[n / 2] < tolerance);
    }
}

/// A cast to a distance equals the cast of a body grown by the distance.
#[test]
fn within_a_distance() {
    let cube = solid(&shapes::cuboid([1.0, 1.0, 1.0]).points);
    let a = Steady::new(&at(0.0, 0.0, 0.0), rest()).expect("a motion");
    let b = Steady::new(
        &at(5.0, 0.3, 0.2),
        Velocity::new(Vector3::x() * -2.0, Vector3::x() * 0.4),
    )
    .expect("a motion");
    for (distance, expected) in [(0.5, 1.25), (1.0, 1.0), (0.0, 1.5)] {
        let mut tracker = Tracker::new();
        let mut pair = tracker.pair(&cube, &cube);
        let found = cast_within(&mut pair, &a, &b, 0.0..2.0, FINE, distance).expect("a cast");
        let Impact::Hit { safe, hit, .. } = found.impact else {
            panic!("{found:?}")
        };
        assert!(safe <= expected, "{safe} {expected} {hit}");
        assert!(expected <= hit + 1e-15, "{safe} {expected} {hit}");
        assert!(hit - safe < 1e-9, "{safe} {expected} {hit}");
    }
    let mut tracker = Tracker::new();
    let mut pair = tracker.pair(&cube, &cube);
    let found = cast_within(&mut pair, &a, &b, 0.0..1.0, FINE, 0.9).expect("a cast");
    assert_eq!(found.impact, Impact::Miss);
    let found = cast_within(&mut pair, &a, &b, 0.0..1.0, FINE, 3.1).expect("a cast");
    assert!(matches!(found.impact, Impact::AtStart { .. }));
}

/// Sweeps by nlerp between two poses, as time-stepping simulators use them, against dense
/// predicates.
#[test]
fn sweeps_between_poses() {
    let mut rng = Rng::new(1915);
    let (mut hits, mut misses) = (0, 0);
    for k in 0..1500 {
        let (a, b) = (body("rods", 12, &mut rng), body("box", 8, &mut rng));
        let throw = aimed(&mut rng, (1.0, 0.9), 3.0);
        let ends = [0, 1].map(|k| throw.velocity[k].applied(&throw.start[k], 1.0));
        let [ma, mb] = [0, 1].map(|k| Nlerp::new(&throw.start[k], &ends[k], 1.0, Point3::origin()).expect("a motion"));
        let found = cast(&mut Tracker::new().pair(&a, &b), &ma, &mb, 0.0..1.0, FINE).expect("a cast");
        let mut tracker = lin_canny::Tracker::new();
        let mut meets = |t: f64| {
            let relative = lin_canny::RelativePose::new(&ma.pose(t), &mb.pose(t)).expect("a pose");
            tracker.intersects(&a, &b, &relative)
        };
        let safe = match found.impact {
            Impact::Hit { safe, hit, .. } => {
                hits += 1;
                assert!(meets(hit));
                safe
            }
            Impact::Miss => {
                misses += 1;
                1.0
            }
            Impact::AtStart { .. } => continue,
            other => panic!("{k}: {other:?}"),
        };
        assert!((0..=200).all(|k| !meets(safe * f64::from(k) / 200.0)), "{k}: {found:?}");
    }
    assert!(hits > 300 && misses > 300, "{hits} {misses}");
}

#[test]
fn what_is_no_question_is_refused() {
    let cube = solid(&shapes::cuboid([1.0, 1.0, 1.0]).points);
    let a = Steady::new(&at(0.0, 0.0, 0.0), rest()).expect("a motion");
    let mut tracker = Tracker::new();
    let mut pair = tracker.pair(&cube, &cube);
    for (from, until) in [(1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        assert!(matches!(
            cast(&mut pair, &a, &a, from..until, FINE),
            Err(ImpactError::Interval { .. })
        ));
    }
    let bad = Tolerance::Time(-1.0);
    assert!(matches!(
        cast(&mut pair, &a, &a, 0.0..1.0, bad),
        Err(ImpactError::Size { .. })
    ));
    assert!(cast_within(&mut pair, &a, &a, 0.0..1.0, FINE, f64::NAN).is_err());
    let found = cast(&mut pair, &a, &a, 0.5..0.5, FINE).expect("a cast");
    assert!(matches!(found.impact, Impact::AtStart { .. }));
}
