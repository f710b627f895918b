//! The parts of a model, from mesh files and cells.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Geometry, Mesh, MeshKind, RepairOptions};
use lin_canny_formats::{MeshFile, MeshFormat};
use lin_canny_robot::{CellFile, LoadOptions, MeshUse, Packages, Skipped};

use crate::error::ClashError;

/// Largest share of caps in the area of a part that is a solid after its repair.
const CAPS: f64 = 0.01;

/// Extensions of mesh files, without a dot.
const MESHES: [&str; 7] = ["stl", "obj", "dae", "ply", "gltf", "glb", "msh"];

/// The unit of lengths in files without one, and in all results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// Metres.
    #[default]
    Metre,
    /// Millimetres.
    Millimetre,
    /// Inches of 25.4 millimetres.
    Inch,
}

impl Unit {
    /// Returns the number of units in a metre.
    pub(crate) fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 1000.0,
            Self::Inch => 1000.0 / 25.4,
        }
    }
}

/// How a model is read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelOptions {
    /// The unit of STL, OBJ, PLY and MSH, which have none, and of all results.
    ///
    /// Lengths of glTF and COLLADA are metres, and are converted. Cell files are read in metres alone.
    pub unit: Unit,
    /// Whether open meshes are repaired: cracks of equal points are welded, inverted triangles turned and
    /// holes closed. A part whose caps would be more than a hundredth of its area stays a surface.
    pub repair: bool,
    /// Whether files that cannot be read are left out and listed in [`Model::failures`].
    pub keep_going: bool,
}

impl Default for ModelOptions {
    fn default() -> Self {
        Self {
            unit: Unit::default(),
            repair: true,
            keep_going: false,
        }
    }
}

impl ModelOptions {
    /// Sets [`unit`](Self::unit).
    #[must_use]
    pub fn unit(self, unit: Unit) -> Self {
        Self { unit, ..self }
    }

    /// Sets [`repair`](Self::repair).
    #[must_use]
    pub fn repair(self, repair: bool) -> Self {
        Self { repair, ..self }
    }

    /// Sets [`keep_going`](Self::keep_going).
    #[must_use]
    pub fn keep_going(self, keep_going: bool) -> Self {
        Self { keep_going, ..self }
    }
}

/// A part: a geometry at its place.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Part {
    /// The name, which no other part of the model has.
    pub name: String,
    /// The geometry in its own frame.
    pub geometry: Geometry,
    /// The place in the model.
    pub pose: Isometry3<f64>,
    /// What was done to the mesh, or why it has no inside; `None` for a solid that was read as it is.
    pub note: Option<String>,
}

/// The parts of a model.
#[derive(Debug, Default)]
pub struct Model {
    parts: Vec<Part>,
    /// The names, and how many parts asked for each.
    names: HashMap<String, usize>,
    failures: Vec<ClashError>,
    skipped: Vec<Skipped>,
}

impl Model {
    /// Returns a model without parts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part. A name that another part has gets a number: the second `bolt` is `bolt#2`.
    pub fn add(&mut self, name: &str, geometry: impl Into<Geometry>, pose: Isometry3<f64>) -> &Part {
        let mut unique = name.to_owned();
        while self.names.contains_key(&unique) {
            let count = self.names.entry(name.to_owned()).or_insert(1);
            *count += 1;
            unique = format!("{name}#{count}");
        }
        self.names.insert(unique.clone(), 1);
        self.parts.push(Part {
            name: unique,
            geometry: geometry.into(),
            pose,
            note: None,
        });
        &self.parts[self.parts.len() - 1]
    }

    /// Returns the parts, in the order in which they were added.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the errors of the files that were left out.
    #[must_use]
    pub fn failures(&self) -> &[ClashError] {
        &self.failures
    }

    /// Returns what cell files name and the model does not hold, such as bodies that could not be read.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Returns the model of files and folders.
    ///
    /// * **A mesh file** (STL, OBJ, COLLADA, PLY, glTF, MSH): each object is a part. Nodes of a glTF are
    ///   objects; a transform that mirrors or scales is applied to the vertices.
    /// * **A folder**: all mesh files below it.
    /// * **A cell file** (JSON or SDFormat): its obstacles are parts. A mesh is its triangles, closed if
    ///   [`repair`](ModelOptions::repair) is set, unless the file says otherwise. Objects that links carry are
    ///   left out: they have no place without the robot.
    ///
    /// The name of a part is the path of its file below the folder, without extension, and the name of the
    /// object if a file has several. Parts of a single file have the names of its objects.
    ///
    /// # Errors
    /// Returns the error of the first file that cannot be read or holds no mesh, unless
    /// [`keep_going`](ModelOptions::keep_going) is set; and an error if there is no file at all.
    pub fn load(inputs: &[PathBuf], options: &ModelOptions) -> Result<Self, ClashError> {
        let mut files = Vec::new();
        for input in inputs {
            let folder = if input.is_dir() { input.as_path() } else { Path::new("") };
            let below = match input.is_dir() {
                true => meshes_below(input)?,
                false => vec![input.clone()],
            };
            files.extend(below.into_iter().map(|file| (folder.to_owned(), file)));
        }
        if files.is_empty() {
            return Err(ClashError::NoParts);
        }
        let mut model = Self::new();
        for (folder, file) in &files {
            let prefix = (files.len() > 1).then(|| name_of(folder, file));
            let added = match file.extension().and_then(|e| e.to_str()) {
                Some("json" | "sdf" | "world") => model.add_cell(file, prefix.as_deref(), options),
                _ => model.add_file(file, prefix.as_deref(), options),
            };
            match added {
                Err(error) if options.keep_going => model.failures.push(error),
                added => added?,
            }
        }
        Ok(model)
    }

