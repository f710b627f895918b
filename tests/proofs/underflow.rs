//! What underflow takes, and what leaves the range: the cases of `tolerance`, and its table of degrees.

use lab::proofs::kernels::{patches, poses, signs};
use lab::proofs::majorant::{Majorant, power, unit};
use lab::proofs::number::{Number, Vector, dot};
use lab::proofs::{Polynomial, Reach};
use lab::rational::{RBig, exact};
use lab::rng::Rng;
use lin_canny::proofs;

/// Stored radii and translations, and edges of stored bodies.
const LEAST_LENGTH: i64 = -105;
const LONGEST_EDGE: i64 = 107;

/// Stored coordinates are multiples of this power of two.
const GRID: i64 = -357;

/// Half of the least number, which a product may lose.
fn half_least() -> RBig {
    power(-1075)
}

fn exactly<const K: usize>(letter: char) -> [Majorant; K] {
    Majorant::vector(letter, &RBig::ZERO)
}

fn constant(name: &str) -> RBig {
    let all = proofs::constants();
    exact(all.iter().find(|(n, _)| *n == name).expect("a constant").1)
}

/// Fails unless what a kernel loses is at most `slack` UNIT of `L^degree` for all L from `2^-105` on, if no input is
/// longer than L. What is lost grows more slowly with L, so the least L decides.
fn is_lost_in_room(what: &str, lost: &Polynomial, degree: usize, slack: f64) {
    assert!(
        lost.degree() < degree,
        "{what}: what is lost grows as fast as the bound"
    );
    let length = power(LEAST_LENGTH);
    let most = lost.at(|_| length.clone()) * half_least();
    let room = exact(slack) * unit() * (0..degree).fold(RBig::ONE, |x, _| x * &length);
    assert!(!lost.is_zero() && most <= room, "{what}");
}

/// Case S.
#[test]
fn stored_lengths_leave_room() {
    let [a, b, c]: [Vector<Majorant>; 3] = ['a', 'b', 'c'].map(exactly);
    is_lost_in_room("VOLUME", signs::volume([a, b, c]).lost(), 3, 512.0 - 392.0);
    // Directions of length one: a coordinate of theirs counts as a number, not as a length.
    let along = |lost: &Polynomial| lost.with('n', |_| Polynomial::constant(RBig::ONE));
    let n = exactly('n');
    is_lost_in_room("HEIGHT", &along(signs::height_over(n, a, b).lost()), 1, 0.5);
    is_lost_in_room("CELL", &along(dot(n, a).lost()), 1, 5.0);
    is_lost_in_room("ORIENTATION", signs::pyramid_side([a, b, c]).1.lost(), 3, 16.0 - 4.2);
    let rotation: [Vector<Majorant>; 3] = ['n', 'n', 'n'].map(exactly);
    for x in poses::product(rotation, a) {
        is_lost_in_room("CERTIFICATE, product", &along(x.lost()), 1, 1.0);
    }
}

/// Case S: the side of a face over an edge, which is as short as the grid allows, and a length.
#[test]
fn sides_of_faces_leave_room() {
    let (n, edge, to) = (exactly('n'), exactly('e'), exactly('t'));
    let side = signs::over_side(n, edge, to);
    let lost = side
        .lost()
        .at(|letter| power(if letter == 'n' { 0 } else { LONGEST_EDGE }));
    assert!(!side.lost().is_zero() && lost * half_least() < unit() * power(GRID + LEAST_LENGTH));
}

/// Case S: points and heights of patches and curved shapes, of weights down to `2^-40`, in pairs from `NEAR` on. All
/// factors of a product that loses are at most one (directions, parameters, weights), so nothing that is lost grows.
#[test]
fn patches_leave_room() {
    let number = |c| Majorant::input(c, 0, &RBig::ZERO);
    let height = patches::coefficient(exactly('n'), exactly('p'), number('c'), number('w'));
    let net: Vec<_> = (0..64).map(|k| Majorant::input('p', k, &RBig::ZERO)).collect();
    let [s, t] = ['s', 't'].map(number);
    let point = patches::value(&net, [7, 7], [[s, t]; 2]);
    for lost in [height.lost(), point.lost()] {
        let most = lost.at(|_| RBig::ONE) * half_least();
        assert!(!lost.is_zero() && most < unit() * power(-300 - 40 - 200));
    }
}

