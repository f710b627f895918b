//! SRDF files: link pairs that are not checked.

use std::fmt::Write as _;
use std::path::Path;

use crate::error::FileError;
use crate::robot::Robot;
use crate::xml::Xml;

/// Two links that are not checked against each other, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredPair {
    /// Names of both links.
    pub links: [String; 2],
    /// The reason as in the file, such as `Adjacent`, `Never` or `User`.
    pub reason: String,
}

/// The link pairs of an SRDF that are not checked, one per `disable_collisions`.
///
/// Groups, poses and end effectors are ignored. `disable_default_collisions` is ignored as well, so
/// its pairs are checked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Srdf {
    /// The pairs, in the order of the file.
    pub ignored: Vec<IgnoredPair>,
}

impl Srdf {
    /// Returns the pairs of an SRDF file of a robot.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or the robot does not have a link. The error
    /// names the line and the link.
    pub fn load(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, robot)
    }

    /// Returns the pairs of an SRDF text. Errors name the file `path`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let xml = Xml::parse(path.as_ref(), text, "robot")?;
        let mut ignored = Vec::new();
        let named = |n: &roxmltree::Node| n.has_tag_name("disable_collisions");
        for node in xml.root().children().filter(named) {
            let name = |field: &str| {
                let name = xml.needed(&node, field)?.to_owned();
                if robot.link(&name).is_some() {
                    return Ok(name);
                }
                Err(xml.error(&node, robot.unknown_link(&name)))
            };
            ignored.push(IgnoredPair {
                links: [name("link1")?, name("link2")?],
                reason: node.attribute("reason").unwrap_or("").to_owned(),
            });
        }
        Ok(Self { ignored })
    }

    /// Returns the text of an SRDF with these pairs.
    #[must_use]
    pub fn text(&self, robot: &str) -> String {
        let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escaped(robot));
        for pair in &self.ignored {
            let [a, b] = pair.links.each_ref().map(|name| escaped(name));
            let reason = escaped(&pair.reason);
            let _ = writeln!(
                text,
                "  <disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"{reason}\"/>"
            );
        }
        text.push_str("</robot>\n");
        text
    }
}

fn escaped(text: &str) -> String {
    let mut all = String::new();
    for c in text.chars() {
        match c {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '"' => all.push_str("&quot;"),
            '\n' | '\r' | '\t' => {
                let _ = write!(all, "&#{};", u32::from(c));
            }
            _ => all.push(c),
        }
    }
    all
}
