//! Polyhedra whose distance or overlap is so small that products and directions underflow: signs are
//! judged by whole numbers.
//!
//! The test `pairs` and the instrument `soak` use this module.

use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, ConvexPolyhedron, RelativePose, Tracker};
use std::cmp::Ordering;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Tips outside and inside of a wall.
        pub tips: [u64; 2],
        /// Pairs that are a few of the least numbers apart, and pairs that touch.
        pub corners: [u64; 2],
    }
}

/// Plays a tip next to a wall and two corners next to each other.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    mix.tips[usize::from(tip(&mut rng)?)] += 1;
    let extents = [0; 2].map(|_| *rng.pick(&EXTENTS));
    mix.corners[usize::from(corners(extents, &mut rng)?)] += 1;
    Ok(mix)
}

/// Judges a tetrahedron that is rotated by almost nothing about two axes, whose tip is as slightly
/// inside or outside a wall. Returns whether the tip is inside.
///
/// The coordinates of an exact direction differ by more than the range of `f64`. Two of them may
/// be rounded to the same size, although one is far above the other, so that the rounded direction
/// rises along an edge that falls.
///
/// # Errors
/// Returns the first wrong answer.
pub fn tip(rng: &mut Rng) -> Result<bool, String> {
    let two = |e: i32| 2f64.powi(e);
    // A cyclic permutation of the axes.
    let first = rng.below(3);
    let place = |p: [f64; 3]| std::array::from_fn::<f64, 3, _>(|k| p[(k + 3 - first) % 3]);
    let solid = |points: &[[f64; 3]]| {
        let points: Vec<_> = points.iter().map(|&p| Point3::from(place(p))).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    };
    // The rounded direction rises along an edge that falls only if the slope is above 1.
    let slope = two(if rng.chance(0.4) {
        1 + rng.below(2) as i32
    } else {
        -(rng.below(120) as i32)
    });
    let ends = [-8.0, 8.0];
    let corners = [-8.0, 0.0].map(|x| ends.map(|y| ends.map(|z| [x, y, z])));
    let a = solid(corners.as_flattened().as_flattened());
    let b = solid(&[[0.0; 3], [0.0, -slope, -1.0], [1.0, 0.5, -0.625], [1.0, -0.5, -0.3125]]);
    // The second vertex of B moves to `x = y - 2 y + 2 slope z`.
    let z = two(-880 - rng.below(60) as i32);
    let y = (2.0 * slope * z * two(rng.below(5) as i32 - 3)) * rng.range(1.1, 1.9);
    let y = if rng.chance(0.6) {
        y
    } else {
        z * two(rng.below(8) as i32 - 6) * rng.range(1.1, 1.9)
    };
    let is_in = slope * two(900) * z * 2.0 <= y * two(900);
    let [i, j, k] = place([0.0, y, z]);
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(1.0, i, j, k));
    let pose = Isometry3::from_parts(Translation3::from(place([y, 0.0, 0.0])), turn);
    let pose = RelativePose::from_isometry(&pose).expect("a pose");
    for (a, b, pose) in [(&a, &b, pose), (&b, &a, pose.swapped())] {
        let mut tracker = Tracker::new();
        let found = [
            tracker.intersects(a, b, &pose),
            Tracker::new().within(a, b, &pose, 0.0),
            Tracker::new().closest_exact(a, b, &pose).state != ContactState::Separated,
            // Warm, after a query that knows only the bounds.
            (tracker.closest(a, b, &pose), tracker.intersects(a, b, &pose)).1,
        ];
        if found != [is_in; 4] {
            return Err(format!(
                "a tip in a wall: {is_in}, not {found:?}, {slope:e} {y:e} {z:e} axis {first}"
            ));
        }
    }
    Ok(is_in)
}

/// Extents of [`corners`].
pub const EXTENTS: [f64; 8] = [1e-31, 1e-33, 1e-60, 1e-95, 1e-100, 1.0, 1e33, 1e98];

/// Returns a tetrahedron with three edges of length `e` along the axes, all ascending or all
/// descending, from a vertex at the origin.
fn corner(e: f64) -> ConvexPolyhedron {
    let o = Point3::origin();
    let points = [
        o,
        Point3::new(e, 0.0, 0.0),
        Point3::new(0.0, e, 0.0),
        Point3::new(0.0, 0.0, e),
    ];
    ConvexPolyhedron::from_points(&points).expect("a corner")
}

/// Returns two such tetrahedra tip to tip, the second moved by `t`, which is the vector between
/// them.
///
/// # Panics
/// Panics if an extent is not that of a body.
pub fn tip_to_tip(extents: [f64; 2], t: [f64; 3]) -> (ConvexPolyhedron, ConvexPolyhedron, RelativePose) {
    let pose = RelativePose::from_isometry(&Isometry3::translation(t[0], t[1], t[2])).expect("a pose");
    (corner(-extents[0]), corner(extents[1]), pose)
}

/// Compares `x`, a small multiple of the least `f64`, with the root of `n` in units of it.
///
/// `None` if `x` is too large to be subnormal.
fn against_root(x: f64, n: u64) -> Option<Ordering> {
    let units = if x <= 0.0 { 0 } else { x.to_bits() };
    (units < 1 << 31).then(|| (units * units).cmp(&n))
}

/// Judges two tetrahedra tip to tip that touch or are a few of the least `f64` apart. Returns
/// whether they touch.
///
/// # Errors
/// Returns the first wrong answer.
pub fn corners(extents: [f64; 2], rng: &mut Rng) -> Result<bool, String> {
    let units = [0; 3].map(|_| rng.below(9) as u64);
    let n = units.iter().map(|u| u * u).sum::<u64>();
    let (a, b, pose) = tip_to_tip(extents, units.map(f64::from_bits));
    let mut t = Tracker::new();
    let is = |holds: bool, what: &str, found: &dyn std::fmt::Debug| {
        let told = || format!("corners of {extents:?}, {units:?} apart: {what} {found:?}");
        if holds { Ok(()) } else { Err(told()) }
    };
    for (k, o) in [t.closest(&a, &b, &pose), t.closest_exact(&a, &b, &pose)]
        .into_iter()
        .enumerate()
    {
        is((o.state == ContactState::Separated) == (n > 0), "contact state", &o)?;
        let low = against_root(o.lower, n);
        is(matches!(low, Some(Ordering::Less | Ordering::Equal)), "lower bound", &o)?;
        // The root of a sum of squares below 2^53 that is not a square is not a whole number.
        is(against_root(o.upper, n) != Some(Ordering::Less), "upper bound", &o)?;
        let is_tight = k == 0 || o.upper.to_bits() <= o.distance.to_bits() + 1;
        is(is_tight, "width", &o)?;
    }
    let d = t.distance(&b, &a, &pose.swapped());
    let low = against_root(d.lower, n);
    is(matches!(low, Some(Ordering::Less | Ordering::Equal)), "lower bound", &d)?;
    is(t.intersects(&a, &b, &pose) == (n == 0), "intersects", &n)?;
    for d in 0..18u64 {
        let found = t.within(&a, &b, &pose, f64::from_bits(d));
        is(found == (d * d >= n), "within", &(d, found))?;
    }
    Ok(n == 0)
}
