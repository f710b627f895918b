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
//! A tracker takes both bodies in one form. A body of another form has a *stand-in*: a converted
//! copy, made with the engine and cached there. [`Engine::lend`] combines the two geometries, or
//! their stand-ins, with the tracker; the [`LentPair`] answers every query. Each engine implements
//! three methods: `lend` borrows its tracker, `report` returns its work and memory, `stored`
//! returns what is serialised.

#[cfg(any(feature = "meshes", feature = "serde"))]
use alloc::boxed::Box;
use alloc::sync::Arc;

use nalgebra::{Unit, Vector3};

use super::lent_pair::{BallPair, LentPair};
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
use crate::convex::tracker::{Tracker, TrackerWork};
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::Decision;
use crate::pair_tracker::geometry::GeometryRef;
use crate::time::separation::{PolyhedronPair, ShapePair};

/// The tracker of a pair of geometries, and their stand-ins.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "convex pairs, the usual ones, stay in place")]
pub(crate) enum Engine {
    /// Two polyhedra.
    Polyhedra(WithStandIns<Tracker, ConvexPolyhedron>),
    /// Two convex shapes, one of which is rounded or curved.
    Shapes(WithStandIns<ShapeTracker, Shape>),
    /// A half-space and a body of any kind, in either order.
    HalfSpace(HalfSpaceEngine),
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

/// Calls a method of the engine of any pair.
macro_rules! each {
    ($all:expr, $engine:ident => $asked:expr) => {
        match $all {
            Engine::Polyhedra($engine) => $asked,
            Engine::Shapes($engine) => $asked,
            Engine::HalfSpace($engine) => $asked,
            #[cfg(feature = "meshes")]
            Engine::Pieces($engine) => $asked,
            #[cfg(feature = "meshes")]
            Engine::Meshes($engine) => $asked,
            #[cfg(feature = "surfaces")]
            Engine::Surfaces($engine) => $asked,
            #[cfg(feature = "surfaces")]
            Engine::SurfaceAndShape($engine) => $asked,
            #[cfg(feature = "surfaces")]
            Engine::SurfaceAndPieces($engine) => $asked,
        }
    };
}

/// Queries a convex pair directly, and any other pair after borrowing it.
///
/// Borrowing would cost a convex pair about 8 ns, a tenth of a query of two balls.
macro_rules! at_once {
    ($all:ident, $bodies:ident, $pair:ident => $asked:expr) => {{
        match $all {
            Engine::Polyhedra(engine) => {
                if let Some(mut $pair) = engine.pair($bodies) {
                    return $asked;
                }
            }
            Engine::Shapes(engine) => {
                if let Some(mut $pair) = engine.pair($bodies) {
                    return $asked;
                }
            }
            _ => {}
        }
        let mut $pair = $all.lend($bodies);
        $asked
    }};
}

impl Engine {
    /// Returns the engine of two geometries, without cached state.
    pub(crate) fn new(bodies: [GeometryRef<'_>; 2]) -> Self {
        if bodies.iter().any(|body| body.half_space().is_some()) {
            return Self::HalfSpace(HalfSpaceEngine);
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
            Self::Shapes(WithStandIns::new(bodies.map(GeometryRef::polyhedron_as_shape)))
        }
    }

    /// Returns the engine of two polyhedra that starts with the state of a tracker.
    pub(crate) fn of_polyhedra(tracker: Tracker) -> Self {
        let stand_ins = [None, None];
        Self::Polyhedra(WithStandIns { tracker, stand_ins })
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
        at_once!(self, bodies, pair => pair.closest_with(pose, question))
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
        at_once!(self, bodies, pair => pair.decide_within(pose, d, question))
    }

    /// Combines the tracker with the two geometries for which the engine was made.
    ///
    /// For other geometries, and for a surface and a mesh with coordinates that are too large for a
    /// surface, the pair knows only balls around them.
    pub(crate) fn lend<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> LentPair<'p> {
        match each!(self, engine => engine.lend(bodies)) {
            Some(pair) => pair,
            None => LentPair::Balls(BallPair::new(bodies)),
        }
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
        each!(self, engine => engine.report())
    }

