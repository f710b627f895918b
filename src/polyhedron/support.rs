//! Extreme vertices: hill climbing from a hint, and a cube map of directions for cold starts.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::topology::Topology;

/// The extreme vertex of a grid of directions on the faces of a cube.
#[derive(Clone, Debug)]
pub(crate) struct CubeMap {
    /// Cells along an edge of the cube.
    side: u32,
    cells: Vec<u32>,
}

impl CubeMap {
    /// Looks up every cell by climbing from its neighbour's vertex.
    pub(crate) fn new(_topology: &Topology, _points: &[Vector3<f64>]) -> Self {
        Self { side: 1, cells: Vec::new() }
    }
}
