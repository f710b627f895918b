//! Construction: bad input, what a cloud returns, memory, files.

use super::*;
use lin_canny::CloudError;

#[test]
fn bad_input_is_an_error_with_the_index() {
    let good = vec![Point3::origin(); 5];
    let ball = || CloudElement::Ball(0.5);
    assert!(matches!(Cloud::new(&[], ball()), Err(CloudError::Count { count: 0 })));
    for bad in [f64::NAN, f64::INFINITY, -1e200] {
        let mut points = good.clone();
        points[3].y = bad;
        assert!(
            matches!(Cloud::new(&points, ball()), Err(CloudError::Point { point: 3, .. })),
            "{bad}"
        );
    }
    let single = [[0.0, 1.0, 2.0], [0.0, f32::NAN, 1.0]];
    assert!(matches!(
        Cloud::from_f32(&single, ball()),
        Err(CloudError::Point { point: 1, .. })
    ));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let found = Cloud::new(&good, CloudElement::Ball(bad));
        assert!(matches!(found, Err(CloudError::Radius { .. })), "{bad}");
        let found = Cloud::new(&good, CloudElement::Balls(vec![0.0, 1.0, bad, 1.0, 1.0]));
        assert!(matches!(found, Err(CloudError::Radius { point: 2, .. })), "{bad}");
        let found = Cloud::new(&good, CloudElement::Box(Vector3::new(1.0, bad, 1.0)));
        assert!(matches!(found, Err(CloudError::Element(_))), "{bad}");
    }
    let found = Cloud::new(&good, CloudElement::Balls(vec![1.0]));
    assert!(matches!(
        found,
        Err(CloudError::Length {
            count: 1,
            expected: 5,
            ..
        })
    ));
    let far = [Point3::new(1e110, 0.0, 0.0), Point3::origin()];
    assert!(matches!(Cloud::new(&far, ball()), Err(CloudError::Extent { .. })));
    let found = Cloud::from_mask(Point3::origin(), Vector3::repeat(1.0), [2, 2, 2], &[true; 7]);
    assert!(matches!(
        found,
        Err(CloudError::Length {
            count: 7,
            expected: 8,
            ..
        })
    ));
    let found = Cloud::from_mask(Point3::origin(), Vector3::repeat(1.0), [2, 2, 2], &[false; 8]);
    assert!(matches!(found, Err(CloudError::Count { count: 0 })));
    let found = Cloud::from_cells(Point3::new(f64::NAN, 0.0, 0.0), Vector3::repeat(1.0), &[[0; 3]]);
    assert!(matches!(found, Err(CloudError::Point { point: 0, .. })));
}

#[test]
fn points_and_element_are_returned_as_given() {
    let mut rng = Rng::new(4);
    let points: Vec<_> = (0..200).map(|_| Point3::from(vector(&mut rng, 1.0))).collect();
    let radii: Vec<f64> = (0..200).map(|_| rng.range(0.0, 0.1)).collect();
    let cloud = Cloud::new(&points, CloudElement::Balls(radii.clone())).unwrap();
    assert_eq!((cloud.len(), cloud.points()), (200, points.clone()));
    assert_eq!(cloud.point(150), Some(points[150]));
    assert_eq!(cloud.point(200), None);
    assert!(matches!(cloud.element(), CloudElement::Balls(found) if found == radii));
    let (low, high) = cloud.aabb();
    for (p, r) in points.iter().zip(&radii) {
        assert!((0..3).all(|k| low[k] <= p[k] - r && high[k] >= p[k] + r));
    }
    let (centre, radius) = cloud.bounding_ball();
    assert!(
        points
            .iter()
            .zip(&radii)
            .all(|(p, r)| (p - centre).norm() + r <= radius)
    );
}

#[test]
fn voxels_are_boxes_of_a_grid() {
    let counts = [3, 4, 5];
    let occupied: Vec<bool> = (0..60).map(|k| k % 7 == 3).collect();
    let (origin, size) = (Point3::new(1.0, 2.0, 3.0), Vector3::new(0.5, 0.25, 1.0));
    let cloud = Cloud::from_mask(origin, size, counts, &occupied).unwrap();
    assert_eq!(cloud.len(), occupied.iter().filter(|full| **full).count());
    let pose = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    for number in 0..cloud.len() {
        let [i, j, k] = cloud.cell(number).unwrap();
        assert!(occupied[(usize::from(i) * 4 + usize::from(j)) * 5 + usize::from(k)]);
        let steps = Vector3::new(f64::from(i), f64::from(j), f64::from(k)).add_scalar(0.5);
        let centre = cloud.point(number).unwrap();
        assert_eq!(centre, origin + size.component_mul(&steps));
        let point = ConvexPolyhedron::point(centre).unwrap();
        let found = PairTracker::new().closest(&cloud, &point, &pose);
        assert_eq!(found.state, ContactState::Overlapping);
        assert_eq!(found.locations[0].subshape as usize, number);
    }
}

/// A wavy sheet, as a depth camera sees it.
fn sheet(n: usize) -> Vec<[f32; 3]> {
    let mut rng = Rng::new(8);
    let mut at = || (rng.range(-2.0, 2.0), rng.range(-2.0, 2.0), rng.range(0.0, 0.001));
    let point = |(x, y, z): (f64, f64, f64)| [x as f32, y as f32, (z + 0.2 * x * y) as f32];
    (0..n).map(|_| point(at())).collect()
}

