//! Depth of an overlap by a polytope around the origin of the Minkowski difference `A - B`.
//!
//! The polytope is a closed surface of triangles whose vertices are points of the difference. Each
//! triangle is counter-clockwise as seen from outside. So the surface intersects every ray from the
//! origin, and the difference contains the ball around the origin that touches the nearest plane of
//! a triangle. The distance of this plane is a lower bound of the depth. The support value along
//! any direction is an upper bound.
//!
//! Source: van den Bergen 2001, "Proximity queries and penetration depth computation on 3D game
//! objects". Departures:
//! 1. The orientation of each triangle is proven against rounding when the triangle is made. A
//!    point is rejected if it would make a triangle whose orientation is in doubt.
//! 2. Both bounds are returned, no matter how the search ends.

use alloc::vec::Vec;

use super::best_bounds::ProvenBounds;
use super::posed::{DifferencePoint, PosedCores, unit};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Vec3, cross, dot, neg, root, sub};
use crate::base::tolerance::{DEPTH_GOAL, ORIENTATION};
use crate::body::shape::Support;

/// Largest number of points of a polytope: a heuristic.
const POINTS: usize = 256;

/// A triangle of the polytope.
struct SurfaceFacet {
    corners: [u16; 3],
    /// Of unit length up to rounding, pointing away from the origin.
    normal: Vec3<f64>,
    /// Distance of the plane from the origin, rounded down.
    distance: f64,
    /// Whether no further point is added over the facet.
    done: bool,
}

/// The polytope.
struct DifferenceSurface<'s, 'p, A, B> {
    posed: &'s PosedCores<'p, A, B, f64>,
    points: Vec<DifferencePoint<f64>>,
    facets: Vec<SurfaceFacet>,
    /// Point that the polytope contains: the origin, or a point inside until the polytope has grown
    /// around the origin.
    about: Vec3<f64>,
}

/// Bound that a polytope proves, and the facet nearest to the origin.
pub(super) struct Depth {
    /// Lower bound of the depth.
    pub(super) least: f64,
    /// Normal of the facet nearest to the origin.
    pub(super) n: Vec3<f64>,
    /// Branches of the vertices of the facet.
    pub(super) of: [[u32; 2]; 3],
}

impl<A: Support, B: Support> DifferenceSurface<'_, '_, A, B> {
    /// Returns a point of `A - B`, relative to `about`.
    fn place(&self, k: u16) -> Vec3<f64> {
        sub(&neg(&self.points[usize::from(k)].w), &self.about)
    }

    /// Returns the triangle if its orientation is proven to be counter-clockwise.
    fn facet(&self, corners: [u16; 3]) -> Option<SurfaceFacet> {
        let [p, q, r] = corners.each(|k| self.place(k));
        let (u, v) = (sub(&q, &p), sub(&r, &p));
        let n = cross(&u, &v);
        let length = root(dot(&n, &n));
        let doubt = ORIENTATION * root(dot(&u, &u)) * root(dot(&v, &v)) * self.posed.size;
        let height = dot(&n, &p).smaller(dot(&n, &q)).smaller(dot(&n, &r)) - doubt;
        (height > 0.0).then(|| SurfaceFacet {
            corners,
            normal: n.each(|x| x / length),
            distance: height / length,
            done: false,
        })
    }

    /// Returns the facet nearest to the origin, of all facets or only of those that still grow.
    fn nearest(&self, open: bool) -> Option<usize> {
        let of = |k: &usize| self.facets[*k].distance;
        let all = (0..self.facets.len()).filter(|&k| !(open && self.facets[k].done));
        all.min_by(|i, j| of(i).total_cmp(&of(j)))
    }

    /// Adds a point over one facet. Returns whether all new triangles are proven.
    fn grow(&mut self, piece: DifferencePoint<f64>) -> bool {
        let top = self.points.len() as u16;
        self.points.push(piece);
        let place = self.place(top);
        let sees = |f: &SurfaceFacet, s: &Self| dot(&f.normal, &place) > dot(&f.normal, &s.place(f.corners[0]));
        let visible: Vec<bool> = self.facets.iter().map(|f| sees(f, self)).collect();
        let mut rim: Vec<[u16; 2]> = Vec::new();
        for (f, _) in self.facets.iter().zip(&visible).filter(|(_, seen)| **seen) {
            let [p, q, r] = f.corners;
            for [from, to] in [[p, q], [q, r], [r, p]] {
                match rim.iter().position(|e| *e == [to, from]) {
                    Some(k) => {
                        rim.swap_remove(k);
                    }
                    None => rim.push([from, to]),
                }
            }
        }
        let fan: Option<Vec<SurfaceFacet>> = rim.iter().map(|&[from, to]| self.facet([from, to, top])).collect();
        match fan {
            Some(fan) if !fan.is_empty() => {
                let mut seen = visible.into_iter();
                self.facets.retain(|_| !seen.next().unwrap_or(false));
                self.facets.extend(fan);
                true
            }
            _ => {
                self.points.pop();
                false
            }
        }
    }

