//! XML with the line of every element, and the elements and attributes that a file may have.
//!
//! An element or attribute that nobody reads is an error, because it may be a misspelt one whose
//! meaning would be lost. Elements that hold neither geometry nor kinematics are listed here and
//! passed over unread.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::rc::Rc;

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::text::check_content;
use crate::turn::{from_xyzw, roll_pitch_yaw};
use crate::xml_text::{UNDECLARED, XmlText};
use lin_canny_plan::nearest_name as nearest;

/// The largest coordinate of a body, as in [`lin_canny`].
pub(crate) const EXTENT_MAX: f64 = 1e100;

/// The first version of URDF that has quaternions.
const QUATERNIONS: [u32; 2] = [1, 1];

/// Most declarations of prefixes, and most quotes behind one tag. The time of the XML parser grows
/// with the cube of the first and the square of the second.
const PREFIXES: usize = 200;
const QUOTES: usize = 10_000;

/// Most bytes of a text that entities of the file make.
const EXPANDED: usize = 1 << 20;

/// The namespace of the elements that Drake adds.
const DRAKE: &str = "http://drake.mit.edu";

/// Maximum depth of nested elements.
const DEPTH: usize = 64;

/// Most letters of a name, and most bytes of the path to an element, that errors show. Many
/// elements may be below one of a long name.
const SHOWN: (usize, usize) = (60, 160);

/// Most bytes of the name of a link or joint with the names of its models, or with what copies add.
pub(crate) const NAME: usize = 256;

/// Most bodies of which some pairs are excluded, and most excluded pairs.
pub(crate) const EXCLUDING: usize = 5_000;
pub(crate) const EXCLUDED: usize = 1_000_000;

/// Elements of xacro, for URDFs in which it has no prefix.
const XACRO: [&str; 7] = ["arg", "if", "include", "insert_block", "macro", "property", "unless"];

/// A file and its elements.
pub(crate) struct Xml<'a> {
    pub(crate) file: &'a Path,
    /// The file, shared by all places.
    place: Rc<Path>,
    text: &'a XmlText,
    document: Document<'a>,
    /// The positions of line feeds.
    line_feeds: Vec<usize>,
    /// What tinyxml passes over, by its position.
    skipped: RefCell<BTreeMap<usize, Skipped>>,
}

impl<'a> Xml<'a> {
    pub(crate) fn parse(file: &'a Path, whole: &'a XmlText) -> Result<Self, FileError> {
        let text = whole.text.as_str();
        check_content(text).map_err(|reason| FileError::new(file, Some(1), "", reason))?;
        check_size(text).map_err(|what| FileError::new(file, Some(1), "", FileErrorKind::Unsupported(what.into())))?;
        let options = ParsingOptions {
            allow_dtd: true,
            nodes_limit: 4_000_000,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options).map_err(|e| {
            let (line, reason) = malformed(text, &e);
            FileError::new(file, Some(line), "", FileErrorKind::Malformed(reason))
        })?;
        let line_feeds = text
            .bytes()
            .enumerate()
            .filter(|(_, b)| *b == b'\n')
            .map(|(k, _)| k)
            .collect();
        let xml = Self {
            file,
            place: file.into(),
            text: whole,
            document,
            line_feeds,
            skipped: RefCell::default(),
        };
        for (at, what) in &whole.notes {
            let reason = FileErrorKind::Malformed(what.clone());
            xml.skip(*at, FileError::new(file, Some(xml.line_at(*at)), "", reason));
        }
        xml.skip_undeclared();
        let is_deep = |node: &Node| node.ancestors().nth(DEPTH).is_some();
        if let Some(node) = xml.document.descendants().find(is_deep) {
            let reason = FileErrorKind::Malformed(format!("elements are nested too deep (expected at most {DEPTH})"));
            return Err(FileError::new(file, Some(xml.line(&node)), "", reason));
        }
        // The parser ignores the values that a document type gives to missing attributes.
        let before = text.get(..xml.root().range().start).unwrap_or_default();
        if before.contains("<!ATTLIST") {
            let reason = FileErrorKind::Unsupported("a document type with attributes".into());
            return Err(FileError::new(file, Some(1), "", reason));
        }
        Ok(xml)
    }

    pub(crate) fn root(&self) -> Node<'_, 'a> {
        self.document.root_element()
    }

    /// Returns the error of a root element that is not expected.
    pub(crate) fn unknown_root(&self, expected: &str) -> FileError {
        let found = self.root().tag_name().name();
        let reason = FileErrorKind::Malformed(format!("unknown root element: {found:?} (expected {expected})"));
        self.error(&self.root(), reason)
    }

