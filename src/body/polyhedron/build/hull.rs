//! Convex hull of points by quickhull with conflict lists (Barber, Dobkin, Huhdanpaa 1996; conflict
//! sets after Clarkson and Shor 1989). Every decision is an exact sign.
//!
//! The hull is a closed surface of triangles. A point outside waits in the conflict list of one
//! triangle that it sees. The farthest point of a list is added. The triangles visible from this
//! point (a connected set) are removed, and new triangles join the boundary of the set, the
//! *horizon*, to the point. The points that waited on removed triangles move to new triangles or
//! are found to be inside.
//!
//! ```text
//!             apex
//!            / | \           new triangles: horizon edge and apex
//!           /  |  \
//!     ---- from - to ----    horizon edge
//!        unseen triangle
//! ```
//!
//! Departures from the paper:
//! 1. Signs are exact, so there are no thick facets and no merging during the construction. A
//!    triangle counts as unseen if the point lies in its plane. Then the horizon is a simple closed
//!    curve, no new triangle is degenerate, and exactly coplanar triangles are merged at the end
//!    (`facets`).
//! 2. Distances only choose the next point; they decide nothing.
//!
//! A waiting point must be tested against the new triangles only. A point that sees both triangles
//! at a horizon edge sees the new triangle between them, because the plane of that triangle is a
//! positive combination of their planes. And the set of triangles that a point sees is connected.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::callbacks::Watch;
use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::sign::{projection, side};
use crate::base::tolerance::{SIDE_ERROR, SIDE_FINE};
use crate::body::polyhedron::build::cloud::bounding_box;

pub(crate) const NONE: u32 = u32::MAX;

/// Triangles of a generation from which it pays to sort them.
const GENERATION: usize = 256;

/// A triangle of the hull's surface, counter-clockwise from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HullTriangle {
    pub(crate) v: [u32; 3],
    /// The triangles on the other side of the edges, edge k leading from `v[k]` to `v[k + 1]`.
    pub(crate) adjacent: [u32; 3],
}

/// The triangulated hull of a cloud.
pub(crate) struct HullSurface {
    pub(crate) triangles: Vec<HullTriangle>,
    /// For each point a triangle in whose plane the point lies, or `NONE`: only points with such a
    /// triangle lie on the surface without being a vertex.
    pub(crate) touching: Vec<u32>,
}

/// Points that span the affine hull of a flat cloud, by number its dimension plus one.
pub(crate) type AffineSpan = Vec<u32>;

struct HullFacet {
    triangle: HullTriangle,
    base: Vector3<f64>,
    normal: Vector3<f64>,
    /// Bound above which `|normal . (p - base)|` proves the sign for every point p of the cloud.
    guard: f64,
    /// Head of the conflict list of this triangle.
    first: u32,
    /// Head of the list of points in the plane that are not outside.
    touching: u32,
    farthest: u32,
    height: f64,
    /// Twice the number of the last insertion that tested this triangle, plus one if the triangle
    /// was visible.
    mark: u32,
    alive: bool,
}

struct Hull<'a> {
    points: &'a [Vector3<f64>],
    /// Sides of the bounding box.
    sides: Vector3<f64>,
    facets: Vec<HullFacet>,
    free: Vec<u32>,
    /// Triangles on which points may wait, oldest first: the hull then grows equally on all sides,
    /// which keeps horizons short.
    pending: Vec<u32>,
    /// The next point of the conflict list, for each point.
    next: Vec<u32>,
    insertion: u32,
    /// Points that are vertices of the hull so far, or inside it.
    settled: usize,
    seen: Vec<u32>,
    /// Horizon edges as `[from, to, unseen triangle]`.
    horizon: Vec<[u32; 3]>,
    fresh: Vec<u32>,
    /// The new triangle whose horizon edge starts at a vertex, for each vertex.
    starting_at: Vec<u32>,
    /// Normals in double-double of triangles that needed one, by index; may be shorter than
    /// `facets`.
    fine: Vec<Option<[DoubleDouble; 3]>>,
}

/// The reason for which points have no hull.
pub(crate) enum NoHull {
    /// All points lie in one plane.
    Flat(AffineSpan),
    /// The horizon of a point is no loop: cannot happen with exact signs.
    Inconsistent,
    /// The caller has stopped the call.
    Stopped,
}

