//! Signs of sums of products.

use super::poses::{product, rotation};
use super::{Bound, once, terms, units};
use crate::factor::{Factor, Positive};
use crate::kernels::signs;
use crate::majorant::{Majorant, unit};
use crate::norm::length;
use crate::number::{Number, Vector, cross, dot, named};
use crate::polynomial::{Polynomial, Symbol};
use dashu_ratio::RBig;

/// A stored normal errs by `NORMAL_ERROR` of its length.
fn normal_error() -> RBig {
    units(1.0625)
}

pub(super) fn bounds() -> Vec<Bound> {
    let mut all = vec![edge_sign(), steeper(), side_error(), orientation(), side_of_pyramid()];
    all.extend(volume());
    all.extend(foot());
    all.extend([
        cell(),
        height(),
        edge_bound(),
        exact_filter(),
        flank_on_a(),
        flank_on_b(),
        slant(),
    ]);
    all
}

/// A vector that the code holds with a relative error of `off` a coordinate.
fn held(letter: char, off: &RBig) -> Vector<Majorant> {
    Majorant::vector(letter, off)
}

fn exactly(letter: char) -> Vector<Majorant> {
    held(letter, &RBig::ZERO)
}

/// The code holds the exact edge, rounded once, and the direction, rounded once.
fn edge_sign() -> Bound {
    let (value, _) = signs::rise(held('n', &unit()), held('e', &once()));
    let error = value.error().over(&terms('n', 'e')).expect("the terms of the product");
    Bound::whole("EDGE_SIGN", "num::sign::rise", error)
}

fn steeper() -> Bound {
    let off = (unit(), once());
    let (value, _) = signs::slopes(
        [held('n', &off.0), held('m', &off.0)],
        [held('e', &off.1), held('f', &off.1)],
    );
    let both = |a, b, c, d| terms(a, b).times(&terms(c, d));
    let size = both('n', 'e', 'm', 'f').plus(&both('n', 'f', 'm', 'e'));
    let error = value.error().over(&size).expect("the terms of the products");
    Bound::whole("STEEPER", "polyhedron::heights::slopes", error)
}

/// The guard, which is computed too, errs below by `low` of itself; the product with the constant rounds twice more.
fn side_error() -> Bound {
    let [u, w, d] = ['u', 'w', 'd'].map(|c| held(c, &once()));
    let size = signs::products(exactly('u'), exactly('w'));
    let size = (0..3u8).fold(Polynomial::default(), |sum, k| {
        sum.plus(&size[k as usize].value().times(&Polynomial::variable('d', k)))
    });
    let over = |x: Majorant| x.error().over(&size).expect("the terms of the height");
    let low = over(dot(signs::products(u, w), d));
    let one = RBig::ONE;
    let rounded = (&one - once()) * (&one - once());
    let error = over(signs::side([u, w, d])) / ((one - low) * rounded);
    Bound::whole("SIDE_ERROR", "hull::side_height", error)
}

/// The rounding of the determinant, and with vertices displaced by 128 UNIT of L.
fn volume() -> [Bound; 2] {
    let value = signs::volume([exactly('a'), exactly('b'), exactly('c')]);
    let own = length(&[value.error()], &[]);
    let kernel = "num::scalar::{dot, cross}";
    let off = units(128.0);
    let grown = (RBig::ONE + &off).pow(3);
    let error = &own * &grown + grown - RBig::ONE;
    [
        Bound::whole("VOLUME", kernel, own).part("rounding", 14.0),
        Bound::whole("VOLUME", kernel, error),
    ]
}

/// Relative to `|u| |v| L`; what is taken off, `|u|^2 + |v|^2`, is at least twice as much.
fn orientation() -> Bound {
    let (_, height) = signs::pyramid_side([exactly('p'), exactly('a'), exactly('q')]);
    let error = length(&[height.error()], &[]) / RBig::from(2);
    Bound::whole("ORIENTATION", "depth::pyramid::PyramidSide::new", error)
}

/// The distance of a side's plane from the origin, `sqrt(low^2 / n^2)`, where `low` is the height less what is taken off:
/// in units of `2 |u| |v| L / |n|`, as both squares are at least that. With E the error of the height, X that of the
/// normal over `|u| |v|` and K that of the quotient and of its root, relative to a distance up to L,
///
/// `(height - E) / (|n| + X |u| |v|) >= low (1 + K) / |n|` if what is taken off is more than `E + (X + K) |u| |v| L`,
///
/// since `low <= |n| L` and `|n| <= |u| |v|`. The difference and what is taken off are rounded too.
fn side_of_pyramid() -> Bound {
    let (_, height) = signs::pyramid_side([exactly('p'), exactly('a'), exactly('q')]);
    let edges = RBig::from(2) * (RBig::ONE + once());
    let of_normal = cross_product() + edges * once();
    let square = || Factor::input().squared();
    let low = Factor::difference();
    let quotient = (low.squared() / (square() + square() + square())).root();
    let second_order = units(200.0) * unit();
    let error = length(&[height.error()], &[]) + of_normal + quotient.error() + second_order;
    // The squares, their sums and the product with the constant.
    let taken = RBig::ONE - units(6.0);
    let kernel = "depth::pyramid::Pyramid::radius";
    Bound::whole("ORIENTATION", kernel, error / RBig::from(2) / taken).case("height of a side as a quotient")
}

