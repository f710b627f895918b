//! Files of configurations.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use datafusion::arrow::datatypes::{DataType, Field, Schema};
use datafusion::dataframe::DataFrame;
use datafusion::execution::options::ArrowReadOptions;
use datafusion::prelude::{CsvReadOptions, ParquetReadOptions, SessionContext};

use crate::error::StudyError;
use crate::format::Format;
use crate::study::Study;

/// The files of the rows of a study, in the order of their names.
#[derive(Clone, Debug)]
pub struct Input {
    files: Vec<PathBuf>,
    format: Format,
}

/// The name of the table of rows in a query.
pub const TABLE: &str = "configs";

/// The column by which rows are known, if there is one.
pub const ID: &str = "id";

/// The column of lists that may stand instead of a column for each coordinate.
const LIST: &str = "q";

impl Input {
    /// Returns the rows of a file, or of all files of one format in a folder.
    ///
    /// # Errors
    /// A path that is not there, a folder without files of rows or with files of two formats.
    pub fn new(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        let path = path.as_ref();
        // Executors look the files up from elsewhere.
        let path = std::fs::canonicalize(path).map_err(StudyError::io(path))?;
        let mut files = vec![path.clone()];
        if path.is_dir() {
            let entries = std::fs::read_dir(&path).map_err(StudyError::io(&path))?;
            files = entries
                .map(|e| e.map(|e| e.path()))
                .collect::<Result<_, _>>()
                .map_err(StudyError::io(&path))?;
            files.retain(|file| Format::of(file).is_some());
            files.sort();
        }
        let mut formats: Vec<_> = files.iter().filter_map(|f| Format::of(f)).collect();
        formats.dedup();
        match formats[..] {
            [format] => Ok(Self { files, format }),
            [] => Err(StudyError::unfit(
                path.display(),
                "no file that ends with .parquet, .csv or .arrow",
            )),
            _ => Err(StudyError::unfit(
                path.display(),
                "folder has files of several formats (expected one format)",
            )),
        }
    }

    /// Returns the files.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns the input of each file alone.
    pub fn each(&self) -> impl ExactSizeIterator<Item = Self> + '_ {
        let format = self.format;
        self.files.iter().map(move |file| Self {
            files: vec![file.clone()],
            format,
        })
    }

    /// Returns the rows. In a CSV file, all columns of numbers are read as such, however they
    /// begin.
    ///
    /// # Errors
    /// A file that the engine cannot read.
    pub async fn read(&self, context: &SessionContext) -> Result<DataFrame, StudyError> {
        let paths: Vec<String> = self.files.iter().map(|f| f.to_string_lossy().into_owned()).collect();
        let frame = match self.format {
            Format::Parquet => context.read_parquet(paths, ParquetReadOptions::default()).await,
            Format::Arrow => context.read_arrow(paths, ArrowReadOptions::default()).await,
            Format::Csv => {
                let guessed = context.read_csv(paths.clone(), CsvReadOptions::new()).await?;
                let numbers = |field: &Arc<Field>| match field.data_type() {
                    DataType::Int64 if field.name() != ID => field.as_ref().clone().with_data_type(DataType::Float64),
                    _ => field.as_ref().clone(),
                };
                let fields: Vec<_> = guessed.schema().fields().iter().map(numbers).collect();
                let schema = Schema::new(fields);
                context.read_csv(paths, CsvReadOptions::new().schema(&schema)).await
            }
        };
        Ok(frame?)
    }

    /// Returns the table that queries name.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub async fn register(&self, context: &SessionContext) -> Result<(), StudyError> {
        let rows = self.read(context).await?;
        context.deregister_table(TABLE)?;
        context.register_table(TABLE, rows.into_view())?;
        Ok(())
    }
}

/// A name as it stands in a query.
#[must_use]
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// Returns the arguments of a function by which a table gives a configuration: a column for each
/// coordinate, or the column `q` of lists.
///
/// # Errors
/// A table without them.
pub fn configuration_of(study: &Study, names: &[&str]) -> Result<String, StudyError> {
    let coordinates = study.coordinates();
    let missing = coordinates.iter().find(|c| !names.contains(&c.name.as_str()));
    match missing {
        None => {
            let columns: Vec<_> = coordinates.iter().map(|c| quoted(&c.name)).collect();
            Ok(columns.join(", "))
        }
        Some(_) if names.contains(&LIST) => Ok(quoted(LIST)),
        Some(coordinate) => Err(StudyError::unfit(
            "the input",
            format!(
                "there is no column {:?}; the columns are {}",
                coordinate.name,
                names.join(", ")
            ),
        )),
    }
}
