//! The sums of a volume over faces, edges and segments, with a bound of their error.
//!
//! With winding numbers `w` and any point `o`, the divergence theorem and Green's theorem on each
//! face about its first corner `q` give
//!
//! ```text
//! 6 V = sum over faces f of A of lam_f det(f - o)
//!     + sum over faces g of B of lam_g det(g - o)
//!     + sum over segments (f, g) from P to Q of det(q_f - q_g, P - o, Q - o)
//! ```
//!
//! where `lam` is the integral of the other body's winding number along the edge between the second
//! and the third corner: the number at its end, plus `s` for each crossing that leaves the other
//! body, minus `s` for each that enters, at the part `s` of the edge. The first moments are sums of
//! the same terms. A crossing takes one division; no crossings are sorted.

use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::arithmetic::{Arithmetic, Counted, Triple, between, cross, dot};
use super::crossings::{Crossing, Crossings, Segment};
use super::surfaces::Surfaces;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{LOST_TERM, UNIT};
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::nonconvex::query::triangle::Triangle;

/// Bits of the rational terms below the cube of the common box.
#[cfg(feature = "exact")]
const FIXED_BITS: i32 = 320;

/// The part of an edge before a crossing, and the crossing relative to the origin of the sums.
#[derive(Clone)]
pub(super) struct Passage<N> {
    pub(super) part: N,
    pub(super) point: Triple<N>,
}

/// A term of the sum.
#[derive(Clone, Copy)]
pub(super) enum Term {
    /// A near triangle of a body, and its crossings in `based`.
    Face {
        of: usize,
        t: u32,
        first: usize,
        end: usize,
    },
    Segment(usize),
}

/// Surfaces with their crossings, whose volume is summed.
pub(super) struct Sums<'a> {
    surfaces: &'a Surfaces<'a>,
    crossings: &'a Crossings,
    /// The origin of the sums.
    pub(super) origin: Vector3<f64>,
    /// A power of two near the lengths: the unit of the moments.
    unit: f64,
}

/// The sum of all terms: six times the volume, and 24 times the first moments about an origin.
#[derive(Default)]
pub(super) struct Total {
    pub(super) six: Counted,
    /// Divided by a unit of length, so that they stay in range.
    moment: Triple<Counted>,
}

impl Total {
    /// Returns the sum over triangles of the volume between each of them and an origin.
    pub(super) fn between(triangles: impl Iterator<Item = Triangle>, origin: &Vector3<f64>, unit: f64) -> Self {
        let mut total = Self::default();
        for corners in triangles {
            let six = six::<Counted>(&corners, origin);
            let [a, b, c] = corners.each(|p| between::<Counted>(origin, &p));
            for k in 0..3 {
                let lever = a[k].plus(&b[k]).plus(&c[k]).scaled(1.0 / unit);
                total.moment[k] = total.moment[k].plus(&six.times(&lever)).lossy(lost(unit));
            }
            total.six = total.six.plus(&six);
        }
        total
    }

    /// Returns the centre of mass, and a bound of the error of each coordinate. `None` if they are
    /// not finite.
    ///
    /// Six times a volume of `doubt` is counted or not, up to `reach` from the origin.
    pub(super) fn centre(
        &self,
        origin: &Vector3<f64>,
        unit: f64,
        [doubt, reach]: [f64; 2],
    ) -> Option<(Vector3<f64>, f64)> {
        let least = self.six.value.hi * (1.0 - 8.0 * UNIT) - (self.six.error + doubt) * (1.0 + 8.0 * UNIT);
        let four = self.six.value.scaled(4.0);
        let mut worst = 0.0_f64;
        let centre = Vector3::from([0, 1, 2].each(|k: usize| {
            let moment = &self.moment[k];
            let shift = (moment.value / four).hi * unit;
            // The part of the moment that is unknown, and of the volume; then three roundings.
            let unknown = 0.25 * moment.error * unit + doubt * reach + shift.abs() * (self.six.error + doubt);
            let at = origin[k] + shift;
            worst = worst.larger(unknown / least + 4.0 * UNIT * (shift.abs() + at.abs()));
            at
        }));
        let error = worst * (1.0 + 16.0 * UNIT) + f64::MIN_POSITIVE;
        (least > 0.0 && centre.iter().all(|x| x.is_finite()) && error.is_finite()).then_some((centre, error))
    }
}

/// Returns a bound of what a term loses by underflow.
fn lost(size: f64) -> f64 {
    let size = size.larger(1.0);
    LOST_TERM * size * size * size
}

/// Returns six times the volume between a triangle and a point.
pub(super) fn six<N: Arithmetic>([a, b, c]: &Triangle, origin: &Vector3<f64>) -> N {
    let normal = cross(&between::<N>(a, b), &between(a, c));
    dot(&normal, &between(origin, a))
}

