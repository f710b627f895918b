//! Configurations in the arguments of a function.

use datafusion::arrow::array::{
    Array, ArrayRef, AsArray, Float64Array, Float64Builder, ListArray, ListBuilder, StringArray,
};
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

    /// Adds the vector of a row to numbers; `name` returns the name of each number, or of the whole
    /// list for `None`.
    pub(crate) fn read<'n>(
        &self,
        row: usize,
        needed: usize,
        name: impl Fn(Option<usize>) -> &'n str,
        into: &mut Vec<f64>,
    ) -> Result<(), RowError> {
        match self {
            Self::Columns(columns) => {
                for (k, column) in columns.iter().enumerate() {
                    if column.is_null(row) {
                        return Err(RowError::null(name(Some(k))));
                    }
                    into.push(column.value(row));
                }
            }
            Self::Lists(lists) => read_list(list_at(lists, row), needed, name, into)?,
        }
        Ok(())
    }
}

/// Returns the list of a row, if there is one.
pub(crate) fn list_at(lists: &ListArray, row: usize) -> Option<ArrayRef> {
    lists.is_valid(row).then(|| lists.value(row))
}

/// Adds a list to numbers, as [`Vectors::read`] does.
pub(crate) fn read_list<'n>(
    list: Option<ArrayRef>,
    needed: usize,
    name: impl Fn(Option<usize>) -> &'n str,
    into: &mut Vec<f64>,
) -> Result<(), RowError> {
    let list = list.ok_or_else(|| RowError::null(name(None)))?;
    let values = list.as_primitive::<Float64Type>();
    if values.len() != needed {
        let (name, found) = (name(None), values.len());
        return Err(RowError::refused(format!(
            "{name} has {found} values (expected {needed})"
        )));
    }
    if let Some(k) = (0..needed).find(|&k| values.is_null(k)) {
        return Err(RowError::null(name(Some(k))));
    }
    into.extend_from_slice(values.values());
    Ok(())
}

/// Adds the configuration of a row to numbers, if it is within its limits.
pub(crate) fn configuration(
    vectors: &Vectors,
    row: usize,
    coordinates: &[Coordinate],
    into: &mut Vec<f64>,
) -> Result<(), RowError> {
    let start = into.len();
    let name = |k: Option<usize>| k.map_or("the configuration", |k| coordinates[k].name.as_str());
    vectors.read(row, coordinates.len(), name, into)?;
    // NaN is outside.
    let is_outside = |(value, of): &(&f64, &Coordinate)| !(of.limits[0]..=of.limits[1]).contains(*value);
    match into[start..].iter().zip(coordinates).find(is_outside) {
        None => Ok(()),
        Some((&value, coordinate)) => Err(RowError::limits(&coordinate.name, value, coordinate.limits)),
    }
}

/// Two configurations per row: the ends of a segment or of a range.
pub(crate) struct Ends([Vectors; 2]);

impl Ends {
    /// Returns the ends in arguments, one half for each.
    pub(crate) fn new(arguments: &[ArrayRef]) -> Self {
        let (first, second) = arguments.split_at(arguments.len() / 2);
        Self([Vectors::new(first), Vectors::new(second)])
    }

    /// Reads both ends of a row into an empty list.
    pub(crate) fn read<'n>(
        &self,
        row: usize,
        coordinates: &[Coordinate],
        numbers: &'n mut Vec<f64>,
    ) -> Result<[&'n [f64]; 2], RowError> {
        for end in &self.0 {
            configuration(end, row, coordinates, numbers)?;
        }
        let (first, second) = numbers.split_at(coordinates.len());
        Ok([first, second])
    }
}

/// Returns the word of a row.
pub(crate) fn word<'w>(words: &'w StringArray, row: usize, name: &str) -> Result<&'w str, RowError> {
    match words.is_null(row) {
        true => Err(RowError::null(name)),
        false => Ok(words.value(row)),
    }
}

/// Returns the type of a list of numbers.
pub(crate) fn list_type() -> DataType {
    DataType::List(Arc::new(Field::new_list_field(DataType::Float64, true)))
}

/// Returns a column of lists of numbers.
pub(crate) fn list_column<'l>(lists: impl IntoIterator<Item = &'l [f64]>) -> ListArray {
    let mut column = ListBuilder::new(Float64Builder::new());
    for list in lists {
        column.append_value(list.iter().copied().map(Some));
    }
    column.finish()
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

/// Returns the types of the arguments of a function that takes names of bodies and a vector.
pub(crate) fn types_after_names<const N: usize>(
    names: usize,
    numbers: [&str; N],
    types: &[DataType],
) -> Result<Vec<DataType>> {
    let what = format!("after {names} name(s), the function ({})", numbers.join(", "));
    let vector = vector_types(types.get(names..).unwrap_or_default(), N, &what)?;
    Ok([vec![DataType::Utf8; names], vector].concat())
}
