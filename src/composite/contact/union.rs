//! The surface of a union of pieces: which points of a piece are on it.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Shape};
use crate::composite::parts::Parted;
use crate::composite::pieces::{Composite, Piece};
use crate::convex::contact::tangents_of;
use crate::convex::shape_tracker::ShapeTracker;

/// How far from a point that another piece covers a place of the same face is looked for that is
/// not covered, in the slack of the point: faces that meet at less than one part in this many of a
/// radian are one. Not measured.
const BESIDE_END: f64 = 64.0;

/// What is at a point of the plane of a face beyond the end of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Under {
    /// The inside of the body: the face ends in a valley.
    Body,
    /// Another face in the same plane.
    Face,
    /// Nothing, or nothing that is known.
    Unknown,
}

/// Returns whether another piece holds the point and is higher along the normal: then the whole has
/// no such normal there.
pub(super) fn is_covered(body: &Composite, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> bool {
    cover(body, of, point, n, slack).is_some()
}

/// Returns a piece that covers a point of another one.
pub(super) fn cover<'a>(
    body: &'a Composite,
    of: u32,
    point: &Point3<f64>,
    n: &Vector3<f64>,
    slack: f64,
) -> Option<&'a Piece> {
    other(body, of, point, slack, |piece, local| {
        let m = piece.pose.inverse_transform_vector(n);
        piece.shape.support_height(&m) > m.dot(&local.coords) + 2.0 * slack
    })
}

/// Returns whether a covered point of a face is at the end of the part of the face that is not:
/// some place of the face next to the point is not covered.
pub(super) fn is_end(body: &Composite, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> bool {
    let Some(Piece { shape, pose, .. }) = body.pieces().get(of as usize) else {
        return false;
    };
    let [u, v] = tangents_of(n);
    let ways = [u, v, u + v, u - v].into_iter().flat_map(|w| [w, -w]);
    ways.into_iter().any(|way| {
        let place = point + way * (BESIDE_END * slack);
        is_in(shape, &pose.inverse_transform_point(&place), 2.0 * slack) && !is_covered(body, of, &place, n, slack)
    })
}

/// Returns what is at a point of the plane of a face of a piece.
pub(super) fn under(body: &Composite, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> Under {
    if is_covered(body, of, point, n, slack) {
        Under::Body
    } else if other(body, of, point, slack, |_, _| true).is_some() {
        Under::Face
    } else {
        Under::Unknown
    }
}

/// Another piece that holds the point, here in the piece's frame, and passes a test.
fn other<'a>(
    body: &'a Composite,
    of: u32,
    point: &Point3<f64>,
    slack: f64,
    passes: impl Fn(&Piece, &Point3<f64>) -> bool,
) -> Option<&'a Piece> {
    if body.pieces().len() == 1 {
        return None;
    }
    let (unit, mut found) = (body.stored_unit(), None);
    let holds = |item: u32| {
        let piece = &body.pieces()[body.number(item) as usize];
        let local = piece.pose.inverse_transform_point(point);
        let holds = body.number(item) != of && passes(piece, &local) && is_in(&piece.shape, &local, slack);
        found = holds.then_some(piece);
        holds
    };
    body.side().tree.any_near(&(point.coords / unit), slack / unit, holds);
    found
}

/// Returns whether a point is within `slack` of a shape, or of the planes of all its faces.
pub(super) fn is_in(shape: &Shape, point: &Point3<f64>, slack: f64) -> bool {
    if let (Core::Polyhedron(core), 0.0) = (shape.core(), shape.round())
        && core.face_count() >= 4
    {
        let planes = core.faces().filter_map(|face| core.face_plane(face));
        return planes
            .into_iter()
            .all(|(n, offset)| n.dot(&point.coords) - offset <= slack);
    }
    dot_at(point).is_some_and(|(dot, at)| ShapeTracker::new().within(shape, &dot, &at, slack))
}

/// Returns a point as a shape, and its pose.
pub(super) fn dot_at(point: &Point3<f64>) -> Option<(Shape, RelativePose)> {
    let dot = ConvexPolyhedron::point(Point3::origin()).ok()?;
    let at = RelativePose::from_isometry(&Isometry3::translation(point.x, point.y, point.z)).ok()?;
    Some((Shape::from(dot), at))
}
