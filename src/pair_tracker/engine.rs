//! The state of a pair between queries: one variant per combination of kinds that is measured in
//! the same manner.
//!
//! ```text
//!              polyhedron   shape    compound    mesh        cloud    surface
//! polyhedron   Polyhedra    Shapes   Pieces      Pieces      Pieces   SurfaceAndShape
//! shape                     Shapes   Pieces      Pieces      Pieces   SurfaceAndShape
//! compound                           Pieces      Meshes (1)  Pieces   SurfaceAndPieces
//! mesh                                           Meshes      Pieces   Surfaces
//! cloud                                                      Pieces   SurfaceAndPieces
//! surface                                                             Surfaces
//! ```
//!
//! A half-space in the pair: `HalfSpace`, without a tracker.
//!
//! (1) `Pieces` unless a mesh is equal to the compound.
//!
//! A tracker takes both bodies in one form. Of a body in another form it gets a *converted copy*,
//! made with the engine and cached there. [`Engine::borrow`] combines the two geometries, or their
//! copies, with the tracker; the [`BorrowedPair`] answers every query.

#[cfg(any(feature = "meshes", feature = "serde"))]
use alloc::boxed::Box;
use alloc::sync::Arc;

use nalgebra::{Unit, Vector3};

use super::borrowed_pair::{BallPair, BorrowedPair};
#[cfg(feature = "meshes")]
use super::contacts::PairContacts;
#[cfg(feature = "meshes")]
use super::of_parts::{self, MeshEngine, PieceEngine};
#[cfg(feature = "surfaces")]
use super::of_surfaces::{self, SurfaceEngine, SurfacePieceEngine, SurfaceShapeEngine};
use super::tracker::PairWork;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Shape;
use crate::convex::replay::Replay;
use crate::convex::shape_tracker::ShapeTracker;
use crate::convex::tracker::Tracker;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::Decision;
use crate::pair_tracker::geometry::GeometryRef;
use crate::time::separation::{PolyhedronPair, ShapePair};

/// The tracker of a pair of geometries, and their converted copies.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "convex pairs, the usual ones, stay in place")]
pub(crate) enum Engine {
    /// Two polyhedra.
    Polyhedra(WithCopies<Tracker, ConvexPolyhedron>),
    /// Two convex shapes, one of which is rounded or curved.
    Shapes(WithCopies<ShapeTracker, Shape>),
    /// A half-space and a body of any kind, in either order: one support point answers every query,
    /// so there is no state.
    HalfSpace,
    /// Two bodies made of subshapes, of which one is a compound or a mesh.
    #[cfg(feature = "meshes")]
    Pieces(Box<PieceEngine>),
    /// Two meshes, or a mesh and a compound whose surface is a mesh.
    #[cfg(feature = "meshes")]
    Meshes(Box<MeshEngine>),
    /// Two surfaces, or a surface and a mesh.
    #[cfg(feature = "surfaces")]
    Surfaces(Box<SurfaceEngine>),
    /// A surface and a convex shape, in either order.
    #[cfg(feature = "surfaces")]
    SurfaceAndShape(Box<SurfaceShapeEngine>),
    /// A surface and a compound, in either order.
    #[cfg(feature = "surfaces")]
    SurfaceAndPieces(Box<SurfacePieceEngine>),
}

