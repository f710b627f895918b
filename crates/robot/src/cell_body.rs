//! Bodies of a JSON file: obstacles of a cell, and objects that are attached to a link.

use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Cloud, CloudElement, Geometry, HalfSpace, Mesh, RelativePose, normalize_rotation};
use lin_canny_formats::{Grid, Invalid, PointFile, Points};
use lin_canny_plan::{Cell, CellBody, PlanError, TimedPoses};
use serde::de::{Deserialize as _, Deserializer, Error as _};

use crate::error::{FileError, FileErrorKind, Skipped};
use crate::geometry::{self, Solid};
use crate::mesh_file::MeshPlacing;
use crate::options::{LoadOptions, MeshUse};
use crate::packages::Packages;
use crate::pose_file::{self, PoseRow};
use crate::text::check_content;
use crate::turn::{from_xyzw, roll_pitch_yaw};

/// Names of the shapes of a body, for errors.
const SHAPES: &str = "box, cylinder, capsule, sphere, ellipsoid, cone, mesh, cloud, voxels, half_space, heights \
                      or geometry";

/// An object that is attached to a link, from a JSON file.
///
/// The file is a body of a [`CellFile`](crate::CellFile), in the frame of the link, with the links that the
/// object may touch:
///
/// ```json
/// {"name": "part", "box": {"size": [0.05, 0.05, 0.1]}, "xyz": [0, 0, 0.12], "touch_links": ["hand", "left finger"]}
/// ```
///
/// A [`HalfSpace`] cannot be attached.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct AttachedBody {
    /// Name of the object.
    pub name: String,
    /// Geometry, in the frame of the object.
    pub geometry: Geometry,
    /// Pose in the frame of the link.
    pub pose: Isometry3<f64>,
    /// Names of the links whose pairs with the object are excluded.
    pub touch_links: Vec<String>,
    /// What the files hold besides the geometry, such as points without a return.
    pub skipped: Vec<Skipped>,
}

impl AttachedBody {
    /// Returns the object of a JSON file. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or the body is invalid.
    pub fn load(path: impl AsRef<Path>, packages: &Packages, options: &LoadOptions) -> Result<Self, FileError> {
        let path = path.as_ref();
        let text = FileError::read(path)?;
        check_content(&text).map_err(|reason| FileError::new(path, Some(1), "", reason))?;
        let body: BodyText = parse_json(&text, path)?;
        let element = format!("{:?}", body.name);
        Self::from_text(body, element, path, packages, options)
    }

    /// Attaches the object to a link of a cell: see [`Cell::attach`].
    ///
    /// # Errors
    /// As [`Cell::attach`].
    pub fn attach_to(&self, cell: &mut Cell, link: &str) -> Result<CellBody, PlanError> {
        let touch: Vec<&str> = self.touch_links.iter().map(String::as_str).collect();
        cell.attach(link, &self.name, self.geometry.clone(), self.pose, &touch)
    }

    /// Returns the object of a body of a file. Errors name the element.
    pub(crate) fn from_text(
        body: BodyText,
        element: String,
        path: &Path,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        let wrong = |reason| FileError::new(path, None, element.clone(), reason);
        if body.poses.is_some() {
            let what = "poses of an attached object (expected in an obstacle of a cell)";
            return Err(wrong(FileErrorKind::Unsupported(what.into())));
        }
        let pose = body.pose().map_err(wrong)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut notes = Vec::new();
        let geometry = body.geometry(folder, packages, options, &mut notes).map_err(wrong)?;
        let skipped = notes
            .into_iter()
            .map(|note| wrong(FileErrorKind::Malformed(note)).into());
        Ok(Self {
            geometry,
            pose,
            skipped: skipped.collect(),
            name: body.name,
            touch_links: body.touch_links.unwrap_or_default(),
        })
    }
}

