//! Sortedness and ownership of every column.

use super::PencilSweep;
use super::column::{Column, entry, index_of, who};
use crate::broad::body::{Bodies, UNBOUNDED};
use alloc::format;
use alloc::string::String;

impl PencilSweep {
    /// Returns the first contradiction between columns and bodies. Between steps only.
    pub(super) fn check_columns(&self) -> Result<(), String> {
        let bodies = &self.state.bodies;
        if self.columns.len() != bodies.grid.column_count() {
            return Err(format!("{} columns for {:?}", self.columns.len(), bodies.grid.size));
        }
        for (i, column) in self.columns.iter().enumerate() {
            column
                .check(bodies.grid.column(i), bodies)
                .map_err(|what| format!("column {i}: {what}"))?;
        }
        // Each entry belongs to a body of this column and no body is listed twice, so an equal
        // count means that no entry is missing.
        let listed: usize = self.columns.iter().map(|c| c.entries.len()).sum();
        let places = bodies
            .records
            .iter()
            .map(|r| r.range_before(bodies.step, &bodies.grid).count());
        let owed: usize = places.sum();
        if listed != owed {
            return Err(format!("{listed} entries, but bodies touch {owed} columns"));
        }
        Ok(())
    }
}

impl Column {
    fn check(&self, cell: [u16; 2], bodies: &Bodies) -> Result<(), String> {
        if self.settled != self.entries.len() {
            return Err(format!("{} of {} entries settled", self.settled, self.entries.len()));
        }
        if !self.entries.is_sorted_by(|a, b| a < b) {
            return Err("entries are out of order".into());
        }
        for &e in &self.entries {
            let i = index_of(e);
            let Some(record) = bodies.records.get(i) else {
                return Err(format!("body {i} is not there"));
            };
            let range = record.range_before(bodies.step, &bodies.grid);
            if record.flags() & UNBOUNDED != 0 || !range.contains(cell) {
                return Err(format!("body {i} does not belong there"));
            }
            let stored = record.before(bodies.step).to_box();
            if e != entry(stored.lo[0], who(i as u32, 0)) {
                return Err(format!("the entry of body {i} is not that of its box"));
            }
            let length = stored.hi[0] - stored.lo[0];
            if length > self.longest {
                return Err(format!(
                    "body {i} is {length} long, more than the longest, {}",
                    self.longest
                ));
            }
        }
        Ok(())
    }
}
