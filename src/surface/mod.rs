//! Bézier patches and NURBS: proven intervals of their distance from each other and from other
//! bodies.
//!
//! The other bodies are convex shapes, compounds of such shapes, and meshes. Reading order:
//!
//! - [`net`](BezierPatch): one patch.
//! - `bezier`: de Casteljau's algorithm.
//! - `nurbs`: [`Nurbs`] split into patches, and surfaces of [`revolution`].
//! - `bezier_surface`: [`BezierSurface`].
//! - `tree`: control nets, split in halves.
//! - `height`: bounds of the height of a node along a direction, and what the proof needs of a
//!   body.
//! - `bowl`: separating quadrics, for nodes that no plane separates.
//! - `gap`: separation of two nodes at a pose.
//! - `closest`: the closest two points by Newton's method, and a proof that surfaces share a point.
//! - `region`: boxes of parameters around the closest points, proven at once.
//! - `search`: the proof of an outcome, and the front that keeps it.
//! - `two_surfaces`: a pair of surfaces, or of a surface and a mesh, at a pose and over time.
//! - `solid`: a convex shape as the second body.
//! - `surface_and_solid`: a surface and a convex shape, or a surface and a compound.
//!
//! # The proof
//!
//! For any unit direction n, `min over Y of n . y - max over X of n . x` is a lower bound of the
//! distance of the sets X and Y. The distance of any two points, one of each set, is an upper
//! bound. A patch lies in the convex hull of its control net, if its weights are positive. Each
//! half of a patch has its own control net, which is four times as flat. So the bounds converge for
//! pairs of ever smaller nodes. A front is a set of pairs of nodes that covers all pairs of
//! patches. If each pair is proven to be at least `upper - width` apart, the interval is as narrow
//! as requested. If the height of a patch along n is proven concave around its highest point, no
//! split is needed for any width of the interval.
//!
//! Sources: M. C. Lin 1993, sections 4.3 to 4.5 (curved surfaces; resultants and eigenvalues are
//! not needed here); Johnson and Cohen 1998 (lower bounds by hulls of control nets); fronts:
//! [`nonconvex`](crate::nonconvex). Departures:
//!
//! 1. The result is an interval whose width the caller chooses, down to `2^-42` of the size. All
//!    rounding errors are counted.
//! 2. If no plane separates two nodes (nested saddles, a surface in the hollow of another), a
//!    quadratic surface does (`bowl`).
//! 3. Second derivatives prove pairs of nodes. So the cost of an interval does not grow as its
//!    width shrinks, if one surface curves away from the separating plane.
//! 4. The largest possible region around the closest points is proven at once (`region`), because
//!    many small nodes there would not be proven again in the next frame.
//!
//! # Supported pairs
//!
//! [`PairTracker`](crate::PairTracker) queries a surface against any other geometry:
//!
//! - A [`Shape`](crate::Shape) is solid and is not split: its support function bounds it.
//! - A [`Compound`](crate::Compound) has a tracker for each piece.
//! - A [`Mesh`](crate::Mesh) is converted to flat patches, one for each triangle. If it is closed,
//!   its inside belongs to the body. [`BezierSurface::from_mesh`] makes a surface of the triangles
//!   alone.
//!
//! # Limits
//!
//! - Trimmed surfaces are not supported.
//! - A closed surface has no inside: a body within it has a positive distance.
//! - There are no depths and no contact manifolds.
//! - Casts do not use directions over time, so a surface that slides along another needs many
//!   steps.
//! - Patches of a degree above three have no separating quadric. There the number of splits grows
//!   with the logarithm of 1/width.
//! - No exact arithmetic decides whether surfaces touch.
//!
//! # Sizes
//!
//! Coordinates of control points are at most `2^200` (1.6e60; other bodies: 1e100). Bounds hold for
//! pairs of any size. Intervals are as narrow as requested if the pair size L is between `2^-300`
//! (5e-91) and `2^300`. Outside this range squares of lengths overflow or underflow. The query then
//! measures only the distance of the origins, and each bound differs from it by about twice the
//! sum of both radii. Then no contact of smaller bodies is decided, and a cast ends as
//! [`Undecided`](crate::impact::Impact::Undecided) or
//! [`Incomplete`](crate::impact::Impact::Incomplete).
//!
//! # Wider intervals than requested
//!
//! If the closest points are isolated, the number of splits of a query grows with log(1/width).
//! Over random pairs, the median is 12 splits and the 99.9th percentile is 1,848. If the distance
//! is constant along a curve or over an area, the number grows with a power of 1/width, in practice
//! without end. Examples:
//!
//! * constant along a curve: a sphere in the hole of a torus, a tube in a sphere;
//! * constant over an area: concentric spheres, coaxial tubes, tori about one circle, a patch and
//!   the same patch shifted a little.
//!
//! After 2,048, 4,096, ... splits a query of two surfaces tests how fast its bounds converge. If
//! they would need several times the budget (20,000 splits by default), the query ends there, with
//! `is_converged` false or undecided. The interval of the returned pair is then about 1e-3 L wide
//! for a curve, and up to 4e-2 L for an area. A larger budget makes it narrower:
//! [`QueryOptions::splits`](crate::QueryOptions::splits). A query of a surface and a shape
//! continues until its budget is used up.
//!
//! Of 10,000 random pairs of surfaces, 7 end early or use up their budget; nearly all of them have
//! the closest point at a pole. Of 10,000 pairs of a surface and a shape, 14 do so; all of them
//! have the closest point within about 1e-6 of the rim of a cylinder or cone.

pub(crate) mod bezier;
mod bezier_surface;
mod bowl;
mod closest;
mod error;
mod gap;
pub(crate) mod height;
pub(crate) mod net;
pub(crate) mod nurbs;
#[cfg(feature = "serde")]
mod persist;
mod region;
mod search;
mod solid;
mod surface_and_solid;
mod top;
mod tree;
mod two_surfaces;

#[cfg(feature = "__internals")]
#[doc(hidden)]
pub use bezier_surface::SurfacePart;
pub use bezier_surface::{BezierSurface, SurfaceWork};
pub use error::SurfaceError;
pub use net::BezierPatch;
pub use nurbs::{Nurbs, revolution};
pub(crate) use surface_and_solid::{SurfaceCompoundTracker, SurfaceShapeTracker, SurfaceSolidPair};
pub(crate) use two_surfaces::{SurfacePair, SurfaceTracker};
