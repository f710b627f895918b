//! The tracker of a pair that is not of two polyhedra: convex shapes, composites, meshes, surfaces
//! of patches.

use alloc::boxed::Box;
use alloc::sync::Arc;

use super::contacts::FoundContacts;
use super::engine::{BodyShapes, ContactAsk, Contacted, PairEngine};
use super::over::{Kinds, OverTime};
use super::pair::{Asked, BallPair, measured};
use super::work::PairWork;
use crate::base::pose::{Operand, RelativePose};
use crate::body::shape::Shape;
use crate::composite::contact::{ContactPatches, PatchContacts};
use crate::composite::mesh::Mesh;
use crate::composite::mesh::tracker::MeshTracker;
use crate::composite::parts::PartsRef;
use crate::composite::pieces::{Composite, CompositeTracker};
use crate::composite::separation::{CompositePair, MeshPair};
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::convex::replay::Replay;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::{Class, Outcome, Until};
use crate::pair::question::Question;
use crate::pair_tracker::geometry::{Geometry, GeometryRef, Lent};
use crate::patch::{
    Surface, SurfaceCompositeTracker, SurfacePair, SurfaceShapeTracker, SurfaceSolidPair, SurfaceTracker,
};
use crate::time::separation::{Measure, Separation, ShapePair, Tangent};

/// The tracker of a pair that is not of two polyhedra, the parts of the last measurement, and the
/// contacts if they are called for.
#[derive(Clone, Debug)]
pub(crate) struct MixedTracker {
    kinds: TrackedKinds,
    parts: [u32; 2],
    contacts: Option<Box<FoundContacts>>,
}

/// The trackers by the kinds of the pair.
#[derive(Clone, Debug)]
enum TrackedKinds {
    /// Two convex shapes.
    Convex(Box<Tracked<ShapeTracker, Shape>>),
    /// Two bodies of which one is a composite or a mesh, and the other of any kind: a convex body
    /// is a single leaf with its own support points.
    Pieces(Box<Tracked<CompositeTracker, Composite>>),
    /// Two meshes, or a mesh and a composite whose surface is one.
    Triangles(Box<Tracked<MeshTracker, Mesh>>),
    Surfaces(Box<Tracked<SurfaceTracker, Surface>>),
    /// A surface and a convex shape, in either order.
    SurfaceAndShape(Box<Tracked<SurfaceShapeTracker, Shape>>),
    /// A surface and a body of pieces, in either order.
    SurfaceAndPieces(Box<Tracked<SurfaceCompositeTracker, Composite>>),
}

/// A tracker of one kind.
#[derive(Clone, Debug)]
struct Tracked<T, S> {
    tracker: T,
    /// The body in the form in which the tracker takes it, for a body of another kind.
    stand_ins: [Option<Arc<S>>; 2],
}

impl<T: Default, S> Tracked<T, S> {
    fn new(stand_ins: [Option<Arc<S>>; 2]) -> Box<Self> {
        let tracker = T::default();
        Box::new(Self { tracker, stand_ins })
    }

    /// Returns the tracker and both bodies, their own or the stand-ins.
    fn sides<'p>(&'p mut self, own: [Option<&'p S>; 2]) -> Option<(&'p mut T, [&'p S; 2])> {
        let [x, y] = &self.stand_ins;
        let sides = [own[0].or(x.as_deref())?, own[1].or(y.as_deref())?];
        Some((&mut self.tracker, sides))
    }
}

impl Tracked<CompositeTracker, Composite> {
    /// Returns the tracker and both bodies of parts.
    fn parts<'p>(
        &'p mut self,
        a: GeometryRef<'p>,
        b: GeometryRef<'p>,
    ) -> Option<(&'p mut CompositeTracker, [PartsRef<'p>; 2])> {
        let [x, y] = &self.stand_ins;
        let side = |own: GeometryRef<'p>, stand_in: &'p Option<Arc<Composite>>| match own.0 {
            Lent::Composite(body) => Some(PartsRef::Pieces(body.get())),
            Lent::Mesh(mesh) => Some(PartsRef::Mesh(mesh.get())),
            _ => stand_in.as_deref().map(PartsRef::Pieces),
        };
        let sides = [side(a, x)?, side(b, y)?];
        Some((&mut self.tracker, sides))
    }
}

/// Returns the surface of a pair with one, the other geometry, and which of both is the surface.
fn surface_first<'a>(a: GeometryRef<'a>, b: GeometryRef<'a>) -> Option<(&'a Surface, GeometryRef<'a>, Operand)> {
    match (a.surface(), b.surface()) {
        (Some(surface), _) => Some((surface, b, Operand::A)),
        (None, Some(surface)) => Some((surface, a, Operand::B)),
        (None, None) => None,
    }
}

