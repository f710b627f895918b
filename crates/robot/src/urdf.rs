//! Converts a URDF to a robot.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use roxmltree::Node;

use crate::drake;
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::geometry::{self, Solid};
use crate::link_tree::{FileJoint, Follows, LinkTree};
use crate::mesh_file::MeshPlacing;
use crate::options::{LoadOptions, MeshUse};
use crate::packages::Packages;
use crate::robot::{Robot, adjacent_by_joints};
use crate::turn::direction;
use crate::xml::{EXTENT_MAX, Xml, attribute};
use lin_canny_plan::nearest_name as nearest;
use lin_canny_plan::{LinkBody, MotionKind, RobotLink};

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

/// Limits of joints, in radians, that are rather degrees: more than ten turns.
const DEGREES: std::ops::RangeInclusive<f64> = 63.0..=720.0;

/// State of the reader.
struct Reader<'a> {
    xml: &'a Xml<'a>,
    links: Vec<(&'a str, Node<'a, 'a>)>,
    joints: Vec<FileJoint>,
    /// Pairs of links that are not checked.
    excluded: BTreeSet<[usize; 2]>,
    folder: &'a Path,
    packages: &'a Packages,
    options: &'a LoadOptions,
}

pub(crate) fn read(xml: &Xml, packages: &Packages, options: &LoadOptions) -> Result<Robot, FileError> {
    xml.version()?;
    let mut reader = Reader {
        xml,
        links: Vec::new(),
        joints: Vec::new(),
        excluded: BTreeSet::new(),
        folder: xml.file.parent().unwrap_or(Path::new("")),
        packages,
        options,
    };
    let elements = xml.below(xml.root(), &["link", "joint"], &PASSED)?;
    let (links, joints): (Vec<_>, Vec<_>) = elements.into_iter().partition(|n| n.tag_name().name() == "link");
    let links = reader.named(links)?;
    let numbers: HashMap<&str, usize> = links.iter().enumerate().map(|(k, (name, _))| (*name, k)).collect();
    let groups = drake::below(xml, xml.root(), &["drake:collision_filter_group"])?;
    reader.excluded = drake::excluded(xml, &groups, &numbers)?;
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
    ) -> Result<FileJoint, FileError> {
        let xml = self.xml;
        let parts = xml.below(node, &["parent", "child", "origin", "axis", "limit", "mimic"], &PASSED)?;
        drake::below(xml, node, &[])?;
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
        let follows = mimic.map(|node| self.mimic(&node)).transpose()?;
        let takes_many = matches!(kind, MotionKind::Planar | MotionKind::Floating);
        if follows.is_some() && takes_many {
            let what = FileErrorKind::Unsupported("mimic of a planar or floating joint".into());
            return Err(xml.error(&node, what));
        }
        let limit = xml.at_most_one(&parts, "limit")?;
        let is_limited = matches!(kind, MotionKind::Revolute | MotionKind::Prismatic) && !is_continuous;
        if is_limited && limit.is_none() && follows.is_none() {
            return Err(xml.error(&node, FileErrorKind::Missing("element limit".into())));
        }
        let limits = limit.map(|limit| self.limits(&limit)).transpose()?;
        if let (Some(limit), Some([lower, upper])) = (limit, limits.filter(|_| is_limited))
            && kind == MotionKind::Revolute
            && [lower, upper].iter().any(|x| DEGREES.contains(&x.abs()))
        {
            let what = format!("limits {lower:?} and {upper:?} look like degrees (expected radians)");
            xml.skip(limit.range().start, xml.error(&limit, FileErrorKind::Malformed(what)));
        }
        let open = [f64::NEG_INFINITY, f64::INFINITY];
        Ok(FileJoint {
            place: xml.place(&node),
            name: name.into(),
            kind,
            parent: end("parent")?,
            child: end("child")?,
            origin: xml.origin(xml.at_most_one(&parts, "origin")?)?,
            axis: self.axis(xml.at_most_one(&parts, "axis")?, kind)?,
            // A mimic joint without limits has the limits of the joint that it follows.
            limits: limits.filter(|_| is_limited).unwrap_or(open),
            velocity: limit.map(|limit| self.velocity(&limit)).transpose()?.flatten(),
            reference: 0.0,
            follows,
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

    fn mimic(&self, node: &Node<'a, 'a>) -> Result<Follows, FileError> {
        self.xml.check_leaf(*node, &["joint", "multiplier", "offset"], false)?;
        let number = |field: &str| Ok(self.xml.numbers(node, field)?.map(|[x]| x));
        Ok(Follows {
            joint: self.xml.needed(node, "joint")?.into(),
            factor: number("multiplier")?.unwrap_or(1.0),
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

    /// Returns the greatest absolute velocity that an element `limit` allows, if there is one.
    fn velocity(&self, node: &Node<'a, 'a>) -> Result<Option<f64>, FileError> {
        // No text is no limit, like no attribute.
        let is_open = attribute(node, "velocity")
            .is_some_and(|text| text.trim().is_empty() || text.trim().parse() == Ok(f64::INFINITY));
        match is_open {
            true => Ok(None),
            false => Ok(self.xml.numbers(node, "velocity")?.map(|[x]| x)),
        }
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

    fn robot(self) -> Result<Robot, FileError> {
        let names: Vec<&str> = self.links.iter().map(|(name, _)| *name).collect();
        let root = self.xml.place(&self.xml.root());
        let tree = LinkTree::new(&names, &self.joints, self.options, &root)?;
        let mut skipped = Vec::new();
        let links = (0..self.links.len()).map(|link| self.link(link, &mut skipped));
        let links: Vec<RobotLink> = links.collect::<Result<_, _>>()?;
        let name = attribute(&self.xml.root(), "name").unwrap_or_default();
        let mut robot = tree.robot(name, links, self.joints);
        robot.model.adjacent = adjacent_by_joints(&robot.model.links, &robot.model.joints);
        robot.model.excluded = bodies_of(&robot.model.links, &names, &self.excluded);
        robot.skipped = skipped;
        Ok(robot)
    }

    fn link(&self, link: usize, skipped: &mut Vec<Skipped>) -> Result<RobotLink, FileError> {
        let (name, node) = self.links[link];
        let parts = self.xml.below(node, &["collision", "origin"], &PASSED)?;
        drake::below(self.xml, node, &[])?;
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
        drake::below(xml, collision, &[])?;
        let origin = xml.origin(xml.at_most_one(&parts, "origin")?)?;
        let geometry = xml.one(&collision, &parts, "geometry")?;
        let mut shapes = xml.below(geometry, &["box", "cylinder", "capsule", "sphere", "mesh"], &PASSED)?;
        shapes.extend(drake::below(xml, geometry, &["drake:capsule", "drake:ellipsoid"])?);
        shapes.sort_by_key(|node| node.range().start);
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
            "ellipsoid" => {
                xml.check_leaf(shape, &["a", "b", "c"], false)?;
                let radii = [number("a")?, number("b")?, number("c")?];
                Solid::Ellipsoid { radii }
            }
            _ => {
                xml.check_leaf(shape, &["filename", "scale"], false)?;
                let convex = drake::below(xml, shape, &["drake:declare_convex"])?;
                let name = xml.needed(&shape, "filename")?;
                let scale = xml.numbers(&shape, "scale")?.unwrap_or([1.0; 3]);
                let file = self.packages.find(name, self.folder).map_err(wrong)?;
                let usage = match convex[..] {
                    [] => self.options.mesh_of(link),
                    _ => MeshUse::Hull,
                };
                let placing = MeshPlacing::scaled(scale).map_err(wrong)?;
                let body = geometry::of_mesh(&file, &placing, usage, self.options);
                let (geometry, hull_fit) = body.map_err(wrong)?;
                return Ok(LinkBody {
                    origin,
                    geometry,
                    mesh: Some(file),
                    hull_fit,
                });
            }
        };
        Ok(LinkBody::new(origin, solid.geometry().map_err(wrong)?))
    }
}

/// Returns the pairs of bodies of pairs of links, whose numbers are indices of `names`.
fn bodies_of(links: &[RobotLink], names: &[&str], pairs: &BTreeSet<[usize; 2]>) -> Vec<[usize; 2]> {
    let mut bodies = HashMap::new();
    let mut count = 0;
    for link in links {
        bodies.insert(link.name.as_str(), count..count + link.bodies.len());
        count += link.bodies.len();
    }
    let mut found = Vec::new();
    for pair in pairs {
        let [a, b] = pair.map(|link| bodies[names[link]].clone());
        found.extend(a.flat_map(|a| b.clone().map(move |b| [a.min(b), a.max(b)])));
    }
    found.sort_unstable();
    found
}
