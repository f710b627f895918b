//! Points inside both of two solids, as lower bounds of the penetration depth.
//!
//! Two kinds are found: the deepest point of one solid in the other, with the translation that
//! moves it out; and the midpoint of a segment of an edge of one solid that lies inside the other.
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
//! Let the inner body contain the ball around x. If x is inside a solid mesh, the mesh contains the
//! ball around x up to the foot. Two balls around one point share interior points until they are
//! moved by the sum of their radii. If x is outside, the foot is a point of the mesh that is
//! `radius - distance` deep in the ball. A vertex is a ball of radius zero. The bound holds for
//! every point tried.
//!
//! ```text
//!     +---------------+
//!     |  other body   |
//!   --x-------m-------x---  edge: it enters and leaves at x, and no vertex is inside
//!     |               |
//!     +---------------+
//! ```
//!
//! If edges cross and no vertex is inside, the midpoint of such a segment is a point inside both
//! bodies. It is a proposal: crossings are computed in rounded arithmetic, and the caller proves a
//! depth by convex regions around the point.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::cell::cell;
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Shape};
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::Placed;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::{Compound, Piece};
use crate::nonconvex::query::box_gaps::{BoundAim, WIDTH, bounds};
use crate::nonconvex::query::frame::split_pair;
use crate::nonconvex::query::state::PosedTrees;
use crate::nonconvex::query::triangle::{self, Triangle};
use crate::pair::outcome::{ContactState, Outcome};

/// Number of vertices of a mesh that are tested for a lower bound of the depth.
const DEEP_POINTS: usize = 2048;

/// Number of steps to the point of a piece that is deepest in a mesh.
///
/// One step finds the deepest point of a ball; more steps follow the faces of the mesh.
const SINKS: usize = 4;

/// A lower bound of a depth, and the translation of the inner body that ends the overlap found.
#[derive(Clone, Copy)]
pub(super) struct ProvenDepth {
    pub(super) depth: f64,
    pub(super) way: Vector3<f64>,
}

/// The inner body in the frame of the outer one, in stored units.
struct InnerPoints<'a> {
    body: PartsRef<'a>,
    place: &'a dyn Fn(&Vector3<f64>) -> Vector3<f64>,
    rotation: Matrix3<f64>,
    /// One stored unit in stored units of the outer body.
    scale: f64,
    /// Bound of the position error of a point.
    doubt: f64,
    /// Number of winding numbers computed.
    windings: u64,
}

/// Returns the deepest overlap, if an interior point is found, and the count of winding numbers.
///
/// The translation is that of B, in A's frame and the caller's unit.
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
            [in_a, a_in_b.in_mesh(b, in_a.map_or(0.0, |d| d.depth))]
        }
        (PartsRef::Mesh(a), PartsRef::Pieces(b)) => [b_in_a.in_mesh(a, 0.0), in_pieces(b, a, &a_in_b)],
        (PartsRef::Pieces(a), PartsRef::Mesh(b)) => [in_pieces(a, b, &b_in_a), a_in_b.in_mesh(b, 0.0)],
        // The elements of a cloud come as a compound, if any is near.
        (PartsRef::Cloud(_), _) | (_, PartsRef::Cloud(_)) => [None, None],
    };
    let in_b = in_b.map(|ProvenDepth { depth, way }| ProvenDepth {
        depth,
        way: rotation * -way,
    });
    let found = deeper_of(in_a, in_b);
    (found, b_in_a.windings + a_in_b.windings)
}

fn deeper(x: ProvenDepth, y: ProvenDepth) -> ProvenDepth {
    if x.depth < y.depth { y } else { x }
}

/// Returns the deeper of two overlaps, if there is one.
pub(super) fn deeper_of(x: Option<ProvenDepth>, y: Option<ProvenDepth>) -> Option<ProvenDepth> {
    x.into_iter().chain(y).reduce(deeper)
}

/// Keeps an overlap if it is valid and deeper than the previous one.
fn keep_deeper(best: &mut Option<ProvenDepth>, new: ProvenDepth) {
    if new.depth > 0.0 && best.is_none_or(|b| b.depth < new.depth) {
        *best = Some(new);
    }
}

/// Returns at most `DEEP_POINTS` vertices of a mesh, spread over the surface.
fn points(mesh: &Mesh) -> impl Iterator<Item = &Vector3<f64>> {
    let step = mesh.points.len().div_ceil(DEEP_POINTS);
    mesh.points.iter().step_by(step)
}

