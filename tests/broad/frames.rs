//! The broad phase against brute force, frame by frame.

use lin_canny::broad::*;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeSet;
use truth::boxes::{Kind, Scene, brute_force};
use truth::rng::Rng;

type Keys = BTreeSet<(BodyId, BodyId)>;

/// Returns the expected pairs by definition, from all pairs.
fn expected(broad: &SweepAndPrune) -> Keys {
    let ids: Vec<BodyId> = broad.bodies().collect();
    let boxes: Vec<StoredBox> = ids.iter().map(|id| broad.stored_box(*id).unwrap()).collect();
    let may = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|i| broad.body(ids[i as usize]).unwrap());
        match a.fixed && b.fixed {
            true => a.groups.meet_fixed(b.groups),
            false => a.groups.meet(b.groups),
        }
    };
    let all = brute_force(&boxes, StoredBox::overlaps);
    all.into_iter()
        .filter(|&(a, b)| may(a, b))
        .map(|(a, b)| (ids[a as usize], ids[b as usize]))
        .collect()
}

fn present(broad: &SweepAndPrune) -> Keys {
    broad.pairs().map(|p| (p.a, p.b)).collect()
}

/// Replays events, which must be new, in order and sufficient.
#[derive(Default)]
struct Replay {
    pairs: Keys,
    slots: std::collections::BTreeMap<PairId, (BodyId, BodyId)>,
}

impl Replay {
    fn apply(&mut self, events: Events<'_>) {
        for part in [events.ended, events.began] {
            assert!(part.is_sorted_by(|a, b| (a.a.index, a.b.index) < (b.a.index, b.b.index)));
        }
        for pair in events.ended {
            assert!(self.pairs.remove(&(pair.a, pair.b)));
            assert_eq!(self.slots.remove(&pair.id), Some((pair.a, pair.b)));
        }
        for pair in events.began {
            assert!(self.pairs.insert((pair.a, pair.b)));
            assert_eq!(self.slots.insert(pair.id, (pair.a, pair.b)), None);
        }
    }
}

/// A broad phase, and the pairs according to its events.
struct Fed {
    broad: SweepAndPrune,
    replay: Replay,
}

impl Fed {
    fn new() -> Self {
        Self {
            broad: SweepAndPrune::new(),
            replay: Replay::default(),
        }
    }

    /// Runs a step and compares all results.
    fn step(&mut self) {
        self.replay.apply(self.broad.step());
        let expected = expected(&self.broad);
        assert_eq!(self.replay.pairs, expected);
        assert_eq!(present(&self.broad), expected);
        assert_eq!(self.broad.pair_count(), expected.len());
        for (id, (a, b)) in &self.replay.slots {
            let pair = Pair { id: *id, a: *a, b: *b };
            assert_eq!(self.broad.pair_of(*id), Some(pair));
            assert_eq!(self.broad.pair(*b, *a), Some(pair));
        }
    }
}

fn run(kind: Kind, n: usize, steps: usize, body: BodyOptions) -> usize {
    let mut scene = Scene::new(kind, n);
    let mut fed = Fed::new();
    let ids: Vec<BodyId> = scene.boxes.iter().map(|b| fed.broad.insert(b, body).unwrap()).collect();
    fed.step();
    let mut seen = fed.replay.pairs.len();
    for _ in 0..steps {
        scene.step();
        let batch: Vec<(BodyId, Aabb)> = scene
            .moved
            .iter()
            .map(|&i| (ids[i as usize], scene.boxes[i as usize]))
            .collect();
        fed.broad.set_boxes(&batch).unwrap();
        fed.step();
        seen += fed.replay.pairs.len();
    }
    seen
}

#[test]
fn every_scene_equals_brute_force_on_every_frame() {
    for kind in Kind::ALL {
        for n in [3, 40, 700] {
            let seen = run(kind, n, 40, BodyOptions::default());
            assert!(n < 700 || seen > 500, "{} hardly has pairs: {seen}", kind.name());
        }
    }
}

#[test]
fn growth_changes_boxes_but_not_the_definition() {
    for kind in [Kind::Uniform, Kind::Pile, Kind::Movers, Kind::Teleport, Kind::Mixed] {
        run(kind, 400, 60, BodyOptions::default().growth(0.04));
        run(kind, 400, 60, BodyOptions::default().growth(0.02).lookahead(5.0));
    }
}

