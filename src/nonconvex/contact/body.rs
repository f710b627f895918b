//! A body for contact queries: the convex patches of a mesh, or the pieces of a compound.
//!
//! For a union of pieces, this module decides which points of a piece are on the surface of the
//! union, and how far a point inside is from that surface. A face of a piece is on the surface
//! where no other piece covers it. Cutting a convex piece out of a convex polygon leaves the
//! regions of the polygon outside each plane of the piece; each region is convex again.

use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Vector3};

use super::patches::{PatchedMesh, Valid};
use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::tangents_of;
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::{Compound, Piece};
use crate::nonconvex::query::frame::TreeSide;
use crate::nonconvex::query::triangle;

/// Convex patches of a mesh's surface, or the pieces of a [`Compound`], for contact queries.
///
/// Build it once for each body.
/// [`PairTracker::contacts_between`](crate::PairTracker::contacts_between) finds the contacts of
/// two of them. The patches of a closed mesh face away from its inside, also if its triangles face
/// inward. Those of an open mesh face as its triangles do: a body that touches an open mesh from
/// behind has no contact.
#[derive(Clone, Debug)]
pub struct ConvexPatches {
    /// The body in a frame about its stored origin, if that is far from the caller's.
    body: PatchedBody,
    fingerprint: Fingerprint,
    /// The origin of this frame in the caller's.
    origin: Vector3<f64>,
    /// Whether a piece has no faces, so that its nearest surface points are known to bounds alone.
    pub(super) is_curved: bool,
}

/// Returns the fingerprint of the patches of a mesh for a tolerance in stored units.
fn of_mesh(mesh: &Mesh, tolerance: f64) -> Fingerprint {
    mesh.fingerprint.with(*b"patches ", tolerance)
}

#[derive(Clone, Debug)]
enum PatchedBody {
    Mesh(Arc<PatchedMesh>),
    Pieces(Arc<Compound>, f64),
}

impl ConvexPatches {
    /// Returns the convex patches of a mesh.
    ///
    /// A flat region or a convex body is one patch, regardless of its number of triangles. Saddles
    /// and walls seen from inside give small patches.
    ///
    /// The error of convexity is at most `64 * 2^-53` times the radius of the mesh about its
    /// reference point (see the [front page](crate)). This is the rounding error of a rotated mesh
    /// in double precision.
    #[must_use]
    pub fn from_mesh(mesh: impl Into<Arc<Mesh>>) -> Self {
        Self::from_mesh_within(mesh, 0.0)
    }

    /// Returns the patches of a mesh that are convex within a tolerance, in the caller's unit.
    ///
    /// Use it for meshes stored in single precision, with a tolerance of about 1e-6 times the size
    /// of the mesh. Reflex edges that are shallower than the tolerance have contacts as if they
    /// were flat.
    #[must_use]
    pub fn from_mesh_within(mesh: impl Into<Arc<Mesh>>, tolerance: f64) -> Self {
        let mesh: Arc<Mesh> = mesh.into();
        let (stored, origin) = (tolerance.at_least(0.0) / mesh.unit(), mesh.frame.origin);
        let fingerprint = of_mesh(&mesh, stored);
        let near = if mesh.frame.is_at_origin() {
            mesh
        } else {
            Arc::new(mesh.centred())
        };
        Self {
            body: PatchedBody::Mesh(Arc::new(PatchedMesh::new(near, stored))),
            fingerprint,
            origin,
            is_curved: false,
        }
    }

    /// Returns whether these are the patches of the mesh in its current state, without a tolerance.
    pub(crate) fn are_of(&self, mesh: &Mesh) -> bool {
        self.fingerprint == of_mesh(mesh, 0.0)
    }

    /// Returns the pieces of a compound as its convex patches.
    ///
    /// Where pieces meet or overlap, only the outside of the union has contacts.
    #[must_use]
    pub fn from_compound(body: impl Into<Arc<Compound>>) -> Self {
        Self::from_compound_within(body, 0.0)
    }

    /// Returns the pieces of a compound as its patches, with a tolerance in the caller's unit.
    ///
    /// Pieces closer than the tolerance count as meeting. Use it for decompositions whose pieces do
    /// not fit exactly.
    #[must_use]
    pub fn from_compound_within(body: impl Into<Arc<Compound>>, tolerance: f64) -> Self {
        let (body, tolerance): (Arc<Compound>, f64) = (body.into(), tolerance.at_least(0.0));
        let fingerprint = body.fingerprint().with(*b"patches ", tolerance);
        let (frame, is_near) = (body.side().frame, body.is_near());
        let near = if is_near { body } else { Arc::new(body.centred()) };
        Self {
            is_curved: near.pieces().iter().any(|piece| solid_core(&piece.shape).is_none()),
            body: PatchedBody::Pieces(near, tolerance),
            fingerprint,
            origin: frame.origin,
        }
    }

