//! Promise: the gradient is the derivative of the exact signed distance by either pose, separated
//! and overlapping, and one-sided at ties.

use lin_canny::nalgebra::Vector3;
use lin_canny::{ContactState, Manifold, ManifoldOptions, Tracker};
use truth::exact::{self, Body};
use truth::motion::Frame;
use truth::pose::{add, quat, quat_mul, scale, unit_quat};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Point, Pose};

/// Returns a pose moved along a twist in its frame.
fn moved(pose: &Pose, linear: Point, angular: Point, by: f64) -> Pose {
    let length = truth::pose::norm(angular);
    let turn = if length > 0.0 {
        quat(scale(angular, 1.0 / length), length * by)
    } else {
        [0.0, 0.0, 0.0, 1.0]
    };
    Pose::new(
        unit_quat(quat_mul(pose.q, turn)),
        add(pose.t, pose.rotate(scale(linear, by))),
    )
}

/// Twists of A and of B.
type Twists = [[Point; 2]; 2];

fn after(frame: &Frame, [a, b]: &Twists, by: f64) -> Frame {
    Frame::new(moved(&frame.a, a[0], a[1], by), moved(&frame.b, b[0], b[1], by))
}

fn truth(a: &Shape, b: &Shape, frame: &Frame) -> f64 {
    exact::solve(Body::from(a), &frame.a, Body::from(b), &frame.b).distance
}

const STEP: f64 = 1e-6;

/// Returns the forward and backward rates of the exact signed distance.
fn rates(a: &Shape, b: &Shape, frame: &Frame, twists: &Twists) -> (f64, f64) {
    let now = truth(a, b, frame);
    let ahead = truth(a, b, &after(frame, twists, STEP));
    let behind = truth(a, b, &after(frame, twists, -STEP));
    ((ahead - now) / STEP, (now - behind) / STEP)
}

fn twists(rng: &mut Rng) -> Twists {
    [(); 2].map(|_| [rng.unit(), rng.unit()])
}

#[test]
fn gradients_are_derivatives() {
    let mut rng = Rng::new(701);
    let (mut compared, mut kinks) = ([0; 4], 0);
    for _ in 0..600 {
        let (a, b) = (shapes::small(&mut rng), shapes::small(&mut rng));
        let frame = Frame::new(
            Pose::new(rng.quat(), rng.unit()),
            Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.3, 2.5))),
        );
        let pose = support::relative(&frame);
        let o = Tracker::new().closest(&support::body(&a), &support::body(&b), &pose);
        if o.distance.abs() < 1e-3 {
            continue;
        }
        let (ga, gb) = (o.gradient_a(), o.gradient_b(&pose));
        let mut twists = twists(&mut rng);
        // Occasionally one body is at rest.
        if rng.chance(0.5) {
            twists[rng.below(2)] = [[0.0; 3]; 2];
        }
        let [ta, tb] = twists.map(|t| t.map(Vector3::from));
        let rate = ga.along(&ta[0], &ta[1]) + gb.along(&tb[0], &tb[1]);
        let (ahead, behind) = rates(&a, &b, &frame, &twists);
        if (ahead - behind).abs() > 1e-3 {
            kinks += 1;
            continue;
        }
        assert!((rate - ahead).abs() < 2e-3, "{rate} {ahead} {behind} {o:?}");
        assert!((rate - behind).abs() < 2e-3, "{rate} {ahead} {behind} {o:?}");
        let off = (rate - (ahead + behind) / 2.0).abs();
        assert!(off < 1e-4, "{rate} {ahead} {behind} {o:?}");
        compared[o.state as usize] += 1;
    }
    assert!(compared[ContactState::Separated as usize] > 100, "{compared:?}");
    assert!(compared[ContactState::Overlapping as usize] > 100, "{compared:?}");
    assert!(kinks < 30, "{kinks}");
}

/// Faces flat on faces, separated and overlapping: the forward rate is the least over the contacts,
/// and the gradient of one of them is no less.
#[test]
fn parallel_faces_have_one_sided_rates() {
    let mut rng = Rng::new(702);
    let (mut tied, mut differ) = (0, 0);
    for k in 0..300 {
        let (a, b) = (shapes::cube(), shapes::cuboid([0.5, 0.75, 0.25]));
        let at = [rng.int(-6, 6), rng.int(-6, 6)].map(|x| x as f64 / 8.0);
        let distance = [0.125, -0.0625][k % 2];
        let frame = Frame::new(Pose::IDENTITY, Pose::shift([at[0], at[1], 1.25 + distance]));
        let (body_a, body_b) = (support::body(&a), support::body(&b));
        let pose = support::relative(&frame);
        let mut options = ManifoldOptions::default().prediction(1.0);
        options.max_points = 8;
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        pair.manifold(&body_a, &body_b, &pose, &options, &mut m);
        assert!(m.points().len() >= 4);
        let twists = twists(&mut rng);
        let [ta, tb] = twists.map(|t| t.map(Vector3::from));
        let rate = m.rate(&pose, &ta[0], &ta[1], &tb[0], &tb[1]).expect("contacts");
        let (ahead, behind) = rates(&a, &b, &frame, &twists);
        assert!((rate - ahead).abs() < 1e-4, "{rate} {ahead} {behind} {m:?}");
        let o = pair.closest(&body_a, &body_b, &pose);
        let one = o.gradient_a().along(&ta[0], &ta[1]) + o.gradient_b(&pose).along(&tb[0], &tb[1]);
        assert!(one >= ahead - 1e-4, "{one} {ahead}");
        tied += 1;
        differ += usize::from((ahead - behind).abs() > 1e-2);
    }
    assert!(tied == 300 && differ > 200, "{differ}");
}

/// Equally deep along several normals: the forward rate is the largest over them, so the outcome's
/// rate is no greater.
#[test]
fn concentric_bodies_have_one_sided_rates() {
    let mut rng = Rng::new(703);
    let mut differ = 0;
    for _ in 0..100 {
        let cube = shapes::cube();
        let at = Frame::new(Pose::IDENTITY, Pose::IDENTITY);
        let body = support::body(&cube);
        let pose = support::relative(&at);
        let o = Tracker::new().closest(&body, &body, &pose);
        let twists = [[[0.0; 3]; 2], [rng.unit(), [0.0; 3]]];
        let rate = o.gradient_b(&pose).along(&twists[1][0].into(), &Vector3::zeros());
        let (ahead, _) = rates(&cube, &cube, &at, &twists);
        assert!(rate <= ahead + 1e-6, "{rate} {ahead}");
        differ += usize::from(rate < ahead - 1e-2);
    }
    assert!(differ > 50, "{differ}");
}
