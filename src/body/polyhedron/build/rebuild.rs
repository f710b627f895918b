//! Rebuilds a body from its vertices in order, for files and replays.

use alloc::vec::Vec;
use nalgebra::Point3;

use crate::body::polyhedron::{BuildError, ConvexPolyhedron};

impl ConvexPolyhedron {
    /// Returns the vertices of the first side of a polygon, in order; empty for other bodies.
    pub(crate) fn first_side(&self) -> Vec<u32> {
        let side = self.faces().next().filter(|_| self.face_count() == 2);
        side.map_or(Vec::new(), |f| self.face_vertices(f).map(|v| v.0).collect())
    }

    /// Returns the body with the given vertices, in the order of their ids, and the given
    /// [`first_side`](Self::first_side): identical bit for bit, because origin, scale and numbering
    /// depend on the extreme points alone. Only names and report are lost.
    ///
    /// # Errors
    /// Vertices that are not the vertices of a body in order, or make no body.
    pub(crate) fn rebuilt(points: &[Point3<f64>], first_side: &[u32]) -> Result<Self, BuildError> {
        let damaged = |what| BuildError::Damaged { what };
        let body = match *points {
            [p] => Self::point(p)?,
            [p, q] => Self::segment(p, q)?,
            _ if first_side.is_empty() => Self::from_points(points)?,
            _ => {
                let corner = |&i: &u32| points.get(i as usize).copied();
                let rim: Option<Vec<_>> = first_side.iter().map(corner).collect();
                Self::polygon(&rim.ok_or(damaged("the polygon names an unknown vertex"))?)?
            }
        };
        if body.vertex_points().ne(points.iter().copied()) {
            return Err(damaged("the vertices are not those of a body in order"));
        }
        Ok(body)
    }
}
