//! Geoms, and the meshes and height fields that they use.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use lin_canny::{Geometry, HullFit, Mesh};

use super::element::{Element, numbers};
use super::settings::{Classes, Compiler, Flags, Settings, check, segment};
use crate::error::{FileError, FileErrorKind, Place};
use crate::geometry::{self, Solid};
use crate::mesh_file::{MeshPlacing, Soup};
use crate::options::{LoadOptions, MeshUse};
use crate::turn::from_xyzw;
use crate::xml::EXTENT_MAX;
use lin_canny_plan::LinkBody;
use lin_canny_plan::nearest_name as nearest;

/// Maximum number of coordinates of a mesh in the file.
const MOST_NUMBERS: usize = 30_000_000;

/// Maximum number of heights of all height fields.
const MOST_HEIGHTS: usize = 100_000;

/// The meshes and height fields of the sections `asset`.
pub(super) struct Assets<'e> {
    meshes: HashMap<String, (&'e Element, Settings<'e>)>,
    fields: HashMap<String, &'e Element>,
    /// Bodies of meshes that have been read.
    read: HashMap<(String, MeshUse), MeshBody>,
    /// Bodies of height fields that have been read, and the number of their heights.
    read_fields: HashMap<String, (Geometry, Vector3<f64>)>,
    heights: usize,
}

/// A mesh as a body: the geometry, how much its hull differs from it, and the file.
type MeshBody = (Geometry, Option<HullFit>, Option<PathBuf>);

