//! Draws random bodies and motions of every family of `truth`.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::Point3;
use truth::motion::{self, Frame};
use truth::pose::{radius, scale};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::{Point, Pose};

/// A body and its family.
#[derive(Clone)]
pub(crate) struct Drawn {
    pub(crate) family: &'static str,
    pub(crate) shape: Shape,
    pub(crate) body: ConvexPolyhedron,
}

/// Two bodies and their poses, frame by frame.
pub(crate) struct Trial {
    pub(crate) a: Drawn,
    pub(crate) b: Drawn,
    pub(crate) motion: &'static str,
    pub(crate) frames: Vec<Frame>,
}

/// Returns a random dyadic number from 0.25 to 2: sums of these are exact.
fn dyadic(rng: &mut Rng) -> f64 {
    *rng.pick(&[0.25, 0.5, 0.75, 1.0, 1.5, 2.0])
}

/// Returns the points of a random family. One body in twenty is large.
fn shape(rng: &mut Rng) -> (&'static str, Shape) {
    let large = rng.chance(0.05);
    let most = if large { 1500 } else { 48 };
    let n = 4 + rng.below(most);
    let thin = rng.log_range(1e-12, 0.3);
    let (family, shape) = match rng.below(20) {
        0 => ("box", shapes::cuboid([dyadic(rng), dyadic(rng), dyadic(rng)])),
        1 => ("box", shapes::cuboid([1.0, rng.range(0.1, 1.0), thin])),
        2 => ("prism", shapes::prism(3 + n / 2, 1.0, rng.range(0.1, 1.0))),
        3 => ("fan", shapes::cone(3 + n / 2, 1.0, rng.log_range(1e-3, 1.0))),
        4 => ("platonic", rng.pick(&shapes::platonic()).clone()),
        5 => ("icosphere", shapes::icosphere(rng.below(if large { 4 } else { 2 }))),
        6 => ("sphere", shapes::sphere(rng, n)),
        7 => ("ball", shapes::ball(rng, n)),
        8 => (
            "ellipsoid",
            shapes::ellipsoid(rng, n, [1.0, 0.7, rng.clone().log_range(1e-4, 1.0)]),
        ),
        9 => ("sliver", shapes::sliver(rng, n.min(48), thin)),
        10 => ("needle", shapes::needle(rng, n.min(48), thin.max(1e-9))),
        11 => {
            let k = rng.int(1, 5);
            ("lattice", shapes::lattice(rng, n, k))
        }
        12 => ("lattice", shapes::grid(1 + rng.below(4))),
        13 => ("chamfer", shapes::chamfered([1.0, dyadic(rng), 0.6], thin.min(0.1))),
        14 => ("almost flat", shapes::roof(thin)),
        15 => ("almost flat", shapes::pyramid_lid(thin)),
        16 => ("almost flat", shapes::cap(3 + rng.below(12), 3, thin)),
        17 => ("almost flat", shapes::dome(2 + rng.below(5), thin)),
        18 => ("no volume", flat(rng)),
        _ => ("small", shapes::small(rng)),
    };
    let untidy = rng.chance(0.1) && family != "no volume";
    (family, if untidy { shapes::dirty(&shape, rng) } else { shape })
}

/// Returns a point, a segment or a polygon.
fn flat(rng: &mut Rng) -> Shape {
    let n = 1 + rng.below(7);
    let turn = Pose {
        q: if rng.chance(0.5) { rng.quat() } else { Pose::IDENTITY.q },
        t: [0.0; 3],
    };
    let s = if n > 2 {
        shapes::lattice(rng, n + 2, 2).stretched([0.5, 0.5, 0.0])
    } else {
        // Only points and segments are rotated: a rotated polygon is no longer planar in `f64`.
        shapes::sphere(rng, n).moved(&turn)
    };
    Shape::hull("flat", s.points)
}

/// Returns the body of some points: a hull, polygon, segment or point. `None` if the points have no
/// such body.
fn body(points: &[Point]) -> Option<ConvexPolyhedron> {
    let points: Vec<_> = points.iter().map(|&p| Point3::from(p)).collect();
    match *points {
        [p] => ConvexPolyhedron::point(p).ok(),
        [p, q] => ConvexPolyhedron::segment(p, q).ok(),
        _ => ConvexPolyhedron::from_points(&points)
            .or_else(|_| ConvexPolyhedron::polygon(&points))
            .ok(),
    }
}

