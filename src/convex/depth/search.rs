//! Search for the deepest facet: grows a polytope at its nearest triangle until this triangle is
//! proven to lie on the boundary of A - B. This file contains the search ([`DepthSearch`]), its
//! result ([`SearchResult`]), and the deepest points after the search has ended.
//!
//! A search may start at a facet ([`search_from`]): the first tetrahedron joins three points of the
//! facet to a point deep in P = A - B. The facet found by a descent is usually the deepest. So its
//! height is a target from the start, and the polytope grows only where P is uncertain. The overlap
//! need not be known: the tetrahedron proves it.

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, scaled, sub};
use crate::base::tolerance::{AGREE_DEPTH, AGREE_WITNESS, ALMOST_FLAT, CERTIFICATE, PLATEAU, SHIFT_DIRECTION, UNIT};
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::convex::depth::descent::{WitnessPoints, foot, sample_rim};
use crate::convex::depth::polytope::{EnclosingSurface, Filter, unit};
use crate::convex::minimum::simplex::Simplex;
use crate::convex::minimum::{Minimum, solve, vertex_of, witnesses};
use crate::pair::difference::DifferenceFacet;
use crate::pair::difference::{MinkowskiPoint, difference_point, support};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Number of repeated points before a polytope counts as folded and the next arithmetic runs.
const REPEATS: u32 = 16;

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SearchEnd {
    /// Both bounds agree.
    Closed,
    /// Rounding hides the next step.
    Stuck,
    /// The polytope reached its limit of triangles.
    Full,
}

/// Proven bounds and final state of a search.
pub(super) struct SearchResult<T> {
    pub(super) end: SearchEnd,
    /// Best unit direction and the support value of A - B along it.
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    /// Every point outside A - B is at least this far from the origin; zero if nothing is known.
    pub(super) radius: T,
    /// Triangle that contains the deepest point, or a triangle of the facet.
    pub(super) vertices: [MinkowskiPoint<T>; 3],
    /// Deepest points of A and of B in their stored frames.
    pub(super) witnesses: Option<WitnessPoints>,
    pub(super) features: Option<FeaturePair>,
    /// Number of points added to the polytope.
    pub(super) points_added: u32,
}

impl SearchResult<f64> {
    /// Returns the result if the difference contains the ball up to the best facet, which has
    /// witnesses.
    pub(super) fn proven(best: &Best<f64>, witnesses: WitnessPoints, size: f64) -> Self {
        Self::of_facet(best, witnesses, best.height - AGREE_DEPTH * size)
    }

    /// Returns the result if the difference contains a ball of this radius, with the best facet and
    /// its witnesses.
    pub(super) fn of_facet(best: &Best<f64>, witnesses: WitnessPoints, radius: f64) -> Self {
        Self {
            end: SearchEnd::Closed,
            normal: best.normal,
            height: best.height,
            radius,
            vertices: [MinkowskiPoint::default(); 3],
            witnesses: Some(witnesses),
            features: best.facet.map(DifferenceFacet::features),
            points_added: 0,
        }
    }
}

/// A direction, the support value along it, and the facet whose normal it is.
#[derive(Clone, Copy)]
pub(super) struct Best<T> {
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    pub(super) facet: Option<DifferenceFacet>,
}

impl<T: Scalar> Best<T> {
    /// Returns normal and height rounded to f64.
    pub(super) fn rounded(&self) -> Best<f64> {
        Best {
            normal: self.normal.each(Scalar::value),
            height: self.height.value(),
            facet: self.facet,
        }
    }
}

/// A polytope during the search for the deepest facet.
pub(super) struct DepthSearch<'a, T: Scalar> {
    pub(super) posed: &'a PosedPair<'a>,
    frame: Transform<T>,
    /// Whether B is perturbed off its pose.
    is_shifted: bool,
    pub(super) surface: &'a mut EnclosingSurface<T>,
    filter: Filter<T>,
    best: Option<Best<T>>,
    size: T,
    points_added: u32,
    repeats: u32,
}

