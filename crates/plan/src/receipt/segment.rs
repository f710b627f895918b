//! Receipts of segments and paths.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use super::contact::contact;
use super::error::ReceiptError;
use super::scene::{Body, Ignored, Scene, SteadyWay, Way};
use super::{Claim, Leg, Receipt, Wanted, apart};
use crate::check::checker::{Checker, PairProof};
use crate::check::verdict::Verdict;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::curve::JointCurve;
use crate::motion::space::{ConfigurationSpace, SegmentMotion};
use crate::names::{WorldId, WorldPair};
use lin_canny::Geometry;

/// The reasons of pairs that are not looked at.
pub(super) const EXCLUDED: &str = "excluded";
const RIGID: &str = "the bodies keep their relative pose";

/// The bodies of a world in a receipt.
pub(super) struct Stated {
    pub(super) scene: Scene,
    ids: Vec<WorldId>,
    /// The pairs that must have evidence, and what they must keep.
    pub(super) pairs: Vec<([usize; 2], f64)>,
    margin: f64,
}

impl Receipt {
    /// Returns the receipt of [`Checker::certify`]: that a segment is free, or free up to a time
    /// and blocked by a pair at a later one.
    ///
    /// Along a blocked segment, all pairs have evidence until `safe` of the
    /// [`Verdict::Blocked`], and the pair has four vertex pairs, or two
    /// points, that prove the contact at `t`; if none are certain there, at most 4,096 times the
    /// bracket from `safe` to `t` later. A segment that is blocked at its start has the contact
    /// alone.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid, if the verdict is undecided, if a body or
    /// the motion has no receipt ([module](crate::receipt)), or if a pair has no evidence that a checker
    /// would accept, for example because the pair is in contact at the start.
    pub fn segment<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        from: &[f64],
        to: &[f64],
    ) -> Result<Self, ReceiptError> {
        let segment = checker.segment(from, to)?;
        let verdict = checker.certify(from, to)?;
        Self::judged(checker, &segment, verdict, vec![from.to_vec(), to.to_vec()])
    }

    /// Returns the receipt of [`Checker::certify_curve`], as [`segment`](Self::segment) does.
    ///
    /// The receipt states the control points of the curve ([`JointCurve::control_point`]). If the
    /// curve was given in another form, they are rounded, and the receipt is about them.
    ///
    /// # Errors
    /// Returns an error as [`segment`](Self::segment) does, if the curve is invalid
    /// ([`Checker::certify_curve`]), or if an obstacle moves.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::receipt::Receipt;
    /// use lin_canny_plan::{Checker, Joint, JointCurve, JointTree, World};
    ///
    /// // A block on two rails flies over a post along a parabola.
    /// let origin = Isometry3::identity();
    /// let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// let mut world = World::new();
    /// world.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// world.obstacle("post", post, origin);
    /// let mut checker = Checker::new(block, world)?;
    ///
    /// let curve = JointCurve::bezier(&[[-2.0, 0.0], [0.0, 1.7], [2.0, 0.0]])?;
    /// let receipt = Receipt::curve(&mut checker, &curve)?;
    /// assert!(receipt.to_string().contains("\"claim\":\"apart\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn curve<C: ConfigurationSpace>(checker: &mut Checker<C>, curve: &JointCurve) -> Result<Self, ReceiptError> {
        checker.world.check_at_rest()?;
        let motion = checker.curve(curve)?;
        let verdict = checker.certify_curve(curve)?;
        Self::judged(checker, &motion, verdict, curve.control_points())
    }

    fn judged<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        motion: &C::Segment,
        verdict: Verdict,
        rows: Vec<Vec<f64>>,
    ) -> Result<Self, ReceiptError> {
        let stated = Stated::new(checker, motion)?;
        let (until, blocked) = match verdict {
            Verdict::Free { .. } => (1.0, None),
            Verdict::Blocked { safe, t, pair, .. } => (safe, Some((t, pair))),
            Verdict::Undecided { t } => return Err(ReceiptError::Undecided { time: t }),
        };
        let mut leg = Leg {
            rows: stated.scene.is_driven().then_some(rows),
            evidence: Vec::new(),
        };
        let margin = stated.margin;
        let claim = match blocked {
            Some((t, _)) if !(until > 0.0) || t == 0.0 => Claim::Lines,
            _ => {
                let proofs = checker.proven(motion, until)?.unwrap_or_default();
                leg.evidence = stated.evidence(leg.rows(), until, &proofs)?;
                let span = [0.0, until];
                Claim::Apart { span, margin }
            }
        };
        if let Some((hit, pair)) = blocked {
            let numbers = stated.numbers(pair);
            let kept = checker.world.kept_distance(pair);
            let line = contact(&stated.scene, leg.rows(), numbers, [until, hit], 1.0, kept)?;
            leg.evidence.push(line);
        }
        Ok(Self {
            claim,
            files: Vec::new(),
            scene: stated.scene,
            legs: vec![leg],
        })
    }

    /// Returns the receipt of a path that is free: one leg for each segment, and the scene once.
    ///
    /// # Errors
    /// Returns an error as [`segment`](Self::segment) does; if a segment is not proven free
    /// ([`ReceiptError::Blocked`]); if the path has fewer than two configurations; or if it has
    /// more in a space of a rigid body: such a path has one receipt for each segment.
    pub fn path<C: ConfigurationSpace>(checker: &mut Checker<C>, path: &[Vec<f64>]) -> Result<Self, ReceiptError> {
        let stated = Stated::of_path(checker, path)?;
        let free = |checker: &mut Checker<C>, k: usize| {
            let [from, to] = [&path[k], &path[k + 1]];
            match checker.certify(from, to)?.is_free() {
                true => Ok(checker.prove(from, to)?),
                false => Err(ReceiptError::Blocked { segment: k }),
            }
        };
        let rows = path.windows(2).map(<[_]>::to_vec).collect();
        Self::of_legs(checker, stated, rows, free)
    }

    /// Returns the receipt of a spline that is free, as [`path`](Self::path) does: one leg for each
    /// curve. See [`curve`](Self::curve).
    ///
    /// # Errors
    /// Returns an error as [`curve`](Self::curve) does; if a curve is not proven free
    /// ([`ReceiptError::Blocked`]); or if a curve does not start where the one before ends.
    pub fn spline<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        curves: &[JointCurve],
    ) -> Result<Self, ReceiptError> {
        let stated = Stated::of_spline(checker, curves)?;
        let free = |checker: &mut Checker<C>, k: usize| match checker.certify_curve(&curves[k])?.is_free() {
            true => Ok(checker.prove_curve(&curves[k])?),
            false => Err(ReceiptError::Blocked { segment: k }),
        };
        let rows = curves.iter().map(JointCurve::control_points).collect();
        Self::of_legs(checker, stated, rows, free)
    }

    fn of_legs<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        stated: Stated,
        all: Vec<Vec<Vec<f64>>>,
        free: impl Fn(&mut Checker<C>, usize) -> Result<Option<Vec<PairProof>>, ReceiptError>,
    ) -> Result<Self, ReceiptError> {
        let mut legs = Vec::new();
        for (k, rows) in all.into_iter().enumerate() {
            let proofs = free(checker, k)?.unwrap_or_default();
            let mut leg = Leg {
                rows: stated.scene.is_driven().then_some(rows),
                evidence: Vec::new(),
            };
            leg.evidence = stated.evidence(leg.rows(), 1.0, &proofs)?;
            legs.push(leg);
        }
        Ok(Self {
            claim: Claim::Apart {
                span: [0.0, 1.0],
                margin: stated.margin,
            },
            files: Vec::new(),
            scene: stated.scene,
            legs,
        })
    }

    /// Returns the bodies and a path without a proof, for a checker that evaluates an older receipt
    /// on them.
    ///
    /// # Errors
    /// Returns an error as [`path`](Self::path) does, but for segments that are not free.
    pub fn scene<C: ConfigurationSpace>(checker: &Checker<C>, path: &[Vec<f64>]) -> Result<Self, ReceiptError> {
        let stated = Stated::of_path(checker, path)?;
        Ok(Self::of_scene_alone(stated, path.windows(2).map(<[_]>::to_vec)))
    }

    /// Returns the bodies and a spline without a proof: see [`scene`](Self::scene).
    ///
    /// # Errors
    /// Returns an error as [`spline`](Self::spline) does, but for curves that are not free.
    pub fn spline_scene<C: ConfigurationSpace>(
        checker: &mut Checker<C>,
        curves: &[JointCurve],
    ) -> Result<Self, ReceiptError> {
        let stated = Stated::of_spline(checker, curves)?;
        Ok(Self::of_scene_alone(
            stated,
            curves.iter().map(JointCurve::control_points),
        ))
    }

    fn of_scene_alone(stated: Stated, all: impl Iterator<Item = Vec<Vec<f64>>>) -> Self {
        let is_driven = stated.scene.is_driven();
        let legs = all.filter(|_| is_driven).map(|rows| Leg {
            rows: Some(rows),
            evidence: Vec::new(),
        });
        Self {
            claim: Claim::Scene,
            files: Vec::new(),
            legs: legs.collect(),
            scene: stated.scene,
        }
    }
}

