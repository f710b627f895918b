//! Volume, centre of mass and inertia. A rounded polyhedron consists of the core, a prism on each
//! face, a sector of a cylinder along each edge, and a sector of a ball at each vertex (Steiner
//! 1840; here with moments up to the second).
//!
//! ```text
//!     ___________
//!    /|         |\      r   border radius
//!   '-+---------+-'     n   normal of a face, from which the arc of an edge begins
//!   | |  core   | |     t   outward from that face, across the edge
//!   | |         | |     o   exterior angle of the edge: from n to the normal of the other face
//! ```
//!
//! A sector of a ball contains the directions `n` with `n . e <= 0` for all edges `e` that leave
//! the vertex. By the divergence theorem on the sphere, its moments are sums over the arcs around
//! it: `int n = -1/2 sum o e` and `int n n^T = (solid angle - sum (int n along the arc) e^T) / 3`.
//! The solid angle is 2 pi minus the angles of the faces at the vertex (Gauss and Bonnet).

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::sqrt;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, VertexId};
use crate::body::shape::{Core, Curved, Shape, match_core};
use core::f64::consts::PI;
use nalgebra::{Matrix3, Point3, Vector3};

/// Mass properties at unit density, in the frame of the shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Mass {
    /// Volume.
    pub volume: f64,
    /// Centre of mass.
    pub centroid: Point3<f64>,
    /// Inertia tensor relative to the centre of mass.
    pub inertia: Matrix3<f64>,
}

impl Mass {
    fn of(body: &ConvexPolyhedron) -> Self {
        Self {
            volume: body.volume(),
            centroid: body.centroid(),
            inertia: body.inertia(),
        }
    }

    /// Returns the mass of a body symmetric about three planes through `centroid`, from the volume
    /// and the mean squares of coordinates.
    pub(super) fn symmetric(volume: f64, centroid: Point3<f64>, mean: Vector3<f64>) -> Self {
        let sums = Vector3::new(mean.y + mean.z, mean.z + mean.x, mean.x + mean.y);
        Self {
            volume,
            centroid,
            inertia: Matrix3::from_diagonal(&(sums * volume)),
        }
    }
}

impl Shape {
    /// Returns the mass properties at unit density, in closed form. `None` for rounded shapes with
    /// a curved core.
    #[must_use]
    pub fn mass(&self) -> Option<Mass> {
        if let Core::Polyhedron(body) = &self.core {
            return self.polyhedral_mass(body);
        }
        (self.rounding == 0.0).then(|| match_core!(&self.core, body => Mass::of(body), core => core.mass()))
    }

    fn polyhedral_mass(&self, body: &ConvexPolyhedron) -> Option<Mass> {
        match body.vertex_count() {
            _ if self.rounding == 0.0 => Some(Mass::of(body)),
            1 => Some(ball(body.centroid(), self.rounding)),
            2 => Some(self.capsule_mass(body)),
            _ => Some(rounded(body, self.rounding)),
        }
    }

    /// Returns the mass of a cylinder between two half balls.
    fn capsule_mass(&self, segment: &ConvexPolyhedron) -> Mass {
        let mut ends = segment.vertex_points();
        let along = match (ends.next(), ends.next()) {
            (Some(p), Some(q)) => q - p,
            _ => Vector3::zeros(),
        };
        let (r, length) = (self.rounding, along.norm());
        let (h, axis) = (length / 2.0, along / length);
        let (tube, caps) = (PI * r * r * length, 4.0 / 3.0 * PI * r * r * r);
        // Half balls: h + 3/8 r is the mea distance of their centres of mass from the middle.
        let lengthwise = tube * h * h / 3.0 + caps * (r * r / 5.0 + h * h + 0.75 * h * r);
        let crosswise = tube * r * r / 4.0 + caps * r * r / 5.0;
        let outer = axis * axis.transpose();
        let inertia = outer * (2.0 * crosswise) + (Matrix3::identity() - outer) * (crosswise + lengthwise);
        Mass {
            volume: tube + caps,
            centroid: segment.centroid(),
            inertia,
        }
    }
}

fn ball(centroid: Point3<f64>, r: f64) -> Mass {
    let volume = 4.0 / 3.0 * PI * r * r * r;
    Mass::symmetric(volume, centroid, Vector3::repeat(r * r / 5.0))
}

/// Sums over a body: volume, first moments and second moments about a point.
struct BorderMoments {
    volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

/// The arc of outward normals along an edge.
struct NormalArc {
    /// Ends of the edge, about the centre of mass of the core.
    ends: [Vector3<f64>; 2],
    /// First normal, and the direction in which the arc leaves it.
    axes: [Vector3<f64>; 2],
    angle: f64,
    sine: f64,
    cosine: f64,
}

/// A rounded polyhedron, lengths about the centre of mass of the core.
struct Rounded<'a> {
    body: &'a ConvexPolyhedron,
    centre: Point3<f64>,
    radius: f64,
}

/// Returns the mass of a polyhedron or polygon with a border.
pub(super) fn rounded(body: &ConvexPolyhedron, radius: f64) -> Mass {
    let (centre, inertia) = (body.centroid(), body.inertia());
    let rounded = Rounded { body, centre, radius };
    let mut sum = BorderMoments {
        volume: body.volume(),
        first: Vector3::zeros(),
        second: Matrix3::identity() * (inertia.trace() / 2.0) - inertia,
    };
    for face in body.faces() {
        rounded.add_prism(face, &mut sum);
    }
    for edge in body.edges() {
        if let Some(arc) = rounded.arc(edge) {
            arc.add_sector(radius, &mut sum);
        }
    }
    for vertex in body.vertices() {
        rounded.add_ball_sector(vertex, &mut sum);
    }
    sum.mass(&centre)
}

