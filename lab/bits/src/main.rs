//! Prints a hash of the answers to each kind of query, the same on every target.
//!
//! ```text
//! cargo run --release -p bits [-- [--scale PERCENT] [--trace] [KIND...]]
//! ```
//!
//! The first line has the version of `lin-canny` and the scale; then follows a line `kind hash` for
//! each kind, or for the kinds that are named. `--trace` prints the text of every answer instead:
//! `diff` of two traces shows the first answer that differs. The number of answers goes to the
//! error output.

use bits::{KINDS, Random, Teller, heading, line, sum};
use std::io::Write;
use std::process::ExitCode;

const USAGE: &str = "usage: bits [--scale PERCENT] [--trace] [KIND...]";

struct Options {
    scale: u64,
    trace: bool,
    names: Vec<String>,
}

fn options() -> Result<Options, String> {
    let (mut scale, mut trace, mut names) = (100, false, Vec::new());
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match &word[..] {
            "--trace" => trace = true,
            "--scale" => {
                let percent = words.next().unwrap_or_default();
                let valid = percent.parse().ok().filter(|n| (1..=1000).contains(n));
                scale = valid.ok_or_else(|| format!("scale {percent:?} is out of range (expected 1..=1000)"))?;
            }
            name if KINDS.iter().any(|kind| kind.0 == name) => names.push(word),
            other => return Err(format!("unknown kind or option: {other:?}\n{USAGE}")),
        }
    }
    Ok(Options { scale, trace, names })
}

fn print(options: &Options) -> std::io::Result<()> {
    let (out, err) = (std::io::stdout(), std::io::stderr());
    let (mut out, mut err, mut all) = (out.lock(), err.lock(), 0);
    writeln!(out, "{}", heading(options.scale))?;
    for &(name, seed, kind) in KINDS {
        if !options.names.is_empty() && !options.names.iter().any(|n| n == name) {
            continue;
        }
        let count = if options.trace {
            let mut written = Ok(());
            let mut write = |number: u64, text: &str| {
                if written.is_ok() {
                    written = writeln!(out, "{name} {number} {text}");
                }
            };
            let mut teller = Teller::new(options.scale, Some(&mut write));
            kind(&mut teller, &mut Random(seed));
            let (count, _) = teller.sum();
            written?;
            count
        } else {
            let (count, hash) = sum(seed, kind, options.scale);
            writeln!(out, "{}", line(name, hash))?;
            count
        };
        out.flush()?;
        all += count;
        writeln!(err, "{name}: {count} answers")?;
    }
    writeln!(err, "{all} answers")
}

fn main() -> ExitCode {
    let options = match options() {
        Ok(options) => options,
        Err(what) => {
            let _ = writeln!(std::io::stderr(), "bits: {what}");
            return ExitCode::from(2);
        }
    };
    // A reader that closes the pipe ends the program.
    match print(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::FAILURE,
    }
}