#[test]
fn growth_holds_the_given_box() {
    let mut scene = Scene::new(Kind::UniformSlow, 300);
    let mut broad = SweepAndPrune::new();
    let body = BodyOptions::default().growth(0.03).lookahead(2.0);
    let ids: Vec<BodyId> = scene.boxes.iter().map(|b| broad.insert(b, body).unwrap()).collect();
    let mut kept = 0;
    for _ in 0..30 {
        scene.step();
        let before: Vec<_> = ids.iter().map(|id| broad.stored_box(*id)).collect();
        for (id, aabb) in ids.iter().zip(&scene.boxes) {
            broad.set_box(*id, aabb).unwrap();
            let given = StoredBox::outward(aabb, &Point3::origin());
            assert!(broad.stored_box(*id).unwrap().contains(&given));
        }
        kept += ids
            .iter()
            .zip(before)
            .filter(|(id, old)| broad.stored_box(**id) == *old)
            .count();
        broad.step();
    }
    assert!(kept > 300 * 30 / 2, "growth keeps most boxes: {kept}");
}

#[test]
fn inserting_and_removing_bodies_equals_brute_force() {
    let mut random = Rng::new(7);
    let mut fed = Fed::new();
    let mut ids: Vec<BodyId> = Vec::new();
    let anywhere = |random: &mut Rng| {
        let center = Point3::from(Vector3::from_fn(|_, _| random.range(-6.0, 6.0)));
        Aabb::from_center(center, Vector3::from_fn(|_, _| random.range(0.1, 1.0)))
    };
    for step in 0..150 {
        let (come, go) = if step < 75 { (8, 4) } else { (4, 8) };
        for _ in 0..come {
            let aabb = anywhere(&mut random);
            let body = if random.below(4) == 0 {
                BodyOptions::default().fixed(true)
            } else {
                BodyOptions::default()
            };
            ids.push(fed.broad.insert(&aabb, body).unwrap());
        }
        for _ in 0..go.min(ids.len()) {
            let id = ids.swap_remove(random.below(ids.len()));
            fed.broad.remove(id).unwrap();
            assert_eq!(fed.broad.remove(id), Err(BroadPhaseError::StaleId { body: id }));
        }
        for _ in 0..ids.len() / 10 {
            let id = ids[random.below(ids.len())];
            fed.broad.set_box(id, &anywhere(&mut random)).unwrap();
        }
        fed.step();
    }
}

#[test]
fn unbounded_bodies_pair_with_what_they_reach() {
    let mut fed = Fed::new();
    let mut scene = Scene::new(Kind::Uniform, 200);
    let ids: Vec<BodyId> = scene
        .boxes
        .iter()
        .map(|b| fed.broad.insert(b, BodyOptions::default()).unwrap())
        .collect();
    let mut below = Aabb::everything();
    below.max.z = 0.0;
    let ground = fed
        .broad
        .insert_unbounded(&below, BodyOptions::default().fixed(true))
        .unwrap();
    let all = fed
        .broad
        .insert_unbounded(&Aabb::everything(), BodyOptions::default())
        .unwrap();
    let far = Aabb::from_center(Point3::new(1e300, -1e300, 1e200), Vector3::repeat(1.0));
    fed.broad.insert(&far, BodyOptions::default()).unwrap();
    for step in 0..30 {
        scene.step();
        for (id, aabb) in ids.iter().zip(&scene.boxes).filter(|(id, _)| id.index % 3 == step % 3) {
            fed.broad.set_box(*id, aabb).unwrap();
        }
        if step == 10 {
            below.max.z = 3.0;
            fed.broad.set_box(ground, &below).unwrap();
        }
        if step == 20 {
            fed.broad.remove(all).unwrap();
        }
        fed.step();
    }
    assert!(fed.broad.pair_count() > 50);
}

#[test]
fn far_bodies_work() {
    let mut fed = Fed::new();
    let mut scene = Scene::new(Kind::Pile, 200);
    let shift = |aabb: &Aabb, by: f64| {
        let by = Vector3::repeat(by);
        Aabb::new(aabb.min + by, aabb.max + by)
    };
    let place = |i: usize| {
        if i.is_multiple_of(2) {
            0.0
        } else {
            [1e5, -3e6, 1e12][i % 3]
        }
    };
    let boxes: Vec<Aabb> = scene
        .boxes
        .iter()
        .enumerate()
        .map(|(i, b)| shift(b, place(i)))
        .collect();
    let ids: Vec<BodyId> = boxes
        .iter()
        .map(|b| fed.broad.insert(b, BodyOptions::default()).unwrap())
        .collect();
    for step in 0..20 {
        fed.step();
        scene.step();
        for (i, aabb) in scene.boxes.iter().enumerate() {
            let by = if step == 10 { -place(i) } else { place(i) };
            fed.broad.set_box(ids[i], &shift(aabb, by)).unwrap();
        }
    }
}