/// Parses a JSON text; errors name the line.
pub(crate) fn parse_json<T: for<'a> serde::Deserialize<'a>>(text: &str, path: &Path) -> Result<T, FileError> {
    serde_json::from_str(text).map_err(|e| {
        let line = (e.line() > 0).then_some(e.line() as u32);
        FileError::new(path, line, "", FileErrorKind::Malformed(e.to_string()))
    })
}

/// Reads exactly `N` numbers. The parser has no word for a list that is too long.
fn exactly<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<[f64; N], D::Error> {
    let numbers = Vec::<f64>::deserialize(deserializer)?;
    let count = numbers.len();
    let wrong = |_| D::Error::custom(format!("list of {count} numbers (expected {N})"));
    numbers.try_into().map_err(wrong)
}

fn exactly_if_given<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<Option<[f64; N]>, D::Error> {
    let Some(numbers) = Option::<Vec<f64>>::deserialize(deserializer)? else {
        return Ok(None);
    };
    exactly(serde::de::value::SeqDeserializer::new(numbers.into_iter())).map(Some)
}

/// A body of a cell, or an attached object.
#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyText {
    /// The name; the second body of one name is `name#2` in the cell.
    pub(crate) name: String,
    /// A box about the origin.
    #[serde(rename = "box")]
    block: Option<BlockText>,
    /// A cylinder along z, about the origin.
    cylinder: Option<RoundText>,
    /// A capsule along z, about the origin; the length is that of its axis.
    capsule: Option<RoundText>,
    /// A ball about the origin.
    sphere: Option<SphereText>,
    /// An ellipsoid about the origin.
    ellipsoid: Option<EllipsoidText>,
    /// A cone along z with its apex above, about the origin.
    cone: Option<RoundText>,
    /// A mesh of a file.
    mesh: Option<MeshText>,
    /// A ball or a box about each of many points.
    cloud: Option<CloudText>,
    /// Cells of a grid.
    voxels: Option<VoxelsText>,
    /// The points x with `normal . x <= offset`.
    half_space: Option<HalfSpaceText>,
    /// A height field.
    heights: Option<HeightsText>,
    /// Any geometry, in the form in which lin-canny serialises it.
    #[cfg_attr(test, schemars(with = "Option<serde_json::Value>"))]
    geometry: Option<Geometry>,
    /// The position: in the world, or of an attached object in the frame of its link.
    #[serde(default, deserialize_with = "exactly_if_given")]
    xyz: Option<[f64; 3]>,
    /// Roll, pitch and yaw in radians.
    #[serde(default, deserialize_with = "exactly_if_given")]
    rpy: Option<[f64; 3]>,
    /// The rotation as a quaternion, instead of `rpy`.
    #[serde(default, deserialize_with = "exactly_if_given")]
    xyzw: Option<[f64; 4]>,
    /// Poses at times of an obstacle that moves, instead of `xyz`, `rpy` and `xyzw`.
    pub(crate) poses: Option<PosesText>,
    /// Links that an attached object may touch.
    pub(crate) touch_links: Option<Vec<String>>,
}

#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct BlockText {
    #[serde(deserialize_with = "exactly")]
    pub(crate) size: [f64; 3],
}

#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct RoundText {
    pub(crate) radius: f64,
    pub(crate) length: f64,
}

#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct SphereText {
    pub(crate) radius: f64,
}

