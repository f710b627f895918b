//! Bodies, frames, copies and joints.

use std::collections::{HashMap, HashSet};
use std::f64::consts::FRAC_PI_2;

use lin_canny::nalgebra::{Isometry3, Translation3, Unit, Vector3};

use super::element::Element;
use super::geom::{Assets, placed};
use super::settings::{Settings, check, euler};
use super::spec::{Attached, Contacts, Spec};
use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::link_tree::{FileJoint, Follows};
use crate::robot::QposJoint;
use crate::turn::{about, direction};
use crate::xml::{check_excluded, check_name};
use lin_canny_plan::{MotionKind, RobotLink};

/// Attributes of a frame.
const FRAME: [&str; 8] = [
    "name",
    "childclass",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
];
/// Attributes that a body has besides those of a frame.
const BODY: [&str; 6] = ["mocap", "gravcomp", "sleep", "simple", "fuse", "user"];

/// Elements below a body that hold neither geometry for collisions nor kinematics.
const PASSED: [&str; 4] = ["inertial", "site", "camera", "light"];

/// Elements below a body that are read, or are an error that names them.
const READ: [&str; 10] = [
    "body",
    "frame",
    "replicate",
    "geom",
    "joint",
    "freejoint",
    "attach",
    "composite",
    "flexcomp",
    "plugin",
];

/// Maximum depth of nested elements, those of attached models counted with those around them: a body
/// that attaches itself ends there.
const MOST_NESTED: usize = 128;

/// Maximum number of pairs, excluded pairs and equalities of attached models.
const MOST_RULES: usize = 1_000_000;

/// Maximum number of elements that copies make, with those that are passed over.
const MOST_COPIES: usize = 20_000;

/// A geom that collides.
pub(super) struct Geom {
    pub(super) name: Option<String>,
    /// The link of the body, and the index of the geom among the bodies of the link.
    pub(super) link: usize,
    pub(super) body: usize,
    /// The bits `contype` and `conaffinity`.
    pub(super) kind: i32,
    pub(super) with: i32,
}

/// The tree of bodies. Each body is a link; a body with several joints has links between them.
pub(super) struct Model<'e> {
    pub(super) links: Vec<RobotLink>,
    pub(super) joints: Vec<FileJoint>,
    pub(super) geoms: Vec<Geom>,
    /// The link of each body.
    pub(super) bodies: HashMap<String, usize>,
    /// For each link, the group of links that no joint moves relative to each other. The world is
    /// in group 0.
    pub(super) groups: Vec<usize>,
    /// For each group, the group that it moves relative to.
    pub(super) groups_above: Vec<Option<usize>>,
    /// The names of free joints, with the poses at which the file draws their bodies.
    pub(super) free: Vec<(String, Isometry3<f64>)>,
    /// For each mocap body its group and the joint that moves it.
    pub(super) mocap: HashMap<usize, usize>,
    pub(super) qpos: Vec<QposJoint>,
    pub(super) skipped: Vec<Skipped>,
    /// The files, and the parts of them that are in the model.
    specs: &'e [Spec<'e>],
    attached: Vec<Attached>,
    /// The assets of each file.
    assets: Vec<Assets<'e>>,
    /// All names in the files.
    stated: HashSet<&'e str>,
    /// Names of joints and geoms, with the kind.
    names: HashSet<(&'static str, String)>,
    body_count: usize,
    joint_count: usize,
    copy_count: usize,
    rule_count: usize,
}

/// The parent of an element.
#[derive(Clone, Copy)]
struct Scope<'s> {
    /// The link of the body around the element.
    link: usize,
    /// The pose of the frame around the element, in the frame of the body.
    frame: Isometry3<f64>,
    /// The class of elements that name none.
    class: &'s str,
    /// The number of the file.
    spec: usize,
    /// What attached models put before names, and copies append to names.
    prefix: &'s str,
    suffix: &'s str,
    /// How many elements are around the element.
    depth: usize,
}

impl Scope<'_> {
    fn name(&self, name: &str) -> String {
        format!("{}{name}{}", self.prefix, self.suffix)
    }
}

