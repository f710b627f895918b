//! Promise: one tracker answers any two geometries, in either order, at one pose and over time.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::separation::Separation;
use lin_canny::surface::BezierSurface;
use lin_canny::{
    Compound, ContactState, Decision, Distance, Geometry, GeometryRef, Manifold, ManifoldOptions, Mesh, PairOutcome,
    PairTracker, PairWork, PatchContact, QueryOptions, RelativePose, Shape, Velocity,
};
use truth::Pose;
use truth::forms;
use truth::forms::{Form, TIE, forms, sphere};
use truth::pose::scale;
use truth::rng::Rng;
use truth::support::Decide;

type Body = (Geometry, Form);

fn meet(x: &Distance, y: &Distance, slack: f64) -> bool {
    x.lower <= y.upper + slack && y.lower <= x.upper + slack
}

/// Judges one pair at one pose: new and used trackers, both orders, predicates, and casts.
fn judge((x, a): &Body, (y, b): &Body, pose: &RelativePose, kept: &mut [PairTracker; 2]) -> ContactState {
    let truth = forms::distance(a, b, pose);
    let found = PairTracker::new().closest(x, y, pose);
    let distance = Distance::from(&found);
    let is_deep = found.state == ContactState::Overlapping && !(a.is_convex() && b.is_convex());
    assert!(is_deep || meet(&distance, &truth, 1e-8), "{found:?} {truth:?}");
    if found.state == ContactState::Separated {
        let (pose_a, pose_b) = pose.poses();
        let apart = (pose_b * found.point_on_b - pose_a * found.point_on_a).norm();
        assert!((apart - found.distance).abs() < 1e-8, "{found:?} {apart}");
    }
    let warm = kept[0].distance(x, y, pose);
    let back = kept[1].closest(y, x, &pose.swapped());
    assert!(meet(&warm, &distance, 1e-12) && meet(&Distance::from(&back), &distance, 1e-8));
    let Distance { lower, upper, .. } = distance;
    assert_eq!(kept[0].decide(x, y, pose, upper.max(0.0) + TIE), Decision::Yes);
    if lower > TIE {
        assert_eq!(kept[0].decide(x, y, pose, lower - TIE), Decision::No);
        assert_eq!(kept[1].decide(y, x, &pose.swapped(), 0.0), Decision::No);
        let mut pair = kept[0].pair(x, y);
        let seen = pair.measure(pose);
        assert!(seen.lower <= upper + TIE, "{seen:?} {found:?}");
        assert!(lower <= seen.upper + TIE, "{seen:?} {found:?}");
    }
    found.state
}

#[test]
fn any_two_geometries_are_measured_in_either_order() {
    let mut rng = Rng::new(38);
    let mut classes = [0; 4];
    for kind in 0..4 {
        let bodies = forms(kind);
        for a in &bodies {
            for b in &bodies {
                let mut kept = [PairTracker::new(), PairTracker::new()];
                for reach in [0.4, 1.0, 3.0] {
                    let (q, t) = (rng.quat(), scale(rng.in_ball(), reach));
                    let pose = RelativePose::from_isometry(&Pose::new(q, t).isometry()).unwrap();
                    classes[judge(a, b, &pose, &mut kept) as usize] += 1;
                }
            }
        }
    }
    assert!(classes[0] > 400 && classes[2] > 100, "{classes:?}");
}

/// A tracker that changes from pair to pair answers each like a new one.
#[test]
fn a_tracker_of_other_geometries_begins_anew() {
    let mut rng = Rng::new(39);
    let mut wandering = PairTracker::new();
    for kind in 0..4 {
        for _ in 0..40 {
            // Geometries that live no longer than a query: an address may be reused.
            let mut bodies = forms(kind);
            let (a, b) = (bodies.swap_remove(rng.below(bodies.len())), bodies.pop().unwrap());
            let pose = Pose::new(rng.quat(), scale(rng.in_ball(), 3.0));
            let pose = RelativePose::from_isometry(&pose.isometry()).unwrap();
            let fresh = PairTracker::new().closest(&a.0, &b.0, &pose);
            let other = wandering.closest(&a.0, &b.0, &pose);
            assert_eq!(other.state, fresh.state);
            assert!(other.lower <= fresh.upper, "{other:?} {fresh:?}");
            assert!(fresh.lower <= other.upper, "{other:?} {fresh:?}");
        }
    }
}

