//! Bodies that are not convex: triangle meshes as the user provides them, and compounds of convex
//! pieces.
//!
//! Reading order:
//!
//! - [`mesh`]: from triangles to a checked mesh; two meshes at a pose; the state of a pair.
//! - `pieces`: from shapes and poses to a compound; two compounds at a pose; the state of a pair.
//! - `cloud`: one convex element at many points.
//! - `parts`: meshes and compounds as convex members, and their poses.
//! - `tree`: oriented boxes in single precision.
//! - `query`: two trees at a pose. It has the bounds of eight pairs of boxes at once, the search
//!   down both trees and its counters, triangles, winding numbers, and the queries.
//! - `front`: the proof of the last answer, kept from frame to frame.
//! - `contact`: manifolds of convex patches.
//! - `penetration`: bounds of the depth.
//! - `point`: a point and a mesh.
//! - `near_parts`: a point and the members of a body.
//! - `near_faces`: a point and the faces of a convex polyhedron.
//! - `simple_surface`: proves that a mesh does not meet itself.
//! - `decomposition`: pieces that replace a mesh.
//! - `separation`: pairs over time.
//! - `top`: the highest point along a direction.
//! - `volume`: the volume that two solids share, and the curves in which their surfaces cross.
//! - [`continuous`]: first contacts of vertices on straight paths.
//!
//! # The proof
//!
//! For any unit direction n, `min over Y of n . y - max over X of n . x` is a lower bound of the
//! distance of the sets X and Y. The distance of any two points, one of each set, is an upper
//! bound. A *front* is a set of pairs of tree nodes that covers every pair of triangles exactly
//! once. Let d be the distance of one pair of triangles. If every pair on a front is proven to be
//! at least d apart, then d is the distance, for any shape of the front. So the state of a tracker
//! can make a query slow, never wrong.
//!
//! Sources: M. C. Lin 1993, chapter 4 (the subpart hierarchical tree); oriented boxes: Gottschalk,
//! Lin and Manocha 1996; fronts of a bounding volume test tree: Li and Chen 1998, Ehmann and Lin
//! 2001. Departures:
//!
//! 1. A pair on the front keeps the direction that separated it. At the next pose one dot product
//!    proves the pair again, because motion perpendicular to that direction does not change the
//!    gap.
//! 2. Boxes are in single precision and rounded outward, and every proven gap is reduced by a
//!    derived error bound. Triangles, witness points and the distance are in double precision.
//! 3. Closed meshes are solids: a component inside another body overlaps it. Exact winding numbers
//!    decide this.

pub(crate) mod cloud;
pub(crate) mod contact;
pub mod continuous;
pub(crate) mod decomposition;
pub(crate) mod front;
pub mod mesh;
pub(crate) mod near_faces;
pub(crate) mod near_parts;
pub(crate) mod parts;
pub(crate) mod penetration;
pub(crate) mod pieces;
pub(crate) mod point;
pub(crate) mod query;
pub(crate) mod separation;
pub(crate) mod simple_surface;
pub(crate) mod top;
pub(crate) mod tree;
pub(crate) mod volume;
