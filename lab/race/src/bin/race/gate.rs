//! `race gate`: shows what a change has made slower, in less than two minutes.
//!
//! Each cell is a ratio of two engines in the same run, ours over a rival, so that the speed of the
//! machine cancels. Every race runs [`ROUNDS`] times, and the least time of each engine counts.
//! Cells of `instructions` are counts per query of ours alone; they are skipped without valgrind.
//! The results are compared with the file [`FILE`], which `gate --save` writes.

use std::collections::BTreeMap;
use std::path::Path;

use race::common::{Options, Rows, boxes, scene};

use crate::{contact, impact, instructions, meshes, pairs};

/// Runs of each race.
const ROUNDS: usize = 9;

/// A cell that is larger than its saved value by more than this factor has lost.
const LOST: f64 = 1.05;

/// The saved cells, from the root of the repository.
const FILE: &str = "benches/record/gate.csv";

const COLUMNS: &str = "race,scene,shape,n,engine,rival,value";

/// The engine of a count that has no rival.
const ALONE: &str = "-";

/// A race with its cells: scene, shape, number, our engine, and the rival.
struct Race {
    name: &'static str,
    run: fn(&Options) -> Result<Rows, String>,
    cells: &'static [(&'static str, &'static str, usize, &'static str, &'static str)],
}

const RACES: [Race; 7] = [
    Race {
        name: "pairs",
        run: |o| Ok(pairs::run(o)),
        cells: &[
            ("coherent-0.5", "box", 8, "ours", "gjk-cached"),
            ("coherent-0.5", "sphere", 8, "ours", "gjk-cached"),
            ("coherent-0.5", "sphere", 128, "ours", "gjk-cached"),
            ("coherent-0.5", "sphere", 2048, "ours", "gjk-cached"),
            ("coherent-0.5", "flat", 32, "ours", "gjk-cached"),
            ("coherent-5", "sphere", 512, "ours", "gjk-cached"),
            ("coherent-5", "flat", 512, "ours", "gjk-cached"),
            ("coherent-25", "box", 8, "ours", "gjk-cached"),
            ("coherent-25", "flat", 32, "ours", "gjk-cached"),
            ("random", "flat", 8, "ours", "gjk-cached"),
        ],
    },
    Race {
        name: "contact",
        run: |o| Ok(contact::run(o)),
        cells: &[
            ("shallow-0.5", "sphere", 8, "ours", "parry-contact"),
            ("shallow-0.5", "sphere", 32, "ours", "parry-contact"),
            ("shallow-0.5", "sphere", 128, "ours", "parry-contact"),
            ("resting", "prism", 8, "ours-manifold", "parry-manifold-warm"),
            ("sliding", "prism", 32, "ours-manifold", "parry-manifold-warm"),
        ],
    },
    Race {
        name: "impact",
        run: |o| Ok(impact::run(o)),
        cells: &[
            ("turn-0", "sphere", 8, "ours", "parry-linear"),
            ("turn-0.3", "sphere", 8, "ours", "parry-sweep"),
            ("turn-1", "sphere", 32, "ours", "parry-sweep"),
        ],
    },
    Race {
        name: "meshes",
        run: |o| Ok(meshes::run(o)),
        cells: &[
            ("tracked-0.5", "rock", 1280, "ours", "parry-trimesh"),
            ("tracked-0.5", "rock", 1280, "ours-cold", "parry-trimesh"),
        ],
    },
    Race {
        name: "boxes",
        run: |o| Ok(boxes::run(o, &[])),
        cells: &[
            ("uniform", "box", 1000, "ours", "parry-bvh"),
            ("pile", "box", 1000, "ours", "parry-bvh"),
            ("movers-1%", "box", 1000, "ours", "parry-bvh"),
            ("mixed", "box", 1000, "ours", "parry-bvh"),
        ],
    },
    Race {
        name: "scene",
        run: |o| Ok(scene::run(o, &[])),
        cells: &[
            ("sparse-32", "hull", 1000, "ours", "parry-parts"),
            ("pile-32", "hull", 1000, "ours", "parry-parts"),
        ],
    },
    Race {
        name: "instructions",
        run: instructions::run,
        cells: &[
            ("coherent-5", "sphere", 512, "ours", ALONE),
            ("coherent-5", "flat", 512, "ours", ALONE),
            ("coherent-25", "flat", 32, "ours", ALONE),
            ("random", "flat", 8, "ours", ALONE),
        ],
    },
];

/// Ratios or counts by cell, in the form of the first columns of the file.
type Values = BTreeMap<String, f64>;

/// Runs the cells of a race, and adds their values.
fn measure(race: &Race, rounds: usize, values: &mut Values) -> Result<(), String> {
    let options = Options::of_cells(race.cells.iter().map(|c| (c.0, c.1, c.2)).collect());
    let runs: Result<Vec<Rows>, String> = (0..rounds).map(|_| (race.run)(&options)).collect();
    let runs = runs?;
    for &(scene, shape, n, engine, rival) in race.cells {
        let least = |engine| {
            let times = runs.iter().filter_map(|rows| rows.get((scene, shape, n), engine));
            times.reduce(f64::min)
        };
        let name = format!("{},{scene},{shape},{n},{engine},{rival}", race.name);
        let ours = least(engine).ok_or_else(|| format!("no result for {name}"))?;
        let value = match rival {
            ALONE => ours,
            _ => ours / least(rival).ok_or_else(|| format!("no result for {name}"))?,
        };
        values.insert(name, value);
    }
    Ok(())
}

fn read(path: &Path) -> Result<Values, String> {
    let text = truth::command::read(path)?;
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, line)| line != COLUMNS) {
        return Err(format!("{}: the first line is not {COLUMNS}", path.display()));
    }
    let cell = |line: &str| -> Option<(String, f64)> {
        let (name, value) = line.rsplit_once(',')?;
        Some((name.into(), value.parse().ok()?))
    };
    lines
        .map(|(k, line)| cell(line).ok_or_else(|| format!("{}: line {} is no cell", path.display(), k + 1)))
        .collect()
}

/// Measures all cells. Compares them with the saved file, or writes it.
///
/// # Errors
/// Names the cells that lost more than 5 %, or the file that cannot be read or written.
pub(crate) fn run(save: bool) -> Result<(), String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(FILE);
    let saved = if save { Values::new() } else { read(&path)? };
    let mut values = Values::new();
    for race in &RACES {
        if race.name == "instructions" {
            if let Err(error) = measure(race, 1, &mut values) {
                eprintln!("instructions are not counted: {error}");
            }
        } else {
            measure(race, ROUNDS, &mut values)?;
        }
    }
    if save {
        let lines = values.iter().map(|(name, value)| format!("{name},{value:.6}\n"));
        return truth::command::write(&path, &format!("{COLUMNS}\n{}", lines.collect::<String>()));
    }
    println!("\n{:<72}{:>10}{:>10}{:>8}", "cell", "saved", "now", "ratio");
    let mut lost = vec![];
    for (name, &now) in &values {
        let Some(&before) = saved.get(name) else {
            println!("{name:<72}{:>10}{now:>10.3}", "-");
            continue;
        };
        println!("{name:<72}{before:>10.3}{now:>10.3}{:>8.3}", now / before);
        if now > LOST * before {
            lost.push(name.as_str());
        }
    }
    match lost[..] {
        [] => Ok(()),
        _ => Err(format!("more than 5 % lost: {}", lost.join("; "))),
    }
}
