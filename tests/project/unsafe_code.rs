//! Promise: only the C interface has `unsafe` code, and each of its blocks states why it is sound.

use std::path::{Path, PathBuf};

/// The package that may use `unsafe`.
const EXCEPTION: &str = "crates/capi";

/// Returns the folders of all packages.
fn packages() -> Vec<PathBuf> {
    let below = ["crates", "lab"].into_iter().flat_map(|folder| {
        let entries = std::fs::read_dir(crate::root().join(folder)).expect("the repository is readable");
        entries.map(|e| e.expect("the repository is readable").path())
    });
    let all: Vec<_> = below
        .chain([crate::root().to_path_buf()])
        .filter(|p| p.join("Cargo.toml").exists())
        .collect();
    assert!(all.len() > 12, "{all:?}");
    all
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_other_package_forbids_unsafe_code() {
    for package in packages() {
        let manifest = std::fs::read_to_string(package.join("Cargo.toml")).expect("a manifest");
        let is_exception = package.ends_with(EXCEPTION);
        let found = manifest.contains("unsafe_code = \"forbid\"");
        assert_eq!(found, !is_exception, "{}", package.display());
        if is_exception {
            assert!(manifest.contains("undocumented_unsafe_blocks = \"deny\""));
            assert!(manifest.contains("unsafe_op_in_unsafe_fn = \"deny\""));
        }
    }
}

/// Clippy checks the same where it runs; this test needs no build of the package.
#[test]
fn every_unsafe_block_of_the_interface_states_its_contract() {
    let mut files = Vec::new();
    sources(&crate::root().join(EXCEPTION).join("src"), &mut files);
    let mut blocks = 0;
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source file");
        let lines: Vec<&str> = text.lines().collect();
        for (k, line) in lines.iter().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            if !code.contains("unsafe {") && !code.contains("unsafe impl") {
                continue;
            }
            blocks += 1;
            // The comment is above the statement, which may have started some lines before.
            let before = lines[k.saturating_sub(6)..k].iter();
            assert!(
                before.clone().any(|l| l.trim_start().starts_with("// SAFETY: ")),
                "{}:{}: no contract",
                file.display(),
                k + 1
            );
        }
    }
    assert!(blocks > 50, "{blocks}");
}
