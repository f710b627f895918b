//! Long builds report progress, stop on request, and give the same body with or without a callback.

use std::ops::ControlFlow;

use lin_canny::nalgebra::Point3;
use lin_canny::polyhedron::BuildError;
use lin_canny::{Compound, ConvexPolyhedron, Decomposition, Mesh, MeshError, Piece, Progress, WithProgress};
use truth::rng::Rng;
use truth::soups;

fn cloud(count: usize) -> Vec<Point3<f64>> {
    let mut rng = Rng::of_case(40, count as u64);
    (0..count).map(|_| Point3::from(rng.unit())).collect()
}

/// Records every progress report of a call, and checks that the work of a stage grows up to its
/// total.
fn noted(call: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>)) -> Vec<&'static str> {
    let (mut stages, mut last) = (Vec::new(), 0);
    call(&mut |progress| {
        if stages.last() != Some(&progress.stage) {
            stages.push(progress.stage);
            last = 0;
        }
        assert!(progress.done >= last, "{progress:?} after {last}");
        assert!(
            progress.total.is_none_or(|total| progress.done <= total),
            "{progress:?}"
        );
        last = progress.done;
        ControlFlow::Continue(())
    });
    stages
}

/// Stops a call at each progress report in turn; returns how often it stopped.
fn stopped(mut call: impl FnMut(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> bool) -> usize {
    for words in 0_usize.. {
        let mut left = words;
        let is_stopped = call(&mut |_| {
            let over = left == 0;
            left = left.saturating_sub(1);
            Progress::stop_if(over)
        });
        if !is_stopped {
            return words;
        }
    }
    unreachable!("a call has a finite number of words")
}

#[test]
fn a_hull_says_how_far_it_is() {
    for points in [
        cloud(5),
        cloud(3000),
        [cloud(3000), vec![Point3::origin(); 900]].concat(),
    ] {
        let stages = noted(|callback| {
            let told = WithProgress::new(callback).convex_hull(&points).expect("a hull");
            let plain = ConvexPolyhedron::from_points(&points).expect("a hull");
            assert!(told.vertex_points().eq(plain.vertex_points()));
        });
        assert_eq!(stages, ["sort", "hull", "faces"]);
    }
    let points = cloud(400);
    let words = stopped(|callback| {
        let found = WithProgress::new(callback).convex_hull(&points);
        assert!(found.is_ok() || matches!(found, Err(BuildError::Stopped)));
        found.is_err()
    });
    assert!(words > 50, "{words}");
}

#[test]
fn a_mesh_says_how_far_it_is() {
    let ring = soups::torus(40, 20, 0.3);
    let points: Vec<_> = ring.points.iter().map(|p| Point3::from(*p)).collect();
    let plain = Mesh::new(&points, &ring.triangles).expect("a mesh");
    let stages = noted(|callback| {
        let told = WithProgress::new(callback)
            .mesh(&points, &ring.triangles)
            .expect("a mesh");
        assert_eq!(told.report(), plain.report());
        assert_eq!(told.inspect(10), plain.inspect(10));
    });
    assert_eq!(stages, ["weld", "edges", "tree", "boxes"]);
    let words = stopped(|callback| {
        let found = WithProgress::new(callback).mesh(&points, &ring.triangles);
        assert!(found.is_ok() || matches!(found, Err(MeshError::Stopped)));
        found.is_err()
    });
    assert!(words > 50, "{words}");
}

#[test]
fn an_inspection_that_is_stopped_is_not_complete() {
    let ring = soups::torus(200, 100, 0.3);
    let points: Vec<_> = ring.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&points, &ring.triangles).expect("a mesh");
    let stages = noted(|callback| assert_eq!(WithProgress::new(callback).inspect(&mesh, 10), mesh.inspect(10)));
    assert_eq!(stages, ["crossings", "parts in parts"]);
    let words = stopped(|callback| !WithProgress::new(callback).inspect(&mesh, 10).is_complete);
    assert!(words > 3, "{words}");
}

#[test]
fn a_decomposition_says_how_far_it_is() {
    let ring = soups::torus(40, 20, 0.3);
    let points: Vec<_> = ring.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&points, &ring.triangles).expect("a mesh");
    let pieces = || Compound::new(vec![Piece::new(mesh.hull().expect("a hull"))]).expect("pieces");
    let plain = Decomposition::new(mesh.clone(), pieces()).expect("pieces of a mesh");
    let stages = noted(|callback| {
        let told = WithProgress::new(callback)
            .decomposition(mesh.clone(), pieces())
            .expect("pieces of a mesh");
        assert_eq!(told.fit(), plain.fit());
    });
    assert_eq!(stages, ["excess", "shortfall"]);
    let words = stopped(|callback| {
        let found = WithProgress::new(callback).decomposition(mesh.clone(), pieces());
        assert!(found.is_ok() || matches!(found, Err(MeshError::Stopped)));
        found.is_err()
    });
    assert!(words > 5, "{words}");
}
