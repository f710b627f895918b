//! From the links and joints of a file to the tree of a robot: order, coordinates, drives.

use std::collections::HashMap;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny_plan::Drive;

use crate::error::{FileError, FileErrorKind, Place};
use crate::options::LoadOptions;
use crate::robot::{Robot, containing};
use crate::xml::EXTENT_MAX;
use lin_canny_plan::nearest_name as nearest;
use lin_canny_plan::{Coordinate, MotionKind, RobotJoint, RobotLink, RobotModel};

/// The most joints through which a joint mimics another one.
const CHAIN: usize = 100;

/// A joint of a file. Links are numbered in the order of the file.
pub(crate) struct FileJoint {
    pub(crate) place: Place,
    pub(crate) name: String,
    pub(crate) kind: MotionKind,
    pub(crate) parent: usize,
    pub(crate) child: usize,
    pub(crate) origin: Isometry3<f64>,
    pub(crate) axis: Unit<Vector3<f64>>,
    /// Least and greatest value; infinite where the file states none.
    pub(crate) limits: [f64; 2],
    /// Greatest absolute velocity, if the file states one.
    pub(crate) velocity: Option<f64>,
    /// The value at which the child is at the origin, where the file draws it.
    pub(crate) reference: f64,
    pub(crate) follows: Option<Follows>,
}

impl FileJoint {
    /// Returns the limits that the file states, and others where it states none.
    fn bounded(&self, open: [f64; 2]) -> [f64; 2] {
        let or = |value: f64, open: f64| if value.is_finite() { value } else { open };
        [or(self.limits[0], open[0]), or(self.limits[1], open[1])]
    }
}

/// The joint that a joint follows: its value is `factor` times the value of that joint, and
/// `offset`.
pub(crate) struct Follows {
    pub(crate) joint: String,
    pub(crate) factor: f64,
    pub(crate) offset: f64,
}

/// The order of links, parents first, and what moves them.
pub(crate) struct LinkTree {
    /// Links, each with the joint that moves it.
    order: Vec<(usize, Option<usize>)>,
    coordinates: Vec<Coordinate>,
    /// The values of the coordinates at which all joints are at their references.
    start: Vec<f64>,
    /// The drive of each joint of the file.
    drives: Vec<Option<Drive>>,
}

/// The links and joints of a file.
struct File<'a> {
    links: &'a [&'a str],
    joints: &'a [FileJoint],
    options: &'a LoadOptions,
}

impl LinkTree {
    /// Returns the tree of the links and joints of a file, whose errors are at the root element.
    pub(crate) fn new(
        links: &[&str],
        joints: &[FileJoint],
        options: &LoadOptions,
        root: &Place,
    ) -> Result<Self, FileError> {
        let file = File { links, joints, options };
        let order = file.order(root)?;
        let (coordinates, drives) = file.coordinates()?;
        let mut start = vec![0.0; coordinates.len()];
        for (joint, drive) in joints.iter().zip(&drives).filter(|(joint, _)| joint.follows.is_none()) {
            if let Some(drive) = drive {
                start[drive.coordinate] = joint.reference;
            }
        }
        Ok(Self {
            order,
            coordinates,
            start,
            drives,
        })
    }

    /// Returns the robot of these links and joints, which are in the order of the file.
    pub(crate) fn robot(self, name: &str, links: Vec<RobotLink>, joints: Vec<FileJoint>) -> Robot {
        let mut number = vec![0; links.len()];
        self.order
            .iter()
            .enumerate()
            .for_each(|(k, (link, _))| number[*link] = k);
        let mut links: Vec<Option<RobotLink>> = links.into_iter().map(Some).collect();
        let mut joints: Vec<Option<FileJoint>> = joints.into_iter().map(Some).collect();
        let joint_of = |(joint, drive): (FileJoint, Option<Drive>)| RobotJoint {
            name: joint.name,
            kind: joint.kind,
            parent: number[joint.parent],
            child: number[joint.child],
            origin: joint.origin,
            axis: joint.axis,
            drive,
            mimics: joint.follows.map(|follows| follows.joint),
            limits: joint.limits,
        };
        Robot {
            name: name.into(),
            model: RobotModel {
                links: self.order.iter().filter_map(|&(link, _)| links[link].take()).collect(),
                joints: self
                    .order
                    .iter()
                    .filter_map(|&(_, mover)| Some((joints[mover?].take()?, self.drives[mover?])))
                    .map(joint_of)
                    .collect(),
                coordinates: self.coordinates,
                ..RobotModel::default()
            },
            start: self.start,
            qpos: Vec::new(),
            skipped: Vec::new(),
        }
    }
}

