//! YAML, in which ROS writes messages, as a value of JSON.
//!
//! One document, without anchors, aliases, tags and complex keys: they are errors.

use saphyr_parser::{Event, Parser, ScalarStyle};
use serde_json::{Map, Number, Value};

/// Maximum depth of a value.
const DEPTH: usize = 32;

/// An error: line, counted from 1, and reason.
type Fault = (u32, String);

/// A collection that has not ended.
enum Open {
    List(Vec<Value>),
    /// With the key whose value comes next.
    Map(Map<String, Value>, Option<String>),
}

/// Returns the value of a text.
pub(crate) fn parse(text: &str) -> Result<Value, Fault> {
    // The line of the last document's start.
    let (mut open, mut whole, mut start) = (Vec::new(), None, 1);
    // The reader counts the end of a text without a line break as a line of its own.
    let lines = text.split('\n').count();
    for event in Parser::new_from_str(text.strip_prefix('\u{feff}').unwrap_or(text)) {
        let (event, span) =
            event.map_err(|error| (error.marker().line().min(lines) as u32, error.info().to_owned()))?;
        let fault = |reason: String| Err((span.start.line() as u32, reason));
        let value = match event {
            Event::DocumentStart(_) => {
                start = span.start.line() as u32;
                continue;
            }
            // A line `---` at the end, as ROS prints it, starts an empty document.
            Event::Scalar(text, ScalarStyle::Plain, ..) if whole.is_some() && open.is_empty() && text.is_empty() => {
                continue;
            }
            Event::Scalar(..) | Event::Alias(_) | Event::SequenceStart(..) | Event::MappingStart(..)
                if whole.is_some() && open.is_empty() =>
            {
                return Err((start, "several documents (expected one)".into()));
            }
            Event::SequenceStart(0, None) | Event::MappingStart(0, None) if open.len() == DEPTH => {
                return fault(format!("too deep (expected a depth of at most {DEPTH})"));
            }
            Event::SequenceStart(0, None) => {
                open.push(Open::List(Vec::new()));
                continue;
            }
            Event::MappingStart(0, None) => {
                open.push(Open::Map(Map::new(), None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List(list)) => Value::Array(list),
                Some(Open::Map(map, _)) => Value::Object(map),
                None => continue,
            },
            Event::Scalar(text, ScalarStyle::Plain, 0, None) => plain(&text),
            Event::Scalar(text, _, 0, None) => Value::String(text.into_owned()),
            Event::Scalar(..) | Event::Alias(_) | Event::SequenceStart(..) | Event::MappingStart(..) => {
                return fault("anchors, aliases and tags are not supported".into());
            }
            _ => continue,
        };
        match open.last_mut() {
            None => whole = Some(value),
            Some(Open::List(list)) => list.push(value),
            Some(Open::Map(map, next @ None)) => {
                let key = match value {
                    Value::String(key) => key,
                    Value::Array(_) | Value::Object(_) => return fault("complex keys are not supported".into()),
                    other => other.to_string(),
                };
                if map.contains_key(&key) {
                    return fault(format!("key {key:?} is given twice"));
                }
                *next = Some(key);
            }
            Some(Open::Map(map, next)) => {
                map.insert(next.take().unwrap_or_default(), value);
            }
        }
    }
    whole.ok_or_else(|| (1, "no value".into()))
}

/// Returns the value of a scalar without quotes.
fn plain(text: &str) -> Value {
    match text {
        "" | "~" | "null" => Value::Null,
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        _ => {
            let is_number = text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'));
            let value = text.parse::<f64>().ok().filter(|_| is_number);
            let number = value.and_then(Number::from_f64);
            number.map_or_else(|| Value::String(text.into()), Value::Number)
        }
    }
}
