//! A feature projected along the normal: its vertices in the perpendicular plane, and their
//! heights. The local coordinates of a contact ([`Axes`]) are plane coordinates perpendicular to
//! the normal, and heights along it.

use nalgebra::Vector3;
use wide::f64x4;

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::COPLANAR;
use crate::body::polyhedron::fans::LARGE;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, HalfEdgeId, VertexId};
use crate::convex::contact::clip::Location;

/// Contact axes in the stored frame of a body: two directions perpendicular to the normal, the
/// normal, and the witness point of the body as the origin.
pub(super) struct Axes {
    pub(super) tangents: [Vector3<f64>; 2],
    pub(super) normal: Vector3<f64>,
    pub(super) witness: Vector3<f64>,
    /// Rounding of a plane coordinate.
    pub(super) noise: f64,
}

impl Axes {
    /// Returns plane coordinates and height of a stored point.
    #[inline(always)]
    pub(super) fn to_local(&self, p: &Vector3<f64>) -> [f64; 3] {
        let d = p - self.witness;
        [self.tangents[0].dot(&d), self.tangents[1].dot(&d), self.normal.dot(&d)]
    }

    /// Returns the stored point at given plane coordinates and height.
    #[inline(always)]
    pub(super) fn point(&self, [x, y]: [f64; 2], height: f64) -> Vector3<f64> {
        self.witness + self.tangents[0] * x + self.tangents[1] * y + self.normal * height
    }
}

/// Plane of a face as a height field over the contact plane: the height at the witness point, and
/// the descent along both axes.
#[derive(Clone, Copy, Default)]
pub(super) struct FacePlane2 {
    level: f64,
    fall: [f64; 2],
}

impl FacePlane2 {
    /// Returns the plane of a face; the face must not be parallel to the normal.
    #[inline(always)]
    pub(super) fn new(body: &ConvexPolyhedron, f: FaceId, axes: &Axes) -> Self {
        let t = &body.topology;
        let m = &body.planes[f.index()].normal;
        let vertex = body.points[t.half_edge(t.rim_half_edge(f)).to.index()];
        let up = 1.0 / m.dot(&axes.normal);
        Self {
            level: m.dot(&(vertex - axes.witness)) * up,
            fall: axes.tangents.each(|e| m.dot(&e) * up),
        }
    }

    #[inline(always)]
    pub(super) fn height(&self, [x, y]: [f64; 2]) -> f64 {
        self.level - self.fall[0] * x - self.fall[1] * y
    }
}

/// Slots for the vertices of a small face plus a repeated first vertex, in fours for SIMD.
pub(super) const SLOTS: usize = LARGE + 4;

/// A feature, with its projection computed at first use.
pub(super) struct LazyProjection<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    pub(super) feature: Feature,
    pub(super) axes: &'a Axes,
    backward: bool,
    projection: Option<ProjectedFeature<'a>>,
}

impl<'a> LazyProjection<'a> {
    /// Returns a feature that is not projected yet. `backward` must be set for B: the outward
    /// normal of its face is opposite to the contact normal, so its half-edges are clockwise.
    #[inline(always)]
    pub(super) fn new(body: &'a ConvexPolyhedron, feature: Feature, axes: &'a Axes, backward: bool) -> Self {
        Self {
            body,
            feature,
            axes,
            backward,
            projection: None,
        }
    }

    #[inline(always)]
    pub(super) fn get(&mut self) -> &ProjectedFeature<'a> {
        self.projection.get_or_insert_with(|| {
            let mut projection = ProjectedFeature::new(self.body, self.feature, self.axes, self.backward);
            projection.project();
            projection
        })
    }
}

/// The vertices of a projected face, or the ends of an edge, counter-clockwise around the normal.
///
/// Up to [`LARGE`] vertices are projected at once; the vertices of larger faces on demand.
pub(super) struct ProjectedFeature<'a> {
    body: &'a ConvexPolyhedron,
    pub(super) axes: &'a Axes,
    pub(super) feature: Feature,
    pub(super) count: usize,
    /// Plane coordinates; after the last vertex of a small face the first vertex is repeated.
    pub(super) x: [f64; SLOTS],
    pub(super) y: [f64; SLOTS],
    vertices: [VertexId; LARGE],
    /// Edge from each vertex to the next.
    edges: [EdgeId; LARGE],
    /// Half-edges of a large face, to be read in reverse order if `backward`.
    ring: Option<&'a [HalfEdgeId]>,
    backward: bool,
    plane: FacePlane2,
}

impl<'a> ProjectedFeature<'a> {
    #[inline(always)]
    fn new(body: &'a ConvexPolyhedron, feature: Feature, axes: &'a Axes, backward: bool) -> Self {
        Self {
            body,
            axes,
            feature,
            count: 0,
            x: [0.0; SLOTS],
            y: [0.0; SLOTS],
            vertices: [VertexId(0); LARGE],
            edges: [EdgeId(0); LARGE],
            ring: None,
            backward,
            plane: FacePlane2::default(),
        }
    }

