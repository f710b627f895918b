//! Pairs of fixed bodies: counted if they are left out, and queried like all others if enabled.

use crate::{ALL, NONE, group, read_back};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, PairQueries, Scene, SceneError};
use lin_canny::{ContactState, ManifoldOptions, Mesh, Ray, Velocity};

fn at(x: f64) -> Isometry3<f64> {
    Isometry3::translation(x, 0.0, 0.0)
}

/// Three plates of 10 mm in a row, of which the second is 0.5 mm inside the first.
fn assembly(queries: PairQueries) -> (Scene, [BodyId; 3]) {
    let mut scene = Scene::with_queries(queries).unwrap();
    let plate = solids::cuboid(Vector3::new(5.0, 40.0, 30.0)).unwrap();
    let ids = [0.0, 9.5, 20.0].map(|x| scene.insert(Body::fixed(plate.clone()), at(x)).unwrap());
    (scene, ids)
}

#[test]
fn a_clash_of_fixed_bodies_is_counted_or_found() {
    let queries = NONE.overlap(true).distance(1.0).features(true).depth(true);
    let queries = queries.manifold(ManifoldOptions::default().prediction(0.6));
    let (mut scene, [a, b, c]) = assembly(queries);
    assert_eq!(scene.step().counts.fixed_left_out, 3);
    assert!(scene.events().is_empty() && scene.pair_count() == 0);
    assert_eq!(scene.closest_pair(ALL, ALL), Ok(None));
    let text = scene.report().to_string();
    assert!(text.starts_with("3 pairs of fixed bodies are not tested"), "{text}");
    // Steps without changes keep the count.
    assert_eq!(scene.step().counts.fixed_left_out, 3);

    scene.set_queries(ALL, ALL, queries.fixed(true)).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 0);
    assert!(!scene.report().to_string().contains("fixed bodies"));
    let [event] = scene.events() else {
        panic!("{:?}", scene.events())
    };
    assert_eq!((event.a, event.b, event.change), (a, b, Change::OverlapBegan));
    let clash = scene.pair(a, b).unwrap();
    assert!((clash.distance.unwrap().value + 0.5).abs() < 1e-12);
    assert_eq!(clash.manifold.unwrap().points().len(), 4);
    let gap = scene.pair(c, b).unwrap();
    assert!((gap.distance.unwrap().value - 0.5).abs() < 1e-12 && gap.overlaps == Some(false));
    assert!(gap.manifold.is_some() && scene.pair(a, c).is_none());

    // Calls on request.
    let found = scene.closest_pair(ALL, ALL).unwrap().unwrap();
    assert_eq!(found.a, a);
    assert_eq!(found.b, b);
    assert_eq!(found.outcome.state, ContactState::Overlapping);
    let contact = scene.any_contact(ALL, ALL).unwrap().unwrap();
    assert_eq!((contact.a, contact.b), (a, b));
    let near = scene.pairs_within(ALL, ALL, 0.6).unwrap();
    assert_eq!(near.iter().map(|p| (p.a, p.b)).collect::<Vec<_>>(), [(a, b), (b, c)]);
    let near = scene.nearest(c, 2, 90.0).unwrap();
    assert_eq!(near.iter().map(|p| p.b).collect::<Vec<_>>(), [b, a]);

    // Nothing changes: nothing is queried. A pose of a fixed body may be set.
    assert_eq!(scene.step().counts.queries, 0);
    scene.set_pose(b, at(10.25)).unwrap();
    scene.step();
    assert!(scene.events().iter().any(|e| e.change == Change::OverlapEnded));
    assert!((scene.pair(a, b).unwrap().distance.unwrap().value - 0.25).abs() < 1e-12);
    assert!(matches!(
        scene.set_velocity(b, Velocity::default()),
        Err(SceneError::Fixed { .. })
    ));

    // The option ends as it began, and takes its pairs with it.
    scene.set_pose(b, at(9.0)).unwrap();
    scene.step();
    scene.set_queries(ALL, ALL, queries).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 3);
    let ended: Vec<_> = scene.events().iter().map(|e| (e.a, e.b, e.change)).collect();
    assert_eq!(ended, [(a, b, Change::OverlapEnded)]);
    assert_eq!(scene.pair_count(), 0);
}

#[test]
fn the_count_names_pairs_with_queries_alone() {
    let mut scene = Scene::new();
    let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let mut ids = Vec::new();
    for k in 0..12u8 {
        let body = if k < 9 { Body::fixed } else { Body::moving };
        let body = body(cube.clone()).group(group(k % 3));
        ids.push(scene.insert(body, at(9.0 * f64::from(k))).unwrap());
    }
    assert_eq!(scene.step().counts.fixed_left_out, 0);
    // Three fixed bodies in each of three groups.
    scene.set_queries(group(0), group(0), NONE.within(0.1)).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 3);
    scene.set_queries(group(0), group(1), NONE.boxes(true)).unwrap();
    scene
        .set_queries(group(1), group(1), NONE.overlap(true).fixed(true))
        .unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 12);
    // Excluded pairs were left out by the caller, whatever the order and the groups.
    for (a, b) in [(0, 3), (4, 0), (1, 4), (0, 9), (2, 5)] {
        scene.exclude_pair(ids[a], ids[b]).unwrap();
    }
    assert_eq!(scene.step().counts.fixed_left_out, 10);
    let mut read = read_back(&scene);
    read.include_pair(ids[3], ids[0]).unwrap();
    assert_eq!(read.step().counts.fixed_left_out, 11);
    scene.remove(ids[0]).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 1 + 6);
    scene.set_group(ids[8], group(0)).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 3 + 9);
    let mut read = read_back(&scene);
    assert_eq!(read.step().counts.fixed_left_out, 12);
    assert_eq!(read.report().counts, scene.step().counts);
}

