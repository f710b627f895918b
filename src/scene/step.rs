//! A step: the stages of the pipeline, in order.

use alloc::vec::Vec;

use super::Scene;
use super::answers::{Change, Event, PairChange, PairImpact};
use super::body::{BodyTable, box_of};
use super::motion::Sweep;
use super::narrow_phase::{StepContext, Tally, test_table};
use super::pair_engine::PairEngine;
use super::pair_table::{DetailTables, PairFlags, PairHeader, PairState, PairTables};
use super::queries::{Detail, GROUPS, Group, Table, group_pair_of};
use super::report::{Clock, Report};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::ROUND_UP;
use crate::body::polyhedron::BoxHint;
use crate::broad::{self, Aabb, PairId};
use crate::pair_tracker::Engine;

/// Ratio of the work of a query to the work of a box in the broad phase. With the default settings,
/// threads are used from 625 queries per step. A query takes at least 60 ns, a task some
/// microseconds.
#[cfg(feature = "parallel")]
const QUERY_IN_BOXES: u64 = 32;

impl Scene {
    /// Applies all calls since the last step and computes the enabled queries. Does nothing if
    /// there were no calls, or only ticks that moved no body.
    pub fn step(&mut self) -> &Report {
        let last = core::mem::take(&mut self.report).counts.queries;
        self.report.counts.steps = 1;
        self.events.clear();
        self.impacts.clear();
        if self.is_due() || self.bodies.ticks.is_pending {
            self.bodies.narrow();
        }
        if self.is_due() {
            let mut clock = Clock::start();
            let recreated = self.replan();
            #[cfg(feature = "meshes")]
            if self.changed || self.replanned != 0 {
                self.make_patches();
            }
            if self.changed || self.replanned != 0 {
                self.fixed_left_out = self.count_fixed_left_out();
            }
            self.make_boxes();
            self.report.times.boxes = clock.lap();
            let changes = self.find_pairs(recreated);
            self.report.times.pairs = clock.lap();
            let tally = self.test_pairs(changes, last);
            self.report.times.narrow_phase = clock.lap();
            self.write_events(tally);
            self.report.times.events = clock.lap();
            self.bodies.end_step();
            (self.changed, self.replanned) = (false, 0);
        } else {
            self.bodies.ticks.end_idle();
        }
        self.report.counts.pairs = self.broad.pair_count() as u64;
        self.report.counts.without_queries = self.census.count(|group| self.partners[group.index()] == 0);
        self.report.counts.fixed_left_out = self.fixed_left_out;
        &self.report
    }

    /// Returns the number of pairs of fixed bodies for which queries are enabled, but without
    /// [`fixed`](super::PairQueries::fixed). Excluded pairs do not count.
    pub(super) fn count_fixed_left_out(&self) -> u64 {
        let is_left_out = |g, h| self.table.plan(group_pair_of(g, h)).leaves_fixed_out();
        let fixed_group = |i: u32| {
            self.bodies.solids[i as usize]
                .as_ref()
                .filter(|s| s.fixed)
                .map(|s| s.group)
        };
        let is_excluded = |&(a, b): &(u32, u32)| {
            let groups = fixed_group(a).zip(fixed_group(b));
            groups.is_some_and(|(g, h)| is_left_out(g, h))
        };
        self.census.fixed_pairs(is_left_out) - self.excluded.iter().filter(is_excluded).count() as u64
    }

    /// Returns whether a call since the last step, other than ticks, changed anything that a step
    /// reads.
    pub(super) fn is_due(&self) -> bool {
        self.changed || self.replanned != 0 || !self.bodies.due.is_empty()
    }

    /// Updates the bodies of groups whose queries changed: the groups to pair with, and the growth
    /// of the boxes. Returns true if some proxies had to be recreated.
    fn replan(&mut self) -> bool {
        if self.replanned == 0 {
            return false;
        }
        self.growths = core::array::from_fn(|g| self.table.growth(group(g)));
        self.partners = core::array::from_fn(|g| self.table.partners(group(g)));
        let mut recreated = false;
        for i in 0..self.bodies.solids.len() {
            let Some(solid) = self.bodies.solids[i].as_ref().filter(|_| self.bodies.lives(i)) else {
                continue;
            };
            if self.replanned & 1 << solid.group.number() == 0 {
                continue;
            }
            if solid.boxed == (self.growths[solid.group.index()] < f64::INFINITY) {
                let groups = self.groups_of(solid.group);
                // The id of a living body is never stale.
                let _ = self.broad.set_groups(self.bodies.proxies[i], groups);
                self.bodies.mark_due(i);
            } else {
                recreated |= self.recreate_proxy(i);
            }
        }
        recreated
    }

