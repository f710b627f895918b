//! Curved shapes along random motions; each frame is judged by the duality gap in double-double
//! (`truth::curved`).

use std::panic::{AssertUnwindSafe, catch_unwind};

use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Manifold, ManifoldOptions, Outcome, PairTracker, Shape, Solver};
use truth::Pose;
use truth::curved::{KINDS, Kind, Place, Wide, special, wide};
use truth::motion::{self, Frame};
use truth::pose::{norm, sub};
use truth::rng::Rng;

/// Largest aspect ratio for which the width of bounds is promised, and the promised width, relative
/// to the size of the pair.
const ASPECT: f64 = 30.0;
const WIDTH: f64 = 1e-13;

truth::tally! {
    /// Counts of the curved motions of a run.
    #[derive(Default, Debug)]
    pub(crate) struct Mix {
        pub(crate) frames: u64,
        pub(crate) queries: u64,
        /// Separated, touching, overlapping, undecided.
        pub(crate) classes: [u64; 4],
        /// Frames of separated shapes that a solver after the first one answered.
        pub(crate) beyond: u64,
        /// Frames of pairs with a rounded shape.
        pub(crate) rounded: u64,
        /// Largest width of the bounds of separated shapes, relative to the size of the pair.
        pub(crate) widest: f64,
    }
}

/// A pair of shapes, their cores and rounding radii for the judge, and a motion.
struct Trial {
    cores: [Kind; 2],
    round: [f64; 2],
    shapes: [Shape; 2],
    /// Whether the width of the bounds is promised for this aspect ratio.
    plain: bool,
    frames: Vec<Frame>,
}

fn trial(rng: &mut Rng) -> Trial {
    if rng.chance(0.25) {
        return special_trial(rng);
    }
    let plain = rng.chance(0.9);
    let aspect = rng.log_range(1.0, if plain { ASPECT } else { 1e5 });
    let (first, second) = (*rng.pick(&KINDS), *rng.pick(&KINDS[3..]));
    let mut cores = [Kind::random(first, rng, aspect), Kind::random(second, rng, aspect)];
    if rng.chance(0.5) {
        cores.reverse();
    }
    let mut round = || {
        if rng.chance(0.25) {
            rng.log_range(1e-6, 1.0)
        } else {
            0.0
        }
    };
    let round = [round(), round()];
    let shape = |k: usize| match round[k] {
        0.0 => cores[k].shape(),
        r => cores[k].shape().rounded(r).expect("a rounding is positive"),
    };
    let shapes = [shape(0), shape(1)];
    let frames = moves(&cores, round, rng);
    Trial {
        cores,
        round,
        shapes,
        plain,
        frames,
    }
}

/// Returns sharp shapes at special poses.
///
/// The poses: lowered onto an edge, or near parallel axes.
fn special_trial(rng: &mut Rng) -> Trial {
    let (cores, frames) = if rng.chance(0.5) {
        let (cores, place, side, _) = special::flush_over_edge(rng);
        let lifts = [0.1, 1e-2, 1e-4, 1e-7, 1e-9, 1e-11, 1e-13, 0.0, 0.0];
        let lowered = lifts.map(|lift| Place {
            t: [place.t[0], place.t[1], place.t[2] + side * lift],
            ..place
        });
        (cores, lowered.iter().map(Place::frame).collect())
    } else {
        let (cores, place) = special::about_parallel_axes(rng);
        (cores, vec![place.frame()])
    };
    let shapes = [cores[0].shape(), cores[1].shape()];
    Trial {
        cores,
        round: [0.0; 2],
        shapes,
        plain: true,
        frames,
    }
}

