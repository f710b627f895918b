//! Adds robots to a cell, and makes one configuration space of them.

use std::collections::BTreeSet;
use std::format;
use std::string::String;
use std::sync::Arc;
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::cell::attached_object::Frame;
use crate::cell::robot_model::{Coordinate, RobotModel, Robots, consecutive};
use crate::cell::{Cell, resting};
use crate::error::PlanError;
use crate::motion::joint::{Drive, TreeJoint};
use crate::motion::tree::JointTree;
use crate::names::{CellBody, CellPair};
use lin_canny::{GeometryKind, RelativePose};

/// Robots from files.
impl Cell {
    /// Adds a robot whose root link has this pose in the world.
    ///
    /// Names of links and coordinates start with the prefix, which distinguishes robots; for a single
    /// robot it may be empty. A configuration has the coordinates of the robots, one robot after
    /// another. [`Checker::of_robots`](crate::Checker::of_robots) checks the cell.
    ///
    /// Pairs that the file of the robot excludes are excluded. Adjacent links are not: see
    /// [`exclude_adjacent`](Self::exclude_adjacent). A half-space of a link that no joint moves, such
    /// as the floor of an MJCF file, becomes an obstacle with the name of the link. Its pairs with
    /// other links at rest are excluded.
    ///
    /// Objects can be [attached](Self::attach) to every link by its name, also to links without
    /// bodies.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::{
    ///     Cell, Checker, Coordinate, Drive, LinkBody, MotionKind, RobotJoint, RobotLink, RobotModel,
    /// };
    ///
    /// let bar = solids::cuboid(Vector3::new(0.05, 0.05, 0.3))?;
    /// let link = |name: &str| RobotLink {
    ///     name: name.into(),
    ///     bodies: vec![LinkBody::new(Isometry3::translation(0.0, 0.0, 0.3), bar.clone())],
    /// };
    /// let model = RobotModel {
    ///     links: vec![link("post"), link("arm")],
    ///     joints: vec![RobotJoint {
    ///         name: "elbow".into(),
    ///         kind: MotionKind::Revolute,
    ///         parent: 0,
    ///         child: 1,
    ///         origin: Isometry3::translation(0.0, 0.0, 0.6),
    ///         axis: Vector3::y_axis(),
    ///         drive: Some(Drive::by(0)),
    ///         mimics: None,
    ///         limits: [-2.0, 2.0],
    ///     }],
    ///     coordinates: vec![Coordinate { name: "elbow".into(), limits: [-2.0, 2.0], velocity: None }],
    ///     adjacent: vec![[0, 1]],
    ///     excluded: Vec::new(),
    /// };
    /// let mut cell = Cell::new();
    /// cell.add_robot("", &model, Isometry3::identity())?;
    /// cell.exclude_adjacent();
    /// cell.add_obstacle("shelf", bar, Isometry3::translation(0.5, 0.0, 0.8))?;
    /// let mut checker = Checker::of_robots(cell)?;
    /// assert!(checker.is_free_at(&[0.0])?);
    /// assert!(!checker.is_free_at(&[1.3])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the pose or the box of a half-space is invalid, if an index is out of range,
    /// if a link or a coordinate has the name of another body or coordinate, or if the cell has robot
    /// bodies or frames of another space. Then nothing changes.
    pub fn add_robot(
        &mut self,
        prefix: &str,
        robot: &impl AsRef<RobotModel>,
        pose: Isometry3<f64>,
    ) -> Result<(), PlanError> {
        let model = robot.as_ref();
        model.check()?;
        self.check_tree()?;
        RelativePose::from_isometry(&pose)?;
        let named = |name: &str| format!("{prefix}{name}");
        let mut names = BTreeSet::new();
        for name in model.links.iter().map(|link| named(&link.name)) {
            self.check_name("link", &name)?;
            if !names.insert(name.clone()) {
                return Err(PlanError::NameTaken { kind: "link", name });
            }
        }
        let mut known: BTreeSet<String> = self.robots.coordinates.iter().map(|c| c.name.clone()).collect();
        for name in model.coordinates.iter().map(|c| named(&c.name)) {
            if !known.insert(name.clone()) {
                return Err(PlanError::NameTaken { kind: "joint", name });
            }
        }
        let mut robots = Robots::clone(&self.robots);
        let first = robots.coordinates.len();
        robots.coordinates.extend(model.coordinates.iter().map(|c| Coordinate {
            name: named(&c.name),
            ..c.clone()
        }));
        let mut links = std::vec![robots.add(TreeJoint::fixed(0, pose))];
        for joint in &model.joints {
            let drive = joint.drive.map(|drive| Drive {
                coordinate: drive.coordinate + first,
                ..drive
            });
            let mut link = links[joint.parent];
            for part in consecutive(joint.kind, &joint.axis, &joint.origin, drive) {
                link = robots.add(TreeJoint { parent: link, ..part });
            }
            links.push(link);
        }
        let (mut bodies, mut frames, mut spaces, mut ids) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (link, &at) in model.links.iter().zip(&links) {
            let name = named(&link.name);
            let mut own = Vec::new();
            for body in &link.bodies {
                let is_half_space = body.geometry.kind() == GeometryKind::HalfSpace;
                match is_half_space.then(|| robots.at_rest(at)).flatten() {
                    Some(pose) => {
                        let pose = pose * body.origin;
                        resting(&body.geometry, &pose)?;
                        let k = self.obstacles.len() + spaces.len();
                        ids.push(CellBody::Obstacle(k));
                        robots.half_spaces.insert(k);
                        spaces.push((name.clone(), body.geometry.clone(), pose));
                    }
                    None => {
                        ids.push(CellBody::Robot(self.robot.len() + bodies.len() + own.len()));
                        own.push(body);
                    }
                }
            }
            let first = self.robot.len() + bodies.len();
            match own.iter().position(|b| b.origin == Isometry3::identity()) {
                Some(0) => {}
                Some(k) => frames.push((name.clone(), Frame::Robot(first + k))),
                None => {
                    frames.push((name.clone(), Frame::Bare(robots.of_frames.len())));
                    robots.of_frames.push(at);
                }
            }
            for body in own {
                let link_of_body = match body.origin == Isometry3::identity() {
                    true => at,
                    false => robots.add(TreeJoint::fixed(at, body.origin)),
                };
                let (centre, radius) = body.geometry.bounding_ball();
                let reach = centre.coords.norm() + radius;
                let known = &mut robots.radii[link_of_body - 1];
                if reach > *known {
                    *known = reach;
                }
                robots.of_bodies.push(link_of_body);
                bodies.push((name.clone(), body.geometry.clone()));
            }
        }
        let pairs = model.adjacent.iter();
        let adjacent = pairs.map(|pair| pair.map(|k| named(&model.links[k].name)));
        robots.adjacent.extend(adjacent);

        self.robots = Arc::new(robots);
        self.names.extend(names);
        let first = self.robot.len();
        Arc::make_mut(&mut self.robot).extend(bodies);
        (first..self.robot.len()).for_each(|k| self.note_hull(CellBody::Robot(k)));
        Arc::make_mut(&mut self.frames).extend(frames);
        self.changes.robot = true;
        for (name, geometry, pose) in spaces {
            self.push_obstacle(name, geometry, pose);
        }
        let pairs = model.excluded.iter();
        for pair in pairs.filter_map(|[a, b]| CellPair::new(ids[*a], ids[*b])) {
            self.note_excluded(pair, "");
        }
        let resting: Vec<CellPair> = self.resting_pairs().collect();
        resting.into_iter().for_each(|pair| self.note_excluded(pair, ""));
        Ok(())
    }

