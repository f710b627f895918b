//! Bowls against heights in twice the digits, and against surfaces that are closer than they look.

#![cfg(test)]

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3};

use super::*;
use crate::base::num::double_double::DoubleDouble as Wide;
use crate::base::num::scalar::Scalar;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::patch::closest::{Meeting, PatchPair};
use crate::patch::gap::{SearchCounts, Trees};
use crate::patch::net::Patch;
use crate::patch::surface::Surface;
use crate::patch::tree::{Grown, Nodes};
use crate::rng::Rng;

/// Returns a value of a patch in twice the digits, from its numbers as they are stored.
fn exact(patch: &Patch, at: [f64; 2]) -> [Wide; 4] {
    let curve = |mut c: Vec<[Wide; 4]>, t: f64| {
        let (t, s) = (Wide::from(t), Wide::from(1.0) - Wide::from(t));
        while c.len() > 1 {
            let mixed = |w: &[[Wide; 4]]| [0, 1, 2, 3].map(|k| w[0][k] * s + w[1][k] * t);
            c = c.windows(2).map(mixed).collect();
        }
        c[0]
    };
    let wide = |h: &[f64; 4]| h.map(Wide::from);
    let rows = patch.net.chunks(patch.degrees[1] + 1);
    curve(
        rows.map(|r| curve(r.iter().map(wide).collect(), at[1])).collect(),
        at[0],
    )
}

/// Returns the height of a point above a bowl, in twice the digits.
fn height(half: &BowlSide, h: &[Wide; 4]) -> Wide {
    let x = [0, 1, 2].map(|k| h[k] / h[3] - Wide::from(half.at[k]));
    let dot = |n: &Vector3<f64>| (0..3).fold(Wide::from(0.0), |s, k| s + Wide::from(n[k]) * x[k]);
    let s = [dot(&half.e[0]), dot(&half.e[1])];
    let form = |i: usize, j: usize| Wide::from(0.5 * half.form[(i, j)]) * s[i] * s[j];
    dot(&half.n) + form(0, 0) + form(0, 1) + form(1, 0) + form(1, 1)
}

fn unit(rng: &mut Rng) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| rng.range(-1.0, 1.0));
        if v.norm_squared() > 0.1 && v.norm_squared() < 1.0 {
            return v / sqrt(v.norm_squared());
        }
    }
}

/// Control points over a square of size 2 at a place, with weights.
fn patch(rng: &mut Rng, off: &Vector3<f64>) -> Patch {
    let [p, q] = [1 + rng.below(3), 1 + rng.below(3)];
    let at = |k: usize, d: usize| 2.0 * k as f64 / d as f64 - 1.0;
    let grid = (0..(p + 1) * (q + 1)).map(|k| [at(k / (q + 1), p), at(k % (q + 1), q)]);
    let points: Vec<Point3<f64>> = grid
        .map(|[x, y]| Point3::from(off + Vector3::new(x, y, rng.range(-0.4, 0.4))))
        .collect();
    let weights: Vec<f64> = points.iter().map(|_| rng.range(0.4, 2.0)).collect();
    if rng.chance(0.7) {
        Patch::rational([p, q], &points, &weights).expect("a patch")
    } else {
        Patch::polynomial([p, q], &points).expect("a patch")
    }
}

