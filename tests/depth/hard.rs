//! Bodies and positions at which rounding hides the depth or its witnesses.

use crate::{both, closest, judge, judge_both};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, Replay, Solver};
use truth::Pose;
use truth::pose::{scale, sub};
use truth::rng::Rng;
use truth::shapes;
use truth::support;

/// A plate, and at its corner a body a billionth as large and a million times thinner.
///
/// The volumes that prove the overlap are far below the rounding of the plate's volumes.
#[test]
fn a_speck_on_the_corner_of_a_plate() {
    let corners = [[-1.0, -1.0, 0.0], [-1.0, -0.5, 0.0], [0.5, -1.0, 0.0], [0.0; 3]].map(|p| p.into());
    let plate = ConvexPolyhedron::polygon(&corners).expect("a polygon");
    let speck = solids::cuboid(Vector3::new(3.5e-9, 2.2e-9, 1.4e-12)).expect("a box");
    let mut rng = Rng::new(17);
    for _ in 0..200 {
        let frame = both(Pose::IDENTITY, Pose::new(rng.quat(), [0.0; 3]));
        judge(&plate, &speck, &frame, "speck");
        judge(&speck, &plate, &frame.swapped(), "speck");
    }
}

/// All sides of a cone are equally near to the middle of its base.
///
/// The solver adds each of them before the depth is known, and each is reported by the apex, which
/// has as many edges.
#[test]
fn thousands_of_equal_depths_about_an_apex() {
    let corner = |p: [f64; 3]| lin_canny::nalgebra::Point3::from(p);
    let wedge = [[0.0; 3], [0.3, 0.0, 1.0], [0.0, 0.3, 1.0], [-0.2, -0.3, 1.0]].map(corner);
    let wedge = ConvexPolyhedron::from_points(&wedge).unwrap();
    let needle = ConvexPolyhedron::segment(corner([0.0; 3]), corner([0.5, 0.25, 1.0])).unwrap();
    let here = both(Pose::IDENTITY, Pose::IDENTITY);
    for (n, limit) in [(40, 2.0), (300, 2.0), (6000, 4.0)] {
        // Its base in the plane z = 0.
        let up = lin_canny::nalgebra::Isometry3::translation(0.0, 0.0, 0.5);
        let cone = solids::cone(n, 0.5, 1.0).unwrap().transformed(&up).unwrap();
        for body in [&wedge, &needle] {
            let began = std::time::Instant::now();
            let o = judge(&cone, body, &here, &format!("cone {n}"));
            let seconds = began.elapsed().as_secs_f64();
            assert!(seconds < limit, "cone {n}: {seconds} s");
            // The height of the origin below a side.
            let side = 1.0 / (1.0 + (std::f64::consts::PI / n as f64).cos().powi(-2)).sqrt();
            assert!(o.lower <= -side + 1e-13, "cone {n}: {o:?}, {side}");
            assert!(-side - 1e-13 <= o.upper, "cone {n}: {o:?}, {side}");
        }
    }
}

/// Bodies thinner than the rounding of their length, put into each other.
///
/// No polytope closes in floating-point arithmetic, so the solver tests every facet.
#[test]
fn bodies_thinner_than_rounding_have_a_depth() {
    let mut rng = Rng::new(29);
    let needle = |rng: &mut Rng| {
        let thin: [f64; 2] = [rng.log_range(1e-14, 1e-8), rng.log_range(1e-14, 1e-8)];
        if rng.chance(0.5) {
            return solids::cuboid(Vector3::new(1.0, thin[0], thin[1])).expect("a box");
        }
        let tips = [[1.0, 0.0, 0.0], [0.0, thin[0], 0.0], [0.0, 0.0, thin[1]]];
        let all: Vec<_> = tips.iter().flat_map(|&p| [p.into(), scale(p, -1.0).into()]).collect();
        ConvexPolyhedron::from_points(&all).expect("an octahedron")
    };
    let mut exact = 0;
    for _ in 0..3000 {
        let a = needle(&mut rng);
        let b = if rng.chance(0.7) { a.clone() } else { needle(&mut rng) };
        let q = rng.quat();
        let t = Pose::new(q, [0.0; 3]).rotate([rng.range(-0.9, 0.9), 0.0, 0.0]);
        let frame = both(Pose::new(q, [0.0; 3]), Pose::new(q, t));
        let o = closest(&a, &b, &frame);
        if o.state == ContactState::Overlapping {
            judge_both(&a, &b, &frame, "needles");
            exact += usize::from(o.solver == Solver::Exact);
        }
    }
    assert!(exact > 50, "{exact}");
}

