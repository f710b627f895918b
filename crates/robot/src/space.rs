//! Setups: robots in a cell as one configuration space and one world.

use core::ops::ControlFlow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::{Geometry, GeometryKind};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, Drive, JointKind, JointTree, PairBoxes, PlanError, TimedPoses, TreeJoint,
};

use crate::cell::{BodyName, CellFile, Obstacle};
use crate::cell_body::AttachedBody;
use crate::error::Skipped;
use crate::geometry::radius;
use crate::robot::{Coordinate, MotionKind, Robot};
use crate::srdf::Srdf;
use crate::turn::from_z;

/// Robots at their poses and their obstacles, from which a [`Checker`] is made.
///
/// A configuration holds the coordinates of the robots, one robot after another. Names of links and
/// coordinates start with the prefix of the robot.
///
/// For many cells, make one setup of the robots and their pairs, and clone it for each cell before
/// its obstacles are added. The checkers then share the space of the robots, their shapes and the
/// hulls of their meshes.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny_robot::{Packages, Robot, Setup};
///
/// let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gripper.urdf");
/// let robot = Robot::load(urdf, &Packages::default())?;
/// let mut setup = Setup::new();
/// setup.robot("", &robot, Isometry3::identity());
/// setup.exclude_adjacent();
/// setup.exclude("left finger", "right finger");
/// let table = solids::cuboid(Vector3::new(0.5, 0.5, 0.02))?;
/// setup.obstacle("table", table, Isometry3::translation(0.8, 0.0, 0.3));
///
/// let mut checker = setup.checker()?;
/// let near = checker.clearance(&[0.0, 0.6, 1.0, 0.0, 0.5, 0.0, 0.02])?.expect("a pair");
/// assert!(near.distance > 0.0 && near.lower <= near.distance);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Setup {
    joints: Vec<TreeJoint>,
    coordinates: Vec<Coordinate>,
    /// For each link of the tree, the distance from its origin to the farthest point of its bodies.
    radii: Vec<f64>,
    /// For each link of the tree, its pose in the world if no joint moves it.
    at_rest: Vec<Option<Isometry3<f64>>>,
    bodies: Vec<SetupBody>,
    adjacent: Vec<[String; 2]>,
    /// Excluded pairs of names, with the reason.
    excluded: BTreeMap<[String; 2], String>,
    /// Pairs of bodies that files exclude.
    excluded_bodies: BTreeSet<CellPair>,
    /// Links without bodies, because an SRDF may name them, and skipped obstacles.
    frames: BTreeSet<String>,
    /// Names of links whose frame is not that of their first body, with a body or the link of the
    /// tree.
    link_frames: Vec<(String, LinkFrame)>,
    obstacles: Vec<(String, Geometry, Isometry3<f64>)>,
    /// The poses of obstacles that move, by their indices.
    motions: BTreeMap<usize, TimedPoses>,
    /// The obstacles that are half-spaces of links of robots.
    half_spaces: BTreeSet<usize>,
    /// The link and the object.
    attached: Vec<(String, AttachedBody)>,
    /// Excluded pairs of which at least one is a single body of several with its name.
    excluded_single: Vec<[BodyName; 2]>,
    margin: Option<f64>,
    paddings: Vec<(BodyName, f64)>,
    margins: Vec<([BodyName; 2], f64)>,
    skipped: Vec<Skipped>,
    /// What all checkers share: made by the first one, dropped when the robots or their pairs
    /// change.
    shared: Arc<OnceLock<RobotPart>>,
}

/// The robots of a setup without obstacles.
#[derive(Clone, Debug)]
struct RobotPart {
    space: JointTree,
    /// The bodies of the robots; pairs of their names are excluded.
    cell: Cell,
    /// The names of the bodies.
    names: BTreeSet<String>,
    /// Boxes in which pairs of bodies are apart.
    pair_boxes: OnceLock<PairBoxes>,
}

/// Where the frame of a link is.
#[derive(Clone, Copy, Debug)]
enum LinkFrame {
    Body(usize),
    Link(usize),
}

#[derive(Clone, Debug)]
pub(crate) struct SetupBody {
    /// The name of the link.
    pub(crate) name: String,
    /// The link of the tree.
    pub(crate) link: usize,
    pub(crate) geometry: Geometry,
}

impl Setup {
    /// Returns a setup without robots or obstacles.
    #[must_use]
    pub fn new() -> Self {
        Self {
            radii: vec![0.0],
            at_rest: vec![Some(Isometry3::identity())],
            ..Self::default()
        }
    }