fn moving(from: Vector3<f64>, linear: Vector3<f64>, angular: Vector3<f64>) -> Steady {
    Steady::new(&Isometry3::from(from), Velocity::new(linear, angular)).unwrap()
}

#[test]
fn any_two_geometries_meet_at_one_time_in_either_order() {
    let mut rng = Rng::new(40);
    let mut hits = 0;
    for kind in 0..4 {
        let bodies = forms(kind);
        for ((x, _), (y, _)) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
            let way = Vector3::from(rng.unit());
            let still = moving(Vector3::zeros(), Vector3::zeros(), Vector3::from(rng.unit()));
            let flight = moving(way * 9.0, way * -9.0, Vector3::from(rng.unit()));
            let tolerance = Tolerance::Distance(1e-5);
            let mut trackers = [PairTracker::new(), PairTracker::new()];
            let [one, two] = &mut trackers;
            let there = cast(&mut one.pair(x, y), &still, &flight, 0.0..1.0, tolerance).unwrap();
            let back = cast(&mut two.pair(y, x), &flight, &still, 0.0..1.0, tolerance).unwrap();
            if let (Impact::Hit { safe, hit, .. }, Impact::Hit { safe: s, hit: h, .. }) = (there.impact, back.impact) {
                assert!(safe <= h && s <= hit, "{:?} {:?}", there.impact, back.impact);
                hits += 1;
            } else {
                let is_miss = |impact: &Impact| matches!(impact, Impact::Miss);
                let is_hit = |impact: &Impact| matches!(impact, Impact::Hit { .. });
                let (i, k) = (there.impact, back.impact);
                assert!(!(is_miss(&i) && is_hit(&k) || is_hit(&i) && is_miss(&k)), "{i:?} {k:?}");
            }
        }
    }
    assert!(hits > 60, "{hits}");
}

/// A solid mesh next to a surface is answered like the hull that it covers, which uses a separate
/// path.
#[test]
fn a_mesh_beside_a_surface_is_a_solid() {
    let mut rng = Rng::new(41);
    let (hull, shell) = (solids::icosahedron(0.6).unwrap(), sphere(0.45));
    let sheet = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.2], [1.0, 1.0, 0.5]].map(Point3::from);
    let sheet = Mesh::new(&sheet, &[[0, 1, 2], [2, 1, 3]]).unwrap();
    let mesh = Mesh::from_convex(&hull).unwrap();
    let [small, open] = [sphere(0.05), BezierSurface::from_mesh(&sheet).unwrap()];
    let narrow = QueryOptions::default().width(1e-9);
    let (mut kept, mut classes, mut inside) = (PairTracker::new(), [0; 4], 0);
    for k in 0..600 {
        let surface = [&shell, &small, &open][k % 3];
        let reach = [0.5, 1.2, 3.0][k / 3 % 3];
        let (q, t) = (rng.quat(), scale(rng.in_ball(), reach));
        let pose = RelativePose::from_isometry(&Pose::new(q, t).isometry()).unwrap();
        let truth = PairTracker::new().closest_with(&hull, surface, &pose, &narrow);
        let found = PairTracker::new().closest_with(&mesh, surface, &pose, &narrow);
        let back = kept.closest_with(surface, &mesh, &pose.swapped(), &narrow);
        for o in [&found, &back] {
            let is_close = truth.upper < 1e-6 && truth.state != ContactState::Overlapping;
            let shares = |o: &PairOutcome| matches!(o.state, ContactState::Overlapping | ContactState::Touching);
            assert!(is_close || shares(o) == shares(&truth), "{o:?} {truth:?}");
            let (lower, upper) = (truth.lower.max(0.0), truth.upper);
            assert!(o.lower <= upper + 1e-12 && lower <= o.upper + 1e-12, "{o:?} {truth:?}");
        }
        let meets = PairTracker::new().decide(&mesh, surface, &pose, 0.0);
        assert!(
            meets.as_bool().is_none_or(|meets| meets == (truth.lower <= 0.0)),
            "{meets:?} {truth:?}"
        );
        assert!(
            kept.decide(surface, &mesh, &pose.swapped(), truth.upper.max(0.0) + 1e-9)
                .is_yes()
        );
        if truth.lower > 1e-6 {
            assert!(kept.decide(surface, &mesh, &pose.swapped(), truth.lower - 1e-9).is_no());
        }
        classes[found.state as usize] += 1;
        inside += u32::from(found.state == ContactState::Overlapping && k % 3 == 1);
    }
    assert!(classes[0] > 150, "{classes:?} {inside}");
    assert!(classes[1] > 30, "{classes:?} {inside}");
    assert!(inside > 30, "{classes:?} {inside}");
}

