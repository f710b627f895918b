//! Converts the SDFormat of a robot or world to a robot, or to the obstacles of a cell.
//!
//! The rules are those of the specification at sdformat.org, versions 1.3 to 1.12. A file is read
//! in three steps:
//!
//! 1. The elements of the file, and of the files that it includes, become frames, links and joints,
//!    which name each other.
//! 2. The names are resolved. Each frame gets a pose and the link that carries it.
//! 3. Joints and links become a tree below the link `world`.

mod frames;
mod include;
mod model;
mod shape;
mod values;

use std::collections::HashMap;
use std::f64::consts::TAU;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::normalize_rotation;
use roxmltree::Node;

use frames::{Carrier, Poses, Target, WORLD};
use model::{ALL_BITS, Description, Joint, Link, Override, Owner};
use values::SdfFile;

use crate::cell::Obstacle;
use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::link_tree::{FileJoint, Follows, LinkTree};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::{Robot, adjacent_by_joints};
use crate::xml::{EXTENT_MAX, Xml, attribute, check_excluded};
use lin_canny_plan::{LinkBody, MotionKind, RobotLink};

/// The one world or model of a file.
struct Top<'n, 'a> {
    node: Node<'n, 'a>,
    /// The frame of the model; `None` for a world.
    model: Option<usize>,
}

pub(crate) fn read(xml: &Xml, packages: &Packages, options: &LoadOptions) -> Result<Robot, FileError> {
    let mut description = Description::new(xml.place(&xml.root()), packages, options);
    let top = describe(xml, &mut description, true)?;
    let poses = description.frames.resolve()?;
    let base = top.model.map(|frame| (frame, xml.place(&top.node)));
    let builder = Builder::new(description, poses, base, options)?;
    builder.robot(attribute(&top.node, "name").unwrap_or_default())
}

/// Returns the bodies of all links where the file draws them, and what was skipped.
pub(crate) fn obstacles(
    xml: &Xml,
    packages: &Packages,
    options: &LoadOptions,
) -> Result<(Vec<Obstacle>, Vec<Skipped>), FileError> {
    // A cell has no links, and all of its meshes must exist. Obstacles may be infinite.
    let options = options
        .clone()
        .link_meshes([])
        .skip_missing_meshes(false)
        .plane_extent(f64::INFINITY);
    let mut description = Description::new(xml.place(&xml.root()), packages, &options);
    describe(xml, &mut description, false)?;
    let poses = description.frames.resolve()?;
    let mut obstacles = Vec::new();
    for link in &description.links {
        for body in &link.bodies {
            let frame = description.frames.number(&body.relative_to)?;
            obstacles.push(Obstacle {
                name: link.name.clone(),
                geometry: body.body.geometry.clone(),
                pose: checked(&(poses.global[frame] * body.body.origin), &link.place)?,
                poses: None,
            });
        }
    }
    Ok((obstacles, description.skipped))
}

/// Reads the one world or model of a file.
fn describe<'n, 'a>(
    xml: &'n Xml<'a>,
    description: &mut Description,
    hides_name: bool,
) -> Result<Top<'n, 'a>, FileError> {
    let file = SdfFile::new(xml)?;
    let root = xml.root();
    let (actors, tops): (Vec<Node>, Vec<Node>) = xml
        .below(root, &["world", "model", "actor"], &["light"])?
        .into_iter()
        .partition(|node| node.tag_name().name() == "actor");
    actors.iter().for_each(|node| description.skip(&file, node));
    let node = match tops[..] {
        [] => return Err(xml.error(&root, FileErrorKind::Missing("element world or model".into()))),
        [node] => node,
        [_, second, ..] => {
            let names = tops.iter().map(|node| attribute(node, "name").unwrap_or_default());
            let names: Vec<&str> = names.take(10).collect();
            let what = format!("several worlds or models: {} (expected one)", names.join(", "));
            return Err(xml.error(&second, FileErrorKind::Malformed(what)));
        }
    };
    let mut model = None;
    if node.tag_name().name() == "world" {
        description.world(&file, node)?;
    } else {
        let instead = Override {
            hides_name,
            ..Override::default()
        };
        model = Some(description.model(&file, node, &Owner::world(), instead)?);
    }
    description.check_names()?;
    Ok(Top { node, model })
}

