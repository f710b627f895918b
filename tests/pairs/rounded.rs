//! Promise: the distance of rounded polyhedra is that of their cores less both radii, on both sides
//! of contact; contact states and predicates are exact.
//!
//! The judge is `truth::exact` on the cores. The radii are subtracted in rational arithmetic.

use std::f64::consts::PI;

use lin_canny::nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, PairTracker, RelativePose, Shape};
use truth::errors::says;
use truth::exact;
use truth::rng::Rng;
use truth::shapes::Shape as Plain;
use truth::support;
use truth::{Body, Pose};

/// Returns a hull of four to eight random points, or a segment or a point.
fn core(rng: &mut Rng, least: usize) -> Plain {
    let n = least.max(*rng.pick(&[1, 2, 4, 6, 8]));
    let core = Plain::hull("core", (0..n).map(|_| rng.in_ball()).collect::<Vec<_>>());
    if n < 4 { core } else { core.solved() }
}

fn rounded(core: &Plain, r: f64) -> Shape {
    Shape::from(support::body(core)).rounded(r).expect("a radius")
}

/// Judges an outcome by itself.
fn judge(o: &Outcome, pose: &RelativePose, size: f64) {
    assert!(o.lower <= o.distance && o.distance <= o.upper, "{o:?}");
    assert!(o.upper - o.lower <= 1e-13 * size, "{o:?}");
    let (pose_a, pose_b) = pose.poses();
    let (p, q, n) = (pose_a * o.point_on_a, pose_b * o.point_on_b, pose_a * o.normal);
    assert!((p + o.distance * *n - q).norm() <= 1e-13 * size, "{o:?}");
}

#[test]
fn signed_distances_are_those_of_the_cores_less_the_radii() {
    let (mut rng, mut classes) = (Rng::new(1601), [0; 3]);
    for _ in 0..1500 {
        let cores = [core(&mut rng, 4), core(&mut rng, 1)];
        let radii = [
            rng.log_range(1e-3, 1.0),
            if rng.chance(0.2) { 0.0 } else { rng.log_range(1e-3, 1.0) },
        ];
        let pose_b = Pose::new(rng.quat(), truth::pose::scale(rng.unit(), rng.range(0.0, 4.0)));
        let pose = support::between(&Pose::IDENTITY, &pose_b);
        let [a, b] = [0, 1].map(|k| rounded(&cores[k], radii[k]));
        let truth = exact::solve(Body::from(&cores[0]), &Pose::IDENTITY, Body::from(&cores[1]), &pose_b);
        // The distance of the cores is rounded once, and the difference twice.
        let s = truth.distance - radii[0] - radii[1];
        let size = 2.0 + radii[0] + radii[1] + truth::pose::norm(pose_b.t);
        let mut pair = PairTracker::new();
        for _ in 0..2 {
            let o = pair.closest(&a, &b, &pose);
            judge(&o, &pose, size);
            let slack = 4.0 * f64::EPSILON * (truth.distance.abs() + radii[0] + radii[1]);
            assert!(o.lower <= s + slack && s - slack <= o.upper, "{s} {o:?}");
            let swapped = PairTracker::new().closest(&b, &a, &pose.swapped());
            assert_eq!(swapped.state, o.state);
            assert!(swapped.lower <= o.upper && o.lower <= swapped.upper);
            classes[o.state as usize] += 1;
            for d in [0.0, 0.5 * s.abs(), 2.0 * s.abs()] {
                assert_eq!(pair.within(&a, &b, &pose, d), s <= d, "{s} {d}");
            }
        }
    }
    assert!(classes[0] > 500 && classes[2] > 500, "{classes:?}");
}

