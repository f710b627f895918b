//! Casts, rays, contacts, scenes and surfaces take a cloud like any other body.

use super::*;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::surface::BezierSurface;
use lin_canny::{ManifoldOptions, Ray, RayCast, RayCaster, Velocity};

/// A square floor of balls of radius 0.1 at z = 0, 0.1 apart.
fn floor() -> Cloud {
    let points: Vec<_> = (0..1681)
        .map(|k| Point3::new(f64::from(k / 41) * 0.1 - 2.0, f64::from(k % 41) * 0.1 - 2.0, 0.0))
        .collect();
    Cloud::new(&points, CloudElement::Ball(0.1)).unwrap()
}

#[test]
fn casts_bracket_the_first_contact() {
    let (floor, die) = (floor(), solids::cuboid(Vector3::repeat(0.5)).unwrap());
    let rest = Steady::new(&Isometry3::identity(), Velocity::default()).unwrap();
    let down = Velocity::new(Vector3::new(0.1, 0.0, -1.0), Vector3::zeros());
    let down = Steady::new(&Isometry3::translation(0.0, 0.0, 3.0), down).unwrap();
    let mut tracker = PairTracker::new();
    let mut pair = tracker.pair(&floor, &die);
    let found = cast(&mut pair, &rest, &down, 0.0..10.0, Tolerance::Distance(1e-9)).unwrap();
    let Impact::Hit { safe, hit, .. } = found.impact else {
        panic!("{:?}", found.impact)
    };
    assert!(safe <= 2.4 && hit >= 2.4 && hit - safe < 1e-8, "{safe} {hit}");
}

#[test]
fn rays_hit_the_elements() {
    let floor = floor();
    let ray = Ray::new(Point3::new(0.3, 0.5, 4.0), -Vector3::z()).unwrap();
    let found = RayCaster::new()
        .cast(&floor, &Isometry3::identity(), &ray, f64::INFINITY)
        .unwrap();
    let RayCast::Hit(hit) = found else { panic!("{found:?}") };
    assert!(hit.safe <= 3.9, "{hit:?}");
    assert!(hit.hit >= 3.9 - 1e-12, "{hit:?}");
    assert!(hit.hit - hit.safe < 1e-9, "{hit:?}");
    let at = floor.point(hit.subshape as usize).unwrap();
    assert!((at - Point3::new(0.3, 0.5, 0.0)).norm() < 1e-9);
    let aside = Ray::new(Point3::new(2.2, 0.0, 4.0), -Vector3::z()).unwrap();
    let found = RayCaster::new()
        .cast(&floor, &Isometry3::identity(), &aside, f64::INFINITY)
        .unwrap();
    assert!(matches!(found, RayCast::Miss), "{found:?}");
}

#[test]
fn contacts_are_on_the_elements() {
    let die = solids::cuboid(Vector3::repeat(0.25)).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.05, 0.05, 0.345)).unwrap();
    let mut tracker = PairTracker::new();
    let options = ManifoldOptions::default().prediction(0.01);
    let found = tracker.contacts(&floor(), &die, &pose, &options).unwrap();
    assert!(!found.is_empty());
    let lowest = found
        .iter()
        .flat_map(|group| &group.contacts)
        .map(|c| c.point.separation);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    assert!((lowest + 0.005).abs() < 1e-9, "{lowest}");
}

