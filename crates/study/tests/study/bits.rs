//! The same bits for any number of partitions and any order of rows.

use std::path::Path;

use datafusion::arrow::array::{RecordBatch, UInt64Array};
use datafusion::arrow::compute::take_record_batch;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Format, Input, Run, RunOptions, RunProgress, StudyOptions, engine};

use crate::{block_on, scratch, study, values};

const ROWS: u64 = 6000;

/// The parts of a run over rows, all values.
fn run(folder: &Path, rows: &RecordBatch, partitions: usize, block: usize, format: Format) -> Vec<Vec<String>> {
    let study = study(StudyOptions::default());
    let (input, out) = (folder.join("in"), folder.join("out"));
    std::fs::create_dir_all(&input).expect("a folder");
    let file = input.join(format!("rows.{}", format.extension()));
    format
        .write(&rows.schema(), std::slice::from_ref(rows), &file)
        .expect("rows");
    let input = Input::new(&input).expect("rows");
    let query = "SELECT *, clearance(turn, lift, elbow, roll, bend, twist) AS c FROM configs";
    let options = RunOptions::default()
        .partitions(partitions)
        .rows_per_part(block)
        .format(format);
    let run = Run {
        study: &study,
        input: &input,
        query,
        folder: &out,
        options: &options,
    };
    let summary = block_on(run.go(&RunProgress::default())).expect("a run");
    assert_eq!(summary.rows, rows.num_rows() as u64);
    let read = async {
        let context = engine::local(&study, 1);
        Input::new(&out)
            .expect("parts")
            .read(&context)
            .await
            .expect("parts")
            .collect()
            .await
    };
    values(&block_on(read).expect("answers"))
}

fn rows() -> RecordBatch {
    let study = study(StudyOptions::default());
    Sampler::random(study.coordinates(), 3).rows(0..ROWS).expect("rows")
}

#[test]
fn partitions_change_no_bit() {
    let rows = rows();
    let one = run(&scratch("bits 1"), &rows, 1, 4096, Format::Parquet);
    assert_eq!(one.len() as u64, ROWS);
    for partitions in [2, 7, 64] {
        // Blocks of other sizes, too.
        let many = run(
            &scratch(&format!("bits {partitions}")),
            &rows,
            partitions,
            1000,
            Format::Parquet,
        );
        assert!(one == many, "{partitions} partitions");
    }
}

#[test]
fn formats_change_no_bit() {
    let rows = rows().slice(0, 1500);
    let parquet = run(&scratch("bits parquet"), &rows, 2, 1024, Format::Parquet);
    for format in [Format::Csv, Format::Arrow] {
        let other = run(
            &scratch(&format!("bits {}", format.extension())),
            &rows,
            2,
            1024,
            format,
        );
        assert!(parquet == other, "{format:?}");
    }
}

#[test]
fn the_order_of_rows_changes_no_bit() {
    let rows = rows();
    let mut straight = run(&scratch("bits straight"), &rows, 2, 4096, Format::Parquet);
    // A permutation in which neighbours are far apart.
    let order = UInt64Array::from_iter_values((0..ROWS).map(|k| k * 2657 % ROWS));
    let mixed = take_record_batch(&rows, &order).expect("rows");
    let mut mixed = run(&scratch("bits mixed"), &mixed, 2, 4096, Format::Parquet);
    assert!(straight != mixed, "the order is the same");
    straight.sort();
    mixed.sort();
    assert!(straight == mixed);
}
