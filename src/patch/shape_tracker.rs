//! The state of a surface and a convex shape, and the queries.

use crate::patch::state::SPLITS;
use crate::patch::tracker::KEPT;
use nalgebra::{Point3, Unit, Vector3};

use super::frame::NetFrame;
use super::gap::{SearchCounts, Trees};
use super::outcome::SurfaceWork;
use super::search::NetGoal;
use super::separation::BesideSurface;
use super::solid::{Feet, ShapeNode};
use super::state::SurfaceMemory;
use super::surface::Surface;
use super::tree::{Grown, Nodes};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{ROUND_UP, SHAPE_POINT, SURFACE_POINT};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::body::shape::Shape;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::answer::far;
use crate::pair::outcome::{Class, Outcome};
use crate::pair::spot::{Answer, Spot, features_on};

/// The front of the last answer for a surface and a convex [`Shape`], from which the next query
/// starts, the nodes made so far, and counters.
///
/// The counterpart of `SurfaceTracker` for every kind of shape: the shape
/// is not split, and its own support function bounds it. The surface is A and the shape B; for the
/// other order see [`RelativePose::swapped`]. The shape is solid: a surface inside it has the
/// distance zero. Not saved to files, as `SurfaceTracker`.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceShapeTracker {
    state: SurfaceMemory,
    grown: Grown,
    /// Of a point of the surface and the shape.
    feet: ShapeTracker,
    /// A point at the origin.
    point: Option<Shape>,
}

impl Default for SurfaceShapeTracker {
    fn default() -> Self {
        Self {
            state: SurfaceMemory::default(),
            grown: Grown::default(),
            feet: ShapeTracker::new(),
            point: ConvexPolyhedron::point(Point3::origin()).ok().map(Shape::from),
        }
    }
}

impl SurfaceShapeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the bytes kept on the heap, without those of shapes.
    #[must_use]
    pub(crate) fn heap_bytes(&self) -> usize {
        self.grown.heap_bytes() + self.state.heap_bytes()
    }

    /// Returns the closest points at a pose that puts points of B up to `placing` aside.
    pub(super) fn answer_placed(
        &mut self,
        a: &Surface,
        b: &Shape,
        a_from_b: &RelativePose,
        goal: NetGoal,
        placing: f64,
    ) -> Answer {
        let is_full = self.grown.numbers() > KEPT;
        if !self.state.recognises([a.fingerprint, b.fingerprint()], is_full) {
            (self.grown, self.feet) = (Grown::default(), ShapeTracker::new());
        }
        let reach = [a.reach, reach(b)];
        let points = reach[0] * SURFACE_POINT + reach[1] * SHAPE_POINT;
        let (Some(frame), Some(point)) = (NetFrame::new(reach, points, a_from_b), &self.point) else {
            return far_apart(a, b, a_from_b);
        };
        let frame = frame.placed(placing);
        let mut trees = Trees {
            a: Nodes::new(&a.tree, &mut self.grown),
            b: ShapeNode::new(b),
            frame: &frame,
            counts: SearchCounts::default(),
        };
        let mut feet = Feet::new(a.patches(), [point, b], &mut self.feet, &frame, a_from_b);
        match self.state.search(&mut trees, &mut feet, goal) {
            Some((lower, best)) => {
                let on = [best.place(0), Spot::new(0, best.feature)];
                let outcome = Outcome {
                    class: class(lower, best.upper),
                    distance: best.distance.clamped(lower, best.upper),
                    lower,
                    upper: best.upper,
                    point_on_a: best.on_a.into(),
                    point_on_b: best.on_b.into(),
                    normal: Unit::new_unchecked(best.normal.unwrap_or_else(Vector3::x)),
                    ..Outcome::starting_at(features_on(&on))
                };
                let is_reached = goal.is_reached(lower, best.upper);
                Answer {
                    outcome,
                    on,
                    is_reached,
                }
            }
            None => far_apart(a, b, a_from_b),
        }
    }
}

impl BesideSurface for SurfaceShapeTracker {
    type Body = Shape;

    fn ball(body: &Shape) -> (Point3<f64>, f64) {
        body.bounding_ball()
    }

    fn answer(&mut self, a: &Surface, b: &Shape, a_from_b: &RelativePose, goal: NetGoal) -> Answer {
        self.answer_placed(a, b, a_from_b, goal, 0.0)
    }

    fn allow(&mut self, splits: Option<usize>) {
        self.state.allow(splits.unwrap_or(SPLITS));
    }
}

/// An upper bound of zero is proven by a point of the surface within the shape.
pub(super) fn class(lower: f64, upper: f64) -> Class {
    if lower > 0.0 {
        Class::Separated
    } else if upper == 0.0 {
        Class::Overlapping
    } else {
        Class::Undecided
    }
}

/// Returns the largest distance of a point of a shape from the origin, rounded up.
fn reach(shape: &Shape) -> f64 {
    let (centre, radius) = shape.bounding_ball();
    (sqrt(centre.coords.norm_squared()) + radius) * ROUND_UP * ROUND_UP
}

/// Bodies so far apart, or so small beside their distance, that only balls about their origins
/// count.
pub(super) fn far_apart(a: &Surface, b: &Shape, a_from_b: &RelativePose) -> Answer {
    let (lower, upper, n) = far([a.reach, reach(b)], a_from_b);
    let facing = -a_from_b.rotation().tr_mul(&n);
    let on = [Spot::on_patch(0, [0.0; 2]), Spot::new(0, Feature::Vertex(VertexId(0)))];
    let outcome = Outcome {
        class: class(lower, upper),
        distance: 0.5 * lower + 0.5 * upper,
        lower,
        upper,
        point_on_a: a.patches()[0].point(0.0, 0.0),
        point_on_b: (b.core_point(&facing).1 + facing * b.round()).into(),
        normal: Unit::new_unchecked(n),
        ..Outcome::starting_at(features_on(&on))
    };
    Answer {
        outcome,
        on,
        is_reached: false,
    }
}

/// Lowers the lower bound of an answer to that of other pieces.
pub(super) fn lower_to(answer: &mut Answer, lower: f64, goal: NetGoal) {
    let o = &mut answer.outcome;
    o.lower = o.lower.smaller(lower);
    o.distance = o.distance.larger(o.lower);
    o.class = class(o.lower, o.upper);
    answer.is_reached = goal.is_reached(o.lower, o.upper);
}
