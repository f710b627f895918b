//! Cells: obstacles that a JSON or SDFormat file defines.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use lin_canny::Geometry;
use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, CellBody, CellPair, PlanError, TimedPoses};

use crate::cell_body::{AttachedBody, BodyText, parse_json};
use crate::error::{FileError, FileErrorKind, Skipped};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::text::check_content;

/// An obstacle of a cell.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle {
    /// Name. In a cell, the second of several obstacles of one name is `name#2`.
    pub name: String,
    /// Geometry, in the frame of the obstacle.
    pub geometry: Geometry,
    /// Pose in the world, the first of an obstacle that moves.
    pub pose: Isometry3<f64>,
    /// Poses at times on a clock, if the obstacle moves.
    pub poses: Option<TimedPoses>,
}

/// The bodies that a name in a cell stands for: all bodies with this name, or one of them.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub struct BodyName {
    /// The name of links, attached objects or obstacles.
    pub name: String,
    /// The index of one body among those with the name, in the order of
    /// [`Cell::bodies`](lin_canny_plan::Cell::bodies); `None` for all of them.
    pub index: Option<usize>,
}

impl From<&str> for BodyName {
    fn from(name: &str) -> Self {
        Self {
            name: name.into(),
            index: None,
        }
    }
}

impl std::fmt::Display for BodyName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.index {
            None => f.write_str(&self.name),
            Some(index) => write!(f, "{} {index}", self.name),
        }
    }
}

/// A name in a JSON file: `"post"`, or `["post", 1]` for the second body of this name.
#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
enum NameText {
    All(String),
    One(String, usize),
}

impl From<NameText> for BodyName {
    fn from(text: NameText) -> Self {
        match text {
            NameText::All(name) => Self { name, index: None },
            NameText::One(name, index) => Self {
                name,
                index: Some(index),
            },
        }
    }
}

/// The obstacles of a JSON or SDFormat file, attached objects, pairs to exclude, and margins.
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
/// | `mesh` | `file`; `scale`: three numbers; `as`: `hull`, `mesh`, `solid` or `pieces`, by default as the options say |
/// | `cloud` | `file` (PLY, PCD, XYZ or npy) or `points`; `radius` of the balls, or `box` with `size`, or the radii of the file; `scale` of the points |
/// | `voxels` | `file` or `indices`; `size` of a cell, one number or three; `origin`: the least corner of the cell `[0, 0, 0]` |
/// | `half_space` | `normal`, `offset` (0 by default): the points x with `normal . x <= offset` |
/// | `geometry` | any geometry in the form in which `lin-canny` serialises it |
/// | `heights` | `file` (rows of numbers, or an npy array of two axes) or `values`; `spacing` `[x, y]`: value `[i][j]` is at `(j x, i y)`; `base`: the body is solid down to this height, else an open surface |
///
/// An obstacle that moves has `poses` instead of a pose: `{"file": "poses.csv"}`, a file with the
/// columns `time`, `x`, `y`, `z`, `qx`, `qy`, `qz` and `qw` in any order, or `{"rows": [...]}` with these
/// eight numbers in each row. Positions are linear in between, and rotations are by slerp: see
/// [`TimedPoses`]. Times are those of the trajectory, which must have no time before the first row
/// or after the last.
///
/// A body has exactly one shape. Its pose in the world is `xyz`, and either `rpy` in radians or the
/// quaternion `xyzw`, which is normalised unless its squared norm is 1 to 1e-12. A path is relative to the folder of the JSON file, or starts with `package://`
/// or `file://`. Lengths are in metres, except the points of a file with a `scale`. Points without a
/// return are dropped and counted in [`skipped`](Self::skipped), unless
/// [`LoadOptions::keep_invalid`] is set. The key `ignore` is read like `exclude`.
///
/// The other keys of the file are optional:
///
/// | key | value |
/// |---|---|
/// | `$schema` | the path of the JSON Schema, `docs/cell.schema.json` of this package, with which editors complete and check the file |
/// | `attached` | objects: `{"link": "hand", "body": {...}}`, with the pose in the frame of the link and `touch_links` in the body |
/// | `margin` | the distance that all pairs must keep |
/// | `paddings` | `[name, length]`: see [`Cell::pad`] |
/// | `margins` | `[name, name, length]`: the explicit margin of pairs |
/// | `exclude` | `[name, name]`: pairs that are excluded, in addition to those of the cell |
/// | `exclude_exactly` | `[name, name]`: the pairs that are excluded; no others are |
///
/// A name stands for all links, attached objects and obstacles that have it. `["post", 1]` instead
/// of a name stands for the second of them. [`from_cell`](Self::from_cell) and
/// [`save`](Self::save) write such files.
///
/// A file whose root element is `sdf` is SDFormat under any name. Each collision element of
/// each link is an obstacle named `model::link`, at the pose where the file draws it. Models that
/// are not static are obstacles too: they stay at this pose. `collide_bitmask` has no effect.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct CellFile {
    /// The obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Objects that are attached to links.
    pub attached: Vec<(String, AttachedBody)>,
    /// The distance that all pairs must keep.
    pub margin: Option<f64>,
    /// Paddings of bodies.
    pub paddings: Vec<(BodyName, f64)>,
    /// Explicit margins of pairs.
    pub margins: Vec<([BodyName; 2], f64)>,
    /// Pairs of links, attached objects and obstacles that are excluded.
    pub excluded: Vec<[BodyName; 2]>,
    /// Whether no other pairs are excluded.
    pub excludes_exactly: bool,
    /// Bodies that were skipped because their mesh file does not exist, if
    /// [`LoadOptions::skip_missing_meshes`] is set; points without a return; elements of SDFormat
    /// that are left out by rule, such as `actor`.
    pub skipped: Vec<Skipped>,
    /// Names of the skipped bodies, because `excluded` may hold them.
    pub(crate) missing: Vec<String>,
    /// The file; empty for a cell of no file.
    pub(crate) file: PathBuf,
}

