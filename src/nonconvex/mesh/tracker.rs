//! Queries of two meshes: the state of the pair, and the tests of triangles at a pose.
//!
//! [`TriangleJudge`] has the tests that a search applies to pairs of triangles.

use alloc::boxed::Box;
use nalgebra::Vector3;

use crate::base::num::Counter;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, VertexId};
#[cfg(feature = "exact")]
use crate::convex::exact::separation;
use crate::convex::tracker::Tracker;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::front::{FrontFault, NodePair, audit};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::self_distance::SelfState;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::query::frame::{TreeFrame, of_stored};
#[cfg(feature = "exact")]
use crate::nonconvex::query::overlap;
use crate::nonconvex::query::overlap::Touching;
#[cfg(feature = "exact")]
use crate::nonconvex::query::search::DecidedContact;
use crate::nonconvex::query::search::TreeWork;
use crate::nonconvex::query::search::{Judge, Measured};
use crate::nonconvex::query::state::{PosedTrees, TreeAnswer, TreeState};
use crate::nonconvex::query::triangle::{self, Closest, Triangle, TriangleSpot, certainly_cross};
use crate::pair::location::{PairOutcome, WitnessLocation};
#[cfg(feature = "exact")]
use crate::pair::outcome::ContactState;
use crate::pair::outcome::Outcome;

/// State of a pair of meshes: the front of the last answer, and work counters.
///
/// The next query starts from the front. A tracker owns no mesh. Its state changes the time of a
/// query, never the answer: a tracker of another pair, or an outdated one, may be used. Saving a
/// tracker (feature `serde`) saves only its counters.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MeshTracker {
    pub(super) state: TreeState,
    /// State of A against itself.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) own: Option<Box<SelfState>>,
}

impl MeshTracker {
    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> TreeWork {
        self.state.kept.work
    }

    pub(crate) fn kept(&self) -> &FrontMemory {
        &self.state.kept
    }

    pub(crate) fn count_windings(&mut self, taken: u64) {
        self.state.kept.work.windings.count(taken);
    }

    /// Returns the number of entries of the stored front.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.kept.front.len() + self.own.as_ref().map_or(0, |own| own.front.len())
    }

    /// Returns the stored front.
    ///
    /// It consists of pairs of nodes of A's and B's trees that are proven farther apart than the
    /// distance.
    #[cfg(feature = "__internals")]
    pub(crate) fn front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.state.kept.front.pairs()
    }

    /// Checks the stored front against all vertices, for debugging.
    ///
    /// The pose is that of the last [`closest`](Self::closest). The claims about A against itself
    /// are checked too. The time is proportional to entries times triangles.
    ///
    /// # Errors
    ///
    /// Returns the first claim that is false, or the first pair that is not covered.
    pub(crate) fn audit(&self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Result<(), FrontFault> {
        if let Some(own) = &self.own {
            own.audit(a)?;
        }
        match PosedTrees::new(a, b, a_from_b) {
            Some(posed) if !self.state.kept.front.is_empty() => audit(&self.state.kept.front, a, b, &posed.frame),
            _ => Ok(()),
        }
    }

    /// Increases the claim of an entry.
    #[cfg(test)]
    pub(crate) fn spoil(&mut self, entry: usize, by: f32) {
        let front = &mut self.state.kept.front;
        front.corrupt(front.place(entry % front.len()), by);
    }

    /// Removes an entry.
    #[cfg(test)]
    pub(crate) fn drop_entry(&mut self, entry: usize) {
        let front = &mut self.state.kept.front;
        front.remove(front.place(entry % front.len()));
    }

    /// Returns the number of bytes cached on the heap.
    #[must_use]
    pub(crate) fn memory_usage(&self) -> usize {
        let own = self.own.as_ref();
        self.state.kept.memory_usage() + own.map_or(0, |own| size_of::<SelfState>() + own.front.memory_usage())
    }

    /// Returns the closest points with bounds of the distance.
    ///
    /// `PairTracker::closest` documents the bounds. Contact ends the search early: for open meshes
    /// at the first pair in contact, for solids after 128 pairs if inner points of both are found.
    pub(crate) fn closest(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> PairOutcome {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.closest(b, a, &a_from_b.swapped()).swapped(a_from_b);
        }
        self.state.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let answer = match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let mut answer = self.state.closest(&posed, TriangleJudge::new(&posed, None));
                answer.join(&posed);
                answer
            }
            None => PosedTrees::far(a, b, a_from_b),
        };
        answered(a, b, &answer)
    }

    /// Returns whether the bodies are at most `d` apart, as `PairTracker::within` documents.
    ///
    /// The answer is exact with the feature `exact`; without it ties count as within. It is false
    /// if `d` is negative or NaN.
    pub(crate) fn within(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.within(b, a, &a_from_b.swapped(), d);
        }
        self.state.recognise(a, b);
        self.state.kept.work.queries.count(1);
        match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let judge = TriangleJudge::new(&posed, Some(d));
                self.state.within(&posed, judge, d / a.unit())
            }
            None => PosedTrees::far::<()>(a, b, a_from_b).lower <= d,
        }
    }

    /// Returns a lower bound of the distance from one pass over the front.
    ///
    /// The call does not search for the closest pair. It returns zero if nothing better is known.
    pub(crate) fn lower_bound(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> f64 {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.lower_bound(b, a, &a_from_b.swapped());
        }
        self.state.recognise(a, b);
        PosedTrees::new(a, b, a_from_b).map_or(0.0, |posed| self.state.lower_bound(&posed))
    }
}

