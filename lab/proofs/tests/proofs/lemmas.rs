//! What an error of a quaternion does to its matrix, by identities of polynomials.
//!
//! Let `N(q)` be `|q|^2` times the rotation of `q`, and `M(q) = (1 - |q|^2) I + N(q)` the matrix that the code makes of
//! `q` with the factor two. For `q` of length one and `q' = (1 + e) q` the identities below say
//!
//! `M(q') - M(q) = 2 e_w (N(q) - I) + 2 [e_v] N(q) + N(e) N(q) - |e|^2 I`,
//!
//! with `[e_v]` the matrix of the cross product: at most `4 |e_w| + 2 |e_v| + 2 |e|^2`, and by Cauchy and Schwarz at most
//! `sqrt(20) |e|` and the second order.

use proofs::Polynomial;
use proofs::kernels::poses;
use truth::rational::{RBig, exact};

type Quaternion = [Polynomial; 4];
type Matrix = [[Polynomial; 3]; 3];

fn quaternion(letter: char) -> Quaternion {
    std::array::from_fn(|k| Polynomial::variable(letter, k as u8))
}

fn number(x: f64) -> Polynomial {
    Polynomial::constant(exact(x))
}

/// The sum of terms, each a sign and two factors.
fn sum(terms: &[(f64, &Polynomial, &Polynomial)]) -> Polynomial {
    let term = |(by, a, b): &(f64, &Polynomial, &Polynomial)| a.times(b).scaled(&exact(*by));
    terms.iter().map(term).fold(Polynomial::default(), |s, t| s.plus(&t))
}

fn product([ax, ay, az, aw]: &Quaternion, [bx, by, bz, bw]: &Quaternion) -> Quaternion {
    [
        sum(&[(1.0, aw, bx), (1.0, ax, bw), (1.0, ay, bz), (-1.0, az, by)]),
        sum(&[(1.0, aw, by), (-1.0, ax, bz), (1.0, ay, bw), (1.0, az, bx)]),
        sum(&[(1.0, aw, bz), (1.0, ax, by), (-1.0, ay, bx), (1.0, az, bw)]),
        sum(&[(1.0, aw, bw), (-1.0, ax, bx), (-1.0, ay, by), (-1.0, az, bz)]),
    ]
}

fn squared(q: &Quaternion) -> Polynomial {
    sum(&[0, 1, 2, 3].map(|k| (1.0, &q[k], &q[k])))
}

/// `|q|^2` times the rotation.
fn rotation(q: &Quaternion) -> Matrix {
    let [x, y, z, w] = q;
    let square = |signs: [f64; 4]| sum(&[0, 1, 2, 3].map(|k| (signs[k], &q[k], &q[k])));
    let twice = |(a, b), by: f64, (c, d)| sum(&[(2.0, a, b), (2.0 * by, c, d)]);
    [
        [
            square([1.0, -1.0, -1.0, 1.0]),
            twice((x, y), -1.0, (w, z)),
            twice((x, z), 1.0, (w, y)),
        ],
        [
            twice((x, y), 1.0, (w, z)),
            square([-1.0, 1.0, -1.0, 1.0]),
            twice((y, z), -1.0, (w, x)),
        ],
        [
            twice((x, z), -1.0, (w, y)),
            twice((y, z), 1.0, (w, x)),
            square([-1.0, -1.0, 1.0, 1.0]),
        ],
    ]
}

fn product_of_matrices(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| sum(&[0, 1, 2].map(|k| (1.0, &a[i][k], &b[k][j])))))
}

/// The sum of two matrices.
fn plus(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j].plus(&b[i][j])))
}

/// A multiple of the identity.
fn diagonal(of: &Polynomial) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { of.clone() } else { Polynomial::default() }))
}

#[test]
fn rotations_multiply_as_quaternions_do() {
    let (p, q) = (quaternion('p'), quaternion('q'));
    let both = rotation(&product(&p, &q));
    assert_eq!(both, product_of_matrices(&rotation(&p), &rotation(&q)));
    let rows = rotation(&q);
    let columns: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i].clone()));
    let fourth = squared(&q).times(&squared(&q));
    assert_eq!(product_of_matrices(&rows, &columns), diagonal(&fourth));
}

#[test]
fn a_quaternion_near_one_turns_twice() {
    let e = quaternion('e');
    let [x, y, z, w] = &e;
    let near = [x.clone(), y.clone(), z.clone(), w.plus(&number(1.0))];
    let by = |p: &Polynomial, factor: f64| p.scaled(&exact(factor));
    let none = Polynomial::default();
    let across = [
        [none.clone(), by(z, -2.0), by(y, 2.0)],
        [by(z, 2.0), none.clone(), by(x, -2.0)],
        [by(y, -2.0), by(x, 2.0), none],
    ];
    let along = diagonal(&number(1.0).plus(&by(w, 2.0)));
    assert_eq!(rotation(&near), plus(&plus(&along, &across), &rotation(&e)));
    let longer = number(1.0).plus(&by(w, 2.0)).plus(&squared(&e));
    assert_eq!(squared(&near), longer);
}

/// On small whole numbers nothing is rounded, and a form of degree two is known by them.
#[test]
fn the_matrix_of_the_code_is_the_rotation_and_a_multiple_of_one() {
    let q = quaternion('q');
    let left = number(1.0).plus(&squared(&q).scaled(&exact(-1.0)));
    let matrix = plus(&diagonal(&left), &rotation(&q));
    for k in 0..81 {
        let at = [1, 3, 9, 27].map(|power| f64::from(k / power % 3 - 1));
        let of_code = poses::matrix(at, 2.0);
        for (row, numbers) in matrix.iter().zip(of_code) {
            for (form, x) in row.iter().zip(numbers) {
                let value = form.terms().fold(RBig::ZERO, |sum, (m, c)| {
                    sum + m.iter().fold(c.clone(), |x, s| x * exact(at[s.index as usize]))
                });
                assert_eq!(value, exact(x), "{at:?}");
            }
        }
    }
}