#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct EllipsoidText {
    #[serde(deserialize_with = "exactly")]
    pub(crate) radii: [f64; 3],
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct MeshText {
    /// A path, relative to the folder of this file, or `package://` or `file://`.
    file: String,
    /// Factors along x, y and z.
    #[serde(default, deserialize_with = "exactly_if_given")]
    scale: Option<[f64; 3]>,
    /// The body that is made of the mesh.
    #[serde(rename = "as")]
    usage: Option<MeshUse>,
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct CloudText {
    /// A file of points: PLY, PCD, XYZ or npy.
    file: Option<String>,
    /// The points, instead of a file.
    points: Option<Vec<[f64; 3]>>,
    /// The radius of a ball about each point.
    radius: Option<f64>,
    /// The box about each point, instead of a radius.
    #[serde(rename = "box")]
    block: Option<BlockText>,
    /// A factor of the points.
    scale: Option<f64>,
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct VoxelsText {
    /// A file of indices.
    file: Option<String>,
    /// The indices of the filled cells, instead of a file.
    indices: Option<Vec<[f64; 3]>>,
    /// The size of a cell: one number or three.
    size: SizeText,
    /// The least corner of the cell with the indices 0, 0, 0.
    #[serde(default, deserialize_with = "exactly")]
    origin: [f64; 3],
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
enum SizeText {
    Cube(f64),
    Box([f64; 3]),
}

/// Timed poses: a CSV file, or rows of time, position and quaternion.
#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(crate) enum PosesText {
    File(String),
    Rows(Vec<PoseRow>),
}

#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct HalfSpaceText {
    #[serde(deserialize_with = "exactly")]
    pub(crate) normal: [f64; 3],
    #[serde(default)]
    pub(crate) offset: f64,
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct HeightsText {
    /// A file of heights: rows of numbers, or an npy array of two axes.
    file: Option<String>,
    /// The heights, instead of a file: value `[i][j]` is at `(i, j)` times the spacing.
    values: Option<Vec<Vec<f64>>>,
    /// The spacing along x and y.
    #[serde(deserialize_with = "exactly")]
    spacing: [f64; 2],
    /// The body is solid down to this height; an open surface without it.
    base: Option<f64>,
}

impl BodyText {
    /// Returns the geometry. Notes say what the files hold besides it.
    pub(crate) fn geometry(
        &self,
        folder: &Path,
        packages: &Packages,
        options: &LoadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Geometry, FileErrorKind> {
        let files = Files {
            folder,
            packages,
            options,
        };
        let mut found = Vec::new();
        if let Some(BlockText { size }) = self.block {
            found.push(Solid::Box { size }.geometry());
        }
        if let Some(RoundText { radius, length }) = self.cylinder {
            found.push(Solid::Cylinder { radius, length }.geometry());
        }
        if let Some(RoundText { radius, length }) = self.capsule {
            found.push(Solid::Capsule { radius, length }.geometry());
        }
        if let Some(SphereText { radius }) = self.sphere {
            found.push(Solid::Sphere { radius }.geometry());
        }
        if let Some(EllipsoidText { radii }) = self.ellipsoid {
            found.push(Solid::Ellipsoid { radii }.geometry());
        }
        if let Some(RoundText { radius, length }) = self.cone {
            found.push(Solid::Cone { radius, length }.geometry());
        }
        if let Some(mesh) = &self.mesh {
            found.push(files.mesh(mesh));
        }
        if let Some(cloud) = &self.cloud {
            found.push(files.cloud(cloud, notes));
        }
        if let Some(voxels) = &self.voxels {
            found.push(files.voxels(voxels));
        }
        if let Some(HalfSpaceText { normal, offset }) = self.half_space {
            let space = HalfSpace::new(Vector3::from(normal), offset);
            found.push(space.map(Geometry::from).map_err(wrong));
        }
        if let Some(heights) = &self.heights {
            found.push(files.heights(heights));
        }
        if let Some(geometry) = &self.geometry {
            found.push(Ok(geometry.clone()));
        }
        match found.len() {
            0 => Err(FileErrorKind::Missing(SHAPES.into())),
            1 => found.remove(0),
            _ => Err(FileErrorKind::Malformed(
                "body has several shapes (expected one)".into(),
            )),
        }
    }

    /// Takes the timed poses of a body that moves.
    pub(crate) fn take_poses(
        &mut self,
        element: &str,
        path: &Path,
        packages: &Packages,
    ) -> Result<Option<TimedPoses>, FileError> {
        let wrong = |reason| FileError::new(path, None, element, reason);
        let Some(poses) = self.poses.take() else {
            return Ok(None);
        };
        if self.xyz.is_some() || self.rpy.is_some() || self.xyzw.is_some() {
            let reason = "both poses and xyz, rpy or xyzw are given (expected one)";
            return Err(wrong(FileErrorKind::Malformed(reason.into())));
        }
        match poses {
            PosesText::Rows(rows) => pose_file::of_rows(&rows).map_err(wrong).map(Some),
            PosesText::File(name) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                pose_file::load(&packages.find(&name, folder).map_err(wrong)?).map(Some)
            }
        }
    }

    /// Returns the pose. A quaternion that a checker takes as it is keeps its bits.
    pub(crate) fn pose(&self) -> Result<Isometry3<f64>, FileErrorKind> {
        let placed =
            |turn| Isometry3::from_parts(Translation3::from(Vector3::from(self.xyz.unwrap_or_default())), turn);
        let turn = match (self.rpy, self.xyzw) {
            (Some(_), Some(_)) => {
                return Err(FileErrorKind::Malformed(
                    "both rpy and xyzw are given (expected at most one)".into(),
                ));
            }
            (Some(rpy), None) => roll_pitch_yaw(rpy),
            (None, Some(xyzw)) => {
                let given = placed(UnitQuaternion::new_unchecked(Quaternion::from(xyzw)));
                if RelativePose::from_isometry(&given).is_ok() {
                    return Ok(given);
                }
                from_xyzw(xyzw).ok_or_else(|| FileErrorKind::Range {
                    field: "length of xyzw".into(),
                    value: 0.0,
                })?
            }
            (None, None) => UnitQuaternion::identity(),
        };
        Ok(normalize_rotation(&placed(turn)))
    }
}

/// Where the files of a body are.
struct Files<'a> {
    folder: &'a Path,
    packages: &'a Packages,
    options: &'a LoadOptions,
}

impl Files<'_> {
    fn mesh(&self, mesh: &MeshText) -> Result<Geometry, FileErrorKind> {
        let file = self.packages.find(&mesh.file, self.folder)?;
        let placing = MeshPlacing::scaled(mesh.scale.unwrap_or([1.0; 3]))?;
        let usage = mesh.usage.unwrap_or(self.options.meshes);
        Ok(geometry::of_mesh(&file, &placing, usage, self.options)?.0)
    }

    /// Returns the cloud of a file or of a list. The scale acts on the points and on the radii of a
    /// file, not on lengths of the JSON text.
    fn cloud(&self, cloud: &CloudText, notes: &mut Vec<String>) -> Result<Geometry, FileErrorKind> {
        let scale = cloud.scale.unwrap_or(1.0);
        if !(scale > 0.0 && scale < f64::INFINITY) {
            let field = "scale".into();
            return Err(FileErrorKind::Range { field, value: scale });
        }
        let (points, radii) = match (&cloud.file, &cloud.points) {
            (Some(_), Some(_)) => return Err(both("cloud", "file", "points")),
            (None, None) => return Err(FileErrorKind::Missing("file or points".into())),
            (None, Some(points)) => (Points::F64(points.clone()), None),
            (Some(name), None) => {
                let file = self.points(name)?;
                if file.dropped > 0 {
                    notes.push(format!("{name}: {} points without a return", file.dropped));
                }
                // A pose of the camera would move the points.
                let poses = file.skipped.iter().filter(|one| one.what.contains("VIEWPOINT"));
                notes.extend(poses.map(|one| format!("{name}: {}", one.what)));
                (file.points, file.radii)
            }
        };
        let element = match (cloud.radius, &cloud.block, radii) {
            (Some(_), Some(_), _) => return Err(both("cloud", "radius", "box")),
            (Some(radius), None, _) => CloudElement::Ball(radius),
            (None, Some(BlockText { size }), _) => CloudElement::Box(Vector3::from(*size) * 0.5),
            (None, None, Some(radii)) => CloudElement::Balls(radii.iter().map(|r| r * scale).collect()),
            (None, None, None) => return Err(FileErrorKind::Missing("radius or box".into())),
        };
        let cloud = match points {
            Points::F32(points) if scale == 1.0 => Cloud::from_f32(&points, element),
            points => {
                let scaled = |p: [f64; 3]| Point3::from(p.map(|x| x * scale));
                let points: Vec<_> = points.to_f64().into_iter().map(scaled).collect();
                Cloud::new(&points, element)
            }
        };
        cloud.map(Geometry::from).map_err(wrong)
    }

    fn points(&self, name: &str) -> Result<PointFile, FileErrorKind> {
        let file = self.packages.find(name, self.folder)?;
        let invalid = if self.options.keep_invalid {
            Invalid::Refuse
        } else {
            Invalid::Drop
        };
        PointFile::read_with(file, invalid).map_err(wrong)
    }

    fn voxels(&self, voxels: &VoxelsText) -> Result<Geometry, FileErrorKind> {
        let indices = match (&voxels.file, &voxels.indices) {
            (Some(_), Some(_)) => return Err(both("voxels", "file", "indices")),
            (None, None) => return Err(FileErrorKind::Missing("file or indices".into())),
            (None, Some(indices)) => indices.clone(),
            (Some(name), None) => {
                let file = self.packages.find(name, self.folder)?;
                let found = PointFile::read_with(file, Invalid::Refuse).map_err(wrong)?;
                found.points.to_f64()
            }
        };
        let mut cells = Vec::with_capacity(indices.len());
        for (k, index) in indices.iter().enumerate() {
            if let Some(&value) = index
                .iter()
                .find(|x| !(**x >= 0.0 && **x <= 65_535.0 && x.fract() == 0.0))
            {
                let reason = format!("index {k} of voxels is {value:?} (expected a whole number from 0 to 65535)");
                return Err(FileErrorKind::Malformed(reason));
            }
            cells.push(index.map(|x| x as u16));
        }
        let size = match voxels.size {
            SizeText::Cube(side) => [side; 3],
            SizeText::Box(sides) => sides,
        };
        let cloud = Cloud::from_cells(Point3::from(voxels.origin), Vector3::from(size), &cells);
        cloud.map(Geometry::from).map_err(wrong)
    }

    fn heights(&self, heights: &HeightsText) -> Result<Geometry, FileErrorKind> {
        let (rows, columns, values) = match (&heights.file, &heights.values) {
            (Some(_), Some(_)) => return Err(both("heights", "file", "values")),
            (None, None) => return Err(FileErrorKind::Missing("file or values".into())),
            (None, Some(rows)) => {
                let columns = rows.first().map_or(0, Vec::len);
                if let Some(k) = rows.iter().position(|row| row.len() != columns) {
                    let count = rows[k].len();
                    let reason = format!("row {k} of heights has {count} numbers (expected {columns})");
                    return Err(FileErrorKind::Malformed(reason));
                }
                (rows.len(), columns, rows.concat())
            }
            (Some(name), None) => {
                let grid = Grid::read(self.packages.find(name, self.folder)?).map_err(wrong)?;
                (grid.rows, grid.columns, grid.values)
            }
        };
        let mesh = Mesh::from_heights(rows, columns, heights.spacing, &values, heights.base);
        mesh.map(Geometry::from).map_err(wrong)
    }
}

fn both(shape: &str, a: &str, b: &str) -> FileErrorKind {
    FileErrorKind::Malformed(format!("{shape} has both {a} and {b} (expected one)"))
}

fn wrong(error: impl std::fmt::Display) -> FileErrorKind {
    FileErrorKind::Geometry(error.to_string())
}
