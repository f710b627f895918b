//! Promise: a body is built in nearly `n log n` time, even if many points lie on faces and edges of
//! the hull.

use cpu_time::ThreadTime;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Point3, Vector3};
use truth::rng::Rng;

/// Returns points near a sphere with so few bits that sums of three are exact, times three.
fn dyadic_sphere(n: usize) -> Vec<Vector3<f64>> {
    let mut rng = Rng::new(811);
    let bits = 2f64.powi(20);
    (0..n)
        .map(|_| Vector3::from(rng.unit()).map(|x| 6.0 * (x * bits).round()))
        .collect()
}

/// Returns the vertices of a hull, and the exact centroids of its triangles.
fn with_centroids(n: usize) -> Vec<Point3<f64>> {
    on_faces(n, |corners| {
        (corners.len() == 3)
            .then(|| corners.iter().sum::<Vector3<f64>>() / 3.0)
            .into_iter()
            .collect()
    })
}

/// Returns the vertices of a hull, and the exact midpoints of its edges.
fn with_midpoints(n: usize) -> Vec<Point3<f64>> {
    on_faces(n, |corners| {
        (0..corners.len())
            .map(|k| (corners[k] + corners[(k + 1) % corners.len()]) / 2.0)
            .collect()
    })
}

fn on_faces(n: usize, more: impl Fn(&[Vector3<f64>]) -> Vec<Vector3<f64>>) -> Vec<Point3<f64>> {
    let points: Vec<Point3<f64>> = dyadic_sphere(n).into_iter().map(Point3::from).collect();
    let body = ConvexPolyhedron::from_points(&points).unwrap();
    let (vertices, faces) = truth::contacts::plain(&body);
    let at: Vec<Vector3<f64>> = vertices.into_iter().map(Vector3::from).collect();
    let mut all = at.clone();
    for face in faces {
        let corners: Vec<_> = face.iter().map(|&v| at[v as usize]).collect();
        all.extend(more(&corners));
    }
    all.into_iter().map(Point3::from).collect()
}

/// Returns two ellipses in planes that are not parallel.
fn skew_ellipses(n: usize) -> Vec<Point3<f64>> {
    let at = |k: usize| {
        let (s, c) = (std::f64::consts::TAU * (k / 2) as f64 / (n / 2) as f64).sin_cos();
        if k.is_multiple_of(2) {
            Point3::new(c, 0.5 * s, 0.0)
        } else {
            Point3::new(0.5 * c, 0.25 * c, 1.0 + s)
        }
    };
    (0..n).map(at).collect()
}

/// Returns the CPU time of the thread, the less of two runs, to exclude other activity.
fn time(points: &[Point3<f64>]) -> f64 {
    let once = || {
        let start = ThreadTime::now();
        ConvexPolyhedron::from_points(points).unwrap();
        start.elapsed().as_secs_f64()
    };
    once().min(once())
}

/// Four times the points may take at most nine times the time. Quadratic work per face took 10 to
/// 18 times; now it is 4 to 5.
#[test]
fn four_times_the_points_take_no_nine_times_as_long() {
    for (name, make) in [
        ("centroids", with_centroids as fn(usize) -> Vec<Point3<f64>>),
        ("midpoints", with_midpoints),
        ("ellipses", skew_ellipses),
    ] {
        let (few, many) = (make(6_000), make(24_000));
        let (before, after) = (time(&few), time(&many));
        println!(
            "{name}: {} points {before:.3} s, {} points {after:.3} s",
            few.len(),
            many.len()
        );
        let by = many.len() as f64 / few.len() as f64;
        assert!(after < 9.0 / 4.0 * by * before, "{name}: {before} s, {after} s");
    }
}
