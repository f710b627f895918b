//! Receipts of two bodies: casts, distances and overlaps; the line of a contact.

use core::ops::Range;

use nalgebra::{Isometry3, Point3, Vector3};

use super::distance::distance;
use super::error::ReceiptError;
use super::number::hex;
use super::parts::{Group, Groups, near_parts};
use super::scene::{Body, Scene, SteadyWay, Way};
use super::taylor::pose;
use super::{Claim, Leg, Receipt, Wanted, apart};
use crate::extremes::Extremes;
use lin_canny::impact::{Impact, Tolerance, cast_with_certificates};
use lin_canny::motion::Steady;
use lin_canny::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use lin_canny::{ContactState, Geometry, Outcome, PairTracker, RelativePose, Tracker};

/// Most pairs of parts that are tried as the place of a contact.
pub(super) const PARTS: usize = 256;

/// Times after a bracket at which a contact is proven if it is not certain at its end, in brackets.
const LATER: [f64; 10] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 256.0, 1024.0, 4096.0];

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
            scene.bodies.push(Body::new(name, geometry, way)?);
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
            scene.bodies.push(Body::new(name, geometry, Way::Rests(at))?);
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

/// Returns the error of a pair at one time.
pub(super) fn missing(scene: &Scene, [a, b]: [usize; 2], time: f64, why: &'static str) -> ReceiptError {
    let [a, b] = [a, b].map(|k| scene.bodies[k].name.clone());
    let (from, until) = (time, time);
    ReceiptError::Pair { a, b, from, until, why }
}

/// Returns the line of a contact in a bracket, at its end or, if no evidence is certain there, at
/// most so many brackets later.
pub(super) fn contact(
    scene: &Scene,
    rows: Option<&[Vec<f64>]>,
    pair: [usize; 2],
    [safe, hit]: [f64; 2],
    last: f64,
    kept: f64,
) -> Result<String, ReceiptError> {
    let first = meeting(scene, rows, pair, Some(hit), kept);
    if first.is_ok() {
        return first;
    }
    let later = LATER.iter().map(|brackets| hit + brackets * (hit - safe));
    let mut later = later.filter(|time| *time <= last);
    let found = later.find_map(|time| meeting(scene, rows, pair, Some(time), kept).ok());
    found.map_or(first, Ok)
}

/// Returns the line that proves that two bodies share a point, or are at most `kept` apart, at a
/// time; without a time if they rest.
pub(super) fn meeting(
    scene: &Scene,
    rows: Option<&[Vec<f64>]>,
    pair: [usize; 2],
    time: Option<f64>,
    kept: f64,
) -> Result<String, ReceiptError> {
    let now = time.unwrap_or(0.0);
    let at = time.map_or(String::new(), |time| format!(",\"at\":\"{}\"", hex(time)));
    let [a, b] = pair;
    let [x, y] = pair.map(|k| pose(&scene.steps(k, rows), now));
    let [first, second] = pair.map(|k| &scene.bodies[k]);
    let refused = |why: &'static str| missing(scene, pair, now, why);
    if first.around.or(second.around).is_some() {
        return Err(refused("a polyhedron around a curved body proves no contact"));
    }
    let relative = RelativePose::new(&x, &y).map_err(|_| refused("a pose is out of range"))?;
    let (groups, reach) = (
        [Groups::new(first), Groups::new(second)],
        kept + first.radius + second.radius,
    );
    let (all, mut near) = ([groups[0].all(), groups[1].all()], Vec::new());
    near_parts(&groups, all, &relative, reach, PARTS, &mut near);
    for [first, second] in &near {
        let mut tracker = Tracker::new();
        tracker.closest(&first.hull, &second.hull, &relative);
        let started = [Tracker::new(), tracker];
        let mut proofs = started
            .iter()
            .map(|start| start.overlap_proof(&first.hull, &second.hull, &relative));
        if let Some(pairs) = proofs.find_map(|proof| proof) {
            let pair = |[i, j]: [VertexId; 2]| format!("[{},{}]", first.points[i.index()], second.points[j.index()]);
            let pairs = pairs.map(pair).join(",");
            return Ok(format!("{{\"meet\":[{a},{b}]{at},\"points\":[{pairs}]}}"));
        }
    }
    let within = hex(kept);
    let mut points = near
        .iter()
        .filter_map(|[x_part, y_part]| points_within([x_part, y_part], [&x, &y], &relative, reach));
    match points.next() {
        Some(on) => Ok(format!(
            "{{\"near\":[{a},{b}],\"within\":\"{within}\",\"on\":[{on}]{at}}}"
        )),
        None => Err(refused("they touch, and no common point is certain")),
    }
}

