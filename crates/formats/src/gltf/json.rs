//! The JSON of a glTF: objects with the path of their element, which errors name.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use crate::error::Fault;
use crate::text;

/// Returns the value of a text in which no object has a key twice: of two values of a key, JSON
/// does not say which one counts.
pub(super) fn parse(text: &str) -> Result<Value, Fault> {
    let parsed = serde_json::from_str::<Unique>(text);
    parsed.map(|unique| unique.0).map_err(|error| {
        let why = error.to_string();
        // The fault has a line of its own.
        let why = why.split(" at line ").next().unwrap_or_default();
        Fault::malformed(
            Some(error.line()).filter(|line| *line > 0),
            format!("invalid JSON: {why}"),
        )
    })
}

struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Values).map(Self)
    }
}

struct Values;

impl<'de> Visitor<'de> for Values {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        let number = Number::from_f64(value).map(Value::Number);
        number.ok_or_else(|| E::custom("a number is not finite"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(Unique(value)) = seq.next_element()? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut values = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            if values.contains_key(&key) {
                return Err(A::Error::custom(format!("key is there twice: {}", text::quoted(&key))));
            }
            let Unique(value) = map.next_value()?;
            values.insert(key, value);
        }
        Ok(Value::Object(values))
    }
}

/// An object of the file.
#[derive(Clone)]
pub(super) struct Item<'a> {
    /// Where the object is: `meshes[0].primitives[1]`; empty for the file.
    pub(super) path: String,
    value: &'a Map<String, Value>,
}

impl<'a> Item<'a> {
    /// Returns the object of a value.
    pub(super) fn new(path: String, value: &'a Value) -> Result<Self, Fault> {
        match value {
            Value::Object(value) => Ok(Self { path, value }),
            _ => Err(Fault::malformed(
                None,
                format!("{path} is invalid (expected an object)"),
            )),
        }
    }

    pub(super) fn malformed(&self, why: impl fmt::Display) -> Fault {
        let path = if self.path.is_empty() { "the file" } else { &self.path };
        Fault::malformed(None, format!("{path} {why}"))
    }

    pub(super) fn unsupported(&self, what: impl fmt::Display) -> Fault {
        let path = if self.path.is_empty() { "the file" } else { &self.path };
        Fault::unsupported(None, format!("{path}: {what}"))
    }

    /// Returns the error of a property that has a wrong value.
    pub(super) fn invalid(&self, key: &str, rule: impl fmt::Display) -> Fault {
        let value = self.value.get(key).map(Value::to_string).unwrap_or_default();
        // Strings have quotes already.
        let shown: String = value.chars().take(24).collect();
        let dots = if shown.len() < value.len() { "..." } else { "" };
        self.malformed(format!("has an invalid {key}: {shown}{dots} (expected {rule})"))
    }

    /// Returns an error if the object has a property that is not one of the keys: it may be a
    /// misspelt one.
    pub(super) fn check_keys(&self, keys: &[&str]) -> Result<(), Fault> {
        let known = |key: &str| keys.contains(&key) || matches!(key, "name" | "extensions" | "extras");
        match self.value.keys().find(|key| !known(key)) {
            Some(key) => Err(self.malformed(format!("has an unknown property: {}", text::quoted(key)))),
            None => Ok(()),
        }
    }

    pub(super) fn keys(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.value.keys().map(String::as_str)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.value.contains_key(key)
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, Fault> {
        match self.value.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(_) => Err(self.invalid(key, "a string")),
        }
    }

    pub(super) fn is(&self, key: &str) -> Result<bool, Fault> {
        match self.value.get(key) {
            None => Ok(false),
            Some(Value::Bool(is)) => Ok(*is),
            Some(_) => Err(self.invalid(key, "true or false")),
        }
    }

    /// Returns a whole number from 0. The format allows to write it as `1.0` or `1e0`.
    pub(super) fn whole(&self, key: &str) -> Result<Option<usize>, Fault> {
        let Some(value) = self.value.get(key) else {
            return Ok(None);
        };
        match whole(value) {
            Some(number) => Ok(Some(number)),
            None => Err(self.invalid(key, "a whole number from 0")),
        }
    }

    /// Returns an array; an empty one if the object does not have it.
    pub(super) fn list(&self, key: &str) -> Result<&'a [Value], Fault> {
        match self.value.get(key) {
            None => Ok(&[]),
            Some(Value::Array(list)) => Ok(list),
            Some(_) => Err(self.invalid(key, "an array")),
        }
    }

    /// Returns an array of numbers.
    pub(super) fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>, Fault> {
        if !self.has(key) {
            return Ok(None);
        }
        let numbers: Option<Vec<f64>> = self.list(key)?.iter().map(Value::as_f64).collect();
        numbers.map(Some).ok_or_else(|| self.invalid(key, "numbers"))
    }

    /// Returns an array of exactly `N` numbers.
    pub(super) fn vector<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        match self.numbers(key)?.map(<[f64; N]>::try_from) {
            None => Ok(None),
            Some(Ok(vector)) => Ok(Some(vector)),
            Some(Err(_)) => Err(self.invalid(key, format!("{N} numbers"))),
        }
    }

    /// Returns an array of whole numbers below a count.
    pub(super) fn indices(&self, key: &str, count: usize) -> Result<Vec<usize>, Fault> {
        let indices = self.list(key)?.iter().map(|value| whole(value).filter(|k| *k < count));
        let rule = || format!("whole numbers from 0 to less than {count}");
        indices.collect::<Option<_>>().ok_or_else(|| self.invalid(key, rule()))
    }

    pub(super) fn object(&self, key: &str) -> Result<Option<Self>, Fault> {
        let path = match &self.path[..] {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        };
        self.value.get(key).map(|value| Self::new(path, value)).transpose()
    }

    /// Returns an object of an array.
    pub(super) fn element(&self, key: &str, index: usize) -> Result<Self, Fault> {
        let path = match &self.path[..] {
            "" => format!("{key}[{index}]"),
            path => format!("{path}.{key}[{index}]"),
        };
        match self.list(key)?.get(index) {
            Some(value) => Self::new(path, value),
            None => Err(Fault::malformed(None, format!("{path} does not exist"))),
        }
    }

    /// Returns the objects of an array.
    pub(super) fn elements(&self, key: &str) -> Result<impl Iterator<Item = Result<Self, Fault>>, Fault> {
        Ok((0..self.list(key)?.len()).map(move |index| self.element(key, index)))
    }

    /// Returns an extension.
    pub(super) fn extension(&self, name: &str) -> Result<Option<Self>, Fault> {
        match self.object("extensions")? {
            Some(extensions) => extensions.object(name),
            None => Ok(None),
        }
    }
}

fn whole(value: &Value) -> Option<usize> {
    // All whole numbers below 2^53 are exact.
    let number = value.as_f64()?;
    let is_whole = (0.0..9_007_199_254_740_992.0).contains(&number) && number.fract() == 0.0;
    is_whole.then_some(number as usize)
}
