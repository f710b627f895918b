//! Sequences of broad-phase calls from arbitrary bytes: no panic, the pairs of brute force, and
//! events that match their changes.
//!
//! The test `broad`, the target `calls` of `fuzz/` and the instrument `soak` share this module.

use super::Bytes;
use lin_canny::broad::*;
use lin_canny::nalgebra::{Point3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

crate::tally! {
    /// Counts of the results.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Tally {
        /// Calls accepted and rejected, without steps.
        pub calls: [u32; 2],
        /// Steps.
        pub steps: u32,
        /// Events of all steps.
        pub events: u32,
        /// Pairs of all steps.
        pub pairs: u32,
    }
}

/// Largest number of calls of one input: brute force is quadratic.
const CALLS: usize = 300;

impl Bytes<'_> {
    fn signed(&mut self) -> f64 {
        f64::from(self.byte() as i8)
    }

    /// Returns a number from a coarse grid, so that coordinates often coincide, or an extreme
    /// number.
    fn coordinate(&mut self) -> f64 {
        const HARD: [f64; 11] = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e300,
            -1e300,
            1e30,
            -0.0,
            5e-324,
            -1e-60,
            3.4e38,
            1e7,
        ];
        match self.byte() {
            0..190 => (self.signed() / 3.0).round() * 0.25,
            190..250 => self.signed() / 12.7 + self.signed() / 2000.0,
            k => HARD[usize::from(k.wrapping_mul(37) ^ self.byte()) % HARD.len()],
        }
    }

    fn point(&mut self) -> Point3<f64> {
        Point3::new(self.coordinate(), self.coordinate(), self.coordinate())
    }

    /// Returns a nonnegative number up to `most`.
    fn side(&mut self, most: f64) -> f64 {
        f64::from(self.byte()) / 255.0 * most
    }

    fn aabb(&mut self) -> Aabb {
        let kind = self.byte() % 10;
        let p = self.point();
        match kind {
            0 => Aabb::new(p, self.point()),
            1 => Aabb::new(p, p + Vector3::new(0.0, self.side(100.0), self.side(100.0))),
            _ => Aabb::new(p, p + Vector3::new(self.side(3.0), self.side(3.0), self.side(3.0))),
        }
    }

    fn groups(&mut self) -> Groups {
        Groups {
            member_of: u32::from(self.byte() % 4),
            pairs_with: u32::from(self.byte() % 4),
            fixed_with: u32::from(self.byte() % 4),
        }
    }

    fn options(&mut self) -> BodyOptions {
        let kind = self.byte();
        let body = if kind.is_multiple_of(2) {
            BodyOptions::default()
        } else {
            BodyOptions::default().fixed(true)
        };
        match kind / 2 % 3 {
            0 => body.groups(self.groups()),
            1 if kind > 250 => body.growth(f64::NAN),
            1 => body.growth(f64::from(kind / 64) / 4.0).lookahead(2.0),
            _ => body,
        }
    }
}

/// A broad phase, and the pairs according to its events.
#[derive(Default)]
struct Fed {
    broad: SweepAndPrune,
    told: BTreeMap<PairId, (BodyId, BodyId)>,
    live: BTreeSet<BodyId>,
    ids: Vec<BodyId>,
    tally: Tally,
}

impl Fed {
    /// Returns an id that was returned before, also of a removed body, or an id that was never
    /// returned.
    fn id(&self, k: u8) -> BodyId {
        self.ids
            .get(usize::from(k) % self.ids.len().max(1))
            .copied()
            .unwrap_or(BodyId {
                index: u32::from(k),
                generation: 1,
            })
    }

    /// Asserts that a call is rejected for its id if and only if no body has the id.
    fn judge(&self, id: BodyId, done: &Result<(), BroadPhaseError>) {
        let is_stale = *done == Err(BroadPhaseError::StaleId { body: id });
        assert_eq!(is_stale, !self.live.contains(&id), "{id}: {done:?}");
    }

