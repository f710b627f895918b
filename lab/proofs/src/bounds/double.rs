//! Numbers of twice the precision, in units of UNIT^2.

use super::Bound;
use crate::kernels::double::{self, ErrorFree};
use crate::majorant::{Majorant, rounding, unit};
use crate::polynomial::Polynomial;
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    let bound = |part, kernel, error: RBig, allowed| {
        Bound::whole("UNIT_DOUBLE_DOUBLE", kernel, error / unit()).part(part, allowed)
    };
    vec![
        bound("product", "num::double_double::mul", product(), 10.0),
        bound("quotient", "num::double_double::div", quotient(), 5.0),
    ]
}

impl ErrorFree for Majorant {
    /// The sum is exact as a whole, which is all that is asked of the parts: the second is the variable `e`.
    fn quick_two_sum(self, other: Self) -> (Self, Self) {
        let rest = Polynomial::variable('e', 0);
        let minus = rest.scaled(&-RBig::ONE);
        let value = self.value().plus(other.value()).plus(&minus);
        let head = Self::with_error(53, value, self.error().plus(other.error()));
        (head, Self::with_error(53, rest, Polynomial::default()))
    }

    fn two_sum(self, other: Self) -> (Self, Self) {
        self.quick_two_sum(other)
    }

    /// The product of two inputs is exact as a whole: the second part is the variable `t`.
    fn two_product(self, other: Self) -> (Self, Self) {
        assert!(self.error().is_zero() && other.error().is_zero(), "factors are inputs");
        let rest = Polynomial::variable('t', 0);
        let value = self.value().times(other.value()).plus(&rest.scaled(&-RBig::ONE));
        let none = Polynomial::default;
        (Self::with_error(53, value, none()), Self::with_error(53, rest, none()))
    }
}

/// Low parts are at most UNIT of the high ones, the error of a product at most a rounding of it. What is left out is
/// the product of the low parts.
fn product() -> RBig {
    let input = |letter, index| Majorant::input(letter, index, &RBig::ZERO);
    let (a, b) = ([input('a', 0), input('a', 1)], [input('b', 0), input('b', 1)]);
    let [high, low] = double::mul(a, b);
    let [x, y] = ['a', 'b'].map(|c| Polynomial::variable(c, 0).plus(&Polynomial::variable(c, 1)));
    let computed = high.value().plus(low.value());
    let left_out = computed.plus(&x.times(&y).scaled(&-RBig::ONE)).absolute();
    let error = left_out.plus(high.error()).plus(low.error());
    let of_high =
        |letter| move |k: u8| Polynomial::variable(letter, 0).scaled(&if k == 0 { RBig::ONE } else { unit() });
    let both = Polynomial::variable('a', 0).times(&Polynomial::variable('b', 0));
    let error = error.with('t', |_| both.scaled(&rounding(53)));
    let error = error.with('a', of_high('a')).with('b', of_high('b'));
    let least = (RBig::ONE - unit()).pow(2);
    error.over(&both).expect("terms of the product") / least
}

/// Every partial result is the true quotient times a polynomial in the errors of the steps:
///
/// * `d`: of a quotient of two high parts, three roundings and second order;
/// * `e`: of a double-double times a number, `3 UNIT^2`, and of a difference, `3 UNIT^2` and second order (Joldes,
///   Muller and Popescu 2017, algorithms 9 and 6);
/// * `c`: the error of the sum of the first two quotients; `g`: of the last rounding of the low part.
fn quotient() -> RBig {
    let v = Polynomial::variable;
    let one = Polynomial::constant(RBig::ONE);
    let minus = |p: &Polynomial| p.scaled(&-RBig::ONE);
    let one_and = |p: &Polynomial| one.plus(p);
    let [d1, d2, d3] = [1, 2, 3].map(|k| v('d', k));
    let [e1, e2, e3, e4] = [1, 2, 3, 4].map(|k| v('e', k));
    let q1 = one_and(&d1);
    let r1 = one.plus(&minus(&q1.times(&one_and(&e1)))).times(&one_and(&e2));
    let q2 = r1.times(&one_and(&d2));
    let r2 = r1.plus(&minus(&q2.times(&one_and(&e3)))).times(&one_and(&e4));
    let q3 = r2.times(&one_and(&d3));
    let last = v('c', 0).plus(&q3).times(&v('g', 0));
    let off = q1.plus(&q2).plus(&q3).plus(&last).plus(&minus(&one));
    let little = |count: f64| truth::rational::exact(count) * unit();
    off.absolute().at(|letter| match letter {
        'd' => little(3.01),
        'e' => little(3.01) * unit(),
        _ => little(1.01),
    })
}
