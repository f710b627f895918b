//! What leaves the range: the table of degrees of `tolerance`, and the scale at which a product may leave f64.

use super::underflow::LONGEST_EDGE;
use lin_canny::__proofs as library;
use proofs::Reach;
use proofs::kernels::planes;
use proofs::kernels::{patches, paths, signs};
use proofs::majorant::power;
use proofs::number::{Vector, cross, dot};
use proofs::vectors::Coordinates;
use truth::rational::exact;

/// The exponent of a limit of the crate, or of its inverse: how many powers of two it is from one.
fn exponent(name: &str) -> i64 {
    let all = library::limits();
    let (_, limit) = all.iter().find(|(n, _)| *n == name).expect("a limit");
    let exponent = (limit.to_bits() >> 52) as i64 - 1023;
    assert_eq!(power(exponent), exact(*limit), "{name} is a power of two");
    exponent.abs()
}

fn of(exponent: i64) -> Vector<Reach> {
    Reach::vector(&power(exponent), 0)
}

fn number(exponent: i64) -> Reach {
    of(exponent)[0]
}

/// A kernel, what is largest in it, and the exponent that the table tells: a sum of up to six terms is less than 2^3 of
/// its largest product.
fn rows() -> Vec<(&'static str, Reach, i64)> {
    let (edge, far) = (of(LONGEST_EDGE), of(exponent("FAR") + 1));
    let (patch_max, pair) = (exponent("PATCH_MAX"), exponent("SMALL_PAIR"));
    // Of a difference of bodies, an edge is that of one of them or a difference of two.
    let edges = of(LONGEST_EDGE + 1);
    // An axis is a sum of products of two lengths.
    let axis = of(2 * LONGEST_EDGE + 2);
    let normal = signs::normal([edges, edges]);
    let square = |n, p| dot(n, p) * dot(n, p);
    // Of differences of points of two bodies.
    let curved = signs::normal([of(pair + 1), of(pair + 1)]);
    let (_, side) = signs::pyramid_side([edge, edge, edge]);
    let patch = || vec![number(patch_max); 64];
    let t = [[number(0); 2]; 2];
    // A derivative of a patch of degrees seven and seven, over weights down to 2^-40.
    let slope = of(patch_max + 47);
    let of_balls = Reach::vector::<3>(&power(2), 0);
    let [.., root] = planes::approach::<Coordinates<Reach>>(of_balls, of_balls, of_balls[0], number(-40));
    // Straight paths: coordinates below one, directions up to the inverse of `PATH_DIRECTION`.
    let (place, n) = (of(0), of(exponent("PATH_DIRECTION")));
    let triangle = [place, place, place];
    vec![
        ("EDGE_SIGN", signs::rise(far, edge).0, 409),
        ("STEEPER", signs::slopes([far, axis], [edge, edge]).0, 740),
        ("STEEPER, scaled", signs::slopes([of(400), axis], [edge, edge]).0, 840),
        ("VOLUME", signs::volume([far, far, far]), 903),
        ("weights of a triangle", signs::weight(normal, edges, far), 630),
        ("squares over a triangle", square(normal, of(160)), 756),
        ("squares over a triangle, curved", square(curved, of(pair + 2)), 852),
        ("ORIENTATION", side, 324),
        ("ORIENTATION, squared", side * side, 650),
        ("SIDE_ERROR", signs::side([edge, edge, edge]), 324),
        ("heights, squared", dot(far, far), 602),
        ("BALLS", root, 10),
        ("PATCH_POINT", patches::value(&patch(), [7, 7], t), 214),
        (
            "normals of patches, squared",
            dot(cross(slope, slope), cross(slope, slope)),
            992,
        ),
        ("PATCH_SLOPE", dot(slope, cross(slope, slope)), 744),
        ("PATH_GAP", paths::gap(n, [place, place]), 202),
        ("PATH_VOLUME", paths::volume(triangle), 2),
        ("PATH_AREA", paths::middle([triangle, triangle], n), 204),
    ]
}

/// The square of a height over a triangle, of degree six, leaves the range where the lengths of a curved pair are beyond
/// `2^168`, and where bodies of the greatest stored size are as far apart as `FAR` allows.
#[test]
fn squares_of_heights_leave_the_range_at_a_scale() {
    let square = |edge: i64, between: i64| {
        let n = signs::normal([of(edge + 1), of(edge + 1)]);
        let height = dot(n, of(between));
        height * height
    };
    let is_left = |x: Reach| *x.highest() >= power(1023);
    assert!(!is_left(square(166, 168)) && is_left(square(172, 174)));
    assert!(!is_left(square(LONGEST_EDGE, 288)) && is_left(square(LONGEST_EDGE, 300)));
}

#[test]
fn nothing_leaves_the_range() {
    for (what, value, exponent) in rows() {
        let highest = value.highest();
        assert!(*highest < power(exponent + 3), "{what}");
        assert!(*highest > power(exponent - 12), "{what}: the table is far off");
        assert!(*highest < power(1023), "{what}");
    }
}
