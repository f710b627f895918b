//! The files of a model: its own, and those of the models that it attaches.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::element::Element;
use super::geom::Source;
use super::settings::{Classes, Compiler, Flags, check};
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::options::LoadOptions;
use crate::xml::Xml;
use crate::xml_text::XmlText;

/// Maximum number of files of models.
const MOST_FILES: usize = 100;

/// Sections that are read.
const READ: [&str; 8] = [
    "compiler",
    "option",
    "default",
    "asset",
    "worldbody",
    "contact",
    "equality",
    "deformable",
];

/// Sections that hold neither geometry for collisions nor kinematics.
const PASSED: [&str; 9] = [
    "size",
    "visual",
    "statistic",
    "custom",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
    "extension",
];

/// A file, with those that it includes.
pub(super) struct ModelFile {
    pub(super) root: Element,
    folder: PathBuf,
    /// The files of the models that it can attach, by their names.
    models: HashMap<String, usize>,
}

impl ModelFile {
    /// Returns a file and those of all models that it and they can attach, and what was passed over.
    pub(super) fn all(xml: &Xml) -> Result<(Vec<Self>, Vec<Skipped>), FileError> {
        let mut skipped = Vec::new();
        let mut files = vec![Self::new(xml, &mut skipped)?];
        let mut numbers: HashMap<PathBuf, usize> = HashMap::new();
        numbers.extend(xml.file.canonicalize().ok().map(|path| (path, 0)));
        let mut next = 0;
        while next < files.len() {
            let mut models = HashMap::new();
            let assets = files[next]
                .root
                .children
                .iter()
                .filter(|section| section.name == "asset");
            let elements = assets
                .flat_map(|section| &section.children)
                .filter(|e| e.name == "model");
            let elements: Vec<(Option<String>, PathBuf, _)> = elements
                .map(|element| {
                    element.check_attributes(&["name", "file", "content_type"])?;
                    let path = files[next].folder.join(element.needed("file")?);
                    Ok((element.get("name").map(str::to_owned), path, element.place.clone()))
                })
                .collect::<Result<_, FileError>>()?;
            for (name, path, place) in elements {
                if !path.is_file() {
                    let what = format!("model file {:?}", path.display().to_string());
                    return Err(place.error(FileErrorKind::Missing(what)));
                }
                let known = path.canonicalize().unwrap_or_else(|_| path.clone());
                let number = match numbers.get(&known) {
                    Some(&number) => number,
                    None if files.len() == MOST_FILES => {
                        let why = format!("too many files of models (expected at most {MOST_FILES})");
                        return Err(place.error(FileErrorKind::Malformed(why)));
                    }
                    None => {
                        let text = XmlText::new(&FileError::read(&path)?);
                        let xml = Xml::parse(&path, &text)?;
                        if xml.root().tag_name().name() != "mujoco" {
                            return Err(xml.unknown_root("mujoco"));
                        }
                        files.push(Self::new(&xml, &mut skipped)?);
                        skipped.extend(xml.skipped());
                        numbers.insert(known, files.len() - 1);
                        files.len() - 1
                    }
                };
                let name = name.unwrap_or_else(|| files[number].name().to_owned());
                if models.insert(name, number).is_some() {
                    return Err(place.error(FileErrorKind::Repeated));
                }
            }
            files[next].models = models;
            next += 1;
        }
        Ok((files, skipped))
    }

    fn new(xml: &Xml, skipped: &mut Vec<Skipped>) -> Result<Self, FileError> {
        let (root, more) = Element::root(xml)?;
        skipped.extend(more);
        Ok(Self {
            root,
            folder: xml.file.parent().unwrap_or(Path::new("")).to_owned(),
            models: HashMap::new(),
        })
    }

    pub(super) fn name(&self) -> &str {
        self.root.get("model").unwrap_or("MuJoCo Model")
    }
}

/// The sections `contact`.
#[derive(Default)]
pub(super) struct Contacts<'e> {
    pub(super) excludes: Vec<&'e Element>,
    pub(super) pairs: Vec<&'e Element>,
}

