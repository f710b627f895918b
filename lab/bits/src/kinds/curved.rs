//! Curved shapes.

use super::WITHIN;
use crate::make::*;
use crate::{Random, Teller};
use lin_canny::nalgebra::Point3;
use lin_canny::{DepthMode, Manifold, ManifoldOptions, PairTracker, QueryOptions, Shape};

fn shape_pair(t: &mut Teller, r: &mut Random, a: &Shape, b: &Shape, frames: u64) {
    let options = ManifoldOptions::default().prediction(0.05);
    let (mut warm, mut manifold) = (PairTracker::new(), Manifold::new());
    let about = [0.7, 1.5, 1.9, 3.0][r.below(4) as usize];
    let mut drift = Drift::new(r, 0.03, about);
    for _ in 0..frames {
        let pose = relative(&drift.next(r));
        t.tell("warm", warm.closest(a, b, &pose));
        t.tell(
            "cold",
            PairTracker::new().closest_with(a, b, &pose, &QueryOptions::default().depth(DepthMode::Local)),
        );
        t.tell("distance", warm.distance(a, b, &pose));
        t.tell("lower", warm.lower_bound(a, b, &pose));
        t.tell("intersects", warm.intersects(a, b, &pose));
        t.tell("within", WITHIN.map(|d| warm.within(a, b, &pose, d)));
        t.tell("manifold", warm.manifold(a, b, &pose, &options, &mut manifold).is_ok());
        t.tell("manifold", &manifold);
    }
}

pub(super) fn curved_pairs(t: &mut Teller, r: &mut Random) {
    let shapes = curved();
    for _ in 0..t.rounds(2) {
        for a in &shapes {
            for b in &shapes {
                shape_pair(t, r, a, b, 8);
            }
            for _ in 0..6 {
                let (p, d) = (Point3::from(in_ball(r) * 1.5), unit(r));
                t.tell(
                    "shape",
                    (
                        a.contains(&p),
                        a.support_height(&d),
                        a.bounding_ball(),
                        a.aabb_at(&isometry(r, 1.0), &mut Default::default()),
                    ),
                );
            }
        }
    }
}
