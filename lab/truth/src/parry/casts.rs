//! parry's casts of two of its bodies over one unit of time, cold: the time at which they meet
//! according to parry.

use super::{Hull, ParryPose};
use parry3d_f64::math::Vector;
use parry3d_f64::query::sweep_toi::{Sweep, SweepToiStatus, ToiProxy, sweep_time_of_impact};
use parry3d_f64::query::{NonlinearRigidMotion, ShapeCastOptions, cast_shapes, cast_shapes_nonlinear};

/// Distance that counts as contact in a sweep: rapier sweeps with this slop.
pub const SLOP: f64 = 0.005;

/// A body with its poses at time zero and time one, and its velocities.
#[derive(Clone, Copy)]
pub struct Flight<'a> {
    /// The body.
    pub hull: &'a Hull,
    /// Its poses.
    pub poses: [ParryPose; 2],
    /// Velocity of its origin.
    pub linear: Vector,
    /// Angular velocity: axis times radians.
    pub angular: Vector,
}

/// Sweeps from end pose to end pose, as rapier does for fast bodies. Returns zero if the bodies
/// meet at the start.
pub fn sweep(a: &Flight, b: &Flight) -> Option<f64> {
    let way = |f: &Flight| Sweep::from_poses(&f.poses[0], &f.poses[1], Vector::ZERO);
    let (proxy_a, proxy_b) = (ToiProxy::from_shape(a.hull)?, ToiProxy::from_shape(b.hull)?);
    let out = sweep_time_of_impact(&proxy_a, &way(a), &proxy_b, &way(b), 1.0, SLOP);
    match out.status {
        SweepToiStatus::Separated => None,
        _ => Some(out.fraction),
    }
}

/// Casts at constant velocities.
pub fn nonlinear(a: &Flight, b: &Flight) -> Option<f64> {
    let motion = |f: &Flight| NonlinearRigidMotion {
        start: f.poses[0],
        local_center: Vector::ZERO,
        linvel: f.linear,
        angvel: f.angular,
    };
    let hit = cast_shapes_nonlinear(&motion(a), a.hull, &motion(b), b.hull, 0.0, 1.0, true);
    hit.ok()?.map(|h| h.time_of_impact)
}

/// Casts at constant velocities without rotation.
pub fn linear(a: &Flight, b: &Flight) -> Option<f64> {
    let options = ShapeCastOptions::with_max_time_of_impact(1.0);
    let hit = cast_shapes(&a.poses[0], a.linear, a.hull, &b.poses[0], b.linear, b.hull, options);
    hit.ok()?.map(|h| h.time_of_impact)
}
