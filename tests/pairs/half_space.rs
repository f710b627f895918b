//! Promise: a polyhedron on a half-space has its exact height, and contacts that support it.

use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, HalfSpace, HalfSpaceError, ManifoldOptions, RelativePose};
use truth::pose::{dot, norm, scale, sub};
use truth::rng::Rng;
use truth::shapes;
use truth::support;
use truth::{Point, Pose};

/// Returns the heights of all vertices above a plane, by a scan.
fn heights(body: &ConvexPolyhedron, pose: &Pose, normal: Point, offset: f64) -> Vec<f64> {
    let height = |p: Point| dot(normal, pose.apply(p)) - offset;
    body.vertex_points().map(|p| height(p.into())).collect()
}

fn relative(pose: &Pose) -> RelativePose {
    support::between(&Pose::IDENTITY, pose)
}

#[test]
fn heights_and_contacts_are_those_of_a_scan() {
    let mut rng = Rng::new(601);
    let (mut classes, mut counts) = ([0; 3], [0; 9]);
    for k in 0..3000 {
        let by = [1.0, 1e-3, 1e3][k % 3];
        let shape = match rng.below(5) {
            0 => shapes::cuboid([1.0, 0.7, 0.02]),
            1 => shapes::prism(3 + rng.below(60), 1.0, 0.1),
            2 => shapes::cone(40, 1.0, 0.5),
            3 => shapes::sphere(&mut rng, 80),
            _ => shapes::small(&mut rng),
        };
        let body = support::body(&shape.stretched([by; 3]));
        let normal = rng.unit();
        let offset = by * rng.range(-2.0, 2.0);
        let q = if rng.chance(0.5) {
            [0.0, 0.0, 0.0, 1.0]
        } else {
            rng.quat()
        };
        let aside = scale(rng.unit(), by * rng.range(0.0, 3.0));
        let mut pose = Pose::new(q, aside);
        let all = heights(&body, &pose, normal, offset);
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        let goal = by * [-0.1, -1e-4, 0.0, 1e-4, 0.3][rng.below(5)];
        pose.t = sub(pose.t, scale(normal, least - goal));
        let all = heights(&body, &pose, normal, offset);
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);

        let floor = HalfSpace::new(Vector3::from(normal) * 7.0, offset * 7.0).expect("a half-space");
        let mut options = ManifoldOptions::default().prediction(0.01 * by);
        options.max_points = 1 + rng.below(8);
        let contacts = floor.contacts(&body, &relative(&pose), &options);
        let d = contacts.distance();
        assert_eq!(d, floor.distance(&body, &relative(&pose)));
        let size = by * 4.0 + norm(pose.t) + offset.abs();
        let told = format!("{d:?} {least:e} {body:?} {pose:?}");
        assert!((d.value - least).abs() <= 1e-14 * size, "{told}");
        assert!(d.lower <= d.value, "{told}");
        assert!(d.value <= d.upper, "{told}");
        assert!(d.upper - d.lower <= 1e-13 * size, "{told}");
        let expected = match d {
            d if d.lower > 0.0 => ContactState::Separated,
            d if d.upper < 0.0 => ContactState::Overlapping,
            _ => ContactState::Touching,
        };
        assert_eq!(d.state, expected, "{told}");
        classes[d.state as usize] += 1;
        counts[contacts.points().len()] += 1;
        assert_eq!(contacts.points().is_empty(), d.value > options.prediction, "{told}");
        assert!(contacts.points().len() <= options.max_points);
        if let Some(first) = contacts.points().first() {
            assert!(first.separation - least <= 1e-13 * size, "{told}");
        }
        for p in contacts.points().iter().chain([contacts.lowest()]) {
            let at = pose.apply(p.point_on_body.into());
            assert_eq!(body.vertex(p.vertex), Some(p.point_on_body));
            assert!((dot(normal, at) - offset - p.separation).abs() <= 1e-13 * size);
            assert!(norm(sub(sub(at, scale(normal, p.separation)), p.point_on_plane.into())) <= 1e-13 * size);
            assert!(p.separation <= options.prediction || std::ptr::eq(p, contacts.lowest()));
        }
    }
    assert!(classes.iter().all(|&n| n > 300), "{classes:?}");
    assert!(counts[1] > 300 && counts[3] > 50 && counts[4] > 50, "{counts:?}");
}

