//! Bodies that rotate faster than the steps of a cast can follow.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Mesh, PairTracker, Shape, Velocity};

/// Bodies that rotate by 1e15 radians: a cast ends when its pace shows that it will not reach the
/// end.
#[test]
fn casts_of_bodies_that_turn_too_fast_end_early() {
    let grid = truth::forms::mesh(&truth::soups::plate(8, [1.0, 1.0, 0.1]));
    let ball = Mesh::from_convex(&solids::icosahedron(0.5).unwrap()).unwrap();
    let cone = Shape::cone(0.3, 0.4).unwrap().rounded(0.05).unwrap();
    let egg = Shape::ellipsoid(Vector3::new(0.5, 0.4, 0.3)).unwrap();
    let pairs: [(Geometry, Geometry); 2] = [(grid.into(), cone.into()), (egg.into(), ball.into())];
    for (a, b) in &pairs {
        let spin = |w: f64| Velocity::new(Vector3::zeros(), Vector3::new(0.3, 0.4, 1.0) * w);
        let still = Steady::new(&Isometry3::identity(), Velocity::default()).unwrap();
        let near = Isometry3::translation(0.0, 0.0, 1.3);
        for w in [1e15, 1e12] {
            let turning = Steady::new(&near, spin(w)).unwrap();
            let mut tracker = PairTracker::new();
            let mut pair = tracker.pair(a, b);
            let began = cpu_time::ThreadTime::now();
            let tolerance = Tolerance::Distance(1e-6);
            let found = cast(&mut pair, &still, &turning, 0.0..1.0, tolerance).unwrap();
            std::println!("{w:e}: {found:?} {:?}", began.elapsed());
            assert!(
                matches!(found.impact, Impact::Incomplete { .. } | Impact::Undecided { .. }),
                "{found:?}"
            );
            assert!(found.queries <= 1024, "{found:?}");
            assert!(began.elapsed().as_secs_f64() < 30.0);
        }
    }
}
