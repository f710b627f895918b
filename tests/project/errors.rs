//! Every text of an error reads as the pattern of CONTRIBUTING.md says: lower case, no full stop, at most 120 characters, the value in
//! front of the rule, and the words of the project.

use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

/// Words that say less than `invalid`, `out of range`, `not finite`, `does not exist` or `cannot`.
const VAGUE: [&str; 7] = [
    "refused",
    "is no ",
    "no number",
    "that is none",
    "makes no",
    "called for",
    "reaches",
];

pub(crate) fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path()) {
        if entry.is_dir() && !entry.ends_with("target") {
            sources(&entry, into);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            into.push(entry);
        }
    }
}

/// Returns the texts of all `#[error("...")]` of a source file.
fn texts(source: &str) -> Vec<String> {
    let attributes = source.split("#[error(").skip(1).map(str::trim_start);
    let literals = attributes.filter_map(|rest| rest.strip_prefix('"'));
    literals
        .map(|rest| {
            let mut text = String::new();
            let mut letters = rest.chars();
            while let Some(letter) = letters.next().filter(|c| *c != '"') {
                match (letter, letters.as_str().starts_with('\n')) {
                    ('\\', true) => letters = letters.as_str().trim_start().chars(),
                    ('\\', false) => text.extend(letters.next()),
                    _ => text.push(letter),
                }
            }
            text
        })
        .collect()
}

/// Returns what is wrong with a text.
fn faults(text: &str) -> Vec<&'static str> {
    let words = text.replace("{expected}", "");
    let is_bare = words.matches("expected").count() != words.matches("(expected").count();
    let all = [
        (text.starts_with(char::is_uppercase), "begins with a capital"),
        (text.ends_with('.'), "ends with a full stop"),
        (text.chars().count() > 120, "is longer than 120 characters"),
        (
            VAGUE.iter().any(|word| text.contains(word)),
            "has a word that says too little",
        ),
        (
            text.contains("out of range") && !text.contains('{'),
            "does not show the value",
        ),
        (is_bare, "has a rule without parentheses"),
    ];
    all.into_iter().filter_map(|(is, name)| is.then_some(name)).collect()
}

#[test]
fn texts_of_errors_follow_the_pattern() {
    let root = crate::root();
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
    sources(&root.join("crates"), &mut files);
    let mut count = 0;
    let mut wrong = Vec::new();
    for file in files {
        for text in texts(&read_to_string(&file).expect("a source file")) {
            count += 1;
            wrong.extend(
                faults(&text)
                    .iter()
                    .map(|f| format!("{}: {text:?} {f}", file.display())),
            );
        }
    }
    assert!(count > 130, "only {count} texts were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_text_outside_the_pattern_is_seen() {
    assert_eq!(texts("#[error(\n  \"a \\\"b\\\" \\\n   c\", d)]"), ["a \"b\" c"]);
    for text in [
        "The x is bad",
        "x is bad.",
        "x is refused",
        "x is out of range",
        "x: 1, expected 2",
    ] {
        assert_eq!(faults(text).len(), 1, "{text}");
    }
    assert!(faults("x is out of range: {x} (expected 0..=1)").is_empty());
}
