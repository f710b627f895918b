//! Receipts of two bodies: casts, distances and overlaps; the line of a contact.

use core::ops::Range;

use nalgebra::Isometry3;

use super::contact::{contact, meeting, missing};
use super::distance::distance;
use super::error::ReceiptError;
use super::scene::{Body, Scene, SteadyWay, Way};
use super::stated::FINENESS;
use super::{Claim, Leg, Receipt, Wanted, apart};
use lin_canny::impact::{Impact, Tolerance, cast_with_certificates};
use lin_canny::motion::Steady;
use lin_canny::{ContactState, Geometry, GeometryKind, Outcome, PairTracker, RelativePose};

impl Receipt {
    /// Returns the receipt of a cast: a miss, or apart up to a time and a contact at a later one.
    ///
    /// Casts two bodies, each with its name, at constant velocities over an interval as
    /// [`impact::cast_within`](lin_canny::impact::cast_within) does. `margin` is the distance that
    /// they must keep.
    ///
    /// # Errors
    /// Returns an error if the cast is invalid or undecided, if a body or a motion has no receipt
    /// ([module](crate::receipt)), or if the pair has no evidence that a checker would accept.
    ///
    /// ```
    /// use lin_canny::impact::Tolerance;
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Geometry, Velocity};
    /// use lin_canny_plan::receipt::Receipt;
    ///
    /// let die = Geometry::from(solids::cuboid(Vector3::repeat(0.5))?);
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let spin = Velocity::new(-Vector3::x(), Vector3::z());
    /// let rest = Steady::new(&at(0.0), Velocity::default())?;
    /// let flight = Steady::new(&at(3.0), spin)?;
    /// let bodies = [("rest", &die), ("flight", &die)];
    /// let (motions, tolerance) = ([&rest, &flight], Tolerance::Distance(1e-6));
    /// let receipt = Receipt::cast(bodies, motions, 0.0..1.0, tolerance, 0.0)?;
    /// assert!(receipt.to_string().contains("\"claim\":\"apart\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cast(
        bodies: [(&str, &Geometry); 2],
        motions: [&Steady; 2],
        interval: Range<f64>,
        tolerance: Tolerance,
        margin: f64,
    ) -> Result<Self, ReceiptError> {
        let mut receipt = Self::cast_with(bodies, motions, interval.clone(), tolerance, margin, 0);
        for fineness in 1..FINENESS {
            let is_coarse = bodies
                .iter()
                .any(|(_, body)| body.kind() == GeometryKind::BezierSurface);
            if !(is_coarse && matches!(receipt, Err(ReceiptError::Pair { .. }))) {
                break;
            }
            receipt = Self::cast_with(bodies, motions, interval.clone(), tolerance, margin, fineness);
        }
        receipt
    }

    fn cast_with(
        bodies: [(&str, &Geometry); 2],
        motions: [&Steady; 2],
        interval: Range<f64>,
        tolerance: Tolerance,
        margin: f64,
        fineness: usize,
    ) -> Result<Self, ReceiptError> {
        let identity = Isometry3::identity();
        let mut ways = Vec::new();
        for ((name, _), motion) in bodies.iter().zip(motions) {
            let way = SteadyWay::new(motion, &identity).ok_or_else(|| ReceiptError::Motion {
                name: (*name).into(),
                why: "it has bounds of unknown accelerations",
            })?;
            ways.push(way);
        }
        // One of two bodies moves, even if both have no velocity.
        let all_still = ways.iter().all(SteadyWay::is_still);
        let mut scene = Scene::default();
        for ((name, geometry), way) in bodies.iter().zip(ways) {
            let way = match way.is_still() && !all_still {
                true => Way::Rests(way.start()),
                false => Way::Steady(way),
            };
            scene.bodies.push(Body::new(name, geometry, way, fineness)?);
        }
        let mut certificates = Vec::new();
        let mut tracker = PairTracker::new();
        let mut pair = tracker.pair(bodies[0].1, bodies[1].1);
        let [a, b] = motions;
        let found = cast_with_certificates(&mut pair, a, b, interval.clone(), tolerance, margin, &mut certificates)?;
        let (until, bracket) = match found.impact {
            Impact::Miss => (Some(interval.end), None),
            Impact::Hit { safe, hit, .. } => (Some(safe), Some([safe, hit])),
            Impact::AtStart { .. } => (None, Some([interval.start; 2])),
            Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
                return Err(ReceiptError::Undecided { time: safe });
            }
            _ => return Err(ReceiptError::Undecided { time: interval.start }),
        };
        let (mut evidence, mut claim) = (Vec::new(), Claim::Lines);
        if let Some(until) = until {
            let span = [interval.start, until];
            let wanted = Wanted {
                pair: [0, 1],
                keep: margin,
                certificates: &certificates,
            };
            evidence = apart(&scene, None, span, margin, &[wanted])?;
            claim = Claim::Apart { span, margin };
        }
        if let Some(bracket) = bracket {
            evidence.push(contact(&scene, None, [0, 1], bracket, interval.end, margin)?);
        }
        Ok(Self::of_scene(claim, scene, evidence))
    }

    /// Returns the receipt of an outcome of two bodies: both bounds of a distance, or that they share
    /// a point.
    ///
    /// `b_in_a` is the pose of B in the frame of A, for which the outcome was computed.
    ///
    /// Of meshes and compounds, both bounds of a distance are wider than those of the outcome by 1e-12
    /// of the greatest coordinate, because each group of parts has a plane whose normal rounds. The
    /// distance of a closed mesh is that of its surface.
    ///
    /// # Errors
    /// Returns an error if a body has no receipt ([module](crate::receipt)), if no evidence is certain,
    /// for example because the bodies touch, or if a distance takes more than 20,000 planes.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Geometry, RelativePose, Tracker};
    /// use lin_canny_plan::receipt::Receipt;
    ///
    /// let (a, b) = (solids::octahedron(0.5)?, solids::icosahedron(0.5)?);
    /// let at = Isometry3::new(Vector3::new(2.0, 0.3, 0.1), Vector3::y());
    /// let pose = RelativePose::from_isometry(&at)?;
    /// let outcome = Tracker::new().closest(&a, &b, &pose);
    /// let (a, b) = (Geometry::from(a), Geometry::from(b));
    /// let receipt = Receipt::outcome([("a", &a), ("b", &b)], &at, &outcome)?;
    /// assert!(receipt.to_string().contains("{\"distance\":[0,1],\"lower\":"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn outcome(
        bodies: [(&str, &Geometry); 2],
        b_in_a: &Isometry3<f64>,
        outcome: &Outcome,
    ) -> Result<Self, ReceiptError> {
        let mut scene = Scene::default();
        let poses = [Isometry3::identity(), *b_in_a];
        for ((name, geometry), at) in bodies.iter().zip(poses) {
            scene.bodies.push(Body::new(name, geometry, Way::Rests(at), 0)?);
        }
        let line = match outcome.state {
            ContactState::Separated => RelativePose::from_isometry(b_in_a)
                .map_err(|_| missing(&scene, [0, 1], 0.0, "the pose is out of range"))
                .and_then(|relative| {
                    let poses = [&poses[0], b_in_a];
                    distance(&scene, [0, 1], poses, &relative, [outcome.lower, outcome.upper])
                }),
            _ => meeting(&scene, None, [0, 1], None, 0.0),
        };
        let line = line?;
        Ok(Self::of_scene(Claim::Lines, scene, vec![line]))
    }

    pub(super) fn of_scene(claim: Claim, scene: Scene, evidence: Vec<String>) -> Self {
        Self {
            claim,
            files: Vec::new(),
            scene,
            legs: vec![Leg { rows: None, evidence }],
        }
    }
}