impl InnerPoints<'_> {
    /// Returns the deepest overlap with a mesh, in the mesh's frame and the caller's unit.
    ///
    /// For a vertex, only an overlap deeper than `floor` is returned.
    fn in_mesh(&mut self, outer: &Mesh, floor: f64) -> Option<ProvenDepth> {
        let (mut best, unit) = (None, outer.unit());
        match self.body {
            PartsRef::Mesh(mesh) => {
                let mut least = floor / unit;
                for place in points(mesh).map(|p| (self.place)(p)) {
                    if let Some((depth, out)) = self.deeper_point(outer, &place, least) {
                        least = depth;
                        best = Some(ProvenDepth {
                            depth: depth * unit,
                            way: out * ((depth + self.doubt) * unit),
                        });
                    }
                }
            }
            PartsRef::Pieces(body) => {
                let mut found = |depth: f64, way: Vector3<f64>| {
                    let new = ProvenDepth {
                        depth: depth * unit,
                        way: way * unit,
                    };
                    keep_deeper(&mut best, new);
                };
                for piece in body.pieces() {
                    self.sink(outer, piece, body.stored_unit(), &mut found);
                }
            }
            PartsRef::Cloud(_) => {}
        }
        best
    }

    /// Returns a lower bound of a point's depth inside a solid mesh, and the unit direction out.
    ///
    /// Returns `None` if the point is no deeper than `least`. All lengths are in stored units of
    /// the mesh. For most points, a triangle near them proves that they are no deeper than the
    /// deepest one so far.
    fn deeper_point(&mut self, mesh: &Mesh, place: &Vector3<f64>, least: f64) -> Option<(f64, Vector3<f64>)> {
        if !may_hold(mesh, place, 0.0) {
            return None;
        }
        let foot = mesh.nearest_beyond(place, least + self.doubt);
        let distance = sqrt(foot.square);
        let depth = distance - self.doubt;
        // The point is on its side of the surface beyond its position error.
        let is_deeper = depth > least && distance > 2.0 * self.doubt;
        (is_deeper && self.is_inside(mesh, place)).then(|| (depth, (foot.point - place) / distance))
    }

    /// Returns whether the winding number puts a point inside a solid mesh.
    fn is_inside(&mut self, mesh: &Mesh, place: &Vector3<f64>) -> bool {
        self.windings += 1;
        mesh.winding(place).is_some_and(|w| w != 0)
    }

    /// Returns a lower bound of the overlap of a ball with a solid mesh, and the unit direction
    /// out.
    ///
    /// The bound is negative if nothing is known. All lengths are in stored units of the mesh.
    fn ball(&mut self, mesh: &Mesh, centre: &Vector3<f64>, radius: f64) -> (f64, Vector3<f64>) {
        let (foot, doubt) = (mesh.nearest(centre), self.doubt);
        let distance = sqrt(foot.square);
        if !(distance > 0.0) {
            return (radius - doubt, Vector3::zeros());
        }
        let to_foot = (foot.point - centre) / distance;
        // The centre is on its side of the surface beyond its position error.
        let is_beyond = distance > 2.0 * doubt && may_hold(mesh, centre, 0.0);
        if is_beyond && self.is_inside(mesh, centre) {
            (radius + distance - doubt, to_foot)
        } else {
            (radius - distance - doubt, -to_foot)
        }
    }

    /// Calls `found` with overlaps of a piece and a mesh.
    ///
    /// They are overlaps of balls in the piece around the vertices, the centre, and points that are
    /// deepest along the direction out of the last ball.
    fn sink(&mut self, outer: &Mesh, piece: &Piece, unit: f64, found: &mut dyn FnMut(f64, Vector3<f64>)) {
        let rotation = self.rotation;
        let mut ask = |local: &Vector3<f64>, radius: f64| {
            let at = (piece.pose * Point3::from(*local)).coords / unit;
            let (depth, out) = self.ball(outer, &(self.place)(&at), radius / unit * self.scale);
            found(depth, out * (depth + self.doubt));
            out
        };
        let (shape, round) = (&piece.shape, piece.shape.rounding_radius());
        let middle = match shape.core() {
            Core::Polyhedron(body) => body.centroid().coords,
            _ => Vector3::zeros(),
        };
        let mut out = ask(
            &middle,
            depth_in(&mut ShapeTracker::new(), shape, &middle).map_or(0.0, |d| d.depth),
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

/// Returns whether the box of a mesh intersects a ball.
fn may_hold(mesh: &Mesh, centre: &Vector3<f64>, radius: f64) -> bool {
    (0..3).all(|k| centre[k] >= mesh.low[k] - radius && centre[k] <= mesh.high[k] + radius)
}

/// Returns the mesh vertex that is deepest in the pieces of a compound.
///
/// The result is in the compound's frame and the caller's unit.
fn in_pieces(outer: &Compound, mesh: &Mesh, inner: &InnerPoints) -> Option<ProvenDepth> {
    let unit = outer.stored_unit();
    let points: Vec<Point3<f64>> = points(mesh).map(|p| Point3::from((inner.place)(p) * unit)).collect();
    let mut best = None;
    for Piece { shape, pose, .. } in outer.pieces() {
        let (centre, radius) = shape.bounding_ball();
        let mut tracker = ShapeTracker::new();
        for p in points.iter().map(|p| pose.inverse_transform_point(p)) {
            if sqrt((p - centre).norm_squared()) < radius
                && let Some(ProvenDepth { depth, way }) = depth_in(&mut tracker, shape, &p.coords)
            {
                let new = ProvenDepth {
                    depth: depth - inner.doubt * unit,
                    way: pose.rotation * way,
                };
                keep_deeper(&mut best, new);
            }
        }
    }
    best
}

/// Returns a lower bound of a point's depth in a shape, and the translation out.
fn depth_in(tracker: &mut ShapeTracker, shape: &Shape, point: &Vector3<f64>) -> Option<ProvenDepth> {
    let dot = Shape::from(ConvexPolyhedron::origin());
    let at = RelativePose::from_isometry(&Isometry3::translation(point.x, point.y, point.z)).ok()?;
    overlap(&tracker.closest(shape, &dot, &at))
}

/// Returns the overlap of an outcome, and the translation of B that ends the overlap.
fn overlap(found: &Outcome) -> Option<ProvenDepth> {
    let is_deep = found.state == ContactState::Overlapping && found.upper < 0.0;
    is_deep.then(|| ProvenDepth {
        depth: -found.upper,
        way: found.normal.into_inner() * -found.distance,
    })
}

/// Convex regions inside A and inside B, each with its pose in the frame of its body.
pub(super) type Regions = [Vec<(Shape, Isometry3<f64>)>; 2];

/// Returns the overlap of convex regions of both bodies around a point, and its translation of B.
///
/// See [`regions`].
pub(super) fn of_parts<A: Parted, B: Parted>(
    a: &A,
    b: &B,
    pose: &RelativePose,
    point: &Point3<f64>,
    reach: f64,
) -> Option<ProvenDepth> {
    of_regions(a, b, &regions(a, b, pose, point, reach)?, pose)
}

/// Returns convex regions of both bodies around a point.
///
/// The point is in A's frame. Regions of meshes extend at most `reach`. All lengths are in the
/// caller's unit.
pub(super) fn regions<A: Parted, B: Parted>(
    a: &A,
    b: &B,
    pose: &RelativePose,
    point: &Point3<f64>,
    reach: f64,
) -> Option<Regions> {
    let posed = PosedTrees::new(a, b, pose)?;
    let place = point.coords / a.stored_unit();
    let of_a = about(a.by_kind(), &place, reach / a.stored_unit());
    let of_b = about(b.by_kind(), &posed.back(&place), reach / b.stored_unit());
    Some([of_a, of_b])
}

/// Returns the overlap of regions of both bodies at a pose, and its translation of B.
pub(super) fn of_regions<A: Parted, B: Parted>(
    a: &A,
    b: &B,
    [of_a, of_b]: &Regions,
    pose: &RelativePose,
) -> Option<ProvenDepth> {
    of_pairs(of_a, of_b, &Placed::of(pose, a, b))
}

/// Returns the convex regions around the centres of meshes, and all pieces of compounds.
pub(super) fn whole_regions<A: Parted, B: Parted>(a: &A, b: &B) -> Regions {
    [wholes(a.by_kind()), wholes(b.by_kind())]
}

/// Returns the overlap of the convex region around the centre of a mesh with the other body.
///
/// The other body is a piece, or the same region of another mesh. The result has the translation of
/// B, in the caller's unit. It is `None` for two compounds, which [`deepest`] measures whole.
pub(super) fn of_wholes<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> Option<ProvenDepth> {
    match (a.by_kind(), b.by_kind()) {
        (PartsRef::Pieces(_), PartsRef::Pieces(_)) => None,
        (of_a, of_b) => of_pairs(&wholes(of_a), &wholes(of_b), &Placed::of(pose, a, b)),
    }
}

/// Returns the convex region of a mesh around its centre, or all pieces.
fn wholes(body: PartsRef) -> Vec<(Shape, Isometry3<f64>)> {
    match body {
        PartsRef::Mesh(mesh) => {
            let size = 2.0 * mesh.half_size() / mesh.unit();
            about(body, &(mesh.centroid().coords / mesh.unit()), size)
        }
        PartsRef::Pieces(body) => body.pieces().iter().map(|p| (p.shape.clone(), p.pose)).collect(),
        PartsRef::Cloud(_) => Vec::new(),
    }
}

/// Returns the deepest overlap of pairs of posed convex bodies.
fn of_pairs(
    of_a: &[(Shape, Isometry3<f64>)],
    of_b: &[(Shape, Isometry3<f64>)],
    placed: &Placed,
) -> Option<ProvenDepth> {
    let mut best = None;
    for (p, at_p) in of_a {
        for (q, at_q) in of_b {
            let at = placed.between(at_p, at_q).0;
            if let Some(ProvenDepth { depth, way }) = overlap(&ShapeTracker::new().closest(p, q, &at)) {
                let way = at_p.rotation * way;
                keep_deeper(&mut best, ProvenDepth { depth, way });
            }
        }
    }
    best
}

/// Returns convex regions of a body around a point in stored coordinates, with their poses.
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
        PartsRef::Cloud(_) => Vec::new(),
    }
}

