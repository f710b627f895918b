//! Reads the elements of worlds, models, links and joints.

use std::collections::HashSet;
use std::f64::consts::TAU;
use std::path::PathBuf;

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use roxmltree::Node;

use super::frames::{Attachment, Frame, Frames, Reference, Scope, Target, WORLD};
use super::shape;
use super::values::SdfFile;
use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::turn::direction;
use crate::xml::{EXTENT_MAX, attribute, check_name};
use lin_canny_plan::{LinkBody, MotionKind};

/// Maximum depth of nested models, included ones counted.
const DEPTH: usize = 64;

/// A limit of this size and beyond is no limit.
const NO_LIMIT: f64 = 1e16;

/// The masks of a collision element that states none.
pub(super) const ALL_BITS: u32 = 0xffff;

/// Elements of a world that are no part of a rigid body.
const WORLD_PASSED: [&str; 13] = [
    "atmosphere",
    "audio",
    "gravity",
    "gui",
    "light",
    "magnetic_field",
    "particle_emitter",
    "physics",
    "plugin",
    "projector",
    "scene",
    "spherical_coordinates",
    "wind",
];

const MODEL_PASSED: [&str; 5] = ["allow_auto_disable", "enable_wind", "gripper", "plugin", "self_collide"];

const LINK_PASSED: [&str; 18] = [
    "audio_sink",
    "audio_source",
    "battery",
    "enable_wind",
    "frame",
    "gravity",
    "inertial",
    "kinematic",
    "light",
    "must_be_base_link",
    "particle_emitter",
    "plugin",
    "projector",
    "self_collide",
    "sensor",
    "velocity_decay",
    "visual",
    "wind",
];

const COLLISION_PASSED: [&str; 6] = [
    "auto_inertia_params",
    "density",
    "frame",
    "laser_retro",
    "material_density",
    "max_contacts",
];

const SURFACE_PASSED: [&str; 3] = ["bounce", "friction", "soft_contact"];

const CONTACT_PASSED: [&str; 7] = [
    "bullet",
    "collide_without_contact",
    "collide_without_contact_bitmask",
    "elastic_modulus",
    "ode",
    "poissons_ratio",
    "torsional",
];

const JOINT_READ: [&str; 7] = [
    "parent",
    "child",
    "pose",
    "axis",
    "axis2",
    "screw_thread_pitch",
    "thread_pitch",
];

const JOINT_PASSED: [&str; 6] = [
    "frame",
    "gearbox_ratio",
    "gearbox_reference_body",
    "physics",
    "plugin",
    "sensor",
];

/// A link of a file. Its name has the names of its models before it.
pub(super) struct Link {
    pub(super) place: Place,
    pub(super) name: String,
    pub(super) frame: usize,
    pub(super) is_static: bool,
    pub(super) bodies: Vec<Body>,
}

/// A collision element of a link.
pub(super) struct Body {
    pub(super) relative_to: Target,
    /// The body, with its pose in that frame.
    pub(super) body: LinkBody,
    /// The bits of `category_bitmask` and `collide_bitmask`.
    pub(super) masks: [u32; 2],
}

/// A joint of a file.
pub(super) struct Joint {
    pub(super) place: Place,
    pub(super) name: String,
    pub(super) frame: usize,
    pub(super) kind: MotionKind,
    pub(super) parent: Target,
    pub(super) child: Target,
    /// The axis; two of a universal joint, and none of a fixed or ball joint.
    pub(super) axes: Vec<Axis>,
    /// How far a screw joint slides in a turn.
    pub(super) thread: Option<f64>,
}

/// An axis of a joint.
pub(super) struct Axis {
    pub(super) direction: Unit<Vector3<f64>>,
    /// The frame in which the direction is expressed.
    pub(super) frame: Target,
    pub(super) limits: [f64; 2],
    pub(super) mimic: Option<Mimic>,
}

impl Joint {
    /// Returns the name of the coordinate of an axis.
    pub(super) fn coordinate(&self, axis: usize) -> String {
        match (self.axes.len(), axis) {
            (0 | 1, _) => self.name.clone(),
            (_, 0) => format!("{}/axis", self.name),
            _ => format!("{}/axis2", self.name),
        }
    }
}

/// Makes the value of a joint `multiplier * (leader - reference) + offset`.
pub(super) struct Mimic {
    pub(super) leader: Reference,
    /// Which axis of the leader.
    pub(super) axis: usize,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
    pub(super) reference: f64,
}

