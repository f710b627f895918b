//! A compound and another body: every answer must agree with the closest pair of parts, each
//! queried by a new tracker.

use super::Mix;
use super::draw::{Drawn, Part, compound, is_thick, other, rotation};
use crate::exact::{self, Body as ExactBody};
use crate::rng::Rng;
use crate::support::Decide;
use crate::{Point, Pose};
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::scene::{Body, Change, Group, PairQueries, Scene};
use lin_canny::shape::Core;
use lin_canny::{ContactState, PairOutcome, PairTracker, RelativePose, Shape, Velocity};

/// Poses of a pair.
const POSES: usize = 5;

/// Largest width of the bounds of compounds, in units of L: twice the promised width for posed
/// pieces.
const WIDTH: f64 = 3e-13;

/// Largest motion of the parts by poses composed in `f64`, in units of L.
const NOISE: f64 = 2e-14;

/// The result of the parts, in the frame of A.
struct Truth {
    lower: f64,
    upper: f64,
    normal: Vector3<f64>,
    /// Whether the closest pair has a part without thickness.
    is_thin: bool,
}

fn truth(a: &Drawn, b: &Drawn, pose: &Isometry3<f64>) -> Truth {
    let mut best = Truth {
        lower: f64::INFINITY,
        upper: f64::INFINITY,
        normal: Vector3::x(),
        is_thin: false,
    };
    for (p, at_p) in &a.parts {
        for (q, at_q) in &b.parts {
            let placed = RelativePose::new(at_p, &(pose * at_q)).expect("a pose");
            let found = PairTracker::new().closest(p, q, &placed);
            if found.upper < best.upper {
                best.normal = at_p.rotation * found.normal.into_inner();
                best.is_thin = !(is_thick(p) && is_thick(q));
            }
            best.lower = best.lower.min(found.lower);
            best.upper = best.upper.min(found.upper);
        }
    }
    best
}

/// A pair with its reference result.
struct Judged<'a> {
    a: &'a Drawn,
    b: &'a Drawn,
    pose: Isometry3<f64>,
    truth: Truth,
    size: f64,
}

impl<'a> Judged<'a> {
    fn new(a: &'a Drawn, b: &'a Drawn, pose: &Isometry3<f64>) -> Self {
        Self {
            a,
            b,
            pose: *pose,
            truth: truth(a, b, pose),
            size: a.reach + b.reach + pose.translation.vector.norm(),
        }
    }

    fn is_shell(&self) -> bool {
        self.a.is_shell || self.b.is_shell
    }

    /// Returns whether the parts of a surface determine its distance.
    fn is_known(&self) -> bool {
        !self.is_shell() || self.truth.lower > 0.0
    }

    fn wrong(&self, what: &str, found: &dyn std::fmt::Debug) -> String {
        let parts = |d: &Drawn| {
            let one = |p: &Part| {
                let points: Vec<_> = match p.0.core() {
                    Core::Polyhedron(body) => body.vertex_points().collect(),
                    _ => Vec::new(),
                };
                format!("{points:?} {:?}", p.1)
            };
            d.parts.iter().map(one).collect::<Vec<_>>().join("\n")
        };
        let (lower, upper) = (self.truth.lower, self.truth.upper);
        format!(
            "{what}: {found:?}, the parts are {lower:e} to {upper:e} apart, {:?} and {:?} at {:?}\n{}\n{}",
            self.a.geometry.kind(),
            self.b.geometry.kind(),
            self.pose,
            parts(self.a),
            parts(self.b)
        )
    }

