//! What several tests share: plain data of the laboratory as bodies and poses of the crate, and the judgement of an
//! answer by the exact oracle.
#![allow(dead_code)]

use lab::shapes::Shape;
use lab::{Exact, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{Class, ConvexPolyhedron, Feature, FeaturePair, Outcome, RelativePose};

/// The pose with the very bits given.
pub(crate) fn isometry(p: &Pose) -> Isometry3<f64> {
    let [x, y, z, w] = p.q;
    let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::new(p.t[0], p.t[1], p.t[2]), q)
}

/// Both poses as one.
pub(crate) fn relative(a: &Pose, b: &Pose) -> RelativePose {
    RelativePose::new(&isometry(a), &isometry(b)).expect("poses of a test are poses")
}

/// The body of a shape: a hull, or a point, a segment or a polygon.
pub(crate) fn body(s: &Shape) -> ConvexPolyhedron {
    let points: Vec<_> = s.points.iter().map(|&p| Point3::from(p)).collect();
    let flat = |_| ConvexPolyhedron::polygon(&points);
    let body = match *points {
        [p] => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        _ => ConvexPolyhedron::from_points(&points).or_else(flat),
    };
    body.unwrap_or_else(|e| panic!("{}: {e}", s.name))
}

/// All features of a body.
pub(crate) fn features(body: &ConvexPolyhedron) -> Vec<Feature> {
    let vertices = body.vertices().map(Feature::Vertex);
    let edges = body.edges().map(Feature::Edge);
    vertices.chain(edges).chain(body.faces().map(Feature::Face)).collect()
}

/// All pairs of features.
pub(crate) fn pairs(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Vec<FeaturePair> {
    let of_b = features(b);
    let with = |a: Feature| of_b.iter().map(move |&b| FeaturePair { a, b });
    features(a).into_iter().flat_map(with).collect()
}

/// The oracle's class in the words of the crate.
pub(crate) fn class(exact: lab::Class) -> Class {
    match exact {
        lab::Class::Separated => Class::Separated,
        lab::Class::Touching => Class::Touching,
        lab::Class::Overlapping => Class::Overlapping,
    }
}

/// Fails unless the class is that of the oracle and the true distance is between the bounds, to the last bit.
pub(crate) fn assert_right(o: &Outcome, truth: &Exact, what: &str) {
    assert_eq!(o.class, class(truth.class), "{what}: {o:?}, truth {}", truth.distance);
    // The differences are small and hence exact, or so large that their sign is not in doubt.
    let above = (o.lower - truth.distance) - truth.remainder;
    let below = (o.upper - truth.distance) - truth.remainder;
    assert!(
        above <= 0.0 && below >= 0.0,
        "{what}: {o:?} misses {} + {}",
        truth.distance,
        truth.remainder
    );
    assert!(o.lower <= o.distance && o.distance <= o.upper, "{what}: {o:?}");
}

/// Fails unless the distance of a separated pair is within one unit in the last place of the truth.
pub(crate) fn assert_exact(o: &Outcome, truth: &Exact, what: &str) {
    assert_right(o, truth, what);
    let d = truth.distance;
    let ulp = d.next_up() - d;
    if truth.class == lab::Class::Separated {
        assert!((o.distance - d).abs() <= ulp, "{what}: {:e} is not {d:e}", o.distance);
    }
}
