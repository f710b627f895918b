//! Values of attributes: those of an element, of its class, and of the classes above; poses.

use std::collections::HashMap;

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

use super::element::{Element, exactly, numbers};
use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::turn::{about, direction, from_xyzw};
use lin_canny_plan::nearest_name as nearest;
use lin_canny_plan::turn_from_z;

/// Attributes that state an orientation. An element has one of them, and it replaces all of those
/// of its class.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Elements with values in a class.
const WITH_CLASS: [&str; 5] = ["mesh", "joint", "geom", "pair", "equality"];

/// What the sections `compiler` say; the last value of each counts for the whole file.
pub(super) struct Compiler {
    /// Radians per unit of an angle.
    pub(super) angle: f64,
    pub(super) euler_order: [char; 3],
    pub(super) has_automatic_limits: bool,
    pub(super) mesh_folder: String,
    pub(super) takes_file_names_only: bool,
}

impl Compiler {
    pub(super) fn new(sections: &[&Element]) -> Result<Self, FileError> {
        let mut compiler = Self {
            angle: std::f64::consts::PI / 180.0,
            euler_order: ['x', 'y', 'z'],
            has_automatic_limits: true,
            mesh_folder: String::new(),
            takes_file_names_only: false,
        };
        for section in sections {
            let flag = |name: &str, value: &str| match value {
                "true" => Ok(true),
                "false" => Ok(false),
                _ => Err(section.unknown_value(name, value, "true or false")),
            };
            // The mesh folder beats the asset folder, whichever is first.
            if let Some(folder) = section.get("assetdir") {
                compiler.mesh_folder = folder.into();
            }
            for (name, value) in &section.attributes {
                match name.as_str() {
                    "angle" => match value.as_str() {
                        "radian" => compiler.angle = 1.0,
                        "degree" => compiler.angle = std::f64::consts::PI / 180.0,
                        _ => return Err(section.unknown_value(name, value, "radian or degree")),
                    },
                    "eulerseq" => {
                        let letters: Vec<char> = value.chars().collect();
                        match <[char; 3]>::try_from(letters) {
                            Ok(order) if order.iter().all(|c| "xyzXYZ".contains(*c)) => compiler.euler_order = order,
                            _ => return Err(section.unknown_value(name, value, "three letters of xyzXYZ")),
                        }
                    }
                    "coordinate" if value != "local" => {
                        return Err(section.unsupported(format!("coordinate={value:?}")));
                    }
                    "autolimits" => compiler.has_automatic_limits = flag(name, value)?,
                    "strippath" => compiler.takes_file_names_only = flag(name, value)?,
                    "meshdir" => compiler.mesh_folder.clone_from(value),
                    _ => {}
                }
            }
        }
        Ok(compiler)
    }
}

