//! The engines and their levels, all with the same interface.
//!
//! Each gets two world poses and returns the distance and, if the level computes them, both witness
//! points in the world frame.

use std::hint::black_box;
use std::rc::Rc;
use std::time::Duration;

use cpu_time::ThreadTime;
use lin_canny::{RelativePose, Tracker, TrackerWork};
use race::parry_f32;
use truth::Point;
use truth::pairs::Pair;
use truth::parry::GjkCached;

/// Shortest time for which a case runs before a pass counts.
const WARM_UP: Duration = Duration::from_millis(2);

/// A level of accuracy of an engine.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Accuracy {
    /// `Tracker::propose`.
    Walk,
    /// `Tracker::closest`.
    Certified,
    /// `Tracker::closest_exact`.
    Exact,
    /// parry's GJK over a hill-climbing support map, with a cached simplex.
    Gjk,
    /// parry's closest points, in `f64` and in `f32`.
    Parry,
    ParryF32,
}

/// A level, warm (from the features of the previous frame) or cold.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Case {
    pub(crate) level: Accuracy,
    pub(crate) cold: bool,
}

impl Case {
    pub(crate) const fn warm(level: Accuracy) -> Self {
        Self { level, cold: false }
    }

    pub(crate) const fn cold(level: Accuracy) -> Self {
        Self { level, cold: true }
    }

    pub(crate) fn engine(self) -> &'static str {
        match (self.level, self.cold) {
            (Accuracy::Gjk, false) => "gjk-cached",
            (Accuracy::Gjk, true) => "gjk-cold",
            (Accuracy::Parry, _) => "parry-f64",
            (Accuracy::ParryF32, _) => "parry-f32",
            (_, false) => "ours",
            (_, true) => "ours-cold",
        }
    }

    pub(crate) fn name(self) -> String {
        match self.level {
            Accuracy::Walk => "walk".into(),
            Accuracy::Certified => "certified".into(),
            Accuracy::Exact => "exact".into(),
            Accuracy::Gjk => "closest".into(),
            Accuracy::Parry | Accuracy::ParryF32 => "distance".into(),
        }
    }

    /// Returns whether the engine could build the bodies.
    pub(crate) fn takes(self, pair: &Pair) -> bool {
        match self.level {
            Accuracy::Parry => pair.a.parry.is_some() && pair.b.parry.is_some(),
            Accuracy::ParryF32 => State::new(self, pair).narrow.is_some(),
            _ => true,
        }
    }
}

/// Distance and witnesses in the world frame; NaN if an engine has no answer.
pub(crate) type Answer = (f64, Point, Point);

const NONE: Answer = (f64::NAN, [0.0; 3], [0.0; 3]);

/// The state that a case keeps for its pair.
#[derive(Default, Clone)]
pub(crate) struct State {
    tracker: Tracker,
    gjk: GjkCached,
    /// Both bodies in single precision, if the case needs them and parry can build them.
    narrow: Option<Rc<[parry_f32::Hull; 2]>>,
}

impl State {
    fn new(case: Case, pair: &Pair) -> Self {
        let hull = |body: &truth::pairs::Body| parry_f32::mesh(&body.points, &body.faces);
        let narrow = match case.level {
            Accuracy::ParryF32 => hull(&pair.a).zip(hull(&pair.b)).map(|(a, b)| Rc::new([a, b])),
            _ => None,
        };
        Self {
            narrow,
            ..Self::default()
        }
    }
}

