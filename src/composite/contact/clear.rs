//! How far a point inside a union of pieces is from the surface of the union.
//!
//! A face of a piece is on the surface where no other piece covers it. What a convex piece leaves
//! of a convex polygon are the parts of the polygon beyond each of the piece's planes, convex
//! again.

use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::union::{cover, dot_at, is_covered};
use crate::base::num::scalar::sqrt;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId};
use crate::body::shape::{Core, Shape};
use crate::composite::meet::triangle;
use crate::composite::parts::Parted;
use crate::composite::pieces::{Composite, Piece};
use crate::convex::shape_tracker::ShapeTracker;

/// Pieces that are cut off a face, one after the other, to find the part that none covers. Not
/// measured.
const COVERS: usize = 4;

/// Returns whether the surface of the union is as far from a point inside as `depth`, as far as
/// faces and feet on curved pieces tell. The point is in the frame of one of the pieces, and
/// `depth` below its core.
pub(super) fn is_clear(body: &Composite, of: u32, point: &Point3<f64>, (depth, slack): (f64, f64)) -> bool {
    let own = &body.pieces()[of as usize];
    if body.pieces().len() == 1 {
        let Core::Polyhedron(core) = own.shape.core() else {
            return true;
        };
        return core.faces().all(|face| {
            let plane = core.face_plane(face);
            plane.is_none_or(|(n, offset)| offset - n.dot(&point.coords) >= depth - own.shape.round())
        });
    }
    let (unit, reach) = (body.stored_unit(), depth + own.shape.round());
    let place = own.pose * point;
    let near = NearPoint {
        body,
        place: place.coords,
        reach,
        slack,
    };
    let is_near = |item: u32| near.is_exposed(body.number(item));
    !body.side().tree.any_near(&(place.coords / unit), reach / unit, is_near)
}

/// A point in a body, both in the body's frame.
struct NearPoint<'a> {
    body: &'a Composite,
    place: Vector3<f64>,
    reach: f64,
    slack: f64,
}

impl NearPoint<'_> {
    /// Returns whether the surface of a piece is within reach where no other piece covers it.
    fn is_exposed(&self, of: u32) -> bool {
        let piece = &self.body.pieces()[of as usize];
        let Core::Polyhedron(core) = piece.shape.core() else {
            return self.is_foot_exposed(of, piece);
        };
        core.faces().any(|face| {
            let Some((n, offset)) = core.face_plane(face) else {
                return false;
            };
            let out = piece.pose * n.into_inner();
            let height = out.dot(&(self.place - piece.pose.translation.vector)) - offset - piece.shape.round();
            height.abs() < self.reach && self.is_left((of, &out), &rim(piece, core, face, &out), COVERS)
        })
    }

    /// Returns whether a part of a face that no other piece covers is within reach.
    fn is_left(&self, (of, n): (u32, &Vector3<f64>), polygon: &[Vector3<f64>], covers: usize) -> bool {
        let (square, foot) = nearest(polygon, &self.place);
        if !(square < self.reach * self.reach) {
            return false;
        }
        let away = self.place - foot;
        let is_out = n.dot(&away) > 0.0;
        let normal = if is_out { away / sqrt(square) } else { *n };
        let Some(by) = cover(self.body, of, &Point3::from(foot), &normal, self.slack) else {
            return true;
        };
        let (Core::Polyhedron(core), 0.0, 1..) = (by.shape.core(), by.shape.round(), covers) else {
            return false;
        };
        core.faces().any(|face| {
            let Some((m, offset)) = core.face_plane(face) else {
                return false;
            };
            let m = by.pose * m.into_inner();
            let level = offset + m.dot(&by.pose.translation.vector) + 2.0 * self.slack;
            let left = beyond(polygon, &m, level);
            left.len() > 2 && self.is_left((of, n), &left, covers - 1)
        })
    }

    /// Returns whether the point of a curved shape that is nearest is within reach, and not
    /// covered.
    fn is_foot_exposed(&self, of: u32, Piece { shape, pose, .. }: &Piece) -> bool {
        let foot = foot(shape, &pose.inverse_transform_point(&Point3::from(self.place)));
        foot.is_some_and(|(foot, n)| {
            let at = pose * foot;
            let is_near = (at.coords - self.place).norm_squared() < self.reach * self.reach;
            is_near && !is_covered(self.body, of, &at, &(pose * n), self.slack)
        })
    }
}

/// Returns the corners of a face of a piece, in the body's frame, moved out by the radius of the
/// piece.
fn rim(piece: &Piece, core: &ConvexPolyhedron, face: FaceId, n: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let corners = core.face_vertices(face).filter_map(|v| core.vertex(v));
    corners
        .map(|p| (piece.pose * p).coords + n * piece.shape.round())
        .collect()
}

/// Returns the squared distance of a point from a convex polygon, and the point of the polygon.
fn nearest(polygon: &[Vector3<f64>], point: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let mut best = (f64::INFINITY, *point);
    for w in polygon.windows(2).skip(1) {
        let found = triangle::foot_of(point, &[polygon[0], w[0], w[1]]);
        if found.0 < best.0 {
            best = found;
        }
    }
    best
}

/// Returns the part of a convex polygon above a plane.
fn beyond(polygon: &[Vector3<f64>], m: &Vector3<f64>, level: f64) -> Vec<Vector3<f64>> {
    let mut left = Vec::with_capacity(polygon.len() + 1);
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (here, next) = (m.dot(p) - level, m.dot(q) - level);
        if here >= 0.0 {
            left.push(*p);
        }
        if (here >= 0.0) != (next >= 0.0) {
            left.push(p + (q - p) * (here / (here - next)));
        }
    }
    left
}

/// Returns the point of a shape's surface that is nearest to a point, and the normal there.
fn foot(shape: &Shape, point: &Point3<f64>) -> Option<(Point3<f64>, Vector3<f64>)> {
    let (dot, at) = dot_at(point)?;
    let found = ShapeTracker::new().closest(shape, &dot, &at);
    Some((found.point_on_a, found.normal.into_inner()))
}
