//! The cell: robot bodies, attached objects, obstacles, and what each pair must keep.

pub(crate) mod attached_object;
mod excluded_pairs;
pub(crate) mod margins_and_paddings;
pub(crate) mod mesh_hull;
pub(crate) mod range_body;
pub(crate) mod robot_model;
mod robots;

use core::fmt;
use std::collections::{BTreeMap, BTreeSet};
use std::string::{String, ToString};
use std::sync::Arc;
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::cell::attached_object::{AttachedObject, Frame};
use crate::cell::mesh_hull::MeshHull;
use crate::cell::robot_model::Robots;
use crate::error::PlanError;
use crate::motion::timed_poses::TimedPoses;
use crate::names::nearest_name;
use crate::names::{CellBody, CellPair, Select};
use lin_canny::broad::Aabb;
use lin_canny::motion::{Steady, Velocity};
use lin_canny::polyhedron::BoxHint;
use lin_canny::{EXTENT_MAX, Geometry, GeometryKind, RelativePose, normalize_rotation};

/// The bodies of a robot, objects attached to it, and obstacles, of any kind of geometry.
///
/// Robot bodies must be added in the order of the bodies of the configuration space. The geometry
/// of a rigid robot is in the frame of the robot, the geometry of an arm in the frame of its link.
///
/// A cell changes at any time, that of a checker by
/// [`Checker::cell_mut`](crate::Checker::cell_mut). Ids of attached objects and obstacles are never
/// used again, so an id names the same body for ever, or is an error:
/// `Checker::new(space, checker.cell().clone())` has the same ids.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredCell", into = "StoredCell"))]
pub struct Cell {
    /// Shared by all copies of the cell, as the geometries are.
    pub(crate) robot: Arc<Vec<(String, Geometry)>>,
    /// Names of frames. A body of the space has each of them.
    pub(crate) frames: Arc<Vec<(String, Frame)>>,
    /// `None` for an object that was detached.
    pub(crate) attached: Vec<Option<AttachedObject>>,
    /// `None` for an obstacle that was removed.
    pub(crate) obstacles: Vec<Option<(String, Geometry, Isometry3<f64>)>>,
    /// The poses of the obstacles that move; their poses in `obstacles` are the first.
    pub(crate) motions: BTreeMap<CellBody, TimedPoses>,
    /// The hulls of the bodies that are meshes.
    pub(crate) hulls: BTreeMap<CellBody, MeshHull>,
    /// The excluded pairs, each with its reason.
    pub(crate) excluded: BTreeMap<CellPair, Arc<str>>,
    pub(crate) margin: f64,
    pub(crate) paddings: BTreeMap<CellBody, f64>,
    pub(crate) margins: BTreeMap<CellPair, f64>,
    /// The links and joints of robots from files.
    pub(crate) robots: Arc<Robots>,
    /// The names of bodies and frames.
    pub(crate) names: BTreeSet<String>,
    pub(crate) changes: Changes,
}

/// What changed in the world of a checker since the checker took it.
#[derive(Default)]
pub(crate) struct Changes {
    /// The number of the checker; 0 for a cell of no checker, which notes nothing.
    pub(crate) owner: u64,
    /// Whether robot bodies or frames changed.
    pub(crate) robot: bool,
    /// Obstacles and attached objects that are new, elsewhere, of other shape, or gone.
    pub(crate) bodies: Vec<CellBody>,
    /// Bodies all of whose pairs may have changed, and single pairs.
    pub(crate) pairs_of: Vec<CellBody>,
    pub(crate) pairs: Vec<CellPair>,
    /// Whether the margin of all pairs changed.
    pub(crate) margin: bool,
}

/// Two cells that are equal print the same.
impl fmt::Debug for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("_")
    }
}

/// A copy belongs to no checker.
impl Clone for Changes {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Changes {
    /// Notes a change, in the world of a checker.
    pub(crate) fn note(&mut self, change: impl FnOnce(&mut Self)) {
        if self.owner != 0 {
            change(self);
        }
    }
}

/// Bodies.
impl Cell {
    /// Returns a cell without bodies.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a robot body.
    pub fn robot_body(&mut self, name: impl ToString, shape: impl Into<Geometry>) -> CellBody {
        let name = name.to_string();
        self.names.insert(name.clone());
        Arc::make_mut(&mut self.robot).push((name, shape.into()));
        self.changes.robot = true;
        let id = CellBody::Robot(self.robot.len() - 1);
        self.note_hull(id);
        id
    }

    /// Names the frame of a body of the space that has no geometry, such as the tool flange.
    ///
    /// Objects can be attached there. In the space, bodies without geometry come after all robot
    /// bodies, in the order of these calls.
    pub fn bare_frame(&mut self, name: impl ToString) {
        let (name, bare) = (name.to_string(), self.bare_frames());
        self.names.insert(name.clone());
        Arc::make_mut(&mut self.frames).push((name, Frame::Bare(bare)));
        self.changes.robot = true;
    }

