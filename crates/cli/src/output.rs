//! What a tool prints.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Writes a line to stdout: see [`put`].
#[macro_export]
macro_rules! say {
    ($($part:tt)*) => {
        $crate::output::put(format_args!("{}\n", format_args!($($part)*)))
    };
}

/// Writes a line to stderr.
#[macro_export]
macro_rules! warn {
    ($($part:tt)*) => {
        $crate::output::complain(format_args!($($part)*))
    };
}

/// Writes a text to stdout. If its reader has gone, as in `... | head`, the text is dropped: the
/// command still writes its files, and its exit code is that of the result.
pub fn put(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    match out.write_all(plain(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            complain(format_args!("stdout cannot be written: {error}"));
            std::process::exit(3);
        }
        _ => {}
    }
}

/// Writes a line to stderr. If that is not possible, the line is lost.
pub fn complain(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{}", plain(text));
}

/// Returns a text without what could show a line as two, or turn its letters round: names come from files.
fn plain(text: Arguments<'_>) -> String {
    let is_bad = |c: char| match c {
        '\n' | '\t' => false,
        '\u{2028}' | '\u{2029}' | '\u{200e}' | '\u{200f}' => true,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        _ => c.is_control(),
    };
    text.to_string().replace(is_bad, "_")
}

/// Returns a progress bar on stderr, visible on a terminal only.
pub fn progress(what: &'static str, length: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} {eta}") {
        Ok(style) => bar.with_style(style).with_prefix(what),
        Err(_) => bar,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_cannot_break_or_turn_a_line() {
        let name = "post\u{2028}free: 1 pair\u{202e}\r\u{1b}[2J";
        assert_eq!(
            super::plain(format_args!("{name}\tx\n")),
            "post_free: 1 pair___[2J\tx\n"
        );
    }
}
