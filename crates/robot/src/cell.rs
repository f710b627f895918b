//! Cells: obstacles that a JSON or SDFormat file defines.

use std::path::Path;

use lin_canny::Geometry;
use lin_canny::nalgebra::Isometry3;

use crate::cell_body::{BodyText, parse_json};
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::sdformat;
use crate::space::Setup;
use crate::text::check_content;
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

/// The obstacles of a JSON or SDFormat file, and pairs to exclude.
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
///   "exclude": [["base", "table"]]
/// }
/// ```
///
/// | shape of a body | fields |
/// |---|---|
/// | `box` | `size` |
/// | `cylinder`, `capsule`, `cone` | `radius`, `length`; the axis is z, the apex of a cone is above |
/// | `sphere` | `radius` |
/// | `ellipsoid` | `radii` |
/// | `mesh` | `file`; `scale`: three numbers; `as`: `hull`, `mesh` or `pieces`, by default as the options say |
/// | `cloud` | `file` (PLY, PCD, XYZ or npy) or `points`; `radius` of the balls, or `box` with `size`, or the radii of the file; `scale` of the points |
/// | `voxels` | `file` or `indices`; `size` of a cell, one number or three; `origin`: the least corner of the cell `[0, 0, 0]` |
/// | `half_space` | `normal`, `offset` (0 by default): the points x with `normal . x <= offset` |
/// | `heights` | `file` (rows of numbers) or `values`; `spacing` `[x, y]`: value `[i][j]` is at `(j x, i y)`; `base`: the body is solid down to this height, else an open surface |
///
/// A body has exactly one shape. Its pose in the world is `xyz`, and either `rpy` in radians or the
/// quaternion `xyzw`. A path is relative to the folder of the JSON file, or starts with `package://`
/// or `file://`. Lengths are in metres, except the points of a file with a `scale`. Points without a
/// return are dropped and counted in [`skipped`](Self::skipped), unless
/// [`LoadOptions::keep_invalid`] is set. The key `ignore` is read like `exclude`.
///
/// A file whose root element is `sdf` is SDFormat under any name. Each collision element of
/// each link is an obstacle named `model::link`, at the pose where the file draws it. Models that
/// are not static are obstacles too: they stay at this pose. `collide_bitmask` has no effect.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Cell {
    /// The obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Pairs of names of links and obstacles that are excluded.
    pub excluded: Vec<[String; 2]>,
    /// Bodies that were skipped because their mesh file does not exist, if
    /// [`LoadOptions::skip_missing_meshes`] is set; points without a return; elements of SDFormat
    /// that are left out by rule, such as `actor`.
    pub skipped: Vec<Skipped>,
    /// Names of the skipped bodies, because `excluded` may hold them.
    missing: Vec<String>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct CellText {
    bodies: Vec<BodyText>,
    #[serde(default, alias = "ignore")]
    exclude: Vec<[String; 2]>,
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
        let cell: CellText = parse_json(text, path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut found = Self::default();
        for (k, body) in cell.bodies.into_iter().enumerate() {
            let element = format!("bodies[{k}] {:?}", body.name);
            let wrong = |reason| FileError::new(path, None, element.clone(), reason);
            if body.touch_links.is_some() {
                let what = "touch_links of an obstacle (expected in a body that is attached to a link)";
                return Err(wrong(FileErrorKind::Unsupported(what.into())));
            }
            let pose = body.pose().map_err(wrong)?;
            let mut notes = Vec::new();
            match body.geometry(folder, packages, options, &mut notes) {
                Ok(geometry) => {
                    let notes = notes.into_iter().map(FileErrorKind::Malformed);
                    found.skipped.extend(notes.map(|note| Skipped::from(wrong(note))));
                    found.obstacles.push(Obstacle {
                        name: body.name,
                        geometry,
                        pose,
                    });
                }
                Err(reason @ FileErrorKind::MissingMesh(_)) if options.skip_missing_meshes => {
                    found.skipped.push(wrong(reason).into());
                    found.missing.push(body.name);
                }
                Err(reason) => return Err(wrong(reason)),
            }
        }
        found.excluded = cell.exclude;
        Ok(found)
    }
}

impl Setup {
    /// Adds the obstacles of a cell, and excludes its pairs.
    pub fn cell(&mut self, cell: &Cell) {
        for obstacle in &cell.obstacles {
            self.obstacle(&obstacle.name, obstacle.geometry.clone(), obstacle.pose);
        }
        self.skipped.extend(cell.skipped.iter().cloned());
        // Another body of this name still has its pairs.
        let missing = cell.missing.iter().filter(|name| !self.has_body(name));
        self.frames.extend(missing.cloned().collect::<Vec<_>>());
        for [a, b] in &cell.excluded {
            self.exclude(a, b);
        }
    }
}