/// A flat coin has contacts all around: its centre is over their span, so it does not tip.
#[test]
fn coins_stand_on_points_all_round() {
    for sides in [3, 4, 5, 6, 8, 12, 32, 48, 128] {
        let coin = solids::prism(sides, 0.06, 1.0).expect("a coin");
        for turned in [0.0, 0.4] {
            let floor = HalfSpace::new(Vector3::z(), 0.25).expect("a half-space");
            let pose = Pose::turn([0.0, 0.0, 1.0], turned, [3.0, -2.0, 0.25 + 0.06 - 1e-4]);
            let lowest = heights(&coin, &pose, [0.0, 0.0, 1.0], 0.25)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let pose = pose.moved_to(sub(pose.t, [0.0, 0.0, lowest + 1e-4]));
            let contacts = floor.contacts(&coin, &relative(&pose), &ManifoldOptions::default().prediction(0.01));
            let points = contacts.points();
            assert_eq!(points.len(), sides.min(4), "{sides}");
            // Angles about the centre of the coin, in order: no gap of half a turn.
            let mut angles: Vec<f64> = points
                .iter()
                .map(|p| p.point_on_body.y.atan2(p.point_on_body.x))
                .collect();
            angles.sort_by(f64::total_cmp);
            angles.push(angles[0] + std::f64::consts::TAU);
            assert!(angles.windows(2).all(|w| w[1] - w[0] < 3.0), "{sides} {angles:?}");
        }
    }
}

#[test]
fn bodies_without_faces_and_far_bodies_have_contacts() {
    let floor = HalfSpace::new(Vector3::y(), -1.0).expect("a half-space");
    let options = ManifoldOptions::default().prediction(0.1);
    let point = ConvexPolyhedron::point([0.0, -1.05, 0.0].into()).expect("a point");
    let segment = ConvexPolyhedron::segment([0.0, -0.95, 0.0].into(), [1.0, -1.0, 0.0].into()).expect("a segment");
    let sheet = [[0.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, -1.0, 1.0]].map(|p| p.into());
    let sheet = ConvexPolyhedron::polygon(&sheet).expect("a polygon");
    for (body, count) in [(&point, 1), (&segment, 2), (&sheet, 3)] {
        let contacts = floor.contacts(body, &relative(&Pose::IDENTITY), &options);
        assert_eq!(contacts.points().len(), count, "{contacts:?}");
    }
    // A small body far from its origin, and a pose that brings it back.
    let away = 1e9;
    let speck =
        [[0.0; 3], [1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-3]].map(|p| [p[0] + away, p[1], p[2]].into());
    let speck = ConvexPolyhedron::from_points(&speck).expect("a solid");
    let contacts = floor.contacts(&speck, &relative(&Pose::shift([-away, -1.0, 0.0])), &options);
    assert_eq!(contacts.points().len(), 3);
    assert!(contacts.distance().lower <= 0.0 && 0.0 <= contacts.distance().upper);
}

#[test]
fn half_spaces_that_are_none_are_refused() {
    for normal in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        let refused = HalfSpace::new(normal.into(), 0.0);
        assert!(matches!(refused, Err(HalfSpaceError::Normal(_))), "{refused:?}");
    }
    for offset in [f64::NAN, f64::INFINITY, 1e120] {
        let refused = HalfSpace::new(Vector3::x(), offset);
        assert!(matches!(refused, Err(HalfSpaceError::Offset(_))), "{refused:?}");
    }
    for scale in [1e-300, 1e300] {
        let space = HalfSpace::new(Vector3::new(0.0, scale, 0.0), 2.0 * scale).expect("a half-space");
        assert_eq!((space.normal().y, space.offset()), (1.0, 2.0));
    }
    // Options that are NaN request nothing.
    let cube = solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).expect("a box");
    let floor = HalfSpace::new(Vector3::y(), 0.0).expect("a half-space");
    let mut options = ManifoldOptions::default().prediction(f64::NAN);
    let pose = relative(&Pose::IDENTITY);
    assert!(floor.contacts(&cube, &pose, &options).points().is_empty());
    options = ManifoldOptions::default().prediction(0.1);
    (options.max_face_sine, options.rebuild_motion) = (f64::NAN, f64::NAN);
    assert_eq!(floor.contacts(&cube, &pose, &options).points().len(), 1);
}
