//! What underflow takes: the cases of `tolerance`.

use lin_canny::__proofs as library;
use proofs::bounds::{self, Bound};
use proofs::kernels::certificate::{self, Placing};
use proofs::kernels::{curved, patches, paths, poses, signs};
use proofs::majorant::{Majorant, power, unit};
use proofs::number::{Number, Vector, dot};
use proofs::vectors::Coordinates;
use proofs::{Polynomial, Reach};
use std::sync::LazyLock;
use truth::rational::{RBig, exact};
use truth::rng::Rng;

type Errors = Coordinates<Majorant>;

/// Stored radii and translations, and edges of stored bodies.
pub(crate) const LEAST_LENGTH: i64 = -105;
pub(crate) const LONGEST_EDGE: i64 = 107;

/// Stored coordinates are multiples of this power of two.
pub(crate) const GRID: i64 = -357;

/// Half of the least number, which a product may lose.
pub(crate) fn half_least() -> RBig {
    power(-1075)
}

pub(crate) fn exactly<const K: usize>(letter: char) -> [Majorant; K] {
    Majorant::vector(letter, &RBig::ZERO)
}

fn constant_of(name: &str) -> f64 {
    let all = library::constants();
    all.iter().find(|(n, _)| *n == name).expect("a constant").1
}

pub(crate) fn constant(name: &str) -> RBig {
    exact(constant_of(name))
}

/// What the constant leaves beside the greatest error that is proved for it, in UNIT.
fn room(constant: &str) -> f64 {
    static PROVED: LazyLock<Vec<Bound>> = LazyLock::new(bounds::all);
    let of_constant = PROVED.iter().filter(|b| b.constant == constant);
    let most = of_constant.map(|b| b.proved.to_f64().value()).fold(0.0, f64::max);
    assert!(most > 0.0, "{constant} is not proved");
    constant_of(constant) - most
}

