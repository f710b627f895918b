//! Checks and plans motions of robots among obstacles, with proofs.
//!
//! A [`Checker`] combines two things. A [`ConfigurationSpace`] gives the poses of the robot's
//! bodies at a configuration and their motion along a segment. A [`Cell`] holds the bodies of the
//! robot, the obstacles and the pairs that may touch; shapes may be of any kind.
//! [`Checker::certify`] decides a segment over its whole length. There is no step size, so no
//! contact between two samples is missed. [`RrtConnect`] searches for a path of segments that are
//! proven free.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny_plan::{Checker, JointMotion, PlanOptions, RigidSpace, Cell, RrtConnect, Shortcuts};
//! use lin_canny::polyhedron::solids;
//!
//! // A rod, and a wall of two blocks with a slit between them.
//! let mut cell = Cell::new();
//! cell.robot_body("rod", solids::cuboid(Vector3::new(0.5, 0.1, 0.1))?);
//! let block = solids::cuboid(Vector3::new(0.2, 1.0, 2.0))?;
//! for (name, y) in [("left", 1.2), ("right", -1.2)] {
//!     let at = Isometry3::translation(0.0, y, 0.0);
//!     cell.add_obstacle(name, block.clone(), at)?;
//! }
//! let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.5, 1)?;
//! let mut checker = Checker::new(space, cell)?;
//!
//! let at = |x: f64| Isometry3::translation(x, 0.8, 0.0);
//! let ends = [-1.5, 1.5].map(|x| RigidSpace::configuration(&at(x)));
//! assert!(!checker.certify(&JointMotion::segment(&ends[0], &ends[1]))?.is_free());
//! let plan = RrtConnect::new(&PlanOptions::default()).plan(&mut checker, &ends[0], &ends[1])?;
//! let path = plan.path.expect("the slit is wide enough");
//! let short = Shortcuts::new(100, 1).shorten(&mut checker, &path)?;
//! assert!(checker.certify(&JointMotion::path(&short)?)?.is_free());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Motions
//!
//! | question | function | result |
//! |---|---|---|
//! | Is a motion free: a segment, a path, a polynomial curve or a spline? | [`Checker::certify`] of a [`JointMotion`], [`is_free`](Checker::is_free) | [`Verdict`]: free, blocked by a pair at a time of a piece, or undecided |
//! | May a part leave the table on which it lies? | [`Checker::set_start_contact_margin`], then `certify` | [`Verdict::Free`] with the contacts that are left |
//! | And with a tracking error of each joint? | [`JointMotion::with_tube`]; [`Checker::tube_contact`] | [`Verdict`] for all motions within the error; a contact within it |
//! | Are all motions near a segment free? | [`JointMotion::with_radius`] | [`Verdict`] for all motions within a distance of the segment |
//! | How does a robot execute a path smoothly, within its limits? | [`Smoother`] | rows of times, positions and velocities, and curves proven free |
//! | And among obstacles that move? | [`Cell::add_moving_obstacle`], [`JointMotion::with_times`] | [`Verdict`] on one clock |
//! | Why is a motion free? | [`Checker::certify_with`] | the certificates of every pair, in order of time |
//! | How does somebody else check it? | [`Receipt::motion`](receipt::Receipt::motion) | a text that proves it without this library: see [`receipt`] |
//! | How large is the clearance along a motion? | [`Checker::clearance_along`] | a proven lower bound, and a distance that is attained |
//! | Is a configuration free? | [`Checker::is_free_at`] | `true` or `false`, without distances |
//! | How large is the clearance at a configuration? | [`Checker::clearance`], [`nearest`](Checker::nearest) | signed distance, witness points, gradient |
//! | And at many configurations? | [`Checker::nearest_batch`] | the same as arrays; see the chapter [`gradients`](guide::gradients) |
//! | Can two bodies meet at any configuration of a range? | [`RangeProver`] | [`RangeVerdict`]: never, always, both, or open |
//! | Which pairs are in contact? | [`Checker::in_contact`] | pairs |
//! | How does the cell change between queries? | [`Checker::cell_mut`] | the [`Cell`]; see the chapter [`cells`](guide::cells) |
//! | Which path leads from a start to a goal? | [`RrtConnect`], [`Opportunistic`], [`PlanMethod`] | [`Plan`] with a path of segments that are proven free; [`Shortcuts`] shortens it |
//!
//! Each chapter of the [`guide`] has a whole program for one task, and its limits.
//!
//! # How a segment is checked
//!
//! A segment is checked pair by pair:
//!
//! 1. Swept boxes along the axes of the world exclude most obstacles. Each box covers a body during
//!    a part of the segment in which its points stay near the chords of their paths
//!    ([`chord_deviation`](SegmentMotion::chord_deviation)).
//! 2. Boxes around the bodies, along their own axes, exclude most of the remaining pairs during
//!    these parts, without a distance query.
//! 3. Each remaining pair is cast ([`impact`](lin_canny::impact)). A step of the cast bounds how
//!    long a plane that rotates with the closest features separates the pair. The next step starts
//!    there.
//! 4. If a pair comes into contact, the cast returns a time up to which the pair is proven apart,
//!    and a time at which it is proven to be in contact. Between both, the pair moves by about a
//!    millionth of its size.
//!
//! A curve is checked in the same way: a straight segment of a tree of joints is a curve of degree
//! one. Bounds of a curve hold for a span, so casts of a curve are cut where joints turn far. Casts
//! with a moving obstacle are cut at its rows.
//!
//! The motion of two links is measured relative to the last link that carries both. Every proof
//! includes the rounding of the motion, of the poses and of the distances. It holds for the motion
//! over the real numbers and for the poses that [`SegmentMotion::pose`] returns at any `f64`.
//!
//! # Spaces
//!
//! | space | configuration |
//! |---|---|
//! | [`PlanarSpace`] | x, y and an angle |
//! | [`TranslationSpace`] | x, y and z |
//! | [`RigidSpace`] | position and quaternion |
//! | [`JointTree`] | revolute, prismatic, ball and fixed joints, in one chain (`serial`) or with branches; joints may mimic another, and a link may carry any number of bodies |
//!
//! The crate `lin-canny-robot` reads a [`JointTree`] from a URDF. For any other robot, implement
//! [`ConfigurationSpace`].
//!
//! # The search for a path
//!
//! Two planners search with a checker: the chapter [`paths`](guide::paths) compares them.
//!
//! Every edge of the roadmap is proven free, and a path is certified again in its direction. Both
//! planners are *probabilistically complete*: the probability of missing a path whose clearance
//! exceeds the margin tends to zero as the search goes on. Neither proves that there is no path.
//!
//! ## RRT-Connect
//!
//! 1. Draw a random configuration. The nearest node of a tree takes a step towards it, if the step
//!    is proven free.
//! 2. From the new node, go on towards the nearest node of the other tree, step by step, until a
//!    step is blocked. If the tree arrives there, the search is done.
//! 3. The smaller tree is next.
//!
//! ## The opportunistic planner
//!
//! The clearance of a configuration is the least signed distance of all pairs. A *slice* holds one
//! *sweep coordinate* fixed. As the sweep coordinate moves, a local maximum of the clearance within
//! the slice moves along a *freeway*, as far from the obstacles as the slice allows.
//!
//! 1. From start and goal, climb within the slice to a freeway. The steps follow the gradients of
//!    all pairs that are nearly closest, because the maxima are where several pairs are equally
//!    close.
//! 2. Follow the freeway in both directions. Predict along the secant, and correct by a climb
//!    within the next slice. Each step is proven free, or halved.
//! 3. A freeway ends where its maximum meets a saddle (an *inflection*), where its channel closes,
//!    or at a bound. Search the slice of the end in the same way, with one dimension less. Freeways
//!    of a slice are called *bridges*.
//! 4. Channels split and join where the robot is between two obstacles on opposite sides. Search
//!    for such a configuration with an *extension*, a motion towards a random configuration up to the
//!    first contact. If it finds one, start a slice there, swept along the channel. Otherwise take
//!    a random slice: a random configuration, in contact or not, and a random sweep coordinate.
//!    Random slices find most narrow passages, because the climb within the slice leads into the
//!    passage.
//! 5. Link the new nodes to other components of the roadmap by straight segments. If start and goal
//!    are in one component, the search is done.
//!
//! The planner is complete in the sense above because extensions reach every open set and are
//! linked.
//!
//! # When not to use it
//!
//! The spaces are geometric. For dynamics or closed chains use another planner. Curves are proven
//! among moving obstacles, but the search of a path has no clock. Each chapter of the [`guide`]
//! lists the limits of its task.
//!
//! # Sources
//!
//! Canny and Lin 1993, "An opportunistic global path planner", Algorithmica 10 (the thesis, chapter
//! 6); Schwarzer, Saha and Latombe 2005, "Adaptive dynamic collision checking" (segments proven by
//! bounds of displacements); Kuffner and LaValle 2000, "RRT-Connect" (and extensions); Yershova,
//! Jaillet, Simeon and LaValle 2005, "Dynamic-domain RRTs". Departures of the opportunistic
//! planner:
//!
//! 1. Segments are proven by separating planes over an interval instead of displacements, so the
//!    steps are longer.
//! 2. Critical points are not enumerated from the constraints of all feature pairs. Contacts
//!    between opposite obstacles, found locally, replace them.
//! 3. The ascent is a proximal bundle method, because the clearance has kinks at its maxima.
//! 4. Straight links and extensions join components of the roadmap before bridges are searched.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod cell;
mod check;
mod error;
mod extremes;
mod fingerprint;
mod motion;
mod names;
mod random;
mod range;
pub mod receipt;
mod search;
mod tolerance;

