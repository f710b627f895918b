//! Random clouds against bodies of every kind, warm and cold, in both orders.

use super::*;

/// Checks one cloud and one body over a few frames.
fn check(seed: u64) {
    let mut rng = Rng::new(seed);
    let unit = [1.0, 1.0, 1.0, 1e-97, 1e97, 1.0 / 1024.0][pick(&mut rng, 6)];
    let family = seed as usize % FAMILIES;
    let kind = seed as usize / FAMILIES % OTHERS;
    let unit = if family == 6 { 1.0 } else { unit };
    let at = points(&mut rng, family, unit);
    let (element, shapes) = element(&mut rng, seed as usize % ELEMENTS, at.len(), unit);
    let cloud = Geometry::from(Cloud::new(&at, element).unwrap());
    let other = other(&mut rng, kind, unit);
    // Exact if the cloud is the world and all members of the other body have its frame. Pairs of
    // nodes are proven up to rounding of the pair's size, which an outlier makes large.
    let is_exact = seed.is_multiple_of(2) && kind != 9 && kind != 12 && family != 6;
    let pose_a = if seed.is_multiple_of(2) {
        Isometry3::identity()
    } else {
        Isometry3::from_parts((vector(&mut rng, 1.0) * unit).into(), rotation(&mut rng))
    };
    let start = vector(&mut rng, 1.5) * unit;
    let step = vector(&mut rng, 0.3) * unit;
    let turn = UnitQuaternion::new(vector(&mut rng, 0.2));
    let mut spin = if seed.is_multiple_of(3) {
        UnitQuaternion::identity()
    } else {
        rotation(&mut rng)
    };
    let (mut warm, mut back) = (PairTracker::new(), PairTracker::new());
    for frame in 0..5 {
        let pose_b = pose_a * Isometry3::from_parts((start + step * f64::from(frame)).into(), spin);
        spin = turn * spin;
        let poses = [pose_a, pose_b];
        let pose = RelativePose::new(&pose_a, &pose_b).unwrap();
        let truth = brute(&at, &shapes, &other, &poses);
        let far = at.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let size = far + 4.0 * unit + pose_b.translation.vector.norm() + pose_a.translation.vector.norm();
        let noise = if is_exact { 1e-14 * truth.upper } else { 1e-13 * size };
        let what = format!("seed {seed}, frame {frame}");
        let answers = [
            warm.closest(&cloud, &other, &pose),
            back.closest(&other, &cloud, &pose.swapped()),
            PairTracker::new().closest(&cloud, &other, &pose),
            PairTracker::new().closest(&other, &cloud, &pose.swapped()),
        ];
        for (k, found) in answers.iter().enumerate() {
            let what = format!("{what}, answer {k}: {found:?} for {:e}..{:e}", truth.lower, truth.upper);
            assert!(found.lower <= truth.upper + noise, "{what}");
            assert!(found.upper >= truth.lower - noise, "{what}");
            assert!(
                found.upper.max(0.0) - found.lower.max(0.0) <= truth.upper - truth.lower + 1e-11 * size,
                "{what}"
            );
            if truth.lower > 4.0 * noise {
                assert_eq!(found.state, ContactState::Separated, "{what}");
            }
            if truth.is_overlap && is_exact {
                assert_eq!(found.state, ContactState::Overlapping, "{what}");
            }
            if found.state == ContactState::Overlapping {
                assert!(truth.lower <= noise, "{what}");
            }
            if found.state == ContactState::Overlapping && kind == 10 {
                // The locations of a contained element are those of the closest point and triangle.
                continue;
            }
            let point = found.locations[k % 2].subshape as usize;
            let one = brute(&at[point..=point], &shapes[point..=point], &other, &poses);
            assert!(one.lower <= found.upper.max(0.0) + noise, "{what}, point {point}");
        }
        let near = truth.upper;
        for d in [
            0.0,
            0.5 * near,
            near * (1.0 - 1e-9),
            near,
            near * (1.0 + 1e-9),
            2.0 * near,
        ] {
            let is_tie = (d - truth.upper).abs() <= 4.0 * noise + (truth.upper - truth.lower) + 1e-12 * unit;
            // The search of a single point and a tiny mesh may leave wide bounds.
            let is_loose = truth.upper - truth.lower > 1e-12 * truth.upper;
            if is_tie && (!is_exact || is_loose) {
                continue;
            }
            let expected = brute_within(&at, &shapes, &other, &poses, d);
            let all = [
                warm.within(&cloud, &other, &pose, d),
                back.within(&other, &cloud, &pose.swapped(), d),
                PairTracker::new().within(&cloud, &other, &pose, d),
                PairTracker::new().within(&other, &cloud, &pose.swapped(), d),
            ];
            assert_eq!(
                all, [expected; 4],
                "{what}, within {d:e} for {:e}..{:e}",
                truth.lower, truth.upper
            );
        }
    }
}

#[test]
fn clouds_agree_with_their_elements() {
    (0..100).for_each(check);
}

