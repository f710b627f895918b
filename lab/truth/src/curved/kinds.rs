//! Shapes of the judge: parameters, support values, and distances of outside points.

use super::wide::{Triple, Wide, dot, wide};
use crate::rng::Rng;
use lin_canny::Shape;
use lin_canny::nalgebra::{Point3, Vector3};

/// The names for [`Kind::random`]; from the fourth on, the shapes are curved.
pub const KINDS: [&str; 6] = ["segment", "box", "hull", "ellipsoid", "cylinder", "cone"];

/// The parameters of a core.
#[derive(Clone, Debug)]
pub enum Kind {
    /// Vertices.
    Hull(Vec<[f64; 3]>),
    /// Semi-axes.
    Ellipsoid([f64; 3]),
    /// Half height and radius; the axis is z.
    Cylinder(f64, f64),
    /// Half height and radius of the base; the apex is at the upper end of z.
    Cone(f64, f64),
}

impl Kind {
    /// Returns a random shape by name, with a size of about one and an aspect ratio up to `aspect`.
    pub fn random(name: &str, rng: &mut Rng, aspect: f64) -> Self {
        let mut size = || rng.log_range(1.0 / aspect, 1.0);
        match name {
            "segment" => Self::Hull(vec![[0.0, 0.0, -size()], [0.0, 0.0, 1.0]]),
            "box" => {
                let half = [size(), size(), 1.0];
                let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] });
                Self::Hull((0..8).map(corner).collect())
            }
            "hull" => {
                let scale = [size(), size(), 1.0];
                let n = *rng.pick(&[8, 20, 100]);
                let point = |rng: &mut Rng| {
                    let u = rng.unit();
                    [0, 1, 2].map(|k| u[k] * scale[k])
                };
                Self::Hull((0..n).map(|_| point(rng)).collect())
            }
            "ellipsoid" => Self::Ellipsoid([size(), 1.0, size()]),
            "cylinder" => {
                let (r, h) = (size(), size());
                Self::Cylinder(h / r.max(h), r / r.max(h))
            }
            "cone" => {
                let (r, h) = (size(), size());
                Self::Cone(h / r.max(h), r / r.max(h))
            }
            other => panic!("no shape is called {other}"),
        }
    }

    /// Returns the shape of the crate.
    pub fn shape(&self) -> Shape {
        match self {
            Self::Hull(points) if points.len() == 1 => {
                Shape::from(lin_canny::ConvexPolyhedron::point(Point3::from(points[0])).expect("a point"))
            }
            Self::Hull(points) if points.len() == 2 => Shape::from(
                lin_canny::ConvexPolyhedron::segment(Point3::from(points[0]), Point3::from(points[1]))
                    .expect("a segment"),
            ),
            Self::Hull(points) => {
                let corners: Vec<_> = points.iter().map(|&p| Point3::from(p)).collect();
                let flat = || lin_canny::ConvexPolyhedron::polygon(&corners).map(Shape::from);
                Shape::hull(&corners)
                    .or_else(|e| flat().map_err(|_| e))
                    .expect("a hull")
            }
            Self::Ellipsoid(a) => Shape::ellipsoid(Vector3::from(*a)).expect("an ellipsoid"),
            Self::Cylinder(h, r) => Shape::cylinder(*h, *r).expect("a cylinder"),
            Self::Cone(h, r) => Shape::cone(*h, *r).expect("a cone"),
        }
    }

    /// Returns the radius of a ball about the origin that contains the shape.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Hull(points) => crate::pose::radius(points),
            Self::Ellipsoid(a) => a.iter().fold(0.0, |r, x| x.max(r)),
            Self::Cylinder(h, r) | Self::Cone(h, r) => h.hypot(*r),
        }
    }

    /// Returns the support value along `n`: the greatest `n . x`.
    pub fn height(&self, n: &Triple) -> Wide {
        let of = Wide::from;
        let flat = (n[0] * n[0] + n[1] * n[1]).root();
        let rim = |r: f64| of(r) * flat;
        match self {
            Self::Hull(points) => {
                let heights = points.iter().map(|&p| dot(n, &wide(p)));
                heights.reduce(Wide::max).expect("a point")
            }
            Self::Ellipsoid(a) => {
                let turned = [0, 1, 2].map(|k| of(a[k]) * n[k]);
                dot(&turned, &turned).root()
            }
            Self::Cylinder(h, r) => rim(*r) + of(*h) * n[2].max(-n[2]),
            Self::Cone(h, r) => (of(*h) * n[2]).max(rim(*r) - of(*h) * n[2]),
        }
    }

    /// Returns how far a point is outside the shape; zero for hulls.
    ///
    /// For a witness, which is outside by rounding at most, the value is too small by rounding at
    /// most.
    pub fn outside(&self, p: &Triple) -> f64 {
        let of = Wide::from;
        let flat = (p[0] * p[0] + p[1] * p[1]).root();
        let size = (dot(p, p)).root().0;
        let excess = match self {
            Self::Hull(_) => of(0.0),
            Self::Ellipsoid(a) => {
                let unit = [0, 1, 2].map(|k| p[k] / of(a[k]));
                (dot(&unit, &unit).root() - of(1.0)) * of(size)
            }
            Self::Cylinder(h, r) => (flat - of(*r)).max(p[2].max(-p[2]) - of(*h)),
            Self::Cone(h, r) => {
                let side = flat * of(2.0 * h) - of(*r) * (of(*h) - p[2]);
                (side / of(r.hypot(2.0 * h))).max(-p[2] - of(*h))
            }
        };
        excess.0.max(0.0)
    }
}
