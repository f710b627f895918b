//! Receipts of segments and paths.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use super::contact::{contact, meeting};
use super::error::ReceiptError;
use super::obstacles::Obstacles;
use super::scene::{Body, Ignored, Scene, SteadyWay, Way};
use super::stated::FINENESS;
use super::{Claim, Leg, Receipt, Wanted, apart};
use crate::check::certify::{Certified, CertifyOptions, PairProof};
use crate::check::checker::{Checker, in_tube};
use crate::check::verdict::{LeavingPair, Verdict};
use crate::extremes::Extremes;
use crate::motion::joint_motion::{JointMotion, Tube};
use crate::motion::space::{ConfigurationSpace, SegmentMotion};
use crate::names::{CellBody, CellPair};
use lin_canny::Geometry;

/// The reasons of pairs that are not looked at.
pub(super) const EXCLUDED: &str = "excluded";
const RIGID: &str = "the bodies keep their relative pose";
const TWO_OBSTACLES: &str = "the bodies are obstacles";
const LEAVING: &str = "in contact at the start, which was accepted";

/// The bodies of a cell in a receipt.
pub(super) struct ReceiptCell<'a> {
    pub(super) scene: Scene,
    obstacles: Obstacles<'a>,
    ids: Vec<CellBody>,
    /// By how much a tube of points brings a pair nearer.
    tube: f64,
    /// The pairs that must have evidence, and what they must keep.
    pub(super) pairs: Vec<([usize; 2], f64)>,
    margin: f64,
}

impl Receipt {
    /// Returns the receipt of [`Checker::certify`]: that a motion is free, or that a motion of one
    /// piece is free up to a time and blocked by a pair at a later one.
    ///
    /// It states the scene once, and has a leg for each piece: the ends of a segment, or the control
    /// points of a curve ([`JointCurve::control_point`](crate::JointCurve::control_point)). If a curve
    /// was given in another form, its control points are rounded, and the receipt is about them.
    ///
    /// Among moving obstacles it has more legs: a piece is cut at the times of the poses of every obstacle
    /// ([`Cell::add_moving_obstacle`](crate::Cell::add_moving_obstacle)). Cuts and poses are rounded, too.
    ///
    /// A tube of points ([`JointMotion::with_radius`]) is a distance that each pair keeps more than along the motion
    /// itself, once or twice the radius.
    ///
    /// If a motion that is cut is blocked, the receipt states the leg with the contact, and the contact alone.
    ///
    /// Along a blocked motion, all pairs have evidence until `free_until` of the
    /// [`Verdict::Blocked`], or until an earlier time if the evidence is within rounding there. Four
    /// vertex pairs, or two points, prove the contact of the pair at `contact_at`; if none are
    /// certain there, at most 4,096 times the bracket later. A motion that is blocked at its start
    /// has the contact alone.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::receipt::Receipt;
    /// use lin_canny_plan::{Checker, Joint, JointCurve, JointMotion, JointTree, Cell};
    ///
    /// // A block on two rails flies over a post along a parabola.
    /// let origin = Isometry3::identity();
    /// let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// cell.add_obstacle("post", post, origin)?;
    /// let mut checker = Checker::new(block, cell)?;
    ///
    /// let curve = JointCurve::bezier(&[[-2.0, 0.0], [0.0, 1.7], [2.0, 0.0]])?;
    /// let receipt = Receipt::motion(&mut checker, &JointMotion::curve(&curve))?;
    /// assert!(receipt.to_string().contains("\"claim\":\"apart\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error as [`Checker::certify`] does, and as [`certified`](Self::certified) does.
    pub fn motion<C: ConfigurationSpace>(checker: &mut Checker<C>, motion: &JointMotion) -> Result<Self, ReceiptError> {
        let found = checker.certify_with(motion, CertifyOptions::default().certificates(true))?;
        Self::certified(checker, motion, &found)
    }