/// Searches from the features of an overlap, around the origin or, one after the other, around
/// perturbed points. Returns the best result if no search closes; if a search closes, `surface` is
/// its polytope.
pub(super) fn search<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    from: FeaturePair,
    shifts: &[f64],
    surface: &mut EnclosingSurface<T>,
) -> Option<SearchResult<T>> {
    let mut found: Option<SearchResult<T>> = None;
    let mut points_added = 0;
    for &shift in shifts {
        let now = match DepthSearch::enclosing(posed, frame, from, shift, surface) {
            Ok(mut search) => search.run(frame, shift),
            Err(found) => found,
        };
        points_added += now.points_added;
        let (end, gap) = (now.end, now.height - now.radius);
        if found.as_ref().is_none_or(|f| gap < f.height - f.radius) {
            found = Some(now);
        }
        if end != SearchEnd::Stuck {
            break;
        }
    }
    found.map(|f| SearchResult { points_added, ..f })
}

/// Returns the result if GJK cannot decide whether the origin is inside: the last direction and the
/// support value along it, an upper bound of the depth.
fn undecided<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    simplex: &Simplex<T>,
    toward: &Vec3<T>,
) -> SearchResult<T> {
    let zero = T::from(0.0);
    let n = unit(&neg(toward));
    let is_unit = dot(&n, &n).value() > 0.5;
    let normal = if is_unit { n } else { [T::from(1.0), zero, zero] };
    let hint = simplex.points()[0];
    let height = dot(&normal, &support(posed, frame, &normal, &hint).w);
    SearchResult {
        end: SearchEnd::Stuck,
        normal,
        height,
        radius: zero,
        vertices: core::array::from_fn(|k| simplex.points()[k.min(simplex.len() - 1)]),
        // Not boundary points of A - B, but nearly coincident points.
        witnesses: (simplex.witness_distance() <= T::from(AGREE_DEPTH * posed.size()))
            .then(|| witnesses(posed, simplex)),
        features: None,
        points_added: 0,
    }
}

impl<'a, T: Scalar> DepthSearch<'a, T> {
    /// Starts from the tetrahedron that proves a perturbed origin to be inside. Without a
    /// tetrahedron, returns the solver's result: if the point is outside, a direction along which
    /// the origin is at most as deep as the perturbation.
    fn enclosing(
        posed: &'a PosedPair<'a>,
        frame: &Transform<T>,
        from: FeaturePair,
        shift: f64,
        surface: &'a mut EnclosingSurface<T>,
    ) -> Result<Self, SearchResult<T>> {
        let size = posed.error_scale::<T>().total();
        let mut shifted = *frame;
        for (t, offset) in shifted.translation.iter_mut().zip(SHIFT_DIRECTION) {
            *t = *t + T::from(offset * shift * size);
        }
        let simplex = match solve(posed, &shifted, vertex_of(posed, &shifted, from)) {
            Minimum::Inside { simplex } => simplex,
            Minimum::Outside { simplex, direction, .. } => return Err(undecided(posed, frame, &simplex, &direction)),
        };
        if !surface.start(simplex.points()) {
            return Err(undecided(posed, frame, &simplex, &simplex.direction()));
        }
        let mut search = Self::new(posed, &shifted, surface);
        search.is_shifted = shift != 0.0;
        Ok(search)
    }

