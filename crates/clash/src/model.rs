//! The parts of a model, from mesh files and cells.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Geometry, Mesh, MeshError, MeshKind, RepairOptions};
use lin_canny_formats::{MeshFormat, MeshObject, MeshScene};
use lin_canny_robot::plan::{Cell, CellBody, CellPair, Checker, PlanError};
use lin_canny_robot::{CellFile, LoadOptions, MeshUse, Packages, RobotFiles, Skipped};

use crate::error::ClashError;

/// Largest share of caps in the area of a part that is a solid after its repair.
const CAPS: f64 = 0.01;

/// Largest difference of an entry of the square of a rotation from that of the identity: the rounding of a
/// chain of nodes. A map that differs more changes the shape of a mesh.
const RIGID: f64 = 1e-14;

/// Number of shapes of one mesh that an instance is compared with, the latest ones.
const SHAPES: usize = 16;

/// Extensions of mesh files, without a dot.
const MESHES: [&str; 7] = ["stl", "obj", "dae", "ply", "gltf", "glb", "msh"];

/// Extensions of robot files, without a dot.
const ROBOTS: [&str; 3] = ["urdf", "xml", "mjcf"];

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
    /// Values of joints of the robot that is read, by their names, in radians or metres. Other joints are
    /// where the file draws them.
    pub joints: Vec<(String, f64)>,
    /// The SRDF of the robot that is read: the link pairs that it disables are excluded.
    pub srdf: Option<PathBuf>,
}