impl<'e> Assets<'e> {
    pub(super) fn new(sections: &[&'e Element], classes: &'e Classes) -> Result<Self, FileError> {
        let mut assets = Self {
            meshes: HashMap::new(),
            fields: HashMap::new(),
            read: HashMap::new(),
            read_fields: HashMap::new(),
            heights: 0,
        };
        for section in sections {
            for element in section.below(&["mesh", "hfield"], &["texture", "material", "skin", "model"])? {
                let stem = || Path::new(element.get("file")?).file_stem()?.to_str();
                let name = element.get("name").or_else(stem).map(str::to_owned);
                let name = name.ok_or_else(|| element.error(FileErrorKind::Missing("attribute name or file".into())));
                let is_new = match element.name.as_str() {
                    "mesh" => {
                        check(element)?;
                        let mesh = (element, classes.of(element, "mesh", "main")?);
                        assets.meshes.insert(name?, mesh).is_none()
                    }
                    _ => {
                        let known = ["name", "content_type", "file", "nrow", "ncol", "size", "elevation"];
                        element.check_attributes(&known)?;
                        assets.fields.insert(name?, element).is_none()
                    }
                };
                if !is_new {
                    return Err(element.error(FileErrorKind::Repeated));
                }
            }
        }
        Ok(assets)
    }

    /// Returns the body of a geom, at its pose in the frame of the element around it.
    pub(super) fn geom(&mut self, geom: &Settings, link: &str, reader: &Source) -> Result<LinkBody, FileError> {
        let kind = geom.get("type").unwrap_or("sphere");
        let mut origin = geom.pose(&reader.compiler)?;
        let mut sizes = geom.up_to("size", 3)?;
        if let Some(ends) = geom.numbers::<6>("fromto")? {
            if !matches!(kind, "capsule" | "cylinder" | "box" | "ellipsoid") {
                let why = format!("fromto of a geom of type {kind:?}");
                return Err(geom.place.error(FileErrorKind::Unsupported(why)));
            }
            if geom.numbers::<3>("pos")?.is_some_and(|pos| pos != [0.0; 3]) {
                let why = "both pos and fromto are given (expected at most one)";
                return Err(geom.place.error(FileErrorKind::Malformed(why.into())));
            }
            let (pose, half) = segment(geom.place, ends)?;
            origin = pose;
            sizes.truncate(1);
            let across = sizes.first().copied().ok_or_else(|| missing_size(geom))?;
            let is_round = matches!(kind, "capsule" | "cylinder");
            sizes.extend(if is_round { vec![half] } else { vec![across, half] });
        }
        if geom.get("mesh").is_some() && kind != "mesh" {
            let why = format!("a geom of type {kind:?} that is fitted to a mesh (expected type=\"mesh\")");
            return Err(geom.place.error(FileErrorKind::Unsupported(why)));
        }
        let size = |k: usize| match sizes.get(k) {
            Some(size) if *size > 0.0 => Ok(*size),
            Some(&value) => {
                let field = "size".into();
                Err(geom.place.error(FileErrorKind::Range { field, value }))
            }
            None => Err(missing_size(geom)),
        };
        let solid = match kind {
            "plane" => Solid::HalfSpace {
                extent: reader.options.plane_extent,
            },
            "sphere" => Solid::Sphere { radius: size(0)? },
            "capsule" => Solid::Capsule {
                radius: size(0)?,
                length: 2.0 * size(1)?,
            },
            "cylinder" => Solid::Cylinder {
                radius: size(0)?,
                length: 2.0 * size(1)?,
            },
            "ellipsoid" => Solid::Ellipsoid {
                radii: [size(0)?, size(1)?, size(2)?],
            },
            "box" => Solid::Box {
                size: [2.0 * size(0)?, 2.0 * size(1)?, 2.0 * size(2)?],
            },
            "hfield" => {
                let (geometry, corner) = self.height_field(geom)?;
                return Ok(LinkBody::new(origin * Translation3::from(corner), geometry));
            }
            "mesh" => {
                let (geometry, hull_fit, mesh) = self.mesh(geom, reader.options.mesh_of(link), reader)?;
                return Ok(LinkBody {
                    hull_fit,
                    mesh,
                    ..LinkBody::new(origin, geometry)
                });
            }
            _ => {
                let why = format!("a geom of type {kind:?}");
                return Err(geom.place.error(FileErrorKind::Unsupported(why)));
            }
        };
        let geometry = solid.geometry().map_err(|reason| geom.place.error(reason))?;
        Ok(LinkBody::new(origin, geometry))
    }

    fn mesh(&mut self, geom: &Settings, usage: MeshUse, reader: &Source) -> Result<MeshBody, FileError> {
        let name = needed(geom, "mesh")?;
        if let Some(read) = self.read.get(&(name.to_owned(), usage)) {
            return Ok(read.clone());
        }
        let Some((element, mesh)) = self.meshes.get(name) else {
            return Err(unknown(geom, "mesh", name, self.meshes.keys()));
        };
        if let Some(builtin) = element.get("builtin").filter(|builtin| *builtin != "none") {
            return Err(element.unsupported(format!("a built-in mesh ({builtin})")));
        }
        if let Some(plugin) = element.children.first() {
            return Err(plugin.unsupported("a mesh of a plugin"));
        }
        let scale = mesh.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
        // MuJoCo moves the points, then turns them, then scales them.
        let before = Vector3::from(mesh.numbers::<3>("refpos")?.unwrap_or_default());
        let [w, x, y, z] = mesh.numbers("refquat")?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let turn = from_xyzw([x, y, z, w]).ok_or_else(|| {
            let (field, value) = ("length of refquat".into(), 0.0);
            element.error(FileErrorKind::Range { field, value })
        })?;
        let turn = if turn.w == 1.0 {
            Matrix3::identity()
        } else {
            turn.inverse().to_rotation_matrix().into_inner()
        };
        let placing = MeshPlacing::new(-before, turn, scale).map_err(|reason| element.error(reason))?;
        let read = match (mesh.get("file"), mesh.get("vertex")) {
            (Some(_), Some(_)) => {
                let why = "both file and vertex are given (expected one)";
                return Err(element.error(FileErrorKind::Malformed(why.into())));
            }
            (None, None) => return Err(element.error(FileErrorKind::Missing("attribute file or vertex".into()))),
            (Some(file), None) => {
                let file = reader.mesh_file(file);
                if !file.is_file() {
                    let why = FileErrorKind::MissingMesh(file.display().to_string());
                    return Err(element.error(why));
                }
                let body = geometry::of_mesh(&file, &placing, usage, reader.options);
                let (geometry, fit) = body.map_err(|reason| element.error(reason))?;
                (geometry, fit, Some(file))
            }
            (None, Some(text)) => {
                let vertices = numbers(&element.place, "vertex", text, MOST_NUMBERS)?;
                let (points, rest) = vertices.as_chunks::<3>();
                if !rest.is_empty() {
                    return Err(not_triples(element, "vertex"));
                }
                let mut triangles = Vec::new();
                if let Some(text) = mesh.get("face") {
                    let corners = numbers(&element.place, "face", text, MOST_NUMBERS)?;
                    let (faces, rest) = corners.as_chunks::<3>();
                    if !rest.is_empty() {
                        return Err(not_triples(element, "face"));
                    }
                    let is_vertex = |k: f64| k.fract() == 0.0 && k >= 0.0 && k < points.len() as f64;
                    if let Some(value) = faces.as_flattened().iter().find(|k| !is_vertex(**k)) {
                        let (field, value) = ("vertex of face".into(), *value);
                        return Err(element.error(FileErrorKind::Range { field, value }));
                    }
                    triangles.extend(faces.iter().map(|face| face.map(|k| k as u32)));
                }
                let soup = Soup::new(points, triangles, &placing);
                let body = soup.and_then(|soup| geometry::of_soup(soup, usage, reader.options));
                let (geometry, fit) = body.map_err(|reason| element.error(reason))?;
                (geometry, fit, None)
            }
        };
        self.read.insert((name.to_owned(), usage), read.clone());
        Ok(read)
    }

    /// Returns the solid below the heights of a field, and where its frame is in that of the geom.
    fn height_field(&mut self, geom: &Settings) -> Result<(Geometry, Vector3<f64>), FileError> {
        let name = needed(geom, "hfield")?;
        if let Some(read) = self.read_fields.get(name) {
            return Ok(read.clone());
        }
        let Some(field) = self.fields.get(name) else {
            return Err(unknown(geom, "height field", name, self.fields.keys()));
        };
        if field.get("file").is_some() {
            return Err(field.unsupported("a height field from a file (expected elevation)"));
        }
        let [x, y, high, low] = field
            .numbers("size")?
            .ok_or_else(|| field.error(FileErrorKind::Missing("attribute size".into())))?;
        if let Some(&value) = [x, y, high, low].iter().find(|size| !(**size > 0.0)) {
            let field_name = "size".into();
            return Err(field.error(FileErrorKind::Range {
                field: field_name,
                value,
            }));
        }
        let count = |name: &str| -> Result<usize, FileError> {
            let text = field.needed(name)?;
            let why = || format!("invalid {name}: {text:?} (expected a number from 2)");
            let number = text.trim().parse().ok().filter(|n| *n >= 2);
            number.ok_or_else(|| field.error(FileErrorKind::Malformed(why())))
        };
        let (mut rows, mut columns): (usize, usize) = (count("nrow")?, count("ncol")?);
        if field.get("elevation").is_none() {
            // All heights are zero, so that the corners make the same solid.
            (rows, columns) = (2, 2);
        }
        self.heights = self.heights.saturating_add(rows.saturating_mul(columns));
        if self.heights > MOST_HEIGHTS {
            let found = self.heights;
            let why = format!("too many heights of height fields: {found} (expected at most {MOST_HEIGHTS})");
            return Err(field.error(FileErrorKind::Malformed(why)));
        }
        let heights = match field.get("elevation") {
            Some(text) => numbers(&field.place, "elevation", text, rows * columns)?,
            None => vec![0.0; rows * columns],
        };
        if heights.len() != rows * columns {
            let (found, expected) = (heights.len(), rows * columns);
            let why = format!("elevation has {found} heights (expected {expected})");
            return Err(field.error(FileErrorKind::Malformed(why)));
        }
        let (least, most) = heights
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
                (if *h < low { *h } else { low }, if *h > high { *h } else { high })
            });
        let range = if most > least { most - least } else { 1.0 };
        // The first row has the largest y.
        let heights: Vec<f64> = (heights.chunks(columns).rev().flatten())
            .map(|height| (height - least) / range * high)
            .collect();
        let spacing = [2.0 * x / (columns - 1) as f64, 2.0 * y / (rows - 1) as f64];
        let mesh = Mesh::from_heights(rows, columns, spacing, &heights, Some(-low));
        let mesh = mesh.map_err(|e| field.error(FileErrorKind::Geometry(e.to_string())))?;
        let read = (Geometry::from(mesh), Vector3::new(-x, -y, 0.0));
        self.read_fields.insert(name.to_owned(), read.clone());
        Ok(read)
    }
}

