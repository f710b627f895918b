//! The world of a checker as a cell, and cells as JSON files.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::shape::Core;
use lin_canny::{Geometry, RelativePose};
use lin_canny_plan::{Cell, CellBody, TimedPoses};
use serde::Serialize;

use crate::cell::{BodyName, CellFile, Obstacle};
use crate::cell_body::{AttachedBody, BlockText, EllipsoidText, HalfSpaceText, PosesText, RoundText, SphereText};
use crate::error::{FileError, FileErrorKind};
use crate::geometry::Solid;
use crate::pose_file;

/// A body of a cell, as it is written.
#[derive(Serialize)]
struct BodyLine<'a> {
    name: &'a str,
    #[serde(flatten)]
    shape: ShapeText<'a>,
    #[serde(flatten)]
    pose: PoseText,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    touch_links: &'a [String],
}

/// The pose of a body, or the poses of one that moves.
#[derive(Serialize)]
#[serde(untagged)]
enum PoseText {
    Still { xyz: [f64; 3], xyzw: [f64; 4] },
    Moving { poses: PosesText },
}

/// A shape with its name in a cell, or else the geometry in full.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum ShapeText<'a> {
    #[serde(rename = "box")]
    Block(BlockText),
    Cylinder(RoundText),
    Capsule(RoundText),
    Sphere(SphereText),
    Ellipsoid(EllipsoidText),
    Cone(RoundText),
    HalfSpace(HalfSpaceText),
    Geometry(&'a Geometry),
}

#[derive(Serialize)]
struct AttachedLine<'a> {
    link: &'a str,
    body: BodyLine<'a>,
}

/// A name, as it is written.
#[derive(Serialize)]
#[serde(untagged)]
enum NameLine<'a> {
    All(&'a str),
    One(&'a str, usize),
}

impl<'a> From<&'a BodyName> for NameLine<'a> {
    fn from(body: &'a BodyName) -> Self {
        match body.index {
            None => Self::All(&body.name),
            Some(index) => Self::One(&body.name, index),
        }
    }
}

