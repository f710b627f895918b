//! A surface and a body of convex pieces over time.

use nalgebra::Point3;

use super::composite_tracker::SurfaceCompositeTracker;
use super::outcome::Decision;
use super::search::NetGoal;
use super::separation::{from_surface, held, in_order};
use super::surface::Surface;
use crate::composite::pieces::Composite;
use crate::composite::separation::ball_about;
use crate::pose::{Operand, RelativePose};
use crate::separation::{Flight, Free, Measure, Separation};
use crate::tuning::patch::MEASURED;

/// A surface and a body of convex pieces that can be measured over time.
///
/// As [`SurfaceShapePair`](super::SurfaceShapePair): a measure has bounds that are at most a
/// quarter of the distance apart, and a hit is proven by a point of the surface within a piece.
#[derive(Clone, Debug)]
pub struct SurfaceCompositePair<'a> {
    surface: &'a Surface,
    body: &'a Composite,
    /// Which of the two is the surface.
    order: Operand,
    tracker: SurfaceCompositeTracker,
}

impl<'a> SurfaceCompositePair<'a> {
    /// Returns the pair of a surface A and a body B with a new tracker.
    #[must_use]
    pub fn new(a: &'a Surface, b: &'a Composite) -> Self {
        Self::with_tracker(a, b, SurfaceCompositeTracker::new())
    }

    /// Returns the pair of a surface A and a body B with a tracker that has followed the pair
    /// before.
    #[must_use]
    pub fn with_tracker(a: &'a Surface, b: &'a Composite, tracker: SurfaceCompositeTracker) -> Self {
        Self {
            surface: a,
            body: b,
            order: Operand::A,
            tracker,
        }
    }

    /// Returns the pair with the body as A and the surface as B.
    #[must_use]
    pub fn swapped(mut self) -> Self {
        self.order = if self.order == Operand::A {
            Operand::B
        } else {
            Operand::A
        };
        self
    }

    /// Returns the tracker, to be kept.
    #[must_use]
    pub fn into_tracker(self) -> SurfaceCompositeTracker {
        self.tracker
    }
}

impl Separation for SurfaceCompositePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == self.order {
            self.surface.bounding_ball()
        } else {
            ball_about(self.body.aabb())
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        let pose = from_surface(self.order, a_from_b);
        let goal = NetGoal::Part(MEASURED);
        let found = self.tracker.answer(self.surface, self.body, &pose, goal);
        in_order(self.order, Measure::from(&found), &pose)
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let pose = from_surface(self.order, a_from_b);
        self.tracker.within(self.surface, self.body, &pose, distance) == Decision::Yes
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, a_from_b, width| {
            let pose = from_surface(pair.order, a_from_b);
            pair.tracker.distance(pair.surface, pair.body, &pose, width).lower
        })
    }
}