impl Leg {
    fn rows(&self) -> Option<&[Vec<f64>]> {
        self.rows.as_deref()
    }
}

impl Stated {
    pub(super) fn new<C: ConfigurationSpace>(checker: &Checker<C>, segment: &C::Segment) -> Result<Self, ReceiptError> {
        let world = &checker.world;
        let (mut scene, mut ids) = (Scene::default(), Vec::new());
        let identity = Isometry3::identity();
        for (k, (name, geometry)) in world.robot_bodies().enumerate() {
            add(&mut scene, checker, segment, (name, geometry), k, &identity)?;
            ids.push(WorldId::Robot(k));
        }
        for (id, object) in world.attached() {
            let body = world.body_of(object.frame);
            let named = (object.name.as_str(), &object.geometry);
            add(&mut scene, checker, segment, named, body, &object.pose)?;
            ids.push(id);
        }
        for (k, obstacle) in world.obstacles.iter().enumerate() {
            let Some((name, geometry, pose)) = obstacle else {
                continue;
            };
            scene.bodies.push(Body::new(name, geometry, Way::Rests(*pose))?);
            ids.push(WorldId::Obstacle(k));
        }
        scene.settle();
        let mut stated = Self {
            scene,
            ids,
            pairs: Vec::new(),
            margin: world.margin(),
        };
        stated.take_pairs(checker);
        Ok(stated)
    }

