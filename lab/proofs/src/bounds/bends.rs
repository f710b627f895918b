//! Derivatives of patches, and heights of patches above curved surfaces.

use super::poses::{product, rotation};
use super::{Bound, once, units};
use crate::kernels::patches;
use crate::majorant::{Majorant, unit};
use crate::number::Number;
use dashu_ratio::RBig;

/// The greatest degree of a patch.
const MOST: usize = 7;

pub(super) fn bounds() -> Vec<Bound> {
    let whole = Bound::whole;
    vec![
        whole("CURVATURE", "patch::height::Curvature", over_degrees(curvature)),
        whole("TAYLOR", "patch::height::bounded", over_degrees(taylor)),
        whole("SURFACE_POINT", "patch::surface", surface_point()),
        whole("PATCH_SLOPE", "patch::crossing::shares", slope()),
        whole("BENT", "patch::bowl::fill", bent()),
    ]
}

/// The greatest error over the square of the sum of the degrees.
fn over_degrees(of: fn(usize, usize) -> RBig) -> RBig {
    let all = (1..=MOST).flat_map(|p| (1..=MOST).map(move |q| (p, q)));
    let ratio = all.map(|(p, q)| of(p, q) / RBig::from((p + q) * (p + q)));
    ratio.max().expect("degrees")
}

fn points(count: usize, off: &RBig) -> Vec<Majorant> {
    (0..count).map(|k| Majorant::input('p', k as u8, off)).collect()
}

/// `1 - t`, rounded once, and `t`.
fn parameters() -> [Majorant; 2] {
    [Majorant::input('s', 0, &once()), Majorant::input('t', 0, &RBig::ZERO)]
}

/// A value along one direction, relative to the largest of points that err by so much of it.
fn value(n: usize, off: &RBig) -> RBig {
    let [s, t] = parameters();
    patches::end(points(n + 1, off), s, t).relative()
}

/// A first derivative along one direction, relative to `2 n` times the largest point.
fn derivative(n: usize, off: &RBig) -> RBig {
    let [s, t] = parameters();
    patches::first(points(n + 1, off), s, t).relative() + once()
}

/// Second differences of coefficients up to one, times their factors.
fn curvature(p: usize, q: usize) -> RBig {
    let none = RBig::ZERO;
    let input = |k| Majorant::input('p', k, &none);
    let second = |n: usize| {
        let times = RBig::from(n * (n - 1));
        let difference = input(0) - Number::times_power(input(1), 1) + input(2);
        let error = difference.error().at(|_| RBig::ONE);
        // Two products with whole numbers of what is no larger than four.
        times * (error + RBig::from(4) * RBig::from(2) * once()) * (RBig::ONE + once())
    };
    let mixed = (input(3) - input(2)) - (input(1) - input(0));
    let error = mixed.error().at(|_| RBig::ONE) + RBig::from(4) * RBig::from(2) * once();
    let mixed = RBig::from(p * q) * error * (RBig::ONE + once());
    second(p).max(second(q)).max(mixed)
}

/// The value, two first derivatives along a way of one, and four roundings of the three sums of bounds, numbers up to
/// `4 (p + q)^2`.
fn taylor(p: usize, q: usize) -> RBig {
    let none = RBig::ZERO;
    let at = value(p, &value(q, &none));
    let along_u = derivative(p, &value(q, &none)) * RBig::from(2 * p);
    let along_v = value(p, &derivative(q, &none)) * RBig::from(2 * q);
    let degree = RBig::from((p + q) * (p + q));
    at + along_u + along_v + degree * RBig::from(16) * once()
}

/// A point of a patch, and its control points.
fn surface_point() -> RBig {
    units(96.0) + units(160.0)
}

/// `(N_u - x w_u) / w` over `3 (p + q) R omega`: with `|N_u|` and `|x w_u|` at most `2 (p + q)` of the largest product of
/// weight and coordinate, and the turn into the other frame.
fn slope() -> RBig {
    let off = value(MOST, &derivative(MOST, &once()));
    let of_point = units(96.0);
    let product_off = &off + &of_point + once();
    let numerator = RBig::from(2) * (&off + product_off + RBig::from(2) * once());
    let below = RBig::from(4) * (value(MOST, &value(MOST, &RBig::ZERO)) + once());
    (numerator + below) / RBig::from(3) + rotation() + product() + units(20.0)
}

/// A coefficient of the height above a bowl of a patch of degrees three and three, in the middle, where sixteen products
/// meet: relative to the sum of the absolute terms, which is at most one and a half times the unit for slopes up to one.
fn bent() -> RBig {
    // The shift by the point of contact, and the product with a direction; that is rounded once in each frame.
    let shifted = RBig::from(2) * once();
    let vector = |c, off: &RBig| Majorant::vector::<3>(c, off);
    let along = |off: &RBig| {
        let height = crate::number::dot(vector('n', &once()), vector('x', off));
        height.error().at(|_| RBig::ONE) / RBig::from(3)
    };
    let of_height = along(&shifted) * RBig::from(2);
    let factor = |c: char, k: u8, off: &RBig| Majorant::input(c, k, off);
    let scaled = (RBig::ONE + of_height) * (RBig::ONE + once()) - RBig::ONE;
    let mut total = None;
    for k in 0..16 {
        let weight = factor('w', k, &once());
        let [h, s, t] = ['h', 's', 't'].map(|c| factor(c, k, &scaled));
        let image = |c, d| {
            let off = &scaled;
            factor('m', k, &RBig::ZERO) * factor(c, k, off) + factor('l', k, &RBig::ZERO) * factor(d, k, off)
        };
        let part = h * weight + s * image('a', 'b') + t * image('c', 'd');
        total = Some(total.map_or(part, |sum| sum + part));
    }
    let above = total.expect("sixteen products").relative() + once();
    let below = (RBig::ONE + unit()).pow(20) - RBig::ONE;
    // Directions that are perpendicular within six roundings.
    RBig::from(3) / RBig::from(2) * (above + below + once()) + units(6.0)
}
