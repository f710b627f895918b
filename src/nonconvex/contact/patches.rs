//! The convex patches of a mesh for contacts: their hulls, and where and along which normals
//! contacts are valid.
//!
//! A triangle joins the patch of an adjacent triangle under two conditions, both within a
//! tolerance. Its vertices are on or below the planes of all triangles of the patch, and all
//! vertices of the patch are on or below its plane. Then every triangle of the patch lies within
//! the tolerance of the boundary of the patch's hull and faces outward ([`grow`]).
//!
//! Source: the convex surface decomposition of Ehmann and Lin 2001, "Accurate and fast proximity
//! queries between polyhedra using convex surface decomposition", section 4. Departures:
//!
//! 1. Patches carry contacts only; distances use the triangles. So hulls may extend outside the
//!    solid.
//! 2. Signs have a tolerance. The vertices of a rotated plane are rounded, so about half of its
//!    inner edges are reflex by a few units.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use crate::base::callbacks::Watch;
use crate::base::num::extremes::{ByValue, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::tolerance::ACROSS;
use crate::body::polyhedron::{ConvexPolyhedron, bounding_box};
use crate::body::shape::Shape;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::frame::TreeSide;
use crate::nonconvex::query::overlap::unit_normal;
use crate::nonconvex::query::triangle;
use crate::nonconvex::tree::Tree;

/// Depth of the hull of a patch that does not surround a body, as a fraction of its radius.
///
/// An overlap deeper than half of it takes the normal of a face instead of the hull's, which costs
/// one gap for each face.
const DEPTH: f64 = 0.25;

/// Minimum number of triangles of a patch whose hull is built together with the patches.
///
/// Hulls of smaller patches are built when a body comes near. A hull takes kilobytes, and most
/// patches of scanned meshes have three to six triangles.
const MANY_TRIANGLES: usize = 12;

/// Sine of the largest angle between a contact's normal and the normals of the mesh at the point.
///
/// The direction between witness points that are 1e-9 apart has an error of 1e-7.
const CONE: f64 = 1.0 / 1_048_576.0;

/// Whether a contact is valid on a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Valid {
    /// Outside the patch, or along a direction that is not a normal of the mesh.
    No,
    /// On a face that is nearly perpendicular to the normal.
    Nearly,
    /// Along a normal of the mesh: of a face, or in the normal cone of a convex edge or vertex.
    Fully,
}

/// A mesh divided into convex patches.
#[derive(Clone, Debug)]
pub(super) struct PatchedMesh {
    /// The caller's mesh.
    pub(super) given: Arc<Mesh>,
    /// The mesh with all triangles facing outward: the given one, or a turned copy of a solid that
    /// is inside out.
    mesh: Arc<Mesh>,
    tree: Tree,
    /// The patch of each leaf of the tree.
    order: Vec<u32>,
    /// The triangles of each patch: the start of its list, and the lists.
    first: Vec<u32>,
    of_patch: Vec<u32>,
    patch_of: Vec<u32>,
    /// The vertices that span the hull of each patch.
    corners: Vec<Box<[u32]>>,
    /// The hulls of large patches.
    hulls: Vec<Option<Shape>>,
    /// Bound of the distance of a triangle from the hull of its patch, in stored units.
    slack: f64,
}

impl PatchedMesh {
    /// Divides a mesh into patches that are convex within a tolerance in stored units.
    pub(super) fn new(given: Arc<Mesh>, tolerance: f64) -> Self {
        let mesh = given.facing_outward().map_or_else(|| given.clone(), Arc::new);
        let slack = tolerance.larger(ACROSS * mesh.radius);
        let patches = grow(&mesh, slack);
        let vertices: Vec<Vec<u32>> = patches.iter().map(|p| corners(&mesh, p, slack)).collect();
        let (mut tree, order) = Tree::split(&mesh.points, &vertices, 1, &mut Watch::none());
        let items: Vec<&[u32]> = order.iter().map(|&k| &vertices[k as usize][..]).collect();
        tree.fit(&mesh.points, &items, 0.0, &mut Watch::none());
        let is_large = |p: &PatchTriangles| p.len() >= MANY_TRIANGLES;
        let mut surface = Self {
            tree,
            order,
            first: alloc::vec![0],
            of_patch: Vec::with_capacity(mesh.triangles.len()),
            patch_of: alloc::vec![0; mesh.triangles.len()],
            hulls: Vec::with_capacity(patches.len()),
            corners: Vec::with_capacity(patches.len()),
            slack,
            mesh,
            given,
        };
        for (k, (patch, corners)) in (0u32..).zip(patches.iter().zip(vertices)) {
            patch.iter().for_each(|&(t, _)| surface.patch_of[t as usize] = k);
            surface.of_patch.extend(patch.iter().map(|p| p.0));
            surface.first.push(surface.of_patch.len() as u32);
            surface.corners.push(corners.into());
            let hull = if is_large(patch) { surface.build(k) } else { None };
            surface.hulls.push(hull);
        }
        surface
    }

