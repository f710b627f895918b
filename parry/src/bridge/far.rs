//! Pairs that are proven far from each other without a solver, in the engine's own numbers.

use super::hull::Hull;
use super::manifold::exchange;
use super::parry::bounding_volume::BoundingSphere;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::{PackedFeatureId, Shape, SupportMap};

/// Rounding of the gap between two balls at a pose of the engine, over the lengths that are summed:
/// a normalized rotation, a turned centre, two sums of vectors, a length and three sums take fewer
/// roundings than this. So does the height of two support points along a normal, over what the
/// shapes reach from their origins: some ten roundings of a turned normal, as many of a support
/// point, and [`LONGER`].
const ROUNDING: Real = 64.0 * Real::EPSILON;

/// How far from one the length of a normal may be.
const LONGER: Real = 8.0 * Real::EPSILON;

/// Returns a ball about a shape by a few operations, or one that is stored with the shape; `None` for
/// a kind of which parry looks at every point.
fn ball(shape: &dyn Shape) -> Option<BoundingSphere> {
    if let Some(hull) = shape.as_shape::<Hull>() {
        return Some(hull.ball);
    }
    let at = |radius: Real| Some(BoundingSphere::new(Vector::ZERO, radius));
    // Not by a root: at most 9 % too far, and right for lengths whose squares are no numbers.
    let tall = |half: Real, radius: Real| half.max(radius) + 0.41422 * half.min(radius);
    if let Some(s) = shape.as_ball() {
        at(s.radius)
    } else if let Some(s) = shape.as_cuboid() {
        at(s.half_extents.length())
    } else if let Some(s) = shape.as_capsule() {
        let (a, b) = (s.segment.a, s.segment.b);
        Some(BoundingSphere::new((a + b) * 0.5, (b - a).length() * 0.5 + s.radius))
    } else if let Some(s) = shape.as_segment() {
        Some(BoundingSphere::new((s.a + s.b) * 0.5, (s.b - s.a).length() * 0.5))
    } else if let Some(s) = shape.as_triangle() {
        let centre = (s.a + s.b + s.c) / 3.0;
        let radius = s.vertices().iter().fold(0.0, |r: Real, p| r.max((p - centre).length()));
        Some(BoundingSphere::new(centre, radius))
    } else if let Some(s) = shape.as_cylinder() {
        at(tall(s.half_height, s.radius))
    } else if let Some(s) = shape.as_cone() {
        at(tall(s.half_height, s.radius))
    } else if let Some(s) = shape.as_round_cuboid() {
        at(s.inner_shape.half_extents.length() + s.border_radius)
    } else if let Some(s) = shape.as_round_cylinder() {
        at(tall(s.inner_shape.half_height, s.inner_shape.radius) + s.border_radius)
    } else if let Some(s) = shape.as_round_cone() {
        at(tall(s.inner_shape.half_height, s.inner_shape.radius) + s.border_radius)
    } else {
        None
    }
}

/// Returns whether balls about two shapes are farther apart than a distance, by more than rounding.
/// False for a pose that is no pose, and for kinds without a ball at hand.
pub(super) fn are_far(pos12: &Pose, (a, b): (&dyn Shape, &dyn Shape), distance: Real) -> bool {
    let balls = ball(a).zip(ball(b));
    balls.is_some_and(|(a, b)| are_balls_far(pos12, (&a, &b), distance))
}

/// Returns whether two balls, each in the frame of its shape, are farther apart than a distance, by
/// more than rounding.
pub(super) fn are_balls_far(pos12: &Pose, (a, b): (&BoundingSphere, &BoundingSphere), distance: Real) -> bool {
    let turn = pos12.rotation.normalize();
    let between = (pos12.translation + turn * b.center - a.center).length();
    let reach = a.radius + b.radius + distance;
    let rounding = pos12.translation.length() + a.center.length() + b.center.length() + reach;
    between - reach > ROUNDING * rounding
}

/// The planes between two shapes: any proves a distance.
pub(super) struct Planes<'a> {
    pos12: &'a Pose,
    a: &'a dyn SupportMap,
    b: &'a dyn SupportMap,
    /// What both shapes reach from their origins; infinite for kinds without a ball at hand.
    reach: Real,
}

impl<'a> Planes<'a> {
    /// Returns `None` for shapes without support points.
    pub(super) fn new(pos12: &'a Pose, (of_a, of_b): (&'a dyn Shape, &'a dyn Shape)) -> Option<Self> {
        let (a, b) = (of_a.as_support_map()?, of_b.as_support_map()?);
        let reach = |shape| ball(shape).map_or(Real::INFINITY, |ball| ball.center.length() + ball.radius);
        let reach = reach(of_a) + reach(of_b);
        Some(Self { pos12, a, b, reach })
    }

    /// Returns the contact of the points farthest along a normal of each shape.
    pub(super) fn contact<C: Default + Copy>(&self, n1: Vector, n2: Vector, dist: Real) -> TrackedContact<C> {
        let none = PackedFeatureId::UNKNOWN;
        let points = [self.a.local_support_point(n1), self.b.local_support_point(n2)];
        TrackedContact::new(points[0], points[1], none, none, dist)
    }

    /// If the plane along the normal that was kept proves that the shapes are farther apart than a
    /// distance, writes its contact. Returns whether it does.
    pub(super) fn write_beyond<M, C: Default + Copy>(&self, distance: Real, out: &mut ContactManifold<M, C>) -> bool {
        let (n1, turn) = (out.local_n1, self.pos12.rotation.normalize());
        let n2 = -(turn.inverse() * n1);
        let mut found = self.contact(n1, n2, 0.0);
        let at = self.pos12.translation + turn * found.local_p2;
        let height = n1.dot(at - found.local_p1);
        let rounding = ROUNDING * (self.reach + self.pos12.translation.length() + distance);
        // NaN is not far.
        if !(height - distance > rounding && (n1.length() - 1.0).abs() < LONGER) {
            return false;
        }
        found.dist = height;
        out.local_n2 = n2;
        exchange(out, |points| points.push(found));
        true
    }
}
