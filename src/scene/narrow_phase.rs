//! Narrow phase of one pair in a step: the cheapest test first, and the tracker if no cheaper test
//! decides.

use alloc::vec::Vec;

use super::answers::StoredAnswer;
use super::answers::{Change, PairChange, PairImpact};
use super::body::BodyTable;
use super::body::least_distance;
use super::budget::{slack, wake};
use super::pair_engine::{ContactAsk, Contacted, PairEngine};
use super::pair_table::{PairFlags, PairHeader, PairTable};
use super::queries::{Detail, NEVER, PairPlan, Table};
use super::report::StepWork;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::pose::RelativePose;
use crate::convex::tracker::Workspace;
use crate::pair::outcome::{ContactState, Outcome};

/// The data of a scene that the narrow phase reads.
pub(super) struct StepContext<'a> {
    pub(super) bodies: &'a BodyTable,
    pub(super) table: &'a Table,
    pub(super) budget: bool,
    /// Whether pairs may sleep until a tick.
    pub(super) schedule: bool,
}

/// Counts and changes of the narrow phase, in addition to the results.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) counts: StepWork,
    pub(super) changes: Vec<PairChange>,
    pub(super) impacts: Vec<PairImpact>,
    /// Working memory that the trackers borrow one after the other.
    pub(super) workspace: Workspace,
}

/// Tests all pairs of a table.
pub(super) fn test_table<T: PairEngine, A: StoredAnswer>(
    pair_table: &mut PairTable<T, A>,
    context: &StepContext<'_>,
    tally: &mut Tally,
) {
    test_run(
        &mut pair_table.headers,
        &mut pair_table.trackers,
        &mut pair_table.answers,
        context,
        tally,
    );
}

/// Tests the pairs of a run of rows.
pub(super) fn test_run<T: PairEngine, A: StoredAnswer>(
    headers: &mut [PairHeader],
    trackers: &mut [T],
    answers: &mut [A],
    context: &StepContext<'_>,
    tally: &mut Tally,
) {
    tally.counts.active += headers.len() as u64;
    for ((header, tracker), answer) in headers.iter_mut().zip(trackers).zip(answers) {
        if context.is_answered(header, &mut tally.counts) {
            continue;
        }
        let before = header.state;
        context.test(header, tracker, answer, tally);
        note_changes(before, header, &mut tally.changes);
    }
}

