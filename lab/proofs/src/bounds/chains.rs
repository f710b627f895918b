//! Chains of positive numbers: odometers, ticks, discs, normals, and the columns of the broad phase.

use super::{Bound, once, units};
use crate::factor::{Factor, Positive};
use crate::majorant::{Majorant, SINGLE, power, rounding, unit};
use crate::number::dot;
use crate::vectors::{Arrow, Lengths, Vectors};
use dashu_ratio::RBig;
use truth::rational::exact;

pub(super) fn bounds() -> Vec<Bound> {
    let whole = Bound::whole;
    let column = |constant, kernel, error| Bound::single(constant, kernel, error);
    vec![
        whole("ODOMETER", "scene::budget::wake", odometer()),
        whole("TICK", "schedule::ticks", ticks()),
        whole("REGION", "patch::region", RBig::from(2) * once()),
        whole("DISC", "depth::facet::disc_radius", disc()),
        whole("DISC", "depth::facet::disc_radius", turned_off()).part("absolute", 256.0),
        whole("PLATEAU", "depth::search", plateau()),
        whole("CROSS_CANCELLED", "polyhedron::plane::cross", cancelled()).part("of a direction", 1.0 / 64.0),
        whole("NORMAL_ERROR", "polyhedron::plane::plane", normal()),
        whole("PLANE_OFFSET", "polyhedron::plane::plane", offset() / unit())
            .sum("product, in UNIT^2", &[(4.0, "UNIT_DOUBLE_DOUBLE")]),
        whole("PLANE_OFFSET", "polyhedron::plane::plane", tilted() + offset()),
        whole("NEAR_PLANE", "polyhedron::query::contains", near_plane()),
        column("COLUMN_SUM", "broad::sweep::scan", column_sum()),
        column("COLUMN_MOVE", "broad::sweep::scan", RBig::from(4) * v()),
        column("COLUMN_SEARCH", "broad::sweep::repair", RBig::from(6) * v()),
        column("COLUMN_REACH", "broad::sweep::repair", RBig::from(6) * v()),
    ]
}

/// One rounding of single precision.
fn v() -> RBig {
    rounding(SINGLE)
}

/// The sum at which a pair wakes, `s - c s`, is no more than the sum of two odometers that is computed later: the sum of
/// odometers, that with the slack, the product and the difference, and the later sum.
fn odometer() -> RBig {
    ((RBig::ONE + once()).pow(4) / (RBig::ONE - once()) - RBig::ONE) * (RBig::ONE + units(16.0))
}

/// A clock that adds up a million ticks, each sum rounded; the quotient and the product.
fn ticks() -> RBig {
    (RBig::from(1 << 20) + RBig::from(3)) * unit()
}

/// Roots, quotient, products and sum of the radius of a disc, each of numbers that are not negative.
fn disc() -> RBig {
    let side = Factor::input() * (Factor::input().squared() + Factor::input().squared()).root();
    let off = side + Factor::input().root();
    (off * Factor::input() / Factor::input() * Factor::input()).error()
}

/// The cross product of two unit vectors, each off as a normal made of edges is in the frame of the pair, is off by so
/// much of the radius, which is no more than half as much again as the height.
fn turned_off() -> RBig {
    let n = Arrow::new(53, RBig::ONE, units(16.0));
    Lengths::cross(n, n).error() * exact(1.5)
}

/// Two heights and the rounding of the direction.
fn plateau() -> RBig {
    let [n, p] = ['n', 'p'].map(|c| Majorant::vector(c, &RBig::ZERO));
    RBig::from(2) * (dot(n, p).relative() + once())
}

/// Two products of a double-double and their difference, beside a cross product that is not below `2^-40` of them; as a
/// vector of three.
fn cancelled() -> RBig {
    let of = units(16.0) * unit();
    let coordinate = &of * RBig::from(2) * power(40) + of;
    super::root(3) * coordinate * (RBig::ONE + power(-20))
}

/// The direction as above, an inverse root of twice the precision, a product, and one rounding a coordinate.
fn normal() -> RBig {
    once() + cancelled() + units(64.0) * unit()
}

/// Three sums of exact products, each off by ten of UNIT^2 at most of what is no longer than the point.
fn offset() -> RBig {
    RBig::from(3) * units(10.0) * unit()
}

/// The error of the normal times the distances, which are computed too.
fn tilted() -> RBig {
    units(1.0625) * (RBig::ONE + reach())
}

/// The root of three squares, the sum with the radius, and the product.
fn reach() -> RBig {
    let square = || Factor::input().squared();
    let length = (square() + square() + square()).root();
    ((length + Factor::input()) * Factor::input()).error()
}

/// A point of the plane: the height is off by the normal's error times two radii, the offset is rounded up by as much
/// and by one in the last place, and the height by its product and difference.
fn near_plane() -> RBig {
    let tilt = units(1.0625) * RBig::from(2);
    let n = Arrow::new(53, RBig::ONE + units(2.0), RBig::ZERO);
    let p = Arrow::new(53, RBig::ONE, RBig::ZERO);
    let height = Lengths::dot(n, p).error();
    RBig::from(2) * tilt + height + units(2.0) + RBig::from(2) * once() + power(-60)
}

/// The sum with an end, and the three sums of the magnitudes.
fn column_sum() -> RBig {
    v() / (RBig::ONE - v()).pow(5) * (RBig::ONE + RBig::from(8) * v()) + v() * v() * RBig::from(16)
}
