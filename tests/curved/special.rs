//! Promise: the same holds at special poses: flush over an edge, near parallel axes, and for
//! superquadrics near the limits of their exponents.

use super::Mix;
use lin_canny::nalgebra::Vector3;
use lin_canny::{ContactState, Manifold, ManifoldOptions, Outcome, PairTracker, Shape};
use truth::curved::special::{about_parallel_axes, flush_over_edge, near_limits};
use truth::curved::{KINDS, Kind, Place};
use truth::rng::Rng;

/// Returns whether an outcome of flush shapes is the gap along the axis of the faces.
fn is_flush(o: &Outcome, side: f64, apart: f64, size: f64) -> bool {
    let near = |x: f64| (x - apart).abs() <= 1e-13 * size;
    let bounded = o.lower <= apart + 1e-15 * size && apart <= o.upper + 1e-15 * size;
    bounded && near(o.distance) && side * o.normal.z > 1.0 - 1e-9
}

/// A flat face flush on another with a small overlap: one signed distance with one normal for any
/// overlap, cold and lowered from above.
#[test]
fn a_face_flush_over_an_edge_is_a_gap_along_its_axis() {
    let (mut rng, mut sideways, mut told) = (Rng::new(2400), [0; 3], String::new());
    for _ in 0..super::count() * 10 {
        let ([a, b], place, side, apart) = flush_over_edge(&mut rng);
        let (x, y, size) = (a.shape(), b.shape(), place.size(&a, &b));
        let mut note = |way: usize, what: &Outcome| {
            sideways[way] += 1;
            if sideways[way] < 3 {
                told += &format!("{way} {a:?} {b:?} {place:?} apart {apart:e}\n{what:?}\n");
            }
        };
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        if !is_flush(&o, side, apart, size) {
            note(0, &o);
        }
        let (mut pair, mut last) = (PairTracker::new(), o);
        for lift in [0.1, 1e-2, 1e-4, 1e-7, 1e-11, 0.0] {
            let mut lifted = place;
            lifted.t[2] += side * lift;
            last = pair.closest(&x, &y, &lifted.pose());
        }
        if !is_flush(&last, side, apart, size) {
            note(1, &last);
        }
        let mut manifold = Manifold::new();
        pair.manifold(
            &x,
            &y,
            &place.pose(),
            &ManifoldOptions::with_prediction(1e-6),
            &mut manifold,
        )
        .unwrap();
        let upright = |n: Vector3<f64>| side * n.z > 1.0 - 1e-9;
        if manifold.points().is_empty() || !upright(*manifold.normal()) {
            note(2, &last);
        }
    }
    assert_eq!(sideways, [0; 3], "cold, warm, contacts\n{told}");
}

