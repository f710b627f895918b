//! Both bounds of a distance, of curved shapes, half-spaces and surfaces: as for polyhedra, with what their support
//! points add. Coordinates of a support point are products and quotients, so each errs relative to itself: the point is
//! off the surface by so much of its distance from the origin, and as no term of its height is negative, too low by no
//! more.

use super::certificate::{Frame, of_length, variable};
use super::{Bound, units};
use crate::factor::{Factor, Positive};
use crate::kernels::{certificate, curved};
use crate::majorant::{DOUBLE, Majorant, power, unit};
use crate::norm::length;
use crate::polynomial::Polynomial;
use crate::vectors::{Lengths, Vectors, Within};
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    let (a, twice) = (Frame::of_a(), Frame::of_double_double());
    let [lower, upper] = pair(&a);
    let [fine_lower, fine_upper] = pair(&twice);
    let [low, high] = half_space(&a);
    vec![
        a.row("curved, lower", "smooth::best_bounds::prove", lower),
        a.row("curved, upper", "smooth::best_bounds::mixture", upper),
        twice.row(
            "curved in double-double, lower",
            "smooth::best_bounds::prove",
            fine_lower,
        ),
        twice.row(
            "curved in double-double, upper",
            "smooth::best_bounds::mixture",
            fine_upper,
        ),
        a.row("half-space, lower", "contact::half_space::distance", low),
        a.row("half-space, upper", "contact::half_space::distance", high),
        a.row("surfaces, gap of two nets", "patch::gap::Trees::gap", nets(&a)),
    ]
}

/// So many roundings of a frame's precision; a root in double-double is three instead of one.
fn of_precision(frame: &Frame, error: &RBig, roots: usize) -> RBig {
    let more = if frame.precision == DOUBLE { 0 } else { 2 * roots };
    (error / unit() + RBig::from(more)) * frame.once() * (RBig::ONE + power(-40))
}

/// By how much a coordinate of a support point is off, relative to itself.
fn on_surface(frame: &Frame) -> RBig {
    let [axes, n] = [0; 2].map(|_| std::array::from_fn(|_| Factor::input()));
    let [x, ..] = curved::on_ellipsoid(&axes, &n);
    let [y, _] = curved::on_circle(Factor::input(), &[Factor::input(), Factor::input()]);
    of_precision(frame, &x.error().max(y.error()), 1)
}

/// By how much the branch that a cone is searched on may be lower than the other, over the reach: the heights of apex
/// and rim as compared, along a direction whose part across the axis is a root of two squares.
fn of_branch(frame: &Frame) -> RBig {
    let exactly = |letter, k| Majorant::input(letter, k, &RBig::ZERO);
    let square = || Factor::input().squared();
    let across = (square() + square()).root().error();
    let n = [Majorant::input('n', 0, &across), exactly('n', 1)];
    let [apex, rim] = curved::apex_and_rim([exactly('r', 0), exactly('r', 1)], n);
    of_precision(frame, &length(&[&apex.error().plus(rim.error())], &[]), 1)
}

/// A vertex of a polyhedron that is taken for the highest as rounded, in f64.
fn of_vertex(frame: &Frame) -> RBig {
    if frame.precision == DOUBLE {
        let one = || frame.arrow(RBig::ONE.into());
        Lengths::dot(one(), one()).error() * RBig::from(2)
    } else {
        RBig::ZERO
    }
}

/// Up to four points by their weights, with the quotient by their sum and the product with it.
fn of_mixture(frame: &Frame) -> RBig {
    let inputs = |letter| [0, 1, 2, 3].map(|k| Majorant::input(letter, k, &RBig::ZERO));
    let [total, sum] = curved::mixed(&inputs('p'), &inputs('w'));
    let off = total.relative() + sum.relative() + RBig::from(2) * unit();
    of_precision(frame, &(off * (RBig::ONE + units(20.0))), 0)
}

fn radii() -> Polynomial {
    variable('a').plus(&variable('b'))
}

/// The height of the support points along a direction that was divided by its length; and the distance of two points,
/// each a mixture.
fn pair(frame: &Frame) -> [Polynomial; 2] {
    let w = frame.placing.difference(['a', 'b'].map(|c| frame.arrow(variable(c))));
    let height = Lengths::dot(frame.direction(), w).error_by_lengths();
    let longer = frame.part(&(of_length(frame.precision) + RBig::from(2) * frame.once()));
    let of_shape = on_surface(frame);
    let missed = (&of_shape + of_branch(frame)).max(of_vertex(frame));
    let lower = height
        .plus(&longer)
        .plus(&frame.lower_vertex())
        .plus(&radii().scaled(&missed));
    let off = radii().scaled(&(of_shape + of_mixture(frame)));
    let upper = w
        .error_by_lengths()
        .plus(&off)
        .plus(&frame.part(&of_length(frame.precision)));
    [lower, upper]
}

/// A vertex in the caller's unit, over a plane whose normal was divided by its length and whose offset is `a`; the radius
/// and the distance of the stored origin are `b`.
fn half_space(frame: &Frame) -> [Polynomial; 2] {
    let longer = of_length(DOUBLE) + frame.once();
    let normal = frame.arrow((RBig::ONE + &longer).into());
    let b = variable('b');
    let vertex = crate::vectors::Arrow::new(DOUBLE, b.clone(), b.scaled(&frame.once()));
    let offset = Within::new(DOUBLE, variable('a'), RBig::ZERO);
    let height = certificate::over_plane::<Lengths>(normal, frame.placing.in_a(vertex), offset);
    let upper = height.error_by_lengths().plus(&frame.part(&longer));
    [upper.plus(&frame.lower_vertex()), upper]
}

/// Heights of both nets along a direction that was divided by its length. Points and coefficients have their own errors,
/// which are counted beside.
fn nets(frame: &Frame) -> Polynomial {
    let longer = of_length(DOUBLE) + frame.once();
    let n = frame.arrow((RBig::ONE + &longer).into());
    let high_a = Lengths::dot(n, frame.arrow(variable('a')));
    let high_b = Lengths::dot(frame.placing.turned_to_b(n), frame.arrow(variable('b')));
    let gap = certificate::between_nets::<Lengths>(n, frame.placing.translation, [high_a, high_b]);
    gap.error_by_lengths().plus(&frame.part(&longer))
}