    /// Asserts that a new id was never returned before.
    fn given(&mut self, id: &Result<BodyId, BroadPhaseError>) {
        self.count(id);
        if let Ok(id) = id {
            assert!(!self.ids.contains(id), "{id} is given twice");
            self.ids.push(*id);
            self.live.insert(*id);
        }
    }

    fn remove(&mut self, id: BodyId) {
        let done = self.broad.remove(id);
        self.judge(id, &done);
        self.count(&done);
        self.live.remove(&id);
    }

    fn count<T>(&mut self, done: &Result<T, impl core::fmt::Debug>) {
        self.tally.calls[usize::from(done.is_err())] += 1;
    }

    fn call(&mut self, bytes: &mut Bytes) {
        // These three ranges of the byte leave the meaning of older inputs unchanged.
        let kind = match bytes.byte() {
            220..226 => return self.wall(bytes),
            226..234 => return self.replace(bytes),
            234..250 => return self.slide(bytes),
            kind => kind,
        };
        match kind % 21 {
            0..6 => {
                let (aabb, body) = (bytes.aabb(), bytes.options());
                self.insert(&aabb, body);
            }
            6 => {
                let aabb = bytes.aabb();
                let id = self.broad.insert_unbounded(&aabb, BodyOptions::default());
                self.given(&id);
            }
            7..9 => {
                let id = self.id(bytes.byte());
                self.remove(id);
            }
            9..15 => self.set(bytes),
            15 => {
                let n = bytes.byte() % 20;
                let batch: Vec<_> = (0..n).map(|_| (self.id(bytes.byte()), bytes.aabb())).collect();
                let done = self.broad.set_boxes(&batch);
                self.count(&done);
            }
            16 => {
                let (id, groups) = (self.id(bytes.byte()), bytes.groups());
                let done = self.broad.set_groups(id, groups);
                self.judge(id, &done);
                self.count(&done);
            }
            _ => self.step(),
        }
    }

    /// Inserts bodies of equal sides on a lattice: equal bounds on every axis.
    fn wall(&mut self, bytes: &mut Bytes) {
        let (size, gap) = (bytes.byte(), 0.5 + f64::from(bytes.byte() % 4) / 2.0);
        for i in 0..1 + size % 4 {
            for j in 0..1 + size / 4 % 8 {
                let low = Point3::new(f64::from(i), f64::from(j), 0.0) * gap;
                self.insert(&Aabb::new(low, low + Vector3::repeat(1.0)), BodyOptions::default());
            }
        }
    }

    fn insert(&mut self, aabb: &Aabb, body: BodyOptions) {
        let id = self.broad.insert(aabb, body);
        self.given(&id);
        if let Ok(id) = id {
            self.covers(id, aabb);
        }
    }

    /// Asserts that the stored box of a body contains the given box, which `f32` cannot hold.
    fn covers(&self, id: BodyId, given: &Aabb) {
        let stored = self.broad.stored_box(id).expect("a body has a box");
        for k in 0..3 {
            let (low, high) = (f64::from(stored.lo[k]), f64::from(stored.hi[k]));
            // Boxes beyond the range of stored boxes end there.
            let is_covered = |x: f64, is_in: bool| is_in || x.abs() > 1e30;
            assert!(is_covered(given.min[k], low <= given.min[k]), "{stored:?} {given:?}");
            assert!(is_covered(given.max[k], given.max[k] <= high), "{stored:?} {given:?}");
        }
    }

    /// Returns the stored box of a body.
    fn present(&self, id: BodyId) -> Option<Aabb> {
        let stored = self.broad.stored_box(id)?;
        let [min, max] = [stored.lo, stored.hi].map(|p| Point3::from(p.map(f64::from)));
        Some(Aabb::new(min, max))
    }

