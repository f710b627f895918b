//! Values in the text of elements: words, numbers, poses.

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::frames::{Reference, Target};
use crate::error::{FileError, FileErrorKind};
use crate::turn::{from_xyzw, roll_pitch_yaw};
use crate::xml::{EXTENT_MAX, Xml, attribute};

/// A file and its version.
pub(super) struct SdfFile<'a> {
    pub(super) xml: &'a Xml<'a>,
    pub(super) version: [u32; 2],
}

/// Versions whose rules this reader knows.
const VERSIONS: [[u32; 2]; 2] = [[1, 3], [1, 12]];

impl<'a> SdfFile<'a> {
    pub(super) fn new(xml: &'a Xml<'a>) -> Result<Self, FileError> {
        let root = xml.root();
        if root.tag_name().name() != "sdf" {
            return Err(xml.unknown_root("sdf"));
        }
        xml.check_attributes(root, &["version"], false)?;
        xml.needed(&root, "version")?;
        let version = xml.version()?;
        let [first, last] = VERSIONS;
        if version < first || version > last {
            let [a, b] = version;
            let what = format!("invalid version: {a}.{b} (expected 1.3 to 1.12)");
            return Err(xml.error(&root, FileErrorKind::Malformed(what)));
        }
        Ok(Self { xml, version })
    }

    /// Lists an element or attribute that the version of the file does not have. It is read as in a
    /// later version, as libsdformat does, which converts files to its own version first.
    pub(super) fn check_version(&self, node: &Node, field: &'static str, since: [u32; 2]) {
        if self.version < since {
            let ([a, b], [c, d]) = (self.version, since);
            let what = format!("{field} in a file of version {a}.{b} is read as in version {c}.{d}");
            let attribute = node.attribute_node(field);
            let position = attribute.map_or(node.range().start, |attribute| attribute.range().start);
            let error = self.xml.error(node, FileErrorKind::Malformed(what));
            self.xml.skip(position, error);
        }
    }

