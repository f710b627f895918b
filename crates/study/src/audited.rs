//! Divides an audit of all pairs of links into rows for the function `prove_pair`.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Int64Array, RecordBatch, StringArray};
use lin_canny_robot::{AuditCell, audit_cells};

use crate::error::StudyError;
use crate::input::ID;
use crate::rows::list_column;
use crate::study::Study;

/// Rows per row group of a file of cells: each may take seconds.
pub const ROWS_PER_GROUP: usize = 64;

/// The query that puts the verdicts of the cells of each two names together.
///
/// Its table has the columns `a`, `b` and those of `prove_pair`. Two names never meet if they never
/// do in any cell, and do both if they meet in one cell and are free in another.
pub const VERDICTS: &str = "SELECT a, b, CASE \
    WHEN bool_or(verdict = 'both') OR (bool_or(verdict = 'never') AND bool_or(verdict = 'always')) THEN 'both' \
    WHEN bool_or(verdict = 'open') THEN 'open' ELSE min(verdict) END AS verdict, \
    min(lower) AS lower, min(upper) AS upper, sum(cells) AS cells FROM configs GROUP BY a, b ORDER BY a, b";

/// Returns rows with the columns `id`, `a`, `b`, `low` and `high`: at most `count` cells for each two
/// links, and each link and obstacle, that move against each other.
///
/// # Errors
/// Returns an error if the world cannot be audited.
pub fn cells(study: &Study, count: usize) -> Result<RecordBatch, StudyError> {
    let cells: Vec<AuditCell> = study.with_checker(|checker| audit_cells(checker, count))??;
    let names = |k: usize| Arc::new(StringArray::from_iter_values(cells.iter().map(|cell| &cell.names[k]))) as ArrayRef;
    let ends = |k: usize| Arc::new(list_column(cells.iter().map(|cell| cell.range[k].as_slice()))) as ArrayRef;
    let ids: ArrayRef = Arc::new(Int64Array::from_iter_values(0..cells.len() as i64));
    let columns = [
        (ID, ids),
        ("a", names(0)),
        ("b", names(1)),
        ("low", ends(0)),
        ("high", ends(1)),
    ];
    Ok(RecordBatch::try_from_iter(columns)?)
}
