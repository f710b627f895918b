//! Promise: overlapping bodies have a proven depth: the shortest translation along the normal that
//! separates them.

mod frames;
mod hard;
mod history;
mod local;
mod nearest;

use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Tracker};
use truth::exact;
use truth::motion::Frame;
use truth::pose::{norm, radius, scale, sub};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Body, Pose};

fn both(a: Pose, b: Pose) -> Frame {
    Frame::new(a, b)
}

fn closest(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame) -> Outcome {
    Tracker::new().closest(a, b, &support::relative(frame))
}

/// Judges bounds, normal and witnesses of an overlap.
///
/// Pushed along the normal by the upper bound of the depth, the bodies are separated; by slightly
/// less than the depth, they are not.
fn judge(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, what: &str) -> Outcome {
    let o = closest(a, b, frame);
    let size = support::size(a, b, frame);
    let told = format!("{what}: {o:?} {frame:?}");
    assert_eq!(o.state, ContactState::Overlapping, "{told}");
    assert!(o.lower <= o.distance, "{told}");
    assert!(o.distance <= o.upper, "{told}");
    assert!(o.upper <= 0.0, "{told}");
    assert!(o.upper - o.lower <= 1e-13 * size, "{told}");
    let n: [f64; 3] = frame.a.rotate(o.normal.into_inner().into());
    let pushed = |by: f64| closest(a, b, &pushed(frame, &o, by)).distance;
    // Below this size, the rounding of the pushed pose decides.
    if -o.distance > 1e-10 * size {
        assert!(pushed(-o.lower * (1.0 + 1e-12)) >= -1e-14 * size, "{told}");
        assert!(pushed(-0.999 * o.distance) < 0.0, "{told}");
    }
    let (p, q) = (o.point_on_a.coords.into(), o.point_on_b.coords.into());
    let between = sub(frame.b.apply(q), frame.a.apply(p));
    let along = scale(n, o.distance);
    assert!(norm(sub(between, along)) <= 1e-12 * size, "{told}");
    for (body, point) in [(a, o.point_on_a), (b, o.point_on_b)] {
        let near = body.closest_point(&point).unwrap_or(point);
        assert!((near - point).norm() <= 1e-12 * size, "{told}");
    }
    assert!(support::are_of(o.features, a, b), "{told}");
    o
}

/// Judges both orders, and asserts that both depths agree.
fn judge_both(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, what: &str) -> f64 {
    let there = judge(a, b, frame, what);
    let back = judge(b, a, &frame.swapped(), what);
    let slack = 1e-14 * support::size(a, b, frame);
    let off = (there.distance - back.distance).abs();
    assert!(off <= slack, "{what}: {there:?} {back:?}");
    there.distance
}

/// Returns poses with many ties and zero volumes.
fn hard_poses(rng: &mut Rng, radii: (f64, f64)) -> Vec<Frame> {
    let turned = Pose::new(rng.quat(), scale(rng.unit(), 3.0));
    let spun = Pose::new(rng.quat(), turned.t);
    let near = |by: f64, rng: &mut Rng| Pose::new(turned.q, sub(turned.t, scale(rng.unit(), by)));
    let shift = [rng.int(-1, 1) as f64 * 0.5, rng.int(-1, 1) as f64 * 0.5, 0.0];
    vec![
        both(Pose::IDENTITY, Pose::IDENTITY),
        both(turned, turned),
        both(turned, spun),
        both(turned, near(1e-9, rng)),
        both(turned, near(0.1 * (radii.0 + radii.1), rng)),
        both(Pose::IDENTITY, Pose::shift(shift)),
    ]
}

/// Returns B moved along the normal of an outcome.
fn pushed(frame: &Frame, o: &Outcome, by: f64) -> Frame {
    let n: [f64; 3] = frame.a.rotate(o.normal.into_inner().into());
    let t = sub(frame.b.t, scale(n, -by));
    both(frame.a, Pose::new(frame.b.q, t))
}

#[test]
fn hard_poses_of_small_bodies_are_exact() {
    let mut rng = Rng::new(501);
    let mut judged = 0;
    while judged < 400 {
        let a = shapes::small(&mut rng);
        let b = if rng.chance(0.3) {
            a.clone()
        } else if rng.chance(0.3) {
            a.clone().stretched([0.5; 3])
        } else {
            shapes::small(&mut rng)
        };
        let (body_a, body_b) = (support::body(&a), support::body(&b));
        for frame in hard_poses(&mut rng, (radius(&a.points), radius(&b.points))) {
            let truth = exact::solve(Body::from(&a), &frame.a, Body::from(&b), &frame.b);
            if truth.state != truth::ContactState::Overlapping {
                continue;
            }
            let d = judge_both(&body_a, &body_b, &frame, &a.name);
            let slack = 1e-14 * support::size(&body_a, &body_b, &frame);
            let off = (d - truth.distance).abs();
            assert!(off <= slack, "{d:e}, not {:e}: {a:?} {b:?} {frame:?}", truth.distance);
            judged += 1;
        }
    }
}

#[test]
fn larger_bodies_are_certified() {
    let mut rng = Rng::new(502);
    let bodies: Vec<(Shape, ConvexPolyhedron)> = [
        shapes::icosphere(2),
        shapes::sphere(&mut rng, 200),
        shapes::ellipsoid(&mut rng, 120, [1.0, 0.6, 0.1]),
        shapes::cone(128, 1.0, 0.4),
        shapes::prism(64, 1.0, 0.3),
        shapes::grid(4),
        shapes::chamfered([1.0, 0.7, 0.5], 1e-9),
        shapes::dome(6, 1e-6),
        shapes::sliver(&mut rng, 40, 1e-6),
    ]
    .into_iter()
    .map(|s| (s.clone(), support::body(&s)))
    .collect();
    let mut judged = 0;
    for (sa, a) in &bodies {
        for (sb, b) in &bodies {
            for frame in hard_poses(&mut rng, (radius(&sa.points), radius(&sb.points))) {
                if closest(a, b, &frame).state == ContactState::Overlapping {
                    judge_both(a, b, &frame, &format!("{} {}", sa.name, sb.name));
                    judged += 1;
                }
            }
        }
    }
    assert!(judged > 200, "{judged}");
}

/// A query without a depth does not pay for it.
#[test]
fn a_depth_is_searched_for_on_request_only() {
    let cube = support::body(&shapes::cube());
    let mut pair = Tracker::new();
    for k in 0..20 {
        let pose = support::shifted([0.1 * f64::from(k), 0.3, 0.2]);
        assert!(pair.intersects(&cube, &cube, &pose));
        assert!(pair.within(&cube, &cube, &pose, 0.1));
        assert!(pair.propose(&cube, &cube, &pose).work.depths == 0);
    }
    assert_eq!(pair.work().depths, 0);
    let o = pair.closest(&cube, &cube, &support::shifted([1.5, 0.3, 0.2]));
    assert_eq!((o.work.depths, pair.work().depths), (1, 1));
    assert_eq!((o.distance, o.normal.into_inner().into()), (-0.5, [1.0, 0.0, 0.0]));
}
