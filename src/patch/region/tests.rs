//! Regions against the points of their boxes.

#![cfg(test)]

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, UnitQuaternion};

use super::*;
use crate::base::pose::RelativePose;
use crate::patch::closest::Patches;
use crate::patch::frame::NetFrame;
use crate::patch::gap::SearchCounts;
use crate::patch::net::Patch;
use crate::patch::surface::Surface;
use crate::patch::tree::{Grown, Nodes};
use crate::rng::Rng;

/// Returns a patch over a square of size 2.
fn patch(rng: &mut Rng) -> Patch {
    let [p, q] = [1 + rng.below(3), 1 + rng.below(3)];
    let at = |k: usize, d: usize| 2.0 * k as f64 / d as f64 - 1.0;
    let bump = rng.range(0.1, 0.8);
    let points: Vec<_> = (0..(p + 1) * (q + 1))
        .map(|k| Point3::new(at(k / (q + 1), p), at(k % (q + 1), q), bump * rng.range(-1.0, 1.0)))
        .collect();
    let weights: Vec<f64> = points.iter().map(|_| rng.range(0.4, 2.0)).collect();
    if rng.chance(0.5) {
        Patch::rational([p, q], &points, &weights).expect("a patch")
    } else {
        Patch::polynomial([p, q], &points).expect("a patch")
    }
}

/// Returns the least distance found of two points of the boxes.
fn least(rng: &mut Rng, [a, b]: [&Patch; 2], sides: &[[f64; 2]; 4], frame: &NetFrame) -> f64 {
    let of = |at: &[f64; 4]| {
        let (p, q) = (a.point(at[0], at[1]), b.point(at[2], at[3]));
        (frame.place(&q.coords) - p.coords).norm()
    };
    let any = |rng: &mut Rng| -> [f64; 4] { core::array::from_fn(|k| rng.range(sides[k][0], sides[k][1])) };
    let mut best = any(rng);
    for _ in 0..100 {
        let at = any(rng);
        if of(&at) < of(&best) {
            best = at;
        }
    }
    let mut step = 0.25;
    while step > 1e-9 {
        let before = best;
        for k in 0..16 {
            let mut at = best;
            let way = (sides[k / 4][1] - sides[k / 4][0]) * step * rng.range(-1.0, 1.0);
            at[k / 4] = (at[k / 4] + way).clamp(sides[k / 4][0], sides[k / 4][1]);
            let other = rng.below(4);
            let way = (sides[other][1] - sides[other][0]) * step * rng.range(-1.0, 1.0);
            at[other] = (at[other] + way).clamp(sides[other][0], sides[other][1]);
            if of(&at) < of(&best) {
                best = at;
            }
        }
        if best == before {
            step *= 0.5;
        }
    }
    of(&best)
}

#[test]
fn no_point_of_a_region_is_closer() {
    let (mut proven, mut refused) = (0, 0);
    for k in 0..1500 {
        let rng = &mut Rng::of_case(91, k);
        let surfaces = [patch(rng), patch(rng)].map(|p| Surface::new(vec![p]).expect("a surface"));
        let [a, b] = &surfaces;
        let axis = Vector3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-0.3, 0.3));
        let turn = UnitQuaternion::from_scaled_axis(axis * rng.range(0.0, 3.0));
        let t = Vector3::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5), rng.range(0.3, 2.5));
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(t.into(), turn)).expect("a pose");
        let frame = NetFrame::new([a.reach, b.reach], 0.0, &pose).expect("of a size");
        let (mut of_a, mut of_b) = (Grown::default(), Grown::default());
        let mut trees = Trees {
            a: Nodes::new(&a.tree, &mut of_a),
            b: Nodes::new(&b.tree, &mut of_b),
            frame: &frame,
            counts: SearchCounts::default(),
        };
        let mut points = Patches {
            a: a.patches(),
            b: b.patches(),
            frame: &frame,
        };
        let start = core::array::from_fn(|_| rng.uniform());
        let (best, _) = points.descend([0, 0], start).expect("points");
        if best.distance < 0.01 {
            continue;
        }
        let way = rng.log_range(0.02, 2.0);
        for lower in [1e-9, 1e-3, 0.1] {
            let target = best.distance - lower;
            let Some(region) = Region::about(&best, way, target, &points, &mut trees) else {
                refused += 1;
                continue;
            };
            proven += 1;
            let found = least(rng, [&a.patches()[0], &b.patches()[0]], &region.sides, &frame);
            assert!(found >= target - 1e-13, "case {k}: {found} below {target}: {region:?}");
            assert!(Region::about(&best, way, best.distance + 1e-11, &points, &mut trees).is_none());
        }
    }
    assert!(proven > 300 && refused > 300, "{proven} {refused}");
}
