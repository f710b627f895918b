//! A converted copy of a body is equal to the body, and cached state is recognised by everything that it
//! relies on.

use core::f64::consts::TAU;
use truth::support::Decide;
use truth::support::piece_at;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::BezierSurface;
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, MeshError, PairTracker, Piece, RelativePose, Shape};
use truth::driven::{copies, played};
use truth::rng::Rng;

fn cuboid(half: [f64; 3]) -> ConvexPolyhedron {
    solids::cuboid(Vector3::from(half)).unwrap()
}

/// Returns a position along x that avoids the edges of a box.
fn along_x(x: f64) -> RelativePose {
    RelativePose::from_isometry(&Isometry3::translation(x, 0.2, 0.1)).unwrap()
}

fn at(shape: impl Into<Shape>, pose: Isometry3<f64>) -> Piece {
    piece_at(pose, shape)
}

/// Returns bodies that lose all their triangles at their pose, or never had one: in x from 0 to
/// 3.5, or at 3.5.
fn thin() -> Vec<(&'static str, Piece)> {
    let far = Isometry3::translation(3.5, 0.3, 0.1);
    let segment = ConvexPolyhedron::segment(Point3::origin(), Point3::new(3.5, 0.0, 0.0)).unwrap();
    let point = ConvexPolyhedron::point(Point3::new(3.5, 0.0, 0.0)).unwrap();
    vec![
        ("segment", Piece::new(segment.clone())),
        ("placed segment", at(segment, Isometry3::translation(0.0, 0.3, 0.1))),
        ("point", Piece::new(point)),
        (
            "placed point",
            at(ConvexPolyhedron::point(Point3::origin()).unwrap(), far),
        ),
        ("speck", at(cuboid([2e-24; 3]), far)),
        ("needle", at(cuboid([1e-20, 1e-20, 0.25]), far)),
        ("plate", at(cuboid([1e-20, 0.25, 0.25]), far)),
        (
            "lost in the flush",
            Piece::new(ConvexPolyhedron::from_points(&flushed()).unwrap()),
        ),
    ]
}

/// Returns a plate up to x = 3.5 whose vertices on one side are as near to a coordinate plane as a
/// larger mesh can resolve.
fn flushed() -> Vec<Point3<f64>> {
    let corner = |k: usize| {
        let end = |i: usize, low: f64, high: f64| if k >> i & 1 == 0 { low } else { high };
        Point3::new(end(0, 3.25, 3.5), end(1, -0.25, 0.25), end(2, 0.0, 5e-61))
    };
    (0..8).map(corner).collect()
}

#[test]
fn pieces_without_triangles_stay_in_the_body() {
    let cube = cuboid([0.5; 3]);
    for (name, piece) in thin() {
        let far = at(cube.clone(), Isometry3::translation(-3.0, 0.0, 0.0));
        let body = Compound::new(vec![far, piece]).unwrap();
        // The box of side 2 at x = 5 is beyond x = 4.
        let die = cuboid([1.0; 3]);
        let mesh = Mesh::from_convex(&die).unwrap();
        let (mut warm, mut hull) = (PairTracker::new(), PairTracker::new());
        for x in [5.0, 4.75, 4.25, 5.0] {
            let found = warm.closest(&body, &mesh, &along_x(x));
            let other = hull.closest(&body, &die, &along_x(x));
            let truth = (x - 4.5).max(0.0);
            assert!((other.distance.max(0.0) - truth).abs() < 1e-12, "{name} {x}: {other:?}");
            assert!(found.lower <= truth + 1e-15, "{name} {x}: {found:?}");
            assert!(truth <= found.upper + 1e-15, "{name} {x}: {found:?}");
            assert_eq!(found.state, other.state, "{name} {x}");
            let back = PairTracker::new().closest(&mesh, &body, &along_x(x).swapped());
            assert_eq!(found.state, back.state, "{name} {x}");
            for tracker in [&mut warm, &mut PairTracker::new()] {
                assert!(
                    tracker.decide(&body, &mesh, &along_x(x), truth + 1e-9).is_yes(),
                    "{name} {x}"
                );
                assert!(
                    tracker.decide(&body, &mesh, &along_x(x), truth - 1e-9).is_no(),
                    "{name} {x}"
                );
                let answer = tracker.decide(&mesh, &body, &along_x(x).swapped(), 0.0).is_yes();
                assert_eq!(answer, truth == 0.0);
            }
        }
        let body_as_mesh = body.to_mesh();
        assert_eq!(body_as_mesh.unwrap_err(), MeshError::Thin { piece: 1 }, "{name}");
    }
}

