//! Shared parts of the races: options and results, and the races of many bodies, which accept
//! further engines.

pub mod boxes;
pub mod hulls;
pub mod scene;
mod tree;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

/// Shortest time for which an engine runs before a pass counts.
pub const WARM_UP: Duration = Duration::from_millis(3);

/// Largest number of bodies of a short run.
const QUICK: usize = 1000;

/// Options of a race.
#[derive(Args, Debug)]
pub struct Options {
    /// Output table, one row per result: scene,shape,n,engine,ns
    #[arg(long, value_name = "FILE.csv", value_parser = truth::command::file("csv"))]
    csv: Option<PathBuf>,
    /// Short run with fewer frames, passes and bodies
    #[arg(long)]
    pub quick: bool,
    /// Single scene to run
    #[arg(long, value_name = "SCENE")]
    only: Option<String>,
    /// Greatest number of bodies or triangles
    #[arg(long, value_name = "N")]
    upto: Option<usize>,
}

impl Options {
    /// Rejects a scene that does not belong to the race.
    pub fn check(&self, scenes: &[&str]) -> Result<(), String> {
        match &self.only {
            Some(only) if !scenes.contains(&only.as_str()) => {
                Err(format!("no scene is called {only}; there are {}", scenes.join(", ")))
            }
            _ => Ok(()),
        }
    }

    /// Returns whether a scene is raced.
    pub fn wants(&self, scene: &str) -> bool {
        self.only.as_deref().is_none_or(|only| only == scene)
    }

    /// Returns whether all scenes are raced.
    pub fn wants_all(&self) -> bool {
        self.only.is_none()
    }

    /// Returns the numbers of bodies that are raced.
    pub fn sizes<const N: usize>(&self, all: [usize; N]) -> impl Iterator<Item = usize> {
        let most = self.upto.unwrap_or(if self.quick { QUICK } else { usize::MAX });
        all.into_iter().filter(move |n| *n <= most)
    }

    /// Writes the output file, if one is requested.
    pub fn save(&self, rows: &Rows) -> Result<(), String> {
        let Some(file) = &self.csv else { return Ok(()) };
        truth::command::write(file, &rows.text)
    }
}

/// Results as CSV: scene, shape, number of vertices or bodies, engine, and nanoseconds or another
/// unit.
#[derive(Debug)]
pub struct Rows {
    text: String,
}

impl Default for Rows {
    /// Returns a table of nanoseconds without rows.
    fn default() -> Self {
        Self::of("ns")
    }
}

impl Rows {
    /// Returns a table without rows whose results are of this unit.
    pub fn of(unit: &str) -> Self {
        Self {
            text: format!("scene,shape,n,engine,{unit}\n"),
        }
    }

    /// Adds one result, with `digits` decimal places.
    pub fn push(&mut self, (scene, shape, n): (&str, &str, usize), engine: &str, ns: f64, digits: usize) {
        let _ = writeln!(self.text, "{scene},{shape},{n},{engine},{ns:.digits$}");
    }
}

/// Returns the median of the numbers, and sorts them.
pub fn median(list: &mut [f64]) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}
