//! What underflow takes from signs along directions: case D of `tolerance`.

use super::underflow::{LONGEST_EDGE, constant, exactly, half_least};
use lin_canny::__proofs as library;
use proofs::Polynomial;
use proofs::kernels::signs;
use proofs::majorant::{Majorant, power, unit};
use proofs::number::Vector;
use truth::rational::{RBig, exact};
use truth::rng::Rng;

/// An exact direction of size one that was rounded: off by `2^-900` of its largest coordinate, here `d`, beside the
/// roundings.
fn dropped(letter: char) -> Vector<Majorant> {
    [0, 1, 2].map(|k| {
        let value = Polynomial::variable(letter, k);
        let error = value.scaled(&unit()).plus(&Polynomial::variable('d', k));
        Majorant::with_error(53, value, error)
    })
}

/// The part of an error by what a direction lost, and the rest.
fn split(error: &Polynomial) -> [Polynomial; 2] {
    [true, false].map(|of_dropped| {
        let terms = error
            .terms()
            .filter(|(m, _)| m.iter().any(|s| s.letter == 'd') == of_dropped);
        terms.fold(Polynomial::default(), |p, (m, c)| {
            p.plus(&Polynomial::term(m.clone(), c.clone()))
        })
    })
}

/// What a direction lost, along the longest edges.
fn largest_dropped(part: &Polynomial) -> RBig {
    part.at(|letter| power(if letter == 'd' { -900 } else { LONGEST_EDGE }))
}

/// Case D: one rise.
#[test]
fn the_least_rise_covers_directions() {
    let (value, size) = signs::rise(dropped('n'), exactly('e'));
    let [of_dropped, _] = split(value.error());
    let off = largest_dropped(&of_dropped);
    let lost = (value.lost().at(|_| RBig::ONE) + size.lost().at(|_| RBig::ONE)) * half_least();
    assert!(!of_dropped.is_zero() && off + lost < constant("LEAST_RISE"));
}

/// Case D: two rises. Each term that is lost or dropped stands beside a product that the guard holds too.
#[test]
fn the_least_rise_covers_slopes() {
    let (value, _) = signs::slopes([dropped('n'), exactly('m')], [exactly('e'), exactly('f')]);
    let [of_dropped, _] = split(value.error());
    assert!(!of_dropped.is_zero());
    // What was dropped is multiplied by an edge: both are replaced by the largest they may be.
    let off = of_dropped.terms().fold(Polynomial::default(), |sum, (m, c)| {
        let d = m.iter().find(|s| s.letter == 'd').expect("a part of what was dropped");
        let axis = m.iter().find(|s| s.letter == 'm').expect("a coordinate of the axis");
        let edge = |letter| m.iter().any(|s| s.letter == letter && s.index == d.index);
        let other = |letter| m.iter().any(|s| s.letter == letter && s.index == axis.index);
        let kept = if edge('e') && other('f') { 'f' } else { 'e' };
        assert!(other(kept), "an edge along the axis");
        let product = Polynomial::variable('m', axis.index).times(&Polynomial::variable(kept, axis.index));
        sum.plus(&product.scaled(&(c * power(LONGEST_EDGE - 900))))
    });
    let sums = [('n', 'e'), ('m', 'f'), ('n', 'f'), ('m', 'e')].iter().fold(
        Polynomial::constant(RBig::ONE),
        |sum, &(a, b)| {
            (0..3).fold(sum, |s, k| {
                s.plus(&Polynomial::variable(a, k).times(&Polynomial::variable(b, k)))
            })
        },
    );
    let guard = sums.scaled(&constant("LEAST_RISE"));
    let [beside_dropped, lost] = split(value.lost());
    let beside_dropped = largest_dropped(&beside_dropped);
    let lost = lost.plus(&Polynomial::constant(beside_dropped)).scaled(&half_least());
    let all = off.plus(&lost);
    let share = all.over(&guard).expect("every term stands in the guard");
    assert!(
        share < exact(0.5),
        "half is left for the rounding of the guard: {share}"
    );
}

fn sign_of(x: &RBig) -> i32 {
    i32::from(*x > RBig::ZERO) - i32::from(*x < RBig::ZERO)
}

fn exact_rise(n: Vector<f64>, e: Vector<f64>) -> RBig {
    (0..3).fold(RBig::ZERO, |s, k| s + exact(n[k]) * exact(e[k]))
}

/// A direction between two numbers, rounded to the wrong side, along an edge at right angles to its largest
/// coordinate: both remaining products are below the least number.
#[test]
fn no_sign_is_certain_of_products_that_underflow() {
    let mut rng = Rng::new(1);
    for _ in 0..2000 {
        let [y, z] = [0; 2].map(|_| rng.range(1.0, 2.0) * 2f64.powi(-180));
        let half = (2 * rng.int(1, 50) + 1) as f64 * 2f64.powi(-537);
        let (ny, nz) = (half / y * 2f64.powi(-538), half / z * 2f64.powi(-538));
        let n = [0.5, ny.next_up(), -nz.next_down()];
        assert_eq!(library::edge_sign(n, [0.0, y, z]), 0, "{n:?} {y} {z}");
    }
}

/// Edges of one fan of very different lengths, at right angles to the largest coordinate of a direction.
#[test]
fn a_certain_slope_is_right_in_underflow() {
    let mut rng = Rng::new(3);
    let mut certain = 0;
    for _ in 0..20_000 {
        let (up, low) = (rng.int(-40, 100), rng.int(0, 120));
        let m: Vector<f64> = [0; 3].map(|_| whole(&mut rng, 20) * 2f64.powi(-20));
        let [e, f]: [Vector<f64>; 2] = [up - low, up].map(|exponent| {
            let scale = 2f64.powi(exponent as i32 - 30);
            [0.0, whole(&mut rng, 30) * scale, whole(&mut rng, 30) * scale]
        });
        let [y, z] = [0; 2].map(|_| whole(&mut rng, 6) * 2f64.powi(-490) * 2f64.powi(-490 - rng.below(95) as i32));
        let n = [1.0, y, z];
        let truth = exact_rise(n, e) * exact_rise(m, f) - exact_rise(n, f) * exact_rise(m, e);
        if let Some(sign) = library::steeper(n, m, e, f) {
            assert_eq!(sign, sign_of(&truth), "{n:?} {m:?} {e:?} {f:?}");
            certain += 1;
        }
    }
    assert!(certain < 20_000, "some are not certain");
}

/// A whole number of so many bits, of either sign.
fn whole(rng: &mut Rng, bits: i32) -> f64 {
    rng.int(-(1 << bits), 1 << bits) as f64
}
