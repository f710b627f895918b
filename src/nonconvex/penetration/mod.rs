//! Bounds of the penetration depth of two solids that are not convex.
//!
//! The depth is the length of the shortest translation of B after which the bodies share no
//! interior point.
//!
//! **Lower bounds.** If a point of one body is `r` deep inside the other, the depth is at least
//! `r`. The depth of two convex parts, one of each body, is a lower bound too, because the
//! translation separates them as well. The parts are:
//!
//! - two pieces of compounds;
//! - convex regions of meshes (`cell`) around the middle of an overlap that a translation ends. If
//!   the bodies are convex near the overlap, this bound is the depth itself; for example, if edges
//!   cross and no vertex is inside;
//! - regions around the middle of each body. If the bodies are convex and have few faces, these
//!   regions are the bodies themselves, up to rounding.
//!
//! **Upper bound.** The length of any translation after which the bodies are proven separated.
//!
//! The search for a short translation:
//!
//! 1. Move B by the deepest point or the deepest pair of pieces (`inner`) until the bodies are
//!    separated. A second start is the translation that separates the hulls.
//! 2. Shorten each translation by bisection.
//! 3. If no vertex is inside the other body and the bounds differ, move B by the overlap of convex
//!    regions around a point of an edge that is inside the other body (`inner`). An example is a
//!    pin in a slot: edges cross, and the hull of the slotted body fills the slot.
//! 4. If the bounds of pieces or elements differ, move B along the normals of their faces. The
//!    deepest of two equal cubes is as deep sideways as it is upward, so step 1 may go astray.
//!
//! No step is certain to find the shortest translation. If none does, the bounds are not tight. The
//! caller may ask for a width of the interval, to which `narrow` narrows it within a budget.
//!
//! Source: both bounds are from Zhang, Kim, Varadhan and Manocha 2007, "Generalized penetration
//! depth computation" (there for convex containers and pieces). Translations by local depths are
//! from Je et al. 2012, "PolyDepth". Departure: both bounds are proven.

mod cell;
mod inner;
mod narrow;

pub(crate) use narrow::Narrowing;

use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{BuildError, ConvexPolyhedron};
use crate::body::shape::Core;
use crate::convex::tracker::Tracker;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::tracker::MeshTracker;
use crate::nonconvex::parts::relative;
use crate::nonconvex::parts::{Centred, Parted, PartsRef};
use crate::nonconvex::pieces::{Compound, CompoundTracker, Piece};
use crate::nonconvex::query::state::PosedTrees;
use crate::nonconvex::separation::ball_about;
use crate::pair::outcome::ContactState;
use crate::pair::transform::about_origins;

/// If the bounds differ by less than this part of the upper one, edges are not searched.
const TIGHT: f64 = 1.0 / 1_048_576.0;

/// Distance to which the convex region of a mesh extends to each side, in depths. In 372 overlaps
/// of bars, Ls, gears, tori, rocks and screws, the bounds are equal with 1 to 16. With 0.5, the
/// lower bound of bars is 0.90 of the upper one instead of 1.
const CELL_REACH: f64 = 4.0;

/// Largest number of moves by the deepest overlap. For 24 overlaps of Ls, the 10 % quantile of the
/// ratio of lower to upper bound is 0.78 with 4 moves, and 0.83 with 12 or 32. For gears it is 0.63
/// with 4, and 0.67 with 12 or 32.
const PUSHES: usize = 12;

/// Number of bisections of the length of a separating translation; ten give a thousandth of the
/// length. For 24 overlaps of Ls, the 10 % quantile of the ratio of lower to upper bound is 0.78
/// with 6 bisections, and 0.83 with 10 or 16. For gears it is 0.61, 0.67 and 0.67.
const HALVINGS: usize = 10;

/// Largest number of normals of pieces along which B is moved: those of boxes along two frames.
const WAYS: usize = 12;

/// Cosine of the angle of two normals that count as one.
const ONE_WAY: f64 = 1.0 - 1.0 / (1u64 << 30) as f64;

/// Number of lengths tried along each normal; each is twice the one before.
const DOUBLINGS: usize = 8;

