//! How deep two bodies overlap: the least translation that parts them, with proof.
//!
//! With P = A - B and h(n) the height of P along the unit vector n, the depth is the least h(n) over all n: the radius of
//! the largest ball about the origin in P. Any n gives an upper bound. A closed surface of triangles on points of P that
//! winds about the origin ([`surface`]) gives a lower one, the least distance of a triangle. Grown at the nearest triangle
//! until both agree, it proves the depth globally; what is open goes from f64 to double-double, and what stays open there to
//! exact arithmetic, facet by facet ([`exhaustive`]).
//!
//! Source: van den Bergen 2001, "Proximity queries and penetration depth computation on 3D game objects", the expanding
//! polytope algorithm. Departures:
//! 1. The proof is the winding number, kept by every step, not convexity: a surface that rounding has folded costs time
//!    and never the answer.
//! 2. The bound of a triangle is the least of three heights along one unit vector, for which any will do (its normal, the
//!    direction of its nearest point, the normal of the best facet): slivers weaken a bound and falsify none.
//! 3. Heights are taken along the normals of the bodies' own features ([`facet`]), not of rounded points.
//! 4. A tracker keeps the surface by its vertex pairs ([`memory`]), and the next search begins with it ([`mod@resume`]).
//! 5. Where faces lie upon faces, the deepest facet itself stands in for triangles that come to lie beneath the border ([`cover`]).
//! 6. Where the first tetrahedron has the origin on its border (lattices, concentric and equal bodies), the surface is grown
//!    about a point beside the origin until the ball about that point holds the origin too.

mod deepest;
mod direction;
#[cfg(feature = "exact")]
mod exhaustive;
mod facet;
mod facet_disc;
mod foot;
mod memory;
mod queue;
mod result;
mod resume;
mod search;
mod surface;
mod verify_surface;

use crate::num::double_double::DoubleDouble;
use crate::num::scalar::Scalar;
use crate::pair::answer::{outward, state_of, unit};
use crate::pair::outcome::Outcome;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
#[cfg(feature = "exact")]
use crate::tolerance::{AGREE_DEPTH, AGREE_WITNESS};
use crate::tolerance::{CERTIFICATE, SHIFTS};
use crate::tuning::depth::SHIFTS_PLAIN;
use nalgebra::Vector3;
use result::{End, Found};
use search::search;
use surface::Surface;

pub(crate) use memory::{Memory, Raw};
pub(crate) use resume::resume;

/// Depth, normal, witnesses and features of bodies of which it is proven that they overlap.
#[cold]
pub(crate) fn penetration_depth(posed: &PosedPair, memory: &mut Memory, outcome: &mut Outcome) {
    memory.clear();
    outcome.work.depths += 1;
    outcome.lower = f64::NEG_INFINITY;
    let shifts = &SHIFTS[..SHIFTS_PLAIN];
    let is_done = memory.within(|memory, room| {
        let surface = &mut room.surface;
        let Some(found) = search(posed, &Transform::of(posed), outcome.features, shifts, surface) else {
            return false;
        };
        take(posed, &found, outcome);
        if found.end == End::Closed {
            memory.keep(surface, outcome.features, None);
        }
        found.end != End::Stuck
    });
    if !is_done {
        penetration_depth_in_double_double(posed, outcome);
    }
}

/// The same in double-double.
#[cold]
#[inline(never)]
fn penetration_depth_in_double_double(posed: &PosedPair, outcome: &mut Outcome) {
    outcome.work.double_doubles += 1;
    let Some(frame) = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) else {
        return;
    };
    if let Some(found) = search(posed, &frame, outcome.features, &SHIFTS, &mut Surface::new()) {
        take(posed, &found, outcome);
    }
    #[cfg(feature = "exact")]
    if !is_narrow(posed, outcome) || outcome.distance == 0.0 || !is_held(posed, outcome) {
        exhaustive::resolve_exactly(posed, &frame, outcome);
    }
}

/// Whether the bounds agree as well as a proven depth's must; NaN does not.
#[cfg(feature = "exact")]
fn is_narrow(posed: &PosedPair, outcome: &Outcome) -> bool {
    outcome.upper - outcome.lower <= AGREE_DEPTH * posed.size()
}

/// Whether the witnesses are as far apart as the depth says, and along the normal: a surface that did not close may have none that are.
#[cfg(feature = "exact")]
fn is_held(posed: &PosedPair, outcome: &Outcome) -> bool {
    let between = posed.point_in_a(&outcome.point_on_b.coords) - outcome.point_on_a.coords;
    let rest = between - outcome.normal.into_inner() * outcome.distance;
    rest.norm_squared() <= (AGREE_WITNESS * posed.size()) * (AGREE_WITNESS * posed.size())
}

/// Takes over what was found, where its bounds are the narrower.
fn take<T: Scalar>(posed: &PosedPair, found: &Found<T>, outcome: &mut Outcome) {
    let term = CERTIFICATE * T::UNIT * posed.reach::<T>().whole();
    outcome.work.grown += found.grown;
    let lower = -outward(found.height, term);
    let upper = (-outward(found.radius, -term)).min(0.0);
    if outcome.lower.is_finite() && !(upper - lower < outcome.upper - outcome.lower) {
        return;
    }
    (outcome.lower, outcome.upper) = (lower.min(0.0), upper.max(lower.min(0.0)));
    outcome.distance = (-found.height.value()).clamp(outcome.lower, outcome.upper);
    let n = &found.normal;
    outcome.normal = unit(&Vector3::new(n[0].value(), n[1].value(), n[2].value()));
    if let Some(witnesses) = found.witnesses {
        (outcome.point_on_a, outcome.point_on_b) = witnesses;
    }
    outcome.features = found.features.unwrap_or_else(|| {
        let (a, b) = (found.corners.map(|c| c.a), found.corners.map(|c| c.b));
        state_of(posed, &a, &b)
    });
}