/// Maximum number of edge segments whose midpoints are tested.
const DEEP_STRETCHES: usize = 128;

/// Maximum number of pairs of leaves that are searched for edges that cross the other mesh.
///
/// A pin in a slot has a few tens. Meshes at the same position have one for each pair of
/// neighbours.
const CROSSED_LEAVES: usize = 1 << 14;

/// A point of both bodies in A's frame, and the number of winding numbers computed.
///
/// The point comes with its approximate depth in one of the bodies, in the caller's unit.
type InnerMiddle = (Option<(Point3<f64>, f64)>, u64);

/// A point on an edge: the vertices of the edge, and the fraction of its length.
///
/// The lower vertex is first. The unit normal is that of a triangle at the edge.
type EdgePart = ([u32; 2], f64, Vector3<f64>);

/// Returns the deepest midpoint of a segment of an edge inside the other body.
///
/// Returns `None` if a body has curved pieces.
pub(super) fn deepest_middle<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> InnerMiddle {
    match (a.by_kind(), b.by_kind()) {
        (PartsRef::Mesh(a), PartsRef::Mesh(b)) => of_meshes(a, b, pose),
        (PartsRef::Mesh(a), PartsRef::Pieces(b)) => b.to_mesh().map_or((None, 0), |b| of_meshes(a, &b, pose)),
        (PartsRef::Pieces(a), PartsRef::Mesh(b)) => a.to_mesh().map_or((None, 0), |a| of_meshes(&a, b, pose)),
        (PartsRef::Pieces(a), PartsRef::Pieces(b)) => match (a.to_mesh(), b.to_mesh()) {
            (Ok(a), Ok(b)) => of_meshes(&a, &b, pose),
            _ => (None, 0),
        },
        (PartsRef::Cloud(_), _) | (_, PartsRef::Cloud(_)) => (None, 0),
    }
}

