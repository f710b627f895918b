//! Contacts on ground with ridges and valleys: overlapping bodies always have one, without ghost
//! contacts.

use super::contacts::{check, cuboid, deepest, exact, patches, within};
use super::{mesh, relative};
use lin_canny::nalgebra::Vector3;
use lin_canny::{Compound, ConvexPatches, PairTracker, Shape};
use truth::Pose;
use truth::pose::{quat, quat_mul, sub, unit, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Returns a floor of squares with random heights, as an open mesh.
fn ground(n: usize, amplitude: f64, rng: &mut Rng) -> Soup {
    let m = n + 1;
    let place = |k: usize| [k % m, k / m].map(|i| 2.0 * i as f64 / n as f64 - 1.0);
    let points = (0..m * m).map(|k| {
        let [x, y] = place(k);
        [x, y, amplitude * rng.range(-1.0, 1.0)]
    });
    let points = points.collect();
    let cells = (0..n * n).flat_map(|k| {
        let a = (k / n * m + k % n) as u32;
        let [b, c, d] = [a + 1, a + 1 + m as u32, a + m as u32];
        if (k / n + k % n).is_multiple_of(2) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        }
    });
    Soup::new(points, cells.collect())
}

/// Returns the height of the ground under a point.
fn height(soup: &Soup, x: f64, y: f64) -> f64 {
    let at = |t: usize| {
        let [a, b, c] = soup.corners(t);
        let cross = |p: [f64; 3], q: [f64; 3]| (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x);
        let w = [cross(b, c), cross(c, a), cross(a, b)];
        let sum = w[0] + w[1] + w[2];
        let inside = w.iter().all(|w| *w >= -1e-12);
        inside.then(|| (w[0] * a[2] + w[1] * b[2] + w[2] * c[2]) / sum)
    };
    (0..soup.triangles.len()).find_map(at).unwrap()
}

#[test]
fn a_ball_rolls_over_bumps_without_ghosts_and_always_with_its_deepest_contact() {
    let mut rng = Rng::new(4);
    let soup = ground(10, 0.06, &mut rng);
    let (floor, surface) = (patches(&soup), mesh(&soup));
    let (ball, radius) = (ConvexPatches::from(Shape::ball(0.11).unwrap()), 0.11);
    let speck = Compound::from(Shape::ball(1e-6).unwrap());
    let options = exact(0.01);
    let mut tracker = PairTracker::new();
    let (mut apart, mut deep) = (0, 0);
    for k in 0..600 {
        let angle = 0.013 * f64::from(k);
        let [x, y] = [0.7 * angle.sin(), 0.7 * (1.31 * angle).cos()];
        let depth = if k % 2 == 0 {
            rng.range(0.0, 0.01)
        } else {
            rng.range(-0.02, 0.0)
        };
        let mut t = [x, y, height(&soup, x, y) + 0.2];
        let middle = |t| {
            let at = relative(&Pose::shift(t));
            lin_canny::PairTracker::new().distance(&surface, &speck, &at).value + 1e-6
        };
        // Down until the centre has the required distance from the ground.
        let (mut low, mut high) = (t[2] - 0.2, t[2]);
        for _ in 0..50 {
            t[2] = 0.5 * (low + high);
            *(if middle(t) > radius + depth {
                &mut high
            } else {
                &mut low
            }) = t[2];
        }
        let truth = middle(t) - radius;
        let found = tracker
            .contacts_between(&floor, &ball, &relative(&Pose::shift(t)), &options)
            .to_vec();
        check(&found, [Some(&soup), None], &Pose::shift(t), &format!("ball {k}"));
        assert!((deepest(&found) - truth).abs() < 1e-8, "{k} {truth} {found:?}");
        *(if truth > 0.0 { &mut apart } else { &mut deep }) += 1;
    }
    assert!(apart > 250 && deep > 250, "{apart} {deep}");
}

