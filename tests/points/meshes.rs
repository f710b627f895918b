use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, MeshKind, PointError, PointQuery, PointTracker};
use truth::driven::exact_place::Place;
use truth::forms::mesh;
use truth::near_points::{MESH_KINDS, POINT_KINDS, hard_mesh, hard_point, is_between, place};
use truth::rng::Rng;
use truth::soups::Soup;
use truth::tally::tenth;

/// Checks points against exact truth; returns how many are outside, on and inside.
fn judge(soup: &Soup, count: usize, rng: &mut Rng, told: &str) -> [usize; 3] {
    let mesh = mesh(soup);
    assert_eq!(mesh.kind(), MeshKind::Solid, "{told}");
    let points: Vec<_> = (0..count).map(|k| hard_point(soup, k % POINT_KINDS, rng)).collect();
    let query = PointQuery::new(&mesh);
    let given: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
    let plain = super::ask(&query, &given, told);
    let proven = query.clone().prepared();
    assert_eq!(super::ask(&proven, &given, told), plain, "{told}: prepared");
    let mut tally = [0; 3];
    for ((k, p), found) in points.iter().enumerate().zip(plain) {
        let told = format!("{told}, kind {}, {p:?}: {found:?}", k % POINT_KINDS);
        // Coordinates below 2^-200 of the size count as zero.
        let flush = soup.radius() * 2f64.powi(-202);
        let p = p.map(|x| if x.abs() < flush { 0.0 } else { x });
        let truth = place(soup, p, rng);
        let state = truth.state();
        tally[truth as usize] += 1;
        assert_eq!(found.state, state, "{told}");
        let lower = found.lower.abs().min(found.upper.abs());
        let upper = found.upper.abs().max(found.lower.abs());
        assert!(is_between(soup, p, lower, upper), "{told}");
        let width = upper - lower;
        assert!(width <= 2e-14 * (soup.radius() + upper), "{width:e}: {told}");
    }
    tally
}

/// Points per mesh and pass; a million in the record.
fn count() -> usize {
    std::env::var("LIN_CANNY_POINTS").map_or_else(|_| tenth(24), |n| n.parse().expect("a number"))
}

#[test]
fn sides_and_distances_of_meshes_are_those_of_exact_arithmetic() {
    let (mut rng, mut tally) = (Rng::new(72), [0; 3]);
    let scales = [1.0, 1.0, 2f64.powi(-329), 2e-100, 1e-30, 3e50, 1e99];
    for (pass, scale) in scales.into_iter().enumerate() {
        for kind in 0..MESH_KINDS {
            let mut soup = hard_mesh(kind, &mut rng);
            if pass == 1 {
                let pose = truth::Pose::new(rng.quat(), [0.3, 0.1, -0.7]);
                soup = soup.moved(&pose);
            }
            let soup = soup.map(|p| p.map(|x| x * scale));
            let told = format!("mesh {kind} times {scale:e}");
            let found = judge(&soup, count(), &mut rng, &told);
            (0..3).for_each(|k| tally[k] += found[k]);
        }
    }
    println!("outside, on, inside: {tally:?}");
    assert!(tally.iter().all(|n| *n > count()), "{tally:?}");
}

#[test]
fn a_mesh_far_from_the_origin_is_measured_as_one_at_the_origin() {
    let mut rng = Rng::new(5);
    for shift in [1e3, 1e6, 2f64.powi(40)] {
        for kind in [0, 1, 2, 5, 8] {
            let soup = hard_mesh(kind, &mut rng).map(|p| p.map(|x| x + shift));
            let mesh = mesh(&soup);
            let query = PointQuery::new(&mesh);
            for k in 0..20 {
                let corners = soup.corners(rng.below(soup.triangles.len()));
                let off = if k % 2 == 0 { 1.0 } else { 1e-3 };
                let p: [f64; 3] = std::array::from_fn(|i| corners[0][i] + off * rng.range(-1.0, 1.0));
                let found = query.closest_point(&Point3::from(p)).expect("a point");
                let told = format!("mesh {kind} at {shift:e}, {p:?}: {found:?}");
                let truth = place(&soup, p, &mut rng);
                assert_eq!(found.is_contained(), truth != Place::Outside, "{told}");
                let (x, y) = (found.lower.abs(), found.upper.abs());
                assert!(is_between(&soup, p, x.min(y), x.max(y)), "{told}");
                assert!((x - y).abs() < 3e-14, "{told}");
            }
        }
    }
}

