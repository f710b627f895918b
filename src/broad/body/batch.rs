//! Setting many boxes at once.

use super::place::PlaceContext;
use super::{Bodies, Marks, Record};
use crate::broad::parallel::{Threads, ascends, join};
use crate::broad::slots::is_living;
use crate::broad::{Aabb, BatchError, BodyId, BroadPhaseError};

/// A run of records that starts at index `first`.
struct BodyRun<'a> {
    first: u32,
    records: &'a mut [Record],
    generations: &'a [u32],
}

impl Bodies {
    /// Applies every valid entry; the error reports the refused entries.
    pub(crate) fn set_boxes(&mut self, batch: &[(BodyId, Aabb)], threads: Threads) -> Result<(), BatchError> {
        let threads = threads.sharing(batch.len());
        let error = match self.grid.axis {
            0 => self.set_boxes_in::<0>(batch, threads),
            1 => self.set_boxes_in::<1>(batch, threads),
            _ => self.set_boxes_in::<2>(batch, threads),
        };
        error.map_or(Ok(()), Err)
    }

    fn set_boxes_in<const AXIS: usize>(&mut self, batch: &[(BodyId, Aabb)], threads: usize) -> Option<BatchError> {
        let context = PlaceContext {
            origin: &self.origin,
            grid: &self.grid,
            details: &self.details,
            step: self.step,
        };
        let run = BodyRun {
            first: 0,
            records: &mut self.records,
            generations: self.slots.generations(),
        };
        // Records can be distributed to threads only if each part of the batch names a part of the
        // table.
        if threads > 1 && ascends(batch, |entry| entry.0.index, threads) {
            self.shares.resize_with(threads.max(self.shares.len()), Marks::default);
            let shares = &mut self.shares[..threads];
            let error = split::<AXIS>(&context, run, batch, shares);
            shares.iter_mut().for_each(|share| self.marks.append(share));
            return error;
        }
        run.apply::<AXIS>(&context, batch, &mut self.marks)
    }
}

/// Halves batch and table until every thread has its own part and marks; the marks are joined in
/// order, so the result equals the result of one thread.
fn split<const AXIS: usize>(
    context: &PlaceContext<'_>,
    run: BodyRun<'_>,
    batch: &[(BodyId, Aabb)],
    shares: &mut [Marks],
) -> Option<BatchError> {
    let half = batch.len() / 2;
    if shares.len() <= 1 || half == 0 {
        let marks = shares.first_mut()?;
        return run.apply::<AXIS>(context, batch, marks);
    }
    let (low, high) = batch.split_at(half);
    let border = (high[0].0.index - run.first) as usize;
    let border = border.min(run.records.len());
    let (records_low, records_high) = run.records.split_at_mut(border);
    let (generations_low, generations_high) = run.generations.split_at(border);
    let run_low = BodyRun {
        first: run.first,
        records: records_low,
        generations: generations_low,
    };
    let run_high = BodyRun {
        first: run.first + border as u32,
        records: records_high,
        generations: generations_high,
    };
    let (shares_low, shares_high) = shares.split_at_mut(shares.len() / 2);
    let (mut error_low, mut error_high) = (None, None);
    join(
        || error_low = split::<AXIS>(context, run_low, low, shares_low),
        || error_high = split::<AXIS>(context, run_high, high, shares_high),
    );
    let error_high = error_high.map(|e| BatchError {
        index: e.index + half,
        ..e
    });
    BatchError::joined(error_low, error_high)
}

impl BodyRun<'_> {
    fn apply<const AXIS: usize>(
        self,
        context: &PlaceContext<'_>,
        batch: &[(BodyId, Aabb)],
        marks: &mut Marks,
    ) -> Option<BatchError> {
        let mut error = None;
        for (place, (id, aabb)) in batch.iter().enumerate() {
            let i = id.index.wrapping_sub(self.first) as usize;
            let is_living = is_living(self.generations, i, *id);
            let Some(record) = self.records.get_mut(i).filter(|_| is_living) else {
                let stale = BroadPhaseError::StaleId { body: *id };
                error = BatchError::joined(error, Some(BatchError::one(place, stale)));
                continue;
            };
            if let Err(fault) = context.place::<AXIS>(record, id.index, aabb, marks) {
                let fault = BroadPhaseError::from_fault(fault, Some(*id));
                error = BatchError::joined(error, Some(BatchError::one(place, fault)));
            }
        }
        error
    }
}
