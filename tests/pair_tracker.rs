//! Promise: one tracker answers any two geometries, in either order, at one pose and over time.

#[path = "support/scene_forms.rs"]
#[allow(unreachable_pub, dead_code)]
mod forms;

use forms::{Form, TIE, forms};
use lab::Pose;
use lab::pose::scale;
use lab::rng::Rng;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::patch::{Decision, Surface};
use lin_canny::polyhedron::solids;
use lin_canny::separation::Separation;
use lin_canny::{Class, Distance, Geometry, Mesh, PairTracker, RelativePose, Velocity};

type Body = (Geometry, Form);

fn meet(x: &Distance, y: &Distance, slack: f64) -> bool {
    x.lower <= y.upper + slack && y.lower <= x.upper + slack
}

/// One pair at one pose: fresh and kept trackers, both orders, predicates, and the form over time.
fn judge((x, a): &Body, (y, b): &Body, pose: &RelativePose, kept: &mut [PairTracker; 2]) -> Class {
    let truth = forms::distance(a, b, pose);
    let found = PairTracker::new().closest(x, y, pose).unwrap();
    let distance = Distance::from(&found);
    let is_deep = found.class == Class::Overlapping && !(a.is_convex() && b.is_convex());
    assert!(is_deep || meet(&distance, &truth, 1e-8), "{found:?} {truth:?}");
    if found.class == Class::Separated {
        let (pose_a, pose_b) = pose.poses();
        let apart = (pose_b * found.point_on_b - pose_a * found.point_on_a).norm();
        assert!((apart - found.distance).abs() < 1e-8, "{found:?} {apart}");
    }
    let warm = kept[0].distance(x, y, pose).unwrap();
    let back = kept[1].closest(y, x, &pose.swapped()).unwrap();
    assert!(meet(&warm, &distance, 1e-12) && meet(&Distance::from(&back), &distance, 1e-8));
    let Distance { lower, upper, .. } = distance;
    assert_eq!(kept[0].within(x, y, pose, upper.max(0.0) + TIE), Ok(Decision::Yes));
    if lower > TIE {
        assert_eq!(kept[0].within(x, y, pose, lower - TIE), Ok(Decision::No));
        assert_eq!(kept[1].intersects(y, x, &pose.swapped()), Ok(Decision::No));
        let mut pair = kept[0].over(x, y).unwrap();
        let seen = pair.measure(pose);
        assert!(
            seen.lower <= upper + TIE && lower <= seen.upper + TIE,
            "{seen:?} {found:?}"
        );
    }
    found.class
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
                    let pose = RelativePose::from_isometry(&Pose { q, t }.isometry()).unwrap();
                    classes[judge(a, b, &pose, &mut kept) as usize] += 1;
                }
            }
        }
    }
    assert!(classes[0] > 400 && classes[2] > 100, "{classes:?}");
}

/// A tracker that goes from pair to pair answers each like a new one.
#[test]
fn a_tracker_of_other_geometries_begins_anew() {
    let mut rng = Rng::new(39);
    let mut wandering = PairTracker::new();
    for kind in 0..4 {
        for _ in 0..40 {
            // Geometries that live no longer than a query: an address may come again.
            let mut bodies = forms(kind);
            let (a, b) = (bodies.swap_remove(rng.below(bodies.len())), bodies.pop().unwrap());
            let pose = Pose {
                q: rng.quat(),
                t: scale(rng.in_ball(), 3.0),
            };
            let pose = RelativePose::from_isometry(&pose.isometry()).unwrap();
            let fresh = PairTracker::new().closest(&a.0, &b.0, &pose);
            assert_eq!(wandering.closest(&a.0, &b.0, &pose), fresh);
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
            let there = cast(&mut one.over(x, y).unwrap(), &still, &flight, (0.0, 1.0), tolerance).unwrap();
            let back = cast(&mut two.over(y, x).unwrap(), &flight, &still, (0.0, 1.0), tolerance).unwrap();
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

#[test]
fn a_mesh_and_a_surface_are_refused_by_name() {
    let mesh = Mesh::from_convex(&solids::octahedron(1.0).unwrap()).unwrap();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2]]).unwrap();
    let [mesh, surface] = [Geometry::from(mesh), Surface::from_mesh(&sheet).unwrap().into()];
    let pose = RelativePose::from_isometry(&Isometry3::translation(3.0, 0.0, 0.0)).unwrap();
    let mut tracker = PairTracker::new();
    let refused = tracker.closest(&mesh, &surface, &pose).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "no tracker follows a mesh and a surface of patches"
    );
    let refused = tracker.over(&surface, &mesh).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "no tracker follows a surface of patches and a mesh"
    );
    assert!(tracker.intersects(&mesh, &mesh, &pose) == Ok(Decision::No));
}
