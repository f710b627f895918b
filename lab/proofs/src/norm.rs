//! Bounds of errors by the lengths of vectors.
//!
//! An error that is a form in the coordinates of several vectors is bounded by the spectral norm of a matrix that is
//! not negative. For any `y > 0`, the square of the norm of M is at most the greatest `(M^T M y)_i / y_i` (Collatz and
//! Wielandt); y is searched for in f64 and the quotients are exact, so the search need not be right.

use super::majorant::power;
use super::polynomial::{Monomial, Polynomial, Symbol};
use dashu_ratio::RBig;
use std::collections::{BTreeMap, BTreeSet};
use truth::rational::exact;

/// Lengths of vectors by letter; one if a letter is not named.
pub type Lengths<'a> = &'a [(char, RBig)];

/// Bound of the length of the vector of these errors, if vectors have the given lengths.
///
/// Monomials of the same letters make a tensor, which is folded to a matrix in every way; the least norm counts.
pub fn length(errors: &[&Polynomial], lengths: Lengths) -> RBig {
    let mut parts: BTreeMap<Vec<char>, Vec<Term>> = BTreeMap::new();
    for (row, error) in errors.iter().enumerate() {
        for (monomial, coefficient) in error.terms() {
            let letters = monomial.iter().map(|s| s.letter).collect();
            let of_letters = parts.entry(letters).or_default();
            of_letters.push((row, monomial.clone(), coefficient.clone()));
        }
    }
    let length_of = |c: &char| {
        let known = lengths.iter().find(|(letter, _)| letter == c);
        known.map_or(RBig::ONE, |(_, length)| length.clone())
    };
    let part = |(letters, terms): (&Vec<char>, &Vec<Term>)| {
        let size = letters.iter().map(length_of).fold(RBig::ONE, |a, b| a * b);
        size * least_folded(letters, terms)
    };
    parts.iter().map(part).fold(RBig::ZERO, |a, b| a + b)
}

/// A term of the error of a coordinate.
type Term = (usize, Monomial, RBig);

fn least_folded(letters: &[char], terms: &[Term]) -> RBig {
    let splits: BTreeSet<Vec<char>> = (0..1u32 << letters.len())
        .map(|bits| {
            let left = letters.iter().enumerate().filter(|(k, _)| bits >> k & 1 == 1);
            left.map(|(_, c)| *c).collect()
        })
        .collect();
    let folded = splits
        .iter()
        .flat_map(|left| [false, true].map(|row_is_left| spectral(&folded(terms, left, row_is_left))));
    folded.min().expect("there is a way to fold")
}

/// A matrix by rows and columns, each with names of their own.
type Matrix = BTreeMap<(String, String), RBig>;

fn folded(terms: &[Term], left: &[char], row_is_left: bool) -> Matrix {
    let mut matrix = Matrix::new();
    for (row, monomial, coefficient) in terms {
        let ways = shared_out(monomial, left);
        let share = coefficient / RBig::from(ways.len());
        for (l, r) in ways {
            let (l, r) = (format!("{l:?}"), format!("{r:?}"));
            let key = if row_is_left {
                (format!("{row}{l}"), r)
            } else {
                (l, format!("{row}{r}"))
            };
            *matrix.entry(key).or_default() += &share;
        }
    }
    matrix
}

/// All ways to share the variables of a monomial out, those of the letters `left` to the left, in every order among
/// variables of one letter.
fn shared_out(monomial: &[Symbol], left: &[char]) -> Vec<(Monomial, Monomial)> {
    let mut right: Vec<char> = monomial.iter().map(|s| s.letter).collect();
    for c in left {
        let at = right.iter().position(|d| d == c).expect("a letter of the monomial");
        right.remove(at);
    }
    let order = [left, &right[..]].concat();
    let mut ways = Vec::new();
    arrange(monomial, &order, &mut Vec::new(), &mut ways);
    ways.into_iter()
        .map(|way| (way[..left.len()].to_vec(), way[left.len()..].to_vec()))
        .collect()
}

/// All orders of the variables whose letters are `order`.
fn arrange(rest: &[Symbol], order: &[char], chosen: &mut Monomial, ways: &mut Vec<Monomial>) {
    let Some(letter) = order.first() else {
        ways.push(chosen.clone());
        return;
    };
    for (k, symbol) in rest.iter().enumerate().filter(|(_, s)| s.letter == *letter) {
        let mut left = rest.to_vec();
        left.remove(k);
        chosen.push(*symbol);
        arrange(&left, &order[1..], chosen, ways);
        chosen.pop();
    }
}

/// Bound of the spectral norm of a matrix that is not negative.
fn spectral(matrix: &Matrix) -> RBig {
    let columns: Vec<&String> = matrix
        .keys()
        .map(|(_, c)| c)
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let index = |c: &String| columns.binary_search(&c).expect("a column of the matrix");
    let mut rows: BTreeMap<&String, Vec<(usize, &RBig)>> = BTreeMap::new();
    for ((r, c), x) in matrix {
        rows.entry(r).or_default().push((index(c), x));
    }
    let rows: Vec<_> = rows.into_values().collect();
    let about: Vec<Vec<(usize, f64)>> = rows
        .iter()
        .map(|row| row.iter().map(|(k, x)| (*k, x.to_f64().value())).collect())
        .collect();
    let y = principal(&about, columns.len());
    let y: Vec<RBig> = y.iter().map(|&x| exact((x * 1e9).round() + 1.0)).collect();
    let mut z = vec![RBig::ZERO; y.len()];
    for row in &rows {
        let sum = row.iter().fold(RBig::ZERO, |s, (k, x)| s + *x * &y[*k]);
        row.iter().for_each(|(k, x)| z[*k] += *x * &sum);
    }
    let square = z.iter().zip(&y).map(|(z, y)| z / y).max().unwrap_or(RBig::ZERO);
    root_above(&square)
}

/// The vector that `M^T M` stretches most, about.
fn principal(rows: &[Vec<(usize, f64)>], columns: usize) -> Vec<f64> {
    let mut y = vec![1.0; columns];
    for _ in 0..100 {
        let mut z = vec![0.0; columns];
        for row in rows {
            let sum: f64 = row.iter().map(|(k, x)| x * y[*k]).sum();
            row.iter().for_each(|(k, x)| z[*k] += x * sum);
        }
        let most = z.iter().fold(0.0f64, |m, x| m.max(*x));
        y = z.iter().map(|x| x / most + 1e-9).collect();
    }
    y
}

/// A number whose square is at least this, hardly greater than the root.
pub fn root_above(square: &RBig) -> RBig {
    let near = exact(truth::rational::sqrt(square).0);
    let root = near * (RBig::ONE + power(-40));
    assert!(&root * &root >= *square, "rounded up");
    root
}
