//! Seeded motions of a pair: a list of world poses, frame by frame.
//!
//! Bodies are assumed to be centred at their origins with radii `ra` and `rb`
//! ([`crate::pose::radius`]), so that they never overlap if the centres are `ra + rb` apart. The
//! true gap depends on the bodies; [`hold_gap`] moves a frame until it has a given gap.

use crate::pose::{add, cross, dot, norm, quat, quat_mul, scale, sub, unit, unit_quat};
use crate::rng::Rng;
use crate::{Point, Pose};
use std::f64::consts::TAU;

/// World poses of A and B in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Pose of A.
    pub a: Pose,
    /// Pose of B.
    pub b: Pose,
}

impl Frame {
    /// Returns the poses of A and of B.
    pub const fn new(a: Pose, b: Pose) -> Self {
        Self { a, b }
    }

    /// Returns B's pose in A's frame, in `f64`.
    pub fn relative(&self) -> Pose {
        Pose::relative(&self.a, &self.b)
    }

    /// Returns the frame in another unit of length.
    pub fn scaled(&self, by: f64) -> Self {
        Self {
            a: self.a.scaled(by),
            b: self.b.scaled(by),
        }
    }

    /// Returns the frame with A and B exchanged.
    pub fn swapped(&self) -> Self {
        Self { a: self.b, b: self.a }
    }

    /// Returns the frame with both bodies moved by the same pose, which changes results only by
    /// rounding.
    pub fn moved(&self, common: &Pose) -> Self {
        Self {
            a: common.after(&self.a),
            b: common.after(&self.b),
        }
    }
}

/// Returns a random direction perpendicular to `u`.
fn across(rng: &mut Rng, u: Point) -> Point {
    loop {
        let v = cross(u, rng.unit());
        if norm(v) > 0.1 {
            return unit(v);
        }
    }
}

/// Returns `start` rotated by `angle` radians about `axis`.
fn spun(start: [f64; 4], axis: Point, angle: f64) -> [f64; 4] {
    unit_quat(quat_mul(quat(axis, angle), start))
}

/// B orbits A while both spin about different axes, by `degrees` per frame.
///
/// The centres are `ra + rb + gap` apart; `gap` oscillates between `gaps.0` and `gaps.1` once in
/// `period` frames.
pub fn orbit_and_spin(
    rng: &mut Rng,
    frames: usize,
    degrees: f64,
    radii: (f64, f64),
    gaps: (f64, f64),
    period: usize,
) -> Vec<Frame> {
    let (axis_a, axis_b, pole) = (rng.unit(), rng.unit(), rng.unit());
    let (qa, qb) = (rng.quat(), rng.quat());
    let out = across(rng, pole);
    let side = cross(pole, out);
    let frame = |i: usize| {
        let turn = (degrees * i as f64).to_radians();
        let swing = 0.5 - 0.5 * (TAU * i as f64 / period as f64).cos();
        let r = radii.0 + radii.1 + gaps.0 + (gaps.1 - gaps.0) * swing;
        let t = add(scale(out, r * turn.cos()), scale(side, r * turn.sin()));
        Frame::new(
            Pose::new(spun(qa, axis_a, turn), [0.0; 3]),
            Pose::new(spun(qb, axis_b, turn), t),
        )
    };
    (0..frames).map(frame).collect()
}

/// Both bodies tumble and pass each other on parallel lines `miss` apart.
///
/// They move from `reach` before to `reach` after the closest approach. A spins by `degrees` per
/// frame, B by 0.7 times as much.
pub fn tumble_past(rng: &mut Rng, frames: usize, degrees: f64, miss: f64, reach: f64) -> Vec<Frame> {
    let along = rng.unit();
    let aside = scale(across(rng, along), miss);
    let (axis_a, axis_b, qa, qb) = (rng.unit(), rng.unit(), rng.quat(), rng.quat());
    let frame = |i: usize| {
        let turn = (degrees * i as f64).to_radians();
        let x = scale(along, reach * (2.0 * i as f64 / (frames - 1).max(1) as f64 - 1.0) * 0.5);
        let a = Pose::new(spun(qa, axis_a, turn), scale(x, -1.0));
        Frame::new(a, Pose::new(spun(qb, axis_b, 0.7 * turn), add(aside, x)))
    };
    (0..frames).map(frame).collect()
}

