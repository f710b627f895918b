//! Converts the text of a URDF to a robot.

use std::collections::HashMap;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny_plan::Drive;
use roxmltree::Node;

use crate::error::{FileError, FileErrorKind, Skipped};
use crate::geometry::{self, Solid};
use crate::names::nearest;
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::{Coordinate, LinkBody, MotionKind, Robot, RobotJoint, RobotLink};
use crate::turn::direction;
use crate::xml::{EXTENT_MAX, Xml, attribute};

/// Elements that hold neither geometry for collisions nor kinematics.
const PASSED: [&str; 23] = [
    "audio_source",
    "calibration",
    "collision_checking",
    "contact",
    "contact_coefficients",
    "dynamics",
    "gazebo",
    "gravity",
    "hardwareInterface",
    "inertial",
    "kinematic",
    "material",
    "mujoco",
    "ros2_control",
    "safety_controller",
    "self_collide",
    "self_collision_checking",
    "self_filter",
    "sensor",
    "surface",
    "transmission",
    "verbose",
    "visual",
];

/// The first version of URDF in which an omitted limit is no limit.
const OPEN_LIMITS: [u32; 2] = [1, 2];

/// A joint of the file. Links are numbered in the order of the file.
struct JointText<'a> {
    node: Node<'a, 'a>,
    name: &'a str,
    kind: MotionKind,
    is_continuous: bool,
    parent: usize,
    child: usize,
    origin: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    limits: [f64; 2],
    mimic: Option<Mimic<'a>>,
}

struct Mimic<'a> {
    joint: &'a str,
    multiplier: f64,
    offset: f64,
}

/// State of the reader.
struct Reader<'a> {
    xml: &'a Xml<'a>,
    links: Vec<(&'a str, Node<'a, 'a>)>,
    joints: Vec<JointText<'a>>,
    folder: &'a Path,
    packages: &'a Packages,
    options: &'a LoadOptions,
}

pub(crate) fn parse(path: &Path, text: &str, packages: &Packages, options: &LoadOptions) -> Result<Robot, FileError> {
    let xml = Xml::parse(path, text, "robot")?;
    xml.version()?;
    let mut reader = Reader {
        xml: &xml,
        links: Vec::new(),
        joints: Vec::new(),
        folder: path.parent().unwrap_or(Path::new("")),
        packages,
        options,
    };
    let elements = xml.below(xml.root(), &["link", "joint"], &PASSED)?;
    let (links, joints): (Vec<_>, Vec<_>) = elements.into_iter().partition(|n| n.tag_name().name() == "link");
    let links = reader.named(links)?;
    let numbers: HashMap<&str, usize> = links.iter().enumerate().map(|(k, (name, _))| (*name, k)).collect();
    reader.links = links;
    for (name, node) in reader.named(joints)? {
        let joint = reader.joint_text(name, node, &numbers)?;
        reader.joints.push(joint);
    }
    reader.robot()
}

impl<'a> Reader<'a> {
    /// Returns elements with their names, which must differ.
    fn named(&self, nodes: Vec<Node<'a, 'a>>) -> Result<Vec<(&'a str, Node<'a, 'a>)>, FileError> {
        let mut names = std::collections::HashSet::new();
        let named = nodes.into_iter().map(|node| {
            let name = self.xml.needed(&node, "name")?;
            if names.insert(name) {
                Ok((name, node))
            } else {
                Err(self.xml.error(&node, FileErrorKind::Repeated))
            }
        });
        named.collect()
    }

