//! SRDF files: link pairs that are not checked, groups of joints and their states.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::Path;

use lin_canny_plan::{Cell, CellPair, PlanError, nearest_name as nearest};
use lin_canny_record::escaped;

use crate::error::{FileError, FileErrorKind, Skipped};
use crate::groups::{self, GroupState, JointGroup, VirtualJoint};
use crate::robot::Robot;
use crate::xml::{Xml, attribute};
use crate::xml_text::XmlText;

/// Two links that are excluded: not checked against each other, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExcludedPair {
    /// Names of both links.
    pub links: [String; 2],
    /// The reason as in the file, such as `Adjacent`, `Never` or `User`.
    pub reason: String,
}

/// Elements of an SRDF that are not read.
const PASSED: [&str; 9] = [
    "contact",
    "end_effector",
    "gripper",
    "handle",
    "joint_property",
    "link_sphere_approximation",
    "passive_joint",
    "rotor_params",
    "specificities",
];

/// The link pairs of an SRDF that are not checked, its groups of joints and their states.
///
/// * `disable_collisions` excludes a pair.
/// * `disable_default_collisions` excludes all pairs of a link with other links of the robot, but
///   not those of `enable_collisions`. Pairs with obstacles are still checked.
/// * `group`, `group_state` and `virtual_joint` change no pair: see [`JointGroup`], [`GroupState`]
///   and [`VirtualJoint`].
/// * End effectors and passive joints are passed over. Any other element is an error.
///
/// One SRDF may serve several robots of a family, so an element that names a link, joint or group
/// which does not exist is skipped. Then no pair is excluded that would be checked otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Srdf {
    /// The pairs, in the order of the file.
    pub excluded: Vec<ExcludedPair>,
    /// The pairs of `enable_collisions`, which are checked even if the links are adjacent.
    pub included: Vec<[String; 2]>,
    /// The groups, in the order of the file.
    pub groups: Vec<JointGroup>,
    /// The states of groups, in the order of the file.
    pub states: Vec<GroupState>,
    /// The virtual joints, in the order of the file.
    pub virtual_joints: Vec<VirtualJoint>,
    /// The elements that name a link, joint or group which does not exist, pairs of a link with itself,
    /// and chains whose base is not an ancestor of their tip.
    pub skipped: Vec<Skipped>,
}

