//! Volume, centroid and inertia of a solid mesh at unit density.
//!
//! Sums over tetrahedra between the box centre and each triangle (Tonon 2004). Points with winding
//! number w count w times, as parts that overlap do in the sum of their masses.

use nalgebra::{Matrix3, Point3, Vector3};

use super::Mesh;

/// Six times the volume, 24 times the first moments, 120 times the second, about the box centre, in
/// stored units.
#[derive(Default)]
struct MeshMoments {
    volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Mesh {
    /// Returns the volume in the caller's unit cubed; zero for surfaces, negative if the mesh is
    /// inside out.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let unit = self.unit();
        self.moments().volume / 6.0 * unit * unit * unit
    }

    /// Returns the centre of mass of the volume; for surfaces and volumes that are not positive the
    /// centre of the bounding box.
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

    /// Returns the inertia tensor about the centroid, in the caller's axes and unit to the fifth
    /// power; zero for surfaces and volumes that are not positive.
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
            let [a, b, c] = self.corners(t).map(|p| p - middle);
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