/// Returns a motion that comes near, touches or overlaps.
fn moves(cores: &[Kind; 2], round: [f64; 2], rng: &mut Rng) -> Vec<Frame> {
    let radii = (cores[0].radius() + round[0], cores[1].radius() + round[1]);
    let (sum, small) = (radii.0 + radii.1, radii.0.min(radii.1));
    let n = 40 + rng.below(120);
    let degrees = rng.log_range(1e-3, 30.0);
    let upright = |z: f64| Frame {
        a: Pose::IDENTITY,
        b: Pose::shift([0.0, 0.0, z]),
    };
    let up = |k: usize, z: f64| cores[k].height(&wide([0.0, 0.0, z])).0 + round[k];
    let top = upright(up(0, 1.0) + up(1, -1.0));
    match rng.below(8) {
        0 | 1 => {
            let gaps = (-rng.range(0.0, 0.9) * sum, rng.range(0.0, 0.5) * sum);
            motion::orbit_and_spin(rng, n, degrees, radii, gaps, 100)
        }
        2 => {
            let miss = rng.range(0.0, 1.2) * sum;
            motion::tumble_past(rng, n, degrees, miss, 3.0 * sum)
        }
        3 => {
            let miss = if rng.chance(0.3) {
                0.0
            } else {
                rng.range(0.0, 0.7) * sum
            };
            motion::pass_through(rng, n, radii, miss)
        }
        4 => {
            let (shift, angle) = (small * rng.log_range(1e-17, 1e-2), rng.log_range(1e-17, 1e-2));
            motion::jitter(rng, top, shift, angle, n)
        }
        5 => {
            let axis = if rng.chance(0.5) { [0.0, 0.0, 1.0] } else { rng.unit() };
            motion::spin(if rng.chance(0.7) { top } else { upright(0.0) }, axis, degrees, n)
        }
        6 => {
            let (axis, near) = (rng.unit(), sum * rng.range(0.0, 0.99));
            motion::approach(rng, axis, 1.5 * sum, near, 1e-14, n)
        }
        _ => motion::random_poses(rng, n, radii, (0.0, 1.2), sum),
    }
}

/// Plays one trial. The error is the failure and its frame.
pub(crate) fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let trial = trial(&mut rng);
    let (mut mix, mut pair, mut last) = (Mix::default(), PairTracker::new(), None);
    for (k, frame) in trial.frames.iter().enumerate() {
        let place = Place::of(frame);
        let asked = catch_unwind(AssertUnwindSafe(|| {
            frame_of(&trial, &place, &mut pair, &mut rng, &mut mix)
        }));
        let fault = match asked {
            Ok(Ok(o)) => jump(&trial, last.replace((place, o)).as_ref(), &place, &o),
            Ok(Err(what)) => Some(what),
            Err(_) => Some("a panic".to_owned()),
        };
        if let Some(what) = fault {
            let Trial { cores, round, .. } = &trial;
            return Err(format!("frame {k}: {what}\n{cores:?}, rounded by {round:?}\n{place:?}"));
        }
    }
    Ok(mix)
}

/// Queries one frame with the tracker, and judges the outcome.
fn frame_of(
    trial: &Trial,
    place: &Place,
    pair: &mut PairTracker,
    rng: &mut Rng,
    mix: &mut Mix,
) -> Result<Outcome, String> {
    let [a, b] = &trial.shapes;
    let pose = place.pose();
    let o = pair.closest(a, b, &pose);
    mix.frames += 1;
    mix.queries += 1;
    mix.classes[o.state as usize] += 1;
    mix.beyond += u64::from(o.state == ContactState::Separated && o.solver != Solver::Walk);
    mix.rounded += u64::from(trial.round != [0.0; 2]);
    let fault = judged(trial, place, &o, rng, mix);
    if fault.is_none() && rng.chance(0.125) {
        mix.queries += 5;
        return match others(trial, place, &o, pair) {
            Some(what) => Err(format!("{what}\n{o:?}")),
            None => Ok(o.outcome),
        };
    }
    fault.map_or(Ok(o.outcome), |what| Err(format!("{what}\n{o:?}")))
}

/// Returns the gap, relative to the size of the pair, within which contact state and predicates may
/// be undecided.
fn open_within(trial: &Trial) -> f64 {
    let is_polyhedral = |kind: &Kind| matches!(kind, Kind::Hull(_));
    if trial.cores.iter().all(is_polyhedral) {
        0.0
    } else {
        3e-14
    }
}

/// Returns a contradiction of an outcome with itself or with the judge.
fn judged(trial: &Trial, place: &Place, o: &Outcome, rng: &mut Rng, mix: &mut Mix) -> Option<String> {
    let [a, b] = &trial.cores;
    let round = trial.round[0] + trial.round[1];
    let size = place.size(a, b) + round;
    let slack = 8.0 * f64::EPSILON * size;
    if !(o.lower <= o.distance && o.distance <= o.upper && o.upper.is_finite()) {
        return Some("bounds out of order".into());
    }
    let points = [o.point_on_a, o.point_on_b];
    if points.iter().any(|p| !p.coords.iter().all(|x| x.is_finite())) {
        return Some("a point that is no number".into());
    }
    if (o.normal.norm() - 1.0).abs() > 1e-15 {
        return Some("a normal not of unit length".into());
    }
    let proof = place.height(a, b, &wide((*o.normal).into())).0 - round;
    if o.lower > proof + slack && o.state == ContactState::Overlapping {
        return Some(format!("the normal proves {proof:e} alone"));
    }
    // Any direction gives a lower bound of the true distance.
    let height = |n: [f64; 3]| place.height(a, b, &wide(n)).0 - round;
    let directions = std::iter::repeat_with(|| rng.unit()).take(4);
    let best = directions.map(height).fold(proof, f64::max);
    if best > o.upper + slack {
        return Some(format!("a direction proves {best:e}"));
    }
    if o.state != ContactState::Separated {
        return None;
    }
    let width = (o.upper - o.lower) / size;
    if trial.plain {
        mix.widest = mix.widest.max(width);
    }
    if trial.plain && width > WIDTH {
        return Some(format!("bounds {width:e} L wide"));
    }
    // Witnesses of rounded shapes lie outside the cores by the rounding radius.
    let (_, upper) = place.truth(a, b, o);
    let rounded = round > 0.0;
    (!rounded && (Wide::from(o.lower) - upper).0 > slack).then(|| format!("the points prove {upper:?}"))
}

