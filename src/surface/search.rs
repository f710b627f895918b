//! Best-first search over the pairs of nodes of two trees, the front that it leaves, and the state
//! that the trackers of all pairs with a surface keep.
//!
//! The search splits the open pair with the smallest lower bound, until no open pair is closer than
//! the goal allows. Pairs that are far enough apart go to the front; together they are the proof.
//! The front of the last outcome ([`NetFront`]) is a set of pairs of nodes that covers every pair
//! of patches. Each entry has the direction that proved it far enough apart.
//!
//! An entry claims a gap at other poses, as in [`nonconvex::front`](crate::nonconvex), but in
//! double precision. Let Y, the points in a node of B, lie in the ball of radius rho around c in
//! B's frame. Let X, the points in a node of A, be at least g below Y along n in A's frame, at the
//! pose (R0, t0). At the pose (R, t) the gap is at least
//!
//! `g + n . (R c + t) - n . (R0 c + t0) - rho |R^T n - R0^T n|`,
//!
//! for any motion between the two poses. If the node of A is the smaller one, the bodies exchange
//! their roles. So a claim never expires; after a large displacement it merely proves nothing.
//!
//! [`SurfaceMemory::search`] runs a query.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::bezier_surface::SurfaceWork;
use super::closest::{Meeting, Meets};
use super::gap::{Gap, NetFrame, NetPair, Trees};
use super::height::NetSide;
use super::region::Region;
use super::tree::Node;
use crate::base::num::Ranked;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{CARRIED, UNIT};

/// Number of splits after which a search first measures how far apart its bounds are. After twice
/// as many splits it tests whether the bounds approach each other fast enough for its budget. Of
/// 2,500 random pairs one in a thousand needs more than 1,848 splits.
const FIRST_LOOK: usize = 1_024;

/// A search continues if it is expected to need at most this many times its budget, because the
/// speed of its bounds is known only roughly. Pairs at a constant distance along a curve need about
/// 20 times the default budget for an interval of 1e-9.
const LENIENT: usize = 4;

/// A region is tried if a pair of nodes is at most this many times as large as the region.
const SMALL: f64 = 4.0;

/// Extent of the first region, as a fraction of the radius of the smaller surface.
const BEGINNING: f64 = 0.25;

/// Factor by which a proven region grows in the next frame.
const GROWING: f64 = 1.05;

/// Factor by which a region shrinks if it was not proven.
const SHRINKING: f64 = 0.5;

/// Number of pairs from one unconditional descent to the next: see [`IMPATIENT`].
const PATIENCE: usize = 32;

/// A pair that may be closer than the goal allows, ranked by its gap.
type OpenNodePair = Ranked<NetPair, Gap>;

/// The goal of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NetGoal {
    /// An interval of the distance of at most this width.
    Width(f64),
    /// An interval of at most this fraction of the upper bound.
    Part(f64),
    /// A decision whether the distance is at most this.
    Within(f64),
}

impl NetGoal {
    /// Returns whether bounds are as close as the goal requires.
    pub(super) fn is_converged(self, lower: f64, upper: f64) -> bool {
        match self {
            Self::Width(width) => upper - lower <= width,
            Self::Part(part) => upper - lower <= part * upper,
            Self::Within(d) => upper <= d || lower > d,
        }
    }
}

/// The speed at which the bounds of a search approach each other.
///
/// If the closest points are isolated, the number of splits grows with log(1/width). If two
/// surfaces are equally far apart along a curve or over an area, it grows with a power of 1/width.
/// Most such queries could use up any budget without reaching their goal.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Number of splits that a query may make.
    allowed: usize,
    /// Number of splits of patches and their parts so far. Splits of groups do not count, because
    /// their number is finite.
    splits: usize,
    /// Number of splits at the last test, and how far apart the bounds were then.
    looked: usize,
    apart: f64,
}

impl Pace {
    fn new(allowed: usize) -> Self {
        Self {
            allowed,
            splits: 0,
            looked: 0,
            apart: f64::INFINITY,
        }
    }