fn answered(a: &Mesh, b: &Mesh, found: &TreeAnswer<[TriangleSpot; 2]>) -> PairOutcome {
    let (pair, features) = found.of.unwrap_or(([0, 0], [TriangleSpot::Vertex(0); 2]));
    found.on(spots(a, b, pair, features))
}

/// Triangles nearer than this fraction of L try face and edge directions as well.
///
/// Such a direction is taken if it proves as much as the direction of the witness points. This
/// costs up to two more gaps per pair, for directions that also prove coplanar neighbours. Plates
/// of 3,000 triangles at a gap of 1e-3 need 300 bounds per query without it.
const SHARP: f64 = 1.0 / 256.0;

/// Largest number of pairs of triangles in contact, and of pairs of boxes on the way to them, for
/// which integers decide the contact state. Two vertices of six triangles each have 36 pairs, a
/// vertex and a face or two edges have at most eight.
#[cfg(feature = "exact")]
const NEAR_PAIRS: usize = 16;
#[cfg(feature = "exact")]
const NEAR_BOXES: usize = 1024;

/// Measures pairs of triangles.
pub(super) struct TriangleJudge<'a> {
    posed: &'a PosedTrees<'a, Mesh, Mesh>,
    /// The distance to compare with, in the caller's unit, if the query is `within`.
    within: Option<f64>,
    /// Number of pairs that were decided by polygons.
    settled: u64,
}

impl<'a> TriangleJudge<'a> {
    pub(super) fn new(posed: &'a PosedTrees<'a, Mesh, Mesh>, within: Option<f64>) -> Self {
        Self {
            posed,
            within,
            settled: 0,
        }
    }