impl TrackedKinds {
    /// Returns a tracker without a start.
    fn new(a: GeometryRef, b: GeometryRef) -> Self {
        use Lent::{Composite as C, Mesh as M, Surface as S};
        match (a.0, b.0) {
            (S(_), S(_) | M(_)) | (M(_), S(_)) => Self::Surfaces(Tracked::new([as_surface(a), as_surface(b)])),
            (S(_), C(_)) | (C(_), S(_)) => Self::SurfaceAndPieces(Tracked::new([None, None])),
            (S(_), _) | (_, S(_)) => {
                Self::SurfaceAndShape(Tracked::new([a.polyhedron_as_shape(), b.polyhedron_as_shape()]))
            }
            (M(_), _) | (_, M(_)) => match (as_mesh(a), as_mesh(b)) {
                (Some(x), Some(y)) => Self::Triangles(Tracked::new([x, y])),
                _ => Self::of_pieces(a, b),
            },
            (C(_), _) | (_, C(_)) => Self::of_pieces(a, b),
            _ => Self::Convex(Tracked::new([a.polyhedron_as_shape(), b.polyhedron_as_shape()])),
        }
    }

    fn of_pieces(a: GeometryRef, b: GeometryRef) -> Self {
        let piece = |shape: Arc<Shape>| Arc::new(Composite::from(Arc::unwrap_or_clone(shape)));
        Self::Pieces(Tracked::new([a, b].map(|own| own.to_shape().map(piece))))
    }

    /// Returns the pair and the tracker; `None` for geometries of another pair.
    fn over<'p>(&'p mut self, a: GeometryRef<'p>, b: GeometryRef<'p>) -> Option<Kinds<'p>> {
        Some(match self {
            Self::Convex(tracked) => {
                let (tracker, [a, b]) = tracked.sides([a.shape(), b.shape()])?;
                Kinds::Convex(ShapePair::new(a, b, tracker))
            }
            Self::Pieces(tracked) => {
                let (tracker, [a, b]) = tracked.parts(a, b)?;
                Kinds::Pieces(CompositePair { a, b, tracker })
            }
            Self::Triangles(tracked) => {
                let (tracker, [a, b]) = tracked.sides([a.mesh(), b.mesh()])?;
                Kinds::Triangles(MeshPair { a, b, tracker })
            }
            Self::Surfaces(tracked) => {
                let of_a = a.mesh().map(|mesh| (Operand::A, mesh));
                let mesh = of_a.or(b.mesh().map(|mesh| (Operand::B, mesh)));
                let (tracker, [a, b]) = tracked.sides([a.surface(), b.surface()])?;
                Kinds::Surfaces(SurfacePair { a, b, mesh, tracker })
            }
            Self::SurfaceAndShape(tracked) => {
                let (surface, other, order) = surface_first(a, b)?;
                let [x, y] = &tracked.stand_ins;
                let shape = other.shape().or(x.as_deref()).or(y.as_deref())?;
                Kinds::SurfaceAndShape(SurfaceSolidPair {
                    surface,
                    body: shape,
                    order,
                    tracker: &mut tracked.tracker,
                })
            }
            Self::SurfaceAndPieces(tracked) => {
                let (surface, other, order) = surface_first(a, b)?;
                Kinds::SurfaceAndPieces(SurfaceSolidPair {
                    surface,
                    body: other.composite()?,
                    order,
                    tracker: &mut tracked.tracker,
                })
            }
        })
    }

    fn work(&self) -> PairWork {
        match self {
            Self::Convex(tracked) => PairWork::of_convex(tracked.tracker.work()),
            Self::Pieces(tracked) => PairWork::of_trees(tracked.tracker.work()),
            Self::Triangles(tracked) => PairWork::of_trees(tracked.tracker.work()),
            Self::Surfaces(tracked) => PairWork::of_surfaces(tracked.tracker.work()),
            Self::SurfaceAndShape(tracked) => PairWork::of_surfaces(tracked.tracker.work()),
            Self::SurfaceAndPieces(tracked) => PairWork::of_surfaces(tracked.tracker.work()),
        }
    }

    fn front_len(&self) -> usize {
        match self {
            Self::Convex(_) => 0,
            Self::Pieces(tracked) => tracked.tracker.front_len(),
            Self::Triangles(tracked) => tracked.tracker.front_len(),
            Self::Surfaces(tracked) => tracked.tracker.front_len(),
            Self::SurfaceAndShape(tracked) => tracked.tracker.front_len(),
            Self::SurfaceAndPieces(tracked) => tracked.tracker.front_len(),
        }
    }

    fn heap_bytes(&self) -> usize {
        fn all<T, S>(tracked: &Tracked<T, S>, kept: impl FnOnce(&T) -> usize) -> usize {
            size_of::<Tracked<T, S>>() + kept(&tracked.tracker)
        }
        match self {
            Self::Convex(tracked) => all(tracked, |_| 0),
            Self::Pieces(tracked) => all(tracked, CompositeTracker::heap_bytes),
            Self::Triangles(tracked) => all(tracked, MeshTracker::heap_bytes),
            Self::Surfaces(tracked) => all(tracked, SurfaceTracker::heap_bytes),
            Self::SurfaceAndShape(tracked) => all(tracked, SurfaceShapeTracker::heap_bytes),
            Self::SurfaceAndPieces(tracked) => all(tracked, SurfaceCompositeTracker::heap_bytes),
        }
    }
}

