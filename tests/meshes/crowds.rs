//! Work of queries of bodies that are in contact nearly everywhere: at the same pose, or filling
//! each other.

use super::{mesh, relative, shapes};
use lin_canny::{ContactState, Mesh, MeshKind, PairTracker, TreeWork};
use truth::Pose;
use truth::pose::{quat, scale};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Returns a dome of `2 n n` triangles over a square: an open mesh.
fn dome(n: usize) -> Soup {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let mut soup = Soup::default();
    for k in 0..(n + 1) * (n + 1) {
        let [x, y] = [k / (n + 1), k % (n + 1)].map(|i| 2.0 * i as f64 / n as f64 - 1.0);
        soup.points.push([x, y, 0.5 - 0.25 * (x * x + y * y)]);
    }
    for k in 0..n * n {
        let (i, j) = (k / n, k % n);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        soup.triangles.extend([[a, b, c], [a, c, d]]);
    }
    soup
}

/// Returns bodies with hundreds to thousands of triangles.
fn crowded() -> Vec<Soup> {
    let mut all = shapes();
    all.extend([
        dome(24),
        soups::sphere(3),
        soups::sphere(3).map(|[x, y, z]| [x, y, z * z * z]),
        soups::gear(40),
        soups::plate(10, [1.0, 1.0, 0.05]),
        soups::cave(3, 0.7),
        // About a hundred sides, ten radii long.
        soups::gear(25).map(|[x, y, z]| [x, y, 25.0 * z]),
    ]);
    all
}

/// Returns a pose that moves a body by nearly nothing: by a rotation, a shift, or both.
fn nearly_nothing(rng: &mut Rng, k: usize) -> Pose {
    let by = 10f64.powf(rng.range(-17.0, -11.0));
    Pose::new(
        quat(rng.unit(), if k % 3 == 1 { 0.0 } else { by }),
        scale(rng.unit(), if k.is_multiple_of(3) { 0.0 } else { by }),
    )
}

/// Returns the work and the contact state of `closest`: cold, again, after another pose, and
/// swapped.
fn closest(a: &Mesh, b: &Mesh, pose: &Pose) -> (TreeWork, ContactState) {
    let (at, mut tracker) = (relative(pose), PairTracker::new());
    let found = tracker.closest(a, b, &at);
    let work = tracker.work();
    assert!(found.lower <= 0.0 && found.upper >= 0.0, "{found:?}");
    let mut classes = vec![tracker.closest(a, b, &at).state];
    let _ = tracker.closest(a, b, &relative(&pose.moved_to([0.3, 0.2, 0.1])));
    classes.push(tracker.closest(a, b, &at).state);
    classes.push(PairTracker::new().closest(b, a, &at.swapped()).state);
    assert_eq!(classes, [found.state; 3], "{found:?}");
    (work.trees, found.state)
}

#[test]
fn bodies_in_one_place_take_few_pairs() {
    let mut rng = Rng::new(61);
    let mut measured = Vec::new();
    for (k, soup) in crowded().iter().enumerate() {
        let m = mesh(soup);
        let grown = [1.0 - 1e-14, 1.0 + 1e-15].map(|s| mesh(&soup.clone().map(|p| scale(p, s))));
        for i in 0..12 {
            let pose = nearly_nothing(&mut rng, i);
            let n = [&m, &m, &grown[0], &grown[1]][i / 3];
            let (work, state) = closest(&m, n, &pose);
            let is_solid = m.kind() == MeshKind::Solid;
            assert_eq!(state == ContactState::Overlapping, is_solid, "{k} {i}");
            measured.push((work.measured, k, i));
            if is_solid {
                let mut tracker = PairTracker::new();
                assert!(tracker.intersects(&m, n, &relative(&pose)), "{k} {i}");
                measured.push((tracker.work().trees.measured, k, i));
            }
        }
    }
    measured.sort_unstable();
    let (median, worst) = (measured[measured.len() / 2], measured[measured.len() - 1]);
    // Absolute, because a median that falls would make a ratio to it stricter.
    assert!(median.0 <= 28 && worst.0 < 700, "{median:?} {worst:?}");
}

#[test]
fn surfaces_on_each_other_keep_their_class() {
    let m = mesh(&dome(24));
    let few = mesh(&dome(5));
    let lifted = |gap: f64| relative(&Pose::shift([0.0, 0.0, gap]));
    let mut tracker = PairTracker::new();
    for gap in [0.0, 1e-17, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9, 1e-4] {
        for (pose, flip) in [(lifted(gap), false), (lifted(gap).swapped(), true)] {
            let state = if gap < 5e-13 {
                ContactState::Touching
            } else {
                ContactState::Separated
            };
            let mut cold = PairTracker::new();
            for found in [cold.closest(&m, &m, &pose), tracker.closest(&m, &m, &pose)] {
                assert_eq!(found.state, state, "{gap:e} {flip} {found:?}");
                // The slope of the rim is the greatest.
                assert!(found.lower <= gap && gap <= 1.3 * found.upper, "{gap:e} {found:?}");
            }
            if gap < 5e-14 {
                assert!(cold.work().trees.measured < 8, "{gap:e} {:?}", cold.work());
            }
            // The predicate is exact below rounding too.
            let meets = PairTracker::new().intersects(&few, &few, &pose);
            assert_eq!(meets, gap == 0.0, "{gap:e} {flip}");
        }
    }
}

#[test]
fn depths_of_bodies_in_one_place_take_few_winding_numbers() {
    let mut rng = Rng::new(62);
    for (k, soup) in crowded().iter().enumerate() {
        let m = mesh(soup);
        if m.kind() != MeshKind::Solid {
            continue;
        }
        for by in [1e-9, 1e-5, 1e-2] {
            let at = relative(&Pose::shift(scale(rng.unit(), by)));
            let mut tracker = PairTracker::new();
            let found = tracker.penetration(&m, &m, &at).unwrap();
            assert!(0.0 < found.lower && found.lower <= found.upper, "{found:?}");
            // A dozen moves, each of which tests the vertices of both bodies.
            let (looks, work) = (24 * m.vertex_count() as u64, tracker.work());
            assert!(found.queries <= 35, "{k} {by:e} {work:?}");
            assert!(2 * work.trees.windings < looks + 100, "{k} {by:e} {work:?}");
        }
    }
}
