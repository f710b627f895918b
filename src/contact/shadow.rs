//! A feature seen along the normal: its corners in the plane across, and their heights.

use nalgebra::Vector3;
use wide::f64x4;

use super::axes::{Axes, FacePlane2};
use super::corners::Location;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, Feature, VertexId};
use crate::tolerance::COPLANAR;
use crate::tuning::polyhedron::LARGE;

/// Corners of a small face, the first of them twice, in fours.
pub(super) const ROOM: usize = LARGE + 4;

/// A feature, and its shadow from when it is first looked at.
pub(super) struct LazyProjection<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    pub(super) feature: Feature,
    pub(super) axes: &'a Axes,
    backward: bool,
    shadow: Option<ProjectedFeature<'a>>,
}

impl<'a> LazyProjection<'a> {
    /// `backward`: the body lies behind the other along the normal, so that its face is seen from within.
    #[inline(always)]
    pub(super) fn new(body: &'a ConvexPolyhedron, feature: Feature, axes: &'a Axes, backward: bool) -> Self {
        Self {
            body,
            feature,
            axes,
            backward,
            shadow: None,
        }
    }

    #[inline(always)]
    pub(super) fn seen(&mut self) -> &ProjectedFeature<'a> {
        self.shadow.get_or_insert_with(|| {
            let mut shadow = ProjectedFeature::new(self.body, self.feature, self.axes, self.backward);
            shadow.cast();
            shadow
        })
    }
}

/// The corners of a face, or the ends of an edge, counter-clockwise about the normal.
///
/// Up to [`LARGE`] corners are seen at once; of larger faces each is looked at when it is needed.
pub(super) struct ProjectedFeature<'a> {
    body: &'a ConvexPolyhedron,
    axes: &'a Axes,
    pub(super) feature: Feature,
    pub(super) count: usize,
    /// Behind the last corner of a small face comes the first once more.
    pub(super) x: [f64; ROOM],
    pub(super) y: [f64; ROOM],
    vertices: [u32; LARGE],
    /// The edge from each corner to the next.
    edges: [u32; LARGE],
    /// The half-edges of a large face, and whether they go round the other way.
    ring: Option<&'a [u32]>,
    backward: bool,
    lean: FacePlane2,
}

impl<'a> ProjectedFeature<'a> {
    #[inline(always)]
    fn new(body: &'a ConvexPolyhedron, feature: Feature, axes: &'a Axes, backward: bool) -> Self {
        Self {
            body,
            axes,
            feature,
            count: 0,
            x: [0.0; ROOM],
            y: [0.0; ROOM],
            vertices: [0; LARGE],
            edges: [0; LARGE],
            ring: None,
            backward,
            lean: FacePlane2::default(),
        }
    }

    /// Takes in the feature; a vertex has no shadow.
    #[inline(always)]
    fn cast(&mut self) {
        let t = &self.body.topology;
        match self.feature {
            Feature::Vertex(_) => {}
            Feature::Edge(e) => {
                for (k, v) in [t.from(e.0), t.half_edge(e.0).to].into_iter().enumerate() {
                    [self.x[k], self.y[k]] = self.place_of(&self.body.points[v as usize]);
                    (self.vertices[k], self.edges[k]) = (v, e.0);
                }
                self.count = 2;
            }
            Feature::Face(f) => {
                self.lean = FacePlane2::new(self.body, f.0, self.axes);
                self.ring = t.ring(f.0);
                match self.ring {
                    Some(ring) => self.count = ring.len(),
                    None => self.go_round(f.0),
                }
            }
        }
    }

    /// The corners of a face, and of the faces beside it that lie in its plane but for rounding: together they are the face that
    /// was meant.
    #[inline(always)]
    fn go_round(&mut self, f: u32) {
        let t = &self.body.topology;
        let start = t.rim_start(f);
        if !(self.body.has_coplanar_neighbours && self.go_round_all(f)) {
            self.walk(start, |_| false);
        }
        let n = self.count;
        if self.backward {
            self.vertices[..n].reverse();
            // The edge from a corner is now the one that led to it.
            self.edges[..n - 1].reverse();
        }
        for k in 0..n {
            let p = &self.body.points[self.vertices[k] as usize];
            [self.x[k], self.y[k]] = self.place_of(p);
        }
        (self.x[n], self.y[n]) = (self.x[0], self.y[0]);
    }

