//! Builders for columns of structs.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Builder, ListBuilder, StringBuilder, StructArray};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use datafusion::error::Result;

use crate::rows::list_type;

/// The type of a field.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Number,
    Numbers,
    Word,
}

/// A value of a field.
pub(super) enum Value<'a> {
    Number(f64),
    Numbers(&'a [f64]),
    Word(&'a str),
    Null,
}

enum Column {
    Numbers(Float64Builder),
    Lists(ListBuilder<Float64Builder>),
    Words(StringBuilder),
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

/// A builder of results.
pub(super) struct Answers {
    fields: Fields,
    columns: Vec<Column>,
    known: Vec<bool>,
}

impl Answers {
    pub(super) fn new(fields: Fields, rows: usize) -> Self {
        let column = |field: &Arc<Field>| match field.data_type() {
            DataType::Float64 => Column::Numbers(Float64Builder::with_capacity(rows)),
            DataType::List(_) => Column::Lists(ListBuilder::new(Float64Builder::new())),
            _ => Column::Words(StringBuilder::new()),
        };
        Self {
            columns: fields.iter().map(column).collect(),
            known: Vec::with_capacity(rows),
            fields,
        }
    }

    /// Adds a row: values of the first fields and NULL for the others, or a NULL struct.
    pub(super) fn push(&mut self, values: Option<&[Value<'_>]>) {
        self.known.push(values.is_some());
        for (k, column) in self.columns.iter_mut().enumerate() {
            match (column, values.and_then(|v| v.get(k))) {
                (Column::Numbers(c), Some(Value::Number(x))) => c.append_value(*x),
                (Column::Lists(c), Some(Value::Numbers(list))) => c.append_value(list.iter().copied().map(Some)),
                (Column::Words(c), Some(Value::Word(w))) => c.append_value(w),
                (Column::Numbers(c), _) => c.append_null(),
                (Column::Lists(c), _) => c.append_null(),
                (Column::Words(c), _) => c.append_null(),
            }
        }
    }

    pub(super) fn finish(self) -> Result<ArrayRef> {
        let arrays = self.columns.into_iter().map(|column| match column {
            Column::Numbers(mut c) => Arc::new(c.finish()) as ArrayRef,
            Column::Lists(mut c) => Arc::new(c.finish()),
            Column::Words(mut c) => Arc::new(c.finish()),
        });
        let nulls = NullBuffer::from(self.known);
        Ok(Arc::new(StructArray::try_new(
            self.fields,
            arrays.collect(),
            Some(nulls),
        )?))
    }
}