/// The bodies of a cell by the names that a file gives them.
pub(crate) struct NamedBodies(BTreeMap<String, Vec<CellBody>>);

impl NamedBodies {
    /// Returns the bodies that a name of the file stands for.
    fn select(&self, cell: &Cell, body: &BodyName) -> Result<Vec<CellBody>, PlanError> {
        let Some(found) = self.0.get(&body.name) else {
            // The error says why.
            return cell.select(&body.name);
        };
        match body.index {
            None => Ok(found.clone()),
            Some(index) => match found.get(index) {
                Some(id) => Ok(vec![*id]),
                None => Err(PlanError::Unnamed {
                    name: body.to_string(),
                    near: Some(body.name.as_str().into()),
                }),
            },
        }
    }

    /// Returns all pairs of a body of `a` and a body of `b`.
    fn pairs(&self, cell: &Cell, [a, b]: &[BodyName; 2]) -> Result<Vec<CellPair>, PlanError> {
        let (first, second) = (self.select(cell, a)?, self.select(cell, b)?);
        let each = first.iter().flat_map(|a| second.iter().map(move |b| (*a, *b)));
        let found: Vec<CellPair> = each.filter_map(|(a, b)| CellPair::new(a, b)).collect();
        // A link with several bodies has pairs with itself, which a saved cell names.
        match found.is_empty() && a == b {
            true => Err(PlanError::Itself(a.to_string())),
            false => Ok(found),
        }
    }
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct CellText {
    /// The schema of this file, for editors.
    #[serde(rename = "$schema")]
    #[allow(dead_code, reason = "read, but not used")]
    schema: Option<String>,
    /// The obstacles.
    bodies: Vec<BodyText>,
    /// Objects that links carry.
    #[serde(default)]
    attached: Vec<AttachedText>,
    /// The distance that all pairs must keep, in the unit of the robot.
    margin: Option<f64>,
    /// Names, and how much more the pairs of the bodies must keep.
    #[serde(default)]
    paddings: Vec<(NameText, f64)>,
    /// Two names, and the distance that their pairs must keep, instead of the margin.
    #[serde(default)]
    margins: Vec<(NameText, NameText, f64)>,
    /// Two names whose pairs are not checked, in addition to those of the robot.
    #[serde(alias = "ignore")]
    exclude: Option<Vec<[NameText; 2]>>,
    /// Two names whose pairs are not checked; all other pairs are.
    exclude_exactly: Option<Vec<[NameText; 2]>>,
}

#[derive(serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct AttachedText {
    /// The link.
    link: String,
    /// The object, in the frame of the link.
    body: BodyText,
}