/// Sums of radii that `f64` cannot represent, against distances that it can.
#[test]
fn classes_and_predicates_are_exact() {
    let tiny = f64::EPSILON / 4.0;
    let pose = RelativePose::from_isometry(&Isometry3::translation(3.0, 4.0, 0.0)).expect("a pose");
    let ball = |r: f64| Shape::ball(r).expect("a ball");
    let mut pair = PairTracker::new();
    for (a, b, state) in [
        (2.0, 3.0, ContactState::Touching),
        (2.0, 3.0f64.next_up(), ContactState::Overlapping),
        (2.0, 3.0f64.next_down(), ContactState::Separated),
        // 5 +- 2^-54, which f64 rounds to 5.
        (tiny, 5.0, ContactState::Overlapping),
        (tiny, 5.0f64.next_down(), ContactState::Separated),
    ] {
        let (x, y) = (ball(a), ball(b));
        for (x, y, pose) in [(&x, &y, pose), (&y, &x, pose.swapped())] {
            let o = pair.closest(x, y, &pose);
            assert_eq!(o.state, state, "{a} {b} {o:?}");
            let found = pair.intersects(x, y, &pose);
            assert_eq!(found, state != ContactState::Separated, "{a} {b}");
            judge(&o, &pose, 10.0);
        }
    }
    // Three numbers whose sum `f64` cannot represent: 1 + 2^-54 + 4 against 5, and 4 less one unit.
    let (x, y) = (ball(1.0), ball(tiny));
    assert!(pair.within(&x, &y, &pose, 4.0));
    assert!(!pair.within(&x, &y, &pose, 4.0f64.next_down()));
    assert!(!pair.within(&x, &y, &pose, -1.0) && !pair.within(&x, &y, &pose, f64::NAN));
    // A capsule next to a rounded box, touching along a segment.
    let pill = Shape::capsule(1.0, 0.25).expect("a capsule");
    let die = Shape::cuboid(Vector3::new(1.0, 1.0, 1.0))
        .and_then(|s| s.rounded(0.5))
        .expect("a box");
    let beside = |x: f64| RelativePose::from_isometry(&Isometry3::translation(x, 0.0, 0.0)).expect("a pose");
    assert_eq!(pair.closest(&die, &pill, &beside(1.75)).state, ContactState::Touching);
    let answer = pair.closest(&die, &pill, &beside(1.75f64.next_up())).state;
    assert_eq!(answer, ContactState::Separated);
    let found = pair.closest(&die, &pill, &beside(1.75f64.next_down())).state;
    assert_eq!(found, ContactState::Overlapping);
    assert_eq!(pair.closest(&die, &pill, &beside(0.0)).state, ContactState::Overlapping);
}

#[test]
fn bad_parameters_are_refused_by_name() {
    let refused = |s: Result<Shape, lin_canny::ShapeError>, what: &str| {
        says(s, what);
    };
    refused(Shape::ball(-1.0), "radius");
    refused(Shape::ball(f64::NAN), "radius");
    refused(
        Shape::ball(1.0).and_then(|s| s.rounded(f64::INFINITY)),
        "rounding radius",
    );
    refused(Shape::capsule(0.0, 1.0), "use a ball");
    refused(Shape::cuboid(Vector3::new(1.0, 0.0, 1.0)), "half extent");
    refused(Shape::cylinder(1.0, 0.0), "radius");
    refused(Shape::cone(1e200, 1.0), "half height");
    refused(Shape::ellipsoid(Vector3::new(1.0, -2.0, 1.0)), "semi-axis");
    refused(Shape::hull(&[Point3::origin(); 3]), "points");
}

/// Returns a tetrahedron without symmetry.
fn tent() -> ConvexPolyhedron {
    let corners = [[-0.5, -0.4, -0.3], [0.8, 0.0, -0.2], [0.1, 0.9, 0.1], [0.2, 0.1, 0.7]];
    ConvexPolyhedron::from_points(&corners.map(Point3::from)).expect("a solid")
}

fn triangle() -> ConvexPolyhedron {
    let corners = [[-0.9, -0.4, 0.1], [0.8, 0.0, -0.2], [0.1, 0.9, 0.1]];
    ConvexPolyhedron::polygon(&corners.map(Point3::from)).expect("a triangle")
}

