//! Surfaces over time, against each other and against convex shapes.
//!
//! No plane separates surfaces that reach into each other's hollows, so a look ahead bounds the
//! displacement of all points, as for composites (Mirtich 1996, conservative advancement): bodies
//! that are proven `d` apart stay apart until their points, seen from each other, may have moved by
//! `d`. A measure is as narrow as a part of the distance, so looks near contact are as sharp as
//! those far away, and the number of looks grows with the logarithm of the tolerance.

use nalgebra::Point3;

use super::search::NetGoal;
use super::surface::Surface;
use crate::base::num::extremes::Extremes;
use crate::base::pose::{Operand, RelativePose};
use crate::pair::answer::unit;
use crate::pair::outcome::{Decision, Outcome};
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::time::separation::{Flight, Free, Measure, Proof, Separation};

/// Width of a measure over time, as a part of the distance: a look of conservative advancement goes
/// so much less far. Not measured.
pub(super) const MEASURED: f64 = 1.0 / 4.0;

/// Width of a distance of surfaces in a scene, as a part of both radii. Not measured.
const SCENE_WIDTH: f64 = 1.0 / (1u64 << 30) as f64;

/// A look over time that would go less far by more than this part is measured again, narrower. Not
/// measured.
const NARROWER: f64 = 1.0 / 2.0;

/// A look ahead gives up if its bound proves less than this part of the distance left: the search
/// for a narrower one has met its limit, and each further look would cost as much for less.
/// Measured: no cast of the tests ends so.
const HOPE: f64 = 0.125;

/// The tracker of a surface, as A, and a body of another kind.
pub(crate) trait BesideSurface {
    /// The other body.
    type Body;

    /// Returns a ball that contains the other body: centre and radius.
    fn ball(body: &Self::Body) -> (Point3<f64>, f64);

    /// Returns the closest points with bounds as close as a goal asks for.
    fn answer(&mut self, a: &Surface, b: &Self::Body, a_from_b: &RelativePose, goal: NetGoal) -> Answer;

    /// Sets the number of nodes that a query may split; `None` for the usual budget.
    fn allow(&mut self, splits: Option<usize>);
}

/// A surface and a solid of convex shapes that can be measured over time, in either order.
#[derive(Debug)]
pub(crate) struct SurfaceSolidPair<'a, T: BesideSurface> {
    pub(crate) surface: &'a Surface,
    pub(crate) body: &'a T::Body,
    /// Which of the two is the surface.
    pub(crate) order: Operand,
    pub(crate) tracker: &'a mut T,
}

impl<T: BesideSurface> SurfaceSolidPair<'_, T> {
    /// Returns the closest points, with bounds of the width that the question sets.
    pub(crate) fn ask(&mut self, a_from_b: &RelativePose, question: &Question) -> Answer {
        let width = width_asked(self, question);
        self.tracker.allow(question.splits);
        self.answer(a_from_b, NetGoal::Width(width)).without_depth()
    }

    /// Returns whether the distance is at most `d`, within the splits that the question allows.
    pub(crate) fn ask_within(&mut self, a_from_b: &RelativePose, d: f64, question: &Question) -> Decision {
        self.tracker.allow(question.splits);
        self.is_within(a_from_b, d)
    }

    /// Returns whether the distance is at most `d`. Undecided only if `d` is within rounding of the
    /// distance, or a budget is used up: pairs that merely touch stay undecided for zero.
    fn is_within(&mut self, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let pose = from_surface(self.order, a_from_b);
        let found = self.tracker.answer(self.surface, self.body, &pose, NetGoal::Within(d));
        Decision::by(found.lower, found.upper, d)
    }

    fn answer(&mut self, a_from_b: &RelativePose, goal: NetGoal) -> Answer {
        let pose = from_surface(self.order, a_from_b);
        let found = self.tracker.answer(self.surface, self.body, &pose, goal);
        if self.order == Operand::A {
            found
        } else {
            exchanged(found, &pose)
        }
    }
}

/// Returns the pose of the other body in the frame of a surface that is A or B.
fn from_surface(order: Operand, a_from_b: &RelativePose) -> RelativePose {
    if order == Operand::A {
        *a_from_b
    } else {
        a_from_b.swapped()
    }
}

/// Returns the answer of B and A as that of A and B, for the pose of B and A.
fn exchanged(found: Answer, pose: &RelativePose) -> Answer {
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

/// Returns the width of the bounds that the question sets.
pub(super) fn width_asked(pair: &impl Separation, question: &Question) -> f64 {
    let radius = |of| pair.ball(of).1;
    question
        .width
        .unwrap_or_else(|| SCENE_WIDTH * (radius(Operand::A) + radius(Operand::B)))
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
        bound = bound.larger(lower(pair, &pose, MEASURED * left));
    }
    let proof = Proof::Own;
    if bound - flight.keep < HOPE * left {
        return Free { span: 0.0, proof };
    }
    let way = bound - flight.keep - flight.apart(pair).noise;
    let span = flight.held(pair, way);
    Free { span, proof }
}

impl<T: BesideSurface> Separation for SurfaceSolidPair<'_, T> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == self.order {
            self.surface.bounding_ball()
        } else {
            T::ball(self.body)
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.answer(a_from_b, NetGoal::Part(MEASURED)))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        self.is_within(a_from_b, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, pose, width| {
            pair.answer(pose, NetGoal::Width(width)).lower
        })
    }
}
