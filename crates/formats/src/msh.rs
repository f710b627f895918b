//! MSH, the binary meshes of MuJoCo: four counts, and then points, normals, texture coordinates and
//! triangles, all in little endian with 32 bits. Source: MuJoCo's chapter "XML reference", `mesh`.

use crate::error::Fault;
use crate::mesh::{MeshFile, MeshFormat, MeshObject, ObjectBuilder, SkippedList};

/// Bytes of the four counts.
const HEADER: usize = 16;

pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let (words, rest) = bytes.as_chunks::<4>();
    let counts = words.first_chunk::<4>().map(|words| words.map(u32::from_le_bytes));
    let Some(counts) = counts else {
        let found = bytes.len();
        let why = format!("MSH file is cut: {found} bytes (expected {HEADER} bytes of counts)");
        return Err(Fault::malformed(None, why));
    };
    let [points, normals, coordinates, triangles] = counts.map(u64::from);
    let expected = 4 * (3 * (points + normals + triangles) + 2 * coordinates) + HEADER as u64;
    if expected != bytes.len() as u64 || !rest.is_empty() {
        let found = bytes.len();
        let why = format!("size of an MSH file is {found} bytes (expected {expected} for its counts)");
        return Err(Fault::malformed(None, why));
    }
    let number = |k: usize| words.get(4 + k).copied().unwrap_or_default();
    let point = |k: u64| [0, 1, 2].map(|axis| f64::from(f32::from_le_bytes(number(3 * k as usize + axis))));
    let first = (3 * (points + normals) + 2 * coordinates) as usize;
    let mut object = ObjectBuilder::new("");
    for triangle in 0..triangles {
        let corners = [0, 1, 2].map(|k| u64::from(u32::from_le_bytes(number(first + 3 * triangle as usize + k))));
        for corner in corners {
            if corner >= points {
                let why = format!("vertex of triangle {triangle} is out of range: {corner} (expected below {points})");
                return Err(Fault::malformed(None, why));
            }
            if !point(corner).iter().all(|x| x.is_finite()) {
                let why = format!("number of vertex {corner} is not finite");
                return Err(Fault::malformed(None, why));
            }
        }
        object
            .triangle(corners, point)
            .ok_or_else(|| Fault::malformed(None, "too many points"))?;
    }
    let mut skipped = SkippedList::default();
    for (count, what) in [(normals, "normals"), (coordinates, "texture coordinates")] {
        if count > 0 {
            skipped.add(None, what);
        }
    }
    let object = match triangles {
        0 => MeshObject::of_points(String::new(), (0..points).map(point).collect()),
        _ => object.build(),
    };
    Ok(MeshFile {
        format: MeshFormat::Msh,
        objects: vec![object],
        skipped: skipped.build(),
    })
}