    fn new(posed: &'a PosedPair<'a>, frame: &Transform<T>, surface: &'a mut EnclosingSurface<T>) -> Self {
        let size = posed.error_scale::<T>().total();
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
            points_added: 0,
            repeats: 0,
        }
    }

    /// Continues from a polytope that encloses the origin, and a direction.
    pub(super) fn resumed(
        posed: &'a PosedPair<'a>,
        frame: &Transform<T>,
        surface: &'a mut EnclosingSurface<T>,
        best: Best<T>,
    ) -> Self {
        let mut search = Self::new(posed, frame, surface);
        search.improve(best);
        search
    }

    /// Returns the result for a polytope whose triangles are all known to be beyond `radius`, up to
    /// the best direction.
    pub(super) fn proven(&mut self, radius: T) -> SearchResult<T> {
        SearchResult {
            radius,
            ..self.end(SearchEnd::Closed, true)
        }
    }

    /// Keeps the direction if its support value is the lowest so far: triangles beyond it then need
    /// no further work.
    fn improve(&mut self, b: Best<T>) {
        // A zero vector has no support; NaN is never better.
        if dot(&b.normal, &b.normal).value() > 0.5 && self.best.is_none_or(|best| b.height < best.height) {
            self.surface.set_target(b.height - self.accepted_gap(T::UNIT));
            self.best = Some(b);
        }
    }

    /// Returns the accepted gap between support and bound, for the rounding of an arithmetic.
    fn accepted_gap(&self, rounding: f64) -> T {
        T::from(AGREE_DEPTH / UNIT * rounding) * self.size
    }

    /// Grows until the ball around the perturbed point contains the origin, and then around the
    /// origin.
    pub(super) fn run(&mut self, frame: &Transform<T>, shift: f64) -> SearchResult<T> {
        if shift != 0.0 {
            // The length of SHIFT_DIRECTION is at most one.
            let reached = self.grow(Some(
                T::from(shift.abs()) * self.size + self.filter.margin + self.filter.margin,
            ));
            (self.frame, self.is_shifted) = (*frame, false);
            let posed = self.posed;
            self.surface.reposition(|c| difference_point(posed, frame, c.a, c.b));
            self.best = None;
            if !reached {
                return self.end(SearchEnd::Stuck, false);
            }
        }
        let end = if self.grow(None) || self.has_close_bounds() {
            SearchEnd::Closed
        } else if self.is_full() {
            SearchEnd::Full
        } else {
            SearchEnd::Stuck
        };
        self.end(end, true)
    }

    /// Returns whether the bounds agree as closely as required, though a finer arithmetic might
    /// improve them.
    fn has_close_bounds(&mut self) -> bool {
        let bound = self.bound();
        self.best
            .is_some_and(|b| b.height - bound <= T::from(AGREE_DEPTH * self.posed.size()))
    }

    /// Returns the height beyond which every triangle lies.
    fn bound(&mut self) -> T {
        match self.surface.weakest() {
            Some(t) => self.surface.triangles[t as usize].bound,
            None => self.surface.target(),
        }
    }

    fn is_full(&self) -> bool {
        let vertices = self.posed.a.points.len() + self.posed.b.points.len();
        self.surface.triangles.len() > 64 * vertices + 1024
    }

    /// Grows the polytope. Returns whether every triangle is beyond `goal` or, without a goal,
    /// whether the bounds agree.
    fn grow(&mut self, goal: Option<T>) -> bool {
        while !self.is_full() {
            let Some(t) = self.surface.weakest() else {
                return goal.is_none_or(|goal| self.surface.target() > goal);
            };
            let bound = self.surface.triangles[t as usize].bound;
            if goal.is_some_and(|goal| bound > goal) {
                return true;
            }
            if self.best.is_some_and(|b| self.surface.improve_bound(t, &b.normal)) {
                continue;
            }
            // NaN ends the search.
            if !(bound > self.filter.margin) {
                return false;
            }
            let direction = self.surface.triangles[t as usize].direction;
            let top = self.probe(t, &direction);
            let gain = dot(&direction, &top.w) - bound;
            if gain < T::from(ALMOST_FLAT) * self.size && self.probe_facets(t) || bound >= self.surface.target() {
                continue;
            }
            let top = self.visible_point(t, top);
            if !(gain > T::from(0.0)) || !self.has_few_repeats(&top) {
                return false;
            }
            self.points_added += 1;
            self.surface.insert(t, top, &self.filter);
        }
        false
    }

    /// Returns a point outside the plane of a triangle, so that the polytope stays convex.
    ///
    /// This is `top`, or the support point along the normal if `top` was found along another
    /// direction and lies inside. If neither is outside, returns `top`.
    fn visible_point(&mut self, t: u32, top: MinkowskiPoint<T>) -> MinkowskiPoint<T> {
        if self.surface.is_visible(t, &top.w, &self.filter) {
            return top;
        }
        let outward = self.surface.triangles[t as usize].outward;
        if !(dot(&outward, &outward).value() > 0.5) {
            return top;
        }
        let other = self.probe(t, &outward);
        if self.surface.is_visible(t, &other.w, &self.filter) {
            other
        } else {
            top
        }
    }

    /// Counts points that are already on the polytope; returns whether repeats are still few.
    fn has_few_repeats(&mut self, c: &MinkowskiPoint<T>) -> bool {
        if self.surface.contains_pair(c) {
            self.repeats += 1;
        }
        self.repeats < REPEATS
    }

    /// Returns the support point of A - B along a unit direction, and keeps the direction if it is
    /// the best.
    fn probe(&mut self, t: u32, n: &Vec3<T>) -> MinkowskiPoint<T> {
        let top = support(self.posed, &self.frame, n, &self.surface.vertices(t)[0]);
        self.improve(Best {
            normal: *n,
            height: dot(n, &top.w),
            facet: None,
        });
        top
    }

    /// Tries the facets that may contain the triangle; returns whether a facet normal raised the
    /// bound.
    fn probe_facets(&mut self, t: u32) -> bool {
        let vertices = self.surface.vertices(t);
        let mut improved = false;
        let facets = DifferenceFacet::at(self.posed, &vertices.each(|c| c.a), &vertices.each(|c| c.b));
        for facet in facets.into_iter().flatten() {
            let Some((normal, height)) = self.height_of(facet, &vertices[0]) else {
                continue;
            };
            self.improve(Best {
                normal,
                height,
                facet: Some(facet),
            });
            improved |= self.surface.improve_bound(t, &normal);
        }
        improved
    }

    /// Returns the normal of a facet that contains `on`, and the support along the normal: from the
    /// face planes if the arithmetic is f64 and B is not perturbed.
    fn height_of(&self, facet: DifferenceFacet, on: &MinkowskiPoint<T>) -> Option<(Vec3<T>, T)> {
        if T::UNIT == UNIT && !self.is_shifted {
            let (n, height) = facet.height(self.posed, &Transform::of(self.posed))?;
            return Some((n.each(T::from), T::from(height)));
        }
        let n = facet.normal(self.posed, &self.frame, on)?;
        Some((n, dot(&n, &support(self.posed, &self.frame, &n, on).w)))
    }

    /// Returns the lowest of the facets that may contain three vertices, if the facet is as low as
    /// the best direction up to rounding. The height of a facet is computed from its features, so
    /// it does not depend on the path of the search.
    fn facet_at(&self, vertices: &[MinkowskiPoint<T>; 3], best: &Best<T>) -> Option<Best<T>> {
        let facets = DifferenceFacet::at(self.posed, &vertices.each(|c| c.a), &vertices.each(|c| c.b));
        let heights = facets.into_iter().flatten().filter_map(|facet| {
            let (normal, height) = self.height_of(facet, &vertices[0])?;
            Some(Best {
                normal,
                height,
                facet: Some(facet),
            })
        });
        let lowest = heights.min_by(|x, y| x.height.value().total_cmp(&y.height.value()))?;
        (lowest.height <= best.height + T::from(0.5) * self.accepted_gap(T::UNIT)).then_some(lowest)
    }

    /// Returns the final result; `winds` must be true only if the polytope encloses the origin.
    fn end(&mut self, end: SearchEnd, winds: bool) -> SearchResult<T> {
        let zero = T::from(0.0);
        let weakest = self.surface.weakest();
        if self.best.is_none() {
            let t = weakest.unwrap_or(0);
            let direction = self.surface.triangles[t as usize].direction;
            self.probe(t, &direction);
        }
        let bound = self.bound();
        let mut best = self.best.unwrap_or(Best {
            normal: [T::from(1.0), zero, zero],
            height: T::from(f64::INFINITY),
            facet: None,
        });
        let (mut vertices, mut witnesses) = self.deepest(&best, weakest.unwrap_or(0), end);
        if end == SearchEnd::Closed
            && best.facet.is_none()
            && let Some(facet) = self.facet_at(&vertices, &best)
        {
            best = facet;
            (vertices, witnesses) = self.deepest(&best, weakest.unwrap_or(0), end);
        }
        SearchResult {
            end,
            normal: best.normal,
            height: best.height,
            radius: if winds && bound > zero { bound } else { zero },
            vertices,
            witnesses: Some(witnesses),
            features: best.facet.map(DifferenceFacet::features),
            points_added: self.points_added,
        }
    }
}