/// What the flags of the sections `option` say; the last value of each counts for the whole file.
pub(super) struct Flags<'e>(HashMap<&'e str, (&'e Element, bool)>);

impl<'e> Flags<'e> {
    /// Returns the flags of a file with a root element.
    pub(super) fn new(root: &'e Element) -> Result<Self, FileError> {
        const KNOWN: [&str; 28] = [
            "constraint",
            "equality",
            "frictionloss",
            "limit",
            "contact",
            "passive",
            "spring",
            "damper",
            "gravity",
            "clampctrl",
            "warmstart",
            "filterparent",
            "actuation",
            "refsafe",
            "sensor",
            "midphase",
            "eulerdamp",
            "autoreset",
            "nativeccd",
            "island",
            "multiccd",
            "override",
            "energy",
            "fwdinv",
            "invdiscrete",
            "sensornoise",
            "sleep",
            "diagexact",
        ];
        let mut flags = HashMap::new();
        let sections = root.children.iter().filter(|section| section.name == "option");
        for element in sections.flat_map(|s| &s.children).filter(|e| e.name == "flag") {
            element.check_attributes(&KNOWN)?;
            for (name, value) in &element.attributes {
                let is_enabled = match value.as_str() {
                    "enable" => true,
                    "disable" => false,
                    _ => return Err(element.unknown_value(name, value, "enable or disable")),
                };
                flags.insert(name.as_str(), (element, is_enabled));
            }
        }
        Ok(Self(flags))
    }

    /// Returns whether a part of the simulation is enabled that is so by default.
    pub(super) fn is_enabled(&self, name: &str) -> bool {
        self.0.get(name).is_none_or(|(_, is_enabled)| *is_enabled)
    }

    /// Returns whether constraints of a kind, `limit` or `equality`, are in force.
    pub(super) fn has(&self, kind: &str) -> bool {
        self.is_enabled("constraint") && self.is_enabled(kind)
    }

    /// Returns the flags that switch contacts off, which changes nothing here.
    pub(super) fn without_contacts(&self) -> impl Iterator<Item = Skipped> {
        let disabled = ["constraint", "contact"]
            .into_iter()
            .filter(|name| !self.is_enabled(name));
        disabled.map(|name| {
            let why = format!("{name}=\"disable\" is passed over: pairs are checked");
            self.0[name].0.error(FileErrorKind::Malformed(why)).into()
        })
    }
}

/// The classes of the sections `default`.
pub(super) struct Classes {
    classes: Vec<Class>,
    /// The class of each name.
    names: HashMap<String, usize>,
}

#[derive(Default)]
struct Class {
    /// The class above.
    parent: Option<usize>,
    /// Values by the name of the element.
    values: HashMap<String, Vec<(String, String)>>,
}

/// The name of the root class.
const ROOT: &str = "main";

impl Classes {
    pub(super) fn new(sections: &[&Element]) -> Result<Self, FileError> {
        let mut classes = Self {
            classes: vec![Class::default()],
            names: HashMap::from([(ROOT.into(), 0)]),
        };
        for section in sections {
            if let Some(name) = section.get("class").filter(|name| *name != ROOT) {
                return Err(section.unknown_value("class of the root", name, "main or none"));
            }
            // The classes of earlier sections keep the values that the root had there.
            let earlier = classes.names.get(ROOT).copied();
            let root = classes.add(earlier);
            classes.names.insert(ROOT.into(), root);
            classes.fill(section, root)?;
        }
        Ok(classes)
    }

    /// Adds a class without values, and returns its number.
    fn add(&mut self, parent: Option<usize>) -> usize {
        let values = HashMap::new();
        self.classes.push(Class { parent, values });
        self.classes.len() - 1
    }

    fn fill(&mut self, section: &Element, class: usize) -> Result<(), FileError> {
        section.check_attributes(&["class"])?;
        for child in &section.children {
            if child.name == "default" {
                let name = child.needed("class")?;
                let below = self.add(Some(class));
                if self.names.insert(name.into(), below).is_some() {
                    return Err(child.error(FileErrorKind::Repeated));
                }
                self.fill(child, below)?;
            } else if WITH_CLASS.contains(&&*child.name) {
                check(child)?;
                let known = self.classes[class].values.entry(child.name.clone()).or_default();
                let has_turn = ORIENTATIONS.iter().any(|name| child.get(name).is_some());
                known.retain(|(name, _)| {
                    child.get(name).is_none() && !(has_turn && ORIENTATIONS.contains(&name.as_str()))
                });
                known.extend(child.attributes.iter().cloned());
            }
        }
        Ok(())
    }

    /// Returns the values of an element: its own, then those of its class or else of `class`, and
    /// of the classes above. `kind` is the name of the element in a class.
    pub(super) fn of<'e>(&'e self, element: &'e Element, kind: &str, class: &str) -> Result<Settings<'e>, FileError> {
        let name = element.get("class").unwrap_or(class);
        let mut next = Some(*self.names.get(name).ok_or_else(|| self.unknown(element, name))?);
        let mut chain = vec![&element.attributes[..]];
        while let Some(class) = next.map(|k| &self.classes[k]) {
            chain.extend(class.values.get(kind).map(|values| &values[..]));
            next = class.parent;
        }
        let place = &element.place;
        Ok(Settings { place, chain })
    }

    /// Returns the class that an attribute `childclass` names, or else `class`.
    pub(super) fn below<'e>(&self, element: &'e Element, class: &'e str) -> Result<&'e str, FileError> {
        match element.get("childclass") {
            Some(name) if self.names.contains_key(name) => Ok(name),
            Some(name) => Err(self.unknown(element, name)),
            None => Ok(class),
        }
    }

    fn unknown(&self, element: &Element, name: &str) -> FileError {
        element.error(FileErrorKind::Unknown {
            kind: "class",
            name: name.into(),
            near: nearest(name, self.names.keys().map(String::as_str)),
        })
    }
}

/// Returns an error if an element with values in a class has an unknown attribute.
pub(super) fn check(element: &Element) -> Result<(), FileError> {
    const GEOM: [&str; 36] = [
        "name",
        "class",
        "type",
        "contype",
        "conaffinity",
        "condim",
        "group",
        "priority",
        "size",
        "material",
        "friction",
        "mass",
        "density",
        "shellinertia",
        "solmix",
        "solref",
        "solimp",
        "margin",
        "gap",
        "surfacevel",
        "adhesion",
        "fromto",
        "pos",
        "quat",
        "axisangle",
        "xyaxes",
        "zaxis",
        "euler",
        "hfield",
        "mesh",
        "fitscale",
        "rgba",
        "fluidshape",
        "fluidcoef",
        "user",
        "castshadow",
    ];
    const JOINT: [&str; 25] = [
        "name",
        "class",
        "type",
        "group",
        "pos",
        "axis",
        "springdamper",
        "limited",
        "actuatorfrclimited",
        "solreflimit",
        "solimplimit",
        "solreffriction",
        "solimpfriction",
        "stiffness",
        "range",
        "actuatorfrcrange",
        "actuatorgravcomp",
        "margin",
        "ref",
        "springref",
        "springyield",
        "armature",
        "damping",
        "frictionloss",
        "user",
    ];
    const MESH: [&str; 18] = [
        "name",
        "class",
        "content_type",
        "file",
        "vertex",
        "normal",
        "texcoord",
        "face",
        "refpos",
        "refquat",
        "scale",
        "smoothnormal",
        "maxhullvert",
        "inertia",
        "builtin",
        "params",
        "material",
        "octree_maxdepth",
    ];
    const PAIR: [&str; 12] = [
        "name",
        "class",
        "geom1",
        "geom2",
        "condim",
        "friction",
        "solref",
        "solreffriction",
        "solimp",
        "gap",
        "margin",
        "adhesion",
    ];
    // Values of a class.
    const EQUALITY: [&str; 4] = ["class", "active", "solref", "solimp"];
    match element.name.as_str() {
        "equality" => element.check_attributes(&EQUALITY),
        "geom" => element.check_attributes(&GEOM),
        "joint" => element.check_attributes(&JOINT),
        "mesh" => element.check_attributes(&MESH),
        "pair" => element.check_attributes(&PAIR),
        _ => Ok(()),
    }
}

/// The values of an element.
pub(super) struct Settings<'e> {
    pub(super) place: &'e Place,
    /// The values of the element, of its class, of the class above, and so on.
    chain: Vec<&'e [(String, String)]>,
}