#[test]
fn fixed_bodies_answer_the_queries_of_their_kinds() {
    let mesh = || Mesh::from_convex(&solids::octahedron(0.5).unwrap()).unwrap();
    let mut scene = Scene::with_queries(NONE.depth(true)).unwrap();
    for _ in 0..2 {
        scene.insert(Body::fixed(mesh()), at(0.0)).unwrap();
    }
    let refused = scene.set_queries(ALL, ALL, NONE.depth(true).fixed(true));
    assert!(matches!(refused, Err(SceneError::Unanswered { query: "depth", .. })));
    let queries = NONE.overlap(true).manifold(ManifoldOptions::default().prediction(0.1));
    scene.set_queries(ALL, ALL, queries.fixed(true)).unwrap();
    scene.step();
    let [pair] = &scene.pairs().collect::<Vec<_>>()[..] else {
        panic!("one pair")
    };
    assert!(pair.overlaps == Some(true) && pair.contacts.is_some());
    scene.set_queries(ALL, ALL, NONE.depth(true)).unwrap();
    assert_eq!(scene.step().counts.fixed_left_out, 1);
}

#[test]
fn rays_and_moving_bodies_do_not_see_the_option() {
    let queries = NONE.overlap(true).within(0.3);
    let [mut plain, mut with] = [queries, queries.fixed(true)].map(|queries| assembly(queries).0);
    let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let ray = Ray::new(Point3::new(-50.0, 1.0, 1.0), Vector3::x()).unwrap();
    let mut seen = [&mut plain, &mut with].map(|scene| {
        let moving = scene.insert(Body::moving(cube.clone()), at(-7.0)).unwrap();
        let mut seen = Vec::new();
        for k in 0..60 {
            scene.set_pose(moving, at(-7.0 + 0.5 * f64::from(k))).unwrap();
            scene.step();
            let events = scene.events().iter().filter(|e| e.b == moving);
            let events: Vec<_> = events.map(|e| (e.a, e.change)).collect();
            seen.push((events, scene.cast_ray(&ray, f64::INFINITY, |_| true)));
        }
        seen
    });
    let [plain, with] = &mut seen;
    assert!(plain == with && plain.iter().map(|s| s.0.len()).sum::<usize>() >= 6);
}

/// Removes the members of objects that a file of an earlier version does not have.
#[cfg(feature = "serde")]
pub(crate) fn of_old(value: &mut serde_json::Value) -> u32 {
    use serde_json::Value;
    let known = [
        ("without_queries", "fixed_left_out"),
        ("pairs_with", "fixed_with"),
        ("local_depth", "impact_within"),
        ("local_depth", "fixed"),
        ("impact", "distance"),
    ];
    let mut removed = 0;
    match value {
        Value::Object(members) => {
            for (beside, name) in known {
                // Queries have an impact, too.
                let is_query = members.contains_key("local_depth");
                if members.contains_key(beside) && (name != "distance" || !is_query) {
                    removed += u32::from(members.remove(name).is_some());
                }
            }
            removed += members.values_mut().map(of_old).sum::<u32>();
        }
        Value::Array(items) => removed += items.iter_mut().map(of_old).sum::<u32>(),
        _ => {}
    }
    removed
}

#[cfg(feature = "serde")]
#[test]
fn scenes_of_old_files_are_read() {
    let (mut scene, [a, b, _]) = assembly(NONE.overlap(true).within(0.4));
    let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let moving = scene.insert(Body::moving(cube), at(-7.0)).unwrap();
    scene.step();
    let mut old = serde_json::to_value(&scene).unwrap();
    assert!(of_old(&mut old) > 10);
    let mut read: Scene = serde_json::from_value(old).unwrap();
    for scene in [&mut scene, &mut read] {
        assert_eq!(scene.step().counts.fixed_left_out, 3);
        scene.set_pose(moving, at(-5.7)).unwrap();
        scene.step();
        let queries = scene.queries(ALL, ALL);
        assert!(!queries.fixed && queries.impact_within.is_none());
        scene.set_queries(ALL, ALL, queries.fixed(true)).unwrap();
    }
    assert_eq!(scene.events(), read.events());
    for scene in [&mut scene, &mut read] {
        scene.step();
        assert_eq!(scene.pair(a, b).and_then(|p| p.overlaps), Some(true));
    }
    assert_eq!(scene.events(), read.events());
}
