//! Search for the first contact of two elements: a vertex and a face, two edges or two triangles.
//!
//! 1. An interval of time that no direction proves is halved.
//! 2. In floating point, a crossing is proven by the signs of volumes.
//! 3. Exact arithmetic decides the rest.

use nalgebra::Vector3;

use super::paths::{FourVertices, Parts, VertexPath, VertexPaths, VertexPlaces, volume_sign, volumes};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, ByValue, Extremes};
use crate::base::num::sort::sort;
use crate::nonconvex::query::triangle::Triangle;

/// Smallest interval of time in which the search for vertices on straight paths is continued before
/// exact arithmetic decides.
const PATH_WIDTH: f64 = 1.0 / (1u64 << 20) as f64;

/// Largest number of time intervals for a vertex and a face or for two edges.
const PATH_INTERVALS: u32 = 128;

/// Number of bits beyond which an integer of an exact decision counts as wide. If coordinates
/// differ by fewer than twenty orders of magnitude, no integer is wide.
#[cfg(feature = "exact")]
const WIDE: usize = 1024;

/// Largest number of products of words of wide integers in the exact decisions of one call. Beyond
/// it, exact decisions return an open result.
#[cfg(feature = "exact")]
const WIDE_WORK: u64 = 100_000_000;

/// Largest number of rounds in which the interval around the root of a volume is narrowed.
const PATH_ROUNDS: u32 = 32;

/// Smallest width of a bracket: a few roundings of times near one.
pub(super) const LEAST_WIDTH: f64 = 4.0 * f64::EPSILON;

/// Result of a search for a first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FirstContact {
    /// Separated from time zero to the end of the searched time.
    Miss,
    /// The parts are in contact at time zero.
    Start,
    /// Separated until `safe`; the first contact is not after `hit`.
    Hit { safe: f64, hit: f64 },
    /// Separated until `safe`, where zero proves nothing. Nothing is known of later times.
    Open { safe: f64 },
}

/// The work of a search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchWork {
    /// Number of time intervals tried.
    pub(super) intervals: u32,
    /// Number of attempts to prove a crossing, and of exact decisions.
    pub(super) proofs: u32,
    /// Work of exact decisions on wide integers.
    pub(super) wide: WideWork,
}

/// Work of exact decisions on wide integers, in products of words.
///
/// Paths whose coordinates differ by a few orders of magnitude never count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WideWork(u64);

#[cfg(feature = "exact")]
impl WideWork {
    /// Counts operations on two integers with these numbers of bits.
    ///
    /// Returns `None` if the budget is spent.
    pub(super) fn count(&mut self, operations: usize, [one, other]: [usize; 2]) -> Option<()> {
        if one.max(other) > WIDE {
            let words = |bits: usize| bits as u64 / 64 + 1;
            let work = words(one)
                .saturating_mul(words(other))
                .saturating_mul(operations as u64);
            self.0 = self.0.saturating_add(work);
        }
        self.left()
    }

    /// Returns `None` if the budget is used up.
    pub(super) fn left(self) -> Option<()> {
        (self.0 <= WIDE_WORK).then_some(())
    }
}

/// Returns the first contact of a vertex and a face or of two edges before `until`.
///
/// The bracket is at most `width` wide if rounding allows.
pub(super) fn first_contact<const A: usize, const B: usize>(
    paths: &VertexPaths<A, B>,
    until: f64,
    width: f64,
    work: &mut SearchWork,
) -> FirstContact
where
    VertexPlaces<A, B>: FourVertices,
{
    search(paths, until, PATH_INTERVALS, work, |[s, e], [x, y], work| {
        work.proofs = work.proofs.saturating_add(1);
        let [n, _] = paths.at(0.5 * (s + e)).normals();
        if !VertexPlaces::is_over([x, y], &n) {
            return None;
        }
        let volumes = volumes(x, y);
        let signs = volumes.each(volume_sign);
        // If both inner coefficients may differ in sign from the outer ones next to them, the cubic
        // may have three roots.
        let is_single = signs[1] == signs[0] || signs[2] == signs[3];
        (signs[0] * signs[3] == -1 && (is_single || e - s <= width.at_least(PATH_WIDTH))).then(|| {
            let [safe, hit] = if is_single {
                narrow(paths, [s, e], volumes, width.at_least(LEAST_WIDTH))
            } else {
                [s, e]
            };
            FirstContact::Hit { safe, hit }
        })
    })
}