    /// Converts two triangles to polygons and runs the certified query on them.
    ///
    /// The result is in A's stored units.
    #[cold]
    fn settle(&mut self, frame: &TreeFrame, pair: NodePair, found: &Closest) -> Option<Measured<[TriangleSpot; 2]>> {
        self.settled += 1;
        let (a, b) = (self.posed.a, self.posed.b);
        // Vertices about a stored origin may be no numbers of the caller's frame.
        let (pose, _) = of_stored(a.side(), b.side(), self.posed.pose)?;
        let (p, q) = (a.stored_polygon(pair[0])?, b.stored_polygon(pair[1])?);
        let o: Outcome = Tracker::new().closest(&p, &q, &pose);
        let unit = 1.0 / a.unit();
        let distance = (o.distance * unit).at_least(0.0);
        // The pose of the stored origins errs by far less than one rounding of L.
        let is_far = !(a.frame.is_at_origin() && b.frame.is_at_origin());
        let off = frame.off + if is_far { UNIT * frame.size } else { 0.0 };
        let (lower, upper) = (o.lower * unit - off, o.upper * unit + off);
        // The witness points of a depth are as far apart as the depth.
        let (on_a, on_b) = if o.distance < 0.0 {
            (found.on_p, self.posed.back(&found.on_q))
        } else {
            (o.point_on_a.coords * unit, o.point_on_b.coords / b.unit())
        };
        Some(Measured {
            pair,
            distance,
            lower: lower.at_least(0.0).smaller(distance),
            upper: upper.larger(distance),
            normal: *o.normal,
            on_a,
            on_b,
            features: found.spots,
            crosses: upper < 0.0,
        })
        .filter(|m| m.lower >= m.distance - frame.tie)
    }

    /// Decides by integers whether two triangles share a point, and whether they cross.
    #[cfg(feature = "exact")]
    fn decide_pair(&mut self, m: &Measured<[TriangleSpot; 2]>) -> Option<Measured<[TriangleSpot; 2]>> {
        self.settled += 1;
        let (p, q) = self.polygons(m.pair)?;
        let (state, distance) = separation(&p, &q, self.posed.pose, [VertexId(0); 2])?;
        let unit = 1.0 / self.posed.a.unit();
        let bounds = if state == ContactState::Separated {
            [distance.next_down() * unit, distance.next_up() * unit]
        } else {
            [0.0; 2]
        };
        // A distance below the range of f64 is not decided.
        (state != ContactState::Separated || bounds[0] > 0.0).then(|| Measured {
            distance: distance * unit,
            lower: bounds[0],
            upper: bounds[1],
            crosses: state == ContactState::Overlapping,
            ..*m
        })
    }

    fn is_within(&mut self, pair: NodePair, d: f64) -> bool {
        self.settled += 1;
        self.polygons(pair)
            .is_none_or(|(p, q)| Tracker::new().within(&p, &q, self.posed.pose, d))
    }

    fn polygons(&self, [i, j]: NodePair) -> Option<(ConvexPolyhedron, ConvexPolyhedron)> {
        Some((self.posed.a.polygon(i)?, self.posed.b.polygon(j)?))
    }

    /// Decides exactly whether two triangles are within the given distance, if the bounds do not.
    ///
    /// Needs the feature `exact`. Ties of points with a position error count as within.
    fn decide(&mut self, frame: &TreeFrame, m: &mut Measured<[TriangleSpot; 2]>) {
        let Some(d) = self.within else { return };
        let stored = d / self.posed.a.unit();
        if m.lower > stored || m.upper <= stored {
            return;
        }
        let is_within = frame.off > 0.0 || self.is_within(m.pair, d);
        if is_within {
            m.upper = m.upper.smaller(stored);
            m.distance = m.distance.smaller(stored);
            m.lower = m.lower.smaller(stored);
        } else {
            m.lower = stored.next_up();
            m.distance = m.distance.larger(m.lower);
            m.upper = m.upper.larger(m.lower) + frame.error;
        }
    }
}

/// Returns the caller's indices of the triangles of a pair of items, and their features.
pub(super) fn spots(a: &Mesh, b: &Mesh, [i, j]: NodePair, spots: [TriangleSpot; 2]) -> [WitnessLocation; 2] {
    [spot(a, i, spots[0]), spot(b, j, spots[1])]
}