    pub(super) fn side(&self) -> TreeSide<'_> {
        TreeSide {
            tree: &self.tree,
            frame: self.mesh.frame,
            radius: self.mesh.radius,
            off: self.mesh.off,
        }
    }

    pub(super) fn patch_of_item(&self, item: u32) -> u32 {
        self.order[item as usize]
    }

    /// Returns the patch of the triangle that is nearest to a point in the caller's unit.
    pub(super) fn patch_at(&self, point: &Point3<f64>) -> u32 {
        let foot = self.mesh.nearest(&(point.coords / self.mesh.unit()));
        self.patch_of[foot.triangle as usize]
    }

    pub(super) fn count(&self) -> usize {
        self.hulls.len()
    }

    /// Returns the triangles of a patch; empty if the patch does not exist.
    pub(super) fn triangles(&self, patch: u32) -> &[u32] {
        let range = self.first.get(patch as usize..patch as usize + 2);
        range.map_or(&[], |r| &self.of_patch[r[0] as usize..r[1] as usize])
    }

    /// Returns the hull of a patch, with depth.
    ///
    /// Returns `None` for a patch that is too small, compared with its distance from the origin, to
    /// be a body.
    pub(super) fn hull(&self, patch: u32) -> Option<Shape> {
        match self.hulls.get(patch as usize)? {
            Some(hull) => Some(hull.clone()),
            None => self.build(patch),
        }
    }

    fn build(&self, patch: u32) -> Option<Shape> {
        let mesh = &self.mesh;
        let corners = &self.corners[patch as usize];
        let mut points: Vec<_> = corners.iter().map(|&v| mesh.given(&mesh.points[v as usize])).collect();
        let normals = || {
            self.triangles(patch)
                .iter()
                .map(|&t| triangle::normal(&mesh.corners(t)))
        };
        let sum: Vector3<f64> = normals().sum();
        let mean = sum / sqrt(sum.norm_squared());
        // A patch that surrounds a body has depth already.
        if normals().all(|n| mean.dot(&n) > 0.25 * sqrt(n.norm_squared())) {
            let (low, high) = bounding_box(points.iter().map(|p| &p.coords));
            let down = mean * (-0.5 * DEPTH * sqrt((high - low).norm_squared()));
            let deep: Vec<_> = points.iter().map(|p: &Point3<f64>| p + down).collect();
            points.extend(deep);
        }
        let built = ConvexPolyhedron::from_points(&points).or_else(|_| ConvexPolyhedron::polygon(&points));
        built.ok().map(Shape::from)
    }

    /// Returns whether a contact of a patch at a point along an outward unit normal is valid.
    ///
    /// The point is in the caller's unit. `doubt` bounds its position error. `sine` is the largest
    /// angle of a face that is nearly perpendicular to the normal.
    pub(super) fn how_valid(&self, patch: u32, point: &Point3<f64>, n: &Vector3<f64>, sine: f64, doubt: f64) -> Valid {
        let place = point.coords / self.mesh.unit();
        let skin = self.slack + doubt / self.mesh.unit();
        let (mut is_outward, mut rise) = (false, 0.0f64);
        let mut valid = None;
        self.mesh.tree.any_near(&place, skin, |t| {
            let corners = self.mesh.corners(t);
            if triangle::nearest(&place, &corners).0 > skin * skin {
                return false;
            }
            for corner in corners {
                let d = corner - place;
                let length = sqrt(d.norm_squared());
                if length > 2.0 * skin {
                    rise = rise.larger((n.dot(&d) - skin) / length);
                }
            }
            let own = triangle::normal(&corners);
            let (along, square) = (own.dot(n), own.norm_squared());
            is_outward |= along > 0.0;
            if self.patch_of[t as usize] == patch {
                let off = own.cross(n).norm_squared();
                let now = match along > 0.0 {
                    true if off <= CONE * CONE * square => Valid::Fully,
                    true if off <= sine * sine * square => Valid::Nearly,
                    _ => Valid::No,
                };
                valid = valid.max(Some(now));
            }
            false
        });
        match valid {
            None => Valid::No,
            // No vertex around the point is higher: the direction is one of the normals of a convex
            // feature.
            Some(_) if is_outward && rise <= CONE => Valid::Fully,
            Some(valid) => valid,
        }
    }

    /// Returns whether a patch has a triangle with this normal.
    pub(super) fn has_face(&self, patch: u32, n: &Vector3<f64>) -> bool {
        self.triangles(patch).iter().any(|&t| {
            let own = triangle::normal(&self.mesh.corners(t));
            own.dot(n) > 0.0 && own.cross(n).norm_squared() <= CONE * CONE * own.norm_squared()
        })
    }

    /// Returns whether a point is at least `depth` away from the mesh.
    pub(super) fn is_clear(&self, point: &Point3<f64>, depth: f64) -> bool {
        let (place, reach) = (point.coords / self.mesh.unit(), depth / self.mesh.unit() - self.slack);
        let is_nearer = |t: u32| triangle::nearest(&place, &self.mesh.corners(t)).0 < reach * reach;
        !(reach > 0.0 && self.mesh.tree.any_near(&place, reach, is_nearer))
    }

    /// Returns whether a solid contains a point; false for an open mesh.
    pub(super) fn holds(&self, point: &Point3<f64>) -> bool {
        self.mesh.is_solid() && self.mesh.winding(&(point.coords / self.mesh.unit())) != Some(0)
    }

    /// Returns whether a point is below the triangle that is nearest to it.
    pub(super) fn is_below(&self, point: &Point3<f64>, doubt: f64) -> bool {
        let place = point.coords / self.mesh.unit();
        let foot = self.mesh.nearest(&place);
        let n = triangle::normal(&self.mesh.corners(foot.triangle));
        let skin = self.slack + doubt / self.mesh.unit();
        n.dot(&(place - foot.point)) < -skin * sqrt(n.norm_squared())
    }

    /// Returns whether the path from a point of the surface to a point below it leaves the mesh.
    pub(super) fn is_left(&self, from: &Point3<f64>, to: &Point3<f64>, doubt: f64) -> bool {
        let unit = self.mesh.unit();
        let skin = 2.0 * (self.slack + doubt / unit);
        self.mesh.is_crossed(&(from.coords / unit), &(to.coords / unit), skin)
    }
}

