//! `prove_pair(a, b, low, high)`: whether two links, by name, can meet at any configuration of a
//! cell.

use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Float64Type, Int64Type};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{ClearanceWidth, RangeOptions};
use lin_canny_robot::audit_pair;

use super::answers::{FieldList, Kind, list, number, structs, text};
use crate::error::RowError;
use crate::rows::{Ends, vector_types, word};
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[
    (Kind::Word, "verdict"),
    (Kind::Number, "lower upper open cells"),
    (Kind::Numbers, "at"),
];

/// Accepts two names, two lists, and optionally the most cells and the width.
pub(super) fn argument_types(study: &Study, _: &str, types: &[DataType]) -> Result<Vec<DataType>> {
    let count = study.coordinates().len();
    let [_, _, low, high, rest @ ..] = types else {
        return plan_err!("prove_pair takes two names, two lists of {count} numbers, and optionally cells and width");
    };
    let mut all = vec![DataType::Utf8; 2];
    for (end, what) in [(low, "the low end of prove_pair"), (high, "the high end of prove_pair")] {
        all.extend(vector_types(std::slice::from_ref(end), count, what)?);
    }
    if rest.len() > 2 {
        return plan_err!("prove_pair has {} arguments (expected 4 to 6)", types.len());
    }
    all.extend([DataType::Int64, DataType::Float64].into_iter().take(rest.len()));
    Ok(all)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let names = [0, 1].map(|k| arguments[k].as_string::<i32>());
    let (ends, coordinates) = (Ends::new(&arguments[2..4]), study.coordinates());
    structs(study, FIELDS, rows, |checker, row, numbers| {
        let range = ends.read(row, coordinates, numbers)?;
        let names = [word(names[0], row, "a")?, word(names[1], row, "b")?];
        let found = audit_pair(checker, names, range, &options(arguments, row)?).map_err(RowError::refused)?;
        let numbers = [found.lower, found.upper, found.open, found.cells as f64];
        let mut values = vec![text(found.verdict)];
        values.extend(numbers.map(number));
        values.push(list(&found.at));
        Ok(values)
    })
}

/// Returns how far the proof of a row goes.
fn options(arguments: &[ArrayRef], row: usize) -> Result<RangeOptions, RowError> {
    let known = |k: usize, name: &str| match arguments.get(k) {
        Some(column) if column.is_null(row) => Err(RowError::null(name)),
        column => Ok(column),
    };
    let mut options = RangeOptions::default();
    if let Some(cells) = known(4, "cells")? {
        let cells = cells.as_primitive::<Int64Type>().value(row);
        let refused = |_| RowError::refused(format!("cells is {cells} (expected 0 or more)"));
        options = options.cells(cells.try_into().map_err(refused)?);
    }
    if let Some(width) = known(5, "width")? {
        let width = width.as_primitive::<Float64Type>().value(row);
        if !(0.0..1.0).contains(&width) {
            return Err(RowError::refused(format!("width is {width:?} (expected 0 to below 1)")));
        }
        if width > 0.0 {
            options = options.width(ClearanceWidth::Share(width));
        }
    }
    Ok(options)
}
