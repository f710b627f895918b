//! A manifold over frames: ids persist, and cached manifolds keep their bounds.

use lin_canny::{ConvexPolyhedron, FeaturePair, Manifold, ManifoldOptions, Tracker};
use truth::contacts::widest_face;
use truth::motion::{self, Frame};
use truth::pose::{add, radius};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Pose, workload};

#[test]
fn names_last_at_rest() {
    let mut rng = Rng::new(604);
    let mut bodies = vec![
        shapes::cube(),
        shapes::cuboid([0.7, 0.4, 0.2]),
        shapes::prism(7, 1.0, 0.3),
    ];
    bodies.push(shapes::prism(48, 1.0, 0.3));
    bodies.push(shapes::sphere(&mut rng, 20));
    let bodies: Vec<_> = bodies.iter().map(support::body).collect();
    let (mut frames, mut fresh, mut full) = (0, 0, 0);
    for (k, a) in bodies.iter().enumerate() {
        for b in &bodies {
            for (noise, drift) in [(1e-6, None), (1e-4, None), (1e-7, Some(0.0))] {
                let ((face_a, _), (face_b, reach)) = (widest_face(a), widest_face(b));
                // Including vertex on vertex and edge on edge.
                let spin = if k % 2 == 0 { 0.0 } else { rng.range(0.0, 6.0) };
                let start = workload::stacked(face_a, face_b, spin, -1e-3);
                let (mut pair, mut m) = (Tracker::new(), Manifold::new());
                let mut options = ManifoldOptions::default().prediction(0.05);
                options.rebuild_motion = drift.unwrap_or(options.rebuild_motion);
                let mut before: Option<Vec<FeaturePair>> = None;
                for frame in workload::at_rest(start, noise, reach, 60, &mut rng) {
                    pair.manifold(a, b, &support::relative(&frame), &options, &mut m);
                    let names: Vec<_> = m.points().iter().map(|p| p.id).collect();
                    if drift.is_none() {
                        assert!(before.as_ref().is_none_or(|b| *b == names), "{before:?} {m:?}");
                    } else if let Some(before) = &before {
                        let lasting = names.iter().filter(|n| before.contains(n)).count();
                        full += usize::from(lasting == names.len());
                    }
                    frames += 1;
                    fresh += usize::from(m.is_fresh());
                    before = Some(names);
                }
            }
        }
    }
    // Without drift, every frame computes again, and rounding chooses among equal vertices.
    assert!(frames == 4500 && fresh < 1700 && full > 1000, "{frames} {fresh} {full}");
}

#[test]
fn sliding_contacts_keep_their_names_and_order() {
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.5]));
    let cube = support::body(&shapes::cube());
    let (mut pair, mut m) = (Tracker::new(), Manifold::new());
    let options = ManifoldOptions::default().prediction(0.05);
    let mut first: Option<Vec<FeaturePair>> = None;
    for k in 0..100 {
        let pose = support::shifted([0.025 * f64::from(k) - 1.0, 0.3, 1.49]);
        pair.manifold(&plate, &cube, &pose, &options, &mut m);
        let names: Vec<_> = m.points().iter().map(|p| p.id).collect();
        assert_eq!(names.len(), 4);
        assert!(m.is_fresh());
        assert_eq!(*first.get_or_insert(names.clone()), names, "{k}");
        assert!((m.points()[0].separation + 0.01).abs() < 1e-14);
    }
}

/// If a vertex leaves the face below it, a crossing of two edges replaces it: another feature pair,
/// but the same contact.
#[test]
fn names_last_over_a_change_of_features() {
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.5]));
    let cube = support::body(&shapes::cube());
    for drift in [0.0, ManifoldOptions::default().rebuild_motion] {
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let mut options = ManifoldOptions::default().prediction(0.05);
        (options.rebuild_motion, options.reselect_motion) = (drift, 0.0);
        let (mut first, mut changed) = (None, 0);
        for k in 0..100 {
            let pose = support::shifted([2.95 + 0.001 * f64::from(k), 0.3, 1.49]);
            pair.manifold(&plate, &cube, &pose, &options, &mut m);
            let names: Vec<_> = m.points().iter().map(|p| p.id).collect();
            assert_eq!(*first.get_or_insert(names.clone()), names, "{k}");
            changed += usize::from(m.points().iter().any(|p| p.features != p.id));
        }
        assert!(changed > 40, "{changed}");
    }
}

