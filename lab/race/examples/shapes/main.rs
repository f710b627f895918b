//! Prints and draws a table of pairs of shapes; `shapes FILE` measures the pairs of a file.

mod draw;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lin_canny::PairTracker;
use truth::curved::parse;

/// Print and draw a table of pairs of curved shapes, or measure the pairs of a file
///
/// A line of a file is `KIND params; KIND params; x y z qx qy qz qw`; the pose is that of B in A's
/// frame: `ball r`, `capsule half_length r` (along z), `box hx hy hz`, `hull x y z x y z ...`,
/// `cylinder half_height r`, `cone half_height r` (apex up z), `ellipsoid a b c`,
/// any with `+ r` for rounding. Empty lines and lines that start with
/// `#` are skipped. Prints `distance lower upper` for each line, with 17 digits each.
#[derive(Parser)]
#[command(verbatim_doc_comment)]
struct Options {
    /// File with the pairs to measure, instead of the built-in table
    file: Option<PathBuf>,
    /// Output picture of the pairs of the table
    #[arg(long, value_name = "FILE.svg", default_value = "target/shapes.svg", value_parser = truth::command::file("svg"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(|o: &Options| match &o.file {
        Some(file) => answer(file),
        None => draw::all(&o.out),
    })
}

fn answer(file: &Path) -> Result<(), String> {
    let (text, name) = (truth::command::read(file)?, file.display());
    let is_pair = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut pairs = text.lines().enumerate().filter(|(_, l)| is_pair(l)).peekable();
    pairs.peek().ok_or(format!("{name}: no pair"))?;
    for (k, line) in pairs {
        let pair = parse::pair(line).map_err(|e| format!("{name}:{}: {e}", k + 1))?;
        let o = PairTracker::new().closest(&pair.a, &pair.b, &pair.pose);
        println!("{:.16e} {:.16e} {:.16e}", o.distance, o.lower, o.upper);
    }
    Ok(())
}