#[test]
fn an_origin_keeps_far_scenes_fine() {
    let origin = Point3::new(1e7, -1e7, 1e7);
    let mut near = SweepAndPrune::new();
    let mut far = SweepAndPrune::with_settings(Settings::default().origin(origin));
    let scene = Scene::new(Kind::Pile, 300);
    for aabb in &scene.boxes {
        // Multiples of 1/256, so that moving them does not round.
        let snap = |p: Point3<f64>| p.map(|v| (v * 256.0).round() / 256.0);
        let aabb = Aabb::new(snap(aabb.min), snap(aabb.max));
        near.insert(&aabb, BodyOptions::default()).unwrap();
        far.insert(
            &Aabb::new(aabb.min + origin.coords, aabb.max + origin.coords),
            BodyOptions::default(),
        )
        .unwrap();
    }
    assert_eq!(near.step(), far.step());
}

#[test]
fn refused_calls_name_the_body_and_change_nothing() {
    let mut fed = Fed::new();
    let cube = Aabb::from_center(Point3::origin(), Vector3::repeat(0.5));
    let [a, b] = [0; 2].map(|_| fed.broad.insert(&cube, BodyOptions::default()).unwrap());
    fed.step();
    for axis in 0..3 {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut broken = cube;
            broken.max[axis] = bad;
            let error = Err(BroadPhaseError::NonFinite { body: Some(b), axis });
            assert_eq!(fed.broad.set_box(b, &broken), error);
            let found = fed.broad.insert(&broken, BodyOptions::default());
            assert_eq!(found, Err(BroadPhaseError::NonFinite { body: None, axis }));
        }
        let mut inverted = cube;
        inverted.min[axis] = 7.0;
        let found = fed.broad.set_box(a, &inverted);
        assert_eq!(found, Err(BroadPhaseError::Inverted { body: Some(a), axis }));
    }
    let stale = BodyId {
        index: 1,
        generation: 3,
    };
    let answer = fed.broad.set_box(stale, &cube);
    assert_eq!(answer, Err(BroadPhaseError::StaleId { body: stale }));
    let unknown = BodyId {
        index: 77,
        generation: 1,
    };
    let found = fed.broad.remove(unknown);
    assert_eq!(found, Err(BroadPhaseError::StaleId { body: unknown }));
    assert_eq!(
        fed.broad.insert(&cube, BodyOptions::default().growth(-1.0)),
        Err(BroadPhaseError::Growth {
            what: "growth",
            value: -1.0
        })
    );
    fed.step();
    assert_eq!(fed.broad.pair_count(), 1);

    let apart = Aabb::from_center(Point3::new(9.0, 0.0, 0.0), Vector3::repeat(0.5));
    let broken = Aabb::new(Point3::new(f64::NAN, 0.0, 0.0), Point3::origin());
    let batch = [(a, broken), (b, apart), (stale, cube)];
    let error = fed.broad.set_boxes(&batch).unwrap_err();
    assert_eq!((error.index, error.refused), (0, 2));
    assert_eq!(error.first, BroadPhaseError::NonFinite { body: Some(a), axis: 0 });
    assert!(error.to_string().contains("body 0"), "{error}");
    fed.step();
    assert_eq!(fed.broad.pair_count(), 0);
}

#[test]
fn touching_and_flat_boxes_are_pairs() {
    let mut fed = Fed::new();
    let unit = |x: f64, y: f64, z: f64| Aabb::new(Point3::new(x, y, z), Point3::new(x + 1.0, y + 1.0, z + 1.0));
    fed.broad.insert(&unit(0.0, 0.0, 0.0), BodyOptions::default()).unwrap();
    fed.broad.insert(&unit(1.0, 1.0, 1.0), BodyOptions::default()).unwrap();
    let point = Point3::new(2.0, 2.0, 2.0);
    fed.broad
        .insert(&Aabb::new(point, point), BodyOptions::default())
        .unwrap();
    fed.broad
        .insert(&Aabb::new(point, point), BodyOptions::default())
        .unwrap();
    fed.broad
        .insert(&unit(-0.0, -1.0, 0.0), BodyOptions::default())
        .unwrap();
    fed.step();
    // The pairs: touching vertex, point on vertex (twice), point on point, touching face.
    assert_eq!(fed.broad.pair_count(), 5);
}

