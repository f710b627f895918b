//! The transcriptions against the crate, bit for bit.

use super::inputs::Inputs;
use lin_canny::__proofs as library;
use proofs::kernels::signs::TwoPlanes;
use proofs::kernels::{double, patches, paths, places, poses, signs};
use proofs::number::{self, Vector, sub};

/// Tries of a kernel.
const TRIES: u64 = 100_000;

/// Equal bits; zeros of either sign, and numbers that are none, are alike.
fn same(a: f64, b: f64) -> bool {
    a == b || a.is_nan() && b.is_nan()
}

/// Compares a kernel with its transcription on the inputs that `run` draws.
pub(crate) fn agree(name: &str, run: impl Fn(&mut Inputs) -> [Vec<f64>; 2]) {
    let mut finite = 0;
    for k in 0..TRIES {
        let [of_crate, ours] = run(&mut Inputs::new(0x9e37, k));
        let equal = of_crate.len() == ours.len() && of_crate.iter().zip(&ours).all(|(a, b)| same(*a, *b));
        assert!(
            equal,
            "{name}, try {k}: {of_crate:?} by the crate, {ours:?} transcribed"
        );
        finite += u64::from(ours.iter().all(|x| x.is_finite()));
    }
    assert!(finite > TRIES / 2, "{name}: only {finite} results are finite");
}

fn constant(name: &str) -> f64 {
    let unit = f64::EPSILON / 2.0;
    let all = library::constants();
    all.iter().find(|(n, _)| *n == name).expect("a constant").1 * unit
}

fn least_rise() -> f64 {
    constant("LEAST_RISE") / (f64::EPSILON / 2.0)
}

#[test]
fn rises() {
    let (error, least) = (constant("EDGE_SIGN"), least_rise());
    agree("rise", |inputs| {
        let (n, e) = (inputs.numbers(), inputs.numbers());
        let (value, bound) = library::rise(n, e);
        let (ours, size) = signs::rise(n, e);
        let limit = error * size + least;
        let sign = f64::from(i32::from(ours > limit) - i32::from(ours < -limit));
        [
            vec![value, bound, f64::from(library::edge_sign(n, e))],
            vec![ours, limit, sign],
        ]
    });
}

#[test]
fn slopes() {
    let (error, least) = (constant("STEEPER"), least_rise());
    agree("slopes", |inputs| {
        let [n, m, e, f]: [Vector<f64>; 4] = [0; 4].map(|_| inputs.numbers());
        let (value, bound) = library::slopes(n, m, e, f);
        let (ours, size) = signs::slopes([n, m], [e, f]);
        let [s_ne, s_mf, s_nf, s_me] = [(n, e), (m, f), (n, f), (m, e)].map(|(a, b)| signs::rise(a, b).1);
        let limit = error * size + least * (1.0 + s_ne + s_mf + s_nf + s_me);
        [vec![value, bound], vec![ours, limit]]
    });
}

#[test]
fn sides_of_triangles() {
    let error = constant("SIDE_ERROR");
    agree("side", |inputs| {
        let [u, w, base, p]: [Vector<f64>; 4] = [0; 4].map(|_| inputs.numbers());
        let sides = sub(p, base).map(f64::abs);
        [
            vec![library::side_height(u, w, base, p), library::guard(u, w, sides)],
            vec![signs::side([u, w, sub(p, base)]), signs::guard([u, w, sides], error)],
        ]
    });
}

#[test]
fn volumes() {
    agree("volume", |inputs| {
        let [a, b, c]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        [vec![library::volume(a, b, c)], vec![signs::volume([a, b, c])]]
    });
}

#[test]
fn weights_of_triangles() {
    agree("triangle", |inputs| {
        let [p, q, r]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        let Some((weights, direction, squared)) = library::triangle([p, q, r]) else {
            return [vec![0.0], vec![0.0]];
        };
        let n = signs::normal([sub(q, p), sub(r, p)]);
        let weight = |x, y| signs::weight(n, sub(y, x), x);
        let [a, b, c] = [weight(q, r), weight(r, p), weight(p, q)];
        let (sum, height) = (a + b + c, number::dot(n, p));
        let of_crate = [&weights[..], &direction, &[squared]].concat();
        let n = if height < 0.0 { n.map(|x| -x) } else { n };
        let square = height * height / number::dot(n, n);
        [of_crate, vec![a / sum, b / sum, c / sum, n[0], n[1], n[2], square]]
    });
}

