//! Closest features of moving convex polyhedra, tracked from frame to frame, with a proven bound on
//! every answer.
//!
//! Two bodies at a pose have a signed distance: how far apart they are or, if they overlap, minus
//! the length of the shortest translation that separates them. A [`Tracker`] remembers the closest
//! features of one pair and finds the features of the next frame in a few steps. Every distance and
//! depth comes with a lower and an upper bound that hold for the poses given, rounding included.
//! Curved shapes, meshes, scenes of many bodies and times of impact stand on the same bounds.
//!
#![doc = include_str!("../images/hero.svg")]
//!
//! *Left: a tracked pair, the Voronoi region of the closest face, and the features met on the way.
//! Right: feature pairs tested per frame against the motion per frame. Pictures of this page:
//! `cargo run --release -p race --bin figures`.*
//!
//! # Quick start
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
//! use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};
//! use lin_canny::polyhedron::solids;
//!
//! let part = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
//! let corners =
//!     [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]].map(Point3::from);
//! // An error names the point and what is wrong with it.
//! let wedge = ConvexPolyhedron::from_points(&corners)?;
//!
//! let mut pair = Tracker::new(); // one per pair of bodies
//! for frame in 0..10 {
//!     let x = 4.0 - 0.1 * f64::from(frame);
//!     let pose = Isometry3::translation(x, 0.5, 0.5);
//!     let wedge_from_part = RelativePose::new(&Isometry3::identity(), &pose)?;
//!     let c = pair.closest(&wedge, &part, &wedge_from_part);
//!     assert!(c.lower <= c.distance && c.distance <= c.upper);
//!     println!("{} {:.6}", c.features, c.distance);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Frames.** Body A sets the frame: [`RelativePose`] maps B's coordinates to A's (`a_from_b`).
//! `point_on_a` and `normal` are in A's frame, `point_on_b` in B's;
//! [`in_world`](Outcome::in_world) maps all three to the world. The normal is a unit vector from A
//! to B. Lengths are in the caller's unit, whatever the unit.
//!
//! # Which function?
//!
//! A chapter for each of the questions that users bring stands in the [`guide`].
//!
//! | question | call | answer |
//! |---|---|---|
//! | Do two bodies share a point? Are they at most `d` apart? | [`Tracker::intersects`], [`within`](Tracker::within) | `bool`, exact; touching counts |
//! | How far apart, how deep? | [`Tracker::distance`] | [`Distance`]: signed value and bounds |
//! | Where, and which features? | [`Tracker::closest`] | [`Outcome`]: features, witness points, normal, distance, bounds |
//! | How far apart, to within one unit in the last place? | `Tracker::closest_exact` (feature `exact`) | state exact, distance within one unit in the last place; depths as by `closest` |
//! | As fast as possible, without bounds? | [`Tracker::propose`] | [`Proposal`]: features and witness points |
//! | How deep at most, at about three times the time of a distance? | [`Tracker::closest_with_local_depth`] | as `closest`; for an overlap a proven upper bound of the depth, often the depth itself |
//! | Which points hold two bodies apart? | [`Tracker::manifold`] | [`Manifold`]: contact points with names that last over frames |
//! | What does a motion do to the distance? | [`Outcome::gradient_a`], [`gradient_b`](Outcome::gradient_b) | [`Gradient`]: derivative of the signed distance by either pose |
//! | When do they meet? | [`impact::cast`], [`cast_within`](impact::cast_within) | a proven bracket, or a proven miss |
//! | When do triangles whose vertices move on straight paths meet, when meshes that bend, or one and itself? | [`continuous::cast_triangles`], [`vertex_face`](continuous::cast_vertex_face), [`edge_edge`](continuous::cast_edge_edge), [`meshes`](continuous::cast_meshes), [`self_contact`](continuous::cast_self) | a proven bracket, or a proven miss; touching is decided |
//! | How far is a mesh from itself, which of its triangles are near each other? | [`PairTracker::self_closest`], [`self_within`](PairTracker::self_within), [`self_pairs`](PairTracker::self_pairs) | [`PairOutcome`]s, for triangles that share no vertex |
//! | Where does a ray enter a body? | [`RayCaster::cast`], [`scene::Scene::cast_ray`] | [`RayCast`]: a proven bracket, point, normal, feature |
//! | When must a pair be measured again? | [`schedule::Schedule`] | due pairs, by integer ticks |
//! | The same of any two geometries: curved and rounded `Shape`s, `Compound`s, `Mesh`es, `surface::BezierSurface`s? | [`PairTracker`] | [`PairOutcome`]: an outcome, and the piece, triangle or patch of each witness |
//! | Which points hold any two solids apart, how deep are they? | [`PairTracker::contacts`], [`penetration`](PairTracker::penetration) | [`ContactGroup`]: points by direction, with names that last; [`PenetrationBounds`]: an interval |
//! | Many bodies: who overlaps, is near, meets when; the closest pair of two groups? | [`scene::Scene`] | events, impacts and answers for the queries that are enabled |
//! | Only the pairs of boxes? | [`broad::SweepAndPrune`] | pairs, events, stable ids |
//! | Is a motion of a robot free over its whole length, is there a path? | `Checker` of the crate `lin-canny-plan` | proven free, or the time and the pair that collide; a path |
//! | How do I report this query? | [`Tracker::replay`] | [`Replay`]: a text that rebuilds it bit for bit |
//! | A ball, capsule, cylinder, cone, ellipsoid, anything rounded? | [`Shape`] | a body for [`PairTracker`] |
//! | Where does B stand? | [`RelativePose::new`] | a checked pose, or a [`PoseError`] |
//! | A body of points, of faces? | [`ConvexPolyhedron::from_points`], [`from_faces`](ConvexPolyhedron::from_faces) | a body with its [`BuildReport`], or a [`BuildError`] |
//! | How much does the hull of a mesh add? | [`Mesh::hull_fit`] | [`HullFit`]: volumes and the largest gap |
//! | How well do convex pieces stand for a mesh? | [`Decomposition`] | [`DecompositionFit`]: gaps; distances as intervals that hold for the mesh |
//! | A common solid? | [`polyhedron::solids`] | a body |
//! | A flat body? | [`polygon`](ConvexPolyhedron::polygon), [`segment`](ConvexPolyhedron::segment), [`point`](ConvexPolyhedron::point) | a body |
//! | Is a point inside, what is the nearest one? | [`contains`](ConvexPolyhedron::contains), [`closest_point`](ConvexPolyhedron::closest_point) | one body, one point |
//!
//! # Guarantees
//!
//! * **Bounds hold.** The true signed distance lies in `lower..=upper`, for the bits given: a
//!   vertex v at the pose (q, t) is at `R(q) v / |q|^2 + t`, over the rationals. Every constant
//!   has its derivation, by the rules of the page [`tolerance`].
//! * **One decision through contact.** Separated, touching and overlapping are one continuous
//!   quantity with one normal and the same features; no second algorithm can disagree at contact.
//! * **State changes time, never the answer.** Contact state and predicates are the same warm and
//!   cold, A to B and B to A, and distances agree within their bounds. Only among exact ties may
//!   features follow the history. A tracker last used with other bodies costs time and nothing
//!   else. Meshes and bodies of pieces keep bounds and predicates so; within `1e-13 L` of contact
//!   their contact state may be one of two neighbours. For curved shapes,
//!   [`within`](PairTracker::within) may follow the history if `d` lies between the bounds.
//! * **No absolute tolerance.** A scene scaled by a power of two gives the answer scaled bit for
//!   bit, unless the scale puts the sizes of two bodies on both sides of 2^105, 2^-105 or another
//!   border between units of storage: then contact state and bounds agree. Curved shapes and
//!   compounds keep their bits for sizes from 2^-90 to 2^90, and the agreement of their bounds
//!   beyond.
//! * **Bad input is refused when a body or a pose is made** ([`BuildError`], [`PoseError`]), with
//!   its index or value. After that no query panics, loops without bound or returns NaN. (Debug
//!   builds check every answer and panic, with a text that replays the query, on a defect of the
//!   crate.)
//! * Bodies are [`Send`] and [`Sync`] and never change; a tracker belongs to one pair at a time and
//!   owns no body. The crate contains no `unsafe` code.
//!
//! | level | promise |
//! |---|---|
//! | [`Tracker::propose`] | the result of the walk: no bounds in its type |
//! | [`Tracker::closest`], [`Tracker::distance`] | bounds no wider than `1e-13 L` |
//! | [`Tracker::closest_with_local_depth`] | as `closest`; the depth of an overlap is bounded from above by a translation that parts the bodies, perhaps not the shortest |
//! | `Tracker::closest_exact` | the contact state is exact, the distance of separated bodies within one unit in the last place; depths as by `closest` |
//! | [`Tracker::intersects`], [`Tracker::within`] | exact with the feature `exact`; without the feature, ties count as within |
//! | [`impact::cast`] | a bracket of the first contact of two motions, or a miss, proven for every instant |
//!
//! L is the sum of both radii and the distance between the reference points of the two bodies. The
//! reference point of a body is its origin; in a coordinate in which the middle of the body's box
//! is more than two half diagonals from the origin, the middle of the box. For bodies far from
//! their own origin 2^-49 of that distance is added to L. What each level costs, and where the
//! crate loses: [`cost`].
//!
//! # Limits
//!
//! * A body's extent lies between 1e-100 and 1e100; one body may be any number of times larger than
//!   the other. Coordinates below 2^-200 of a body's radius are stored as zero and counted in the
//!   build report.
//! * Answers have the same bits on every target with IEEE 754 arithmetic. On 32-bit x86 without
//!   SSE2 the crate does not compile: the x87 unit rounds twice, and no bound would hold.
//! * Of an overlap, the witnesses lie on the supporting planes of the features named, not always on
//!   the features: see [`Outcome::features`].
//! * The depth of an overlap takes half a microsecond to two if the motions are small; ten at
//!   random poses of bodies of 40 vertices; milliseconds for round bodies of thousands of faces
//!   about one centre.
//! * Degenerate depths that no floating-point arithmetic decides (a needle a billionth as thick as
//!   long laid into its like) are decided facet by facet over integers, with the feature `exact`:
//!   below a millisecond for boxes, a tenth of a second for twin plates of 59 sides. The faces must
//!   be flat to the last bit, as the faces of hulls are, and at most four million pairs of edges
//!   are examined, 65,536 of them exactly. Otherwise the bounds stay open and are returned as they
//!   are.
//! * Contacts of meshes and bodies of pieces ([`PairTracker::contacts`]) are those of shallow
//!   overlap. Their depth is an interval ([`PairTracker::penetration`]) that may stay wide.
//! * Curved shapes ([`shape`]) have the same bounds, superquadrics twice as wide. Contact state and
//!   predicates are exact for polyhedra, rounded or not; other shapes within `3e-14 L` of contact,
//!   superquadrics within `1e-13 L`, count as touching or are undecided, and `intersects` and
//!   `within` return true unless a search of their own proves the shapes apart. Depths of curved
//!   shapes are searched to `2^-19 L` if no ball inside the shapes proves them, and may stay wider
//!   about a common centre: see [`PairTracker`].
//! * Bézier surfaces ([`surface`]) have an interval of a width asked for. If the interval holds
//!   both answers, `intersects` and `within` are undecided, at one pose perhaps warm and not cold.
//!   Surfaces that are equally far along a curve or over an area keep wide intervals. Coordinates
//!   are at most 2^200 (1.6e60), and pairs with L below 2^-300 (5e-91) are measured by their
//!   origins alone.
//! * There is no dynamics: see rapier.
//!
//! # Recipes
//!
//! ## Poses from `f32`, files and integration
//!
//! [`RelativePose::new`] refuses a rotation whose squared norm differs from 1 by more than 1e-12.
//! [`RelativePose::new_normalized`] normalises both rotations first, and [`normalize_rotation`]
//! does so for the poses of a scene.
//!
//! ## Another version of nalgebra
//!
//! The types of the interface are those of [`lin_canny::nalgebra`](nalgebra). Numbers cross between
//! versions as arrays: `[[f64; 3]]` for points, `pose.translation.vector` and
//! `pose.rotation.coords` for poses.
//!
//! ## Bodies and poses of parry and rapier
//!
//! The documentation of the crate `lin-canny-parry` has the lines that convert both.
//!
//! ## Parts that are not convex
//!
//! [`Mesh`] takes the mesh as it is. The [`hull`](Mesh::hull) of a mesh is faster;
//! [`Mesh::hull_fit`] measures how much the hull adds. A part that was decomposed elsewhere (CoACD,
//! V-HACD) is a [`Compound`] of the pieces, and [`Decomposition`] measures how far mesh and pieces
//! are apart. The member `lin-canny-parry` runs parry's V-HACD.
//!
//! # The idea in five minutes
//!
//! A polyhedron is made of **features**: vertices, edges and faces. Two bodies apart are closest at
//! a pair of points, and each point lies on one feature of its body: the *closest features*. There
//! are few kinds of feature pairs, and for each kind the closest points are a formula. So the
//! question "how far apart?" becomes "which features?".
//!
//! **Voronoi regions.** The Voronoi region of a feature is the set of points outside the body that
//! are closer to this feature than to any other. Regions have plane borders: a prism over a face, a
//! wedge at an edge, a cone at a vertex. Whether a point lies in a region is decided by a few
//! signs, one per adjacent feature.
//!
#![doc = include_str!("../images/regions.svg")]
//!
//! **The criterion** (Lin and Canny 1991). Take a feature of each body and the closest points of
//! these two features. The points are the closest points of the bodies if and only if each lies in
//! the Voronoi region of the other feature. The rest of the two bodies need not be examined.
//!
//! **The walk.** If a point lies outside the region, a border was crossed, and behind this border
//! lies an adjacent feature that is closer. The walk steps there and tests again. The distance
//! falls with each step and features are finite in number, so the walk ends.
//!
#![doc = include_str!("../images/walk.svg")]
//!
//! *The point has moved from the ring to the dot. The feature remembered (1) is no longer the
//! closest one: three steps to neighbours lead to the one that is (4).*
//!
//! **Coherence.** Between two frames bodies move a little, so the closest features of the last
//! frame are still closest, or a step away from the closest. A [`Tracker`] remembers the features
//! of the last answer and, for an overlap, the surface that proved the depth. The chart on top
//! counts the pairs tested: hardly more than one for small motions, whatever the number of
//! vertices.
//!
//! **The certificate.** The criterion holds for real numbers. With rounding, borders blur: nearly
//! parallel edges have no good formula, regions of nearly coplanar faces are slivers, and a walk
//! may circle or stop on the wrong pair. So the walk only proposes. Two bounds that need no history
//! judge the proposal: the distance of any two points of the bodies is an *upper* bound, and for
//! any unit vector n the gap between the supporting planes perpendicular to n, least `n . b` minus
//! greatest `n . a`, is a *lower* bound. At the closest points, with n along the line between them,
//! the two bounds are equal. The crate computes both, adds the error of its own rounding, and
//! returns [`Outcome::lower`] and [`Outcome::upper`]. If the bounds do not meet, finer solvers take
//! over: [`Outcome::solver`] names the solver that answered.
//!
//! # Cargo features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `std` | yes | square roots by the machine, `std::error::Error` everywhere; without it the crate is `no_std` with `alloc` |
//! | `exact` | yes | exact integers behind the filters: every contact state and predicate decided, distances of separated bodies to the last bit |
//! | `meshes` | yes | compounds and meshes, their contacts, bounds of penetration depths |
//! | `surfaces` | yes | Bézier and NURBS surfaces; needs `meshes` |
//! | `serde` | no | bodies, poses, trackers, manifolds, scenes, ids and answers in files; bodies are checked again when read; `serde_json` keeps every bit with its feature `float_roundtrip` |
//! | `parallel` | no | threads in the broad phase, and in scenes from 625 queries a step on; the same answers bit for bit for any number |
//! | `tracing` | no | events for a subscriber of `tracing`: solvers that fall back, budgets spent, input refused |
//!
//! # Reading the source
//!
//! `ARCHITECTURE.md` in the repository has the layers, the data flow from points to a body and
//! from a pose to an outcome, the invariants and a glossary. Start with `walk/mod.rs`: the loop
//! is on one screen; then `pair/certificate.rs`, the proof, and `solve/mod.rs`, the solvers
//! behind the walk.
//!
//! # From the thesis
//!
//! M. C. Lin, "Efficient collision detection for animation and robotics", PhD thesis, UC Berkeley,
//! 1993; before it M. C. Lin and J. F. Canny, "A fast algorithm for incremental distance
//! calculation", ICRA 1991.
//!
//! | thesis | here |
//! |---|---|
//! | chapter 3, incremental distance computation | [`polyhedron`], [`Tracker`] |
//! | chapter 4, curved bodies | [`shape`], [`PairTracker`]; Bézier surfaces: [`surface`] |
//! | chapter 4, non-convex bodies | [`nonconvex`] |
//! | chapter 5, many moving bodies | [`broad`], [`scene`]; scheduling by time: [`impact`], [`schedule`] |
//! | chapter 6, path planning | the crate `lin-canny-plan` |
//!
//! Departures:
//!
//! 1. Four pairs of kinds instead of six: an edge over a face slides to one of its ends or to the
//!    rim, two faces meet as a vertex and a face or as two edges (Mirtich 1998, V-Clip). The states
//!    on which the walk of 1991 circles are gone.
//! 2. Faces and vertices are not cut to a bounded number of neighbours: the pieces would be
//!    coplanar, and walks break on coplanar neighbours. Coplanar facets are one face; large fans
//!    and rims are searched.
//! 3. Regions are not flared by small angles. Rounding may end a walk early or wrongly, and the
//!    certificate says so.
//! 4. Every answer carries bounds (the duality gap of Gilbert, Johnson and Keerthi 1988).
//! 5. Behind the walk stand solvers that do not walk; no answer is lost to a cycle.
//! 6. Overlapping bodies are an answer with a depth and a proof, not a walk that never ends.
//!
//! # Citation
//!
//! ```bibtex
//! @software{lin_canny,
//!   title   = {lin-canny: certified incremental closest features of moving convex bodies},
//!   author  = {{The lin-canny contributors}},
//!   version = {0.1.0},
//!   year    = {2026},
//! }
//! ```
// What meshes and surfaces alone use lies idle without them.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(not(feature = "surfaces"), allow(dead_code, unused_imports, unused_macros))]
#![no_std]
// Bits that differ by target are refused by `.clippy.toml`; tests are free.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!("lin-canny needs IEEE 754 arithmetic: the x87 unit rounds twice; enable `sse2`");

