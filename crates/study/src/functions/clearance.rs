//! `clearance(q..)`: returns the closest pair at a configuration.

use datafusion::arrow::array::ArrayRef;
use datafusion::arrow::datatypes::Fields;
use datafusion::error::Result;

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use crate::error::RowError;
use crate::rows::{Vectors, configuration};
use crate::study::Study;

const FIELDS: [(&str, Kind); 11] = [
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

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    let (mut answers, mut q) = (Answers::new(fields(), rows), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                let found = configuration(&vectors, row, coordinates, &mut q).and_then(|()| {
                    checker.forget();
                    checker.clearance(&q).map_err(|e| RowError::Refused(e.to_string()))
                });
                let Some(near) = study.settled(row, &q, found)? else {
                    answers.push(None);
                    continue;
                };
                let Some(near) = near else {
                    answers.push(Some(&[f64::INFINITY; 3].map(Value::Number)));
                    continue;
                };
                let [a, b] = [near.pair.a, near.pair.b].map(|part| Value::Word(checker.name(part)));
                let [p, q] = near.witnesses.map(|p| [p.x, p.y, p.z].map(Value::Number));
                let [d, l, u] = [near.distance, near.lower, near.upper].map(Value::Number);
                let values: Vec<_> = [d, l, u, a, b].into_iter().chain(p).chain(q).collect();
                answers.push(Some(&values));
            }
            answers.finish()
        })
        .map_err(outside)?
}
