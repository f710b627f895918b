//! `signed_distance(body, x, y, z)`: measures a point and a body, by name, in the frame of the body.

use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny::nalgebra::Point3;
use lin_canny::{PointOutcome, PointQuery};

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use super::separation::body;
use crate::error::RowError;
use crate::rows::{Vectors, vector_types};
use crate::study::Study;

const FIELDS: [(&str, Kind); 11] = [
    ("state", Kind::Word),
    ("distance", Kind::Number),
    ("lower", Kind::Number),
    ("upper", Kind::Number),
    ("closest_x", Kind::Number),
    ("closest_y", Kind::Number),
    ("closest_z", Kind::Number),
    ("normal_x", Kind::Number),
    ("normal_y", Kind::Number),
    ("normal_z", Kind::Number),
    ("subshape", Kind::Number),
];

/// The numbers of a point.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Absolute values of coordinates are below it, as in [`PointQuery::closest_point`].
const FAR: f64 = 1e116;

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

pub(super) fn argument_types(types: &[DataType]) -> Result<Vec<DataType>> {
    let [_, point @ ..] = types else {
        return plan_err!("signed_distance takes a name and a point");
    };
    let mut all = vec![DataType::Utf8];
    all.extend(vector_types(
        point,
        AXES.len(),
        "the point of signed_distance (x, y, z)",
    )?);
    Ok(all)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (names, points) = (arguments[0].as_string::<i32>(), Vectors::new(&arguments[1..]));
    let (mut answers, mut numbers) = (Answers::new(fields(), rows), Vec::new());
    study
        .with_checker(|checker| {
            // The body of the row before.
            let mut last: Option<(&str, PointQuery<'_>)> = None;
            for row in 0..rows {
                numbers.clear();
                let mut ask = || -> Result<PointOutcome, RowError> {
                    let name = (!names.is_null(row)).then(|| names.value(row));
                    let query = match &last {
                        Some((known, query)) if Some(*known) == name => query,
                        _ => {
                            let query = PointQuery::new(body(checker, names, row, "body")?);
                            &last.insert((names.value(row), query)).1
                        }
                    };
                    let name = |k: Option<usize>| k.map_or("the point", |k| AXES[k]);
                    points.read(row, AXES.len(), name, &mut numbers)?;
                    closest(query, &numbers)
                };
                let found = ask();
                let Some(found) = study.settled(row, &numbers, found)? else {
                    answers.push(None);
                    continue;
                };
                let state = found.state.to_string();
                let bounds = [found.distance, found.lower, found.upper];
                let (p, n) = (found.point, found.normal);
                let subshape = f64::from(found.location.subshape);
                let rest = [p.x, p.y, p.z, n.x, n.y, n.z, subshape];
                let numbers = bounds.into_iter().chain(rest).map(Value::Number);
                let values: Vec<_> = std::iter::once(Value::Word(&state)).chain(numbers).collect();
                answers.push(Some(&values));
            }
            answers.finish()
        })
        .map_err(outside)?
}

/// Returns the closest point of a point with three coordinates.
fn closest(query: &PointQuery<'_>, point: &[f64]) -> Result<PointOutcome, RowError> {
    // Written so that NaN is out of range.
    if let Some(k) = (0..AXES.len()).find(|&k| !(point[k].abs() < FAR)) {
        let (name, value) = (AXES[k].into(), point[k]);
        let (lower, upper) = (-FAR, FAR);
        return Err(RowError::Limits {
            name,
            value,
            lower,
            upper,
        });
    }
    let found = query.closest_point(&Point3::from_slice(point));
    found.map_err(|e| RowError::Refused(e.to_string()))
}
