//! The features and facets of two bodies that carry the contacts. For polyhedra, the closest
//! features are replaced by those most nearly perpendicular to the normal ([`Promotion`]): a face,
//! or otherwise an edge. For curved shapes, the flat facets of the surfaces carry the contacts
//! ([`Facet`]): a face or an edge of a polyhedron, a flat round face, a generator of a curved side.

use core::f64::consts::FRAC_1_SQRT_2;

use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{STAY, STEEP};
use crate::body::polyhedron::fans::MANY;
use crate::body::polyhedron::fans::{Cycle, Fan, LARGE};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature, HalfEdgeId, VertexId};
use crate::convex::contact::ManifoldOptions;
use crate::convex::contact::clip::Location;
use crate::convex::contact::projection::{Axes, LazyProjection};

/// A body's outward contact direction, and the largest angle of a face or edge from it.
pub(super) struct Promotion<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    /// Unit direction away from the body, in the frame of the body.
    pub(super) outward: Vector3<f64>,
    /// Sine of the largest angle.
    pub(super) sine: f64,
    /// Feature that carried the contact before. Its largest accepted sine is larger by a quarter.
    pub(super) previous: Option<Feature>,
}

impl Promotion<'_> {
    /// Returns the face at `feature` most nearly perpendicular to the normal, if one is within the
    /// angle; otherwise the edge; otherwise `feature`.
    ///
    /// Tests the faces at the feature: the two faces of an edge, or the faces of a vertex's whole
    /// fan; in a large fan only the neighbourhood of the outermost face, found by bisection.
    pub(super) fn promote(&self, feature: Feature) -> Feature {
        let t = &self.body.topology;
        match feature {
            Feature::Face(f) => self.face([f]).unwrap_or(feature),
            Feature::Edge(e) => {
                let h = t.half_edge(e.half_edge());
                self.face([h.face, t.half_edge(h.twin).face]).unwrap_or(feature)
            }
            Feature::Vertex(v) => {
                let face = |h: HalfEdgeId| t.half_edge(h).face;
                let outward = |h: HalfEdgeId| self.body.planes[face(h).index()].normal.dot(&self.outward);
                let faces = self.sample_fan(t.fan(v), outward).map(face);
                let edges = || self.sample_fan(t.fan(v), |h| -self.rise(h));
                self.face(faces).or_else(|| self.edge(edges())).unwrap_or(feature)
            }
        }
    }

    /// Returns the half-edges of a fan; of a large fan, the half-edge of greatest measure and its
    /// two neighbours.
    fn sample_fan<M: Fn(HalfEdgeId) -> f64>(&self, fan: Fan, measure: M) -> impl Iterator<Item = HalfEdgeId> + use<M> {
        let m = fan.len();
        let (first, count) = if m <= MANY {
            (0, m)
        } else {
            (fan.top_index(measure) + m - 1, 3)
        };
        (first..first + count).map(move |k| fan.wrapped(k))
    }

    /// Returns the squared sine of the angle between an edge and the plane perpendicular to the
    /// outward direction.
    fn rise(&self, h: HalfEdgeId) -> f64 {
        let t = &self.body.topology;
        let u = self.body.points[t.half_edge(h).to.index()] - self.body.points[t.from(h).index()];
        let rise = u.dot(&self.outward);
        rise * rise / u.norm_squared()
    }

    /// Returns the largest squared sine accepted for a feature.
    fn max_squared_sine(&self, feature: Feature) -> f64 {
        let sine = if self.previous == Some(feature) {
            STAY * self.sine
        } else {
            self.sine
        };
        sine * sine
    }

    fn face(&self, faces: impl IntoIterator<Item = FaceId>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for f in faces {
            let n = &self.body.planes[f.index()].normal;
            let off = n.cross(&self.outward).norm_squared();
            let feature = Feature::Face(f);
            // The null face of a segment has no normal.
            if n.dot(&self.outward) > STEEP
                && off <= self.max_squared_sine(feature)
                && best.is_none_or(|(least, _)| off < least)
            {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }

    fn edge(&self, fan: impl Iterator<Item = HalfEdgeId>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for h in fan {
            let off = self.rise(h);
            let feature = Feature::Edge(self.body.topology.edge(h));
            if off <= self.max_squared_sine(feature) && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }
}

/// A flat round face perpendicular to the z axis, with its centre on the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundFace {
    pub(crate) z: f64,
    pub(crate) radius: f64,
    pub(crate) face: Feature,
    pub(crate) rim: Feature,
    /// Number of the first of the eight named points of the rim.
    pub(crate) first: u32,
}

/// The flat or straight facet of a surface around a witness point, in the frame of the shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Facet<'a> {
    /// The face or edge of a polyhedron that carries the contact, found as for two polyhedra.
    Body(&'a ConvexPolyhedron),
    Round(RoundFace),
    /// A generator of a curved side: both ends, the radii of the shape there, the features that
    /// contain them, and the side.
    Straight {
        ends: [Vector3<f64>; 2],
        radii: [f64; 2],
        names: [Feature; 2],
        side: Feature,
    },
    /// A surface that is curved in both directions.
    Point,
}

/// Unit vectors at multiples of 45 degrees: the points of a rim that may carry contacts. They are
/// fixed on the shape at every pose.
const SPOKES: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// A circle in contact coordinates.
#[derive(Clone, Copy)]
pub(super) struct Circle {
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
    rim: Feature,
}

/// A facet in contact coordinates: the vertices of a polygon, the ends of a segment, or points of a
/// rim; none for a point.
pub(super) struct ProjectedFacet {
    pub(super) feature: Feature,
    pub(super) count: usize,
    pub(super) points: [[f64; 3]; LARGE],
    names: [Feature; LARGE],
    edges: [Feature; LARGE],
    pub(super) circle: Option<Circle>,
    /// Radii of the shape at the ends of a segment; zero for the edge of a polyhedron.
    radii: [f64; 2],
    /// Height over the witness, and the descent along both axes.
    level: f64,
    fall: [f64; 2],
}

impl ProjectedFacet {
    fn empty(feature: Feature) -> Self {
        Self {
            feature,
            count: 0,
            points: [[0.0; 3]; LARGE],
            names: [feature; LARGE],
            edges: [feature; LARGE],
            circle: None,
            radii: [0.0; 2],
            level: 0.0,
            fall: [0.0; 2],
        }
    }

    /// Returns a facet in contact coordinates. `axes` are in the frame of the shape, relative to
    /// its witness point. `closest` is the feature that contains the witness point; `side` is 0 for
    /// A and 1 for B.
    pub(super) fn new(
        facet: &Facet,
        axes: &Axes,
        closest: Feature,
        options: &ManifoldOptions,
        previous: Option<Feature>,
        side: usize,
    ) -> Self {
        match facet {
            Facet::Body(body) => Self::of_body(body, axes, closest, options, previous, side),
            Facet::Round(face) => Self::of_round(face, axes),
            Facet::Straight {
                ends,
                radii,
                names,
                side,
            } => {
                let mut patch = Self::empty(*side);
                patch.count = 2;
                patch.radii = *radii;
                for k in 0..2 {
                    (patch.points[k], patch.names[k]) = (axes.to_local(&ends[k]), names[k]);
                }
                patch
            }
            Facet::Point => Self::empty(closest),
        }
    }

    fn of_round(face: &RoundFace, axes: &Axes) -> Self {
        let mut patch = Self::empty(face.face);
        let centre = axes.to_local(&Vector3::new(0.0, 0.0, face.z));
        patch.circle = Some(Circle {
            centre,
            radius: face.radius,
            rim: face.rim,
        });
        patch.count = SPOKES.len();
        for (k, [x, y]) in SPOKES.into_iter().enumerate() {
            patch.points[k] = axes.to_local(&Vector3::new(x * face.radius, y * face.radius, face.z));
            patch.names[k] = Feature::Vertex(VertexId(face.first + k as u32));
        }
        patch.set_plane(&Vector3::z(), axes, &centre);
        patch
    }

    /// Returns the face or edge of a polyhedron; for a face with many vertices, some of them.
    fn of_body(
        body: &ConvexPolyhedron,
        axes: &Axes,
        closest: Feature,
        options: &ManifoldOptions,
        previous: Option<Feature>,
        side: usize,
    ) -> Self {
        let outward = if side == 0 { axes.normal } else { -axes.normal };
        let promotion = Promotion {
            body,
            outward,
            sine: options.max_face_sine,
            previous,
        };
        let feature = promotion.promote(closest);
        let mut patch = Self::empty(feature);
        let is_upright = matches!(feature, Feature::Face(f) if body.planes[f.index()].normal.dot(&outward) <= STEEP);
        if is_upright || feature.dimension() == 0 {
            return patch;
        }
        let unit = body.unit();
        let stored = Axes {
            tangents: axes.tangents,
            normal: axes.normal,
            witness: (axes.witness - body.origin) / unit,
            noise: axes.noise / unit,
        };
        let mut lazy = LazyProjection::new(body, feature, &stored, side == 1);
        let projected = lazy.get();
        let stride = projected.count.div_ceil(LARGE).max(1);
        for k in (0..projected.count).step_by(stride) {
            let at = patch.count;
            patch.points[at] = projected.vertex(k).each(|x| x * unit);
            patch.names[at] = projected.feature_at(Location::vertex(k));
            patch.edges[at] = projected.feature_at(Location::edge(k));
            patch.count += 1;
        }
        if let Feature::Face(f) = feature {
            let first = patch.points[0];
            patch.set_plane(&body.planes[f.index()].normal, axes, &first);
        }
        patch
    }

    /// Sets the plane through a local point from its normal in the frame of the shape.
    fn set_plane(&mut self, normal: &Vector3<f64>, axes: &Axes, through: &[f64; 3]) {
        let up = 1.0 / normal.dot(&axes.normal);
        self.fall = axes.tangents.each(|e| normal.dot(&e) * up);
        self.level = through[2] + self.fall[0] * through[0] + self.fall[1] * through[1];
    }

    pub(super) fn is_segment(&self) -> bool {
        self.count == 2
    }

    pub(super) fn is_face(&self) -> bool {
        self.count > 2
    }

    /// Returns the number of straight edges: one for a segment, none for a round face.
    pub(super) fn edge_count(&self) -> usize {
        match (self.count, &self.circle) {
            (_, Some(_)) => 0,
            (2, _) => 1,
            (n, _) => n,
        }
    }

    /// Returns both ends of a straight edge.
    pub(super) fn ends(&self, k: usize) -> [[f64; 3]; 2] {
        [self.points[k], self.points[if k + 1 < self.count { k + 1 } else { 0 }]]
    }

    /// Returns the height over a point of the contact plane.
    pub(super) fn height(&self, at: [f64; 2]) -> f64 {
        if self.is_segment() {
            let [p, q] = self.ends(0);
            return p[2] + self.along(at) * (q[2] - p[2]);
        }
        self.level - self.fall[0] * at[0] - self.fall[1] * at[1]
    }

    /// Returns the parameter of the foot of a point on a segment, from 0 to 1.
    pub(super) fn along(&self, at: [f64; 2]) -> f64 {
        let [p, q] = self.ends(0);
        let u = [q[0] - p[0], q[1] - p[1]];
        let t = ((at[0] - p[0]) * u[0] + (at[1] - p[1]) * u[1]) / (u[0] * u[0] + u[1] * u[1]);
        if t > 0.0 { t.at_most(1.0) } else { 0.0 }
    }

    /// Returns the radius of the shape at a parameter of a segment.
    pub(super) fn radius(&self, t: f64) -> f64 {
        let [from, to] = self.radii;
        from + t * (to - from)
    }

    /// Returns the vector in space from the centre of a circle to the point of its plane over `at`.
    pub(super) fn spoke(&self, circle: &Circle, at: [f64; 2]) -> [f64; 3] {
        let c = &circle.centre;
        [at[0] - c[0], at[1] - c[1], self.height(at) - c[2]]
    }

    /// Returns the gradient of half the squared length of the spoke by the position.
    pub(super) fn spoke_slope(&self, spoke: &[f64; 3]) -> [f64; 2] {
        [spoke[0] - spoke[2] * self.fall[0], spoke[1] - spoke[2] * self.fall[1]]
    }

    /// Returns how far inside a face a point of the contact plane is: negative outside.
    pub(super) fn inside_by(&self, at: [f64; 2]) -> f64 {
        if let Some(circle) = &self.circle {
            let [x, y, z] = self.spoke(circle, at);
            return circle.radius - sqrt(x * x + y * y + z * z);
        }
        let mut least = f64::INFINITY;
        for k in 0..self.count {
            let [p, q] = self.ends(k);
            let u = [q[0] - p[0], q[1] - p[1]];
            let length = sqrt(u[0] * u[0] + u[1] * u[1]);
            let inside = (u[0] * (at[1] - p[1]) - u[1] * (at[0] - p[0])) / length;
            // NaN, from an edge without length, is ignored.
            least = if inside < least { inside } else { least };
        }
        least
    }

    /// Returns the feature that contains a location. Edge 1 of a round face is the second crossing
    /// of one line with its rim, named by the face.
    pub(super) fn feature_at(&self, on: Location) -> Feature {
        match (on.as_vertex(), on.as_edge(), &self.circle) {
            (Some(k), ..) => self.names[k % LARGE],
            (_, Some(0), Some(circle)) => circle.rim,
            (_, Some(_), Some(_)) | (_, None, _) => self.feature,
            (_, Some(k), None) => self.edges[k % LARGE],
        }
    }
}
