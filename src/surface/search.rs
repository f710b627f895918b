//! Best-first search down two trees, the front that it leaves, and what the trackers of all pairs
//! with a surface keep of it.
//!
//! The open pair with the least lower bound is split, until no open pair is as close as the goal.
//! Pairs that are far enough go to the front: together they are the proof. The front of the last
//! answer ([`NetFront`]) holds pairs of nodes under which every pair of patches lies, each with the
//! direction that proved it far enough.
//!
//! As [`nonconvex::front`](crate::compound), in double precision: let Y, the points below a node
//! of B, lie in the ball of radius rho about c in B's frame, and X, the points below a node of A,
//! be at least g below Y along n in A's frame, at the pose (R0, t0). At the pose (R, t) the gap is
//! at least
//!
//! `g + n . (R c + t) - n . (R0 c + t0) - rho |R^T n - R0^T n|`,
//!
//! whatever way led there. With the bodies exchanged if the node of A is the smaller. So a claim is
//! never out of date; after a long way it merely proves nothing.
//!
//! The course of a query is that of [`SurfaceMemory`].

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

/// Splits after which a search first looks how far apart its bounds are; at twice as many it asks
/// whether they approach each other fast enough for its budget. Of 2,500 random pairs one in a
/// thousand needs more than 1,848 splits.
const FIRST_LOOK: usize = 1_024;

/// A search goes on if it is expected to need at most so many times its budget: the speed of its
/// bounds is seen only roughly. Pairs that are level along a curve need some twenty times the usual
/// budget for an interval of 1e-9.
const LENIENT: usize = 4;

/// The surroundings of the closest points are tried to be proven at once where a pair of nodes is
/// at most so many times as large. Not measured.
const SMALL: f64 = 4.0;

/// How far the first region reaches, as a part of the radius of the smaller surface. Not measured.
const BEGINNING: f64 = 0.25;

/// A region that was proven is this much larger in the next frame. Not measured.
const GROWING: f64 = 1.05;

/// A region that was not proven is tried so much smaller. Not measured.
const SHRINKING: f64 = 0.5;

/// See [`IMPATIENT`].
const PATIENCE: usize = 32;

/// A pair that may be closer than the goal, ranked by the gap.
type OpenNodePair = Ranked<NetPair, Gap>;

/// What a search is for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NetGoal {
    /// An interval of the distance no wider than this.
    Width(f64),
    /// An interval no wider than this part of the distance.
    Part(f64),
    /// Whether the distance is at most this.
    Within(f64),
}

impl NetGoal {
    /// Returns whether bounds are as close as asked for.
    pub(super) fn is_converged(self, lower: f64, upper: f64) -> bool {
        match self {
            Self::Width(width) => upper - lower <= width,
            Self::Part(part) => upper - lower <= part * upper,
            Self::Within(d) => upper <= d || lower > d,
        }
    }
}

/// How fast the bounds of a search approach each other.
///
/// The number of splits grows with the logarithm of the narrowness where the closest points are
/// isolated, but with a power of it where two surfaces are equally far along a curve or over an
/// area. There most queries could use up any budget without reaching their goal.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Splits that a query may make.
    allowed: usize,
    /// Pairs of patches or parts of them split so far: those of groups are finite in number.
    splits: usize,
    /// Splits at the last look, and how far apart the bounds were.
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

    /// Returns whether bounds that are now so far `apart` will be as close as `needed` within some
    /// times the splits allowed, if each doubling of the splits brings them as much closer as the
    /// last one. Looks after [`FIRST_LOOK`] splits, twice as many, and so on; true between looks.
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

/// A search under way.
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
    /// A direction from A to B at the best meeting.
    hint: Option<Vector3<f64>>,
    /// The surroundings of the best meeting, proven.
    region: Option<Region>,
    /// How far a region reaches along the surfaces; `None` if the search has found none.
    way: &'a mut Option<f64>,
    /// Pairs to be split until two points are looked for below one of them, whatever its middle.
    patience: usize,
    /// Regions that may still be tried.
    tries: usize,
    /// The least lower bound of all pairs closed so far.
    least: f64,
    work: &'a mut SurfaceWork,
}

impl<B: NetSide, M: Meets> NetSearch<'_, '_, B, M> {
    /// Pairs whose distance is at least this need no further look.
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

    /// Takes two points if they are closer than the best.
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

    /// Opens the pair of roots.
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

    /// Proves the front again at the new pose; entries that are not proven are bounded anew, or
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

