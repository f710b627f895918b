//! Straight edges of faces with many vertices next to, above and over straight edges: the overlap
//! is a line or a strip.

use crate::judge::judge;
use crate::{exact, manifold};
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, Tracker};
use truth::motion::Frame;
use truth::pose::scale;
use truth::rng::Rng;
use truth::shapes;
use truth::support;
use truth::{Point, Pose};

/// Half length of a straight edge along y, and half the width of its body along x.
#[derive(Clone, Copy)]
struct Rim {
    half: f64,
    width: f64,
}

fn plate(k: usize) -> (ConvexPolyhedron, Rim) {
    let body = support::body(&shapes::rounded_plate([1.0, 1.5, 0.25], k));
    let half = if k > 1 { 1.0 } else { 1.5 };
    (body, Rim { half, width: 1.0 })
}

fn bodies() -> Vec<(ConvexPolyhedron, Rim)> {
    let mut bodies: Vec<_> = [1, 4, 6, 7, 8, 10, 15, 40].map(plate).into();
    for h in [[0.5, 0.5, 0.25], [0.125, 2.0, 0.25]] {
        let rim = Rim {
            half: h[1],
            width: h[0],
        };
        bodies.push((support::body(&shapes::cuboid(h)), rim));
    }
    bodies
}

/// Returns the length along y of the overlap, and of the points of a manifold.
fn lengths([a, b]: [Rim; 2], aside: f64, m: &Manifold) -> (f64, f64) {
    let shared = (a.half.min(aside + b.half) - (-a.half).max(aside - b.half)).max(0.0);
    let y = m.points().iter().map(|p| -> f64 {
        let p: Point = p.point_on_a.coords.into();
        p[1]
    });
    let (low, high) = y.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    (shared, high - low)
}

#[test]
fn straight_rims_bear_contacts_on_both_bodies() {
    let (mut rng, bodies) = (Rng::new(621), bodies());
    let (mut lines, mut short) = (0, 0);
    for k in 0..6000 {
        let ((a, of_a), (b, of_b)) = (rng.pick(&bodies), rng.pick(&bodies));
        // Of either sign: the edges are in line, the bodies are separated sideways, or they share a
        // strip.
        let across = match k % 4 {
            0 => 0.0,
            1 => rng.log_range(1e-17, 1e-3),
            2 => -rng.log_range(1e-17, 1e-3),
            _ => rng.range(-0.02, 0.01),
        };
        let gap = match k / 4 % 4 {
            0 => rng.log_range(1e-15, 3e-2),
            1 | 2 => rng.log_range(1e-6, 3e-2),
            _ => -across.abs() * rng.range(0.0, 0.5),
        };
        let aside = rng.range(-0.9, 0.9) * (of_a.half + of_b.half);
        let yaw = [0.0, rng.log_range(1e-17, 1e-2)][usize::from(k % 3 == 0)];
        let t = [of_a.width + of_b.width + across, aside, 0.5 + gap];
        let mut frame = Frame::new(Pose::IDENTITY, Pose::turn([0.0, 0.0, 1.0], yaw, t));
        if rng.chance(0.5) {
            frame = frame.moved(&Pose::new(rng.quat(), scale(rng.unit(), 3.0)));
        }
        let options = exact(0.1, 4 + rng.below(5));
        let m = manifold(a, b, &frame, &options);
        let o = judge(a, b, &frame, &m, &options, &format!("rims {k}"));
        judge(
            b,
            a,
            &frame.swapped(),
            &manifold(b, a, &frame.swapped(), &options),
            &options,
            "rims, swapped",
        );
        let steep = o.normal.z.abs() < 0.9;
        if yaw == 0.0 && o.lower > 0.0 && !steep {
            let (shared, spanned) = lengths([*of_a, *of_b], aside, &m);
            lines += 1;
            short += usize::from(spanned < 0.9 * shared);
        }
    }
    assert!(lines > 2000 && short == 0, "{short} of {lines}");
}

/// A box moves off a straight edge, along it and perpendicular to it: cached contacts are as sound
/// as new ones.
#[test]
fn contacts_kept_along_straight_rims_are_sound() {
    let (mut rng, bodies) = (Rng::new(622), bodies());
    let mut kept = 0;
    for _ in 0..150 {
        let ((a, of_a), (b, of_b)) = (rng.pick(&bodies), rng.pick(&bodies));
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let mut options = ManifoldOptions::default().prediction(0.1);
        options.rebuild_motion = 0.0;
        let gap = rng.log_range(1e-6, 3e-2);
        let drawn = rng.log_range(1e-17, 1e-3) * if rng.chance(0.5) { 1.0 } else { -1.0 };
        let step = rng.log_range(1e-4, 0.05);
        // Rotated together, rounding alone decides on which side of one edge the other lies.
        let q = [Pose::IDENTITY.q, rng.quat()][usize::from(rng.chance(0.7))];
        let common = Pose::new(q, scale(rng.unit(), 3.0));
        let start = -(of_a.half + of_b.half) * rng.range(0.5, 1.0);
        for k in 0..40 {
            let across = if k % 2 == 0 { 0.0 } else { drawn };
            let t = [of_a.width + of_b.width + across, start - step * f64::from(k), 0.5 + gap];
            let frame = Frame::new(Pose::IDENTITY, Pose::shift(t)).moved(&common);
            pair.manifold(a, b, &support::relative(&frame), &options, &mut m);
            judge(a, b, &frame, &m, &options, "drawn along a rim");
            kept += m.points().len();
        }
    }
    assert!(kept > 6000, "{kept}");
}

/// Edges in one line up to rounding, nearly touching, in rotated frames: edges that seem to cross
/// by rounding need not meet.
#[test]
fn rims_in_line_bear_contacts_only_where_they_meet() {
    let (mut rng, bodies) = (Rng::new(623), bodies());
    for k in 0..8000 {
        let ((a, of_a), (b, of_b)) = (rng.pick(&bodies), rng.pick(&bodies));
        let across = match k % 4 {
            0 | 1 => 0.0,
            2 => rng.log_range(1e-17, 1e-14),
            _ => -rng.log_range(1e-17, 1e-14),
        };
        // Next to each other, or one above the other with both edges on one side.
        let side = if rng.chance(0.7) { 1.0 } else { -1.0 };
        let aside = rng.range(-0.9, 0.9) * (of_a.half + of_b.half);
        let gap = rng.log_range(1e-15, 1e-13);
        let frame = Frame::new(
            Pose::IDENTITY,
            Pose::shift([of_a.width + side * of_b.width + across, aside, 0.5 + gap]),
        );
        let frame = frame.moved(&Pose::new(rng.quat(), scale(rng.unit(), 3.0)));
        let options = exact(0.1, 4 + rng.below(5));
        let m = manifold(a, b, &frame, &options);
        judge(a, b, &frame, &m, &options, &format!("in line {k}"));
    }
}
