//! Engines of pairs with a compound or a mesh.

use alloc::boxed::Box;
use alloc::sync::Arc;

#[cfg(feature = "serde")]
use super::engine::StoredEngine;
use super::engine::{Engine, EngineReport, WithStandIns};
use super::lent_pair::LentPair;
use super::tracker::PairWork;
use crate::base::num::each::Each;
use crate::body::shape::Shape;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::PartsRef;
use crate::nonconvex::pieces::{Compound, CompoundTracker};
use crate::nonconvex::separation::{CompoundPair, MeshPair};
use crate::pair_tracker::geometry::{GeometryRef, Lent};

/// Two bodies of subshapes. A convex body is a compound of one piece, a single leaf with support
/// points.
pub(super) type PieceEngine = WithStandIns<CompoundTracker, Compound>;

/// Two meshes, or a mesh and the mesh of a compound.
pub(super) type MeshEngine = WithStandIns<MeshTracker, Mesh>;

/// Returns the engine of a pair without a surface; `None` if both bodies are convex.
pub(super) fn engine([a, b]: [GeometryRef<'_>; 2]) -> Option<Engine> {
    if a.kind().is_convex() && b.kind().is_convex() {
        return None;
    }
    if a.mesh().or(b.mesh()).is_some()
        && let (Some(x), Some(y)) = (as_mesh(a), as_mesh(b))
    {
        return Some(Engine::Meshes(Box::new(WithStandIns::new([x, y]))));
    }
    Some(of_pieces([a, b]))
}

/// Returns the engine of two bodies of subshapes, in which a compound stays a compound against a
/// mesh.
pub(super) fn of_pieces(bodies: [GeometryRef<'_>; 2]) -> Engine {
    let piece = |shape: Arc<Shape>| Arc::new(Compound::from(Arc::unwrap_or_clone(shape)));
    let stand_ins = bodies.each(|body| body.to_shape().map(piece));
    Engine::Pieces(Box::new(WithStandIns::new(stand_ins)))
}

/// Returns the mesh that equals a body that is not convex; `Some(None)` for a mesh itself.
///
/// Pieces that a mesh cannot represent (points, segments and needles) stay pieces.
fn as_mesh(body: GeometryRef<'_>) -> Option<Option<Arc<Mesh>>> {
    match body.0 {
        Lent::Mesh(_) => Some(None),
        Lent::Compound(body) => body.get().stand_in().map(|mesh| Some(Arc::new(mesh))),
        _ => None,
    }
}

/// Implements the report and the serialised form of engines with a front.
macro_rules! report_front {
    ($work:ident, $stored:ident) => {
        pub(super) fn report(&self) -> EngineReport {
            EngineReport {
                work: PairWork::$work(self.tracker.work()),
                front_len: self.tracker.front_len(),
                memory_usage: size_of::<Self>() + self.tracker.memory_usage(),
            }
        }

        #[cfg(feature = "serde")]
        pub(super) fn stored(&self, parts: [u32; 2]) -> StoredEngine {
            StoredEngine::$stored(parts)
        }
    };
}

pub(super) use report_front;

impl PieceEngine {
    pub(super) fn lend<'p>(&'p mut self, [a, b]: [GeometryRef<'p>; 2]) -> Option<LentPair<'p>> {
        let parts = |body: GeometryRef<'p>, stand_in: &'p Option<Arc<Compound>>| match body.0 {
            Lent::Compound(body) => Some(PartsRef::Pieces(body.get())),
            Lent::Mesh(mesh) => Some(PartsRef::Mesh(mesh.get())),
            Lent::Cloud(cloud) => Some(PartsRef::Cloud(cloud.get())),
            _ => stand_in.as_deref().map(PartsRef::Pieces),
        };
        let [x, y] = &self.stand_ins;
        let (a, b) = (parts(a, x)?, parts(b, y)?);
        let tracker = &mut self.tracker;
        Some(LentPair::Pieces(CompoundPair { a, b, tracker }))
    }

    report_front!(of_trees, Pieces);
}

impl MeshEngine {
    pub(super) fn lend<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<LentPair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.each(GeometryRef::mesh))?;
        Some(LentPair::Meshes(MeshPair { a, b, tracker }))
    }

    report_front!(of_trees, Triangles);
}
