//! The tracker of a pair that is not of two polyhedra: convex shapes, composites, meshes, surfaces
//! of patches.

use alloc::boxed::Box;
use alloc::sync::Arc;

use super::engine::{BodyShapes, ContactAsk, Contacted, PairEngine};
use super::over::{Kinds, OverTime};
use super::surface::WithSurface;
use crate::composite::contact::{ContactPatches, ContactTracker, PatchContacts};
use crate::composite::mesh::Mesh;
use crate::composite::parts::PartsRef;
use crate::composite::pieces::{Composite, CompositeTracker};
use crate::composite::separation::{CompositePair, MeshPair};
use crate::composite::tracker::MeshTracker;
use crate::contact::{Manifold, ManifoldOptions};
use crate::geometry::Geometry;
use crate::pair::outcome::{Class, Outcome, Until};
use crate::patch::Decision;
use crate::polyhedron::FeaturePair;
use crate::pose::RelativePose;
use crate::separation::{Measure, Separation, ShapePair, Tangent};
use crate::shape_tracker::ShapeTracker;

/// The tracker of a pair that is not of two polyhedra.
#[derive(Clone, Debug)]
pub(crate) enum MixedTracker {
    /// Two convex shapes.
    Convex(Box<ShapeTracker>),
    /// Two bodies of which one is a composite or a mesh, and the other of any kind: a convex body
    /// is a single leaf with its own support points.
    Pieces(Box<TrackedPieces<CompositeTracker, Composite>>),
    /// Two meshes, or a mesh and a composite whose surface is one.
    Triangles(Box<TrackedPieces<MeshTracker, Mesh>>),
    /// A surface of patches, and another or a convex shape.
    Patches(Box<WithSurface>),
}

/// A tracker of two bodies of many pieces.
#[derive(Clone, Debug)]
pub(crate) struct TrackedPieces<T, S> {
    tracker: T,
    /// The body in the form in which the tracker takes it, for a body of another kind.
    stand_ins: [Option<Arc<S>>; 2],
    pieces: [u32; 2],
    contacts: Option<Box<FoundContacts>>,
}

/// The contacts of a pair that is within the prediction.
#[derive(Clone, Debug)]
struct FoundContacts {
    tracker: ContactTracker,
    /// The patches of a convex body.
    stand_ins: [Option<ContactPatches>; 2],
}

impl<T: Default, S> TrackedPieces<T, S> {
    fn new(stand_ins: [Option<Arc<S>>; 2]) -> Box<Self> {
        Box::new(Self {
            tracker: T::default(),
            stand_ins,
            pieces: [0; 2],
            contacts: None,
        })
    }
}

impl MixedTracker {
    /// Returns a tracker without a start; `None` for kinds that no tracker takes together.
    pub(super) fn new(a: &Geometry, b: &Geometry) -> Option<Self> {
        use Geometry::{Composite as C, Mesh as M, Surface as S};
        Some(match (a, b) {
            (S(_), _) | (_, S(_)) => Self::Patches(Box::new(WithSurface::new(a, b)?)),
            (M(_), _) | (_, M(_)) => match (as_mesh(a), as_mesh(b)) {
                (Some(x), Some(y)) => Self::Triangles(TrackedPieces::new([x, y])),
                _ => Self::of_pieces(a, b),
            },
            (C(_), _) | (_, C(_)) => Self::of_pieces(a, b),
            _ => Self::Convex(Box::default()),
        })
    }

    /// Returns the pair in the form that can be measured over time; `None` for shapes of another
    /// pair.
    pub(super) fn over<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<OverTime<'p>> {
        let kinds = match self {
            Self::Convex(tracker) => Kinds::Convex(ShapePair::new(a.as_convex()?, b.as_convex()?, tracker)),
            Self::Pieces(tracked) => {
                let (tracker, [a, b]) = tracked.sides(a, b)?;
                Kinds::Pieces(CompositePair { a, b, tracker })
            }
            Self::Triangles(tracked) => {
                let (tracker, [a, b]) = tracked.sides(a, b)?;
                Kinds::Triangles(MeshPair { a, b, tracker })
            }
            Self::Patches(tracker) => tracker.over(a, b)?,
        };
        Some(OverTime(kinds))
    }

    /// Returns whether the geometries are at most `d` apart; true for geometries of another pair.
    pub(super) fn within(&mut self, (a, b): BodyShapes<'_>, pose: &RelativePose, d: f64) -> Decision {
        let is_within = match self {
            Self::Convex(tracker) => match (a.as_convex(), b.as_convex()) {
                (Some(x), Some(y)) => tracker.within(&x, &y, pose, d),
                _ => true,
            },
            Self::Pieces(tracked) => tracked.sides(a, b).is_none_or(|(t, [x, y])| t.within(&x, &y, pose, d)),
            Self::Triangles(tracked) => tracked.sides(a, b).is_none_or(|(t, [x, y])| t.within(x, y, pose, d)),
            Self::Patches(tracker) => return tracker.within(a, b, pose, d),
        };
        if is_within { Decision::Yes } else { Decision::No }
    }

    fn of_pieces(a: &Geometry, b: &Geometry) -> Self {
        Self::Pieces(TrackedPieces::new([as_composite(a), as_composite(b)]))
    }
}

