//! Coordinates of every magnitude in one frame: a call ends at its budget.

use cpu_time::ThreadTime;
use lab::forms::mesh;
use lab::soups;
use lin_canny::Mesh;
use lin_canny::continuous::{self, MeshOverFrame};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Point3};
use std::time::Duration;

/// A cube of side two with a vertex far out.
fn stretched(far: f64) -> Mesh {
    let mut cube = soups::plate(1, [1.0, 1.0, 1.0]);
    cube.points[0] = cube.points[0].map(|x| x * far);
    mesh(&cube)
}

#[test]
fn wide_ranges_of_numbers_end_at_a_budget() {
    for far in [1e100, 1e60] {
        for away in [1e240, 1e270, 1e300] {
            for tolerance in [1e-3, 1e-12] {
            let body = stretched(far);
            let other = stretched(-far);
            let to = Isometry3::translation(away, away, -away);
            let moving = MeshOverFrame::new(&body, &body).unwrap();
            let moving = moving.moving(&Isometry3::translation(0.1, 0.2, 0.3), &to).unwrap();
            for still in [&body, &other] {
            let still = MeshOverFrame::new(still, still).unwrap();
            let began = ThreadTime::now();
            let cast = continuous::meshes(&moving, &still, Tolerance::Time(tolerance)).unwrap();
            let spent = began.elapsed();
            std::println!("{far:e} {away:e} {tolerance:e}: {cast:?} {spent:?}");
            assert!(spent < Duration::from_secs(500), "{spent:?}");
            }
            }
        }
    }
    let _ = Point3::<f64>::origin();
}