    /// Names the frame of a robot body, if it differs from the body's name.
    ///
    /// Without this call, a name stands for the frame of the first robot body that has it.
    pub fn body_frame(&mut self, name: impl ToString, body: usize) {
        let name = name.to_string();
        self.names.insert(name.clone());
        Arc::make_mut(&mut self.frames).push((name, Frame::Robot(body)));
        self.changes.robot = true;
    }

    /// Returns this cell without its obstacles.
    ///
    /// The robot, its attached objects, and what their pairs must keep are the same. Half-spaces of
    /// links of [robots](Self::add_robot) stay.
    ///
    /// The result shares all shapes with this cell, so that checkers of many cells need the robot
    /// only once.
    ///
    /// ```
    /// use lin_canny::Shape;
    /// use lin_canny::nalgebra::Isometry3;
    /// use lin_canny_plan::{Checker, TranslationSpace, Cell};
    ///
    /// let mut cell = Cell::new();
    /// cell.robot_body("drone", Shape::ball(0.1)?);
    /// cell.add_obstacle("mast", Shape::ball(0.1)?, Isometry3::identity())?;
    /// let space = TranslationSpace::new([[-4.0, 4.0]; 3], Default::default(), 1)?;
    /// let mut first = Checker::new(space.clone(), cell)?;
    /// assert!(!first.is_free_at(&[0.0; 3])?);
    ///
    /// let mut cell = first.cell().without_obstacles();
    /// cell.add_obstacle("wall", Shape::ball(0.5)?, Isometry3::translation(2.0, 0.0, 0.0))?;
    /// let mut second = Checker::new(space, cell)?;
    /// assert!(second.is_free_at(&[0.0; 3])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn without_obstacles(&self) -> Self {
        let is_kept = |id: &CellBody| !matches!(id, CellBody::Obstacle(_)) || self.is_of_robot(*id);
        let all = self.obstacles.iter().enumerate();
        let mut obstacles: Vec<_> = all
            .map(|(k, o)| o.clone().filter(|_| is_kept(&CellBody::Obstacle(k))))
            .collect();
        let last = obstacles.iter().rposition(Option::is_some);
        obstacles.truncate(last.map_or(0, |k| k + 1));
        let gone = self.bodies().filter(|(id, _)| !is_kept(id)).map(|(_, name)| name);
        let gone: BTreeSet<&str> = gone.collect();
        Self {
            robot: self.robot.clone(),
            frames: self.frames.clone(),
            attached: self.attached.clone(),
            obstacles,
            motions: BTreeMap::new(),
            hulls: entries(&self.hulls, is_kept),
            excluded: entries(&self.excluded, |pair: &CellPair| is_kept(&pair.b)),
            margin: self.margin,
            paddings: entries(&self.paddings, is_kept),
            margins: entries(&self.margins, |pair: &CellPair| is_kept(&pair.b)),
            robots: self.robots.clone(),
            names: self
                .names
                .iter()
                .filter(|name| !gone.contains(name.as_str()))
                .cloned()
                .collect(),
            changes: Changes::default(),
        }
    }

    /// Returns the number of bodies of the space without geometry.
    pub(crate) fn bare_frames(&self) -> usize {
        let bare = self.frames.iter().filter(|(_, frame)| matches!(frame, Frame::Bare(_)));
        bare.count()
    }

    /// Adds an obstacle at a pose in the world, and returns its id.
    ///
    /// # Errors
    /// Returns an error if the pose is invalid or out of range, if the box of the obstacle is not
    /// finite, or if another body or link has the name. Then nothing changes.
    pub fn add_obstacle(
        &mut self,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
    ) -> Result<CellBody, PlanError> {
        let (name, geometry) = (name.to_string(), geometry.into());
        resting(&geometry, &pose)?;
        self.check_name("obstacle", &name)?;
        Ok(self.push_obstacle(name, geometry, pose))
    }

    /// Adds an obstacle that was checked.
    fn push_obstacle(&mut self, name: String, geometry: Geometry, pose: Isometry3<f64>) -> CellBody {
        self.names.insert(name.clone());
        self.obstacles.push(Some((name, geometry, pose)));
        let id = CellBody::Obstacle(self.obstacles.len() - 1);
        self.note_hull(id);
        self.note_body(id);
        id
    }

    /// Returns an error if a body or a frame has the name.
    fn check_name(&self, kind: &'static str, name: &str) -> Result<(), PlanError> {
        match self.names.contains(name) {
            true => Err(PlanError::NameTaken {
                kind,
                name: name.to_string(),
            }),
            false => Ok(()),
        }
    }