    /// Returns the receipt of a verdict with its certificates ([`Checker::certify_with`]), as
    /// [`motion`](Self::motion) does. Nothing is cast again. The certificates only make it shorter.
    ///
    /// # Errors
    /// Returns an error if the verdict is undecided; if a motion of several pieces is blocked
    /// ([`ReceiptError::Blocked`]); if it has several pieces in a space of a rigid body, where each
    /// piece needs a separate receipt; if a body or the motion has no receipt
    /// ([module](crate::receipt)); or if a pair has no evidence that a checker would accept, for
    /// example because no plane separates it by more than rounding. A pair whose contact at the start was accepted
    /// is listed as not looked at.
    pub fn certified<C: ConfigurationSpace>(
        checker: &Checker<C>,
        motion: &JointMotion,
        found: &Certified,
    ) -> Result<Self, ReceiptError> {
        let (until, blocked, leaving) = match &found.verdict {
            Verdict::Free { start_contacts, .. } => (1.0, None, start_contacts),
            Verdict::Blocked { piece, .. } if motion.pieces() > 1 => {
                return Err(ReceiptError::Blocked { piece: *piece });
            }
            Verdict::Blocked {
                free_until,
                contact_at,
                pair,
                start_contacts,
                ..
            } => (*free_until, Some(([*free_until, *contact_at], *pair)), start_contacts),
            Verdict::Undecided { free_until, .. } => return Err(ReceiptError::Undecided { time: *free_until }),
        };
        let mut receipt = Err(ReceiptError::Nothing);
        for fineness in 0..FINENESS {
            let mut stated = match ReceiptCell::of_motion(checker, motion, fineness) {
                // The evidence of the last fineness was not enough, and the next has too many triangles.
                Err(ReceiptError::Parts { .. } | ReceiptError::Vertices { .. }) if fineness > 0 => break,
                stated => stated?,
            };
            stated.leave_out(leaving);
            // Close to a contact the evidence may be within rounding: then it ends earlier.
            for part in [1.0, 1023.0 / 1024.0, 0.5, 0.0] {
                receipt = Self::proven(checker, motion, found, &stated, part * until, blocked);
                if blocked.is_none() || !matches!(receipt, Err(ReceiptError::Pair { .. })) {
                    break;
                }
            }
            // A contact has no evidence at any fineness.
            let is_missing = matches!(&receipt, Err(ReceiptError::Pair { from, until, .. }) if from < until);
            if !(is_missing && stated.scene.is_coarse()) {
                break;
            }
        }
        receipt
    }

    /// Writes the evidence of a motion that is free until a time, and blocked by a pair at a later one.
    fn proven<C: ConfigurationSpace>(
        checker: &Checker<C>,
        motion: &JointMotion,
        found: &Certified,
        stated: &ReceiptCell<'_>,
        until: f64,
        blocked: Option<([f64; 2], CellPair)>,
    ) -> Result<Self, ReceiptError> {
        let margin = stated.margin;
        // Without a pair that moves, nothing is claimed of the time before a contact.
        let is_at_start = stated.pairs.is_empty() || blocked.is_some_and(|([_, at], _)| !(until > 0.0) || at == 0.0);
        if is_at_start && blocked.is_none() {
            return Err(ReceiptError::Nothing);
        }
        let pieces = stated.legs(motion);
        stated.check_legs(pieces.len())?;
        // Of a motion that is cut, only the leg with the contact is stated.
        let is_at_start = is_at_start || (blocked.is_some() && pieces.len() > 1);
        let mut legs = Vec::new();
        for (k, [start, end], mut leg) in pieces {
            let mut line = None;
            if let Some((bracket, pair)) = blocked {
                if bracket[1] > end {
                    continue;
                }
                let bracket = bracket.map(|time| ((time - start) / (end - start)).larger(0.0));
                let numbers = stated.numbers(pair);
                let kept = in_tube(checker.cell.required_distance(pair).distance, stated.tube);
                let moves = numbers.iter().any(|k| stated.scene.moves(*k));
                line = Some(match moves {
                    true => contact(&stated.scene, leg.rows(), numbers, bracket, 1.0, kept)?,
                    // A pair at rest meets at no time in particular.
                    false => meeting(&stated.scene, leg.rows(), numbers, None, kept)?,
                });
            }
            if !is_at_start {
                // Certificates have the times of the whole piece.
                let proofs = found.proofs.get(k).filter(|_| [start, end] == [0.0, 1.0]);
                let proofs = proofs.map_or(&[][..], Vec::as_slice);
                leg.evidence = stated.evidence(leg.rows(), until, proofs)?;
            }
            leg.evidence.extend(line);
            legs.push(leg);
            if blocked.is_some() {
                break;
            }
        }
        let span = [0.0, until];
        Ok(Self {
            claim: if is_at_start {
                Claim::Lines
            } else {
                Claim::Apart { span, margin }
            },
            files: Vec::new(),
            scene: stated.scene.clone(),
            legs,
        })
    }

    /// Returns the bodies and a motion without a proof, for a checker that evaluates an older receipt
    /// on them.
    ///
    /// # Errors
    /// Returns an error as [`certified`](Self::certified) does, but for verdicts.
    pub fn scene<C: ConfigurationSpace>(checker: &Checker<C>, motion: &JointMotion) -> Result<Self, ReceiptError> {
        let stated = ReceiptCell::of_motion(checker, motion, 0)?;
        let legs = stated.legs(motion);
        stated.check_legs(legs.len())?;
        let legs = legs.into_iter().map(|(_, _, leg)| leg);
        Ok(Self {
            claim: Claim::Scene,
            files: Vec::new(),
            legs: legs.filter(|leg| leg.rows.is_some()).collect(),
            scene: stated.scene,
        })
    }
}