/// A vertex moves to and fro over a border.
///
/// Its id moves to one of the two crossings that replace it, and returns from either. No two
/// contacts have the same id.
#[test]
fn names_are_never_given_twice() {
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.5]));
    let cube = support::body(&shapes::cube());
    let mut rng = Rng::new(613);
    let mut strange = 0;
    for _ in 0..60 {
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let mut options = ManifoldOptions::default().prediction(0.05);
        (options.rebuild_motion, options.reselect_motion, options.max_points) = (0.0, 0.0, 8);
        let (yaw, aside) = (rng.range(0.1, 1.4), rng.range(-0.5, 0.5));
        for k in 0..120 {
            let x = 2.6 + 0.1 * (0.2 * f64::from(k)).sin() + rng.range(0.0, 0.02);
            let turn = yaw + rng.range(-0.02, 0.02);
            let frame = Frame::new(Pose::IDENTITY, Pose::turn([0.0, 0.0, 1.0], turn, [x, aside, 1.49]));
            pair.manifold(&plate, &cube, &support::relative(&frame), &options, &mut m);
            for (k, p) in m.points().iter().enumerate() {
                assert!(m.points()[..k].iter().all(|q| q.id != p.id), "{m:?}");
                strange += usize::from(m.points().iter().any(|q| q.features == p.id && q.id != p.id));
            }
        }
    }
    assert!(strange > 100, "{strange}");
}

#[test]
fn old_manifolds_keep_their_bounds() {
    let mut rng = Rng::new(605);
    let (mut old, mut empty, mut anew) = (0, 0, 0);
    for k in 0..60 {
        let n = 6 + rng.below(30);
        let (a, b) = match k % 3 {
            0 => (shapes::cube(), shapes::cuboid([0.3, 0.2, 0.1])),
            1 => (shapes::sphere(&mut rng, n), shapes::sphere(&mut rng, n)),
            _ => (shapes::small(&mut rng), shapes::small(&mut rng)),
        };
        let radii = (radius(&a.points), radius(&b.points));
        let (a, b) = (support::body(&a), support::body(&b));
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let mut options = ManifoldOptions::default().prediction(0.02);
        options.rebuild_motion = 1.0 / 64.0;
        for frame in motion::pass_through(&mut rng, 4000, radii, 0.3) {
            let pose = support::relative(&frame);
            pair.manifold(&a, &b, &pose, &options, &mut m);
            let truth = pair.clone().closest(&a, &b, &pose);
            assert!(m.lower() <= truth.upper && truth.lower <= m.upper(), "{m:?} {truth:?}");
            if m.is_fresh() {
                anew += 1;
                continue;
            }
            if m.points().is_empty() {
                assert!(truth.upper > options.prediction, "{m:?} {truth:?}");
                empty += 1;
                continue;
            }
            let size = support::size(&a, &b, &frame);
            let deepest = m.deepest().expect("not empty").separation;
            assert!(deepest >= m.lower() - 1e-13 * size, "{m:?} {truth:?}");
            assert!(m.upper() - m.lower() < 2.1 * options.rebuild_motion * radii.0.min(radii.1) + 1e-12 * size);
            old += 1;
        }
    }
    assert!(old > 1000 && empty > 10_000 && anew > 10_000, "{old} {empty} {anew}");
}

#[test]
fn manifolds_of_other_bodies_are_made_anew() {
    let cube = support::body(&shapes::cube());
    let shaved = {
        let mut s = shapes::cube();
        s.points.push([1.0, 1.0, 0.99]);
        s.points.retain(|p| *p != [1.0, 1.0, 1.0]);
        support::body(&Shape::hull("shaved", s.points))
    };
    assert_eq!(shaved.vertex_count(), 8);
    let pose = support::shifted([0.0, 0.0, 1.99]);
    let options = ManifoldOptions::default().prediction(0.05);
    let (mut pair, mut m) = (Tracker::new(), Manifold::new());
    pair.manifold(&cube, &cube, &pose, &options, &mut m);
    pair.manifold(&cube, &cube, &pose, &options, &mut m);
    assert!(!m.is_fresh());
    pair.manifold(&shaved, &cube, &pose, &options, &mut m);
    assert!(m.is_fresh());
    pair.manifold(
        &shaved,
        &cube,
        &pose,
        &ManifoldOptions::default().prediction(0.06),
        &mut m,
    );
    assert!(m.is_fresh());
}

/// Points of bodies far from their origin have fewer digits than distances between the bodies:
/// nothing is measured from them that an outcome gives more accurately.
#[test]
fn bodies_far_from_their_origin_are_asked_anew() {
    let away = [3e5, -2e5, 1e5];
    let near = support::body(&shapes::cube());
    let far = support::body(&shapes::cube().moved(&Pose::shift(away)));
    let mut rng = Rng::new(612);
    for (a, b) in [(&near, &far), (&far, &near), (&far, &far)] {
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let options = ManifoldOptions::default().prediction(0.02);
        let home = |body: &ConvexPolyhedron| {
            Pose::shift(if std::ptr::eq(body, &far) {
                away.map(|x| -x)
            } else {
                [0.0; 3]
            })
        };
        for k in 0..40 {
            let aside = [0.3 + 1e-5 * f64::from(k), 0.2, 1.99 - 1e-6 * rng.uniform()];
            let frame = Frame::new(home(a), Pose::shift(add(home(b).t, aside)));
            let pose = support::relative(&frame);
            pair.manifold(a, b, &pose, &options, &mut m);
            let truth = Tracker::new().closest(a, b, &pose);
            let deepest = m.deepest().expect("cube on cube").separation;
            assert!((deepest - truth.distance).abs() <= 1e-14, "{k}: {m:?} {truth:?}");
        }
    }
}