/// Returns a strip of 80 by 20 squares of side 1 / 40 about the origin, rolled up by `turns` turns
/// beyond x = 0.
fn strip(turns: f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let rolled = |x: f64, y: f64| {
        if x <= 0.0 || turns == 0.0 {
            return Point3::new(x, y, 0.0);
        }
        let (angle, start) = (turns * TAU * x, 1.0 / (turns * TAU));
        let radius = (1.0 + 0.02 * angle) * start;
        Point3::new(radius * angle.sin(), y, start - radius * angle.cos())
    };
    let place = |i: u32, j: u32| rolled(f64::from(i) / 40.0 - 1.0, f64::from(j) / 40.0);
    let points = (0..=80).flat_map(|i| (0..=20).map(move |j| place(i, j))).collect();
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * 21 + j + l);
        [[a, b, c], [a, c, d]]
    };
    (
        points,
        (0..80).flat_map(|i| (0..20).flat_map(move |j| square(i, j))).collect(),
    )
}

/// Queries one mesh and then another with one tracker; new trackers judge the second.
fn ask_in_turn(first: &Mesh, second: &Mesh, calls: usize) {
    let probe = Mesh::from_convex(&cuboid([0.02; 3])).unwrap();
    let pose = |k: usize| {
        let t = 0.05 * k as f64;
        let place = Isometry3::translation(0.6 * t.sin(), 0.25 + 0.2 * (1.7 * t).cos(), 0.4 * (2.3 * t).sin());
        RelativePose::from_isometry(&place).unwrap()
    };
    let mut tracker = PairTracker::new();
    for k in 0..calls {
        // The last query is at the pose of the other mesh, where the cached state of the first one
        // holds.
        for j in (0..4).rev() {
            tracker.closest(first, &probe, &pose(k + j));
        }
        let found = tracker.closest(second, &probe, &pose(k));
        let fresh = PairTracker::new().closest(second, &probe, &pose(k));
        assert_eq!(found.state, fresh.state, "{k}");
        assert!(found.lower <= fresh.upper, "{k}: {found:?} {fresh:?}");
        assert!(fresh.lower <= found.upper, "{k}: {found:?} {fresh:?}");
    }
}

#[test]
fn two_ways_to_one_shape_make_two_trees() {
    let (flat, triangles) = strip(0.0);
    let mut m = Mesh::new(&flat, &triangles).unwrap();
    m.set_vertices(&strip(1.0).0).unwrap();
    m.set_vertices(&flat).unwrap();
    m.rebuild();
    let (mut a, mut b) = (m.clone(), m);
    for _ in 0..17 {
        a.set_vertices(&flat).unwrap();
    }
    let order = |m: &Mesh| m.triangles().map(|t| t.0).collect::<Vec<_>>();
    // Rolled up until the tree is rebuilt automatically.
    let before = order(&a);
    let rolled = |k: u32| strip(f64::from(k)).0;
    let mut turns = 1;
    while order(&a) == before {
        turns += 1;
        assert!(turns < 40);
        a.set_vertices(&rolled(turns)).unwrap();
        b.set_vertices(&rolled(turns)).unwrap();
    }
    // Calls that moved nothing do not count.
    assert_ne!(order(&b), before, "{turns} turns");
    b.rebuild();
    assert_ne!(order(&a), order(&b));
    ask_in_turn(&a, &b, 20);
    ask_in_turn(&b, &a, 20);
}

/// Returns one square of two triangles, with its vertices numbered in two ways.
fn squares() -> ([Point3<f64>; 4], [Mesh; 2]) {
    let p = [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)].map(|(x, y)| Point3::new(x, y, 0.0));
    let a = Mesh::new(&p, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let b = Mesh::new(&[p[1], p[0], p[2], p[3]], &[[1, 0, 2], [1, 2, 3]]).unwrap();
    (p, [a, b])
}

#[test]
fn one_list_bends_two_numberings_to_two_bodies() {
    let (p, [mut a, mut b]) = squares();
    let lifted: Vec<_> = p.iter().map(|p| Point3::new(p.x, p.y, 0.5)).collect();
    a.set_vertices(&lifted).unwrap();
    b.set_vertices(&lifted).unwrap();
    let probe = Mesh::from_convex(&cuboid([0.25; 3])).unwrap();
    let bodies: [&Mesh; 2] = [&a, &b];
    for (x, y) in [(5.0, 5.0), (-9.0, 0.0), (-6.0, 1.0), (0.5, -9.0)] {
        let pose = RelativePose::from_isometry(&Isometry3::translation(x, y, 1.75)).unwrap();
        let mut tracker = PairTracker::new();
        for k in 0..6 {
            let body = bodies[k % 2];
            let found = tracker.closest(body, &probe, &pose);
            let fresh = PairTracker::new().closest(body, &probe, &pose);
            assert!(found.lower <= fresh.upper, "{k}: {found:?} {fresh:?}");
            assert!(fresh.lower <= found.upper, "{k}: {found:?} {fresh:?}");
            let other = bodies[(k + 1) % 2];
            for d in [0.5, 0.99, 1.01, 2.0, 4.0] {
                let now = tracker.decide(other, &probe, &pose, d);
                assert_eq!(now, PairTracker::new().decide(other, &probe, &pose, d), "{k} {d}");
            }
            let now = tracker.lower_bound(other, &probe, &pose);
            let fresh = PairTracker::new().closest(other, &probe, &pose);
            assert!(now <= fresh.upper, "{k}: {now} {fresh:?}");
        }
    }
}