    /// Adds a robot whose root link has this pose in the world.
    ///
    /// The prefix distinguishes robots; for a single robot it may be empty. Pairs that the file of
    /// the robot excludes are not checked: see [`Robot::excluded`].
    ///
    /// A half-space of a link that no joint moves, such as the floor of an MJCF file, becomes an
    /// obstacle with the name of the link. Its pairs with other links at rest are excluded.
    pub fn robot(&mut self, prefix: &str, robot: &Robot, pose: Isometry3<f64>) {
        self.shared = Arc::default();
        self.skipped.extend(robot.skipped.iter().cloned());
        let first = self.coordinates.len();
        let named = |name: &str| format!("{prefix}{name}");
        self.coordinates.extend(robot.coordinates.iter().map(|c| Coordinate {
            name: named(&c.name),
            ..c.clone()
        }));
        let mut links = vec![self.add(TreeJoint::fixed(0, pose))];
        for joint in &robot.joints {
            let drive = joint.drive.map(|drive| Drive {
                coordinate: drive.coordinate + first,
                ..drive
            });
            let mut link = links[joint.parent];
            for part in parts(joint.kind, &joint.axis, &joint.origin, drive) {
                link = self.add(TreeJoint { parent: link, ..part });
            }
            links.push(link);
        }
        let mut ids = Vec::new();
        for (link, &at) in robot.links.iter().zip(&links) {
            if link.bodies.is_empty() {
                self.frames.insert(named(&link.name));
            }
            let mut bodies = Vec::new();
            for body in &link.bodies {
                match self.at_rest[at].filter(|_| body.geometry.kind() == GeometryKind::HalfSpace) {
                    Some(pose) => {
                        ids.push(CellBody::Obstacle(self.obstacles.len()));
                        self.half_spaces.insert(self.obstacles.len());
                        self.obstacle(named(&link.name), body.geometry.clone(), pose * body.origin);
                    }
                    None => {
                        ids.push(CellBody::Robot(self.bodies.len() + bodies.len()));
                        bodies.push(body);
                    }
                }
            }
            let first = self.bodies.len();
            let at_origin = bodies.iter().position(|b| b.origin == Isometry3::identity());
            match at_origin {
                Some(0) => {}
                Some(k) => self.link_frames.push((named(&link.name), LinkFrame::Body(first + k))),
                None => self.link_frames.push((named(&link.name), LinkFrame::Link(at))),
            }
            for body in bodies {
                let is_at_origin = body.origin == Isometry3::identity();
                let link_of_body = if is_at_origin {
                    at
                } else {
                    self.add(TreeJoint::fixed(at, body.origin))
                };
                let reach = radius(&body.geometry);
                if reach > self.radii[link_of_body] {
                    self.radii[link_of_body] = reach;
                }
                self.bodies.push(SetupBody {
                    name: named(&link.name),
                    link: link_of_body,
                    geometry: body.geometry.clone(),
                });
            }
        }
        let excluded = robot.excluded.iter();
        self.excluded_bodies
            .extend(excluded.filter_map(|[a, b]| CellPair::new(ids[*a], ids[*b])));
        let pairs = robot.adjacent.iter();
        self.adjacent
            .extend(pairs.map(|pair| pair.map(|k| named(&robot.links[k].name))));
    }

    fn add(&mut self, joint: TreeJoint) -> usize {
        let parent = self.at_rest[joint.parent].filter(|_| joint.drive.is_none());
        self.at_rest.push(parent.map(|pose| pose * joint.origin));
        self.joints.push(joint);
        self.radii.push(0.0);
        self.joints.len()
    }

    /// Adds an obstacle at a pose in the world.
    pub fn obstacle(&mut self, name: impl Into<String>, geometry: impl Into<Geometry>, pose: Isometry3<f64>) {
        self.obstacles.push((name.into(), geometry.into(), pose));
    }

    /// Adds an obstacle that moves: see [`Cell::add_moving_obstacle`].
    pub fn moving_obstacle(&mut self, name: impl Into<String>, geometry: impl Into<Geometry>, poses: TimedPoses) {
        let first = poses.poses()[0];
        self.motions.insert(self.obstacles.len(), poses);
        self.obstacle(name, geometry, first);
    }

