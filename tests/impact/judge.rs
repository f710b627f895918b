//! Judges a cast by dense predicates and by conservative advancement.

use lin_canny::impact::{Cast, Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};
use truth::casts::{Advance, Throw, advance};

/// Counts of the results.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) starts: u32,
    pub(crate) hits: u32,
    pub(crate) misses: u32,
    pub(crate) near: u32,
    pub(crate) unknown: u32,
    /// Queries of hits with rotations of at most one radian, and of at most six.
    pub(crate) queries: [Vec<u32>; 2],
    /// Number of misses that needed queries, and their queries.
    pub(crate) of_misses: (u64, u64),
    pub(crate) widest: f64,
    pub(crate) advanced: u32,
}

impl std::fmt::Debug for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} starts, {} hits, {} misses ({} with queries, {} of these), {} near, {} unknown; queries a hit {:?}; widest {:e}; {} advanced",
            self.starts,
            self.hits,
            self.misses,
            self.of_misses.0,
            self.of_misses.1,
            self.near,
            self.unknown,
            self.medians(),
            self.widest,
            self.advanced
        )
    }
}

impl Tally {
    pub(crate) fn medians(&self) -> [u32; 2] {
        self.queries.clone().map(|mut q| {
            q.sort_unstable();
            if q.is_empty() { 0 } else { q[q.len() / 2] }
        })
    }
}

pub(crate) struct Judge<'a> {
    bodies: [&'a ConvexPolyhedron; 2],
    motions: [Steady; 2],
    throw: Throw,
    name: String,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(bodies: [&'a ConvexPolyhedron; 2], throw: Throw, name: String) -> Self {
        let motions = throw.motions();
        Self {
            bodies,
            motions,
            throw,
            name,
        }
    }

    pub(crate) fn meets(&self, tracker: &mut Tracker, time: f64) -> bool {
        let [a, b] = &self.motions;
        let relative = RelativePose::new(&a.pose(time), &b.pose(time)).expect("a pose");
        tracker.intersects(self.bodies[0], self.bodies[1], &relative)
    }

    /// Asserts that the bodies are separated at instants up to `safe`: evenly spread, and closer
    /// and closer to the end.
    pub(crate) fn free(&self, safe: f64, instants: usize) {
        let mut tracker = Tracker::new();
        let evenly = (0..instants).map(|k| safe * k as f64 / instants as f64);
        let nearer = (0..30).map(|k| safe - safe * 0.5f64.powi(2 * k));
        for time in evenly.chain(nearer).chain([safe]) {
            assert!(
                !self.meets(&mut tracker, time),
                "{}: contact at {time}, safe {safe}",
                self.name
            );
        }
    }

    /// Casts and judges; `turn` is the largest rotation of the family.
    pub(crate) fn cast(&self, tolerance: Tolerance, instants: usize, turn: f64, tally: &mut Tally) -> Cast {
        let [a, b] = &self.motions;
        let cast = cast(
            &mut Tracker::new().pair(self.bodies[0], self.bodies[1]),
            a,
            b,
            0.0..1.0,
            tolerance,
        )
        .expect("a cast");
        let name = &self.name;
        let other = self.advance(turn, tally);
        match cast.impact {
            Impact::Hit { safe, hit, .. } => {
                tally.hits += 1;
                assert!(0.0 <= safe && safe < hit && hit <= 1.0, "{name}: {cast:?}");
                self.free(safe, instants);
                assert!(self.meets(&mut Tracker::new(), hit), "{name}: nothing meets at {hit}");
                tally.widest = tally.widest.max(hit - safe);
                if turn <= 6.0 {
                    tally.queries[usize::from(turn > 1.0)].push(cast.queries);
                }
                match other {
                    Some(Advance::Near(time) | Advance::Limit(time)) => assert!(time <= hit, "{name}: {hit} {other:?}"),
                    Some(Advance::Miss | Advance::Start) => panic!("{name}: {cast:?} {other:?}"),
                    None => {}
                }
            }
            Impact::Miss => {
                tally.misses += 1;
                tally.of_misses.0 += u64::from(cast.queries > 0);
                tally.of_misses.1 += u64::from(cast.queries);
                self.free(1.0, instants);
                assert_ne!(other, Some(Advance::Start), "{name}");
                if let Some(Advance::Near(time)) = other {
                    let mut tracker = Tracker::new();
                    let close = (0..1000).map(|k| (time + 1e-5 * f64::from(k)).min(1.0));
                    close.for_each(|t| assert!(!self.meets(&mut tracker, t), "{name}: contact at {t}"));
                }
            }
            Impact::AtStart { .. } => {
                tally.starts += 1;
                assert!(self.meets(&mut Tracker::new(), 0.0), "{name}");
            }
            Impact::Undecided { safe, .. } => {
                tally.near += 1;
                self.free(safe, instants);
            }
            Impact::Incomplete { safe } => {
                tally.unknown += 1;
                self.free(safe, instants);
            }
            _ => panic!("{name}: {cast:?}"),
        }
        cast
    }

    fn advance(&self, turn: f64, tally: &mut Tally) -> Option<Advance> {
        if turn > 60.0 {
            return None;
        }
        tally.advanced += 1;
        Some(advance(self.bodies, &self.throw, 1e-6, 400).0)
    }
}
