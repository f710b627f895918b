//! The query dispatcher.

use std::sync::Arc;

use lin_canny::nalgebra::{Point3, UnitQuaternion};
use lin_canny::{ContactState, Outcome, PairTracker, RelativePose};

use super::cast::{self, Flown};
use super::contact::ContactOptions;
use super::convex;
use super::guard::{self, Turning, margin, parrys};
use super::known::Known;
use super::mesh;
use super::number::{isometry, narrow};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::{
    NormalConstraints, ShapeCastOptions, cast_shapes_composite_shape_shape,
    cast_shapes_nonlinear_composite_shape_shape, cast_shapes_nonlinear_shape_composite_shape,
    cast_shapes_shape_composite_shape, closest_points_composite_shape_shape, closest_points_shape_composite_shape,
    contact_composite_shape_shape, contact_manifolds_composite_shape_composite_shape,
    contact_manifolds_composite_shape_shape, contact_manifolds_heightfield_composite_shape,
    contact_manifolds_heightfield_shape_shapes, contact_manifolds_trimesh_shape_shapes, contact_shape_composite_shape,
    distance_composite_shape_shape, distance_shape_composite_shape, intersection_test_composite_shape_shape,
    intersection_test_shape_composite_shape,
};
use super::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use super::parry::shape::{CompositeShape, Shape, ShapeType};
use super::part::{self, Placed};
use super::surface;

/// Query dispatcher that handles convex shapes with [`lin_canny`] and all others with parry.
///
/// The table on the page of the crate `lin_canny_parry` lists all pairs. A manifold depends only on
/// the relative pose and on the contacts that it contains. The dispatcher is cheap to clone. Clones
/// share the bodies that were made from cuboids, balls, capsules and plain polyhedra.
///
/// ```
/// use lin_canny_parry::single::{CertifiedDispatcher, parry};
/// use parry::math::{Pose, Vector};
/// use parry::query::QueryDispatcher;
/// use parry::shape::{Capsule, Cuboid};
///
/// let (cuboid, capsule) = (Cuboid::new(Vector::splat(1e-3)), Capsule::new_y(2e-3, 5e-4));
/// let pose = Pose::translation(2.5e-3, 0.0, 0.0);
/// let gap = CertifiedDispatcher::default().distance(&pose, &cuboid, &capsule).unwrap().distance;
/// assert!((gap - 1e-3).abs() < 1e-9);
/// ```
#[derive(Clone, Default)]
pub struct CertifiedDispatcher {
    options: ContactOptions,
    known: Arc<Known>,
    /// Whether triangles are part of a mesh or height field.
    is_surface: bool,
}

impl std::fmt::Debug for CertifiedDispatcher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Certified")
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl CertifiedDispatcher {
    /// Returns a dispatcher with options.
    #[must_use]
    pub fn new(options: ContactOptions) -> Self {
        Self {
            options,
            ..Self::default()
        }
    }

    /// Returns the options of the manifolds.
    #[must_use]
    pub fn options(&self) -> ContactOptions {
        self.options
    }

    /// Returns two shapes that [`lin_canny`] supports, at their pose; `None` if the pose is not
    /// finite or parry has a closed form.
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
        PairTracker::new()
            .closest(&self.a.shape, &self.b.shape, &self.pose)
            .outcome
    }

    fn intersects(&self) -> bool {
        PairTracker::new().intersects(&self.a.shape, &self.b.shape, &self.pose)
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

/// Returns a shape that consists of convex pieces, which are queried one by one.
fn compound(shape: &dyn Shape) -> Option<&(dyn CompositeShape + Sync)> {
    shape.as_compound().and_then(|_| shape.as_composite_shape())
}

/// Returns a shape whose pieces are queried one by one against another shape: a compound, or
/// against a half-space also a mesh.
fn parts_beside<'a>(shape: &'a dyn Shape, other: &dyn Shape) -> Option<&'a (dyn CompositeShape + Sync)> {
    let is_on_space = other.as_halfspace().is_some();
    compound(shape).or_else(|| shape.as_composite_shape().filter(|_| is_on_space))
}

/// Returns whether a shape is not a compound, mesh, height field or voxels.
fn is_single(shape: &dyn Shape) -> bool {
    shape.as_composite_shape().is_none() && !matches!(shape.shape_type(), ShapeType::Voxels | ShapeType::HeightField)
}