#[test]
fn sides_of_pyramids() {
    agree("pyramid", |inputs| {
        let [from, to, apex]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        let (n, height) = signs::pyramid_side([from, to, apex]);
        let square = |v: Vector<f64>| number::dot(v, v);
        let squares = square(sub(from, to)) + square(sub(apex, to));
        [
            library::pyramid_side(from, to, apex).to_vec(),
            [&n[..], &[height, squares]].concat(),
        ]
    });
}

#[test]
fn sides_of_faces_and_heights() {
    agree("over_side", |inputs| {
        let [n, edge, to]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        [
            vec![library::over_side(n, edge, to), library::over_middle(n, edge, to)],
            vec![signs::over_side(n, edge, to), signs::height_over(n, edge, to)],
        ]
    });
}

#[test]
fn bounds_by_two_planes() {
    let error = constant("EDGE_BOUND");
    agree("two_planes", |inputs| {
        let [n, left, right]: [Vector<f64>; 3] = [0; 3].map(|_| inputs.numbers());
        let [alpha, beta, o, p, radius]: [f64; 5] = inputs.numbers();
        let (weights, radius) = ([alpha.abs(), beta.abs()], radius.abs());
        let planes = [(left, o), (right, p)];
        let TwoPlanes { combined, .. } = signs::two_planes(n, planes, weights, 0.0);
        let scale = number::dot(n, n) / number::dot(combined, n);
        let bound = signs::two_planes_bound(&signs::two_planes(n, planes, weights, scale), error, radius);
        let ours = if scale >= 0.0 { bound } else { f64::INFINITY };
        // Of weights that prove nothing there is no bound to compare.
        let of_crate = library::two_planes_bound(n, planes, weights, radius);
        if of_crate == f64::INFINITY && ours == f64::INFINITY {
            return [vec![0.0], vec![0.0]];
        }
        [vec![of_crate], vec![ours]]
    });
}

#[test]
fn relative_poses() {
    agree("relative pose", |inputs| {
        let (qa, qb) = (inputs.quaternion(), inputs.quaternion());
        let (ta, tb): (Vector<f64>, Vector<f64>) = (inputs.numbers(), inputs.numbers());
        let Some((rows, shift)) = library::relative_pose([qa, qb], [ta, tb]) else {
            return [vec![0.0], vec![0.0]];
        };
        let (na, nb) = (poses::squared_norm(qa), poses::squared_norm(qb));
        let matrix = poses::matrix(poses::quotient(qa, qb), poses::rotation_factor(na, nb));
        let translation = poses::rotated_to_a(qa, sub(tb, ta), poses::translation_factor(na));
        [
            [rows.concat(), shift.to_vec()].concat(),
            [matrix.concat(), translation.to_vec()].concat(),
        ]
    });
}

#[test]
fn matrices_and_turns() {
    agree("matrix", |inputs| {
        let (q, v, s): ([f64; 4], Vector<f64>, f64) = (inputs.numbers(), inputs.numbers(), inputs.number());
        let rows = [0; 3].map(|_| inputs.numbers());
        [
            [
                library::rotation_matrix(q, s).concat(),
                library::product(rows, v).to_vec(),
                library::turned(q, v).to_vec(),
            ]
            .concat(),
            [
                poses::matrix(q, s).concat(),
                poses::product(rows, v).to_vec(),
                poses::turned(q, v).to_vec(),
            ]
            .concat(),
        ]
    });
}

#[test]
fn cuts_of_cubics() {
    agree("rest", |inputs| {
        let (c, x): ([f64; 4], f64) = (inputs.numbers(), inputs.between(0.0, 1.0));
        [library::rest(c, x).to_vec(), places::rest(c, x, 1.0 - x).to_vec()]
    });
}

