//! Feature `parallel`: multithreading of the two stages in which bodies and pairs are independent
//! of each other. Threads process runs of them; runs are joined in order and sums do not depend on
//! the order, so any number of threads gives equal bits.

use alloc::vec::Vec;

use rayon::prelude::*;

use super::answers::StoredAnswer;
use super::narrow_phase::{StepContext, Tally, test_run};
use super::pair_engine::PairEngine;
use super::pair_table::PairTable;
use super::step::Boxes;
use crate::body::polyhedron::BoxHint;
use crate::broad::{self, Aabb};

/// Number of bodies of one task.
const RUN: usize = 1024;

/// Number of pairs of one task: fewer than bodies, because a query takes longer than a box.
const PAIRS: usize = 128;

/// Computes the boxes of all due bodies, which are in ascending order.
pub(super) fn make_boxes(
    boxes: &Boxes<'_>,
    hints: &mut [BoxHint],
    due: &[u32],
    batch: &mut Vec<(broad::BodyId, Aabb)>,
) {
    let runs = hints.par_chunks_mut(RUN).enumerate().map(|(k, hints)| {
        let first = (k * RUN) as u32;
        let from = due.partition_point(|i| *i < first);
        let to = due.partition_point(|i| *i < first + RUN as u32);
        let mut part = Vec::with_capacity(to - from);
        boxes.make(first, hints, &due[from..to], &mut part);
        part
    });
    for mut part in runs.collect::<Vec<_>>() {
        batch.append(&mut part);
    }
}

/// Tests all pairs of a table.
pub(super) fn test_table<T: PairEngine, A: StoredAnswer>(
    pair_table: &mut PairTable<T, A>,
    context: &StepContext<'_>,
    tally: &mut Tally,
) {
    let headers = pair_table.headers.par_chunks_mut(PAIRS);
    let rows = headers
        .zip(pair_table.trackers.par_chunks_mut(PAIRS))
        .zip(pair_table.answers.par_chunks_mut(PAIRS));
    let parts = rows.map(|((headers, trackers), answers)| {
        let mut part = Tally::default();
        test_run(headers, trackers, answers, context, &mut part);
        part
    });
    for mut part in parts.collect::<Vec<_>>() {
        tally.counts += part.counts;
        tally.changes.append(&mut part.changes);
        tally.impacts.append(&mut part.impacts);
    }
}
