//! The part of YAML in which ROS writes messages, as a value of JSON.
//!
//! Block and flow mappings and sequences, plain and quoted scalars, comments, one document. Anchors,
//! aliases, tags, block scalars and complex keys are errors.

use serde_json::{Map, Value};

/// Maximum depth of a value.
const DEPTH: u32 = 32;

/// An error: line, counted from 1, and reason.
type Fault = (u32, String);

/// A line without its comment.
#[derive(Clone, Copy)]
struct Line<'a> {
    indent: usize,
    text: &'a str,
    number: u32,
}

/// Returns the value of a text.
pub(crate) fn parse(text: &str) -> Result<Value, Fault> {
    let mut lines = Vec::new();
    let mut is_ended = false;
    for (number, raw) in (1..).zip(text.strip_prefix('\u{feff}').unwrap_or(text).lines()) {
        let line = without_comment(raw).trim_end();
        let text = line.trim_start_matches(' ');
        if text.is_empty() || line.starts_with('%') {
            continue;
        }
        if line == "---" || line == "..." {
            is_ended = !lines.is_empty();
            continue;
        }
        if is_ended {
            return Err((number, "several documents (expected one)".into()));
        }
        if text.starts_with('\t') {
            return Err((number, "tab in the indentation".into()));
        }
        let indent = line.len() - text.len();
        lines.push(Line { indent, text, number });
    }
    let mut reader = Reader { lines, at: 0 };
    let Some(first) = reader.peek() else {
        return Err((1, "no value".into()));
    };
    let value = reader.block(first.indent, 0)?;
    match reader.peek() {
        Some(line) => Err((line.number, "unexpected indentation".into())),
        None => Ok(value),
    }
}

/// Cuts off a comment, which starts a line or follows a space, outside quotes.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (k, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') if before.is_whitespace() => return &line[..k],
            (None, '\'' | '"') if !before.is_alphanumeric() => quote = Some(c),
            (Some(q), _) if q == c => quote = None,
            _ => {}
        }
        before = c;
    }
    line
}

struct Reader<'a> {
    lines: Vec<Line<'a>>,
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<Line<'a>> {
        self.lines.get(self.at).copied()
    }

    /// Reads the value whose lines have this indentation.
    fn block(&mut self, indent: usize, depth: u32) -> Result<Value, Fault> {
        let Some(line) = self.peek() else {
            return Ok(Value::Null);
        };
        if depth > DEPTH {
            return Err((line.number, format!("too deep (expected a depth of at most {DEPTH})")));
        }
        if item(line.text).is_some() {
            return self.sequence(indent, depth);
        }
        if entry(line.text).is_some() {
            return self.mapping(indent, depth);
        }
        self.at += 1;
        self.scalar(line.text, line.number)
    }

    fn sequence(&mut self, indent: usize, depth: u32) -> Result<Value, Fault> {
        let mut list = Vec::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent) {
            let Some(rest) = item(line.text) else { break };
            list.push(if rest.is_empty() {
                self.at += 1;
                self.nested(indent, false, depth)?
            } else {
                // The rest of the line is the first line of the item.
                let indent = indent + line.text.len() - rest.len();
                self.lines[self.at] = Line {
                    indent,
                    text: rest,
                    number: line.number,
                };
                self.block(indent, depth + 1)?
            });
        }
        Ok(Value::Array(list))
    }

    fn mapping(&mut self, indent: usize, depth: u32) -> Result<Value, Fault> {
        let mut map = Map::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent) {
            let Some((key, rest)) = entry(line.text) else {
                return Err((line.number, format!("no key: {:?}", line.text)));
            };
            let key = match plain(key, line.number)? {
                Value::String(key) => key,
                other => other.to_string(),
            };
            self.at += 1;
            let value = match rest {
                "" => self.nested(indent, true, depth)?,
                _ => self.scalar(rest, line.number)?,
            };
            if map.insert(key.clone(), value).is_some() {
                return Err((line.number, format!("key {key:?} is given twice")));
            }
        }
        Ok(Value::Object(map))
    }

    /// Reads the value below a key or a dash; a sequence may have the indentation of its key.
    fn nested(&mut self, indent: usize, is_key: bool, depth: u32) -> Result<Value, Fault> {
        match self.peek() {
            Some(line) if line.indent > indent => self.block(line.indent, depth + 1),
            Some(line) if is_key && line.indent == indent && item(line.text).is_some() => self.block(indent, depth + 1),
            _ => Ok(Value::Null),
        }
    }

    /// Reads a scalar or a flow collection, which may go on in the next lines.
    fn scalar(&mut self, text: &str, number: u32) -> Result<Value, Fault> {
        if !text.starts_with(['[', '{']) {
            return plain(text, number);
        }
        let mut all = text.to_owned();
        while open_brackets(&all) > 0 {
            let Some(line) = self.peek() else {
                return Err((number, "bracket is not closed".into()));
            };
            self.at += 1;
            all.push(' ');
            all.push_str(line.text);
        }
        let mut flow = Flow { rest: &all, number };
        let value = flow.value(0)?;
        match flow.rest.trim() {
            "" => Ok(value),
            rest => Err((number, format!("text after a bracket: {rest:?}"))),
        }
    }
}

