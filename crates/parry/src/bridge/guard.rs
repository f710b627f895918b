//! Guards parry's code: for some numbers it would panic, for others it would never end.

use super::number::{isometry, pose};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::ShapeCastOptions;
use super::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, ShapeCastHit, Unsupported};
use super::parry::shape::{Shape, TypedShape};

/// Largest coordinate, length and velocity that is passed to parry. Its fourth power, the square of
/// an area, is still a finite number, with a reserve of a factor of some hundred.
const LARGEST: Real = if Real::MAX_EXP > 128 { 1e76_f64 as Real } else { 1e9 };

/// Maximum number of cells that a cast against a field of cells may visit.
const CELLS: Real = 65536.0;

/// Maximum number of steps of parry's search after a penetration at the start.
const INSTANTS: Real = 1e4;

/// Returns parry's dispatcher for a pair with valid numbers.
pub(super) fn parrys(pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<DefaultQueryDispatcher, Unsupported> {
    if is_posed(pos12) && is_sound(a) && is_sound(b) {
        Ok(DefaultQueryDispatcher)
    } else {
        Err(Unsupported)
    }
}

/// Returns parry's dispatcher for the manifolds of a pair.
pub(super) fn touching(pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Result<DefaultQueryDispatcher, Unsupported> {
    // Manifolds of voxels need support points if the pair overlaps.
    let is_told = |a: &dyn Shape, b: &dyn Shape| a.as_voxels().is_none() || has_support(b);
    if has_faces(a) && has_faces(b) && is_told(a, b) && is_told(b, a) {
        parrys(pos12, a, b)
    } else {
        Err(Unsupported)
    }
}

/// Returns false for a polyhedron of parry without faces.
///
/// parry makes such polyhedra from small ones, and its manifolds index the first face.
fn has_faces(shape: &dyn Shape) -> bool {
    let core = shape.as_convex_polyhedron();
    core.or_else(|| shape.as_round_convex_polyhedron().map(|s| &s.inner_shape))
        .is_none_or(|s| !s.faces().is_empty())
}

/// Returns false for a shape without support points, such as a half-space.
fn has_support(shape: &dyn Shape) -> bool {
    match shape.as_compound() {
        Some(compound) => compound.shapes().iter().all(|(_, part)| has_support(&**part)),
        None => shape.as_support_map().is_some() || shape.as_composite_shape().is_some() || cell(shape).is_some(),
    }
}

/// Returns parry's dispatcher for a cast without rotation, with options for which the cast ends.
pub(super) fn casting(
    pos12: &Pose,
    vel12: Vector,
    (a, b): (&dyn Shape, &dyn Shape),
    options: &ShapeCastOptions,
) -> Result<(DefaultQueryDispatcher, ShapeCastOptions), Unsupported> {
    let (target, mut options) = (options.target_distance, *options);
    let is_asked = is_bounded(vel12) && (0.0..=LARGEST).contains(&target) && options.max_time_of_impact >= 0.0;
    if !(is_asked && has_length(a) && has_length(b)) {
        return Err(Unsupported);
    }
    let parry = parrys(pos12, a, b)?;
    let reach = pos12.translation.length() + extent(a) + extent(b) + target;
    if !is_walked((a, b), reach) {
        return Err(Unsupported);
    }
    if cell(a).or(cell(b)).is_some() {
        // parry visits cells until the longest time, at any distance from the field. After this
        // time the shapes are farther apart than `target`.
        let passed = 1.001 * reach / vel12.abs().max_element();
        options.max_time_of_impact = options.max_time_of_impact.min(passed);
    }
    Ok((parry, options))
}

/// Returns whether a cast visits few enough cells, if one of two shapes is a field of cells.
fn is_walked((a, b): (&dyn Shape, &dyn Shape), way: Real) -> bool {
    let least = cell(a).into_iter().chain(cell(b)).reduce(Real::min);
    least.is_none_or(|cell| way <= CELLS * cell)
}

/// Returns the width of the cells of a height field or of voxels.
fn cell(shape: &dyn Shape) -> Option<Real> {
    let field = shape.as_heightfield().map(|f| f.cell_width().min(f.cell_height()));
    field.or_else(|| shape.as_voxels().map(|v| v.voxel_size().min_element()))
}

/// Returns an upper bound of the distance of the points of a shape from its origin.
fn extent(shape: &dyn Shape) -> Real {
    let local = shape.compute_local_aabb();
    local.mins.abs().max(local.maxs.abs()).length()
}

/// Returns a prediction by which parry can enlarge a box.
pub(super) fn margin(prediction: Real) -> Real {
    if prediction >= 0.0 {
        prediction.min(8.0 * LARGEST)
    } else {
        0.0
    }
}

fn is_bounded(v: Vector) -> bool {
    v.to_array().into_iter().all(|x| x.abs() <= LARGEST)
}

/// Returns whether a pose is valid: bounded, with a rotation that can be normalised.
fn is_posed(at: &Pose) -> bool {
    let turn = at.rotation.length();
    is_bounded(at.translation) && (0.5..=2.0).contains(&turn)
}

/// Returns whether the lengths of a shape are finite and not negative, and its box is bounded.
fn is_sound(shape: &dyn Shape) -> bool {
    let is_length = |x: Real| x.is_sign_positive() && x <= LARGEST;
    let are_lengths = match shape.as_typed_shape() {
        TypedShape::Ball(s) => is_length(s.radius),
        TypedShape::Capsule(s) => is_length(s.radius),
        TypedShape::Cuboid(s) => s.half_extents.to_array().into_iter().all(is_length),
        TypedShape::Cylinder(s) => is_length(s.half_height) && is_length(s.radius),
        TypedShape::Cone(s) => is_length(s.half_height) && is_length(s.radius),
        TypedShape::RoundCuboid(s) => is_length(s.border_radius) && is_sound(&s.inner_shape),
        TypedShape::RoundTriangle(s) => is_length(s.border_radius),
        TypedShape::RoundCylinder(s) => is_length(s.border_radius) && is_sound(&s.inner_shape),
        TypedShape::RoundCone(s) => is_length(s.border_radius) && is_sound(&s.inner_shape),
        TypedShape::RoundConvexPolyhedron(s) => is_length(s.border_radius),
        // The box of a half-space is unbounded.
        TypedShape::HalfSpace(s) => return (0.5..=2.0).contains(&s.normal.length()),
        _ => true,
    };
    if !are_lengths {
        return false;
    }
    let local = shape.compute_local_aabb();
    is_bounded(local.mins) && is_bounded(local.maxs)
}

/// Returns whether the ends of a capsule differ, which casts of parry assert; true for other
/// shapes.
fn has_length(shape: &dyn Shape) -> bool {
    let capsule = shape.as_capsule();
    capsule.is_none_or(|c| (c.segment.b - c.segment.a).length() > 0.0)
}

/// Two motions over an interval of time, scaled so that parry's bisection ends.
///
/// parry halves an interval down to an absolute length, which times above about ten cannot reach in
/// `f32`.
pub(super) struct Turning {
    pub(super) motion1: NonlinearRigidMotion,
    pub(super) motion2: NonlinearRigidMotion,
    /// End of the interval, at most 1; the start is 0.
    pub(super) end: Real,
    pub(super) stop_at_penetration: bool,
    from: Real,
    span: Real,
}

impl Turning {
    /// Returns the motions, unless a number is out of parry's range.
    pub(super) fn new(
        (a, b): (&dyn Shape, &dyn Shape),
        (x, y): (&NonlinearRigidMotion, &NonlinearRigidMotion),
        (start, end): (Real, Real),
        stop_at_penetration: bool,
    ) -> Result<Self, Unsupported> {
        let is_asked = start.is_finite() && end.is_finite() && start <= end && has_length(a) && has_length(b);
        let span = (end - start).max(1.0);
        let (motion1, motion2) = (later(x, start, span), later(y, start, span));
        let are_bounded = [&motion1, &motion2].into_iter().all(|motion| {
            let vectors = [motion.local_center, motion.linvel, motion.angvel];
            is_posed(&motion.start) && vectors.into_iter().all(is_bounded)
        });
        if !(is_asked && are_bounded && is_sound(a) && is_sound(b)) {
            return Err(Unsupported);
        }
        let way = |m: &NonlinearRigidMotion| [m.start.translation, m.linvel, m.local_center].map(Vector::length);
        let way = [way(&motion1), way(&motion2)].concat().into_iter().sum::<Real>();
        if !is_walked((a, b), 2.0 * way + extent(a) + extent(b)) {
            return Err(Unsupported);
        }
        let end = (end - start) / span;
        let stop_at_penetration = stop_at_penetration || !is_searched((a, b), (&motion1, &motion2), end);
        Ok(Self {
            motion1,
            motion2,
            end,
            stop_at_penetration,
            from: start,
            span,
        })
    }

    /// Converts a hit to the caller's time.
    pub(super) fn in_callers_time(&self, hit: ShapeCastHit) -> ShapeCastHit {
        let time_of_impact = self.from + hit.time_of_impact * self.span;
        ShapeCastHit { time_of_impact, ..hit }
    }
}

/// Returns a motion that starts later, and in a unit of time that is `span` times as long.
fn later(motion: &NonlinearRigidMotion, from: Real, span: Real) -> NonlinearRigidMotion {
    let start = if from == 0.0 {
        motion.start
    } else {
        pose(&isometry(&motion.position_at_time(from)))
    };
    NonlinearRigidMotion {
        start,
        linvel: motion.linvel * span,
        angvel: motion.angvel * span,
        ..*motion
    }
}

/// Returns whether parry's search after a penetration at the start ends.
///
/// parry takes one step for each time in which the shapes move by their thickness or rotate by an
/// angle of their edges. Without rotation or without a displacement it takes a single step.
fn is_searched(
    (a, b): (&dyn Shape, &dyn Shape),
    (x, y): (&NonlinearRigidMotion, &NonlinearRigidMotion),
    end: Real,
) -> bool {
    let speed = (y.linvel - x.linvel).length();
    let spin = (y.angvel - x.angvel).length();
    if !(spin > 0.0 && speed > 0.0) {
        return true;
    }
    let edge = a.ccd_angular_thickness().max(b.ccd_angular_thickness());
    let by_angle = (std::f64::consts::PI as Real - edge) / spin;
    let by_way = (a.ccd_thickness() + b.ccd_thickness()) / speed;
    let step = by_angle.min(by_way);
    // Without a time step parry takes a single step.
    step == 0.0 || step * INSTANTS >= end
}
