//! A body as its contacts see it: the convex patches of a mesh, or the pieces of a composite.

use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Vector3};

use super::clear::is_clear;
use super::surface::{Borne, PatchedMesh};
use super::union::{Under, is_covered, is_end, under};
use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::body::shape::Shape;
use crate::composite::meet::frame::TreeSide;
use crate::composite::mesh::Mesh;
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::pieces::Composite;

/// A body as its contacts see it: convex patches of a mesh's surface, or the pieces of a
/// [`Composite`].
///
/// Built once for each body;
/// [`PairTracker::contacts_between`](crate::PairTracker::contacts_between) finds the contacts of
/// two. The patches of a mesh face outward, whether the mesh is closed or not: a body that touches
/// an open mesh from behind has no contact.
#[derive(Clone, Debug)]
pub struct ContactPatches(PatchedBody, Fingerprint);

/// Returns the fingerprint of the patches of a mesh, by a tolerance in stored units.
fn of_mesh(mesh: &Mesh, tolerance: f64) -> Fingerprint {
    mesh.fingerprint.with(*b"patches ", tolerance)
}

#[derive(Clone, Debug)]
enum PatchedBody {
    Surface(Arc<PatchedMesh>),
    Pieces(Arc<Composite>, f64),
}

impl ContactPatches {
    /// Returns the patches of a mesh. Flat regions and convex bodies are one patch each, however
    /// finely they are cut into triangles; saddles and walls seen from inside give small patches.
    ///
    /// Patches are convex to `64 * 2^-53` times the radius of the mesh about its origin, the
    /// rounding of a mesh in double precision that was turned.
    #[must_use]
    pub fn of_mesh(mesh: impl Into<Arc<Mesh>>) -> Self {
        Self::of_mesh_within(mesh, 0.0)
    }

    /// Returns the patches of a mesh that are convex within a tolerance in the caller's unit, for
    /// meshes stored in single precision: some 1e-6 times the size of the mesh. Reflex edges that
    /// shallow bear contacts as if they were flat.
    #[must_use]
    pub fn of_mesh_within(mesh: impl Into<Arc<Mesh>>, tolerance: f64) -> Self {
        let mesh: Arc<Mesh> = mesh.into();
        let stored = tolerance.at_least(0.0) / mesh.unit();
        let fingerprint = of_mesh(&mesh, stored);
        Self(
            PatchedBody::Surface(Arc::new(PatchedMesh::new(mesh, stored))),
            fingerprint,
        )
    }

    /// Returns whether these are the patches of a mesh as it is, without a tolerance.
    pub(crate) fn are_of(&self, mesh: &Mesh) -> bool {
        self.1 == of_mesh(mesh, 0.0)
    }

    /// Returns the pieces of a body as its patches. Where pieces meet or overlap, only the outside
    /// of the whole bears contacts.
    #[must_use]
    pub fn of_pieces(body: impl Into<Arc<Composite>>) -> Self {
        Self::of_pieces_within(body, 0.0)
    }

    /// Returns the pieces of a body as its patches. Pieces closer than a tolerance, in the caller's
    /// unit, count as meeting: for decompositions whose pieces fit roughly.
    #[must_use]
    pub fn of_pieces_within(body: impl Into<Arc<Composite>>, tolerance: f64) -> Self {
        let (body, tolerance): (Arc<Composite>, f64) = (body.into(), tolerance.at_least(0.0));
        let fingerprint = body.fingerprint().with(*b"patches ", tolerance);
        Self(PatchedBody::Pieces(body, tolerance), fingerprint)
    }

