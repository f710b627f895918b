//! Promise: the side of a point is right, its distance lies within the bounds, and batches and
//! trackers return the same bits.

mod faults;
mod grid;
mod kinds;
mod lattice;
mod meshes;
mod turned_boxes;

use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, PointOutcome, PointQuery, PointTracker};

/// Checks what every outcome promises by itself.
fn check_form(p: &Point3<f64>, found: &PointOutcome, told: &str) {
    let told = format!("{told}, {p:?}: {found:?}");
    assert!(found.lower <= found.distance && found.distance <= found.upper, "{told}");
    assert!(!found.distance.is_nan(), "{told}");
    assert!(found.point.iter().all(|x| x.is_finite()), "{told}");
    assert!((found.normal.norm() - 1.0).abs() < 1e-14, "{told}");
    match found.state {
        ContactState::Separated => assert!(found.lower >= 0.0, "{told}"),
        ContactState::Overlapping => assert!(found.upper <= 0.0, "{told}"),
        ContactState::Touching => assert!(found.lower <= 0.0 && found.upper >= 0.0, "{told}"),
        _ => {}
    }
}

/// Returns the outcomes of points one by one, after checking that all calls agree with them.
fn ask(query: &PointQuery<'_>, points: &[Point3<f64>], told: &str) -> Vec<PointOutcome> {
    let mut tracker = PointTracker::new();
    let one = |p: &Point3<f64>| query.closest_point(p).expect("a point");
    let alone: Vec<PointOutcome> = points.iter().map(one).collect();
    assert_eq!(query.closest_points(points).expect("points"), alone, "{told}: batch");
    let held = query.contains_each(points).expect("points");
    for ((p, found), held) in points.iter().zip(&alone).zip(held) {
        check_form(p, found, told);
        assert_eq!(query.contains(p).expect("a point"), held, "{told}: contains {p:?}");
        assert_eq!(held, found.is_contained(), "{told}: contains {p:?}: {found:?}");
        let tracked = tracker.closest_point(query, p).expect("a point");
        check_form(p, &tracked, told);
        assert_eq!(tracked.state, found.state, "{told}: tracked {p:?}");
        assert!(tracked.lower <= found.upper, "{told}: tracked {p:?}");
        assert!(found.lower <= tracked.upper, "{told}: tracked {p:?}");
    }
    alone
}