impl BorderMoments {
    fn mass(&self, about: &Point3<f64>) -> Mass {
        let shift = self.first / self.volume;
        let central = self.second - shift * self.first.transpose();
        let central = (central + central.transpose()) * 0.5;
        Mass {
            volume: self.volume,
            centroid: about + shift,
            inertia: Matrix3::identity() * central.trace() - central,
        }
    }
}

impl Rounded<'_> {
    fn at(&self, vertex: VertexId) -> Option<Vector3<f64>> {
        Some(self.body.vertex(vertex)? - self.centre)
    }

    /// Adds the prism between a face and the plane through the border.
    fn add_prism(&self, face: FaceId, sum: &mut BorderMoments) {
        let mut rim = self.body.face_vertices(face).filter_map(|v| self.at(v));
        let (Some(a), Some(mut b), Some((n, _))) = (rim.next(), rim.next(), self.body.face_plane(face)) else {
            return;
        };
        let (n, r) = (n.into_inner(), self.radius);
        let (mut area, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for c in rim {
            let part = 0.5 * (b - a).cross(&(c - a)).dot(&n);
            let corners = a + b + c;
            let squares = [a, b, c].each(|p| p * p.transpose());
            area += part;
            first += corners * (part / 3.0);
            second += (squares[0] + squares[1] + squares[2] + corners * corners.transpose()) * (part / 12.0);
            b = c;
        }
        sum.volume += area * r;
        sum.first += first * r + n * (area * r * r / 2.0);
        sum.second += second * r + mixed(&first, &n) * (r * r / 2.0) + n * n.transpose() * (area * r * r * r / 3.0);
    }

    fn arc(&self, edge: EdgeId) -> Option<NormalArc> {
        let [from, to] = self.body.edge_vertices(edge)?;
        let [f, g] = self.body.edge_faces(edge)?;
        let ends = [self.at(from)?, self.at(to)?];
        let along = (ends[1] - ends[0]).try_normalize(0.0)?;
        let (n, m) = (
            self.body.face_plane(f)?.0.into_inner(),
            self.body.face_plane(g)?.0.into_inner(),
        );
        // The edge runs counter-clockwise about the first of its faces: that face lies to its left.
        let out = along.cross(&n);
        let (sine, cosine) = (m.dot(&out).at_least(0.0), m.dot(&n));
        Some(NormalArc {
            ends,
            axes: [n, out],
            angle: libm::atan2(sine, cosine),
            sine,
            cosine,
        })
    }

    /// Adds the sector of a ball about a vertex.
    fn add_ball_sector(&self, vertex: VertexId, sum: &mut BorderMoments) {
        let Some(p) = self.at(vertex) else { return };
        let r = self.radius;
        let (mut solid, mut first, mut second) = (2.0 * PI, Vector3::zeros(), Matrix3::zeros());
        let mut before = self.body.vertex_neighbours(vertex).last();
        let edges = self.body.vertex_edges(vertex).zip(self.body.vertex_neighbours(vertex));
        for (edge, to) in edges {
            let leaving = |v: VertexId| self.at(v).map(|q| q - p);
            let (Some(arc), Some(e), Some(d)) = (self.arc(edge), leaving(to), before.and_then(leaving)) else {
                return;
            };
            let away = e.try_normalize(0.0).unwrap_or_default();
            solid -= libm::atan2(sqrt(d.cross(&e).norm_squared()), d.dot(&e));
            first -= away * (arc.angle / 2.0);
            second -= arc.sum() * away.transpose() / 3.0;
            before = Some(to);
        }
        let solid = solid.at_least(0.0);
        second += Matrix3::identity() * (solid / 3.0);
        let third = r * r * r / 3.0;
        sum.volume += third * solid;
        sum.first += p * (third * solid) + first * (r * r * r * r / 4.0);
        sum.second += p * p.transpose() * (third * solid)
            + mixed(&p, &first) * (r * r * r * r / 4.0)
            + second * (r * r * r * r * r / 5.0);
    }
}

impl NormalArc {
    /// Returns the sum of the normals along the arc.
    fn sum(&self) -> Vector3<f64> {
        let [n, out] = self.axes;
        n * self.sine + out * (1.0 - self.cosine)
    }

    /// Adds the sector of a cylinder along the edge.
    fn add_sector(&self, r: f64, sum: &mut BorderMoments) {
        let ([a, b], [n, out]) = (self.ends, self.axes);
        let length = sqrt((b - a).norm_squared());
        let (middle, both) = ((a + b) * (length / 2.0), a + b);
        let squares = (a * a.transpose() + b * b.transpose() + both * both.transpose()) * (length / 6.0);
        let (area, normal) = (r * r * self.angle / 2.0, self.sum() * (r * r * r / 3.0));
        let (half, twice) = (self.angle / 2.0, self.sine * self.cosine / 2.0);
        let directions = n * n.transpose() * (half + twice)
            + out * out.transpose() * (half - twice)
            + mixed(&n, &out) * (self.sine * self.sine / 2.0);
        sum.volume += area * length;
        sum.first += middle * area + normal * length;
        sum.second += squares * area + mixed(&middle, &normal) + directions * (length * r * r * r * r / 4.0);
    }
}

/// Returns `a b^T + b a^T`.
fn mixed(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    let product = a * b.transpose();
    product + product.transpose()
}
