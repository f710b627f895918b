//! Promise: pairs of bodies with velocities are queried when a proof expires and no earlier, with
//! the same events; no body passes through another if impacts are enabled.

use crate::{ALL, NONE, read_back};
use lin_canny::impact::{Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Event, PairQueries, Scene, SceneError, StepWork};
use lin_canny::schedule::Schedule;
use lin_canny::{Compound, Geometry, Mesh, PairTracker, Piece, RelativePose, Shape, Velocity};
use std::collections::BTreeMap;
use std::sync::Arc;
use truth::forms::shapes;
use truth::rng::Rng;

/// Policy that selects the queried pairs of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Policy {
    /// Every pair of boxes, in every step.
    Boxes,
    Budget,
    Schedule,
    /// The schedule, and impacts.
    Continuous,
}

/// Hulls of 32 vertices in a box with walls, with speeds to 8 and spins to 6, bouncing off each
/// other.
struct Gas {
    scene: Scene,
    ids: Vec<BodyId>,
    half: f64,
    tick: f64,
    counts: StepWork,
    events: Vec<Event>,
}

impl Gas {
    fn new(n: usize, fill: f64, tick: f64, policy: Policy) -> Self {
        let mut rng = Rng::new(19);
        let mut scene = Scene::new();
        let mut queries = NONE.overlap(true);
        queries.impact = (policy == Policy::Continuous).then_some(Tolerance::Distance(1e-6));
        scene.set_queries(ALL, ALL, queries).unwrap();
        scene.set_budget(policy != Policy::Boxes);
        scene.set_schedule(matches!(policy, Policy::Schedule | Policy::Continuous));
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        let half = 0.5 * (n as f64 * ball / fill).cbrt();
        let shapes: Vec<_> = (0..8)
            .map(|seed| Arc::new(solids::random_hull(32, Vector3::repeat(1.0), seed + 1).unwrap()))
            .collect();
        let ids = (0..n)
            .map(|k| {
                let at = Vector3::from_fn(|_, _| rng.range(-half, half));
                let pose = Isometry3::new(at, Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
                let id = scene.insert(Body::moving(shapes[k % 8].clone()), pose).unwrap();
                let linear = Vector3::from(rng.in_ball()) * 8.0;
                let spin = Vector3::from(rng.in_ball()) * 6.0;
                scene.set_velocity(id, Velocity::new(linear, spin)).unwrap();
                id
            })
            .collect();
        let (counts, events) = (StepWork::default(), Vec::new());
        Self {
            scene,
            ids,
            half,
            tick,
            counts,
            events,
        }
    }

    fn step(&mut self) {
        for &id in &self.ids {
            let at = self.scene.pose(id).unwrap().translation.vector;
            let mut v = self.scene.velocity(id).unwrap();
            for k in 0..3 {
                if at[k].abs() > self.half && at[k] * v.linear[k] > 0.0 {
                    v.linear[k] = -v.linear[k];
                }
            }
            self.scene.set_velocity(id, v).unwrap();
        }
        self.scene.advance(self.tick).unwrap();
        self.scene.step();
        self.counts += self.scene.report().counts;
        let events = self.scene.events().to_vec();
        for e in events.iter().filter(|e| e.change == Change::OverlapBegan) {
            self.bounce(e);
        }
        self.events.extend(
            events
                .iter()
                .filter(|e| !matches!(e.change, Change::BoxesMet | Change::BoxesParted)),
        );
    }

    /// Exchanges the velocities along the line of centres if the bodies approach.
    fn bounce(&mut self, e: &Event) {
        let place = |id| self.scene.pose(id).unwrap().translation.vector;
        let (mut x, mut y) = (self.scene.velocity(e.a).unwrap(), self.scene.velocity(e.b).unwrap());
        let n = (place(e.b) - place(e.a)).normalize();
        let push = n * (y.linear - x.linear).dot(&n).min(0.0);
        x.linear += push;
        y.linear -= push;
        self.scene.set_velocity(e.a, x).unwrap();
        self.scene.set_velocity(e.b, y).unwrap();
    }
}

/// Returns events as a user sees them: ids of pairs depend on the boxes, which impacts enlarge.
fn seen(events: &[Event]) -> Vec<(BodyId, BodyId, Change)> {
    events.iter().map(|e| (e.a, e.b, e.change)).collect()
}

#[test]
fn looks_at_separated_pairs_follow_proofs_with_the_same_events() {
    for (n, fill, rate, steps, most) in [
        (1000, 0.02, 60.0, 240, 0.3),
        (1000, 0.02, 600.0, 600, 0.05),
        (400, 0.15, 60.0, 60, 0.3),
    ] {
        let policies = [Policy::Boxes, Policy::Budget, Policy::Schedule, Policy::Continuous];
        let mut plays = policies.map(|policy| Gas::new(n, fill, 1.0 / rate, policy));
        for _ in 0..steps {
            plays.iter_mut().for_each(Gas::step);
        }
        println!("{n} bodies, {fill} full, {rate} Hz, {steps} steps; a step:");
        for (play, policy) in plays.iter().zip(policies) {
            let c = &play.counts;
            let each = |count: u64| count as f64 / f64::from(steps);
            println!(
                "  {:<10} separated {:7.2} (and {:6.2} by balls), queries {:7.2}, slept {:7.1}, skipped {:7.1}, ahead {:6.2}, casts {:6.2}, impacts {:5.2}",
                format!("{policy:?}"),
                each(c.separated),
                each(c.balls),
                each(c.queries),
                each(c.slept),
                each(c.skipped),
                each(c.ahead),
                each(c.casts),
                each(c.impacts)
            );
        }
        let [boxes, budget, schedule, continuous] = &plays;
        assert!(boxes.events.len() > 100, "{} events", boxes.events.len());
        assert_eq!(boxes.events, budget.events);
        assert_eq!(boxes.events, schedule.events);
        assert_eq!(seen(&boxes.events), seen(&continuous.events));
        // Detection by boxes alone queries every pair of boxes; here two balls decide some of
        // these.
        let pairs_apart = boxes.counts.separated + boxes.counts.balls;
        let ratio = schedule.counts.separated as f64 / pairs_apart as f64;
        let all = continuous.counts.queries as f64 / (boxes.counts.queries + boxes.counts.balls) as f64;
        println!(
            "  looks at pairs apart of box-gated: {ratio:.3}; queries of continuous over discrete box-gated: {all:.3}"
        );
        assert!(ratio <= most, "{ratio} of the looks at separated pairs");
        assert!(all < 1.0, "{all} of the queries");
        assert_eq!(schedule.counts.casts, 0);
        assert_eq!(schedule.counts.impacts, 0);
        assert_eq!(budget.counts.ahead, 0);
        assert!(continuous.counts.impacts > 0);
    }
}

/// A flying body: its id, and its shape as posed convex pieces.
struct Flyer {
    id: BodyId,
    pieces: Vec<(Shape, Isometry3<f64>)>,
}

fn pieces_of(shape: &Geometry, compound: &Compound) -> Vec<(Shape, Isometry3<f64>)> {
    match shape.as_convex() {
        Some(shape) => vec![(shape.into_owned(), Isometry3::identity())],
        None => compound.pieces().iter().map(|p| (p.shape.clone(), p.pose)).collect(),
    }
}

fn thin(k: usize, rng: &mut Rng) -> (Geometry, Compound) {
    let plate = solids::cuboid(Vector3::new(0.01, 0.8, 0.8)).unwrap();
    let rod = solids::cuboid(Vector3::new(0.02, 0.02, 1.0)).unwrap();
    let mut upright = Piece::new(rod.clone());
    upright.pose = Isometry3::new(Vector3::new(0.0, 0.5, 0.0), Vector3::x() * 1.5);
    let cross = Compound::new(vec![Piece::new(rod.clone()), upright]).unwrap();
    let only = |body: &lin_canny::ConvexPolyhedron| Compound::new(vec![Piece::new(body.clone())]).unwrap();
    match k % 4 {
        0 => (plate.clone().into(), only(&plate)),
        1 => (cross.clone().into(), cross),
        2 => (Mesh::from_convex(&plate).unwrap().into(), only(&plate)),
        _ => {
            let hull = solids::random_hull(12, Vector3::repeat(rng.range(0.05, 0.4)), k as u64 + 1).unwrap();
            (hull.clone().into(), only(&hull))
        }
    }
}

/// Instants of a tick at which all pairs are tested.
const INSTANTS: usize = 40;

/// Pairs that met, pairs that meet at samples, and pairs that passed through each other and are
/// separated at both ends.
#[derive(Debug, Default)]
struct Mix {
    impacts: usize,
    sampled: usize,
    through: usize,
    grazed: usize,
}

fn intersects(x: &Flyer, y: &Flyer, at: &Isometry3<f64>, on: &Isometry3<f64>) -> bool {
    x.pieces.iter().any(|(a, i)| {
        y.pieces.iter().any(|(b, j)| {
            let pose = RelativePose::new(&(at * i), &(on * j)).unwrap();
            PairTracker::new().intersects(a, b, &pose)
        })
    })
}

/// Compares the impacts of the last tick with samples of its motions.
fn check_tick(scene: &Scene, flyers: &[Flyer], motions: &BTreeMap<BodyId, Steady>, tick: f64, mix: &mut Mix) {
    assert!(scene.impacts().is_sorted_by(|x, y| x.safe() <= y.safe()));
    let found: BTreeMap<_, _> = scene.impacts().iter().map(|i| ((i.a, i.b), i)).collect();
    assert_eq!(found.len(), scene.impacts().len(), "a pair meets once");
    for (k, x) in flyers.iter().enumerate() {
        for y in &flyers[k + 1..] {
            let at = |t: f64| (motions[&x.id].pose(t), motions[&y.id].pose(t));
            let meets = |t: f64| {
                let (on_x, on_y) = at(t);
                intersects(x, y, &on_x, &on_y)
            };
            let impact = found.get(&(x.id.min(y.id), x.id.max(y.id)));
            if meets(0.0) {
                assert!(impact.is_none(), "apart before the tick: {impact:?}");
                continue;
            }
            let first = (1..=INSTANTS)
                .map(|i| tick * i as f64 / INSTANTS as f64)
                .find(|t| meets(*t));
            mix.sampled += usize::from(first.is_some());
            mix.through += usize::from(first.is_some() && !meets(tick));
            match impact.map(|i| i.impact) {
                None => assert_eq!(first, None, "missed: {} and {}", x.id, y.id),
                Some(Impact::Hit { safe, hit, .. }) => {
                    mix.impacts += 1;
                    assert!(safe < hit, "{safe} {hit} {first:?}");
                    assert!(hit <= tick, "{safe} {hit} {first:?}");
                    assert!(first.is_none_or(|t| safe < t), "{safe} {hit} {first:?}");
                    assert!(!meets(safe) && meets(hit), "{safe} {hit}");
                }
                Some(Impact::Undecided { safe, .. }) => {
                    mix.grazed += 1;
                    assert!(first.is_none_or(|t| safe < t));
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

fn fly(shapes: Vec<(Geometry, Compound)>, queries: PairQueries, seed: u64) -> Mix {
    let mut rng = Rng::new(seed);
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, queries).unwrap();
    let flyers: Vec<Flyer> = shapes
        .into_iter()
        .map(|(shape, compound)| {
            let pieces = pieces_of(&shape, &compound);
            let id = scene.insert(Body::moving(shape), Isometry3::identity()).unwrap();
            Flyer { id, pieces }
        })
        .collect();
    let tick = 1.0 / 60.0;
    let mut mix = Mix::default();
    for round in 0..24 {
        for flyer in &flyers {
            // At random, a body keeps its motion, is thrown again, or jumps.
            if round % 6 == 0 || rng.chance(0.2) {
                let at = Vector3::from(rng.in_ball()) * 4.0;
                let aim = (Vector3::from(rng.in_ball()) * 2.0 - at) * rng.log_range(1.0, 100.0);
                let spin = Vector3::from(rng.unit()) * rng.log_range(1.0, 100.0);
                scene
                    .set_pose(flyer.id, Isometry3::new(at, Vector3::from(rng.unit())))
                    .unwrap();
                scene.set_velocity(flyer.id, Velocity::new(aim, spin)).unwrap();
            }
        }
        let motion = |f: &Flyer| {
            (
                f.id,
                Steady::new(scene.pose(f.id).unwrap(), scene.velocity(f.id).unwrap()).unwrap(),
            )
        };
        let motions = flyers.iter().map(motion).collect();
        scene.advance(tick).unwrap();
        if round % 5 == 4 {
            // A jump after the tick is not part of its motion.
            scene
                .set_pose(flyers[0].id, Isometry3::translation(0.0, 0.0, 9.0))
                .unwrap();
        }
        scene.step();
        check_tick(&scene, &flyers, &motions, tick, &mut mix);
    }
    mix
}

#[test]
fn nothing_passes_through_unseen() {
    let impact = NONE.impact(Tolerance::Distance(1e-7));
    let other = Compound::new(vec![Piece::new(solids::octahedron(1.0).unwrap())]).unwrap();
    let (mut impacts, mut grazed) = (0, 0);
    for seed in 0..6 {
        let queries = impact.overlap(seed % 2 == 0);
        let mut rng = Rng::new(seed);
        let solid = fly((0..10).map(|k| thin(k, &mut rng)).collect(), queries, seed);
        let curved = fly(
            shapes([0.8, 0.5, 0.03])
                .into_iter()
                .chain([Shape::cuboid(Vector3::new(0.01, 0.8, 0.8)).unwrap()])
                .map(|shape| (shape.into(), other.clone()))
                .collect(),
            queries,
            seed + 50,
        );
        println!("{solid:?} {curved:?}");
        for mix in [&solid, &curved] {
            assert!(mix.impacts > 5, "{mix:?}");
            assert!(mix.through > 3, "{mix:?}");
            assert!(mix.impacts + mix.grazed >= mix.sampled, "{mix:?}");
            impacts += mix.impacts;
            grazed += mix.grazed;
        }
    }
    assert!(impacts > 200, "{impacts} impacts, {grazed} grazed");
    assert!(grazed * 50 <= impacts, "{impacts} impacts, {grazed} grazed");
}

/// The same random calls to scenes with different policies.
#[test]
fn schedules_survive_every_kind_of_disturbance() {
    let (mut events, mut slept) = (0, 0);
    for seed in 0..30 {
        let mut rng = Rng::new(seed);
        let shape = Arc::new(solids::random_hull(16, Vector3::new(1.0, 0.6, 0.3), seed + 1).unwrap());
        let mut scenes: Vec<Scene> = (0..3).map(|_| Scene::new()).collect();
        let queries = NONE.overlap(true).within(0.2);
        for (k, scene) in scenes.iter_mut().enumerate() {
            scene.set_queries(ALL, ALL, queries).unwrap();
            scene.set_schedule(k != 0);
            scene.set_budget(k != 0);
        }
        let mut ids: Vec<BodyId> = Vec::new();
        let mut tick = 1.0 / 60.0;
        for round in 0..200 {
            let (pick, call) = (rng.below(12), rng.below(40));
            let at = Isometry3::new(Vector3::from(rng.in_ball()) * 4.0, Vector3::from(rng.unit()));
            let v = Velocity::new(Vector3::from(rng.in_ball()) * 4.0, Vector3::from(rng.in_ball()) * 3.0);
            if rng.chance(0.05) {
                tick = rng.pick(&[1.0 / 60.0, 1.0 / 240.0, -1.0 / 60.0, 0.0]).to_owned();
            }
            let ticks = [1, 1, 1, 1, 0, 2][rng.below(6)];
            let mut all: Vec<Vec<Event>> = Vec::new();
            for (k, scene) in scenes.iter_mut().enumerate() {
                let id = ids.get(pick).copied();
                match (call, id) {
                    (0 | 1, Some(id)) => scene.set_pose(id, at).unwrap(),
                    (2 | 3, Some(id)) => scene.set_velocity(id, v).unwrap(),
                    (4, Some(id)) if ids.len() > 6 => scene.remove(id).unwrap(),
                    (5, Some(id)) => scene.set_velocity(id, Velocity::default()).unwrap(),
                    _ => {}
                }
                if call > 36 || round < 10 {
                    let id = scene.insert(Body::moving(shape.clone()), at).unwrap();
                    scene.set_velocity(id, v).unwrap();
                    if k == 2 {
                        ids.push(id);
                    }
                }
                for _ in 0..ticks {
                    scene.advance(tick).unwrap();
                }
                if let (6, Some(id)) = (call, id) {
                    scene.set_pose(id, at).unwrap();
                }
                scene.step();
                slept += scene.report().counts.slept;
                all.push(scene.events().to_vec());
            }
            if let (4, Some(id)) = (call, ids.get(pick).copied())
                && ids.len() > 6
                && scenes[0].pose(id).is_none()
            {
                ids.remove(pick);
            }
            assert_eq!(all[0], all[1], "seed {seed} round {round}");
            assert_eq!(all[1], all[2], "seed {seed} round {round}");
            // A scene that was read back sorts its lists again.
            let [one, mut other] = [1, 2].map(|k| scenes[k].report().counts);
            other.swaps = one.swaps;
            assert_eq!(one, other);
            events += all[0].len();
            if round % 20 == 10 {
                scenes[2] = read_back(&scenes[2]);
            }
        }
    }
    assert!(events > 300 && slept > 1500, "{events} events, {slept} slept");
}

#[test]
fn a_step_sees_one_tick_where_impacts_are_called_for() {
    let mut scene = Scene::new();
    scene.advance(1.0).unwrap();
    scene.advance(1.0).unwrap();
    scene
        .set_queries(ALL, ALL, NONE.impact(Tolerance::Distance(0.0)))
        .unwrap();
    assert_eq!(scene.advance(1.0), Err(SceneError::StepDue));
    scene.step();
    scene.advance(1.0).unwrap();
    assert_eq!(scene.advance(1.0), Err(SceneError::StepDue));
    let wrong = NONE.impact(Tolerance::Time(f64::NAN));
    assert!(matches!(
        scene.set_queries(ALL, ALL, wrong),
        Err(SceneError::Range { .. })
    ));
}

#[test]
fn the_last_tick_of_a_schedule_ends() {
    for slept in [None, Some(0), Some(1), Some(u64::MAX)] {
        let mut schedule = Schedule::new();
        for (a, b) in [(1, 2), (1, 3), (4, 5)] {
            schedule.insert(a, b);
        }
        for now in [7, u64::MAX - 1, u64::MAX, u64::MAX] {
            schedule.advance(now);
            let mut looks = 0;
            while let Some(due) = schedule.due() {
                looks += 1;
                assert!(looks <= 3, "a pair is due once a tick");
                if let Some(ticks) = slept {
                    schedule.sleep(&due, ticks);
                }
            }
            assert!(looks == 3 || slept == Some(u64::MAX) || schedule.now() == u64::MAX);
        }
        assert_eq!(schedule.next(), None);
        schedule.disturb(1);
        assert_eq!(schedule.next(), Some(u64::MAX));
        assert_eq!(std::iter::from_fn(|| schedule.due()).count(), 2);
    }
}

#[test]
fn no_answer_about_a_pair_that_was_removed_counts() {
    // The removed item, and whether bodies were disturbed before.
    for (k, disturbed) in [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)] {
        let mut schedule = Schedule::new();
        schedule.insert(1, 2);
        if disturbed {
            schedule.disturb(1);
            schedule.disturb(2);
        }
        let due = schedule.due().expect("a pair is due at once");
        match k {
            0 => schedule.remove_body(1),
            1 => schedule.remove_body(2),
            _ => assert!(schedule.remove(2, 1)),
        }
        schedule.sleep(&due, 9);
        assert_eq!(schedule.next(), None);
        schedule.insert(2, 1);
        schedule.sleep(&due, 9);
        assert_eq!(schedule.next(), Some(0), "{k} {disturbed}");
        let due = schedule.due().expect("a pair is due at once");
        schedule.sleep(&due, 9);
        assert_eq!(schedule.next(), Some(10), "{k} {disturbed}");
    }
}
