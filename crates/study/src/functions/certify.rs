//! `certify(from, to)`: proves a segment free, or returns the time and the pair that collides.

use datafusion::arrow::array::ArrayRef;
use datafusion::arrow::datatypes::{DataType, Fields};
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{Checker, JointTree, Verdict};

use super::answers::{Answers, Kind, Value, fields_of};
use super::outside;
use crate::error::RowError;
use crate::rows::{Vectors, configuration, vector_types};
use crate::study::Study;

const FIELDS: [(&str, Kind); 6] = [
    ("verdict", Kind::Word),
    ("safe", Kind::Number),
    ("t", Kind::Number),
    ("a", Kind::Word),
    ("b", Kind::Word),
    ("start_contacts", Kind::Word),
];

pub(super) fn fields() -> Fields {
    fields_of(&FIELDS)
}

/// Accepts two lists, or the numbers of both ends.
pub(super) fn argument_types(name: &str, types: &[DataType], count: usize) -> Result<Vec<DataType>> {
    if types.len() != 2 && types.len() != 2 * count {
        return plan_err!(
            "{name} has invalid arguments (expected two lists of {count} numbers, or {} numbers)",
            2 * count
        );
    }
    let (from, to) = types.split_at(types.len() / 2);
    let mut all = vector_types(from, count, &format!("the start of {name}"))?;
    all.extend(vector_types(to, count, &format!("the end of {name}"))?);
    Ok(all)
}

pub(super) fn answer(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let coordinates = study.coordinates();
    let (from, to) = arguments.split_at(arguments.len() / 2);
    let (from, to) = (Vectors::new(from), Vectors::new(to));
    let (mut answers, mut p, mut q) = (Answers::new(fields(), rows), Vec::new(), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                q.clear();
                let verdict = configuration(&from, row, coordinates, &mut p)
                    .and_then(|()| configuration(&to, row, coordinates, &mut q))
                    .and_then(|()| {
                        checker.forget();
                        checker.certify(&p, &q).map_err(|e| RowError::Refused(e.to_string()))
                    });
                let ends = [p.as_slice(), q.as_slice()].concat();
                let verdict = study.settled(row, &ends, verdict)?;
                push(&mut answers, checker, verdict);
            }
            answers.finish()
        })
        .map_err(outside)?
}

/// Adds a verdict, or NULL.
pub(super) fn push(answers: &mut Answers, checker: &Checker<JointTree>, verdict: Option<Verdict>) {
    let Some(verdict) = verdict else {
        answers.push(None);
        return;
    };
    let safe = Value::Number(verdict.safe());
    match verdict {
        Verdict::Free { start_contacts, .. } => {
            let pairs = start_contacts
                .iter()
                .map(|leaving| checker.show(&leaving.pair).to_string());
            let pairs = pairs.collect::<Vec<_>>().join(", ");
            let contacts = match pairs.as_str() {
                "" => Value::Null,
                pairs => Value::Word(pairs),
            };
            let [t, a, b] = [Value::Null, Value::Null, Value::Null];
            answers.push(Some(&[Value::Word("free"), safe, t, a, b, contacts]));
        }
        Verdict::Blocked { t, pair, .. } => {
            let [a, b] = [pair.a, pair.b].map(|part| Value::Word(checker.name(part)));
            answers.push(Some(&[Value::Word("blocked"), safe, Value::Number(t), a, b]));
        }
        _ => answers.push(Some(&[Value::Word("undecided"), safe])),
    }
}