/// An open mesh has no inside, and a mesh beyond the coordinates of surfaces only has a bounding
/// ball.
#[test]
fn meshes_that_no_surface_stands_for_have_bounds() {
    let corners = [[-9.0, -9.0, -1.0], [9.0, -9.0, -1.0], [0.0, 9.0, -1.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2]]).unwrap();
    let at = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, 1.0)).unwrap();
    let d = PairTracker::new().distance(&sheet, &sphere(0.5), &at);
    assert!(d.state == ContactState::Separated, "{d:?}");
    assert!((d.value - 1.5).abs() < 1e-8, "{d:?}");
    let far = corners.map(|p| p * 1e70);
    let huge = Mesh::new(&far, &[[0, 1, 2]]).unwrap();
    let mut tracker = PairTracker::new();
    let answer = tracker.closest(&huge, &sphere(0.5), &at);
    assert!(!answer.is_converged, "{answer:?}");
    assert!(answer.lower <= 1e70, "{answer:?}");
    assert!(answer.upper >= 1e70, "{answer:?}");
    assert_eq!(tracker.decide(&huge, &sphere(0.5), &at, 1e80), Decision::Yes);
    assert_eq!(tracker.decide(&huge, &sphere(0.5), &at, f64::NAN), Decision::No);
    assert!(tracker.pair(&huge, &sphere(0.5)).measure(&at).lower <= 1e70);
}

/// Two convex geometries have the points of their manifold, other solids those of convex patches, a
/// surface none.
#[test]
fn contacts_of_any_two_geometries() {
    let die = solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).unwrap();
    let floor = solids::cuboid(Vector3::new(5.0, 5.0, 1.0)).unwrap();
    let ground = Mesh::from_convex(&floor).unwrap();
    let blocks = Compound::from(Shape::from(floor.clone()));
    let at = RelativePose::from_isometry(&Isometry3::translation(0.1, 0.0, 1.49)).unwrap();
    let options = ManifoldOptions::default().prediction(0.02);
    let round = Shape::from(die.clone()).rounded(0.01).unwrap();
    let floors = [GeometryRef::from(&floor), (&ground).into(), (&blocks).into()];
    let mut tracker = PairTracker::new();
    for floor in floors {
        for die in [GeometryRef::from(&die), (&round).into()] {
            for frame in 0..3 {
                let found = tracker.contacts(floor, die, &at, &options).unwrap();
                assert_eq!((found.len(), found[0].contacts.len()), (1, 4), "{frame}");
                let depth = |c: &PatchContact| c.point.separation;
                assert!(found[0].contacts.iter().all(|c| (depth(c) + 0.01).abs() < 0.0101));
            }
            let depth = tracker.penetration(floor, die, &at).unwrap();
            assert!(depth.lower <= 0.0201, "{depth:?}");
            assert!(depth.upper >= 0.0099, "{depth:?}");
            assert!(depth.upper < 0.022, "{depth:?}");
        }
    }
    let shell = sphere(1.0);
    let refused = tracker.contacts(&floor, &shell, &at, &options).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "contacts cannot be computed for a polyhedron and a Bézier surface"
    );
    let refused = tracker.manifold(&ground, &die, &at, &options, &mut Manifold::new());
    let answer = refused.unwrap_err().to_string();
    assert_eq!(answer, "manifold cannot be computed for a mesh and a polyhedron");
    assert_eq!(tracker.penetration(&floor, &shell, &at), None);
    assert!(tracker.check(&floor, &die, &at).is_ok() && tracker.work().trees.queries > 0);
    tracker.reset();
    assert_eq!(tracker.work(), PairWork::default());
}