impl<'a> Sums<'a> {
    pub(super) fn new(surfaces: &'a Surfaces<'a>, crossings: &'a Crossings) -> Self {
        let (low, high) = (surfaces.common.low, surfaces.common.high);
        let mut reach = f64::MIN_POSITIVE;
        for side in &surfaces.of {
            for v in side.near.iter().flat_map(|t| side.vertices(*t)) {
                reach = reach.larger(side.point(v).amax());
            }
        }
        Self {
            surfaces,
            crossings,
            origin: low * 0.5 + high * 0.5,
            unit: power_of_two(exponent_of(reach)),
        }
    }

    /// Returns all terms that are not zero.
    pub(super) fn terms(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        for of in 0..2 {
            let (surface, side) = (&self.surfaces.of[of], &self.crossings.of[of]);
            let mut first = 0;
            for &t in &surface.near {
                first += side.based[first..].iter().take_while(|x| x.0 < t).count();
                let end = first + side.based[first..].iter().take_while(|x| x.0 == t).count();
                let last = surface.vertices(t)[1].max(surface.vertices(t)[2]);
                if end > first || side.windings[last as usize] != 0 {
                    terms.push(Term::Face { of, t, first, end });
                }
                first = end;
            }
        }
        terms.extend((0..self.crossings.segments.len()).map(Term::Segment));
        terms
    }

    /// Returns where an edge of a body passes through a triangle.
    pub(super) fn passage<N: Arithmetic>(&self, of: usize, crossing: &Crossing) -> Passage<N> {
        let [p, q] = crossing.edge.each(|v| self.surfaces.of[of].point(v));
        let [a, b, c] = self.surfaces.of[1 - of].corners(crossing.through);
        let normal = cross(&between::<N>(&a, &b), &between(&a, &c));
        let along = between(p, q);
        let part = dot(&normal, &between(p, &a)).fraction(&dot(&normal, &along));
        let start = between::<N>(&self.origin, p);
        let at = |k: usize| start[k].plus(&part.times(&along[k]));
        Passage {
            point: [at(0), at(1), at(2)],
            part: part.clone(),
        }
    }

    /// Returns the passages of all crossings of both bodies.
    pub(super) fn passages(&self) -> [Vec<Passage<Counted>>; 2] {
        [0, 1].each(|of: usize| {
            let all = self.crossings.of[of].all.iter();
            all.map(|crossing| self.passage(of, crossing)).collect()
        })
    }

    /// Returns the winding number along the edge that a triangle is summed by, at its end, and the
    /// ends, the lower index first.
    fn base(&self, of: usize, t: u32) -> (i32, [u32; 2]) {
        let [_, b, c] = self.surfaces.of[of].vertices(t);
        let edge = [b.min(c), b.max(c)];
        (self.crossings.of[of].windings[edge[1] as usize], edge)
    }

    /// Returns a term of the volume, with the passages that it needs.
    pub(super) fn value<N: Arithmetic>(&self, term: &Term, passage: impl Fn(usize, u32) -> Passage<N>) -> N {
        match *term {
            Term::Face { of, t, first, end } => {
                let side = &self.crossings.of[of];
                let mut mean = N::whole(self.base(of, t).0);
                for &(_, k) in &side.based[first..end] {
                    let part = passage(of, k).part;
                    mean = if side.all[k as usize].leaves > 0 {
                        mean.plus(&part)
                    } else {
                        mean.minus(&part)
                    };
                }
                mean.times(&six(&self.surfaces.of[of].corners(t), &self.origin))
            }
            Term::Segment(k) => {
                let Segment { of: [f, g], ends } = self.crossings.segments[k];
                let [start, end] = ends.each(|(of, number)| passage(of, number).point);
                let corner = |k: usize, t: u32| *self.surfaces.of[k].point(self.surfaces.of[k].vertices(t)[0]);
                dot(&between(&corner(1, g), &corner(0, f)), &cross(&start, &end))
            }
        }
    }

    /// Returns a term of the volume in double-double.
    #[cfg(feature = "exact")]
    pub(super) fn counted(&self, term: &Term) -> Counted {
        self.value(term, |of, k| self.passage(of, self.crossing(of, k)))
    }

    #[cfg(feature = "exact")]
    pub(super) fn crossing(&self, of: usize, k: u32) -> &Crossing {
        &self.crossings.of[of].all[k as usize]
    }

    /// Returns the exponent of a number far below every width, in stored units cubed.
    #[cfg(feature = "exact")]
    pub(super) fn least_exponent(&self) -> i32 {
        3 * exponent_of(self.surfaces.size().larger(f64::MIN_POSITIVE)) - FIXED_BITS
    }

    /// Returns the mean of the other body's winding number along the edge of a face.
    pub(super) fn mean(&self, term: &Term, passages: &[Vec<Passage<Counted>>; 2]) -> f64 {
        let &Term::Face { of, t, first, end } = term else {
            return 0.0;
        };
        let side = &self.crossings.of[of];
        let part =
            |&(_, k): &(u32, u32)| f64::from(side.all[k as usize].leaves) * passages[of][k as usize].part.value.hi;
        f64::from(self.base(of, t).0) + side.based[first..end].iter().map(part).sum::<f64>()
    }

