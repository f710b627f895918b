//! Surfaces of the tests.

use lab::rng::Rng;
use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::patch::{Patch, Surface, revolution};

pub(crate) const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A sphere as eight rational octants.
pub(crate) fn sphere(r: f64) -> Surface {
    let south: &[[f64; 3]] = &[[0.0, -r, 1.0], [r, -r, HALF], [r, 0.0, 1.0]];
    let north: &[[f64; 3]] = &[[r, 0.0, 1.0], [r, r, HALF], [0.0, r, 1.0]];
    revolution(&[south, north]).expect("a sphere")
}

/// The side of a cylinder about z.
pub(crate) fn tube(r: f64, h: f64) -> Surface {
    revolution(&[&[[r, -h, 1.0], [r, h, 1.0]]]).expect("a cylinder")
}

/// A vase of 32 patches.
pub(crate) fn vase() -> Surface {
    let rim: Vec<[f64; 2]> = vec![
        [0.0, -1.0],
        [0.4, -1.0],
        [0.8, -0.95],
        [0.9, -0.7],
        [1.0, -0.45],
        [0.95, -0.3],
        [0.8, -0.1],
        [0.65, 0.1],
        [0.4, 0.2],
        [0.3, 0.35],
        [0.25, 0.45],
        [0.25, 0.55],
        [0.35, 0.65],
        [0.42, 0.72],
        [0.5, 0.75],
        [0.55, 0.8],
        [0.6, 0.85],
        [0.62, 0.9],
        [0.64, 0.95],
        [0.66, 0.97],
        [0.68, 0.98],
        [0.7, 1.0],
        [0.69, 1.01],
        [0.68, 1.0],
        [0.67, 0.99],
    ];
    let curves: Vec<Vec<[f64; 3]>> = (0..8)
        .map(|k| {
            (0..4)
                .map(|i| {
                    let [r, z] = rim[3 * k + i];
                    [r, z, 1.0]
                })
                .collect()
        })
        .collect();
    let curves: Vec<&[[f64; 3]]> = curves.iter().map(Vec::as_slice).collect();
    revolution(&curves).expect("a vase")
}

/// A bicubic patch over a square of size 2 with bumps.
pub(crate) fn bumpy(rng: &mut Rng, degrees: [usize; 2], bump: f64) -> Patch {
    let points = grid(rng, degrees, bump);
    Patch::polynomial(degrees, &points).expect("a patch")
}

pub(crate) fn grid(rng: &mut Rng, [p, q]: [usize; 2], bump: f64) -> Vec<Point3<f64>> {
    let at = |k: usize, rng: &mut Rng| {
        let (i, j) = (k / (q + 1), k % (q + 1));
        let x = 2.0 * i as f64 / p as f64 - 1.0;
        let y = 2.0 * j as f64 / q as f64 - 1.0;
        Point3::new(x, y, bump * rng.range(-1.0, 1.0))
    };
    (0..(p + 1) * (q + 1)).map(|k| at(k, rng)).collect()
}

/// Any pose with the origins so far apart.
pub(crate) fn place(rng: &mut Rng, apart: f64) -> Isometry3<f64> {
    let direction = Vector3::from(rng.unit());
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.1));
    Isometry3::from_parts((direction * apart).into(), turn)
}

pub(crate) fn pose(p: &Isometry3<f64>) -> RelativePose {
    RelativePose::from_isometry(p).expect("a pose")
}
