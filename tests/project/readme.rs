//! Promise: the README shows the example `hello` verbatim, and every file that it links exists.

use crate::read;
use std::path::Path;

/// The packages of the workspace that have programs, examples or tests.
const PACKAGES: [&str; 16] = [
    ".",
    "crates/capi",
    "crates/clash",
    "crates/cli",
    "crates/formats",
    "crates/parry",
    "crates/plan",
    "crates/rapier",
    "crates/record",
    "crates/robot",
    "crates/verify",
    "lab/bits",
    "lab/cases",
    "lab/proofs",
    "lab/race",
    "lab/truth",
];

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(crate::root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn the_readme_shows_hello() {
    let hello = read("examples/hello.rs");
    let code = &hello[hello.find("use ").expect("hello uses the crate")..];
    assert!(
        read("README.md").contains(code),
        "README.md and examples/hello.rs differ"
    );
}

#[test]
fn files_of_the_readme_exist() {
    let readme = read("README.md");
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let files = links.filter_map(|l| l.split('#').next());
    let local: Vec<&str> = files.filter(|l| !l.starts_with("http")).collect();
    assert!(local.len() >= 4, "{local:?}");
    local
        .iter()
        .for_each(|name| assert!(!bytes(name).is_empty(), "{name} is empty"));
}

/// A page that is longer belongs into the documentation of the crate, into `-h`, or into `docs/`.
#[test]
fn first_pages_are_short() {
    let names = super::pages::pages();
    let of_members = |page: &&String| {
        ["crates/", "lab/"].iter().any(|folder| page.starts_with(folder))
            && page.ends_with("/README.md")
            && page.matches('/').count() == 2
    };
    let members: Vec<&String> = names.iter().filter(of_members).collect();
    assert!(members.len() > 13, "{members:?}");
    let limit = |page: &str| if page == "crates/cli/README.md" { 150 } else { 100 };
    let pages = members.into_iter().map(|page| (page.as_str(), limit(page)));
    let long: Vec<_> = pages
        .chain([("README.md", 100), ("BENCHMARKS.md", 250)])
        .map(|(page, limit)| (page, read(page).lines().count(), limit))
        .filter(|(_, lines, limit)| lines > limit)
        .collect();
    assert!(long.is_empty(), "page, lines, limit: {long:?}");
}

/// Every `cargo ... --test NAME`, `--example NAME` and `--bin NAME` of a page exists in a package. The
/// records and CHANGELOG.md name programs of their day.
#[test]
fn commands_of_pages_exist() {
    let root = crate::root();
    let mut seen = 0;
    let all = super::pages::pages();
    let is_of_today = |page: &&String| !page.starts_with("benches/") && *page != "CHANGELOG.md";
    let texts: Vec<String> = all.iter().filter(is_of_today).map(|page| read(page)).collect();
    for (flag, folder) in [("--test ", "tests"), ("--example ", "examples"), ("--bin ", "src/bin")] {
        for rest in texts.iter().flat_map(|text| text.split(flag).skip(1)) {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let is_there = |package: &str| {
                let folder = root.join(package).join(folder);
                folder.join(format!("{name}.rs")).exists() || folder.join(&name).join("main.rs").exists()
            };
            assert!(name == "NAME" || PACKAGES.into_iter().any(is_there), "{flag}{name}");
            seen += 1;
        }
    }
    assert!(seen > 35, "{seen}");
}

/// Every example of the table of examples exists, and the table lists every example.
#[test]
fn the_table_of_examples_is_complete() {
    let readme = read("examples/README.md");
    let rows = readme.lines().filter(|l| l.starts_with("| `"));
    let first = rows.filter_map(|l| l.split('|').nth(1));
    let mut named: Vec<String> = first
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .map(Into::into)
        .collect();
    named.sort();
    let folder = crate::root().join("examples");
    let entries = std::fs::read_dir(folder)
        .expect("examples")
        .map(|e| e.expect("an entry").path());
    let is_example = |p: &std::path::PathBuf| p.extension().is_some_and(|e| e == "rs") || p.join("main.rs").exists();
    let stem = |p: std::path::PathBuf| p.file_stem().expect("a name").to_string_lossy().into_owned();
    let mut there: Vec<String> = entries.filter(is_example).map(stem).collect();
    there.sort();
    assert_eq!(named, there);
}

/// Columns of a line of code that the documentation site shows without a scroll bar.
const CODE: usize = 80;

/// Returns the lines of Rust in the documentation of a source file: line number and text, without
/// hidden lines.
fn doc_code(text: &str) -> Vec<(usize, String)> {
    let (mut is_code, mut is_rust, mut found) = (false, false, vec![]);
    for (line, number) in text.lines().zip(1..) {
        let trimmed = line.trim_start();
        let Some(doc) = trimmed.strip_prefix("///").or(trimmed.strip_prefix("//!")) else {
            (is_code, is_rust) = (false, false);
            continue;
        };
        let doc = doc.strip_prefix(' ').unwrap_or(doc);
        if doc.trim_start().starts_with("```") {
            is_rust = !is_code && ["```", "```no_run", "```rust"].contains(&doc.trim());
            is_code = !is_code;
        } else if is_code && is_rust && !doc.trim_start().starts_with("# ") {
            found.push((number, doc.to_owned()));
        }
    }
    found
}

fn source_files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            source_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn code_of_the_documentation_is_narrow_and_needs_no_other_crate() {
    let mut files = vec![];
    source_files(&crate::root().join("src"), &mut files);
    let (mut lines, mut faults) = (0, vec![]);
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source file");
        for (number, line) in doc_code(&text) {
            lines += 1;
            if line.chars().count() > CODE || line.starts_with("use nalgebra::") {
                faults.push(format!("{}:{number}: {line}", file.display()));
            }
        }
    }
    assert!(lines > 300, "only {lines} lines of code found");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Returns the rows of all tables under a header, without the markup of links.
fn rows(text: &str, header: &str) -> Vec<String> {
    let lines = text.lines().map(|l| l.trim_start_matches("//! "));
    let (mut rows, mut is_table) = (vec![], false);
    for line in lines {
        is_table = line == header || is_table && line.starts_with('|');
        let is_row = is_table && line != header && !line.starts_with("|---");
        rows.extend(is_row.then(|| without_links(line)));
    }
    rows
}

/// Returns `text` with `[name](target)` and `[name]` as `name`.
fn without_links(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        let (name, tail) = after.split_once(']').expect("a link ends");
        plain.push_str(before);
        plain.push_str(name);
        rest = match tail.strip_prefix('(') {
            Some(target) => target.split_once(')').expect("a target ends").1,
            None => tail,
        };
    }
    plain + rest
}

/// The questions of the README are questions of the front page of the documentation, word for word.
#[test]
fn questions_of_the_readme_are_those_of_the_documentation() {
    let (readme, front) = (read("README.md"), read("src/lib.rs"));
    let questions = "| question | call | answer |";
    let (some, all) = (rows(&readme, questions), rows(&front, questions));
    let other: Vec<_> = some.iter().filter(|row| !all.contains(row)).collect();
    assert!(other.is_empty(), "not in the documentation: {other:#?}");
    assert_eq!(some.len(), 6);
}
