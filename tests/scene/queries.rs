//! Scenes against brute force: the closest pair of two groups, excluded pairs, queries for all
//! groups.

use crate::group;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Group, PairQueries, Scene, SceneError};
use lin_canny::{ContactState, Outcome, RelativePose, Tracker};
use truth::rng::Rng;

const BOXES: PairQueries = PairQueries::none().boxes(true);

fn pose(rng: &mut Rng, room: f64) -> Isometry3<f64> {
    let (q, t) = (rng.quat(), [0; 3].map(|_| rng.range(-room, room)));
    truth::Pose::new(q, t).isometry()
}

/// Returns bodies of the groups 1 and 2 in a room of half size `room`; every fourth body is fixed
/// and has the user data 1.
fn crowd(rng: &mut Rng, queries: PairQueries, count: [usize; 2], room: f64) -> Scene {
    let mut scene = Scene::new();
    for (g, h) in [(1, 1), (1, 2)] {
        scene.set_queries(group(g), group(h), queries).unwrap();
    }
    for (g, n) in [1, 2].into_iter().zip(count) {
        for i in 0..n {
            let half = Vector3::from_fn(|_, _| rng.range(0.05, 0.5));
            let shape = match i % 2 {
                0 => solids::cuboid(half),
                _ => solids::random_hull(20, half, i as u64),
            };
            let body = Body::moving(shape.unwrap()).group(group(g));
            let body = match i % 4 {
                1 => Body::fixed(body.geometry).group(group(g)).user_data(1),
                _ => body,
            };
            scene.insert(body, pose(rng, room)).unwrap();
        }
    }
    scene
}

/// Returns the closest of all pairs, each measured by a separate tracker.
fn brute(scene: &Scene, these: Group, those: Group) -> Option<(BodyId, BodyId, Outcome)> {
    let of = |g: Group| scene.bodies().filter(move |id| scene.group(*id) == Some(g));
    let is_fixed = |id| scene.user_data(id) == Some(1);
    let mut pairs = Vec::new();
    for a in of(these) {
        for b in of(those) {
            let twice = these == those && b <= a;
            if !(twice || is_fixed(a) && is_fixed(b) || scene.is_excluded(a, b)) {
                let pose = RelativePose::new(scene.pose(a).unwrap(), scene.pose(b).unwrap()).unwrap();
                let [x, y] = [a, b].map(|id| scene.geometry(id).unwrap().as_polyhedron().unwrap());
                pairs.push((a, b, Tracker::new().closest(x, y, &pose)));
            }
        }
    }
    pairs.into_iter().min_by(|x, y| x.2.distance.total_cmp(&y.2.distance))
}

#[test]
fn the_closest_pair_is_the_closest_of_all() {
    let mut rng = Rng::new(41);
    let far = BOXES.distance(f64::INFINITY);
    let within = BOXES.within(0.3);
    let (mut classes, mut none) = ([0; 2], 0);
    for round in 0..120 {
        let room = *rng.pick(&[1.0, 4.0, 15.0]);
        let queries = *rng.pick(&[BOXES, within, far]);
        let count = *rng.pick(&[[1, 30], [6, 25], [20, 5], [2, 0]]);
        let mut scene = crowd(&mut rng, queries, count, room);
        let ids: Vec<_> = scene.bodies().collect();
        for _ in 0..rng.below(30) {
            scene.exclude_pair(*rng.pick(&ids), *rng.pick(&ids)).unwrap();
        }
        scene.step();
        for (g, h) in [(1, 2), (2, 1), (1, 1)].map(|(g, h)| (group(g), group(h))) {
            let (found, truth) = (scene.closest_pair(g, h).unwrap(), brute(&scene, g, h));
            let Some((found, truth)) = found.zip(truth) else {
                assert!(found.is_none() && truth.is_none(), "{round}: {found:?} {truth:?}");
                none += 1;
                continue;
            };
            let off = (found.outcome.distance - truth.2.distance).abs();
            assert!(off <= 1e-12 * room, "{round}: {found:?} {truth:?}");
            assert_eq!((found.a, found.b), (truth.0, truth.1), "{round}");
            assert_eq!((scene.group(found.a), scene.group(found.b)), (Some(g), Some(h)));
            classes[usize::from(found.outcome.state == ContactState::Overlapping)] += 1;
        }
    }
    println!("{classes:?} separated and overlapping, {none} without a pair");
    assert!(classes.iter().all(|n| *n > 50) && none > 10, "{classes:?} {none}");
}

