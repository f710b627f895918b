//! Casts: the time at which two moving shapes first come within a distance of each other.

use std::ops::Range;

use lin_canny::impact::{Impact, Tolerance, cast_within};
use lin_canny::motion::{Motion, Steady, Velocity};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ContactState, PairTracker, RelativePose, Shape};

use super::number::{down, isometry, narrow, wide, wide_point};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::ShapeCastOptions;
use super::parry::query::{NonlinearRigidMotion, ShapeCastHit, ShapeCastStatus};
use super::parry::shape;
use super::part::Placed;

/// Width of the bracket of a hit, as a distance divided by the size of the pair: a few units in the
/// last place of the engine's numbers.
const TOLERANCE: f64 = 4.0 * Real::EPSILON as f64;

/// Radii of the cores of a shape, divided by its thickness.
///
/// The first is that of parry's sweeps against meshes. A core is cast if all previous ones touch at
/// the start.
pub(super) const CORES: [f64; 3] = [0.5, 0.125, 0.03125];

/// The result of a cast.
pub(super) enum Flown {
    /// The shapes stay apart.
    Free,
    Hit(ShapeCastHit),
    /// The shapes are in contact at the start; without a hit if none was requested.
    Start(Option<ShapeCastHit>),
    /// A motion, the interval or the distance is out of range, so nothing is known.
    Refused,
}

/// Casts two shapes in the frame of the first; the second moves at constant velocity without
/// rotation.
pub(super) fn linear((a, b): (&Placed, &Placed), pos12: &Pose, vel12: Vector, options: &ShapeCastOptions) -> Flown {
    let (velocity, target) = (wide(vel12), f64::from(options.target_distance));
    let start = isometry(pos12) * b.at;
    let speed = velocity.norm();
    let reach = start.translation.vector.norm() + reach(a) + reach(b) + target;
    // After this time the shapes are farther apart than `target`.
    let passed = if speed > 0.0 { 1.000_001 * reach / speed } else { 0.0 };
    let until = f64::from(options.max_time_of_impact).min(passed);
    let rest = Steady::new(&a.at, Velocity::default());
    let way = Steady::new(&start, Velocity::new(velocity, Vector3::zeros()));
    let (Ok(rest), Ok(way)) = (rest, way) else {
        return Flown::Refused;
    };
    match fly((a, b), (&rest, &way), 0.0..until, target, true) {
        // The distance of convex shapes at a constant velocity is a convex function of time, so
        // that shapes that move apart stay apart.
        Flown::Start(Some(hit))
            if !options.stop_at_penetration
                && a.is_convex()
                && b.is_convex()
                && wide(hit.normal1).dot(&velocity) >= 0.0 =>
        {
            Flown::Free
        }
        Flown::Start(Some(hit)) => Flown::Hit(hit),
        flown => flown,
    }
}

/// Casts two shapes that move and rotate at constant velocities.
///
/// A contact at the start is measured only if requested, because a depth takes longer than the
/// cast.
pub(super) fn nonlinear(
    (a, b): (&Placed, &Placed),
    (motion1, motion2): (&NonlinearRigidMotion, &NonlinearRigidMotion),
    (start, end): (Real, Real),
    is_wanted: bool,
) -> Flown {
    let interval = f64::from(start)..f64::from(end);
    match (steady(a, motion1), steady(b, motion2)) {
        (Some(x), Some(y)) => fly((a, b), (&x, &y), interval, 0.0, is_wanted),
        _ => Flown::Refused,
    }
}

/// Returns a core of a convex shape, a ball around its centre of mass, to cast against a mesh that
/// the shape touches at the start; `None` for shapes without thickness.
pub(super) fn core(shape: &dyn shape::Shape, share: f64) -> Option<Placed> {
    let radius = share * f64::from(shape.ccd_thickness());
    let centre = wide(shape.mass_properties(1.0).local_com);
    Some(Placed {
        shape: Shape::ball(radius).ok().filter(|_| radius > 0.0)?.into(),
        at: Isometry3::from(centre),
    })
}

