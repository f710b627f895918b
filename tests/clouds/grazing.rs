//! Rays and casts that pass clouds and meshes at gaps that single precision hides, and clouds of
//! many equal points.

use super::{pick, rotation, vector};
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Cloud, CloudElement, Geometry, Mesh, PairTracker, Ray, RayCast, RayCaster, RelativePose, Shape, Velocity,
};
use truth::rng::Rng;
use truth::soups;

const GAPS: [f64; 6] = [1e-3, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11];

/// Returns points around the x axis, and their distances from it.
fn around_axis(rng: &mut Rng, count: usize) -> Vec<(Point3<f64>, f64)> {
    let mut point = || {
        let p = vector(rng, 1.0);
        let p = Point3::new(4.0 * p.x, p.y, p.z);
        (p, p.y.hypot(p.z))
    };
    (0..count).map(|_| point()).filter(|(_, far)| *far > 0.1).collect()
}

/// Returns what a ray along the x axis of a body meets.
fn along_x(body: &Cloud, pose: &Isometry3<f64>) -> RayCast {
    let ray = Ray::new(pose * Point3::new(-6.0, 0.0, 0.0), pose * Vector3::x()).unwrap();
    RayCaster::new().cast(body, pose, &ray, 20.0).unwrap()
}

#[test]
fn rays_between_balls_are_decided() {
    for seed in 0..60 {
        let mut rng = Rng::new(seed);
        let all = around_axis(&mut rng, 600);
        let points: Vec<_> = all.iter().map(|x| x.0).collect();
        let pose = Isometry3::from_parts(vector(&mut rng, 2.0).into(), rotation(&mut rng));
        for gap in GAPS {
            // One ball in three grazes the ray.
            let radius = |(k, x): (usize, &(Point3<f64>, f64))| if k % 3 == 0 { x.1 - gap } else { 0.5 * x.1 };
            let mut radii: Vec<f64> = all.iter().enumerate().map(radius).collect();
            let found = along_x(&Cloud::new(&points, CloudElement::Balls(radii.clone())).unwrap(), &pose);
            assert!(matches!(found, RayCast::Miss), "seed {seed}, gap {gap:e}: {found:?}");
            // A ball that reaches over the ray is never missed.
            let k = pick(&mut rng, radii.len());
            radii[k] = all[k].1 + gap;
            let found = along_x(&Cloud::new(&points, CloudElement::Balls(radii)).unwrap(), &pose);
            assert!(
                !matches!(found, RayCast::Miss),
                "seed {seed}, overlap {gap:e}: {found:?}"
            );
        }
    }
}

/// Returns a cloud of boxes of different heights with tops at most at zero, many of them there.
fn steps(rng: &mut Rng) -> Cloud {
    let top = |rng: &mut Rng| if pick(rng, 2) == 0 { 0.0 } else { rng.range(-0.5, 0.0) };
    let points: Vec<_> = (0..900)
        .map(|k: i32| {
            Point3::new(
                f64::from(k / 30 - 15) * 0.25,
                f64::from(k % 30 - 15) * 0.25,
                top(rng) - 0.125,
            )
        })
        .collect();
    Cloud::new(&points, CloudElement::Box(Vector3::repeat(0.125))).unwrap()
}

#[test]
fn bodies_slide_over_steps_in_a_few_queries() {
    for seed in 0..30 {
        let mut rng = Rng::new(1000 + seed);
        let cloud = steps(&mut rng);
        let pose = Isometry3::from_parts(vector(&mut rng, 2.0).into(), rotation(&mut rng));
        // Bodies, and how far they reach down.
        let two = Cloud::new(&[Point3::new(0.3, 0.2, 0.0), Point3::origin()], CloudElement::Ball(0.1));
        let tools: [(Geometry, f64); 3] = [
            (solids::cuboid(Vector3::new(0.3, 0.2, 0.1)).unwrap().into(), 0.1),
            (Shape::capsule(0.2, 0.1).unwrap().into(), 0.3),
            (two.unwrap().into(), 0.1),
        ];
        for gap in GAPS {
            for (tool, low) in &tools {
                let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * rng.range(-3.0, 3.0));
                let at = pose * Isometry3::from_parts(Vector3::new(-2.0, 0.3, low + gap).into(), turn);
                let way = pose * Vector3::new(3.0, rng.range(-1.0, 1.0), 0.0);
                for spin in [Vector3::zeros(), pose * Vector3::z()] {
                    let fly = Steady::new(&at, Velocity::new(way, spin)).unwrap();
                    let rest = Steady::new(&pose, Velocity::default()).unwrap();
                    let (mut tracker, tolerance) = (PairTracker::new(), Tolerance::Distance(1e-6));
                    let found = cast(&mut tracker.pair(&cloud, tool), &rest, &fly, 0.0..1.0, tolerance).unwrap();
                    assert!(
                        matches!(found.impact, Impact::Miss),
                        "seed {seed}, gap {gap:e}: {found:?}"
                    );
                    assert!(
                        found.queries <= 60,
                        "seed {seed}, gap {gap:e}: {} queries",
                        found.queries
                    );
                }
            }
        }
    }
}