/// The depth is below the least number: the bounds are near zero, on the side of an overlap.
#[test]
fn an_overlap_below_the_least_number() {
    let root = 1.414_213_562_373_095_4;
    let (start, end) = ([-0.8; 3].into(), [0.0, 0.0, -root].into());
    let segment = ConvexPolyhedron::segment(start, end).unwrap();
    let side = [
        0.803_804_099_559_783_9,
        -0.317_358_702_421_188_35,
        0.000_914_436_706_807_464_4,
    ];
    let triangle = ConvexPolyhedron::polygon(&[[0.0; 3], side, [0.0, 1.0, 0.0]].map(|p| p.into())).unwrap();
    let frame = both(Pose::IDENTITY, Pose::shift([-1e-323, 0.0, -root]));
    for o in [
        closest(&segment, &triangle, &frame),
        closest(&triangle, &segment, &frame.swapped()),
    ] {
        assert_eq!(o.state, ContactState::Overlapping, "{o:?}");
        assert!(
            o.lower < 0.0 && o.lower <= o.distance && o.distance <= o.upper && o.upper <= 0.0,
            "{o:?}"
        );
    }
}

/// A point just inside a needle with thousands of faces: if the polytope does not close, the list
/// of all facets gives the witnesses.
#[test]
fn a_point_in_the_skin_of_a_needle_has_its_witnesses() {
    let mut rng = Rng::new(415);
    let speck = ConvexPolyhedron::point([0.0; 3].into()).unwrap();
    let mut inside = 0;
    for n in [200, 1000, 5000] {
        let rim = (0..n).map(|k| std::f64::consts::TAU * (k as f64 / n as f64).powi(3));
        let tip = [[0.0, 0.0, 1e6].into()];
        let points: Vec<_> = rim.map(|t| [t.cos(), t.sin(), 0.0].into()).chain(tip).collect();
        let needle = ConvexPolyhedron::from_points(&points).unwrap();
        let corners: Vec<Vector3<f64>> = needle.vertex_points().map(|p| p.coords).collect();
        for _ in 0..1000 {
            let t = rng.uniform();
            let at = *rng.pick(&corners) * t + Vector3::new(0.0, 0.0, 1e6) * (1.0 - t);
            let frame = both(Pose::IDENTITY, Pose::shift(at.into()));
            let o = closest(&needle, &speck, &frame);
            if o.state != ContactState::Overlapping {
                continue;
            }
            inside += 1;
            let between = at + o.point_on_b.coords - o.point_on_a.coords;
            let off = (between - o.normal.into_inner() * o.distance).norm();
            assert!(off <= 1e-13 * 1e6, "{n}: {off:e} {o:?}");
        }
    }
    assert!(inside > 20, "{inside}");
}

/// The error of a witness is independent of the distance of the bodies from their origins, except
/// for the digits of its coordinates.
#[test]
fn witnesses_of_far_bodies_are_as_good_as_their_coordinates() {
    let mut rng = Rng::new(416);
    let away = 1e8;
    let (mut deep, mut doubled) = (0, 0);
    for k in 0..1500 {
        let small = shapes::cone(200, 1.0, 0.4).stretched([1e-5; 3]);
        let large = shapes::cone(128, 1.0, 1.0).moved(&Pose::shift(rng.unit().map(|x| x * away)));
        let (a, b) = (support::body(&small), support::body(&large));
        let mut frame = both(Pose::IDENTITY, Pose::new(rng.quat(), [0.0; 3]));
        let middle = frame.b.apply(b.bounding_ball().0.into());
        frame.b.t = sub(rng.unit(), middle);
        for _ in 0..4 {
            let o = closest(&a, &b, &frame);
            let by = [-1e-15, -1e-9, -1e-12, 0.0][k % 4] - o.distance;
            frame.b.t = truth::pose::add(frame.b.t, scale(o.normal.into_inner().into(), by));
        }
        let o = closest(&a, &b, &frame);
        if o.state != ContactState::Overlapping {
            continue;
        }
        deep += 1;
        doubled += usize::from(o.solver == Solver::DoubleDouble);
        let between = truth::bound::witness_distance(o.point_on_a.into(), &frame.a, o.point_on_b.into(), &frame.b);
        // The coordinates of the witness on B end with 2^-27.
        let off = (between + o.distance).abs();
        assert!(off <= 3e-8, "{k}: {off:e} {o:?}");
    }
    assert!(deep > 300 && doubled > 15, "{deep} {doubled}");
}

/// A small body in a cube, found by a soak: the triangles of the cached polytope are needles, and
/// `f64` chose a wrong one for the normal.
#[test]
fn witnesses_among_needles_are_behind_each_other() {
    let replay: Replay = include_str!("../replays/needles.txt").parse().expect("a replay");
    let o = replay.tracker().closest(&replay.a, &replay.b, &replay.pose);
    assert_eq!((o.state, o.solver), (ContactState::Overlapping, Solver::Polytope));
    let (pa, pb) = replay.pose.poses();
    let (n, between) = (pa * o.normal.into_inner(), pb * o.point_on_b - pa * o.point_on_a);
    let aside = (between - n * n.dot(&between)).norm();
    assert!(aside <= 1e-14, "{aside:e} {o:?}");
}
