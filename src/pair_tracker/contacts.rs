//! Contacts of two geometries of any kinds.

use alloc::vec::Vec;

use super::engine::BodyShapes;
use crate::composite::contact::{ContactPatches, ContactTracker, PatchContact, PatchContacts};
use crate::contact::{Manifold, ManifoldOptions};
use crate::geometry::{GeometryRef, Lent};
use crate::pose::RelativePose;

/// The contacts of a pair with a composite or a mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundContacts {
    tracker: ContactTracker,
    /// The patches of bodies for which the caller has none.
    stand_ins: [Option<ContactPatches>; 2],
}

impl FoundContacts {
    /// Returns the contacts of two bodies at a pose; `None` if one of both can have none. The patches
    /// of bodies without are made here, once.
    pub(super) fn find(
        &mut self,
        bodies: BodyShapes<'_>,
        patches: [Option<&ContactPatches>; 2],
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> Option<&[PatchContacts]> {
        for (k, own) in [bodies.0, bodies.1].into_iter().enumerate() {
            if patches[k].is_none() && self.stand_ins[k].is_none() {
                self.stand_ins[k] = patches_of(own);
            }
        }
        let [x, y] = &self.stand_ins;
        let (x, y) = (patches[0].or(x.as_ref())?, patches[1].or(y.as_ref())?);
        Some(self.tracker.contacts(x, y, pose, options))
    }

    pub(super) fn found(&self) -> &[PatchContacts] {
        self.tracker.found()
    }
}

/// Returns the patches of a body; `None` for a surface, which bears no contacts.
pub(crate) fn patches_of(own: GeometryRef) -> Option<ContactPatches> {
    match own.0 {
        Lent::Mesh(mesh) => Some(ContactPatches::of_mesh(mesh.to_arc())),
        Lent::Composite(body) => Some(ContactPatches::of_pieces(body.to_arc())),
        Lent::Polyhedron(_) | Lent::Convex(_) => own.to_shape().map(|s| ContactPatches::from((*s).clone())),
        Lent::Surface(_) => None,
    }
}

/// The contacts of two convex bodies: their manifold, and the same points as those of one patch
/// each.
#[derive(Clone, Debug, Default)]
pub(super) struct ConvexContacts {
    pub(super) manifold: Manifold,
    found: Vec<PatchContacts>,
}

impl ConvexContacts {
    /// Returns the points of the manifold.
    pub(super) fn found(&mut self) -> &[PatchContacts] {
        let normal = self.manifold.normal();
        let contact = |point: &_| PatchContact {
            patches: [0; 2],
            normal,
            point: *point,
        };
        let points = self.manifold.points();
        if points.is_empty() {
            self.found.clear();
            return &self.found;
        }
        let mut contacts = self.found.pop().map(|group| group.contacts).unwrap_or_default();
        contacts.clear();
        contacts.extend(points.iter().map(contact));
        self.found.push(PatchContacts { normal, contacts });
        &self.found
    }
}