    /// Judges bounds and contact state.
    fn judge(&self, found: &PairOutcome, what: &str) -> Result<(), String> {
        let (noise, width) = (NOISE * self.size, WIDTH * self.size);
        let [lower, upper] = [self.truth.lower, self.truth.upper].map(|x| x.max(0.0));
        let is_right = match found.state {
            ContactState::Separated => upper > 0.0 && self.truth.upper > -noise,
            ContactState::Overlapping => lower <= noise,
            _ => self.is_shell() || lower <= width,
        };
        let is_bounded = found.lower.max(0.0) <= upper + noise && lower <= found.upper.max(0.0) + noise;
        let is_close = found.state != ContactState::Separated
            || self.is_shell()
            || found.upper - found.lower <= width + (self.truth.upper - self.truth.lower);
        if is_right && is_bounded && is_close && found.distance.is_finite() {
            Ok(())
        } else {
            Err(self.wrong(what, found))
        }
    }

    /// Judges every query of a tracker, in either order of the pair.
    fn ask(&self, tracker: &mut PairTracker, is_swapped: bool, what: &str) -> Result<(), String> {
        let pose = RelativePose::from_isometry(&self.pose).map_err(|e| e.to_string())?;
        let (a, b, pose) = if is_swapped {
            (&self.b.geometry, &self.a.geometry, pose.swapped())
        } else {
            (&self.a.geometry, &self.b.geometry, pose)
        };
        self.judge(&tracker.closest(a, b, &pose), what)?;
        let (noise, width) = (NOISE * self.size, WIDTH * self.size);
        let (lower, upper) = (self.truth.lower, self.truth.upper);
        if tracker.lower_bound(a, b, &pose) > upper.max(0.0) + noise {
            return Err(self.wrong(what, &"a lower bound"));
        }
        let asked = [
            0.0,
            0.5 * lower,
            lower - 2.0 * width,
            upper + 2.0 * noise,
            2.0 * upper + 0.1,
        ];
        for d in asked.into_iter().filter(|d| *d >= 0.0) {
            let said = tracker.decide(a, b, &pose, d);
            let is_wrong = if upper + noise <= d {
                said.is_no() || !self.is_shell() && !said.is_yes()
            } else if lower - width > d {
                said.is_yes() || !self.is_shell() && !said.is_no()
            } else {
                false
            };
            if is_wrong {
                return Err(self.wrong(what, &(d, said)));
            }
        }
        let meets = tracker.decide(a, b, &pose, 0.0);
        if !self.is_shell() && (lower > width && !meets.is_no() || upper < -noise && !meets.is_yes()) {
            return Err(self.wrong(what, &meets));
        }
        Ok(())
    }

    /// Judges a new tracker by exact arithmetic, if B has no posed parts and no part is curved or a
    /// surface.
    fn ask_exactly(&self) -> Result<bool, String> {
        let is_solid = |p: &Part| matches!(p.0.core(), Core::Polyhedron(body) if body.face_count() > 2);
        let is_asked = self.a.is_sharp
            && self.b.is_sharp
            && self.b.is_in_place
            && !self.is_shell()
            && self.b.parts.iter().all(is_solid);
        if !is_asked {
            return Ok(false);
        }
        let plain = |i: &Isometry3<f64>| {
            let (q, t) = (i.rotation.coords, i.translation.vector);
            Pose::new([q.x, q.y, q.z, q.w], [t.x, t.y, t.z])
        };
        let mut least: Option<exact::Exact> = None;
        for (p, at_p) in &self.a.parts {
            for (q, _) in &self.b.parts {
                let (x, y) = (plain_body(p), plain_body(q));
                let one = ExactBody {
                    points: &x.0,
                    faces: &x.1,
                };
                let two = ExactBody {
                    points: &y.0,
                    faces: &y.1,
                };
                let found = exact::solve(one, &plain(at_p), two, &plain(&self.pose));
                if least.as_ref().is_none_or(|l| found.distance < l.distance) {
                    least = Some(found);
                }
            }
        }
        let Some(least) = least else { return Ok(false) };
        let (low, high) = (least.distance.next_down().max(0.0), least.distance.next_up().max(0.0));
        let pose = RelativePose::from_isometry(&self.pose).map_err(|e| e.to_string())?;
        let (a, b) = (&self.a.geometry, &self.b.geometry);
        let mut tracker = PairTracker::new();
        let found = tracker.closest(a, b, &pose);
        let is_right = match least.state {
            exact::ContactState::Separated => found.state != ContactState::Overlapping,
            exact::ContactState::Touching => {
                found.state != ContactState::Separated && found.state != ContactState::Overlapping
            }
            exact::ContactState::Overlapping => found.state != ContactState::Separated,
        };
        let is_bounded = found.lower.max(0.0) <= high && low <= found.upper.max(0.0);
        if !(is_right && is_bounded) {
            return Err(self.wrong("exactly", &(found, least)));
        }
        let said = tracker.decide(a, b, &pose, high);
        if !said.is_yes() {
            return Err(self.wrong("within, exactly", &(said, least)));
        }
        Ok(true)
    }
}

