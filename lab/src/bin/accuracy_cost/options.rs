//! What the command line asks for.

use std::path::PathBuf;

pub(crate) const USAGE: &str = "\
usage: accuracy_cost [--csv FILE] [--out FOLDER] [--quick] [--only PART] [--mesh A.obj|A.stl --mesh B.obj|B.stl]

What each step of accuracy costs in time: every level of this crate and of parry on the same motions, errors against exact
arithmetic. Prints tables and draws pictures.

  --csv FILE     one row a pass: engine,level,family,n,ns,err (err over the size of the pair)
  --out FOLDER   where to draw (default: target/accuracy-cost)
  --quick        fewer frames and passes: ten seconds
  --only PART    levels, motion, gap, geometry, curved, nonconvex or asking
  --mesh FILE    two meshes of your own instead of ours, taken as hulls of radius 1 (parts levels, motion, gap, asking)";

pub(crate) const PARTS: [&str; 7] = ["levels", "motion", "gap", "geometry", "curved", "nonconvex", "asking"];

pub(crate) struct Options {
    pub(crate) csv: Option<PathBuf>,
    pub(crate) out: PathBuf,
    pub(crate) quick: bool,
    pub(crate) only: Option<String>,
    pub(crate) meshes: Option<[String; 2]>,
}

impl Options {
    /// Frames of a motion.
    pub(crate) fn frames(&self) -> usize {
        if self.quick { 200 } else { 600 }
    }

    /// Passes, and stretches of a motion whose error is a row of its own.
    pub(crate) fn passes(&self) -> usize {
        if self.quick { 3 } else { 5 }
    }

    /// Frames that exact arithmetic looks at.
    pub(crate) fn sampled(&self) -> usize {
        if self.quick { 15 } else { 50 }
    }

    pub(crate) fn does(&self, part: &str) -> bool {
        self.only.as_ref().is_none_or(|p| p == part)
    }
}

/// The options, or what to tell the user: `Ok(None)` when asked for help.
pub(crate) fn parse(mut words: impl Iterator<Item = String>) -> Result<Option<Options>, String> {
    let mut o = Options {
        csv: None,
        out: PathBuf::from("target/accuracy-cost"),
        quick: false,
        only: None,
        meshes: None,
    };
    let mut meshes = Vec::new();
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "-h" | "--help" => return Ok(None),
            "--csv" => o.csv = Some(value()?.into()),
            "--out" => o.out = value()?.into(),
            "--quick" => o.quick = true,
            "--only" => o.only = Some(value()?),
            "--mesh" => meshes.push(value()?),
            _ => return Err(format!("{word} is no option")),
        }
    }
    if let Some(part) = o.only.as_ref().filter(|p| !PARTS.contains(&p.as_str())) {
        return Err(format!("{part} is no part"));
    }
    o.meshes = match <[String; 2]>::try_from(meshes) {
        Ok(two) => Some(two),
        Err(none) if none.is_empty() => None,
        Err(other) => return Err(format!("two meshes are needed, or none; {} given", other.len())),
    };
    Ok(Some(o))
}
