//! `prove_pair(a, b, low, high)`: whether two links, by name, can meet at any configuration of a
//! cell.

use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Fields, Float64Type, Int64Type};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{ClearanceWidth, RangeOptions};
use lin_canny_robot::audit_pair;

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use crate::error::RowError;
use crate::rows::{Vectors, configuration, vector_types};
use crate::study::Study;

const FIELDS: [(&str, Kind); 6] = [
    ("verdict", Kind::Word),
    ("lower", Kind::Number),
    ("upper", Kind::Number),
    ("open", Kind::Number),
    ("cells", Kind::Number),
    ("at", Kind::Numbers),
];

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

/// Accepts two names, two lists, and optionally the most cells and the width.
pub(super) fn argument_types(types: &[DataType], count: usize) -> Result<Vec<DataType>> {
    let [_, _, low, high, rest @ ..] = types else {
        return plan_err!("prove_pair takes two names, two lists of {count} numbers, and optionally cells and width");
    };
    let mut all = vec![DataType::Utf8; 2];
    for (end, what) in [(low, "the low end of prove_pair"), (high, "the high end of prove_pair")] {
        all.extend(vector_types(std::slice::from_ref(end), count, what)?);
    }
    match rest.len() {
        0 => {}
        1 => all.push(DataType::Int64),
        2 => all.extend([DataType::Int64, DataType::Float64]),
        _ => return plan_err!("prove_pair has {} arguments (expected 4 to 6)", types.len()),
    }
    Ok(all)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let coordinates = study.coordinates();
    let names = [0, 1].map(|k| arguments[k].as_string::<i32>());
    let ends = [2, 3].map(|k| Vectors::new(&arguments[k..=k]));
    let name_of = |k: usize, row: usize| {
        let name = ["a", "b"][k].to_owned();
        let is_known = names[k].is_valid(row);
        is_known.then(|| names[k].value(row)).ok_or(RowError::Null { name })
    };
    let (mut answers, mut low, mut high) = (Answers::new(fields(), rows), Vec::new(), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                high.clear();
                let found = configuration(&ends[0], row, coordinates, &mut low)
                    .and_then(|()| configuration(&ends[1], row, coordinates, &mut high))
                    .and_then(|()| {
                        let (names, options) = ([name_of(0, row)?, name_of(1, row)?], options(arguments, row)?);
                        let found = audit_pair(checker, names, [&low, &high], &options);
                        found.map_err(|e| RowError::Refused(e.to_string()))
                    });
                let found = study.settled(row, &[low.as_slice(), high.as_slice()].concat(), found)?;
                match found {
                    None => answers.push(None),
                    Some(found) => answers.push(Some(&[
                        Value::Word(&found.verdict.to_string()),
                        Value::Number(found.lower),
                        Value::Number(found.upper),
                        Value::Number(found.open),
                        Value::Number(found.cells as f64),
                        Value::Numbers(&found.at),
                    ])),
                }
            }
            answers.finish()
        })
        .map_err(outside)?
}

/// Returns how far the proof of a row goes.
fn options(arguments: &[ArrayRef], row: usize) -> Result<RangeOptions, RowError> {
    let null = |k: usize, name: &str| match arguments.get(k) {
        Some(column) if column.is_null(row) => Err(RowError::Null { name: name.into() }),
        column => Ok(column),
    };
    let mut options = RangeOptions::default();
    if let Some(cells) = null(4, "cells")? {
        let cells = cells.as_primitive::<Int64Type>().value(row);
        let refused = |_| RowError::Refused(format!("cells is {cells} (expected 0 or more)"));
        options = options.cells(cells.try_into().map_err(refused)?);
    }
    if let Some(width) = null(5, "width")? {
        let width = width.as_primitive::<Float64Type>().value(row);
        if !(0.0..1.0).contains(&width) {
            return Err(RowError::Refused(format!("width is {width:?} (expected 0 to below 1)")));
        }
        if width > 0.0 {
            options = options.width(ClearanceWidth::Share(width));
        }
    }
    Ok(options)
}
