//! Pairs with a surface of patches.

use alloc::boxed::Box;
use alloc::sync::Arc;

use nalgebra::Point3;

use super::engine::BodyShapes;
#[cfg(feature = "serde")]
use super::mixed::StoredTracker;
use super::pair::Asked;
use super::tracked::{AnyKinds, PairOfKinds, Tracked, counters};
use super::work::PairWork;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::{Operand, RelativePose};
use crate::body::shape::Shape;
use crate::composite::mesh::Mesh;
use crate::composite::pieces::Composite;
use crate::composite::separation::ball_about;
use crate::pair::outcome::Decision;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::pair_tracker::geometry::{GeometryRef, Lent};
use crate::patch::{
    BesideSurface, Surface, SurfaceCompositeTracker, SurfacePair, SurfaceShapeTracker, SurfaceSolidPair, SurfaceTracker,
};

/// The surface that stands for a mesh, and the fingerprint of the mesh with its vertices then.
type MadeSurface = (Fingerprint, Arc<Surface>);

/// Two surfaces, or a surface and a mesh for which one stands.
#[derive(Clone, Debug, Default)]
pub(super) struct TrackedSurfaces {
    pub(super) tracker: SurfaceTracker,
    stand_ins: [Option<MadeSurface>; 2],
}

impl TrackedSurfaces {
    /// Makes the surface that stands for a mesh, and again if the mesh has bent since.
    fn follow(&mut self, (a, b): BodyShapes<'_>) {
        for (own, stand_in) in [a, b].into_iter().zip(&mut self.stand_ins) {
            let Some(mesh) = own.mesh() else { continue };
            if stand_in.as_ref().is_none_or(|(of, _)| *of != mesh.fingerprint) {
                *stand_in = as_surface(mesh).map(|surface| (mesh.fingerprint, surface));
            }
        }
    }
}

/// Returns the surface itself, or the one that stands for a mesh.
fn surface_of<'p>(own: GeometryRef<'p>, stand_in: Option<&'p MadeSurface>) -> Option<&'p Surface> {
    own.surface().or(stand_in.map(|(_, surface)| surface.as_ref()))
}

/// A surface and a convex shape, in either order.
type TrackedSurfaceAndShape = Tracked<SurfaceShapeTracker, Shape>;

/// A surface and a body of pieces, in either order.
type TrackedSurfaceAndPieces = Tracked<SurfaceCompositeTracker, Composite>;

/// Returns a tracker of a pair with a surface; `None` for any other pair.
pub(super) fn tracker((a, b): BodyShapes<'_>) -> Option<Box<dyn AnyKinds>> {
    use Lent::{Composite as C, Mesh as M, Surface as S};
    match (a.0, b.0) {
        (S(_), S(_) | M(_)) | (M(_), S(_)) => Some(Box::<TrackedSurfaces>::default()),
        (S(_), C(_)) | (C(_), S(_)) => Some(TrackedSurfaceAndPieces::new([None, None])),
        (S(_), _) | (_, S(_)) => Some(TrackedSurfaceAndShape::new([
            a.polyhedron_as_shape(),
            b.polyhedron_as_shape(),
        ])),
        _ => None,
    }
}

/// Returns the surface that stands for a mesh; `None` for a mesh of coordinates that are too large
/// for surfaces, and for all other geometries.
fn as_surface(mesh: &Mesh) -> Option<Arc<Surface>> {
    Surface::from_mesh(mesh).ok().map(Arc::new)
}

/// Returns the surface of a pair with one, the other geometry, and which of both is the surface.
fn surface_first<'a>((a, b): BodyShapes<'a>) -> Option<(&'a Surface, GeometryRef<'a>, Operand)> {
    match (a.surface(), b.surface()) {
        (Some(surface), _) => Some((surface, b, Operand::A)),
        (None, Some(surface)) => Some((surface, a, Operand::B)),
        (None, None) => None,
    }
}

/// Returns the ball of the surface of a pair, or of the other body.
fn ball_of<T: BesideSurface>(
    surface: &Surface,
    is_surface: bool,
    other: Option<&T::Body>,
) -> Option<(Point3<f64>, f64)> {
    if is_surface {
        Some(surface.bounding_ball())
    } else {
        other.map(T::ball)
    }
}

impl PairOfKinds for TrackedSurfaces {
    type Pair<'p> = SurfacePair<'p>;

    fn pair<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<SurfacePair<'p>> {
        self.follow((a, b));
        let of_a = a.mesh().map(|mesh| (Operand::A, mesh));
        let mesh = of_a.or(b.mesh().map(|mesh| (Operand::B, mesh)));
        let [x, y] = &self.stand_ins;
        Some(SurfacePair {
            a: surface_of(a, x.as_ref())?,
            b: surface_of(b, y.as_ref())?,
            mesh,
            tracker: &mut self.tracker,
        })
    }

    fn ball(&self, (a, b): BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        let own = if of == Operand::A { a } else { b };
        let stand_in = self.stand_ins[usize::from(of == Operand::B)].as_ref();
        // A mesh that no query has seen as it is now.
        let is_new = |mesh: &&Mesh| stand_in.is_none_or(|(of, _)| *of != mesh.fingerprint);
        match own.mesh().filter(is_new) {
            Some(mesh) => Some(ball_about(mesh.aabb())),
            None => surface_of(own, stand_in).map(Surface::bounding_ball),
        }
    }

    counters!(of_surfaces, Patches);
}

impl TrackedSurfaceAndShape {
    /// Returns the shape beside the surface, or the one that stands for a polyhedron.
    fn shape<'p>(stand_ins: &'p [Option<Arc<Shape>>; 2], own: GeometryRef<'p>) -> Option<&'p Shape> {
        let [x, y] = stand_ins;
        own.shape().or(x.as_deref()).or(y.as_deref())
    }
}

impl PairOfKinds for TrackedSurfaceAndShape {
    type Pair<'p> = SurfaceSolidPair<'p, SurfaceShapeTracker>;

    fn pair<'p>(&'p mut self, bodies: BodyShapes<'p>) -> Option<Self::Pair<'p>> {
        let (surface, other, order) = surface_first(bodies)?;
        Some(SurfaceSolidPair {
            surface,
            body: Self::shape(&self.stand_ins, other)?,
            order,
            tracker: &mut self.tracker,
        })
    }

    fn ball(&self, bodies: BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        let (surface, other, order) = surface_first(bodies)?;
        ball_of::<SurfaceShapeTracker>(surface, of == order, Self::shape(&self.stand_ins, other))
    }

    counters!(of_surfaces, Patches);
}

impl PairOfKinds for TrackedSurfaceAndPieces {
    type Pair<'p> = SurfaceSolidPair<'p, SurfaceCompositeTracker>;

    fn pair<'p>(&'p mut self, bodies: BodyShapes<'p>) -> Option<Self::Pair<'p>> {
        let (surface, other, order) = surface_first(bodies)?;
        Some(SurfaceSolidPair {
            surface,
            body: other.composite()?,
            order,
            tracker: &mut self.tracker,
        })
    }

    fn ball(&self, bodies: BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        let (surface, other, order) = surface_first(bodies)?;
        ball_of::<SurfaceCompositeTracker>(surface, of == order, other.composite())
    }

    counters!(of_surfaces, Patches);
}

impl Asked for SurfacePair<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }
}

impl<T: BesideSurface> Asked for SurfaceSolidPair<'_, T> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }
}
