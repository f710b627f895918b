//! Measurements of one mesh: volume, centroid, inertia at unit density, and nearest points.
//!
//! Volume, centroid and inertia are sums over tetrahedra between the box centre and each triangle
//! (Tonon 2004). A point with winding number w counts w times, as overlapping components do in a
//! sum of masses.

use nalgebra::{Matrix3, Point3, Vector3};

use super::{Mesh, tracker};
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::UNIT_SINGLE;
use crate::nonconvex::query::near::NearMemory;
use crate::nonconvex::query::triangle;
use crate::nonconvex::tree::Tree;
use crate::pair::location::WitnessLocation;

/// Moments about the box centre, in stored units.
///
/// Six times the volume, 24 times the first moments, and 120 times the second moments.
#[derive(Default)]
struct MeshMoments {
    volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Mesh {
    /// Returns the volume in the caller's unit cubed.
    ///
    /// It is zero for open meshes and negative if the mesh is inside out.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let unit = self.unit();
        self.moments().volume / 6.0 * unit * unit * unit
    }

    /// Returns the centre of mass of the volume.
    ///
    /// For open meshes, and if the volume is not positive, it is the centre of the bounding box.
    #[doc(alias = "center_of_mass")]
    #[must_use]
    pub fn centroid(&self) -> Point3<f64> {
        let m = self.moments();
        let shift = if m.volume > 0.0 {
            m.first / (4.0 * m.volume)
        } else {
            Vector3::zeros()
        };
        self.given(&(self.middle() + shift))
    }

    /// Returns the inertia tensor about the centroid, in the caller's axes.
    ///
    /// Its unit is the caller's unit to the fifth power. It is zero for open meshes, and if the
    /// volume is not positive.
    #[doc(alias = "moment_of_inertia")]
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        let m = self.moments();
        if !(m.volume > 0.0) {
            return Matrix3::zeros();
        }
        let mean = m.first / (4.0 * m.volume);
        let central = m.second / 120.0 - mean * mean.transpose() * (m.volume / 6.0);
        let tensor = Matrix3::identity() * central.trace() - central;
        let unit = self.unit();
        tensor * unit * unit * unit * unit * unit
    }

    fn middle(&self) -> Vector3<f64> {
        self.low * 0.5 + self.high * 0.5
    }

    fn moments(&self) -> MeshMoments {
        let mut sum = MeshMoments::default();
        if !self.is_solid() {
            return sum;
        }
        let middle = self.middle();
        for t in 0..self.triangle_count() as u32 {
            let [a, b, c] = self.corners(t).each(|p| p - middle);
            let six = a.dot(&b.cross(&c));
            let corners = a + b + c;
            sum.volume += six;
            sum.first += corners * six;
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
            sum.second += (squares + corners * corners.transpose()) * six;
        }
        sum
    }
}

/// The nearest point of a mesh, in stored coordinates.
#[derive(Clone, Copy)]
pub(crate) struct MeshFoot {
    /// The squared distance.
    pub(crate) square: f64,
    pub(crate) point: Vector3<f64>,
    pub(crate) triangle: u32,
}

/// A point in the frame of a tree.
pub(crate) struct From<'a> {
    tree: &'a Tree,
    place: Vector3<f64>,
    slack: f64,
}

impl<'a> From<'a> {
    /// Returns a point in stored coordinates of the body.
    pub(crate) fn new(tree: &'a Tree, point: &Vector3<f64>) -> Self {
        let place = (point - tree.centre) / tree.unit();
        // The stored axes are orthonormal within 8 UNIT_SINGLE.
        let slack = 32.0 * UNIT_SINGLE * (1.0 + place.amax());
        Self { tree, place, slack }
    }

    /// Returns a lower bound of the distance of all triangles below a node, in stored units.
    pub(crate) fn least(&self, node: u32) -> f64 {
        let b = &self.tree.boxes[node as usize];
        let (d, half) = (self.place - b.centre(), b.half());
        let out = |k: usize| (b.axis(k).dot(&d).abs() - half[k] - self.slack).at_least(0.0);
        let away = sqrt(out(0) * out(0) + out(1) * out(1) + out(2) * out(2));
        away * (1.0 - self.slack) * self.tree.unit()
    }
}

impl Mesh {
    /// Returns the nearest point of the surface, a unit normal there, and the triangle.
    ///
    /// All are in the caller's coordinates and exact up to rounding. The normal is that of the
    /// triangle, on the side of the query point; it may be zero for a very thin triangle. The
    /// search starts from `first`, which does not change the result.
    pub(crate) fn seen_from(
        &self,
        point: &Vector3<f64>,
        first: Option<u32>,
    ) -> (Point3<f64>, Vector3<f64>, WitnessLocation) {
        let place = self.frame.stored(&Point3::from(*point));
        let foot = self.nearest_from(&place, 0.0, first);
        let corners = self.corners(foot.triangle);
        let normal = triangle::normal(&corners);
        let height = normal.dot(&(place - corners[0]));
        let length = sqrt(normal.norm_squared()) * if height < 0.0 { -1.0 } else { 1.0 };
        let normal = if length == 0.0 { normal } else { normal / length };
        let (_, spot) = triangle::nearest(&place, &corners);
        (
            self.given(&foot.point),
            normal,
            tracker::spot(self, foot.triangle, spot),
        )
    }

    /// Returns the point of the surface that is nearest to a point, up to rounding.
    ///
    /// Both are in stored coordinates.
    pub(crate) fn nearest(&self, point: &Vector3<f64>) -> MeshFoot {
        self.nearest_beyond(point, 0.0)
    }

    /// Returns the nearest point, or any point that is no farther than `level`.
    ///
    /// The second case applies if the surface is no farther than `level`.
    pub(crate) fn nearest_beyond(&self, point: &Vector3<f64>, level: f64) -> MeshFoot {
        self.nearest_from(point, level, None)
    }

    fn nearest_from(&self, point: &Vector3<f64>, level: f64, start: Option<u32>) -> MeshFoot {
        let mut memory = NearMemory::default();
        memory.start = start;
        let near = self.nearest_triangle(point, level, &mut memory);
        let (square, point) = triangle::foot_of(point, &self.corners(near.item));
        let triangle = near.item;
        MeshFoot {
            square,
            point,
            triangle,
        }
    }
}
