//! Promise: each pair of feature kinds is answered correctly: results computed by hand, and all
//! kinds in random poses and motions.
//!
//! No outcome pairs an edge with a face, or a face with a face: one of their vertices or edges
//! represents them.

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, RelativePose, Tracker};
use truth::motion::{orbit_and_spin, random_poses};
use truth::pose::radius;
use truth::rng::Rng;
use truth::rows::{numbers, rows};
use truth::support;
use truth::support::kinds;

fn hull(points: &[[f64; 3]]) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(&points.iter().map(|&p| Point3::from(p)).collect::<Vec<_>>()).expect("a hull")
}

/// Returns the cube of half size 1.
fn cube() -> ConvexPolyhedron {
    solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).expect("a cube")
}

/// Returns the octahedron with vertices on the axes at distance 1.
fn octahedron() -> ConvexPolyhedron {
    solids::octahedron(1.0).expect("an octahedron")
}

/// Returns a prism over the square with vertices on the x and y axes, with edges along z from -1 to
/// 1.
fn diamond_along_z() -> ConvexPolyhedron {
    hull(&[
        [1.0, 0.0, -1.0],
        [1.0, 0.0, 1.0],
        [-1.0, 0.0, -1.0],
        [-1.0, 0.0, 1.0],
        [0.0, 1.0, -1.0],
        [0.0, 1.0, 1.0],
        [0.0, -1.0, -1.0],
        [0.0, -1.0, 1.0],
    ])
}

/// Returns the same along y.
fn diamond_along_y() -> ConvexPolyhedron {
    let turned: Vec<[f64; 3]> = diamond_along_z().vertex_points().map(|p| [p.x, p.z, p.y]).collect();
    hull(&turned)
}

/// B shifted by `shift`; the closest points in A's frame, and the kinds of the features.
struct Case {
    name: String,
    a: ConvexPolyhedron,
    b: ConvexPolyhedron,
    shift: [f64; 3],
    on_a: [f64; 3],
    on_b: [f64; 3],
    kinds: (usize, usize),
}

fn cases() -> Vec<Case> {
    let body = |name: &str| match name {
        "cube" => cube(),
        "octahedron" => octahedron(),
        "diamond along z" => diamond_along_z(),
        "diamond along y" => diamond_along_y(),
        _ => panic!("{name}"),
    };
    let case = |[name, a, b, shift, on_a, on_b, kinds]: [String; 7]| Case {
        name,
        a: body(&a),
        b: body(&b),
        shift: numbers(&shift),
        on_a: numbers(&on_a),
        on_b: numbers(&on_b),
        kinds: numbers::<2>(&kinds).map(|kind| kind as usize).into(),
    };
    let rows = rows(include_str!("features.txt"), "cases");
    rows.into_iter().map(case).collect()
}

/// Checks the case in a moved world, where nothing is aligned with an axis.
fn check(case: &Case, world: &Isometry3<f64>, swap: bool) {
    let pose_b = world * Translation3::from(case.shift);
    let (a, b) = if swap { (&case.b, &case.a) } else { (&case.a, &case.b) };
    let (pose_a, pose_b) = if swap { (pose_b, *world) } else { (*world, pose_b) };
    let (at_a, at_b) = if swap {
        (case.on_b, case.on_a)
    } else {
        (case.on_a, case.on_b)
    };
    let wanted = if swap { (case.kinds.1, case.kinds.0) } else { case.kinds };
    let o = Tracker::new().closest(a, b, &RelativePose::new(&pose_a, &pose_b).expect("a pose"));
    let distance = (Point3::from(at_a) - Point3::from(at_b)).norm();
    let name = &case.name;
    assert_eq!(o.state, ContactState::Separated, "{name}");
    assert_eq!(kinds(o.features), wanted, "{name}, swapped {swap}: {}", o.features);
    assert!((o.distance - distance).abs() < 1e-14, "{name}: {o:?}");
    assert!(o.lower <= distance, "{name}: {o:?}");
    assert!(distance <= o.upper, "{name}: {o:?}");
    let (on_a, on_b) = (pose_a * o.point_on_a, pose_b * o.point_on_b);
    assert!((on_a - world * Point3::from(at_a)).norm() < 1e-14, "{name}: {on_a}");
    assert!((on_b - world * Point3::from(at_b)).norm() < 1e-14, "{name}: {on_b}");
    let normal = world * (Point3::from(at_b) - Point3::from(at_a)) / distance;
    let off = (pose_a.rotation * o.normal.into_inner() - normal).norm();
    assert!(off < 1e-14, "{name}");
}

#[test]
fn hand_made_cases() {
    let mut rng = Rng::new(301);
    for case in cases() {
        for swap in [false, true] {
            check(&case, &Isometry3::identity(), swap);
            for _ in 0..20 {
                let rotation = truth::Pose::new(rng.quat(), [0.0; 3]).isometry().rotation;
                let place = Translation3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
                check(&case, &Isometry3::from_parts(place, rotation), swap);
            }
        }
    }
}

/// Every pair of features as a start leads to the same outcome.
#[test]
fn every_start_leads_to_the_answer() {
    for case in cases() {
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(case.shift.into(), UnitQuaternion::identity()));
        let pose = pose.expect("a pose");
        let wanted = Tracker::new().closest(&case.a, &case.b, &pose);
        let features = |body: &ConvexPolyhedron| {
            let v = body.vertices().map(lin_canny::Feature::Vertex);
            let e = body.edges().map(lin_canny::Feature::Edge);
            v.chain(e)
                .chain(body.faces().map(lin_canny::Feature::Face))
                .collect::<Vec<_>>()
        };
        for a in features(&case.a) {
            for b in features(&case.b) {
                let start = lin_canny::FeaturePair { a, b };
                let o = Tracker::with_features(start, &case.a, &case.b).closest(&case.a, &case.b, &pose);
                let close = (o.distance - wanted.distance).abs() <= 1e-14 && o.state == wanted.state;
                assert!(close, "{} from {start}: {o:?}", case.name);
            }
        }
    }
}

/// Counts `[kind of A][kind of B]` over poses and motions of all built-in solids.
#[test]
fn all_kinds_are_met() {
    let mut rng = Rng::new(302);
    let bodies = support::shipped();
    let (mut random, mut moving) = ([[0; 3]; 3], [[0; 3]; 3]);
    for _ in 0..60 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let radii = (radius(&support::plain(a).points), radius(&support::plain(b).points));
        let count = |mix: &mut [[usize; 3]; 3], frames: Vec<truth::motion::Frame>| {
            let mut tracker = Tracker::new();
            for f in frames {
                let o = tracker.closest(a, b, &support::relative(&f));
                if o.state == ContactState::Separated {
                    let (i, j) = kinds(o.features);
                    mix[i][j] += 1;
                }
            }
        };
        count(&mut random, random_poses(&mut rng, 200, radii, (0.6, 1.2), 1.0));
        count(&mut moving, orbit_and_spin(&mut rng, 400, 0.5, radii, (-0.2, 0.2), 200));
    }
    for mix in [random, moving] {
        for (i, j) in [(0, 0), (0, 1), (1, 0), (0, 2), (2, 0), (1, 1)] {
            assert!(mix[i][j] >= 200, "kinds ({i}, {j}) met {} times: {mix:?}", mix[i][j]);
        }
        assert_eq!(
            [mix[1][2], mix[2][1], mix[2][2]],
            [0; 3],
            "no state of the walk: {mix:?}"
        );
    }
}