    /// Returns the name, or else with a number that makes it one that no body and no link has: `post`,
    /// `post#2`, `post#3`.
    #[must_use]
    pub fn free_name(&self, name: &str) -> String {
        if !self.names.contains(name) {
            return name.to_string();
        }
        let numbered = |k: usize| std::format!("{name}#{k}");
        let is_taken = |k: usize| self.names.contains(&numbered(k));
        // `low` is taken. A search by halves, because many bodies may have one name.
        let (mut low, mut high) = (1, 2);
        while is_taken(high) {
            (low, high) = (high, 2 * high);
        }
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if is_taken(middle) { low = middle } else { high = middle }
        }
        numbered(high)
    }

    /// Adds an obstacle that moves, and returns its id. The obstacle has these poses in the world at times on a clock.
    ///
    /// A motion among moving obstacles has times ([`JointMotion::with_times`](crate::JointMotion::with_times)),
    /// and configurations are queried at the time of [`Checker::set_time`](crate::Checker::set_time). All
    /// other motions and configurations are errors ([`PlanError::NoTime`]), as are times at which the
    /// obstacle has no pose ([`PlanError::PoseTime`]).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, UnitQuaternion};
    /// use lin_canny::Shape;
    /// use lin_canny_plan::{Checker, JointCurve, JointMotion, TimedPoses, TranslationSpace, Cell};
    ///
    /// // A drone flies 4 m along x in the seconds 0 to 2. A train crosses its path.
    /// let at = |y: f64| Isometry3::translation(2.0, y, 0.0);
    /// let crossing = TimedPoses::new(&[0.0, 4.0], &[at(-4.0), at(4.0)])?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("drone", Shape::ball(0.2)?);
    /// cell.add_moving_obstacle("train", Shape::ball(0.5)?, crossing)?;
    /// let space = TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1)?;
    /// let mut checker = Checker::new(space, cell)?;
    ///
    /// let flight = JointCurve::bezier(&[[0.0; 3], [4.0, 0.0, 0.0]])?;
    /// let verdict = checker.certify(&JointMotion::curve(&flight.clone().with_times([0.0, 2.0])?))?;
    /// assert!(verdict.is_free(), "it is past before the train arrives");
    /// let verdict = checker.certify(&JointMotion::curve(&flight.clone().with_times([1.0, 3.0])?))?;
    /// assert!(checker.show(&verdict).to_string().starts_with("blocked by drone and train"));
    /// assert!(checker.certify(&JointMotion::curve(&flight)).is_err(), "the curve has no times");
    ///
    /// checker.set_time(2.0)?;
    /// assert_eq!(checker.clearance(&[0.0; 3])?.unwrap().distance, 1.3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the box of the obstacle is not finite, or if another body or link has the
    /// name. Then nothing changes.
    pub fn add_moving_obstacle(
        &mut self,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        poses: TimedPoses,
    ) -> Result<CellBody, PlanError> {
        let geometry = geometry.into();
        swept(&geometry, &poses)?;
        let id = self.add_obstacle(name, geometry, poses.poses()[0])?;
        self.motions.insert(id, poses);
        Ok(id)
    }

    /// Notes that a body is new.
    fn note_body(&mut self, id: CellBody) {
        self.changes.note(|changes| {
            changes.bodies.push(id);
            changes.pairs_of.push(id);
        });
    }

    /// Returns the poses of an obstacle that moves; `None` for any other body.
    #[must_use]
    pub fn obstacle_motion(&self, id: CellBody) -> Option<&TimedPoses> {
        self.motions.get(&id)
    }

    /// Returns the error of a query without a time, if an obstacle moves.
    pub(crate) fn check_at_rest(&self) -> Result<(), PlanError> {
        match self.motions.keys().next() {
            Some(id) => Err(PlanError::NoTime(self.name(*id).to_string())),
            None => Ok(()),
        }
    }

    /// Moves obstacles to a pose in the world, and returns them. An obstacle that moved is at rest
    /// from then on.
    ///
    /// # Errors
    /// Returns an error if the pose is invalid or out of range, if the box of an obstacle is not
    /// finite, or if a body does not exist or is not an obstacle. Then nothing changes.
    pub fn move_obstacle<'a>(
        &mut self,
        bodies: impl Into<Select<'a>>,
        pose: Isometry3<f64>,
    ) -> Result<Vec<CellBody>, PlanError> {
        RelativePose::from_isometry(&pose)?;
        let found = self.select_obstacles(bodies.into())?;
        for geometry in found.iter().filter_map(|id| self.geometry(*id)) {
            resting(geometry, &pose)?;
        }
        for id in &found {
            if let Some(obstacle) = self.obstacle_mut(*id) {
                obstacle.2 = pose;
            }
            self.motions.remove(id);
        }
        self.changes.note(|changes| changes.bodies.extend(&found));
        Ok(found)
    }

    /// Replaces the geometry of obstacles, and returns them. Poses, names and ids stay.
    ///
    /// # Errors
    /// Returns an error if a body does not exist or is not an obstacle, or if the box of an obstacle
    /// is not finite. Then nothing changes.
    pub fn replace_obstacle<'a>(
        &mut self,
        bodies: impl Into<Select<'a>>,
        geometry: impl Into<Geometry>,
    ) -> Result<Vec<CellBody>, PlanError> {
        let found = self.select_obstacles(bodies.into())?;
        let geometry = geometry.into();
        for id in &found {
            if let Some(pose) = self.obstacle_pose(*id) {
                resting(&geometry, pose)?;
            }
            if let Some(poses) = self.obstacle_motion(*id) {
                swept(&geometry, poses)?;
            }
        }
        for id in &found {
            if let Some(obstacle) = self.obstacle_mut(*id) {
                obstacle.1 = geometry.clone();
            }
            self.note_hull(*id);
        }
        self.changes.note(|changes| changes.bodies.extend(&found));
        Ok(found)
    }

    /// Removes obstacles with their exclusions, padding and margins, and returns their ids, which
    /// are never used again.
    ///
    /// # Errors
    /// Returns an error if a body does not exist or is not an obstacle. Then nothing changes.
    pub fn remove_obstacle<'a>(&mut self, bodies: impl Into<Select<'a>>) -> Result<Vec<CellBody>, PlanError> {
        let found = self.select_obstacles(bodies.into())?;
        for id in &found {
            if let CellBody::Obstacle(k) = *id {
                let name = self.obstacles[k].take().map(|o| o.0).unwrap_or_default();
                self.free(*id, &name);
                self.remove_settings_of(*id);
                self.note_body(*id);
            }
        }
        Ok(found)
    }

    /// Attaches an object to a link, and returns its id.
    ///
    /// The object moves with the link in every query. Its pairs with bodies that keep their pose
    /// relative to the link are never measured, nor are its pairs with the touch links, such as the
    /// fingers that hold it: they are [excluded](Self::exclude). The link is the frame of that name
    /// ([`bare_frame`](Self::bare_frame)), or else that of the first robot body of that name.
    ///
    /// # Errors
    /// Returns an error if the pose is invalid or out of range, if a link does not exist, or if another
    /// body or link has the name. Then nothing changes.
    pub fn attach(
        &mut self,
        link: &str,
        name: impl ToString,
        geometry: impl Into<Geometry>,
        pose: Isometry3<f64>,
        touch_links: &[&str],
    ) -> Result<CellBody, PlanError> {
        RelativePose::from_isometry(&pose)?;
        let geometry = geometry.into();
        if geometry.kind() == GeometryKind::HalfSpace {
            return Err(PlanError::Unbounded(name.to_string()));
        }
        let frame = self.frame(link)?;
        self.check_name("object", &name.to_string())?;
        let mut touched = Vec::new();
        for name in touch_links {
            match self.select(*name) {
                Ok(found) => touched.extend(found),
                // A link without bodies has no pairs.
                Err(PlanError::WithoutBodies(_)) => {}
                Err(error) => return Err(error),
            }
        }
        let id = CellBody::Attached(self.attached.len());
        self.names.insert(name.to_string());
        self.attached.push(Some(AttachedObject {
            name: name.to_string(),
            geometry,
            link: link.to_string(),
            pose: normalized_once(&pose),
            frame,
        }));
        self.note_hull(id);
        self.note_body(id);
        let touched = touched.into_iter().filter_map(|body| CellPair::new(id, body));
        self.excluded.extend(touched.map(|pair| (pair, "Touch".into())));
        Ok(id)
    }

    /// Removes attached objects with their exclusions, padding and margins, and returns their ids,
    /// which are never used again.
    ///
    /// # Errors
    /// Returns an error if a body does not exist or is not attached. Then nothing changes.
    pub fn detach<'a>(&mut self, bodies: impl Into<Select<'a>>) -> Result<Vec<CellBody>, PlanError> {
        let bodies = bodies.into();
        let found = self.select_kind(bodies, |id| matches!(id, CellBody::Attached(_)), "an attached object")?;
        for id in &found {
            if let CellBody::Attached(k) = *id {
                let name = self.attached[k].take().map(|o| o.name).unwrap_or_default();
                self.free(*id, &name);
                self.remove_settings_of(*id);
                self.note_body(*id);
            }
        }
        Ok(found)
    }

    /// Returns the index of the body of the space whose frame has this name.
    pub(crate) fn frame(&self, link: &str) -> Result<Frame, PlanError> {
        if let Some((_, frame)) = self.frames.iter().find(|(name, _)| name == link) {
            return Ok(*frame);
        }
        let body = self.robot.iter().position(|(name, _)| name == link);
        body.map(Frame::Robot).ok_or_else(|| {
            let names = self.frames.iter().map(|f| &f.0).chain(self.robot.iter().map(|b| &b.0));
            PlanError::Unnamed {
                name: link.to_string(),
                near: nearest_name(link, names.map(String::as_str)),
            }
        })
    }

    /// Returns the index of the body of the space that has a frame.
    pub(crate) fn body_of(&self, frame: Frame) -> usize {
        match frame {
            Frame::Robot(body) => body,
            Frame::Bare(k) => self.robot.len() + k,
        }
    }

    fn obstacle_mut(&mut self, id: CellBody) -> Option<&mut (String, Geometry, Isometry3<f64>)> {
        match id {
            CellBody::Obstacle(k) => self.obstacles.get_mut(k)?.as_mut(),
            _ => None,
        }
    }

    /// Frees the name of a removed body, if it is not that of a link.
    fn free(&mut self, id: CellBody, name: &str) {
        if !self.is_of_robot(id) {
            self.names.remove(name);
        }
    }

    /// Removes what is known about the pairs of a body.
    fn remove_settings_of(&mut self, id: CellBody) {
        self.paddings.remove(&id);
        self.motions.remove(&id);
        self.hulls.remove(&id);
        let robot = (0..self.robot.len()).map(CellBody::Robot);
        let attached = (0..self.attached.len()).map(CellBody::Attached);
        let mut partners: Vec<CellBody> = robot.chain(attached).collect();
        if matches!(id, CellBody::Attached(_)) {
            partners.extend((0..self.obstacles.len()).map(CellBody::Obstacle));
        }
        for pair in partners.into_iter().filter_map(|other| CellPair::new(id, other)) {
            self.excluded.remove(&pair);
            self.margins.remove(&pair);
        }
    }

    /// Returns the bodies that a selection stands for.
    ///
    /// # Errors
    /// Returns an error if a name does not exist, which states the nearest name; if a name is that
    /// of a link without bodies; or if the body of an id does not exist or was removed.
    pub fn select<'a>(&self, bodies: impl Into<Select<'a>>) -> Result<Vec<CellBody>, PlanError> {
        match bodies.into() {
            Select::Id(id) if self.contains(id) => Ok([id].into()),
            Select::Id(id) => Err(match id {
                CellBody::Attached(k) if k < self.attached.len() => PlanError::Removed(id),
                CellBody::Obstacle(k) if k < self.obstacles.len() => PlanError::Removed(id),
                _ => PlanError::NoBody(id),
            }),
            Select::Name(name) => {
                let found: Vec<CellBody> = self.bodies().filter(|b| b.1 == name).map(|b| b.0).collect();
                if !found.is_empty() {
                    return Ok(found);
                }
                if self.frames.iter().any(|frame| frame.0 == name) {
                    return Err(PlanError::WithoutBodies(name.to_string()));
                }
                let frames = self.frames.iter().map(|frame| frame.0.as_str());
                Err(PlanError::Unnamed {
                    name: name.to_string(),
                    near: nearest_name(name, self.bodies().map(|b| b.1).chain(frames)),
                })
            }
            Select::Names(names) => {
                let mut all = BTreeSet::new();
                for name in names {
                    match self.select(name) {
                        Ok(found) => all.extend(found),
                        Err(PlanError::WithoutBodies(_)) => {}
                        Err(error) => return Err(error),
                    }
                }
                Ok(all.into_iter().collect())
            }
        }
    }

    /// Returns all pairs of a body of `a` and a body of `b`, in ascending order; an error if both are the
    /// same body or link.
    pub(crate) fn pairs_of(&self, a: Select<'_>, b: Select<'_>) -> Result<Vec<CellPair>, PlanError> {
        let (first, second) = (self.select(a)?, self.select(b)?);
        // The bodies of a name are those of one link, except for bodies without a robot.
        let is_link = matches!(a, Select::Name(_)) && !self.robots.of_bodies.is_empty();
        let is_same = first == second && (first.len() == 1 || is_link);
        if let Some(id) = first.first().filter(|_| is_same) {
            return Err(PlanError::Itself(self.show(id).to_string()));
        }
        let pairs = first.iter().flat_map(|x| second.iter().map(move |y| (*x, *y)));
        let pairs: BTreeSet<_> = pairs.filter_map(|(x, y)| CellPair::new(x, y)).collect();
        Ok(pairs.into_iter().collect())
    }

    fn select_obstacles(&self, bodies: Select<'_>) -> Result<Vec<CellBody>, PlanError> {
        self.select_kind(bodies, |id| matches!(id, CellBody::Obstacle(_)), "an obstacle")
    }

    /// Returns the bodies of one kind that a selection stands for; at least one.
    fn select_kind(
        &self,
        bodies: Select<'_>,
        is_kind: fn(&CellBody) -> bool,
        kind: &'static str,
    ) -> Result<Vec<CellBody>, PlanError> {
        let mut found = self.select(bodies)?;
        let first = found.first().copied();
        found.retain(is_kind);
        match (found.is_empty(), first) {
            (true, Some(id)) => Err(PlanError::Kind {
                body: self.show(&id).to_string(),
                kind,
            }),
            _ => Ok(found),
        }
    }

    /// Returns whether a body exists and was not removed.
    #[must_use]
    pub fn contains(&self, id: CellBody) -> bool {
        self.geometry(id).is_some()
    }

    /// Returns the name of a body; empty if the body does not exist.
    #[must_use]
    pub fn name(&self, part: CellBody) -> &str {
        match part {
            CellBody::Robot(k) => self.robot.get(k).map(|b| &b.0),
            CellBody::Attached(k) => self.attached.get(k).and_then(Option::as_ref).map(|o| &o.name),
            CellBody::Obstacle(k) => self.obstacles.get(k).and_then(Option::as_ref).map(|o| &o.0),
        }
        .map_or("", String::as_str)
    }

    /// Returns the geometry of a body; `None` if the body does not exist.
    #[must_use]
    pub fn geometry(&self, part: CellBody) -> Option<&Geometry> {
        match part {
            CellBody::Robot(k) => self.robot.get(k).map(|b| &b.1),
            CellBody::Attached(k) => self.attached.get(k)?.as_ref().map(|o| &o.geometry),
            CellBody::Obstacle(k) => self.obstacles.get(k)?.as_ref().map(|o| &o.1),
        }
    }

    /// Returns the pose of an obstacle in the world, the first if it moves; `None` if it does not
    /// exist.
    #[must_use]
    pub fn obstacle_pose(&self, id: CellBody) -> Option<&Isometry3<f64>> {
        match id {
            CellBody::Obstacle(k) => self.obstacles.get(k)?.as_ref().map(|o| &o.2),
            _ => None,
        }
    }

    /// Returns id and name of all bodies: of the robot, then attached, then obstacles.
    pub fn bodies(&self) -> impl Iterator<Item = (CellBody, &str)> {
        let robot = self.robot.iter().enumerate();
        let robot = robot.map(|(k, b)| (CellBody::Robot(k), b.0.as_str()));
        let obstacles = self.obstacles.iter().enumerate();
        let obstacles = obstacles.filter_map(|(k, o)| Some((CellBody::Obstacle(k), o.as_ref()?.0.as_str())));
        robot
            .chain(self.attached().map(|(id, object)| (id, object.name.as_str())))
            .chain(obstacles)
    }

    /// Returns name and geometry of the robot bodies, in the order of the configuration space.
    pub fn robot_bodies(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry)> {
        self.robot.iter().map(|(name, shape)| (name.as_str(), shape))
    }

    /// Returns the attached objects with their ids.
    pub fn attached(&self) -> impl Iterator<Item = (CellBody, &AttachedObject)> {
        let attached = self.attached.iter().enumerate();
        attached.filter_map(|(k, object)| Some((CellBody::Attached(k), object.as_ref()?)))
    }

    /// Returns name, geometry and pose of the obstacles, without those that were removed. An
    /// obstacle that moves has its first pose: see [`obstacle_motion`](Self::obstacle_motion).
    ///
    /// If none was removed, the k-th obstacle has the id `CellBody::Obstacle(k)`.
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = (&str, &Geometry, &Isometry3<f64>)> {
        let all: Vec<_> = self.obstacles.iter().flatten().collect();
        all.into_iter().map(|(name, shape, pose)| (name.as_str(), shape, pose))
    }

    /// Returns what prints a body, a pair, a [`NearPair`](crate::NearPair) or a
    /// [`Verdict`](crate::Verdict) with the names of the bodies.
    ///
    /// ```
    /// # use lin_canny_plan::{Cell, CellPair};
    /// # use lin_canny::{Shape, nalgebra::Isometry3};
    /// let mut cell = Cell::new();
    /// let hand = cell.robot_body("hand", Shape::ball(0.1)?);
    /// let post = cell.add_obstacle("post", Shape::ball(0.2)?, Isometry3::identity())?;
    /// let pair = CellPair::new(post, hand).unwrap();
    /// assert_eq!(cell.show(&pair).to_string(), "hand and post");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn show<'a, T>(&'a self, value: &'a T) -> Named<'a, T> {
        Named { cell: self, value }
    }

    /// Returns the geometries of a pair of bodies that exist.
    pub(crate) fn shapes(&self, pair: CellPair) -> [&Geometry; 2] {
        [self.shape(pair.a), self.shape(pair.b)]
    }

    /// Pairs that are measured have bodies that exist.
    fn shape(&self, part: CellBody) -> &Geometry {
        match part {
            CellBody::Robot(k) => &self.robot[k].1,
            CellBody::Attached(k) => self.attached[k].as_ref().map_or(&self.robot[0].1, |o| &o.geometry),
            CellBody::Obstacle(k) => self.obstacles[k].as_ref().map_or(&self.robot[0].1, |o| &o.1),
        }
    }

    /// Prepares the hull of a body that is new or has a new geometry, if it is a mesh.
    pub(crate) fn note_hull(&mut self, id: CellBody) {
        match self.geometry(id).is_some_and(|body| body.kind() == GeometryKind::Mesh) {
            true => self.hulls.insert(id, MeshHull::default()),
            false => self.hulls.remove(&id),
        };
    }

    /// Returns the convex bodies that contain those of a pair, with hulls instead of meshes.
    ///
    /// Returns `None` if no body is a mesh, or if a body has no hull and is not convex.
    pub(crate) fn hulls(&self, pair: CellPair) -> Option<[&Geometry; 2]> {
        if self.hulls.is_empty() {
            return None;
        }
        let meshes = [pair.a, pair.b].map(|id| self.hulls.get(&id));
        if meshes.iter().all(Option::is_none) {
            return None;
        }
        let [a, b] = self.shapes(pair);
        Some([hull(meshes[0], a)?, hull(meshes[1], b)?])
    }

    /// Returns whether a body is not convex, so that a distance costs many times a predicate.
    pub(crate) fn has_parts(&self) -> bool {
        let attached = self.attached.iter().flatten().map(|o| &o.geometry);
        let obstacles = self.obstacles.iter().flatten().map(|o| &o.1);
        !self
            .robot
            .iter()
            .map(|b| &b.1)
            .chain(attached)
            .chain(obstacles)
            .all(is_convex)
    }

    /// Returns an error if something refers to a body or frame that does not exist, or if a length
    /// is out of range.
    pub(crate) fn validate(&self) -> Result<(), PlanError> {
        let has = |id: CellBody| match self.contains(id) {
            true => Ok(()),
            // The error says why.
            false => self.select(id).map(|_| ()),
        };
        let bare = self.bare_frames();
        let objects = self.attached().map(|(_, object)| (&object.name, &object.geometry));
        let moving = self
            .robot
            .iter()
            .map(|(name, geometry)| (name, geometry))
            .chain(objects);
        if let Some((name, _)) = moving.into_iter().find(|(_, g)| g.kind() == GeometryKind::HalfSpace) {
            return Err(PlanError::Unbounded(name.clone()));
        }
        for (_, object) in self.attached() {
            RelativePose::from_isometry(&object.pose)?;
            match object.frame {
                Frame::Robot(k) => has(CellBody::Robot(k))?,
                Frame::Bare(k) if k < bare => {}
                Frame::Bare(_) => {
                    return Err(PlanError::Unnamed {
                        name: object.link.clone(),
                        near: None,
                    });
                }
            }
        }
        for (_, frame) in self.frames.iter() {
            if let Frame::Robot(k) = *frame {
                has(CellBody::Robot(k))?;
            }
        }
        self.robots.check(self.robot.len(), self.obstacles.len())?;
        let pairs = self.excluded.keys().chain(self.margins.keys());
        for pair in pairs {
            has(pair.a)?;
            has(pair.b)?;
            if CellPair::new(pair.a, pair.b) != Some(*pair) {
                return Err(PlanError::NoBody(pair.b));
            }
        }
        self.paddings.keys().try_for_each(|id| has(*id))?;
        for id in self.motions.keys() {
            has(*id)?;
            if self.obstacle_pose(*id).is_none() {
                return Err(PlanError::NoBody(*id));
            }
        }
        check_length("margin", self.margin)?;
        self.margins
            .values()
            .try_for_each(|m| check_length("margin of a pair", *m))?;
        self.paddings.values().try_for_each(|p| check_length("padding", *p))
    }
}

