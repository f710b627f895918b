//! Trackers that were used for other bodies: their results are those of new trackers, for any
//! numbers of the bodies.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{Compound, Decision, PairTracker, QueryOptions, Shape};
use truth::rng::Rng;
use truth::support::Decide;
use truth::support::piece_at;

use crate::bodies::{place, pose, sphere};
use crate::random::{KINDS, surface};
use crate::shapes::kinds;

const WIDTH: f64 = 1e-6;

/// Returns the surface with one number of one control point changed by thousandths to tenths.
fn changed(rng: &mut Rng, s: &BezierSurface) -> BezierSurface {
    let mut patches = s.patches().to_vec();
    let which = rng.below(patches.len());
    let (mut points, weights): (Vec<Point3<f64>>, Vec<f64>) = patches[which].control_points().unzip();
    let (at, axis) = (rng.below(points.len()), rng.below(3));
    points[at][axis] += rng.log_range(1e-3, 0.3);
    patches[which] = BezierPatch::rational(patches[which].degrees(), &points, &weights).expect("a patch");
    BezierSurface::new(patches).expect("a surface")
}

/// Returns a random surface and another: slightly different, or of any kind.
fn two(rng: &mut Rng) -> [BezierSurface; 2] {
    let kind = rng.below(KINDS.len());
    let first = surface(rng, KINDS[kind]);
    let other = if rng.chance(0.5) {
        changed(rng, &first)
    } else {
        let kind = rng.below(KINDS.len());
        surface(rng, KINDS[kind])
    };
    [first, other]
}

#[test]
fn surfaces_of_every_kind_share_a_tracker() {
    let mut shared = PairTracker::new();
    for k in 0..40 {
        let mut rng = Rng::of_case(61, k);
        let ([a, c], [b, d]) = (two(&mut rng), two(&mut rng));
        let apart = rng.range(0.5, 3.5);
        let at = pose(&place(&mut rng, apart));
        for (x, y) in [(&a, &b), (&c, &d), (&a, &d), (&c, &b)] {
            let o = shared.closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            let cold = PairTracker::new().closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            assert_eq!(o, cold, "{k}");
            let within = shared.decide(&d, &c, &at, o.distance);
            assert_eq!(within, PairTracker::new().decide(&d, &c, &at, o.distance), "{k}");
            let meets = shared.decide(y, x, &at, 0.0);
            assert_eq!(meets, PairTracker::new().decide(y, x, &at, 0.0), "{k}");
        }
    }
}

/// Returns a shape and another: with another radius, or of any kind.
fn two_shapes(rng: &mut Rng) -> [Shape; 2] {
    let kinds = kinds();
    let first = rng.pick(&kinds).clone();
    let other = if rng.chance(0.5) {
        first.clone().rounded(rng.log_range(1e-3, 0.3)).expect("a radius")
    } else {
        let others: Vec<_> = kinds.iter().filter(|s| **s != first).collect();
        (*rng.pick(&others)).clone()
    };
    [first, other]
}

#[test]
fn surfaces_and_shapes_of_every_kind_share_a_tracker() {
    let mut shared = PairTracker::new();
    for k in 0..40 {
        let mut rng = Rng::of_case(62, k);
        let ([a, c], [b, d]) = (two(&mut rng), two_shapes(&mut rng));
        let apart = rng.range(0.5, 3.5);
        let at = pose(&place(&mut rng, apart));
        let pairs = [(&a, &b), (&c, &d), (&a, &d), (&c, &b)];
        for (n, (x, y)) in pairs.into_iter().enumerate() {
            let o = shared.closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            let cold = PairTracker::new().closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            assert_eq!(o, cold, "{k}");
            // Neither this pair nor the next.
            let (z, w) = pairs[(n + 2) % 4];
            let within = shared.decide(z, w, &at, o.distance);
            assert_eq!(within, PairTracker::new().decide(z, w, &at, o.distance), "{k}");
        }
    }
}

fn is_consistent(x: Decision, y: Decision) -> bool {
    x.as_bool().is_none() || y.as_bool().is_none() || x == y
}