    /// Returns whether the bounds are expected to be as close as `needed` within [`LENIENT`] times
    /// the budget. `apart` is how far apart they are now. Each doubling of the splits is expected
    /// to gain as much as the last one. The test runs after [`FIRST_LOOK`] splits, twice as many,
    /// and so on; the result is true between tests.
    fn is_enough(&mut self, apart: f64, needed: f64) -> bool {
        if self.splits < FIRST_LOOK.max(2 * self.looked) {
            return true;
        }
        let gain = self.apart / apart;
        (self.looked, self.apart) = (self.splits, apart);
        let (mut splits, mut apart) = (self.splits, apart);
        while splits < LENIENT * self.allowed && apart > needed {
            (splits, apart) = (2 * splits, apart / gain);
        }
        apart <= needed
    }
}

/// A search in progress.
struct NetSearch<'a, 't, B, M> {
    trees: &'a mut Trees<'t, B>,
    points: &'a mut M,
    goal: NetGoal,
    /// Splits that are left.
    budget: usize,
    pace: Pace,
    heap: &'a mut BinaryHeap<OpenNodePair>,
    front: &'a mut NetFront,
    best: Option<Meeting>,
    /// Upper bound of the distance, errors included.
    upper: f64,
    /// A direction from A to B at the best points.
    hint: Option<Vector3<f64>>,
    /// The proven region around the best points.
    region: Option<Region>,
    /// Extent of the next region along the surfaces: `None` before the first try, zero if no region
    /// could be proven.
    way: &'a mut Option<f64>,
    /// Number of pairs until the next descent that starts whether or not the middle of the pair is
    /// close.
    patience: usize,
    /// Number of regions that may still be tried.
    tries: usize,
    /// The smallest lower bound of all closed pairs.
    least: f64,
    work: &'a mut SurfaceWork,
}

impl<B: NetSide, M: Meets> NetSearch<'_, '_, B, M> {
    /// Returns the lower bound from which a pair is far enough apart.
    fn level(&self) -> f64 {
        let limit = self.trees.frame.limit;
        match self.goal {
            NetGoal::Width(width) => self.upper - limit.larger(width),
            NetGoal::Part(part) => self.upper - (part * self.upper).larger(limit),
            NetGoal::Within(d) => d.next_up().smaller(self.upper - limit),
        }
    }

    fn is_over(&self) -> bool {
        matches!(self.goal, NetGoal::Within(d) if self.upper <= d)
    }

    /// Descends from a start, and keeps the two points if they are closer than the best.
    pub(super) fn offer(&mut self, patches: [u32; 2], start: [f64; 4]) {
        let Some((meeting, steps)) = self.points.descend(patches, start) else {
            return;
        };
        self.work.steps += steps;
        if meeting.upper < self.upper {
            self.upper = meeting.upper;
            self.hint = meeting.along;
            self.best = Some(meeting);
            self.region = None;
        }
    }

    /// Starts the search at the pair of roots.
    pub(super) fn start(&mut self) {
        self.work.searches += 1;
        self.front.entries.clear();
        *self.way = self.way.filter(|way| *way > 0.0);
        let (x, y) = (self.trees.a.node(0), self.trees.b.node(0));
        let between = self.trees.frame.place(&y.centre) - x.centre;
        let square = between.norm_squared();
        let along = if square > 0.0 {
            between / sqrt(square)
        } else {
            Vector3::x()
        };
        self.sort([0, 0], &along);
    }

    /// Proves the front again at the new pose. An entry that is not proven gets a new bound, or is
    /// opened.
    pub(super) fn renew(&mut self) {
        self.work.entries += self.front.entries.len() as u64;
        if self.way.is_some_and(|way| way > 0.0) {
            self.find_region();
        }
        let mut k = 0;
        while k < self.front.entries.len() {
            let entry = self.front.entries[k];
            let carried = entry.gap(self.trees.frame);
            if carried.at_least(0.0) >= self.level() {
                self.least = self.least.smaller(carried);
                k += 1;
                continue;
            }
            self.work.failed += 1;
            let n = entry.direction(self.trees.frame);
            let gap = self.bound(entry.pair, &n);
            if gap.gap.at_least(0.0) >= self.level() {
                self.least = self.least.smaller(gap.gap);
                self.front.entries[k] = NetEntry::new(self.trees, entry.pair, &gap);
                k += 1;
            } else {
                self.front.entries.swap_remove(k);
                self.open(entry.pair, gap);
            }
        }
    }

