//! Proves that pairs are far apart without a solver, in the engine's numbers.

use super::contact::exchange;
use super::hull::Hull;
use super::parry::bounding_volume::BoundingSphere;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::{PackedFeatureId, Shape, SupportMap};

/// Rounding error of the gap between two balls at a pose, divided by the lengths that are summed.
///
/// A normalised rotation, a rotated centre, two sums of vectors, a length and three sums take fewer
/// roundings than this. So does the height of two support points along a normal, divided by the
/// extents of the shapes: about ten roundings of a rotated normal, as many of a support point, and
/// [`LONGER`].
const ROUNDING: Real = 64.0 * Real::EPSILON;

/// Largest deviation of the length of a normal from one.
const LONGER: Real = 8.0 * Real::EPSILON;

/// Returns a ball around a shape that costs a few operations or is stored with the shape.
///
/// Returns `None` for a kind for which parry reads every point.
fn ball(shape: &dyn Shape) -> Option<BoundingSphere> {
    if let Some(hull) = shape.as_shape::<Hull>() {
        return Some(hull.ball);
    }
    let at = |radius: Real| Some(BoundingSphere::new(Vector::ZERO, radius));
    // Without a square root: at most 9 % too large, and valid if squares overflow.
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

/// Returns whether balls around two shapes are farther apart than a distance, by more than
/// rounding.
///
/// Returns false for an invalid pose, and for kinds without a cheap ball.
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

/// The planes between two shapes; each of them proves a distance.
pub(super) struct Planes<'a> {
    pos12: &'a Pose,
    a: &'a dyn SupportMap,
    b: &'a dyn SupportMap,
    /// Sum of the extents of both shapes from their origins; infinite for kinds without a cheap
    /// ball.
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

    /// Returns the contact of the support points along a normal of each shape.
    pub(super) fn contact<C: Default + Copy>(&self, n1: Vector, n2: Vector, dist: Real) -> TrackedContact<C> {
        let none = PackedFeatureId::UNKNOWN;
        let points = [self.a.local_support_point(n1), self.b.local_support_point(n2)];
        TrackedContact::new(points[0], points[1], none, none, dist)
    }

    /// Writes the contact of the plane along the kept normal, if this plane proves that the shapes
    /// are farther apart than a distance. Returns whether it does.
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

#[cfg(test)]
mod tests {
    use lin_canny::{PairTracker, RelativePose};
    use truth::rng::Rng;

    use super::super::hull::Hull;
    use super::super::mesh::geometry;
    use super::super::number::isometry;
    use super::super::parry::math::Rotation;
    use super::super::parry::shape::SharedShape;
    use super::*;

    const SIZES: [Real; 5] = [1e-4, 1e-2, 1.0, 100.0, 1e4];

    fn vector(rng: &mut Rng, length: Real) -> Vector {
        Vector::from(rng.unit().map(|x| x as Real)) * length
    }

    /// One shape of each kind with a cheap ball.
    fn kinds(rng: &mut Rng, size: Real) -> Vec<SharedShape> {
        let mut side = || size * rng.range(0.1, 0.6) as Real;
        let (x, y, z, border) = (side(), side(), side(), 0.1 * size);
        let [a, b, c, d] = [0; 4].map(|_| vector(rng, 0.6 * size));
        let hull = Hull::from_points(&[a, b, c, d]).expect("a solid");
        vec![
            SharedShape::ball(x),
            SharedShape::cuboid(x, y, z),
            SharedShape::capsule(a, b, y),
            SharedShape::segment(a, b),
            SharedShape::triangle(a, b, c),
            SharedShape::cylinder(x, y),
            SharedShape::cylinder(y, x),
            SharedShape::cone(x, y),
            SharedShape::round_cuboid(x, y, z, border),
            SharedShape::round_cylinder(x, y, border),
            SharedShape::round_cone(x, y, border),
            SharedShape::from(hull.rounded(border).expect("a radius")),
            SharedShape::from(hull),
        ]
    }

    fn pose(rng: &mut Rng, apart: Real) -> Pose {
        let [i, j, k, w] = rng.quat().map(|x| x as Real);
        Pose::from_parts(vector(rng, apart), Rotation::from_xyzw(i, j, k, w).normalize())
    }

    /// Returns the distance of two shapes, proven from above.
    fn distance(pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> f64 {
        let ((a, of_a), (b, of_b)) = (geometry(a).expect("a kind"), geometry(b).expect("a kind"));
        let at = RelativePose::new(&of_a, &(isometry(pos12) * of_b)).expect("a pose");
        PairTracker::new().closest(&a, &b, &at).upper
    }

    #[test]
    fn balls_hold_their_shapes_and_are_not_much_larger() {
        for size in SIZES {
            let mut rng = Rng::new(81);
            for _ in 0..20 {
                for shape in kinds(&mut rng, size) {
                    let ball = ball(&*shape).expect("a ball");
                    let map = shape.as_support_map().expect("a support map");
                    for _ in 0..20 {
                        let direction = vector(&mut rng, 1.0);
                        let far = (map.local_support_point(direction) - ball.center).length();
                        assert!(far <= ball.radius * (1.0 + 8.0 * Real::EPSILON), "{far} {ball:?}");
                    }
                    let least = shape.compute_local_aabb().half_extents().max_element();
                    // Of a triangle the centroid need not be the middle.
                    assert!(ball.radius < 2.1 * least, "{ball:?} {least} {:?}", shape.shape_type());
                }
            }
        }
    }

    #[test]
    fn what_is_told_far_is_farther() {
        let (mut far, mut near) = (0, 0);
        for size in SIZES {
            let mut rng = Rng::new(82);
            for _ in 0..6 {
                let list = kinds(&mut rng, size);
                for (a, b) in list.iter().flat_map(|a| list.iter().map(move |b| (a, b))) {
                    let apart = size * rng.range(0.3, 2.5) as Real;
                    let pos12 = pose(&mut rng, apart);
                    let true_gap = distance(&pos12, &**a, &**b);
                    let asked = size * rng.range(0.0, 0.5) as Real;
                    if are_far(&pos12, (&**a, &**b), asked) {
                        assert!(true_gap > f64::from(asked), "{true_gap} {asked}");
                        far += 1;
                    } else {
                        near += 1;
                    }
                    // A distance within the balls of the gap is never far.
                    assert!(!are_far(&pos12, (&**a, &**b), apart));
                    let beyond = Pose::from_parts(pos12.translation * 20.0, pos12.rotation);
                    assert!(
                        are_far(&beyond, (&**a, &**b), apart),
                        "{:?} {:?}",
                        a.shape_type(),
                        b.shape_type()
                    );
                }
            }
        }
        assert!(far > 1000 && near > 1000, "{far} {near}");
        let ball = SharedShape::ball(1.0);
        let bad = Pose::translation(Real::NAN, 0.0, 0.0);
        assert!(
            !are_far(&bad, (&*ball, &*ball), 0.0)
                && !are_far(&Pose::translation(9.0, 0.0, 0.0), (&*ball, &*ball), Real::NAN)
        );
    }

    #[test]
    fn planes_prove_what_they_write() {
        let (mut proven, mut refused) = (0, 0);
        for size in SIZES {
            let mut rng = Rng::new(83);
            for _ in 0..6 {
                let list = kinds(&mut rng, size);
                for (a, b) in list.iter().flat_map(|a| list.iter().map(move |b| (a, b))) {
                    let apart = size * rng.range(0.3, 2.5) as Real;
                    let pos12 = pose(&mut rng, apart);
                    let (true_gap, asked) = (distance(&pos12, &**a, &**b), size * rng.range(0.0, 0.3) as Real);
                    let planes = Planes::new(&pos12, (&**a, &**b)).expect("support points");
                    let toward = pos12.translation.normalize() + vector(&mut rng, 0.2);
                    let mut out = ContactManifold::<(), u32>::new();
                    out.local_n1 = toward.normalize();
                    out.points.push(planes.contact(out.local_n1, -out.local_n1, 0.0));
                    let before = out.clone();
                    if !planes.write_beyond(asked, &mut out) {
                        assert_eq!(out.points.len(), 1);
                        assert_eq!(out.local_n2, before.local_n2);
                        refused += 1;
                        continue;
                    }
                    let p = &out.points[0];
                    let close = 1e-5 * size;
                    assert!(
                        p.dist > asked && f64::from(p.dist) <= true_gap + f64::from(close),
                        "{p:?} {true_gap}"
                    );
                    let reported = (pos12 * p.local_p2 - p.local_p1).dot(out.local_n1);
                    assert!((reported - p.dist).abs() < close, "{reported} {p:?}");
                    assert!((pos12.rotation * out.local_n2 + out.local_n1).length() < 1e-5);
                    // A normal that is longer, or none, proves nothing.
                    for bad in [out.local_n1 * 1.01, Vector::ZERO, Vector::splat(Real::NAN)] {
                        out.local_n1 = bad;
                        assert!(!planes.write_beyond(asked, &mut out), "{bad:?}");
                    }
                    proven += 1;
                }
            }
        }
        assert!(proven > 1000 && refused > 1000, "{proven} {refused}");
    }
}