/// Halves the time until a direction separates the pair in every interval, or `settle` returns a
/// result.
pub(super) fn search<const A: usize, const B: usize>(
    paths: &VertexPaths<A, B>,
    until: f64,
    limit: u32,
    work: &mut SearchWork,
    mut settle: impl FnMut([f64; 2], [&VertexPlaces<A, B>; 2], &mut SearchWork) -> Option<FirstContact>,
) -> FirstContact
where
    VertexPlaces<A, B>: Parts,
{
    let (mut safe, mut tried) = (0.0, 0);
    // The ends of the following intervals, the next one last.
    let mut ends = [until; 64];
    let mut count = 1;
    let mut x = paths.at(0.0);
    while count > 0 {
        let end = ends[count - 1];
        let y = paths.at(end);
        tried += 1;
        work.intervals = work.intervals.saturating_add(1);
        if is_free(paths, [safe, end], [&x, &y]) {
            (safe, x) = (end, y);
            count -= 1;
            continue;
        }
        if let Some(found) = settle([safe, end], [&x, &y], work) {
            return found;
        }
        let middle = 0.5 * (safe + end);
        if end - safe <= PATH_WIDTH || tried >= limit || count == ends.len() {
            return FirstContact::Open { safe };
        }
        ends[count] = middle;
        count += 1;
    }
    FirstContact::Miss
}

/// Returns whether the pair is proven separated between two times.
///
/// The proof is a direction, or that the four vertices never lie in one plane.
pub(super) fn is_free<const A: usize, const B: usize>(
    paths: &VertexPaths<A, B>,
    [s, e]: [f64; 2],
    both: [&VertexPlaces<A, B>; 2],
) -> bool
where
    VertexPlaces<A, B>: Parts,
{
    let middle = paths.at(0.5 * (s + e));
    let is_parted = |n: &Vector3<f64>| paths.are_parted(both, n);
    is_parted(&middle.toward())
        || is_parted(&both[0].toward())
        || is_parted(&both[1].toward())
        || middle.normals().iter().any(is_parted)
        || paths.are_straight() && VertexPlaces::is_never_flat(both)
}

/// Narrows an interval in which the volume has one root, and the pair is in contact only there.
///
/// Uses the secant method with a step to each side of each estimate.
fn narrow<const A: usize, const B: usize>(
    paths: &VertexPaths<A, B>,
    [mut low, mut high]: [f64; 2],
    [mut at_low, _, _, mut at_high]: [f64; 4],
    width: f64,
) -> [f64; 2]
where
    VertexPlaces<A, B>: FourVertices,
{
    let first = volume_sign(at_low);
    let mut side = 0.375 * width;
    for round in 0..PATH_ROUNDS {
        if high - low <= width {
            break;
        }
        let root = if round % 4 == 3 {
            0.5 * (low + high)
        } else {
            low + (high - low) * (at_low / (at_low - at_high))
        };
        let before = [low, high];
        for time in [root - side, root + side] {
            if !(low < time && time < high) {
                continue;
            }
            let x = paths.at(time);
            let volume = VertexPlaces::volume([&x, &x, &x]);
            let sign = volume_sign(volume);
            if sign == first {
                (low, at_low) = (time, volume);
            } else if sign == -first {
                (high, at_high) = (time, volume);
            }
        }
        if before == [low, high] {
            side *= 8.0;
        }
    }
    [low, high]
}

/// Largest number of time intervals for a pair of triangles as a whole. If they are not enough, its
/// vertices, edges and faces are tested pair by pair.
const TRIANGLE_INTERVALS: u32 = 12;

/// Returns the first contact of a vertex and a face, in a bracket of `width` if rounding allows.
#[cfg(feature = "__internals")]
pub(super) fn vertex_face(
    vertex: &[VertexPath; 1],
    face: &[VertexPath; 3],
    width: f64,
    work: &mut SearchWork,
) -> FirstContact {
    let found = vertex_face_until(vertex, face, 1.0, width, work);
    decided(found, width, work, |wide| exact_vertex_face(vertex, face, width, wide))
}