/// Returns a pose with a rotation of length one, or an error if it is too far away.
fn checked(pose: &Isometry3<f64>, place: &Place) -> Result<Isometry3<f64>, FileError> {
    let value = pose.translation.vector.amax();
    if value <= EXTENT_MAX {
        return Ok(normalize_rotation(pose));
    }
    let field = "position of a body".into();
    Err(place.error(FileErrorKind::Range { field, value }))
}

/// Makes a tree of the links and joints. Link 0 is the world, and link k + 1 the k-th of the file.
struct Builder<'a> {
    description: Description<'a>,
    poses: Poses,
    options: &'a LoadOptions,
    joints: Vec<FileJoint>,
    /// The frame of each link: that of the joint that rotates or slides it, or else its own.
    frames: Vec<usize>,
    /// For each link, the parent of the joint that moves it.
    parents: Vec<Option<usize>>,
    /// The names of further links, without bodies: between the parts of a joint.
    between: Vec<String>,
}

impl<'a> Builder<'a> {
    /// Returns the joints of the tree. A model alone has its frame as `base`.
    fn new(
        description: Description<'a>,
        poses: Poses,
        base: Option<(usize, Place)>,
        options: &'a LoadOptions,
    ) -> Result<Self, FileError> {
        let own = description.links.iter().map(|link| link.frame);
        let mut builder = Self {
            frames: std::iter::once(WORLD).chain(own).collect(),
            parents: vec![None; description.links.len() + 1],
            joints: Vec::new(),
            between: Vec::new(),
            description,
            poses,
            options,
        };
        let joints = std::mem::take(&mut builder.description.joints);
        let ends = joints.iter().map(|joint| builder.ends(joint));
        let ends: Vec<Option<[usize; 2]>> = ends.collect::<Result<_, _>>()?;
        for (joint, ends) in joints.iter().zip(&ends) {
            match *ends {
                Some([parent, child]) => {
                    builder.parents[child] = Some(parent);
                    if joint.kind != MotionKind::Fixed {
                        builder.frames[child] = joint.frame;
                    }
                }
                None if joint.kind == MotionKind::Fixed => {}
                None => {
                    let reason = FileErrorKind::Malformed("joint of a static model never moves".into());
                    builder.description.skipped.push(joint.place.error(reason).into());
                }
            }
        }
        let moving: HashMap<usize, &Joint> = joints
            .iter()
            .zip(&ends)
            .filter(|(_, ends)| ends.is_some())
            .map(|(joint, _)| (joint.frame, joint))
            .collect();
        for (joint, ends) in joints.iter().zip(&ends) {
            if let Some(ends) = *ends {
                builder.joint(joint, ends, &moving)?;
            }
        }
        let fixed = base.map(|(frame, place)| builder.base(frame, &place)).transpose()?;
        for link in 1..builder.parents.len() {
            if builder.parents[link].is_none() {
                let joint = builder.standing(link, fixed.flatten() == Some(link));
                builder.joints.push(joint);
            }
        }
        Ok(builder)
    }

    fn link(&self, link: usize) -> &Link {
        &self.description.links[link - 1]
    }

    fn is_static(&self, link: usize) -> bool {
        link == 0 || self.link(link).is_static
    }

    /// Returns the parent and the child link of a joint; `None` if neither can move.
    fn ends(&self, joint: &Joint) -> Result<Option<[usize; 2]>, FileError> {
        let link_of = |target: &Target| {
            let frame = self.description.frames.number(target)?;
            match self.poses.carriers[frame] {
                Carrier::World => Ok(0),
                Carrier::Link(link) => Ok(link + 1),
                Carrier::Nothing => {
                    let name = &self.description.frames.frames[frame].name;
                    let reason = FileErrorKind::Missing(format!("link of the frame {name:?}"));
                    Err(joint.place.error(reason))
                }
            }
        };
        let [parent, child] = [link_of(&joint.parent)?, link_of(&joint.child)?];
        let is_world = matches!(&joint.child, Target::Named(name) if name.name == "world");
        if !is_world && self.is_static(parent) && self.is_static(child) {
            return Ok(None);
        }
        if self.is_static(child) {
            let reason = FileErrorKind::Unsupported("a joint that moves the world or a static model".into());
            return Err(joint.place.error(reason));
        }
        Ok(Some([parent, child]))
    }