    /// Returns the pairs of links at rest with half-spaces of robots.
    fn resting_pairs(&self) -> impl Iterator<Item = CellPair> {
        let has_spaces = !self.robots.half_spaces.is_empty();
        let of_bodies = self.robots.of_bodies.iter().enumerate().filter(move |_| has_spaces);
        let at_rest = of_bodies.filter(|(_, link)| self.robots.at_rest(**link).is_some());
        at_rest.flat_map(|(a, _)| {
            let spaces = self.robots.half_spaces.iter();
            let spaces = spaces.filter(|b| self.contains(CellBody::Obstacle(**b)));
            spaces.filter_map(move |b| CellPair::new(CellBody::Robot(a), CellBody::Obstacle(*b)))
        })
    }

    /// Excludes all pairs of adjacent links of the robots: those that one joint connects, or several
    /// joints with links without bodies between them.
    #[doc(alias = "ignore_adjacent")]
    pub fn exclude_adjacent(&mut self) {
        for [a, b] in self.robots.clone().adjacent.iter() {
            // A link without bodies has no pairs.
            let _ = self.exclude_because(a, b, "Adjacent");
        }
    }

    /// Includes all pairs again but those of links at rest with half-spaces of robots: see
    /// [`add_robot`](Self::add_robot).
    pub fn include_all(&mut self) {
        let excluded = core::mem::take(&mut self.excluded);
        self.changes.note(|changes| changes.pairs.extend(excluded.keys()));
        let resting: Vec<CellPair> = self.resting_pairs().collect();
        resting.into_iter().for_each(|pair| self.note_excluded(pair, ""));
    }