/// The mass of rounded cores of almost no size is that of a ball, and of thin cores that of a
/// capsule.
#[test]
fn mass_of_rounded_cores_joins_balls_and_capsules() {
    let same = |a: Shape, b: Shape| {
        let (a, b) = (a.mass().expect("a mass"), b.mass().expect("a mass"));
        assert!((a.volume - b.volume).abs() < 1e-5 * b.volume, "{a:?} {b:?}");
        assert!((a.centroid - b.centroid).norm() < 1e-5, "{a:?} {b:?}");
        assert!((a.inertia - b.inertia).norm() < 1e-5 * b.inertia.norm(), "{a:?} {b:?}");
    };
    let ball = || Shape::ball(0.75).expect("a ball");
    for core in [tent(), triangle()] {
        let points: Vec<_> = core.vertex_points().map(|p| p * 1e-7).collect();
        let speck = match points.len() {
            3 => ConvexPolyhedron::polygon(&points),
            _ => ConvexPolyhedron::from_points(&points),
        };
        same(
            Shape::from(speck.expect("a body")).rounded(0.75).expect("a shape"),
            ball(),
        );
    }
    let rod = Shape::cuboid(Vector3::new(1e-7, 1e-7, 0.5)).and_then(|s| s.rounded(0.25));
    same(rod.expect("a rod"), Shape::capsule(0.5, 0.25).expect("a capsule"));
    // A square with a border: a slab, four half cylinders, and the quarters of a ball.
    let (a, r) = (0.5, 0.25);
    let plate = Shape::cuboid(Vector3::new(a, a, 1e-8)).and_then(|s| s.rounded(r));
    let mass = plate.expect("a plate").mass().expect("a mass");
    let volume = 8.0 * a * a * r + 4.0 * a * PI * r * r + 4.0 / 3.0 * PI * r * r * r;
    assert!((mass.volume - volume).abs() < 1e-6, "{mass:?} {volume}");
    // The mean square of z, by the areas of the cross-sections, which are squares with round
    // corners.
    let n = 100_000;
    let along = (0..n).map(|k| {
        let z = r * ((f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0);
        let s = (r * r - z * z).sqrt();
        z * z * (4.0 * a * a + 8.0 * a * s + PI * s * s) * 2.0 * r / f64::from(n)
    });
    let zz = along.sum::<f64>();
    let of_mass = mass.inertia.trace() / 2.0 - mass.inertia[(2, 2)];
    assert!((of_mass - zz).abs() < 1e-6 * zz, "{of_mass} {zz}");
}

fn kinds() -> Vec<Shape> {
    [
        Shape::ball(0.5),
        Shape::capsule(1.0, 0.25),
        Shape::cuboid(Vector3::new(1.0, 2.0, 0.5)),
        Shape::cylinder(0.5, 1.0),
        Shape::cone(1.0, 0.75),
        Shape::ellipsoid(Vector3::new(1.0, 2.0, 0.25)),
        Shape::cuboid(Vector3::new(1.0, 0.5, 0.5)).and_then(|s| s.rounded(0.25)),
        Shape::from(tent()).rounded(0.5),
        Shape::from(triangle()).rounded(0.25),
        Shape::cylinder(0.5, 1.0).and_then(|s| s.rounded(0.125)),
    ]
    .into_iter()
    .map(|s| s.expect("a shape"))
    .collect()
}

/// Mass, box and ball against random interior points, judged by `contains`.
#[test]
fn mass_box_and_ball_agree_with_containment() {
    let mut rng = Rng::new(1602);
    for shape in kinds() {
        let (_, radius) = shape.bounding_ball();
        let turned = Pose::new(rng.quat(), rng.in_ball()).isometry();
        let (low, high) = shape.aabb_at(&turned, &mut Default::default());
        let (n, mut inside, mut far) = (if shape.mass().is_some() { 200_000 } else { 20_000 }, 0, [f64::MAX; 6]);
        let (mut first, mut second) = (Vector3::zeros(), Matrix3::zeros());
        for _ in 0..n {
            let p = Vector3::from_fn(|_, _| rng.range(-radius, radius));
            if !shape.contains(&Point3::from(p)) {
                continue;
            }
            assert!(p.norm() <= radius, "{shape:?}");
            (inside, first, second) = (inside + 1, first + p, second + p * p.transpose());
            let w = turned * Point3::from(p);
            for k in 0..3 {
                assert!(low[k] <= w[k] && w[k] <= high[k], "{shape:?}");
                far[k] = far[k].min(w[k] - low[k]);
                far[3 + k] = far[3 + k].min(high[k] - w[k]);
            }
        }
        assert!(
            far.iter().all(|&d| d < 0.2 * radius),
            "a loose box: {far:?} of {shape:?}"
        );
        let Some(mass) = shape.mass() else { continue };
        let share = f64::from(inside) / f64::from(n);
        let cube = 8.0 * radius.powi(3);
        assert!(
            (mass.volume / cube - share).abs() < 0.006,
            "{} {} {shape:?}",
            mass.volume,
            share * cube
        );
        let mean = first / f64::from(inside);
        assert!((mass.centroid.coords - mean).norm() < 0.02, "{shape:?}");
        let spread = second / f64::from(inside) - mean * mean.transpose();
        let inertia = Matrix3::identity() * spread.trace() - spread;
        let off = (mass.inertia / mass.volume - inertia).norm();
        assert!(off < 0.05 * inertia.norm(), "{off} {inertia} {shape:?}");
    }
}

/// Support values are never below a point of the shape, and no looser than the box.
#[test]
fn heights_hold_the_shape() {
    let mut rng = Rng::new(1603);
    for shape in kinds() {
        let (_, radius) = shape.bounding_ball();
        for _ in 0..200 {
            let n = Vector3::from(rng.unit());
            let (up, down) = (shape.support_height(&n), shape.support_height(&(-3.0 * n)) / 3.0);
            let turn = UnitQuaternion::rotation_between(&n, &Vector3::x()).unwrap_or_default();
            let turned = Isometry3::from_parts(Default::default(), turn);
            let (low, high) = shape.aabb_at(&turned, &mut Default::default());
            assert!((high.x - up).abs() < 1e-6 * radius, "{shape:?}");
            assert!((low.x + down).abs() < 1e-6 * radius, "{shape:?}");
            let p = Point3::from(Vector3::from(rng.in_ball()) * radius);
            assert!(!shape.contains(&p) || n.dot(&p.coords) <= up, "{shape:?} {p}");
        }
    }
}