    /// Closes a pair that is far enough apart; opens any other pair.
    fn sort(&mut self, pair: NetPair, along: &Vector3<f64>) {
        let level = self.level();
        let gap = self.bound(pair, along);
        if gap.gap.at_least(0.0) >= level {
            self.close(pair, &gap);
        } else {
            self.open(pair, gap);
        }
    }

    fn bound(&mut self, pair: NetPair, along: &Vector3<f64>) -> Gap {
        if let Some(gap) = self.covered(pair, along) {
            return gap;
        }
        let (level, is_near) = (self.level(), self.is_at_best(pair));
        if is_near && self.region.is_some() {
            // The pair is larger than the region that was proven at once.
            return self.trees.along(pair, along);
        }
        let mut gap = self.trees.bound(pair, along, self.hint.as_ref(), level);
        if gap.gap < level {
            self.raise(pair, level, &mut gap);
        }
        // If the best points lie in the pair, other directions rarely raise its gap to the level.
        if gap.gap < level && !is_near {
            self.trees.turn(pair, level, &mut gap);
        }
        if gap.gap >= level || !(level > 0.0) {
            return gap;
        }
        if is_near && self.is_small(pair) && self.find_region() {
            return self.covered(pair, along).unwrap_or(gap);
        }
        let bowl = self.best.as_ref().and_then(|best| best.bowl.as_ref());
        let more = self.target();
        match bowl {
            Some(bowl) if self.trees.is_about(pair, bowl, more) => Gap {
                gap: more,
                is_plane: false,
                ..gap
            },
            _ => gap,
        }
    }

    /// Raises a gap to a convex body along the direction from the middle of A's node to the closest
    /// point of B. The distance of a point from a convex body is convex, and this direction is its
    /// gradient. So the gap falls short only by terms of second order.
    fn raise(&mut self, pair: NetPair, level: f64, gap: &mut Gap) {
        let x = self.trees.a.node(pair[0]);
        if B::IS_CONVEX
            && !x.is_group()
            && let Some(n) = self.points.direction(x.patch(), x.middle())
        {
            self.trees.improve(pair, &n, level, gap);
        }
    }

    /// Returns a little more than the level, so that rounding leaves the interval no wider than
    /// requested.
    fn target(&self) -> f64 {
        self.level() + 4.0 * UNIT * self.trees.frame.size
    }

    /// Returns the gap of a pair in the region; `None` for any other pair.
    fn covered(&self, pair: NetPair, along: &Vector3<f64>) -> Option<Gap> {
        let region = self.region.as_ref()?;
        let (x, y) = (self.trees.a.node(pair[0]), self.trees.b.node(pair[1]));
        region.covers(x, y).then_some(Gap {
            n: *along,
            gap: region.target,
            is_plane: false,
        })
    }

    /// Returns whether a pair is small enough to try a region.
    fn is_small(&self, pair: NetPair) -> bool {
        let (x, y) = (self.trees.a.node(pair[0]), self.trees.b.node(pair[1]));
        let size = if y.can_split() {
            x.radius.larger(y.radius)
        } else {
            x.radius
        };
        size <= SMALL * self.first_way()
    }

    /// Returns the extent of the first region to try.
    fn first_way(&self) -> f64 {
        self.way.unwrap_or_else(|| {
            let radius = |node: &Node| if node.can_split() { node.radius } else { f64::INFINITY };
            BEGINNING * radius(self.trees.a.node(0)).smaller(radius(self.trees.b.node(0)))
        })
    }