/// Factor by which separating translations are longer than computed, so that rounding does not keep
/// the bodies in contact.
pub(super) const BEYOND: f64 = 1.0 + 1.0 / 1_073_741_824.0;

/// Bounds of the penetration depth of two bodies.
///
/// The depth is the length of the shortest translation of B after which the bodies share no inner
/// point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PenetrationBounds {
    /// Lower bound of the depth: no shorter translation separates the bodies.
    ///
    /// It is zero for bodies that are separated or touch, and if nothing is known.
    pub lower: f64,
    /// Upper bound of the depth: the length of [`shift`](Self::shift), rounded up.
    pub upper: f64,
    /// A translation of B, in A's frame, after which the bodies are proven to be separated.
    pub shift: Vector3<f64>,
    /// Number of queries of the bodies that were needed.
    pub queries: u32,
}

/// Result of a tracker at a pose: contact state, lower bound of the distance, closest point of A.
type FoundAtPose = (ContactState, f64, Point3<f64>);

/// Two bodies whose depth is computed, and a query of a tracker.
struct Overlap<'a, A, B, Q> {
    a: &'a A,
    b: &'a B,
    query: Q,
}

impl<A: Parted, B: Parted, Q: FnMut(&RelativePose) -> FoundAtPose> Overlap<'_, A, B, Q> {
    /// Returns a lower bound of the distance at a pose and the closest point of A.
    ///
    /// Returns `None` if the bodies are not proven separated.
    fn apart(&mut self, pose: &RelativePose) -> Option<(f64, Point3<f64>)> {
        let (state, lower, point) = (self.query)(pose);
        (state == ContactState::Separated).then_some((lower, point))
    }

    /// Returns the translation of B that separates the hulls of both bodies, at least `least` long.
    fn by_hulls(&self, pose: &RelativePose, least: f64) -> Option<Vector3<f64>> {
        let hulls = hull(self.a.by_kind()).and_then(|a| Ok((a, hull(self.b.by_kind())?)));
        let (a, b) = hulls.ok()?;
        let found = Tracker::new().closest(&a, &b, pose);
        let length = (-found.lower).larger(least);
        length.is_finite().then(|| found.normal.into_inner() * length)
    }
}

fn hull(body: PartsRef) -> Result<ConvexPolyhedron, BuildError> {
    match body {
        PartsRef::Mesh(mesh) => mesh.hull(),
        PartsRef::Pieces(pieces) => pieces.hull(),
        PartsRef::Cloud(cloud) => cloud.hull(),
    }
}

struct PenetrationSearch<'a, A, B, Q> {
    bodies: Overlap<'a, A, B, Q>,
    /// The corners of the boxes of both bodies; of clouds, with all elements.
    boxes: [(Point3<f64>, Point3<f64>); 2],
    at: Isometry3<f64>,
    /// Bound of the rounding error of a translated pose.
    noise: f64,
    queries: u32,
    windings: u64,
    /// The last translation after which the bodies were separated, and the closest point of A.
    parted: Option<(Vector3<f64>, Point3<f64>)>,
}