    /// Projects the feature; a vertex has no projection.
    #[inline(always)]
    fn project(&mut self) {
        let t = &self.body.topology;
        match self.feature {
            Feature::Vertex(_) => {}
            Feature::Edge(e) => {
                for (k, v) in [t.from(e.half_edge()), t.half_edge(e.half_edge()).to]
                    .into_iter()
                    .enumerate()
                {
                    [self.x[k], self.y[k]] = self.position_of(&self.body.points[v.index()]);
                    (self.vertices[k], self.edges[k]) = (v, e);
                }
                self.count = 2;
            }
            Feature::Face(f) => {
                self.plane = FacePlane2::new(self.body, f, self.axes);
                self.ring = t.ring(f);
                match self.ring {
                    Some(ring) => self.count = ring.len(),
                    None => self.outline(f),
                }
            }
        }
    }

    /// Collects the vertices of a face together with adjacent faces coplanar up to rounding:
    /// together they are the intended face.
    #[inline(always)]
    fn outline(&mut self, f: FaceId) {
        let t = &self.body.topology;
        let start = t.rim_half_edge(f);
        if !(self.body.has_coplanar_neighbours && self.outline_coplanar(f)) {
            self.walk(start, |_| false);
        }
        let n = self.count;
        if self.backward {
            self.vertices[..n].reverse();
            // The edge from a vertex is now the edge that led to the vertex.
            self.edges[..n - 1].reverse();
        }
        for k in 0..n {
            let p = &self.body.points[self.vertices[k].index()];
            [self.x[k], self.y[k]] = self.position_of(p);
        }
        (self.x[n], self.y[n]) = (self.x[0], self.y[0]);
    }

    /// Collects the outline of several coplanar faces; returns whether an outline was found, of at
    /// most [`LARGE`] vertices.
    #[cold]
    fn outline_coplanar(&mut self, f: FaceId) -> bool {
        let (t, planes) = (&self.body.topology, &self.body.planes);
        let n = planes[f.index()].normal;
        let within = |h: HalfEdgeId| {
            let m = &planes[t.half_edge(t.half_edge(h).twin).face.index()].normal;
            m.dot(&n) > 0.0 && m.cross(&n).norm_squared() <= COPLANAR * COPLANAR
        };
        // Rotates around the first vertex, out of the coplanar faces.
        let mut start = t.rim_half_edge(f);
        for _ in 0..t.fan(t.from(start)).len() {
            if !within(start) {
                return self.walk(start, within) && self.count > 2;
            }
            start = t.half_edge(t.half_edge(start).twin).next;
        }
        false
    }