/// Compares an outcome with other queries that must agree.
fn others(trial: &Trial, place: &Place, o: &Outcome, pair: &mut PairTracker) -> Option<String> {
    let [a, b] = &trial.shapes;
    let pose = place.pose();
    let meet = |p: &Outcome| o.lower <= p.upper && p.lower <= o.upper;
    let cold = PairTracker::new().closest(a, b, &pose);
    if !meet(&cold) {
        return Some(format!("cold: {cold:?}"));
    }
    let swapped = PairTracker::new().closest(b, a, &pose.swapped());
    if !meet(&swapped) {
        return Some(format!("swapped: {swapped:?}"));
    }
    let round = trial.round[0] + trial.round[1];
    let size = place.size(&trial.cores[0], &trial.cores[1]) + round;
    // Predicates compute separate bounds, which may be tighter for shapes that nearly touch.
    let nearly = open_within(trial) * size;
    let (meets, is_apart) = (pair.intersects(a, b, &pose), o.state == ContactState::Separated);
    if meets == is_apart && o.lower > nearly {
        return Some("intersects contradicts the contact state".into());
    }
    if !pair.within(a, b, &pose, o.upper.max(0.0)) {
        return Some("not within the upper bound".into());
    }
    // The predicate computes separate bounds. If they leave the answer open, the answer is yes.
    if trial.plain && o.lower > 0.0 && pair.within(a, b, &pose, o.lower - WIDTH * size) {
        return Some("within less than the lower bound".into());
    }
    if round == 0.0 {
        return contacts(trial, place, size, pair);
    }
    // The distance of a rounded pair is that of the cores less the rounding radii.
    let cores = trial.cores.each_ref().map(Kind::shape);
    let core = PairTracker::new().closest(&cores[0], &cores[1], &pose);
    let slack = 8.0 * f64::EPSILON * size;
    let agree = core.lower - round <= o.upper + slack && o.lower <= core.upper - round + slack;
    (!agree).then(|| format!("the cores: {core:?}"))
}

/// Largest distance of a contact from a shape, relative to the size of the pair.
const ON: f64 = 1e-12;

/// Checks that contacts are on both shapes, and no deeper than the bounds. The judge of hulls
/// takes every point for inside.
fn contacts(trial: &Trial, place: &Place, size: f64, pair: &mut PairTracker) -> Option<String> {
    let [a, b] = &trial.shapes;
    let options = ManifoldOptions::default().prediction(0.02 * size);
    let mut manifold = Manifold::new();
    if let Err(error) = pair.manifold(a, b, &place.pose(), &options, &mut manifold) {
        return Some(format!("no contacts: {error}"));
    }
    manifold.points().iter().find_map(|p| {
        let outside = |k: usize, point: Point3<f64>| trial.cores[k].outside(&wide(point.coords.into()));
        let off = outside(0, p.point_on_a).max(outside(1, p.point_on_b));
        let is_on = off <= ON * size && p.separation >= manifold.lower() - ON * size;
        (!is_on).then(|| format!("a contact {off:e} outside or too deep: {p:?}"))
    })
}

/// Returns an error if the distance changed by more than any point of B moved.
fn jump(trial: &Trial, last: Option<&(Place, Outcome)>, place: &Place, o: &Outcome) -> Option<String> {
    let (old, p) = last?;
    let chord = |sign: f64| {
        let squares = (0..4).map(|k| (place.q[k] - sign * old.q[k]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let reach = trial.cores[1].radius() + trial.round[1];
    let moved = norm(sub(place.t, old.t)) + 2.0 * chord(1.0).min(chord(-1.0)) * reach;
    let slack = moved + 1e-14 * (norm(place.t) + norm(old.t) + reach);
    let jumped = o.lower > p.upper + slack || p.lower > o.upper + slack;
    jumped.then(|| format!("the distance jumped from {:e} to {:e}", p.distance, o.distance))
}