/// Returns the hull of distinct points.
pub(crate) fn hull(points: &[Vector3<f64>], watch: &mut Watch<'_>) -> Result<HullSurface, NoHull> {
    let mut hull = Hull::new(points);
    hull.begin(simplex(points).map_err(NoHull::Flat)?);
    watch.stage("hull", Some(points.len())).map_err(|_| NoHull::Stopped)?;
    // Generation after generation, each along the curve of the cloud: the hull then grows equally
    // on all sides, which keeps horizons short, and the data in use are close together in memory.
    let mut generation: Vec<(u32, u32)> = Vec::new();
    while !hull.pending.is_empty() {
        generation.clear();
        let facets = &hull.facets;
        generation.extend(hull.pending.drain(..).map(|f| (facets[f as usize].farthest, f)));
        if generation.len() > GENERATION {
            generation.sort_unstable();
        }
        for &(_, facet) in &generation {
            let f = &hull.facets[facet as usize];
            if f.alive && f.first != NONE {
                hull.add(facet).ok_or(NoHull::Inconsistent)?;
                if !watch.done(hull.settled) {
                    return Err(NoHull::Stopped);
                }
            }
        }
    }
    Ok(hull.finish())
}

impl<'a> Hull<'a> {
    fn new(points: &'a [Vector3<f64>]) -> Self {
        let (low, high) = bounding_box(points);
        Self {
            points,
            sides: high - low,
            facets: Vec::with_capacity(64 + 2 * points.len()),
            free: Vec::new(),
            pending: Vec::new(),
            next: vec![NONE; points.len()],
            insertion: 0,
            settled: 0,
            seen: Vec::new(),
            horizon: Vec::new(),
            fresh: Vec::new(),
            starting_at: vec![NONE; points.len()],
            fine: Vec::new(),
        }
    }

    /// Creates the first tetrahedron; the last vertex must lie below the first three.
    fn begin(&mut self, [a, b, c, d]: [u32; 4]) {
        // The adjacent triangles follow from the order: 0 = abc, 1 = adb, 2 = bdc, 3 = cda.
        self.create([a, b, c], [1, 2, 3]);
        self.create([a, d, b], [3, 2, 0]);
        self.create([b, d, c], [1, 3, 0]);
        self.create([c, d, a], [2, 1, 0]);
        self.fresh.extend(0..4);
        for p in 0..self.points.len() as u32 {
            if ![a, b, c, d].contains(&p) {
                self.hand_over(p);
            }
        }
        self.pending.extend(0..4);
    }

    fn create(&mut self, v: [u32; 3], adjacent: [u32; 3]) -> u32 {
        let [a, b, c] = v.each(|i| self.points[i as usize]);
        let (u, w) = (b - a, c - a);
        let guard = guard(&u, &w, &self.sides);
        let facet = HullFacet {
            triangle: HullTriangle { v, adjacent },
            base: a,
            normal: u.cross(&w),
            guard,
            first: NONE,
            touching: NONE,
            farthest: NONE,
            height: 0.0,
            mark: 0,
            alive: true,
        };
        match self.free.pop() {
            Some(slot) => {
                self.facets[slot as usize] = facet;
                if let Some(fine) = self.fine.get_mut(slot as usize) {
                    *fine = None;
                }
                slot
            }
            None => {
                self.facets.push(facet);
                self.facets.len() as u32 - 1
            }
        }
    }

    /// Returns the height of `p` above `facet`: a rounded value with an exact sign.
    #[inline]
    fn height(&mut self, facet: u32, p: u32) -> f64 {
        let f = &self.facets[facet as usize];
        let height = side_height(&f.normal, &f.base, &self.points[p as usize]);
        if height.abs() > f.guard {
            height
        } else {
            self.exact_height(facet, p)
        }
    }