    pub(crate) fn place(&self, node: &Node) -> Place {
        Place {
            file: self.place.clone(),
            line: self.line(node),
            element: title(node),
        }
    }

    /// Returns the error of an element.
    pub(crate) fn error(&self, node: &Node, reason: FileErrorKind) -> FileError {
        FileError::new(self.file, Some(self.line(node)), title(node), reason)
    }

    pub(crate) fn line(&self, node: &Node) -> u32 {
        self.line_at(node.range().start)
    }

    fn line_at(&self, position: usize) -> u32 {
        1 + self.line_feeds.partition_point(|&at| at < position) as u32
    }

    /// Returns what was passed over so far that XML, or the format, does not allow.
    pub(crate) fn skipped(&self) -> Vec<Skipped> {
        self.skipped.borrow().values().cloned().collect()
    }

    /// Lists what is passed over at a position of the text.
    pub(crate) fn skip(&self, position: usize, error: FileError) {
        self.skipped
            .borrow_mut()
            .entry(position)
            .or_insert_with(|| error.into());
    }

    /// Lists the prefixes that the file does not declare, each with the first element that has it.
    fn skip_undeclared(&self) {
        let mut known = HashSet::new();
        let mut check = |node: &Node, position: usize, uri: Option<&str>| {
            if let Some(prefix) = uri.and_then(|uri| uri.strip_prefix(UNDECLARED))
                && known.insert(prefix.to_owned())
            {
                let rule = format!("expected an attribute xmlns:{prefix} of the root element");
                let reason = FileErrorKind::Malformed(format!("undeclared prefix: {prefix:?} ({rule})"));
                self.skip(position, self.error(node, reason));
            }
        };
        for node in self.document.descendants().filter(Node::is_element) {
            check(&node, node.range().start, node.tag_name().namespace());
            for attribute in node.attributes() {
                check(&node, attribute.range().start, attribute.namespace());
            }
        }
    }

    /// Lists a text that is not blank between elements, where no text is read.
    pub(crate) fn skip_text(&self, parent: &Node, text: &Node) {
        let found = text.text().filter(|_| text.is_text()).unwrap_or_default().trim();
        if !found.is_empty() {
            let shown: String = found.chars().take(40).collect();
            let reason = FileErrorKind::Unsupported(format!("text between elements ({shown:?})"));
            let range = text.range();
            let written = self.text.text.get(range.clone()).unwrap_or_default();
            let at = range.start + (written.len() - written.trim_start().len());
            let error = FileError::new(self.file, Some(self.line_at(at)), title(parent), reason);
            self.skip(at, error);
        }
    }

    /// Returns whether an element has a prefix of another namespace than the root.
    pub(crate) fn is_foreign(&self, node: &Node) -> bool {
        self.prefix(node).is_some() && node.tag_name().namespace() != self.root().tag_name().namespace()
    }