    /// Adds a joint of the file. One with two axes has a link without bodies between them, and so
    /// has a screw, which slides as it turns.
    fn joint(
        &mut self,
        joint: &Joint,
        [mut parent, child]: [usize; 2],
        moving: &HashMap<usize, &Joint>,
    ) -> Result<(), FileError> {
        let origin = self.origin(parent, child);
        let single = |kind, axis, name: String| FileJoint {
            place: joint.place.clone(),
            name,
            kind,
            parent: 0,
            child,
            origin: Isometry3::identity(),
            axis,
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            velocity: None,
            reference: 0.0,
            follows: None,
        };
        let mut parts = Vec::new();
        if joint.axes.is_empty() {
            parts.push(single(joint.kind, Vector3::z_axis(), joint.name.clone()));
        }
        for (k, axis) in joint.axes.iter().enumerate() {
            let frames = &self.description.frames;
            let follows = axis.mimic.as_ref().map(|mimic| {
                let unknown = || frames.unknown(&mimic.leader, "joint that moves");
                let leader = moving.get(&frames.find(&mimic.leader)?).ok_or_else(unknown)?;
                if mimic.axis > 0 && leader.axes.len() < 2 {
                    let what = format!("second axis of joint {:?}", leader.name);
                    return Err(mimic.leader.place.error(FileErrorKind::Missing(what)));
                }
                Ok(Follows {
                    joint: leader.coordinate(mimic.axis),
                    factor: mimic.multiplier,
                    offset: mimic.offset - mimic.multiplier * mimic.reference,
                })
            });
            let turn = self.poses.between(frames.number(&axis.frame)?, joint.frame).rotation;
            let direction = turn * axis.direction;
            parts.push(FileJoint {
                limits: axis.limits,
                follows: follows.transpose()?,
                ..single(joint.kind, direction, joint.coordinate(k))
            });
            if let Some(thread) = joint.thread {
                let follows = Follows {
                    joint: joint.name.clone(),
                    factor: thread / TAU,
                    offset: 0.0,
                };
                parts.push(FileJoint {
                    follows: Some(follows),
                    ..single(MotionKind::Prismatic, direction, format!("{}/thread", joint.name))
                });
            }
        }
        parts[0].origin = origin;
        let last = parts.len() - 1;
        for (k, mut part) in parts.into_iter().enumerate() {
            part.parent = parent;
            if k < last {
                self.between.push(part.name.clone());
                part.child = self.description.links.len() + self.between.len();
            }
            parent = part.child;
            self.joints.push(part);
        }
        Ok(())
    }

    /// Returns the pose of a link in another one.
    fn origin(&self, parent: usize, child: usize) -> Isometry3<f64> {
        self.poses.between(self.frames[child], self.frames[parent])
    }

    /// Returns the link that is on the ground if a model is alone: the first above its
    /// canonical link. There is none if a joint holds a link to the world.
    fn base(&self, frame: usize, place: &Place) -> Result<Option<usize>, FileError> {
        if self.description.links.is_empty() {
            return Err(place.error(FileErrorKind::Missing("element link".into())));
        }
        let Carrier::Link(canonical) = self.poses.carriers[frame] else {
            return Ok(None);
        };
        if self.parents.contains(&Some(0)) {
            return Ok(None);
        }
        let mut link = canonical + 1;
        // The joints may form a loop, which the tree of links reports.
        for _ in 0..self.parents.len() {
            link = self.parents[link].unwrap_or(link);
        }
        Ok(Some(link))
    }

