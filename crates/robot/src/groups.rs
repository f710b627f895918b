//! Groups, states and virtual joints of an SRDF.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use roxmltree::Node;

use crate::error::{FileError, FileErrorKind, Skipped};
use crate::robot::Robot;
use crate::turn::{from_xyzw, to_roll_pitch_yaw};
use crate::xml::{Xml, attribute};
use lin_canny_plan::MotionKind;
use lin_canny_plan::nearest_name as nearest;

/// A named set of links and joints of a robot.
///
/// As in MoveIt, a link brings the joint that moves it, a joint brings the link that it moves, and
/// a chain has all links from `base_link` to `tip_link` with the joints between them. The links and
/// joints of the groups inside a group are among its own.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct JointGroup {
    /// The name.
    pub name: String,
    /// Names of the links, in the order of [`Robot::links`].
    pub links: Vec<String>,
    /// Names of the joints, in the order of [`Robot::joints`]. Virtual joints are not among them.
    pub joints: Vec<String>,
}

/// Values of some joints, such as those of a robot at rest.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GroupState {
    /// The name, which is unique in its group.
    pub name: String,
    /// Name of the group; empty if the file names none.
    pub group: String,
    /// Names of coordinates, as in [`Robot::coordinates`], and their values: radians, or metres for
    /// a prismatic joint and for the positions of a planar or floating joint.
    ///
    /// The limits are not checked. A joint that is fixed or mimics another has no coordinate, so
    /// its value is not here.
    pub values: Vec<(String, f64)>,
}

/// A joint between a frame of the world and the robot, which is not in the robot's file.
///
/// A fixed virtual joint says that the robot does not move in the frame: its pose is an argument of
/// [`Cell::add_robot`](lin_canny_plan::Cell::add_robot). A planar or floating one has no effect here. To move the
/// robot by it, add its `parent_frame` as a link and the joint to the URDF, with the type `planar`
/// or `floating`, the `child_link` as its child, and the name of the virtual joint. Then the robot
/// has coordinates such as `name/x`, in metres and radians, and states may name the joint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct VirtualJoint {
    /// The name.
    pub name: String,
    /// The kind of motion: fixed, planar or floating.
    pub kind: MotionKind,
    /// Name of the frame in which the robot moves.
    pub parent_frame: String,
    /// Name of the link that is joined to the frame, usually the root link.
    pub child_link: String,
}

/// Links and joints of a group, by their indices.
#[derive(Default)]
struct Members {
    links: BTreeSet<usize>,
    joints: BTreeSet<usize>,
}

/// State of the reader.
struct Reader<'a> {
    xml: &'a Xml<'a>,
    robot: &'a Robot,
    links: BTreeMap<&'a str, usize>,
    joints: BTreeMap<&'a str, usize>,
    groups: BTreeMap<&'a str, usize>,
    virtual_joints: HashSet<&'a str>,
    skipped: Vec<Skipped>,
}

/// What the elements of groups, states and virtual joints hold.
pub(crate) struct Groups {
    pub(crate) groups: Vec<JointGroup>,
    pub(crate) states: Vec<GroupState>,
    pub(crate) virtual_joints: Vec<VirtualJoint>,
    pub(crate) skipped: Vec<Skipped>,
}

/// Reads the groups, states and virtual joints among the elements of an SRDF.
pub(crate) fn read<'a>(xml: &'a Xml<'a>, robot: &'a Robot, elements: &[Node<'a, 'a>]) -> Result<Groups, FileError> {
    let of = |kind: &'static str| elements.iter().copied().filter(move |n| n.tag_name().name() == kind);
    let links = robot.links().iter().enumerate();
    let joints = robot.joints().iter().enumerate();
    let mut reader = Reader {
        xml,
        robot,
        links: links.map(|(k, link)| (link.name.as_str(), k)).collect(),
        joints: joints.map(|(k, joint)| (joint.name.as_str(), k)).collect(),
        groups: BTreeMap::new(),
        virtual_joints: HashSet::new(),
        skipped: Vec::new(),
    };
    let mut virtual_joints = Vec::new();
    for node in of("virtual_joint") {
        virtual_joints.extend(reader.virtual_joint(node)?);
    }
    for (k, node) in of("group").enumerate() {
        if reader.groups.insert(xml.needed(&node, "name")?, k).is_some() {
            return Err(xml.error(&node, FileErrorKind::Repeated));
        }
    }
    let groups = reader.groups(&of("group").collect::<Vec<_>>())?;
    let (mut states, mut names) = (Vec::new(), HashSet::new());
    for node in of("group_state") {
        let state = reader.state(node)?;
        if !names.insert([state.group.clone(), state.name.clone()]) {
            return Err(xml.error(&node, FileErrorKind::Repeated));
        }
        states.push(state);
    }
    Ok(Groups {
        groups,
        states,
        virtual_joints,
        skipped: reader.skipped,
    })
}