    /// Returns the names of adjacent links: see [`exclude_adjacent`](Self::exclude_adjacent).
    #[must_use]
    pub fn adjacent(&self) -> &[[String; 2]] {
        &self.robots.adjacent
    }

    /// Returns the coordinates of a configuration of the robots.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.robots.coordinates
    }

    /// Returns whether an obstacle is a half-space of a link of a robot.
    #[must_use]
    pub fn is_of_robot(&self, id: CellBody) -> bool {
        matches!(id, CellBody::Obstacle(k) if self.robots.half_spaces.contains(&k))
    }

    /// Widens the limits of all coordinates by `slack` at both ends, in radians or lengths.
    ///
    /// Recorded values often exceed a limit by their rounding.
    pub fn widen_limits(&mut self, slack: f64) {
        for coordinate in &mut Arc::make_mut(&mut self.robots).coordinates {
            let [low, high] = coordinate.limits;
            coordinate.limits = [low - slack, high + slack];
        }
        self.changes.robot = true;
    }

    /// Returns an error if the cell has robot bodies or frames that the tree of the robots has not.
    fn check_tree(&self) -> Result<(), PlanError> {
        let counts = [
            (self.robots.of_bodies.len(), self.robot.len()),
            (self.robots.of_frames.len(), self.bare_frames()),
        ];
        let other = counts.into_iter().find(|(space, cell)| space != cell);
        other.map_or(Ok(()), |(space, cell)| Err(PlanError::Bodies { space, cell }))
    }

    /// Returns the configuration space of all robots that [`add_robot`](Self::add_robot) added.
    ///
    /// Its bodies are those of all links, then one without geometry for the frame of each link that is
    /// not the frame of a body. Its [`sample`](crate::ConfigurationSpace::sample) returns a random
    /// configuration within the limits.
    ///
    /// # Errors
    /// Returns an error if a number of a robot is out of range, or if the cell has robot bodies or
    /// frames of another space.
    pub fn space(&self) -> Result<JointTree, PlanError> {
        self.check_tree()?;
        let robots = &*self.robots;
        let radii = core::iter::once(&0.0).chain(&robots.radii).copied();
        JointTree::new(
            Isometry3::identity(),
            robots.joints.clone(),
            robots.coordinates.iter().map(|c| c.limits).collect(),
            robots.of_bodies.iter().chain(&robots.of_frames).copied().collect(),
            radii.collect(),
        )
    }
}
