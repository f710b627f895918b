//! The motions that engines are timed on: pairs of random hulls held at a gap of 2 % of their radius.

use crate::motion::{Frame, hold_gap};
use crate::pose::{add, quat, quat_mul, scale, unit, unit_quat};
use crate::rng::Rng;
use crate::shapes::{cuboid, ellipsoid, sphere};
use crate::{Point, Pose};

/// Vertices of the random hulls.
pub const SIZES: [usize; 6] = [8, 32, 128, 512, 2048, 8192];

/// The gap at every frame: bodies have radius 1.
pub const GAP: f64 = 0.02;

/// The points of a body: `n` random ones on the unit sphere (`sphere`) or on an ellipsoid 1:1:0.1 (`flat`), or the
/// corners of a `box`.
pub fn points(shape: &str, n: usize, rng: &mut Rng) -> Vec<Point> {
    match shape {
        "sphere" => sphere(rng, n).points,
        "flat" => ellipsoid(rng, n, [1.0, 1.0, 0.1]).points,
        _ => cuboid([0.6, 0.5, 0.4]).points,
    }
}

/// Frames of a motion: B orbits A and spins about a drifting axis, by `degrees` a frame each; or takes a new pose every
/// frame, for `None`. `query` tells the witness points of a frame in the world, or that the bodies overlap.
pub fn motion(
    degrees: Option<f64>,
    frames: usize,
    rng: &mut Rng,
    mut query: impl FnMut(&Frame) -> Option<(Point, Point)>,
) -> Vec<Frame> {
    // Further apart than two bodies of radius 1 reach.
    let apart = 2.2;
    let a = Pose {
        q: rng.quat(),
        t: rng.unit(),
    };
    let (mut turn, mut out, pole, mut axis) = (rng.quat(), rng.unit(), rng.unit(), rng.unit());
    let step = |_| {
        match degrees {
            Some(d) => {
                axis = unit(add(axis, scale(rng.unit(), 0.05)));
                turn = unit_quat(quat_mul(quat(axis, d.to_radians()), turn));
                out = Pose {
                    q: quat(pole, d.to_radians()),
                    t: [0.0; 3],
                }
                .rotate(out);
            }
            None => (turn, out) = (rng.quat(), rng.unit()),
        }
        let b = a.after(&Pose {
            q: turn,
            t: scale(out, apart),
        });
        hold_gap(
            Frame {
                a,
                b: Pose {
                    q: unit_quat(b.q),
                    t: b.t,
                },
            },
            GAP,
            &mut query,
        )
    };
    (0..frames).map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brute_hull::faces;
    use crate::parry::{closest_points, mesh};

    #[test]
    fn every_frame_keeps_the_gap() {
        let mut rng = Rng::new(3);
        let cloud = points("flat", 12, &mut rng);
        let body = mesh(&cloud, &faces(&cloud)).expect("a solid");
        for degrees in [Some(5.0), None] {
            let ask = |f: &Frame| closest_points(&body, &f.a, &body, &f.b).map(|w| (w.on_a, w.on_b));
            let list = motion(degrees, 20, &mut rng, ask);
            for f in &list {
                let w = closest_points(&body, &f.a, &body, &f.b).expect("apart");
                assert!((w.distance - GAP).abs() < 1e-4 * GAP, "{}", w.distance);
            }
        }
    }
}