    /// Attaches an object to a link: see [`Cell::attach`].
    ///
    /// If the link or a touch link does not exist, [`checker`](Self::checker) returns an error.
    pub fn attach(&mut self, link: impl Into<String>, object: AttachedBody) {
        self.skipped.extend(object.skipped.iter().cloned());
        self.attached.push((link.into(), object));
    }

    /// Sets the padding of a link, an obstacle or an attached object, in the unit of the files: see
    /// [`Cell::pad`].
    ///
    /// If the name does not exist or the padding is negative, [`checker`](Self::checker) returns an
    /// error.
    pub fn pad(&mut self, name: impl Into<String>, padding: f64) {
        let (name, index) = (name.into(), None);
        self.paddings.push((BodyName { name, index }, padding));
    }

    /// Adds the obstacles and attached objects of a cell, excludes its pairs, and sets its margins.
    ///
    /// If the cell [excludes exactly](CellFile::excludes_exactly) its pairs, pairs that were excluded
    /// before this call are not excluded any more. An obstacle that equals a half-space of a robot
    /// of this setup is not added again.
    pub fn cell(&mut self, cell: &CellFile) {
        let added = cell.obstacles.iter().filter(|obstacle| !self.has_half_space(obstacle));
        for obstacle in added.collect::<Vec<_>>() {
            let (name, geometry) = (&obstacle.name, obstacle.geometry.clone());
            match &obstacle.poses {
                Some(poses) => self.moving_obstacle(name, geometry, poses.clone()),
                None => self.obstacle(name, geometry, obstacle.pose),
            }
        }
        for (link, object) in &cell.attached {
            self.attach(link, object.clone());
        }
        self.skipped.extend(cell.skipped.iter().cloned());
        // Another body of this name still has its pairs.
        let missing = cell.missing.iter().filter(|name| !self.has_body(name));
        self.frames.extend(missing.cloned().collect::<Vec<_>>());
        self.pairs_and_margins_of(cell);
    }

    /// Excludes the pairs of a cell and sets its margins.
    fn pairs_and_margins_of(&mut self, cell: &CellFile) {
        if cell.excludes_exactly {
            self.shared = Arc::default();
            self.excluded.clear();
            self.excluded_bodies.clear();
            self.excluded_single.clear();
        }
        for pair in &cell.excluded {
            match pair {
                [a, b] if a.index.is_none() && b.index.is_none() => self.exclude(&a.name, &b.name),
                single => self.excluded_single.push(single.clone()),
            }
        }
        self.margin = cell.margin.or(self.margin);
        self.paddings.extend(cell.paddings.iter().cloned());
        self.margins.extend(cell.margins.iter().cloned());
    }

    /// Excludes all pairs of adjacent links: see [`Robot::adjacent`].
    #[doc(alias = "ignore_adjacent")]
    pub fn exclude_adjacent(&mut self) {
        for [a, b] in self.adjacent.clone() {
            self.exclude_because(&a, &b, "Adjacent");
        }
    }

    /// Excludes the pairs of an SRDF, for the robot with this prefix.
    ///
    /// Pairs that the SRDF enables are not excluded any more: call
    /// [`exclude_adjacent`](Self::exclude_adjacent) before. Groups, states and virtual joints change
    /// nothing, so what is skipped in them is only in [`Srdf::skipped`].
    pub fn exclude_srdf(&mut self, prefix: &str, srdf: &Srdf) {
        for pair in &srdf.enabled {
            let [a, b] = pair.each_ref().map(|name| format!("{prefix}{name}"));
            self.include(&a, &b);
        }
        let is_of_pairs = |skipped: &&Skipped| {
            !["group", "virtual_joint"]
                .iter()
                .any(|kind| skipped.element.starts_with(kind))
        };
        self.skipped.extend(srdf.skipped.iter().filter(is_of_pairs).cloned());
        for pair in &srdf.excluded {
            let [a, b] = pair.links.each_ref().map(|name| format!("{prefix}{name}"));
            self.exclude_because(&a, &b, &pair.reason);
        }
    }

    /// Excludes all pairs of two links, or of a link and an obstacle.
    ///
    /// A link without bodies has no pairs, so the call changes nothing:
    /// [`exclusions_without_bodies`](Self::exclusions_without_bodies) lists such calls. If a name
    /// does not exist, [`checker`](Self::checker) returns an error.
    #[doc(alias = "allow")]
    #[doc(alias = "ignore_pair")]
    #[doc(alias = "allowed collision matrix")]
    pub fn exclude(&mut self, a: &str, b: &str) {
        self.exclude_because(a, b, "User");
    }