    /// Puts a pair to the front or to the open ones.
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
            // Larger than what could be proven at once.
            return self.trees.along(pair, along);
        }
        let mut gap = self.trees.bound(pair, along, self.hint.as_ref(), level);
        if gap.gap < level {
            self.raise(pair, level, &mut gap);
        }
        // Points of both parts may be known to be no farther apart than the level.
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
    /// point of B. The distance of a point from a convex body is convex, and this direction its
    /// gradient: the gap falls short by terms of second order alone.
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
    /// asked for.
    fn target(&self) -> f64 {
        self.level() + 4.0 * UNIT * self.trees.frame.size
    }

    /// Returns the gap of a pair in the region.
    fn covered(&self, pair: NetPair, along: &Vector3<f64>) -> Option<Gap> {
        let region = self.region.as_ref()?;
        let (x, y) = (self.trees.a.node(pair[0]), self.trees.b.node(pair[1]));
        region.covers(x, y).then_some(Gap {
            n: *along,
            gap: region.target,
            is_plane: false,
        })
    }

    /// Returns whether a pair is about as small as a region to be tried.
    fn is_small(&self, pair: NetPair) -> bool {
        let (x, y) = (self.trees.a.node(pair[0]), self.trees.b.node(pair[1]));
        let size = if y.can_split() {
            x.radius.larger(y.radius)
        } else {
            x.radius
        };
        size <= SMALL * self.first_way()
    }

    /// Returns how far a region to be tried first reaches.
    fn first_way(&self) -> f64 {
        self.way.unwrap_or_else(|| {
            let radius = |node: &Node| if node.can_split() { node.radius } else { f64::INFINITY };
            BEGINNING * radius(self.trees.a.node(0)).smaller(radius(self.trees.b.node(0)))
        })
    }

    /// Proves the surroundings of the best meeting, as large as may be.
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
        // Not tried again until a search begins at the roots.
        *self.way = Some(0.0);
        false
    }

    /// Returns whether the best points lie below a pair.
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

    /// Searches until the goal is reached, or the budget is used up; returns the least lower bound
    /// of all pairs, zero at least.
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

    /// Returns whether the search may reach its goal within its budget, as far as its pace tells;
    /// `open` is the pair with the least bound. Beside a convex body, where bounds come close late
    /// at the rims of cylinders and cones, always.
    fn is_worth(&mut self, open: &OpenNodePair) -> bool {
        let needed = self.upper - self.level();
        B::IS_CONVEX || self.pace.is_enough(self.upper - open.rank, needed)
    }

    /// Splits the larger node of a pair and sorts the two new pairs; false if nothing can be split.
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

    /// Looks for closer points below a pair, unless the best ones lie there.
    fn improve(&mut self, open: &OpenNodePair) {
        let (x, y) = (self.trees.a.node(open.key[0]), self.trees.b.node(open.key[1]));
        if x.is_group() || y.is_group() || self.is_at_best(open.key) {
            return;
        }
        let patches = [x.patch(), y.patch()];
        let ([u, v], [s, t]) = (x.middle(), y.middle());
        // Bodies that cross have no bound to follow: parts that lie in each other have any.
        self.patience -= 1;
        if self.patience == 0 {
            self.patience = PATIENCE;
            return self.offer(patches, [u, v, s, t]);
        }
        let frame = self.trees.frame;
        // A body that is not split is as large as ever, however near its points are.
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

/// A pair of nodes with the claim of its gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetEntry {
    pub(super) pair: NetPair,
    /// In A's frame.
    n: Vector3<f64>,
    /// In B's frame.
    m: Vector3<f64>,
    /// Middle of the ball, in the frame of its body.
    centre: Vector3<f64>,
    radius: f64,
    base: f64,
    /// Whether the ball is that of A's node.
    is_of_a: bool,
    /// Whether the gap was proven by planes: else nothing is claimed at another pose.
    is_plane: bool,
}

impl NetEntry {
    /// Returns the entry of a pair with a gap at this pose.
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

    /// Returns the height of the ball's middle as seen from the other body.
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

/// The entries, and their number when the front was cut.
#[derive(Clone, Debug, Default)]
pub(super) struct NetFront {
    pub(super) entries: Vec<NetEntry>,
    cut: usize,
}

/// Splits of nodes that one query may make by default. Two bicubic patches in general position need
/// some hundred, surfaces that are level along a curve any number: see [`FIRST_LOOK`].
pub(super) const SPLITS: usize = 20_000;

/// Splits that a query may be allowed: two nodes each of 448 numbers at most are counted in 32
/// bits.
const MOST_SPLITS: usize = 1 << 22;

/// A front is cut anew if it has grown to so many times its length. Not measured.
const GROWTH: usize = 4;

/// Regions tried in one search. Not measured.
const TRIES: usize = 5;

/// After so many pairs split the search is taken to be stuck at a local minimum, as where bodies
/// cross: then two points are looked for below every 32nd pair, wherever its middle is. A search
/// for points costs as much as some six splits.
const IMPATIENT: usize = 128;

/// The front of the last answer, the last witnesses, and counters.
#[derive(Clone, Debug)]
pub(super) struct SurfaceMemory {
    fingerprints: [Fingerprint; 2],
    budget: usize,
    pub(super) front: NetFront,
    /// Patches and parameters of the last witnesses.
    last: Option<([u32; 2], [f64; 4])>,
    /// How far the region of the last search reached.
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

    /// Forgets everything but the budget.
    pub(super) fn reset(&mut self) {
        let budget = self.budget;
        *self = Self {
            budget,
            ..Self::default()
        };
    }

    /// Begins a query of two bodies: returns whether the state is theirs; if not, or if it
    /// `is_full`, forgets it.
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

    /// Returns the front of these bodies, empty for others.
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

    /// Returns a lower bound of the distance and the closest points; `None` if no points were
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
