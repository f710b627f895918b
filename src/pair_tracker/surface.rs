//! The tracker of a pair with a surface of patches.

use super::over::Kinds;
use crate::composite::pieces::Composite;
use crate::geometry::Geometry;
use crate::patch::{
    Decision, Surface, SurfaceCompositePair, SurfaceCompositeTracker, SurfacePair, SurfaceShapePair,
    SurfaceShapeTracker, SurfaceTracker, exchanged,
};
use crate::pose::{Operand, RelativePose};
use crate::separation::Measure;
use crate::tuning::patch::SCENE_WIDTH;

/// The tracker of a surface and another body, and the patches of the last witnesses.
#[derive(Clone, Debug)]
pub(crate) struct WithSurface {
    kind: SurfacePartner,
    pub(super) pieces: [u32; 2],
}

#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "the tracker about it is in a box")]
enum SurfacePartner {
    Surfaces(SurfaceTracker),
    /// A surface and a convex shape, in either order.
    Convex(SurfaceShapeTracker),
    /// A surface and a body of pieces, in either order.
    Pieces(SurfaceCompositeTracker),
}

/// A surface and a convex shape, and whether the shape is A.
type Mixed<'a> = (&'a Surface, alloc::borrow::Cow<'a, crate::shape::Shape>, bool);

fn surfaces<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<[&'a Surface; 2]> {
    match (a, b) {
        (Geometry::Surface(x), Geometry::Surface(y)) => Some([x, y]),
        _ => None,
    }
}

fn mixed<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Mixed<'a>> {
    match (a, b) {
        (Geometry::Surface(x), y) => Some((x, y.as_convex()?, false)),
        (x, Geometry::Surface(y)) => Some((y, x.as_convex()?, true)),
        _ => None,
    }
}

fn of_pieces<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<(&'a Surface, &'a Composite, bool)> {
    match (a, b) {
        (Geometry::Surface(x), Geometry::Composite(y)) => Some((x, y, false)),
        (Geometry::Composite(x), Geometry::Surface(y)) => Some((y, x, true)),
        _ => None,
    }
}

/// Returns the measure of a surface, as A, and another body, in their order in the scene.
fn ordered(is_second: bool, pose: &RelativePose, see: impl FnOnce(&RelativePose) -> Measure) -> Measure {
    if is_second {
        let turned = pose.swapped();
        exchanged(&see(&turned), &turned)
    } else {
        see(pose)
    }
}

impl WithSurface {
    /// Returns a tracker without a start; `None` for kinds that no tracker takes together.
    pub(super) fn new(a: &Geometry, b: &Geometry) -> Option<Self> {
        let kind = match surfaces(a, b) {
            Some(_) => SurfacePartner::Surfaces(SurfaceTracker::new()),
            None if of_pieces(a, b).is_some() => SurfacePartner::Pieces(SurfaceCompositeTracker::new()),
            None => mixed(a, b).map(|_| SurfacePartner::Convex(SurfaceShapeTracker::new()))?,
        };
        let pieces = [0; 2];
        Some(Self { kind, pieces })
    }

    /// Returns the closest points; `None` for bodies of other kinds.
    pub(super) fn measure(&mut self, a: &Geometry, b: &Geometry, pose: &RelativePose) -> Option<Measure> {
        let (_, of_a) = a.bounding_ball();
        let (_, of_b) = b.bounding_ball();
        let width = SCENE_WIDTH * (of_a + of_b);
        let seen = match &mut self.kind {
            SurfacePartner::Surfaces(tracker) => {
                let [x, y] = surfaces(a, b)?;
                Measure::from(&tracker.closest(x, y, pose, width))
            }
            SurfacePartner::Convex(tracker) => {
                let (surface, shape, is_second) = mixed(a, b)?;
                ordered(is_second, pose, |pose| {
                    (&tracker.closest(surface, &shape, pose, width)).into()
                })
            }
            SurfacePartner::Pieces(tracker) => {
                let (surface, body, is_second) = of_pieces(a, b)?;
                ordered(is_second, pose, |pose| {
                    (&tracker.closest(surface, body, pose, width)).into()
                })
            }
        };
        self.pieces = [seen.pieces.0, seen.pieces.1];
        Some(seen)
    }

    /// Returns whether the bodies are at most `d` apart; yes for bodies of other kinds.
    pub(super) fn within(&mut self, a: &Geometry, b: &Geometry, pose: &RelativePose, d: f64) -> Decision {
        let decision = match &mut self.kind {
            SurfacePartner::Surfaces(tracker) => surfaces(a, b).map(|[x, y]| tracker.within(x, y, pose, d)),
            SurfacePartner::Convex(tracker) => mixed(a, b).map(|(surface, shape, is_second)| {
                let pose = if is_second { pose.swapped() } else { *pose };
                tracker.within(surface, &shape, &pose, d)
            }),
            SurfacePartner::Pieces(tracker) => of_pieces(a, b).map(|(surface, body, is_second)| {
                let pose = if is_second { pose.swapped() } else { *pose };
                tracker.within(surface, body, &pose, d)
            }),
        };
        decision.unwrap_or(Decision::Yes)
    }

    /// Returns the pair in the form that can be measured over time; `None` for bodies of other
    /// kinds.
    pub(super) fn over<'p>(&'p mut self, a: &'p Geometry, b: &'p Geometry) -> Option<Kinds<'p>> {
        let order = |is_second| if is_second { Operand::B } else { Operand::A };
        Some(match &mut self.kind {
            SurfacePartner::Surfaces(tracker) => {
                let [a, b] = surfaces(a, b)?;
                Kinds::Surfaces(SurfacePair { a, b, tracker })
            }
            SurfacePartner::Convex(tracker) => {
                let (surface, shape, is_second) = mixed(a, b)?;
                let order = order(is_second);
                Kinds::SurfaceAndShape(SurfaceShapePair {
                    surface,
                    shape,
                    order,
                    tracker,
                })
            }
            SurfacePartner::Pieces(tracker) => {
                let (surface, body, is_second) = of_pieces(a, b)?;
                let order = order(is_second);
                Kinds::SurfaceAndPieces(SurfaceCompositePair {
                    surface,
                    body,
                    order,
                    tracker,
                })
            }
        })
    }

    pub(super) fn heap_bytes(&self) -> usize {
        match &self.kind {
            SurfacePartner::Surfaces(tracker) => tracker.heap_bytes(),
            SurfacePartner::Convex(tracker) => tracker.heap_bytes(),
            SurfacePartner::Pieces(tracker) => tracker.heap_bytes(),
        }
    }
}