#[test]
#[ignore = "10,000 cases, minutes: cargo test --release --all-features --test clouds -- --ignored"]
fn clouds_agree_with_their_elements_10_000() {
    (0..10_000).for_each(check);
}

/// Clouds of several leaves against each other: leaves of sixteen points each.
#[test]
fn clouds_of_many_leaves_agree_with_brute_force() {
    for seed in 0..12 {
        let mut rng = Rng::new(100 + seed);
        let mut cloud =
            |n: usize| -> Vec<Point3<f64>> { (0..n).map(|_| Point3::from(vector(&mut rng, 1.0))).collect() };
        let (a, b) = (cloud(300), cloud(200));
        let [of_a, of_b] = [&a, &b].map(|points| Cloud::new(points, CloudElement::Ball(0.01)).unwrap());
        let mut warm = PairTracker::new();
        for frame in 0..4 {
            let at = Isometry3::new(
                Vector3::new(2.2 - 0.2 * f64::from(frame), 0.1, 0.0),
                Vector3::new(0.0, 0.3, 0.1),
            );
            let pose = RelativePose::from_isometry(&at).unwrap();
            let gaps = a.iter().flat_map(|p| b.iter().map(move |q| (p - at * q).norm() - 0.02));
            let least = gaps.fold(f64::INFINITY, f64::min).max(0.0);
            let found = warm.closest(&of_a, &of_b, &pose);
            let off = (found.distance.max(0.0) - least).abs();
            assert!(off < 1e-13, "seed {seed}: {found:?} for {least:e}");
            let [i, j] = found.locations.map(|at| at.subshape as usize);
            assert!(((a[i] - at * b[j]).norm() - 0.02).max(0.0) - least < 1e-13);
            assert!(warm.within(&of_a, &of_b, &pose, least + 1e-9));
            assert_eq!(warm.within(&of_a, &of_b, &pose, (least - 1e-9).max(0.0)), least <= 1e-9);
        }
    }
}

/// A closed mesh contains elements that are far from its surface.
#[test]
fn elements_inside_of_a_mesh_overlap_it() {
    let sphere = Mesh::from_convex(&solids::geodesic_sphere(3, 10.0).unwrap()).unwrap();
    let mut rng = Rng::new(5);
    let mut points: Vec<_> = (0..500)
        .map(|_| Point3::from(vector(&mut rng, 1.0) + Vector3::x() * 20.0))
        .collect();
    let pose = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    for (is_inside, at) in [
        (false, Point3::new(12.0, 0.0, 0.0)),
        (true, Point3::new(4.0, 0.5, 0.25)),
    ] {
        points[77] = at;
        let cloud = Cloud::new(&points, CloudElement::Box(Vector3::repeat(0.1))).unwrap();
        let found = PairTracker::new().closest(&sphere, &cloud, &pose);
        let expected = if is_inside {
            ContactState::Overlapping
        } else {
            ContactState::Separated
        };
        assert_eq!(found.state, expected);
        let answer = PairTracker::new().intersects(&cloud, &sphere, &pose.swapped());
        assert_eq!(answer, is_inside);
        let gap = if is_inside { 0.0 } else { 2.0 - 0.1 };
        let mut tracker = PairTracker::new();
        let answer = tracker.within(&cloud, &sphere, &pose.swapped(), f64::max(gap - 0.2, 0.0));
        assert_eq!(answer, is_inside);
        assert!(tracker.within(&cloud, &sphere, &pose.swapped(), gap + 0.2));
        let distance = tracker.distance(&sphere, &cloud, &pose);
        assert!(distance.lower <= gap + 0.2, "{distance:?}");
        assert!(distance.upper >= gap - 0.2, "{distance:?}");
        assert!(!is_inside || distance.upper <= 0.0, "{distance:?}");
    }
}

#[test]
fn depths_are_bounded() {
    let mut rng = Rng::new(9);
    let points: Vec<_> = (0..400)
        .map(|_| Point3::from(vector(&mut rng, 1.0).component_mul(&Vector3::new(1.0, 1.0, 0.0))))
        .collect();
    let floor = Cloud::new(&points, CloudElement::Ball(0.1)).unwrap();
    let die = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, 0.55)).unwrap();
    let found = PairTracker::new().penetration(&floor, &die, &pose).unwrap();
    assert!(found.lower > 0.04999, "{found:?}");
    assert!(found.lower <= found.upper, "{found:?}");
    assert!(found.upper < 0.0502, "{found:?}");
    let found = PairTracker::new().penetration(&die, &floor, &pose.swapped()).unwrap();
    assert!(found.lower > 0.04999, "{found:?}");
    assert!(found.lower <= found.upper, "{found:?}");
    assert!(found.upper < 0.0502, "{found:?}");
    let mesh = Mesh::from_convex(&die).unwrap();
    let found = PairTracker::new().penetration(&floor, &mesh, &pose).unwrap();
    assert!(found.lower > 0.04999, "{found:?}");
    assert!(found.lower <= found.upper, "{found:?}");
    assert!(found.upper < 0.0502, "{found:?}");
}
