//! Two shapes of any kind and their tracker.

use nalgebra::{Point3, Vector3};

use super::{Measure, Separation, SupportPoint, Tangent};
use crate::pair::outcome::Outcome;
use crate::pose::{Operand, RelativePose};
use crate::shape::Shape;
use crate::shape_tracker::ShapeTracker;
use crate::tolerance::HEIGHT;

/// Two rounded or curved shapes that can be measured over time.
///
/// ```
/// use lin_canny::impact::{Impact, Tolerance, cast};
/// use lin_canny::motion::Steady;
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::separation::ShapePair;
/// use lin_canny::{Shape, Velocity};
///
/// let (ball, capsule) = (Shape::ball(0.5)?, Shape::capsule(1.0, 0.25)?);
/// let still = Velocity::new(Vector3::zeros(), Vector3::zeros());
/// let still = Steady::new(&Isometry3::identity(), still)?;
/// let start = Isometry3::translation(3.0, 0.0, 0.0);
/// let speed = Velocity::new(Vector3::new(-4.0, 0.0, 0.0), Vector3::zeros());
/// let thrown = Steady::new(&start, speed)?;
/// let mut pair = ShapePair::new(&capsule, &ball);
/// let tolerance = Tolerance::Distance(1e-9);
/// let found = cast(&mut pair, &still, &thrown, (0.0, 1.0), tolerance)?;
/// let Impact::Hit { safe, hit, .. } = found.impact else {
///     panic!("{:?}", found.impact);
/// };
/// // 2.25 of the way at speed 4.
/// assert!(safe <= 0.5625 && 0.5625 <= hit && hit - safe < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ShapePair<'a> {
    a: BalledShape<'a>,
    b: BalledShape<'a>,
    tracker: ShapeTracker,
}

/// A shape and its ball.
#[derive(Clone, Copy, Debug)]
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
    /// Returns the pair with a new tracker.
    #[must_use]
    pub fn new(a: &'a Shape, b: &'a Shape) -> Self {
        Self::with_tracker(a, b, ShapeTracker::new())
    }

    /// Returns the pair with a tracker that has followed the pair before.
    #[must_use]
    pub fn with_tracker(a: &'a Shape, b: &'a Shape, tracker: ShapeTracker) -> Self {
        Self {
            a: BalledShape::new(a),
            b: BalledShape::new(b),
            tracker,
        }
    }

    /// Returns the tracker, to be kept.
    #[must_use]
    pub fn into_tracker(self) -> ShapeTracker {
        self.tracker
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
        let placed = *self.of(of);
        let length = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let size = placed.radius + placed.centre.coords.abs().sum();
        let height = placed.shape.support_height(direction) - direction.dot(&placed.centre.coords);
        SupportPoint {
            height: height + HEIGHT * length * size,
            // Steers the search alone: the point of the ball.
            point: direction * (height / direction.norm_squared().max(f64::MIN_POSITIVE)),
        }
    }
}
