//! The first contact of two parts: what floating point proves, and what exact arithmetic decides.

use super::paths::{Path, VertexPaths};
use super::search::{FirstContact, LEAST_WIDTH, SearchWork, WideWork, first_contact, search};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::composite::meet::triangle::Triangle;

/// Most intervals of time tried for a pair of triangles as a whole, before its vertices, edges and
/// faces are tried pair by pair. Not measured.
const TRIANGLE_INTERVALS: u32 = 12;

/// Returns the first contact of a vertex and a face, in a bracket at most `width` wide if rounding
/// allows.
pub(super) fn vertex_face(vertex: &[Path; 1], face: &[Path; 3], width: f64, work: &mut SearchWork) -> FirstContact {
    let found = vertex_face_until(vertex, face, (1.0, width), work);
    decided(found, width, work, |wide| exact_vertex_face(vertex, face, width, wide))
}

/// Returns the first contact of two edges, in a bracket at most `width` wide if rounding allows.
pub(super) fn edge_edge(a: &[Path; 2], b: &[Path; 2], width: f64, work: &mut SearchWork) -> FirstContact {
    let found = edge_edge_until(a, b, (1.0, width), work);
    decided(found, width, work, |wide| exact_edge_edge(a, b, width, wide))
}

fn vertex_face_until(vertex: &[Path; 1], face: &[Path; 3], time: (f64, f64), work: &mut SearchWork) -> FirstContact {
    VertexPaths::new(vertex, face).map_or(FirstContact::Start, |paths| first_contact(&paths, time, work))
}

fn edge_edge_until(a: &[Path; 2], b: &[Path; 2], time: (f64, f64), work: &mut SearchWork) -> FirstContact {
    VertexPaths::new(a, b).map_or(FirstContact::Start, |paths| first_contact(&paths, time, work))
}

/// Returns until when a pair that is not settled is apart: undecided, or in a bracket that rounding
/// keeps wide.
fn unsettled(found: FirstContact, width: f64) -> Option<f64> {
    match found {
        FirstContact::Open { safe } => Some(safe),
        FirstContact::Hit { safe, hit } if hit - safe > width.at_least(LEAST_WIDTH) => Some(safe),
        _ => None,
    }
}

/// Returns what is found, or what exact arithmetic decides of the rest.
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
fn exact_vertex_face(vertex: &[Path; 1], face: &[Path; 3], width: f64, wide: &mut WideWork) -> FirstContact {
    super::exact::vertex_face(&vertex[0], face, width, wide)
}

#[cfg(feature = "exact")]
fn exact_edge_edge(a: &[Path; 2], b: &[Path; 2], width: f64, wide: &mut WideWork) -> FirstContact {
    super::exact::edge_edge(a, b, width, wide)
}

#[cfg(not(feature = "exact"))]
fn exact_vertex_face(_: &[Path; 1], _: &[Path; 3], _: f64, _: &mut WideWork) -> FirstContact {
    FirstContact::Open { safe: 0.0 }
}

#[cfg(not(feature = "exact"))]
fn exact_edge_edge(_: &[Path; 2], _: &[Path; 2], _: f64, _: &mut WideWork) -> FirstContact {
    FirstContact::Open { safe: 0.0 }
}

#[cfg(feature = "exact")]
fn pierce(p: &Triangle, q: &Triangle) -> bool {
    super::exact::pierce(p, q)
}

/// Without exact arithmetic, a start in contact ends as open.
#[cfg(not(feature = "exact"))]
fn pierce(_: &Triangle, _: &Triangle) -> bool {
    false
}

/// A pair of a vertex and a face or of two edges of two triangles.
enum Elements {
    VertexFace([Path; 1], [Path; 3]),
    EdgeEdge([Path; 2], [Path; 2]),
}

impl Elements {
    fn until(&self, time: (f64, f64), work: &mut SearchWork) -> FirstContact {
        match self {
            Self::VertexFace(vertex, face) => vertex_face_until(vertex, face, time, work),
            Self::EdgeEdge(a, b) => edge_edge_until(a, b, time, work),
        }
    }

    fn exactly(&self, width: f64, wide: &mut WideWork) -> FirstContact {
        match self {
            Self::VertexFace(vertex, face) => exact_vertex_face(vertex, face, width, wide),
            Self::EdgeEdge(a, b) => exact_edge_edge(a, b, width, wide),
        }
    }
}

/// The six pairs of a vertex and a face and the nine pairs of edges of two triangles.
fn elements(a: &[Path; 3], b: &[Path; 3]) -> impl Iterator<Item = Elements> {
    let (a, b) = (*a, *b);
    let edge = |t: &[Path; 3], k: usize| [t[k], t[(k + 1) % 3]];
    let of_a = (0..3).map(move |k| Elements::VertexFace([a[k]], b));
    let of_b = (0..3).map(move |k| Elements::VertexFace([b[k]], a));
    let edges = (0..9).map(move |k| Elements::EdgeEdge(edge(&a, k / 3), edge(&b, k % 3)));
    of_a.chain(of_b).chain(edges)
}

/// Returns the first contact of two triangles.
///
/// Triangles apart at time zero first meet where a vertex meets a face or two edges meet: at the
/// first contact a plane supports both, and what they share lies in that plane.
pub(super) fn triangles(a: &[Path; 3], b: &[Path; 3], width: f64, work: &mut SearchWork) -> FirstContact {
    triangles_until((a, b), (1.0, width), work)
}

/// Returns the first contact of two triangles as [`triangles`] does, and misses after `until` as
/// well.
pub(super) fn triangles_until(
    (a, b): (&[Path; 3], &[Path; 3]),
    (until, width): (f64, f64),
    work: &mut SearchWork,
) -> FirstContact {
    let Some(paths) = VertexPaths::new(a, b) else {
        return FirstContact::Start;
    };
    let FirstContact::Open { safe } = search(&paths, until, TRIANGLE_INTERVALS, work, |_, _, _| None) else {
        return FirstContact::Miss;
    };
    if safe == 0.0 {
        let begin = |t: &[Path; 3]| t.map(|p| p.begin.coords);
        work.proofs = work.proofs.saturating_add(1);
        if pierce(&begin(a), &begin(b)) {
            return FirstContact::Start;
        }
    }
    let (mut first, mut open) = (First::default(), alloc::vec::Vec::new());
    for pair in elements(a, b) {
        let found = pair.until((first.hit.smaller(until), width), work);
        match unsettled(found, width) {
            Some(safe) => open.push((safe, found, pair)),
            None => first.add(found),
        }
    }
    // Those that nothing is known of first, as they may end the search.
    open.sort_by(|x, y| x.0.total_cmp(&y.0));
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
    /// All pairs are apart until here.
    pub(super) safe: f64,
    /// A pair is in contact not after this.
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
