//! Contacts of meshes and compounds: one manifold for each pair of convex patches.
//!
//! A manifold treats the triangles of a convex region as one body, so that edges inside the region
//! have no contact (`patches`). The manifold of two patches (`near`) is kept if its normal is a
//! normal of both bodies at the deepest point: the normal of a face, or one in the normal cone of a
//! convex edge or vertex. A reflex edge has no such normal, and neither has a face that an adjacent
//! piece covers (`body`).
//!
//! Otherwise the normal of a face is used: of all faces whose normal gives a valid contact, the one
//! with the least overlap. The contact is at the deepest vertex if no other surface is nearer to
//! it. If the face ends in a valley before it reaches the vertex, the contact is on one of the
//! vertex's edges. So a body that slides over the edges of a tessellated floor, or along a reflex
//! edge, feels none of them.
//!
//! A hull of a patch may extend outside the solid, and the face of the least overlap may be one
//! that the bodies do not reach. So a contact that is not sure is checked with the surfaces of both
//! bodies and all shallower contacts (`unresolved`): it is dropped if an overlap far shallower than
//! its own explains it.
//!
//! ```text
//!     |  B     |            B touches the wall along its whole side. The hull of wall and floor
//!     |        |            contains B, and the way out of the hull is up, from the bottom of B
//!   --|--------'  p_a       to the top of the wall. But p_b is on the surface of the wall, and p_a
//!  wall        |            on that of B: a shift by nothing ends this overlap.
//!     |________| p_b
//! ```
//!
//! Bodies may overlap although no patches have a valid contact. Two edges that cross may both not
//! be edges of a patch's hull, and a vertex that has passed through a thin edge is below the planes
//! of all faces near it. Then the direction of a separating translation is used (`penetration`),
//! and the contact is the point at which the bodies touch last on that translation ([`parting`]).
//!
//! Sources: normal cones: Clarke 1990, "Optimization and Nonsmooth Analysis", section 2.5 (proximal
//! normals). Patches: see `patches`.

mod body;
mod patch_pair;
mod patches;

use alloc::collections::BTreeMap;
use alloc::collections::btree_map::Entry;
use alloc::vec::Vec;
use nalgebra::{Point3, Translation3, Unit, Vector3};

pub use body::ConvexPatches;

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, ByValue, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::{sort, sort_by_key};
use crate::base::pose::RelativePose;
use crate::base::tolerance::{ACROSS, CERTIFICATE, UNIT};
use crate::convex::contact::{ContactCandidate, ContactPoint, ManifoldOptions, reduce, tangents_of};
use crate::nonconvex::front::NodePair;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::parts::{Placed, relative};
use crate::nonconvex::pieces::CompoundTracker;
use crate::nonconvex::query::box_gaps::{BoundAim, WIDTH, bounds};
use crate::nonconvex::query::frame::{TreeFrame, split_pair};
use crate::pair::outcome::ContactState;
use crate::pair::transform::about_origins;
use patch_pair::NearPatches;

/// Sine of the largest angle between the normals of contacts that are reduced together.
const ALIKE: f64 = 1.0 / 64.0;

/// How many times deeper than another contact a contact is that this one may explain. Vertices in
/// valleys are up to ten times deeper below one face than below the other, and have both contacts.
const FAR_DEEPER: f64 = 8.0;

/// How far from a contact the middle of its overlap is searched for, and the radius of the ball
/// that must be in the overlap there, in depths of the contact.
///
/// In the inner corner of two or three perpendicular sides, the overlap next to the contact is a
/// square or a cube of side 1. One of eight directions leads at most 22.5 degrees past its middle,
/// 0.7 away: to 0.27 and 0.65 from two of the sides.
const ASIDE: f64 = 0.7;
const ROOM: f64 = 0.25;

/// The square root of one half.
const HALF_ROOT: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// A contact and the patches on which it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PatchContact {
    /// The patch or piece of A and of B.
    ///
    /// Together with the id of the point it identifies the contact as long as the contact lasts.
    pub patches: [u32; 2],
    /// Unit direction from A to B, in A's frame, along which the two points are opposite each
    /// other.
    pub normal: Unit<Vector3<f64>>,
    /// The two points, in the bodies' frames.
    ///
    /// Features belong to the hulls of the patches. If the contact represents an overlap in which
    /// no patches have a valid contact, they belong to triangles or pieces.
    pub point: ContactPoint,
}