#[test]
fn a_box_tumbles_over_bumps_without_ghosts() {
    let mut rng = Rng::new(5);
    let soup = ground(10, 0.05, &mut rng);
    let (floor, half) = (patches(&soup), [0.15, 0.1, 0.12]);
    let (cube, solid) = (cuboid(half), soups::plate(1, half));
    let (mut met, mut deep, mut lost) = (0, 0, Vec::new());
    let (mut q, mut tracker) = (rng.quat(), PairTracker::new());
    for k in 0..400u32 {
        q = unit_quat(quat_mul(quat(rng.unit(), 0.03), q));
        let angle = 0.017 * f64::from(k);
        let mut t = [0.6 * angle.sin(), 0.6 * (1.31 * angle).cos(), 0.5];
        let (m, n) = (mesh(&soup), mesh(&solid));
        let distance = |t| PairTracker::new().distance(&m, &n, &relative(&Pose::new(q, t))).value;
        for _ in 0..60 {
            t[2] -= distance(t);
        }
        let gap = [2e-3, 5e-3, -2e-3, -8e-3][k as usize % 4];
        t[2] += gap;
        let pose = Pose::new(q, t);
        let truth = distance(t);
        let found = tracker
            .contacts_between(&floor, &cube, &relative(&pose), &within(0.01))
            .to_vec();
        check(&found, [Some(&soup), None], &pose, &format!("box {k}"));
        if truth > 0.0 {
            let options = exact(0.01);
            let cold = PairTracker::new()
                .contacts_between(&floor, &cube, &relative(&pose), &options)
                .to_vec();
            assert!((deepest(&cold) - truth).abs() < 1e-9, "{k} {truth} {cold:?}");
        } else {
            // Overlaps: no deeper than the descent.
            if found.is_empty() {
                lost.push((k, gap));
                continue;
            }
            assert!(deepest(&found) < 1e-9, "{k} {gap} {found:?}");
            assert!(deepest(&found) > gap - 1e-3, "{k} {gap} {found:?}");
            deep += 1;
        }
        met += 1;
    }
    assert!(lost.is_empty(), "{lost:?}");
    assert!(met == 400 && deep > 150, "{met} {deep}");
}

/// A vertex below both faces of a valley: its foot on the plane of either lies beyond the bottom,
/// where the face ends.
#[test]
fn a_corner_in_a_valley_has_contacts_along_both_of_its_faces() {
    let mut rng = Rng::new(6);
    for rise in [0.05, 0.2, 0.35] {
        // The valley runs along y.
        let ends = |x: f64| [[x, -1.0, rise * x.abs()], [x, 1.0, rise * x.abs()]];
        let soup = Soup::new(
            [-1.0, 0.0, 1.0].into_iter().flat_map(ends).collect(),
            vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]],
        );
        let (floor, cube) = (patches(&soup), cuboid([0.1; 3]));
        let mut tracker = PairTracker::new();
        for k in 0..200 {
            // A vertex of the cube below, next to the bottom line; its edges are steeper than the
            // sides.
            let upright = quat(unit([-1.0, 1.0, 0.0]), 0.955);
            let q = unit_quat(quat_mul(quat(rng.unit(), rng.range(-0.2, 0.2)), upright));
            let depth = 10f64.powf(rng.range(-5.0, -2.0));
            let beside = 0.3 * rise * depth * rng.range(-1.0, 1.0);
            let corner = Pose::new(q, [0.0; 3]).apply([0.1, 0.1, -0.1]);
            let t = sub([beside, rng.range(-0.2, 0.2), -depth], corner);
            let pose = Pose::new(q, t);
            let found = tracker
                .contacts_between(&floor, &cube, &relative(&pose), &exact(1e-3))
                .to_vec();
            let what = format!("{rise} {k} {depth:e}");
            check(&found, [Some(&soup), None], &pose, &what);
            for side in [-1.0, 1.0] {
                let n = Vector3::new(-side * rise, 0.0, 1.0).normalize();
                let below = depth * n.z - beside * n.x;
                let group = found.iter().find(|g| (*g.normal - n).norm() < 1e-9);
                let group = group.unwrap_or_else(|| panic!("{what} {side} {found:?}"));
                let least = group.contacts.iter().map(|c| c.point.separation).fold(0.0, f64::min);
                assert!(least < 0.0, "{what} {side} {below:e} {found:?}");
                assert!(least > -below - 1e-9, "{what} {side} {below:e} {found:?}");
            }
        }
    }
}
