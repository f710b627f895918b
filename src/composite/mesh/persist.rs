//! Meshes in files (feature `serde`): vertices, triangles and names are written in the caller's
//! order, all else is built again, so that a hostile file does no harm and the mesh comes back bit
//! for bit.

use alloc::vec::Vec;
use nalgebra::Point3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Mesh, MeshError, MeshReport};

#[derive(Serialize, Deserialize)]
#[serde(rename = "Mesh")]
struct StoredMesh {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    source_points: Vec<u32>,
    source_triangles: Vec<u32>,
    report: MeshReport,
}

/// Numbers `0..names.len()` by rising name.
fn by_name(names: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..names.len() as u32).collect();
    order.sort_unstable_by_key(|&k| names[k as usize]);
    order
}

impl Serialize for Mesh {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (points, triangles) = (by_name(&self.source_points), by_name(&self.source_triangles));
        let mut number = points.clone();
        (0u32..).zip(&points).for_each(|(k, &v)| number[v as usize] = k);
        let place = |&v: &u32| self.given(&self.points[v as usize]).into();
        StoredMesh {
            points: points.iter().map(place).collect(),
            triangles: triangles
                .iter()
                .map(|&t| self.triangles[t as usize].map(|v| number[v as usize]))
                .collect(),
            source_points: points.iter().map(|&v| self.source_points[v as usize]).collect(),
            source_triangles: triangles.iter().map(|&t| self.source_triangles[t as usize]).collect(),
            report: self.report.clone(),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Mesh {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        restore(StoredMesh::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

fn restore(stored: StoredMesh) -> Result<Mesh, MeshError> {
    let points: Vec<Point3<f64>> = stored.points.into_iter().map(Point3::from).collect();
    let mut mesh = Mesh::new(&points, &stored.triangles)?;
    let kept = (mesh.vertex_count(), mesh.triangle_count());
    let given = (stored.source_points.len(), stored.source_triangles.len());
    if kept != (points.len(), stored.triangles.len()) || kept != given {
        return Err(MeshError::Damaged {
            what: "points or triangles are missing, repeated or without area",
        });
    }
    mesh.source_points
        .iter_mut()
        .for_each(|v| *v = stored.source_points[*v as usize]);
    mesh.source_triangles
        .iter_mut()
        .for_each(|t| *t = stored.source_triangles[*t as usize]);
    let kind = mesh.report.kind;
    mesh.report = MeshReport { kind, ..stored.report };
    Ok(mesh)
}