/// Returns two boxes as one mesh, and its points.
fn two_boxes(rng: &mut Rng) -> (Mesh, Vec<Point3<f64>>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for x in [-0.6, 0.7] {
        let at = Isometry3::from_parts(Vector3::new(x, 0.1, 0.0).into(), rotation(rng));
        let first = points.len() as u32;
        let half = soups::cuboid([-0.3, -0.2, -0.1], [0.3, 0.2, 0.1]);
        points.extend(half.points.iter().map(|p| at * Point3::from(*p)));
        triangles.extend(half.triangles.iter().map(|t| t.map(|k| first + k)));
    }
    (Mesh::new(&points, &triangles).unwrap(), points)
}

/// A body that rotates, and whose lowest corner swings past a plate.
#[test]
fn meshes_swing_past_a_plate_in_a_hundred_queries() {
    let plate: Geometry = solids::cuboid(Vector3::new(4.0, 4.0, 0.5)).unwrap().into();
    let mut most = 0;
    for seed in 0..40 {
        let mut rng = Rng::new(2000 + seed);
        let (mesh, points) = two_boxes(&mut rng);
        let (turn, spin) = (rotation(&mut rng), vector(&mut rng, 3.0));
        let way = vector(&mut rng, 0.5);
        let low = |t: f64| {
            let turned = UnitQuaternion::from_scaled_axis(spin * t) * turn;
            let heights = points.iter().map(|p| (turned * p).z + way.z * t);
            heights.fold(f64::INFINITY, f64::min)
        };
        // The lowest height of the motion.
        let of = |k: i32| f64::from(k) / 1e3;
        let mut time = of((0..=1000).min_by(|x, y| low(of(*x)).total_cmp(&low(of(*y)))).unwrap());
        let mut step = 1e-3;
        while step > 1e-12 {
            for other in [time - step, time + step].map(|t| t.clamp(0.0, 1.0)) {
                if low(other) < low(time) {
                    time = other;
                }
            }
            step *= 0.7;
        }
        for gap in [1e-3, 1e-6, 1e-9, 3e-12] {
            let at = Isometry3::from_parts(Vector3::new(0.1, 0.2, 0.5 - low(time) + gap).into(), turn);
            let fly = Steady::new(&at, Velocity::new(way, spin)).unwrap();
            let rest = Steady::new(&Isometry3::identity(), Velocity::default()).unwrap();
            let mut tracker = PairTracker::new();
            let tolerance = Tolerance::Distance(1e-6);
            let found = cast(&mut tracker.pair(&plate, &mesh), &rest, &fly, 0.0..1.0, tolerance).unwrap();
            assert!(
                matches!(found.impact, Impact::Miss),
                "seed {seed}, gap {gap:e}: {found:?}"
            );
            most = most.max(found.queries);
        }
    }
    assert!(most <= 100, "{most} queries");
}