#[test]
fn an_open_mesh_contains_its_surface_alone() {
    let mut soup = hard_mesh(0, &mut Rng::new(1));
    let lid = soup.triangles.pop().expect("a triangle");
    let mesh = mesh(&soup);
    let query = PointQuery::new(&mesh).prepared();
    let inside = Point3::new(0.1, 0.2, 0.0);
    let found = query.closest_point(&inside).expect("a point");
    assert_eq!(found.state, ContactState::Separated);
    assert!(!query.contains(&inside).expect("a point"));
    let corner = Point3::from(soup.points[lid[0] as usize]);
    assert!(query.contains(&corner).expect("a point"));
    let answer = query.closest_point(&corner).expect("a point").state;
    assert_eq!(answer, ContactState::Touching);
}

#[test]
fn meshes_with_faults_follow_the_winding_number() {
    let mut rng = Rng::new(9);
    for _ in 0..40 {
        let clean = truth::faults::on_grid(hard_mesh(rng.below(9), &mut rng));
        let soup = truth::faults::faulty(&clean, &mut rng);
        let mesh = mesh(&soup);
        if mesh.kind() != MeshKind::Solid {
            continue;
        }
        let query = PointQuery::new(&mesh);
        let proven = query.clone().prepared();
        for _ in 0..20 {
            let p = hard_point(&clean, rng.below(8), &mut rng);
            // The mesh drops repeated triangles, so the clean one is the judge.
            let truth = place(&clean, p, &mut rng);
            let asked = Point3::from(p);
            let found = query.closest_point(&asked).expect("a point");
            assert_eq!(found, proven.closest_point(&asked).expect("a point"));
            // Slivers that cancel are surface.
            if truth == Place::On || found.state != ContactState::Touching {
                assert_eq!(found.is_contained(), truth != Place::Outside, "{p:?}: {found:?}");
            }
        }
    }
}

#[test]
fn a_batch_names_a_point_that_is_not_finite() {
    let mesh = mesh(&hard_mesh(0, &mut Rng::new(1)));
    let query = PointQuery::new(&mesh);
    let mut points = vec![Point3::origin(); 5];
    for bad in [f64::NAN, f64::INFINITY, 1e116] {
        points[3].y = bad;
        let error = query.closest_points(&points).expect_err("a bad point");
        assert!(matches!(error, PointError::OutOfRange { index: 3, .. }), "{error:?}");
        assert!(
            error
                .to_string()
                .starts_with("point 3 is not finite or farther than 1e116"),
            "{error}"
        );
        assert!(query.contains_each(&points).is_err() && query.signed_distances(&points).is_err());
        assert!(query.closest_point(&points[3]).is_err() && query.contains(&points[3]).is_err());
        assert!(PointTracker::new().closest_point(&query, &points[3]).is_err());
    }
    assert_eq!(query.closest_points(&[]).expect("no points"), []);
}

#[test]
fn points_at_any_distance_have_bounds_as_close_as_rounding() {
    for scale in [2e-100, 1.0, 2e99] {
        let soup = hard_mesh(1, &mut Rng::new(1)).map(|p| p.map(|x| x * scale));
        let mesh = mesh(&soup);
        let query = PointQuery::new(&mesh);
        for far in [1.0, 1e3, 1e8, 1e15, 1e30, 1e115 / scale] {
            let p = Point3::new(0.3, -0.4, 0.6) * (far * scale);
            if far * scale > 1e115 {
                continue;
            }
            let found = query.closest_point(&p).expect("a point");
            super::check_form(&p, &found, &format!("{scale:e} {far:e}"));
            assert!(found.upper - found.lower <= 1e-14 * (scale + found.upper), "{found:?}");
            let off = (found.distance - p.coords.norm()).abs();
            assert!(off <= 1.1 * scale + 1e-14 * found.distance, "{found:?}");
        }
    }
}

#[test]
fn a_tracked_path_has_the_bits_of_single_queries() {
    let mut rng = Rng::new(3);
    for kind in 0..MESH_KINDS {
        let soup = hard_mesh(kind, &mut rng);
        let mesh = mesh(&soup);
        let query = PointQuery::new(&mesh).prepared();
        let (mut tracker, mut p) = (PointTracker::new(), Point3::new(0.1, 0.2, 0.3));
        for k in 0..400 {
            let step = [1e-4, 1e-2, 0.3][k % 3];
            p += lin_canny::nalgebra::Vector3::from(rng.unit()) * step;
            let found = tracker.closest_point(&query, &p).expect("a point");
            assert_eq!(found, query.closest_point(&p).expect("a point"), "mesh {kind}");
        }
    }
}
