//! Feature `parallel`: the two stages in which bodies and pairs are independent of each other, dealt out to threads in runs. Runs
//! are joined in order and sums do not depend on it, so that any number of threads gives the same bits.

use alloc::vec::Vec;

use rayon::prelude::*;

use super::kept::Answer;
use super::lane::Lane;
use super::look::{Context, Tally, look_at_run};
use super::step::Boxes;
use crate::broad::{self, Aabb};
use crate::polyhedron::BoxHint;

/// Bodies or pairs of one run: enough to be worth a task.
const RUN: usize = 1024;

/// Makes the boxes of all due bodies, which are in ascending order.
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

/// Looks at all pairs of a lane.
pub(super) fn look_at_lane<A: Answer>(lane: &mut Lane<A>, context: &Context<'_>, tally: &mut Tally) {
    let heads = lane.heads.par_chunks_mut(RUN);
    let seats = heads
        .zip(lane.trackers.par_chunks_mut(RUN))
        .zip(lane.answers.par_chunks_mut(RUN));
    let parts = seats.map(|((heads, trackers), answers)| {
        let mut part = Tally::default();
        look_at_run(heads, trackers, answers, context, &mut part);
        part
    });
    for mut part in parts.collect::<Vec<_>>() {
        tally.counts += part.counts;
        tally.happened.append(&mut part.happened);
    }
}
