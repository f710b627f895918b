//! Lower bounds of the penetration depth if edges cross and no vertex is inside.
//!
//! They are compared with the certified depth of convex bodies, and with translations that separate
//! the bodies.

use super::{mesh, relative};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Mesh, PairTracker, PenetrationBounds, Piece, RelativePose, Shape,
};
use truth::Pose;
use truth::pose::{add, quat, quat_mul, scale, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Ratios of lower and upper bounds of a family, and the number of poses with lower bound zero.
#[derive(Default)]
struct Ratios(Vec<f64>);

impl Ratios {
    fn push(&mut self, o: &PenetrationBounds) {
        assert!(0.0 <= o.lower && o.lower <= o.upper, "{o:?}");
        self.0.push(o.lower / o.upper);
    }

    fn median(&mut self, name: &str) -> f64 {
        self.0.sort_by(f64::total_cmp);
        let at = |part: f64| self.0[(part * (self.0.len() - 1) as f64) as usize];
        let none = self.0.iter().filter(|r| **r == 0.0).count();
        println!(
            "{name}: {} overlaps, {none} without a lower bound; lower over upper: {:.3} at 10 %, {:.3} in the middle",
            self.0.len(),
            at(0.1),
            at(0.5)
        );
        at(0.5)
    }
}

fn of_meshes(a: &Mesh, b: &Mesh, at: &RelativePose) -> PenetrationBounds {
    PairTracker::new().penetration(a, b, at).expect("two solids")
}

/// Asserts, for some shifts, that no shift shorter than the lower bound separates the bodies.
fn check(o: &PenetrationBounds, pose: &Pose, rng: &mut Rng, mut state: impl FnMut(&RelativePose) -> ContactState) {
    let moved = |by: Vector3<f64>| relative(&pose.shifted(by.into()));
    assert_eq!(state(&moved(o.shift)), ContactState::Separated, "{o:?}");
    for by in [
        o.shift.normalize(),
        Vector3::from(rng.unit()),
        Vector3::from(rng.unit()),
    ] {
        let found = state(&moved(by * (o.lower * 0.999)));
        assert_eq!(found, ContactState::Overlapping, "{o:?} {by}");
    }
}

#[test]
fn bars_that_cross_have_the_depth_of_their_edges() {
    let mut rng = Rng::new(71);
    let halves = [[1.0, 0.1, 0.1], [0.9, 0.12, 0.08]];
    let bars = halves.map(|h| soups::plate(1, h));
    let fine = soups::plate(4, halves[0]);
    let (mut coarse, mut cut, mut mixed) = (Ratios::default(), Ratios::default(), Ratios::default());
    for k in 0..60 {
        // Each about its axis, then one across the other.
        let own = [0, 1].map(|_| quat([1.0, 0.0, 0.0], rng.range(0.3, 1.2)));
        let across = quat([0.0, 0.0, 1.0], rng.range(0.4, 1.57));
        let turned = bars[0].clone().moved(&Pose::new(own[0], [0.0; 3]));
        let finer = fine.clone().moved(&Pose::new(own[0], [0.0; 3]));
        let q = unit_quat(quat_mul(across, own[1]));
        let shapes = [&turned, &bars[1]].map(|s| {
            let points: Vec<_> = s.points.iter().map(|p| Point3::from(*p)).collect();
            Shape::from(ConvexPolyhedron::from_points(&points).unwrap())
        });
        // Down until the edges cross slightly.
        let mut pose = Pose::new(q, [rng.range(-0.4, 0.4), rng.range(-0.2, 0.2), 0.5]);
        let apart = PairTracker::new()
            .closest(&shapes[0], &shapes[1], &relative(&pose))
            .distance;
        pose.t[2] -= apart + [1e-4, 3e-3, 0.03][k % 3];
        let at = relative(&pose);
        let truth = PairTracker::new().closest(&shapes[0], &shapes[1], &at);
        if truth.state != ContactState::Overlapping {
            continue;
        }
        let (a, b) = (mesh(&turned), mesh(&bars[1]));
        let pieces = Compound::new(vec![Piece::new(shapes[1].clone())]).unwrap();
        let found = [
            of_meshes(&a, &b, &at),
            of_meshes(&mesh(&finer), &b, &at),
            PairTracker::new().penetration(&a, &pieces, &at).unwrap(),
        ];
        for (o, ratios) in found.iter().zip([&mut coarse, &mut cut, &mut mixed]) {
            assert!(o.lower <= -truth.lower + 1e-12, "{k} {o:?} {truth:?}");
            assert!(o.upper >= -truth.upper - 1e-12, "{k} {o:?} {truth:?}");
            ratios.push(o);
        }
        check(&found[0], &pose, &mut rng, |p| {
            PairTracker::new().closest(&a, &b, p).state
        });
    }
    let all = [
        coarse.median("bars"),
        cut.median("bars in squares"),
        mixed.median("a bar and a piece"),
    ];
    assert!(all.iter().all(|m| *m > 0.99), "{all:?}");
}

/// Returns the median ratio for bodies moved together until they overlap slightly, or more.
fn family(name: &str, a: &Soup, b: &Soup, seed: u64) -> f64 {
    let mut rng = Rng::new(seed);
    let (m, n) = (mesh(a), mesh(b));
    let mut ratios = Ratios::default();
    for k in 0..24 {
        let at = rng.unit();
        let mut pose = Pose::new(unit_quat(rng.quat()), scale(at, 3.0));
        for _ in 0..30 {
            let d = PairTracker::new().distance(&m, &n, &relative(&pose)).value;
            pose.t = add(pose.t, scale(at, -d));
        }
        pose.t = add(pose.t, scale(at, -[0.01, 0.05, 0.15][k % 3]));
        let found = of_meshes(&m, &n, &relative(&pose));
        if found.upper == 0.0 {
            continue;
        }
        ratios.push(&found);
        check(&found, &pose, &mut rng, |p| PairTracker::new().closest(&m, &n, p).state);
    }
    ratios.median(name)
}

#[test]
fn bodies_that_are_not_convex_have_lower_bounds() {
    let (l, gear) = (soups::bracket(), soups::gear(12));
    let medians = [
        family("L and L", &l, &l, 81),
        family("gear and gear", &gear, &gear, 82),
        family("L and gear", &l, &gear, 83),
        family("torus and L", &soups::torus(24, 12, 0.3), &l, 84),
        family("rock and rock", &soups::rock(3, 1), &soups::rock(3, 2), 85),
        family("screw and gear", &soups::screw(4, 24), &gear, 86),
        family(
            "torus and torus",
            &soups::torus(24, 12, 0.3),
            &soups::torus(24, 12, 0.3),
            87,
        ),
        family("ball and ball", &soups::sphere(3), &soups::sphere(3), 88),
    ];
    assert!(medians.iter().all(|m| *m > 0.9), "{medians:?}");
}
