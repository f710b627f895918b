//! Errors of building a body.

use alloc::vec::Vec;

/// The reason for which points or faces make no body. Indices are the caller's, lengths in the
/// caller's unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such point.
        index: usize,
    },
    /// Fewer points than the body needs.
    #[error("{count} points are too few, {needed} are needed")]
    TooFewPoints {
        /// Points given.
        count: usize,
        /// Points needed.
        needed: usize,
    },
    /// More points, faces or vertices of faces than 32-bit ids can name.
    #[error("{count} points or corners of faces are more than ids can name")]
    TooMany {
        /// Number of points, faces or vertices of faces.
        count: usize,
    },
    /// The longest side of the bounding box is below 1e-100 or above 1e100, or a coordinate is
    /// above 1e116 (then `extent` is the coordinate).
    #[error("the extent {extent:e}, reached at point {index}, lies outside 1e-100..1e100")]
    OutOfRange {
        /// A point at an end of the longest side.
        index: usize,
        /// The longest side of the bounding box.
        extent: f64,
    },
    /// All points are exactly coplanar (dimension 2), collinear (1) or equal (0).
    #[error("the points are flat: they span only {dimension} dimensions (points {span:?})")]
    Flat {
        /// Dimension of the affine hull.
        dimension: usize,
        /// Points that span the affine hull, one more than `dimension`.
        span: Vec<usize>,
    },
    /// The vertices of a polygon leave their plane by more than rounding explains.
    #[error("point {index} lies {distance:.2e} off the plane of the polygon, more than {bound:.2e}")]
    PolygonNotPlanar {
        /// The point farthest off.
        index: usize,
        /// The distance of the point from the plane.
        distance: f64,
        /// The largest accepted distance.
        bound: f64,
    },
    /// A face names a point that does not exist.
    #[error("face {face} names point {index}, which does not exist")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index that does not exist.
        index: usize,
    },
    /// A face has fewer than three vertices.
    #[error("face {face} has fewer than three corners")]
    FaceTooSmall {
        /// The face.
        face: usize,
    },
    /// A face passes twice through one point, or through two points of equal coordinates.
    #[error("face {face} passes twice through point {vertex}")]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The point.
        vertex: usize,
    },
    /// All vertices of a face are collinear.
    #[error("the corners of face {face} are collinear")]
    FaceWithoutArea {
        /// The face.
        face: usize,
    },
    /// A vertex leaves the plane of its face by more than the bound. For rounded coordinates, as in
    /// files in single precision, see
    /// [`from_faces_within`](super::ConvexPolyhedron::from_faces_within).
    #[error("point {vertex} lies {distance:.2e} off the plane of face {face}, more than {bound:.2e}")]
    FaceNotPlanar {
        /// The face.
        face: usize,
        /// The vertex farthest off the plane.
        vertex: usize,
        /// The distance of the vertex from the plane.
        distance: f64,
        /// The largest accepted distance.
        bound: f64,
    },
    /// An edge has a face on one side only.
    #[error("the faces are not closed: the edge from point {} to point {} has one face", edge[0], edge[1])]
    NotClosed {
        /// The ends of the edge, in the direction of its one face.
        edge: [usize; 2],
    },
    /// An edge belongs to more than two faces, or twice to the same side.
    #[error("the edge from point {} to point {} is used too often", edge[0], edge[1])]
    EdgeUsedTwice {
        /// The ends of the edge.
        edge: [usize; 2],
    },
    /// A face runs clockwise seen from outside.
    #[error("face {face} is wrongly oriented: its normal points inward")]
    WrongOrientation {
        /// The face.
        face: usize,
    },
    /// A point lies in front of a face. If by a little, because coordinates were rounded, see
    /// [`from_faces_within`](super::ConvexPolyhedron::from_faces_within). Else the mesh is not
    /// convex; [`from_points`](super::ConvexPolyhedron::from_points) takes its hull.
    #[error("not convex: point {vertex} lies {by:.2e} in front of face {face}")]
    NotConvex {
        /// The face.
        face: usize,
        /// The point that sticks out farthest.
        vertex: usize,
        /// The distance of the point from the plane of the face.
        by: f64,
    },
    /// A planarity bound that is negative or not finite.
    #[error("the planarity bound {value} is negative or not finite")]
    BadBound {
        /// The bound given.
        value: f64,
    },
    /// A size or count of a solid that makes no body.
    #[error("{value} is no {what} for this solid")]
    BadSize {
        /// The parameter.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// Data of a stored body that describe no body.
    #[error("the stored body is damaged: {what}")]
    Damaged {
        /// The part that does not fit.
        what: &'static str,
    },
    /// The surface found is not a polyhedron. Exact predicates exclude this, so the error is a
    /// defect of this crate.
    #[error("the hull found is not a polyhedron; please report these points")]
    Inconsistent,
}