impl Default for ModelOptions {
    fn default() -> Self {
        Self {
            unit: Unit::default(),
            repair: true,
            keep_going: false,
            joints: Vec::new(),
            srdf: None,
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

    /// Sets [`joints`](Self::joints).
    #[must_use]
    pub fn joints(self, joints: impl IntoIterator<Item = (String, f64)>) -> Self {
        let joints = joints.into_iter().collect();
        Self { joints, ..self }
    }

    /// Sets [`srdf`](Self::srdf).
    #[must_use]
    pub fn srdf(self, srdf: Option<PathBuf>) -> Self {
        Self { srdf, ..self }
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
    /// Pairs of parts that are not looked at, the smaller number first, with the reason.
    excluded: HashMap<(usize, usize), String>,
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

    /// Excludes the pair of two parts, by their numbers in [`parts`](Self::parts), with the reason.
    pub fn exclude(&mut self, a: usize, b: usize, reason: &str) {
        self.excluded.insert((a.min(b), a.max(b)), reason.to_owned());
    }

    /// Returns the reason why a pair of parts is excluded, if it is.
    #[must_use]
    pub fn exclusion(&self, a: usize, b: usize) -> Option<&str> {
        self.excluded.get(&(a.min(b), a.max(b))).map(String::as_str)
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
    /// * **A mesh file** (STL, OBJ, COLLADA, PLY, glTF, MSH): each object, or node of a scene, is a part. Nodes
    ///   of one mesh share it; a transform that mirrors, scales or shears is applied to the vertices.
    /// * **A folder**: all mesh files below it.
    /// * **A cell file** (JSON or SDFormat): its obstacles are parts. A mesh is its triangles, closed if
    ///   [`repair`](ModelOptions::repair) is set, unless the file says otherwise. Objects that links carry are
    ///   left out: they have no place without the robot.
    /// * **A robot** (URDF, MJCF): its links are parts, where [`joints`](ModelOptions::joints) puts them.
    ///   Bodies of one link, of adjacent links and the pairs that an [`srdf`](ModelOptions::srdf) excludes are
    ///   excluded.
    ///
    /// The name of a part is the path of its file below the folder, without extension, and the name of the
    /// object if a file has several. Parts of a single file have the names of its objects. The name of a node
    /// is its path in the scene, such as `frame/left/bolt`.
    ///
    /// # Errors
    /// Returns the error of the first file that cannot be read or holds no mesh, unless
    /// [`keep_going`](ModelOptions::keep_going) is set; and an error if there is no file at all, or if joints
    /// or an SRDF are given and the inputs do not hold exactly one robot.
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
        let extension = |file: &Path| file.extension().map(|e| e.to_string_lossy().to_lowercase());
        let is_robot = |file: &Path| extension(file).is_some_and(|e| ROBOTS.contains(&e.as_str()));
        let robots = files.iter().filter(|(_, file)| is_robot(file)).count();
        if robots != 1 && !(options.joints.is_empty() && options.srdf.is_none()) {
            return Err(ClashError::NotOneRobot(robots));
        }
        let mut model = Self::new();
        for (folder, file) in &files {
            let prefix = (files.len() > 1).then(|| name_of(folder, file));
            let added = match extension(file).as_deref() {
                Some("json" | "sdf" | "world") => model.add_cell(file, prefix.as_deref(), options),
                _ if is_robot(file) => model.add_robot(file, prefix.as_deref(), options),
                _ => model.add_file(file, prefix.as_deref(), options),
            };
            match added {
                Err(error) if options.keep_going => model.failures.push(error),
                added => added?,
            }
        }
        Ok(model)
    }

    /// Adds the nodes of a mesh file.
    fn add_file(&mut self, file: &Path, prefix: Option<&str>, options: &ModelOptions) -> Result<(), ClashError> {
        let read = MeshScene::load(file)?;
        let scale = match read.format {
            MeshFormat::Gltf | MeshFormat::Collada => options.unit.per_metre(),
            _ => 1.0,
        };
        let is_one = read.nodes.len() == 1;
        let mut shapes: Vec<Vec<Shape>> = read.meshes.iter().map(|_| Vec::new()).collect();
        for (k, node) in read.nodes.iter().enumerate() {
            let own = if node.name.is_empty() {
                format!("object{k}")
            } else {
                node.name.clone()
            };
            let stem = || name_of(Path::new(""), file);
            let name = match prefix {
                Some(prefix) if is_one => prefix.to_owned(),
                Some(prefix) => format!("{prefix}/{own}"),
                None if node.name.is_empty() && is_one => stem(),
                None => own,
            };
            let transform = node.transform.map(|row| row.map(|x| x * scale));
            let invalid = |reason| ClashError::Part {
                file: file.to_owned(),
                part: name.clone(),
                reason,
            };
            let known = &mut shapes[node.mesh];
            let (shape, pose) =
                Shape::at(&read.meshes[node.mesh], &transform, known, options.repair).map_err(invalid)?;
            // A copy of the geometry shares the mesh.
            let (geometry, note) = (shape.geometry.clone(), shape.note.clone());
            self.add(&name, geometry, pose);
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

    /// Adds the links of a robot.
    fn add_robot(&mut self, file: &Path, prefix: Option<&str>, options: &ModelOptions) -> Result<(), ClashError> {
        if options.unit != Unit::Metre {
            return Err(ClashError::Unit(file.to_owned()));
        }
        let meshes = if options.repair { MeshUse::Solid } else { MeshUse::Mesh };
        let mut files = RobotFiles::new(file);
        files.srdf.clone_from(&options.srdf);
        files.options = LoadOptions::default().meshes(meshes);
        let loaded = files.load()?;
        self.skipped.extend(loaded.skipped);
        let mut configuration = loaded.robot.start().to_vec();
        let coordinates = loaded.robot.coordinates();
        for (joint, value) in &options.joints {
            let Some(k) = coordinates.iter().position(|c| c.name == *joint) else {
                let names = coordinates.iter().map(|c| c.name.as_str());
                return Err(ClashError::Joint {
                    file: file.to_owned(),
                    joint: joint.clone(),
                    known: names.collect::<Vec<_>>().join(", "),
                });
            };
            configuration[k] = *value;
        }
        self.add_cell_at(loaded.cell, prefix, &configuration)
            .map_err(|reason| ClashError::Robot {
                file: file.to_owned(),
                reason,
            })
    }

    /// Adds the bodies of a cell with robots at a configuration. Pairs that the cell excludes are excluded,
    /// and those of one link.
    ///
    /// # Errors
    /// Returns an error if the configuration has another length, or a value that is not finite.
    pub fn add_cell_at(&mut self, cell: Cell, prefix: Option<&str>, configuration: &[f64]) -> Result<(), PlanError> {
        let checker = Checker::of_robots(cell)?;
        let cell = checker.cell();
        let mut added: Vec<(CellBody, usize)> = Vec::new();
        for (id, name) in cell.bodies() {
            let Some(geometry) = cell.geometry(id) else {
                continue;
            };
            let pose = checker.pose(id, configuration)?;
            let name = match prefix {
                Some(prefix) => format!("{prefix}/{name}"),
                None => name.to_owned(),
            };
            self.add(&name, geometry.clone(), pose);
            added.push((id, self.parts.len() - 1));
        }
        for (k, &(a, i)) in added.iter().enumerate() {
            for &(b, j) in &added[k + 1..] {
                let reason = CellPair::new(a, b).and_then(|pair| cell.exclusion(pair));
                let is_link = |id| matches!(id, CellBody::Robot(_));
                let is_one_link = is_link(a) && is_link(b) && cell.name(a) == cell.name(b);
                if is_one_link {
                    self.exclude(i, j, "one link");
                } else if let Some(reason) = reason {
                    self.exclude(i, j, reason);
                }
            }
        }
        Ok(())
    }
}

/// A mesh of a file, as some of its nodes have it: scaled or sheared, but not turned.
struct Shape {
    /// The map that was applied to the vertices.
    linear: Matrix3<f64>,
    geometry: Geometry,
    note: Option<String>,
}

impl Shape {
    /// Returns the shape of a node and its pose: one that is known if a rotation takes it to the node.
    fn at<'a>(
        object: &MeshObject,
        transform: &[[f64; 4]; 3],
        known: &'a mut Vec<Self>,
        is_repaired: bool,
    ) -> Result<(&'a Self, Isometry3<f64>), MeshError> {
        let linear = Matrix3::from_fn(|i, k| transform[i][k]);
        let position = Translation3::from(Vector3::from(transform.map(|row| row[3])));
        let latest = known.len().saturating_sub(SHAPES);
        let mut found = None;
        for (k, shape) in known.iter().enumerate().skip(latest) {
            let inverse = shape.linear.try_inverse();
            if let Some(rotation) = inverse.and_then(|inverse| rotation(&(linear * inverse))) {
                found = Some((k, rotation));
                break;
            }
        }
        let (k, rotation) = match found {
            Some(found) => found,
            None => {
                // A scale and a rotation: the scale is applied to the vertices.
                let scale = linear.column(0).norm();
                let (linear, rotation) = match rotation(&(linear / scale)) {
                    Some(rotation) => (Matrix3::from_diagonal_element(scale), rotation),
                    None => (linear, UnitQuaternion::identity()),
                };
                let points: Vec<Point3<f64>> = object.points.iter().map(|p| linear * Point3::from(*p)).collect();
                let mut triangles = object.triangles.clone();
                // Scaled first, so that the product stays in range.
                if (linear / linear.amax()).determinant() < 0.0 {
                    triangles.iter_mut().for_each(|t| t.swap(1, 2));
                }
                let (mesh, note) = meshed(&points, &triangles, is_repaired)?;
                let geometry = mesh.into();
                known.push(Self { linear, geometry, note });
                (known.len() - 1, rotation)
            }
        };
        Ok((&known[k], Isometry3::from_parts(position, rotation)))
    }
}

/// Returns the rotation of a matrix that is one up to rounding.
fn rotation(matrix: &Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let apart = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    let is_rotation = apart <= RIGID && matrix.determinant() > 0.0;
    is_rotation.then(|| UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*matrix)))
}

/// Returns the mesh of a part, and what was done to it.
fn meshed(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    is_repaired: bool,
) -> Result<(Mesh, Option<String>), MeshError> {
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
