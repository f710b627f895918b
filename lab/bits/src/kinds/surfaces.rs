//! Bézier and NURBS surfaces.

use crate::make::*;
use crate::{Random, Teller};
use lin_canny::surface::{self, BezierSurface};
use lin_canny::{GeometryRef, PairTracker, QueryOptions};

pub(super) fn surfaces(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(40) {
        let (a, b) = (bumpy(r, [2, 2], k % 2 == 0), bumpy(r, [3, 3], k % 3 == 0));
        for (u, v) in [(0.2, 0.7), (0.0, 1.0), (0.5, 0.3)] {
            let patch = &a.patches()[0];
            t.tell(
                "patch",
                (
                    patch.point(u, v),
                    patch.tangents(u, v),
                    patch.normal(u, v),
                    patch.aabb(),
                ),
            );
        }
        t.tell("surface", (a.aabb(), a.bounding_ball()));
        let mut warm = PairTracker::new();
        let mut drift = Drift::new(r, 0.02, [1.4, 2.4][k as usize % 2]);
        for _ in 0..10 {
            let pose = relative(&drift.next(r));
            t.tell(
                "closest",
                warm.closest_with(&a, &b, &pose, &QueryOptions::default().width(1e-6).splits(3000)),
            );
            t.tell(
                "intersects",
                warm.decide_within(&a, &b, &pose, 0.0, &QueryOptions::default().splits(2000)),
            );
            t.tell(
                "within",
                warm.decide_within(&a, &b, &pose, 0.3, &QueryOptions::default().splits(2000)),
            );
        }
    }
}

pub(super) fn surfaces_mixed(t: &mut Teller, r: &mut Random) {
    let half = 0.5_f64.sqrt();
    let side: &[[f64; 3]] = &[[1.0, 0.0, 1.0], [0.5, 2.0, 1.0]];
    let bowl: &[[f64; 3]] = &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
    let turned = surface::revolution(&[bowl, side]).expect("a surface");
    let flat = BezierSurface::from_convex(&round(r, 12)).expect("a surface");
    let shapes = curved();
    for k in 0..t.rounds(20) {
        let a = [&turned, &flat][k as usize % 2];
        let (body, mesh) = (compound(r), dented(&round(r, 10), 0.9));
        let mut others: Vec<GeometryRef> = shapes.iter().map(GeometryRef::from).collect();
        others.extend([GeometryRef::from(&body), GeometryRef::from(&mesh)]);
        for b in others {
            let mut tracker = PairTracker::new();
            for apart in [2.2, 4.0] {
                let pose = pose(r, apart);
                t.tell(
                    "closest",
                    tracker.closest_with(a, b, &pose, &QueryOptions::default().width(1e-6).splits(2000)),
                );
                t.tell(
                    "within",
                    tracker.decide_within(a, b, &pose, 0.3, &QueryOptions::default().splits(2000)),
                );
            }
        }
    }
}
