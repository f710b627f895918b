//! Promise: bounds, exact distances and predicates hold for subnormal distances, squares or scaled
//! distances, for extents from 1e-100 to 1e100.
#![cfg(feature = "exact")]

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::{ContactState, ConvexPolyhedron, RelativePose, Tracker};
use std::sync::Arc;
use truth::driven::underflow;
use truth::rng::Rng;

/// Bounds and predicates of bodies of any size hold if the distance is a few units of the least
/// `f64`.
#[test]
fn a_distance_of_a_few_least_numbers_is_bounded() {
    let mut rng = Rng::new(701);
    let mut asked = 0;
    for e in underflow::EXTENTS {
        for f in [e, 1e-33, 1e-100, 1.0] {
            for _ in 0..20 {
                underflow::corners([e, f], &mut rng).unwrap();
                asked += 1;
            }
        }
    }
    assert_eq!(asked, 640);
}

/// A plate and a segment whose distance is less than the least `f64`.
#[test]
fn bodies_apart_by_less_than_the_least_number_do_not_intersect() {
    for side in [1e-30, 1e-33, 1e-60, 1e-98] {
        let square = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| Point3::new(x, y, 0.0));
        let plate = ConvexPolyhedron::polygon(&square).unwrap();
        let p = Point3::new(0.2 * side, 0.3 * side, 0.0);
        let q = Point3::new(0.4 * side, 0.5 * side, 0.0);
        let needle = ConvexPolyhedron::segment(p, q).unwrap();
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(1.0, 1e-300, 0.0, 0.0));
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(Translation3::identity(), turn)).unwrap();
        let mut t = Tracker::new();
        let outcomes = [
            t.closest(&plate, &needle, &pose),
            t.closest_exact(&plate, &needle, &pose),
        ];
        for o in outcomes {
            assert!(o.state == ContactState::Separated, "{side:e} {o:?}");
            assert!(o.lower <= 0.0, "{side:e} {o:?}");
            assert!(o.upper > 0.0, "{side:e} {o:?}");
        }
        assert!(!t.intersects(&plate, &needle, &pose), "{side:e}");
        assert!(t.within(&plate, &needle, &pose, f64::from_bits(1)), "{side:e}");
    }
}

/// The scaled distance of large bodies may be subnormal although it is normal in the caller's unit.
#[test]
fn an_exact_distance_of_large_bodies_is_right_to_the_last_bit() {
    let mut rng = Rng::new(702);
    let mut normal = 0;
    for e in [1e-33, 1.0, 1e32, 1e98] {
        for exponent in [-980, -880, -700, -640, -600, -400] {
            for _ in 0..10 {
                // A distance that `f64` can represent: 2^2 + 3^2 + 6^2 = 7^2.
                let m = (1 + rng.below(1 << 40)) as f64 * 2f64.powi(exponent - 40);
                let (a, b, pose) = underflow::tip_to_tip([e, e], [2.0 * m, 3.0 * m, 6.0 * m]);
                let o = Tracker::new().closest_exact(&a, &b, &pose);
                let near = |x: f64| (x.to_bits() as i64 - (7.0 * m).to_bits() as i64).abs() <= 1;
                assert!(near(o.distance), "{e:e} {m:e} {o:?}");
                assert!(o.lower <= 7.0 * m, "{e:e} {m:e} {o:?}");
                assert!(7.0 * m <= o.upper, "{e:e} {m:e} {o:?}");
                let is_close = (o.upper.to_bits() - o.lower.to_bits()) <= 2;
                assert!(is_close, "{e:e} {m:e} {o:?}");
                normal += usize::from(m.is_normal());
            }
        }
    }
    assert_eq!(normal, 240);
}

