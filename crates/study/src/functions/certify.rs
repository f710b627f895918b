//! `certify(from, to)`: proves a segment free, or returns the time and the pair that collides.

use datafusion::arrow::array::ArrayRef;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::ScalarValue;
use datafusion::common::plan_err;
use datafusion::error::Result;
use lin_canny_plan::{Checker, JointMotion, JointTree, Verdict};

use super::answers::{FieldList, Kind, number, structs, text};
use crate::error::RowError;
use crate::rows::{Ends, vector_types};
use crate::study::Study;

pub(super) const FIELDS: &FieldList = &[
    (Kind::Word, "verdict"),
    (Kind::Number, "safe t"),
    (Kind::Word, "a b start_contacts"),
];

/// Accepts two lists, or the numbers of both ends.
pub(super) fn argument_types(study: &Study, name: &str, types: &[DataType]) -> Result<Vec<DataType>> {
    let count = study.coordinates().len();
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
    let (ends, coordinates) = (Ends::new(arguments), study.coordinates());
    structs(study, FIELDS, rows, |checker, row, numbers| {
        let [from, to] = ends.read(row, coordinates, numbers)?;
        checker.reset();
        let verdict = checker
            .certify(&JointMotion::segment(from, to))
            .map_err(RowError::refused)?;
        Ok(values(checker, &verdict))
    })
}

/// Returns the fields of a verdict.
pub(super) fn values(checker: &Checker<JointTree>, verdict: &Verdict) -> Vec<ScalarValue> {
    let (name, safe) = (text(verdict.name()), number(verdict.free_until()));
    let mut fields = match verdict {
        Verdict::Blocked { contact_at, pair, .. } => {
            let [a, b] = [pair.a, pair.b].map(|part| text(checker.name(part)));
            vec![name, safe, number(*contact_at), a, b]
        }
        _ => vec![name, safe],
    };
    let leaving = verdict.start_contacts().iter();
    let pairs: Vec<String> = leaving.map(|leaving| checker.show(&leaving.pair).to_string()).collect();
    if !pairs.is_empty() {
        fields.resize(5, ScalarValue::Null);
        fields.push(text(pairs.join(", ")));
    }
    fields
}
