//! Exact checks of an outcome, for bodies of any size.
//!
//! A direction alone gives a lower bound of the distance, and two points give an upper bound. So an
//! outcome can be judged without solving anything. Each function takes the poses of the actual
//! query and rounds once, at the end.
//!
//! First `f64` scans all points, with a slack far above its rounding errors. Then exact arithmetic
//! evaluates only the few candidates: thousands of points take well under a millisecond.

use crate::body::Body;
use crate::pose::{cross, dot, sub};
use crate::rational::{exact, over_root, placed, rotation, rounded, sqrt};
use crate::{Face, Point, Pose};
use dashu_ratio::RBig;

/// Relative slack of the `f64` scans: about a hundred times the rounding error of three products
/// and two sums.
const SLACK: f64 = 1e-13;

/// Returns the gap of two bodies along a direction `n` of the world frame, correctly rounded.
///
/// The gap is `(min over B of n.b - max over A of n.a) / |n|`. It never exceeds the signed
/// distance, for any `n`; for the best `n` it is the signed distance. Faces are not used. `n` must
/// not be zero and need not be unit.
///
/// For a query in A's frame with one relative pose, pass [`Pose::IDENTITY`] and that pose.
pub fn support_gap(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, n: Point) -> f64 {
    let (gap, norm2) = exact_gap(a, pose_a, b, pose_b, n);
    over_root(&gap, &norm2)
}

/// Returns whether the direction `n` proves `lower`: the exact gap along it is at least `lower`.
pub fn proves(lower: f64, a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, n: Point) -> bool {
    if lower == f64::NEG_INFINITY {
        return true;
    }
    let (gap, norm2) = exact_gap(a, pose_a, b, pose_b, n);
    let lower = exact(lower);
    let signed_square = |x: &RBig| if *x < RBig::ZERO { -(x * x) } else { x * x };
    signed_square(&gap) >= signed_square(&lower) * norm2
}

/// Returns the gap times `|n|`, and `|n|^2`.
fn exact_gap(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, n: Point) -> (RBig, RBig) {
    let upper_a = support(a.points, pose_a, n);
    let lower_b = -support(b.points, pose_b, n.map(|x| -x));
    let norm2 = n.iter().fold(RBig::ZERO, |s, &x| s + exact(x) * exact(x));
    assert!(!norm2.is_zero(), "a direction is not zero");
    (lower_b - upper_a, norm2)
}

/// Returns the greatest `n . p` over the points at the pose, exactly.
pub fn support(points: &[Point], pose: &Pose, n: Point) -> RBig {
    // n . (R v + t) = (n R) . v + n . t, with R divided by |q|^2.
    let r = rotation(pose.q);
    let m: [RBig; 3] = std::array::from_fn(|j| (0..3).fold(RBig::ZERO, |s, i| s + exact(n[i]) * &r[i][j]));
    let near = m.each_ref().map(rounded);
    let best = of_candidates(points, |&p| (dot(near, p), scan_error(near, p)), |&p| exact_dot(&m, p));
    best.expect("a body has points") + exact_dot(&pose.t.map(exact), n)
}

fn exact_dot(m: &[RBig; 3], p: Point) -> RBig {
    &m[0] * exact(p[0]) + &m[1] * exact(p[1]) + &m[2] * exact(p[2])
}

fn scan_error(m: Point, p: Point) -> f64 {
    // The least normal number covers products that underflow.
    SLACK * (0..3).map(|i| (m[i] * p[i]).abs()).sum::<f64>() + f64::MIN_POSITIVE
}

/// Returns the greatest exact value. Evaluates only items that value and error of the scan do not
/// rule out.
fn of_candidates<T>(items: &[T], scan: impl Fn(&T) -> (f64, f64), value: impl Fn(&T) -> RBig) -> Option<RBig> {
    let low = items
        .iter()
        .map(&scan)
        .map(|(v, e)| v - e)
        .fold(f64::NEG_INFINITY, f64::max);
    let may_win = |i: &&T| {
        let (v, e) = scan(i);
        // Written so that overflow (infinity, NaN) keeps the candidate.
        let cannot = v + e < low;
        !cannot
    };
    items.iter().filter(may_win).map(value).max()
}

/// Returns the distance of two points, each in its body's frame, at the poses of the bodies,
/// correctly rounded.
///
/// It is an upper bound of the distance of the bodies if the points lie in them.
pub fn witness_distance(on_a: Point, pose_a: &Pose, on_b: Point, pose_b: &Pose) -> f64 {
    let (p, q) = (&placed(&[on_a], pose_a)[0], &placed(&[on_b], pose_b)[0]);
    sqrt(&(0..3).map(|i| &p[i] - &q[i]).fold(RBig::ZERO, |s, d| s + &d * &d)).0
}

