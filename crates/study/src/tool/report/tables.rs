//! The content of the page, computed by queries.

use std::sync::Arc;

use datafusion::arrow::array::{Array, AsArray, RecordBatch};
use datafusion::arrow::compute::{cast, concat_batches};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::prelude::SessionContext;
use lin_canny_study::{ID, Study, StudyError, TABLE, quoted};

/// Bars of the histogram, and cells of the map along each joint.
const BARS: u32 = 60;
const CELLS: u32 = 48;

/// A row among the worst.
pub(super) struct WorstRow {
    /// The value of the column `id`, if there is one.
    pub(super) id: Option<String>,
    pub(super) configuration: Vec<f64>,
    pub(super) distance: f64,
    pub(super) lower: f64,
    pub(super) pair: [String; 2],
}

/// A pair, the number of rows in which it is the closest, and its least distance.
pub(super) struct PairCount {
    pub(super) pair: [String; 2],
    pub(super) rows: u64,
    pub(super) contacts: u64,
    pub(super) least: f64,
}

pub(super) struct Tables {
    pub(super) rows: u64,
    /// Rows without a result.
    pub(super) unanswered: u64,
    pub(super) contacts: u64,
    pub(super) least: f64,
    pub(super) greatest: f64,
    pub(super) mean: f64,
    /// Start of each bar with its count, and the width of a bar.
    pub(super) bars: Vec<(f64, f64)>,
    pub(super) width: f64,
    pub(super) pairs: Vec<PairCount>,
    pub(super) worst: Vec<WorstRow>,
    /// Cells of the map by column and row, with the share of their rows in contact.
    pub(super) map: Vec<(u32, u32, f64)>,
}

impl Tables {
    pub(super) const CELLS: u32 = CELLS;

    pub(super) async fn read(
        context: &SessionContext,
        study: &Arc<Study>,
        map: &[String],
        worst: usize,
    ) -> Result<Self, StudyError> {
        let query = Query { context };
        let whole = format!(
            "SELECT count(*), count(*) - count(distance), count(CASE WHEN distance <= 0 THEN 1 END), \
             coalesce(min(distance), 0), coalesce(max(distance), 0), coalesce(avg(distance), 0) FROM {TABLE} \
             WHERE distance IS NULL OR distance < 'Infinity'"
        );
        let whole = query.numbers(&whole).await?;
        let [rows, unanswered, contacts, least, greatest, mean] = whole.first().copied_array()?;
        let mut tables = Self {
            rows: rows as u64,
            unanswered: unanswered as u64,
            contacts: contacts as u64,
            least,
            greatest,
            mean,
            bars: Vec::new(),
            width: ((greatest - least) / f64::from(BARS)).max(f64::MIN_POSITIVE),
            pairs: query.pairs().await?,
            worst: query.worst(study, worst).await?,
            map: query.map(study, map).await?,
        };
        let bar = format!(
            "least({}, floor((distance - {least:e}) / {:e}))",
            BARS - 1,
            tables.width
        );
        let bars =
            format!("SELECT {bar} AS bar, count(*) FROM {TABLE} WHERE distance < 'Infinity' GROUP BY 1 ORDER BY 1");
        let start = |bar: f64| least + tables.width * bar;
        let bars = query.numbers(&bars).await?;
        tables.bars = bars.iter().map(|b| (start(b[0]), b[1])).collect();
        Ok(tables)
    }

    pub(super) fn headline(&self) -> String {
        let Self {
            contacts,
            least,
            mean,
            unanswered,
            ..
        } = self;
        format!("{contacts} in contact, {unanswered} without an answer; least {least:.6}, mean {mean:.6}")
    }
}

struct Query<'a> {
    context: &'a SessionContext,
}