impl<'e> Model<'e> {
    pub(super) fn new(specs: &'e [Spec<'e>]) -> Result<Self, FileError> {
        let world = RobotLink {
            name: "world".into(),
            bodies: Vec::new(),
        };
        let assets = specs.iter().map(|spec| Assets::new(&spec.assets, &spec.classes));
        Ok(Self {
            links: vec![world],
            joints: Vec::new(),
            geoms: Vec::new(),
            bodies: HashMap::from([("world".into(), 0)]),
            groups: vec![0],
            groups_above: vec![None],
            free: Vec::new(),
            mocap: HashMap::new(),
            qpos: Vec::new(),
            skipped: Vec::new(),
            specs,
            attached: Vec::new(),
            assets: assets.collect::<Result<_, _>>()?,
            stated: specs.iter().flat_map(Spec::names).collect(),
            names: HashSet::new(),
            body_count: 0,
            joint_count: 0,
            copy_count: 0,
            rule_count: 0,
        })
    }

    /// Adds the worlds of the main file, and what they attach, and lets joints follow others.
    pub(super) fn read(&mut self) -> Result<(), FileError> {
        let scope = Scope {
            link: 0,
            frame: Isometry3::identity(),
            class: "main",
            spec: 0,
            prefix: "",
            suffix: "",
            depth: 0,
        };
        self.attached.push(Attached::default());
        self.all_of(scope)?;
        self.rest();
        let names = self.joints.iter().enumerate();
        let numbers: HashMap<String, usize> = names.map(|(k, joint)| (joint.name.clone(), k)).collect();
        let known = ["joint", "connect", "weld", "tendon", "flex", "flexvert", "flexstrain"];
        for attached in self.attached.clone() {
            for section in &self.specs[attached.spec].equalities {
                for element in section.below(&known, &[])? {
                    self.equality(element, &attached, &numbers)?;
                }
            }
        }
        Ok(())
    }

    /// Returns the elements of the sections `contact`, with what is added to the names in them.
    pub(super) fn contacts<'m>(
        &'m self,
        which: impl Fn(&'m Contacts<'e>) -> &'m [&'e Element],
    ) -> impl Iterator<Item = (&'m Attached, &'e Element)> {
        let parts = self.attached.iter();
        parts.flat_map(move |part| {
            let elements = which(&self.specs[part.spec].contacts).iter();
            elements.map(move |element| (part, *element))
        })
    }

    /// Adds all that the sections `worldbody` of a file hold.
    fn all_of(&mut self, scope: Scope) -> Result<(), FileError> {
        for section in &self.specs[scope.spec].worlds {
            self.below(section, scope)?;
        }
        Ok(())
    }

    /// Lists a part that an element attaches: the rules of its file hold for it, too.
    fn add_part(&mut self, element: &Element, scope: &Scope) -> Result<(), FileError> {
        self.rule_count += self.specs[scope.spec].rules();
        if self.rule_count > MOST_RULES {
            let why = format!("attached models have too many pairs and equalities (expected at most {MOST_RULES})");
            return Err(element.error(FileErrorKind::Malformed(why)));
        }
        self.attached.push(Attached {
            spec: scope.spec,
            prefix: scope.prefix.into(),
            suffix: scope.suffix.into(),
        });
        Ok(())
    }

    /// Adds a body, a frame or the whole world of another model, or of this one.
    fn attach(&mut self, element: &'e Element, scope: Scope) -> Result<(), FileError> {
        element.check_attributes(&["model", "body", "frame", "prefix"])?;
        let wrong = |why: String| element.error(FileErrorKind::Malformed(why));
        let models = self.specs[scope.spec].models;
        let spec = match element.get("model") {
            None => scope.spec,
            Some(name) => *models.get(name).ok_or_else(|| {
                element.error(FileErrorKind::Unknown {
                    kind: "model",
                    name: name.into(),
                    near: lin_canny_plan::nearest_name(name, models.keys().map(String::as_str)),
                })
            })?,
        };
        let prefix = format!("{}{}", scope.prefix, element.needed("prefix")?);
        check_name(&prefix).map_err(|reason| element.error(reason))?;
        let scope = Scope {
            spec,
            class: "main",
            prefix: &prefix,
            ..scope
        };
        let (kind, name) = match (element.get("body"), element.get("frame")) {
            (None, None) if element.get("model").is_some() => {
                self.add_part(element, &scope)?;
                return self.all_of(scope);
            }
            (Some(name), None) => ("body", name),
            (None, Some(name)) => ("frame", name),
            _ => {
                return Err(wrong(
                    "attach names both a body and a frame, or nothing (expected model, body or frame)".into(),
                ));
            }
        };
        let found = self.specs[spec].parts.get(&(kind, name)).copied();
        let (part, class) = found.ok_or_else(|| {
            element.error(FileErrorKind::Unknown {
                kind: if kind == "body" { "body" } else { "frame" },
                name: name.into(),
                near: None,
            })
        })?;
        self.add_part(element, &scope)?;
        let scope = Scope { class, ..scope };
        if kind == "body" {
            return self.body(part, scope);
        }
        match part.children.iter().find(|child| child.name.ends_with("joint")) {
            Some(joint) => Err(joint.unsupported("a joint of an attached frame")),
            None => self.framed(part, scope),
        }
    }

    /// Adds all below a frame.
    fn framed(&mut self, element: &'e Element, scope: Scope) -> Result<(), FileError> {
        element.check_attributes(&FRAME)?;
        let spec = &self.specs[scope.spec];
        let pose = Settings::own(element).pose(&spec.source.compiler)?;
        let scope = Scope {
            frame: placed(&element.place, &scope.frame, &pose)?,
            class: spec.classes.below(element, scope.class)?,
            ..scope
        };
        self.below(element, scope)
    }

    /// Holds the mocap bodies of which nothing collides, neither they nor bodies below them.
    fn rest(&mut self) {
        let mut collides: Vec<bool> = self.links.iter().map(|link| !link.bodies.is_empty()).collect();
        for joint in self.joints.iter().rev() {
            collides[joint.parent] |= collides[joint.child];
        }
        for &joint in self.mocap.values() {
            let joint = &mut self.joints[joint];
            if !collides[joint.child] {
                joint.kind = MotionKind::Fixed;
                let drawn = self.free.iter().position(|(name, _)| *name == joint.name);
                joint.origin = drawn.map(|k| self.free.swap_remove(k).1).unwrap_or(joint.origin);
            }
        }
    }

    fn below(&mut self, parent: &'e Element, scope: Scope) -> Result<(), FileError> {
        let scope = Scope {
            depth: scope.depth + 1,
            ..scope
        };
        if scope.depth > MOST_NESTED {
            let why = format!("attached elements are nested too deep (expected at most {MOST_NESTED})");
            return Err(parent.error(FileErrorKind::Malformed(why)));
        }
        if scope.spec > 0 || !scope.prefix.is_empty() || !scope.suffix.is_empty() {
            self.copy_count += 1 + parent.children.len();
            if self.copy_count > MOST_COPIES {
                let why = format!("copies make too many elements (expected at most {MOST_COPIES})");
                return Err(parent.error(FileErrorKind::Malformed(why)));
            }
        }
        for element in parent.below(&READ, &PASSED)? {
            match element.name.as_str() {
                "body" => self.body(element, scope)?,
                "frame" => self.framed(element, scope)?,
                "attach" => self.attach(element, scope)?,
                "replicate" => self.copies(element, scope)?,
                "geom" => self.geom(element, scope)?,
                // The joints of a body are read with the body.
                "joint" | "freejoint" if scope.link > 0 => {}
                "joint" | "freejoint" => {
                    let why = "joint of the world (expected a body around it)";
                    return Err(element.error(FileErrorKind::Malformed(why.into())));
                }
                name => return Err(element.unsupported(format!("the element {name}"))),
            }
        }
        Ok(())
    }

    /// Returns the name of an element without a name, which no element of the files has.
    fn given(&self, mut name: String) -> String {
        while self.stated.contains(name.as_str()) {
            name.push('_');
        }
        name
    }

    /// Adds the copies of an element `replicate`: each is moved relative to the one before.
    fn copies(&mut self, element: &'e Element, scope: Scope) -> Result<(), FileError> {
        element.check_attributes(&["count", "sep", "offset", "euler", "childclass"])?;
        let class = self.specs[scope.spec].classes.below(element, scope.class)?;
        let text = element.needed("count")?;
        let why = || format!("invalid count: {text:?} (expected a whole number from 1)");
        let count: usize = (text.trim().parse().ok().filter(|n| *n > 0))
            .ok_or_else(|| element.error(FileErrorKind::Malformed(why())))?;
        let offset = Vector3::from(element.numbers::<3>("offset")?.unwrap_or_default());
        let angles = element.numbers::<3>("euler")?.unwrap_or_default();
        let step = Isometry3::from_parts(
            Translation3::from(offset),
            euler(angles, &self.specs[scope.spec].source.compiler),
        );
        let separator = element.get("sep").unwrap_or_default();
        let digits = (count - 1).to_string().len();
        let mut frame = scope.frame;
        for k in 0..count {
            let suffix = format!("{separator}{k:0digits$}{}", scope.suffix);
            let scope = Scope {
                frame,
                class,
                suffix: &suffix,
                ..scope
            };
            check_name(&suffix).map_err(|reason| element.error(reason))?;
            self.below(element, scope)?;
            frame = placed(&element.place, &frame, &step)?;
        }
        Ok(())
    }

    fn body(&mut self, element: &'e Element, scope: Scope) -> Result<(), FileError> {
        element.check_attributes(&[FRAME.as_slice(), &BODY].concat())?;
        self.body_count += 1;
        let name = match element.get("name") {
            Some(name) => scope.name(name),
            None => self.given(format!("body{}", self.body_count)),
        };
        check_name(&name).map_err(|reason| element.error(reason))?;
        let settings = Settings::own(element);
        let pose = placed(
            &element.place,
            &scope.frame,
            &settings.pose(&self.specs[scope.spec].source.compiler)?,
        )?;
        let class = self.specs[scope.spec].classes.below(element, scope.class)?;
        let mut joints = Vec::new();
        self.joints_of(
            element,
            Scope {
                class,
                frame: Isometry3::identity(),
                ..scope
            },
            &mut joints,
        )?;
        let is_mocap = match element.get("mocap").unwrap_or("false") {
            "true" => true,
            "false" => false,
            other => return Err(element.unknown_value("mocap", other, "true or false")),
        };
        if is_mocap {
            if scope.link > 0 || !joints.is_empty() {
                let why =
                    "mocap body with a joint, or below another body (expected a body of the world without joints)";
                return Err(element.error(FileErrorKind::Malformed(why.into())));
            }
            let joint = format!("{name}:mocap");
            if !self.names.insert(("joint", joint.clone())) {
                return Err(element.error(FileErrorKind::Repeated));
            }
            self.mocap.insert(self.groups_above.len(), self.joints.len());
            joints.push(BodyJoint::free(element.place.clone(), joint));
        }
        let link = self.add_joints(element, &name, scope.link, &pose, joints)?;
        if self.bodies.insert(name, link).is_some() {
            return Err(element.error(FileErrorKind::Repeated));
        }
        let scope = Scope {
            link,
            frame: Isometry3::identity(),
            class,
            ..scope
        };
        self.below(element, scope)
    }

    /// Collects the joints of a body, with those in its frames and copies.
    fn joints_of(&mut self, parent: &'e Element, scope: Scope, joints: &mut Vec<BodyJoint>) -> Result<(), FileError> {
        for element in &parent.children {
            match element.name.as_str() {
                "joint" | "freejoint" => {
                    let joint = self.joint(element, scope)?;
                    joints.push(joint);
                }
                "frame" => {
                    let pose = Settings::own(element).pose(&self.specs[scope.spec].source.compiler)?;
                    let scope = Scope {
                        frame: placed(&element.place, &scope.frame, &pose)?,
                        class: self.specs[scope.spec].classes.below(element, scope.class)?,
                        ..scope
                    };
                    self.joints_of(element, scope, joints)?;
                }
                "replicate" => {
                    let has_joint = element.children.iter().find(|child| child.name.ends_with("joint"));
                    if let Some(joint) = has_joint {
                        return Err(joint.unsupported("a copied joint of one body"));
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn joint(&mut self, element: &'e Element, scope: Scope) -> Result<BodyJoint, FileError> {
        self.joint_count += 1;
        let name = match element.get("name") {
            Some(name) => scope.name(name),
            None => self.given(format!("joint{}", self.joint_count - 1)),
        };
        check_name(&name).map_err(|reason| element.error(reason))?;
        if !self.names.insert(("joint", name.clone())) {
            return Err(element.error(FileErrorKind::Repeated));
        }
        if element.name == "freejoint" {
            element.check_attributes(&["name", "group", "align"])?;
            return Ok(BodyJoint::free(element.place.clone(), name));
        }
        check(element)?;
        let settings = self.specs[scope.spec].classes.of(element, "joint", scope.class)?;
        let limited = settings.get("limited").unwrap_or("auto");
        if !["true", "false", "auto"].contains(&limited) {
            return Err(element.unknown_value("limited", limited, "true, false or auto"));
        }
        let wrong = |reason| element.error(reason);
        let kind = match settings.get("type").unwrap_or("hinge") {
            "hinge" => MotionKind::Revolute,
            "slide" => MotionKind::Prismatic,
            "ball" => MotionKind::Ball,
            // MuJoCo passes over all else that the joint and its class say.
            "free" => return Ok(BodyJoint::free(element.place.clone(), name)),
            kind => return Err(element.unsupported(format!("a joint of type {kind:?}"))),
        };
        let unit = match kind {
            MotionKind::Prismatic => 1.0,
            _ => self.specs[scope.spec].source.compiler.angle,
        };
        let is_ball = kind == MotionKind::Ball;
        let axis = settings
            .numbers("axis")?
            .filter(|_| !is_ball)
            .unwrap_or([0.0, 0.0, 1.0]);
        let axis = direction(axis).ok_or_else(|| {
            let field = "length of the axis".into();
            wrong(FileErrorKind::Range { field, value: 0.0 })
        })?;
        let place = Vector3::from(settings.numbers::<3>("pos")?.unwrap_or_default());
        let anchor = scope.frame * lin_canny::nalgebra::Point3::from(place);
        let reference = settings.numbers("ref")?.filter(|_| !is_ball).map_or(0.0, |[x]| x) * unit;
        let open = [f64::NEG_INFINITY, f64::INFINITY];
        // Without a range, that of a ball joint is an angle of 0.
        let range = settings.numbers::<2>("range")?.or(is_ball.then_some([0.0; 2]));
        let limits = match (limited, range) {
            ("true", None) => return Err(wrong(FileErrorKind::Missing("attribute range".into()))),
            ("true", Some([lower, upper])) if lower >= upper && !is_ball => {
                let why = format!(
                    "invalid range of a limited joint: {lower} to {upper} (expected the first below the second)"
                );
                return Err(wrong(FileErrorKind::Malformed(why)));
            }
            ("auto", Some(range))
                if range != [0.0; 2] && !self.specs[scope.spec].source.compiler.has_automatic_limits =>
            {
                return Err(wrong(FileErrorKind::Missing("attribute limited".into())));
            }
            // Without a word of the file, a range limits the joint if it is one.
            ("true" | "auto", Some([lower, upper])) if lower < upper || limited == "true" => match is_ball {
                false => [lower * unit, upper * unit],
                true if lower != 0.0 => {
                    let why = format!("invalid range of a ball joint: {lower} to {upper} (expected 0 to an angle)");
                    return Err(wrong(FileErrorKind::Malformed(why)));
                }
                true => angles_within(upper * unit),
            },
            _ => open,
        };
        let limits = if self.specs[scope.spec].source.flags.has("limit") {
            limits
        } else {
            open
        };
        Ok(BodyJoint {
            place: element.place.clone(),
            name,
            kind,
            axis: scope.frame.rotation * axis,
            anchor: anchor.coords,
            limits,
            reference,
        })
    }

    /// Adds the link of a body below its joints, and returns it.
    fn add_joints(
        &mut self,
        body: &Element,
        name: &str,
        parent: usize,
        pose: &Isometry3<f64>,
        joints: Vec<BodyJoint>,
    ) -> Result<usize, FileError> {
        let group = match joints.first() {
            None => self.groups[parent],
            Some(_) => {
                self.groups_above.push(Some(self.groups[parent]));
                self.groups_above.len() - 1
            }
        };
        let turns = |joint: &BodyJoint| matches!(joint.kind, MotionKind::Ball | MotionKind::Revolute);
        let ball = joints.iter().position(|joint| joint.kind == MotionKind::Ball);
        if let Some(joint) = ball.and_then(|ball| joints[ball + 1..].iter().find(|joint| turns(joint))) {
            let why = "hinge or ball joint after a ball joint of the same body (expected the ball joint after it)";
            return Err(joint.place.error(FileErrorKind::Malformed(why.into())));
        }
        let is_free = |joint: &BodyJoint| joint.kind == MotionKind::Floating;
        if let Some(joint) = joints.iter().find(|joint| is_free(joint)) {
            let why = "free joint of a body below another body, or with another joint (expected it alone)";
            if joints.len() > 1 || parent > 0 {
                return Err(joint.place.error(FileErrorKind::Malformed(why.into())));
            }
        }
        let mut before = parent;
        let mut origin = *pose;
        let add = |model: &mut Self, link: String, joint: FileJoint| {
            model.links.push(RobotLink {
                name: link,
                bodies: Vec::new(),
            });
            model.groups.push(group);
            model.joints.push(joint);
        };
        let count = joints.len();
        for (k, joint) in joints.into_iter().enumerate() {
            let child = self.links.len();
            let at = Translation3::from(joint.anchor);
            let is_last = k + 1 == count && joint.anchor == Vector3::zeros();
            let link = if is_last {
                name.to_owned()
            } else {
                format!("{name}:{}", joint.name)
            };
            let is_free = is_free(&joint);
            // A mocap body has no values in `qpos`.
            if !self.mocap.values().any(|&joint| joint == self.joints.len()) {
                let (name, rest) = (joint.name.clone(), joint.reference);
                self.qpos.push(QposJoint { name, rest });
            }
            if is_free {
                self.free.push((joint.name.clone(), *pose));
            }
            let joint = FileJoint {
                place: joint.place,
                name: joint.name,
                kind: joint.kind,
                parent: before,
                child,
                origin: if is_free { Isometry3::identity() } else { origin * at },
                axis: joint.axis,
                limits: joint.limits,
                velocity: None,
                reference: joint.reference,
                follows: None,
            };
            add(self, link, joint);
            if is_last {
                return Ok(child);
            }
            origin = Isometry3::from_parts(at.inverse(), lin_canny::nalgebra::UnitQuaternion::identity());
            before = child;
        }
        let child = self.links.len();
        let weld = FileJoint {
            place: body.place.clone(),
            name: format!("{name}:weld"),
            kind: MotionKind::Fixed,
            parent: before,
            child,
            origin,
            axis: Vector3::z_axis(),
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            velocity: None,
            reference: 0.0,
            follows: None,
        };
        add(self, name.to_owned(), weld);
        Ok(child)
    }

    fn geom(&mut self, element: &'e Element, scope: Scope) -> Result<(), FileError> {
        check(element)?;
        if let Some(plugin) = element.children.first() {
            return Err(plugin.unsupported("a geom of a plugin"));
        }
        let settings = self.specs[scope.spec].classes.of(element, "geom", scope.class)?;
        let name = element.get("name").map(|name| scope.name(name));
        check_name(name.as_deref().unwrap_or_default()).map_err(|reason| element.error(reason))?;
        if name
            .as_ref()
            .is_some_and(|name| !self.names.insert(("geom", name.clone())))
        {
            return Err(element.error(FileErrorKind::Repeated));
        }
        let kind = settings.whole_number("contype", 1)?;
        let with = settings.whole_number("conaffinity", 1)?;
        let own = element.get("name").map(|name| format!("{name}{}", scope.suffix));
        let is_paired = own.is_some_and(|own| self.specs[scope.spec].paired.contains(own.as_str()));
        if kind == 0 && with == 0 && !is_paired {
            return Ok(());
        }
        check_excluded(self.geoms.len() + 1, 0).map_err(|reason| element.error(reason))?;
        let link = &mut self.links[scope.link];
        let body = self.assets[scope.spec].geom(&settings, &link.name, &self.specs[scope.spec].source);
        let mut body = match body {
            Ok(body) => body,
            Err(error) => match error.reason {
                FileErrorKind::MissingMesh(_) if self.specs[scope.spec].source.options.skip_missing_meshes => {
                    self.skipped.push(error.into());
                    return Ok(());
                }
                _ => return Err(error),
            },
        };
        body.origin = placed(&element.place, &scope.frame, &body.origin)?;
        self.geoms.push(Geom {
            name,
            link: scope.link,
            body: link.bodies.len(),
            kind,
            with,
        });
        link.bodies.push(body);
        Ok(())
    }

    /// Lets a joint follow another one, or holds it, as an element `equality/joint` says. Lists
    /// other equalities that are in force. `numbers` has the number of each joint.
    fn equality(
        &mut self,
        element: &'e Element,
        attached: &Attached,
        numbers: &HashMap<String, usize>,
    ) -> Result<(), FileError> {
        let known = [
            "name", "class", "active", "solref", "solimp", "joint1", "joint2", "polycoef",
        ];
        let is_of_joints = element.name == "joint";
        if is_of_joints {
            element.check_attributes(&known)?;
        }
        let settings = self.specs[attached.spec].classes.of(element, "equality", "main")?;
        match settings.get("active").unwrap_or("true") {
            "true" if self.specs[0].source.flags.has("equality") => {}
            "true" | "false" => return Ok(()),
            other => return Err(element.unknown_value("active", other, "true or false")),
        }
        if !is_of_joints {
            let what = format!("the equality {}", element.name);
            self.skipped.push(Skipped::from(element.unsupported(what)));
            return Ok(());
        }
        let find = |name: &str| {
            let name = attached.name(name);
            match numbers.get(&name) {
                None if attached.is_whole() => {
                    let names = self.joints.iter().map(|joint| joint.name.as_str());
                    Err(element.error(FileErrorKind::Unknown {
                        kind: "joint",
                        near: lin_canny_plan::nearest_name(&name, names),
                        name,
                    }))
                }
                joint => Ok(joint.copied()),
            }
        };
        let (Some(follower), leader) = (
            find(element.needed("joint1")?)?,
            element.get("joint2").map(find).transpose()?,
        ) else {
            return Ok(());
        };
        let leader = match leader {
            Some(None) => return Ok(()),
            leader => leader.flatten(),
        };
        let mut factors = settings.up_to("polycoef", 5)?;
        if factors.is_empty() {
            factors = vec![0.0, 1.0];
        }
        factors.resize(5, 0.0);
        let has_value = |k: usize| matches!(self.joints[k].kind, MotionKind::Revolute | MotionKind::Prismatic);
        if !has_value(follower) || leader.is_some_and(|k| !has_value(k)) || self.joints[follower].follows.is_some() {
            return Err(element.unsupported("equality of a joint that is free, a ball, held or follows another one"));
        }
        match leader {
            Some(_) if factors[2..].iter().any(|x| *x != 0.0) => {
                Err(element.unsupported("polycoef of a degree above 1"))
            }
            Some(leader) => {
                let (joint, reference) = (self.joints[leader].name.clone(), self.joints[leader].reference);
                let follower = &mut self.joints[follower];
                follower.follows = Some(Follows {
                    joint,
                    factor: factors[1],
                    offset: factors[0] + follower.reference - factors[1] * reference,
                });
                Ok(())
            }
            None => {
                let joint = &mut self.joints[follower];
                if let Some(at) = self.qpos.iter_mut().find(|at| at.name == joint.name) {
                    at.rest += factors[0];
                }
                joint.origin *= match joint.kind {
                    MotionKind::Prismatic => Isometry3::from(Translation3::from(joint.axis.into_inner() * factors[0])),
                    _ => Isometry3::from_parts(Translation3::identity(), about(&joint.axis, factors[0])),
                };
                joint.kind = MotionKind::Fixed;
                Ok(())
            }
        }
    }
}

/// A joint of a body, in the frame of the body.
struct BodyJoint {
    place: Place,
    name: String,
    kind: MotionKind,
    axis: Unit<Vector3<f64>>,
    anchor: Vector3<f64>,
    limits: [f64; 2],
    reference: f64,
}

impl BodyJoint {
    fn free(place: Place, name: String) -> Self {
        Self {
            place,
            name,
            kind: MotionKind::Floating,
            axis: Vector3::z_axis(),
            anchor: Vector3::zeros(),
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            reference: 0.0,
        }
    }
}

/// Returns limits of roll, pitch and yaw that contain all rotations by at most an angle.
///
/// Below a quarter turn, none of the three is larger than the angle of the rotation: x and z turn by
/// at most that angle, and yaw, pitch and roll are angles of their projections. MuJoCo takes a
/// negative angle as 0.
fn angles_within(angle: f64) -> [f64; 2] {
    let angle = if angle < 0.0 { 0.0 } else { angle };
    if angle < FRAC_PI_2 {
        [-angle, angle]
    } else {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
}