    /// Returns the text of an element without elements.
    pub(super) fn text(&self, node: Node<'_, 'a>, attributes: &'static [&'static str]) -> Result<String, FileError> {
        self.xml.check_attributes(node, attributes, false)?;
        if let Some(child) = node.children().find(Node::is_element) {
            let reason = FileErrorKind::UnknownPart {
                what: "element",
                name: child.tag_name().name().into(),
                expected: &[],
            };
            return Err(self.xml.error(&child, reason));
        }
        let texts = node.children().filter(Node::is_text).filter_map(|n| n.text());
        // A comment separates words.
        Ok(texts.collect::<Vec<_>>().join(" ").trim().to_owned())
    }

    /// Returns the text of an element that must not be empty.
    pub(super) fn word(&self, node: Node<'_, 'a>) -> Result<String, FileError> {
        let text = self.text(node, &[])?;
        if text.is_empty() {
            let name = node.tag_name().name();
            return Err(self.xml.error(&node, FileErrorKind::Missing(format!("text of {name}"))));
        }
        Ok(text)
    }

    /// Returns a text of exactly `N` numbers, which may be infinite with `may_be_infinite`.
    fn numbers_of<const N: usize>(
        &self,
        node: &Node,
        text: &str,
        may_be_infinite: bool,
    ) -> Result<[f64; N], FileError> {
        let words: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let is_good = |x: &f64| x.is_finite() || (may_be_infinite && x.is_infinite());
        let numbers = words.ok().filter(|words| words.iter().all(is_good));
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
            let (field, text) = (node.tag_name().name().into(), text.into());
            let reason = FileErrorKind::Number { field, count: N, text };
            self.xml.error(node, reason)
        })
    }

    /// Returns exactly `N` finite numbers of an element.
    pub(super) fn numbers<const N: usize>(&self, node: Node<'_, 'a>) -> Result<[f64; N], FileError> {
        self.numbers_with(node, &[])
    }

    /// Returns exactly `N` finite numbers of an element that may have these attributes.
    pub(super) fn numbers_with<const N: usize>(
        &self,
        node: Node<'_, 'a>,
        attributes: &'static [&'static str],
    ) -> Result<[f64; N], FileError> {
        self.numbers_of(&node, &self.text(node, attributes)?, false)
    }

    /// Returns the number of an element, which may be infinite.
    pub(super) fn limit(&self, node: Node<'_, 'a>) -> Result<f64, FileError> {
        let numbers = self.numbers_of(&node, &self.text(node, &[])?, true)?;
        let [number] = numbers;
        Ok(number)
    }

    /// Returns the numbers of an element below another one.
    pub(super) fn needed<const N: usize>(
        &self,
        parent: &Node,
        parts: &[Node<'_, 'a>],
        name: &str,
    ) -> Result<[f64; N], FileError> {
        self.numbers(self.xml.one(parent, parts, name)?)
    }

    fn truth(&self, node: &Node, field: &str, text: &str) -> Result<bool, FileError> {
        match text.to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            _ => {
                let what = format!("invalid {field}: {text:?} (expected true or false)");
                Err(self.xml.error(node, FileErrorKind::Malformed(what)))
            }
        }
    }

    /// Returns the truth value of an element below another one, if there is one.
    pub(super) fn flag(&self, parts: &[Node<'_, 'a>], name: &str) -> Result<Option<bool>, FileError> {
        let node = self.xml.at_most_one(parts, name)?;
        node.map(|node| self.truth(&node, name, &self.text(node, &[])?))
            .transpose()
    }

    /// Returns the truth value of an attribute: false if there is none.
    pub(super) fn flag_attribute(&self, node: &Node, field: &'static str, since: [u32; 2]) -> Result<bool, FileError> {
        let Some(text) = attribute(node, field) else {
            return Ok(false);
        };
        self.check_version(node, field, since);
        self.truth(node, field, text.trim())
    }

    /// Returns the frame that an attribute names, unless the attribute is empty.
    pub(super) fn frame_attribute(
        &self,
        node: &Node,
        field: &'static str,
        since: [u32; 2],
        [scope, model]: [usize; 2],
    ) -> Result<Option<Target>, FileError> {
        let Some(name) = attribute(node, field).filter(|name| !name.is_empty()) else {
            return Ok(None);
        };
        self.check_version(node, field, since);
        Ok(Some(Target::Named(Reference {
            place: self.xml.place(node),
            scope,
            model,
            name: name.into(),
        })))
    }

    /// Returns the pose of an element below another one, and the frame that it states.
    pub(super) fn pose(
        &self,
        parts: &[Node<'_, 'a>],
        names: [usize; 2],
    ) -> Result<(Option<Target>, Isometry3<f64>), FileError> {
        let Some(node) = self.xml.at_most_one(parts, "pose")? else {
            return Ok((None, Isometry3::identity()));
        };
        let text = self.text(node, &["relative_to", "degrees", "rotation_format", "frame"])?;
        let wrong = |reason| self.xml.error(&node, reason);
        if attribute(&node, "frame").is_some_and(|name| !name.is_empty()) {
            let what = "attribute frame of a pose (expected relative_to, of version 1.7)".into();
            return Err(wrong(FileErrorKind::Unsupported(what)));
        }
        let base = self.frame_attribute(&node, "relative_to", [1, 7], names)?;
        let is_in_degrees = self.flag_attribute(&node, "degrees", [1, 9])?;
        let format = attribute(&node, "rotation_format");
        if format.is_some() {
            self.check_version(&node, "rotation_format", [1, 9]);
        }
        let is_quaternion = match format.unwrap_or("euler_rpy") {
            "euler_rpy" => false,
            "quat_xyzw" if !is_in_degrees => true,
            "quat_xyzw" => {
                let what = "both degrees and quat_xyzw are given (expected at most one)".into();
                return Err(wrong(FileErrorKind::Malformed(what)));
            }
            other => {
                let what = format!("invalid rotation_format: {other:?} (expected euler_rpy or quat_xyzw)");
                return Err(wrong(FileErrorKind::Malformed(what)));
            }
        };
        if text.is_empty() {
            return Ok((base, Isometry3::identity()));
        }
        let (xyz, turn) = if is_quaternion {
            let [x, y, z, a, b, c, d] = self.numbers_of(&node, &text, false)?;
            let zero = || FileErrorKind::Range {
                field: "length of the quaternion".into(),
                value: 0.0,
            };
            ([x, y, z], from_xyzw([a, b, c, d]).ok_or_else(|| wrong(zero()))?)
        } else {
            let [x, y, z, roll, pitch, yaw] = self.numbers_of(&node, &text, false)?;
            let angle = |a: f64| if is_in_degrees { a.to_radians() } else { a };
            ([x, y, z], roll_pitch_yaw([roll, pitch, yaw].map(angle)))
        };
        Ok((base, self.checked_pose(&node, xyz, turn)?))
    }

    fn checked_pose(&self, node: &Node, xyz: [f64; 3], turn: UnitQuaternion<f64>) -> Result<Isometry3<f64>, FileError> {
        let pose = Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn);
        let value = pose.translation.vector.amax();
        if !(value <= EXTENT_MAX) {
            let field = "position".into();
            return Err(self.xml.error(node, FileErrorKind::Range { field, value }));
        }
        match RelativePose::from_isometry(&pose) {
            Ok(_) => Ok(pose),
            Err(e) => Err(self.xml.error(node, FileErrorKind::Geometry(e.to_string()))),
        }
    }
}
