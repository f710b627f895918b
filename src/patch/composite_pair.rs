//! A surface and a body of convex pieces over time.

use nalgebra::Point3;

use super::composite_tracker::SurfaceCompositeTracker;
use super::search::NetGoal;
use super::separation::{from_surface, held, in_order};
use super::surface::Surface;
use crate::composite::pieces::Composite;
use crate::composite::separation::ball_about;
use crate::pose::{Operand, RelativePose};
use crate::separation::{Flight, Free, Measure, Separation};
use crate::tuning::patch::MEASURED;

/// A surface and a body of convex pieces that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfaceCompositePair<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) body: &'a Composite,
    /// Which of the two is the surface.
    pub(crate) order: Operand,
    pub(crate) tracker: &'a mut SurfaceCompositeTracker,
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
        Measure::from(&in_order(self.order, found, &pose))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let pose = from_surface(self.order, a_from_b);
        self.tracker.within(self.surface, self.body, &pose, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, a_from_b, width| {
            let pose = from_surface(pair.order, a_from_b);
            pair.tracker.closest(pair.surface, pair.body, &pose, width).lower
        })
    }
}