    fn exclude_because(&mut self, a: &str, b: &str, reason: &str) {
        self.shared = Arc::default();
        let is_known = self.excluded.contains_key(&[b.to_owned(), a.to_owned()]);
        let pair = if is_known { [b, a] } else { [a, b] };
        self.excluded.insert(pair.map(str::to_owned), reason.to_owned());
    }

    /// Includes all pairs of two links, or of a link and an obstacle, again. Pairs that the file of
    /// a robot excludes stay excluded.
    pub fn include(&mut self, a: &str, b: &str) {
        self.shared = Arc::default();
        self.excluded.remove(&[a.to_owned(), b.to_owned()]);
        self.excluded.remove(&[b.to_owned(), a.to_owned()]);
    }

    /// Returns the excluded pairs of names, each with its reason, such as `Adjacent` or `User`.
    #[doc(alias = "allowed collision matrix")]
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = ([&str; 2], &str)> {
        let each = self.excluded.iter();
        each.map(|(pair, reason)| (pair.each_ref().map(String::as_str), reason.as_str()))
    }

    /// Returns the excluded pairs that name a link without bodies, so that they exclude nothing.
    #[must_use]
    pub fn exclusions_without_bodies(&self) -> Vec<[&str; 2]> {
        let is_frame = |name: &&str| self.frames.contains(*name) && !self.has_body(name);
        let is_bare = |pair: &&[&str; 2]| pair.iter().any(is_frame);
        let pairs = self.excluded().map(|(pair, _)| pair);
        pairs.collect::<Vec<_>>().iter().filter(is_bare).copied().collect()
    }

    /// Returns what the files of the robots and cells name and this setup does not hold.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Returns the coordinates of a configuration.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Widens the limits of all coordinates by `slack` at both ends, in radians or lengths.
    ///
    /// Recorded values often exceed a limit by their rounding.
    pub fn widen_limits(&mut self, slack: f64) {
        self.shared = Arc::default();
        for coordinate in &mut self.coordinates {
            let [low, high] = coordinate.limits;
            coordinate.limits = [low - slack, high + slack];
        }
    }

    /// Returns whether a link with bodies, an attached object or an obstacle has this name.
    pub(crate) fn has_body(&self, name: &str) -> bool {
        let links = self.bodies.iter().map(|body| &body.name);
        let objects = self.attached.iter().map(|(_, object)| &object.name);
        let mut names = links.chain(objects).chain(self.obstacles.iter().map(|o| &o.0));
        names.any(|n| n == name)
    }

    /// Returns whether an obstacle is a half-space of a robot, which is already in the setup.
    pub(crate) fn has_half_space(&self, obstacle: &Obstacle) -> bool {
        let (Geometry::HalfSpace(space), None) = (&obstacle.geometry, &obstacle.poses) else {
            return false;
        };
        let mut own = self.half_spaces.iter().map(|&k| &self.obstacles[k]);
        own.any(|(name, geometry, pose)| match geometry {
            Geometry::HalfSpace(other) => {
                *name == obstacle.name
                    && *pose == obstacle.pose
                    && (other.normal(), other.offset()) == (space.normal(), space.offset())
            }
            _ => false,
        })
    }

    pub(crate) fn bodies(&self) -> &[SetupBody] {
        &self.bodies
    }

    pub(crate) fn adjacent(&self) -> &[[String; 2]] {
        &self.adjacent
    }

    /// Returns the configuration space of all robots, whose bodies are those of all links.
    ///
    /// Its [`sample`](lin_canny_plan::ConfigurationSpace::sample) returns a random configuration
    /// within the limits.
    ///
    /// # Errors
    /// Returns an error if a number of a robot is out of range.
    pub fn space(&self) -> Result<JointTree, PlanError> {
        self.space_of(self.bodies.iter().map(|b| b.link).collect())
    }

    fn space_of(&self, links: Vec<usize>) -> Result<JointTree, PlanError> {
        let limits = self.coordinates.iter().map(|c| c.limits).collect();
        JointTree::new(
            Isometry3::identity(),
            self.joints.clone(),
            limits,
            links,
            self.radii.clone(),
        )
    }

