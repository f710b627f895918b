//! `clearance(q..)`: returns the closest pair at a configuration.

use datafusion::arrow::array::ArrayRef;
use datafusion::error::Result;

use super::answers::{Kind, Value, structs};
use crate::error::RowError;
use crate::rows::{Vectors, configuration};
use crate::study::Study;

pub(super) const FIELDS: [(&str, Kind); 11] = [
    ("distance", Kind::Number),
    ("lower", Kind::Number),
    ("upper", Kind::Number),
    ("a", Kind::Word),
    ("b", Kind::Word),
    ("a_x", Kind::Number),
    ("a_y", Kind::Number),
    ("a_z", Kind::Number),
    ("b_x", Kind::Number),
    ("b_y", Kind::Number),
    ("b_z", Kind::Number),
];

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    structs(study, &FIELDS, rows, |checker, row, q| {
        configuration(&vectors, row, coordinates, q)?;
        checker.forget();
        let Some(near) = checker.clearance(q).map_err(RowError::refused)? else {
            return Ok([f64::INFINITY; 3].map(Value::Number).into());
        };
        let mut values: Vec<_> = [near.distance, near.lower, near.upper].map(Value::Number).into();
        values.extend([near.pair.a, near.pair.b].map(|part| Value::word(checker.name(part))));
        values.extend(near.witnesses.iter().flat_map(|p| [p.x, p.y, p.z].map(Value::Number)));
        Ok(values)
    })
}
