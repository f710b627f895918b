//! Closest features of moving convex polyhedra, tracked from frame to frame, with a proven bound on
//! every answer.
//!
#![doc = include_str!("../images/hero.svg")]
//!
//! *Left: a tracked pair, the Voronoi region of the closest face, and the features met on the way.
//! Right: the feature pairs looked at in a frame against the motion in it. Pictures of this page:
//! `cargo run --release --example figures`.*
//!
//! # Quick start
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
//! use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, polyhedron::solids};
//!
//! let part = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
//! let corners = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]].map(Point3::from);
//! let wedge = ConvexPolyhedron::from_points(&corners)?; // an error names the point and what is wrong with it
//!
//! let mut pair = Tracker::new(); // one for each pair: the features of the last answer
//! for frame in 0..10 {
//!     let part_pose = Isometry3::translation(4.0 - 0.1 * f64::from(frame), 0.5, 0.5);
//!     let wedge_from_part = RelativePose::new(&Isometry3::identity(), &part_pose)?;
//!     let c = pair.closest(&wedge, &part, &wedge_from_part);
//!     assert!(c.lower <= c.distance && c.distance <= c.upper);
//!     println!("{} {:.6} +- {:.0e}", c.features, c.distance, (c.upper - c.lower) / 2.0);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which function?
//!
//! | question | function | answer |
//! |---|---|---|
//! | Do two bodies share a point? | [`Tracker::intersects`] | `bool`, touching counts |
//! | Are they at most `d` apart? | [`Tracker::within`] | `bool` |
//! | How far apart, how deep? | [`Tracker::distance`] | [`Distance`]: signed value and bounds |
//! | Where, and which features? | [`Tracker::closest`] | [`Outcome`]: features, witnesses, normal, bounds |
//! | The same to the last bit? | `Tracker::closest_exact` (feature `exact`) | [`Outcome`] |
//! | As fast as possible, without bounds? | [`Tracker::propose`] | [`Proposal`]: no bounds |
//! | Which points hold them apart? | [`Tracker::manifold`] | [`Manifold`]: contact points, with names that last |
//! | What does a motion do to the distance? | [`Outcome::gradient_a`], [`gradient_b`](Outcome::gradient_b) | [`Gradient`] of the signed distance |
//! | When do they meet? | [`impact::cast`], [`impact::cast_within`] | a proven bracket or a proven miss |
//! | When must a pair be measured again? | [`schedule::Schedule`] | due pairs, by integer ticks |
//! | Meshes that are not convex? | [`MeshTracker`] on [`Mesh`]es | the same questions, [`MeshOutcome`]; inside a solid is an overlap |
//! | Bodies of several convex pieces, or a convex body and a mesh? | [`CompositeTracker`] on [`Composite`]s and [`Mesh`]es | [`CompositeOutcome`] |
//! | Which points hold meshes apart? | [`PatchTracker`] on [`ContactPatches`] | [`PatchContacts`]: points by direction, with names that last |
//! | Many moving bodies? | [`scene::Scene`] | events and answers for the effects called for |
//! | Only the pairs of boxes? | [`broad::PencilSweep`] | pairs, events, stable ids |
//! | Which feature pairs would the walk test? | [`Tracker::trace`] | the walk, pair by pair |
//! | How do I report this query? | [`Tracker::replay`] | [`Replay`]: a text that rebuilds it bit for bit |
//! | Balls, capsules, cylinders, cones, ellipsoids, anything rounded? | [`ShapeTracker`] on [`Shape`] | the same questions, [`Outcome`] |
//! | Where does B stand? | [`RelativePose::new`] | a checked pose, or a [`PoseError`] |
//! | A body of points, of faces? | [`ConvexPolyhedron::from_points`], [`from_faces`](ConvexPolyhedron::from_faces) | a body with its [`BuildReport`], or a [`BuildError`] |
//! | A common solid? | [`polyhedron::solids`] | a body |
//! | A flat body? | [`polygon`](ConvexPolyhedron::polygon), [`segment`](ConvexPolyhedron::segment), [`point`](ConvexPolyhedron::point) | a body |
//! | Is a point inside, what is the nearest one? | [`contains`](ConvexPolyhedron::contains), [`closest_point`](ConvexPolyhedron::closest_point) | one body, one point |
//!
//! Bodies that overlap are a negative distance apart: minus the length of the shortest shift that
//! parts them, B along the normal.
//!
//! A, the first body, sets the frame: [`RelativePose`] maps B's coordinates into A's (`a_from_b`),
//! `point_on_a` and `normal` are in A's frame, `point_on_b` is in B's: `pose_a * point_on_a` and
//! `pose_b * point_on_b` are in the world. The normal is a unit vector from A to B. Lengths are in
//! the caller's unit, whatever it is.
//!
//! # Bodies and poses of parry and rapier
//!
//! The types of this crate are those of [`nalgebra`], in `f64`; parry and rapier have `glam`'s,
//! rapier mostly in `f32`. What goes over is numbers. A rotation from `f32` has to be normalised in
//! `f64`, or it is refused ([`PoseError`]).
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
//! use lin_canny::{BuildError, ConvexPolyhedron, RelativePose, Tracker};
//! use parry3d::{math::{Pose, Vector}, shape}; // `rapier3d::parry` and `rapier3d::math` are the same
//!
//! /// The hull of vertices: of `Cuboid::to_trimesh`, `ConvexPolyhedron::points`, `TriMesh::vertices` and so on.
//! fn body(points: &[Vector]) -> Result<ConvexPolyhedron, BuildError> {
//!     let wide = |p: &Vector| Point3::from(p.to_array().map(f64::from));
//!     ConvexPolyhedron::from_points(&points.iter().map(wide).collect::<Vec<_>>())
//! }
//!
//! fn pose(pose: &Pose) -> Isometry3<f64> {
//!     let [i, j, k, w] = pose.rotation.to_array().map(f64::from);
//!     let translation = Translation3::from(pose.translation.to_array().map(f64::from));
//!     Isometry3::from_parts(translation, UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)))
//! }
//!
//! let a = body(&shape::Cuboid::new(Vector::new(1.0, 2.0, 3.0)).to_trimesh().0)?;
//! let b = body(shape::ConvexPolyhedron::from_convex_hull(&shape::Ball::new(0.5).to_trimesh(8, 8).0).unwrap().points())?;
//! let (pose_a, pose_b) = (Pose::identity(), Pose::translation(4.0, 0.1, 0.0));
//! let c = Tracker::new().closest(&a, &b, &RelativePose::new(&pose(&pose_a), &pose(&pose_b))?);
//! assert!((c.distance - 2.5).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The idea in five minutes
//!
//! A polyhedron is made of **features**: vertices, edges and faces. Two bodies apart are closest at
//! a pair of points, and each of these lies on one feature of its body: the *closest features*.
//! There are few kinds of pairs, and for each the closest points are a formula. So the question
//! "how far apart?" becomes "which features?".
//!
//! **Voronoi regions.** Cut the space outside a body by the feature that is nearest. The pieces
//! have plane borders: over a face a prism, at an edge a wedge, at a vertex a cone. Whether a point
//! lies in the region of a feature is decided by a few signs, one for each neighbour of the
//! feature.
//!
#![doc = include_str!("../images/regions.svg")]
//!
//! **The criterion** (Lin and Canny 1991). Take a feature of each body and the closest points of
//! these two features. They are the closest points of the bodies if and only if each lies in the
//! Voronoi region of the other's feature. Two features are enough to know; the rest of the bodies
//! need not be looked at.
//!
//! **The walk.** Where a point lies outside the region, a border was crossed, and behind this
//! border lies a neighbouring feature that is closer. Step there and look again. The distance
//! falls, features are finite in number, so the walk ends.
//!
#![doc = include_str!("../images/walk.svg")]
//!
//! *The point has moved from the ring to the dot. The feature remembered (1) is no longer the
//! closest one: three steps to neighbours lead to the one that is (4).*
//!
//! **Coherence.** Between two frames bodies move a little, so the closest features of the last
//! frame are the right ones or a step away. That is what a [`Tracker`] remembers: the features of
//! the last answer (and, of an overlap, the surface that proved its depth). The chart on top counts
//! the pairs looked at: hardly more than one for small motions, whatever the number of vertices.
//!
//! **The certificate.** All of this holds for real numbers. With rounding, borders blur: nearly
//! parallel edges have no good formula, regions of nearly coplanar faces are slivers, and a walk
//! may circle or stop on the wrong pair without a sign. So the walk only proposes. Two facts that
//! need no history judge it: the distance of any two points of the bodies is an *upper* bound, and
//! for any direction n the gap between the supporting planes across n, least `n . b` minus greatest
//! `n . a`, is a *lower* bound. At the closest points, with n along them, the two are equal. The
//! walk delivers both; the crate compares them, adds the error of its own rounding, and returns
//! what is then proven: [`Outcome::lower`] and [`Outcome::upper`]. Where they do not meet, other
//! solvers take over: [`Solver`] says which one answered.
//!
//! # Accuracy
//!
//! With L the sum of both radii and the distance between the points these are about: the bodies'
//! own origins or, in each coordinate in which the middle of a body's box is more than two half
//! diagonals of it from its origin, that middle.
//!
//! | level | what it promises |
//! |---|---|
//! | [`Tracker::propose`] | the walk's word: no bounds in its type |
//! | [`Tracker::closest`], [`Tracker::distance`] | the true signed distance lies in `lower..=upper`, no wider than `1e-13 L` |
//! | `Tracker::closest_exact` | the class is exact and the distance within one unit in the last place |
//! | [`Tracker::intersects`], [`Tracker::within`] | exact with the feature `exact`; without it ties count as within |
//! | [`impact::cast`] | a bracket of the first contact of two motions, or a miss, proven for every instant |
//!
//! What each of these costs, and where the crate loses: [`cost`].
//!
//! To the L of bodies that lie far from their own origin 2^-49 of that distance is added: it
//! matters where they are of the size of the rounding of their coordinates.
//!
//! The truth is that of the bits given: a vertex v at the pose (q, t) is at `R(q) v / |q|^2 + t`,
//! over the rationals. Every constant stands with its derivation in [`tolerance`].
//!
//! # Guarantees and limits
//!
//! * Bad input is refused where it enters: a body by [`BuildError`], a pose by [`PoseError`], each
//!   with index or value. After that no query panics, loops without bound or returns NaN. (Debug
//!   builds check every answer and panic, with a text that replays the query, on a defect of the
//!   crate.)
//! * State changes time, never the answer: classes and predicates are the same warm and cold, A to
//!   B and B to A, and distances agree within their bounds. Among exact ties features may follow
//!   history. A tracker of other bodies is allowed.
//! * There is no absolute tolerance: a scene scaled by a power of two gives the answer scaled bit
//!   for bit, but where the scale puts the sizes of two bodies on both sides of 2^105, 2^-105 or
//!   another border between units of storage: there class and bounds agree.
//! * Bodies are [`Send`] and [`Sync`] and never change; a tracker belongs to one pair at a time and
//!   owns no body.
//! * A body's extent lies between 1e-100 and 1e100; one body may be any number of times larger than
//!   the other.
//! * The depth of an overlap is tracked: a microsecond for small motions, more where bodies lie
//!   deep or turn far, and milliseconds for round bodies of thousands of faces about one centre.
//!   What no floating-point arithmetic settles (a needle a billionth as thick as long laid into its
//!   like, a speck a trillionth as large as the body on whose edge it sits) is settled facet by
//!   facet in exact arithmetic, below a millisecond for boxes and in a tenth of a second for twin
//!   plates of 59 sides: with the feature `exact`, for faces that are flat to the last bit, as
//!   those of hulls are, and where no more than four million pairs of edges, and 65,536 in
//!   question, are to be looked at. Else its bounds stay open, and are returned as they are.
//! * Coordinates below 2^-200 of a body's radius are stored as zero, and the build report counts
//!   them: answers are those of the body so stored.
//! * Meshes and bodies of pieces have no depth and no place in scenes yet, and contacts only in
//!   shallow overlap; scenes do not request times of impact yet. There is no dynamics: see rapier.
//! * Curved shapes ([`shape`]) have the same bounds; class and predicates are exact for polyhedra,
//!   rounded or not, and within `3e-14 L` of contact undecided for others, whose closest points are
//!   algebraic numbers: there `intersects` and `within` say yes.
//!
//! # Cargo features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `std` | yes | square roots by the machine, `std::error::Error` everywhere; without it the crate is `no_std` with `alloc` |
//! | `exact` | yes | the rung of exact integers (crate `dashu-int`) behind the filters |
//! | `serde` | no | bodies, poses, trackers, manifolds, scenes, ids and answers in files |
//! | `parallel` | no | threads in the broad phase and in the queries of a scene, the same answers bit for bit |
//!
//! # Reading the source
//!
//! `ARCHITECTURE.md` in the repository has the layers, the road of a body and of a pose, the
//! invariants and a glossary. Start with `walk/mod.rs`: the loop is on one screen; then
//! `pair/certificate.rs`, the proof, and `solve/ladder.rs`, the solvers behind the walk.
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
//! | chapter 4, curved bodies | [`shape`], `smooth`, [`ShapeTracker`] |
//! | chapter 4, non-convex bodies | [`composite`] |
//! | chapter 5, many moving bodies | [`broad`], [`scene`]; scheduling by time: [`impact`], [`schedule`] |
//! | chapter 6, path planning | not yet |
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
#![no_std]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

