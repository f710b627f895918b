//! Counts instructions per query with callgrind: unlike times, they do not depend on the load of
//! the machine.
//!
//! The program runs itself under `valgrind`, once per cell, and callgrind counts only inside
//! [`counted`].

use std::hint::black_box;
use std::process::Command;

use race::common::{Options, Rows};
use race::progress::Progress;

use crate::pairs::{Engine, State, ask, degrees, pair};
use truth::rng::Rng;

/// Frames of a cell that are counted, after as many frames of warm-up.
const FRAMES: usize = 2000;

pub(crate) const SCENES: [&str; 4] = ["coherent-0.5", "coherent-5", "coherent-25", "random"];

const ENGINES: [Engine; 2] = [Engine::Ours, Engine::GjkCached];

/// Motion, shape and size of one pair, and the engine.
struct Cell {
    scene: &'static str,
    shape: &'static str,
    n: usize,
    engine: Engine,
}

impl Cell {
    fn all() -> impl Iterator<Item = Self> {
        let shapes = [("box", 8)].into_iter().chain(
            ["sphere", "flat"]
                .into_iter()
                .flat_map(|s| [8, 32, 128, 512].map(|n| (s, n))),
        );
        let places = SCENES.into_iter().flat_map(move |scene| {
            let shapes = shapes.clone();
            shapes.map(move |(shape, n)| (scene, shape, n))
        });
        places.flat_map(|(scene, shape, n)| {
            ENGINES.map(|engine| Self {
                scene,
                shape,
                n,
                engine,
            })
        })
    }

    fn name(&self) -> String {
        format!("{},{},{},{}", self.scene, self.shape, self.n, self.engine.name())
    }

    /// Returns the instructions per query that callgrind counts in a run of this program.
    fn count(&self) -> Result<f64, String> {
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let run = Command::new("valgrind")
            .args([
                "--tool=callgrind",
                "--callgrind-out-file=/dev/null",
                "--toggle-collect=*counted*",
            ])
            .arg(program)
            .args(["instructions", "--cell", &self.name()])
            .output()
            .map_err(|e| format!("valgrind: {e}"))?;
        let said = String::from_utf8_lossy(&run.stderr);
        let collected = said
            .lines()
            .find_map(|line| line.split_once("Collected : ")?.1.trim().parse::<f64>().ok());
        collected
            .map(|total| total / FRAMES as f64)
            .ok_or_else(|| format!("callgrind counted nothing:\n{said}"))
    }
}

/// Runs a cell: one half of its frames as warm-up, then the half that callgrind counts.
pub(crate) fn run_cell(name: &str) -> Result<(), String> {
    let cell = Cell::all()
        .find(|c| c.name() == name)
        .ok_or_else(|| format!("no cell is called {name}"))?;
    let mut rng = Rng::new(1000 + cell.n as u64);
    let pair = pair(cell.shape, cell.n, degrees(cell.scene), 2 * FRAMES, &mut rng, false);
    let mut state = State::default();
    (0..FRAMES).for_each(|f| {
        black_box(ask(cell.engine, &pair, f, &mut state));
    });
    counted(cell.engine, |engine, f| {
        black_box(ask(engine, &pair, f, &mut state));
    });
    Ok(())
}

/// The part of a run that callgrind counts. The engine is a compile-time constant, as in the race.
#[inline(never)]
fn counted(engine: Engine, mut ask: impl FnMut(Engine, usize)) {
    match engine {
        Engine::Ours => (FRAMES..2 * FRAMES).for_each(|f| ask(Engine::Ours, f)),
        _ => (FRAMES..2 * FRAMES).for_each(|f| ask(Engine::GjkCached, f)),
    }
}

pub(crate) fn run(o: &Options) -> Result<Rows, String> {
    let cells: Vec<_> = Cell::all().filter(|c| o.wants_cell(c.scene, c.shape, c.n)).collect();
    println!(
        "{:<14} {:<7} {:>5} {:<12} {:>12}",
        "scene", "shape", "n", "engine", "instructions"
    );
    let progress = Progress::new("race instructions", cells.len() as u64);
    let mut rows = Rows::of("instructions");
    for cell in &cells {
        let count = cell.count()?;
        println!(
            "{:<14} {:<7} {:>5} {:<12} {count:>12.0}",
            cell.scene,
            cell.shape,
            cell.n,
            cell.engine.name()
        );
        rows.push((cell.scene, cell.shape, cell.n), cell.engine.name(), count, 0);
        progress.step();
    }
    Ok(rows)
}
