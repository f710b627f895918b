//! Motions and cubics of time.

use super::{Bound, once, units};
use crate::factor::Factor;
use crate::kernels::places;
use crate::majorant::{Majorant, unit};
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    vec![
        Bound::whole("PLACED_CENTRE", "motion::steady::pose", pivot()),
        Bound::whole("BERNSTEIN", "separation::bernstein::rest", cuts()),
        Bound::whole("ARM_VALUE", "plan", between()),
        Bound::whole("ROOT", "separation::bernstein::crossing", crossing()).part("one crossing", 8.0),
    ]
}

fn exactly(letter: char) -> Majorant {
    Majorant::input(letter, 0, &RBig::ZERO)
}

/// Twice: the pivot, and the difference with the turned one; the velocity at a later time is two roundings more.
fn pivot() -> RBig {
    let at = places::pivot(['c', 'v', 'a'].map(exactly), exactly('t'));
    RBig::from(2) * (at.relative() + units(3.0))
}

/// Four cuts, each at a place of its own, of coefficients rounded once: relative to the largest coefficient, as the
/// factors of every coefficient sum up to one.
fn cuts() -> RBig {
    let mut c: [Majorant; 4] = std::array::from_fn(|k| Majorant::input('c', k as u8, &unit()));
    for k in 0..4 {
        let (x, y) = (Majorant::input('x', k, &RBig::ZERO), Majorant::input('y', k, &once()));
        c = places::rest(c, x, y);
    }
    c.map(Majorant::relative).into_iter().max().expect("four coefficients")
}

/// A value between two, at a time up to one, over the greater of the two: a round of de Casteljau's algorithm, which
/// averages the errors of the rounds before.
fn between() -> RBig {
    let (a, b) = (exactly('a'), exactly('b'));
    (a + (b - a) * exactly('t')).error().at(|_| RBig::ONE)
}

/// `(i + k p / (p - q)) / 3` of coefficients of either sign, with p not negative and q negative.
fn crossing() -> RBig {
    let (p, sum) = (Factor::input(), Factor::difference());
    let third = Factor::off(&once());
    let part = p / sum;
    ((Factor::input() + Factor::input() * part) * third).error()
}
