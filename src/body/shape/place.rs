//! Bounds of a shape: bounding ball, support heights, box at a pose.

use nalgebra::{Isometry3, Point3, Vector3};

use super::{Core, Curved, Shape, Support, match_core};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{dot, sqrt};
use crate::base::pose::rotation_matrix;
use crate::base::tolerance::{BOX, UNIT};
use crate::body::polyhedron::BoxHint;

impl Core {
    /// Returns the largest distance of a point from [`origin`](Self::origin), rounded up.
    pub(crate) fn radius(&self) -> f64 {
        match_core!(self, body => body.radius * body.unit(), core => core.reach())
    }

    /// Returns the point about which the core is stored.
    pub(crate) fn origin(&self) -> Vector3<f64> {
        match self {
            Self::Polyhedron(body) => body.origin,
            _ => Vector3::zeros(),
        }
    }

    /// Returns the fingerprint of kind and parameters.
    pub(super) fn fingerprint(&self) -> Fingerprint {
        match_core!(self, body => body.fingerprint, core => core.fingerprint())
    }

    /// Returns the fingerprint of the core rounded by a radius.
    pub(super) fn rounded_fingerprint(&self, radius: f64) -> Fingerprint {
        let core = self.fingerprint();
        if radius == 0.0 {
            core
        } else {
            core.with(*b"rounded ", radius)
        }
    }
}

impl Shape {
    /// Returns centre and radius of a ball that contains the shape, the radius rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (centre, radius) = match_core!(
            &self.core,
            body => body.bounding_ball(),
            core => (Point3::origin(), core.reach())
        );
        (centre, (radius + self.round) * (1.0 + 2.0 * UNIT))
    }

    /// Upper bound of `direction . x` over the shape, at most `1e-14` times its size and the length
    /// of the direction too large. `direction` is of any length, in the shape's frame; zero for one
    /// that is zero or not finite.
    #[doc(alias = "support")]
    #[must_use]
    pub fn support_height(&self, direction: &Vector3<f64>) -> f64 {
        let size = direction.amax();
        if !(size > 0.0 && size.is_finite()) {
            return 0.0;
        }
        if let Core::Polyhedron(body) = &self.core
            && self.round == 0.0
            && let Some(height) = body.scanned_height(direction)
        {
            let reach = body.radius * body.unit() + body.origin.abs().sum();
            return height + BOX * reach * direction.abs().sum();
        }
        let length = size * sqrt((direction / size).norm_squared());
        let n = direction / length;
        let of = |height: f64, reach: f64, noise: f64| height + (BOX + noise * UNIT) * reach;
        let height = match_core!(&self.core, body => {
            let v = body.vertex(body.extreme_vertex(&n)).unwrap_or_else(Point3::origin);
            of(n.dot(&v.coords), body.radius * body.unit() + v.coords.abs().sum(), 0.0)
        }, core => of(height(core, &n), core.reach(), core.noise()));
        (height + self.round * (1.0 + BOX)) * length
    }

    /// Returns a point of the core of about the greatest height along a unit direction, and the
    /// vertex of a polyhedral core.
    pub(crate) fn core_point(&self, n: &Vector3<f64>) -> (Option<u32>, Vector3<f64>) {
        let along = [n.x, n.y, n.z];
        match_core!(&self.core, body => {
            let v = body.extreme_vertex(n);
            let p = body.vertex(v).unwrap_or_else(Point3::origin);
            (Some(v.0), p.coords)
        }, core => (None, core.support(&along, 0).1.into()))
    }

    /// Returns the axis-aligned box of the shape at a pose, rounded outward: least and greatest
    /// corner, in the frame that the pose leads to. `hint` caches the extreme vertices of a
    /// polyhedron from one frame to the next.
    ///
    /// The box of a pose that is not finite is not finite either.
    #[doc(alias = "compute_aabb")]
    #[must_use]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        let (low, high) = match_core!(&self.core, body => body.aabb_at(pose, hint), core => box_at(core, pose));
        if self.round == 0.0 {
            return (low, high);
        }
        let out = |x: f64, by: f64| x + by + (x.abs() + by.abs()) * UNIT * by.signum();
        (low.map(|x| out(x, -self.round)), high.map(|x| out(x, self.round)))
    }
}

/// Returns the greatest `n . x` over a core, up to rounding.
fn height<C: Support>(core: &C, n: &Vector3<f64>) -> f64 {
    let n = [n.x, n.y, n.z];
    dot(&n, &core.support(&n, 0).1)
}

/// Returns the box of six support points, rounded outward.
fn box_at<C: Support>(core: &C, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let q = pose.rotation.coords;
    let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
    let t = pose.translation.vector;
    let (mut low, mut high) = (t, t);
    for k in 0..3 {
        let row = [matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]];
        let norm = sqrt(dot(&row, &row));
        let up = Vector3::from(row.map(|x| x / norm));
        let margin = (BOX + core.noise() * UNIT) * (core.reach() + t[k].abs());
        high[k] += height(core, &up) + margin;
        low[k] -= height(core, &-up) + margin;
    }
    (Point3::from(low), Point3::from(high))
}