#[test]
fn memory_per_point_is_bounded() {
    let single = sheet(50_000);
    let per = |cloud: &Cloud| cloud.memory_usage() as f64 / cloud.len() as f64;
    let of_f32 = Cloud::from_f32(&single, CloudElement::Ball(0.002)).unwrap();
    let double: Vec<_> = single.iter().map(|p| Point3::from(p.map(f64::from))).collect();
    let of_f64 = Cloud::new(&double, CloudElement::Ball(0.002)).unwrap();
    let cells: Vec<_> = single.iter().map(|p| p.map(|x| ((x + 2.0) * 100.0) as u16)).collect();
    let voxels = Cloud::from_cells(Point3::origin(), Vector3::repeat(0.01), &cells).unwrap();
    let found = [per(&of_f32), per(&of_f64), per(&voxels)];
    println!("bytes per point, f32, f64 and cells: {found:.1?}");
    assert!(found[0] <= 32.0 && found[1] <= 44.0 && found[2] <= 22.0, "{found:?}");
}

#[cfg(feature = "serde")]
#[test]
fn files_restore_clouds() {
    let mut rng = Rng::new(6);
    let points: Vec<_> = (0..300).map(|_| Point3::from(vector(&mut rng, 1.0))).collect();
    let radii = (0..300).map(|_| rng.range(0.0, 0.1)).collect();
    let cells: Vec<[u16; 3]> = (0..300).map(|k| [k % 9, k % 31, k % 17]).collect();
    let all = [
        Cloud::new(&points, CloudElement::Balls(radii)).unwrap(),
        Cloud::from_f32(&sheet(300), Shape::cylinder(0.1, 0.2).unwrap()).unwrap(),
        Cloud::from_cells(Point3::new(0.1, 0.2, 0.3), Vector3::new(0.1, 0.2, 0.3), &cells).unwrap(),
    ];
    let die = solids::cuboid(Vector3::repeat(0.3)).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(2.0, 0.4, 0.9)).unwrap();
    for cloud in all.map(Geometry::from) {
        let text = serde_json::to_string(&cloud).unwrap();
        let read: Geometry = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), text);
        let [before, after] = [&cloud, &read].map(|g| PairTracker::new().closest(g, &die, &pose));
        assert_eq!(before.outcome, after.outcome);
    }
    let bad = serde_json::to_string(&Geometry::from(Cloud::new(&points, CloudElement::Ball(0.5)).unwrap())).unwrap();
    assert!(serde_json::from_str::<Geometry>(&bad.replace("\"Ball\":0.5", "\"Ball\":-0.5")).is_err());
}

/// Prints times and memory of a cloud of 100,000 points and a hull of 32 vertices.
#[test]
#[ignore = "a measurement: cargo test --release --all-features --test clouds measure -- --ignored --nocapture"]
fn measure_100_000_points() {
    use std::time::Instant;
    let points = sheet(100_000);
    let least = |n: usize, f: &mut dyn FnMut()| {
        let time = |f: &mut dyn FnMut()| {
            let start = Instant::now();
            f();
            start.elapsed().as_secs_f64()
        };
        (0..n).map(|_| time(f)).fold(f64::INFINITY, f64::min)
    };
    let build = least(10, &mut || {
        Cloud::from_f32(&points, CloudElement::Ball(0.002)).unwrap();
    });
    let cloud = Cloud::from_f32(&points, CloudElement::Ball(0.002)).unwrap();
    println!(
        "build {:.2} ms, {:.1} bytes a point",
        build * 1e3,
        cloud.memory_usage() as f64 / 1e5
    );
    let hull = solids::random_hull(32, Vector3::new(0.1, 0.1, 0.1), 5).unwrap();
    for (name, height) in [("far", 1.5), ("close", 0.3), ("contact", 0.05)] {
        let step = 0.5f64.to_radians();
        let poses: Vec<_> = (0..720)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * step).sin_cos();
                let (x, y) = (0.5 * cos, 0.5 * sin);
                let at = Isometry3::new(
                    Vector3::new(x, y, 0.2 * x * y + height),
                    Vector3::new(0.3, 0.1, 1.0) * (f64::from(k) * step),
                );
                RelativePose::from_isometry(&at).unwrap()
            })
            .collect();
        let mut warm = PairTracker::new();
        let each = |seconds: f64| seconds / 720.0 * 1e6;
        let tracked = least(5, &mut || {
            poses.iter().for_each(|pose| {
                warm.closest(&cloud, &hull, pose);
            })
        });
        let mut all = PairTracker::new();
        let cold = least(5, &mut || {
            for pose in &poses {
                all.reset();
                all.closest(&cloud, &hull, pose);
            }
        });
        let mut yes = 0;
        let within = least(5, &mut || {
            yes = poses
                .iter()
                .filter(|pose| warm.within(&cloud, &hull, pose, 0.02))
                .count();
        });
        println!(
            "{name}: tracked {:.2} us, cold {:.2} us, within {:.2} us ({yes} yes)",
            each(tracked),
            each(cold),
            each(within)
        );
    }
}