impl<'a> Reader<'a> {
    fn virtual_joint(&mut self, node: Node<'a, 'a>) -> Result<Option<VirtualJoint>, FileError> {
        let xml = self.xml;
        let fields = &["name", "type", "parent_frame", "child_link"];
        xml.check_leaf(node, fields, true)?;
        let [name, kind, parent, child] = fields.map(|field| xml.needed(&node, field));
        let (name, kind, parent, child) = (name?, kind?, parent?, child?);
        if !self.virtual_joints.insert(name) {
            return Err(xml.error(&node, FileErrorKind::Repeated));
        }
        let kind = match kind.trim() {
            "fixed" => MotionKind::Fixed,
            "planar" => MotionKind::Planar,
            "floating" => MotionKind::Floating,
            _ => {
                let reason = format!("invalid type: {kind:?} (expected fixed, planar or floating)");
                return Err(xml.error(&node, FileErrorKind::Malformed(reason)));
            }
        };
        let Some(link) = known(&mut self.skipped, xml, &node, "link", child, &self.links) else {
            return Ok(None);
        };
        Ok(Some(VirtualJoint {
            name: name.into(),
            kind,
            parent_frame: parent.into(),
            child_link: self.robot.links()[link].name.clone(),
        }))
    }

    /// Returns the groups, each with the members of the groups inside it.
    fn groups(&mut self, nodes: &[Node<'a, 'a>]) -> Result<Vec<JointGroup>, FileError> {
        let (mut members, mut inner) = (Vec::new(), Vec::new());
        for node in nodes {
            let (own, groups) = self.group(*node)?;
            members.push(own);
            inner.push(groups);
        }
        let mut groups = Vec::new();
        for (k, node) in nodes.iter().enumerate() {
            let name = |node: &Node<'a, 'a>| self.xml.needed(node, "name").map(str::to_owned);
            let found = nested(k, &inner);
            if let Some(&last) = found.get(&k) {
                let outer = std::iter::successors(Some(last), |at| found.get(at).copied());
                let mut names = vec![name(node)?];
                for at in outer.take_while(|at| *at != k) {
                    names.insert(1, name(&nodes[at])?);
                }
                return Err(self.xml.error(node, FileErrorKind::GroupLoop(names)));
            }
            let all = || found.keys().chain([&k]).map(|k| &members[*k]);
            let links: BTreeSet<usize> = all().flat_map(|m: &Members| &m.links).copied().collect();
            let joints: BTreeSet<usize> = all().flat_map(|m: &Members| &m.joints).copied().collect();
            groups.push(JointGroup {
                name: name(node)?,
                links: links.iter().map(|k| self.robot.links()[*k].name.clone()).collect(),
                joints: joints.iter().map(|k| self.robot.joints()[*k].name.clone()).collect(),
            });
        }
        Ok(groups)
    }

    /// Returns the members of a group, and the numbers of the groups inside it.
    fn group(&mut self, group: Node<'a, 'a>) -> Result<(Members, Vec<usize>), FileError> {
        let xml = self.xml;
        let (mut members, mut groups) = (Members::default(), Vec::new());
        for node in xml.below(group, &["link", "joint", "chain", "group"], &["passive_joint"])? {
            let kind = node.tag_name().name();
            if kind == "chain" {
                self.chain(node, &mut members)?;
                continue;
            }
            xml.check_leaf(node, &["name"], true)?;
            let name = xml.needed(&node, "name")?;
            let skipped = &mut self.skipped;
            match kind {
                // Joint k moves link k + 1.
                "link" => {
                    let link = known(skipped, xml, &node, "link", name, &self.links);
                    members.links.extend(link);
                    members.joints.extend(link.and_then(|link| link.checked_sub(1)));
                }
                "joint" if self.virtual_joints.contains(name) && !self.joints.contains_key(name) => {}
                "joint" => {
                    let joint = known(skipped, xml, &node, "joint", name, &self.joints);
                    members.joints.extend(joint);
                    members.links.extend(joint.map(|joint| joint + 1));
                }
                _ => groups.extend(known(skipped, xml, &node, "group", name, &self.groups)),
            }
        }
        Ok((members, groups))
    }

