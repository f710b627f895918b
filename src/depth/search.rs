//! The search for the deepest facet: a surface grown at its nearest triangle until that is known to lie on the border.

use crate::minimum::gjk::{Minimum, solve};
use crate::minimum::simplex::Simplex;
use crate::minimum::witnesses::witnesses;
use crate::num::scalar::{Scalar, Vec3, dot, neg};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::difference::{difference_point, support};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::FeaturePair;
use crate::tolerance::{AGREE_DEPTH, ALMOST_FLAT, ASIDE, CERTIFICATE, PLATEAU, UNIT};

use crate::depth::direction::unit;
use crate::depth::facet::{facets, height_of, normal_of};
use crate::depth::result::{Best, End, Found};
use crate::depth::surface::{Filter, Surface};
use crate::tuning::depth::REPEATS;

/// A surface on its way to the deepest facet.
pub(super) struct Search<'a, T: Scalar> {
    pub(super) posed: &'a PosedPair<'a>,
    frame: Transform<T>,
    /// Whether B is shifted off its place.
    is_shifted: bool,
    pub(super) surface: &'a mut Surface<T>,
    filter: Filter<T>,
    best: Option<Best<T>>,
    size: T,
    grown: u32,
    repeats: u32,
}

/// Searches from the features of an overlap, about the origin or, one after the other, points shifted off it. The best that
/// was found where none closes; where one does, `surface` is its.
pub(super) fn search<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    from: FeaturePair,
    shifts: &[f64],
    surface: &mut Surface<T>,
) -> Option<Found<T>> {
    let mut found: Option<Found<T>> = None;
    let mut grown = 0;
    for &shift in shifts {
        let now = match Search::about(posed, frame, from, shift, surface) {
            Ok(mut search) => search.run(frame, shift),
            Err(found) => found,
        };
        grown += now.grown;
        let (end, open) = (now.end, now.height - now.radius);
        if found.as_ref().is_none_or(|f| open < f.height - f.radius) {
            found = Some(now);
        }
        if end != End::Stuck {
            break;
        }
    }
    found.map(|f| Found { grown, ..f })
}

/// What a solver knows of an origin that it cannot tell from the border: a direction and its height.
fn flat<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, simplex: &Simplex<T>, toward: &Vec3<T>) -> Found<T> {
    let zero = T::from(0.0);
    let n = unit(&neg(toward));
    let is_unit = dot(&n, &n).value() > 0.5;
    let normal = if is_unit { n } else { [T::from(1.0), zero, zero] };
    let hint = simplex.kept()[0];
    let height = dot(&normal, &support(posed, frame, &normal, &hint).w);
    Found {
        end: End::Stuck,
        normal,
        height,
        radius: zero,
        corners: core::array::from_fn(|k| simplex.kept()[k.min(simplex.len() - 1)]),
        // No points of the border, but ones that nearly coincide.
        witnesses: (simplex.reach() <= T::from(AGREE_DEPTH * posed.size())).then(|| witnesses(posed, simplex)),
        features: None,
        grown: 0,
    }
}

impl<'a, T: Scalar> Search<'a, T> {
    /// From the tetrahedron that proves a point beside the origin inside; without one, what the solver found instead:
    /// of a point outside, a direction along which the origin is not deeper than the shift.
    fn about(
        posed: &'a PosedPair<'a>,
        frame: &Transform<T>,
        from: FeaturePair,
        shift: f64,
        surface: &'a mut Surface<T>,
    ) -> Result<Self, Found<T>> {
        let size = posed.reach::<T>().whole();
        let mut shifted = *frame;
        for (t, aside) in shifted.translation.iter_mut().zip(ASIDE) {
            *t = *t + T::from(aside * shift * size);
        }
        let simplex = match solve(posed, &shifted, from) {
            Minimum::Inside { simplex } => simplex,
            Minimum::Outside { simplex, direction, .. } => return Err(flat(posed, frame, &simplex, &direction)),
        };
        if !surface.start(simplex.kept()) {
            return Err(flat(posed, frame, &simplex, &simplex.direction()));
        }
        let mut search = Self::new(posed, &shifted, surface);
        search.is_shifted = shift != 0.0;
        Ok(search)
    }

