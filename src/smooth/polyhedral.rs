//! Polyhedra as cores of curved pairs.

use nalgebra::Vector3;

use crate::num::scalar::{Scalar, Vec3};
use crate::pair::difference::support_vertex;
use crate::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::shape::{Disc, Support};

/// A polyhedron in stored coordinates, times a power of two.
#[derive(Clone, Copy)]
pub(super) struct Hull<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    pub(super) unit: f64,
}

/// Branches are the vertices.
impl Support for Hull<'_> {
    fn reach(&self) -> f64 {
        self.body.radius * self.unit
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>) {
        let hint = if (hint as usize) < self.body.points.len() {
            hint
        } else {
            0
        };
        let VertexId(branch) = support_vertex(self.body, n, VertexId(hint));
        (branch, self.of_branch(branch, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, branch: u32, _: &Vec3<T>) -> Vec3<T> {
        let points = &self.body.points;
        let p = points.get(branch as usize).unwrap_or(&points[0]) * self.unit;
        [T::from(p.x), T::from(p.y), T::from(p.z)]
    }

    #[inline(always)]
    fn bent<T: Scalar>(&self, _: u32, _: &Vec3<T>, _: &Vec3<T>, _: &Vec3<T>) -> Vec3<T> {
        [T::from(0.0); 3]
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T> {
        self.of_branch(branch, place)
    }

    fn inner_ball(&self, point: &Vector3<f64>, _: &Vector3<f64>) -> (Vector3<f64>, f64) {
        (*point, 0.0)
    }

    fn disc(&self, _: &Vector3<f64>) -> Option<Disc> {
        None
    }

    fn feature(&self, branches: &[u32], _: &Vector3<f64>) -> Feature {
        let mut vertices = [VertexId(branches.first().copied().unwrap_or(0)); 3];
        for (vertex, &branch) in vertices.iter_mut().zip(branches) {
            *vertex = VertexId(branch);
        }
        if vertices.iter().any(|v| v.index() >= self.body.points.len()) {
            return Feature::Vertex(VertexId(0));
        }
        self.body.feature_of(&vertices)
    }
}
