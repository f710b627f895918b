//! Two shapes of any kind and their tracker.

use nalgebra::{Point3, Vector3};

use super::{Measure, Separation, SupportPoint, Tangent};
use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::HEIGHT;
use crate::body::shape::Shape;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::{Decision, Outcome, Until};
use crate::pair::question::Question;
use crate::pair::spot::Answer;

/// Two rounded or curved shapes that can be measured over time.
#[derive(Debug)]
pub(crate) struct ShapePair<'a> {
    shapes: [&'a Shape; 2],
    /// Balls about both, which a question at one pose does not need.
    balls: Option<[(Point3<f64>, f64); 2]>,
    tracker: &'a mut ShapeTracker,
}

impl<'a> ShapePair<'a> {
    #[inline]
    pub(crate) fn new(a: &'a Shape, b: &'a Shape, tracker: &'a mut ShapeTracker) -> Self {
        Self {
            shapes: [a, b],
            balls: None,
            tracker,
        }
    }

    /// Computes both balls, once for all looks of a cast.
    pub(crate) fn with_balls(self) -> Self {
        Self {
            balls: Some(self.shapes.map(Shape::bounding_ball)),
            ..self
        }
    }

    /// Returns the closest points, and for an overlap as much as the question sets. Rounded shapes
    /// need the depth of their cores, because a deep overlap differs from touch by it alone.
    #[inline]
    pub(crate) fn ask(&mut self, a_from_b: &RelativePose, question: &Question) -> Answer {
        let (a, b, tracker) = self.sides();
        Answer::of_convex(match question.until {
            Until::Class => tracker.closest(a, b, a_from_b).without_depth(),
            until => tracker.measure(a, b, a_from_b, until),
        })
    }

    /// Returns whether the shapes are at most `d` apart.
    #[inline]
    pub(crate) fn ask_within(&mut self, a_from_b: &RelativePose, d: f64, _: &Question) -> Decision {
        let (a, b, tracker) = self.sides();
        Decision::of(tracker.within(a, b, a_from_b, d))
    }

    /// Returns the shapes and the tracker.
    #[inline]
    pub(crate) fn sides(&mut self) -> (&'a Shape, &'a Shape, &mut ShapeTracker) {
        let [a, b] = self.shapes;
        (a, b, self.tracker)
    }

    /// Returns an outcome of the tracker as a measure.
    pub(crate) fn seen(outcome: &Outcome) -> Measure {
        Measure {
            // A radius moves the lower bound; the height along the normal is taken again.
            by_plane: false,
            ..Measure::new(outcome, Tangent::Free)
        }
    }
}

impl Separation for ShapePair<'_> {
    #[inline]
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let k = usize::from(of == Operand::B);
        match self.balls {
            Some(balls) => balls[k],
            None => self.shapes[k].bounding_ball(),
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        let (a, b, tracker) = self.sides();
        Self::seen(&tracker.closest(a, b, a_from_b))
    }

    /// Proven by the upper bound of the distance; exact for rounded polyhedra with the feature
    /// `exact`.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        let (a, b, tracker) = self.sides();
        tracker.closest(a, b, a_from_b).upper <= distance
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let (centre, radius) = self.ball(of);
        let shape = self.shapes[usize::from(of == Operand::B)];
        let length = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let size = radius + centre.coords.abs().sum();
        let height = shape.support_height(direction) - direction.dot(&centre.coords);
        SupportPoint {
            height: height + HEIGHT * length * size,
            // Steers the search alone: the point of the ball.
            point: direction * (height / direction.norm_squared().at_least(f64::MIN_POSITIVE)),
        }
    }
}