/// The exact depth of overlapping bodies of any size.
#[test]
fn a_shallow_depth_is_bounded_in_the_callers_unit() {
    for e in [1e-100, 1e-60, 1e-33, 1.0, 1e33, 1e98] {
        // Plates whose faces meet in a square, one a few of the last bits into the other.
        let square = [[-e, -e], [e, -e], [e, e], [-e, e]];
        let points: Vec<_> = square
            .iter()
            .flat_map(|&[x, y]| [Point3::new(x, y, 0.0), Point3::new(x, y, e)])
            .collect();
        let block = ConvexPolyhedron::from_points(&points).unwrap();
        let below: Vec<_> = points.iter().map(|p| Point3::new(p.x, p.y, -p.z)).collect();
        let below = ConvexPolyhedron::from_points(&below).unwrap();
        for depth in [f64::from_bits(1), f64::from_bits(7), 1e-310, 1e-200] {
            let pose = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, -depth)).unwrap();
            let o = Tracker::new().closest(&below, &block, &pose);
            assert_eq!(o.state, ContactState::Overlapping, "{e:e} {o:?}");
            assert!(o.lower <= -depth, "{e:e} {depth:e} {o:?}");
            assert!(-depth <= o.upper, "{e:e} {depth:e} {o:?}");
            assert!(o.upper <= 0.0, "{e:e} {depth:e} {o:?}");
        }
    }
}

/// Returns whether a length is at most `d`, for numbers whose squares leave the range; `None` if
/// rounding may decide.
fn is_within(t: [f64; 3], d: f64) -> Option<bool> {
    let up = 2f64.powi(500);
    let [x, y, z] = t.map(|c| c * up);
    let (squared, allowed) = (x * x + y * y + z * z, d * up * (d * up));
    let is_clear = (squared - allowed).abs() > 1e-12 * allowed;
    is_clear.then_some(squared < allowed)
}

/// Returns points whose squared distance is subnormal.
fn near_points(rng: &mut Rng) -> ([f64; 3], f64) {
    let size = 10f64.powf(rng.range(-165.0, -153.0));
    let t = [0; 3].map(|_| size * rng.range(-1.0, 1.0));
    let length = t.iter().map(|c| c / size * (c / size)).sum::<f64>().sqrt() * size;
    let off = *rng.pick(&[1e-9, 1e-6, 1e-4, 1e-2, 0.3]);
    (t, length * (1.0 + off * rng.range(-1.0, 1.0)))
}

#[test]
fn points_whose_squared_distance_is_subnormal_are_within_as_they_are() {
    let point = ConvexPolyhedron::point(Point3::origin()).unwrap();
    let known = (
        [3.560677907904087e-161, 1.2480818310921172e-161, 3.6660995865690815e-161],
        5.260843749100646e-161,
    );
    let mut rng = Rng::new(703);
    let mut found = [0; 2];
    for k in 0..40_000 {
        let (t, d) = if k == 0 { known } else { near_points(&mut rng) };
        let Some(truth) = is_within(t, d) else { continue };
        let pose = RelativePose::from_isometry(&Isometry3::translation(t[0], t[1], t[2])).unwrap();
        assert_eq!(Tracker::new().within(&point, &point, &pose, d), truth, "{t:?} {d:e}");
        found[usize::from(truth)] += 1;
    }
    assert!(found.iter().all(|&n| n > 10_000), "{found:?}");
}

#[test]
fn a_scene_of_such_points_finds_them_within() {
    let point = Arc::new(ConvexPolyhedron::point(Point3::origin()).unwrap());
    let mut rng = Rng::new(704);
    let mut found = [0; 2];
    let group = Group::default();
    for _ in 0..3000 {
        let (t, d) = near_points(&mut rng);
        let Some(truth) = is_within(t, d) else { continue };
        let mut scene = Scene::new();
        let queries = PairQueries::none().within(d);
        scene.set_queries(group, group, queries).unwrap();
        let at = |t: [f64; 3]| Isometry3::translation(t[0], t[1], t[2]);
        let a = scene.insert(Body::moving(point.clone()), at([0.0; 3])).unwrap();
        scene.insert(Body::moving(point.clone()), at(t)).unwrap();
        scene.step();
        let told = scene.pairs().find(|p| p.a == a).and_then(|p| p.within);
        assert_eq!(told, Some(truth), "{t:?} {d:e}");
        found[usize::from(truth)] += 1;
    }
    assert!(found.iter().all(|&n| n > 500), "{found:?}");
}
