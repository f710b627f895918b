//! Collision detection with proven bounds: tracks the closest features of moving bodies from frame
//! to frame.
//!
//! Two bodies at a pose have a signed distance. If they are apart, it is the distance of their
//! closest points. If two convex bodies overlap, it is the negative penetration depth: the
//! length of the shortest translation that separates them. A [`Tracker`] remembers the closest
//! features of one pair and finds the features of the next frame in a few steps. Every distance
//! comes with a lower and an upper bound that hold for the given poses, rounding included.
//! Curved shapes, meshes, scenes and times of impact use the same bounds.
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
//! # Is it for you?
//!
//! Yes, if you need distances that you can rely on, or if you query the same pairs at many nearby
//! poses. Use [rapier](https://rapier.rs) for dynamics and a ray tracer for pictures. For a game
//! whose bodies are half a metre and larger, [parry](https://parry.rs) alone is good enough.
//! The [`guide`] has a chapter for each task.
//!
//! # Which function?
//!
//! A [`Tracker`] takes two convex polyhedra. A [`PairTracker`] takes any two geometries: polyhedra,
//! curved or rounded shapes, meshes, compounds, clouds, Bézier surfaces and half-spaces.
//!
//! **One pair**
//!
//! | question | call | answer |
//! |---|---|---|
//! | Do two polyhedra share a point? Are they at most `d` apart? | [`Tracker::intersects`], [`within`](Tracker::within) | `bool`, exact; touching counts |
//! | How far apart are two polyhedra, or how deep do they overlap? | [`Tracker::distance`] | [`Distance`]: value and bounds; negative for an overlap |
//! | Which points and features are closest? | [`Tracker::closest`] | [`Outcome`]: features, witness points, normal, distance, bounds |
//! | How far apart are they, to within 1 ulp? | `Tracker::closest_exact` (feature `exact`) | contact state exact, distance within 1 ulp; depths as by `closest` |
//! | Which features does the walk end on, without bounds? | [`Tracker::propose`] | [`Proposal`]: features and witness points |
//! | How deep do two polyhedra overlap at most, in a fraction of the time? | [`Tracker::closest_with_local_depth`] | as `closest`, with an upper bound of the depth that is often the depth |
//! | Where do two polyhedra touch, for a solver of contacts? | [`Tracker::manifold`] | [`Manifold`]: contact points with ids that last over frames |
//! | How does the distance change with the poses? | [`Outcome::gradient_a`], [`gradient_b`](Outcome::gradient_b) | [`Gradient`]: derivative of the signed distance by either pose |
//! | How do I report a query? | [`Tracker::replay`] | [`Replay`]: a text that rebuilds the query bit for bit |
//!
//! **Any two geometries**
//!
//! | question | call | answer |
//! |---|---|---|
//! | Do any two geometries overlap, and how far apart are they: two meshes, or a mesh and a ball? | [`PairTracker`]: `intersects`, `within`, `distance`, `closest` | `bool`, [`Distance`], [`PairOutcome`] with the piece, triangle or patch of each witness; overlaps of meshes, compounds and surfaces have distance 0, but their depth in a half-space is exact |
//! | Where do any two bodies but Bézier surfaces touch? How deep do two solids overlap? | [`PairTracker::contacts`], [`penetration`](PairTracker::penetration) | [`ContactGroup`]: points with one normal, for gaps up to a prediction and shallow overlaps; [`PenetrationBounds`]: an interval |
//! | How much of two solids overlaps? In which curves do their surfaces cross? | [`PairTracker::overlap`], [`overlap_loops`](PairTracker::overlap_loops) | [`OverlapVolume`]: proven bounds of the shared volume for all ties, and its centre of mass; [`OverlapLoops`]: closed polylines, and the area of each face inside the other solid |
//! | How far is a mesh from itself, and which of its triangles are close? | [`PairTracker::self_closest`], [`self_within`](PairTracker::self_within), [`self_pairs`](PairTracker::self_pairs) | [`PairOutcome`]s, for triangles that share no vertex |
//! | On which side of a body is a point, and how far is it? What is near it? | [`PointQuery`]: `closest_point`, `contains`, `signed_distance`, `nearest_features`, `within`, and batches of points | [`PointOutcome`]: proven side, signed distance with bounds, closest point; exact sides for polyhedra, meshes and half-spaces |
//! | Which balls contain a body, and which are inside it? | [`cover::cover_outside`], [`cover_inside`](cover::cover_inside) | [`BallCover`](cover::BallCover): balls, with a proven bound of how far they and the body differ |
//! | Which convex polyhedron of few faces contains a body? | [`cover::hull_outside`] | [`HullCover`](cover::HullCover): the polyhedron and its planes, with a proven bound of how far it sticks out of the convex hull |
//! | Where does a ray enter a body (any but a Bézier surface)? | [`RayCaster::cast`], [`scene::Scene::cast_ray`] | [`RayCast`]: a hit with a proven bracket, point, normal and feature; a miss; inside; or undecided |
//!
//! **Over time**
//!
//! | question | call | answer |
//! |---|---|---|
//! | When do two moving bodies first touch? | [`impact::cast`], [`cast_within`](impact::cast_within) with [`PairTracker::pair`] and two motions | [`Impact`](impact::Impact): in contact at the start; a hit with a proven bracket; a proven miss; or free until a proven time |
//! | Does a body leave a contact, or slide along it, without coming closer? | [`PairTracker::cast_from_contact`] | [`Cast`](impact::Cast): the proven distances, and when the bodies have left the contact |
//! | When do meshes meet whose vertices move on straight paths, or a mesh and itself? | [`continuous::cast_meshes`], [`cast_self`](continuous::cast_self) | a proven bracket, or a proven miss; touching is decided |
//! | When must a pair be queried again? | [`schedule::Schedule`] | due pairs, by integer ticks |
//! | Is a motion of a robot free over its whole length? Is there a path? | `Checker` of the crate `lin-canny-plan` | proven free, or the time and the pair that collide; a path |
//!
//! **Many bodies**
//!
//! | question | call | answer |
//! |---|---|---|
//! | Which of many bodies overlap, come near or meet? What is the closest pair of two groups? | [`scene::Scene`] | after `set_queries`: events, impacts and results |
//! | Which parts of a model clash, how deep, and which gaps are too small? | `find` of the crate `lin-canny-clash` | a row for each pair: kind, gap, depth, volume and point; flush parts touch and do not clash |
//! | Which boxes overlap? | [`broad::SweepAndPrune`] | pairs, events, stable ids |
//!
//! **Bodies and poses**
//!
//! | question | call | answer |
//! |---|---|---|
//! | How do I build a body from points or faces? | [`ConvexPolyhedron::from_points`], [`from_faces`](ConvexPolyhedron::from_faces) | a body with its [`BuildReport`], or a [`BuildError`] |
//! | How do I build a ball, capsule, cylinder, cone, ellipsoid or a rounded body? | [`Shape`] | a shape for [`PairTracker`] |
//! | How do I build a common solid? | [`polyhedron::solids`] | a body |
//! | How do I build a flat body? | [`polygon`](ConvexPolyhedron::polygon), [`segment`](ConvexPolyhedron::segment), [`point`](ConvexPolyhedron::point) | a body |
//! | How do I give the pose of B relative to A? | [`RelativePose::new`] | a checked pose, or a [`PoseError`] |
//! | How much does the hull of a mesh add? | [`Mesh::hull_fit`] | [`HullFit`]: volumes and the largest gap |
//! | How well do convex pieces approximate a mesh? | [`Decomposition`] | [`DecompositionFit`]: gaps; distances as intervals that hold for the mesh |
//!
//! # Frames and units
//!
//! Body A sets the frame: [`RelativePose`] maps B's coordinates to A's (`a_from_b`). `point_on_a`
//! and `normal` are in A's frame, `point_on_b` is in B's; [`in_world`](Outcome::in_world) maps all
//! three to the world. The normal is a unit vector from A to B. Lengths are in the caller's unit,
//! whichever that is.
//!
//! [`RelativePose::new`] returns an error for a rotation whose squared norm differs from 1 by more
//! than 1e-12. For poses from `f32`, files or integration, [`RelativePose::new_normalized`]
//! normalises both rotations first, and [`normalize_rotation`] does so for the poses of a scene.
//! The types of the interface are those of [`lin_canny::nalgebra`](nalgebra); between versions of
//! nalgebra, numbers cross as arrays.
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
//! of the last answer and, for an overlap, the polytope that proved the depth. The chart on top
//! counts the pairs tested: hardly more than one for small motions, for any number of
//! vertices.
//!
//! **The certificate.** The criterion holds for real numbers. With rounding, borders blur: nearly
//! parallel edges have no good formula, regions of nearly coplanar faces are slivers, and a walk
//! may circle or stop on the wrong pair. So the walk only proposes. Two bounds that need no history
//! judge the proposal: the distance of any two points of the bodies is an *upper* bound, and for
//! any unit vector n the gap between the supporting planes perpendicular to n, least `n . b` minus
//! greatest `n . a`, is a *lower* bound. At the closest points, with n along the line between them,
//! the two bounds are equal. The crate computes both, adds the error of its rounding, and
//! returns [`Outcome::lower`] and [`Outcome::upper`]. If the bounds do not meet, finer solvers take
//! over: [`Outcome::solver`] names the solver that answered.
//!
//! # Guarantees
//!
//! * **Bounds hold.** The true signed distance lies in `lower..=upper`. Inputs count as exact: a
//!   vertex v at the pose (q, t) is the rational point `R(q) v / |q|^2 + t`. The source of
//!   the module `tolerance` derives every constant.
//! * **One signed distance of convex bodies.** Distance and negative depth are one continuous
//!   function of the pose, so the value does not jump at contact.
//! * **A tracker changes the time, never the answer.** Contact state and predicates of polyhedra
//!   are the same warm and cold, A to B and B to A, and distances agree within their bounds. A
//!   tracker that last followed other bodies costs time only. If several feature pairs are exactly
//!   equally close, earlier queries may decide which one is reported. The section
//!   [Limits](#limits) has the other kinds of geometry.
//! * **No absolute tolerance.** Scale a scene by a power of two, and every length in the answer
//!   scales exactly. Exception: if the scaled sizes of the two bodies lie on opposite sides of a
//!   storage limit (2^105, 2^-105, ...), bits may differ; contact state and bounds still agree.
//!   Curved shapes and compounds scale exactly for sizes from 2^-90 to 2^90.
//! * **Invalid input returns an error when a body or a pose is made**, with its index or value
//!   ([`BuildError`], [`PoseError`]). After that no query panics, returns NaN or loops without
//!   bound. Debug builds check the closest points of two polyhedra, and panic with a
//!   replay if the crate has a defect.
//! * **The same bits everywhere.** Answers have the same bits on every target with IEEE 754
//!   arithmetic and for any number of threads. 32-bit x86 without SSE2 does not compile.
//! * **Safe.** The crate contains no `unsafe` code. Bodies are [`Send`] and [`Sync`]. No query
//!   changes a body; only calls such as [`Mesh::set_vertices`] do. A tracker belongs to one pair at
//!   a time and owns no body.
//!
//! | level | bounds |
//! |---|---|
//! | [`Tracker::propose`] | none: the features on which the walk ends |
//! | [`Tracker::closest`], [`Tracker::distance`] | at most `1e-13 L` wide, but for *degenerate depths* ([Limits](#limits)) |
//! | [`Tracker::closest_with_local_depth`] | as `closest`; the depth is bounded from above, by a translation that separates the bodies |
//! | `Tracker::closest_exact` | contact state exact, distance within one unit in the last place; depths as by `closest` |
//! | [`Tracker::intersects`], [`Tracker::within`] | exact with the feature `exact`; without it, ties count as within |
//! | [`impact::cast`] | a bracket of the first contact, a miss, or a time until which the bodies are free: proven for every instant |
//!
//! The pair size L is the sum of both bounding radii plus the distance between the reference
//! points. The reference point of a body is its origin. If the middle of the box of a polyhedron,
//! mesh, compound or cloud is more than two half diagonals from the origin in a coordinate, the
//! reference point has that coordinate of the middle; then 2^-49 of the distance from the origin is
//! added to L. The chapter [accuracy](guide::accuracy) has the time of each level.
//!
//! # Limits
//!
//! | geometry | width of bounds | near contact | depth | contacts |
//! |---|---|---|---|---|
//! | polyhedra, rounded or not | `1e-13 L` | exact (feature `exact`) | bounded both ways | [`Tracker::manifold`] |
//! | curved shapes | `1e-13 L` | within `3e-14 L` touching or undecided; `intersects` and `within` return true unless a search proves the shapes apart | bounded both ways to `1e-13 L` if a ball inside the shapes proves the depth, else to about `2^-19 L`; wider if both have one centre | [`PairTracker::manifold`] |
//! | meshes, compounds | `1e-13 L`; compounds whose pieces have poses `1.5e-13 L` | predicates of meshes and of compounds whose pieces have no pose exact (feature `exact`), but for two ties of [`PairTracker::within`]; within `1e-13 L` of contact, the contact state may be touching instead of separated or overlapping | [`PairTracker::penetration`]: an interval that may stay wide | [`PairTracker::contacts`], for shallow overlap |
//! | clouds | `1.5e-13 L` | ties count as within; at the identity as exact as the element and the other body | bounds of [`PairTracker::penetration`] | [`PairTracker::contacts`] |
//! | Bézier surfaces | you choose | undecided if the interval allows both answers, at one pose perhaps warm and not cold | none | none |
//! | half-spaces, with a body of any kind | as the other body, `1e-13 L` and less | ties count as within; with a Bézier surface undecided | the signed distance, bounded both ways | [`PairTracker::contacts`] |
//!
//! * **Sizes.** The extent of a body is from 1e-100 to 1e100; one body may be any number of times
//!   larger than the other. Coordinates below 2^-200 of a body's radius are stored as zero and
//!   counted in the build report. Control points of Bézier surfaces are at most 2^200 (1.6e60), and
//!   pairs with surfaces and L below 2^-300 (5e-91) are measured by their origins alone.
//! * **Witnesses of an overlap** lie on the supporting planes of the named features, not always on
//!   the features: see [`Outcome::features`].
//! * **Time of a depth.** 0.5 to 5 µs for small motions of bodies of 8 to 512 vertices, 10 µs at
//!   random poses of bodies of 40 vertices, milliseconds for round bodies of thousands of faces
//!   about one centre.
//! * **Degenerate depths** that no floating-point arithmetic decides (two needles a billionth as
//!   thick as long, one inside the other) are decided facet by facet over integers with the feature
//!   `exact`: below a millisecond for boxes, 0.1 s for two plates of 59 sides. The faces must be
//!   flat to the last bit, as the faces of hulls are. At most four million pairs of edges are
//!   examined, 65,536 of them exactly; beyond that the bounds are returned as they are.
//! * **Bézier surfaces** that are equally far along a curve or over an area keep wide intervals.
//!
//! A part that is not convex is a [`Mesh`], or its faster [`hull`](Mesh::hull), of which
//! [`Mesh::hull_fit`] measures how much it adds. A part that was decomposed elsewhere (CoACD,
//! V-HACD) is a [`Compound`] of the pieces, and [`Decomposition`] measures how far mesh and pieces
//! are apart. Points of a depth camera, and voxels, are a [`Cloud`].
//!
//! # Cargo features
//!
//! The chapter [features](guide::features) has those of all packages, and the checked combinations.
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `std` | yes | square roots of the machine; without it the crate is `no_std` and needs `alloc` |
//! | `exact` | yes | exact integer arithmetic if the floating-point filters fail: it decides contact state and predicates of polyhedra, and adds `closest_exact` |
//! | `meshes` | yes | compounds, meshes and clouds: queries, contacts, bounds of penetration depths |
//! | `surfaces` | no | Bézier and NURBS surfaces; needs `meshes` |
//! | `serde` | no | bodies, poses, trackers, manifolds, scenes, ids and results in files; bodies are checked when read; `serde_json` needs its feature `float_roundtrip` to keep every bit |
//! | `parallel` | no | multithreading in the broad phase, and in scenes with 625 or more queries per step; results are bit-identical for any number of threads |
//! | `tracing` | no | an event if a solver falls back, a budget runs out or input is rejected |
//!
//! # Reading the source
//!
//! `ARCHITECTURE.md` in the repository has the layers, the data flow, the invariants and a table of
//! questions and files. Start with `convex/walk/mod.rs`, the loop of the walk on one screen; then
//! `pair/certificate.rs`, the proof, and `convex/solve/mod.rs`, the solvers behind the walk.
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
//! 3. Voronoi regions are not flared. If rounding ends a walk early or at the wrong pair, the
//!    certificate fails and the next solver runs.
//! 4. Every answer carries bounds (the duality gap of Gilbert, Johnson and Keerthi 1988).
//! 5. If the walk fails, solvers that do not walk follow, so no answer is lost to a cycle.
//! 6. Overlapping bodies are an answer with a depth and a proof, not a walk that never ends.
// Without surfaces or exact arithmetic, code that only they use is dead.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    not(all(feature = "surfaces", feature = "exact")),
    allow(dead_code, unused_imports, unused_macros)
)]
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
mod half_space;
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
mod point;
mod ray;
#[cfg(test)]
#[allow(dead_code, unreachable_pub)]
#[path = "../tests/support/rng.rs"]
mod rng;
pub mod scene;
#[cfg(feature = "surfaces")]
pub mod surface;
mod time;

