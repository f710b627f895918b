//! The contact of bodies that overlap where no two patches bear one.
//!
//! Of two edges that cross, neither may be an edge of a patch's hull, and a corner that has gone
//! through a thin edge lies behind every face that is near. The bodies then have the direction of a
//! translation that parts them (`penetration`), and the contact is the place at which they touch
//! last on their way out.

use nalgebra::{Translation3, Unit};

use super::{PatchContact, PatchQuery};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::composite::pieces::CompositeTracker;
use crate::composite::placement::relative;
use crate::convex::contact::ContactPoint;
use crate::pair::outcome::Class;

/// Steps back along a translation that parts two bodies, to the place of their last contact. Each
/// takes the gap that is left, so few do unless the bodies slide past each other. Not measured.
const WAY_BACK: usize = 64;

/// Returns the contact along a translation that parts two solids; `None` if none is known. `size`
/// is L of the pair in the caller's unit.
pub(super) fn parting(query: &PatchQuery, size: f64) -> Option<PatchContact> {
    let (a, b) = (query.a.parts(), query.b.parts());
    let mut tracker = CompositeTracker::new();
    let shift = tracker.penetration(&a, &b, query.pose)?.shift;
    let mut length = sqrt(shift.norm_squared());
    if !(length > 0.0) {
        return None;
    }
    let (n, at) = (Unit::new_unchecked(shift / length), relative(query.pose));
    // Twice the gap that proves the bodies apart.
    let last = 8.0 * CERTIFICATE * UNIT * size;
    let mut found = None;
    for _ in 0..WAY_BACK {
        let shifted = Translation3::from(*n * length) * at;
        let outcome = tracker.closest(&a, &b, &RelativePose::from_isometry(&shifted).ok()?);
        if outcome.class != Class::Separated {
            break;
        }
        found = Some(outcome);
        if !(outcome.upper > last) {
            break;
        }
        // The bodies cannot meet before they have moved by the gap between them.
        length -= outcome.lower - 0.5 * last;
    }
    let outcome = found?;
    let [p, q] = outcome.parts();
    let (point_on_a, point_on_b) = (outcome.point_on_a, outcome.point_on_b);
    Some(PatchContact {
        patches: [query.a.patch_at(p, &point_on_a), query.b.patch_at(q, &point_on_b)],
        normal: n,
        point: ContactPoint {
            point_on_a,
            point_on_b,
            separation: n.dot(&(at * point_on_b - point_on_a)),
            features: outcome.features,
            id: outcome.features,
        },
    })
}
