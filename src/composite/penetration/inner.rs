//! The deepest inner point that two solids share, and the translation that frees the bodies of it.
//!
//! ```text
//!            way
//!             ^      outer mesh
//!   ----------|--------------------   foot
//!        .    |    .                  |
//!      .      |      .                | distance
//!      .      x------.                centre of a ball of the inner body
//!        .    radius                  way = distance + radius, if x is inside the mesh;
//!           .   .                     way = radius - distance, if x is outside
//! ```
//!
//! Let the inner body hold the ball about x. If x is inside a solid mesh, the mesh holds the ball
//! about x up to the foot, and two balls about one point share inner points until they are moved by
//! the sum of their radii. If x is outside, the foot is a point of the mesh that is
//! `radius - distance` deep in the ball. A vertex is a ball of radius zero. So none of the points
//! that are tried need be a good one.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::cell::cell;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Shape};
use crate::composite::meet::state::PosedTrees;
use crate::composite::mesh::Mesh;
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::pieces::{Composite, Piece};
use crate::composite::placement::Placed;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::{Class, Outcome};

/// Vertices of a mesh that are looked at for a lower bound of the depth. Not measured.
const DEEP_POINTS: usize = 2048;

/// Steps to the point of a piece that is deepest in a mesh. One finds the deepest point of a ball;
/// more turn with the faces of the mesh. Not measured.
const SINKS: usize = 4;

/// A lower bound of a depth, and the translation of the inner body that ends the overlap found.
pub(super) type ProvenDepth = (f64, Vector3<f64>);

/// The inner body seen from the frame of the outer one, in stored units.
struct InnerPoints<'a> {
    body: PartsRef<'a>,
    place: &'a dyn Fn(&Vector3<f64>) -> Vector3<f64>,
    rotation: Matrix3<f64>,
    /// One stored unit in the outer body's.
    scale: f64,
    /// By how much a place may be off.
    doubt: f64,
    /// Winding numbers taken.
    windings: u64,
}

/// Returns the deepest overlap found, with the translation of B, in A's frame and the caller's
/// unit, if an inner point is found; and the winding numbers taken.
pub(super) fn deepest<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> (Option<ProvenDepth>, u64) {
    let Some(posed) = PosedTrees::new(a, b, pose) else {
        return (None, 0);
    };
    let (rotation, scale, doubt) = (posed.frame.rotation, posed.frame.scale, 2.0 * posed.frame.error);
    let mut b_in_a = InnerPoints {
        body: b.by_kind(),
        place: &|p| posed.frame.point(p),
        rotation,
        scale,
        doubt,
        windings: 0,
    };
    let mut a_in_b = InnerPoints {
        body: a.by_kind(),
        place: &|p| posed.back(p),
        rotation: rotation.transpose(),
        scale: 1.0 / scale,
        doubt: doubt / scale,
        windings: 0,
    };
    let [in_a, in_b] = match (a.by_kind(), b.by_kind()) {
        (PartsRef::Pieces(a), PartsRef::Pieces(b)) => {
            let placed = Placed::of(pose, a, b);
            [of_pairs(&wholes(a.by_kind()), &wholes(b.by_kind()), &placed), None]
        }
        (PartsRef::Mesh(a), PartsRef::Mesh(b)) => {
            let in_a = b_in_a.in_mesh(a, 0.0);
            [in_a, a_in_b.in_mesh(b, in_a.map_or(0.0, |d| d.0))]
        }
        (PartsRef::Mesh(a), PartsRef::Pieces(b)) => [b_in_a.in_mesh(a, 0.0), in_pieces(b, a, &a_in_b)],
        (PartsRef::Pieces(a), PartsRef::Mesh(b)) => [in_pieces(a, b, &b_in_a), a_in_b.in_mesh(b, 0.0)],
    };
    let in_b = in_b.map(|(depth, way)| (depth, rotation * -way));
    let found = in_a.into_iter().chain(in_b).reduce(deeper);
    (found, b_in_a.windings + a_in_b.windings)
}

fn deeper(x: ProvenDepth, y: ProvenDepth) -> ProvenDepth {
    if x.0 < y.0 { y } else { x }
}

/// Adds an overlap if it is one, and deeper than the one before.
fn keep_deeper(best: &mut Option<ProvenDepth>, new: ProvenDepth) {
    if new.0 > 0.0 && best.is_none_or(|b| b.0 < new.0) {
        *best = Some(new);
    }
}

/// Some thousand vertices of a mesh, spread over the surface.
fn points(mesh: &Mesh) -> impl Iterator<Item = &Vector3<f64>> {
    let step = mesh.points.len().div_ceil(DEEP_POINTS);
    mesh.points.iter().step_by(step)
}