    /// Returns the checker of all robots among the obstacles.
    ///
    /// Objects can be [attached](Cell::attach) to every link by its name, also to links without
    /// bodies: in the space of the checker, bodies without geometry come last, one for the frame of
    /// each link that is not the frame of a body.
    ///
    /// # Errors
    /// Returns an error if a number of a robot or an obstacle is out of range, or if a name of an
    /// excluded pair, of a padding or of an attached object does not exist.
    pub fn checker(&self) -> Result<Checker<JointTree>, PlanError> {
        let shared = self.robot_part()?;
        let mut cell = shared.cell.clone();
        for (k, (name, geometry, pose)) in self.obstacles.iter().enumerate() {
            match self.motions.get(&k) {
                Some(poses) => cell.add_moving_obstacle(name, geometry.clone(), poses.clone())?,
                None => cell.add_obstacle(name, geometry.clone(), *pose)?,
            };
        }
        let is_at_rest = |pair: CellPair| match (pair.a, pair.b) {
            (CellBody::Robot(a), CellBody::Obstacle(b)) => {
                self.half_spaces.contains(&b) && self.at_rest[self.bodies[a].link].is_some()
            }
            _ => false,
        };
        if !(self.excluded_bodies.is_empty() && self.half_spaces.is_empty()) {
            cell.exclude_if(|pair| self.excluded_bodies.contains(&pair) || is_at_rest(pair));
        }
        for (link, object) in &self.attached {
            let touch: Vec<&str> = object.touch_links.iter().map(String::as_str).collect();
            cell.attach(link, &object.name, object.geometry.clone(), object.pose, &touch)?;
        }
        cell.set_margin(self.margin.unwrap_or(cell.margin()))?;
        let has_names = !(self.paddings.is_empty() && self.margins.is_empty() && self.excluded_single.is_empty());
        let named = NamedBodies::new(has_names.then_some(&cell));
        for (name, padding) in &self.paddings {
            for id in named.select(&cell, name)? {
                cell.pad(id, *padding)?;
            }
        }
        for ([a, b], margin) in &self.margins {
            for (a, b) in named.pairs(&cell, a, b)? {
                cell.set_pair_margin(a, b, Some(*margin))?;
            }
        }
        let is_frame = |name: &String| self.frames.contains(name) && !self.has_body(name);
        let is_of_robots = |pair: &[String; 2]| pair.iter().all(|name| shared.names.contains(name));
        let others = self.obstacles.iter().map(|o| &o.0);
        let others: BTreeSet<&String> = others.chain(self.attached.iter().map(|(_, o)| &o.name)).collect();
        let is_shared = |pair: &[String; 2]| is_of_robots(pair) && !pair.iter().any(|name| others.contains(name));
        let excluded = self.excluded.keys().filter(|pair| !is_shared(pair));
        for [a, b] in excluded.filter(|pair| !pair.iter().any(is_frame)) {
            cell.exclude(a, b)?;
        }
        for [a, b] in &self.excluded_single {
            for (a, b) in named.pairs(&cell, a, b)? {
                cell.exclude(a, b)?;
            }
        }
        let mut checker = Checker::new(shared.space.clone(), cell)?;
        if let Some(boxes) = shared.pair_boxes.get() {
            checker.set_pair_boxes(boxes)?;
        }
        Ok(checker)
    }

    /// Searches for boxes of joint values in which pairs of links are proven apart, for all checkers
    /// from now on: see [`PairBoxes::search`]. Copies of this setup that are made afterwards have
    /// them too, until something about the robots changes.
    ///
    /// `boxes` is the largest number of boxes of a pair. A second call changes nothing.
    ///
    /// # Errors
    /// Returns an error as [`checker`](Self::checker) and [`PairBoxes::search`] do.
    pub fn prepare_pairs(&self, boxes: u64) -> Result<&PairBoxes, PlanError> {
        let cell = self.checker()?.cell().without_obstacles();
        let shared = self.robot_part()?;
        if let Some(known) = shared.pair_boxes.get() {
            return Ok(known);
        }
        let found = PairBoxes::search(&mut Checker::new(shared.space.clone(), cell)?, boxes, &mut |_| {
            ControlFlow::Continue(())
        })?;
        Ok(shared.pair_boxes.get_or_init(|| found))
    }