    fn new(posed: &'a PosedPair<'a>, frame: &Transform<T>, surface: &'a mut Surface<T>) -> Self {
        let size = posed.reach::<T>().whole();
        Self {
            posed,
            frame: *frame,
            is_shifted: false,
            surface,
            filter: Filter {
                margin: T::from(2.0 * CERTIFICATE * T::UNIT * size),
                noise: T::from(PLATEAU / UNIT * T::UNIT * size),
            },
            best: None,
            size: T::from(size),
            grown: 0,
            repeats: 0,
        }
    }

    /// From a surface that is about the origin, and a direction.
    pub(super) fn resumed(
        posed: &'a PosedPair<'a>,
        frame: &Transform<T>,
        surface: &'a mut Surface<T>,
        best: Best<T>,
    ) -> Self {
        let mut search = Self::new(posed, frame, surface);
        search.improve(best);
        search
    }

    /// Of a surface of which every triangle is known to be beyond `radius`, as far as the best direction.
    pub(super) fn stands(&mut self, radius: T) -> Found<T> {
        Found {
            radius,
            ..self.end(End::Closed, true)
        }
    }

    /// Takes the direction if it is the best: triangles as far as it is high are then beyond doubt.
    fn improve(&mut self, b: Best<T>) {
        // No direction has no height; NaN is no better than anything.
        if dot(&b.normal, &b.normal).value() > 0.5 && self.best.is_none_or(|best| b.height < best.height) {
            self.surface.expect(b.height - self.open(T::UNIT));
            self.best = Some(b);
        }
    }

    /// How far height and bound may be apart, for the rounding of an arithmetic.
    fn open(&self, rounding: f64) -> T {
        T::from(AGREE_DEPTH / UNIT * rounding) * self.size
    }

    /// Grows until the ball about the shifted point holds the origin, then about the origin.
    pub(super) fn run(&mut self, frame: &Transform<T>, shift: f64) -> Found<T> {
        if shift != 0.0 {
            // ASIDE is no longer than one.
            let reached = self.grow(Some(
                T::from(shift.abs()) * self.size + self.filter.margin + self.filter.margin,
            ));
            (self.frame, self.is_shifted) = (*frame, false);
            let posed = self.posed;
            self.surface.place(|c| difference_point(posed, frame, c.a, c.b));
            self.best = None;
            if !reached {
                return self.end(End::Stuck, false);
            }
        }
        let end = if self.grow(None) || self.is_good() {
            End::Closed
        } else if self.is_full() {
            End::Full
        } else {
            End::Stuck
        };
        self.end(end, true)
    }

    /// Whether the bounds agree as well as they have to, though they might do better in a finer arithmetic.
    fn is_good(&mut self) -> bool {
        let bound = self.bound();
        self.best
            .is_some_and(|b| b.height - bound <= T::from(AGREE_DEPTH * self.posed.size()))
    }

    /// What every triangle is beyond.
    fn bound(&mut self) -> T {
        match self.surface.weakest() {
            Some(t) => self.surface.triangles[t as usize].bound,
            None => self.surface.enough(),
        }
    }

    fn is_full(&self) -> bool {
        let vertices = self.posed.a.points.len() + self.posed.b.points.len();
        self.surface.triangles.len() > 64 * vertices + 1024
    }