/// B passes straight through A with a slow spin: apart, touching, overlapping, touching, apart.
///
/// The line passes within `miss` of A's centre.
pub fn pass_through(rng: &mut Rng, frames: usize, radii: (f64, f64), miss: f64) -> Vec<Frame> {
    let degrees = rng.range(0.0, 1.0);
    let reach = 2.4 * (radii.0 + radii.1);
    tumble_past(rng, frames, degrees, miss, reach)
}

/// B slides along `direction` without rotating, by `step` per frame: features change one by one, or
/// a face rests on a face.
pub fn slide(start: Frame, direction: Point, step: f64, frames: usize) -> Vec<Frame> {
    let at = |i: usize| start.b.shifted(scale(direction, step * i as f64));
    (0..frames).map(|i| Frame { b: at(i), ..start }).collect()
}

/// B approaches along the unit `axis` from centre distance `far` to `near`.
///
/// `far > near`. The difference to `near` shrinks by a constant factor per frame, down to
/// `(far - near) * ratio` in the last frame.
pub fn approach(rng: &mut Rng, axis: Point, far: f64, near: f64, ratio: f64, frames: usize) -> Vec<Frame> {
    let (qa, qb) = (rng.quat(), rng.quat());
    let frame = |i: usize| {
        let left = (far - near) * ratio.powf(i as f64 / (frames - 1).max(1) as f64);
        Frame::new(Pose::new(qa, [0.0; 3]), Pose::new(qb, scale(axis, near + left)))
    };
    (0..frames).map(frame).collect()
}

/// B trembles at rest: shifted by at most `shift` along each axis and rotated by at most `angle`
/// radians.
///
/// Each frame starts from `start`, not from the previous frame.
pub fn jitter(rng: &mut Rng, start: Frame, shift: f64, angle: f64, frames: usize) -> Vec<Frame> {
    let mut shaken = || {
        let by: Point = std::array::from_fn(|_| shift * rng.range(-1.0, 1.0));
        Pose::new(
            spun(start.b.q, rng.unit(), angle * rng.range(-1.0, 1.0)),
            add(start.b.t, by),
        )
    };
    (0..frames).map(|_| Frame { b: shaken(), ..start }).collect()
}

/// B rotates about `axis` through its origin by `degrees` per frame, at its position in `start`.
pub fn spin(start: Frame, axis: Point, degrees: f64, frames: usize) -> Vec<Frame> {
    let at = |i: usize| Pose {
        q: spun(start.b.q, axis, (degrees * i as f64).to_radians()),
        ..start.b
    };
    (0..frames).map(|i| Frame { b: at(i), ..start }).collect()
}

/// B, the hull of `points`, rolls along x by `degrees` per frame on the plane `z = top`, which is
/// A's top.
///
/// A rests at the origin. B's lowest point stays at `top` up to rounding.
pub fn roll(points: &[Point], top: f64, degrees: f64, frames: usize) -> Vec<Frame> {
    let radius = crate::pose::radius(points);
    let frame = |i: usize| {
        let turn = (degrees * (i as f64 - 0.5 * frames as f64)).to_radians();
        let q = quat([0.0, 1.0, 0.0], turn);
        let turned = Pose::new(q, [0.0; 3]);
        let lowest = points
            .iter()
            .map(|&p| turned.rotate(p)[2])
            .fold(f64::INFINITY, f64::min);
        Frame::new(Pose::IDENTITY, Pose::new(q, [radius * turn, 0.0, top - lowest]))
    };
    (0..frames).map(frame).collect()
}