/// Returns the points and faces of a polyhedron.
fn plain_body(shape: &Shape) -> (Vec<Point>, Vec<Vec<u32>>) {
    let Core::Polyhedron(body) = shape.core() else {
        return Default::default();
    };
    let points = body.vertex_points().map(Into::into).collect();
    let rim = |f| body.face_vertices(f).map(|v| v.index() as u32).collect();
    (points, body.faces().map(rim).collect())
}

/// Plays a compound and another body.
pub(super) fn pair(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix {
        pairs: 1,
        ..Mix::default()
    };
    let (a, b) = (compound(&mut rng, &mut mix), other(&mut rng, &mut mix));
    let (mut there, mut back) = (PairTracker::new(), PairTracker::new());
    let mut pose = Isometry3::from_parts(
        (Vector3::from(rng.in_ball()) * rng.range(0.1, 6.0)).into(),
        rotation(&mut rng),
    );
    for k in 0..POSES {
        let judged = Judged::new(&a, &b, &pose);
        if judged.is_known() {
            judged.ask(&mut there, false, "warm")?;
            judged.ask(&mut back, true, "warm, in the other order")?;
            judged.ask(&mut PairTracker::new(), k % 2 == 1, "cold")?;
            if rng.chance(0.25) {
                mix.exact += u64::from(judged.ask_exactly()?);
            }
            let apart = judged.truth.upper;
            mix.poses += 1;
            mix.thin_is_closest += u64::from(judged.truth.is_thin);
            mix.close += u64::from(judged.truth.lower > 0.0 && apart < 1e-8 * judged.size);
            mix.overlapping += u64::from(apart < -NOISE * judged.size);
        }
        let gap = match rng.below(6) {
            0 => rng.range(-0.1, 0.0),
            1 => rng.log_range(1e-16, 1e-12),
            2 => rng.log_range(1e-12, 1e-3),
            3 => 0.0,
            _ => rng.range(0.0, 1.0),
        };
        if judged.truth.upper.is_finite() {
            pose.translation.vector += judged.truth.normal * (gap - judged.truth.upper);
        }
        if rng.chance(0.2) {
            pose.rotation *= rotation(&mut rng).slerp(&lin_canny::nalgebra::UnitQuaternion::identity(), 0.99);
        }
    }
    if !(a.is_shell || b.is_shell) {
        if rng.chance(0.15) {
            casts(&a, &b, &pose, &mut rng, &mut mix)?;
        }
        if rng.chance(0.15) {
            scene(&a, &b, &pose, &mut rng, &mut mix)?;
        }
    }
    Ok(mix)
}