    /// Returns the elements below another one that are read, in their order.
    ///
    /// Elements of `passed` and of a foreign namespace are passed over, and text is listed. Any other
    /// element is an error.
    pub(crate) fn below<'n>(
        &self,
        parent: Node<'n, 'a>,
        read: &'static [&'static str],
        passed: &[&str],
    ) -> Result<Vec<Node<'n, 'a>>, FileError> {
        let is_urdf = self.root().tag_name().name() == "robot";
        let mut found = Vec::new();
        for node in parent.children() {
            let name = node.tag_name().name();
            let uri = node.tag_name().namespace();
            let prefix = self.prefix(&node);
            let is_xacro = prefix == Some("xacro") || uri.is_some_and(|uri| uri.contains("xacro"));
            let is_foreign = self.is_of_drake(&node) || self.is_foreign(&node);
            self.skip_text(&parent, &node);
            if !node.is_element() || (is_foreign && !is_xacro) {
                continue;
            }
            if !is_xacro && read.contains(&name) {
                found.push(node);
            } else if is_xacro || (is_urdf && XACRO.contains(&name) && !passed.contains(&name)) {
                let name = prefix.map_or(name.to_owned(), |prefix| format!("{prefix}:{name}"));
                return Err(self.error(&node, FileErrorKind::Xacro(name)));
            } else if !passed.contains(&name) {
                let reason = FileErrorKind::UnknownPart {
                    what: "element",
                    name: name.into(),
                    expected: read,
                };
                return Err(self.error(&node, reason));
            }
        }
        Ok(found)
    }

    /// Returns the one element of a name, if there is one.
    pub(crate) fn at_most_one<'n>(
        &self,
        nodes: &[Node<'n, 'a>],
        name: &str,
    ) -> Result<Option<Node<'n, 'a>>, FileError> {
        let mut named = nodes.iter().filter(|n| n.tag_name().name() == name);
        let first = named.next().copied();
        match named.next() {
            Some(second) => Err(self.error(second, FileErrorKind::Twice(name.into()))),
            None => Ok(first),
        }
    }

    /// Returns the one element of a name.
    pub(crate) fn one<'n>(&self, parent: &Node, nodes: &[Node<'n, 'a>], name: &str) -> Result<Node<'n, 'a>, FileError> {
        let missing = || self.error(parent, FileErrorKind::Missing(format!("element {name}")));
        self.at_most_one(nodes, name)?.ok_or_else(missing)
    }

    /// Returns an error if an element has an attribute that is not read, or elements below it.
    ///
    /// With `is_open`, an attribute is an error only if it is almost spelt as one that is read.
    pub(crate) fn check_leaf(
        &self,
        node: Node<'_, 'a>,
        read: &'static [&'static str],
        is_open: bool,
    ) -> Result<(), FileError> {
        self.below(node, &[], &[])?;
        self.check_attributes(node, read, is_open)
    }

    /// Returns an error if an element has an attribute that is not read.
    ///
    /// With `is_open`, an attribute is an error only if it is almost spelt as one that is read.
    pub(crate) fn check_attributes(
        &self,
        node: Node<'_, 'a>,
        read: &'static [&'static str],
        is_open: bool,
    ) -> Result<(), FileError> {
        let own = node.attributes().filter(|a| a.namespace().is_none());
        for name in own.map(|a| a.name()).filter(|name| !read.contains(name)) {
            if !is_open || nearest(name, read.iter().copied()).is_some() {
                let reason = FileErrorKind::UnknownPart {
                    what: "attribute",
                    name: name.into(),
                    expected: read,
                };
                return Err(self.error(&node, reason));
            }
        }
        Ok(())
    }

    /// Returns the prefix of the namespace of an element, as it is written.
    fn prefix(&self, node: &Node) -> Option<&'a str> {
        let tag = self
            .text
            .text
            .get(node.range().start + 1..)
            .filter(|_| node.is_element())?;
        let end = tag.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>'))?;
        tag[..end].split_once(':').map(|(prefix, _)| prefix)
    }

    /// Returns whether an element is one of those that Drake adds.
    pub(crate) fn is_of_drake(&self, node: &Node) -> bool {
        let prefix = self.prefix(node);
        prefix == Some("drake") || prefix.is_some() && node.tag_name().namespace() == Some(DRAKE)
    }

    /// Returns a required attribute.
    pub(crate) fn needed<'n>(&self, node: &Node<'n, 'a>, name: &str) -> Result<&'n str, FileError> {
        let missing = || self.error(node, FileErrorKind::Missing(format!("attribute {name}")));
        let text = attribute(node, name).ok_or_else(missing)?;
        self.check_expanded(node, text)?;
        Ok(text)
    }

    fn check_expanded(&self, node: &Node, text: &str) -> Result<(), FileError> {
        if text.contains("${") || text.contains("$(") {
            return Err(self.error(node, FileErrorKind::Xacro(text.into())));
        }
        Ok(())
    }

    /// Returns the version of a file: 1.0 if it names none.
    pub(crate) fn version(&self) -> Result<[u32; 2], FileError> {
        let root = self.root();
        let Some(text) = attribute(&root, "version") else {
            return Ok([1, 0]);
        };
        let numbers = text.trim().split_once('.');
        let numbers = numbers.and_then(|(major, minor)| Some([major.parse().ok()?, minor.parse().ok()?]));
        let wrong =
            || FileErrorKind::Malformed(format!("invalid version: {text:?} (expected two numbers such as 1.1)"));
        numbers.ok_or_else(|| self.error(&root, wrong()))
    }

    /// Returns exactly `N` finite numbers of an attribute, if there is one.
    pub(crate) fn numbers<const N: usize>(&self, node: &Node, field: &str) -> Result<Option<[f64; N]>, FileError> {
        let Some(text) = attribute(node, field) else {
            return Ok(None);
        };
        self.check_expanded(node, text)?;
        let words: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let numbers = words.ok().filter(|words| words.iter().all(|x: &f64| x.is_finite()));
        match numbers.and_then(|numbers| numbers.try_into().ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => {
                let (field, text) = (field.into(), text.into());
                let reason = FileErrorKind::Number { field, count: N, text };
                Err(self.error(node, reason))
            }
        }
    }

    /// Returns exactly `N` finite numbers of a required attribute.
    pub(crate) fn needed_numbers<const N: usize>(&self, node: &Node, field: &str) -> Result<[f64; N], FileError> {
        let missing = || self.error(node, FileErrorKind::Missing(format!("attribute {field}")));
        self.numbers(node, field)?.ok_or_else(missing)
    }

    /// Returns the pose of an element `origin`; the identity if there is none.
    pub(crate) fn origin(&self, node: Option<Node<'_, 'a>>) -> Result<Isometry3<f64>, FileError> {
        let Some(node) = node else {
            return Ok(Isometry3::identity());
        };
        self.check_leaf(node, &["xyz", "rpy", "quat_xyzw"], false)?;
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
        if attribute(&node, "quat_xyzw").is_some() && version < QUATERNIONS {
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
}

/// Returns an attribute without a namespace.
pub(crate) fn attribute<'n>(node: &Node<'n, '_>, name: &str) -> Option<&'n str> {
    let mut own = node.attributes().filter(|a| a.namespace().is_none());
    own.find(|a| a.name() == name).map(|a| a.value())
}

/// Returns an error if a small text could take the parser much time or memory.
fn check_size(text: &str) -> Result<(), &'static str> {
    let quotes = |tag: &str| tag.bytes().filter(|b| matches!(b, b'"' | b'\'')).count();
    if text.matches("xmlns:").nth(PREFIXES).is_some() || text.split('<').any(|tag| quotes(tag) > QUOTES) {
        return Err("XML with that many prefixes or attributes");
    }
    // An entity is shorter than all declarations, and is replaced once for each `&` if none is in
    // another.
    if let Some(first) = text.find("<!ENTITY") {
        let declarations = &text[first..text.rfind("]>").unwrap_or(text.len()).max(first)];
        if declarations.contains('&') {
            return Err("an entity in an entity");
        }
        if declarations.len().saturating_mul(text.matches('&').count()) > EXPANDED {
            return Err("a text of entities that is longer than a megabyte");
        }
    }
    Ok(())
}