/// Independent frames: random rotations, centres `lo..hi` times `ra + rb` apart, the pair within
/// `spread` of the origin.
pub fn random_poses(rng: &mut Rng, frames: usize, radii: (f64, f64), apart: (f64, f64), spread: f64) -> Vec<Frame> {
    let mut frame = || {
        let d = rng.range(apart.0, apart.1) * (radii.0 + radii.1);
        let place: Point = std::array::from_fn(|_| spread * rng.range(-1.0, 1.0));
        let a = Pose::new(rng.quat(), place);
        Frame::new(a, Pose::new(rng.quat(), add(place, scale(rng.unit(), d))))
    };
    (0..frames).map(|_| frame()).collect()
}

/// Shifts B along the line of the witness points until the distance is `gap`.
///
/// It stops within a relative `1e-6` of the gap, or after 60 rounds. `query` returns the witness
/// points in the world frame, or `None` if the bodies overlap.
pub fn hold_gap(frame: Frame, gap: f64, mut query: impl FnMut(&Frame) -> Option<(Point, Point)>) -> Frame {
    let mut f = frame;
    for _ in 0..60 {
        let apart = sub(f.b.t, f.a.t);
        match query(&f) {
            Some((p, q)) => {
                let d = sub(q, p);
                let length = norm(d);
                if (length - gap).abs() <= 1e-6 * gap {
                    break;
                }
                f.b.t = add(f.b.t, scale(unit(d), gap - length));
            }
            // Overlapping: move out along the line of centres, or along x if the centres coincide.
            None if dot(apart, apart) > 0.0 => f.b.t = add(f.b.t, scale(apart, 0.05)),
            None => f.b.t[0] += gap,
        }
    }
    f
}

/// Shifts B along the normal until the signed distance is `goal`.
///
/// It stops within a relative `1e-6` of the goal, or after 60 rounds: one round out of an overlap,
/// a few inward or sideways. `query` returns the signed distance and the unit normal from A to B in
/// the world frame.
pub fn hold_distance(frame: Frame, goal: f64, mut query: impl FnMut(&Frame) -> (f64, Point)) -> Frame {
    let mut f = frame;
    for _ in 0..60 {
        let (distance, normal) = query(&f);
        if (distance - goal).abs() <= 1e-6 * goal.abs() {
            break;
        }
        f.b.t = add(f.b.t, scale(normal, goal - distance));
    }
    f
}

#[cfg(test)]
mod tests {
    use super::*;

    fn centres(f: &Frame) -> f64 {
        norm(sub(f.a.t, f.b.t))
    }

    fn turned(p: &Pose, q: &Pose) -> f64 {
        let cos = p.q.iter().zip(&q.q).map(|(x, y)| x * y).sum::<f64>().abs().min(1.0);
        2.0 * cos.acos().to_degrees()
    }

    #[test]
    fn orbits_keep_their_gap_and_turn_as_told() {
        let frames = orbit_and_spin(&mut Rng::new(1), 720, 0.5, (1.0, 2.0), (0.1, 0.5), 90);
        assert_eq!(frames.len(), 720);
        let gaps: Vec<f64> = frames.iter().map(|f| centres(f) - 3.0).collect();
        assert!(gaps.iter().all(|g| (0.1 - 1e-12..0.5 + 1e-12).contains(g)));
        assert!((gaps[0] - 0.1).abs() < 1e-12 && (gaps[45] - 0.5).abs() < 1e-12);
        for w in frames.windows(2) {
            assert!((turned(&w[0].a, &w[1].a) - 0.5).abs() < 1e-5 && (turned(&w[0].b, &w[1].b) - 0.5).abs() < 1e-5);
        }
    }

    #[test]
    fn passing_bodies_meet_in_the_middle_only() {
        let frames = pass_through(&mut Rng::new(2), 101, (1.0, 1.0), 0.25);
        assert!((centres(&frames[50]) - 0.25).abs() < 1e-12);
        assert!(centres(&frames[0]) > 4.0 && centres(&frames[100]) > 4.0);
    }

