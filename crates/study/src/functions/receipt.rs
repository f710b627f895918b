//! `receipt(from, to)`: the proof of a segment as a text that `lin-canny-robot verify` checks.

use datafusion::arrow::array::ArrayRef;
use datafusion::arrow::datatypes::Fields;
use datafusion::error::Result;
use lin_canny_plan::receipt::{Receipt, ReceiptError};

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use crate::error::RowError;
use crate::rows::{Vectors, configuration};
use crate::study::Study;

const FIELDS: [(&str, Kind); 2] = [("text", Kind::Word), ("error", Kind::Word)];

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

/// Returns the text of a receipt, or the reason why there is none.
pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let coordinates = study.coordinates();
    let (from, to) = arguments.split_at(arguments.len() / 2);
    let (from, to) = (Vectors::new(from), Vectors::new(to));
    let (mut answers, mut p, mut q) = (Answers::new(fields(), rows), Vec::new(), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                q.clear();
                let written = configuration(&from, row, coordinates, &mut p)
                    .and_then(|()| configuration(&to, row, coordinates, &mut q))
                    .and_then(|()| {
                        checker.forget();
                        match Receipt::segment(checker, &p, &q) {
                            Ok(receipt) => Ok(Ok(receipt.to_string())),
                            Err(ReceiptError::Plan(error)) => Err(RowError::Refused(error.to_string())),
                            Err(error) => Ok(Err(error.to_string())),
                        }
                    });
                let ends = [p.as_slice(), q.as_slice()].concat();
                match study.settled(row, &ends, written)? {
                    None => answers.push(None),
                    Some(Ok(text)) => answers.push(Some(&[Value::Word(&text)])),
                    Some(Err(why)) => answers.push(Some(&[Value::Null, Value::Word(&why)])),
                }
            }
            answers.finish()
        })
        .map_err(outside)?
}
