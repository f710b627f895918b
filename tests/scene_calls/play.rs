//! Random calls, and all that a scene says after them beside what is true.

use crate::support::body;
use crate::{NONE, group};
use lab::rng::Rng;
use lab::shapes;
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::scene::{Body, BodyId, Change, Effects, Scene, SceneError};
use lin_canny::{Class, ConvexPolyhedron, ManifoldOptions, RelativePose, Tracker, Velocity};
use std::collections::BTreeSet;
use std::sync::Arc;

type Keys = BTreeSet<(BodyId, BodyId)>;

/// A scene under random calls, and what events have told of it.
pub(crate) struct Play {
    scene: Scene,
    pub(crate) rng: Rng,
    shapes: Vec<Arc<ConvexPolyhedron>>,
    fixed: BTreeSet<BodyId>,
    overlapping: Keys,
    within: Keys,
    boxes: Keys,
}

impl Play {
    pub(crate) fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut shapes: Vec<_> = [shapes::cube(), shapes::icosahedron(), shapes::needle(&mut rng, 8, 0.1)]
            .iter()
            .map(|s| Arc::new(body(s)))
            .collect();
        shapes.push(Arc::new(ConvexPolyhedron::point(Point3::new(0.1, 0.2, 0.3)).unwrap()));
        // Far from its own origin.
        let far: Vec<_> = shapes::cube()
            .points
            .iter()
            .map(|p| Point3::new(p[0] + 5.0, p[1], p[2]))
            .collect();
        shapes.push(Arc::new(ConvexPolyhedron::from_points(&far).unwrap()));
        Self {
            scene: Scene::new(),
            rng,
            shapes,
            fixed: BTreeSet::new(),
            overlapping: Keys::new(),
            within: Keys::new(),
            boxes: Keys::new(),
        }
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let (q, t) = (self.rng.quat(), [0; 3].map(|_| self.rng.range(-3.0, 3.0)));
        lab::Pose { q, t }.isometry()
    }

    fn any(&mut self) -> Option<BodyId> {
        let n = self.scene.body_count();
        (n > 0).then(|| self.scene.bodies().nth(self.rng.below(n)).unwrap())
    }

    fn effects(&mut self) -> Effects {
        let distance = |rng: &mut Rng| *rng.pick(&[0.0, 0.1, 0.5, 2.0]);
        Effects {
            boxes: self.rng.chance(0.5),
            overlap: self.rng.chance(0.5),
            within: self.rng.chance(0.4).then(|| distance(&mut self.rng)),
            distance: self.rng.chance(0.4).then(|| {
                if self.rng.chance(0.3) {
                    f64::INFINITY
                } else {
                    distance(&mut self.rng)
                }
            }),
            features: self.rng.chance(0.2),
            depth: self.rng.chance(0.2),
            manifold: self
                .rng
                .chance(0.2)
                .then(|| ManifoldOptions::within(distance(&mut self.rng))),
            impact: self.rng.chance(0.2).then_some(Tolerance::Distance(1e-6)),
            local_depth: self.rng.chance(0.2),
        }
    }

    /// One call.
    pub(crate) fn call(&mut self) {
        let Some(id) = self.any().filter(|_| self.scene.body_count() > 6) else {
            return self.insert();
        };
        match self.rng.below(20) {
            0 if self.scene.body_count() < 16 => self.insert(),
            1 => self.scene.remove(id).unwrap(),
            2 => {
                let (g, h, effects) = (self.rng.below(3), self.rng.below(3), self.effects());
                let effects = if self.rng.chance(0.2) { NONE } else { effects };
                self.scene.call_for(group(g), group(h), effects).unwrap();
            }
            3 => {
                let g = group(self.rng.below(3));
                self.scene.set_group(id, g).unwrap();
            }
            4 => {
                let on = self.rng.chance(0.7);
                self.scene.set_budget(on);
            }
            5 | 6 => {
                let pose = self.pose();
                self.scene.set_pose(id, pose).unwrap();
            }
            7 if !self.fixed.contains(&id) => {
                let part = |rng: &mut Rng| Vector3::from(rng.unit()) * rng.range(0.0, 0.3);
                let velocity = Velocity::new(part(&mut self.rng), part(&mut self.rng));
                self.scene.set_velocity(id, velocity).unwrap();
            }
            8 => {
                let (other, ignored) = (self.any().unwrap(), self.rng.chance(0.6));
                let set = if ignored { Scene::ignore_pair } else { Scene::allow_pair };
                set(&mut self.scene, id, other).unwrap();
            }
            9..12 => match self.scene.advance(0.1) {
                // A step sees one tick if impacts are called for.
                Ok(()) | Err(SceneError::StepDue) => {}
                Err(e) => panic!("{e}"),
            },
            _ => {
                let small = Isometry3::new(
                    Vector3::from(self.rng.unit()) * 0.05,
                    Vector3::from(self.rng.unit()) * 0.05,
                );
                let pose = self.scene.pose(id).unwrap() * small;
                let turn = UnitQuaternion::new_normalize(pose.rotation.into_inner());
                self.scene
                    .set_pose(id, Isometry3::from_parts(pose.translation, turn))
                    .unwrap();
            }
        }
    }

    fn insert(&mut self) {
        let shape = self.rng.pick(&self.shapes).clone();
        let fixed = self.rng.chance(0.3);
        let body = if fixed { Body::fixed(shape) } else { Body::moving(shape) };
        let (g, pose) = (group(self.rng.below(3)), self.pose());
        let id = self.scene.insert(body.group(g), pose).unwrap();
        if fixed {
            self.fixed.insert(id);
        }
    }

    /// A step, all of which is compared: how many distances, overlaps among them, overlapping pairs and pairs within it had.
    pub(crate) fn step(&mut self) -> [usize; 4] {
        self.scene.step();
        let mut now = Now::default();
        let ids: Vec<BodyId> = self.scene.bodies().collect();
        for (k, &a) in ids.iter().enumerate() {
            for &b in &ids[k + 1..] {
                self.compare(a, b, &mut now);
            }
        }
        self.compare_events(&now);
        let Now {
            overlapping,
            within,
            distances: [all, deep],
        } = now;
        (self.overlapping, self.within) = (overlapping, within);
        [all, deep, self.overlapping.len(), self.within.len()]
    }

    fn called(&self, a: BodyId, b: BodyId) -> Effects {
        if self.scene.is_ignored(a, b) {
            return NONE;
        }
        let [g, h] = [a, b].map(|id| self.scene.group(id).unwrap());
        self.scene.effects(g, h)
    }

    /// What the scene says of a pair, beside what is true.
    fn compare(&self, a: BodyId, b: BodyId, now: &mut Now) {
        let found = self.scene.pair(a, b);
        if self.fixed.contains(&a) && self.fixed.contains(&b) {
            assert_eq!(found, None);
            return;
        }
        let effects = self.called(a, b);
        let (x, y) = (
            self.scene.shape(a).and_then(|s| s.as_polyhedron()).unwrap(),
            self.scene.shape(b).and_then(|s| s.as_polyhedron()).unwrap(),
        );
        let pose = RelativePose::new(self.scene.pose(a).unwrap(), self.scene.pose(b).unwrap()).unwrap();
        let truth = Tracker::new().closest(x, y, &pose);
        let at_most = |d: f64| Tracker::new().within(x, y, &pose, d);
        if effects.overlap && at_most(0.0) {
            now.overlapping.insert((a, b));
        }
        if effects.within.is_some_and(at_most) {
            now.within.insert((a, b));
        }
        let distance = found.and_then(|p| p.distance);
        let measured = range(&effects).is_some_and(|range| range == f64::INFINITY || at_most(range));
        assert_eq!(distance.is_some(), measured, "{effects:?} {truth:?}");
        let outcome = found.and_then(|p| p.outcome);
        let whole = effects.features || effects.manifold.is_some();
        assert_eq!(outcome.is_some(), measured && whole);
        let manifold = found.and_then(|p| p.manifold);
        let touches = effects.manifold.is_some_and(|m| at_most(m.prediction));
        assert_eq!(manifold.is_some(), touches);
        if let Some(d) = distance {
            let is_deep = effects.depth || effects.local_depth || effects.manifold.is_some();
            let known = d.class != Class::Overlapping || is_deep;
            assert!(
                !known || d.lower <= truth.upper && truth.lower <= d.upper,
                "{d:?} {truth:?}"
            );
            now.distances[0] += 1;
            now.distances[1] += usize::from(d.class == Class::Overlapping);
        }
    }

    /// The events of the step, beside what has changed since the last.
    fn compare_events(&mut self, now: &Now) {
        let events = self.scene.events();
        assert!(events.is_sorted_by_key(|e| (e.a.index, e.b.index, e.change)));
        let of = |change: Change| -> Keys {
            let those = events.iter().filter(|e| e.change == change);
            those.map(|e| (e.a, e.b)).collect()
        };
        let overlaps = (of(Change::OverlapBegan), of(Change::OverlapEnded));
        self.compare_changes((&self.overlapping, &now.overlapping), overlaps, |e| e.overlap);
        let withins = (of(Change::CameWithin), of(Change::LeftWithin));
        self.compare_changes((&self.within, &now.within), withins, |e| e.within.is_some());
        let told = self.scene.pairs().map(|p| (p.a, p.b));
        let boxes: Keys = told.filter(|&(a, b)| self.called(a, b).boxes).collect();
        assert_eq!(of(Change::BoxesMet), boxes.difference(&self.boxes).copied().collect());
        self.boxes = boxes;
    }

    fn compare_changes(
        &self,
        (before, now): (&Keys, &Keys),
        (began, ended): (Keys, Keys),
        called: fn(&Effects) -> bool,
    ) {
        assert_eq!(began, now.difference(before).copied().collect());
        // What is no longer called for may be forgotten in silence.
        let may: Keys = before.difference(now).copied().collect();
        let is_called = |(a, b): &(BodyId, BodyId)| {
            let groups = self.scene.group(*a).zip(self.scene.group(*b));
            groups.is_some_and(|(g, h)| called(&self.scene.effects(g, h)))
        };
        let must: Keys = may.iter().copied().filter(is_called).collect();
        assert!(
            must.is_subset(&ended) && ended.is_subset(&may),
            "{must:?} {ended:?} {may:?}"
        );
    }
}

/// What is true of the pairs of a step.
#[derive(Default)]
struct Now {
    overlapping: Keys,
    within: Keys,
    /// Distances the scene gave, and those among them of overlapping bodies.
    distances: [usize; 2],
}

/// How far apart bodies may be for a distance to be called for; none where it is not.
fn range(effects: &Effects) -> Option<f64> {
    let is_measured = effects.distance.is_some() || effects.depth || effects.local_depth || effects.features;
    let own = is_measured.then(|| effects.distance.or(effects.within).unwrap_or(0.0));
    let prediction = effects.manifold.map(|m| m.prediction);
    own.into_iter().chain(prediction).reduce(f64::max)
}