/// What a file describes, with the files that it includes.
pub(super) struct Description<'o> {
    pub(super) frames: Frames,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    pub(super) skipped: Vec<Skipped>,
    pub(super) packages: &'o Packages,
    pub(super) options: &'o LoadOptions,
    /// The files that are being read, each included by the one before.
    pub(super) open_files: Vec<PathBuf>,
    /// How many files were included in all, and how many bytes they have.
    pub(super) included: [usize; 2],
}

/// The parent of elements: the world, or a model.
#[derive(Clone)]
pub(super) struct Owner {
    pub(super) scope: usize,
    /// The frame of the model.
    pub(super) frame: usize,
    /// The prefix of names.
    pub(super) prefix: String,
    pub(super) is_static: bool,
    pub(super) depth: usize,
}

/// What an element `include` states instead of the model that it includes.
#[derive(Default)]
pub(super) struct Override {
    pub(super) name: Option<String>,
    /// The pose, and the frame that it is relative to.
    pub(super) pose: Option<(Option<Target>, Isometry3<f64>)>,
    pub(super) is_static: Option<bool>,
    pub(super) placement: Option<(Place, String)>,
    /// Whether the elements of the model belong to the model that includes it.
    pub(super) is_merged: bool,
    /// Whether names of links and joints start without the name of the model.
    pub(super) hides_name: bool,
}

impl Owner {
    pub(super) fn world() -> Self {
        Self {
            scope: WORLD,
            frame: WORLD,
            prefix: String::new(),
            is_static: false,
            depth: 0,
        }
    }

    /// The scope, and the frame that `__model__` names.
    fn names(&self) -> [usize; 2] {
        [self.scope, self.frame]
    }
}

impl<'o> Description<'o> {
    pub(super) fn new(root: Place, packages: &'o Packages, options: &'o LoadOptions) -> Self {
        Self {
            open_files: vec![root.file.to_path_buf()],
            frames: Frames::new(root),
            links: Vec::new(),
            joints: Vec::new(),
            skipped: Vec::new(),
            packages,
            options,
            included: [0; 2],
        }
    }

    pub(super) fn world(&mut self, file: &SdfFile, world: Node) -> Result<(), FileError> {
        const READ: [&str; 8] = [
            "model",
            "include",
            "frame",
            "joint",
            "actor",
            "road",
            "population",
            "state",
        ];
        file.xml.check_attributes(world, &["name"], false)?;
        let parts = file.xml.below(world, &READ, &WORLD_PASSED)?;
        self.contents(file, &parts, &Owner::world()).map(drop)
    }

    /// Lists an element that is left out by rule.
    pub(super) fn skip(&mut self, file: &SdfFile, node: &Node) {
        let what = format!("element {}", node.tag_name().name());
        let reason = FileErrorKind::Unsupported(what);
        self.skipped.push(file.xml.error(node, reason).into());
    }

    /// Reads the elements of a world or model. Returns what carries its frame: its first link, or
    /// else the frame of its first model.
    fn contents(&mut self, file: &SdfFile, parts: &[Node], owner: &Owner) -> Result<Attachment, FileError> {
        let (mut first_link, mut first_model) = (None, None);
        for &node in parts {
            match node.tag_name().name() {
                "link" => {
                    let link = self.link(file, node, owner)?;
                    first_link = first_link.or(Some(Attachment::Link(link)));
                }
                "model" => {
                    let model = self.model(file, node, owner, Override::default())?;
                    first_model = first_model.or(Some(Attachment::To(Target::Frame(model))));
                }
                "include" => {
                    let model = self.include(file, node, owner)?;
                    let model = model.map(|frame| Attachment::To(Target::Frame(frame)));
                    first_model = first_model.or(model);
                }
                "frame" => self.frame(file, node, owner)?,
                "joint" => self.joint(file, node, owner)?,
                "actor" | "road" | "population" | "state" => self.skip(file, &node),
                _ => {}
            }
        }
        Ok(first_link.or(first_model).unwrap_or(Attachment::Nothing))
    }

