//! What a tracker keeps of an overlap: the surface by the names of its points, and the deepest facet.
//!
//! Points of the difference are vertex pairs, and stay points of it whatever the pose: taken up again at another pose the
//! surface is as good a proof as any, once it is known to be about the origin. It is if it is closed and every triangle is seen
//! from behind (each ray then meets only triangles that count one way). Where all of them are beyond the facet, the depth is proven
//! in one pass; else it grows; a surface that has folded is dropped.

use alloc::vec::Vec;

use crate::closest::fallback::corner;
use crate::closest::outcome::{Class, Layer, Outcome};
use crate::closest::placed::{Frame, Placed};
use crate::closest::simplex::Corner;
use crate::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::scalar::{Vec3, cross, dot, sub};
use crate::tolerance::{AGREE_DEPTH, CERTIFICATE, ORIENTATION, UNIT};

use super::facet::normal_of;
use super::search::{Best, End, Search, highest};
use super::surface::Surface;
use super::take;

/// Triangles that are worth their memory.
const MOST: usize = 256;

/// Triangles a surface may gain before it is built afresh, beside those it was built with.
const GAIN: usize = 24;

/// A closed surface without places.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Memory {
    /// A vertex of each body.
    pub(crate) points: Vec<[u32; 2]>,
    /// Three corners, and the triangle across the edge from corner k to corner k + 1.
    pub(crate) triangles: Vec<[u32; 6]>,
    /// The features of the deepest facet.
    pub(crate) facet: Option<FeaturePair>,
    /// With how many triangles it was built.
    pub(crate) built: u32,
}

/// What one pass over the surface shows.
enum Pass {
    /// About the origin, and every triangle beyond the facet: the depth is proven.
    Stands,
    /// About the origin.
    About,
    Folded,
}

impl Memory {
    /// Forgets the surface, not its room.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.triangles.clear();
        self.facet = None;
        self.built = 0;
    }

    /// Whether there is nothing to begin with.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Whether it names vertices of these bodies and is closed: each edge of a triangle is the reverse of one of its
    /// neighbour. What comes from a file need not be.
    fn fits(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> bool {
        let known = |[x, y]: &[u32; 2]| (*x as usize) < a.points.len() && (*y as usize) < b.points.len();
        let closed = |(k, t): (usize, &[u32; 6])| {
            (0..3).all(|i| {
                let (from, to) = (t[i], t[(i + 1) % 3]);
                (from as usize) < self.points.len()
                    && self
                        .triangles
                        .get(t[3 + i] as usize)
                        .is_some_and(|o| (0..3).any(|j| (o[j], o[(j + 1) % 3], o[3 + j]) == (to, from, k as u32)))
            })
        };
        self.points.iter().all(known) && self.triangles.iter().enumerate().all(closed)
    }

    /// Keeps a surface if it is small, and has not outgrown the one it came from.
    pub(super) fn keep(&mut self, surface: &Surface<f64>, facet: FeaturePair, built: Option<u32>) {
        self.clear();
        let count = surface.alive().count();
        let built = built.unwrap_or(count as u32);
        if count > MOST || count > 2 * built as usize + GAIN {
            return;
        }
        surface.names(&mut self.points, &mut self.triangles);
        (self.facet, self.built) = (Some(facet), built);
    }
}

/// The depth from the surface of the last answer; nothing is said of bodies that it no longer proves to overlap.
pub(crate) fn resume(placed: &Placed, memory: &mut Memory, outcome: &mut Outcome) -> bool {
    let Some(facet) = memory.facet.filter(|f| f.is_of(placed.a, placed.b)) else {
        return false;
    };
    if !memory.fits(placed.a, placed.b) {
        return false;
    }
    let frame = Frame::of(placed);
    let (a, b) = facet.vertices_of(placed.a, placed.b);
    let hint = corner(placed, &frame, a, b);
    let Some(normal) = normal_of(placed, &frame, facet, &hint) else {
        return false;
    };
    let height = dot(&normal, &highest(placed, &frame, &normal, &hint).w);
    let best = Best {
        normal,
        height,
        features: Some(facet),
    };
    let points: Vec<_> = memory
        .points
        .iter()
        .map(|p| corner(placed, &frame, p[0], p[1]))
        .collect();
    let pass = pass(&memory.triangles, &points, &best, placed.size());
    if let Pass::Folded = pass {
        return false;
    }
    let surface = Surface::named(points, &memory.triangles, matches!(pass, Pass::About));
    let mut search = Search::resumed(placed, &frame, surface, best);
    let found = match pass {
        Pass::Stands => search.stands(height - AGREE_DEPTH * placed.size()),
        _ => search.run(&frame, 0.0),
    };
    if found.end != End::Closed {
        return false;
    }
    outcome.class = Class::Overlapping;
    outcome.layer = Layer::Surface;
    outcome.lower = f64::NEG_INFINITY;
    outcome.work.depths += 1;
    take(placed, &found, outcome);
    if let Pass::About = pass {
        let built = memory.built;
        memory.keep(&search.surface, outcome.features, Some(built));
    }
    true
}

/// Looks at every triangle once, without roots or divisions.
fn pass(triangles: &[[u32; 6]], points: &[Corner<f64>], best: &Best<f64>, size: f64) -> Pass {
    let margin = 2.0 * CERTIFICATE * UNIT * size;
    let goal = best.height - AGREE_DEPTH * size;
    let mut stands = goal > margin;
    for t in triangles {
        let w = [0, 1, 2].map(|k| points[t[k] as usize].w);
        let (u, v) = (sub(&w[1], &w[0]), sub(&w[2], &w[0]));
        let n = cross(&u, &v);
        let low = least(&n, &w);
        let (squared, noise) = (dot(&n, &n), ORIENTATION * size);
        // Seen from behind, certainly, and clear of the origin. Comparisons are written so that NaN is a fold.
        let certain =
            low > 0.0 && low * low > noise * noise * dot(&u, &u) * dot(&v, &v) && low * low > margin * margin * squared;
        if !certain {
            return Pass::Folded;
        }
        stands = stands && (low * low >= goal * goal * squared || least(&best.normal, &w) >= goal);
    }
    if stands { Pass::Stands } else { Pass::About }
}

fn least(n: &Vec3<f64>, w: &[Vec3<f64>; 3]) -> f64 {
    dot(n, &w[0]).min(dot(n, &w[1])).min(dot(n, &w[2]))
}