/// Returns the first contact of two edges, in a bracket of `width` if rounding allows.
#[cfg(feature = "__internals")]
pub(super) fn edge_edge(a: &[VertexPath; 2], b: &[VertexPath; 2], width: f64, work: &mut SearchWork) -> FirstContact {
    let found = edge_edge_until(a, b, 1.0, width, work);
    decided(found, width, work, |wide| exact_edge_edge(a, b, width, wide))
}

fn vertex_face_until(
    vertex: &[VertexPath; 1],
    face: &[VertexPath; 3],
    until: f64,
    width: f64,
    work: &mut SearchWork,
) -> FirstContact {
    VertexPaths::new(vertex, face).map_or(FirstContact::Start, |paths| first_contact(&paths, until, width, work))
}

fn edge_edge_until(
    a: &[VertexPath; 2],
    b: &[VertexPath; 2],
    until: f64,
    width: f64,
    work: &mut SearchWork,
) -> FirstContact {
    VertexPaths::new(a, b).map_or(FirstContact::Start, |paths| first_contact(&paths, until, width, work))
}

/// Returns the time until which an unsettled pair is separated; `None` if the pair is settled.
///
/// A pair is unsettled if it is open or if rounding keeps its bracket wide.
fn unsettled(found: FirstContact, width: f64) -> Option<f64> {
    match found {
        FirstContact::Open { safe } => Some(safe),
        FirstContact::Hit { safe, hit } if hit - safe > width.at_least(LEAST_WIDTH) => Some(safe),
        _ => None,
    }
}

/// Returns the result, improved by exact arithmetic if it is unsettled.
fn decided(
    found: FirstContact,
    width: f64,
    work: &mut SearchWork,
    exactly: impl FnOnce(&mut WideWork) -> FirstContact,
) -> FirstContact {
    let Some(safe) = unsettled(found, width) else {
        return found;
    };
    work.proofs = work.proofs.saturating_add(1);
    match exactly(&mut work.wide) {
        FirstContact::Hit { safe: before, hit } => FirstContact::Hit {
            safe: if safe < hit { before.larger(safe) } else { before },
            hit,
        },
        FirstContact::Open { .. } => found,
        other => other,
    }
}

#[cfg(feature = "exact")]
fn exact_vertex_face(
    vertex: &[VertexPath; 1],
    face: &[VertexPath; 3],
    width: f64,
    wide: &mut WideWork,
) -> FirstContact {
    super::exact::vertex_face(&vertex[0], face, width, wide)
}

#[cfg(feature = "exact")]
fn exact_edge_edge(a: &[VertexPath; 2], b: &[VertexPath; 2], width: f64, wide: &mut WideWork) -> FirstContact {
    super::exact::edge_edge(a, b, width, wide)
}

#[cfg(not(feature = "exact"))]
fn exact_vertex_face(_: &[VertexPath; 1], _: &[VertexPath; 3], _: f64, _: &mut WideWork) -> FirstContact {
    FirstContact::Open { safe: 0.0 }
}

#[cfg(not(feature = "exact"))]
fn exact_edge_edge(_: &[VertexPath; 2], _: &[VertexPath; 2], _: f64, _: &mut WideWork) -> FirstContact {
    FirstContact::Open { safe: 0.0 }
}

#[cfg(feature = "exact")]
fn pierce(p: &Triangle, q: &Triangle) -> bool {
    super::exact::pierce(p, q)
}

/// Without exact arithmetic, a contact at the start is reported as open.
#[cfg(not(feature = "exact"))]
fn pierce(_: &Triangle, _: &Triangle) -> bool {
    false
}

/// A pair of a vertex and a face or of two edges of two triangles.
enum Elements {
    VertexFace([VertexPath; 1], [VertexPath; 3]),
    EdgeEdge([VertexPath; 2], [VertexPath; 2]),
}

impl Elements {
    fn until(&self, until: f64, width: f64, work: &mut SearchWork) -> FirstContact {
        match self {
            Self::VertexFace(vertex, face) => vertex_face_until(vertex, face, until, width, work),
            Self::EdgeEdge(a, b) => edge_edge_until(a, b, until, width, work),
        }
    }