    /// Reads a model, and returns its frame.
    pub(super) fn model(
        &mut self,
        file: &SdfFile,
        model: Node,
        outer: &Owner,
        instead: Override,
    ) -> Result<usize, FileError> {
        const READ: [&str; 7] = ["static", "pose", "link", "joint", "frame", "model", "include"];
        let xml = file.xml;
        xml.check_attributes(model, &["name", "canonical_link", "placement_frame"], false)?;
        let parts = xml.below(model, &READ, &MODEL_PASSED)?;
        if outer.depth >= DEPTH {
            let what = format!("models are nested too deep (expected at most {DEPTH})");
            return Err(xml.error(&model, FileErrorKind::Malformed(what)));
        }
        let own_name = xml.needed(&model, "name")?.to_owned();
        let name = instead.name.unwrap_or(own_name);
        let is_static = file.flag(&parts, "static")?.unwrap_or(false);
        let is_static = outer.is_static || instead.is_static.unwrap_or(is_static);
        if instead.is_merged && is_static != outer.is_static {
            let what = "a merged model that is static".into();
            return Err(xml.error(&model, FileErrorKind::Unsupported(what)));
        }
        let own_pose = file.pose(&parts, outer.names())?;
        let (base, pose) = instead.pose.unwrap_or(own_pose);
        let frame = self.frames.add(Frame {
            place: xml.place(&model),
            name: format!("{}{name}", outer.prefix),
            relative_to: base.unwrap_or(Target::Frame(outer.frame)),
            pose,
            placement: None,
            attached_to: Attachment::World,
        });
        let mut owner = Owner {
            frame,
            is_static,
            depth: outer.depth + 1,
            ..outer.clone()
        };
        if !instead.is_merged {
            self.name(file, &model, &name, frame, outer)?;
            owner.scope = self.frames.scopes.len();
            if !instead.hides_name {
                owner.prefix = format!("{}{name}::", outer.prefix);
            }
            self.frames.scopes[outer.scope].models.insert(name, owner.scope);
            let mut names = Scope::default();
            names.frames.insert("__model__".into(), frame);
            self.frames.scopes.push(names);
        }
        let named = |field, since| file.frame_attribute(&model, field, since, owner.names());
        let placement = match instead.placement {
            Some((place, name)) => Some(Reference {
                place,
                scope: owner.scope,
                model: frame,
                name,
            }),
            None => named("placement_frame", [1, 8])?.and_then(Target::reference),
        };
        let canonical_link = named("canonical_link", [1, 7])?;
        let first = self.contents(file, &parts, &owner)?;
        self.frames.frames[frame].placement = placement;
        self.frames.frames[frame].attached_to = match canonical_link {
            _ if is_static => Attachment::World,
            Some(link) => Attachment::To(link),
            None => first,
        };
        Ok(frame)
    }

    /// Gives a frame a name in a scope.
    fn name(&mut self, file: &SdfFile, node: &Node, name: &str, frame: usize, owner: &Owner) -> Result<(), FileError> {
        let is_reserved = name == "world" || (name.starts_with("__") && name.ends_with("__"));
        let is_scoped = name.contains("::") && file.version >= [1, 8];
        if name.trim().is_empty() || is_reserved || is_scoped {
            let what = format!("invalid name: {name:?} (expected no name in __, no :: and not world)");
            return Err(file.xml.error(node, FileErrorKind::Malformed(what)));
        }
        check_name(&format!("{}{name}", owner.prefix)).map_err(|reason| file.xml.error(node, reason))?;
        let names = &mut self.frames.scopes[owner.scope].frames;
        let is_joint = node.tag_name().name() == "joint";
        let Some(&other) = names.get(name) else {
            names.insert(name.into(), frame);
            return Ok(());
        };
        // Before version 1.7, joints were no frames, so that a link and a joint could share a name.
        let other_is_joint = self.joints.iter().any(|joint| joint.frame == other);
        if file.version >= [1, 7] || is_joint == other_is_joint {
            return Err(file.xml.error(node, FileErrorKind::Repeated));
        }
        if !is_joint {
            names.insert(name.into(), frame);
        }
        Ok(())
    }

    fn frame(&mut self, file: &SdfFile, node: Node, owner: &Owner) -> Result<(), FileError> {
        let xml = file.xml;
        xml.check_attributes(node, &["name", "attached_to"], false)?;
        let parts = xml.below(node, &["pose"], &[])?;
        let name = xml.needed(&node, "name")?;
        let to = file.frame_attribute(&node, "attached_to", [1, 7], owner.names())?;
        let to = to.unwrap_or(Target::Frame(owner.frame));
        let (base, pose) = file.pose(&parts, owner.names())?;
        let frame = self.frames.add(Frame {
            place: xml.place(&node),
            name: format!("{}{name}", owner.prefix),
            relative_to: base.unwrap_or_else(|| to.clone()),
            pose,
            placement: None,
            attached_to: Attachment::To(to),
        });
        self.name(file, &node, name, frame, owner)
    }

