//! Convex patches of a mesh's surface.
//!
//! A triangle joins the patch of an adjacent one if its vertices are on or below the planes of all
//! triangles of the patch, and all vertices of the patch on or below its own plane, both within a
//! tolerance: then every triangle of the patch lies within the tolerance of the boundary of the
//! patch's hull, outward.
//!
//! Source: the convex surface decomposition of Ehmann and Lin 2001, "Accurate and fast proximity
//! queries between polyhedra using convex surface decomposition", section 4. Departures:
//!
//! 1. Patches carry contacts only; distances are the triangles' own. So hulls may leave the solid.
//! 2. Signs have a tolerance: the vertices of a turned plane are rounded, so that its inner edges
//!    are reflex by a few units as often as not.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::scalar::sqrt;
use crate::composite::meet::triangle;
use crate::composite::mesh::Mesh;

/// Most planes of a patch for contacts: larger patches for a build in time that grows with their
/// square. Not measured.
const PLANES: usize = 1024;

/// A convex patch: triangles, each with a triangle of the plane to which it belongs.
pub(super) type PatchTriangles = Vec<(u32, u32)>;

/// Cuts a mesh into patches.
pub(super) fn grow(mesh: &Mesh, tolerance: f64) -> Vec<PatchTriangles> {
    let count = mesh.triangles.len() as u32;
    let surface = MeshSurface {
        mesh,
        tolerance,
        normals: (0..count).map(|t| unit_normal(mesh, t)).collect(),
        edges: edges(mesh),
    };
    let mut free = alloc::vec![true; count as usize];
    let mut patches = Vec::new();
    for seed in 0..count {
        if free[seed as usize] {
            free[seed as usize] = false;
            let mut patch = Growing::new(&surface, seed);
            patch.grow(&mut free);
            patches.push(patch.triangles);
        }
    }
    patches
}

/// Zero for a triangle too small to have one.
fn unit_normal(mesh: &Mesh, t: u32) -> Vector3<f64> {
    let n = triangle::normal(&mesh.corners(t));
    let length = sqrt(n.norm_squared());
    if length > 0.0 { n / length } else { n }
}

/// Returns the edges of all triangles as they run, in order, each with its triangle.
fn edges(mesh: &Mesh) -> Vec<([u32; 2], u32)> {
    let mut edges = Vec::with_capacity(3 * mesh.triangles.len());
    for (k, &[a, b, c]) in (0u32..).zip(&mesh.triangles) {
        edges.extend([([a, b], k), ([b, c], k), ([c, a], k)]);
    }
    edges.sort_unstable();
    edges
}

struct MeshSurface<'a> {
    mesh: &'a Mesh,
    tolerance: f64,
    normals: Vec<Vector3<f64>>,
    edges: Vec<([u32; 2], u32)>,
}

impl MeshSurface<'_> {
    /// Returns the height of a vertex over the plane of a triangle.
    fn height(&self, triangle: u32, vertex: u32) -> f64 {
        let base = self.mesh.points[self.mesh.triangles[triangle as usize][0] as usize];
        self.normals[triangle as usize].dot(&(self.mesh.points[vertex as usize] - base))
    }

    /// Returns the triangles that share an edge with one, run in the opposite sense.
    fn adjacent(&self, triangle: u32) -> impl Iterator<Item = u32> + '_ {
        let [a, b, c] = self.mesh.triangles[triangle as usize];
        [[b, a], [c, b], [a, c]].into_iter().flat_map(move |edge| {
            let from = self.edges.partition_point(|e| e.0 < edge);
            let run = self.edges[from..].iter().take_while(move |e| e.0 == edge);
            run.map(|e| e.1)
        })
    }
}

/// A patch that takes adjacent triangles.
struct Growing<'a> {
    surface: &'a MeshSurface<'a>,
    triangles: PatchTriangles,
    vertices: Vec<u32>,
    /// A triangle of each plane.
    planes: Vec<u32>,
}

impl<'a> Growing<'a> {
    fn new(surface: &'a MeshSurface<'a>, seed: u32) -> Self {
        Self {
            surface,
            triangles: alloc::vec![(seed, seed)],
            vertices: surface.mesh.triangles[seed as usize].to_vec(),
            planes: alloc::vec![seed],
        }
    }

