//! A mesh against itself: distances, contact states and pairs are those of brute force in exact
//! arithmetic, independent of earlier queries.

use super::bending::{WAYS, bent, sheet, vertices};
use super::mesh;
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, PairOutcome, PairTracker, RelativePose};
use truth::exact_meshes::{itself, pairs_within};
use truth::rational::{RBig, exact, rounded, sqrt};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Judges an answer by the exact square of the distance.
pub(crate) fn judge_answer(found: &PairOutcome, square: &RBig, size: f64, what: &str) {
    let (root, _) = sqrt(square);
    let upper = exact(found.upper.max(0.0));
    let lower = exact(found.lower.max(0.0));
    let what = || format!("{what}: {found:?}, exact {root}");
    assert!(&lower * &lower <= *square && *square <= &upper * &upper, "{}", what());
    assert!(found.upper - found.lower < 2e-13 * size, "{}", what());
    assert!((found.distance - root).abs() < 1e-13 * size, "{}", what());
    match found.state {
        ContactState::Separated => assert!(*square > RBig::ZERO && found.lower > 0.0, "{}", what()),
        ContactState::Touching => assert!(found.lower == 0.0 && root < 1e-13 * size, "{}", what()),
        _ => panic!("{}", what()),
    }
}

/// Queries a mesh against itself and judges all answers; returns the contact state.
fn judge(tracker: &mut PairTracker, soup: &Soup, m: &Mesh, what: &str) -> ContactState {
    let size = 2.0 * soup.radius();
    let (square, _) = itself(soup).expect("triangles that share no vertex");
    let found = tracker.self_closest(m).expect("triangles that share no vertex");
    judge_answer(&found, &square, size, what);
    let [p, q] = found.locations.map(|spot| spot.subshape as usize);
    assert!(
        p != q && soup.triangles[p].iter().all(|v| !soup.triangles[q].contains(v)),
        "{what}: {p} {q}"
    );
    let apart = (found.point_on_a - found.point_on_b).norm();
    assert!(
        (apart - found.distance).abs() < 1e-13 * size || found.state == ContactState::Touching,
        "{what}: {apart} {found:?}"
    );
    assert_eq!(tracker.self_within(m, 0.0), square == RBig::ZERO, "{what}");
    for d in [found.upper, found.lower.next_down(), rounded(&exact(found.distance))] {
        let is_within = d >= 0.0 && square <= exact(d) * exact(d);
        assert_eq!(tracker.self_within(m, d), is_within, "{what}: {d} {found:?}");
    }
    found.state
}

/// Compares the pairs within a distance.
fn judge_pairs(tracker: &mut PairTracker, soup: &Soup, m: &Mesh, d: f64, what: &str) -> usize {
    let named = |answer: &PairOutcome| {
        assert!(answer.lower <= d, "{what}: {d} {answer:?}");
        let [p, q] = answer.locations.map(|spot| spot.subshape as usize);
        [p.min(q), p.max(q)]
    };
    let mut found: Vec<_> = tracker.self_pairs(m, d).iter().map(named).collect();
    found.sort_unstable();
    let truth = pairs_within(soup, d);
    let differs = found.iter().zip(&truth).find(|(p, q)| p != q);
    assert!(
        found.len() == truth.len() && differs.is_none(),
        "{what}: {d} {} {} {differs:?}",
        found.len(),
        truth.len()
    );
    found.len()
}

fn bodies() -> [Soup; 4] {
    [
        sheet(7),
        soups::torus(14, 6, 0.3),
        soups::rock(2, 1),
        soups::knot(24, 5, 0.1),
    ]
}

#[test]
fn a_mesh_against_itself_is_as_exact_arithmetic_says() {
    let (mut tally, mut entries, mut failed, mut pairs) = ([0; 2], 0, 0, 0);
    for name in WAYS {
        for (k, rest) in bodies().iter().enumerate() {
            let mut m = mesh(rest);
            let mut warm = PairTracker::new();
            for frame in 0..10 {
                let what = format!("{name} {k} {frame}");
                let now = rest.clone().map(|p| bent(name, f64::from(frame) / 9.0, p));
                m.set_vertices(&vertices(&now)).unwrap();
                let state = judge(&mut warm, &now, &m, &what);
                tally[usize::from(state == ContactState::Separated)] += 1;
                warm.check(&m, &m, &RelativePose::from_isometry(&Default::default()).unwrap())
                    .unwrap();
                if frame % 4 == 0 {
                    let d = 0.02 + 0.01 * f64::from(frame);
                    pairs += judge_pairs(&mut warm, &now, &m, d, &what);
                    judge_pairs(&mut PairTracker::new(), &now, &m, d, &what);
                    judge(&mut PairTracker::new(), &now, &m, &what);
                }
            }
            let work = warm.work().trees;
            (entries, failed) = (entries + work.entries, failed + work.failed);
        }
    }
    assert!(tally.iter().all(|n| *n > 50) && pairs > 5_000, "{tally:?} {pairs}");
    assert!(entries > 50_000 && failed * 3 < entries, "{entries} {failed}");
}

