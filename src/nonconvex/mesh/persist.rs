//! Meshes in files (feature `serde`).
//!
//! A file holds vertices, triangles and names in the caller's order. Everything else is built again
//! on reading, so that a malicious file does no harm and the mesh is equal to the last bit. If
//! vertices were replaced, the file holds the vertices as built and the current ones.

use alloc::vec::Vec;
use nalgebra::Point3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::vertices::by_source;
use super::{Mesh, MeshError, MeshReport};
use crate::base::num::each::Each;

#[derive(Serialize, Deserialize)]
#[serde(rename = "Mesh")]
struct StoredMesh {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    source_points: Vec<u32>,
    source_triangles: Vec<u32>,
    report: MeshReport,
    /// The positions of the vertices, if they were replaced after the build.
    #[serde(default)]
    now: Vec<[f64; 3]>,
}

impl Serialize for Mesh {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (points, triangles) = (by_source(&self.source_points), by_source(&self.source_triangles));
        let mut number = points.clone();
        (0u32..).zip(&points).for_each(|(k, &v)| number[v as usize] = k);
        let now: Vec<[f64; 3]> = self.vertices().into_iter().map(Into::into).collect();
        let (built, now) = match &self.bending {
            Some(bending) => (bending.built.iter().map(|p| (*p).into()).collect(), now),
            None => (now, Vec::new()),
        };
        StoredMesh {
            points: built,
            now,
            triangles: triangles
                .iter()
                .map(|&t| self.triangles[t as usize].each(|v| number[v as usize]))
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
    mesh.fingerprint = mesh.fingerprint_as_built();
    let kind = mesh.report.kind;
    mesh.report = MeshReport { kind, ..stored.report };
    if !stored.now.is_empty() {
        let now: Vec<Point3<f64>> = stored.now.into_iter().map(Point3::from).collect();
        mesh.set_vertices(&now).map_err(|_| MeshError::Damaged {
            what: "the places of the vertices are not those of this mesh",
        })?;
    }
    Ok(mesh)
}