/// Fails unless what a kernel loses is at most `slack` UNIT of `L^degree` for all L from `2^-105` on, if no input is
/// longer than L. What is lost grows no faster with L than the bound, so the least L decides.
fn is_lost_in_room(what: &str, lost: &Polynomial, degree: usize, slack: f64) {
    assert!(
        lost.degree() <= degree,
        "{what}: what is lost grows faster than the bound"
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
    is_lost_in_room("VOLUME", signs::volume([a, b, c]).lost(), 3, room("VOLUME"));
    // Directions of length one: a coordinate of theirs counts as a number, not as a length.
    let along = |lost: &Polynomial| lost.with('n', |_| Polynomial::constant(RBig::ONE));
    let n = exactly('n');
    is_lost_in_room("HEIGHT", &along(signs::height_over(n, a, b).lost()), 1, room("HEIGHT"));
    is_lost_in_room("CELL", &along(dot(n, a).lost()), 1, room("CELL"));
    is_lost_in_room(
        "ORIENTATION",
        signs::pyramid_side([a, b, c]).1.lost(),
        3,
        room("ORIENTATION"),
    );
    let rotation: [Vector<Majorant>; 3] = ['n', 'n', 'n'].map(exactly);
    for x in poses::product(rotation, a) {
        is_lost_in_room("CERTIFICATE, product", &along(x.lost()), 1, room("CERTIFICATE"));
    }
}

/// Case S: both bounds of the certificate. Rotations and directions count as numbers, as do weights and positions on
/// edges.
#[test]
fn certificates_leave_room() {
    let rotation: [Vector<Majorant>; 3] = ['n', 'n', 'n'].map(exactly);
    let placing = Placing::<Errors> {
        rotation,
        translation: exactly('t'),
    };
    let [p, q, r]: [Vector<Majorant>; 3] = ['p', 'q', 'r'].map(exactly);
    let (n, s) = (exactly('n'), Majorant::input('s', 0, &RBig::ZERO));
    let number = |lost: &Polynomial| {
        let one = |_| Polynomial::constant(RBig::ONE);
        lost.with('n', one).with('s', one)
    };
    let left = room("CERTIFICATE");
    let vector = |what: &str, v: Vector<Majorant>| {
        v.iter().for_each(|x| is_lost_in_room(what, &number(x.lost()), 1, left));
    };
    let scalar = |what: &str, x: Majorant| is_lost_in_room(what, &number(x.lost()), 1, left);
    let offset = Majorant::input('o', 0, &RBig::ZERO);
    vector("vertices", placing.between_vertices([p, q]));
    vector("a vertex in the other frame", placing.in_b(p));
    vector("a support", placing.difference([p, q]));
    scalar("supports", placing.support_distance(n, [p, q]));
    scalar("a plane", certificate::over_plane::<Errors>(n, placing.in_a(q), offset));
    scalar("a corner", certificate::over_corner::<Errors>(n, placing.in_a(q), p));
    vector("a foot", certificate::from_edge::<Errors>(placing.in_a(q), [p, r], s));
    let [edge, to] = certificate::along_edge::<Errors>(placing.in_a(q), [p, r]);
    vector("beside an edge", certificate::less::<Errors>(to, edge, s));
    let edges = placing.edges([p, r], [q, q]);
    vector("two edges", edges.between_witnesses(p, [s, s]));
    vector("a combination", certificate::combined::<Errors>(&[p, q, r], &[s, s, s]));
    let high = |v: Vector<Majorant>| dot(n, v);
    scalar("nets", certificate::between_nets::<Errors>(n, p, [high(q), high(r)]));
    let [total, _] = curved::mixed(&p, &[s, s, s]);
    scalar("a mixture", total);
}

/// Case S: the square of a length loses less than the square of UNIT L, so its root less than UNIT L; the weight of a
/// triangle, of degree four.
#[test]
fn roots_and_weights_leave_room() {
    let [a, b, c]: [Vector<Majorant>; 3] = ['a', 'b', 'c'].map(exactly);
    let square = dot(a, a).lost().at(|_| RBig::ONE) * half_least();
    let share = unit() * power(LEAST_LENGTH);
    assert!(square != RBig::ZERO && square < &share * &share);
    is_lost_in_room("a weight", signs::weight(signs::normal([a, b]), b, c).lost(), 4, 1.0);
}

/// Case S: the distance of a side of a pyramid as a quotient of squares. A side that counts is farther than
/// `2 CERTIFICATE UNIT L`, and so is the apex from the facet; as what is taken off is less than the height, the normal is
/// longer than `2^-49` of the square of that. Both squares are normal numbers then.
#[test]
fn squares_of_a_side_are_normal() {
    let least = exact(2.0 * constant_of("CERTIFICATE")) * unit() * power(LEAST_LENGTH);
    let normal = exact(constant_of("ORIENTATION")) * unit() * &least * &least;
    let low = &least * &normal;
    for square in [&normal * &normal, &low * &low] {
        assert!(square > power(-1022 + 8));
    }
}

fn size(x: RBig) -> RBig {
    if x < RBig::ZERO { -x } else { x }
}

/// Case S: numbers of twice the precision lose no more than a few of the least number, also where their low parts do not
/// fit.
#[test]
fn doubles_lose_little() {
    let mut rng = Rng::new(8);
    let (most, mut below) = (power(-1070), 0);
    for _ in 0..20_000 {
        let at = rng.int(-540, -420) as i32;
        let mut number = |size: i32| {
            let (high, low) = (rng.range(1.0, 2.0), rng.range(-1.0, 1.0));
            let scale = 2f64.powi(size);
            let (high, low) = proofs::traced::two_sum(high * scale, low * scale * 2f64.powi(-53));
            [high, low]
        };
        let (a, b) = (number(at), number(-1000 - at));
        let of = |d: [f64; 2]| exact(d[0]) + exact(d[1]);
        for (found, truth) in [
            (library::double_product(a, b), of(a) * of(b)),
            (library::double_product(a, a), of(a) * of(a)),
            (library::double_sum(a, b), of(a) + of(b)),
        ] {
            let off = size(of(found) - &truth);
            let relative = exact(10.0) * unit() * unit() * size(truth);
            assert!(off <= &relative + &most, "{a:?} {b:?}");
            below += usize::from(off > relative);
        }
    }
    assert!(below > 100, "only {below} lose more than their rounding");
}

/// Vertices on straight paths: coordinates are below one, directions longer than `PATH_DIRECTION`, and every factor of
/// what is lost is one of these or a share of time, at most one.
#[test]
fn straight_paths_leave_room() {
    let number = |c| Majorant::input(c, 0, &RBig::ZERO);
    let vector = |c| Majorant::vector::<3>(c, &RBig::ZERO);
    let place = paths::place([number('a'), number('b')], [number('s'), number('t')]);
    let [a, b, c, n] = ['a', 'b', 'c', 'n'].map(vector);
    // Directions are divided out: no product of theirs loses more than it does for one of length one.
    let along = [
        paths::gap(n, [a, b]),
        paths::end([a, b, c], n),
        paths::middle([[a, b, c], [c, a, b]], n),
    ];
    let whole = [place, paths::volume([a, b, c])];
    for (lost, room) in along.iter().map(|x| (x, 200)).chain(whole.iter().map(|x| (x, 0))) {
        let lost = lost.lost().at(|_| RBig::ONE) * half_least();
        assert!(lost != RBig::ZERO && lost < unit() * power(-room) * power(-100));
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
        let y = library::scaled_down(x, 2f64.powi(exponent as i32));
        let truth = exact(x) * power(exponent);
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