    /// Returns the number of patches or pieces.
    #[must_use]
    pub fn count(&self) -> usize {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.count(),
            PatchedBody::Pieces(body, _) => body.pieces().len(),
        }
    }

    /// Returns the triangles of a patch by the caller's numbers; none for pieces.
    pub fn triangles(&self, patch: u32) -> impl Iterator<Item = u32> + '_ {
        let surface = match &self.0 {
            PatchedBody::Surface(surface) => Some(&**surface),
            PatchedBody::Pieces(..) => None,
        };
        let named = move |s: &'_ PatchedMesh| -> Vec<u32> {
            let source = &s.mesh.source_triangles;
            s.triangles(patch).iter().map(|&t| source[t as usize]).collect()
        };
        surface.map(named).unwrap_or_default().into_iter()
    }

    pub(super) fn side(&self) -> TreeSide<'_> {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.side(),
            PatchedBody::Pieces(body, _) => body.side(),
        }
    }

    pub(super) fn fingerprint(&self) -> Fingerprint {
        self.1
    }

    pub(super) fn unit(&self) -> f64 {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.mesh.unit(),
            PatchedBody::Pieces(body, _) => body.stored_unit(),
        }
    }

    pub(super) fn is_in_place(&self) -> bool {
        match &self.0 {
            PatchedBody::Surface(_) => true,
            PatchedBody::Pieces(body, _) => body.is_in_place(),
        }
    }

    pub(super) fn is_mesh(&self) -> bool {
        matches!(self.0, PatchedBody::Surface(_))
    }

    pub(super) fn parts(&self) -> PartsRef<'_> {
        match &self.0 {
            PatchedBody::Surface(surface) => PartsRef::Mesh(&surface.mesh),
            PatchedBody::Pieces(body, _) => PartsRef::Pieces(body),
        }
    }

    /// Returns the patch of a point of the surface, in the caller's unit, or the piece that holds
    /// it.
    pub(super) fn patch_at(&self, piece: u32, point: &Point3<f64>) -> u32 {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.patch_at(point),
            PatchedBody::Pieces(..) => piece,
        }
    }

    /// Returns the patch of an item of the tree.
    pub(super) fn patch(&self, item: u32) -> u32 {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.patch_of_item(item),
            PatchedBody::Pieces(body, _) => body.number(item),
        }
    }

    /// Returns the convex body of a patch, and its pose in the body's frame.
    pub(super) fn part(&self, patch: u32) -> Option<(Shape, Isometry3<f64>)> {
        match &self.0 {
            PatchedBody::Surface(surface) => Some((surface.hull(patch)?, Isometry3::identity())),
            PatchedBody::Pieces(body, _) => {
                let piece = body.pieces().get(patch as usize)?;
                Some((piece.shape.clone(), piece.pose))
            }
        }
    }

    /// Returns whether a normal in the body's frame is that of a face of a patch.
    pub(super) fn has_face(&self, patch: u32, n: &Vector3<f64>) -> bool {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.has_face(patch, n),
            PatchedBody::Pieces(..) => true,
        }
    }

    /// Returns whether a point along an outward normal is at the end of what a piece bears, both in
    /// the body's frame: what bears contacts is closed.
    pub(super) fn ends(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, doubt: f64) -> bool {
        matches!(&self.0, PatchedBody::Pieces(body, tolerance) if is_end(body, patch, point, n, tolerance + doubt))
    }

    /// Returns how far a patch bears a contact at a point along an outward normal, both in the
    /// body's frame and the caller's unit.
    pub(super) fn bears(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, (sine, doubt): (f64, f64)) -> Borne {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.bears(patch, point, n, (sine, doubt)),
            PatchedBody::Pieces(body, tolerance) => {
                if is_covered(body, patch, point, n, tolerance + doubt) {
                    Borne::No
                } else {
                    Borne::Fully
                }
            }
        }
    }

    /// Returns whether no surface of the body is nearer to a point inside than `depth`. The point
    /// is in the frame of the patch's part.
    pub(super) fn is_clear(&self, patch: u32, point: &Point3<f64>, (depth, doubt): (f64, f64)) -> bool {
        match &self.0 {
            PatchedBody::Surface(surface) => surface.is_clear(point, depth),
            PatchedBody::Pieces(body, tolerance) => is_clear(body, patch, point, (depth, tolerance + doubt)),
        }
    }

    /// Returns what is at a point of the plane of a patch's face, beyond the face, in the body's
    /// frame.
    pub(super) fn under(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, doubt: f64) -> Under {
        match &self.0 {
            PatchedBody::Surface(surface) if surface.is_below(point, doubt) => Under::Body,
            PatchedBody::Surface(_) => Under::Unknown,
            PatchedBody::Pieces(body, tolerance) => under(body, patch, point, n, tolerance + doubt),
        }
    }

    /// Returns whether the way from a point of the surface to a point below leaves the body.
    pub(super) fn is_left(&self, from: &Point3<f64>, to: &Point3<f64>, doubt: f64) -> bool {
        matches!(&self.0, PatchedBody::Surface(surface) if surface.is_left(from, to, doubt))
    }
}

impl From<Shape> for ContactPatches {
    /// Returns a convex body as its only patch.
    fn from(shape: Shape) -> Self {
        Self::of_pieces(Composite::from(shape))
    }
}