    /// Removes a body from the broad phase and inserts the body again, with a box or unbounded.
    fn recreate_proxy(&mut self, i: usize) -> bool {
        let Some(mut solid) = self.bodies.solids[i].take() else {
            return false;
        };
        // A broad phase can hold one body more than a scene.
        let proxy = self.create_proxy(&mut solid, &self.bodies.poses[i].clone(), &mut BoxHint::default());
        if let Ok(proxy) = proxy {
            let _ = self.broad.remove(self.bodies.proxies[i]);
            self.bodies.set_proxy(i as u32, proxy);
        }
        self.bodies.solids[i] = Some(solid);
        true
    }

    /// Computes the boxes that are due and passes them to the broad phase. Bodies without any query
    /// need no box; those that move are listed, for ray casts.
    fn make_boxes(&mut self) {
        let Self { bodies, batch, .. } = self;
        batch.clear();
        if !bodies.due.is_sorted() {
            bodies.due.sort_unstable();
        }
        let is_without = |group: Group| self.partners[group.index()] == 0;
        if !bodies.stale.is_empty() || self.census.count(is_without) > 0 {
            bodies.list_stale(&self.partners);
        }
        let mut hints = core::mem::take(&mut bodies.hints);
        let boxes = Boxes {
            bodies,
            partners: &self.partners,
            growths: &self.growths,
            swept_groups: self.table.impact_groups(),
        };
        #[cfg(feature = "parallel")]
        if bodies.due.len() >= self.settings.parallel_from.max(1) {
            super::parallel::make_boxes(&boxes, &mut hints, &bodies.due, batch);
        } else {
            boxes.make(0, &mut hints, &bodies.due, batch);
        }
        #[cfg(not(feature = "parallel"))]
        boxes.make(0, &mut hints, &bodies.due, batch);
        bodies.hints = hints;
        self.report.counts.boxes = batch.len() as u64;
        // Boxes of checked shapes at checked poses are valid, and the ids are of living bodies.
        let taken = self.broad.set_boxes(batch);
        debug_assert_eq!(taken, Ok(()));
    }

    /// Lets the broad phase find new and ended pairs, and updates the rows of the tables. If a
    /// proxy was recreated, the pairs of its body end and start in one step and keep their state.
    fn find_pairs(&mut self, recreated: bool) -> Vec<PairChange> {
        let (bodies, pair_tables, excluded) = (&self.bodies, &mut self.pair_tables, &self.excluded);
        let body_of = |proxy: broad::BodyId| bodies.body_of_proxy[proxy.index as usize];
        let mut filter = |x, y| !excluded.contains(body_of(x), body_of(y));
        let events = self.broad.step_with(&mut filter);
        let mut changes = Vec::new();
        let mut removed = Vec::new();
        for pair in events.ended {
            let members = bodies_of(bodies, pair);
            let pair_state = pair_tables.remove(pair.id.slot);
            if recreated {
                removed.push((members, pair.id, pair_state));
            } else {
                end(&pair_state, members, pair.id, &mut changes);
            }
        }
        removed.sort_unstable_by_key(|(members, ..)| *members);
        for pair in events.began {
            let members = bodies_of(bodies, pair);
            let found = removed.binary_search_by_key(&members, |(members, ..)| *members);
            let pair_state = found.map_or_else(|_| PairState::default(), |k| core::mem::take(&mut removed[k].2));
            begin(
                pair_tables,
                &self.table,
                bodies,
                members,
                pair.id,
                pair_state,
                &mut changes,
            );
        }
        for (members, id, pair_state) in removed {
            end(&pair_state, members, id, &mut changes);
        }
        let counts = &mut self.report.counts;
        (counts.began, counts.ended) = (events.began.len() as u64, events.ended.len() as u64);
        counts.swaps = self.broad.swaps();
        if self.replanned != 0 {
            self.move_pairs(&mut changes);
        }
        self.pair_tables.trim();
        changes
    }

