//! Finds and reads the files that an element `include` names.

use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::frames::WORLD;
use super::model::{Description, Override, Owner};
use super::values::SdfFile;
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::xml::{Xml, attribute};
use crate::xml_text::XmlText;

/// The most files that are included in all, and the most bytes of them. A file counts as often as
/// it is included.
const FILES: usize = 10_000;
const BYTES: usize = 16 << 20;

/// The file in the folder of a model that names the file of each version.
const CONFIG: &str = "model.config";

impl Description<'_> {
    /// Reads an included model, and returns its frame; `None` for a file without a model.
    pub(super) fn include(&mut self, file: &SdfFile, node: Node, owner: &Owner) -> Result<Option<usize>, FileError> {
        let xml = file.xml;
        let wrong = |reason| xml.error(&node, reason);
        xml.check_attributes(node, &["merge"], false)?;
        if let Some(params) = node.children().find(|n| n.tag_name().name() == "params") {
            let what = "params, which change the included model,".into();
            return Err(xml.error(&params, FileErrorKind::Unsupported(what)));
        }
        let parts = xml.below(node, &["uri", "name", "pose", "static", "placement_frame"], &["plugin"])?;
        let one = |name: &str| xml.at_most_one(&parts, name);
        let pose = one("pose")?.map(|_| file.pose(&parts, [owner.scope, owner.frame]));
        let placement = match one("placement_frame")? {
            Some(node) => {
                file.check_version(&node, "placement_frame", [1, 8]);
                Some((xml.place(&node), file.text(node, &[])?)).filter(|(_, name)| !name.is_empty())
            }
            None => None,
        };
        if placement.is_some() && pose.is_none() {
            return Err(wrong(FileErrorKind::Missing("element pose".into())));
        }
        let name = one("name")?.map(|node| file.text(node, &[])).transpose()?;
        let instead = Override {
            name: name.filter(|name| !name.is_empty()),
            pose: pose.transpose()?,
            is_static: file.flag(&parts, "static")?,
            placement,
            is_merged: file.flag_attribute(&node, "merge", [1, 9])?,
            hides_name: false,
        };
        if instead.is_merged && owner.frame == WORLD {
            let what = "a merged include of a world".into();
            return Err(wrong(FileErrorKind::Unsupported(what)));
        }
        let uri = xml.one(&node, &parts, "uri")?;
        let path = self.included_file(file, uri)?;
        let known = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.open_files.contains(&known) {
            let what = format!("file includes itself: {} (expected no cycle)", path.display());
            return Err(wrong(FileErrorKind::Malformed(what)));
        }
        let text = FileError::read(&path)?;
        self.included[0] += 1;
        self.included[1] += text.len();
        let [files, bytes] = self.included;
        if files > FILES || bytes > BYTES {
            let what =
                format!("too many included files: {files} with {bytes} bytes (expected at most {FILES} with {BYTES})");
            return Err(wrong(FileErrorKind::Malformed(what)));
        }
        self.open_files.push(known);
        let model = self.load(&path, &text, owner, instead);
        self.open_files.pop();
        model
    }

    /// Reads the one model of a file.
    fn load(&mut self, path: &Path, text: &str, owner: &Owner, instead: Override) -> Result<Option<usize>, FileError> {
        let text = XmlText::new(text);
        let xml = Xml::parse(path, &text)?;
        let file = SdfFile::new(&xml)?;
        let root = xml.root();
        let parts = xml.below(root, &["model", "world", "actor", "light"], &[])?;
        let mut model = None;
        for &node in &parts {
            match node.tag_name().name() {
                "model" if model.is_none() => model = Some(node),
                "model" => {
                    let what = "a second model of an included file".into();
                    return Err(xml.error(&node, FileErrorKind::Unsupported(what)));
                }
                "world" => {
                    let what = "a world of an included file".into();
                    return Err(xml.error(&node, FileErrorKind::Unsupported(what)));
                }
                "actor" => self.skip(&file, &node),
                _ => {}
            }
        }
        let model = match model {
            Some(model) => Some(self.model(&file, model, owner, instead)?),
            None if parts.is_empty() => {
                return Err(xml.error(&root, FileErrorKind::Missing("element model".into())));
            }
            None => None,
        };
        self.skipped.extend(xml.skipped());
        Ok(model)
    }

    /// Returns the file that a `uri` names, or that the configuration of its folder names.
    fn included_file(&mut self, file: &SdfFile, node: Node) -> Result<PathBuf, FileError> {
        let uri = file.word(node)?;
        let wrong = |reason| file.xml.error(&node, reason);
        let schemes = ["model://", "package://", "file://"];
        if uri.contains("://") && !schemes.iter().any(|scheme| uri.starts_with(scheme)) {
            return Err(wrong(FileErrorKind::Unsupported(format!(
                "the address {uri:?} of a model"
            ))));
        }
        let folder = file.xml.file.parent().unwrap_or(Path::new(""));
        let find = |name: &str| self.packages.find(name, folder).ok();
        if let Some(path) = find(&uri) {
            return Ok(path);
        }
        let config = find(&format!("{}/{CONFIG}", uri.trim_end_matches('/')));
        let missing = || {
            FileErrorKind::Missing(format!(
                "included model {uri:?}, a file or a folder with {CONFIG} in the packages or above this file,"
            ))
        };
        let config = config.ok_or_else(|| wrong(missing()))?;
        newest(&config, &mut self.skipped)
    }
}

/// Returns the file of the highest version that the configuration of a model names.
fn newest(config: &Path, skipped: &mut Vec<Skipped>) -> Result<PathBuf, FileError> {
    let text = XmlText::new(&FileError::read(config)?);
    let xml = Xml::parse(config, &text)?;
    skipped.extend(xml.skipped());
    let root = xml.root();
    let mut newest = None;
    for node in root.children().filter(|node| node.has_tag_name("sdf")) {
        let version = attribute(&node, "version").map_or(Some([0, 0]), |text| {
            let (major, minor) = text.trim().split_once('.')?;
            Some([major.parse().ok()?, minor.parse::<u32>().ok()?])
        });
        let Some(version) = version else {
            let text = attribute(&node, "version").unwrap_or_default();
            let what = format!("invalid version: {text:?} (expected two numbers such as 1.9)");
            return Err(xml.error(&node, FileErrorKind::Malformed(what)));
        };
        if newest.is_none_or(|(known, _)| version > known) {
            newest = Some((version, node));
        }
    }
    let missing = |node: &Node, what: &str| xml.error(node, FileErrorKind::Missing(what.into()));
    let (_, node) = newest.ok_or_else(|| missing(&root, "element sdf"))?;
    let name = node.text().unwrap_or_default().trim();
    let path = config.parent().unwrap_or(Path::new("")).join(name);
    if name.is_empty() || !path.is_file() {
        return Err(missing(&node, &format!("file {name:?}")));
    }
    Ok(path)
}