pub use base::callbacks::{Progress, WithProgress};
pub use base::motion;
pub use base::motion::Velocity;
pub use base::pose::{Operand, PoseError, RelativePose, normalize_rotation};
pub use base::tolerance::{EXTENT_MAX, POSE_UNIT};
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
pub use nonconvex::cloud::{Cloud, CloudElement, CloudError};
#[cfg(feature = "meshes")]
pub use nonconvex::contact::{ContactGroup, ConvexPatches, PatchContact};
#[cfg(feature = "meshes")]
pub use nonconvex::continuous;
#[cfg(feature = "meshes")]
pub use nonconvex::decomposition::{Decomposition, DecompositionFit};
#[cfg(feature = "meshes")]
pub use nonconvex::mesh::{
    HullFit, Mesh, MeshCap, MeshError, MeshInspection, MeshKind, MeshPart, MeshRepair, MeshReport, RepairOptions,
    VertexError,
};
#[cfg(feature = "meshes")]
pub use nonconvex::penetration::PenetrationBounds;
#[cfg(feature = "meshes")]
pub use nonconvex::pieces::{Compound, CompoundError, Piece};
#[cfg(feature = "meshes")]
pub use nonconvex::query::search::TreeWork;
#[cfg(feature = "meshes")]
pub use nonconvex::volume::{FaceShare, OverlapLoops, OverlapVolume};
pub use pair::location::{PairOutcome, WitnessLocation};
pub use pair::options::QueryOptions;
pub use pair::outcome::WorldWitnesses;
pub use pair::outcome::{Accuracy, ContactState, Decision, DepthMode, Distance, Outcome, Proposal, Solver, Work};
pub use pair::point::PointOutcome;
#[cfg(feature = "meshes")]
pub use pair_tracker::OverlapError;
pub use pair_tracker::geometry::{Geometry, GeometryKind, GeometryRef};
pub use pair_tracker::{MovingPair, PairError, PairTracker, PairWork};
pub use point::cover;
pub use point::{DistanceGrid, PointError, PointQuery, PointTracker};
pub use ray::{Ray, RayCast, RayCaster, RayError, RayHit};
pub use time::{impact, schedule, separation};

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
