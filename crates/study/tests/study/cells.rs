//! Cells of an audit: their rows together have the verdicts of the audit, bit for bit on any number of partitions.

use std::ops::ControlFlow;
use std::sync::Arc;

use datafusion::arrow::array::RecordBatch;
use lin_canny_plan::{Checker, RangeOptions};
use lin_canny_robot::{AuditVerdict, audit};
use lin_canny_study::robot::RobotFiles;
use lin_canny_study::{Study, StudyError, StudyOptions, audited, engine, flat};

use crate::{block_on, example, said, scratch, tool, values};

/// The robot of the examples alone: few pairs.
fn robot() -> Arc<Study> {
    crate::load(&RobotFiles::new(example("six_axis.urdf")), StudyOptions::default()).expect("the example")
}

/// The answer to a query over cells.
fn asked(
    study: &Arc<Study>,
    cells: RecordBatch,
    partitions: usize,
    query: &str,
) -> Result<Vec<RecordBatch>, StudyError> {
    block_on(async {
        let context = engine::local(study, partitions);
        context.register_batch("configs", cells)?;
        let answers = context.sql(query).await?.collect().await?;
        answers.iter().map(flat).collect()
    })
}

const PROOFS: &str = "SELECT a, b, prove_pair(a, b, low, high, 200) AS proof FROM configs";

#[test]
fn cells_have_together_the_verdicts_of_an_audit() {
    let study = robot();
    let cells = audited::cells(&study, 4).expect("cells");
    let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
    let options = RangeOptions::default().cells(200);
    let all = audit(&mut checker, &options, &[], &mut |_| ControlFlow::Continue(())).expect("an audit");
    assert!(cells.num_rows() > all.len(), "{} cells", cells.num_rows());
    let proofs = asked(&study, cells.clone(), 1, PROOFS).expect("proofs");
    let again = asked(&study, cells, 7, PROOFS).expect("proofs");
    assert_eq!(values(&proofs), values(&again));
    let table = datafusion::arrow::compute::concat_batches(&proofs[0].schema(), &proofs).expect("a table");
    let query = format!("SELECT a, b, verdict FROM ({}) ORDER BY a, b", audited::VERDICTS);
    let found = values(&asked(&study, table, 2, &query).expect("verdicts"));
    assert_eq!(found.len(), all.len());
    // Each cell has a budget of its own, so together they may decide what the audit leaves open.
    let decided: Vec<_> = all.iter().filter(|one| one.verdict != AuditVerdict::Open).collect();
    // Base and shoulder, forearm and first wrist touch without depth.
    assert_eq!(all.len() - decided.len(), 2);
    for one in decided {
        let row = [&one.names[..], &[one.verdict.to_string()]].concat();
        assert!(found.contains(&row), "{row:?} {found:?}");
    }
}

#[test]
fn a_row_that_is_no_cell_is_named() {
    let study = robot();
    let zero = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";
    for (arguments, part) in [
        (format!("'base', 'grippr', {zero}, {zero}"), "nearest: \"gripper\""),
        (format!("'base', NULL, {zero}, {zero}"), "b is NULL"),
        (
            format!("'base', 'gripper', {zero}, [0.0, 0.0]"),
            "has 2 values (expected 6)",
        ),
        (
            format!("'base', 'gripper', {zero}, [100.0, 0.0, 0.0, 0.0, 0.0, 0.0]"),
            "turn is 100.0",
        ),
        (
            format!("'base', 'gripper', {zero}, [-0.1, 0.0, 0.0, 0.0, 0.0, 0.0]"),
            "0",
        ),
        (format!("'base', 'gripper', {zero}, {zero}, -1"), "cells is -1"),
        (format!("'base', 'gripper', {zero}, {zero}, 10, 1.0"), "width is 1.0"),
        (format!("'base', 'gripper', {zero}"), "prove_pair takes two names"),
        (format!("'base', 'gripper', {zero}, {zero}, 1, 0.1, 2"), "7 arguments"),
    ] {
        let cells = audited::cells(&study, 1).expect("cells");
        let query = format!("SELECT prove_pair({arguments}) FROM configs");
        let error = asked(&study, cells, 1, &query).expect_err(&query).to_string();
        assert!(error.contains(part), "{query}: {error}");
    }
}

#[test]
fn three_commands_make_an_audit() {
    let folder = scratch("audit");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let run = |command: &str, arguments: &[&str]| {
        let mut command = tool(command);
        let (code, text) = said(command.args(arguments));
        assert_eq!(code, 0, "{text}");
        text
    };
    let text = run(
        "cells",
        &["--cells", "2", "--rows-per-file", "100", "--out", &at("cells")],
    );
    assert!(text.contains(" cells in "), "{text}");
    let select = "prove_pair(a, b, low, high, 20) AS proof";
    run(
        "run",
        &["--in", &at("cells"), "--out", &at("proofs"), "--select", select],
    );
    let verdicts = [
        "--in",
        &at("proofs"),
        "--out",
        &at("pairs"),
        "--format",
        "csv",
        "--sql",
        audited::VERDICTS,
    ];
    run("run", &verdicts);
    let pairs = std::fs::read_to_string(at("pairs/result.csv")).expect("a table");
    assert!(pairs.starts_with("a,b,verdict,lower,upper,cells\n"), "{pairs:.200}");
    assert!(
        pairs
            .lines()
            .any(|line| line.starts_with("base,") && line.contains(",never,")),
        "{pairs}"
    );
}
