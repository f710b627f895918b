//! Promise: every public type of options has one style: `#[non_exhaustive]`, public fields, a chained setter named like
//! each field, and default values unless a field has none.

use std::fs::read_to_string;
use std::path::PathBuf;

use crate::errors::sources;

/// Types without default values, and why.
const WITHOUT_DEFAULT: [(&str, &str); 1] = [("SmoothOptions", "the limits of a robot have no default")];

/// Returns what breaks the style in a file, given the text of all files.
fn faults(source: &str, all: &str) -> Vec<String> {
    let lines: Vec<&str> = source.lines().collect();
    let mut faults = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let Some(name) = line
            .strip_prefix("pub struct ")
            .and_then(|rest| rest.split([' ', '<']).next())
        else {
            continue;
        };
        if !(name.ends_with("Options") || name.ends_with("Settings")) {
            continue;
        }
        let above = lines[..k].iter().rev().take_while(|line| line.starts_with(['#', '/']));
        let above: String = above.copied().collect();
        if !above.contains("non_exhaustive") {
            faults.push(format!("{name} is not non_exhaustive"));
        }
        let has_default = above.contains("Default") || all.contains(&format!("Default for {name} "));
        if !has_default && !WITHOUT_DEFAULT.iter().any(|one| one.0 == name) {
            faults.push(format!("{name} has no default values"));
        }
        for field in lines[k + 1..].iter().take_while(|line| **line != "}") {
            let Some(field) = field
                .strip_prefix("    ")
                .filter(|rest| rest.starts_with(char::is_alphabetic))
            else {
                continue;
            };
            let Some(field) = field.strip_prefix("pub ").and_then(|rest| rest.split(':').next()) else {
                faults.push(format!("{name} has a private field: {field}"));
                continue;
            };
            let heads = ["self", "mut self"].map(|own| format!("fn {field}({own}, "));
            if !heads.iter().any(|head| source.contains(head.as_str())) {
                faults.push(format!("{name} has no setter of {field}"));
            }
        }
    }
    faults
}

#[test]
fn types_of_options_have_one_style() {
    let root = crate::root();
    let mut files: Vec<PathBuf> = Vec::new();
    sources(&root.join("src"), &mut files);
    for package in ["parry", "plan", "rapier", "record", "robot", "study", "formats"] {
        sources(&root.join("crates").join(package).join("src"), &mut files);
    }
    let texts: Vec<String> = files
        .iter()
        .map(|file| read_to_string(file).expect("a source"))
        .collect();
    let all = texts.concat();
    let found: Vec<String> = texts.iter().flat_map(|text| faults(text, &all)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
    let count = texts
        .iter()
        .map(|text| text.matches("Options {\n").count())
        .sum::<usize>();
    assert!(count > 10, "{count}");
}

#[test]
fn another_style_is_seen() {
    let source =
        "pub struct ViewOptions {\n    pub far: f64,\n    near: f64,\n}\nimpl ViewOptions {\n    pub fn new() {}\n}\n";
    assert_eq!(faults(source, source).len(), 4);
    let source = "#[derive(Default)]\n#[non_exhaustive]\npub struct ViewOptions {\n    pub far: f64,\n}\nfn far(mut self, far: f64) {}\n";
    assert_eq!(faults(source, source).len(), 0);
}
