//! Worlds of bodies of every kind under sequences of calls from arbitrary bytes.
//!
//! After every call, the tables of the scene must be consistent. After every step, all results of
//! the scene must agree with brute force, for every method of selecting the queried pairs: budget,
//! schedule, threads, and a file read back between any two calls. Rays and searches are judged
//! after steps.
//!
//! The test `scene`, the target `scenes` of `fuzz/` and the instrument `soak` share this module.

mod judge;
mod searches;

use super::Bytes;
use crate::forms::{Form, forms};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene, SceneError, Settings};
use lin_canny::{Geometry, ManifoldOptions, Velocity};
use std::collections::{BTreeMap, BTreeSet};

type Keys = BTreeSet<(BodyId, BodyId)>;
type Motions = BTreeMap<BodyId, (Isometry3<f64>, Velocity)>;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Worlds played.
        pub worlds: u64,
        /// Steps judged.
        pub steps: u64,
        /// Ticks, and the ticks in which no body has a velocity.
        pub ticks: [u64; 2],
        /// Bodies moved by `set_pose` after the tick of the step.
        pub late: u64,
        /// Bodies that were given the index of a removed body.
        pub reused: u64,
        /// Scenes read back between a tick and its step, and at other times.
        pub saved: [u64; 2],
        /// Calls rejected.
        pub refused: u64,
        /// Overlapping pairs, by kind of world.
        pub overlapping: [u64; 4],
        /// Pairs within the distance of the query.
        pub within: u64,
        /// Distances, and the distances of overlaps.
        pub distances: [u64; 2],
        /// Events of overlaps and of `within`.
        pub events: u64,
        /// Pairs decided by sleep, and by the budget.
        pub slept: [u64; 2],
        /// Impacts without a distance, and with one.
        pub impacts: [u64; 2],
        /// Pairs of fixed bodies left out, and the overlapping ones of those tested.
        pub fixed: [u64; 2],
        /// Rays, rays that hit a body, and rays that hit a moved body without queries.
        pub rays: [u64; 3],
        /// Closest pairs that are separated and not the only pairs, pairs searched, and bodies reported
        /// as near.
        pub searches: [u64; 3],
    }
}

/// Largest number of calls of one world.
const CALLS: usize = 220;
const NONE: PairQueries = PairQueries::none();
const BRACKET: Tolerance = Tolerance::Distance(1e-6);
const DISTANCES: [f64; 4] = [0.0, 0.1, 0.5, 2.0];

impl Bytes<'_> {
    fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    fn chance(&mut self, percent: u8) -> bool {
        self.byte() % 100 < percent
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from([0; 3].map(|_| f64::from(self.byte() as i8) / 128.0 * size))
    }

    fn turn(&mut self) -> UnitQuaternion<f64> {
        let eighth = std::f64::consts::FRAC_PI_4;
        match self.below(4) {
            0 => UnitQuaternion::identity(),
            1 => UnitQuaternion::from_axis_angle(&Vector3::z_axis(), eighth * f64::from(self.byte() % 8)),
            _ => {
                let axis = self.vector(1.0);
                UnitQuaternion::new_normalize(Quaternion::from_parts(0.3 + self.vector(1.0).x.abs(), axis))
            }
        }
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let at = if self.chance(40) {
            // Bodies with equal coordinates touch.
            self.vector(2.0).map(|x| (x * 4.0).round() * 0.25)
        } else {
            self.vector(2.5)
        };
        Isometry3::from_parts(at.into(), self.turn())
    }

    fn velocity(&mut self) -> Velocity {
        let speed = [1e-3, 0.3, 0.3, 3.0, 60.0][self.below(5)];
        let spin = if self.chance(1) {
            1e120
        } else {
            [0.0, 0.2, 2.0, 50.0][self.below(4)]
        };
        Velocity::new(self.vector(speed), self.vector(spin))
    }

    fn queries(&mut self) -> PairQueries {
        let calls = u16::from(self.byte()) | u16::from(self.byte()) << 8;
        let d = DISTANCES[self.below(4)];
        let of = |bit: u16| calls & 1 << bit != 0;
        let rare = |bit: u16| of(bit) && of(bit + 1);
        let mut queries = PairQueries::none().boxes(of(0)).overlap(of(1) || of(2));
        queries.within = rare(3).then_some(0.1);
        queries.distance = rare(5).then_some(if of(4) { f64::INFINITY } else { d });
        queries.manifold = (rare(9) && of(4)).then_some(ManifoldOptions::default().prediction(d));
        queries.impact = of(11).then_some(BRACKET);
        queries.impact_within = rare(12).then_some((d, BRACKET));
        let queries = queries.features(rare(6)).depth(rare(7)).local_depth(rare(8));
        queries.fixed(of(14) && queries != NONE)
    }
}

