//! Motions for timing: pairs at a fixed gap, in contact, at rest, or passing through contact.

use crate::motion::{Frame, hold_distance, hold_gap};
use crate::pose::{add, cross, dot, quat, quat_mul, scale, sub, unit, unit_quat};
use crate::rng::Rng;
use crate::shapes::{cone, cuboid, ellipsoid, prism, sphere};
use crate::{Point, Pose};

/// Vertices of the random hulls.
pub const SIZES: [usize; 6] = [8, 32, 128, 512, 2048, 8192];

/// The gap in every frame; bodies have radius 1.
pub const GAP: f64 = 0.02;

/// The depth in every frame of a shallow contact: 1 % of the diameter.
pub const DEPTH: f64 = 0.02;

/// Returns the points of a body.
///
/// `sphere`: `n` random points on the unit sphere; `flat`: on an ellipsoid 1:1:0.1; `prism`,
/// `cone`: regular, with `n` vertices; otherwise the vertices of a box.
pub fn points(shape: &str, n: usize, rng: &mut Rng) -> Vec<Point> {
    match shape {
        "sphere" => sphere(rng, n).points,
        "flat" => ellipsoid(rng, n, [1.0, 1.0, 0.1]).points,
        "prism" => prism(n / 2, 1.0, 0.3).points,
        "cone" => cone(n - 1, 1.0, 0.8).points,
        _ => cuboid([0.6, 0.5, 0.4]).points,
    }
}

/// Returns the frames of a motion at a gap of [`GAP`].
///
/// B orbits A and spins about a drifting axis, by `degrees` per frame each; for `None`, it takes a
/// new pose every frame. `query` returns the witness points of a frame in the world frame, or
/// `None` if the bodies overlap.
pub fn motion(
    degrees: Option<f64>,
    frames: usize,
    rng: &mut Rng,
    mut query: impl FnMut(&Frame) -> Option<(Point, Point)>,
) -> Vec<Frame> {
    orbit(degrees.map(|d| (d, d)), frames, rng, |_, f| {
        hold_gap(f, GAP, &mut query)
    })
}

/// Like [`motion`], at a signed distance of `goal(frame)`: B spins and orbits by the given degrees
/// per frame.
///
/// `query` returns the signed distance and the normal from A to B in the world frame.
pub fn contact(
    (spin, round): (f64, f64),
    frames: usize,
    rng: &mut Rng,
    goal: impl Fn(usize) -> f64,
    mut query: impl FnMut(&Frame) -> (f64, Point),
) -> Vec<Frame> {
    orbit(Some((spin, round)), frames, rng, |k, f| {
        hold_distance(f, goal(k), &mut query)
    })
}

/// B spins and orbits A by the given degrees; `hold` then shifts each frame.
fn orbit(
    degrees: Option<(f64, f64)>,
    frames: usize,
    rng: &mut Rng,
    mut hold: impl FnMut(usize, Frame) -> Frame,
) -> Vec<Frame> {
    // Farther apart than the radii of two bodies of radius 1.
    let apart = 2.2;
    let a = Pose::new(rng.quat(), rng.unit());
    let (mut turn, mut out, pole, mut axis) = (rng.quat(), rng.unit(), rng.unit(), rng.unit());
    let step = |k| {
        match degrees {
            Some((spin, round)) => {
                axis = unit(add(axis, scale(rng.unit(), 0.05)));
                turn = unit_quat(quat_mul(quat(axis, spin.to_radians()), turn));
                out = Pose::new(quat(pole, round.to_radians()), [0.0; 3]).rotate(out);
            }
            None => (turn, out) = (rng.quat(), rng.unit()),
        }
        let b = a.after(&Pose::new(turn, scale(out, apart)));
        hold(k, Frame::new(a, Pose::new(unit_quat(b.q), b.t)))
    };
    (0..frames).map(step).collect()
}

/// A face of a body: a point of it, and the outward unit normal.
pub type FacePlane = (Point, Point);

/// Lays B's face flat on A's at a signed `distance`, one reference point above the other, with B
/// rotated by `spin` radians about the normal.
pub fn stacked(a: FacePlane, b: FacePlane, spin: f64, distance: f64) -> Frame {
    let ((at, up), (on, down)) = (a, b);
    let q = quat_mul(quat(up, spin), between(down, scale(up, -1.0)));
    let turned = Pose::new(unit_quat(q), [0.0; 3]);
    let t = sub(add(at, scale(up, distance)), turned.rotate(on));
    Frame::new(Pose::IDENTITY, turned.moved_to(t))
}

/// Returns a rotation that maps one unit direction to another.
fn between(from: Point, to: Point) -> [f64; 4] {
    let c = 1.0 + dot(from, to);
    if c > 1e-9 {
        let [x, y, z] = cross(from, to);
        return unit_quat([x, y, z, c]);
    }
    // Half a turn about any perpendicular axis.
    let other = if from[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let [x, y, z] = unit(cross(from, other));
    [x, y, z, 0.0]
}

/// Returns `start` at rest with noise that does not accumulate: `size` in position, and
/// `size / reach` radians in rotation.
///
/// The pair is at a random pose in the world.
pub fn at_rest(start: Frame, size: f64, reach: f64, frames: usize, rng: &mut Rng) -> Vec<Frame> {
    let world = Pose::new(rng.quat(), rng.unit());
    let mut frame = |_| {
        let shake = Pose::new(
            quat(rng.unit(), rng.range(-1.0, 1.0) * size / reach),
            scale(rng.unit(), size),
        );
        let b = Pose::new(unit_quat(quat_mul(shake.q, start.b.q)), add(start.b.t, shake.t));
        Frame::new(start.a, b).moved(&world)
    };
    (0..frames).map(&mut frame).collect()
}

/// Returns `start` with B moving to and fro along `way`, one cycle in `period` frames.
pub fn to_and_fro(start: Frame, way: Point, period: usize, frames: usize, rng: &mut Rng) -> Vec<Frame> {
    let world = Pose::new(rng.quat(), rng.unit());
    let frame = |k: usize| {
        let phase = (k % period) as f64 / period as f64;
        let along = 1.0 - 4.0 * (phase - 0.5).abs();
        let t = add(start.b.t, scale(way, along));
        Frame {
            b: start.b.moved_to(t),
            ..start
        }
        .moved(&world)
    };
    (0..frames).map(frame).collect()
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

    #[test]
    fn stacked_faces_meet() {
        let mut rng = Rng::new(4);
        for k in 0..100 {
            let up = if k % 4 == 0 { [0.0, 0.0, 1.0] } else { rng.unit() };
            let down = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], rng.unit()][k % 3];
            let (at, on) = (rng.unit(), rng.unit());
            let f = stacked((at, up), (on, down), rng.range(0.0, 6.0), 0.25);
            let n = f.b.rotate(down);
            assert!((dot(n, up) + 1.0).abs() < 1e-12);
            let lifted = sub(f.b.apply(on), add(at, scale(up, 0.25)));
            assert!(dot(lifted, lifted) < 1e-24);
        }
    }
}
