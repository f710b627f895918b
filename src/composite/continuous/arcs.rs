//! Triangles of meshes that rotate: on straight paths but for the sagitta of the arcs, which falls
//! with the square of the time.

use nalgebra::{Point3, Vector3};

use super::frame::MeshOverFrame;
use super::pair;
use super::paths::{Path, VertexPaths, VertexPlaces, determinant};
use super::search::{FirstContact, LEAST_WIDTH, SearchWork, is_free};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::{CERTIFICATE, PATH_VOLUME, UNIT};
use crate::composite::front::NodePair;

/// Most intervals of time tried for a pair of triangles of meshes that rotate. Not measured.
const ARC_INTERVALS: u32 = 1024;

/// Returns how far the places of two points, computed at an instant, are from the motions together.
///
/// With `L` the largest coordinates of both meshes, a place errs by the pose of its motion (64 UNIT
/// of the radius, 48 of the place: `TURN`, `PLACED_CENTRE`), by the matrix and the product (33
/// UNIT) and by the mean of both ends and the sum, 4 UNIT: less than twice `CERTIFICATE`.
pub(super) fn placed(a: &MeshOverFrame, b: &MeshOverFrame) -> f64 {
    2.0 * CERTIFICATE * UNIT * (a.reach() + b.reach())
}

/// Two triangles of meshes at least one of which rotates.
pub(super) struct TrianglesOnArcs<'a> {
    of: [&'a MeshOverFrame<'a>; 2],
    triangles: NodePair,
    /// How far the places of corners, as computed, are from the motion.
    placed: f64,
    /// How far corners are from straight paths over the frame.
    sagitta: f64,
}

/// Corners of both triangles at an instant.
type Corners = [[Point3<f64>; 3]; 2];

impl<'a> TrianglesOnArcs<'a> {
    pub(super) fn new(of: [&'a MeshOverFrame<'a>; 2], triangles: NodePair, placed: f64) -> Self {
        let [a, b] = [0, 1].map(|k| of[k].sagitta_of(triangles[k]));
        Self {
            of,
            triangles,
            placed,
            sagitta: a + b,
        }
    }

    fn at(&self, time: f64) -> Corners {
        [0, 1].map(|k| {
            let of = self.of[k];
            of.corners(self.triangles[k], &of.moment(time))
        })
    }

    /// Returns both triangles at rest as they are at an instant.
    pub(super) fn at_rest(&self, time: f64) -> [[Path; 3]; 2] {
        self.at(time).map(|corners| corners.map(|p| Path::new(p, p)))
    }

    /// Returns the first contact between two instants, in a bracket at most `width` wide if the
    /// contact is deep enough by then. The triangles are apart until the first. A contact that
    /// begins in that time may be proven later, up to `latest`.
    pub(super) fn first_contact(
        &self,
        [from, until]: [f64; 2],
        (latest, width): (f64, f64),
        work: &mut SearchWork,
    ) -> FirstContact {
        // A quarter: an edge may take some time to pass beyond doubt.
        let width = (0.25 * width).at_least(LEAST_WIDTH);
        let (mut safe, mut tried) = (from, 0);
        let mut ends = [until; 64];
        let mut count = 1;
        let mut x = self.at(from);
        while count > 0 {
            let end = ends[count - 1];
            let y = self.at(end);
            tried += 1;
            work.intervals = work.intervals.saturating_add(1);
            if self.are_apart([&x, &y], end - safe) {
                (safe, x) = (end, y);
                count -= 1;
                continue;
            }
            if safe == 0.0 && tried == 1 && self.is_start(work) {
                return FirstContact::Start;
            }
            // A contact at the begin of the interval is deeper later.
            let later = (safe + width).smaller(latest);
            if end - safe <= 0.5 * width
                && let Some(hit) = [end, later].into_iter().find(|t| self.is_crossed(*t, work))
            {
                return FirstContact::Hit { safe, hit };
            }
            if end - safe <= LEAST_WIDTH || tried >= ARC_INTERVALS || count == ends.len() {
                return self.crossed_later([safe, latest], width, work);
            }
            ends[count] = 0.5 * (safe + end);
            count += 1;
        }
        FirstContact::Miss
    }