/// One world in several scenes with the same input, each of which selects the queried pairs
/// differently.
struct World<C> {
    kind: usize,
    forms: Vec<(Geometry, Form)>,
    /// With budget and schedule; with neither; with threads; read back from a file occasionally.
    scenes: Vec<Scene>,
    copy: C,
    bodies: BTreeMap<BodyId, (usize, bool)>,
    /// Duration and motions of the tick of the step, if impacts were enabled.
    motions: Option<(f64, Motions)>,
    has_tick: bool,
    has_velocities: bool,
    length: f64,
    overlapping: Keys,
    within: Keys,
    boxes: Keys,
    /// Bodies that have moved since they were inserted.
    moved: BTreeSet<BodyId>,
    mix: Mix,
}

impl<C: Fn(&Scene) -> Scene> World<C> {
    fn new(bytes: &mut Bytes<'_>, copy: C) -> Self {
        let kind = bytes.below(4);
        let mut scenes: Vec<Scene> = (0..4).map(|_| Scene::new()).collect();
        scenes[1].set_budget(false);
        scenes[1].set_schedule(false);
        scenes[2] = Scene::with_settings(Settings::default().parallel_from(0));
        let mut world = Self {
            kind,
            forms: forms(kind),
            scenes,
            copy,
            bodies: BTreeMap::new(),
            motions: None,
            has_tick: false,
            has_velocities: bytes.chance(55),
            length: [1.0 / 60.0, 1.0 / 240.0, 0.5][bytes.below(3)],
            overlapping: Keys::new(),
            within: Keys::new(),
            boxes: Keys::new(),
            moved: BTreeSet::new(),
            mix: Mix::default(),
        };
        world.mix.worlds = 1;
        for (g, h) in [(0, 0), (0, 1), (1, 1)] {
            let mut events = NONE.overlap(true).fixed(bytes.chance(30));
            events.impact = (world.kind == 0).then_some(BRACKET);
            events.impact_within = (world.kind == 0 && bytes.chance(50)).then_some((0.1, BRACKET));
            let queries = if bytes.chance(40) { bytes.queries() } else { events };
            world.set_queries(g, h, queries);
        }
        world
    }

    /// Makes a call of every scene and asserts equal answers.
    fn each<T: PartialEq + std::fmt::Debug>(&mut self, mut call: impl FnMut(&mut Scene) -> T) -> T {
        let mut answers = self.scenes.iter_mut().map(&mut call);
        let first = answers.next().expect("there are scenes");
        answers.for_each(|other| assert_eq!(other, first));
        first
    }

    fn set_queries(&mut self, g: u8, h: u8, queries: PairQueries) {
        let [g, h] = [g, h].map(group);
        match self.each(|scene| scene.set_queries(g, h, queries)) {
            Ok(()) => {}
            Err(SceneError::Unanswered { .. }) => self.mix.refused += 1,
            Err(e) => panic!("{e}"),
        }
    }

    fn main(&self) -> &Scene {
        &self.scenes[0]
    }

    fn any(&self, bytes: &mut Bytes<'_>) -> Option<BodyId> {
        let k = bytes.below(self.bodies.len().max(1));
        self.bodies.keys().nth(k).copied()
    }