/// Returns what follows the dash of an item.
fn item(text: &str) -> Option<&str> {
    let rest = text.strip_prefix('-')?;
    (rest.is_empty() || rest.starts_with(' ')).then(|| rest.trim_start())
}

/// Returns key and rest of an entry of a mapping.
fn entry(text: &str) -> Option<(&str, &str)> {
    if text.starts_with(['[', '{']) {
        return None;
    }
    let from = match text.chars().next() {
        Some(quote @ ('\'' | '"')) => text[1..].find(quote)? + 2,
        _ => 0,
    };
    let colon = text[from..].match_indices(':').map(|(k, _)| from + k).find(|k| {
        let after = &text[k + 1..];
        after.is_empty() || after.starts_with(' ')
    })?;
    Some((text[..colon].trim_end(), text[colon + 1..].trim()))
}

fn open_brackets(text: &str) -> i32 {
    let mut quote = None;
    let mut open = 0;
    for c in text.chars() {
        match (quote, c) {
            (Some(q), _) if q == c => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '[' | '{') => open += 1,
            (None, ']' | '}') => open -= 1,
            _ => {}
        }
    }
    open
}

/// Returns the value of a scalar.
fn plain(text: &str, number: u32) -> Result<Value, Fault> {
    let text = text.trim();
    if let Some(rest) = text.strip_prefix('"') {
        // Escapes are those of JSON.
        let whole = rest.ends_with('"').then(|| serde_json::from_str::<String>(text).ok());
        return whole
            .flatten()
            .map(Value::String)
            .ok_or_else(|| (number, format!("invalid string: {text}")));
    }
    if let Some(rest) = text.strip_prefix('\'') {
        let inner = rest
            .strip_suffix('\'')
            .ok_or_else(|| (number, format!("invalid string: {text}")))?;
        return Ok(Value::String(inner.replace("''", "'")));
    }
    if text.starts_with(['&', '*', '!', '|', '>', '?', '@', '`', '%']) {
        let reason = "anchors, aliases, tags, block scalars and complex keys are not supported";
        return Err((number, format!("{reason}: {text:?}")));
    }
    Ok(match text {
        "" | "~" | "null" => Value::Null,
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        _ => {
            let is_number = text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'));
            let value = text.parse::<f64>().ok().filter(|_| is_number);
            let number = value.and_then(serde_json::Number::from_f64);
            number.map_or_else(|| Value::String(text.into()), Value::Number)
        }
    })
}

/// The rest of a flow collection.
struct Flow<'a> {
    rest: &'a str,
    number: u32,
}

impl Flow<'_> {
    fn fault(&self, reason: &str) -> Fault {
        (self.number, format!("{reason} in brackets"))
    }

    /// Takes this letter after spaces, if it is next.
    fn takes(&mut self, letter: char) -> bool {
        self.rest = self.rest.trim_start();
        let rest = self.rest.strip_prefix(letter);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn value(&mut self, depth: u32) -> Result<Value, Fault> {
        if depth > DEPTH {
            return Err(self.fault("too deep"));
        }
        if self.takes('[') {
            let mut list = Vec::new();
            while !self.takes(']') {
                list.push(self.value(depth + 1)?);
                if !self.takes(',') && !self.rest.trim_start().starts_with(']') {
                    return Err(self.fault("no comma"));
                }
            }
            return Ok(Value::Array(list));
        }
        if self.takes('{') {
            let mut map = Map::new();
            while !self.takes('}') {
                let key = match self.word()? {
                    Value::String(key) => key,
                    other => other.to_string(),
                };
                if !self.takes(':') {
                    return Err(self.fault("no colon"));
                }
                let value = self.value(depth + 1)?;
                if map.insert(key, value).is_some() {
                    return Err(self.fault("key given twice"));
                }
                if !self.takes(',') && !self.rest.trim_start().starts_with('}') {
                    return Err(self.fault("no comma"));
                }
            }
            return Ok(Value::Object(map));
        }
        self.word()
    }

    fn word(&mut self) -> Result<Value, Fault> {
        self.rest = self.rest.trim_start();
        let end = match self.rest.chars().next() {
            Some(quote @ ('\'' | '"')) => self.rest[1..].find(quote).map(|k| k + 2),
            _ => self.rest.find([',', ']', '}', ':', '[', '{']),
        };
        let end = end.ok_or_else(|| self.fault("no end"))?;
        if end == 0 {
            return Err(self.fault("no value"));
        }
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        plain(word, self.number)
    }
}
