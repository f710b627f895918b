//! Shared parts of the races: options and results, and the races of many bodies, which accept
//! further engines.

pub mod boxes;
pub mod hulls;
pub mod scene;
mod tree;

use std::fmt::{self, Display, Formatter};
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
    /// Cells to which the run is restricted: scene, shape and number; all cells if empty.
    #[arg(skip)]
    cells: Vec<(&'static str, &'static str, usize)>,
}

impl Options {
    /// Returns the options of a short run of these cells: scene, shape and number.
    pub fn of_cells(cells: Vec<(&'static str, &'static str, usize)>) -> Self {
        Self {
            csv: None,
            quick: true,
            only: None,
            upto: None,
            cells,
        }
    }

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
        let has_cell = self.cells.is_empty() || self.cells.iter().any(|c| c.0 == scene);
        has_cell && self.only.as_deref().is_none_or(|only| only == scene)
    }

    /// Returns whether a cell of a scene is raced.
    pub fn wants_cell(&self, scene: &str, shape: &str, n: usize) -> bool {
        self.wants(scene) && (self.cells.is_empty() || self.cells.contains(&(scene, shape, n)))
    }

    /// Returns whether all scenes are raced.
    pub fn wants_all(&self) -> bool {
        self.only.is_none() && self.cells.is_empty()
    }

    /// Returns the numbers of bodies that are raced.
    pub fn sizes<const N: usize>(&self, all: [usize; N]) -> impl Iterator<Item = usize> {
        let most = self.upto.unwrap_or(if self.quick { QUICK } else { usize::MAX });
        let wanted = move |n| match &self.cells[..] {
            [] => n <= most,
            cells => cells.iter().any(|c| c.2 == n),
        };
        all.into_iter().filter(move |&n| wanted(n))
    }

    /// Returns the greatest number that is requested.
    pub fn most(&self) -> Option<usize> {
        self.upto
    }

    /// Writes the output file, if one is requested.
    pub fn save(&self, rows: &impl Display) -> Result<(), String> {
        let Some(file) = &self.csv else { return Ok(()) };
        truth::command::write(file, &rows.to_string())
    }
}

/// Results of a race. They are written as CSV: scene, shape, number of vertices or bodies, engine,
/// and nanoseconds or another unit.
#[derive(Debug)]
pub struct Rows {
    unit: String,
    list: Vec<Row>,
}

/// One result of a race.
#[derive(Debug)]
struct Row {
    scene: String,
    shape: String,
    n: usize,
    engine: String,
    value: f64,
    digits: usize,
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
            unit: unit.into(),
            list: vec![],
        }
    }

    /// Adds one result, with `digits` decimal places.
    pub fn push(&mut self, (scene, shape, n): (&str, &str, usize), engine: &str, value: f64, digits: usize) {
        self.list.push(Row {
            scene: scene.into(),
            shape: shape.into(),
            n,
            engine: engine.into(),
            value,
            digits,
        });
    }

    /// Returns the result of an engine in a cell.
    pub fn get(&self, cell: (&str, &str, usize), engine: &str) -> Option<f64> {
        let of_cell = |r: &&Row| (r.scene.as_str(), r.shape.as_str(), r.n) == cell && r.engine == engine;
        self.list.iter().find(of_cell).map(|r| r.value)
    }
}

impl Display for Rows {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "scene,shape,n,engine,{}", self.unit)?;
        for r in &self.list {
            let Row {
                scene,
                shape,
                n,
                engine,
                value,
                digits,
            } = r;
            writeln!(f, "{scene},{shape},{n},{engine},{value:.digits$}")?;
        }
        Ok(())
    }
}

/// Returns the median of the numbers, and sorts them.
pub fn median(list: &mut [f64]) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}