/// Returns the caller's index of the triangle of an item, and its feature.
pub(crate) fn spot(mesh: &Mesh, item: u32, spot: TriangleSpot) -> WitnessLocation {
    let corners = mesh.triangles[item as usize].each(|v| mesh.source_points[v as usize]);
    let at = |k: u8| corners[k as usize % 3];
    let triangle = mesh.source_triangles[item as usize];
    let feature = match spot {
        TriangleSpot::Vertex(k) => Feature::Vertex(VertexId(at(k))),
        TriangleSpot::Edge(k) => Feature::Edge(EdgeId(at(k))),
        TriangleSpot::Inside => Feature::Face(FaceId(triangle)),
    };
    WitnessLocation::new(triangle, feature)
}

/// Returns the gap of two triangles at a pose along a direction.
#[inline(always)]
fn gap(p: &Triangle, q: &Triangle, n: &Vector3<f64>) -> f64 {
    let high = p.iter().map(|x| n.dot(x)).fold(f64::NEG_INFINITY, f64::larger);
    let low = q.iter().map(|x| n.dot(x)).fold(f64::INFINITY, f64::smaller);
    low - high
}

/// Returns candidate directions from the triangles themselves, the likelier first.
///
/// First the outward normals of both, for flush triangles, then a direction perpendicular to both
/// features.
fn candidates(p: &Triangle, q: &Triangle, found: &Closest) -> [Vector3<f64>; 4] {
    let edge = |t: &Triangle, k: u8| t[(k as usize + 1) % 3] - t[k as usize % 3];
    let (of_p, of_q) = (triangle::normal(p), triangle::normal(q));
    let across = match found.spots {
        [TriangleSpot::Edge(i), TriangleSpot::Edge(j)] => edge(p, i).cross(&edge(q, j)),
        // A vertex and an edge: perpendicular to the edge, in the plane of the edge's triangle.
        [TriangleSpot::Edge(i), _] => edge(p, i).cross(&of_p),
        [_, TriangleSpot::Edge(j)] => of_q.cross(&edge(q, j)),
        [TriangleSpot::Inside, _] => -of_p,
        _ => of_q,
    };
    [of_p, -of_q, across, -across]
}

/// Returns the unit vector of a direction; `None` for a zero direction and for NaN.
fn unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let n = v / sqrt(v.norm_squared());
    // Written so that NaN gives `None`.
    (n.norm_squared() > 0.5).then_some(n)
}

