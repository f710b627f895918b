//! The grammar of a line: the part of JSON that receipts use, without blanks and escapes.

mod fields;

use crate::Stop;

/// A value; texts are parts of the line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json<'a> {
    Object(Vec<(&'a str, Json<'a>)>),
    Array(Vec<Json<'a>>),
    Text(&'a str),
    Whole(usize),
}

/// Deepest nesting of objects and arrays.
const DEPTH: usize = 8;

impl<'a> Json<'a> {
    pub(crate) fn parse(text: &'a str) -> Result<Self, Stop> {
        let mut rest = text;
        let value = Self::value(&mut rest, 0)?;
        if !matches!(value, Self::Object(_)) || !rest.is_empty() {
            return Stop::bad("not one object");
        }
        Ok(value)
    }

    fn value(rest: &mut &'a str, depth: usize) -> Result<Self, Stop> {
        match rest.as_bytes().first() {
            Some(b'{' | b'[') if depth == DEPTH => Stop::bad("nested too deep"),
            Some(b'{') => {
                let mut all: Vec<(&str, Self)> = Vec::new();
                list(rest, '}', |rest| {
                    let key = text(rest)?;
                    take(rest, ':')?;
                    if all.iter().any(|x| x.0 == key) || all.len() == 16 {
                        return Stop::bad(format!("field {key} is there twice, or too many fields"));
                    }
                    all.push((key, Self::value(rest, depth + 1)?));
                    Ok(())
                })?;
                Ok(Self::Object(all))
            }
            Some(b'[') => {
                let mut all = Vec::new();
                list(rest, ']', |rest| {
                    all.push(Self::value(rest, depth + 1)?);
                    Ok(())
                })?;
                Ok(Self::Array(all))
            }
            Some(b'"') => Ok(Self::Text(text(rest)?)),
            Some(b'0'..=b'9') => {
                let end = rest.bytes().position(|c| !c.is_ascii_digit()).unwrap_or(rest.len());
                let (digits, after) = rest.split_at(end);
                if end > 9 || end > 1 && digits.starts_with('0') {
                    return Stop::bad("a whole number has zeros in front or more than 9 digits");
                }
                *rest = after;
                digits
                    .parse()
                    .map(Self::Whole)
                    .map_err(|_| Stop::Bad("a whole number".into()))
            }
            _ => Stop::bad("not a value of the format"),
        }
    }
}

fn take(rest: &mut &str, c: char) -> Result<(), Stop> {
    *rest = rest
        .strip_prefix(c)
        .ok_or_else(|| Stop::Bad(format!("{c} is expected")))?;
    Ok(())
}

/// Whether a character ends a line, changes how the others are shown, or starts an escape.
fn is_refused(c: char) -> bool {
    match c {
        '\\' | '\u{2028}' | '\u{2029}' | '\u{200e}' | '\u{200f}' => true,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        _ => c.is_control(),
    }
}

fn text<'a>(rest: &mut &'a str) -> Result<&'a str, Stop> {
    take(rest, '"')?;
    let (text, after) = rest.split_once('"').ok_or(Stop::Bad("a text without end".into()))?;
    if text.chars().any(is_refused) {
        return Stop::bad("a text with an escape or a control character");
    }
    *rest = after;
    Ok(text)
}

/// Reads entries, separated by commas, from the opening bracket to the closing one.
fn list<'a>(rest: &mut &'a str, end: char, mut each: impl FnMut(&mut &'a str) -> Result<(), Stop>) -> Result<(), Stop> {
    *rest = &rest[1..];
    if let Some(after) = rest.strip_prefix(end) {
        *rest = after;
        return Ok(());
    }
    loop {
        each(rest)?;
        if let Some(after) = rest.strip_prefix(end) {
            *rest = after;
            return Ok(());
        }
        take(rest, ',')?;
    }
}
