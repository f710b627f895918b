//! Casts: judged by the distances of the dispatcher at many instants.

use truth::rng::Rng;

use super::dispatch::{CONVEX, kinds, random_pose};
use super::engine::CertifiedDispatcher;
use super::engine::parry::math::{Pose, Real, Vector};
use super::engine::parry::query::details::ShapeCastOptions;
use super::engine::parry::query::{NonlinearRigidMotion, QueryDispatcher, ShapeCastHit, ShapeCastStatus};
use super::engine::parry::shape::{Ball, Cuboid, Shape};

/// Instants at which the distance of a cast is looked at.
const INSTANTS: u32 = 64;

/// Distances below this part of the size count as contact: poses are placed in the engine's numbers.
const CLOSE: Real = 2e-5;

fn vector(rng: &mut Rng, length: f64) -> Vector {
    Vector::from(rng.unit().map(|c| (length * c) as Real))
}

/// How many casts ended how.
#[derive(Default, Debug)]
struct Seen {
    hits: u32,
    misses: u32,
    starts: u32,
}

/// Judges a cast from `start` until `end` by the distance as a function of the time.
fn judge(
    found: Option<&ShapeCastHit>,
    (start, end): (Real, Real),
    (target, size): (Real, Real),
    kinds: (usize, usize),
    distance: impl Fn(Real) -> Real,
    seen: &mut Seen,
) {
    let close = CLOSE * size;
    let until = found.map_or(end, |hit| hit.time_of_impact);
    for k in 0..INSTANTS {
        let time = start + (until - start) * k as Real / INSTANTS as Real;
        let d = distance(time);
        let is_start = found.is_some_and(|hit| hit.time_of_impact == start);
        assert!(is_start || d > target - close, "met at {time} of {until} already: {d}");
    }
    match found {
        None => seen.misses += 1,
        Some(hit) => {
            assert!((start..=end).contains(&hit.time_of_impact), "{hit:?}");
            let d = distance(hit.time_of_impact);
            assert!(d < target + close, "{d} at the hit of {kinds:?}: {hit:?}");
            let is_start = hit.status == ShapeCastStatus::PenetratingOrWithinTargetDist;
            seen.starts += u32::from(is_start);
            seen.hits += u32::from(!is_start);
        }
    }
}

/// Casts without a turn: never late, never missed, in both orders; normals and witnesses agree with
/// the distance.
#[test]
fn linear_casts_stop_at_the_first_contact() {
    let mut rng = Rng::new(21);
    let (ours, mut seen) = (CertifiedDispatcher::default(), Seen::default());
    for round in 0..16 {
        let size: Real = [1.0, 1e-3][round % 2];
        let list = kinds(&mut rng, size);
        for (k, a) in list[..CONVEX].iter().enumerate() {
            for (l, b) in list[..CONVEX].iter().enumerate().skip(k) {
                let apart = f64::from(size) * rng.range(1.0, 4.0);
                let pos12 = random_pose(&mut rng, apart);
                let far = f64::from(size) * rng.range(0.0, 1.5);
                let aside = vector(&mut rng, far);
                let velocity = -pos12.translation + aside;
                let options = ShapeCastOptions {
                    max_time_of_impact: [2.0, Real::MAX][round / 2 % 2],
                    target_distance: [0.0, 0.1 * size][round / 4 % 2],
                    ..ShapeCastOptions::default()
                };
                let hit = ours
                    .cast_shapes(&pos12, velocity, &**a, &**b, options)
                    .expect("supported");
                let at = |time: Real| Pose::from_parts(pos12.translation + velocity * time, pos12.rotation);
                let distance = |time: Real| ours.distance(&at(time), &**a, &**b).expect("supported").distance;
                let end = options.max_time_of_impact.min(8.0);
                let sizes = (options.target_distance, size);
                judge(hit.as_ref(), (0.0, end), sizes, (k, l), distance, &mut seen);
                if let Some(hit) = &hit {
                    check_contact(hit, &at(hit.time_of_impact), options.target_distance, size);
                }
                let back = pos12.inverse();
                let turned = -(pos12.rotation.inverse() * velocity);
                let swapped = ours.cast_shapes(&back, turned, &**b, &**a, options).expect("supported");
                let times = [hit, swapped].map(|h| h.map(|h| h.time_of_impact));
                let is_same = match times {
                    [Some(s), Some(t)] => (s - t).abs() < 1e-3,
                    [s, t] => s.is_none() && t.is_none(),
                };
                // A graze may be a hit in one order and a miss in the other.
                let nearest = (0..=256)
                    .map(|i| distance(end * i as Real / 256.0))
                    .fold(Real::MAX, Real::min);
                let is_graze = (nearest - options.target_distance).abs() < 1e-2 * size;
                assert!(is_same || is_graze, "{times:?}");
            }
        }
    }
    assert!(seen.hits > 150 && seen.misses > 30 && seen.starts > 10, "{seen:?}");
}

fn check_contact(hit: &ShapeCastHit, pos12: &Pose, target: Real, size: Real) {
    if hit.status != ShapeCastStatus::Converged {
        return;
    }
    let apart = (pos12 * hit.witness2 - hit.witness1).dot(hit.normal1);
    assert!((apart - target).abs() < CLOSE * size, "{apart}: {hit:?}");
    let opposed = (hit.normal1 + pos12.rotation * hit.normal2).length();
    assert!(opposed < 1e-5, "{hit:?}");
}