impl InnerPoints<'_> {
    /// Returns the deepest overlap with a mesh, in the mesh's frame and the caller's unit; of a
    /// vertex only if it is deeper than `floor`.
    fn in_mesh(&mut self, outer: &Mesh, floor: f64) -> Option<ProvenDepth> {
        let (mut best, unit) = (None, outer.unit());
        match self.body {
            PartsRef::Mesh(mesh) => {
                let mut least = floor / unit;
                for place in points(mesh).map(|p| (self.place)(p)) {
                    if let Some((depth, out)) = self.deeper_point(outer, &place, least) {
                        least = depth;
                        best = Some((depth * unit, out * ((depth + self.doubt) * unit)));
                    }
                }
            }
            PartsRef::Pieces(body) => {
                let mut found = |depth: f64, way: Vector3<f64>| keep_deeper(&mut best, (depth * unit, way * unit));
                for piece in body.pieces() {
                    self.sink(outer, (piece, body.stored_unit()), &mut found);
                }
            }
        }
        best
    }

    /// Returns how deep a point is inside a solid mesh, at least, and the unit direction of the way
    /// out; `None` if it is no deeper than `least`. All in stored units of the mesh.
    ///
    /// Of most points a triangle near them shows that they are no deeper than the deepest before.
    fn deeper_point(&mut self, mesh: &Mesh, place: &Vector3<f64>, least: f64) -> Option<ProvenDepth> {
        if !may_hold(mesh, place, 0.0) {
            return None;
        }
        let foot = mesh.nearest_beyond(place, least + self.doubt);
        let distance = sqrt(foot.square);
        let depth = distance - self.doubt;
        // Beyond doubt, the point is on its side of the surface.
        let is_deeper = depth > least && distance > 2.0 * self.doubt;
        (is_deeper && self.is_inside(mesh, place)).then(|| (depth, (foot.point - place) / distance))
    }

    /// Returns whether a point is inside a solid mesh by its winding number.
    fn is_inside(&mut self, mesh: &Mesh, place: &Vector3<f64>) -> bool {
        self.windings += 1;
        mesh.winding(place).is_some_and(|w| w != 0)
    }

    /// Returns how deep a ball overlaps a solid mesh, at least; negative if nothing is known. And
    /// the unit direction in which the ball leaves. All in stored units of the mesh.
    fn ball(&mut self, mesh: &Mesh, centre: &Vector3<f64>, radius: f64) -> (f64, Vector3<f64>) {
        let (foot, doubt) = (mesh.nearest(centre), self.doubt);
        let distance = sqrt(foot.square);
        if !(distance > 0.0) {
            return (radius - doubt, Vector3::zeros());
        }
        let to_foot = (foot.point - centre) / distance;
        // Beyond doubt, the centre is on its side of the surface.
        let is_beyond = distance > 2.0 * doubt && may_hold(mesh, centre, 0.0);
        if is_beyond && self.is_inside(mesh, centre) {
            (radius + distance - doubt, to_foot)
        } else {
            (radius - distance - doubt, -to_foot)
        }
    }

    /// Calls `found` with overlaps of a piece and a mesh: of balls in the piece about the vertices,
    /// the middle, and points that lie deepest along the way out of the last one.
    fn sink(&mut self, outer: &Mesh, (piece, unit): (&Piece, f64), found: &mut dyn FnMut(f64, Vector3<f64>)) {
        let rotation = self.rotation;
        let mut ask = |local: &Vector3<f64>, radius: f64| {
            let at = (piece.pose * Point3::from(*local)).coords / unit;
            let (depth, out) = self.ball(outer, &(self.place)(&at), radius / unit * self.scale);
            found(depth, out * (depth + self.doubt));
            out
        };
        let (shape, round) = (&piece.shape, piece.shape.round());
        let middle = match shape.core() {
            Core::Polyhedron(body) => body.centroid().coords,
            _ => Vector3::zeros(),
        };
        let mut out = ask(
            &middle,
            depth_in(&mut ShapeTracker::new(), shape, &middle).map_or(0.0, |d| d.0),
        );
        for _ in 0..SINKS {
            let down = piece.pose.rotation.inverse_transform_vector(&-rotation.tr_mul(&out));
            out = ask(&shape.core_point(&down).1, round);
        }
        if let Core::Polyhedron(body) = shape.core() {
            let step = body.vertex_count().div_ceil(DEEP_POINTS);
            for p in body.vertex_points().step_by(step) {
                ask(&p.coords, round);
            }
        }
    }
}

/// Returns whether the box of a mesh meets a ball.
fn may_hold(mesh: &Mesh, centre: &Vector3<f64>, radius: f64) -> bool {
    (0..3).all(|k| centre[k] >= mesh.low[k] - radius && centre[k] <= mesh.high[k] + radius)
}