/// Maximum number of planes of a patch.
///
/// Larger patches would need a build time that grows with the square of their size.
const PLANES: usize = 1024;

/// A convex patch: triangles, each with a triangle that represents its plane.
type PatchTriangles = Vec<(u32, u32)>;

/// Divides a mesh into patches.
pub(super) fn grow(mesh: &Mesh, tolerance: f64) -> Vec<PatchTriangles> {
    let count = mesh.triangles.len() as u32;
    let surface = MeshSurface {
        mesh,
        tolerance,
        normals: (0..count)
            .map(|t| unit_normal(&mesh.corners(t)).unwrap_or_default())
            .collect(),
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

/// Returns the directed edges of all triangles in order, each with its triangle.
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
    /// Returns the height of a vertex above the plane of a triangle.
    fn height(&self, triangle: u32, vertex: u32) -> f64 {
        let base = self.mesh.points[self.mesh.triangles[triangle as usize][0] as usize];
        self.normals[triangle as usize].dot(&(self.mesh.points[vertex as usize] - base))
    }

    /// Returns the triangles that share an edge with a triangle and run along it in the opposite
    /// direction.
    fn adjacent(&self, triangle: u32) -> impl Iterator<Item = u32> + '_ {
        let [a, b, c] = self.mesh.triangles[triangle as usize];
        [[b, a], [c, b], [a, c]].into_iter().flat_map(move |edge| {
            let from = self.edges.partition_point(|e| e.0 < edge);
            let run = self.edges[from..].iter().take_while(move |e| e.0 == edge);
            run.map(|e| e.1)
        })
    }
}

/// A patch that is extended by adjacent triangles.
struct Growing<'a> {
    surface: &'a MeshSurface<'a>,
    triangles: PatchTriangles,
    vertices: Vec<u32>,
    /// One triangle of each plane.
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

    /// Adds a triangle that is adjacent to one of a plane, if the patch stays convex.
    ///
    /// Returns the plane of the added triangle.
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

/// Returns the vertices of a patch that span its hull within a tolerance.
///
/// For each plane these are the vertices of the hull of its triangles, so that a flat face stays
/// flat for any vertices inside it.
pub(super) fn corners(mesh: &Mesh, patch: &PatchTriangles, tolerance: f64) -> Vec<u32> {
    let mut by_plane: Vec<(u32, u32)> = patch.iter().map(|&(t, plane)| (plane, t)).collect();
    by_plane.sort_unstable();
    let mut all = Vec::new();
    for run in by_plane.chunk_by(|x, y| x.0 == y.0) {
        let mut vertices: Vec<u32> = run.iter().flat_map(|r| mesh.triangles[r.1 as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        if run.len() > 1 {
            flat_corners(
                mesh,
                &unit_normal(&mesh.corners(run[0].0)).unwrap_or_default(),
                tolerance,
                &mut vertices,
            );
        }
        all.extend(vertices);
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Keeps only the hull vertices of vertices that lie in one plane (Andrew 1979, monotone chain).
///
/// A vertex within the tolerance of the line through its neighbours is removed.
fn flat_corners(mesh: &Mesh, n: &Vector3<f64>, tolerance: f64, vertices: &mut Vec<u32>) {
    let skip = n.iamin();
    let u = n.cross(&Vector3::from_fn(|k, _| if k == skip { 1.0 } else { 0.0 }));
    let v = n.cross(&u);
    let base = mesh.points[vertices[0] as usize];
    let at = |k: u32| {
        let d = mesh.points[k as usize] - base;
        (u.dot(&d), v.dot(&d))
    };
    sort(vertices, |&j, &k| {
        let (p, q) = (at(j), at(k));
        p.0.by_value(q.0).then(p.1.by_value(q.1))
    });
    // Twice, because of the lengths of u and v, which are at least the square root of two thirds.
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