    /// Whether an outline about several faces was found, of no more corners than there is room for.
    #[cold]
    fn go_round_all(&mut self, f: u32) -> bool {
        let (t, planes) = (&self.body.topology, &self.body.planes);
        let n = planes[f as usize].normal;
        let within = |h: u32| {
            let m = &planes[t.half_edge(t.half_edge(h).twin).face as usize].normal;
            m.dot(&n) > 0.0 && m.cross(&n).norm_squared() <= COPLANAR * COPLANAR
        };
        // Turns about the first corner, out of the faces that belong together.
        let mut start = t.rim_start(f);
        for _ in 0..t.fan(t.from(start)).len() {
            if !within(start) {
                return self.walk(start, within) && self.count > 2;
            }
            start = t.half_edge(t.half_edge(start).twin).next;
        }
        false
    }

    /// The corners along a rim from a half-edge on, past the edges within it; whether it closed in the room there is.
    #[inline(always)]
    fn walk(&mut self, start: u32, within: impl Fn(u32) -> bool) -> bool {
        let t = &self.body.topology;
        self.count = 0;
        let (mut h, mut v) = (start, t.from(start));
        while self.count < LARGE {
            let e = t.half_edge(h);
            (self.vertices[self.count], self.edges[self.count]) = (v, h.min(e.twin));
            self.count += 1;
            (v, h) = (e.to, e.next);
            let mut turns = 0;
            while within(h) && turns < LARGE {
                h = t.half_edge(t.half_edge(h).twin).next;
                turns += 1;
            }
            if h == start {
                return true;
            }
        }
        false
    }

    pub(super) fn is_edge(&self) -> bool {
        self.count == 2
    }

    pub(super) fn is_large(&self) -> bool {
        self.ring.is_some()
    }

    #[inline(always)]
    pub(super) fn next(&self, k: usize) -> usize {
        if k + 1 == self.count { 0 } else { k + 1 }
    }

    /// The number of a corner's vertex.
    #[inline(always)]
    fn number(&self, k: usize) -> u32 {
        let Some(ring) = self.ring else {
            return self.vertices[k];
        };
        // The head of the half-edge before; going backward, that of the edge from here.
        let h = match (self.backward, k) {
            (true, _) => ring[self.count - 1 - k],
            (false, 0) => ring[self.count - 1],
            (false, _) => ring[k - 1],
        };
        self.body.topology.half_edge(h).to
    }

    /// The name of what a point lies on.
    pub(super) fn name(&self, on: Location) -> Feature {
        match (on.as_corner(), on.as_edge()) {
            (Some(k), _) => Feature::Vertex(VertexId(self.number(k))),
            (_, Some(k)) => self.edge(k),
            _ => self.feature,
        }
    }

    /// The edge from a corner to the next.
    fn edge(&self, k: usize) -> Feature {
        let edge = match self.ring {
            None => self.edges[k],
            Some(ring) => {
                let h = ring[if self.backward { self.count - 1 - k } else { k }];
                self.body.topology.edge(h)
            }
        };
        Feature::Edge(EdgeId(edge))
    }

    /// Point2 and height of a corner.
    #[inline(always)]
    pub(super) fn corner(&self, k: usize) -> [f64; 3] {
        self.axes.see(&self.body.points[self.number(k) as usize])
    }

    /// Those of the ends of an edge.
    #[inline(always)]
    pub(super) fn ends(&self, k: usize) -> [[f64; 3]; 2] {
        [self.corner(k), self.corner(self.next(k))]
    }