impl File<'_> {
    /// Returns all links with the joints that move them, parents first.
    fn order(&self, root: &Place) -> Result<Vec<(usize, Option<usize>)>, FileError> {
        let mut mover: Vec<Option<usize>> = vec![None; self.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        for (k, joint) in self.joints.iter().enumerate() {
            if let Some(other) = mover[joint.child].replace(k) {
                let link = self.links[joint.child].to_owned();
                let other = self.joints[other].name.clone();
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
            let names = roots.iter().map(|link| self.links[*link].to_owned()).collect();
            return Err(root.error(FileErrorKind::Roots(names)));
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
        let names = passed.iter().map(|joint| self.joints[*joint].name.clone()).collect();
        self.wrong_joint(passed.first().copied().unwrap_or(0), FileErrorKind::Loop(names))
    }

    /// Returns all coordinates, and the drive of each joint.
    fn coordinates(&self) -> Result<(Vec<Coordinate>, Vec<Option<Drive>>), FileError> {
        let mut coordinates = Vec::new();
        let mut drives = vec![None; self.joints.len()];
        for (joint, drive) in self.joints.iter().zip(&mut drives) {
            if joint.kind == MotionKind::Fixed || joint.follows.is_some() {
                continue;
            }
            *drive = Some(Drive {
                offset: -joint.reference,
                ..Drive::by(coordinates.len())
            });
            if joint.kind.coordinate_names().is_empty() {
                let (name, limits) = (joint.name.clone(), self.range(joint));
                let velocity = joint.velocity;
                coordinates.push(Coordinate { name, limits, velocity });
            }
            coordinates.extend(joint.kind.coordinate_names().iter().map(|part| Coordinate {
                name: format!("{}/{part}", joint.name),
                limits: joint.bounded(if part.len() == 1 {
                    self.options.floating_limits
                } else {
                    self.options.continuous_limits
                }),
                velocity: None,
            }));
        }
        let by_name = self.joints.iter().enumerate().map(|(k, j)| (j.name.as_str(), k));
        let by_name: HashMap<&str, usize> = by_name.collect();
        for k in 0..self.joints.len() {
            // A fixed joint never moves, even if it has a mimic element: tools that fix joints
            // leave the element.
            if self.joints[k].follows.is_some() && self.joints[k].kind != MotionKind::Fixed {
                let drive = self.mimicked(k, &drives, &by_name)?;
                drives[k] = Some(drive);
                let of = &mut coordinates[drive.coordinate].velocity;
                let own = self.joints[k].velocity.filter(|_| drive.factor != 0.0);
                *of = match (*of, own.map(|own| own / drive.factor.abs())) {
                    (Some(of), Some(own)) => Some(if own < of { own } else { of }),
                    (of, own) => of.or(own),
                };
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
        while let Some(follows) = &self.joints[at].follows {
            if let Some(first) = place.insert(at, passed.len()) {
                let names = passed[first..]
                    .iter()
                    .map(|joint: &usize| self.joints[*joint].name.clone());
                return Err(self.wrong_joint(at, FileErrorKind::MimicLoop(names.collect())));
            }
            passed.push(at);
            if passed.len() > CHAIN {
                let what = format!("chain of mimics is too long (expected at most {CHAIN} joints)");
                return Err(self.wrong_joint(index, FileErrorKind::Malformed(what)));
            }
            offset += factor * follows.offset;
            factor *= follows.factor;
            let Some(next) = by_name.get(follows.joint.as_str()) else {
                let reason = FileErrorKind::Unknown {
                    kind: "joint",
                    name: follows.joint.clone(),
                    near: nearest(&follows.joint, self.joints.iter().map(|joint| joint.name.as_str())),
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
        let is_single = self.joints[at].kind.coordinate_names().is_empty();
        match drives[at].filter(|_| is_single) {
            Some(drive) => Ok(Drive {
                coordinate: drive.coordinate,
                factor,
                offset: offset - self.joints[index].reference,
            }),
            None => {
                let name = &self.joints[at].name;
                let what = format!("mimic of joint {name:?}, which does not have exactly one value,");
                Err(self.wrong_joint(index, FileErrorKind::Unsupported(what)))
            }
        }
    }

    /// Returns the least and greatest value of the coordinate of a joint. Limits that the file does
    /// not state contain the value at which it draws the joint.
    fn range(&self, joint: &FileJoint) -> [f64; 2] {
        let open = match joint.kind {
            MotionKind::Prismatic => self.options.floating_limits,
            _ => self.options.continuous_limits,
        };
        let open = match joint.reference {
            0.0 => open,
            drawn => containing(open, drawn),
        };
        joint.bounded(open)
    }

    fn wrong_joint(&self, joint: usize, reason: FileErrorKind) -> FileError {
        self.joints[joint].place.error(reason)
    }
}
