//! Promise: a scene finds what brute force over all pairs finds, on every frame, for all queries
//! and all cost savings.

use crate::{ALL, Keys, NONE, Replay};
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene};
use lin_canny::{ContactState, ConvexPolyhedron, ManifoldOptions, RelativePose, Tracker};
use std::collections::BTreeMap;
use std::sync::Arc;
use truth::crowd::{Crowd, Kind};

/// A crowd in a scene.
struct Play {
    crowd: Crowd,
    scene: Scene,
    ids: Vec<BodyId>,
}

impl Play {
    fn new(kind: Kind, n: usize, queries: PairQueries) -> Self {
        Self::in_groups(
            kind,
            n,
            |_| Body::moving,
            |_| ALL,
            |scene| scene.set_queries(ALL, ALL, queries).unwrap(),
        )
    }

    fn in_groups(
        kind: Kind,
        n: usize,
        make: impl Fn(usize) -> fn(Arc<ConvexPolyhedron>) -> Body,
        group: impl Fn(usize) -> Group,
        call: impl FnOnce(&mut Scene),
    ) -> Self {
        let crowd = Crowd::new(kind, n, 20);
        let shapes = crowd.hulls();
        let mut scene = Scene::new();
        call(&mut scene);
        let ids = (0..n)
            .map(|i| {
                let body = make(i)(shapes[crowd.shape_of[i]].clone()).group(group(i));
                scene.insert(body, crowd.poses[i].isometry()).unwrap()
            })
            .collect();
        Self { crowd, scene, ids }
    }

    /// Advances the crowd by one frame, for bodies that exist.
    fn step(&mut self) {
        self.crowd.step();
        for (id, pose) in self.ids.iter().zip(&self.crowd.poses) {
            let _ = self.scene.set_pose(*id, pose.isometry());
        }
        self.scene.step();
    }
}

/// Bounds of the distance of each pair.
type Intervals = BTreeMap<(BodyId, BodyId), (f64, f64)>;

/// Returns the pairs that share a point, the pairs within `d`, and the distances, of all existing
/// bodies.
fn truth(scene: &Scene, d: f64, trackers: &mut BTreeMap<(BodyId, BodyId), Tracker>) -> (Keys, Keys, Intervals) {
    let ids: Vec<BodyId> = scene.bodies().collect();
    let (mut overlapping, mut within, mut distances) = (Keys::new(), Keys::new(), BTreeMap::new());
    for (k, &a) in ids.iter().enumerate() {
        for &b in &ids[k + 1..] {
            let pose = RelativePose::new(scene.pose(a).unwrap(), scene.pose(b).unwrap()).unwrap();
            let x = scene.geometry(a).and_then(|s| s.as_polyhedron()).unwrap();
            let y = scene.geometry(b).and_then(|s| s.as_polyhedron()).unwrap();
            let tracker = trackers.entry((a, b)).or_default();
            let outcome = tracker.closest(x, y, &pose);
            distances.insert((a, b), (outcome.lower, outcome.upper));
            if tracker.intersects(x, y, &pose) {
                overlapping.insert((a, b));
            }
            if tracker.within(x, y, &pose, d) {
                within.insert((a, b));
            }
        }
    }
    (overlapping, within, distances)
}

const D: f64 = 0.15;

/// Returns growing sets, except that the third and fourth are both parts of the fifth.
fn ladder() -> [PairQueries; 9] {
    [
        NONE,
        NONE.boxes(true),
        NONE.overlap(true),
        NONE.within(D),
        NONE.overlap(true).within(D).boxes(true),
        NONE.overlap(true).within(D).distance(0.3),
        NONE.overlap(true).within(D).distance(0.3).features(true),
        NONE.overlap(true)
            .within(D)
            .distance(0.3)
            .features(true)
            .depth(true)
            .boxes(true),
        NONE.overlap(true)
            .within(D)
            .distance(0.3)
            .features(true)
            .depth(true)
            .boxes(true)
            .manifold(ManifoldOptions::default().prediction(D)),
    ]
}

const KINDS: [Kind; 3] = [Kind::Sparse, Kind::Pile, Kind::Gas { fill: 0.05, rate: 10.0 }];