    /// Returns the number of patches or pieces.
    #[must_use]
    pub fn count(&self) -> usize {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.count(),
            PatchedBody::Pieces(body, _) => body.pieces().len(),
        }
    }

    /// Returns the caller's indices of the triangles of a patch; empty for pieces.
    pub fn triangles(&self, patch: u32) -> impl Iterator<Item = u32> + '_ {
        let surface = match &self.body {
            PatchedBody::Mesh(surface) => Some(&**surface),
            PatchedBody::Pieces(..) => None,
        };
        let named = move |s: &'_ PatchedMesh| -> Vec<u32> {
            let source = &s.given.source_triangles;
            s.triangles(patch).iter().map(|&t| source[t as usize]).collect()
        };
        surface.map(named).unwrap_or_default().into_iter()
    }

    pub(super) fn side(&self) -> TreeSide<'_> {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.side(),
            PatchedBody::Pieces(body, _) => body.side(),
        }
    }

    pub(super) fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// Returns the origin of the frame of these patches in the caller's frame.
    pub(super) fn origin(&self) -> &Vector3<f64> {
        &self.origin
    }

    pub(super) fn unit(&self) -> f64 {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.given.unit(),
            PatchedBody::Pieces(body, _) => body.stored_unit(),
        }
    }

    pub(super) fn is_in_place(&self) -> bool {
        match &self.body {
            PatchedBody::Mesh(_) => true,
            PatchedBody::Pieces(body, _) => body.is_in_place(),
        }
    }

    pub(super) fn is_mesh(&self) -> bool {
        matches!(self.body, PatchedBody::Mesh(_))
    }

    /// Returns whether the convex bodies of all patches are parts of the body.
    pub(super) fn is_whole(&self) -> bool {
        !self.is_mesh() || self.count() == 1
    }

    pub(super) fn parts(&self) -> PartsRef<'_> {
        match &self.body {
            PatchedBody::Mesh(surface) => PartsRef::Mesh(&surface.given),
            PatchedBody::Pieces(body, _) => PartsRef::Pieces(body),
        }
    }

    /// Returns the patch of a point of the surface, or the piece that contains the point.
    ///
    /// The point is in the caller's unit.
    pub(super) fn patch_at(&self, piece: u32, point: &Point3<f64>) -> u32 {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.patch_at(point),
            PatchedBody::Pieces(..) => piece,
        }
    }

    /// Returns the patch of an item of the tree.
    pub(super) fn patch(&self, item: u32) -> u32 {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.patch_of_item(item),
            PatchedBody::Pieces(body, _) => body.number(item),
        }
    }

    /// Returns the convex body of a patch, and its pose in the body's frame.
    pub(super) fn part(&self, patch: u32) -> Option<(Shape, Isometry3<f64>)> {
        match &self.body {
            PatchedBody::Mesh(surface) => Some((surface.hull(patch)?, Isometry3::identity())),
            PatchedBody::Pieces(body, _) => {
                let piece = body.pieces().get(patch as usize)?;
                Some((piece.shape.clone(), piece.pose))
            }
        }
    }

    /// Returns whether a normal in the body's frame is the normal of a face of a patch.
    pub(super) fn has_face(&self, patch: u32, n: &Vector3<f64>) -> bool {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.has_face(patch, n),
            PatchedBody::Pieces(..) => true,
        }
    }

    /// Returns whether a point is at the end of the region where a piece has valid contacts.
    ///
    /// The contacts are along an outward normal; point and normal are in the body's frame. The
    /// region is closed.
    pub(super) fn ends(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, doubt: f64) -> bool {
        matches!(&self.body, PatchedBody::Pieces(body, tolerance) if is_end(body, patch, point, n, tolerance + doubt))
    }

    /// Returns whether a contact at a point along an outward normal is valid on a patch.
    ///
    /// Point and normal are in the body's frame and the caller's unit.
    pub(super) fn how_valid(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, sine: f64, doubt: f64) -> Valid {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.how_valid(patch, point, n, sine, doubt),
            PatchedBody::Pieces(body, tolerance) => {
                if is_covered(body, patch, point, n, tolerance + doubt) {
                    Valid::No
                } else {
                    Valid::Fully
                }
            }
        }
    }

    /// Returns whether no surface of the body is nearer than `depth` to a point inside.
    ///
    /// The point is in the frame of the patch's convex body.
    pub(super) fn is_clear(&self, patch: u32, point: &Point3<f64>, depth: f64, doubt: f64) -> bool {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.is_clear(point, depth),
            PatchedBody::Pieces(body, tolerance) => is_clear(body, patch, point, depth, tolerance + doubt),
        }
    }

    /// Returns whether the surface of the body is nearer than `reach` to a point in the body's
    /// frame.
    pub(super) fn is_near(&self, point: &Point3<f64>, reach: f64, doubt: f64) -> bool {
        match &self.body {
            PatchedBody::Mesh(surface) => !surface.is_clear(point, reach),
            PatchedBody::Pieces(body, tolerance) => is_near(body, &point.coords, reach, tolerance + doubt),
        }
    }

    /// Returns whether the body contains a point in its frame; false for an open mesh.
    pub(super) fn holds(&self, point: &Point3<f64>, doubt: f64) -> bool {
        match &self.body {
            PatchedBody::Mesh(surface) => surface.holds(point),
            PatchedBody::Pieces(body, tolerance) => {
                // A single piece has no other.
                let first = &body.pieces()[0];
                is_in(
                    &first.shape,
                    &first.pose.inverse_transform_point(point),
                    tolerance + doubt,
                ) || other(body, 0, point, tolerance + doubt, |_, _| true).is_some()
            }
        }
    }

    /// Returns what is at a point in the plane of a patch's face but outside the face.
    ///
    /// The point is in the body's frame.
    pub(super) fn under(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, doubt: f64) -> Under {
        match &self.body {
            PatchedBody::Mesh(surface) if surface.is_below(point, doubt) => Under::Body,
            PatchedBody::Mesh(_) => Under::Unknown,
            PatchedBody::Pieces(body, tolerance) => under(body, patch, point, n, tolerance + doubt),
        }
    }

    /// Returns whether the path from a point of the surface to a point below it leaves the body.
    pub(super) fn is_left(&self, from: &Point3<f64>, to: &Point3<f64>, doubt: f64) -> bool {
        matches!(&self.body, PatchedBody::Mesh(surface) if surface.is_left(from, to, doubt))
    }
}

