//! Converts an MJCF file, MuJoCo's XML, to a robot.
//!
//! The root link is the world, and every body is a link. The rules are those of MuJoCo's chapter
//! "XML reference" (mujoco.readthedocs.io).

mod bodies;
mod element;
mod geom;
mod pairs;
mod settings;
mod spec;

use std::collections::{HashMap, HashSet};

use bodies::Model;
use settings::Flags;
use spec::{ModelFile, Spec};

use crate::error::{FileError, FileErrorKind};
use crate::link_tree::LinkTree;
use crate::options::LoadOptions;
use crate::robot::Robot;
use crate::xml::Xml;

pub(crate) fn read(xml: &Xml, options: &LoadOptions) -> Result<Robot, FileError> {
    let (files, mut skipped) = ModelFile::all(xml)?;
    let root = &files[0].root;
    let flags = Flags::new(root)?;
    skipped.extend(flags.without_contacts());
    let specs = files.iter().map(|file| Spec::new(file, &flags, options));
    let specs: Vec<Spec> = specs.collect::<Result<_, _>>()?;
    let mut model = Model::new(&specs)?;
    model.read()?;
    let names: Vec<&str> = model.links.iter().map(|link| link.name.as_str()).collect();
    let mut different = HashSet::new();
    if let Some(name) = names.iter().find(|name| !different.insert(**name)) {
        let why = format!("two bodies or joints have the name {name:?} (expected different names)");
        return Err(root.error(FileErrorKind::Malformed(why)));
    }
    let tree = LinkTree::new(&names, &model.joints, options, &root.place)?;
    let (links, joints) = (model.links.clone(), std::mem::take(&mut model.joints));
    let mut robot = tree.robot(files[0].name(), links, joints);
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
    robot.qpos = std::mem::take(&mut model.qpos);
    robot.skipped = skipped;
    robot.skipped.append(&mut model.skipped);
    let adjacent = flags.is_enabled("filterparent");
    pairs::set(&mut robot, &model, adjacent, &root.place)?;
    Ok(robot)
}