    fn exactly(&self, width: f64, wide: &mut WideWork) -> FirstContact {
        match self {
            Self::VertexFace(vertex, face) => exact_vertex_face(vertex, face, width, wide),
            Self::EdgeEdge(a, b) => exact_edge_edge(a, b, width, wide),
        }
    }
}

/// Returns the six pairs of a vertex and a face and the nine pairs of edges of two triangles.
fn elements(a: &[VertexPath; 3], b: &[VertexPath; 3]) -> impl Iterator<Item = Elements> {
    let (a, b) = (*a, *b);
    let edge = |t: &[VertexPath; 3], k: usize| [t[k], t[(k + 1) % 3]];
    let of_a = (0..3).map(move |k| Elements::VertexFace([a[k]], b));
    let of_b = (0..3).map(move |k| Elements::VertexFace([b[k]], a));
    let edges = (0..9).map(move |k| Elements::EdgeEdge(edge(&a, k / 3), edge(&b, k % 3)));
    of_a.chain(of_b).chain(edges)
}

/// Returns the first contact of two triangles.
///
/// If triangles are separated at time zero, their first contact is that of a vertex and a face or
/// of two edges. At this time a plane supports both triangles, and all common points lie in this
/// plane.
pub(super) fn triangles(a: &[VertexPath; 3], b: &[VertexPath; 3], width: f64, work: &mut SearchWork) -> FirstContact {
    triangles_until(a, b, 1.0, width, work)
}

/// Returns the first contact of two triangles as [`triangles`] does, or a miss if it is after
/// `until`.
pub(super) fn triangles_until(
    a: &[VertexPath; 3],
    b: &[VertexPath; 3],
    until: f64,
    width: f64,
    work: &mut SearchWork,
) -> FirstContact {
    let Some(paths) = VertexPaths::new(a, b) else {
        return FirstContact::Start;
    };
    let FirstContact::Open { safe } = search(&paths, until, TRIANGLE_INTERVALS, work, |_, _, _| None) else {
        return FirstContact::Miss;
    };
    if safe == 0.0 {
        let begin = |t: &[VertexPath; 3]| t.each(|p| p.start.coords);
        work.proofs = work.proofs.saturating_add(1);
        if pierce(&begin(a), &begin(b)) {
            return FirstContact::Start;
        }
    }
    let (mut first, mut open) = (First::default(), alloc::vec::Vec::new());
    for pair in elements(a, b) {
        let found = pair.until(first.hit.smaller(until), width, work);
        match unsettled(found, width) {
            Some(safe) => open.push((safe, found, pair)),
            None => first.add(found),
        }
    }
    // Pairs with the smallest `safe` come first, because they may end the search.
    sort(&mut open, |x, y| x.0.by_value(y.0));
    for (safe, found, pair) in open {
        if safe < first.hit {
            first.add(decided(found, width, work, |wide| pair.exactly(width, wide)));
        }
        if first.is_start {
            return FirstContact::Start;
        }
    }
    first.found()
}

/// The first contact of several pairs.
#[derive(Clone, Copy, Debug)]
pub(super) struct First {
    pub(super) is_start: bool,
    /// All pairs are separated until here.
    pub(super) safe: f64,
    /// A pair is in contact at or before this time.
    pub(super) hit: f64,
}

impl Default for First {
    fn default() -> Self {
        Self {
            is_start: false,
            safe: f64::INFINITY,
            hit: f64::INFINITY,
        }
    }
}

impl First {
    pub(super) fn add(&mut self, found: FirstContact) {
        match found {
            FirstContact::Miss => {}
            FirstContact::Start => self.is_start = true,
            FirstContact::Hit { safe, hit } => {
                self.safe = self.safe.smaller(safe);
                self.hit = self.hit.smaller(hit);
            }
            FirstContact::Open { safe } => self.safe = self.safe.smaller(safe),
        }
    }

    pub(super) fn found(self) -> FirstContact {
        if self.is_start {
            FirstContact::Start
        } else if self.hit <= 1.0 {
            FirstContact::Hit {
                safe: self.safe,
                hit: self.hit,
            }
        } else if self.safe <= 1.0 {
            FirstContact::Open { safe: self.safe }
        } else {
            FirstContact::Miss
        }
    }
}
