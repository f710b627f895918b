//! Meshes from STL, OBJ and COLLADA files.

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

use lin_canny::nalgebra::{Point3, Vector3};

use crate::collada;

/// Points and triangles of one object of an OBJ, or of one primitive of a COLLADA file.
pub(crate) struct Soup {
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Returns the scaled objects of a file: one for an STL, one or more for an OBJ or a COLLADA file.
pub(crate) fn objects(file: &Path, scale: &Vector3<f64>) -> Result<Vec<Soup>, String> {
    let ending = file.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let mut objects = match ending.as_deref() {
        Some("stl") => vec![stl(file)?],
        Some("obj") => obj(file)?,
        Some("dae") => {
            let text = std::fs::read_to_string(file).map_err(|e| format!("cannot be read: {e}"))?;
            collada::read(&text)?
        }
        _ => return Err("unknown file extension (expected .stl, .obj or .dae)".into()),
    };
    for soup in &mut objects {
        if let Some(k) = soup.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(format!("point {k} is not finite"));
        }
        for p in &mut soup.points {
            *p = Point3::from(p.coords.component_mul(scale));
        }
        // A mirror turns the mesh inside out.
        if scale.x * scale.y * scale.z < 0.0 {
            soup.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
    objects.retain(|soup| !soup.triangles.is_empty());
    if objects.is_empty() {
        return Err("contains no triangle".into());
    }
    Ok(objects)
}

/// Returns all objects of a file as one mesh.
pub(crate) fn whole(file: &Path, scale: &Vector3<f64>) -> Result<Soup, String> {
    let objects = objects(file, scale)?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for soup in objects {
        let first = points.len() as u32;
        points.extend(soup.points);
        triangles.extend(soup.triangles.iter().map(|t| t.map(|k| k + first)));
    }
    Ok(Soup { points, triangles })
}

fn stl(file: &Path) -> Result<Soup, String> {
    let mut bytes = std::fs::read(file).map_err(|e| format!("cannot be read: {e}"))?;
    // The reader takes a header that starts with `solid` for text. If the length fits, the file is
    // binary.
    let count = bytes.get(80..84).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    if count.is_some_and(|n| bytes.len() as u64 == 84 + 50 * u64::from(n)) {
        bytes[..80].fill(0);
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|e| format!("malformed STL: {e}"))?;
    let point = |v: &stl_io::Vertex| Point3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
    Ok(Soup {
        points: mesh.vertices.iter().map(point).collect(),
        triangles: mesh.faces.iter().map(|f| f.vertices.map(|k| k as u32)).collect(),
    })
}

fn obj(file: &Path) -> Result<Vec<Soup>, String> {
    let text = File::open(file).map_err(|e| format!("cannot be read: {e}"))?;
    let options = tobj::LoadOptions {
        triangulate: true,
        ..tobj::LoadOptions::default()
    };
    // Materials are only colours.
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(text), &options, no_materials)
        .map_err(|e| format!("malformed OBJ: {e}"))?;
    let soup = |model: tobj::Model| Soup {
        points: model
            .mesh
            .positions
            .as_chunks::<3>()
            .0
            .iter()
            .copied()
            .map(Point3::from)
            .collect(),
        triangles: model.mesh.indices.as_chunks::<3>().0.to_vec(),
    };
    Ok(models.into_iter().map(soup).collect())
}