/// Returns a random body: most as generated, others smaller or away from their origin.
fn drawn(rng: &mut Rng) -> Drawn {
    loop {
        let (family, mut shape) = shape(rng);
        if rng.chance(0.1) {
            let by = if rng.chance(0.5) {
                2f64.powi(-(rng.below(40) as i32))
            } else {
                rng.log_range(1e-12, 1.0)
            };
            shape = shape.stretched([by; 3]);
        }
        if rng.chance(0.05) && family != "no volume" {
            let away = rng.log_range(0.1, 1e6);
            let away = Pose::shift(scale(rng.unit(), away));
            shape = shape.moved(&away);
        }
        if let Some(body) = body(&shape.points) {
            return Drawn { family, shape, body };
        }
    }
}

/// Puts B on top of A, both upright: faces, edges or vertices meet, exactly if the coordinates
/// allow it.
fn on_top(a: &Shape, b: &Shape, rng: &mut Rng) -> Frame {
    let extent = |s: &Shape, k: usize| {
        let of = |p: &Point| p[k];
        let low = s.points.iter().map(of).fold(f64::INFINITY, f64::min);
        let high = s.points.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        (low, high)
    };
    let mut t: Point = std::array::from_fn(|k| {
        let ((low_a, high_a), (low_b, high_b)) = (extent(a, k), extent(b, k));
        match rng.below(4) {
            0 => 0.0,
            1 => high_a - low_b, // ends meet ends
            2 => low_a - low_b,  // sides are flush
            _ => rng.range(low_a - high_b, high_a - low_b),
        }
    });
    t[2] = extent(a, 2).1 - extent(b, 2).0;
    Frame {
        a: Pose::IDENTITY,
        b: Pose::shift(t),
    }
}

/// Returns a random motion with its name. Bodies need not be centred at their origins, so gaps
/// vary.
fn moves(a: &Drawn, b: &Drawn, rng: &mut Rng) -> (&'static str, Vec<Frame>) {
    let (ra, rb) = (radius(&a.shape.points), radius(&b.shape.points));
    let n = 60 + rng.below(200);
    let degrees = rng.log_range(1e-3, 30.0);
    let top = on_top(&a.shape, &b.shape, rng);
    let small = rb.min(ra);
    let same_place = Frame {
        a: Pose::IDENTITY,
        b: Pose::IDENTITY,
    };
    match rng.below(14) {
        0 | 1 => {
            let gaps = (-rng.range(0.0, 0.9) * (ra + rb), rng.range(0.0, 0.5) * (ra + rb));
            ("orbiting", motion::orbit_and_spin(rng, n, degrees, (ra, rb), gaps, 100))
        }
        2 => {
            let miss = rng.range(0.0, 1.2) * (ra + rb);
            (
                "tumbling past",
                motion::tumble_past(rng, n, degrees, miss, 3.0 * (ra + rb)),
            )
        }
        3 | 4 => {
            let miss = if rng.chance(0.3) {
                0.0
            } else {
                rng.range(0.0, 0.7) * (ra + rb)
            };
            ("passing through", motion::pass_through(rng, n, (ra, rb), miss))
        }
        5 => {
            let step = small * 2f64.powi(-(rng.below(8) as i32));
            let direction = if rng.chance(0.5) {
                [1.0, 0.0, 0.0]
            } else {
                [0.5, -1.0, 0.0]
            };
            ("sliding", motion::slide(top, direction, step, n))
        }
        6 => {
            let (shift, angle) = (small * rng.log_range(1e-17, 1e-3), rng.log_range(1e-17, 1e-3));
            ("resting", motion::jitter(rng, top, shift, angle, n))
        }
        7 => {
            let highest = a.shape.points.iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
            ("rolling", motion::roll(&b.shape.points, highest, degrees, n))
        }
        8 => {
            let axis = if rng.chance(0.5) { [0.0, 0.0, 1.0] } else { rng.unit() };
            ("spinning", motion::spin(top, axis, degrees, n))
        }
        9 => {
            // From above down to exact touch and through it, with steps that halve.
            let step = |i: usize| Pose {
                t: [
                    top.b.t[0],
                    top.b.t[1],
                    top.b.t[2] + small * if i < 60 { 1.0 } else { -1.0 } * 2f64.powi(-(i as i32 % 60)),
                ],
                ..top.b
            };
            let frames = (0..120).map(|i| Frame { b: step(i), ..top }).collect();
            ("closing in", frames)
        }
        10 => {
            let axis = rng.unit();
            let near = (ra + rb) * rng.range(0.0, 0.99);
            let frames = motion::approach(rng, axis, 1.5 * (ra + rb), near, 1e-14, n);
            ("approaching", frames)
        }
        11 => {
            let spread = rng.log_range(1.0, 1e3);
            (
                "random poses",
                motion::random_poses(rng, n, (ra, rb), (0.0, 1.2), spread * (ra + rb)),
            )
        }
        12 => {
            let axis = rng.unit();
            ("concentric", motion::spin(same_place, axis, degrees, n))
        }
        _ => {
            let (shift, angle) = (small * rng.log_range(1e-17, 0.3), rng.log_range(1e-17, 0.3));
            ("about one place", motion::jitter(rng, same_place, shift, angle, n))
        }
    }
}