/// Returns the bound of a random node above a random bowl, less the greatest height found of the
/// patch itself, in the size of the pair.
fn excess(rng: &mut Rng, far: f64) -> Option<f64> {
    let off = unit(rng) * far;
    let patch = patch(rng, &off);
    let surface = Surface::new(vec![patch.clone()]).expect("a surface");
    let mut grown = Grown::default();
    let mut nodes = Nodes::new(&surface.tree, &mut grown);
    let mut id = 0;
    for _ in 0..rng.below(14) {
        id = nodes.split(id) + rng.below(2) as u32;
    }
    let node = nodes.node(id);
    let [u, v] = node.domain();
    let inside = |rng: &mut Rng, [low, high]: [f64; 2]| low + (high - low) * rng.uniform();
    let at = patch.point(inside(rng, u), inside(rng, v)).coords;
    let n = unit(rng);
    let (a, b, c) = (rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
    // From a form that hardly matters to the steepest that is looked at.
    let form = Matrix2::new(a, b, b, c) * rng.log_range(0.1, 6.0);
    let length = sqrt(form.norm_squared()) * ROUND_UP;
    let half = BowlSide {
        n,
        e: tangents(&n),
        at,
        form,
        length,
    };
    if !half.is_near(node) {
        return None;
    }
    let bound = half.highest(node, &nodes.net(id))?;
    // The best of a grid, then of ever smaller steps about it.
    let at = |[x, y]: [f64; 2]| [u[0] + (u[1] - u[0]) * x, v[0] + (v[1] - v[0]) * y];
    let of = |p: [f64; 2]| height(&half, &exact(&patch, at(p)));
    let (mut best, mut place) = (of([0.0; 2]), [0.0; 2]);
    let mut step = 0.25;
    let mut around: Vec<[f64; 2]> = (0..25)
        .map(|k| [0.25 * (k / 5) as f64, 0.25 * (k % 5) as f64])
        .collect();
    while step > 1e-8 {
        let before = place;
        for p in around {
            let h = of(p);
            if (h - best).value() > 0.0 {
                (best, place) = (h, p);
            }
        }
        if place == before {
            step *= 0.25;
        }
        let moved = |x: f64, d: f64| (x + d * step).clamp(0.0, 1.0);
        let eight = [-1.0, 0.0, 1.0]
            .into_iter()
            .flat_map(|d| [-1.0, 0.0, 1.0].map(|f| [d, f]));
        around = eight.map(|[d, f]| [moved(place[0], d), moved(place[1], f)]).collect();
    }
    Some((Wide::from(bound) - best).value() / (1.0 + far))
}

/// Bounds hold to the last bit, near the origin and far from it; and they are bounds worth the
/// name, so that one that is lower by 1e-9 of the size fails.
#[test]
fn heights_above_a_bowl_hold() {
    for far in [0.0, 10.0, 1e6] {
        let (mut tight, mut least) = (0, f64::INFINITY);
        for k in 0..600 {
            let Some(over) = excess(&mut Rng::of_case(71, k), far) else {
                continue;
            };
            least = least.min(over);
            assert!(over >= 0.0, "case {k}, {far} off: the bound is {over:e} too low");
            tight += u32::from(over < 4096.0 * UNIT);
        }
        assert!(tight > 40, "{tight} of all are tight at {far}");
    }
}

fn one(points: Vec<Point3<f64>>) -> Surface {
    Surface::new(vec![Patch::polynomial([2, 2], &points).expect("a patch")]).expect("a surface")
}

/// Heights `bend (x^2 + y^2) / 2 + z` over a square.
fn dish(size: f64, bend: f64, z: f64) -> Surface {
    // The blossom of the square of a coordinate between -size and size.
    let square = |k: usize| [1.0, -1.0, 1.0][k] * size * size;
    let at = |k: usize| {
        let (i, j) = (k / 3, k % 3);
        let [x, y] = [i, j].map(|i| (i as f64 - 1.0) * size);
        Point3::new(x, y, 0.5 * bend * (square(i) + square(j)) + z)
    };
    one((0..9).map(at).collect())
}

fn meeting(a: &Surface, b: &Surface, frame: &NetFrame) -> Meeting {
    let pair = PatchPair {
        a: &a.patches[0],
        b: &b.patches[0],
        frame,
    };
    pair.descend([0, 0], [0.5; 4]).0
}

/// One dish in another, so little flatter that the point below is no closest point: the graph
/// of no form proves the distance of both lowest points, whatever its curvature. The terms by
/// the square of the form refuse it.
#[test]
fn a_bowl_knows_that_parallel_surfaces_bend_more() {
    let frame = NetFrame::new(
        [1.0, 1.0],
        0.0,
        &RelativePose::from_isometry(&Isometry3::identity()).expect("a pose"),
    )
    .expect("of a size");
    // Parallel to A at this distance is a surface that bends by 1 / (2 - 0.5) = 0.667.
    let a = dish(0.2, 0.5, 0.0);
    for (bend, holds) in [(0.55, false), (0.62, false), (0.66, false), (0.8, true), (1.0, true)] {
        let b = dish(0.2, bend, 0.5);
        let mut found = 0;
        for k in 0..=20 {
            let n = Vector3::z();
            let form = Matrix2::identity() * (0.5 + (bend - 0.5) * f64::from(k) / 20.0);
            let length = sqrt(form.norm_squared()) * ROUND_UP;
            let bowl = Bowl {
                n,
                e: tangents(&n),
                at: Vector3::zeros(),
                form,
                length,
            };
            let (mut of_a, mut of_b) = (Grown::default(), Grown::default());
            let mut trees = Trees {
                a: Nodes::new(&a.tree, &mut of_a),
                b: Nodes::new(&b.tree, &mut of_b),
                frame: &frame,
                counts: SearchCounts::default(),
            };
            found += u32::from(trees.is_about([0, 0], &bowl, 0.5 - 1e-9));
            assert!(!trees.is_about([0, 0], &bowl, 0.5 + 1e-9), "{bend} {k}");
        }
        assert_eq!(found > 0, holds, "{bend}: {found}");
    }
}

/// The bowl that a search makes proves the distance of a dish in a wider one, and no more.
#[test]
fn a_bowl_proves_a_distance_and_no_more() {
    let mut rng = Rng::new(72);
    let mut proven = 0;
    for _ in 0..200 {
        let (a, b) = (
            dish(0.3, rng.range(-0.8, 0.8), 0.0),
            dish(0.3, rng.range(-0.8, 0.8), rng.range(0.05, 0.5)),
        );
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(unit(&mut rng) * rng.range(0.0, 0.1));
        let shift = unit(&mut rng) * 0.03;
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(shift.into(), turn)).expect("a pose");
        let frame = NetFrame::new([a.reach, b.reach], 0.0, &pose).expect("of a size");
        let found = meeting(&a, &b, &frame);
        let Some(bowl) = &found.bowl else { continue };
        let (mut of_a, mut of_b) = (Grown::default(), Grown::default());
        let mut trees = Trees {
            a: Nodes::new(&a.tree, &mut of_a),
            b: Nodes::new(&b.tree, &mut of_b),
            frame: &frame,
            counts: SearchCounts::default(),
        };
        proven += u32::from(trees.is_about([0, 0], bowl, found.distance - 1e-9));
        assert!(!trees.is_about([0, 0], bowl, found.distance + 1e-12));
    }
    assert!(proven > 30, "{proven}");
}