    /// Returns what all checkers share, made now if this is the first one.
    fn robot_part(&self) -> Result<&RobotPart, PlanError> {
        if let Some(known) = self.shared.get() {
            return Ok(known);
        }
        let mut cell = Cell::new();
        for body in &self.bodies {
            cell.robot_body(&body.name, body.geometry.clone());
        }
        for (name, frame) in &self.link_frames {
            match *frame {
                LinkFrame::Body(body) => cell.body_frame(name, body),
                LinkFrame::Link(_) => cell.bare_frame(name),
            }
        }
        let names: BTreeSet<String> = self.bodies.iter().map(|body| body.name.clone()).collect();
        let is_of_bodies = |pair: &&[String; 2]| pair.iter().all(|name| names.contains(name));
        for [a, b] in self.excluded.keys().filter(is_of_bodies) {
            cell.exclude(a, b)?;
        }
        let bare = self.link_frames.iter().filter_map(|(_, frame)| match frame {
            LinkFrame::Link(link) => Some(*link),
            LinkFrame::Body(_) => None,
        });
        let links = self.bodies.iter().map(|b| b.link).chain(bare).collect();
        let space = self.space_of(links)?;
        let pair_boxes = OnceLock::new();
        Ok(self.shared.get_or_init(|| RobotPart {
            space,
            cell,
            names,
            pair_boxes,
        }))
    }
}

impl Srdf {
    /// Returns the SRDF of the excluded pairs of links of a robot: of one whose names have this prefix
    /// in the setup. The pairs of links and obstacles are left out.
    #[must_use]
    pub fn from_setup(setup: &Setup, prefix: &str, robot: &Robot) -> Self {
        Self::from_pairs(setup.excluded(), prefix, robot)
    }
}

/// The bodies of a world by their names: a saved world may have a pair of names for each two bodies.
struct NamedBodies(BTreeMap<String, Vec<CellBody>>);

impl NamedBodies {
    /// Returns the bodies of a world, or none.
    fn new(cell: Option<&Cell>) -> Self {
        let mut named: BTreeMap<String, Vec<CellBody>> = BTreeMap::new();
        for (id, name) in cell.into_iter().flat_map(Cell::bodies) {
            named.entry(name.to_owned()).or_default().push(id);
        }
        Self(named)
    }

    /// Returns the bodies that a name of a cell stands for.
    fn select(&self, cell: &Cell, body: &BodyName) -> Result<Vec<CellBody>, PlanError> {
        let Some(found) = self.0.get(&body.name) else {
            // The error says why.
            return cell.select(&body.name);
        };
        match body.index {
            None => Ok(found.clone()),
            Some(index) => match found.get(index) {
                Some(id) => Ok(vec![*id]),
                None => Err(PlanError::Unnamed {
                    name: body.to_string(),
                    near: Some(body.name.as_str().into()),
                }),
            },
        }
    }

    /// Returns all pairs of a body of `a` and a body of `b`.
    fn pairs(&self, cell: &Cell, a: &BodyName, b: &BodyName) -> Result<Vec<(CellBody, CellBody)>, PlanError> {
        let (first, second) = (self.select(cell, a)?, self.select(cell, b)?);
        let each = first.iter().flat_map(|a| second.iter().map(move |b| (*a, *b)));
        Ok(each.collect())
    }
}

/// Returns the consecutive revolute and prismatic joints of a joint; the caller sets their parents.
fn parts(kind: MotionKind, axis: &Unit<Vector3<f64>>, origin: &Isometry3<f64>, drive: Option<Drive>) -> Vec<TreeJoint> {
    let joint = |kind: JointKind, axis: Unit<Vector3<f64>>, drive: Option<Drive>| TreeJoint {
        parent: 0,
        kind,
        origin: Isometry3::identity(),
        axis,
        drive,
    };
    let after = |k: usize| drive.map(|d| Drive::by(d.coordinate + k));
    let slide = |axis, k| joint(JointKind::Prismatic, axis, after(k));
    let turn = |axis, k| joint(JointKind::Revolute, axis, after(k));
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let mut parts = match kind {
        MotionKind::Fixed => vec![TreeJoint::fixed(0, Isometry3::identity())],
        MotionKind::Revolute => vec![joint(JointKind::Revolute, *axis, drive)],
        MotionKind::Prismatic => vec![joint(JointKind::Prismatic, *axis, drive)],
        MotionKind::Planar => {
            let frame = from_z(axis);
            vec![slide(frame * x, 0), slide(frame * y, 1), turn(*axis, 2)]
        }
        // The rotation is the product of yaw, pitch and roll.
        MotionKind::Floating => vec![
            slide(x, 0),
            slide(y, 1),
            slide(z, 2),
            turn(z, 5),
            turn(y, 4),
            turn(x, 3),
        ],
    };
    parts[0].origin = *origin;
    parts
}
