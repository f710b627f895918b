//! Promise: each public term of the glossary has one name. No public item, field, variant, method, name of Python or
//! option of the tool is one of the synonyms that the glossary lists.

use std::collections::BTreeSet;
use std::fs::{read_dir, read_to_string};
use std::path::PathBuf;

use crate::errors::sources;

/// Where a synonym is the name of another thing: the start of a path, the name, and the reason.
const OTHERS: [(&str, &str, &str); 8] = [
    ("src/ray", "safe", "the bracket of a cast: `safe`, `hit`"),
    ("src/scene/answers", "safe", "the bracket of a cast"),
    ("src/time/impact", "safe", "the bracket of a cast"),
    ("crates/capi/src/pair", "safe", "the bracket of a cast"),
    ("crates/capi/src/scene", "safe", "the bracket of a cast"),
    ("crates/record/src/format", "safe", "a key of the file"),
    ("crates/python/lin_canny/_native", "safe", "the bracket of a cast"),
    ("crates/python/lin_canny/trimesh", "", "the names of trimesh"),
];

/// Returns the terms of the glossary with their synonyms.
fn terms() -> Vec<(String, Vec<String>)> {
    let page = read_to_string(crate::root().join("ARCHITECTURE.md")).expect("a page");
    let rows = page
        .lines()
        .skip_while(|line| *line != "| public term | its one meaning | never in names |");
    let rows = rows.skip(2).take_while(|line| line.starts_with('|'));
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let quoted = |cell: &str| cell.split('`').skip(1).step_by(2).map(Into::into).collect();
    rows.map(cells).map(|row| (row[1].clone(), quoted(&row[3]))).collect()
}

/// Returns a name in lower case with `_` between its words: `ExcludedPair` and `excluded-pair` are `excluded_pair`.
fn words(name: &str) -> String {
    let mut text = String::new();
    let mut was_lower = false;
    for letter in name.chars() {
        if letter.is_uppercase() && was_lower {
            text.push('_');
        }
        was_lower = letter.is_lowercase();
        text.extend(if letter == '-' { '_' } else { letter }.to_lowercase());
    }
    text
}

/// Returns the name at the start of a text.
fn name(text: &str) -> Option<&str> {
    let end = text
        .find(|c: char| !c.is_alphanumeric() && c != '_')
        .unwrap_or(text.len());
    (end > 0).then(|| &text[..end])
}

/// Returns the public names of a source of Rust: items, fields, variants, and methods of traits.
fn names_of_rust(source: &str) -> Vec<&str> {
    let mut is_listed = false; // in an enum or a trait, whose entries are public
    let mut found = Vec::new();
    for line in source.lines() {
        let code = line.trim_start();
        let indent = line.len() - code.len();
        if let Some(mut rest) = code.strip_prefix("pub ") {
            for word in ["const ", "unsafe ", "async ", "extern \"C\" "] {
                rest = rest.strip_prefix(word).unwrap_or(rest);
            }
            let kinds = ["fn ", "struct ", "enum ", "trait ", "type ", "mod ", "static "];
            is_listed |= indent == 0 && (rest.starts_with("enum ") || rest.starts_with("trait "));
            let item = kinds.iter().find_map(|kind| rest.strip_prefix(kind));
            found.extend(name(item.unwrap_or(rest)).filter(|name| *name != "use"));
        } else if line == "}" {
            is_listed = false;
        } else if is_listed && [4, 8].contains(&indent) {
            let entry = code.strip_prefix("fn ").unwrap_or(code);
            let is_entry = indent == 4 || entry.split(' ').next().is_some_and(|word| word.ends_with(':'));
            found.extend(name(entry).filter(|_| is_entry));
        }
    }
    found
}

/// Returns the public names of Python's stubs and modules: classes, functions and their parameters.
fn names_of_python(source: &str) -> Vec<&str> {
    let code = source
        .lines()
        .map(str::trim_start)
        .filter(|line| !line.starts_with('#'));
    code.flat_map(|line| {
        let defined = ["def ", "class "].iter().find_map(|word| line.strip_prefix(word));
        let typed = line.split([',', '(']).map(str::trim_start);
        let typed = typed.filter_map(|one| name(one).filter(|name| one[name.len()..].starts_with(':')));
        defined.and_then(name).into_iter().chain(typed)
    })
    .filter(|name| !name.starts_with('_'))
    .collect()
}

