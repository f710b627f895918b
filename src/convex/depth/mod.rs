//! Penetration depth: the shortest translation that separates two overlapping bodies, with a proof.
//!
//! With P = A - B and h(n) the support value of P along the unit vector n, the depth is the minimum
//! of h(n) over all n: the radius of the largest ball around the origin inside P. Any n gives an
//! upper bound. The polytope, a closed surface of triangles on points of P with winding number one
//! around the origin ([`polytope`]), gives a lower bound: the least distance of a triangle. The
//! search grows the polytope at the nearest triangle until both bounds agree; the depth is then
//! proven globally. If the bounds are not tight in f64, the search is repeated in double-double,
//! and then in exact arithmetic, facet by facet ([`exhaustive`]).
//!
//! Source: van den Bergen 2001, "Proximity queries and penetration depth computation on 3D game
//! objects", the expanding polytope algorithm. Departures:
//! 1. The proof is the winding number, which every step preserves, not convexity: a surface folded
//!    by rounding costs time but never gives a wrong result.
//! 2. The bound of a triangle is the least of three heights along a unit vector, and any unit
//!    vector is valid (the normal, the direction of the nearest point, the normal of the best
//!    facet). Slivers make a bound weaker, never wrong.
//! 3. Heights are measured along the normals of the features of the bodies ([`facet`]), not of
//!    rounded points.
//! 4. A tracker caches the polytope as vertex pairs ([`memory`]) and starts the next search from it
//!    ([`mod@resume`]).
//! 5. If faces are flush, the deepest facet proves the depth even if some triangles are slightly
//!    below the boundary of P ([`holds_disc`](facet::holds_disc)).
//! 6. A shallow overlap needs no polytope: a facet found by a walk over facets ([`descent`]) and
//!    one point deep in P prove the depth ([`pyramid`]), at the cost of a walk ([`nearest`]).
//! 7. A local depth is only an upper bound: the height of the facet on which the descent ends. A
//!    pyramid or four points around the origin prove the overlap ([`local_depth`]).
//! 8. If the origin lies on the boundary of the first tetrahedron (lattices, concentric and equal
//!    bodies), the polytope is grown around a point close to the origin, until the ball around this
//!    point contains the origin too.

mod descent;
#[cfg(feature = "exact")]
mod exhaustive;
mod facet;
mod memory;
mod nearest;
mod polytope;
pub(crate) mod pyramid;
mod resume;
mod search;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{Scalar, dot};
#[cfg(feature = "exact")]
use crate::base::tolerance::AGREE_WITNESS;
use crate::base::tolerance::{AGREE_DEPTH, CERTIFICATE, ORIGIN_SHIFTS, UNIT};
use crate::pair::difference::{difference_point, support};
use crate::pair::draft::Draft;
use crate::pair::draft::{round_outward, unit, walk_state};
use crate::pair::outcome::{ContactState, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use nalgebra::Vector3;
use polytope::EnclosingSurface;
use search::{SearchEnd, SearchResult, search};

pub(crate) use memory::{Memory, RawMemory, Workspace};
pub(crate) use nearest::{NearestFeature, depth_from, local_depth, nearest_facet};
pub(crate) use resume::resume;

/// Number of perturbations worth a search in f64, the first of [`ORIGIN_SHIFTS`]: the perturbations
/// well above the rounding of f64.
const SHIFTS_PLAIN: usize = 3;

/// Bounds the depth of an overlap that only double-double could distinguish from a touch. The bound
/// is the support value of A - B along the direction in which the bodies are nearly separated: an
/// upper bound of the depth, which is within rounding of zero. Returns false, with the draft
/// unchanged, if the support value is higher.
#[cold]
pub(crate) fn of_touch(posed: &PosedPair, draft: &mut Draft) -> bool {
    if draft.solver != Solver::DoubleDouble {
        return false;
    }
    let Some(frame) = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) else {
        return false;
    };
    let (a, b) = draft.features.vertices_of(posed.a, posed.b);
    let n = draft.normal.map(DoubleDouble::from).into();
    let height = dot(
        &n,
        &support(posed, &frame, &n, &difference_point(posed, &frame, a, b)).w,
    );
    let depth = height.value();
    // Comparisons with NaN are false.
    if !(depth > 0.0 && depth <= AGREE_DEPTH * posed.size()) {
        return false;
    }
    // The normal is of unit length within a few UNIT.
    let term = CERTIFICATE * DoubleDouble::UNIT * posed.error_scale::<DoubleDouble>().total();
    draft.work.depths += 1;
    draft.lower = -round_outward(height, term + 8.0 * UNIT * depth);
    (draft.distance, draft.upper) = (-depth, 0.0);
    true
}