/// The side of the foot over `|edge| |to|`, and with the foot itself, off by its height and the tilt of the normal.
fn foot() -> [Bound; 2] {
    let tilted = |k: u8| {
        let value = Polynomial::variable('n', k);
        Majorant::with_error(53, value, Polynomial::variable('t', k))
    };
    let n = [0, 1, 2].map(tilted);
    let side = signs::over_side(n, held('e', &once()), held('d', &once()));
    let side = length(&[side.error()], &[('t', normal_error())]);
    let on = signs::foot(exactly('p'), exactly('n'), Majorant::input('h', 0, &RBig::ZERO));
    let on = [0, 1, 2].map(|k| on[k].named('f', k as u8));
    let off = length(&on.each_ref().map(|x| x.error()), &[]);
    let kernel = "polyhedron::query::over_side";
    [
        Bound::whole("FOOT", kernel, side.clone()).part("side", 9.4),
        Bound::whole("FOOT", kernel, side + off + normal_error()),
    ]
}

/// A height, twice.
fn cell() -> Bound {
    let height = dot(exactly('a'), exactly('b'));
    let error = RBig::from(2) * length(&[height.error()], &[]);
    Bound::whole("CELL", "nalgebra dot", error)
}

/// Two heights of points no farther than the radius, their difference, no more than that, and the sum with the bound.
fn height() -> Bound {
    let gap = signs::height_over(exactly('n'), exactly('p'), exactly('c')).named('g', 0);
    let error = length(&[gap.error()], &[]) + unit();
    Bound::whole("HEIGHT", "separation::polyhedra::over_middle", error)
}

/// In units of `s (alpha + beta) r`, for planes with unit normals and offsets up to r, and `|x| <= r`.
///
/// For the numbers s, alpha and beta as the code has them, `n . x <= s (alpha oL + beta oR) + |n - s M| r` is exact,
/// with M the exact sum of the normals. Three things are between that and the code:
///
/// 1. The rest as computed is off the exact one. Linear in the weights, so at most as for the greater one alone.
/// 2. Its 1-norm is raised and multiplied. The rest is at right angles to n but for the rounding of s, so no longer
///    than `s m`. The two sums of the norm cost nothing: a rounded sum is no less than its largest term. So either the
///    norm is longer than the length by what the sums lose, or the other terms are below `4 u` of the largest, which
///    is then the length to `8 u^2`.
/// 3. The sum of the offsets.
fn edge_bound() -> Bound {
    let one = |letter| Majorant::input(letter, 0, &RBig::ZERO);
    let planes = [(exactly('l'), one('o')), (exactly('k'), one('o'))];
    let parts = signs::two_planes(exactly('n'), planes, [one('a'), one('b')], one('s'));
    let only_left = [('b', RBig::ZERO), ('z', RBig::ONE + units(8.0))];
    let of_rest = length(&parts.rest.each_ref().map(|x| x.error()), &only_left);
    let settled = signs::TwoPlanes {
        norm: one('z'),
        weights: one('w'),
        ..parts
    };
    let bound = signs::two_planes_bound(&settled, 0.0, one('x'));
    let of = |letters: &[char]| {
        let has_all = |m: &[Symbol]| letters.iter().all(|c| m.iter().any(|s| s.letter == *c));
        let terms = bound.error().terms().filter(|(m, _)| has_all(m));
        terms.map(|(_, c)| c.clone()).max().expect("an error of these letters")
    };
    let second_order = units(200.0) * unit();
    let error = of_rest + of(&['z', 'x']) + of(&['s', 'o']) + second_order;
    Bound::whole("EDGE_BOUND", "pair::star::two_planes_bound", error)
}

/// An edge turned by a matrix, times a stored normal.
fn exact_filter() -> Bound {
    let edge = rotation() + product() + unit();
    let height = dot(exactly('n'), exactly('v'));
    let error = edge + length(&[height.error()], &[]) + normal_error();
    Bound::whole("EXACT_FILTER", "depth::exhaustive::may_be_perpendicular", error)
}

/// Relative to the turned edge: the edge, its product with the normal, which errs by as much as it is off, the cross
/// product, once more if it is made perpendicular, and the dot.
fn flank_on_a() -> Bound {
    let w = cross_product() + units(4.0);
    let along = length(&[dot(exactly('n'), exactly('v')).error()], &[]);
    let error = RBig::from(2) * unit() + w + along + normal_error();
    Bound::whole("FLANK", "pair::star::falls_into_both_faces", error).part("on A", 13.0)
}

/// A matrix that is off by `rotation` turns a cross product into that of the turned vectors within three times as much,
/// and keeps a right angle within twice.
fn flank_on_b() -> Bound {
    let edges = RBig::from(2) * (product() + unit());
    let along = length(&[dot(exactly('n'), exactly('v')).error()], &[]);
    let second_order = units(1.0);
    let error = RBig::from(5) * rotation() + edges + cross_product() + units(4.0) + along + normal_error();
    Bound::whole("FLANK", "pair::star::falls_into_both_faces", error + second_order).case("on B")
}

/// A cross product of vectors of length one.
fn cross_product() -> RBig {
    let c = named('c', cross(exactly('u'), exactly('v')));
    length(&c.each_ref().map(|x| x.error()), &[])
}

/// Two slants `(g . u)^2 / u^2` and their difference, for `|g| <= 3/4`; a coordinate of u has two roundings.
fn slant() -> Bound {
    let g = RBig::from_parts(3.into(), 4u8.into());
    let two = (RBig::ONE + once()).pow(2) - RBig::ONE;
    let height = dot(exactly('g'), held('u', &two));
    let off = length(&[height.error()], &[('g', g.clone())]);
    let square = &g * &g;
    let coordinate = || Factor::off(&two).squared();
    let norm = coordinate() + coordinate() + coordinate();
    // What is relative to the slant: the square's own rounding, the norm and the quotient.
    let relative = (Factor::off(&once()) / norm).error();
    let above = RBig::from(2) * &g * &off + &off * &off;
    let one = above * (RBig::ONE + &relative) + &square * relative;
    let error = RBig::from(2) * one + square * once();
    Bound::whole("SLANT", "polyhedron::flat", error)
}