/// Contacts come from the elements near the other body alone, in every frame of a motion.
#[test]
fn contacts_are_those_of_all_elements() {
    let mut rng = Rng::new(17);
    let points: Vec<_> = (0..3000)
        .map(|_| Point3::from(vector(&mut rng, 2.0).component_mul(&Vector3::new(1.0, 1.0, 0.02))))
        .collect();
    let elements = [
        CloudElement::Ball(0.05),
        CloudElement::Box(Vector3::new(0.04, 0.05, 0.06)),
        CloudElement::Balls((0..3000).map(|k| 0.01 + 0.04 * f64::from(k % 7) / 7.0).collect()),
    ];
    let die = solids::cuboid(Vector3::repeat(0.3)).unwrap();
    let others = [
        Geometry::from(die.clone()),
        Geometry::from(Shape::ball(0.3).unwrap()),
        Geometry::from(Mesh::from_convex(&die).unwrap()),
        Geometry::from(Cloud::new(&points[..40], CloudElement::Ball(0.02)).unwrap()),
    ];
    let options = ManifoldOptions::default().prediction(0.02);
    let mut met = 0;
    for element in elements {
        let cloud = Cloud::new(&points, element).unwrap();
        let compound = cloud.to_compound().unwrap();
        for other in &others {
            let [mut ours, mut swapped, mut all] = [(); 3].map(|()| PairTracker::new());
            for frame in 0..12 {
                let t = f64::from(frame);
                let at = Isometry3::new(
                    Vector3::new(-1.0 + 0.15 * t, 0.3, 0.42 - 0.01 * t),
                    Vector3::new(0.02 * t, 0.01 * t, 0.1 * t),
                );
                let pose = RelativePose::from_isometry(&at).unwrap();
                let lowest = |groups: &[lin_canny::ContactGroup]| {
                    let contacts = groups.iter().flat_map(|group| &group.contacts);
                    contacts.map(|c| c.point.separation).fold(f64::INFINITY, f64::min)
                };
                let expected = lowest(all.contacts(&compound, other, &pose, &options).unwrap());
                let found = ours.contacts(&cloud, other, &pose, &options).unwrap();
                let what = format!("{other:?} frame {frame}: {} for {expected}", lowest(found));
                assert!(
                    lowest(found) == expected || (lowest(found) - expected).abs() < 1e-9,
                    "{what}"
                );
                for contact in found.iter().flat_map(|group| &group.contacts) {
                    met += 1;
                    let at = points[contact.patches[0] as usize];
                    assert!((at - contact.point.point_on_a).norm() < 0.12, "{what}: {contact:?}");
                }
                let back = swapped.contacts(other, &cloud, &pose.swapped(), &options).unwrap();
                assert!(
                    lowest(back) == expected || (lowest(back) - expected).abs() < 1e-9,
                    "{what}"
                );
            }
        }
    }
    assert!(met > 200, "{met}");
}

#[test]
fn scenes_measure_clouds() {
    let all = Group::default();
    let mut scene = Scene::new();
    scene.set_queries(all, all, PairQueries::none().distance(10.0)).unwrap();
    scene.insert(Body::moving(floor()), Isometry3::identity()).unwrap();
    let die = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let id = scene
        .insert(Body::moving(die), Isometry3::translation(0.0, 0.0, 1.6))
        .unwrap();
    for height in [1.6, 1.2, 0.9] {
        scene.set_pose(id, Isometry3::translation(0.0, 0.0, height)).unwrap();
        scene.step();
        let distances: Vec<f64> = scene.pairs().map(|pair| pair.distance.unwrap().value).collect();
        assert_eq!(distances.len(), 1);
        assert!((distances[0] - (height - 0.6)).abs() < 1e-12, "{distances:?}");
    }
}

#[test]
fn surfaces_measure_clouds() {
    let mesh = Mesh::from_convex(&solids::cuboid(Vector3::repeat(0.5)).unwrap()).unwrap();
    let surface = BezierSurface::from_mesh(&mesh).unwrap();
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, 1.6)).unwrap();
    let found = PairTracker::new().closest(&floor(), &surface, &pose);
    assert!(found.lower <= 1.0 + 1e-12, "{found:?}");
    assert!(found.upper >= 1.0 - 1e-12, "{found:?}");
    assert!(found.upper - found.lower < 1e-6, "{found:?}");
    let found = PairTracker::new().closest(&surface, &floor(), &pose.swapped());
    assert!(found.lower <= 1.0 + 1e-12, "{found:?}");
    assert!(found.upper >= 1.0 - 1e-12, "{found:?}");
    assert!(found.upper - found.lower < 1e-6, "{found:?}");
}
