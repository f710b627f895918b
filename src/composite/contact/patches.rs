//! Convex patches of a mesh's surface.
//!
//! A triangle joins the patch of an adjacent one if its vertices are on or below the planes of all
//! triangles of the patch, and all vertices of the patch on or below its own plane: then every
//! triangle of the patch lies on the boundary of the patch's hull, outward. All signs are exact.
//!
//! Source: the convex surface decomposition of Ehmann and Lin 2001, "Accurate and fast proximity
//! queries between polyhedra using convex surface decomposition", section 4. Departures:
//!
//! 1. Patches carry contacts only; distances are the triangles' own. So hulls may leave the solid.
//! 2. A hull is given depth against the patch's mean normal, so that a flat patch has a normal in
//!    shallow overlap.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::skin::Skin;
use crate::composite::mesh::{Mesh, MeshError};
use crate::composite::pieces::{Composite, Piece};
use crate::num::scalar::sqrt;
use crate::num::sign;
use crate::polyhedron::ConvexPolyhedron;
use crate::shape::Core;
use crate::tuning::composite::{DEPTH, PLANES};

/// A body as its contacts see it: convex patches of a mesh's surface, or the pieces of a
/// [`Composite`].
///
/// Built once for each body; [`PatchTracker`](crate::PatchTracker) finds the contacts of two.
#[derive(Clone, Debug)]
pub struct ContactPatches {
    pub(super) hulls: Composite,
    /// The surface on which contacts must lie, for meshes.
    pub(super) skin: Option<Skin>,
}

impl ContactPatches {
    /// Returns the patches of a mesh. Flat regions and convex bodies are one patch each, however
    /// finely they are cut into triangles; saddles and walls seen from inside give small ones.
    ///
    /// # Errors
    ///
    /// A patch too small beside its place to be a body ([`MeshError::OutOfRange`]).
    pub fn of_mesh(mesh: &Mesh) -> Result<Self, MeshError> {
        let mut skin = Skin::new(mesh);
        let patches = grow(&skin);
        let mut pieces = Vec::with_capacity(patches.len());
        for patch in &patches {
            pieces.push(Piece::new(hull(&skin, patch)?));
        }
        skin.set_patches(patches);
        let extent = skin.extent();
        Ok(Self {
            hulls: Composite::new(pieces).map_err(|_| MeshError::OutOfRange { extent })?,
            skin: Some(skin),
        })
    }

    /// Returns the pieces of a body as its patches.
    ///
    /// # Errors
    ///
    /// A piece that is rounded or curved.
    pub fn of_pieces(body: &Composite) -> Result<Self, MeshError> {
        let placed = |(k, piece): (usize, &Piece)| {
            let (Core::Polyhedron(shape), 0.0) = (piece.shape.core(), piece.shape.round()) else {
                return Err(MeshError::Curved { piece: k });
            };
            let points: Vec<_> = shape.vertex_points().map(|p| piece.pose * p).collect();
            body_of(&points).map(Piece::new)
        };
        let pieces: Result<Vec<_>, _> = body.pieces().iter().enumerate().map(placed).collect();
        let hulls = Composite::new(pieces?).map_err(|_| MeshError::Empty { given: 0 })?;
        Ok(Self { hulls, skin: None })
    }

    /// Returns the number of patches or pieces.
    #[must_use]
    pub fn count(&self) -> usize {
        self.hulls.pieces().len()
    }

    /// Returns the triangles of a patch by the caller's numbers; none for pieces.
    pub fn triangles(&self, patch: u32) -> impl Iterator<Item = u32> + '_ {
        self.skin.iter().flat_map(move |s| s.sources(patch))
    }

    pub(super) fn hull(&self, patch: u32) -> Option<&ConvexPolyhedron> {
        match self.hulls.pieces().get(patch as usize)?.shape.core() {
            Core::Polyhedron(body) => Some(body),
            _ => None,
        }
    }
}

/// The triangles of each patch.
fn grow(skin: &Skin) -> Vec<Vec<u32>> {
    let mut free = alloc::vec![true; skin.triangles.len()];
    let mut patches = Vec::new();
    for seed in 0..skin.triangles.len() as u32 {
        if free[seed as usize] {
            free[seed as usize] = false;
            let mut patch = Growing::new(skin, seed);
            patch.grow(&mut free);
            patches.push(patch.triangles);
        }
    }
    patches
}

