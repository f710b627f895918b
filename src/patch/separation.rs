//! Surfaces over time, against each other and against convex shapes.
//!
//! No plane separates surfaces that reach into each other's hollows, so a look ahead bounds the
//! displacement of all points, as for composites (Mirtich 1996, conservative advancement): bodies
//! that are proven `d` apart stay apart until their points, seen from each other, may have moved by
//! `d`. A measure is as narrow as a part of the distance, so looks near contact are as sharp as
//! those far away, and the number of looks grows with the logarithm of the tolerance.

use nalgebra::Point3;

use super::search::NetGoal;
use super::shape_tracker::SurfaceShapeTracker;
use super::surface::Surface;
use crate::pair::answer::unit;
use crate::pair::outcome::Outcome;
use crate::pair::spot::Answer;
use crate::pose::{Operand, RelativePose};
use crate::separation::{Flight, Free, Measure, Proof, Separation};
use crate::shape::Shape;
use crate::tuning::patch::{HOPE, MEASURED, NARROWER};

/// A surface and a convex shape that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfaceShapePair<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) shape: &'a Shape,
    /// Which of the two is the surface.
    pub(crate) order: Operand,
    pub(crate) tracker: &'a mut SurfaceShapeTracker,
}

/// Returns the pose of the other body in the frame of a surface that is A or B.
pub(crate) fn from_surface(order: Operand, a_from_b: &RelativePose) -> RelativePose {
    if order == Operand::A {
        *a_from_b
    } else {
        a_from_b.swapped()
    }
}

/// Returns an answer with the surface as A as that of the pair, for the pose of the answer.
pub(crate) fn in_order(order: Operand, found: Answer, pose: &RelativePose) -> Answer {
    if order == Operand::A {
        found
    } else {
        exchanged(found, pose)
    }
}

/// Returns the answer of B and A as that of A and B, for the pose of B and A.
pub(crate) fn exchanged(found: Answer, pose: &RelativePose) -> Answer {
    let normal = unit(&-pose.rotation().tr_mul(&found.normal));
    let o = found.outcome;
    Answer {
        outcome: Outcome {
            features: o.features.swapped(),
            point_on_a: o.point_on_b,
            point_on_b: o.point_on_a,
            normal,
            ..o
        },
        on: [found.on[1], found.on[0]],
        ..found
    }
}

/// Returns how long a lower bound lasts, where `lower` takes a width and returns a new bound: asked
/// if the bound seen is far below the distance that is left. The answer is zero if no search comes
/// near that distance.
pub(super) fn held<S: Separation>(
    pair: &mut S,
    seen: &Measure,
    flight: &Flight,
    lower: impl FnOnce(&mut S, &RelativePose, f64) -> f64,
) -> Free {
    let left = seen.upper - flight.keep;
    let mut bound = seen.lower;
    if left > 0.0
        && bound - flight.keep < (1.0 - NARROWER) * left
        && let Ok(pose) = RelativePose::new(&flight.pose_a, &flight.pose_b)
    {
        bound = bound.max(lower(pair, &pose, MEASURED * left));
    }
    let proof = Proof::Own;
    if bound - flight.keep < HOPE * left {
        return Free { span: 0.0, proof };
    }
    let way = bound - flight.keep - flight.apart(pair).noise;
    let span = flight.held(pair, way);
    Free { span, proof }
}

impl Separation for SurfaceShapePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == self.order {
            self.surface.bounding_ball()
        } else {
            self.shape.bounding_ball()
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        let pose = from_surface(self.order, a_from_b);
        let goal = NetGoal::Part(MEASURED);
        let found = self.tracker.answer(self.surface, self.shape, &pose, goal);
        Measure::from(&in_order(self.order, found, &pose))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let pose = from_surface(self.order, a_from_b);
        self.tracker.within(self.surface, self.shape, &pose, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, a_from_b, width| {
            let pose = from_surface(pair.order, a_from_b);
            pair.tracker.closest(pair.surface, pair.shape, &pose, width).lower
        })
    }
}
