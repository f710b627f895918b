//! The table of constants in the documentation of `tolerance`, and a word for every constant.

use super::bounds::allowed;
use proofs::bounds::{self, Bound};
use proofs::climb;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Tries of the search for large errors, of each kernel.
const TRIES: u64 = 50_000;

/// Set to a number of tries: prints what a longer search finds.
const LONGER: &str = "LIN_CANNY_CLIMB";

/// Set to anything: the table is written instead of compared.
const WRITE: &str = "LIN_CANNY_WRITE";

/// The constants of a list.
fn list(name: &str) -> Vec<String> {
    let rows = truth::rows::rows::<1>(include_str!("constants.txt"), name);
    rows.into_iter().map(|[name]| name).collect()
}

/// The lists of constants.
fn lists() -> [Vec<String>; 4] {
    ["steers", "limits", "by hand", "underflow"].map(list)
}

/// The sources of the constants, those of the planner too.
const FILES: [&str; 2] = ["base/tolerance.rs", "../crates/plan/src/tolerance.rs"];

/// The constants of the planner in roundings, as its source has them.
pub(crate) fn of_planner() -> Vec<(&'static str, f64)> {
    let text = std::fs::read_to_string(source("../crates/plan/src/tolerance.rs")).expect("the source is text");
    let value = |name: &'static str| {
        let (_, rest) = text.split_once(&format!("const {name}: f64 = ")).expect("a constant");
        let (count, _) = rest.split_once(" * UNIT;").expect("a count of roundings");
        (name, count.parse().expect("a number"))
    };
    ["ARM_PLACE", "ARM_TURN", "ARM_VALUE", "LENGTH", "PLACED"]
        .map(value)
        .to_vec()
}

fn source(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../src").join(path)
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
        let lists = lists().iter().filter(|list| list.contains(&name)).count();
        let count = lists + usize::from(proved.iter().any(|b| b.constant == name));
        assert_eq!(count, 1, "{name} stands in {count} lists");
    }
    let known = names();
    let gone = lists().concat();
    let gone: Vec<_> = gone.iter().filter(|name| !known.contains(name)).collect();
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
        .skip_while(|l| l.starts_with("#["))
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
    let silent = |name: &String| !words.iter().any(|w| documentation(name).contains(w));
    let silent: Vec<_> = list("steers").into_iter().filter(silent).collect();
    assert!(silent.is_empty(), "{silent:?} do not say that they steer");
}

/// Rows that are sums of others, whose errors are found there: what the table says instead of a figure.
const SUMS: &[(&str, &str)] = &[
    ("PLANE_OFFSET", "sum of `NORMAL_ERROR` and the row above"),
    ("SURFACE_POINT", "sum of `PATCH_POINT` and `KNOTS`"),
];

/// The largest error that the search finds, in the constant's roundings.
fn observed(constant: &str, part: &str, tries: u64) -> Option<f64> {
    let climb = climb::all().find(|c| c.constant == constant && c.part == part)?;
    Some(climb.run(1, tries).0)
}

/// A number of roundings as the table writes it: a bound is rounded up.
fn written(x: f64, is_small: bool, is_bound: bool) -> String {
    let digits = match (is_small, is_bound) {
        (true, _) => 4,
        (false, true) => 2,
        (false, false) => 1,
    };
    let tenths = 10f64.powi(digits);
    let x = if is_bound { (x * tenths).ceil() / tenths } else { x };
    format!("{x:.*}", digits as usize)
}

/// What the search finds, compared with what is proved; or the word for a row without.
fn found(bound: &Bound, is_small: bool, tries: u64) -> String {
    let Bound { constant, part, .. } = bound;
    let sum = SUMS.iter().find(|(name, _)| part.is_empty() && name == constant);
    match (observed(constant, part, tries), sum) {
        (Some(found), None) => {
            let proved = bound.proved.to_f64().value();
            assert!(found <= proved, "{constant} {part}: {found} found, {proved} proved");
            assert!(tries < TRIES || found > 0.0, "{constant} {part}: nothing found");
            written(found, is_small, false)
        }
        (None, Some((_, word))) => (*word).to_owned(),
        (Some(_), Some(_)) => panic!("{constant} {part} is climbed: it needs no word"),
        (None, None) => panic!("{constant} {part} is not climbed, and says no word why"),
    }
}

fn table(tries: u64) -> String {
    let mut text = String::from("| constant | part | allowed | proved | found |\n|---|---|---|---|---|\n");
    for bound in bounds::all() {
        let Bound { constant, part, .. } = &bound;
        let (allowed, proved) = (allowed(&bound), bound.proved.to_f64().value());
        let is_small = allowed < 2.0;
        let found = found(&bound, is_small, tries);
        let proved = written(proved, is_small, true);
        let allowed = (allowed * 1e3).round() / 1e3;
        writeln!(text, "| `{constant}` | {part} | {allowed} | {proved} | {found} |").expect("text grows");
    }
    let sum = observed("UNIT_DOUBLE_DOUBLE", "sum", tries).expect("a kernel that is climbed");
    let sum = written(sum, false, false);
    let by = "by Muller and Rideau 2022";
    writeln!(text, "| `UNIT_DOUBLE_DOUBLE` | sum, {by} | 10 |  | {sum} |").expect("text grows");
    for (what, name) in [
        ("Underflow by machine", "underflow"),
        ("Derived by hand, not transcribed yet", "by hand"),
        ("Limits, widths and premises, without roundings", "limits"),
        ("Constants that only steer work", "steers"),
    ] {
        let names: Vec<String> = list(name).iter().map(|name| format!("`{name}`")).collect();
        write!(text, "\n{what}: {}.\n", names.join(", ")).expect("text grows");
    }
    text
}

/// Nothing is climbed that no bound speaks of.
#[test]
fn every_climb_has_a_bound() {
    let all = bounds::all();
    let known = |c: &climb::Climb| {
        let of_literature = c.constant == "UNIT_DOUBLE_DOUBLE" && c.part == "sum";
        of_literature || all.iter().any(|b| b.constant == c.constant && b.part == c.part)
    };
    let lost: Vec<_> = climb::all()
        .filter(|c| !known(c))
        .map(|c| (c.constant, c.part))
        .collect();
    assert!(lost.is_empty(), "{lost:?}");
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
