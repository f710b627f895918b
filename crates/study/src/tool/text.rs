//! What the commands print.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

/// Writes a text to stdout. If its reader has gone, as in `... | head`, the text is dropped.
pub(super) fn put(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            complain(format_args!("lin-canny-study: stdout cannot be written: {error}"));
            std::process::exit(3);
        }
        _ => {}
    }
}

/// Writes a line to stderr. If that is not possible, nobody can be told.
pub(super) fn complain(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
