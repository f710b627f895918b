//! Bodies that are not convex: meshes of triangles as the user brought them, and bodies of placed
//! convex pieces.
//!
//! Reading order: [`mesh`] (triangles to a checked mesh, two meshes at a pose, the state of a
//! pair), `pieces` (placed shapes to a body, and the same), `parts` (both as convex parts, and
//! their poses), `tree` (oriented boxes in single precision), `meet` (two trees at a pose: the
//! bounds of eight pairs of boxes at once, the search down both trees and its counters, triangles,
//! winding numbers, and the queries), `front` (the proof of the last answer, kept from frame to
//! frame), `contact` (manifolds of convex patches), `penetration` (bounds of the depth),
//! `decomposition` (pieces in the place of a mesh), `separation` (pairs over time) and
//! [`continuous`] (first contacts of vertices on straight paths).
//!
//! # The proof
//!
//! For any unit direction n, `min over Y of n . y - max over X of n . x` is a lower bound of the
//! distance of the sets X and Y, and the distance of two points is an upper bound. A *front* is a
//! set of pairs of tree nodes under which every pair of triangles lies exactly once. If every pair
//! on a front is proven at least d apart and d is the distance of one pair of triangles, d is the
//! distance: whatever the front looks like. So the state of a tracker can make a query slow, never
//! wrong.
//!
//! Source: M. C. Lin 1993, chapter 4 (the subpart hierarchical tree); oriented boxes: Gottschalk,
//! Lin and Manocha 1996; fronts of a bounding volume test tree: Li and Chen 1998, Ehmann and Lin
//! 2001. Departures:
//!
//! 1. A pair on the front keeps the direction that separated it. At the next pose one dot product
//!    proves it again, because motion perpendicular to that direction costs nothing.
//! 2. Boxes are in single precision, rounded outward, and every proven gap is lowered by a derived
//!    error; triangles, witnesses and the distance are in double precision.
//! 3. Closed meshes are solids: a part inside another body is an overlap, decided by exact winding
//!    numbers.

pub(crate) mod contact;
pub mod continuous;
pub(crate) mod decomposition;
pub(crate) mod front;
pub mod mesh;
pub(crate) mod parts;
pub(crate) mod penetration;
pub(crate) mod pieces;
pub(crate) mod query;
pub(crate) mod separation;
mod tree;
