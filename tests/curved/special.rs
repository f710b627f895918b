//! Promise: the same holds at special poses: flush over an edge, near parallel axes.

use lin_canny::nalgebra::Vector3;
use lin_canny::{ContactState, Manifold, ManifoldOptions, Outcome, PairTracker};
use truth::curved::special::{about_parallel_axes, flush_over_edge};
use truth::rng::Rng;

/// Returns whether an outcome of flush shapes is the gap along the axis of the faces.
fn is_flush(o: &Outcome, side: f64, apart: f64, size: f64) -> bool {
    let near = |x: f64| (x - apart).abs() <= 1e-13 * size;
    let bounded = o.lower <= apart + 1e-15 * size && apart <= o.upper + 1e-15 * size;
    bounded && near(o.distance) && side * o.normal.z > 1.0 - 1e-9
}

/// A flat face flush on another with a small overlap: one signed distance with one normal for any
/// overlap, cold and lowered from above.
#[test]
fn a_face_flush_over_an_edge_is_a_gap_along_its_axis() {
    let (mut rng, mut sideways, mut told) = (Rng::new(2400), [0; 3], String::new());
    for _ in 0..super::count() * 10 {
        let ([a, b], place, side, apart) = flush_over_edge(&mut rng);
        let (x, y, size) = (a.shape(), b.shape(), place.size(&a, &b));
        let mut note = |way: usize, what: &Outcome| {
            sideways[way] += 1;
            if sideways[way] < 3 {
                told += &format!("{way} {a:?} {b:?} {place:?} apart {apart:e}\n{what:?}\n");
            }
        };
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        if !is_flush(&o, side, apart, size) {
            note(0, &o);
        }
        let (mut pair, mut last) = (PairTracker::new(), o);
        for lift in [0.1, 1e-2, 1e-4, 1e-7, 1e-11, 0.0] {
            let mut lifted = place;
            lifted.t[2] += side * lift;
            last = pair.closest(&x, &y, &lifted.pose());
        }
        if !is_flush(&last, side, apart, size) {
            note(1, &last);
        }
        let mut manifold = Manifold::new();
        pair.manifold(
            &x,
            &y,
            &place.pose(),
            &ManifoldOptions::default().prediction(1e-6),
            &mut manifold,
        )
        .unwrap();
        let upright = |n: Vector3<f64>| side * n.z > 1.0 - 1e-9;
        if manifold.points().is_empty() || !upright(*manifold.normal()) {
            note(2, &last);
        }
    }
    assert_eq!(sideways, [0; 3], "cold, warm, contacts\n{told}");
}

/// Cylinders and cones about parallel axes: the depth is that of two polygons, as tight as for
/// separated bodies, though a whole circle of directions attains it.
#[test]
fn depths_about_parallel_axes_are_closed() {
    let (mut rng, mut told, mut bad, mut deep) = (Rng::new(2402), String::new(), 0, 0);
    for _ in 0..super::count() {
        let ([a, b], place) = about_parallel_axes(&mut rng);
        let (x, y, size) = (a.shape(), b.shape(), place.size(&a, &b));
        for (x, y, pose) in [(&x, &y, place.pose()), (&y, &x, place.pose().swapped())] {
            let o = PairTracker::new().closest(x, y, &pose);
            if o.state == ContactState::Separated {
                continue;
            }
            deep += 1;
            if o.state != ContactState::Overlapping || o.upper - o.lower > 1e-13 * size {
                bad += 1;
                if bad < 4 {
                    told += &format!("{:e} {a:?} {b:?} {place:?}\n{o:?}\n", (o.upper - o.lower) / size);
                }
            }
        }
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        let known = super::suites::sampled(&a, &b, &place, &mut rng);
        assert!(known <= o.upper + 1e-15 * size, "{known:e} {a:?} {b:?} {place:?} {o:?}");
    }
    assert!(bad == 0 && deep > 300, "{bad} of {deep}\n{told}");
}