    /// Adds the objects of a mesh file.
    fn add_file(&mut self, file: &Path, prefix: Option<&str>, options: &ModelOptions) -> Result<(), ClashError> {
        let read = MeshFile::load(file)?;
        let scale = match read.format {
            MeshFormat::Gltf | MeshFormat::Collada => options.unit.per_metre(),
            _ => 1.0,
        };
        let is_one = read.objects.len() == 1;
        for (k, object) in read.objects.iter().enumerate() {
            let own = if object.name.is_empty() {
                format!("object{k}")
            } else {
                object.name.clone()
            };
            let stem = || name_of(Path::new(""), file);
            let name = match prefix {
                Some(prefix) if is_one => prefix.to_owned(),
                Some(prefix) => format!("{prefix}/{own}"),
                None if object.name.is_empty() && is_one => stem(),
                None => own,
            };
            let points: Vec<_> = object
                .points
                .iter()
                .map(|p| Point3::from(p.map(|x| x * scale)))
                .collect();
            let invalid = |reason| ClashError::Part {
                file: file.to_owned(),
                part: name.clone(),
                reason,
            };
            let (mesh, note) = meshed(&points, &object.triangles, options.repair).map_err(invalid)?;
            self.add(&name, mesh, Isometry3::identity());
            if let Some(part) = self.parts.last_mut() {
                part.note = note;
            }
        }
        Ok(())
    }

    /// Adds the bodies of a cell file.
    fn add_cell(&mut self, file: &Path, prefix: Option<&str>, options: &ModelOptions) -> Result<(), ClashError> {
        if options.unit != Unit::Metre {
            return Err(ClashError::Unit(file.to_owned()));
        }
        let packages = Packages::default().with_environment();
        let meshes = if options.repair { MeshUse::Solid } else { MeshUse::Mesh };
        let cell = CellFile::load(file, &packages, &LoadOptions::default().meshes(meshes))?;
        self.skipped.extend(cell.skipped.iter().cloned());
        for obstacle in &cell.obstacles {
            let name = match prefix {
                Some(prefix) => format!("{prefix}/{}", obstacle.name),
                None => obstacle.name.clone(),
            };
            self.add(&name, obstacle.geometry.clone(), obstacle.pose);
        }
        Ok(())
    }
}

/// Returns the mesh of a part, and what was done to it.
fn meshed(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    is_repaired: bool,
) -> Result<(Mesh, Option<String>), lin_canny::MeshError> {
    let mesh = Mesh::new(points, triangles)?;
    if mesh.kind() == MeshKind::Solid {
        return Ok((mesh, None));
    }
    let edges = mesh.report().boundary_edges.len() + mesh.report().misoriented_edges.len();
    let surface = |why: String| format!("a surface without inside: {why}");
    if !is_repaired {
        return Ok((mesh, Some(surface(format!("{edges} edges are open or inverted")))));
    }
    let solid = Mesh::repaired(points, triangles, &RepairOptions::default())?;
    let repair = solid.report().repair.as_deref().cloned().unwrap_or_default();
    if repair.is_empty || repair.cap_share > CAPS {
        let why = match repair.is_empty {
            true => "its triangles enclose nothing".to_owned(),
            false => format!("its holes are {:.1} % of its area", 100.0 * repair.cap_share),
        };
        return Ok((mesh, Some(surface(why))));
    }
    Ok((solid, Some(format!("repaired: {repair}"))))
}

/// Returns the path of a file below a folder, without its extension, with slashes.
fn name_of(folder: &Path, file: &Path) -> String {
    let below = match folder.as_os_str().is_empty() {
        true => Path::new(file.file_name().unwrap_or_default()),
        false => file.strip_prefix(folder).unwrap_or(file),
    };
    let parts: Vec<_> = below
        .with_extension("")
        .components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    parts.join("/")
}

/// Returns the mesh files below a folder, in the order of their names.
fn meshes_below(folder: &Path) -> Result<Vec<PathBuf>, ClashError> {
    let failed = |reason| ClashError::Folder {
        folder: folder.to_owned(),
        reason,
    };
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        entries.push(entry.map_err(failed)?.path());
    }
    entries.sort();
    let mut files = Vec::new();
    for entry in entries {
        let extension = entry.extension().map(|e| e.to_string_lossy().to_lowercase());
        // Links are not followed, so that no folder is in itself.
        if entry.is_dir() && !entry.is_symlink() {
            files.extend(meshes_below(&entry)?);
        } else if extension.is_some_and(|e| MESHES.contains(&e.as_str())) {
            files.push(entry);
        }
    }
    Ok(files)
}