impl<'e> Settings<'e> {
    /// Returns the values of an element without a class.
    pub(super) fn own(element: &'e Element) -> Self {
        Self {
            place: &element.place,
            chain: vec![&element.attributes],
        }
    }

    pub(super) fn get(&self, name: &str) -> Option<&'e str> {
        let mut found = self.chain.iter().flat_map(|values| values.iter());
        found.find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, FileError> {
        self.get(name).map(|text| exactly(self.place, name, text)).transpose()
    }

    /// Returns up to `most` numbers; none if the attribute is missing.
    pub(super) fn up_to(&self, name: &str, most: usize) -> Result<Vec<f64>, FileError> {
        self.get(name)
            .map_or(Ok(Vec::new()), |text| numbers(self.place, name, text, most))
    }

    pub(super) fn whole_number(&self, name: &str, otherwise: i32) -> Result<i32, FileError> {
        let Some(text) = self.get(name) else {
            return Ok(otherwise);
        };
        let why = || format!("invalid {name}: {text:?} (expected a whole number)");
        let number = text.trim().parse();
        number.map_err(|_| self.place.error(FileErrorKind::Malformed(why())))
    }

    /// Returns the pose of an element: `pos`, and one orientation.
    pub(super) fn pose(&self, compiler: &Compiler) -> Result<Isometry3<f64>, FileError> {
        let xyz = self.numbers::<3>("pos")?.unwrap_or_default();
        let turn = self.orientation(compiler)?;
        Ok(Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn))
    }

    fn orientation(&self, compiler: &Compiler) -> Result<UnitQuaternion<f64>, FileError> {
        let is_turn = |(name, _): &&(String, String)| ORIENTATIONS.contains(&name.as_str());
        let mut lists = self.chain.iter().map(|values| values.iter().filter(is_turn));
        let Some(mut turns) = lists.find(|turns| turns.clone().next().is_some()) else {
            return Ok(UnitQuaternion::identity());
        };
        let (Some((name, text)), None) = (turns.next(), turns.next()) else {
            let why = "several orientations are given (expected at most one)";
            return Err(self.place.error(FileErrorKind::Malformed(why.into())));
        };
        let zero = || {
            let field = format!("length of {name}");
            self.place.error(FileErrorKind::Range { field, value: 0.0 })
        };
        match name.as_str() {
            "quat" => {
                let [w, x, y, z] = exactly(self.place, name, text)?;
                from_xyzw([x, y, z, w]).ok_or_else(zero)
            }
            "axisangle" => {
                let [x, y, z, angle] = exactly(self.place, name, text)?;
                let axis = direction([x, y, z]).ok_or_else(zero)?;
                Ok(about(&axis, angle * compiler.angle))
            }
            "euler" => Ok(euler(exactly(self.place, name, text)?, compiler)),
            "zaxis" => {
                let axis = direction(exactly(self.place, name, text)?).ok_or_else(zero)?;
                Ok(turn_from_z(&axis))
            }
            _ => {
                let [a, b, c, d, e, f] = exactly(self.place, name, text)?;
                let x = direction([a, b, c]).ok_or_else(zero)?;
                let y = direction([d, e, f]).ok_or_else(zero)?.into_inner();
                let y = direction((y - x.into_inner() * x.dot(&y)).into()).ok_or_else(zero)?;
                let columns = [*x, *y, x.cross(&y)];
                let turn = lin_canny::nalgebra::Rotation3::from_basis_unchecked(&columns);
                Ok(UnitQuaternion::from_rotation_matrix(&turn))
            }
        }
    }
}