/// Casts the largest core of a convex shape that does not touch a mesh at the start.
fn core_hit(
    (a, b): (&dyn Shape, &dyn Shape),
    (on_a, on_b): (Placed, Placed),
    motions: (&NonlinearRigidMotion, &NonlinearRigidMotion),
    interval: (Real, Real),
) -> Option<ShapeCastHit> {
    for share in cast::CORES {
        let flown = if on_a.is_convex() {
            cast::nonlinear((&cast::core(a, share)?, &on_b), motions, interval, false)
        } else {
            cast::nonlinear((&on_a, &cast::core(b, share)?), motions, interval, false)
        };
        match flown {
            Flown::Hit(hit) => return Some(hit),
            Flown::Start(_) => {}
            _ => return None,
        }
    }
    None
}

/// Returns whether a shape is a mesh or height field of parry.
fn is_field(shape: &dyn Shape) -> bool {
    matches!(shape.shape_type(), ShapeType::TriMesh | ShapeType::HeightField)
}

/// Writes the manifolds of a mesh or height field of parry and another shape, triangle by triangle.
fn fields<M, C>(
    by: &CertifiedDispatcher,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    prediction: Real,
    out: &mut Vec<ContactManifold<M, C>>,
    kept: &mut Option<ContactManifoldsWorkspace>,
) where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    let other = &pos12.inverse();
    let compounds = (a.as_composite_shape(), b.as_composite_shape());
    match (compounds, a.as_heightfield(), b.as_heightfield()) {
        ((Some(c), Some(d)), ..) => {
            contact_manifolds_composite_shape_composite_shape(by, pos12, c, d, prediction, out, kept);
        }
        ((None, Some(c)), Some(field), _) => {
            contact_manifolds_heightfield_composite_shape(by, pos12, other, field, c, prediction, out, kept, false);
        }
        ((Some(c), None), _, Some(field)) => {
            contact_manifolds_heightfield_composite_shape(by, other, pos12, field, c, prediction, out, kept, true);
        }
        ((None, None), ..) => contact_manifolds_heightfield_shape_shapes(by, pos12, a, b, prediction, out, kept),
        _ => contact_manifolds_trimesh_shape_shapes(by, pos12, a, b, prediction, out, kept),
    }
}

impl QueryDispatcher for CertifiedDispatcher {
    fn intersection_test(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<ShapeIntersection, Unsupported> {
        let is_closed = part::has_closed_test(a, b);
        if let Some(posed) = (!is_closed).then(|| self.posed(pos12, a, b)).flatten() {
            return Ok(posed.intersects().into());
        }
        let parry = parrys(pos12, a, b)?;
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(intersection_test_composite_shape_shape(self, pos12, c, b)),
            (_, Some(c)) => Ok(intersection_test_shape_composite_shape(self, pos12, a, c)),
            _ => parry.intersection_test(pos12, a, b),
        }
    }