fn of_meshes(a: &Mesh, b: &Mesh, pose: &RelativePose) -> InnerMiddle {
    let Some(posed) = PosedTrees::new(a, b, pose) else {
        return (None, 0);
    };
    let [of_a, of_b] = crossings(&posed);
    let (frame, mut windings) = (&posed.frame, 0);
    let mut best: Option<(Vector3<f64>, Vector3<f64>, f64)> = None;
    let in_b = middles(a, of_a).into_iter().map(|(p, inward)| (p, inward, true));
    let in_a = middles(b, of_b)
        .into_iter()
        .map(|(p, inward)| (frame.point(&p), inward, false));
    for (on_a, inward, is_of_a) in in_b.chain(in_a) {
        let (outer, scale) = if is_of_a { (b, frame.scale) } else { (a, 1.0) };
        let place = if is_of_a { posed.back(&on_a) } else { on_a };
        let least = (best.map_or(0.0, |b| b.2) + 2.0 * frame.error) / scale;
        let depth = sqrt(outer.nearest_beyond(&place, least).square);
        if depth > least {
            windings += 1;
            if outer.winding(&place).is_some_and(|w| w != 0) {
                best = Some((on_a, inward, depth * scale));
            }
        }
    }
    // Moved off the surface of the edge's body by at most half the depth.
    let given = |(p, inward, depth): (Vector3<f64>, Vector3<f64>, f64)| {
        (a.given(&(p + inward * (0.5 * depth))), depth * a.unit())
    };
    (best.map(given), windings)
}