/// Returns the motion of a shape of [`lin_canny`] from the motion of the engine's shape.
fn steady(placed: &Placed, motion: &NonlinearRigidMotion) -> Option<Steady> {
    let pose = isometry(&motion.start) * placed.at;
    let pivot: Point3<f64> = placed.at.inverse_transform_point(&wide_point(motion.local_center));
    let velocity = Velocity::new(wide(motion.linvel), wide(motion.angvel));
    Steady::about(&pose, pivot, velocity).ok()
}

fn fly(
    (a, b): (&Placed, &Placed),
    (x, y): (&Steady, &Steady),
    interval: Range<f64>,
    target: f64,
    is_wanted: bool,
) -> Flown {
    use ShapeCastStatus::{Converged, OutOfIterations, PenetratingOrWithinTargetDist};
    let mut tracker = PairTracker::new();
    let mut pair = tracker.pair(&a.shape, &b.shape);
    let size = a.shape.bounding_ball().1 + b.shape.bounding_ball().1;
    let tolerance = Tolerance::Distance(TOLERANCE * size);
    let start = interval.start;
    let Ok(cast) = cast_within(&mut pair, x, y, interval, tolerance, target) else {
        return Flown::Refused;
    };
    let mut hit = |time| hit((a, b), (&x.pose(time), &y.pose(time)), time, &mut tracker);
    let (found, status) = match cast.impact {
        Impact::Miss => return Flown::Free,
        Impact::AtStart { .. } if !is_wanted => return Flown::Start(None),
        Impact::AtStart { seen } => {
            // An overlap of two polyhedra is measured without a depth.
            let is_touching = seen.state != ContactState::Overlapping && seen.distance >= target;
            let status = if is_touching {
                Converged
            } else {
                PenetratingOrWithinTargetDist
            };
            let start = hit(start).map(|found| Flown::Start(Some(ShapeCastHit { status, ..found })));
            return start.unwrap_or(Flown::Refused);
        }
        // Proven apart up to `safe`, and closer than the tolerance there.
        Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } => (hit(safe), Converged),
        Impact::Incomplete { safe } => (hit(safe), OutOfIterations),
        _ => (None, Converged),
    };
    found.map_or(Flown::Refused, |found| Flown::Hit(ShapeCastHit { status, ..found }))
}

/// Returns the hit at a time, with witness points and normals in the frames of the engine's shapes.
fn hit(
    (a, b): (&Placed, &Placed),
    (pose_a, pose_b): (&Isometry3<f64>, &Isometry3<f64>),
    time: f64,
    tracker: &mut PairTracker,
) -> Option<ShapeCastHit> {
    let pose = RelativePose::new(pose_a, pose_b).ok()?;
    let outcome = tracker.closest(&a.shape, &b.shape, &pose);
    let in_world = pose_a.rotation * outcome.normal.into_inner();
    let on = |placed: &Placed, p: &Point3<f64>| narrow(&(placed.at * p).coords);
    // The outward normal in the frame of the engine's shape.
    let out = |placed: &Placed, pose: &Isometry3<f64>, n: Vector3<f64>| {
        narrow(&(placed.at.rotation * pose.rotation.inverse_transform_vector(&n)))
    };
    Some(ShapeCastHit {
        time_of_impact: down(time),
        witness1: on(a, &outcome.point_on_a),
        witness2: on(b, &outcome.point_on_b),
        normal1: out(a, pose_a, in_world),
        normal2: out(b, pose_b, -in_world),
        status: ShapeCastStatus::Converged,
        subshape1: 0,
        subshape2: 0,
    })
}

/// Returns the largest distance of a point of the shape from the origin of the engine's frame.
fn reach(placed: &Placed) -> f64 {
    let (centre, radius) = placed.shape.bounding_ball();
    (placed.at * centre).coords.norm() + radius
}