    /// Returns whether a direction parts the triangles over an interval of this length.
    fn are_apart(&self, [x, y]: [&Corners; 2], length: f64) -> bool {
        let paths = |k: usize| [0, 1, 2].map(|i| Path::new(x[k][i], y[k][i]));
        let slack = self.placed + self.sagitta * (length * length) * (1.0 + 8.0 * UNIT);
        VertexPaths::new(&paths(0), &paths(1)).is_some_and(|paths| {
            let paths = paths.within(slack);
            let middle = paths.at(0.5);
            let both = [&paths.at(0.0), &paths.at(1.0)];
            is_free(&paths, [0.0, 1.0], both) || crosses(&middle).any(|n| paths.are_parted(both, &n))
        })
    }

    /// Returns whether the triangles, as they are placed at the begin, share a point.
    fn is_start(&self, work: &mut SearchWork) -> bool {
        let [a, b] = self.at_rest(0.0);
        matches!(pair::triangles(&a, &b, 1.0, work), FirstContact::Start)
    }

    /// Returns a contact that is proven at an instant after the time until which the triangles are
    /// proven apart, at distances that double.
    fn crossed_later(&self, [safe, latest]: [f64; 2], width: f64, work: &mut SearchWork) -> FirstContact {
        let mut ahead = width;
        while ahead < latest - safe {
            let hit = safe + ahead;
            if self.is_crossed(hit, work) {
                return FirstContact::Hit { safe, hit };
            }
            ahead *= 2.0;
        }
        if self.is_crossed(latest, work) {
            return FirstContact::Hit { safe, hit: latest };
        }
        FirstContact::Open { safe }
    }

    /// Returns whether an edge of one triangle passes through the inside of the other at an
    /// instant, beyond all doubt about their places.
    fn is_crossed(&self, time: f64, work: &mut SearchWork) -> bool {
        work.proofs = work.proofs.saturating_add(1);
        let [a, b] = self.at_rest(time);
        let Some(paths) = VertexPaths::new(&a, &b) else {
            return false;
        };
        // Differences of halves of coordinates are below one.
        let VertexPlaces { a: p, b: q } = paths.at(0.0);
        let off = 0.5 * self.placed / paths.unit[0] / paths.unit[1];
        if !(off < 1.0 / 64.0) {
            return false;
        }
        let [p, q] = [p, q].map(|t| t.map(|x| x * 0.5));
        passes(&p, &q, off) || passes(&q, &p, off)
    }
}

/// Returns the common perpendiculars of the edges of two triangles, both ways: where two edges
/// nearly meet, the way between the closest points has lost its direction.
fn crosses(places: &VertexPlaces<3, 3>) -> impl Iterator<Item = Vector3<f64>> {
    let edge = |t: &[Vector3<f64>; 3], k: usize| t[(k + 1) % 3] - t[k];
    (0..18).map(move |k| {
        let n = edge(&places.a, k / 6).cross(&edge(&places.b, k / 2 % 3));
        if k % 2 == 0 { n } else { -n }
    })
}

/// Returns whether an edge of a triangle certainly passes through the inside of another one, with
/// coordinates below a half, each corner off by at most `off`, below 1/64.
fn passes(p: &[Vector3<f64>; 3], q: &[Vector3<f64>; 3], off: f64) -> bool {
    // Three vectors of lengths up to the root of three, each off by twice as much as a corner:
    // 3 * 2 * 3 off, and the squares and the cube of it, 0.4 off.
    let doubt = PATH_VOLUME + 20.0 * off;
    let sign = |a: &Vector3<f64>, others: [&Vector3<f64>; 3]| {
        let [u, v, w] = others.map(|x| x - a);
        let volume = determinant([&u, &v, &w]);
        i32::from(volume > doubt) - i32::from(volume < -doubt)
    };
    let sides = [0, 1, 2].map(|k| sign(&p[k], [&q[0], &q[1], &q[2]]));
    (0..3).any(|k| {
        let (from, to) = (&p[k], &p[(k + 1) % 3]);
        if sides[k] * sides[(k + 1) % 3] >= 0 {
            return false;
        }
        let turns = [0, 1, 2].map(|j| sign(from, [to, &q[j], &q[(j + 1) % 3]]));
        turns[0] != 0 && turns[1] == turns[0] && turns[2] == turns[0]
    })
}