/// Returns convex bodies of all size classes about the origin.
fn measures() -> Vec<ConvexPolyhedron> {
    let p = |x, y, z| Point3::new(x, y, z);
    vec![
        ConvexPolyhedron::point(p(0.3, 0.1, -0.2)).unwrap(),
        ConvexPolyhedron::segment(p(-0.5, 0.1, 0.0), p(0.5, 0.2, 0.3)).unwrap(),
        ConvexPolyhedron::polygon(&[p(-0.5, -0.4, 0.0), p(0.5, -0.3, 0.0), p(0.1, 0.6, 0.0)]).unwrap(),
        cuboid([1e-24; 3]),
        cuboid([0.5, 1e-20, 1e-20]),
        cuboid([0.5, 1e-20, 0.4]),
        cuboid([0.5, 0.3, 0.2]),
    ]
}

#[test]
fn every_kind_that_a_body_is_turned_into_is_the_body() {
    let die = cuboid([0.3, 0.2, 0.25]);
    let partners: Vec<(Geometry, Shape)> = {
        let (sharp, round) = (Shape::from(die.clone()), Shape::from(die.clone()).rounded(0.1).unwrap());
        let ball = Shape::ball(0.3).unwrap();
        vec![
            (die.clone().into(), sharp.clone()),
            (round.clone().into(), round),
            (ball.clone().into(), ball.clone()),
            (Mesh::from_convex(&die).unwrap().into(), sharp.clone()),
            (Compound::from(sharp.clone()).into(), sharp),
            (Compound::from(ball.clone()).into(), ball),
        ]
    };
    let mut rng = Rng::new(5);
    for body in measures() {
        let placed = at(body.clone(), Isometry3::identity());
        let mut forms: Vec<Geometry> = vec![
            body.clone().into(),
            Shape::from(body.clone()).into(),
            Compound::from(Shape::from(body.clone())).into(),
            Compound::new(vec![placed]).unwrap().into(),
        ];
        assert_eq!(Mesh::from_convex(&body).is_ok(), body.face_count() > 0);
        assert_eq!(BezierSurface::from_convex(&body).is_ok(), body.face_count() > 0);
        forms.extend(Mesh::from_convex(&body).ok().map(Geometry::from));
        for _ in 0..12 {
            let pose = truth::Pose::new(rng.quat(), rng.in_ball().map(|x| 1.5 * x));
            let pose = super::relative(&pose);
            for (other, convex) in &partners {
                let truth = PairTracker::new().closest(&body, convex, &pose);
                let (lower, upper) = (truth.lower.max(0.0), truth.upper.max(0.0));
                for form in &forms {
                    for found in [
                        PairTracker::new().closest(form, other, &pose),
                        PairTracker::new().closest(other, form, &pose.swapped()),
                    ] {
                        let is_right = found.lower.max(0.0) <= upper + 1e-14 && lower <= found.upper.max(0.0) + 1e-14;
                        assert!(is_right, "{form:?} {other:?}: {found:?} {truth:?}");
                    }
                    if lower > 1e-12 || truth.upper < -1e-12 {
                        let meets = PairTracker::new().decide(form, other, &pose, 0.0);
                        assert_eq!(meets.is_yes(), lower == 0.0, "{form:?} {other:?}: {truth:?}");
                    }
                }
            }
        }
    }
}

/// Plays pairs and families, and asserts that every ingredient occurred at least a given number of
/// times per thousand seeds.
fn check(thousands: u64) {
    let mix = played(0..1000 * thousands, copies::play);
    let some = |x: u64, least: u64| x >= least * thousands;
    assert!(mix.pieces.iter().all(|n| some(*n, 100)), "{mix:?}");
    assert!(mix.beside.iter().all(|n| some(*n, 10)), "{mix:?}");
    assert!(some(mix.placed, 300) && some(mix.poses, 3000), "{mix:?}");
    assert!(some(mix.thin_is_closest, 500) && some(mix.close, 100), "{mix:?}");
    assert!(some(mix.overlapping, 100) && some(mix.exact, 50), "{mix:?}");
    assert!(some(mix.casts[1], 10), "{mix:?}");
    assert!(some(mix.steps, 100), "{mix:?}");
    assert!(some(mix.reused, 20), "{mix:?}");
    assert!(some(mix.families[1], 1000) && some(mix.numbered, 30), "{mix:?}");
    assert!(mix.trees.iter().all(|n| some(*n, 20)), "{mix:?}");
}

#[test]
fn pieces_of_every_measure_are_those_of_the_body() {
    check(1);
}

/// Needles at poses, one nearer than the rounding of the pose of its piece, which puts one into the
/// other.
#[test]
fn needles_nearer_than_the_rounding_of_their_poses_keep_their_distance() {
    copies::play(14_877).expect("bounds that hold the distance");
}

#[test]
#[ignore = "minutes: cargo test --release --all-features --test meshes copies -- --ignored"]
fn pieces_of_every_measure_are_those_of_the_body_in_many_pairs() {
    check(100);
}
