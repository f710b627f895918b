//! Three sorted axes: sweep and prune as in the thesis.

use super::aabb::order_key;
use super::body::{Bodies, Record};
use super::change::{Changes, overlap};
use super::parallel::Threads;
use super::state::{BroadPhaseState, HasState};
use super::{BodyId, BroadPhase, Events, Settings, StoredBox};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// Sweep and prune on three sorted axes, as in the thesis; the reference implementation.
///
/// Baraff 1992 (thesis, section 2.3); Lin 1993 (thesis, section 2.4); Cohen, Lin, Manocha, Ponamgi
/// 1995 (I-COLLIDE, section 4). Both ends of every box stand in one sorted list an axis. Boxes
/// overlap exactly if their intervals do on all three axes. Between steps the lists are kept sorted
/// by insertion sort, and two boxes can begin or cease to overlap only if a lower end and an upper
/// end change places:
///
/// ```text
///    last step   a[-----]  b[----]          ... a] b[ ...
///    this step   a[-----b[--a]--]           ... b[ a] ...     this exchange gives a pair to test
/// ```
///
/// Departures:
/// 1. An exchange does not flip one of three flags a pair, which takes n^2 bits; old and new boxes
///    are compared, and a pair seen on several axes is counted once.
/// 2. Many insertions at once sort the lists again and sweep one axis, instead of inserting each by
///    exchanges.
///
/// Cost of a step: 6 n ends read and the exchanges made. At constant density the exchanges grow as
/// n^(5/3), on a flat floor faster, so prefer [`PencilSweep`](super::PencilSweep).
#[derive(Clone, Debug)]
pub struct SortedAxes {
    pub(super) state: BroadPhaseState,
    axes: [Vec<End>; 3],
}

/// An end of an interval: sort key of the coordinate, then whether the end is an upper end, then
/// the body. At equal coordinates lower ends thus come first, which makes touching intervals
/// overlap.
type End = u64;

const UPPER: u64 = 1 << 31;

fn ends(index: u32, stored: &StoredBox, axis: usize) -> [End; 2] {
    let end = |v: f32| u64::from(order_key(v)) << 32 | u64::from(index);
    [end(stored.lo[axis]), end(stored.hi[axis]) | UPPER]
}

fn index_of(end: End) -> u32 {
    (end & (UPPER - 1)) as u32
}

impl SortedAxes {
    /// Returns an empty broad phase about the origin.
    #[must_use]
    pub fn new() -> Self {
        Self::with_settings(Settings::default())
    }

    /// Returns an empty broad phase with the given settings.
    #[must_use]
    pub fn with_settings(settings: Settings) -> Self {
        Self::from_state(BroadPhaseState::new(settings.origin))
    }

    /// Returns a structure with these bodies and pairs; the lists get every body that was present
    /// in the last step.
    pub(super) fn from_state(state: BroadPhaseState) -> Self {
        let bodies = &state.bodies;
        let there = bodies
            .records
            .iter()
            .enumerate()
            .filter(|(_, r)| r.present_before(bodies.step));
        let mut axes: [Vec<End>; 3] = Default::default();
        for (i, record) in there {
            let old = record.before(bodies.step).to_box();
            (0..3).for_each(|k| axes[k].extend(ends(i as u32, &old, k)));
        }
        axes.iter_mut().for_each(|axis| axis.sort_unstable());
        Self { state, axes }
    }

    fn find_changes(&mut self) {
        let BroadPhaseState { bodies, changes, .. } = &mut self.state;
        changes.clear();
        // Every body of the lists was present in the last step; all further present bodies are new.
        let listed = self.axes[0].len() / 2;
        let coming: Vec<u32> = (bodies.marks.moved.iter().copied())
            .filter(|&i| !bodies.records[i as usize].present_before(bodies.step))
            .collect();
        for axis in &mut self.axes {
            axis.extend(coming.iter().flat_map(|&i| [u64::from(i), u64::from(i) | UPPER]));
        }
        let anew = coming.len() > 16 + listed / 8;
        for (k, axis) in self.axes.iter_mut().enumerate() {
            if anew {
                axis.iter_mut().for_each(|end| *end = renewed(*end, &bodies.records, k));
                axis.sort_unstable();
            } else {
                exchange(axis, k, bodies, changes);
            }
        }
        if anew {
            sweep_one_axis(bodies, changes);
        }
        changes.settle();
        if bodies.slots.has_leaving() {
            let stays = |end: &End| bodies.records[index_of(*end) as usize].present();
            self.axes.iter_mut().for_each(|axis| axis.retain(stays));
        }
    }
}