#[test]
fn every_rung_equals_brute_force_on_every_frame() {
    let mut seen = [0usize; 3];
    for kind in KINDS {
        let mut plays: Vec<Play> = ladder().iter().map(|e| Play::new(kind, 40, *e)).collect();
        let mut replays: Vec<Replay> = ladder().iter().map(|_| Replay::default()).collect();
        let mut trackers = BTreeMap::new();
        for _ in 0..60 {
            plays.iter_mut().for_each(Play::step);
            let (overlapping, within, distances) = truth(&plays[0].scene, D, &mut trackers);
            seen[0] += overlapping.len();
            seen[1] += within.len();
            for ((play, replay), queries) in plays.iter().zip(&mut replays).zip(&ladder()) {
                replay.apply(play.scene.events());
                let called = |keys: &Keys, on: bool| if on { keys.clone() } else { Keys::new() };
                assert_eq!(replay.overlapping, called(&overlapping, queries.overlap), "{queries:?}");
                assert_eq!(replay.within, called(&within, queries.within.is_some()), "{queries:?}");
                seen[2] += check_answers(&play.scene, queries, &distances, &replay.overlapping, &replay.within);
            }
        }
    }
    assert!(seen[0] > 500 && seen[1] > 1000 && seen[2] > 3000, "{seen:?}");
}

/// Checks the results by pair and by body; returns the number of distances checked.
fn check_answers(
    scene: &Scene,
    queries: &PairQueries,
    distances: &BTreeMap<(BodyId, BodyId), (f64, f64)>,
    overlapping: &Keys,
    within: &Keys,
) -> usize {
    let mut measured = Keys::new();
    for p in scene.pairs() {
        let key = (p.a, p.b);
        assert_eq!(p.overlaps, queries.overlap.then(|| overlapping.contains(&key)));
        assert_eq!(p.within, queries.within.map(|_| within.contains(&key)));
        assert_eq!(p.outcome.is_some(), queries.features && p.distance.is_some());
        assert_eq!(scene.pair(p.b, p.a).map(|q| q.pair), Some(p.pair));
        let touches = |(lower, _): &(f64, f64)| queries.manifold.is_some() && *lower <= D;
        assert_eq!(p.manifold.is_some(), touches(&distances[&key]));
        if let Some((manifold, outcome)) = p.manifold.zip(p.outcome) {
            let deepest = manifold.deepest().expect("within the prediction");
            assert!(!manifold.is_fresh() || (deepest.separation - outcome.distance).abs() < 1e-9);
        }
        if let Some(d) = p.distance {
            measured.insert(key);
            let (lower, upper) = distances[&key];
            if queries.depth || d.state != ContactState::Overlapping {
                assert!(d.lower <= upper && lower <= d.upper, "{d:?} {lower} {upper}");
            } else {
                assert!(d.value == 0.0 && upper <= 0.0);
            }
        }
    }
    for id in scene.bodies() {
        let of: Vec<_> = scene.pairs_of(id).unwrap().iter().map(|p| p.pair).collect();
        let mut all: Vec<_> = scene.pairs().filter(|p| p.a == id || p.b == id).collect();
        all.sort_by_key(|p| (p.a, p.b));
        assert_eq!(of, all.iter().map(|p| p.pair).collect::<Vec<_>>());
    }
    let range = queries.distance.unwrap_or(f64::NEG_INFINITY);
    let near = distances
        .iter()
        .filter(|(_, (lower, _))| *lower <= range)
        .map(|(k, _)| *k);
    assert_eq!(measured, near.collect());
    measured.len()
}