impl CellFile {
    /// Adds the obstacles and attached objects of this file to a cell, excludes its pairs, and sets its
    /// margins and paddings. Returns what was [skipped](Self::skipped), and which names were taken:
    /// the second body of a name `post` is `post#2` in the cell.
    ///
    /// If the file [excludes exactly](Self::excludes_exactly) its pairs, pairs that were excluded
    /// before this call are not excluded any more. An obstacle that equals a half-space of a robot of
    /// the cell is not added again.
    ///
    /// # Errors
    /// Returns an error if a pose or a length is out of range, or if a name does not exist. Then the
    /// cell has some of the bodies. The error names the file and its key, such as `exclude[0]`.
    pub fn add_to(&self, cell: &mut Cell) -> Result<Vec<Skipped>, FileError> {
        let (named, skipped) = self.add_bodies(cell)?;
        self.add_pairs(cell, &named)?;
        Ok(skipped)
    }

    /// Adds the bodies, and returns them by their names with what was skipped.
    pub(crate) fn add_bodies(&self, cell: &mut Cell) -> Result<(NamedBodies, Vec<Skipped>), FileError> {
        if self.excludes_exactly {
            cell.include_all();
        }
        // The names in the file of bodies that have other names in the cell.
        let mut renamed: BTreeMap<CellBody, &str> = BTreeMap::new();
        let half_spaces: Vec<CellBody> = cell
            .bodies()
            .map(|(id, _)| id)
            .filter(|id| cell.is_of_robot(*id))
            .collect();
        for obstacle in &self.obstacles {
            if half_spaces.iter().any(|id| is_half_space(cell, *id, obstacle)) {
                continue;
            }
            let (name, geometry) = (cell.free_name(&obstacle.name), obstacle.geometry.clone());
            let id = match &obstacle.poses {
                Some(poses) => cell.add_moving_obstacle(&name, geometry, poses.clone()),
                None => cell.add_obstacle(&name, geometry, obstacle.pose),
            };
            let id = id.map_err(|e| self.error(format!("body {:?}", obstacle.name), e))?;
            if name != obstacle.name {
                renamed.insert(id, &obstacle.name);
            }
        }
        for (k, (link, object)) in self.attached.iter().enumerate() {
            let free = AttachedBody {
                name: cell.free_name(&object.name),
                ..object.clone()
            };
            let id = free.attach_to(cell, link);
            let id = id.map_err(|e| self.error(format!("attached[{k}] {:?}", object.name), e))?;
            if free.name != object.name {
                renamed.insert(id, &object.name);
            }
        }
        let mut taken: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (id, name) in &renamed {
            taken.entry(name).or_default().push(cell.name(*id));
        }
        let mut skipped = self.skipped.clone();
        skipped.extend(taken.into_iter().map(|(name, new)| Skipped {
            file: self.file.clone(),
            line: None,
            element: format!("{name:?}"),
            reason: match new[..] {
                [one] => format!("the name is taken: this body is {one:?}"),
                _ => format!(
                    "the name is taken: these bodies are {:?} to {:?}",
                    new[0],
                    new[new.len() - 1]
                ),
            },
        }));
        let mut named: BTreeMap<String, Vec<CellBody>> = BTreeMap::new();
        for (id, name) in cell.bodies() {
            let name = renamed.get(&id).copied().unwrap_or(name);
            named.entry(name.to_owned()).or_default().push(id);
        }
        Ok((NamedBodies(named), skipped))
    }

    /// Excludes the pairs, and sets margins and paddings.
    pub(crate) fn add_pairs(&self, cell: &mut Cell, named: &NamedBodies) -> Result<(), FileError> {
        if let Some(margin) = self.margin {
            cell.set_margin(margin).map_err(|e| self.error("margin", e))?;
        }
        for (k, (name, padding)) in self.paddings.iter().enumerate() {
            let wrong = |e| self.error(format!("paddings[{k}]"), e);
            for id in named.select(cell, name).map_err(wrong)? {
                cell.pad(id, *padding).map_err(wrong)?;
            }
        }
        for (k, (pair, margin)) in self.margins.iter().enumerate() {
            let wrong = |e| self.error(format!("margins[{k}]"), e);
            for pair in named.pairs(cell, pair).map_err(wrong)? {
                cell.set_pair_margin(pair.a, pair.b, Some(*margin)).map_err(wrong)?;
            }
        }
        // A skipped body and a link without bodies have no pairs.
        let missing: BTreeSet<&str> = self.missing.iter().map(String::as_str).collect();
        let is_missing = |name: &BodyName| missing.contains(&*name.name) && !named.0.contains_key(&name.name);
        let key = match self.excludes_exactly {
            true => "exclude_exactly",
            false => "exclude",
        };
        for (k, pair) in self.excluded.iter().enumerate() {
            if pair.iter().any(is_missing) {
                continue;
            }
            let wrong = |e| self.error(format!("{key}[{k}]"), e);
            match named.pairs(cell, pair) {
                Ok(found) => {
                    for pair in found {
                        cell.exclude(pair.a, pair.b).map_err(wrong)?;
                    }
                }
                Err(PlanError::WithoutBodies(_)) => {}
                Err(error) => return Err(wrong(error)),
            }
        }
        Ok(())
    }

