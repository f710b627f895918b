//! `clearance(q..)`: returns the closest pair at a configuration.

use datafusion::arrow::array::ArrayRef;
use datafusion::error::Result;

use super::answers::{FieldList, Kind, number, structs, text};
use crate::error::RowError;
use crate::rows::{Vectors, configuration};
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[
    (Kind::Number, "distance lower upper"),
    (Kind::Word, "a b"),
    (Kind::Number, "a_x a_y a_z b_x b_y b_z"),
];

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    structs(study, FIELDS, rows, |checker, row, q| {
        configuration(&vectors, row, coordinates, q)?;
        checker.reset();
        let Some(near) = checker.clearance(q).map_err(RowError::refused)? else {
            return Ok([f64::INFINITY; 3].map(number).into());
        };
        let mut values: Vec<_> = [near.distance, near.lower, near.upper].map(number).into();
        values.extend([near.pair.a, near.pair.b].map(|part| text(checker.name(part))));
        values.extend(near.witnesses.iter().flat_map(|p| [p.x, p.y, p.z].map(number)));
        Ok(values)
    })
}
