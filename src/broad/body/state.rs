//! Feature `serde`: the table of bodies as text.

use super::*;
use crate::base::num::each::Each;
use crate::broad::aabb::FARTHEST;
use alloc::string::String;

/// The serialized values of one index of the table.
#[derive(serde::Serialize, serde::Deserialize)]
struct BodyRow {
    generation: u32,
    body: BodyOptions,
    new: StoredBox,
    old: StoredBox,
    stamp: u32,
    flags: u32,
}

/// The complete state of [`Bodies`]. Boxes are in the order x, y, z.
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) struct BodiesState {
    origin: Point3<f64>,
    step: u32,
    rows: Vec<BodyRow>,
    free: Vec<u32>,
    leaving: Vec<u32>,
    regrouped: Vec<u32>,
    unbounded: Vec<u32>,
    moved: Vec<u32>,
}

/// Flags that outlive a step.
const LASTING: u32 = FIXED | UNBOUNDED | LOOSE;

impl Bodies {
    pub(crate) fn state(&self) -> BodiesState {
        let back = 3 - self.grid.axis;
        let generations = self.slots.generations();
        let [free, leaving] = self.slots.vacancies().each(Vec::clone);
        let row = |(i, record): (usize, &Record)| BodyRow {
            generation: generations[i],
            body: self.details[i].body(),
            new: record.now().to_box().rotated(back),
            old: record.before(self.step).to_box().rotated(back),
            stamp: record.stamp(),
            flags: record.flags() & LASTING,
        };
        BodiesState {
            origin: self.origin,
            step: self.step,
            rows: self.records.iter().enumerate().map(row).collect(),
            free,
            leaving,
            regrouped: self.regrouped.clone(),
            unbounded: self.unbounded.clone(),
            moved: self.marks.moved.clone(),
        }
    }
}

impl BodiesState {
    /// Checks that every list names existing bodies, none twice, and that step and origin are
    /// valid.
    fn check(&self) -> Result<(), String> {
        let n = self.rows.len();
        let lists = [&self.regrouped, &self.unbounded, &self.moved];
        let is_known = |list: &&Vec<u32>| list.len() <= n && list.iter().all(|i| (*i as usize) < n);
        if n > MOST_BODIES || !lists.iter().all(is_known) {
            return Err("a list of the broad phase names a body that is not there".into());
        }
        let once = |list: &Vec<u32>| {
            let mut sorted = list.clone();
            sorted.sort_unstable();
            sorted.is_sorted_by(|a, b| a < b)
        };
        if !once(&self.unbounded) || !once(&self.moved) {
            return Err("a list of the broad phase names a body twice".into());
        }
        if self.step == 0 || !self.origin.iter().all(|v| v.is_finite()) {
            return Err("the broad phase has no sound step or origin".into());
        }
        Ok(())
    }

    pub(crate) fn restored(self) -> Result<Bodies, String> {
        self.check()?;
        let mut bodies = Bodies::new(self.origin);
        let generations = self.rows.iter().map(|row| row.generation).collect();
        let slots = Slots::restored(generations, self.free, self.leaving);
        bodies.slots = slots.ok_or("the lists of removed bodies contradict the broad phase")?;
        bodies.step = self.step;
        for row in &self.rows {
            let sound = |b: &StoredBox| {
                let ordered = (0..3).all(|k| b.lo[k] <= b.hi[k] && b.lo[k] >= -FARTHEST && b.hi[k] <= FARTHEST);
                ordered || *b == StoredBox::EMPTY
            };
            if !sound(&row.new) || !sound(&row.old) || row.body.check().is_err() {
                return Err("a body of the broad phase has an unusable box or growth".into());
            }
            let mut record = Record::new(&Bounds::from_box(&row.new), row.stamp, row.flags & LASTING);
            record.set_old(&Bounds::from_box(&row.old));
            bodies.records.push(record);
            bodies.details.push(BodyDetail::new(row.body));
        }
        (bodies.regrouped, bodies.unbounded) = (self.regrouped, self.unbounded);
        bodies.marks.moved = self.moved;
        bodies.set_grid(Grid::single(0));
        Ok(bodies)
    }
}
