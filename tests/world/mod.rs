//! Between the plain data of `lab` and the types of the crate.

#![allow(dead_code, unreachable_pub)] // each test uses a part

use lab::motion::Frame;
use lab::shapes::Shape;
use lab::{Point, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Feature, FeaturePair, RelativePose};

/// The hull of a shape's points.
pub fn body(shape: &Shape) -> ConvexPolyhedron {
    let points: Vec<_> = shape.points.iter().map(|&p| Point3::from(p)).collect();
    ConvexPolyhedron::from_points(&points).unwrap_or_else(|e| panic!("{}: {e}", shape.name))
}

/// A body as plain data, with the faces it says it has.
pub fn plain(body: &ConvexPolyhedron) -> Shape {
    let rim = |f| body.face_vertices(f).map(|v| v.index() as u32).collect();
    let mut shape = Shape::hull("body", body.vertex_points().map(|p| p.coords.into()).collect());
    shape.faces = body.faces().map(rim).collect();
    shape
}

/// The pose bit for bit.
pub fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.q;
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(pose.t), rotation)
}

/// B as seen from A.
pub fn relative(frame: &Frame) -> RelativePose {
    RelativePose::new(&isometry(&frame.a), &isometry(&frame.b)).expect("a pose")
}

/// B shifted, A at rest.
pub fn shifted(by: Point) -> RelativePose {
    RelativePose::from_isometry(&Isometry3::from_parts(by.into(), UnitQuaternion::identity())).expect("a pose")
}

/// The size L of a placed pair: both radii about the middles of the boxes, and the distance of the middles.
pub fn size(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame) -> f64 {
    let ((middle_a, radius_a), (middle_b, radius_b)) = (a.bounding_ball(), b.bounding_ball());
    let apart = isometry(&frame.b) * middle_b - isometry(&frame.a) * middle_a;
    radius_a + radius_b + apart.norm()
}

/// One of each shipped solid, none larger than 2 across, with at most 42 vertices.
pub fn shipped() -> Vec<ConvexPolyhedron> {
    let all = [
        solids::cuboid(Vector3::new(0.5, 0.5, 0.5)),
        solids::cuboid(Vector3::new(0.9, 0.3, 0.1)),
        solids::tetrahedron(1.0),
        solids::octahedron(1.0),
        solids::icosahedron(1.0),
        solids::dodecahedron(1.0),
        solids::prism(3, 0.8, 0.5),
        solids::prism(16, 0.8, 0.4),
        solids::cone(5, 0.7, 1.0),
        solids::cone(24, 0.9, 0.6),
        solids::geodesic_sphere(1, 1.0),
    ];
    all.into_iter().map(|b| b.expect("a shipped solid")).collect()
}

/// Dimensions of the features of A and of B.
pub fn kinds(pair: FeaturePair) -> (usize, usize) {
    (pair.a.dimension(), pair.b.dimension())
}

/// Whether both features are those of the bodies.
pub fn are_of(pair: FeaturePair, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
    let known = |body: &ConvexPolyhedron, feature| match feature {
        Feature::Vertex(v) => body.vertex(v).is_some(),
        Feature::Edge(e) => body.edge_vertices(e).is_some(),
        Feature::Face(f) => body.face_plane(f).is_some(),
    };
    known(a, pair.a) && known(b, pair.b)
}