/// Returns the composite that stands for a convex body; `None` for any other body.
fn as_composite(shape: &Geometry) -> Option<Arc<Composite>> {
    let convex = shape.as_convex()?;
    Some(Arc::new(Composite::from(convex.into_owned())))
}

/// Returns the mesh that stands for a body that is not convex: `Some(None)` for the body itself.
fn as_mesh(shape: &Geometry) -> Option<Option<Arc<Mesh>>> {
    let surface = match shape {
        Geometry::Mesh(_) => return Some(None),
        Geometry::Composite(composite) => composite.to_mesh(),
        Geometry::Polyhedron(_) | Geometry::Convex(_) | Geometry::Surface(_) => return None,
    };
    surface.ok().map(|mesh| Some(Arc::new(mesh)))
}

impl TrackedPieces<CompositeTracker, Composite> {
    fn sides<'a>(
        &'a mut self,
        a: &'a Geometry,
        b: &'a Geometry,
    ) -> Option<(&'a mut CompositeTracker, [PartsRef<'a>; 2])> {
        let [x, y] = &self.stand_ins;
        let side = |own: &'a Geometry, stand_in: &'a Option<Arc<Composite>>| match own {
            Geometry::Composite(composite) => Some(PartsRef::Pieces(composite)),
            Geometry::Mesh(mesh) => Some(PartsRef::Mesh(mesh)),
            _ => stand_in.as_deref().map(PartsRef::Pieces),
        };
        Some((&mut self.tracker, [side(a, x)?, side(b, y)?]))
    }
}

impl<T, S> TrackedPieces<T, S> {
    /// Finds the contacts of two bodies at a pose; the patches of convex bodies are made here.
    fn find_contacts(
        &mut self,
        (a, b): (&Geometry, &Geometry),
        patches: [Option<&ContactPatches>; 2],
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> bool {
        let contacts = self.contacts.get_or_insert_with(|| {
            let of = |shape: &Geometry| shape.as_convex().map(|s| ContactPatches::from(s.into_owned()));
            Box::new(FoundContacts {
                tracker: ContactTracker::new(),
                stand_ins: [of(a), of(b)],
            })
        });
        let [x, y] = &contacts.stand_ins;
        let (Some(x), Some(y)) = (patches[0].or(x.as_ref()), patches[1].or(y.as_ref())) else {
            return false;
        };
        contacts.tracker.contacts(x, y, pose, options);
        true
    }
}

impl TrackedPieces<MeshTracker, Mesh> {
    fn sides<'a>(&'a mut self, a: &'a Geometry, b: &'a Geometry) -> Option<(&'a mut MeshTracker, [&'a Mesh; 2])> {
        let [x, y] = &self.stand_ins;
        let side = |own: &'a Geometry, stand_in: &'a Option<Arc<Mesh>>| match own {
            Geometry::Mesh(mesh) => Some(&**mesh),
            _ => stand_in.as_deref(),
        };
        Some((&mut self.tracker, [side(a, x)?, side(b, y)?]))
    }
}

/// Returns the outcome of composites or meshes.
fn outcome_of(found: &Measure) -> Outcome {
    let features = found.features.unwrap_or(FeaturePair::FIRST);
    Outcome {
        class: found.class,
        distance: found.distance,
        lower: found.lower,
        upper: found.upper,
        point_on_a: found.point_on_a,
        point_on_b: found.point_on_b,
        normal: found.normal,
        ..Outcome::starting_at(features)
    }
}

/// Returns the measure of an outcome, which proves a distance.
fn measure_of(found: &Outcome) -> Measure {
    Measure {
        by_plane: false,
        ..Measure::new(found, Tangent::Free)
    }
}

/// Returns the outcome with an overlap of unknown depth.
fn without_depth(outcome: Outcome) -> Outcome {
    if outcome.class == Class::Overlapping {
        let (distance, lower, upper) = (0.0, f64::NEG_INFINITY, 0.0);
        Outcome {
            distance,
            lower,
            upper,
            ..outcome
        }
    } else {
        outcome
    }
}

