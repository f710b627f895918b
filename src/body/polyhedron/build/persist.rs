//! Serialization of bodies (feature `serde`): vertices and the caller's indices are written,
//! everything else is rebuilt and checked.
//!
//! Because the body is rebuilt, a hostile file is harmless and the result is identical bit for bit:
//! origin, scale and numbering depend on the extreme points alone.

use alloc::vec::Vec;
use nalgebra::Point3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::body::polyhedron::{BuildError, BuildReport, ConvexPolyhedron};

#[derive(Serialize, Deserialize)]
#[serde(rename = "ConvexPolyhedron")]
struct StoredPolyhedron {
    /// The vertices in the order of their ids.
    vertices: Vec<[f64; 3]>,
    /// The vertices of the first side of a polygon, in order; empty for other bodies.
    polygon: Vec<u32>,
    source: Vec<u32>,
    source_faces: Vec<u32>,
    report: BuildReport,
}

impl Serialize for ConvexPolyhedron {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        StoredPolyhedron {
            vertices: self.vertex_points().map(|p| [p.x, p.y, p.z]).collect(),
            polygon: self.first_side(),
            source: self.source.clone(),
            source_faces: self.source_faces.clone(),
            report: self.report.clone(),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ConvexPolyhedron {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        restore(StoredPolyhedron::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

fn restore(stored: StoredPolyhedron) -> Result<ConvexPolyhedron, BuildError> {
    let damaged = |what| BuildError::Damaged { what };
    let points: Vec<Point3<f64>> = stored.vertices.iter().map(|&[x, y, z]| Point3::new(x, y, z)).collect();
    let mut body = ConvexPolyhedron::rebuilt(&points, &stored.polygon)?;
    let sizes = (stored.source.len(), stored.source_faces.len());
    if sizes.0 != body.vertex_count() || sizes.1 != 0 && sizes.1 != body.face_count() {
        return Err(damaged("the lists of names have the wrong length"));
    }
    (body.source, body.source_faces, body.report) = (stored.source, stored.source_faces, stored.report);
    Ok(body)
}
