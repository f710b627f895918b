//! Frames of deforming meshes.
//!
//! Distances, contact states, bounds, predicates and self-distances are judged by brute force in
//! exact arithmetic. Rays, depths, surfaces and planners are compared with new meshes.

use super::bending::{WAYS, anew, bent, sheet, vertices};
use super::own::judge_answer;
use super::{mesh, relative};
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{ContactState, Geometry, Mesh, MeshKind, PairTracker, Ray, RayCast, RayCaster};
use lin_canny_plan::{Cell, Checker, RigidSpace};
use truth::exact_meshes::{apart, itself};
use truth::pose::{quat, quat_mul, unit_quat};
use truth::rational::{RBig, exact};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

/// Frames of one body that deforms in one way.
const CLIP: usize = 20;

#[derive(Debug, Default)]
struct Tally {
    /// By contact state: separated, touching, overlapping.
    classes: [usize; 3],
    within: usize,
    selves: [usize; 2],
    rays: [usize; 2],
    depths: usize,
    surfaces: usize,
    free: [usize; 2],
}

/// Returns whether one of two bodies with separated surfaces contains the other.
fn is_held((a, m): (&Soup, &Mesh), (b, n): (&Soup, &Mesh), pose: &Pose) -> bool {
    let inside = |s: &Soup, body: &Mesh, p| body.kind() == MeshKind::Solid && brute::winding(s, p).abs() > 0.5;
    inside(a, m, pose.apply(b.points[0])) || inside(b, n, pose.apply_inverse(a.points[0]))
}

impl Tally {
    fn judge(
        &mut self,
        tracker: &mut PairTracker,
        (a, m): (&Soup, &Mesh),
        (b, n): (&Soup, &Mesh),
        pose: &Pose,
        what: &str,
    ) {
        let (square, _) = apart(a, b, pose);
        let at = relative(pose);
        let found = tracker.closest(m, n, &at);
        let size = super::size(a, b, pose);
        let is_held = square > RBig::ZERO && is_held((a, m), (b, n), pose);
        match found.state {
            ContactState::Overlapping => {
                assert!(m.kind() == MeshKind::Solid, "{what}: {found:?}");
                assert!(n.kind() == MeshKind::Solid, "{what}: {found:?}");
                assert!(square == RBig::ZERO || is_held, "{what}: {found:?} {square}");
                self.classes[2] += 1;
            }
            _ => {
                assert!(!is_held, "{what}: {found:?}");
                judge_answer(&found, &square, size, what);
                self.classes[usize::from(found.state == ContactState::Touching)] += 1;
            }
        }
        let meets = square == RBig::ZERO || is_held;
        assert_eq!(tracker.intersects(m, n, &at), meets, "{what}: {found:?} {square}");
        for d in [
            found.upper,
            found.lower.next_down(),
            0.5 * (found.lower + found.upper),
            found.lower * 0.99,
        ] {
            let is_within = d >= 0.0 && (meets || square <= exact(d) * exact(d));
            if d.is_finite() {
                let answer = tracker.within(m, n, &at, d);
                assert_eq!(answer, is_within, "{what}: {d} {found:?} {square}");
                self.within += 1;
            }
        }
        assert!(tracker.lower_bound(m, n, &at) <= found.upper.max(0.0), "{what}");
    }

    fn judge_self(&mut self, tracker: &mut PairTracker, a: &Soup, m: &Mesh, what: &str) {
        let (square, _) = itself(a).expect("triangles that share no vertex");
        let found = tracker.self_closest(m).expect("triangles that share no vertex");
        judge_answer(&found, &square, 2.0 * a.radius(), what);
        assert_eq!(tracker.self_within(m, 0.0), square == RBig::ZERO, "{what}");
        let d = found.lower.next_down();
        assert!(d < 0.0 || !tracker.self_within(m, d), "{what}");
        self.selves[usize::from(square == RBig::ZERO)] += 1;
    }

