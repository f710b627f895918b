//! Curved surfaces: Bezier patches and NURBS, and the distance of two of them in a proven interval.
//!
//! Reading order: [`net`](Patch) (one patch), `bezier` (de Casteljau), `nurbs` ([`Nurbs`], taken
//! apart), `surface` ([`Surface`]), `revolution`, `tree` (control nets by halves), `height` (how
//! far a node reaches along a direction), `frame` (a pair at a pose), `gap` (two nodes apart),
//! `closest` (two points, by Newton's method), `crossing` (a proof that surfaces meet), `front` and
//! `search` (the proof of an answer), `tracker` ([`SurfaceTracker`], the queries).
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
//! [`composite`](crate::composite). Departures:
//!
//! 1. The answer is an interval of a width asked for, down to `2^-42` of the size, with every
//!    rounding counted.
//! 2. Nodes are closed by second derivatives, so the cost of a narrow interval does not grow with
//!    its narrowness where one surface curves away from the plane between.
//!
//! # What is missing
//!
//! Trimmed surfaces; insides of closed surfaces, so a body within a closed surface has a positive
//! distance; contacts with [`Shape`](crate::Shape)s, which are not split (convex polyhedra and
//! meshes are surfaces of flat patches); time of impact and scenes; a cap where both surfaces are
//! saddles or one lies in the hollow of the other: there the number of splits grows with the
//! logarithm of the width; no exact arithmetic decides touching surfaces.

mod bezier;
mod closest;
mod crossing;
mod error;
mod frame;
mod front;
mod gap;
mod height;
mod net;
mod nurbs;
mod outcome;
mod revolution;
mod search;
mod surface;
mod tracker;
mod tree;

pub use error::PatchError;
pub use net::Patch;
pub use nurbs::Nurbs;
pub use outcome::{Decision, SurfaceOutcome, SurfacePart, SurfaceWork};
pub use revolution::revolution;
pub use surface::{Surface, SurfacePoint};
pub use tracker::SurfaceTracker;
