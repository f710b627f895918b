//! Writes hard cases with their exact answers, in the format of `tests/CASES.md`.

use std::error::Error;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use cases::families;
use cases::maker::Precision;
use cases::minkowski;
use cases::shapes::Shape;
use cases::solid;
use cases::suite::{self, Line, Reader};
use clap::Parser;
use std::collections::HashMap;

/// Write hard queries of bodies with their exact answers to standard output
///
/// The same options give the same file on one machine. Another library of mathematical functions may
/// change the last bits of some bodies and poses; the answers are exact for what the file states.
#[derive(Parser)]
struct Options {
    /// Suite: `core`, `extreme`, `standard` with both, or `queries` of points, meshes, casts and rays
    #[arg(long, default_value = "standard")]
    suite: String,
    /// Only these families
    #[arg(long, value_delimiter = ',')]
    family: Vec<String>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cases of each family, about
    #[arg(long, default_value_t = 100)]
    count: usize,
    /// Round points and poses to single precision before they are answered
    #[arg(long)]
    single: bool,
    /// Answer the cases of FILE instead, whatever answers it holds, and find faces that bodies lack
    #[arg(long, value_name = "FILE")]
    solve: Option<String>,
}

/// Faces of bodies of more points take longer than all their answers.
const FACES_UP_TO: usize = 64;

fn solve(file: &str, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mut bodies: HashMap<usize, Shape> = HashMap::new();
    for line in Reader::open(file).map_err(|e| format!("{file}: {e}"))? {
        let mut line = line?;
        if let Line::Shape(s) = &mut line {
            if !s.is_mesh && s.shape.faces.is_empty() && s.shape.points.len() <= FACES_UP_TO {
                s.shape = s.shape.clone().solved();
            }
            bodies.insert(s.id, s.shape.clone());
        }
        if let Line::Case(case) = &mut line {
            let body = |id| {
                bodies
                    .get(&id)
                    .ok_or_else(|| format!("case {}: no shape {id}", case.id))
            };
            let (a, b) = (body(case.a)?, body(case.b)?);
            case.truth = Some(minkowski::solve(a.into(), &case.pose_a, b.into(), &case.pose_b));
        }
        if let Line::Query(case) = &mut line {
            if let Some(id) = case.query.bodies().iter().find(|id| !bodies.contains_key(id)) {
                return Err(format!("{} {}: no mesh or shape {id}", case.query.kind(), case.id).into());
            }
            case.truth = Some(solid::solve(&case.query, |id| &bodies[&id]));
        }
        suite::write(out, &line)?;
    }
    Ok(())
}

fn run(o: &Options) -> Result<(), Box<dyn Error>> {
    let mut out = BufWriter::new(io::stdout().lock());
    if let Some(file) = &o.solve {
        solve(file, &mut out)?;
    } else {
        let all = families::suite(&o.suite);
        let mut wanted =
            all.ok_or_else(|| format!("suite {:?} is unknown: core, extreme, standard, queries", o.suite))?;
        if let Some(unknown) = o.family.iter().find(|f| !wanted.contains(&f.as_str())) {
            return Err(format!("suite {} has no family {unknown:?}: {}", o.suite, wanted.join(", ")).into());
        }
        wanted.retain(|f| o.family.is_empty() || o.family.iter().any(|g| g == f));
        let precision = if o.single { Precision::Single } else { Precision::Double };
        families::write(&mut out, &o.suite, &wanted, o.seed, o.count, precision)?;
    }
    Ok(out.flush()?)
}

fn main() -> ExitCode {
    cases::command::main(run)
}