    /// Collects the vertices along a face boundary from a half-edge on, skipping edges `within` the
    /// merged face; returns whether the boundary closed within the capacity.
    #[inline(always)]
    fn walk(&mut self, start: HalfEdgeId, within: impl Fn(HalfEdgeId) -> bool) -> bool {
        let t = &self.body.topology;
        self.count = 0;
        let (mut h, mut v) = (start, t.from(start));
        while self.count < LARGE {
            let e = t.half_edge(h);
            (self.vertices[self.count], self.edges[self.count]) = (v, EdgeId::of(h, e.twin));
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

    /// Returns the id of a vertex.
    #[inline(always)]
    fn vertex_id(&self, k: usize) -> VertexId {
        let Some(ring) = self.ring else {
            return self.vertices[k];
        };
        // The end of the previous half-edge; going backward, the end of the half-edge from here.
        let h = match (self.backward, k) {
            (true, _) => ring[self.count - 1 - k],
            (false, 0) => ring[self.count - 1],
            (false, _) => ring[k - 1],
        };
        self.body.topology.half_edge(h).to
    }

    /// Returns the feature that contains a location.
    pub(super) fn feature_at(&self, on: Location) -> Feature {
        match (on.as_vertex(), on.as_edge()) {
            (Some(k), _) => Feature::Vertex(self.vertex_id(k)),
            (_, Some(k)) => self.edge(k),
            _ => self.feature,
        }
    }

    /// Returns the edge from a vertex to the next.
    fn edge(&self, k: usize) -> Feature {
        let edge = match self.ring {
            None => self.edges[k],
            Some(ring) => {
                let h = ring[if self.backward { self.count - 1 - k } else { k }];
                self.body.topology.edge(h)
            }
        };
        Feature::Edge(edge)
    }

    /// Returns plane coordinates and height of a vertex.
    #[inline(always)]
    pub(super) fn vertex(&self, k: usize) -> [f64; 3] {
        self.axes.to_local(&self.body.points[self.vertex_id(k).index()])
    }

    /// Returns plane coordinates and height of both ends of an edge.
    #[inline(always)]
    pub(super) fn ends(&self, k: usize) -> [[f64; 3]; 2] {
        [self.vertex(k), self.vertex(self.next(k))]
    }

    /// Returns the plane coordinates of a vertex.
    #[inline(always)]
    pub(super) fn position(&self, k: usize) -> [f64; 2] {
        if self.ring.is_none() {
            return [self.x[k], self.y[k]];
        }
        self.position_of(&self.body.points[self.vertex_id(k).index()])
    }

    /// Returns the plane coordinates of a stored point.
    #[inline(always)]
    pub(super) fn position_of(&self, p: &Vector3<f64>) -> [f64; 2] {
        let d = p - self.axes.witness;
        self.axes.tangents.each(|e| e.dot(&d))
    }

    /// Returns the least and greatest plane coordinates of a small face. Beyond the apex of a
    /// sliver a distant point may be inside every side up to rounding; there the span bounds the
    /// face.
    #[inline(always)]
    pub(super) fn span(&self) -> [[f64; 2]; 2] {
        let of = |c: &[f64]| {
            let coordinates = c[..self.count].iter();
            coordinates.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| {
                [if x < low { x } else { low }, if x > high { x } else { high }]
            })
        };
        [of(&self.x), of(&self.y)]
    }

    /// Lower bound of the distance by which a point is inside the face. For large faces it is only
    /// 0 if the point is inside, and minus infinity otherwise.
    #[inline(always)]
    pub(super) fn inside_by(&self, at: [f64; 2]) -> f64 {
        if self.is_large() {
            return if self.contains(self.middle(), at) {
                0.0
            } else {
                f64::NEG_INFINITY
            };
        }
        let span = self.span();
        let past_extreme = |k: usize| (at[k] - span[k][0]).smaller(span[k][1] - at[k]);
        let (x, y) = (f64x4::splat(at[0]), f64x4::splat(at[1]));
        let four =
            |list: &[f64; SLOTS], k: usize| list[k..].first_chunk().map_or(f64x4::ZERO, |four| f64x4::new(*four));
        let mut least = past_extreme(0).smaller(past_extreme(1));
        for k in (0..self.count).step_by(4) {
            let (px, py) = (four(&self.x, k), four(&self.y, k));
            let (ux, uy) = (four(&self.x, k + 1) - px, four(&self.y, k + 1) - py);
            // The sum of two coordinates is at least the length.
            let inside = (ux * (y - py) - uy * (x - px)) / (ux.abs() + uy.abs());
            for inside in &inside.to_array()[..(self.count - k).min(4)] {
                // NaN is outside.
                least = if *inside >= least { least } else { *inside };
            }
        }
        least
    }

    /// Returns the height of the face over a point of the plane.
    #[inline(always)]
    pub(super) fn height_on_face(&self, at: [f64; 2]) -> f64 {
        self.plane.height(at)
    }

    /// Returns the height over a point of the plane: of the face, or of the edge at the point's
    /// foot.
    pub(super) fn height_at(&self, at: [f64; 2]) -> f64 {
        if self.is_edge() {
            self.height_on_edge(0, at)
        } else {
            self.height_on_face(at)
        }
    }

    /// Returns the parameter along edge `k` of the foot of a point, from 0 to 1.
    #[inline(always)]
    pub(super) fn along(&self, k: usize, [x, y]: [f64; 2]) -> f64 {
        let (p, q) = (self.position(k), self.position(self.next(k)));
        let u = [q[0] - p[0], q[1] - p[1]];
        let squared = u[0] * u[0] + u[1] * u[1];
        let t = ((x - p[0]) * u[0] + (y - p[1]) * u[1]) / squared;
        // On an edge of length zero returns the start.
        if t > 0.0 { t.at_most(1.0) } else { 0.0 }
    }

    /// Returns the height of edge `k` at the foot of a point of the plane.
    #[inline(always)]
    pub(super) fn height_on_edge(&self, k: usize, at: [f64; 2]) -> f64 {
        let (p, q) = (self.vertex(k), self.vertex(self.next(k)));
        p[2] + self.along(k, at) * (q[2] - p[2])
    }

    /// Returns the stored point at plane coordinates, on the given location.
    pub(super) fn point(&self, on: Location, at: [f64; 2]) -> Vector3<f64> {
        let vertex = |k: usize| self.body.points[self.vertex_id(k).index()];
        let on_edge = |k: usize| {
            let (p, q) = (vertex(k), vertex(self.next(k)));
            p + (q - p) * self.along(k, at)
        };
        match (on.as_vertex(), on.as_edge()) {
            (Some(k), _) => vertex(k),
            (_, Some(k)) => on_edge(k),
            _ if self.is_edge() => on_edge(0),
            _ => self.axes.point(at, self.height_on_face(at)),
        }
    }
}
