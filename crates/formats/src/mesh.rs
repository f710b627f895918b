//! A mesh file: its objects, and what was skipped.

use std::collections::HashMap;
use std::path::Path;

use crate::error::{Fault, FormatError, FormatFault};
use crate::{collada, gltf, msh, obj, ply, stl, text};

/// Format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// STL, text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// COLLADA 1.4 or 1.5.
    Collada,
    /// MSH, the binary meshes of MuJoCo.
    Msh,
    /// PLY 1.0, text or binary.
    Ply,
    /// glTF 2.0, as JSON (`.gltf`) or binary (`.glb`).
    Gltf,
}

/// A mesh file as read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// The format.
    pub format: MeshFormat,
    /// The objects with triangles, in the order of the file.
    pub objects: Vec<MeshObject>,
    /// What the reader has passed over because it is no part of a body.
    pub skipped: Vec<Skipped>,
}

/// An object of a mesh file: a solid of an STL, an object of an OBJ, a geometry of a scene, a PLY.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshObject {
    /// The name in the file; empty if it has none.
    pub name: String,
    /// The points that triangles use, in the unit of the file (metres for COLLADA and glTF).
    pub points: Vec<[f64; 3]>,
    /// Three indices of points per triangle, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Something that a reader has passed over.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Skipped {
    /// The line, counted from 1, if known. Of several in a row, the first.
    pub line: Option<usize>,
    /// What it is: `normals`, `l (lines)`, `usemtl`.
    pub what: String,
}

impl MeshFile {
    /// Returns the mesh of a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, has no known format, is malformed, contains
    /// geometry that is not supported, or contains no triangle. The error names file and line.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let bytes = FormatError::read(path)?;
        Self::parse(&bytes, path)
    }

    /// Returns the mesh of the bytes of a file. Errors name the file `path`; its extension matters
    /// if the content does not decide the format. The buffers of a glTF may be in other files, which
    /// are read from the folder of `path`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let error = |fault: Fault| fault.of(path);
        let file = match format_of(bytes, path).map_err(error)? {
            MeshFormat::Stl => stl::read(bytes),
            MeshFormat::Obj => obj::read(bytes),
            MeshFormat::Collada => collada::read(bytes),
            MeshFormat::Msh => msh::read(bytes),
            MeshFormat::Ply => ply::read(bytes),
            MeshFormat::Gltf => gltf::read(bytes, path.parent().unwrap_or(Path::new(""))),
        };
        let mut file = file.map_err(error)?;
        file.objects.retain(|object| !object.triangles.is_empty());
        if file.objects.is_empty() {
            let (line, fault) = (None, FormatFault::Empty);
            return Err(error(Fault { line, fault }));
        }
        Ok(file)
    }

    /// Returns the points and triangles of all objects as one mesh.
    #[must_use]
    pub fn whole(&self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for object in &self.objects {
            let first = points.len() as u32;
            points.extend(&object.points);
            triangles.extend(object.triangles.iter().map(|t| t.map(|k| k + first)));
        }
        (points, triangles)
    }
}

/// Returns the format of a file: by its content, or else by its extension.
fn format_of(bytes: &[u8], path: &Path) -> Result<MeshFormat, Fault> {
    let unknown = |why: &str| Fault {
        line: None,
        fault: FormatFault::Unknown(why.into()),
    };
    if let Some(why) = text::foreign(bytes) {
        return Err(unknown(why));
    }
    let start = text::start(bytes);
    let lower = start.to_ascii_lowercase();
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    Ok(match extension.as_deref() {
        _ if stl::is_binary(bytes) => MeshFormat::Stl,
        _ if bytes.starts_with(b"glTF") => MeshFormat::Gltf,
        _ if text::first_line(&start).eq_ignore_ascii_case("ply") => MeshFormat::Ply,
        _ if start.contains("<COLLADA") => MeshFormat::Collada,
        _ if start.starts_with('{') && (start.contains(ASSET) || contains(bytes, ASSET)) => MeshFormat::Gltf,
        Some("stl") => MeshFormat::Stl,
        Some("obj") => MeshFormat::Obj,
        Some("dae") => MeshFormat::Collada,
        Some("msh") => MeshFormat::Msh,
        Some("ply") => MeshFormat::Ply,
        Some("gltf" | "glb") => MeshFormat::Gltf,
        _ if lower.starts_with("solid") => MeshFormat::Stl,
        _ => {
            let why = "unknown file extension (expected .stl, .obj, .dae, .ply, .gltf, .glb or .msh)";
            return Err(unknown(why));
        }
    })
}

/// The property of a glTF that must be there, and that may be anywhere in the file.
const ASSET: &str = "\"asset\"";

fn contains(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|window| window == word.as_bytes())
}

/// Collects the triangles of one object; points that no triangle uses are left out.
#[derive(Debug, Default)]
pub(crate) struct ObjectBuilder {
    object: MeshObject,
    /// The new index of each point of the file that a triangle uses.
    indices: HashMap<u64, u32>,
    /// What is passed over in this object; the reader adds it to the list of the file.
    pub(crate) skipped: SkippedList,
}

impl ObjectBuilder {
    pub(crate) fn new(name: impl Into<String>) -> Self {
        let mut builder = Self::default();
        builder.object.name = name.into();
        builder
    }

    /// Adds a triangle whose corners are points of a list of the file; `None` if an object has more
    /// points than 32 bits name.
    pub(crate) fn triangle(&mut self, corners: [u64; 3], point: impl Fn(u64) -> [f64; 3]) -> Option<()> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            *index = match self.indices.get(&corner) {
                Some(&known) => known,
                None => {
                    let new = u32::try_from(self.object.points.len()).ok()?;
                    self.object.points.push(point(corner));
                    self.indices.insert(corner, new);
                    new
                }
            };
        }
        self.object.triangles.push(triangle);
        Some(())
    }

    pub(crate) fn build(self) -> MeshObject {
        self.object
    }
}

/// Collects what a reader passes over: one entry for each kind, with its first line.
#[derive(Debug, Default)]
pub(crate) struct SkippedList(Vec<Skipped>);

impl SkippedList {
    pub(crate) fn add(&mut self, line: impl Into<Option<usize>>, what: &str) {
        if self.0.iter().all(|known| known.what != what) {
            self.0.push(Skipped {
                line: line.into(),
                what: what.into(),
            });
        }
    }

    pub(crate) fn append(&mut self, other: Self) {
        for one in other.0 {
            self.add(one.line, &one.what);
        }
    }

    pub(crate) fn build(self) -> Vec<Skipped> {
        self.0
    }
}
