//! Promise: suites have every family and all contact states, the naive oracle gives the same answers,
//! and the package is built on no engine.

use cases::families::{self, CORE, EXTREME, QUERIES};
use cases::maker::Precision;
use cases::shapes::Shape;
use cases::suite::{self, Case, Line, Reader};
use cases::{ContactState, exact};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::process::Command;

fn drawn(suite: &str, seed: u64, count: usize, precision: Precision) -> (HashMap<usize, Shape>, Vec<Case>) {
    let mut text = Vec::new();
    let names = families::suite(suite).expect("a suite");
    families::write(&mut text, suite, &names, seed, count, precision).expect("memory");
    let (mut shapes, mut all) = (HashMap::new(), Vec::new());
    for line in Reader::new(&text[..]) {
        match line.expect("a line of the format") {
            Line::Header(h) => assert_eq!((h.name.as_str(), h.seed), (suite, seed)),
            Line::Shape(s) => drop(shapes.insert(s.id, s.shape)),
            Line::Case(case) => all.push(*case),
            Line::Query(case) => panic!("{case:?}"),
        }
    }
    (shapes, all)
}

/// Queries of every family have every state, are read as they were written, and change with the seed.
#[test]
fn queries_have_their_families_and_all_states() {
    for precision in [Precision::Double, Precision::Single] {
        let mut text = Vec::new();
        families::write(&mut text, "queries", &QUERIES, 3, 40, precision).expect("memory");
        let lines: Vec<Line> = Reader::new(&text[..]).map(|line| line.expect("a line")).collect();
        let mut again = Vec::new();
        lines
            .iter()
            .for_each(|line| suite::write(&mut again, line).expect("memory"));
        assert!(text == again);
        for family in QUERIES {
            let states = lines.iter().filter_map(|line| match line {
                Line::Query(case) if case.family == family => case.truth.map(|truth| truth.state),
                _ => None,
            });
            let states: Vec<ContactState> = states.collect();
            let of = |state| states.iter().filter(|s| **s == state).count();
            let [apart, touching, over] = [
                ContactState::Separated,
                ContactState::Touching,
                ContactState::Overlapping,
            ]
            .map(of);
            assert_eq!(states.len(), 40);
            assert!(
                apart > 1 && touching > 0 && over > 1,
                "{family}: {apart} {touching} {over}"
            );
        }
    }
}

#[test]
fn suites_have_their_families_and_all_states() {
    let (_, all) = drawn("standard", 3, 30, Precision::Double);
    let has = |family: &str, state| {
        all.iter()
            .filter(|c| c.family == family && c.truth.as_ref().expect("solved").state == state)
            .count()
    };
    for family in CORE.into_iter().chain(EXTREME) {
        let [apart, touching, over] = [
            ContactState::Separated,
            ContactState::Touching,
            ContactState::Overlapping,
        ]
        .map(|s| has(family, s));
        let enough = match family {
            "touching" => touching == 30,
            "deep" => over == 30,
            "equal" => over == 30,
            "flat" => apart > 2,
            _ => apart > 1 && over > 1,
        };
        assert!(
            enough && apart + touching + over == 30,
            "{family}: {apart} {touching} {over}"
        );
    }
}

#[test]
fn the_naive_oracle_gives_the_same_answers() {
    for precision in [Precision::Double, Precision::Single] {
        let (shapes, all) = drawn("standard", 4, 10, precision);
        let mut seen = 0;
        for case in &all {
            let (a, b) = (&shapes[&case.a], &shapes[&case.b]);
            let is_small = |s: &Shape| s.points.len() <= 16 && !s.faces.is_empty();
            if !is_small(a) || !is_small(b) {
                continue;
            }
            let naive = exact::solve(a.into(), &case.pose_a, b.into(), &case.pose_b);
            let truth = case.truth.as_ref().expect("solved");
            assert_eq!(
                (truth.state, truth.distance, truth.remainder),
                (naive.state, naive.distance, naive.remainder),
                "{} {}",
                case.family,
                case.level
            );
            seen += 1;
        }
        assert!(seen > 70, "{seen}");
    }
}

#[test]
fn single_files_hold_numbers_of_single_precision() {
    let (shapes, all) = drawn("standard", 5, 10, Precision::Single);
    let is_single = |x: &f64| f64::from(*x as f32).to_bits() == x.to_bits();
    assert!(shapes.values().flat_map(|s| s.points.iter().flatten()).all(is_single));
    for case in &all {
        let poses = [case.pose_a, case.pose_b];
        assert!(
            poses.iter().all(|p| p.q.iter().chain(&p.t).all(is_single)),
            "{}",
            case.id
        );
    }
}

/// A seed draws a family alike, whatever other families are drawn.
#[test]
fn families_do_not_depend_on_each_other() {
    let (_, all) = drawn("standard", 6, 10, Precision::Double);
    let (_, alone) = drawn("extreme", 6, 10, Precision::Double);
    let poses = |cases: &[Case]| -> Vec<_> {
        let of_far = cases.iter().filter(|c| c.family == "far");
        of_far.map(|c| (c.pose_a, c.pose_b)).collect()
    };
    assert_eq!(poses(&all), poses(&alone));
}

/// `cargo tree` lists the package, what computes with large integers, JSON, options, and what these
/// are built on; no other package of the repository, and no engine.
#[test]
fn the_package_is_built_on_no_engine() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--locked",
            "--offline",
            "--package",
            "cases",
            "--edges",
            "normal,build",
            "--prefix",
            "none",
        ])
        .args(["--format", "{p}"])
        .current_dir(folder)
        .output()
        .expect("cargo");
    let text = String::from_utf8(output.stdout).expect("text");
    let built_on: BTreeSet<&str> = text.lines().filter_map(|l| l.split(' ').next()).collect();
    assert!(
        built_on.contains("dashu-int"),
        "{text} {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let here: Vec<&str> = text
        .lines()
        .filter(|l| l.contains("(/") && !l.starts_with("cases "))
        .collect();
    assert!(here.is_empty(), "packages of the repository: {here:?}");
    let engines = [
        "lin-canny",
        "parry3d",
        "parry3d-f64",
        "rapier3d",
        "nalgebra",
        "truth",
        "race",
    ];
    assert!(engines.iter().all(|name| !built_on.contains(name)), "{built_on:?}");
}
