//! A point and the subshapes of a body: triangles, pieces of a compound, elements of a cloud.
//!
//! Compounds and clouds are unions: a point outside all of them is as far as the closest, a point
//! inside of one is inside. The deepest one bounds the distance from above, the box of the body
//! from below.

use alloc::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::num::double_double::Expansion;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{FAR_POINT, POINT_ELEMENT, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::body::shape::{Core, Shape};
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::query::near::TreePoint;
use crate::pair::draft::unit;
use crate::pair::location::WitnessLocation;
use crate::pair::outcome::ContactState;
use crate::pair::point::PointOutcome;

/// Subshapes whose distance from a point can be measured one by one.
pub(crate) trait NearItems: Parted {
    /// Returns the outcome of one item and a point in the caller's coordinates.
    fn outcome_of_item(&self, item: u32, point: &Point3<f64>) -> PointOutcome;
}

/// Calls `keep` with the outcome of each item whose lower bound may be at most a level.
///
/// The level is the distance that the last call returned, in the caller's unit; at the start it is
/// `level`. All items with a lower bound of at most the last level are among those passed.
fn search(body: &impl NearItems, point: &Point3<f64>, level: f64, mut keep: impl FnMut(PointOutcome) -> f64) {
    let (side, unit) = (body.side(), body.stored_unit());
    let place = side.frame.stored(point);
    let size = f64::from(side.tree.reach) * side.tree.unit();
    let (mut level, start) = (level, level.at_least(0.0) / unit);
    let mut each = |items: core::ops::Range<u32>| {
        for item in items {
            let found = body.outcome_of_item(item, point);
            if found.lower <= level {
                level = keep(found);
            }
        }
        // A level below zero admits what contains the point.
        level.at_least(0.0) / unit
    };
    if (place - side.tree.centre).amax() > FAR_POINT * size.at_least(f64::MIN_POSITIVE) {
        // All items are equally far, up to rounding.
        each(side.tree.range(0));
        return;
    }
    TreePoint::new(side.tree, &place, 0.0).descend(&mut Vec::new(), start, each);
}

/// Returns the order of outcomes: by upper bound, then by subshape.
pub(super) fn order(a: &PointOutcome, b: &PointOutcome) -> core::cmp::Ordering {
    let by_index = || a.location.subshape.cmp(&b.location.subshape);
    a.upper.total_cmp(&b.upper).then_with(by_index)
}

/// Returns the `count` subshapes nearest to a point, in rising order of their upper bounds.
pub(crate) fn nearest(body: &impl NearItems, point: &Point3<f64>, count: usize) -> Vec<PointOutcome> {
    let mut found: Vec<PointOutcome> = Vec::new();
    if count == 0 {
        return found;
    }
    search(body, point, f64::INFINITY, |new| {
        let at = found.partition_point(|old| order(old, &new).is_lt());
        if at < count {
            found.insert(at, new);
            found.truncate(count);
        }
        if found.len() < count {
            f64::INFINITY
        } else {
            found[count - 1].upper
        }
    });
    found
}

/// Returns the subshapes that may be at most `d` from a point, in rising order of their upper
/// bounds.
pub(crate) fn within(body: &impl NearItems, point: &Point3<f64>, d: f64) -> Vec<PointOutcome> {
    let mut found = Vec::new();
    if d.is_nan() {
        return found;
    }
    search(body, point, d, |new| {
        found.push(new);
        d
    });
    sort(&mut found, order);
    found
}

/// Returns the outcome of a point and a union of solid items.
pub(crate) fn outcome_of_union(body: &impl NearItems, point: &Point3<f64>) -> PointOutcome {
    let mut found: Vec<PointOutcome> = Vec::new();
    let mut level = f64::INFINITY;
    search(body, point, level, |new| {
        found.push(new);
        level = level.smaller(new.upper);
        level.at_least(0.0)
    });
    found.retain(|item| item.lower <= level.at_least(0.0));
    let has = |state: ContactState| found.iter().any(|item| item.state == state);
    let state = [
        ContactState::Overlapping,
        ContactState::Undecided,
        ContactState::Touching,
    ];
    let state = state.into_iter().find(|s| has(*s)).unwrap_or(ContactState::Separated);
    // A body has an item. Inside, the deepest one is the closest.
    let of_state = found.iter().filter(|item| item.state == state);
    let Some(best) = of_state.min_by(|a, b| order(a, b)).copied() else {
        return body.outcome_of_item(0, point);
    };
    let least = found.iter().fold(best.lower, |least, item| least.smaller(item.lower));
    let lower = match state {
        ContactState::Overlapping if !body.side().tree.is_alone() => best.upper.smaller(-room_in_box(body, point)),
        ContactState::Separated => least.at_least(0.0),
        ContactState::Touching => 0.0,
        _ => least,
    };
    let upper = if state == ContactState::Undecided {
        level
    } else {
        best.upper
    };
    PointOutcome {
        state,
        lower,
        upper,
        distance: best.distance.clamped(lower, upper),
        ..best
    }
}

/// Returns an upper bound of the distance of a point to the outside of the box of a body.
fn room_in_box(body: &impl Parted, point: &Point3<f64>) -> f64 {
    let origin = body.side().frame.origin;
    let (low, high) = body.corners_of_box();
    let least = (0..3).fold(f64::INFINITY, |least, k| {
        least.smaller(high[k] - point[k]).smaller(point[k] - low[k])
    });
    // The box contains the body up to a rounding of its corners.
    let far = (low - origin).coords.amax().larger((high - origin).coords.amax());
    least.at_least(0.0) + 64.0 * UNIT * far + 4.0 * UNIT * origin.amax()
}

/// Returns the outcome of a shape at a pose and a point.
pub(crate) fn outcome_of_shape(
    shape: &Shape,
    pose: &Isometry3<f64>,
    point: &Point3<f64>,
    subshape: u32,
) -> PointOutcome {
    let origin = &Shape::from(ConvexPolyhedron::origin());
    let at = Isometry3::translation(point.x, point.y, point.z);
    // Both poses were checked. The bounds are those of the pose as stored.
    let placed = RelativePose::new(pose, &at).unwrap_or_else(|_| RelativePose::identity());
    let mut tracker = ShapeTracker::new();
    let found = tracker.closest(shape, origin, &placed);
    let mut outcome = PointOutcome {
        state: PointOutcome::state_of(found.lower, found.upper),
        distance: found.distance,
        lower: found.lower,
        upper: found.upper,
        point: pose * found.point_on_a,
        normal: pose.rotation * found.normal,
        location: WitnessLocation::new(subshape, found.features.a),
    };
    if let Core::Polyhedron(body) = shape.core() {
        if *pose == Isometry3::identity() && shape.rounding_radius() == 0.0 {
            outcome.set_side(body.side_of(point));
        } else if outcome.state == ContactState::Undecided && !tracker.within(shape, origin, &placed, 0.0) {
            outcome.set_side(1);
        }
    }
    outcome
}

/// Returns the outcome of a ball and a point.
pub(crate) fn outcome_of_ball(centre: &Vector3<f64>, radius: f64, point: &Point3<f64>, subshape: u32) -> PointOutcome {
    let apart = point.coords - centre;
    let size = apart.amax();
    let distance = if size > 0.0 {
        size * sqrt((apart / size).norm_squared())
    } else {
        0.0
    };
    let normal = unit(&apart);
    let error = POINT_ELEMENT * (distance + radius);
    let value = distance - radius;
    let (lower, upper) = (value - error, value + error);
    let feature = Feature::Vertex(VertexId(0));
    let mut outcome = PointOutcome {
        state: PointOutcome::state_of(lower, upper),
        distance: value,
        lower,
        upper,
        point: Point3::from(centre + normal.into_inner() * radius),
        normal,
        location: WitnessLocation::new(subshape, feature),
    };
    if radius == 0.0 {
        outcome.set_side(i32::from(size > 0.0));
    }
    outcome
}

/// Returns the outcome of a box along the axes and a point; the side is exact.
pub(crate) fn outcome_of_box(
    centre: &Vector3<f64>,
    half: &Vector3<f64>,
    point: &Point3<f64>,
    subshape: u32,
) -> PointOutcome {
    let apart = point.coords - centre;
    let over = apart.abs() - half;
    let outside = over.map(|x| x.at_least(0.0));
    let size = outside.amax();
    let axis = over.imax();
    let mut own = Vector3::zeros();
    own[axis] = if apart[axis] < 0.0 { -1.0 } else { 1.0 };
    let signed = |v: Vector3<f64>| v.zip_map(&apart, |x, s| if s < 0.0 { -x } else { x });
    let (value, normal) = if size > 0.0 {
        (
            size * sqrt((outside / size).norm_squared()),
            unit(&signed(outside)).into_inner(),
        )
    } else {
        (over[axis], own)
    };
    let foot = if size > 0.0 {
        apart - signed(outside)
    } else {
        apart - own * value
    };
    let error = POINT_ELEMENT * (apart.amax() + half.amax());
    let excess = |k: usize| {
        [1.0, -1.0].map(|way| {
            let mut sum = Expansion::<4>::new();
            [way * point[k], -way * centre[k], -half[k]]
                .iter()
                .for_each(|x| sum.add(*x));
            sum.sign()
        })
    };
    let side = (0..3).flat_map(excess).max().unwrap_or(1);
    let mut outcome = PointOutcome {
        state: ContactState::Undecided,
        distance: value,
        lower: value - error,
        upper: value + error,
        point: Point3::from(centre + foot),
        normal: nalgebra::Unit::new_unchecked(normal),
        location: WitnessLocation::new(subshape, Feature::Vertex(VertexId(0))),
    };
    outcome.set_side(side);
    outcome
}