/// Contacts along nearly one direction.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactGroup {
    /// Unit direction from A to B, in A's frame: the normal of the deepest contact.
    ///
    /// The normals of the other contacts differ from it by at most one degree.
    pub normal: Unit<Vector3<f64>>,
    /// At most [`ManifoldOptions::max_points`] contacts of all patches.
    ///
    /// These are the deepest contact and those that span the largest area.
    pub contacts: Vec<PatchContact>,
}

/// The manifolds of the pairs of patches of two bodies that are near each other.
///
/// The contacts are those of shallow overlap. A body has no contact with a face if it is wholly
/// below the plane of the face, or if its deepest point has left the mesh on another side. If
/// solids overlap and the hulls of their patches have no valid contact, one contact is returned
/// along a separating translation. It costs as much as a depth query. A solid that is deep inside
/// another one, away from all patches, has no contact.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactTracker {
    fingerprints: [Fingerprint; 2],
    near: BTreeMap<NodePair, NearPatches>,
    /// Finds whether bodies without a contact overlap.
    overlap: CompoundTracker,
    found: Vec<ContactGroup>,
}

/// A contact query of two bodies.
struct PatchQuery<'a> {
    a: &'a ConvexPatches,
    b: &'a ConvexPatches,
    pose: &'a RelativePose,
    placed: Placed<'a>,
    options: &'a ManifoldOptions,
    /// Error bound of the position of a contact, in the caller's unit.
    doubt: f64,
}

impl ContactTracker {
    /// Returns the contacts of the last query.
    #[must_use]
    pub(crate) fn found(&self) -> &[ContactGroup] {
        &self.found
    }

    /// Returns the contacts within `options.prediction`, in groups of one direction.
    ///
    /// The group of the deepest contact is first. `options.max_face_sine` and
    /// `options.rebuild_motion` apply to the manifold of two patches.
    pub(crate) fn contacts(
        &mut self,
        a: &ConvexPatches,
        b: &ConvexPatches,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> &[ContactGroup] {
        let fingerprints = [a.fingerprint(), b.fingerprint()];
        if self.fingerprints != fingerprints {
            *self = Self::default();
            self.fingerprints = fingerprints;
        }
        let before = self.names();
        self.found.clear();
        let Some(a_from_b) = about_origins(a_from_b, [a.origin(), b.origin()]) else {
            return &self.found;
        };
        let a_from_b = &a_from_b;
        let Some(frame) = TreeFrame::new(a.side(), b.side(), a_from_b) else {
            return &self.found;
        };
        let query = PatchQuery {
            a,
            b,
            pose: a_from_b,
            placed: Placed::new(a_from_b, a.is_in_place() && b.is_in_place()),
            options,
            doubt: ACROSS * frame.size * a.unit(),
        };
        let mut all = self.ask_all(&query, &frame);
        if all.is_empty()
            && self.near.values().any(NearPatches::may_overlap)
            && self.overlap.within(&a.parts(), &b.parts(), a_from_b, 0.0)
        {
            let contact = parting(&query, frame.size * a.unit());
            all.extend(contact.filter(|c| c.point.separation <= options.prediction));
        }
        // The old contacts come first, so that they stay if others are equally good.
        let name = |c: &PatchContact| (c.patches, c.point.id);
        sort_by_key(&mut all, |c| !before.contains(&name(c)));
        let is_old = all.iter().take_while(|c| before.contains(&name(c))).count();
        let size = a.parts().half_size().smaller(b.parts().half_size());
        let merge = query.doubt.larger(options.rebuild_motion * size);
        self.found = groups(&all, is_old, options.most(), merge, query.doubt);
        let is_far = |origin: &Vector3<f64>| *origin != Vector3::zeros();
        if is_far(a.origin()) || is_far(b.origin()) {
            for contact in self.found.iter_mut().flat_map(|group| &mut group.contacts) {
                contact.point.point_on_a += a.origin();
                contact.point.point_on_b += b.origin();
            }
        }
        &self.found
    }

    /// Returns the names (patches and ids) of the contacts of the last query.
    fn names(&self) -> Vec<(NodePair, crate::body::polyhedron::FeaturePair)> {
        let all = self.found.iter().flat_map(|g| &g.contacts);
        all.map(|c| (c.patches, c.point.id)).collect()
    }

    /// Returns the contacts of all pairs of patches that are near each other.
    fn ask_all(&mut self, query: &PatchQuery, frame: &TreeFrame) -> Vec<PatchContact> {
        let mut all = Vec::new();
        self.near.values_mut().for_each(|n| n.is_seen = false);
        for patches in near_pairs(query, frame) {
            let near = match self.near.entry(patches) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => match NearPatches::new(query.a, query.b, patches) {
                    Some(near) => place.insert(near),
                    None => continue,
                },
            };
            near.is_seen = true;
            near.ask(query, patches, |contact, is_sure| all.push((contact, is_sure)));
        }
        self.near.retain(|_, near| near.is_seen);
        unresolved(query, &all)
    }
}