/// Returns the mesh that stands for a body that is not convex: `Some(None)` for the body itself.
fn as_mesh(own: GeometryRef) -> Option<Option<Arc<Mesh>>> {
    match own.0 {
        Lent::Mesh(_) => Some(None),
        Lent::Composite(body) => body.get().to_mesh().ok().map(|mesh| Some(Arc::new(mesh))),
        Lent::Polyhedron(_) | Lent::Convex(_) | Lent::Surface(_) => None,
    }
}

/// Returns the surface that stands for a mesh; `None` for a mesh of coordinates that are too large
/// for surfaces, and for all other geometries.
fn as_surface(own: GeometryRef) -> Option<Arc<Surface>> {
    Surface::from_mesh(own.mesh()?).ok().map(Arc::new)
}

impl MixedTracker {
    /// Returns a tracker without a start.
    pub(super) fn new(a: GeometryRef, b: GeometryRef) -> Self {
        Self {
            kinds: TrackedKinds::new(a, b),
            parts: [0; 2],
            contacts: None,
        }
    }

    /// Returns a tracker of two bodies of parts of which a composite stays one.
    pub(super) fn of_pieces(a: GeometryRef, b: GeometryRef) -> Self {
        Self {
            kinds: TrackedKinds::of_pieces(a, b),
            parts: [0; 2],
            contacts: None,
        }
    }

    /// Takes the recorded start of a query of two convex bodies.
    pub(super) fn begin_as(&mut self, replay: &Replay) {
        if let TrackedKinds::Convex(tracked) = &mut self.kinds {
            tracked.tracker = replay.shape_tracker();
        }
    }

    /// Returns the pair and the tracker.
    pub(super) fn over<'p>(&'p mut self, a: GeometryRef<'p>, b: GeometryRef<'p>) -> OverTime<'p> {
        let balls = || Kinds::Balls(BallPair::new(a, b));
        OverTime(self.kinds.over(a, b).unwrap_or_else(balls))
    }

    pub(super) fn work(&self) -> PairWork {
        self.kinds.work()
    }

    pub(super) fn front_len(&self) -> usize {
        self.kinds.front_len()
    }

    /// Returns the tracker of two meshes.
    pub(super) fn meshes(&self) -> Option<&MeshTracker> {
        match &self.kinds {
            TrackedKinds::Triangles(tracked) => Some(&tracked.tracker),
            _ => None,
        }
    }

    /// Returns the tracker of two surfaces.
    pub(super) fn surfaces(&self) -> Option<&SurfaceTracker> {
        match &self.kinds {
            TrackedKinds::Surfaces(tracked) => Some(&tracked.tracker),
            _ => None,
        }
    }

    /// Returns the tracker of two convex shapes, and the shapes.
    pub(super) fn convex<'p>(
        &'p mut self,
        a: GeometryRef<'p>,
        b: GeometryRef<'p>,
    ) -> Option<(&'p mut ShapeTracker, [&'p Shape; 2])> {
        match &mut self.kinds {
            TrackedKinds::Convex(tracked) => tracked.sides([a.shape(), b.shape()]),
            _ => None,
        }
    }

    /// Returns whether both bodies are convex.
    pub(super) fn is_convex(&self) -> bool {
        matches!(self.kinds, TrackedKinds::Convex(_))
    }

    /// Returns the contacts by patches; `None` for bodies without.
    pub(super) fn find_contacts(
        &mut self,
        bodies: BodyShapes<'_>,
        patches: [Option<&ContactPatches>; 2],
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> Option<&[PatchContacts]> {
        if !matches!(self.kinds, TrackedKinds::Pieces(_) | TrackedKinds::Triangles(_)) {
            return None;
        }
        self.contacts
            .get_or_insert_default()
            .find(bodies, patches, pose, options)
    }
}

