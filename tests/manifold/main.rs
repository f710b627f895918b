//! Promise: points of a manifold lie on the bodies, opposite each other; the deepest is that of the
//! certified outcome; the overlap of two faces is spanned; ids persist.

mod faces;
mod frames;
mod hard;
mod judge;
mod planar;
mod rims;

use judge::judge;
use lin_canny::{ContactState, ConvexPolyhedron, Manifold, ManifoldOptions, Tracker};
use truth::motion::Frame;
use truth::pose::unit;
use truth::shapes;
use truth::support;
use truth::{Point, Pose};

fn exact(prediction: f64, max_points: usize) -> ManifoldOptions {
    let mut o = ManifoldOptions::default().prediction(prediction);
    (o.rebuild_motion, o.reselect_motion, o.max_points) = (0.0, 0.0, max_points);
    o
}

/// Returns options under which only faces within one degree of the normal carry contacts.
fn flush(prediction: f64, max_points: usize) -> ManifoldOptions {
    let mut o = exact(prediction, max_points);
    o.max_face_sine = 1.0 / 64.0;
    o
}

fn manifold(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, options: &ManifoldOptions) -> Manifold {
    let mut m = Manifold::new();
    Tracker::new().manifold(a, b, &support::relative(frame), options, &mut m);
    m
}

#[test]
fn predictions_reach_as_far_as_they_say() {
    let cube = support::body(&shapes::cube());
    let mut count = [0; 2];
    for k in 0..100 {
        let gap = 0.001 * f64::from(k);
        let pose = support::shifted([0.3, 0.2, 2.0 + gap]);
        let mut m = Manifold::new();
        let options = ManifoldOptions::default().prediction(0.05);
        Tracker::new().manifold(&cube, &cube, &pose, &options, &mut m);
        if (gap - 0.05).abs() > 1e-12 {
            assert_eq!(m.points().len(), if gap < 0.05 { 4 } else { 0 }, "{gap}");
            count[usize::from(gap < 0.05)] += 1;
        }
    }
    assert!(count.iter().all(|&c| c >= 49));
    // Invalid numbers request nothing and are harmless.
    for (prediction, points) in [(f64::NAN, 0), (-1.0, 0), (f64::INFINITY, 4)] {
        let options = exact(prediction, 100);
        let mut m = Manifold::new();
        Tracker::new().manifold(&cube, &cube, &support::shifted([0.3, 0.2, 1.99]), &options, &mut m);
        assert_eq!(m.points().len(), points);
    }
    let mut options = exact(0.05, 0);
    (options.max_face_sine, options.rebuild_motion) = (f64::NAN, f64::NAN);
    let mut m = Manifold::new();
    Tracker::new().manifold(&cube, &cube, &support::shifted([0.3, 0.2, 1.99]), &options, &mut m);
    assert_eq!(m.points().len(), 1);
}

/// Edges on faces and edges on edges have two contacts, vertices have one.
#[test]
fn edges_and_corners_make_contacts() {
    let cube = support::body(&shapes::cube());
    let quarter = std::f64::consts::FRAC_PI_4;
    let options = exact(0.05, 4);
    let turned = |axis: Point, angle: f64, t: Point| Frame::new(Pose::IDENTITY, Pose::turn(axis, angle, t));
    let root = 2f64.sqrt();
    let on_edge = turned([1.0, 0.0, 0.0], quarter, [0.3, 0.0, 1.0 + root - 0.01]);
    let m = manifold(&cube, &cube, &on_edge, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (2, Some((2, 1))));
    judge(&cube, &cube, &on_edge, &m, &options, "edge on face");
    // Two crossed edges.
    let base = Pose::turn([0.0, 1.0, 0.0], quarter, [0.0; 3]);
    let crossed = Frame::new(
        base,
        Pose::turn([1.0, 0.0, 0.0], quarter, [0.0, 0.0, 2.0 * root + 0.01]),
    );
    let m = manifold(&cube, &cube, &crossed, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (1, Some((1, 1))));
    judge(&cube, &cube, &crossed, &m, &options, "edges crosswise");
    // And along each other.
    let along = Frame::new(base, base.moved_to([0.0, 0.5, 2.0 * root + 0.01]));
    let m = manifold(&cube, &cube, &along, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (2, Some((1, 1))));
    judge(&cube, &cube, &along, &m, &options, "edges along each other");
    let length = (m.points()[0].point_on_a - m.points()[1].point_on_a).norm();
    assert!((length - 1.5).abs() < 1e-12);
    // A vertex: the cube on its diagonal.
    let axis = unit([1.0, -1.0, 0.0]);
    let corner = turned(axis, (1.0 / 3f64.sqrt()).acos(), [0.2, 0.1, 1.0 + 3f64.sqrt() - 0.01]);
    let m = manifold(&cube, &cube, &corner, &options);
    let o = judge(&cube, &cube, &corner, &m, &options, "corner on face");
    assert_eq!((m.points().len(), o.state), (1, ContactState::Overlapping));
}

/// The contacts of an outcome are those of a new tracker, and a foreign outcome has none.
#[test]
fn an_outcome_gives_the_contacts_of_a_first_query() {
    let mut rng = truth::rng::Rng::new(611);
    let bodies = [
        shapes::cube(),
        shapes::sphere(&mut rng, 40),
        shapes::prism(30, 1.0, 0.2),
    ];
    let bodies = bodies.map(|s| support::body(&s));
    let mut points = [0; 9];
    for k in 0..600 {
        let (a, b) = (&bodies[k % 3], &bodies[k / 3 % 3]);
        let frame = Frame::new(
            Pose::IDENTITY,
            Pose::new(rng.quat(), truth::pose::scale(rng.unit(), rng.range(0.3, 2.4))),
        );
        let (pose, options) = (support::relative(&frame), ManifoldOptions::default().prediction(0.1));
        let outcome = Tracker::new().closest(a, b, &pose);
        let m = Manifold::from_outcome(a, b, &pose, &outcome, &options);
        assert_eq!(m, manifold(a, b, &frame, &options));
        points[m.points().len()] += 1;
        let point = ConvexPolyhedron::point(lin_canny::nalgebra::Point3::origin()).expect("a point");
        let m = Manifold::from_outcome(&point, &point, &pose, &outcome, &options);
        assert!(m.points().len() <= 1, "features of other bodies");
    }
    assert!(points[0] > 50 && points[1] > 5 && points[4] > 50, "{points:?}");
}
