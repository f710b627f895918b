//! A run that was stopped goes on; a folder of another run is refused.

use lin_canny_study::StudyOptions;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Format, Input, Run, RunOptions, RunProgress, RunSummary, StudyError};

use crate::{block_on, scratch, study};

const QUERY: &str = "SELECT *, clearance(turn, lift, elbow, roll, bend, twist) AS c FROM configs";

struct Place {
    folder: std::path::PathBuf,
}

impl Place {
    /// Three files of 700 rows.
    fn new(name: &str) -> Self {
        let place = Self { folder: scratch(name) };
        let study = study(StudyOptions::default());
        let mut sampler = Sampler::halton(study.coordinates());
        for k in 0..3 {
            let rows = sampler.rows(700 * k..700 * (k + 1)).expect("rows");
            place.write(k, &rows);
        }
        place
    }

    fn write(&self, k: u64, rows: &datafusion::arrow::array::RecordBatch) {
        std::fs::create_dir_all(self.folder.join("in")).expect("a folder");
        let file = self.folder.join(format!("in/{k}.parquet"));
        let rows = std::slice::from_ref(rows);
        Format::Parquet.write(&rows[0].schema(), rows, &file).expect("rows");
    }

    fn run(&self, margin: f64, query: &str, block: usize) -> Result<RunSummary, StudyError> {
        let options = StudyOptions::default().margin(margin);
        let (study, input) = (study(options), Input::new(self.folder.join("in"))?);
        let options = RunOptions::default().partitions(2).rows_per_part(block);
        let run = Run {
            study: &study,
            input: &input,
            query,
            folder: &self.folder.join("out"),
            options: &options,
        };
        let before = study.rows();
        let done = block_on(run.go(&RunProgress::default()))?;
        // What was kept was not measured again.
        let kept = (0..done.parts).filter(|k| *k < done.kept).count();
        assert!(study.rows() - before <= done.rows - kept as u64 * 200, "{done:?}");
        Ok(done)
    }
}

#[test]
fn parts_that_are_there_are_kept() {
    let place = Place::new("kept");
    let first = place.run(0.0, QUERY, 400).expect("a run");
    // Blocks end with files: 400 and 300 rows of each.
    assert_eq!((first.rows, first.parts, first.kept), (2100, 6, 0));
    let part = |k: usize| place.folder.join(format!("out/part-{k:05}.parquet"));
    let bytes: Vec<_> = (0..6).map(|k| std::fs::read(part(k)).expect("a part")).collect();
    // A stop leaves whole parts, and one that is not finished.
    for k in [2, 5] {
        std::fs::remove_file(part(k)).expect("a part");
    }
    std::fs::write(place.folder.join("out/part-00002.parquet.unfinished"), "PAR1").expect("a file");
    let second = place.run(0.0, QUERY, 400).expect("a run");
    assert_eq!((second.rows, second.parts, second.kept), (2100, 6, 4));
    for (k, before) in bytes.iter().enumerate() {
        assert!(*before == std::fs::read(part(k)).expect("a part"), "part {k}");
    }
}

#[test]
fn another_run_is_refused() {
    let place = Place::new("refused");
    place.run(0.0, QUERY, 700).expect("a run");
    let refused = |margin: f64, query: &str, block: usize, reason: &str| {
        let error = place.run(margin, query, block).expect_err(reason).to_string();
        assert!(error.contains(reason), "{error}");
    };
    refused(0.1, QUERY, 700, "another robot, cell or option");
    refused(0.0, "SELECT * FROM configs", 700, "another query");
    refused(0.0, QUERY, 600, "parts of another size");
    let study = study(StudyOptions::default());
    place.write(3, &Sampler::halton(study.coordinates()).rows(0..10).expect("rows"));
    refused(0.0, QUERY, 700, "another input");
    std::fs::remove_file(place.folder.join("out/_study.json")).expect("a manifest");
    refused(0.0, QUERY, 700, "not empty");
}
