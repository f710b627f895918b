//! The table of constants in the documentation of `tolerance`, and a word for every constant.

use super::bounds::allowed;
use lab::proofs::bounds::{self, Bound};
use lab::proofs::climb;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Tries of the search for large errors, of each kernel.
const TRIES: u64 = 20_000;

/// Set to a number of tries: prints what a longer search finds.
const LONGER: &str = "LIN_CANNY_CLIMB";

/// Set to anything: the table is written instead of compared.
const WRITE: &str = "LIN_CANNY_WRITE";

/// Constants that no bound rests on: another value changes the time of a query, or which of two right answers is told.
const STEERS: &[&str] = &[
    "ACROSS",
    "ALMOST_FLAT",
    "ASIDE",
    "DIRECTION",
    "LEAST_MEAN",
    "LEAST_START",
    "LEAST_WIDTH",
    "PARALLEL_SIDES",
    "PIVOT",
    "SEAM",
    "STAY",
    "STEEP",
    "TIP",
    "UNIT_LENGTH",
    "WITNESS_CHECK",
];

/// Limits of what is accepted, units, widths that are asked for, and premises of derivations: no roundings are counted.
const LIMITS: &[&str] = &[
    "AGREE",
    "AGREE_CURVED",
    "AGREE_DEPTH",
    "AGREE_WITNESS",
    "BENT_POSE",
    "COPLANAR",
    "DEPTH_GOAL",
    "DISC_MOST",
    "EXPONENT_FREE",
    "EXTENT_MAX",
    "EXTENT_MIN",
    "FAR",
    "FAR_POINT",
    "FLUSH_EXPONENT",
    "LN2_REST",
    "NEAR",
    "NEARLY_PARALLEL",
    "ORIGIN_SHIFTS",
    "PARALLEL",
    "PATCH_LIMIT",
    "PATCH_MAX",
    "PATH_DIRECTION",
    "PLACE_MAX",
    "PLANARITY",
    "POSE_UNIT",
    "REACH",
    "SCENE_REACH",
    "SHIFT_DIRECTION",
    "SHORT_OF",
    "SLOPE",
    "SMALL_PAIR",
    "SPECK",
    "SQUARE_MIN",
    "UNIT",
    "UNIT_SINGLE",
    "WEIGHT_RATIO",
];

/// Constants whose derivation is prose alone.
const PROSE: &[&str] = &[];

/// Constants whose bound is a matter of underflow, see `underflow`.
const UNDERFLOW: &[&str] = &["LEAST_RISE", "LEAST_SQUARE"];

/// The sources of the constants, those of the planner too.
const FILES: [&str; 5] = [
    "base/tolerance.rs",
    "base/tolerance/motions.rs",
    "base/tolerance/patches.rs",
    "base/tolerance/signs.rs",
    "../plan/src/tolerance.rs",
];

/// The constants of the planner in roundings, as its source has them.
pub(crate) fn of_planner() -> Vec<(&'static str, f64)> {
    let text = std::fs::read_to_string(source("../plan/src/tolerance.rs")).expect("the source is text");
    let value = |name: &'static str| {
        let (_, rest) = text.split_once(&format!("const {name}: f64 = ")).expect("a constant");
        let (count, _) = rest.split_once(" * UNIT;").expect("a count of roundings");
        (name, count.parse().expect("a number"))
    };
    ["ARM_PLACE", "ARM_TURN", "ARM_VALUE", "PLACED"].map(value).to_vec()
}

fn source(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(path)
}

/// The names of all constants.
fn names() -> Vec<String> {
    let mut names = Vec::new();
    for file in FILES {
        let text = std::fs::read_to_string(source(file)).expect("the source is text");
        let of_line = |line: &str| {
            let (_, rest) = line.split_once("const ")?;
            let is_code = line.starts_with("pub");
            is_code.then(|| rest.split(':').next().unwrap_or("").to_owned())
        };
        names.extend(text.lines().filter_map(of_line));
    }
    names
}

