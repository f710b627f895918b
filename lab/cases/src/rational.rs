//! Exact arithmetic of the oracle: bodies at poses over the rationals, with roots rounded once.
//!
//! A pose maps a vertex to `R(q) v / |q|^2 + t`, where `R(q) v` is the vector part of
//! `q v conj(q)`. This is rational in the bits of `q`, `v` and `t`, so no rounding occurs even if
//! the quaternion is not quite unit. Over one common denominator, coordinates are integers, and the
//! geometry needs only integers.

use crate::{Point, Pose};
use dashu_base::{Abs, BitTest, DivRem, Gcd, SquareRoot};
use dashu_int::{IBig, UBig};
pub use dashu_ratio::RBig;

/// A vector of integers.
pub type IntVec = [IBig; 3];

/// Returns the exact value of `x`, which must be finite.
pub fn exact(x: f64) -> RBig {
    RBig::try_from(x).unwrap_or_else(|_| panic!("{x} is not finite"))
}

/// Returns `x` rounded to nearest, ties to even.
pub fn rounded(x: &RBig) -> f64 {
    x.to_f64().value()
}

/// Returns the matrix `R(q) / |q|^2`; `q` must not be zero.
pub fn rotation(q: [f64; 4]) -> [[RBig; 3]; 3] {
    let q = q.map(exact);
    let [x, y, z, w] = &q;
    let two = |a: RBig| &a + &a;
    let rows = [
        [w * w + x * x - y * y - z * z, two(x * y - w * z), two(x * z + w * y)],
        [two(x * y + w * z), w * w - x * x + y * y - z * z, two(y * z - w * x)],
        [two(x * z - w * y), two(y * z + w * x), w * w - x * x - y * y + z * z],
    ];
    let norm2 = q.iter().fold(RBig::ZERO, |s, c| s + c * c);
    rows.map(|row| row.map(|m| m / &norm2))
}

/// Returns the image of every point under `pose`, exactly.
pub fn placed(points: &[Point], pose: &Pose) -> Vec<[RBig; 3]> {
    let m = rotation(pose.q);
    let t = pose.t.map(exact);
    let place = |p: &Point| {
        let v = p.map(exact);
        std::array::from_fn(|i| &m[i][0] * &v[0] + &m[i][1] * &v[1] + &m[i][2] * &v[2] + &t[i])
    };
    points.iter().map(place).collect()
}

/// Returns `m` and `e` of `x = m 2^e`; `m` is odd or zero.
fn parts(x: f64) -> (i64, i32) {
    assert!(x.is_finite(), "{x} is not finite");
    let field = (x.to_bits() >> 52 & 0x7ff) as i32;
    let fraction = (x.to_bits() & ((1 << 52) - 1)) as i64;
    let (m, e) = if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, field - 1075)
    };
    let shift = m.trailing_zeros() % 64; // zero stays zero
    let m = m >> shift;
    (if x < 0.0 { -m } else { m }, e + shift as i32)
}

/// Returns the least exponent of some numbers, or 0 if all are zero.
fn least_exponent<'a>(numbers: impl Iterator<Item = &'a f64>) -> i32 {
    let nonzero = numbers.filter(|x| **x != 0.0);
    nonzero.map(|&x| parts(x).1).min().unwrap_or(0)
}

/// Returns `x / 2^e`, which must be an integer.
fn whole(x: f64, e: i32) -> IBig {
    let (m, own) = parts(x);
    IBig::from(m) << if m == 0 { 0 } else { (own - e) as usize }
}

/// Returns a matrix `M` and a number `n` of integers with the rotation `M / n`.
fn whole_rotation(q: [f64; 4]) -> ([IntVec; 3], IBig) {
    let e = least_exponent(q.iter());
    let [x, y, z, w] = &q.map(|c| whole(c, e));
    let two = |a: IBig| a << 1;
    let rows = [
        [w * w + x * x - y * y - z * z, two(x * y - w * z), two(x * z + w * y)],
        [two(x * y + w * z), w * w - x * x + y * y - z * z, two(y * z - w * x)],
        [two(x * z - w * y), two(y * z + w * x), w * w - x * x - y * y + z * z],
    ];
    (rows, x * x + y * y + z * z + w * w)
}

