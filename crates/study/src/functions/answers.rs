//! Columns of structs, filled row by row.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Builder, ListBuilder, StringBuilder, StructArray};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::error::Result;
use lin_canny_plan::{Checker, JointTree};

use super::each_row;
use crate::error::RowError;
use crate::rows::list_type;
use crate::study::Study;

/// The type of a field.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Number,
    Numbers,
    Word,
}

/// A value of a field.
pub(super) enum Value {
    Number(f64),
    Numbers(Vec<f64>),
    Word(String),
    Null,
}

impl Value {
    pub(super) fn word(word: impl ToString) -> Self {
        Self::Word(word.to_string())
    }
}

enum Column {
    Numbers(Float64Builder),
    Lists(ListBuilder<Float64Builder>),
    Words(StringBuilder),
}

impl Column {
    fn new(field: &Field) -> Self {
        match field.data_type() {
            DataType::Float64 => Self::Numbers(Float64Builder::new()),
            DataType::List(_) => Self::Lists(ListBuilder::new(Float64Builder::new())),
            _ => Self::Words(StringBuilder::new()),
        }
    }

    fn push(&mut self, value: Option<&Value>) {
        match (self, value) {
            (Self::Numbers(c), Some(Value::Number(x))) => c.append_value(*x),
            (Self::Lists(c), Some(Value::Numbers(list))) => c.append_value(list.iter().copied().map(Some)),
            (Self::Words(c), Some(Value::Word(w))) => c.append_value(w),
            (Self::Numbers(c), _) => c.append_null(),
            (Self::Lists(c), _) => c.append_null(),
            (Self::Words(c), _) => c.append_null(),
        }
    }

    fn finish(self) -> ArrayRef {
        match self {
            Self::Numbers(mut c) => Arc::new(c.finish()),
            Self::Lists(mut c) => Arc::new(c.finish()),
            Self::Words(mut c) => Arc::new(c.finish()),
        }
    }
}

/// The fields of a struct; every one may be NULL.
pub(super) fn fields_of(list: &[(&str, Kind)]) -> Fields {
    let field = |&(name, kind): &(&str, Kind)| {
        let data_type = match kind {
            Kind::Number => DataType::Float64,
            Kind::Numbers => list_type(),
            Kind::Word => DataType::Utf8,
        };
        Field::new(name, data_type, true)
    };
    list.iter().map(field).collect()
}

/// Returns a struct for each row, as [`each_row`] asks: values of the first fields and NULL for the
/// others, or a NULL struct for an invalid row of a lenient study.
pub(super) fn structs(
    study: &Study,
    fields: &[(&str, Kind)],
    rows: usize,
    ask: impl FnMut(&mut Checker<JointTree>, usize, &mut Vec<f64>) -> Result<Vec<Value>, RowError>,
) -> Result<ArrayRef> {
    let fields = fields_of(fields);
    let mut columns: Vec<Column> = fields.iter().map(|field| Column::new(field)).collect();
    let mut known = Vec::with_capacity(rows);
    each_row(study, rows, ask, |values| {
        known.push(values.is_some());
        for (k, column) in columns.iter_mut().enumerate() {
            column.push(values.as_ref().and_then(|v| v.get(k)));
        }
    })?;
    let columns = columns.into_iter().map(Column::finish).collect();
    Ok(Arc::new(StructArray::try_new(
        fields,
        columns,
        Some(NullBuffer::from(known)),
    )?))
}
