//! Columns of structs, filled row by row.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, StructArray, new_empty_array};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::common::ScalarValue;
use datafusion::error::Result;
use lin_canny_plan::{Checker, JointTree};

use super::each_row;
use crate::error::RowError;
use crate::rows::{list_column, list_type};
use crate::study::Study;

/// The type of a field.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Number,
    Numbers,
    Word,
}

/// The fields of a struct: the names of each type, separated by spaces. Every one may be NULL.
pub(super) type FieldList = [(Kind, &'static str)];

/// Returns the value of a number field.
pub(super) fn number(x: f64) -> ScalarValue {
    x.into()
}

/// Returns the value of a field with a list of numbers.
pub(super) fn list(list: &[f64]) -> ScalarValue {
    ScalarValue::List(Arc::new(list_column([list])))
}

/// Returns the value of a text field.
pub(super) fn text(value: impl ToString) -> ScalarValue {
    value.to_string().into()
}

pub(super) fn fields_of(list: &FieldList) -> Fields {
    let fields = list.iter().flat_map(|(kind, names)| {
        let data_type = match kind {
            Kind::Number => DataType::Float64,
            Kind::Numbers => list_type(),
            Kind::Word => DataType::Utf8,
        };
        names
            .split(' ')
            .map(move |name| Field::new(name, data_type.clone(), true))
    });
    fields.collect()
}

/// Returns a struct for each row, as [`each_row`] asks: values of the first fields and NULL for the
/// others, or a NULL struct for an invalid row of a lenient study.
pub(super) fn structs(
    study: &Study,
    fields: &FieldList,
    rows: usize,
    ask: impl FnMut(&mut Checker<JointTree>, usize, &mut Vec<f64>) -> Result<Vec<ScalarValue>, RowError>,
) -> Result<ArrayRef> {
    let fields = fields_of(fields);
    if rows == 0 {
        return Ok(new_empty_array(&DataType::Struct(fields)));
    }
    let nulls: Vec<_> = fields
        .iter()
        .map(|field| ScalarValue::try_new_null(field.data_type()))
        .collect::<Result<_>>()?;
    let mut columns = vec![Vec::with_capacity(rows); fields.len()];
    let mut known = Vec::with_capacity(rows);
    each_row(study, rows, ask, |values: Option<Vec<ScalarValue>>| {
        known.push(values.is_some());
        let mut values = values.unwrap_or_default().into_iter();
        for (column, null) in columns.iter_mut().zip(&nulls) {
            let value = values.next().filter(|value| !value.is_null());
            column.push(value.unwrap_or_else(|| null.clone()));
        }
    })?;
    let columns = columns
        .into_iter()
        .map(ScalarValue::iter_to_array)
        .collect::<Result<_>>()?;
    let known = NullBuffer::from(known);
    Ok(Arc::new(StructArray::try_new(fields, columns, Some(known))?))
}