    /// Returns the bodies of a path.
    fn of_path<C: ConfigurationSpace>(checker: &Checker<C>, path: &[Vec<f64>]) -> Result<Self, ReceiptError> {
        let [first, second, ..] = path else {
            return Err(PlanError::Empty.into());
        };
        let segment = checker.segment(first, second)?;
        Self::new(checker, &segment)?.of_several(path.len() - 1)
    }

    /// Returns the bodies of a spline.
    fn of_spline<C: ConfigurationSpace>(checker: &mut Checker<C>, curves: &[JointCurve]) -> Result<Self, ReceiptError> {
        let first = curves.first().ok_or(PlanError::Empty)?;
        for (k, pair) in curves.windows(2).enumerate() {
            let (end, start) = (pair[0].end(), pair[1].start());
            if let Some(coordinate) = end.iter().zip(&start).position(|(x, y)| x != y) {
                let index = k + 1;
                return Err(PlanError::CurveJump { index, coordinate }.into());
            }
        }
        checker.world.check_at_rest()?;
        let motion = checker.curve(first)?;
        Self::new(checker, &motion)?.of_several(curves.len())
    }

    /// Refuses several legs of bodies whose motion is stated once, as that along the first.
    fn of_several(self, legs: usize) -> Result<Self, ReceiptError> {
        let stated = self;
        let is_steady = |body: &&Body| matches!(body.way, Way::Steady(_));
        let steady = stated.scene.bodies.iter().find(is_steady);
        if legs > 1 && (steady.is_some() || !stated.scene.is_driven()) {
            let body = steady.or(stated.scene.bodies.first());
            return Err(ReceiptError::Motion {
                name: body.map_or(String::new(), |body| body.name.clone()),
                why: "no joint moves it, so each segment needs a separate receipt",
            });
        }
        Ok(stated)
    }

    /// Sorts the pairs into those that must have evidence and those that are not looked at.
    fn take_pairs<C: ConfigurationSpace>(&mut self, checker: &Checker<C>) {
        let measured = checker.pairs.ordered().into_iter().map(|k| &checker.pairs.all[k]);
        let measured: BTreeMap<WorldPair, f64> = measured.map(|tracked| (tracked.pair, tracked.kept)).collect();
        let moves: Vec<bool> = (0..self.ids.len()).map(|k| self.scene.moves(k)).collect();
        for a in 0..self.ids.len() {
            for b in a + 1..self.ids.len() {
                let Some(pair) = WorldPair::new(self.ids[a], self.ids[b]).filter(|_| moves[a] || moves[b]) else {
                    continue;
                };
                if let Some(kept) = measured.get(&pair) {
                    self.pairs.push(([a, b], *kept));
                    continue;
                }
                let is_excluded = checker.world.excluded.contains(&pair);
                let why = if is_excluded { EXCLUDED } else { RIGID }.into();
                self.scene.ignored.push(Ignored { pair: [a, b], why });
            }
        }
        let least = self.pairs.iter().map(|pair| pair.1).fold(f64::INFINITY, f64::smaller);
        if least.is_finite() {
            self.margin = least;
        }
    }

    /// Returns the pair of two numbers of bodies.
    pub(super) fn pair(&self, [a, b]: [usize; 2]) -> Option<WorldPair> {
        WorldPair::new(self.ids[a], self.ids[b])
    }

    /// Returns the numbers of the bodies of a pair.
    fn numbers(&self, pair: WorldPair) -> [usize; 2] {
        [pair.a, pair.b].map(|id| self.ids.iter().position(|x| *x == id).unwrap_or_default())
    }

    /// Returns the lines that prove that all pairs stay apart from 0 until a time.
    fn evidence(
        &self,
        rows: Option<&[Vec<f64>]>,
        until: f64,
        proofs: &[PairProof],
    ) -> Result<Vec<String>, ReceiptError> {
        let known: BTreeMap<WorldPair, &PairProof> = proofs.iter().map(|proof| (proof.pair, proof)).collect();
        let wanted = self.pairs.iter().map(|(pair, keep)| {
            let of = WorldPair::new(self.ids[pair[0]], self.ids[pair[1]]);
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
    (name, geometry): (&str, &Geometry),
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
    scene.bodies.push(Body::new(name, geometry, way)?);
    Ok(())
}