pub mod broad;
pub mod composite;
mod contact;
pub mod cost;
mod depth;
#[cfg(feature = "exact")]
mod exact;
pub mod impact;
mod minimum;
pub mod motion;
mod num;
mod pair;
pub mod polyhedron;
mod pose;
mod replay;
pub mod scene;
pub mod schedule;
pub mod separation;
pub mod shape;
mod shape_tracker;
mod smooth;
mod solve;
mod soundness;
pub mod tolerance;
mod tracker;
mod tuning;
mod walk;

pub use composite::audit::FrontFault;
pub use composite::contact::{ContactPatches, PatchContact, PatchContacts, PatchTracker};
pub use composite::mesh::{Mesh, MeshError, MeshInspection, MeshKind, MeshPart, MeshReport};
pub use composite::outcome::{MeshFeature, MeshOutcome, MeshSpot};
pub use composite::parts::Parts;
pub use composite::pieces::{Composite, CompositeError, CompositeOutcome, CompositeTracker, Piece};
pub use composite::search::MeshWork;
pub use composite::tracker::MeshTracker;
pub use contact::{ContactPoint, Gradient, Manifold, ManifoldOptions};
pub use motion::Velocity;
pub use nalgebra;
pub use pair::outcome::{Accuracy, Class, Distance, Outcome, Proposal, Solver, Work};
pub use pair::world::WorldWitnesses;
pub use polyhedron::{
    BoxHint, BuildError, BuildReport, ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId,
};
pub use pose::{Operand, PoseError, RelativePose, normalize};
pub use replay::{Replay, ReplayError};
pub use shape::{Shape, ShapeError};
pub use shape_tracker::ShapeTracker;
pub use tracker::{Totals, Tracker};

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