/// Many equal points answer as one does, with the number of the largest ball among them.
#[test]
fn equal_points_cost_as_much_as_one() {
    for seed in 0..20 {
        let mut rng = Rng::new(3000 + seed);
        let distinct: Vec<Point3<f64>> = (0..200).map(|_| Point3::from(vector(&mut rng, 1.0))).collect();
        let mut all: Vec<(Point3<f64>, f64)> = distinct.iter().map(|p| (*p, rng.range(0.0, 0.02))).collect();
        for _ in 0..4 {
            let again = distinct[pick(&mut rng, 200)];
            all.extend((0..50 + 50 * pick(&mut rng, 20)).map(|_| (again, rng.range(0.0, 0.02))));
        }
        all.sort_by_cached_key(|_| rng.range(0.0, 1e9) as u64);
        let points: Vec<_> = all.iter().map(|x| x.0).collect();
        let radii: Vec<_> = all.iter().map(|x| x.1).collect();
        let cloud = Cloud::new(&points, CloudElement::Balls(radii.clone())).unwrap();
        assert_eq!(cloud.points(), points);
        assert!(matches!(cloud.element(), CloudElement::Balls(kept) if kept == radii));
        let other = Cloud::new(&distinct[..50], CloudElement::Ball(0.01)).unwrap();
        let mut pair = PairTracker::new();
        for frame in 0..4 {
            let at = Isometry3::new(
                Vector3::new(2.1 - 0.3 * f64::from(frame), 0.1, 0.0),
                Vector3::new(0.0, 0.3, 0.1),
            );
            let pose = RelativePose::from_isometry(&at).unwrap();
            let gap = |k: usize, q: &Point3<f64>| (points[k] - at * q).norm() - radii[k] - 0.01;
            let gaps = (0..points.len()).flat_map(|k| distinct[..50].iter().map(move |q| gap(k, q)));
            let least = gaps.fold(f64::INFINITY, f64::min).max(0.0);
            let found = pair.closest(&cloud, &other, &pose);
            let off = (found.distance.max(0.0) - least).abs();
            assert!(off < 1e-13, "seed {seed}: {found:?} for {least:e}");
            let [i, j] = found.locations.map(|at| at.subshape as usize);
            assert!(gap(i, &distinct[j]).max(0.0) - least < 1e-13);
        }
    }
    // Pixels without a return.
    let count = 64_000;
    for radius in [0.0, 0.1] {
        let cloud = Cloud::from_f32(&vec![[0.0; 3]; count], CloudElement::Ball(radius)).unwrap();
        for x in [0.0, 0.2, 1.0] {
            let mut pair = PairTracker::new();
            let pose = RelativePose::from_isometry(&Isometry3::translation(x, 0.0, 0.0)).unwrap();
            let found = pair.closest(&cloud, &cloud, &pose);
            let off = (found.distance.max(0.0) - (x - 2.0 * radius).max(0.0)).abs();
            assert!(off < 1e-12, "{found:?}");
            let _ = pair.penetration(&cloud, &cloud, &pose);
            let work = pair.work().trees;
            assert!(work.bounds + work.looks + work.measured < 1000, "{work:?}");
        }
    }
}

#[test]
#[ignore = "a measurement: cargo test --release --all-features --test clouds grazing::measure -- --ignored --nocapture"]
fn measure() {
    let grid = |k: i32| Point3::new(f64::from(k / 100) * 0.1, f64::from(k % 100) * 0.1, 0.0);
    let points: Vec<_> = (0..10_000).map(grid).collect();
    let tool: Geometry = solids::cuboid(Vector3::repeat(0.2)).unwrap().into();
    let pose = Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.1, 0.2, 0.3));
    let elements = [
        ("balls", CloudElement::Ball(0.05)),
        ("boxes", CloudElement::Box(Vector3::repeat(0.05))),
    ];
    for (name, element) in elements {
        let cloud = Cloud::new(&points, element).unwrap();
        for gap in GAPS {
            let ray = Ray::new(pose * Point3::new(-1.0, 0.5, 0.05 + gap), pose * Vector3::x()).unwrap();
            let start = std::time::Instant::now();
            let met = RayCaster::new().cast(&cloud, &pose, &ray, 20.0).unwrap();
            let of_ray = start.elapsed();
            let at = pose * Isometry3::translation(1.0, 0.5, 0.25 + gap);
            let fly = Steady::new(&at, Velocity::new(pose * Vector3::x(), Vector3::zeros())).unwrap();
            let rest = Steady::new(&pose, Velocity::default()).unwrap();
            let (mut tracker, tolerance) = (PairTracker::new(), Tolerance::Distance(1e-9));
            let start = std::time::Instant::now();
            let found = cast(&mut tracker.pair(&cloud, &tool), &rest, &fly, 0.0..1.0, tolerance).unwrap();
            let (of_cast, queries) = (start.elapsed(), found.queries);
            println!("{name}, gap {gap:e}: ray {of_ray:.0?} {met:?}, cast {of_cast:.0?} in {queries} queries");
        }
    }
    for count in [1000, 16_000, 64_000] {
        let cloud = Cloud::from_f32(&vec![[0.0; 3]; count], CloudElement::Ball(0.1)).unwrap();
        for x in [0.0, 1.0] {
            let pose = RelativePose::from_isometry(&Isometry3::translation(x, 0.0, 0.0)).unwrap();
            let start = std::time::Instant::now();
            let found = PairTracker::new().penetration(&cloud, &cloud, &pose).map(|p| p.lower);
            println!(
                "{count} equal balls against themselves, moved by {x}: {:.0?}, depth {found:?}",
                start.elapsed()
            );
        }
    }
}
