//! Files of rows as Parquet, CSV or Arrow IPC.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::ValueEnum;
use datafusion::arrow::array::{Array, ArrayRef, AsArray, RecordBatch, new_null_array};
use datafusion::arrow::compute::nullif;
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Schema, SchemaRef};
use datafusion::arrow::{csv, ipc};
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::basic::{Compression, ZstdLevel};
use datafusion::parquet::file::properties::WriterProperties;
use datafusion::parquet::schema::types::ColumnPath;

use crate::error::StudyError;

/// The format of a file of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[non_exhaustive]
pub enum Format {
    /// Apache Parquet
    Parquet,
    /// CSV with a header line
    Csv,
    /// Arrow IPC
    Arrow,
}

impl Format {
    /// Returns the file extension of the format.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::Csv => "csv",
            Self::Arrow => "arrow",
        }
    }

    /// Returns the format of a file, from its extension.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ends = |format: &Self| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case(format.extension()))
        };
        Self::value_variants().iter().copied().find(ends)
    }

    /// Writes rows to a file atomically: the file is complete or does not exist.
    ///
    /// Fields of structs are written as columns, see [`flat`].
    ///
    /// # Errors
    /// Returns an error if the file cannot be written or the format does not support a column.
    pub fn write(self, schema: &SchemaRef, batches: &[RecordBatch], path: &Path) -> Result<(), StudyError> {
        self.write_grouped(schema, batches, path, ROW_GROUP)
    }

    /// Writes rows as [`write`](Self::write) does, with at most `rows_per_group` rows in a row group
    /// of a Parquet file. A cluster divides a file by its row groups.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_grouped(
        self,
        schema: &SchemaRef,
        batches: &[RecordBatch],
        path: &Path,
        rows_per_group: usize,
    ) -> Result<(), StudyError> {
        let batches: Vec<_> = batches.iter().map(flat).collect::<Result<_, _>>()?;
        let schema = match batches.first() {
            Some(batch) => batch.schema(),
            None => flat(&RecordBatch::new_empty(Arc::clone(schema)))?.schema(),
        };
        let unfinished = unfinished(path);
        let file = File::create(&unfinished).map_err(StudyError::io(&unfinished))?;
        self.write_to(file, &schema, &batches, rows_per_group)
            .map_err(|e| StudyError::unfit(path.display(), e))?;
        std::fs::rename(&unfinished, path).map_err(StudyError::io(path))
    }

    fn write_to(self, file: File, schema: &SchemaRef, batches: &[RecordBatch], group: usize) -> Result<(), StudyError> {
        let file = match self {
            Self::Parquet => {
                let level = ZstdLevel::try_new(1).unwrap_or_default();
                let mut properties = WriterProperties::builder().set_compression(Compression::ZSTD(level));
                // Distances are nearly all different, so a dictionary saves nothing.
                for field in schema.fields().iter().filter(|f| f.data_type().is_floating()) {
                    let column = ColumnPath::from(field.name().as_str());
                    properties = properties.set_column_dictionary_enabled(column, false);
                }
                // Readers divide a file by its row groups.
                let properties = properties.set_max_row_group_row_count(Some(group.max(1))).build();
                let mut writer = ArrowWriter::try_new(file, Arc::clone(schema), Some(properties)).map_err(parquet)?;
                for batch in batches {
                    writer.write(batch).map_err(parquet)?;
                }
                writer.into_inner().map_err(parquet)?
            }
            Self::Csv => {
                let mut writer = csv::Writer::new(file);
                if batches.is_empty() {
                    writer.write(&RecordBatch::new_empty(Arc::clone(schema)))?;
                }
                for batch in batches {
                    writer.write(batch)?;
                }
                writer.into_inner()
            }
            Self::Arrow => {
                let mut writer = ipc::writer::FileWriter::try_new(file, schema)?;
                for batch in batches {
                    writer.write(batch)?;
                }
                writer.finish()?;
                writer.into_inner()?
            }
        };
        let whole = |mut file: File| file.flush().and_then(|()| file.sync_all());
        whole(file).map_err(StudyError::io(""))
    }
}

/// Rows per row group of a Parquet file.
const ROW_GROUP: usize = 16_384;

fn parquet(error: datafusion::parquet::errors::ParquetError) -> StudyError {
    StudyError::Engine(error.into())
}

/// Returns the name of a file while it is written.
fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".unfinished");
    path.with_file_name(name)
}

/// Returns rows with the fields of all structs as columns.
///
/// A column has the name of its field, or `column_field` if that name is in use. If a row has no
/// struct, its fields are NULL.
///
/// # Errors
/// Returns no error for rows of the engine.
pub fn flat(batch: &RecordBatch) -> Result<RecordBatch, StudyError> {
    let mut columns: Vec<(FieldRef, ArrayRef)> = Vec::new();
    let schema = batch.schema();
    for (field, column) in schema.fields().iter().zip(batch.columns()) {
        let DataType::Struct(fields) = field.data_type() else {
            columns.push((Arc::clone(field), Arc::clone(column)));
            continue;
        };
        let parts = column.as_struct();
        for (part, values) in fields.iter().zip(parts.columns()) {
            let is_taken = |name: &str| {
                let before = columns.iter().any(|(f, _)| f.name() == name);
                before || schema.fields().iter().any(|f| f.name() == name)
            };
            let name = match is_taken(part.name()) {
                true => format!("{}_{}", field.name(), part.name()),
                false => part.name().clone(),
            };
            let part = Field::new(name, part.data_type().clone(), true);
            columns.push((Arc::new(part), known(values, parts)?));
        }
    }
    let (fields, columns): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    Ok(RecordBatch::try_new(Arc::new(Schema::new(fields)), columns)?)
}

/// Returns the values of a field, with NULL where the struct is NULL.
fn known(values: &ArrayRef, parts: &dyn Array) -> Result<ArrayRef, StudyError> {
    if parts.null_count() == parts.len() {
        return Ok(new_null_array(values.data_type(), parts.len()));
    }
    let is_null = datafusion::arrow::compute::is_null(parts)?;
    Ok(nullif(values, &is_null)?)
}