/// Saves cells.
impl CellFile {
    /// Returns the file of a cell: its obstacles, attached objects, paddings, margins and excluded
    /// pairs.
    ///
    /// A cell of the same robot to which this is [added](Self::add_to) has a checker that answers as
    /// one of this cell, bit for bit, also after it was [saved](Self::save) and [loaded](Self::load).
    /// Ids start again: bodies keep their order, but those that were removed have no id. The start
    /// contact margin belongs to the checker, not to the cell.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{HalfSpace, Shape};
    /// use lin_canny_robot::plan::{Cell, Checker};
    /// use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot};
    ///
    /// let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gripper.urdf");
    /// let robot = Robot::load(urdf, &Packages::default())?;
    /// let mut cell = Cell::new();
    /// cell.add_robot("", &robot, Isometry3::identity())?;
    /// cell.exclude_adjacent();
    /// let mut checker = Checker::of_robots(cell)?;
    /// let floor = HalfSpace::new(Vector3::z(), -0.1)?;
    /// checker.cell_mut().add_obstacle("floor", floor, Isometry3::identity())?;
    /// checker.cell_mut().pad("floor", 0.01)?;
    /// let text = CellFile::from_cell(checker.cell()).to_json()?;
    ///
    /// let (packages, options) = (Packages::default(), LoadOptions::default());
    /// let mut again = Cell::new();
    /// again.add_robot("", &robot, Isometry3::identity())?;
    /// CellFile::parse(&text, "cell.json", &packages, &options)?.add_to(&mut again)?;
    /// let mut loaded = Checker::of_robots(again)?;
    /// let q = [0.0, 0.6, 1.0, 0.0, 0.5, 0.0, 0.02];
    /// assert_eq!(loaded.clearance(&q)?, checker.clearance(&q)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn from_cell(cell: &Cell) -> Self {
        let names = Names::new(cell);
        let ids = cell
            .bodies()
            .map(|(id, _)| id)
            .filter(|id| cell.obstacle_pose(*id).is_some());
        let obstacles = cell.obstacles().zip(ids).map(|((name, geometry, pose), id)| Obstacle {
            name: name.into(),
            geometry: geometry.clone(),
            pose: *pose,
            poses: cell.obstacle_motion(id).cloned(),
        });
        let attached = cell.attached().map(|(_, object)| {
            let body = AttachedBody {
                name: object.name.clone(),
                geometry: object.geometry.clone(),
                pose: object.pose,
                touch_links: Vec::new(),
                skipped: Vec::new(),
            };
            (object.link.clone(), body)
        });
        let mut excluded: Vec<[BodyName; 2]> = Vec::new();
        let whole = cell.excluded_names();
        excluded.extend(whole.iter().map(|(pair, _)| pair.map(BodyName::from)));
        let is_single = |pair: &[CellBody; 2]| {
            let mut pair = pair.map(|id| cell.name(id));
            pair.sort_unstable();
            whole.binary_search_by_key(&pair, |(names, _)| *names).is_err()
        };
        let single = cell.excluded().filter(is_single);
        excluded.extend(single.map(|pair| pair.map(|id| names.of(id))));
        let margins = cell
            .margins()
            .map(|(pair, margin)| ([pair.a, pair.b].map(|id| names.of(id)), margin));
        Self {
            obstacles: obstacles.collect(),
            attached: attached.collect(),
            margin: Some(cell.margin()),
            paddings: cell.paddings().map(|(id, padding)| (names.of(id), padding)).collect(),
            margins: margins.collect(),
            excluded,
            excludes_exactly: true,
            ..Self::default()
        }
    }

    /// Returns the text of a JSON file with this cell, as [`parse`](Self::parse) reads it.
    ///
    /// Numbers keep every bit. Boxes, round solids and half-spaces have their names in the text, all
    /// other geometries are `geometry`.
    ///
    /// # Errors
    /// Returns an error if a pose is invalid or a length is not finite.
    pub fn to_json(&self) -> Result<String, FileError> {
        self.text(Path::new("cell.json"))
    }

    /// Writes the cell to a JSON file: see [`to_json`](Self::to_json).
    ///
    /// # Errors
    /// As [`to_json`](Self::to_json), and if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let text = self.text(path)?;
        std::fs::write(path, text).map_err(|error| FileError::new(path, None, "", FileErrorKind::Write(error)))
    }

    fn text(&self, path: &Path) -> Result<String, FileError> {
        let wrong = |element: &str, reason: String| {
            FileError::new(path, None, format!("{element:?}"), FileErrorKind::Geometry(reason))
        };
        let margins = self.margins.iter().map(|(pair, margin)| (&pair[0], *margin));
        let lengths = self
            .paddings
            .iter()
            .map(|(name, padding)| (name, *padding))
            .chain(margins);
        if let Some((name, length)) = lengths.into_iter().find(|(_, length)| !length.is_finite()) {
            return Err(wrong(&name.to_string(), format!("margin is not finite: {length}")));
        }
        let body = |name, geometry, pose: &Isometry3<f64>, poses: Option<&TimedPoses>, touch_links| {
            RelativePose::from_isometry(pose).map_err(|error| wrong(name, error.to_string()))?;
            Ok(BodyLine {
                name,
                shape: shape(geometry),
                pose: match poses {
                    Some(poses) => PoseText::Moving {
                        poses: PosesText::Rows(pose_file::rows(poses)),
                    },
                    None => PoseText::Still {
                        xyz: pose.translation.vector.into(),
                        xyzw: pose.rotation.coords.into(),
                    },
                },
                touch_links,
            })
        };
        let bodies = self
            .obstacles
            .iter()
            .map(|o| body(&o.name, &o.geometry, &o.pose, o.poses.as_ref(), &[][..]));
        let attached = self.attached.iter().map(|(link, o)| {
            let body = body(&o.name, &o.geometry, &o.pose, None, &o.touch_links)?;
            Ok(AttachedLine { link, body })
        });
        let paddings = self
            .paddings
            .iter()
            .map(|(name, padding)| (NameLine::from(name), padding));
        let margins = self
            .margins
            .iter()
            .map(|([a, b], m)| (NameLine::from(a), NameLine::from(b), m));
        let excluded = self.excluded.iter().map(|pair| pair.each_ref().map(NameLine::from));
        let exclude = if self.excludes_exactly {
            "exclude_exactly"
        } else {
            "exclude"
        };
        let mut text = Text("{".into());
        text.list("bodies", &bodies.collect::<Result<Vec<_>, _>>()?)?;
        text.list("attached", &attached.collect::<Result<Vec<_>, _>>()?)?;
        if let Some(margin) = self.margin {
            text.key("margin", &margin)?;
        }
        text.list("paddings", &paddings.collect::<Vec<_>>())?;
        text.list("margins", &margins.collect::<Vec<_>>())?;
        text.list(exclude, &excluded.collect::<Vec<_>>())?;
        Ok(text.0 + "\n}\n")
    }
}

/// The text of an object, one entry of a list per line.
struct Text(String);

impl Text {
    fn key(&mut self, key: &str, value: &impl Serialize) -> Result<(), FileError> {
        let separator = if self.0.len() > 1 { "," } else { "" };
        let _ = write!(self.0, "{separator}\n  \"{key}\": {}", json(value)?);
        Ok(())
    }