    #[cold]
    fn exact_height(&mut self, facet: u32, p: u32) -> f64 {
        let f = &self.facets[facet as usize];
        let [a, b, c] = f.triangle.v.each(|i| &self.points[i as usize]);
        let p = &self.points[p as usize];
        // If every term vanishes by itself (axis-parallel planes), the sum needs no exact
        // arithmetic.
        if products(&(b - a), &(c - a)).dot(&(p - a).abs()) == 0.0 {
            return 0.0;
        }
        // In clouds flat to rounding every point comes here; nearly all are decided by twice the
        // digits.
        if self.fine.len() <= facet as usize {
            self.fine.resize(self.facets.len(), None);
        }
        let difference = |q: &Vector3<f64>| [0, 1, 2].each(|k| DoubleDouble::sum(q[k], -a[k]));
        let n = *self.fine[facet as usize].get_or_insert_with(|| {
            let (u, w) = (difference(b), difference(c));
            [(1, 2), (2, 0), (0, 1)].each(|(i, j)| u[i] * w[j] - u[j] * w[i])
        });
        let d = difference(p);
        let height = (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]).hi;
        if height.abs() > f.guard * SIDE_FINE + f64::MIN_POSITIVE {
            height
        } else {
            side(a, b, c, p)
        }
    }

    /// Puts `p` into the conflict list of a new triangle that it sees, if any, or else into the
    /// list of a new triangle in whose plane it lies.
    ///
    /// If the triangle of a point on the surface is removed, the point stays on the surface only on
    /// the horizon, where a new triangle holds the point.
    fn hand_over(&mut self, p: u32) {
        let mut touched = NONE;
        for k in 0..self.fresh.len() {
            let facet = self.fresh[k];
            let height = self.height(facet, p);
            if height > 0.0 {
                let f = &mut self.facets[facet as usize];
                self.next[p as usize] = f.first;
                f.first = p;
                if height > f.height || height == f.height && p < f.farthest {
                    (f.height, f.farthest) = (height, p);
                }
                return;
            }
            if height == 0.0 {
                touched = facet;
            }
        }
        match self.facets.get_mut(touched as usize) {
            Some(f) => {
                self.next[p as usize] = f.touching;
                f.touching = p;
            }
            None => self.settled += 1,
        }
    }

    /// Adds the farthest point of the conflict list of `facet` to the hull.
    fn add(&mut self, facet: u32) -> Option<()> {
        let apex = self.facets[facet as usize].farthest;
        self.find_visible(facet, apex);
        self.add_cone(apex)?;
        for k in 0..self.seen.len() {
            let old = &self.facets[self.seen[k] as usize];
            for mut p in [old.first, old.touching] {
                while p != NONE {
                    let after = self.next[p as usize];
                    if p != apex {
                        self.hand_over(p);
                    }
                    p = after;
                }
            }
        }
        self.free.append(&mut self.seen);
        let facets = &self.facets;
        self.pending
            .extend(self.fresh.iter().filter(|&&f| facets[f as usize].first != NONE));
        Some(())
    }

    /// Collects the triangles visible from `apex`, starting from one of them, and the horizon.
    fn find_visible(&mut self, start: u32, apex: u32) {
        self.insertion += 1;
        self.settled += 1;
        let (unseen, seen) = (2 * self.insertion, 2 * self.insertion + 1);
        self.seen.clear();
        self.horizon.clear();
        self.seen.push(start);
        self.facets[start as usize].mark = seen;
        let mut k = 0;
        while k < self.seen.len() {
            let HullTriangle { v, adjacent } = self.facets[self.seen[k] as usize].triangle;
            for (i, &other) in adjacent.iter().enumerate() {
                if self.facets[other as usize].mark < unseen {
                    let sees = self.height(other, apex) > 0.0;
                    self.facets[other as usize].mark = if sees { seen } else { unseen };
                    if sees {
                        self.seen.push(other);
                    }
                }
                if self.facets[other as usize].mark == unseen {
                    self.horizon.push([v[i], v[(i + 1) % 3], other]);
                }
            }
            k += 1;
        }
    }

    /// Replaces the visible triangles by a cone from the horizon to `apex`. `None` if the horizon
    /// is not closed.
    fn add_cone(&mut self, apex: u32) -> Option<()> {
        self.fresh.clear();
        for &f in &self.seen {
            self.facets[f as usize].alive = false;
        }
        for k in 0..self.horizon.len() {
            let [from, to, other] = self.horizon[k];
            let fresh = self.create([from, to, apex], [other, NONE, NONE]);
            let outer = &mut self.facets[other as usize].triangle;
            let slot = outer.v.iter().position(|&v| v == to)?;
            outer.adjacent[slot] = fresh;
            self.starting_at[from as usize] = fresh;
            self.fresh.push(fresh);
        }
        for k in 0..self.fresh.len() {
            let (fresh, to) = (self.fresh[k], self.horizon[k][1]);
            let after = self.starting_at[to as usize];
            self.facets.get_mut(after as usize)?.triangle.adjacent[2] = fresh;
            self.facets[fresh as usize].triangle.adjacent[1] = after;
        }
        Some(())
    }

    /// Returns the remaining triangles, renumbered without gaps.
    fn finish(self) -> HullSurface {
        let mut number = vec![NONE; self.facets.len()];
        let slots = number.iter_mut().zip(&self.facets).filter(|(_, f)| f.alive);
        slots.zip(0u32..).for_each(|((slot, _), count)| *slot = count);
        let alive = self.facets.iter().filter(|f| f.alive);
        let renumber = |t: &HullTriangle| HullTriangle {
            v: t.v,
            adjacent: t.adjacent.each(|b| number[b as usize]),
        };
        let mut touching = vec![NONE; self.points.len()];
        for (f, triangle) in alive.clone().zip(0u32..) {
            let mut p = f.touching;
            while p != NONE {
                touching[p as usize] = triangle;
                p = self.next[p as usize];
            }
        }
        HullSurface {
            triangles: alive.map(|f| renumber(&f.triangle)).collect(),
            touching,
        }
    }
}

