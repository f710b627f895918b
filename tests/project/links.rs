//! Promise: no page of the repository refers to a file that does not exist.

use std::path::{Path, PathBuf};

/// Folders without pages of this repository.
const SKIPPED: [&str; 3] = ["target", ".git", "node_modules"];

pub(crate) fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
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

/// Returns the targets of the links of a page, without those in code blocks and code spans.
fn links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (k, block) in text.split("```").enumerate() {
        let prose: String = block.split('`').step_by(2).collect();
        if k % 2 == 0 {
            let targets = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
            found.extend(targets.map(str::to_owned));
        }
    }
    found
}

#[test]
fn links_of_all_pages_lead_to_files() {
    let root = crate::root();
    let mut all = Vec::new();
    pages(root, &mut all);
    let (mut seen, mut missing) = (0, Vec::new());
    for page in &all {
        let text = std::fs::read_to_string(page).expect("a page is text");
        for link in links(&text) {
            let target = link.split('#').next().unwrap_or_default();
            // rustdoc checks the items of the library.
            let is_elsewhere = target.is_empty() || target.contains("://") || target.contains("::");
            seen += usize::from(!is_elsewhere);
            if !is_elsewhere && !page.parent().expect("a folder").join(target).exists() {
                missing.push(format!("{}: {link}", page.strip_prefix(root).unwrap_or(page).display()));
            }
        }
    }
    assert!(all.len() > 25 && seen > 60, "{} pages, {seen} links", all.len());
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Paths in code spans exist: `crates/...`, `lab/...`, `tests/...` and the like.
#[test]
fn paths_in_pages_exist() {
    let root = crate::root();
    let folders = [
        "benches/",
        "crates/",
        "docs/",
        "examples/",
        "fuzz/",
        "images/",
        "lab/",
        "src/",
        "tests/",
        ".ci/",
    ];
    let mut all = Vec::new();
    pages(root, &mut all);
    let (mut seen, mut missing) = (0, Vec::new());
    for page in all {
        let text = std::fs::read_to_string(&page).expect("a page is text");
        for span in text.split('`').skip(1).step_by(2) {
            let is_path = folders.iter().any(|f| span.starts_with(f))
                && !span.contains([' ', '*', '{', '<', '\n'])
                && !span.contains("DATE");
            let path = span.trim_end_matches(['.', ',']).split('#').next().unwrap_or_default();
            // A page of a package may also name its own folders.
            let is_there = || {
                page.ancestors()
                    .skip(1)
                    .any(|folder| folder.starts_with(root) && folder.join(path).exists())
            };
            seen += usize::from(is_path);
            if is_path && !is_there() {
                missing.push(format!(
                    "{}: {span}",
                    page.strip_prefix(root).unwrap_or(&page).display()
                ));
            }
        }
    }
    assert!(seen > 50, "{seen} paths");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}
