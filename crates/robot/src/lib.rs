//! Reads robots from URDF, MJCF, SDFormat and SRDF, with branches, mimic joints, meshes and trajectories.
//!
//! ```
//! use lin_canny::nalgebra::Isometry3;
//! use lin_canny_robot::plan::{Cell, Checker, JointMotion};
//! use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, Srdf, Trajectory};
//!
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
//! let packages = Packages::default().with_environment();
//! let options = LoadOptions::default();
//! let robot = Robot::load_with(format!("{folder}/gripper.urdf"), &packages, &options)?;
//!
//! let mut cell = Cell::new();
//! cell.add_robot("", &robot, Isometry3::identity())?;
//! cell.exclude_adjacent();
//! Srdf::load(format!("{folder}/gripper.srdf"), &robot)?.exclude_in(&mut cell, "")?;
//! CellFile::load(format!("{folder}/cell.json"), &packages, &options)?.add_to(&mut cell)?;
//!
//! let motion = Trajectory::load(format!("{folder}/carry.csv"), cell.coordinates())?;
//! let mut checker = Checker::of_robots(cell)?;
//! let verdict = checker.certify(&JointMotion::path(&motion.rows)?)?;
//! assert!(verdict.is_free());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | task | type or function |
//! |---|---|
//! | load the links, joints and coordinates of a URDF, MJCF or SDFormat file | [`Robot`], [`LoadOptions`] |
//! | use meshes as hulls, as triangles, or as convex pieces | [`LoadOptions::meshes`], [`MeshUse`] |
//! | set the folders of `package://` paths | [`Packages`] |
//! | exclude pairs of links, from an SRDF or random configurations | [`Srdf`], [`find_excluded`] |
//! | use the groups and named states of an SRDF | [`Srdf::groups`], [`Srdf::state`] |
//! | load obstacles from JSON or SDFormat | [`CellFile`] |
//! | save the cell of a checker, and load it again | [`CellFile::from_cell`], [`CellFile::save`] |
//! | load all files of robots and their cell in one call | [`RobotFiles`], [`OtherRobot`] |
//! | obstacles that move on the clock of a trajectory | [`CellFile`] with `poses`, [`Cell::add_moving_obstacle`](lin_canny_plan::Cell::add_moving_obstacle) |
//! | put robots and obstacles into one cell | [`Cell::add_robot`](lin_canny_plan::Cell::add_robot), [`Checker::of_robots`](lin_canny_plan::Checker::of_robots) |
//! | read configurations from CSV | [`Trajectory`] |
//! | read trajectories with times and velocities from CSV, or from the JSON or YAML of ROS | [`Trajectory::load_timed`], [`Trajectory::curves`] |
//! | cover links by balls, and fill them with balls, for planners that know only spheres | [`cover_links`], [`urdf_of_balls`], [`json_of_balls`] |
//! | contain links in hulls of few faces, for programs that know only convex polyhedra | [`hull_links`], [`urdf_of_hulls`], [`json_of_hulls`] |
//! | write a recording, or a page that plays it | [`RobotRecorder`], [`record::page`] |
//!
//! The checker of [`lin_canny_plan`] computes clearances with bounds, proves segments free over
//! their whole length, and searches for paths. The command line tool `lin-canny` of the
//! package `lin-canny-cli` does the same without a program.
//!
//! # How a URDF is converted
//!
//! * Boxes, cylinders, capsules and spheres keep their exact shape. A cylinder is not approximated
//!   by a prism.
//! * A box, capsule, cylinder or sphere whose sizes are zero is a point, a segment or a rectangle.
//!   A cylinder of length zero with a radius is an error, as is a negative size. The hull of a flat
//!   mesh is a polygon.
//! * `quat_xyzw` is kept as a quaternion and may have any length. In a file of a version below 1.1,
//!   where urdfdom ignores it, it is an error.
//! * A revolute joint without limits gets the limits [`LoadOptions::continuous_limits`].
//! * A planar joint has three coordinates, a floating joint six. The angles of a floating joint are
//!   those of `rpy`: see [`roll_pitch_yaw`].
//! * A mimic joint follows the joint at the end of its chain of mimics. Only the limits of that
//!   joint are checked.
//! * Below `robot`, the elements `link` and `joint` are read; below `link`, `collision` with its
//!   `origin` and `geometry`; below `joint`, `parent`, `child`, `origin`, `axis`, `limit` (without
//!   effort) and `mimic`. The velocity of a limit is in [`Coordinate::velocity`].
//! * Elements without geometry or kinematics are passed over unread: `visual`, `inertial`,
//!   `dynamics`, `calibration`, `safety_controller`, `transmission`, `gazebo`, `material`,
//!   `sensor`, `ros2_control`, some of other tools, and all of a foreign namespace. A fault in them
//!   changes nothing.
//! * Every other element is an error, and so is an element that is given twice, or an unknown
//!   attribute of `origin`, `axis`, `mimic` or a shape.
//! * What simulators take, because they read XML by tinyxml, is read and listed in
//!   [`Robot::skipped`]: text and CDATA between elements, `--` in a comment, a prefix that is not
//!   declared, and text before the XML declaration. The same holds for MJCF, SDFormat and SRDF. An
//!   attribute that is given twice is an error. Limits of a joint that look like degrees are listed.
//! * Drake's elements are read by their prefix: `drake:capsule` and `drake:ellipsoid` are shapes, a
//!   mesh with `drake:declare_convex` is its hull with every [`LoadOptions::meshes`], and
//!   `drake:collision_filter_group` excludes pairs (see [`Robot::excluded`]). Elements of contacts,
//!   forces, motors and visuals are passed over. Any other, such as `drake:joint`, is an error.
//! * What xacro left is an error: run xacro on the file first.
//! * Files are UTF-8, UTF-16, or ISO-8859-1 or windows-1252 if the XML declaration says so.
//! * The `<up_axis>` of a COLLADA file is ignored, and a glTF, whose Y is up, is not turned.
//!
//! # How an MJCF file is converted
//!
//! [`Robot::load`] reads MuJoCo's XML as well, if the root element is `mujoco`. Poses of bodies and
//! geoms are those of MuJoCo to 1e-12; the pairs that are checked are those of MuJoCo.
//!
//! * The root link is `world`, and each body is a link. A body with several joints, or with a joint
//!   whose `pos` is not zero, has links without bodies before it: `body:joint`. Without a name in
//!   the file, bodies and joints are `body3` and `joint2`, with MuJoCo's numbers, and `_` after them
//!   where the file has that name.
//! * A coordinate is MuJoCo's `qpos` of the joint, so that `ref` is the drawn pose. A free joint
//!   has the position in the world, and angles as in `rpy`; its limits contain the drawn pose. A
//!   ball joint has the angles `JOINT/roll`, `JOINT/pitch` and `JOINT/yaw`. Its `range` limits the
//!   angle of the rotation; the limits of the three angles contain those rotations, and allow more.
//!   [`Robot::configuration_of_qpos`] and [`Robot::qpos_of_configuration`] convert whole configurations.
//! * A joint has limits if `limited` is true, or if it is `auto` and the first number of `range` is
//!   below the second: `range="0 0"` is no limit. A free joint has none. The flags `limit`,
//!   `equality` and `constraint` switch limits and equalities off.
//! * A body with `mocap`, which a program moves, has the coordinates `BODY:mocap/x` to
//!   `BODY:mocap/yaw`, as with a free joint. Exception: if neither the body nor a body below it
//!   collides, the body is at rest. Pairs of two bodies without joints above them are not checked.
//! * Geoms with `contype` and `conaffinity` of zero are visuals, unless an element `pair` names
//!   them. The bits, `exclude`, `pair` and the flag `filterparent` decide which pairs are checked:
//!   see [`Robot::excluded`] and [`Robot::adjacent`]. Masks of a `CellFile` and a second robot change
//!   nothing: all those pairs are checked. A flag that switches contacts off changes nothing, and
//!   is listed in [`Robot::skipped`].
//! * A mesh is used as its hull, as in MuJoCo, or as [`LoadOptions::meshes`] says. Meshes are STL,
//!   OBJ and MSH files, or in the file; a file of points alone is a hull only. A geom that MuJoCo would fit to a mesh is an error.
//! * A plane of a body that no joint moves is a half-space; in a cell it is an obstacle with the
//!   name of the link. A plane that moves is a box of the size [`LoadOptions::plane_extent`] below
//!   the plane. A height field is the solid below its heights, which must be in the file.
//! * An equality of two joints is a mimic joint, and one without a second joint holds the joint.
//!   Other equalities are listed in [`Robot::skipped`]. An equality that is not `active` is none.
//! * `include`, `default`, `frame`, `replicate` and `attach` are read. An attached model, body or
//!   frame has the compiler settings, classes and assets of its file, and the flags of the main
//!   file; the pairs and equalities of its file hold if what they name is attached. `composite`,
//!   `flexcomp`, plugins and fields from pictures are errors.
//!
//! # How an SDFormat file is converted
//!
//! Versions 1.3 to 1.12 are read, each by its rules. What a later version added, such as
//! `relative_to` in version 1.6, has its later meaning, as in libsdformat, and is listed.
//!
//! ```
//! use lin_canny_robot::{Packages, Robot};
//!
//! let bench = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/bench.sdf");
//! let robot = Robot::load(bench, &Packages::default())?;
//! assert!(robot.link("table::top").is_some());
//! // Three joints, and the six coordinates of a part that moves freely.
//! assert_eq!(robot.coordinates().len(), 9);
//! assert_eq!(robot.coordinates()[3].name, "part::block/x");
//! assert_eq!(robot.start()[3..6], [0.3, 0.1, 0.1]);
//! # Ok::<(), lin_canny_robot::FileError>(())
//! ```
//!
//! * The first link is `world`, without bodies. A file has one world, or one model
//!   at its `pose` in the world. Several of them are an error.
//! * Links and joints of a world are named `model::link`. In a file with one model, they have no
//!   prefix; those of a nested model have the prefix of that model.
//! * Links of static models are fixed, and their joints never move. A link that no joint holds
//!   floats in the world. Exception: if a model is alone and none of its joints has the parent
//!   `world`, the tree of its canonical link is fixed.
//! * A floating link has the coordinates `LINK/x`, `LINK/y`, `LINK/z`, `LINK/roll`, `LINK/pitch`
//!   and `LINK/yaw`: its pose in the world, as in `pose`. [`Robot::start`] returns the
//!   configuration in which the file draws the robot, and the limits contain it.
//! * The frame of a link is that of the revolute or prismatic joint that moves it, as in URDF, and
//!   not that of its `pose`.
//! * `relative_to`, `attached_to`, `placement_frame`, `expressed_in`, `canonical_link`, nested
//!   models, and included models, merged or not, are read. An include names a file, or a folder
//!   with `model.config`, of which the file of the highest version is read.
//! * Joints are `revolute`, `continuous`, `prismatic`, `fixed`, `ball`, `universal`, `revolute2` and
//!   `screw`. A ball joint has the angles `JOINT/roll`, `JOINT/pitch` and `JOINT/yaw`, as in `pose`.
//!   A `universal` or `revolute2` joint turns about its `axis`, then about its `axis2`: coordinates
//!   `JOINT/axis` and `JOINT/axis2`, and a link without bodies between them. A screw slides by its
//!   pitch in a turn. `gearbox` joints are an error, as is a link with two parent joints.
//! * All pairs of links of a model are checked, although `self_collide` is false by default.
//!   `collide_bitmask` and `category_bitmask` exclude pairs of bodies: see [`Robot::excluded`].
//! * A `plane` of a [`CellFile`], or of a link that no joint moves, is a half-space; in a cell it is
//!   an obstacle. A plane that moves is a box of the size [`LoadOptions::plane_extent`] below the
//!   plane. A `polyline` is an exact prism. `heightmap`, `image`, a geometry of several polylines,
//!   and a `submesh` of a COLLADA file are errors.
//! * `actor`, `road`, `population`, `state` and an `initial_position` other than zero are left out,
//!   and listed in [`Robot::skipped`]. So are joints of static models.
//! * Elements without geometry or kinematics are passed over unread, such as `visual`, `inertial`,
//!   `sensor`, `light`, `physics`, `gripper` and `plugin`, and all of a foreign namespace. Every
//!   other element or attribute is an error, and so is an element that is given twice.
//!
//! # How an SRDF is read
//!
//! * `disable_collisions`, `enable_collisions` and `disable_default_collisions` say which pairs are
//!   checked. A `group` is a [`JointGroup`] with the members of the groups inside it, and a
//!   `group_state` is a [`GroupState`]. A [`VirtualJoint`] does not move the robot.
//! * The value of a planar joint in a state is `x y theta`, of a floating joint the position and
//!   the quaternion `x y z w`, as in MoveIt. Another count of numbers is an error.
//! * `end_effector`, `passive_joint` (also below a `group`) and some elements of other tools are
//!   passed over; any other element is an error, as is a name that is given twice and a group that
//!   contains itself.
//! * An element that names a link, joint or group which does not exist is listed in
//!   [`Srdf::skipped`].
//!
//! # Bounds
//!
//! A [`FileError`] names the file, the line and the element. No file content causes a panic.
//!
//! While a file is read, it takes at most 4 MiB and 400 bytes for each of its bytes. A mesh file
//! counts as often as it is named. MJCF and SDFormat can ask for much in few words; what they ask
//! for takes at most 128 MiB more, and more than the following is an error:
//!
//! * 20,000 elements that `replicate` copies, those that are passed over counted.
//! * 5,000 geoms of MJCF that collide, or bodies of SDFormat with masks, and 1,000,000 pairs of
//!   them that the file excludes.
//! * 100,000 heights of all height fields.
//! * 256 bytes of a name, with the names of the models around it or with what copies add to it.
//! * 100 joints through which a joint mimics another one.
//! * 10,000 files that SDFormat includes, with 16 MiB. A file counts as often as it is included.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod audit;
mod cell;
mod cell_body;
mod cell_save;
mod cover;
mod csv_rows;
mod drake;
mod error;
mod files;
mod find_excluded;
mod geometry;
mod groups;
mod hulls;
mod link_tree;
mod load;
mod mesh_file;
mod message;
mod mjcf;
mod options;
mod packages;
mod pose_file;
mod qpos;
mod recorder;
mod robot;
mod sdformat;
mod srdf;
mod text;
mod trajectory;
mod turn;
mod urdf;
mod xml;
mod xml_text;
mod yaml;

