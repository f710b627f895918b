//! The curves in which two surfaces cross, and the area of each face inside the other body.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::arithmetic::Counted;
use super::crossings::Segment;
use super::sums::{Passage, Sums, Term};
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::nonconvex::query::triangle;

/// The curves in which the surfaces of two solids cross, and the areas inside the other body.
///
/// Both are for pictures and measurements, up to rounding. They do not depend continuously on the
/// pose: where faces lie on each other, an infinitesimal shift of B by `(e, e^2, e^3)` in A's frame
/// decides which of them are inside, and which curves there are.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OverlapLoops {
    /// The curves as closed polylines in A's frame; the last point precedes the first.
    ///
    /// A curve may pass a point more than once. Seen from outside A, the part of A's surface inside
    /// B is on the left.
    pub loops: Vec<Vec<Point3<f64>>>,
    /// For each body, the faces with a part inside the other one.
    pub shares: [Vec<FaceShare>; 2],
}

/// A face with a part inside the other body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FaceShare {
    /// The triangle of a mesh, the face of a polyhedron or the piece of a compound, by the caller's
    /// index.
    pub face: u32,
    /// The area inside the other body in the caller's unit squared; it counts by winding number.
    pub area: f64,
}

/// Adds the shares of one face together; the list is sorted by faces then.
pub(crate) fn merged(mut shares: Vec<FaceShare>) -> Vec<FaceShare> {
    let mut sums = BTreeMap::new();
    for share in shares.drain(..) {
        *sums.entry(share.face).or_insert(0.0) += share.area;
    }
    sums.into_iter().map(|(face, area)| FaceShare { face, area }).collect()
}

/// Returns the curves and the areas of two surfaces.
pub(super) fn all(sums: &Sums) -> OverlapLoops {
    let passages = sums.passages();
    OverlapLoops {
        loops: loops(sums, &passages),
        shares: shares(sums, &passages),
    }
}

/// Joins the segments to closed curves.
///
/// As many segments start at a crossing as end there, so a walk from a crossing ends where it
/// began. Where more than two faces meet at an edge, any continuation will do.
fn loops(sums: &Sums, passages: &[Vec<Passage<Counted>>; 2]) -> Vec<Vec<Point3<f64>>> {
    let segments = sums.segments();
    let mut starts: Vec<((usize, u32), usize)> = segments.iter().map(|s| s.ends[0]).zip(0..).collect();
    starts.sort_unstable();
    // The next segment at the start of each one that is taken, by the order of `starts`.
    let mut is_taken = vec![false; segments.len()];
    let mut next = vec![0; segments.len()];
    let mut curves = Vec::new();
    for first in 0..segments.len() {
        let (mut points, mut at) = (Vec::new(), first);
        while !is_taken[at] {
            is_taken[at] = true;
            let (of, number) = segments[at].ends[0];
            let point = passages[of][number as usize].point.each_ref().each(|x| x.value.hi);
            let point = sums.given(&(sums.origin + Vector3::from(point)));
            if points.last() != Some(&point) {
                points.push(point);
            }
            let end = segments[at].ends[1];
            let low = starts.partition_point(|x| x.0 < end);
            // Segments that start at the end of this one, of which `next` have been tried.
            let Some(&(start, _)) = starts.get(low) else { break };
            while starts
                .get(low + next[low])
                .is_some_and(|x| x.0 == start && is_taken[x.1])
            {
                next[low] += 1;
            }
            match starts.get(low + next[low]) {
                Some(x) if x.0 == end => at = x.1,
                _ => break,
            }
        }
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if !points.is_empty() {
            curves.push(points);
        }
    }
    curves
}

/// Returns the area of each face inside the other body.
fn shares(sums: &Sums, passages: &[Vec<Passage<Counted>>; 2]) -> [Vec<FaceShare>; 2] {
    // The part of each triangle that is inside.
    let mut parts: [BTreeMap<u32, f64>; 2] = Default::default();
    for term in sums.terms() {
        match term {
            Term::Face { of, t, .. } => {
                *parts[of].entry(t).or_insert(0.0) += sums.mean(&term, passages);
            }
            Term::Segment(k) => {
                let Segment { of, ends } = sums.segments()[k];
                let [start, end] = ends.each(|(of, number)| {
                    let point = passages[of][number as usize].point.each_ref().each(|x| x.value.hi);
                    sums.origin + Vector3::from(point)
                });
                for body in 0..2 {
                    let corners = sums.corners(body, of[body]);
                    let normal = triangle::normal(&corners);
                    let square = normal.norm_squared();
                    let across = (start - corners[0]).cross(&(end - corners[0]));
                    let sign = if body == 0 { 1.0 } else { -1.0 };
                    if square > 0.0 {
                        *parts[body].entry(of[body]).or_insert(0.0) += sign * normal.dot(&across) / square;
                    }
                }
            }
        }
    }
    [0, 1].each(|body: usize| {
        let area = |(&t, part): (&u32, &f64)| {
            let normal = triangle::normal(&sums.corners(body, t));
            FaceShare {
                face: sums.number(body, t),
                area: 0.5 * sqrt(normal.norm_squared()) * part * sums.square_unit(),
            }
        };
        merged(parts[body].iter().map(area).collect())
    })
}
