//! Robots from their files: URDF and SRDF, branches, mimic joints, meshes, trajectories.
//!
//! ```
//! use lin_canny::nalgebra::Isometry3;
//! use lin_canny_robot::{Cell, LoadOptions, Packages, Robot, Setup, Srdf, Trajectory};
//!
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
//! let packages = Packages::default().with_environment();
//! let options = LoadOptions::default();
//! let robot = Robot::load_with(format!("{folder}/gripper.urdf"), &packages, &options)?;
//!
//! let mut setup = Setup::new();
//! setup.robot("", &robot, Isometry3::identity());
//! setup.ignore_adjacent();
//! setup.ignore("", &Srdf::load(format!("{folder}/gripper.srdf"), &robot)?);
//! setup.cell(&Cell::load(format!("{folder}/cell.json"), &packages, &options.meshes)?);
//!
//! let motion = Trajectory::load(format!("{folder}/carry.csv"), setup.coordinates())?;
//! let mut checker = setup.checker()?;
//! let (_, verdict) = checker.certify_path(&motion.rows)?;
//! assert!(verdict.is_free());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | what | with |
//! |---|---|
//! | a robot of a URDF: links, joints, coordinates | [`Robot`], [`LoadOptions`] |
//! | its meshes as hulls, as they are, or as convex pieces | [`MeshOptions`], [`MeshUse`] |
//! | where `package://` is | [`Packages`] |
//! | pairs of links to ignore: of an SRDF, found by random configurations | [`Srdf`], [`find_ignorable`] |
//! | obstacles of a JSON file | [`Cell`] |
//! | all files of a robot in its cell in one call | [`RobotFiles`] |
//! | robots and obstacles in one [`Checker`](lin_canny_plan::Checker) | [`Setup`] |
//! | configurations of a CSV file | [`Trajectory`] |
//! | a recording for the viewer | [`RobotRecorder`] |
//!
//! The checker is that of [`lin_canny_plan`]: clearances with bounds, segments proven free over
//! their whole length, paths. The tool `lin-canny-robot` does the same without a program.
//!
//! # What a URDF becomes
//!
//! Boxes, cylinders, capsules and spheres are exact: a cylinder is no prism. A joint that turns
//! without limits gets those of [`LoadOptions::continuous_limits`]; planar and floating joints have three and
//! six coordinates, the angles of a floating joint those of `rpy`. A joint that mimics follows the
//! joint at the end of its chain of mimics, whose limits alone hold. Visual elements, inertia,
//! transmissions and sensors are passed over, and so is the axis that points up in a COLLADA file;
//! xacro files have to be expanded.
//!
//! A [`FileError`] names file, line and element. Nothing here panics on a file.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod cell;
mod collada;
mod error;
mod files;
mod geometry;
mod ignorable;
mod mesh_file;
mod packages;
mod recorder;
mod robot;
mod space;
mod srdf;
mod trajectory;
mod turn;
mod urdf;
mod xml;

pub use cell::{Cell, Obstacle};
pub use error::{FileError, FileErrorKind};
pub use files::RobotFiles;
pub use geometry::{MeshOptions, MeshUse};
pub use ignorable::{IgnoreReason, LinkPairCount, find_ignorable};
pub use lin_canny;
pub use lin_canny_plan as plan;
pub use lin_canny_record as record;
pub use packages::Packages;
pub use recorder::RobotRecorder;
pub use robot::{Coordinate, LinkBody, LoadOptions, MotionKind, Robot, RobotJoint, RobotLink};
pub use space::Setup;
pub use srdf::{IgnoredPair, Srdf};
pub use trajectory::{Trajectory, csv_text};
