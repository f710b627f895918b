//! Meshes from files, scaled as a URDF or a cell states.

use std::path::Path;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny_formats::{MeshFile, MeshObject};

use crate::error::FileErrorKind;

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