/// Returns the end with the coordinate of this step.
fn renewed(end: End, records: &[Record], axis: usize) -> End {
    let index = index_of(end);
    let [lower, upper] = ends(index, &records[index as usize].now().to_box(), axis);
    if end & UPPER == 0 { lower } else { upper }
}

/// Sorts one axis by insertion; every exchange of a lower with an upper end is a pair to compare.
fn exchange(axis: &mut [End], k: usize, bodies: &Bodies, changes: &mut Changes) {
    for place in 0..axis.len() {
        let end = renewed(axis[place], &bodies.records, k);
        let mut to = place;
        while to > 0 && axis[to - 1] > end {
            let other = axis[to - 1];
            axis[to] = other;
            to -= 1;
            if (other ^ end) & UPPER != 0 {
                compare(index_of(end), index_of(other), bodies, changes);
            }
        }
        axis[to] = end;
    }
}

fn compare(a: u32, b: u32, bodies: &Bodies, changes: &mut Changes) {
    let [first, second] = [a, b].map(|i| &bodies.records[i as usize]);
    let (was, is) = overlap(first, second, bodies.step);
    changes.note(a, b, was, is);
}

/// Sweeps once along the first axis, over boxes that cover old and new position.
fn sweep_one_axis(bodies: &Bodies, changes: &mut Changes) {
    let cover = |(i, record): (usize, &Record)| (record.before(bodies.step).united(&record.now()).to_box(), i as u32);
    let mut boxes: Vec<(StoredBox, u32)> = bodies.records.iter().enumerate().map(cover).collect();
    boxes.retain(|(cover, _)| cover.lo[0] <= cover.hi[0]);
    boxes.sort_unstable_by_key(|(cover, i)| (order_key(cover.lo[0]), *i));
    for (k, (cover, i)) in boxes.iter().enumerate() {
        for (_, j) in boxes[k + 1..].iter().take_while(|(next, _)| next.lo[0] <= cover.hi[0]) {
            compare(*i, *j, bodies, changes);
        }
    }
}

impl Default for SortedAxes {
    fn default() -> Self {
        Self::new()
    }
}

impl HasState for SortedAxes {
    fn state(&self) -> &BroadPhaseState {
        &self.state
    }

    fn state_mut(&mut self) -> &mut BroadPhaseState {
        &mut self.state
    }

    fn overlapping_stored(&self, asked: &StoredBox, found: &mut Vec<BodyId>) {
        self.state.overlapping_of_all(asked, found);
    }
}

impl BroadPhase for SortedAxes {
    fn step_with(&mut self, filter: &mut dyn FnMut(BodyId, BodyId) -> bool) -> Events<'_> {
        self.find_changes();
        let partners = |bodies: &Bodies, index: u32, found: &mut Vec<u32>| {
            let stored = bodies.records[index as usize].now();
            let hits = bodies
                .records
                .iter()
                .enumerate()
                .filter(|(_, r)| r.now().overlaps(&stored));
            found.extend(hits.map(|(i, _)| i as u32));
        };
        self.state.take_over(filter, partners, Threads::ONE);
        self.state.pairs.events(&self.state.bodies)
    }

    fn check(&self) -> Result<(), String> {
        self.state.check()?;
        let bodies = &self.state.bodies;
        for (k, axis) in self.axes.iter().enumerate() {
            if !axis.is_sorted_by(|a, b| a < b) {
                return Err(format!("axis {k} is out of order"));
            }
            let there = bodies.records.iter().filter(|r| r.present_before(bodies.step)).count();
            let own = |end: &End| {
                let i = index_of(*end);
                let record = bodies.records.get(i as usize).filter(|r| r.present_before(bodies.step));
                record.is_some_and(|r| ends(i, &r.before(bodies.step).to_box(), k).contains(end))
            };
            if axis.len() != 2 * there || !axis.iter().all(own) {
                return Err(format!("axis {k} does not list the {there} boxes there are"));
            }
        }
        Ok(())
    }

    fn bytes(&self) -> usize {
        self.state.bytes() + self.axes.iter().map(|a| a.capacity() * 8).sum::<usize>()
    }
}
