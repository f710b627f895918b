//! Engines of pairs with a Bézier surface.

use alloc::boxed::Box;
use alloc::sync::Arc;

use super::borrowed_pair::BorrowedPair;
use super::engine::{Engine, WithCopies};
use crate::base::num::each::Each;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::Operand;
use crate::body::shape::Shape;
use crate::nonconvex::pieces::Compound;
use crate::pair_tracker::geometry::{Borrowed, GeometryRef};
use crate::surface::{
    BezierSurface, SurfaceCompoundTracker, SurfacePair, SurfaceShapeTracker, SurfaceSolidPair, SurfaceTracker,
};

/// Two surfaces, or a surface and a mesh, which is converted to a surface of flat patches.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceEngine {
    pub(super) tracker: SurfaceTracker,
    /// Each surface has the fingerprint that its mesh had when the surface was made.
    copies: [Option<(Fingerprint, Arc<BezierSurface>)>; 2],
}

/// A surface and a convex shape.
pub(super) type SurfaceShapeEngine = WithCopies<SurfaceShapeTracker, Shape>;

/// A surface and a compound, or a cloud that is converted to a compound.
pub(super) type SurfacePieceEngine = WithCopies<SurfaceCompoundTracker, Compound>;

/// Returns the engine of a pair with a surface; `None` for any other pair.
pub(super) fn engine([a, b]: [GeometryRef<'_>; 2]) -> Option<Engine> {
    let (_, other, _) = surface_first([a, b])?;
    Some(match other.0 {
        Borrowed::HalfSpace(_) => return None,
        Borrowed::BezierSurface(_) | Borrowed::Mesh(_) => Engine::Surfaces(Box::default()),
        Borrowed::Compound(_) => Engine::SurfaceAndPieces(Box::new(WithCopies::new([None, None]))),
        Borrowed::Cloud(_) => {
            let pieces = |body: GeometryRef<'_>| match body.0 {
                Borrowed::Cloud(cloud) => cloud.get().to_compound().ok().map(Arc::new),
                _ => None,
            };
            Engine::SurfaceAndPieces(Box::new(WithCopies::new([a, b].each(pieces))))
        }
        Borrowed::Polyhedron(_) | Borrowed::Convex(_) => {
            let copies = [a, b].each(GeometryRef::polyhedron_as_shape);
            Engine::SurfaceAndShape(Box::new(WithCopies::new(copies)))
        }
    })
}

/// Returns the surface of a pair, the other geometry, and which of the two is the surface.
fn surface_first<'p>([a, b]: [GeometryRef<'p>; 2]) -> Option<(&'p BezierSurface, GeometryRef<'p>, Operand)> {
    match (a.surface(), b.surface()) {
        (Some(surface), _) => Some((surface, b, Operand::A)),
        (None, Some(surface)) => Some((surface, a, Operand::B)),
        (None, None) => None,
    }
}

impl SurfaceEngine {
    /// Converts a mesh to a surface, and converts it again if its vertices have moved since.
    fn follow(&mut self, bodies: [GeometryRef<'_>; 2]) {
        for (body, copy) in bodies.into_iter().zip(&mut self.copies) {
            let Some(mesh) = body.mesh() else { continue };
            if copy.as_ref().is_none_or(|(of, _)| *of != mesh.fingerprint) {
                let surface = BezierSurface::from_mesh(mesh).ok();
                *copy = surface.map(|surface| (mesh.fingerprint, Arc::new(surface)));
            }
        }
    }

    /// Returns the pair; `None` for a mesh with coordinates that are too large for a surface.
    pub(super) fn borrow<'p>(&'p mut self, [a, b]: [GeometryRef<'p>; 2]) -> Option<BorrowedPair<'p>> {
        self.follow([a, b]);
        let [x, y] = self
            .copies
            .each_ref()
            .each(|s| s.as_ref().map(|(_, surface)| &**surface));
        let of_a = a.mesh().map(|mesh| (Operand::A, mesh));
        Some(BorrowedPair::Surfaces(SurfacePair {
            a: a.surface().or(x)?,
            b: b.surface().or(y)?,
            mesh: of_a.or(b.mesh().map(|mesh| (Operand::B, mesh))),
            tracker: &mut self.tracker,
        }))
    }
}

impl SurfaceShapeEngine {
    pub(super) fn borrow<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<BorrowedPair<'p>> {
        let [x, y] = &self.copies;
        let (surface, other, order) = surface_first(bodies)?;
        Some(BorrowedPair::SurfaceAndShape(SurfaceSolidPair {
            surface,
            body: other.shape().or(x.as_deref()).or(y.as_deref())?,
            order,
            tracker: &mut self.tracker,
        }))
    }
}

impl SurfacePieceEngine {
    pub(super) fn borrow<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<BorrowedPair<'p>> {
        let [x, y] = &self.copies;
        let (surface, other, order) = surface_first(bodies)?;
        Some(BorrowedPair::SurfaceAndPieces(SurfaceSolidPair {
            surface,
            body: other.compound().or(x.as_deref()).or(y.as_deref())?,
            order,
            tracker: &mut self.tracker,
        }))
    }
}