impl Judge for TriangleJudge<'_> {
    type Features = [TriangleSpot; 2];

    #[inline(always)]
    fn highest_in_a(&self, item: u32, n: &Vector3<f64>) -> f64 {
        self.posed.a.highest(item, n)
    }

    #[inline(always)]
    fn lowest_in_b(&self, item: u32, n: &Vector3<f64>) -> f64 {
        let [a, b, c] = self.posed.b.corners(item);
        n.dot(&a).at_most(n.dot(&b)).at_most(n.dot(&c))
    }

    fn settled(&self) -> u64 {
        self.settled
    }

    fn shares_inside(&self, touching: &Touching, found: &Measured<[TriangleSpot; 2]>) -> (bool, u64) {
        self.posed.shares_inside(touching, found, false)
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn decide_contact(
        &mut self,
        touching: &Touching,
        found: &Measured<Self::Features>,
    ) -> Option<DecidedContact<Self::Features>> {
        let posed = self.posed;
        let frame = &posed.frame;
        // Pairs in one plane are many, or cost more than all the rest of the query.
        let is_flush = |[i, j]: NodePair| {
            let q = posed.b.corners(j).each(|x| frame.point(&x));
            overlap::is_flush(&posed.a.corners(i), &q, 2.0 * frame.error)
        };
        let mut met = touching.pairs().iter().chain([&found.pair]);
        // Far from the origin of a frame, a mesh that was moved has vertices between numbers.
        let is_far = !(posed.a.frame.is_at_origin() && posed.b.frame.is_at_origin());
        if is_far || frame.off > 0.0 || touching.is_full() || met.any(|pair| is_flush(*pair)) {
            return None;
        }
        let level = 2.0 * frame.tie;
        let (mut near, mut lower, mut measured) = (Touching::NONE, level, 0);
        let mut best: Option<Measured<_>> = None;
        let mut take = |m: Measured<_>| {
            lower = lower.smaller(m.lower);
            let is_better =
                |b: &Measured<_>| m.crosses && !b.crosses || m.crosses == b.crosses && m.distance < b.distance;
            if best.as_ref().is_none_or(is_better) {
                best = Some(m);
            }
        };
        let is_whole = posed.meet(level, NEAR_BOXES, |pair| {
            let q = posed.b.corners(pair[1]).each(|x| frame.point(&x));
            if gap(&posed.a.corners(pair[0]), &q, &found.normal) - frame.error > level {
                return false;
            }
            measured += 1;
            let m = self.measure(frame, pair, level);
            if m.lower > 0.0 {
                take(m);
            } else {
                near.push(pair);
            }
            let is_many = near.pairs().len() > NEAR_PAIRS || measured > 4 * NEAR_PAIRS;
            is_many || !(m.lower > 0.0) && is_flush(pair)
        });
        if !is_whole {
            return None;
        }
        near.sort();
        for &pair in near.pairs() {
            let m = self.measure(frame, pair, level);
            take(if m.crosses { m } else { self.decide_pair(&m)? });
        }
        Some(DecidedContact {
            best: best?,
            lower,
            touching: near,
        })
    }

    fn measure(&mut self, frame: &TreeFrame, pair: NodePair, known: f64) -> Measured<[TriangleSpot; 2]> {
        let p = self.posed.a.corners(pair[0]);
        let local = self.posed.b.corners(pair[1]);
        let q = local.each(|x| frame.point(&x));
        let found = triangle::closest(&p, &q);
        let distance = sqrt(found.square);
        let crosses = found.pierces && certainly_cross(&p, &q, frame.error);
        // Witness points closer than the rounding error have no direction.
        let between = if distance > frame.error {
            unit(&(found.on_q - found.on_p))
        } else {
            None
        };
        let mut best = between.map_or(f64::NEG_INFINITY, |n| gap(&p, &q, &n));
        let mut normal = between.unwrap_or_else(Vector3::x);
        // For `within`, the bound must exceed the threshold.
        let known = if self.within.is_some() {
            known + frame.tie + frame.error
        } else {
            known
        };
        let enough = distance.smaller(known) - frame.tie + frame.error;
        if best >= enough {
            // The direction between such near witness points has an error of rounding divided by
            // their distance. It affects long triangles and whole plates in flush contact.
            if distance < SHARP * frame.size {
                let level = enough.larger(best - frame.error);
                let sharp = |n: &Vector3<f64>| gap(&p, &q, n) >= level;
                if let Some(n) = candidates(&p, &q, &found).iter().filter_map(unit).find(sharp) {
                    (best, normal) = (gap(&p, &q, &n), n);
                }
            }
        } else {
            for n in candidates(&p, &q, &found).iter().filter_map(unit) {
                let along = gap(&p, &q, &n);
                if along > best + frame.error {
                    (best, normal) = (along, n);
                }
            }
        }
        let mut m = Measured {
            pair,
            distance,
            lower: (best - frame.error).at_least(0.0),
            upper: distance + frame.error,
            normal,
            on_a: found.on_p,
            on_b: frame.rotation.tr_mul(&(found.on_q - frame.translation))
                * (self.posed.a.unit() / self.posed.b.unit()),
            features: found.spots,
            crosses,
        };
        if crosses {
            (m.lower, m.upper) = (0.0, 0.0);
        } else if !(best >= enough)
            && let Some(settled) = self.settle(frame, pair, &found)
        {
            m = settled;
        }
        self.decide(frame, &mut m);
        m
    }
}
