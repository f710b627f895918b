//! Promises: a row's answer is a function of the row alone, bit for bit, whatever runs it; bad rows are named; what was done
//! before a stop is kept.

mod bits;
mod cells;
mod cluster;
mod functions;
mod graph;
mod points_and_curves;
mod resumed;
mod tool;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use datafusion::arrow::array::{AsArray, RecordBatch};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use lin_canny_study::robot::RobotFiles;
use lin_canny_study::{Study, StudyError, StudyOptions};

/// The robot and the cell of the examples.
fn example(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../robot/examples")
        .join(name);
    file.to_string_lossy().into_owned()
}

fn files() -> RobotFiles {
    let mut files = RobotFiles::new(example("six_axis.urdf"));
    files.cell = Some(example("six_axis_cell.json").into());
    files.srdf = Some(example("six_axis.srdf").into());
    files
}

fn load(files: &RobotFiles, options: StudyOptions) -> Result<Arc<Study>, StudyError> {
    Study::new(files.load()?.cell, options)
}

fn study(options: StudyOptions) -> Arc<Study> {
    load(&files(), options).expect("the example")
}

/// A new folder of this test run.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Arguments of the robot and the cell for the tool.
fn robot() -> Vec<String> {
    let [robot, cell, srdf] = ["six_axis.urdf", "six_axis_cell.json", "six_axis.srdf"].map(example);
    [robot, "--cell".into(), cell, "--srdf".into(), srdf].into()
}

fn tool(command: &str) -> Command {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny-study"));
    tool.arg(command).args(robot());
    tool
}

/// Runs the tool; returns its exit code and all that it says.
fn said(command: &mut Command) -> (i32, String) {
    let Output { status, stdout, stderr } = command.output().expect("the tool runs");
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.code().expect("an exit code"), text)
}

/// Every value of rows as text, numbers by their bits.
fn values(batches: &[RecordBatch]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for batch in batches {
        for row in 0..batch.num_rows() {
            let value = |column: &Arc<dyn datafusion::arrow::array::Array>| match column.data_type() {
                DataType::Float64 if column.is_valid(row) => {
                    format!("{:016x}", column.as_primitive::<Float64Type>().value(row).to_bits())
                }
                _ => datafusion::arrow::util::display::array_value_to_string(column, row).expect("a value"),
            };
            rows.push(batch.columns().iter().map(value).collect());
        }
    }
    rows
}

fn block_on<T>(future: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build();
    runtime.expect("a runtime").block_on(future)
}