impl Leg {
    fn rows(&self) -> Option<&[Vec<f64>]> {
        self.rows.as_deref()
    }
}

impl<'a> ReceiptCell<'a> {
    /// Returns the bodies along a segment, or along a whole motion between two times on the clock, whose
    /// configurations have so many coordinates.
    pub(super) fn new<C: ConfigurationSpace>(
        checker: &'a Checker<C>,
        segment: &C::Segment,
        clock: Option<([f64; 2], usize)>,
        fineness: usize,
    ) -> Result<Self, ReceiptError> {
        let cell = &checker.cell;
        let mut obstacles = Obstacles::default();
        let (mut scene, mut ids) = (Scene::default(), Vec::new());
        let identity = Isometry3::identity();
        for (k, (name, geometry)) in cell.robot_bodies().enumerate() {
            add(&mut scene, checker, segment, (name, geometry, fineness), k, &identity)?;
            ids.push(CellBody::Robot(k));
        }
        for (id, object) in cell.attached() {
            let body = cell.body_of(object.frame);
            let named = (object.name.as_str(), &object.geometry, fineness);
            add(&mut scene, checker, segment, named, body, &object.pose)?;
            ids.push(id);
        }
        for (k, obstacle) in cell.obstacles.iter().enumerate() {
            let Some((name, geometry, pose)) = obstacle else {
                continue;
            };
            let id = CellBody::Obstacle(k);
            let way = match (cell.motions.get(&id), clock) {
                (Some(poses), Some((ends, robot))) => obstacles.carry(&mut scene, poses, ends, robot),
                _ => Way::Rests(*pose),
            };
            scene.bodies.push(Body::new(name, geometry, way, fineness)?);
            ids.push(id);
        }
        scene.settle();
        let mut stated = Self {
            scene,
            obstacles,
            ids,
            tube: 0.0,
            pairs: Vec::new(),
            margin: cell.margin(),
        };
        stated.take_pairs(checker);
        Ok(stated)
    }

    /// Returns the bodies of a motion.
    fn of_motion<C: ConfigurationSpace>(
        checker: &'a Checker<C>,
        motion: &JointMotion,
        fineness: usize,
    ) -> Result<Self, ReceiptError> {
        let tube = match motion.tube {
            Tube::None => 0.0,
            Tube::Radius(radius) => checker.widened(radius),
            Tube::Joints(_) => return Err(ReceiptError::Tube),
        };
        // A spline may have times at some of its pieces alone.
        let times: Option<Vec<[f64; 2]>> = (0..motion.pieces()).map(|k| motion.times(k)).collect();
        let clock = times.map(|times| [times[0][0], times[times.len() - 1][1]]);
        match clock {
            Some(ends) => checker.check_poses(ends)?,
            None => checker.cell.check_at_rest()?,
        }
        let first = checker.moved(motion, 0)?;
        for k in 1..motion.pieces() {
            checker.moved(motion, k)?;
        }
        let clock = clock.map(|ends| (ends, motion.control_points(0)[0].len()));
        let mut stated = Self::new(checker, &first, clock, fineness)?;
        stated.tube = tube;
        stated
            .pairs
            .iter_mut()
            .for_each(|(_, kept)| *kept = in_tube(*kept, tube));
        stated.margin = stated.least().unwrap_or(stated.margin);
        Ok(stated)
    }

    /// Returns the legs of all pieces of a motion, each with the number of its piece and the part of the piece's time.
    fn legs(&self, motion: &JointMotion) -> Vec<(usize, [f64; 2], Leg)> {
        let mut all = Vec::new();
        for piece in 0..motion.pieces() {
            let legs = self.obstacles.legs(motion, piece);
            all.extend(legs.into_iter().map(|(part, rows)| {
                let rows = self.scene.is_driven().then_some(rows);
                (
                    piece,
                    part,
                    Leg {
                        rows,
                        evidence: Vec::new(),
                    },
                )
            }));
        }
        all
    }

    /// Refuses several legs of bodies whose motion is stated once, as that along the first.
    fn check_legs(&self, legs: usize) -> Result<(), ReceiptError> {
        let is_steady = |body: &&Body| matches!(body.way, Way::Steady(_));
        let steady = self.scene.bodies.iter().find(is_steady);
        if legs > 1 && (steady.is_some() || !self.scene.is_driven()) {
            let body = steady.or(self.scene.bodies.first());
            return Err(ReceiptError::Motion {
                name: body.map_or(String::new(), |body| body.name.clone()),
                why: "no joint moves it, so each segment needs a separate receipt",
            });
        }
        Ok(())
    }

