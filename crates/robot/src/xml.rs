//! XML with the line of every element, and checks of the numbers and names of a URDF or SRDF.
//!
//! `urdf-rs` keeps no lines and reads `"0 0 x 1"` as three numbers. So the numbers are checked here
//! first, and later errors take the line of their element from here.

use std::path::Path;

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use crate::error::{FileError, FileErrorKind};
use crate::turn::{from_xyzw, roll_pitch_yaw};

/// The largest coordinate of a body, as in [`lin_canny`].
pub(crate) const EXTENT_MAX: f64 = 1e100;

/// The first version of URDF that has quaternions.
const QUATERNIONS: [u32; 2] = [1, 1];

/// Maximum depth of nested elements.
const DEPTH: usize = 64;

/// A file and its elements.
pub(crate) struct Xml<'a> {
    pub(crate) file: &'a Path,
    document: Document<'a>,
}

impl<'a> Xml<'a> {
    pub(crate) fn parse(file: &'a Path, text: &'a str, root: &str) -> Result<Self, FileError> {
        // No document types, because their entities can grow without bound.
        let options = ParsingOptions {
            allow_dtd: false,
            nodes_limit: 4_000_000,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options).map_err(|e| {
            let reason = FileErrorKind::Malformed(e.to_string());
            FileError::new(file, Some(e.pos().row), "", reason)
        })?;
        let xml = Self { file, document };
        // `urdf-rs` is recursive.
        let is_deep = |node: &Node| node.ancestors().nth(DEPTH).is_some();
        if let Some(node) = xml.document.descendants().find(is_deep) {
            let reason = FileErrorKind::Malformed(format!("elements are nested more than {DEPTH} deep"));
            return Err(FileError::new(file, Some(xml.line(&node)), "", reason));
        }
        let found = xml.root().tag_name().name();
        if found != root {
            let reason = FileErrorKind::Malformed(format!("unknown root element: {found:?} (expected {root:?})"));
            return Err(xml.error(&xml.root(), reason));
        }
        Ok(xml)
    }

    pub(crate) fn root(&self) -> Node<'_, 'a> {
        self.document.root_element()
    }

    /// Returns the elements of a kind directly below the root.
    pub(crate) fn elements(&self, kind: &str) -> impl Iterator<Item = Node<'_, 'a>> {
        children(self.root(), kind)
    }

    /// Returns the error of an element.
    pub(crate) fn error(&self, node: &Node, reason: FileErrorKind) -> FileError {
        FileError::new(self.file, Some(self.line(node)), title(node), reason)
    }

    /// Returns the error of the `link` or `joint` with a name; of the file if there is none.
    pub(crate) fn error_of(&self, kind: &str, name: &str, reason: FileErrorKind) -> FileError {
        let node = self.elements(kind).find(|n| n.attribute("name") == Some(name));
        match node {
            Some(node) => self.error(&node, reason),
            None => FileError::new(self.file, None, format!("{kind} {name:?}"), reason),
        }
    }

    pub(crate) fn line(&self, node: &Node) -> u32 {
        self.document.text_pos_at(node.range().start).row
    }

