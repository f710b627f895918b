//! Helpers of several tests: plain data as bodies and poses of the crate, and comparison with the
//! exact oracle.

use crate::motion::Frame;
use crate::shapes::Shape;
use crate::{Exact, Point, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    ContactState, ConvexPolyhedron, Decision, Feature, FeaturePair, GeometryRef, Outcome, PairTracker, Piece,
    QueryOptions, RelativePose,
};

/// Returns the pose of B in A's frame, from poses in the world frame.
pub fn between(a: &Pose, b: &Pose) -> RelativePose {
    RelativePose::new(&a.isometry(), &b.isometry()).expect("poses of a test are poses")
}

/// Returns the pose of B in A's frame, in a frame of a motion.
pub fn relative(frame: &Frame) -> RelativePose {
    between(&frame.a, &frame.b)
}

/// Returns the pose of B shifted by a vector, with A at rest.
pub fn shifted(by: Point) -> RelativePose {
    between(&Pose::IDENTITY, &Pose::shift(by))
}

/// Decisions with the default options.
pub trait Decide {
    /// Returns whether two geometries are at most `d` apart.
    fn decide<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        pose: &RelativePose,
        d: f64,
    ) -> Decision;
}

impl Decide for PairTracker {
    fn decide<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        pose: &RelativePose,
        d: f64,
    ) -> Decision {
        self.decide_within(a, b, pose, d, &QueryOptions::default())
    }
}

/// Returns a piece of a compound without a name.
pub fn piece_at(pose: Isometry3<f64>, shape: impl Into<lin_canny::Shape>) -> Piece {
    Piece {
        pose,
        ..Piece::new(shape)
    }
}

/// Returns the body of a shape: a hull, a point, a segment or a polygon.
pub fn body(s: &Shape) -> ConvexPolyhedron {
    let points: Vec<_> = s.points.iter().map(|&p| Point3::from(p)).collect();
    let flat = |_| ConvexPolyhedron::polygon(&points);
    let body = match *points {
        [p] => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        _ => ConvexPolyhedron::from_points(&points).or_else(flat),
    };
    body.unwrap_or_else(|e| panic!("{}: {e}", s.name))
}

/// Returns a body as plain data, with the faces that it reports.
pub fn plain(body: &ConvexPolyhedron) -> Shape {
    let (points, faces) = crate::contacts::plain(body);
    let mut shape = Shape::hull("body", points);
    shape.faces = faces;
    shape
}

/// Returns the size L of a pair: both radii about the centres of the boxes, plus the distance of
/// the centres.
pub fn size(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame) -> f64 {
    let ((middle_a, radius_a), (middle_b, radius_b)) = (a.bounding_ball(), b.bounding_ball());
    let apart = frame.b.isometry() * middle_b - frame.a.isometry() * middle_a;
    radius_a + radius_b + apart.norm()
}

/// Returns one of each built-in solid, none wider than 2, with at most 42 vertices.
pub fn shipped() -> Vec<ConvexPolyhedron> {
    let all = [
        solids::cuboid(Vector3::new(0.5, 0.5, 0.5)),
        solids::cuboid(Vector3::new(0.9, 0.3, 0.1)),
        solids::tetrahedron(1.0),
        solids::octahedron(1.0),
        solids::icosahedron(1.0),
        solids::dodecahedron(1.0),
        solids::prism(3, 0.5, 0.8),
        solids::prism(16, 0.4, 0.8),
        solids::cone(5, 0.5, 0.7),
        solids::cone(24, 0.3, 0.9),
        solids::geodesic_sphere(1, 1.0),
    ];
    all.into_iter().map(|b| b.expect("a shipped solid")).collect()
}

/// Returns the dimensions of the features of A and of B.
pub fn kinds(pair: FeaturePair) -> (usize, usize) {
    (pair.a.dimension(), pair.b.dimension())
}

/// Returns whether both features exist on their bodies.
pub fn are_of(pair: FeaturePair, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
    let known = |body: &ConvexPolyhedron, feature| match feature {
        Feature::Vertex(v) => body.vertex(v).is_some(),
        Feature::Edge(e) => body.edge_vertices(e).is_some(),
        Feature::Face(f) => body.face_plane(f).is_some(),
    };
    known(a, pair.a) && known(b, pair.b)
}

/// Returns all features of a body.
pub fn features(body: &ConvexPolyhedron) -> Vec<Feature> {
    let vertices = body.vertices().map(Feature::Vertex);
    let edges = body.edges().map(Feature::Edge);
    vertices.chain(edges).chain(body.faces().map(Feature::Face)).collect()
}

/// Returns all pairs of features.
pub fn pairs(a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Vec<FeaturePair> {
    let of_b = features(b);
    let with = |a: Feature| of_b.iter().map(move |&b| FeaturePair { a, b });
    features(a).into_iter().flat_map(with).collect()
}

/// Returns the oracle's contact state as the crate's type.
pub fn state(exact: crate::ContactState) -> ContactState {
    match exact {
        crate::ContactState::Separated => ContactState::Separated,
        crate::ContactState::Touching => ContactState::Touching,
        crate::ContactState::Overlapping => ContactState::Overlapping,
    }
}

/// Asserts that the contact state is that of the oracle and that the bounds contain the true
/// distance, exactly.
pub fn assert_right(o: &Outcome, truth: &Exact, what: &str) {
    assert_eq!(o.state, state(truth.state), "{what}: {o:?}, truth {}", truth.distance);
    // The differences are small and therefore exact, or so large that their sign is certain.
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