    fn call(&mut self, bytes: &mut Bytes<'_>) {
        if bytes.chance(15) {
            let read = (self.copy)(&self.scenes[3]);
            self.scenes[3] = read;
            self.mix.saved[usize::from(!self.has_tick)] += 1;
        }
        let Some(id) = self.any(bytes).filter(|_| self.bodies.len() > 3) else {
            return self.insert(bytes);
        };
        match bytes.byte() % 32 {
            0 if self.bodies.len() < self.most() => self.insert(bytes),
            1 => {
                self.each(|scene| scene.remove(id)).expect("the body lives");
                self.bodies.remove(&id);
            }
            2 if bytes.chance(1) => {
                for (g, h) in [(0, 0), (0, 1), (1, 1)] {
                    self.set_queries(g, h, NONE);
                }
            }
            2 if bytes.chance(30) => {
                let (g, h) = (bytes.byte() % 2, bytes.byte() % 2);
                let queries = if bytes.chance(20) { NONE } else { bytes.queries() };
                self.set_queries(g, h, queries);
            }
            3 if bytes.chance(30) => {
                let g = group(self.drawn_group(bytes));
                let done = self.each(|scene| scene.set_group(id, g));
                self.mix.refused += u64::from(done.is_err());
            }
            4 => self.switch(bytes),
            5 => {
                let (other, excluded) = (self.any(bytes).expect("there are bodies"), bytes.chance(50));
                let set = if excluded {
                    Scene::exclude_pair
                } else {
                    Scene::include_pair
                };
                self.each(|scene| set(scene, id, other)).expect("both live");
            }
            6..9 => {
                let pose = bytes.pose();
                self.put(id, pose);
            }
            9..11 => {
                // Onto another body, or next to it.
                let other = self.any(bytes).expect("there are bodies");
                let mut pose = *self.main().pose(other).expect("the body lives");
                pose.translation.vector += bytes.vector(1.2);
                self.put(id, pose);
            }
            11..14 => {
                let pose = *self.main().pose(id).expect("the body lives");
                let turn = UnitQuaternion::from_scaled_axis(bytes.vector(0.05)) * pose.rotation;
                let turn = UnitQuaternion::new_normalize(turn.into_inner());
                let at = pose.translation.vector + bytes.vector(0.05);
                self.put(id, Isometry3::from_parts(at.into(), turn));
            }
            14..17 => self.throw(id, bytes),
            17 => {
                let moving: Vec<_> = self.bodies.iter().filter(|b| !b.1.1).map(|b| *b.0).collect();
                for id in moving {
                    self.each(|scene| scene.set_velocity(id, Velocity::default()))
                        .expect("it moves");
                }
            }
            18..25 => self.advance(bytes),
            _ => self.step(),
        }
    }

    fn most(&self) -> usize {
        if self.kind < 2 { 10 } else { 6 }
    }

    fn insert(&mut self, bytes: &mut Bytes<'_>) {
        let k = bytes.below(self.forms.len());
        let fixed = bytes.chance(25);
        let g = group(self.drawn_group(bytes));
        let pose = bytes.pose();
        let shape = self.forms[k].0.clone();
        let body = if fixed { Body::fixed(shape) } else { Body::moving(shape) };
        let body = body.group(g);
        match self.each(|scene| scene.insert(body.clone(), pose)) {
            Ok(id) => {
                self.mix.reused += u64::from(id.generation > 1);
                self.bodies.insert(id, (k, fixed));
            }
            Err(SceneError::Unanswered { .. }) => self.mix.refused += 1,
            Err(e) => panic!("{e}"),
        }
    }

    /// Returns a group for a body: usually one with queries, occasionally the third, which never
    /// has any.
    fn drawn_group(&self, bytes: &mut Bytes<'_>) -> u8 {
        let byte = bytes.byte();
        if byte % 8 == 7 { 2 } else { byte % 2 }
    }

    fn switch(&mut self, bytes: &mut Bytes<'_>) {
        let (on, is_schedule) = (bytes.chance(70), bytes.chance(50));
        for k in [0, 2, 3] {
            if is_schedule {
                self.scenes[k].set_schedule(on);
            } else {
                self.scenes[k].set_budget(on);
            }
        }
    }

    fn put(&mut self, id: BodyId, pose: Isometry3<f64>) {
        self.each(|scene| scene.set_pose(id, pose)).expect("a sound pose");
        self.moved.insert(id);
        self.mix.late += u64::from(self.has_tick);
    }

