//! Boxes of joint values in which single pairs of robot bodies are proven apart.
//!
//! Two links with one or two joints between them are near each other at most configurations, so they
//! cost a query nearly every time. Their distance depends on these joints alone. Some hundred boxes
//! of joint values answer most of these queries, for every cell in which the robot is.
//!
//! The limits are one box. A box in which the pair is not proven apart is halved, the largest first:
//! see the proofs over ranges. A box in which the pair is always in contact stays whole.
//!
//! Sources: Brooks and Lozano-Perez 1985 (free and full cells of a subdivision); Zhu and Latombe 1991.

use core::fmt;
use core::ops::ControlFlow;
use std::collections::{BTreeSet, VecDeque};
use std::string::String;
use std::sync::Arc;
use std::vec::Vec;

use super::{BoxProof, PairProver};
use crate::check::apart::{ApartBoxes, BoxTree, Node};
use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::motion::space::{ConfigurationSpace, JointPath};
use crate::names::{CellBody, CellPair};
use lin_canny::{Geometry, Progress};

/// Largest number of coordinates that move a pair with boxes: each multiplies their number.
const COORDINATES: usize = 2;

/// Boxes of joint values in which pairs of robot bodies are proven apart.
///
/// [`search`](Self::search) makes them, once for a robot, and [`Checker::set_pair_boxes`] hands them
/// to the checkers of its cells. Copies share the boxes.
#[derive(Clone)]
pub struct PairBoxes {
    robot: Arc<Vec<(String, Geometry)>>,
    pairs: Vec<Arc<ApartBoxes>>,
}

impl fmt::Debug for PairBoxes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.pairs()).finish()
    }
}

impl PairBoxes {
    /// Returns each pair with the share of the joint limits in which its boxes prove it apart.
    pub fn pairs(&self) -> impl Iterator<Item = (CellPair, f64)> {
        self.pairs.iter().map(|one| (one.pair, one.boxes.share))
    }