    pub(super) fn segments(&self) -> &[Segment] {
        &self.crossings.segments
    }

    pub(super) fn corners(&self, of: usize, t: u32) -> Triangle {
        self.surfaces.of[of].corners(t)
    }

    /// Returns the caller's index of a triangle.
    pub(super) fn number(&self, of: usize, t: u32) -> u32 {
        self.surfaces.of[of].mesh.source_triangles[t as usize]
    }

    /// Returns a point in the caller's unit, in A's frame.
    pub(super) fn given(&self, p: &Vector3<f64>) -> Point3<f64> {
        self.surfaces.of[0].mesh.given(p)
    }

    /// Returns the square of one stored unit in the caller's unit.
    pub(super) fn square_unit(&self) -> f64 {
        let unit = self.surfaces.of[0].mesh.unit();
        unit * unit
    }

    /// Returns the sum of all terms.
    pub(super) fn total(&self, terms: &[Term]) -> Total {
        let passages = self.passages();
        let mut total = Total::default();
        for term in terms {
            let six = self.value(term, |of, k| passages[of][k as usize].clone());
            total.six = total.six.plus(&six);
            match *term {
                Term::Face { of, t, first, end } => self.add_face(of, t, first..end, &passages[of], &mut total),
                Term::Segment(k) => self.add_segment(k, &passages, &mut total),
            }
        }
        if total.six.error > 0.0 {
            total.six.error += terms.len() as f64 * self.lost();
        }
        total
    }

    /// Returns a bound of what a term loses by underflow.
    pub(super) fn lost(&self) -> f64 {
        lost(self.unit)
    }

    /// Returns a coordinate about the origin of the sums in units of the moments.
    fn lever(&self, x: f64, k: usize) -> Counted {
        Counted::difference(x, self.origin[k]).scaled(1.0 / self.unit)
    }

    /// Adds to the moments along an axis.
    fn add(&self, total: &mut Total, k: usize, moment: &Counted) {
        total.moment[k] = total.moment[k].plus(moment).lossy(self.lost());
    }

    /// Adds the moments of a face.
    fn add_face(
        &self,
        of: usize,
        t: u32,
        based: core::ops::Range<usize>,
        passages: &[Passage<Counted>],
        total: &mut Total,
    ) {
        let (surface, side) = (&self.surfaces.of[of], &self.crossings.of[of]);
        let (winding, edge) = self.base(of, t);
        // The integrals of the winding number, and of twice the winding number times the part.
        let mut mean = Counted::whole(winding);
        let mut tilt = mean;
        for &(_, k) in &side.based[based] {
            let part = &passages[k as usize].part;
            let sign = Counted::whole(side.all[k as usize].leaves);
            (mean, tilt) = (mean.plus(&sign.times(part)), tilt.plus(&sign.times(part).times(part)));
        }
        let corners = surface.corners(t);
        let six = six::<Counted>(&corners, &self.origin);
        let [p, q] = edge.each(|v| surface.point(v));
        for k in 0..3 {
            let [corner, low, high] = [corners[0][k], p[k], q[k]].each(|x| self.lever(x, k));
            let level = mean.times(&corner.plus(&low).plus(&low));
            let moment = six.times(&level.plus(&tilt.times(&high.minus(&low))));
            self.add(total, k, &moment);
        }
    }

    /// Adds the moments of a segment.
    fn add_segment(&self, k: usize, passages: &[Vec<Passage<Counted>>; 2], total: &mut Total) {
        let Segment { of, ends } = self.crossings.segments[k];
        let [start, end] = ends.each(|(of, number)| &passages[of][number as usize].point);
        let across = cross(start, end);
        for (body, sign) in [(0, 1.0), (1, -1.0)] {
            let surface = &self.surfaces.of[body];
            let corner = surface.point(surface.vertices(of[body])[0]);
            let six = dot(&between(&self.origin, corner), &across).scaled(sign);
            for k in 0..3 {
                let ends = start[k].plus(&end[k]).scaled(1.0 / self.unit);
                self.add(total, k, &six.times(&self.lever(corner[k], k).plus(&ends)));
            }
        }
    }

    /// Returns the centre of mass in the stored frame of A, and a bound of the error of each
    /// coordinate. `None` if they are not finite.
    ///
    /// Six times a volume of `doubt` is counted or not.
    pub(super) fn centroid(&self, total: &Total, doubt: f64) -> Option<(Vector3<f64>, f64)> {
        // Half of the common box, with its rounding.
        let reach = self.surfaces.size() + self.surfaces.grown();
        total.centre(&self.origin, self.unit, [doubt, reach])
    }
}