#[test]
fn excluded_pairs_end_and_begin_again() {
    let mut scene = Scene::with_queries(BOXES.overlap(true)).unwrap();
    let cube = solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).unwrap();
    let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let [a, b, c] = [0.0, 0.9, 1.8].map(|x| scene.insert(Body::moving(cube.clone()), at(x)).unwrap());
    let changes = |scene: &mut Scene| -> Vec<_> {
        scene.step();
        scene.events().iter().map(|e| (e.a, e.b, e.change)).collect()
    };
    let [began, met] = [Change::OverlapBegan, Change::BoxesMet];
    let all = [(a, b, met), (a, b, began), (b, c, met), (b, c, began)];
    assert_eq!(changes(&mut scene), all);
    scene.exclude_pair(b, a).unwrap();
    assert!(scene.is_excluded(a, b) && !scene.is_excluded(b, c));
    assert_eq!(scene.excluded_pairs().collect::<Vec<_>>(), [(a, b)]);
    // Until the next step, all results are those of the last step.
    assert!(scene.pair(a, b).is_some());
    let ends = [(a, b, Change::OverlapEnded), (a, b, Change::BoxesParted)];
    assert_eq!(changes(&mut scene), ends);
    assert!(scene.pair(a, b).is_none() && scene.pair(b, c).is_some());
    // Boxes that separate and meet again make no new pair.
    scene.set_pose(a, at(-9.0)).unwrap();
    assert_eq!(changes(&mut scene), []);
    scene.set_pose(a, at(0.0)).unwrap();
    assert_eq!(changes(&mut scene), []);
    scene.include_pair(a, b).unwrap();
    assert_eq!(changes(&mut scene), all[..2]);
    // A pair is forgotten with its body, even if the index is reused.
    scene.exclude_pair(b, c).unwrap();
    scene.remove(c).unwrap();
    assert!(!scene.is_excluded(b, c) && scene.excluded_pairs().next().is_none());
    scene.step();
    let d = scene.insert(Body::moving(cube), at(1.8)).unwrap();
    assert_eq!(d.index, c.index);
    assert_eq!(changes(&mut scene), [(b, d, met), (b, d, began)]);
    assert_eq!(scene.exclude_pair(b, c), Err(SceneError::StaleBody { body: c }));
}

#[test]
fn a_scene_without_queries_is_not_silent() {
    let cube = solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).unwrap();
    let mut scene = Scene::new();
    let a = scene
        .insert(Body::moving(cube.clone()).user_data(7), Isometry3::identity())
        .unwrap();
    let b = scene
        .insert(Body::moving(cube).group(group(3)), Isometry3::identity())
        .unwrap();
    assert_eq!(scene.step().counts.without_queries, 2);
    assert!(scene.report().to_string().contains("set_queries"), "{}", scene.report());
    let refused = SceneError::GroupNotEnabled { group: group(0) };
    assert_eq!(scene.nearest(a, 1, 9.0), Err(refused));
    let refused = SceneError::NotEnabled {
        these: group(0),
        those: group(3),
    };
    assert_eq!(scene.closest_pair(group(0), group(3)), Err(refused));
    scene.set_queries(group(0), group(0), BOXES).unwrap();
    assert_eq!(scene.closest_pair(group(0), group(0)), Err(SceneError::StepDue));
    assert_eq!(scene.step().counts.without_queries, 1);
    assert_eq!(scene.closest_pair(group(0), group(0)), Ok(None));
    scene.set_group(b, group(0)).unwrap();
    assert_eq!(scene.step().counts.without_queries, 0);
    assert!(!scene.report().to_string().contains("set_queries"));
    scene.remove(b).unwrap();
    assert_eq!((scene.user_data(a), scene.user_data(b)), (Some(7), None));
    scene.set_user_data(a, u64::MAX).unwrap();
    assert_eq!(scene.user_data(a), Some(u64::MAX));
    scene.set_group(a, group(9)).unwrap();
    assert_eq!(scene.step().counts.without_queries, 1);
}

#[cfg(feature = "serde")]
#[test]
fn excluded_pairs_and_user_data_survive_a_file() {
    let mut rng = Rng::new(5);
    let mut scene = crowd(&mut rng, BOXES.overlap(true), [8, 8], 0.5);
    let ids: Vec<_> = scene.bodies().collect();
    scene.exclude_pair(ids[0], ids[9]).unwrap();
    scene.exclude_pair(ids[3], ids[2]).unwrap();
    scene.step();
    let text = serde_json::to_string(&scene).unwrap();
    let mut back: Scene = serde_json::from_str(&text).unwrap();
    let found = back.excluded_pairs().collect::<Vec<_>>();
    assert_eq!(found, [(ids[0], ids[9]), (ids[2], ids[3])]);
    assert!(ids.iter().all(|id| back.user_data(*id) == scene.user_data(*id)));
    for scene in [&mut scene, &mut back] {
        scene.remove(ids[1]).unwrap();
        scene.include_pair(ids[0], ids[9]).unwrap();
        scene.step();
    }
    assert_eq!(back.events(), scene.events());
    assert_eq!(back.report().counts, scene.report().counts);
    // A pair of one body, of no body, or listed twice.
    for pairs in ["[[2,2]]", "[[3,2]]", "[[2,99]]", "[[2,3],[2,3]]"] {
        let broken = text.replace("\"ignored\":[[0,9],[2,3]]", &format!("\"ignored\":{pairs}"));
        assert_ne!(broken, text);
        assert!(serde_json::from_str::<Scene>(&broken).is_err(), "{pairs}");
    }
}
