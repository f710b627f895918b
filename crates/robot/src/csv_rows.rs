//! Rows of CSV files, with the lines of their first letters.

use std::io::{Chain, Read as _};
use std::path::Path;

use crate::error::{FileError, FileErrorKind};
use crate::text::check_content;

/// The rows of a CSV text after the header, whose fields are trimmed. Comments start with `#`.
pub(crate) struct Records<'a> {
    path: &'a Path,
    lines: Lines<'a>,
    records: csv::StringRecordsIntoIter<Chain<&'a [u8], &'static [u8]>>,
    /// The names of the columns, and their line.
    pub(crate) names: Vec<String>,
    pub(crate) line: u32,
}

impl<'a> Records<'a> {
    /// Reads the header. Errors name the file `path`.
    pub(crate) fn new(text: &'a str, path: &'a Path) -> Result<Self, FileError> {
        check_content(text).map_err(|reason| FileError::new(path, Some(1), "", reason))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = Lines::new(text);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            // A comment in the last line without an end would be a record.
            .from_reader(text.as_bytes().chain(&b"\n"[..]));
        let header = reader.headers().map_err(|error| malformed(path, &error))?;
        let line = lines.of(header.position());
        let names: Vec<String> = header.iter().map(String::from).collect();
        if let [name] = &names[..]
            && name.contains(';')
        {
            let shown: String = name.chars().take(40).collect();
            let reason = format!("semicolons between the columns: {shown:?} (expected commas)");
            return Err(FileError::new(path, Some(line), "", FileErrorKind::Malformed(reason)));
        }
        Ok(Self {
            path,
            lines,
            records: reader.into_records(),
            names,
            line,
        })
    }

    /// Returns the next row with its line; `None` after the last.
    ///
    /// Returns an error if the row has another number of fields than the header.
    pub(crate) fn next_row(&mut self) -> Result<Option<(u32, csv::StringRecord)>, FileError> {
        let Some(record) = self.records.next() else {
            return Ok(None);
        };
        let record = record.map_err(|error| malformed(self.path, &error))?;
        let (line, count) = (self.lines.of(record.position()), self.names.len());
        if record.len() != count {
            let reason = format!("wrong number of fields: {} (expected {count})", record.len());
            return Err(FileError::new(
                self.path,
                Some(line),
                "",
                FileErrorKind::Malformed(reason),
            ));
        }
        Ok(Some((line, record)))
    }
}

fn malformed(path: &Path, error: &csv::Error) -> FileError {
    FileError::new(path, None, "", FileErrorKind::Malformed(error.to_string()))
}

/// Counts the lines of a text up to its records, which come in order.
///
/// The positions of the reader are before the line feed of a CR LF and before blank lines and
/// comments.
struct Lines<'a> {
    text: &'a str,
    at: usize,
    line: u32,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0, line: 1 }
    }

    /// Returns the line of the first letter of a record.
    fn of(&mut self, position: Option<&csv::Position>) -> u32 {
        let bytes = self.text.as_bytes();
        let start = position.map_or(self.at, |p| p.byte() as usize);
        let mut is_comment = false;
        while let Some(&byte) = bytes.get(self.at) {
            let is_end = matches!(byte, b'\r' | b'\n');
            if self.at >= start {
                is_comment = byte == b'#' || (is_comment && !is_end);
                if !is_end && !is_comment {
                    break;
                }
            }
            self.at += 1;
            self.line += u32::from(is_end && !(byte == b'\r' && bytes.get(self.at) == Some(&b'\n')));
        }
        self.line
    }
}
