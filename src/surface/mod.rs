//! Curved surfaces: Bézier patches and NURBS; the distance of two of them, and of one and a convex
//! shape or a body of such shapes, in a proven interval.
//!
//! Reading order: [`net`](BezierPatch) (one patch), `bezier` (de Casteljau), `nurbs` ([`Nurbs`],
//! taken apart, and surfaces of [`revolution`]), `surface` ([`BezierSurface`]), `tree` (control
//! nets by halves), `height` (how far a node reaches along a direction, and what the proof asks of
//! a body), `bowl` (where no plane stands between), `gap` (two nodes apart, at a pose), `closest`
//! (two points, by Newton's method, and a proof that surfaces meet), `region` (their surroundings,
//! proven at once), `search` (the proof of an answer, and the front that keeps it), `two_surfaces`
//! (a pair of surfaces, at a pose and over time; a mesh for which one stands), `solid` (a convex
//! shape as such a body) and `surface_and_solid` (a surface and a convex shape, or a body of them).
//!
//! # The proof
//!
//! For any unit direction n, `min over Y of n . y - max over X of n . x` is a lower bound of the
//! distance of the sets X and Y; the distance of two points is an upper bound. A patch lies in the
//! convex hull of its control net, of a rational one with positive weights too, and halves of a
//! patch have nets of their own, four times as flat. So bounds of pairs of ever smaller nodes
//! converge. A front is a set of pairs under which all pairs of patches lie; if each is proven at
//! least `upper - width` apart, the interval is as narrow as asked for. Where the height of a patch
//! is proven concave about its highest point, no split is needed however narrow the interval.
//!
//! Sources: M. C. Lin 1993, sections 4.3 to 4.5 (curved surfaces; resultants and eigenvalues are
//! not needed here); Johnson and Cohen 1998 (lower bounds by hulls of control nets); fronts:
//! [`nonconvex`](crate::nonconvex). Departures:
//!
//! 1. The answer is an interval of a width asked for, down to `2^-42` of the size, with every
//!    rounding counted.
//! 2. Where no plane stands between (nested saddles, hollows), a quadratic surface does (`bowl`).
//! 3. Nodes are closed by second derivatives, so the cost of a narrow interval does not grow with
//!    its narrowness where one surface curves away from the plane between.
//! 4. Around the closest points a region as large as can be is proven at once (`region`), because
//!    its many small nodes would not survive the next frame.
//!
//! # Which pair
//!
//! [`PairTracker`](crate::PairTracker) answers a surface beside any other geometry. A
//! [`Shape`](crate::Shape) is solid and is not split: its own support function bounds it. A
//! [`Compound`](crate::Compound) has a tracker for each piece. A [`Mesh`](crate::Mesh) is its
//! triangles as flat patches, and its inside, if it is closed; [`BezierSurface::from_mesh`] makes a
//! surface of the triangles alone.
//!
//! # What is missing
//!
//! Trimmed surfaces; insides of closed surfaces, so a body within a closed surface has a positive
//! distance; depths and contact manifolds; looks over time along directions, so that a surface that
//! slides along another is looked at often; a bowl for patches of a degree above three: there the
//! number of splits grows with the logarithm of the width; no exact
//! arithmetic decides touching surfaces.
//!
//! # Sizes
//!
//! Coordinates of control points are at most `2^200` (1.6e60; other bodies: 1e100). Answers hold
//! for pairs of any size, and are as narrow as asked for if the size L is between `2^-300` (5e-91)
//! and `2^300`. Beyond, squares of lengths leave f64, and a pair is measured by the distance of
//! its origins alone, to the sum of both reaches: no contact of bodies below that size is decided,
//! and a cast onto one ends as [`Near`](crate::impact::Impact::Undecided) or
//! [`Unknown`](crate::impact::Impact::Incomplete).
//!
//! # Wider intervals than asked for
//!
//! Where the closest points are isolated, the splits of a query grow with the logarithm of the
//! narrowness: 12 in the median of random pairs, 1,848 in one of a thousand. They grow with a power
//! of it, without end in practice, for surfaces that are level:
//!
//! * equally far along a curve: a sphere in the hole of a torus, a tube in a sphere;
//! * equally far over an area: concentric spheres, coaxial tubes, tori about one circle, a patch
//!   and the same patch a little aside.
//!
//! After 2,048 splits, 4,096 and so on a query of two surfaces looks how fast its bounds approach
//! each other. If they would need several times the budget, 20,000 splits by default, the query
//! ends there, with `is_converged` false or undecided. The interval of the pairs named is then some
//! 1e-3 of the size L wide along a curve, and up to 4e-2 over an area. A larger budget makes it
//! narrower: [`QueryOptions::splits`](crate::QueryOptions::splits). A query of a surface and a
//! shape goes on until its budget is used up.
//!
//! Of 10,000 random pairs of surfaces 7 end so or use up their budget, nearly all with the closest
//! point at a pole, and of 10,000 surfaces and shapes 14, all within some 1e-6 of the rim of a
//! cylinder or cone.

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
