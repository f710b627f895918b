//! `signed_distance(body, x, y, z)`: measures a point and a body, by name, in the frame of the body.

use datafusion::arrow::array::{ArrayRef, AsArray};
use datafusion::arrow::datatypes::DataType;
use datafusion::error::Result;
use lin_canny::PointQuery;
use lin_canny::nalgebra::Point3;

use super::answers::{FieldList, Kind, number, structs, text};
use super::separation::body;
use crate::error::RowError;
use crate::rows::{Vectors, types_after_names, word};
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[
    (Kind::Word, "state"),
    (
        Kind::Number,
        "distance lower upper closest_x closest_y closest_z normal_x normal_y normal_z subshape",
    ),
];

/// The numbers of a point.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Absolute values of coordinates are below it, as in [`PointQuery::closest_point`].
const FAR: f64 = 1e116;

pub(super) fn argument_types(_: &Study, _: &str, types: &[DataType]) -> Result<Vec<DataType>> {
    types_after_names(1, AXES, types)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (names, points) = (arguments[0].as_string::<i32>(), Vectors::new(&arguments[1..]));
    // The body of the row before.
    let mut last: Option<(&str, PointQuery<'_>)> = None;
    structs(study, FIELDS, rows, |_, row, numbers| {
        let name = word(names, row, "body")?;
        let query = match &last {
            Some((known, query)) if *known == name => query,
            _ => &last.insert((name, PointQuery::new(body(study, names, row, "body")?))).1,
        };
        points.read(row, AXES.len(), |k| k.map_or("the point", |k| AXES[k]), numbers)?;
        // Written so that NaN is out of range.
        if let Some(k) = numbers.iter().position(|x| !(x.abs() < FAR)) {
            return Err(RowError::limits(AXES[k], numbers[k], [-FAR, FAR]));
        }
        let found = query
            .closest_point(&Point3::from_slice(numbers))
            .map_err(RowError::refused)?;
        let (p, n, subshape) = (found.point, found.normal, f64::from(found.location.subshape));
        let bounds = [found.distance, found.lower, found.upper];
        let mut values = vec![text(found.state)];
        values.extend(bounds.map(number));
        values.extend([p.x, p.y, p.z, n.x, n.y, n.z, subshape].map(number));
        Ok(values)
    })
}
