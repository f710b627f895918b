//! Cells: obstacles that a JSON or SDFormat file defines.

use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Geometry, normalize_rotation};

use crate::error::{FileError, FileErrorKind, Skipped};
use crate::geometry::{self, MeshUse, Solid};
use crate::mesh_file::MeshPlacing;
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::sdformat;
use crate::space::Setup;
use crate::text::check_content;
use crate::turn::{from_xyzw, roll_pitch_yaw};
use crate::xml::Xml;

/// An obstacle of a cell.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle {
    /// Name; several obstacles may have the same name.
    pub name: String,
    /// Geometry, in the frame of the obstacle.
    pub geometry: Geometry,
    /// Pose in the world.
    pub pose: Isometry3<f64>,
}

/// The obstacles of a JSON or SDFormat file, and pairs to ignore.
///
/// A file of JSON looks like this:
///
/// ```json
/// {
///   "bodies": [
///     {"name": "table", "box": {"size": [1.3, 1.5, 0.04]}, "xyz": [0.4, 0, -0.02]},
///     {"name": "post", "cylinder": {"radius": 0.035, "length": 0.9}, "xyz": [0.2, 0.7, 0.45], "rpy": [0, 0, 0.5]},
///     {"name": "ball", "sphere": {"radius": 0.1}},
///     {"name": "part", "mesh": {"file": "part.stl", "scale": [0.001, 0.001, 0.001], "as": "mesh"}}
///   ],
///   "ignore": [["base", "table"]]
/// }
/// ```
///
/// A body is a `box` (`size`), `cylinder`, `capsule` or `cone` (`radius` and `length`), `sphere`
/// (`radius`), `ellipsoid` (`radii`) or `mesh`. Axes are along z, the apex of a cone is above. Its
/// pose in the world is `xyz`, and either `rpy` in radians or the quaternion `xyzw`. The path of a
/// mesh file is relative to the folder of the JSON file, or starts with `package://` or `file://`.
/// `as` is `hull`, `mesh` or `pieces`; the default is that of the options.
///
/// A file whose root element is `sdf` is SDFormat under any name. Each collision element of
/// each link is an obstacle named `model::link`, at the pose where the file draws it. Models that
/// are not static are obstacles too: they stay at this pose. `collide_bitmask` has no effect.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Cell {
    /// The obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Names of links and obstacles that may touch.
    pub ignored: Vec<[String; 2]>,
    /// Bodies that were skipped because their mesh file does not exist, if
    /// [`LoadOptions::skip_missing_meshes`] is set; elements of SDFormat that are left out by rule,
    /// such as `actor`.
    pub skipped: Vec<Skipped>,
    /// Names of the skipped bodies, because `ignored` may hold them.
    missing: Vec<String>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct CellText {
    bodies: Vec<BodyText>,
    #[serde(default)]
    ignore: Vec<[String; 2]>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyText {
    name: String,
    #[serde(rename = "box")]
    block: Option<BlockText>,
    cylinder: Option<RoundText>,
    capsule: Option<RoundText>,
    sphere: Option<SphereText>,
    ellipsoid: Option<EllipsoidText>,
    cone: Option<RoundText>,
    mesh: Option<MeshText>,
    #[serde(default)]
    xyz: [f64; 3],
    rpy: Option<[f64; 3]>,
    xyzw: Option<[f64; 4]>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BlockText {
    size: [f64; 3],
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RoundText {
    radius: f64,
    length: f64,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereText {
    radius: f64,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipsoidText {
    radii: [f64; 3],
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshText {
    file: String,
    scale: Option<[f64; 3]>,
    #[serde(rename = "as")]
    usage: Option<MeshUse>,
}

impl Cell {
    /// Returns the cell of a JSON or SDFormat file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or a body is invalid. The error names the line
    /// or the body.
    pub fn load(path: impl AsRef<Path>, packages: &Packages, options: &LoadOptions) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, packages, options)
    }

    /// Returns the cell of a JSON or SDFormat text. Errors name the file `path`, and mesh paths are
    /// relative to its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(
        text: &str,
        path: impl AsRef<Path>,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            let (obstacles, skipped) = sdformat::obstacles(&Xml::parse(path, text)?, packages, options)?;
            return Ok(Self {
                obstacles,
                skipped,
                ..Self::default()
            });
        }
        check_content(text).map_err(|reason| FileError::new(path, Some(1), "", reason))?;
        let cell: CellText = serde_json::from_str(text).map_err(|e| {
            let line = (e.line() > 0).then_some(e.line() as u32);
            FileError::new(path, line, "", FileErrorKind::Malformed(e.to_string()))
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut found = Self::default();
        for (k, body) in cell.bodies.into_iter().enumerate() {
            let element = format!("bodies[{k}] {:?}", body.name);
            let wrong = |reason| FileError::new(path, None, element.clone(), reason);
            let pose = body.pose().map_err(wrong)?;
            match body.geometry(folder, packages, options) {
                Ok(geometry) => found.obstacles.push(Obstacle {
                    name: body.name,
                    geometry,
                    pose,
                }),
                Err(reason @ FileErrorKind::MissingMesh(_)) if options.skip_missing_meshes => {
                    found.skipped.push(wrong(reason).into());
                    found.missing.push(body.name);
                }
                Err(reason) => return Err(wrong(reason)),
            }
        }
        found.ignored = cell.ignore;
        Ok(found)
    }
}

impl BodyText {
    fn geometry(&self, folder: &Path, packages: &Packages, options: &LoadOptions) -> Result<Geometry, FileErrorKind> {
        let mut solids = Vec::new();
        solids.extend(self.block.as_ref().map(|b| Solid::Box { size: b.size }));
        solids.extend(
            self.cylinder
                .as_ref()
                .map(|&RoundText { radius, length }| Solid::Cylinder { radius, length }),
        );
        solids.extend(
            self.capsule
                .as_ref()
                .map(|&RoundText { radius, length }| Solid::Capsule { radius, length }),
        );
        solids.extend(
            self.sphere
                .as_ref()
                .map(|&SphereText { radius }| Solid::Sphere { radius }),
        );
        solids.extend(
            self.ellipsoid
                .as_ref()
                .map(|&EllipsoidText { radii }| Solid::Ellipsoid { radii }),
        );
        solids.extend(
            self.cone
                .as_ref()
                .map(|&RoundText { radius, length }| Solid::Cone { radius, length }),
        );
        match (&solids[..], &self.mesh) {
            ([solid], None) => solid.geometry(),
            ([], Some(mesh)) => {
                let file = packages.find(&mesh.file, folder)?;
                let placing = MeshPlacing::scaled(mesh.scale.unwrap_or([1.0; 3]))?;
                let usage = mesh.usage.unwrap_or(options.meshes);
                Ok(geometry::of_mesh(&file, &placing, usage, options)?.0)
            }
            ([], None) => Err(FileErrorKind::Missing(
                "box, cylinder, capsule, sphere, ellipsoid, cone or mesh".into(),
            )),
            _ => Err(FileErrorKind::Malformed(
                "body has several shapes (expected one)".into(),
            )),
        }
    }

    fn pose(&self) -> Result<Isometry3<f64>, FileErrorKind> {
        let turn = match (self.rpy, self.xyzw) {
            (Some(_), Some(_)) => {
                return Err(FileErrorKind::Malformed(
                    "both rpy and xyzw are given (expected at most one)".into(),
                ));
            }
            (Some(rpy), None) => roll_pitch_yaw(rpy),
            (None, Some(xyzw)) => from_xyzw(xyzw).ok_or_else(|| FileErrorKind::Range {
                field: "length of xyzw".into(),
                value: 0.0,
            })?,
            (None, None) => UnitQuaternion::identity(),
        };
        Ok(normalize_rotation(&Isometry3::from_parts(
            Translation3::from(Vector3::from(self.xyz)),
            turn,
        )))
    }
}

impl Setup {
    /// Adds the obstacles of a cell, and ignores its pairs.
    pub fn cell(&mut self, cell: &Cell) {
        for obstacle in &cell.obstacles {
            self.obstacle(&obstacle.name, obstacle.geometry.clone(), obstacle.pose);
        }
        self.skipped.extend(cell.skipped.iter().cloned());
        // Another body of this name still has its pairs.
        let missing = cell.missing.iter().filter(|name| !self.has_body(name));
        self.frames.extend(missing.cloned().collect::<Vec<_>>());
        for [a, b] in &cell.ignored {
            self.exclude(a, b);
        }
    }
}
