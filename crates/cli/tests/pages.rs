//! Promise: the commands of all pages print what the pages show. `TRYCMD=overwrite` writes it again.
//!
//! The blocks of a page with the language `console` run one after the other in a copy of
//! `crates/robot/examples`. A block `console,ignore` is not run: the test `pages` of the library
//! lists these blocks with their reasons.

use std::path::{Path, PathBuf};

/// Folders without pages of this repository.
const SKIPPED: [&str; 3] = ["target", ".git", "node_modules"];

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) {
            pages(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// Returns the folder of the repository and its pages.
fn repository() -> (PathBuf, Vec<PathBuf>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().expect("the repository");
    let mut all = vec![];
    pages(&root, &mut all);
    (root, all)
}

#[cfg(unix)]
#[test]
fn commands_of_pages_print_what_the_pages_show() {
    use std::os::unix::fs::symlink;

    let (root, mut all) = repository();
    let is_run = |page: &PathBuf| {
        std::fs::read_to_string(page)
            .expect("a page is text")
            .contains("\n```console\n")
    };
    all.retain(is_run);
    assert!(all.len() >= 2, "{all:?}");

    // trycmd takes the files of a page from the folder beside it, and runs it in a copy if there is another.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    for page in &all {
        let name = page
            .strip_prefix(&root)
            .expect("a page of the repository")
            .to_string_lossy()
            .replace('/', "-");
        let link = folder.join(name);
        symlink(page, &link).expect("a link to a page");
        symlink(root.join("crates/robot/examples"), link.with_extension("in")).expect("a link to the examples");
        std::fs::create_dir(link.with_extension("out")).expect("a folder");
    }
    let cases = trycmd::TestCases::new();
    cases.register_bin("lin-canny", Path::new(env!("CARGO_BIN_EXE_lin-canny")));
    for name in ["cat", "cksum", "head", "tail"] {
        cases.register_bin(name, Path::new("/usr/bin").join(name).as_path());
    }
    cases.case(folder.join("*.md"));
}

/// Pages that name commands of their day.
const OF_THEIR_DAY: [&str; 3] = ["BENCHMARKS.md", "CHANGELOG.md", "benches/record/2026-12-01-tables.md"];

/// Returns the code spans of a page that are commands of the tool.
fn spans(text: &str) -> Vec<&str> {
    let prose = text.split("\n```").step_by(2);
    let spans = prose.flat_map(|part| part.split('`').skip(1).step_by(2));
    spans.filter(|span| span.starts_with("lin-canny ")).collect()
}

#[test]
fn options_of_commands_in_sentences_exist() {
    let (root, mut all) = repository();
    let is_of_today = |page: &PathBuf| {
        let page = page.strip_prefix(&root).expect("a page of the repository");
        !page.starts_with("benches/record") && OF_THEIR_DAY.iter().all(|old| page != Path::new(old))
    };
    all.retain(is_of_today);
    let mut seen = 0;
    for page in &all {
        let text = std::fs::read_to_string(page).expect("a page is text");
        for span in spans(&text) {
            let words: Vec<&str> = span.split_whitespace().collect();
            let help = std::process::Command::new(env!("CARGO_BIN_EXE_lin-canny"))
                .args([words[1], "--help"])
                .output();
            let help = help.expect("the tool runs");
            assert!(help.status.success(), "{}: `{span}`", page.display());
            let help = String::from_utf8_lossy(&help.stdout).into_owned();
            for option in words.iter().filter(|word| word.starts_with("--")) {
                let option = option.split('=').next().unwrap_or_default();
                let is_there = help.split_whitespace().any(|word| word.trim_end_matches(',') == option);
                assert!(is_there, "{}: `{span}` has {option}", page.display());
            }
            seen += 1;
        }
    }
    assert!(seen >= 5, "{seen}");
}