/// Returns the points of two bodies at their poses, exactly, as integers over one common
/// denominator, and the denominator.
pub fn placed_together(a: &[Point], pose_a: &Pose, b: &[Point], pose_b: &Pose) -> (Vec<IntVec>, Vec<IntVec>, UBig) {
    let lengths = a.iter().chain(b).chain([&pose_a.t, &pose_b.t]).flatten();
    let e = least_exponent(lengths).min(0);
    let (ra, na) = whole_rotation(pose_a.q);
    let (rb, nb) = whole_rotation(pose_b.q);
    let put = |points: &[Point], (rows, n): (&[IntVec; 3], &IBig), t: Point, by: &IBig| -> Vec<IntVec> {
        let origin = t.map(|x| whole(x, e) * n);
        let place = |p: &Point| {
            let v = p.map(|x| whole(x, e));
            std::array::from_fn(|i| (dot(&rows[i], &v) + &origin[i]) * by)
        };
        points.iter().map(place).collect()
    };
    let (by_a, by_b) = if pose_a.q == pose_b.q {
        (IBig::ONE, IBig::ONE)
    } else {
        (nb.clone(), na.clone())
    };
    let den = (&na * &by_a) << (-e) as usize;
    let den = UBig::try_from(den).expect("a square is not negative");
    (
        put(a, (&ra, &na), pose_a.t, &by_a),
        put(b, (&rb, &nb), pose_b.t, &by_b),
        den,
    )
}

/// Returns two sets of points as integers over one common denominator, and the denominator.
pub fn common(a: &[[RBig; 3]], b: &[[RBig; 3]]) -> (Vec<IntVec>, Vec<IntVec>, UBig) {
    let lcm = |d: UBig, x: &RBig| &d / (&d).gcd(x.denominator()) * x.denominator();
    let den = a.iter().chain(b).flatten().fold(UBig::ONE, lcm);
    let whole = |x: &RBig| x.numerator() * IBig::from(&den / x.denominator());
    let each = |set: &[[RBig; 3]]| set.iter().map(|p| p.each_ref().map(whole)).collect();
    (each(a), each(b), den)
}

/// Returns `sqrt(x)` for `x >= 0`, correctly rounded, and the rounded remainder.
pub fn sqrt(x: &RBig) -> (f64, f64) {
    if x.is_zero() {
        return (0.0, 0.0);
    }
    // Scale by 4^h so that the integer root has at least 200 bits. A sticky last bit represents
    // everything below it, so that rounding knows on which side of a tie the true root lies.
    let (num, den) = (x.numerator().abs_ref(), x.denominator());
    let bits = num.bit_len() as i64 - den.bit_len() as i64;
    let h = ((402 - bits).max(0) / 2) as usize;
    let (m, rest) = (num << (2 * h)).div_rem(den);
    let root = m.sqrt();
    let inexact = !rest.is_zero() || &root * &root != m;
    let sticky = (root << 1) + UBig::from(u8::from(inexact));
    let value = RBig::from_parts(sticky.into(), UBig::ONE << (h + 1));
    let head = rounded(&value);
    if !head.is_finite() {
        return (head, 0.0);
    }
    (head, rounded(&(value - exact(head))))
}

/// Returns `x / sqrt(norm2)` correctly rounded, with the sign of `x`; `norm2 > 0`.
pub fn over_root(x: &RBig, norm2: &RBig) -> f64 {
    let size = sqrt(&(x * x / norm2)).0;
    if *x < RBig::ZERO { -size } else { size }
}