/// Many pairs at exactly the same distance: layers of a lattice.
#[test]
fn ties_on_a_lattice_are_decided_exactly() {
    let rest = sheet(6);
    let mut m = mesh(&rest);
    let mut tracker = PairTracker::new();
    let mut rng = Rng::new(3);
    for frame in 0..60 {
        let at = |x: f64| ((x + 1.0) * 3.0).round();
        let mut now = rest.clone();
        for p in &mut now.points {
            *p = [at(p[0]), at(p[1]), rng.below(3) as f64];
        }
        m.set_vertices(&vertices(&now)).unwrap();
        judge(&mut tracker, &now, &m, &format!("{frame}"));
        for d in [0.0, 0.5, 1.0] {
            judge_pairs(&mut tracker, &now, &m, d, &format!("{frame}"));
        }
    }
}

/// Missed frames, clones, new trees, parts of the vertices, other meshes and other sizes.
#[test]
fn state_of_another_time_or_mesh_changes_no_answer() {
    let (rest, other) = (soups::torus(14, 6, 0.3), soups::knot(24, 5, 0.1));
    let (mut p, mut n) = (mesh(&rest), mesh(&other));
    let mut q = p.clone();
    let (mut tracker, mut rng) = (PairTracker::new(), Rng::new(11));
    for frame in 0..90 {
        let time = f64::from(frame) / 89.0;
        let size = if frame / 30 == 1 { 64.0 } else { 1.0 };
        let grown = |p: [f64; 3]| p.map(|x| size * x);
        let one = rest.clone().map(|p| grown(bent("wave", time, p)));
        let two = rest.clone().map(|p| bent("crumple", time, p));
        let three = other.clone().map(|p| bent("twist", time, p));
        p.set_vertices(&vertices(&one)).unwrap();
        q.set_vertices(&vertices(&two)).unwrap();
        n.set_vertices(&vertices(&three)).unwrap();
        if frame % 17 == 16 {
            p.rebuild();
        }
        if frame % 23 == 22 {
            q = p.clone();
            q.set_vertices(&vertices(&two)).unwrap();
        }
        if frame % 7 < 3 {
            continue;
        }
        match rng.below(8) {
            0 => judge(&mut tracker, &two, &q, "q"),
            1 => judge(&mut tracker, &three, &n, "n"),
            _ => judge(&mut tracker, &one, &p, "p"),
        };
    }
    assert!(tracker.work().trees.failed > 0);
}

#[test]
fn scales_of_powers_of_two_are_bit_for_bit() {
    let rest = soups::knot(24, 5, 0.1);
    let run = |size: f64| {
        let mut m = mesh(&rest.clone().map(|p| p.map(|x| size * x)));
        let mut tracker = PairTracker::new();
        let mut found = Vec::new();
        for frame in 0..20 {
            let now = rest
                .clone()
                .map(|p| bent("twist", f64::from(frame) / 19.0, p).map(|x| size * x));
            m.set_vertices(&vertices(&now)).unwrap();
            let answer = tracker.self_closest(&m).unwrap();
            found.push((
                answer.state,
                answer.distance / size,
                tracker.self_pairs(&m, 0.05 * size).len(),
            ));
        }
        found
    };
    let one = run(1.0);
    for exponent in [-300, -90, -1, 90, 300] {
        assert_eq!(run(2f64.powi(exponent)), one, "{exponent}");
    }
}

#[test]
fn meshes_whose_triangles_all_share_a_vertex_have_no_distance() {
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let points = [
        at(0., 0., 0.),
        at(1., 0., 0.),
        at(0., 1., 0.),
        at(0., 0., 1.),
        at(-1., 0., 0.),
        at(0., -1., 0.),
    ];
    let fan = Mesh::new(&points, &[[0, 1, 2], [0, 2, 4], [0, 4, 5]]).unwrap();
    let wedge = Mesh::new(&points[..4], &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
    for m in [fan, wedge] {
        let mut tracker = PairTracker::new();
        for _ in 0..3 {
            assert!(tracker.self_closest(&m).is_none());
            assert!(!tracker.self_within(&m, f64::INFINITY) && tracker.self_pairs(&m, 10.0).is_empty());
        }
    }
    let m = mesh(&sheet(3));
    let mut tracker = PairTracker::new();
    for d in [-1.0, f64::NAN, -0.5] {
        assert!(!tracker.self_within(&m, d), "{d}");
        assert!(tracker.self_pairs(&m, d).is_empty(), "{d}");
    }
    let all = tracker.self_pairs(&m, f64::INFINITY).len();
    assert_eq!(all, pairs_within(&sheet(3), 1e3).len());
}