#[test]
fn every_constant_is_proved_or_named() {
    let proved = bounds::all();
    for name in names() {
        let lists = [STEERS, LIMITS, PROSE, UNDERFLOW].map(|list| usize::from(list.contains(&&name[..])));
        let count = lists.iter().sum::<usize>() + usize::from(proved.iter().any(|b| b.constant == name));
        assert_eq!(count, 1, "{name} stands in {count} lists");
    }
    let known = names();
    let gone = [STEERS, LIMITS, PROSE, UNDERFLOW].concat();
    let gone: Vec<_> = gone.iter().filter(|n| !known.contains(&(**n).to_owned())).collect();
    assert!(gone.is_empty(), "no constants: {gone:?}");
}

/// The documentation of a constant.
fn documentation(name: &str) -> String {
    let text = FILES.map(|file| std::fs::read_to_string(source(file)).expect("the source is text"));
    let text = text.concat();
    let (before, _) = text.split_once(&format!("const {name}:")).expect("a constant");
    let lines: Vec<&str> = before
        .lines()
        .rev()
        .skip(1)
        .take_while(|l| l.starts_with("//"))
        .collect();
    let words = lines.iter().rev().map(|l| l.trim_start_matches('/').trim());
    words.collect::<Vec<_>>().join(" ")
}

/// A constant that only steers work says so.
#[test]
fn what_steers_says_so() {
    let words = [
        "ot a matter of soundness",
        "teers",
        "osts time only",
        "o bound of an answer",
    ];
    let silent = |name: &&&str| !words.iter().any(|w| documentation(name).contains(w));
    let silent: Vec<_> = STEERS.iter().filter(silent).collect();
    assert!(silent.is_empty(), "{silent:?} do not say that they steer");
}

/// The largest error that the search finds, in the constant's roundings.
fn observed(constant: &str, part: &str, tries: u64) -> Option<f64> {
    let climb = climb::all().find(|c| c.constant == constant && c.part == part)?;
    Some(climb.run(1, tries).0)
}

fn table(tries: u64) -> String {
    let mut text = String::from("| constant | part | allowed | proved | found |\n|---|---|---|---|---|\n");
    let mut row = |name: &str, part: &str, [allowed, proved, found]: [Option<f64>; 3]| {
        let number = |x: Option<f64>, digits: usize| x.map_or(String::new(), |x| format!("{x:.digits$}"));
        let digits = if allowed.is_some_and(|x| x < 2.0) { 3 } else { 2 };
        let up = |x: f64| (x * 10f64.powi(digits)).ceil() / 10f64.powi(digits);
        let (proved, found) = (number(proved.map(up), digits as usize), number(found, 1));
        let allowed = allowed.map_or(String::new(), |x| format!("{}", (x * 1e3).round() / 1e3));
        writeln!(text, "| `{name}` | {part} | {allowed} | {proved} | {found} |").expect("text grows");
    };
    for bound in bounds::all() {
        let Bound { constant, part, .. } = bound;
        let (allowed, proved) = (allowed(&bound), bound.proved.to_f64().value());
        let found = observed(constant, part, tries);
        if let Some(found) = found {
            assert!(found <= proved, "{constant} {part}: {found} found, {proved} proved");
            assert!(tries < TRIES || found > 0.0, "{constant} {part}: nothing found");
        }
        row(constant, part, [Some(allowed), Some(proved), found]);
    }
    let sum = observed("UNIT_DOUBLE_DOUBLE", "sum", tries);
    row(
        "UNIT_DOUBLE_DOUBLE",
        "sum, by Muller and Rideau 2022",
        [Some(10.0), None, sum],
    );
    let list = |names: &[&str]| names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    write!(text, "\nUnderflow by machine: {}.\n", list(UNDERFLOW)).expect("text grows");
    write!(text, "\nBy prose alone: {}.\n", list(PROSE)).expect("text grows");
    write!(
        text,
        "\nLimits, widths and premises, without roundings: {}.\n",
        list(LIMITS)
    )
    .expect("text grows");
    write!(text, "\nConstants that only steer work: {}.\n", list(STEERS)).expect("text grows");
    text
}

#[test]
fn the_table_is_that_of_the_documentation() {
    if let Ok(tries) = std::env::var(LONGER) {
        println!("{}", table(tries.parse().expect("a number of tries")));
    }
    let (text, path) = (table(TRIES), source("base/tolerance/proved.md"));
    if std::env::var(WRITE).is_ok() {
        std::fs::write(&path, &text).expect("the table is written");
    }
    let told = std::fs::read_to_string(&path).expect("the table is text");
    assert!(told == text, "set {WRITE} to write the table anew:\n{text}");
}
