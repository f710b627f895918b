//! Times of impact of two moving bodies, ours and parry's casts.
//!
//! Both bodies have radius 1, and B is thrown past A or at it while both turn. `ours` returns a proven
//! bracket of 1e-9, `ours, 5e-3` the bracket of the gap at which parry's sweep stops. Every cast starts
//! cold. Run `cargo bench --bench impact`; the race `impact` has more shapes and counts missed hits.

use common::{chosen, each};
use criterion::{Criterion, criterion_group, criterion_main};
use lin_canny::impact::{Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{ConvexPolyhedron, Tracker};
use truth::casts::{aimed, body};
use truth::contacts::plain;
use truth::parry::casts::{Flight, SLOP, nonlinear, sweep};
use truth::parry::{self, ParryPose};
use truth::rng::Rng;

const THROWS: usize = 200;

fn pose(pose: &Isometry3<f64>) -> ParryPose {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    parry::pose(&truth::Pose {
        q: [q.x, q.y, q.z, q.w],
        t: t.into(),
    })
}

fn impacts(c: &mut Criterion) {
    let turns = [("turn-0.3", 0.3), ("turn-6", 6.0), ("turn-0", 0.0), ("turn-60", 60.0)];
    for &(scene, turn) in chosen(&turns[..2], &turns) {
        for shape in chosen(&["sphere"], &["sphere", "flat", "rods"]) {
            let mut group = c.benchmark_group(format!("impact/{scene}/{shape}"));
            for &n in chosen(&[128], &[8, 128, 512, 2048]) {
                let mut rng = Rng::new(n as u64 ^ 0x19);
                let bodies = [0; 2].map(|_| body(shape, n, &mut rng));
                let throws: Vec<_> = (0..THROWS).map(|_| aimed(&mut rng, (1.0, 1.0), turn)).collect();
                let motions: Vec<[Steady; 2]> = throws.iter().map(|throw| throw.motions()).collect();
                let [a, b] = &bodies;
                for (name, tolerance) in [("ours", 1e-9), ("ours, 5e-3", SLOP)] {
                    each(&mut group, name, n, &motions, |[of_a, of_b]| {
                        let mut tracker = Tracker::new();
                        cast(
                            &mut tracker.pair(a, b),
                            of_a,
                            of_b,
                            0.0..1.0,
                            Tolerance::Distance(tolerance),
                        )
                    });
                }
                let hull = |body: &ConvexPolyhedron| {
                    let (points, faces) = plain(body);
                    parry::mesh(&points, &faces)
                };
                let (Some(hull_a), Some(hull_b)) = (hull(a), hull(b)) else {
                    continue;
                };
                let flights: Vec<[Flight; 2]> = (motions.iter().zip(&throws))
                    .map(|(motions, throw)| {
                        [0, 1].map(|k| {
                            let vector = |v: Vector3<f64>| [v.x, v.y, v.z].into();
                            Flight {
                                hull: [&hull_a, &hull_b][k],
                                poses: [0.0, 1.0].map(|time| pose(&motions[k].pose(time))),
                                linear: vector(throw.velocity[k].linear),
                                angular: vector(throw.velocity[k].angular),
                            }
                        })
                    })
                    .collect();
                each(&mut group, "parry, sweep", n, &flights, |[a, b]| sweep(a, b));
                each(&mut group, "parry, nonlinear", n, &flights, |[a, b]| nonlinear(a, b));
            }
        }
    }
}

criterion_group!(name = benches; config = common::criterion(); targets = impacts);
criterion_main!(benches);
