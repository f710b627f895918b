//! Configurations in the arguments of a function.

use datafusion::arrow::array::{Array, ArrayRef, AsArray, Float64Array, ListArray};
use datafusion::arrow::datatypes::{DataType, Field, Float64Type};
use datafusion::common::plan_err;
use datafusion::error::Result;
use std::sync::Arc;

use crate::error::RowError;
use lin_canny_robot::Coordinate;

/// One vector of numbers per row: a column for each number, or a column of lists.
pub(crate) enum Vectors {
    Columns(Vec<Float64Array>),
    Lists(ListArray),
}

impl Vectors {
    /// Returns the vectors in arguments of the types that [`vector_types`] returns.
    pub(crate) fn new(arguments: &[ArrayRef]) -> Self {
        match arguments {
            [one] if matches!(one.data_type(), DataType::List(_)) => Self::Lists(one.as_list().clone()),
            columns => {
                let columns = columns.iter().map(|c| c.as_primitive::<Float64Type>().clone());
                Self::Columns(columns.collect())
            }
        }
    }

    /// Reads the vector of a row; `name` returns the name of each number, or of the whole list for
    /// `None`.
    pub(crate) fn read<'n>(
        &self,
        row: usize,
        needed: usize,
        name: impl Fn(Option<usize>) -> &'n str,
        into: &mut Vec<f64>,
    ) -> Result<(), RowError> {
        into.clear();
        let null = |k: Option<usize>| RowError::Null { name: name(k).into() };
        match self {
            Self::Columns(columns) => {
                for (k, column) in columns.iter().enumerate() {
                    if column.is_null(row) {
                        return Err(null(Some(k)));
                    }
                    into.push(column.value(row));
                }
            }
            Self::Lists(lists) => {
                if lists.is_null(row) {
                    return Err(null(None));
                }
                let values = lists.value(row);
                let values = values.as_primitive::<Float64Type>();
                if values.len() != needed {
                    let (name, found) = (name(None).into(), values.len());
                    return Err(RowError::Length { name, found, needed });
                }
                if let Some(k) = (0..needed).find(|&k| values.is_null(k)) {
                    return Err(null(Some(k)));
                }
                into.extend_from_slice(values.values());
            }
        }
        Ok(())
    }
}

/// Reads the configuration of a row, within its limits.
pub(crate) fn configuration(
    vectors: &Vectors,
    row: usize,
    coordinates: &[Coordinate],
    into: &mut Vec<f64>,
) -> Result<(), RowError> {
    let name = |k: Option<usize>| k.map_or("the configuration", |k| coordinates[k].name.as_str());
    vectors.read(row, coordinates.len(), name, into)?;
    for (&value, coordinate) in into.iter().zip(coordinates) {
        let [lower, upper] = coordinate.limits;
        // NaN is outside.
        if !(lower..=upper).contains(&value) {
            let name = coordinate.name.clone();
            return Err(RowError::Limits {
                name,
                value,
                lower,
                upper,
            });
        }
    }
    Ok(())
}

/// Returns the type of a list of numbers.
pub(crate) fn list_type() -> DataType {
    DataType::List(Arc::new(Field::new_list_field(DataType::Float64, true)))
}

/// Returns the types to which the arguments of a vector are cast: `count` numbers, or one list.
pub(crate) fn vector_types(arguments: &[DataType], count: usize, what: &str) -> Result<Vec<DataType>> {
    let is_number = |t: &DataType| t.is_numeric() || t.is_null();
    match arguments {
        [DataType::List(_) | DataType::LargeList(_) | DataType::FixedSizeList(..)] => Ok(vec![list_type()]),
        all if all.len() == count && all.iter().all(is_number) => Ok(vec![DataType::Float64; count]),
        _ => plan_err!("{what} takes {count} number(s), or one list of them"),
    }
}
