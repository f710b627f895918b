//! `certify_curve(p0, .., pn)`: proves a Bezier curve free, or returns the time and the pair that
//! collides.

use datafusion::arrow::array::{Array, ArrayRef, AsArray, ListArray};
use datafusion::arrow::datatypes::{DataType, Field};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{JointCurve, JointMotion, PlanError};
use lin_canny_robot::Coordinate;
use std::sync::Arc;

use super::answers::structs;
use super::certify::{FIELDS, values};
use crate::error::RowError;
use crate::rows::{Vectors, list_type};
use crate::study::Study;

/// Accepts one list per control point, or one list of such lists.
pub(super) fn argument_types(types: &[DataType]) -> Result<Vec<DataType>> {
    let inner = |of: &DataType| match of {
        DataType::List(field) | DataType::LargeList(field) | DataType::FixedSizeList(field, _) => {
            Some(field.data_type().clone())
        }
        _ => None,
    };
    let all: Option<Vec<DataType>> = types.iter().map(inner).collect();
    match all.as_deref() {
        Some([list]) if inner(list).is_some() => {
            let field = Field::new_list_field(list_type(), true);
            Ok(vec![DataType::List(Arc::new(field))])
        }
        Some(lists) if !lists.is_empty() && lists.iter().all(|of| inner(of).is_none()) => {
            Ok(vec![list_type(); lists.len()])
        }
        _ => plan_err!("certify_curve takes control points as lists of numbers, or one list of such lists"),
    }
}

/// The control points of each row.
enum Curves {
    /// A column for each control point.
    Columns(Vec<Vectors>),
    /// A column of lists of control points.
    Lists(ListArray),
}

impl Curves {
    fn new(arguments: &[ArrayRef]) -> Self {
        match arguments {
            [one] if one.as_list::<i32>().value_type() == list_type() => Self::Lists(one.as_list().clone()),
            columns => Self::Columns(columns.iter().map(|c| Vectors::new(std::slice::from_ref(c))).collect()),
        }
    }

    /// Reads the control points of a row, one after the other.
    fn read(&self, row: usize, coordinates: &[Coordinate], all: &mut Vec<f64>) -> Result<(), RowError> {
        match self {
            Self::Columns(columns) => {
                let mut points = columns.iter().enumerate();
                points.try_for_each(|(k, column)| control_point(column, row, k, coordinates, all))
            }
            Self::Lists(lists) if lists.is_null(row) => Err(RowError::null("the curve")),
            Self::Lists(lists) => {
                let points = lists.value(row);
                let count = points.len();
                let points = Vectors::new(&[points]);
                (0..count).try_for_each(|k| control_point(&points, k, k, coordinates, all))
            }
        }
    }
}

/// Adds a control point, the one of a row of vectors.
fn control_point(
    vectors: &Vectors,
    row: usize,
    number: usize,
    coordinates: &[Coordinate],
    all: &mut Vec<f64>,
) -> Result<(), RowError> {
    let name = |k: Option<usize>| k.map_or("the list", |k| coordinates[k].name.as_str());
    let refused = |what: String| RowError::refused(format!("control point {number}: {what}"));
    let start = all.len();
    let read = vectors.read(row, coordinates.len(), name, all);
    read.map_err(|error| refused(error.to_string()))?;
    match all[start..].iter().zip(coordinates).find(|(x, _)| !x.is_finite()) {
        None => Ok(()),
        Some((x, Coordinate { name, .. })) => Err(refused(format!("{name} is {x:?} (expected a finite number)"))),
    }
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (curves, coordinates) = (Curves::new(arguments), study.coordinates());
    structs(study, &FIELDS, rows, |checker, row, numbers| {
        curves.read(row, coordinates, numbers)?;
        let points: Vec<&[f64]> = numbers.chunks(coordinates.len().max(1)).collect();
        checker.forget();
        let verdict = JointCurve::bezier(&points).and_then(|curve| checker.certify(&JointMotion::curve(&curve)));
        let verdict = verdict.map_err(|error| match error {
            PlanError::CurveLimit {
                coordinate,
                time,
                value,
            } => {
                let Coordinate { name, limits, .. } = &coordinates[coordinate];
                RowError::limits(format!("{name} at {time:?} of the curve"), value, *limits)
            }
            error => RowError::refused(error),
        })?;
        Ok(values(checker, &verdict))
    })
}
