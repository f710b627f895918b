//! What pairs of parts must keep, and which pairs are not looked at, in the words of a cell.

use serde::Deserialize;

use crate::error::ClashError;

/// Rules for the pairs of a model.
///
/// A name may have `*`, which stands for any letters: `frame/*` are all parts of the file or folder
/// `frame`. A rule of two names holds for both orders.
///
/// ```
/// use lin_canny_clash::Rules;
///
/// let rules = Rules::from_json(
///     r#"{"margin": 0.001, "margins": [["bolt*", "*", 0]], "exclude": [["seal", "lid", "soft"]]}"#,
/// )?;
/// assert_eq!(rules.required("lid", "box").distance, 0.001);
/// assert_eq!(rules.required("box", "bolt#2").distance, 0.0);
/// assert_eq!(rules.excluded("lid", "seal"), Some("soft"));
/// assert!(Rules::from_json(r#"{"margn": 1}"#).is_err());
/// # Ok::<(), lin_canny_clash::ClashError>(())
/// ```
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rules {
    /// The distance that all pairs must keep.
    margin: f64,
    /// Two names, and the distance that their pairs must keep, instead of the margin. The last rule that
    /// matches counts.
    margins: Vec<(String, String, f64)>,
    /// A name, and how much more the pairs of the part must keep.
    paddings: Vec<(String, f64)>,
    /// Two names whose pairs are not looked at, and optionally the reason.
    exclude: Vec<Excluded>,
    /// Two names, and the depth that their overlap may have: a press fit.
    allowed_depth: Vec<(String, String, f64)>,
    /// Two names, and the volume that they may share.
    allowed_volume: Vec<(String, String, f64)>,
    /// Whether parts that touch break a rule.
    touching: bool,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
enum Excluded {
    Pair([String; 2]),
    WithReason([String; 3]),
}

impl Excluded {
    fn names(&self) -> (&str, &str) {
        match self {
            Self::Pair([a, b]) | Self::WithReason([a, b, _]) => (a, b),
        }
    }

    fn reason(&self) -> &str {
        match self {
            Self::Pair(_) => "excluded",
            Self::WithReason([.., reason]) => reason,
        }
    }
}

/// The distance that a pair must keep, and the rule that says so.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Required {
    /// The distance.
    pub distance: f64,
    /// The rule, such as `margins[0] + paddings[1]`; empty if nothing is required.
    pub rule: String,
}

impl Rules {
    /// Returns the rules of a JSON text. All keys are optional:
    ///
    /// | key | value |
    /// |---|---|
    /// | `margin` | the distance that all pairs must keep |
    /// | `margins` | rows of two names and the distance that their pairs must keep, instead of the margin; the last row that matches counts |
    /// | `paddings` | rows of a name and how much more the pairs of the part must keep |
    /// | `exclude` | rows of two names whose pairs are left out, and optionally the reason |
    /// | `allowed_depth`, `allowed_volume` | rows of two names and the depth or the volume that their overlap may have |
    /// | `touching` | whether parts that touch break a rule; false by default |
    ///
    /// # Errors
    /// Returns an error if the text is no JSON, has an unknown key, or a length that is negative.
    pub fn from_json(text: &str) -> Result<Self, ClashError> {
        // An object: a list would be taken for the values in their order.
        let invalid = |error: serde_json::Error| ClashError::Rules(error.to_string());
        let object: serde_json::Map<String, serde_json::Value> = serde_json::from_str(text).map_err(invalid)?;
        serde_json::from_value::<Self>(object.into())
            .map_err(invalid)?
            .checked()
    }

    /// Returns the rules of a TOML text, with the keys of [`from_json`](Self::from_json).
    ///
    /// # Errors
    /// As [`from_json`](Self::from_json).
    pub fn from_toml(text: &str) -> Result<Self, ClashError> {
        let rules: Self = toml::from_str(text).map_err(|error| ClashError::Rules(error.to_string()))?;
        rules.checked()
    }

    /// Returns an error if a length is negative or not finite.
    fn checked(self) -> Result<Self, ClashError> {
        let rules = self;
        check_length("margin", rules.margin)?;
        let lists = [
            ("margins", &rules.margins),
            ("allowed_depth", &rules.allowed_depth),
            ("allowed_volume", &rules.allowed_volume),
        ];
        for (key, list) in lists {
            for (k, rule) in list.iter().enumerate() {
                check_length(&format!("{key}[{k}]"), rule.2)?;
            }
        }
        for (k, rule) in rules.paddings.iter().enumerate() {
            check_length(&format!("paddings[{k}]"), rule.1)?;
        }
        Ok(rules)
    }

    /// Returns the distance that a pair must keep: that of the last rule of `margins` that matches or else
    /// the margin, and the paddings of both.
    #[must_use]
    pub fn required(&self, a: &str, b: &str) -> Required {
        let mut rule = Vec::new();
        let own = self
            .margins
            .iter()
            .enumerate()
            .rev()
            .find(|(_, (x, y, _))| match_pair((x, y), (a, b)));
        let mut distance = match own {
            Some((k, (_, _, distance))) => {
                rule.push(format!("margins[{k}]"));
                *distance
            }
            None => {
                if self.margin > 0.0 {
                    rule.push("margin".into());
                }
                self.margin
            }
        };
        for name in [a, b] {
            for (k, (pattern, padding)) in self.paddings.iter().enumerate() {
                if matches(pattern, name) {
                    rule.push(format!("paddings[{k}]"));
                    distance += padding;
                }
            }
        }
        Required {
            distance,
            rule: rule.join(" + "),
        }
    }