/// A patch that takes adjacent triangles.
struct Growing<'a> {
    skin: &'a Skin,
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    /// A triangle of each plane.
    planes: Vec<u32>,
}

impl<'a> Growing<'a> {
    fn new(skin: &'a Skin, seed: u32) -> Self {
        Self {
            skin,
            triangles: alloc::vec![seed],
            vertices: skin.triangles[seed as usize].to_vec(),
            planes: alloc::vec![seed],
        }
    }

    fn grow(&mut self, free: &mut [bool]) {
        let mut queue = VecDeque::from([self.triangles[0]]);
        while let Some(of) = queue.pop_front() {
            for next in self.skin.adjacent(of) {
                if free[next as usize] && self.admits(next, of) {
                    free[next as usize] = false;
                    queue.push_back(next);
                }
            }
        }
    }

    /// Takes a triangle that is adjacent to one of the patch, if the patch stays convex.
    fn admits(&mut self, next: u32, of: u32) -> bool {
        let skin = self.skin;
        let triangle = skin.triangles[next as usize];
        let is_coplanar = triangle.iter().all(|&v| skin.side(of, v) == 0.0);
        if is_coplanar && skin.normal(next).dot(&skin.normal(of)) < 0.0 {
            return false;
        }
        let fits = |&v: &u32| self.planes.iter().all(|&t| skin.side(t, v) <= 0.0);
        let holds = || self.vertices.iter().all(|&v| skin.side(next, v) <= 0.0);
        if !triangle.iter().all(fits) || !is_coplanar && !holds() {
            return false;
        }
        let lies_in = |&t: &u32| triangle.iter().all(|&v| skin.side(t, v) == 0.0);
        if !is_coplanar && !self.planes.iter().any(lies_in) {
            if self.planes.len() >= PLANES {
                return false;
            }
            self.planes.push(next);
        }
        self.triangles.push(next);
        self.vertices.extend(triangle);
        if self.vertices.len() > 256 && self.vertices.len().is_power_of_two() {
            self.vertices.sort_unstable();
            self.vertices.dedup();
        }
        true
    }
}

/// The hull of a patch, with depth.
fn hull(skin: &Skin, patch: &[u32]) -> Result<ConvexPolyhedron, MeshError> {
    let mut vertices: Vec<u32> = patch.iter().flat_map(|&t| skin.triangles[t as usize]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut points: Vec<_> = vertices
        .iter()
        .map(|&v| Point3::from(skin.points[v as usize]))
        .collect();
    let (mut sum, mut area) = (Vector3::zeros(), 0.0);
    for &t in patch {
        let n = skin.normal(t);
        (sum, area) = (sum + n, area + sqrt(n.norm_squared()));
    }
    // A patch that goes round a body has depth of its own.
    if sqrt(sum.norm_squared()) > 0.5 * area {
        let down = sum * (-DEPTH * radius(&points) / sqrt(sum.norm_squared()));
        let deep: Vec<_> = points.iter().map(|p| p + down).collect();
        points.extend(deep);
    }
    body_of(&points)
}

fn body_of(points: &[Point3<f64>]) -> Result<ConvexPolyhedron, MeshError> {
    let built = ConvexPolyhedron::from_points(points).or_else(|_| ConvexPolyhedron::polygon(points));
    built.map_err(|_| MeshError::OutOfRange { extent: radius(points) })
}

/// Half the diagonal of the box of some points.
fn radius(points: &[Point3<f64>]) -> f64 {
    let (low, high) = crate::polyhedron::bounding_box(points.iter().map(|p| &p.coords));
    sqrt((high - low).norm_squared()) * 0.5
}

impl Skin {
    /// On which side of a triangle's plane a vertex is: positive outside.
    fn side(&self, triangle: u32, vertex: u32) -> f64 {
        let [a, b, c] = self.corners(triangle);
        sign::side(&a, &b, &c, &self.points[vertex as usize])
    }
}