/// Returns the height of `p` over a triangle with a corner `base`, times twice the triangle's area.
#[inline(always)]
pub(crate) fn side_height(normal: &Vector3<f64>, base: &Vector3<f64>, p: &Vector3<f64>) -> f64 {
    normal.dot(&(p - base))
}

/// Returns the bound of the error of such heights over a triangle with edges `u` and `w`, for
/// points in a box with these sides.
#[inline(always)]
pub(crate) fn guard(u: &Vector3<f64>, w: &Vector3<f64>, sides: &Vector3<f64>) -> f64 {
    SIDE_ERROR * products(u, w).dot(sides) * (1.0 + SIDE_ERROR) + f64::MIN_POSITIVE
}

/// Returns, coordinate by coordinate, the sum of the magnitudes of the two products in `u x v`.
#[inline]
fn products(u: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let (u, v) = (u.abs(), v.abs());
    Vector3::new(u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x)
}

/// Returns four points not in one plane, the last below the first three, or, for a flat cloud,
/// points that span the affine hull.
fn simplex(points: &[Vector3<f64>]) -> Result<[u32; 4], AffineSpan> {
    let at = |i: u32| &points[i as usize];
    let all = || 0..points.len() as u32;
    if points.len() < 2 {
        return Err(all().collect());
    }
    // Measures only propose; if the proposal is degenerate, every point is tried exactly.
    let a = largest(all(), |i| -at(i).x);
    let b = largest(all(), |i| (at(i) - at(a)).norm_squared());
    let b = if a == b { (a + 1) % points.len() as u32 } else { b };
    let axis = at(b) - at(a);
    let c = largest(all(), |i| axis.cross(&(at(i) - at(a))).norm_squared());
    let spans = |i: u32| projection(at(a), at(b), at(i)).is_some();
    let Some(c) = Some(c).filter(|&c| spans(c)).or_else(|| all().find(|&i| spans(i))) else {
        return Err(vec![a, b]);
    };
    let normal = axis.cross(&(at(c) - at(a)));
    let d = largest(all(), |i| normal.dot(&(at(i) - at(a))).abs());
    let height = |i: u32| side(at(a), at(b), at(c), at(i));
    let Some(d) = Some(d)
        .filter(|&d| height(d) != 0.0)
        .or_else(|| all().find(|&i| height(i) != 0.0))
    else {
        return Err(vec![a, b, c]);
    };
    Ok(if height(d) < 0.0 { [a, b, c, d] } else { [a, c, b, d] })
}

/// Returns the first index of the largest measure.
fn largest(indices: impl Iterator<Item = u32>, measure: impl Fn(u32) -> f64) -> u32 {
    let mut best = (0, f64::NEG_INFINITY);
    for i in indices {
        let m = measure(i);
        if m > best.1 {
            best = (i, m);
        }
    }
    best.0
}
