//! Options of the command line.

use std::path::PathBuf;

use clap::Parser;
use clap::builder::PossibleValuesParser;
use truth::command::file;

const PARTS: [&str; 7] = ["levels", "motion", "gap", "geometry", "curved", "nonconvex", "asking"];

/// Measure the time and the error of each level of accuracy, of this crate and of parry
///
/// All levels run on the same motions; errors are relative to exact arithmetic. Prints tables and
/// draws pictures.
#[derive(Parser)]
pub(crate) struct Options {
    /// Output table, one row per pass: engine,level,family,n,ns,err (err relative to the size of
    /// the pair)
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    pub(crate) csv: Option<PathBuf>,
    /// Output folder of the pictures
    #[arg(long, value_name = "FOLDER", default_value = "target/accuracy-cost")]
    pub(crate) out: PathBuf,
    /// Short run of ten seconds, with fewer frames and passes
    #[arg(long)]
    pub(crate) quick: bool,
    /// Single part to run
    #[arg(long, value_name = "PART", value_parser = PossibleValuesParser::new(PARTS))]
    pub(crate) only: Option<String>,
    /// Mesh file that replaces a built-in body, as a hull scaled to radius 1; give two (parts
    /// levels, motion, gap, asking)
    #[arg(long, value_name = "FILE")]
    mesh: Vec<String>,
}

impl Options {
    /// Returns the number of frames of a motion.
    pub(crate) fn frames(&self) -> usize {
        if self.quick { 200 } else { 600 }
    }

    /// Returns the number of passes, which is also the number of stretches of a motion with an
    /// error each.
    pub(crate) fn passes(&self) -> usize {
        if self.quick { 3 } else { 5 }
    }

    /// Returns the number of frames that exact arithmetic checks.
    pub(crate) fn sampled(&self) -> usize {
        if self.quick { 15 } else { 50 }
    }

    pub(crate) fn does(&self, part: &str) -> bool {
        self.only.as_ref().is_none_or(|p| p == part)
    }

    /// Returns the meshes of the user, if there are any.
    pub(crate) fn meshes(&self) -> Option<[&str; 2]> {
        match self.mesh.as_slice() {
            [a, b] => Some([a, b]),
            _ => None,
        }
    }

    /// Rejects one mesh, or more than two.
    pub(crate) fn check(&self) -> Result<(), String> {
        match self.mesh.len() {
            0 | 2 => Ok(()),
            given => Err(format!("two meshes are needed, or none; {given} given")),
        }
    }
}
