//! A grid of numbers, and its text with a row per line. The module `load` picks its reader.

use crate::error::Fault;
use crate::text;

/// A rectangle of finite numbers from a file, such as the heights of a terrain.
///
/// A file is one of these:
///
/// * npy: an array of two axes of numbers, in both byte orders, in C and Fortran order.
/// * Text: a row per line, all of the same length. White space, commas or semicolons are between
///   the numbers. Empty lines and lines that start with `#` are passed over.
///
/// ```
/// use lin_canny_formats::Grid;
///
/// let grid = Grid::parse(b"0 0 0\n0, 0.5, 0\n", "heights.txt")?;
/// assert_eq!((grid.rows, grid.columns), (2, 3));
/// assert_eq!(grid.values[4], 0.5);
/// # Ok::<(), lin_canny_formats::FormatError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Grid {
    /// Number of rows, at least 1.
    pub rows: usize,
    /// Number of columns, at least 1.
    pub columns: usize,
    /// The numbers, row by row; all are finite.
    pub values: Vec<f64>,
}

impl Grid {
    /// Returns the grid, or an error that names the first number that is not finite.
    pub(crate) fn checked(self) -> Result<Self, Fault> {
        let Some(at) = self.values.iter().position(|x| !x.is_finite()) else {
            return Ok(self);
        };
        let (row, column) = (at / self.columns, at % self.columns);
        let why = format!("number [{row}][{column}] is not finite: {:?}", self.values[at]);
        Err(Fault::malformed(None, why))
    }
}

/// Reads a text with a row per line.
pub(crate) fn read_text(bytes: &[u8]) -> Result<Grid, Fault> {
    let text = text::decode(bytes);
    let mut grid = Grid {
        rows: 0,
        columns: 0,
        values: Vec::new(),
    };
    for (at, line) in text::lines(&text) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let before = grid.values.len();
        for word in line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty()) {
            let number = text::number(word).ok_or_else(|| {
                let column = grid.values.len() - before;
                let why = format!(
                    "number [{}][{column}] is {} (expected a finite number)",
                    grid.rows,
                    text::quoted(word)
                );
                Fault::malformed(at, why)
            })?;
            grid.values.push(number);
        }
        let columns = grid.values.len() - before;
        if grid.rows > 0 && columns != grid.columns {
            let why = format!("row {} has {columns} numbers (expected {})", grid.rows, grid.columns);
            return Err(Fault::malformed(at, why));
        }
        grid.columns = columns;
        grid.rows += 1;
    }
    match grid.values.is_empty() {
        true => Err(Fault::malformed(None, "the file contains no number")),
        false => Ok(grid),
    }
}