impl<'e> Contacts<'e> {
    pub(super) fn new(sections: &[&'e Element]) -> Result<Self, FileError> {
        let mut contacts = Self::default();
        for section in sections {
            for element in section.below(&["pair", "exclude"], &[])? {
                if element.name == "pair" {
                    check(element)?;
                    contacts.pairs.push(element);
                } else {
                    element.check_attributes(&["name", "body1", "body2"])?;
                    contacts.excludes.push(element);
                }
            }
        }
        Ok(contacts)
    }

    /// Returns the names of the geoms of pairs, which are checked even if their bits are zero.
    pub(super) fn geoms(&self) -> Result<HashSet<&'e str>, FileError> {
        let names = self
            .pairs
            .iter()
            .flat_map(|pair| ["geom1", "geom2"].map(|end| pair.needed(end)));
        names.collect()
    }
}

/// What a file says, by sections.
pub(super) struct Spec<'e> {
    pub(super) source: Source<'e>,
    pub(super) classes: Classes,
    pub(super) contacts: Contacts<'e>,
    /// The names of the geoms of pairs.
    pub(super) paired: HashSet<&'e str>,
    pub(super) equalities: Vec<&'e Element>,
    pub(super) worlds: Vec<&'e Element>,
    pub(super) parts: Parts<'e>,
    pub(super) assets: Vec<&'e Element>,
    pub(super) models: &'e HashMap<String, usize>,
}

impl<'e> Spec<'e> {
    /// Returns what a file says. The flags are those of the main file.
    pub(super) fn new(file: &'e ModelFile, flags: &'e Flags<'e>, options: &'e LoadOptions) -> Result<Self, FileError> {
        let all: Vec<&Element> = file.root.below(&READ, &PASSED)?.collect();
        let sections = |name: &str| -> Vec<&'e Element> { all.iter().copied().filter(|s| s.name == name).collect() };
        for section in sections("deformable") {
            if let Some(flex) = section.below(&["flex"], &["skin"])?.next() {
                return Err(flex.unsupported("a flexible body"));
            }
        }
        let contacts = Contacts::new(&sections("contact"))?;
        let (classes, worlds) = (Classes::new(&sections("default"))?, sections("worldbody"));
        Ok(Self {
            parts: parts(&worlds, &classes)?,
            source: Source {
                compiler: Compiler::new(&sections("compiler"))?,
                flags,
                options,
                folder: &file.folder,
            },
            classes,
            paired: contacts.geoms()?,
            contacts,
            equalities: sections("equality"),
            worlds,
            assets: sections("asset"),
            models: &file.models,
        })
    }

    /// Returns the names of all elements of the sections `worldbody`.
    pub(super) fn names(&self) -> Vec<&'e str> {
        let (mut names, mut open) = (Vec::new(), self.worlds.clone());
        while let Some(element) = open.pop() {
            names.extend(element.get("name"));
            open.extend(&element.children);
        }
        names
    }

    /// Returns how many pairs, excluded pairs and equalities the file has.
    pub(super) fn rules(&self) -> usize {
        let equalities = self.equalities.iter().map(|section| section.children.len());
        self.contacts.pairs.len() + self.contacts.excludes.len() + equalities.sum::<usize>()
    }
}

/// Bodies and frames by their kind and name, with the class of their surroundings.
type Parts<'e> = HashMap<(&'e str, &'e str), (&'e Element, &'e str)>;

fn parts<'e>(worlds: &[&'e Element], classes: &Classes) -> Result<Parts<'e>, FileError> {
    let mut parts = Parts::new();
    let mut open: Vec<(&Element, &str)> = worlds.iter().map(|world| (*world, "main")).collect();
    while let Some((parent, class)) = open.pop() {
        for child in parent.children.iter().filter(|c| c.name == "body" || c.name == "frame") {
            if let Some(name) = child.get("name") {
                parts.entry((child.name.as_str(), name)).or_insert((child, class));
            }
            open.push((child, classes.below(child, class)?));
        }
    }
    Ok(parts)
}

/// A part of a file that is in the model: all of the main file, and each attached part.
#[derive(Clone, Default)]
pub(super) struct Attached {
    /// The number of the file.
    pub(super) spec: usize,
    /// What is added to names.
    pub(super) prefix: String,
    pub(super) suffix: String,
}

impl Attached {
    /// Returns the name in the model of an element that has a name in the file.
    pub(super) fn name(&self, name: &str) -> String {
        format!("{}{name}{}", self.prefix, self.suffix)
    }

    /// Returns whether names that do not exist are an error. An attached part leaves out what
    /// refers to elements outside.
    pub(super) fn is_whole(&self) -> bool {
        self.prefix.is_empty() && self.suffix.is_empty() && self.spec == 0
    }
}
