//! Writes receipts to files.

use std::collections::BTreeMap;
use std::path::Path;

use lin_canny_cli::RobotOptions;
use lin_canny_robot::plan::Cell;
use lin_canny_robot::plan::receipt::{Receipt, ReceiptError};

use crate::end::{End, ToolError};
use crate::text::write as write_text;

/// Returns the error of a receipt that cannot be written or read.
pub(crate) fn refused(file: &Path, reason: impl ToString) -> ToolError {
    ToolError::Input {
        file: file.to_owned(),
        reason: reason.to_string(),
    }
}

/// Writes a receipt as [`write()`] does. Of a motion that is not free, a receipt that does not exist is a
/// warning and `None`: the run ends with its verdict.
pub(crate) fn write_unless_blocked(
    file: &Path,
    robot: &RobotOptions,
    cell: &Cell,
    receipt: Result<Receipt, ReceiptError>,
    end: End,
) -> Result<Option<usize>, ToolError> {
    match receipt {
        Err(error) if end != End::Free => {
            warn!("warning: {}: not written: {error}", file.display());
            Ok(None)
        }
        receipt => write(file, robot, cell, receipt).map(Some),
    }
}

/// Writes a receipt with the files of the options and the reasons of excluded pairs, and returns
/// the number of pieces of evidence.
pub(crate) fn write(
    file: &Path,
    robot: &RobotOptions,
    cell: &Cell,
    receipt: Result<Receipt, ReceiptError>,
) -> Result<usize, ToolError> {
    let mut receipt = receipt.map_err(|error| refused(file, error))?;
    let reasons: BTreeMap<[&str; 2], &str> = cell.excluded_names().into_iter().collect();
    receipt.set_reasons(|mut names| {
        names.sort_unstable();
        let found = reasons.get(&names).filter(|reason| !reason.is_empty());
        found.map(|reason| format!("excluded: {reason}"))
    });
    for named in robot.named_files() {
        let content = std::fs::read(named).map_err(|error| refused(named, error))?;
        receipt.add_file(&named.to_string_lossy(), &content);
    }
    write_text(file, &receipt.to_string())?;
    Ok(receipt.certificates())
}