/// Runs one query of one case.
#[inline(always)]
pub(crate) fn ask(case: Case, pair: &Pair, frame: usize, state: &mut State) -> Answer {
    if case.cold {
        state.tracker = Tracker::new();
        state.gjk = GjkCached::default();
    }
    let (a, b) = (&pair.a.ours, &pair.b.ours);
    let (pa, pb) = &pair.isometries[frame];
    let f = &pair.frames[frame];
    let witnesses =
        |w: Option<truth::parry::Witnesses>| w.map_or((0.0, [0.0; 3], [0.0; 3]), |w| (w.distance, w.on_a, w.on_b));
    match case.level {
        Accuracy::Gjk => witnesses(state.gjk.closest(&pair.a.climber, &f.a, &pair.b.climber, &f.b)),
        Accuracy::Parry => match (&pair.a.parry, &pair.b.parry) {
            (Some(a), Some(b)) => witnesses(truth::parry::closest_points(a, &f.a, b, &f.b)),
            _ => NONE,
        },
        Accuracy::ParryF32 => match state.narrow.as_deref() {
            Some([a, b]) => witnesses(parry_f32::closest_points(a, &f.a, b, &f.b)),
            None => NONE,
        },
        ours => {
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return NONE;
            };
            let o = match ours {
                Accuracy::Walk => {
                    let p = state.tracker.propose(a, b, &relative);
                    let d = p.distance.unwrap_or(0.0);
                    return (d, (pa * p.point_on_a).into(), (pb * p.point_on_b).into());
                }
                Accuracy::Exact => state.tracker.closest_exact(a, b, &relative),
                _ => state.tracker.closest(a, b, &relative),
            };
            (o.distance, (pa * o.point_on_a).into(), (pb * o.point_on_b).into())
        }
    }
}

/// Returns the answers of a whole motion, and the work counters of the tracker.
pub(crate) fn answers(case: Case, pair: &Pair) -> (Vec<Answer>, TrackerWork) {
    let mut state = State::new(case, pair);
    let list = (0..pair.frames.len()).map(|f| ask(case, pair, f, &mut state)).collect();
    (list, state.tracker.work())
}

/// Returns nanoseconds per query over the first frames of a motion, as many as fit into 4 ms.
pub(crate) fn time(case: Case, pair: &Pair) -> f64 {
    // Each level is compiled as a separate loop.
    match case.level {
        Accuracy::Walk => pass(case, Accuracy::Walk, pair),
        Accuracy::Certified => pass(case, Accuracy::Certified, pair),
        Accuracy::Exact => pass(case, Accuracy::Exact, pair),
        Accuracy::Gjk => pass(case, Accuracy::Gjk, pair),
        Accuracy::Parry => pass(case, Accuracy::Parry, pair),
        Accuracy::ParryF32 => pass(case, Accuracy::ParryF32, pair),
    }
}

/// Times one case. `level` is the level of the case, and a constant in the inlined loop.
#[inline(always)]
fn pass(case: Case, level: Accuracy, pair: &Pair) -> f64 {
    let fresh = State::new(case, pair);
    clocked(
        pair.frames.len(),
        || fresh.clone(),
        |f, s| ask(Case { level, ..case }, pair, f, s),
    )
}

/// Returns nanoseconds of processor time per query.
///
/// The first passes warm up caches and branch predictors after another engine; only the last pass
/// counts.
#[inline(always)]
pub(crate) fn clocked<S, A>(frames: usize, fresh: impl Fn() -> S, ask: impl Fn(usize, &mut S) -> A) -> f64 {
    clocked_within(2 * WARM_UP, frames, fresh, ask)
}

/// Times as many frames as fit into `time`, so many that the first search of a tracking engine has
/// no weight.
#[inline(always)]
pub(crate) fn clocked_within<S, A>(
    time: Duration,
    frames: usize,
    fresh: impl Fn() -> S,
    ask: impl Fn(usize, &mut S) -> A,
) -> f64 {
    let run = |frames: usize| {
        let mut state = fresh();
        let began = ThreadTime::now();
        for f in 0..frames {
            black_box(ask(f, &mut state));
        }
        began.elapsed()
    };
    // A slow engine gets fewer frames.
    let first = run(frames.min(16)).as_nanos().max(1) as usize / 16;
    let frames = (time.as_nanos() as usize / first.max(1))
        .clamp(16, frames.max(16))
        .min(frames);
    let began = ThreadTime::now();
    while began.elapsed() < WARM_UP {
        run(frames);
    }
    run(frames).as_nanos() as f64 / frames as f64
}
