//! Bodies and pairs: the state of a broad phase apart from its sorted columns, and the check of
//! both.

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::broad::body::{Bodies, UNBOUNDED};
use crate::broad::change::{Changes, pair_key};
use crate::broad::pairs::PairSlots;
use crate::broad::parallel::Threads;
use crate::broad::{Aabb, BodyId, BodyOptions, BroadPhaseError, Pair, PairId, StoredBox, SweepAndPrune};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::Point3;

/// Bodies, pairs and the changes of the current step.
#[derive(Clone, Debug)]
pub(crate) struct BroadPhaseState {
    pub(super) bodies: Bodies,
    pub(super) pairs: PairSlots,
    pub(super) changes: Changes,
}

/// A body, and the distance between its box and the query box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearest {
    /// The body.
    pub body: BodyId,
    /// Distance of the boxes; 0 if they overlap.
    pub distance: f64,
}

impl BroadPhaseState {
    pub(super) fn new(origin: Point3<f64>) -> Self {
        Self {
            bodies: Bodies::new(origin),
            pairs: PairSlots::default(),
            changes: Changes::default(),
        }
    }

    pub(super) fn insert(
        &mut self,
        aabb: &Aabb,
        body: BodyOptions,
        unbounded: bool,
    ) -> Result<BodyId, BroadPhaseError> {
        if let Some(axis) = self.bodies.origin.iter().position(|x| !x.is_finite()) {
            return Err(BroadPhaseError::Origin { axis });
        }
        let flags = if unbounded { UNBOUNDED } else { 0 };
        let stored = self.bodies.stored(aabb, flags)?;
        self.bodies.insert(stored, body, flags)
    }

    /// Applies the changes to pairs and events, and tests groups and filter again for the pairs of
    /// regrouped bodies. `partners` lists the bodies whose new boxes overlap the box of the body at
    /// an index. The result does not depend on the number of threads.
    pub(super) fn take_over(
        &mut self,
        filter: &mut dyn FnMut(BodyId, BodyId) -> bool,
        mut partners: impl FnMut(&Bodies, u32, &mut Vec<u32>),
        threads: Threads,
    ) {
        let Self { bodies, pairs, changes } = self;
        changes.settle();
        pairs.apply(changes, bodies, filter, threads);
        let mut allowed = |a: u32, b: u32| bodies.may_pair(a, b) && filter(bodies.id(a), bodies.id(b));
        let mut found = Vec::new();
        for &index in &bodies.regrouped {
            if !bodies.lives(index) {
                continue;
            }
            found.clear();
            partners(bodies, index, &mut found);
            found.sort_unstable(); // slots are given out in this order
            for &other in found.iter().filter(|other| **other != index) {
                let key = pair_key(index, other);
                let (low, high) = super::change::pair_of(key);
                if allowed(low, high) {
                    pairs.begin(key, bodies)
                } else {
                    pairs.end(key, bodies)
                }
            }
        }
        if !bodies.regrouped.is_empty() {
            pairs.sort_events();
        }
        bodies.end_step();
    }

    pub(super) fn pair(&self, a: BodyId, b: BodyId) -> Option<Pair> {
        let id = self.pairs.get(a.index, b.index)?;
        self.pair_of(id)
            .filter(|p| (p.a, p.b) == (a, b) || (p.a, p.b) == (b, a))
    }

    pub(super) fn pair_of(&self, id: PairId) -> Option<Pair> {
        let (a, b) = self.pairs.members(id)?;
        Some(Pair {
            id,
            a: self.bodies.id(a),
            b: self.bodies.id(b),
        })
    }

    /// Returns the stored form of a query box.
    pub(super) fn asked(&self, aabb: &Aabb) -> Result<StoredBox, BroadPhaseError> {
        self.bodies.stored(aabb, UNBOUNDED)
    }

    /// Returns the bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let changes = self.changes.began.capacity() + self.changes.ended.capacity();
        self.bodies.bytes() + self.pairs.bytes() + changes * 8
    }
}

/// Queries larger and larger boxes until enough bodies are found within the distance of the box.
pub(super) fn nearest(
    broad: &SweepAndPrune,
    aabb: &Aabb,
    count: usize,
    farthest: f64,
) -> Result<Vec<Nearest>, BroadPhaseError> {
    let bodies = &broad.state.bodies;
    let asked = bodies.stored(aabb, 0)?;
    let back = 3 - bodies.grid.axis;
    let mut out: Vec<Nearest> = Vec::new();
    if count == 0 || farthest.is_nan() || farthest < 0.0 {
        return Ok(out);
    }
    let mut found = Vec::new();
    let mut reach = f64::from(bodies.grid.width).smaller(farthest);
    loop {
        found.clear();
        broad.overlapping_stored(&asked.grown(reach), &mut found);
        let distance = |id: &BodyId| {
            let stored = bodies.records[id.index as usize].before(bodies.step).to_box();
            Nearest {
                body: *id,
                // The axes are in one order for any swept axis, so the sum is equal to the last
                // bit.
                distance: sqrt(stored.rotated(back).distance_squared(&asked.rotated(back))),
            }
        };
        out.clear();
        out.extend(found.iter().map(distance).filter(|n| n.distance <= reach));
        // Beyond the clamp of stored boxes a larger distance finds nothing new.
        if out.len() >= count || reach >= farthest || reach > 1e39 {
            break;
        }
        reach = (reach * 2.0).smaller(farthest);
    }
    sort(out.as_mut_slice(), |a, b| {
        a.distance.total_cmp(&b.distance).then(a.body.cmp(&b.body))
    });
    out.truncate(count);
    Ok(out)
}

impl BroadPhaseState {
    /// Returns the first contradiction among bodies and pairs. Between steps only.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { bodies, pairs, .. } = self;
        check_bodies(bodies)?;
        pairs.check()?;
        for pair in pairs.iter(bodies) {
            let [a, b] = [pair.a, pair.b].each(|id| bodies.records[id.index as usize].before(bodies.step));
            if !a.overlaps(&b) {
                return Err(format!(
                    "{} is of boxes that do not overlap: {} and {}",
                    pair.id, pair.a, pair.b
                ));
            }
        }
        Ok(())
    }
}

/// Checks the columns of the records, and the list of moved bodies.
fn check_bodies(bodies: &Bodies) -> Result<(), String> {
    let mut moved = 0;
    for (i, record) in bodies.records.iter().enumerate() {
        let bounded = record.present() && record.flags() & UNBOUNDED == 0;
        if bounded && record.range() != bodies.grid.range(&record.now()) {
            return Err(format!("body {i} does not know its columns"));
        }
        moved += usize::from(record.moved(bodies.step));
    }
    let listed = |i: &u32| bodies.records[*i as usize].moved(bodies.step);
    if moved != bodies.marks.moved.len() || !bodies.marks.moved.iter().all(listed) {
        return Err(format!("{moved} bodies moved, {} are listed", bodies.marks.moved.len()));
    }
    Ok(())
}
