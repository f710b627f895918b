//! `receipt(from, to)`: the proof of a segment as a text that `lin-canny verify` checks.

use datafusion::arrow::array::ArrayRef;
use datafusion::common::ScalarValue;
use datafusion::error::Result;
use lin_canny_plan::JointMotion;
use lin_canny_plan::receipt::{Receipt, ReceiptError};

use super::answers::{FieldList, Kind, structs, text};
use crate::error::RowError;
use crate::rows::Ends;
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[(Kind::Word, "text error")];

/// Returns the text of a receipt, or the reason why there is none.
pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (ends, coordinates) = (Ends::new(arguments), study.coordinates());
    structs(study, FIELDS, rows, |checker, row, numbers| {
        let [from, to] = ends.read(row, coordinates, numbers)?;
        checker.reset();
        match Receipt::motion(checker, &JointMotion::segment(from, to)) {
            Ok(receipt) => Ok(vec![text(receipt)]),
            Err(ReceiptError::Plan(error)) => Err(RowError::refused(error)),
            Err(error) => Ok(vec![ScalarValue::Null, text(error)]),
        }
    })
}