/// What a body is read with.
pub(super) struct Source<'e> {
    pub(super) compiler: Compiler,
    pub(super) flags: &'e Flags<'e>,
    pub(super) options: &'e LoadOptions,
    /// The folder of the file.
    pub(super) folder: &'e Path,
}

impl Source<'_> {
    fn mesh_file(&self, name: &str) -> PathBuf {
        let name = Path::new(name);
        let stripped = name.file_name().filter(|_| self.compiler.takes_file_names_only);
        let name = stripped.map_or(name, Path::new);
        self.folder.join(&self.compiler.mesh_folder).join(name)
    }
}

fn needed<'e>(settings: &Settings<'e>, name: &str) -> Result<&'e str, FileError> {
    let missing = || {
        settings
            .place
            .error(FileErrorKind::Missing(format!("attribute {name}")))
    };
    settings.get(name).ok_or_else(missing)
}

fn missing_size(geom: &Settings) -> FileError {
    let what = "number of the attribute size";
    geom.place.error(FileErrorKind::Missing(what.into()))
}

fn not_triples(element: &Element, field: &str) -> FileError {
    let why = format!("numbers of {field} are not triples");
    element.error(FileErrorKind::Malformed(why))
}

fn unknown<'n>(
    settings: &Settings,
    kind: &'static str,
    name: &str,
    names: impl Iterator<Item = &'n String>,
) -> FileError {
    settings.place.error(FileErrorKind::Unknown {
        kind,
        name: name.into(),
        near: nearest(name, names.map(String::as_str)),
    })
}

/// Returns a pose after a pose, or an error if it is too far away.
pub(super) fn placed(
    place: &Place,
    outer: &Isometry3<f64>,
    inner: &Isometry3<f64>,
) -> Result<Isometry3<f64>, FileError> {
    let pose = outer * inner;
    let value = pose.translation.vector.amax();
    if !(value <= EXTENT_MAX) {
        let field = "position".into();
        return Err(place.error(FileErrorKind::Range { field, value }));
    }
    Ok(pose)
}