/// Returns the box of an obstacle that moves, at all times.
pub(crate) fn swept(geometry: &Geometry, poses: &TimedPoses) -> Result<Aabb, PlanError> {
    let aabb = poses.swept(geometry.bounding_ball());
    aabb.validate_unbounded()?;
    Ok(aabb)
}

/// Returns motion and box of a body at rest.
pub(crate) fn resting(geometry: &Geometry, pose: &Isometry3<f64>) -> Result<(Steady, Aabb), PlanError> {
    let steady = Steady::new(pose, Velocity::default())?;
    let aabb = Aabb::from(geometry.aabb_at(pose, &mut BoxHint::default()));
    // The box of a half-space is infinite.
    aabb.validate_unbounded()?;
    Ok((steady, aabb))
}

/// Returns the convex body that contains a body: itself or its hull.
fn hull<'a>(mesh: Option<&'a MeshHull>, shape: &'a Geometry) -> Option<&'a Geometry> {
    match mesh {
        Some(hull) => hull.of(shape),
        None => Some(shape).filter(|shape| is_convex(shape)),
    }
}

/// Returns the entries of a map whose keys are kept.
fn entries<K: Copy + Ord, V: Clone>(map: &BTreeMap<K, V>, is_kept: impl Fn(&K) -> bool) -> BTreeMap<K, V> {
    let kept = map.iter().filter(|(key, _)| is_kept(key));
    kept.map(|(key, value)| (*key, value.clone())).collect()
}