/// Returns a rotation by a multiple of a quarter turn about one axis, tilted slightly or not at
/// all.
fn quarter(rng: &mut Rng) -> [f64; 4] {
    let axis = *rng.pick(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let angle = *rng.pick(&[0.0, 0.5, 1.0]) * core::f64::consts::PI;
    let tilt = *rng.pick(&[0.0, 1e-14, 1e-9, 1e-4]);
    truth::pose::unit_quat(truth::pose::quat_mul(
        truth::pose::quat(rng.unit(), tilt),
        truth::pose::quat(axis, angle),
    ))
}

/// Returns the pose of B moved along the axis between the origins to a gap.
fn moved_to(a: &Shape, b: &Shape, mut place: Place, gap: f64) -> Place {
    for _ in 0..3 {
        let o = PairTracker::new().closest(a, b, &place.pose());
        place.t = (Vector3::from(place.t) - *o.normal * (o.distance - gap)).into();
    }
    place
}

/// Superquadrics that are nearly octahedra and boxes, close to contact: witnesses lie on the
/// shapes, and bounds are ordered.
#[test]
fn superquadrics_near_the_limits_are_bounded_close_to_contact() {
    let (mut rng, mut mix) = (Rng::new(2401), Mix::default());
    let cases = super::count() * 2;
    for k in 0..cases as usize {
        let a = near_limits(&mut rng);
        let b = match rng.below(4) {
            0 => near_limits(&mut rng),
            // A triangle, nearly flat against a tip.
            1 | 2 => Kind::Hull((0..3).map(|_| rng.in_ball()).map(|p| [p[0], p[1], 0.0]).collect()),
            _ => Kind::random(KINDS[k % 6], &mut rng, 3.0),
        };
        let mut along = [0.0; 3];
        along[rng.below(3)] = *rng.pick(&[-3.0, 3.0]);
        let (x, y) = (a.shape(), b.shape());
        let q = quarter(&mut rng);
        let gap = rng.log_range(1e-12, 1.0);
        let place = moved_to(&x, &y, Place { q, t: along }, gap);
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        let told = || format!("{a:?} {b:?} {place:?} {o:?}");
        for p in [o.point_on_a, o.point_on_b] {
            assert!(p.coords.iter().all(|x| x.is_finite()), "{}", told());
        }
        assert!(o.distance.is_finite() && o.upper.is_finite(), "{}", told());
        if o.state == ContactState::Separated {
            mix.judge(&a, &b, &place, &o);
        }
        let round = rng.range(0.1, 1.0);
        let p = PairTracker::new().closest(&x.rounded(round).expect("a radius"), &y, &place.pose());
        let slack = 1e-13 * (place.size(&a, &b) + round);
        let meets = p.lower <= o.upper - round + slack && o.lower - round <= p.upper + slack;
        assert!(meets, "rounded by {round}: {p:?}\n{}", told());
    }
    mix.print("superquadric", "near limits");
    assert!(mix.count() > cases * 9 / 10, "{mix:?}");
    assert!(mix.widest <= 2e-13, "{}", mix.widest);
}

/// Cylinders and cones about parallel axes: the depth is that of two polygons, as tight as for
/// separated bodies, though a whole circle of directions attains it.
#[test]
fn depths_about_parallel_axes_are_closed() {
    let (mut rng, mut told, mut bad, mut deep) = (Rng::new(2402), String::new(), 0, 0);
    for _ in 0..super::count() {
        let ([a, b], place) = about_parallel_axes(&mut rng);
        let (x, y, size) = (a.shape(), b.shape(), place.size(&a, &b));
        for (x, y, pose) in [(&x, &y, place.pose()), (&y, &x, place.pose().swapped())] {
            let o = PairTracker::new().closest(x, y, &pose);
            if o.state == ContactState::Separated {
                continue;
            }
            deep += 1;
            if o.state != ContactState::Overlapping || o.upper - o.lower > 1e-13 * size {
                bad += 1;
                if bad < 4 {
                    told += &format!("{:e} {a:?} {b:?} {place:?}\n{o:?}\n", (o.upper - o.lower) / size);
                }
            }
        }
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        let known = super::suites::sampled(&a, &b, &place, &mut rng);
        assert!(known <= o.upper + 1e-15 * size, "{known:e} {a:?} {b:?} {place:?} {o:?}");
    }
    assert!(bad == 0 && deep > 300, "{bad} of {deep}\n{told}");
}

/// A query of such superquadrics uses at most the number of directions that the documentation of
/// `closest` states, at every gap.
#[test]
fn superquadrics_near_the_limits_take_no_more_directions_than_stated() {
    let mut rng = Rng::new(2403);
    let mut steps = Vec::new();
    for k in 0..4 * super::count() as usize {
        let limits = |rng: &mut Rng| [0, 1].map(|_| *rng.pick(&[0.1, 0.5, 1.5, 1.9]));
        let [a, b] = [0, 1].map(|_| {
            let half = [0; 3].map(|_| rng.range(0.2, 1.0));
            let [e, f] = limits(&mut rng);
            if k % 3 == 0 {
                near_limits(&mut rng).shape()
            } else {
                Shape::superquadric(half.into(), e, f).expect("a superquadric")
            }
        });
        let q = if k % 2 == 0 { rng.quat() } else { quarter(&mut rng) };
        let gap = [1.0, 1e-3, 1e-6, 1e-9, 1e-11, 1e-13, 0.0, -1e-3][k % 8];
        let t = truth::pose::scale(rng.unit(), 4.0);
        let place = moved_to(&a, &b, Place { q, t }, gap);
        let o = PairTracker::new().closest(&a, &b, &place.pose());
        assert!(o.lower <= o.upper && o.upper.is_finite(), "{k} {o:?}");
        let most = if o.lower > 1e-10 { 450 } else { 1300 };
        assert!(o.work.steps <= most, "{k} {o:?}");
        steps.push(o.work.steps);
    }
    steps.sort_unstable();
    let (median, worst) = (steps[steps.len() / 2], steps[steps.len() - 1]);
    assert!(worst < 100 * median, "{median} {worst}");
}
