//! The query dispatcher.

use std::sync::Arc;

use lin_canny::nalgebra::{Point3, UnitQuaternion};
use lin_canny::{Class, Outcome, RelativePose, ShapeTracker};

use super::cast::{self, Flown};
use super::half_space;
use super::known::Known;
use super::manifold::{PosedPair, is_far};
use super::number::{isometry, narrow};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::{
    NormalConstraints, ShapeCastOptions, cast_shapes_composite_shape_shape,
    cast_shapes_nonlinear_composite_shape_shape, cast_shapes_nonlinear_shape_composite_shape,
    cast_shapes_shape_composite_shape, closest_points_composite_shape_shape, closest_points_shape_composite_shape,
    contact_composite_shape_shape, contact_manifolds_composite_shape_composite_shape,
    contact_manifolds_composite_shape_shape, contact_shape_composite_shape, distance_composite_shape_shape,
    distance_shape_composite_shape, intersection_test_composite_shape_shape, intersection_test_shape_composite_shape,
};
use super::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use super::parry::shape::{CompositeShape, Cuboid, Shape, ShapeType};
use super::part::{self, Placed};

/// Which contacts a manifold holds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactOptions {
    /// Sine of the largest angle between the normal and a face that bears the contact. Default 1/2;
    /// at 1/64 piles of round hulls penetrate 1.3 times as deep.
    pub sine: Real,
    /// Prediction of a manifold over the prediction asked for. Default 4: an engine drops the
    /// contacts that do not close within a step, and piles of hulls penetrate half as deep as with
    /// 1.
    pub reach: Real,
    /// Largest number of points of a manifold, 1 to 8. Default 8; rapier reduces to 4 by itself.
    pub max_points: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            sine: 0.5,
            reach: 4.0,
            max_points: 8,
        }
    }
}

/// Query dispatcher that answers convex shapes by [`lin_canny`] and all others by parry: see the
/// table on the page of the crate `lin_canny_parry`.
///
/// A manifold depends on the relative pose and on the contacts kept in it, and on nothing else.
/// Cheap to clone; clones share the bodies that were made of cuboids, balls, capsules and plain
/// polyhedra.
///
/// ```
/// use lin_canny_parry::single::{Certified, parry};
/// use parry::math::{Pose, Vector};
/// use parry::query::QueryDispatcher;
/// use parry::shape::{Capsule, Cuboid};
///
/// let (cuboid, capsule) = (Cuboid::new(Vector::splat(1e-3)), Capsule::new_y(2e-3, 5e-4));
/// let pose = Pose::translation(2.5e-3, 0.0, 0.0);
/// let gap = Certified::default().distance(&pose, &cuboid, &capsule).unwrap().distance;
/// assert!((gap - 1e-3).abs() < 1e-9);
/// ```
#[derive(Clone, Default)]
pub struct Certified {
    options: ContactOptions,
    known: Arc<Known>,
}

