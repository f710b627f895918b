//! Finds the files that a robot or cell names.

use std::path::{Component, Path, PathBuf};

use roxmltree::{Document, ParsingOptions};

use crate::error::FileErrorKind;
use crate::xml_text::XmlText;

/// Folders in which packages are searched.
///
/// `package://NAME/REST` is the file REST in the package NAME, and so is `model://NAME/REST`. The
/// package is the first of these folders that has this name and this file:
///
/// 1. each given folder, and the folders in it;
/// 2. each folder above the URDF, and its folder NAME.
///
/// A folder whose `package.xml` says the name goes before one that has the name itself.
///
/// `file://` paths and plain paths are relative to the folder of the URDF. A path may have percent
/// signs for its letters, such as `%20`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Packages {
    folders: Vec<PathBuf>,
}

impl Packages {
    /// Returns packages in these folders only.
    #[must_use]
    pub fn new(folders: impl IntoIterator<Item = impl Into<PathBuf>>) -> Self {
        let folders = folders.into_iter().map(Into::into).collect();
        Self { folders }
    }

    /// Appends the folders of the environment variable `ROS_PACKAGE_PATH`.
    #[must_use]
    pub fn with_environment(mut self) -> Self {
        if let Some(path) = std::env::var_os("ROS_PACKAGE_PATH") {
            self.folders
                .extend(std::env::split_paths(&path).filter(|p| !p.as_os_str().is_empty()));
        }
        self
    }

    /// Returns the file of a name in a URDF that is in `folder`.
    pub(crate) fn find(&self, name: &str, folder: &Path) -> Result<PathBuf, FileErrorKind> {
        let name = name.trim();
        let folder = &absolute(folder);
        let inside = name
            .strip_prefix("package://")
            .or_else(|| name.strip_prefix("model://"));
        let Some(inside) = inside else {
            let path = name.strip_prefix("file://").or_else(|| name.strip_prefix("file:"));
            let path = path.unwrap_or(name);
            if path.contains("://") {
                return Err(FileErrorKind::Unsupported(format!("the address {name:?} of a mesh")));
            }
            let path = path
                .strip_prefix("localhost")
                .filter(|rest| rest.starts_with('/'))
                .unwrap_or(path);
            let missing = || FileErrorKind::MissingMesh(folder.join(path).display().to_string());
            let mut files = spellings(path).map(|path| folder.join(path));
            return files.find(|file| file.is_file()).ok_or_else(missing);
        };
        for inside in spellings(inside.trim_start_matches('/')) {
            let (package, rest) = inside.split_once('/').unwrap_or((&inside, ""));
            let given = self.folders.iter().flat_map(|place| {
                let place = absolute(place);
                let below = std::fs::read_dir(&place).into_iter().flatten().flatten();
                let mut below: Vec<PathBuf> = below.map(|entry| entry.path()).collect();
                // The order in which a file system lists a folder is its own.
                below.sort();
                std::iter::once(place).chain(below)
            });
            let above = folder
                .ancestors()
                .flat_map(|place| [place.to_owned(), place.join(package)]);
            let places = given.chain(above).filter(|place| place.join(rest).is_file());
            let places: Vec<PathBuf> = places.collect();
            let is_declared = |place: &&PathBuf| declared_name(place).is_some_and(|name| name == package);
            let is_named = |place: &&PathBuf| place.file_name().is_some_and(|name| name == package);
            let place = places.iter().find(is_declared).or_else(|| places.iter().find(is_named));
            if let Some(place) = place {
                return Ok(place.join(rest));
            }
        }
        let folders: String = self.folders.iter().map(|f| format!("{}, ", f.display())).collect();
        let places = format!("{folders}the folders above the URDF");
        Err(FileErrorKind::MissingMesh(format!("{name:?} (looked for in {places})")))
    }
}

/// Returns an absolute path, so that all folders above it are known.
fn absolute(folder: &Path) -> PathBuf {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let path = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let goes_up = path.components().any(|part| part == Component::ParentDir);
    match path.canonicalize() {
        Ok(path) if goes_up => path,
        _ => path,
    }
}

/// Returns the name that the `package.xml` of a folder says.
fn declared_name(folder: &Path) -> Option<String> {
    let text = std::fs::read_to_string(folder.join("package.xml")).ok()?;
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let text = XmlText::new(&text).text;
    let document = Document::parse_with_options(&text, options).ok()?;
    let mut elements = document.root_element().children();
    let name = elements.find(|n| n.has_tag_name("name"))?;
    name.text().map(|name| name.trim().to_owned())
}

/// Returns a path as it is written and, if they differ, with its percent signs decoded.
fn spellings(path: &str) -> impl Iterator<Item = String> {
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let [first, after @ ..] = rest {
        let digits = after.get(..2).filter(|_| *first == b'%');
        let code = digits.and_then(|d| u8::from_str_radix(str::from_utf8(d).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = after.get(code.map_or(0, |_| 2)..).unwrap_or_default();
    }
    let decoded = String::from_utf8(bytes).ok().filter(|decoded| decoded != path);
    std::iter::once(path.to_owned()).chain(decoded)
}