impl PairEngine for MixedTracker {
    type Shapes<'a> = (&'a Geometry, &'a Geometry);

    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        Some((a, b))
    }

    fn measure(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, until: Until) -> Outcome {
        let unknown = || Outcome {
            upper: f64::MAX,
            ..Outcome::starting_at(FeaturePair::FIRST)
        };
        let outcome = match self {
            Self::Convex(tracker) => match (a.as_convex(), b.as_convex()) {
                (Some(x), Some(y)) if until == Until::LocalDepth => tracker.closest_with_local_depth(&x, &y, pose),
                (Some(x), Some(y)) => tracker.closest(&x, &y, pose),
                _ => unknown(),
            },
            Self::Pieces(tracked) => {
                let Some((tracker, [x, y])) = tracked.sides(a, b) else {
                    return unknown();
                };
                let found = tracker.closest(&x, &y, pose);
                tracked.pieces = found.pieces;
                return without_depth(outcome_of(&Measure::from(&found)));
            }
            Self::Triangles(tracked) => {
                let Some((tracker, [x, y])) = tracked.sides(a, b) else {
                    return unknown();
                };
                let found = tracker.closest(x, y, pose);
                tracked.pieces = [found.on_a.triangle, found.on_b.triangle];
                return without_depth(outcome_of(&Measure::from(&found)));
            }
            Self::Patches(tracker) => {
                return match tracker.measure(a, b, pose) {
                    Some(found) => without_depth(outcome_of(&found)),
                    None => unknown(),
                };
            }
        };
        match until {
            Until::Depth | Until::LocalDepth => outcome,
            Until::Class => without_depth(outcome),
        }
    }

    fn decides_within(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        if outcome.class == Class::Overlapping || outcome.upper <= d {
            return true;
        }
        if outcome.lower > d {
            return false;
        }
        self.within((a, b), pose, d) != Decision::No
    }

    fn over_time<R>(
        &mut self,
        (a, b): Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measure>) -> R,
    ) -> Option<R> {
        let mut pair = self.over((a, b))?;
        Some(ask(&mut pair, seen.map(measure_of)))
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
        let is_found = match self {
            Self::Pieces(tracked) => tracked.find_contacts((a, b), patches, pose, options),
            Self::Triangles(tracked) => tracked.find_contacts((a, b), patches, pose, options),
            Self::Patches(_) => false,
            Self::Convex(tracker) => {
                let (Some(x), Some(y)) = (a.as_convex(), b.as_convex()) else {
                    return Contacted::Nothing;
                };
                let queries = tracker.totals().queries;
                tracker.manifold(&x, &y, pose, options, stored.get_or_insert_default());
                // A manifold is rebuilt from a query.
                if tracker.totals().queries > queries {
                    return Contacted::Renewed;
                }
                true
            }
        };
        if is_found { Contacted::Kept } else { Contacted::Nothing }
    }

    fn contacts(&self) -> Option<&[PatchContacts]> {
        let contacts = match self {
            Self::Convex(_) | Self::Patches(_) => None,
            Self::Pieces(tracked) => tracked.contacts.as_deref(),
            Self::Triangles(tracked) => tracked.contacts.as_deref(),
        };
        contacts.map(|c| c.tracker.found())
    }

    fn drop_contacts(&mut self) {
        match self {
            Self::Convex(_) | Self::Patches(_) => {}
            Self::Pieces(tracked) => tracked.contacts = None,
            Self::Triangles(tracked) => tracked.contacts = None,
        }
    }

    fn pieces(&self) -> [u32; 2] {
        match self {
            Self::Convex(_) => [0; 2],
            Self::Pieces(tracked) => tracked.pieces,
            Self::Triangles(tracked) => tracked.pieces,
            Self::Patches(tracker) => tracker.pieces,
        }
    }

    fn facets(&self) -> usize {
        0
    }

    fn shed(&mut self) {}

    fn heap_bytes(&self) -> usize {
        match self {
            Self::Convex(_) => size_of::<ShapeTracker>(),
            Self::Pieces(_) => size_of::<TrackedPieces<CompositeTracker, Composite>>(),
            Self::Triangles(tracked) => size_of::<TrackedPieces<MeshTracker, Mesh>>() + tracked.tracker.heap_bytes(),
            Self::Patches(tracker) => size_of::<WithSurface>() + tracker.heap_bytes(),
        }
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
        match self {
            Self::Convex(tracker) => StoredTracker::Convex(tracker.clone()),
            Self::Pieces(tracked) => StoredTracker::Pieces(tracked.pieces),
            Self::Triangles(tracked) => StoredTracker::Triangles(tracked.pieces),
            Self::Patches(tracker) => StoredTracker::Patches(tracker.pieces),
        }
    }

    /// Returns the tracker of two bodies as written; `None` if the tracker is of other kinds.
    pub(crate) fn restored(stored: StoredTracker, a: &Geometry, b: &Geometry) -> Option<Self> {
        let mut tracker = Self::new(a, b)?;
        match (&mut tracker, stored) {
            (Self::Convex(tracker), StoredTracker::Convex(known)) => *tracker = known,
            (Self::Pieces(tracked), StoredTracker::Pieces(pieces)) => tracked.pieces = pieces,
            (Self::Triangles(tracked), StoredTracker::Triangles(pieces)) => tracked.pieces = pieces,
            (Self::Patches(tracker), StoredTracker::Patches(pieces)) => tracker.pieces = pieces,
            _ => return None,
        }
        Some(tracker)
    }
}