impl Query<'_> {
    async fn rows(&self, text: &str) -> Result<RecordBatch, StudyError> {
        let frame = self.context.sql(text).await?;
        let schema = Arc::clone(frame.schema().inner());
        Ok(concat_batches(&schema, &frame.collect().await?)?)
    }

    /// Returns the rows of a query whose columns are numbers; NULL is NaN.
    async fn numbers(&self, text: &str) -> Result<Vec<Vec<f64>>, StudyError> {
        numbers(&self.rows(text).await?)
    }

    async fn pairs(&self) -> Result<Vec<PairCount>, StudyError> {
        let text = format!(
            "SELECT a, b, count(*) AS n, count(CASE WHEN distance <= 0 THEN 1 END), min(distance) FROM {TABLE} \
             WHERE a IS NOT NULL GROUP BY a, b ORDER BY n DESC, a, b"
        );
        let rows = self.rows(&text).await?;
        let (names, values) = (words(&rows, [0, 1])?, numbers(&rows.project(&[2, 3, 4])?)?);
        let pairs = names.into_iter().zip(values).map(|(pair, v)| PairCount {
            pair,
            rows: v[0] as u64,
            contacts: v[1] as u64,
            least: v[2],
        });
        Ok(pairs.collect())
    }

    async fn worst(&self, study: &Arc<Study>, count: usize) -> Result<Vec<WorstRow>, StudyError> {
        let columns = self.context.table(TABLE).await?;
        let has_id = columns.schema().has_column_with_unqualified_name(ID);
        let joints: Vec<_> = study.coordinates().iter().map(|c| quoted(&c.name)).collect();
        let text = format!(
            "SELECT a, b, {}, distance, lower, {} FROM {TABLE} WHERE distance < 'Infinity' ORDER BY distance, lower{} LIMIT {count}",
            if has_id {
                "CAST(id AS VARCHAR) AS row"
            } else {
                "'' AS row"
            },
            joints.join(", "),
            if has_id { ", id" } else { "" },
        );
        let rows = self.rows(&text).await?;
        let (names, ids) = (words(&rows, [0, 1])?, words(&rows, [2, 2])?);
        let all: Vec<usize> = (3..rows.num_columns()).collect();
        let values = numbers(&rows.project(&all)?)?;
        let worst = names
            .into_iter()
            .zip(ids)
            .zip(values)
            .map(|((pair, [id, _]), v)| WorstRow {
                id: has_id.then_some(id),
                distance: v[0],
                lower: v[1],
                configuration: v[2..].to_vec(),
                pair,
            });
        Ok(worst.collect())
    }

    /// Returns the share of rows in contact, by cells of two joints.
    async fn map(&self, study: &Arc<Study>, joints: &[String]) -> Result<Vec<(u32, u32, f64)>, StudyError> {
        let [x, y] = joints else { return Ok(Vec::new()) };
        let cell = |name: &String| {
            let limits = study.coordinates().iter().find(|c| c.name == *name).map(|c| c.limits);
            let [low, high] = limits.unwrap_or([0.0, 1.0]);
            let width = ((high - low) / f64::from(CELLS)).max(f64::MIN_POSITIVE);
            format!("least({}, floor(({} - {low:e}) / {width:e}))", CELLS - 1, quoted(name))
        };
        let text = format!(
            "SELECT {} AS i, {} AS j, avg(CASE WHEN distance <= 0 THEN 1.0 ELSE 0.0 END) FROM {TABLE} WHERE distance < 'Infinity' GROUP BY 1, 2",
            cell(x),
            cell(y)
        );
        let cells = self.numbers(&text).await?;
        Ok(cells.iter().map(|c| (c[0] as u32, c[1] as u32, c[2])).collect())
    }
}

fn numbers(rows: &RecordBatch) -> Result<Vec<Vec<f64>>, StudyError> {
    let columns = rows.columns().iter().map(|c| cast(c, &DataType::Float64));
    let columns: Vec<_> = columns.collect::<Result<_, _>>()?;
    let value = |column: &Arc<dyn Array>, row: usize| {
        let numbers = column.as_primitive::<Float64Type>();
        if numbers.is_null(row) {
            f64::NAN
        } else {
            numbers.value(row)
        }
    };
    let row = |row: usize| columns.iter().map(|c| value(c, row)).collect();
    Ok((0..rows.num_rows()).map(row).collect())
}

fn words(rows: &RecordBatch, columns: [usize; 2]) -> Result<Vec<[String; 2]>, StudyError> {
    let texts = columns.map(|k| cast(rows.column(k), &DataType::Utf8));
    let [a, b] = texts;
    let (a, b) = (a?, b?);
    let word = |column: &dyn Array, row: usize| column.as_string::<i32>().value(row).to_owned();
    Ok((0..rows.num_rows()).map(|row| [word(&a, row), word(&b, row)]).collect())
}

/// The first row of a query, as an array.
trait FirstRow {
    fn copied_array<const N: usize>(self) -> Result<[f64; N], StudyError>;
}

impl FirstRow for Option<&Vec<f64>> {
    fn copied_array<const N: usize>(self) -> Result<[f64; N], StudyError> {
        let row = self.and_then(|row| <[f64; N]>::try_from(row.as_slice()).ok());
        row.ok_or_else(|| StudyError::unfit("the run", "no rows"))
    }
}
