//! Curves of joints from arbitrary bytes: control points, coefficients, knots and times.
//!
//! The test `driven` and the target `curves` of `fuzz/` share this module.

use super::Bytes;
use crate::arm::chain::chain;
use lin_canny_plan::{Checker, JointCurve, JointMotion, JointTree, PlanError};
use std::sync::LazyLock;

/// Coordinates of a curve: the joints of the arm that follows it.
const JOINTS: usize = 3;

/// Limits of each joint.
const LIMITS: [f64; 2] = [-3.0, 3.0];

/// Times at which a curve is evaluated.
const TIMES: [f64; 5] = [0.0, 0.2, 0.5, 0.9, 1.0];

/// The arm among posts that follows the curves.
static ARM: LazyLock<(JointTree, lin_canny_plan::Cell)> = LazyLock::new(|| chain(JOINTS, LIMITS).expect("an arm"));

/// Counts of the results.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Curves made and rejected.
    pub curves: [u32; 2],
    /// Curves that the arm follows, and those that are out of its limits.
    pub followed: [u32; 2],
}

/// Makes curves from the bytes; an arm follows them.
///
/// # Panics
/// Panics if a curve leaves its control points, or if a curve that is called free is not free at a
/// time.
pub fn drive(bytes: &[u8]) -> Tally {
    let (mut bytes, mut tally) = (Bytes(bytes), Tally::default());
    let row = |bytes: &mut Bytes<'_>| -> Vec<f64> { (0..JOINTS).map(|_| bytes.joint()).collect() };
    let count = 1 + usize::from(bytes.byte() % 18);
    let rows: Vec<Vec<f64>> = (0..count).map(|_| row(&mut bytes)).collect();
    let at = |k: usize| &rows[k % count];
    let duration = bytes.joint();
    let degree = usize::from(bytes.byte() % 8);
    let knots: Vec<f64> = (0..count + degree + 1).map(|_| bytes.joint()).collect();
    let mut made: Vec<Result<JointCurve, PlanError>> = match bytes.byte() % 6 {
        0 => vec![JointCurve::power(&rows)],
        1 => vec![JointCurve::cubic(at(0), at(1), at(2), at(3), duration)],
        2 => vec![JointCurve::quintic(
            [at(0), at(1)],
            [at(2), at(3)],
            [at(4), at(5)],
            duration,
        )],
        3 => pieces(JointCurve::uniform_b_spline(&rows, degree)),
        4 => pieces(JointCurve::b_spline(&rows, degree, &knots)),
        _ => vec![JointCurve::bezier(&rows)],
    };
    let elevated: Vec<_> = made.iter().flatten().map(JointCurve::elevated).collect();
    made.extend(elevated);
    let (space, cell) = ARM.clone();
    let mut checker = Checker::new(space, cell).expect("a world");
    for curve in made {
        tally.curves[usize::from(curve.is_err())] += 1;
        let Ok(curve) = curve else { continue };
        inside(&curve);
        let verdict = checker.certify(&JointMotion::curve(&curve));
        tally.followed[usize::from(verdict.is_err())] += 1;
        let Ok(verdict) = verdict else { continue };
        for time in TIMES {
            // A curve that touches a limit inside may exceed it by rounding.
            let q = curve.at(time * verdict.free_until()).into_iter();
            let q: Vec<f64> = q.map(|x| x.clamp(LIMITS[0], LIMITS[1])).collect();
            if verdict.is_free() {
                assert!(checker.is_free_at(&q).expect("within limits"), "{time} {curve:?}");
            }
        }
    }
    tally
}

fn pieces(spline: Result<Vec<JointCurve>, PlanError>) -> Vec<Result<JointCurve, PlanError>> {
    match spline {
        Ok(curves) => curves.into_iter().map(Ok).collect(),
        Err(error) => vec![Err(error)],
    }
}

/// A curve lies within its control points.
fn inside(curve: &JointCurve) {
    let points: Vec<_> = (0..=curve.degree()).map(|k| curve.control_point(k)).collect();
    for time in TIMES {
        for (k, x) in curve.at(time).into_iter().enumerate() {
            let each = || points.iter().map(|p| p[k]);
            let low = each().fold(f64::INFINITY, f64::min);
            let high = each().fold(f64::NEG_INFINITY, f64::max);
            let slack = 1e-12 * (low.abs().max(high.abs()));
            assert!(low - slack <= x && x <= high + slack, "{x} at {time}: {points:?}");
        }
    }
}

impl Bytes<'_> {
    /// Returns the value of a joint: a small number, mostly, or any.
    fn joint(&mut self) -> f64 {
        let whole = f64::from(i16::from_le_bytes([self.byte(), self.byte()]));
        match self.byte() % 16 {
            0 => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
            1 => whole * 2f64.powi(i32::from(self.byte() as i8) * 8),
            2 => whole / 8192.0 * f64::EPSILON,
            3 => (whole / 8192.0).round(),
            _ => whole / 16384.0,
        }
    }
}