    /// Returns the reason why a pair is not looked at, if it is not.
    #[must_use]
    pub fn excluded(&self, a: &str, b: &str) -> Option<&str> {
        let mut rows = self.exclude.iter();
        Some(rows.find(|row| match_pair(row.names(), (a, b)))?.reason())
    }

    /// Returns the depth that the overlap of a pair may have, and the rule.
    pub(crate) fn allowed_depth(&self, a: &str, b: &str) -> Option<(f64, String)> {
        allowed(&self.allowed_depth, "allowed_depth", a, b)
    }

    /// Returns the volume that a pair may share, and the rule.
    pub(crate) fn allowed_volume(&self, a: &str, b: &str) -> Option<(f64, String)> {
        allowed(&self.allowed_volume, "allowed_volume", a, b)
    }

    /// Returns whether parts that touch break a rule.
    pub(crate) fn forbids_touching(&self) -> bool {
        self.touching
    }

    /// Returns the largest distance that any pair must keep.
    pub(crate) fn largest(&self) -> f64 {
        let margins = self.margins.iter().map(|rule| rule.2);
        let paddings: f64 = self.paddings.iter().map(|rule| 2.0 * rule.1).sum();
        margins.fold(self.margin, larger) + paddings
    }

    /// Returns the rules that match no pair of these names, such as `exclude[2] ("seal", "lid")`: a name may
    /// be misspelt.
    #[must_use]
    pub fn unused(&self, names: &[&str]) -> Vec<String> {
        let is_known = |pattern: &str| names.iter().any(|name| matches(pattern, name));
        let pairs = |rows: &[(String, String, f64)], key: &str| -> Vec<String> {
            let rows = rows
                .iter()
                .enumerate()
                .filter(|(_, (x, y, _))| !(is_known(x) && is_known(y)));
            rows.map(|(k, (x, y, _))| format!("{key}[{k}] ({x:?}, {y:?})"))
                .collect()
        };
        let mut found = pairs(&self.margins, "margins");
        let paddings = self.paddings.iter().enumerate().filter(|(_, (x, _))| !is_known(x));
        found.extend(paddings.map(|(k, (x, _))| format!("paddings[{k}] ({x:?})")));
        let excluded = self.exclude.iter().map(Excluded::names).enumerate();
        let excluded = excluded.filter(|(_, (x, y))| !(is_known(x) && is_known(y)));
        found.extend(excluded.map(|(k, (x, y))| format!("exclude[{k}] ({x:?}, {y:?})")));
        found.extend(pairs(&self.allowed_depth, "allowed_depth"));
        found.extend(pairs(&self.allowed_volume, "allowed_volume"));
        found
    }
}

/// Returns an error if a number is negative or not finite.
pub(crate) fn check_length(what: &str, value: f64) -> Result<(), ClashError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    let what = what.into();
    Err(ClashError::Length { what, value })
}

/// Returns the larger of two numbers.
pub(crate) fn larger(x: f64, y: f64) -> f64 {
    if y > x { y } else { x }
}

/// Returns the value of the last row that matches a pair, and the name of the rule.
fn allowed(rows: &[(String, String, f64)], key: &str, a: &str, b: &str) -> Option<(f64, String)> {
    let mut rows = rows.iter().enumerate().rev();
    let (k, (_, _, most)) = rows.find(|(_, (x, y, _))| match_pair((x, y), (a, b)))?;
    Some((*most, format!("{key}[{k}]")))
}

/// Returns whether two patterns match two names, in either order.
fn match_pair((x, y): (&str, &str), (a, b): (&str, &str)) -> bool {
    matches(x, a) && matches(y, b) || matches(x, b) && matches(y, a)
}

/// Returns whether a pattern, in which `*` stands for any letters, matches a name.
fn matches(pattern: &str, name: &str) -> bool {
    let mut pieces = pattern.split('*');
    let first = pieces.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else {
        return false;
    };
    let Some(last) = pieces.next_back() else {
        return rest.is_empty();
    };
    for piece in pieces {
        match rest.find(piece) {
            Some(at) => rest = &rest[at + piece.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn stars_stand_for_any_letters() {
        for (pattern, name, expected) in [
            ("bolt", "bolt", true),
            ("bolt", "bolt#2", false),
            ("bolt*", "bolt#2", true),
            ("*", "", true),
            ("frame/*/rib*", "frame/left/rib7", true),
            ("frame/*/rib", "frame/left/rib7", false),
            ("*a*a", "a", false),
            ("*a*a", "aa", true),
            ("a*a", "a", false),
            ("**", "x", true),
            ("", "", true),
            ("", "x", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern:?} {name:?}");
        }
    }
}
