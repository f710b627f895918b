//! Generated faults of real mesh files: none of them opens a closed surface.

use super::{mesh, relative};
use lin_canny::{ContactState, MeshKind, PairTracker};
use truth::faults::{faulty, on_grid, slit};
use truth::pose::scale;
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

#[test]
fn no_fault_opens_a_closed_surface() {
    let shapes = [
        soups::torus(16, 8, 0.3),
        soups::rock(2, 1),
        soups::gear(8),
        soups::bracket(),
        soups::plate(2, [1.0, 0.5, 0.125]),
    ]
    .map(on_grid);
    let pebble = soups::sphere(1).map(|p| scale(p, 0.03));
    let small = mesh(&pebble);
    let mut rng = Rng::new(77);
    let mut inside = 0;
    for k in 0..200 {
        let clean = &shapes[k % shapes.len()];
        let soup = faulty(clean, &mut rng);
        let m = mesh(&soup);
        assert_eq!(m.kind(), MeshKind::Solid, "{k}: {} {:?}", m.report(), soup.triangles);
        let volume = mesh(clean).volume();
        assert!((m.volume() - volume).abs() < 1e-9 * volume, "{k}: {}", m.report());
        let mut tracker = PairTracker::new();
        for _ in 0..10 {
            let pose = Pose::new(rng.quat(), scale(rng.in_ball(), 1.2));
            if brute::distance(clean, &pebble, &pose).0 < 1e-9 {
                continue;
            }
            let contained = brute::winding(clean, pose.apply(pebble.points[0])).abs() > 0.5;
            let state = if contained {
                ContactState::Overlapping
            } else {
                ContactState::Separated
            };
            let found = tracker.closest(&m, &small, &relative(&pose));
            assert_eq!(found.state, state, "{k}: {} {pose:?}", m.report());
            assert_eq!(tracker.intersects(&m, &small, &relative(&pose)), contained);
            inside += usize::from(contained);
        }
    }
    assert!(inside > 100, "{inside}");
}

#[test]
fn layers_that_share_a_face_count_twice() {
    // Two boxes on the same bottom, one higher than the other.
    let low = soups::plate(1, [1.0, 1.0, 0.5]);
    let high = low.clone().map(|[x, y, z]| [x, y, 2.0 * z + 0.5]);
    let both = low.with(&high);
    let m = mesh(&both);
    assert_eq!(m.kind(), MeshKind::Solid, "{}", m.report());
    assert!((m.volume() - 12.0).abs() < 1e-12, "{}", m.volume());
    let pebble = mesh(&soups::sphere(1).map(|p| scale(p, 0.05)));
    for (z, state) in [
        (0.0, ContactState::Overlapping),
        (1.0, ContactState::Overlapping),
        (1.6, ContactState::Separated),
    ] {
        let at = relative(&Pose::shift([0.1, 0.2, z]));
        assert_eq!(PairTracker::new().closest(&m, &pebble, &at).state, state, "{z}");
    }
}

/// Returns a cone of a fan whose edges at the apex are alternately whole and cut at their middle.
///
/// The triangles without area between them are removed.
fn cut_fan(n: u32) -> Soup {
    let grid = |x: f64| (x * 1_048_576.0).round() / 524_288.0;
    let rim = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        [grid(angle.cos()), grid(angle.sin()), 2.0]
    };
    let mut points = vec![[0.0; 3], [0.0, 0.0, 2.0]];
    points.extend((0..n).map(rim));
    points.extend((0..n).map(|k| scale(rim(k), 0.5)));
    let mut triangles = Vec::new();
    for k in 0..n {
        let (r, next, cut) = (2 + k, 2 + (k + 1) % n, 2 + n + (k + 1) % n);
        triangles.extend([[0, cut, r], [r, cut, next], [0, next, cut], [1, r, next]]);
    }
    Soup::new(points, triangles)
}

#[test]
fn a_fan_of_triangles_without_area_builds_in_time() {
    for n in [64, 10_000] {
        let begun = std::time::Instant::now();
        let m = mesh(&cut_fan(n));
        assert_eq!(m.kind(), MeshKind::Solid, "{n}");
        assert_eq!(m.report().degenerate.len(), n as usize);
        // Testing all pairs of lines would take half a minute or more.
        assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
        let mut open = cut_fan(n);
        open.points[2 + n as usize + 7][2] += 1.0 / 1_048_576.0;
        open.triangles.retain(|t| *t != [0, 9, 9 + n]);
        assert_eq!(mesh(&open).kind(), MeshKind::Open, "{n}");
    }
}

#[test]
fn a_border_stays_a_border() {
    // A slit that is really open: the middle of the edge is off the edge.
    let mut rng = Rng::new(78);
    for k in 0..50 {
        let mut soup = on_grid(soups::rock(1, 1));
        slit(&mut soup, &mut rng, k % 2 == 0);
        let last = soup.points.len() - 1;
        soup.points[last][k % 3] += 2f64.powi(-40);
        let m = mesh(&soup);
        // A cap with area closes it again.
        let kind = if k % 2 == 0 { MeshKind::Solid } else { MeshKind::Open };
        assert_eq!(m.kind(), kind, "{k}: {}", m.report());
    }
    // A strip whose long borders are straight lines of several edges.
    let points: Vec<[f64; 3]> = (0..10).map(|k| [f64::from(k / 2), f64::from(k % 2), 0.0]).collect();
    let triangles = (0..8).map(|k| {
        if k % 2 == 0 {
            [k, k + 2, k + 1]
        } else {
            [k, k + 1, k + 2]
        }
    });
    let strip = Soup::new(points, triangles.collect());
    assert_eq!(mesh(&strip).kind(), MeshKind::Open);
}