#[test]
fn groups_filters_and_fixed_bodies() {
    let cube = Aabb::from_center(Point3::origin(), Vector3::repeat(0.5));
    let robot = Groups {
        member_of: 1,
        pairs_with: 2,
        fixed_with: 0,
    };
    let cell = Groups {
        member_of: 2,
        pairs_with: 3,
        fixed_with: 0,
    };
    let mut fed = Fed::new();
    let r: Vec<BodyId> = (0..3)
        .map(|_| fed.broad.insert(&cube, BodyOptions::default().groups(robot)).unwrap())
        .collect();
    let c: Vec<BodyId> = (0..3)
        .map(|_| {
            fed.broad
                .insert(&cube, BodyOptions::default().fixed(true).groups(cell))
                .unwrap()
        })
        .collect();
    fed.step();
    assert_eq!(fed.broad.pair_count(), 9);
    assert_eq!(fed.broad.pairs_between(2, 1).count(), 9);
    assert_eq!(fed.broad.pairs_between(1, 1).count(), 0);

    fed.broad.set_groups(r[0], cell).unwrap();
    fed.step();
    // The changed body now also pairs with the two other robots, and still with the three cells.
    assert_eq!(fed.broad.pair_count(), 6 + 3 + 2);

    // Two fixed bodies pair if both say so, and until one no longer does.
    let open = Groups { fixed_with: 2, ..cell };
    for (body, groups, pairs) in [(c[1], open, 0), (c[2], open, 1), (c[1], cell, 0), (c[1], open, 1)] {
        fed.broad.set_groups(body, groups).unwrap();
        fed.step();
        assert_eq!(fed.broad.pair_count(), 11 + pairs);
    }

    let never = |broad: &mut SweepAndPrune| {
        broad.regroup(c[0]).unwrap();
        let ended = broad.step_with(&mut |a, b| a != c[0] && b != c[0]).ended.len();
        (ended, broad.pair_count())
    };
    assert_eq!(never(&mut fed.broad), (3, 9));
}

#[test]
fn ids_and_slots_carry_generations() {
    let cube = Aabb::from_center(Point3::origin(), Vector3::repeat(0.5));
    let mut fed = Fed::new();
    let a = fed.broad.insert(&cube, BodyOptions::default()).unwrap();
    let b = fed.broad.insert(&cube, BodyOptions::default()).unwrap();
    fed.step();
    let first = fed.broad.pair(a, b).unwrap();
    fed.broad.remove(b).unwrap();
    let same_step = fed.broad.insert(&cube, BodyOptions::default()).unwrap();
    assert_ne!(same_step.index, b.index, "an index rests until its pairs are reported");
    fed.step();
    let c = fed.broad.insert(&cube, BodyOptions::default()).unwrap();
    assert_eq!((c.index, c.generation), (b.index, b.generation + 2));
    fed.step();
    assert!(!fed.broad.contains(b) && fed.broad.pair_of(first.id).is_none());
    assert_eq!(fed.broad.pair(a, b), None);
    let slots: BTreeSet<u32> = fed.broad.pairs().map(|p| p.id.slot).collect();
    assert_eq!(slots, BTreeSet::from([0, 1, 2]), "slots are reused");
}

#[test]
fn permuted_ids_change_only_names() {
    let mut scene = Scene::new(Kind::Pile, 300);
    let n = scene.boxes.len();
    let name = |i: usize| (i * 7 + 3) % n;
    let mut plain = SweepAndPrune::new();
    let mut other = SweepAndPrune::new();
    let ids: Vec<BodyId> = scene
        .boxes
        .iter()
        .map(|b| plain.insert(b, BodyOptions::default()).unwrap())
        .collect();
    let mut inverse = vec![0; n];
    (0..n).for_each(|i| inverse[name(i)] = i);
    let others: Vec<BodyId> = (0..n)
        .map(|k| other.insert(&scene.boxes[inverse[k]], BodyOptions::default()).unwrap())
        .collect();
    for _ in 0..30 {
        let keys = |pairs: &[Pair], of: &dyn Fn(BodyId) -> usize| -> BTreeSet<(usize, usize)> {
            pairs
                .iter()
                .map(|p| (of(p.a).min(of(p.b)), of(p.a).max(of(p.b))))
                .collect()
        };
        let renamed = |id: BodyId| inverse[id.index as usize];
        let same = |id: BodyId| id.index as usize;
        let (events, renamed_events) = (plain.step(), other.step());
        assert_eq!(keys(events.began, &same), keys(renamed_events.began, &renamed));
        assert_eq!(keys(events.ended, &same), keys(renamed_events.ended, &renamed));
        scene.step();
        for (i, aabb) in scene.boxes.iter().enumerate() {
            plain.set_box(ids[i], aabb).unwrap();
            other.set_box(others[name(i)], aabb).unwrap();
        }
    }
}