    fn grow(&mut self, free: &mut [bool]) {
        let surface = self.surface;
        let mut queue = VecDeque::from([self.triangles[0]]);
        while let Some((of, plane)) = queue.pop_front() {
            for next in surface.adjacent(of) {
                if free[next as usize]
                    && let Some(plane) = self.admit(next, plane)
                {
                    free[next as usize] = false;
                    queue.push_back((next, plane));
                }
            }
        }
    }

    /// Takes a triangle that is adjacent to one of a plane, if the patch stays convex; returns the
    /// triangle's plane.
    fn admit(&mut self, next: u32, plane: u32) -> Option<u32> {
        let surface = self.surface;
        let triangle = surface.mesh.triangles[next as usize];
        let (own, other) = (surface.normals[next as usize], surface.normals[plane as usize]);
        let is_coplanar = triangle
            .iter()
            .all(|&v| surface.height(plane, v).abs() <= surface.tolerance);
        if is_coplanar && own.dot(&other) < 0.0 {
            return None;
        }
        let fits = |&v: &u32| self.planes.iter().all(|&t| surface.height(t, v) <= surface.tolerance);
        let holds = || {
            let mut all = self.vertices.iter();
            self.planes.len() < PLANES && all.all(|&v| surface.height(next, v) <= surface.tolerance)
        };
        if !triangle.iter().all(fits) || !is_coplanar && !holds() {
            return None;
        }
        let plane = if is_coplanar { plane } else { next };
        self.triangles.push((next, plane));
        self.vertices.extend(triangle);
        if self.vertices.len().is_power_of_two() {
            self.vertices.sort_unstable();
            self.vertices.dedup();
        }
        if !is_coplanar {
            self.planes.push(next);
        }
        Some(plane)
    }
}

/// Returns the vertices of a patch that span its hull within a tolerance: of each plane the corners
/// of the hull of its triangles, so that a flat face is flat whatever its vertices inside are.
pub(super) fn corners(mesh: &Mesh, patch: &PatchTriangles, tolerance: f64) -> Vec<u32> {
    let mut by_plane: Vec<(u32, u32)> = patch.iter().map(|&(t, plane)| (plane, t)).collect();
    by_plane.sort_unstable();
    let mut all = Vec::new();
    for run in by_plane.chunk_by(|x, y| x.0 == y.0) {
        let mut vertices: Vec<u32> = run.iter().flat_map(|r| mesh.triangles[r.1 as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        if run.len() > 1 {
            flat_corners(mesh, &unit_normal(mesh, run[0].0), tolerance, &mut vertices);
        }
        all.extend(vertices);
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Leaves the corners of the hull of vertices that lie in one plane (Andrew 1979, monotone chain);
/// a vertex within the tolerance of the line of its neighbours is none.
fn flat_corners(mesh: &Mesh, n: &Vector3<f64>, tolerance: f64, vertices: &mut Vec<u32>) {
    let skip = n.iamin();
    let u = n.cross(&Vector3::from_fn(|k, _| if k == skip { 1.0 } else { 0.0 }));
    let v = n.cross(&u);
    let base = mesh.points[vertices[0] as usize];
    let at = |k: u32| {
        let d = mesh.points[k as usize] - base;
        (u.dot(&d), v.dot(&d))
    };
    vertices.sort_by(|&j, &k| {
        let (p, q) = (at(j), at(k));
        p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1))
    });
    // Twice for the length of u and v, which is at least the root of two thirds.
    let is_corner = |a: u32, b: u32, c: u32| {
        let (a, b, c) = (at(a), at(b), at(c));
        let (s, t) = ((c.0 - a.0, c.1 - a.1), (b.0 - a.0, b.1 - a.1));
        t.0 * s.1 - t.1 * s.0 > 2.0 * tolerance * sqrt(s.0 * s.0 + s.1 * s.1)
    };
    let chain = |order: &mut dyn Iterator<Item = u32>| {
        let mut chain: Vec<u32> = Vec::new();
        for k in order {
            while let [.., a, b] = chain[..]
                && !is_corner(k, b, a)
            {
                chain.pop();
            }
            chain.push(k);
        }
        chain
    };
    let (there, back) = (
        chain(&mut vertices.iter().copied()),
        chain(&mut vertices.iter().rev().copied()),
    );
    *vertices = there.into_iter().chain(back).collect();
}
