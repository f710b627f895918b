//! The transcriptions of kernels of vectors against the crate, bit for bit.

use super::inputs::Inputs;
use super::transcribed::agree;
use lin_canny::__proofs as library;
use proofs::kernels::boxes::{self, Oriented};
use proofs::kernels::{patches, planes};
use proofs::number::{Vector, cross, dot};
use proofs::vectors::{Coordinates, Vectors};

type Single = Coordinates<f32>;

fn single(inputs: &mut Inputs) -> Vector<f32> {
    [0; 3].map(|_| inputs.single())
}

fn wide(v: &[f32]) -> Vec<f64> {
    v.iter().map(|&x| f64::from(x)).collect()
}

/// The gap along an excess vector, of the amounts that `beyond` yields.
fn by_excess(along: Vector<f32>, half: [Vector<f32>; 2], products: [Vector<f32>; 3]) -> f32 {
    let [over, left] = boxes::beyond::<Single>(along, half, products);
    let x = left.map(|x| x.max(0.0));
    let e: Vector<f32> = std::array::from_fn(|k| if along[k].is_sign_negative() { -x[k] } else { x[k] });
    let square = dot(x, x);
    if !(square > 0.0) {
        return -f32::MAX;
    }
    let inverse = 1.0 / square.sqrt().max(f32::MIN_POSITIVE);
    boxes::excess::<Single>([e, x], over, half[1], products) * inverse
}

/// The gap along a direction, where it is greater than those before and positive.
fn offered(
    best: f32,
    c: Vector<f32>,
    between: Vector<f32>,
    half: [Vector<f32>; 2],
    axes: [[Vector<f32>; 3]; 2],
) -> f32 {
    let square = dot(c, c);
    let inverse = 1.0 / square.sqrt().max(f32::MIN_POSITIVE);
    let gap = boxes::along::<Single>(c, between, half, axes) * inverse;
    let parallel = (128.0 / 16_777_216.0f64).powi(2) as f32;
    if square > parallel && gap > best.max(0.0) {
        gap
    } else {
        best
    }
}

#[test]
fn gaps_of_boxes() {
    agree("box gap", |inputs| {
        let mut rows = |first: f32| {
            let axes = [0; 3].map(|_| single(inputs));
            let (centre, half) = (single(inputs), single(inputs).map(f32::abs));
            // Long ones, so that all directions are tried.
            [axes[0], axes[1], axes[2], centre, [half[0] * first, half[1], half[2]]]
        };
        let pair = [rows(64.0), rows(64.0)];
        let r = [0; 3].map(|_| single(inputs));
        let (shift, known) = (single(inputs), single(inputs));
        let rotation: [f32; 9] = r.concat().try_into().expect("nine numbers");
        let of_crate = library::box_gap(rotation, shift, pair, Some(known));
        let [a, b] = pair.map(|[x, y, z, centre, half]| Oriented::<Single> {
            axes: [x, y, z],
            centre,
            half,
        });
        let posed = boxes::posed::<Single>(r, shift, [&a, &b]);
        let (d, half, axes) = (posed.between, [a.half, b.half], [a.axes, posed.axes_b]);
        let inverse = 1.0 / dot(d, d).sqrt().max(f32::MIN_POSITIVE);
        let line = boxes::by_centres::<Single>(d, posed.along, half) * inverse;
        let of_a = by_excess(posed.along[0], half, posed.products);
        let of_b = by_excess(posed.along[1], [b.half, a.half], Single::transposed(posed.products));
        let mut best = of_a.max(of_b).max(line);
        let is_long = |h: Vector<f32>| h[0] > h[1] * 4.0;
        if is_long(a.half) && is_long(b.half) {
            best = offered(best, cross(a.axes[0], posed.axes_b[0]), d, half, axes);
        }
        if is_long(a.half) || is_long(b.half) {
            best = offered(best, known, d, half, axes);
        }
        [vec![f64::from(of_crate)], vec![f64::from(best)]]
    });
}

#[test]
fn entries_of_fronts() {
    agree("front entry", |inputs| {
        let poses = [0; 2].map(|_| ([0; 3].map(|_| single(inputs)), single(inputs)));
        let rotations = poses.map(|(r, _)| r.concat().try_into().expect("nine numbers"));
        let shifts = poses.map(|(_, t)| t);
        let (n, gap, centre) = (single(inputs), inputs.single(), single(inputs));
        let radius = inputs.single().abs();
        let rod = if inputs.below(2) == 0 { [0.0; 3] } else { single(inputs) };
        let (m, base, left) = library::front_entry(rotations, shifts, n, gap, centre, radius, rod);
        let (m_ours, base_ours) = boxes::entry::<Single>(poses[0], n, centre, gap);
        let (turn, along) = boxes::carried::<Single>(poses[1], [n, m_ours], centre, base_ours);
        let mut ours = along - radius * dot(turn, turn).sqrt();
        if rod != [0.0; 3] {
            ours -= dot(turn, rod).abs();
        }
        [
            [wide(&m), wide(&[base, left])].concat(),
            [wide(&m_ours), wide(&[base_ours, ours])].concat(),
        ]
    });
}

#[test]
fn planes_in_motion() {
    agree("plane", |inputs| {
        let [normal, spin, rate]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        let ways: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        let ([first, second], way) = library::plane_derivatives(normal, spin, rate, ways);
        let turning = planes::Turning::<Coordinates<f64>> { normal, spin, rate };
        let ours = planes::derivatives(&turning, 2.0);
        [
            [first, second, way].concat(),
            [ours[0], ours[1], planes::way(&turning, ways, 2.0)].concat(),
        ]
    });
}

#[test]
fn flights_of_balls() {
    agree("balls", |inputs| {
        let (from, velocity): (Vector<f64>, Vector<f64>) = (inputs.numbers(), inputs.numbers());
        let radius = inputs.number().abs();
        let more = 2f64.powi(-40);
        [
            library::flight_of_ball(from, velocity, radius).to_vec(),
            planes::approach::<Coordinates<f64>>(from, velocity, radius, more).to_vec(),
        ]
    });
}

#[test]
fn turns_and_products_of_quaternions() {
    agree("turn", |inputs| {
        let (axis, other): (Vector<f64>, [f64; 4]) = (inputs.numbers(), inputs.numbers());
        let [sine, cosine, rest]: [f64; 3] = inputs.numbers();
        let of_crate = library::half_turn(axis, sine, cosine, rest, other);
        let ours = planes::spun(axis, [sine, cosine], rest);
        [of_crate.concat(), [ours, planes::composed(ours, other)].concat()]
    });
}

#[test]
fn derivatives_of_curves() {
    agree("first", |inputs| {
        let degree = 1 + inputs.below(7);
        let net: Vec<f64> = (0..=degree).map(|_| inputs.number()).collect();
        let at = inputs.between(0.0, 1.0);
        let ours = degree as f64 * patches::first(net.clone(), 1.0 - at, at);
        [vec![library::patch_first(&net, degree, at)], vec![ours]]
    });
}