impl<A: Parted, B: Parted, Q: FnMut(&RelativePose) -> FoundAtPose> PenetrationSearch<'_, A, B, Q> {
    fn shifted(&self, shift: &Vector3<f64>) -> Option<RelativePose> {
        RelativePose::from_isometry(&(Translation3::from(*shift) * self.at)).ok()
    }

    fn parts(&mut self, shift: &Vector3<f64>) -> bool {
        self.queries += 1;
        let pose = self.shifted(shift);
        let apart = pose.and_then(|pose| self.bodies.apart(&pose));
        let Some((_, point)) = apart.filter(|a| a.0 > self.noise) else {
            return false;
        };
        self.parted = Some((*shift, point));
        true
    }

    fn deepest(&mut self, pose: &RelativePose) -> Option<inner::ProvenDepth> {
        let (found, windings) = inner::deepest(self.bodies.a, self.bodies.b, pose);
        self.windings += windings;
        found
    }

    /// Returns a translation that separates the bounding balls of the boxes.
    fn far(&self) -> Vector3<f64> {
        let [(low_a, high_a), (low_b, high_b)] = self.boxes;
        let middle = |low: Point3<f64>, high: Point3<f64>| low + (high - low) * 0.5;
        let apart = self.at * middle(low_b, high_b) - middle(low_a, high_a);
        let length = sqrt(apart.norm_squared());
        let n = if length > 0.0 { apart / length } else { Vector3::x() };
        let reach = sqrt((high_a - low_a).norm_squared()) + sqrt((high_b - low_b).norm_squared());
        n * (0.5 * reach * BEYOND + 4.0 * self.noise - length).at_least(0.0)
    }

    /// Moves B by one overlap after another until the bodies are separated.
    ///
    /// `next` returns the translation out of an overlap; `None` if edges cross, and no interior
    /// point is found.
    fn pushed(
        &mut self,
        first: inner::ProvenDepth,
        next: impl Fn(&mut Self, &RelativePose) -> Option<Vector3<f64>>,
    ) -> Option<Vector3<f64>> {
        let mut shift = first.way;
        for _ in 0..PUSHES {
            // Without this, a body that touches one side of a slot would be moved on into the other
            // side.
            shift = self.longer(&shift);
            if self.parts(&shift) {
                return Some(shift);
            }
            let pose = self.shifted(&shift)?;
            shift = next(self, &pose).map_or(shift * 1.25, |way| shift + way);
        }
        None
    }

    /// Returns the overlap of convex parts of both bodies around an edge's point inside the other
    /// body.
    fn on_edges(&mut self, pose: &RelativePose) -> Option<inner::ProvenDepth> {
        let (a, b) = (self.bodies.a, self.bodies.b);
        let (found, windings) = inner::deepest_middle(a, b, pose);
        self.windings += windings;
        let (middle, depth) = found?;
        let reaches = [CELL_REACH * depth, f64::INFINITY];
        let parts = reaches.each(|reach| inner::of_parts(a, b, pose, &middle, reach));
        parts.into_iter().flatten().max_by(|x, y| x.depth.total_cmp(&y.depth))
    }

    /// Returns a longer translation, by more than the rounding of the pose.
    fn longer(&self, shift: &Vector3<f64>) -> Vector3<f64> {
        shift * (BEYOND + 4.0 * self.noise / sqrt(shift.norm_squared()))
    }

    /// Shortens a separating translation, to no less than `lower`.
    fn shortened(&mut self, shift: Vector3<f64>, lower: f64) -> Vector3<f64> {
        let length = sqrt(shift.norm_squared());
        // The shortest translation that the lower bound allows.
        let least = shift * (lower / length);
        if lower > 0.0 {
            let least = self.longer(&least);
            if least.norm_squared() < shift.norm_squared() && self.parts(&least) {
                return least;
            }
        }
        let (mut low, mut high) = ((lower / length).at_most(1.0), 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if !(middle > low && middle < high) {
                break;
            }
            if self.parts(&(shift * middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        shift * high
    }

    /// Returns a lower bound of the depth by convex parts around the middle of the overlap.
    ///
    /// The middle is taken between the bodies where they were closest after the last translation.
    fn between(&self, pose: &RelativePose) -> f64 {
        let Some((shift, on_a)) = &self.parted else { return 0.0 };
        let (middle, length) = (on_a - shift * 0.5, sqrt(shift.norm_squared()));
        let found = inner::of_parts(self.bodies.a, self.bodies.b, pose, &middle, CELL_REACH * length);
        found.map_or(0.0, |d| d.depth - self.noise)
    }

    /// Shortens a translation, and keeps it if it is the shortest separating one.
    fn improve(&mut self, pose: &RelativePose, start: &Vector3<f64>, lower: &mut f64, best: &mut Vector3<f64>) {
        // Longer by the rounding of the pose too.
        let start = self.longer(start);
        if start.norm_squared() > 0.0 && self.parts(&start) {
            let shift = self.shortened(start, *lower);
            if shift.norm_squared() < best.norm_squared() {
                *best = shift;
            }
            *lower = lower.larger(self.between(pose));
        }
    }

    /// Returns different directions in which a translation of B leaves a face of a piece.
    fn ways(&self) -> Vec<Vector3<f64>> {
        let mut all: Vec<Vector3<f64>> = Vec::new();
        let turned = self.at.rotation;
        for (body, is_of_a) in [(self.bodies.a.by_kind(), true), (self.bodies.b.by_kind(), false)] {
            let PartsRef::Pieces(body) = body else { continue };
            for Piece { shape, pose, .. } in body.pieces() {
                let Core::Polyhedron(core) = shape.core() else { continue };
                for (n, _) in core.faces().filter_map(|face| core.face_plane(face)) {
                    let n = pose.rotation * n.into_inner();
                    let n = if is_of_a { n } else { turned * -n };
                    if all.len() == WAYS {
                        return all;
                    }
                    if all.iter().all(|m| m.dot(&n) < ONE_WAY) {
                        all.push(n);
                    }
                }
            }
        }
        all
    }

    /// Moves B along the normals of pieces until the bodies are separated.
    fn improve_by_ways(&mut self, pose: &RelativePose, lower: &mut f64, best: &mut Vector3<f64>) {
        for n in self.ways() {
            let most = sqrt(best.norm_squared());
            let mut length = lower.larger(most / (1u64 << DOUBLINGS) as f64);
            for _ in 0..DOUBLINGS {
                let shift = self.longer(&(n * length));
                if !(shift.norm_squared() < most * most) {
                    break;
                }
                if self.parts(&shift) {
                    let shift = self.shortened(shift, *lower);
                    *best = shift;
                    *lower = lower.larger(self.between(pose));
                    break;
                }
                length *= 2.0;
            }
        }
    }

    fn run(mut self, pose: &RelativePose, narrowing: Option<Narrowing>) -> (PenetrationBounds, u64) {
        let deepest = self.deepest(pose);
        let mut lower = deepest.map_or(0.0, |d| (d.depth - self.noise).at_least(0.0));
        // Convex regions around the centres contain all of a convex body.
        let wholes = inner::of_wholes(self.bodies.a, self.bodies.b, pose);
        lower = wholes.map_or(lower, |d| lower.larger(d.depth - self.noise));
        let mut best = self.far();
        let starts = [
            self.bodies.by_hulls(pose, self.noise),
            deepest.and_then(|d| self.pushed(d, |s, pose| Some(s.deepest(pose)?.way * BEYOND))),
        ];
        for start in starts.into_iter().flatten() {
            self.improve(pose, &start, &mut lower, &mut best);
        }
        if deepest.is_none()
            && lower < (1.0 - TIGHT) * sqrt(best.norm_squared())
            && let Some(first) = self.on_edges(pose)
        {
            lower = lower.larger(first.depth - self.noise);
            let out = |s: &mut Self, pose: &RelativePose| s.deepest(pose).or_else(|| s.on_edges(pose));
            if let Some(start) = self.pushed(first, |s, pose| Some(out(s, pose)?.way)) {
                self.improve(pose, &start, &mut lower, &mut best);
            }
        }
        if lower < (1.0 - TIGHT) * sqrt(best.norm_squared()) {
            self.improve_by_ways(pose, &mut lower, &mut best);
        }
        if let Some(narrowing) = narrowing {
            self.narrow(narrowing, &mut lower, &mut best);
        }
        let bounds = PenetrationBounds {
            lower: lower.smaller(sqrt(best.norm_squared())),
            upper: sqrt(best.norm_squared()) * (1.0 + 4.0 * UNIT),
            shift: best,
            queries: self.queries,
        };
        (bounds, self.windings)
    }
}

/// Returns the bounds, and the number of winding numbers computed in addition to the queries.
///
/// `a` and `b` are the bodies, except that a cloud may be replaced by some of its elements:
/// these prove lower bounds, and `query` measures the whole bodies. `boxes` and `noise` are of the
/// whole bodies. Returns `None` if a body is an open mesh.
fn bounds<A: Parted, B: Parted>(
    a: &A,
    b: &B,
    (boxes, noise): WholeBodies,
    pose: &RelativePose,
    narrowing: Option<Narrowing>,
    query: impl FnMut(&RelativePose) -> FoundAtPose,
) -> Option<(PenetrationBounds, u64)> {
    if !(a.is_solid() && b.is_solid()) {
        return None;
    }
    let mut bodies = Overlap { a, b, query };
    if bodies.apart(pose).is_some() {
        let none = PenetrationBounds {
            lower: 0.0,
            upper: 0.0,
            shift: Vector3::zeros(),
            queries: 1,
        };
        return Some((none, 0));
    }
    let search = PenetrationSearch {
        bodies,
        boxes,
        at: relative(pose),
        noise,
        queries: 1,
        windings: 0,
        parted: None,
    };
    Some(search.run(pose, narrowing))
}

/// The corners of the boxes of two bodies, and a bound of the rounding error of a translated pose.
type WholeBodies = ([(Point3<f64>, Point3<f64>); 2], f64);

fn whole<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> Option<WholeBodies> {
    let posed = PosedTrees::new(a, b, pose)?;
    let noise = 4.0 * posed.frame.error * a.stored_unit();
    Some(([a.corners_of_box(), b.corners_of_box()], noise))
}

/// Largest number of elements of a cloud that are measured for a lower bound.
const NEAR_ELEMENTS: usize = 1024;

/// Returns the elements of a cloud near the other body as a compound.
///
/// If there are too many, some of them are left out. Returns `None` if there is none, and if the
/// body is no cloud. `other` is the other body's ball in the frame of the body.
fn near_elements(body: PartsRef, other: (Point3<f64>, f64)) -> Option<Compound> {
    let PartsRef::Cloud(cloud) = body else { return None };
    let (centre, radius) = other;
    let items = cloud.items_near((centre, 2.0 * radius));
    let step = items.len().div_ceil(NEAR_ELEMENTS).max(1);
    cloud.compound_of(items.into_iter().step_by(step)).ok()
}

impl MeshTracker {
    /// Returns bounds of the penetration depth of two solids; `None` if a mesh is open.
    ///
    /// See `PairTracker::penetration_with`.
    pub(crate) fn penetration(
        &mut self,
        a: &Mesh,
        b: &Mesh,
        a_from_b: &RelativePose,
        narrowing: Option<Narrowing>,
    ) -> Option<PenetrationBounds> {
        if !(a.is_near() && b.is_near()) {
            let pose = about_origins(a_from_b, [&a.frame.origin, &b.frame.origin])?;
            return self.penetration(&a.centred(), &b.centred(), &pose, narrowing);
        }
        let whole = whole(a, b, a_from_b)?;
        let (found, windings) = bounds(a, b, whole, a_from_b, narrowing, |pose| {
            let found = self.closest(a, b, pose);
            (found.state, found.lower, found.point_on_a)
        })?;
        self.count_windings(windings);
        Some(found)
    }
}

impl CompoundTracker {
    /// Returns bounds of the penetration depth of two solids: meshes, compounds or clouds.
    ///
    /// Returns `None` if a mesh is open. See `PairTracker::penetration_with`.
    pub(crate) fn penetration<A: Parted, B: Parted>(
        &mut self,
        a: &A,
        b: &B,
        a_from_b: &RelativePose,
        narrowing: Option<Narrowing>,
    ) -> Option<PenetrationBounds> {
        if !(a.is_near() && b.is_near()) {
            let origins = [a.side().frame.origin, b.side().frame.origin];
            let pose = about_origins(a_from_b, origins.each_ref())?;
            let (a, b) = (Centred::new(a.by_kind()), Centred::new(b.by_kind()));
            return self.penetration(&a.parts(), &b.parts(), &pose, narrowing);
        }
        let whole = whole(a, b, a_from_b)?;
        let (at, balls) = (relative(a_from_b), whole.0.each(ball_about));
        let of_a = near_elements(a.by_kind(), (at * balls[1].0, balls[1].1));
        let of_b = near_elements(b.by_kind(), (at.inverse_transform_point(&balls[0].0), balls[0].1));
        let near_a = of_a.as_ref().map_or(a.by_kind(), PartsRef::Pieces);
        let near_b = of_b.as_ref().map_or(b.by_kind(), PartsRef::Pieces);
        let (found, windings) = bounds(&near_a, &near_b, whole, a_from_b, narrowing, |pose| {
            let found = self.closest(a, b, pose);
            (found.state, found.lower, found.point_on_a)
        })?;
        self.count_windings(windings);
        Some(found)
    }
}
