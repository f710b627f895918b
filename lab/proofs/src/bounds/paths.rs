//! Vertices on straight paths, coordinates at most one.

use super::{Bound, units};
use crate::kernels::paths;
use crate::majorant::{DOUBLE, Majorant, rounding, unit};
use crate::number::Vector;
use crate::polynomial::Polynomial;
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    vec![gap(), volume(), area_at_an_end(), area_between()]
}

fn constant(x: RBig) -> Polynomial {
    Polynomial::constant(x)
}

/// The error of a coordinate at an instant. The ends are differences, rounded once; of the shares of a time from zero
/// to one the second is exact, and the first, at most one, is off by half a unit. What errs is linear in the shares,
/// whose sum is one: it is largest where one of them is.
fn place_error() -> RBig {
    let half = unit() / RBig::from(2);
    let first = Majorant::with_error(DOUBLE, Polynomial::variable('s', 0), constant(half));
    let ends = ['x', 'y'].map(|c| Majorant::input(c, 0, &unit()));
    let place = paths::place(ends, [first, Majorant::input('t', 0, &RBig::ZERO)]);
    let at = |s: u8, t: u8| {
        place.error().at(|letter| match letter {
            's' => RBig::from(s),
            't' => RBig::from(t),
            _ => RBig::ONE,
        })
    };
    at(1, 0).max(at(0, 1))
}

/// A place as the code has it.
fn place(letter: char) -> Vector<Majorant> {
    let error = place_error();
    std::array::from_fn(|k| {
        let value = Polynomial::variable(letter, k as u8);
        Majorant::with_error(DOUBLE, value, constant(error.clone()))
    })
}

/// An error where coordinates of places are one, over the sum of the magnitudes of the direction `n`: linear in n, so
/// at most as along one axis. The sum and its product with the constant, four roundings, may be too small.
fn per_direction(error: &Polynomial) -> RBig {
    let along = |axis: u8| {
        let on_axis = error.with('n', |k| constant(RBig::from(u8::from(k == axis))));
        on_axis.at(|_| RBig::ONE)
    };
    let most = along(0).max(along(1)).max(along(2));
    most / (RBig::ONE - units(4.0))
}

fn direction() -> Vector<Majorant> {
    Majorant::vector('n', &RBig::ZERO)
}

/// The difference of two heights is compared with the doubt, which is exact.
fn gap() -> Bound {
    let gap = paths::gap(direction(), [place('p'), place('q')]);
    Bound::whole(
        "PATH_GAP",
        "continuous::paths::VertexPlaces::gap",
        per_direction(gap.error()),
    )
}

/// A coefficient between the ends: three volumes, each at most six, their sum, and its third.
fn volume() -> Bound {
    let one = paths::volume([place('a'), place('b'), place('c')]);
    let error = one.error().at(|_| RBig::ONE);
    let six = |index: u8| Majorant::with_error(DOUBLE, Polynomial::variable('v', index), constant(error.clone()));
    let sum = paths::thrice([six(0), six(1), six(2)]);
    let third = sum.error().at(|_| RBig::from(6)) / RBig::from(3);
    let divided = &third + rounding(DOUBLE) * (RBig::from(6) + &third);
    Bound::whole("PATH_VOLUME", "continuous::paths::volumes", divided)
}

fn area_at_an_end() -> Bound {
    let area = paths::end(['i', 'j', 'k'].map(place), direction());
    Bound::whole("PATH_AREA", "continuous::paths::turn", per_direction(area.error())).case("at an end")
}

fn area_between() -> Bound {
    let [first, second] = [['i', 'j', 'k'], ['l', 'm', 'o']].map(|c| c.map(place));
    let area = paths::middle([first, second], direction());
    Bound::whole("PATH_AREA", "continuous::paths::turn", per_direction(area.error())).case("between")
}