/// Casts B on a straight path past A.
fn casts(a: &Drawn, b: &Drawn, pose: &Isometry3<f64>, rng: &mut Rng, mix: &mut Mix) -> Result<(), String> {
    let way = Vector3::from(rng.unit());
    let mut start = *pose;
    start.translation.vector -= way * 4.0;
    let path = way * 8.0 + Vector3::from(rng.in_ball()) * 0.3;
    let still = Steady::new(&Isometry3::identity(), Velocity::default()).map_err(|e| e.to_string())?;
    let moving = Steady::new(&start, Velocity::new(path, Vector3::zeros())).map_err(|e| e.to_string())?;
    let mut tracker = PairTracker::new();
    let tolerance = Tolerance::Distance(1e-7);
    let found = cast(
        &mut tracker.pair(&a.geometry, &b.geometry),
        &still,
        &moving,
        0.0..1.0,
        tolerance,
    );
    let found = found.map_err(|e| e.to_string())?.impact;
    let at = |t: f64| {
        let mut now = start;
        now.translation.vector += path * t;
        Judged::new(a, b, &now)
    };
    let safe = match found {
        Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => safe,
        Impact::AtStart { .. } => 0.0,
        _ => 1.0,
    };
    for k in 0..=40 {
        let judged = at(safe * f64::from(k) / 40.0);
        if safe > 0.0 && judged.truth.upper < -1e-9 {
            return Err(judged.wrong("a cast", &(found, k)));
        }
    }
    if let Impact::Hit { hit, .. } = found {
        let judged = at(hit);
        if judged.truth.lower > 1e-7 + 1e-9 {
            return Err(judged.wrong("a cast that hit", &found));
        }
        mix.casts[1] += 1;
    }
    mix.casts[0] += 1;
    Ok(())
}

/// Moves both in a scene, and gives the index of one to another body.
fn scene(a: &Drawn, b: &Drawn, pose: &Isometry3<f64>, rng: &mut Rng, mix: &mut Mix) -> Result<(), String> {
    let text = |e: &dyn std::fmt::Display| e.to_string();
    let group = Group::new(1).ok_or("a group")?;
    let mut queries = PairQueries::none().overlap(true);
    queries.distance = Some(f64::INFINITY);
    let mut scene = Scene::new();
    scene.set_queries(group, group, queries).map_err(|e| text(&e))?;
    let body = |d: &Drawn| Body::moving(d.geometry.clone()).group(group);
    let x = scene.insert(body(a), Isometry3::identity()).map_err(|e| text(&e))?;
    let mut y = scene.insert(body(b), *pose).map_err(|e| text(&e))?;
    let (mut now, mut met, mut spare) = (*pose, false, Mix::default());
    let (mut own, mut replaced);
    let mut b = b;
    for k in 0..6 {
        if k == 3 {
            // Another body at the same index of the tables.
            own = other(rng, &mut spare);
            if own.is_shell {
                break;
            }
            scene.remove(y).map_err(|e| text(&e))?;
            replaced = scene.insert(body(&own), now).map_err(|e| text(&e))?;
            (b, y, met) = (&own, replaced, false);
            mix.reused += 1;
        }
        scene.set_pose(y, now).map_err(|e| text(&e))?;
        scene.step();
        let judged = Judged::new(a, b, &now);
        let said = |change: Change| {
            let mut events = scene.events().iter();
            events.any(|e| e.change == change && (e.a == y || e.b == y))
        };
        let (begun, ended) = (said(Change::OverlapBegan), said(Change::OverlapEnded));
        met = (met || begun) && !ended;
        let (noise, width) = (NOISE * judged.size, WIDTH * judged.size);
        if judged.truth.upper < -noise && !met || judged.truth.lower > width && met {
            return Err(judged.wrong("events of a scene", &met));
        }
        let Some(found) = scene.pair(x, y).and_then(|p| p.distance) else {
            return Err(judged.wrong("a scene without a distance", &k));
        };
        let [lower, upper] = [judged.truth.lower, judged.truth.upper].map(|t| t.max(0.0));
        if found.lower.max(0.0) > upper + noise || lower > found.upper.max(0.0) + noise {
            return Err(judged.wrong("a scene", &found));
        }
        let gap = if rng.chance(0.5) {
            rng.range(-0.1, 0.0)
        } else {
            rng.range(0.0, 1.0)
        };
        now.translation.vector += judged.truth.normal * (gap - judged.truth.upper);
        mix.steps += 1;
    }
    Ok(())
}
