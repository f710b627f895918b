//! Meshes and bodies of pieces as convex parts under a tree.

use nalgebra::{Isometry3, Point3, Vector3};

use super::frame::Side;
use super::mesh::Mesh;
use super::pieces::Composite;
use crate::polyhedron::ConvexPolyhedron;
use crate::shape::Shape;

/// A body of convex parts under a tree: a [`Mesh`], whose parts are its triangles, or a
/// [`Composite`], whose parts are its pieces.
///
/// No other type can implement the trait.
pub trait Parts: Parted {}

impl Parts for Mesh {}
impl Parts for Composite {}

/// The methods behind [`Parts`], which callers do not see. Points and directions are in stored
/// units of the body; an item is a part by its number in the tree.
pub trait Parted {
    /// Returns the body as its tree sees it.
    fn side(&self) -> Side<'_>;

    /// Returns the number by which a tracker recognises the body.
    fn fingerprint(&self) -> u64;

    /// Returns one stored unit in the caller's.
    fn stored_unit(&self) -> f64;

    /// Returns whether all parts stand in the frame of the body, so that no pose is composed.
    fn is_in_place(&self) -> bool;

    /// Returns an upper bound of the height of an item along a direction of any length.
    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64;

    /// Returns the caller's number of an item.
    fn number(&self, item: u32) -> u32;

    /// Returns the shape of an item and its pose in the body; `None` for a triangle too small
    /// beside its mesh to be a body of its own.
    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)>;

    /// Returns whether points inside belong to the body: not so for surfaces.
    fn is_solid(&self) -> bool;

    /// Returns whether [`holds`](Self::holds) can be true: for solid meshes alone.
    fn may_hold(&self) -> bool;

    /// Returns the number of connected parts, as far as it is known: of pieces, or of a mesh.
    fn probe_count(&self) -> usize;

    /// Returns two points of a connected part, far from each other.
    fn probe(&self, k: usize) -> [Vector3<f64>; 2];

    /// Returns whether the first point of each probe is an inner one: of pieces, not of meshes.
    fn has_inner_probes(&self) -> bool;

    /// Returns whether a point that may be off its place by `doubt` is inside a solid mesh: false
    /// for pieces, which are measured as solids. `None` if the surface is as near as the doubt, or
    /// if every segment to the outside met an edge.
    fn holds(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool>;
}

impl Parted for Mesh {
    fn side(&self) -> Side<'_> {
        Side {
            tree: &self.tree,
            exponent: self.exponent,
            radius: self.radius,
        }
    }

    fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    fn stored_unit(&self) -> f64 {
        self.unit()
    }

    fn is_in_place(&self) -> bool {
        true
    }

    #[inline(always)]
    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64 {
        let [a, b, c] = self.corners(item);
        n.dot(&a).max(n.dot(&b)).max(n.dot(&c))
    }

    fn number(&self, item: u32) -> u32 {
        self.source_triangles[item as usize]
    }

    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        let corners: [Point3<f64>; 3] = self.corners(item).map(|p| self.given(&p));
        let polygon = ConvexPolyhedron::polygon(&corners).ok()?;
        Some((Shape::from(polygon), Isometry3::identity()))
    }

    fn is_solid(&self) -> bool {
        Mesh::is_solid(self)
    }

    fn may_hold(&self) -> bool {
        Mesh::is_solid(self)
    }

    fn probe_count(&self) -> usize {
        self.part_vertices.len()
    }

    fn probe(&self, k: usize) -> [Vector3<f64>; 2] {
        self.part_vertices[k].map(|v| self.points[v as usize])
    }

    fn has_inner_probes(&self) -> bool {
        false
    }

    fn holds(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool> {
        if !Mesh::is_solid(self) {
            return Some(false);
        }
        if doubt > 0.0 && !self.is_clear_of(point, doubt) {
            return None;
        }
        self.winding(point).map(|w| w != 0)
    }
}