    /// Returns a required attribute.
    pub(crate) fn needed<'n>(&self, node: &'n Node<'_, '_>, name: &str) -> Result<&'n str, FileError> {
        let missing = || self.error(node, FileErrorKind::Missing(format!("attribute {name}")));
        node.attribute(name).ok_or_else(missing)
    }

    /// Returns the version of a URDF: 1.0 if it names none.
    fn version(&self) -> Result<[u32; 2], FileError> {
        let root = self.root();
        let Some(text) = root.attribute("version") else {
            return Ok([1, 0]);
        };
        let numbers = text.trim().split_once('.');
        let numbers = numbers.and_then(|(major, minor)| Some([major.parse().ok()?, minor.parse().ok()?]));
        let wrong =
            || FileErrorKind::Malformed(format!("invalid version: {text:?} (expected two numbers such as 1.1)"));
        numbers.ok_or_else(|| self.error(&root, wrong()))
    }

    /// Returns exactly `N` finite numbers of an attribute, if there is one.
    fn numbers<const N: usize>(&self, node: &Node, field: &str) -> Result<Option<[f64; N]>, FileError> {
        let Some(text) = node.attribute(field) else {
            return Ok(None);
        };
        self.check_numbers(node, field, N)?;
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        Ok(numbers.try_into().ok())
    }

    /// Returns the pose of the `origin` below an element; the identity if there is none.
    pub(crate) fn origin(&self, parent: Node) -> Result<Isometry3<f64>, FileError> {
        let Some(node) = children(parent, "origin").next() else {
            return Ok(Isometry3::identity());
        };
        let xyz = self.numbers::<3>(&node, "xyz")?.unwrap_or_default();
        let turn = match (self.numbers(&node, "rpy")?, self.numbers(&node, "quat_xyzw")?) {
            (None, None) => UnitQuaternion::identity(),
            (Some(rpy), None) => roll_pitch_yaw(rpy),
            (None, Some(xyzw)) => from_xyzw(xyzw).ok_or_else(|| {
                let field = "length of quat_xyzw".into();
                self.error(&node, FileErrorKind::Range { field, value: 0.0 })
            })?,
            (Some(_), Some(_)) => {
                let reason = "both rpy and quat_xyzw are given (expected at most one)".into();
                return Err(self.error(&node, FileErrorKind::Malformed(reason)));
            }
        };
        let version = self.version()?;
        if node.has_attribute("quat_xyzw") && version < QUATERNIONS {
            let reason = FileErrorKind::Version {
                field: "quat_xyzw",
                version,
                since: QUATERNIONS,
            };
            return Err(self.error(&node, reason));
        }
        let pose = Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn);
        let value = pose.translation.vector.amax();
        if !(value <= EXTENT_MAX) {
            let field = "xyz of the origin".into();
            return Err(self.error(&node, FileErrorKind::Range { field, value }));
        }
        match RelativePose::from_isometry(&pose) {
            Ok(_) => Ok(pose),
            Err(e) => Err(self.error(&node, FileErrorKind::Geometry(e.to_string()))),
        }
    }

    /// Returns an error if an attribute does not hold exactly `count` finite numbers.
    fn check_numbers(&self, node: &Node, field: &str, count: usize) -> Result<(), FileError> {
        let Some(text) = node.attribute(field) else {
            return Ok(());
        };
        let words = || text.split_whitespace();
        let is_number = |w: &str| w.parse::<f64>().is_ok_and(f64::is_finite);
        if words().count() == count && words().all(is_number) {
            return Ok(());
        }
        let reason = FileErrorKind::Number {
            field: field.into(),
            count,
            text: text.into(),
        };
        Err(self.error(node, reason))
    }

    /// Returns the text with blanks in place of visual elements.
    ///
    /// `urdf-rs` is stricter about these than other readers, for example about a texture without a
    /// file.
    pub(crate) fn undrawn(&self, text: &str) -> String {
        let visuals = self.elements("link").flat_map(|link| children(link, "visual"));
        let mut bytes = text.as_bytes().to_vec();
        for node in visuals.chain(self.elements("material")) {
            bytes[node.range()].fill(b' ');
        }
        // `urdf-rs` converts quaternions to angles, which loses digits near a pitch of 90 degrees.
        let origins = self.document.descendants().filter(|n| n.has_tag_name("origin"));
        for attribute in origins.filter_map(|n| n.attribute_node("quat_xyzw")) {
            bytes[attribute.range()].fill(b' ');
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Returns an error if a number, name or kind of a link or joint is invalid.
    pub(crate) fn check_urdf(&self) -> Result<(), FileError> {
        for kind in ["link", "joint"] {
            let mut names = std::collections::HashSet::new();
            for node in self.elements(kind) {
                if !names.insert(self.needed(&node, "name")?.to_owned()) {
                    return Err(self.error(&node, FileErrorKind::Repeated));
                }
                for part in node.descendants().filter(Node::is_element) {
                    self.check_part(&part)?;
                }
            }
        }
        self.elements("joint").try_for_each(|joint| self.check_joint(&joint))
    }

    fn check_part(&self, part: &Node) -> Result<(), FileError> {
        let of = part.tag_name().name();
        let is_shape = matches!(of, "box" | "cylinder" | "capsule" | "sphere" | "mesh");
        // Elements of other tools have other attributes.
        if is_shape && !part.parent_element().is_some_and(|p| p.has_tag_name("geometry")) {
            return Ok(());
        }
        let fields: &[(&str, usize, bool)] = match of {
            "origin" => &[("xyz", 3, false), ("rpy", 3, false), ("quat_xyzw", 4, false)],
            "box" => &[("size", 3, true)],
            "cylinder" | "capsule" => &[("radius", 1, true), ("length", 1, true)],
            "sphere" => &[("radius", 1, true)],
            "mesh" => &[("scale", 3, false)],
            "axis" => &[("xyz", 3, true)],
            "limit" => &[("lower", 1, false), ("upper", 1, false)],
            "mimic" => &[("multiplier", 1, false), ("offset", 1, false)],
            _ => &[],
        };
        for &(field, count, is_needed) in fields {
            if is_needed {
                self.needed(part, field)?;
            }
            self.check_numbers(part, field, count)?;
        }
        match of {
            "mesh" => self.needed(part, "filename").map(drop),
            "mimic" => self.needed(part, "joint").map(drop),
            "geometry" => self.check_shape(part),
            _ => Ok(()),
        }
    }

    fn check_shape(&self, geometry: &Node) -> Result<(), FileError> {
        let Some(shape) = geometry.children().find(Node::is_element) else {
            return Err(self.error(geometry, FileErrorKind::Missing("a shape".into())));
        };
        let name = shape.tag_name().name();
        if matches!(name, "box" | "cylinder" | "capsule" | "sphere" | "mesh") {
            return Ok(());
        }
        Err(self.error(&shape, FileErrorKind::Unsupported(format!("the shape {name:?}"))))
    }

    fn check_joint(&self, joint: &Node) -> Result<(), FileError> {
        let kind = self.needed(joint, "type")?;
        let known = ["revolute", "continuous", "prismatic", "fixed", "planar", "floating"];
        if !known.contains(&kind) {
            let reason = FileErrorKind::Unsupported(format!("a joint of type {kind:?}"));
            return Err(self.error(joint, reason));
        }
        for end in ["parent", "child"] {
            let node = children(*joint, end).next();
            let missing = || self.error(joint, FileErrorKind::Missing(format!("element {end}")));
            self.needed(&node.ok_or_else(missing)?, "link")?;
        }
        let limit = children(*joint, "limit").next();
        if matches!(kind, "revolute" | "prismatic") && limit.is_none() && children(*joint, "mimic").next().is_none() {
            return Err(self.error(joint, FileErrorKind::Missing("element limit".into())));
        }
        Ok(())
    }
}

/// Returns the elements of a kind directly below a node.
pub(crate) fn children<'n, 'a>(node: Node<'n, 'a>, kind: &str) -> impl Iterator<Item = Node<'n, 'a>> {
    node.children().filter(move |n| n.has_tag_name(kind))
}

/// Returns the path of the elements to a node, such as `link "hand" mesh`.
fn title(node: &Node) -> String {
    let mut words: Vec<String> = node
        .ancestors()
        .filter(|n| n.is_element() && n.parent_element().is_some())
        .map(|n| match n.attribute("name") {
            Some(name) => format!("{} {name:?}", n.tag_name().name()),
            None => n.tag_name().name().to_owned(),
        })
        .collect();
    words.reverse();
    words.join(" ")
}