#[test]
fn points_of_patches() {
    agree("patch", |inputs| {
        let degrees = [1 + inputs.below(7), 1 + inputs.below(7)];
        let net: Vec<f64> = (0..(degrees[0] + 1) * (degrees[1] + 1))
            .map(|_| inputs.number())
            .collect();
        let at = [inputs.between(0.0, 1.0), inputs.between(0.0, 1.0)];
        let ours = patches::value(&net, degrees, at.map(|t| [1.0 - t, t]));
        [vec![library::patch_value(&net, degrees, at)], vec![ours]]
    });
}

#[test]
fn blossoms_and_degrees() {
    agree("blossom", |inputs| {
        let degree = 1 + inputs.below(6);
        let points: Vec<[f64; 4]> = (0..=degree).map(|_| inputs.numbers()).collect();
        let mut knots: Vec<f64> = (0..2 * degree + 2).map(|_| inputs.between(0.0, 1.0)).collect();
        knots.sort_by(f64::total_cmp);
        let (ends, upper) = ([knots[degree], knots[degree + 1]], inputs.below(degree + 1));
        let factors = |level: usize, i: usize| {
            let t = ends[usize::from(level <= upper)];
            let (low, high) = (knots[i], knots[degree + 1 + i - level]);
            [(high - t) / (high - low), (t - low) / (high - low)]
        };
        let raised = |j: usize| {
            [
                (degree + 1 - j) as f64 / (degree + 1) as f64,
                j as f64 / (degree + 1) as f64,
            ]
        };
        let along = |k: usize| points.iter().map(|p| p[k]).collect::<Vec<f64>>();
        let blossom = [0, 1, 2, 3].map(|k| patches::blossom(along(k), factors));
        let rows = [0, 1, 2, 3].map(|k| patches::raise(along(k), raised));
        let rows: Vec<[f64; 4]> = (0..degree + 2).map(|i| [0, 1, 2, 3].map(|k| rows[k][i])).collect();
        [
            [
                library::blossom(&points, &knots, degree, ends, upper).to_vec(),
                library::raise(&points).concat(),
            ]
            .concat(),
            [blossom.to_vec(), rows.concat()].concat(),
        ]
    });
}

#[test]
fn numbers_of_twice_the_precision() {
    agree("double", |inputs| {
        let mut pair = || {
            let (high, low) = (inputs.number(), inputs.number());
            let (high, low) = proofs::traced::two_sum(high, high * low * f64::EPSILON);
            [high, low]
        };
        let (a, b) = (pair(), pair());
        let quotient = a[0] / b[0];
        let quotients = if quotient == 0.0 || !quotient.is_finite() {
            [quotient, 0.0]
        } else {
            double::div(a, b)
        };
        [
            [
                library::double_sum(a, b),
                library::double_product(a, b),
                library::double_quotient(a, b),
            ]
            .concat(),
            [double::add(a, b), double::mul(a, b), quotients].concat(),
        ]
    });
}

#[test]
fn vertices_on_straight_paths() {
    agree("paths", |inputs| {
        let [a, b, c, d, e, f, n]: [Vector<f64>; 7] = [0; 7].map(|_| inputs.numbers());
        let time = inputs.between(0.0, 1.0);
        let at = [[a, b, c], [d, e, f]];
        let place = std::array::from_fn(|k| paths::place([a[k], b[k]], [1.0 - time, time]));
        let ours = [
            paths::volume([a, b, c]),
            paths::thrice(d) / 3.0,
            paths::end(at[0], n),
            paths::middle(at, n),
            paths::end(at[1], n),
            paths::gap(n, [a, b]),
        ];
        let of_crate = [library::path_volume(a, b, c), library::third(d)];
        let join = |place: Vector<f64>, first: &[f64], rest: &[f64]| [&place[..], first, rest].concat();
        [
            join(library::place([a, b], time), &of_crate, &library::path_areas(at, n)),
            join(place, &ours[..2], &ours[2..]),
        ]
    });
}
