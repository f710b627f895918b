//! The geometry of a body: a solid of a URDF or cell, or a mesh.

use std::cmp::Ordering;
use std::path::Path;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    BuildError, Compound, ConvexPolyhedron, Geometry, HalfSpace, HullFit, Mesh, MeshError, Piece, RepairOptions, Shape,
};

use crate::error::FileErrorKind;
use crate::mesh_file::{self, MeshPlacing, Soup};
use crate::options::{LoadOptions, MeshUse};

/// A solid that is centred at its origin, with its axis along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solid {
    Box {
        size: [f64; 3],
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    /// The length is that of the axis, without the caps.
    Capsule {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    Ellipsoid {
        radii: [f64; 3],
    },
    /// The apex is at the end of positive z.
    Cone {
        radius: f64,
        length: f64,
    },
    /// All below the plane `z = 0`, as far as `extent` in each direction: a box, or a half-space if
    /// the extent is infinite.
    HalfSpace {
        extent: f64,
    },
}

impl Solid {
    /// Returns the body. A solid with sizes of zero is a point, a segment or a rectangle.
    pub(crate) fn geometry(&self) -> Result<Geometry, FileErrorKind> {
        let wrong = |e: &dyn std::fmt::Display| FileErrorKind::Geometry(e.to_string());
        let sizes: &[(&str, f64)] = match self {
            Self::Box { size: [x, y, z] } => &[("size", *x), ("size", *y), ("size", *z)],
            Self::Cylinder { radius, length } | Self::Capsule { radius, length } | Self::Cone { radius, length } => {
                &[("radius", *radius), ("length", *length)]
            }
            Self::Ellipsoid { radii: [x, y, z] } => &[("radii", *x), ("radii", *y), ("radii", *z)],
            Self::Sphere { radius } => &[("radius", *radius)],
            Self::HalfSpace { extent } => &[("extent of planes", *extent)],
        };
        if let Some(&(field, value)) = sizes.iter().find(|(_, size)| !(*size >= 0.0)) {
            let field = field.into();
            return Err(FileErrorKind::Range { field, value });
        }
        let shape = match *self {
            Self::Box { size } if size.contains(&0.0) => {
                let corner = |k: usize| {
                    let half = |axis: usize| if k >> axis & 1 == 1 { 0.5 } else { -0.5 } * size[axis];
                    Point3::new(half(0), half(1), half(2))
                };
                return flat(&(0..8).map(corner).collect::<Vec<_>>()).map(Geometry::from);
            }
            Self::Box { size } => {
                let body = solids::cuboid(Vector3::from(size) * 0.5).map_err(|e| wrong(&e))?;
                return Ok(Geometry::from(body));
            }
            Self::Cylinder { radius: 0.0, length }
            | Self::Capsule { radius: 0.0, length }
            | Self::Cone { radius: 0.0, length } => {
                let end = Point3::new(0.0, 0.0, 0.5 * length);
                return flat(&[-end, end]).map(Geometry::from);
            }
            Self::Cylinder { radius, length: 0.0 } | Self::Cone { radius, length: 0.0 } => {
                let rule = "expected a length above 0, such as 1e-6";
                return Err(FileErrorKind::Geometry(format!(
                    "disc of radius {radius} and length 0 ({rule})"
                )));
            }
            Self::Sphere { radius: 0.0 } => return flat(&[Point3::origin()]).map(Geometry::from),
            Self::Cylinder { radius, length } => Shape::cylinder(0.5 * length, radius),
            // URDF allows a capsule of length zero, which is a ball.
            Self::Capsule { radius, length: 0.0 } | Self::Sphere { radius } => Shape::ball(radius),
            Self::Capsule { radius, length } => Shape::capsule(0.5 * length, radius),
            Self::Ellipsoid { radii } => Shape::ellipsoid(Vector3::from(radii)),
            Self::Cone { radius, length } => Shape::cone(0.5 * length, radius),
            Self::HalfSpace { extent: f64::INFINITY } => {
                return HalfSpace::new(Vector3::z(), 0.0)
                    .map(Geometry::from)
                    .map_err(|e| wrong(&e));
            }
            Self::HalfSpace { extent } => {
                let corner = |k: usize| {
                    let [x, y] = [k & 1, k >> 1 & 1].map(|side| if side == 1 { extent } else { -extent });
                    Point3::new(x, y, if k >> 2 == 1 { 0.0 } else { -extent })
                };
                return hull(&(0..8).map(corner).collect::<Vec<_>>()).map(Geometry::from);
            }
        };
        Ok(Geometry::from(shape.map_err(|e| wrong(&e))?))
    }
}

/// Returns the convex hull of points, which may lie in a plane, on a line, or in one place.
fn hull(points: &[Point3<f64>]) -> Result<ConvexPolyhedron, FileErrorKind> {
    match ConvexPolyhedron::from_points(points) {
        Err(BuildError::Flat { .. }) => flat(points),
        hull => hull.map_err(|e| FileErrorKind::Geometry(e.to_string())),
    }
}

/// Returns the convex hull of points in a plane, on a line, or in one place.
fn flat(points: &[Point3<f64>]) -> Result<ConvexPolyhedron, FileErrorKind> {
    // On a line, the ends are first and last in the order of coordinates.
    let before = |a: &&Point3<f64>, b: &&Point3<f64>| {
        let order = a
            .iter()
            .zip(b.iter())
            .map(|(x, y)| x.partial_cmp(y).unwrap_or(Ordering::Equal));
        order.fold(Ordering::Equal, Ordering::then)
    };
    let ends = points.iter().min_by(before).zip(points.iter().max_by(before));
    let body = match (ConvexPolyhedron::polygon(points), ends) {
        (Err(BuildError::Flat { .. } | BuildError::TooFewPoints { .. }), Some((a, b))) if a == b => {
            ConvexPolyhedron::point(*a)
        }
        (Err(BuildError::Flat { .. } | BuildError::TooFewPoints { .. }), Some((a, b))) => {
            ConvexPolyhedron::segment(*a, *b)
        }
        (polygon, _) => polygon,
    };
    body.map_err(|e| FileErrorKind::Geometry(e.to_string()))
}

/// Returns the body of a mesh file, and the fit of its hull if requested.
pub(crate) fn of_mesh(
    file: &Path,
    placing: &MeshPlacing,
    usage: MeshUse,
    options: &LoadOptions,
) -> Result<(Geometry, Option<HullFit>), FileErrorKind> {
    let of_file = |file: &Path, why: String| FileErrorKind::Geometry(format!("mesh {}: {why}", file.display()));
    if usage != MeshUse::Pieces {
        let named = |e: FileErrorKind| of_file(file, e.to_string());
        let soup = mesh_file::whole(file, placing, usage == MeshUse::Hull)?;
        return of_soup(soup, usage, options).map_err(named);
    }
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
    let hulls = mesh_file::objects(&beside, placing, true)?;
    let hulls = hulls.iter().map(|soup| hull(&soup.points).map(Piece::new));
    let hulls: Result<Vec<Piece>, _> = hulls.collect();
    let hulls = hulls.map_err(|e| of_file(&beside, e.to_string()))?;
    let compound = Compound::new(hulls).map_err(|e| of_file(&beside, e.to_string()))?;
    Ok((Geometry::from(compound), None))
}

/// Returns the body of points and triangles: their hull, or the mesh. A hull needs no triangles.
pub(crate) fn of_soup(
    soup: Soup,
    usage: MeshUse,
    options: &LoadOptions,
) -> Result<(Geometry, Option<HullFit>), FileErrorKind> {
    let Soup { points, triangles } = soup;
    let wrong = |e: MeshError| FileErrorKind::Geometry(e.to_string());
    let mesh = || Mesh::new(&points, &triangles).map_err(wrong);
    match usage {
        MeshUse::Mesh => return Ok((Geometry::from(mesh()?), None)),
        MeshUse::Solid => {
            let solid = Mesh::repaired(&points, &triangles, &RepairOptions::default()).map_err(wrong)?;
            return Ok((Geometry::from(solid), None));
        }
        MeshUse::Hull | MeshUse::Pieces => {}
    }
    let hull = hull(&points)?;
    let mesh = options.measure_hulls.then(mesh).and_then(Result::ok);
    let fit = mesh.map(|mesh| mesh.hull_fit(&hull));
    Ok((Geometry::from(hull), fit))
}

/// Returns the body of one object of a mesh file, and the fit of its hull if requested.
pub(crate) fn of_submesh(
    file: &Path,
    name: &str,
    is_centered: bool,
    placing: &MeshPlacing,
    usage: MeshUse,
    options: &LoadOptions,
) -> Result<(Geometry, Option<HullFit>), FileErrorKind> {
    let named = |e: FileErrorKind| match e {
        FileErrorKind::Geometry(why) => FileErrorKind::Geometry(format!("mesh {}: {why}", file.display())),
        other => other,
    };
    if usage == MeshUse::Pieces {
        return Err(FileErrorKind::Unsupported("a submesh as convex pieces".into()));
    }
    let soup = mesh_file::submesh(file, name, is_centered, placing, usage == MeshUse::Hull);
    soup.and_then(|soup| of_soup(soup, usage, options)).map_err(named)
}
