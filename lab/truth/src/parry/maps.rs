//! Curved shapes as support maps of parry, and its GJK started from the direction of the previous
//! frame.

use parry3d_f64::math::Vector;
use parry3d_f64::query::details::closest_points_support_map_support_map_with_params;
use parry3d_f64::query::gjk::{GJKResult, VoronoiSimplex};
use parry3d_f64::shape::SupportMap;

use super::{Witnesses, pose};
use crate::motion::Frame;

/// A shape without its rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Core {
    /// Half extents.
    Box([f64; 3]),
    /// Half the length; the axis is z.
    Segment(f64),
    /// Half height and radius; the axis is z.
    Cylinder(f64, f64),
    /// Half height and radius of the base; the apex is at the upper end of z.
    Cone(f64, f64),
    /// Semi-axes.
    Ellipsoid([f64; 3]),
}

/// A shape for parry's GJK, rounded or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The shape.
    pub core: Core,
    /// The rounding radius.
    pub round: f64,
}

impl SupportMap for Map {
    fn local_support_point(&self, n: Vector) -> Vector {
        let flat = n.x.hypot(n.y).max(f64::MIN_POSITIVE);
        let rim = |r: f64, z: f64| Vector::new(n.x * r / flat, n.y * r / flat, z);
        let core = match self.core {
            Core::Box([x, y, z]) => Vector::new(x.copysign(n.x), y.copysign(n.y), z.copysign(n.z)),
            Core::Segment(h) => Vector::new(0.0, 0.0, h.copysign(n.z)),
            Core::Cylinder(h, r) => rim(r, h.copysign(n.z)),
            Core::Cone(h, r) if 2.0 * h * n.z >= r * flat => Vector::new(0.0, 0.0, h),
            Core::Cone(h, r) => rim(r, -h),
            Core::Ellipsoid([a, b, c]) => {
                let p = Vector::new(a * a * n.x, b * b * n.y, c * c * n.z);
                p / p.dot(n).sqrt()
            }
        };
        if self.round > 0.0 {
            core + n * (self.round / n.length())
        } else {
            core
        }
    }
}

/// GJK with its direction and simplex of the last frame.
#[derive(Default)]
pub struct MapGjk {
    last: Option<Vector>,
    simplex: VoronoiSimplex,
}

impl MapGjk {
    /// Returns distance and witnesses in the world frame; `None` if GJK finds an overlap.
    pub fn closest(&mut self, a: &Map, b: &Map, frame: &Frame) -> Option<Witnesses> {
        let (pa, pb) = (pose(&frame.a), pose(&frame.b));
        let between = pa.inv_mul(&pb);
        let found =
            closest_points_support_map_support_map_with_params(&between, a, b, f64::MAX, &mut self.simplex, self.last);
        let GJKResult::ClosestPoints(p, q, n) = found else {
            self.last = None;
            return None;
        };
        self.last = Some(n);
        Some(Witnesses {
            distance: (q - p).length(),
            on_a: (pa * p).into(),
            on_b: (pa * q).into(),
        })
    }
}
