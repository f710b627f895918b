//! Converts the text of a URDF to a robot.

use std::collections::HashMap;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_plan::Drive;
use roxmltree::Node;
use urdf_rs::JointType;

use crate::error::{FileError, FileErrorKind};
use crate::geometry::{self, Solid};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::{Coordinate, LinkBody, MotionKind, Robot, RobotJoint, RobotLink};
use crate::turn::direction;
use crate::xml::{EXTENT_MAX, Xml, children};

/// State of the reader.
struct Reader<'a> {
    xml: Xml<'a>,
    model: urdf_rs::Robot,
    folder: &'a Path,
    packages: &'a Packages,
    options: &'a LoadOptions,
}

pub(crate) fn parse(path: &Path, text: &str, packages: &Packages, options: &LoadOptions) -> Result<Robot, FileError> {
    let xml = Xml::parse(path, text, "robot")?;
    xml.check_urdf()?;
    let model = urdf_rs::read_from_string(&xml.undrawn(text))
        .map_err(|e| FileError::new(path, None, "", FileErrorKind::Malformed(e.to_string())))?;
    let reader = Reader {
        xml,
        model,
        folder: path.parent().unwrap_or(Path::new("")),
        packages,
        options,
    };
    reader.robot()
}

impl Reader<'_> {
    fn robot(&self) -> Result<Robot, FileError> {
        let order = self.order()?;
        let number: HashMap<&str, usize> = order.iter().enumerate().map(|(k, (link, _))| (*link, k)).collect();
        let (coordinates, drives) = self.coordinates()?;
        let (mut links, mut joints) = (Vec::new(), Vec::new());
        for (link, joint) in &order {
            links.push(self.link(link)?);
            if let Some(j) = *joint {
                let joint = &self.model.joints[j];
                let [parent, child] = [&joint.parent.link, &joint.child.link].map(|name| number[name.as_str()]);
                joints.push(self.joint(joint, [parent, child], drives[j])?);
            }
        }
        Ok(Robot {
            name: self.model.name.clone(),
            links,
            joints,
            coordinates,
        })
    }

    fn wrong_joint(&self, joint: &str, reason: FileErrorKind) -> FileError {
        self.xml.error_of("joint", joint, reason)
    }

    /// Returns all links with the joints that move them, parents first.
    fn order(&self) -> Result<Vec<(&str, Option<usize>)>, FileError> {
        let joints = &self.model.joints;
        let mut mover: HashMap<&str, usize> = HashMap::new();
        let mut below: HashMap<&str, Vec<usize>> = HashMap::new();
        for (k, joint) in joints.iter().enumerate() {
            for name in [&joint.parent.link, &joint.child.link] {
                if !self.model.links.iter().any(|l| l.name == *name) {
                    let (kind, name) = ("link", name.clone());
                    return Err(self.wrong_joint(&joint.name, FileErrorKind::Unknown { kind, name }));
                }
            }
            if let Some(other) = mover.insert(&joint.child.link, k) {
                let link = joint.child.link.clone();
                let other = joints[other].name.clone();
                return Err(self.wrong_joint(&joint.name, FileErrorKind::SecondParent { link, other }));
            }
            below.entry(&joint.parent.link).or_default().push(k);
        }
        let links = || self.model.links.iter().map(|l| l.name.as_str());
        let roots: Vec<&str> = links().filter(|l| !mover.contains_key(l)).collect();
        let mut order: Vec<(&str, Option<usize>)> = roots.iter().map(|l| (*l, None)).collect();
        let mut next = 0;
        while let Some(&(link, _)) = order.get(next) {
            let children = below.get(link).into_iter().flatten();
            order.extend(children.map(|&k| (joints[k].child.link.as_str(), Some(k))));
            next += 1;
        }
        if order.len() < self.model.links.len() {
            return Err(self.loop_of_joints(&order));
        }
        if roots.len() != 1 {
            let names = roots.iter().map(|l| (*l).to_owned()).collect();
            return Err(self.xml.error(&self.xml.root(), FileErrorKind::Roots(names)));
        }
        Ok(order)
    }

    /// Returns the error of links that are not connected to a root: the loop above one of them.
    fn loop_of_joints(&self, order: &[(&str, Option<usize>)]) -> FileError {
        let hangs = |link: &str| order.iter().any(|(l, _)| *l == link);
        let loose = self.model.links.iter().find(|l| !hangs(&l.name));
        let mut link = loose.map_or("", |l| l.name.as_str());
        let mut passed: Vec<&urdf_rs::Joint> = Vec::new();
        while let Some(joint) = self.model.joints.iter().find(|j| j.child.link == link) {
            if let Some(first) = passed.iter().position(|j| j.name == joint.name) {
                passed.drain(..first);
                break;
            }
            passed.push(joint);
            link = &joint.parent.link;
        }
        let names: Vec<String> = passed.iter().map(|j| j.name.clone()).collect();
        let first = names.first().cloned().unwrap_or_default();
        self.wrong_joint(&first, FileErrorKind::Loop(names))
    }

    /// Returns all coordinates, and the drive of each joint.
    fn coordinates(&self) -> Result<(Vec<Coordinate>, Vec<Option<Drive>>), FileError> {
        let joints = &self.model.joints;
        let mut coordinates = Vec::new();
        let mut drives = vec![None; joints.len()];
        for (joint, drive) in joints.iter().zip(&mut drives) {
            let kind = self.kind(joint)?;
            if kind == MotionKind::Fixed || joint.mimic.is_some() {
                continue;
            }
            *drive = Some(Drive::by(coordinates.len()));
            let ranges = self.ranges(joint, kind)?;
            if kind.parts().is_empty() {
                let (name, limits) = (joint.name.clone(), ranges);
                coordinates.push(Coordinate { name, limits });
            }
            coordinates.extend(kind.parts().iter().map(|part| Coordinate {
                name: format!("{}/{part}", joint.name),
                limits: if part.len() == 1 {
                    self.options.floating_limits
                } else {
                    self.options.continuous_limits
                },
            }));
        }
        for k in 0..joints.len() {
            if joints[k].mimic.is_some() && joints[k].joint_type != JointType::Fixed {
                drives[k] = Some(self.mimicked(k, &drives)?);
            }
        }
        Ok((coordinates, drives))
    }

    /// Follows a chain of mimics to the joint that has a coordinate.
    fn mimicked(&self, index: usize, drives: &[Option<Drive>]) -> Result<Drive, FileError> {
        let joints = &self.model.joints;
        let (mut factor, mut offset) = (1.0, 0.0);
        let (mut at, mut passed) = (index, Vec::new());
        while let Some(mimic) = &joints[at].mimic {
            if let Some(first) = passed.iter().position(|name| *name == joints[at].name) {
                passed.drain(..first);
                return Err(self.wrong_joint(&joints[at].name, FileErrorKind::MimicLoop(passed)));
            }
            passed.push(joints[at].name.clone());
            offset += factor * mimic.offset.unwrap_or(0.0);
            factor *= mimic.multiplier.unwrap_or(1.0);
            let Some(next) = joints.iter().position(|j| j.name == mimic.joint) else {
                let (kind, name) = ("joint", mimic.joint.clone());
                return Err(self.wrong_joint(&joints[at].name, FileErrorKind::Unknown { kind, name }));
            };
            at = next;
        }
        for (field, value) in [("multiplier", factor), ("offset", offset)] {
            if !(value.abs() <= EXTENT_MAX) {
                let field = field.into();
                return Err(self.wrong_joint(&joints[index].name, FileErrorKind::Range { field, value }));
            }
        }
        let is_single = self.kind(&joints[at])?.parts().is_empty();
        match drives[at].filter(|_| is_single) {
            Some(drive) => Ok(Drive {
                coordinate: drive.coordinate,
                factor,
                offset,
            }),
            None => {
                let what = format!(
                    "mimic of joint {:?}, which does not have exactly one value,",
                    joints[at].name
                );
                Err(self.wrong_joint(&joints[index].name, FileErrorKind::Unsupported(what)))
            }
        }
    }

    fn kind(&self, joint: &urdf_rs::Joint) -> Result<MotionKind, FileError> {
        let kind = match joint.joint_type {
            JointType::Revolute | JointType::Continuous => MotionKind::Revolute,
            JointType::Prismatic => MotionKind::Prismatic,
            JointType::Fixed => MotionKind::Fixed,
            JointType::Planar => MotionKind::Planar,
            JointType::Floating => MotionKind::Floating,
            JointType::Spherical => {
                let what = FileErrorKind::Unsupported("a spherical joint".into());
                return Err(self.wrong_joint(&joint.name, what));
            }
        };
        // A fixed joint never moves, even if it has a mimic element: tools that fix joints leave
        // the element.
        let takes_many = matches!(kind, MotionKind::Planar | MotionKind::Floating);
        if joint.mimic.is_some() && takes_many {
            let what = FileErrorKind::Unsupported("mimic of a planar or floating joint".into());
            return Err(self.wrong_joint(&joint.name, what));
        }
        Ok(kind)
    }

    /// Returns the least and greatest value of a joint, which URDF 1.2 may omit.
    fn ranges(&self, joint: &urdf_rs::Joint, kind: MotionKind) -> Result<[f64; 2], FileError> {
        let open = match kind {
            MotionKind::Prismatic => self.options.floating_limits,
            _ => self.options.continuous_limits,
        };
        if joint.joint_type == JointType::Continuous || !kind.parts().is_empty() {
            return Ok(open);
        }
        let [lower, upper] = [joint.limit.lower, joint.limit.upper];
        if lower > upper {
            return Err(self.wrong_joint(&joint.name, FileErrorKind::Limits { lower, upper }));
        }
        for (field, value) in [("lower", lower), ("upper", upper)] {
            if value.is_finite() && value.abs() > EXTENT_MAX {
                let field = field.into();
                return Err(self.wrong_joint(&joint.name, FileErrorKind::Range { field, value }));
            }
        }
        let or = |value: f64, open: f64| if value.is_finite() { value } else { open };
        Ok([or(lower, open[0]), or(upper, open[1])])
    }

    fn joint(
        &self,
        joint: &urdf_rs::Joint,
        [parent, child]: [usize; 2],
        drive: Option<Drive>,
    ) -> Result<RobotJoint, FileError> {
        let kind = self.kind(joint)?;
        let axis = direction(*joint.axis.xyz);
        let is_free = matches!(kind, MotionKind::Fixed | MotionKind::Floating);
        let Some(axis) = axis.or(is_free.then(Vector3::z_axis)) else {
            let field = "the length of the axis".into();
            let reason = FileErrorKind::Range { field, value: 0.0 };
            return Err(self.wrong_joint(&joint.name, reason));
        };
        let node = self
            .xml
            .elements("joint")
            .find(|n| n.attribute("name") == Some(&joint.name));
        let origin = node.map_or(Ok(Isometry3::identity()), |n| self.xml.origin(n))?;
        let limits = match (kind, joint.joint_type == JointType::Continuous) {
            (MotionKind::Revolute | MotionKind::Prismatic, false) => [joint.limit.lower, joint.limit.upper],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        Ok(RobotJoint {
            name: joint.name.clone(),
            kind,
            parent,
            child,
            origin,
            axis,
            drive,
            mimics: joint.mimic.as_ref().map(|m| m.joint.clone()),
            limits,
        })
    }

    fn link(&self, name: &str) -> Result<RobotLink, FileError> {
        let collisions = self
            .model
            .links
            .iter()
            .filter(|l| l.name == name)
            .flat_map(|l| &l.collision);
        let bodies: Result<Vec<LinkBody>, FileError> = collisions
            .enumerate()
            .map(|(k, collision)| {
                let node = self.collision(name, k);
                let origin = node.map_or(Ok(Isometry3::identity()), |n| self.xml.origin(n))?;
                self.body(name, collision, origin)
                    .map_err(|reason| self.wrong_collision(name, k, reason))
            })
            .collect();
        Ok(RobotLink {
            name: name.into(),
            bodies: bodies?,
        })
    }

    /// Returns a collision element of a link, by its number.
    fn collision(&self, link: &str, number: usize) -> Option<Node<'_, '_>> {
        let node = self.xml.elements("link").find(|n| n.attribute("name") == Some(link));
        children(node?, "collision").nth(number)
    }

    /// Returns the error of a collision element of a link, by its number.
    fn wrong_collision(&self, link: &str, number: usize, reason: FileErrorKind) -> FileError {
        let collision = self.collision(link, number);
        let shape = collision.and_then(|c| children(c, "geometry").next()?.children().find(|n| n.is_element()));
        match shape {
            Some(shape) => self.xml.error(&shape, reason),
            None => self.xml.error_of("link", link, reason),
        }
    }

    fn body(
        &self,
        link: &str,
        collision: &urdf_rs::Collision,
        origin: Isometry3<f64>,
    ) -> Result<LinkBody, FileErrorKind> {
        let body = |geometry, mesh, hull_fit| LinkBody {
            origin,
            geometry,
            mesh,
            hull_fit,
        };
        let solid = match &collision.geometry {
            urdf_rs::Geometry::Box { size } => Solid::Box { size: **size },
            &urdf_rs::Geometry::Cylinder { radius, length } => Solid::Cylinder { radius, length },
            &urdf_rs::Geometry::Capsule { radius, length } => Solid::Capsule { radius, length },
            &urdf_rs::Geometry::Sphere { radius } => Solid::Sphere { radius },
            urdf_rs::Geometry::Mesh { filename, scale } => {
                let file = self.packages.find(filename, self.folder)?;
                let scale = scale.map_or(Vector3::repeat(1.0), |s| Vector3::from(*s));
                let usage = self.options.mesh_of(link);
                let (geometry, fit) = geometry::of_mesh(&file, &scale, usage, self.options)?;
                return Ok(body(geometry, Some(file), fit));
            }
        };
        Ok(body(solid.geometry()?, None, None))
    }
}
