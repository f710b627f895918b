//! Motions of robots among obstacles: segments proven free, and paths made of such segments.
//!
//! A [`Checker`] joins a [`ConfigurationSpace`] (where the bodies of a robot are at a
//! configuration, and how they move along a segment) with a [`World`] (the bodies of the robot, the
//! obstacles, of every kind of shape, and the pairs that may touch). [`Checker::certify`] decides a
//! segment over its whole length: no step size, no contact missed between two samples.
//! [`Checker::plan`] searches a path.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny_plan::{Checker, PlanOptions, RigidSpace, World};
//! use lin_canny::polyhedron::solids;
//!
//! // A rod, a wall of two blocks with a slit between them.
//! let mut world = World::new();
//! world.robot_body("rod", solids::cuboid(Vector3::new(0.5, 0.1, 0.1))?);
//! let block = solids::cuboid(Vector3::new(0.2, 1.0, 2.0))?;
//! for (name, y) in [("left", 1.2), ("right", -1.2)] {
//!     let at = Isometry3::translation(0.0, y, 0.0);
//!     world.obstacle(name, block.clone(), at);
//! }
//! let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.5, 1)?;
//! let mut checker = Checker::new(space, world)?;
//!
//! let at = |x: f64| Isometry3::translation(x, 0.8, 0.0);
//! let ends = [-1.5, 1.5].map(|x| RigidSpace::configuration(&at(x)));
//! assert!(!checker.certify(&ends[0], &ends[1])?.is_free());
//! let plan = checker.plan(&ends[0], &ends[1], &PlanOptions::default())?;
//! let path = plan.path.expect("the slit is wide enough");
//! let short = checker.shorten(&path, 100, 1)?;
//! assert!(checker.certify_path(&short)?.1.is_free());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Segments
//!
//! | question | function | answer |
//! |---|---|---|
//! | Is a segment free? | [`Checker::certify`], [`is_free`](Checker::is_free) | [`Verdict`]: free, blocked at a time by a pair, unknown |
//! | Is a path free? | [`Checker::certify_path`] | the first segment that is not |
//! | Is a spline, or a motion with an error of tracking, free? | [`Checker::certify_tube`] | [`Verdict`] on all motions that close to the segment |
//! | Why is the segment free? | [`Checker::prove`] | the certificates of every pair, one after the other |
//! | How clear is the segment? | [`Checker::clearance_along`] | a proven bound, and a distance that is attained |
//! | Is a configuration free? | [`Checker::is_free_at`] | yes or no, by predicates alone |
//! | How clear is a configuration? | [`Checker::clearance`], [`nearest`](Checker::nearest) | signed distance, witnesses, gradient |
//!
//! A segment is looked at pair by pair. Boxes swept over stretches of the segment, each as long as
//! the motion is nearly a parabola, sort out most obstacles, balls most of the rest without a
//! distance query; two links are looked at from the last link that carries both. A look at one of the remaining pairs proves as much
//! of the segment as a separating plane holds that turns with the closest features
//! ([`impact`](lin_canny::impact)), and the next look begins where the plane ends. A pair that comes
//! into contact ends with a time up to which the pair is proven apart and a time at which the pair
//! is proven to meet, about a millionth of the pair's size apart. Rounding of the
//! motion, of the poses and of the distances is part of every proof: of the motion over the reals,
//! and of the poses that [`SegmentMotion::pose`] places at any f64.
//!
//! # Spaces
//!
//! [`PlanarSpace`] (x, y, angle), [`TranslationSpace`], [`RigidSpace`] (position and quaternion)
//! and [`JointTree`] (revolute, prismatic and fixed joints, branches, joints that mimic another,
//! any number of bodies on a link), of which [`SerialArm`] is the case of one chain. The crate
//! `lin-canny-robot` reads one from a URDF. Any other robot implements [`ConfigurationSpace`].
//!
//! # The opportunistic planner
//!
//! The clearance of a configuration is the least signed distance of all pairs. A *slice* holds one
//! *sweep coordinate* fixed. As the sweep coordinate moves, a local maximum of the clearance within
//! the slice moves along a *freeway*, as far from the obstacles as the slice allows.
//!
//! 1. From start and goal, climb within the slice to a freeway: steps along the gradients of the
//!    pairs that are nearest together, as the maxima lie where several pairs are equally near.
//! 2. Follow the freeway both ways: predict along the secant, correct by a climb within the next
//!    slice. Each step is proven free, or halved.
//! 3. A freeway ends where its maximum meets a saddle (an *inflection*), where its channel closes,
//!    or at a bound. Search the slice of the end in the same way, with one dimension less: freeways
//!    of a slice are *bridges*.
//! 4. Channels split and join where the robot lies between two obstacles on opposite sides of it.
//!    Look for such a place by a *feeler*, a motion towards a random configuration up to the first
//!    contact, and begin a slice there, swept along the channel; else take a random slice: a
//!    random configuration, in contact or not, and a random sweep coordinate. Narrow passages are
//!    mostly found by such a slice, since the climb within the slice leads into the passage.
//! 5. Link what is new by straight segments to other components of the roadmap. Start and goal in
//!    one component: done.
//!
//! Every edge of the roadmap is proven free. The search is *probabilistically complete*, no more:
//! the probability of missing a path whose clearance exceeds the margin tends to zero with the
//! number of slices, since feelers reach every open set and are linked. No answer ever says that
//! there is no path. Budgets count ([`PlanOptions`]) or stop by a clock of the caller
//! ([`Checker::plan_with_progress`]); the same seed gives the same answer, bit for bit.
//!
//! # When not to use it
//!
//! A robot with dynamics, moving obstacles, closed chains: the spaces here are geometry. Six free
//! axes in tight clutter take seconds: an arm through a window 0.5 and 0.35 m high at most 0.5 and
//! 4.1 s over 20 seeds, a plank 0.2 thick through a hole of 0.3 at most 0.7 s
//! (`crates/plan/tests`, ignored tests). A planner with a tuned sampler and fixed steps may be faster
//! and may be wrong.
//!
//! No other planner is part of the crate: [`Checker::is_free_at`] and [`is_free`](Checker::is_free)
//! answer what sampling planners ask of a configuration and of a motion. RRT-Connect of the crate
//! `oxmpl` is a dependency of the benchmarks alone (`race plan`), although light (`log` and
//! `rand`): its motions are checked at fixed steps inside the planner, so that a certified checker
//! cannot take their place.
//!
//! # Sources
//!
//! Canny and Lin 1993, "An opportunistic global path planner", Algorithmica 10 (the thesis, chapter
//! 6); Schwarzer, Saha and Latombe 2005, "Adaptive dynamic collision checking" (segments proven by
//! bounds of displacements); Kuffner and LaValle 2000, RRT-Connect (feelers). Departures:
//!
//! 1. Proofs of segments are planes over an interval, not displacements: steps are longer.
//! 2. Critical points are not enumerated from the constraints of all pairs of features; contacts
//!    between opposite obstacles, found locally, stand for them.
//! 3. The ascent is a proximal bundle method, since the clearance has kinks at its maxima.
//! 4. Straight links and feelers join parts of the roadmap before bridges are searched.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arm;
mod ascent;
mod checker;
mod clearance;
mod error;
mod extremes;
mod free;
mod freeway;
mod links;
mod opportunistic;
mod pairs;
mod path;
mod random;
mod rigid;
mod roadmap;
mod search;
mod space;
mod tolerance;
mod tree;
mod tree_motion;
mod verdict;
mod world;

pub use arm::{Joint, JointKind, SerialArm};
pub use checker::{Checker, PairProof};
pub use clearance::{NearPair, SegmentClearance};
pub use error::PlanError;
pub use freeway::FreewayEnd;
pub use opportunistic::{Plan, PlanOptions, PlanWork};
pub use path::Path;
pub use rigid::{PlanarSpace, RigidSpace, TranslationSpace};
pub use roadmap::{Edge, EdgeKind, Freeway, Roadmap};
pub use space::{BodyMotion, ConfigurationSpace, SegmentMotion};
pub use tree::{Drive, JointTree, TreeJoint};
pub use tree_motion::TreeSegment;
pub use verdict::{CheckWork, Verdict};
pub use world::{World, WorldId, WorldPair};

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
