//! Engines of pairs with a compound or a mesh.

use alloc::boxed::Box;
use alloc::sync::Arc;

use super::borrowed_pair::BorrowedPair;
use super::engine::{Engine, WithCopies};
use crate::base::num::each::Each;
use crate::body::shape::Shape;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::PartsRef;
use crate::nonconvex::pieces::{Compound, CompoundTracker};
use crate::nonconvex::separation::{CompoundPair, MeshPair};
use crate::pair_tracker::geometry::{Borrowed, GeometryRef};

/// Two bodies of subshapes. A convex body is a compound of one piece, a single leaf with support
/// points.
pub(super) type PieceEngine = WithCopies<CompoundTracker, Compound>;

/// Two meshes, or a mesh and the mesh of a compound.
pub(super) type MeshEngine = WithCopies<MeshTracker, Mesh>;

/// Returns the engine of a pair without a surface; `None` if both bodies are convex.
pub(super) fn engine([a, b]: [GeometryRef<'_>; 2]) -> Option<Engine> {
    if a.kind().is_convex() && b.kind().is_convex() {
        return None;
    }
    if a.mesh().or(b.mesh()).is_some()
        && let (Some(x), Some(y)) = (as_mesh(a), as_mesh(b))
    {
        return Some(Engine::Meshes(Box::new(WithCopies::new([x, y]))));
    }
    Some(of_pieces([a, b]))
}

/// Returns the engine of two bodies of subshapes, in which a compound stays a compound against a
/// mesh.
pub(super) fn of_pieces(bodies: [GeometryRef<'_>; 2]) -> Engine {
    let piece = |shape: Arc<Shape>| Arc::new(Compound::from(Arc::unwrap_or_clone(shape)));
    let copies = bodies.each(|body| body.to_shape().map(piece));
    Engine::Pieces(Box::new(WithCopies::new(copies)))
}

/// Returns the mesh that equals a body that is not convex; `Some(None)` for a mesh itself.
///
/// Pieces that a mesh cannot represent (points, segments and needles) stay pieces.
fn as_mesh(body: GeometryRef<'_>) -> Option<Option<Arc<Mesh>>> {
    match body.0 {
        Borrowed::Mesh(_) => Some(None),
        Borrowed::Compound(body) => body.get().surface_mesh().map(|mesh| Some(Arc::new(mesh))),
        _ => None,
    }
}

impl PieceEngine {
    pub(super) fn borrow<'p>(&'p mut self, [a, b]: [GeometryRef<'p>; 2]) -> Option<BorrowedPair<'p>> {
        let parts = |body: GeometryRef<'p>, copy: &'p Option<Arc<Compound>>| match body.0 {
            Borrowed::Compound(body) => Some(PartsRef::Pieces(body.get())),
            Borrowed::Mesh(mesh) => Some(PartsRef::Mesh(mesh.get())),
            Borrowed::Cloud(cloud) => Some(PartsRef::Cloud(cloud.get())),
            _ => copy.as_deref().map(PartsRef::Pieces),
        };
        let [x, y] = &self.copies;
        let (a, b) = (parts(a, x)?, parts(b, y)?);
        let tracker = &mut self.tracker;
        Some(BorrowedPair::Pieces(CompoundPair { a, b, tracker }))
    }
}

impl MeshEngine {
    pub(super) fn borrow<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<BorrowedPair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.each(GeometryRef::mesh))?;
        Some(BorrowedPair::Meshes(MeshPair { a, b, tracker }))
    }
}