/// Returns the line of a fault of the parser, and what helps.
fn malformed(text: &str, error: &roxmltree::Error) -> (u32, String) {
    use roxmltree::Error;
    let line = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => text.lines().count() as u32,
        _ => error.pos().row,
    };
    let reason = match error {
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
            "undeclared prefix: \"xacro\" (expected a URDF); run xacro on the file first".into()
        }
        Error::MalformedEntityReference(_) => "malformed entity reference: \"&\" (expected &amp; for the sign)".into(),
        error => error.to_string(),
    };
    (line, reason)
}

/// Returns the path of the elements to a node, such as `link "hand" mesh`; of a long path the end.
fn title(node: &Node) -> String {
    let shown = |name: &str| -> String { name.chars().take(SHOWN.0).collect() };
    let mut title = String::new();
    for node in node
        .ancestors()
        .filter(|n| n.is_element() && n.parent_element().is_some())
    {
        let tag = shown(node.tag_name().name());
        let word = match node.attribute("name") {
            Some(name) => format!("{tag} {:?}", shown(name)),
            None => tag,
        };
        if title.is_empty() {
            title = word;
        } else if title.len() + word.len() < SHOWN.1 {
            title = format!("{word} {title}");
        } else {
            break;
        }
    }
    title
}

/// Returns an error if a name is too long.
pub(crate) fn check_name(name: &str) -> Result<(), FileErrorKind> {
    if name.len() <= NAME {
        return Ok(());
    }
    let shown: String = name.chars().take(20).collect();
    let what = format!(
        "name is too long: {shown:?} with {} bytes (expected at most {NAME})",
        name.len()
    );
    Err(FileErrorKind::Malformed(what))
}

/// Returns an error if the bodies of which pairs are excluded, or these pairs, are too many.
pub(crate) fn check_excluded(bodies: usize, pairs: usize) -> Result<(), FileErrorKind> {
    for (what, count, most) in [
        ("colliding bodies", bodies, EXCLUDING),
        ("excluded pairs", pairs, EXCLUDED),
    ] {
        if count > most {
            let what = format!("too many {what}: {count} (expected at most {most})");
            return Err(FileErrorKind::Malformed(what));
        }
    }
    Ok(())
}