    /// Compares rays, depths, surfaces and planners with a new mesh.
    fn judge_others(&mut self, rng: &mut Rng, a: &Soup, m: &Mesh, (b, n): (&Soup, &Mesh), pose: &Pose, what: &str) {
        let Some(fresh) = anew(a).filter(|f| f.kind() == m.kind() && f.report().degenerate.is_empty()) else {
            return;
        };
        for _ in 0..4 {
            let from = Point3::from(rng.unit().map(|x| 3.0 * x));
            let to = Point3::from(rng.unit().map(|x| 0.6 * x));
            let ray = Ray::new(from, to - from).unwrap();
            let cast = |mesh: &Mesh| RayCaster::new().cast(mesh, &Isometry3::identity(), &ray, 9.0).unwrap();
            match (cast(m), cast(&fresh)) {
                (RayCast::Miss, RayCast::Miss) => self.rays[0] += 1,
                (RayCast::Hit(p), RayCast::Hit(q)) => {
                    assert!(p.safe <= q.hit + 1e-9 && q.safe <= p.hit + 1e-9, "{what}: {p:?} {q:?}");
                    self.rays[1] += 1;
                }
                (p, q) => assert!(
                    p.safe().zip(q.safe()).is_some_and(|(p, q)| (p - q).abs() < 1e-9),
                    "{what}: {p:?} {q:?}"
                ),
            }
        }
        let at = relative(pose);
        let depth = |mesh: &Mesh| PairTracker::new().penetration(mesh, n, &at);
        if let (Some(p), Some(q)) = (depth(m), depth(&fresh)) {
            assert!(p.lower <= q.upper + 1e-12, "{what}: {p:?} {q:?}");
            assert!(q.lower <= p.upper + 1e-12, "{what}: {p:?} {q:?}");
            self.depths += usize::from(p.upper > 0.0);
        }
        let points: Vec<_> = (0..9)
            .map(|k| Point3::new((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0, 0.3 * rng.unit()[0]))
            .collect();
        let surface = BezierSurface::new(vec![BezierPatch::polynomial([2, 2], &points).unwrap()]).unwrap();
        let [p, q] = [m, &fresh].map(|mesh| PairTracker::new().closest(mesh, &surface, &at));
        assert!(p.lower <= q.upper + 1e-9, "{what}: {p:?} {q:?}");
        assert!(q.lower <= p.upper + 1e-9, "{what}: {p:?} {q:?}");
        self.surfaces += 1;
        let mut cell = Cell::new();
        cell.robot_body("robot", Geometry::from(n.clone()));
        cell.add_obstacle("bent", Geometry::from(m.clone()), Isometry3::identity())
            .expect("an obstacle");
        let space = RigidSpace::new([[-60.0, 60.0]; 3], 1.0, 1).unwrap();
        let mut checker = Checker::new(space, cell).unwrap();
        let meets = apart(a, b, pose).0 == RBig::ZERO || is_held((a, m), (b, n), pose);
        let is_free = checker
            .is_free_at(&RigidSpace::configuration(&pose.isometry()))
            .unwrap();
        assert_eq!(is_free, !meets, "{what}");
        self.free[usize::from(is_free)] += 1;
    }
}

/// Runs `frames` frames from a seed.
fn run(frames: usize, seed: u64) -> Tally {
    let mut tally = Tally::default();
    let mut rng = Rng::new(seed);
    let bodies = [
        sheet(7),
        soups::torus(12, 6, 0.3),
        soups::rock(1, 1),
        soups::gear(5),
        soups::knot(20, 4, 0.1),
        sheet(4),
    ];
    let others = [
        soups::rock(1, 3),
        soups::torus(8, 5, 0.4),
        sheet(5).map(|p| p.map(|x| 0.7 * x)),
    ];
    for clip in 0..frames.div_ceil(CLIP) {
        let (way, rest) = (WAYS[clip % WAYS.len()], &bodies[rng.below(bodies.len())]);
        let other = &others[rng.below(others.len())];
        let (mut m, n) = (mesh(rest), mesh(other));
        let (mut warm, mut own) = (PairTracker::new(), PairTracker::new());
        let (start, step) = (rng.range(0.0, 0.8), [0.0005, 0.003, 0.01][rng.below(3)]);
        let (mut q, axis, at, far) = (rng.quat(), rng.unit(), rng.unit(), rng.range(0.2, 2.0));
        for frame in 0..CLIP {
            let time = start + step * frame as f64;
            let now = rest.clone().map(|p| bent(way, time, p));
            let given = vertices(&now);
            let half = given.len() / 2;
            if frame % 3 == 1 {
                m.set_vertices_from(half, &given[half..]).unwrap();
                m.set_vertices_from(0, &given[..half]).unwrap();
            } else {
                m.set_vertices(&given).unwrap();
            }
            q = unit_quat(quat_mul(quat(axis, 0.01), q));
            let centre = if way == "shift" {
                bent(way, time, [0.0; 3])
            } else {
                [0.0; 3]
            };
            let t = [0, 1, 2].map(|k| centre[k] + at[k] * (far - 0.01 * frame as f64));
            let (pose, what) = (Pose::new(q, t), format!("{seed} {clip} {way} {frame}"));
            tally.judge(&mut warm, (&now, &m), (other, &n), &pose, &what);
            if frame % 4 == 0 {
                tally.judge(&mut PairTracker::new(), (&now, &m), (other, &n), &pose, &what);
            }
            if frame % 2 == 0 {
                tally.judge_self(&mut own, &now, &m, &what);
            }
            if frame % 10 == 9 {
                tally.judge_others(&mut rng, &now, &m, (other, &n), &pose, &what);
            }
        }
    }
    tally
}

#[test]
fn frames_are_as_exact_arithmetic_says() {
    let tally = run(400, 1);
    assert!(tally.classes[0] > 50, "{tally:?}");
    assert!(tally.classes[1] > 20, "{tally:?}");
    assert!(tally.classes[2] > 20, "{tally:?}");
    assert!(tally.selves.iter().all(|n| *n > 20) && tally.within > 800, "{tally:?}");
    assert!(tally.rays.iter().all(|n| *n > 5) && tally.surfaces > 10, "{tally:?}");
}

#[test]
#[ignore = "minutes: ten thousand frames in exact arithmetic"]
fn ten_thousand_frames_are_as_exact_arithmetic_says() {
    let tally = run(10_000, 2);
    println!("{tally:?}");
    assert!(tally.depths > 20 && tally.free.iter().all(|n| *n > 50), "{tally:?}");
}
