//! Distances of features in double-double, and the signs in f64 that prove the features the closest.
//!
//! Lengths are the radii `a` and `b` and the distance `t` of the origins, as in [`certificate`](super::certificate);
//! edges are of length one, as every form is of degree zero in them. What a normal of length `s` errs by is told per
//! `1 / s`, the stretch of the source.

use super::certificate::{of_length, turn_of_twice};
use super::poses::rotation;
use super::{Bound, units};
use crate::kernels::{certificate, closed_form};
use crate::majorant::{DOUBLE, power, rounding, unit};
use crate::polynomial::Polynomial;
use crate::vectors::{Arrow, Lengths, Turn, Vectors};
use dashu_ratio::RBig;

/// The precision of double-double, by the bound of its operations.
const TWICE: u32 = 102;

pub(super) fn bounds() -> Vec<Bound> {
    let w = between();
    let area = Lengths::cross(w, edge());
    let turned = closed_form::turned::<Lengths>([turn_of_twice(); 2], edge());
    let of_length = |count: u32| size().scaled(&(RBig::from(count) * of_length(TWICE)));
    vec![
        row("vertices", w.error_by_lengths().plus(&of_length(1))),
        // The root of a quotient of two squares.
        row("vertex and edge", area.error_by_lengths().plus(&of_length(3))),
        row("vertex and face", over_plane(w, [edge(); 2])),
        row("edges", over_plane(w, [edge(), turned])),
        clearly("a vertex falls", falls()),
        clearly("a point beside an edge", beside()),
    ]
}

fn row(part: &'static str, error: Polynomial) -> Bound {
    let proved = error.over(&size()).expect("lengths of the pair") / power(-i64::from(TWICE));
    Bound::whole("CLOSED_FORM", "convex::solve::closed_form", proved * unit()).case(part)
}

fn clearly(part: &'static str, error: RBig) -> Bound {
    Bound::whole("CLEAR_SIGN", "convex::solve::closed_form", error).case(part)
}

fn variable(letter: char) -> Polynomial {
    Polynomial::variable(letter, 0)
}

/// The size L.
fn size() -> Polynomial {
    ['a', 'b', 't']
        .iter()
        .fold(Polynomial::default(), |s, c| s.plus(&variable(*c)))
}

/// An edge, whose coordinates are exact.
fn edge() -> Arrow {
    Arrow::new(TWICE, RBig::ONE, RBig::ZERO)
}

/// From a vertex of A to one of B, of bodies about their own origins.
fn between() -> Arrow {
    let [a, b, t] = ['a', 'b', 't'].map(|c| Arrow::new(TWICE, variable(c), RBig::ZERO));
    certificate::shift::<Lengths>([turn_of_twice(); 2], [a, b], t).at_most(size())
}

/// The height of a point over the plane of two edges, times the length of the normal; the error of that length; and the
/// rounding of the quotient. All but the first are told per length of the normal, which is at most one.
fn over_plane(w: Arrow, edges: [Arrow; 2]) -> Polynomial {
    let (n, height) = closed_form::height::<Lengths>(w, edges);
    let relative = n.error() + of_length(TWICE) + rounding(TWICE);
    height.error_by_lengths().plus(&size().scaled(&relative))
}

/// A direction in the frame of the other body, and its product with an edge: both are rounded once.
fn falls() -> RBig {
    let n = Arrow::new(DOUBLE, RBig::ONE, units(1.0));
    let turn = Turn::new(DOUBLE, RBig::ONE + rotation(), rotation());
    let turned = Lengths::product(turn, n).at_most(RBig::ONE);
    Lengths::dot(turned, n).error() + units(8.0)
}

/// A product of three vectors whose coordinates are rounded, and the rounding of what it is compared with.
fn beside() -> RBig {
    let one = Arrow::new(DOUBLE, RBig::ONE, units(1.0));
    Lengths::dot(one, Lengths::cross(one, one)).error() + units(16.0)
}