    fn joint_text(
        &self,
        name: &'a str,
        node: Node<'a, 'a>,
        numbers: &HashMap<&str, usize>,
    ) -> Result<JointText<'a>, FileError> {
        let xml = self.xml;
        let parts = xml.below(node, &["parent", "child", "origin", "axis", "limit", "mimic"], &PASSED)?;
        let kind = self.kind(&node)?;
        let is_continuous = attribute(&node, "type") == Some("continuous");
        let end = |element: &str| -> Result<usize, FileError> {
            let end = xml.one(&node, &parts, element)?;
            xml.check_leaf(end, &["link"], false)?;
            let name = xml.needed(&end, "link")?;
            let unknown = || FileErrorKind::Unknown {
                kind: "link",
                name: name.into(),
                near: nearest(name, self.links.iter().map(|(name, _)| *name)),
            };
            numbers.get(name).copied().ok_or_else(|| xml.error(&end, unknown()))
        };
        let mimic = xml.at_most_one(&parts, "mimic")?;
        let mimic = mimic.map(|node| self.mimic(&node)).transpose()?;
        let takes_many = matches!(kind, MotionKind::Planar | MotionKind::Floating);
        if mimic.is_some() && takes_many {
            let what = FileErrorKind::Unsupported("mimic of a planar or floating joint".into());
            return Err(xml.error(&node, what));
        }
        let limit = xml.at_most_one(&parts, "limit")?;
        let is_limited = matches!(kind, MotionKind::Revolute | MotionKind::Prismatic) && !is_continuous;
        if is_limited && limit.is_none() && mimic.is_none() {
            return Err(xml.error(&node, FileErrorKind::Missing("element limit".into())));
        }
        let limits = limit.map(|limit| self.limits(&limit)).transpose()?;
        let open = [f64::NEG_INFINITY, f64::INFINITY];
        Ok(JointText {
            node,
            name,
            kind,
            is_continuous,
            parent: end("parent")?,
            child: end("child")?,
            origin: xml.origin(xml.at_most_one(&parts, "origin")?)?,
            axis: self.axis(xml.at_most_one(&parts, "axis")?, kind)?,
            // A mimic joint without limits has the limits of the joint that it follows.
            limits: limits.filter(|_| is_limited).unwrap_or(open),
            mimic,
        })
    }

    fn kind(&self, joint: &Node<'a, 'a>) -> Result<MotionKind, FileError> {
        match self.xml.needed(joint, "type")? {
            "revolute" | "continuous" => Ok(MotionKind::Revolute),
            "prismatic" => Ok(MotionKind::Prismatic),
            "fixed" => Ok(MotionKind::Fixed),
            "planar" => Ok(MotionKind::Planar),
            "floating" => Ok(MotionKind::Floating),
            kind => {
                let what = FileErrorKind::Unsupported(format!("a joint of type {kind:?}"));
                Err(self.xml.error(joint, what))
            }
        }
    }

    fn mimic(&self, node: &Node<'a, 'a>) -> Result<Mimic<'a>, FileError> {
        self.xml.check_leaf(*node, &["joint", "multiplier", "offset"], false)?;
        let number = |field: &str| Ok(self.xml.numbers(node, field)?.map(|[x]| x));
        Ok(Mimic {
            joint: self.xml.needed(node, "joint")?,
            multiplier: number("multiplier")?.unwrap_or(1.0),
            offset: number("offset")?.unwrap_or(0.0),
        })
    }

    /// Returns the least and greatest value that an element `limit` allows.
    fn limits(&self, node: &Node<'a, 'a>) -> Result<[f64; 2], FileError> {
        // Files have further attributes of motors here.
        self.xml.check_leaf(*node, &["lower", "upper"], true)?;
        let is_open = self.xml.version()? >= OPEN_LIMITS;
        let value = |field: &str, open: f64| {
            let value = self.xml.numbers(node, field)?.map(|[x]| x);
            if value.is_some_and(|x| x.abs() > EXTENT_MAX) {
                let (field, value) = (field.into(), value.unwrap_or_default());
                return Err(self.xml.error(node, FileErrorKind::Range { field, value }));
            }
            Ok(value.unwrap_or(if is_open { open } else { 0.0 }))
        };
        let [lower, upper] = [value("lower", f64::NEG_INFINITY)?, value("upper", f64::INFINITY)?];
        if lower > upper {
            return Err(self.xml.error(node, FileErrorKind::Limits { lower, upper }));
        }
        Ok([lower, upper])
    }

    fn axis(&self, node: Option<Node<'a, 'a>>, kind: MotionKind) -> Result<Unit<Vector3<f64>>, FileError> {
        let Some(node) = node else {
            return Ok(Vector3::x_axis());
        };
        self.xml.check_leaf(node, &["xyz"], false)?;
        let axis = direction(self.xml.needed_numbers(&node, "xyz")?);
        let has_none = matches!(kind, MotionKind::Fixed | MotionKind::Floating);
        axis.or(has_none.then(Vector3::z_axis)).ok_or_else(|| {
            let field = "length of the axis".into();
            self.xml.error(&node, FileErrorKind::Range { field, value: 0.0 })
        })
    }

    fn robot(&self) -> Result<Robot, FileError> {
        let order = self.order()?;
        let mut number = vec![0; self.links.len()];
        order.iter().enumerate().for_each(|(k, (link, _))| number[*link] = k);
        let (coordinates, drives) = self.coordinates()?;
        let (mut links, mut joints, mut skipped) = (Vec::new(), Vec::new(), Vec::new());
        for &(link, mover) in &order {
            links.push(self.link(link, &mut skipped)?);
            let Some(mover) = mover else { continue };
            let joint = &self.joints[mover];
            joints.push(RobotJoint {
                name: joint.name.into(),
                kind: joint.kind,
                parent: number[joint.parent],
                child: number[joint.child],
                origin: joint.origin,
                axis: joint.axis,
                drive: drives[mover],
                mimics: joint.mimic.as_ref().map(|mimic| mimic.joint.into()),
                limits: joint.limits,
            });
        }
        Ok(Robot {
            name: attribute(&self.xml.root(), "name").unwrap_or_default().into(),
            links,
            joints,
            coordinates,
            skipped,
        })
    }

    fn wrong_joint(&self, joint: usize, reason: FileErrorKind) -> FileError {
        self.xml.error(&self.joints[joint].node, reason)
    }

    /// Returns all links with the joints that move them, parents first.
    fn order(&self) -> Result<Vec<(usize, Option<usize>)>, FileError> {
        let mut mover: Vec<Option<usize>> = vec![None; self.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for (k, joint) in self.joints.iter().enumerate() {
            if let Some(other) = mover[joint.child].replace(k) {
                let link = self.links[joint.child].0.to_owned();
                let other = self.joints[other].name.to_owned();
                return Err(self.wrong_joint(k, FileErrorKind::SecondParent { link, other }));
            }
            below[joint.parent].push(k);
        }
        let roots: Vec<usize> = (0..self.links.len()).filter(|link| mover[*link].is_none()).collect();
        let mut order: Vec<(usize, Option<usize>)> = roots.iter().map(|link| (*link, None)).collect();
        let mut next = 0;
        while let Some(&(link, _)) = order.get(next) {
            order.extend(below[link].iter().map(|&k| (self.joints[k].child, Some(k))));
            next += 1;
        }
        if order.len() < self.links.len() {
            return Err(self.loop_of_joints(&order, &mover));
        }
        if roots.len() != 1 {
            let names = roots.iter().map(|link| self.links[*link].0.to_owned()).collect();
            return Err(self.xml.error(&self.xml.root(), FileErrorKind::Roots(names)));
        }
        Ok(order)
    }

    /// Returns the error of links that are not connected to a root: the loop above one of them.
    fn loop_of_joints(&self, order: &[(usize, Option<usize>)], mover: &[Option<usize>]) -> FileError {
        let mut is_connected = vec![false; self.links.len()];
        order.iter().for_each(|(link, _)| is_connected[*link] = true);
        let mut link = is_connected.iter().position(|is| !is).unwrap_or(0);
        let (mut passed, mut place) = (Vec::new(), vec![None; self.joints.len()]);
        while let Some(joint) = mover[link] {
            if let Some(first) = place[joint] {
                passed.drain(..first);
                break;
            }
            place[joint] = Some(passed.len());
            passed.push(joint);
            link = self.joints[joint].parent;
        }
        let names = passed.iter().map(|joint| self.joints[*joint].name.to_owned()).collect();
        self.wrong_joint(passed.first().copied().unwrap_or(0), FileErrorKind::Loop(names))
    }

    /// Returns all coordinates, and the drive of each joint.
    fn coordinates(&self) -> Result<(Vec<Coordinate>, Vec<Option<Drive>>), FileError> {
        let mut coordinates = Vec::new();
        let mut drives = vec![None; self.joints.len()];
        for (joint, drive) in self.joints.iter().zip(&mut drives) {
            if joint.kind == MotionKind::Fixed || joint.mimic.is_some() {
                continue;
            }
            *drive = Some(Drive::by(coordinates.len()));
            if joint.kind.parts().is_empty() {
                let (name, limits) = (joint.name.into(), self.range(joint));
                coordinates.push(Coordinate { name, limits });
            }
            coordinates.extend(joint.kind.parts().iter().map(|part| Coordinate {
                name: format!("{}/{part}", joint.name),
                limits: if part.len() == 1 {
                    self.options.floating_limits
                } else {
                    self.options.continuous_limits
                },
            }));
        }
        let by_name: HashMap<&str, usize> = self.joints.iter().enumerate().map(|(k, j)| (j.name, k)).collect();
        for k in 0..self.joints.len() {
            // A fixed joint never moves, even if it has a mimic element: tools that fix joints
            // leave the element.
            if self.joints[k].mimic.is_some() && self.joints[k].kind != MotionKind::Fixed {
                drives[k] = Some(self.mimicked(k, &drives, &by_name)?);
            }
        }
        Ok((coordinates, drives))
    }

    /// Follows a chain of mimics to the joint that has a coordinate.
    fn mimicked(
        &self,
        index: usize,
        drives: &[Option<Drive>],
        by_name: &HashMap<&str, usize>,
    ) -> Result<Drive, FileError> {
        let (mut factor, mut offset) = (1.0, 0.0);
        let (mut at, mut passed, mut place) = (index, Vec::new(), HashMap::new());
        while let Some(mimic) = &self.joints[at].mimic {
            if let Some(first) = place.insert(at, passed.len()) {
                let names = passed[first..]
                    .iter()
                    .map(|joint: &usize| self.joints[*joint].name.to_owned());
                return Err(self.wrong_joint(at, FileErrorKind::MimicLoop(names.collect())));
            }
            passed.push(at);
            offset += factor * mimic.offset;
            factor *= mimic.multiplier;
            let Some(next) = by_name.get(mimic.joint) else {
                let reason = FileErrorKind::Unknown {
                    kind: "joint",
                    name: mimic.joint.into(),
                    near: nearest(mimic.joint, self.joints.iter().map(|joint| joint.name)),
                };
                return Err(self.wrong_joint(at, reason));
            };
            at = *next;
        }
        for (field, value) in [("multiplier", factor), ("offset", offset)] {
            if !(value.abs() <= EXTENT_MAX) {
                let field = field.into();
                return Err(self.wrong_joint(index, FileErrorKind::Range { field, value }));
            }
        }
        let is_single = self.joints[at].kind.parts().is_empty();
        match drives[at].filter(|_| is_single) {
            Some(drive) => Ok(Drive {
                coordinate: drive.coordinate,
                factor,
                offset,
            }),
            None => {
                let name = self.joints[at].name;
                let what = format!("mimic of joint {name:?}, which does not have exactly one value,");
                Err(self.wrong_joint(index, FileErrorKind::Unsupported(what)))
            }
        }
    }

    /// Returns the least and greatest value of the coordinate of a joint.
    fn range(&self, joint: &JointText) -> [f64; 2] {
        let open = match joint.kind {
            MotionKind::Prismatic => self.options.floating_limits,
            _ => self.options.continuous_limits,
        };
        let or = |value: f64, open: f64| if value.is_finite() { value } else { open };
        match joint.limits {
            _ if joint.is_continuous => open,
            [lower, upper] => [or(lower, open[0]), or(upper, open[1])],
        }
    }

    fn link(&self, link: usize, skipped: &mut Vec<Skipped>) -> Result<RobotLink, FileError> {
        let (name, node) = self.links[link];
        let parts = self.xml.below(node, &["collision", "origin"], &PASSED)?;
        let origin = self.xml.at_most_one(&parts, "origin")?;
        // Some files have an origin of no effect here, where URDF has none.
        if let Some(node) = origin.filter(|_| self.xml.origin(origin).ok() != Some(Isometry3::identity())) {
            let what = "origin of a link is not the identity (expected an origin in its collision or joint)".into();
            return Err(self.xml.error(&node, FileErrorKind::Malformed(what)));
        }
        let collisions = parts.iter().filter(|n| n.tag_name().name() == "collision");
        let mut bodies = Vec::new();
        for collision in collisions {
            match self.body(name, *collision) {
                Ok(body) => bodies.push(body),
                Err(error) => match error.reason {
                    FileErrorKind::MissingMesh(_) if self.options.skip_missing_meshes => skipped.push(error.into()),
                    _ => return Err(error),
                },
            }
        }
        let name = name.into();
        Ok(RobotLink { name, bodies })
    }

    fn body(&self, link: &str, collision: Node<'a, 'a>) -> Result<LinkBody, FileError> {
        let xml = self.xml;
        let parts = xml.below(collision, &["origin", "geometry"], &PASSED)?;
        let origin = xml.origin(xml.at_most_one(&parts, "origin")?)?;
        let geometry = xml.one(&collision, &parts, "geometry")?;
        let shapes = xml.below(geometry, &["box", "cylinder", "capsule", "sphere", "mesh"], &PASSED)?;
        let shape = match shapes[..] {
            [shape] => shape,
            [] => return Err(xml.error(&geometry, FileErrorKind::Missing("a shape".into()))),
            [_, second, ..] => return Err(xml.error(&second, FileErrorKind::Twice("shape".into()))),
        };
        let wrong = |reason| xml.error(&shape, reason);
        let number = |field: &str| xml.needed_numbers(&shape, field).map(|[x]| x);
        let solid = match shape.tag_name().name() {
            "box" => {
                xml.check_leaf(shape, &["size"], false)?;
                let size = xml.needed_numbers(&shape, "size")?;
                Solid::Box { size }
            }
            "sphere" => {
                xml.check_leaf(shape, &["radius"], false)?;
                let radius = number("radius")?;
                Solid::Sphere { radius }
            }
            name @ ("cylinder" | "capsule") => {
                xml.check_leaf(shape, &["radius", "length"], false)?;
                let (radius, length) = (number("radius")?, number("length")?);
                if name == "cylinder" {
                    Solid::Cylinder { radius, length }
                } else {
                    Solid::Capsule { radius, length }
                }
            }
            _ => {
                xml.check_leaf(shape, &["filename", "scale"], false)?;
                let name = xml.needed(&shape, "filename")?;
                let scale = xml.numbers(&shape, "scale")?.unwrap_or([1.0; 3]);
                let file = self.packages.find(name, self.folder).map_err(wrong)?;
                let usage = self.options.mesh_of(link);
                let body = geometry::of_mesh(&file, &Vector3::from(scale), usage, self.options);
                let (geometry, hull_fit) = body.map_err(wrong)?;
                return Ok(LinkBody {
                    origin,
                    geometry,
                    mesh: Some(file),
                    hull_fit,
                });
            }
        };
        Ok(LinkBody {
            origin,
            geometry: solid.geometry().map_err(wrong)?,
            mesh: None,
            hull_fit: None,
        })
    }
}
