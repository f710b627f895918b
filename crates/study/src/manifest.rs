//! The manifest of an output folder: only the same run may resume in it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::StudyError;
use crate::run::Run;

/// Name of the manifest in the folder of the parts. Programs that read all parts of a folder pass
/// over names that start with an underscore: pyarrow, pandas, Spark and DataFusion.
const NAME: &str = "_study.json";

/// The run that wrote the parts of a folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    /// The fingerprint of robot, cell and options.
    study: String,
    /// The version of the library.
    version: String,
    query: String,
    /// Names and lengths of the files of the input.
    input: Vec<(String, u64)>,
    /// Rows per part; `None` if each input file is a part.
    block: Option<usize>,
    format: String,
}

impl Manifest {
    pub(crate) fn new(run: &Run<'_>) -> Self {
        let length = |file: &Path| std::fs::metadata(file).map_or(0, |m| m.len());
        let files = run.input.files().iter();
        let options = run.options;
        Self {
            study: run.study.fingerprint().into(),
            version: env!("CARGO_PKG_VERSION").into(),
            query: run.query.into(),
            input: files.map(|f| (f.display().to_string(), length(f))).collect(),
            block: options.scheduler.is_none().then_some(options.rows_per_part),
            format: options.format.extension().into(),
        }
    }

    /// Makes the folder, or checks that this run may resume in it.
    pub(crate) fn claim(&self, folder: &Path) -> Result<(), StudyError> {
        std::fs::create_dir_all(folder).map_err(StudyError::io(folder))?;
        let path = folder.join(NAME);
        if !path.exists() {
            let is_empty = std::fs::read_dir(folder)
                .map_err(StudyError::io(folder))?
                .next()
                .is_none();
            if !is_empty {
                let reason = format!("the folder is not empty, and has no {NAME} of an earlier run");
                return Err(StudyError::unfit(folder.display(), reason));
            }
            let text = serde_json::to_string_pretty(self)?;
            return std::fs::write(&path, text).map_err(StudyError::io(&path));
        }
        let text = std::fs::read_to_string(&path).map_err(StudyError::io(&path))?;
        let other: Self = serde_json::from_str(&text).map_err(|e| StudyError::unfit(path.display(), e))?;
        if *self == other {
            return Ok(());
        }
        let what = self.difference(&other);
        let reason = format!("the folder holds the parts of a run with {what}");
        Err(StudyError::unfit(folder.display(), reason))
    }

    fn difference(&self, other: &Self) -> &'static str {
        let differences = [
            (self.study != other.study, "another robot, cell or option"),
            (self.version != other.version, "another version"),
            (self.query != other.query, "another query"),
            (self.input != other.input, "another input"),
            (self.block != other.block, "parts of another size"),
        ];
        let first = differences.into_iter().find(|(is, _)| *is);
        first.map_or("another format", |(_, what)| what)
    }
}