    fn distance(&self, pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        if let Some(posed) = self.posed(pos12, a, b) {
            return Ok(ShapeDistance::new(posed.closest().distance.max(0.0) as Real));
        }
        let parry = parrys(pos12, a, b)?;
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(distance_composite_shape_shape(self, pos12, c, b)),
            (_, Some(c)) => Ok(distance_shape_composite_shape(self, pos12, a, c)),
            _ => parry.distance(pos12, a, b),
        }
    }

    fn contact(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        if let Some(deepest) = mesh::deepest(&self.known, pos12, (a, b), prediction, &self.options) {
            return Ok(Some(deepest).filter(|contact| contact.dist <= prediction));
        }
        if let Some(posed) = self.posed(pos12, a, b) {
            let outcome = posed.closest();
            let is_near = outcome.distance <= f64::from(prediction);
            return Ok(is_near.then(|| posed.contact(&outcome)));
        }
        let (parry, within) = (parrys(pos12, a, b)?, margin(prediction));
        let found = match (parts_beside(a, b), parts_beside(b, a)) {
            (Some(c), _) => contact_composite_shape_shape(self, pos12, c, b, within),
            (_, Some(c)) => contact_shape_composite_shape(self, pos12, a, c, within),
            // parry forgets to invert the pose of a half-space that comes second.
            _ if b.as_halfspace().is_some() => {
                let found = parry.contact(&pos12.inverse(), b, a, within)?;
                found.map(Contact::flipped)
            }
            _ => parry.contact(pos12, a, b, within)?,
        };
        Ok(found.filter(|contact| contact.dist <= prediction))
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
            return Ok(match outcome.state {
                ContactState::Overlapping | ContactState::Touching => ClosestPoints::Intersecting,
                _ if outcome.distance <= f64::from(max_dist) => {
                    ClosestPoints::WithinMargin(contact.point1, contact.point2)
                }
                _ => ClosestPoints::Disjoint,
            });
        }
        let (parry, within) = (parrys(pos12, a, b)?, margin(max_dist));
        let found = match (compound(a), compound(b)) {
            (Some(c), _) => closest_points_composite_shape_shape(self, pos12, c, b, within),
            (_, Some(c)) => closest_points_shape_composite_shape(self, pos12, a, c, within),
            _ => parry.closest_points(pos12, a, b, within)?,
        };
        Ok(match found {
            ClosestPoints::WithinMargin(..) if !(max_dist >= 0.0) => ClosestPoints::Disjoint,
            found => found,
        })
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        vel12: Vector,
        a: &dyn Shape,
        b: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let pair = part::placed(&self.known, a, b);
        if let Some((on_a, on_b)) = pair.filter(|_| pos12.is_finite()) {
            match cast::linear((&on_a, &on_b), pos12, vel12, &options) {
                Flown::Free => return Ok(None),
                Flown::Hit(hit) | Flown::Start(Some(hit)) => return Ok(Some(hit)),
                Flown::Start(None) | Flown::Refused => {}
            }
        }
        let (parry, options) = guard::casting(pos12, vel12, (a, b), &options)?;
        match (compound(a), compound(b)) {
            (Some(c), _) => Ok(cast_shapes_composite_shape_shape(self, pos12, vel12, c, b, options)),
            (_, Some(c)) => Ok(cast_shapes_shape_composite_shape(self, pos12, vel12, a, c, options)),
            _ => parry.cast_shapes(pos12, vel12, a, b, options),
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
        let asked = Turning::new((a, b), (motion1, motion2), (start, end), stop_at_penetration);
        // parry computes what happens after a penetration at the start, if it can.
        let goes_on = asked.as_ref().is_ok_and(|asked| !asked.stop_at_penetration);
        if let Some((on_a, on_b)) = part::both(&self.known, a, b) {
            match cast::nonlinear((&on_a, &on_b), (motion1, motion2), (start, end), !goes_on) {
                Flown::Free => return Ok(None),
                Flown::Hit(hit) | Flown::Start(Some(hit)) => return Ok(Some(hit)),
                Flown::Start(None) if on_a.is_convex() != on_b.is_convex() => {
                    return Ok(core_hit((a, b), (on_a, on_b), (motion1, motion2), (start, end)));
                }
                Flown::Start(None) | Flown::Refused => {}
            }
        }
        let asked = asked?;
        let (x, y, end, stop) = (&asked.motion1, &asked.motion2, asked.end, asked.stop_at_penetration);
        let hit = match (a.as_composite_shape(), b.as_composite_shape()) {
            (Some(c), _) => cast_shapes_nonlinear_composite_shape_shape(self, x, c, y, b, 0.0, end, stop),
            (_, Some(c)) => cast_shapes_nonlinear_shape_composite_shape(self, x, a, y, c, 0.0, end, stop),
            _ => DefaultQueryDispatcher.cast_shapes_nonlinear(x, a, y, b, 0.0, end, stop)?,
        };
        Ok(hit.map(|hit| asked.in_callers_time(hit)))
    }
}

impl<M, C> PersistentQueryDispatcher<M, C> for CertifiedDispatcher
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
        let prediction = margin(prediction);
        if mesh::write(&self.known, pos12, (a, b), prediction, &self.options, (out, kept)) {
            return Ok(());
        }
        if is_single(a) && is_single(b) {
            if out.is_empty() {
                out.push(ContactManifold::new());
            }
            return self.contact_manifold_convex_convex(pos12, a, b, None, None, prediction, &mut out[0]);
        }
        let parry = guard::touching(pos12, a, b)?;
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
            _ if is_field(a) != is_field(b) => {
                let by = Self {
                    is_surface: true,
                    ..self.clone()
                };
                fields(&by, pos12, (a, b), prediction, out, kept);
                Ok(())
            }
            _ => parry.contact_manifolds(pos12, a, b, prediction, out, kept),
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
        if convex::write(&self.known, pos12, (a, b), prediction, &self.options, out) {
            if self.is_surface || constraints1.or(constraints2).is_some() {
                let constraints = [constraints1, constraints2];
                surface::correct(&self.known, pos12, (a, b), constraints, prediction, &self.options, out);
            }
            return Ok(());
        }
        guard::touching(pos12, a, b)?.contact_manifold_convex_convex(
            pos12,
            a,
            b,
            constraints1,
            constraints2,
            prediction,
            out,
        )
    }
}