    /// Returns the joint to the world of a link that no joint of the file moves.
    fn standing(&self, link: usize, is_base: bool) -> FileJoint {
        let is_fixed = is_base || self.link(link).is_static;
        FileJoint {
            place: self.link(link).place.clone(),
            name: self.link(link).name.clone(),
            kind: if is_fixed {
                MotionKind::Fixed
            } else {
                MotionKind::Floating
            },
            parent: 0,
            child: link,
            // A floating joint has the pose in its coordinates.
            origin: if is_fixed {
                self.origin(0, link)
            } else {
                Isometry3::identity()
            },
            axis: Vector3::z_axis(),
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            velocity: None,
            reference: 0.0,
            follows: None,
        }
    }

    fn robot(mut self, name: &str) -> Result<Robot, FileError> {
        let links = std::mem::take(&mut self.description.links);
        let names: Vec<&str> = std::iter::once("world")
            .chain(links.iter().map(|link| link.name.as_str()))
            .chain(self.between.iter().map(String::as_str))
            .collect();
        let root = &self.description.frames.frames[WORLD].place;
        let tree = LinkTree::new(&names, &self.joints, self.options, root)?;
        let world = RobotLink {
            name: "world".into(),
            bodies: Vec::new(),
        };
        let mut robot_links = vec![world];
        for (k, link) in links.iter().enumerate() {
            let bodies = link.bodies.iter().map(|body| {
                let frame = self.description.frames.number(&body.relative_to)?;
                let origin = self.poses.between(frame, self.frames[k + 1]) * body.body.origin;
                Ok(LinkBody {
                    origin: checked(&origin, &link.place)?,
                    ..body.body.clone()
                })
            });
            robot_links.push(RobotLink {
                name: link.name.clone(),
                bodies: bodies.collect::<Result<_, FileError>>()?,
            });
        }
        robot_links.extend(self.between.into_iter().map(|name| RobotLink {
            name,
            bodies: Vec::new(),
        }));
        let mut robot = tree.robot(name, robot_links, self.joints);
        robot.model.adjacent = adjacent_by_joints(&robot.model.links, &robot.model.joints);
        robot.model.excluded = excluded(&robot, &links).map_err(|reason| root.error(reason))?;
        robot.skipped = self.description.skipped;
        let drawn: HashMap<&str, usize> = links.iter().map(|link| (link.name.as_str(), link.frame)).collect();
        let mut drawn_at = Vec::new();
        for joint in robot
            .model
            .joints
            .iter()
            .filter(|joint| joint.kind == MotionKind::Floating)
        {
            let frame = drawn.get(robot.model.links[joint.child].name.as_str());
            if let (Some(drive), Some(&frame)) = (joint.drive, frame) {
                drawn_at.push((drive.coordinate, self.poses.global[frame]));
            }
        }
        for (first, pose) in drawn_at {
            robot.draw(first, &pose);
        }
        Ok(robot)
    }
}

/// Returns the pairs of bodies that collide by the masks of neither.
fn excluded(robot: &Robot, links: &[Link]) -> Result<Vec<[usize; 2]>, FileErrorKind> {
    let by_name: HashMap<&str, &Link> = links.iter().map(|link| (link.name.as_str(), link)).collect();
    let in_order = robot
        .model
        .links
        .iter()
        .filter_map(|link| by_name.get(link.name.as_str()));
    let masks: Vec<[u32; 2]> = in_order
        .flat_map(|link| link.bodies.iter().map(|body| body.masks))
        .collect();
    let is_apart = |[category, collide]: [u32; 2], [other_category, other_collide]: [u32; 2]| {
        category & other_collide == 0 && other_category & collide == 0
    };
    // A body with all bits collides with each other one that has any bit.
    let is_masked = |k: usize| masks[k] != [ALL_BITS; 2];
    let masked: Vec<usize> = (0..masks.len()).filter(|&k| is_masked(k)).collect();
    let mut pairs = Vec::new();
    for &a in &masked {
        check_excluded(masked.len(), pairs.len())?;
        let others = (0..masks.len()).filter(|&b| b > a || !is_masked(b));
        let apart = others.filter(|&b| is_apart(masks[a], masks[b]));
        pairs.extend(apart.map(|b| [a.min(b), a.max(b)]));
    }
    check_excluded(masked.len(), pairs.len())?;
    pairs.sort_unstable();
    Ok(pairs)
}
