//! Text in the encodings of mesh and point files: UTF-8, UTF-16 and Latin-1, with or without a byte order
//! mark.

use std::borrow::Cow;

/// Number of bytes that decide a format.
const START: usize = 4096;

/// Returns the beginning of a file as text, without a byte order mark and white space in front.
pub(crate) fn start(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(START)];
    decode(start).trim_start().to_owned()
}

/// Returns the first line, without white space behind it.
pub(crate) fn first_line(text: &str) -> &str {
    text.split(['\n', '\r']).next().unwrap_or(text).trim_end()
}

/// Returns why a file is none of the formats of this crate under any name: it is empty, or
/// replaces the file that somebody wanted to download.
pub(crate) fn foreign(bytes: &[u8]) -> Option<&'static str> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Some("the file is empty");
    }
    let lower = start(bytes).to_ascii_lowercase();
    if lower.starts_with("version https://git-lfs") {
        return Some("the file is a pointer of Git LFS; `git lfs pull` replaces it by its content");
    }
    (lower.starts_with("<!doctype html") || lower.starts_with("<html")).then_some("the file is a page of HTML")
}

/// Returns the text of a file.
///
/// A byte order mark decides between UTF-8 and UTF-16. Without one, bytes that are not valid UTF-8
/// are read as Latin-1, which gives every byte a letter.
pub(crate) fn decode(bytes: &[u8]) -> String {
    let wide = |pairs: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = pairs.as_chunks::<2>().0.iter().map(|&pair| unit(pair)).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => utf8_or_latin1(rest),
        // XML without a mark.
        [b'<', 0, ..] => wide(bytes, u16::from_le_bytes),
        [0, b'<', ..] => wide(bytes, u16::from_be_bytes),
        _ => utf8_or_latin1(bytes),
    }
}

/// Returns the bytes of a file whose header is text and whose body may be binary: without the byte
/// order mark of UTF-8, and as UTF-8 if the mark is that of UTF-16.
pub(crate) fn without_mark(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Cow::Owned(decode(bytes).into_bytes()),
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        _ => Cow::Borrowed(bytes),
    }
}

fn utf8_or_latin1(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// Returns a finite number; `None` for anything else.
pub(crate) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|x: &f64| x.is_finite())
}

/// Returns a number as sensors write it: NaN for `nan`, `inf` and what C prints for them; `None` for
/// a word that is no number or out of range, such as `1e400`.
pub(crate) fn measured(word: &str) -> Option<f64> {
    let lower = word.to_ascii_lowercase();
    match lower.strip_prefix(['+', '-']).unwrap_or(&lower) {
        "nan" | "inf" | "infinity" => Some(f64::NAN),
        mark if mark.starts_with("nan(") || mark.starts_with("1.#") => Some(f64::NAN),
        _ => number(word),
    }
}

/// Returns a word of a file for an error, cut if it is long.
pub(crate) fn quoted(word: &str) -> String {
    let start: String = word.chars().take(24).collect();
    if start.len() < word.len() {
        format!("{start:?}...")
    } else {
        format!("{start:?}")
    }
}

/// Returns the lines of a text, counted from 1. A line ends with LF, CR or CR LF.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let now = rest?;
        let Some(end) = now.find(['\n', '\r']) else {
            rest = None;
            return Some(now);
        };
        let after = &now[end..];
        rest = Some(after.strip_prefix("\r\n").unwrap_or(&after[1..]));
        Some(&now[..end])
    })
    .enumerate()
    .map(|(k, line)| (k + 1, line))
}
