//! Proofs over ranges of joints: whether two bodies can ever meet.
//!
//! # Method
//!
//! 1. Only the joints between two bodies move them against each other. They form one chain from A
//!    to B; the joints on A's side count in reverse.
//! 2. The range is a box of coordinates, divided into cells. A cell is free if a plane fixed to any
//!    link between the bodies separates them over the whole cell. The bound is a Taylor polynomial
//!    of first or second degree about the centre of the cell, with its remainder. Joints next to a
//!    body that turn far are swept instead: each point of the body stays in a ball.
//! 3. Swept balls are tried first, then the plane of the parent cell, then the plane of the closest points
//!    at the centre, in the frame of each link, at last the distance at the centre less the greatest
//!    displacement.
//! 4. A cell is blocked if a point fixed to a link stays inside both bodies. Points on the axes of
//!    joints do not move, so links that overlap about their joint are often one cell.
//! 5. Other cells are halved along the coordinate that moves the bodies most.
//! 6. Where the hulls of bodies that are not convex meet, pairs of nodes of trees take their place,
//!    in that cell alone.
//!
//! The number of cells grows with the logarithm of the width to which a clearance is proven, because
//! both the distance near its minimum and the loss of a second-order bound are quadratic. It grows
//! by about six for each joint.
//!
//! # Soundness
//!
//! A plane may be anything: a bad one costs time, not truth. The bounds hold for the motion over the
//! real numbers and for the poses of [`ConfigurationSpace::place`]; rounding is counted by
//! `RANGE_FRAME` and `RANGE_TERM`. Witnesses are decided by the predicate of
//! [`Checker::is_free_at`].
//!
//! Sources: Brockett 1984 (product of exponentials); Schwarzer, Saha and Latombe 2005 (bounds of
//! displacements); Lin 1993 (closest features). Departures: planes of any link, second order.

mod bound;
mod chain;
mod contact;
pub(crate) mod pair_boxes;
mod parts;
mod prover;
mod search;
mod verdict;

use core::ops::ControlFlow;
use std::vec::Vec;

use nalgebra::Isometry3;

use crate::cell::range_body::RangeBody;
use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::{CellBody, CellPair};
use chain::{Chain, ChainEnd};
use lin_canny::{PairTracker, Progress, normalize_rotation};
use search::{Search, fingerprint_of};

pub(crate) use prover::PairProver;
pub(crate) use search::BoxProof;
pub use verdict::{ClearanceWidth, RangeAnswer, RangeCell, RangeOptions, RangeVerdict};

/// Proves whether bodies can meet at any configuration of a range.
///
/// A range is a box of configurations: `low` and `high` hold the least and the greatest value of
/// each coordinate.
pub struct RangeProver<'a> {
    options: RangeOptions,
    progress: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
}

impl<'a> RangeProver<'a> {
    /// Returns a prover with these options.
    #[must_use]
    pub fn new(options: &RangeOptions) -> Self {
        Self {
            options: *options,
            progress: None,
        }
    }

