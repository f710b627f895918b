//! The functions that pick the reader of a file, of meshes, points and grids.

use std::path::Path;

use crate::error::{Fault, FormatError, FormatFault};
use crate::grid::{self, Grid};
use crate::mesh::{MeshFile, MeshFormat};
use crate::points::{Invalid, PointFile, PointFormat, PointList};
use crate::scene::MeshScene;
use crate::{collada, gltf, msh, npy, obj, pcd, ply, stl, text, xyz};

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
        Self::read(bytes, path, false).map_err(|fault| fault.of(path))
    }

    /// Returns the mesh of a file whose convex hull is wanted: an OBJ, a PLY or an MSH without
    /// triangles has objects of points alone.
    ///
    /// # Errors
    /// As [`load`](Self::load), but only if the file contains no point.
    pub fn load_for_hull(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let bytes = FormatError::read(path)?;
        Self::parse_for_hull(&bytes, path)
    }

    /// Returns the mesh of the bytes of a file whose convex hull is wanted, as
    /// [`parse`](Self::parse) takes them.
    ///
    /// # Errors
    /// As [`load_for_hull`](Self::load_for_hull).
    pub fn parse_for_hull(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        Self::read(bytes, path, true).map_err(|fault| fault.of(path))
    }

    fn read(bytes: &[u8], path: &Path, takes_points: bool) -> Result<Self, Fault> {
        let mut file = match format_of_mesh(bytes, path)? {
            MeshFormat::Stl => stl::read(bytes),
            MeshFormat::Obj => obj::read(bytes),
            MeshFormat::Collada => collada::read(bytes)?.into_file(),
            MeshFormat::Msh => msh::read(bytes),
            MeshFormat::Ply => ply::read(bytes),
            MeshFormat::Gltf => gltf::read(bytes, folder(path))?.into_file(),
        }?;
        let objects = &mut file.objects;
        objects.retain(|object| !object.points.is_empty());
        if objects.iter().any(|object| !object.triangles.is_empty()) {
            objects.retain(|object| !object.triangles.is_empty());
            return Ok(file);
        }
        if objects.is_empty() {
            let (line, fault) = (None, FormatFault::Empty);
            return Err(Fault { line, fault });
        }
        if !takes_points {
            let what = "a point cloud (vertices without faces) as a mesh";
            return Err(Fault::unsupported(None, what));
        }
        for (k, point) in objects.iter().flat_map(|object| &object.points).enumerate() {
            if !point.iter().all(|x| x.is_finite()) {
                let why = format!("vertex {k} is not finite: {point:?} (expected finite numbers)");
                return Err(Fault::malformed(None, why));
            }
        }
        Ok(file)
    }
}

impl MeshScene {
    pub(crate) fn read(bytes: &[u8], path: &Path) -> Result<Self, Fault> {
        let placed = match format_of_mesh(bytes, path)? {
            MeshFormat::Collada => collada::read(bytes)?,
            MeshFormat::Gltf => gltf::read(bytes, folder(path))?,
            _ => return MeshFile::read(bytes, path, false).map(Self::from),
        };
        if placed.places.is_empty() {
            let (line, fault) = (None, FormatFault::Empty);
            return Err(Fault { line, fault });
        }
        Ok(placed.into_scene())
    }
}

/// Returns the folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Returns the format of a file: by its content, or else by its extension.
fn format_of_mesh(bytes: &[u8], path: &Path) -> Result<MeshFormat, Fault> {
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

impl PointFile {
    /// Returns the points of a file, without those that are not finite.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, has no known format, is malformed, contains
    /// coordinates of a type that is not supported, or contains no finite point.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        Self::read_with(path, Invalid::Drop)
    }

    /// As [`read`](Self::read), with a choice of what happens to points that are not finite.
    ///
    /// # Errors
    /// As [`read`](Self::read), and [`FormatFault::Invalid`] for the first point that is refused.
    pub fn read_with(path: impl AsRef<Path>, invalid: Invalid) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let bytes = FormatError::read(path)?;
        Self::parse_with(&bytes, path, invalid)
    }

    /// Returns the points of the bytes of a file, without those that are not finite. Errors name the
    /// file `path`; its extension matters if the content does not decide the format.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, FormatError> {
        Self::parse_with(bytes, path, Invalid::Drop)
    }

    /// As [`parse`](Self::parse), with a choice of what happens to points that are not finite.
    ///
    /// # Errors
    /// As [`read_with`](Self::read_with).
    pub fn parse_with(bytes: &[u8], path: impl AsRef<Path>, invalid: Invalid) -> Result<Self, FormatError> {
        let path = path.as_ref();
        read_points(bytes, path, invalid).map_err(|fault| fault.of(path))
    }
}

fn read_points(bytes: &[u8], path: &Path, invalid: Invalid) -> Result<PointFile, Fault> {
    let format = format_of_points(bytes, path)?;
    let mut list = PointList::new(invalid);
    match format {
        PointFormat::Ply => ply::read_points(bytes, &mut list),
        PointFormat::Pcd => pcd::read(bytes, &mut list),
        PointFormat::Xyz => xyz::read(bytes, &mut list),
        PointFormat::Npy => npy::read(bytes, &mut list),
    }?;
    list.build(format)
}

/// Returns the format of a file: by its content, or else by its extension.
fn format_of_points(bytes: &[u8], path: &Path) -> Result<PointFormat, Fault> {
    let unknown = |why: &str| Fault {
        line: None,
        fault: FormatFault::Unknown(why.into()),
    };
    if bytes.starts_with(b"PK\x03\x04") {
        return Err(unknown(
            "the file is an archive, such as .npz (expected one array: .npy)",
        ));
    }
    if let Some(why) = text::foreign(bytes) {
        return Err(unknown(why));
    }
    let start = text::start(bytes);
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    Ok(match extension.as_deref() {
        _ if bytes.starts_with(npy::MAGIC) => PointFormat::Npy,
        _ if text::first_line(&start).eq_ignore_ascii_case("ply") => PointFormat::Ply,
        _ if pcd::is_start(&start) => PointFormat::Pcd,
        Some("ply") => PointFormat::Ply,
        Some("pcd") => PointFormat::Pcd,
        Some("npy") => PointFormat::Npy,
        Some("xyz" | "xyzn" | "xyzrgb" | "asc" | "pts" | "txt" | "csv") => PointFormat::Xyz,
        _ => {
            return Err(unknown(
                "unknown file extension (expected .ply, .pcd, .xyz, .txt, .csv or .npy)",
            ));
        }
    })
}

impl Grid {
    /// Returns the grid of a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is malformed, if it is an array of other than
    /// two axes, if rows differ in length, if there is no number, or if a number is not finite.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let bytes = FormatError::read(path)?;
        Self::parse(&bytes, path)
    }

    /// Returns the grid of the bytes of a file. Errors name the file `path`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let is_array = bytes.starts_with(npy::MAGIC);
        let found = match (is_array, text::foreign(bytes)) {
            (true, _) => npy::read_grid(bytes),
            (false, None) => grid::read_text(bytes),
            (false, Some(why)) => Err(Fault::malformed(None, why)),
        };
        found.and_then(Self::checked).map_err(|fault| fault.of(path.as_ref()))
    }
}