impl StepContext<'_> {
    pub(super) fn sum(&self, header: &PairHeader) -> f64 {
        let travels = &self.bodies.travels;
        travels[header.a as usize].odometer + travels[header.b as usize].odometer
    }

    /// Returns whether the last result remains valid: neither body moved, or the budget is not used
    /// up.
    #[inline]
    fn is_answered(&self, header: &mut PairHeader, counts: &mut StepWork) -> bool {
        let [a, b] = [header.a, header.b].each(|i| &self.bodies.travels[i as usize]);
        let step = self.bodies.step;
        if !header.state.known {
            return false;
        }
        if header.state.sleeps {
            if self.is_asleep(header) {
                counts.slept += 1;
                return true;
            }
            (header.state.sleeps, header.wake) = (false, 0.0);
        }
        if a.moved != step && b.moved != step {
            counts.resting += 1;
            return true;
        }
        // With NaN the pair is tested.
        if self.budget && a.odometer + b.odometer < header.wake {
            counts.skipped += 1;
            return true;
        }
        false
    }

    /// Returns whether two balls are so far apart that no enabled query can apply.
    #[inline]
    fn is_clear(&self, header: &mut PairHeader, reach: f64, counts: &mut StepWork) -> bool {
        let [a, b] = [header.a, header.b].each(|i| &self.bodies.balls[i as usize]);
        let apart = least_distance(a, b);
        if !(apart > reach) {
            return false;
        }
        counts.balls += 1;
        header.state = PairFlags {
            known: true,
            ..PairFlags::default()
        };
        header.wake = wake(self.sum(header), apart - reach);
        true
    }

    #[inline]
    fn test<T: PairEngine, A: StoredAnswer>(
        &self,
        header: &mut PairHeader,
        tracker: &mut T,
        answer: &mut A,
        tally: &mut Tally,
    ) {
        let plan = self.table.plan(header.groups);
        // Balls before geometries, so that a far pair reads no geometry. A swept motion must come
        // before its balls.
        if !plan.has_impacts() && self.is_clear(header, plan.reach, &mut tally.counts) {
            return drop_contacts(tracker, answer);
        }
        let (a, b) = (header.a as usize, header.b as usize);
        let (Some(solid_a), Some(solid_b)) = (&self.bodies.solids[a], &self.bodies.solids[b]) else {
            return;
        };
        let Some(shapes) = T::shapes(&solid_a.shape, &solid_b.shape) else {
            return;
        };
        if plan.has_impacts()
            && (self.sweep_pair(header, tracker, shapes, plan, tally)
                || self.is_clear(header, plan.reach, &mut tally.counts))
        {
            return drop_contacts(tracker, answer);
        }
        // Poses within the range of a scene always have a relative pose.
        let Ok(pose) = RelativePose::new(&self.bodies.poses[a], &self.bodies.poses[b]) else {
            return;
        };
        tracker.exchange(&mut tally.workspace);
        let outcome = tracker.measure(shapes, &pose, plan.until);
        tracker.exchange(&mut tally.workspace);
        let counts = &mut tally.counts;
        counts.note(&outcome, tracker.facets());
        let mut within = |t: f64| t != NEVER && tracker.decides_within(shapes, &pose, &outcome, t);
        header.state = PairFlags {
            known: true,
            overlaps: plan.overlap && within(0.0),
            within: within(plan.within),
            measured: within(plan.range),
            sleeps: false,
        };
        let is_near = plan.manifold.as_ref().is_some_and(|options| within(options.prediction));
        counts.overlaps += u64::from(plan.overlap);
        counts.withins += u64::from(plan.within != NEVER);
        if header.state.measured {
            counts.distances += 1;
            counts.features += u64::from(plan.detail >= Detail::Features);
            answer.store(&outcome);
            header.wake = 0.0;
        } else if !self.sleep(header, tracker, shapes, plan, &outcome, counts) {
            header.wake = wake(self.sum(header), slack_of(plan, &outcome));
        }
        if let (Some(stored), Some(options)) = (answer.manifold(), &plan.manifold) {
            if is_near {
                let ask = ContactAsk {
                    outcome: &outcome,
                    options,
                    #[cfg(feature = "meshes")]
                    patches: [solid_a.patches.as_ref(), solid_b.patches.as_ref()],
                };
                let done = tracker.update_manifold(shapes, &pose, ask, stored);
                counts.manifolds += u64::from(done != Contacted::Nothing);
                counts.renewed += u64::from(done == Contacted::Renewed);
            } else {
                drop_contacts(tracker, answer);
            }
        }
    }
}

/// Drops the contacts of a pair that is beyond the prediction, if contacts are enabled.
fn drop_contacts<T: PairEngine, A: StoredAnswer>(tracker: &mut T, answer: &mut A) {
    if let Some(stored) = answer.manifold() {
        *stored = None;
        tracker.drop_contacts();
    }
}

/// Returns how much the distance of a pair without a measured distance may change before a result
/// changes.
pub(super) fn slack_of(plan: &PairPlan, outcome: &Outcome) -> f64 {
    // The upper bound of an overlap without depth is 0.
    let upper = if outcome.state == ContactState::Overlapping {
        0.0
    } else {
        outcome.upper
    };
    let contact = if plan.overlap { 0.0 } else { NEVER };
    let thresholds = [contact, plan.within, plan.range];
    let called = thresholds.into_iter().filter(|t| *t != NEVER);
    let called = called.chain(plan.impacts.iter().flatten().map(|impact| impact.0));
    called.fold(f64::INFINITY, |s, t| s.smaller(slack(t, outcome.lower, upper)))
}

fn note_changes(before: PairFlags, header: &PairHeader, changes: &mut Vec<PairChange>) {
    let now = header.state;
    let mut note = |was: bool, is: bool, began: Change, ended: Change| {
        if was != is {
            changes.push(PairChange {
                id: header.pair,
                pair: [header.a, header.b],
                change: if is { began } else { ended },
            });
        }
    };
    note(
        before.overlaps,
        now.overlaps,
        Change::OverlapBegan,
        Change::OverlapEnded,
    );
    note(before.within, now.within, Change::CameWithin, Change::LeftWithin);
}