pub use cell::attached_object::AttachedObject;
pub use cell::margins_and_paddings::RequiredDistance;
pub use cell::robot_model::{Coordinate, LinkBody, MotionKind, RobotJoint, RobotLink, RobotModel, turn_from_z};
pub use cell::{Cell, Named};
pub use check::batch::NearPairs;
pub use check::certify::{Certified, CertifyOptions, PairProof};
pub use check::checker::Checker;
pub use check::clearance::{NearPair, SegmentClearance};
pub use check::verdict::{CheckWork, LeavingPair, Verdict};
pub use error::PlanError;
pub use motion::curve::JointCurve;
pub use motion::joint::{Drive, Joint, JointKind, TreeJoint};
pub use motion::joint_motion::JointMotion;
pub use motion::rigid::{PlanarSpace, RigidSegment, RigidSpace, TranslationSpace};
pub use motion::space::{BodyBall, BodyMotion, ConfigurationSpace, JointPath, SegmentMotion};
pub use motion::timed_poses::TimedPoses;
pub use motion::tree::JointTree;
pub use motion::tree_motion::TreeSegment;
pub use motion::tube::JointTube;
pub use names::{CellBody, CellPair, Select, nearest_name};
pub use range::pair_boxes::PairBoxes;
pub use range::{ClearanceWidth, RangeAnswer, RangeCell, RangeOptions, RangeProver, RangeVerdict};
pub use search::freeway::FreewayEnd;
pub use search::options::{Plan, PlanMethod, PlanOptions, PlanWork};
pub use search::plan::{Opportunistic, RrtConnect};
pub use search::roadmap::{Edge, EdgeKind, Freeway, Roadmap};
pub use search::shorten::{Path, Shortcuts, widen};
pub use search::smooth::{SmoothOptions, SmoothPath, Smoother};

/// One chapter for each task, with a whole program that is run as a test.
pub mod guide {
    #[doc = include_str!("../docs/cells.md")]
    pub mod cells {}
    #[doc = include_str!("../docs/paths.md")]
    pub mod paths {}
    #[doc = include_str!("../docs/ranges.md")]
    pub mod ranges {}
    #[doc = include_str!("../docs/curves.md")]
    pub mod curves {}
    #[doc = include_str!("../docs/receipts.md")]
    pub mod receipts {}
    #[doc = include_str!("../docs/gradients.md")]
    pub mod gradients {}
}

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