mod base;
mod body;
pub mod broad;
mod convex;
#[cfg(feature = "meshes")]
pub mod nonconvex;
// Pages of the documentation, and tests of their code; no part of the library.
#[cfg(feature = "__proofs")]
#[doc(hidden)]
pub mod __proofs;
#[cfg(all(any(doc, doctest), feature = "surfaces", feature = "exact"))]
pub mod guide;
mod pair;
mod pair_tracker;
#[cfg(test)]
#[allow(dead_code, unreachable_pub)]
#[path = "../tests/support/rng.rs"]
mod rng;
pub mod scene;
#[cfg(feature = "surfaces")]
pub mod surface;
mod time;

pub use base::motion::Velocity;
pub use base::notice::Progress;
pub use base::pose::{Operand, PoseError, RelativePose, normalize_rotation};
pub use base::{cost, motion, tolerance};
pub use body::polyhedron::{
    BoxHint, BuildError, BuildReport, ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId,
};
pub use body::shape::{Shape, ShapeError};
pub use body::{polyhedron, shape};
pub use convex::contact::{
    ContactPoint, Gradient, HalfSpace, HalfSpaceContact, HalfSpaceContacts, HalfSpaceError, Manifold, ManifoldOptions,
};
pub use convex::replay::{Replay, ReplayError};
pub use convex::tracker::{Tracker, TrackerWork};
pub use nalgebra;
#[cfg(feature = "meshes")]
pub use nonconvex::contact::{ContactGroup, ConvexPatches, PatchContact};
#[cfg(feature = "meshes")]
pub use nonconvex::continuous;
#[cfg(feature = "meshes")]
pub use nonconvex::decomposition::{Decomposition, DecompositionFit};
#[cfg(feature = "meshes")]
pub use nonconvex::meet::search::TreeWork;
#[cfg(feature = "meshes")]
pub use nonconvex::mesh::{HullFit, Mesh, MeshError, MeshInspection, MeshKind, MeshPart, MeshReport, VertexError};
#[cfg(feature = "meshes")]
pub use nonconvex::penetration::PenetrationBounds;
#[cfg(feature = "meshes")]
pub use nonconvex::pieces::{Compound, CompoundError, Piece};
pub use pair::location::{PairOutcome, WitnessLocation};
pub use pair::options::QueryOptions;
pub use pair::outcome::WorldWitnesses;
pub use pair::outcome::{Accuracy, ContactState, Decision, DepthMode, Distance, Outcome, Proposal, Solver, Work};
pub use pair_tracker::geometry::{Geometry, GeometryKind, GeometryRef};
pub use pair_tracker::ray::{Ray, RayCast, RayCaster, RayError, RayHit};
pub use pair_tracker::{MovingPair, PairError, PairTracker, PairWork};
pub use time::{impact, schedule, separation};

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