    fn link(&mut self, file: &SdfFile, node: Node, owner: &Owner) -> Result<usize, FileError> {
        let xml = file.xml;
        xml.check_attributes(node, &["name"], false)?;
        let parts = xml.below(node, &["pose", "collision"], &LINK_PASSED)?;
        let name = xml.needed(&node, "name")?;
        let full_name = format!("{}{name}", owner.prefix);
        let (base, pose) = file.pose(&parts, owner.names())?;
        let link = self.links.len();
        let frame = self.frames.add(Frame {
            place: xml.place(&node),
            name: full_name.clone(),
            relative_to: base.unwrap_or(Target::Frame(owner.frame)),
            pose,
            placement: None,
            attached_to: Attachment::Link(link),
        });
        self.name(file, &node, name, frame, owner)?;
        let mut bodies = Vec::new();
        for collision in parts.iter().filter(|n| n.tag_name().name() == "collision") {
            match self.collision(file, *collision, &full_name, frame, owner) {
                Ok(body) => bodies.extend(body),
                Err(error) => match error.reason {
                    FileErrorKind::MissingMesh(_) if self.options.skip_missing_meshes => {
                        self.skipped.push(error.into());
                    }
                    _ => return Err(error),
                },
            }
        }
        self.links.push(Link {
            place: xml.place(&node),
            name: full_name,
            frame,
            is_static: owner.is_static,
            bodies,
        });
        Ok(link)
    }

    fn collision(
        &self,
        file: &SdfFile,
        node: Node,
        link: &str,
        frame: usize,
        owner: &Owner,
    ) -> Result<Option<Body>, FileError> {
        let xml = file.xml;
        xml.check_attributes(node, &["name"], false)?;
        let parts = xml.below(node, &["pose", "geometry", "surface"], &COLLISION_PASSED)?;
        let (base, pose) = file.pose(&parts, owner.names())?;
        let masks = masks(file, &parts)?;
        let geometry = xml.one(&node, &parts, "geometry")?;
        let shape = shape::read(file, geometry, link, self.packages, self.options)?;
        Ok(shape.map(|shape| Body {
            relative_to: base.unwrap_or(Target::Frame(frame)),
            body: LinkBody {
                origin: pose * shape.pose,
                geometry: shape.geometry,
                mesh: shape.mesh,
                hull_fit: shape.hull_fit,
            },
            masks,
        }))
    }

    fn joint(&mut self, file: &SdfFile, node: Node, owner: &Owner) -> Result<(), FileError> {
        let xml = file.xml;
        xml.check_attributes(node, &["name", "type"], false)?;
        let parts = xml.below(node, &JOINT_READ, &JOINT_PASSED)?;
        let name = xml.needed(&node, "name")?;
        let kind_name = xml.needed(&node, "type")?;
        let kind = match kind_name {
            "revolute" | "continuous" | "universal" | "revolute2" | "screw" => MotionKind::Revolute,
            "prismatic" => MotionKind::Prismatic,
            "ball" => MotionKind::Ball,
            "fixed" => MotionKind::Fixed,
            kind => {
                let what = FileErrorKind::Unsupported(format!("a joint of type {kind:?}"));
                return Err(xml.error(&node, what));
            }
        };
        let axes: &[&str] = match kind_name {
            // Converters leave an axis in fixed and ball joints, where it has no meaning.
            "fixed" | "ball" => &[],
            "universal" | "revolute2" => &["axis", "axis2"],
            _ => &["axis"],
        };
        if let Some(second) = xml.at_most_one(&parts, "axis2")?.filter(|_| axes.len() == 1) {
            let what = format!("a second axis of a {kind_name} joint");
            return Err(xml.error(&second, FileErrorKind::Unsupported(what)));
        }
        let end = |element: &str| -> Result<Reference, FileError> {
            let node = xml.one(&node, &parts, element)?;
            Ok(Reference {
                place: xml.place(&node),
                scope: owner.scope,
                model: owner.frame,
                name: file.word(node)?,
            })
        };
        let (parent, child) = (end("parent")?, Target::Named(end("child")?));
        let parent = match parent.name.as_str() {
            "world" => Target::Frame(WORLD),
            _ => Target::Named(parent),
        };
        let (base, pose) = file.pose(&parts, owner.names())?;
        let frame = self.frames.add(Frame {
            place: xml.place(&node),
            name: format!("{}{name}", owner.prefix),
            relative_to: base.unwrap_or_else(|| child.clone()),
            pose,
            placement: None,
            attached_to: Attachment::To(child.clone()),
        });
        let axes = axes.iter().map(|axis| {
            let axis = xml.one(&node, &parts, axis)?;
            self.axis(file, axis, owner, frame)
        });
        let mut axes = axes.collect::<Result<Vec<Axis>, FileError>>()?;
        if kind_name == "continuous" {
            axes[0].limits = [f64::NEG_INFINITY, f64::INFINITY];
        }
        let thread = match kind_name {
            "screw" => Some(thread(file, &node, &parts)?),
            _ => None,
        };
        self.name(file, &node, name, frame, owner)?;
        self.joints.push(Joint {
            place: xml.place(&node),
            name: format!("{}{name}", owner.prefix),
            frame,
            kind,
            parent,
            child,
            axes,
            thread,
        });
        Ok(())
    }

