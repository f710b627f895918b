//! Names and ids of bodies, and the name that was meant by a misspelt one.

use core::fmt;

/// A robot body, an attached object or an obstacle, by its index in the order of insertion.
///
/// [`Cell::name`](crate::Cell::name) returns its name, and [`Cell::show`](crate::Cell::show) prints it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CellBody {
    /// A robot body; the first is 0.
    Robot(usize),
    /// An object that was attached to the robot; the first is 0. Never used again.
    Attached(usize),
    /// An obstacle; the first is 0. Never used again.
    Obstacle(usize),
}

impl fmt::Display for CellBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Robot(k) => write!(f, "robot body {k}"),
            Self::Attached(k) => write!(f, "attached object {k}"),
            Self::Obstacle(k) => write!(f, "obstacle {k}"),
        }
    }
}

/// A pair of bodies, at least one of which moves with the robot; the smaller id comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CellPair {
    /// A robot body or an attached object.
    pub a: CellBody,
    /// The obstacle, or a later body that moves with the robot.
    pub b: CellBody,
}

impl CellPair {
    /// Returns the pair of two bodies, in any order.
    ///
    /// Returns `None` if the bodies are the same or both are obstacles: there is no such pair.
    #[must_use]
    pub fn new(x: CellBody, y: CellBody) -> Option<Self> {
        let (a, b) = (x.min(y), x.max(y));
        (a != b && !matches!(a, CellBody::Obstacle(_))).then_some(Self { a, b })
    }
}

impl fmt::Display for CellPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} and {}", self.a, self.b)
    }
}

/// Names the bodies that a call acts on: one id, a name, or several names such as a group of links.
///
/// A name stands for all bodies that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Select<'a> {
    /// One body.
    Id(CellBody),
    /// All bodies with this name.
    Name(&'a str),
    /// All bodies with one of these names. Links without bodies are passed over.
    Names(&'a [String]),
}

impl From<CellBody> for Select<'_> {
    fn from(id: CellBody) -> Self {
        Self::Id(id)
    }
}

impl<'a> From<&'a str> for Select<'a> {
    fn from(name: &'a str) -> Self {
        Self::Name(name)
    }
}

impl<'a> From<&&'a str> for Select<'a> {
    fn from(name: &&'a str) -> Self {
        Self::Name(name)
    }
}

impl<'a> From<&'a String> for Select<'a> {
    fn from(name: &'a String) -> Self {
        Self::Name(name)
    }
}

impl<'a> From<&'a [String]> for Select<'a> {
    fn from(names: &'a [String]) -> Self {
        Self::Names(names)
    }
}

impl<'a> From<&'a Vec<String>> for Select<'a> {
    fn from(names: &'a Vec<String>) -> Self {
        Self::Names(names)
    }
}

/// The longest name, in letters, that gets a suggestion.
const LONGEST: usize = 100;

/// Returns the name that is closest to a wrong one, if one is close.
///
/// Blanks at the ends and the case of letters do not count.
#[must_use]
pub fn nearest_name<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<Box<str>> {
    let letters = |name: &str| -> Vec<char> { name.trim().to_lowercase().chars().take(LONGEST + 1).collect() };
    let wrong = letters(wrong);
    let most = (wrong.len() + 1) / 3;
    let near = |name: &'a str| {
        let name_letters = letters(name);
        let is_long = wrong.len().max(name_letters.len()) > LONGEST;
        let is_close = wrong.len().abs_diff(name_letters.len()) <= most;
        let edits = (is_close && !is_long).then(|| strsim::generic_damerau_levenshtein(&wrong, &name_letters))?;
        (edits <= most).then_some((edits, name))
    };
    let found = names.into_iter().filter_map(near).min_by_key(|(edits, _)| *edits);
    found.map(|(_, name)| name.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested_if_it_is_close() {
        let names = ["base_link", "tool", "forearm", "upper_arm"];
        let near = |wrong: &str| nearest_name(wrong, names);
        assert_eq!(near("base_lnik").as_deref(), Some("base_link"));
        assert_eq!(near(" Base_Link ").as_deref(), Some("base_link"));
        assert_eq!(near("foream").as_deref(), Some("forearm"));
        assert_eq!(near("tools").as_deref(), Some("tool"));
        // Two letters that changed places are one edit.
        assert_eq!(near("tolo").as_deref(), Some("tool"));
        assert_eq!(near("gripper"), None);
        assert_eq!(near(""), None);
        assert_eq!(nearest_name("x", ["a", "b"]), None);
        assert_eq!(nearest_name(&"x".repeat(1_000_000), [&*"x".repeat(1_000_000)]), None);
    }
}