    /// Sets the progress callback, which receives the number of cells of the pair at hand, after
    /// each cell. If it stops the proof, answers are open, and can be resumed.
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Returns whether two bodies can meet at any configuration of a range, with proof.
    ///
    /// Coordinates that do not move the bodies against each other do not matter. Excluded pairs are
    /// answered too.
    /// See [`RangeVerdict`] for the four verdicts, and [`resume`](Self::resume) for an answer that is
    /// open.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::{Checker, Joint, JointTree, RangeOptions, RangeProver, RangeVerdict, Cell};
    ///
    /// // Two links in the plane, each one long, and a post.
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
    /// let base = Isometry3::identity();
    /// let arm = JointTree::serial(base, vec![turn(0.0), turn(1.0)], vec![2], 1.0)?;
    /// let rod = solids::cuboid(Vector3::new(0.4, 0.05, 0.05))?.transformed(&at(0.5))?;
    /// let mut cell = Cell::new();
    /// let rod = cell.robot_body("fore arm", rod);
    /// let post = solids::cuboid(Vector3::new(0.1, 0.1, 1.0))?;
    /// let post = cell.add_obstacle("post", post, at(1.5))?;
    ///
    /// let mut checker = Checker::new(arm, cell)?;
    /// let options = RangeOptions::default();
    /// let all = RangeProver::new(&options).pair(&mut checker, rod, post, &[-3.0; 2], &[3.0; 2])?;
    /// assert!(matches!(all.verdict, RangeVerdict::Both { .. }));
    /// let [low, high] = [[1.0, -1.0], [2.0, 1.0]];
    /// let aside = RangeProver::new(&options).pair(&mut checker, rod, post, &low, &high)?;
    /// assert!(aside.is_never() && aside.lower > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// A tolerance is a joint with a range. Here a peg is placed to 2 cm along x:
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, ClearanceWidth, Drive, JointKind, JointTree};
    /// # use lin_canny_plan::{RangeOptions, RangeProver, TreeJoint, Cell};
    /// let slide = |parent, axis| TreeJoint {
    ///     parent,
    ///     kind: JointKind::Prismatic,
    ///     origin: Isometry3::identity(),
    ///     axis,
    ///     drive: Some(Drive::by(parent)),
    /// };
    /// // The lift moves the peg, the tolerance shifts it.
    /// let joints = vec![slide(0, Vector3::z_axis()), slide(1, Vector3::x_axis())];
    /// let limits = vec![[0.0, 1.0], [-0.02, 0.02]];
    /// let base = Isometry3::identity();
    /// let tree = JointTree::new(base, joints, limits, vec![2], vec![1.0; 3])?;
    /// let mut cell = Cell::new();
    /// let peg = cell.robot_body("peg", solids::cuboid(Vector3::repeat(0.1))?);
    /// let wall = solids::cuboid(Vector3::new(0.1, 1.0, 2.0))?;
    /// let wall = cell.add_obstacle("wall", wall, Isometry3::translation(0.25, 0.0, 0.0))?;
    ///
    /// let mut checker = Checker::new(tree, cell)?;
    /// let options = RangeOptions::default().width(ClearanceWidth::Length(1e-6));
    /// let [low, high] = [[0.0, -0.02], [1.0, 0.02]];
    /// let found = RangeProver::new(&options).pair(&mut checker, peg, wall, &low, &high)?;
    /// assert!((found.lower - 0.03).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Obstacles that move are at their poses at the time of [`Checker::set_time`].
    ///
    /// Planes are proven for prisms and pyramids with 32 sides around cylinders and cones, whose
    /// radius is up to 0.5 % larger, and for boxes around ellipsoids, clouds and
    /// Bézier surfaces. Where those meet and the bodies do not, a cell is proven by the distance at
    /// its centre less the greatest displacement. Verdicts are of the bodies, but a clearance far
    /// below the error of the prism or box takes many more cells.
    ///
    /// # Errors
    /// Returns an error if a coordinate is out of bounds or `low` is above `high`, which names the
    /// coordinate; if a body does not exist, or both are obstacles; if an obstacle moves and no time
    /// is set; or if the space does not move a body by joints
    /// ([`ConfigurationSpace::joint_path`]).
    pub fn pair<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        a: CellBody,
        b: CellBody,
        low: &[f64],
        high: &[f64],
    ) -> Result<RangeAnswer, PlanError> {
        checker.check_range(low, high)?;
        let pair = CellPair::new(a, b).ok_or(PlanError::NoBody(b))?;
        let range = low.iter().zip(high).map(|(low, high)| [*low, *high]).collect();
        self.proved(checker, RangeAnswer::new(pair, range))
    }

    /// Returns the answers about all pairs that are measured, in ascending order: see
    /// [`pair`](Self::pair).
    ///
    /// If the callback stops the proof, the pair at hand and all later ones are open.
    ///
    /// # Errors
    /// As [`pair`](Self::pair).
    pub fn all_pairs<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        low: &[f64],
        high: &[f64],
    ) -> Result<Vec<RangeAnswer>, PlanError> {
        checker.check_range(low, high)?;
        let range: Vec<[f64; 2]> = low.iter().zip(high).map(|(low, high)| [*low, *high]).collect();
        let ordered = checker.pairs.ordered();
        let mut pairs: Vec<CellPair> = ordered.iter().map(|k| checker.pairs.all[*k].pair).collect();
        pairs.sort_unstable();
        let Self { options, mut progress } = self;
        let mut is_stopped = false;
        let mut answers = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let answer = RangeAnswer::new(pair, range.clone());
            let mut watch = |now| {
                is_stopped |= progress.as_mut().is_some_and(|progress| progress(now).is_break());
                Progress::stop_if(is_stopped)
            };
            answers.push(checker.proved(answer, &options, &mut watch)?);
        }
        Ok(answers)
    }

    /// Goes on with an answer that is open, for as many cells as the options allow.
    ///
    /// Two calls give the same answer as one call with the sum of both budgets. An answer that is
    /// not open is returned as it is.
    ///
    /// # Errors
    /// As [`pair`](Self::pair), and if the bodies of the pair, the joints between them or the
    /// distance that the pair must keep are not those of the answer. They are recognised by a hash
    /// of corners, points, sizes and poses. A forged answer is not recognised.
    pub fn resume<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        answer: &RangeAnswer,
    ) -> Result<RangeAnswer, PlanError> {
        let [low, high] = [0, 1].map(|k| answer.range.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
        checker.check_range(&low, &high)?;
        self.proved(checker, answer.clone())
    }

    fn proved<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        answer: RangeAnswer,
    ) -> Result<RangeAnswer, PlanError> {
        let mut unwatched = |_| ControlFlow::Continue(());
        checker.proved(answer, &self.options, self.progress.unwrap_or(&mut unwatched))
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    pub(crate) fn check_range(&self, low: &[f64], high: &[f64]) -> Result<(), PlanError> {
        self.check_time()?;
        self.space.check(low)?;
        self.space.check(high)?;
        let each = low.iter().zip(high).enumerate();
        match each.into_iter().find(|(_, (low, high))| low > high) {
            Some((index, (&low, &high))) => Err(PlanError::Range { index, low, high }),
            None => Ok(()),
        }
    }

    fn proved(
        &mut self,
        answer: RangeAnswer,
        options: &RangeOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<RangeAnswer, PlanError> {
        let pair = answer.pair;
        match options.width {
            Some(ClearanceWidth::Length(width) | ClearanceWidth::Share(width)) if !(width >= 0.0) => {
                let (what, value) = ("width of the clearance", width);
                return Err(PlanError::Value { what, value });
            }
            _ => {}
        }
        let [low, high] = [0, 1].map(|k| answer.range.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
        self.prepare_pair(pair)?;
        let chain = self.chain(pair, &low, &high)?;
        let shapes = self.cell.shapes(pair);
        let bodies = [pair.a, pair.b].map(|id| &self.range_bodies[&id]);
        let kept = self.cell.required_distance(pair).distance;
        let fingerprint = fingerprint_of(shapes, bodies, &chain, kept);
        let (space, body_poses) = (&self.space, &self.pairs.body_poses);
        let place = |q: &[f64], poses: &mut Vec<Isometry3<f64>>| {
            space.place(q, poses);
            body_poses.carry(poses);
            [pair.a, pair.b].map(|id| *body_poses.pose(id, poses))
        };
        let search = Search {
            shapes,
            bodies,
            fingerprint,
            chain: &chain,
            place: &place,
            kept,
            options,
            tracker: PairTracker::new(),
            answer,
            room: Default::default(),
        };
        search.run(progress)
    }

    /// Prepares the bodies of a pair for proofs over ranges.
    fn prepare_pair(&mut self, pair: CellPair) -> Result<(), PlanError> {
        for id in [pair.a, pair.b] {
            self.cell.select(id)?;
        }
        let shapes = self.cell.shapes(pair);
        for (id, shape) in [pair.a, pair.b].into_iter().zip(shapes) {
            self.range_bodies.entry(id).or_insert_with(|| RangeBody::new(shape));
        }
        Ok(())
    }

    /// Returns the joints between two bodies that are prepared.
    fn chain(&self, pair: CellPair, low: &[f64], high: &[f64]) -> Result<Chain, PlanError> {
        let [a, b] = [pair.a, pair.b].map(|id| self.chain_end(id, self.range_bodies[&id].reach()));
        Ok(Chain::new(&a?, &b?, low, high))
    }

    fn chain_end(&self, id: CellBody, reach: f64) -> Result<ChainEnd, PlanError> {
        let body_poses = &self.pairs.body_poses;
        let (path, pose) = match (id, body_poses.mover(id)) {
            (CellBody::Obstacle(k), _) => (None, body_poses.obstacle_poses[k]),
            (_, mover) => {
                let (body, carried) = body_poses.carrier(mover.unwrap_or_default());
                let path = self.space.joint_path(body).ok_or(PlanError::WithoutJoints(id))?;
                (
                    Some(path),
                    carried.map_or(Isometry3::identity(), |carried| carried.pose),
                )
            }
        };
        Ok(ChainEnd {
            path,
            pose: normalize_rotation(&pose),
            deviation: (pose.rotation.norm_squared() - 1.0).abs(),
            reach,
        })
    }
}
