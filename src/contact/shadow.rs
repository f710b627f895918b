//! A feature seen along the normal: its corners in the plane across, and their heights.

use nalgebra::Vector3;

use crate::polyhedron::topology::LARGE;
use crate::polyhedron::{ConvexPolyhedron, Feature};

/// Two directions across the normal and the normal, in one body's stored frame, about that body's witness.
pub(super) struct Axes {
    pub(super) across: [Vector3<f64>; 2],
    pub(super) normal: Vector3<f64>,
    pub(super) witness: Vector3<f64>,
}

impl Axes {
    /// Place and height of a stored point.
    #[inline(always)]
    pub(super) fn see(&self, p: &Vector3<f64>) -> [f64; 3] {
        let d = p - self.witness;
        [self.across[0].dot(&d), self.across[1].dot(&d), self.normal.dot(&d)]
    }

    /// The stored point at a place and height.
    #[inline(always)]
    pub(super) fn point(&self, [x, y]: [f64; 2], height: f64) -> Vector3<f64> {
        self.witness + self.across[0] * x + self.across[1] * y + self.normal * height
    }
}

/// The plane of a face: heights over places.
#[derive(Clone, Copy, Default)]
pub(super) struct Slope {
    level: f64,
    rise: [f64; 2],
}

impl Slope {
    /// Of the face `f`, which is not upright.
    #[inline(always)]
    pub(super) fn new(body: &ConvexPolyhedron, f: u32, axes: &Axes) -> Self {
        let m = &body.planes[f as usize].normal;
        let corner = body.points[body.topology.half_edge(body.topology.rim_start(f)).to as usize];
        let up = 1.0 / m.dot(&axes.normal);
        Self {
            level: m.dot(&(corner - axes.witness)) * up,
            rise: [m.dot(&axes.across[0]) * up, m.dot(&axes.across[1]) * up],
        }
    }

    #[inline(always)]
    pub(super) fn height(&self, [x, y]: [f64; 2]) -> f64 {
        self.level - self.rise[0] * x - self.rise[1] * y
    }
}

/// The corners of a face with at most [`LARGE`] of them, or the ends of an edge; counter-clockwise about the normal.
pub(super) struct Shadow {
    pub(super) feature: Feature,
    pub(super) count: usize,
    /// Place and height.
    pub(super) corners: [[f64; 3]; LARGE],
    pub(super) vertices: [u32; LARGE],
    /// The edge from each corner to the next.
    pub(super) edges: [u32; LARGE],
    pub(super) slope: Slope,
}

impl Shadow {
    /// Of an edge or a small face; a vertex has none. `below`: the body lies before the other along the normal, so that its
    /// face is seen from outside.
    pub(super) fn new(body: &ConvexPolyhedron, feature: Feature, axes: &Axes, below: bool) -> Option<Self> {
        let t = &body.topology;
        let mut shadow = Self {
            feature,
            count: 0,
            corners: [[0.0; 3]; LARGE],
            vertices: [0; LARGE],
            edges: [0; LARGE],
            slope: Slope::default(),
        };
        match feature {
            Feature::Vertex(_) => return None,
            Feature::Edge(e) => {
                for (k, v) in [t.from(e.0), t.half_edge(e.0).to].into_iter().enumerate() {
                    shadow.corners[k] = axes.see(&body.points[v as usize]);
                    shadow.vertices[k] = v;
                    shadow.edges[k] = e.0;
                }
                shadow.count = 2;
            }
            Feature::Face(f) => {
                shadow.slope = Slope::new(body, f.0, axes);
                shadow.fill(body, f.0, axes);
                if !below {
                    shadow.turn_round();
                }
            }
        }
        Some(shadow)
    }

    fn fill(&mut self, body: &ConvexPolyhedron, f: u32, axes: &Axes) {
        let t = &body.topology;
        let start = t.rim_start(f);
        let mut h = start;
        let mut v = t.from(start);
        for k in 0..LARGE {
            let e = t.half_edge(h);
            self.corners[k] = axes.see(&body.points[v as usize]);
            self.vertices[k] = v;
            self.edges[k] = h.min(e.twin);
            self.count = k + 1;
            (v, h) = (e.to, e.next);
            if h == start {
                break;
            }
        }
    }

    /// Corners in reverse; the edges between them then begin one place earlier.
    fn turn_round(&mut self) {
        let n = self.count;
        self.corners[..n].reverse();
        self.vertices[..n].reverse();
        self.edges[..n].reverse();
        self.edges[..n].rotate_left(1);
    }

    pub(super) fn is_edge(&self) -> bool {
        self.count == 2
    }

    #[inline(always)]
    pub(super) fn next(&self, k: usize) -> usize {
        if k + 1 == self.count { 0 } else { k + 1 }
    }

    /// The part of the way along edge `k` at which a place lies.
    #[inline(always)]
    pub(super) fn along(&self, k: usize, [x, y]: [f64; 2]) -> f64 {
        let (p, q) = (self.corners[k], self.corners[self.next(k)]);
        let u = [q[0] - p[0], q[1] - p[1]];
        let squared = u[0] * u[0] + u[1] * u[1];
        let t = ((x - p[0]) * u[0] + (y - p[1]) * u[1]) / squared;
        // Written so that the end of an edge of no length is its beginning.
        if t > 0.0 { t.min(1.0) } else { 0.0 }
    }

    /// The height over a place beside edge `k`, or on the face.
    #[inline(always)]
    pub(super) fn height_on_edge(&self, k: usize, at: [f64; 2]) -> f64 {
        let (p, q) = (self.corners[k], self.corners[self.next(k)]);
        p[2] + self.along(k, at) * (q[2] - p[2])
    }
}