impl Engine {
    /// Returns the engine of two geometries, without cached state.
    pub(crate) fn new(bodies: [GeometryRef<'_>; 2]) -> Self {
        if bodies.iter().any(|body| body.half_space().is_some()) {
            return Self::HalfSpace;
        }
        #[cfg(feature = "surfaces")]
        if let Some(engine) = of_surfaces::engine(bodies) {
            return engine;
        }
        #[cfg(feature = "meshes")]
        if let Some(engine) = of_parts::engine(bodies) {
            return engine;
        }
        if bodies.iter().all(|body| body.polyhedron().is_some()) {
            Self::of_polyhedra(Tracker::new())
        } else {
            Self::Shapes(WithCopies::new(bodies.map(GeometryRef::polyhedron_as_shape)))
        }
    }

    /// Returns the engine of two polyhedra that starts with the state of a tracker.
    pub(crate) fn of_polyhedra(tracker: Tracker) -> Self {
        let copies = [None, None];
        Self::Polyhedra(WithCopies { tracker, copies })
    }

    /// Returns the closest points.
    ///
    /// Two polyhedra are queried in the code of the caller, where no outcome is copied; a call for
    /// all kinds would be too long for that.
    #[inline]
    pub(super) fn closest_with(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        pose: &RelativePose,
        question: &QueryOptions,
    ) -> PairOutcome {
        if let Self::Polyhedra(engine) = self
            && let Some(mut pair) = engine.pair(bodies)
        {
            return pair.closest_with(pose, question);
        }
        self.closest_of_others(bodies, pose, question)
    }

    #[inline(never)]
    fn closest_of_others(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        pose: &RelativePose,
        question: &QueryOptions,
    ) -> PairOutcome {
        // Borrowing would cost 8 ns, a tenth of a query of two balls.
        if let Self::Shapes(engine) = self
            && let Some(mut pair) = engine.pair(bodies)
        {
            return pair.closest_with(pose, question);
        }
        self.borrow(bodies).closest_with(pose, question)
    }

    /// Returns whether the geometries are at most `d` apart.
    #[inline]
    pub(super) fn decide_within(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        pose: &RelativePose,
        d: f64,
        question: &QueryOptions,
    ) -> Decision {
        if let Self::Polyhedra(engine) = self
            && let Some(mut pair) = engine.pair(bodies)
        {
            return pair.decide_within(pose, d, question);
        }
        if let Self::Shapes(engine) = self
            && let Some(mut pair) = engine.pair(bodies)
        {
            return pair.decide_within(pose, d, question);
        }
        self.borrow(bodies).decide_within(pose, d, question)
    }

    /// Combines the tracker with the two geometries for which the engine was made.
    ///
    /// For other geometries, and for a surface and a mesh with coordinates that are too large for a
    /// surface, the pair knows only balls around them.
    pub(crate) fn borrow<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> BorrowedPair<'p> {
        let pair = match self {
            Self::Polyhedra(engine) => engine.pair(bodies).map(BorrowedPair::Polyhedra),
            Self::Shapes(engine) => engine.pair(bodies).map(BorrowedPair::Shapes),
            Self::HalfSpace => GeometryRef::half_space_pair(bodies).map(BorrowedPair::HalfSpace),
            #[cfg(feature = "meshes")]
            Self::Pieces(engine) => engine.borrow(bodies),
            #[cfg(feature = "meshes")]
            Self::Meshes(engine) => engine.borrow(bodies),
            #[cfg(feature = "surfaces")]
            Self::Surfaces(engine) => engine.borrow(bodies),
            #[cfg(feature = "surfaces")]
            Self::SurfaceAndShape(engine) => engine.borrow(bodies),
            #[cfg(feature = "surfaces")]
            Self::SurfaceAndPieces(engine) => engine.borrow(bodies),
        };
        pair.unwrap_or_else(|| BorrowedPair::Balls(BallPair::new(bodies)))
    }

    /// Starts the next query of two convex bodies, one of them curved, along a direction from A to
    /// B.
    pub(super) fn begin_along(&mut self, n: &Unit<Vector3<f64>>) {
        if let Self::Shapes(engine) = self {
            engine.tracker = ShapeTracker::along(n);
        }
    }

    /// Takes over the recorded start of a query of two convex bodies.
    pub(super) fn begin_as(&mut self, replay: &Replay) {
        match self {
            Self::Polyhedra(engine) => engine.tracker = replay.tracker(),
            Self::Shapes(engine) => engine.tracker = replay.shape_tracker(),
            _ => {}
        }
    }

    /// Returns the work and the memory of the engine.
    pub(super) fn report(&self) -> EngineReport {
        match self {
            Self::Polyhedra(engine) => EngineReport {
                work: PairWork::of_convex(engine.tracker.work()),
                memory_usage: engine.tracker.memory_usage(),
                ..EngineReport::default()
            },
            Self::Shapes(engine) => EngineReport {
                work: PairWork::of_convex(engine.tracker.work()),
                ..EngineReport::default()
            },
            Self::HalfSpace => EngineReport::default(),
            #[cfg(feature = "meshes")]
            Self::Pieces(of) => of_front(
                &**of,
                PairWork::of_trees(of.tracker.work()),
                of.tracker.front_len(),
                of.tracker.memory_usage(),
            ),
            #[cfg(feature = "meshes")]
            Self::Meshes(of) => of_front(
                &**of,
                PairWork::of_trees(of.tracker.work()),
                of.tracker.front_len(),
                of.tracker.memory_usage(),
            ),
            #[cfg(feature = "surfaces")]
            Self::Surfaces(of) => of_front(
                &**of,
                PairWork::of_surfaces(of.tracker.work()),
                of.tracker.front_len(),
                of.tracker.memory_usage(),
            ),
            #[cfg(feature = "surfaces")]
            Self::SurfaceAndShape(of) => of_front(
                &**of,
                PairWork::of_surfaces(of.tracker.work()),
                of.tracker.front_len(),
                of.tracker.memory_usage(),
            ),
            #[cfg(feature = "surfaces")]
            Self::SurfaceAndPieces(of) => of_front(
                &**of,
                PairWork::of_surfaces(of.tracker.work()),
                of.tracker.front_len(),
                of.tracker.memory_usage(),
            ),
        }
    }

