//! The surface of a mesh with adjacency: possible places and normals of contacts.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::composite::mesh::Mesh;
use crate::composite::triangle::{self, Spot};
use crate::num::scalar::sqrt;

/// Triangles in the caller's coordinates, by vertex and by patch.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    source: Vec<u32>,
    /// The triangles about each vertex: where its list begins, and the lists.
    first: Vec<u32>,
    about: Vec<u32>,
    /// The triangles of each patch: where its list begins, and the lists.
    patch_first: Vec<u32>,
    of_patch: Vec<u32>,
}

impl Skin {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut first = alloc::vec![0u32; mesh.points.len() + 1];
        for &v in mesh.triangles.iter().flatten() {
            first[v as usize + 1] += 1;
        }
        for v in 0..mesh.points.len() {
            first[v + 1] += first[v];
        }
        let mut at = first.clone();
        let mut about = alloc::vec![0; 3 * mesh.triangles.len()];
        for (k, t) in (0u32..).zip(&mesh.triangles) {
            for &v in t {
                about[at[v as usize] as usize] = k;
                at[v as usize] += 1;
            }
        }
        Self {
            points: mesh.points.iter().map(|p| mesh.given(p).coords).collect(),
            triangles: mesh.triangles.clone(),
            source: mesh.source_triangles.clone(),
            first,
            about,
            patch_first: Vec::new(),
            of_patch: Vec::new(),
        }
    }

    pub(super) fn set_patches(&mut self, patches: Vec<Vec<u32>>) {
        self.patch_first = alloc::vec![0];
        for patch in patches {
            self.of_patch.extend(patch);
            self.patch_first.push(self.of_patch.len() as u32);
        }
    }

    pub(super) fn extent(&self) -> f64 {
        self.points.iter().fold(0.0, |m: f64, p| m.max(p.amax()))
    }

    pub(super) fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    /// The normal of a triangle, with twice its area as length.
    pub(super) fn normal(&self, triangle: u32) -> Vector3<f64> {
        triangle::normal(&self.corners(triangle))
    }

    fn about(&self, vertex: u32) -> &[u32] {
        let [from, to] = [vertex, vertex + 1].map(|v| self.first[v as usize] as usize);
        &self.about[from..to]
    }

    /// The triangles that share an edge with one, run in the opposite sense.
    pub(super) fn adjacent(&self, triangle: u32) -> Vec<u32> {
        let t = self.triangles[triangle as usize];
        let runs = |other: u32, from: u32, to: u32| {
            let u = self.triangles[other as usize];
            (0..3).any(|k| u[k] == from && u[(k + 1) % 3] == to)
        };
        (0..3)
            .flat_map(|k| {
                let (from, to) = (t[k], t[(k + 1) % 3]);
                let all = self.about(from).iter().copied();
                all.filter(move |&other| runs(other, to, from))
            })
            .collect()
    }

    fn patch(&self, patch: u32) -> &[u32] {
        let range = self.patch_first.get(patch as usize..patch as usize + 2);
        range.map_or(&[], |r| &self.of_patch[r[0] as usize..r[1] as usize])
    }

    pub(super) fn sources(&self, patch: u32) -> impl Iterator<Item = u32> + '_ {
        self.patch(patch).iter().map(|&t| self.source[t as usize])
    }

    /// Whether a point lies on a patch's triangles, within `slack`, and the outward direction `n`
    /// is a normal of the mesh there: within `sine` of the normal of a triangle
    /// at the point, or in the cone of normals of the vertex or edge.
    pub(super) fn bears(&self, patch: u32, point: &Vector3<f64>, n: &Vector3<f64>, sine: f64, slack: f64) -> bool {
        self.patch(patch).iter().any(|&t| {
            let (square, spot) = triangle::nearest(point, &self.corners(t));
            square <= slack * slack && (self.faces(t, n, sine) || self.is_in_cone(t, spot, n, sine))
        })
    }

    fn faces(&self, triangle: u32, n: &Vector3<f64>, sine: f64) -> bool {
        let own = self.normal(triangle);
        let length = sqrt(own.norm_squared());
        own.dot(n) > 0.0 && own.cross(n).norm_squared() <= (sine * length) * (sine * length)
    }

    /// Whether no vertex of the triangles about a vertex or edge is higher along `n`: the feature
    /// is convex there and `n` one of its normals. Reflex edges have none.
    fn is_in_cone(&self, triangle: u32, spot: Spot, n: &Vector3<f64>, sine: f64) -> bool {
        let t = self.triangles[triangle as usize];
        let ends = match spot {
            Spot::Inside => return false,
            Spot::Vertex(k) => [t[k as usize % 3]; 2],
            Spot::Edge(k) => [t[k as usize % 3], t[(k as usize + 1) % 3]],
        };
        let base = self.points[ends[0] as usize];
        let is_lower = |&v: &u32| {
            let d = self.points[v as usize] - base;
            n.dot(&d) <= sine * sqrt(d.norm_squared())
        };
        let all = self.about(ends[0]).iter().map(|&t| &self.triangles[t as usize]);
        all.filter(|t| t.contains(&ends[1])).all(|t| t.iter().all(is_lower))
    }
}
