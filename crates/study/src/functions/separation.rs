//! `separation(a, b, pose)`: measures two bodies, by name, at a relative pose.

use datafusion::arrow::array::{Array, ArrayRef, AsArray, StringArray};
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, Geometry, PairTracker, RelativePose, normalize_rotation};
use lin_canny_plan::{Checker, JointTree};

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use crate::error::RowError;
use crate::rows::{Vectors, vector_types};
use crate::study::{Study, bodies_called};

const FIELDS: [(&str, Kind); 10] = [
    ("state", Kind::Word),
    ("distance", Kind::Number),
    ("lower", Kind::Number),
    ("upper", Kind::Number),
    ("a_x", Kind::Number),
    ("a_y", Kind::Number),
    ("a_z", Kind::Number),
    ("b_x", Kind::Number),
    ("b_y", Kind::Number),
    ("b_z", Kind::Number),
];

/// The numbers of a pose.
const POSE: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// Largest deviation of the norm of a quaternion from 1, as in files of cells.
const NORM: f64 = 1e-3;

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

pub(super) fn argument_types(types: &[DataType]) -> Result<Vec<DataType>> {
    let [_, _, pose @ ..] = types else {
        return plan_err!("separation takes two names and a pose");
    };
    let mut all = vec![DataType::Utf8; 2];
    all.extend(vector_types(
        pose,
        POSE.len(),
        "the pose of separation (x, y, z, qx, qy, qz, qw)",
    )?);
    Ok(all)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let names = [0, 1].map(|k| arguments[k].as_string::<i32>());
    let poses = Vectors::new(&arguments[2..]);
    let (mut answers, mut numbers) = (Answers::new(fields(), rows), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                numbers.clear();
                let found = separation(checker, names, &poses, row, &mut numbers);
                match study.settled(row, &numbers, found)? {
                    None => answers.push(None),
                    Some((state, numbers)) => {
                        let state = state.to_string();
                        let numbers = numbers.map(Value::Number).into_iter();
                        let values: Vec<_> = std::iter::once(Value::Word(&state)).chain(numbers).collect();
                        answers.push(Some(&values));
                    }
                }
            }
            answers.finish()
        })
        .map_err(outside)?
}

fn separation(
    checker: &Checker<JointTree>,
    names: [&StringArray; 2],
    poses: &Vectors,
    row: usize,
    numbers: &mut Vec<f64>,
) -> Result<(ContactState, [f64; 9]), RowError> {
    let [a, b] = names;
    let (a, b) = (body(checker, a, row, "a")?, body(checker, b, row, "b")?);
    let name = |k: Option<usize>| k.map_or("the pose", |k| POSE[k]);
    poses.read(row, POSE.len(), name, numbers)?;
    let pose = pose_of(numbers)?;
    let relative = RelativePose::from_isometry(&pose).map_err(|e| RowError::Refused(e.to_string()))?;
    // A new tracker, so that the result depends on the row alone.
    let found = PairTracker::new().closest(a, b, &relative);
    let is_known = found.state != ContactState::Overlapping || found.lower > f64::NEG_INFINITY;
    let distance = if is_known { found.distance } else { 0.0 };
    let (p, q) = (found.point_on_a, pose * found.point_on_b);
    Ok((
        found.state,
        [distance, found.lower, found.upper, p.x, p.y, p.z, q.x, q.y, q.z],
    ))
}

/// Returns the one body with the name in a row.
pub(super) fn body<'c>(
    checker: &'c Checker<JointTree>,
    names: &StringArray,
    row: usize,
    what: &str,
) -> Result<&'c Geometry, RowError> {
    if names.is_null(row) {
        return Err(RowError::Null { name: what.into() });
    }
    let (name, world) = (names.value(row), checker.world());
    let parts = bodies_called(checker, name);
    let only = parts.first().and_then(|&part| world.geometry(part));
    let (name, count) = (name.to_owned(), parts.len());
    only.filter(|_| count == 1).ok_or(RowError::Name { name, count })
}

fn pose_of(numbers: &[f64]) -> Result<Isometry3<f64>, RowError> {
    let &[x, y, z, i, j, k, w] = numbers else {
        let (name, found, needed) = ("the pose".into(), numbers.len(), POSE.len());
        return Err(RowError::Length { name, found, needed });
    };
    let quaternion = Quaternion::new(w, i, j, k);
    let norm = quaternion.norm();
    if !((norm - 1.0).abs() <= NORM) {
        let reason = format!("quaternion has norm {norm:?} (expected 1)");
        return Err(RowError::Refused(reason));
    }
    let turn = UnitQuaternion::new_normalize(quaternion);
    Ok(normalize_rotation(&Isometry3::from_parts(
        Translation3::new(x, y, z),
        turn,
    )))
}