    /// Proves a region around the best points, as large as possible; returns whether one is proven.
    fn find_region(&mut self) -> bool {
        let target = self.target();
        let Some(best) = self.best.filter(|_| target > 0.0) else {
            return false;
        };
        let mut way = self.first_way();
        while self.tries > 0 {
            self.tries -= 1;
            self.region = Region::about(&best, way, target, &*self.points, self.trees);
            if self.region.is_some() {
                self.work.regions += 1;
                *self.way = Some(way * GROWING);
                return true;
            }
            self.work.refused += 1;
            way *= SHRINKING;
        }
        // No region is tried again until a search starts at the roots.
        *self.way = Some(0.0);
        false
    }

    /// Returns whether the best points lie in a pair.
    fn is_at_best(&self, pair: NetPair) -> bool {
        let (x, y) = (self.trees.a.node(pair[0]), self.trees.b.node(pair[1]));
        self.best.as_ref().is_some_and(|best| {
            let [u, v, s, t] = best.at;
            best.patches == [x.patch(), y.patch()] && x.holds([u, v]) && y.holds([s, t])
        })
    }

    fn close(&mut self, pair: NetPair, gap: &Gap) {
        self.least = self.least.smaller(gap.gap);
        self.front.entries.push(NetEntry::new(self.trees, pair, gap));
    }

    /// Searches until the goal is reached or the budget is used up. Returns the smallest lower
    /// bound of all pairs, at least zero.
    pub(super) fn run(&mut self) -> f64 {
        while !self.is_over() {
            let Some(open) = self.heap.pop() else { break };
            self.improve(&open);
            let is_over = open.rank.at_least(0.0) >= self.level() || !self.is_worth(&open);
            if is_over || !self.split(&open) {
                self.close(open.key, &open.item);
                if is_over || self.budget == 0 {
                    break;
                }
            }
        }
        let rest = core::mem::take(self.heap);
        for open in rest.iter() {
            self.close(open.key, &open.item);
        }
        *self.heap = rest;
        self.heap.clear();
        self.least.clamped(0.0, self.upper)
    }

    /// Puts a pair on the heap.
    fn open(&mut self, key: NetPair, item: Gap) {
        let rank = item.gap;
        self.heap.push(Ranked { rank, key, item });
    }

    /// Returns whether the search is expected to reach its goal within its budget. `open` is the
    /// pair with the smallest bound. Always true for a convex body, because at the rims of
    /// cylinders and cones the bounds come close late.
    fn is_worth(&mut self, open: &OpenNodePair) -> bool {
        let needed = self.upper - self.level();
        B::IS_CONVEX || self.pace.is_enough(self.upper - open.rank, needed)
    }

    /// Splits the larger node of a pair and sorts the two new pairs. Returns false if nothing can
    /// be split or the budget is used up.
    fn split(&mut self, open: &OpenNodePair) -> bool {
        let [x, y] = open.key;
        if self.budget == 0 {
            return false;
        }
        let (a, b) = (self.trees.a.node(x), self.trees.b.node(y));
        let is_of_groups = a.is_group() || b.is_group();
        let of_a = match (a.can_split(), b.can_split()) {
            (false, false) => return false,
            (true, true) => a.radius >= b.radius,
            (of_a, _) => of_a,
        };
        self.budget -= 1;
        self.pace.splits += usize::from(!is_of_groups);
        self.work.splits += 1;
        let pairs = if of_a {
            let child = self.trees.a.split(x);
            [[child, y], [child + 1, y]]
        } else {
            let child = self.trees.b.split(y);
            [[x, child], [x, child + 1]]
        };
        for pair in pairs {
            self.sort(pair, &open.item.n);
        }
        true
    }