/// Returns all public names with the file of each, from the root of the repository.
fn names() -> Vec<(String, String)> {
    let root = crate::root();
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
    for package in read_dir(root.join("crates")).expect("packages") {
        let source = package.expect("a package").path().join("src");
        if source.exists() {
            sources(&source, &mut files);
        }
    }
    let python = read_dir(root.join("crates/python/lin_canny")).expect("the package");
    let python = python.map(|entry| entry.expect("an entry").path());
    files.extend(python.filter(|path: &PathBuf| path.extension().is_some_and(|e| e == "py" || e == "pyi")));
    let mut all = Vec::new();
    for file in files {
        let text = read_to_string(&file).expect("a source");
        let found = match file.extension().is_some_and(|e| e == "rs") {
            true => names_of_rust(&text),
            false => names_of_python(&text),
        };
        let place = file
            .strip_prefix(root)
            .expect("a file of the repository")
            .to_string_lossy();
        all.extend(
            found
                .into_iter()
                .map(|name| (place.replace('\\', "/"), name.to_owned())),
        );
    }
    let help = "crates/cli/tests/transcripts/help.trycmd";
    let text = read_to_string(root.join(help)).expect("the help");
    let options = text.split_whitespace().filter_map(|word| word.strip_prefix("--"));
    let options: BTreeSet<&str> = options
        .filter_map(|word| word.split(['=', '`', ',', '\'']).next())
        .collect();
    all.extend(options.into_iter().map(|name| (help.to_owned(), name.to_owned())));
    all
}

/// Returns whether a name is a synonym, or holds the words of one.
fn is_synonym(name: &str, synonym: &str) -> bool {
    format!("_{}_", words(name)).contains(&format!("_{synonym}_"))
}

#[test]
fn public_names_are_those_of_the_glossary() {
    let terms = terms();
    assert_eq!(terms.len(), 8);
    let names = names();
    assert!(names.len() > 3000, "{}", names.len());
    let is_other = |place: &str, name: &str| {
        let mut others = OTHERS.iter();
        others.any(|(start, other, _)| place.starts_with(start) && (other.is_empty() || is_synonym(name, other)))
    };
    let mut found = Vec::new();
    for (place, name) in &names {
        for (term, synonyms) in &terms {
            if synonyms.iter().any(|one| is_synonym(name, one)) && !is_other(place, name) {
                found.push(format!("{place}: `{name}` (say {term})"));
            }
        }
    }
    found.dedup();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn the_glossary_has_at_most_30_terms() {
    let page = read_to_string(crate::root().join("ARCHITECTURE.md")).expect("a page");
    let glossary = page.split("\n## ").find(|section| section.starts_with("Glossary\n"));
    let rows = glossary
        .expect("a glossary")
        .lines()
        .filter(|line| line.starts_with("| "));
    let count = rows.filter(|line| !line.contains("term |")).count();
    assert!((8..=30).contains(&count), "{count}");
}

#[test]
fn names_are_read() {
    let rust = "pub enum Answer {\n    Kept {\n        safe: f64,\n    },\n}\nimpl Scene {\n    pub fn ignore_pair() {}\n}\n\
                pub struct Row {\n    pub margin: f64,\n    own: f64,\n}\n";
    assert_eq!(
        names_of_rust(rust),
        ["Answer", "Kept", "safe", "ignore_pair", "Row", "margin"]
    );
    let python = "class Scene:\n    def allow(self, a: int, b: int) -> None: ...\n    def _own(self) -> None: ...\n";
    assert_eq!(names_of_python(python), ["Scene", "allow", "a", "b"]);
    assert!(is_synonym("ignorePair", "ignore") && is_synonym("kept-distance", "kept_distance"));
    assert!(!is_synonym("disallowed", "allow"));
}