/// Returns the rotation of three angles. Small letters turn about the axes of the turned frame,
/// capitals about those of the frame before.
pub(super) fn euler(angles: [f64; 3], compiler: &Compiler) -> UnitQuaternion<f64> {
    let mut turn = UnitQuaternion::identity();
    for (letter, angle) in compiler.euler_order.into_iter().zip(angles) {
        let axis = match letter.to_ascii_lowercase() {
            'x' => Vector3::x_axis(),
            'y' => Vector3::y_axis(),
            _ => Vector3::z_axis(),
        };
        let step = about(&axis, angle * compiler.angle);
        turn = if letter.is_ascii_lowercase() {
            turn * step
        } else {
            step * turn
        };
    }
    turn
}

/// Returns the middle of a segment, half its length, and the rotation from z to its direction.
pub(super) fn segment(place: &Place, ends: [f64; 6]) -> Result<(Isometry3<f64>, f64), FileError> {
    let [a, b, c, d, e, f] = ends;
    let (from, to) = (Point3::new(a, b, c), Point3::new(d, e, f));
    let along = from - to;
    let axis: Option<Unit<Vector3<f64>>> = direction(along.into());
    let axis = axis.ok_or_else(|| {
        let field = "length of fromto".into();
        place.error(FileErrorKind::Range { field, value: 0.0 })
    })?;
    let middle = Translation3::from((from.coords + to.coords) * 0.5);
    Ok((Isometry3::from_parts(middle, turn_from_z(&axis)), 0.5 * along.norm()))
}