impl From<Shape> for ConvexPatches {
    /// Returns a convex body as its only patch.
    fn from(shape: Shape) -> Self {
        Self::from_compound(Compound::from(shape))
    }
}

/// Distance, in units of the slack, at which the neighbourhood of a covered point is tested.
///
/// If a point of the same face at that distance is not covered, the covered point is at an end.
/// Faces that meet at less than one radian divided by this number count as one face.
const BESIDE_END: f64 = 64.0;

/// What is at a point in the plane of a face, outside the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Under {
    /// The inside of the body: the face ends in a valley.
    Body,
    /// Another face in the same plane.
    Face,
    /// Nothing, or nothing known.
    Unknown,
}

/// Returns whether another piece contains the point and extends higher along the normal.
///
/// If so, the union does not have this normal there.
fn is_covered(body: &Compound, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> bool {
    cover(body, of, point, n, slack).is_some()
}

/// Returns another piece that covers a point of a piece.
pub(super) fn cover<'a>(
    body: &'a Compound,
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

/// Returns whether a covered point of a face is at the end of the uncovered region of the face.
///
/// This is so if some point of the face near this point is not covered.
fn is_end(body: &Compound, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> bool {
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

/// Returns what is at a point in the plane of a face of a piece.
pub(super) fn under(body: &Compound, of: u32, point: &Point3<f64>, n: &Vector3<f64>, slack: f64) -> Under {
    if is_covered(body, of, point, n, slack) {
        Under::Body
    } else if other(body, of, point, slack, |_, _| true).is_some() {
        Under::Face
    } else {
        Under::Unknown
    }
}

/// Returns another piece that contains the point and passes a test.
///
/// The test gets the point in that piece's frame.
fn other<'a>(
    body: &'a Compound,
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
    if let (Some(core), 0.0) = (solid_core(shape), shape.rounding_radius()) {
        let planes = core.faces().filter_map(|face| core.face_plane(face));
        return planes
            .into_iter()
            .all(|(n, offset)| n.dot(&point.coords) - offset <= slack);
    }
    dot_at(point).is_some_and(|(dot, at)| ShapeTracker::new().within(shape, &dot, &at, slack))
}

/// Returns the core of a shape if it is a polyhedron with a volume.
fn solid_core(shape: &Shape) -> Option<&ConvexPolyhedron> {
    match shape.core() {
        Core::Polyhedron(core) if core.face_count() >= 4 => Some(core),
        _ => None,
    }
}

/// Returns a point as a shape, and its pose.
fn dot_at(point: &Point3<f64>) -> Option<(Shape, RelativePose)> {
    let dot = ConvexPolyhedron::origin();
    let at = RelativePose::from_isometry(&Isometry3::translation(point.x, point.y, point.z)).ok()?;
    Some((Shape::from(dot), at))
}

/// Maximum number of pieces that are cut out of a face to find its uncovered region.
const COVERS: usize = 4;

/// Returns whether the surface of the union is at least `depth` away from a point inside.
///
/// Faces, and nearest points of curved pieces, decide this. The point is in the frame of one of the
/// pieces and `depth` below its core.
pub(super) fn is_clear(body: &Compound, of: u32, point: &Point3<f64>, depth: f64, slack: f64) -> bool {
    let own = &body.pieces()[of as usize];
    if body.pieces().len() == 1 {
        let Core::Polyhedron(core) = own.shape.core() else {
            return true;
        };
        return core.faces().all(|face| {
            let plane = core.face_plane(face);
            plane.is_none_or(|(n, offset)| offset - n.dot(&point.coords) >= depth - own.shape.rounding_radius())
        });
    }
    !is_near(
        body,
        &(own.pose * point).coords,
        depth + own.shape.rounding_radius(),
        slack,
    )
}

/// Returns whether the surface of the union is nearer than `reach` to a point in the body's frame.
fn is_near(body: &Compound, point: &Vector3<f64>, reach: f64, slack: f64) -> bool {
    let (unit, place) = (body.stored_unit(), *point);
    let near = NearPoint {
        body,
        place,
        reach,
        slack,
    };
    let is_exposed = |item: u32| near.is_exposed(body.number(item));
    body.side().tree.any_near(&(place / unit), reach / unit, is_exposed)
}

/// A point inside a body, with the body; the point is in the body's frame.
struct NearPoint<'a> {
    body: &'a Compound,
    place: Vector3<f64>,
    reach: f64,
    slack: f64,
}

impl NearPoint<'_> {
    /// Returns whether an uncovered point of a piece's surface is within the depth.
    fn is_exposed(&self, of: u32) -> bool {
        let piece = &self.body.pieces()[of as usize];
        let Some(core) = solid_core(&piece.shape) else {
            return self.is_foot_exposed(of, piece);
        };
        core.faces().any(|face| {
            let Some((n, offset)) = core.face_plane(face) else {
                return false;
            };
            let out = piece.pose * n.into_inner();
            let height =
                out.dot(&(self.place - piece.pose.translation.vector)) - offset - piece.shape.rounding_radius();
            height.abs() < self.reach && self.is_left(of, &out, &rim(piece, core, face, &out), COVERS)
        })
    }

    /// Returns whether an uncovered region of a face is within the depth.
    fn is_left(&self, of: u32, n: &Vector3<f64>, polygon: &[Vector3<f64>], covers: usize) -> bool {
        let (square, foot) = nearest(polygon, &self.place);
        if !(square < self.reach * self.reach) {
            return false;
        }
        let away = self.place - foot;
        let height = n.dot(&away);
        let normal = if height > 0.0 { away / sqrt(square) } else { *n };
        let cover = |normal| cover(self.body, of, &Point3::from(foot), normal, self.slack);
        // Within the slack this direction is that of rounding, so the face must be covered along
        // its normal as well.
        let is_flush = height > 0.0 && height <= self.slack;
        let Some(by) = cover(&normal).filter(|_| !is_flush || cover(n).is_some()) else {
            return true;
        };
        let (Core::Polyhedron(core), 0.0, 1..) = (by.shape.core(), by.shape.rounding_radius(), covers) else {
            return false;
        };
        core.faces().any(|face| {
            let Some((m, offset)) = core.face_plane(face) else {
                return false;
            };
            let m = by.pose * m.into_inner();
            let level = offset + m.dot(&by.pose.translation.vector) + 2.0 * self.slack;
            let left = beyond(polygon, &m, level);
            left.len() > 2 && self.is_left(of, n, &left, covers - 1)
        })
    }

    /// Returns whether the nearest point of a curved shape is within the depth and not covered.
    fn is_foot_exposed(&self, of: u32, Piece { shape, pose, .. }: &Piece) -> bool {
        let foot = foot(shape, &pose.inverse_transform_point(&Point3::from(self.place)));
        foot.is_some_and(|(foot, n)| {
            let at = pose * foot;
            let is_near = (at.coords - self.place).norm_squared() < self.reach * self.reach;
            is_near && !is_covered(self.body, of, &at, &(pose * n), self.slack)
        })
    }
}

/// Returns the vertices of a face of a piece, in the body's frame.
///
/// They are moved outward by the rounding radius of the piece.
fn rim(piece: &Piece, core: &ConvexPolyhedron, face: FaceId, n: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let corners = core.face_vertices(face).filter_map(|v| core.vertex(v));
    corners
        .map(|p| (piece.pose * p).coords + n * piece.shape.rounding_radius())
        .collect()
}

/// Returns the squared distance of a point from a convex polygon, and the nearest point of the
/// polygon.
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

/// Returns the region of a convex polygon above a plane.
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
