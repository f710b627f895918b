//! The geometry of a body: a solid of a URDF or cell, or a mesh.

use std::path::Path;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ConvexPolyhedron, Geometry, HullFit, Mesh, Piece, Shape};

use crate::error::FileErrorKind;
use crate::mesh_file::{self, Soup};
use crate::options::LoadOptions;

/// The body that is made from a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MeshUse {
    /// The convex hull: the fastest queries, but the hull is larger than the mesh.
    #[default]
    Hull,
    /// The triangles of the mesh; a closed mesh is solid.
    Mesh,
    /// Convex pieces from a separate file: the hull of each object of an OBJ.
    Pieces,
}

/// A solid that is centred at its origin, with its axis along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solid {
    Box { size: [f64; 3] },
    Cylinder { radius: f64, length: f64 },
    Capsule { radius: f64, length: f64 },
    Sphere { radius: f64 },
}

impl Solid {
    pub(crate) fn geometry(&self) -> Result<Geometry, FileErrorKind> {
        let refused = |e: &dyn std::fmt::Display| FileErrorKind::Geometry(e.to_string());
        let shape = match *self {
            Self::Box { size } => {
                check("size", &size)?;
                let body = solids::cuboid(Vector3::from(size) * 0.5).map_err(|e| refused(&e))?;
                return Ok(Geometry::from(body));
            }
            Self::Cylinder { radius, length } => {
                check("radius", &[radius])?;
                check("length", &[length])?;
                Shape::cylinder(0.5 * length, radius)
            }
            // URDF allows a capsule of length zero, which is a ball.
            Self::Capsule { radius, length } if length != 0.0 => {
                check("radius", &[radius])?;
                check("length", &[length])?;
                Shape::capsule(0.5 * length, radius)
            }
            Self::Capsule { radius, .. } | Self::Sphere { radius } => {
                check("radius", &[radius])?;
                Shape::ball(radius)
            }
        };
        Ok(Geometry::from(shape.map_err(|e| refused(&e))?))
    }
}

fn check(field: &str, sizes: &[f64]) -> Result<(), FileErrorKind> {
    match sizes.iter().find(|x| !(**x > 0.0)) {
        Some(&value) => Err(FileErrorKind::Range {
            field: field.into(),
            value,
        }),
        None => Ok(()),
    }
}

/// Returns the body of a mesh file, and the fit of its hull if requested.
pub(crate) fn of_mesh(
    file: &Path,
    scale: &Vector3<f64>,
    usage: MeshUse,
    options: &LoadOptions,
) -> Result<(Geometry, Option<HullFit>), FileErrorKind> {
    let of_file = |file: &Path, why: String| FileErrorKind::Geometry(format!("mesh {}: {why}", file.display()));
    if let Some(&value) = scale.iter().find(|s| **s == 0.0) {
        return Err(FileErrorKind::Range {
            field: "scale".into(),
            value,
        });
    }
    match usage {
        MeshUse::Hull => {
            let soup = mesh_file::whole(file, scale)?;
            let hull = ConvexPolyhedron::from_points(&soup.points).map_err(|e| of_file(file, e.to_string()))?;
            let mesh = options.measure_hulls.then(|| Mesh::new(&soup.points, &soup.triangles));
            let fit = mesh.and_then(Result::ok).map(|mesh| mesh.hull_fit(&hull));
            Ok((Geometry::from(hull), fit))
        }
        MeshUse::Mesh => {
            let Soup { points, triangles } = mesh_file::whole(file, scale)?;
            let mesh = Mesh::new(&points, &triangles).map_err(|e| of_file(file, e.to_string()))?;
            Ok((Geometry::from(mesh), None))
        }
        MeshUse::Pieces => {
            let Some(folder) = &options.pieces else {
                return Err(FileErrorKind::Missing("folder of the convex pieces".into()));
            };
            let beside = folder.join(file.file_stem().unwrap_or_default()).with_extension("obj");
            if !beside.is_file() {
                return Err(FileErrorKind::Missing(format!(
                    "file {} of the convex pieces",
                    beside.display()
                )));
            }
            let hulls = mesh_file::objects(&beside, scale)?;
            let hulls = hulls
                .iter()
                .map(|soup| ConvexPolyhedron::from_points(&soup.points).map(Piece::new));
            let hulls: Result<Vec<Piece>, _> = hulls.collect();
            let hulls = hulls.map_err(|e| of_file(&beside, e.to_string()))?;
            let compound = Compound::new(hulls).map_err(|e| of_file(&beside, e.to_string()))?;
            Ok((Geometry::from(compound), None))
        }
    }
}

/// Returns an upper bound of the distance from the origin of a body's frame to its farthest point.
pub(crate) fn radius(geometry: &Geometry) -> f64 {
    let (centre, radius): (Point3<f64>, f64) = geometry.bounding_ball();
    centre.coords.norm() + radius
}