/// How many times the error bound of a position counts next to curved pieces, for contacts that are
/// this many times deeper still.
///
/// The nearest surface point of a curved piece is known to the bounds of a distance, that of a face
/// to rounding.
const CURVED: f64 = 64.0;

/// Returns the contacts that no far shallower overlap explains, each with whether its depth is
/// sure.
///
/// An overlap that a shift of B ends is as narrow as the shift: everywhere in it the surfaces of
/// both bodies are near. So the contacts of two patches are kept if the point on B of one that is
/// nearly the deepest is deep inside A, or its point on A is deep inside B. The shift may be along
/// the normals of three shallower contacts, and it may be none, for bodies that touch.
///
/// The points of a real contact may all be at the ends of the overlap, next to other sides of both
/// bodies. Then both bodies contain a ball next to one of them, and the contacts are kept as well.
fn unresolved(query: &PatchQuery, all: &[(PatchContact, bool)]) -> Vec<PatchContact> {
    let depth = |c: &PatchContact| -c.point.separation;
    let mut depths: Vec<f64> = Vec::new();
    if all.iter().any(|(_, is_sure)| !is_sure) {
        depths.extend(all.iter().map(|(c, _)| depth(c)).filter(|d| *d > 0.0));
        sort(&mut depths, f64::total_cmp);
    }
    let is_kept = |of: &[(PatchContact, bool)]| {
        let deepest = of.iter().map(|(c, _)| depth(c)).fold(0.0, f64::larger);
        let before = depths.partition_point(|d| *d <= deepest / FAR_DEEPER);
        let shallower = before.checked_sub(1).map_or(0.0, |k| depths[k]);
        let within = |doubt| 2.0 * (shallower + 2.0 * doubt);
        let mut reach = within(query.doubt);
        if of[0].1 || !(reach < deepest) {
            return true;
        }
        if query.a.is_curved || query.b.is_curved {
            reach = reach.larger(within(CURVED * query.doubt).smaller(deepest / CURVED));
        }
        // A far shallower contact of the same patches says nothing about the deepest one.
        let overlaps = || of.iter().map(|(c, _)| c).filter(|c| depth(c) > deepest / FAR_DEEPER);
        overlaps().any(|c| query.is_deep(c, reach)) || overlaps().any(|c| query.have_room(c))
    };
    let pairs = all.chunk_by(|x, y| x.0.patches == y.0.patches).filter(|of| is_kept(of));
    pairs.flatten().map(|(c, _)| *c).collect()
}

impl PatchQuery<'_> {
    /// Returns a point of A's frame in B's.
    fn in_b(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.pose.rotation().tr_mul(&(point.coords - self.pose.translation())))
    }

    /// Returns a point of B's frame in A's.
    fn in_a(&self, point: &Point3<f64>) -> Point3<f64> {
        self.pose.rotation() * point + self.pose.translation()
    }

    /// Returns whether a contact's point on B is deeper than `reach` inside A, or its point on A
    /// inside B.
    ///
    /// The path from point to point is known to stay in the body, unless it starts along a side.
    fn is_deep(&self, contact: &PatchContact, reach: f64) -> bool {
        let (n, point) = (contact.normal.into_inner(), &contact.point);
        let deep = |body: &ConvexPatches, from: &Point3<f64>, to: &Point3<f64>| {
            !body.is_near(to, reach, self.doubt) && !body.is_near(from, 0.5 * reach, self.doubt)
        };
        let (on_a, on_b) = (point.point_on_a, self.in_a(&point.point_on_b));
        deep(self.a, &(on_a - n * reach), &on_b) || deep(self.b, &self.in_b(&(on_b + n * reach)), &self.in_b(&on_a))
    }

    /// Returns whether both bodies contain a ball next to a contact: its radius is a part of the
    /// depth, so no far shorter shift separates the bodies.
    fn have_room(&self, contact: &PatchContact) -> bool {
        let PatchContact { normal, point, .. } = contact;
        let depth = -point.separation;
        let middle = point.point_on_a + (self.in_a(&point.point_on_b) - point.point_on_a) * 0.5;
        let [u, v] = tangents_of(normal).each(|w| w * (ASIDE * depth));
        let [sum, difference] = [u + v, u - v].each(|w| w * HALF_ROOT);
        let ways = [Vector3::zeros(), u, -u, v, -v, sum, -sum, difference, -difference];
        let radius = ROOM * depth;
        let contains = |body: &ConvexPatches, place: &Point3<f64>| {
            !body.is_near(place, radius, self.doubt) && body.holds(place, self.doubt)
        };
        let mut places = ways.iter().map(|way| middle + way);
        places.any(|place| contains(self.a, &place) && contains(self.b, &self.in_b(&place)))
    }
}