#[test]
fn an_infinite_range_means_all_pairs_of_two_groups() {
    let (a, b) = (Group::new(3).unwrap(), Group::new(9).unwrap());
    let everywhere = NONE.distance(f64::INFINITY).overlap(true);
    let mut play = Play::in_groups(
        Kind::Sparse,
        30,
        |i| if i % 3 == 0 { Body::fixed } else { Body::moving },
        |i| if i % 2 == 0 { a } else { b },
        |scene| scene.set_queries(a, b, everywhere).unwrap(),
    );
    let mut trackers = BTreeMap::new();
    for _ in 0..10 {
        play.step();
        let (_, _, distances) = truth(&play.scene, D, &mut trackers);
        let mut found = 0;
        for p in play.scene.pairs() {
            let d = p.distance.expect("is taken");
            let (lower, upper) = distances[&(p.a, p.b)];
            assert!(d.state == ContactState::Overlapping || d.lower <= upper && lower <= d.upper);
            found += 1;
        }
        // 15 by 15, less the pairs of two fixed bodies: 5 by 5.
        assert_eq!(found, 15 * 15 - 25);
    }
    // Back to boxes and out again: overlaps continue without an event.
    let near = NONE.overlap(true);
    let mut replay = Replay::default();
    for k in 0..30 {
        play.scene
            .set_queries(a, b, if k % 3 == 0 { near } else { everywhere })
            .unwrap();
        play.step();
        if k == 0 {
            replay.overlapping = play
                .scene
                .pairs()
                .filter(|p| p.overlaps == Some(true))
                .map(|p| (p.a, p.b))
                .collect();
            continue;
        }
        replay.apply(play.scene.events());
        let found: Keys = play
            .scene
            .pairs()
            .filter(|p| p.overlaps == Some(true))
            .map(|p| (p.a, p.b))
            .collect();
        assert_eq!(replay.overlapping, found);
    }
}

#[test]
fn budget_on_and_off_give_the_same_events_and_answers() {
    for kind in KINDS {
        for queries in ladder() {
            let (mut on, mut off) = (Play::new(kind, 120, queries), Play::new(kind, 120, queries));
            off.scene.set_budget(false);
            let (mut saved, mut events) = (0, 0);
            for _ in 0..80 {
                on.step();
                off.step();
                assert_eq!(on.scene.events(), off.scene.events());
                assert_eq!(off.scene.report().counts.skipped, 0);
                saved += on.scene.report().counts.skipped;
                events += on.scene.events().len();
                for (p, q) in on.scene.pairs().zip(off.scene.pairs()) {
                    assert_eq!((p.pair, p.overlaps, p.within), (q.pair, q.overlaps, q.within));
                    match (p.distance, q.distance) {
                        (Some(p), Some(q)) => assert!(p.state == q.state && p.lower <= q.upper && q.lower <= p.upper),
                        (p, q) => assert_eq!(p, q),
                    }
                }
            }
            let predicates = queries.overlap || queries.within.is_some();
            assert!(
                !predicates || (saved > 50 && events > 20),
                "{kind:?} {queries:?} {saved} {events}"
            );
        }
    }
}

#[test]
fn dropping_an_effect_never_raises_a_work_counter() {
    for kind in KINDS {
        let totals = ladder().map(|queries| {
            let mut play = Play::new(kind, 300, queries);
            let mut total = lin_canny::scene::StepWork::default();
            for _ in 0..60 {
                play.step();
                total += play.scene.report().counts;
            }
            total
        });
        for (queries, t) in ladder().iter().zip(&totals) {
            println!("{kind:?} {queries:?}: {t:?}");
        }
        // Work of disabled queries is exactly zero.
        for t in &totals[..2] {
            assert_eq!(
                (t.active, t.queries, t.walked, t.certificates, t.depths),
                (0, 0, 0, 0, 0)
            );
        }
        assert_eq!(totals[0].boxes + totals[0].pairs, 0);
        assert!(totals[1].pairs > 0);
        for (queries, t) in ladder().iter().zip(&totals) {
            assert_eq!(t.overlaps > 0, queries.overlap);
            assert_eq!(t.withins > 0, queries.within.is_some());
            assert_eq!(t.distances > 0, queries.distance.is_some());
            assert_eq!(t.features > 0, queries.features);
            assert_eq!(t.depths > 0, queries.depth);
            assert_eq!(t.manifolds > 0, queries.manifold.is_some());
            assert_eq!(t.renewed > 0, queries.manifold.is_some());
        }
        // Each is a part of a later one: see the ladder.
        for (less, more) in [(0, 1), (1, 4), (2, 4), (3, 4), (4, 5), (5, 6), (6, 7), (7, 8)] {
            let (l, m) = (&totals[less], &totals[more]);
            let work =
                |t: &lin_canny::scene::StepWork| [t.boxes, t.queries, t.walked, t.certificates, t.depths, t.manifolds];
            for (x, y) in work(l).into_iter().zip(work(m)) {
                assert!(x <= y, "{kind:?}: {less} {:?} above {more} {:?}", work(l), work(m));
            }
        }
    }
}