fn is_convex(shape: &Geometry) -> bool {
    matches!(
        shape,
        Geometry::Polyhedron(_) | Geometry::Convex(_) | Geometry::HalfSpace(_)
    )
}

/// Returns the pose with a normalised rotation. A rotation that was normalised before keeps its
/// bits, so that a cell that was saved is the same when it is loaded.
fn normalized_once(pose: &Isometry3<f64>) -> Isometry3<f64> {
    // Components of a normalised quaternion err by less than 5 units of rounding.
    match (pose.rotation.norm_squared() - 1.0).abs() <= 8.0 * f64::EPSILON {
        true => *pose,
        false => normalize_rotation(pose),
    }
}

/// Returns an error if a length is negative or not finite.
pub(crate) fn check_length(what: &'static str, value: f64) -> Result<(), PlanError> {
    match (0.0..=EXTENT_MAX).contains(&value) {
        true => Ok(()),
        false => Err(PlanError::Value { what, value }),
    }
}

/// Prints a value with the names of its bodies: see [`Cell::show`].
#[derive(Clone, Copy, Debug)]
pub struct Named<'a, T> {
    pub(crate) cell: &'a Cell,
    pub(crate) value: &'a T,
}

impl fmt::Display for Named<'_, CellBody> {
    /// Writes the name; an id without a name as such.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.cell.name(*self.value) {
            "" => self.value.fmt(f),
            name => f.pad(name),
        }
    }
}