    /// Returns an axis of the joint with a frame.
    fn axis(&mut self, file: &SdfFile, axis: Node, owner: &Owner, joint: usize) -> Result<Axis, FileError> {
        const READ: [&str; 5] = ["xyz", "limit", "mimic", "use_parent_model_frame", "initial_position"];
        let xml = file.xml;
        xml.check_attributes(axis, &[], false)?;
        let parts = xml.below(axis, &READ, &["dynamics"])?;
        let xyz = xml.one(&axis, &parts, "xyz")?;
        let direction = direction(file.numbers_with(xyz, &["expressed_in"])?).ok_or_else(|| {
            let field = "length of the axis".into();
            xml.error(&xyz, FileErrorKind::Range { field, value: 0.0 })
        })?;
        let stated = file.frame_attribute(&xyz, "expressed_in", [1, 7], owner.names())?;
        let of_model = xml.at_most_one(&parts, "use_parent_model_frame")?;
        if let Some(node) = of_model.filter(|_| file.version >= [1, 7]) {
            let what = "use_parent_model_frame of version 1.7 and later (expected expressed_in)".into();
            return Err(xml.error(&node, FileErrorKind::Unsupported(what)));
        }
        if let Some(node) = of_model {
            file.check_version(&node, "use_parent_model_frame", [1, 5]);
        }
        let is_of_model = file.flag(&parts, "use_parent_model_frame")?.unwrap_or(false);
        // The value has no effect in simulators.
        if let Some(node) = xml.at_most_one(&parts, "initial_position")? {
            let [position] = file.numbers(node)?;
            if position != 0.0 {
                self.skip(file, &node);
            }
        }
        let limit = xml.at_most_one(&parts, "limit")?;
        let limits = limit.map(|limit| limits(file, limit)).transpose()?;
        let mimic = xml.at_most_one(&parts, "mimic")?;
        Ok(Axis {
            direction,
            frame: match stated {
                _ if is_of_model || file.version < [1, 5] => Target::Frame(owner.frame),
                stated => stated.unwrap_or(Target::Frame(joint)),
            },
            limits: limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
            mimic: mimic.map(|mimic| mimicked(file, mimic, owner)).transpose()?,
        })
    }

    /// Returns an error if two links or two joints have the same name, with those of their models.
    pub(super) fn check_names(&self) -> Result<(), FileError> {
        let links = self.links.iter().map(|link| (&link.name, &link.place));
        let joints = self.joints.iter().map(|joint| (&joint.name, &joint.place));
        for elements in [links.collect::<Vec<_>>(), joints.collect()] {
            let mut names = HashSet::new();
            if let Some((_, place)) = elements.iter().find(|(name, _)| !names.insert(*name)) {
                return Err(place.error(FileErrorKind::Repeated));
            }
        }
        Ok(())
    }
}

impl Target {
    fn reference(self) -> Option<Reference> {
        match self {
            Self::Named(reference) => Some(reference),
            Self::Frame(_) => None,
        }
    }
}