impl Srdf {
    /// Returns the content of an SRDF file of a robot.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or an element is invalid. The error names the
    /// line.
    pub fn load(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, robot)
    }

    /// Returns the content of an SRDF text. Errors name the file `path`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: impl AsRef<Path>, robot: &Robot) -> Result<Self, FileError> {
        let text = XmlText::new(text);
        let xml = Xml::parse(path.as_ref(), &text)?;
        if xml.root().tag_name().name() != "robot" {
            return Err(xml.unknown_root("robot"));
        }
        let mut srdf = Self::default();
        let mut alone = Vec::new();
        let read = &[
            "disable_collisions",
            "enable_collisions",
            "disable_default_collisions",
            "group",
            "group_state",
            "virtual_joint",
        ];
        let elements = xml.below(xml.root(), read, &PASSED)?;
        for &node in &elements {
            let kind = node.tag_name().name();
            let fields: &'static [&'static str] = match kind {
                "disable_default_collisions" => &["link"],
                "disable_collisions" | "enable_collisions" => &["link1", "link2"],
                _ => continue,
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
                (_, Ok([a, b])) if a == b => {
                    let reason =
                        FileErrorKind::Malformed(format!("link {a:?} has no pair with itself (expected two links)"));
                    srdf.skipped.push(xml.error(&node, reason).into());
                }
                ("disable_collisions", Ok(links)) => srdf.excluded.push(ExcludedPair { links, reason }),
                ("enable_collisions", Ok(links)) => srdf.included.push(links),
                ("disable_default_collisions", Err(links)) => alone.extend(links),
                _ => {}
            }
        }
        let found = groups::read(&xml, robot, &elements)?;
        (srdf.groups, srdf.states) = (found.groups, found.states);
        srdf.virtual_joints = found.virtual_joints;
        srdf.skipped.extend(found.skipped);
        srdf.skipped.extend(xml.skipped());
        srdf.skipped.sort_by_key(|skipped| skipped.line);
        // A pair that is both disabled and enabled is disabled, as in MoveIt.
        let disabled: HashSet<[String; 2]> = srdf.excluded.iter().map(|pair| sorted(&pair.links)).collect();
        srdf.included.retain(|pair| !disabled.contains(&sorted(pair)));
        let enabled: HashSet<[String; 2]> = srdf.included.iter().map(sorted).collect();
        let mut found = disabled;
        for a in alone {
            for b in robot.links().iter().filter(|link| link.name != a) {
                let links = [a.clone(), b.name.clone()];
                if !enabled.contains(&sorted(&links)) && found.insert(sorted(&links)) {
                    let reason = "Default".into();
                    srdf.excluded.push(ExcludedPair { links, reason });
                }
            }
        }
        Ok(srdf)
    }

    /// Returns a state by its name: `group/name`, or `name` if only one group has such a state.
    ///
    /// # Errors
    /// Returns an error if there is no such state, or several groups have one.
    pub fn state(&self, name: &str) -> Result<&GroupState, FileErrorKind> {
        let full = |state: &GroupState| format!("{}/{}", state.group, state.name);
        if let Some(state) = self.states.iter().find(|state| full(state) == name) {
            return Ok(state);
        }
        let named: Vec<&GroupState> = self.states.iter().filter(|state| state.name == name).collect();
        match named[..] {
            [state] => Ok(state),
            [] => {
                let full: Vec<String> = self.states.iter().map(full).collect();
                let short = self.states.iter().map(|state| state.name.as_str());
                Err(FileErrorKind::Unknown {
                    kind: "state",
                    name: name.into(),
                    near: nearest(name, short.chain(full.iter().map(String::as_str))),
                })
            }
            [one, ..] => {
                let reason = format!("ambiguous state: {name:?} (expected a group, such as {:?})", full(one));
                Err(FileErrorKind::Malformed(reason))
            }
        }
    }

    /// Excludes the pairs of this SRDF in a cell, for the robot with this prefix.
    ///
    /// Pairs that the SRDF enables are not excluded any more, unless the file of the robot excludes
    /// them: call [`Cell::exclude_adjacent`] before. A link without bodies has no pairs. Groups, states
    /// and virtual joints change nothing.
    ///
    /// # Errors
    /// Returns an error if the cell has no link of one of the names.
    pub fn exclude_in(&self, cell: &mut Cell, prefix: &str) -> Result<(), PlanError> {
        let with_prefix = |links: &[String; 2]| links.each_ref().map(|name| format!("{prefix}{name}"));
        let may_lack_bodies = |found| match found {
            Err(PlanError::WithoutBodies(_)) => Ok(Vec::new()),
            found => found,
        };
        for [a, b] in self.included.iter().map(with_prefix) {
            let [first, second] = [may_lack_bodies(cell.select(&a))?, may_lack_bodies(cell.select(&b))?];
            let pairs = first
                .iter()
                .flat_map(|a| second.iter().map(move |b| CellPair::new(*a, *b)));
            // What a file excludes has no reason.
            let is_given = |pair: &CellPair| cell.exclusion(*pair).is_some_and(|reason| !reason.is_empty());
            let pairs: Vec<CellPair> = pairs.flatten().filter(is_given).collect();
            for pair in pairs {
                cell.include(pair.a, pair.b)?;
            }
        }
        for pair in &self.excluded {
            let [a, b] = with_prefix(&pair.links);
            match cell.exclude_because(&a, &b, &pair.reason) {
                Ok(_) | Err(PlanError::WithoutBodies(_)) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Returns what was skipped among the pairs, without groups and virtual joints.
    pub fn skipped_pairs(&self) -> impl Iterator<Item = &Skipped> {
        let is_of_others = |skipped: &Skipped| {
            let mut kinds = ["group", "virtual_joint"].iter();
            kinds.any(|kind| skipped.element.starts_with(kind))
        };
        self.skipped.iter().filter(move |skipped| !is_of_others(skipped))
    }

    /// Returns the SRDF of the links of a robot, with this prefix in the cell, all of whose pairs are
    /// excluded, each with its reason. The pairs of links and obstacles are left out.
    #[must_use]
    pub fn from_cell(cell: &Cell, prefix: &str, robot: &Robot) -> Self {
        let excluded = cell.excluded_names().into_iter().filter_map(|(pair, reason)| {
            let links = own_links(pair, prefix, robot)?;
            let reason = reason.to_owned();
            Some(ExcludedPair { links, reason })
        });
        Self {
            excluded: excluded.collect(),
            ..Self::default()
        }
    }

    /// Returns the text of an SRDF with these pairs, without groups, states and virtual joints.
    #[must_use]
    pub fn text(&self, robot: &str) -> String {
        let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escaped(robot));
        for pair in &self.excluded {
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

/// Returns the names of two different links of a robot without the prefix, if both are.
fn own_links(pair: [&str; 2], prefix: &str, robot: &Robot) -> Option<[String; 2]> {
    let own = |name: &str| {
        let name = name.strip_prefix(prefix)?;
        robot.link(name).map(|_| name.to_owned())
    };
    let [a, b] = pair.map(own);
    (a != b).then_some([a?, b?])
}

fn sorted([a, b]: &[String; 2]) -> [String; 2] {
    let mut pair = [a.clone(), b.clone()];
    pair.sort();
    pair
}