/// Computes depth, normal, witness points and features of two bodies that are already proven to
/// overlap.
#[cold]
pub(crate) fn penetration_depth(posed: &PosedPair, memory: &mut Memory, draft: &mut Draft) {
    memory.clear();
    draft.work.depths += 1;
    draft.lower = f64::NEG_INFINITY;
    let shifts = &ORIGIN_SHIFTS[..SHIFTS_PLAIN];
    let is_done = memory.with_scratch(|memory, scratch| {
        let surface = &mut scratch.surface;
        let Some(found) = search(posed, &Transform::of(posed), draft.features, shifts, surface) else {
            return false;
        };
        write_result(posed, &found, draft);
        if found.end == SearchEnd::Closed {
            memory.keep(surface, draft.features, None);
        }
        found.end != SearchEnd::Stuck
    });
    if !is_done {
        penetration_depth_in_double_double(posed, draft);
    }
}

/// Computes depth, normal, witness points and features in double-double, and exactly if the bounds
/// are still not tight.
#[cold]
#[inline(never)]
fn penetration_depth_in_double_double(posed: &PosedPair, draft: &mut Draft) {
    draft.work.double_doubles += 1;
    let Some(frame) = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) else {
        return;
    };
    if let Some(found) = search(
        posed,
        &frame,
        draft.features,
        &ORIGIN_SHIFTS,
        &mut EnclosingSurface::new(),
    ) {
        write_result(posed, &found, draft);
    }
    #[cfg(feature = "exact")]
    if !has_close_bounds(posed, draft) || draft.distance == 0.0 || !has_witnesses(posed, draft) {
        exhaustive::resolve_exactly(posed, &frame, draft);
    }
}

/// Returns whether the bounds agree as closely as a proven depth requires; false for NaN.
#[cfg(feature = "exact")]
fn has_close_bounds(posed: &PosedPair, draft: &Draft) -> bool {
    draft.upper - draft.lower <= AGREE_DEPTH * posed.size()
}

/// Returns whether the witness points differ by the depth along the normal. A polytope that failed
/// to close may have no such points.
#[cfg(feature = "exact")]
fn has_witnesses(posed: &PosedPair, draft: &Draft) -> bool {
    let between = posed.point_in_a(&draft.point_on_b.coords) - draft.point_on_a.coords;
    let rest = between - draft.normal.into_inner() * draft.distance;
    rest.norm_squared() <= (AGREE_WITNESS * posed.size()) * (AGREE_WITNESS * posed.size())
}

/// Writes a depth that a polytope proves, and with it the overlap.
fn write_overlap(posed: &PosedPair, found: &SearchResult<f64>, draft: &mut Draft) {
    draft.state = ContactState::Overlapping;
    draft.solver = Solver::Polytope;
    draft.lower = f64::NEG_INFINITY;
    draft.work.depths += 1;
    write_result(posed, found, draft);
}

/// Writes the search result to the outcome if its bounds are narrower.
fn write_result<T: Scalar>(posed: &PosedPair, found: &SearchResult<T>, draft: &mut Draft) {
    let term = CERTIFICATE * T::UNIT * posed.error_scale::<T>().total();
    draft.work.points_added += found.points_added;
    let lower = -round_outward(found.height, term);
    // All closed searches have the same width, so no bit depends on which polytope proved the
    // depth.
    let accepted = T::from(1.5 * AGREE_DEPTH / UNIT * T::UNIT * posed.error_scale::<T>().total());
    let is_wider = found.end == SearchEnd::Closed && found.radius > found.height - accepted;
    let radius = if is_wider {
        found.height - accepted
    } else {
        found.radius
    };
    let upper = (-round_outward(radius, -term)).at_most(0.0);
    if draft.lower.is_finite() && !(upper - lower < draft.upper - draft.lower) {
        return;
    }
    (draft.lower, draft.upper) = (lower.at_most(0.0), upper.larger(lower.at_most(0.0)));
    draft.distance = (-found.height.value()).clamped(draft.lower, draft.upper);
    let n = &found.normal;
    draft.normal = unit(&Vector3::new(n[0].value(), n[1].value(), n[2].value()));
    if let Some(witnesses) = found.witnesses {
        [draft.point_on_a, draft.point_on_b] = witnesses;
    }
    draft.features = found.features.unwrap_or_else(|| {
        let (a, b) = (found.vertices.each(|c| c.a), found.vertices.each(|c| c.b));
        walk_state(posed, &a, &b)
    });
}