    /// Returns the bytes on the heap, without stand-ins.
    pub(crate) fn memory_usage(&self) -> usize {
        self.report().memory_usage
    }

    /// Returns what is serialised of the engine, with the subshapes of the last outcome.
    #[cfg(feature = "serde")]
    pub(crate) fn stored(&self, parts: [u32; 2]) -> StoredEngine {
        each!(self, engine => engine.stored(parts))
    }
}

/// The work and the memory of an engine.
pub(super) struct EngineReport {
    pub(super) work: PairWork,
    /// Entries of the front; convex pairs have none.
    pub(super) front_len: usize,
    /// Bytes on the heap, without stand-ins.
    pub(super) memory_usage: usize,
}

impl EngineReport {
    fn of_convex(work: TrackerWork, memory_usage: usize) -> Self {
        Self {
            work: PairWork::of_convex(work),
            front_len: 0,
            memory_usage,
        }
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

/// The engine of a pair with a half-space: one support point answers every query, so it has no
/// state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpaceEngine;

impl HalfSpaceEngine {
    fn lend<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<LentPair<'p>> {
        GeometryRef::half_space_pair(bodies).map(LentPair::HalfSpace)
    }

    fn report(self) -> EngineReport {
        EngineReport::of_convex(TrackerWork::default(), 0)
    }

    #[cfg(feature = "serde")]
    fn stored(self, parts: [u32; 2]) -> StoredEngine {
        StoredEngine::HalfSpace(parts)
    }
}

/// A tracker, and the stand-ins of bodies of another form.
#[derive(Clone, Debug)]
pub(crate) struct WithStandIns<T, S> {
    pub(crate) tracker: T,
    pub(super) stand_ins: [Option<Arc<S>>; 2],
}

impl<T: Default, S> WithStandIns<T, S> {
    pub(super) fn new(stand_ins: [Option<Arc<S>>; 2]) -> Self {
        let tracker = T::default();
        Self { tracker, stand_ins }
    }

    /// Returns the tracker and both bodies, the originals or the stand-ins.
    #[inline]
    pub(super) fn sides<'p>(&'p mut self, own: [Option<&'p S>; 2]) -> Option<(&'p mut T, [&'p S; 2])> {
        let [x, y] = &self.stand_ins;
        let sides = [own[0].or(x.as_deref())?, own[1].or(y.as_deref())?];
        Some((&mut self.tracker, sides))
    }
}

impl WithStandIns<Tracker, ConvexPolyhedron> {
    #[inline]
    fn pair<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<PolyhedronPair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.map(GeometryRef::polyhedron))?;
        Some(PolyhedronPair::new(a, b, tracker))
    }

    fn lend<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<LentPair<'p>> {
        self.pair(bodies).map(LentPair::Polyhedra)
    }

    fn report(&self) -> EngineReport {
        EngineReport::of_convex(self.tracker.work(), self.tracker.memory_usage())
    }

    #[cfg(feature = "serde")]
    fn stored(&self, _: [u32; 2]) -> StoredEngine {
        StoredEngine::Polyhedra(Box::new(self.tracker.clone()))
    }
}

impl WithStandIns<ShapeTracker, Shape> {
    #[inline]
    fn pair<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<ShapePair<'p>> {
        let (tracker, [a, b]) = self.sides(bodies.map(GeometryRef::shape))?;
        Some(ShapePair::new(a, b, tracker))
    }

    fn lend<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> Option<LentPair<'p>> {
        self.pair(bodies).map(LentPair::Shapes)
    }

    fn report(&self) -> EngineReport {
        EngineReport::of_convex(self.tracker.work(), 0)
    }

    #[cfg(feature = "serde")]
    fn stored(&self, _: [u32; 2]) -> StoredEngine {
        StoredEngine::Convex(Box::new(self.tracker.clone()))
    }
}
