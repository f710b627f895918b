//! Promise: each command of a page is in a block that a test runs, or in one that states why none does.
//!
//! The test `pages` of the package `lin-canny-cli` runs the blocks.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// Blocks of commands that no test runs: page, number of blocks, and the reason that stands above each.
const NOT_RUN: &[(&str, usize, &str)] = &[
    ("CONTRIBUTING.md", 1, "lists tests, which change"),
    ("CONTRIBUTING.md", 1, "needs 35 minutes, and runs this test"),
    ("CONTRIBUTING.md", 1, "needs a nightly toolchain and minutes"),
    ("CONTRIBUTING.md", 1, "needs an hour; `.ci/run` runs a minute of it"),
    ("CONTRIBUTING.md", 1, "needs cargo-mutants and hours"),
    ("CONTRIBUTING.md", 1, "needs minutes; `.ci/run` runs these tests"),
    (
        "crates/capi/README.md",
        1,
        "needs an installed library; `.ci/capi` links programs so",
    ),
    ("crates/capi/README.md", 2, "needs CMake; `.ci/capi` runs it"),
    ("crates/cli/README.md", 1, "needs a build of the tool; the tests run it"),
    (
        "crates/python/README.md",
        1,
        "needs a build of the package; `.ci/python` installs its wheel",
    ),
    (
        "crates/python/docs/pages.md",
        1,
        "needs a build of the workspace; `.ci/page` runs the example",
    ),
    (
        "crates/record/README.md",
        1,
        "needs a build of the workspace; `.ci/page` runs the example",
    ),
    (
        "crates/rerun/README.md",
        1,
        "needs a workspace of its own and the viewer; `.ci/rerun` runs its tests",
    ),
    (
        "crates/robot/README.md",
        1,
        "needs a build of the workspace; `.ci/examples` compares the lines, without the times",
    ),
    (
        "crates/study/README.md",
        1,
        "needs a workspace of its own; `.ci/study` runs both commands on 1,000 rows",
    ),
    (
        "crates/study/README.md",
        1,
        "needs a workspace of its own; the tests of the package run such queries",
    ),
    (
        "crates/study/docs/cluster.md",
        1,
        "needs several machines; the tests of the package run a cluster of processes",
    ),
    (
        "crates/study/docs/functions.md",
        3,
        "needs a workspace of its own; the tests of the package run such queries",
    ),
    (
        "docs/studies.md",
        1,
        "needs Python with Ray; `crates/python/tests/test_examples.py` runs both programs",
    ),
    (
        "docs/studies.md",
        1,
        "needs the study, a workspace of its own; `.ci/study` runs these commands",
    ),
    (
        "fuzz/README.md",
        1,
        "needs a nightly toolchain and minutes; `.ci/fuzz` runs all targets",
    ),
    (
        "fuzz/README.md",
        1,
        "needs a nightly toolchain and minutes; `.ci/nightly` runs it for less",
    ),
    ("fuzz/README.md", 1, "needs cargo-fuzz and minutes"),
    (
        "lab/referee/README.md",
        1,
        "needs a build of the package; `.ci/python` judges lin-canny with it",
    ),
    (
        "tests/CASES.md",
        1,
        "needs a build of the workspace; the tests of the package draw suites",
    ),
];

/// Pages whose commands are long measurements, or of their day.
const ELSEWHERE: [&str; 4] = [
    "BENCHMARKS.md",
    "CHANGELOG.md",
    "benches/record/2026-12-01-tables.md",
    "benches/record/README.md",
];

/// Words with which a line of a shell starts.
const PROGRAMS: [&str; 15] = [
    ".ci/",
    "alias ",
    "cargo ",
    "cc ",
    "cd ",
    "cmake ",
    "ctest ",
    "export ",
    "git ",
    "grep ",
    "lin-canny",
    "pip ",
    "python",
    "rerun ",
    "study ",
];

/// Returns the text of a page.
pub(crate) fn read(page: &str) -> String {
    std::fs::read_to_string(crate::root().join(page)).unwrap_or_else(|e| panic!("{page}: {e}"))
}

/// Returns the names of all pages of the repository.
pub(crate) fn pages() -> Vec<String> {
    let mut found = vec![];
    super::links::pages(crate::root(), &mut found);
    let name = |page: &PathBuf| {
        page.strip_prefix(crate::root())
            .expect("a page of the repository")
            .display()
            .to_string()
    };
    let mut names: Vec<String> = found.iter().map(name).collect();
    names.sort();
    names
}

/// A line of a page, with the language of the block that it is in, and the line above the block.
struct Line<'a> {
    text: &'a str,
    /// `None` outside of blocks.
    block: Option<(&'a str, &'a str)>,
    number: usize,
}

fn lines(page: &str) -> Vec<Line<'_>> {
    let (mut found, mut block, mut above) = (vec![], None, "");
    for (text, number) in page.lines().zip(1..) {
        match (text.strip_prefix("```"), block) {
            (Some(language), None) => block = Some((language, above)),
            (Some(_), Some(_)) => block = None,
            (None, _) => found.push(Line { text, block, number }),
        }
        above = text;
    }
    found
}

#[test]
fn commands_of_pages_are_in_blocks_of_a_console() {
    let mut wrong = vec![];
    for page in pages().iter().filter(|page| !ELSEWHERE.contains(&page.as_str())) {
        let text = read(page);
        for Line { text, block, number } in lines(&text) {
            let line = match block {
                None => text.strip_prefix("    ").unwrap_or_default(),
                Some((language, _)) if language.starts_with("console") => continue,
                Some(_) => text,
            };
            let line = line.trim_start_matches("$ ");
            if PROGRAMS.iter().any(|program| line.starts_with(program)) {
                wrong.push(format!("{page}:{number}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn blocks_that_are_not_run_are_listed_with_their_reason() {
    let mut found: BTreeMap<(String, String), usize> = BTreeMap::new();
    let mut run = 0;
    for page in pages() {
        let text = read(&page);
        let blocks = lines(&text);
        let mut last = None;
        for line in blocks
            .iter()
            .filter(|line| line.block.is_some_and(|b| b.0.starts_with("console")))
        {
            let is_next = last.is_some_and(|last| last + 1 == line.number);
            last = Some(line.number);
            let (language, above) = line.block.expect("a block");
            if is_next {
                continue;
            }
            assert!(
                line.text.starts_with("$ "),
                "{page}:{}: a block starts with `$ `",
                line.number
            );
            if language == "console" {
                run += 1;
                continue;
            }
            assert_eq!(language, "console,ignore", "{page}:{}", line.number);
            let reason = above
                .strip_prefix("<!-- not run: ")
                .and_then(|rest| rest.strip_suffix(" -->"));
            let reason = reason.unwrap_or_else(|| panic!("{page}:{}: no reason above the block", line.number));
            *found.entry((page.clone(), reason.to_owned())).or_default() += 1;
        }
    }
    let listed = NOT_RUN
        .iter()
        .map(|(page, count, reason)| ((page.to_string(), reason.to_string()), *count));
    assert_eq!(
        found,
        listed.collect(),
        "the blocks of the pages, and those of `NOT_RUN`"
    );
    assert!(run >= 8, "only {run} blocks are run");
}