/// Returns how far a screw joint slides in a turn: along the axis for a right-handed thread.
fn thread(file: &SdfFile, joint: &Node, parts: &[Node]) -> Result<f64, FileError> {
    let xml = file.xml;
    let node = |name: &str| xml.at_most_one(parts, name);
    let (pitch, node) = match (node("screw_thread_pitch")?, node("thread_pitch")?) {
        (Some(node), _) => (file.numbers::<1>(node)?[0], node),
        // Turns by so many radians for each metre, of a left-handed thread.
        (None, Some(node)) => (-TAU / file.numbers::<1>(node)?[0], node),
        (None, None) => (1.0, *joint),
    };
    match pitch.abs() <= EXTENT_MAX {
        true => Ok(pitch),
        false => {
            let field = "pitch of the thread".into();
            Err(xml.error(&node, FileErrorKind::Range { field, value: pitch }))
        }
    }
}

/// Returns the least and greatest value that an element `limit` allows.
fn limits(file: &SdfFile, limit: Node) -> Result<[f64; 2], FileError> {
    let xml = file.xml;
    xml.check_attributes(limit, &[], false)?;
    let motor = ["effort", "velocity", "stiffness", "dissipation"];
    let parts = xml.below(limit, &["lower", "upper"], &motor)?;
    let value = |name: &str, open: f64| -> Result<f64, FileError> {
        let node = xml.at_most_one(&parts, name)?;
        let value = node.map(|node| file.limit(node)).transpose()?.unwrap_or(open);
        let is_open = value * open.signum() >= NO_LIMIT;
        Ok(if is_open { open } else { value })
    };
    let [lower, upper] = [value("lower", f64::NEG_INFINITY)?, value("upper", f64::INFINITY)?];
    if !(lower <= upper) || lower >= NO_LIMIT || upper <= -NO_LIMIT {
        return Err(xml.error(&limit, FileErrorKind::Limits { lower, upper }));
    }
    Ok([lower, upper])
}

fn mimicked(file: &SdfFile, mimic: Node, owner: &Owner) -> Result<Mimic, FileError> {
    let xml = file.xml;
    file.check_version(&mimic, "mimic", [1, 11]);
    xml.check_attributes(mimic, &["joint", "axis"], false)?;
    let parts = xml.below(mimic, &["multiplier", "offset", "reference"], &[])?;
    let axis = match attribute(&mimic, "axis").unwrap_or("axis") {
        "axis" => 0,
        "axis2" => 1,
        other => {
            let what = format!("invalid axis of a mimic: {other:?} (expected axis or axis2)");
            return Err(xml.error(&mimic, FileErrorKind::Malformed(what)));
        }
    };
    let [multiplier] = file.needed(&mimic, &parts, "multiplier")?;
    let [offset] = file.needed(&mimic, &parts, "offset")?;
    let [reference] = file.needed(&mimic, &parts, "reference")?;
    let leader = Reference {
        place: xml.place(&mimic),
        scope: owner.scope,
        model: owner.frame,
        name: xml.needed(&mimic, "joint")?.into(),
    };
    Ok(Mimic {
        leader,
        axis,
        multiplier,
        offset,
        reference,
    })
}

/// Returns the masks of a collision element: those of its category, and those that it collides
/// with.
fn masks(file: &SdfFile, parts: &[Node]) -> Result<[u32; 2], FileError> {
    let xml = file.xml;
    let Some(surface) = xml.at_most_one(parts, "surface")? else {
        return Ok([ALL_BITS; 2]);
    };
    let parts = xml.below(surface, &["contact"], &SURFACE_PASSED)?;
    let Some(contact) = xml.at_most_one(&parts, "contact")? else {
        return Ok([ALL_BITS; 2]);
    };
    let parts = xml.below(contact, &["collide_bitmask", "category_bitmask"], &CONTACT_PASSED)?;
    let mask = |name: &str| -> Result<Option<u32>, FileError> {
        let Some(node) = xml.at_most_one(&parts, name)? else {
            return Ok(None);
        };
        let text = file.word(node)?;
        let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
        let mask = digits.map_or_else(|| text.parse().ok(), |digits| u32::from_str_radix(digits, 16).ok());
        match mask.filter(|mask| *mask <= ALL_BITS) {
            Some(mask) => Ok(Some(mask)),
            None => {
                let what = format!("invalid {name}: {text:?} (expected 0 to 65535)");
                Err(xml.error(&node, FileErrorKind::Malformed(what)))
            }
        }
    };
    let collide = mask("collide_bitmask")?.unwrap_or(ALL_BITS);
    // Without a category, a body is in the category of what it collides with.
    Ok([mask("category_bitmask")?.unwrap_or(collide), collide])
}
