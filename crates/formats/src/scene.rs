//! A mesh file with its instances apart: each mesh once, and the nodes that place it.

use std::path::Path;

use crate::error::{Fault, FormatError};
use crate::mesh::{MeshFile, MeshFormat, MeshObject, Skipped};
use crate::transform::{FLAT, IDENTITY, Matrix, apply, orientation};

/// A mesh file whose instances share their mesh: the parts of an assembly.
///
/// [`MeshFile`] has a moved copy of a mesh for each node of glTF and COLLADA; a scene has the mesh once.
/// An object of another format is a node of its mesh.
///
/// ```
/// use lin_canny_formats::MeshScene;
///
/// let text = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
///     "nodes": [{"name": "shelf", "children": [1, 2]}, {"name": "left", "mesh": 0},
///         {"name": "right", "mesh": 0, "translation": [2, 0, 0]}],
///     "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
///     "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
///         "min": [0, 0, 0], "max": [1, 1, 0]}],
///     "bufferViews": [{"buffer": 0, "byteLength": 36}],
///     "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
/// let scene = MeshScene::parse(text.as_bytes(), "shelf.gltf")?;
/// assert_eq!((scene.meshes.len(), scene.nodes.len()), (1, 2));
/// assert_eq!(scene.nodes[1].name, "shelf/right");
/// assert_eq!(scene.nodes[1].transform[0], [1.0, 0.0, 0.0, 2.0]);
/// # Ok::<(), lin_canny_formats::FormatError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshScene {
    /// The format.
    pub format: MeshFormat,
    /// The meshes in their own frames; metres for COLLADA and glTF, after the transform of their node.
    pub meshes: Vec<MeshObject>,
    /// The nodes with a mesh, in the order of the scene.
    pub nodes: Vec<MeshNode>,
    /// What the reader has passed over because it is no part of a body.
    pub skipped: Vec<Skipped>,
}

/// A mesh at its place in a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshNode {
    /// The names of the nodes from the root to this one, with slashes between them; the name of the object
    /// if there are none.
    pub name: String,
    /// The index of the mesh.
    pub mesh: usize,
    /// The map from the frame of the mesh to the scene: three rows of four numbers, the last of which is
    /// the translation. It has an inverse, and may scale, shear or mirror.
    pub transform: [[f64; 4]; 3],
}

impl MeshScene {
    /// Returns the scene of a file.
    ///
    /// # Errors
    /// As [`MeshFile::load`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        Self::parse(&FormatError::read(path)?, path)
    }

    /// Returns the scene of the bytes of a file, as [`MeshFile::parse`] takes them.
    ///
    /// # Errors
    /// As [`MeshFile::load`].
    pub fn parse(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        Self::read(bytes, path).map_err(|fault| fault.of(path))
    }
}

/// A scene as its reader builds it.
#[derive(Debug)]
pub(crate) struct RawScene {
    pub(crate) format: MeshFormat,
    pub(crate) meshes: Vec<MeshObject>,
    pub(crate) places: Vec<PlacedMesh>,
    pub(crate) skipped: Vec<Skipped>,
    /// Bytes of moved copies that the file may ask for.
    pub(crate) left: usize,
}

/// A node with a mesh, and what its errors name.
#[derive(Debug)]
pub(crate) struct PlacedMesh {
    pub(crate) mesh: usize,
    pub(crate) transform: Matrix,
    /// The names of the nodes from the root.
    pub(crate) path: String,
    /// The name of the object if its mesh has none.
    pub(crate) name: String,
    pub(crate) line: Option<usize>,
    pub(crate) element: String,
}

impl PlacedMesh {
    fn malformed(&self, why: &str) -> Fault {
        Fault::malformed(self.line, format!("{} {why}", self.element))
    }

    /// Returns an error if the transform has no inverse.
    pub(crate) fn checked(self) -> Result<Self, Fault> {
        if orientation(&self.transform).abs() > FLAT {
            return Ok(self);
        }
        Err(self.malformed("has an invalid transform: flat or not finite (expected one with an inverse)"))
    }

    /// Returns the moved copy of the mesh.
    fn object(&self, mesh: &MeshObject) -> Result<MeshObject, Fault> {
        let mut object = mesh.clone();
        if object.name.is_empty() {
            object.name.clone_from(&self.name);
        }
        for point in &mut object.points {
            *point = apply(&self.transform, *point);
            if point.iter().any(|x| !x.is_finite()) {
                let why = "has a point that its transform makes infinite (expected finite coordinates)";
                return Err(self.malformed(why));
            }
        }
        // A mirror turns triangles over.
        if orientation(&self.transform) < 0.0 {
            object.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(object)
    }
}

impl RawScene {
    /// Returns the file with a moved copy of each mesh for each node.
    pub(crate) fn into_file(mut self) -> Result<MeshFile, Fault> {
        let mut objects = Vec::with_capacity(self.places.len());
        for place in &self.places {
            let mesh = &self.meshes[place.mesh];
            let lists = size_of_val(&mesh.points[..]) + size_of_val(&mesh.triangles[..]);
            let bytes = size_of::<MeshObject>() + mesh.name.len() + lists;
            let too_large = || place.malformed("makes the scene too large by repeated use of data");
            self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
            objects.push(place.object(mesh)?);
        }
        Ok(MeshFile {
            format: self.format,
            objects,
            skipped: self.skipped,
        })
    }

    pub(crate) fn into_scene(self) -> MeshScene {
        let node = |place: PlacedMesh| MeshNode {
            name: match place.path.is_empty() {
                true => {
                    let mesh = &self.meshes[place.mesh].name;
                    if mesh.is_empty() { place.name } else { mesh.clone() }
                }
                false => place.path,
            },
            mesh: place.mesh,
            transform: place.transform,
        };
        MeshScene {
            format: self.format,
            nodes: self.places.into_iter().map(node).collect(),
            meshes: self.meshes,
            skipped: self.skipped,
        }
    }
}

impl From<MeshFile> for MeshScene {
    fn from(file: MeshFile) -> Self {
        let node = |(mesh, object): (usize, &MeshObject)| MeshNode {
            name: object.name.clone(),
            mesh,
            transform: IDENTITY,
        };
        Self {
            format: file.format,
            nodes: file.objects.iter().enumerate().map(node).collect(),
            meshes: file.objects,
            skipped: file.skipped,
        }
    }
}
