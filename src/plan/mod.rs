//! Motions of robots among obstacles: segments proven free.
mod arm;
mod arm_motion;
mod ascent;
mod checker;
mod clearance;
mod error;
mod freeway;
mod opportunistic;
mod pairs;
mod path;
mod random;
mod rigid;
mod roadmap;
mod space;
mod world;

pub use arm::{Joint, JointKind, SerialArm};
pub use arm_motion::ArmSegment;
pub use checker::{CheckWork, Checker, PairProof, Verdict};
pub use clearance::{Near, SegmentClearance};
pub use error::PlanError;
pub use freeway::FreewayEnd;
pub use opportunistic::{Plan, PlanOptions, PlanWork};
pub use path::Path;
pub use rigid::{PlanarSpace, RigidSpace, TranslationSpace};
pub use roadmap::{Edge, EdgeKind, Freeway, Roadmap};
pub use space::{BodyMotion, ConfigurationSpace, SegmentMotion};
pub use world::{Part, PartPair, World};