/// Returns weights of two points, one of each part, that are less than `reach` apart.
pub(super) fn points_within(
    parts: [&Group; 2],
    poses: [&Isometry3<f64>; 2],
    relative: &RelativePose,
    reach: f64,
) -> Option<String> {
    let seen = Tracker::new().closest(&parts[0].hull, &parts[1].hull, relative);
    let on = [
        weights(&parts[0].hull, seen.features.a, &seen.point_on_a),
        weights(&parts[1].hull, seen.features.b, &seen.point_on_b),
    ];
    let point = |k: usize| poses[k] * Point3::from(mean(&parts[k].hull, &on[k]));
    if !((point(0) - point(1)).norm() < reach) {
        return None;
    }
    let named = |k: usize| {
        let on: Vec<_> = on[k].iter().map(|(v, part)| (parts[k].points[*v], *part)).collect();
        weights_text(&on)
    };
    Some([named(0), named(1)].join(","))
}

/// Returns vertices of a feature, and weights whose mean is about a point.
pub(super) fn weights(hull: &ConvexPolyhedron, feature: Feature, point: &Point3<f64>) -> Vec<(usize, f64)> {
    let all: Vec<Point3<f64>> = hull.vertex_points().collect();
    let corners: Vec<usize> = match feature {
        Feature::Vertex(v) => vec![v.index()],
        Feature::Edge(e) => hull
            .edge_vertices(e)
            .map_or(Vec::new(), |ends| ends.map(|v| v.index()).into()),
        Feature::Face(f) => hull.face_vertices(f).map(|v| v.index()).collect(),
    };
    match corners[..] {
        [] => vec![(0, 1.0)],
        [v] => vec![(v, 1.0)],
        [v, w] => {
            let way = all[w] - all[v];
            let part = ((point - all[v]).dot(&way) / way.norm_squared()).clamped(0.0, 1.0);
            vec![(v, 1.0 - part), (w, part)]
        }
        [first, ..] => {
            // The triangle of the fan whose least weight is greatest.
            let mut best = (f64::NEG_INFINITY, vec![(first, 1.0)]);
            for ends in corners[1..].windows(2) {
                let corner = [first, ends[0], ends[1]];
                let (u, v, w) = (
                    all[corner[1]] - all[first],
                    all[corner[2]] - all[first],
                    point - all[first],
                );
                let normal = u.cross(&v);
                let square = normal.norm_squared();
                let [y, z] = [w.cross(&v), u.cross(&w)].map(|part| part.dot(&normal) / square);
                let parts = [1.0 - y - z, y, z];
                let least = parts.iter().copied().fold(f64::INFINITY, f64::smaller);
                if least > best.0 {
                    let each = corner.iter().zip(parts);
                    best = (least, each.map(|(v, part)| (*v, part.at_least(0.0))).collect());
                }
            }
            best.1
        }
    }
}

fn mean(hull: &ConvexPolyhedron, on: &[(usize, f64)]) -> Vector3<f64> {
    let all: Vec<Point3<f64>> = hull.vertex_points().collect();
    let total: f64 = on.iter().map(|x| x.1).sum();
    on.iter().map(|(k, part)| all[*k].coords * (part / total)).sum()
}

pub(super) fn weights_text(on: &[(usize, f64)]) -> String {
    let all: Vec<String> = on.iter().map(|(k, part)| format!("[{k},\"{}\"]", hex(*part))).collect();
    format!("[{}]", all.join(","))
}