/// Case U: a bound in the caller's unit is no better than the one in the stored unit, whatever the unit.
#[test]
fn bounds_leave_the_stored_unit_outward() {
    let mut rng = Rng::new(9);
    let mut rounded = 0;
    for _ in 0..100_000 {
        let x = f64::from_bits(rng.bits());
        let exponent = rng.int(-1000, 1000);
        let at_the_end = rng.chance(0.5);
        // Products about the least number: one that is rounded up has to be lowered.
        let size = if at_the_end {
            -1074 - exponent + rng.int(-2, 54)
        } else {
            rng.int(-900, 900)
        };
        if !x.is_finite() || !(-1022..1023).contains(&size) {
            continue;
        }
        let x = f64::from_bits((x.to_bits() & !(0x7ff << 52)) | ((size + 1023) as u64) << 52);
        let (y, truth) = (
            proofs::scaled_down(x, 2f64.powi(exponent as i32)),
            exact(x) * power(exponent),
        );
        if y == f64::NEG_INFINITY {
            continue;
        }
        assert!(exact(y) <= truth, "{x:e} times 2^{exponent}");
        rounded += usize::from(exact(y) != truth);
    }
    assert!(rounded > 10_000, "only {rounded} were rounded");
}

/// Case P: coordinates of unit quaternions; translations in the caller's unit, at most `2^420` stored ones.
#[test]
fn poses_leave_room() {
    let (p, q) = (exactly::<4>('p'), exactly::<4>('q'));
    let one = |_| RBig::ONE;
    let rotation = poses::quotient(p, q)
        .into_iter()
        .chain(poses::matrix(q, Majorant::exact(2.0)).concat());
    for x in rotation {
        assert!(!x.lost().is_zero() && x.lost().at(one) * half_least() < power(-1000));
    }
    for x in poses::rotated_to_a(q, exactly('o'), Majorant::exact(2.0)) {
        assert!(x.lost().terms().all(|(m, _)| m.iter().all(|s| s.letter != 'o')));
        assert!(x.lost().at(one) * half_least() * power(420) < unit() * power(LEAST_LENGTH));
    }
}

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

/// Case G: three squares of any numbers, before the root.
#[test]
fn the_least_square_covers_three() {
    let squares = dot(exactly('a'), exactly('a'));
    assert!(squares.lost().degree() == 0);
    assert!(squares.lost().at(|_| RBig::ONE) * half_least() < constant("LEAST_SQUARE") * power(-80));
}

/// Differences of stored coordinates lose nothing in products of three.
#[test]
fn products_of_stored_edges_do_not_underflow() {
    let [u, w, d] = [0; 3].map(|_| Reach::vector(&power(LONGEST_EDGE), GRID));
    let height = signs::side([u, w, d]);
    assert!(height.finest() == 3 * GRID && height.finest() >= -1074);
}

/// The table of degrees: the largest number on the way, as an exponent, and what the table says.
#[test]
fn nothing_leaves_the_range() {
    let of = |exponent| Reach::vector::<3>(&power(exponent), 0);
    let (edge, far) = (of(LONGEST_EDGE), of(301));
    // An axis is a sum of products of two lengths.
    let axis = of(2 * LONGEST_EDGE + 2);
    let rows = [
        ("EDGE_SIGN", signs::rise(far, edge).0, 409),
        ("STEEPER", signs::slopes([far, axis], [edge, edge]).0, 740),
        ("STEEPER, scaled", signs::slopes([of(400), axis], [edge, edge]).0, 840),
        ("VOLUME", signs::volume([far, far, far]), 903),
        ("SIDE_ERROR", signs::side([edge, edge, edge]), 324),
        ("heights, squared", dot(far, far), 602),
    ];
    for (what, value, exponent) in rows {
        // A sum of up to six terms is less than 2^3 of the largest product.
        assert!(*value.highest() < power(exponent + 3), "{what}");
        assert!(*value.highest() > power(exponent - 12), "{what}: the table is far off");
        assert!(*value.highest() < power(1023), "{what}");
    }
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
        assert_eq!(proofs::edge_sign(n, [0.0, y, z]), 0, "{n:?} {y} {z}");
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
        if let Some(sign) = proofs::steeper(n, m, e, f) {
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