#[test]
fn a_scene_at_rest_does_nothing() {
    let mut play = Play::new(Kind::Pile, 100, ladder()[7]);
    play.step();
    let pairs = play.scene.pair_count();
    for _ in 0..3 {
        let report = *play.scene.step();
        assert!(play.scene.events().is_empty() && play.scene.pair_count() == pairs && pairs > 20);
        let c = report.counts;
        assert_eq!((c.boxes, c.active, c.queries, c.pairs), (0, 0, 0, pairs as u64));
        assert_eq!(report.times.total(), std::time::Duration::ZERO);
    }
    // One body moves: only its pairs are queried.
    let id = play.ids[7];
    let of = play.scene.pairs_of(id).unwrap().len();
    let mut pose = *play.scene.pose(id).unwrap();
    pose.translation.x += 1e-9;
    play.scene.set_pose(id, pose).unwrap();
    let c = play.scene.step().counts;
    assert_eq!((c.boxes, c.resting), (1, (pairs - of) as u64));
    assert!(c.queries + c.balls + c.skipped == of as u64 && of > 0);
}

/// The purpose of the budget: 2 % density, 60 Hz.
#[test]
fn most_separated_pairs_are_answered_by_the_budget() {
    let kind = Kind::Gas { fill: 0.02, rate: 60.0 };
    for queries in [ladder()[2], ladder()[3]] {
        let mut play = Play::new(kind, 400, queries);
        let (mut skipped, mut asked) = (0, 0);
        for step in 0..400 {
            play.step();
            let c = play.scene.report().counts;
            if step >= 60 {
                // Overlapping pairs cost a query in every step.
                skipped += c.skipped;
                asked += c.separated + c.balls; // two balls are no query, but no budget either
            }
        }
        let share = skipped as f64 / (skipped + asked) as f64;
        println!(
            "{queries:?}: {skipped} of {} separated pairs, {share:.3}",
            skipped + asked
        );
        assert!(share > 0.6, "{share}");
    }
}

/// A local depth in a scene bounds the depth, under contacts too, and neither query changes the
/// overlaps.
#[test]
fn local_depths_bound_the_depths() {
    let near = NONE.distance(0.3).features(true);
    let mut options = ManifoldOptions::default().prediction(D);
    options.local_depth = true;
    let asked = [
        near.depth(true),
        near.local_depth(true),
        near.manifold(options),
        // A request for the depth returns the depth.
        near.manifold(options).depth(true),
        near.manifold(ManifoldOptions::default().prediction(D))
            .local_depth(true),
    ];
    let (mut overlaps, mut wide) = (0, [0; 5]);
    let mut plays = asked.map(|queries| Play::new(Kind::Pile, 60, queries));
    for _ in 0..60 {
        plays.iter_mut().for_each(Play::step);
        let [deep, others @ ..] = &plays;
        for pair in deep.scene.pairs() {
            let depth = pair.outcome;
            for (k, other) in others.iter().enumerate() {
                let outcome = other.scene.pair(pair.a, pair.b).and_then(|p| p.outcome);
                let found = outcome.map(|o| o.state);
                assert_eq!(found, depth.map(|o| o.state), "{outcome:?} {depth:?}");
                let (Some(o), Some(d)) = (outcome, depth) else { continue };
                assert!(o.lower <= d.upper && d.lower <= o.upper, "{o:?} {d:?}");
                overlaps += usize::from(o.state == ContactState::Overlapping);
                wide[k + 1] += usize::from(o.upper - o.lower > 1e-12);
            }
        }
    }
    let [_, local, contacts, both, proven] = wide;
    assert!(
        overlaps > 2000 && local > 100 && contacts > 100 && both + proven == 0,
        "{overlaps} {wide:?}"
    );
}
