//! Errors of building a body.

use alloc::vec::Vec;
use core::fmt;

use crate::base::callbacks::Stopped;

/// Error of building a body. Indices are the caller's, lengths are in the caller's unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate is infinite or NaN.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such point.
        index: usize,
    },
    /// Fewer points than the body needs.
    #[error("too few points: {count} (expected at least {needed})")]
    TooFewPoints {
        /// Number of points given.
        count: usize,
        /// Number of points needed.
        needed: usize,
    },
    /// More points, faces or vertices of faces than 32-bit ids can name.
    #[error("too many points or face vertices for 32-bit ids: {count}")]
    TooMany {
        /// Number of points, faces or vertices of faces.
        count: usize,
    },
    /// The longest side of the bounding box is below 1e-100 or above 1e100, or a coordinate is
    /// above 1e116. In the second case `extent` is the coordinate.
    #[error("extent of the points is out of range: {extent:e}, at point {index} (expected 1e-100..=1e100)")]
    OutOfRange {
        /// A point at an end of the longest side.
        index: usize,
        /// The longest side of the bounding box.
        extent: f64,
    },
    /// All points are exactly coplanar (dimension 2), collinear (1) or equal (0).
    #[error("{}", FlatPoints(*dimension, span))]
    Flat {
        /// Dimension of the affine hull.
        dimension: usize,
        /// Points that span the affine hull, one more than `dimension`.
        span: Vec<usize>,
    },
    /// The vertices of a polygon are farther from one plane than rounding explains.
    #[error("point {index} is not in the plane of the polygon: distance {distance:.2e} (expected at most {bound:.2e})")]
    PolygonNotPlanar {
        /// The point farthest from the plane.
        index: usize,
        /// The distance of the point from the plane.
        distance: f64,
        /// The largest accepted distance.
        bound: f64,
    },
    /// A face names a point that does not exist.
    #[error("face {face} has a point that does not exist: {index}")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index that does not exist.
        index: usize,
    },
    /// A face has fewer than three vertices.
    #[error("face {face} has fewer than three vertices")]
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
    #[error("the vertices of face {face} are collinear")]
    FaceWithoutArea {
        /// The face.
        face: usize,
    },
    /// A vertex is farther from the plane of its face than the bound. For rounded coordinates, as
    /// in files in single precision, see
    /// [`from_faces_within`](super::ConvexPolyhedron::from_faces_within).
    #[error(
        "point {vertex} is not in the plane of face {face}: distance {distance:.2e} (expected at most {bound:.2e})"
    )]
    FaceNotPlanar {
        /// The face.
        face: usize,
        /// The vertex farthest from the plane.
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
    #[error("the edge from point {} to point {} belongs to more than two faces, or twice to the same side", edge[0], edge[1])]
    EdgeUsedTwice {
        /// The ends of the edge.
        edge: [usize; 2],
    },
    /// The vertices of a face are clockwise seen from outside.
    #[error("face {face} is wrongly oriented: its normal points inward")]
    WrongOrientation {
        /// The face.
        face: usize,
    },
    /// A point lies outside the plane of a face. If the distance is small because coordinates were
    /// rounded, see [`from_faces_within`](super::ConvexPolyhedron::from_faces_within). Otherwise
    /// the mesh is not convex; [`from_points`](super::ConvexPolyhedron::from_points) takes its
    /// hull.
    #[error("the faces are not convex: point {vertex} is {by:.2e} outside the plane of face {face}")]
    NotConvex {
        /// The face.
        face: usize,
        /// The point farthest outside.
        vertex: usize,
        /// The distance of the point from the plane of the face.
        by: f64,
    },
    /// The planarity bound is negative or not finite.
    #[error("planarity bound is out of range: {value} (expected a finite number that is not negative)")]
    BadBound {
        /// The bound given.
        value: f64,
    },
    /// A size of a solid is outside 1e-100..1e100.
    #[error("{what} is out of range: {value:?} (expected 1e-100..=1e100)")]
    BadSize {
        /// The parameter.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A count is too small or too large for a solid.
    #[error("number of {what} is out of range: {count} (expected {least}..={most})")]
    BadCount {
        /// What is counted.
        what: &'static str,
        /// The number given.
        count: usize,
        /// The least number accepted.
        least: usize,
        /// The greatest number accepted.
        most: usize,
    },
    /// The scale factor is not a positive finite number.
    #[error("scale factor is out of range: {value:?} (expected a positive finite number)")]
    BadFactor {
        /// The factor given.
        value: f64,
    },
    /// The data of a stored body are invalid.
    #[error("the stored body is damaged: {what}")]
    Damaged {
        /// What is invalid.
        what: &'static str,
    },
    /// The computed surface is not a polyhedron. Exact predicates exclude this, so this error is a
    /// defect of the crate.
    #[error("the hull found is not a polyhedron; please report these points")]
    Inconsistent,
    /// The caller's progress callback stopped the call.
    #[error("the caller has stopped the build")]
    Stopped,
}

impl From<Stopped> for BuildError {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

/// Displays why points that span less than three dimensions have no hull with volume.
struct FlatPoints<'a>(usize, &'a [usize]);

impl fmt::Display for FlatPoints<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(dimension, span) = self;
        match dimension {
            0 => f.write_str("all points are equal"),
            1 => write!(f, "all points lie on the line through points {span:?}"),
            _ => write!(f, "all points lie in the plane through points {span:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;
    use nalgebra::{Point3, Vector3};

    use crate::body::polyhedron::{ConvexPolyhedron, solids};

    #[test]
    fn errors_name_the_value_and_the_rule() {
        let line = [0.0, 1.0, 3.0, 2.0].map(|x| Point3::new(x, 0.0, 0.0));
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| Point3::new(x, y, 0.0));
        let hull = |points: &[Point3<f64>]| ConvexPolyhedron::from_points(points).unwrap_err().to_string();
        assert_eq!(hull(&line[..1]), "too few points: 1 (expected at least 4)");
        assert_eq!(hull(&[Point3::origin(); 4]), "all points are equal");
        assert_eq!(hull(&line), "all points lie on the line through points [0, 2]");
        assert_eq!(hull(&square), "all points lie in the plane through points [0, 2, 3]");
        assert_eq!(
            solids::cuboid(Vector3::new(1.0, 0.0, 1.0)).unwrap_err().to_string(),
            "half extent is out of range: 0.0 (expected 1e-100..=1e100)"
        );
        assert_eq!(
            solids::prism(2, 1.0, 1.0).unwrap_err().to_string(),
            "number of vertices around the axis is out of range: 2 (expected 3..=16777216)"
        );
        let cube = solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).unwrap();
        assert_eq!(
            cube.scaled(-1.0).unwrap_err().to_string(),
            "scale factor is out of range: -1.0 (expected a positive finite number)"
        );
    }
}
