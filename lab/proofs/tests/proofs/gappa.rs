//! The scripts of `lab/proofs/gappa`: roots, quotients and chains of scalars once more, by another prover (Gappa, Daumas and
//! Melquiond 2010). They speak of the source as it stands; `.ci/proofs` runs them where Gappa is installed, and says so
//! where it is not.

use std::path::{Path, PathBuf};

fn scripts() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("gappa");
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "gappa"));
    paths.sort();
    paths
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).expect("text")
}

/// The definition of a constant as the source writes it.
fn definition(name: &str) -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../src");
    let source = text(&root.join("base/tolerance.rs"));
    let (_, rest) = source.split_once(&format!("const {name}: f64 = "))?;
    Some(rest.split(';').next()?.to_owned())
}

#[test]
fn scripts_speak_of_the_source() {
    let mut constants = 0;
    for path in scripts() {
        let script = text(&path);
        for line in script.lines().filter_map(|l| l.strip_prefix("# constant: ")) {
            let (name, value) = line.split_once(" = ").expect("a name and a value");
            assert_eq!(definition(name).as_deref(), Some(value), "{}: {name}", path.display());
            constants += 1;
        }
        for line in script.lines().filter_map(|l| l.strip_prefix("# code: ")) {
            let (file, function) = line.split_once(' ').expect("a file and a function");
            let code = text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file));
            assert!(code.contains(&format!("fn {function}")), "{}: {line}", path.display());
        }
    }
    assert!(constants >= 6, "only {constants} constants");
}
