//! Regions: boxes of parameters around the closest points of two patches, proven far enough apart
//! at once.
//!
//! Nodes are made by repeated halving. So if the closest points lie near a border of a half, many
//! small pairs of nodes meet there. A box of parameters with the closest points in its middle is
//! therefore cut out of each patch by de Casteljau's algorithm. The part is bounded like a node: by
//! second derivatives along the normal, or by a separating quadric. Pairs of nodes inside the boxes
//! then need no proof. Pairs outside are so much farther apart that their planes stay valid for
//! some frames.

use nalgebra::Vector3;

use super::bowl::Bowl;
use super::closest::{Meeting, Meets};
use super::gap::Trees;
use super::height::NetSide;
use super::height::taylor;
use super::tree::Cut;
use super::tree::Node;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{BENT_POSE, REGION};

/// Boxes of parameters whose parts are proven `target` apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    patches: [u32; 2],
    /// Of u and v on A, then on B.
    sides: [[f64; 2]; 4],
    pub(super) target: f64,
}

impl Region {
    /// Returns whether a pair of nodes lies in the boxes.
    #[inline]
    pub(super) fn covers(&self, x: &Node, y: &Node) -> bool {
        let within = |[low, high]: [f64; 2], [from, to]: [f64; 2]| low <= from && to <= high;
        let inside = |node: &Node, sides: [[f64; 2]; 2]| {
            let [u, v] = node.domain();
            within(sides[0], u) && within(sides[1], v)
        };
        let [u, v, s, t] = self.sides;
        self.patches == [x.patch(), y.patch()]
            && !x.is_group()
            && !y.is_group()
            && inside(x, [u, v])
            && inside(y, [s, t])
    }

    /// Returns the boxes around two close points, if both parts are proven at least `target` apart.
    /// The parts extend about `way` along the surfaces.
    pub(super) fn about<B: NetSide, M: Meets>(
        best: &Meeting,
        way: f64,
        target: f64,
        points: &M,
        trees: &mut Trees<'_, B>,
    ) -> Option<Self> {
        let n = best.along?;
        let sides = core::array::from_fn(|k| {
            let length = sqrt(best.tangents[k].norm_squared());
            // A parameter that moves no point may take any value.
            let half = if way < length { way / length } else { 1.0 };
            [(best.at[k] - half).at_least(0.0), (best.at[k] + half).at_most(1.0)]
        });
        let [u, v, s, t] = sides;
        let a = points.cut(0, best.patches[0], [u, v])?;
        let b = points.cut(1, best.patches[1], [s, t]);
        let is_proven = is_apart(&a, b.as_ref(), &n, target, trees)
            || match (&best.bowl, &b) {
                (Some(bowl), Some(b)) => is_about([&a, b], bowl, target, trees),
                _ => false,
            };
        // The ends of the boxes have rounding errors.
        let inner = |[low, high]: [f64; 2]| {
            let low = if low > 0.0 { low + REGION } else { low };
            [low, if high < 1.0 { high - REGION } else { high }]
        };
        let mut sides = sides.each(inner);
        if b.is_none() {
            (sides[2], sides[3]) = ([0.0, 1.0], [0.0, 1.0]);
        }
        let patches = best.patches;
        is_proven.then_some(Self { patches, sides, target })
    }
}

/// Returns whether planes and second derivatives prove two parts apart; without `b`, A's part and
/// all of B.
fn is_apart<B: NetSide>(a: &Cut, b: Option<&Cut>, n: &Vector3<f64>, target: f64, trees: &mut Trees<'_, B>) -> bool {
    trees.counts.caps += 1;
    let frame = trees.frame;
    let m = -frame.direction_in_b(n);
    let high_a = a.net().highest(n);
    let (high_b, error_b) = match b {
        Some(b) => (b.net().highest(&m), b.node.error),
        None => (trees.b.highest(0, &m), trees.b.node(0).error),
    };
    let most = n.dot(&frame.translation) - frame.error - a.node.error - error_b;
    let need = target - (most - high_b - high_a);
    let top = |part: &Cut, n: &Vector3<f64>, highest: f64| {
        let of = taylor(&part.node, &part.net(), n, highest, need);
        of.unwrap_or(highest).smaller(highest)
    };
    let top_a = top(a, n, high_a);
    let top_b = b.map_or(high_b, |b| top(b, &m, high_b));
    most - top_b - top_a >= target
}

/// Returns whether a separating quadric proves two parts apart.
fn is_about<B: NetSide>([a, b]: [&Cut; 2], bowl: &Bowl, target: f64, trees: &mut Trees<'_, B>) -> bool {
    let (of_a, of_b) = (bowl.of_a(target), bowl.of_b(target, trees.frame));
    if !of_a.is_near(&a.node) || !of_b.is_near(&b.node) {
        return false;
    }
    let most = -target - BENT_POSE * trees.frame.error;
    let (least_a, least_b) = (of_a.least(&a.node, &a.net()), of_b.least(&b.node, &b.net()));
    if !(least_a + least_b <= most) {
        return false;
    }
    trees.counts.bowls += 1;
    let Some(high_a) = of_a.highest(&a.node, &a.net()) else {
        return false;
    };
    let Some(high_b) = of_b.highest(&b.node, &b.net()) else {
        return false;
    };
    -high_a - high_b - BENT_POSE * trees.frame.error >= target
}

#[cfg(test)]
mod tests {
    //! Tests regions against the points of their boxes.

    use alloc::vec;
    use alloc::vec::Vec;
    use nalgebra::{Isometry3, Point3, UnitQuaternion};

    use super::*;
    use crate::base::pose::RelativePose;
    use crate::rng::Rng;
    use crate::surface::bezier_surface::BezierSurface;
    use crate::surface::closest::Patches;
    use crate::surface::gap::NetFrame;
    use crate::surface::gap::SearchWork;
    use crate::surface::net::BezierPatch;
    use crate::surface::tree::{Grown, Nodes};

    /// Returns a patch over a square of size 2.
    fn patch(rng: &mut Rng) -> BezierPatch {
        let [p, q] = [1 + rng.below(3), 1 + rng.below(3)];
        let at = |k: usize, d: usize| 2.0 * k as f64 / d as f64 - 1.0;
        let bump = rng.range(0.1, 0.8);
        let points: Vec<_> = (0..(p + 1) * (q + 1))
            .map(|k| Point3::new(at(k / (q + 1), p), at(k % (q + 1), q), bump * rng.range(-1.0, 1.0)))
            .collect();
        let weights: Vec<f64> = points.iter().map(|_| rng.range(0.4, 2.0)).collect();
        if rng.chance(0.5) {
            BezierPatch::rational([p, q], &points, &weights).expect("a patch")
        } else {
            BezierPatch::polynomial([p, q], &points).expect("a patch")
        }
    }

    /// Returns the smallest distance found between points of the boxes.
    fn least(rng: &mut Rng, [a, b]: [&BezierPatch; 2], sides: &[[f64; 2]; 4], frame: &NetFrame) -> f64 {
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
            let surfaces = [patch(rng), patch(rng)].map(|p| BezierSurface::new(vec![p]).expect("a surface"));
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
                counts: SearchWork::default(),
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
}
