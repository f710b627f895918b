//! Promise: each command of a page is in a block that a test runs, or in one that states why none does.
//!
//! The test `pages` of the package `lin-canny-cli` runs the blocks.

use std::collections::BTreeMap;
use std::path::PathBuf;

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
    let listed = truth::rows::rows(include_str!("not_run.txt"), "not run").into_iter();
    let listed = listed.map(|[page, count, reason]| ((page, reason), count.parse().expect("a count")));
    assert_eq!(
        found,
        listed.collect(),
        "the blocks of the pages, and those of `not_run.txt`"
    );
    assert!(run >= 8, "only {run} blocks are run");
}