    /// Returns the error of a key of the file.
    fn error(&self, element: impl Into<String>, error: PlanError) -> FileError {
        let element = element.into();
        FileError {
            element,
            ..FileError::of_plan(&self.file, error)
        }
    }

    /// Returns the cell of a JSON text.
    pub(crate) fn from_json(
        text: &str,
        path: &Path,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        check_content(text).map_err(|reason| FileError::new(path, Some(1), "", reason))?;
        let cell: CellText = parse_json(text, path)?;
        let mut found = Self {
            file: path.into(),
            ..Self::default()
        };
        for (k, mut body) in cell.bodies.into_iter().enumerate() {
            let element = format!("bodies[{k}] {:?}", body.name);
            let wrong = |reason| FileError::new(path, None, element.clone(), reason);
            if body.touch_links.is_some() {
                let what = "touch_links of an obstacle (expected in a body that is attached to a link)";
                return Err(wrong(FileErrorKind::Unsupported(what.into())));
            }
            let name = body.name.clone();
            let poses = body.take_poses(&element, path, packages)?;
            if let Some(body) = found.body(body, element, path, packages, options)? {
                found.obstacles.push(Obstacle {
                    name,
                    geometry: body.geometry,
                    pose: poses.as_ref().map_or(body.pose, |poses| poses.poses()[0]),
                    poses,
                });
            }
        }
        for (k, AttachedText { link, body }) in cell.attached.into_iter().enumerate() {
            let element = format!("attached[{k}] {:?}", body.name);
            if let Some(body) = found.body(body, element, path, packages, options)? {
                found.attached.push((link, body));
            }
        }
        let names = |pair: [NameText; 2]| pair.map(BodyName::from);
        found.margin = cell.margin;
        found.paddings = cell.paddings.into_iter().map(|(a, p)| (a.into(), p)).collect();
        found.margins = cell.margins.into_iter().map(|(a, b, m)| (names([a, b]), m)).collect();
        found.excludes_exactly = cell.exclude_exactly.is_some();
        if cell.exclude.is_some() && found.excludes_exactly {
            let reason = FileErrorKind::Malformed("both exclude and exclude_exactly (expected one)".into());
            return Err(FileError::new(path, None, "", reason));
        }
        let pairs = cell.exclude_exactly.or(cell.exclude).unwrap_or_default();
        found.excluded = pairs.into_iter().map(names).collect();
        Ok(found)
    }

    /// Returns a body of a file, or `None` if its mesh is missing and may be. Notes what is skipped.
    fn body(
        &mut self,
        body: BodyText,
        element: String,
        path: &Path,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Option<AttachedBody>, FileError> {
        let name = body.name.clone();
        match AttachedBody::from_text(body, element, path, packages, options) {
            Ok(mut body) => {
                self.skipped.append(&mut body.skipped);
                Ok(Some(body))
            }
            Err(error) if options.skip_missing_meshes && matches!(error.reason, FileErrorKind::MissingMesh(_)) => {
                self.skipped.push(error.into());
                self.missing.push(name);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}

/// Returns whether an obstacle equals a half-space of a robot, so that it is in the cell already.
fn is_half_space(cell: &Cell, id: CellBody, obstacle: &Obstacle) -> bool {
    let (Some(Geometry::HalfSpace(own)), Geometry::HalfSpace(other)) = (cell.geometry(id), &obstacle.geometry) else {
        return false;
    };
    obstacle.poses.is_none()
        && cell.name(id) == obstacle.name
        && cell.obstacle_pose(id) == Some(&obstacle.pose)
        && (own.normal(), own.offset()) == (other.normal(), other.offset())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The schema next to the documentation is that of the reader's types. `UPDATE_SCHEMA=1` writes it.
    #[test]
    fn the_schema_of_a_cell_is_as_written() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/cell.schema.json");
        let mut schema = schemars::schema_for!(CellText);
        schema.insert("title".into(), "A cell of lin-canny".into());
        let text = serde_json::to_string_pretty(&schema).expect("a schema") + "\n";
        if std::env::var_os("UPDATE_SCHEMA").is_some() {
            std::fs::write(&path, &text).expect("a file");
        }
        assert_eq!(std::fs::read_to_string(path).expect("the schema"), text);
    }
}
