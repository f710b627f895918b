//! The elements of an MJCF file, with those of the files that it includes.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use roxmltree::Node;

use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::xml::Xml;
use crate::xml_text::XmlText;
use lin_canny_plan::nearest_name as nearest;

/// Maximum depth of nested elements, those of included files counted with the file.
const DEPTH: usize = 64;

/// An element of the file or of an included one.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) children: Vec<Element>,
    pub(super) place: Place,
}

impl Element {
    /// Returns the elements of a file, with an `include` replaced by what it includes, and what was
    /// passed over.
    pub(super) fn root(xml: &Xml) -> Result<(Self, Vec<Skipped>), FileError> {
        let folder = xml.file.parent().unwrap_or(Path::new("")).to_owned();
        let mut files = Files {
            folder,
            read: HashSet::new(),
            skipped: Vec::new(),
        };
        files.read.extend(xml.file.canonicalize());
        Ok((files.element(xml, xml.root(), 0)?, files.skipped))
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    pub(super) fn needed(&self, name: &str) -> Result<&str, FileError> {
        let missing = || self.error(FileErrorKind::Missing(format!("attribute {name}")));
        self.get(name).ok_or_else(missing)
    }

    /// Returns exactly `N` finite numbers of an attribute, if there is one.
    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, FileError> {
        self.get(name).map(|text| exactly(&self.place, name, text)).transpose()
    }

    pub(super) fn error(&self, reason: FileErrorKind) -> FileError {
        self.place.error(reason)
    }

    pub(super) fn unsupported(&self, what: impl Into<String>) -> FileError {
        self.error(FileErrorKind::Unsupported(what.into()))
    }

    /// Returns the error of an attribute value that is not one of those expected.
    pub(super) fn unknown_value(&self, name: &str, value: &str, expected: &str) -> FileError {
        let why = format!("unknown {name}: {value:?} (expected {expected})");
        self.error(FileErrorKind::Malformed(why))
    }

    /// Returns an error if an attribute is unknown, because it may be a misspelt one.
    pub(super) fn check_attributes(&self, known: &[&str]) -> Result<(), FileError> {
        let is_unknown = |(name, _): &&(String, String)| !known.contains(&name.as_str());
        match self.attributes.iter().find(is_unknown) {
            Some((name, _)) => Err(self.error(unknown("attribute", name, known))),
            None => Ok(()),
        }
    }

    /// Returns the children that are read. Those of `passed` are passed over, others are an error.
    pub(super) fn below(&self, read: &[&str], passed: &[&str]) -> Result<impl Iterator<Item = &Element>, FileError> {
        let is_unknown = |child: &&Element| ![read, passed].iter().any(|known| known.contains(&&*child.name));
        if let Some(child) = self.children.iter().find(is_unknown) {
            return Err(child.error(unknown("element", &child.name, &[read, passed].concat())));
        }
        let read: Vec<String> = read.iter().map(|&name| name.into()).collect();
        Ok(self.children.iter().filter(move |child| read.contains(&child.name)))
    }
}

fn unknown(kind: &'static str, name: &str, known: &[&str]) -> FileErrorKind {
    FileErrorKind::Unknown {
        kind,
        name: name.into(),
        near: nearest(name, known.iter().copied()),
    }
}

/// Returns up to `most` finite numbers of a text.
pub(super) fn numbers(place: &Place, field: &str, text: &str, most: usize) -> Result<Vec<f64>, FileError> {
    let words: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let numbers = words.ok().filter(|words| words.iter().all(|x: &f64| x.is_finite()));
    let wrong = || {
        place.error(FileErrorKind::Number {
            field: field.into(),
            count: most,
            text: text.chars().take(60).collect(),
        })
    };
    let is_right = |numbers: &Vec<f64>| (1..=most).contains(&numbers.len());
    numbers.filter(is_right).ok_or_else(wrong)
}

/// Returns exactly `N` finite numbers of a text.
pub(super) fn exactly<const N: usize>(place: &Place, field: &str, text: &str) -> Result<[f64; N], FileError> {
    let found = numbers(place, field, text, N)?;
    found.try_into().map_err(|_| {
        let (field, text) = (field.into(), text.chars().take(60).collect());
        place.error(FileErrorKind::Number { field, count: N, text })
    })
}

/// The files that are read.
struct Files {
    /// The folder of the main file.
    folder: PathBuf,
    read: HashSet<PathBuf>,
    /// Elements of another namespace, and what XML does not allow in included files.
    skipped: Vec<Skipped>,
}

impl Files {
    fn element(&mut self, xml: &Xml, node: Node, depth: usize) -> Result<Element, FileError> {
        let place = xml.place(&node);
        if depth > DEPTH {
            let why = format!("elements are nested too deep (expected at most {DEPTH})");
            return Err(place.error(FileErrorKind::Malformed(why)));
        }
        let mut children = Vec::new();
        for child in node.children() {
            xml.skip_text(&node, &child);
            if xml.is_foreign(&child) {
                let what = format!("element {} of another namespace", child.tag_name().name());
                self.skipped
                    .push(xml.error(&child, FileErrorKind::Unsupported(what)).into());
            } else if child.tag_name().name() == "include" {
                children.extend(self.included(xml, child, depth)?);
            } else if child.is_element() {
                children.push(self.element(xml, child, depth + 1)?);
            }
        }
        let attributes = node.attributes().filter(|a| a.namespace().is_none());
        Ok(Element {
            name: node.tag_name().name().into(),
            attributes: attributes.map(|a| (a.name().into(), a.value().into())).collect(),
            children,
            place,
        })
    }

    /// Returns the elements below the root of an included file.
    ///
    /// The file is looked for in the folder of the main file, and then in that of the file that
    /// includes it. MuJoCo includes a file once.
    fn included(&mut self, xml: &Xml, node: Node, depth: usize) -> Result<Vec<Element>, FileError> {
        xml.check_leaf(node, &["file"], false)?;
        let name = xml.needed(&node, "file")?;
        let beside = xml.file.parent().unwrap_or(Path::new("")).join(name);
        let places = [self.folder.join(name), beside];
        let Some(path) = places.into_iter().find(|path| path.is_file()) else {
            let what = format!("included file {name:?}");
            return Err(xml.error(&node, FileErrorKind::Missing(what)));
        };
        if !self.read.insert(path.canonicalize().unwrap_or_else(|_| path.clone())) {
            let why = format!("file is included twice: {name:?} (expected once)");
            return Err(xml.error(&node, FileErrorKind::Malformed(why)));
        }
        let text = XmlText::new(&FileError::read(&path)?);
        let xml = Xml::parse(&path, &text)?;
        let children = self.element(&xml, xml.root(), depth + 1)?.children;
        self.skipped.extend(xml.skipped());
        Ok(children)
    }
}
