//! Converts an MJCF file, MuJoCo's XML, to a robot.
//!
//! The root link is the world, and every body is a link. The rules are those of MuJoCo's chapter
//! "XML reference" (mujoco.readthedocs.io).

mod bodies;
mod element;
mod geom;
mod pairs;
mod settings;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use bodies::Model;
use element::Element;
use geom::{Assets, Source};
use pairs::Contacts;
use settings::{Classes, Compiler, Flags};

use crate::error::{FileError, FileErrorKind};
use crate::link_tree::LinkTree;
use crate::options::LoadOptions;
use crate::robot::Robot;
use crate::xml::Xml;

/// Sections that are read.
const READ: [&str; 8] = [
    "compiler",
    "option",
    "default",
    "asset",
    "worldbody",
    "contact",
    "equality",
    "deformable",
];

/// Sections that hold neither geometry for collisions nor kinematics.
const PASSED: [&str; 9] = [
    "size",
    "visual",
    "statistic",
    "custom",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
    "extension",
];

pub(crate) fn read(xml: &Xml, options: &LoadOptions) -> Result<Robot, FileError> {
    let (root, mut skipped) = Element::root(xml)?;
    let all: Vec<&Element> = root.below(&READ, &PASSED)?.collect();
    let sections = |name: &str| -> Vec<&Element> { all.iter().copied().filter(|s| s.name == name).collect() };
    let compiler = Compiler::new(&sections("compiler"))?;
    let flags = Flags::new(&sections("option"))?;
    skipped.extend(flags.without_contacts());
    let classes = Classes::new(&sections("default"))?;
    let assets = Assets::new(&sections("asset"), &classes)?;
    let contacts = Contacts::new(&sections("contact"))?;
    for section in sections("deformable") {
        if let Some(flex) = section.below(&["flex"], &["skin"])?.next() {
            return Err(flex.unsupported("a flexible body"));
        }
    }
    let source = Source {
        compiler: &compiler,
        flags: &flags,
        options,
        folder: xml.file.parent().unwrap_or(Path::new("")),
    };
    let mut model = Model::new(&classes, &source, assets, contacts.geoms()?);
    for section in sections("worldbody") {
        model.world(section)?;
    }
    model.rest();
    let names = model
        .joints
        .iter()
        .enumerate()
        .map(|(k, joint)| (joint.name.clone(), k));
    let numbers: HashMap<String, usize> = names.collect();
    let known = ["joint", "connect", "weld", "tendon", "flex", "flexvert", "flexstrain"];
    for section in sections("equality") {
        for element in section.below(&known, &[])? {
            model.equality(element, &numbers)?;
        }
    }
    let names: Vec<&str> = model.links.iter().map(|link| link.name.as_str()).collect();
    let mut different = HashSet::new();
    if let Some(name) = names.iter().find(|name| !different.insert(**name)) {
        let why = format!("two bodies or joints have the name {name:?} (expected different names)");
        return Err(root.error(FileErrorKind::Malformed(why)));
    }
    let tree = LinkTree::new(&names, &model.joints, options, &root.place)?;
    let (links, joints) = (model.links.clone(), std::mem::take(&mut model.joints));
    let mut robot = tree.robot(root.get("model").unwrap_or("MuJoCo Model"), links, joints);
    let drives: HashMap<String, _> = robot
        .model
        .joints
        .iter()
        .map(|joint| (joint.name.clone(), joint.drive))
        .collect();
    for (name, pose) in &model.free {
        if let Some(drive) = drives.get(name).copied().flatten() {
            robot.draw(drive.coordinate, pose);
        }
    }
    robot.skipped = skipped;
    robot.skipped.append(&mut model.skipped);
    let adjacent = flags.is_enabled("filterparent");
    pairs::set(&mut robot, &model, &contacts, adjacent, &root.place)?;
    Ok(robot)
}