pub use audit::{AuditCell, AuditVerdict, LinkAudit, audit, audit_cells, audit_pair};
pub use cell::{BodyName, CellFile, Obstacle};
pub use cell_body::AttachedBody;
pub use cover::{LinkCover, LinkCoverError, cover_links, json_of_balls, urdf_of_balls};
pub use error::{FileError, FileErrorKind, Skipped};
pub use files::{LoadedCell, OtherRobot, RobotFiles};
pub use find_excluded::{ExcludeReason, LinkPairCount, find_excluded};
pub use groups::{GroupState, JointGroup, VirtualJoint};
pub use hulls::{LinkHulls, hull_links, json_of_hulls, urdf_of_hulls};
pub use lin_canny;
pub use lin_canny_plan as plan;
pub use lin_canny_plan::{Coordinate, LinkBody, MotionKind, RobotJoint, RobotLink, RobotModel};
pub use lin_canny_record as record;
pub use options::{LoadOptions, MeshUse};
pub use packages::Packages;
pub use recorder::RobotRecorder;
pub use robot::Robot;
pub use srdf::{ExcludedPair, Srdf};
pub use trajectory::{Trajectory, csv_text};
pub use turn::{roll_pitch_yaw, to_roll_pitch_yaw};

/// Runs the README as a test.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeDoctests;