    /// Grows the surface: whether every triangle came to be beyond `goal` or, without one, the bounds agree.
    fn grow(&mut self, goal: Option<T>) -> bool {
        while !self.is_full() {
            let Some(t) = self.surface.weakest() else {
                return goal.is_none_or(|goal| self.surface.enough() > goal);
            };
            let bound = self.surface.triangles[t as usize].bound;
            if goal.is_some_and(|goal| bound > goal) {
                return true;
            }
            if self.best.is_some_and(|b| self.surface.raise(t, &b.normal)) {
                continue;
            }
            // Comparisons are written so that NaN ends the search.
            if !(bound > self.filter.margin) {
                return false;
            }
            let direction = self.surface.triangles[t as usize].direction;
            let top = self.probe(t, &direction);
            let gain = dot(&direction, &top.w) - bound;
            if gain < T::from(ALMOST_FLAT) * self.size && self.probe_facets(t) || bound >= self.surface.enough() {
                continue;
            }
            let top = self.in_sight(t, top);
            if !(gain > T::from(0.0)) || !self.is_worth(&top) {
                return false;
            }
            self.grown += 1;
            self.surface.insert(t, top, &self.filter);
        }
        false
    }

    /// A point outside the plane of a triangle, so that the surface stays convex: the one found or, where that was along a
    /// direction from elsewhere and is not, the highest along the normal.
    fn in_sight(&mut self, t: u32, top: MinkowskiPoint<T>) -> MinkowskiPoint<T> {
        if self.surface.sees(t, &top.w, &self.filter) {
            return top;
        }
        let outward = self.surface.triangles[t as usize].outward;
        if !(dot(&outward, &outward).value() > 0.5) {
            return top;
        }
        let other = self.probe(t, &outward);
        if self.surface.sees(t, &other.w, &self.filter) {
            other
        } else {
            top
        }
    }

    /// Counts points that are there already.
    fn is_worth(&mut self, c: &MinkowskiPoint<T>) -> bool {
        if self.surface.knows(c) {
            self.repeats += 1;
        }
        self.repeats < REPEATS
    }

    /// The highest point of the difference along a unit direction; the direction is kept if it is the best.
    fn probe(&mut self, t: u32, n: &Vec3<T>) -> MinkowskiPoint<T> {
        let top = support(self.posed, &self.frame, n, &self.surface.corners(t)[0]);
        self.improve(Best {
            normal: *n,
            height: dot(n, &top.w),
            features: None,
        });
        top
    }

    /// Tries the facets that the triangle may lie in; whether the normal of one of them raises its bound.
    fn probe_facets(&mut self, t: u32) -> bool {
        let corners = self.surface.corners(t);
        let mut raised = false;
        let facets = facets(self.posed, &corners.map(|c| c.a), &corners.map(|c| c.b));
        for facet in facets.into_iter().flatten() {
            let Some((normal, height)) = self.height_of(facet, &corners[0]) else {
                continue;
            };
            self.improve(Best {
                normal,
                height,
                features: Some(facet),
            });
            raised |= self.surface.raise(t, &normal);
        }
        raised
    }

    /// The normal of a facet that holds `on`, and the height along it: by the planes of the bodies where those are where they belong.
    fn height_of(&self, facet: FeaturePair, on: &MinkowskiPoint<T>) -> Option<(Vec3<T>, T)> {
        if T::UNIT == UNIT && !self.is_shifted {
            let (n, height) = height_of(self.posed, &Transform::of(self.posed), facet)?;
            return Some((n.map(T::from), T::from(height)));
        }
        let n = normal_of(self.posed, &self.frame, facet, on)?;
        Some((n, dot(&n, &support(self.posed, &self.frame, &n, on).w)))
    }

    /// What is known; `winds` if the surface is about the origin.
    fn end(&mut self, end: End, winds: bool) -> Found<T> {
        let zero = T::from(0.0);
        let weakest = self.surface.weakest();
        if self.best.is_none() {
            let t = weakest.unwrap_or(0);
            let direction = self.surface.triangles[t as usize].direction;
            self.probe(t, &direction);
        }
        let bound = self.bound();
        let best = self.best.unwrap_or(Best {
            normal: [T::from(1.0), zero, zero],
            height: T::from(f64::INFINITY),
            features: None,
        });
        let (corners, witnesses) = self.deepest(&best, weakest.unwrap_or(0), end);
        Found {
            end,
            normal: best.normal,
            height: best.height,
            radius: if winds && bound > zero { bound } else { zero },
            corners,
            witnesses: Some(witnesses),
            features: best.features,
            grown: self.grown,
        }
    }
}
