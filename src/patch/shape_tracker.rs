//! The state of a surface and a convex shape, and the queries.

use nalgebra::{Point3, Unit, Vector3};

use super::frame::{NetFrame, far};
use super::gap::{SearchCounts, Trees};
use super::outcome::{Decision, SurfacePart, SurfaceShapeOutcome, SurfaceWork};
use super::search::NetGoal;
use super::solid::{Feet, ShapeNode};
use super::state::SurfaceMemory;
use super::surface::{Surface, SurfacePoint};
use super::tree::{Grown, Nodes};
use crate::num::scalar::sqrt;
use crate::pair::outcome::{Class, Distance};
use crate::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::pose::RelativePose;
use crate::shape::Shape;
use crate::shape_tracker::ShapeTracker;
use crate::tolerance::{ROUND_UP, SHAPE_POINT, SURFACE_POINT};
use crate::tuning::patch::KEPT;

/// The front of the last answer for a surface and a convex [`Shape`], from which the next query
/// starts, the nodes made so far, and counters.
///
/// The counterpart of [`SurfaceTracker`](super::SurfaceTracker) for every kind of shape: the shape
/// is not split, and its own support function bounds it. The surface is A and the shape B; for the
/// other order see [`RelativePose::swapped`]. The shape is solid: a surface inside it has the
/// distance zero. Not saved to files, as [`SurfaceTracker`](super::SurfaceTracker).
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
/// use lin_canny::patch::{Patch, Surface, SurfaceShapeTracker};
/// use lin_canny::{RelativePose, Shape};
///
/// // An ellipsoid over the top of a dome.
/// let at = |k: usize| {
///     let (x, y) = ((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0);
///     Point3::new(x, y, -x.abs() - y.abs())
/// };
/// let points: Vec<_> = (0..9).map(at).collect();
/// let dome = Surface::new(vec![Patch::polynomial([2, 2], &points)?])?;
/// let egg = Shape::ellipsoid(Vector3::new(0.3, 0.2, 0.5))?;
/// let mut pair = SurfaceShapeTracker::new();
/// for k in 0..10 {
///     let pose = Isometry3::translation(0.1, 0.0, 2.0 + 0.1 * k as f64);
///     let a_from_b = RelativePose::from_isometry(&pose)?;
///     let c = pair.closest(&dome, &egg, &a_from_b, 1e-9);
///     assert!(c.is_reached && c.upper - c.lower <= 1e-9 && c.lower > 0.5);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SurfaceShapeTracker {
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
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the tracker with another budget: the number of nodes that one query may split,
    /// 20,000 by default and at most `2^22`. A query that uses up its budget returns wider bounds.
    #[must_use]
    pub fn with_budget(mut self, splits: usize) -> Self {
        self.state.allow(splits);
        self
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the front that is kept for this pair: parts of the surface that are proven apart
    /// from the shape, under which every patch lies. Empty for a pair other than that of the last
    /// query.
    pub fn front<'t>(&'t self, a: &'t Surface, b: &Shape) -> impl Iterator<Item = SurfacePart> + 't {
        let entries = self.state.entries([a.fingerprint, b.fingerprint()]);
        entries
            .iter()
            .map(|e| SurfacePart::of(self.grown.node(&a.tree, e.pair[0])))
    }

    /// Returns the bytes kept on the heap, without those of shapes.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        self.grown.heap_bytes() + self.state.heap_bytes()
    }

    /// Forgets everything that is kept, counters too; the budget stays.
    pub fn reset(&mut self) {
        self.state.reset();
        (self.grown, self.feet) = (Grown::default(), ShapeTracker::new());
    }

    /// Returns the closest points with bounds of the distance that are at most `width` apart, a
    /// length in the caller's unit. A width that is no number, or that is below
    /// [`PATCH_LIMIT`](crate::tolerance::PATCH_LIMIT) times the size L (the farthest points of both
    /// bodies from their origins, and the distance of the origins), is taken as that limit.
    pub fn closest(&mut self, a: &Surface, b: &Shape, a_from_b: &RelativePose, width: f64) -> SurfaceShapeOutcome {
        self.answer(a, b, a_from_b, NetGoal::Width(width))
    }

    /// Returns the distance with bounds that are at most `width` apart, as
    /// [`closest`](Self::closest).
    pub fn distance(&mut self, a: &Surface, b: &Shape, a_from_b: &RelativePose, width: f64) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b, width))
    }

    /// Decides whether a point of the surface lies in the shape. Pairs that merely touch stay
    /// undecided.
    pub fn intersects(&mut self, a: &Surface, b: &Shape, a_from_b: &RelativePose) -> Decision {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Decides whether the distance is at most `d`, a length in the caller's unit. Undecided only
    /// if `d` is within rounding of the distance, or the budget is too small.
    pub fn within(&mut self, a: &Surface, b: &Shape, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let found = self.answer(a, b, a_from_b, NetGoal::Within(d));
        Decision::by(found.lower, found.upper, d)
    }

    /// Returns the closest points with bounds as close as a goal asks for.
    pub(super) fn answer(
        &mut self,
        a: &Surface,
        b: &Shape,
        a_from_b: &RelativePose,
        goal: NetGoal,
    ) -> SurfaceShapeOutcome {
        self.answer_placed(a, b, a_from_b, goal, 0.0)
    }

    /// Returns the closest points at a pose that puts points of B up to `placing` aside.
    pub(super) fn answer_placed(
        &mut self,
        a: &Surface,
        b: &Shape,
        a_from_b: &RelativePose,
        goal: NetGoal,
        placing: f64,
    ) -> SurfaceShapeOutcome {
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
            Some((lower, best)) => SurfaceShapeOutcome {
                class: class(lower, best.upper),
                distance: best.distance.clamp(lower, best.upper),
                lower,
                upper: best.upper,
                is_reached: goal.is_reached(lower, best.upper),
                on_a: best.place(0),
                point_on_a: best.on_a.into(),
                point_on_b: best.on_b.into(),
                normal: Unit::new_unchecked(best.normal.unwrap_or_else(Vector3::x)),
                feature: best.feature,
            },
            None => far_apart(a, b, a_from_b),
        }
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
pub(super) fn far_apart(a: &Surface, b: &Shape, a_from_b: &RelativePose) -> SurfaceShapeOutcome {
    let (lower, upper, n) = far([a.reach, reach(b)], a_from_b);
    let facing = -a_from_b.rotation().tr_mul(&n);
    SurfaceShapeOutcome {
        class: class(lower, upper),
        distance: 0.5 * lower + 0.5 * upper,
        lower,
        upper,
        is_reached: false,
        on_a: SurfacePoint::default(),
        point_on_a: a.patches()[0].point(0.0, 0.0),
        point_on_b: (b.core_point(&facing).1 + facing * b.round()).into(),
        normal: Unit::new_unchecked(n),
        feature: Feature::Vertex(VertexId(0)),
    }
}
