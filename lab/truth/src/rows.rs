//! Cases of a test as rows of a text, so that a new case is one line.
//!
//! ```text
//! # A comment.
//! $box = <box size="1 1 1"/>
//!
//! == numbers of a box
//! <geometry>$box</geometry>   | 1 1 1
//! <geometry>\n$box</geometry> | 2 1 1
//! ```
//!
//! A row belongs to the section above, and its fields are apart by bars. Blanks around a field are
//! not part of it. `\n`, `\r`, `\t` and `\s` (a blank) are letters of a field, and a backslash before
//! any other letter is left out, so that `\|`, `\#` and `\\` stand for a bar, a `#` at the start of
//! a line, and a backslash. A line `$name = text` gives text a name, which the lines below may use.
//!
//! The tests of `lin-canny-formats` and the package `truth` use this file, so it depends on neither.

use std::collections::BTreeMap;

/// Returns the rows of a section.
///
/// ```
/// use truth::rows::{numbers, rows};
/// let text = r"
/// $unit = <size>1 1 1</size>
///
/// == sizes
/// <box>$unit</box>       | 1 1 1
/// <box>\n\|$none</box>\s  | 2
/// == others
/// | three | fields
/// ";
/// let [one, two] = rows::<2>(text, "sizes").try_into().unwrap();
/// assert_eq!(one, ["<box><size>1 1 1</size></box>", "1 1 1"]);
/// assert_eq!(two, ["<box>\n|$none</box> ", "2"]);
/// assert_eq!(numbers(&one[1]), [1.0, 1.0, 1.0]);
/// assert_eq!(numbers(&two[1]), [2.0, 2.0, 2.0]);
/// assert_eq!(rows(text, "others"), [["", "three", "fields"]]);
/// ```
///
/// # Panics
/// Panics if the text has no such section, or if a row of the section has another count of fields.
pub fn rows<const N: usize>(text: &str, section: &str) -> Vec<[String; N]> {
    let mut names = BTreeMap::new();
    let (mut is_in, mut rows) = (false, Vec::new());
    for (k, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(heading) = line.strip_prefix("== ") {
            is_in = heading == section;
        } else if let Some((name, text)) = line.strip_prefix('$').and_then(|line| line.split_once(" = ")) {
            names.insert(name.to_owned(), expanded(text, &names));
        } else if is_in {
            let fields = fields(&expanded(line, &names));
            let count = fields.len();
            let row = fields.try_into();
            rows.push(row.unwrap_or_else(|_| panic!("line {} has {count} fields (expected {N}): {line}", k + 1)));
        }
    }
    assert!(!rows.is_empty(), "section \"{section}\" has no rows");
    rows
}

/// Returns a line with the texts of its names; a `$` before anything else stays.
fn expanded(line: &str, names: &BTreeMap<String, String>) -> String {
    let mut parts = line.split('$');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_');
        let (name, rest) = part.split_at(end.unwrap_or(part.len()));
        match names.get(name) {
            Some(value) => text += value,
            None => text.extend(["$", name]),
        }
        text += rest;
    }
    text
}

/// Returns the fields of a line.
fn fields(line: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut letters = line.chars();
    while let Some(letter) = letters.next() {
        let last = parts.len() - 1;
        match letter {
            '|' => parts.push(String::new()),
            '\\' => {
                parts[last].push(letter);
                parts[last].extend(letters.next());
            }
            _ => parts[last].push(letter),
        }
    }
    parts.iter().map(|part| plain(part.trim())).collect()
}

/// Returns a field with its letters in place of what is written with a backslash.
fn plain(field: &str) -> String {
    let mut letters = field.chars();
    let mut text = String::new();
    while let Some(letter) = letters.next() {
        text.push(match letter {
            '\\' => match letters.next() {
                Some('n') => '\n',
                Some('r') => '\r',
                Some('t') => '\t',
                Some('s') => ' ',
                Some(other) => other,
                None => '\\',
            },
            _ => letter,
        });
    }
    text
}

/// Returns the numbers of a field, apart by blanks; one number stands for all.
///
/// # Panics
/// Panics if the field has another count of numbers.
pub fn numbers<const N: usize>(field: &str) -> [f64; N] {
    let numbers: Vec<f64> = field
        .split_whitespace()
        .map(|word| word.parse().unwrap_or_else(|_| panic!("no number: {word}")))
        .collect();
    match numbers[..] {
        [all] => [all; N],
        _ => numbers
            .try_into()
            .unwrap_or_else(|_| panic!("expected {N} numbers: {field}")),
    }
}