    /// Sorts the pairs into those that must have evidence and those that are not looked at.
    fn take_pairs<C: ConfigurationSpace>(&mut self, checker: &Checker<C>) {
        let measured = checker.pairs.ordered().into_iter().map(|k| &checker.pairs.all[k]);
        let measured: BTreeMap<CellPair, f64> = measured.map(|tracked| (tracked.pair, tracked.kept)).collect();
        let moves: Vec<bool> = (0..self.ids.len()).map(|k| self.scene.moves(k)).collect();
        for a in 0..self.ids.len() {
            for b in a + 1..self.ids.len() {
                if !(moves[a] || moves[b]) {
                    continue;
                }
                let Some(pair) = CellPair::new(self.ids[a], self.ids[b]) else {
                    let why = TWO_OBSTACLES.into();
                    self.scene.ignored.push(Ignored { pair: [a, b], why });
                    continue;
                };
                if let Some(kept) = measured.get(&pair) {
                    self.pairs.push(([a, b], *kept));
                    continue;
                }
                let is_excluded = checker.cell.excluded.contains_key(&pair);
                let why = if is_excluded { EXCLUDED } else { RIGID }.into();
                self.scene.ignored.push(Ignored { pair: [a, b], why });
            }
        }
        self.margin = self.least().unwrap_or(self.margin);
    }

    /// Returns the least distance that a pair must keep.
    fn least(&self) -> Option<f64> {
        let least = self.pairs.iter().map(|pair| pair.1).fold(f64::INFINITY, f64::smaller);
        least.is_finite().then_some(least)
    }

    /// Leaves out the pairs whose contact at the start was accepted.
    fn leave_out(&mut self, leaving: &[LeavingPair]) {
        for contact in leaving {
            let pair = self.numbers(contact.pair);
            if let Some(place) = self.pairs.iter().position(|one| one.0 == pair) {
                self.pairs.remove(place);
                let why = LEAVING.into();
                self.scene.ignored.push(Ignored { pair, why });
            }
        }
        self.margin = self.least().unwrap_or(self.margin);
    }

    /// Returns the pair of two numbers of bodies.
    pub(super) fn pair(&self, [a, b]: [usize; 2]) -> Option<CellPair> {
        CellPair::new(self.ids[a], self.ids[b])
    }

    /// Returns the numbers of the bodies of a pair.
    fn numbers(&self, pair: CellPair) -> [usize; 2] {
        [pair.a, pair.b].map(|id| self.ids.iter().position(|x| *x == id).unwrap_or_default())
    }

    /// Returns the lines that prove that all pairs stay apart from 0 until a time.
    fn evidence(
        &self,
        rows: Option<&[Vec<f64>]>,
        until: f64,
        proofs: &[PairProof],
    ) -> Result<Vec<String>, ReceiptError> {
        let known: BTreeMap<CellPair, &PairProof> = proofs.iter().map(|proof| (proof.pair, proof)).collect();
        let wanted = self.pairs.iter().map(|(pair, keep)| {
            let of = CellPair::new(self.ids[pair[0]], self.ids[pair[1]]);
            let proof = of.and_then(|pair| known.get(&pair));
            Wanted {
                pair: *pair,
                keep: *keep,
                certificates: proof.map_or(&[], |proof| &proof.certificates),
            }
        });
        let wanted: Vec<Wanted<'_>> = wanted.collect();
        apart(&self.scene, rows, [0.0, until], self.margin, &wanted)
    }
}

/// Adds a body that has a pose in the frame of a body of the space.
fn add<C: ConfigurationSpace>(
    scene: &mut Scene,
    checker: &Checker<C>,
    segment: &C::Segment,
    (name, geometry, fineness): (&str, &Geometry, usize),
    body: usize,
    at: &Isometry3<f64>,
) -> Result<(), ReceiptError> {
    let refused = |why: &'static str| {
        let name = name.into();
        ReceiptError::Motion { name, why }
    };
    let way = match (segment.steady(body), checker.space.joint_path(body)) {
        (Some(steady), _) => {
            let way = SteadyWay::new(&steady, at);
            Way::Steady(way.ok_or_else(|| refused("it has bounds of unknown accelerations"))?)
        }
        (None, Some(path)) => {
            let link = scene.link(&path);
            let link = link.ok_or_else(|| refused("joints of two bodies start at different bases"))?;
            Way::Link(link, (*at != Isometry3::identity()).then_some(*at))
        }
        (None, None) => return Err(refused("its space states neither joints nor constant velocities")),
    };
    scene.bodies.push(Body::new(name, geometry, way, fineness)?);
    Ok(())
}