    fn chain(&mut self, node: Node<'a, 'a>, members: &mut Members) -> Result<(), FileError> {
        let xml = self.xml;
        xml.check_leaf(node, &["base_link", "tip_link"], true)?;
        let [base, tip] = [xml.needed(&node, "base_link")?, xml.needed(&node, "tip_link")?];
        let ends = [base, tip].map(|name| known(&mut self.skipped, xml, &node, "link", name, &self.links));
        let [Some(first), Some(last)] = ends else {
            return Ok(());
        };
        let before = |link: &usize| link.checked_sub(1).map(|joint| self.robot.joints()[joint].parent);
        let links = std::iter::successors(Some(last), before).take_while(|link| *link != first);
        let links: Vec<usize> = links.collect();
        // Without the first link, the list ends at the root.
        if links.contains(&0) {
            let reason = format!("base_link {base:?} is not an ancestor of tip_link: {tip:?}");
            self.skipped
                .push(xml.error(&node, FileErrorKind::Malformed(reason)).into());
            return Ok(());
        }
        members.joints.extend(links.iter().map(|link| link - 1));
        members.links.extend(links);
        members.links.insert(first);
        Ok(())
    }

    fn state(&mut self, node: Node<'a, 'a>) -> Result<GroupState, FileError> {
        let xml = self.xml;
        let name = xml.needed(&node, "name")?.to_owned();
        // Some files have states of no group.
        let group = attribute(&node, "group").unwrap_or_default();
        if !group.is_empty() {
            known(&mut self.skipped, xml, &node, "group", group, &self.groups);
        }
        let (mut values, mut names) = (Vec::new(), HashSet::new());
        for node in xml.below(node, &["joint"], &[])? {
            xml.check_leaf(node, &["name", "value"], true)?;
            let name = xml.needed(&node, "name")?;
            xml.needed(&node, "value")?;
            let Some(joint) = known(&mut self.skipped, xml, &node, "joint", name, &self.joints) else {
                continue;
            };
            if !names.insert(joint) {
                return Err(xml.error(&node, FileErrorKind::Repeated));
            }
            values.extend(self.values(&node, joint)?);
        }
        let group = group.into();
        Ok(GroupState { name, group, values })
    }

    /// Returns the coordinates of a joint in a state, and their values.
    fn values(&self, node: &Node<'a, 'a>, joint: usize) -> Result<Vec<(String, f64)>, FileError> {
        let xml = self.xml;
        let joint = &self.robot.joints()[joint];
        let angles = |xyzw: [f64; 4]| {
            let turn = from_xyzw(xyzw).ok_or_else(|| {
                let field = "length of the quaternion".into();
                xml.error(node, FileErrorKind::Range { field, value: 0.0 })
            })?;
            Ok::<_, FileError>(to_roll_pitch_yaw(&turn))
        };
        let numbers = match joint.kind {
            // Some files give a fixed joint the seven numbers of its pose.
            MotionKind::Fixed => Vec::new(),
            MotionKind::Planar => xml.needed_numbers::<3>(node, "value")?.to_vec(),
            MotionKind::Floating => {
                let [x, y, z, turn @ ..] = xml.needed_numbers::<7>(node, "value")?;
                [[x, y, z], angles(turn)?].concat()
            }
            MotionKind::Ball => angles(xml.needed_numbers(node, "value")?)?.to_vec(),
            _ => xml.needed_numbers::<1>(node, "value")?.to_vec(),
        };
        let names = match joint.kind.coordinate_names() {
            [] if joint.mimics.is_some() => Vec::new(),
            [] => vec![joint.name.clone()],
            parts => parts.iter().map(|part| format!("{}/{part}", joint.name)).collect(),
        };
        Ok(names.into_iter().zip(numbers).collect())
    }
}

/// Returns the number of a name. If the name does not exist, the element is listed as skipped.
fn known(
    skipped: &mut Vec<Skipped>,
    xml: &Xml,
    node: &Node,
    kind: &'static str,
    name: &str,
    numbers: &BTreeMap<&str, usize>,
) -> Option<usize> {
    let number = [name, name.trim()].iter().find_map(|name| numbers.get(name).copied());
    if number.is_none() {
        let reason = FileErrorKind::Unknown {
            kind,
            name: name.into(),
            near: nearest(name, numbers.keys().copied()),
        };
        skipped.push(xml.error(node, reason).into());
    }
    number
}

/// Returns the groups inside a group, directly or through others, each with the group that names
/// it.
///
/// The group itself is among them if it is in a cycle.
pub(crate) fn nested(group: usize, inner: &[Vec<usize>]) -> HashMap<usize, usize> {
    let mut found = HashMap::new();
    let mut open = vec![group];
    while let Some(outer) = open.pop() {
        for &next in &inner[outer] {
            if let Entry::Vacant(entry) = found.entry(next) {
                entry.insert(outer);
                open.push(next);
            }
        }
    }
    found
}