    #[test]
    fn approaches_end_where_told() {
        let frames = approach(&mut Rng::new(3), [0.0, 0.0, 1.0], 5.0, 2.0, 1e-12, 25);
        assert_eq!(centres(&frames[0]), 5.0);
        let last = centres(&frames[24]) - 2.0;
        assert!((last - 3e-12).abs() < 1e-15);
    }

    #[test]
    fn sliding_moves_only_b() {
        let start = random_poses(&mut Rng::new(4), 1, (1.0, 1.0), (1.5, 2.0), 10.0)[0];
        let frames = slide(start, [1.0, 0.0, 0.0], 0.25, 5);
        assert_eq!(frames[0], start);
        assert!(frames.iter().all(|f| f.a == start.a && f.b.q == start.b.q));
        assert_eq!(frames[4].b.t[0], start.b.t[0] + 1.0);
    }

    #[test]
    fn rolling_bodies_touch_the_plane() {
        let cube = crate::shapes::cube();
        let frames = roll(&cube.points, 0.5, 2.0, 90);
        let lowest = |f: &Frame| {
            let z = cube.points.iter().map(|&p| f.b.apply(p)[2]);
            z.fold(f64::INFINITY, f64::min)
        };
        assert!(frames.iter().all(|f| (lowest(f) - 0.5).abs() < 1e-15));
        assert!(frames[0].b.t[0] < -2.0 && frames[89].b.t[0] > 2.0);
        assert!((turned(&frames[0].b, &frames[1].b) - 2.0).abs() < 1e-5);
    }

    #[test]
    fn shaken_bodies_stay_and_spun_ones_turn() {
        let start = Frame::new(Pose::IDENTITY, Pose::shift([0.0, 0.0, 2.0]));
        let shaken = jitter(&mut Rng::new(7), start, 1e-6, 1e-6, 50);
        assert!(shaken.iter().all(|f| (centres(f) - 2.0).abs() < 1e-5));
        assert!(shaken.iter().all(|f| turned(&f.b, &start.b) < 1e-3 && f.b != start.b));
        let spun = spin(start, [0.0, 0.0, 1.0], 3.0, 10);
        assert_eq!(spun[0], start);
        assert!((turned(&spun[0].b, &spun[9].b) - 27.0).abs() < 1e-6 && spun[9].b.t == start.b.t);
    }

    #[test]
    fn motions_are_seeded_and_unit() {
        let make = || random_poses(&mut Rng::new(5), 50, (1.0, 0.5), (1.01, 2.0), 100.0);
        assert_eq!(make(), make());
        for f in make() {
            assert!(
                [f.a, f.b]
                    .iter()
                    .all(|p| (p.q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15)
            );
            assert!((1.5..3.01).contains(&centres(&f)));
            let alike = f.moved(&Pose::turn([0.0, 1.0, 0.0], 1.0, [3.0, 0.0, 0.0]));
            assert!((centres(&alike) - centres(&f)).abs() < 1e-12);
            assert_eq!(f.swapped().swapped(), f);
        }
    }

    #[test]
    fn a_gap_between_balls_is_held() {
        // Two unit balls represent the bodies; the query is exact for them.
        let balls = |f: &Frame| {
            let d = sub(f.b.t, f.a.t);
            (norm(d) > 2.0).then(|| (add(f.a.t, unit(d)), sub(f.b.t, unit(d))))
        };
        for start in random_poses(&mut Rng::new(6), 20, (1.0, 1.0), (0.2, 3.0), 5.0) {
            let f = hold_gap(start, 0.02, balls);
            assert!((centres(&f) - 2.02).abs() < 1e-7);
        }
    }

    #[test]
    fn a_depth_of_balls_is_held() {
        let balls = |f: &Frame| {
            let d = sub(f.b.t, f.a.t);
            (norm(d) - 2.0, unit(d))
        };
        for start in random_poses(&mut Rng::new(7), 20, (1.0, 1.0), (0.2, 3.0), 5.0) {
            for goal in [-0.02, 0.5] {
                let f = hold_distance(start, goal, balls);
                assert!((centres(&f) - 2.0 - goal).abs() < 1e-6);
            }
        }
    }
}
