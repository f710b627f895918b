//! Bézier and NURBS patches.

use super::{Bound, once};
use crate::kernels::patches;
use crate::majorant::Majorant;
use crate::norm::length;
use crate::polynomial::Polynomial;
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    vec![
        Bound::whole("PATCH_POINT", "patch::bezier::value", point()),
        Bound::whole("KNOTS", "patch::nurbs::blossom", knots()),
        Bound::whole("RAISED", "patch::net::raise", raised()),
        Bound::whole("NET", "patch::net::homogeneous", after(0, &RBig::ZERO)),
        Bound::whole("NET_STEP", "patch::bezier::halves", halves())
            .sum("a thousand, with NET", &[(1.0, "NET"), (1000.0, "NET_STEP")]),
        Bound::whole("NET_CUT", "patch::cut", cuts())
            .sum("degrees 7 and 7, with NET", &[(1.0, "NET"), (14.0, "NET_CUT")]),
        Bound::whole("COEFFICIENT", "patch::height::fill", coefficient()),
    ]
}

/// The relative error of a number whose terms are not negative, for inputs with a relative error of `off`.
fn held(count: usize, off: &RBig) -> Vec<Majorant> {
    (0..count).map(|k| Majorant::input('p', k as u8, off)).collect()
}

/// A curve of degree seven, of points with a relative error.
fn end(off: &RBig) -> RBig {
    let (s, t) = (Majorant::input('s', 0, &once()), Majorant::input('t', 0, &RBig::ZERO));
    patches::end(held(8, off), s, t).relative()
}

/// A quotient of two sums, each term of which errs by so much of itself, over the largest quotient of their terms.
fn quotient(above: RBig, below: RBig) -> RBig {
    (above + &below) / (RBig::ONE - below)
}

/// Degrees seven and seven; the products of weight and coordinate, and the quotient.
fn point() -> RBig {
    let (above, below) = (end(&end(&once())), end(&end(&RBig::ZERO)));
    let off = quotient(above, below);
    &off * (RBig::ONE + once()) + once()
}

/// Seven levels in both directions; a factor is a quotient of two differences of knots.
fn knots() -> RBig {
    let factor = |k: char, level: usize, i: usize| {
        let off = (RBig::ONE + once()).pow(2) / (RBig::ONE - once()) - RBig::ONE;
        Majorant::input(k, (8 * level + i) as u8, &off)
    };
    let once_along = |off: &RBig| {
        patches::blossom(held(8, off), |level, i| [factor('s', level, i), factor('r', level, i)]).relative()
    };
    let off = once_along(&once_along(&once()));
    quotient(off.clone(), off) + once()
}

/// From degree one to seven; a factor is a quotient of whole numbers.
fn raised() -> RBig {
    let mut points = held(2, &RBig::ZERO);
    for n in 1..7 {
        let m = RBig::from(n + 1);
        let factor = |j: usize| {
            let value = Polynomial::constant(RBig::from(j) / &m);
            Majorant::with_error(53, value.clone(), value.scaled(&once()))
        };
        points = patches::raise(points, |j| [factor(n + 1 - j), factor(j)]);
    }
    let off = points.into_iter().map(Majorant::relative).max().expect("eight points");
    quotient(off.clone(), off)
}

/// The quotient of a product of weight and coordinate and of the weight, after steps that multiply the relative error by
/// `1 + step` each. Weights are scaled by a power of two, which rounds nothing.
fn after(steps: isize, step: &RBig) -> RBig {
    let grown = (RBig::ONE + step).pow(steps);
    let [above, below] = [once(), RBig::ZERO].map(|off| (RBig::ONE + off) * &grown - RBig::ONE);
    quotient(above, below) * (RBig::ONE + once()) + once()
}

/// A thousand halves: a sum has one rounding, and its half is exact.
fn halves() -> RBig {
    let [a, b] = [0, 1].map(|k| Majorant::input('p', k, &RBig::ZERO));
    after(1000, &(a + b).relative())
}

/// Two cuts in each direction of degrees seven and seven, each step with three roundings a term.
fn cuts() -> RBig {
    let (s, t) = (Majorant::input('s', 0, &once()), Majorant::input('t', 0, &RBig::ZERO));
    after(28, &patches::end(held(2, &RBig::ZERO), s, t).relative())
}

/// `n . N - c w` over `R w`, for a unit normal, `|N| <= R w` and `|c| <= R`.
fn coefficient() -> RBig {
    let vector = |letter| Majorant::vector::<3>(letter, &RBig::ZERO);
    let one = |letter| Majorant::input(letter, 0, &RBig::ZERO);
    let height = patches::coefficient(vector('n'), vector('p'), one('c'), one('w'));
    length(&[height.error()], &[])
}