    /// Searches for closer points in a pair, unless the best points lie there.
    fn improve(&mut self, open: &OpenNodePair) {
        let (x, y) = (self.trees.a.node(open.key[0]), self.trees.b.node(open.key[1]));
        if x.is_group() || y.is_group() || self.is_at_best(open.key) {
            return;
        }
        let patches = [x.patch(), y.patch()];
        let ([u, v], [s, t]) = (x.middle(), y.middle());
        // If bodies cross, no bound leads to the crossing, because parts inside each other have
        // arbitrary bounds.
        self.patience -= 1;
        if self.patience == 0 {
            self.patience = PATIENCE;
            return self.offer(patches, [u, v, s, t]);
        }
        let frame = self.trees.frame;
        // The ball of a body that is not split does not shrink, however close its points are.
        let share = if y.can_split() { 0.5 } else { 1.0 };
        let most = self.upper + share * (x.radius + y.radius);
        let between = frame.place(&y.centre) - x.centre;
        if !(between.norm_squared() < most * most) {
            return;
        }
        if self.points.is_closer(patches, [u, v, s, t], self.upper) {
            self.offer(patches, [u, v, s, t]);
        }
    }
}

/// A pair of nodes, and what its gap claims at any pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetEntry {
    pub(super) pair: NetPair,
    /// The direction in A's frame.
    n: Vector3<f64>,
    /// The direction in B's frame.
    m: Vector3<f64>,
    /// Centre of the ball, in the frame of its body.
    centre: Vector3<f64>,
    radius: f64,
    base: f64,
    /// Whether the ball contains A's node.
    is_of_a: bool,
    /// Whether planes proved the gap. Otherwise the entry claims nothing at other poses.
    is_plane: bool,
}

impl NetEntry {
    /// Returns the entry of a pair with this gap at this pose.
    fn new<B: NetSide>(trees: &Trees<B>, pair: NetPair, gap: &Gap) -> Self {
        let (x, y) = (trees.a.node(pair[0]), trees.b.node(pair[1]));
        let is_of_a = x.radius < y.radius;
        let ball = if is_of_a { x } else { y };
        let mut entry = Self {
            pair,
            n: gap.n,
            m: trees.frame.direction_in_b(&gap.n),
            centre: ball.centre,
            radius: ball.radius + ball.error,
            base: 0.0,
            is_of_a,
            is_plane: gap.is_plane,
        };
        entry.base = gap.gap - entry.height(trees.frame) - CARRIED * trees.frame.size;
        entry
    }

    /// Returns the height of the centre of the ball in the frame of the other body.
    #[inline(always)]
    fn height(&self, frame: &NetFrame) -> f64 {
        if self.is_of_a {
            self.m.dot(&frame.rotation.tr_mul(&(frame.translation - self.centre)))
        } else {
            self.n.dot(&frame.place(&self.centre))
        }
    }

    /// Returns a lower bound of the gap at a pose.
    #[inline(always)]
    fn gap(&self, frame: &NetFrame) -> f64 {
        if !self.is_plane {
            return f64::NEG_INFINITY;
        }
        let turned = if self.is_of_a {
            frame.rotation * self.m - self.n
        } else {
            frame.direction_in_b(&self.n) - self.m
        };
        let lost = self.radius * sqrt(turned.norm_squared());
        self.base + self.height(frame) - lost - CARRIED * frame.size - frame.placing
    }

    /// Returns the direction in A's frame at a pose.
    fn direction(&self, frame: &NetFrame) -> Vector3<f64> {
        if self.is_of_a {
            let n = frame.rotation * self.m;
            n / sqrt(n.norm_squared())
        } else {
            self.n
        }
    }
}

/// The entries, and their number after the last search from the roots.
#[derive(Clone, Debug, Default)]
pub(super) struct NetFront {
    pub(super) entries: Vec<NetEntry>,
    cut: usize,
}

/// Default number of splits that a query may make. Two bicubic patches in general position need of
/// the order of a hundred; surfaces at a constant distance along a curve need any number: see
/// [`FIRST_LOOK`].
pub(super) const SPLITS: usize = 20_000;

/// Largest number of splits that a query may make. Each makes two nodes of at most 448 numbers, and
/// 32 bits count them.
const MOST_SPLITS: usize = 1 << 22;

/// A front is built again from the roots if it has grown to more than this many times its length.
const GROWTH: usize = 4;

