//! `certify_curve(p0, .., pn)`: proves a Bezier curve free, or returns the time and the pair that
//! collides.

use datafusion::arrow::array::{ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Field};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{JointCurve, JointMotion, PlanError};
use lin_canny_robot::Coordinate;
use std::sync::Arc;

use super::answers::structs;
use super::certify::{FIELDS, values};
use crate::error::RowError;
use crate::rows::{list_at, list_type, read_list};
use crate::study::Study;

/// Accepts one list per control point, or one list of such lists.
pub(super) fn argument_types(_: &Study, _: &str, types: &[DataType]) -> Result<Vec<DataType>> {
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

/// Returns the control points of a row, as lists.
fn control_points(arguments: &[ArrayRef], row: usize) -> Result<Vec<Option<ArrayRef>>, RowError> {
    match arguments {
        [one] if one.as_list::<i32>().value_type() == list_type() => {
            let points = list_at(one.as_list(), row).ok_or_else(|| RowError::null("the curve"))?;
            Ok(points.as_list::<i32>().iter().collect())
        }
        columns => Ok(columns.iter().map(|column| list_at(column.as_list(), row)).collect()),
    }
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let coordinates = study.coordinates();
    let name = |k: Option<usize>| k.map_or("the list", |k| coordinates[k].name.as_str());
    structs(study, FIELDS, rows, |checker, row, numbers| {
        for (number, point) in control_points(arguments, row)?.into_iter().enumerate() {
            let refused = |what: String| RowError::refused(format!("control point {number}: {what}"));
            let start = numbers.len();
            read_list(point, coordinates.len(), name, numbers).map_err(|error| refused(error.to_string()))?;
            if let Some((k, x)) = (0..).zip(&numbers[start..]).find(|(_, x)| !x.is_finite()) {
                let name = &coordinates[k].name;
                return Err(refused(format!("{name} is {x:?} (expected a finite number)")));
            }
        }
        let points: Vec<&[f64]> = numbers.chunks(coordinates.len().max(1)).collect();
        checker.reset();
        let verdict = JointCurve::bezier(&points).and_then(|curve| checker.certify(&JointMotion::curve(&curve)));
        let verdict = verdict.map_err(|error| match error {
            PlanError::CurveLimit {
                coordinate,
                time,
                value,
            } => {
                let Coordinate { name, limits, .. } = &coordinates[coordinate];
                RowError::limits(&format!("{name} at {time:?} of the curve"), value, *limits)
            }
            error => RowError::refused(error),
        })?;
        Ok(values(checker, &verdict))
    })
}