    fn list(&mut self, key: &str, values: &[impl Serialize]) -> Result<(), FileError> {
        let separator = if self.0.len() > 1 { "," } else { "" };
        let _ = write!(self.0, "{separator}\n  \"{key}\": [");
        for (k, value) in values.iter().enumerate() {
            let separator = if k > 0 { "," } else { "" };
            let _ = write!(self.0, "{separator}\n    {}", json(value)?);
        }
        self.0 += if values.is_empty() { "]" } else { "\n  ]" };
        Ok(())
    }
}

fn json(value: &impl Serialize) -> Result<String, FileError> {
    let wrong = |error: serde_json::Error| {
        FileError::new(
            Path::new(""),
            None,
            "",
            FileErrorKind::Write(std::io::Error::from(error)),
        )
    };
    serde_json::to_string(value).map_err(wrong)
}

/// Returns the shape that stands for a geometry: a named one if it is read as the same geometry,
/// bit for bit.
fn shape(geometry: &Geometry) -> ShapeText<'_> {
    let named = match geometry {
        Geometry::HalfSpace(space) => {
            let (normal, offset) = (space.normal().into_inner().into(), space.offset());
            Some((ShapeText::HalfSpace(HalfSpaceText { normal, offset }), None))
        }
        Geometry::Polyhedron(body) => {
            let most = body.vertex_points().fold([0.0; 3], |most: [f64; 3], p: Point3<f64>| {
                [0, 1, 2].map(|k| if p[k] > most[k] { p[k] } else { most[k] })
            });
            let size = most.map(|x| 2.0 * x);
            Some((ShapeText::Block(BlockText { size }), Some(Solid::Box { size })))
        }
        Geometry::Convex(shape) => {
            let rounding = shape.rounding_radius();
            match shape.core() {
                Core::Polyhedron(core) if core.vertex_count() == 1 => {
                    let radius = rounding;
                    Some((ShapeText::Sphere(SphereText { radius }), Some(Solid::Sphere { radius })))
                }
                Core::Polyhedron(core) => {
                    let half = core
                        .vertex_points()
                        .fold(0.0, |most, p| if p.z > most { p.z } else { most });
                    let (radius, length) = (rounding, 2.0 * half);
                    let text = ShapeText::Capsule(RoundText { radius, length });
                    Some((text, Some(Solid::Capsule { radius, length })))
                }
                Core::Ellipsoid(core) => {
                    let radii = core.semi_axes().into();
                    Some((
                        ShapeText::Ellipsoid(EllipsoidText { radii }),
                        Some(Solid::Ellipsoid { radii }),
                    ))
                }
                Core::Cylinder(core) => {
                    let (radius, length) = (core.radius(), 2.0 * core.half_height());
                    let text = ShapeText::Cylinder(RoundText { radius, length });
                    Some((text, Some(Solid::Cylinder { radius, length })))
                }
                Core::Cone(core) => {
                    let (radius, length) = (core.radius(), 2.0 * core.half_height());
                    let text = ShapeText::Cone(RoundText { radius, length });
                    Some((text, Some(Solid::Cone { radius, length })))
                }
                _ => None,
            }
        }
        _ => None,
    };
    let Some((text, solid)) = named else {
        return ShapeText::Geometry(geometry);
    };
    let read = match (&text, solid) {
        (ShapeText::HalfSpace(HalfSpaceText { normal, offset }), _) => {
            lin_canny::HalfSpace::new((*normal).into(), *offset)
                .ok()
                .map(Geometry::from)
        }
        (_, Some(solid)) => solid.geometry().ok(),
        _ => None,
    };
    let stored = |geometry: &Geometry| serde_json::to_string(geometry).ok();
    match read.as_ref().and_then(stored) {
        Some(read) if Some(&read) == stored(geometry).as_ref() => text,
        _ => ShapeText::Geometry(geometry),
    }
}

/// The names of the bodies of a world.
struct Names(BTreeMap<CellBody, BodyName>);

impl Names {
    fn new(cell: &Cell) -> Self {
        let mut of_name: BTreeMap<&str, Vec<CellBody>> = BTreeMap::new();
        for (id, name) in cell.bodies() {
            of_name.entry(name).or_default().push(id);
        }
        let each = of_name.into_iter().flat_map(|(name, ids)| {
            let is_alone = ids.len() == 1;
            let named = move |(index, id)| {
                let index = (!is_alone).then_some(index);
                let name = name.to_owned();
                (id, BodyName { name, index })
            };
            ids.into_iter().enumerate().map(named)
        });
        Self(each.collect())
    }

    fn of(&self, id: CellBody) -> BodyName {
        self.0.get(&id).cloned().unwrap_or_else(|| "".into())
    }
}
