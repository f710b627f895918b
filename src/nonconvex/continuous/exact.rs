//! First contact of four vertices on straight paths, in exact integer arithmetic.
//!
//! 1. At a contact the four vertices lie in one plane, so their volume, a cubic in time, is zero.
//!    If the cubic is not zero everywhere, it has at most three roots.
//! 2. At each root, the signs of further polynomials decide whether the vertex is in the face or
//!    the edges cross.
//! 3. If the vertices stay in one plane, the first contact is at time zero or at a root of one of
//!    the further polynomials, where it changes its sign.
//!
//! [`Polynomial`] isolates its roots in the unit interval. [`Root`] computes the signs of other
//! polynomials at a root.
//!
//! Sources: Collins and Akritas 1976 (bisection by Descartes' rule of signs); Collins 1967
//! (remainder sequences). Departure: sign changes are those of Bernstein coefficients.

use alloc::vec;
use alloc::vec::Vec;
use dashu_base::{BitTest, Gcd};
use dashu_int::IBig;

use super::paths::VertexPath;
use super::search::{FirstContact, LEAST_WIDTH};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::body::polyhedron::lowest_bit;
use crate::convex::exact::integer::{self, Big3, integer, sign};
use crate::nonconvex::continuous::search::WideWork;
use crate::nonconvex::query::triangle::Triangle;

/// A vector whose coordinates are polynomials in time.
type Vector = [Polynomial; 3];