/// Casts with turns about a centre, judged as above.
#[test]
fn turning_casts_stop_at_the_first_contact() {
    let mut rng = Rng::new(22);
    let (ours, mut seen) = (CertifiedDispatcher::default(), Seen::default());
    for round in 0..8 {
        let size: Real = [1.0, 1e-3][round % 2];
        let list = kinds(&mut rng, size);
        for (k, a) in list[..CONVEX].iter().enumerate() {
            for (l, b) in list[..CONVEX].iter().enumerate().skip(k) {
                let apart = f64::from(size) * rng.range(1.5, 4.0);
                let motion = |start: Pose, toward: Vector, rng: &mut Rng| {
                    let centre = vector(rng, 0.3 * f64::from(size));
                    let spin = vector(rng, 4.0);
                    NonlinearRigidMotion::new(start, centre, toward, spin)
                };
                let here = random_pose(&mut rng, 0.0);
                let there = random_pose(&mut rng, apart);
                let far = f64::from(size) * rng.range(0.0, 1.5);
                let aside = vector(&mut rng, far);
                let x = motion(here, Vector::ZERO, &mut rng);
                let y = motion(there, -there.translation + aside, &mut rng);
                let (start, end) = (0.25, 2.0);
                let hit = ours
                    .cast_shapes_nonlinear(&x, &**a, &y, &**b, start, end, true)
                    .expect("supported");
                let distance = |time: Real| {
                    let pos12 = x.position_at_time(time).inv_mul(&y.position_at_time(time));
                    ours.distance(&pos12, &**a, &**b).expect("supported").distance
                };
                judge(hit.as_ref(), (start, end), (0.0, size), (k, l), distance, &mut seen);
            }
        }
    }
    assert!(seen.hits > 80 && seen.misses > 30 && seen.starts > 5, "{seen:?}");
}

/// Two cubes of a millimetre: the time of impact is known in closed form, independent of parry.
#[test]
fn small_cubes_meet_in_time() {
    let cube = Cuboid::new(Vector::splat(5e-4));
    let pos12 = Pose::translation(0.01, 1e-4, 0.0);
    let options = ShapeCastOptions::default();
    let ours = CertifiedDispatcher::default();
    let hit = ours.cast_shapes(&pos12, Vector::X * -1.0, &cube, &cube, options);
    let time = hit.expect("supported").expect("a hit").time_of_impact;
    assert!((time - 9e-3).abs() < 1e-8 && time <= 9e-3, "{time}");
    let away = ours
        .cast_shapes(&pos12, Vector::X, &cube, &cube, options)
        .expect("supported");
    assert!(away.is_none());
    // Beyond the longest time asked for.
    let soon = ShapeCastOptions::with_max_time_of_impact(8.9e-3);
    assert!(
        ours.cast_shapes(&pos12, -Vector::X, &cube, &cube, soon)
            .expect("supported")
            .is_none()
    );
}

/// Shapes that overlap at the start: told, unless the cast asks for later contacts and the shapes
/// move apart.
#[test]
fn a_start_in_contact_is_told_by_its_direction() {
    let (ball, cube) = (Ball::new(0.5), Cuboid::new(Vector::splat(0.5)));
    let ours = CertifiedDispatcher::default();
    let pos12 = Pose::translation(0.9, 0.1, 0.2);
    for stop in [true, false] {
        let options = ShapeCastOptions {
            stop_at_penetration: stop,
            ..ShapeCastOptions::default()
        };
        let into = ours
            .cast_shapes(&pos12, -Vector::X, &cube, &ball, options)
            .expect("supported");
        let hit = into.expect("told");
        assert_eq!(hit.status, ShapeCastStatus::PenetratingOrWithinTargetDist);
        assert!(hit.time_of_impact == 0.0 && hit.normal1.x > 0.999, "{hit:?}");
        let out = ours
            .cast_shapes(&pos12, Vector::X, &cube, &ball, options)
            .expect("supported");
        assert_eq!(out.is_some(), stop);
    }
}

/// Compounds are cast part by part.
#[test]
fn compounds_are_cast_by_their_parts() {
    let mut rng = Rng::new(23);
    let scale: Real = 1e-3;
    let list = kinds(&mut rng, scale);
    let (hull, compound) = (&list[0], &list[9]);
    let ours = CertifiedDispatcher::default();
    let pos12 = Pose::translation(0.0, 10.0 * scale, 0.0);
    let options = ShapeCastOptions::default();
    let pairs: [(&dyn Shape, &dyn Shape); 3] = [
        (&**hull, &**compound),
        (&**compound, &**hull),
        (&**compound, &**compound),
    ];
    for (a, b) in pairs {
        let velocity = -Vector::Y * scale;
        let hit = ours
            .cast_shapes(&pos12, velocity, a, b, options)
            .expect("supported")
            .expect("a hit");
        let at = Pose::from_parts(pos12.translation + velocity * hit.time_of_impact, pos12.rotation);
        let d = ours.distance(&at, a, b).expect("supported").distance;
        assert!(d < CLOSE * scale, "{d}");
        let x = NonlinearRigidMotion::identity();
        let y = NonlinearRigidMotion::new(pos12, Vector::ZERO, velocity, Vector::ZERO);
        let turned = ours
            .cast_shapes_nonlinear(&x, a, &y, b, 0.0, 20.0, true)
            .expect("supported");
        let time = turned.expect("a hit").time_of_impact;
        assert!((time - hit.time_of_impact).abs() < 1e-4, "{time} {hit:?}");
    }
}