    /// Moves pairs whose queries changed to the table of their new level of detail.
    fn move_pairs(&mut self, changes: &mut Vec<PairChange>) {
        let (bodies, pair_tables) = (&self.bodies, &mut self.pair_tables);
        let replanned = |i: u32| bodies.group(i).is_some_and(|g| self.replanned & 1 << g.number() != 0);
        for pair in self.broad.pairs() {
            let members = bodies_of(bodies, &pair);
            if members.into_iter().any(replanned) {
                let pair_state = pair_tables.remove(pair.id.slot);
                begin(pair_tables, &self.table, bodies, members, pair.id, pair_state, changes);
            }
        }
    }

    /// The narrow phase: budget, balls, tracker. `last` is the number of queries of the last step,
    /// an estimate for this step if bodies continue to move as before.
    fn test_pairs(&mut self, changes: Vec<PairChange>, last: u64) -> Tally {
        let context = StepContext {
            bodies: &self.bodies,
            table: &self.table,
            budget: self.budget,
            schedule: self.schedule,
        };
        let mut tally = Tally {
            counts: self.report.counts,
            changes,
            impacts: Vec::new(),
            workspace: core::mem::take(&mut self.workspace),
        };
        #[cfg(feature = "parallel")]
        let is_parallel = is_shared(last.max(self.report.counts.began), self.settings.parallel_from);
        #[cfg(not(feature = "parallel"))]
        let (is_parallel, _) = (false, last);
        test_tables(&mut self.pair_tables.polyhedra, &context, &mut tally, is_parallel);
        test_tables(&mut self.pair_tables.mixed, &context, &mut tally, is_parallel);
        self.report.counts = tally.counts;
        self.workspace = core::mem::take(&mut tally.workspace);
        tally
    }

    /// Sorts changes and impacts, and writes them with ids.
    fn write_events(&mut self, mut tally: Tally) {
        tally.changes.sort_unstable_by_key(|h| (h.pair, h.change));
        let bodies = &self.bodies;
        self.events.extend(tally.changes.iter().map(|h| Event {
            a: bodies.id(h.pair[0]),
            b: bodies.id(h.pair[1]),
            pair: h.id,
            change: h.change,
        }));
        self.impacts.append(&mut tally.impacts);
        let order = |x: &PairImpact, y: &PairImpact| {
            let order = x.safe().total_cmp(&y.safe()).then((x.a, x.b).cmp(&(y.a, y.b)));
            order.then(x.distance.total_cmp(&y.distance))
        };
        self.impacts.sort_unstable_by(order);
        self.report.counts.events = self.events.len() as u64;
        self.report.counts.impacts = self.impacts.len() as u64;
    }
}

/// Returns whether a step should use threads for the queries expected. The scene uses threads for
/// boxes from `bodies` bodies.
#[cfg(feature = "parallel")]
fn is_shared(queries: u64, bodies: usize) -> bool {
    queries.saturating_mul(QUERY_IN_BOXES) >= bodies as u64
}

/// Tests the pairs of all tables of one type of tracker.
fn test_tables<T: PairEngine>(
    tables: &mut DetailTables<T>,
    context: &StepContext<'_>,
    tally: &mut Tally,
    is_parallel: bool,
) {
    #[cfg(feature = "parallel")]
    if is_parallel {
        super::parallel::test_table(&mut tables.predicates, context, tally);
        super::parallel::test_table(&mut tables.distances, context, tally);
        super::parallel::test_table(&mut tables.features, context, tally);
        super::parallel::test_table(&mut tables.contacts, context, tally);
        return;
    }
    debug_assert!(!is_parallel, "threads need the feature `parallel`");
    test_table(&mut tables.predicates, context, tally);
    test_table(&mut tables.distances, context, tally);
    test_table(&mut tables.features, context, tally);
    test_table(&mut tables.contacts, context, tally);
}

pub(super) fn group(number: usize) -> Group {
    Group::new(number as u8).unwrap_or_default()
}

/// Returns the indices of the two bodies of a pair, the lower index first.
pub(super) fn bodies_of(bodies: &BodyTable, pair: &broad::Pair) -> [u32; 2] {
    let [a, b] = [pair.a, pair.b].each(|id| bodies.body_of_proxy[id.index as usize]);
    [a.min(b), a.max(b)]
}

