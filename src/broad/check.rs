//! Consistency of bodies and pairs, the part of [`BroadPhase::check`](super::BroadPhase::check)
//! that every structure shares.

use super::body::{Bodies, UNBOUNDED};
use super::state::BroadPhaseState;
use alloc::format;
use alloc::string::String;

impl BroadPhaseState {
    /// Returns the first contradiction among bodies and pairs. Between steps only.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { bodies, pairs, .. } = self;
        check_bodies(bodies)?;
        pairs.check()?;
        for pair in pairs.iter(bodies) {
            let [a, b] = [pair.a, pair.b].map(|id| bodies.records[id.index as usize].before(bodies.step));
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