impl std::fmt::Debug for Certified {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Certified")
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl Certified {
    /// Returns a dispatcher with options.
    #[must_use]
    pub fn new(options: ContactOptions) -> Self {
        Self {
            options,
            known: Arc::default(),
        }
    }

    /// Returns the options of its manifolds.
    #[must_use]
    pub fn options(&self) -> ContactOptions {
        self.options
    }

    /// Returns two shapes that [`lin_canny`] has at their pose; `None` for a pose that is not
    /// finite and for pairs with a closed form.
    fn posed(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Option<PosedShapes> {
        let (a, b) = part::placed(&self.known, a, b)?;
        let isometry = isometry(pos12);
        let pose = RelativePose::new(&a.at, &(isometry * b.at)).ok()?;
        let turn = isometry.rotation;
        Some(PosedShapes { a, b, pose, turn })
    }
}

/// Two shapes at a pose.
struct PosedShapes {
    a: Placed,
    b: Placed,
    pose: RelativePose,
    /// Rotation from the frame of the engine's second shape to the frame of its first.
    turn: UnitQuaternion<f64>,
}

impl PosedShapes {
    fn closest(&self) -> Outcome {
        ShapeTracker::new().closest(&self.a.shape, &self.b.shape, &self.pose)
    }

    fn intersects(&self) -> bool {
        ShapeTracker::new().intersects(&self.a.shape, &self.b.shape, &self.pose)
    }

    /// Returns the contact in the frames of the two shapes of the engine.
    fn contact(&self, outcome: &Outcome) -> Contact {
        let on = |placed: &Placed, p: &Point3<f64>| narrow(&(placed.at * p).coords);
        let n1 = self.a.at.rotation * outcome.normal.into_inner();
        let n2 = -self.turn.inverse_transform_vector(&n1);
        Contact::new(
            on(&self.a, &outcome.point_on_a),
            on(&self.b, &outcome.point_on_b),
            narrow(&n1),
            narrow(&n2),
            outcome.distance as Real,
        )
    }
}

/// Returns a shape made of convex parts, which are asked for one by one.
fn compound(shape: &dyn Shape) -> Option<&(dyn CompositeShape + Sync)> {
    shape.as_compound().and_then(|_| shape.as_composite_shape())
}

/// Returns whether a shape is no composite, mesh, height field or voxels.
fn is_single(shape: &dyn Shape) -> bool {
    shape.as_composite_shape().is_none() && !matches!(shape.shape_type(), ShapeType::Voxels | ShapeType::HeightField)
}

impl QueryDispatcher for Certified {
    fn intersection_test(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<ShapeIntersection, Unsupported> {
        if let Some(posed) = self.posed(pos12, a, b) {
            return Ok(posed.intersects().into());
        }
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(intersection_test_composite_shape_shape(self, pos12, c, b)),
            (_, Some(c)) => Ok(intersection_test_shape_composite_shape(self, pos12, a, c)),
            _ => parrys(pos12, a, b)?.intersection_test(pos12, a, b),
        }
    }

    fn distance(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        if let Some(posed) = self.posed(pos12, a, b) {
            return Ok(ShapeDistance::new(posed.closest().distance.max(0.0) as Real));
        }
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(distance_composite_shape_shape(self, pos12, c, b)),
            (_, Some(c)) => Ok(distance_shape_composite_shape(self, pos12, a, c)),
            _ => parrys(pos12, a, b)?.distance(pos12, a, b),
        }
    }

    fn contact(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        if let Some(posed) = self.posed(pos12, a, b) {
            let outcome = posed.closest();
            let is_near = outcome.distance <= f64::from(prediction);
            return Ok(is_near.then(|| posed.contact(&outcome)));
        }
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(contact_composite_shape_shape(self, pos12, c, b, prediction)),
            (_, Some(c)) => Ok(contact_shape_composite_shape(self, pos12, a, c, prediction)),
            _ => parrys(pos12, a, b)?.contact(pos12, a, b, prediction),
        }
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        if let Some(posed) = self.posed(pos12, a, b) {
            let outcome = posed.closest();
            let contact = posed.contact(&outcome);
            return Ok(match outcome.class {
                Class::Overlapping | Class::Touching => ClosestPoints::Intersecting,
                _ if outcome.distance <= f64::from(max_dist) => {
                    ClosestPoints::WithinMargin(contact.point1, contact.point2)
                }
                _ => ClosestPoints::Disjoint,
            });
        }
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(closest_points_composite_shape_shape(self, pos12, c, b, max_dist)),
            (_, Some(c)) => Ok(closest_points_shape_composite_shape(self, pos12, a, c, max_dist)),
            _ => parrys(pos12, a, b)?.closest_points(pos12, a, b, max_dist),
        }
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        vel12: Vector,
        a: &dyn Shape,
        b: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        // parry has a closed form for two balls.
        let are_balls = a.as_ball().is_some() && b.as_ball().is_some();
        let pair = if are_balls { None } else { part::cast(&self.known, a, b) };
        if let Some((on_a, on_b)) = pair.filter(|_| pos12.is_finite()) {
            match cast::linear((&on_a, &on_b), pos12, vel12, &options) {
                Flown::Free => return Ok(None),
                Flown::Hit(hit) | Flown::Start(hit) => return Ok(Some(hit)),
                Flown::Refused => {}
            }
        }
        match (compound(a), compound(b)) {
            (Some(c), _) if pos12.is_finite() => {
                Ok(cast_shapes_composite_shape_shape(self, pos12, vel12, c, b, options))
            }
            (_, Some(c)) if pos12.is_finite() => {
                Ok(cast_shapes_shape_composite_shape(self, pos12, vel12, a, c, options))
            }
            _ if vel12.is_finite() && has_length(a) && has_length(b) => {
                parrys(pos12, a, b)?.cast_shapes(pos12, vel12, a, b, options)
            }
            _ => Err(Unsupported),
        }
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        a: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        b: &dyn Shape,
        start: Real,
        end: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let (x, y) = (motion1, motion2);
        if let Some((on_a, on_b)) = part::cast(&self.known, a, b) {
            match cast::nonlinear((&on_a, &on_b), (x, y), (start, end)) {
                Flown::Free => return Ok(None),
                Flown::Hit(hit) => return Ok(Some(hit)),
                Flown::Start(hit) if stop_at_penetration => return Ok(Some(hit)),
                // What happens after a penetration at the start is asked of parry.
                Flown::Start(_) | Flown::Refused => {}
            }
        }
        let stop = stop_at_penetration;
        match (compound(a), compound(b)) {
            (Some(c), _) if is_finite(x) && is_finite(y) => Ok(cast_shapes_nonlinear_composite_shape_shape(
                self, x, c, y, b, start, end, stop,
            )),
            (_, Some(c)) if is_finite(x) && is_finite(y) => Ok(cast_shapes_nonlinear_shape_composite_shape(
                self, x, a, y, c, start, end, stop,
            )),
            _ if is_finite(x) && is_finite(y) && has_length(a) && has_length(b) => {
                parrys(&x.start, a, b)?.cast_shapes_nonlinear(x, a, y, b, start, end, stop)
            }
            _ => Err(Unsupported),
        }
    }
}

