//! `separation(a, b, pose)`: measures two bodies, by name, at a relative pose.

use datafusion::arrow::array::{ArrayRef, AsArray, StringArray};
use datafusion::arrow::datatypes::DataType;
use datafusion::error::Result;
use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, Geometry, PairTracker, RelativePose, normalize_rotation};

use super::answers::{FieldList, Kind, number, structs, text};
use crate::error::RowError;
use crate::rows::{Vectors, types_after_names, word};
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[
    (Kind::Word, "state"),
    (Kind::Number, "distance lower upper a_x a_y a_z b_x b_y b_z"),
];

/// The numbers of a pose.
const POSE: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// Largest deviation of the norm of a quaternion from 1, as in files of cells.
const NORM: f64 = 1e-3;

pub(super) fn argument_types(_: &Study, _: &str, types: &[DataType]) -> Result<Vec<DataType>> {
    types_after_names(2, POSE, types)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let names = [0, 1].map(|k| arguments[k].as_string::<i32>());
    let poses = Vectors::new(&arguments[2..]);
    structs(study, FIELDS, rows, |_, row, numbers| {
        let (a, b) = (body(study, names[0], row, "a")?, body(study, names[1], row, "b")?);
        poses.read(row, POSE.len(), |k| k.map_or("the pose", |k| POSE[k]), numbers)?;
        let pose = pose_of(numbers)?;
        let relative = RelativePose::from_isometry(&pose).map_err(RowError::refused)?;
        // A new tracker, so that the result depends on the row alone.
        let found = PairTracker::new().closest(a, b, &relative);
        let is_known = found.state != ContactState::Overlapping || found.lower > f64::NEG_INFINITY;
        let distance = if is_known { found.distance } else { 0.0 };
        let (p, q) = (found.point_on_a, pose * found.point_on_b);
        let numbers = [distance, found.lower, found.upper, p.x, p.y, p.z, q.x, q.y, q.z];
        let mut values = vec![text(found.state)];
        values.extend(numbers.map(number));
        Ok(values)
    })
}

/// Returns the one body with the name in a row.
pub(super) fn body<'s>(
    study: &'s Study,
    names: &StringArray,
    row: usize,
    what: &str,
) -> Result<&'s Geometry, RowError> {
    let (name, cell) = (word(names, row, what)?, study.cell());
    let mut bodies = cell.bodies().filter(|(_, of_body)| *of_body == name);
    match (bodies.next().and_then(|(id, _)| cell.geometry(id)), bodies.count()) {
        (Some(only), 0) => Ok(only),
        (first, more) => {
            let count = usize::from(first.is_some()) + more;
            let error = format!("{count} bodies have the name {name:?} (expected 1)");
            Err(RowError::refused(error))
        }
    }
}

fn pose_of(numbers: &[f64]) -> Result<Isometry3<f64>, RowError> {
    let quaternion = Quaternion::new(numbers[6], numbers[3], numbers[4], numbers[5]);
    let norm = quaternion.norm();
    if !((norm - 1.0).abs() <= NORM) {
        return Err(RowError::refused(format!("quaternion has norm {norm:?} (expected 1)")));
    }
    let rotation = UnitQuaternion::new_normalize(quaternion);
    let translation = Translation3::new(numbers[0], numbers[1], numbers[2]);
    Ok(normalize_rotation(&Isometry3::from_parts(translation, rotation)))
}