    /// Returns the bytes on the heap, without converted copies.
    pub(crate) fn memory_usage(&self) -> usize {
        self.report().memory_usage
    }

    /// Returns what is serialised of the engine, with the subshapes of the last outcome.
    #[cfg(feature = "serde")]
    pub(crate) fn stored(&self, parts: [u32; 2]) -> StoredEngine {
        match self {
            Self::Polyhedra(engine) => StoredEngine::Polyhedra(Box::new(engine.tracker.clone())),
            Self::Shapes(engine) => StoredEngine::Convex(Box::new(engine.tracker.clone())),
            Self::HalfSpace => StoredEngine::HalfSpace(parts),
            #[cfg(feature = "meshes")]
            Self::Pieces(_) => StoredEngine::Pieces(parts),
            #[cfg(feature = "meshes")]
            Self::Meshes(_) => StoredEngine::Triangles(parts),
            #[cfg(feature = "surfaces")]
            Self::Surfaces(_) | Self::SurfaceAndShape(_) | Self::SurfaceAndPieces(_) => StoredEngine::Patches(parts),
        }
    }
}

/// What is kept of a pair between queries.
#[derive(Clone, Debug)]
pub(crate) struct TrackedPair {
    pub(crate) engine: Engine,
    /// The subshapes of the last outcome. Scenes store them; a tracker returns them.
    pub(crate) parts: [u32; 2],
    #[cfg(feature = "meshes")]
    pub(crate) contacts: Option<PairContacts>,
}

impl From<Engine> for TrackedPair {
    #[inline]
    fn from(engine: Engine) -> Self {
        Self {
            engine,
            parts: [0; 2],
            #[cfg(feature = "meshes")]
            contacts: None,
        }
    }
}

/// The work and the memory of an engine.
#[derive(Default)]
pub(super) struct EngineReport {
    pub(super) work: PairWork,
    /// Entries of the front; convex pairs have none.
    pub(super) front_len: usize,
    /// Bytes on the heap, without converted copies.
    pub(super) memory_usage: usize,
}

/// Returns the report of an engine with a front, whose tracker has so many bytes on the heap.
#[cfg(feature = "meshes")]
fn of_front<E>(engine: &E, work: PairWork, front_len: usize, memory_usage: usize) -> EngineReport {
    EngineReport {
        work,
        front_len,
        memory_usage: size_of_val(engine) + memory_usage,
    }
}

/// The serialised form of an engine.
///
/// Fronts of compounds, meshes and surfaces are not serialised: their engines start without a
/// front.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) enum StoredEngine {
    Convex(Box<ShapeTracker>),
    Pieces([u32; 2]),
    Triangles([u32; 2]),
    Patches([u32; 2]),
    Polyhedra(Box<Tracker>),
    HalfSpace([u32; 2]),
}

/// A tracker, and the converted copies of bodies of another form.
#[derive(Clone, Debug)]
pub(crate) struct WithCopies<T, S> {
    pub(crate) tracker: T,
    pub(super) copies: [Option<Arc<S>>; 2],
}

impl<T: Default, S> WithCopies<T, S> {
    pub(super) fn new(copies: [Option<Arc<S>>; 2]) -> Self {
        let tracker = T::default();
        Self { tracker, copies }
    }

    /// Returns the tracker and both bodies, the originals or the converted copies.
    #[inline]
    pub(super) fn sides<'p>(&'p mut self, own: [Option<&'p S>; 2]) -> Option<(&'p mut T, [&'p S; 2])> {
        let [x, y] = &self.copies;
        let sides = [own[0].or(x.as_deref())?, own[1].or(y.as_deref())?];
        Some((&mut self.tracker, sides))
    }
}

impl WithCopies<Tracker, ConvexPolyhedron> {
    #[inline]
    fn pair<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<PolyhedronPair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.map(GeometryRef::polyhedron))?;
        Some(PolyhedronPair::new(a, b, tracker))
    }
}

impl WithCopies<ShapeTracker, Shape> {
    #[inline]
    fn pair<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<ShapePair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.map(GeometryRef::shape))?;
        Some(ShapePair::new(a, b, tracker))
    }
}
