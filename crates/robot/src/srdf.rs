//! SRDF files: link pairs that are not checked.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::Path;

use crate::error::{FileError, Skipped};
use crate::robot::Robot;
use crate::xml::{Xml, attribute};

/// Two links that are not checked against each other, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredPair {
    /// Names of both links.
    pub links: [String; 2],
    /// The reason as in the file, such as `Adjacent`, `Never` or `User`.
    pub reason: String,
}

/// Elements of an SRDF that say nothing about which pairs are checked.
const PASSED: [&str; 12] = [
    "contact",
    "end_effector",
    "gripper",
    "group",
    "group_state",
    "handle",
    "joint_property",
    "link_sphere_approximation",
    "passive_joint",
    "rotor_params",
    "specificities",
    "virtual_joint",
];

/// The link pairs of an SRDF that are not checked.
///
/// * `disable_collisions` ignores a pair.
/// * `disable_default_collisions` ignores all pairs of a link with other links of the robot, but
///   not those of `enable_collisions`. Pairs with obstacles are still checked.
/// * Groups, states, virtual joints and end effectors are passed over. Any other element is an
///   error.
///
/// One SRDF may serve several robots of a family, so an element that names a link which the robot
/// does not have is skipped. Then no pair is ignored that would be checked otherwise.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Srdf {
    /// The pairs, in the order of the file.
    pub ignored: Vec<IgnoredPair>,
    /// The pairs of `enable_collisions`, which are checked even if the links are adjacent.
    pub enabled: Vec<[String; 2]>,
    /// The elements that name a link which the robot does not have.
    pub skipped: Vec<Skipped>,
}

impl Srdf {
    /// Returns the pairs of an SRDF file of a robot.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or an element is invalid. The error names the
    /// line.
    pub fn load(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, robot)
    }

    /// Returns the pairs of an SRDF text. Errors name the file `path`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let xml = Xml::parse(path.as_ref(), text)?;
        if xml.root().tag_name().name() != "robot" {
            return Err(xml.unknown_root("robot"));
        }
        let mut srdf = Self::default();
        let mut alone = Vec::new();
        let read = &["disable_collisions", "enable_collisions", "disable_default_collisions"];
        for node in xml.below(xml.root(), read, &PASSED)? {
            let kind = node.tag_name().name();
            let fields: &'static [&'static str] = match kind {
                "disable_default_collisions" => &["link"],
                _ => &["link1", "link2"],
            };
            // The reason, and attributes of other tools, may be missing or given.
            xml.check_leaf(node, fields, true)?;
            let mut links = Vec::new();
            for field in fields {
                let name = xml.needed(&node, field)?;
                let known = [name, name.trim()].into_iter().find(|name| robot.link(name).is_some());
                match known {
                    Some(name) => links.push(name.to_owned()),
                    None => srdf.skipped.push(xml.error(&node, robot.unknown_link(name)).into()),
                }
            }
            let reason = attribute(&node, "reason").unwrap_or_default().to_owned();
            match (kind, <[String; 2]>::try_from(links)) {
                ("disable_collisions", Ok(links)) => srdf.ignored.push(IgnoredPair { links, reason }),
                ("enable_collisions", Ok(links)) => srdf.enabled.push(links),
                ("disable_default_collisions", Err(links)) => alone.extend(links),
                _ => {}
            }
        }
        // A pair that is both disabled and enabled is disabled, as in MoveIt.
        let disabled: HashSet<[String; 2]> = srdf.ignored.iter().map(|pair| sorted(&pair.links)).collect();
        srdf.enabled.retain(|pair| !disabled.contains(&sorted(pair)));
        let enabled: HashSet<[String; 2]> = srdf.enabled.iter().map(sorted).collect();
        let mut found = disabled;
        for a in alone {
            for b in robot.links().iter().filter(|link| link.name != a) {
                let links = [a.clone(), b.name.clone()];
                if !enabled.contains(&sorted(&links)) && found.insert(sorted(&links)) {
                    let reason = "Default".into();
                    srdf.ignored.push(IgnoredPair { links, reason });
                }
            }
        }
        Ok(srdf)
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

fn sorted([a, b]: &[String; 2]) -> [String; 2] {
    let mut pair = [a.clone(), b.clone()];
    pair.sort();
    pair
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