    /// Searches for boxes of joint values in which pairs of robot bodies are proven apart, for each
    /// pair that is measured and has one or two coordinates that move it. `boxes` is the largest
    /// number of boxes of a pair that are searched.
    ///
    /// The boxes do not depend on obstacles and attached objects, so they serve all cells of the
    /// robot. They are proven for what the pairs must keep at this call. The callback receives the
    /// number of boxes of a pair, after each box. If it stops the search, the result has what was
    /// proven until then.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, Joint, JointMotion, JointTree, Cell};
    /// # use core::ops::ControlFlow;
    /// use lin_canny::Progress;
    /// use lin_canny_plan::PairBoxes;
    ///
    /// // Two blocks on one rail.
    /// let rail = || Joint::prismatic(Isometry3::identity(), Vector3::x_axis(), [0.0, 4.0]);
    /// let rails = JointTree::serial(Isometry3::identity(), vec![rail(), rail()], vec![1, 2], 0.1)?;
    /// let mut cell = Cell::new();
    /// let block = solids::cuboid(Vector3::repeat(0.5))?;
    /// cell.robot_body("first", block.clone());
    /// cell.robot_body("second", block);
    /// let mut checker = Checker::new(rails, cell)?;
    ///
    /// let mut show = |_: Progress| ControlFlow::Continue(()); // here a bar is drawn
    /// let boxes = PairBoxes::search(&mut checker, 100, &mut show)?;
    /// checker.set_pair_boxes(&boxes)?;
    /// assert!(checker.is_free(&JointMotion::segment(&[0.0, 2.0], &[3.0, 1.5]))?);
    /// assert_eq!(checker.work().queries + checker.work().decisions, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the space has a coordinate without limits.
    pub fn search<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        boxes: u64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Self, PlanError> {
        let [low, high] = checker.range_of_limits()?;
        let own = checker.pairs.own.values().map(|k| checker.pairs.all[*k].pair);
        let pairs: Vec<CellPair> = own.filter(|pair| checker.has_few_joints(*pair)).collect();
        let mut found = Vec::with_capacity(pairs.len());
        let mut is_stopped = false;
        for pair in pairs {
            let boxes = checker.with_prover(pair, &low, &high, |prover| {
                search(prover, [low.clone(), high.clone()], boxes, &mut |at| {
                    let flow = progress(at);
                    is_stopped |= flow.is_break();
                    flow
                })
            })?;
            found.push(Arc::new(ApartBoxes {
                pair,
                kept: checker.cell.required_distance(pair).distance,
                paths: checker.paths_of(pair),
                boxes,
            }));
            if is_stopped {
                break;
            }
        }
        Ok(Self {
            robot: checker.cell.robot.clone(),
            pairs: found,
        })
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Answers by the boxes of pairs from now on, where they decide.
    ///
    /// [`is_free_at`](Self::is_free_at), [`is_free`](Self::is_free), [`certify`](Self::certify) and
    /// the planners look up each of these pairs before they query it. Verdicts stay; only
    /// within rounding of the margin a box may prove a segment free that is undecided without. A pair
    /// that must keep more than its boxes prove is queried as before, and so are all pairs inside
    /// tubes and if contacts at the start are accepted. Changes of the cell keep the boxes.
    /// [`fork`](Self::fork) hands them on.
    ///
    /// # Errors
    /// Returns an error if the boxes were not made for copies of this robot: of its cell, whose
    /// bodies all copies share, and of its joints. Then nothing changes.
    pub fn set_pair_boxes(&mut self, boxes: &PairBoxes) -> Result<(), PlanError> {
        if !Arc::ptr_eq(&boxes.robot, &self.cell.robot) {
            let what = "the bodies of the robot are not those of the pairs";
            return Err(PlanError::OtherPairBoxes(what.into()));
        }
        if let Some(other) = boxes.pairs.iter().find(|one| self.paths_of(one.pair) != one.paths) {
            let pair = self.show(&other.pair);
            return Err(PlanError::OtherPairBoxes(std::format!("{pair}: the joints differ")));
        }
        for one in &boxes.pairs {
            self.pairs.set_apart(one.pair, one);
        }
        Ok(())
    }

    /// Returns the limits of all coordinates.
    fn range_of_limits(&self) -> Result<[Vec<f64>; 2], PlanError> {
        self.check_cell()?;
        let bounds = self.space.bounds();
        if bounds.len() != self.space.coordinates() {
            return Err(PlanError::Value {
                what: "number of coordinates without limits",
                value: (self.space.coordinates() - bounds.len()) as f64,
            });
        }
        let limits = [0, 1].map(|k| bounds.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
        self.check_range(&limits[0], &limits[1])?;
        Ok(limits)
    }

    /// Returns the joints that move each body of a pair.
    fn paths_of(&self, pair: CellPair) -> [Option<JointPath>; 2] {
        [pair.a, pair.b].map(|id| match id {
            CellBody::Robot(body) => self.space.joint_path(body),
            _ => None,
        })
    }

    /// Returns whether a pair of robot bodies has few coordinates that move it.
    fn has_few_joints(&self, pair: CellPair) -> bool {
        let [Some(a), Some(b)] = self.paths_of(pair) else {
            return false;
        };
        let numbers = |path: &JointPath| path.joints.iter().map(|joint| joint.0).collect::<BTreeSet<_>>();
        let (of_a, of_b) = (numbers(&a), numbers(&b));
        let joints = a.joints.iter().filter(|joint| !of_b.contains(&joint.0));
        let joints = joints.chain(b.joints.iter().filter(|joint| !of_a.contains(&joint.0)));
        let moving = joints.filter_map(|(_, joint)| joint.drive.filter(|drive| drive.factor != 0.0));
        let coordinates: BTreeSet<usize> = moving.map(|drive| drive.coordinate).collect();
        (1..=COORDINATES).contains(&coordinates.len())
    }
}

/// Searches boxes until as many are searched as `most` says, or the caller stops.
fn search(
    prover: &mut PairProver<'_>,
    [low, high]: [Vec<f64>; 2],
    most: u64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<BoxTree, PlanError> {
    let mut waiting = VecDeque::from([(0, [low.clone(), high.clone()], 1.0)]);
    let mut tree = BoxTree {
        low,
        high,
        nodes: std::vec![Node::Open],
        share: 0.0,
    };
    let mut searched = 0;
    while searched < most
        && let Some((node, [low, high], share)) = waiting.pop_front()
    {
        match prover.prove(&low, &high)? {
            BoxProof::Free => {
                tree.nodes[node] = Node::Apart;
                tree.share += share;
            }
            BoxProof::Contact => {}
            BoxProof::Left => {
                if let Some((coordinate, at)) = halving(prover, &low, &high) {
                    let half = tree.nodes.len();
                    tree.nodes[node] = Node::Halved { coordinate, half, at };
                    tree.nodes.extend([Node::Open; 2]);
                    let (mut middle_low, mut middle_high) = (low.clone(), high.clone());
                    (middle_low[coordinate], middle_high[coordinate]) = (at, at);
                    waiting.push_back((half, [low, middle_high], 0.5 * share));
                    waiting.push_back((half + 1, [middle_low, high], 0.5 * share));
                }
            }
        }
        searched += 1;
        let total = usize::try_from(most).ok();
        if progress(Progress::new("boxes", searched as usize, total)).is_break() {
            break;
        }
    }
    Ok(tree)
}

/// Returns the coordinate that moves the pair most, with the value at which a box is halved.
fn halving(prover: &PairProver<'_>, low: &[f64], high: &[f64]) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for (coordinate, moved) in prover.levers() {
        let (low, high) = (low[coordinate], high[coordinate]);
        let at = 0.5 * low + 0.5 * high;
        if low < at && at < high && best.is_none_or(|(most, ..)| moved > most) {
            best = Some((moved, coordinate, at));
        }
    }
    best.map(|(_, coordinate, at)| (coordinate, at))
}