/// Returns the measure of an outcome, which proves a distance.
fn measure_of(found: &Outcome) -> Measure {
    Measure {
        by_plane: false,
        ..Measure::new(found, Tangent::Free)
    }
}

impl PairEngine for MixedTracker {
    type Shapes<'a> = BodyShapes<'a>;

    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        Some((a.into(), b.into()))
    }

    fn measure(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, until: Until) -> Outcome {
        if let Some((tracker, [x, y])) = self.convex(a, b) {
            return measured(tracker, (x, y), pose, until);
        }
        let answer = self.over(a, b).answer(pose, &Question::new());
        self.parts = answer.parts();
        answer.outcome
    }

    fn decides_within(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        if outcome.class == Class::Overlapping || outcome.upper <= d {
            return true;
        }
        if outcome.lower > d {
            return false;
        }
        !self.over(a, b).within(pose, d, &Question::new()).is_no()
    }

    fn over_time<R>(
        &mut self,
        (a, b): Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measure>) -> R,
    ) -> R {
        ask(&mut self.over(a, b), seen.map(measure_of))
    }

    /// Convex shapes have a manifold, composites and meshes contacts by patches.
    fn update_manifold(
        &mut self,
        (a, b): Self::Shapes<'_>,
        pose: &RelativePose,
        ask: ContactAsk<'_>,
        stored: &mut Option<Box<Manifold>>,
    ) -> Contacted {
        let ContactAsk { options, patches, .. } = ask;
        if let Some((tracker, [x, y])) = self.convex(a, b) {
            let queries = tracker.work().queries;
            tracker.manifold(x, y, pose, options, stored.get_or_insert_default());
            // A manifold is rebuilt from a query.
            return if tracker.work().queries > queries {
                Contacted::Renewed
            } else {
                Contacted::Kept
            };
        }
        match self.find_contacts((a, b), patches, pose, options) {
            Some(_) => Contacted::Kept,
            None => Contacted::Nothing,
        }
    }

    fn contacts(&self) -> Option<&[PatchContacts]> {
        self.contacts.as_deref().map(FoundContacts::found)
    }

    fn drop_contacts(&mut self) {
        self.contacts = None;
    }

    fn pieces(&self) -> [u32; 2] {
        self.parts
    }

    fn facets(&self) -> usize {
        0
    }

    fn shed(&mut self) {}

    fn heap_bytes(&self) -> usize {
        self.kinds.heap_bytes()
    }
}

/// The serialized form of a tracker. Fronts of composites, meshes and surfaces are not written:
/// these trackers begin anew.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) enum StoredTracker {
    Convex(Box<ShapeTracker>),
    Pieces([u32; 2]),
    Triangles([u32; 2]),
    Patches([u32; 2]),
}

#[cfg(feature = "serde")]
impl MixedTracker {
    /// Returns the part of the tracker that is written.
    pub(crate) fn stored(&self) -> StoredTracker {
        match &self.kinds {
            TrackedKinds::Convex(tracked) => StoredTracker::Convex(Box::new(tracked.tracker.clone())),
            TrackedKinds::Pieces(_) => StoredTracker::Pieces(self.parts),
            TrackedKinds::Triangles(_) => StoredTracker::Triangles(self.parts),
            _ => StoredTracker::Patches(self.parts),
        }
    }

    /// Returns the tracker of two bodies as written; `None` if the tracker is of other kinds.
    pub(crate) fn restored(stored: StoredTracker, a: &Geometry, b: &Geometry) -> Option<Self> {
        use TrackedKinds::{Convex, Pieces, Triangles};
        let mut tracker = Self::new(a.into(), b.into());
        tracker.parts = match (&mut tracker.kinds, stored) {
            (Convex(tracked), StoredTracker::Convex(known)) => {
                tracked.tracker = *known;
                [0; 2]
            }
            (Pieces(_), StoredTracker::Pieces(parts)) | (Triangles(_), StoredTracker::Triangles(parts)) => parts,
            (Convex(_) | Pieces(_) | Triangles(_), _) => return None,
            (_, StoredTracker::Patches(parts)) => parts,
            _ => return None,
        };
        Some(tracker)
    }
}
