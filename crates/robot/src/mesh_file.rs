//! Meshes from files, scaled as a URDF or a cell states.

use std::path::Path;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny_formats::{MeshFile, MeshFormat, MeshObject};

use crate::error::FileErrorKind;
use crate::names::nearest;

/// Points and triangles of one object of a mesh file.
pub(crate) struct Soup {
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Soup {
    fn new(object: MeshObject, scale: &Vector3<f64>) -> Self {
        let scaled = |p: [f64; 3]| Point3::from(Vector3::from(p).component_mul(scale));
        let mut triangles = object.triangles;
        // A mirror turns the mesh inside out.
        if scale.x * scale.y * scale.z < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Self {
            points: object.points.into_iter().map(scaled).collect(),
            triangles,
        }
    }
}

/// Returns the scaled objects of a file.
pub(crate) fn objects(file: &Path, scale: &Vector3<f64>) -> Result<Vec<Soup>, FileErrorKind> {
    let mesh = MeshFile::load(file)?;
    let soups: Vec<Soup> = mesh
        .objects
        .into_iter()
        .map(|object| Soup::new(object, scale))
        .collect();
    match soups
        .iter()
        .flat_map(|soup| &soup.points)
        .find(|p| !p.iter().all(|x| x.is_finite()))
    {
        Some(_) => Err(FileErrorKind::Geometry(format!(
            "mesh {}: a scaled point is not finite",
            file.display()
        ))),
        None => Ok(soups),
    }
}

/// Returns all objects of a file as one mesh.
pub(crate) fn whole(file: &Path, scale: &Vector3<f64>) -> Result<Soup, FileErrorKind> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for soup in objects(file, scale)? {
        let first = points.len() as u32;
        points.extend(soup.points);
        triangles.extend(soup.triangles.iter().map(|t| t.map(|k| k + first)));
    }
    Ok(Soup { points, triangles })
}

/// Returns the one object of a file that has a name.
///
/// A centred object has the middle of the box around it at the origin.
pub(crate) fn submesh(file: &Path, name: &str, is_centered: bool, scale: &Vector3<f64>) -> Result<Soup, FileErrorKind> {
    if let Some(&value) = scale.iter().find(|s| **s == 0.0) {
        let field = "scale".into();
        return Err(FileErrorKind::Range { field, value });
    }
    let mesh = MeshFile::load(file)?;
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
    let soup = Soup::new(object, scale);
    if !soup.points.iter().all(|p| p.iter().all(|x| x.is_finite())) {
        let what = format!("mesh {}: a scaled point is not finite", file.display());
        return Err(FileErrorKind::Geometry(what));
    }
    Ok(soup)
}