    fn throw(&mut self, id: BodyId, bytes: &mut Bytes<'_>) {
        if self.has_velocities && !self.bodies[&id].1 {
            let velocity = if bytes.chance(30) {
                Velocity::default()
            } else {
                bytes.velocity()
            };
            self.each(|scene| scene.set_velocity(id, velocity))
                .expect("a sound velocity");
        }
    }

    fn advance(&mut self, bytes: &mut Bytes<'_>) {
        if bytes.chance(6) {
            self.length = [1.0 / 60.0, -1.0 / 60.0, 0.0, 1.0 / 240.0][bytes.below(4)];
        }
        let motion = |id: &BodyId| Some((*id, (*self.main().pose(*id)?, self.main().velocity(*id)?)));
        let motions: Motions = self.bodies.keys().filter_map(motion).collect();
        let length = self.length;
        match self.each(|scene| scene.advance(length)) {
            Ok(()) => {
                self.mix.ticks[0] += 1;
                let thrown = motions.iter().filter(|m| m.1.1 != Velocity::default());
                self.moved.extend(thrown.map(|m| *m.0));
                let is_rest = motions.values().all(|m| m.1 == Velocity::default());
                self.mix.ticks[1] += u64::from(is_rest);
                // The step sees only its first tick, and only if impacts were enabled before the
                // tick.
                let pairs = [(0, 0), (0, 1), (1, 1)].map(|(g, h)| (group(g), group(h)));
                let is_swept = pairs
                    .iter()
                    .any(|(g, h)| !first_times(&self.main().queries(*g, *h)).is_empty());
                self.motions = (!self.has_tick && is_swept).then_some((length, motions));
                self.has_tick = true;
            }
            Err(SceneError::StepDue) => assert!(self.has_tick, "a step is due only after a tick"),
            // A body would leave the range of the scene.
            Err(SceneError::TooFar { .. }) => self.mix.refused += 1,
            Err(e) => panic!("{e}"),
        }
    }

    /// Runs a step and judges all its results.
    fn step(&mut self) {
        let called: Vec<_> = self
            .pairs()
            .flat_map(|(a, b)| first_times(&self.called(a, b)).into_iter().map(move |d| (a, b, d)))
            .collect();
        for scene in &mut self.scenes {
            scene.step();
        }
        self.mix.steps += 1;
        self.compare_scenes();
        self.judge_left_out();
        self.judge_searches();
        let mut now = [Keys::new(), Keys::new()];
        for (a, b) in self.pairs().collect::<Vec<_>>() {
            self.judge(a, b, &mut now);
        }
        self.judge_events(&now);
        self.judge_impacts(&called);
        self.mix.overlapping[self.kind] += now[0].len() as u64;
        self.mix.within += now[1].len() as u64;
        let are_fixed = |(a, b): &&(BodyId, BodyId)| self.bodies[a].1 && self.bodies[b].1;
        self.mix.fixed[1] += now[0].iter().filter(are_fixed).count() as u64;
        [self.overlapping, self.within] = now;
        let counts = self.main().report().counts;
        self.mix.slept[0] += counts.slept;
        self.mix.slept[1] += counts.skipped;
        (self.motions, self.has_tick) = (None, false);
    }

    fn check(&self) {
        for scene in &self.scenes {
            assert_eq!(scene.check(), Ok(()));
        }
    }
}

/// Returns the distances whose first times are queried.
fn first_times(queries: &PairQueries) -> Vec<f64> {
    let contact = queries.impact.map(|_| 0.0);
    contact
        .into_iter()
        .chain(queries.impact_within.map(|(d, _)| d))
        .collect()
}

fn group(k: u8) -> Group {
    Group::new(k).expect("few groups")
}

/// Makes the calls that the bytes encode, and one step at the end.
///
/// `copy` returns a scene read back from a written one.
pub fn drive(bytes: &[u8], copy: impl Fn(&Scene) -> Scene) -> Mix {
    let mut bytes = Bytes(bytes);
    let mut world = World::new(&mut bytes, copy);
    for _ in 0..CALLS {
        if bytes.0.is_empty() {
            break;
        }
        world.call(&mut bytes);
        world.check();
    }
    world.step();
    world.check();
    world.mix
}