    /// The same without the height.
    #[inline(always)]
    pub(super) fn place(&self, k: usize) -> [f64; 2] {
        if self.ring.is_none() {
            return [self.x[k], self.y[k]];
        }
        self.place_of(&self.body.points[self.number(k) as usize])
    }

    /// The place of a stored point.
    #[inline(always)]
    pub(super) fn place_of(&self, p: &Vector3<f64>) -> [f64; 2] {
        let d = p - self.axes.witness;
        self.axes.across.map(|e| e.dot(&d))
    }

    /// Least and greatest coordinates of the corners of a small face. Beyond the tip of a sliver a place may be inside of every side
    /// but for rounding, and far off: this is what ends the face there.
    #[inline(always)]
    pub(super) fn span(&self) -> [[f64; 2]; 2] {
        let of = |c: &[f64]| {
            let corners = c[..self.count].iter();
            corners.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| {
                [if x < low { x } else { low }, if x > high { x } else { high }]
            })
        };
        [of(&self.x), of(&self.y)]
    }

    /// How far a place is inside the face, at least; of large faces no more is known than whether it is.
    #[inline(always)]
    pub(super) fn inside_by(&self, at: [f64; 2]) -> f64 {
        if self.is_large() {
            return if self.holds(self.middle(), at) {
                0.0
            } else {
                f64::NEG_INFINITY
            };
        }
        let span = self.span();
        let past = |k: usize| (at[k] - span[k][0]).min(span[k][1] - at[k]);
        let (x, y) = (f64x4::splat(at[0]), f64x4::splat(at[1]));
        let four = |list: &[f64; ROOM], k: usize| list[k..].first_chunk().map_or(f64x4::ZERO, |four| f64x4::new(*four));
        let mut least = past(0).min(past(1));
        for k in (0..self.count).step_by(4) {
            let (px, py) = (four(&self.x, k), four(&self.y, k));
            let (ux, uy) = (four(&self.x, k + 1) - px, four(&self.y, k + 1) - py);
            // The sum of two coordinates is at least the length.
            let inside = (ux * (y - py) - uy * (x - px)) / (ux.abs() + uy.abs());
            for inside in &inside.to_array()[..(self.count - k).min(4)] {
                // Written so that NaN is outside.
                least = if *inside >= least { least } else { *inside };
            }
        }
        least
    }

    /// The height of the face over a place.
    #[inline(always)]
    pub(super) fn height_on_face(&self, at: [f64; 2]) -> f64 {
        self.lean.height(at)
    }

    /// The part of the way along edge `k` at which a place lies.
    #[inline(always)]
    pub(super) fn along(&self, k: usize, [x, y]: [f64; 2]) -> f64 {
        let (p, q) = (self.place(k), self.place(self.next(k)));
        let u = [q[0] - p[0], q[1] - p[1]];
        let squared = u[0] * u[0] + u[1] * u[1];
        let t = ((x - p[0]) * u[0] + (y - p[1]) * u[1]) / squared;
        // Written so that the end of an edge of no length is its beginning.
        if t > 0.0 { t.min(1.0) } else { 0.0 }
    }

    /// The height over a place beside edge `k`.
    #[inline(always)]
    pub(super) fn height_on_edge(&self, k: usize, at: [f64; 2]) -> f64 {
        let (p, q) = (self.corner(k), self.corner(self.next(k)));
        p[2] + self.along(k, at) * (q[2] - p[2])
    }

    /// The stored point at a place, on what it lies on.
    pub(super) fn point(&self, on: Location, at: [f64; 2]) -> Vector3<f64> {
        let corner = |k: usize| self.body.points[self.number(k) as usize];
        let on_edge = |k: usize| {
            let (p, q) = (corner(k), corner(self.next(k)));
            p + (q - p) * self.along(k, at)
        };
        match (on.as_corner(), on.as_edge()) {
            (Some(k), _) => corner(k),
            (_, Some(k)) => on_edge(k),
            _ if self.is_edge() => on_edge(0),
            _ => self.axes.point(at, self.height_on_face(at)),
        }
    }
}
