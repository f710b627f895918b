//! Where a shape is: ball, box at a pose, points inside.

use nalgebra::{Isometry3, Point3};

use super::{Core, Shape, Support};
use crate::polyhedron::BoxHint;
use crate::pose::rotation_matrix;
use crate::scalar::{Vec3, dot, sqrt};
use crate::tolerance::{BOX, UNIT};

impl Shape {
    /// A ball that holds the shape: centre and radius, rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (centre, radius) = match &self.core {
            Core::Polyhedron(body) => body.bounding_ball(),
            Core::Ellipsoid(core) => (Point3::origin(), core.radius()),
            Core::Cylinder(core) => (Point3::origin(), core.radius()),
            Core::Cone(core) => (Point3::origin(), core.radius()),
            Core::Superquadric(core) => (Point3::origin(), core.radius()),
        };
        (centre, (radius + self.round) * (1.0 + 2.0 * UNIT))
    }

    /// The axis-aligned box of the shape at a pose, rounded outward: least and greatest corner, in the frame that the
    /// pose leads to. `hint` remembers the extreme vertices of a polyhedron from one frame to the next.
    ///
    /// A pose that is not finite gives a box that is not.
    #[doc(alias = "compute_aabb")]
    #[must_use]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        let (low, high) = match &self.core {
            Core::Polyhedron(body) => body.aabb_at(pose, hint),
            Core::Ellipsoid(core) => box_at(core, pose),
            Core::Cylinder(core) => box_at(core, pose),
            Core::Cone(core) => box_at(core, pose),
            Core::Superquadric(core) => box_at(core, pose),
        };
        if self.round == 0.0 {
            return (low, high);
        }
        let out = |x: f64, by: f64| x + by + (x.abs() + by.abs()) * UNIT * by.signum();
        (low.map(|x| out(x, -self.round)), high.map(|x| out(x, self.round)))
    }
}

/// Six support points, rounded outward.
fn box_at<C: Support>(core: &C, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let q = pose.rotation.coords;
    let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
    let t = pose.translation.vector;
    let (mut low, mut high) = (t, t);
    for k in 0..3 {
        let row = [matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]];
        let norm = sqrt(dot(&row, &row));
        let up: Vec3<f64> = row.map(|x| x / norm);
        let margin = (BOX + core.noise() * UNIT) * (core.radius() + t[k].abs());
        let height = |n: &Vec3<f64>| dot(n, &core.support(n, 0).1);
        high[k] += height(&up) + margin;
        low[k] -= height(&up.map(|x| -x)) + margin;
    }
    (Point3::from(low), Point3::from(high))
}