/// Groups contacts with similar normals and keeps a few of each group.
///
/// The first `old` contacts are those of the last query.
fn groups(all: &[PatchContact], old: usize, most: usize, merge: f64, tie: f64) -> Vec<ContactGroup> {
    let mut deepest: Vec<usize> = (0..all.len()).collect();
    sort(&mut deepest, |&i, &j| {
        all[i].point.separation.by_value(all[j].point.separation)
    });
    let mut groups: Vec<(Unit<Vector3<f64>>, Vec<usize>)> = Vec::new();
    for k in deepest {
        let n = all[k].normal;
        let is_alike = |m: &Unit<Vector3<f64>>| m.dot(&n) > 0.0 && m.cross(&n).norm_squared() <= ALIKE * ALIKE;
        match groups.iter_mut().find(|g| is_alike(&g.0)) {
            Some(group) => group.1.push(k),
            None => groups.push((n, alloc::vec![k])),
        }
    }
    let reduced = |(normal, mut members): (Unit<Vector3<f64>>, Vec<usize>)| {
        members.sort_unstable();
        let before = members.partition_point(|&k| k < old);
        let [u, v] = tangents_of(&normal);
        let first = all[members[0]].point.point_on_a;
        let candidate = |&k: &usize| {
            let d = all[k].point.point_on_a - first;
            ContactCandidate::at([u.dot(&d), v.dot(&d)], all[k].point.separation)
        };
        let candidates: Vec<_> = members.iter().map(candidate).collect();
        let kept = if before < 64 { (1 << before) - 1 } else { u64::MAX };
        let chosen = reduce(&candidates, kept, most, merge, tie);
        ContactGroup {
            normal,
            contacts: chosen.all().iter().map(|&k| all[members[k]]).collect(),
        }
    };
    groups.into_iter().map(reduced).collect()
}

/// Returns the pairs of patches whose boxes may be within the prediction, in order.
///
/// All other pairs are proven farther apart.
fn near_pairs(query: &PatchQuery, frame: &TreeFrame) -> Vec<NodePair> {
    let PatchQuery { a, b, options, .. } = query;
    let (of_a, of_b) = (a.side().tree, b.side().tree);
    let level = frame.single_up(options.prediction.at_least(0.0) / a.unit());
    let aim = BoundAim::to((level + frame.single.error).next_up());
    let (mut stack, mut found) = (alloc::vec![[0, 0]], Vec::new());
    while !stack.is_empty() {
        let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
        let gaps = bounds(&frame.single, [of_a, of_b], &batch, &aim);
        for (&pair, gap) in batch.iter().zip(gaps.gap) {
            if frame.single.error.is_finite() && gap - frame.single.error > level {
                continue;
            }
            match split_pair([of_a, of_b], frame, pair) {
                Some(two) => stack.extend(two),
                None => found.push([a.patch(of_a.range(pair[0]).start), b.patch(of_b.range(pair[1]).start)]),
            }
        }
    }
    found.sort_unstable();
    found
}

/// Maximum number of steps back along a separating translation to the point of last contact.
///
/// Each step closes the gap that is left, so few steps suffice unless the bodies slide past each
/// other.
const WAY_BACK: usize = 64;

/// Returns the contact along a translation that separates two solids; `None` if none is known.
///
/// `size` is the pair size L in the caller's unit.
fn parting(query: &PatchQuery, size: f64) -> Option<PatchContact> {
    let (a, b) = (query.a.parts(), query.b.parts());
    let mut tracker = CompoundTracker::new();
    let shift = tracker.penetration(&a, &b, query.pose, None)?.shift;
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
        if outcome.state != ContactState::Separated {
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