/// The motion in which every manifold is judged.
pub(crate) const ALONG_A_RIM: &str = "along a rim";

/// Returns a plate whose faces have 28 to 60 vertices, or a box.
fn rimmed(rng: &mut Rng, corners: usize) -> Drawn {
    let shape = shapes::rounded_plate([dyadic(rng), dyadic(rng), 0.25 * dyadic(rng)], corners);
    let body = body(&shape.points).expect("a plate is a solid");
    Drawn {
        family: "plate",
        shape,
        body,
    }
}

/// Returns two plates, or a plate and a box in either order, along a straight edge of a face.
///
/// One is flush next to and above the other's edge: in line with it, over it or next to it, by as
/// little as rounding.
fn along_a_rim(rng: &mut Rng) -> Trial {
    let (many, other) = (7 + rng.below(9), *rng.pick(&[1, 1, 7, 12]));
    let corners = if rng.chance(0.5) { [many, other] } else { [other, many] };
    let [a, b] = corners.map(|k| rimmed(rng, k));
    let reach = |d: &Drawn, k: usize| d.shape.points.iter().map(|p| p[k]).fold(0.0, f64::max);
    let [width, length, height] = [0, 1, 2].map(|k| reach(&a, k) + reach(&b, k));
    let gap = rng.log_range(1e-16, 0.05) * *rng.pick(&[1.0, 1.0, -1.0]);
    let frames = (0..60).map(|_| {
        let across = rng.log_range(1e-17, 1e-2) * *rng.pick(&[0.0, 1.0, -1.0]);
        let t = [width + across, rng.range(-1.0, 1.0) * length, height + gap];
        Frame {
            a: Pose::IDENTITY,
            b: Pose::shift(t),
        }
    });
    let frames = frames.collect();
    Trial {
        a,
        b,
        motion: ALONG_A_RIM,
        frames,
    }
}

/// Returns trial `k` of a seed, independent of earlier trials.
pub(crate) fn trial(seed: u64, k: u64) -> Trial {
    let mut rng = Rng::of_case(seed, k);
    let mut trial = if rng.chance(0.1) {
        along_a_rim(&mut rng)
    } else {
        moving(&mut rng)
    };
    let size = radius(&trial.a.shape.points) + radius(&trial.b.shape.points);
    // Both bodies are moved together: rotated, or far from the origin.
    if rng.chance(0.3) {
        let t = scale(rng.unit(), size * rng.log_range(0.1, 1e3));
        let common = Pose { q: rng.quat(), t };
        trial.frames.iter_mut().for_each(|f| *f = f.moved(&common));
    } else if rng.chance(0.15) {
        let t = scale(rng.unit(), size * rng.log_range(1e3, 1e12));
        trial.frames.iter_mut().for_each(|f| *f = f.moved(&Pose::shift(t)));
    }
    trial
}

/// Returns bodies of any family in any of the motions.
fn moving(rng: &mut Rng) -> Trial {
    let a = drawn(rng);
    let twins = rng.chance(0.15);
    let b = if twins { a.clone() } else { drawn(rng) };
    let (motion, frames) = moves(&a, &b, rng);
    Trial { a, b, motion, frames }
}