/// Ends a pair, and with it every state that started.
fn end(pair_state: &PairState, pair: [u32; 2], id: PairId, changes: &mut Vec<PairChange>) {
    let ends = [
        (pair_state.state.within, Change::LeftWithin),
        (pair_state.state.overlaps, Change::OverlapEnded),
        (pair_state.box_event_sent, Change::BoxesParted),
    ];
    let sent = ends.into_iter().filter(|(was, _)| *was);
    changes.extend(sent.map(|(_, change)| PairChange { id, pair, change }));
}

/// Starts a pair, or moves a pair to another table.
fn begin(
    pair_tables: &mut PairTables,
    table: &Table,
    bodies: &BodyTable,
    [a, b]: [u32; 2],
    id: PairId,
    pair_state: PairState,
    changes: &mut Vec<PairChange>,
) {
    let (Some(g), Some(h)) = (bodies.group(a), bodies.group(b)) else {
        return;
    };
    let groups = group_pair_of(g, h);
    let plan = table.plan(groups);
    if plan.boxes && !pair_state.box_event_sent {
        changes.push(PairChange {
            id,
            pair: [a, b],
            change: Change::BoxesMet,
        });
    }
    let header = PairHeader {
        a,
        b,
        pair: id,
        groups,
        state: PairFlags::default(),
        wake: 0.0,
    };
    let tracker = pair_state.tracker.or_else(|| {
        let shape = |i: u32| bodies.solids[i as usize].as_ref().map(|solid| &solid.shape);
        if plan.detail > Detail::Boxes {
            Some(Engine::new([shape(a)?.into(), shape(b)?.into()]).into())
        } else {
            None
        }
    });
    pair_tables.insert(plan, header, PairState { tracker, ..pair_state });
}

/// Read-only input for computing boxes.
pub(super) struct Boxes<'a> {
    bodies: &'a BodyTable,
    /// By group: the groups to pair with as bits, and the growth of the boxes.
    partners: &'a [u32; GROUPS],
    growths: &'a [f64; GROUPS],
    /// Groups whose boxes contain swept motions, as bits.
    swept_groups: u32,
}

impl Boxes<'_> {
    /// Computes the boxes of `due` bodies; `hints` are those of a run of bodies that starts at
    /// `first`.
    pub(super) fn make(&self, first: u32, hints: &mut [BoxHint], due: &[u32], batch: &mut Vec<(broad::BodyId, Aabb)>) {
        for &index in due {
            let i = index as usize;
            let Some(solid) = self.bodies.solids[i]
                .as_ref()
                .filter(|s| s.boxed && self.bodies.lives(i))
            else {
                continue;
            };
            let group = solid.group.index();
            if self.partners[group] != 0 {
                let hint = &mut hints[(index - first) as usize];
                let growth = self.growths[group];
                let sweep = self.bodies.sweeps.get(i).and_then(Option::as_ref);
                let sweep = sweep.filter(|_| self.swept_groups & 1 << group != 0);
                let swept = sweep.and_then(|sweep| swept_box(self.bodies, i, sweep, growth, hint));
                let aabb = swept.unwrap_or_else(|| box_of(&solid.shape, &self.bodies.poses[i], growth, hint));
                batch.push((self.bodies.proxies[i], aabb));
            }
        }
    }
}

/// Returns the box of a body over the tick of the step being prepared and at the pose after it,
/// grown on every side.
fn swept_box(bodies: &BodyTable, i: usize, sweep: &Sweep, growth: f64, hint: &mut BoxHint) -> Option<Aabb> {
    let solid = bodies.solids[i].as_ref()?;
    let time = bodies.ticks.length.abs();
    let poses = [sweep.from, sweep.velocity.applied(&sweep.from, time), bodies.poses[i]];
    let [first, second, third] = poses.each(|pose| solid.shape.aabb_at(&pose, hint));
    let low = first.0.smaller(second.0).smaller(third.0);
    let high = first.1.larger(second.1).larger(third.1);
    let growth = growth + sweep.bulge(solid.reach(), time);
    Some(Aabb::new(low, high).grown(growth * ROUND_UP))
}