    /// Replaces a body by another one, mostly under the same index.
    fn replace(&mut self, bytes: &mut Bytes) {
        let id = self.id(bytes.byte());
        let Some(place) = self.present(id) else { return };
        self.remove(id);
        if bytes.byte() < 200 {
            self.step(); // the index is free only now
        }
        self.insert(&place, BodyOptions::default());
    }

    /// Moves a body by a fraction of a unit per step, possibly from another body's position.
    fn slide(&mut self, bytes: &mut Bytes) {
        let (id, other) = (self.id(bytes.byte()), self.id(bytes.byte()));
        let (axis, by) = (usize::from(bytes.byte() % 3), 0.125 * (bytes.signed() / 32.0).round());
        if bytes.byte() < 40 {
            let place = self.present(other);
            self.set_to(id, place);
        }
        for _ in 0..bytes.byte() % 8 {
            let place = self.present(id).map(|aabb| {
                let mut step = Vector3::zeros();
                step[axis] = by;
                Aabb::new(aabb.min + step, aabb.max + step)
            });
            self.set_to(id, place);
            self.step();
        }
    }

    fn set_to(&mut self, id: BodyId, place: Option<Aabb>) {
        let Some(aabb) = place else { return };
        let done = self.broad.set_box(id, &aabb);
        self.judge(id, &done);
        self.count(&done);
    }

    fn set(&mut self, bytes: &mut Bytes) {
        let (id, aabb) = (self.id(bytes.byte()), bytes.aabb());
        let before = self.broad.stored_box(id);
        let done = self.broad.set_box(id, &aabb);
        self.judge(id, &done);
        self.count(&done);
        match done {
            Err(_) => assert_eq!(self.broad.stored_box(id), before),
            Ok(()) => {
                self.covers(id, &aabb);
                let given = StoredBox::outward(&aabb, &Point3::origin());
                assert!(self.broad.stored_box(id).is_some_and(|b| b.contains(&given)));
            }
        }
    }

    fn step(&mut self) {
        assert!(self.broad.bodies().eq(self.live.iter().copied()));
        let events = self.broad.step();
        for pair in events.ended {
            assert_eq!(self.told.remove(&pair.id), Some((pair.a, pair.b)));
        }
        for pair in events.began {
            assert_eq!(self.told.insert(pair.id, (pair.a, pair.b)), None);
        }
        self.tally.steps += 1;
        self.tally.events += (events.began.len() + events.ended.len()) as u32;
        assert_eq!(self.broad.check(), Ok(()));
        assert!(self.broad.pairs().all(|p| self.told.get(&p.id) == Some(&(p.a, p.b))));
        assert_eq!(self.broad.pair_count(), self.told.len());
        let mut present: Vec<_> = self.broad.pairs().map(|p| (p.a, p.b)).collect();
        present.sort_unstable();
        self.tally.pairs += present.len() as u32;
        assert_eq!(present, self.expected());
    }

    /// Returns the pairs by brute force.
    fn expected(&self) -> Vec<(BodyId, BodyId)> {
        let bodies: Vec<_> = self
            .broad
            .bodies()
            .filter_map(|id| Some((id, self.broad.stored_box(id)?, self.broad.body(id)?)))
            .collect();
        let mut pairs = Vec::new();
        for (k, (a, box_a, body_a)) in bodies.iter().enumerate() {
            for (b, box_b, body_b) in &bodies[k + 1..] {
                let may = match body_a.fixed && body_b.fixed {
                    true => body_a.groups.meet_fixed(body_b.groups),
                    false => body_a.groups.meet(body_b.groups),
                };
                if may && box_a.overlaps(box_b) {
                    pairs.push((*a, *b));
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }
}

/// Makes the calls that the bytes encode, and one step at the end.
pub fn drive(bytes: &[u8]) -> Tally {
    let mut bytes = Bytes(bytes);
    let mut fed = Fed::default();
    for _ in 0..CALLS {
        if bytes.0.is_empty() {
            break;
        }
        fed.call(&mut bytes);
    }
    fed.step();
    fed.tally
}
