//! Surfaces of the tests.

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface, revolution};
pub(crate) use truth::forms::sphere;
use truth::rng::Rng;

pub(crate) const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Returns the side of a cylinder about z.
pub(crate) fn tube(r: f64, h: f64) -> BezierSurface {
    revolution(&[&[[r, -h, 1.0], [r, h, 1.0]]]).expect("a cylinder")
}

/// Returns a torus about z as sixteen rational patches: the radius of the centre circle, and of the
/// tube.
pub(crate) fn torus(middle: f64, r: f64) -> BezierSurface {
    let arc = |k: usize| {
        let [(s, c), (t, d)] = [k, k + 1].map(|k| (k as f64 * std::f64::consts::FRAC_PI_2).sin_cos());
        let corner = [middle + r * (c + d), r * (s + t), HALF];
        vec![[middle + r * c, r * s, 1.0], corner, [middle + r * d, r * t, 1.0]]
    };
    let arcs: Vec<Vec<[f64; 3]>> = (0..4).map(arc).collect();
    let arcs: Vec<&[[f64; 3]]> = arcs.iter().map(Vec::as_slice).collect();
    revolution(&arcs).expect("a torus")
}

/// Returns a vase of 32 patches.
pub(crate) fn vase() -> BezierSurface {
    let curves = truth::nets::vase();
    let curves: Vec<&[[f64; 3]]> = curves.iter().map(Vec::as_slice).collect();
    revolution(&curves).expect("a vase")
}

/// Returns a bicubic patch over a square of size 2 with bumps.
pub(crate) fn bumpy(rng: &mut Rng, degrees: [usize; 2], bump: f64) -> BezierPatch {
    let points = grid(rng, degrees, bump);
    BezierPatch::polynomial(degrees, &points).expect("a patch")
}

pub(crate) fn grid(rng: &mut Rng, degrees: [usize; 2], bump: f64) -> Vec<Point3<f64>> {
    let points = truth::nets::bumps(rng, degrees, bump);
    points.into_iter().map(Point3::from).collect()
}

/// Returns a random pose with the origins `apart` apart.
pub(crate) fn place(rng: &mut Rng, apart: f64) -> Isometry3<f64> {
    let direction = Vector3::from(rng.unit());
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.1));
    Isometry3::from_parts((direction * apart).into(), turn)
}

pub(crate) fn pose(p: &Isometry3<f64>) -> RelativePose {
    RelativePose::from_isometry(p).expect("a pose")
}