/// Returns the deepest of a mesh's vertices in the pieces of a body, in the body's frame and the
/// caller's unit.
fn in_pieces(outer: &Composite, mesh: &Mesh, inner: &InnerPoints) -> Option<ProvenDepth> {
    let unit = outer.stored_unit();
    let points: Vec<Point3<f64>> = points(mesh).map(|p| Point3::from((inner.place)(p) * unit)).collect();
    let mut best = None;
    for Piece { shape, pose, .. } in outer.pieces() {
        let (centre, radius) = shape.bounding_ball();
        let mut tracker = ShapeTracker::new();
        for p in points.iter().map(|p| pose.inverse_transform_point(p)) {
            if sqrt((p - centre).norm_squared()) < radius
                && let Some((depth, way)) = depth_in(&mut tracker, shape, &p.coords)
            {
                keep_deeper(&mut best, (depth - inner.doubt * unit, pose.rotation * way));
            }
        }
    }
    best
}

/// Returns how deep a point is in a shape, at least, and the way out.
fn depth_in(tracker: &mut ShapeTracker, shape: &Shape, point: &Vector3<f64>) -> Option<ProvenDepth> {
    let dot = Shape::from(ConvexPolyhedron::point(Point3::origin()).ok()?);
    let at = RelativePose::from_isometry(&Isometry3::translation(point.x, point.y, point.z)).ok()?;
    overlap(&tracker.closest(shape, &dot, &at))
}

/// Returns the overlap of an outcome, and the translation of B that ends the overlap.
fn overlap(found: &Outcome) -> Option<ProvenDepth> {
    let is_deep = found.class == Class::Overlapping && found.upper < 0.0;
    is_deep.then(|| (-found.upper, found.normal.into_inner() * -found.distance))
}

/// Returns the overlap of convex parts of both bodies about a point in A's frame, and its
/// translation of B; parts of meshes are at most `reach` wide. All in the caller's unit.
pub(super) fn of_parts<A: Parted, B: Parted>(
    (a, b): (&A, &B),
    pose: &RelativePose,
    point: &Point3<f64>,
    reach: f64,
) -> Option<ProvenDepth> {
    let posed = PosedTrees::new(a, b, pose)?;
    let (placed, place) = (Placed::of(pose, a, b), point.coords / a.stored_unit());
    let of_a = about(a.by_kind(), &place, reach / a.stored_unit());
    let of_b = about(b.by_kind(), &posed.back(&place), reach / b.stored_unit());
    of_pairs(&of_a, &of_b, &placed)
}

/// Returns the overlap of the convex part about the middle of a mesh with a piece, or with the same
/// part of another mesh, and its translation of B, in the caller's unit. `None` for two bodies of
/// pieces, which [`deepest`] measures whole.
pub(super) fn of_wholes<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> Option<ProvenDepth> {
    match (a.by_kind(), b.by_kind()) {
        (PartsRef::Pieces(_), PartsRef::Pieces(_)) => None,
        (of_a, of_b) => of_pairs(&wholes(of_a), &wholes(of_b), &Placed::of(pose, a, b)),
    }
}

/// Returns the convex part of a mesh about its middle, or all pieces.
fn wholes(body: PartsRef) -> Vec<(Shape, Isometry3<f64>)> {
    match body {
        PartsRef::Mesh(mesh) => {
            let size = 2.0 * mesh.half_size() / mesh.unit();
            about(body, &(mesh.centroid().coords / mesh.unit()), size)
        }
        PartsRef::Pieces(body) => body.pieces().iter().map(|p| (p.shape.clone(), p.pose)).collect(),
    }
}

/// Returns the deepest pair of placed convex bodies.
fn of_pairs(
    of_a: &[(Shape, Isometry3<f64>)],
    of_b: &[(Shape, Isometry3<f64>)],
    placed: &Placed,
) -> Option<ProvenDepth> {
    let mut best = None;
    for (p, at_p) in of_a {
        for (q, at_q) in of_b {
            let at = placed.between(at_p, at_q).0;
            if let Some((depth, way)) = overlap(&ShapeTracker::new().closest(p, q, &at)) {
                keep_deeper(&mut best, (depth, at_p.rotation * way));
            }
        }
    }
    best
}

/// Convex parts of a body about a point in stored coordinates, with their poses.
fn about(body: PartsRef, place: &Vector3<f64>, reach: f64) -> Vec<(Shape, Isometry3<f64>)> {
    match body {
        PartsRef::Mesh(mesh) => {
            let part = cell(mesh, place, reach).map(|part| (part, Isometry3::identity()));
            part.into_iter().collect()
        }
        PartsRef::Pieces(body) => {
            let point = Point3::from(place * body.stored_unit());
            let holds = |p: &&Piece| {
                let local = p.pose.inverse_transform_point(&point);
                depth_in(&mut ShapeTracker::new(), &p.shape, &local.coords).is_some()
            };
            let pieces = body.pieces().iter().filter(holds);
            pieces.map(|p| (p.shape.clone(), p.pose)).collect()
        }
    }
}