    /// Makes the facets of a tetrahedron, or of an octahedron of points up and down three axes, if
    /// they are proven to be around `about`. One of the two vertex orders is right for all facets.
    fn begin(&mut self) -> bool {
        let tetrahedron = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let octahedron = [
            [0, 2, 4],
            [0, 4, 3],
            [0, 3, 5],
            [0, 5, 2],
            [1, 4, 2],
            [1, 3, 4],
            [1, 5, 3],
            [1, 2, 5],
        ];
        let is_four = self.points.len() == 4;
        let order: &[[u16; 3]] = if is_four { &tetrahedron } else { &octahedron };
        [false, true].into_iter().any(|turned| {
            let turn = |[p, q, r]: [u16; 3]| if turned { [p, r, q] } else { [p, q, r] };
            let facets: Option<Vec<SurfaceFacet>> = order.iter().map(|&f| self.facet(turn(f))).collect();
            self.facets = facets.unwrap_or_default();
            !self.facets.is_empty()
        })
    }

    /// Starts again with a tetrahedron around its centroid: three points far apart, and the support
    /// point above or below their plane.
    fn begin_inside(&mut self) -> bool {
        let all = core::mem::take(&mut self.points);
        let from_first = |p: &DifferencePoint<f64>| sub(&all[0].w, &p.w);
        let squared = |v: &Vec3<f64>| dot(v, v);
        let farthest = |of: fn(&Vec3<f64>, &Vec3<f64>) -> Vec3<f64>, u: &Vec3<f64>| {
            let far = |p: &&DifferencePoint<f64>| squared(&of(u, &from_first(p)));
            all.iter().max_by(|p, q| far(p).total_cmp(&far(q))).copied()
        };
        let second = farthest(|_, v| *v, &[0.0; 3]).unwrap_or(all[0]);
        let u = from_first(&second);
        let third = farthest(cross, &u).unwrap_or(all[0]);
        let Some(n) = unit(&cross(&u, &from_first(&third))) else {
            return false;
        };
        let [up, down] = [n, neg(&n)].each(|n| self.posed.support(&self.posed.toward(n), all[0].of));
        let height = |p: &DifferencePoint<f64>| dot(&n, &from_first(p)).abs();
        let fourth = if height(&up) > height(&down) { up } else { down };
        self.points = [all[0], second, third, fourth].to_vec();
        let sum = |sum: Vec3<f64>, p: &DifferencePoint<f64>| sub(&sum, &p.w);
        self.about = self.points.iter().fold([0.0; 3], sum).each(|x| x / 4.0);
        self.begin()
    }

    /// Adds points over the facets that have the origin on or above their plane, until the polytope
    /// is proven to contain the origin.
    fn reach_origin(&mut self) -> bool {
        let about = self.about;
        while self.points.len() < POINTS {
            self.about = [0.0; 3];
            let facets: Option<Vec<SurfaceFacet>> = self.facets.iter().map(|f| self.facet(f.corners)).collect();
            if let Some(facets) = facets {
                self.facets = facets;
                return true;
            }
            self.about = about;
            let height = |f: &&SurfaceFacet| f.distance + dot(&f.normal, &about);
            let lowest = self.facets.iter().min_by(|f, g| height(f).total_cmp(&height(g)));
            let Some((n, corners)) = lowest.and_then(|f| Some((unit(&f.normal)?, f.corners))) else {
                return false;
            };
            let hint = self.points[usize::from(corners[0])].of;
            let piece = self.posed.support(&self.posed.toward(n), hint);
            if !self.grow(piece) {
                return false;
            }
        }
        false
    }

    /// Returns the bound that the nearest facet proves.
    fn result(&self, k: usize) -> Depth {
        let facet = &self.facets[k];
        Depth {
            least: facet.distance,
            n: facet.normal,
            of: facet.corners.each(|k| self.points[usize::from(k)].of),
        }
    }
}

/// Grows a polytope from points around the origin until the bounds agree or no more points are
/// allowed.
pub(super) fn deepen<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    corners: &[DifferencePoint<f64>],
    best: &mut ProvenBounds<f64>,
) -> Option<Depth> {
    let mut surface = DifferenceSurface {
        posed,
        points: corners.to_vec(),
        facets: Vec::new(),
        about: [0.0; 3],
    };
    if !(surface.begin() || surface.begin_inside() && surface.reach_origin()) {
        return None;
    }
    let goal = DEPTH_GOAL * posed.size;
    while surface.points.len() < POINTS {
        let Some(k) = surface.nearest(true) else { break };
        let facet = &surface.facets[k];
        let Some(n) = unit(&facet.normal) else { break };
        let hint = surface.points[usize::from(facet.corners[0])].of;
        let toward = posed.toward(n);
        let piece = posed.support(&toward, hint);
        best.prove(&toward, &piece);
        let least = surface.nearest(false).map_or(0.0, |k| surface.facets[k].distance);
        if -best.lower - least <= goal {
            break;
        }
        let known = surface.points.iter().any(|p| p.w == piece.w);
        let rises = -dot(&n, &piece.w) > surface.facets[k].distance;
        if known || !rises || !surface.grow(piece) {
            surface.facets[k].done = true;
        }
    }
    surface.nearest(false).map(|k| surface.result(k))
}
