//! Shapes of every kind: `shapes` prints a table of pairs and draws them, `shapes FILE` answers the pairs of a file.

mod draw;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lin_canny::PairTracker;
use truth::curved::parse;

/// Prints a table of pairs of curved shapes and draws them, or answers the pairs of a file
///
/// A line of a file is `KIND params; KIND params; x y z qx qy qz qw`, the pose that of B in A's frame:
/// `ball r`, `capsule half_length r` (along z), `box hx hy hz`, `hull x y z x y z ...`,
/// `cylinder half_height r`, `cone half_height r` (apex up z), `ellipsoid a b c`,
/// `superquadric a b c e1 e2`, any with `+ r` for rounding. Empty lines and those that begin with `#`
/// are skipped. The answer is `distance lower upper`, 17 digits each, line for line.
#[derive(Parser)]
#[command(verbatim_doc_comment)]
struct Options {
    /// Pairs to answer, instead of the table
    file: Option<PathBuf>,
    /// Where to draw the table's pairs
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
