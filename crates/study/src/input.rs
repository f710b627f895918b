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

/// The input files of a study, in the order of their names.
#[derive(Clone, Debug)]
pub struct Input {
    files: Vec<PathBuf>,
    format: Format,
}

/// The name of the table of rows in a query.
pub const TABLE: &str = "configs";

/// Name of the optional column that identifies rows.
pub const ID: &str = "id";

/// Name of the column of lists that may replace the columns of the coordinates.
const LIST: &str = "q";

impl Input {
    /// Returns the rows of a file, or of all files of one format in a folder.
    ///
    /// # Errors
    /// Returns an error if the path does not exist, or if a folder has no files of rows or files of
    /// two formats.
    pub fn new(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        let path = path.as_ref();
        // Executors have another working folder.
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

    /// Returns the rows.
    ///
    /// In a CSV file, a column that starts with integers is read as floating-point numbers, except `id`.
    ///
    /// # Errors
    /// Returns an error if the engine cannot read a file.
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

    /// Registers the rows as the table [`TABLE`].
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

/// Returns a column name, quoted for a query.
#[must_use]
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// Returns the function arguments for the configuration of a row.
///
/// They are one column per coordinate, or the column `q` of lists.
///
/// # Errors
/// Returns an error if the table has neither.
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
