//! The lines of a file, with their number and their hash.

use std::io::{BufRead, Read};

use crate::sha256::Sha256;
use crate::{Stop, Unreadable};

/// Longest line.
const LINE: u64 = 1 << 24;

pub(crate) struct Lines<R> {
    reader: R,
    hash: Sha256,
    pub(crate) number: usize,
    text: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self {
            reader,
            hash: Sha256::new(),
            number: 0,
            text: Vec::new(),
        }
    }

    /// Reads a line, without its end; `None` at the end of the file.
    pub(crate) fn next(&mut self) -> Result<Option<String>, Unreadable> {
        self.text.clear();
        let read = self.reader.by_ref().take(LINE + 1).read_until(b'\n', &mut self.text);
        if read.map_err(Unreadable::Io)? == 0 {
            return Ok(None);
        }
        self.number += 1;
        let text = std::str::from_utf8(&self.text)
            .ok()
            .and_then(|text| text.strip_suffix('\n'));
        match text {
            Some(text) => Ok(Some(text.into())),
            None => Err(self.bad("not UTF-8, longer than 16 MiB, or without an end of line")),
        }
    }

    /// Adds the line that was read last to the hash.
    pub(crate) fn count(&mut self) {
        self.hash.add(&self.text);
    }

    /// Returns the hash of the lines that were counted.
    pub(crate) fn hash(&mut self) -> String {
        std::mem::replace(&mut self.hash, Sha256::new()).text()
    }

    pub(crate) fn bad(&self, why: impl Into<String>) -> Unreadable {
        Unreadable::Line {
            line: self.number,
            why: why.into(),
        }
    }

    /// Adds the number of the line.
    pub(crate) fn whole<T>(&self, result: Result<T, Stop>) -> Result<T, Unreadable> {
        result.map_err(|stop| {
            let (Stop::Bad(why) | Stop::Fails(why)) = stop;
            self.bad(why)
        })
    }
}