/// Searches for the depth from a facet; `None` if the search does not close.
pub(super) fn search_from(
    posed: &PosedPair,
    frame: &Transform<f64>,
    facet: DifferenceFacet,
    surface: &mut EnclosingSurface<f64>,
) -> Option<SearchResult<f64>> {
    let (normal, height) = facet.height(posed, frame)?;
    let (v, w) = facet.features().vertices_of(posed.a, posed.b);
    let apex = support(posed, frame, &neg(&normal), &difference_point(posed, frame, v, w));
    let [p, q, r] = pierced(posed, frame, facet, &normal, &apex.w)?;
    let simplex = Simplex::tetrahedron([p, q, r, apex], posed.error_scale::<f64>());
    if !surface.start(simplex.points()) {
        return None;
    }
    let best = Best {
        normal,
        height,
        facet: Some(facet),
    };
    let found = DepthSearch::resumed(posed, frame, surface, best).run(frame, 0.0);
    (found.end == SearchEnd::Closed).then_some(found)
}

/// Returns the triangle of a facet through which the ray from `apex` to the origin leaves.
fn pierced(
    posed: &PosedPair,
    frame: &Transform<f64>,
    facet: DifferenceFacet,
    normal: &Vec3<f64>,
    apex: &Vec3<f64>,
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let along = neg(apex);
    let point = |(a, b): (VertexId, VertexId)| difference_point(posed, frame, a, b);
    // Whether the ray passes to the left of the segment from `p` to `q`, seen along the ray.
    let is_left = |p: &MinkowskiPoint<f64>, q: &MinkowskiPoint<f64>| {
        dot(&along, &cross(&sub(&p.w, apex), &sub(&q.w, apex))) >= 0.0
    };
    let corner = |k: u32, v: VertexId, w: VertexId| if k == 0 { (v, w) } else { (w, v) };
    let (first, rest) = match facet {
        DifferenceFacet::Edges(e, g) => {
            let (t, u) = (&posed.a.topology, &posed.b.topology);
            let (e, g) = (e.half_edge(), g.half_edge());
            let ((p, q), (x, y)) = ((t.from(e), t.half_edge(e).to), (u.from(g), u.half_edge(g).to));
            let c = [(p, x), (q, x), (q, y), (p, y)].each(point);
            let n = cross(&sub(&c[1].w, &c[0].w), &sub(&c[3].w, &c[0].w));
            let [p, q, r, s] = if dot(&n, normal) > 0.0 {
                c
            } else {
                [c[3], c[2], c[1], c[0]]
            };
            return Some(if is_left(&p, &r) { [p, r, s] } else { [p, q, r] });
        }
        DifferenceFacet::FaceVertex(f, v) => ((0, v), sample_rim(posed.a, f)),
        DifferenceFacet::VertexFace(v, f) => ((1, v), sample_rim(posed.b, f)),
    };
    let (side, other) = first;
    let body = if side == 0 { posed.a } else { posed.b };
    let corners = rest.map(|h| point(corner(side, body.topology.from(h), other)));
    fan_triangle(corners, side == 0, is_left)
}

