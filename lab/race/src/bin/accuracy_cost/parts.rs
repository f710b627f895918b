//! Measures all levels on families of bodies, and some levels against the motion and the gap.

use lin_canny::Solver;
use race::plot::Chart;
use race::progress::Progress;
use race::record::Row;

use crate::engines::{Accuracy, Case};
use crate::measure::{self, Seen};
use crate::options::Options;
use truth::pairs::{self, Pair};

type Trouble = Box<dyn std::error::Error>;

/// Every level, warm and cold.
pub(crate) const ALL: [Case; 9] = [
    Case::warm(Accuracy::Walk),
    Case::warm(Accuracy::Certified),
    Case::warm(Accuracy::Exact),
    Case::cold(Accuracy::Certified),
    Case::cold(Accuracy::Exact),
    Case::warm(Accuracy::Gjk),
    Case::cold(Accuracy::Gjk),
    Case::cold(Accuracy::Parry),
    Case::cold(Accuracy::ParryF32),
];

/// The levels measured against motion and gap.
const SOME: [Case; 6] = [
    Case::warm(Accuracy::Walk),
    Case::warm(Accuracy::Certified),
    Case::warm(Accuracy::Exact),
    Case::warm(Accuracy::Gjk),
    Case::cold(Accuracy::Parry),
    Case::cold(Accuracy::ParryF32),
];

/// Families, numbers of vertices and degrees per frame of the part `levels`.
const FAMILIES: [(&str, usize, &str); 9] = [
    ("box", 8, "0.5"),
    ("sphere", 8, "0.5"),
    ("sphere", 32, "0.5"),
    ("sphere", 128, "0.5"),
    ("sphere", MIDDLE, "0.5"),
    ("sphere", 2048, "0.5"),
    ("sphere", 8192, "0.5"),
    ("flat", MIDDLE, "0.5"),
    ("sphere", MIDDLE, "0.05"),
];

/// Degrees per frame of the part `motion`.
const DEGREES: [&str; 9] = ["0.001", "0.01", "0.03", "0.1", "0.3", "1", "3", "10", "30"];

/// Vertices of the spheres of the parts `motion` and `gap`.
pub(crate) const MIDDLE: usize = 512;

/// Exponents of the gaps: 10^-k times the size of the pair.
const GAPS: [i32; 16] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16];

/// Returns the bodies of a part: the caller's meshes, or the built-in bodies.
fn pair(options: &Options, shape: &str, n: usize) -> Result<(Pair, usize), Trouble> {
    Ok(match options.meshes() {
        Some([a, b]) => {
            let (a, b) = (pairs::mesh(a)?, pairs::mesh(b)?);
            let n = a.points.len();
            (Pair::new(a, b), n)
        }
        None => (Pair::of(shape, n)?, n),
    })
}

/// Returns the number of families that `--only` selects.
pub(crate) fn count(options: &Options) -> u64 {
    let part = |name: &str, n: usize| if options.does(name) { n as u64 } else { 0 };
    let families = if options.meshes().is_some() {
        3
    } else {
        FAMILIES.len() + 2
    };
    part("levels", families) + part("motion", DEGREES.len()) + part("gap", GAPS.len() * near(options).len())
}

pub(crate) fn levels(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<(), Trouble> {
    measure::head(
        "Every level: gaps from 2 to 52 % of the radius, so many degrees a frame; `random` takes a new pose every frame",
    );
    let own = options.meshes().is_some();
    let mine = [("mesh", 0, "0.5"), ("mesh", 0, "0.05")];
    for &(shape, n, degrees) in if own { &mine[..] } else { &FAMILIES } {
        let (pair, n) = pair(options, shape, n)?;
        let pair = pair.swinging(degrees.parse()?, options.frames());
        measure::family(
            &pair,
            (&format!("{shape} {degrees}deg"), n),
            &ALL,
            options,
            rows,
            progress,
        );
    }
    let jumps = if own {
        &[("mesh", 0)][..]
    } else {
        &[("sphere", MIDDLE), ("flat", MIDDLE)]
    };
    for &(shape, n) in jumps {
        let (pair, n) = pair(options, shape, n)?;
        let pair = pair.moving(None, options.frames());
        measure::family(&pair, (&format!("{shape} random"), n), &ALL, options, rows, progress);
    }
    Ok(())
}

pub(crate) fn motion(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<usize, Trouble> {
    measure::head("Against the motion a frame");
    let mut size = MIDDLE;
    for degrees in DEGREES {
        let (pair, n) = pair(options, "sphere", MIDDLE)?;
        let pair = pair.moving(Some(degrees.parse()?), options.frames());
        measure::family(
            &pair,
            (&format!("motion {degrees}deg"), n),
            &SOME,
            options,
            rows,
            progress,
        );
        size = n;
    }
    Ok(size)
}

/// Approximate size of a pair of the part `gap`.
const SPHERE_SIZE: f64 = 4.0;
const FLUSH_SIZE: f64 = 2.6;

/// The families of the part `gap`.
pub(crate) fn near(options: &Options) -> &'static [&'static str] {
    if options.meshes().is_some() {
        &["sphere"]
    } else {
        &["sphere", "flush"]
    }
}

/// Measures times, errors and answering solvers near contact.
///
/// Returns, for each family, the number of vertices and a picture of the shares of the solvers.
pub(crate) fn gap(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<Vec<(usize, Chart)>, Trouble> {
    measure::head("Against the gap, 0.5 degrees a frame; `flush` are boxes face on face");
    near(options)
        .iter()
        .map(|family| gap_of(family, options, rows, progress))
        .collect()
}

fn gap_of(
    family: &str,
    options: &Options,
    rows: &mut Vec<Row>,
    progress: &Progress,
) -> Result<(usize, Chart), Trouble> {
    let layers = [
        (Solver::Walk, "walk"),
        (Solver::Restart, "walk, started afresh"),
        (Solver::Gjk, "minimum norm, f64"),
        (Solver::DoubleDouble, "minimum norm, double-double"),
        (Solver::Exact, "exact integers"),
    ];
    let (mut size, mut shares) = (0, vec![Vec::new(); layers.len()]);
    for k in GAPS {
        let gap = 10f64.powi(-k) * if family == "flush" { FLUSH_SIZE } else { SPHERE_SIZE };
        let pair = match family {
            "flush" => Pair::flush(gap, options.frames())?,
            _ => pair(options, family, MIDDLE)?.0.at_gap(gap, options.frames()),
        };
        size = pair.a.points.len();
        if pair.frames.len() < 16 {
            println!("{family} gap 1e-{k}: {} frames are apart, left out", pair.frames.len());
            progress.step();
            continue;
        }
        let seen = measure::family(
            &pair,
            (&format!("{family} gap 1e-{k}"), size),
            &SOME,
            options,
            rows,
            progress,
        );
        let certified = |s: &&Seen| s.case == Case::warm(Accuracy::Certified);
        if let Some(s) = seen.iter().find(certified) {
            for (share, (layer, _)) in shares.iter_mut().zip(layers) {
                let part = s.totals.answered_by(layer) as f64 / s.totals.queries as f64;
                share.push((10f64.powi(-k), 100.0 * part));
            }
        }
    }
    let mut chart = Chart::new(format!(
        "which layer answered `closest`: {family}, {size} vertices a body"
    ))
    .axes("gap over the size of the pair", "percent of the queries")
    .log_x()
    .from_zero()
    .size(880, 400)
    .legend_beside();
    for (share, (_, name)) in shares.into_iter().zip(layers) {
        chart = chart.curve(name, share);
    }
    Ok((size, chart))
}
