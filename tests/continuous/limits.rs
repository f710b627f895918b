//! Coordinates of every magnitude in one frame: a call ends at its budget.

use cpu_time::ThreadTime;
use lin_canny::Mesh;
use lin_canny::continuous::{self, MovingMesh};
use lin_canny::impact::{Impact, Tolerance};
use lin_canny::nalgebra::Isometry3;
use std::time::Duration;
use truth::forms::mesh;
use truth::soups;

/// Returns a cube of side two with one vertex far out.
fn stretched(far: f64) -> Mesh {
    let mut cube = mesh(&soups::plate(1, [1.0, 1.0, 1.0]));
    let mut vertices = cube.vertices();
    vertices[0] *= far;
    cube.set_vertices(&vertices).unwrap();
    cube
}

/// One vertex is far out, and the body moves farther by a hundred orders of magnitude and more.
#[test]
fn wide_ranges_of_numbers_end_at_a_budget() {
    let mut unknown = 0;
    for (far, away) in [(1e100, 1e240), (1e100, 1e300), (1e60, 1e270)] {
        let (body, other) = (stretched(far), stretched(-far));
        let [from, to] = [0.1, away].map(|x| Isometry3::translation(x, 2.0 * x, -x));
        let moving = MovingMesh::new(&body, &body).unwrap().with_poses(&from, &to).unwrap();
        for still in [&body, &other] {
            let still = MovingMesh::new(still, still).unwrap();
            for tolerance in [1e-3, 1e-12] {
                let began = ThreadTime::now();
                let cast = continuous::cast_meshes(&moving, &still, Tolerance::Time(tolerance)).unwrap();
                let spent = began.elapsed();
                std::println!("{far:e} {away:e} {tolerance:e}: {cast:?} {spent:?}");
                // Half a second on one core in release; a build with checks takes longer.
                assert!(spent < Duration::from_secs(5), "{spent:?}");
                unknown += usize::from(matches!(cast.impact, Impact::Incomplete { .. }));
            }
        }
    }
    assert!(unknown > 0, "no call reached its budget");
}