/// Returns the height of a point above the worst face plane of a body, in the body's frame,
/// correctly rounded.
///
/// It is not positive inside. The distance from the body is at least this height, and zero if this
/// is not positive.
///
/// Faces should be planar: each plane passes through the first vertex, with the normal of the exact
/// area vector.
pub fn outside_by(point: Point, body: Body) -> f64 {
    let height = |f: &Face| {
        let (height, norm2) = plane_height(point, body.points, f);
        over_root(&height, &norm2)
    };
    highest_faces(point, body)
        .into_iter()
        .map(height)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the 32 faces whose planes are the highest below the point, by a scan in `f64`.
fn highest_faces<'a>(point: Point, body: Body<'a>) -> Vec<&'a Face> {
    let height = |f: &Face| {
        let c = |i: usize| body.points[f[i] as usize];
        let fan = (2..f.len()).map(|i| cross(sub(c(i - 1), c(0)), sub(c(i), c(0))));
        let n = fan
            .reduce(|s, x| std::array::from_fn(|i| s[i] + x[i]))
            .expect("a face has three corners");
        let h = dot(n, sub(point, c(0))) / dot(n, n).sqrt();
        if h.is_nan() { f64::INFINITY } else { h } // a face too small for f64 is evaluated exactly
    };
    let mut faces: Vec<(f64, &Face)> = body.faces.iter().map(|f| (height(f), f)).collect();
    faces.sort_by(|x, y| y.0.total_cmp(&x.0));
    faces.into_iter().take(32).map(|(_, f)| f).collect()
}

/// Returns the exact height of a point above the plane of a face, times the length of the normal,
/// and that length squared.
fn plane_height(point: Point, points: &[Point], face: &Face) -> (RBig, RBig) {
    let at = |i: u32| points[i as usize].map(exact);
    let base = at(face[0]);
    let from_base = |p: [RBig; 3]| -> [RBig; 3] { std::array::from_fn(|i| &p[i] - &base[i]) };
    let rim: Vec<[RBig; 3]> = face.iter().map(|&i| from_base(at(i))).collect();
    let mut n = [RBig::ZERO; 3];
    for w in rim.windows(2) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            n[i] += &w[0][j] * &w[1][k] - &w[0][k] * &w[1][j];
        }
    }
    let p = from_base(point.map(exact));
    let dot = |a: &[RBig; 3], b: &[RBig; 3]| (0..3).fold(RBig::ZERO, |s, i| s + &a[i] * &b[i]);
    (dot(&n, &p), dot(&n, &n))
}

/// Result of [`check`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checked {
    /// Exact gap along the normal: a proven lower bound.
    pub lower: f64,
    /// Exact distance of the witness points.
    pub upper: f64,
    /// The larger of both witnesses' [`outside_by`].
    pub outside: f64,
}

impl Checked {
    /// Returns whether `lower` and `upper` differ by at most `width`, and `outside` is at most
    /// `width`.
    ///
    /// The true signed distance of separated bodies lies in `lower ..= upper + 2 outside`, if faces
    /// are planar and meet at no needle-sharp edges.
    pub fn within(&self, width: f64) -> bool {
        self.upper - self.lower <= width && self.outside <= width
    }
}

