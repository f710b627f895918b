//! The text of a file, by its encoding.

use std::path::Path;

use crate::error::{FileError, FileErrorKind};

/// The byte order mark that some programs write at the start of a text.
const MARK: char = '\u{feff}';

/// The characters of the bytes 0x80 to 0x9f in windows-1252; those without a meaning stay.
const WINDOWS: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘', '’',
    '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

impl FileError {
    /// Returns the text of a file.
    pub(crate) fn read(file: &Path) -> Result<String, Self> {
        let bytes = std::fs::read(file).map_err(|e| Self::new(file, None, "", FileErrorKind::Read(e)))?;
        decode(&bytes).map_err(|(line, reason)| Self::new(file, Some(line), "", reason))
    }
}

/// Returns the text of a file without its byte order mark, or the line that is wrong and why.
///
/// UTF-16 is known by its first bytes, other encodings by the declaration of an XML file. A file
/// that declares none is UTF-8.
pub(crate) fn decode(bytes: &[u8]) -> Result<String, (u32, FileErrorKind)> {
    match bytes {
        [0xff, 0xfe, rest @ ..] => return utf_16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => return utf_16(rest, u16::from_be_bytes),
        [b'<', 0, b'?', 0, ..] => return utf_16(bytes, u16::from_le_bytes),
        [0, b'<', 0, b'?', ..] => return utf_16(bytes, u16::from_be_bytes),
        _ => {}
    }
    let declared = declared_encoding(bytes).unwrap_or_default();
    match declared.to_ascii_lowercase().as_str() {
        _ if bytes.starts_with(MARK.to_string().as_bytes()) => utf_8(bytes),
        "" | "utf-8" | "utf8" | "us-ascii" | "ascii" | "utf-16" => utf_8(bytes),
        "iso-8859-1" | "latin1" | "latin-1" => Ok(bytes.iter().copied().map(char::from).collect()),
        "windows-1252" | "cp1252" => Ok(bytes.iter().copied().map(windows).collect()),
        _ => {
            let rule = "expected utf-8, utf-16, iso-8859-1 or windows-1252";
            let reason = FileErrorKind::Malformed(format!("unsupported encoding: {declared:?} ({rule})"));
            Err((1, reason))
        }
    }
}

/// Returns an error if a text is empty, or stands for a file that was not fetched.
pub(crate) fn check_content(text: &str) -> Result<(), FileErrorKind> {
    let wrong = |what: &str| Err(FileErrorKind::Malformed(what.into()));
    match text.trim_start_matches(MARK).trim_start() {
        "" => wrong("the file is empty"),
        text if text.starts_with("version https://git-lfs.github.com/") => {
            wrong("the file is a Git LFS pointer (expected its content); run `git lfs pull` first")
        }
        _ => Ok(()),
    }
}

fn windows(byte: u8) -> char {
    let letter = byte.checked_sub(0x80).and_then(|k| WINDOWS.get(usize::from(k)));
    letter.copied().unwrap_or(char::from(byte))
}

/// Returns the encoding that the declaration of an XML file names.
fn declared_encoding(bytes: &[u8]) -> Option<String> {
    let start: String = bytes.iter().take(400).copied().map(char::from).collect();
    let declaration = start.trim_start().strip_prefix("<?xml")?.split_once("?>")?.0;
    let value = declaration.split_once("encoding")?.1.trim_start().strip_prefix('=')?;
    let quote = value.trim_start().chars().next()?;
    Some(value.trim_start().strip_prefix(quote)?.split_once(quote)?.0.to_owned())
}

fn utf_8(bytes: &[u8]) -> Result<String, (u32, FileErrorKind)> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let (right, wrong) = bytes.split_at(e.valid_up_to());
        let byte = wrong.first().copied().unwrap_or_default();
        let rule = "expected UTF-8, or XML that declares its encoding";
        let line = 1 + right.iter().filter(|b| **b == b'\n').count() as u32;
        (
            line,
            FileErrorKind::Malformed(format!("not UTF-8: byte {byte:#04x} ({rule})")),
        )
    })?;
    Ok(text.strip_prefix(MARK).unwrap_or(text).to_owned())
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, (u32, FileErrorKind)> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let mut text = String::new();
    for letter in char::decode_utf16(pairs.iter().map(|pair| unit(*pair))) {
        match letter {
            Ok(letter) => text.push(letter),
            Err(_) => return Err(not_utf_16(&text)),
        }
    }
    match rest {
        [] => Ok(text),
        _ => Err(not_utf_16(&text)),
    }
}

fn not_utf_16(before: &str) -> (u32, FileErrorKind) {
    let line = 1 + before.matches('\n').count() as u32;
    (
        line,
        FileErrorKind::Malformed("not UTF-16 (expected pairs of bytes)".into()),
    )
}