/// Largest number of regions tried in one search.
const TRIES: usize = 5;

/// Number of pairs after which a search counts as stuck at a local minimum, for example where
/// bodies cross. From then on a descent starts at every 32nd pair, wherever its middle is. A
/// descent costs as much as about six splits.
const IMPATIENT: usize = 128;

/// The front of the last outcome, the last witnesses, and counters.
#[derive(Clone, Debug)]
pub(super) struct SurfaceMemory {
    fingerprints: [Fingerprint; 2],
    budget: usize,
    pub(super) front: NetFront,
    /// Patches and parameters of the last witnesses.
    last: Option<([u32; 2], [f64; 4])>,
    /// Extent of the next region along the surfaces, as in [`NetSearch`].
    way: Option<f64>,
    heap: BinaryHeap<OpenNodePair>,
    pub(super) work: SurfaceWork,
}

impl Default for SurfaceMemory {
    fn default() -> Self {
        Self {
            fingerprints: [Fingerprint::default(); 2],
            budget: SPLITS,
            front: NetFront::default(),
            last: None,
            way: None,
            heap: BinaryHeap::new(),
            work: SurfaceWork::default(),
        }
    }
}

impl SurfaceMemory {
    /// Sets the number of splits that a query may make.
    pub(super) fn allow(&mut self, splits: usize) {
        self.budget = splits.min(MOST_SPLITS);
    }

    /// Drops everything except the budget.
    pub(super) fn reset(&mut self) {
        let budget = self.budget;
        *self = Self {
            budget,
            ..Self::default()
        };
    }

    /// Starts a query of two bodies, and returns whether the state belongs to them. Otherwise, or
    /// if the state `is_full`, drops it except for the budget and the counters.
    pub(super) fn recognises(&mut self, fingerprints: [Fingerprint; 2], is_full: bool) -> bool {
        let is_known = self.fingerprints == fingerprints && !is_full;
        if !is_known {
            let work = self.work;
            self.reset();
            (self.fingerprints, self.work) = (fingerprints, work);
        }
        self.work.queries += 1;
        is_known
    }

    /// Returns the front of these bodies; empty for other bodies.
    #[cfg(feature = "__internals")]
    pub(super) fn entries(&self, fingerprints: [Fingerprint; 2]) -> &[NetEntry] {
        if self.fingerprints == fingerprints {
            &self.front.entries
        } else {
            &[]
        }
    }

    pub(super) fn memory_usage(&self) -> usize {
        self.front.entries.capacity() * size_of::<NetEntry>() + self.heap.capacity() * size_of::<OpenNodePair>()
    }

    /// Returns a lower bound of the distance, and the closest points; `None` if no points were
    /// found.
    pub(super) fn search<B: NetSide, M: Meets>(
        &mut self,
        trees: &mut Trees<'_, B>,
        points: &mut M,
        goal: NetGoal,
    ) -> Option<(f64, Meeting)> {
        let mut search = NetSearch {
            trees,
            points,
            goal,
            budget: self.budget,
            pace: Pace::new(self.budget),
            heap: &mut self.heap,
            front: &mut self.front,
            best: None,
            upper: f64::INFINITY,
            hint: None,
            region: None,
            way: &mut self.way,
            patience: IMPATIENT,
            tries: TRIES,
            least: f64::INFINITY,
            work: &mut self.work,
        };
        let (patches, at) = self.last.unwrap_or(([0, 0], [0.5; 4]));
        search.offer(patches, at);
        search.best.as_ref()?;
        let entries = search.front.entries.len();
        let is_new = entries == 0 || entries > GROWTH * search.front.cut;
        if is_new {
            search.start();
        } else {
            search.renew();
        }
        let lower = search.run();
        let best = search.best;
        if is_new {
            self.front.cut = self.front.entries.len();
        }
        self.work.gaps += trees.counts.gaps;
        self.work.caps += trees.counts.caps;
        self.work.bowls += trees.counts.bowls;
        let best = best?;
        self.last = Some((best.patches, best.at));
        Some((lower, best))
    }
}