impl fmt::Display for Named<'_, CellPair> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = [&self.value.a, &self.value.b].map(|id| self.cell.show(id));
        write!(f, "{a} and {b}")
    }
}

/// A cell as it is stored: lists, checked when they are read. Removed bodies keep their places, so
/// that ids stay. No field is left out: formats without field names need all of them.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Cell")]
struct StoredCell {
    robot: Vec<(String, Geometry)>,
    frames: Vec<(String, Frame)>,
    attached: Vec<Option<AttachedObject>>,
    obstacles: Vec<Option<(String, Geometry, Isometry3<f64>)>>,
    #[serde(default)]
    motions: Vec<(CellBody, TimedPoses)>,
    excluded: Vec<(CellPair, String)>,
    margin: f64,
    paddings: Vec<(CellBody, f64)>,
    margins: Vec<(CellPair, f64)>,
    #[serde(default)]
    robots: Robots,
}

#[cfg(feature = "serde")]
impl From<Cell> for StoredCell {
    fn from(cell: Cell) -> Self {
        Self {
            robot: Arc::unwrap_or_clone(cell.robot),
            frames: Arc::unwrap_or_clone(cell.frames),
            attached: cell.attached,
            obstacles: cell.obstacles,
            motions: cell.motions.into_iter().collect(),
            excluded: cell
                .excluded
                .into_iter()
                .map(|(pair, why)| (pair, why.to_string()))
                .collect(),
            margin: cell.margin,
            paddings: cell.paddings.into_iter().collect(),
            margins: cell.margins.into_iter().collect(),
            robots: Arc::unwrap_or_clone(cell.robots),
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCell> for Cell {
    type Error = PlanError;

    fn try_from(stored: StoredCell) -> Result<Self, PlanError> {
        let mut cell = Self {
            robot: stored.robot.into(),
            frames: stored.frames.into(),
            attached: stored.attached,
            obstacles: stored.obstacles,
            motions: stored.motions.into_iter().collect(),
            hulls: BTreeMap::new(),
            excluded: stored
                .excluded
                .into_iter()
                .map(|(pair, why)| (pair, why.into()))
                .collect(),
            margin: stored.margin,
            paddings: stored.paddings.into_iter().collect(),
            margins: stored.margins.into_iter().collect(),
            robots: stored.robots.into(),
            names: BTreeSet::new(),
            changes: Changes::default(),
        };
        cell.validate()?;
        let names = cell
            .bodies()
            .map(|b| b.1)
            .chain(cell.frames.iter().map(|f| f.0.as_str()));
        cell.names = names.map(String::from).collect();
        let bodies: Vec<CellBody> = cell.bodies().map(|body| body.0).collect();
        bodies.into_iter().for_each(|id| cell.note_hull(id));
        Ok(cell)
    }
}
