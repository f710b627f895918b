//! Bodies that are not convex: meshes of triangles as the user brought them, and bodies of placed
//! convex pieces.
//!
//! Reading order: [`mesh`] (triangles to a checked mesh), `pieces` (placed shapes to a body),
//! `parts` (both as convex parts), `placed` (poses of parts), `tree` (oriented boxes in single
//! precision), `frame` (a pair at a pose), `bounds` (eight pairs of boxes at once), `front` (the
//! proof of the last answer), `search` (down both trees), `kept` (front and search from frame to
//! frame), `worth` (whether a front pays), `triangle` (two triangles), `inside` (winding numbers),
//! `shared` (inner points of solids in contact), `state` (the queries), `tracker` (the state of a
//! pair), `contact` (manifolds of convex patches), `penetration` (bounds of the depth),
//! `decomposition` (pieces in the place of a mesh, over `gaps` and `greatest`), `separation` (pairs
//! over time), `ahead` (the bound of a look) and `work` (counters).
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

mod ahead;
pub(crate) mod audit;
mod bounds;
pub(crate) mod contact;
pub(crate) mod decomposition;
mod frame;
mod front;
mod gaps;
mod greatest;
mod heights;
mod inside;
mod kept;
mod leaves;
pub mod mesh;
mod pair;
pub(crate) mod parts;
pub(crate) mod penetration;
pub(crate) mod pieces;
pub(crate) mod placed;
pub(crate) mod search;
pub(crate) mod separation;
mod shared;
mod state;
pub(crate) mod tracker;
mod tree;
mod triangle;
pub(crate) mod work;
mod worth;