/// Returns the triangle of the fan of a polygon around its first vertex that lies on the ray.
fn fan_triangle(
    mut corners: impl Iterator<Item = MinkowskiPoint<f64>>,
    counter_clockwise: bool,
    is_left: impl Fn(&MinkowskiPoint<f64>, &MinkowskiPoint<f64>) -> bool,
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let (root, mut from) = (corners.next()?, corners.next()?);
    let mut last = None;
    for to in corners {
        last = Some([root, from, to]);
        if is_left(&root, &to) != counter_clockwise {
            break;
        }
        from = to;
    }
    last
}

impl<T: Scalar> DepthSearch<'_, T> {
    /// Returns the deepest points and three vertices of their facet.
    ///
    /// If the features of the best direction do not contain the deepest points, these are the point
    /// of the polytope nearest to the foot of the origin on the best plane. The polytope crosses
    /// the ray along the normal between both bounds, so it crosses at the foot if the bounds agree.
    pub(super) fn deepest(
        &self,
        best: &Best<T>,
        weakest: u32,
        end: SearchEnd,
    ) -> ([MinkowskiPoint<T>; 3], WitnessPoints) {
        if let Some(foot) = best.facet.and_then(|f| foot(self.posed, f, &best.rounded())) {
            return (self.surface.vertices(weakest), foot);
        }
        // Relative to L in either arithmetic, not to the distance of far origins.
        let close = T::from(AGREE_DEPTH * self.posed.size());
        let plane = best.height - close;
        let all = 0..self.surface.triangles.len() as u32;
        let flat = all.clone().filter(|t| self.surface.height(*t, &best.normal) >= plane);
        let order = || core::iter::once(weakest).chain(flat.clone()).chain(all.clone());
        let found = self.nearest::<T>(order(), best, close);
        if T::UNIT < UNIT || found.1 <= AGREE_WITNESS * self.posed.size() {
            return (self.surface.vertices(found.0), found.2);
        }
        // In f64 the barycentric coordinates of needles are wrong.
        let mut found = self.nearest::<DoubleDouble>(flat.clone().chain(core::iter::once(found.0)), best, close);
        if end == SearchEnd::Closed && found.1 > AGREE_WITNESS * self.posed.size() {
            found = self.nearest::<DoubleDouble>(order(), best, close);
        }
        (self.surface.vertices(found.0), found.2)
    }

    /// Returns the first triangle close enough to the foot of the origin on the best plane (if
    /// there is none, the nearest triangle), the distance from the foot, and the witness points
    /// there.
    fn nearest<S: Scalar>(
        &self,
        triangles: impl Iterator<Item = u32>,
        best: &Best<T>,
        close: T,
    ) -> (u32, f64, WitnessPoints) {
        // Converts both parts of a double-double.
        let as_s = |x: T| S::from(x.value()) + S::from((x - T::from(x.value())).value());
        let fine = |v: &Vec3<T>| v.each(as_s);
        let target = scaled(&fine(&best.normal), as_s(best.height));
        let mut found: Option<(u32, f64, Simplex<S>)> = None;
        for t in triangles {
            let shifted = self.surface.vertices(t).each(|c| MinkowskiPoint {
                a: c.a,
                b: c.b,
                w: sub(&fine(&c.w), &target),
            });
            let simplex = Simplex::triangle(shifted);
            let off = simplex.witness_distance().value();
            if found.as_ref().is_none_or(|f| off < f.1) {
                found = Some((t, off, simplex));
            }
            if off <= close.value() {
                break;
            }
        }
        let (t, off, simplex) = found.unwrap_or_else(|| {
            let c = self.surface.vertices(0)[0];
            let at = MinkowskiPoint {
                a: c.a,
                b: c.b,
                w: fine(&c.w),
            };
            (0, f64::INFINITY, Simplex::vertex(at))
        });
        (t, off, witnesses(self.posed, &simplex))
    }
}
