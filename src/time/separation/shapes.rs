//! Two shapes of any kind and their tracker.

use nalgebra::{Point3, Vector3};

use super::{Measure, Separation, SupportPoint, Tangent};
use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::HEIGHT;
use crate::body::shape::Shape;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::Outcome;

/// Two rounded or curved shapes that can be measured over time.
#[derive(Debug)]
pub(crate) struct ShapePair<'a> {
    a: BalledShape<'a>,
    b: BalledShape<'a>,
    tracker: &'a mut ShapeTracker,
}

/// A shape and its ball.
#[derive(Debug)]
struct BalledShape<'a> {
    shape: &'a Shape,
    centre: Point3<f64>,
    radius: f64,
}

impl<'a> BalledShape<'a> {
    fn new(shape: &'a Shape) -> Self {
        let (centre, radius) = shape.bounding_ball();
        Self { shape, centre, radius }
    }
}

impl<'a> ShapePair<'a> {
    pub(crate) fn new(a: &'a Shape, b: &'a Shape, tracker: &'a mut ShapeTracker) -> Self {
        Self {
            a: BalledShape::new(a),
            b: BalledShape::new(b),
            tracker,
        }
    }

    /// Returns the shapes and the tracker, for a question at one pose.
    pub(crate) fn asked(&mut self) -> (&'a Shape, &'a Shape, &mut ShapeTracker) {
        (self.a.shape, self.b.shape, self.tracker)
    }

    /// Returns an outcome of the tracker as a measure.
    pub(crate) fn seen(outcome: &Outcome) -> Measure {
        Measure {
            // A radius moves the lower bound; the height along the normal is taken again.
            by_plane: false,
            ..Measure::new(outcome, Tangent::Free)
        }
    }

    fn of(&self, of: Operand) -> &BalledShape<'a> {
        if of == Operand::A { &self.a } else { &self.b }
    }
}

impl Separation for ShapePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let placed = self.of(of);
        (placed.centre, placed.radius)
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Self::seen(&self.tracker.closest(self.a.shape, self.b.shape, a_from_b))
    }

    /// Proven by the upper bound of the distance; exact for rounded polyhedra with the feature
    /// `exact`.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measure) -> bool {
        let _ = seen;
        let outcome = self.tracker.closest(self.a.shape, self.b.shape, a_from_b);
        outcome.upper <= distance
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let placed = self.of(of);
        let length = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let size = placed.radius + placed.centre.coords.abs().sum();
        let height = placed.shape.support_height(direction) - direction.dot(&placed.centre.coords);
        SupportPoint {
            height: height + HEIGHT * length * size,
            // Steers the search alone: the point of the ball.
            point: direction * (height / direction.norm_squared().at_least(f64::MIN_POSITIVE)),
        }
    }
}