/// Checks the whole outcome of a separated pair: normal in the world frame, witnesses in the frames
/// of their bodies.
///
/// Both bodies must have faces.
pub fn check(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose, normal: Point, on_a: Point, on_b: Point) -> Checked {
    Checked {
        lower: support_gap(a, pose_a, b, pose_b, normal),
        upper: witness_distance(on_a, pose_a, on_b, pose_b),
        outside: outside_by(on_a, a).max(outside_by(on_b, b)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{ContactState, distance_to_body, solve};
    use crate::rng::Rng;
    use crate::shapes;

    const STILL: Pose = Pose::IDENTITY;

    #[test]
    fn gaps_of_boxes_by_hand() {
        let s = shapes::cuboid([0.5; 3]);
        let unit = Body::from(&s);
        let gap = |t, n| support_gap(unit, &STILL, unit, &Pose::shift(t), n);
        assert_eq!(gap([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 2.0);
        assert_eq!(gap([3.0, 0.0, 0.0], [7.0, 0.0, 0.0]), 2.0, "of any length");
        assert_eq!(gap([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), -4.0);
        assert_eq!(gap([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 0.0);
        assert_eq!(gap([4.0, 5.0, 0.0], [3.0, 4.0, 0.0]), 5.0);
        let hair = support_gap(
            unit,
            &Pose::shift([-1.0, 0.0, 0.0]),
            unit,
            &Pose::shift([1e-15, 0.0, 0.0]),
            [1.0, 0.0, 0.0],
        );
        assert_eq!(hair, 1e-15);
    }

    #[test]
    fn a_bound_one_bit_too_high_is_not_proved() {
        let s = shapes::cuboid([0.5; 3]);
        let unit = Body::from(&s);
        let proved = |lower, n| proves(lower, unit, &STILL, unit, &Pose::shift([3.0, 0.0, 0.0]), n);
        assert!(proved(2.0, [1.0, 0.0, 0.0]) && proved(f64::NEG_INFINITY, [0.0, 1.0, 0.0]));
        assert!(!proved(2.0f64.next_up(), [1.0, 0.0, 0.0]));
        assert!(!proved(2.0, [1.0, 1e-20, 0.0]));
        assert!(proved(-4.0, [-1.0, 0.0, 0.0]) && !proved((-4.0f64).next_up(), [-1.0, 0.0, 0.0]));
    }

    #[test]
    fn no_direction_beats_the_oracle() {
        let mut r = Rng::new(31);
        for _ in 0..30 {
            let (a, b) = (shapes::sphere(&mut r, 7).solved(), shapes::sphere(&mut r, 6).solved());
            let pa = Pose::new(r.quat(), [0.0; 3]);
            let pb = Pose::new(r.quat(), r.unit().map(|x| 1.5 * x));
            let e = solve((&a).into(), &pa, (&b).into(), &pb);
            for _ in 0..30 {
                let n = r.unit();
                assert!(support_gap((&a).into(), &pa, (&b).into(), &pb, n) <= e.distance);
            }
            assert!(e.state != ContactState::Touching);
        }
    }

    #[test]
    fn the_scan_hides_no_candidate() {
        let mut r = Rng::new(32);
        for s in [
            shapes::sphere(&mut r, 3000),
            shapes::chamfered([1.0; 3], 1e-16),
            shapes::dome(8, 1e-15),
            shapes::grid(5),
        ] {
            let pose = Pose::new(r.quat(), r.unit());
            for n in [r.unit(), [0.0, 0.0, 1.0], pose.rotate([0.0, 0.0, 1.0])] {
                let all = placed(&s.points, &pose);
                let most = all.iter().map(|p| exact_dot(p, n)).max().unwrap();
                assert_eq!(support(&s.points, &pose, n), most, "{}", s.name);
            }
        }
    }

    #[test]
    fn heights_over_faces() {
        let s = shapes::cuboid([0.5; 3]);
        let unit = Body::from(&s);
        assert_eq!(outside_by([0.0; 3], unit), -0.5);
        assert_eq!(outside_by([0.5, 0.1, 0.2], unit), 0.0);
        assert_eq!(outside_by([0.5f64.next_up(), 0.0, 0.0], unit), 0.5f64.next_up() - 0.5);
        assert_eq!(outside_by([2.0, 1.0, 0.0], unit), 1.5);
        let mut r = Rng::new(33);
        for _ in 0..50 {
            let body = shapes::small(&mut r);
            let p = r.unit();
            let low = outside_by(p, (&body).into());
            let true_one = distance_to_body(p, (&body).into(), &STILL);
            assert!(
                low <= true_one || true_one == 0.0 && low <= 0.0,
                "{}: {low} {true_one}",
                body.name
            );
            assert_eq!(low > 0.0, true_one > 0.0);
        }
    }

    #[test]
    fn a_right_answer_passes_and_a_wrong_one_does_not() {
        let s = shapes::cuboid([0.5; 3]);
        let (unit, there) = (Body::from(&s), Pose::shift([3.0, 0.0, 0.0]));
        let ask = |n, p, q| check(unit, &STILL, unit, &there, n, p, q);
        assert!(ask([1.0, 0.0, 0.0], [0.5, 0.25, 0.0], [-0.5, 0.25, 0.0]).within(0.0));
        assert!(
            !ask([1.0, 0.1, 0.0], [0.5, 0.25, 0.0], [-0.5, 0.25, 0.0]).within(1e-3),
            "a wrong normal"
        );
        assert!(
            !ask([1.0, 0.0, 0.0], [0.5, 0.25, 0.0], [-0.5, 0.5, 0.0]).within(1e-3),
            "not closest"
        );
        assert!(
            !ask([1.0, 0.0, 0.0], [0.6, 0.25, 0.0], [-0.6, 0.25, 0.0]).within(1e-3),
            "off the bodies"
        );
    }
}