/// Returns where edges of A and of B pass through triangles of the other mesh, up to rounding.
fn crossings(posed: &PosedTrees<Mesh, Mesh>) -> [Vec<EdgePart>; 2] {
    let (a, b, frame) = (posed.a, posed.b, &posed.frame);
    let (of_a, of_b) = (&a.tree, &b.tree);
    let aim = BoundAim::to(frame.single.error.next_up());
    let (mut stack, mut found, mut leaves) = (alloc::vec![[0, 0]], [Vec::new(), Vec::new()], 0);
    while !stack.is_empty() && leaves < CROSSED_LEAVES {
        let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
        let gaps = bounds(&frame.single, [of_a, of_b], &batch, &aim);
        for (&pair, gap) in batch.iter().zip(gaps.gap) {
            if gap > frame.single.error {
                continue;
            }
            match split_pair([of_a, of_b], frame, pair) {
                Some(two) => stack.extend(two),
                None => {
                    leaves += 1;
                    of_leaves(posed, pair, &mut found);
                }
            }
        }
    }
    found
}

fn of_leaves(posed: &PosedTrees<Mesh, Mesh>, [x, y]: NodePair, found: &mut [Vec<EdgePart>; 2]) {
    let (a, b) = (posed.a, posed.b);
    let (of_a, of_b) = (a.tree.range(x), b.tree.range(y));
    for u in of_b {
        let q = b.corners(u).each(|p| posed.frame.point(&p));
        for t in of_a.clone() {
            let p = a.corners(t);
            through(a.triangles[t as usize], &p, &q, &mut found[0]);
            through(b.triangles[u as usize], &q, &p, &mut found[1]);
        }
    }
}

/// Adds the points where edges of a triangle pass through another triangle, boundary included.
fn through(vertices: [u32; 3], x: &Triangle, [a, b, c]: &Triangle, found: &mut Vec<EdgePart>) {
    let normal = (b - a).cross(&(c - a));
    let heights = x.each(|p| normal.dot(&(p - a)));
    for i in 0..3 {
        let k = (i + 1) % 3;
        if !(heights[i] * heights[k] <= 0.0 && heights[i] != heights[k]) {
            continue;
        }
        let along = x[k] - x[i];
        let turn = |p: &Vector3<f64>, q: &Vector3<f64>| (p - x[i]).cross(&(q - x[i])).dot(&along);
        let turns = [turn(a, b), turn(b, c), turn(c, a)];
        if turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0) {
            let (part, own) = (heights[i] / (heights[i] - heights[k]), triangle::normal(x));
            let own = own / sqrt(own.norm_squared());
            found.push(if vertices[i] < vertices[k] {
                ([vertices[i], vertices[k]], part, own)
            } else {
                ([vertices[k], vertices[i]], 1.0 - part, own)
            });
        }
    }
}

/// Returns the midpoints of all segments of an edge between crossings, ends included.
///
/// They are in stored coordinates, each with an inward direction in the frame of the crossings. If
/// there are many, only some of them are returned.
fn middles(mesh: &Mesh, mut crossings: Vec<EdgePart>) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    sort(&mut crossings, |x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
    let mut all = Vec::new();
    for on_edge in crossings.chunk_by(|x, y| x.0 == y.0) {
        let [from, to] = on_edge[0].0.each(|v| mesh.points[v as usize]);
        // From the normals of both triangles at the edge.
        let inward = -on_edge.iter().map(|x| x.2).sum::<Vector3<f64>>() / on_edge.len() as f64;
        let mut last = 0.0;
        for part in on_edge.iter().map(|x| x.1).chain([1.0]) {
            if part > last {
                all.push((from + (to - from) * (0.5 * (last + part)), inward));
            }
            last = part;
        }
    }
    let step = all.len().div_ceil(DEEP_STRETCHES).max(1);
    all.into_iter().step_by(step).collect()
}