impl<M, C> PersistentQueryDispatcher<M, C> for Certified
where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        prediction: Real,
        out: &mut Vec<ContactManifold<M, C>>,
        kept: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        // parry asserts on both inside of composites; the contacts there are left as they are.
        let prediction = if prediction >= 0.0 { prediction } else { 0.0 };
        if !(pos12.is_finite() || is_single(a) && is_single(b)) {
            return Err(Unsupported);
        }
        match (compound(a), compound(b)) {
            (Some(c), Some(d)) => {
                contact_manifolds_composite_shape_composite_shape(self, pos12, c, d, prediction, out, kept);
                Ok(())
            }
            (Some(c), None) if is_single(b) => {
                contact_manifolds_composite_shape_shape(self, pos12, c, b, prediction, out, kept, false);
                Ok(())
            }
            (None, Some(c)) if is_single(a) => {
                contact_manifolds_composite_shape_shape(self, &pos12.inverse(), c, a, prediction, out, kept, true);
                Ok(())
            }
            _ if is_single(a) && is_single(b) => {
                if out.is_empty() {
                    out.push(ContactManifold::new());
                }
                self.contact_manifold_convex_convex(pos12, a, b, None, None, prediction, &mut out[0])
            }
            _ => DefaultQueryDispatcher.contact_manifolds(pos12, a, b, prediction, out, kept),
        }
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        constraints1: Option<&dyn NormalConstraints>,
        constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        out: &mut ContactManifold<M, C>,
    ) -> Result<(), Unsupported> {
        // Corrected normals of mesh triangles are parry's.
        let is_free = constraints1.is_none() && constraints2.is_none();
        let pair = if is_free { part::pair(&self.known, a, b) } else { None };
        if pair
            .as_ref()
            .is_some_and(|pair| is_far(pair, pos12, prediction * self.options.reach))
        {
            out.clear();
            return Ok(());
        }
        if let Some(posed) = pair.as_ref().and_then(|pair| PosedPair::new(pair, pos12)) {
            posed.write(prediction, &self.options, out);
            return Ok(());
        }
        if is_free && half_space::write(&self.known, pos12, (a, b), prediction, &self.options, out) {
            return Ok(());
        }
        parrys(pos12, a, b)?.contact_manifold_convex_convex(pos12, a, b, constraints1, constraints2, prediction, out)
    }
}

/// Returns parry's dispatcher for a pair that it can answer: for two cuboids, parry asserts that the
/// pose is finite and that the cuboids have a size.
fn parrys(pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<DefaultQueryDispatcher, Unsupported> {
    if pos12.is_finite() && has_size(a) && has_size(b) {
        Ok(DefaultQueryDispatcher)
    } else {
        Err(Unsupported)
    }
}

/// Returns whether the pose and the velocities of a motion are finite.
fn is_finite(motion: &NonlinearRigidMotion) -> bool {
    let velocities = [motion.local_center, motion.linvel, motion.angvel];
    motion.start.is_finite() && velocities.iter().all(|v| v.is_finite())
}

/// Returns whether the ends of a capsule differ, which casts of parry assert, and its radius is a
/// number; true for other shapes.
fn has_length(shape: &dyn Shape) -> bool {
    let (capsule, ball) = (shape.as_capsule(), shape.as_ball());
    capsule.is_none_or(|c| (c.segment.b - c.segment.a).length() > 0.0 && c.radius >= 0.0)
        && ball.is_none_or(|b| b.radius >= 0.0)
}

/// Returns whether the extents of a cuboid are numbers and not negative; true for other shapes.
fn has_size(shape: &dyn Shape) -> bool {
    let of = |cuboid: &Cuboid| (0..3).all(|k| cuboid.half_extents[k] >= 0.0 && cuboid.half_extents[k].is_finite());
    shape.as_cuboid().is_none_or(of)
}