/// The tracker queries the previously closest piece first, so bounds may differ within their
/// interval.
#[test]
fn surfaces_and_bodies_of_pieces_share_a_tracker() {
    let mut shared = PairTracker::new();
    for k in 0..20 {
        let mut rng = Rng::of_case(63, k);
        let [a, c] = two(&mut rng);
        let bodies: [Compound; 2] = std::array::from_fn(|n| {
            let count = 1 + rng.below(3) + n;
            let pieces = (0..count).map(|_| piece_at(place(&mut rng, 0.8), two_shapes(&mut rng)[1].clone()));
            Compound::new(pieces.collect()).expect("a body")
        });
        let [b, d] = &bodies;
        let apart = rng.range(0.5, 3.5);
        let at = pose(&place(&mut rng, apart));
        for (x, y) in [(&a, b), (&c, d), (&a, d), (&c, b)] {
            let o = shared.closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            let cold = PairTracker::new().closest_with(x, y, &at, &QueryOptions::default().width(WIDTH));
            assert!(o.lower <= cold.upper && cold.lower <= o.upper, "{k}: {o:?} {cold:?}");
            assert!(o.is_converged && cold.is_converged, "{k}: {o:?} {cold:?}");
            let within = shared.decide(&c, d, &at, o.distance);
            let cold = PairTracker::new().decide(&c, d, &at, o.distance);
            assert!(is_consistent(within, cold), "{k}: {within:?} {cold:?}");
        }
    }
}

/// One invertible step of a hash: the next step can undo a change of one number.
fn step(h: u64, x: u64) -> u64 {
    (h ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
}

/// Returns two roofs whose tops differ in x and y so that such hashes collide.
fn roofs_that_collide(rng: &mut Rng) -> [BezierSurface; 2] {
    let made = |top: [f64; 2]| {
        let mut points: Vec<Point3<f64>> = (0..4)
            .map(|k| Point3::new(f64::from(k / 2), f64::from(k % 2), 0.0))
            .collect();
        points[3] = Point3::new(top[0], top[1], 1.0);
        BezierSurface::new(vec![BezierPatch::polynomial([1, 1], &points).expect("a patch")]).expect("a surface")
    };
    let before = [0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0_f64];
    let begun = before.iter().fold(step(1, 9), |h, x| step(h, x.to_bits()));
    let [x, y] = [rng.range(1.0, 2.0), rng.range(1.0, 2.0)];
    loop {
        let other: f64 = rng.range(1.0, 8.0);
        let back = y.to_bits() ^ step(begun, x.to_bits()) ^ step(begun, other.to_bits());
        let back = f64::from_bits(back);
        if (0.5..8.0).contains(&back.abs()) && (back - y).abs() > 0.1 {
            return [made([x, y]), made([other, back])];
        }
    }
}

/// Returns two rounded ellipsoids with colliding hashes: if numbers are combined by `xor`, the
/// radius of the second compensates all other numbers.
fn eggs_that_collide(rng: &mut Rng) -> [Shape; 2] {
    let of = |axes: &Vector3<f64>| {
        [axes.x, axes.y, axes.z, 0.0, 0.0].iter().fold(1, |hash: u64, x| {
            let mixed = (hash ^ x.to_bits()).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            (mixed ^ (mixed >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb)
        })
    };
    let mut axes = || Vector3::from_fn(|_, _| rng.range(0.1, 1.0));
    let (first, radius) = (axes(), 0.25_f64);
    loop {
        let other = axes();
        let bits = (of(&first) ^ of(&other)).rotate_right(17) ^ radius.to_bits();
        let found = f64::from_bits(bits);
        if (1e-3..10.0).contains(&found) {
            let egg = |axes, r| Shape::ellipsoid(axes).and_then(|s| s.rounded(r)).expect("an egg");
            return [egg(first, radius), egg(other, found)];
        }
    }
}

/// Bodies with colliding hashes of invertible steps, found in about a thousand tries: a tracker
/// does not apply claims of one to the other.
#[test]
fn bodies_made_to_be_taken_for_each_other_are_told_apart() {
    let ball = sphere(0.5);
    for k in 0..10 {
        let mut rng = Rng::of_case(64, k);
        let (roofs, eggs) = (roofs_that_collide(&mut rng), eggs_that_collide(&mut rng));
        for _ in 0..5 {
            let apart = rng.range(2.0, 12.0);
            let at = pose(&place(&mut rng, apart));
            let mut shared = PairTracker::new();
            let mut of_eggs = PairTracker::new();
            for roof in &roofs {
                let o = shared.closest_with(&ball, roof, &at, &QueryOptions::default().width(WIDTH));
                let cold = PairTracker::new().closest_with(&ball, roof, &at, &QueryOptions::default().width(WIDTH));
                assert_eq!(o, cold, "{k}");
            }
            for egg in &eggs {
                let o = of_eggs.closest_with(&ball, egg, &at, &QueryOptions::default().width(WIDTH));
                let expected = PairTracker::new().closest_with(&ball, egg, &at, &QueryOptions::default().width(WIDTH));
                assert_eq!(o, expected, "{k}");
            }
        }
    }
}