/// The moving vertices of a vertex and a segment, a vertex and a face, or two segments.
#[derive(Clone)]
enum ExactPair<'a> {
    Segment([&'a Vector; 3]),
    Face([&'a Vector; 4]),
    Edges([&'a Vector; 4]),
}

/// Returns the first contact of a vertex and a face.
///
/// The bracket is at most about `width` wide. The result is open only if a limit is reached.
pub(super) fn vertex_face(
    vertex: &VertexPath,
    face: &[VertexPath; 3],
    width: f64,
    work: &mut WideWork,
) -> FirstContact {
    let [p, a, b, c] = moving([vertex, &face[0], &face[1], &face[2]]);
    ExactPair::Face([&p, &a, &b, &c]).found(width, work)
}

/// Returns the first contact of two edges.
///
/// The bracket is at most about `width` wide. The result is open only if a limit is reached.
pub(super) fn edge_edge(a: &[VertexPath; 2], b: &[VertexPath; 2], width: f64, work: &mut WideWork) -> FirstContact {
    let [a, b, c, d] = moving([&a[0], &a[1], &b[0], &b[1]]);
    ExactPair::Edges([&a, &b, &c, &d]).found(width, work)
}

/// Returns whether an edge of one triangle passes through the interior of the other.
pub(super) fn pierce(p: &Triangle, q: &Triangle) -> bool {
    let numbers = p.iter().chain(q).flat_map(|v| v.iter().copied());
    let lowest = lowest_bit(numbers).unwrap_or(0);
    let whole = |t: &Triangle| t.each(|v| [v.x, v.y, v.z].each(|x| integer(x, lowest)));
    let (p, q) = (whole(p), whole(q));
    let volume = |a: &Big3, b: &Big3, c: &Big3, d: &Big3| {
        let [u, v, w] = [b, c, d].each(|x| integer::sub(x, a));
        sign(&integer::dot(&integer::cross(&u, &v), &w))
    };
    let through = |x: &[Big3; 3], y: &[Big3; 3]| {
        (0..3).any(|i| {
            let (from, to) = (&x[i], &x[(i + 1) % 3]);
            if volume(&y[0], &y[1], &y[2], from) * volume(&y[0], &y[1], &y[2], to) >= 0 {
                return false;
            }
            let turns = [0, 1, 2].each(|j| volume(from, to, &y[j], &y[(j + 1) % 3]));
            turns[0] != 0 && turns[1] == turns[0] && turns[2] == turns[0]
        })
    };
    through(&p, &q) || through(&q, &p)
}

/// Returns the paths as integers, all scaled by the same power of two.
fn moving(paths: [&VertexPath; 4]) -> [Vector; 4] {
    let ends = |p: &VertexPath| [p.start, p.end];
    let numbers = paths.iter().flat_map(|p| ends(p)).flat_map(|v| [v.x, v.y, v.z]);
    let lowest = lowest_bit(numbers).unwrap_or(0);
    paths.each(|p| {
        [0, 1, 2].each(|k| {
            let [begin, end] = ends(p).each(|v| integer(v[k], lowest));
            let move_of = &end - &begin;
            Polynomial::new(vec![begin, move_of])
        })
    })
}

fn sub(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].each(|k| a[k].sub(&b[k]))
}

fn dot(a: &Vector, b: &Vector) -> Polynomial {
    a[0].times(&b[0]).add(&a[1].times(&b[1])).add(&a[2].times(&b[2]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].each(|(i, j)| a[i].times(&b[j]).sub(&a[j].times(&b[i])))
}

fn is_zero(a: &Vector) -> bool {
    a.iter().all(Polynomial::is_zero)
}

impl<'a> ExactPair<'a> {
    fn found(&self, width: f64, work: &mut WideWork) -> FirstContact {
        self.first_contact(width.at_least(LEAST_WIDTH), work)
            .unwrap_or(FirstContact::Open { safe: 0.0 })
    }

    /// Returns the first contact; `None` if a limit is reached before.
    fn first_contact(&self, width: f64, work: &mut WideWork) -> Option<FirstContact> {
        work.left()?;
        if self.is_in_contact(&mut Root::zero(), work)? {
            return Some(FirstContact::Start);
        }
        let mut bracket: Option<[f64; 2]> = None;
        for polynomial in self.candidates() {
            for mut root in polynomial.roots(work)? {
                if !root.is_zero() && self.is_in_contact(&mut root, work)? {
                    let [safe, hit] = root.bracket(width, work)?;
                    let [s, h] = bracket.unwrap_or([safe, hit]);
                    bracket = Some([safe.smaller(s), hit.smaller(h)]);
                    break;
                }
            }
        }
        Some(bracket.map_or(FirstContact::Miss, |[safe, hit]| FirstContact::Hit { safe, hit }))
    }

    /// Returns polynomials of which one is zero at the first contact, unless that is at time zero.
    ///
    /// The signs of these polynomials decide the contact, and one that is not zero everywhere
    /// changes its sign at the contact.
    fn candidates(&self) -> Vec<Polynomial> {
        let volume = self.volume();
        if !volume.is_zero() {
            return vec![volume];
        }
        let normal = self.normal();
        if is_zero(&normal) && !matches!(self, ExactPair::Segment(_)) {
            return self.segments().iter().flat_map(ExactPair::candidates).collect();
        }
        let mut all = self.shares(&normal);
        all.push(dot(&normal, &normal));
        all.retain(|p| !p.is_zero());
        all
    }

    /// Returns whether the pair is in contact at a time; `None` if this is not decided.
    fn is_in_contact(&self, at: &mut Root, work: &mut WideWork) -> Option<bool> {
        if at.sign_of(&self.volume(), work)? != 0 {
            return Some(false);
        }
        let normal = self.normal();
        let mut is_flat = true;
        for x in &normal {
            is_flat &= at.sign_of(x, work)? == 0;
        }
        if is_flat {
            for segment in self.segments() {
                if segment.is_in_contact(at, work)? {
                    return Some(true);
                }
            }
            if !matches!(self, ExactPair::Segment(_)) {
                return Some(false);
            }
        } else if matches!(self, ExactPair::Segment(_)) {
            return Some(false);
        }
        for share in self.shares(&normal) {
            if at.sign_of(&share, work)? < 0 {
                return Some(false);
            }
        }
        Some(true)
    }

    /// Returns six times the volume of the four vertices.
    ///
    /// For a vertex and a segment, returns a coordinate of the cross product instead: one that is
    /// not zero everywhere, if there is one.
    fn volume(&self) -> Polynomial {
        match self {
            ExactPair::Segment(_) => {
                let normal = self.normal();
                let first = normal.iter().find(|x| !x.is_zero());
                first.unwrap_or(&normal[0]).clone()
            }
            ExactPair::Face([p, a, b, c]) => dot(&cross(&sub(b, a), &sub(c, a)), &sub(p, a)),
            ExactPair::Edges([a, b, c, d]) => dot(&cross(&sub(b, a), &sub(d, c)), &sub(c, a)),
        }
    }

    /// Returns the normal of the face or the common perpendicular of the edges.
    ///
    /// For a vertex and a segment, returns a cross product that is zero if the vertex is on the
    /// line of the segment.
    fn normal(&self) -> Vector {
        match self {
            ExactPair::Segment([p, a, b]) => cross(&sub(b, a), &sub(p, a)),
            ExactPair::Face([_, a, b, c]) => cross(&sub(b, a), &sub(c, a)),
            ExactPair::Edges([a, b, c, d]) => cross(&sub(b, a), &sub(d, c)),
        }
    }

    /// Returns numbers that are all at least zero if the pair is in contact.
    ///
    /// All vertices lie in the plane with this normal. The numbers are multiples of the barycentric
    /// coordinates of the common point: in the face, or on both edges.
    fn shares(&self, normal: &Vector) -> Vec<Polynomial> {
        match self {
            ExactPair::Segment([p, a, b]) => vec![dot(&sub(p, a), &sub(b, p))],
            ExactPair::Face([p, a, b, c]) => {
                let share = |x: &Vector, y: &Vector| dot(&cross(&sub(x, p), &sub(y, p)), normal);
                vec![share(a, b), share(b, c), share(c, a)]
            }
            ExactPair::Edges([a, b, c, d]) => {
                let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
                let whole = dot(normal, normal);
                let [on_a, on_b] = [&v, &u].each(|x| dot(&cross(&w, x), normal));
                vec![whole.sub(&on_a), on_a, whole.sub(&on_b), on_b]
            }
        }
    }

    /// Returns the pairs of a vertex and a segment that decide a pair whose normal is zero.
    fn segments(&self) -> Vec<ExactPair<'a>> {
        match *self {
            ExactPair::Segment(_) => Vec::new(),
            ExactPair::Face([p, a, b, c]) => [[p, a, b], [p, b, c], [p, c, a]].each(ExactPair::Segment).to_vec(),
            ExactPair::Edges([a, b, c, d]) => [[a, c, d], [b, c, d], [c, a, b], [d, a, b]]
                .each(ExactPair::Segment)
                .to_vec(),
        }
    }
}

/// A polynomial by its coefficients, the constant first. The last is not zero; zero has none.
#[derive(Clone, Debug, PartialEq)]
struct Polynomial(Vec<IBig>);

/// Largest number of halvings of an interval around a root. Far fewer separate the roots of
/// polynomials whose coefficients have a few thousand bits.
const MOST: u32 = 1 << 16;

impl Polynomial {
    fn new(mut coefficients: Vec<IBig>) -> Self {
        while coefficients.last().is_some_and(IBig::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the number of bits of the widest coefficient.
    fn bits(&self) -> usize {
        self.0.iter().map(BitTest::bit_len).max().unwrap_or(0)
    }

    fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// Returns the sum with a multiple of another polynomial.
    fn plus(&self, other: &Self, factor: i32) -> Self {
        let at = |p: &Self, k: usize| p.0.get(k).cloned().unwrap_or(IBig::ZERO);
        let length = self.0.len().max(other.0.len());
        Self::new(
            (0..length)
                .map(|k| at(self, k) + at(other, k) * IBig::from(factor))
                .collect(),
        )
    }

    fn add(&self, other: &Self) -> Self {
        self.plus(other, 1)
    }

    fn sub(&self, other: &Self) -> Self {
        self.plus(other, -1)
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self(Vec::new());
        }
        let mut product = vec![IBig::ZERO; self.0.len() + other.0.len() - 1];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in other.0.iter().enumerate() {
                product[i + j] += x * y;
            }
        }
        Self::new(product)
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::new(terms.map(|(k, c)| c * IBig::from(k)).collect())
    }

    /// Returns the polynomial without the common divisor of its coefficients.
    fn primitive(self) -> Self {
        // The divisor of two zeros is not defined.
        let Some(last) = self.0.last() else { return self };
        let common = self.0.iter().fold(last.clone(), |g, c| IBig::from((&g).gcd(c)));
        Self(self.0.iter().map(|c| c / &common).collect())
    }

    /// Returns quotient and remainder of a multiple of the polynomial, divided by one that is not
    /// zero.
    fn divided(&self, by: &Self) -> (Self, Self) {
        let (mut rest, mut quotient) = (self.clone(), Self(Vec::new()));
        let lead = &by.0[by.degree()];
        while rest.0.len() >= by.0.len() {
            let (shift, top) = (rest.0.len() - by.0.len(), rest.0[rest.degree()].clone());
            let mut term = vec![IBig::ZERO; shift];
            term.push(top);
            let term = Self(term);
            let scaled = |p: &Self| Self::new(p.0.iter().map(|c| c * lead).collect());
            quotient = scaled(&quotient).add(&term);
            rest = scaled(&rest).sub(&by.times(&term));
        }
        (quotient, rest)
    }

    fn common_divisor(&self, other: &Self, work: &mut WideWork) -> Option<Self> {
        let (mut a, mut b) = (self.clone().primitive(), other.clone().primitive());
        while !b.is_zero() {
            let bits = a.bits().max(b.bits());
            // The work of the quotients of polynomials and of the divisors of their coefficients.
            work.count(8 * a.0.len() * b.0.len(), [bits, bits])?;
            let rest = a.divided(&b).1.primitive();
            (a, b) = (b, rest);
        }
        Some(a)
    }

    /// Returns a polynomial with the same roots, each of them simple.
    fn square_free(&self, work: &mut WideWork) -> Option<Self> {
        let common = self.common_divisor(&self.derivative(), work)?;
        Some(if common.degree() == 0 {
            self.clone().primitive()
        } else {
            self.divided(&common).0.primitive()
        })
    }

    /// Returns the Bernstein coefficients from `k / 2^j` to `(k + 1) / 2^j`, up to a positive
    /// factor.
    ///
    /// All coefficients have the same factor. Returns `None` if the budget is spent.
    fn bernstein(&self, k: &IBig, j: usize, work: &mut WideWork) -> Option<Vec<IBig>> {
        let n = self.degree();
        work.count((n + 1) * (n + 2), [self.bits() + j * n, k.bit_len()])?;
        // p((k + x) / 2^j) 2^(j n), by Horner's rule for the shift.
        let mut shifted: Vec<IBig> = self.0.iter().enumerate().map(|(i, c)| c << (j * (n - i))).collect();
        for first in 0..n {
            for i in (first..n).rev() {
                let carry = &shifted[i + 1] * k;
                shifted[i] += carry;
            }
        }
        // b_i = sum over m of binomial(i, m) / binomial(n, m) a_m, times n!.
        let factorial = |x: usize| (1..=x).product::<usize>();
        let weight = |i: usize, m: usize| factorial(i) / factorial(i - m) * factorial(n - m);
        let of = |i: usize| (0..=i).fold(IBig::ZERO, |sum, m| sum + &shifted[m] * IBig::from(weight(i, m)));
        Some((0..=n).map(of).collect())
    }

    /// Returns the roots from zero to one, in order; `None` if a limit is reached before.
    fn roots(&self, work: &mut WideWork) -> Option<Vec<Root>> {
        let simple = self.square_free(work)?;
        let mut roots = Vec::new();
        if simple.degree() == 0 {
            return Some(roots);
        }
        if simple.0[0].is_zero() {
            roots.push(Root::exact(simple.clone(), IBig::ZERO, 0));
        }
        let mut open = vec![(IBig::ZERO, 0usize)];
        for _ in 0..MOST {
            let Some((k, j)) = open.pop() else {
                return Some(roots);
            };
            let coefficients = simple.bernstein(&k, j, work)?;
            match variations(&coefficients) {
                0 => {}
                1 => roots.push(Root {
                    of: simple.clone(),
                    low: k.clone(),
                    halvings: j,
                    is_exact: false,
                }),
                _ => {
                    open.push((2 * &k + 1, j + 1));
                    open.push((2 * &k, j + 1));
                    continue;
                }
            }
            if coefficients.last().is_some_and(IBig::is_zero) {
                roots.push(Root::exact(simple.clone(), k + 1, j));
            }
        }
        None
    }
}

/// Returns the number of sign changes, zeros left out.
///
/// This exceeds the number of roots in the open interval by zero or by an even number.
fn variations(coefficients: &[IBig]) -> usize {
    let signs = coefficients.iter().map(sign).filter(|s| *s != 0);
    let (count, _) = signs.fold((0, 0), |(count, last), s| (count + usize::from(last * s < 0), s));
    count
}

/// A root of a polynomial that has only simple roots.
///
/// It is the only root between `low / 2^halvings` and `(low + 1) / 2^halvings` or, if exact,
/// `low / 2^halvings` itself.
#[derive(Clone, Debug)]
struct Root {
    of: Polynomial,
    low: IBig,
    halvings: usize,
    is_exact: bool,
}

impl Root {
    fn exact(of: Polynomial, low: IBig, halvings: usize) -> Self {
        Self {
            of,
            low,
            halvings,
            is_exact: true,
        }
    }

    /// Returns zero as the root of a polynomial.
    fn zero() -> Self {
        Self::exact(Polynomial(vec![IBig::ZERO, IBig::ONE]), IBig::ZERO, 0)
    }

    fn is_zero(&self) -> bool {
        self.is_exact && self.low.is_zero()
    }

    /// Halves the interval; `None` if the budget is spent.
    fn refine(&mut self, work: &mut WideWork) -> Option<()> {
        let (left, halvings) = (2 * &self.low, self.halvings + 1);
        let coefficients = self.of.bernstein(&left, halvings, work)?;
        self.halvings = halvings;
        self.is_exact = coefficients.last().is_some_and(IBig::is_zero);
        let is_left = variations(&coefficients) == 1;
        self.low = if self.is_exact || !is_left { left + 1 } else { left };
        Some(())
    }

    /// Returns the sign of a polynomial at the root; `None` if a limit is reached before.
    fn sign_of(&mut self, other: &Polynomial, work: &mut WideWork) -> Option<i32> {
        if other.is_zero() {
            return Some(0);
        }
        let mut is_unequal = false;
        for _ in 0..MOST {
            if self.is_exact {
                return other.bernstein(&self.low, self.halvings, work)?.first().map(sign);
            }
            let coefficients = other.bernstein(&self.low, self.halvings, work)?;
            if variations(&coefficients) == 0 {
                let first = coefficients.iter().map(sign).find(|s| *s != 0);
                return Some(first.unwrap_or(0));
            }
            if !is_unequal {
                let common = self.of.common_divisor(other, work)?;
                // The interval holds one root of `of`, so at most one of the common divisor.
                let is_common = |at: Vec<IBig>| variations(&at) % 2 == 1;
                if common.degree() > 0 && is_common(common.bernstein(&self.low, self.halvings, work)?) {
                    return Some(0);
                }
                is_unequal = true;
            }
            self.refine(work)?;
        }
        None
    }

    /// Returns two numbers around the root: one below it, and one that is not below it.
    ///
    /// They differ by at most `width` plus a rounding. Returns `None` if the budget is spent. The
    /// root must not be zero, and `width` must not be below `2^-1000`.
    fn bracket(&mut self, width: f64, work: &mut WideWork) -> Option<[f64; 2]> {
        while !self.is_exact && crate::body::polyhedron::power_of_two(-(self.halvings as i32)) > width {
            self.refine(work)?;
        }
        if self.is_exact {
            let [below, above] = rounded(&self.low, self.halvings);
            let low = if below == above { below.next_down() } else { below };
            return Some([low.at_least(0.0), above]);
        }
        Some([
            rounded(&self.low, self.halvings)[0],
            rounded(&(&self.low + 1), self.halvings)[1],
        ])
    }
}

/// Returns `k / 2^j`, which is from zero to one, rounded down and up.
fn rounded(k: &IBig, j: usize) -> [f64; 2] {
    if k.is_zero() {
        return [0.0, 0.0];
    }
    let cut = k.bit_len().saturating_sub(53);
    let exponent = cut as i64 - j as i64;
    if exponent < -1000 {
        return [0.0, f64::from_bits((1023 - 900) << 52)];
    }
    let unit = crate::body::polyhedron::power_of_two(exponent as i32);
    let head = k >> cut;
    let is_whole = cut == 0 || &head << cut == *k;
    let number = |x: &IBig| i64::try_from(x).unwrap_or(0) as f64 * unit;
    [number(&head), number(&if is_whole { head.clone() } else { &head + 1 })]
}