/// `a - b`.
pub fn sub(a: &IntVec, b: &IntVec) -> IntVec {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// `a . b`.
pub fn dot(a: &IntVec, b: &IntVec) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// `a x b`.
pub fn cross(a: &IntVec, b: &IntVec) -> IntVec {
    [
        &a[1] * &b[2] - &a[2] * &b[1],
        &a[2] * &b[0] - &a[0] * &b[2],
        &a[0] * &b[1] - &a[1] * &b[0],
    ]
}

/// Helper for the absolute value of a borrowed integer.
trait AbsRef {
    fn abs_ref(&self) -> UBig;
}

impl AbsRef for IBig {
    fn abs_ref(&self) -> UBig {
        self.clone()
            .abs()
            .try_into()
            .expect("an absolute value is not negative")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn roots_of_squares_are_exact_and_others_round_to_nearest() {
        assert_eq!(sqrt(&exact(0.0)), (0.0, 0.0));
        assert_eq!(sqrt(&exact(9.0)), (3.0, 0.0));
        let mut r = Rng::new(5);
        for _ in 0..2000 {
            let x = r.log_range(1e-150, 1e150);
            assert_eq!(sqrt(&(exact(x) * exact(x))), (x, 0.0));
            let (head, tail) = sqrt(&exact(x));
            assert_eq!(head, x.sqrt(), "the processor rounds square roots correctly");
            assert!(tail.abs() <= head * 1.2e-16);
        }
    }

    #[test]
    fn tiny_and_huge_roots_do_not_leave_the_range() {
        let tiny = exact(f64::from_bits(1));
        assert_eq!(sqrt(&(&tiny * &tiny)).0, f64::from_bits(1));
        let huge = exact(f64::MAX);
        assert_eq!(sqrt(&(&huge * &huge)).0, f64::MAX);
        assert_eq!(over_root(&exact(-6.0), &exact(4.0)), -3.0);
    }

    #[test]
    fn placing_is_exact_for_a_quaternion_that_is_not_unit() {
        // q = (0, 0, 3, 3) is a quarter turn about z, independent of its length.
        let pose = Pose::new([0.0, 0.0, 3.0, 3.0], [0.5, 0.0, 1e-30]);
        let p = placed(&[[1.0, 2.0, 3.0]], &pose);
        assert_eq!(p[0], [exact(-1.5), exact(1.0), exact(3.0) + exact(1e-30)]);
    }

    #[test]
    fn points_are_placed_alike_over_integers_and_over_rationals() {
        let mut r = Rng::new(6);
        for k in 0..300 {
            let points = [(); 3].map(|()| r.unit().map(|x| x * [1.0, 0.0, 1e-300, 1e200][k % 4]));
            let pose_a = Pose {
                q: r.quat(),
                t: r.unit().map(|x| x * [0.0, 1.0, 1e9][k % 3]),
            };
            let q = if k % 5 == 0 { pose_a.q } else { r.quat() };
            let pose_b = Pose {
                q,
                t: [5e-324, -0.0, 1.0],
            };
            let (a, b, den) = placed_together(&points, &pose_a, &points, &pose_b);
            for (ours, pose) in [(a, pose_a), (b, pose_b)] {
                let ours = ours.into_iter().map(|v| v.map(|x| RBig::from_parts(x, den.clone())));
                assert!(ours.eq(placed(&points, &pose)));
            }
        }
    }

    #[test]
    fn common_denominators_keep_the_values() {
        let third = RBig::from_parts(1.into(), 3u8.into());
        let (a, b, den) = common(
            &[[third, exact(0.5), exact(2.0)]],
            &[[exact(0.25), exact(0.0), exact(-1.0)]],
        );
        assert_eq!(den, UBig::from(12u8));
        assert_eq!(a[0], [4.into(), 6.into(), 24.into()]);
        assert_eq!(b[0], [3.into(), 0.into(), (-12).into()]);
    }
}
