//! Meshes from files, scaled as a URDF or a cell states.

use std::path::Path;

use lin_canny::nalgebra::{Matrix3, Point3, Vector3};
use lin_canny_formats::{MeshFile, MeshFormat};

use crate::error::FileErrorKind;
use lin_canny_plan::nearest_name as nearest;

/// Points and triangles of one object of a mesh file.
pub(crate) struct Soup {
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// How the points of a mesh are moved: by `before`, and then by a linear map.
pub(crate) struct MeshPlacing {
    before: Vector3<f64>,
    linear: Matrix3<f64>,
}

impl MeshPlacing {
    /// Returns an error if a factor of the scale is zero.
    pub(crate) fn scaled(scale: [f64; 3]) -> Result<Self, FileErrorKind> {
        Self::new(Vector3::zeros(), Matrix3::identity(), scale)
    }

    /// Returns the placing that moves, then turns, then scales.
    pub(crate) fn new(before: Vector3<f64>, turn: Matrix3<f64>, scale: [f64; 3]) -> Result<Self, FileErrorKind> {
        if let Some(&value) = scale.iter().find(|s| **s == 0.0) {
            let field = "scale".into();
            return Err(FileErrorKind::Range { field, value });
        }
        let linear = Matrix3::from_diagonal(&Vector3::from(scale)) * turn;
        Ok(Self { before, linear })
    }
}

impl Soup {
    /// Returns the moved mesh, or an error if a point is then not finite.
    pub(crate) fn new(
        points: &[[f64; 3]],
        mut triangles: Vec<[u32; 3]>,
        placing: &MeshPlacing,
    ) -> Result<Self, FileErrorKind> {
        let placed = |p: &[f64; 3]| Point3::from(placing.linear * (Vector3::from(*p) + placing.before));
        let points: Vec<Point3<f64>> = points.iter().map(placed).collect();
        if !points.iter().all(|p| p.iter().all(|x| x.is_finite())) {
            return Err(FileErrorKind::Geometry("a scaled point is not finite".into()));
        }
        // A mirror turns the mesh inside out.
        if placing.linear.determinant() < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(Self { points, triangles })
    }
}

/// Returns the placed objects of a file.
///
/// With `is_hull` they may have no triangles.
pub(crate) fn objects(file: &Path, placing: &MeshPlacing, is_hull: bool) -> Result<Vec<Soup>, FileErrorKind> {
    let named = |e: FileErrorKind| FileErrorKind::Geometry(format!("mesh {}: {e}", file.display()));
    let mesh = load(file, is_hull)?;
    let soups = mesh
        .objects
        .into_iter()
        .map(|object| Soup::new(&object.points, object.triangles, placing));
    soups.collect::<Result<_, _>>().map_err(named)
}

fn load(file: &Path, is_hull: bool) -> Result<MeshFile, FileErrorKind> {
    let mesh = if is_hull {
        MeshFile::load_for_hull(file)
    } else {
        MeshFile::load(file)
    };
    Ok(mesh?)
}

/// Returns all objects of a file as one mesh.
pub(crate) fn whole(file: &Path, placing: &MeshPlacing, is_hull: bool) -> Result<Soup, FileErrorKind> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for soup in objects(file, placing, is_hull)? {
        let first = points.len() as u32;
        points.extend(soup.points);
        triangles.extend(soup.triangles.iter().map(|t| t.map(|k| k + first)));
    }
    Ok(Soup { points, triangles })
}

/// Returns the one object of a file that has a name.
///
/// A centred object has the middle of the box around it at the origin.
pub(crate) fn submesh(
    file: &Path,
    name: &str,
    is_centered: bool,
    placing: &MeshPlacing,
    is_hull: bool,
) -> Result<Soup, FileErrorKind> {
    let mesh = load(file, is_hull)?;
    // Simulators use the name of the node here, and the objects have the name of the geometry.
    if mesh.format == MeshFormat::Collada {
        return Err(FileErrorKind::Unsupported("a submesh of a COLLADA file".into()));
    }
    let unknown = || FileErrorKind::Unknown {
        kind: "submesh",
        name: name.into(),
        near: nearest(name, mesh.objects.iter().map(|object| object.name.as_str())),
    };
    let mut named = mesh.objects.iter().filter(|object| object.name == name);
    let mut object = named.next().ok_or_else(unknown)?.clone();
    if named.next().is_some() {
        let what = format!("several submeshes have the name {name:?} (expected one)");
        return Err(FileErrorKind::Malformed(what));
    }
    if is_centered {
        for axis in 0..3 {
            let values = || object.points.iter().map(|p| p[axis]);
            let low = values().fold(f64::INFINITY, |least, x| if x < least { x } else { least });
            let high = values().fold(f64::NEG_INFINITY, |most, x| if x > most { x } else { most });
            let middle = 0.5 * low + 0.5 * high;
            object.points.iter_mut().for_each(|p| p[axis] -= middle);
        }
    }
    Soup::new(&object.points, object.triangles, placing)
}
